#!/usr/bin/env python3
"""Draws the subdomains that `kerf partition` has found, as they lie and pulled apart, and charts of their measures."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

try:
    import matplotlib

    matplotlib.use("Agg")
    import numpy as np
    import scene
    from charts import plain, style
    from matplotlib.figure import Figure
    from model_view import box_of, upright
    from pictures import SHOWN, show, show_image, tilted
    from results import Results, ResultsError, cell_array, cell_centres, points
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid
except ModuleNotFoundError as error:
    sys.exit(f"kerf partition: the Python package {error.name} is missing; ./kerf build installs it, unless "
             "KERF_PYTHON names another Python")

COLOURS = 20  # of matplotlib's table tab20
MARKS = "os^vD<>*PX"
CHARTS = (("interface_nodes", "interface nodes"), ("element_balance", "elements, largest over mean"),
          ("mean_neighbours", "neighbours of a part, mean"), ("largest_surface_index", "surface index, largest"),
          ("contact_balance", "work of contact, largest over mean"), ("seconds", "time [s]"))


def colour_of(parts: np.ndarray) -> np.ndarray:
    """A place in the table of colours; parts whose numbers are near one another get colours that are not."""
    return (parts.astype(int) * 7) % COLOURS


def pulled_apart(grid, parts: np.ndarray, factor: float):
    """The grid with every part moved away from the middle, by `factor` times the distance of its centre."""
    cells = grid.GetCells()
    offsets = vtk_to_numpy(cells.GetOffsetsArray()).astype(np.int64)
    nodes = vtk_to_numpy(cells.GetConnectivityArray()).astype(np.int64)
    x = points(grid)
    centres = cell_centres(grid)
    middle = centres.mean(axis=0)
    n_parts = int(parts.max()) + 1
    count = np.maximum(np.bincount(parts, minlength=n_parts), 1)
    centre_of_part = np.stack([np.bincount(parts, centres[:, d], n_parts) / count for d in range(3)], axis=1)
    # Each part gets nodes of its own.
    keys = np.repeat(parts, np.diff(offsets)).astype(np.int64) * len(x) + nodes
    own, place = np.unique(keys, return_inverse=True)
    moved = x[own % len(x)] + factor * (centre_of_part - middle)[own // len(x)]
    apart = vtkUnstructuredGrid()
    where = vtkPoints()
    where.SetData(numpy_to_vtk(np.ascontiguousarray(moved), deep=True))
    apart.SetPoints(where)
    table = vtkCellArray()
    table.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True),
                  numpy_to_vtkIdTypeArray(np.ascontiguousarray(place.reshape(-1)), deep=True))
    kinds = [grid.GetCellType(i) for i in range(grid.GetNumberOfCells())]
    apart.SetCells(numpy_to_vtk(np.array(kinds, dtype=np.uint8), deep=True), table)
    return apart


def draw_parts(results: Results, row: dict, factor: float, title: str, path: Path) -> None:
    """One partition: the bodies coloured by part, and the parts pulled apart."""
    grid = results.grid(0)
    parts = cell_array(grid, f"{row['method']}_{row['parts']}").astype(int)
    apart = pulled_apart(grid, parts, factor)
    colours = colour_of(parts)
    colouring = scene.Colouring(SHOWN, -0.5, COLOURS - 0.5, map_name="tab20")
    figure = Figure(figsize=(13.0, 6.2), layout="constrained")
    panels = figure.subplots(1, 2)
    sight = np.array([-1.0, 0.0, 0.0])
    up = upright(sight, [0.0, 1.0, 0.0])
    direction = tilted(np.array([-0.6, 1.0, 0.0]), up, 0.0, 0.45)
    for axes, shown in zip(panels, (grid, apart)):
        low, high = box_of(results, [shown])
        image, pixel = scene.draw(show(shown, colours), colouring, 0, direction, up, low, high)
        show_image(axes, image, pixel)
    figure.suptitle(f"{title}\n{row['method']}, {row['parts']} parts: {row['interface_nodes']} interface nodes, "
                    f"largest over mean of elements {row['element_balance']:.3f}, surface index "
                    f"{row['surface_index']:.3f}", fontsize=11)
    figure.savefig(path, dpi=140)


def draw_charts(rows: list[dict], state: str, title: str, path: Path) -> None:
    """The measures over the number of parts, a line for each method."""
    figure = Figure(figsize=(13.0, 7.5), layout="constrained")
    panels = figure.subplots(2, 3).flat
    methods = list(dict.fromkeys(row["method"] for row in rows))
    for axes, (key, label) in zip(panels, CHARTS):
        for i, method in enumerate(methods):
            line = [(row["parts"], row[key]) for row in rows if row["method"] == method and row[key] is not None]
            if line:
                axes.plot(*zip(*line), marker=MARKS[i % len(MARKS)], markersize=4, label=plain(method))
        style(axes, label)
        axes.set_xscale("log", base=2)
        axes.set_xlabel("parts")
        if key in ("interface_nodes", "seconds") and min((row[key] for row in rows), default=0) > 0:
            axes.set_yscale("log")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(len(methods), 7), frameon=False)
    figure.suptitle(f"{title}  ·  {state}")
    figure.savefig(path, dpi=140)


def main() -> int:
    parser = argparse.ArgumentParser(prog="kerf partition", description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="folder that kerf partition has written")
    parser.add_argument("--most-parts", type=int, default=64, help="draw no subdomains of more parts than this")
    parser.add_argument("--apart", type=float, default=0.5, help="how far parts are pulled apart")
    arguments = parser.parse_args()
    folder = arguments.folder
    try:
        study = json.loads((folder / "partitions.json").read_text())
    except (OSError, json.JSONDecodeError) as failure:
        print(f"{folder}/partitions.json: error: {failure}", file=sys.stderr)
        return 1
    title = plain(Path(study["input"]).stem)
    pictures = folder / "pictures"
    pictures.mkdir(exist_ok=True)
    drawn = []
    draws = scene.choose_window() is not None
    if not draws:
        print("no way to draw in three dimensions without a screen: install libegl1 and libosmesa6", file=sys.stderr)
    for state in dict.fromkeys(row["state"] for row in study["partitions"]):
        rows = [row for row in study["partitions"] if row["state"] == state]
        draw_charts(rows, state, title, pictures / f"{state}.png")
        drawn.append(f"{state}.png")
        if not draws or not (folder / state / "results.vtkhdf").exists():
            continue
        try:
            results = Results(folder / state)
        except ResultsError as failure:
            print(f"error: {failure}", file=sys.stderr)
            return 1
        for row in rows:
            if row["parts"] > arguments.most_parts:
                continue
            name = f"{state}_{row['method']}_{row['parts']}.png"
            draw_parts(results, row, arguments.apart, title, pictures / name)
            drawn.append(name)
    print(f"pictures in {pictures}: " + ", ".join(drawn))
    return 0


if __name__ == "__main__":
    sys.exit(main())
