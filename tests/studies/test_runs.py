"""Running a study: the table, what is run again, points that fail, results that cannot be trusted, signals."""

import json
import os
import signal
import subprocess
import time

import pytest
from study_case import INPUT, KERF, STUDY, SWEEP, csv_table, fits_of, summaries, sweep, table, values, write

import point_folder

GRID = "points: {type: grid, axes: {speed: [100 m/s, 150 m/s], strength: [300 MPa, 400 MPa]}}\n"


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    study = write(tmp_path_factory.mktemp("grid"), GRID)
    return study, sweep(study, "--jobs", 2)


def test_all_points_of_a_grid_complete(grid):
    study, done = grid
    assert done.returncode == 0, done.stdout + done.stderr
    assert "4 of 4 points have completed" in done.stdout
    assert values(study, "speed") == [100, 100, 150, 150]
    assert values(study, "strength") == [300, 400, 300, 400]


def test_the_table_holds_what_the_summaries_hold(grid):
    study, _ = grid
    assert len(table(study)) == 4
    for point in table(study):
        summary = json.loads((study.parent / "out" / point["point"] / "summary.json").read_text())
        assert point["results"] == {"residual": -summary["measures"]["striker.z"],
                                    "balance": summary["energy"]["balance_error"]}
        assert (point["exit"], point["exit_code"], point["trust"]) == ("completed", 0, "yes")
        assert point["state_hash"] == summary["state_hash"] and point["warnings"] == len(summary["warnings"])


def test_a_point_is_the_input_with_the_values_set(grid, tmp_path):
    """The same state, bit for bit, as a run of `kerf run` with the values typed by hand."""
    study, _ = grid
    subprocess.run([KERF, "run", study.parent / "input.yaml", "--output", tmp_path, "--set",
                    "materials.copper.strength.yield_stress=300 MPa", "--set", "parameters.speed=0 0 -150 m/s"],
                   check=True, capture_output=True)
    assert table(study)[2]["state_hash"] == json.loads((tmp_path / "summary.json").read_text())["state_hash"]
    assert len({point["state_hash"] for point in table(study)}) == 4


def test_the_csv_table_has_units_and_the_same_numbers(grid):
    study, _ = grid
    for row, point in zip(csv_table(study), table(study), strict=True):
        assert float(row["speed [m/s]"]) == point["parameters"]["speed"]
        assert float(row["residual"]) == point["results"]["residual"]
        assert row["state_hash"] == point["state_hash"] and row["trust"] == "yes"


def test_what_is_done_is_not_run_again(tmp_path):
    study = write(tmp_path, GRID)
    sweep(study)
    before = summaries(study)
    done = sweep(study)
    assert done.returncode == 0 and "4 points, 4 of them done already" in done.stdout
    assert summaries(study) == before and len(before) == 4


def test_a_new_point_leaves_the_others_as_they_are(tmp_path):
    study = write(tmp_path, GRID)
    sweep(study)
    before = summaries(study)
    study.write_text(study.read_text().replace("[100 m/s,", "[80 m/s, 100 m/s,"))
    assert "6 points, 4 of them done already" in sweep(study).stdout
    assert {name: time for name, time in summaries(study).items() if name in before} == before
    assert len(table(study)) == 6


@pytest.mark.parametrize("lost", ["summary.json", "exit_code", "point.json"])
def test_a_point_that_lost_a_file_is_run_again(tmp_path, lost):
    study = write(tmp_path, GRID)
    sweep(study)
    folder = tmp_path / "out" / table(study)[1]["point"]
    hash_before = table(study)[1]["state_hash"]
    (folder / lost).unlink()
    assert "4 points, 3 of them done already" in sweep(study).stdout
    assert table(study)[1]["state_hash"] == hash_before


def test_another_input_makes_all_points_new(tmp_path):
    study = write(tmp_path, GRID)
    sweep(study)
    (tmp_path / "input.yaml").write_text(INPUT.replace("8930", "8900"))
    done = sweep(study, "--collect")
    assert done.returncode == 4 and "the input has changed since this point was run" in done.stdout
    assert [point["results"]["residual"] for point in table(study)] == [None] * 4
    assert "4 points, 0 of them done already" in sweep(study).stdout


