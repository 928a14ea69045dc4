"""Plugins by their name: KERF_PLUGIN_PATH, for the command line and for an input, on any number of ranks."""

import json

import pytest

from plugin_case import HERE, KERF, call, compile_library
from test_bad_libraries import CASE


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """Two folders of plugins, of which the second has one, and a folder with an input."""
    top = tmp_path_factory.mktemp("path")
    for name in ("first", "second", "case"):
        (top / name).mkdir()
    compile_library(HERE / "bad_library.cpp", top / "second" / "bad.so", "-O1")
    (top / "case" / "plain.yaml").write_text(json.dumps(CASE))
    (top / "case" / "named.yaml").write_text(json.dumps({**CASE, "plugins": ["bad"]}))
    return top


@pytest.fixture
def path(folders):
    return {"KERF_PLUGIN_PATH": f"{folders}/first::{folders}/second"}


@pytest.mark.parametrize("name", ["bad", "bad.so"])
def test_a_name_is_looked_for_in_the_folders(folders, path, name):
    for words in (["list", "material"], ["check", "plain.yaml"], ["check", "plain.yaml", "--ranks", 2]):
        done = call(KERF, *words, "--plugin", name, cwd=folders / "case", env=path)
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("ranks", [1, 2])
def test_an_input_may_name_a_plugin(folders, path, ranks):
    words = [KERF, "run", "named.yaml", "--ranks", ranks, "--output", folders / "out"]
    done = call(*words, cwd=folders / "case", env=path)
    assert done.returncode == 0, done.stderr
    # By two names, it is one plugin.
    done = call(*words, "--plugin", folders / "second" / "bad.so", cwd=folders / "case", env=path)
    assert done.returncode == 0, done.stderr


def test_the_present_folder_comes_first(folders, path):
    here = folders / "here"
    here.mkdir()
    (here / "bad").write_text("no library")
    done = call(KERF, "list", "--plugin", "bad", cwd=here, env=path)
    assert done.returncode == 2 and done.stderr.startswith("bad: error: is a file of another kind")


def test_a_path_with_a_slash_is_not_looked_for(folders, path):
    done = call(KERF, "list", "--plugin", "./bad", cwd=folders / "case", env=path)
    assert done.returncode == 2
    assert done.stderr == ("./bad: error: there is no such plugin file; looked for ./bad; expected a shared library "
                           "(.so), by its path or by its name in a folder of KERF_PLUGIN_PATH\n")


@pytest.mark.parametrize("ranks", [1, 2])
def test_all_places_are_listed(folders, path, ranks):
    done = call(KERF, "check", "plain.yaml", "--plugin", "worse", "--ranks", ranks, cwd=folders / "case", env=path)
    assert done.returncode == 2
    first, second = folders / "first", folders / "second"
    assert (f"looked for worse, {first}/worse, {first}/worse.so, {second}/worse, {second}/worse.so; expected"
            in done.stderr)
    (folders / "case" / "other.yaml").write_text(json.dumps({**CASE, "plugins": ["worse.so"]}))
    done = call(KERF, "check", "other.yaml", "--ranks", ranks, cwd=folders / "case", env=path)
    assert done.returncode == 2
    assert done.stderr.startswith("other.yaml:1:") and f"`plugins`: worse.so: there is no such" in done.stderr
    assert f"looked for worse.so, {first}/worse.so, {second}/worse.so; expected" in done.stderr


def test_rank_0_decides(folders, path):
    """Rank 1 has no KERF_PLUGIN_PATH."""
    done = call("mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-n", 1, "-x",
                "KERF_PLUGIN_PATH=" + path["KERF_PLUGIN_PATH"], KERF, "check", "named.yaml", ":", "-n", 1, "-x",
                "KERF_PLUGIN_PATH=/nowhere", KERF, "check", "named.yaml", cwd=folders / "case")
    assert done.returncode == 0, done.stderr
