"""Measures on this machine what elements, laws, contact, erosion and re-balancing cost, for `balance.work_model`.

A block of hex8 flies against a rigid wall, once with every law of tests/data/sample_laws.yaml, each time for the same
few cycles; the timer of the elements over the elements gives a law's time. Contact and erosion come from the oblique
rod, a re-balance from two ranks that hold bars of two sizes and move nothing, or everything.
"""

from __future__ import annotations

import datetime
import json
import statistics
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from cases import rod
from runner import ROOT, BenchError, Case, Run

LAW_CYCLES = 80
CELLS = 20  # along an edge of the block
KEYS = {"material": "strength", "eos": "eos", "solid": "solid"}
SMALL, LARGE = 16, 36  # cells along an edge of the bars that two ranks re-balance
USUAL = {"density": 7850, "strength": {"type": "elastic_plastic", "shear_modulus": 80e9, "yield_stress": 4e8,
                                       "hardening_modulus": 5e8},
         "eos": {"type": "linear", "bulk_modulus": 160e9}}
NEVER = {"criteria": [{"type": "plastic_strain", "limit": 1000}]}


@dataclass(frozen=True)
class OwnCase(Case):
    """An input that is written here."""

    def command(self, binary: str, output: Path) -> list[str]:
        words = [binary, "run", self.input, "--output", str(output)]
        return words + (["--ranks", str(self.ranks)] if self.ranks > 1 else [])


def samples() -> dict:
    try:
        import yaml
    except ModuleNotFoundError as error:
        raise BenchError("the Python package yaml is missing; ./kerf build installs it") from error
    return yaml.safe_load((ROOT / "tests" / "data" / "sample_laws.yaml").read_text())


def material_with(kind: str, name: str, sample: dict | None) -> dict:
    """A material with this law, and the usual partner where it needs one."""
    law = {"type": name, **(sample or {})}
    beside = law.pop("beside", {})
    law.pop("conformance", None)
    if kind == "solid":
        return {"density": USUAL["density"], "solid": law, **beside}
    return {**USUAL, KEYS[kind]: law, **beside}


