"""The points of a study: lists of values, grids, Latin hypercubes and refinements of meshes, and their product."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field

import numpy as np

from marked_yaml import Block, Complaints, is_list, is_map, is_scalar, kind_of, nearest, text_of
from quantities import Value, value_of, with_unit

KINDS = ("values", "grid", "latin_hypercube", "mesh")
MOST_POINTS = 100_000


@dataclass
class Parameter:
    """A name of the study, and what it sets in the input. With `counts` or `sizes` it refines meshes instead."""

    name: str
    node: object
    paths: list[str] = field(default_factory=list)
    factor: float = 1.0
    unit: str = ""
    new_key: bool = False
    counts: list[str] = field(default_factory=list)
    sizes: list[str] = field(default_factory=list)
    is_refinement: bool = False
    fixed_unit: bool = False  # whether `unit` is known already


@dataclass
class Range:
    low: float
    high: float
    logarithmic: bool
    whole: bool

    def at(self, share: float) -> float:
        """The number at a share of the way, 0 at the lower end and 1 at the upper, in 12 digits."""
        if self.whole:  # each whole number has the same share of the way
            return min(math.floor(self.low + share * (self.high - self.low + 1)), self.high)
        if self.logarithmic:
            number = math.exp(math.log(self.low) + share * (math.log(self.high) - math.log(self.low)))
        else:
            number = self.low + share * (self.high - self.low)
        return float(format(number, ".12g"))


class Spaces:
    """Reads the key `points` of a study."""

    def __init__(self, parameters: dict[str, Parameter], complaints: Complaints):
        self.parameters, self.complaints = parameters, complaints
        self._varied_in: dict[str, int] = {}

    def read(self, node) -> list[dict[str, Value]]:
        """All points. Several blocks in a list give their product: each point of one with each of the others."""
        blocks = node.value if is_list(node) else [node]
        if not blocks:
            self.complaints.add(node, "`points` is an empty list; expected one block or more")
        parts = [self._read_block(block, i) for i, block in enumerate(blocks)]
        if self.complaints or self._too_many(node, math.prod(len(part) for part in parts)):
            return []
        return [dict(pair for part in parts_of_one for pair in part.items())
                for parts_of_one in itertools.product(*parts)]

    def _read_block(self, node, number: int) -> list[dict[str, Value]]:
        block = Block(node, "`points`", self.complaints)
        if not is_map(node):
            return []
        kind = block.choice("type", KINDS)
        read = {"values": self._values, "grid": self._grid, "latin_hypercube": self._latin_hypercube,
                "mesh": self._mesh}.get(kind)
        points = read(block, number) if read else []
        if read:
            block.finish()
        return points

    def _too_many(self, node, count: int) -> bool:
        if count > MOST_POINTS:
            self.complaints.add(node, f"these are more than {MOST_POINTS} points; expected fewer")
        return count > MOST_POINTS

    # ---- kinds

    def _values(self, block: Block, number: int) -> list[dict[str, Value]]:
        node = block.take("values", "a list of maps, one for each point, of the parameters' names and values")
        if node is None:
            return []
        if not is_list(node) or not node.value:
            self.complaints.add(node, f"`values` is {kind_of(node)}; expected a list of maps, one for each point")
            return []
        points, first = [], None
        for item in node.value:
            one = Block(item, "a point", self.complaints)
            point = {key.value: self._value(value, self._parameter(key, number)) for key, value in one.rest()}
            first = point.keys() if first is None else first
            if is_map(item) and point.keys() != first:
                self.complaints.add(item, f"this point has {', '.join(point) or 'nothing'}, but the first one has "
                                    f"{', '.join(first)}; expected the same parameters at all points")
            points.append(point)
        return points

    def _grid(self, block: Block, number: int) -> list[dict[str, Value]]:
        node = block.take("axes", "a map of parameters' names and their values: a list, or a range")
        if node is None:
            return []
        axes = Block(node, "`axes`", self.complaints)
        lists = {}
        for key, value in axes.rest():
            parameter = self._parameter(key, number)
            if is_list(value) and value.value:
                lists[key.value] = [self._value(item, parameter) for item in value.value]
            elif is_map(value):
                lists[key.value] = self._spaced(value, parameter)
            else:
                self.complaints.add(value, f"`{key.value}` is {kind_of(value)}; expected a list of values, or a range: "
                                    "{from: 1 mm, to: 4 mm, count: 4}")
        if is_map(node) and not node.value:
            self.complaints.add(node, "`axes` is empty; expected one parameter or more")
        if self._too_many(node, math.prod(len(values) for values in lists.values())):
            return []
        return [dict(zip(lists, values)) for values in itertools.product(*lists.values())]

    def _latin_hypercube(self, block: Block, number: int) -> list[dict[str, Value]]:
        count = block.whole("n", "a number of points, from 1 on", required=True)
        seed = block.whole("seed", "a whole number, which makes the points the same every time", least=0, required=True)
        node = block.take("ranges", "a map of parameters' names and ranges, {from: 1 mm, to: 4 mm}")
        if node is None:
            return []
        names, ranges = [], []
        for key, value in Block(node, "`ranges`", self.complaints).rest():
            parameter = self._parameter(key, number)
            one = Block(value, f"the range of `{key.value}`", self.complaints)
            if is_map(value):
                names.append(key.value)
                ranges.append(self._range(one, parameter))
                one.finish()
        if is_map(node) and not node.value:
            self.complaints.add(node, "`ranges` is empty; expected one parameter or more")
        if self.complaints or count is None or seed is None or self._too_many(node, count):
            return []
        return [{name: with_unit(found.at(share), self.parameters[name].unit)
                 for name, found, share in zip(names, ranges, row)} for row in hypercube(len(names), count, seed)]

    def _mesh(self, block: Block, number: int) -> list[dict[str, Value]]:
        name = block.text("name", "a name for the refinement", default="refinement")
        node = block.take("factors", "a list of numbers, 1 for the mesh as it is and 2 for cells of half the size")
        parameter = Parameter(name, block.node, is_refinement=True, fixed_unit=True,
                              counts=block.texts("counts", "paths of numbers of cells"),
                              sizes=block.texts("sizes", "paths of sizes of cells"))
        if name in self.parameters:
            self.complaints.add(block.node, f"`{name}` is a parameter already; expected another `name`")
            return []
        self.parameters[name] = parameter
        self._varied_in[name] = number
        if node is None:
            return []
        if not is_list(node) or not node.value:
            self.complaints.add(node, f"`factors` is {kind_of(node)}; expected a list of numbers")
            return []
        numbers = [block.number_of(item, "factors", "numbers above zero", 1.0, 1e-6) for item in node.value]
        return [{name: with_unit(factor, "")} for factor in numbers]

    # ---- values

    def _parameter(self, key, number: int) -> Parameter | None:
        known = self.parameters.get(key.value) if is_scalar(key) else None
        if known is None or known.is_refinement:
            names = [name for name, p in self.parameters.items() if not p.is_refinement]
            self.complaints.add(key, f"`{getattr(key, 'value', '')}` is no parameter of this study; "
                                + nearest(str(key.value), names))
            return None
        if self._varied_in.setdefault(key.value, number) != number:
            self.complaints.add(key, f"`{key.value}` is varied by an earlier block already; expected it in one block")
        return known

    def _value(self, node, parameter: Parameter | None) -> Value:
        text = node.value if is_scalar(node) else text_of(node)
        if not text:
            self.complaints.add(node, "there is no value; expected a number, a number with a unit, or a text")
        value = value_of(text) if is_scalar(node) else Value(text)
        if parameter is None:
            return value
        if value.number is None:
            if parameter.factor != 1.0 or parameter.fixed_unit:
                self.complaints.add(node, f"`{text}` is no number; expected a number for `{parameter.name}`, which has "
                                    "a factor, a unit, or other values that are numbers")
            return Value(text_of(node))
        if not math.isfinite(value.number):
            self.complaints.add(node, f"`{text}` is beyond what a computer can hold; expected a smaller number")
            return value
        return self._in_unit(node, value, parameter)

    def _in_unit(self, node, value: Value, parameter: Parameter) -> Value:
        """One unit for all values of a parameter, so that tables and fits can compare them without converting."""
        if not parameter.fixed_unit:
            parameter.unit, parameter.fixed_unit = value.unit, True
        if not value.unit and parameter.unit:
            return Value(f"{value.text} {parameter.unit}", value.number, parameter.unit) \
                if child_unit_given(parameter) else self._wrong_unit(node, value, parameter)
        return value if value.unit == parameter.unit else self._wrong_unit(node, value, parameter)

    def _wrong_unit(self, node, value: Value, parameter: Parameter) -> Value:
        wanted = f"in {parameter.unit}" if parameter.unit else "without a unit"
        self.complaints.add(node, f"`{value.text}` has another unit than `{parameter.name}` has elsewhere in this "
                            f"study; expected a number {wanted}")
        return value

    def _end(self, block: Block, key: str, parameter: Parameter | None) -> float:
        node = block.take(key, "a number, maybe with a unit")
        if node is None:
            return math.nan
        value = self._value(node, parameter)
        if value.number is None:
            self.complaints.add(node, f"`{key}` is {kind_of(node)}; expected a number, maybe with a unit")
            return math.nan
        return value.number

    def _range(self, block: Block, parameter: Parameter | None) -> Range:
        before = len(self.complaints)
        found = Range(self._end(block, "from", parameter), self._end(block, "to", parameter),
                      block.choice("spacing", ("linear", "logarithmic"), "linear") == "logarithmic",
                      block.flag("whole"))
        if len(self.complaints) > before:  # its ends are not known
            return found
        if found.low >= found.high:
            self.complaints.add(block.node, f"the range goes from {found.low:g} to {found.high:g}; expected the lower "
                                "end first")
        if found.logarithmic and found.low <= 0.0:
            self.complaints.add(block.node, f"the range begins at {found.low:g}; expected more than zero for a "
                                "logarithmic spacing")
        if found.whole and not (float(found.low).is_integer() and float(found.high).is_integer()):
            self.complaints.add(block.node, "the ends of this range are not whole; expected whole numbers with "
                                "`whole: true`")
        if found.whole and found.logarithmic:
            self.complaints.add(block.node, "whole numbers cannot be spaced logarithmically here; expected `spacing: "
                                "linear`, or a list of values")
        return found

    def _spaced(self, node, parameter: Parameter | None) -> list[Value]:
        block = Block(node, "a range", self.complaints)
        found = self._range(block, parameter)
        count = block.whole("count", "a number of values, from 2 on", least=2, required=True)
        block.finish()
        if self.complaints or count is None or parameter is None or self._too_many(node, count):
            return []
        if found.whole:
            numbers = [round(x) for x in np.linspace(found.low, found.high, count)]
            if len(set(numbers)) < count:
                self.complaints.add(node, f"there are no {count} whole numbers from {found.low:g} to {found.high:g}; "
                                    "expected a smaller `count`")
        else:
            numbers = [found.at(i / (count - 1)) for i in range(count)]
        return [with_unit(float(number), parameter.unit) for number in numbers]


def child_unit_given(parameter: Parameter) -> bool:
    """Whether the study says `unit:` for a parameter; its bare numbers have that unit then."""
    return any(key.value == "unit" for key, _ in parameter.node.value) if is_map(parameter.node) else False


def hypercube(dimensions: int, count: int, seed: int) -> np.ndarray:
    """`count` points in the unit cube, one in each of `count` layers of every dimension (McKay, Beckman & Conover
    1979)."""
    from scipy.stats import qmc  # only studies of this kind wait for it

    return qmc.LatinHypercube(d=dimensions, rng=seed).random(count)
