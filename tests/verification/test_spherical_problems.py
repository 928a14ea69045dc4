"""Spherically symmetric problems with exact solutions, in columns between oblique planes and in eighths of a sphere."""

from pathlib import Path

import numpy as np
import pytest

EXACT = Path(__file__).resolve().parents[1] / "data" / "exact"


def cut_off(*names):
    return [{"type": "symmetry", "normal": {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}[n]} for n in names]


def column(inner, outer, cells, angle):
    """Mesh and planes of a column along z between planes that meet at the centre."""
    mesh = {"type": "spherical_sector", "inner_radius": inner, "outer_radius": outer, "angle_x": f"{angle} deg",
            "angle_y": f"{angle} deg", "radial_cells": cells, "cells_x": 1, "cells_y": 1}
    oblique = [{"type": "symmetry", "normal": [-1, 0, 0], "axis": [0, 1, 0], "angle": f"{angle} deg"},
               {"type": "symmetry", "normal": [0, -1, 0], "axis": [-1, 0, 0], "angle": f"{angle} deg"}]
    return mesh, cut_off("x", "y") + oblique


def radii(points):
    return np.linalg.norm(points, axis=1)


def model(material, mesh, boundaries, end, **more):
    return {"title": "spherical", "time": {"end": end}, "materials": {"m": material},
            "parts": {"body": {"material": "m", "mesh": mesh}}, "boundaries": boundaries,
            "output": {"results_interval": end, "precision": "double",
                       "element_fields": ["density", "pressure"], "node_fields": ["velocity", "displacement"]}, **more}


def stays_radial(run):
    """How far the directions of nodes turn from where they were."""
    start, moved = run.results.points(0), run.results.node("displacement", -1)
    along = start / radii(start)[:, None]
    across = moved - along * (moved * along).sum(axis=1)[:, None]
    return radii(across).max()


def cavity(kerf, cells):
    """Blake's problem: a pressure steps up in a cavity in an elastic body. Mean error of the displacement."""
    mesh, planes = column(0.1, 1.1, cells, 4)
    steel = {"density": 3000, "strength": {"type": "elastic", "shear_modulus": 25e9},
             "eos": {"type": "linear", "bulk_modulus": 25e9 * (1 + 2 / 3)}}
    run = kerf(model(steel, mesh, planes, 1.6e-4, sets={"wall": {"face": "inner"}},
                     loads=[{"type": "pressure", "facets": "wall", "pressure": 1e6}]))
    exact = np.loadtxt(EXACT / "blake_spherical_cavity_t1.6e-4.csv", delimiter=",")
    exact = exact[exact[:, 0] > 0.1]
    start, moved = run.results.points(0), run.results.node("displacement", -1)
    order = np.argsort(radii(start))
    u = np.interp(exact[:, 0], radii(start)[order], (moved * start).sum(axis=1)[order] / radii(start)[order])
    assert stays_radial(run) < 1e-9 * np.abs(moved).max() + 1e-17  # round-off of nodes that lie on two planes
    return np.abs(u - exact[:, 1]).mean() / np.abs(exact[:, 1]).max()


def test_a_pressed_cavity_converges_to_blakes_solution(kerf):
    coarse, fine = cavity(kerf, 50), cavity(kerf, 200)
    print("errors", coarse, fine)
    assert fine < 0.01
    # The front is a kink of the displacement, where no scheme exceeds the first order.
    assert np.log(coarse / fine) / np.log(4) > 0.9


def collapse(kerf, cells):
    """Verney's problem: a plastic shell flows inwards without change of volume until all its energy is plastic work."""
    mesh, planes = column(0.08, 0.10, cells, 3)
    beryllium = {"density": 1845, "strength": {"type": "elastic_plastic", "shear_modulus": 151e9, "yield_stress": 330e6},
                 "eos": {"type": "linear", "bulk_modulus": 130e9}}
    flow = {"type": "initial_velocity", "radial_speed": -619.78708, "reference_radius": 0.08, "exponent": 2}
    run = kerf(model(beryllium, mesh, [flow] + planes, 98.994e-6))
    return run, radii(run.results.points(-1))


