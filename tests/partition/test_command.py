"""`kerf partition` measures what it says, for the initial mesh and for frames of a run, and its files can be read."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]

h5py = pytest.importorskip("h5py")

# A rod strikes a plate; both erode, and a third body that is not in contact stands aside.
MODEL = {
    "time": {"end": "9 us"},
    "materials": {"metal": {
        "density": 7850,
        "strength": {"type": "elastic_plastic", "shear_modulus": 80e9, "yield_stress": 0.4e9,
                     "hardening_modulus": 0.2e9},
        "eos": {"type": "linear", "bulk_modulus": 160e9},
        "erosion": {"criteria": [{"type": "plastic_strain", "limit": 0.25}, {"type": "inversion"}]}}},
    "parts": {
        "plate": {"material": "metal", "mesh": {"type": "block", "size": "[10, 9, 3] mm", "cells": [10, 9, 3]}},
        "rod": {"material": "metal", "velocity": "0 0 900 m/s",
                "mesh": {"type": "block", "size": "[3, 3, 6] mm", "origin": "[4, 3, -6.01] mm", "cells": [3, 3, 6]}},
        "aside": {"material": "metal",
                  "mesh": {"type": "block", "size": "[4, 4, 4] mm", "origin": "[30, 0, 0] mm", "cells": [4, 4, 4]}}},
    "contacts": [{"type": "eroding_surface", "parts": ["plate", "rod"]}],
    "checks": {"energy_growth": 0.5},
    "output": {"results_interval": "3 us", "precision": "double", "element_fields": ["pressure", "owner"]},
}
FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def call(binary, *words, expect=0):
    done = subprocess.run([str(binary), *map(str, words)], capture_output=True, text=True, timeout=600)
    assert done.returncode == expect, done.stdout + done.stderr
    return done


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    path = tmp_path_factory.mktemp("model") / "rod.yaml"
    path.write_text(json.dumps(MODEL))
    return path


@pytest.fixture(scope="module")
def run(binary, model, tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    call(binary, "run", model, "--output", folder, "--ranks", 2)
    return folder


@pytest.fixture(scope="module")
def study(binary, model, tmp_path_factory):
    """All methods, on one rank."""
    folder = tmp_path_factory.mktemp("study")
    call(binary, "partition", model, "--parts", "2,3,7", "--output", folder)
    return folder


def rows_of(folder):
    return json.loads((folder / "partitions.json").read_text())["partitions"]


def cells_of(folder, state):
    with h5py.File(folder / state / "results.vtkhdf") as file:
        return (file["VTKHDF/Connectivity"][:].reshape(-1, 8), file["VTKHDF/CellData/alive"][:],
                file["VTKHDF/Points"][:], {name: data[:] for name, data in file["VTKHDF/CellData"].items()})


def measures(cells, alive, part, n_parts):
    """The measures of a division, counted one by one."""
    live = np.flatnonzero(alive)
    elements = np.bincount(part[live], minlength=n_parts)
    at_node, at_face, faces_of = {}, {}, [set() for _ in range(n_parts)]
    for e in live:
        for n in cells[e]:
            at_node.setdefault(n, set()).add(part[e])
        for face in FACES:
            key = tuple(sorted(cells[e][list(face)]))
            at_face.setdefault(key, []).append(part[e])
            faces_of[part[e]].add(key)
    shared = [parts for parts in at_node.values() if len(parts) > 1]
    neighbours = [set() for _ in range(n_parts)]
    for parts in shared:
        for p in parts:
            neighbours[p] |= parts - {p}
    between = [key for key, parts in at_face.items() if len(set(parts)) > 1]
    of_part = [sum(key in faces for key in between) for faces in faces_of]
    return {
        "elements": elements.tolist(),
        "interface_nodes": len(shared),
        "node_copies": sum(len(parts) - 1 for parts in shared),
        "most_interface_nodes": max(sum(p in parts for parts in shared) for p in range(n_parts)),
        "most_neighbours": max(map(len, neighbours)),
        "mean_neighbours": sum(map(len, neighbours)) / n_parts,
        "surface_index": len(between) / len(at_face),
        "largest_surface_index": max(n / len(faces) for n, faces in zip(of_part, faces_of) if faces),
    }


def contact_of_parts(cells, alive, part, n_parts, in_contact):
    """The work of contact of each part: exterior nodes in equal shares for the exterior faces round them."""
    sides = {}
    for e in np.flatnonzero(alive):
        for face in FACES:
            nodes = cells[e][list(face)]
            sides.setdefault(tuple(sorted(nodes)), []).append((e, nodes))
    exterior = [found[0] for found in sides.values() if len(found) == 1]
    round_node = {}
    for _, nodes in exterior:
        for n in nodes:
            round_node[n] = round_node.get(n, 0) + 1
    work = np.zeros(n_parts)
    for e, nodes in exterior:
        if in_contact[e]:
            work[part[e]] += sum(1.0 / round_node[n] for n in nodes)
    return work


def expect_measured(row, folder):
    cells, alive, _, fields = cells_of(folder, row["state"])
    part = fields[f"{row['method']}_{row['parts']}"].astype(int)
    counted = measures(cells, alive, part, row["parts"])
    assert row["of_parts"]["elements"] == counted.pop("elements")
    for key, value in counted.items():
        assert row[key] == pytest.approx(value, rel=1e-12), key
    elements = np.array(row["of_parts"]["elements"])
    assert row["element_balance"] == pytest.approx(elements.max() / elements.mean())
    assert row["empty_parts"] == (elements == 0).sum()
    # The plate and the rod are in contact, the third body is not.
    contact = contact_of_parts(cells, alive, part, row["parts"], fields["part"] < 2)
    assert row["of_parts"]["contact_work"] == pytest.approx(contact.tolist(), abs=1e-9)
    assert row["contact_balance"] == pytest.approx(contact.max() / contact.mean(), rel=1e-9)


def test_all_methods_are_measured_and_balance(study):
    rows = rows_of(study)
    methods = {row["method"] for row in rows}
    assert methods == {"bisection", "block", "zoltan_graph", "zoltan_hsfc", "zoltan_hypergraph", "zoltan_rcb",
                       "zoltan_rib", "zoltan_scotch"}
    assert {row["parts"] for row in rows} == {2, 3, 7} and len(rows) == 3 * len(methods)
    for row in rows:
        expect_measured(row, study)
        # A plane of elements across a cut of `bisection` stays on one side: here a layer is a tenth of a part.
        limit = 1.2 if row["method"] == "bisection" else 1.1
        assert row["element_balance"] < limit and row["empty_parts"] == 0, row["method"]
        assert row["moved_elements"] is None


def test_tables_hold_the_same_numbers(study):
    with open(study / "partitions.csv", newline="") as file:
        table = list(csv.DictReader(file))
    for line, row in zip(table, rows_of(study), strict=True):
        assert (line["method"], int(line["parts"])) == (row["method"], row["parts"])
        assert int(line["interface_nodes"]) == row["interface_nodes"]
        assert float(line["largest_surface_index"]) == pytest.approx(row["largest_surface_index"], rel=1e-5)
    text = (study / "partitions.md").read_text()
    assert text.count("\n| zoltan_rcb | ") == 3


def test_file_of_partitions_holds_what_the_mesh_shows(study):
    _, _, _, fields = cells_of(study, "initial")
    with h5py.File(study / "partitions.h5") as file:
        assert file.attrs["kerf_partitions"] == 1 and file.attrs["n_elements"] == len(fields["part"])
        for row in rows_of(study):
            data = file[f"initial/{row['method']}/{row['parts']}"]
            assert data.attrs["n_parts"] == row["parts"]
            assert np.array_equal(data[:], fields[f"{row['method']}_{row['parts']}"].astype(int))


def test_several_ranks_measure_alike_and_two_calls_find_the_same(binary, model, study, tmp_path):
    call(binary, "partition", model, "--parts", "2,3,7", "--output", tmp_path / "one")
    call(binary, "partition", model, "--parts", "4,7", "--output", tmp_path / "three", "--ranks", 3)
    call(binary, "partition", model, "--parts", "4,7", "--output", tmp_path / "again", "--ranks", 3)
    with h5py.File(study / "partitions.h5") as first, h5py.File(tmp_path / "one" / "partitions.h5") as second:
        for row in rows_of(study):
            name = f"initial/{row['method']}/{row['parts']}"
            assert np.array_equal(first[name][:], second[name][:]), name
    with h5py.File(tmp_path / "three/partitions.h5") as first, h5py.File(tmp_path / "again/partitions.h5") as second:
        for row in rows_of(tmp_path / "three"):
            expect_measured(row, tmp_path / "three")
            name = f"initial/{row['method']}/{row['parts']}"
            assert np.array_equal(first[name][:], second[name][:]), name


def test_block_does_not_depend_on_ranks(binary, model, study, tmp_path):
    call(binary, "partition", model, "--parts", 7, "--method", "block", "--output", tmp_path, "--ranks", 3)
    with h5py.File(study / "partitions.h5") as one, h5py.File(tmp_path / "partitions.h5") as three:
        assert np.array_equal(one["initial/block/7"][:], three["initial/block/7"][:])
        assert np.all(np.diff(one["initial/block/7"][:]) >= 0)


def test_the_file_of_an_earlier_call_may_be_read_and_replaced(binary, model, tmp_path):
    call(binary, "partition", model, "--parts", 7, "--method", "block", "--no-mesh", "--output", tmp_path)
    with h5py.File(tmp_path / "partitions.h5") as file:
        before = file["initial/block/7"][:]
    again = f"again={{type: file, file: {tmp_path / 'partitions.h5'}, method: block}}"
    call(binary, "partition", model, "--parts", 7, "--method", again, "--no-mesh", "--output", tmp_path)
    with h5py.File(tmp_path / "partitions.h5") as file:
        assert list(file["initial"]) == ["again"]
        assert np.array_equal(file["initial/again/7"][:], before)
    assert not list(tmp_path.glob("*.part"))


@pytest.mark.parametrize("ranks", [1, 2])
def test_frames_are_divided_as_they_are(binary, model, run, tmp_path, ranks):
    call(binary, "partition", model, "--parts", "2,5", "--results", run, "--frame", "last,0,1", "--output", tmp_path,
         "--ranks", ranks, "--method", "block,zoltan_rcb,zoltan_hypergraph")
    rows = rows_of(tmp_path)
    with h5py.File(run / "results.vtkhdf") as file:
        root = file["VTKHDF"]
        last, n = len(root["Steps/Values"]) - 1, int(root["NumberOfPoints"][0])
        assert list(dict.fromkeys(row["frame"] for row in rows)) == [0, 1, last]
        for row in rows:
            frame = row["frame"]
            _, alive, x, fields = cells_of(tmp_path, row["state"])
            there = root["CellData/alive"][root["Steps/CellDataOffsets/alive"][frame]:][: len(alive)]
            assert np.array_equal(alive, there)
            assert row["live_elements"] == there.sum() == sum(row["of_parts"]["elements"])
            start = root["Steps/PointOffsets"][frame]
            used = np.unique(root["Connectivity"][:].reshape(-1, 8)[there == 1])
            assert x[used] == pytest.approx(root["Points"][start:start + n][used], rel=1e-6, abs=1e-9)
            expect_measured(row, tmp_path)
    assert rows[-1]["live_elements"] < rows[0]["live_elements"], "the run erodes nothing, so the test shows little"


def test_moved_elements_are_those_of_another_part_than_before(binary, model, run, tmp_path):
    call(binary, "partition", model, "--parts", "4", "--results", run, "--frame", "0,1,last", "--output", tmp_path,
         "--method", "zoltan_rcb,zoltan_hypergraph")
    for method in ("zoltan_rcb", "zoltan_hypergraph"):
        rows = [row for row in rows_of(tmp_path) if row["method"] == method]
        assert rows[0]["moved_elements"] is None
        with h5py.File(tmp_path / "partitions.h5") as file:
            parts = [file[f"{row['state']}/{method}/4"][:] for row in rows]
        for before, now, row in zip(parts, parts[1:], rows[1:]):
            moved = int(((before != now) & (now >= 0)).sum())
            assert row["moved_elements"] == moved < row["live_elements"] / 2


def test_methods_take_parameters_and_names(binary, model, tmp_path):
    call(binary, "partition", model, "--parts", 6, "--output", tmp_path, "--method", "zoltan_rcb", "--method",
         "both={type: zoltan_rcb, criteria: elements_and_contact}")
    plain, both = rows_of(tmp_path)
    assert (both["method"], both["type"]) == ("both", "zoltan_rcb")
    assert both["contact_balance"] < plain["contact_balance"]
    assert both["element_balance"] < 1.4


def test_two_and_three_parts_of_a_bar_are_cut_across(binary, tmp_path):
    """The pictures of Ren & Wang: equal elements, and no more interface nodes than plane cuts have."""
    bar = {**MODEL, "contacts": [],
           "parts": {"bar": {"material": "metal",
                             "mesh": {"type": "block", "size": "[24, 4, 4] mm", "cells": [24, 4, 4]}}}}
    (tmp_path / "bar.yaml").write_text(json.dumps(bar))
    call(binary, "partition", tmp_path / "bar.yaml", "--parts", "2,3", "--output", tmp_path / "out")
    rows = rows_of(tmp_path / "out")
    for row in rows:
        assert row["contact_balance"] is None
    for method in ("zoltan_rcb", "zoltan_rib"):
        found = [(row["element_balance"], row["interface_nodes"], row["most_neighbours"]) for row in rows
                 if row["method"] == method]
        assert found == [(1.0, 25, 1), (1.0, 50, 2)]


@pytest.mark.parametrize("words, message", [
    (["--parts", "2,x"], '--parts 2,x: error: "x" is no number of parts; expected whole numbers from 1 to 388'),
    (["--parts", "0"], '"0" is no number of parts'),
    (["--parts", "389"], '"389" is no number of parts'),
    (["--parts", "2", "--method", "zoltan_rbc"], "zoltan_rcb"),
    (["--parts", "2", "--method", "a b={type: block}"], 'error: "a b" is no name of a method'),
    (["--parts", "2", "--method", "block,block"], "error: the method block is named twice"),
    (["--parts", "2", "--method", "zoltan_rcb={type: block}"],
     "error: zoltan_rcb is the name of another partitioner, and the method is of the type block"),
    (["--parts", "2", "--method", "all={type: block}"], "error: all is the name of all methods together"),
    (["--parts", "2", "--method", "x={type: block, seed: 3}"], "seed"),
    (["--parts", "3", "--method", "none"], "3 parts are asked for; use `block` in its place"),
    (["--parts", "2", "--frame", "1"], "--frame 1: error: frames of which results?"),
    (["--parts", "2", "--results", "nowhere"], "nowhere/results.vtkhdf: error: there are no results of a run"),
    (["--parts", "2", "--results", "RUN", "--frame", "99"], '--frame 99: error: "99" is no frame'),
    (["--parts", "2", "--results", "OTHER"], "the results are of a model of"),
])
def test_mistakes_are_told(binary, model, run, study, tmp_path, words, message):
    places = {"RUN": run, "OTHER": tmp_path / "other"}
    if "OTHER" in words:
        small = {**MODEL, "time": {"end": "1 ns"},
                 "parts": {"plate": MODEL["parts"]["plate"], "rod": MODEL["parts"]["rod"]}}
        (tmp_path / "small.yaml").write_text(json.dumps(small))
        call(binary, "run", tmp_path / "small.yaml", "--output", places["OTHER"])
    done = call(binary, "partition", model, "--output", tmp_path / "out", *[places.get(w, w) for w in words], expect=2)
    assert message in done.stderr and "error:" in done.stderr


def test_pictures_are_drawn(study):
    done = subprocess.run([sys.executable, "-B", str(ROOT / "framework/post/partition.py"), str(study), "--most-parts",
                           "3"], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    drawn = {path.name for path in (study / "pictures").iterdir()}
    if "no way to draw" in done.stderr:
        pytest.skip(done.stderr)
    assert {"initial.png", "initial_zoltan_rcb_2.png", "initial_zoltan_rcb_3.png"} <= drawn
    assert "initial_zoltan_rcb_7.png" not in drawn
    from matplotlib.image import imread
    image = imread(study / "pictures" / "initial_zoltan_rcb_3.png")[..., :3]
    colours = {tuple((c * 8).astype(int)) for c in image.reshape(-1, 3)}
    assert len(colours) > 20, "an empty picture"


def test_results_tell_the_owner(binary, model, run, tmp_path):
    with h5py.File(run / "results.vtkhdf") as file:
        owner = file["VTKHDF/CellData/owner"][:]
    assert set(np.unique(owner)) == {0.0, 1.0}
    call(binary, "run", model, "--output", tmp_path)
    with h5py.File(tmp_path / "results.vtkhdf") as file:
        assert not file["VTKHDF/CellData/owner"][:].any()
    one, two = (json.loads((folder / "summary.json").read_text()) for folder in (tmp_path, run))
    assert one["state_hash"] == two["state_hash"]


def test_observers_cannot_have_the_owner(binary, tmp_path):
    watched = {**MODEL, "observers": {"probe": {"type": "gauge", "part": "rod", "point": "5 4 -3 mm",
                                                "quantities": ["owner"]}}}
    (tmp_path / "watched.yaml").write_text(json.dumps(watched))
    done = call(binary, "check", tmp_path / "watched.yaml", expect=2)
    assert "owner" in done.stderr
