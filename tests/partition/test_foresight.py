"""`balance.foresee`: the same bits as without, shares that follow from known lives, a line for everything wrong."""

import csv
import json
import shutil

import numpy as np
import pytest

from test_command import call

h5py = pytest.importorskip("h5py")

END = 12e-6
STEEL = {"density": 7850, "eos": {"type": "linear", "bulk_modulus": 160e9},
         "strength": {"type": "elastic_plastic", "shear_modulus": 80e9, "yield_stress": 4e8, "hardening_modulus": 1e9},
         "erosion": {"criteria": [{"type": "plastic_strain", "limit": 0.15}]}}
LAYERS = 24
N, NODES = 48, 117  # elements and nodes of the coarse rod


def rod(scale=1, **more):
    """A rod that is used up at a wall, from its front on; finer cells with a larger scale."""
    return {"time": {"end": END}, "materials": {"steel": STEEL},
            "parts": {"rod": {"material": "steel", "velocity": [0, 0, -900], "mesh": {
                "type": "block", "size": [0.004, 0.004, 0.024], "cells": [2 * scale, 2 * scale, LAYERS // 2 * scale]}}},
            "boundaries": [{"type": "rigid_wall", "point": [0, 0, 0], "normal": [0, 0, 1]}],
            "checks": {"energy_growth": 1e6}, "output": {"element_fields": ["owner"], "precision": "double"}, **more}


def write(path, model):
    path.write_text(json.dumps(model))
    return path


@pytest.fixture(scope="module")
def place(binary, tmp_path_factory):
    """A folder with a coarse run, and the fine run on one rank without foresight."""
    folder = tmp_path_factory.mktemp("foresight")
    call(binary, "run", write(folder / "coarse.yaml", rod()), "--output", folder / "coarse")
    call(binary, "run", write(folder / "fine.yaml", rod(2)), "--output", folder / "fine")
    return folder


def summary_of(folder):
    return json.loads((folder / "summary.json").read_text())


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def owners(folder):
    with h5py.File(folder / "results.vtkhdf") as file:
        return file["VTKHDF/CellData/owner"][:file["VTKHDF/NumberOfCells"][0]]


def run_fine(binary, place, output, ranks, balance, *options, expect=0, **more):
    path = write(place / f"{output.name}.yaml", rod(2, balance=balance, **more))
    return call(binary, "run", path, "--output", output, "--ranks", ranks, *options, expect=expect)


def test_the_rod_is_used_up(place):
    """Else the tests below show nothing."""
    summary = summary_of(place / "fine")
    assert 0.2 < summary["eroded"]["elements"] / summary["parts"]["rod"]["elements"] < 0.8
    assert summary_of(place / "coarse")["eroded"]["elements"] > 5


@pytest.mark.parametrize("ranks", [1, 2, 3, 5])
def test_foresight_leaves_the_bits_alone_also_after_a_restart(binary, place, tmp_path, ranks):
    state = summary_of(place / "fine")["state_hash"]
    run_fine(binary, place, tmp_path / f"plain_{ranks}", ranks, {})
    assert summary_of(tmp_path / f"plain_{ranks}")["state_hash"] == state
    run_fine(binary, place, tmp_path / f"foreseen_{ranks}", ranks, {"foresee": "coarse"})
    assert summary_of(tmp_path / f"foreseen_{ranks}")["state_hash"] == state
    if ranks > 1:
        first = rows_of(tmp_path / f"foreseen_{ranks}" / "balance.csv")[0]
        assert (first["decision"], first["reason"]) == ("first", "foreseen")
        plain = rows_of(tmp_path / f"plain_{ranks}" / "balance.csv")[0]
        assert (plain["decision"], plain["reason"]) == ("first", "")
    half = tmp_path / f"half_{ranks}"
    cycles = summary_of(place / "fine")["cycles"]
    run_fine(binary, place, half, ranks, {"foresee": "coarse"}, "--set", f"time.maximum_cycles={cycles // 2}")
    assert summary_of(half)["cycles"] == cycles // 2
    run_fine(binary, place, half, 6 - ranks, {"foresee": "coarse"}, "--resume")
    assert summary_of(half)["state_hash"] == state


def with_lives(place, folder, deaths):
    """A copy of the coarse run in which other elements have died: (time, element)."""
    shutil.copytree(place / "coarse", folder)
    heading = (folder / "erosion.csv").read_text().splitlines()[0]
    names = next(csv.reader([heading]))
    lines = [",".join({"time [s]": str(time), "element": str(element)}.get(name, "0") for name in names)
             for time, element in deaths]
    (folder / "erosion.csv").write_text("\n".join([heading, *lines]) + "\n")
    summary = summary_of(folder)
    assert summary["parts"]["rod"]["elements"] == N
    summary["eroded"]["elements"] = len(deaths)
    (folder / "summary.json").write_text(json.dumps(summary))
    return folder


@pytest.mark.parametrize(("life", "elements"), [
    (1.0, 192),  # the same on both sides
    (0.75, 192),  # with more elements below, the first three quarters of the run would take longer than is won after
    (0.25, 264),  # 192 that count a quarter and 72 whole ones against 120
    (0.0, 287),  # 192 that die at once and count one hundredth, and 95 whole ones, against 97
])
def test_known_lives_give_the_shares_that_follow_from_them(binary, place, tmp_path, life, elements):
    with h5py.File(place / "coarse/results.vtkhdf") as file:
        root = file["VTKHDF"]
        corners = root["Connectivity"][:].reshape(-1, 8)
        z = root["Points"][:root["NumberOfPoints"][0]][corners][:, :, 2].mean(axis=1)
        ids = root["CellData/GlobalElementId"][:]
    lower = [int(e) for e in ids[z < 0.012]]
    assert len(lower) == len(ids) // 2
    deaths = [(life * END, e) for e in lower] if life < 1.0 else []
    with_lives(place, tmp_path / "known", deaths)
    run_fine(binary, place, tmp_path / "out", 2, {"foresee": str(tmp_path / "known"), "policy": {"type": "never"}},
             time={"end": END, "maximum_cycles": 1})
    owner = owners(tmp_path / "out")
    with h5py.File(tmp_path / "out/results.vtkhdf") as file:
        root = file["VTKHDF"]
        points = root["Points"][:root["NumberOfPoints"][0]]
        z = points[root["Connectivity"][:].reshape(-1, 8)][:, :, 2].mean(axis=1)
    below = owner[np.argmin(z)]
    assert (owner == below).sum() == elements and z[owner == below].max() < z[owner != below].min() + 1e-9
    row = rows_of(tmp_path / "out/balance.csv")[0]
    assert float(row["imbalance_after"]) == pytest.approx(elements / 192, rel=1e-6)


@pytest.mark.parametrize("ranks", [2, 3])
def test_the_mean_imbalance_is_less_where_the_front_dies(binary, place, tmp_path, ranks):
    mean = {}
    for name, balance in (("plain", {}), ("foreseen", {"foresee": "coarse"})):
        run_fine(binary, place, tmp_path / f"{name}_mean_{ranks}", ranks, {**balance, "policy": {"type": "never"}})
        rows = rows_of(tmp_path / f"{name}_mean_{ranks}" / "history.csv")
        mean[name] = np.mean([float(row["imbalance [-]"]) for row in rows])
    assert mean["plain"] > 1.15
    assert mean["foreseen"] - 1 < 0.8 * (mean["plain"] - 1), mean


def rewrite(folder, leave_out=(), change=None):
    """The results anew, without some objects, or with others."""
    path = folder / "results.vtkhdf"
    tables = {}
    with h5py.File(path) as file:
        file.visititems(lambda name, item: tables.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
    tables |= change(tables) if change else {}
    with h5py.File(path, "w") as file:
        for name, values in tables.items():
            if name not in leave_out:
                file[name] = values


def shuffled(tables):
    """The same elements in another order."""
    order = np.random.default_rng(5).permutation(N)
    cells = {name: tables[name][:N][order] for name in ("VTKHDF/CellData/part", "VTKHDF/CellData/GlobalElementId")}
    return cells | {"VTKHDF/Connectivity": tables["VTKHDF/Connectivity"].reshape(-1, 8)[order].ravel()}


def test_elements_are_known_by_their_ids_not_by_their_rows(binary, place, tmp_path):
    """The lives of the coarse run do not follow its rows."""
    found = []
    for name in ("as written", "shuffled"):
        with_lives(place, tmp_path / name, [(0.01 * e * END, e) for e in range(0, N, 3)])
        if name == "shuffled":
            rewrite(tmp_path / name, change=shuffled)
        run_fine(binary, place, tmp_path / f"out {name}", 3, {"foresee": str(tmp_path / name)},
                 time={"end": END, "maximum_cycles": 1})
        found.append(owners(tmp_path / f"out {name}"))
    assert np.array_equal(*found) and len(np.unique(np.bincount(found[0].astype(int)))) > 1


def cut(path, share=0.5):
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])


def edit_summary(folder, **values):
    (folder / "summary.json").write_text(json.dumps(summary_of(folder) | values))


def edit_erosion(folder, change):
    path = folder / "erosion.csv"
    path.write_text("".join(change(path.read_text().splitlines(keepends=True))))


def other_element(lines):
    """The last death is one of an element that does not exist."""
    names = next(csv.reader(lines[:1]))
    fields = lines[-1].rstrip("\n").split(",")
    fields[names.index("element")] = "48"
    return [*lines[:-1], ",".join(fields) + "\n"]


def foreign(folder):
    (folder / "results.vtkhdf").unlink()
    with h5py.File(folder / "results.vtkhdf", "w") as file:
        file["temperature"] = np.zeros(7)


DAMAGE = {
    "missing folder": (shutil.rmtree,
                       "results.vtkhdf: error: there are no results of a run that can be read; expected"),
    "no results": (lambda f: (f / "results.vtkhdf").unlink(),
                   "results.vtkhdf: error: there are no results of a run that can be read; expected"),
    "foreign file": (foreign, "results.vtkhdf: error: `VTKHDF/NumberOfPoints` is missing; expected a file of results"),
    "text": (lambda f: (f / "results.vtkhdf").write_text("a,b\n" * 99),
             "results.vtkhdf: error: there are no results of a run that can be read; expected"),
    "truncated": (lambda f: cut(f / "results.vtkhdf"), "results.vtkhdf: error: "),
    "no part": (lambda f: rewrite(f, ["VTKHDF/CellData/part"]), "`VTKHDF/CellData/part` is missing; expected"),
    "no ids": (lambda f: rewrite(f, ["VTKHDF/CellData/GlobalElementId"]),
               "`VTKHDF/CellData/GlobalElementId` is missing; expected"),
    "no names": (lambda f: rewrite(f, ["Kerf/part_names"]), "`Kerf/part_names` is missing; expected"),
    "names are numbers": (lambda f: rewrite(f, change=lambda t: {"Kerf/part_names": np.zeros(1)}),
                          "`Kerf/part_names` cannot be read; expected texts"),
    "sizes disagree": (lambda f: rewrite(f, change=lambda t: {"VTKHDF/CellData/part": np.zeros(N - 1, np.int32)}),
                       f"`VTKHDF/CellData/part` has {N - 1} rows of 1 numbers; expected at least {N} of 1"),
    "more elements than there are": (
        lambda f: rewrite(f, change=lambda t: {"VTKHDF/NumberOfCells": np.array([N + 1])}),
        f"`VTKHDF/Offsets` has {N + 1} rows of 1 numbers; expected at least {N + 2} of 1"),
    "no elements": (lambda f: rewrite(f, change=lambda t: {"VTKHDF/NumberOfCells": np.array([-3])}),
                    "there are -3 elements; expected"),
    "ids twice": (lambda f: rewrite(f, change=lambda t: {
        "VTKHDF/CellData/GlobalElementId": np.where(np.arange(N) == 7, 8, np.arange(N))}),
        "`VTKHDF/CellData/GlobalElementId` names element 8 twice, or there is no element 8; "
        "expected each number from 0 to 47 once"),
    "nodes that are not there": (lambda f: rewrite(f, change=lambda t: {
        "VTKHDF/Connectivity": t["VTKHDF/Connectivity"] + 90}),
        f"`VTKHDF/Connectivity` names node {NODES}; expected 0 to {NODES - 1}"),
    "no positions": (lambda f: rewrite(f, change=lambda t: {"VTKHDF/Points": t["VTKHDF/Points"] * np.nan}),
                     "`VTKHDF/Points` holds values that are no numbers; expected positions"),
    "offsets fall": (lambda f: rewrite(f, change=lambda t: {"VTKHDF/Offsets": t["VTKHDF/Offsets"][::-1]}),
                     "`VTKHDF/Offsets` do not rise from 0; expected"),
    "later frame": (lambda f: rewrite(f, change=lambda t: {"VTKHDF/Steps/Values": t["VTKHDF/Steps/Values"] + 1e-6}),
                    "the first frame is not of time 0; expected"),
    "no summary": (lambda f: (f / "summary.json").unlink(),
                   "summary.json: error: the file cannot be read: No such file or directory; expected the folder of"),
    "half a summary": (lambda f: cut(f / "summary.json"), "summary.json: error: `exit`, `end_time` or"),
    "did not finish": (lambda f: edit_summary(f, exit="signal"),
                       "summary.json: error: the run has not come to its end: signal; expected one that has completed"),
    "ended early": (lambda f: edit_summary(f, end_time=END / 2),
                    "summary.json: error: the run ends at 6e-06 s, and time.end is 1.2e-05 s; expected a run that is"),
    "no erosion": (lambda f: (f / "erosion.csv").unlink(), "erosion.csv: error: the file cannot be read: No such file"),
    "deaths are missing": (lambda f: edit_erosion(f, lambda lines: lines[:-1]),
                           "elements have eroded, and by summary.json"),
    "half a line": (lambda f: edit_erosion(f, lambda lines: [*lines[:-1], lines[-1][:-9]]),
                    "erosion.csv: error: the last line does not end; expected the whole file"),
    "other element": (lambda f: edit_erosion(f, other_element),
                      ": error: there is no element 48; expected a number from 0 to 47"),
    "other columns": (lambda f: edit_erosion(f, lambda lines: ["a,b\n", *lines[1:]]),
                      'erosion.csv:1:1: error: there is no column "time [s]"'),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_a_folder_that_does_not_serve_is_told(binary, place, tmp_path, name):
    spoil, message = DAMAGE[name]
    shutil.copytree(place / "coarse", tmp_path / "spoilt")
    spoil(tmp_path / "spoilt")
    done = run_fine(binary, place, tmp_path / "bad", 2, {"foresee": str(tmp_path / "spoilt")}, expect=2)
    assert message in done.stderr, done.stderr
    assert "bad.yaml:1:" in done.stderr
    assert "error: `foresee` names a folder that does not serve; expected that of an earlier run of this model" in (
        done.stderr)
    assert not (tmp_path / "bad" / "summary.json").exists()


def test_two_of_a_kind_of_mistake_are_both_told(binary, place, tmp_path):
    with_lives(place, tmp_path / "spoilt", [(-1e-6, 3), (1e-6, 3.5)])
    done = run_fine(binary, place, tmp_path / "bad", 2, {"foresee": str(tmp_path / "spoilt")}, expect=2)
    assert "erosion.csv:2:1: error: the time is -1e-06; expected one from 0 on" in done.stderr
    assert "erosion.csv:3:1: error: there is no element 3.5; expected a number from 0 to 47" in done.stderr


def test_a_run_of_another_model_is_told(binary, place, tmp_path):
    moved = rod()
    moved["parts"]["rod"]["placement"] = [{"translate": [0, 0, 0.02]}]
    moved["time"]["maximum_cycles"] = 3
    call(binary, "run", write(tmp_path / "moved.yaml", moved), "--output", tmp_path / "moved")
    edit_summary(tmp_path / "moved", end_time=END)
    done = run_fine(binary, place, tmp_path / "bad", 2, {"foresee": str(tmp_path / "moved")}, expect=2)
    assert "part rod of the run stands elsewhere or has another size, by 0.02 m; expected" in done.stderr
    moved["parts"] = {"bar": moved["parts"]["rod"]}
    call(binary, "run", write(tmp_path / "named.yaml", moved), "--output", tmp_path / "named")
    edit_summary(tmp_path / "named", end_time=END)
    done = run_fine(binary, place, tmp_path / "bad", 2, {"foresee": str(tmp_path / "named")}, expect=2)
    assert "the run has no part rod; expected a run of the same model" in done.stderr


def test_a_run_does_not_write_over_what_it_foresees_from(binary, place, tmp_path):
    shutil.copytree(place / "coarse", tmp_path / "mine")
    before = (tmp_path / "mine/summary.json").read_bytes()
    done = run_fine(binary, place, tmp_path / "mine", 2, {"foresee": str(tmp_path / "mine")}, expect=2)
    assert "error: `foresee` names the folder that this run writes into" in done.stderr and "; expected" in done.stderr
    assert (tmp_path / "mine/summary.json").read_bytes() == before


def test_check_looks_at_the_folder_too(binary, place, tmp_path):
    path = write(tmp_path / "model.yaml", rod(2, balance={"foresee": "nowhere"}))
    done = call(binary, "check", path, expect=2)
    assert f"{tmp_path}/nowhere/results.vtkhdf: error: there are no results" in done.stderr
    call(binary, "check", path, "--set", f"balance.foresee={place / 'coarse'}")
