"""What `kerf check` and the end of a run say is true: first step, energies, shares, and null where nothing is known."""

import re

import pytest
import yaml

from input_case import GOOD, kerf, on_ranks, settings, spoiled, summary_of

EOS = "eos: {type: linear, bulk_modulus: 130 GPa}"


def gas(density, energy):
    return {"density": density, "strength": {"type": "hydrodynamic"},
            "eos": {"type": "linear_polynomial", "C4": 0.4, "C5": 0.4, "initial_energy": energy}}


def gas_part(material, x):
    return {"material": material, "mesh": {"type": "block", "origin": [x, 0, 0], "size": [0.5, 0.05, 0.05],
                                           "cells": [10, 1, 1]}}


# A shock tube in two parts that touch, closed on all sides: at rest, and full of internal energy.
TUBE = {
    "time": {"end": 0.1}, "materials": {"dense": gas(1.0, 2.5), "thin": gas(0.125, 0.25)},
    "parts": {"left": gas_part("dense", -0.5), "right": gas_part("thin", 0.0)},
    "sets": {"front": {"parts": ["left"], "face": "x_min"}, "back": {"parts": ["right"], "face": "x_max"}},
    "boundaries": [{"type": "fixed", "nodes": ["front", "back"], "components": ["x"]}] + [
        {"type": "symmetry", "normal": [0, sign * (axis == "y"), sign * (axis == "z")],
         "point": [0, 0.05 * (sign < 0), 0.05 * (sign < 0)]} for axis in "yz" for sign in (1, -1)],
    "contacts": [{"type": "eroding_surface"}]}


@pytest.fixture
def write(tmp_path):
    def write_case(case):
        (tmp_path / "case.yaml").write_text(case if isinstance(case, str) else yaml.safe_dump(case))
        return tmp_path
    return write_case


def report_of(folder, *words):
    done = kerf("check", "case.yaml", *words, cwd=folder)
    assert done.returncode == 0, done.stderr
    return dict(re.split(r"\s{2,}", line, maxsplit=1) for line in done.stdout.split("\n\n")[1].splitlines())


def run(folder, *words):
    done = kerf("run", "case.yaml", "--output", "out", *words, cwd=folder)
    assert done.returncode == 0, done.stderr
    return done.stdout, summary_of(folder / "out")


# ---- kerf check

@pytest.mark.parametrize("case, changes, setter", [
    (GOOD, {}, r"element \d+ of part (target|striker)"),
    (TUBE, {}, "contact"),
    (GOOD, {"time.initial_step": "1 ns"}, "time.initial_step"),
    (GOOD, {"time.maximum_step": "2 ns"}, "time.maximum_step"),
    (GOOD, {"time.end": "3 ns"}, "time.end")], ids=["element", "contact", "initial_step", "maximum_step", "end"])
def test_check_knows_the_first_step_and_what_sets_it(case, changes, setter, write):
    folder = write(case)
    step, by = report_of(folder, *settings(changes))["first time step"].split(" s, set by ")
    assert re.fullmatch(setter, by)
    printed, _ = run(folder, *settings({**changes, "output.progress_interval": 1, "time.maximum_cycles": 1}))
    dt, cause = re.search(r"^cycle +1  .* dt (\S+) s \((.*?)\)", printed, re.M).groups()
    assert float(dt) == pytest.approx(float(step), rel=1e-3) and cause == by


def test_a_step_is_said_to_be_set_by_what_has_set_it(write):
    """The last one by the end of the run; one that follows a shorter one by the bound on growth."""
    printed, _ = run(write(GOOD), *settings({"time.initial_step": "1 ns", "output.progress_interval": 1}))
    causes = re.findall(r"^cycle .* dt \S+ s \((.*?)\)", printed, re.M)
    assert causes[:3] == ["time.initial_step", "time.growth", "time.growth"] and causes[-1] == "time.end"


def test_check_tells_kinetic_from_internal_energy(write):
    report = report_of(write(TUBE))
    assert float(report["kinetic energy"].split()[0]) == 0.0
    assert float(report["internal energy"].split()[0]) == pytest.approx((2.5 + 0.25) * 0.5 * 0.05**2, rel=1e-5)
    report = report_of(write(GOOD))
    assert report["internal energy"] == "0 J" and float(report["kinetic energy"].split()[0]) > 0.0


def test_check_counts_cycles_frames_and_restart_files_as_a_run_makes_them(write):
    folder = write(GOOD)
    assert report_of(folder, "--set", "time.maximum_cycles=5")["cycles, about"] == "5"
    changes = settings({"output.results_interval": "0.3 us", "output.precision": "double"})
    report = report_of(folder, *changes)
    run(folder, *changes)
    assert report["output, about"].endswith("MB in 8 frames")  # seven at whole intervals, and the last state
    # Of a small file a good part is what HDF5 keeps in its own interest.
    size = float(re.fullmatch(r"(\S+) MB in 1 file", report["restart, about"])[1]) * 1e6
    actual = (folder / "out" / "restart" / "restart.h5").stat().st_size
    assert 0.5 * actual < size + 0.05e6 < 1.5 * actual
    assert report_of(folder, "--set", "output.restart_at_end=false")["restart, about"] == "0.0 MB in 0 files"
    assert report_of(folder, "--set", "output.restart_interval=1 us")["restart, about"].endswith("MB in 2 files")


def test_check_adds_up_the_memory_of_all_ranks(write):
    folder = write(spoiled([("cells: [4, 4, 2]", "cells: [40, 40, 10]"), ("1 1 2.1 mm", "1 1 2.05 mm")]))
    one, three = (float(report_of(folder, *on_ranks(n))["memory, about"].split()[0]) for n in (1, 3))
    assert one < three < 1.5 * one  # nodes on the cuts are held twice


