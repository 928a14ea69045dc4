"""Sources have the format of .clang-format, lines of up to 120 columns, and tests with names in one style."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2]
ROOMS = ["framework", "physics", "partitioners", "tests"]
FORMATTED = {".c", ".cpp", ".hpp"}
# The words of CMake, Python and shell files are broken by hand; clang-format does not break long texts either.
NARROW = FORMATTED | {".py", ".cmake", ".sh"}
COLUMNS = 120


def sources(suffixes):
    """Templates have placeholders in place of names, which clang-format cannot know the length of."""
    found = [path for room in ROOMS for path in sorted((SOURCE / room).rglob("*"))
             if path.suffix in suffixes and "templates" not in path.parts]
    assert len(found) > 100, "the sources are not where this test looks for them"
    return found


def formatter():
    """clang-format 14, or None: other versions break some lines in other places."""
    for name in ("clang-format-14", "clang-format"):
        program = shutil.which(name)
        if program and " version 14." in subprocess.run([program, "--version"], capture_output=True, text=True).stdout:
            return program
    return None


def complaints(program, files):
    done = subprocess.run([program, "--dry-run", "-Werror", *map(str, files)], capture_output=True, text=True,
                          timeout=300, cwd=SOURCE)
    return done.returncode, sorted({line.split(":")[0] for line in done.stderr.splitlines() if ": error: " in line})


needs_formatter = pytest.mark.skipif(formatter() is None, reason="clang-format 14 is not installed")


@needs_formatter
def test_sources_are_formatted():
    code, wrong = complaints(formatter(), sources(FORMATTED))
    assert not wrong, f"run: {Path(formatter()).name} -i " + " ".join(wrong)
    assert code == 0


@needs_formatter
def test_another_format_is_found():
    """What the test above would not notice if the options of clang-format changed their meaning."""
    done = subprocess.run([formatter(), "--dry-run", "-Werror", f"--assume-filename={SOURCE}/tests/unit/odd.cpp"],
                          input="int  twice (int *a){return 2**a;}\n", capture_output=True, text=True, timeout=60)
    assert done.returncode != 0 and "error: code should be clang-formatted" in done.stderr


def test_names_of_tests_are_snake_case():
    named = [(path, name) for path in sources({".cpp"})
             for name in re.findall(r"^TEST(?:_F|_P)?\(\w+,\s+(\w+)\)", path.read_text(encoding="utf-8"), re.M)]
    assert len(named) > 300, "the tests are not written as this test expects"
    odd = [f"{path.relative_to(SOURCE)}: {name}" for path, name in named if name != name.lower()]
    assert not odd, "\n".join(odd)


def test_lines_have_up_to_120_columns():
    files = [*sources(NARROW), SOURCE / "kerf", *SOURCE.glob("framework/**/CMakeLists.txt")]
    wide = [f"{path.relative_to(SOURCE)}:{number}: {len(line)} columns"
            for path in files for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
            if len(line) > COLUMNS]
    assert not wide, "\n".join(wide)
