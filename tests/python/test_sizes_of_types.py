"""Every type of the headers that plugins include is in the list of sizes of its header, which manifests are made of."""

import re
from pathlib import Path

import pytest

HEADERS = sorted((Path(__file__).resolve().parents[2] / "framework" / "api" / "kerf").glob("*.hpp"))
# All of their types are compiled into a plugin, or into Kerf, and are handed to nobody.
HELPERS = {"compaction_table", "contact_geometry", "functions", "lanes", "manifest", "radial_return", "select",
           "shock_sensor", "sizes", "solid_blocks", "solid_element", "solid_kernel", "solid_laws", "solid_motion",
           "solid_rows", "tension_limit"}
# Types inside of others that are handed to nobody.
INNER = {"Expression::Stack", "LaneErrors"}


def types_of(text):
    """The structs and classes of the namespace kerf that are no templates, and the public ones inside of them."""
    found, spaces, outer, before = [], [], None, ""
    for line in text.splitlines():
        if match := re.match(r"(?:inline )?namespace ([\w:]+) \{", line):
            spaces.append(match.group(1))
        elif re.match(r"\}  // namespace", line):
            spaces.pop()
        elif spaces == ["kerf"]:
            if match := re.match(r"(?:struct|class)(?: \[\[.*?\]\]| alignas\(\w+\))* (\w+)[^;]*$", line):
                outer = None if before.startswith("template") else match.group(1)
                found += [outer] if outer else []
            elif match := re.match(r"  (?:struct|class) (\w+)[^;]*\{", line):
                found += [f"{outer}::{match.group(1)}"] if outer and not before.startswith("  template") else []
        before = line
    return [name for name in found if name not in INNER]


def listed_in(text):
    call = re.search(r"^KERF_SIZES\((\w+),(.*?)\)\n", text + "\n", re.MULTILINE | re.DOTALL)
    return call and (call.group(1), re.findall(r"KERF_SIZE\(([\w:]+)\)", text[call.start():]))


@pytest.mark.parametrize("path", HEADERS, ids=lambda path: path.stem)
def test_every_type_is_listed(path):
    text = path.read_text()
    if path.stem in HELPERS:
        assert path.stem == "sizes" or listed_in(text) is None
        return
    header, names = listed_in(text) or (None, [])
    assert header == path.stem, f"{path.name} has no KERF_SIZES({path.stem}, ...) at its end"
    missing = set(types_of(text)) - set(names)
    assert not missing, f"KERF_SIZES of {path.name} lacks {', '.join(sorted(missing))}"


def test_what_is_a_type():
    assert types_of("""namespace kerf {
struct Forward;
struct One final : Base {
  struct Inner {
  };
};
template <class T>
class Many {
};
namespace detail {
struct Hidden {
};
}  // namespace detail
}  // namespace kerf
""") == ["One", "One::Inner"]
