"""Reads what a run has written: results.vtkhdf, history.csv, history.h5, erosion.csv and summary.json."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import h5py
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkFiltersCore import vtkAppendFilter, vtkThreshold
from vtkmodules.vtkIOHDF import vtkHDFReader

HIDDEN = 32  # the bit of vtkGhostType that hides a cell


class ResultsError(Exception):
    """A result that cannot be read, with a sentence that says what to do."""


def read_summary(folder: Path) -> dict:
    """summary.json, or an empty dictionary where the run has not written one."""
    path = folder / "summary.json"
    if not path.exists():
        return {}
    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ResultsError(f"{path} cannot be read: {error}") from error
    if not isinstance(summary, dict):
        raise ResultsError(f"{path} is no summary of a run")
    return summary


def read_history(path: Path) -> dict[str, np.ndarray]:
    """The columns of a CSV file, named without their units: {'time': ..., 'kinetic': ...}."""
    if not path.exists():
        return {}
    try:
        return columns_of(path)
    except (OSError, ValueError, csv.Error) as error:
        raise ResultsError(f"{path} cannot be read: {error}") from error


def columns_of(path: Path) -> dict[str, np.ndarray]:
    with path.open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.reader(file) if row]
    if not rows:
        return {}
    names = [name.split("[")[0].strip() for name in rows[0]]
    # A run that was killed may leave a last line that is not complete.
    values = [row for row in rows[1:] if len(row) == len(names)]
    table = np.array(values, dtype=float).reshape(len(values), len(names))
    return {name: table[:, i] for i, name in enumerate(names)}


def energies_of(path: Path) -> list[str]:
    """The names of the columns of history.csv that are energies."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        header = next(csv.reader(file), [])
    return [name.split("[")[0].strip() for name in header if name.endswith("[J]")]


def read_observers(path: Path) -> dict[str, dict[str, np.ndarray]]:
    """The columns of history.h5 by observer: {'nose': {'time': ..., 'pressure': ...}}."""
    if not path.exists():
        return {}
    try:
        with h5py.File(path, "r") as file:
            return {name: {column: data[()] for column, data in group.items()} for name, group in file.items()}
    except (OSError, KeyError, RuntimeError, ValueError) as error:
        raise ResultsError(f"{path} cannot be read: {error}") from error


def units_of_observers(path: Path) -> dict[str, dict[str, str]]:
    """The units of these columns: {'nose': {'time': 's', 'pressure': 'Pa'}}."""
    if not path.exists():
        return {}
    before = "unit of "
    with h5py.File(path, "r") as file:
        return {name: {key[len(before):]: bytes(np.bytes_(group.attrs[key])).decode("utf-8").rstrip("\0")
                       for key in group.attrs if key.startswith(before)} for name, group in file.items()}


def require_whole_frames(path: Path) -> None:
    """Throws ResultsError where a file is damaged in a way that the reader, which trusts it, would not survive."""
    try:
        with h5py.File(path, "r") as file:
            steps = file["VTKHDF/Steps"]
            n_steps = int(steps.attrs["NSteps"])
            tables = [name for name in ("Values", "PartOffsets", "PointOffsets") if name in steps]
            whole = n_steps > 0 and all(len(steps[name]) == n_steps for name in tables)
    except (OSError, KeyError, RuntimeError, TypeError, ValueError) as error:
        raise ResultsError(f"{path} cannot be read: {error}") from error
    if not whole:
        raise ResultsError(f"{path} holds no frame, or its tables of frames are not equally long")


