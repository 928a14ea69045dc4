"""kerf scale from end to end: runs, hashes, counts, tables, report; runs that fail; states that differ."""

import csv
import json

import pytest
from scale_case import content_of, made_up, row, scale, summary, write_input
from study_case import INPUT, ROOT

import message_counts
import scaling
from quantities import value_of

SMALL = INPUT.replace("cells: [4, 4, 2]", "cells: [8, 8, 4]").replace("end: 2 us", "end: 2 us\n  maximum_cycles: 30")


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A study of 1 and 2 ranks with everything in it: its folder and what was printed."""
    folder = tmp_path_factory.mktemp("scale")
    output = folder / "out"
    done = scale(write_input(folder, SMALL), "--ranks", "1,2", "--repeats", "1", "--side-by-side", "--output", output)
    assert done.returncode == 0, done.stdout + done.stderr
    return output, done


def test_states_are_equal_on_all_ranks(small):
    content = content_of(small[0])
    assert content["hashes"]["equal"] is True and len(content["hashes"]["values"]) == 1
    assert len({run["state_hash"] for run in content["runs"]}) == 1
    assert [run["status"] for run in content["runs"]] == ["done"] * 6


def test_factors_are_in_their_range(small):
    for line in content_of(small[0])["ranks"]:
        f = line["factors"]
        for name in ("load_balance", "communication_efficiency", "parallel_efficiency"):
            assert 0.0 < f[name] <= 1.0, (name, f)
        assert f["parallel_efficiency"] == pytest.approx(f["load_balance"] * f["communication_efficiency"])
        assert f["global_efficiency"] == pytest.approx(f["parallel_efficiency"] * f["computation_scaling"])
        assert f["serialisation_efficiency"] is None and f["transfer_efficiency"] is None
    assert "not split into serialisation and transfer" in small[1].stdout


def test_steps_take_no_longer_than_the_run(small):
    """The set-up finds contact and forces, too; its time is not that of a step."""
    summaries = [json.loads(path.read_text()) for path in small[0].rglob("summary.json")]
    assert summaries
    for one in summaries:
        assert one["steps"]["max"] <= one["wall_seconds"], one["ranks"]
        in_steps = sum(one["timers"][name]["mean"] for name in scaling.OF_STEP)
        assert one["steps"]["mean"] == pytest.approx(in_steps)


def test_messages_are_counted(small):
    content = content_of(small[0])
    one, two = (row(content, n)["counts"]["per_cycle"]["all"] for n in (1, 2))
    assert one["cycles"] == two["cycles"] == row(content, 2)["cycles"]
    assert one["messages"]["mean"] == 0 and two["messages"]["mean"] > 0 and two["bytes"]["mean"] > 0
    assert two["collectives"]["median"] >= 1
    named = {(entry["phase"], entry["kind"]) for entry in row(content, 2)["counts"]["functions"]}
    assert ("halo", "message") in named and ("setup", "collective") in named


def test_tables_have_a_line_for_each_number_and_run(small):
    with open(small[0] / "scale.csv", newline="") as file:
        lines = list(csv.DictReader(file))
    assert [line["ranks"] for line in lines] == ["1", "2"]
    assert float(lines[0]["speed_up"]) == 1.0 and float(lines[0]["efficiency"]) == 1.0
    assert float(lines[1]["efficiency_side_by_side"]) > 0.0 and lines[1]["collectives_all_median"]
    assert {"work_elements", "waiting_halo", "imbalance_contact_search", "imbalance_of_model_mean"} <= lines[0].keys()
    with open(small[0] / "runs.csv", newline="") as file:
        assert [line["kind"] for line in csv.DictReader(file)] == ["timed"] * 2 + ["side_by_side"] * 2 + ["counted"] * 2
    assert (small[0] / "counts.csv").exists()


def test_the_report_has_its_figures_in_it(small):
    page = (small[0] / "report.html").read_text()
    assert page.count("data:image/png;base64,") == 8 and "src=\"http" not in page
    assert content_of(small[0])["machine"]["cpu"] in page
    assert (small[0] / "report.png").read_bytes().startswith(b"\x89PNG")


def test_the_report_can_be_drawn_again(small):
    names = ("report.html", "report.png", "scale.csv", "runs.csv")
    for name in names:
        (small[0] / name).unlink()
    before = (small[0] / "scale.json").read_text()
    done = scale("--plot-only", "--output", small[0])
    assert done.returncode == 0 and all((small[0] / name).exists() for name in names)
    assert (small[0] / "scale.json").read_text() == before


def test_runs_that_are_there_are_not_run_again(small):
    times = {path: path.stat().st_mtime_ns for path in small[0].rglob("summary.json")}
    done = scale(small[0].parent / "input.yaml", "--ranks", "1,2", "--repeats", "1", "--side-by-side", "--output",
                 small[0])
    assert done.returncode == 0 and "0 runs to do" in done.stdout
    assert {path: path.stat().st_mtime_ns for path in small[0].rglob("summary.json")} == times


def test_talp_files_have_what_the_pages_need(small):
    files = sorted((small[0] / "talp" / "input" / "strong_scaling").glob("*.json"))
    assert [file.name for file in files] == ["ranks_1_repeat_1.json", "ranks_2_repeat_1.json"]
    talp = json.loads(files[1].read_text())
    assert talp["dlbVersion"].startswith("3.5") and talp["resources"] == {"numCpus": 2, "numMpiRanks": 2}
    region = talp["Application"]["Global"]
    assert region["usefulTime"] + region["mpiTime"] == pytest.approx(2 * region["elapsedTime"], rel=1e-6)
    assert region["mpiParallelEfficiency"] == pytest.approx(
        region["mpiLoadBalance"] * region["mpiCommunicationEfficiency"])
    # Such a time is all that TALP-Pages 3.6.1 can read.
    assert "T" in talp["timestamp"] and "+" not in talp["timestamp"]


def test_phases_have_the_names_of_the_program():
    assert message_counts.phases_of_source(ROOT / "framework" / "core" / "timers.hpp") == message_counts.PHASES


def test_runs_alternate(tmp_path):
    environment, options = made_up(tmp_path, {1: summary(1, 8.0, 8.0, 8.0), 2: summary(2, 5.0, 4.0, 4.5)})
    done = scale(write_input(tmp_path), "--ranks", "2,1", "--repeats", "2", *options, "--output", tmp_path / "out",
                 environment=environment)
    names = [line.split("] ")[1].split(":")[0] for line in done.stdout.splitlines() if "] ranks_" in line]
    assert names == ["ranks_1/repeat_1", "ranks_2/repeat_1", "ranks_1/repeat_2", "ranks_2/repeat_2"]


def test_known_times_give_known_factors(tmp_path):
    """Serial 8 s of work in 8 s; on two ranks 3.6 and 4.5 s of work in 5 s; on four 2 s each in 2.5 s."""
    environment, options = made_up(tmp_path, {1: summary(1, 8.0, 8.0, 8.0), 2: summary(2, 5.0, 4.05, 4.5),
                                              4: summary(4, 2.5, 2.0, 2.0)})
    done = scale(write_input(tmp_path), "--ranks", "1,2,4", "--repeats", "1", *options, "--output", tmp_path / "out",
                 environment=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    content = content_of(tmp_path / "out")
    two, four = row(content, 2), row(content, 4)
    assert two["speed_up"] == pytest.approx(1.6) and two["efficiency"] == pytest.approx(0.8)
    assert two["factors"]["load_balance"] == pytest.approx(0.9)
    assert two["factors"]["communication_efficiency"] == pytest.approx(0.9)
    assert two["factors"]["parallel_efficiency"] == pytest.approx(0.81)
    assert two["factors"]["computation_scaling"] == pytest.approx(8.0 / 8.1)
    assert two["factors"]["global_efficiency"] == pytest.approx(0.8)
    assert two["phases"]["elements"]["imbalance"] == pytest.approx(4.5 / 4.05)
    assert two["phases"]["halo"]["waiting_share"] == pytest.approx(0.95 / 5.0)
    assert four["factors"]["load_balance"] == pytest.approx(1.0)
    assert four["factors"]["communication_efficiency"] == pytest.approx(0.8)
    assert four["efficiency"] == pytest.approx(0.8)


@pytest.mark.parametrize("change, message", [
    ({"ranks": 1}, "the run was on 1 ranks; expected 2"),
    ({"state_hash": None}, "summary.json has no state_hash"),
    ({"steps": None}, "summary.json has no steps"),
    ({"wall_seconds": 0.0}, "has made no step whose time could be measured"),
])
def test_a_summary_of_another_run_is_refused(tmp_path, change, message):
    environment, options = made_up(tmp_path, {1: summary(1, 8.0, 8.0, 8.0), 2: summary(2, 5.0, 4.0, 4.5) | change})
    done = scale(write_input(tmp_path), "--ranks", "1,2", "--repeats", "1", *options, "--output", tmp_path / "out",
                 environment=environment)
    assert done.returncode == 3 and message in done.stdout + done.stderr, done.stdout + done.stderr
    assert row(content_of(tmp_path / "out"), 2)["completed"] == 0
    assert "Traceback" not in done.stderr


def test_a_mesh_that_does_not_grow_is_no_weak_scaling(tmp_path):
    """Twice the ranks, and the same elements."""
    environment, options = made_up(tmp_path, {1: summary(1, 8.0, 8.0, 8.0), 4: summary(4, 5.0, 4.0, 4.5)})
    done = scale(write_input(tmp_path), "--ranks", "1,4", "--repeats", "1", "--weak", "mesh", *options, "--output",
                 tmp_path / "out", environment=environment)
    assert done.returncode == 3 and "the mesh of 4 ranks has 100 elements" in done.stderr, done.stdout + done.stderr
    assert "expected about 400: --weak must name all that makes cells" in done.stderr


def test_a_launcher_that_starts_always_the_same_is_refused(tmp_path):
    done = scale(write_input(tmp_path), "--ranks", "1,2", "--launch", "mpirun -n 1", "--output", tmp_path / "out")
    assert done.returncode == 2 and "expected a command with @RANKS@" in done.stderr


def test_a_run_that_fails_stands_in_the_table(tmp_path):
    environment, options = made_up(tmp_path, {1: summary(1, 8.0, 8.0, 8.0), 4: summary(4, 2.5, 2.0, 2.0)})
    done = scale(write_input(tmp_path), "--ranks", "1,2,4", "--repeats", "1", *options, "--output", tmp_path / "out",
                 environment=environment)
    assert done.returncode == 3
    content = content_of(tmp_path / "out")
    assert [(run["status"], run["exit_code"]) for run in content["runs"]] == [("done", 0), ("failed", 3), ("done", 0)]
    assert "made to fail" in content["runs"][1]["message"] and "made to fail" in done.stdout
    assert row(content, 2)["completed"] == 0 and "speed_up" not in row(content, 2)
    assert row(content, 4)["speed_up"] == pytest.approx(3.2)
    assert "made to fail" in (tmp_path / "out" / "report.html").read_text()


def test_a_launcher_that_is_not_there_is_told(tmp_path):
    environment, _ = made_up(tmp_path, {2: summary(2, 5.0, 4.0, 4.5)})
    done = scale(write_input(tmp_path), "--ranks", "2", "--no-counts", "--launch", "no_such_launcher -n @RANKS@",
                 "--output", tmp_path / "out", environment=environment)
    assert done.returncode == 1
    assert "no_such_launcher: error: the command cannot be started: No such file or directory; expected a program" in \
        done.stderr


def test_an_input_that_is_wrong_fails_in_every_run(tmp_path):
    done = scale(write_input(tmp_path), "--ranks", "1,2", "--repeats", "1", "--set", "time.ende=1 us", "--output",
                 tmp_path / "out")
    assert done.returncode == 3 and "ende" in done.stdout
    assert "No run has completed" in (tmp_path / "out" / "report.html").read_text()


def test_states_that_differ_are_told_loudly(tmp_path):
    environment, options = made_up(tmp_path, {1: summary(1, 8.0, 8.0, 8.0),
                                              2: summary(2, 5.0, 4.0, 4.5, state_hash="b" * 16)})
    done = scale(write_input(tmp_path), "--ranks", "1,2", "--repeats", "1", *options, "--output", tmp_path / "out",
                 environment=environment)
    assert done.returncode == 5 and "STATES DIFFER" in done.stderr and "ranks_2/repeat_1" in done.stderr
    assert content_of(tmp_path / "out")["hashes"]["equal"] is False
    assert "STATES DIFFER" in (tmp_path / "out" / "report.html").read_text()


def test_more_ranks_than_cores_are_noted(tmp_path):
    environment, options = made_up(tmp_path, {1: summary(1, 8.0, 8.0, 8.0), 4096: summary(4096, 1.0, 0.5, 0.6)})
    done = scale(write_input(tmp_path), "--ranks", "1,4096", "--repeats", "1", *options, "--output", tmp_path / "out",
                 environment=environment)
    assert "on 4096 ranks there are more ranks than the" in done.stdout
    assert row(content_of(tmp_path / "out"), 4096)["oversubscribed"] is True


def test_weak_scaling_takes_the_true_sizes(tmp_path):
    """Twice the elements in 1.25 times the time on two ranks: throughput 1.6, efficiency 0.8. States may differ."""
    environment, options = made_up(tmp_path, {1: summary(1, 4.0, 4.0, 4.0), 2: summary(
        2, 5.0, 4.0, 4.0, element_cycles=2000, state_hash="b" * 16)})
    done = scale(write_input(tmp_path), "--ranks", "1,2", "--repeats", "1", "--weak", "parts.target.mesh.cells",
                 *options, "--output", tmp_path / "out", environment=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    two = row(content_of(tmp_path / "out"), 2)
    assert two["speed_up"] == pytest.approx(1.6) and two["efficiency"] == pytest.approx(0.8)
    assert two["factors"]["computation_scaling"] == pytest.approx(1.0)
    assert (tmp_path / "out" / "talp" / "input" / "weak_scaling").is_dir()


def test_meshes_grow_with_the_ranks(tmp_path):
    """Cells of 0.5 mm on one rank are 0.25 mm on eight, and 2 x 2 x 2 cells are 4 x 4 x 4."""
    model = SMALL.replace("size: 4 4 2 mm, cells: [8, 8, 4]", "size: 4 4 2 mm, cell_size: $h").replace(
        "  speed:", "  h: 0.5 mm\n  speed:")
    output = tmp_path / "out"
    done = scale(write_input(tmp_path, model), "--ranks", "1,8", "--repeats", "1", "--weak", "mesh", "--output", output,
                 "--slurm", "--no-counts")
    assert done.returncode == 0, done.stderr
    settings = json.loads((output / "ranks_8" / "repeat_1" / "point.json").read_text())["settings"]
    assert value_of(settings["parameters.h"]).number == pytest.approx(0.25)
    assert settings["parts.striker.mesh.cells"] == "[4, 4, 4]"
