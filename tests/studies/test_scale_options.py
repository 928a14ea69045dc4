"""kerf scale: arguments that are wrong, and job arrays for Slurm."""

import json
import os
import subprocess

import pytest
from scale_case import content_of, made_up, row, scale, summary, write_input
from test_slurm import cluster  # noqa: F401  # the fixture


@pytest.mark.parametrize("words, sentence", [
    (["--ranks", "0,2"], "expected whole numbers from 1 on"), (["--ranks", "2,2"], "has a number twice"),
    (["--ranks", "one"], "expected whole numbers from 1 on"), (["--repeats", "0"], "expected a whole number from 1 on"),
    (["--set", "time.end"], "expected KEY.PATH=VALUE"), (["--submit"], "--submit goes with --slurm only"),
    (["--slurm", "--side-by-side"], "--side-by-side needs this machine"),
    (["--slurm", "--template", "nowhere.sh"], "there is no file nowhere.sh"),
    (["--slurm", "--collect"], "not allowed with"), (["--weak", "parts.target.mesh.cell"], "did you mean `cells`?"),
    (["--weak", "title"], "title makes no cells; expected `mesh`, the path of a key `cells`"),
    (["--weak", "time.end"], "time.end makes no cells"), (["--launch", "mpirun '-n @RANKS@"], "No closing quotation"),
    (["--weak", "parts.striker.mesh.cells", "--ranks", "7,8"], "the mesh of 8 ranks is that of 7 ranks")])
def test_wrong_arguments_are_refused(tmp_path, words, sentence):
    done = scale(write_input(tmp_path), *words, "--output", tmp_path / "out")
    assert done.returncode == 2 and sentence in done.stderr, done.stderr
    assert not (tmp_path / "out").exists()


def test_without_an_input_nothing_is_done(tmp_path):
    done = scale(cwd=tmp_path)
    assert done.returncode == 2 and "an input is missing" in done.stderr
    done = scale(tmp_path / "nowhere.yaml", cwd=tmp_path)
    assert done.returncode == 2 and "nowhere.yaml: error: the file cannot be read" in done.stderr


@pytest.mark.parametrize("what", ["--collect", "--plot-only"])
def test_a_folder_without_a_study_is_refused(tmp_path, what):
    done = scale(what, "--output", tmp_path)
    assert done.returncode == 1 and "expected the folder of an earlier kerf scale" in done.stderr


def test_a_missing_library_is_told(tmp_path):
    environment, _ = made_up(tmp_path, {1: summary(1, 8.0, 8.0, 8.0)})
    done = scale(write_input(tmp_path), "--ranks", "1", "--output", tmp_path / "out", environment=environment)
    assert done.returncode == 1 and "the library that counts messages is not there" in done.stderr


def test_slurm_scripts_are_written_and_nothing_is_run(tmp_path):
    done = scale(write_input(tmp_path), "--ranks", "1,16", "--repeats", "2", "--slurm", "--output", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    script = (tmp_path / "out" / "jobs" / "ranks_16" / "slurm" / "array.sh").read_text()
    # One task at a time: two repeats, and the run in which messages are counted.
    assert "#SBATCH --array=0-2%1\n" in script and "#SBATCH --ntasks=16\n" in script
    timed = (tmp_path / "out" / "ranks_16" / "repeat_1" / "run.sh").read_text()
    counted = (tmp_path / "out" / "ranks_16" / "counted" / "run.sh").read_text()
    assert "srun --ntasks=16 " in timed and "LD_PRELOAD" not in timed and "--resume" not in timed
    assert "srun --ntasks=16 env LD_PRELOAD=" in counted and "mpirun" not in timed + counted
    for path in (tmp_path / "out").rglob("*.sh"):
        assert subprocess.run(["bash", "-n", path]).returncode == 0
    assert not list((tmp_path / "out").rglob("summary.json"))
    done = scale("--collect", "--output", tmp_path / "out")
    assert done.returncode == 4 and "0 of 6 runs have completed" in done.stdout


def test_jobs_are_run_and_collected(tmp_path, cluster):  # noqa: F811
    """The stand-in for srun starts one rank, whatever it is asked for, so the study has one rank only."""
    output = tmp_path / "out"
    done = scale(write_input(tmp_path), "--ranks", "1", "--repeats", "2", "--slurm", "--submit", "--output", output,
                 environment=cluster)
    assert done.returncode == 0 and "submitted as job 4711" in done.stdout, done.stdout + done.stderr
    done = scale("--collect", "--output", output)
    assert done.returncode == 0, done.stdout + done.stderr
    content = content_of(output)
    assert content["hashes"]["equal"] and row(content, 1)["counts"]["per_cycle"]["all"]["cycles"] > 0
    written = json.loads((output / "jobs" / "ranks_1" / "slurm" / "logs" / "machine.json").read_text())
    assert content["machine"] == written and written["cpu"]
    done = scale(tmp_path / "input.yaml", "--ranks", "1", "--repeats", "2", "--slurm", "--output", output)
    assert "all runs on 1 ranks are done" in done.stdout


def test_a_queued_array_is_not_written_again(tmp_path, cluster):  # noqa: F811
    words = [write_input(tmp_path), "--ranks", "1", "--repeats", "1", "--slurm", "--output", tmp_path / "out"]
    assert scale(*words, "--submit", environment=cluster).returncode == 0
    (tmp_path / "cluster" / "queue").write_text("4711_0 normal study RUNNING\n")
    done = scale(*words, environment=cluster)
    assert done.returncode == 1 and "is still in the queue" in done.stderr
    assert os.path.exists(tmp_path / "out" / "jobs" / "ranks_1" / "slurm" / "job_id")
