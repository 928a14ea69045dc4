"""Runs a tiny model with 0, denormal, infinite, huge and other odd numbers for the parameters of every type.

Each set of parameters is refused with a message, stopped by a check with a message, or runs some cycles to finite
energies. The types and their parameters come from `kerf schema`, so new ones are tried without a change here.
"""

import copy
import json
import random
import subprocess
from concurrent.futures import ThreadPoolExecutor

from harness import KERF, Report, workplace

ODD = [0, -0.0, 5e-324, 1e-310, 2.3e-308, 1e-200, 1e-30, 1e-9, -1, 1, 2, 1e9, 1e30, 1e154, 1e200, 1e300,
       1.7976931348623157e308, -1e300, -5e-324, ".inf", "-.inf", ".nan", 2147483647, 2147483648, 9223372036854775807]
PATIENCE = 60  # seconds
TOLD_TO_STOP = 4  # exit code of a run that a signal has stopped

# Plausible values; what is not named here gets 1.
PLAUSIBLE = {
    "bulk_modulus": 130e9, "shear_modulus": 43e9, "yield_stress": 400e6, "hardening_modulus": 1e8, "A": 90e6,
    "B": 292e6, "n": 0.31, "C": 0.025, "m": 1.09, "melting_temperature": 1356, "specific_heat": 383, "c0": 3940,
    "s": 1.49, "gamma0": 2.0, "C1": 130e9, "velocity": [0, 0, -100], "normal": [0, 0, 1], "point": [0, 0, 0],
    "axis": [0, 0, 1],
    "radius": 1e-3, "length": 2e-3, "cell_size": 5e-4, "size": [2e-3, 2e-3, 2e-3], "cells": [2, 2, 2],
    "core_cells": 2, "ring_cells": 1, "axial_cells": 4, "slave": "striker", "master": "target", "part": "striker",
    "limit": 0.5, "nodes": "bottom", "facets": "striker"}


def base_model():
    return {
        "time": {"end": 2e-6, "maximum_cycles": 6},
        "materials": {"copper": {"density": 8930, "strength": {"type": "elastic_plastic", "shear_modulus": 43e9,
                                                               "yield_stress": 400e6, "hardening_modulus": 1e8},
                                 "eos": {"type": "linear", "bulk_modulus": 130e9},
                                 "erosion": {"criteria": [{"type": "plastic_strain", "limit": 1.5}]}}},
        "parts": {"target": {"material": "copper", "mesh": {"type": "block", "size": [4e-3, 4e-3, 2e-3],
                                                            "cells": [4, 4, 2]}},
                  "striker": {"material": "copper", "velocity": [0, 0, -200],
                              "mesh": {"type": "block", "size": [2e-3, 2e-3, 2e-3], "cells": [2, 2, 2],
                                       "origin": [1e-3, 1e-3, 2.1e-3]}}},
        "sets": {"bottom": {"parts": "target", "face": "z_min"}},
        "boundaries": [{"type": "fixed", "nodes": "bottom"}],
        "loads": [{"type": "gravity", "acceleration": [0, 0, -9.81]}],
        "contacts": [{"type": "eroding_surface"}],
        "measures": {"speed": {"type": "residual_velocity", "part": "striker"}}, "observers": {},
        "balance": {"partitioner": {"type": "zoltan_rcb"}},
        "output": {"restart_at_end": False}, "checks": {}}


# Where a type of each kind stands in the model.
PLACES = {
    "material": ("materials", "copper", "strength"), "solid": ("materials", "copper", "solid"),
    "eos": ("materials", "copper", "eos"),
    "erosion": ("materials", "copper", "erosion", "criteria", 0), "element": ("parts", "striker", "element"),
    "mesh": ("parts", "striker", "mesh"), "contact": ("contacts", 0), "boundary": ("boundaries", 0),
    "load": ("loads", 0), "measure": ("measures", "speed"), "observer": ("observers", "watch"),
    "partitioner": ("balance", "partitioner"), "balance_policy": ("balance", "policy")}


def put(model, place, value):
    for key in place[:-1]:
        model = model[key]
    model[place[-1]] = value


def options_of(schema):
    """All forms that a value may take."""
    return [o for form in schema.get("anyOf", [schema]) for o in (options_of(form) if form is not schema else [form])]


def is_number(schema):
    return any(o.get("type") in ("number", "integer") for o in options_of(schema))


def plausible(name, schema):
    if name in PLAUSIBLE:
        return copy.deepcopy(PLAUSIBLE[name])
    for option in options_of(schema):
        if "enum" in option:
            return option["enum"][0]
        if option.get("type") == "array":
            return [1] * option.get("minItems", 1)
        if option.get("type") == "boolean":
            return True
    return 1 if is_number(schema) else "striker"


