#!/usr/bin/env python3
"""Compares two runs: state hash, every number of their summaries, and their histories.

Exit code 0: the states are the same bit for bit, or all numbers agree within the tolerance; 3: they differ.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

try:
    import numpy as np
    from results import ResultsError, read_history, read_observers, read_summary
except ModuleNotFoundError as error:
    sys.exit(f"kerf compare: the Python package {error.name} is missing; ./kerf build installs it, unless KERF_PYTHON "
             "names another Python")

# How a run was computed or what it was called, not what it computed.
NOT_PHYSICS = ("wall_seconds", "element_cycles_per_second", "timers", "steps", "rebalances", "work", "ranks", "input",
               "title", "kerf_version", "state_hash", "imbalance")


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


def shown(value) -> str:
    """As it stands in the file: null is a measure that has no value, "-" a quantity that is missing altogether."""
    return "null" if value is None else str(value)[:17]


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
            print(f"{name:<44}{shown(left):>18}{shown(right):>18}{text:>14}")
    return differing


def compare_histories(a: dict[str, np.ndarray], b: dict[str, np.ndarray], tolerance: float,
                      title: str = "history") -> int:
    """Prints the largest difference of each column over the common time span, in parts of the column's range.

    A number that is none (nan) in one of the two alone is an infinite difference, a column that one of the two lacks is
    a difference.
    """
    rows = [len(history.get("time", [])) for history in (a, b)]
    if rows == [0, 0]:
        print(f"{title}: missing or empty in both, not compared")
        return 0
    if 0 in rows:
        print(f"* {title}: missing or empty in {'AB'[rows.index(0)]}")
        return 1
    lacking = [f"{name} (only in {'A' if name in a else 'B'})" for name in sorted(set(a) ^ set(b))]
    if lacking:
        print(f"* {title}: columns of one run alone: {', '.join(lacking)}")
    differing = len(lacking)
    time = a["time"][a["time"] <= b["time"][-1]]
    print(f"\n{title}, {len(a['time'])} and {len(b['time'])} rows: largest difference of each column, and when")
    for name in a:
        if name == "time" or name not in b or len(time) == 0:
            continue
        other = np.interp(time, b["time"], b[name])
        mine = a[name][: len(time)]
        gap = np.where(np.isnan(mine) & np.isnan(other), 0.0, np.nan_to_num(np.abs(mine - other), nan=np.inf))
        gap[mine == other] = 0.0  # infinite and equal
        scale = max(np.abs(np.nan_to_num(column, nan=0.0, posinf=0.0, neginf=0.0)).max()
                    for column in (a[name], b[name]))
        worst = int(np.argmax(gap))
        relative = gap[worst] / scale if scale > 0.0 else gap[worst]
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
    if not arguments.tolerance >= 0.0:
        parser.error("--tolerance has to be a number that is not negative")
    summaries, histories, observers = [], [], []
    try:
        for folder in (arguments.a, arguments.b):
            summaries.append(read_summary(folder))
            histories.append(read_history(folder / "history.csv"))
            observers.append(read_observers(folder / "history.h5"))
            if not summaries[-1]:
                raise ResultsError(f"there is no {folder / 'summary.json'}")
    except ResultsError as error:
        print(f"kerf compare: {error}", file=sys.stderr)
        return 1
    differing = compare_summaries(*summaries, arguments.tolerance, arguments.all)
    differing += compare_histories(*histories, arguments.tolerance)
    for name in sorted(set(observers[0]) | set(observers[1])):
        pair = [of_run.get(name, {}) for of_run in observers]
        differing += compare_histories(*pair, arguments.tolerance, f"observer {name}")
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
