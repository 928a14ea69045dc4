"""Every file and every command of doc/plugin-authors/tutorial.md, in their order, as a reader would take them."""

import json
import re
import shlex
import subprocess
from pathlib import Path

from plugin_case import BUILD, KERF, SOURCE, cached

PAGE = SOURCE / "doc" / "plugin-authors" / "tutorial.md"
# A file to write, named in a line of its own before its block, or commands.
STEP = re.compile(r"^`([\w./]+)`:\n\n```\w+\n(.*?)^```|^```console\n(.*?)^```", re.M | re.S)


def steps():
    for name, text, commands in STEP.findall(PAGE.read_text()):
        yield (name, text) if name else (None, [line[2:] for line in commands.splitlines() if line.startswith("$ ")])


def words_of(command):
    words = [word.replace("/path/to/kerf/build", str(BUILD)) for word in shlex.split(command)]
    if words[0] == "kerf":
        words[0] = str(KERF)
    if words[0] == "cmake" and "-S" in words:
        words.append(f"-DCMAKE_CXX_COMPILER={cached('CMAKE_CXX_COMPILER')}")
    return words


def test_the_tutorial_works_from_its_first_to_its_last_command(tmp_path):
    folder, outputs = tmp_path, {}
    for name, what in steps():
        if name:
            (folder / name).write_text(what)
            continue
        for command in what:
            words = words_of(command)
            if words[0] == "cd":
                folder = folder / words[1]
                continue
            done = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=600)
            assert done.returncode == 0, command + "\n" + done.stdout + done.stderr
            outputs[command] = done.stdout
    hashes = next(text for command, text in outputs.items() if command.startswith("grep")).splitlines()
    assert len(hashes) == 2 and hashes[0] == hashes[1]
    summary = json.loads((folder / "results" / "one" / "summary.json").read_text())
    # "Some 800 m/s", and a hole.
    assert -850 < summary["measures"]["ball.z"] < -750, summary["measures"]
    assert summary["eroded"]["by_part"]["plate"] > 10


def test_the_page_has_files_and_commands():
    kinds = [name is None for name, _ in steps()]
    assert kinds.count(True) >= 4 and kinds.count(False) >= 6


def test_each_file_is_named_once_and_in_the_folder():
    names = [name for name, _ in steps() if name]
    assert len(set(names)) == len(names) and not any(Path(name).is_absolute() for name in names)
