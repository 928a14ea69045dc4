"""Job arrays for Slurm: scripts are written, run here by a stand-in for sbatch, and collected."""

import os
import subprocess

import pytest
from study_case import STUDY, summaries, sweep, table, write

POINTS = "points: {type: grid, axes: {speed: [100 m/s, 150 m/s, 200 m/s]}}\n"

# What Slurm does with an array, one task after the other; srun starts one rank here.
SBATCH = """#!/usr/bin/env bash
[[ "$1" == --parsable ]] && shift
array="$(sed -n 's/^#SBATCH --array=//p' "$1")"
range="${array%\\%*}"
for ((SLURM_ARRAY_TASK_ID = ${range%-*}; SLURM_ARRAY_TASK_ID <= ${range#*-}; ++SLURM_ARRAY_TASK_ID)); do
  export SLURM_ARRAY_TASK_ID
  bash "$1" >&2
done
echo 4711
"""
SRUN = """#!/usr/bin/env bash
[[ "$1" == --ntasks=* ]] || exit 64
echo "$1" >>"$(dirname "$0")/srun_calls"
shift
exec "$@"
"""


@pytest.fixture
def cluster(tmp_path):
    """An environment in which sbatch, srun and squeue are ours."""
    folder = tmp_path / "cluster"
    folder.mkdir()
    squeue = '#!/bin/sh\ncat "$(dirname "$0")/queue"\n'
    for name, text in {"sbatch": SBATCH, "srun": SRUN, "squeue": squeue}.items():
        (folder / name).write_text(text)
        (folder / name).chmod(0o755)
    (folder / "queue").write_text("")
    return {"PATH": f"{folder}:{os.environ['PATH']}"}


def test_an_array_is_written_and_nothing_is_run(tmp_path):
    study = write(tmp_path, POINTS, "ranks: 16\n")
    done = sweep(study, "--slurm", "--jobs", "2")
    assert done.returncode == 0, done.stderr
    script = (tmp_path / "out" / "slurm" / "array.sh").read_text()
    assert "#SBATCH --array=0-2%2\n" in script and "#SBATCH --ntasks=16\n" in script and "@" not in script.replace(
        "TERM@300", "")
    assert not summaries(study)
    assert len((tmp_path / "out" / "slurm" / "points.txt").read_text().splitlines()) == 3
    for path in (tmp_path / "out").glob("*/run.sh"):
        assert "srun --ntasks=16 " in path.read_text() and "--ranks" not in path.read_text()
        assert subprocess.run(["bash", "-n", path]).returncode == 0


def test_before_the_array_has_run_nothing_is_there(tmp_path):
    study = write(tmp_path, POINTS)
    sweep(study, "--slurm")
    assert sweep(study, "--collect").returncode == 4
    assert [point["flags"] for point in table(study)] == [["unfinished"]] * 3


def test_an_array_is_run_and_collected(tmp_path, cluster):
    study = write(tmp_path, POINTS)
    done = sweep(study, "--slurm", "--submit", environment=cluster)
    assert done.returncode == 0 and "submitted as job 4711" in done.stdout, done.stdout + done.stderr
    assert (tmp_path / "cluster" / "srun_calls").read_text().split() == ["--ntasks=1"] * 3
    done = sweep(study, "--collect")
    assert done.returncode == 0, done.stdout
    of_slurm = [(point["state_hash"], point["results"]) for point in table(study)]
    # The same points, run on this machine.
    (tmp_path / "here").mkdir()
    here = write(tmp_path / "here", POINTS)
    sweep(here)
    assert [(point["state_hash"], point["results"]) for point in table(here)] == of_slurm
    # What is done is not submitted again.
    assert "all points are done" in sweep(study, "--slurm").stdout


