"""The headers that plugins include change only together with the number of their interface.

    python3 tests/python/test_interface_number.py --renew

stores the present headers for the present number: for a change that alters no plugin's meaning, or after the number
was raised.
"""

import hashlib
import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HEADERS = ROOT / "framework" / "api" / "kerf"
STORED = Path(__file__).with_name("interface.json")
COMMENT_OR_TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|("(?:\\.|[^"\\\n])*")', re.S)


def without_comments(text):
    """The code of a header without comments and white space; texts stay as they are."""
    return "".join(COMMENT_OR_TEXT.sub(lambda found: found.group(1) or " ", text).split())


def present():
    code = {path.relative_to(HEADERS).as_posix(): without_comments(path.read_text(encoding="utf-8"))
            for path in sorted(HEADERS.rglob("*.hpp"))}
    number = re.search(r"interface_version=(\d+);", code["plugin.hpp"]).group(1)
    digest = hashlib.sha256(json.dumps(code, sort_keys=True).encode()).hexdigest()
    return {"interface_version": int(number), "headers": digest}


def test_headers_change_only_with_the_number_of_the_interface():
    stored, now = json.loads(STORED.read_text()), present()
    assert now == stored, (
        "the headers in framework/api/kerf differ from the stored ones; if plugins have to be changed or compiled "
        "again, raise interface_version in plugin.hpp and list the change in CHANGELOG.md; then run "
        "python3 tests/python/test_interface_number.py --renew")


def test_comments_and_white_space_do_not_count():
    assert without_comments('int a; // one\n/* two */ const char* b = "// text";') == 'inta;constchar*b="//text";'


if __name__ == "__main__":
    if sys.argv[1:] != ["--renew"]:
        sys.exit("usage: test_interface_number.py --renew")
    STORED.write_text(json.dumps(present(), indent=1) + "\n")
