"""Loads give the same bits on any number of ranks, through erosion of what they press, re-balancing and restart."""

import json

import pytest

from test_state_hash import expect_same, partitioned, run

# A plate, held at its rim, is pushed through by a pressure that erodes its way in.
PLATE = {
    "title": "a plate under pressure",
    "time": {"end": "12 us"},
    "materials": {"metal": {
        "density": 7850,
        "strength": {"type": "elastic_plastic", "shear_modulus": 80e9, "yield_stress": 0.4e9,
                     "hardening_modulus": 0.2e9},
        "eos": {"type": "linear", "bulk_modulus": 160e9},
        "erosion": {"criteria": [{"type": "plastic_strain", "limit": 0.12}, {"type": "inversion"}]}}},
    "parts": {
        "plate": {"material": "metal", "mesh": {"type": "block", "size": "[12, 10, 3] mm", "cells": [12, 10, 3]}},
        "drop": {"material": "metal", "velocity": "0 0 300 m/s",
                 "mesh": {"type": "block", "size": "[3, 3, 2] mm", "origin": "[5, 4, -2.01] mm", "cells": [3, 3, 2]}}},
    "sets": {"rim": {"parts": "plate", "box": "[-1, -1, -1, 1.5, 11, 4] mm"},
             "far_rim": {"parts": "plate", "box": "[10.5, -1, -1, 13, 11, 4] mm"},
             "middle": {"parts": "plate", "box": "[2.9, 2.9, 2.9, 9.1, 7.1, 3.1] mm"},
             "edge": {"parts": "plate", "face": "y_min"}},
    "boundaries": [{"type": "fixed", "nodes": ["rim", "far_rim"]}],
    "contacts": [{"type": "eroding_surface"}],
    "curves": {"push": {"times": "[0, 2, 6] us", "values": [0.1, 1, 0.6]},
               "shake": {"times": "[0, 1] us", "values": [-1, 1], "period": "1.5 us"}},
    "loads": [{"type": "pressure", "facets": "middle", "pressure": "3 GPa", "curve": "push", "follow_erosion": True},
              {"type": "gravity", "acceleration": [3e7, 0, -1e7], "curve": "shake"},
              {"type": "pressure", "facets": "drop", "pressure": "200 MPa"},
              {"type": "nodal_force", "nodes": "edge", "force": [0, 300, 0], "curve": "push"}],
    "balance": {"force_interval": 7},
    "checks": {"energy_growth": 0.5, "free_nodes": "keep"},
    "output": {"results_interval": "20 us", "history_interval": "0.5 us"},
}


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    path = tmp_path_factory.mktemp("case") / "plate.yaml"
    path.write_text(json.dumps(PLATE))
    return [path]


@pytest.fixture(scope="module")
def one(case, tmp_path_factory):
    return run(case, tmp_path_factory.mktemp("one"))


@pytest.mark.parametrize("ranks, partitioner",
                         [(2, "zoltan_rcb"), (3, "zoltan_hsfc"), (5, "zoltan_graph"), (5, "none")])
def test_loads_have_the_same_bits_on_any_number_of_ranks(case, one, tmp_path, ranks, partitioner):
    results = run(case, tmp_path, ranks, partitioned(partitioner))
    assert len(results.summary["rebalances"]) > 5
    expect_same(results, one)


def test_pressure_goes_through_what_it_erodes(case, one, tmp_path):
    """Otherwise the tests above would show little: following makes another run, which erodes more."""
    assert one.summary["eroded"]["by_part"]["plate"] > 20
    stays = run(case, tmp_path, 2, ["loads.0.follow_erosion=false"])
    assert stays.summary["state_hash"] != one.summary["state_hash"]
    assert stays.summary["eroded"]["by_part"]["plate"] < one.summary["eroded"]["by_part"]["plate"]


@pytest.mark.parametrize("before, after", [(1, 3), (3, 1), (5, 2)])
def test_restart_loses_no_load(case, one, tmp_path, before, after):
    settings = ["output.restart_interval=5 us"]  # amid erosion
    expect_same(run(case, tmp_path, before, settings), one)
    expect_same(run(case, tmp_path, after, settings, resume=True), one)


def test_restart_with_dropped_nodes_loses_no_load(case, tmp_path):
    settings = ["output.restart_interval=5 us", "checks.free_nodes=drop"]
    whole = run(case, tmp_path, 2, settings)
    assert whole.summary["mass"]["dropped"] > 0.0
    expect_same(run(case, tmp_path, 3, settings, resume=True), whole)


def test_loads_are_in_the_balance_of_momentum(one):
    m = one.summary["momentum"]
    missing = [f + e - i - x for f, e, i, x in zip(m["final"], m["eroded"], m["initial"], m["external_impulse"])]
    # Thousands of nodes and hundreds of steps, each rounded by 1e-16.
    assert max(map(abs, missing)) < 1e-12 * max(map(abs, m["final"] + m["external_impulse"]))


def test_a_restart_with_another_curve_is_refused(case, tmp_path):
    run(case, tmp_path, 1, ["time.maximum_cycles=3"])
    run(case, tmp_path, 1, ["curves.push.values=[0.1, 1, 0.5]"], resume=True, expect=2)
    run(case, tmp_path, 1, ["loads.0.pressure=2 GPa"], resume=True, expect=2)


def test_a_restart_with_another_curve_file_is_refused(tmp_path):
    model = {**PLATE, "curves": {**PLATE["curves"], "push": {"file": "push.csv"}}}
    (tmp_path / "plate.yaml").write_text(json.dumps(model))
    (tmp_path / "push.csv").write_text("0,0.1\n2e-6,1\n6e-6,0.6\n")
    case = [tmp_path / "plate.yaml"]
    run(case, tmp_path / "out", 2, ["time.maximum_cycles=3"])
    run(case, tmp_path / "out", 3, ["time.maximum_cycles=6"], resume=True)
    (tmp_path / "push.csv").write_text("0,0.1\n2e-6,1\n6e-6,0.5\n")
    run(case, tmp_path / "out", 2, ["time.maximum_cycles=9"], resume=True, expect=2)


def test_a_curve_from_a_file_is_the_table_in_place(case, one, tmp_path):
    path = tmp_path / "plate.yaml"
    path.write_text(json.dumps({**PLATE, "curves": {**PLATE["curves"], "push": {
        "file": "data/push.csv", "columns": ["t", "factor"], "time_scale": 1e-6}}}))
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "push.csv").write_text("factor,t\n0.1,0\n1,2\n0.6,6\n")
    results = run([path], tmp_path / "out", 2)
    assert results.summary["state_hash"] == one.summary["state_hash"]


def test_contact_may_have_a_partitioner_of_its_own(case, one, tmp_path):
    results = run(case, tmp_path, 3, ["balance.contact_partitioner={type: zoltan_rcb, imbalance_tolerance: 1.5}"])
    expect_same(results, one)
