"""Factors of parallel efficiency, as the POP Centre of Excellence defines them, and imbalance by its causes.

https://pop-coe.eu/node/69 and https://co-design.pop-coe.eu/metrics/ . The same functions serve predicted times and
measured ones: all they need is the useful time of each rank, the run time, and if known the run time on an ideal
network.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

# Phases that people want to see apart when they ask why ranks wait for each other.
CAUSES = {"elements": ("elements", "nodes", "loads"), "contact": ("contact_search", "contact_forces"),
          "erosion": ("erosion",), "rebalance": ("rebalance",), "exchange": ("halo",)}


@dataclass(frozen=True)
class Factors:
    """Each between 0 and 1 (computation scaling may exceed 1); None where it is not known."""
    load_balance: float
    communication_efficiency: float
    parallel_efficiency: float
    serialisation_efficiency: float | None
    transfer_efficiency: float | None
    computation_scaling: float | None
    global_efficiency: float | None

    def as_dict(self) -> dict:
        return asdict(self)


def factors(useful, runtime: float, ideal_runtime: float | None = None, reference_useful: float | None = None,
            ) -> Factors:
    """The factors of one run.

    `useful`: time that each rank computes [s]. `runtime`: of the whole [s]. `ideal_runtime`: on a network whose
    messages take no time [s]. `reference_useful`: sum of the useful times of the run that this one is compared with
    [s].

    load balance = mean / greatest useful time; communication efficiency = greatest useful time / run time; parallel
    efficiency = their product; serialisation = greatest useful time / ideal run time; transfer = ideal run time / run
    time; computation scaling = useful times of the reference / useful times; global efficiency = parallel efficiency
    times computation scaling.
    """
    useful = np.asarray(useful, dtype=float)
    if not runtime > 0.0:
        raise ValueError(f"a run time of {runtime} s; expected more than 0")
    if len(useful) == 0 or not np.all(useful >= 0.0) or not useful.max() > 0.0:
        raise ValueError("useful times without a rank, or negative, or all zero; expected a time for each rank")
    most, mean = useful.max(), useful.mean()
    serialisation = transfer = scaling = overall = None
    if ideal_runtime is not None:
        serialisation, transfer = float(most / ideal_runtime), float(ideal_runtime / runtime)
    if reference_useful is not None:
        scaling = float(reference_useful / useful.sum())
        overall = float(scaling * mean / runtime)
    return Factors(float(mean / most), float(most / runtime), float(mean / runtime), serialisation, transfer, scaling,
                   overall)


def imbalance(useful) -> float:
    """Greatest over mean; 1 where there is no work at all."""
    useful = np.asarray(useful, dtype=float)
    mean = useful.mean()
    return float(useful.max() / mean) if mean > 0.0 else 1.0


def imbalance_by_cause(useful_by_phase: dict[str, np.ndarray], runtime: float) -> dict[str, dict[str, float]]:
    """For each cause its imbalance, and the share of the run time that it would cost if ranks met after it.

    lost = (greatest - mean) / run time. Ranks that compute long in one phase and briefly in the next lose less, so the
    shares are bounds, and their sum may exceed what the load balance of the whole costs.
    """
    known = {phase for phases in CAUSES.values() for phase in phases}
    causes = {**CAUSES, **{phase: (phase,) for phase in useful_by_phase if phase not in known}}
    result = {}
    for cause, phases in causes.items():
        parts = [np.asarray(useful_by_phase[p], dtype=float) for p in phases if p in useful_by_phase]
        if not parts:
            continue
        useful = np.sum(parts, axis=0)
        result[cause] = {"imbalance": imbalance(useful), "lost": float((useful.max() - useful.mean()) / runtime)}
    return result
