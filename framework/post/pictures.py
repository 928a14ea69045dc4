"""Composes the pictures of a run: three-dimensional views and cuts, with legends, scales and titles."""

from __future__ import annotations

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPlane
from vtkmodules.vtkFiltersCore import vtkCutter

import charts
import scene
from model_view import Viewpoint, box_of, find_viewpoint
from results import Results, cell_array, cell_centres, keep_cells, scalar_of

SHOWN = "kerf_shown"  # the cell array that holds what a picture is coloured by
# Field units are SI; these are brought to what an analyst reads.
SCALED = {"Pa": (1.0e-6, "MPa"), "kg/m3": (1.0, "kg/m³")}


def draw_all(results: Results, arguments, title: str, into, drawn: list[str], notes: list[str]) -> None:
    """Draws every picture that the results allow and adds its name to `drawn`; what is missing goes into `notes`."""
    grid = results.grid(len(results.times) - 1)
    if grid.GetNumberOfCells() == 0:
        notes.append("no element is left at the end: nothing to draw")
        return
    view = find_viewpoint(results, arguments.cut_normal, arguments.cut_origin)
    field = choose_field(grid, arguments.field, notes)
    limits = None
    if field is None:
        notes.append("the results hold no element field to colour cuts by")
    else:
        limits = arguments.range or field_range(results, field)
        plot_cut(results, view, field, limits, arguments.frames, title, into / "cut.png", notes)
        drawn.append("cut.png")
    if scene.choose_window() is None:
        notes.append("no way to draw in three dimensions without a screen: install libegl1 and libosmesa6")
        return
    mirror = ["xyz".index(axis) for axis in sorted(set(arguments.mirror))]
    for name, sign in (("front", 1.0), ("back", -1.0)):
        plot_side(results, view, sign, mirror, f"{title}  ·  {name}", into / f"{name}.png")
        drawn.append(f"{name}.png")
    plot_overview(results, view, field, limits, title, into / "overview.png")
    drawn.append("overview.png")


def choose_field(grid, wanted: str, notes: list[str]) -> str | None:
    present = [grid.GetCellData().GetArrayName(i) for i in range(grid.GetCellData().GetNumberOfArrays())]
    physical = [name for name in present
                if name not in ("alive", "part", "GlobalElementId", "element_id", "vtkGhostType", "kept")]
    for name in [wanted, "effective_plastic_strain", "von_mises", "pressure", *physical]:
        if name in physical:
            if name != wanted:
                notes.append(f"the results hold no field '{wanted}'; coloured by '{name}' instead")
            return name
    return None


def field_range(results: Results, field: str) -> tuple[float, float]:
    """A range that the few most extreme cells of the last frame do not stretch."""
    values = cell_array(results.grid(len(results.times) - 1), field)
    values = scalar_of(values)
    values = values[np.isfinite(values)]
    if len(values) == 0:
        return 0.0, 1.0
    low, high = np.percentile(values, [0.5, 99.5])
    if low >= 0.0:
        low = 0.0
    return (low, high) if high > low else (low, low + 1.0)


def field_label(results: Results, field: str) -> tuple[float, str]:
    stored = results.unit_of(field)
    factor, unit = SCALED.get(stored, (1.0, stored))
    return factor, charts.plain(field.replace("_", " ")) + (f" [{unit}]" if unit else "")


def show(grid, values: np.ndarray):
    array = numpy_to_vtk(np.ascontiguousarray(values, dtype=float), deep=True)
    array.SetName(SHOWN)
    grid.GetCellData().AddArray(array)
    return grid


# ---- cuts ---------------------------------------------------------------------------------------------------------


def cut_polygons(grid, view: Viewpoint) -> tuple[list[np.ndarray], np.ndarray]:
    """The outlines of the cut cells in the plane's own axes [mm], and the cell value of each."""
    plane = vtkPlane()
    plane.SetNormal(*view.cut_normal)
    plane.SetOrigin(*view.cut_origin)
    cutter = vtkCutter()
    cutter.SetInputData(grid)
    cutter.SetCutFunction(plane)
    cutter.GenerateTrianglesOff()
    cutter.Update()
    cut = cutter.GetOutput()
    if cut.GetNumberOfPolys() == 0:
        return [], np.zeros(0)
    nodes = vtk_to_numpy(cut.GetPoints().GetData()).astype(float) * 1.0e3
    flat = np.column_stack([nodes @ axis for axis in view.cut_axes])
    offsets = vtk_to_numpy(cut.GetPolys().GetOffsetsArray())
    connectivity = vtk_to_numpy(cut.GetPolys().GetConnectivityArray())
    outlines = [flat[connectivity[offsets[i]:offsets[i + 1]]] for i in range(len(offsets) - 1)]
    return outlines, vtk_to_numpy(cut.GetCellData().GetArray(SHOWN))


