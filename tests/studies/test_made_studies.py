"""The studies of doc/studies: small ones are made whole, and their tables and figures are there."""

import os
import re
import subprocess
import sys

import pytest
from study_case import KERF, STUDIES

MADE = STUDIES.parents[1] / "doc" / "studies"
sys.path.insert(0, str(MADE))
PAGES = {"classical": "classical_speedup.md", "erosion": "erosion_imbalance.md"}


def tables_of(text):
    return dict(re.findall(r"<!-- table: (\w+) -->\n(.*?)<!-- end -->", text, re.S))


@pytest.mark.parametrize("study", sorted(PAGES))
def test_a_small_study_fills_its_page(study, tmp_path):
    before = (MADE / PAGES[study]).read_text()
    done = subprocess.run([sys.executable, "-B", str(MADE / "make_studies.py"), study, "--quick", "--output",
                           str(tmp_path)], capture_output=True, text=True, check=False, timeout=600,
                          env={**os.environ, "KERF_BINARY": str(KERF)})
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "pages" / PAGES[study]).read_text()
    tables = tables_of(page)
    assert tables and tables.keys() == tables_of(before).keys()
    for name, text in tables.items():
        rows = [line for line in text.splitlines() if line.startswith("|")]
        assert len(rows) >= 3 and len({row.count("|") for row in rows}) == 1, name
    if study == "erosion":  # its models stand below one another, each under its name
        for name in ("causes", "policies", "predicted", "targets"):
            assert re.findall(r"^\*\*(\w+)\*\*$", tables[name], re.M) == ["small_rod", "small_penetration"], name
    assert (MADE / PAGES[study]).read_text() == before
    figures = list((tmp_path / "pages").glob("*.png"))
    assert figures and all(1000 < figure.stat().st_size < 150_000 for figure in figures)


@pytest.mark.parametrize("page", sorted(PAGES.values()))
def test_figures_of_a_page_are_beside_it(page):
    figures = re.findall(r"\]\((\w+\.png)\)", (MADE / page).read_text())
    assert figures
    for figure in figures:
        assert (MADE / figure).stat().st_size < 150_000, figure


def test_a_table_without_a_place_is_refused(tmp_path):
    from study_tools import StudyError, put_tables

    page = tmp_path / "page.md"
    page.write_text("a\n<!-- table: one -->\nold\n<!-- end -->\nb\n")
    put_tables(page, {"one": "new"})
    assert page.read_text() == "a\n<!-- table: one -->\nnew\n<!-- end -->\nb\n"
    with pytest.raises(StudyError, match=r"places for the tables \['one'\]; expected one for each of \['two'\]"):
        put_tables(page, {"two": "new"})


def test_states_that_differ_are_told(tmp_path):
    from study_tools import StudyError, equal_hashes

    for n, state in ((1, "a"), (2, "b")):
        (tmp_path / str(n)).mkdir()
        (tmp_path / str(n) / "summary.json").write_text(f'{{"state_hash": "{state}"}}')
    assert equal_hashes({1: tmp_path / "1"}) == "a"
    with pytest.raises(StudyError, match="state hashes differ"):
        equal_hashes({1: tmp_path / "1", 2: tmp_path / "2"})


def test_a_call_is_repeated_when_a_file_of_it_has_changed(tmp_path, monkeypatch):
    import study_tools

    monkeypatch.setattr(study_tools, "binary_of_kerf", lambda: KERF)
    copy = tmp_path / "copy.sh"
    copy.write_text('cp "$1" "$3/result"\n')
    source = tmp_path / "input.yaml"
    results = []
    for text in ("one", "one", "two"):
        source.write_text(text)
        (tmp_path / "out").mkdir(exist_ok=True)
        before = (tmp_path / "out" / "result").stat().st_mtime_ns if results else 0
        study_tools.once(["bash", copy, source], tmp_path / "out", "result")
        made = (tmp_path / "out" / "result").stat().st_mtime_ns != before
        results.append(((tmp_path / "out" / "result").read_text(), made))
    assert results == [("one", True), ("one", False), ("two", True)]
