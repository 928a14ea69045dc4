"""Writes runs in the format of DLB's TALP, one JSON for each, so that `talp ci-report` makes its pages of them.

The keys are those of DLB 3.5; TALP-Pages 3.6.1 gives runs without GPUs no label in the format of 3.6. Counters of the
processor are not known here: cycles and instructions are 0.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import pop
from point_folder import write_whole
from scaling import times_of_ranks

FORMAT = "3.5.0"  # of DLB, whose keys these are
IN_NS = 1.0e9


def region_of(useful: list[float], seconds: float) -> dict:
    """A region of the program. One rank is one CPU; there are no threads."""
    n = len(useful)
    found = pop.factors(useful, seconds)
    total = sum(useful)
    return {"numCpus": n, "avgCpus": float(n), "cycles": 0, "instructions": 0, "numMeasurements": 1, "numResets": 0,
            "numMpiCalls": 0, "numOmpParallels": 0, "numOmpTasks": 0, "elapsedTime": round(seconds * IN_NS),
            "usefulTime": round(total * IN_NS), "mpiTime": round((n * seconds - total) * IN_NS),
            "ompLoadImbalanceTime": 0, "ompSchedulingTime": 0, "ompSerializationTime": 0,
            "parallelEfficiency": found.parallel_efficiency, "mpiParallelEfficiency": found.parallel_efficiency,
            "mpiCommunicationEfficiency": found.communication_efficiency, "mpiLoadBalance": found.load_balance,
            # Which nodes the ranks are on is not known here: all of the imbalance is told as that within nodes.
            "mpiLoadBalanceIn": found.load_balance, "mpiLoadBalanceOut": 1.0,
            "ompParallelEfficiency": 1.0, "ompLoadBalance": 1.0, "ompSchedulingEfficiency": 1.0,
            "ompSerializationEfficiency": 1.0}


def talp_of(summary: dict, timestamp: str) -> dict:
    n = summary["ranks"]
    useful = times_of_ranks(summary["steps"]["work"], n)
    return {"dlbVersion": FORMAT, "timestamp": timestamp, "resources": {"numCpus": n, "numMpiRanks": n},
            "Application": {"Global": region_of(useful, summary["wall_seconds"])}}


def write_talp(runs: list[tuple[str, dict, str]], output: Path, case: str, weak: bool) -> int:
    """`runs`: name, summary and time stamp of each. Returns how many files were written."""
    place = output / "talp" / re.sub(r"\W+", "_", case) / ("weak_scaling" if weak else "strong_scaling")
    place.mkdir(parents=True, exist_ok=True)
    for file in place.glob("*.json"):
        file.unlink()
    for name, summary, timestamp in runs:
        write_whole(place / f"{name.replace('/', '_')}.json", json.dumps(talp_of(summary, timestamp), indent=1) + "\n")
    return len(runs)
