"""The command line: what each command prints, its exit code, and the ways of starting a run on several ranks."""

import fcntl
import json
import os
import re
import subprocess

import jsonschema
import pytest
import yaml

from input_case import GOOD, KERF, SOURCE, kerf, on_ranks, settings, spoiled, summary_of
from shipped import INPUTS

MPIRUN = ["mpirun", "-n", "2", "--oversubscribe", "--bind-to", "none"] + (["--allow-run-as-root"] if os.geteuid() == 0
                                                                         else [])


@pytest.fixture
def case(tmp_path):
    (tmp_path / "case.yaml").write_text(GOOD)
    return tmp_path


# ---- check

def test_check_reports_what_a_run_will_be(case):
    done = kerf("check", "case.yaml", cwd=case)
    assert done.returncode == 0 and done.stderr == ""
    lines = done.stdout.splitlines()
    assert lines[0].split() == "part elements nodes smallest edge largest edge scaled Jacobian".split()
    assert lines[1].split() == ["target", "32", "75", "0.001", "m", "0.001", "m", "1.000"]
    assert lines[2].split() == ["striker", "8", "27", "0.001", "m", "0.001", "m", "1.000"]
    report = {key: value for key, value in (re.split(r"\s{2,}", line, maxsplit=1) for line in lines[4:])}
    assert report["elements"] == "40" and report["nodes"] == "102"
    # 0.9 h / c with c = sqrt((K + 4/3 G) / rho), for cubes of 1 mm.
    speed = ((130e9 + 4 / 3 * 43e9) / 8930) ** 0.5
    step = re.fullmatch(r"(\S+) s, set by element (\d+) of part (?:target|striker)", report["first time step"])
    assert float(step[1]) <= 0.9e-3 / speed * 1.001 and int(step[2]) < 40
    assert float(report["cycles, about"]) == pytest.approx(2e-6 / float(step[1]), abs=1)
    assert re.fullmatch(r"\d+\.\d MB", report["memory, about"])
    assert re.fullmatch(r"\d+\.\d MB in 21 frames", report["output, about"])
    assert float(report["mass"].split()[0]) == pytest.approx(8930 * 40e-9, rel=1e-5)
    assert float(report["kinetic energy"].split()[0]) == pytest.approx(0.5 * 8930 * 8e-9 * 200**2, rel=1e-5)
    assert report["initial penetration"] == "none"
    assert sorted(p.name for p in case.iterdir()) == ["case.yaml"], "nothing is written"


def test_check_sees_a_skewed_mesh(case):
    """The nose of a rod has cells that are no bricks."""
    text = spoiled([("{type: block, size: 2 2 2 mm, origin: 1 1 2.1 mm, cells: [2, 2, 2]}",
                     "{type: cylinder, radius: 1 mm, length: 4 mm, cell_size: 0.25 mm, nose: {type: hemispherical}}"),
                    ("velocity: $speed", "placement: [{translate: 2 2 3 mm}]")])
    (case / "case.yaml").write_text(text)
    done = kerf("check", "case.yaml", cwd=case)
    assert done.returncode == 0, done.stderr
    row = next(line.split() for line in done.stdout.splitlines() if line.startswith("striker"))
    assert 0.05 < float(row[-1]) < 0.9 and float(row[3]) < float(row[5])


def test_check_gives_the_same_report_on_two_ranks(case):
    one, two = (kerf("check", "case.yaml", *on_ranks(n), cwd=case) for n in (1, 2))
    without_memory = [re.sub(r"memory.*", "", done.stdout) for done in (one, two)]
    assert two.returncode == 0 and without_memory[0] == without_memory[1]


@pytest.mark.parametrize("path", INPUTS, ids=lambda p: p.stem)
def test_shipped_inputs_pass_the_check(path):
    done = kerf("check", path)
    assert done.returncode == 0, done.stderr
    assert "initial penetration  none" in done.stdout


# ---- list, describe, schema

def test_list_shows_every_kind():
    done = kerf("list")
    assert done.returncode == 0
    kinds = [line for line in done.stdout.splitlines() if line and line[0] != " "]
    declared = [name for name in json.loads(kerf("schema").stdout)["$defs"] if "." not in name]
    assert kinds == sorted(declared) and len(kinds) > 9


def test_list_of_one_kind():
    done = kerf("list", "contact")
    assert [line.split()[0] for line in done.stdout.splitlines()] == ["contact", "eroding_surface", "slide_surface"]


def test_every_listed_type_is_described():
    kind, n_described = None, 0
    for line in kerf("list").stdout.splitlines():
        if line and line[0] != " ":
            kind = line
        elif line:
            name, summary = line.split(maxsplit=1)
            done = kerf("describe", kind, name)
            assert done.returncode == 0 and done.stdout.startswith(f"{name} ({kind}): {summary}\n")
            n_described += 1
    assert n_described > 30


