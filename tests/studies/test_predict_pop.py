"""The factors of POP: their definitions on numbers that can be checked by hand."""

import numpy as np
import pytest
from predict_scenes import STUDIES  # noqa: F401  # makes the modules known

import pop


def test_factors_by_hand():
    f = pop.factors([6.0, 8.0, 10.0, 8.0], runtime=16.0, ideal_runtime=12.5, reference_useful=30.0)
    assert f.load_balance == pytest.approx(0.8)
    assert f.communication_efficiency == pytest.approx(10.0 / 16.0)
    assert f.parallel_efficiency == pytest.approx(0.5)
    assert f.serialisation_efficiency == pytest.approx(0.8)
    assert f.transfer_efficiency == pytest.approx(12.5 / 16.0)
    assert f.computation_scaling == pytest.approx(30.0 / 32.0)
    assert f.global_efficiency == pytest.approx(0.5 * 30.0 / 32.0)


def test_factors_are_products_of_their_parts():
    rng = np.random.default_rng(3)
    for _ in range(100):
        useful = rng.uniform(0.1, 1.0, 17)
        ideal = useful.max() * rng.uniform(1.0, 2.0)
        f = pop.factors(useful, ideal * rng.uniform(1.0, 2.0), ideal, 9.0)
        assert f.parallel_efficiency == pytest.approx(f.load_balance * f.communication_efficiency)
        assert f.communication_efficiency == pytest.approx(f.serialisation_efficiency * f.transfer_efficiency)
        assert f.global_efficiency == pytest.approx(f.parallel_efficiency * f.computation_scaling)


def test_measured_runs_have_no_ideal_network():
    f = pop.factors([1.0, 1.0], 2.0)
    assert f.serialisation_efficiency is None and f.transfer_efficiency is None and f.global_efficiency is None
    assert f.parallel_efficiency == 0.5


@pytest.mark.parametrize("useful, runtime", [([1.0], 0.0), ([], 1.0), ([0.0, 0.0], 1.0), ([1.0, -1.0], 1.0),
                                             ([1.0, float("nan")], 1.0)])
def test_times_that_cannot_be_are_refused(useful, runtime):
    with pytest.raises(ValueError, match="expected"):
        pop.factors(useful, runtime)


def test_causes_of_imbalance():
    causes = pop.imbalance_by_cause({"elements": [3.0, 1.0], "nodes": [1.0, 1.0], "contact_forces": [0.0, 4.0],
                                     "weather": [1.0, 1.0]}, runtime=8.0)
    assert causes["elements"] == {"imbalance": pytest.approx(4.0 / 3.0), "lost": pytest.approx(1.0 / 8.0)}
    assert causes["contact"] == {"imbalance": 2.0, "lost": pytest.approx(2.0 / 8.0)}
    assert causes["weather"] == {"imbalance": 1.0, "lost": 0.0}
    assert "erosion" not in causes


def test_no_work_is_balanced():
    assert pop.imbalance([0.0, 0.0]) == 1.0
