"""Plugins of every kind outside of the tree: built from the build tree and from an installed Kerf, each acts as its law
says, and all of them together have the same bits on any number of ranks."""

import json
import math

import h5py
import numpy as np
import pytest

from plugin_case import BUILD, HERE, KERF, build, cached, call

NAMES = {"mesh": "tapered_rod", "measure": "tilt", "boundary": "turning_plane", "load": "drag",
         "contact": "closest_point", "partitioner": "slices", "balance_policy": "patient", "eos": "tait",
         "solid": "granular", "erosion": "distortion_energy"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return build(HERE / "kinds", tmp_path_factory.mktemp("kinds"), "")


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    """An installed Kerf, and the plugins that were built with what it has installed."""
    at = tmp_path_factory.mktemp("prefix")
    done = call("cmake", "--install", BUILD, "--prefix", at)
    assert done.returncode == 0, done.stdout + done.stderr
    built = tmp_path_factory.mktemp("kinds_of_prefix")
    done = call("cmake", "-G", "Ninja", "-S", HERE / "kinds", "-B", built, f"-DCMAKE_PREFIX_PATH={at}",
                f"-DCMAKE_CXX_COMPILER={cached('CMAKE_CXX_COMPILER')}")
    assert done.returncode == 0, done.stdout + done.stderr
    assert str(at) in (built / "CMakeCache.txt").read_text()
    done = call("cmake", "--build", built)
    assert done.returncode == 0, done.stdout + done.stderr
    return at, built


def run(folder, case, output, *options, program=KERF):
    (output.parent / "case.yaml").write_text(json.dumps(case))
    plugins = [word for name in NAMES.values() for word in ("--plugin", folder / f"{name}.so")]
    done = call(program, "run", output.parent / "case.yaml", *plugins, "--output", output, *options, cwd=output.parent)
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads((output / "summary.json").read_text())


STEEL = {"density": 7850, "strength": {"type": "elastic", "shear_modulus": 80e9},
         "eos": {"type": "linear", "bulk_modulus": 160e9}}


def all_kinds():
    """A tapered rod strikes a plate of sand at an angle, into gas, beside a drop that a plane sweeps away."""
    brittle = STEEL | {"erosion": {"criteria": [{"type": "distortion_energy", "shear_modulus": 80e9, "limit": 1.0e6}]}}
    sand = {"density": 1800, "solid": {"type": "granular", "shear_modulus": 1e9, "bulk_modulus": 2e9, "friction": 1.0}}
    water = {"density": 1000, "strength": {"type": "newtonian_fluid", "viscosity": 1e-3},
             "eos": {"type": "tait", "B": 300e6, "n": 7.15}}
    return {
        "time": {"end": 6e-6},
        "materials": {"steel": brittle, "sand": sand, "water": water},
        "parts": {
            "rod": {"mesh": {"type": "tapered_rod", "radius": 1e-3, "end_radius": 2e-3, "length": 10e-3,
                             "cell_size": 0.5e-3, "ratio": 1.5}, "material": "steel", "velocity": [0, 0, -600],
                    "placement": [{"angle": 0.1, "axis": [0, 1, 0]}]},
            "plate": {"mesh": {"type": "block", "size": [12e-3, 12e-3, 3e-3], "origin": [-6e-3, -6e-3, -3.3e-3],
                               "cells": [16, 16, 4]}, "material": "sand"},
            "drop": {"mesh": {"type": "block", "size": [3e-3, 3e-3, 3e-3], "origin": [10e-3, 0, 0],
                              "cells": [6, 6, 6]}, "material": "water"}},
        "boundaries": [{"type": "turning_plane", "nodes": ["drop"], "point": [4e-3, 0, 0], "normal": [0, 0, 1],
                        "axis": [0, 1, 0], "rate": -2e4}],
        "loads": [{"type": "drag", "facets": ["rod"], "density": 1.2}],
        "contacts": [{"type": "closest_point", "slave": ["rod"], "master": ["plate"], "friction": 0.1},
                     {"type": "closest_point", "slave": ["plate"], "master": ["rod"]}],
        "measures": {"tilt": {"type": "tilt", "part": "rod", "direction": [0, 0, 1]}},
        "balance": {"partitioner": {"type": "slices", "direction": [1, 0, 0]},
                    "policy": {"type": "patient", "threshold": 1.0001, "interval": 5, "patience": 2}},
        "output": {"precision": "double"}}


@pytest.mark.parametrize("kind", NAMES)
def test_each_is_listed_with_its_kind(folder, kind):
    done = call(KERF, "describe", kind, NAMES[kind], "--plugin", folder / f"{NAMES[kind]}.so")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"{NAMES[kind]} ({kind}): ")


def test_all_kinds_together_have_the_same_bits_on_any_number_of_ranks(folder, tmp_path):
    summaries = {}
    for n in (1, 2, 3):
        (tmp_path / str(n)).mkdir()
        summaries[n] = run(folder, all_kinds(), tmp_path / str(n) / "out", "--ranks", n)
    assert all(s["exit"] == "completed" for s in summaries.values())
    assert len({s["state_hash"] for s in summaries.values()}) == 1
    one = summaries[1]
    assert one["eroded"]["by_criterion"]["distortion_energy"] > 0
    assert one["measures"]["tilt"] > 0.05
    assert len(summaries[3]["rebalances"]) > 1, "the policy has moved the mesh after the first distribution"