# ---- progress lines

def test_progress_lines_are_not_older_than_their_cycle(write):
    """Not of the last row of history.csv, which may be far back."""
    changes = {"output.history_interval": "1", "output.progress_interval": 1, "parameters.speed": "0 0 -1000 m/s",
               "materials.copper.erosion.criteria[0].limit": 0.3}
    printed, summary = run(write(GOOD), *settings(changes))
    eroded = [int(n) for n in re.findall(r"^cycle .* eroded +(\d+)", printed, re.M)]
    assert eroded[-1] == summary["eroded"]["elements"] > 0
    assert len(set(eroded)) > 2


# ---- the end of a run

@pytest.mark.parametrize("erosion", [True, False], ids=["eroding", "whole"])
def test_energy_that_a_material_starts_with_is_not_dissipated(erosion, write):
    """Without a pressure that depends on it, it changes nothing else either."""
    hourglass = []
    for energy in ("0", "1.0e+9 J/m3"):
        text = spoiled([(EOS, f"eos: {{type: linear_polynomial, C1: 130 GPa, initial_energy: {energy}}}")])
        changes = {"parameters.speed": "0 0 -600 m/s", "time.end": "4 us",
                   "checks.free_nodes": "keep", "materials.copper.erosion.criteria[0].limit": 0.4 if erosion else 100}
        _, summary = run(write(text), *settings(changes))
        assert (summary["eroded"]["elements"] > 0) == erosion
        assert summary["mass"]["dropped"] == 0.0
        hourglass.append(summary["hourglass"])
    # The balance is kept in quanta of the energy that there is; both runs make the same steps to round-off.
    assert hourglass[1]["dissipated"] == pytest.approx(hourglass[0]["dissipated"], rel=1e-6)
    assert hourglass[1]["share"] == pytest.approx(hourglass[0]["share"], rel=1e-6)
    assert hourglass[0]["share"] > 0.01


def test_a_fluid_gives_back_all_that_was_done_on_it(write):
    _, summary = run(write(TUBE))
    energy = summary["energy"]
    assert summary["hourglass"]["dissipated"] == pytest.approx(
        energy["hourglass"] + energy["bulk_viscosity"] + energy["contact"], rel=1e-12)
    assert summary["hourglass"]["dissipated"] < 0.1 * energy["initial"]


def test_a_measure_that_is_not_known_is_null_and_says_why(write):
    half = "  plate: {type: hole_diameter, part: target, normal: 0 1 1}\n  all: {type: mass_lost, part: striker}\n"
    printed, summary = run(write(GOOD + half))
    reason = "part target has no flat entry face that is perpendicular to `normal`; look at `normal`"
    assert summary["measures"]["plate.perforated"] is None and summary["measures"]["all"] == 0.0
    assert summary["not_measured"]["plate.perforated"] == reason
    assert set(summary["not_measured"]) == {name for name, value in summary["measures"].items() if value is None}
    assert re.search(r"^  plate\.perforated +null$", printed, re.M)
    names = "plate.entry_area, plate.entry_largest, plate.entry_smallest, plate.perforated"
    assert f"  null: {reason} ({names})\n" in printed


@pytest.mark.parametrize("normals", [["symmetry_normal: 0 0 1"],
                                     ["symmetry_normal: 1 0 0", "second_symmetry_normal: 1 1 0"]])
def test_planes_of_symmetry_that_do_not_fit_are_refused(normals, write):
    folder = write(GOOD + f"  plate: {{type: hole_diameter, part: target, {', '.join(normals)}}}\n")
    done = kerf("check", "case.yaml", cwd=folder)
    key = normals[-1].split(":")[0]
    assert done.returncode == 2 and f"error: `{key}`: the plane" in done.stderr and "perpendicular" in done.stderr


def test_nothing_that_is_left_has_no_velocity(write):
    changes = {"materials.copper.erosion.criteria[0].limit": "1.0e-5", "parameters.speed": "0 0 -800 m/s",
               "time.end": "4 us"}
    printed, summary = run(write(GOOD), *settings(changes))
    striker = summary["parts"]["striker"]
    assert striker["alive"] == 0 and striker["velocity"] == [None, None, None] and striker["kinetic"] == 0.0
    assert re.search(r"^striker +8 +0 +0 +null$", printed, re.M)
    assert summary["measures"]["exit.speed"] is None
    assert summary["not_measured"]["exit.speed"] == "no element of part striker is left"


def test_a_time_that_never_came_is_null(write):
    _, summary = run(write(GOOD))
    assert summary["contact_let_go"]["nodes"] == 0 and summary["contact_let_go"]["first_time"] is None


def test_the_title_is_in_the_summary(write):
    assert run(write(GOOD))[1]["title"] == "two blocks"


def test_a_resumed_run_counts_from_time_zero_but_for_its_own_speed(write):
    folder = write(GOOD)
    changes = {"parameters.speed": "0 0 -1000 m/s", "materials.copper.erosion.criteria[0].limit": 0.3}
    first = run(folder, *settings({**changes, "time.end": "1.5 us"}))[1]
    both = run(folder, "--resume", *settings({**changes, "time.end": "3 us"}))[1]
    assert 0 < first["eroded"]["elements"] < both["eroded"]["elements"]
    for counts in ("by_part", "by_criterion"):
        assert sum(both["eroded"][counts].values()) == both["eroded"]["elements"]
    own = both["element_cycles"] - first["element_cycles"]
    assert both["element_cycles_per_second"] * both["wall_seconds"] == pytest.approx(own, rel=1e-9)
