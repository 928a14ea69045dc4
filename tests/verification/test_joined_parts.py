"""Parts that share nodes: the same bits as one part of the same mesh, waves across interfaces, and many parts."""

import copy
import json
import math
import subprocess

import numpy as np
import pytest

METAL = {
    "density": 7850,
    "strength": {"type": "elastic_plastic", "shear_modulus": 80e9, "yield_stress": 1e9, "hardening_modulus": 0.3e9},
    "eos": {"type": "linear", "bulk_modulus": 160e9},
    "erosion": {"criteria": [{"type": "geometric_strain", "limit": 0.25}, {"type": "inversion"}]},
}
FIELDS = {"precision": "double", "node_fields": ["velocity", "mass"], "element_fields": ["stress", "internal_energy"]}
OFTEN = ["balance.force_interval=7"]  # moves elements many times


def block(first, last, material="metal", **more):
    """Cells of 1 mm between two corners, given in cells."""
    cells = [b - a for a, b in zip(first, last)]
    mesh = {"type": "block", "origin": [1e-3 * a for a in first], "size": [1e-3 * n for n in cells], "cells": cells}
    return {"material": material, "mesh": mesh, **more}


def impact(parts, joined):
    """A small body strikes a block, which is of one part or of several."""
    striker = {"material": "metal", "velocity": [100, 50, -1500],
               "mesh": {"type": "block", "origin": [1.3e-3, 0.2e-3, 6.01e-3], "size": [2e-3, 1e-3, 2e-3],
                        "cells": [2, 1, 2]}}
    return copy.deepcopy({
        "time": {"end": 5e-6},
        "materials": {"metal": METAL},
        "parts": {"striker": striker, **parts},
        **({"joined": joined} if joined else {}),
        "sets": {"bottom": {"face": "z_min", "box": [-1, -1, -1e-6, 1, 1, 1e-6]}},
        "boundaries": [{"type": "fixed", "nodes": "bottom"}, {"type": "symmetry", "normal": [1, 0, 0]}],
        "contacts": [{"type": "eroding_surface"}],
        "checks": {"energy_growth": 0.5, "free_nodes": "keep"},
        "output": {**FIELDS, "results_interval": 1e-6},
    })


WHOLE = {"block": block((0, 0, 0), (5, 4, 6))}
# Layers: elements and nodes are numbered as in one block, so that even the hash of the state is the same.
LAYERS = {"low": block((0, 0, 0), (5, 4, 3)), "high": block((0, 0, 3), (5, 4, 6))}
LAYERS_JOINED = [{"parts": ["low", "high"]}]
# Pieces that are numbered in another way, with edges in which three of them meet.
PIECES = {
    "corner": block((2, 0, 3), (5, 4, 6)),
    "low": block((0, 0, 0), (5, 4, 3)),
    "side": block((0, 0, 3), (2, 4, 6)),
}
PIECES_JOINED = [{"parts": ["low", "corner"]}, {"parts": ["side", "low", "corner"]}]


def frame_by_place(run, frame, places):
    """All fields of a frame, nodes and cells in the order of their undeformed places."""
    results = run.results
    undeformed = results.points(0)
    nodes = np.lexsort(np.round(undeformed / 1e-7).T)
    cells = np.lexsort(np.round(results.centres(0) / 1e-7).T)
    assert len(undeformed) == places
    return {
        "points": results.points(frame)[nodes],
        **{name: results.node(name, frame)[nodes] for name in FIELDS["node_fields"]},
        **{name: results.cell(name, frame)[cells] for name in [*FIELDS["element_fields"], "alive"]},
    }


N_NODES = 6 * 5 * 7 + 3 * 2 * 3


@pytest.fixture(scope="module")
def whole(kerf):
    run = kerf(impact(WHOLE, None))
    assert run.summary["eroded"]["elements"] > 5
    return run


