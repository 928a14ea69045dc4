"""What a run records: the same on any number of ranks and through restart, in agreement with its summary, and whole
whatever ends the run."""

import csv
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from predict_scenes import STUDIES  # noqa: F401  puts the studies into the path

import prediction
from loggp import Link, Network
from message_counts import by_cycle, read_ranks
from recording import RecordingError, read_recording

HERE = Path(__file__).resolve().parent
KERF = os.environ.get("KERF_BINARY", str(HERE.parents[1] / "build" / "bin" / "kerf"))
LIBRARY = Path(os.environ.get("KERF_BUILD_DIR", "")) / "lib" / "libkerf_message_counts.so"
CASE = HERE / "recorded_impact.yaml"
OFTEN = ["balance.policy={type: every, interval: 8}"]
STOPS = ["output.restart_interval=3.3 us", "output.restart_at_end=true"]
LONG = ["time.end=1 ms", "output.recording_interval=0.2 us", "output.results_interval=1 ms"]
STEADY = ["parts.striker.velocity=0 0 -200 m/s", "time.end=3 us", "output.recording_interval=0.25 us",
          "output.results_interval=3 us"]  # nothing erodes
NOWHERE = [Network("nothing", Link())]  # messages take no time


def start(folder, ranks=1, settings=(), options=(), environment=(), **others):
    words = [w for setting in settings for w in ("--set", setting)]
    command = [KERF, "run", str(CASE), "--output", str(folder), *words, *options]
    if ranks > 1:
        given = [w for name in environment for w in ("-x", name)]
        command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-n", str(ranks), *given, *command]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **others)


def run(folder, *arguments, **others):
    process = start(folder, *arguments, **others)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 0, out + err
    return json.loads((folder / "summary.json").read_text())


def touching(moment):
    """Pairs of ids: of a node, and of the corners of the facet that it touches."""
    c, ids = moment.contact, moment.mesh.node_ids()
    which = c.pair_touches.astype(bool)
    return {(int(ids[c.slaves[s]]), *sorted(ids[c.facets[f]].tolist()))
            for s, f in zip(c.pair_slave[which], c.pair_facet[which])}


def expect_same(ours, theirs):
    """All that is no time, and no candidate: boxes on several ranks may be larger, so there are more."""
    assert len(ours.moments) == len(theirs.moments)
    assert (ours.record_bytes, ours.source) == (theirs.record_bytes, theirs.source)
    for a, b in zip(ours.moments, theirs.moments):
        for key in ("cycle", "n_cycles", "time", "rounds", "agreements", "friction", "n_loads", "n_eroding"):
            assert getattr(a, key) == getattr(b, key), key
        for key in ("element", "eroded"):
            np.testing.assert_array_equal(getattr(a, key), getattr(b, key))
        for key in ("cells", "points", "node"):
            np.testing.assert_array_equal(getattr(a.mesh, key), getattr(b.mesh, key))
        np.testing.assert_array_equal(a.contact.slaves, b.contact.slaves)
        assert touching(a) == touching(b)


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recorded")
    return folder, run(folder), read_recording(folder / "recording.h5")


@pytest.mark.parametrize("ranks, settings", [(2, []), (3, []), (3, OFTEN)])
def test_the_same_is_recorded_on_any_number_of_ranks(reference, tmp_path, ranks, settings):
    summary = run(tmp_path, ranks, settings)
    assert summary["state_hash"] == reference[1]["state_hash"]
    assert len(summary["rebalances"]) == (1 if not settings else 9)
    expect_same(read_recording(tmp_path / "recording.h5"), reference[2])


def test_a_recording_adds_up_to_the_summary(reference):
    folder, summary, recording = reference
    moments = recording.moments
    assert len(moments) == 8
    assert sum(m.n_cycles for m in moments) == summary["cycles"]
    assert [m.cycle for m in moments] == [1 + sum(n.n_cycles for n in moments[:k]) for k in range(len(moments))]
    with open(folder / "erosion.csv", newline="") as file:
        deaths = [(int(row["cycle"]), int(row["element"])) for row in csv.DictReader(file)]
    assert len(deaths) == summary["work"]["eroded_elements"] == summary["eroded"]["elements"] > 100
    left = {int(e) for e in moments[0].element}
    n_element_cycles = 0
    for m in moments:
        assert set(m.element.tolist()) == left
        here = [(cycle, e) for cycle, e in deaths if m.cycle <= cycle < m.cycle + m.n_cycles]
        assert m.n_eroding == len({cycle for cycle, _ in here})
        assert len(m.eroded) == (int(len(here) / m.n_eroding + 0.5) if here else 0)
        assert set(m.element[m.eroded].tolist()) <= {e for _, e in here}
        # An element counts in the cycle in which it dies.
        n_element_cycles += len(left) * m.n_cycles - sum(m.cycle + m.n_cycles - 1 - cycle for cycle, _ in here)
        left -= {e for _, e in here}
    assert n_element_cycles == summary["element_cycles"]
    assert len(left) == sum(p["alive"] for p in summary["parts"].values())
    assert any(len(m.contact.pair_slave) for m in moments) and any(len(touching(m)) for m in moments)


