"""Fits against made data with known answers: ballistic limits, and orders of convergence."""

import numpy as np
import pytest
from study_case import STUDIES  # noqa: F401  makes the modules of studies known

import fits

SPEEDS = np.array([200.0, 230.0, 260.0, 300.0, 400.0, 600.0])


def made(a=0.87, limit=185.0, p=2.0, speeds=SPEEDS):
    return a * (speeds**p - limit**p) ** (1.0 / p)


# ---- ballistic limit

@pytest.mark.parametrize("p", [2.0, 3.0])
def test_the_limit_and_the_factor_are_found(p):
    found = fits.fit_ballistic_limit(SPEEDS, made(p=p), p=p)
    assert (found.limit, found.a, found.p) == pytest.approx((185.0, 0.87, p), rel=1e-6)
    assert found.rms < 1e-4


def test_the_exponent_is_found_where_it_is_free():
    found = fits.fit_ballistic_limit(SPEEDS, made(p=2.4), p=None)
    assert (found.limit, found.a, found.p) == pytest.approx((185.0, 0.87, 2.4), rel=1e-4)


def test_a_fixed_factor_needs_two_points():
    found = fits.fit_ballistic_limit([220.0, 300.0], made(speeds=np.array([220.0, 300.0])), a=0.87)
    assert found.limit == pytest.approx(185.0, rel=1e-6)
    assert "a" not in found.intervals


def test_points_that_were_stopped_do_not_enter():
    speeds, residual = np.append(SPEEDS, [150.0, 180.0]), np.append(made(), [-11.0, 0.0])
    found = fits.fit_ballistic_limit(speeds, residual)
    assert found.limit == pytest.approx(185.0, rel=1e-6) and found.n_perforating == 6 and not found.notes


def test_a_point_that_was_stopped_above_the_limit_is_told():
    found = fits.fit_ballistic_limit(np.append(SPEEDS, 210.0), np.append(made(), -3.0))
    assert any("stopped at 210 m/s, which is above the fitted limit" in note for note in found.notes)


def test_the_interval_holds_the_truth_as_often_as_it_says():
    """With noise of 2 m/s, intervals of 90 % hold the limit in 90 % of the draws; 300 draws scatter by 1.7 %."""
    draws = np.random.default_rng(7)
    held = 0
    for _ in range(300):
        low, high = fits.fit_ballistic_limit(SPEEDS, made() + draws.normal(0.0, 2.0, SPEEDS.size),
                                             confidence=0.9).intervals["limit"]
        held += low < 185.0 < high
    assert 0.84 < held / 300 < 0.96


def test_the_interval_widens_with_the_confidence():
    noisy = made() + np.array([2.0, -1.0, 1.5, -2.0, 1.0, -0.5])
    (low, high), (lower, higher) = (fits.fit_ballistic_limit(SPEEDS, noisy, confidence=c).intervals["limit"]
                                    for c in (0.5, 0.99))
    assert lower < low < high < higher


def test_as_many_unknowns_as_points_have_no_interval():
    found = fits.fit_ballistic_limit(SPEEDS[:2], made()[:2])
    assert found.intervals == {"limit": None, "a": None}
    assert any("no interval" in note for note in found.notes)


@pytest.mark.parametrize("residual, sentence", [
    ([-1.0, 0.0], "there are no perforating points; expected two or more"),
    ([-1.0, 50.0], "there is 1 perforating point; expected two or more")])
def test_fewer_than_two_perforating_points_are_refused(residual, sentence):
    with pytest.raises(fits.Refused, match=sentence):
        fits.fit_ballistic_limit([150.0, 200.0], residual)


def test_too_few_points_for_a_free_exponent_are_refused():
    with pytest.raises(fits.Refused, match=r"2 perforating speeds cannot give 3 unknowns \(limit, a, p\)"):
        fits.fit_ballistic_limit(SPEEDS[:2], made()[:2], p=None)


def test_points_that_do_not_determine_the_factor_say_so():
    """A constant is no relation of this kind."""
    found = fits.fit_ballistic_limit(SPEEDS, np.full(6, 0.001))
    assert any("ended at the bound" in note for note in found.notes)
    assert set(found.intervals.values()) == {None}


@pytest.mark.parametrize("striking, residual", [
    ([900.0, 1000.0, 1100.0], [800.0, 600.0, 500.0]), ([800.0, 1000.0, 1200.0, 1400.0], [700.0, 860.0, 1010.0, 1150.0]),
    ([800.0, 1000.0, 1200.0], [400.0, 500.0, 600.0])])
def test_points_without_a_limit_are_refused(striking, residual):
    """Residual speeds in proportion, or more than that, come from a limit of zero."""
    with pytest.raises(fits.Refused, match="the best fit has a limit of zero"):
        fits.fit_ballistic_limit(striking, residual)


