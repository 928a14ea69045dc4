"""Draws the rooms of framework/ with the numbers of their floors, and arrows to the rooms that they include.

    python3 doc/developers/draw_floors.py > doc/developers/floors.svg

A room may include the rooms of lower floors only. tests/python/test_include_arrows.py holds the sources to that, and
the picture to the sources.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FLOORS = [["core"], ["profile", "parallel", "output", "plugin"], ["mesh"], ["input", "decks"], ["lowering", "model"],
          ["erosion", "loads", "partition"], ["contact"], ["review", "drive"], ["dynamics"], ["report", "conformance"],
          ["app"]]
INCLUDE = re.compile(r'^\s*#include\s+"([^"/]+)/', re.M)
WIDTH, HEIGHT, GAP, LEFT = 150, 34, 26, 30


def includes_of(room):
    """The other rooms that the files of a room include."""
    found = set()
    for path in (ROOT / "framework" / room).glob("*.[hc]pp"):
        found |= set(INCLUDE.findall(path.read_text(encoding="utf-8")))
    return found & {name for floor in FLOORS for name in floor} - {room}


def lines_of(room):
    return sum(len(path.read_text(encoding="utf-8").splitlines())
               for path in (ROOT / "framework" / room).glob("*.[hc]pp"))


def floor_of(room):
    return next(k for k, rooms in enumerate(FLOORS) if room in rooms)


def upward_arrows():
    """Pairs of a room and one that it includes although it does not stand below."""
    return [(room, other) for rooms in FLOORS for room in rooms for other in sorted(includes_of(room))
            if floor_of(other) >= floor_of(room)]


ROWS = [room for rooms in reversed(FLOORS) for room in rooms]


def top_of(room):
    return GAP + ROWS.index(room) * (HEIGHT + GAP // 2)


def arrow(room, other, lane, leaving, arriving):
    """From the right edge of a room, down a lane of its own, to the right edge of the included one."""
    right = LEFT + WIDTH + 24 + 14 * lane
    start, end = top_of(room) + HEIGHT - 6 - 4 * leaving, top_of(other) + 6 + 4 * arriving
    return (f'<path d="M{LEFT + WIDTH} {start} H{right} V{end} H{LEFT + WIDTH + 2}" class="arrow" '
            f'marker-end="url(#tip)"><title>{room} includes {other}</title></path>')


def steps():
    """Pairs of a room and one that it includes, without the pairs that other pairs imply, so that they can be read."""
    reach = {room: includes_of(room) for room in ROWS}
    return [(a, b) for a in ROWS for b in ROWS if b in reach[a] and not any(b in reach[c] for c in reach[a] - {b})]


def picture():
    drawn = steps()
    width, height = LEFT + WIDTH + 24 + 14 * len(drawn) + GAP, GAP + len(ROWS) * (HEIGHT + GAP // 2)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif">',
           "<style>.room{fill:#eef3f8;stroke:#35506b}.arrow{fill:none;stroke:#6b7c8d}text{font-size:13px}"
           ".size{font-size:10px;fill:#667}</style>",
           '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
           '<path d="M0 0 L8 4 L0 8 z" fill="#6b7c8d"/></marker></defs>',
           f'<rect width="{width}" height="{height}" fill="white"/>']
    leaving, arriving = dict.fromkeys(ROWS, 0), dict.fromkeys(ROWS, 0)
    for lane, (room, other) in enumerate(drawn):
        out.append(arrow(room, other, lane, leaving[room], arriving[other]))
        leaving[room] += 1
        arriving[other] += 1
    for room in ROWS:
        y = top_of(room)
        # Rounded, so that the picture does not change with every commit.
        thousands = max(round(lines_of(room) / 500), 1) / 2
        out += [f'<text x="8" y="{y + 21}" class="size">{floor_of(room)}</text>',
                f'<rect x="{LEFT}" y="{y}" width="{WIDTH}" height="{HEIGHT}" rx="4" class="room"/>',
                f'<text x="{LEFT + 10}" y="{y + 21}">{room}</text>',
                f'<text x="{LEFT + WIDTH - 8}" y="{y + 21}" text-anchor="end" class="size">'
                f'{thousands:g} k lines</text>']
    return "\n".join(out + ["</svg>", ""])


if __name__ == "__main__":
    sys.stdout.write(picture())