def test_describe_shows_units_ranges_and_defaults():
    done = kerf("describe", "slide_surface")
    assert "  penalty: number, greater than 0, by default 0.1\n" in done.stdout
    assert "  slave: list of texts, required\n" in done.stdout
    text = kerf("describe", "input").stdout
    assert "      safety_factor: number, greater than 0 and at most 1, by default 0.9\n" in text
    assert "  parameters: values by name, optional\n" in text


REFUSED = {
    "list matrial": 'there is no kind "matrial"; did you mean `material`?',
    "describe elastik": 'nothing is called "elastik"; did you mean `elastic`?',
    "describe material": '"material" is a kind, not a name; `kerf list material` shows its names',
    "describe boundry fixed": 'there is no kind "boundry"; did you mean `boundary`?',
    "chek case.yaml": 'there is no command "chek"; did you mean `kerf check`?',
    "xyz": 'there is no command "xyz"; `kerf --help` shows all commands',
    "run": "INPUT is required; `kerf run --help` shows what can be typed",
    "run case.yaml other.yaml": '"other.yaml" is one argument too many; `kerf run --help` shows what can be typed',
    "run case.yaml --rank 2": "`kerf run` has no option --rank; did you mean --ranks?; `kerf run --help` shows what "
                              "can be typed",
    "run case.yaml --ranks 0": '--ranks: "0" is no number of ranks; expected a whole number from 1 on; `kerf run '
                               "--help` shows what can be typed",
    "run case.yaml --ranks two": '--ranks: "two" is no number of ranks; expected a whole number from 1 on; `kerf run '
                                 "--help` shows what can be typed",
}


@pytest.mark.parametrize("words", REFUSED)
def test_what_cannot_be_typed(words, case):
    """Exit code 1: not a mistake in an input file."""
    done = kerf(*words.split(), cwd=case)
    assert done.returncode == 1
    assert done.stderr == f"error: {REFUSED[words]}\n"
    assert done.stdout == ""


def test_help_and_version():
    assert kerf("--help").returncode == 0
    assert kerf("run", "--help").returncode == 0
    done = kerf("--version")
    assert done.returncode == 0 and re.fullmatch(r"kerf \d+\.\d+\.\d+ \(interface \d+\)\n", done.stdout)
    alone = kerf()
    assert alone.returncode == 1 and "check an input file without running it" in alone.stdout


@pytest.fixture(scope="module")
def schema():
    done = kerf("schema")
    assert done.returncode == 0
    made = json.loads(done.stdout)
    jsonschema.Draft202012Validator.check_schema(made)
    return jsonschema.Draft202012Validator(made)


@pytest.mark.parametrize("path", INPUTS, ids=lambda p: p.stem)
def test_schema_accepts_the_shipped_inputs(path, schema):
    schema.validate(yaml.safe_load(path.read_text()))


def test_parameters_may_stand_for_any_single_value(schema, case):
    """In the schema and in the program alike."""
    text = spoiled([
        ("  speed: 0 0 -200 m/s", "  speed: 0 0 -200 m/s\n  finish: 2 us\n  how: any\n  many: 4\n  balanced: true"),
        ("end: 2 us", "end: $finish"), ("rule: any", "rule: $how"), ("cells: [4, 4, 2]", "cells: [$many, 4, 2]"),
        ("output:", "balance: {enabled: $balanced}\noutput:")])
    schema.validate(yaml.safe_load(text))
    (case / "case.yaml").write_text(text)
    done = kerf("check", "case.yaml", cwd=case)
    assert done.returncode == 0, done.stderr


SCHEMA_REFUSES = {
    "unknown key": ("end: 2 us", "ende: 2 us"),
    "unknown type": ("type: elastic_plastic", "type: elastic_plastik"),
    "missing key": ("    density: 8930 kg/m3\n", ""),
    "number out of range": ("end: 2 us", "end: -2.0"),
    "choice": ("rule: any", "rule: some"),
    "list of two": ("size: 4 4 2 mm", "size: [4, 4]"),
    "parameter that is a list": ("  speed: 0 0 -200 m/s", "  speed: [0, 0, -200]"),
    "text that is no number": ("8930 kg/m3", "heavy"),
}


@pytest.mark.parametrize("name", SCHEMA_REFUSES, ids=lambda n: n.replace(" ", "_"))
def test_schema_refuses(name, schema):
    schema.validate(yaml.safe_load(GOOD))
    assert not schema.is_valid(yaml.safe_load(spoiled([SCHEMA_REFUSES[name]])))


