"""The reference pages in doc/reference are those that the program writes, and every link in them leads somewhere."""

import os
import re
import subprocess
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2]
KERF = os.environ.get("KERF_BINARY", str(SOURCE / "build" / "bin" / "kerf"))
COMMITTED = SOURCE / "doc" / "reference"


def pages(folder):
    return {path.relative_to(folder).as_posix(): path.read_text() for path in folder.rglob("*.md")}


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """The pages as the program writes them now, in a folder that has the theory pages beside it."""
    root = tmp_path_factory.mktemp("doc")
    (root / "theory").symlink_to(SOURCE / "doc" / "theory")
    subprocess.run([KERF, "reference", "--output", str(root / "reference")], check=True, timeout=60)
    return pages(root / "reference")


def test_committed_pages_are_up_to_date(written):
    committed = pages(COMMITTED)
    stale = sorted(name for name in written if committed.get(name) != written[name])
    left_over = sorted(set(committed) - set(written))
    assert not stale and not left_over, (
        f"pages that differ: {stale}; pages of types that are gone: {left_over}; "
        "run: rm -r doc/reference && ./kerf reference --output doc/reference")


def test_every_type_has_a_page(written):
    listing = subprocess.run([KERF, "list"], capture_output=True, text=True, check=True, timeout=60).stdout
    kind = None
    for line in filter(None, listing.splitlines()):
        if line.startswith(" "):
            assert f"{kind}/{line.split()[0]}.md" in written
        else:
            kind = line.strip()
    assert kind is not None


def anchor(heading):
    """The anchor that Markdown viewers give a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def test_links_lead_somewhere():
    assert len(pages(COMMITTED)) > 30
    for name, text in pages(COMMITTED).items():
        for target, section in re.findall(r"\]\(([^)#]*)#?([^)]*)\)", text):
            page = (COMMITTED / name).parent / target
            assert page.is_file(), f"{name} links to {target}, which does not exist"
            headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
            assert not section or section in map(anchor, headings), f"{name}: {target} has no section {section}"


def test_laws_link_to_their_equations():
    kinds = {folder.name for folder in COMMITTED.iterdir() if folder.is_dir()}
    assert {"eos", "material", "solid"} <= kinds
    for kind in kinds - {"mesh", "library"}:  # generators and sets of constants have no equations
        for page in (COMMITTED / kind).glob("*.md"):
            assert "](../../theory/" in page.read_text(), f"{kind}/{page.name} does not name its theory page"


def test_no_dead_links_where_there_is_no_theory(tmp_path):
    subprocess.run([KERF, "reference", "--output", str(tmp_path / "reference")], check=True, timeout=60)
    assert not any("theory/" in text for text in pages(tmp_path / "reference").values())
