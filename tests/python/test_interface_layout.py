"""What crosses the boundary between Kerf and its plugins keeps its layout as long as the number of the interface stays.

The headers of the last tag and the present ones are compiled into two libraries that mention every public type;
`abidiff` (Debian's abigail-tools) compares sizes, members and virtual functions. A changed layout needs another
`interface_version`, another number needs a changed layout and a section in doc/plugin-authors/interface_changes.md.
"""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HEADERS = ROOT / "framework" / "api" / "kerf"
CHANGES = ROOT / "doc" / "plugin-authors" / "interface_changes.md"
BUILD = Path(os.environ.get("KERF_BUILD_DIR", ROOT / "build")).resolve()
TYPE = re.compile(r"^(template <[^\n]*>\n)?(?:struct|class) (?:alignas\(\w+\) )?(\w+)(?: final)?(?: :[^;{]*)? ?\{",
                  re.M)
NUMBER = re.compile(r"interface_version = (\d+);")


def call(*words, cwd=ROOT):
    return subprocess.run([str(w) for w in words], cwd=cwd, capture_output=True, text=True, timeout=600)


def compiler():
    lines = (BUILD / "CMakeCache.txt").read_text().splitlines()
    return next(line.split("=", 1)[1] for line in lines if line.startswith("CMAKE_CXX_COMPILER:"))


def include_flags():
    """Where the compiler finds MPI, which one header includes."""
    done = call("mpicxx", "--showme:compile")
    return done.stdout.split() if done.returncode == 0 else []


def public_code(text):
    """The code of a header outside of `namespace detail`."""
    return re.sub(r"^namespace detail \{.*?^\}  // namespace detail", "", text, flags=re.M | re.S)


def types_of(headers):
    """Every public type: templates that stand for a precision with both of them."""
    names = []
    for path in sorted(headers.glob("*.hpp")):
        for template, name in TYPE.findall(public_code(path.read_text())):
            if not template:
                names.append(name)
            elif template == "template <class Real>\n":
                names += [f"{name}<double>", f"{name}<float>"]
    return names


def probe_name(name):
    return "probe_" + re.sub(r"\W", "_", name)


def probe(headers, folder):
    """A library with debugging information whose functions take every type of the headers."""
    folder.mkdir(parents=True, exist_ok=True)
    lines = [f'#include "kerf/{path.name}"' for path in sorted(headers.glob("*.hpp"))]
    lines += [f'extern "C" void {probe_name(name)}(kerf::{name}&) {{}}' for name in types_of(headers)]
    (folder / "probe.cpp").write_text("\n".join(lines) + "\n")
    # Otherwise compilers describe a class with virtual functions only where the functions are defined.
    whole = "-fstandalone-debug" if "clang" in compiler() else "-femit-class-debug-always"
    done = call(compiler(), "-std=c++20", "-g", whole, "-O0", "-shared", "-fPIC", "-w", '-DKERF_VERSION="0"',
                f"-I{headers.parent}", *include_flags(), folder / "probe.cpp", "-o", folder / "probe.so")
    assert done.returncode == 0, done.stderr
    return folder / "probe.so"


def difference(old, new):
    """What abidiff says about types that both have; empty where their layout is the same."""
    done = call("abidiff", "--changed-fns", old, new)
    assert not done.returncode & 3, done.stdout + done.stderr  # 1: an error, 2: wrong usage
    return done.stdout if re.search(r"[1-9]\d* Changed", done.stdout) else ""


def number_of(headers):
    return int(NUMBER.search((headers / "plugin.hpp").read_text()).group(1))


@pytest.fixture(scope="module")
def present(tmp_path_factory):
    if not shutil.which("abidiff"):
        pytest.fail("abidiff is missing; ./kerf build installs abigail-tools")
    return probe(HEADERS, tmp_path_factory.mktemp("present"))


def test_layout_changes_only_with_the_number_of_the_interface(present, tmp_path):
    tag = call("git", "describe", "--tags", "--match", "v*", "--abbrev=0")
    if tag.returncode != 0:
        pytest.skip("there is no tag to compare with: " + tag.stderr.strip())
    archive = call("git", "archive", "--output", tmp_path / "old.tar", tag.stdout.strip(), "framework/api/kerf")
    assert archive.returncode == 0, archive.stderr
    assert call("tar", "xf", tmp_path / "old.tar", "-C", tmp_path).returncode == 0
    old = tmp_path / "framework" / "api" / "kerf"
    changed = difference(probe(old, tmp_path / "old"), present)
    if number_of(old) == number_of(HEADERS):
        assert not changed, ("plugins that were built for this number would read the wrong bytes; raise "
                             "interface_version in plugin.hpp\n" + changed)
    else:
        assert changed, "the number of the interface was raised, but no layout has changed; leave it as it was"


def test_every_number_says_what_an_author_has_to_do():
    assert f"\n## {number_of(HEADERS)}\n" in CHANGES.read_text()


@pytest.mark.parametrize("header, before, after", [
    ("eos.hpp", "double density = 0.0;", "double added = 0.0, density = 0.0;"),
    ("observer.hpp", "virtual void before_forces(", "virtual void added() {}\n  virtual void before_forces("),
    ("load.hpp", "double area = 0.0;", "float area = 0.0;"),
], ids=["a member", "a virtual function", "a type"])
def test_a_changed_layout_is_seen(present, tmp_path, header, before, after):
    headers = tmp_path / "api" / "kerf"
    shutil.copytree(HEADERS, headers)
    text = (headers / header).read_text()
    assert before in text
    (headers / header).write_text(text.replace(before, after, 1))
    assert difference(present, probe(headers, tmp_path / "changed"))


def test_comments_and_functions_that_are_no_members_do_not_count(present, tmp_path):
    headers = tmp_path / "api" / "kerf"
    shutil.copytree(HEADERS, headers)
    text = (headers / "eos.hpp").read_text()
    more = "// a comment\ninline double nothing() { return 0.0; }\nstruct EosInput {"
    (headers / "eos.hpp").write_text(text.replace("struct EosInput {", more))
    assert not difference(present, probe(headers, tmp_path / "changed"))
