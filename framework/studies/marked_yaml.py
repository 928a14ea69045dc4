"""Reads YAML so that every value knows its line and column, and gathers complaints about it.

Users meet the result as lines `file:line:column: error: what is wrong; what is expected`.
"""

from __future__ import annotations

import difflib
import json
import re
from pathlib import Path

import yaml

NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


class StudyError(Exception):
    """One or more mistakes of a user, each a complete line."""

    def __init__(self, *lines: str):
        super().__init__("\n".join(lines))
        self.lines = list(lines)


class Hindered(StudyError):
    """Nothing is wrong with the study, but it cannot be run now, or not here."""


class Complaints:
    """Mistakes in one file, in the order of the file when they are told."""

    def __init__(self, file: Path):
        self.file = file
        self._found: list[tuple[int, int, str]] = []

    def add(self, node, text: str) -> None:
        mark = node.start_mark
        self._found.append((mark.line + 1, mark.column + 1, text))

    def __len__(self) -> int:
        return len(self._found)

    def lines(self) -> list[str]:
        ordered = sorted(dict.fromkeys(self._found))
        return [f"{self.file}:{line}:{column}: error: {text}" for line, column, text in ordered]

    def raise_if_any(self) -> None:
        if self._found:
            raise StudyError(*self.lines())


def read_marked(file: Path, complaints: Complaints):
    """The root node of a YAML file. Throws StudyError where the file is missing or no YAML."""
    try:
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise StudyError(f"{file}: error: the file cannot be read: {error.strerror}; expected a YAML file") from error
    except UnicodeDecodeError as error:
        raise StudyError(f"{file}: error: byte {error.start} is no UTF-8; expected a text file in UTF-8") from error
    try:
        root = yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        raise StudyError(f"{file}:{mark.line + 1}:{mark.column + 1}: error: this is no YAML: {error.problem}; "
                         "look at the indentation, brackets and quotes before this place") from error
    except yaml.YAMLError as error:
        raise StudyError(f"{file}: error: this is no YAML: {error}; expected a text file") from error
    except RecursionError as error:
        raise StudyError(f"{file}: error: its values are nested too deep; expected a few levels") from error
    if root is None:
        raise StudyError(f"{file}: error: the file is empty; expected a map of keys and values")
    refuse_odd_nodes(root, complaints, set(), set())
    complaints.raise_if_any()
    return root


def refuse_odd_nodes(node, complaints: Complaints, above: set, seen: set) -> None:
    """Complains about tags, and about aliases that stand inside of what they refer to. Aliases are looked into once."""
    if id(node) in above:
        complaints.add(node, "an alias stands inside the value it refers to; aliases must come after it")
    if id(node) in above or id(node) in seen:
        return
    seen.add(id(node))
    if node.tag.startswith("!"):
        complaints.add(node, f"there is the tag {node.tag}; expected a value without a tag")
    if not is_scalar(node):
        for entry in node.value:
            for part in entry if isinstance(entry, tuple) else (entry,):
                refuse_odd_nodes(part, complaints, above | {id(node)}, seen)


def nearest(name: str, names) -> str:
    """"; did you mean ...?" where one of the names is near, or the list of all names."""
    names = [str(other) for other in names]
    close = difflib.get_close_matches(name, names, n=1, cutoff=0.6)
    if close:
        return f"did you mean `{close[0]}`?"
    return "expected one of " + ", ".join(f"`{other}`" for other in names) if names else "expected none here"


def is_map(node) -> bool:
    return isinstance(node, yaml.MappingNode)


def is_list(node) -> bool:
    return isinstance(node, yaml.SequenceNode)


def is_scalar(node) -> bool:
    return isinstance(node, yaml.ScalarNode)


def kind_of(node) -> str:
    if is_map(node):
        return "a map"
    if is_list(node):
        return "a list"
    return f'the text "{node.value}"' if node.value else "nothing"


def child(node, key: str):
    """The value of a key of a map, or None."""
    if is_map(node):
        for key_node, value in node.value:
            if key_node.value == key:
                return value
    return None


def keys_of(node) -> list[str]:
    return [key.value for key, _ in node.value] if is_map(node) else []


PLAIN = re.compile(r"[A-Za-z0-9_$.+\-/][^\n:#{}\[\],&*!|>'\"%@`]*")
LIST_WITH_UNIT = re.compile(r"\[[^\[\]\n:#{}'\"]*\]\s*[^\]\n:#{}'\"]+")


