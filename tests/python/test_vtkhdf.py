"""results.vtkhdf, written on several ranks, opens in VTK with every frame, field and hidden cell in its place."""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

vtk_io = pytest.importorskip("vtkmodules.vtkIOHDF")
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes  # noqa: E402
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline  # noqa: E402

N_ELEMENTS = 23
N_FRAMES = 5
MPIRUN = ["--oversubscribe", "--allow-run-as-root", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1"]


def output_test_program() -> Path | None:
    """The C++ test program, which also writes the file that is read here."""
    if "KERF_OUTPUT_TEST" in os.environ:
        return Path(os.environ["KERF_OUTPUT_TEST"])
    path = Path(os.environ.get("KERF_BUILD_DIR", "build")) / "tests" / "kerf_parallel_tests"
    return path if path.exists() else None


@pytest.fixture(scope="module", params=[1, 2, 3], ids=lambda ranks: f"{ranks}_ranks")
def folder(request, tmp_path_factory):
    program = output_test_program()
    if program is None or shutil.which("mpirun") is None:
        pytest.skip("needs mpirun and the C++ tests (build with KERF_TESTS=ON)")
    folder = tmp_path_factory.mktemp("vtkhdf")
    subprocess.run(
        ["mpirun", "-n", str(request.param), *MPIRUN, str(program), "--gtest_filter=Results.file_for_vtk"],
        check=True,
        env={**os.environ, "KERF_TEST_OUTPUT": str(folder)},
        timeout=120,
    )
    return folder


@pytest.fixture(params=["for_vtk.vtkhdf", "for_vtk_double.vtkhdf"])
def reader(request, folder):
    reader = vtk_io.vtkHDFReader()
    reader.SetFileName(str(folder / request.param))
    reader.UpdateInformation()
    return reader


def grid_at(reader, frame):
    reader.SetStep(frame)
    reader.Update()
    output = reader.GetOutputDataObject(0)
    return output.GetPartition(0) if output.IsA("vtkPartitionedDataSet") else output


def lives(frame):
    elements = np.arange(N_ELEMENTS)
    return (elements % 5 != 0) | (frame < 2)


def test_all_frames_are_there_with_their_times(reader):
    assert reader.GetNumberOfSteps() == N_FRAMES
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    assert np.allclose(times, 1e-6 * np.arange(N_FRAMES), rtol=1e-15, atol=0)


@pytest.mark.parametrize("frame", [3, 0, 4, 2, 1])
def test_points_move_and_dropped_nodes_stay(reader, frame):
    grid = grid_at(reader, frame)
    points = vtk_to_numpy(grid.GetPoints().GetData())
    node = np.arange(4 * (N_ELEMENTS + 1))
    dropped = (node // 4 == N_ELEMENTS) & (frame >= 3)  # not written any more; last seen in frame 2
    stretch = np.where(dropped, 1.0 + 0.5 * 2, 1.0 + 0.5 * frame)
    assert points.shape == (node.size, 3)
    assert np.array_equal(points[:, 0], (node // 4) * stretch)
    assert np.array_equal(points[:, 2], np.where(node % 4 >= 2, 1.0, 0.0))


@pytest.mark.parametrize("frame", [1, 0, 2])
def test_cells_are_hexahedra_with_positive_volume(reader, frame):
    grid = grid_at(reader, frame)
    assert grid.GetNumberOfCells() == N_ELEMENTS
    points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    for i in range(N_ELEMENTS):
        assert grid.GetCellType(i) == 12
        ids = [grid.GetCell(i).GetPointId(k) for k in range(8)]
        a, b, d, e = points[ids[0]], points[ids[1]], points[ids[3]], points[ids[4]]
        assert np.dot(np.cross(b - a, d - a), e - a) > 0
        assert ids[0] == 4 * i


@pytest.mark.parametrize("frame", range(N_FRAMES))
def test_fields_belong_to_their_frame(reader, frame):
    grid = grid_at(reader, frame)
    element = np.arange(N_ELEMENTS)[:, None]
    stress = vtk_to_numpy(grid.GetCellData().GetArray("stress"))
    expected = np.where(lives(frame)[:, None], element * 10 + np.arange(6) + 0.25 * frame, 0.0)
    assert np.array_equal(stress, expected)
    node = np.arange(4 * (N_ELEMENTS + 1))
    dropped = (node // 4 == N_ELEMENTS) & (frame >= 3)
    speed = vtk_to_numpy(grid.GetPointData().GetArray("speed"))
    assert np.array_equal(speed, np.where(dropped, 0.0, node + frame))


@pytest.mark.parametrize("frame", range(N_FRAMES))
def test_dead_cells_are_hidden(reader, frame):
    grid = grid_at(reader, frame)
    hidden = vtkDataSetAttributes.HIDDENCELL
    alive = vtk_to_numpy(grid.GetCellData().GetArray("alive"))
    ghost = grid.GetCellData().GetArray(vtkDataSetAttributes.GhostArrayName())
    assert ghost.GetDataTypeAsString() == "unsigned char"
    assert np.array_equal(alive, lives(frame))
    assert np.array_equal(vtk_to_numpy(ghost), np.where(lives(frame), 0, hidden))
    assert grid.GetCellGhostArray() is not None


def test_cell_data_that_never_changes_is_stored_once(reader):
    h5py = pytest.importorskip("h5py")
    with h5py.File(reader.GetFileName(), "r") as file:
        assert file["VTKHDF/CellData/part"].shape == (N_ELEMENTS,)
        assert file["VTKHDF/Connectivity"].shape == (8 * N_ELEMENTS,)
        assert list(file["Kerf/part_names"].asstr()[:]) == ["rod", "plate"]
    for frame in (0, N_FRAMES - 1):
        cells = grid_at(reader, frame).GetCellData()
        assert np.array_equal(vtk_to_numpy(cells.GetArray("GlobalElementId")), np.arange(N_ELEMENTS))
        assert np.array_equal(vtk_to_numpy(cells.GetArray("part")), np.arange(N_ELEMENTS) >= N_ELEMENTS // 2)
