"""`kerf drive`: closed forms along its paths, what it refuses, what it writes and draws."""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from shipped import DRIVES

ROOT = Path(__file__).resolve().parents[2]
KERF = os.environ.get("KERF_BINARY", ROOT / "build" / "bin" / "kerf")

YOUNG, POISSON = 200e9, 0.25
SHEAR, BULK = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))
STEEL = {"density": 7850, "strength": {"type": "elastic", "shear_modulus": SHEAR},
         "eos": {"type": "linear", "bulk_modulus": BULK}}


def drive(folder, paths, materials=None, options=(), **rest):
    file = folder / "point.yaml"
    file.write_text(json.dumps({"materials": materials or {"steel": STEEL}, "paths": paths} | rest))
    return subprocess.run([KERF, "drive", str(file), *options], capture_output=True, text=True, timeout=120)


def curve(folder, name):
    with open(folder / "point.drive" / f"{name}.csv", newline="") as file:
        rows = list(csv.reader(file))
    return dict(zip(rows[0], np.array(rows[1:], dtype=float).T))


def refused(folder, paths, sentence, code=2, **more):
    done = drive(folder, paths, **more)
    assert done.returncode == code, done.stdout + done.stderr
    assert sentence in done.stderr, done.stderr
    assert not (folder / "point.drive").exists() or code == 1


# ---- closed forms

def test_uniaxial_stress_has_youngs_modulus_and_poissons_ratio(tmp_path):
    assert drive(tmp_path, [{"type": "uniaxial_stress", "strains": [0, 1e-4], "rate": "100 1/s"}]).returncode == 0
    c = curve(tmp_path, "steel.uniaxial_stress")
    # Second order in the strain, 1e-4.
    assert c["stress_xx"][-1] == pytest.approx(YOUNG * 1e-4, rel=3e-4)
    assert (c["F_yy"][-1] - 1.0) / 1e-4 == pytest.approx(-POISSON, rel=1e-3)
    assert np.all(np.abs(c["stress_yy"]) < 1e-3) and np.all(np.abs(c["stress_zz"]) < 1e-3)


def test_uniaxial_strain_shear_and_volumetric_have_their_moduli(tmp_path):
    paths = [{"type": t, "strains": [0, 1e-4, 0], "rate": "100 1/s"}
             for t in ("uniaxial_strain", "simple_shear", "volumetric")]
    assert drive(tmp_path, paths).returncode == 0
    strain, shear, volume = (curve(tmp_path, f"steel.{p['type']}") for p in paths)
    middle = np.argmax(strain["strain"])
    # Second order in the strain, 1e-4.
    assert strain["stress_xx"][middle] == pytest.approx((BULK + 4 / 3 * SHEAR) * 1e-4, rel=3e-4)
    assert shear["stress_xy"][np.argmax(shear["strain"])] == pytest.approx(SHEAR * 1e-4, rel=3e-4)
    assert volume["pressure"][np.argmax(volume["strain"])] == pytest.approx(-3 * BULK * 1e-4, rel=3e-4)
    # What is elastic comes back; energies of 1 J/kg are resolved to round-off of the volume.
    for c in (strain, shear, volume):
        assert abs(c["stress_xx"][-1]) < 1e3 and abs(c["specific_energy"][-1]) < 1e-3


def test_triaxial_keeps_the_confinement_to_the_side(tmp_path):
    path = {"type": "triaxial", "confinement": "50 MPa", "strains": [0, -0.001], "rate": "1000 1/s"}
    assert drive(tmp_path, [path]).returncode == 0
    c = curve(tmp_path, "steel.triaxial")
    assert c["pressure"][1] == pytest.approx(50e6, rel=1e-8)
    assert np.allclose(c["stress_yy"][1:], -50e6, rtol=1e-8) and np.allclose(c["stress_zz"][1:], -50e6, rtol=1e-8)
    # Over the stress of the confinement, the axis has Young's modulus; second order in the strain, 1e-3.
    assert c["stress_xx"][-1] + 50e6 == pytest.approx(-YOUNG * 0.001, rel=3e-3)


def test_a_history_is_the_path_that_it_describes(tmp_path):
    (tmp_path / "shear.csv").write_text("# a comment\ntime_s,F_xy,remark\n0,0,a\n1e-4,0.01,b\n3e-4,-0.01,c\n")
    paths = [{"type": "history", "file": "shear.csv"},
             {"type": "simple_shear", "strains": [0, 0.01, -0.01], "times": [0, 1e-4, 3e-4]}]
    assert drive(tmp_path, paths).returncode == 0
    a, b = curve(tmp_path, "steel.history"), curve(tmp_path, "steel.simple_shear")
    for name in ("time", "stress_xx", "stress_xy", "pressure", "specific_energy"):
        assert np.array_equal(a[name], b[name]), name


