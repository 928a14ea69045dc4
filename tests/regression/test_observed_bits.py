"""Columns of observers have the same bits on any number of ranks and through restart, and observers change nothing."""

import json
import os
import shutil
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest

from test_load_hashes import PLATE
from test_state_hash import KERF, OFTEN, ROD, run

# A gauge whose element erodes, one that things pass by, one on a node; contact and a plane of symmetry.
OBSERVERS = [
    "observers.parts={type: part_history}",
    'observers.tip={type: gauge, part: rod, point: "[26, 0.5, 2] mm", quantities: [pressure, stress, density]}',
    'observers.here={type: gauge, part: plate, motion: fixed, point: "[27.6, 0.5, -2] mm", quantities: [von_mises]}',
    'observers.node={type: gauge, at: node, part: plate, point: "[27.6, 0.5, -2] mm", quantities: [velocity]}',
    "observers.contact={type: contact_forces, interval: 0.5 us}",
    "observers.planes={type: reactions, interval: 1 us}"]
SETTINGS = OFTEN + OBSERVERS + ["output.history_interval=0.25 us"]
# A second definition: forces of each have to be kept apart, in restart files too.
TWO_CONTACTS = ["contacts=[{type: eroding_surface, friction: 0.1}, {type: slide_surface, slave: rod, master: plate}]"]


def columns(folder):
    """{"tip/pressure": values}"""
    found = {}
    with h5py.File(folder / "history.h5") as file:
        file.visititems(lambda name, item: found.update({name: item[()]} if isinstance(item, h5py.Dataset) else {}))
    return found


def expect_same_columns(ours, theirs):
    assert ours.keys() == theirs.keys()
    differing = [name for name in ours if ours[name].tobytes() != theirs[name].tobytes()]
    assert differing == []


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    folder = tmp_path_factory.mktemp("observed")
    return folder, run(ROD, folder, settings=SETTINGS)


@pytest.mark.parametrize("ranks, partitioner", [(2, "zoltan_rcb"), (3, "zoltan_hsfc"), (5, "none")])
def test_columns_have_the_same_bits_on_any_number_of_ranks(reference, tmp_path, ranks, partitioner):
    folder, results = reference
    again = run(ROD, tmp_path, ranks, SETTINGS + [f"balance.partitioner={{type: {partitioner}}}"])
    assert len(again.summary["rebalances"]) > 5 or partitioner == "none"
    expect_same_columns(columns(tmp_path), columns(folder))
    assert again.summary["observers"] == results.summary["observers"]


def test_observers_change_nothing(reference, tmp_path):
    plain = run(ROD, tmp_path, settings=OFTEN)
    assert not (tmp_path / "history.h5").exists()
    assert plain.summary["state_hash"] == reference[1].summary["state_hash"]
    assert plain.summary["observers"] == {}


def test_parts_add_up_to_the_ledger(reference):
    folder, results = reference
    c = columns(folder)
    names = results.history[0]
    history = dict(zip((name.split(" ")[0] for name in names), np.array(results.history[1:], dtype=float).T))
    assert np.array_equal(c["parts/time"], history["time"])
    # Sums of the parts' sums are rounded once more, and energies per mass twice: some units in the last place.
    for name, scale in (("kinetic", "kinetic"), ("internal", "kinetic"), ("momentum_x", "momentum_x"),
                        ("momentum_y", "momentum_x"), ("momentum_z", "momentum_z")):
        total = c[f"parts/rod.{name}"] + c[f"parts/plate.{name}"]
        assert np.abs(total - history[name]).max() < 1e-13 * np.abs(history[scale]).max(), name
    assert np.array_equal(c["parts/rod.eroded_elements"] + c["parts/plate.eroded_elements"], history["eroded_count"])
    assert c["parts/rod.eroded_elements"][-1] == results.summary["eroded"]["by_part"]["rod"] > 0
    lost = results.summary["measures"]
    assert c["parts/rod.eroded_mass"][-1] == pytest.approx(lost["rod_lost"], rel=1e-12)
    assert c["parts/rod.velocity_z"][-1] == pytest.approx(results.summary["parts"]["rod"]["velocity"][2], rel=1e-14)