@pytest.mark.parametrize("ranks", [1, 2])
def test_times_add_up_to_the_timers(tmp_path, ranks):
    """All of a phase is recorded but what it took before the first cycle."""
    summary, recording = run(tmp_path, ranks), read_recording(tmp_path / "recording.h5")
    total = {"elements": 0.0, "erosion": 0.0, "contact_forces": 0.0, "contact_search": 0.0}
    for m in recording.moments:
        total["elements"] += m.element_seconds.sum() * m.n_cycles
        total["erosion"] += m.erosion_seconds.sum() * m.n_eroding
        total["contact_forces"] += m.contact.force_seconds.sum() * m.n_cycles
        total["contact_search"] += m.contact.search_seconds.sum() * (m.n_searches + m.n_renewals or m.n_cycles)
    for phase, seconds in total.items():
        spent = summary["timers"][phase]["work"]["mean"] * ranks
        # At the start there is one more evaluation, and a search for overlaps; a busy machine may stop either.
        assert 0.5 * spent < seconds <= spent * (1.0 + 1e-9), phase


def test_recording_changes_no_bit(reference, tmp_path):
    (tmp_path / "plain.yaml").write_text(
        "".join(line for line in CASE.read_text().splitlines(True) if "recording_interval" not in line))
    done = subprocess.run([KERF, "run", "plain.yaml", "--output", "out"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert not (tmp_path / "out" / "recording.h5").exists()
    plain = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert plain["state_hash"] == reference[1]["state_hash"]
    for file in ("history.csv", "erosion.csv"):
        assert (tmp_path / "out" / file).read_bytes() == (reference[0] / file).read_bytes()


@pytest.fixture(scope="module")
def stopped(tmp_path_factory):
    """A run with restart files in the midst of an interval, and at its end."""
    folder = tmp_path_factory.mktemp("stopped")
    return folder, run(folder, 1, STOPS), read_recording(folder / "recording.h5")


def go_back(stopped, folder):
    """The same folder with the restart file before the last as the newest."""
    shutil.copytree(stopped[0], folder, dirs_exist_ok=True)
    (folder / "restart" / "restart_previous.h5").rename(folder / "restart" / "restart.h5")
    return folder


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_run_that_is_resumed_goes_on_with_its_recording(stopped, tmp_path, ranks):
    """What was recorded after the restart file is cut off, and recorded again."""
    summary = run(go_back(stopped, tmp_path), ranks, STOPS, ["--resume"])
    assert summary["state_hash"] == stopped[1]["state_hash"]
    assert not [w for w in summary["warnings"] if "recording" in w]
    again = read_recording(tmp_path / "recording.h5")
    expect_same(again, stopped[2])
    assert len(again.moments) > 8, "a moment ends at each restart file"
    assert again.moments[0].element_seconds.tobytes() == stopped[2].moments[0].element_seconds.tobytes()


def test_a_run_that_is_resumed_without_an_interval_leaves_the_recording(stopped, tmp_path):
    case = "".join(line for line in CASE.read_text().splitlines(True) if "recording_interval" not in line)
    folder = go_back(stopped, tmp_path / "out")
    before = (folder / "recording.h5").read_bytes()
    (tmp_path / CASE.name).write_text(case)
    words = [w for setting in STOPS for w in ("--set", setting)]
    done = subprocess.run([KERF, "run", CASE.name, "--output", "out", "--resume", *words], cwd=tmp_path,
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (folder / "recording.h5").read_bytes() == before


def test_cycles_that_nobody_has_recorded_are_told(stopped, tmp_path):
    folder = go_back(stopped, tmp_path)
    (folder / "recording.h5").unlink()
    summary = run(folder, 1, STOPS, ["--resume"])
    recording = read_recording(folder / "recording.h5")
    first = recording.moments[0].cycle
    assert first > 30
    told = [w for w in summary["warnings"] if "recording.h5" in w]
    assert len(told) == 1
    assert told[0].endswith(f"recording.h5 has no record of the cycles 1 to {first - 1}, before this start; a "
                            "prediction does not count them")


def test_a_recording_that_cannot_go_on_is_not_overwritten(stopped, tmp_path):
    folder = go_back(stopped, tmp_path)
    damaged = bytearray((folder / "recording.h5").read_bytes())
    damaged[60] ^= 1
    (folder / "recording.h5").write_bytes(damaged)
    process = start(folder, 1, STOPS, ["--resume"])
    err = process.communicate(timeout=60)[1]
    assert process.returncode != 0
    assert 'error: ' in err and f'cannot go on with the recording "{folder}/recording.h5": ' in err
    assert "move the file away, or take output.recording_interval out" in err
    assert (folder / "recording.h5").read_bytes() == damaged


def test_a_new_run_takes_the_place_of_an_earlier_recording(reference, tmp_path):
    shutil.copy(reference[0] / "recording.h5", tmp_path / "recording.h5")
    run(tmp_path, 1, ["time.end=0.5 us"])
    assert [m.cycle for m in read_recording(tmp_path / "recording.h5").moments] == [1]


@pytest.mark.parametrize("value, message", [
    ("0 us", "`recording_interval` = 0 s is out of range; expected greater than 0 s"),
    ("-1 us", "`recording_interval` = -1e-06 s is out of range; expected greater than 0 s"),
    ("1 mm", "recording_interval"), ("soon", "recording_interval"), ("[1 us]", "recording_interval")])
def test_wrong_intervals_are_told(tmp_path, value, message):
    done = subprocess.run([KERF, "check", str(CASE), "--set", f"output.recording_interval={value}"],
                          capture_output=True, text=True)
    assert done.returncode == 2
    assert "error: " in done.stderr and "; expected" in done.stderr and message in done.stderr


def wait_for(path, size):
    for _ in range(500):
        time.sleep(0.01)
        if path.exists() and path.stat().st_size > size:
            return
    pytest.fail(f"{path} has not reached {size} bytes")


def test_a_disk_that_is_full_leaves_what_was_recorded(tmp_path):
    path = tmp_path / "recording.h5"
    process = start(tmp_path, 1, LONG)
    wait_for(path, 300_000)
    limit = path.stat().st_size + 500_000  # of one file, which the recording reaches first
    resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (limit, limit))
    err = process.communicate(timeout=60)[1]
    assert process.returncode == 1
    assert re.search(f'error: the run stopped: cannot (write|shorten) "{path}": File too large', err), err
    assert "File too large" in json.loads((tmp_path / "summary.json").read_text())["exit"]
    kept = read_recording(path)
    assert len(kept.moments) >= 2
    assert prediction.predict(kept, 4, prediction.CutPartitions(), prediction.Policy(), NOWHERE)[0].seconds > 0.0


def test_a_run_that_is_killed_leaves_what_was_recorded(tmp_path):
    path = tmp_path / "recording.h5"
    process = start(tmp_path, 1, LONG)
    wait_for(path, 500_000)
    process.send_signal(signal.SIGKILL)
    process.communicate(timeout=60)
    kept = read_recording(path)
    assert len(kept.moments) >= 2
    assert [m.cycle for m in kept.moments[1:]] == [m.cycle + m.n_cycles for m in kept.moments[:-1]]


def test_a_recording_that_is_cut_off_is_refused_with_a_sentence(reference, tmp_path):
    whole = (reference[0] / "recording.h5").read_bytes()
    for size in (0, 100, 128, 5000, len(whole) // 2, len(whole) - 2000):
        (tmp_path / "recording.h5").write_bytes(whole[:size])
        with pytest.raises(RecordingError, match="recording.h5: error: .*; expected"):
            read_recording(tmp_path / "recording.h5")


def test_a_run_that_ends_before_its_first_cycle_has_no_moment(tmp_path):
    """What the file is before the first moment."""
    process = start(tmp_path, 1, ["time.end=1 ms", "output.recording_interval=1 ms"])
    wait_for(tmp_path / "recording.h5", 0)
    process.send_signal(signal.SIGKILL)
    process.communicate(timeout=60)
    with pytest.raises(RecordingError, match="there is no moment; expected at least one"):
        read_recording(tmp_path / "recording.h5")


class RunOwners:
    """The owners that the run itself had, which never changed."""
    name = "run"

    def __init__(self, folder):
        import h5py

        with h5py.File(folder / "results.vtkhdf") as file:
            self.owner = file["VTKHDF/CellData/owner"][:].astype(np.int64)

    def owners(self, moment, state, n_ranks):
        return self.owner[state.element]


@pytest.mark.skipif(not LIBRARY.is_file(), reason=f"{LIBRARY} has not been built")
def test_predicted_messages_are_near_those_that_are_counted(tmp_path):
    """What touches in the middle of an interval stands for its one or two cycles, and candidates of one rank for those
    of several, whose boxes are larger: that may be a tenth, and half as much is left for the next compiler. On several
    ranks nodes leave the boxes of their ranks, so there are more complete searches, which have collective operations.
    """
    run(tmp_path / "alone", 1, STEADY)
    recording = read_recording(tmp_path / "alone" / "recording.h5")
    for ranks in (2, 3):
        folder = tmp_path / str(ranks)
        environment = {"KERF_MESSAGE_COUNTS": str(tmp_path / f"counts{ranks}")}
        run(folder, ranks, STEADY, environment=["KERF_MESSAGE_COUNTS", f"LD_PRELOAD={LIBRARY}"],
            env={**os.environ, **environment})
        cycles = by_cycle(read_ranks(tmp_path / f"counts{ranks}", ranks)).values()
        counted = {key: np.mean([c[key] for c in cycles]) for key in ("messages", "bytes", "collectives")}
        traffic = prediction.predict(recording, ranks, RunOwners(folder), prediction.Policy(), NOWHERE)[0].traffic
        assert traffic.messages == pytest.approx(counted["messages"], rel=0.15)
        assert traffic.n_bytes == pytest.approx(counted["bytes"], rel=0.15)
        assert 1.0 <= traffic.collectives <= counted["collectives"] * (1.0 + 1e-9)