def test_built_with_an_installed_kerf_they_compute_the_same(folder, prefix, tmp_path):
    at, built = prefix
    for name in ("tree", "prefix"):
        (tmp_path / name).mkdir()
    tree = run(folder, all_kinds(), tmp_path / "tree" / "out", "--ranks", 2)
    installed = run(built, all_kinds(), tmp_path / "prefix" / "out", "--ranks", 2, program=at / "bin" / "kerf")
    assert installed["state_hash"] == tree["state_hash"]


def test_the_policy_goes_on_after_a_restart(folder, tmp_path):
    settings = ("--ranks", 2, "--set", "output.restart_interval=4 us", "--set", "output.restart_at_end=false")
    whole = run(folder, all_kinds(), tmp_path / "out", *settings)
    resumed = run(folder, all_kinds(), tmp_path / "out", "--resume", *settings)
    assert resumed["state_hash"] == whole["state_hash"]
    moves = [r["cycle"] for r in whole["rebalances"]]
    later = [r["cycle"] for r in resumed["rebalances"] if r["cycle"] > 0]
    assert later and moves[-len(later):] == later


def test_the_mass_of_a_tapered_rod(folder, tmp_path):
    rod = {"type": "tapered_rod", "radius": 2e-3, "end_radius": 4e-3, "length": 12e-3, "cell_size": 1e-3}
    case = {"time": {"end": 1e-8}, "materials": {"steel": STEEL},
            "parts": {"rod": {"mesh": rod, "material": "steel", "velocity": [0, 0, 1]}},
            "measures": {"momentum": {"type": "part_momentum", "part": "rod"}}}
    mass = run(folder, case, tmp_path / "out")["measures"]["momentum.z"]
    corners = 16  # of the rim: 8 for each of the two cells from the axis to a side of the core
    polygon = corners / 2 * math.sin(2 * math.pi / corners)  # in place of pi
    exact = 7850 * polygon * 12e-3 / 3 * (2e-3**2 + 2e-3 * 4e-3 + 4e-3**2)
    assert mass == pytest.approx(exact, rel=1e-12)  # cells with straight edges fill the polygon exactly


def test_drag_slows_a_block_down_as_its_equation_says(folder, tmp_path):
    """m dv/dt = -C/2 rho A v^2, so that v = v0 / (1 + C rho A v0 t / (2 m))."""
    soft = {"density": 100, "strength": {"type": "elastic", "shear_modulus": 1e9},
            "eos": {"type": "linear", "bulk_modulus": 2e9}}
    case = {"time": {"end": 1e-3}, "materials": {"foam": soft},
            "parts": {"body": {"mesh": {"type": "block", "size": [0.01, 0.01, 0.01], "cells": [2, 2, 2]},
                               "material": "foam", "velocity": [400, 0, 0]}},
            "loads": [{"type": "drag", "facets": ["body"], "density": 2.0}],
            "measures": {"momentum": {"type": "part_momentum", "part": "body"}}}
    s = run(folder, case, tmp_path / "out")
    mass, area, c, rho = 100 * 0.01**3, 0.01**2, 2.0, 2.0
    exact = mass * 400 / (1 + c * rho * area * 400 / (2 * mass) * 1e-3)
    # The pressure, 0.3 MPa, compresses the block by 1e-4 and lets its face swing by 1e-3 of the speed.
    assert s["measures"]["momentum.x"] == pytest.approx(exact, rel=1e-3)


def test_tilt_is_the_angle_of_the_placement(folder, tmp_path):
    rod = {"type": "tapered_rod", "radius": 1e-3, "end_radius": 1e-3, "length": 8e-3, "cell_size": 0.5e-3}
    case = {"time": {"end": 1e-8}, "materials": {"steel": STEEL},
            "parts": {"rod": {"mesh": rod, "material": "steel", "placement": [{"angle": 0.3, "axis": [0, 1, 0]}]}},
            "measures": {"tilt": {"type": "tilt", "part": "rod", "direction": [0, 0, 2]}}}
    # The axis is found as an eigenvector of second moments, from sums whose round-off is far below this.
    assert run(folder, case, tmp_path / "out")["measures"]["tilt"] == pytest.approx(0.3, abs=1e-9)


def test_no_node_comes_to_lie_behind_the_turning_plane(folder, tmp_path):
    end, rate = 20e-6, -5e3
    case = {"time": {"end": end}, "materials": {"steel": STEEL},
            "parts": {"body": {"mesh": {"type": "block", "size": [4e-3, 2e-3, 2e-3], "origin": [4e-3, 0, 0],
                                        "cells": [4, 2, 2]}, "material": "steel"}},
            "boundaries": [{"type": "turning_plane", "point": [0, 0, 0], "normal": [0, 0, 1], "axis": [0, 1, 0],
                            "rate": rate}],
            "output": {"precision": "double"}}
    s = run(folder, case, tmp_path / "out")
    with h5py.File(tmp_path / "out" / "results.vtkhdf") as file:
        points = file["VTKHDF/Points"][-45:]
    normal = np.array([math.sin(rate * s["end_time"]), 0.0, math.cos(rate * s["end_time"])])
    heights = points @ normal
    assert heights.min() > -1e-12  # round-off of placing a node at some millimetres
    assert points[:, 2].min() > 1e-4, "the plane has lifted the body"
