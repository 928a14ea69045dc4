"""A run that goes wrong, is stopped or is killed says where and when, and leaves results that can be read."""

import os
import re
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest
from vtkmodules.vtkIOHDF import vtkHDFReader

from input_case import GOOD, KERF, kerf, on_ranks, settings, spoiled, summary_of

# Without erosion, so that nothing saves an element that goes wrong.
PLAIN = spoiled([(GOOD[GOOD.index("    erosion:"):GOOD.index("\nparts:")], "")])

# What makes a run fail: (settings, message; NODE and ELEMENT stand for "node 7 of part rod").
FAILURES = {
    "inverted element": (  # the upper face is driven through the lower one
        {"contacts": "[]", "sets": "{bottom: {parts: target, face: z_min}, top: {parts: target, face: z_max}}",
         "boundaries": "[{type: fixed, nodes: bottom}, {type: prescribed_motion, nodes: top, components: z, "
                       "velocity: 0 0 -20000 m/s}]", "checks.energy_growth": "1.0e+12",
         "parts.target.element": "{type: hex8, linear_viscosity: 0, quadratic_viscosity: 0}"},
        r"ELEMENT is inverted \(its volume is not positive\); give its material the erosion criterion inversion, "
        r"refine the mesh, or use more hourglass control; at TIME"),
    "stress that is no number": (
        {"materials.copper.eos": "{type: linear_polynomial, C1: 130 GPa, C2: 1.0e+300, C3: 1.0e+300}"},
        r"the forces of ELEMENT are not finite or beyond all bounds at TIME"),
    "speed beyond all bounds": (
        {"parameters.speed": "0 0 -1.0e+100 m/s"},
        r"NODE moves at \S+ m/s, faster than 4.58e\+05 m/s, which is a hundred times .* meant at TIME"),
    "energy balance that is off": (
        {"checks.energy_growth": "1.0e-6"},
        r"the energy balance is off by \d+\.\d\d %, more than checks.energy_growth of 0.00 %, at TIME; the highest "
        r"energy per mass, \S+ J/kg, is in ELEMENT"),
    "contact that lets go": (
        {"parameters.speed": "0 0 -50000 m/s", "time.growth": "10", "checks.let_go": "0",
         "checks.energy_growth": "1.0e+12"},
        r"contact has let go of \d+ nodes, which came to lie up to \S+ m inside a body, with more than checks.let_go "
        r"\(0\) of the mass of the model, the first at time \S+ s; refine the mesh where bodies meet, or lower "
        r"time.safety_factor; at TIME"),
    "time step that collapses": (
        {"time.minimum_step": "150 ns"},
        r"the stable time step of ELEMENT is \S+ s \(times safety_factor 0.9\), below the minimum of 1.5e-07 s; give "
        r"its material the erosion criterion minimum_time_step or lower time.minimum_step; at TIME"),
    "node that is too fast": (
        {"checks.maximum_speed": "100 m/s"},
        r"NODE moves at 200 m/s, faster than 100 m/s, which is checks.maximum_speed at TIME"),
}


def pattern(message):
    return (message.replace("ELEMENT", r"element \d+ of part (target|striker)")
            .replace("NODE", r"node \d+ of part (target|striker)")
            .replace("TIME", r"time \S+ s, cycle \d+"))


def frames(folder):
    """Times of the frames, after a look at every one with the reader that ParaView uses."""
    path = str(folder / "results.vtkhdf")
    reader = vtkHDFReader()
    assert reader.CanReadFile(path)
    reader.SetFileName(path)
    reader.UpdateInformation()
    with h5py.File(path) as file:
        times = file["VTKHDF/Steps/Values"][()]
        assert file["VTKHDF/Steps"].attrs["NSteps"] == len(times)
    assert reader.GetNumberOfSteps() == len(times)
    for step in range(len(times)):
        reader.SetStep(step)
        reader.Update()
        grid = reader.GetOutput()
        assert grid.GetNumberOfCells() > 0 and grid.GetCellData().GetArray("pressure").GetNumberOfTuples() > 0
    return times


@pytest.fixture
def case(tmp_path):
    (tmp_path / "case.yaml").write_text(PLAIN)
    return tmp_path


