"""What `precision: single` costs: the same runs in both precisions.

A float has 24 bits; its unit round-off is 6e-8. Stresses and pressures are rounded to that of themselves in every step.
Volumes, energies and what laws keep are doubles.
"""

import numpy as np
import pytest

UNIT = 2.0**-24
FIELDS = "output.element_fields=[pressure, von_mises, effective_plastic_strain, density, internal_energy]"
K_COPPER = 130e9  # of inputs/taylor_bar [Pa]


@pytest.fixture(scope="module")
def bars(kerf):
    settings = ("parts.bar.mesh.cell_size=0.7 mm", FIELDS, "output.precision=double")
    return {p: kerf("taylor_bar/taylor_bar.yaml", *settings, f"precision={p}") for p in ("double", "single")}


@pytest.fixture(scope="module")
def impacts(kerf):
    settings = ("parameters.cell_size=0.1 mm", "output.element_fields=[stress]", "output.precision=double")
    return {p: kerf("plate_impact/plate_impact.yaml", *settings, f"precision={p}") for p in ("double", "single")}


def test_the_bar_has_the_same_shape(bars):
    # A smooth problem of thousands of steps: round-off is not amplified, and its errors nearly cancel.
    exact, single = (bars[p].summary["measures"] for p in ("double", "single"))
    for name in ("length", "mushroom_radius"):
        assert single[name] == pytest.approx(exact[name], rel=100 * UNIT)


def test_energies_of_the_bar_agree_and_balance(bars):
    exact, single = (bars[p].summary["energy"] for p in ("double", "single"))
    # What a step's work loses by round-off, a few units of it, is random: after thousands of steps, some hundred units.
    for name in ("kinetic", "internal", "hourglass", "bulk_viscosity"):
        assert abs(single[name] - exact[name]) < 100 * UNIT * exact["initial"]
    assert abs(single["balance_error"] - exact["balance_error"]) < 100 * UNIT


def test_mass_is_the_same_and_momentum_is_conserved(bars):
    exact, single = (bars[p].summary for p in ("double", "single"))
    assert single["mass"] == exact["mass"]
    m = single["momentum"]
    missing = [f + e - i - x for f, e, i, x in zip(m["final"], m["eroded"], m["initial"], m["external_impulse"])]
    # Forces of an element are whole quanta that add up to nothing, in either precision. What is left is that a step
    # rounds the nodes' momenta, in doubles: see test_momentum_is_conserved_to_round_off in tests/regression.
    assert np.linalg.norm(missing) < 1e-12 * np.linalg.norm(m["initial"])


def test_fields_of_the_bar_agree(bars):
    exact, single = (bars[p].results for p in ("double", "single"))
    frame = len(exact.times) // 2
    # The pressure follows from the volume: its error is K times the volume's, some ten units, and what
    # waves that this sets off add.
    def error(name):
        return np.abs(single.cell(name, frame) - exact.cell(name, frame)).max()

    # What a step loses is a few units, random; after a walk of a thousand steps, less than a hundred.
    for name in ("pressure", "von_mises", "density", "effective_plastic_strain", "internal_energy"):
        scale = np.abs(exact.cell(name, frame)).max()
        assert error(name) < 100 * UNIT * scale, name


def test_an_elastic_plastic_wave_is_the_same(impacts):
    exact, single = (impacts[p].results for p in ("double", "single"))
    for frame in (-2, -1):
        reference = exact.cell("stress", frame)
        assert np.abs(reference).max() > 5e8
        assert np.abs(single.cell("stress", frame) - reference).max() < 100 * UNIT * 191.5e9  # K of the plate


def test_a_body_at_rest_stays_at_rest(kerf):
    # The volume is of doubles, so the pressure of an undeformed element is round-off of doubles, and the rest is zero.
    run = kerf("taylor_bar/taylor_bar.yaml", "parts.bar.mesh.cell_size=0.8 mm", "parts.bar.velocity=0 0 0 m/s",
               "precision=single", "output.element_fields=[pressure]", "output.precision=double")
    pressure = np.abs(run.results.cell("pressure", -1)).max()
    speed = np.linalg.norm(run.results.node("velocity", -1), axis=1).max()
    assert run.summary["cycles"] > 500
    assert pressure < 1e-13 * K_COPPER
    assert speed < 1e-13 * 4000.0  # of the sound speed
    assert abs(run.summary["energy"]["kinetic"]) < 1e-18


def test_a_slow_body_gains_no_energy(kerf):
    # Round-off as a share of the modulus, not of the stress, would heat a body without load by some 1e-8 J/kg a cycle:
    # ten times the energy of this one.
    run = kerf("taylor_bar/taylor_bar.yaml", "parts.bar.mesh.cell_size=0.8 mm", "boundaries=[]",
               "parts.bar.velocity=0.01 0.02 -0.005 m/s", "precision=single")
    assert run.summary["cycles"] > 500
    assert abs(run.summary["energy"]["balance_error"]) < 1e-9