# ---- run

def test_a_run_writes_its_files_and_its_table(case):
    done = kerf("run", "case.yaml", cwd=case)
    assert done.returncode == 0 and done.stderr == ""
    assert re.search(r"^40 elements, 102 nodes, 1 rank; first stable step \S+ s$", done.stdout, re.M)
    line = r"^cycle +\d+  t \S+ s  dt \S+ s \(element \d+ of part \w+\)  energy \S+ %  eroded +0  imbalance 1.000"
    assert re.search(line, done.stdout, re.M)
    folder = case / "results" / "case"
    assert sorted(p.name for p in folder.iterdir()) == ["balance.csv", "erosion.csv", "history.csv", "restart",
                                                         "results.vtkhdf", "summary.json"]
    summary = summary_of(folder)
    assert summary["exit"] == "completed" and summary["ranks"] == 1 and summary["end_time"] == pytest.approx(2e-6)
    assert f"state hash {summary['state_hash']}" in done.stdout
    assert summary["measures"]["exit.speed"] > 0.0


@pytest.mark.parametrize("ranks", [2, 3])
def test_the_option_ranks(case, ranks):
    """More ranks than cores, too."""
    one = kerf("run", "case.yaml", "--output", "one", cwd=case)
    many = kerf("run", "case.yaml", "--output", "many", "--ranks", ranks, cwd=case)
    assert one.returncode == many.returncode == 0, many.stderr
    assert many.stderr == ""
    assert summary_of(case / "many")["ranks"] == ranks
    assert summary_of(case / "many")["state_hash"] == summary_of(case / "one")["state_hash"]


def mpirun(*words, cwd):
    return subprocess.run([*MPIRUN, KERF, *words], cwd=cwd, capture_output=True, text=True, timeout=120)


def test_plain_mpirun(case):
    done = mpirun("run", "case.yaml", "--output", "out", cwd=case)
    assert done.returncode == 0, done.stderr
    assert summary_of(case / "out")["ranks"] == 2
    assert done.stdout.count("completed:") == 1, "one rank prints"


def test_plain_mpirun_with_the_same_number_of_ranks(case):
    done = mpirun("run", "case.yaml", "--output", "out", "--ranks", "2", cwd=case)
    assert done.returncode == 0, done.stderr
    assert summary_of(case / "out")["ranks"] == 2


def test_plain_mpirun_with_another_number_of_ranks(case):
    done = mpirun("run", "case.yaml", "--output", "out", "--ranks", "3", cwd=case)
    assert done.returncode == 1
    assert "error: mpirun started 2 ranks, but --ranks asks for 3; leave one of them out" in done.stderr


def test_plain_mpirun_passes_on_the_exit_code_and_prints_once(case):
    done = mpirun("run", "case.yaml", "--set", "time.end=1 mm", cwd=case)
    assert done.returncode == 2
    assert done.stderr.count("has the wrong dimension") == 1


def test_set_replaces_values(case):
    changes = {"time.end": "1 us", "parts.striker.mesh.cells": "[3, 3, 3]", "title": "changed",
               "contacts[0].friction": "0.2", "parameters.speed": "0 0 -100 m/s"}
    done = kerf("run", "case.yaml", "--output", "out", *settings(changes), cwd=case)
    assert done.returncode == 0, done.stderr
    summary = summary_of(case / "out")
    assert summary["end_time"] == pytest.approx(1e-6)
    assert summary["parts"]["striker"]["elements"] == 27
    assert summary["energy"]["initial"] == pytest.approx(0.5 * 8930 * 8e-9 * 100**2)


# ---- one folder, one run

@pytest.mark.parametrize("name", ["PMI_SIZE", "SLURM_STEP_NUM_TASKS"])
def test_ranks_that_do_not_know_of_each_other_are_refused(case, name):
    """A launcher of another MPI starts two processes, each of which MPI calls the only one."""
    done = kerf("run", "case.yaml", cwd=case, env={**os.environ, name: "2"})
    assert done.returncode == 2 and f"{name} is 2: error: 2 processes were started, and MPI knows of one" in done.stderr
    assert sorted(p.name for p in case.iterdir()) == ["case.yaml"], "nothing is written"


def test_a_folder_in_which_a_run_works_is_refused(case):
    folder = case / "results" / "case"
    folder.mkdir(parents=True)
    held = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(held, fcntl.LOCK_EX)
        done = kerf("run", "case.yaml", cwd=case)
        assert done.returncode == 2
        assert "case: error: another run works in this folder; wait for its end, or name another" in done.stderr
        assert not list(folder.iterdir())
    finally:
        os.close(held)
    assert kerf("run", "case.yaml", cwd=case).returncode == 0
