"""Free elastic bodies: energy over a thousand periods of an oscillation, and rigid spin."""

import math

import numpy as np
import pytest

RHO, E, NU = 7800.0, 200.0e9, 0.3
STEEL = {
    "density": RHO,
    "strength": {"type": "elastic", "shear_modulus": E / (2 * (1 + NU))},
    "eos": {"type": "linear", "bulk_modulus": E / (3 * (1 - 2 * NU))},
}
# Nothing that dissipates: no bulk viscosity, and hourglass control by stiffness, whose energy is stored.
CONSERVATIVE = {
    "type": "hex8",
    "linear_viscosity": 0,
    "quadratic_viscosity": 0,
    "hourglass": "stiffness",
    "hourglass_coefficient": 0.05,
}


@pytest.fixture(scope="module")
def oscillation(kerf):
    """A block of 2 x 2 x 8 mm whose halves start towards each other; period of the axial mode 2 L / c0.

    The step is constant, 0.85 of the stable one. Central differences conserve an energy only then: a step that
    follows the stable one, which the motion changes by 1e-4, lets the energy wander by 2e-3 in ten thousand steps.
    """
    period, step = 2 * 8e-3 / math.sqrt(E / RHO), 1.3e-7
    n_steps = math.ceil(1000 * period / step)
    model = {
        "title": "free axial oscillation of an elastic block",
        "time": {"end": n_steps * step, "maximum_step": step},
        "materials": {"steel": STEEL},
        "parts": {
            "block": {
                "material": "steel",
                "element": CONSERVATIVE,
                "mesh": {"type": "block", "origin": [0, 0, -4e-3], "size": [2e-3, 2e-3, 8e-3], "cells": [2, 2, 8]},
            }
        },
        "sets": {
            "lower": {"parts": "block", "box": [0, 0, -5e-3, 2e-3, 2e-3, -0.5e-3]},
            "upper": {"parts": "block", "box": [0, 0, 0.5e-3, 2e-3, 2e-3, 5e-3]},
        },
        "boundaries": [
            {"type": "initial_velocity", "nodes": "lower", "velocity": [0, 0, 1]},
            {"type": "initial_velocity", "nodes": "upper", "velocity": [0, 0, -1]},
        ],
        "output": {"history_interval": period / 2.3, "results_interval": 200 * period},
    }
    return kerf(model)


def test_oscillating_block_conserves_its_energy_over_a_thousand_periods(oscillation):
    h = oscillation.history
    total = h["kinetic"] + h["internal"] + h["hourglass"]
    drift = np.abs(total / h["kinetic"][0] - 1.0).max()
    print("cycles", oscillation.summary["cycles"], "largest deviation", drift)
    assert oscillation.summary["cycles"] > 24000  # some 25 steps in each of a thousand periods
    assert drift < 1e-3
    assert np.abs(h["balance_error"]).max() < 1e-3
    assert h["bulk_viscosity"][-1] == 0.0


