"""An elastic bar strikes a rigid wall: stress rho c0 v, contact time 2 L / c0 (one-dimensional wave theory)."""

import math

import numpy as np
import pytest

RHO, E, SPEED, LENGTH, SIDE = 7800.0, 200.0e9, 10.0, 100.0e-3, 2.0e-3
C0 = math.sqrt(E / RHO)


def run_bar(kerf, poisson):
    model = {
        "title": "elastic bar on a rigid wall",
        "time": {"end": 2.6 * LENGTH / C0},
        "materials": {
            "steel": {
                "density": RHO,
                "strength": {"type": "elastic", "shear_modulus": E / (2 * (1 + poisson))},
                "eos": {"type": "linear", "bulk_modulus": E / (3 * (1 - 2 * poisson))},
            }
        },
        "parts": {
            "bar": {
                "material": "steel",
                "mesh": {"type": "block", "size": [SIDE, SIDE, LENGTH], "cells": [2, 2, 200]},
                "velocity": [0, 0, -SPEED],
            }
        },
        "boundaries": [{"type": "rigid_wall", "point": [0, 0, 0], "normal": [0, 0, 1]}],
        "output": {
            "history_interval": LENGTH / C0 / 200,
            "results_interval": 0.2 * LENGTH / C0,
            "element_fields": ["stress"],
        },
    }
    return kerf(model)


# Without Poisson's effect the bar is one-dimensional. With it, lateral inertia makes the front ring (Pochhammer,
# Chree), about a mean that is that of wave theory for a wave longer than the bar is wide.
@pytest.fixture(scope="module", params=[0.0, 0.3], ids=["no_poisson", "steel"])
def bar(request, kerf):
    return run_bar(kerf, request.param)


def wall_force(history):
    time, momentum = history["time"], history["momentum_z"]
    return 0.5 * (time[1:] + time[:-1]), np.diff(momentum) / np.diff(time)


def test_force_on_the_wall_is_that_of_wave_theory(bar):
    time, force = wall_force(bar.history)
    pressing = (time > 0.1 * LENGTH / C0) & (time < 1.9 * LENGTH / C0)
    assert force[pressing].mean() / SIDE**2 == pytest.approx(RHO * C0 * SPEED, rel=0.01)


def test_stress_behind_the_front_is_that_of_wave_theory(bar):
    results = bar.results
    frame = int(np.argmin(np.abs(results.times - 0.8 * LENGTH / C0)))
    z = results.centres(frame)[:, 2]
    behind = z < 0.6 * LENGTH  # three quarters of the way that the front has gone
    assert -results.cell("stress", frame)[behind, 2].mean() == pytest.approx(RHO * C0 * SPEED, rel=0.01)


def test_contact_lasts_for_two_passages_of_the_wave(bar):
    time, force = wall_force(bar.history)
    touching = time[force > 0.5 * RHO * C0 * SPEED * SIDE**2]
    assert touching[-1] - time[0] == pytest.approx(2.0 * LENGTH / C0, rel=0.01)


def test_bar_flies_off_with_its_speed(bar):
    # All of the bar has turned round, but for what the front, spread by bulk viscosity, and lateral vibration keep.
    assert bar.summary["parts"]["bar"]["velocity"][2] == pytest.approx(SPEED, rel=0.02)
    assert abs(bar.summary["energy"]["balance_error"]) < 1e-3


def test_bar_of_a_single_cell_is_stable_with_the_bound_of_a_free_element(kerf):
    """A bar of one cell can breathe in both lateral directions, faster than a plane wave's step allows: with the
    default bound of the step, this bar would burst within a hundred cycles."""
    model = {
        "title": "elastic bar of one cell on a rigid wall",
        "time": {"end": "200 us"},
        "materials": {
            "steel": {
                "density": RHO,
                "strength": {"type": "elastic", "shear_modulus": E / 2.6},
                "eos": {"type": "linear", "bulk_modulus": E / 1.2},
            }
        },
        "parts": {
            "bar": {
                "material": "steel",
                "element": {"type": "hex8", "stable_step": "free_element"},
                "mesh": {"type": "block", "size": [1e-3, 1e-3, 8e-3], "cells": [1, 1, 8]},
                "velocity": [0, 0, -1],
            }
        },
        "boundaries": [{"type": "rigid_wall", "point": [0, 0, 0], "normal": [0, 0, 1]}],
    }
    history = kerf(model).history
    assert np.abs(history["balance_error"]).max() < 1e-3
    assert (history["kinetic"] <= history["kinetic"][0] * 1.001).all()


def test_wall_does_no_work_and_its_impulse_is_the_change_of_momentum(bar):
    summary = bar.summary
    initial, final = summary["momentum"]["initial"][2], summary["momentum"]["final"][2]
    assert summary["momentum"]["external_impulse"][2] == pytest.approx(final - initial, rel=1e-12)
    # Nodes that arrive are stopped within a step: the plastic impact of the first layer of half cells.
    lost = 0.5 * RHO * SIDE**2 * (0.5 * LENGTH / 200) * SPEED**2
    assert abs(summary["energy"]["external"]) < 1.1 * lost