def odd_value(schema, chance):
    """An odd number, or a list with one in it; None for what is no number."""
    for option in options_of(schema):
        if option.get("type") == "array" and is_number(option.get("items", {})):
            size = option.get("minItems") or chance.choice([1, 2, 3])
            values = [chance.choice([0, 1, 1e-3]) for _ in range(size)]
            values[chance.randrange(size)] = chance.choice(ODD)
            return values
        if "enum" in option:
            return chance.choice(option["enum"])
        if option.get("type") == "boolean":
            return chance.choice([True, False])
    return chance.choice(ODD) if is_number(schema) else None


def as_yaml(value):
    """JSON, which is YAML, but for what it has no numbers for."""
    text = json.dumps(value)
    for word in (".inf", "-.inf", ".nan"):
        text = text.replace(f'"{word}"', word)
    return text


def fresh_law(definitions, kind, name, chance):
    """A law with its required parameters, and some of its others, all plausible."""
    schema = definitions[f"{kind}.{name}"]
    law = {"type": name}
    for parameter, of_parameter in schema["properties"].items():
        wanted = parameter in schema["required"] or (chance.random() < 0.15 and parameter in PLAUSIBLE)
        if parameter != "type" and wanted:
            law[parameter] = plausible(parameter, of_parameter)
    return law


def one_set(schema, kind, name, chance):
    """A model with a law of this type, in which one to three numbers are odd."""
    definitions, model = schema["$defs"], base_model()
    law = fresh_law(definitions, kind, name, chance) if name else None
    if name:
        put(model, PLACES[kind], law)
        if kind == "solid":
            del model["materials"]["copper"]["strength"], model["materials"]["copper"]["eos"]
        if kind == "measure":
            model["measures"] = {"speed": law}
    for _ in range(chance.choice([1, 1, 2, 3])):
        if name and chance.random() < 0.8:
            owner, properties = law, definitions[f"{kind}.{name}"]["properties"]
        else:
            block = chance.choice(["time", "output", "checks", "balance"])
            owner, properties = model[block], schema["properties"][block]["properties"]
            if chance.random() < 0.15:
                owner, properties = model["materials"]["copper"], {"density": {"type": "number"}}
        parameter = chance.choice([p for p in properties if p not in ("type", "partitioner")] or ["type"])
        value = odd_value(properties[parameter], chance) if parameter != "type" else None
        if value is not None:
            owner[parameter] = value
    model["time"].setdefault("maximum_cycles", 6)
    return model


def complaint(code, out, err, summary):
    """What must not happen; an empty text for what may."""
    if code < 0:
        return f"signal {-code}"
    if code in (2, 3):
        return "" if "error: " in err else "stopped without a word"
    if code != 0:
        return f"exit code {code}: {err[-300:]}"
    if not summary.exists():
        return "completed without a summary"
    energies = json.loads(summary.read_text())["energy"]
    bad = [key for key, value in energies.items() if value is None]
    return f"completed with {bad[0]} that is no number" if bad else ""


def try_set(folder, number, model):
    place = folder / str(number)
    place.mkdir()
    (place / "case.yaml").write_text(as_yaml(model))
    words = [KERF, "run", "case.yaml", "--output", "out"]
    try:
        process = subprocess.Popen(words, cwd=place, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   errors="replace")
        try:
            out, err = process.communicate(timeout=PATIENCE)
        except subprocess.TimeoutExpired:  # a tiny step may ask for billions of cycles; the run stops when it is told
            process.terminate()
            out, err = process.communicate(timeout=PATIENCE)
            return process.returncode, "" if process.returncode == TOLD_TO_STOP else "hangs"
        return process.returncode, complaint(process.returncode, out, err, place / "out" / "summary.json")
    except subprocess.TimeoutExpired:
        process.kill()
        return 0, "hangs"
    finally:
        subprocess.run(["rm", "-rf", str(place)])


def campaign(short=False):
    report, chance = Report("parameters"), random.Random(3)
    schema = json.loads(subprocess.run([KERF, "schema"], capture_output=True, text=True, check=True).stdout)
    types = [tuple(name.split(".")) for name in schema["$defs"] if "." in name] + [("blocks", "")]
    names = {0: "ran some cycles", 2: "refused", 3: "stopped by a check", TOLD_TO_STOP: "ran until told to stop"}
    with workplace() as folder, ThreadPoolExecutor(2) as workers:
        sets = [(i, *types[i % len(types)]) for i in range(80 if short else 10000)]
        models = [(i, kind, name, one_set(schema, kind, name, chance)) for i, kind, name in sets]
        tried = workers.map(lambda s: (s, *try_set(folder, s[0], s[3])), models)
        try:
            for (i, kind, name, model), code, wrong in tried:
                if wrong:
                    report.failed(f"{i}: {kind} {name}: {as_yaml(model)}", wrong)
                else:
                    report.passed(f"{kind}: {names[code]}")
        finally:
            workers.shutdown(cancel_futures=True)  # where the campaign is interrupted
    return report
