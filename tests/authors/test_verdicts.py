"""What a criterion may say: anything else stops the run with the law's name, and never goes on with wrong numbers. And
what becomes of a run that goes on with another build of its plugin."""

import json

import pytest

from plugin_case import KERF, call, compile_library

CRITERION = """
#include <kerf/erosion.hpp>
using namespace kerf;
struct Speaks final : PointwiseErosion<Speaks> {
  %s
  using State = NoVariables;
  using Reads = NoVariables;
  static void describe(Schema<Speaks>& s) { describe_interval(s); }
  Verdict judge_point(const ErosionInputPoint& in, const Reads&, State&) const {
    const double late = select(in.time > 1e-6, 1.0, 0.0), none = 0.0 / (1.0 - late);
    Verdict v;
    %s
    (void)none;
    return v;
  }
};
KERF_EROSION(Speaks, "speaks", "says something")
"""
SOFTENS = "static constexpr bool can_soften = true;"
WRONG = {
    "a number": ("", "v.failed = 0.5 * late;", "by the number 0.5; expected 0 or 1"),
    "no number": ("", "v.failed = none;", "is not known: a number in the criterion is none (NaN)"),
    "a value that is none": ("", "v.value = none;", "is not known: a number in the criterion is none (NaN)"),
    "a share above one": (SOFTENS, "v.strength = 1.0 + late;",
                          "it leaves 2 of the deviator; expected a share from 0 to 1"),
    "a negative share": (SOFTENS, "v.tension = 1.0 - 2.0 * late;", "it leaves -1 of the tensile pressures"),
    "a share that is none": (SOFTENS, "v.compression = 1.0 + none;", "of the pressures in compression"),
    "a share that nobody heeds": ("", "v.strength = 1.0 - 0.5 * late;", "can_soften"),
}


def library(folder, name, text):
    (folder / f"{name}.cpp").write_text(text)
    return compile_library(folder / f"{name}.cpp", folder / f"{name}.so", "-O1")


def model(folder, **more):
    case = {"time": {"end": "3 us"},
            "materials": {"steel": {"density": 7850, "strength": {"type": "elastic", "shear_modulus": 80e9},
                                    "eos": {"type": "linear", "bulk_modulus": 160e9},
                                    "erosion": {"criteria": [{"type": "speaks"}]}}},
            "parts": {"bar": {"mesh": {"type": "block", "size": [0.004, 0.001, 0.001], "cells": [8, 2, 2]},
                              "material": "steel", "velocity": [-100, 0, 0]}},
            "boundaries": [{"type": "rigid_wall", "point": [0, 0, 0], "normal": [1, 0, 0]}]} | more
    (folder / "case.yaml").write_text(json.dumps(case))
    return folder / "case.yaml"


@pytest.mark.parametrize("wrong", WRONG)
def test_a_verdict_that_is_none_stops_the_run(tmp_path, wrong):
    declaration, statement, sentence = WRONG[wrong]
    plugin = library(tmp_path, "speaks", CRITERION % (declaration, statement))
    done = call(KERF, "run", model(tmp_path), "--plugin", plugin, "--output", tmp_path / "out")
    assert done.returncode == 3, done.stdout + done.stderr
    assert sentence in done.stderr and "erosion speaks" in done.stderr and "element" in done.stderr, done.stderr


@pytest.mark.parametrize("declaration, statement", [("", "v.value = late;"),
                                                    (SOFTENS, "v.strength = 1.0 - 0.5 * late;")])
def test_a_verdict_that_is_one_runs_to_the_end(tmp_path, declaration, statement):
    plugin = library(tmp_path, "speaks", CRITERION % (declaration, statement))
    done = call(KERF, "run", model(tmp_path), "--plugin", plugin, "--output", tmp_path / "out")
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_macro_of_another_kind_does_not_compile(tmp_path):
    text = (CRITERION % ("", "")).replace("KERF_EROSION(", "KERF_LOAD(").replace(
        "#include <kerf/erosion.hpp>", "#include <kerf/erosion.hpp>\n#include <kerf/load.hpp>")
    with pytest.raises(AssertionError, match="expected a type that derives from kerf::Load"):
        library(tmp_path, "speaks", text)


def test_a_run_that_goes_on_with_another_build_warns(tmp_path):
    plugin = library(tmp_path, "speaks", CRITERION % ("", "v.value = 1.0;"))
    case, out = model(tmp_path), tmp_path / "out"
    begin = ["--plugin", plugin, "--output", out]
    assert call(KERF, "run", case, *begin, "--set", "time.maximum_cycles=4").returncode == 0
    done = call(KERF, "run", case, *begin, "--resume")
    assert done.returncode == 0 and "other builds" not in done.stderr, done.stderr
    assert call(KERF, "run", case, *begin, "--set", "time.maximum_cycles=4").returncode == 0
    library(tmp_path, "speaks", CRITERION % ("", "v.value = 2.0;"))
    done = call(KERF, "run", case, *begin, "--resume")
    assert done.returncode == 0 and done.stderr.count("or with other builds of them") == 1, done.stderr
    warnings = json.loads((out / "summary.json").read_text())["warnings"]
    assert any("or with other builds of them" in text for text in warnings)
