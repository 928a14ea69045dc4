"""The rooms depend on one another in one direction only (doc/developers/architecture.md)."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "doc" / "developers"))

import draw_floors  # noqa: E402

INCLUDE = re.compile(r'^\s*#include\s+["<]([^">]+)[">]', re.M)
ROOMS = {room for floor in draw_floors.FLOORS for room in floor}


def includes(path):
    return INCLUDE.findall(path.read_text(encoding="utf-8"))


def test_every_room_stands_on_a_floor():
    folders = {path.name for path in (ROOT / "framework").iterdir() if list(path.glob("*.[hc]pp"))}
    assert folders - {"cmake"} == ROOMS  # cmake/ has programs that check the compiler


def test_rooms_include_only_rooms_of_lower_floors():
    assert draw_floors.upward_arrows() == []


def test_the_headers_of_plugins_include_no_room():
    wrong = [f"{path.relative_to(ROOT)} includes {name}" for path in sorted((ROOT / "framework/api").rglob("*.hpp"))
             for name in includes(path) if name.split("/")[0] in ROOMS]
    assert not wrong, "\n".join(wrong)


def test_no_room_is_larger_than_a_sixth_of_the_house():
    lines = {room: draw_floors.lines_of(room) for room in ROOMS}
    headers = sum(len(path.read_text().splitlines()) for path in (ROOT / "framework/api/kerf").glob("*.hpp"))
    assert max(lines.values()) < (headers + sum(lines.values())) / 6, lines


def test_the_picture_of_the_floors_is_the_one_of_these_sources():
    drawn = (ROOT / "doc/developers/floors.svg").read_text(encoding="utf-8")
    assert drawn == draw_floors.picture(), "run: python3 doc/developers/draw_floors.py > doc/developers/floors.svg"


def test_physics_and_partitioners_see_only_what_an_outside_author_sees():
    wrong = []
    for room in ("physics", "partitioners"):
        for path in sorted((ROOT / room).rglob("*.[hc]pp")):
            for name in includes(path):
                if name.split("/")[0] in ROOMS:
                    wrong.append(f"{path.relative_to(ROOT)} includes {name}")
    assert not wrong, "\n".join(wrong)


def test_trilinos_headers_stay_in_their_rooms():
    wrong = []
    for path in sorted(ROOT.glob("**/*.[hc]pp")):
        place = path.relative_to(ROOT).parts
        if place[0].startswith("build"):
            continue
        for name in includes(path):
            tpetra = name.startswith(("Tpetra", "Teuchos", "Kokkos"))
            zoltan = name.lower().startswith("zoltan") and name != "zoltan_support.hpp"
            if tpetra and place[:2] != ("framework", "parallel") or zoltan and place[0] != "partitioners":
                wrong.append(f"{path.relative_to(ROOT)} includes {name}")
    assert not wrong, "\n".join(wrong)
