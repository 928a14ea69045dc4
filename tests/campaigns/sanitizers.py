"""Builds with the sanitizers of addresses and undefined behaviour; runs the unit, point, patch and parallel tests."""

import os
import subprocess

from harness import BUILD, SOURCE, Report

FOLDER = BUILD / "sanitizers"
FLAGS = "-fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer -g1"
LABELS = ("unit", "point", "patch", "parallel")


def campaign(short=False):
    report = Report("sanitizers")
    jobs = os.environ.get("KERF_JOBS", str(os.cpu_count()))
    labels = LABELS[:1] if short else LABELS
    subprocess.run(["cmake", "-G", "Ninja", "-S", str(SOURCE), "-B", str(FOLDER), "-DCMAKE_BUILD_TYPE=Release",
                    f"-DCMAKE_CXX_FLAGS={FLAGS}", f"-DCMAKE_EXE_LINKER_FLAGS={FLAGS}", "-DCMAKE_CXX_FLAGS_RELEASE=-O1"],
                   check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["ninja", "-C", str(FOLDER), "-j", jobs, *(f"kerf_{label}_tests" for label in labels)], check=True,
                   stdout=subprocess.DEVNULL)
    # Open MPI and the libraries below it keep memory to the end; leaks of theirs are not ours to mend.
    environment = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0:detect_stack_use_after_return=1",
                   "UBSAN_OPTIONS": "print_stacktrace=1"}
    for label in labels:
        done = subprocess.run(["ctest", "--output-on-failure", "-L", f"^{label}$", "-E", "narrow"], cwd=FOLDER,
                              env=environment, capture_output=True, text=True, errors="replace")
        if done.returncode == 0 and "No tests were found" not in done.stdout:
            report.passed(f"{label} tests")
        else:
            report.failed(f"{label} tests", done.stdout[-4000:])
    return report
