"""What `precision: single` costs: the same runs in both precisions.

A float has 24 bits; its unit round-off is 6e-8. Volumes are known to some ten of those, pressures to that share of the
bulk modulus, stresses to it of themselves. Energies and what laws keep are doubles.
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
    for name in ("kinetic", "internal", "hourglass", "bulk_viscosity"):
        assert single[name] == pytest.approx(exact[name], rel=1e-5, abs=1e-5 * exact["initial"])
    # What a step's work loses by round-off, a few units, is random and adds up over the steps as a walk.
    assert abs(single["balance_error"] - exact["balance_error"]) < 1e-5


def test_mass_is_the_same_and_momentum_is_conserved(bars):
    exact, single = (bars[p].summary for p in ("double", "single"))
    assert single["mass"] == exact["mass"]
    m = single["momentum"]
    missing = [f + e - i - x for f, e, i, x in zip(m["final"], m["eroded"], m["initial"], m["external_impulse"])]
    # Forces of an element are whole quanta that add up to nothing, in either precision.
    assert np.linalg.norm(missing) < 1e-12 * np.linalg.norm(m["initial"])


def test_fields_of_the_bar_agree(bars):
    exact, single = (bars[p].results for p in ("double", "single"))
    frame = len(exact.times) // 2
    # The pressure follows from the volume: its error is K times the volume's, some ten units, and waves that this sets off.
    error = np.abs(single.cell("pressure", frame) - exact.cell("pressure", frame)).max()
    print(f"pressure {error:.3g} Pa, {error / K_COPPER / UNIT:.3g} units of K")
    assert error < 100 * UNIT * K_COPPER
    strain, expected = (r.cell("effective_plastic_strain", frame) for r in (single, exact))
    print(f"plastic strain {np.abs(strain - expected).max():.3g} of {expected.max():.3g}")
    assert np.abs(strain - expected).max() < 1e-5 * expected.max()
    assert single.cell("density", frame) == pytest.approx(exact.cell("density", frame), rel=1e-5)
    assert single.cell("internal_energy", frame) == pytest.approx(exact.cell("internal_energy", frame), rel=1e-3, abs=1.0)


def test_an_elastic_plastic_wave_is_the_same(impacts):
    exact, single = (impacts[p].results for p in ("double", "single"))
    for frame in (-2, -1):
        reference = exact.cell("stress", frame)
        assert np.abs(reference).max() > 5e8
        assert np.abs(single.cell("stress", frame) - reference).max() < 100 * UNIT * 191.5e9  # K of the plate


def test_a_body_at_rest_stays_at_rest(kerf):
    # Initial pressures are round-off of the volume instead of zero: what they set off must stay that small.
    run = kerf("taylor_bar/taylor_bar.yaml", "parts.bar.mesh.cell_size=0.8 mm", "parts.bar.velocity=0 0 0 m/s",
               "precision=single", "output.element_fields=[pressure]", "output.precision=double")
    pressure = np.abs(run.results.cell("pressure", -1)).max()
    speed = np.linalg.norm(run.results.node("velocity", -1), axis=1).max()
    print(f"pressure {pressure:.3g} Pa, speed {speed:.3g} m/s after {run.summary['cycles']} cycles")
    assert pressure < 30 * UNIT * K_COPPER
    assert speed < 30 * UNIT * 4000.0  # of the sound speed