def test_a_collapsing_shell_stops_where_its_energy_is_spent(kerf):
    errors = []
    for cells in (10, 40):
        run, r = collapse(kerf, cells)
        errors.append((abs(r.min() / 0.04 - 1), abs(r.max() / 0.08203132 - 1)))
        energy = run.summary["energy"]
        print(cells, r.min(), r.max(), energy)
        assert abs(energy["balance_error"]) < 1e-3
        assert energy["kinetic"] < 0.01 * energy["initial"]
    # The exact solution has neither elastic strain nor compression: both are about Y / K = 0.25 % here.
    assert errors[1][0] < 0.01 and errors[1][1] < 0.005


def gas(gamma):
    return {"density": 1.0, "strength": {"type": "hydrodynamic"},
            "eos": {"type": "linear_polynomial", "C4": gamma - 1, "C5": gamma - 1}}


LOOSE = {"maximum_speed": 1e4, "energy_growth": 1e12}  # the gas at rest holds no energy to compare with


def test_converging_gas_is_stopped_at_the_centre(kerf):
    """Noh's problem in an eighth of a sphere: behind a shock at t/3 the density is 64."""
    mesh = {"type": "sphere", "radius": 1.0, "core_cells": 11, "ring_cells": 9, "sector": "eighth"}
    cold = gas(5 / 3)
    cold["eos"]["initial_energy"] = 1e-6
    run = kerf(model(cold, mesh, [{"type": "initial_velocity", "radial_speed": -1.0}] + cut_off("x", "y", "z"), 0.6,
                     checks=LOOSE))
    r, density = radii(run.results.centres(-1)), run.results.cell("density", -1)
    behind, ahead = (r > 0.1) & (r < 0.16), (r > 0.3) & (r < 0.38)
    print(behind.sum(), density[behind].mean(), density[r < 0.18].max(), (density[ahead] * (r[ahead]**2 / (r[ahead] + 0.6)**2)).mean())
    assert behind.sum() > 20
    assert density[behind].mean() == pytest.approx(64, rel=0.1)
    # Ahead of the shock the gas flows freely: (1 + t/r)^2.
    assert density[ahead] == pytest.approx((1 + 0.6 / r[ahead])**2, rel=0.05)


def test_a_point_blast_spreads_as_sedov_says(kerf):
    cells = 20
    mesh = {"type": "sphere", "radius": 1.2, "core_cells": 13, "ring_cells": 11, "sector": "eighth"}
    h = 1.2 / 24
    hot = {"centre": {"box": [0, 0, 0, 1.01 * h, 1.01 * h, 1.01 * h]}}
    first = kerf(model(gas(1.4), mesh, cut_off("x", "y", "z"), 1e-9, sets=hot, checks=LOOSE,
                       initial_state=[{"elements": "centre", "variable": "specific_energy", "value": "1 J/kg"}]))
    energy = 0.851071859 / 8 / first.summary["energy"]["initial"]
    run = kerf(model(gas(1.4), mesh, cut_off("x", "y", "z"), 1.0, sets=hot, checks=LOOSE,
                     initial_state=[{"elements": "centre", "variable": "specific_energy", "value": energy}]))
    r, density, pressure = radii(run.results.centres(-1)), run.results.cell("density", -1), run.results.cell("pressure", -1)
    exact = np.loadtxt(EXACT / "sedov_sph_gamma1.4.csv", delimiter=",")
    bins = np.arange(0.3, 1.2, h)
    mean = np.array([density[(r >= a) & (r < a + h)].mean() for a in bins])
    front = bins[np.argmax(mean)] + h / 2
    inside = (r > 0.4) & (r < 0.7)
    exact_p = np.interp(r[inside], exact[:, 0], exact[:, 3])
    print(energy, front, mean, np.abs(pressure[inside] / exact_p - 1).mean(), run.summary["energy"], cells)
    assert front == pytest.approx(1.0, abs=1.5 * h)
    assert pressure[inside].mean() == pytest.approx(exact_p.mean(), rel=0.1)
