#!/usr/bin/env python3
"""Draws the pictures of a finished run into OUTPUT_DIR/plots.

front.png, back.png  the bodies at the end, eroded elements removed, seen along and against the impact
cut.png              a cut through the model at several times, coloured by a field
overview.png         the bodies cut open, halfway and at the end
energies.png         energies and their balance over time
progress.png         eroded elements, load imbalance and time step over time
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
sys.path.insert(0, str(Path(__file__).resolve().parent))

import charts  # noqa: E402
import pictures  # noqa: E402
from results import Results, ResultsError, read_history, read_summary  # noqa: E402


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="kerf plot", description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path, help="output folder of a run")
    parser.add_argument("--field", default="effective_plastic_strain", help="element field that colours cuts")
    parser.add_argument("--range", nargs=2, type=float, metavar=("LOW", "HIGH"), help="range of the colours, SI units")
    parser.add_argument("--cut-normal", nargs=3, type=float, metavar=("X", "Y", "Z"), help="default: 0 1 0")
    parser.add_argument("--cut-origin", nargs=3, type=float, metavar=("X", "Y", "Z"), help="a point of the cut [m]")
    parser.add_argument("--frames", type=int, default=6, help="number of times in the cut mosaic (default 6)")
    parser.add_argument("--mirror", default="", metavar="AXES", help="show a symmetric model whole, e.g. x or xy")
    parser.add_argument("--into", type=Path, help="folder for the pictures (default OUTPUT/plots)")
    arguments = parser.parse_args()
    if set(arguments.mirror) - set("xyz"):
        parser.error(f"--mirror takes letters of x, y and z, not '{arguments.mirror}'")
    if arguments.frames < 1:
        parser.error("--frames has to be at least 1")
    if arguments.cut_normal is not None and not any(arguments.cut_normal):
        parser.error("--cut-normal must not be zero")
    return arguments


def title_of(folder: Path) -> str:
    """The name of the case and what came of it, for the head of every picture."""
    summary = read_summary(folder)
    name = summary.get("title") or Path(summary.get("input", "") or folder.resolve().name).stem
    end = summary.get("end_time")
    facts = []
    if isinstance(end, (int, float)):
        facts.append(f"{end * 1.0e6:.4g} µs")
    eroded = summary.get("eroded", {}).get("elements")
    if eroded is not None:
        facts.append(f"{eroded} elements eroded")
    return name + ("  ·  " + ", ".join(facts) if facts else "")


def main() -> int:
    arguments = parse_arguments()
    folder = arguments.output
    if not folder.is_dir():
        print(f"kerf plot: there is no folder {folder}", file=sys.stderr)
        return 1
    into = arguments.into or folder / "plots"
    into.mkdir(parents=True, exist_ok=True)
    title, drawn, notes = title_of(folder), [], []

    history = read_history(folder / "history.csv")
    if len(history.get("time", [])) > 0:
        if any(name in history for name in charts.ENERGIES):
            charts.plot_energies(history, title, into / "energies.png")
            drawn.append("energies.png")
        charts.plot_progress(history, title, into / "progress.png")
        drawn.append("progress.png")
    else:
        notes.append("history.csv is missing or empty: no charts over time")

    try:
        drawn += pictures.draw_all(Results(folder), arguments, title, into, notes)
    except ResultsError as error:
        notes.append(str(error))
    for note in notes:
        print(f"kerf plot: {note}", file=sys.stderr)
    if drawn:
        print(f"kerf plot: {', '.join(drawn)} in {into}")
    return 0 if drawn else 1


if __name__ == "__main__":
    sys.exit(main())
