"""The sample decks, their units, and the figures that an independent reader has made of them."""

import csv
import json
import re
import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "input"))

from input_case import SOURCE, kerf, on_ranks, summary_of  # noqa: E402, F401

DECKS = SOURCE / "tests" / "data" / "decks"
# The deck, and its units as --units takes them.
UNITS = {"01_one_element/one_element.k": "kg,m,s", "02_taylor_bar/taylor.k": "kg-mm-ms",
         "03_oblique_rod/rod.k": "g,cm,us", "04_ball_free_format/ball.k": "g-mm-ms",
         "05_plate_impact/plate_impact.k": "g,cm,us", "06_explosive_tube/tube.k": "g-cm-us",
         "07_ceramic_tile/tile.k": "mm-ms-kg", "08_tension_table/tension.k": "t-mm-s",
         "09_include_transform/assembly.k": "t,mm,s", "10_topologies/topologies.k": "si",
         "11_long_format/abutting.k": "si", "11_long_format/i10.k": "si", "11_long_format/i10_whole_deck.k": "si",
         "11_long_format/long.k": "si", "11_long_format/plus.k": "si", "12_rubber_ball/rubber_ball.k": "kg-mm-ms"}
SI = {"kg": 1.0, "g": 1e-3, "t": 1e3, "m": 1.0, "mm": 1e-3, "cm": 1e-2, "s": 1.0, "ms": 1e-3, "us": 1e-6}


def in_si(units):
    """Mass, length and time of a system of units in SI."""
    names = {"si": "kg,m,s", "mm-ms-kg": "kg,mm,ms"}.get(units, units.replace("-", ",")).split(",")
    return [SI[name] for name in names]


def figures_of(deck):
    return json.loads((DECKS / deck).with_suffix("").with_suffix(".expected.json").read_text())


def copied(deck, folder):
    """The folder of a deck in another place, where a run may leave its results; returns the deck there."""
    shutil.copytree((DECKS / deck).parent, folder, dirs_exist_ok=True)
    return folder / Path(deck).name


def run(deck, *words, timeout=600):
    """Runs a deck, and returns its summary."""
    done = kerf("run", deck.name, *words, cwd=deck.parent, timeout=timeout)
    assert done.returncode == 0, done.stdout + done.stderr
    return summary_of(deck.parent / "results" / deck.stem)


def table_of_parts(text):
    """Rows of `kerf check` by the id of the part: volume, mass and what else stands in a row."""
    head, _, rest = text.partition("      part  called")
    assert rest, text
    rows = {}
    for line in rest.splitlines()[1:]:
        found = re.match(r" *(\d+)  (\S+) .*?(\d.*?)\s+(\S+)\s+(\S+)$", line)
        if not found:
            break
        rows[found[1]] = {"name": found[2], "volume": float(found[4]), "mass": float(found[5]), "line": line}
    return rows


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file, delimiter="\t"))
