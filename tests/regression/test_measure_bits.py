"""Measures have the same bits on any number of ranks, with parts that share nodes and nodes that were dropped."""

import json

import pytest

from test_state_hash import run

CASE = {
    "title": "a rod through a plate that is joined to a frame, far from the origin",
    "time": {"end": "12 us"},
    "materials": {name: {
        "density": 7850,
        "strength": {"type": "elastic_plastic", "shear_modulus": "80 GPa", "yield_stress": "0.8 GPa"},
        "eos": {"type": "linear", "bulk_modulus": "160 GPa"},
        "erosion": {"criteria": [{"type": "plastic_strain", "limit": limit}, {"type": "inversion"}]}}
        for name, limit in (("soft", 0.5), ("hard", 0.8))},
    "parts": {
        "plate": {"material": "soft", "mesh": {"type": "block", "origin": "-10 -10 50 mm", "size": "20 20 3 mm",
                                               "cell_size": "1 mm"}},
        "frame": {"material": "hard", "mesh": {"type": "block", "origin": "10 -10 50 mm", "size": "3 20 3 mm",
                                               "cell_size": "1 mm"}},
        "rod": {"material": "hard", "velocity": "300 0 -1500 m/s", "placement": [{"translate": "0 0 53.1 mm"}],
                "mesh": {"type": "cylinder", "radius": "2 mm", "length": "20 mm", "core_cells": 2, "ring_cells": 1,
                         "axial_cells": 20}}},
    "joined": [{"parts": ["plate", "frame"]}],
    "contacts": [{"type": "eroding_surface", "self_contact": True}],
    "balance": {"policy": {"type": "every", "interval": 10}},
    "measures": {
        "hole": {"type": "hole_diameter", "part": "plate"},
        "rod_length": {"type": "residual_length", "part": "rod"},
        "rod_extent": {"type": "residual_length", "part": "rod", "axis": [0, 0, 1]},
        "rod": {"type": "residual_velocity", "part": "rod"},
        "waist": {"type": "largest_radius", "part": "rod", "axis": [0, 0, 1], "at_height": 0.5, "point": "2 0 0 mm"},
        "frame": {"type": "part_momentum", "part": "frame"},
        "flight": {"type": "part_momentum", "part": "rod"},
        "plate_moves": {"type": "part_momentum", "part": "plate"},
        "plate_energy": {"type": "kinetic_energy", "part": "plate"},
        "frame_width": {"type": "final_length", "part": "frame", "axis": [1, 0, 0]},
        "lost": {"type": "mass_lost", "part": "plate"}},
}


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    path = tmp_path_factory.mktemp("measured") / "case.yaml"
    path.write_text(json.dumps(CASE))
    return path


@pytest.fixture(scope="module")
def alone(case, tmp_path_factory):
    return run([case], tmp_path_factory.mktemp("alone")).summary


def test_what_is_measured_is_there(alone):
    measured = alone["measures"]
    assert all(value is not None for value in measured.values()), alone["not_measured"]
    assert measured["hole.perforated"] == 1 and 4e-3 < measured["hole.entry_smallest"] < 12e-3
    assert measured["rod.z"] < -500 and 5e-3 < measured["rod_length"] < 20e-3
    assert abs(measured["frame.z"]) > 1e-6  # kg m/s: through the joint, the plate drags it along


@pytest.mark.parametrize("ranks, partitioner", [(2, "zoltan_rcb"), (3, "zoltan_hsfc"), (5, "block")])
def test_measures_have_the_same_bits_on_any_number_of_ranks(case, alone, tmp_path, ranks, partitioner):
    several = run([case], tmp_path, ranks, [f"balance.partitioner={{type: {partitioner}}}"]).summary
    assert several["state_hash"] == alone["state_hash"] and len(several["rebalances"]) > 3
    assert several["measures"] == alone["measures"]


def test_dropped_nodes_leave_the_undeformed_part_where_it_was(case, alone, tmp_path):
    dropped = run([case], tmp_path, 2, ["checks.free_nodes=drop"]).summary
    assert dropped["mass"]["dropped"] > 0
    assert dropped["not_measured"] == {}
    for name in ("hole.entry_smallest", "hole.exit_largest", "rod_length", "waist"):
        # Free nodes that are gone no longer hit what is left: the runs differ a little.
        assert dropped["measures"][name] == pytest.approx(alone["measures"][name], rel=0.1), name


def test_a_part_whose_nodes_were_all_dropped_has_no_momentum(case, tmp_path):
    settings = ["checks.free_nodes=drop", "materials.hard.erosion.criteria=[{type: minimum_time_step, limit: 1 s}]",
                "time.end=1 us"]
    gone = run([case], tmp_path, 2, settings).summary
    assert gone["parts"]["rod"]["alive"] == 0
    reason = "all nodes of part rod have been dropped"
    names = [name for name, why in gone["not_measured"].items() if why == reason]
    assert names == ["flight.x", "flight.y", "flight.z"]
