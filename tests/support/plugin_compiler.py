"""Compiling a plugin by hand, with the flags that kerf_add_plugin() gives: faster than CMake."""

import os
import re
import subprocess
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("KERF_BUILD_DIR", SOURCE / "build")).resolve()
KERF = BUILD / "bin" / "kerf"


def cached(name):
    """A variable of the CMake cache that Kerf was built with."""
    lines = (BUILD / "CMakeCache.txt").read_text().splitlines()
    return next(line.split("=", 1)[1] for line in lines if line.startswith(name + ":"))


def flags(*replaced, matter=r"-f(fp-contract|no-math-errno|no-trapping-math)|-mtune-ctrl"):
    """What kerf_add_plugin() gives to the compiler: the options that Kerf was built with, and the definition that tells
    those which matter. `replaced` take the place of the options of their beginning, up to a "="."""
    text = (BUILD / "KerfConfig.cmake").read_text()
    options = re.search(r'KERF_PLUGIN_COMPILE_OPTIONS "(.*?)"', text).group(1).split(";")
    for new in replaced:
        options = [o for o in options if not o.startswith(new.split("=")[0])] + [new]
    told = " ".join(o for o in options if re.match(matter, o))
    return ["-std=c++20", *options, "-shared", "-fPIC", "-fvisibility=hidden", "-DKERF_PLUGIN_SHARED",
            f'-DKERF_COMPILE_FLAGS="{told}"', f'-DKERF_VERSION="{version()}"', f"-I{SOURCE / 'framework' / 'api'}"]


def version():
    lines = (BUILD / "KerfConfigVersion.cmake").read_text().splitlines()
    return next(line.split('"')[1] for line in lines if line.startswith("set(PACKAGE_VERSION "))


def call(*words, cwd=None, env=None):
    return subprocess.run([str(w) for w in words], cwd=cwd, capture_output=True, text=True, timeout=600,
                          env=env and {**os.environ, **env})


def compile_library(source, library, *options):
    """A library of one file, compiled as kerf_add_plugin() does but for what `options` change."""
    done = call(cached("CMAKE_CXX_COMPILER"), *flags(), *options, source, "-o", library)
    assert done.returncode == 0, done.stderr
    return library
