"""The Kerf input that a study varies: what stands at a path in it, and which files it names.

A path is written with dots and positions from zero: parts.rod.velocity[0]. The input itself is never changed; a point
of a study is the input with values for `kerf run --set`.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

from marked_yaml import Complaints, child, is_list, is_map, is_scalar, keys_of, nearest, read_marked, text_of
from quantities import components, vector_text

PATH = re.compile(r"[A-Za-z_]\w*(?:\.\w+|\[\d+\])*")


class PathError(Exception):
    """Why a path leads nowhere, and what is expected."""


def split_path(path: str) -> list[str]:
    if not PATH.fullmatch(path):
        raise PathError(f"`{path}` is no path; expected names with dots between, and positions in brackets, for "
                        "example parts.rod.velocity[0]")
    return re.findall(r"\w+", path)


class ModelInput:
    """One input file, read once."""

    def __init__(self, file: Path):
        self.file = file
        self.root = read_marked(file, Complaints(file))

    def find(self, steps: list[str], new_key: bool = False):
        """(node, rest): the node at a path; `rest` is [index] where the path ends with a component of a text such as
        "0 0 -800 m/s". With `new_key`, the last key may be absent, and the node is None then."""
        node = self.root
        for i, step in enumerate(steps):
            here = ".".join(steps[:i]) or "the input"
            if is_list(node) and step.isdigit() and int(step) < len(node.value):
                node = node.value[int(step)]
            elif is_list(node):
                raise PathError(f"{here} is a list of {len(node.value)}, and has no [{step}]; expected a position from "
                                f"0 to {len(node.value) - 1}")
            elif is_map(node):
                found = child(node, step)
                if found is None and new_key and i == len(steps) - 1:
                    return None, []
                if found is None:
                    raise PathError(f"{self.file.name} has no `{'.'.join(steps[:i + 1])}`; "
                                    + nearest(step, keys_of(node)))
                node = found
            elif step.isdigit() and i == len(steps) - 1:
                return node, [step]
            else:
                raise PathError(f"{here} is a single value, and has no `{step}`; expected a path that ends there")
        return node, []

    def text_at(self, steps: list[str], settings: dict[str, str]) -> tuple[str, str]:
        """(path, text) of the value that counts at a path: as set before, or as in the input, with $NAME followed."""
        path = ".".join(steps)
        text = settings.get(path)
        if text is None:
            node, _ = self.find(steps)
            text = text_of(node)
        name = re.fullmatch(r"\$(\w+)", text)
        return self.text_at(["parameters", name.group(1)], settings) if name else (path, text)

    def component_set(self, steps: list[str], settings: dict[str, str], component: str) -> tuple[str, str]:
        """(path, text) with one component of a vector replaced. `steps` ends with the position."""
        path = ".".join(steps[:-1])
        _, text = self.text_at(steps[:-1], settings)
        single = steps[0] == "parameters"  # named values are no lists
        parts = components(text)
        if parts is None or int(steps[-1]) >= len(parts):
            raise PathError(f"{path} is {text}, and has no component [{steps[-1]}]; expected a vector of numbers")
        parts[int(steps[-1])] = component
        return path, vector_text(parts, single)

    def files(self, texts: list[str], plugins: list[str]) -> list[Path]:
        """All files that the input, or one of the texts, names: curves, meshes, plugins, and the user's own material
        library. Paths are relative to the input; names of plugins are looked for in KERF_PLUGIN_PATH, as Kerf does."""
        names = set(texts)
        pending, seen = [self.root], set()
        while pending:
            node = pending.pop()
            if id(node) in seen:  # an alias
                continue
            seen.add(id(node))
            if is_scalar(node):
                names.add(node.value)
            else:
                pending += [part for entry in node.value for part in (entry if isinstance(entry, tuple) else (entry,))]
        found = {(self.file.parent / name).resolve() for name in names if self._is_file(self.file.parent, name)}
        listed = child(self.root, "plugins")
        words = [item.value for item in listed.value] if listed is not None and is_list(listed) else []
        for folder in filter(None, os.environ.get("KERF_PLUGIN_PATH", "").split(":")):
            found |= {(Path(folder) / f"{word}{end}").resolve() for word in [*words, *plugins] for end in ("", ".so")
                      if self._is_file(Path(folder), f"{word}{end}")}
        found |= {Path(plugin).resolve() for plugin in plugins if self._is_file(Path(), plugin)}
        for folder in filter(None, os.environ.get("KERF_LIBRARY", "").split(":")):
            found |= {file.resolve() for file in Path(folder).rglob("*.yaml")}
        return sorted(found)

    @staticmethod
    def _is_file(folder: Path, name: str) -> bool:
        if not name or len(name) > 500 or "\n" in name or "\0" in name:
            return False
        try:
            return (folder / name).is_file()
        except OSError:
            return False
