"""Laws in Python: the same numbers as compiled ones, in `kerf drive` and in a run; what goes wrong is told with its
line."""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from plugin_case import KERF, build, call

SOURCE = Path(__file__).resolve().parents[2]
os.environ.setdefault("KERF_PYTHON", sys.executable)  # a Python that has NumPy
LAWS = '''import numpy as np
from kerf_laws import Eos, Erosion, Material, Solid, deviator, reads, real, state, tensor, trace, von_mises


class MyElasticPlastic(Material):
    "J2 plasticity with linear hardening"
    shear_modulus = real("Pa", "elastic shear modulus", above=0)
    yield_stress = real("Pa", "initial yield stress", above=0)
    hardening_modulus = real("Pa", "slope of the flow stress", default="0 Pa", least=0)
    effective_plastic_strain = state("-", "equivalent plastic strain")

    def update(self, p):
        G, H = self.shear_modulus, self.hardening_modulus
        trial = p.deviator + 2 * G * deviator(p.strain_increment)
        q = von_mises(trial)
        d = np.maximum(q - self.yield_stress - H * p.state.effective_plastic_strain, 0) / (3 * G + H)
        p.deviator = (1 - 3 * G * d / (q + 1e-300)) * trial
        p.state.effective_plastic_strain += d
        return G


class MyGruneisen(Eos):
    "Mie and Gruneisen, with a linear Hugoniot, in compression"
    c0 = real("m/s", "speed of sound", above=0)
    gamma = real("-", "Gruneisen's parameter times density, constant", above=0)

    def evaluate(self, p):
        r0, mu = p.reference_density, p.density / p.reference_density - 1
        K = r0 * self.c0**2
        pressure = K * mu + self.gamma * r0 * p.specific_energy
        return pressure, (1 + mu) * K + self.gamma * pressure / (1 + mu)


class MyPlasticStrain(Erosion):
    "a limit of the plastic strain"
    limit = real("-", "greatest plastic strain", above=0)
    effective_plastic_strain = reads("of the material")

    def judge(self, p):
        return p.reads.effective_plastic_strain, p.reads.effective_plastic_strain >= self.limit


class MyMaxwell(Solid):
    "elastic in volume, viscoelastic in shape"
    name = "maxwell"
    inputs = ("length", "rotation")
    bulk_modulus = real("Pa", "bulk modulus", above=0)
    shear_modulus = real("Pa", "shear modulus", above=0)
    relaxation_time = real("s", "time of relaxation", above=0)
    strain = tensor("-", "deviatoric strain so far")

    def update(self, p):
        p.state.strain += deviator(p.strain_increment)
        s = deviator(p.stress) + 2 * self.shear_modulus * deviator(p.strain_increment)
        s /= 1 + p.dt / self.relaxation_time
        p.stress[:] = s
        p.stress[:3] += self.bulk_modulus * (1 - p.density / p.reference_density)
        assert p.length.shape == (8,) and p.rotation.shape == (9, 8)
        return self.shear_modulus, self.bulk_modulus
'''
ELASTIC_PLASTIC = {"shear_modulus": 80e9, "yield_stress": 400e6, "hardening_modulus": 1e9}


@pytest.fixture
def laws(tmp_path):
    (tmp_path / "laws.py").write_text(LAWS)
    return tmp_path / "laws.py"


def drive(folder, materials, paths, *options):
    (folder / "point.yaml").write_text(json.dumps({"plugins": ["laws.py"], "materials": materials, "paths": paths}))
    return call(KERF, "drive", folder / "point.yaml", *options)


def columns(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}


def material(strength, criterion, limit=0.1):
    return {"density": 8000, "strength": {"type": strength} | ELASTIC_PLASTIC,
            "eos": {"type": "linear", "bulk_modulus": 160e9},
            "erosion": {"criteria": [{"type": criterion, "limit": limit}]}}


def test_a_law_in_python_has_the_numbers_of_the_compiled_one(laws, tmp_path):
    both = {"python": material("my_elastic_plastic", "my_plastic_strain"),
            "ours": material("elastic_plastic", "plastic_strain")}
    paths = [{"type": "simple_shear", "strains": [0, 0.1, -0.1], "rate": 1000},
             {"type": "uniaxial_stress", "strains": [0, 0.2], "rate": 1000}]
    done = drive(tmp_path, both, paths)
    assert done.returncode == 0, done.stderr
    for path in ("simple_shear", "uniaxial_stress"):
        a, b = (columns(tmp_path / "point.drive" / f"{m}.{path}.csv") for m in ("python", "ours"))
        assert a["time"] == b["time"] and a["failed"] == b["failed"]
        for name in ("stress_xx", "stress_xy", "pressure", "specific_energy", "effective_plastic_strain"):
            # The order of operations differs: round-off of 1e9 Pa.
            assert a[name] == pytest.approx(b[name], rel=1e-10, abs=1e-3), name


