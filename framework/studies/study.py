"""The file STUDY.yaml: what varies, which results are wanted, which plots and fits. All mistakes are gathered."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

from marked_yaml import Block, Complaints, StudyError, is_map, is_scalar, read_marked, text_of
from model_input import ModelInput, PathError, split_path
from plot_keys import Plot, PlotReader
from quantities import Value, scaled, with_unit
from spaces import Parameter, Spaces

NAME = re.compile(r"[A-Za-z_]\w*")
TAKES = ("last", "max", "min")
RESERVED = ("point", "trust", "flags", "exit", "exit_code", "state_hash", "warnings", "message")


@dataclass
class Result:
    """A number of a finished run: at a path of summary.json, or taken from a column of history.csv or history.h5."""

    name: str
    node: object
    path: str = ""
    column: str = ""
    observer: str = ""
    take: str = "last"
    factor: float = 1.0


@dataclass
class Limits:
    """Beyond these a completed run is not trusted."""

    balance_error: float = 0.01
    hourglass_share: float = 0.1
    let_go_mass: float = 0.001  # share of the mass at the start


@dataclass
class Point:
    """One run: the values of the parameters, and the settings of the input that they make."""

    values: dict[str, Value]
    settings: dict[str, str]


@dataclass
class Study:
    file: Path
    title: str = ""
    input: ModelInput | None = None
    output: str = ""
    ranks: int = 1
    plugins: list[str] = field(default_factory=list)
    fixed: dict[str, str] = field(default_factory=dict)
    parameters: dict[str, Parameter] = field(default_factory=dict)
    points: list[Point] = field(default_factory=list)
    has_points: bool = False
    results: dict[str, Result] = field(default_factory=dict)
    limits: Limits = field(default_factory=Limits)
    plots: list[Plot] = field(default_factory=list)
    slurm_template: Path | None = None
    slurm_launch: str = "srun --ntasks=@RANKS@"

    def settings_of(self, values: dict[str, Value]) -> dict[str, str]:
        """The settings of one point, by path. Throws PathError."""
        settings = dict(self.fixed)
        writers: dict[str, str] = {}  # by what is written, a key or one component of a vector: the parameter
        for name, value in values.items():
            parameter = self.parameters[name]
            if parameter.is_refinement:
                written = refine(self.input, parameter, value.number, settings)
            else:
                written = [put(self.input, parameter, path, value, settings) for path in parameter.paths]
            for place in written:
                # The same place, the whole vector of a component, or a component of the vector.
                others = {writer for key, writer in writers.items() if writer != name and (
                    key in (place, place.partition("[")[0]) or key.startswith(f"{place}["))}
                if others:
                    raise PathError(f"{place} is set by {min(others)} and by {name}; expected each value to be set "
                                    "once")
                writers[place] = name
        refuse_overlaps(settings)
        return settings


def refuse_overlaps(settings: dict[str, str]) -> None:
    """Throws PathError where one setting is inside of another: which of the two counts would depend on their order."""
    for inner in settings:
        steps = inner.split(".")
        for n in range(1, len(steps)):
            if ".".join(steps[:n]) in settings:
                raise PathError(f"{inner} and {'.'.join(steps[:n])} are both set, and one is inside of the other; "
                                "expected each value to be set once")


def put(model: ModelInput, parameter: Parameter, path: str, value: Value, settings: dict[str, str]) -> str:
    """Sets the value at a path; returns the key that is set, with the place where that is one of a list."""
    steps = split_path(path)
    text = value.text
    if parameter.factor != 1.0:
        text = with_unit(value.number * parameter.factor, value.unit).text
    _, rest = model.find(steps, parameter.new_key)
    if rest:
        key, text = model.component_set(steps, settings, text)
        settings[key] = text
        return f"{key}[{'.'.join(map(str, rest))}]"
    settings[".".join(steps)] = text
    return ".".join(steps)


def refine(model: ModelInput, parameter: Parameter, factor: float, settings: dict[str, str]) -> list[str]:
    """Multiplies numbers of cells by a factor, and divides sizes of cells by it. A named value ($h) that several places
    use is scaled once. Returns the keys that are set."""
    done = set()
    for path, power, whole in [*((p, factor, True) for p in parameter.counts),
                               *((p, 1.0 / factor, False) for p in parameter.sizes)]:
        key, text = model.text_at(split_path(path), settings)
        if key in done:
            continue
        done.add(key)
        made = scaled(text, power, whole, single=key.startswith("parameters."))
        if made is None:
            wanted = "whole numbers of cells" if whole else "a size of cells"
            raise PathError(f"{path} is {text}, and {factor:g} times as fine it is no longer {wanted}; expected "
                            f"{wanted} at every factor")
        settings[key] = made
    return sorted(done)


class StudyReader:
    def __init__(self, file: Path):
        self.complaints = Complaints(file)
        self.study = Study(file)
        self.block = Block(read_marked(file, self.complaints), "the study", self.complaints)

    def read(self) -> Study:
        study, block = self.study, self.block
        study.title = block.text("title", "one line")
        self._input()
        study.output = block.text("output", "a folder, relative to this file")
        study.ranks = block.whole("ranks", "a number of MPI ranks, from 1 on", 1)
        study.plugins = [self._beside(text) for text in block.texts("plugins", "paths of plugin libraries")]
        self._fixed()
        self._parameters()
        self._points()
        self._results()
        self._limits()
        study.plots = PlotReader(study.parameters, study.results, self.complaints).read(block.take("plots"))
        self._slurm()
        block.finish()
        self.complaints.raise_if_any()
        self._settings()
        self.complaints.raise_if_any()
        return study

    def _beside(self, text: str) -> str:
        """A path relative to the study's file. A bare name is left for Kerf to look up."""
        return str((self.study.file.parent / text).resolve()) if "/" in text else text

    def _input(self) -> None:
        name = self.block.text("input", "the path of a Kerf input, relative to this file", required=True)
        if not name:
            return
        try:
            self.study.input = ModelInput((self.study.file.parent / name).resolve())
        except StudyError as error:
            self.complaints.add(self.block.entries["input"][1], f"the input `{name}` cannot be used; expected a Kerf "
                                "input, with a path relative to this file; " + "; ".join(error.lines))

    def _fixed(self) -> None:
        node = self.block.take("set")
        if node is None:
            return
        for key, value in Block(node, "`set`", self.complaints).rest():
            try:
                steps = split_path(key.value)
                rest = self.study.input.find(steps, new_key=True)[1] if self.study.input else []
                path, text = (self.study.input.component_set(steps, self.study.fixed, text_of(value)) if rest
                              else (".".join(steps), text_of(value)))
                self.study.fixed[path] = text
            except PathError as error:
                self.complaints.add(key, str(error))

    def _parameters(self) -> None:
        node = self.block.take("parameters")
        if node is None:
            return
        for key, value in Block(node, "`parameters`", self.complaints).rest():
            if not NAME.fullmatch(key.value) or key.value in RESERVED:
                self.complaints.add(key, f"`{key.value}` cannot be the name of a parameter; expected letters, digits "
                                    "and underscores, and no name that the table has already")
                continue
            self.study.parameters[key.value] = self._parameter(key, value)

    def _parameter(self, key, node) -> Parameter:
        parameter = Parameter(key.value, node)
        if is_scalar(node):
            parameter.paths = [node.value]
        else:
            block = Block(node, f"the parameter `{key.value}`", self.complaints)
            parameter.paths = block.texts("path", "a path in the input, or a list of paths", required=True)
            parameter.factor = block.number("factor", "a number that the values are multiplied by", 1.0)
            parameter.unit = block.text("unit", "the unit of the values")
            parameter.fixed_unit = bool(parameter.unit)
            parameter.new_key = block.flag("new_key")
            block.finish()
        for path in parameter.paths:
            try:
                if self.study.input:
                    self.study.input.find(split_path(path), parameter.new_key)
            except PathError as error:
                self.complaints.add(node, str(error))
        return parameter

    def _points(self) -> None:
        node = self.block.take("points")
        if node is None:
            return
        self.study.has_points = True
        spaces = Spaces(self.study.parameters, self.complaints)
        values = spaces.read(node)
        for parameter in self.study.parameters.values():
            if parameter.is_refinement and self.study.input:
                self._complete_refinement(parameter)
        self.study.points = [Point(v, {}) for v in values]

    def _complete_refinement(self, parameter: Parameter) -> None:
        if not parameter.counts and not parameter.sizes:
            parameter.counts, parameter.sizes = cells_of_meshes(self.study.input)
        if not parameter.counts and not parameter.sizes:
            self.complaints.add(parameter.node, "the input has no numbers or sizes of cells in its meshes; expected "
                                "`counts` or `sizes`, with their paths")
        for path in [*parameter.counts, *parameter.sizes]:
            try:
                self.study.input.find(split_path(path))
            except PathError as error:
                self.complaints.add(parameter.node, str(error))

    def _settings(self) -> None:
        """The settings of all points, and that no two points are the same."""
        seen = set()
        for point in self.study.points:
            try:
                point.settings = self.study.settings_of(point.values)
            except PathError as error:
                self.complaints.add(self.block.entries["points"][1], str(error))
                continue
            same = tuple(sorted(point.settings.items()))
            if same in seen:
                shown = ", ".join(f"{name} = {value.text}" for name, value in point.values.items())
                self.complaints.add(self.block.entries["points"][1], f"the point {shown} is there twice; expected it "
                                    "once")
            seen.add(same)

    def _results(self) -> None:
        node = self.block.take("results", "a map of names and paths in summary.json, for example measures.hole")
        if node is None:
            return
        for key, value in Block(node, "`results`", self.complaints).rest():
            if not NAME.fullmatch(key.value) or key.value in RESERVED or key.value in self.study.parameters:
                self.complaints.add(key, f"`{key.value}` cannot be the name of a result; expected letters, digits and "
                                    "underscores, and no name that the table has already")
                continue
            self.study.results[key.value] = self._result(key, value)
        if is_map(node) and not node.value:
            self.complaints.add(node, "`results` is empty; expected one result or more")

    def _result(self, key, node) -> Result:
        result = Result(key.value, node)
        if is_scalar(node):
            result.path = node.value
        else:
            block = Block(node, f"the result `{key.value}`", self.complaints)
            result.path = block.text("path", "a path in summary.json")
            result.column = block.text("history", "a column of history.csv")
            gauge = block.text("observer", "an observer and its column in history.h5, NAME.COLUMN")
            result.take = block.choice("take", TAKES, "last")
            result.factor = block.number("factor", "a number that the result is multiplied by", 1.0)
            block.finish()
            if is_map(node) and sum(map(bool, (result.path, result.column, gauge))) != 1:
                self.complaints.add(node, f"the result `{key.value}` has none or several of `path`, `history` and "
                                    "`observer`; expected one of them")
            if result.path and "take" in block.entries:
                self.complaints.add(block.entries["take"][0], "`take` needs a column; expected `history` or `observer` "
                                    "beside it")
            if gauge:
                result.observer, _, result.column = gauge.partition(".")
                if not result.column:
                    self.complaints.add(node, f"`observer` is `{gauge}`; expected NAME.COLUMN")
        return result

    def _limits(self) -> None:
        node = self.block.take("limits")
        if node is None:
            return
        block = Block(node, "`limits`", self.complaints)
        limits = self.study.limits
        for name in ("balance_error", "hourglass_share", "let_go_mass"):
            setattr(limits, name, block.number(name, "a share, from 0 on", getattr(limits, name), 0.0))
        block.finish()

    def _slurm(self) -> None:
        node = self.block.take("slurm")
        if node is None:
            return
        block = Block(node, "`slurm`", self.complaints)
        template = block.text("template", "a file, relative to this one")
        if template:
            self.study.slurm_template = (self.study.file.parent / template).resolve()
            if not self.study.slurm_template.is_file():
                self.complaints.add(block.entries["template"][1], f"there is no file {self.study.slurm_template}; "
                                    "expected a job script with @RUN@ in it")
        self.study.slurm_launch = block.text("launch", "a command that starts the ranks, with @RANKS@ for their number",
                                             default=self.study.slurm_launch)
        block.finish()


def cells_of_meshes(model: ModelInput) -> tuple[list[str], list[str]]:
    """Paths of all numbers of cells, and of all sizes of cells, in the meshes of an input."""
    counts, sizes = [], []
    parts = model.find(["parts"], new_key=True)[0]
    for key, part in parts.value if is_map(parts) else []:
        for name, mesh in part.value if is_map(part) else []:
            for inner, value in mesh.value if name.value == "mesh" and is_map(mesh) else []:
                path = f"parts.{key.value}.mesh.{inner.value}"
                if inner.value == "cells" or inner.value.endswith("_cells"):
                    counts.append(path)
                elif inner.value == "cell_size":
                    sizes.append(path)
                elif inner.value.startswith("refine_") and is_map(value):
                    sizes += [f"{path}.size" for k, _ in value.value if k.value == "size"]
    return counts, sizes


def read_study(file: Path) -> Study:
    """Throws StudyError with all mistakes."""
    return StudyReader(file).read()