@pytest.mark.parametrize("name", FAILURES, ids=lambda name: name.replace(" ", "_"))
def test_stops_on_all_ranks_and_says_where(name, case):
    """Exit code 3; the same words on any number of ranks."""
    changes, message = FAILURES[name]
    said = []
    for ranks in (1, 2):
        done = kerf("run", "case.yaml", "--output", f"out{ranks}", *on_ranks(ranks), *settings(changes), cwd=case)
        assert done.returncode == 3, done.stdout + done.stderr
        found = re.fullmatch(r"case.yaml: error: the run stopped: (.*)\n", done.stderr)
        assert found and re.fullmatch(pattern(message), found[1]), done.stderr
        summary = summary_of(case / f"out{ranks}")
        assert summary["exit"] == found[1] and summary["ranks"] == ranks
        times = frames(case / f"out{ranks}")
        assert len(times) >= 2 and times[0] == 0.0, "the start and the end are there"
        stopped = float(re.search(r"time (\S+) s, cycle", found[1])[1])
        assert times[-1] == pytest.approx(stopped, rel=1e-5), "the last frame shows the failure"
        rows = (case / f"out{ranks}" / "history.csv").read_text().splitlines()
        assert float(rows[-1].split(",")[0]) == pytest.approx(stopped, rel=1e-5)
        said.append(found[1])
    assert said[0] == said[1]


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_step_that_is_too_small_from_the_start(command, case):
    done = kerf(command, "case.yaml", "--set", "time.minimum_step=1 us", cwd=case)
    assert done.returncode == 3
    found = re.fullmatch(r"case.yaml: error: the run cannot start: (.*)\n", done.stderr)
    assert found and re.fullmatch(pattern(FAILURES["time step that collapses"][1]).replace("1.5e-07", "1e-06"),
                                  found[1]), done.stderr


# ---- Stopping and killing: a finer mesh, so that there is time for it.
LONG = {"time.end": "6 us", "parts.target.mesh.cells": "[20, 20, 10]", "parts.striker.mesh.cells": "[10, 10, 10]",
        "output.results_interval": "0.2 us", "output.progress_interval": "10",
        "balance.force_interval": "25"}  # migration, too, must not matter


def start(folder, ranks, changes, output="out"):
    """A run of LONG that has shown at least three progress lines, in a process group of its own."""
    words = [KERF, "run", "case.yaml", "--output", output, *map(str, on_ranks(ranks)), *settings(changes)]
    process = subprocess.Popen(words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               start_new_session=True)
    seen = 0
    while seen < 3:
        line = process.stdout.readline()
        assert line, process.stderr.read()
        seen += line.startswith("cycle ")
    return process


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    folder = tmp_path_factory.mktemp("uninterrupted")
    (folder / "case.yaml").write_text(PLAIN)
    done = kerf("run", "case.yaml", "--output", "out", *settings(LONG), cwd=folder)
    assert done.returncode == 0, done.stderr
    return folder


def columns(folder):
    return np.genfromtxt(folder / "history.csv", delimiter=",", skip_header=1)


@pytest.mark.parametrize("ranks, later", [(1, 2), (2, 3), (2, 1)])
def test_a_stopped_run_goes_on_to_the_same_bits(ranks, later, case, uninterrupted):
    process = start(case, ranks, LONG)
    process.send_signal(signal.SIGTERM)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 4, out + err
    assert err.startswith("stopped by a signal; go on with: kerf run case.yaml --output out --resume --set ")
    first = summary_of(case / "out")
    assert first["exit"] == "signal" and 0.0 < first["end_time"] < 6.0e-6
    assert frames(case / "out")[-1] == pytest.approx(first["end_time"], rel=1e-12)

    done = kerf("run", "case.yaml", "--output", "out", "--resume", *on_ranks(later), *settings(LONG), cwd=case)
    assert done.returncode == 0, done.stderr
    summary, whole = summary_of(case / "out"), summary_of(uninterrupted / "out")
    assert summary["exit"] == "completed"
    assert summary["state_hash"] == whole["state_hash"]
    assert summary["cycles"] == whole["cycles"]
    assert summary["energy"] == whole["energy"]
    # The files go on as if nothing had been: a frame and a row for the stop may have come on top.
    expected = frames(uninterrupted / "out")
    assert set(np.round(expected, 15)) <= set(np.round(frames(case / "out"), 15))
    here, there = columns(case / "out"), columns(uninterrupted / "out")
    assert np.all(np.diff(here[:, 0]) > 0.0)
    kept = here[np.isin(here[:, 0], there[:, 0])]
    assert len(kept) == len(there)
    names = (uninterrupted / "out" / "history.csv").read_text().splitlines()[0].split(",")
    same = [i for i, name in enumerate(names) if not name.startswith("imbalance")]  # which is that of the ranks
    np.testing.assert_array_equal(kept[:, same], there[:, same])


