"""What the contract of laws promises to authors of plugins: inputs, tensors, reads, and what becomes of exceptions."""

import json
import re

import h5py
import numpy as np
import pytest

from plugin_case import KERF, SOURCE, cached, call, compile_library


def library(folder, name, source):
    path = folder / f"{name}.cpp"
    path.write_text(source)
    return compile_library(path, folder / f"{name}.so", "-O1")


# ---- exceptions

# Each throws in the element at `place`, from `begin` on.
FRAGILE = """
#include <kerf/eos.hpp>
#include <kerf/erosion.hpp>
#include <kerf/material.hpp>
#include <kerf/solid.hpp>

#include <stdexcept>

using namespace kerf;

struct Trigger {
  double place = 0.0, begin = 0.0;
  template <class S>
  static void describe(S& s) {
    s.real(&Trigger::place, "place", "m", any_value, "x of the element's centre");
    s.real(&Trigger::begin, "begin", "s", non_negative, "time from which it throws");
  }
  void pull(double x, double time) const {
    if (time > begin && std::fabs(x - place) < 1e-9) throw std::runtime_error("the trigger is pulled");
  }
};
struct FragileMaterial final : PointwiseMaterial<FragileMaterial>, Trigger {
  static constexpr unsigned inputs = with_reference_position;
  using State = NoVariables;
  static void describe(Schema<FragileMaterial>& s) { Trigger::describe(s); }
  void update_point(const PointInputWith<inputs>& in, SymTensor& stress, State&, double& modulus) const {
    pull(in.reference_position.x, in.time);
    stress = stress + (2.0 * 80e9) * deviator(in.strain_increment);
    modulus = 80e9;
  }
};
struct FragileEos final : PointwiseEos<FragileEos>, Trigger {
  static constexpr unsigned inputs = with_reference_position;
  using State = NoVariables;
  static void describe(Schema<FragileEos>& s) { Trigger::describe(s); }
  EosOutput evaluate_point(const EosInputWith<inputs>& in, const State&) const {
    pull(in.reference_position.x, in.time);
    return {160e9 * (in.density / in.reference_density - 1.0), 160e9};
  }
};
struct FragileSolid final : PointwiseSolid<FragileSolid>, Trigger {
  static constexpr unsigned inputs = with_reference_position;
  using State = NoVariables;
  static void describe(Schema<FragileSolid>& s) { Trigger::describe(s); }
  void update_point(const SolidInputWith<inputs>& in, SymTensor& stress, State&, SolidModuli& moduli) const {
    pull(in.reference_position.x, in.time);
    const double p = 160e9 * in.strain_increment.trace();
    stress = stress + (2.0 * 80e9) * deviator(in.strain_increment) + SymTensor{p, p, p, 0.0, 0.0, 0.0};
    moduli = {80e9, 160e9};
  }
};
struct FragileCriterion final : PointwiseErosion<FragileCriterion>, Trigger {
  static constexpr unsigned inputs = with_reference_position;
  using State = NoVariables;
  using Reads = NoVariables;
  static void describe(Schema<FragileCriterion>& s) {
    Trigger::describe(s);
    describe_interval(s);
  }
  Verdict judge_point(const ErosionInputWith<inputs>& in, const Reads&, State&) const {
    pull(in.reference_position.x, in.time);
    return {0.0, 0.0};
  }
};
KERF_REGISTER(KERF_TYPE(FragileMaterial, "material", "fragile", "throws")
              KERF_TYPE(FragileEos, "eos", "fragile", "throws") KERF_TYPE(FragileSolid, "solid", "fragile", "throws")
              KERF_TYPE(FragileCriterion, "erosion", "fragile", "throws"))
"""
TRIGGER = {"type": "fragile", "place": 0.0265, "begin": 2e-6}
STEEL = {"density": 7850, "strength": {"type": "elastic", "shear_modulus": "80 GPa"},
         "eos": {"type": "linear", "bulk_modulus": "160 GPa"}}
LAWS = {
    "material": {**STEEL, "strength": TRIGGER},
    "eos": {**STEEL, "eos": TRIGGER},
    "solid": {"density": 7850, "solid": TRIGGER},
    "erosion": {**STEEL, "erosion": {"criteria": [TRIGGER]}},
}


