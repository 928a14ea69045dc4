"""Runs clang-tidy, with the checks of .clang-tidy, over all sources of the engine, the plugins and the tests."""

import json
import os
import re
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from harness import BUILD, SOURCE, Report

ROOMS = ("framework", "physics", "partitioners", "tests")


def sources(short):
    entries = json.loads((BUILD / "compile_commands.json").read_text())
    files = sorted({Path(e["file"]) for e in entries})
    ours = [f for f in files if f.is_relative_to(SOURCE) and f.relative_to(SOURCE).parts[0] in ROOMS]
    return ours[::20] if short else ours


def campaign(short=False):
    report = Report("tidy")
    if shutil.which("clang-tidy") is None:
        report.failed("clang-tidy is installed", "install clang-tidy")
        return report

    def look(file):
        # Flags of GCC that Clang does not know are no faults of ours.
        done = subprocess.run(["clang-tidy", "--quiet", "-p", str(BUILD), "--extra-arg=-Wno-unknown-warning-option",
                               "--extra-arg=-Wno-ignored-optimization-argument",
                               "--extra-arg=-Wno-unused-command-line-argument", str(file)],
                              capture_output=True, text=True, errors="replace")
        return file, sorted(set(re.findall(r"^\S+:\d+:\d+: (?:warning|error): .*$", done.stdout, re.M)))

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for file, lines in pool.map(look, sources(short)):
            if lines:
                report.failed(str(file.relative_to(SOURCE)), "\n".join(lines))
            else:
                report.passed("files without a finding")
    return report