def test_a_file_that_the_input_names_counts_as_well(tmp_path):
    model = INPUT + ("curves:\n  push: {file: push.csv}\nloads:\n"
                     "  - {type: nodal_force, nodes: bottom, force: 0 0 1 N, curve: push}\n")
    (tmp_path / "push.csv").write_text("0,0\n1e-6,1\n")
    study = write(tmp_path, GRID, model=model)
    done = sweep(study)
    assert done.returncode == 0, done.stdout
    (tmp_path / "push.csv").write_text("0,0\n2e-6,1\n")
    assert "4 points, 0 of them done already" in sweep(study).stdout


def test_a_point_that_fails_does_not_stop_the_others(tmp_path):
    study = write(tmp_path, "points: {type: grid, axes: {strength: [300 MPa, 0 Pa, 400 MPa]}}\n".replace(
        "0 Pa,", "-1 MPa,"))
    done = sweep(study, "--jobs", 1)
    assert done.returncode == 3
    good, bad, last = table(study)
    assert (good["exit_code"], bad["exit_code"], last["exit_code"]) == (0, 2, 0)
    assert "yield_stress" in bad["message"] and "is out of range" in bad["message"]
    assert bad["trust"] == "no" and bad["flags"] == ["failed"] and bad["results"]["residual"] is None
    assert "is out of range" in csv_table(study)[1]["message"]
    # A failed point is tried again, the others are not.
    assert "3 points, 2 of them done already" in sweep(study).stdout


def test_a_run_that_physics_stops_has_no_results(tmp_path):
    """The cells of the striker shrink at the impact, and with them their stable step."""
    study = write(tmp_path, "points: {type: grid, axes: {speed: [200 m/s]}}\n",
                  "set: {time.minimum_step: 0.16 us}\n")
    done = sweep(study)
    assert done.returncode == 3, done.stdout
    point, = table(study)
    assert point["exit_code"] == 3 and point["results"] == {"residual": None, "balance": None}
    assert point["message"] == point["exit"] != "completed"


# ---- results and trust

def test_results_come_from_columns_as_well(tmp_path):
    results = STUDY + ("  kinetic: {history: kinetic, take: max}\n  least: {history: kinetic, take: min}\n"
                       "  pressure: {observer: nose.pressure, take: max, factor: 1e-6}\n")
    study = write(tmp_path, "points: {type: grid, axes: {speed: [100 m/s]}}\n", study=results)
    done = sweep(study)
    assert done.returncode == 0, done.stdout
    found = table(study)[0]["results"]
    assert found["kinetic"] == pytest.approx(0.5 * 8930 * 8e-9 * 100**2, rel=1e-9)
    assert 0.0 <= found["least"] < found["kinetic"]
    assert 100.0 < found["pressure"] < 5000.0  # MPa: below rho c v = 3.5 GPa / 2 with room for overshoots


def test_a_result_that_is_not_there_is_flagged(tmp_path):
    study = write(tmp_path, "points: {type: grid, axes: {speed: [100 m/s]}}\n",
                  study=STUDY.replace("measures.striker.z", "measures.striker.zz"))
    sweep(study)
    point, = table(study)
    assert point["trust"] == "no" and point["flags"] == ["no_result"]
    assert "no `measures.striker.zz`" in point["reasons"][0]


def test_a_balance_beyond_the_limit_is_flagged_and_left_out_of_fits(tmp_path):
    study = write(tmp_path, GRID, "limits: {balance_error: 1e-12}\nplots:\n"
                                  "  - {type: recht_ipson, striking: speed, residual: residual}\n")
    done = sweep(study)
    assert done.returncode == 1
    assert {tuple(point["flags"]) for point in table(study)} == {("energy_balance",)}
    assert "there are no perforating points" in done.stdout and "4 points that cannot be trusted" in done.stdout
    assert fits_of(study)[0]["refused"] is True


def test_warnings_of_a_run_are_to_be_looked_at(tmp_path):
    study = write(tmp_path, "points: {type: grid, axes: {speed: [100 m/s]}}\n",
                  "set: {contacts: []}\n")  # bodies on a collision course without a contact
    sweep(study)
    point, = table(study)
    summary = json.loads((tmp_path / "out" / point["point"] / "summary.json").read_text())
    assert summary["warnings"], "the input was meant to call for a warning"
    assert point["warnings"] == len(summary["warnings"]) and point["trust"] == "look"
    assert summary["warnings"][0] in point["reasons"][0]