def assert_same_bits(run, whole):
    assert run.summary["cycles"] == whole.summary["cycles"]
    assert run.summary["eroded"]["elements"] == whole.summary["eroded"]["elements"]
    for key, value in whole.summary["energy"].items():
        assert run.summary["energy"][key] == value, key
    assert len(run.results.times) == len(whole.results.times)
    for frame in range(len(whole.results.times)):
        expected = frame_by_place(whole, frame, N_NODES)
        for name, values in frame_by_place(run, frame, N_NODES).items():
            assert np.array_equal(values, expected[name]), (name, frame)


@pytest.mark.parametrize("ranks", [1, 2, 3, 5])
def test_joined_layers_have_the_bits_of_one_block_through_impact_and_erosion(kerf, whole, ranks):
    run = kerf(impact(LAYERS, LAYERS_JOINED), *OFTEN, ranks=ranks)
    assert_same_bits(run, whole)
    assert run.summary["state_hash"] == whole.summary["state_hash"]


@pytest.mark.parametrize("ranks", [1, 3])
def test_joined_pieces_numbered_in_another_way_do_not_change_between_ranks(kerf, ranks):
    first = kerf(impact(PIECES, PIECES_JOINED))
    run = kerf(impact(PIECES, PIECES_JOINED), *OFTEN, "balance.partitioner={type: zoltan_graph}", ranks=ranks)
    assert run.summary["state_hash"] == first.summary["state_hash"]
    assert_same_bits(run, first)


def elastic(parts, joined):
    """The block alone, whose nodes start with different velocities in two halves."""
    model = impact(parts, joined)
    del model["parts"]["striker"], model["contacts"], model["materials"]["metal"]["erosion"]
    model["materials"]["metal"]["strength"] = {"type": "elastic", "shear_modulus": 80e9}
    model["sets"]["upper"] = {"box": [-1, -1, 3.5e-3, 1, 1, 1]}
    model["boundaries"].append({"type": "initial_velocity", "nodes": "upper", "velocity": [30, 20, -100]})
    return model


@pytest.mark.parametrize("ranks", [1, 2, 3, 5])
def test_joined_pieces_have_the_bits_of_one_block_in_elastic_motion(kerf, ranks):
    whole, run = kerf(elastic(WHOLE, None)), kerf(elastic(PIECES, PIECES_JOINED), *OFTEN, ranks=ranks)
    assert whole.summary["energy"]["internal"] > 0.0
    for frame in range(len(whole.results.times)):
        expected = frame_by_place(whole, frame, 6 * 5 * 7)
        for name, values in frame_by_place(run, frame, 6 * 5 * 7).items():
            assert np.array_equal(values, expected[name]), (name, frame)


def command(binary, folder, ranks, *more):
    return [str(binary), "run", str(folder / "input.yaml"), "--output", str(folder), "--ranks", str(ranks), *more]


