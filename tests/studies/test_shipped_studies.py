"""The studies that come with Kerf: all are accepted, and one is run."""

import re
import subprocess

import pytest
import yaml
from study_case import ROOT, SWEEP, fits_of, sweep, table

from shipped import STUDIES

WITH_POINTS = [path for path in STUDIES if "\npoints:" in path.read_text()]


def test_there_are_some():
    assert len(STUDIES) >= 3 and len(WITH_POINTS) >= 2


@pytest.mark.parametrize("path", STUDIES, ids=lambda path: str(path.relative_to(ROOT)))
def test_shipped_studies_are_accepted(path, tmp_path):
    done = subprocess.run([*SWEEP, str(path), "--output", str(tmp_path / "out"),
                           "--check" if path in WITH_POINTS else "--collect"], capture_output=True, text=True)
    if path in WITH_POINTS:
        assert done.returncode == 0, done.stderr
    else:  # Dakota brings the points
        assert done.stderr.endswith("there is no such folder; expected that of an earlier kerf sweep\n"), done.stderr


def test_the_length_of_the_taylor_bar_converges(tmp_path):
    """The shipped study on its three middle meshes. The finest one takes as long as all others, and the coarsest is
    outside of the range in which the order is steady. The order that was measured is 1.16, and 1.22 with the finest."""
    path = ROOT / "inputs" / "taylor_bar" / "studies" / "convergence.yaml"
    study = yaml.safe_load(path.read_text())
    assert study["points"]["values"].pop() == {"cell_size": "0.32 mm"}
    del study["points"]["values"][0]
    study["input"] = str((path.parent / study["input"]).resolve())
    study["plots"].pop()
    mine = tmp_path / "convergence.yaml"
    mine.write_text(yaml.safe_dump(study))
    done = sweep(mine)
    assert done.returncode == 0, done.stdout + done.stderr
    assert {point["trust"] for point in table(mine)} == {"yes"} and len(table(mine)) == 3
    finest = fits_of(mine)[0]["triplets"][0]
    assert finest["behaviour"] == "monotone" and 1.0 < finest["order"] < 1.5
    assert finest["extrapolated"] == pytest.approx(26.45e-3, abs=0.02e-3)
    assert (tmp_path / "out" / "plots" / "convergence_length.png").stat().st_size > 5000


def test_the_page_shows_the_shipped_files():
    """Commands and files that doc/users/sweep.md names are there."""
    page = (ROOT / "doc" / "users" / "sweep.md").read_text()
    named = set(re.findall(r"inputs/\w+/studies/[\w.]+", page))
    assert named >= {str(path.relative_to(ROOT)) for path in STUDIES}
    assert all((ROOT / name).exists() for name in named)
    shown = re.search(r"```\n(# A Latin hypercube of six.*?)```", page, re.DOTALL).group(1)
    assert shown == (ROOT / "inputs" / "taylor_bar" / "studies" / "dakota.in").read_text()


def first_block(page, heading):
    text = (ROOT / "doc" / "users" / page).read_text()
    return re.search(rf"## {heading}\n.*?```yaml\n(.*?)```", text, re.DOTALL).group(1)


def test_the_example_of_the_page_is_a_study_of_the_example_of_the_input(tmp_path):
    (tmp_path / "plate.yaml").write_text(first_block("input.md", "An example"))
    study = tmp_path / "plate_study.yaml"
    study.write_text(first_block("sweep.md", "An example"))
    done = sweep(study, "--check")
    assert done.returncode == 0, done.stderr
    assert "10 points of" in done.stdout and "parts.rod.velocity = [0, 0, -1600] m/s" in done.stdout


def test_the_mistakes_of_the_page_are_told_like_that(tmp_path):
    (tmp_path / "plate.yaml").write_text(first_block("input.md", "An example"))
    text = first_block("sweep.md", "An example")
    (tmp_path / "plate_study.yaml").write_text(text.replace("strength.yield", "strength.yeild").replace(
        "to: 1600 m/s", "to: 1 km/s"))
    done = sweep(tmp_path / "plate_study.yaml", "--check")
    page = (ROOT / "doc" / "users" / "sweep.md").read_text()
    lines = re.findall(r"^plate_study\.yaml:.*$", page, re.MULTILINE)
    assert len(lines) == 2
    assert [line.replace(f"{tmp_path}/", "") for line in done.stderr.splitlines()][:2] == lines
