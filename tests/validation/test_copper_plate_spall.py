"""The velocity of the free surface of a copper plate that spalls, against closed forms."""

import h5py
import numpy as np
import pytest

DENSITY, SOUND, SLOPE, SPEED, LIMIT = 8930.0, 3940.0, 1.489, 300.0, 1.5e9  # the input's copper, impact and tension


class Signal:
    def __init__(self, run):
        with h5py.File(run.folder / "history.h5") as file:
            gauge = file["free_surface"]
            self.time, self.velocity = gauge["time"][:].ravel(), gauge["velocity_x"][:].ravel()
        self.arrival = np.interp(SPEED / 2, *self.rise())
        self.run = run

    def rise(self):
        top = int(np.argmax(self.velocity > 0.9 * SPEED))
        return self.velocity[:top + 1], self.time[:top + 1]

    def median(self, start, end):
        """Of the velocity between two times after the arrival [s]."""
        since = self.time - self.arrival
        return np.median(self.velocity[(since > start) & (since < end)])


@pytest.fixture(scope="module")
def signal(kerf):
    return Signal(kerf("copper_plate_spall/copper_plate_spall.yaml"))


def test_the_shock_arrives_in_time_and_throws_the_surface_at_the_speed_of_the_flyer(signal):
    # The front is some seven cells wide, 35 ns, of which half is before the middle.
    assert signal.arrival == pytest.approx(16e-3 / (SOUND + SLOPE * SPEED / 2), abs=30e-9)
    # Between equal plates; bulk viscosity heats the metal at the impact, not here.
    assert signal.median(0.08e-6, 0.18e-6) == pytest.approx(SPEED, rel=2e-3)


def test_the_pull_back_is_that_of_the_spall_stress(signal):
    pull_back = signal.median(0.08e-6, 0.18e-6) - signal.median(0.42e-6, 0.51e-6)
    # What experiments are evaluated by; of first order in the stress.
    assert pull_back == pytest.approx(2 * LIMIT / (DENSITY * SOUND), rel=0.05)
    # Along the Hugoniot, from which the release isentrope differs in third order only.
    u = np.roots([DENSITY * SLOPE, -DENSITY * SOUND, LIMIT]).min()
    assert pull_back == pytest.approx(2 * u, rel=0.01)


def test_the_surface_is_thrown_again_by_the_wave_from_the_gap(signal):
    since = signal.time - signal.arrival
    assert signal.velocity[(since > 0.55e-6) & (since < 0.63e-6)].max() > SPEED
    eroded = signal.run.summary["eroded"]
    assert eroded["by_part"]["flyer"] == 0 and 1 <= eroded["by_part"]["target"] <= 20


def test_energy_balances(signal):
    # Deleted cells take their energy with them, which the books keep; the rest is round-off and the caps of tension.
    assert np.abs(signal.run.history["balance_error"]).max() < 1e-3
