"""Every registered material, equation of state, solid and criterion in small impacts of two bodies: the same bits on
one rank, and on three that hand elements to each other, stop half-way, and are resumed by two. The samples are those
of tests/data/sample_laws.yaml."""
import json
import os
import re
import subprocess
from pathlib import Path

import pytest
import yaml

SOURCE = Path(__file__).resolve().parents[2]
KERF = os.environ.get("KERF_BINARY", str(SOURCE / "build" / "bin" / "kerf"))
SAMPLES = yaml.safe_load((SOURCE / "tests" / "data" / "sample_laws.yaml").read_text())
# The partners of a law that is not the whole material. This strength keeps all that criteria read.
USUAL = {"density": "7850 kg/m3", "strength": {"type": "johnson_cook"} | SAMPLES["material"]["johnson_cook"],
         "eos": {"type": "mie_gruneisen"} | SAMPLES["eos"]["mie_gruneisen"]}
KEYS = {"material": "strength", "eos": "eos", "solid": "solid"}


def registered():
    kinds = set(KEYS) | {"erosion"}
    listing = subprocess.run([KERF, "list"], capture_output=True, text=True, check=True, timeout=60).stdout
    laws, kind = [], None
    for line in filter(None, listing.splitlines()):
        if not line.startswith(" "):
            kind = line.strip()
        elif kind in kinds:
            laws.append((kind, line.split()[0]))
    return laws


def material_of(kind, name):
    sample = dict(SAMPLES[kind][name] or {})
    beside = sample.pop("beside", {})
    law = {"type": name} | sample
    if kind == "erosion":
        return USUAL | {"erosion": {"criteria": [law]}} | beside
    if kind == "solid":
        return {"density": USUAL["density"], "solid": law} | beside
    return USUAL | {KEYS[kind]: law} | beside


def impacts(laws):
    """One model: for every law a short bar that hits another one, sideways a little, so that elements are sheared and
    turned, too. Pairs stand apart, those with detonators next to the origin, where these are."""
    case = {"time": {"end": "1 ms", "maximum_cycles": 30}, "materials": {}, "parts": {},
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
            "material": material, "velocity": "200 60 0 m/s",
            "mesh": {"type": "block", "origin": f"0 {20 * i} 0 mm", "size": "4 2 2 mm", "cells": [4, 2, 2]}}
        case["parts"][material + "_target"] = {
            "material": material,
            "mesh": {"type": "block", "origin": f"4 {20 * i} 0 mm", "size": "4 3 2 mm", "cells": [4, 3, 2]}}
    return case


def run(folder, name, case, *arguments):
    folder.mkdir(exist_ok=True)
    path = folder / "case.yaml"
    path.write_text(yaml.safe_dump(case, sort_keys=False))
    process = subprocess.run([KERF, "run", path, "--output", folder / name, *map(str, arguments)], capture_output=True,
                             text=True, timeout=300)
    assert process.returncode == 0, process.stderr + process.stdout
    return json.loads((folder / name / "summary.json").read_text())


def difference(folder, laws):
    """What a run on one rank, and one on three that stops half-way and goes on with two, do not have in common."""
    case = impacts(laws)
    whole = run(folder, "whole", case)
    run(folder, "stopped", case, "--ranks", 3, "--set", "time.maximum_cycles=15")
    resumed = run(folder, "stopped", case, "--ranks", 2, "--resume")
    assert whole["cycles"] == resumed["cycles"] == 30 and re.fullmatch("[0-9a-f]+", whole["state_hash"])
    assert any(balance["elements_moved"] > 0 for balance in resumed["rebalances"])
    return {key: (whole[key], resumed[key]) for key in ("state_hash", "energy", "eroded", "momentum", "parts")
            if whole[key] != resumed[key]}


def test_every_law_has_a_sample():
    for kind, name in registered():
        assert name in SAMPLES.get(kind, {}), f"{kind} {name} has no sample; give it one in tests/data/sample_laws.yaml"


def test_ranks_migration_and_restart_leave_the_bits_alone(tmp_path):
    """All laws in one model, which is quick; where something differs, one after the other, to name the law."""
    laws = registered()
    if not difference(tmp_path, laws):
        return
    found = {name: difference(tmp_path / name, [(kind, name)]) for kind, name in laws}
    assert not any(found.values()), {name: keys for name, keys in found.items() if keys}
    pytest.fail("the laws differ only together")
