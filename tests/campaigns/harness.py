"""What the campaigns share: the tiny model, runs with a fault in them, and a look at what they left behind."""

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
BUILD = Path(os.environ.get("KERF_BUILD_DIR", SOURCE / "build")).resolve()
KERF = str(Path(os.environ.get("KERF_BINARY", BUILD / "bin" / "kerf")).resolve())
SHIM = os.environ.get("KERF_FAULT_SHIM", str(BUILD / "tests" / "libkerf_fault_shim.so"))
TINY = HERE / "tiny.yaml"
HANG = 60  # seconds; a run takes a tenth of a second on one rank and a second on two
MPIRUN = ["mpirun", "--oversubscribe", "--allow-run-as-root", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1"]


@dataclass
class Report:
    """Counts of what happened, and the cases that must not happen."""

    name: str
    counts: Counter = field(default_factory=Counter)
    faults: list = field(default_factory=list)

    def __post_init__(self):
        Report.latest = self

    def passed(self, what):
        self.counts[what] += 1

    def failed(self, case, what):
        self.counts["WRONG"] += 1
        self.faults.append(f"{case}: {what}")
        print(f"{self.name}: WRONG: {case}: {what}", flush=True)

    def text(self):
        total = sum(self.counts.values())
        lines = [f"{self.name}: {total} cases"] + [f"  {n:7d}  {what}" for what, n in sorted(self.counts.items())]
        return "\n".join(lines)


@dataclass
class Ended:
    code: int
    out: str
    err: str
    hung: bool = False

    def signal(self):
        """The name of the signal that ended the program, or of one that mpirun tells of; None without."""
        if self.code < 0:
            return signal.Signals(-self.code).name
        return "signal" if "exited on signal" in self.out + self.err else None


def descendants(pid):
    """A process and all that it started."""
    text = subprocess.run(["ps", "-e", "-o", "pid=,ppid="], capture_output=True, text=True).stdout
    parents = [tuple(map(int, line.split())) for line in text.splitlines()]
    found = [pid]
    for p in found:
        found += [child for child, parent in parents if parent == p]
    return found


def kill_all(process):
    for pid in descendants(process.pid):
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass


def command_of(folder, ranks, words=(), fault=None):
    """The words that run the tiny model in `folder`. A fault is a dictionary of KERF_FAULT_* without that prefix."""
    program = [KERF, "run", str(folder / "case.yaml"), "--output", str(folder / "out"), *words]
    if fault is not None:
        settings = {"FOLDER": str(folder / "out"), **fault}
        program = ["env", f"LD_PRELOAD={SHIM}", *(f"KERF_FAULT_{k}={v}" for k, v in settings.items()), *program]
    return [*MPIRUN, "-n", str(ranks), *program] if ranks > 1 else program


def start(folder, ranks, words=(), fault=None):
    environment = {**os.environ, "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_orte_execute_quiet": "1"}
    return subprocess.Popen(command_of(folder, ranks, words, fault), cwd=folder, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, errors="replace", env=environment)


def run(folder, ranks=1, words=(), fault=None, patience=HANG):
    process = start(folder, ranks, words, fault)
    try:
        out, err = process.communicate(timeout=patience)
        return Ended(process.returncode, out, err)
    except subprocess.TimeoutExpired:
        kill_all(process)
        out, err = process.communicate()
        return Ended(process.returncode, out, err, hung=True)


@contextmanager
def workplace():
    folder = Path(tempfile.mkdtemp(prefix="kerf_campaign_"))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def fresh(parent, name="case"):
    """A new folder with the tiny model in it."""
    folder = parent / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    shutil.copy(TINY, folder / "case.yaml")
    return folder


def in_a_process_of_its_own(work):
    """Calls work() in a child. Returns what is wrong: an exception's text, a signal's name, or an empty text."""
    sys.stdout.flush()
    reading, writing = os.pipe()
    pid = os.fork()
    if pid == 0:
        try:
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, signal.SIG_DFL)
            os.close(reading)
            work()
        except BaseException as e:  # all that can go wrong is told to the parent
            os.write(writing, f"{type(e).__name__}: {e}".encode()[:2000])
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        text = pipe.read().decode(errors="replace")
    _, status = os.waitpid(pid, 0)
    if os.WIFSIGNALED(status):
        return f"the reader ended by {signal.Signals(os.WTERMSIG(status)).name}"
    return text


def tables_of(path):
    """All datasets and attributes of an HDF5 file, read with h5py."""
    import h5py

    found = {}
    with h5py.File(path) as file:
        def keep(name, item):
            if isinstance(item, h5py.Dataset):
                found[name] = item[()]
            for key, value in item.attrs.items():
                found[f"{name}@{key}"] = value
        file.visititems(keep)
    return found


