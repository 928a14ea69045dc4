#!/usr/bin/env python3
"""Reads the JSON of `kerf_kernels --benchmark_filter=laws --benchmark_format=json` and prints a Markdown table of the
cost of one point of every law, for doc/developers/performance.md."""
import json
import math
import sys


def rows(benchmarks):
    """Kind, name, nanoseconds per point in double and, where there is one, in single precision."""
    cost = {}
    for b in benchmarks:
        if b["run_type"] == "aggregate":
            continue
        _, kind, name, *single = b["name"].split("/")
        of_law = cost.setdefault((kind, name), {})
        precision = "single" if single else "double"
        # Of several repetitions the least: whatever else the machine does only adds.
        of_law[precision] = min(of_law.get(precision, math.inf), 1e9 / b["items_per_second"])
    return cost


def main():
    cost = rows(json.load(sys.stdin)["benchmarks"])
    print("| kind | law | ns per point | single |\n|---|---|---|---|")
    for (kind, name), ns in cost.items():
        single = f"{ns['single']:.1f}" if "single" in ns else ""
        print(f"| {kind} | `{name}` | {ns['double']:.1f} | {single} |")


if __name__ == "__main__":
    main()