def test_a_point_that_fails_stands_in_the_table(tmp_path, cluster):
    study = write(tmp_path, "points: {type: grid, axes: {strength: [300 MPa, -1 MPa]}}\n")
    sweep(study, "--slurm", "--submit", environment=cluster)
    done = sweep(study, "--collect")
    assert done.returncode == 3
    assert [point["exit_code"] for point in table(study)] == [0, 2]
    assert "is out of range" in table(study)[1]["message"]
    sweep(study, "--slurm")
    assert len((tmp_path / "out" / "slurm" / "points.txt").read_text().splitlines()) == 1


def test_an_input_that_changed_in_the_queue_is_not_run(tmp_path, cluster):
    study = write(tmp_path, POINTS)
    sweep(study, "--slurm")
    (tmp_path / "input.yaml").write_text((tmp_path / "input.yaml").read_text() + "# changed\n")
    array = tmp_path / "out" / "slurm" / "array.sh"
    subprocess.run([tmp_path / "cluster" / "sbatch", array], env={**os.environ, **cluster}, capture_output=True)
    assert not summaries(study)
    for path in (tmp_path / "out").glob("*/errors.log"):
        assert "has changed since the scripts were written" in path.read_text()
    assert sweep(study, "--collect").returncode != 0


def test_a_job_that_is_in_the_queue_is_not_submitted_again(tmp_path, cluster):
    study = write(tmp_path, POINTS, "set: {time.minimum_step: 1 us}\n")
    sweep(study, "--slurm", "--submit", environment=cluster)
    (tmp_path / "cluster" / "queue").write_text("4711_0 normal study RUNNING\n")
    done = sweep(study, "--slurm", environment=cluster)
    assert done.returncode == 1 and "job 4711 of this study is still in the queue" in done.stderr


def test_a_folder_with_a_blank_is_refused(tmp_path):
    folder = tmp_path / "with a blank"
    folder.mkdir()
    done = sweep(write(folder, POINTS), "--slurm")
    assert done.returncode == 1 and "cannot name a folder with a blank; expected another --output" in done.stderr


def test_the_folder_of_another_study_is_refused(tmp_path):
    assert sweep(write(tmp_path, POINTS), "--slurm").returncode == 0
    (tmp_path / "other").mkdir()
    done = sweep(write(tmp_path / "other", POINTS), "--slurm", "--output", tmp_path / "out")
    assert done.returncode == 1 and f"has the results of {tmp_path / 'study.yaml'}; expected another" in done.stderr


def test_a_template_of_the_user_is_filled_in(tmp_path):
    (tmp_path / "mine.sh").write_text("#!/bin/bash\n#SBATCH --array=@ARRAY@ --account=steel\nmodule load kerf\n@RUN@\n")
    study = write(tmp_path, POINTS, "slurm: {template: mine.sh, launch: mpiexec -n @RANKS@}\nranks: 4\n")
    assert sweep(study, "--slurm").returncode == 0
    script = (tmp_path / "out" / "slurm" / "array.sh").read_text()
    assert "#SBATCH --array=0-2 --account=steel\nmodule load kerf\n" in script
    assert "mpiexec -n 4 " in next((tmp_path / "out").glob("*/run.sh")).read_text()


@pytest.mark.parametrize("text, sentence", [
    ("#SBATCH --array=@ARRAY@\n@RUN@ @TASKS@\n", "mine.sh:2: error: there is no @TASKS@; expected one of @NAME@"),
    ("#SBATCH --array=@ARRAY@\n", "mine.sh: error: @RUN@ is missing")])
def test_a_bad_template_is_refused(tmp_path, text, sentence):
    (tmp_path / "mine.sh").write_text(text)
    done = sweep(write(tmp_path, POINTS, "slurm: {template: mine.sh}\n"), "--slurm")
    assert done.returncode == 2 and sentence in done.stderr
    assert not list((tmp_path / "out").glob("*/run.sh"))


def test_without_slurm_submitting_is_refused(tmp_path):
    done = sweep(write(tmp_path, POINTS, study=STUDY), "--slurm", "--submit", environment={"PATH": "/nowhere"})
    assert done.returncode == 1 and "sbatch cannot be started" in done.stderr