def bars(material):
    """Two bars side by side, of which the second is made of the material; elements have edges of a millimetre."""
    mesh = {"type": "block", "size": [0.04, 0.002, 0.002], "cells": [40, 2, 2]}
    return {
        "title": "bars", "time": {"end": "4 us"}, "materials": {"sound": STEEL, "law": material},
        "parts": {"sound": {"material": "sound", "mesh": mesh},
                  "bar": {"material": "law", "mesh": {**mesh, "size": [0.04, 0.001, 0.001], "cells": [40, 1, 1]},
                          "placement": [{"translate": "0 10 0 mm"}], "velocity": "-10 0 0 m/s"}},
        "boundaries": [{"type": "symmetry", "normal": [1, 0, 0]}],
    }


@pytest.fixture(scope="module")
def fragile(tmp_path_factory):
    return library(tmp_path_factory.mktemp("fragile"), "fragile", FRAGILE)


def run(model, plugin, folder, *options):
    case = folder / "case.yaml"
    case.write_text(json.dumps(model))
    return call(KERF, "run", case, "--plugin", plugin, "--output", folder / "out", *options, cwd=folder)


@pytest.mark.parametrize("kind", LAWS)
def test_a_law_that_throws_stops_the_run_and_is_named(fragile, tmp_path, kind):
    """The same element on any number of ranks: number 26 of the bar, after the 160 of the part before it."""
    messages = []
    for ranks in (1, 2, 3):
        folder = tmp_path / str(ranks)
        folder.mkdir()
        done = run(bars(LAWS[kind]), fragile, folder, "--ranks", ranks)
        assert done.returncode == 3, done.stdout + done.stderr
        line = next(line for line in done.stderr.splitlines() if "the trigger is pulled" in line)
        for text in (f"{kind} fragile (", "fragile.cpp", "element 186 of part bar", "at time 2."):
            assert text in line, line
        messages.append(re.sub(r"^.*the run stopped: ", "", line))
    assert len(set(messages)) == 1, messages


