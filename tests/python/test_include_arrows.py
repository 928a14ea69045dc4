"""The rooms depend on one another in one direction only (doc/developers/architecture.md)."""
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# A room includes itself and the rooms of lower floors; those of its own floor only where named here.
FLOORS = [["core"], ["parallel", "output", "plugin"], ["input"], ["mesh"], ["model"], ["erosion"], ["contact"], ["review"], ["dynamics"],
          ["report"], ["app"]]
MAY_INCLUDE = {"api": set()}
for floor, rooms in enumerate(FLOORS):
    for room in rooms:
        MAY_INCLUDE[room] = {room} | {below for lower in FLOORS[:floor] for below in lower}
INCLUDE = re.compile(r'^\s*#include\s+["<]([^">]+)[">]', re.M)
ROOMS = set(MAY_INCLUDE) - {"api"}


def includes(path):
    return INCLUDE.findall(path.read_text(encoding="utf-8"))


def test_rooms_of_the_framework_include_only_rooms_below():
    wrong = []
    for room, allowed in MAY_INCLUDE.items():
        for path in sorted((ROOT / "framework" / room).rglob("*.[hc]pp")):
            for name in includes(path):
                first = name.split("/")[0]
                if first in ROOMS and first not in allowed:
                    wrong.append(f"{path.relative_to(ROOT)} includes {name}")
    assert not wrong, "\n".join(wrong)


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
