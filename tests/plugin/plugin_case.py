"""Building a plugin as its author would, against the tree that the tests run."""

import json
import os
import subprocess
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
BUILD = Path(os.environ.get("KERF_BUILD_DIR", SOURCE / "build")).resolve()
KERF = BUILD / "bin" / "kerf"


def cached(name):
    """A variable of the CMake cache that Kerf was built with."""
    lines = (BUILD / "CMakeCache.txt").read_text().splitlines()
    return next(line.split("=", 1)[1] for line in lines if line.startswith(name + ":"))


def call(*words, cwd=None):
    return subprocess.run([str(w) for w in words], cwd=cwd, capture_output=True, text=True, timeout=600)


def build(source, folder, library):
    """The plugin of a source folder, built as its author would."""
    done = call("cmake", "-G", "Ninja", "-S", source, "-B", folder, f"-DKerf_DIR={BUILD}",
                f"-DCMAKE_CXX_COMPILER={cached('CMAKE_CXX_COMPILER')}")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "refuse to load" not in done.stderr, "compilers differ"
    done = call("cmake", "--build", folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / library


def run(case, plugin, output, *options):
    """The summary of a run that has to end well."""
    done = call(KERF, "run", case, "--plugin", plugin, "--output", output, *options, cwd=output.parent)
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads((output / "summary.json").read_text())
