"""Hourglass control in bodies that flow, spin and bend: it takes no more than there is, and gives nothing."""

import numpy as np
import pytest

ALUMINIUM = {
    "density": 2700,
    "strength": {
        "type": "johnson_cook",
        "shear_modulus": 27.6e9,
        "A": 324e6,
        "B": 114e6,
        "n": 0.42,
        "C": 0.002,
        "m": 1.34,
        "reference_rate": 1,
        "reference_temperature": 298,
        "melting_temperature": 925,
        "initial_temperature": 294,
        "specific_heat": 896,
        "taylor_quinney": 0.9,
    },
    "eos": {"type": "mie_gruneisen", "c0": 5240, "s": 1.40, "gamma0": 1.97},
}
SYMMETRY = [{"type": "symmetry", "normal": [1, 0, 0]}, {"type": "symmetry", "normal": [0, 1, 0]}]
FLOOR = {"type": "rigid_wall", "point": [0, 0, 0], "normal": [0, 0, 1]}


@pytest.mark.parametrize("coefficient", [0.05, 0.15])
def test_viscous_control_is_stable_in_cells_that_a_fast_bar_crushes(kerf, coefficient):
    """Cells at the foot of an aluminium bar of 603 m/s shrink to a tenth and taper; their hourglass vectors grow."""
    run = kerf(
        {
            "title": "aluminium bar, 603 m/s",
            "time": {"end": 48e-6},
            "materials": {"aluminium": ALUMINIUM},
            "parts": {
                "bar": {
                    "material": "aluminium",
                    "element": {"type": "hex8", "hourglass": "viscous", "hourglass_coefficient": coefficient},
                    "mesh": {
                        "type": "cylinder",
                        "radius": 3.81e-3,
                        "length": 23.47e-3,
                        "core_cells": 3,
                        "ring_cells": 3,
                        "axial_cells": 37,
                        "sector": "quarter",
                        "exact_section": True,
                    },
                    "velocity": [0, 0, -603],
                }
            },
            "boundaries": [FLOOR, *SYMMETRY],
            "output": {"history_interval": 0.5e-6},
        }
    )
    h = run.history
    # One per mille of the initial energy; unstable control added 22.9 % by 39.6 us.
    assert np.abs(h["balance_error"]).max() < 1e-3
    assert np.diff(h["hourglass"]).max() < 0.02 * h["kinetic"][0]  # in half a microsecond


def test_viscous_control_is_stable_in_a_soft_block_under_a_punch(kerf):
    """Cells round a punch of 150 m/s fold; their control used to feed them 12 J, two thirds of all, in 1 us."""
    run = kerf(
        {
            "title": "gelatine under a steel punch",
            "time": {"end": 200e-6},
            "materials": {
                "gelatine": {
                    "density": 1000,
                    "strength": {
                        "type": "elastic_plastic",
                        "shear_modulus": 3e6,
                        "yield_stress": 0.2e6,
                        "hardening_modulus": 0,
                    },
                    "eos": {"type": "linear", "bulk_modulus": 50e6},
                },
                "steel": {
                    "density": 7850,
                    "strength": {"type": "elastic", "shear_modulus": 80e9},
                    "eos": {"type": "linear", "bulk_modulus": 160e9},
                },
            },
            "parts": {
                "block": {
                    "material": "gelatine",
                    "element": {"type": "hex8", "hourglass": "viscous"},
                    "mesh": {
                        "type": "block",
                        "size": [0.02, 0.02, 0.02],
                        "origin": [-0.01, -0.01, -0.02],
                        "cell_size": 2e-3,
                    },
                },
                "punch": {
                    "material": "steel",
                    "mesh": {
                        "type": "block",
                        "size": [6e-3, 6e-3, 6e-3],
                        "origin": [-3e-3, -3e-3, 0.05e-3],
                        "cell_size": 2e-3,
                    },
                    "velocity": [0, 0, -150],
                },
            },
            "boundaries": [{**FLOOR, "point": [0, 0, -0.02]}],
            "contacts": [{"type": "eroding_surface"}],
            # Flattened cells let go of some nodes of the punch; this test is about their hourglass modes.
            "checks": {"energy_growth": 1.0, "let_go": 1.0},
            "output": {"history_interval": 0.5e-6},
        }
    )
    h = run.history
    # Between two samples, about four steps, hourglass control can take a hundredth of what there was at the start.
    assert np.diff(h["hourglass"]).max() < 0.01 * h["kinetic"][0]
    assert np.abs(h["balance_error"]).max() < 0.01  # a step at full speed crosses 0.15 of a cell
    # The mesh is too coarse for folds of one cell, and the run says so.
    hourglass, energy = run.summary["hourglass"], run.summary["energy"]
    assert hourglass["energy"] == energy["hourglass"]
    assert hourglass["share"] == pytest.approx(hourglass["energy"] / hourglass["dissipated"])
    taken = energy["hourglass"] + energy["bulk_viscosity"] + max(energy["contact"], 0.0)
    assert taken <= hourglass["dissipated"] <= taken + energy["internal"]  # less what both bodies hold elastically
    assert hourglass["share"] > 0.1
    assert "warning: hourglass control took" in run.process.stdout


