"""Builds with Clang and for the plainest x86-64 processor; runs unit, point and patch tests, compares stored hashes."""

import os
import shutil
import subprocess
import sys

from harness import BUILD, SOURCE, Report

LABELS = ("unit", "point", "patch")
# By name: the two compilers, and the architecture that they build for; empty for this machine.
BUILDS = {"clang": ("clang++", "clang", ""), "plain": ("g++", "gcc", "x86-64")}


def build(name, compiler, c_compiler, architecture, labels, report):
    folder = BUILD / "compilers" / name
    jobs = os.environ.get("KERF_JOBS", str(os.cpu_count()))
    configured = subprocess.run(
        ["cmake", "-G", "Ninja", "-S", str(SOURCE), "-B", str(folder), "-DCMAKE_BUILD_TYPE=Release",
         f"-DCMAKE_CXX_COMPILER={shutil.which(compiler)}", f"-DCMAKE_C_COMPILER={shutil.which(c_compiler)}",
         f"-DKERF_ARCH={architecture}"], capture_output=True, text=True)
    made = configured.returncode == 0 and subprocess.run(
        ["ninja", "-C", str(folder), "-j", jobs, "kerf", *(f"kerf_{label}_tests" for label in labels)],
        capture_output=True, text=True)
    if not made or made.returncode != 0:
        report.failed(f"builds with {name}", (made.stdout if made else configured.stderr)[-4000:])
        return None
    report.passed(f"builds with {name}")
    return folder


def campaign(short=False):
    report = Report("compilers")
    for name, (compiler, c_compiler, architecture) in BUILDS.items():
        if shutil.which(compiler) is None:
            report.failed(f"{compiler} is installed", f"install {compiler}")
            continue
        labels = LABELS[1:2] if short else LABELS
        folder = build(name, compiler, c_compiler, architecture, labels, report)
        if folder is None:
            continue
        for label in labels:
            done = subprocess.run([str(folder / "tests" / f"kerf_{label}_tests"), "--gtest_brief=1"],
                                  capture_output=True, text=True, errors="replace")
            if done.returncode == 0 and "PASSED" in done.stdout:
                report.passed(f"{name}: {label} tests")
            else:
                report.failed(f"{name}: {label} tests", done.stdout[-4000:])
        hashes = subprocess.run([sys.executable, str(SOURCE / "tests" / "regression" / "stored_hashes.py")],
                                capture_output=True, text=True,
                                env={**os.environ, "KERF_BINARY": str(folder / "bin" / "kerf")})
        if hashes.returncode == 0:
            report.passed(f"{name}: stored hashes")
        else:
            report.failed(f"{name}: stored hashes", hashes.stdout + hashes.stderr[-2000:])
    return report