def test_plots_and_fits_are_written(tmp_path):
    study = write(tmp_path, "points: {type: grid, axes: {speed: [100 m/s, 150 m/s, 200 m/s]}}\n", """plots:
  - {type: line, x: speed, y: [residual, balance], name: over_speed}
  - {type: scatter, x: residual, y: balance}
""")
    done = sweep(study)
    assert done.returncode == 0, done.stdout
    for name in ("over_speed", "scatter_balance"):
        assert (tmp_path / "out" / "plots" / f"{name}.png").read_bytes().startswith(b"\x89PNG")


def test_ranks_do_not_change_the_result(tmp_path):
    study = write(tmp_path, "points: {type: grid, axes: {speed: [100 m/s]}}\n")
    sweep(study)
    one = table(study)[0]["state_hash"]
    (tmp_path / "two").mkdir()
    other = write(tmp_path / "two", "points: {type: grid, axes: {speed: [100 m/s]}}\n", "ranks: 2\n")
    done = sweep(other)
    assert done.returncode == 0, done.stdout
    assert table(other)[0]["ranks"] == 2 and table(other)[0]["state_hash"] == one


# ---- signals

LONG = "points: {type: grid, axes: {speed: [100 m/s, 150 m/s, 200 m/s]}}\n"
END = "set: {time.end: 15 ms}\n"  # some seconds


def start_and_wait_for_progress(study):
    process = subprocess.Popen([*SWEEP, str(study), "--output", str(study.parent / "out"), "--jobs", "2"],
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               env={**os.environ, "KERF_BINARY": str(KERF)})
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline and not list((study.parent / "out").glob("*/history.csv")):
        time.sleep(0.05)
    time.sleep(0.3)
    return process


def runs_in(folder):
    """Processes of Kerf that work in a folder."""
    found = []
    for entry in os.listdir("/proc"):
        try:
            command = open(f"/proc/{entry}/cmdline", "rb").read() if entry.isdigit() else b""
        except OSError:
            continue
        if str(folder).encode() in command and b"\0run\0" in command:
            found.append(entry)
    return found


def test_a_signal_ends_the_runs_and_the_next_call_goes_on(tmp_path):
    study = write(tmp_path, LONG, END)
    process = start_and_wait_for_progress(study)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=60)
    assert process.returncode == 4, out
    assert not runs_in(tmp_path)
    assert "interrupted" in [p["flags"][0] for p in table(study)] and "missing" in [p["flags"][0] for p in table(study)]
    stopped = next(p["point"] for p in table(study) if p["flags"] == ["interrupted"])
    done = sweep(study)
    assert done.returncode == 0, done.stdout
    assert "--resume" not in (tmp_path / "out" / stopped / "errors.log").read_text()
    # The state at the end is that of a study which nobody has stopped.
    other = tmp_path / "whole"
    other.mkdir()
    whole = write(other, LONG, END)
    sweep(whole)
    assert [p["state_hash"] for p in table(study)] == [p["state_hash"] for p in table(whole)]


def test_no_run_outlives_a_study_that_is_killed(tmp_path):
    study = write(tmp_path, LONG, END.replace("15 ms", "900 ms"))
    process = start_and_wait_for_progress(study)
    assert runs_in(tmp_path)
    process.kill()
    process.communicate(timeout=10)
    deadline = time.monotonic() + 30
    while runs_in(tmp_path) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not runs_in(tmp_path)


def test_two_studies_do_not_work_in_one_folder(tmp_path):
    study = write(tmp_path, LONG, END.replace("15 ms", "900 ms"))
    process = start_and_wait_for_progress(study)
    try:
        second = sweep(study)
        assert second.returncode == 1 and "another kerf sweep works in this folder" in second.stderr
    finally:
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
    assert process.returncode == 4


@pytest.mark.parametrize("printed, told", [
    (["kerf: error: no memory", "-----", "mpirun noticed that process rank 1 exited on signal 9 (Killed).", "------"],
     "kerf: error: no memory"),
    (["------", "mpirun noticed that process rank 1 exited on signal 9 (Killed).", "Look at the log.", "------"],
     "mpirun noticed that process rank 1 exited on signal 9 (Killed)."),
    (["cycle 1", "=====", ""], "cycle 1"),
    ([], "nothing was printed"),
])
def test_the_message_of_a_run_that_fails_is_a_sentence(tmp_path, printed, told):
    folder = point_folder.PointFolder.__new__(point_folder.PointFolder)
    folder.path = tmp_path
    (tmp_path / "errors.log").write_text("\n".join(printed))
    assert folder.last_message() == told
