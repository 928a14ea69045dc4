#!/usr/bin/env python3
"""Prints the table of doc/theory/accuracy.md: for every file of tests/data/laws the column that comes nearest to its
tolerance. usage: python3 tests/curves/accuracy_table.py [BUILD]"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]


def driven_rows(build):
    """Rows of the paths: one for each file, as (file, line)."""
    rows = []
    for file in sorted((TESTS / "curves").glob("*.yaml")):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([build / "bin" / "kerf", "drive", file, "--output", folder], check=True, capture_output=True)
            drive = json.loads((Path(folder) / "drive.json").read_text())
        for curve in drive["curves"]:
            worst = max(curve["checks"], key=lambda c: c["error"] / c["allowed"])
            name = Path(worst["file"]).stem
            rows.append((name, f"| {file.stem} | `{name}` | {worst['column']} | {worst['error']:.1e} | "
                               f"{worst['allowed']:.1e} |"))
    return rows


def other_rows(build):
    """Rows of files that are no path of one element."""
    files = sorted((TESTS / "data/laws").glob("*.csv"))
    done = subprocess.run([build / "tests" / "kerf_law_curves", "--markdown", *files], capture_output=True, text=True)
    return [(line.split("`")[1], line) for line in done.stdout.splitlines()]


if __name__ == "__main__":
    where = Path(sys.argv[1] if len(sys.argv) > 1 else TESTS.parent / "build").resolve()
    print("| law | file | column | error | tolerance |\n|---|---|---|---|---|")
    for _, line in sorted(driven_rows(where) + other_rows(where)):
        print(line)
