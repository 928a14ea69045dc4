"""The folder of one point: what is to be run there, with which files, and what has become of it.

point.json   the point: values, settings, digest of everything that decides the result. Written before a run
exit_code    of the last run in the folder. Absent while it runs, and after a kill
run.log, errors.log   what the run printed
The rest is written by Kerf. A point is done when exit_code is 0, summary.json says `completed`, and the digest is that
of today's study and input.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import re
import shutil
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from marked_yaml import Hindered
from study import Point, Study

DONE, FAILED, INTERRUPTED, UNFINISHED, MISSING = "done", "failed", "interrupted", "unfinished", "missing"


@dataclass
class State:
    """What has become of a point."""

    status: str
    exit_code: int | None = None
    exit: str = ""  # the exit reason of summary.json
    message: str = ""
    summary: dict | None = None


def hash_of_file(file: Path) -> str:
    """SHA-256 of a file, as `sha256sum` prints it. A file is read again only when it was written again."""
    facts = file.stat()
    return _hash_of_file(file, facts.st_mtime_ns, facts.st_size, facts.st_ino)


@lru_cache(maxsize=1000)
def _hash_of_file(file: Path, *_) -> str:
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def write_whole(path: Path, text: str) -> None:
    """Writes a file so that a reader sees all of it or the earlier one."""
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    part.write_text(text, encoding="utf-8")
    os.replace(part, path)


def name_of(point: Point) -> str:
    """A folder's name that tells the values, and that stays when other points are added to the study."""
    told = "_".join(f"{name}_{value.text}" for name, value in point.values.items())
    told = re.sub(r"[^A-Za-z0-9.+-]+", "_", told).strip("_.")[:60] or "point"
    # A refinement or a new fixed value changes the settings, and with them the point.
    settings = json.dumps(sorted(point.settings.items()))
    return f"{told}-{hashlib.sha256(settings.encode()).hexdigest()[:8]}"


class PointFolder:
    program = "kerf sweep"  # the command whose study this is
    may_resume = True  # whether a run that was cut off goes on from its restart file

    def __init__(self, study: Study, point: Point, output: Path):
        self.study, self.point = study, point
        self.name = name_of(point)
        self.path = output / self.name

    # ---- what decides the result

    def input_files(self) -> list[Path]:
        return [self.study.input.file, *self.study.input.files(list(self.point.settings.values()), self.study.plugins)]

    def digest(self) -> str:
        """Of the input, of every file it names, and of the settings of this point."""
        total = hashlib.sha256(b"kerf sweep 1")
        for file in self.input_files():
            total.update(file.name.encode() + b"\0" + bytes.fromhex(hash_of_file(file)))
        total.update(json.dumps([sorted(self.point.settings.items()), self.study.plugins]).encode())
        return total.hexdigest()

    def command(self, binary: Path, ranks: int) -> list[str]:
        words = [str(binary), "run", str(self.study.input.file), "--output", str(self.path)]
        if ranks > 1:
            words += ["--ranks", str(ranks)]
        for plugin in self.study.plugins:
            words += ["--plugin", plugin]
        for path, text in self.point.settings.items():
            words += ["--set", f"{path}={text}"]
        return words

    def can_resume(self) -> bool:
        return self.may_resume and (self.path / "restart" / "restart.h5").exists()

    # ---- before and after a run

    def prepare(self, afresh: bool) -> None:
        """Makes the folder ready for a run. Without `afresh`, a restart file stays and the run goes on from it."""
        self.path.mkdir(parents=True, exist_ok=True)
        for name in ("exit_code", "summary.json", "run.log", "errors.log"):
            (self.path / name).unlink(missing_ok=True)
        if afresh:
            shutil.rmtree(self.path / "restart", ignore_errors=True)
        values = {name: {"text": v.text, "number": v.number, "unit": v.unit} for name, v in self.point.values.items()}
        text = {"study": str(self.study.file.resolve()), "input": str(self.study.input.file), "values": values,
                "settings": self.point.settings, "plugins": self.study.plugins, "digest": self.digest()}
        write_whole(self.path / "point.json", json.dumps(text, indent=1, ensure_ascii=False) + "\n")

    def state(self) -> State:
        known = read_json(self.path / "point.json")
        if known is None or known.get("digest") != self.digest():
            return State(MISSING, message="" if known is None else "the input has changed since this point was run")
        summary = read_json(self.path / "summary.json")
        reason = str((summary or {}).get("exit", ""))
        try:
            code = int((self.path / "exit_code").read_text())
        except (OSError, ValueError):
            return State(UNFINISHED, None, reason, "no exit code: it runs, waits in a queue, or was killed", summary)
        if code == 0 and reason == "completed":
            return State(DONE, 0, reason, "", summary)
        if code == 4 or (reason == "signal" and code == 1):  # mpirun replaces codes by its own, 1
            return State(INTERRUPTED, code, reason, "stopped by a signal; the next call goes on with it", summary)
        if code == 0:
            return State(FAILED, code, reason, "the exit code is 0, but no summary.json says that the run completed",
                         summary)
        told = self.last_message() if reason in ("", "completed", "signal") else reason
        return State(FAILED, code, reason, told, summary)

    def last_message(self) -> str:
        """The last error line that the run printed, or what the launcher says of its end, or its last line of all."""
        lines = [line.strip() for name in ("run.log", "errors.log") for line in read_lines(self.path / name)]
        lines = [line for line in lines if re.search(r"\w", line)]  # not the rules round a notice
        errors = [line for line in lines if "error:" in line]
        ends = [line for line in lines if re.search(r"exited on signal|[Ee]xit code", line)]
        return (errors or ends or lines or ["nothing was printed"])[-1][:500]

    @contextmanager
    def alone(self):
        """Only one process at a time works in the folder of a point; others wait."""
        self.path.mkdir(parents=True, exist_ok=True)
        with (self.path / "lock").open("a") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            yield


def read_json(path: Path) -> dict | None:
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return value if isinstance(value, dict) else None


def read_lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return []


@contextmanager
def study_alone(output: Path, program: str = "kerf sweep"):
    """One study at a time per output folder. Throws Hindered where another one works there."""
    output.mkdir(parents=True, exist_ok=True)
    with (output / "lock").open("a") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise Hindered(f"{output}: error: another {program} works in this folder; wait for its end, or name "
                           "another folder with --output") from error
        yield


def claim(output: Path, study: Path) -> None:
    """Notes whose folder it is. Throws Hindered where it is that of another study, whose tables would be lost."""
    note = output / "study_file"
    before = "".join(read_lines(note)[:1])
    if before and before != str(study) and Path(before).exists():
        raise Hindered(f"{output}: error: the folder has the results of {before}; expected another --output")
    write_whole(note, f"{study}\n")
