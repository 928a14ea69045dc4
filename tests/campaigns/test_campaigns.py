"""A short form of each campaign: a spread of the faults that the full form goes through one by one."""

import importlib
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))


@pytest.mark.parametrize("name", ["damaged_restarts", "kills", "io_faults", "parameters"])
def test_short_form(name):
    report = importlib.import_module(name).campaign(short=True)
    assert not report.faults, report.text() + "\n" + "\n".join(report.faults)
    assert sum(report.counts.values()) > 20, report.text()


def test_short_form_of_fuzzing():
    fuzz_input = importlib.import_module("fuzz_input")
    if not fuzz_input.is_possible():
        pytest.skip("clang++ and its fuzzer are not installed")
    report = fuzz_input.campaign(short=True)
    assert not report.faults, "\n".join(report.faults)
    assert report.counts["inputs read or refused"] > 1000
