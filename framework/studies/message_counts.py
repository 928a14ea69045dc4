"""Reads what the library kerf_message_counts has written in a run, and sums it up by function, phase and cycle.

A cycle counts as eroding when erosion.csv has the death of an element in it. Collective operations are those of one
rank (the largest over ranks); messages and bytes are of all ranks together.
"""

from __future__ import annotations

import csv
import json
import re
from collections import defaultdict
from pathlib import Path
from statistics import fmean, median

# Names of the phases by their marks: the entries of timer_table in framework/core/timers.hpp, after "none".
PHASES = ("none", "setup", "elements", "nodes", "contact_search", "contact_forces", "loads", "halo", "erosion",
          "rebalance", "output", "observers")
OF_STEP = ("elements", "nodes", "contact_search", "contact_forces", "loads", "halo", "erosion")
OF_CYCLE = ("collectives", "messages", "bytes")


class CountsError(Exception):
    """Why there are no counts."""


def read_ranks(path: Path, n_ranks: int) -> list[dict]:
    """The files `<path>.<rank>.json` of all ranks."""
    found = []
    for rank in range(n_ranks):
        file = path.with_name(f"{path.name}.{rank}.json")
        try:
            found.append(json.loads(file.read_text(encoding="utf-8")))
        except (OSError, ValueError) as error:
            raise CountsError(f"{file} cannot be read: {error}") from error
    return found


def cycles_that_erode(folder: Path) -> set[int]:
    file = folder / "erosion.csv"
    if not file.exists():
        return set()
    with open(file, newline="", encoding="utf-8") as text:
        return {int(row["cycle"]) for row in csv.DictReader(text)}


def by_cycle(ranks: list[dict]) -> dict[int, dict[str, float]]:
    """Of each cycle: collective operations of one rank, messages and bytes of all ranks."""
    cycles: dict[int, dict[str, float]] = {}
    for book in ranks:
        for number, collectives, messages, n_bytes, _ in book["cycles"]:
            entry = cycles.setdefault(number, dict.fromkeys(OF_CYCLE, 0))
            entry["collectives"] = max(entry["collectives"], collectives)
            entry["messages"] += messages
            entry["bytes"] += n_bytes
    return cycles


def spread_of(values: list[float]) -> dict[str, float | None]:
    if not values:
        return {"mean": None, "median": None, "largest": None}
    return {"mean": fmean(values), "median": median(values), "largest": max(values)}


def by_function(ranks: list[dict], n_cycles: int) -> list[dict]:
    """Calls of one rank (the largest over ranks), bytes of all ranks, and seconds (mean over ranks)."""
    total: dict[tuple, dict] = defaultdict(lambda: {"calls": 0, "bytes": 0, "seconds": 0.0})
    for book in ranks:
        for entry in book["functions"]:
            number = entry["phase"]
            phase = PHASES[number] if number < len(PHASES) else f"phase {number}"
            sums = total[phase, entry["function"], entry["kind"]]
            sums["calls"] = max(sums["calls"], entry["calls"])
            sums["bytes"] += entry["bytes"]
            sums["seconds"] += entry["seconds"] / len(ranks)
    rows = []
    for (phase, function, kind), sums in sorted(total.items()):
        in_step = phase in OF_STEP
        rows.append({"phase": phase, "function": function, "kind": kind, "in_step": in_step, **sums,
                     "calls_per_cycle": sums["calls"] / n_cycles if in_step and n_cycles else None,
                     "bytes_per_cycle": sums["bytes"] / n_cycles if in_step and n_cycles else None})
    return rows


def counts_of(folder: Path, path: Path, n_ranks: int) -> dict:
    """All counts of one run. Throws CountsError where a file is missing or there is no cycle in it."""
    ranks = read_ranks(path, n_ranks)
    cycles = by_cycle(ranks)
    if not cycles:
        raise CountsError(f"{path}: no cycle was counted; expected a program that marks its cycles")
    eroding = cycles_that_erode(folder) & cycles.keys()
    parts = {"all": set(cycles), "eroding": eroding, "others": set(cycles) - eroding}
    per_cycle = {name: {"cycles": len(which)} | {
        what: spread_of([cycles[c][what] for c in sorted(which)]) for what in OF_CYCLE}
        for name, which in parts.items()}
    return {"per_cycle": per_cycle, "functions": by_function(ranks, len(cycles))}


def phases_of_source(header: Path) -> tuple[str, ...]:
    """The names in timer_table, for a test that PHASES is up to date."""
    table = re.search(r"timer_table\[\] = \{(.*?)\n\};", header.read_text(encoding="utf-8"), re.S).group(1)
    return ("none", *re.findall(r'\{"(\w+)"', table))