def test_a_rotation_leaves_the_stress_turned(tmp_path):
    times = np.linspace(0.0, 1e-4, 2001)
    stretch, angle = np.minimum(times / 2e-5, 1.0) * 1e-3, np.maximum(times - 2e-5, 0.0) / 8e-5 * np.pi / 2
    c, s = np.cos(angle), np.sin(angle)
    rows = np.column_stack([times, c * (1 + stretch), -s, s * (1 + stretch), c])
    text = "time_s,F_xx,F_xy,F_yx,F_yy\n" + "\n".join(",".join(f"{v:.17g}" for v in row) for row in rows)
    (tmp_path / "turn.csv").write_text(text)
    assert drive(tmp_path, [{"type": "history", "file": "turn.csv", "steps": 2000}]).returncode == 0
    h = curve(tmp_path, "steel.history")
    before = np.argmin(np.abs(h["time"] - 2e-5))
    # A quarter of a turn swaps the axes; steps of 1/1600 of a turn err by their square.
    assert h["stress_yy"][-1] == pytest.approx(h["stress_xx"][before], rel=1e-5)
    assert h["stress_xx"][-1] == pytest.approx(h["stress_yy"][before], rel=1e-5)


def test_temperature_and_rate_change_the_strength(tmp_path):
    jc = {"density": 7830, "eos": {"type": "linear", "bulk_modulus": 160e9},
          "strength": {"type": "johnson_cook", "shear_modulus": 80e9, "A": 800e6, "B": 500e6, "n": 0.26, "C": 0.014,
                       "m": 1, "reference_temperature": 300, "melting_temperature": 1800, "specific_heat": 477,
                       "taylor_quinney": 0}}
    shear = {"type": "simple_shear", "strains": [0, 0.3]}
    paths = [shear | {"name": "slow", "rate": 1}, shear | {"name": "fast", "rate": 1e4},
             shear | {"name": "hot", "rate": 1, "initial_state": {"temperature": "1050 K"}}]
    assert drive(tmp_path, paths, {"steel": jc}).returncode == 0
    slow, fast, hot = (curve(tmp_path, f"steel.{n}") for n in ("slow", "fast", "hot"))
    assert np.all(hot["temperature"] == 1050)
    # (1 + C ln rate): rates of plastic strain are 1e4 apart. The other: 1 - T* = 0.5.
    by_rate = 1 + 0.014 * np.log(1e4 / np.sqrt(3))
    assert fast["von_mises"][-1] / slow["von_mises"][-1] == pytest.approx(by_rate, rel=2e-3)
    # The plastic strains differ by the elastic ones, 0.3 %, which changes the hardening by a fifth of that.
    assert hot["von_mises"][-1] / slow["von_mises"][-1] == pytest.approx(0.5, rel=2e-3)


def test_an_element_that_fails_ends_the_path_unless_it_is_to_go_on(tmp_path):
    brittle = STEEL | {"erosion": {"criteria": [{"type": "tensile_stress", "limit": "200 MPa"}]}}
    path = {"type": "uniaxial_stress", "strains": [0, 0.002], "rate": "100 1/s", "steps": 2000}
    done = drive(tmp_path, [path, path | {"name": "on", "after_failure": "go_on"}], {"steel": brittle})
    assert done.returncode == 0 and done.stdout.count("the element fails at") == 2
    stopped, on = curve(tmp_path, "steel.uniaxial_stress"), curve(tmp_path, "steel.on")
    assert stopped["failed"][-1] == 1 and not np.any(stopped["failed"][:-1])
    # Within one step, 1e-6 of strain, of 1e-3.
    assert stopped["strain"][-1] == pytest.approx(200e6 / YOUNG, rel=3e-3)
    assert on["strain"][-1] == 0.002


# ---- references

def reference(folder, error=0.0):
    """Shear of an elastic cube with Jaumann's rate: the stress is G sin(gamma), after Dienes (1979)."""
    times = np.linspace(0.0, 1e-3, 21)
    rows = "\n".join(f"{t:.17g},{SHEAR * np.sin(1000 * t * 1e-2) * (1 + error):.17g}" for t in times)
    (folder / "table.csv").write_text("time_s,stress_xy_Pa\n" + rows + "\n")
    return {"type": "simple_shear", "strains": [0, 0.01], "rate": 10, "references": [{"file": "table.csv"}]}


