"""The pages of the kinds of plugins show the sources of today, and there is one for every kind."""

import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "doc" / "plugin-authors"))
import write_kinds  # noqa: E402

WRITTEN = write_kinds.pages()


@pytest.mark.parametrize("name", WRITTEN)
def test_pages_are_those_of_the_sources(name):
    assert (write_kinds.PAGES / name).read_text(encoding="utf-8") == WRITTEN[name], (
        "run python3 doc/plugin-authors/write_kinds.py")


def test_every_kind_has_a_page():
    kinds = re.findall(r'\{"(\w+)", (?:"\w+"|nullptr)\}', (ROOT / "framework" / "plugin" / "kinds.hpp").read_text())
    assert len(kinds) > 10 and set(kinds) == set(write_kinds.KINDS)


def test_sections_are_there():
    headings = re.findall(r"^#+ (.*)$", (ROOT / "doc/plugin-authors/writing_a_plugin.md").read_text(), re.M)
    anchors = {re.sub(r"[^\w -]", "", h).lower().replace(" ", "-") for h in headings}
    assert {section for *_, section in write_kinds.KINDS.values() if section} <= anchors