def test_oscillating_block_does_oscillate(oscillation):
    h = oscillation.history
    share = h["kinetic"] / h["kinetic"][0]
    assert share.min() < 0.5 and share[len(share) // 2 :].max() > 0.7  # no decay in the second half


def test_oscillating_block_stays_where_it_is(oscillation):
    h = oscillation.history
    momentum_of_a_half = oscillation.summary["mass"]["initial"] / 2 * 1.0
    for axis in "xyz":
        # Forces add up to nothing in whole quanta; what is left is the rounding of velocities over the cycles.
        assert np.abs(h[f"momentum_{axis}"]).max() < 1e-10 * momentum_of_a_half


SPIN = 2000.0  # [rad/s]


@pytest.fixture(scope="module")
def spinning(kerf):
    """A bar of 4 x 4 x 12 mm that spins about an oblique axis through its centre of mass, along a principal axis."""
    angle = 30.0
    axis = np.array([math.sin(math.radians(angle)), 0.0, math.cos(math.radians(angle))])
    model = {
        "title": "spinning elastic bar",
        "time": {"end": 5 * 2 * math.pi / SPIN},  # five turns
        "materials": {"steel": STEEL},
        "parts": {
            "bar": {
                "material": "steel",
                "element": CONSERVATIVE,
                "mesh": {"type": "block", "origin": [-2e-3, -6e-3, -2e-3], "size": [4e-3, 12e-3, 4e-3],
                         "cells": [2, 6, 2]},
                "placement": [{"angle": math.radians(angle), "axis": [0, 1, 0]}],
            }
        },
        "boundaries": [{"type": "initial_velocity", "nodes": "bar", "angular_velocity": (SPIN * axis).tolist()}],
        "output": {"precision": "double", "element_fields": ["stress"], "node_fields": ["velocity", "mass"],
                   "results_interval": 0.25 * 2 * math.pi / SPIN},
    }
    return kerf(model), axis


def angular_velocity(results, frame):
    """About the centre of mass: the inverse of the inertia tensor times the angular momentum."""
    m = results.node("mass", frame)[:, None]
    x, v = results.points(frame), results.node("velocity", frame)
    x = x - (m * x).sum(0) / m.sum()
    momentum = (m * np.cross(x, v)).sum(0)
    inertia = sum(mi * (np.dot(xi, xi) * np.eye(3) - np.outer(xi, xi)) for mi, xi in zip(m[:, 0], x))
    return np.linalg.solve(inertia, momentum)


def test_spinning_bar_keeps_its_energy(spinning):
    run, _ = spinning
    kinetic = run.history["kinetic"]
    # The bar starts without the centrifugal strain: u/L of order rho (omega L/2)^2 / E = 6e-6.
    assert np.abs(kinetic / kinetic[0] - 1.0).max() < 5e-5
    assert np.abs(run.history["balance_error"]).max() < 1e-6


def test_spinning_bar_keeps_its_angular_velocity(spinning):
    run, axis = spinning
    results = run.results
    assert len(results.times) == 21  # the start, and every quarter of five turns
    for frame in range(1, len(results.times)):
        assert angular_velocity(results, frame) == pytest.approx(SPIN * axis, abs=1e-4 * SPIN)


def test_spinning_bar_turns_by_the_right_angle(spinning):
    run, axis = spinning
    results = run.results
    start, end = results.points(0), results.points(-1)
    angle = SPIN * results.times[-1]
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turn = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    # Central differences advance the angle of a rotation by its own error of (omega dt)^2/24 = 1e-9.
    assert np.abs(end - start @ turn.T).max() < 1e-4 * 6e-3


def test_spinning_bar_has_only_centrifugal_stress(spinning):
    run, _ = spinning
    static = RHO * (SPIN * 6e-3) ** 2 / 2  # at the centre; 0.56 MPa
    frames = range(1, len(run.results.times))
    largest = max(np.abs(run.results.cell("stress", frame)).max() for frame in frames)
    # The bar starts unstrained, so its stress swings between nothing and twice the static value; 20 frames come near to
    # the top of a swing.
    assert static < largest < 2.4 * static


# Steel, and a solid that is nearly a fluid: bulk over shear modulus 2.2 and 91.
@pytest.mark.parametrize("bulk", [E / (3 * (1 - 2 * NU)), 7000e9])
@pytest.mark.parametrize("cells", [(1, 1, 1), (1, 1, 2), (1, 1, 6), (5, 5, 1), (2, 2, 2), (3, 3, 3)], ids=str)
def test_small_bodies_are_stable_at_the_default_step(kerf, cells, bulk):
    """Cells with few neighbours breathe faster than a plane wave: what stands alone, or thin, sets a smaller step."""
    run = kerf(
        {
            "title": "a small body that bounces off a tilted wall",
            "time": {"end": 2e-4},
            "materials": {
                "solid": {
                    "density": RHO,
                    "strength": {"type": "elastic", "shear_modulus": E / (2 * (1 + NU))},
                    "eos": {"type": "linear", "bulk_modulus": bulk},
                }
            },
            "parts": {
                "body": {
                    "material": "solid",
                    "mesh": {"type": "block", "size": [1e-3 * n for n in cells], "cells": list(cells)},
                    "velocity": [0, 0, -20],
                }
            },
            "boundaries": [{"type": "rigid_wall", "point": [0, 0, 0], "normal": [0.1, 0.2, 1]}],
            "checks": {"energy_growth": 1.0},
            "output": {"history_interval": 2e-6, "results_interval": 1},
        }
    )
    # The step changes as cells deform, and the sum of the terms with it: 0.12 % at most, in the single cell.
    assert np.abs(run.history["balance_error"]).max() < 5e-3


def soft_block_on_a_wall(strength, speed, gap, **time):
    """Gelatine, K/G 17; waves run at 232 m/s."""
    return {
        "title": "a soft block and a wall",
        "time": {"end": 2e-4, **time},
        "materials": {
            "gel": {
                "density": 1000,
                "strength": {"shear_modulus": 3e6, **strength},
                "eos": {"type": "linear", "bulk_modulus": 50e6},
            }
        },
        "parts": {
            "block": {
                "material": "gel",
                "mesh": {"type": "block", "origin": [gap, 0, 0], "size": [20e-3] * 3, "cell_size": 2e-3},
                "velocity": [-speed, 0, 0],
            }
        },
        "boundaries": [{"type": "rigid_wall", "point": [0, 0, 0], "normal": [1, 0, 0]}],
        "output": {"history_interval": 2e-6, "results_interval": 1},
    }


ELASTIC, PLASTIC = {"type": "elastic"}, {"type": "elastic_plastic", "yield_stress": 0.2e6}


@pytest.mark.parametrize("strength", [ELASTIC, PLASTIC], ids=["elastic", "plastic"])
@pytest.mark.parametrize("speed", [20.0, 30.0, 60.0])
def test_a_soft_block_that_starts_on_a_wall_gains_nothing(kerf, strength, speed):
    """Where the step shrinks while forces are large, the books of central differences are off by F^2/m times
    (old^2 - new^2)/8 of the steps: the first step must be short."""
    run = kerf(soft_block_on_a_wall(strength, speed, 0.0))
    balance = run.history["balance_error"]
    print("least and greatest error", balance.min(), balance.max())
    # Measured: -0.33 to 0.00 %, for the step grows after the start; 0.5 to 1.8 % with a first step of 0.3 cells.
    assert balance.max() < 1e-3 and balance.min() > -4e-3
    # A warning of hourglass control is right at 60 m/s, where one layer of cells flattens.
    assert not [text for text in run.summary["warnings"] if "strikes a wall" in text]


# The gap that is worst at 60 m/s and the default factor, where the energy grows by 1.4 %.
@pytest.mark.parametrize("factor, warns, bound", [(0.9, True, 0.016), (0.6, False, 0.0015)])
def test_a_fast_soft_block_is_warned_of_and_balances_as_the_warning_says(kerf, factor, warns, bound):
    run = kerf(soft_block_on_a_wall(PLASTIC, 60.0, 3.2e-3, safety_factor=factor))
    balance = np.abs(run.history["balance_error"]).max()
    print("error", balance, run.summary["warnings"])
    assert balance < bound
    said = [w for w in run.summary["warnings"] if "strikes a wall at 0.26 of its wave speed" in w]
    # At the end comes a second warning, of the balance itself.
    opened = [w for w in run.summary["warnings"] if "the energy balance is off by +1.4 %" in w]
    assert len(said) == len(opened) == (1 if warns else 0)
    assert len(said) + len(opened) == len(run.summary["warnings"])


def test_a_slow_soft_block_is_not_warned_of(kerf):
    run = kerf(soft_block_on_a_wall(ELASTIC, 20.0, 0.3e-3))
    assert run.summary["warnings"] == []
    assert np.abs(run.history["balance_error"]).max() < 6e-3  # measured: 0.55 %


def test_cells_between_planes_of_symmetry_keep_the_step_of_a_plane_wave(kerf):
    """A row of single cells that conditions hold on all sides has nowhere to breathe, and pays nothing for it."""
    planes = [
        {"type": "symmetry", "normal": [0, 1, 0]},
        {"type": "symmetry", "normal": [0, 0, 1]},
        {"type": "symmetry", "point": [0, 1e-3, 0], "normal": [0, -1, 0]},
        {"type": "symmetry", "point": [0, 0, 1e-3], "normal": [0, 0, -1]},
    ]

    def first_step(boundaries):
        model = {
            "title": "a row of cells",
            "time": {"end": 1e-6, "maximum_cycles": 1},
            "materials": {"steel": STEEL},
            "parts": {
                "row": {
                    "material": "steel",
                    "element": {"type": "hex8", "linear_viscosity": 0},
                    "mesh": {"type": "block", "size": [5e-3, 1e-3, 1e-3], "cells": [5, 1, 1]},
                }
            },
            **({"boundaries": boundaries} if boundaries else {}),
        }
        return kerf(model).history["dt"][-1]

    bulk, shear = E / (3 * (1 - 2 * NU)), E / (2 * (1 + NU))
    plane_wave = 0.9 * 1e-3 / math.sqrt((bulk + 4 / 3 * shear) / RHO)
    assert first_step(planes) == pytest.approx(plane_wave, rel=1e-9)
    # An end of a bar has five faces that nothing holds: three quarters of the freedom of a single cell, whose square of
    # the speed is more by 2 lambda over rho.
    bar = 1 + 0.75 * 2 * (bulk - 2 / 3 * shear) / (bulk + 4 / 3 * shear)
    assert first_step(None) == pytest.approx(plane_wave / math.sqrt(bar), rel=1e-9)
