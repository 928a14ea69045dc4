#!/usr/bin/env python3
"""Compares two runs: state hash, every number of their summaries, and their histories.

Exit code 0: the states are the same bit for bit, or all numbers agree within the tolerance; 3: they differ.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from results import read_history, read_summary  # noqa: E402

# How a run was computed, not what it computed.
NOT_PHYSICS = ("wall_seconds", "element_cycles_per_second", "timers", "rebalances", "ranks", "input", "kerf_version",
               "state_hash", "imbalance")


def flatten(value, name: str = "") -> dict[str, object]:
    """{'energy': {'kinetic': 1.0}} -> {'energy.kinetic': 1.0}"""
    if isinstance(value, dict):
        items = value.items()
    elif isinstance(value, list):
        items = enumerate(value)
    else:
        return {name: value}
    flat: dict[str, object] = {}
    for key, inner in items:
        flat.update(flatten(inner, f"{name}.{key}" if name else str(key)))
    return flat


def is_number(value) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def relative_difference(a: float, b: float) -> float:
    if a == b or (np.isnan(a) and np.isnan(b)):
        return 0.0
    difference = abs(a - b) / max(abs(a), abs(b))
    return float(difference) if np.isfinite(difference) else float("inf")


def compare_summaries(a: dict, b: dict, tolerance: float, every: bool) -> int:
    """Prints a table; returns how many physical quantities differ by more than the tolerance."""
    flat_a, flat_b = flatten(a), flatten(b)
    differing = 0
    print(f"{'quantity':<44}{'A':>18}{'B':>18}{'difference':>14}")
    for name in [*flat_a, *(name for name in flat_b if name not in flat_a)]:
        left, right = flat_a.get(name, "-"), flat_b.get(name, "-")
        physics = name.split(".")[0] not in NOT_PHYSICS
        if is_number(left) and is_number(right):
            difference = relative_difference(left, right)
            text = f"{difference:.2e}" if difference else "same"
            differs = difference > tolerance
            left, right = f"{left:.9g}", f"{right:.9g}"
        else:
            differs = left != right
            text = "DIFFERS" if differs else "same"
        if physics and differs:
            differing += 1
            text = "* " + text
        if every or text != "same":
            print(f"{name:<44}{str(left)[:17]:>18}{str(right)[:17]:>18}{text:>14}")
    return differing


def compare_histories(a: dict[str, np.ndarray], b: dict[str, np.ndarray], tolerance: float) -> int:
    """Prints the largest difference of each column over the common time span, in parts of the column's range."""
    if not len(a.get("time", [])) or not len(b.get("time", [])):
        print("history: missing or empty in one of the two, not compared")
        return 0
    differing = 0
    time = a["time"][a["time"] <= b["time"][-1]]
    print(f"\nhistory, {len(a['time'])} and {len(b['time'])} rows: largest difference of each column, and when")
    for name in a:
        if name == "time" or name not in b or len(time) == 0:
            continue
        other = np.interp(time, b["time"], b[name])
        gap = np.abs(a[name][: len(time)] - other)
        scale = max(np.abs(a[name]).max(), np.abs(b[name]).max())
        worst = int(np.argmax(gap))
        relative = gap[worst] / scale if scale > 0.0 else 0.0
        marked = relative > tolerance and name not in NOT_PHYSICS
        differing += marked
        if gap[worst] > 0.0:
            mark = "*" if marked else " "
            print(f"{mark} {name:<28}{gap[worst]:>14.6g} ({relative:.2e} of its range) at {time[worst] * 1e6:.4g} µs")
    return differing


def main() -> int:
    parser = argparse.ArgumentParser(prog="kerf compare", description=__doc__.splitlines()[0])
    parser.add_argument("a", type=Path, metavar="A", help="output folder of one run")
    parser.add_argument("b", type=Path, metavar="B", help="output folder of the other run")
    parser.add_argument("--tolerance", type=float, default=0.0, help="relative difference that counts as equal")
    parser.add_argument("--all", action="store_true", help="list quantities that are the same, too")
    arguments = parser.parse_args()
    summaries = []
    for folder in (arguments.a, arguments.b):
        summary = read_summary(folder)
        if not summary:
            print(f"kerf compare: there is no {folder / 'summary.json'}", file=sys.stderr)
            return 1
        summaries.append(summary)
    differing = compare_summaries(*summaries, arguments.tolerance, arguments.all)
    histories = [read_history(folder / "history.csv") for folder in (arguments.a, arguments.b)]
    differing += compare_histories(*histories, arguments.tolerance)
    hashes = [summary.get("state_hash", "") for summary in summaries]
    same_state = bool(hashes[0]) and hashes[0] == hashes[1]
    print(f"\nstate hash: {'the same' if same_state else 'different'} ({hashes[0] or 'none'}, {hashes[1] or 'none'})")
    if same_state and differing == 0:
        print("The two runs ended in the same state, bit for bit.")
    elif differing == 0:
        print(f"All numbers agree within {arguments.tolerance:g}.")
    else:
        print(f"{differing} quantities (marked *) differ by more than {arguments.tolerance:g}.")
    return 3 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
