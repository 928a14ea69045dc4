"""Runs the program on an input and reads what it wrote, for the tests that drive it from outside."""

import csv
import json
import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


class Run:
    """The output folder of one run."""

    def __init__(self, folder, process):
        self.folder, self.process = folder, process
        self.summary = json.loads((folder / "summary.json").read_text())

    @property
    def history(self):
        """Columns of history.csv by name without unit, as arrays."""
        import numpy as np

        with open(self.folder / "history.csv", newline="") as file:
            rows = list(csv.reader(file))
        names = [name.split(" ")[0] for name in rows[0]]
        return dict(zip(names, np.array(rows[1:], dtype=float).T))

    @property
    def results(self):
        return Results(self.folder / "results.vtkhdf")


class Results:
    """Frames of results.vtkhdf."""

    def __init__(self, path):
        import h5py

        self.root = h5py.File(path)["VTKHDF"]
        self.times = self.root["Steps/Values"][:]
        self.cells = self.root["Connectivity"][:].reshape(-1, 8)
        self.part = self.root["CellData/part"][: len(self.cells)]

    def points(self, frame):
        return self._slice(self.root["Points"], self.root["Steps/PointOffsets"][frame], self._n_points())

    def node(self, name, frame):
        return self._field("PointData", name, frame, self._n_points())

    def cell(self, name, frame):
        return self._field("CellData", name, frame, len(self.cells))

    def centres(self, frame):
        return self.points(frame)[self.cells].mean(axis=1)

    def _n_points(self):
        return int(self.cells.max()) + 1

    def _field(self, kind, name, frame, count):
        frame = range(len(self.times))[frame]
        return self._slice(self.root[f"{kind}/{name}"], self.root[f"Steps/{kind}Offsets/{name}"][frame], count)

    @staticmethod
    def _slice(data, start, count):
        return data[start : start + count].astype("f8")


@pytest.fixture(scope="session")
def binary():
    path = Path(os.environ.get("KERF_BINARY", ROOT / "build" / "bin" / "kerf"))
    if not path.exists():
        pytest.skip(f"{path} is not built")
    return path


@pytest.fixture(scope="session")
def kerf(binary, tmp_path_factory):
    """kerf(model, *settings) runs an input file, or a model given as a dictionary, to its end; settings are
    KEY.PATH=VALUE texts. The run, on `ranks` ranks, must complete unless `completes` is False; it goes on with the
    run `resumes` where one is given."""

    def run(model, *settings, completes=True, timeout=600, ranks=1, resumes=None):
        folder = resumes.folder if resumes else tmp_path_factory.mktemp("run")
        if isinstance(model, dict):
            path = folder / "input.yaml"
            path.write_text(json.dumps(model, indent=1))  # JSON is YAML
        else:
            path = ROOT / "inputs" / model
        command = [str(binary), "run", str(path), "--output", str(folder), "--ranks", str(ranks)]
        if resumes:
            command.append("--resume")
        for setting in settings:
            command += ["--set", setting]
        process = subprocess.run(command, capture_output=True, text=True, timeout=timeout)
        if completes:
            assert process.returncode == 0, process.stdout + process.stderr
        return Run(folder, process)

    return run
