#!/usr/bin/env python3
"""Runs an input at many points of its parameters, and gathers the results.

Exit code 0: all points have completed; 1: a fit has no answer, or anything else; 2: the study is wrong; 3: a point has
failed; 4: stopped by a signal, or points are not run yet.
"""

from __future__ import annotations

import argparse
import shlex
import signal
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

try:
    import dakota
    import gather
    import slurm
    from local_runs import Runner, binary_of_kerf, usual_jobs
    from marked_yaml import Hindered, StudyError
    from point_folder import DONE, FAILED, PointFolder, State, claim, read_json, study_alone
    from quantities import Value
    from study import Point, Study, read_study
except ModuleNotFoundError as error:
    sys.exit(f"kerf sweep: the Python package {error.name} is missing; ./kerf build installs it, unless KERF_PYTHON "
             "names another Python")

EXIT_OTHER, EXIT_BAD_STUDY, EXIT_POINT_FAILED, EXIT_STOPPED = 1, 2, 3, 4


def say(text: str) -> None:
    print(f"kerf sweep: {text}", flush=True)


def at_least_one(text: str) -> int:
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f'"{text}" is no number of runs; expected a whole number from 1 on')
    return int(text)


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="kerf sweep", description=__doc__.splitlines()[0])
    parser.add_argument("study", nargs="?", type=Path, metavar="STUDY.yaml", help="what varies, and what is wanted")
    parser.add_argument("--study", dest="study_option", type=Path, metavar="STUDY.yaml", help="the same, as an option")
    parser.add_argument("--output", type=Path, metavar="DIR", help="folder for the points, the table and the plots")
    parser.add_argument("--jobs", type=at_least_one, metavar="N", help="runs at the same time (default: cores / ranks)")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--check", action="store_true", help="print the points and run nothing")
    what.add_argument("--collect", action="store_true", help="gather what is there and run nothing")
    what.add_argument("--slurm", action="store_true", help="write the scripts of a Slurm job array and run nothing")
    what.add_argument("--dakota", nargs=2, type=Path, metavar=("PARAMETERS", "RESULTS"),
                      help="run one point for Dakota's fork interface")
    parser.add_argument("--submit", action="store_true", help="with --slurm: hand the array to sbatch")
    arguments = parser.parse_args()
    arguments.study = arguments.study or arguments.study_option
    if arguments.study is None:
        parser.error("a study is missing; expected kerf sweep STUDY.yaml")
    if arguments.submit and not arguments.slurm:
        parser.error("--submit goes with --slurm only")
    return arguments


def output_of(study: Study, arguments: argparse.Namespace) -> Path:
    if arguments.output:
        return arguments.output.resolve()
    if study.output:
        return (study.file.parent / study.output).resolve()
    return (Path("results") / f"{study.input.file.stem}_{study.file.stem}").resolve()


def folders_of(study: Study, output: Path) -> list[PointFolder]:
    """The points of the study, or, of a study that Dakota drives, all that are in the folder."""
    if study.has_points:
        return [PointFolder(study, point, output) for point in study.points]
    found = []
    for file in sorted(output.glob("*/point.json")):
        known = read_json(file) or {}
        if known.get("study") == str(study.file.resolve()):
            values = {name: Value(**value) for name, value in known["values"].items()}
            found.append(PointFolder(study, Point(values, known["settings"]), output))
    return found


def need_points(study: Study) -> None:
    if not study.has_points:
        raise StudyError(f"{study.file}:1:1: error: the required key `points` of the study is missing; expected "
                         "values, grid, latin_hypercube or mesh. Only --dakota and --collect can do without")


# ---- commands

def check(study: Study, output: Path) -> int:
    need_points(study)
    for folder in folders_of(study, output):
        print(f"{folder.name}  [{folder.state().status}]")
        for path, text in folder.point.settings.items():
            print(f"    {path} = {text}")
    print(f"{len(study.points)} points of {study.input.file}, results in {output}")
    return 0


def report(study: Study, output: Path) -> int:
    """Writes the table, plots and fits, prints them, and returns the exit code."""
    rows = gather.gather(folders_of(study, output), study)
    gather.write_tables(rows, study, output)
    print(gather.table_text(rows, study))
    refused = draw(study, rows, output)
    for row in rows:
        for reason in row.reasons:
            say(f"{row.folder.name}: {reason}")
    states = [row.state.status for row in rows]
    say(f"{states.count(DONE)} of {len(rows)} points have completed; the table is {output / 'table.csv'}")
    if FAILED in states:
        return EXIT_POINT_FAILED
    if states.count(DONE) < len(states):
        return EXIT_STOPPED
    return EXIT_OTHER if refused or not rows else 0


