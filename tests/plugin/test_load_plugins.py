"""Loads of outside authors: the documented one runs, all three kinds act as declared, and faulty ones stop the run."""

import json

import numpy as np
import pytest

from plugin_case import KERF, call, compile_library
from test_documented_plugins import EXAMPLES, NAMES

# Loads that a test needs: uniform tractions, forces that know where they are, and faults.
LOADS = r"""
#include <kerf/load.hpp>

#include <limits>
#include <stdexcept>

using namespace kerf;

struct Traction final : FacetLoad {
  Vec3 value;
  static void describe(Schema<Traction>& s) { s.vector(&Traction::value, "traction", "Pa", any_value, "traction"); }
  std::vector<std::string> targets() const override { return {"top"}; }
  FacetForce force(const LoadedFacet& f, double) const override {
    // The undeformed top lies at z = 5 mm.
    return {0.0, f.reference_position.z == 5e-3 && f.normal.z > 0.9 ? value : Vec3{}};
  }
  bool reads_reference_position() const override { return true; }
};

/// Turns the body about the z axis: a force per mass that grows with the distance in the undeformed model.
struct Spin final : BodyLoad {
  double rate = 0.0;
  static void describe(Schema<Spin>& s) { s.real(&Spin::rate, "rate", "1/s2", any_value, "angular acceleration"); }
  std::vector<std::string> targets() const override { return {}; }
  bool reads_reference_position() const override { return true; }
  Vec3 acceleration(const LoadedNode& n, double) const override {
    return Vec3{-n.reference_position.y, n.reference_position.x, 0.0} * rate;
  }
};

struct Faulty final : NodalLoad {
  std::string fault;
  static void describe(Schema<Faulty>& s) { s.choice(&Faulty::fault, "fault", {"nan", "huge", "throws"}, "which"); }
  std::vector<std::string> targets() const override { return {"top"}; }
  Vec3 force(const LoadedNode&, double time) const override {
    if (time < 5e-7) return {};
    if (fault == "throws") throw std::runtime_error("the table has no such row");
    return {0.0, fault == "nan" ? std::numeric_limits<double>::quiet_NaN() : 1e18, 0.0};
  }
};

KERF_REGISTER(KERF_TYPE(Traction, "load", "traction", "a traction") KERF_TYPE(Spin, "load", "spin", "a spin")
                  KERF_TYPE(Faulty, "load", "faulty", "a fault"))
"""

CASE = {
    "time": {"end": "3 us", "maximum_step": "50 ns"},
    "materials": {"steel": {"density": 7850, "strength": {"type": "elastic", "shear_modulus": 80e9},
                            "eos": {"type": "linear", "bulk_modulus": 160e9}}},
    "parts": {"block": {"material": "steel", "mesh": {
        "type": "block", "origin": "[-4, -3, 0] mm", "size": "[8, 6, 5] mm", "cells": [8, 6, 5]}}},
    "sets": {"top": {"face": "z_max"}},
    "balance": {"force_interval": 10},
}


def compiled(source, folder, name):
    (folder / f"{name}.cpp").write_text(source)
    return compile_library(folder / f"{name}.cpp", folder / f"{name}.so", "-O1", "-Werror")


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return compiled(LOADS, tmp_path_factory.mktemp("loads"), "loads")


@pytest.fixture(scope="module")
def blast(tmp_path_factory):
    return compiled(EXAMPLES[NAMES.index(("LOAD", "blast"))], tmp_path_factory.mktemp("blast"), "blast")


def attempt(folder, library, load, ranks=1):
    path = folder / "case.yaml"
    path.write_text(json.dumps({**CASE, "loads": [load]}))
    return call(KERF, "run", path, "--plugin", library, "--output", folder / f"out_{ranks}", "--ranks", ranks)


def run(folder, library, load, ranks=1):
    done = attempt(folder, library, load, ranks)
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads((folder / f"out_{ranks}" / "summary.json").read_text())


def test_the_documented_load_runs_the_same_on_any_number_of_ranks(blast, tmp_path):
    load = {"type": "blast", "facets": "block", "source": "[0, 0, 30] mm", "peak": "200 MPa", "speed": "30 km/s",
            "duration": "2 us"}
    summaries = [run(tmp_path, blast, load, ranks) for ranks in (1, 2, 3)]
    assert len({s["state_hash"] for s in summaries}) == 1
    # The top faces the source at 25 mm: the pulse arrives at 0.83 us, and the integral of (1 - x) exp(-x) over the
    # duration is 1/e of it. At 3 us, x is 1.08, and the suction after the duration has not counted yet. Facets at the
    # rim of the top are up to 5 mm beside the axis, and are reached 20 ns later.
    impulse = summaries[0]["momentum"]["external_impulse"]
    assert impulse[2] == pytest.approx(-8e-3 * 6e-3 * 200e6 * 2e-6 / np.e, rel=0.05)
    # The sides see the source at a slant or not at all, and those that do lie opposite in pairs.
    assert np.abs(impulse[:2]).max() < 1e-9 * abs(impulse[2])


def test_a_traction_acts_on_the_area(library, tmp_path):
    summaries = [run(tmp_path, library, {"type": "traction", "traction": [2e6, -1e6, 0]}, ranks) for ranks in (1, 3)]
    assert summaries[0]["state_hash"] == summaries[1]["state_hash"]
    # In the plane of the top, which shears but hardly changes its area; velocities run half a step behind the time.
    expected = np.array([2e6, -1e6]) * 8e-3 * 6e-3 * (3e-6 - 25e-9)
    assert summaries[0]["momentum"]["external_impulse"][:2] == pytest.approx(expected, rel=1e-4)


def test_a_body_load_reads_where_a_node_was(library, tmp_path):
    summaries = [run(tmp_path, library, {"type": "spin", "rate": 1e10}, ranks) for ranks in (1, 3)]
    assert summaries[0]["state_hash"] == summaries[1]["state_hash"]
    # Energy of rotation, with the moment of inertia of the lumped masses: (n^2 + 2)/n^2 of that of n cells' length.
    mass = summaries[0]["mass"]["initial"]
    inertia = mass / 12 * (8e-3**2 * (1 + 2 / 8**2) + 6e-3**2 * (1 + 2 / 6**2))
    assert summaries[0]["energy"]["external"] == pytest.approx(inertia * (1e10 * 3e-6) ** 2 / 2, rel=0.02)


@pytest.mark.parametrize("ranks", [1, 3])
@pytest.mark.parametrize("fault, said", [
    ("nan", "nan N, is not finite, or out of all proportion to what the materials can bear"),
    ("huge", "1e+18 N, is not finite, or out of all proportion to what the materials can bear"),
    ("throws", "the load faulty (")])
def test_a_force_that_cannot_be_stops_the_run(library, tmp_path, fault, said, ranks):
    done = attempt(tmp_path, library, {"type": "faulty", "fault": fault}, ranks)
    assert done.returncode == 3, done.stdout + done.stderr
    assert said in done.stderr and "faulty" in done.stderr and done.stderr.count("at time ") == 1
    if fault == "throws":
        assert "failed: the table has no such row" in done.stderr