def test_joined_layers_have_the_same_bits_after_restart_on_other_ranks(binary, whole, tmp_path):
    (tmp_path / "input.yaml").write_text(json.dumps(impact(LAYERS, LAYERS_JOINED)))
    for ranks, more in ((3, ["--set", "time.end=2.3e-6"]), (2, ["--resume"])):
        done = subprocess.run(command(binary, tmp_path, ranks, *more), capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
    # A step ends at the time of the restart, so that only the same interrupted run on one rank has the same steps.
    interrupted = json.loads((tmp_path / "summary.json").read_text())
    alone = tmp_path / "alone"
    alone.mkdir()
    (alone / "input.yaml").write_text(json.dumps(impact(WHOLE, None)))
    for more in (["--set", "time.end=2.3e-6"], ["--resume"]):
        done = subprocess.run(command(binary, alone, 1, *more), capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
    assert interrupted["state_hash"] == json.loads((alone / "summary.json").read_text())["state_hash"]
    assert interrupted["eroded"]["elements"] == whole.summary["eroded"]["elements"]


def test_masses_and_momenta_of_joined_parts_add_up_to_those_of_the_model(kerf):
    model = impact(LAYERS, LAYERS_JOINED)
    model["materials"]["light"] = {**METAL, "density": 2700}
    model["parts"]["high"]["material"] = "light"
    model["parts"]["high"]["velocity"] = [0, 0, 70]
    model["boundaries"] = []
    model["measures"] = {f"{kind}_{part}": {"type": kind, "part": part}
                         for kind in ("part_momentum", "kinetic_energy", "mass_lost") for part in model["parts"]}
    for ranks in (1, 3):
        run = kerf(model, ranks=ranks)
        s, m = run.summary, run.summary["measures"]
        # Free nodes keep mass in `measures`; in `parts` they do not count. Sums over some hundred nodes round.
        assert sum(m[f"kinetic_energy_{p}"] for p in model["parts"]) == pytest.approx(s["energy"]["kinetic"], rel=1e-2)
        for axis in range(3):
            total = sum(m[f"part_momentum_{p}.{'xyz'[axis]}"] for p in model["parts"])
            assert total == pytest.approx(s["momentum"]["final"][axis], abs=1e-9 * 0.1)
        for p, mass in (("low", 7850 * 60e-9), ("high", 2700 * 60e-9)):
            assert s["parts"][p]["mass"] + m[f"mass_lost_{p}"] == pytest.approx(mass, rel=1e-12)
        assert any("start with different velocities" in w for w in s["warnings"])


def test_a_wave_crosses_a_joined_interface_as_its_impedances_say(kerf):
    """A bar in uniaxial strain of two materials: of a step of velocity v in the first, the second gets
    2 Z1 / (Z1 + Z2) v, and - (Z2 - Z1) / (Z2 + Z1) v comes back on top of v (e.g. Achenbach, Wave Propagation in
    Elastic Solids, 1973, section 1.4)."""
    n, cell = 200, 1e-3
    stiff = {"density": 8000, "bulk": 160e9, "shear": 80e9}
    soft = {"density": 2700, "bulk": 70e9, "shear": 26e9}

    def impedance(m):
        return math.sqrt(m["density"] * (m["bulk"] + 4.0 / 3.0 * m["shear"]))

    def law(m):
        return {"density": m["density"], "strength": {"type": "elastic", "shear_modulus": m["shear"]},
                "eos": {"type": "linear", "bulk_modulus": m["bulk"]}}

    def bar(first, material):
        return {"material": material, "mesh": {"type": "block", "origin": [0, 0, first * cell],
                                               "size": [cell, cell, n * cell], "cells": [1, 1, n]}}

    speed = math.sqrt((stiff["bulk"] + 4.0 / 3.0 * stiff["shear"]) / stiff["density"])
    arrival = n * cell / speed
    model = {
        "time": {"end": 1.5 * arrival},
        "materials": {"stiff": law(stiff), "soft": law(soft)},
        "parts": {"first": bar(0, "stiff"), "second": bar(n, "soft")},
        "joined": [{"parts": ["first", "second"]}],
        "sets": {"end": {"parts": "first", "face": "z_min"}},
        "boundaries": [
            *({"type": "symmetry", "normal": normal, "point": point} for normal, point in (
                ([1, 0, 0], [0, 0, 0]), ([-1, 0, 0], [cell, 0, 0]),
                ([0, 1, 0], [0, 0, 0]), ([0, -1, 0], [0, cell, 0]))),
            {"type": "prescribed_motion", "nodes": "end", "velocity": [0, 0, 1.0]},
        ],
        "output": {**FIELDS, "results_interval": 1.5 * arrival},
    }
    run = kerf(model, ranks=2)
    z, v = run.results.points(-1)[:, 2] / cell, run.results.node("velocity", -1)[:, 2]
    ratio = 2 * impedance(stiff) / (impedance(stiff) + impedance(soft))
    # Both waves are about 80 cells long; within 20 cells of the interface nothing but the two plateaus is seen.
    near = v[(np.abs(z - n) < 20)]
    print("transmitted", near.mean(), "of", ratio)
    assert near.mean() == pytest.approx(ratio, rel=2e-3)  # viscosity smears fronts, not plateaus
    assert np.abs(near - ratio).max() < 0.03 * ratio  # overshoot that the front has left behind
    pressure_free = run.results.cell("stress", -1)
    side = np.abs(run.results.centres(-1)[:, 2] / cell - n) < 20
    stress = -impedance(soft) * ratio * 1.0
    axial = pressure_free[:, 2][side]
    assert axial.mean() == pytest.approx(stress, rel=5e-3)  # traction is the same on both sides


def test_a_bonded_body_whose_one_side_erodes_leaves_the_other_in_contact(kerf):
    """The coating of a block is destroyed by a striker, which then meets the block beneath."""
    weak = {**METAL, "erosion": {"criteria": [{"type": "geometric_strain", "limit": 0.05}]}}
    model = impact({"base": block((0, 0, 0), (5, 4, 5)), "coating": block((0, 0, 5), (5, 4, 6), "weak")},
                   [{"parts": ["base", "coating"]}])
    model["materials"]["weak"] = weak
    del model["materials"]["metal"]["erosion"]
    model["time"]["end"] = 8e-6
    model["measures"] = {"momentum": {"type": "part_momentum", "part": "base"}}
    model["parts"]["striker"]["velocity"] = [0, 0, -700]
    one, three = (kerf(model, *OFTEN, ranks=ranks) for ranks in (1, 3))
    assert one.summary["state_hash"] == three.summary["state_hash"]
    eroded = one.summary["eroded"]["by_part"]
    assert eroded.get("coating", 0) >= 4 and eroded.get("base", 0) == 0
    # The striker bounces off the base, which no surface would stop it at if the uncovered faces were not in contact.
    z = one.results.points(-1)[one.results.cells[one.results.part == 0]][..., 2]
    assert z.min() > 4e-3
    assert one.summary["parts"]["striker"]["velocity"][2] > -350


def test_more_than_64_parts_sets_and_boundaries(kerf):
    n = 70
    model = {
        "time": {"end": 2e-6},
        "materials": {"metal": METAL},
        "parts": {f"p{k}": block((2 * k, 0, 0), (2 * k + 1, 1, 2), velocity=[0, 0, 10 + k]) for k in range(n)},
        "sets": {f"s{k}": {"parts": f"p{k}", "face": "z_min"} for k in range(n)},
        "boundaries": [{"type": "fixed", "nodes": f"s{k}"} for k in range(n)],
        "contacts": [{"type": "eroding_surface"}],
        "output": {**FIELDS, "results_interval": 1e-6},
    }
    one, three = kerf(model), kerf(model, *OFTEN, ranks=3)
    assert one.summary["state_hash"] == three.summary["state_hash"]
    z0, z, v = one.results.points(0)[:, 2], one.results.points(-1)[:, 2], one.results.node("velocity", -1)[:, 2]
    assert np.array_equal(z[z0 == 0.0], z0[z0 == 0.0]) and len(z0) == 12 * n
    assert np.all(v[z0 == 0.0] == 0.0) and np.all(v[z0 > 1.5e-3] != 0.0)


@pytest.mark.parametrize("joined, message", [
    ([{"parts": ["low", "hihg"]}], 'there is no part "hihg"; did you mean `high`?'),
    ([{"parts": ["low", "low"]}], "part low cannot be joined with itself"),
    ([{"parts": ["low"]}], "at least two parts are needed to join anything"),
    ([{"parts": ["low", "striker"]}], "no node of part low is within"),
    ([{"parts": ["low", "high"], "tolerance": "0.7 mm"}], "would join nodes of one cell"),
    ([{"parts": ["low", "high"], "tolerance": "-1 mm"}], "tolerance"),
])
def test_what_cannot_be_joined_is_refused(binary, tmp_path, joined, message):
    (tmp_path / "input.yaml").write_text(json.dumps(impact(LAYERS, joined), indent=1))
    done = subprocess.run(command(binary, tmp_path, 1), capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert message in done.stderr and "input.yaml:" in done.stderr
