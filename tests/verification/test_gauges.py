"""Gauges, section forces and reactions against closed forms."""

import math

import h5py
import numpy as np
import pytest

from test_plate_impact import C_ELASTIC, C_PLASTIC, HEL, PRESSURE, RHO, SIGMA, SPEED, TOLERANCE, Y

PLATE = "plate_impact/plate_impact.yaml"
X = 2.0e-3  # place of the gauges in the target [m]
AREA = 0.2e-3**2


def columns(run, observer):
    with h5py.File(run.folder / "history.h5") as file:
        return {name: data[()] for name, data in file[observer].items()}


@pytest.fixture(scope="module")
def plates(kerf):
    place = f'"[{X}, 0.1e-3, 0.1e-3] m"'
    return kerf(PLATE, f"observers.cell={{type: gauge, part: target, point: {place}, "
                "quantities: [stress, pressure, von_mises]}",
                f"observers.node={{type: gauge, at: node, part: target, point: {place}, quantities: [velocity]}}",
                f"observers.space={{type: gauge, motion: fixed, part: target, point: {place}, quantities: [stress]}}",
                f"observers.section={{type: section_force, part: target, point: {place}, normal: 1 0 0}}",
                "output.history_interval=5 ns")


def behind_both_waves(c):
    """Well after the plastic wave has passed, and before waves from the rear faces, 10 mm off, come back."""
    return (c["time"] > X / C_PLASTIC + 0.3e-6) & (c["time"] < 1.5e-6)


def test_a_gauge_shows_the_plateau_of_stress_and_pressure(plates):
    c = columns(plates, "cell")
    plateau = behind_both_waves(c)
    assert plateau.sum() > 50
    assert -c["stress_xx"][plateau].mean() == pytest.approx(SIGMA, rel=TOLERANCE)
    assert c["pressure"][plateau].mean() == pytest.approx(PRESSURE, rel=TOLERANCE)
    assert np.allclose(c["von_mises"][plateau], Y, rtol=2e-3)  # hardening: 0.1 GPa times 1e-3


def test_a_gauge_moves_with_its_material_and_a_fixed_one_does_not(plates):
    c, fixed = columns(plates, "cell"), columns(plates, "space")
    assert len(set(c["id"])) == 1
    # Material moves at HEL / (rho c) between the two waves, and at half the speed of the impact behind them.
    x = c["position_x"][0]
    moved = HEL / (RHO * C_ELASTIC) * (x / C_PLASTIC - x / C_ELASTIC) + SPEED / 2.0 * (c["time"][-1] - x / C_PLASTIC)
    assert c["position_x"][-1] - x == pytest.approx(moved, rel=TOLERANCE)
    assert np.abs(fixed["position_x"] - X).max() < 0.1e-3  # never more than a cell off
    assert -fixed["stress_xx"][behind_both_waves(fixed)].mean() == pytest.approx(SIGMA, rel=TOLERANCE)


def test_a_node_has_half_the_speed_of_the_impact_behind_the_waves(plates):
    c = columns(plates, "node")
    assert c["velocity_x"][behind_both_waves(c)].mean() == pytest.approx(SPEED / 2.0, rel=TOLERANCE)


def test_waves_arrive_at_a_gauge_when_they_should(plates):
    c = columns(plates, "cell")
    for level, speed in ((HEL / 2.0, C_ELASTIC), ((HEL + SIGMA) / 2.0, C_PLASTIC)):
        arrival = c["time"][np.nonzero(-c["stress_xx"] > level)[0][0]]
        cell = 0.1e-3
        # The gauge's value is that of a cell's centre, up to half a cell from X; fronts are some cells wide.
        assert arrival == pytest.approx(X / speed, abs=1.5 * cell / speed)


def test_a_section_hands_on_stress_times_area(plates):
    c = columns(plates, "section")
    plateau = behind_both_waves(c)
    # Compression: what lies ahead pushes back. The moment about the middle of the section is zero by symmetry.
    assert c["force_x"][plateau].mean() == pytest.approx(-SIGMA * AREA, rel=TOLERANCE)
    assert np.array_equal(c["normal_force"], c["force_x"])
    assert np.abs(c["moment_y"][plateau]).max() < 1e-6 * SIGMA * AREA * 0.2e-3


def block(**more):
    """A free block that flies against a rigid wall."""
    return {"time": {"end": 20e-6},
            "materials": {"metal": {"density": 7850, "strength": {"type": "elastic", "shear_modulus": 80e9},
                                    "eos": {"type": "linear", "bulk_modulus": 160e9}}},
            "parts": {"bar": {"material": "metal", "velocity": [-20, 0, 0],
                              "mesh": {"type": "block", "size": [40e-3, 10e-3, 10e-3], "cells": [32, 6, 6]}}},
            "boundaries": [{"type": "rigid_wall", "point": [0, 0, 0], "normal": [1, 0, 0]}],
            "output": {"history_interval": 0.1e-6}, **more}


@pytest.fixture(scope="module")
def bar(kerf):
    cut = {"type": "section_force", "part": "bar", "normal": [1, 0, 0]}
    return kerf(block(observers={
        "wall": {"type": "reactions"}, "whole": {"type": "part_history"},
        "cut": cut | {"point": [20e-3, 5e-3, 5e-3]}, "far": cut | {"point": [20e-3, 25e-3, 5e-3]}}))


