"""Calls of `kerf scale`, and made-up summaries of runs, for the tests of scaling studies."""

import json
import os
import subprocess
import sys

from study_case import INPUT, KERF, STUDIES

SCALE = [sys.executable, "-B", str(STUDIES / "scale.py")]


def write_input(folder, model=INPUT):
    path = folder / "input.yaml"
    path.write_text(model)
    return path


def scale(*words, cwd=None, environment=None):
    environment = {**os.environ, "KERF_BINARY": str(KERF), **(environment or {})}
    return subprocess.run([*SCALE, *map(str, words)], capture_output=True, text=True, timeout=300, env=environment,
                          cwd=cwd)


def content_of(output):
    return json.loads((output / "scale.json").read_text())


def row(content, ranks):
    return next(row for row in content["ranks"] if row["ranks"] == ranks)


def summary(ranks, seconds, work_mean, work_max, element_cycles=1000, state_hash="a" * 16, cycles=10):
    """What summary.json of a run would have; all work is in `elements`, the rest of the time in `halo`."""
    def times(mean, largest, work):
        return {"min": mean, "mean": mean, "max": largest, "work": work}

    work = {"min": 2.0 * work_mean - work_max, "mean": work_mean, "max": work_max}
    none = {"min": 0.0, "mean": 0.0, "max": 0.0}
    return {"kerf_version": "0.0.0", "title": "made up", "ranks": ranks, "exit": "completed", "wall_seconds": seconds,
            "element_cycles": element_cycles, "cycles": cycles, "state_hash": state_hash,
            "parts": {"bar": {"elements": element_cycles // cycles}},
            "timers": {"elements": times(work_mean, work_max, work),
                       "halo": times(seconds - work_mean, seconds - work_mean, none)},
            "steps": times(seconds, seconds, work)}


# A stand-in for Kerf: writes the summary that KERF_MADE_UP/<ranks>.json has, or fails where it has none. It is called
# as mpirun, too: `launch` is its path, and a rank count stands behind it.
PROGRAM = """#!/usr/bin/env bash
if [[ "$1" == --ranks-of-launch ]]; then ranks="$2"; shift 3; else ranks=1; fi
while (($#)); do [[ "$1" == --output ]] && output="$2"; shift; done
if [[ ! -f "$KERF_MADE_UP/$ranks.json" ]]; then echo 'error: made to fail' >&2; exit 3; fi
cp "$KERF_MADE_UP/$ranks.json" "$output/summary.json"
"""


def made_up(folder, summaries):
    """An environment and options for `scale` in which runs end as `summaries` (by ranks) say."""
    place = folder / "made_up"
    place.mkdir()
    for n, content in summaries.items():
        (place / f"{n}.json").write_text(json.dumps(content))
    program = folder / "kerf"
    program.write_text(PROGRAM)
    program.chmod(0o755)
    launch = ["--launch", f"{program} --ranks-of-launch @RANKS@", "--no-counts"]
    return {"KERF_BINARY": str(program), "KERF_MADE_UP": str(place)}, launch