@pytest.mark.parametrize("viscosity", [0.0, 0.06])
def test_stiffness_control_does_not_feed_a_spinning_bar(kerf, viscosity):
    """Twenty revolutions of a bar of steel. Hourglass rates and strains that are not turned with the body make
    forces out of line with the displacement, which feed it: the energy grew e-fold every 0.4 revolutions."""
    spin, n = 3192.0, 20
    run = kerf(
        {
            "title": "spinning bar",
            "time": {"end": n * 2 * np.pi / spin},
            "materials": {
                "steel": {
                    "density": 7850,
                    "strength": {"type": "elastic", "shear_modulus": 76.92e9},
                    "eos": {"type": "linear", "bulk_modulus": 166.67e9},
                }
            },
            "parts": {
                "bar": {
                    "material": "steel",
                    "element": {
                        "type": "hex8",
                        "hourglass": "stiffness",
                        "linear_viscosity": viscosity,
                        "quadratic_viscosity": 25 * viscosity,
                    },
                    "mesh": {
                        "type": "block",
                        "origin": [-0.05, -0.005, -0.005],
                        "size": [0.1, 0.01, 0.01],
                        "cells": [20, 2, 2],
                    },
                }
            },
            "boundaries": [{"type": "initial_velocity", "angular_velocity": [0, 0, spin]}],
            "output": {"history_interval": 0.05 * 2 * np.pi / spin, "results_interval": 1},
        }
    )
    h = run.history
    start = h["kinetic"][0]
    assert np.abs(h["balance_error"]).max() < 1e-4
    assert np.abs(h["hourglass"]).max() < 1e-4 * start  # grew to 4 % by the 15th revolution
    # What centrifugal force stretches elastically, and the ringing of its sudden onset: 4e-4 at the start, no growth.
    assert h["internal"].max() < 2e-3 * start
    assert h["internal"][-100:].max() < 1.2 * h["internal"][:100].max()


def mushroom(kerf, hourglass, coefficient):
    """Final radius of the standard copper bar, five cells to the radius, a quarter of it [m]; its hourglass energy over
    its initial energy."""
    run = kerf(
        "taylor_bar/taylor_bar.yaml",
        f"parts.bar.element.hourglass={hourglass}",
        f"parts.bar.element.hourglass_coefficient={coefficient}",
        "parts.bar.mesh.sector=quarter",
        "boundaries=[{type: rigid_wall, point: [0, 0, 0], normal: [0, 0, 1]}, {type: symmetry, normal: [1, 0, 0]}, "
        "{type: symmetry, normal: [0, 1, 0]}]",
    )
    energy = run.summary["energy"]
    assert "warning: hourglass" not in run.process.stdout
    return run.summary["measures"]["mushroom_radius"], energy["hourglass"] / energy["initial"]


def test_stiffness_control_does_not_stiffen_a_body_that_flows(kerf):
    """Resistance that grows with the elastic modulus where cells flow kept a mushroom of 6.29 mm at 0.1, of 7.21 mm."""
    viscous, _ = mushroom(kerf, "viscous", 0.1)
    assert 6.97e-3 < viscous < 7.24e-3  # the range of published codes
    for coefficient in (0.02, 0.1, 0.25):
        radius, energy = mushroom(kerf, "stiffness", coefficient)
        print(coefficient, radius, energy)
        assert radius == pytest.approx(viscous, rel=0.02)
        assert energy < 0.03  # what control has taken where cells flow is not given back


