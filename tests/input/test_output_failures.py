"""Output that fails for real, not by a preloaded fault: the run stops on all ranks and names the file and the cause."""

import os
import resource
import shutil
import subprocess
from pathlib import Path

import pytest

from input_case import KERF, kerf, on_ranks, settings, summary_of
from test_failures import LONG, PLAIN, descendants, frames, start


@pytest.fixture
def case(tmp_path):
    (tmp_path / "case.yaml").write_text(PLAIN)
    return tmp_path


def run(case, ranks, changes=None, **options):
    words = [KERF, "run", "case.yaml", "--output", "out", *map(str, on_ranks(ranks)), *settings(changes or {})]
    return subprocess.run(words, cwd=case, stderr=subprocess.PIPE, text=True, timeout=60, **options)


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_limit_of_the_file_size(ranks, case):
    """The limit comes as a signal, too, which must not end the program."""
    process = start(case, ranks, LONG | {"time.end": "1 s"})
    there = (case / "out" / "results.vtkhdf").stat().st_size
    for pid in descendants(process.pid):
        if Path(f"/proc/{pid}/comm").read_text().strip() == "kerf":  # not mpirun, which has files of its own
            resource.prlimit(pid, resource.RLIMIT_FSIZE, (there + 100_000, there + 100_000))
    _, err = process.communicate(timeout=60)
    assert process.returncode == 1
    assert err.count('case.yaml: error: the run stopped: cannot write "out/results.vtkhdf": File too large') == 1
    assert len(frames(case / "out")) >= 1
    assert "File too large" in summary_of(case / "out")["exit"], "there is room for a small file"


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_folder_that_is_removed(ranks, case):
    process = start(case, ranks, LONG | {"time.end": "1 s", "output.history_interval": "0.1 us"})
    shutil.rmtree(case / "out")
    _, err = process.communicate(timeout=60)
    assert process.returncode == 1, err
    assert "case.yaml: error: the run stopped: cannot " in err
    assert "somebody has removed it" in err or "No such file or directory" in err


def test_a_standard_output_that_is_closed(case):
    done = run(case, 1, preexec_fn=lambda: os.close(1))
    assert done.returncode == 1
    assert done.stderr == ("case.yaml: error: the run stopped: cannot write to the standard output: "
                           "Bad file descriptor\n")
    assert len(frames(case / "out")) == 1, "nothing that is printed ends in a file of results"


def test_a_pipe_that_nobody_reads_any_more(case):
    process = start(case, 1, LONG | {"time.end": "1 s"})
    process.stdout.close()
    err = process.stderr.read()
    assert process.wait(timeout=60) == 1
    assert err == "case.yaml: error: the run stopped: cannot write to the standard output: Broken pipe\n"
    assert len(frames(case / "out")) >= 1


def test_a_standard_error_that_is_closed(case):
    """There is nobody to tell; the exit code still tells."""
    done = run(case, 1, {"time.minimum_step": "170 ns"}, stdout=subprocess.DEVNULL,
               preexec_fn=lambda: os.close(2))
    assert done.returncode == 3


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_damaged_restart_file(ranks, case):
    """The one before it is taken, with a note; without that the run refuses."""
    few = settings(LONG | {"time.end": "0.6 us", "output.restart_interval": "0.2 us"})
    assert kerf("run", "case.yaml", "--output", "out", *few, cwd=case).returncode == 0
    restart = case / "out" / "restart"
    whole = summary_of(case / "out")["state_hash"]
    previous = restart / "restart_previous.h5"
    for damaged in (restart / "restart.h5", previous):
        data = bytearray(damaged.read_bytes())
        data[len(data) // 2] ^= 16
        damaged.write_bytes(data)
        done = kerf("run", "case.yaml", "--output", "out", "--resume", *on_ranks(ranks), *few, cwd=case)
        if damaged == previous:
            break
        assert done.returncode == 0, done.stderr
        assert done.stdout.count('note: "out/restart/restart.h5" is damaged: ') == 1
        assert "going on from the restart file before it, out/restart/restart_previous.h5" in done.stdout
        assert summary_of(case / "out")["state_hash"] == whole
        assert (restart / "restart_damaged.h5").exists(), "to be looked at"
        (restart / "restart.h5").write_bytes(data)
    assert done.returncode == 2
    assert "there is no restart file that can be used: \"out/restart/restart.h5\" is damaged: " in done.stderr
