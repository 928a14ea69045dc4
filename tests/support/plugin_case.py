"""Building a plugin as its author would, against the tree that the tests run."""

import json

from plugin_compiler import BUILD, KERF, SOURCE, cached, call, compile_library, flags

__all__ = ["BUILD", "HERE", "KERF", "SOURCE", "build", "cached", "call", "compile_library", "flags", "run"]
HERE = SOURCE / "tests" / "plugin"  # where the plugins that tests build are


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
