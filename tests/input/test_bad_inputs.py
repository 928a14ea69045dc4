"""Bad input is refused before a run with exit code 2, all mistakes at once, each with its place and what to do."""

from concurrent.futures import ThreadPoolExecutor

import pytest
import yaml

from input_case import HERE, GOOD, kerf, on_ranks, spoiled

CASES = yaml.safe_load((HERE / "bad_inputs.yaml").read_text())
# Answers are kept by name: a second case of the same name would hide the first.
assert len({case["name"] for case in CASES}) == len(CASES), "two cases of bad_inputs.yaml have the same name"


def refuse(case, command, folder):
    (folder / "case.yaml").write_text(case["text"] if "text" in case else spoiled(case.get("edit", [])))
    for name, text in case.get("files", {}).items():
        (folder / name).write_text(text)
    options = [word for text in case.get("set", []) for word in ("--set", text)]
    return kerf(command, "case.yaml", *on_ranks(case.get("ranks", 1)), *options, cwd=folder)


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """What the program says to each case. All are asked at once: starting MPI takes longer than reading an input."""
    asked = [(case, command) for case in CASES for command in case.get("commands", ["check"])]
    folders = [tmp_path_factory.mktemp("case") for _ in asked]
    with ThreadPoolExecutor(3) as pool:
        done = list(pool.map(lambda job: refuse(*job), [(*a, f) for a, f in zip(asked, folders)]))
    return {(case["name"], command): d for (case, command), d in zip(asked, done)}


def identify(case):
    return case["name"].replace(" ", "_")


@pytest.mark.parametrize("case", CASES, ids=identify)
def test_is_refused_with_these_lines(case, answers):
    for command in case.get("commands", ["check"]):
        done = answers[case["name"], command]
        assert done.stderr.splitlines() == case["lines"], command
        assert done.returncode == 2, command


def test_the_input_that_is_spoiled_is_good(tmp_path):
    (tmp_path / "case.yaml").write_text(GOOD)
    done = kerf("run", "case.yaml", "--output", "out", cwd=tmp_path)
    assert done.returncode == 0 and done.stderr == ""


def test_each_of_six_mistakes_alone_gives_its_line_of_the_six(tmp_path):
    """No mistake hides another one, and none is told twice because there are others."""
    six = next(case for case in CASES if case["name"] == "six mistakes")
    said = []
    for edit in six["edit"]:
        done = refuse({"edit": [edit]}, "check", tmp_path)
        assert done.returncode == 2 and done.stderr.count("\n") == 1, done.stderr
        said.append(done.stderr.strip())
    assert sorted(said) == sorted(six["lines"])


# What is wrong before the input is read: (arguments, line on stderr).
FILES = {
    "absent file": (["absent.yaml"], "absent.yaml: error: the input file cannot be read: No such file or directory"),
    "folder in place of a file": (["folder"], "folder: error: this is a folder; name the input file in it"),
    "path through a file": (["case.yaml/case.yaml"],
                            "case.yaml/case.yaml: error: the input file cannot be read: Not a directory"),
    "absent plugin": (["case.yaml", "--plugin", "laws.so"],
                      "laws.so: error: there is no such plugin file; looked for laws.so; expected a shared library "
                      "(.so), by its path or by its name in a folder of KERF_PLUGIN_PATH"),
    "plugin that is no library": (["case.yaml", "--plugin", "case.yaml"],
                                  "case.yaml: error: is a file of another kind, not a shared library; name the .so "
                                  "file that kerf_add_plugin() has made"),
    "nothing to resume from": (["case.yaml", "--resume", "--output", "new"],
                               "new/restart/restart.h5: error: there is no restart file to resume from; a run writes "
                               "one at its end (unless output.restart_at_end is false), when a signal stops it and, if "
                               "output.restart_interval is given, on the way; run without --resume, or name "
                               "the folder of the earlier run with --output"),
    "output into a file": (["case.yaml", "--output", "case.yaml"],
                           "case.yaml: error: the folder for the results cannot be made: Not a directory; name another "
                           "with --output"),
}


@pytest.mark.parametrize("name", FILES, ids=lambda name: name.replace(" ", "_"))
def test_files_that_do_not_fit(name, tmp_path):
    (tmp_path / "case.yaml").write_text(GOOD)
    (tmp_path / "folder").mkdir()
    words, line = FILES[name]
    done = kerf("run", *words, cwd=tmp_path)
    assert done.stderr.splitlines() == [line]
    assert done.returncode == 2


def test_more_ranks_than_the_machine_can_hold(tmp_path):
    """Nothing is started, where a slip of the finger would bring the machine down."""
    (tmp_path / "case.yaml").write_text(spoiled([("cells: [4, 4, 2]", "cells: [200, 200, 200]")]))
    done = kerf("run", "case.yaml", "--ranks", 1000000, cwd=tmp_path, timeout=30)
    assert done.returncode == 2
    assert done.stderr.startswith("--ranks 1000000: error: so many ranks take about 20000 GB by themselves, and this "
                                  "machine has ")


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_restart_file_that_is_none(tmp_path, ranks):
    (tmp_path / "case.yaml").write_text(GOOD)
    restart = tmp_path / "out" / "restart" / "restart.h5"
    restart.parent.mkdir(parents=True)
    restart.write_text("this is no HDF5 file")
    done = kerf("run", "case.yaml", "--resume", "--output", "out", *on_ranks(ranks), cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("out/restart/restart.h5: error: there is no restart file that can be used: "
                                  "\"out/restart/restart.h5\" is no file of Kerf's: ")
    assert done.stderr.endswith("run without --resume\n") and done.stderr.count("\n") == 1


def test_a_file_without_permission(tmp_path):
    path = tmp_path / "case.yaml"
    path.write_text(GOOD)
    path.chmod(0)
    try:
        path.read_text()
        pytest.skip("this user may read everything")
    except PermissionError:
        pass
    done = kerf("check", "case.yaml", cwd=tmp_path)
    assert done.stderr == "case.yaml: error: the input file cannot be read: Permission denied\n"
    assert done.returncode == 2
