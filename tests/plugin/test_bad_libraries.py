"""A bad library cannot break Kerf: each fault is told in one sentence, and ends all ranks.

The sentences are those of the table "Bad libraries" in doc/plugin-authors/out_of_tree.md, where "..." stands for paths,
numbers and the like: what the page says is what is printed.
"""

import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

import pytest

from plugin_case import HERE, KERF, SOURCE, build, cached, call, compile_library, flags

SOURCE_FILE = HERE / "bad_library.cpp"
PAGE = (SOURCE / "doc" / "plugin-authors" / "out_of_tree.md").read_text()
TABLE = dict(re.findall(r"^\| (.+?) \| `+ ?(.+?) ?`+ \| [^|]+ \|$", PAGE.split("## Bad libraries")[1], re.MULTILINE))
told = set()  # causes whose sentence a test has seen


def is_told(cause, text):
    """Asserts that a line of what was printed is the page's sentence for the cause; returns the line."""
    pattern = ".*".join(re.escape(piece) for piece in TABLE[cause].split("..."))
    lines = [line for line in text.splitlines() if re.fullmatch(pattern, line)]
    assert lines, f"expected: {TABLE[cause]}\nprinted: {text}"
    told.add(cause)
    return lines[0]


CASE = {
    "title": "a bar", "time": {"end": "4 us"}, "checks": {"stall_limit": "2 s"},
    "materials": {"metal": {"density": 7850, "strength": {"type": "bad"},
                            "eos": {"type": "linear", "bulk_modulus": "160 GPa"}}},
    "parts": {"bar": {"material": "metal", "velocity": "10 0 0 m/s", "mesh": {
        "type": "block", "size": [0.02, 0.002, 0.002], "cells": [20, 2, 2]}}},
}


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """One library for every fault that shows after it was loaded."""
    return compile_library(SOURCE_FILE, tmp_path_factory.mktemp("bad") / "bad.so", "-O1")


@pytest.fixture
def case(tmp_path):
    (tmp_path / "case.yaml").write_text(json.dumps(CASE, indent=1))
    return tmp_path / "case.yaml"


def listed(plugin, env=None):
    return call(KERF, "list", "material", "--plugin", plugin, env=env)


def refused(cause, plugin, env=None):
    done = listed(plugin, env)
    assert done.returncode == 2, done.stdout + done.stderr
    assert done.stdout == ""
    return is_told(cause, done.stderr)


def attempt(case, plugin, *settings, ranks=1, env=None):
    sets = [word for setting in settings for word in ("--set", setting)]
    return call(KERF, "run", case, "--plugin", plugin, "--output", case.parent / "out", "--ranks", ranks, *sets,
                cwd=case.parent, env=env)


def patched(library, folder, old, new):
    """A copy of a library with other text in it, of the same length."""
    bytes_ = library.read_bytes()
    assert bytes_.count(old) == 1 and len(old) == len(new)
    (folder / "patched.so").write_bytes(bytes_.replace(old, new))
    return folder / "patched.so"


# ---- what does not fit


def test_the_good_library_loads_and_runs(library, case):
    assert "bad" in listed(library).stdout
    done = attempt(case, library)
    assert done.returncode == 0, done.stderr


def test_another_number_of_the_interface(library, tmp_path):
    number = re.search(rb"interface=(\d+)\n", library.read_bytes())[1]
    foreign = number[:-1] + (b"0" if number[-1:] == b"9" else b"9")  # of the same length
    said = refused("another number of the interface",
                   patched(library, tmp_path, b"interface=" + number + b"\n", b"interface=" + foreign + b"\n"))
    assert f"the interface version is {foreign.decode()} in the plugin and {number.decode()} here" in said


def test_another_version_of_kerf_with_the_same_interface_is_taken(library, tmp_path):
    assert "bad" in listed(patched(library, tmp_path, b"\nkerf=0.", b"\nkerf=9.")).stdout


def test_another_compiler(library, tmp_path):
    refused("another compiler", patched(library, tmp_path, b"\ncompiler=1", b"\ncompiler=9"))


def test_another_size_of_a_struct(library, tmp_path):
    size = re.search(rb"size\.material\.MaterialBatch=(\d+)\n", library.read_bytes())
    other = size.group(0).replace(size.group(1), b"9" * len(size.group(1)))
    line = refused("another size of a struct", patched(library, tmp_path, size.group(0), other))
    assert line.count(" in the plugin and ") == 1