def test_a_wall_gives_back_the_momentum_that_it_took(bar):
    wall, whole = columns(bar, "wall"), columns(bar, "whole")
    gained = whole["bar.momentum_x"] - whole["bar.momentum_x"][0]
    scale = np.abs(whole["bar.momentum_x"][0])
    assert np.abs(gained).max() > scale  # it has turned round
    # Impulses are counted in quanta of 2^-51 of the model's momentum, one for each of 49 nodes and each step.
    assert np.abs(wall["rigid_wall_1.impulse_x"] - gained).max() < 1e-10 * scale
    assert bar.summary["momentum"]["external_impulse"][0] == wall["rigid_wall_1.impulse_x"][-1]
    force = wall["rigid_wall_1.force_x"]
    assert np.allclose(np.cumsum(force[1:] * np.diff(wall["time"])), wall["rigid_wall_1.impulse_x"][1:],
                       rtol=0, atol=1e-10 * scale)


def test_the_section_of_a_struck_bar_carries_rho_c_v(bar):
    """The plateau of a long bar: sigma = rho c v with c = sqrt(E / rho), until the wave comes back from the end."""
    k, g, rho, v = 160e9, 80e9, 7850.0, 20.0
    young = 9.0 * k * g / (3.0 * k + g)
    c = math.sqrt(young / rho)
    cut = columns(bar, "cut")
    plateau = (cut["time"] > 1.6 * 20e-3 / c) & (cut["time"] < 2.6 * 20e-3 / c)
    assert plateau.sum() >= 15
    # The bar is only four diameters long, so radial inertia makes the plateau wavy; its mean is what theory says.
    assert -cut["normal_force"][plateau].mean() == pytest.approx(rho * c * v * 1e-4, rel=0.05)


def test_moments_of_a_section_are_about_the_point(bar):
    cut, far = columns(bar, "cut"), columns(bar, "far")
    assert np.array_equal(cut["force_x"], far["force_x"])
    # Moved by -20 mm along y: the moment about z grows by that times the force.
    expected = cut["moment_z"] + 20e-3 * cut["force_x"]
    assert np.allclose(far["moment_z"], expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_a_body_in_free_fall_hands_on_nothing(kerf):
    """Gravity acts on all nodes alike, so elements need not push: a section without loads in it shows no force."""
    model = block(loads=[{"type": "gravity", "acceleration": [-1e5, 0, 0]}],
                  observers={"cut": {"type": "section_force", "part": "bar", "point": [20e-3, 5e-3, 5e-3],
                                     "normal": [1, 0, 0]}, "whole": {"type": "part_history"}})
    model["boundaries"] = []
    run = kerf(model)
    cut, whole = columns(run, "cut"), columns(run, "whole")
    weight = 7850 * 2e-6 * 1e5  # of what lies behind: half of the bar [N]
    # Positions are rounded to some 1e-17 m, which a stiffness of E times 3 mm makes up to 1e-5 N in a cell.
    assert np.abs(cut["normal_force"]).max() < 1e-6 * weight
    gained = whole["bar.momentum_x"][-1] - whole["bar.momentum_x"][0]
    assert gained == pytest.approx(-2.0 * weight * whole["time"][-1], rel=5e-3)  # momenta are half a step older


@pytest.mark.parametrize("ranks", [1, 3])
def test_joined_parts_share_mass_momentum_and_energy(kerf, ranks):
    """A bar of two parts, of which the second is denser: the layer of shared nodes counts for both by mass."""
    model = block(joined=[{"parts": ["bar", "rear"]}], boundaries=[],
                  observers={"whole": {"type": "part_history"},
                             "node": {"type": "gauge", "at": "node", "part": "rear", "quantities": ["velocity"],
                                      "point": [40e-3, 5e-3, 5e-3]}})
    model["materials"]["heavy"] = model["materials"]["metal"] | {"density": 15700}
    rear = {"type": "block", "origin": [40e-3, 0, 0], "size": [20e-3, 10e-3, 10e-3], "cells": [16, 6, 6]}
    model["parts"]["rear"] = {"material": "heavy", "velocity": [-20, 0, 0], "mesh": rear}
    run = kerf(model, ranks=ranks)
    whole, history = columns(run, "whole"), run.history
    mass = {"bar": 7850 * 4e-6, "rear": 15700 * 2e-6}
    for part in mass:
        # The bar flies on without a force; sums of some thousand nodes are exact but for the rounding of each term.
        assert np.allclose(whole[f"{part}.momentum_x"], -20 * mass[part], rtol=1e-9)
        assert np.allclose(whole[f"{part}.kinetic"], 200 * mass[part], rtol=1e-9)
        assert np.allclose(whole[f"{part}.velocity_x"], -20, rtol=1e-12)
        assert whole[f"{part}.velocity_x"][-1] == pytest.approx(run.summary["parts"][part]["velocity"][0], rel=1e-14)
    both = whole["bar.kinetic"] + whole["rear.kinetic"]
    assert np.allclose(both, history["kinetic"], rtol=1e-13)
    # The nearest node of the rear part is a shared one, on the interface.
    assert columns(run, "node")["position_x"][0] == pytest.approx(40e-3, rel=1e-12)
