"""Failure in whole runs: elements that stay without tension, averages over a neighbourhood, and conditions that the
user writes."""

import csv

import numpy as np
import pytest

STEEL = {"density": 7850, "strength": {"type": "elastic_plastic", "shear_modulus": "80 GPa",
                                       "yield_stress": "600 MPa"},
         "eos": {"type": "linear", "bulk_modulus": "160 GPa"}}


def deletions(run):
    with open(run.folder / "erosion.csv", newline="") as file:
        return list(csv.DictReader(file))


# ---- elements that stay ---------------------------------------------------------------------------------------------


def pulled(criterion, cells=24, length=0.012):
    """A column that is torn apart by its own motion, and then pushed together again by a wall that it meets."""
    width = length / cells
    walls = [{"type": "symmetry", "point": point, "normal": normal} for point, normal in (
        ([0, 0, 0], [0, 1, 0]), ([0, 0, 0], [0, 0, 1]), ([0, width, 0], [0, -1, 0]), ([0, 0, width], [0, 0, -1]))]
    return {
        "title": "column",
        "time": {"end": 6e-6},
        "materials": {"steel": {**STEEL, "erosion": {"criteria": [criterion]}}},
        "parts": {"column": {"material": "steel",
                             "mesh": {"type": "block", "size": [length, width, width], "cells": [cells, 1, 1]}}},
        "sets": {"right": {"face": "x_max"}},
        "boundaries": [*walls, {"type": "symmetry", "normal": [1, 0, 0]},
                       {"type": "prescribed_motion", "nodes": ["right"], "velocity": [1, 0, 0], "curve": "pull"}],
        "curves": {"pull": {"times": [0, 3e-6, 3.1e-6], "values": [60, 60, -80]}},
        "output": {"results_interval": 2e-7, "precision": "double",
                   "element_fields": ["pressure", "von_mises", "no_tension"]},
        "checks": {"energy_growth": 0.5},
    }


SPALL = {"type": "minimum_pressure", "limit": "-0.8 GPa", "then": "no_tension"}


def test_failed_elements_resist_compression_only(kerf):
    run = kerf(pulled(SPALL))
    results = run.results
    failed = np.array([results.cell("no_tension", f) for f in range(len(results.times))])
    pressure = np.array([results.cell("pressure", f) for f in range(len(results.times))])
    stress = np.array([results.cell("von_mises", f) for f in range(len(results.times))])
    assert run.summary["no_tension"]["elements"] == failed[-1].sum() > 0
    assert run.summary["no_tension"]["by_part"] == {"column": failed[-1].sum()}
    assert run.summary["eroded"]["elements"] == 0
    assert np.all(np.diff(failed, axis=0) >= 0.0)  # for ever
    # The verdict acts a step after it is given, so the frame in which it is given may show the stress before.
    since = failed[:-1] == 1.0
    assert np.all(pressure[1:][since] >= 0.0)
    assert np.all(stress[1:][since] == 0.0)
    assert pressure[1:][since].max() > 1e8  # pushed together again
    assert abs(run.summary["energy"]["balance_error"]) < 1e-3


def test_elements_are_deleted_where_nothing_else_is_asked_for(kerf):
    model = pulled({**SPALL, "then": "erosion"})
    model["output"]["element_fields"] = ["pressure"]
    run = kerf(model)
    assert run.summary["eroded"]["elements"] > 0
    assert run.summary["no_tension"] == {"elements": 0, "by_part": {}}


@pytest.mark.parametrize("rule, count", [("all", None), ("at_least", 2)])
def test_criteria_that_fail_together_keep_together(kerf, rule, count):
    """The second criterion comes later: the volume grows with time."""
    model = pulled(SPALL)
    erosion = {"rule": rule, "criteria": [SPALL, {"type": "volumetric_strain", "tension_limit": 0.01,
                                                  "then": "no_tension"}]}
    if count:
        erosion["count"] = count
    model["materials"]["steel"]["erosion"] = erosion
    run, first = kerf(model), kerf(pulled(SPALL))
    assert 0 < run.summary["no_tension"]["elements"] <= first.summary["no_tension"]["elements"]
    assert run.summary["eroded"]["elements"] == 0


# ---- the same bits ---------------------------------------------------------------------------------------------------

NONLOCAL = {"type": "ductile_damage", "failure_strain": 0.02, "nonlocal_radius": "1.2 mm"}


def block(criteria):
    """A block that is pulled from its middle, so that damage is uneven."""
    return {
        "title": "block",
        "time": {"end": 8e-6},
        "materials": {"steel": {**STEEL, "erosion": {"criteria": criteria}}},
        "parts": {"block": {"material": "steel",
                            "mesh": {"type": "block", "size": [0.006, 0.004, 0.002], "cells": [12, 8, 4]}}},
        "sets": {"left": {"face": "x_min"}, "right": {"face": "x_max"}},
        "boundaries": [{"type": "fixed", "nodes": ["left"]},
                       {"type": "prescribed_motion", "nodes": ["right"], "velocity": [60, 10, 0]}],
        "output": {"results_interval": 8e-6, "precision": "double"},
        "checks": {"energy_growth": 0.5},
    }


