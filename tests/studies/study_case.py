"""A small input, studies of it, and calls of `kerf sweep`, for the tests of studies."""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
STUDIES = ROOT / "framework" / "studies"
SWEEP = [sys.executable, "-B", str(STUDIES / "sweep.py")]
KERF = Path(os.environ.get("KERF_BINARY", ROOT / "build" / "bin" / "kerf"))

sys.path.insert(0, str(STUDIES))

# A block of 32 cells is struck by one of 8: a few milliseconds for a run.
INPUT = """\
title: two blocks
parameters:
  speed: 0 0 -100 m/s
time:
  end: 2 us
materials:
  copper:
    density: 8930 kg/m3
    strength: {type: elastic_plastic, shear_modulus: 43 GPa, yield_stress: 400 MPa, hardening_modulus: 100 MPa}
    eos: {type: linear, bulk_modulus: 130 GPa}
parts:
  target:
    material: copper
    mesh: {type: block, size: 4 4 2 mm, cells: [4, 4, 2]}
  striker:
    material: copper
    mesh: {type: block, size: 2 2 2 mm, origin: 1 1 2.05 mm, cells: [2, 2, 2]}
    velocity: $speed
boundaries:
  - {type: fixed, nodes: bottom}
sets:
  bottom: {parts: target, face: z_min}
contacts:
  - {type: eroding_surface}
observers:
  nose: {type: gauge, part: striker, point: 2 2 2.1 mm, quantities: [pressure]}
measures:
  striker: {type: residual_velocity, part: striker}
"""

STUDY = """\
title: two blocks
input: input.yaml
parameters:
  speed: {path: "parts.striker.velocity[2]", factor: -1}
  strength: materials.copper.strength.yield_stress
results:
  residual: {path: measures.striker.z, factor: -1}
  balance: energy.balance_error
"""


def write(folder, points="", rest="", study=STUDY, model=INPUT):
    """Writes the input and a study of it; returns the study's path."""
    (folder / "input.yaml").write_text(model)
    path = folder / "study.yaml"
    path.write_text(study + points + rest)
    return path


def sweep(study, *options, **more):
    environment = {**os.environ, "KERF_BINARY": str(KERF), **more.pop("environment", {})}
    return subprocess.run([*SWEEP, str(study), "--output", str(Path(study).parent / "out"), *map(str, options)],
                          capture_output=True, text=True, timeout=300, env=environment, **more)


def table(study):
    return json.loads((Path(study).parent / "out" / "table.json").read_text())["points"]


def csv_table(study):
    with open(Path(study).parent / "out" / "table.csv", newline="") as file:
        return list(csv.DictReader(file))


def fits_of(study):
    return json.loads((Path(study).parent / "out" / "fits.json").read_text())["fits"]


def values(study, name):
    return [point["parameters"][name] for point in table(study)]


def summaries(study):
    """The time at which each summary was written: it tells which points were run again."""
    return {path.parent.name: path.stat().st_mtime_ns for path in (study.parent / "out").glob("*/summary.json")}