def test_equations_of_state_and_solids_work(laws, tmp_path):
    materials = {
        "eos": {"density": 2700, "strength": {"type": "hydrodynamic"},
                "eos": {"type": "my_gruneisen", "c0": 5000, "gamma": 2}},
        "solid": {"density": 2700, "solid": {"type": "maxwell", "bulk_modulus": 70e9, "shear_modulus": 26e9,
                                             "relaxation_time": 1e-3}}}
    paths = [{"type": "volumetric", "strains": [0, -0.01], "rate": 100, "materials": ["eos"]},
             {"type": "simple_shear", "strains": [0, 1e-4, 1e-4 + 1e-12], "times": [0, 1e-6, 1.001e-3],
              "materials": ["solid"]}]
    done = drive(tmp_path, materials, paths)
    assert done.returncode == 0, done.stderr
    c = columns(tmp_path / "point.drive" / "eos.volumetric.csv")
    mu = c["density"][-1] / 2700 - 1
    assert c["pressure"][-1] == pytest.approx(2700 * 25e6 * mu + 2 * 2700 * c["specific_energy"][-1], rel=1e-9)
    s = columns(tmp_path / "point.drive" / "solid.simple_shear.csv")
    # One relaxation time later 1/e is left; backward Euler with 1000 steps errs by half a thousandth.
    assert s["stress_xy"][-1] == pytest.approx(26e9 * 1e-4 * 0.36788, rel=2e-3)
    assert s["strain_xy"][-1] == pytest.approx(0.5e-4, rel=1e-6)


def test_a_run_takes_them_on_two_ranks_and_warns(laws, tmp_path):
    model = {"plugins": ["laws.py"], "time": {"end": "4 us"},
             "materials": {"metal": material("my_elastic_plastic", "my_plastic_strain", 0.05)},
             "parts": {"bar": {"mesh": {"type": "block", "size": [0.004, 0.001, 0.001], "cells": [8, 2, 2]},
                               "material": "metal", "velocity": [-300, 0, 0]}},
             "boundaries": [{"type": "rigid_wall", "point": [0, 0, 0], "normal": [1, 0, 0]}]}
    (tmp_path / "run.yaml").write_text(json.dumps(model))
    hashes = set()
    for ranks in ("1", "2"):
        done = call(KERF, "run", tmp_path / "run.yaml", "--output", tmp_path / ranks, "--ranks", ranks)
        assert done.returncode == 0, done.stdout + done.stderr
        summary = json.loads((tmp_path / ranks / "summary.json").read_text())
        hashes.add(summary["state_hash"])
        assert any("the law is a prototype in Python" in text for text in summary["warnings"])
    assert len(hashes) == 1


def test_they_are_described_like_all_others(laws):
    done = call(KERF, "describe", "my_elastic_plastic", "--plugin", laws)
    assert done.returncode == 0, done.stderr
    assert "hardening_modulus: number in Pa, at least 0 Pa, by default 0 Pa" in done.stdout
    assert "shear_modulus: number in Pa, greater than 0 Pa, required" in done.stdout
    assert "effective_plastic_strain: without unit, at first 0" in done.stdout


def test_input_is_checked_as_declared(laws, tmp_path):
    bad = material("my_elastic_plastic", "my_plastic_strain")
    bad["strength"]["shear_modulus"] = -1
    done = drive(tmp_path, {"bad": bad}, [{"type": "simple_shear", "strains": [0, 1], "rate": 1}])
    assert done.returncode == 2 and "`shear_modulus`" in done.stderr and "greater than 0 Pa" in done.stderr


SPOILED = {
    "        return G\n": ("        return G, G\n", 2, "MyElasticPlastic.update returns 2 values; expected 1"),
    "        q = von_mises(trial)\n": ("        q = von_mises(trail)\n", 2, "laws.py:15: NameError: name 'trail'"),
    "        p.deviator = (1": ("        p.deviator = np.zeros(3) * (1", 2, "laws.py:17: ValueError"),
    '    "J2 plasticity with linear hardening"\n': ("", 2, "the class MyElasticPlastic says nothing of itself"),
    "    def update(self, p):\n        G, H": ("    def updat(self, p):\n        G, H", 2,
                                               "the class MyElasticPlastic has no function update(self, p)"),
    'inputs = ("length", "rotation")': ('inputs = ("lenght",)', 2, "asks for \"lenght\""),
    "import numpy as np\n": ("import numpy as np\n)", 2, "laws.py:2: SyntaxError"),
    "    c0 = real(": ("    flow = tensor('-', 'flow')\n    c0 = real(", 2, "keeps the tensor flow"),
    "return p.reads.effective_plastic_strain, p": (
        "if p.time > 5e-5: raise RuntimeError('too late')\n        return p.reads.effective_plastic_strain, p", 3,
        "laws.py:40: RuntimeError: too late"),
    "        d = np.max": ("        import os; os._exit(1)\n        d = np.max", 2, "the Python of this law has ended"),
}