class Reference:
    """An undisturbed run of the tiny model, and what other runs may look like beside it."""

    def __init__(self, parent):
        self.folder = fresh(parent, "reference")
        done = run(self.folder)
        assert done.code == 0, done.out + done.err
        out = self.folder / "out"
        self.hash = json.loads((out / "summary.json").read_text())["state_hash"]
        self.tables = tables_of(out / "results.vtkhdf")
        self.rows = {name: (out / name).read_text().splitlines() for name in ("history.csv", "erosion.csv")}
        self.n_frames = len(self.tables["VTKHDF/Steps/Values"])
        assert self.n_frames >= 3 and all(len(rows) > 2 for rows in self.rows.values())

    def complaint(self, out):
        """What is wrong with the files in a folder of output; an empty text where nothing is."""
        results = out / "results.vtkhdf"
        if results.exists():
            wrong = in_a_process_of_its_own(lambda: self._check_results(results))
            if wrong:
                return f"results.vtkhdf: {wrong}"
        try:
            for name, rows in self.rows.items():
                if (out / name).exists():
                    self._check_rows((out / name).read_text(), rows, name)
            if (out / "summary.json").exists():
                summary = json.loads((out / "summary.json").read_text())
                if summary["exit"] == "completed" and summary["state_hash"] != self.hash:
                    return "summary.json: another state"
        except (AssertionError, ValueError, KeyError) as e:
            return str(e)
        return ""

    def _check_results(self, path):
        """Every frame with the reader of ParaView, and every byte against the undisturbed run."""
        import numpy as np
        from vtkmodules.vtkIOHDF import vtkHDFReader

        reader = vtkHDFReader()
        reader.SetFileName(str(path))
        assert reader.CanReadFile(str(path)), "VTK refuses it"
        reader.UpdateInformation()
        n = reader.GetNumberOfSteps()
        for step in range(n):
            reader.SetStep(step)
            reader.Update()
            assert reader.GetOutput().GetNumberOfCells() == len(self.tables["VTKHDF/Types"])
        tables = tables_of(path)
        assert tables["VTKHDF/Steps@NSteps"] == n == len(tables["VTKHDF/Steps/Values"]), "steps do not agree"
        assert 1 <= n <= self.n_frames
        assert set(tables) == set(self.tables)
        for name, expected in self.tables.items():
            if "@" in name:
                continue
            found, rows = tables[name], len(expected)
            grows = rows % self.n_frames == 0 and len(found) == rows // self.n_frames * n
            assert np.array_equal(found, expected[:len(found)] if grows else expected), f"{name} differs"

    @staticmethod
    def _check_rows(text, rows, name):
        """Complete lines are those of the undisturbed run."""
        lines = text.split("\n")[:-1]  # what follows the last end of line was cut off
        assert lines and lines[0] == rows[0], f"{name} has no header"
        header = next(csv.reader([rows[0]]))
        width = len(header)
        # The imbalance is that of the ranks, whose number differs.
        compared = [i for i, column in enumerate(header) if not column.startswith("imbalance")]
        for number, (found, expected) in enumerate(zip(lines, rows)):
            cells, wanted = next(csv.reader([found])), next(csv.reader([expected]))
            assert len(cells) == width and [cells[i] for i in compared] == [wanted[i] for i in compared], \
                f"{name}, line {number + 1}: {found}"
        assert all(len(next(csv.reader([line]))) == width for line in lines), f"{name} has a broken line"

    def resume(self, folder, ranks=1):
        """Goes on with a run. Returns what is wrong; an empty text for the right end or for a refusal."""
        had = any((folder / "out" / "restart" / f"restart{kind}.h5").exists() for kind in ("", "_previous"))
        done = run(folder, ranks, ["--resume"])
        if done.hung or done.signal():
            return f"resuming: {done.signal() or 'hangs'}"
        if not had:
            return "" if done.code == 2 and "there is no restart file" in done.err else f"resuming: {done.code}"
        if done.code != 0:
            return f"resuming: exit code {done.code}: {done.err[-300:]}"
        summary = json.loads((folder / "out" / "summary.json").read_text())
        if summary["state_hash"] != self.hash:
            return "resuming: another state: SILENT"
        return self.complaint(folder / "out")


def count_calls(folder, ranks, words=()):
    """The number of output calls of each rank in an undisturbed run."""
    done = run(folder, ranks, words, {"COUNT": folder / "count"})
    assert done.code == 0, done.out + done.err
    return [int((folder / f"count.{r}").read_text()) for r in range(ranks)]


def every(n, short, few):
    """1 to n; a spread of `few` of them where `short`. The spread moves on from day to day."""
    if not short or n <= few:
        return list(range(1, n + 1))
    first = int(time.time() / 86400) % max(1, n // few)
    return sorted({min(n, 1 + first + i * n // few) for i in range(few)})
