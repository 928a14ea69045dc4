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


def write_results(path, with_strain, plate_alone=None):
    plate, plate_cells = block(plate_alone or (3, 12, 12), (0.0, -0.03, -0.03), (0.009, 0.03, 0.03))
    rod, rod_cells = block((8, 2, 2), (-0.03, -0.004, -0.004), (0.0, 0.004, 0.004))
    if plate_alone:
        rod, rod_cells = rod[:0], rod_cells[:0]
    nodes, cells = np.vstack([plate, rod]), np.vstack([plate_cells, rod_cells + len(plate)])
    n_nodes, n_cells, frame = len(nodes), len(cells), np.arange(len(TIMES))
    part = (np.arange(n_cells) >= len(plate_cells)).astype("i4")
    moves = np.arange(n_nodes) >= len(plate)
    centre = nodes[cells].mean(axis=1)
    radius = np.hypot(centre[:, 1], centre[:, 2])
    hit = (part == 0) & (radius < 0.006) & (not plate_alone)
    alive = [~(hit & (centre[:, 0] < SPEED * t)) for t in TIMES]
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


def write_run(folder, kinetic=2.0, state_hash="12ab", with_strain=True, internal=0.0, **more):
    folder.mkdir()
    write_results(folder / "results.vtkhdf", with_strain)
    columns = {"time [s]": TIMES, "kinetic [J]": kinetic + 0.0 * TIMES, "internal [J]": internal + 0.0 * TIMES,
               "balance_error [-]": 0.0 * TIMES, "eroded_count [-]": np.arange(len(TIMES)),
               "imbalance [-]": 1.0 + 0.0 * TIMES, "dt [s]": 1.0e-8 + 0.0 * TIMES}
    with (folder / "history.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values()))
    summary = {"input": "rod.yaml", "end_time": TIMES[-1], "state_hash": state_hash, "ranks": 2,
               "wall_seconds": kinetic, "energy": {"kinetic": kinetic}, "eroded": {"elements": 4}, **more}
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


def said(done):
    """The last line of what a command said on stderr, without a traceback."""
    assert "Traceback" not in done.stderr, done.stderr
    return done.stderr.strip().splitlines()[-1] if done.stderr.strip() else ""


def post_module(name):
    sys.path.insert(0, str(POST))
    try:
        return __import__(name)
    finally:
        sys.path.remove(str(POST))


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    return write_run(tmp_path_factory.mktemp("finished") / "run")


ODD = {
    "--cut-normal 0 0 0": "--cut-normal must not be zero",
    "--cut-normal nan 0 1": "--cut-normal takes numbers of a usual size, not nan 0 1",
    "--cut-normal 0 1e-300 0": "--cut-normal takes numbers of a usual size, not 0 1e-300 0",
    "--cut-origin 0 -inf 0": "--cut-origin takes numbers of a usual size, not 0 -inf 0",
    "--range 1 0": "--range takes the lower end first, then the upper, not 1 0",
    "--range 2 2": "--range takes the lower end first, then the upper, not 2 2",
    "--range nan 2": "--range takes numbers of a usual size, not nan 2",
    "--frames 0": "--frames has to be from 1 to 60, not 0",
    "--frames 1000000000": "--frames has to be from 1 to 60, not 1000000000",
    "--frames many": "argument --frames: invalid int value: 'many'",
    "--mirror q": "--mirror takes letters of x, y and z, not 'q'",
}


@pytest.mark.parametrize("words", ODD)
def test_plot_refuses_odd_values_in_a_sentence(words, finished, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["plot.py", str(finished), *words.split()])
    with pytest.raises(SystemExit, match="2"):
        post_module("plot").main()
    assert capsys.readouterr().err.splitlines()[-1] == f"kerf plot: error: {ODD[words]}"
    assert not (finished / "plots").exists()


@pytest.mark.parametrize("words, note", [
    ("--cut-normal 0 0 1", ""), ("--cut-normal 0 0 -1e-3 --cut-origin 0 -1e-3 0", ""), ("--cut-normal 1 0 0", ""),
    ("--cut-origin 0 5 0", "the cut plane meets no element; choose another with --cut-normal and --cut-origin"),
    ("--field none", "the results hold no field 'none'; coloured by 'effective_plastic_strain' instead"),
    ("--range -1e9 1e9 --frames 60 --mirror yzzy", "")])
def test_plot_draws_with_unusual_values(words, note, finished, tmp_path):
    done = run_tool("plot.py", finished, "--into", tmp_path, *words.split())
    assert done.returncode == 0 and said(done) == (f"kerf plot: {note}" if note else "")
    assert (tmp_path / "cut.png").exists() and (tmp_path / "overview.png").exists()


def test_plot_says_why_a_folder_cannot_be_written(finished):
    done = run_tool("plot.py", finished, "--into", finished / "summary.json")
    assert done.returncode == 1 and said(done).endswith("summary.json: File exists")


DAMAGES = [("summary.json", b'{"input": "rod.ya'), ("summary.json", b"[]"), ("summary.json", b"\xff\xfe"),
           ("history.csv", b"time [s],kinetic [J]\n0,much\n"), ("history.csv", b"\xff\xfe"), ("results.vtkhdf", b""),
           ("results.vtkhdf", b"no HDF5")]


@pytest.mark.parametrize("name, content", DAMAGES)
def test_a_damaged_file_is_named(name, content, tmp_path):
    results = post_module("results")
    read = {"summary.json": lambda p: results.read_summary(p.parent), "history.csv": results.read_history,
            "results.vtkhdf": lambda p: results.Results(p.parent)}
    (tmp_path / name).write_bytes(content)
    with pytest.raises(results.ResultsError, match=name):
        read[name](tmp_path / name)


@pytest.mark.parametrize("name, content", [DAMAGES[0], DAMAGES[3], DAMAGES[5]])
def test_plot_draws_the_rest_where_a_file_is_damaged(name, content, tmp_path):
    run = write_run(tmp_path / "run")
    (run / name).write_bytes(content)
    done = run_tool("plot.py", run)
    assert done.returncode == 0 and name in said(done)
    assert (run / "plots" / "progress.png").exists() == (name != "history.csv")
    assert (run / "plots" / "cut.png").exists() == (name != "results.vtkhdf")


def test_plot_does_not_trust_a_file_whose_tables_do_not_fit_together(tmp_path):
    """The reader would write beyond its memory."""
    run = write_run(tmp_path / "run")
    with h5py.File(run / "results.vtkhdf", "a") as file:
        file["VTKHDF/Steps"].attrs["NSteps"] = len(TIMES) - 1
    done = run_tool("plot.py", run)
    assert done.returncode == 0 and "its tables of frames are not equally long" in said(done)


def test_plot_draws_a_model_of_one_cell(tmp_path):
    run = write_run(tmp_path / "run")
    write_results(run / "results.vtkhdf", True, plate_alone=(1, 1, 1))
    done = run_tool("plot.py", run)
    assert done.returncode == 0 and said(done) == ""


def test_a_cut_keeps_the_global_axes_upright():
    """Whatever the direction of the impact: that of an oblique rod turned its plate by 45 degrees."""
    viewpoint = post_module("model_view").Viewpoint
    impact = np.array([1.0, 0.0, -1.0]) / np.sqrt(2.0)
    for normal, right, up in [((0, 1, 0), (1, 0, 0), (0, 0, 1)), ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
                              ((1, 0, 0), (0, 1, 0), (0, 0, 1)), ((0, 0, 1), (1, 0, 0), (0, 1, 0)),
                              ((0, 0, -1), (1, 0, 0), (0, 1, 0)), ((0.6, 0, 0.8), (0.8, 0, -0.6), (0, 1, 0)),
                              ((0.8, 0, 0.6), (0, 1, 0), (-0.6, 0, 0.8))]:
        view = viewpoint(impact, None, np.array(normal, dtype=float), None, None, None)
        assert np.allclose(view.cut_axes, [right, up]), normal


def test_plots_bear_the_title_of_the_input(tmp_path):
    title_of = post_module("plot").title_of
    summary = {"input": "in/rod.yaml", "title": "a rod", "end_time": 1e-6}
    assert title_of(tmp_path / "run", summary) == "a rod  ·  1 µs"
    assert title_of(tmp_path / "run", {"input": "in/rod.yaml", "title": "", "end_time": None}) == "rod"
    assert title_of(tmp_path / "run", {}) == "run"
    # Text between dollar signs would be taken for a formula.
    run = write_run(tmp_path / "run", title=r"costs 3 $ or \frac $ " + 200 * "long ")
    done = run_tool("plot.py", run)
    assert done.returncode == 0 and said(done) == ""


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


def test_compare_tells_null_from_a_number(tmp_path):
    a = write_run(tmp_path / "a", measures={"hole.perforated": None, "length": 0.5}, title="one")
    b = write_run(tmp_path / "b", measures={"hole.perforated": 0.0, "length": 0.5}, title="other")
    done = run_tool("compare.py", a, b, "--tolerance", 1)
    row = next(line.split() for line in done.stdout.splitlines() if line.startswith("measures.hole.perforated"))
    assert row == ["measures.hole.perforated", "null", "0.0", "*", "DIFFERS"]
    assert done.returncode == 3 and "1 quantities (marked *) differ" in done.stdout
    assert run_tool("compare.py", a, a).returncode == 0


@pytest.mark.parametrize("change", ["no number", "no column", "no rows"])
def test_compare_does_not_pass_over_what_is_missing_in_one_history(change, tmp_path):
    a, b = write_run(tmp_path / "a"), write_run(tmp_path / "b")
    path = b / "history.csv"
    rows = list(csv.reader(path.open()))
    if change == "no number":
        rows[3][2] = "nan"
    else:
        rows = [row[:2] + row[3:] for row in rows] if change == "no column" else rows[:1]
    path.write_text("\n".join(",".join(row) for row in rows))
    for pair in ((a, b), (b, a)):
        done = run_tool("compare.py", *pair, "--tolerance", 0.5)
        assert done.returncode == 3, done.stdout
    assert run_tool("compare.py", b, b).returncode == 0


def test_compare_says_what_cannot_be_read(tmp_path):
    a, b = write_run(tmp_path / "a"), write_run(tmp_path / "b")
    (b / "summary.json").write_text("{")
    done = run_tool("compare.py", a, b)
    assert done.returncode == 1 and "summary.json cannot be read" in said(done)
    done = run_tool("compare.py", a, tmp_path)
    assert done.returncode == 1 and said(done) == f"kerf compare: there is no {tmp_path / 'summary.json'}"
    assert run_tool("compare.py", a, a, "--tolerance", "nan").returncode == 2


# ---- columns of observers

def write_columns(folder, pressure=1.0e9, name="pressure", gone=2):
    """history.h5 of a gauge whose element is gone after some rows, and of a part."""
    values = pressure * np.sin(np.linspace(0.0, 3.0, 40))
    values[40 - gone:] = np.nan
    with h5py.File(folder / "history.h5", "w") as file:
        groups = {"nose": {name: (values, b"Pa"), "id": (np.full(40, 7.0), b"-")},
                  "bodies": {"rod.mass": (np.ones(40), b"kg"), "rod.kinetic": (values[::-1], b"J")}}
        for group, columns in groups.items():
            g = file.create_group(group)
            g["time"], g.attrs["unit of time"] = np.linspace(0.0, 40.0e-6, 40), np.bytes_(b"s")
            for column, (data, unit) in columns.items():
                g[column] = data
                g.attrs[f"unit of {column}"] = np.bytes_(unit)


def test_plot_draws_a_chart_for_each_observer(tmp_path):
    write_run(tmp_path / "run")
    write_columns(tmp_path / "run")
    done = run_tool("plot.py", tmp_path / "run")
    assert done.returncode == 0, done.stderr
    for name in ("observer_nose.png", "observer_bodies.png"):
        assert name in done.stdout
        assert (tmp_path / "run" / "plots" / name).stat().st_size > 10_000  # a chart with curves, not an empty frame


def test_plot_names_the_columns_that_it_leaves_out(tmp_path):
    write_run(tmp_path / "run")
    write_columns(tmp_path / "run", gone=40)
    done = run_tool("plot.py", tmp_path / "run")
    assert done.returncode == 0
    assert "observer_nose.png leaves out 1 columns of the observer nose: pressure" in done.stderr
    assert not (tmp_path / "run" / "plots" / "observer_nose.png").exists()


def test_an_energy_that_is_new_is_drawn(tmp_path):
    """Columns of energies are found by their unit, so that an account needs no list in the charts."""
    write_run(tmp_path / "run")
    path = tmp_path / "run" / "history.csv"
    rows = list(csv.reader(path.open()))
    more = [[*rows[0], "detonation [J]"], *([*row, str(i)] for i, row in enumerate(rows[1:]))]
    with path.open("w", newline="") as file:
        csv.writer(file).writerows(more)
    results = post_module("results")
    assert "detonation" in results.energies_of(path) and "momentum_x" not in results.energies_of(path)
    assert run_tool("plot.py", tmp_path / "run").returncode == 0


def test_compare_looks_at_the_columns_of_observers(tmp_path):
    for name, pressure in (("a", 1.0e9), ("b", 1.0e9), ("c", 1.1e9)):
        write_run(tmp_path / name)
        write_columns(tmp_path / name, pressure)
    same = run_tool("compare.py", tmp_path / "a", tmp_path / "b")
    assert same.returncode == 0 and "observer nose, 40 and 40 rows" in same.stdout
    other = run_tool("compare.py", tmp_path / "a", tmp_path / "c")
    assert other.returncode == 3
    assert any(line.startswith("* pressure") for line in other.stdout.splitlines())
    write_run(tmp_path / "d")
    lacking = run_tool("compare.py", tmp_path / "a", tmp_path / "d")
    assert lacking.returncode == 3 and "* observer nose: missing or empty in B" in lacking.stdout


def test_damaged_columns_are_named(tmp_path):
    write_run(tmp_path / "run")
    (tmp_path / "run" / "history.h5").write_bytes(b"no HDF5 at all")
    done = run_tool("plot.py", tmp_path / "run")
    assert done.returncode == 0 and "history.h5 cannot be read" in done.stderr
