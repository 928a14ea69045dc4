"""The first 25 us of a blunt projectile in a plate of Weldox 460 E, on a coarse mesh: balances, and bounds of the speed
that follow from momentum alone. The residual speed needs a fine mesh, and minutes: pytest -m slow."""

import numpy as np
import pytest

SPEED, MASS = 303.5, 0.197 / 4  # of the quarter that is computed
THICKNESS, RADIUS, DENSITY = 12e-3, 10e-3, 7850.0
PLUG = DENSITY * THICKNESS * np.pi * RADIUS**2 / 4
END = 25e-6


@pytest.fixture(scope="module")
def plate(kerf):
    return kerf("weldox_plate/weldox_plate.yaml", "parameters.cell_size=1.5 mm", "parameters.projectile_cell=2.5 mm",
                "time.end=25 us")


def test_the_projectile_has_the_mass_of_the_experiment(plate):
    # 0.197 kg has three digits; facets take 1 % and less of the round section.
    assert plate.summary["parts"]["projectile"]["mass"] == pytest.approx(MASS, rel=0.01)


def test_the_speed_is_between_a_free_plug_and_a_plug_held_by_all_its_shear(plate):
    """Above: the projectile has shared its momentum with a plug that nothing holds. Below: the plug is held from the
    start, round its whole edge, by 1.4 GPa / sqrt(3): what the law gives at a strain of 0.5 and 1e5 /s without heat.
    The plate outside is carried along, too, by as much as a plug again; hence three plugs."""
    held = 1.4e9 / np.sqrt(3) * THICKNESS * np.pi * RADIUS / 2 * END
    free = MASS * SPEED / (MASS + PLUG)
    assert (MASS * SPEED - held) / (MASS + 3 * PLUG) < plate.summary["measures"]["projectile.speed"] < free


def test_energy_and_mass_balance(plate):
    assert np.abs(plate.history["balance_error"]).max() < 5e-3  # the mark set for this case
    mass = plate.summary["mass"]
    assert mass["live"] + mass["free_nodes"] + mass["dropped"] == pytest.approx(mass["initial"], rel=1e-9)


def test_momentum_is_what_the_start_and_the_outside_gave(plate):
    momentum = plate.summary["momentum"]
    for axis in range(3):
        given = momentum["initial"][axis] + momentum["external_impulse"][axis]
        kept = momentum["final"][axis] + momentum["eroded"][axis]
        assert kept == pytest.approx(given, abs=1e-6 * MASS * SPEED)  # round-off over a few hundred cycles


@pytest.mark.slow
def test_the_residual_speed_is_that_of_the_experiment(kerf):
    """132.6 m/s, Borvik et al. 2002. The mark for this case is 8 %; the mesh of the input comes out 5 % low, one of 0.3
    mm 4 % high."""
    run = kerf("weldox_plate/weldox_plate.yaml", "parameters.velocity=0 0 -244.2 m/s", "time.end=120 us", timeout=3600)
    assert run.summary["measures"]["projectile.speed"] == pytest.approx(132.6, rel=0.08)
    assert run.summary["measures"]["hole.perforated"] == 1
