#!/usr/bin/env python3
"""Draws the pictures of a finished run into OUTPUT_DIR/plots.

front.png, back.png  the bodies at the end, eroded elements removed, seen along and against the impact
cut.png              a cut through the model at several times, coloured by a field
                     z points upwards, or y where the cut is normal to z
overview.png         the bodies cut open, halfway and at the end
energies.png         energies and their balance over time
progress.png         eroded elements, load imbalance and time step over time
observer_NAME.png    the columns of an observer over time
"""

from __future__ import annotations

import argparse
import re
import sys
import textwrap
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

try:
    import matplotlib

    matplotlib.use("Agg")
    import charts
    import pictures
    from results import (Results, ResultsError, energies_of, read_history, read_observers, read_summary,
                         units_of_observers)
except ModuleNotFoundError as error:
    sys.exit(f"kerf plot: the Python package {error.name} is missing; ./kerf build installs it, unless KERF_PYTHON "
             "names another Python")


# What stands after an option and is its value: -1e-3 too, which argparse of Python 3.11 takes for an option.
NEGATIVE_NUMBER = re.compile(r"^-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$|^-(inf|nan)", re.IGNORECASE)
MOST_FRAMES = 60  # more panels than these make an image too large to be drawn


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="kerf plot", description=__doc__.splitlines()[0])
    parser._negative_number_matcher = NEGATIVE_NUMBER
    parser.add_argument("output", type=Path, help="output folder of a run")
    parser.add_argument("--field", default="effective_plastic_strain", help="element field that colours cuts")
    parser.add_argument("--range", nargs=2, type=float, metavar=("LOW", "HIGH"), help="range of the colours, SI units")
    parser.add_argument("--cut-normal", nargs=3, type=float, metavar=("X", "Y", "Z"), help="default: 0 1 0")
    parser.add_argument("--cut-origin", nargs=3, type=float, metavar=("X", "Y", "Z"), help="a point of the cut [m]")
    parser.add_argument("--frames", type=int, default=6,
                        help=f"number of times in the cut mosaic (default 6, at most {MOST_FRAMES})")
    parser.add_argument("--mirror", default="", metavar="AXES", help="show a symmetric model whole, e.g. x or xy")
    parser.add_argument("--into", type=Path, help="folder for the pictures (default OUTPUT/plots)")
    arguments = parser.parse_args()
    if set(arguments.mirror) - set("xyz"):
        parser.error(f"--mirror takes letters of x, y and z, not '{arguments.mirror}'")
    if not 1 <= arguments.frames <= MOST_FRAMES:
        parser.error(f"--frames has to be from 1 to {MOST_FRAMES}, not {arguments.frames}")
    for option in ("range", "cut_normal", "cut_origin"):
        values = getattr(arguments, option)
        # Squares of larger or smaller numbers are beyond what a computer can hold.
        if values is not None and not all(value == 0.0 or 1.0e-100 < abs(value) < 1.0e100 for value in values):
            parser.error(f"--{option.replace('_', '-')} takes numbers of a usual size, not "
                         + " ".join(f"{value:g}" for value in values))
    if arguments.cut_normal is not None and not any(arguments.cut_normal):
        parser.error("--cut-normal must not be zero")
    if arguments.range is not None and not arguments.range[0] < arguments.range[1]:
        parser.error("--range takes the lower end first, then the upper, not "
                     + " ".join(f"{value:g}" for value in arguments.range))
    return arguments


def title_of(folder: Path, summary: dict) -> str:
    """The title of the input and what came of it, for the head of every picture."""
    name = summary.get("title") or Path(summary.get("input", "") or folder.resolve().name).stem
    end = summary.get("end_time")
    facts = []
    if isinstance(end, (int, float)):
        facts.append(f"{end * 1.0e6:.4g} µs")
    eroded = summary.get("eroded", {}).get("elements")
    if eroded is not None:
        facts.append(f"{eroded} elements eroded")
    width = 95  # characters that fit above the narrowest picture
    between = "  ·  " if len(name) + len(", ".join(facts)) + 5 <= width else "\n"
    return charts.plain(textwrap.fill(name, width) + (between + ", ".join(facts) if facts else ""))


def draw_observers(folder: Path, title: str, into: Path, drawn: list[str], notes: list[str]) -> None:
    observers = read_observers(folder / "history.h5")  # says what is wrong with a damaged file
    units = units_of_observers(folder / "history.h5")
    for name, columns in observers.items():
        if len(columns.get("time", [])) == 0:
            notes.append(f"the observer {name} has filled no row")
            continue
        path = into / f"observer_{name}.png"
        left_out = charts.plot_observer(columns, units[name], f"{title}  ·  {charts.plain(name)}", path)
        if path.exists():
            drawn.append(path.name)
        if left_out:
            notes.append(f"{path.name} leaves out {len(left_out)} columns of the observer {name}: "
                         + ", ".join(left_out))


def draw(folder: Path, arguments: argparse.Namespace, into: Path, drawn: list[str], notes: list[str]) -> None:
    """Draws what can be drawn and adds its names to `drawn`; why the rest cannot be drawn goes into `notes`."""
    summary = {}
    try:
        summary = read_summary(folder)
    except ResultsError as error:
        notes.append(str(error))
    title = title_of(folder, summary)
    try:
        history = read_history(folder / "history.csv")
        if len(history.get("time", [])) == 0:
            raise ResultsError("history.csv is missing or empty: no charts over time")
        energies = energies_of(folder / "history.csv")
        if energies:
            charts.plot_energies(history, energies, title, into / "energies.png")
            drawn.append("energies.png")
        charts.plot_progress(history, title, into / "progress.png")
        drawn.append("progress.png")
    except ResultsError as error:
        notes.append(str(error))
    try:
        draw_observers(folder, title, into, drawn, notes)
    except ResultsError as error:
        notes.append(str(error))
    try:
        pictures.draw_all(Results(folder), arguments, title, into, drawn, notes)
    except ResultsError as error:
        notes.append(str(error))


def main() -> int:
    arguments = parse_arguments()
    folder = arguments.output
    if not folder.is_dir():
        print(f"kerf plot: there is no folder {folder}", file=sys.stderr)
        return 1
    into = arguments.into or folder / "plots"
    drawn, notes = [], []
    try:
        into.mkdir(parents=True, exist_ok=True)
        draw(folder, arguments, into, drawn, notes)
    except OSError as error:  # a folder that cannot be written, a full disk
        notes.append(f"{error.filename or into}: {error.strerror or error}")
    for note in notes:
        print(f"kerf plot: {note}", file=sys.stderr)
    if drawn:
        print(f"kerf plot: {', '.join(drawn)} in {into}")
    return 0 if drawn else 1


if __name__ == "__main__":
    sys.exit(main())
