"""Small models, and the state hashes that they have to end with on every x86-64 machine and from every compiler.

    python tests/regression/stored_hashes.py            runs them and shows which hashes differ from hashes.json
    python tests/regression/stored_hashes.py --renew    writes hashes.json anew, after a change of physics on purpose

The program is KERF_BINARY, or build/bin/kerf. Between them the models use every material, equation of state, solid,
erosion criterion, contact, boundary, load and generator, both precisions and both forms of hourglass control. The
models `laws` and `criteria` contain whatever is registered, with the samples of tests/data/sample_laws.yaml; where
their hashes differ, `python tests/regression/stored_hashes.py --laws` runs each law alone, to compare two machines.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "support"))
from law_models import KERF, impacts, laws_of, plugins  # noqa: E402

STORED = Path(__file__).with_name("hashes.json")

STEEL = {"type": "elastic_plastic", "shear_modulus": "80 GPa", "yield_stress": "1 GPa", "hardening_modulus": "0.3 GPa"}
JOHNSON_COOK = {"type": "johnson_cook", "shear_modulus": "46 GPa", "A": "90 MPa", "B": "292 MPa", "n": 0.31,
                "C": 0.025, "m": 1.09, "specific_heat": 383, "melting_temperature": "1356 K"}
COPPER = {"type": "mie_gruneisen", "c0": 3940, "s": 1.489, "gamma0": 1.99, "gamma_slope": 0.47}
WATER = {"type": "linear_polynomial", "C1": "2.2 GPa", "C2": "9.5 GPa", "C3": "14.6 GPa", "C4": 0.28, "C5": 0.28,
         "tension_limit": "1 MPa"}
LINEAR = {"type": "linear", "bulk_modulus": "160 GPa"}
CASING = {"type": "mixed_hardening", "shear_modulus": "80 GPa", "yield_stress": "0.8 GPa",
          "hardening_modulus": "2 GPa", "isotropic_share": 0.4}
IRON = {"type": "zerilli_armstrong", "shear_modulus": "80 GPa", "C0": "65 MPa", "C1": "1033 MPa", "C3": "0.00698 1/K",
        "C4": "0.000415 1/K", "C5": "266 MPa", "n": 0.289, "specific_heat": "452 J/(kg K)"}
TNT = {"type": "jwl", "A": "371.2 GPa", "B": "3.231 GPa", "R1": 4.15, "R2": 0.95, "omega": 0.3,
       "initial_energy": "7 GJ/m3", "detonation_velocity": "6930 m/s", "cj_pressure": "21 GPa"}
SENSITIVE = {
    "type": "ignition_and_growth",
    "unreacted": {"A": "6969 GPa", "B": "-172.7 GPa", "R1": 7.8, "R2": 3.9, "omega": 0.8578, "heat_capacity": 2.505e6},
    "products": {"A": "854.5 GPa", "B": "20.493 GPa", "R1": 4.6, "R2": 1.35, "omega": 0.25, "heat_capacity": 1e6},
    "initial_energy": "10.2 GJ/m3", "I": "44 1/us", "b": 0.222, "x": 4, "G1": "200 1/us", "c": 0.222, "d": 0.667,
    "y": 1.6}
FOAM = {"type": "p_alpha", "solid_density": 2700, "c0": 5350, "s": 1.34, "gamma0": 2.0,
        "elastic_pressure": "50 MPa", "solid_pressure": "600 MPa"}
ALUMINA = {"type": "johnson_holmquist_2", "shear_modulus": "90.16 GPa", "A": 0.93, "B": 0.31, "M": 0.6, "N": 0.6,
           "C": 0.007, "tensile_strength": "0.2 GPa", "hugoniot_elastic_limit": "2.79 GPa",
           "hugoniot_elastic_pressure": "1.46 GPa", "D1": 0.005, "D2": 1.0, "K1": "130.95 GPa"}


def block(material, size, cells, **more):
    return {"material": material, "mesh": {"type": "block", "size": size, "cells": cells}, **more}


def copper_bar(precision, hourglass):
    """A bar with an ogival nose and an oblique axis bounces off a wall with friction and spins."""
    return {
        "title": "bar", "precision": precision, "time": {"end": "12 us"},
        "materials": {"copper": {"density": "8960 kg/m3", "strength": JOHNSON_COOK, "eos": COPPER}},
        "parts": {"bar": {
            "material": "copper", "element": {"type": "hex8", "hourglass": hourglass},
            "mesh": {"type": "cylinder", "radius": "2 mm", "length": "9 mm", "cell_size": "0.7 mm",
                     "nose": {"type": "ogival", "caliber_radius_head": 2.0}},
            "placement": [{"angle": "170 deg", "axis": [1, 0.2, 0]}, {"translate": "0 0 9.2 mm"}]}},
        "boundaries": [
            {"type": "initial_velocity", "nodes": ["bar"], "velocity": "10 0 -220 m/s",
             "angular_velocity": [0, 0, 3000]},
            {"type": "rigid_wall", "point": [0, 0, 0], "normal": [0, 0, 1], "friction": 0.2}],
    }


def perforation(precision, hourglass):
    """A blunt rod goes through the corner of a plate obliquely; both erode, by three criteria."""
    return {
        "title": "perforation", "precision": precision, "time": {"end": "12 us"},
        "materials": {
            "rod": {"density": 7850, "strength": STEEL, "eos": LINEAR, "erosion": {"criteria": [
                {"type": "geometric_strain", "limit": 0.7}, {"type": "inversion"},
                {"type": "minimum_time_step", "limit": "75 ns"}]}},
            "plate": {"density": 7850, "strength": STEEL, "eos": LINEAR, "erosion": {"criteria": [
                {"type": "plastic_strain", "limit": 0.5}, {"type": "inversion", "limit": 0.93}]}}},
        "parts": {
            "rod": {"material": "rod", "element": {"type": "hex8", "hourglass": hourglass},
                    "velocity": "400 0 -1200 m/s",
                    "mesh": {"type": "cylinder", "radius": "2 mm", "length": "10 mm", "cell_size": "1 mm"},
                    "placement": [{"angle": "17 deg", "axis": [0, 1, 0]}, {"translate": "5 5 2.8 mm"}]},
            "plate": block("plate", "12 10 2 mm", [12, 10, 2])},
        "sets": {"rim": {"parts": ["plate"], "face": "x_min"}},
        "boundaries": [{"type": "fixed", "nodes": ["rim"]}],
        "contacts": [{"type": "eroding_surface", "friction": 0.1}],
        "checks": {"energy_growth": 0.5, "free_nodes": "keep"},
    }


def spall_and_splash():
    """A steel plate that is driven strikes water over an elastic plate; another steel plate spalls in tension."""
    return {
        "title": "spall and splash", "time": {"end": "4 us"},
        "materials": {
            "brittle": {"density": 7850, "strength": STEEL, "eos": LINEAR,
                        "erosion": {"criteria": [{"type": "tensile_stress", "limit": "2 GPa"}]}},
            "elastic": {"density": 2700, "strength": {"type": "elastic", "shear_modulus": "26 GPa"},
                        "eos": {"type": "linear", "bulk_modulus": "70 GPa"}},
            "water": {"density": 1000, "strength": {"type": "hydrodynamic"}, "eos": WATER}},
        "parts": {
            "base": block("elastic", "4 3 2 mm", [6, 4, 3]),
            "water": {"material": "water", "velocity": "0 0 -50 m/s",
                      "mesh": {"type": "block", "origin": "0 0 2.01 mm", "size": "4 3 2 mm", "cell_size": "1 mm",
                               "grading_z": [{"to": "2 mm", "cells": 4, "ratio": 0.5}]}},
            "driven": {"material": "elastic", "mesh": {
                "type": "block", "origin": "0.3 0.2 4.02 mm", "size": "3.4 2.6 1 mm", "cells": [4, 3, 2]}},
            "flyer": {"material": "brittle", "velocity": "0 0 -600 m/s", "mesh": {
                "type": "block", "origin": "10 0 4.05 mm", "size": "3 3 2 mm", "cells": [3, 3, 5]}},
            "target": {"material": "brittle", "mesh": {
                "type": "block", "origin": "10 0 0 mm", "size": "3 3 4 mm", "cells": [3, 3, 10]}}},
        "sets": {"top": {"parts": ["driven"], "face": "z_max"}},
        "boundaries": [
            {"type": "symmetry", "normal": [0, 0, 1]},
            {"type": "prescribed_motion", "nodes": ["top"], "velocity": "0 0 -80 m/s"}],
        "contacts": [
            {"type": "slide_surface", "slave": ["water"], "master": ["base", "driven"], "symmetric": True},
            {"type": "eroding_surface", "parts": ["flyer", "target"]}],
        "checks": {"energy_growth": 0.5},
    }


def pressed_plate():
    """A plate with round corners under a pressure that erodes its way in, pushed and shaken."""
    return {
        "title": "pressed plate", "time": {"end": "8 us"},
        "materials": {"steel": {"density": 7850, "strength": STEEL, "eos": LINEAR,
                                "erosion": {"criteria": [{"type": "plastic_strain", "limit": 0.1}]}}},
        "parts": {"plate": {"material": "steel", "mesh": {
            "type": "cylinder", "radius": "5 mm", "length": "2 mm", "core_cells": 3, "ring_cells": 3,
            "axial_cells": 3}}},
        "sets": {"rim": {"face": "lateral"}, "top": {"box": "-2.5 -2.5 1.9 2.5 2.5 2.1 mm"}, "back": {"face": "z_min"}},
        "boundaries": [{"type": "fixed", "nodes": ["rim"]}],
        "curves": {"rise": {"times": "[0, 1] us", "values": [0, 1]},
                   "shake": {"times": "[0, 1] us", "values": [-1, 1], "period": "1.7 us"}},
        "loads": [
            {"type": "pressure", "facets": "top", "pressure": "6 GPa", "curve": "rise", "follow_erosion": True},
            {"type": "gravity", "acceleration": [1e7, 2e7, 0], "curve": "shake"},
            {"type": "nodal_force", "nodes": "back", "force": [0, 0, 400], "curve": "rise"}],
        "checks": {"energy_growth": 0.5},
    }


def explosion():
    """An explosive between casing, wall and ceramic plate, lit at a corner; warm foam behind the plate is crushed."""
    softening = {"type": "johnson_cook_damage", "D1": 0.05, "D2": 0.1, "D3": -1.5, "softening": "stress",
                 "critical_damage": 0.2, "softening_exponent": 1.5}
    return {
        "title": "explosion", "time": {"end": "4 us"},
        "materials": {
            "explosive": {"density": 1630, "strength": {"type": "hydrodynamic"},
                          "eos": {**TNT, "detonators": [{"point": "0 0 5 mm"}]},
                          "erosion": {"criteria": [{"type": "geometric_strain", "limit": 1.5},
                                                   {"type": "inversion", "limit": 0.2}]}},
            "casing": {"density": 7850, "strength": CASING, "eos": LINEAR,
                       "erosion": {"fade_out": 5, "criteria": [softening, {"type": "inversion", "limit": 0.3}]}},
            "iron": {"density": 7870, "strength": IRON, "eos": LINEAR},
            "foam": {"density": 1800, "strength": {"type": "elastic", "shear_modulus": "0.5 GPa"}, "eos": FOAM,
                     "erosion": {"criteria": [{"type": "geometric_strain", "limit": 1.5},
                                              {"type": "inversion", "limit": 0.2}]}},
            "ceramic": {"density": 3700, "solid": ALUMINA, "erosion": {"criteria": [
                {"type": "variable", "variable": "effective_plastic_strain", "limit": 0.4},
                {"type": "inversion", "limit": 0.2}]}}},
        "parts": {
            "foam": block("foam", "6 6 3 mm", [6, 6, 3]),
            "ceramic": block("ceramic", "6 6 2 mm", [6, 6, 2], placement=[{"translate": "0 0 3 mm"}]),
            "explosive": block("explosive", "6 6 4 mm", [6, 6, 4], placement=[{"translate": "0 0 5 mm"}]),
            "casing": block("casing", "6 6 1 mm", [6, 6, 1], placement=[{"translate": "0 0 9 mm"}]),
            "wall": block("iron", "1 6 4 mm", [1, 6, 4], placement=[{"translate": "6 0 5 mm"}])},
        "sets": {"corner": {"parts": ["foam"], "box": "0 0 0 3 3 3 mm"}},
        "initial_state": [{"elements": ["corner"], "variable": "specific_energy", "value": "20 kJ/kg"},
                          {"elements": ["wall"], "variable": "temperature", "value": "400 K"},
                          {"elements": ["casing"], "variable": "effective_plastic_strain", "value": "0.01"}],
        "boundaries": [{"type": "symmetry", "normal": [0, 0, 1]}, {"type": "symmetry", "normal": [1, 0, 0]},
                       {"type": "symmetry", "normal": [0, 1, 0]}],
        "contacts": [{"type": "eroding_surface"}],
        "checks": {"energy_growth": 0.5},
    }


def initiation():
    """A sensitive explosive is thrown against a wall and begins to react; of two others, side by side, one is lit from
    the other, round a corner."""
    round_corners = {**TNT, "arrival": "eikonal"}
    return {
        "title": "initiation", "time": {"end": "2 us"},
        "materials": {
            "sensitive": {"density": 1842, "strength": {"type": "hydrodynamic"}, "eos": SENSITIVE},
            "booster": {"density": 1630, "strength": {"type": "hydrodynamic"},
                        "eos": {**round_corners, "detonators": [{"point": "20 0 0 mm", "end": "20 0 2 mm"}]}},
            "charge": {"density": 1630, "strength": {"type": "hydrodynamic"}, "eos": round_corners}},
        "parts": {
            "sensitive": block("sensitive", "3 3 6 mm", [3, 3, 12], velocity="0 0 -1200 m/s"),
            "booster": block("booster", "3 6 2 mm", [3, 6, 2], placement=[{"translate": "20 0 0 mm"}]),
            "charge": block("charge", "4 2 2 mm", [4, 2, 2], placement=[{"translate": "23 4 0 mm"}])},
        "joined": [{"parts": ["booster", "charge"]}],
        "boundaries": [{"type": "symmetry", "normal": [0, 0, 1]}],
        "checks": {"energy_growth": 0.5},
    }


def vessels():
    """A tube, a sphere, a spherical shell and a sector of one, round bodies of all kinds, in the blast of a charge."""
    return {
        "title": "vessels", "time": {"end": "10 us"},
        "materials": {"copper": {"density": "8960 kg/m3", "strength": JOHNSON_COOK, "eos": COPPER}},
        "parts": {
            "tube": {"material": "copper", "mesh": {
                "type": "tube", "inner_radius": "20 mm", "outer_radius": "23 mm", "length": "9 mm", "radial_cells": 3,
                "circumferential_cells": 7, "axial_cells": 3, "radial_ratio": 2, "sector": "quarter"}},
            "ball": {"material": "copper", "placement": [{"translate": "0 0 15 mm"}], "mesh": {
                "type": "sphere", "radius": "8 mm", "core_cells": 3, "ring_cells": 3, "sector": "eighth"}},
            "bowl": {"material": "copper", "placement": [{"translate": "0 0 30 mm"}], "mesh": {
                "type": "spherical_shell", "inner_radius": "10 mm", "outer_radius": "13 mm", "radial_cells": 3,
                "angular_cells": 4, "sector": "eighth"}},
            "column": {"material": "copper", "placement": [{"translate": "0 0 40 mm"}], "mesh": {
                "type": "spherical_sector", "inner_radius": "10 mm", "outer_radius": "16 mm", "angle_x": "20 deg",
                "angle_y": "15 deg", "radial_cells": 5, "cells_x": 3, "cells_y": 2}}},
        "boundaries": [{"type": "symmetry", "normal": [1, 0, 0]}, {"type": "symmetry", "normal": [0, 1, 0]}],
        "loads": [{"type": "air_blast", "facets": ["tube", "ball", "bowl", "column"], "burst": "free_air",
                   "charge_mass": "100 g", "charge_position": "50 60 70 mm", "detonation_time": "-14 us"}],
    }


def clamped_bar():
    """A bar is bent by a displacement of its end, pulled by another one for a while, and settles by damping."""
    return {
        "title": "clamped bar", "time": {"end": "10 us"},
        "materials": {"steel": {"density": 7850, "strength": STEEL, "eos": LINEAR}},
        "parts": {"bar": block("steel", "9 3 3 mm", [9, 3, 3])},
        "sets": {"root": {"face": "x_min"}, "tip": {"face": "x_max"}},
        "curves": {"way": {"times": "[0, 3, 6] us", "values": [0, 1, 0.7]}},
        "boundaries": [
            {"type": "fixed", "nodes": ["root"]},
            {"type": "prescribed_motion", "nodes": ["tip"], "displacement": "0 0.2 0.1 mm", "curve": "way",
             "components": ["y", "z"]},
            {"type": "prescribed_motion", "nodes": ["tip"], "displacement": "0.1 0 0 mm", "times": "[0, 4] us",
             "factors": [0, 1], "components": ["x"], "birth": "1 us", "death": "5 us"}],
        "loads": [{"type": "mass_damping", "nodes": ["bar"], "coefficient": "1.0e+5 s-1", "factors": [1, 0.5, 1],
                   "curve": "way"}],
    }


def mesh_file():
    """A bar strikes a plate; both are blocks of one file."""
    path = str(SOURCE / "tests" / "data" / "meshes" / "bar_and_plate_v22.msh")
    mesh = {"type": "file", "file": path, "unit": "mm"}
    return {
        "title": "mesh of a file", "time": {"end": "2 us"},
        "materials": {"steel": {"density": 7850, "strength": STEEL, "eos": LINEAR}},
        "parts": {"bar": {"material": "steel", "mesh": {**mesh, "block": "bar"}, "velocity": "0 0 -200 m/s"},
                  "plate": {"material": "steel", "mesh": {**mesh, "block": "plate 12 x 12"}}},
        "sets": {"edge": {"parts": ["plate"], "face": "plate edge"}},
        "boundaries": [{"type": "fixed", "nodes": ["edge"]}],
        "contacts": [{"type": "eroding_surface"}],
    }


def laws():
    """Every material, equation of state and solid."""
    return impacts([law for law in laws_of(plugins()) if law[0] != "erosion"])


def criteria():
    """Every erosion criterion, in impacts that are hard enough for all of them."""
    return impacts([law for law in laws_of(plugins()) if law[0] == "erosion"], "2500 500 0 m/s", 60)


MODELS = {
    "bar": copper_bar("double", "viscous"),
    "bar_single": copper_bar("single", "stiffness"),
    "perforation": perforation("double", "stiffness"),
    "perforation_single": perforation("single", "viscous"),
    "spall_and_splash": spall_and_splash(),
    "pressed_plate": pressed_plate(),
    "explosion": explosion(),
    "initiation": initiation(),
    "vessels": vessels(),
    "clamped_bar": clamped_bar(),
    "mesh_file": mesh_file(),
    "laws": laws(),
    "criteria": criteria(),
}


def summary_of(name, folder, environment=None, case=None):
    """Runs a model, one of MODELS where none is given; its summary."""
    folder = Path(folder) / name
    folder.mkdir()
    model = folder / "input.yaml"
    model.write_text(json.dumps(case or MODELS[name], indent=1))  # JSON is YAML
    done = subprocess.run([str(KERF), "run", str(model), "--output", str(folder)], capture_output=True, text=True,
                          timeout=300, env={**os.environ, **(environment or {})})
    if done.returncode != 0:
        raise RuntimeError(f"{name}:\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
    return json.loads((folder / "summary.json").read_text())


def show_each_law():
    with tempfile.TemporaryDirectory() as folder:
        for kind, name in laws_of(plugins()):
            case = impacts([(kind, name)], *(["2500 500 0 m/s", 60] if kind == "erosion" else []))
            print(f"{kind:<10} {name:<30} {summary_of(name, folder, case=case)['state_hash']}")


def main():
    if "--laws" in sys.argv[1:]:
        show_each_law()
        return 0
    with tempfile.TemporaryDirectory() as folder:
        hashes = {name: summary_of(name, folder)["state_hash"] for name in MODELS}
    stored = json.loads(STORED.read_text()) if STORED.exists() else {}
    differing = [name for name in MODELS if hashes[name] != stored.get(name)]
    for name in MODELS:
        verdict = f"differs from {stored.get(name, 'none')}" if name in differing else "as stored"
        print(f"{name:<20} {hashes[name]} {verdict}")
    if "--renew" in sys.argv[1:]:
        STORED.write_text(json.dumps(hashes, indent=2) + "\n")
        print(f"{STORED} is renewed: {len(differing)} changed")
        return 0
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
