"""The examples in doc/plugin-authors are complete: each compiles as it stands and registers a type."""

import os
import re
import subprocess
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("KERF_BUILD_DIR", SOURCE / "build")).resolve()
KERF = BUILD / "bin" / "kerf"
PAGE = SOURCE / "doc" / "plugin-authors" / "writing_a_plugin.md"
EXAMPLES = re.findall(r"^```cpp\n(.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL)
NAMES = [re.search(r'^KERF_(\w+)\(\w+, "(\w+)"', example, re.MULTILINE).group(1, 2) for example in EXAMPLES]


def cached(name):
    lines = (BUILD / "CMakeCache.txt").read_text().splitlines()
    return next(line.split("=", 1)[1] for line in lines if line.startswith(name + ":"))


def call(*words):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=600)


def test_the_page_shows_examples_of_each_kind():
    kinds = [kind for kind, _ in NAMES]
    assert kinds == ["EOS", "MATERIAL", "MATERIAL", "EOS", "EOS", "SOLID", "EROSION", "CONTACT", "LOAD", "OBSERVER",
                     "OBSERVER"]


@pytest.mark.parametrize("number", range(len(EXAMPLES)), ids=[name for _, name in NAMES])
def test_example_compiles_without_warning_and_registers(number, tmp_path):
    kind, name = NAMES[number]
    source, library = tmp_path / f"{name}.cpp", tmp_path / f"{name}.so"
    source.write_text(EXAMPLES[number])
    version = call(KERF, "--version").stdout.split()[1]
    done = call(cached("CMAKE_CXX_COMPILER"), "-std=c++20", "-O1", "-Wall", "-Wextra", "-Werror",
                "-Wno-unknown-pragmas", "-shared", "-fPIC", "-DKERF_PLUGIN_SHARED", f'-DKERF_VERSION="{version}"',
                f"-I{SOURCE / 'framework' / 'api'}", source, "-o", library)
    assert done.returncode == 0, done.stderr
    done = call(KERF, "describe", kind.lower(), name, "--plugin", library)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"{name} ({kind.lower()}): ")