@pytest.mark.parametrize("wrong", SPOILED, ids=[str(i) for i in range(len(SPOILED))])
def test_what_is_wrong_is_told_with_its_line(tmp_path, wrong):
    right, code, sentence = SPOILED[wrong]
    assert LAWS.count(wrong) >= 1
    (tmp_path / "laws.py").write_text(LAWS.replace(wrong, right, 1))
    done = drive(tmp_path, {"m": material("my_elastic_plastic", "my_plastic_strain")},
                 [{"type": "simple_shear", "strains": [0, 0.1], "rate": 1000}])
    assert done.returncode == code, done.stdout + done.stderr
    assert sentence in done.stderr, done.stderr
    assert "Traceback" not in done.stderr


def test_a_file_without_laws_and_a_missing_python_are_told(tmp_path):
    (tmp_path / "laws.py").write_text("x = 1\n")
    done = call(KERF, "list", "--plugin", tmp_path / "laws.py")
    assert done.returncode == 2 and "the file has no law" in done.stderr
    (tmp_path / "laws.py").write_text(LAWS)
    done = subprocess.run([KERF, "list", "--plugin", tmp_path / "laws.py"], capture_output=True, text=True, timeout=60,
                          env=os.environ | {"KERF_PYTHON": "/nowhere/python"})
    assert done.returncode == 2 and "/nowhere/python cannot be started" in done.stderr


def test_two_laws_of_one_name_are_refused(laws, tmp_path):
    (tmp_path / "more.py").write_text(LAWS)
    done = call(KERF, "list", "--plugin", laws, "--plugin", tmp_path / "more.py")
    assert done.returncode == 2 and "two plugins of kind" in done.stderr
    (tmp_path / "laws.py").write_text(LAWS.replace("    c0 = real(", "    name = 'linear'\n    c0 = real("))
    done = call(KERF, "list", "--plugin", laws)
    assert done.returncode == 2 and 'two plugins of kind eos are called "linear"' in done.stderr


# ---- to C++

@pytest.mark.parametrize("kind, name, law", [("material", "compiled", "my_elastic_plastic"),
                                             ("solid", "compiled_solid", "maxwell"),
                                             ("eos", "compiled_eos", "my_gruneisen"),
                                             ("erosion", "compiled_strain", "my_plastic_strain")])
def test_a_skeleton_has_the_same_declarations_and_refuses_to_run(laws, tmp_path, kind, name, law):
    done = call(KERF, "new-plugin", kind, name, "--from", laws, "--output", tmp_path)
    assert done.returncode == 0, done.stderr
    library = build(tmp_path / name, tmp_path / "build", f"{name}.so")

    def described(what, plugin):
        text = call(KERF, "describe", kind, what, "--plugin", plugin).stdout
        return text[text.index("\n\n"):]

    assert described(name, library) == described(law, laws)
    assert "is not written yet" in (tmp_path / name / f"{name}.cpp").read_text()
    done = call("ctest", "--test-dir", tmp_path / "build", "-R", "describe|page", "--no-tests=error")
    assert done.returncode == 0, done.stdout


def test_a_skeleton_that_is_not_written_stops_at_once(laws, tmp_path):
    assert call(KERF, "new-plugin", "material", "compiled", "--from", laws, "--output", tmp_path).returncode == 0
    library = build(tmp_path / "compiled", tmp_path / "build", "compiled.so")
    done = drive(tmp_path, {"m": material("compiled", "my_plastic_strain")},
                 [{"type": "simple_shear", "strains": [0, 0.1], "rate": 1}], "--plugin", library)
    assert done.returncode == 2 and "compiled: update_point is not written yet" in done.stderr, done.stderr


def test_what_cannot_become_a_skeleton_is_told(laws, tmp_path):
    done = call(KERF, "new-plugin", "load", "mine", "--from", laws, "--output", tmp_path)
    assert done.returncode == 1 and "a load cannot be written in Python" in done.stderr
    laws.write_text(LAWS.replace("class MyGruneisen(Eos)", "class MyMaterial(Material)").replace("evaluate", "update"))
    done = call(KERF, "new-plugin", "material", "mine", "--from", laws, "--output", tmp_path)
    assert done.returncode == 1 and "expected one of my_elastic_plastic or my_material as the name" in done.stderr
    assert not (tmp_path / "mine").exists()
