"""Reads the description of a network: LogGP parameters, each with its source."""

from __future__ import annotations

import difflib
import re
from dataclasses import fields
from pathlib import Path

import yaml

from loggp import Link, Network

FOLDER = Path(__file__).resolve().parent / "networks"
LINK_KEYS = tuple(f.name for f in fields(Link))
LINK_NEEDS = ("latency", "send_overhead", "receive_overhead", "overhead_per_byte")  # the others are 0 where not given
LONGEST = 0.1  # no message and no byte takes longer [s]; other units than seconds are seen by it
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
NUMBERS = ("node_gap", "node_gap_per_byte")
WHOLE_NUMBERS = ("ranks_per_node", "eager_limit", "envelope")
WORDS = ("name", "allreduce", "all_to_all")
KEYS = ("between", "inside", "notes", *NUMBERS, *WHOLE_NUMBERS, *WORDS)


class NetworkError(Exception):
    """Mistakes in a description, one line each."""


class _Reader:
    """Walks the nodes of one file and gathers what is wrong."""

    def __init__(self, path: Path):
        self.path, self.errors = path, []

    def wrong(self, node, text: str) -> None:
        mark = node.start_mark
        self.errors.append((mark.line + 1, mark.column + 1, text))

    def items(self, node, known: tuple[str, ...], what: str) -> dict[str, yaml.Node]:
        if not isinstance(node, yaml.MappingNode):
            self.wrong(node, f"{what} is no map; expected keys with values")
            return {}
        found: dict[str, yaml.Node] = {}
        for key, value in node.value:
            name = getattr(key, "value", "")
            if name not in known:
                near = difflib.get_close_matches(str(name), known, n=1)
                hint = f"did you mean `{near[0]}`?" if near else f"expected one of {', '.join(known)}"
                self.wrong(key, f"unknown key `{name}` in {what}; {hint}")
            elif name in found:
                self.wrong(key, f"the key `{name}` stands twice in {what}; expected it once")
            else:
                found[name] = value
        return found

    def number(self, node, key: str) -> float:
        """A number, or a map of its value and its source."""
        if isinstance(node, yaml.MappingNode):
            inner = self.items(node, ("value", "source"), f"`{key}`")
            if "value" not in inner:
                self.wrong(node, f"`{key}` has no value; expected `value` and `source`")
                return 0.0
            node = inner["value"]
        text = getattr(node, "value", "")
        value = float(text) if isinstance(text, str) and NUMBER.fullmatch(text) else float("nan")
        if not 0.0 <= value < float("inf"):
            self.wrong(node, f"`{key}` is `{getattr(node, 'value', '')}`; expected a finite number, at least 0")
            return 0.0
        return value

    def seconds(self, node, key: str) -> float:
        value = self.number(node, key)
        if value > LONGEST:
            self.wrong(node, f"`{key}` is {value:g} s; expected seconds, at most {LONGEST:g}")
        return value

    def word(self, node, key: str) -> str:
        if not isinstance(node, yaml.ScalarNode):
            self.wrong(node, f"`{key}` is no word; expected one")
            return ""
        return node.value

    def link(self, node, what: str) -> Link:
        found = self.items(node, LINK_KEYS, what)
        for key in LINK_NEEDS:
            if isinstance(node, yaml.MappingNode) and key not in found:
                self.wrong(node, f"{what} has no `{key}`; expected seconds")
        return Link(**{key: self.seconds(value, key) for key, value in found.items()})


def read_network(path: Path) -> Network:
    """The network of a file. Throws NetworkError with all that is wrong in it."""
    reader = _Reader(path)
    try:
        root = yaml.compose(path.read_text(encoding="utf-8"), Loader=yaml.SafeLoader)
    except OSError as error:
        raise NetworkError(f"{path}: error: the file cannot be read: {error.strerror}; expected a description of a "
                           "network") from error
    except UnicodeDecodeError as error:
        raise NetworkError(f"{path}: error: the file is no text in UTF-8; expected a description of a "
                           "network") from error
    except yaml.reader.ReaderError as error:
        raise NetworkError(f"{path}: error: {error.reason}, at character {error.position}; expected YAML") from error
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f"{path}:{mark.line + 1}:{mark.column + 1}"
        raise NetworkError(f"{place}: error: {error.problem}; expected YAML") from error
    if root is None:
        raise NetworkError(f"{path}: error: the file is empty; expected a description of a network")
    found = reader.items(root, KEYS, "the network")
    values: dict = {"name": path.stem}
    for key in ("between", "inside"):
        if key in found:
            values[key] = reader.link(found[key], f"`{key}`")
    if "between" not in found:
        reader.wrong(root, "the network has no key `between`; expected the parameters of messages between nodes")
        values["between"] = Link()
    for key in NUMBERS + WHOLE_NUMBERS:
        if key in found:
            number = reader.number(found[key], key) if key in WHOLE_NUMBERS else reader.seconds(found[key], key)
            if key in WHOLE_NUMBERS and number != int(number):
                reader.wrong(found[key], f"`{key}` is {number}; expected a whole number")
            values[key] = int(number) if key in WHOLE_NUMBERS else number
    for key in WORDS:
        if key in found:
            values[key] = reader.word(found[key], key)
    if values.get("ranks_per_node", 1) > 1 and "inside" not in found:
        reader.wrong(root, "a node has several ranks, but there is no key `inside`; expected the parameters of "
                     "messages inside a node")
    if reader.errors:
        raise NetworkError("\n".join(f"{path}:{line}:{column}: error: {text}"
                                     for line, column, text in sorted(reader.errors)))
    try:
        return Network(**values)
    except ValueError as error:
        raise NetworkError(f"{path}: error: {error}") from error


def find_network(name: str) -> Path:
    """A file, or one of those that come with Kerf."""
    path = Path(name)
    if path.suffix in (".yaml", ".yml") or path.exists():
        return path
    known = sorted(p.stem for p in FOLDER.glob("*.yaml"))
    if name not in known:
        near = difflib.get_close_matches(name, known, n=1)
        hint = f"did you mean `{near[0]}`? " if near else ""
        raise NetworkError(f"--network: error: there is no network `{name}`; {hint}expected a file or one of "
                           f"{', '.join(known)}")
    return FOLDER / f"{name}.yaml"
