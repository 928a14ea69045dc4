"""What both studies need: runs of Kerf that are kept, tables between markers of a Markdown file, small pictures."""

from __future__ import annotations

import csv
import json
import os
import re
import statistics
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
STUDIES = ROOT / "framework" / "studies"
POST = ROOT / "framework" / "post"
sys.path[:0] = [str(STUDIES), str(POST)]

from local_runs import binary_of_kerf, clean_environment  # noqa: E402
from machine import processor  # noqa: E402
from point_folder import hash_of_file  # noqa: E402

MOST_BYTES = 150_000  # of a picture
OVERSUBSCRIBED = {"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}


class StudyError(Exception):
    """Why a study cannot be made."""


@dataclass(frozen=True)
class Case:
    """A model, and what is set in it."""
    name: str
    input: Path
    settings: tuple[str, ...] = field(default_factory=tuple)


def call(command: list, log: Path) -> None:
    """Runs a program; its output goes to a file, whose end is shown where the program fails."""
    log.parent.mkdir(parents=True, exist_ok=True)
    with log.open("wb") as out:
        done = subprocess.run([*map(str, command)], stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT,
                              env={**clean_environment(), **OVERSUBSCRIBED}, check=False)
    if done.returncode != 0:
        end = "\n".join(log.read_text(errors="replace").splitlines()[-15:])
        raise StudyError(f"{log}: error: `{' '.join(map(str, command))}` ended with {done.returncode}; expected 0\n"
                         f"{end}")


def content_of(word) -> str:
    """What decides the result of a call: of a file its content, of a folder that `once` has made how it was made."""
    if not isinstance(word, Path) or word == binary_of_kerf():
        return ""
    file = word / "made_by.json" if word.is_dir() else word
    return hash_of_file(file) if file.is_file() else ""


def once(command: list, output: Path, result: str) -> Path:
    """Calls a program that writes `result` into the folder `output`, unless the same call has done it before, with the
    same program and the same files."""
    program = binary_of_kerf().stat()
    scripts = max(path.stat().st_mtime_ns for path in STUDIES.glob("*.py")) if STUDIES / "predict.py" in command else 0
    stamp = json.dumps([*map(str, command), *map(content_of, command), program.st_size, program.st_mtime_ns, scripts])
    mark = output / "made_by.json"
    if not (mark.exists() and mark.read_text() == stamp and (output / result).exists()):
        print(f"  {output.name}", flush=True)
        mark.unlink(missing_ok=True)
        call([*command, "--output", output], output.parent / f"{output.name}.log")
        mark.write_text(stamp)
    return output


def words_of(case: Case, *settings: str) -> list:
    words = [case.input]
    for setting in (*case.settings, *settings):
        words += ["--set", setting]
    return words


def run(case: Case, folder: Path, name: str, *settings: str, ranks: int = 1) -> Path:
    """The folder of a run of Kerf."""
    many = ["--ranks", ranks] if ranks > 1 else []
    return once([binary_of_kerf(), "run", *words_of(case, *settings), *many], folder / name, "summary.json")


def partition(case: Case, folder: Path, name: str, parts: list[int], methods: list[str], *options) -> Path:
    command = [binary_of_kerf(), "partition", *words_of(case), "--parts", ",".join(map(str, parts)), "--method",
               ",".join(methods), *options]
    return once(command, folder / name, "partitions.json")


def scale(case: Case, folder: Path, name: str, ranks: list[int], repeats: int, *settings: str) -> Path:
    """Interleaved timed runs."""
    command = [sys.executable, "-B", STUDIES / "scale.py", *words_of(case, *settings), "--ranks",
               ",".join(map(str, ranks)), "--repeats", repeats, "--no-counts", "--side-by-side"]
    return once(command, folder / name, "scale.json")


def predict(recorded: Path, folder: Path, name: str, *options) -> list[dict]:
    """Rows of predict.csv; numbers are floats."""
    once([sys.executable, "-B", STUDIES / "predict.py", recorded, *options], folder / name, "predict.csv")
    return rows_of(folder / name / "predict.csv")


def rows_of(path: Path) -> list[dict]:
    def value(text: str):
        try:
            return float(text)
        except ValueError:
            return text

    with path.open(newline="") as file:
        return [{key: value(text) for key, text in row.items()} for row in csv.DictReader(file)]


def summary_of(run_folder: Path) -> dict:
    return json.loads((run_folder / "summary.json").read_text())


def equal_hashes(folders: dict[int, Path], reference: str | None = None) -> str:
    """The state hash of runs on different numbers of ranks; throws StudyError where one is another."""
    hashes = {ranks: summary_of(folder)["state_hash"] for ranks, folder in folders.items()}
    first = reference or next(iter(hashes.values()))
    if any(found != first for found in hashes.values()):
        raise StudyError(f"state hashes differ: {hashes}; expected {first} on all numbers of ranks")
    return first


def most_lost(row: dict, n: int) -> str:
    """The causes that cost most in a row of predict.csv, and their shares of the time."""
    lost = sorted(((v, k) for k, v in row.items() if k.startswith("lost_") and v), reverse=True)[:n]
    return "; ".join(f"{name.removeprefix('lost_').replace('_', ' ')} {100 * share:.1f} %" for share, name in lost)


def table(head: list[str], rows: list[list]) -> str:
    """A table of Markdown; floats have three digits behind the point."""
    def word(value) -> str:
        return f"{value:.3f}" if isinstance(value, float) else str(value)

    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(map(word, row)) + " |" for row in rows])


def put_tables(page: Path, tables: dict[str, str]) -> None:
    """Replaces what stands between `<!-- table: NAME -->` and `<!-- end -->`; every table has exactly one place."""
    text = page.read_text(encoding="utf-8")
    pattern = re.compile(r"(<!-- table: (\w+) -->\n).*?(<!-- end -->)", re.S)
    places = [match.group(2) for match in pattern.finditer(text)]
    if sorted(places) != sorted(tables):
        raise StudyError(f"{page}: error: places for the tables {sorted(places)}; expected one for each of "
                         f"{sorted(tables)}")
    page.write_text(pattern.sub(lambda m: m.group(1) + tables[m.group(2)] + "\n" + m.group(3), text), encoding="utf-8")


def save_small(source, path: Path, width: int = 1200) -> None:
    """A figure of matplotlib or a picture in a file, with few enough colours for MOST_BYTES."""
    from PIL import Image

    if not isinstance(source, Path):
        source.savefig(path, dpi=100)
        source = path
    image = Image.open(source).convert("RGB")
    if image.width > width:
        image = image.resize((width, image.height * width // image.width), Image.Resampling.LANCZOS)
    for colours in (128, 64, 32):
        image.quantize(colours, dither=Image.Dither.NONE).save(path, optimize=True)
        if path.stat().st_size < MOST_BYTES:
            return
    raise StudyError(f"{path}: error: {path.stat().st_size} bytes; expected less than {MOST_BYTES}")


def machine() -> str:
    """The processor, and how busy it is."""
    return f"{processor() or 'unknown processor'}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}"


median = statistics.median
