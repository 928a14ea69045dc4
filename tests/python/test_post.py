"""Pictures and comparisons of finished runs, on a small result written here: a rod that has passed a plate."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

POST = Path(__file__).resolve().parents[2] / "framework" / "post"
TIMES = np.linspace(0.0, 40.0e-6, 5)  # [s]
SPEED = 800.0  # of the rod [m/s]


def block(cells, low, high):
    """Nodes and hexahedra of a regular block."""
    axes = [np.linspace(low[i], high[i], cells[i] + 1) for i in range(3)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    i, j, k = np.meshgrid(*(np.arange(n) for n in cells), indexing="ij")
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    ids = [((i + a) * (cells[1] + 1) + j + b) * (cells[2] + 1) + k + c for a, b, c in corners]
    return nodes, np.stack(ids, -1).reshape(-1, 8)


def write_results(path, with_strain):
    plate, plate_cells = block((3, 12, 12), (0.0, -0.03, -0.03), (0.009, 0.03, 0.03))
    rod, rod_cells = block((8, 2, 2), (-0.03, -0.004, -0.004), (0.0, 0.004, 0.004))
    nodes, cells = np.vstack([plate, rod]), np.vstack([plate_cells, rod_cells + len(plate)])
    n_nodes, n_cells, frame = len(nodes), len(cells), np.arange(len(TIMES))
    part = (np.arange(n_cells) >= len(plate_cells)).astype("i4")
    moves = np.arange(n_nodes) >= len(plate)
    centre = nodes[cells].mean(axis=1)
    radius = np.hypot(centre[:, 1], centre[:, 2])
    alive = [~((part == 0) & (radius < 0.006) & (centre[:, 0] < SPEED * t)) for t in TIMES]
    fields = {"alive": np.concatenate(alive).astype("u1"),
              "vtkGhostType": np.where(np.concatenate(alive), 0, 32).astype("u1")}
    if with_strain:
        fields["effective_plastic_strain"] = np.concatenate([np.exp(-radius / 0.01) * t / TIMES[-1] for t in TIMES])
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array([2, 0])
        root.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", 16))
        root["NumberOfPoints"], root["NumberOfCells"] = [n_nodes], [n_cells]
        root["NumberOfConnectivityIds"] = [8 * n_cells]
        root["Connectivity"], root["Offsets"] = cells.ravel(), 8 * np.arange(n_cells + 1)
        root["Types"] = np.full(n_cells, 12, "u1")
        root["Points"] = np.vstack([nodes + np.outer(moves, [SPEED * t, 0.0, 0.0]) for t in TIMES]).astype("f4")
        root["PointData/velocity"] = np.tile(np.outer(moves, [SPEED, 0.0, 0.0]), (len(TIMES), 1)).astype("f4")
        root["CellData/part"] = part
        steps = root.create_group("Steps")
        steps.attrs["NSteps"] = len(TIMES)
        steps["Values"], steps["NumberOfParts"], steps["PointOffsets"] = TIMES, 0 * frame + 1, frame * n_nodes
        for name in ("PartOffsets", "CellOffsets", "ConnectivityIdOffsets", "CellDataOffsets/part"):
            steps[name] = 0 * frame
        steps["PointDataOffsets/velocity"] = frame * n_nodes
        for name, values in fields.items():
            root[f"CellData/{name}"], steps[f"CellDataOffsets/{name}"] = values, frame * n_cells
        names = file.create_dataset("Kerf/part_names", 2, h5py.string_dtype())
        names[:] = ["plate", "rod"]


def write_run(folder, kinetic=2.0, state_hash="12ab", with_strain=True):
    folder.mkdir()
    write_results(folder / "results.vtkhdf", with_strain)
    columns = {"time [s]": TIMES, "kinetic [J]": kinetic + 0.0 * TIMES, "internal [J]": 0.0 * TIMES,
               "balance_error [-]": 0.0 * TIMES, "eroded_count [-]": np.arange(len(TIMES)),
               "imbalance [-]": 1.0 + 0.0 * TIMES, "dt [s]": 1.0e-8 + 0.0 * TIMES}
    with (folder / "history.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values()))
    summary = {"input": "rod.yaml", "end_time": TIMES[-1], "state_hash": state_hash, "ranks": 2,
               "wall_seconds": kinetic, "energy": {"kinetic": kinetic}, "eroded": {"elements": 4}}
    (folder / "summary.json").write_text(json.dumps(summary))
    return folder


def run_tool(name, *arguments):
    return subprocess.run([sys.executable, "-B", POST / name, *map(str, arguments)], capture_output=True, text=True)


def test_plot_draws_every_picture_and_none_is_blank(tmp_path):
    image = pytest.importorskip("matplotlib.image")
    run = write_run(tmp_path / "run")
    done = run_tool("plot.py", run)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    for name in ("front", "back", "cut", "overview", "energies", "progress"):
        pixels = image.imread(run / "plots" / f"{name}.png")[..., :3]
        white = np.mean(np.all(pixels > 0.99, axis=-1))
        black = np.mean(np.all(pixels < 0.01, axis=-1))
        assert 0.2 < white < 0.99, f"{name}.png: {white:.0%} white"
        assert black < 0.2, f"{name}.png: {black:.0%} black"


def test_plot_says_which_field_is_missing(tmp_path):
    run = write_run(tmp_path / "run", with_strain=False)
    done = run_tool("plot.py", run)
    assert done.returncode == 0
    assert "no element field to colour cuts by" in done.stderr
    assert (run / "plots" / "overview.png").exists()


def test_plot_draws_history_where_field_results_are_missing(tmp_path):
    run = write_run(tmp_path / "run")
    (run / "results.vtkhdf").unlink()
    done = run_tool("plot.py", run)
    assert done.returncode == 0
    assert "results.vtkhdf" in done.stderr
    assert (run / "plots" / "energies.png").exists()


def test_compare_finds_equal_runs_equal_whatever_the_time_they_took(tmp_path):
    a, b = write_run(tmp_path / "a"), write_run(tmp_path / "b")
    done = run_tool("compare.py", a, b)
    assert done.returncode == 0, done.stdout
    assert "bit for bit" in done.stdout


def test_compare_finds_a_difference_beyond_the_tolerance(tmp_path):
    a, b = write_run(tmp_path / "a"), write_run(tmp_path / "b", kinetic=2.02, state_hash="34cd")
    assert run_tool("compare.py", a, b).returncode == 3
    assert "energy.kinetic" in run_tool("compare.py", a, b).stdout
    assert run_tool("compare.py", a, b, "--tolerance", "0.05").returncode == 0
