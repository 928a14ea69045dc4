"""Symmetric plate impact in one-dimensional strain against the closed forms of an elastic-plastic double wave."""

import math

import numpy as np
import pytest

RHO, G, K, Y, SPEED = 7805.0, 78.33e9, 191.5e9, 1.103e9, 100.0  # plate of the reference case, SI
C_ELASTIC = math.sqrt((K + 4.0 * G / 3.0) / RHO)
C_PLASTIC = math.sqrt(K / RHO)
HEL = Y * (K / (2.0 * G) + 2.0 / 3.0)
SIGMA = HEL + RHO * C_PLASTIC * (SPEED / 2.0 - HEL / (RHO * C_ELASTIC))
PRESSURE = SIGMA - 2.0 * Y / 3.0
TOLERANCE = 0.01  # the closed forms are of first order in the strain, which is 0.8 %


class Wave:
    """Stress along the target, by the positions of the undeformed cells: wave speeds are those of the closed forms."""

    def __init__(self, run):
        self.results = run.results
        self.target = self.results.part == 1
        x = self.results.centres(0)[self.target, 0]
        self.x, self.column = np.unique(np.round(x, 9), return_inverse=True)
        self.times = self.results.times

    def profile(self, name, frame, component=None):
        values = self.results.cell(name, frame)[self.target]
        values = values if component is None else values[:, component]
        return np.bincount(self.column, values) / np.bincount(self.column)

    def stress(self, frame):
        return -self.profile("stress", frame, 0)

    def front(self, level, frame):
        """Where the stress passes a level, the last time along the target."""
        s = self.stress(frame)
        i = np.nonzero(s > level)[0][-1]
        return self.x[i] + (self.x[i + 1] - self.x[i]) * (s[i] - level) / (s[i] - s[i + 1])

    def speed(self, level):
        frames = [i for i, t in enumerate(self.times) if t > 0.5e-6]
        fronts = [self.front(level, i) for i in frames]
        return np.polyfit(self.times[frames], fronts, 1)[0]

    def mean(self, values, low, high):
        inside = (self.x > low) & (self.x < high)
        assert inside.sum() >= 5
        return values[inside].mean()


@pytest.fixture(scope="module")
def runs(kerf):
    return [kerf("plate_impact/plate_impact.yaml", f"parameters.cell_size={h} mm") for h in (0.2, 0.1, 0.05)]


@pytest.fixture(scope="module")
def waves(runs):
    return [Wave(run) for run in runs]


@pytest.fixture(scope="module")
def wave(waves):
    return waves[1]  # the mesh of the input file


def test_closed_forms_are_those_of_the_reference_data():
    assert SIGMA == pytest.approx(2.34056e9, rel=1e-5)
    assert PRESSURE == pytest.approx(1.60522e9, rel=1e-5)


def test_elastic_precursor_runs_at_the_longitudinal_wave_speed(wave):
    assert wave.speed(HEL / 2.0) == pytest.approx(C_ELASTIC, rel=TOLERANCE)


def test_plastic_wave_runs_at_the_bulk_wave_speed(wave):
    assert wave.speed((HEL + SIGMA) / 2.0) == pytest.approx(C_PLASTIC, rel=TOLERANCE)


def test_precursor_has_the_hugoniot_elastic_limit(waves):
    fine = waves[2]
    t = fine.times[-1]
    plateau = fine.mean(fine.stress(-1), C_PLASTIC * t + 5e-4, C_ELASTIC * t - 5e-4)  # ten cells off both fronts
    assert plateau == pytest.approx(HEL, rel=TOLERANCE)


def test_stress_and_pressure_behind_the_plastic_wave(wave):
    t = wave.times[-1]
    ends = 0.0, C_PLASTIC * t - 1e-3  # ten cells behind the plastic front
    assert wave.mean(wave.stress(-1), *ends) == pytest.approx(SIGMA, rel=TOLERANCE)
    assert wave.mean(wave.profile("pressure", -1), *ends) == pytest.approx(PRESSURE, rel=TOLERANCE)
    assert np.ptp(wave.stress(-1)[wave.x < ends[1]]) < TOLERANCE * SIGMA  # no ringing either


def test_stress_deviator_is_on_the_yield_surface_behind_the_front(wave):
    behind = (wave.x > 1e-3) & (wave.x < 0.8 * C_PLASTIC * wave.times[-1])  # ten cells off the impact face
    assert np.allclose(wave.profile("von_mises", -1)[behind], Y, rtol=2e-3)  # hardening: 0.1 GPa times 1e-3


def test_energy_is_balanced_and_momentum_conserved(runs):
    run = runs[1]
    assert abs(run.summary["energy"]["balance_error"]) < 1e-3
    initial, final = (np.array(run.summary["momentum"][key]) for key in ("initial", "final"))
    assert np.abs(final - initial)[0] < 1e-12 * abs(initial[0])


@pytest.mark.xfail(strict=True, reason="order 0.45 since contact no longer softens the first front; not yet explained")
def test_solution_converges_with_first_order_in_the_mean(waves):
    """Differences of the stress profiles of three meshes, as the integral over the target: shocks are spread over a
    fixed number of cells, so the differences must shrink as the cells do."""
    grid = np.linspace(0.1e-3, 9.9e-3, 981)
    profiles = []
    for w in waves:
        # To the time 1.5 us exactly: the last frame is there.
        assert w.times[-1] == pytest.approx(1.5e-6, rel=1e-6)
        profiles.append(np.interp(grid, w.x, w.stress(-1)))
    coarse = np.abs(profiles[0] - profiles[1]).mean()
    fine = np.abs(profiles[1] - profiles[2]).mean()
    order = math.log2(coarse / fine)
    exact = np.where(grid < C_PLASTIC * 1.5e-6, SIGMA, np.where(grid < C_ELASTIC * 1.5e-6, HEL, 0.0))
    errors = [np.abs(p - exact).mean() / SIGMA for p in profiles]
    print("order", order, "mean errors", errors)
    assert 0.7 < order < 1.3
    assert errors[0] > errors[1] > errors[2]
