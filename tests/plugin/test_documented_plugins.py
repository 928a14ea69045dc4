"""The examples in doc/plugin-authors are complete: each compiles as it stands and registers a type."""

import re

import pytest

from plugin_case import KERF, SOURCE, call, compile_library

PAGE = SOURCE / "doc" / "plugin-authors" / "writing_a_plugin.md"
EXAMPLES = re.findall(r"^```cpp\n(.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL)
NAMES = [re.search(r'^KERF_(\w+)\(\w+, "(\w+)"', example, re.MULTILINE).group(1, 2) for example in EXAMPLES]


def test_the_page_shows_examples_of_each_kind():
    kinds = [kind for kind, _ in NAMES]
    assert kinds == ["EOS", "MATERIAL", "MATERIAL", "EOS", "EOS", "SOLID", "EROSION", "CONTACT", "LOAD", "OBSERVER",
                     "OBSERVER"]


@pytest.mark.parametrize("number", range(len(EXAMPLES)), ids=[name for _, name in NAMES])
def test_example_compiles_without_warning_and_registers(number, tmp_path):
    kind, name = NAMES[number]
    source, library = tmp_path / f"{name}.cpp", tmp_path / f"{name}.so"
    source.write_text(EXAMPLES[number])
    compile_library(source, library, "-O1", "-Werror")
    done = call(KERF, "describe", kind.lower(), name, "--plugin", library)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"{name} ({kind.lower()}): ")
