#!/usr/bin/env python3
"""Measures how an input scales: times on several numbers of ranks, factors of efficiency, messages, a report.

Exit code 0: all runs have completed with the same state; 1: hindered, or anything else; 2: an argument or the input is
wrong; 3: a run has failed; 4: stopped by a signal, or runs are not there yet; 5: states of runs differ.
"""

from __future__ import annotations

import argparse
import shlex
import signal
import sys
from datetime import datetime, timezone
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

try:
    import scaling_output
    import slurm
    from local_runs import Runner, binary_of_kerf
    from machine import machine_facts
    from marked_yaml import Hindered, StudyError
    from model_input import ModelInput
    from point_folder import DONE, FAILED, read_json, study_alone
    from scaling import finite, run_of, tabulate, wrong_growth
    from scaling_study import TIMED, ScalingStudy, hash_of_program, library_of_counts, read_study_of
    from talp import write_talp
except ModuleNotFoundError as error:
    sys.exit(f"kerf scale: the Python package {error.name} is missing; ./kerf build installs it, unless KERF_PYTHON "
             "names another Python")

EXIT_OTHER, EXIT_BAD_ARGUMENT, EXIT_RUN_FAILED, EXIT_STOPPED, EXIT_HASHES = 1, 2, 3, 4, 5
SCHEMA = "kerf scale 1"
MOST_RANKS = 1 << 20


def say(text: str) -> None:
    print(f"kerf scale: {text}", flush=True)


# ---- arguments

def whole_number(text: str) -> int:
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f'"{text}"; expected a whole number from 1 on')
    return int(text)


def numbers_of_ranks(text: str) -> list[int]:
    words = text.split(",")
    if not all(word.isdigit() and 1 <= int(word) <= MOST_RANKS for word in words):
        raise argparse.ArgumentTypeError(f'"{text}"; expected whole numbers from 1 on with commas between, as 1,2,4')
    if len({int(word) for word in words}) < len(words):
        raise argparse.ArgumentTypeError(f'"{text}" has a number twice; expected each once')
    return sorted(int(word) for word in words)


def setting(text: str) -> tuple[str, str]:
    path, equals, value = text.partition("=")
    if not equals or not path.strip():
        raise argparse.ArgumentTypeError(f'"{text}"; expected KEY.PATH=VALUE')
    return path.strip(), value.strip()


def make_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="kerf scale", description=__doc__.splitlines()[0])
    parser.add_argument("input", nargs="?", type=Path, metavar="INPUT", help="the input file")
    parser.add_argument("--ranks", type=numbers_of_ranks, default=[1, 2, 4], metavar="N,N,...",
                        help="numbers of ranks (default: 1,2,4)")
    parser.add_argument("--repeats", type=whole_number, default=3, metavar="N", help="runs on each (default: 3)")
    parser.add_argument("--weak", action="append", default=[], metavar="KEY.PATH",
                        help="weak scaling: a number or size of cells that follows the ranks, or `mesh` for all; may "
                        "be repeated")
    parser.add_argument("--set", action="append", default=[], type=setting, metavar="KEY=VALUE", dest="settings",
                        help="of all runs, as with kerf run")
    parser.add_argument("--plugin", action="append", default=[], help="of all runs, as with kerf run")
    parser.add_argument("--side-by-side", action="store_true", help="also n serial runs at the same time on n cores")
    parser.add_argument("--no-counts", action="store_true", help="no runs in which messages are counted")
    parser.add_argument("--launch", default="", metavar="COMMAND", help="starts ranks, with @RANKS@ for their number")
    parser.add_argument("--output", type=Path, metavar="DIR", help="folder of the runs and the report (default: "
                        "results/NAME_scale, or NAME_weak_scale)")
    parser.add_argument("--template", type=Path, metavar="FILE", help="job script for --slurm")
    parser.add_argument("--submit", action="store_true", help="with --slurm: hand the job arrays to sbatch")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--slurm", action="store_true", help="write job arrays for Slurm and run nothing")
    what.add_argument("--collect", action="store_true", help="gather what is in --output and run nothing")
    what.add_argument("--plot-only", action="store_true", help="draw the report of scale.json in --output anew")
    return parser


def parse_arguments(words: list[str] | None = None) -> argparse.Namespace:
    parser = make_parser()
    arguments = parser.parse_args(words)
    later = arguments.collect or arguments.plot_only
    if arguments.input is None and not (later and arguments.output):
        parser.error("an input is missing; expected kerf scale INPUT" + (", or --output DIR" if later else ""))
    if arguments.submit and not arguments.slurm:
        parser.error("--submit goes with --slurm only")
    if arguments.template and not arguments.slurm:
        parser.error("--template goes with --slurm only")
    if arguments.slurm and arguments.side_by_side:
        parser.error("--side-by-side needs this machine; expected it without --slurm")
    if arguments.launch:
        try:
            shlex.split(arguments.launch)
        except ValueError as error:
            parser.error(f"--launch: {error} in `{arguments.launch}`; expected a command as for a shell")
    if arguments.launch and "@RANKS@" not in arguments.launch and set(arguments.ranks) != {1}:
        parser.error(f"--launch: \"{arguments.launch}\" starts the same number of ranks in every run; expected a "
                     "command with @RANKS@ for their number")
    if arguments.template and not arguments.template.is_file():
        parser.error(f"--template: there is no file {arguments.template}")
    return arguments


def output_of(arguments: argparse.Namespace) -> Path:
    if arguments.output:
        return arguments.output.resolve()
    return (Path("results") / f"{arguments.input.stem}_{'weak_' if arguments.weak else ''}scale").resolve()