def test_a_run_that_mpirun_was_asked_to_stop(case):
    """`kerf run --ranks` passes on the interrupt key as well."""
    process = start(case, 2, LONG)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 4, err
    assert (case / "out" / "restart" / "restart.h5").exists()


def descendants(pid):
    """A process and all that it started."""
    text = subprocess.run(["ps", "-e", "-o", "pid=,ppid="], capture_output=True, text=True).stdout
    parents = [tuple(map(int, line.split())) for line in text.splitlines()]
    found = [pid]
    for p in found:
        found += [child for child, parent in parents if parent == p]
    return found


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_killed_run_leaves_results_that_can_be_read(ranks, case):
    process = start(case, ranks, LONG)
    for pid in descendants(process.pid):
        os.kill(pid, signal.SIGKILL)
    process.communicate(timeout=60)
    assert process.returncode == -signal.SIGKILL
    times = frames(case / "out")
    assert len(times) >= 1 and times[0] == 0.0 and np.all(np.diff(times) > 0.0)
    assert len(columns(case / "out")) >= 2
    assert not (case / "out" / "summary.json").exists()
    # There is nothing to go on from, and the program says so.
    done = kerf("run", "case.yaml", "--output", "out", "--resume", *settings(LONG), cwd=case)
    assert done.returncode == 2 and "there is no restart file to resume from" in done.stderr


def test_a_killed_run_goes_on_from_its_last_restart_file(case, uninterrupted):
    process = start(case, 1, LONG | {"output.restart_interval": "0.1 us"})
    while not (case / "out" / "restart" / "restart.h5").exists():
        time.sleep(0.02)
    process.kill()
    process.communicate(timeout=60)
    done = kerf("run", "case.yaml", "--output", "out", "--resume", *settings(LONG), cwd=case)
    assert done.returncode == 0, done.stderr
    assert summary_of(case / "out")["state_hash"] == summary_of(uninterrupted / "out")["state_hash"]
    frames(case / "out")


def test_a_run_that_has_ended_can_be_prolonged(case, uninterrupted):
    """After time.end and after time.maximum_cycles, unless the input asks for no restart file at the end."""
    few = settings(LONG | {"time.maximum_cycles": 20})
    unwanted = kerf("run", "case.yaml", "--output", "out", *few, "--set", "output.restart_at_end=false", cwd=case)
    assert unwanted.returncode == 0 and not (case / "out" / "restart" / "restart.h5").exists()
    assert kerf("run", "case.yaml", "--output", "out", *few, cwd=case).returncode == 0
    before = list(frames(case / "out")), columns(case / "out")[:, 0].tolist()
    for ranks in (1, 2):
        nothing = kerf("run", "case.yaml", "--output", "out", "--resume", *on_ranks(ranks), *few, cwd=case)
        assert nothing.returncode == 0 and summary_of(case / "out")["cycles"] == 20
        assert "has come to time.maximum_cycles (20) already; no cycle is left to make; raise it" in nothing.stdout
        # Nothing that is there is written again.
        assert (list(frames(case / "out")), columns(case / "out")[:, 0].tolist()) == before
    done = kerf("run", "case.yaml", "--output", "out", "--resume", *settings(LONG), cwd=case)
    assert done.returncode == 0, done.stderr
    assert summary_of(case / "out")["state_hash"] == summary_of(uninterrupted / "out")["state_hash"]
    assert (np.diff(frames(case / "out")) > 0.0).all() and (np.diff(columns(case / "out")[:, 0]) > 0.0).all()


