"""A cold gas that runs into a plane of symmetry: motion is faster than any wave from the first step on."""

import numpy as np
import pytest


@pytest.mark.parametrize("energy", [1e-6, 1e-3])
def test_cold_gas_is_stopped_by_a_shock(kerf, energy):
    """Noh's problem in the plane, gamma = 5/3, gas at 1 m/s: behind a shock that moves at 1/3 m/s the density is 4 and
    the pressure 4/3. Forces are those of rho v^2, 6e5 times the colder gas's bulk modulus; the first step by the wave
    speed alone would turn a cell inside out."""
    model = {
        "title": "cold gas",
        "time": {"end": 0.6},
        "materials": {
            "gas": {
                "density": 1.0,
                "strength": {"type": "hydrodynamic"},
                "eos": {"type": "linear_polynomial", "C4": 2 / 3, "C5": 2 / 3, "initial_energy": energy},
            }
        },
        "parts": {
            "gas": {
                "material": "gas",
                "mesh": {"type": "block", "size": [1, 0.01, 0.01], "cells": [100, 1, 1]},
                "velocity": [-1, 0, 0],
            }
        },
        "boundaries": [
            {"type": "symmetry", "normal": [1, 0, 0]},
            {"type": "symmetry", "normal": [0, 1, 0]},
            {"type": "symmetry", "normal": [0, 0, 1]},
            {"type": "symmetry", "point": [0, 0.01, 0], "normal": [0, -1, 0]},
            {"type": "symmetry", "point": [0, 0, 0.01], "normal": [0, 0, -1]},
        ],
        # The gas at rest holds next to nothing, so what it gains is a large multiple of it.
        "checks": {"maximum_speed": 1000, "energy_growth": 1e12},
        "output": {"results_interval": 0.6, "precision": "double", "element_fields": ["pressure", "density"]},
    }
    run = kerf(model)
    x = run.results.centres(-1)[:, 0]
    behind = (x > 0.05) & (x < 0.15)  # away from the wall, where viscosity heats the gas, and from the shock at 0.2
    assert behind.sum() > 20
    # Within the oscillation that is left behind a shock of three cells' width.
    assert run.results.cell("density", -1)[behind] == pytest.approx(4.0, rel=0.05)
    assert run.results.cell("pressure", -1)[behind] == pytest.approx(4 / 3, rel=0.05)
    front = x[np.argmax(run.results.cell("density", -1) < 2.5)]
    assert front == pytest.approx(0.2, abs=0.015)
    assert abs(run.summary["energy"]["balance_error"]) < 1e-3