@pytest.mark.parametrize("kind", LAWS)
def test_a_law_that_does_not_throw_runs_to_the_end(fragile, tmp_path, kind):
    model = bars(json.loads(json.dumps(LAWS[kind]).replace("2e-06", "1.0")))
    done = run(model, fragile, tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


# ---- inputs

MATERIAL = """
#include <kerf/material.hpp>
using namespace kerf;
struct Asks final : PointwiseMaterial<Asks> {
  %s
  using State = NoVariables;
  static void describe(Schema<Asks>&) {}
  void update_point(const PointInputWith<%s>& in, SymTensor&, State&, double& modulus) const { modulus = %s; }
};
KERF_MATERIAL(Asks, "asks", "asks for inputs")
"""
INPUTS = [("with_length", "in.length"), ("with_initial_length", "in.initial_length"),
          ("with_reference_position", "in.reference_position.x"), ("with_rotation", "in.rotation.xx")]


@pytest.mark.parametrize("asked, used", INPUTS, ids=[a for a, _ in INPUTS])
def test_a_law_that_uses_what_it_did_not_ask_for_does_not_compile(tmp_path, asked, used):
    every = " | ".join(a for a, _ in INPUTS)
    others = " | ".join(a for a, _ in INPUTS if a != asked)
    for inputs, compiles in ((every, True), (others, False)):
        source = tmp_path / "asks.cpp"
        source.write_text(MATERIAL % (f"static constexpr unsigned inputs = {inputs};", "inputs", used))
        done = call(cached("CMAKE_CXX_COMPILER"), "-std=c++20", "-fsyntax-only", f"-I{SOURCE / 'framework' / 'api'}",
                    source)
        assert (done.returncode == 0) == compiles, done.stderr
        assert compiles or f"has no member named '{used.split('.')[1]}'" in done.stderr.replace("‘", "'").replace(
            "’", "'")


def test_a_law_of_blocks_has_to_say_what_its_inputs_are(tmp_path):
    law = """
#include <kerf/material.hpp>
struct Blocks final : kerf::Material {
  static constexpr unsigned inputs = kerf::with_length;
  %s
  static void describe(kerf::Schema<Blocks>&) {}
  void update(const kerf::MaterialBatch& b) const override {
    for (int l = 0; l < kerf::lane_width; ++l) b.shear_modulus[l] = b.length[l];
  }
};
KERF_MATERIAL(Blocks, "blocks", "works on blocks")
"""
    done = call(KERF, "list", "--plugin", library(tmp_path, "silent", law % ""))
    assert done.returncode == 2
    assert "material blocks (" in done.stderr and "silent.cpp" in done.stderr
    assert "`inputs` and asked_inputs() differ; override asked_inputs() to return `inputs`" in done.stderr
    done = call(KERF, "list", "--plugin",
                library(tmp_path, "says", law % "unsigned asked_inputs() const override { return inputs; }"))
    assert done.returncode == 0, done.stderr


def test_a_tensor_in_an_equation_of_state_is_refused(tmp_path):
    law = """
#include <kerf/eos.hpp>
struct Tensor final : kerf::PointwiseEos<Tensor> {
  struct State {
    kerf::SymTensor flow;
  };
  static void describe(kerf::Schema<Tensor>& s) { s.state(&State::flow, "flow", "-", "a tensor"); }
  kerf::EosOutput evaluate_point(const kerf::EosInput&, State&) const { return {0.0, 1.0}; }
};
KERF_EOS(Tensor, "tensor", "keeps a tensor")
"""
    done = call(KERF, "list", "--plugin", library(tmp_path, "tensor", law))
    assert done.returncode == 2
    assert ("eos tensor (" in done.stderr and "the state variable `flow_xx` belongs to a tensor, which nobody "
            "rotates for this kind; declare scalars" in done.stderr)


# ---- reads

# An equation of state keeps ten numbers; a material and a criterion read them all, one that nobody keeps, and one that
# the user names.
READERS = """
#include <kerf/eos.hpp>
#include <kerf/erosion.hpp>
#include <kerf/material.hpp>

using namespace kerf;

struct Keeper final : PointwiseEos<Keeper> {
  double scale = 0.0;
  struct State {
    double x[10], steps;
  };
  static void describe(Schema<Keeper>& s) {
    s.real(&Keeper::scale, "scale", "-", any_value, "x_i is i times it");
    s.state(&State::x, "x", "-", -1.0, "numbers");
    s.state(&State::steps, "steps", "-", 0.0, "steps that were taken");
  }
  void initialise_point(const InitialPoint& point, State& state) const {
    for (int i = 0; i < 10; ++i) state.x[i] = (i + 1) * scale + (state.x[i] + 1.0) + 0.0 * point.density;
  }
  EosOutput evaluate_point(const EosInput& in, State& state) const {
    state.steps += 1.0;
    return {160e9 * (in.density / in.reference_density - 1.0) + 1e-6 * in.specific_energy, 160e9};
  }
};
struct Ten {
  double a, b, c, d, e, f, g, h, i, j, absent, named;
  double sum() const { return a + 2 * b + 3 * c + 4 * d + 5 * e + 6 * f + 7 * g + 8 * h + 9 * i + 10 * j; }
};
template <class Law>
void declare(Schema<Law>& s) {
  double Ten::*const members[] = {&Ten::a, &Ten::b, &Ten::c, &Ten::d, &Ten::e,
                                  &Ten::f, &Ten::g, &Ten::h, &Ten::i, &Ten::j};
  for (int k = 0; k < 10; ++k) s.reads(members[k], "x_" + std::to_string(k + 1), "a number");
  s.reads(&Ten::absent, "nobody_keeps_it", "a number that is optional").by_default(7.5);
  s.text(&Law::variable, "variable", "what is read as well");
  s.reads(&Ten::named, &Law::variable, "what the user names");
}
struct ReadingMaterial final : PointwiseMaterial<ReadingMaterial> {
  std::string variable;
  using Reads = Ten;
  struct State {
    double sum, absent, named;
  };
  static void describe(Schema<ReadingMaterial>& s) {
    declare(s);
    s.state(&State::sum, "material_sum", "-", 0.0, "of the numbers times their places");
    s.state(&State::absent, "material_absent", "-", 0.0, "the optional number");
    s.state(&State::named, "material_named", "-", 0.0, "the number that was named");
  }
  void update_point(const PointInput&, const Reads& reads, SymTensor&, State& state, double& modulus) const {
    state = {reads.sum(), reads.absent, reads.named};
    modulus = 1e9;
  }
};
struct ReadingCriterion final : PointwiseErosion<ReadingCriterion> {
  std::string variable;
  using Reads = Ten;
  struct State {
    double sum, absent, named;
  };
  static void describe(Schema<ReadingCriterion>& s) {
    declare(s);
    describe_interval(s);
    s.state(&State::sum, "criterion_sum", "-", 0.0, "of the numbers times their places");
    s.state(&State::absent, "criterion_absent", "-", 0.0, "the optional number");
    s.state(&State::named, "criterion_named", "-", 0.0, "the number that was named");
  }
  Verdict judge_point(const ErosionInputPoint&, const Reads& reads, State& state) const {
    state = {reads.sum(), reads.absent, reads.named};
    return {0.0, 0.0};
  }
};
KERF_REGISTER(KERF_TYPE(Keeper, "eos", "keeper", "keeps") KERF_TYPE(ReadingMaterial, "material", "reader", "reads")
              KERF_TYPE(ReadingCriterion, "erosion", "reader", "reads"))
"""
READ = [f"{law}_{what}" for law in ("material", "criterion") for what in ("sum", "absent", "named")]


def reading(of_material="steps", of_criterion="steps"):
    model = bars({"density": 7850, "strength": {"type": "reader", "variable": of_material},
                  "eos": {"type": "keeper", "scale": 0.5},
                  "erosion": {"criteria": [{"type": "reader", "variable": of_criterion}]}})
    model["parts"].pop("sound")
    model["materials"].pop("sound")
    model["output"] = {"precision": "double", "results_interval": "4 us", "element_fields": ["steps", "x_3", *READ]}
    return model


@pytest.fixture(scope="module")
def readers(tmp_path_factory):
    return library(tmp_path_factory.mktemp("readers"), "readers", READERS)


def last_frame(folder):
    with h5py.File(folder / "out" / "results.vtkhdf") as file:
        cells = file["VTKHDF/CellData"]
        return {name: np.ravel(cells[name])[-40:] for name in ("steps", "x_3", *READ)}


@pytest.mark.parametrize("precision", ["double", "single"])
def test_laws_read_more_than_eight_variables_optional_ones_and_those_that_the_user_names(readers, tmp_path, precision):
    done = run(reading(), readers, tmp_path, "--ranks", "2", "--set", f"precision={precision}")
    assert done.returncode == 0, done.stdout + done.stderr
    frame = last_frame(tmp_path)
    cycles = json.loads((tmp_path / "out" / "summary.json").read_text())["cycles"]
    # Only the last of the two evaluations of a step counts, and none before the first step.
    assert np.all(frame["steps"] == cycles) and np.all(frame["x_3"] == 1.5)
    for law in ("material", "criterion"):
        assert np.all(frame[f"{law}_sum"] == 0.5 * sum(k * k for k in range(1, 11)))
        assert np.all(frame[f"{law}_absent"] == 7.5)
    # A material sees what the last step has left, a criterion what this one has made.
    assert np.all(frame["material_named"] == cycles - 1) and np.all(frame["criterion_named"] == cycles)


def test_what_every_element_keeps_can_be_named(readers, tmp_path):
    done = run(reading("volume", "mass"), readers, tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    frame = last_frame(tmp_path)
    assert frame["material_named"] == pytest.approx(1e-9, rel=0.01)  # a wave of a thousandth runs along the bar
    assert frame["criterion_named"] == pytest.approx(7850e-9, rel=1e-12)


def test_a_name_that_nothing_has_is_an_error_with_its_line(readers, tmp_path):
    done = run(reading("steps", "speed"), readers, tmp_path)
    assert done.returncode == 2
    assert 'reader reads the state variable "speed" (what the user names), which no law of material `law` declares' in (
        done.stderr)


def test_the_initial_state_can_be_set_by_the_input(readers, tmp_path):
    model = reading("x_3", "x_4")
    model["sets"] = {"left": {"box": [-1, -1, -1, 0.0101, 1, 1]}}
    model["initial_state"] = [{"variable": "x_3", "value": "9"},
                              {"variable": "x_4", "value": "8", "elements": ["left"]}]
    done = run(model, readers, tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    frame = last_frame(tmp_path)
    assert np.all(frame["x_3"] == 9.0) and np.all(frame["material_named"] == 9.0)
    assert sorted(set(frame["criterion_named"])) == [2.0, 8.0] and np.sum(frame["criterion_named"] == 8.0) == 10
