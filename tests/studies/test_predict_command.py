"""The command: from a recording to tables and pictures, and what it says when it cannot."""

import csv
import json
import subprocess
import sys

import h5py
import numpy as np
import pytest
from predict_scenes import STUDIES, sample_recording

import loggp
import prediction
from networks import find_network, read_network
from recording import Moment, read_recording, write_recording
from recording_check import mistakes_in


def predict(*arguments):
    return subprocess.run([sys.executable, "-B", str(STUDIES / "predict.py"), *map(str, arguments)],
                          capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    write_recording(folder / "recording.h5", sample_recording())
    return folder


def test_a_prediction_writes_tables_and_pictures(run_folder, tmp_path):
    done = predict(run_folder, "--ranks", "2..8", "--network", "hdr_infiniband", "--network", "ethernet_10", "--policy",
                   "never", "--policy", "threshold:1.05", "--output", tmp_path)
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "predict.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2 * 2 * 3
    assert {int(r["ranks"]) for r in rows} == {2, 4, 8}
    for row in rows:
        communication = float(row["serialisation_efficiency"]) * float(row["transfer_efficiency"])
        assert float(row["parallel_efficiency"]) == pytest.approx(float(row["load_balance"]) * communication)
        assert float(row["efficiency"]) == pytest.approx(float(row["speed_up"]) / int(row["ranks"]))
        assert float(row["global_efficiency"]) == pytest.approx(float(row["efficiency"]))
        assert 0.0 < float(row["efficiency"]) <= 1.0
        phases = sum(float(v) for k, v in row.items() if v and k.startswith("seconds_") and k != "seconds_per_cycle")
        # Ranks leave a cycle at different times: their mean is a little before the last.
        assert phases == pytest.approx(float(row["seconds_per_cycle"]), rel=0.1)
    assert json.loads((tmp_path / "predict.json").read_text())["predictions"][0]["ranks"] == 2
    assert (tmp_path / "predict_speed_up.png").stat().st_size > 10000
    assert len(list(tmp_path.glob("predict_efficiency_*.png"))) == 4


def outcome(recording, n_ranks, policy="never", network="hdr_infiniband", space="rcb"):
    return prediction.predict(recording, n_ranks, prediction.CutPartitions(), prediction.read_policy(policy),
                              [read_network(find_network(network))], space)[0]


def test_one_rank_takes_the_work_and_nothing_else():
    recording = sample_recording()
    serial = outcome(recording, 1)
    assert serial.seconds == pytest.approx(serial.total_useful().sum())
    elements = np.mean([m.element_seconds.sum() for m in recording.moments])
    assert serial.useful["elements"].sum() == pytest.approx(elements)


def test_the_work_is_the_same_on_any_number_of_ranks():
    recording = sample_recording()
    for n_ranks in (2, 7, 32):
        useful = outcome(recording, n_ranks).useful
        assert useful["elements"].sum() == pytest.approx(outcome(recording, 1).useful["elements"].sum())


def test_re_balancing_costs_something_and_evens_the_work():
    recording = sample_recording()
    never, moved = outcome(recording, 8), outcome(recording, 8, "threshold:1.05")
    assert (never.moves, moved.moves) == (0, 1)
    assert moved.causes["elements"]["imbalance"] < never.causes["elements"]["imbalance"]
    assert moved.phases["rebalance"] > 0.0 and "rebalance" not in never.phases
    assert outcome(recording, 8, "every:50").moves == 4


def test_cycles_since_the_last_move_count_in_the_next_moment():
    recording = sample_recording(n_moments=3)
    assert sum(m.n_cycles for m in recording.moments) == 300
    for interval in (70, 130, 299):
        assert outcome(recording, 8, f"every:{interval}").moves == 300 // interval


def test_a_network_without_time_leaves_only_waiting():
    recording = sample_recording()
    nothing = loggp.Network("nothing", loggp.Link())
    got = prediction.predict(recording, 16, prediction.CutPartitions(), prediction.Policy(), [nothing])[0]
    assert got.seconds == pytest.approx(got.ideal_seconds)
    assert got.seconds >= got.total_useful().max() * (1.0 - 1e-12)


def test_owners_of_kerf_partition(run_folder, tmp_path):
    recording = read_recording(run_folder / "recording.h5")
    n = int(recording.moments[0].element.max()) + 1
    path = tmp_path / "partitions.h5"
    with h5py.File(path, "w") as file:
        file.create_group("initial").attrs["time"] = 0.0
        file["initial/slices/4"] = np.arange(n, dtype=np.int32) * 4 // n
    done = predict(run_folder, "--ranks", 4, "--partitions", path, "--method", "slices", "--output", tmp_path)
    assert done.returncode == 0, done.stderr
    row = json.loads((tmp_path / "predict.json").read_text())["predictions"][0]
    assert row["partitioner"] == "slices"
    done = predict(run_folder, "--ranks", 8, "--partitions", path, "--method", "slices", "--output", tmp_path)
    assert done.returncode == 2
    assert f"{path}: error: the state initial has no partition slices/8; expected one of slices/4" in done.stderr


@pytest.mark.parametrize("arguments, message", [
    (("--ranks", "0"), "--ranks: error: `0`; expected numbers as 2,4,8 or a range as 2..4096"),
    (("--ranks", "two"), "--ranks: error: `two`; expected numbers"),
    (("--policy", "sometimes"), "--policy: error: a policy `sometimes`; expected never, every:CYCLES or threshold:"),
    (("--policy", "every:1.5"), "--policy: error: a policy `every:1.5`; expected"),
    (("--policy", "threshold:0.5"), "--policy: error: a policy `threshold:0.5`; expected"),
    (("--network", "carrier_pigeon"), "--network: error: there is no network `carrier_pigeon`; expected a file or one"),
    (("--method", "rcb"), "--method: error: there is no --partitions; expected a file of kerf partition"),
    (("--partitions", "nowhere.h5", "--method", "rcb"), "nowhere.h5: error: the file cannot be read: "),
    (("--ranks", "60000"), "every number of ranks is greater than that of elements; expected fewer ranks")])
def test_wrong_options_are_told(arguments, message, run_folder, tmp_path):
    done = predict(run_folder, "--output", tmp_path, *arguments)
    assert done.returncode == 2
    assert message in done.stderr
    assert not list(tmp_path.glob("predict*"))


def test_a_folder_that_cannot_be_made_is_told(run_folder, tmp_path):
    (tmp_path / "taken").write_text("")
    done = predict(run_folder, "--ranks", 2, "--output", tmp_path / "taken")
    assert done.returncode == 1, done.stderr
    assert done.stderr == f"{tmp_path / 'taken'}: error: File exists; expected a folder that can be written\n"


def test_a_file_that_is_no_recording_is_told(tmp_path):
    with h5py.File(tmp_path / "recording.h5", "w"):
        pass
    done = predict(tmp_path)
    assert done.returncode == 2
    assert "recording.h5: error: the file is no recording of format 2; expected" in done.stderr
    assert predict(tmp_path / "nothing.h5").returncode == 2
    assert predict().returncode == 2


def test_arrays_that_do_not_fit_are_all_told():
    recording = sample_recording()
    recording.moments[0].element_seconds = recording.moments[0].element_seconds[:-1]
    recording.moments[1].element_seconds[3] = np.nan
    lines = mistakes_in(recording)
    assert len(lines) == 2
    assert lines[0].startswith("moment 0:") and "expected one for each" in lines[0]
    assert lines[1].startswith("moment 1: a value of element_seconds is negative or not finite")


@pytest.mark.parametrize("place, value, message", [
    ("rounds", np.nan, "moment 0: rounds is nan; expected a finite number, at least 0"),
    ("rounds", -3.0, "moment 0: rounds is -3.0; expected"),
    ("n_searches", 1e6, "searches, renewals and refreshes in"), ("n_eroding", 1e5, "moment 0: elements erode in 1"),
    ("facet_reach", -1.0, "moment 0: facet_reach is -1.0 m; expected a finite length"),
    ("element_seconds", np.inf, "moment 0: a value of element_seconds is negative or not finite"),
    ("contact/force_seconds", -1.0, "moment 0: a value of force_seconds is negative or not finite"),
    ("points", np.nan, "moment 0: a coordinate of a node is not finite"), ("element", 0, "two elements have the same"),
    ("node", 0, "moment 0: two nodes have the same id"), ("cells", -1, "moment 0: a node of a cell is -1; expected"),
])
def test_a_recording_with_numbers_that_cannot_be_is_refused(place, value, message, tmp_path):
    path = tmp_path / "recording.h5"
    write_recording(path, sample_recording())
    with h5py.File(path, "r+") as file:
        group = file["moments/0"]
        if place in group:
            group[place][:2] = value
        else:
            group.attrs[place] = value
    done = predict(path, "--ranks", 2, "--output", tmp_path / "out")
    assert done.returncode == 2 and message in done.stderr and "Traceback" not in done.stderr, done.stderr


@pytest.mark.parametrize("name", ["element", "element_seconds", "cells", "contact/slaves"])
def test_a_recording_without_an_array_is_refused(name, tmp_path):
    path = tmp_path / "recording.h5"
    write_recording(path, sample_recording())
    with h5py.File(path, "r+") as file:
        del file[f"moments/0/{name}"]
    done = predict(path, "--ranks", 2, "--output", tmp_path / "out")
    assert done.returncode == 2 and "expected a whole recording" in done.stderr, done.stderr


def test_moments_must_follow_one_another(tmp_path):
    recording = sample_recording()
    recording.moments.reverse()
    assert any("expected at least" in line and "after the moment before" in line for line in mistakes_in(recording))


@pytest.mark.parametrize("every, moves", [(20, 16), (50, 6), (7, 46), (322, 1), (323, 0)])
def test_the_policy_every_moves_as_often_as_a_run(every, moves):
    """322 cycles in ten moments; a run moves in the cycles that `every` divides."""
    starts = np.linspace(1, 323, 11).astype(int)
    found = [prediction.read_policy(f"every:{every}").moves(Moment(int(a), int(b - a), None, None, None), 1.0)
             for a, b in zip(starts, starts[1:])]
    assert sum(found) == moves
