#!/usr/bin/env python3
"""Draws the pictures of `kerf drive` into its folder: one column against another, of all materials and paths, with
references and measured points laid under."""

from __future__ import annotations

import argparse
import csv
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

try:
    import matplotlib

    matplotlib.use("Agg")
    import numpy as np
    from charts import engineering, plain, style
    from matplotlib.figure import Figure
except ModuleNotFoundError as error:
    sys.exit(f"kerf drive: the Python package {error.name} is missing; ./kerf build installs it, unless KERF_PYTHON "
             "names another Python")

USUAL = ({"name": "von_mises_over_strain", "x": "strain", "y": "von_mises", "paths": [], "points": []},
         {"name": "pressure_over_density", "x": "density", "y": "pressure", "paths": [], "points": []})
COLOURS = ("#2b6cb0", "#c05621", "#2f855a", "#805ad5", "#c53030", "#b7791f", "#319795", "#d53f8c", "#4a5568")
LINES = ("-", "--", "-.", ":")


class Refused(Exception):
    """A file that cannot be drawn, in a sentence."""


def read_table(path: Path) -> dict[str, np.ndarray]:
    """The columns of numbers of a CSV file with a heading, those that begin with # skipped."""
    try:
        rows = [r for r in csv.reader(path.read_text().splitlines()) if r and not r[0].lstrip().startswith("#")]
    except OSError as failure:
        raise Refused(f"{path} cannot be read: {failure.strerror}") from failure
    columns = {}
    for i, name in enumerate(cell.strip() for cell in rows[0]):
        try:
            columns[name] = np.array([float(row[i]) for row in rows[1:]])
        except (ValueError, IndexError):
            continue
    return columns


def read_points(points: dict) -> tuple[np.ndarray, np.ndarray]:
    """Measured points in SI units. Columns are named, or numbered from 1; the heading may be missing."""
    path = Path(points["file"])
    try:
        rows = [r for r in csv.reader(path.read_text().splitlines()) if r and not r[0].lstrip().startswith("#")]
    except OSError as failure:
        raise Refused(f"{path} cannot be read: {failure.strerror}") from failure
    heading = [cell.strip() for cell in rows[0]] if rows else []
    places = []
    for column in points["columns"]:
        if column in heading:
            places.append(heading.index(column))
        elif column.isdigit() and 1 <= int(column) <= len(heading):
            places.append(int(column) - 1)
        else:
            raise Refused(f"{path} has no column \"{column}\"; expected one of {', '.join(heading)}, or a number "
                          "from 1")
    try:
        float(rows[0][places[0]])
    except ValueError:
        rows = rows[1:]
    try:
        x, y = (np.array([float(row[place]) for row in rows]) for place in places)
    except (ValueError, IndexError) as failure:
        raise Refused(f"{path}: {failure}; expected numbers in the columns {', '.join(points['columns'])}") from failure
    return x * points["scales"][0], y * points["scales"][1]


def heading_of(name: str, unit: str, reference: dict, columns: dict) -> str | None:
    """The heading of a column of the driver in a reference."""
    unit = {"s-1": "1_s"}.get(unit, unit).replace("/", "_")
    for heading in (reference["columns"].get(name), name, f"{name}_{unit}"):
        if heading in columns:
            return heading
    return None


def curves_of(picture: dict, curves: list[dict]) -> list[dict]:
    """The curves that a picture shows."""
    chosen = [c for c in curves if not picture["paths"] or c["path"] in picture["paths"]]
    return [c for c in chosen if picture["x"] in c["units"] and picture["y"] in c["units"]]


def draw(picture: dict, curves: list[dict], folder: Path, title: str) -> str | None:
    """Draws one picture. Returns the name of its file, or nothing where no curve has its columns."""
    shown = curves_of(picture, curves)
    if not shown:
        return None
    x, y = picture["x"], picture["y"]
    tables = [read_table(folder / c["file"]) for c in shown]
    factors = []
    for name in (x, y):
        scaled = shown[0]["units"][name] not in ("-", "kg/m3")
        factors.append(engineering(np.concatenate([t[name] for t in tables])) if scaled else (1.0, ""))
    (fx, px), (fy, py) = factors
    figure = Figure(figsize=(8.0, 5.5), layout="constrained")
    axes = figure.subplots()
    for points in picture["points"]:
        at, value = read_points(points)
        axes.plot(at * fx, value * fy, "o", color="#1a202c", fillstyle="none", markersize=5,
                  label=plain(points["label"]))
    materials = list(dict.fromkeys(c["material"] for c in shown))
    paths = list(dict.fromkeys(c["path"] for c in shown))
    for curve, table in zip(shown, tables):
        colour = COLOURS[materials.index(curve["material"]) % len(COLOURS)]
        line = LINES[paths.index(curve["path"]) % len(LINES)]
        if len(materials) == 1:
            colour, line = COLOURS[paths.index(curve["path"]) % len(COLOURS)], "-"
        for reference in curve["references"]:
            known = read_table(Path(reference["file"]))
            hx, hy = (heading_of(n, curve["units"][n], reference, known) for n in (x, y))
            if hy is None:
                continue
            at = known[hx] if hx else np.interp(known[reference["time"]], table["time"], table[x])
            axes.plot(at * fx, known[hy] * fy, ".", color=colour, alpha=0.35, markersize=6)
        axes.plot(table[x] * fx, table[y] * fy, color=colour, linestyle=line, linewidth=1.5,
                  label=plain(f"{curve['material']}, {curve['path']}"))
        if curve["failed_at"] is not None:
            i = int(np.argmin(np.abs(table["time"] - curve["failed_at"])))
            axes.plot(table[x][i] * fx, table[y][i] * fy, "x", color=colour, markersize=8)
    unit = shown[0]["units"]
    style(axes, f"{y.replace('_', ' ')} [{py}{unit[y]}]")
    axes.set_xlabel(f"{x.replace('_', ' ')} [{px}{unit[x]}]")
    if len(shown) <= 14:
        axes.legend(frameon=False, fontsize="small")
    figure.suptitle(plain(title))
    name = picture["name"] + ".png"
    figure.savefig(folder / name, dpi=140)
    return name


def main() -> int:
    parser = argparse.ArgumentParser(prog="kerf drive", description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="folder that kerf drive has written")
    folder = parser.parse_args().folder
    try:
        drive = json.loads((folder / "drive.json").read_text())
        pictures = drive["pictures"] or USUAL
        drawn = [draw(p, drive["curves"], folder, drive["title"] or folder.stem) for p in pictures]
    except (OSError, json.JSONDecodeError) as failure:
        print(f"{folder}/drive.json: error: {failure}", file=sys.stderr)
        return 1
    except Refused as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 1
    missing = [p for p, name in zip(pictures, drawn) if name is None]
    for picture in missing:
        print(f"error: no curve has both columns {picture['x']} and {picture['y']} of the picture {picture['name']}",
              file=sys.stderr)
    print("pictures: " + ", ".join(str(folder / name) for name in drawn if name))
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
