"""The program, the small good input that tests change, and how they call the one with the other."""

import json
import os
import subprocess
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
KERF = str(Path(os.environ.get("KERF_BINARY", SOURCE / "build" / "bin" / "kerf")).resolve())
# Ranks that wait must not keep others from a core where several programs share it.
os.environ.setdefault("OMPI_MCA_mpi_yield_when_idle", "1")
GOOD = (HERE / "good.yaml").read_text()


def spoiled(edits, text=GOOD):
    """`text` with each pair (old, new) of `edits` carried out; what is replaced must stand there once."""
    for old, new in edits:
        assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times in the input"
        text = text.replace(old, new)
    return text


def kerf(*words, cwd=None, timeout=120, env=None):
    return subprocess.run([KERF, *(str(w) for w in words)], cwd=cwd, capture_output=True, text=True, timeout=timeout,
                          env=env)


def on_ranks(n):
    return ["--ranks", n] if n > 1 else []


def settings(values):
    """{"time.end": "1 us"} as options."""
    return [word for key, value in values.items() for word in ("--set", f"{key}={value}")]


def summary_of(folder):
    return json.loads((Path(folder) / "summary.json").read_text())
