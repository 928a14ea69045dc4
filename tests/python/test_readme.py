"""What the README says is true: its table of types, its plugin, the cases' commands. All pages' links."""

import os
import re
import shlex
import subprocess
from pathlib import Path

import pytest
import yaml

from plugin_compiler import compile_library

SOURCE = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("KERF_BUILD_DIR", SOURCE / "build")).resolve()
KERF = os.environ.get("KERF_BINARY", str(BUILD / "bin" / "kerf"))
README = (SOURCE / "README.md").read_text()
CASES = sorted((SOURCE / "inputs").glob("*/README.md"))
# The reference pages have a test of their own.
PAGES = [*SOURCE.glob("*.md"), *CASES, SOURCE / "doc" / "README.md",
         *(page for room in ("users", "theory", "plugin-authors", "developers", "studies")
           for page in sorted((SOURCE / "doc" / room).glob("*.md")))]


def call(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=300, cwd=SOURCE)


def links(text):
    text = re.sub(r"^```.*?^```|`[^`\n]*`", "", text, flags=re.MULTILINE | re.DOTALL)
    return [target for target in re.findall(r"\]\(([^)#]+)", text) if not target.startswith("http")]


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(SOURCE)))
def test_links_lead_to_files(page):
    for target in links(page.read_text()):
        assert (page.parent / target).exists(), target


def test_links_are_found():
    assert {"LICENSE", "doc/README.md"} <= set(links(README))


def test_quick_start_has_the_two_commands():
    block = re.search(r"## Quick start\n.*?```\n(.*?)```", README, re.DOTALL).group(1)
    assert block.splitlines() == ["./kerf run inputs/oblique_rod/oblique_rod.yaml", "./kerf test"]


def test_table_names_every_type():
    kinds, kind = {}, None
    for line in filter(None, call(KERF, "list").stdout.splitlines()):
        if line.startswith(" "):
            kinds[kind].add(line.split()[0])
        else:
            kind = line.strip()
            kinds[kind] = set()
    rows = {row[0]: set(re.findall(r"`(\w+)`", row[1]))
            for row in re.findall(r"^\| (\w+) \| (.*) \|$", README, re.MULTILINE) if row[0] in kinds}
    assert rows == kinds


def test_the_citation_and_the_changelog_know_this_version():
    version = call(KERF, "--version").stdout.split()[1]
    assert yaml.safe_load((SOURCE / "CITATION.cff").read_text())["version"] == version
    assert re.search(rf"^## v?{re.escape(version)} - ", (SOURCE / "CHANGELOG.md").read_text(), re.MULTILINE)


def test_every_case_is_named():
    for folder in sorted((SOURCE / "inputs").iterdir()):
        if any(folder.glob("*.yaml")):
            assert f"inputs/{folder.name}" in README


def test_the_plugin_compiles_and_is_described(tmp_path):
    source, library = tmp_path / "shear_stress.cpp", tmp_path / "shear_stress.so"
    source.write_text(re.search(r"^```cpp\n(.*?)^```", README, re.MULTILINE | re.DOTALL).group(1))
    compile_library(source, library, "-O1", "-Werror")
    done = call(KERF, "describe", "shear_stress", "--plugin", library)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("shear_stress (erosion): largest shear stress reaches a limit")


def commands_of(text):
    """The check and run commands that a page shows, as `kerf check` with the same input and values."""
    for block in re.findall(r"^```\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
        for line in block.splitlines():
            words = re.match(r"""\./kerf (?:run|check) (\S+\.yaml)((?: --set (?:"[^"]*"|[^\s"])+)*)""", line)
            if words:
                yield (words.group(1), *shlex.split(words.group(2)))


COMMANDS = sorted({command for page in [SOURCE / "README.md", *CASES] for command in commands_of(page.read_text())})


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_commands_shown_are_accepted(command):
    done = call(KERF, "check", *command)
    assert done.returncode == 0, done.stderr
