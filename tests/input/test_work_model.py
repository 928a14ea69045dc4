"""The work model of an input: costs from a file, mistakes of the file, contact that goes with the elements."""

import csv
import json

import pytest
from input_case import kerf

FILE = """format: 1
kerf_version: "0.2.0"
machine: "a test"
date: "2026-11-28"
element_cycle: 100 ns
other_element: 50 ns
other_law: 5 ns
other_eos: 0 s
erosion: 10 ns
eroded_element: 1 us
elements: {hex8: {seconds: 50 ns}}
laws: {elastic: {seconds: 50 ns}, elastic_plastic: {seconds: 250 ns}}
eos: {}
contact: {node: 300 ns, candidate: 20 ns}
rebalance: {fixed: 1 ms, element: 1 us, moved_element: 2 us}
"""
ELASTIC = {"type": "elastic", "shear_modulus": 80e9}
PLASTIC = {"type": "elastic_plastic", "shear_modulus": 80e9, "yield_stress": 4e8, "hardening_modulus": 1e9}


def case(gap=0.001, speed=0.0, **more):
    """Two equal blocks of unlike materials; the first moves to the second."""
    eos = {"type": "linear", "bulk_modulus": 160e9}
    return {"time": {"end": 1e-3, "maximum_cycles": 60},
            "materials": {"a": {"density": 7850, "strength": ELASTIC, "eos": eos},
                          "b": {"density": 7850, "strength": PLASTIC, "eos": eos}},
            "parts": {"first": {"material": "a", "velocity": [speed, 0, 0],
                                "mesh": {"type": "block", "size": [0.008, 0.004, 0.004], "cells": [8, 4, 4]}},
                      "second": {"material": "b", "mesh": {"type": "block", "origin": [0.008 + gap, 0, 0],
                                                           "size": [0.008, 0.004, 0.004], "cells": [8, 4, 4]}}},
            "output": {"restart_at_end": False}, **more}


def run(folder, model, *options, ranks=2, code=0):
    (folder / "case.yaml").write_text(json.dumps(model))
    done = kerf("run", folder / "case.yaml", "--output", folder / "out", "--ranks", ranks, *options)
    assert done.returncode == code, done.stdout + done.stderr
    if code != 0:
        return done.stderr
    with open(folder / "out" / "balance.csv", newline="", encoding="utf-8") as file:
        return json.loads((folder / "out" / "summary.json").read_text()), list(csv.DictReader(file))


def test_costs_of_laws_from_a_file_decide_what_is_balanced(tmp_path):
    (tmp_path / "work.yaml").write_text(FILE)
    balance = {"partitioner": {"type": "none"}, "work_model": "work.yaml", "policy": {"type": "never"}}
    _, rows = run(tmp_path, case(balance=balance))
    # A rank has the elements of one part: 1 against 3 element cycles each.
    assert [r["decision"] for r in rows] == ["first"]
    assert float(rows[0]["imbalance_after"]) == pytest.approx(1.5)
    del balance["work_model"]
    _, rows = run(tmp_path, case(balance=balance))
    assert float(rows[0]["imbalance_after"]) == 1.0  # both laws declare the same cost


def test_a_file_named_on_the_command_line_is_relative_to_the_present_folder(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "work.yaml").write_text(FILE)
    stderr = run(tmp_path / "sub", case(balance={"work_model": "work.yaml"}), code=2)
    assert "sub/work.yaml\" cannot be read" in stderr and "case.yaml:1:" in stderr
    run(tmp_path / "sub", case(), "--set", f"balance.work_model={tmp_path / 'work.yaml'}")


MISTAKES = [
    ("elastic_plastic: {seconds", "elastic_plastik: {seconds",
     "work.yaml:12:35: error: there is no type `elastic_plastik`; did you mean `elastic_plastic`?"),
    ("other_eos: 0 s\n", "", "work.yaml:1:1: error: the required key `other_eos` is missing"),
    ("element_cycle: 100 ns", "element_cycle: 0 ns", "work.yaml:5:16: error: `element_cycle`"),
    ("erosion: 10 ns", "erosion: 10 m", "work.yaml:9:10: error: "),
    ("format: 1", "format: 2", "work.yaml:1:9: error: `format`"),
    ("candidate: 20 ns", "candidate: -1 ns", "work.yaml:14:36: error: `candidate`"),
    ("machine:", "macine:", "work.yaml:3:1: error: unknown key `macine`"),
]


@pytest.mark.parametrize(("right", "wrong", "message"), MISTAKES)
def test_mistakes_of_the_file_have_their_place(tmp_path, right, wrong, message):
    assert right in FILE
    (tmp_path / "work.yaml").write_text(FILE.replace(right, wrong))
    stderr = run(tmp_path, case(balance={"work_model": "work.yaml"}), code=2)
    assert message in stderr


def test_contact_with_the_elements_weighs_them_and_leaves_the_bits(tmp_path):
    (tmp_path / "work.yaml").write_text(FILE)
    contacts = {"contacts": [{"type": "eroding_surface"}]}
    balance = {"work_model": "work.yaml", "policy": {"type": "every", "interval": 20}}
    own, rows_own = run(tmp_path, case(1e-5, 300.0, balance=balance, **contacts))
    with_elements, rows = run(tmp_path, case(1e-5, 300.0, balance=balance | {"contact_work": "with_elements"},
                                             **contacts))
    alone, _ = run(tmp_path, case(1e-5, 300.0, **contacts), ranks=1)
    assert own["state_hash"] == with_elements["state_hash"] == alone["state_hash"]
    assert own["work"]["contact_touches"] > 0
    # Other elements move where contact counts, and it is balanced to what one element may be too much.
    assert [r["elements_moved"] for r in rows] != [r["elements_moved"] for r in rows_own]
    assert float(rows[-1]["imbalance_after"]) < 1.15


def test_another_word_for_the_work_of_contact_is_an_error(tmp_path):
    stderr = run(tmp_path, case(balance={"contact_work": "with_element"}), code=2)
    assert "`contact_work`" in stderr and "with_elements" in stderr