class Calibration:
    def __init__(self, bench):
        self.bench = bench
        self.folder = bench.runner.scratch / "calibration"
        self.folder.mkdir()
        self.skipped: list[str] = []

    def case(self, name: str, material: dict, cells: int = CELLS, cycles: int = LAW_CYCLES, ranks: int = 1,
             **more) -> OwnCase:
        edge = 1e-3 * cells
        model = {"time": {"end": 1.0, "maximum_cycles": cycles}, "materials": {"m": material},
                 "parts": {"block": {"mesh": {"type": "block", "size": [edge, edge, edge], "cells": [cells] * 3},
                                     "material": "m", "velocity": [0, 0, -50]}},
                 "boundaries": [{"type": "rigid_wall", "point": [0, 0, 0], "normal": [0, 0, 1]}],
                 "checks": {"energy_growth": 1.0e6},
                 "output": {"results_interval": 1.0, "history_interval": 1.0, "restart_at_end": False}, **more}
        path = self.folder / f"{name}.yaml"
        path.write_text(json.dumps(model))
        return OwnCase(name, str(path), ranks=ranks)

    def runs(self, cases: dict[str, Case]) -> dict[str, list[Run]]:
        """All repeats, in turn. A case that does not run at all is told and left out."""
        done: dict[str, list[Run]] = {name: [] for name in cases}
        for _ in range(self.bench.repeats):
            for name, case in list(cases.items()):
                try:
                    done[name].append(self.bench.runner.run(self.bench.binary, case))
                except BenchError as error:
                    if not isinstance(case, OwnCase) or case.ranks > 1 or "/" not in name:
                        raise
                    self.skipped.append(name)
                    print(f"  {name}: not measured, its run fails: {str(error).splitlines()[-1]}")
                    del cases[name]
        return {name: done[name] for name in cases}

    def elements_and_laws(self) -> dict:
        all_samples = samples()
        cases = {"usual": self.case("usual", USUAL),
                 "bare": self.case("bare", {**USUAL, "strength": {"type": "hydrodynamic"}}),
                 "eroding": self.case("eroding", {**USUAL, "erosion": NEVER})}
        for kind in KEYS:
            for name, sample in all_samples[kind].items():
                cases[f"{kind}/{name}"] = self.case(f"{kind}_{name}", material_with(kind, name, sample))
        runs = self.runs(cases)
        seconds = {name: least([r.timer("elements") / r.summary["element_cycles"] for r in of_case])
                   for name, of_case in runs.items()}
        bare = seconds["bare"]
        # Of a law of pressure beside what its own partner costs.
        partner = {f"eos/{name}": bare if "hydrodynamic" in str((sample or {}).get("beside")) else seconds["usual"]
                   for name, sample in all_samples["eos"].items()}
        of_type = {name: max(0.0, s - partner.get(name, bare)) for name, s in seconds.items() if "/" in name}
        laws = {name.split("/")[1]: s for name, s in of_type.items() if not name.startswith("eos/")}
        eos = {name.split("/")[1]: s for name, s in of_type.items() if name.startswith("eos/")}
        unit = bare + laws["elastic_plastic"]
        return {"element_cycle": unit, "other_element": bare, "other_law": laws["elastic_plastic"],
                "other_eos": statistics.median(eos.values()),
                "erosion": max(0.0, seconds["eroding"] - seconds["usual"]),
                "elements": {"hex8": bare}, "laws": laws, "eos": eos}

    def contact_and_erosion(self) -> dict:
        # Long enough that elements die.
        runs = self.runs({"rod": rod("rod", "11 thousand", f"time.end={'8 us' if self.bench.quick else '15 us'}",
                                     "output.restart_at_end=false")})["rod"]
        work = [run.summary["work"] for run in runs]
        if not work[0]["eroded_elements"] or not work[0]["contact_candidates"]:
            raise BenchError("calibration: nothing touches or erodes in the oblique rod")

        def per(timer: str, count: str) -> float:
            return least([run.timer(timer) / max(w[count], 1) for run, w in zip(runs, work)])

        return {"eroded_element": per("erosion", "eroded_elements"),
                "contact": {"node": per("contact_search", "contact_nodes"),
                            "candidate": per("contact_forces", "contact_candidates"),
                            "touch": per("contact_forces", "contact_touches")}}

    def rebalance(self) -> dict:
        swap = {"partitioner": {"type": "file", "file": str(self.folder / "swapped.txt")}}
        stay = {"partitioner": {"type": "none"}, "force_interval": 4}
        n = LARGE**3  # elements; the first half is made on the first rank
        (self.folder / "swapped.txt").write_text("".join(f"{e} {1 if e < n // 2 else 0}\n" for e in range(n)))
        runs = self.runs({
            "small": self.case("small", USUAL, SMALL, 24, 2, balance=stay),
            "large": self.case("large", USUAL, LARGE, 24, 2, balance=stay),
            "swapped": self.case("swapped", USUAL, LARGE, 2, 2, balance=swap)})

        def later(name: str) -> float:
            return least([statistics.median(m["seconds"] for m in run.summary["rebalances"] if m["cycle"] > 0)
                          for run in runs[name]])

        def first(name: str) -> float:
            return least([run.summary["rebalances"][0]["seconds"] for run in runs[name]])

        moved = runs["swapped"][0].summary["rebalances"][0]["elements_moved"]
        if moved != n:
            raise BenchError(f"calibration: {moved} of {n} elements have moved; expected all")
        per_element = max(0.0, (later("large") - later("small")) / (0.5 * (LARGE**3 - SMALL**3)))
        return {"rebalance": {"fixed": max(0.0, later("small") - per_element * 0.5 * SMALL**3), "element": per_element,
                              "moved_element": max(0.0, (first("swapped") - first("large")) / (0.5 * n))}}


def least(values: list[float]) -> float:
    """What other programs do on the machine only adds."""
    return min(values)


def as_yaml(value, indent: int = 0) -> str:
    text = ""
    for key, entry in value.items():
        if isinstance(entry, dict) and entry and not any(isinstance(v, dict) for v in entry.values()):
            text += f"{' ' * indent}{key}: {{" + ", ".join(f"{k}: {number(v)}" for k, v in entry.items()) + "}\n"
        elif isinstance(entry, dict):
            text += f"{' ' * indent}{key}:\n" + as_yaml(entry, indent + 2)
        else:
            text += f"{' ' * indent}{key}: {number(entry)}\n"
    return text


def number(value) -> str:
    if isinstance(value, float):
        return f"{value:.4e} s"
    return json.dumps(value)


def calibrate(bench, path: Path, host: dict) -> None:
    """Writes the file."""
    print(f"\nCalibration of the work model, {bench.repeats} repeats", flush=True)
    calibration = Calibration(bench)
    measured = {**calibration.elements_and_laws(), **calibration.contact_and_erosion(), **calibration.rebalance()}
    version = subprocess.run([bench.binary, "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
    for types in ("elements", "laws", "eos"):
        measured[types] = {name: {"seconds": s} for name, s in measured[types].items()}
    head = {"format": 1, "kerf_version": version, "machine": f"{host['processor']}, {host['cores']} cores",
            "date": datetime.datetime.now().astimezone().isoformat(timespec="seconds")}
    text = ("# Work model for balance.work_model, written by kerf bench --calibrate. Least of "
            f"{bench.repeats} repeats; load of the machine at the start {host['load_at_start']:.2f}.\n")
    if calibration.skipped:
        text += f"# Not measured, other_law and other_eos hold for them: {', '.join(calibration.skipped)}.\n"
    path.write_text(text + as_yaml({**head, **measured}))
    print(f"an element cycle takes {1e9 * measured['element_cycle']:.1f} ns; written to {path}", file=sys.stdout)
