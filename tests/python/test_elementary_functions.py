"""Whatever enters the state is computed with the functions of kerf/functions.hpp, and without fused operations."""

import json
import os
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# Their bits depend on the C library, its release and the processor. sqrt, fabs, rint, fma, ldexp and the like are exact
# or rounded correctly everywhere.
NAMES = ("exp|exp2|expm1|log|log2|log10|log1p|pow|sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|asinh|acosh|atanh|"
         "cbrt|hypot|erf|erfc|tgamma|lgamma")
LIBRARY_CALL = re.compile(rf"(?:std::|__builtin_|(?<![\w:.>]))(?:{NAMES})[fl]?\s*\(")
OURS = {"framework/api/kerf/functions.hpp"}


def sources():
    for room in ("framework", "physics", "partitioners", "tests/plugin/out_of_tree"):
        for path in sorted((ROOT / room).rglob("*.?pp")):
            if str(path.relative_to(ROOT)) not in OURS:
                yield path


def calls_in(text):
    """Line numbers and text of calls of the C library's functions; comments and texts do not count."""
    for number, line in enumerate(text.splitlines(), 1):
        code = re.sub(r'"(?:\\.|[^"\\])*"', '""', line).split("//")[0]
        if LIBRARY_CALL.search(code):
            yield number, line.strip()


def test_no_function_of_the_c_library_enters_the_state():
    found = [f"{path.relative_to(ROOT)}:{number}: {line}"
             for path in sources() for number, line in calls_in(path.read_text())]
    assert found == [], "use kerf::exp and so on, of kerf/functions.hpp"


@pytest.mark.parametrize("line", ["y = std::exp(x);", "y = pow(x, 2.0);", "y = 2*cosf(x);", "__builtin_log (x)"])
def test_calls_are_found(line):
    assert list(calls_in(line))


@pytest.mark.parametrize("line", ["y = kerf::exp(x);", "// log(x)", "std::sqrt(x)", 'say("pow(x)");', "in.log(x)",
                                  "max_exp(x)"])
def test_other_calls_are_left_alone(line):
    assert not list(calls_in(line))


def test_everything_is_compiled_without_fused_operations():
    build = Path(os.environ.get("KERF_BUILD_DIR", ROOT / "build"))
    commands = json.loads((build / "compile_commands.json").read_text())
    ours = [c for c in commands if Path(c["file"]).is_relative_to(ROOT / "framework")
            or Path(c["file"]).is_relative_to(ROOT / "physics")]
    assert len(ours) > 30
    assert [c["file"] for c in ours if "-ffp-contract=off" not in c["command"]] == []
    assert "-ffp-contract=off" in (build / "KerfConfig.cmake").read_text()