def test_a_reference_passes_and_fails(tmp_path):
    path = reference(tmp_path)
    path["references"][0]["tolerance"] = 1e-5  # steps of 1e-5 of shear err by the square of that
    done = drive(tmp_path, [path], options=["--check"])
    assert done.returncode == 0 and "stress_xy" in done.stdout and done.stdout.rstrip().endswith("pass"), done.stderr
    assert not (tmp_path / "point.drive").exists()
    path = reference(tmp_path, error=1e-4)
    path["references"][0]["tolerance"] = 1e-5
    done = drive(tmp_path, [path], options=["--check"])
    assert done.returncode == 1 and done.stdout.rstrip().endswith("FAIL") and "1 of 1 checks fail" in done.stderr


def test_a_reference_that_a_failed_element_does_not_reach_fails(tmp_path):
    path = reference(tmp_path)
    path["references"][0]["tolerance"] = 1e-5
    brittle = STEEL | {"erosion": {"criteria": [{"type": "maximum_shear", "limit": 0.001, "measure": "tensor"}]}}
    done = drive(tmp_path, [path], {"steel": brittle}, options=["--check"])
    assert done.returncode == 1 and "nan" in done.stdout, done.stdout + done.stderr


def test_nothing_to_check_is_an_error(tmp_path):
    done = drive(tmp_path, [reference(tmp_path)], options=["--check"])
    assert done.returncode == 2 and "nothing to check" in done.stderr


# ---- what is refused

SHEARS = {"type": "simple_shear", "strains": [0, 0.1], "rate": 1}


@pytest.mark.parametrize("path, sentence", [
    ({"type": "simple_shear", "strains": [0, 0.1]}, "strains take either a rate or times"),
    (SHEARS | {"times": [0, 1]}, "strains take either a rate or times"),
    ({"type": "simple_shear", "rate": 1}, "every other path needs strains"),
    (SHEARS | {"strains": [0.1, 0.2]}, "strains begin at 0"),
    ({"type": "uniaxial_strain", "strains": [0, -1.5], "rate": 1}, "leaves nothing of the element"),
    ({"type": "uniaxial_strain", "strain_rates": [-1, -1], "times": [0, 2]}, "nothing is left of the element"),
    (SHEARS | {"confinement": 1e6}, "no other path takes them"),
    ({"type": "triaxial", "strains": [0, -0.1], "rate": 1}, "takes either confinement or isotropic_until"),
    (SHEARS | {"lateral_stress": 1e6}, "by uniaxial_stress only"),
    (SHEARS | {"lateral_strains": [0, 0.1]}, "for uniaxial_strain"),
    (SHEARS | {"materials": ["stel"]}, "did you mean `steel`?"),
    (SHEARS | {"name": "a/b"}, "expected a name that a file can have"),
    (SHEARS | {"initial_state": {"temperature": 300}}, "no law of material steel keeps \"temperature\""),
    (SHEARS | {"initial_state": {"specific_energy": "3 m"}}, "specific_energy"),
    ({"type": "history", "file": "none.csv"}, "none.csv"),
    (SHEARS | {"references": [{"file": "none.csv"}]}, "none.csv"),
    ({"type": "sheer", "strains": [0, 1], "rate": 1}, "simple_shear"),
])
def test_mistakes_are_told_with_their_place(tmp_path, path, sentence):
    code = 3 if "nothing is left" in sentence else 2
    refused(tmp_path, [path], sentence, code)


@pytest.mark.parametrize("text, sentence", [
    ("time_s,F_xx\n0,1\n", "at least two"),
    ("time_s,F_xx\n0,1\n1,1.1\n1,1.2\n", "times have to ascend"),
    ("time_s,F_xx\n0,1.1\n1,1.2\n", "the first row has to be that of the undeformed element"),
    ("time_s,F_xx\n0,1\n1,-1\n", "the determinant of the deformation gradient"),
    ("time_s,G_xx\n0,1\n1,2\n", "no column of the deformation gradient"),
    ("t,F_xx\n0,1\n1,2\n", "no column of numbers \"time_s\""),
    ("time_s,F_xx\n0,1\n1,x\n", "holds something that is no number"),
    ("time_s,F_xx\n0,1\n1\n", "expected 2, as many as the heading"),
    ("", "holds no table"),
])
def test_bad_histories_are_refused(tmp_path, text, sentence):
    (tmp_path / "path.csv").write_text(text)
    refused(tmp_path, [{"type": "history", "file": "path.csv"}], sentence)


