"""Runs the Python tests with the newest Python packages in an environment of their own, and says what changed."""

import os
import subprocess
import sys

from harness import BUILD, SOURCE, Report, workplace

FOLDERS = ("python", "input", "regression", "studies")


def imported_packages():
    """The names that Kerf imports: those of the first list of the requirements."""
    text = (SOURCE / "framework" / "post" / "requirements.txt").read_text()
    first = text.split("# Imported by Kerf.")[1].split("#")[0]
    return [line.split("==")[0] for line in first.split()]


def versions(python):
    out = subprocess.run([python, "-m", "pip", "--disable-pip-version-check", "list", "--format=freeze"],
                         capture_output=True, text=True, check=True).stdout
    return dict(line.split("==") for line in out.split() if "==" in line)


def pinned():
    text = (SOURCE / "framework" / "post" / "requirements.txt").read_text()
    return dict(line.split("==") for line in text.splitlines() if "==" in line and not line.startswith("#"))


def campaign(short=False):
    report = Report("newest_python")
    with workplace() as parent:
        python = str(parent / "venv" / "bin" / "python")
        subprocess.run([sys.executable, "-m", "venv", str(parent / "venv")], check=True)
        subprocess.run([python, "-m", "pip", "--disable-pip-version-check", "install", "--quiet", "--upgrade",
                        *imported_packages()], check=True)
        newest, ours = {k.lower(): v for k, v in versions(python).items()}, pinned()
        for name, version in ours.items():
            now = newest.get(name.lower().replace("_", "-"), newest.get(name.lower(), "absent"))
            report.passed("packages that are the newest" if now == version else "packages with a newer version")
            if now != version:
                print(f"{name}: {version} is required, {now} is the newest", flush=True)
        environment = {**os.environ, "KERF_BUILD_DIR": str(BUILD), "PYTHONDONTWRITEBYTECODE": "1"}
        for folder in FOLDERS:
            words = [python, "-m", "pytest", "-q", "-ra", "--tb=short", "-p", "no:cacheprovider",
                     str(SOURCE / "tests" / folder)]
            if short:
                words += ["-x", "-k", "test_vtkhdf"]
            done = subprocess.run(words, cwd=SOURCE, env=environment, capture_output=True, text=True)
            if done.returncode in (0, 5):
                report.passed(f"tests/{folder} passes")
            else:
                report.failed(f"tests/{folder}", done.stdout[-3000:])
    return report
