"""An explosive in a copper tube: the speed of the wall against cylinder tests and Gurney's formula."""

import math

import h5py
import numpy as np
import pytest

# Speeds seen at a fixed station after 6 and 19 mm of expansion [m/s], as the explosive's handbook says, to 3 %.
EXPERIMENTS = {"tnt_jwl": (1200.0, 1395.0, 6930.0, 1630.0), "comp_b_jwl": (1430.0, 1630.0, 7980.0, 1717.0)}


@pytest.fixture(scope="module", params=EXPERIMENTS)
def wall(request, kerf):
    run = kerf("copper_cylinder/copper_cylinder.yaml", f"materials.tnt.library={request.param}")
    with h5py.File(run.folder / "history.h5") as file:
        gauge = {name: values[:].ravel() for name, values in file["wall"].items() if name != "id"}
    return run, gauge, EXPERIMENTS[request.param]


def at(gauge, expansion, quantity):
    return np.interp(expansion, gauge["displacement_x"], gauge[quantity])


def seen_speed(gauge, expansion, detonation_velocity):
    """What a slit that stays in place sees of a wall that also moves along the tube: the mean over 3 mm, because the
    wall rings while shocks run to and fro in it [m/s]."""
    begin, end = expansion - 1.5e-3, min(expansion + 1.5e-3, gauge["displacement_x"][-1])
    radial = (end - begin) / (at(gauge, end, "time") - at(gauge, begin, "time"))
    return radial / (1 - at(gauge, expansion, "velocity_z") / detonation_velocity)


def test_the_wall_is_as_fast_as_in_the_experiment(wall):
    _, gauge, (at_6_mm, at_19_mm, detonation_velocity, _) = wall
    # The experiment's own uncertainty.
    assert seen_speed(gauge, 6e-3, detonation_velocity) == pytest.approx(at_6_mm, rel=0.03)
    assert seen_speed(gauge, 19e-3, detonation_velocity) == pytest.approx(at_19_mm, rel=0.03)


def test_the_wall_is_almost_as_fast_as_gurney_says(wall):
    _, gauge, (_, _, _, density) = wall
    energy_speed = {1630.0: 2440.0, 1717.0: 2700.0}[density]  # sqrt(2E) of the handbook
    ratio = 8930.0 * (15.306**2 - 12.7**2) / (density * 12.7**2)
    speed = math.hypot(at(gauge, 19e-3, "velocity_x"), at(gauge, 19e-3, "velocity_z"))
    # The mark for this case is 6 %. The formula knows neither the strength of copper nor the ends of the tube.
    assert speed == pytest.approx(energy_speed / math.sqrt(ratio + 0.5), rel=0.06)


def test_the_energy_of_the_explosive_is_in_the_books(wall):
    run, _, _ = wall
    energy = run.summary["energy"]
    assert energy["chemical"] == pytest.approx(0.0, abs=1e-6 * energy["released"])
    assert np.abs(run.history["balance_error"]).max() < 5e-3