def plot_cut(results: Results, view: Viewpoint, field: str, limits, count: int, title: str, path, notes) -> None:
    """A mosaic of the cut plane at several times, coloured by a field, axes in mm."""
    frames = results.spread_frames(count)
    factor, label = field_label(results, field)
    norm = Normalize(limits[0] * factor, limits[1] * factor)
    axes_of_plane = view.cut_axes
    low, high = box_of(results, (results.grid(frame) for frame in (frames[0], frames[len(frames) // 2], frames[-1])))
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    box = [(middle @ axis + np.abs(axis) @ half * np.array([-1.0, 1.0])) * 1.0e3 for axis in axes_of_plane]
    width, height = np.ptp(box[0]), np.ptp(box[1])
    columns = min(len(frames), 3 if width > 0.7 * height else 6)
    rows = -(-len(frames) // columns)
    panel = 3.6 if columns <= 3 else 2.6
    tall = min(max(panel * height / width, 0.9), 9.0)  # inches; the marks and names beside a thin body need some room
    figure = Figure(figsize=(panel * columns + 1.2, tall * rows + 1.2), layout="constrained")
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    empty = True
    for axes, frame in zip(panels.flat, frames):
        grid = results.grid(frame)
        show(grid, scalar_of(cell_array(grid, field)) * factor)
        outlines, values = cut_polygons(grid, view)
        empty = empty and not outlines
        line = 0.15 if len(outlines) < 20000 else 0.0
        axes.add_collection(PolyCollection(outlines, array=values, cmap="turbo", norm=norm,
                                           edgecolors=(0.0, 0.0, 0.0, 0.35), linewidths=line))
        axes.set_title(f"{results.times[frame] * 1.0e6:.4g} µs", fontsize=10)
        axes.set(xlim=box[0], ylim=box[1], aspect="equal")
        axes.yaxis.set_major_locator(MaxNLocator(int(np.clip(3.0 * panel * height / width, 1, 9)), min_n_ticks=1))
        axes.set_facecolor("#f7fafc")
    for axes in panels.flat[len(frames):]:
        axes.set_visible(False)
    figure.supxlabel(f"{axis_name(axes_of_plane[0])} [mm]", fontsize=10)
    figure.supylabel(f"{axis_name(axes_of_plane[1])} [mm]", fontsize=10)
    figure.colorbar(ScalarMappable(norm, "turbo"), ax=panels, label=label, shrink=0.8, extend="both")
    figure.suptitle(title)
    figure.savefig(path, dpi=150)
    if empty:
        notes.append("the cut plane meets no element; choose another with --cut-normal and --cut-origin")


def axis_name(axis: np.ndarray) -> str:
    largest = int(np.argmax(np.abs(axis)))
    if abs(axis[largest]) > 0.999:
        return "xyz"[largest] if axis[largest] > 0.0 else "−" + "xyz"[largest]
    return "(" + ", ".join(f"{value:.2g}" for value in axis) + ")"


# ---- three-dimensional views --------------------------------------------------------------------------------------


def part_values(grid) -> np.ndarray:
    part = cell_array(grid, "part")
    return np.zeros(grid.GetNumberOfCells()) if part is None else part.astype(float)


def tilted(along: np.ndarray, up: np.ndarray, sideways: float, upwards: float) -> np.ndarray:
    """A line of sight that follows `along` but looks a little from the side and from above."""
    side = np.cross(along, up)
    return along + sideways * side / np.linalg.norm(side) - upwards * up


def part_legend(figure, results: Results) -> None:
    names = results.part_names()
    if not names:
        return
    colours = scene.PART_COLOURS
    patches = [Patch(facecolor=colours[number % len(colours)], label=charts.plain(name))
               for number, name in names.items()]
    figure.legend(handles=patches[:16], loc="outside lower center", ncols=min(len(patches), 6), frameon=False)


def scale_bar(axes, pixel: float, image: np.ndarray) -> None:
    """A bar of a round length; the projection is parallel, so it holds everywhere in the image."""
    rows, columns = image.shape[:2]
    wanted = 0.2 * columns * pixel * 1.0e3
    power = 10.0 ** np.floor(np.log10(wanted))
    length = max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted)
    x, y, bar = 0.04 * columns, 0.96 * rows, length * 1.0e-3 / pixel
    axes.plot([x, x + bar], [y, y], color="black", linewidth=2.5, solid_capstyle="butt")
    axes.text(x + 0.5 * bar, y - 0.015 * rows, f"{length:g} mm", ha="center", va="bottom", fontsize=9)


def show_image(axes, image: np.ndarray, pixel: float) -> None:
    axes.imshow(image)
    axes.set_axis_off()
    scale_bar(axes, pixel, image)


def mirrored_box(view: Viewpoint, mirror: list[int]) -> tuple[np.ndarray, np.ndarray]:
    low, high = view.low.copy(), view.high.copy()
    for axis in mirror:
        reach = max(abs(low[axis]), abs(high[axis]))
        low[axis], high[axis] = -reach, reach
    return low, high


def plot_side(results: Results, view: Viewpoint, sign: float, mirror: list[int], title: str, path) -> None:
    """The bodies at the end, seen along the impact (sign 1) or against it (sign -1)."""
    grid = results.grid(len(results.times) - 1)
    show(grid, part_values(grid))
    grid = scene.reflect(grid, mirror)
    low, high = mirrored_box(view, mirror)
    n_parts = max(results.part_names(), default=0) + 1
    direction = tilted(sign * view.impact, view.up, 0.35, 0.3)
    image, pixel = scene.draw(grid, scene.Colouring(SHOWN, by_part=True), n_parts, direction, view.up, low, high)
    figure = Figure(figsize=(9.0, 8.0), layout="constrained")
    axes = figure.subplots()
    show_image(axes, image, pixel)
    part_legend(figure, results)
    figure.suptitle(title)
    figure.savefig(path, dpi=140)


def behind_cut(grid, view: Viewpoint):
    """The whole cells behind the cut plane; all cells where the model ends at the plane."""
    behind = (cell_centres(grid) - view.cut_origin) @ view.cut_normal >= 0.0
    if behind.all() or not behind.any():
        return grid
    return keep_cells(grid, behind)


def plot_overview(results: Results, view: Viewpoint, field: str | None, limits, title: str, path) -> None:
    """The bodies cut open, at an intermediate time and at the end."""
    middle = results.nearest_frame(0.5 * (results.times[0] + results.times[-1]))
    frames = sorted({middle, len(results.times) - 1})
    n_parts = max(results.part_names(), default=0) + 1
    factor, label = field_label(results, field) if field else (1.0, "")
    figure = Figure(figsize=(6.0 * len(frames) + 1.0, 6.5), layout="constrained")
    panels = figure.subplots(1, len(frames), squeeze=False)[0]
    low, high = box_of(results, (behind_cut(results.grid(frame), view) for frame in frames))
    up = view.cut_axes[1]
    for axes, frame in zip(panels, frames):
        grid = behind_cut(results.grid(frame), view)
        if field:
            colouring = scene.Colouring(SHOWN, limits[0] * factor, limits[1] * factor)
            show(grid, scalar_of(cell_array(grid, field)) * factor)
        else:
            colouring = scene.Colouring(SHOWN, by_part=True)
            show(grid, part_values(grid))
        direction = tilted(view.cut_normal, up, 0.35 if view.impact.sum() > 0.0 else -0.35, 0.35)
        image, pixel = scene.draw(grid, colouring, n_parts, direction, up, low, high)
        show_image(axes, image, pixel)
        axes.set_title(f"{results.times[frame] * 1.0e6:.4g} µs", fontsize=11)
    if field:
        norm = Normalize(limits[0] * factor, limits[1] * factor)
        figure.colorbar(ScalarMappable(norm, "turbo"), ax=panels, label=label, shrink=0.7, extend="both")
    else:
        part_legend(figure, results)
    figure.suptitle(title)
    figure.savefig(path, dpi=140)
