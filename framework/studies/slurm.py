"""Writes the points of a study as a Slurm job array: one script for the array, and one for each point.

A point's script needs no Python on the cluster's nodes. It compares the input files with their checksums first, so that
a result never belongs to another input than the study says.
"""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from pathlib import Path

from marked_yaml import Hindered, StudyError
from point_folder import INTERRUPTED, UNFINISHED, PointFolder, hash_of_file, write_whole

TEMPLATE = Path(__file__).with_name("slurm_template.sh")
PLACES = ("NAME", "ARRAY", "RANKS", "LOGS", "RUN")

POINT = """#!/usr/bin/env bash
# One run of a study, written by `{program} --slurm`. It leaves its exit code in the file exit_code.
set -u
here={here}
rm -f -- "$here/exit_code" "$here/summary.json"
code=0
if ! sha256sum --check --status -- "$here/files.sha256" >"$here/run.log" 2>"$here/errors.log"; then
  echo 'error: the input, or a file that it names, has changed since the scripts were written;' \\
    'write them again with {program} --slurm' >"$here/errors.log"
  code=2
else
  goes_on=()
{resume}  {command} ${{goes_on[@]+"${{goes_on[@]}}"}} >"$here/run.log" 2>"$here/errors.log"
  code=$?
fi
printf '%s\\n' "$code" >"$here/exit_code.part" && mv -- "$here/exit_code.part" "$here/exit_code"
exit "$code"
"""

RESUME = """  # A restart file in this folder was written by this same point.
  [[ -f "$here/restart/restart.h5" ]] && goes_on=(--resume)
"""

RUN = """folder="$(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" {points})"
exec bash "$folder/run.sh"
"""


def filled(text: str, values: dict[str, str], file: Path) -> str:
    """The template with its @PLACES@ filled in. Throws StudyError for names that there are not."""
    unknown = [(i, name) for i, line in enumerate(text.splitlines(), 1) for name in re.findall(r"@([A-Z_]+)@", line)
               if name not in PLACES]
    if unknown:
        raise StudyError(*(f"{file}:{i}: error: there is no @{name}@; expected one of "
                           + ", ".join(f"@{place}@" for place in PLACES) for i, name in unknown))
    missing = [name for name in ("ARRAY", "RUN") if f"@{name}@" not in text]
    if missing:
        raise StudyError(*(f"{file}: error: @{name}@ is missing; expected it once in the template of a job array"
                           for name in missing))
    return re.sub(r"@([A-Z_]+)@", lambda match: values[match.group(1)], text)


def write_point(folder: PointFolder, binary: Path) -> None:
    goes_on = folder.state().status in (INTERRUPTED, UNFINISHED) and folder.can_resume()
    folder.prepare(afresh=not goes_on)
    sums = "".join(f"{hash_of_file(file)}  {file}\n" for file in folder.input_files())
    write_whole(folder.path / "files.sha256", sums)
    # The cluster's own launcher starts the ranks, so Kerf is not asked to.
    launch = folder.study.slurm_launch.replace("@RANKS@", str(folder.study.ranks))
    command = f"{launch} {shlex.join(folder.command(binary, 1))}".strip()
    write_whole(folder.path / "run.sh", POINT.format(
        here=shlex.quote(str(folder.path)), command=command, program=folder.program,
        resume=RESUME if folder.may_resume else ""))


def refuse_if_queued(output: Path) -> None:
    """Two arrays must not work on the same points."""
    try:
        job = (output / "slurm" / "job_id").read_text().strip()
    except OSError:
        return
    if not shutil.which("squeue"):
        return
    found = subprocess.run(["squeue", "--noheader", "--jobs", job], capture_output=True, text=True)
    if found.returncode == 0 and found.stdout.strip():
        raise Hindered(f"{output}: error: job {job} of this study is still in the queue; wait for its end, or cancel "
                       f"it with: scancel {job}")


def write_array(folders: list[PointFolder], output: Path, binary: Path, jobs: int | None) -> Path:
    """Writes all scripts and returns the path of the array's. Pre: there is at least one point."""
    study = folders[0].study
    file = study.slurm_template or TEMPLATE
    place = output / "slurm"
    logs = place / "logs"
    if re.search(r"\s", str(logs)):
        raise Hindered(f"{output}: error: Slurm's scripts cannot name a folder with a blank; expected another --output")
    at_once = f"%{jobs}" if jobs else ""
    script = filled(file.read_text(encoding="utf-8"), {
        "NAME": re.sub(r"\W+", "_", study.file.stem), "ARRAY": f"0-{len(folders) - 1}{at_once}",
        "RANKS": str(study.ranks), "LOGS": str(logs), "RUN": RUN.format(points=shlex.quote(str(place / "points.txt")))},
        file)
    logs.mkdir(parents=True, exist_ok=True)
    for folder in folders:
        write_point(folder, binary)
    write_whole(place / "points.txt", "".join(f"{folder.path}\n" for folder in folders))
    write_whole(place / "array.sh", script)
    return place / "array.sh"


def submit(script: Path) -> str:
    """Hands the array to Slurm and returns the job's number. Throws Hindered."""
    try:
        done = subprocess.run(["sbatch", "--parsable", str(script)], capture_output=True, text=True)
    except OSError as error:
        raise Hindered(f"{script}: error: sbatch cannot be started: {error.strerror}; expected Slurm's commands on "
                       "this machine, or leave out --submit") from error
    if done.returncode != 0:
        raise Hindered(f"{script}: error: sbatch has refused the array: {done.stderr.strip()}; change the template")
    job = done.stdout.strip().split(";")[0]
    write_whole(script.parent / "job_id", job + "\n")
    return job
