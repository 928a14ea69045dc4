"""Symmetric plate impacts of fluids: shock velocity and pressure against the Hugoniots of their equations of state."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

LAWS = Path(__file__).resolve().parents[1] / "data" / "laws"
CELLS, LENGTH = 300, 6e-3
TOLERANCE = 5e-3  # of the shock velocity and the pressure behind; the mesh spreads the front over some four cells

LEAD = {"type": "mie_gruneisen", "c0": 2006, "s": 1.429, "s2": 0.8506, "s3": -1.64, "gamma0": 2.74, "gamma_slope": 2.2}
COPPER = {"type": "mie_gruneisen", "c0": 3940, "s": 1.489, "gamma0": 2.02, "gamma_slope": 0.47}
BASALT = {"type": "tillotson", "a": 0.5, "b": 1.5, "A": "26.7 GPa", "B": "26.7 GPa", "E0": 487e6, "alpha": 5, "beta": 5,
          "incipient_vaporisation_energy": 4.72e6, "complete_vaporisation_energy": 18.2e6}
GAMMA, STIFFNESS = 4.4, 600e6
WATER = {"type": "stiffened_gas", "gamma": GAMMA, "stiffness": STIFFNESS}


def state_of_file(name, velocity):
    """Particle velocity, shock velocity and pressure of the row that comes nearest to a particle velocity."""
    with open(LAWS / f"{name}.csv", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    row = min(rows, key=lambda r: abs(float(r["particle_velocity_m_s"]) - velocity))
    return tuple(float(row[k]) for k in ("particle_velocity_m_s", "shock_velocity_m_s", "pressure_Pa"))


def state_of_stiffened_gas(velocity, density):
    """From the jump of mass, momentum and energy, with no pressure ahead of the shock."""
    a = 0.25 * (GAMMA + 1.0) * velocity
    shock = a + math.sqrt(a * a + GAMMA * STIFFNESS / density)
    return velocity, shock, density * shock * velocity


def impact(density, eos, velocity, end):
    """One of two equal plates: the plane in which they meet is one of symmetry."""
    width = LENGTH / CELLS
    walls = [((0, 0, 0), (1, 0, 0)), ((0, 0, 0), (0, 1, 0)), ((0, 0, 0), (0, 0, 1)), ((0, width, 0), (0, -1, 0)),
             ((0, 0, width), (0, 0, -1))]
    return {
        "title": "impact of a plate on its mirror image",
        "time": {"end": end},
        "materials": {"fluid": {"density": density, "strength": {"type": "hydrodynamic"}, "eos": eos}},
        "parts": {"plate": {"material": "fluid", "velocity": [-velocity, 0, 0],
                            "mesh": {"type": "block", "size": [LENGTH, width, width], "cells": [CELLS, 1, 1]}}},
        "boundaries": [{"type": "symmetry", "point": list(p), "normal": list(n)} for p, n in walls],
        "output": {"results_interval": 0.5 * end, "precision": "double", "element_fields": ["pressure"]},
    }


def front(x, pressure, level):
    """Where the pressure falls through a level, counted in the undeformed plate."""
    i = np.nonzero(pressure > level)[0][-1]
    return x[i] + (x[i + 1] - x[i]) * (pressure[i] - level) / (pressure[i] - pressure[i + 1])


@pytest.mark.parametrize("density, eos, state", [
    (11340.0, LEAD, state_of_file("eos_gruneisen_cubic_lead_hugoniot", 900.0)),
    (8930.0, COPPER, state_of_file("eos_gruneisen_copper_hugoniot", 1000.0)),
    (2700.0, BASALT, state_of_file("eos_tillotson_basalt_hugoniot", 1500.0)),
    (1000.0, WATER, state_of_stiffened_gas(500.0, 1000.0)),
], ids=["cubic_lead", "copper", "tillotson_basalt", "stiffened_water"])
def test_shock_has_the_velocity_and_the_pressure_of_the_hugoniot(kerf, density, eos, state):
    particle, shock, pressure = state
    run = kerf(impact(density, eos, particle, 0.85 * LENGTH / shock))
    results = run.results
    order = np.argsort(results.centres(0)[:, 0])
    x, middle, last = results.centres(0)[order, 0], len(results.times) // 2, len(results.times) - 1
    profiles = [results.cell("pressure", frame)[order] for frame in (middle, last)]
    places = [front(x, p, 0.5 * pressure) for p in profiles]
    speed = (places[1] - places[0]) / (results.times[last] - results.times[middle])
    # Behind the front, away from the plane of impact, which the first cells heat.
    plateau = profiles[1][(x > 0.25 * places[1]) & (x < 0.75 * places[1])]
    print("shock velocity", speed / shock - 1.0, "pressure", plateau.mean() / pressure - 1.0)
    assert speed == pytest.approx(shock, rel=TOLERANCE)
    assert plateau.mean() == pytest.approx(pressure, rel=TOLERANCE)
    assert np.ptp(plateau) < 2 * TOLERANCE * pressure
    # Steps of the usual safety factor, with a shock that heats: a per cent of the energy of the plate.
    assert abs(run.summary["energy"]["balance_error"]) < 1e-2


def test_gas_accounts_for_the_energy_it_starts_with(kerf):
    """A gas that flows out of a pipe, as a law of its own and as a polynomial: the same flow, and the same balance."""
    density, p, gamma = 1.2, 1e5, 1.4
    laws = ({"type": "ideal_gas", "gamma": gamma, "initial_pressure": p},
            {"type": "stiffened_gas", "gamma": gamma, "stiffness": 0, "initial_pressure": p},
            {"type": "linear_polynomial", "C4": gamma - 1.0, "C5": gamma - 1.0, "initial_energy": p / (gamma - 1.0)})
    runs = [kerf(impact(density, law, 0.0, 8e-6)) for law in laws]
    energies = [run.summary["energy"] for run in runs]
    volume = LENGTH**3 / CELLS**2
    assert energies[0]["initial"] == pytest.approx(p / (gamma - 1.0) * volume, rel=1e-6)
    assert energies[0]["kinetic"] > 0.01 * energies[0]["initial"]
    pressures = [run.results.cell("pressure", -1) for run in runs]
    for energy, pressure in zip(energies[1:], pressures[1:]):
        assert energy["initial"] == pytest.approx(energies[0]["initial"], rel=1e-12)
        # Round-off of different orders of operations, over some thousand steps.
        assert energy["kinetic"] == pytest.approx(energies[0]["kinetic"], rel=1e-9)
        assert np.abs(pressure - pressures[0]).max() < 1e-9 * p
    assert abs(energies[0]["balance_error"]) < 1e-2