def test_a_run_that_has_come_to_its_end_has_nothing_to_resume(case):
    ends = settings(LONG | {"time.end": "0.2 us", "output.restart_interval": "0.2 us"})
    assert kerf("run", "case.yaml", "--output", "out", *ends, cwd=case).returncode == 0
    before = list(frames(case / "out")), columns(case / "out")[:, 0].tolist()
    done = kerf("run", "case.yaml", "--output", "out", "--resume", *ends, cwd=case)
    assert done.returncode == 0, done.stderr
    assert "has come to time.end (2e-07 s) already; no cycle is left to make" in done.stdout
    assert (list(frames(case / "out")), columns(case / "out")[:, 0].tolist()) == before
    longer = settings(LONG | {"time.end": "0.4 us"})
    done = kerf("run", "case.yaml", "--output", "out", "--resume", *longer, cwd=case)
    assert done.returncode == 0 and summary_of(case / "out")["end_time"] == pytest.approx(0.4e-6, rel=1e-9)
    assert list(frames(case / "out"))[:len(before[0])] == before[0]


@pytest.mark.parametrize("ranks, setting, says", [
    (1, "output.element_fields=[stress, pressure]", "expected output.element_fields to be ["),
    (2, "output.node_fields=[velocity, mass]", "expected output.node_fields to be [velocity]"),
    (1, "output.precision=double", "expected output.precision to be [single]")])
def test_a_resumed_run_cannot_write_other_fields(case, ranks, setting, says):
    few = settings(LONG | {"time.maximum_cycles": 20, "output.restart_interval": "1 s"})
    assert kerf("run", "case.yaml", "--output", "out", *few, cwd=case).returncode == 0
    before = list(frames(case / "out"))
    done = kerf("run", "case.yaml", "--output", "out", "--resume", *on_ranks(ranks), *settings(LONG), "--set", setting,
                cwd=case)
    assert done.returncode == 2
    assert done.stderr.count("error: the run that is resumed has begun it in another way; " + says) == 1
    assert list(frames(case / "out")) == before


def cycle_of(restart):
    """The cycle in which a restart file was written, or None where there is no file."""
    if not restart.exists():
        return None
    with h5py.File(restart) as file:
        return int(file["attributes/counters"][0])


@pytest.mark.parametrize("key", ["results_interval", "history_interval", "restart_interval"])
def test_an_interval_shorter_than_any_cycle_is_every_cycle(case, key):
    few = settings(LONG | {"time.maximum_cycles": 5, f"output.{key}": "1e-30", "output.restart_at_end": "false"})
    done = kerf("run", "case.yaml", "--output", "out", *few, cwd=case)
    assert done.returncode == 0, done.stderr
    if key == "results_interval":
        assert len(frames(case / "out")) == 6
    if key == "history_interval":
        assert len(columns(case / "out")) == 6
    cycles = [cycle_of(case / "out" / "restart" / name) for name in ("restart.h5", "restart_previous.h5")]
    assert cycles == ([5, 4] if key == "restart_interval" else [None, None])


def test_ranks_do_not_outlive_the_command_that_started_them(case):
    process = start(case, 2, LONG | {"time.end": "1 s"})
    children = descendants(process.pid)[1:]
    assert len(children) >= 3, "mpirun and two ranks"
    process.kill()
    process.communicate(timeout=60)
    for _ in range(200):
        left = [pid for pid in children if os.path.exists(f"/proc/{pid}")]
        if not left:
            break
        time.sleep(0.1)
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    assert not left
    assert summary_of(case / "out")["exit"] == "signal", "they stopped in good order"


def test_a_restart_file_of_another_model_is_refused(case):
    process = start(case, 1, LONG)
    process.terminate()
    process.communicate(timeout=60)
    done = kerf("run", "case.yaml", "--output", "out", "--resume", "--set", "parts.striker.mesh.origin=1 1 2.2 mm",
                *settings(LONG), cwd=case)
    assert done.returncode == 2
    assert done.stderr == ("out/restart/restart.h5: error: this restart file belongs to another model; resume with the "
                           "input that wrote it (precision, materials, parts, joined, sets, initial_state, "
                           "boundaries, loads, curves with their files, contacts, checks, and time but for its end, "
                           "must be the same)\n")
    assert summary_of(case / "out")["exit"] == "signal", "what was there is left alone"


def test_a_new_run_does_not_leave_an_older_restart_file_to_be_resumed(case):
    process = start(case, 1, LONG)
    process.terminate()
    process.communicate(timeout=60)
    done = kerf("run", "case.yaml", "--output", "out", "--set", "output.restart_at_end=false", cwd=case)
    assert done.returncode == 0
    assert not (case / "out" / "restart" / "restart.h5").exists()
    assert (case / "out" / "restart" / "earlier_run.h5").exists()
