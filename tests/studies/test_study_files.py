"""What is wrong with a study file is told with its line and column, all of it, with exit code 2."""

import re

import pytest
from study_case import STUDY, sweep, write

POINTS = "points: {type: grid, axes: {speed: [100 m/s, 150 m/s]}}\n"

# (what is appended to the study or replaced in it, line, column, sentence). STUDY has 8 lines.
BAD = {
    "unknown key": ("pionts: 3\n", 9, 1, "unknown key `pionts` in the study; did you mean `points`?"),
    "unknown kind": ("points: {type: gird}\n", 9, 16, '`type` is the text "gird"; did you mean `grid`?'),
    "unknown parameter": ("points: {type: grid, axes: {sped: [1 m/s]}}\n", 9, 29,
                          "`sped` is no parameter of this study; did you mean `speed`?"),
    "two units": ("points: {type: grid, axes: {speed: [1 m/s, 2 km/s]}}\n", 9, 44,
                  "`2 km/s` has another unit than `speed` has elsewhere in this study; expected a number in m/s"),
    "no number": ("points: {type: grid, axes: {speed: [fast]}}\n", 9, 37, "`fast` is no number; expected a number"),
    "range": ("points: {type: grid, axes: {speed: {from: 3 m/s, to: 1 m/s, count: 2}}}\n", 9, 36,
              "the range goes from 3 to 1; expected the lower end first"),
    "no count": ("points: {type: grid, axes: {speed: {from: 1 m/s, to: 3 m/s}}}\n", 9, 36,
                 "the required key `count` of a range is missing; expected a number of values, from 2 on"),
    "no seed": ("points: {type: latin_hypercube, n: 3, ranges: {speed: {from: 1 m/s, to: 3 m/s}}}\n", 9, 9,
                "the required key `seed` of `points` is missing"),
    "n of zero": ("points: {type: latin_hypercube, n: 0, seed: 1, ranges: {speed: {from: 1 m/s, to: 2 m/s}}}\n", 9, 36,
                  '`n` is the text "0"; expected a number of points, from 1 on'),
    "different parameters": ("points: {type: values, values: [{speed: 1 m/s}, {strength: 1 MPa}]}\n", 9, 49,
                             "this point has strength, but the first one has speed"),
    "cells that are not whole": ("points: {type: mesh, factors: [1.2]}\n", 9, 9,
                                 "it is no longer whole numbers of cells; expected whole numbers of cells"),
    "factors of text": ("points: {type: mesh, factors: [fine]}\n", 9, 32, '`factors` is the text "fine"'),
    "given twice": (POINTS + "title: again\n", 10, 1, "the key `title` is given twice; expected it once"),
    "set without a place": (POINTS + "set: {parts.stricker.velocity: 1}\n", 10, 7,
                            "input.yaml has no `parts.stricker`; did you mean `striker`?"),
    "ranks": (POINTS + "ranks: 0\n", 10, 8, '`ranks` is the text "0"; expected a number of MPI ranks, from 1 on'),
    "limits": (POINTS + "limits: {balance: 0.1}\n", 10, 10, "unknown key `balance` in `limits`; did you mean "
               "`balance_error`?"),
    "plot": (POINTS + "plots: [{type: recht_ipson, striking: sped, residual: residual}]\n", 10, 39,
             "`striking` is `sped`, which is not a parameter of this study; did you mean `speed`?"),
    "exponent": (POINTS + "plots: [{type: recht_ipson, striking: speed, residual: residual, p: two}]\n", 10, 69,
                 '`p` is the text "two"; expected a number above zero, or `free`'),
    "measured": (POINTS + "plots: [{type: recht_ipson, striking: speed, residual: residual, measured: [[1]]}]\n", 10,
                 77, "a measured point is no pair"),
    "two plots of one name": (POINTS + "plots: [{type: line, x: speed, y: residual}, "
                              "{type: line, x: speed, y: residual}]\n", 10, 46, "two plots are called `line_residual`"),
    "template": (POINTS + "slurm: {template: none.sh}\n", 10, 19, "there is no file"),
    "no YAML": ("points: [\n", 10, 1, "this is no YAML"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_study_is_refused_with_its_place(tmp_path, name):
    appended, line, column, sentence = BAD[name]
    study = write(tmp_path, appended)
    done = sweep(study)
    assert done.returncode == 2, done.stdout + done.stderr
    assert f"{study}:{line}:{column}: error: " in done.stderr, done.stderr
    assert sentence in done.stderr
    assert not (tmp_path / "out").exists()


INSIDE = {
    "path": ("materials.copper.strength.yield_stress", "materials.copper.strength.yeild_stress", 5, 13,
             "input.yaml has no `materials.copper.strength.yeild_stress`; did you mean `yield_stress`?"),
    "component": ("velocity[2]", "velocity[3]", None, None, "has no component [3]; expected a vector of numbers"),
    "no input": ("input: input.yaml", "input: inptu.yaml", 2, 8, "the input `inptu.yaml` cannot be used"),
    "name of the table": ("  residual:", "  exit:", 7, 3, "`exit` cannot be the name of a result"),
    "two sources": ("balance: energy.balance_error", "balance: {path: a, history: b}", 8, 12,
                    "has none or several of `path`, `history` and `observer`; expected one of them"),
    "what to take": ("balance: energy.balance_error", "balance: {history: kinetic, take: mean}", 8, 37,
                     '`take` is the text "mean"'),
}


@pytest.mark.parametrize("name", INSIDE)
def test_a_bad_line_is_told(tmp_path, name):
    old, new, line, column, sentence = INSIDE[name]
    assert old in STUDY
    study = write(tmp_path, POINTS, study=STUDY.replace(old, new))
    done = sweep(study, "--check")
    assert done.returncode == 2
    assert sentence in done.stderr
    if line:
        assert f"{study}:{line}:{column}: error: " in done.stderr, done.stderr


def test_all_mistakes_are_told_at_once_in_their_order(tmp_path):
    study = write(tmp_path, "points: {type: gird}\nranks: none\n", "titel: x\n")
    done = sweep(study, "--check")
    assert [int(line) for line in re.findall(r"study\.yaml:(\d+):\d+: error", done.stderr)] == [9, 10, 11]


def test_a_study_without_points_says_what_can_do_without(tmp_path):
    done = sweep(write(tmp_path), "--check")
    assert done.returncode == 2
    assert "the required key `points` of the study is missing" in done.stderr


@pytest.mark.parametrize("text", ["", "[1, 2]\n", "just text\n", "title: &a [*a]\n", "title: !run x\n",
                                  "input: input.yaml\npoints: *none\n", "a: 1\n---\nb: 2\n"])
def test_what_is_no_map_is_refused(tmp_path, text):
    study = write(tmp_path, study=text)
    done = sweep(study, "--check")
    assert done.returncode == 2 and "error:" in done.stderr and "Traceback" not in done.stderr


@pytest.mark.parametrize("options, sentence", [
    (["--jobs", "0"], "expected a whole number from 1 on"), (["--submit"], "--submit goes with --slurm only"),
    (["--check", "--collect"], "not allowed with")])
def test_bad_options_are_refused(tmp_path, options, sentence):
    done = sweep(write(tmp_path, POINTS), *options)
    assert done.returncode == 2 and sentence in done.stderr


def test_collecting_what_was_never_run_is_refused(tmp_path):
    done = sweep(write(tmp_path, POINTS), "--collect")
    assert done.returncode == 1 and "there is no such folder" in done.stderr