def test_contact_and_reactions_explain_the_momentum_of_the_plate(reference):
    """What the plate has of momentum came through contact and the plane of symmetry; there is nothing else."""
    c = columns(reference[0])
    at = np.searchsorted(c["parts/time"], c["planes/time"])
    assert np.array_equal(c["parts/time"][at], c["planes/time"])  # rows of 1 us are rows of 0.25 us, too
    contact = np.isin(c["contact/time"], c["planes/time"])
    gained = {d: c[f"contact/eroding_surface_1.plate.impulse_{d}"][contact] for d in "xyz"}
    scale = np.abs(c["parts/plate.momentum_z"]).max()
    # Impulses are counted in quanta of 2^-51 of the model's momentum, one for every node and step.
    for d in "xz":
        assert np.abs(gained[d] - c[f"parts/plate.momentum_{d}"][at]).max() < 1e-9 * scale, d
    both = c["parts/plate.momentum_y"][at] + c["parts/rod.momentum_y"][at]
    assert np.abs(c["planes/symmetry_1.impulse_y"] - both).max() < 1e-9 * scale
    rows = c["planes/symmetry_1.force_y"][1:] * np.diff(c["planes/time"])
    assert np.allclose(np.cumsum(rows), c["planes/symmetry_1.impulse_y"][1:], rtol=1e-12)


def test_work_of_contact_is_that_of_the_ledger(reference):
    folder, results = reference
    c = columns(folder)
    names = [name.split(" ")[0] for name in results.history[0]]
    history = np.array(results.history[1:], dtype=float)
    at = np.isin(history[:, 0], c["contact/time"])
    assert np.array_equal(c["contact/eroding_surface_1.work"], history[at, names.index("contact")])


def test_forces_of_a_definition_add_up_to_zero(reference):
    c = columns(reference[0])
    for d in "xyz":
        force = c[f"contact/eroding_surface_1.rod.force_{d}"]
        assert np.abs(force).max() > 1e4
        assert np.array_equal(force, -c[f"contact/eroding_surface_1.plate.force_{d}"])


def test_a_gauge_is_nan_from_the_erosion_of_its_element_on(reference):
    folder, results = reference
    c = columns(folder)
    element = int(c["tip/id"][0])
    lines = [line.split(",") for line in results.erosion.decode().splitlines()]
    eroded = next(float(line[0]) for line in lines[1:] if int(line[lines[0].index("element")]) == element)
    gone = c["tip/time"] >= eroded
    assert 0 < gone.sum() < len(gone)
    for name in c:
        if name.startswith("tip/") and name != "tip/time":
            assert np.isnan(c[name][gone]).all() and np.isfinite(c[name][~gone]).all(), name
    report = results.summary["observers"]["tip"]
    assert report == {"rows_without_value": gone.sum(), "first_row_without_value": c["tip/time"][gone][0]}
    assert any("the gauge `tip` has no value in" in line and "eroded" in line for line in results.summary["warnings"])


def test_a_fixed_gauge_sees_what_passes(reference):
    c = columns(reference[0])
    seen = c["here/id"][np.isfinite(c["here/id"])]
    assert len(set(seen)) > 1


@pytest.mark.parametrize("ranks, more", [(1, []), (3, []), (1, TWO_CONTACTS), (2, TWO_CONTACTS)],
                         ids=["1", "3", "two_contacts_1", "two_contacts_2"])
def test_a_resumed_run_goes_on_with_the_same_bits(tmp_path, ranks, more):
    settings = SETTINGS + more + ["output.restart_interval=5 us", "output.restart_at_end=false"]
    run(ROD, tmp_path / "whole", settings=settings)
    shutil.copytree(tmp_path / "whole", tmp_path / "resumed")
    before = columns(tmp_path / "whole")
    again = run(ROD, tmp_path / "resumed", ranks, settings, resume=True)
    expect_same_columns(columns(tmp_path / "resumed"), before)
    assert again.summary["observers"]["tip"]["rows_without_value"] > 0
    if more:
        assert np.abs(before["contact/slide_surface_2.work"]).max() > 0.0