class Results:
    """The field results of one run, frame by frame."""

    def __init__(self, folder: Path):
        self.folder = Path(folder)
        path = self.folder / "results.vtkhdf"
        if not path.exists():
            raise ResultsError(f"there is no {path}; did the run write field results (output.results_interval)?")
        require_whole_frames(path)
        self._reader = vtkHDFReader()
        self._reader.SetFileName(str(path))
        self._reader.UpdateInformation()
        information = self._reader.GetOutputInformation(0)
        steps = vtkStreamingDemandDrivenPipeline.TIME_STEPS()
        self.times = np.array(information.Get(steps) or [0.0])
        self._part_names: dict[int, str] | None = None

    def nearest_frame(self, time: float) -> int:
        return int(np.argmin(np.abs(self.times - time)))

    def spread_frames(self, count: int) -> list[int]:
        """At most `count` frames, evenly spread in time, first and last included."""
        wanted = np.linspace(self.times[0], self.times[-1], count)
        return sorted({self.nearest_frame(time) for time in wanted})

    def whole_grid(self, frame: int) -> vtkUnstructuredGrid:
        """All cells of a frame, eroded ones too."""
        self._reader.UpdateTimeStep(float(self.times[frame]))
        output = self._reader.GetOutputDataObject(0)
        if not isinstance(output, vtkUnstructuredGrid):
            append = vtkAppendFilter()
            for i in range(output.GetNumberOfPartitions()):
                append.AddInputData(output.GetPartition(i))
            append.Update()
            output = append.GetOutput()
        if output is None or output.GetNumberOfPoints() == 0:
            raise ResultsError(f"{self.folder / 'results.vtkhdf'} holds no readable frame; is the run complete?")
        grid = vtkUnstructuredGrid()
        grid.ShallowCopy(output)
        return grid

    def grid(self, frame: int) -> vtkUnstructuredGrid:
        """The cells of a frame that are alive."""
        grid = self.whole_grid(frame)
        alive = cell_array(grid, "alive")
        if alive is None:
            ghost = cell_array(grid, "vtkGhostType")
            alive = np.ones(grid.GetNumberOfCells()) if ghost is None else (ghost & HIDDEN) == 0
        # Filters would drop or keep hidden cells by rules of their own; `alive` alone decides here.
        grid.GetCellData().RemoveArray("vtkGhostType")
        grid.GetPointData().RemoveArray("vtkGhostType")
        if np.all(alive):
            return grid
        return keep_cells(grid, alive)

    def part_names(self) -> dict[int, str]:
        """The name of each value of the cell array `part`."""
        if self._part_names is None:
            self._part_names = self._read_part_names()
        return self._part_names

    def unit_of(self, field: str) -> str:
        """The unit of a field in SI units; empty where the file does not know it or it has none."""
        with h5py.File(self.folder / "results.vtkhdf", "r") as file:
            if "Kerf/field_units" not in file:
                return ""
            names, units = (list(file[f"Kerf/{name}"].asstr()[:]) for name in ("field_names", "field_units"))
        unit = dict(zip(names, units)).get(field, "")
        return "" if unit == "-" else unit

    def _read_part_names(self) -> dict[int, str]:
        grid = self.whole_grid(0)
        part = cell_array(grid, "part")
        numbers = [] if part is None else [int(number) for number in np.unique(part)]
        with h5py.File(self.folder / "results.vtkhdf", "r") as file:
            stored = file["Kerf/part_names"].asstr()[:] if "Kerf/part_names" in file else []
        names = [str(name) for name in stored]
        return {n: names[n] if n < len(names) and names[n] else f"part {n}" for n in numbers}


def keep_cells(grid, keep: np.ndarray):
    """The cells for which `keep` is not zero, with their data."""
    mask = numpy_to_vtk(np.ascontiguousarray(keep != 0, dtype=np.uint8), deep=True)
    mask.SetName("kept")
    grid.GetCellData().AddArray(mask)
    threshold = vtkThreshold()
    threshold.SetInputData(grid)
    threshold.SetInputArrayToProcess(0, 0, 0, 1, "kept")  # 1: cell data
    threshold.SetLowerThreshold(0.5)
    threshold.SetUpperThreshold(1.5)
    threshold.SetThresholdFunction(vtkThreshold.THRESHOLD_BETWEEN)
    threshold.Update()
    return threshold.GetOutput()


def cell_array(grid, name: str) -> np.ndarray | None:
    array = grid.GetCellData().GetArray(name)
    return None if array is None else vtk_to_numpy(array)


def node_array(grid, name: str) -> np.ndarray | None:
    array = grid.GetPointData().GetArray(name)
    return None if array is None else vtk_to_numpy(array)


def points(grid) -> np.ndarray:
    """The coordinates of all nodes [m]."""
    return vtk_to_numpy(grid.GetPoints().GetData()).astype(float)


def cell_centres(grid) -> np.ndarray:
    """The mean of each cell's nodes [m]."""
    if grid.GetNumberOfCells() == 0:
        return np.zeros((0, 3))
    cells = grid.GetCells()
    offsets = vtk_to_numpy(cells.GetOffsetsArray()).astype(np.int64)
    corners = points(grid)[vtk_to_numpy(cells.GetConnectivityArray())]
    return np.add.reduceat(corners, offsets[:-1], axis=0) / np.diff(offsets)[:, None]


def scalar_of(values: np.ndarray) -> np.ndarray:
    """A field as one number per cell: the length of vectors, the largest size of tensors' entries."""
    if values.ndim == 1:
        return values.astype(float)
    if values.shape[1] == 3:
        return np.linalg.norm(values, axis=1)
    return np.abs(values).max(axis=1)
