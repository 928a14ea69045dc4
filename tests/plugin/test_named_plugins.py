"""An input names the plugins that it needs: loaded once, from beside the input, with mistakes told at their place."""

import json

import pytest

from plugin_case import HERE, KERF, build, call
from test_out_of_tree import CASE

NAMED = CASE.replace("title:", "plugins: [lib/swift_material.so]\ntitle:", 1)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """An input, and the plugin in a folder beside it."""
    folder = tmp_path_factory.mktemp("named")
    library = build(HERE / "out_of_tree", tmp_path_factory.mktemp("plugin"), "swift_material.so")
    (folder / "lib").mkdir()
    (folder / "lib" / "swift_material.so").write_bytes(library.read_bytes())
    (folder / "plain.yaml").write_text(CASE)
    (folder / "named.yaml").write_text(NAMED)
    return folder


def hash_of(folder, name, *options):
    done = call(KERF, "run", folder / name, "--output", folder / "out", *options, cwd=folder.parent)
    assert done.returncode == 0, done.stderr
    return json.loads((folder / "out" / "summary.json").read_text())["state_hash"]


def test_an_input_runs_with_the_plugins_that_it_names(folder):
    library = folder / "lib" / "swift_material.so"
    expected = hash_of(folder, "plain.yaml", "--plugin", library)
    assert hash_of(folder, "named.yaml") == expected
    assert hash_of(folder, "named.yaml", "--ranks", 3) == expected
    # Named twice, by two ways, it is one plugin.
    assert hash_of(folder, "named.yaml", "--plugin", library) == expected


def test_a_resumed_run_loads_them_again(folder):
    whole = hash_of(folder, "named.yaml")
    hash_of(folder, "named.yaml", "--set", "time.maximum_cycles=50")
    assert hash_of(folder, "named.yaml", "--resume", "--ranks", 2) == whole


@pytest.mark.parametrize("ranks", [1, 3])
@pytest.mark.parametrize("path, said", [
    ("absent.so", "there is no such plugin file"),
    ("named.yaml", "is a file of another kind, not a shared library"),
    ("lib", "is a folder, not a shared library"),
])
def test_what_is_no_plugin_is_told_at_its_place(folder, path, said, ranks):
    named = f"\n  - lib/swift_material.so\n  - {path}"
    (folder / "wrong.yaml").write_text(NAMED.replace("[lib/swift_material.so]", named))
    done = call(KERF, "run", folder / "wrong.yaml", "--ranks", ranks, "--output", folder / "none", cwd=folder)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"{folder}/wrong.yaml:4:5: error: `plugins`: {folder}/{path}: {said}"), line


def test_without_the_line_the_type_is_unknown(folder):
    done = call(KERF, "check", folder / "plain.yaml")
    assert done.returncode == 2 and 'there is no material of type "swift"' in done.stderr
