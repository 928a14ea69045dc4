"""Models of small impacts in which every registered material, equation of state, solid and criterion takes part; their
parameters are the samples of tests/data/sample_laws.yaml."""

import os
import subprocess
from pathlib import Path

import yaml

SOURCE = Path(__file__).resolve().parents[2]
KERF = os.environ.get("KERF_BINARY", str(SOURCE / "build" / "bin" / "kerf"))
SAMPLES = yaml.safe_load((SOURCE / "tests" / "data" / "sample_laws.yaml").read_text())
# The partners of a law that is not the whole material. This strength keeps all that criteria read.
USUAL = {"density": "7850 kg/m3", "strength": {"type": "johnson_cook"} | SAMPLES["material"]["johnson_cook"],
         "eos": {"type": "mie_gruneisen"} | SAMPLES["eos"]["mie_gruneisen"]}
KEYS = {"material": "strength", "eos": "eos", "solid": "solid"}


def plugins():
    """Names of the registered plugins, a list per kind."""
    listing = subprocess.run([KERF, "list"], capture_output=True, text=True, check=True, timeout=60).stdout
    names, kind = {}, ""
    for line in filter(None, listing.splitlines()):
        if not line.startswith(" "):
            kind = line.strip()
        else:
            names.setdefault(kind, []).append(line.split()[0])
    return names


def laws_of(names):
    """(kind, name) of every law that a material can have."""
    return [(kind, name) for kind in (*KEYS, "erosion") for name in names[kind]]


def material_of(kind, name):
    sample = dict(SAMPLES[kind][name] or {})
    beside = sample.pop("beside", {})
    sample.pop("conformance", None)
    law = {"type": name} | sample
    if kind == "erosion":
        return USUAL | {"erosion": {"criteria": [law]}} | beside
    if kind == "solid":
        return {"density": USUAL["density"], "solid": law} | beside
    return USUAL | {KEYS[kind]: law} | beside


def impacts(laws, velocity="200 60 0 m/s", cycles=30):
    """One model: for every law a short bar that hits another one, sideways a little, so that elements are sheared and
    turned, too. Pairs stand apart, those with detonators next to the origin, where these are."""
    case = {"time": {"end": "1 ms", "maximum_cycles": cycles}, "materials": {}, "parts": {},
            "contacts": [{"type": "eroding_surface"}],
            # Elements move between ranks often, whether or not that pays.
            "balance": {"force_interval": 7},
            # Samples are no engineering: an explosive may well send parts flying.
            "checks": {"energy_growth": 1.0e6, "let_go": 1.0}}
    first = sorted(laws, key=lambda law: "detonators" not in str(SAMPLES[law[0]][law[1]]))
    for i, (kind, name) in enumerate(first):
        material = f"{kind}_{name}"
        case["materials"][material] = material_of(kind, name)
        case["parts"][material + "_flyer"] = {
            "material": material, "velocity": velocity,
            "mesh": {"type": "block", "origin": f"0 {20 * i} 0 mm", "size": "4 2 2 mm", "cells": [4, 2, 2]}}
        case["parts"][material + "_target"] = {
            "material": material,
            "mesh": {"type": "block", "origin": f"4 {20 * i} 0 mm", "size": "4 3 2 mm", "cells": [4, 3, 2]}}
    return case