def test_a_reference_that_does_not_fit_is_refused(tmp_path):
    path = reference(tmp_path)
    refused(tmp_path, [path | {"strains": [0, 0.005]}], "expected times of the path")
    path["references"][0]["tolerances"] = {"stress_yx": 1e-3}
    refused(tmp_path, [path], "no column \"stress_yx\" can be compared")
    path["references"][0]["tolerances"] = {"stress_xy": "small"}
    refused(tmp_path, [path], "tolerances.stress_xy is \"small\"")


def test_laws_are_checked_as_in_an_input(tmp_path):
    bad = STEEL | {"strength": {"type": "elastic", "shear_modulus": -1}}
    refused(tmp_path, [SHEARS], "shear_modulus", materials={"steel": bad})
    refused(tmp_path, [SHEARS, SHEARS], "two paths are called \"simple_shear\"")
    refused(tmp_path, [SHEARS], "there is no path \"sheer\"", pictures=[{"y": "von_mises", "paths": ["sheer"]}])


def test_a_material_that_cannot_be_confined_stops(tmp_path):
    weak = STEEL | {"eos": {"type": "ideal_gas", "gamma": 1.4, "initial_pressure": "100 kPa"}}
    done = drive(tmp_path, [{"type": "triaxial", "confinement": "900 GPa", "strains": [0, -0.1], "rate": 1}],
                 {"steel": weak})
    assert done.returncode == 3 and "material steel on path triaxial" in done.stderr, done.stderr
    assert "the confinement of 9e+11 Pa is not reached" in done.stderr


# ---- shipped

@pytest.mark.parametrize("path", DRIVES, ids=lambda path: path.stem)
def test_shipped_drives_run(tmp_path, path):
    done = subprocess.run([KERF, "drive", path, "--output", tmp_path / "out"], capture_output=True, text=True,
                          timeout=120)
    assert done.returncode == 0, done.stderr
    assert "error" not in done.stderr


# ---- pictures

def draw(folder):
    return subprocess.run([sys.executable, "-B", str(ROOT / "framework/post/drive.py"), str(folder / "point.drive")],
                          capture_output=True, text=True, timeout=120)


def test_pictures_are_drawn_with_points_laid_under(tmp_path):
    path = reference(tmp_path)
    (tmp_path / "measured.csv").write_text("strain in %,stress in MPa\n0.2,160\n0.6,480\n")
    pictures = [{"y": "stress_xy", "points": [{"file": "measured.csv", "x_scale": 0.01, "y_scale": 1e6,
                                               "label": "measured"}]}]
    assert drive(tmp_path, [path], pictures=pictures).returncode == 0
    done = draw(tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "point.drive" / "stress_xy_over_strain.png").stat().st_size > 10000


def test_a_picture_of_nothing_is_an_error(tmp_path):
    assert drive(tmp_path, [SHEARS], pictures=[{"y": "temperature"}]).returncode == 0
    done = draw(tmp_path)
    assert done.returncode == 1 and "no curve has both columns strain and temperature" in done.stderr
    bad = [{"y": "stress_xy", "points": [{"file": "none.csv"}]}]
    assert drive(tmp_path, [SHEARS], pictures=bad).returncode == 0
    done = draw(tmp_path)
    assert done.returncode == 1 and "none.csv" in done.stderr and "Traceback" not in done.stderr


# ---- laws that are not isotropic

def test_a_law_that_is_not_isotropic_cannot_keep_a_lateral_stress(tmp_path):
    (tmp_path / "fibre.py").write_text('''
from kerf_laws import Material, deviator


class Fibre(Material):
    "twice as stiff along y"

    def update(self, p):
        d = 2e11 * deviator(p.strain_increment)
        d[1] *= 2
        p.deviator += deviator(d)
        return 2e11
''')
    fibre = STEEL | {"strength": {"type": "fibre"}}
    done = drive(tmp_path, [{"type": "uniaxial_stress", "strains": [0, 0.01], "rate": 1}], {"fibre": fibre},
                 plugins=["fibre.py"])
    assert done.returncode == 3, done.stdout + done.stderr
    assert "the law is not isotropic, and uniaxial_stress keeps one" in done.stderr