def draw(study: Study, rows, output: Path) -> bool:
    if not study.plots:
        return False
    from drawing import Drawing

    drawing = Drawing(study, rows, output)
    drawing.draw_all()
    for note in drawing.notes:
        say(note)
    return drawing.refused


def run(study: Study, output: Path, jobs: int | None) -> int:
    need_points(study)
    binary = binary_of_kerf()
    with study_alone(output):
        claim(output, study.file)
        folders = folders_of(study, output)
        waiting = [folder for folder in folders if folder.state().status != DONE]
        jobs = jobs or usual_jobs(study.ranks)
        say(f"{len(folders)} points, {len(folders) - len(waiting)} of them done already; {jobs} at a time")
        finished = Runner(binary, study.ranks, jobs, say).run(waiting)
        code = report(study, output)
    if not finished:
        say("stopped by a signal; the same command goes on")
        return EXIT_STOPPED
    return code


def write_slurm(study: Study, output: Path, jobs: int | None, submit: bool) -> int:
    need_points(study)
    binary = binary_of_kerf()
    with study_alone(output):
        claim(output, study.file)
        slurm.refuse_if_queued(output)
        waiting = [folder for folder in folders_of(study, output) if folder.state().status != DONE]
        if not waiting:
            say("all points are done; there is nothing to submit")
            return 0
        script = slurm.write_array(waiting, output, binary, jobs)
        say(f"{len(waiting)} points are in the array {script}")
        say(f"submitted as job {slurm.submit(script)}" if submit else
            f"submit it with: sbatch {shlex.quote(str(script))}")
        say(f"gather the results with: kerf sweep {study.file} --output {output} --collect")
    return 0


def collect(study: Study, output: Path) -> int:
    if not output.is_dir():
        raise Hindered(f"{output}: error: there is no such folder; expected that of an earlier kerf sweep")
    return report(study, output)


def run_alone(folder: PointFolder, binary: Path, ranks: int) -> State:
    """Runs one point unless it is done. A signal ends the run with its state saved."""
    with folder.alone():
        state = folder.state()
        if state.status == DONE:
            return state
        runner = Runner(binary, ranks, 1, lambda text: print(f"kerf sweep: {text}", file=sys.stderr))
        runner.run([folder])
        return folder.state()


def answer_dakota(study: Study, output: Path, parameters: Path, results: Path) -> int:
    """One evaluation. Every failure ends in a results file that says FAIL; the sentence goes to stderr as well."""
    try:
        request = dakota.read_request(parameters)
        folder = PointFolder(study, dakota.point_of(request, study, parameters), output)
        run_alone(folder, binary_of_kerf(), study.ranks)
        row = gather.row_of(folder, study)
        reasons = row.reasons if row.trust == "no" else []
        if reasons:
            raise StudyError(*(f"{parameters}: error: {folder.path}: {reason}" for reason in reasons))
        dakota.write_results(results, request, row.results)
    except StudyError as error:
        dakota.write_failure(results, error.lines)
        print(*error.lines, sep="\n", file=sys.stderr)
    return 0  # Dakota reads FAIL in the file; an exit code other than zero says that the driver itself is broken


def main() -> int:
    arguments = parse_arguments()
    try:
        study = read_study(arguments.study)
        output = output_of(study, arguments)
        if arguments.dakota:
            return answer_dakota(study, output, *arguments.dakota)
        if arguments.check:
            return check(study, output)
        if arguments.collect:
            return collect(study, output)
        if arguments.slurm:
            return write_slurm(study, output, arguments.jobs, arguments.submit)
        return run(study, output, arguments.jobs)
    except StudyError as error:
        print(*error.lines, sep="\n", file=sys.stderr)
        if arguments.dakota:
            dakota.write_failure(arguments.dakota[1], error.lines)
        return EXIT_OTHER if isinstance(error, Hindered) else EXIT_BAD_STUDY
    except ModuleNotFoundError as error:
        print(f"kerf sweep: the Python package {error.name} is missing; ./kerf build installs it, unless KERF_PYTHON "
              "names another Python", file=sys.stderr)
        return EXIT_OTHER
    except OSError as error:
        print(f"{error.filename or output}: error: {error.strerror or error}; expected a folder that can be written",
              file=sys.stderr)
        return EXIT_OTHER


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.exit(main())
