"""Balance policies of the input: when they move the mesh, the older keys, both together, and one that throws."""

import json

from plugin_case import KERF, call, compile_library

CASE = {"time": {"end": 2e-6, "maximum_step": "20 ns"},
        "materials": {"steel": {"density": 7850, "strength": {"type": "elastic", "shear_modulus": 80e9},
                                "eos": {"type": "linear", "bulk_modulus": 160e9}}},
        "parts": {"bar": {"mesh": {"type": "block", "size": [0.012, 0.002, 0.002], "cells": [12, 2, 2]},
                          "material": "steel", "velocity": [20, 0, 0]}}}

FAULTY = """
#include <kerf/balance_policy.hpp>
#include <stdexcept>
struct Faulty final : kerf::BalancePolicy {
  static void describe(kerf::Schema<Faulty>&) {}
  std::int64_t check_interval() const override { return asked_ ? 1 : 7; }  // asked once
  bool move(const kerf::BalanceState& now) override {
    asked_ = true;
    if (now.cycle >= 21) throw std::runtime_error("the moon stands badly");
    return false;
  }
  bool asked_ = false;
};
KERF_BALANCE_POLICY(Faulty, "faulty", "throws in cycle 21")
"""


def run(folder, balance, *options, ranks=3, code=0):
    (folder / "case.yaml").write_text(json.dumps(CASE | {"balance": balance}))
    done = call(KERF, "run", folder / "case.yaml", "--output", folder / "out", "--ranks", ranks, *options)
    assert done.returncode == code, done.stdout + done.stderr
    return done, json.loads((folder / "out" / "summary.json").read_text()) if code in (0, 3) else None


def moves(summary):
    return [r["cycle"] for r in summary["rebalances"] if r["cycle"] > 0]


def test_every_moves_at_its_interval_and_never_never_with_the_same_bits(tmp_path):
    _, every = run(tmp_path, {"policy": {"type": "every", "interval": 30}})
    assert moves(every) == list(range(30, every["cycles"] + 1, 30))
    _, never = run(tmp_path, {"policy": {"type": "never"}})
    assert moves(never) == []
    _, alone = run(tmp_path, {}, ranks=1)
    assert every["state_hash"] == never["state_hash"] == alone["state_hash"]


def test_the_older_keys_decide_as_the_policy_does(tmp_path):
    keys = {"threshold": 1.001, "check_interval": 10, "cooldown": 20, "cost_factor": 0.0}
    partitioner = {"partitioner": {"type": "none"}}  # whose ranges stay unequal
    _, older = run(tmp_path, partitioner | keys, ranks=5)
    _, newer = run(tmp_path, partitioner | {"policy": {"type": "threshold"} | keys}, ranks=5)
    assert moves(older) == moves(newer) != []


def test_keys_and_policy_together_are_an_error_of_the_input(tmp_path):
    done, _ = run(tmp_path, {"threshold": 1.1, "policy": {"type": "never"}}, code=2)
    assert "`threshold` belongs to a policy; expected it inside of `policy`, or no key `policy`" in done.stderr


def test_a_policy_that_throws_stops_the_run_on_all_ranks_with_its_place(tmp_path):
    source = tmp_path / "faulty.cpp"
    source.write_text(FAULTY)
    version = call(KERF, "--version").stdout.split()[1]
    library = compile_library(source, tmp_path / "faulty.so", f'-DKERF_VERSION="{version}"')
    done, summary = run(tmp_path, {"policy": {"type": "faulty"}}, "--plugin", library, code=3)
    assert "the balance policy faulty (" in done.stderr and "case.yaml:1:" in done.stderr
    assert "failed: the moon stands badly; at time" in done.stderr and "cycle 21" in done.stderr
    assert summary["exit"].startswith("the balance policy faulty")