def test_stiffness_control_bends_one_layer_of_cubes_with_the_right_stiffness(kerf):
    """First frequency of a cantilever of steel of 100 x 10 mm in plane stress, by Timoshenko's beam: 823.0 Hz. Cubes
    bend exactly with the coefficient E / (3 (K + 4G/3)), 0.248 at Poisson's ratio 0.3."""
    young, poisson, n, frequency = 207e9, 0.3, 10, 823.0
    run = kerf(
        {
            "title": "cantilever, one layer",
            "time": {"end": 12 / frequency},
            "materials": {
                "steel": {
                    "density": 7850,
                    "strength": {"type": "elastic", "shear_modulus": young / (2 * (1 + poisson))},
                    "eos": {"type": "linear", "bulk_modulus": young / (3 * (1 - 2 * poisson))},
                }
            },
            "parts": {
                "beam": {
                    "material": "steel",
                    "element": {
                        "type": "hex8",
                        "hourglass": "stiffness",
                        "hourglass_coefficient": 0.248,
                        "stable_step": "free_element",
                        "linear_viscosity": 0,
                        "quadratic_viscosity": 0,
                    },
                    "mesh": {"type": "block", "size": [0.1, 0.01, 0.01], "cells": [n, 1, 1]},
                }
            },
            "sets": {"root": {"parts": "beam", "face": "x_min"}},
            "boundaries": [
                {"type": "initial_velocity", "velocity": [0, 0, 0.1]},
                {"type": "fixed", "nodes": "root"},
            ],
            "output": {"results_interval": 0.01 / frequency, "precision": "double", "node_fields": ["displacement"]},
        }
    )
    results = run.results
    tip = np.array([results.node("displacement", f)[:, 2].max() for f in range(len(results.times))])
    low = np.array([results.node("displacement", f)[:, 2].min() for f in range(len(results.times))])
    deflection, t = tip + low, results.times
    assert deflection.max() > 1e-6
    # The first mode is by far the strongest: the best fit of a cosine and a sine over twelve periods is its frequency.
    trials = np.arange(0.5, 1.5, 0.001) * frequency

    def left(f):
        basis = np.stack([np.cos(2 * np.pi * f * t), np.sin(2 * np.pi * f * t)], axis=1)
        return np.linalg.lstsq(basis, deflection, rcond=None)[1][0]

    found = min(trials, key=left)
    print("first frequency", found)
    assert found == pytest.approx(frequency, rel=0.02)


@pytest.mark.parametrize("material", ["gelatine", "lead"])
def test_stiffness_control_gives_no_energy_to_flattened_cells(kerf, material):
    """A cube that strikes a wall. Resistance that grew with the elastic stiffness and fell with the lesser one of cells
    that flow gave back more than it had taken: five times the initial energy of gelatine at 200 m/s."""
    shear, strength, bulk, density, speed = {
        "gelatine": (3e6, 0.2e6, 2e9, 1000, 200), "lead": (5.6e9, 10e6, 45e9, 11340, 300)}[material]
    law = {"density": density, "eos": {"type": "linear", "bulk_modulus": bulk},
           "strength": {"type": "elastic_plastic", "shear_modulus": shear, "yield_stress": strength,
                        "hardening_modulus": 0}}
    run = kerf({"title": f"{material} on a wall", "time": {"end": 5e-5}, "materials": {material: law},
                "parts": {"cube": {"material": material, "velocity": [0, 0, -speed],
                                   "mesh": {"type": "block", "size": [0.01] * 3, "origin": [0, 0, 1e-5],
                                            "cells": [10] * 3}}},
                "boundaries": [FLOOR]})
    energy = run.summary["energy"]
    taken = run.history["hourglass"]
    assert taken.min() >= -1e-3 * energy["initial"]  # a step's work is known half a step late
    assert energy["hourglass_given_back"] == 0.0
    assert abs(energy["balance_error"]) < 5e-3  # half of a kick's work is booked half a step late (test_bar_on_wall.py)
