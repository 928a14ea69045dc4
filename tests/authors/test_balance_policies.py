"""Balance policies of the input: when they move the mesh, the older keys, both together, and one that throws."""

import csv
import json

import pytest
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


def eroding(**balance):
    """A rod that is used up at a wall: the ranks at its front lose elements."""
    erosion = {"criteria": [{"type": "plastic_strain", "limit": 0.15}]}
    steel = {"density": 7850, "eos": {"type": "linear", "bulk_modulus": 160e9}, "erosion": erosion,
             "strength": {"type": "elastic_plastic", "shear_modulus": 80e9, "yield_stress": 4e8,
                          "hardening_modulus": 1e9}}
    mesh = {"type": "block", "size": [0.004, 0.004, 0.024], "cells": [4, 4, 24]}
    return {"time": {"end": 1e-3, "maximum_cycles": 400}, "materials": {"steel": steel},
            "parts": {"rod": {"mesh": mesh, "material": "steel", "velocity": [0, 0, -600]}},
            "boundaries": [{"type": "rigid_wall", "point": [0, 0, 0], "normal": [0, 0, 1]}],
            "checks": {"energy_growth": 1.0e6}, "balance": balance}


def run_eroding(folder, balance, *options, ranks=3, cycles=400, code=0):
    model = eroding(**balance)
    model["time"]["maximum_cycles"] = cycles
    (folder / "rod.yaml").write_text(json.dumps(model))
    done = call(KERF, "run", folder / "rod.yaml", "--output", folder / "out", "--ranks", ranks, *options)
    assert done.returncode == code, done.stdout + done.stderr
    if code:
        return done.stderr, []
    with open(folder / "out" / "balance.csv", newline="", encoding="utf-8") as file:
        return json.loads((folder / "out" / "summary.json").read_text()), list(csv.DictReader(file))


WINDOWED = {"type": "threshold", "threshold": 1.02, "check_interval": 10, "window": 3, "cooldown": 40,
            "cost_factor": 0.1}


def moved_cycles(rows):
    return [int(r["cycle"]) for r in rows if r["decision"] in ("move", "forced")]


def test_every_decision_stands_in_the_table_with_the_numbers_that_it_follows_from(tmp_path):
    summary, rows = run_eroding(tmp_path, {"policy": WINDOWED})
    assert rows[0]["decision"] == "first"
    looks = rows[1:]
    assert [int(r["cycle"]) for r in looks] == list(range(10, summary["cycles"] + 1, 10))
    assert moved_cycles(rows) == moves(summary) != []
    window, last = [], 0
    for row in looks:
        cycle = int(row["cycle"])
        window = [*window, float(row["imbalance"])][-3:]
        mean = sum(window) / len(window)
        assert abs(float(row["mean_imbalance"]) - mean) < 1e-12
        saving, cost = (float(row[f"predicted_{what} [element cycles]"]) for what in ("saving", "cost"))
        reason = ("window not full" if len(window) < 3 else "below threshold" if not mean > 1.02 else
                  "cooldown" if cycle - last < 40 else "does not pay" if not saving > 0.1 * cost else "pays")
        assert row["reason"] == reason
        assert row["decision"] == ("move" if reason == "pays" else "stay")
        if reason == "pays":
            window, last = [], cycle
            assert int(row["elements_moved"]) > 0 and float(row["imbalance_after"]) < float(row["imbalance"])
        else:
            assert row["elements_moved"] == row["imbalance_after"] == ""
    assert {r["reason"] for r in looks} >= {"window not full", "pays", "cooldown"}


def test_replay_repeats_the_decisions_of_another_run_on_any_number_of_ranks(tmp_path):
    summary, rows = run_eroding(tmp_path, {"policy": WINDOWED})
    (tmp_path / "moves.csv").write_bytes((tmp_path / "out" / "balance.csv").read_bytes())
    again, replayed = run_eroding(tmp_path, {"policy": {"type": "replay", "file": "moves.csv"}})
    assert moved_cycles(replayed) == moved_cycles(rows) != []
    taken = ("cycle", "imbalance", "elements_moved", "imbalance_after")
    assert ([[r[k] for k in taken] for r in replayed if r["decision"] == "move"] ==
            [[r[k] for k in taken] for r in rows if r["decision"] == "move"])
    other, on_two = run_eroding(tmp_path, {"policy": {"type": "replay", "file": "moves.csv"}}, ranks=2)
    assert moved_cycles(on_two) == moved_cycles(rows)
    assert summary["state_hash"] == again["state_hash"] == other["state_hash"]


@pytest.mark.parametrize(("text", "message"), [
    ("time [s],cycle,decision\n1e-6,20,move\n2e-6,x,move\n", "moves.csv:3:1: error: \"x\" is no cycle; expected"),
    ("time [s],cycle,decision\n1e-6,20,perhaps\n", "moves.csv:2:1: error: \"perhaps\" is no decision; expected move"),
    ("time [s],cycle,decision\n1e-6,20\n", "moves.csv:2:1: error: the line has 2 fields; expected 3"),
    ("time [s],cycle\n1e-6,20\n", "moves.csv:1:1: error: there are no columns `cycle` and `decision`"),
    ("", "moves.csv:1:1: error: the file is empty"),
    ("time [s],cycle,decision\n1,20,move\n1,10,move\n", "moves.csv:1:1: error: the cycles do not ascend"),
    (None, "moves.csv\" cannot be read: No such file or directory; expected a balance.csv")])
def test_a_recording_that_cannot_be_repeated_is_an_error_with_its_place(tmp_path, text, message):
    if text is not None:
        (tmp_path / "moves.csv").write_text(text)
    stderr, _ = run_eroding(tmp_path, {"policy": {"type": "replay", "file": "moves.csv"}}, code=2)
    assert message in stderr


def test_a_resumed_run_goes_on_with_the_table_and_the_memory_of_its_policy(tmp_path):
    whole, _ = run_eroding(tmp_path, {"policy": WINDOWED})
    first, before = run_eroding(tmp_path, {"policy": WINDOWED}, cycles=195)
    after, rows = run_eroding(tmp_path, {"policy": WINDOWED}, "--resume")
    assert whole["state_hash"] == after["state_hash"]
    assert rows[:len(before)] == before and first["cycles"] == 195
    assert [r["decision"] for r in rows].count("first") == 1
    assert (rows[len(before)]["decision"], rows[len(before)]["cycle"]) == ("resumed", "195")
    looks = [int(r["cycle"]) for r in rows if r["decision"] in ("move", "stay")]
    assert looks == list(range(10, after["cycles"] + 1, 10))
    # The window goes on: looks of before the restart are in the first mean after it. No move has emptied it since.
    at = next(k for k, r in enumerate(rows) if r["cycle"] == "200")
    looked = [r for r in rows[:at + 1] if r["decision"] in ("stay", "move")][-3:]
    assert [(r["cycle"], r["decision"]) for r in looked[:2]] == [("180", "stay"), ("190", "stay")]
    mean = sum(float(r["imbalance"]) for r in looked) / 3.0
    assert abs(float(rows[at]["mean_imbalance"]) - mean) < 1e-12