@pytest.mark.parametrize("criteria", [
    [SPALL, {"type": "plastic_strain", "limit": 0.05}],
    [NONLOCAL],
    [{**NONLOCAL, "softening": "linear", "fracture_energy": 2e3, "nonlocal_weight": "bell"}],
    [{"type": "expression", "expression": "effective_plastic_strain > 0.03 and pressure < 0.1 GPa"}],
], ids=["no_tension", "nonlocal", "nonlocal_softening", "expression"])
def test_the_bits_do_not_depend_on_the_ranks(kerf, criteria):
    alone = kerf(block(criteria))
    for ranks in (2, 3):
        many = kerf(block(criteria), "balance.force_interval=11", ranks=ranks)
        assert many.summary["state_hash"] == alone.summary["state_hash"]
        assert many.summary["eroded"] == alone.summary["eroded"]
        assert many.summary["no_tension"] == alone.summary["no_tension"]
    # Something has happened that could have gone apart.
    assert alone.summary["eroded"]["elements"] + alone.summary["no_tension"]["elements"] > 0


@pytest.mark.parametrize("size, radius", [(0.8, 2.4), (0.7, 1.4)])
def test_neighbours_at_the_very_radius_are_the_same_on_any_ranks(kerf, size, radius):
    """Round-off decides whether they count; it must not do so differently where a rank asks another one."""
    model = block([{**NONLOCAL, "nonlocal_radius": f"{radius} mm"}])
    model["parts"]["block"]["mesh"] |= {"size": [12 * size * 1e-3, 4 * size * 1e-3, 2 * size * 1e-3],
                                        "cells": [12, 4, 2]}
    model["time"]["end"] = 12e-6
    model["boundaries"][1]["velocity"] = [120, 20, 0]
    alone = kerf(model)
    assert alone.summary["eroded"]["elements"] > 0
    for ranks in (2, 3, 5):
        assert kerf(model, "balance.force_interval=3", ranks=ranks).summary["state_hash"] == alone.summary["state_hash"]


@pytest.mark.parametrize("criteria", [[SPALL], [NONLOCAL]], ids=["no_tension", "nonlocal"])
def test_a_restart_goes_on_as_if_nothing_had_been(kerf, criteria):
    whole = kerf(block(criteria))
    half = whole.summary["cycles"] // 2
    assert whole.summary["eroded"]["elements"] + whole.summary["no_tension"]["elements"] > 0
    stopped = kerf(block(criteria), f"time.maximum_cycles={half}", ranks=3)
    resumed = kerf(block(criteria), ranks=2, resumes=stopped)
    assert resumed.summary["state_hash"] == whole.summary["state_hash"]
    assert resumed.summary["eroded"] == whole.summary["eroded"]


def test_an_average_over_one_element_is_local_damage_a_step_later(kerf):
    def cycle_of_deletion(**more):
        criterion = {"type": "ductile_damage", "failure_strain": 0.02, **more}
        (row,) = deletions(kerf(pulled(criterion, cells=1, length=0.0005), "output.element_fields=[]"))
        return int(row["cycle"])

    local = cycle_of_deletion()
    assert local > 2
    # What the average adds at the end of a step is seen by the next one.
    assert cycle_of_deletion(nonlocal_radius="0.2 mm") == local + 1


# ---- conditions -----------------------------------------------------------------------------------------------------


def test_a_condition_is_as_good_as_a_criterion(kerf):
    of_its_own = kerf(block([{"type": "plastic_strain", "limit": 0.03}]))
    written = kerf(block([{"type": "expression", "expression": "effective_plastic_strain >= 0.03"}]))
    assert of_its_own.summary["eroded"]["elements"] > 0
    rows = [[{k: v for k, v in row.items() if k != "criterion"} for row in deletions(run)]
            for run in (of_its_own, written)]
    assert rows[0] == rows[1]


@pytest.mark.parametrize("ranks", [1, 3])
def test_a_condition_of_a_number_that_is_none_stops_the_run(kerf, ranks):
    """Before it is stressed, an element has 0/0 there."""
    stopped = kerf(block([{"type": "expression", "expression": "pressure / von_mises > 3"}]), ranks=ranks,
                   completes=False)
    assert stopped.process.returncode == 3
    (line,) = [line for line in stopped.process.stderr.splitlines() if "the run stopped" in line]
    assert "expression" in line and "is none (NaN)" in line and "part block" in line and "element" in line, line
    guarded = kerf(block([{"type": "expression", "expression": "von_mises > 0 and pressure / von_mises < -0.3"}]),
                   ranks=ranks)
    assert guarded.summary["eroded"]["elements"] > 0
