"""Forces that an observer adds: an oscillation with a closed form, in the books as external, with the same bits on any
ranks, after re-balancing and after a restart."""

import csv
import json

import numpy as np
import pytest

from plugin_case import HERE, KERF, build, call, compile_library

RATE = 2.0e5  # angular frequency [1/s]
PERIOD = 2.0 * np.pi / RATE


@pytest.fixture(scope="module")
def spring(tmp_path_factory):
    return build(HERE / "out_of_tree", tmp_path_factory.mktemp("plugin"), "spring_to_point.so")


def model(**more):
    """A bar that flies at 20 m/s, held by springs: every node has the same acceleration, so that nothing deforms."""
    observer = {"type": "spring_to_point", "part": "bar", "stiffness": RATE**2, "interval": "0.2 us"} | more
    return {"time": {"end": PERIOD, "maximum_step": "20 ns"},
            "materials": {"steel": {"density": 7850, "strength": {"type": "elastic", "shear_modulus": 80e9},
                                    "eos": {"type": "linear", "bulk_modulus": 160e9}}},
            "parts": {"bar": {"mesh": {"type": "block", "size": [0.012, 0.002, 0.002], "cells": [12, 2, 2]},
                              "material": "steel", "velocity": [20, 0, 0]}},
            "observers": {"spring": observer},
            "output": {"history_interval": "0.2 us", "precision": "double"}}


def run(spring, folder, case, *options, code=0):
    (folder / "case.yaml").write_text(json.dumps(case))
    done = call(KERF, "run", folder / "case.yaml", "--plugin", spring, "--output", folder / "out", *options)
    assert done.returncode == code, done.stdout + done.stderr
    return done


def summary(folder):
    return json.loads((folder / "out" / "summary.json").read_text())


def history(folder):
    with open(folder / "out" / "history.csv", newline="") as file:
        rows = list(csv.reader(file))
    return {name.split(" ")[0]: np.array([float(row[i]) for row in rows[1:]]) for i, name in enumerate(rows[0])}


def test_the_oscillation_and_its_energy(spring, tmp_path):
    run(spring, tmp_path, model())
    h = history(tmp_path)
    whole = 0.5 * 7850 * 0.012 * 0.002**2 * 20.0**2
    # Central differences of 1570 steps a period: the phase errs by (w dt)^2/24 = 7e-7 of itself, energies alike.
    assert np.allclose(h["kinetic"], whole * np.cos(RATE * h["time"]) ** 2, atol=2e-5 * whole)
    assert np.allclose(h["external"], -whole * np.sin(RATE * h["time"]) ** 2, atol=2e-5 * whole)
    assert np.max(np.abs(h["balance_error"])) < 1e-9
    s = summary(tmp_path)
    assert s["exit"] == "completed" and s["cycles"] > 1500


def test_the_same_bits_on_any_ranks_with_rebalancing_and_restart(spring, tmp_path):
    hashes = {}
    for ranks, more in ((1, []), (2, []), (3, ["--set", "balance.force_interval=7"])):
        folder = tmp_path / f"ranks_{ranks}"
        folder.mkdir()
        run(spring, folder, model(), "--ranks", str(ranks), *more)
        hashes[ranks] = summary(folder)["state_hash"]
    folder = tmp_path / "resumed"
    folder.mkdir()
    run(spring, folder, model(), "--ranks", "2", "--set", "time.maximum_cycles=600")
    run(spring, folder, model(), "--ranks", "3", "--resume")
    hashes["resumed"] = summary(folder)["state_hash"]
    assert len(set(hashes.values())) == 1, hashes
    assert abs(history(folder)["external"][-1] - history(tmp_path / "ranks_1")["external"][-1]) < 1e-9


def test_forces_are_there_from_time_zero(spring, tmp_path):
    """Springs that are stretched at the start pull at once. If they did not, all would be late by half a step, and the
    energy of the motion would differ by up to w dt = 4e-3 of the whole."""
    case = model(offset=[20.0 / RATE, 0, 0])
    case["parts"]["bar"]["velocity"] = [0, 0, 0]
    run(spring, tmp_path, case)
    h = history(tmp_path)
    whole = 0.5 * 7850 * 0.012 * 0.002**2 * 20.0**2
    assert np.allclose(h["kinetic"], whole * np.sin(RATE * h["time"]) ** 2, atol=2e-5 * whole)
    assert np.allclose(h["external"], h["kinetic"], atol=1e-9 * whole)


@pytest.mark.parametrize("ranks", ["1", "2"])
def test_a_force_that_is_no_number_stops_the_run_with_a_name(spring, tmp_path, ranks):
    done = run(spring, tmp_path, model(spoil_at=2e-6), "--ranks", ranks, code=3)
    assert "the force of the observer spring (" in done.stderr and "on node 3 of part bar" in done.stderr, done.stderr
    assert "is not finite" in done.stderr


def test_a_force_on_a_copy_is_refused(spring, tmp_path):
    done = run(spring, tmp_path, model(ghosts=True), "--ranks", "2", code=3)
    assert "spring_to_point" in done.stderr and "which it does not own; expected owned nodes only" in done.stderr


READER = """
#include <stdexcept>
#include <kerf/observer.hpp>
struct Reader final : kerf::Observer {
  static void describe(kerf::Schema<Reader>&) {}
  kerf::ObserverCalls calls() const override {
    return {.before_forces = true, .after_forces = true, .after_step = true, .forces = true};
  }
  void before_forces(kerf::ObservedModel& m) override { before_ = read(m); }
  void add_forces(kerf::ObservedModel& m, kerf::ObservedForces&) override { last_ = read(m); }
  void after_forces(kerf::ObservedModel& m) override {
    if (m.cycle > 1 && read(m) == before_) throw std::runtime_error("the forces have changed no stress");
  }
  void after_step(kerf::ObservedModel& m) override {
    if (read(m) != last_) throw std::runtime_error("the stress has changed behind the forces");
    ++steps_;
  }
  kerf::ObserverReport report(kerf::ObservedModel&) override { return {{{"steps", double(steps_)}}, {}}; }

  /// Stress of all elements, and a velocity that has to be that of the node.
  static std::vector<double> read(kerf::ObservedModel& m) {
    for (int i = 0; i < m.nodes.n; ++i)
      if (m.node_field(i, "velocity").at(0) != m.nodes.v(i).x) throw std::runtime_error("another velocity");
    return m.field(0, "stress");
  }
  std::vector<double> before_, last_;
  int steps_ = 0;
};
KERF_OBSERVER(Reader, "reader", "reads fields wherever it is called")
"""


@pytest.mark.parametrize("ranks", [1, 2])
def test_fields_are_read_by_name_before_and_after_the_forces(tmp_path, ranks):
    (tmp_path / "reader.cpp").write_text(READER)
    version = call(KERF, "--version").stdout.split()[1]
    library = compile_library(tmp_path / "reader.cpp", tmp_path / "reader.so", f'-DKERF_VERSION="{version}"')
    case = model() | {"time": {"end": "1 us"}, "observers": {"all": {"type": "reader"}},
                      "boundaries": [{"type": "rigid_wall", "point": [0.012, 0, 0], "normal": [-1, 0, 0]}]}
    run(library, tmp_path, case, "--ranks", ranks)
    assert summary(tmp_path)["observers"]["all"]["steps"] == summary(tmp_path)["cycles"] > 5