def test_a_limit_that_the_points_say_little_of_has_no_interval():
    found = fits.fit_ballistic_limit([800.0, 1000.0, 1200.0, 1400.0], [700.0, 860.0, 1010.0, 1150.0], p=None)
    assert set(found.intervals.values()) == {None}
    assert any("do not determine" in note for note in found.notes)


def test_intervals_are_those_of_the_usual_formula():
    """Standard errors as curve_fit gives them, for a problem that is well posed."""
    from scipy.optimize import curve_fit
    from scipy.stats import t
    noisy = made() + np.array([2.0, -1.0, 1.5, -2.0, 1.0, -0.5])
    found = fits.fit_ballistic_limit(SPEEDS, noisy)
    best, covariance = curve_fit(lambda v, limit, a: fits.lambert_jonas(v, a, limit, 2.0), SPEEDS, noisy, [180.0, 0.9])
    width = np.sqrt(np.diag(covariance)) * t.ppf(0.975, 4)
    assert found.intervals["limit"] == pytest.approx((best[0] - width[0], best[0] + width[0]), rel=1e-4)
    assert found.intervals["a"] == pytest.approx((best[1] - width[1], best[1] + width[1]), rel=1e-4)


def test_a_striking_speed_of_zero_is_refused():
    with pytest.raises(fits.Refused, match="striking speed of zero"):
        fits.fit_ballistic_limit([0.0, 300.0, 400.0], [10.0, 200.0, 300.0])


# ---- convergence

def test_an_order_above_that_of_the_method_is_told():
    found = fits.convergence((1.0, 2.0, 4.0), results((1.0, 2.0, 4.0), 4.0))[0]
    assert found.order == pytest.approx(4.0) and "says that the meshes are not fine enough" in found.sentence()
    # Factor 3, order 2: f = 5 + 3 h^4 at h = 1, 2.
    assert found.index_fine == pytest.approx(3.0 * (48.0 - 3.0) / 8.0 / 3.0)
    assert "not fine enough" not in fits.convergence((1.0, 2.0, 4.0), results((1.0, 2.0, 4.0), 2.1))[0].sentence()


def test_a_result_of_zero_has_no_index():
    found = fits.convergence((1.0, 2.0, 4.0), (0.0, 3.0, 15.0))[0]
    assert found.index_fine is None and "none (finest mesh, whose result is 0)" in found.sentence()


def results(sizes, order, exact=5.0, slope=3.0):
    return [exact + slope * h**order for h in sizes]


@pytest.mark.parametrize("order", [0.7, 1.0, 2.0, 3.5])
@pytest.mark.parametrize("sizes", [(1.0, 2.0, 4.0), (0.32, 0.4, 0.64), (1.0, 1.1, 3.0)])
def test_the_order_and_the_limit_are_found(sizes, order):
    found = fits.convergence(sizes, results(sizes, order))[0]
    assert found.behaviour == "monotone"
    assert found.order == pytest.approx(order, rel=1e-8)
    assert found.extrapolated == pytest.approx(5.0, rel=1e-8)


def test_the_index_is_that_of_roache():
    """Fs |(f2 - f1) / f1| / (r^p - 1), with f = 5 + 3 h^2 at h = 1, 2: 1.25 * 9 / 8 / 3."""
    found = fits.convergence((4.0, 1.0, 2.0), results((4.0, 1.0, 2.0), 2.0))[0]
    assert found.index_fine == pytest.approx(1.25 * 9.0 / 8.0 / 3.0, rel=1e-9)
    assert found.index_middle == pytest.approx(1.25 * 36.0 / 17.0 / 3.0, rel=1e-9)


@pytest.mark.parametrize("numbers, behaviour, sentence", [
    ((1.0, 1.2, 0.9), "oscillating", "not monotone"), ((1.0, 2.0, 2.5), "diverging", "not converging"),
    ((1.0, 2.0, 3.0), "diverging", "not converging"), ((1.0, 1.0, 2.0), "unchanged", "the same number")])
def test_what_does_not_converge_has_no_order(numbers, behaviour, sentence):
    found = fits.convergence((1.0, 2.0, 4.0), numbers)[0]
    assert found.behaviour == behaviour and found.order is None and found.index_fine is None
    assert sentence in found.sentence()


def test_four_meshes_give_two_orders():
    sizes = (1.0, 2.0, 4.0, 8.0)
    assert [t.order for t in fits.convergence(sizes, results(sizes, 2.0))] == pytest.approx([2.0, 2.0])


@pytest.mark.parametrize("sizes, sentence", [((1, 2), "there are 2 meshes; expected three or more"),
                                             ((1, 2, 2), "two points have the same size"),
                                             ((0, 1, 2), "expected more than zero")])
def test_meshes_that_tell_no_order_are_refused(sizes, sentence):
    with pytest.raises(fits.Refused, match=sentence):
        fits.convergence(sizes, results(sizes, 1.0))