def quoted_where_needed(text: str, inside: bool) -> str:
    if PLAIN.fullmatch(text) or (not inside and LIST_WITH_UNIT.fullmatch(text)):
        return text
    return json.dumps(text, ensure_ascii=False)


def text_of(node, inside: bool = False) -> str:
    """A value in one line, as `kerf run --set KEY=VALUE` reads it."""
    if is_list(node):
        return "[" + ", ".join(text_of(item, True) for item in node.value) + "]"
    if is_map(node):
        return "{" + ", ".join(f"{key.value}: {text_of(value, True)}" for key, value in node.value) + "}"
    return quoted_where_needed(node.value, inside)


class Block:
    """The keys of one map. What was never taken is an unknown key, which `finish` complains about."""

    def __init__(self, node, what: str, complaints: Complaints):
        self.node, self.what, self.complaints = node, what, complaints
        self.entries, self._known = {}, []
        if not is_map(node):
            complaints.add(node, f"{what} is {kind_of(node)}; expected a map of keys and values")
            return
        for key, value in node.value:
            if not is_scalar(key):
                complaints.add(key, f"a key of {what} is {kind_of(key)}; expected a word")
            elif key.value in self.entries:
                complaints.add(key, f"the key `{key.value}` is given twice; expected it once")
            else:
                self.entries[key.value] = (key, value)

    def take(self, key: str, required: str = ""):
        """The value node of a key, or None. `required` says what is expected where the key must be there."""
        self._known.append(key)
        if key in self.entries:
            return self.entries[key][1]
        if required and is_map(self.node):
            self.complaints.add(self.node, f"the required key `{key}` of {self.what} is missing; expected {required}")
        return None

    def rest(self):
        """All entries, for maps whose keys are names that the user chooses."""
        return list(self.entries.values())

    def finish(self) -> None:
        for name, (key, _) in self.entries.items():
            if name not in self._known:
                self.complaints.add(key, f"unknown key `{name}` in {self.what}; {nearest(name, self._known)}")

    def text(self, key: str, expected: str, required: bool = False, default: str = "") -> str:
        node = self.take(key, expected if required else "")
        if node is None:
            return default
        if not is_scalar(node) or not node.value:
            self.complaints.add(node, f"`{key}` is {kind_of(node)}; expected {expected}")
            return default
        return node.value

    def texts(self, key: str, expected: str, required: bool = False) -> list[str]:
        """One text, or a list of texts."""
        node = self.take(key, expected if required else "")
        if node is None:
            return []
        items = node.value if is_list(node) else [node]
        for item in items:
            if not is_scalar(item) or not item.value:
                self.complaints.add(item, f"`{key}` holds {kind_of(item)}; expected {expected}")
        return [item.value for item in items if is_scalar(item) and item.value]

    def number(self, key: str, expected: str, default=None, least: float | None = None, required: bool = False):
        node = self.take(key, expected if required else "")
        return default if node is None else self.number_of(node, key, expected, default, least)

    def number_of(self, node, key: str, expected: str, default=None, least: float | None = None):
        if is_scalar(node) and NUMBER.fullmatch(node.value):
            value = float(node.value)
            if abs(value) < float("inf") and (least is None or value >= least):
                return value
        self.complaints.add(node, f"`{key}` is {kind_of(node)}; expected {expected}")
        return default

    def whole(self, key: str, expected: str, default=None, least: int = 1, required: bool = False):
        node = self.take(key, expected if required else "")
        if node is None:
            return default
        if is_scalar(node) and re.fullmatch(r"-?(0|[1-9]\d{0,15})", node.value) and int(node.value) >= least:
            return int(node.value)
        self.complaints.add(node, f"`{key}` is {kind_of(node)}; expected {expected}")
        return default

    def flag(self, key: str, default: bool = False) -> bool:
        node = self.take(key)
        if node is None:
            return default
        if is_scalar(node) and node.value in ("true", "false"):
            return node.value == "true"
        self.complaints.add(node, f"`{key}` is {kind_of(node)}; expected true or false")
        return default

    def choice(self, key: str, choices, default: str = "") -> str:
        node = self.take(key, "" if default else "one of " + ", ".join(choices))
        if node is None:
            return default
        if is_scalar(node) and node.value in choices:
            return node.value
        self.complaints.add(node, f"`{key}` is {kind_of(node)}; "
                            + nearest(node.value if is_scalar(node) else "", choices))
        return default
