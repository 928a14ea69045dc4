"""A short form of each campaign: a spread of the faults that the full form goes through one by one."""

import importlib
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))


@pytest.mark.parametrize("name", ["damaged_restarts", "kills", "io_faults"])
def test_short_form(name):
    report = importlib.import_module(name).campaign(short=True)
    assert not report.faults, report.text() + "\n" + "\n".join(report.faults)
    assert sum(report.counts.values()) > 20, report.text()