def test_other_compile_flags(tmp_path):
    plugin = tmp_path / "flags.so"
    done = call(cached("CMAKE_CXX_COMPILER"), *flags("-ffp-contract=fast"), SOURCE_FILE, "-o", plugin)
    assert done.returncode == 0, done.stderr
    refused("other compile flags", plugin)


def test_flags_that_cmake_is_given_by_the_author(tmp_path):
    """CMAKE_CXX_FLAGS of the author count; those that Kerf's own come behind do not."""
    copy = tmp_path / "source"
    shutil.copytree(HERE / "out_of_tree", copy)
    for name, options, fits in (("one", "-fno-signed-zeros", False), ("two", "-ffp-contract=fast -Wall -g", True)):
        lists = (HERE / "out_of_tree" / "CMakeLists.txt").read_text()
        (copy / "CMakeLists.txt").write_text(lists.replace("find_package", f'set(CMAKE_CXX_FLAGS "{options}")\n'
                                                           "find_package", 1))
        done = listed(build(copy, tmp_path / name, "swift_material.so"))
        assert (done.returncode == 0) == fits, done.stderr
        assert fits or 'that differ are "-fno-signed-zeros" in the plugin and "none" here' in done.stderr


def test_another_instruction_set(tmp_path):
    plugin = tmp_path / "machine.so"
    done = call(cached("CMAKE_CXX_COMPILER"), *flags("-march=x86-64"), SOURCE_FILE, "-o", plugin)
    if done.returncode != 0 or listed(plugin).returncode == 0:
        pytest.skip("this Kerf is built for the least of all processors, or for processors of another kind")
    refused("another instruction set", plugin)


def test_unknown_flags(tmp_path):
    plugin = tmp_path / "by_hand.so"
    done = call(cached("CMAKE_CXX_COMPILER"), "-std=c++20", "-shared", "-fPIC", "-DKERF_PLUGIN_SHARED",
                f"-I{SOURCE / 'framework' / 'api'}", SOURCE_FILE, "-o", plugin)
    assert done.returncode == 0, done.stderr
    refused("compiled without kerf_add_plugin()", plugin)


def test_an_old_manifest(tmp_path):
    """As plugins of interface 9 had it: a struct by value, whose size nobody knows."""
    source = tmp_path / "old.cpp"
    source.write_text("""
struct Manifest { int numbers[5]; char compiler[64], version[32]; };
#define EXPORT extern "C" __attribute__((visibility("default")))
EXPORT Manifest kerf_plugin_manifest() { __builtin_trap(); }
EXPORT void kerf_plugin_register(void*) { __builtin_trap(); }
""")
    refused("built for an older Kerf", compile_library(source, tmp_path / "old.so"))


# ---- what is no library, or not a whole one


def test_a_text_a_folder_an_empty_file(tmp_path):
    (tmp_path / "text.so").write_text("#!/bin/sh\nexit 0\n")
    (tmp_path / "short.so").write_text("E")
    (tmp_path / "empty.so").write_text("")
    (tmp_path / "folder.so").mkdir()
    (tmp_path / "object.cpp").write_text("int nothing() { return 0; }\n")
    done = call(cached("CMAKE_CXX_COMPILER"), "-c", tmp_path / "object.cpp", "-o", tmp_path / "object.so")
    assert done.returncode == 0, done.stderr
    refused("a text or a picture", tmp_path / "text.so")
    refused("a text or a picture", tmp_path / "short.so")
    refused("a folder", tmp_path / "folder.so")
    refused("an empty file", tmp_path / "empty.so")
    refused("an object file", tmp_path / "object.so")
    refused("no such file", tmp_path / "absent.so")


