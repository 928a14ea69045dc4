"""Runs points on this machine, several at a time, and ends them cleanly when it is told to stop."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import time
from pathlib import Path

from marked_yaml import Hindered
from point_folder import DONE, INTERRUPTED, UNFINISHED, PointFolder, write_whole

LIBC = ctypes.CDLL(None)
PR_SET_PDEATHSIG = 1
# What an MPI launcher tells its ranks. A run that is started from within a rank must not take itself for one.
OF_RANKS = ("OMPI_COMM_WORLD_", "OMPI_UNIVERSE_", "PMIX_", "PMI_", "OMPI_MCA_orte_", "OMPI_MCA_ess_", "OMPI_MCA_pmix")


def binary_of_kerf() -> Path:
    given = os.environ.get("KERF_BINARY")
    build = os.environ.get("KERF_BUILD_DIR") or Path(__file__).resolve().parents[2] / "build"
    path = Path(given).resolve() if given else Path(build).resolve() / "bin" / "kerf"
    if not os.access(path, os.X_OK):
        raise Hindered(f"{path}: error: the program is not there; ./kerf build makes it, or set KERF_BINARY")
    return path


def clean_environment() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if not name.startswith(OF_RANKS)}


def stop_with_parent() -> None:
    """In the child: a run whose study is killed saves its state and ends, too."""
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0)


class Run:
    """One run that has been started."""

    def __init__(self, folder: PointFolder, binary, ranks: int):
        self.folder, self.began = folder, time.monotonic()
        state = folder.state()
        goes_on = state.status in (INTERRUPTED, UNFINISHED) and folder.can_resume()
        folder.prepare(afresh=not goes_on)
        self.digest = folder.digest()
        command = folder.command(binary, ranks) + (["--resume"] if goes_on else [])
        with (folder.path / "run.log").open("wb") as out, (folder.path / "errors.log").open("wb") as errors:
            try:
                self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=errors,
                                                env=clean_environment(), start_new_session=True,
                                                preexec_fn=stop_with_parent)
            except OSError as error:
                raise Hindered(f"{command[0]}: error: the command cannot be started: {error.strerror}; expected a "
                               "program that starts the run") from error

    def ended(self) -> bool:
        code = self.process.poll()
        if code is None:
            return False
        if self.folder.digest() != self.digest:
            # Which of the two inputs Kerf has read is not known.
            with (self.folder.path / "errors.log").open("a") as errors:
                errors.write("error: the input was changed while the run began or went on; run the point again\n")
            code = 1
        write_whole(self.folder.path / "exit_code", f"{code if code >= 0 else 128 - code}\n")
        return True

    def stop(self, kill: bool) -> None:
        if kill:
            os.killpg(self.process.pid, signal.SIGKILL)
        else:
            self.process.terminate()


class Runner:
    """Keeps `jobs` runs going. SIGINT and SIGTERM end all of them with their state saved; a second one kills them."""

    def __init__(self, binary, ranks: int, jobs: int, say):
        self.binary, self.ranks, self.jobs, self.say = binary, ranks, jobs, say
        self.signals = 0

    def _note_signal(self, *_) -> None:
        self.signals += 1

    def run(self, folders: list[PointFolder]) -> bool:
        """Runs all points, whatever becomes of single ones. Returns whether it came to its end without a signal."""
        before = {number: signal.signal(number, self._note_signal) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            return self._loop(list(folders))
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def _loop(self, waiting: list[PointFolder]) -> bool:
        total, n_ended, told, running = len(waiting), 0, 0, []
        while running or (waiting and not self.signals):
            while waiting and len(running) < self.jobs and not self.signals:
                running.append(Run(waiting.pop(0), self.binary, self.ranks))
            if self.signals > told:
                self.say("stopping: running points save their state" if told == 0 else "stopping at once")
                for run in running:
                    run.stop(kill=told > 0)
                told = self.signals
            ended = [run for run in running if run.ended()]
            running = [run for run in running if run not in ended]
            for run in ended:
                n_ended += 1
                self._tell(run, n_ended, total)
            if not ended:
                time.sleep(0.05)
        return self.signals == 0

    def _tell(self, run: Run, number: int, total: int) -> None:
        state = run.folder.state()
        values = ", ".join(f"{name} = {value.text}" for name, value in run.folder.point.values.items())
        what = "completed" if state.status == DONE else f"{state.status} ({state.exit_code}): {state.message}"
        self.say(f"[{number}/{total}] {values or run.folder.name}: {what}, {time.monotonic() - run.began:.1f} s")


def usual_jobs(ranks: int) -> int:
    """As many runs as the cores that this process may use can take."""
    return max(1, len(os.sched_getaffinity(0)) // ranks)