def study_of(arguments: argparse.Namespace, binary: Path) -> ScalingStudy:
    file = arguments.input.resolve()
    return ScalingStudy(
        ModelInput(file), arguments.ranks, arguments.repeats, dict(arguments.settings), arguments.weak,
        arguments.plugin, not arguments.no_counts, arguments.side_by_side, arguments.launch, hash_of_program(binary),
        "" if arguments.no_counts else str(library_of_counts(binary)), arguments.template and
        arguments.template.resolve())


# ---- commands

def run(study: ScalingStudy, binary: Path, output: Path) -> int:
    with study_alone(output, "kerf scale"):
        study.save(output)
        waiting = [group for group in study.groups(output) if any(run.state().status != DONE for run in group)]
        total = sum(len(group) for group in waiting)
        say(f"{total} runs to do, on {', '.join(map(str, study.ranks))} ranks")
        finished = True
        for group in waiting:
            # Copies that run at the same time are measured together, so one that is missing repeats all of them.
            for folder in group:
                (folder.path / "exit_code").unlink(missing_ok=True)
            finished = Runner(binary, 0, len(group), say).run(group)
            if not finished:
                break
        code = report(study, output, machine_facts())
    if not finished:
        say("stopped by a signal; the same command goes on")
        return EXIT_STOPPED
    return code


def about(study: ScalingStudy, machine: dict) -> dict:
    return {"schema": SCHEMA, "date": datetime.now(timezone.utc).isoformat(timespec="seconds"),
            "input": str(study.input.file), "mode": "weak" if study.weak else "strong", "weak": study.weak,
            "settings": study.settings, "repeats": study.repeats, "launch": study.launch, "machine": machine}


def report(study: ScalingStudy, output: Path, machine: dict) -> int:
    """Writes tables, report and TALP files, prints the table, and returns the exit code."""
    content = finite(about(study, machine) | tabulate(study, output, machine))
    scaling_output.write_json(content, output)
    scaling_output.write_tables(content, output)
    stamped = []
    for group in study.groups(output):
        for folder in group:
            one, summary = run_of(folder)
            if folder.kind == TIMED and summary is not None:
                written = datetime.fromtimestamp((folder.path / "summary.json").stat().st_mtime, timezone.utc)
                # TALP-Pages cannot read a time with its zone.
                stamped.append((one.name, summary, written.replace(tzinfo=None).isoformat(timespec="seconds")))
    write_talp(stamped, output, study.input.file.stem, bool(study.weak))
    draw(content, output)
    return tell(content, output)


def draw(content: dict, output: Path) -> None:
    from scaling_report import write_report

    write_report(content, output)


def tell(content: dict, output: Path) -> int:
    print(scaling_output.table_text(content))
    for one in content["runs"]:
        if one["status"] != DONE:
            say(f"{one['name']}: {one['status']}: {one['message']}")
    for note in scaling_output.notes_of(content):
        say(note)
    say(f"the report is {output / 'report.html'}")
    states = [one["status"] for one in content["runs"]]
    if content["hashes"]["differing"]:
        print(*scaling_output.hash_message(content, output), sep="\n", file=sys.stderr)
        return EXIT_HASHES
    if grew_wrong := wrong_growth(content):
        print(*grew_wrong, sep="\n", file=sys.stderr)
        return EXIT_RUN_FAILED
    if FAILED in states:
        return EXIT_RUN_FAILED
    return EXIT_STOPPED if states.count(DONE) < len(states) else 0


def write_slurm(study: ScalingStudy, binary: Path, output: Path, submit: bool) -> int:
    """One job array for each number of ranks; its tasks run one after the other."""
    with study_alone(output, "kerf scale"):
        places = {n: output / "jobs" / f"ranks_{n}" for n in study.ranks}
        for place in places.values():
            slurm.refuse_if_queued(place)
        study.save(output)
        for n, place in places.items():
            waiting = [run for run in study.of_ranks(output, n) if run.state().status != DONE]
            if not waiting:
                say(f"all runs on {n} ranks are done")
                continue
            script = slurm.write_array(waiting, place, binary, 1)
            say(f"{len(waiting)} runs on {n} ranks are in the array {script}")
            say(f"submitted as job {slurm.submit(script)}" if submit else
                f"submit it with: sbatch {shlex.quote(str(script))}")
        say(f"gather the results with: kerf scale --collect --output {output}")
    return 0


def collect(output: Path) -> int:
    study = read_study_of(output)
    if not (output / "jobs").is_dir():
        return report(study, output, machine_facts())
    # The runs were on nodes of a batch system, whose template has written what it knows of them.
    files = sorted((output / "jobs").glob("*/slurm/logs/machine.json"))
    return report(study, output, (read_json(files[0]) or {}) if files else {})


def plot_again(output: Path) -> int:
    content = read_json(output / "scale.json")
    if content is None or content.get("schema") != SCHEMA:
        raise Hindered(f"{output / 'scale.json'}: error: the file is not there or is no \"{SCHEMA}\"; expected the "
                       "folder of an earlier kerf scale")
    scaling_output.write_tables(content, output)
    draw(content, output)
    return tell(content, output)


def main() -> int:
    arguments = parse_arguments()
    output = output_of(arguments)
    try:
        if arguments.plot_only:
            return plot_again(output)
        if arguments.collect:
            return collect(output)
        binary = binary_of_kerf()
        study = study_of(arguments, binary)
        if arguments.slurm:
            return write_slurm(study, binary, output, arguments.submit)
        return run(study, binary, output)
    except StudyError as error:
        print(*error.lines, sep="\n", file=sys.stderr)
        return EXIT_OTHER if isinstance(error, Hindered) else EXIT_BAD_ARGUMENT
    except OSError as error:
        print(f"{error.filename or output}: error: {error.strerror or error}; expected a folder that can be written",
              file=sys.stderr)
        return EXIT_OTHER


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.exit(main())