def test_a_file_that_is_cut_off(library, tmp_path):
    """Wherever it is cut: the system's loader, which may crash, does not see it."""
    whole = library.read_bytes()
    places = [*range(4, 64, 7), 64, 65, 100, 200, 500, 1000, len(whole) - 1]
    places += [len(whole) * i // 16 for i in range(1, 16)]
    for n in places:
        (tmp_path / "cut.so").write_bytes(whole[:n])
        refused("cut off", tmp_path / "cut.so")


def test_headers_that_lie(library, tmp_path):
    """Every byte of the header once 0, once 255: refused or loaded, never a crash."""
    whole = library.read_bytes()
    for place in range(16, 64):
        for value in (0, 255):
            (tmp_path / "lies.so").write_bytes(whole[:place] + bytes([value]) + whole[place + 1:])
            done = listed(tmp_path / "lies.so")
            assert done.returncode in (0, 2), (place, value, done.stderr)
            assert done.returncode == 0 or "lies.so: error: " in done.stderr


def test_no_permission(library):
    """Root may read everything, so somebody else has to try."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        plugin = folder / "secret.so"
        plugin.write_bytes(library.read_bytes())
        plugin.chmod(0o000)
        words = ["setpriv", "--reuid=65534", "--clear-groups"] if os.geteuid() == 0 else []
        if words and (not shutil.which("setpriv") or call(*words, KERF, "--version").returncode != 0):
            pytest.skip("tests run as root, and nobody else can be made to run Kerf")
        done = call(*words, KERF, "list", "--plugin", plugin)
        assert done.returncode == 2, done.stdout + done.stderr
        is_told("no permission to read it", done.stderr)


def test_a_symbol_that_is_missing(tmp_path):
    source = tmp_path / "missing.cpp"
    source.write_text(SOURCE_FILE.read_text().replace(
        "namespace {\n", "double yield_of_table(int row);\n\nnamespace {\n", 1).replace(
        "    act(in.time);\n", "    modulus = yield_of_table(3);\n"))
    refused("a missing symbol", compile_library(source, tmp_path / "missing.so"))


def test_a_library_that_it_needs_is_gone(tmp_path):
    (tmp_path / "table.cpp").write_text("double yield_of_table(int row) { return row; }\n")
    done = call(cached("CMAKE_CXX_COMPILER"), "-shared", "-fPIC", tmp_path / "table.cpp", "-o",
                tmp_path / "libtable.so")
    assert done.returncode == 0, done.stderr
    source = tmp_path / "needs.cpp"
    source.write_text("double yield_of_table(int row);\ndouble first_row = yield_of_table(1);\n" +
                      SOURCE_FILE.read_text())
    plugin = tmp_path / "needs.so"
    done = call(cached("CMAKE_CXX_COMPILER"), *flags(), source, "-o", plugin, f"-L{tmp_path}", "-ltable",
                f"-Wl,-rpath,{tmp_path}")
    assert done.returncode == 0, done.stderr
    assert listed(plugin).returncode == 0
    (tmp_path / "libtable.so").unlink()
    refused("a library that it needs is gone", plugin)


def test_a_shared_library_that_is_no_plugin(tmp_path):
    (tmp_path / "nothing.cpp").write_text("int nothing() { return 0; }\n")
    refused("no plugin", compile_library(tmp_path / "nothing.cpp", tmp_path / "nothing.so"))


# ---- names


def test_the_name_of_another_plugin_or_of_a_built_in_type(library, tmp_path):
    twin = compile_library(SOURCE_FILE, tmp_path / "twin.so", '-DBAD_NAME="bad"')
    done = call(KERF, "list", "--plugin", library, "--plugin", twin)
    assert done.returncode == 2
    is_told("the name of another type", done.stderr)
    built_in = compile_library(SOURCE_FILE, tmp_path / "built_in.so", '-DBAD_NAME="johnson_cook"')
    line = refused("the name of another type", built_in)
    assert "johnson_cook.cpp" in line and "bad_library.cpp" in line


# ---- what shows when it is loaded


def test_code_that_crashes_when_it_is_loaded(tmp_path):
    done = listed(compile_library(SOURCE_FILE, tmp_path / "start.so", "-DBAD_START"))
    assert done.returncode == -signal.SIGSEGV
    is_told("its code crashes when it is loaded", done.stderr)


def test_a_registration_that_throws(library):
    refused("the registration throws", library, {"BAD_REGISTRATION": "throws"})
    done = listed(library, {"BAD_REGISTRATION": "throws a number"})
    assert done.returncode == 2 and "something was thrown that is not a std::exception" in done.stderr


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_registration_that_never_ends(library, case, ranks):
    env = {"BAD_REGISTRATION": "loops", "KERF_LOAD_LIMIT": "1"}
    refused("the registration never ends", library, env)
    done = attempt(case, library, ranks=ranks, env=env)
    assert done.returncode == 2, done.stderr
    is_told("the registration never ends", done.stderr)


def test_a_constructor_that_throws_or_never_ends(library, case):
    done = attempt(case, library, "materials.metal.strength={type: unmade}")
    assert done.returncode == 2
    is_told("a constructor throws", done.stderr)
    text = json.dumps(CASE, indent=1).replace('"type": "bad"', '"type": "unmade"')
    case.write_text(text)
    done = attempt(case, library)
    assert done.returncode == 2
    line = next(i for i, row in enumerate(text.splitlines(), 1) if "unmade" in row)
    assert is_told("a constructor throws", done.stderr).startswith(f"{case}:{line}:")
    done = attempt(case, library, env={"BAD_REGISTRATION": "constructor loops", "KERF_LOAD_LIMIT": "1"})
    assert done.returncode == 2
    is_told("a constructor never ends", done.stderr)


def test_a_limit_that_is_no_number_is_an_error(library):
    done = listed(library, {"KERF_LOAD_LIMIT": "soon"})
    assert done.returncode == 2 and done.stderr == (
        'KERF_LOAD_LIMIT: error: "soon" in the environment is no number of seconds; expected one such as 60, or 0 for '
        "no limit\n")


# ---- what shows in the run


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("fault, cause", [
    ("throws", "a law throws"), ("nan_stress", "a law returns a stress that is no number"),
    ("nan_modulus", "a law returns a modulus that is no number")])
def test_a_law_that_throws_or_returns_no_number(library, case, fault, cause, ranks):
    done = attempt(case, library, f"materials.metal.strength.fault={fault}", "materials.metal.strength.x=5 mm",
                   ranks=ranks)
    assert done.returncode == 3, done.stdout + done.stderr
    line = is_told(cause, done.stderr)
    assert "element 0 of part bar" in line
    summary = json.loads((case.parent / "out" / "summary.json").read_text())
    assert summary["exit"] in line


def test_an_equation_of_state_that_returns_no_number(case, tmp_path):
    source = tmp_path / "void.cpp"
    source.write_text("""
#include <kerf/eos.hpp>
#include <limits>
using namespace kerf;
struct Void final : PointwiseEos<Void> {
  using State = NoVariables;
  static void describe(Schema<Void>&) {}
  EosOutput evaluate_point(const EosInput& in, const State&) const {
    return {in.time < 1e-6 ? 0.0 : std::numeric_limits<double>::infinity(), 160e9};
  }
};
KERF_EOS(Void, "void", "returns no number")
""")
    plugin = compile_library(source, tmp_path / "void.so", "-O1")
    done = attempt(case, plugin, "materials.metal.eos={type: void}",
                   "materials.metal.strength={type: elastic, shear_modulus: 80 GPa}")
    assert done.returncode == 3
    is_told("an equation of state returns a pressure that is no number", done.stderr)


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("fault, cause, number", [
    ("aborts", "a law calls abort()", signal.SIGABRT),
    ("crashes", "a law reads or writes where it must not", signal.SIGSEGV),
    ("recurses", "a law calls itself without end", signal.SIGSEGV),
    ("calls", "a law calls a function that is not there", signal.SIGSEGV),
    ("escapes", "an exception leaves a noexcept function", signal.SIGABRT)])
def test_a_law_that_crashes(library, case, fault, cause, number, ranks):
    """On one of two ranks only; the other one waits for it in MPI, and is ended by mpirun."""
    done = attempt(case, library, f"materials.metal.strength.fault={fault}", "materials.metal.strength.x=5 mm",
                   ranks=ranks)
    # A shell and mpirun report a signal as 128 and its number.
    assert done.returncode == (-number if ranks == 1 else 128 + number), done.stdout + done.stderr
    line = is_told(cause, done.stderr)
    assert line.startswith("error: the plugin" if ranks == 1 else "error: rank ")
    assert done.stderr.count("has crashed") == 1
    assert not (case.parent / "out" / "summary.json").exists()


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_law_that_never_ends(library, case, ranks):
    """The rank that loops is named; the one that waits for it keeps silent."""
    done = attempt(case, library, "materials.metal.strength.fault=loops", "materials.metal.strength.x=5 mm",
                   ranks=ranks)
    assert done.returncode == 3, done.stdout + done.stderr
    line = is_told("a law never ends", done.stderr)
    assert "in phase elements of cycle " in line
    assert done.stderr.count("error: ") == 1, done.stderr


def test_a_run_that_is_slow_or_suspended_goes_on(library, case):
    """It takes longer than the limit in all, and is suspended for longer than it, but no phase takes so long."""
    words = [KERF, "run", case, "--plugin", library, "--output", case.parent / "out", "--set", "checks.stall_limit=1 s",
             "--set", "materials.metal.strength={type: bad, fault: slow, x: 1 mm}"]
    with subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True) as process:
        time.sleep(1.0)
        process.send_signal(signal.SIGSTOP)
        time.sleep(2.5)
        process.send_signal(signal.SIGCONT)
        _, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors
    summary = json.loads((case.parent / "out" / "summary.json").read_text())
    assert summary["wall_seconds"] > 3.5


def test_the_limit_is_no_part_of_the_model(library, case):
    """A run that stood still can be resumed with another limit, or with none."""
    assert attempt(case, library).returncode == 0
    for limit in ("0", "100 s"):
        done = call(KERF, "run", case, "--plugin", library, "--output", case.parent / "out", "--resume", "--set",
                    f"checks.stall_limit={limit}", "--set", "time.end=5 us")
        assert done.returncode == 0, done.stderr
    case.write_text(json.dumps({key: value for key, value in CASE.items() if key != "checks"}))
    assert attempt(case, library).returncode == 0
    done = attempt(case, library, "checks.stall_limit=5 s", "time.end=5 us")
    assert done.returncode == 0, done.stderr


def test_all_ranks_wait_for_one_another(case, tmp_path):
    """Rank 0 waits for a message that nobody sends; the others wait for rank 0."""
    source = tmp_path / "waits.cpp"
    source.write_text("""
#include <kerf/observer.hpp>
#include <mpi.h>
struct Waits final : kerf::Observer {
  static void describe(kerf::Schema<Waits>&) {}
  std::vector<kerf::ObservedColumn> columns() const override { return {{"x", "-", "nothing"}}; }
  void sample(kerf::ObservedModel& model, std::span<double>) override {
    int rank = 0, nothing = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    if (rank == 0 && model.time > 1e-6) MPI_Recv(&nothing, 1, MPI_INT, 1, 77, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  }
};
KERF_OBSERVER(Waits, "waits", "waits for a message that nobody sends")
""")
    paths = call("mpicxx", "--showme:compile").stdout.split()
    plugin = compile_library(source, tmp_path / "waits.so", *paths)
    case.write_text(json.dumps({**CASE, "observers": {"deaf": {"type": "waits"}}}))
    elastic = "materials.metal.strength={type: elastic, shear_modulus: 80 GPa}"
    done = attempt(case, plugin, elastic, "checks.stall_limit=1 s", ranks=2)
    assert done.returncode == 3, done.stdout + done.stderr
    is_told("MPI is called on some ranks only", done.stderr)


# ---- several ranks


def on_folders(folders, *words):
    """Runs the program on one rank in each folder."""
    command = []
    for i, folder in enumerate(folders):
        command += [":"] * (i > 0) + ["-n", "1", "--wdir", folder, KERF, *words]
    return subprocess.run(["mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "--quiet",
                           *map(str, command)], capture_output=True, text=True, timeout=120)


@pytest.mark.parametrize("command", ["run", "check"])
@pytest.mark.parametrize("named", ["--plugin", "plugins"])
def test_ranks_that_see_different_files(library, tmp_path, command, named):
    folders = [tmp_path / name for name in ("a", "b")]
    for i, folder in enumerate(folders):
        folder.mkdir()
        (folder / "bad.so").write_bytes(library.read_bytes() + b"\0" * i)
        (folder / "case.yaml").write_text(json.dumps(CASE if named == "--plugin" else {**CASE, "plugins": ["bad.so"]}))
    words = [command, "case.yaml", *(["--plugin", "bad.so"] if named == "--plugin" else [])]
    good = on_folders([folders[0], folders[0]], *words)
    assert good.returncode == 0, good.stderr
    done = on_folders([folders[0], folders[0], folders[1]], *words)
    assert done.returncode == 2, done.stdout + done.stderr
    line = is_told("different on two ranks", done.stderr)
    assert f"{library.stat().st_size + 1} bytes" in line and "on rank 2;" in line
    assert ("case.yaml:1:" in line) == (named == "plugins")
    # The same size, other content.
    bytes_ = bytearray(library.read_bytes())
    bytes_[-1] ^= 1
    (folders[1] / "bad.so").write_bytes(bytes_)
    is_told("different on two ranks", on_folders(folders, *words).stderr)
    (folders[1] / "bad.so").unlink()
    done = on_folders(folders, *words)
    assert done.returncode == 2
    is_told("missing on some ranks", done.stderr)


def test_every_sentence_of_the_page_was_seen(request):
    """Last of all: the table has no row that nobody has checked."""
    ran = {item.function.__name__ for item in request.session.items if item.fspath == request.node.fspath}
    every = {name for name in globals() if name.startswith("test_")}
    if ran != every:
        pytest.skip("only some of the tests were run")
    assert set(TABLE) - told <= {"no permission to read it", "another instruction set"}  # which may be skipped