def test_joined_parts_under_loads_are_seen_with_the_same_bits(tmp_path):
    """A plate of two joined parts, which erodes under a pressure: one rank, three ranks, and two after a restart."""
    cap = {"material": "metal",
           "mesh": {"type": "block", "size": "[12, 10, 2] mm", "origin": "[0, 0, 3] mm", "cells": [12, 10, 2]}}
    middle = {"parts": "cap", "box": "[2.9, 2.9, 4.9, 9.1, 7.1, 5.1] mm"}
    node = {"type": "gauge", "at": "node", "part": "cap", "point": "6 5 3 mm", "quantities": ["velocity"]}
    model = PLATE | {
        "parts": PLATE["parts"] | {"cap": cap}, "joined": [{"parts": ["plate", "cap"]}],
        "sets": PLATE["sets"] | {"middle": middle},
        "observers": {"parts": {"type": "part_history"}, "contact": {"type": "contact_forces"}, "node": node,
                      "walls": {"type": "reactions"},
                      "cut": {"type": "section_force", "part": "drop", "point": "0 0 -1.1 mm", "normal": [0, 0, 1]}},
        "output": PLATE["output"] | {"restart_interval": "4 us", "restart_at_end": False}}
    case = [tmp_path / "case.yaml"]
    case[0].write_text(json.dumps(model))
    results = run(case, tmp_path / "one")
    one = columns(tmp_path / "one")
    run(case, tmp_path / "three", 3)
    expect_same_columns(columns(tmp_path / "three"), one)
    run(case, tmp_path / "one", 2, resume=True)
    expect_same_columns(columns(tmp_path / "one"), one)
    history = dict(zip((name.split(" ")[0] for name in results.history[0]),
                       np.array(results.history[1:], dtype=float).T))
    assert one["parts/cap.eroded_elements"][-1] > 0 and np.abs(one["parts/cap.kinetic"]).max() > 0.0
    for name in ("kinetic", "internal", "momentum_x", "momentum_z"):
        total = sum(one[f"parts/{part}.{name}"] for part in model["parts"])
        # Shares of nodes and sums of parts are rounded once more: some units in the last place.
        assert np.abs(total - history[name]).max() < 1e-13 * np.abs(history[name]).max(), name


def test_a_run_cannot_be_resumed_with_other_observers(tmp_path):
    settings = SETTINGS + ["output.restart_interval=5 us"]
    run(ROD, tmp_path, settings=settings)
    before = (tmp_path / "history.h5").read_bytes()
    for change, says in ((["observers.more={type: part_history}"], "the run had no observer `more`"),
                         (["observers.parts.parts=[rod]"], "has other columns than the observers of this run fill")):
        command = [str(KERF), "run", str(ROD[0]), "--output", str(tmp_path), "--resume"]
        for setting in [*ROD[1:], *settings, *change]:
            command += ["--set", setting]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
        assert done.returncode != 0
        assert says in done.stderr
    assert (tmp_path / "history.h5").read_bytes() == before


@pytest.mark.parametrize("delay", [0.3, 1.3, 2.2])
def test_a_killed_run_leaves_columns_that_can_be_read(tmp_path, delay):
    command = [str(KERF), "run", str(ROD[0]), "--output", str(tmp_path)]
    for setting in [*ROD[1:], *OBSERVERS, "time.end=60 us", "parameters.cell_size=1.3 mm",
                    "output.history_interval=1 ns"]:
        command += ["--set", setting]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               env=dict(os.environ, OMPI_MCA_mpi_yield_when_idle="1"))
    for _ in range(200):
        if (tmp_path / "history.h5").exists():
            break
        time.sleep(0.05)
    time.sleep(delay)
    process.send_signal(signal.SIGKILL)
    process.wait()
    found = columns(tmp_path)
    for name, values in found.items():
        times = found[name.split("/")[0] + "/time"]
        assert len(values) == len(times)
    if delay > 2.0:
        assert len(found["parts/time"]) > 10
    assert np.all(np.diff(found["parts/time"]) > 0.0)
