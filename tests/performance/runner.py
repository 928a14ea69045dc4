"""Runs the program once, or several times side by side, and reads what a run says about itself."""

from __future__ import annotations

import json
import os
import shutil
import signal
import statistics
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class BenchError(RuntimeError):
    """A run that failed, with the end of its output."""


@dataclass(frozen=True)
class Case:
    """An input file with values replaced."""

    name: str
    input: str  # relative to inputs/
    overrides: tuple[str, ...] = ()
    ranks: int = 1

    def command(self, binary: str, output: Path) -> list[str]:
        words = [binary, "run", str(ROOT / "inputs" / self.input), "--output", str(output)]
        for override in self.overrides:
            words += ["--set", override]
        return words + (["--ranks", str(self.ranks)] if self.ranks > 1 else [])


@dataclass
class Run:
    """What one run said and took."""

    summary: dict
    startup: float  # from the start of the process to the first cycle [s]
    wall: float  # of the whole process [s]
    peak_memory: int  # resident, largest process [bytes]
    result_bytes: int  # size of results.vtkhdf
    copy_seconds: float | None = None  # of copying results.vtkhdf on the same disk, best of three

    @property
    def rate(self) -> float:
        return self.summary["element_cycles_per_second"]

    @property
    def element_phase_rate(self) -> float:
        return self.summary["element_cycles"] / self.summary["ranks"] / max(self.timer("elements"), 1e-9)

    @property
    def elements(self) -> int:
        return sum(part["elements"] for part in self.summary["parts"].values())

    def timer(self, phase: str) -> float:
        return self.summary["timers"].get(phase, {}).get("mean", 0.0)

    @property
    def total_seconds(self) -> float:
        """The run with its output and without its set-up."""
        return self.summary["wall_seconds"] + self.timer("output")


@dataclass
class _Started:
    case: Case
    output: Path
    process: subprocess.Popen
    began: float
    startup: float | None = None
    lines: list[str] = field(default_factory=list)


class Runner:
    """Starts runs below one scratch folder; each leaves nothing behind."""

    def __init__(self, scratch: Path):
        self._scratch = scratch
        self._count = 0
        self._running: list[subprocess.Popen] = []

    @property
    def scratch(self) -> Path:
        return self._scratch

    def run(self, binary: str, case: Case, copy: bool = False) -> Run:
        if copy:
            os.sync()  # what earlier runs have left to the disk is not this one's
        return self._finish(self._start(binary, case), copy)

    def side_by_side(self, binary: str, cases: list[Case]) -> list[Run]:
        """Independent runs that compete for the machine, as jobs of several users would."""
        started = [self._start(binary, case) for case in cases]
        return [self._finish(one, False) for one in started]

    def stop(self) -> None:
        """Ends what still runs after an interruption, ranks included: mpirun passes the signal on."""
        for process in self._running:
            os.killpg(process.pid, signal.SIGTERM)
            process.wait()

    def _start(self, binary: str, case: Case) -> _Started:
        self._count += 1
        output = self._scratch / f"{self._count:04d}"
        began = time.perf_counter()
        process = subprocess.Popen(case.command(binary, output), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   text=True, bufsize=1, process_group=0)
        self._running.append(process)
        return _Started(case, output, process, began)

    def _finish(self, one: _Started, copy: bool) -> Run:
        for line in one.process.stdout:
            one.lines.append(line)
            if one.startup is None and "first stable step" in line:
                one.startup = time.perf_counter() - one.began
        one.process.stdout.close()
        # wait4 tells this process's memory; subprocess would only tell that of all children together.
        _, status, usage = os.wait4(one.process.pid, 0)
        one.process.returncode = os.waitstatus_to_exitcode(status)
        self._running.remove(one.process)
        wall = time.perf_counter() - one.began
        summary_file = one.output / "summary.json"
        if one.process.returncode != 0 or not summary_file.is_file():
            end = "".join(one.lines[-15:])
            raise BenchError(f"{one.case.name}: exit code {one.process.returncode}\n"
                             f"{' '.join(one.case.command('kerf', one.output))}\n{end}")
        results = one.output / "results.vtkhdf"
        run = Run(json.loads(summary_file.read_text()), one.startup or 0.0, wall, usage.ru_maxrss * 1024,
                  results.stat().st_size, copy_seconds(results) if copy else None)
        shutil.rmtree(one.output)
        return run


def copy_seconds(file: Path) -> float:
    """A copy that is safe on the disk at its end, as every frame is."""
    times = []
    twin = file.with_suffix(".copy")
    for _ in range(3):
        os.sync()
        began = time.perf_counter()
        with open(twin, "wb") as copy:
            copy.write(file.read_bytes())
            os.fsync(copy.fileno())
        times.append(time.perf_counter() - began)
        twin.unlink()
    return min(times)


@dataclass
class Samples:
    """Repeats of one number."""

    values: list[float]

    @property
    def median(self) -> float:
        return statistics.median(self.values)

    @property
    def spread(self) -> float:
        """Half the range over the median."""
        return 0.5 * (max(self.values) - min(self.values)) / abs(self.median) if self.median else 0.0

    def as_json(self) -> dict:
        return {"median": self.median, "spread": self.spread, "values": self.values}
