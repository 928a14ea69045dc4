"""Reads the key `plots` of a study: pictures and fits that are drawn from its table."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from marked_yaml import Block, Complaints, is_map, is_scalar, kind_of, nearest

PLOT_TYPES = ("recht_ipson", "convergence", "scatter", "line")


@dataclass
class Plot:
    type: str
    name: str
    node: object
    options: dict = field(default_factory=dict)


class PlotReader:
    def __init__(self, parameters, results, complaints: Complaints):
        self.parameters, self.results, self.complaints = list(parameters), list(results), complaints

    def read(self, node) -> list[Plot]:
        plots: list[Plot] = []
        if node is None:
            return plots
        if not hasattr(node, "value") or is_scalar(node) or is_map(node):
            self.complaints.add(node, f"`plots` is {kind_of(node)}; expected a list")
            return plots
        used = set()
        for item in node.value:
            plot = self._plot(Block(item, "a plot", self.complaints))
            if plot.name in used:
                self.complaints.add(item, f"two plots are called `{plot.name}`; expected a `name` of its own for each")
            used.add(plot.name)
            plots.append(plot)
        return plots

    def _plot(self, block: Block) -> Plot:
        kind = block.choice("type", PLOT_TYPES) if is_map(block.node) else ""
        options = {}
        if kind == "recht_ipson":
            options = {"striking": self._column(block, "striking", True), "residual": self._column(block, "residual"),
                       "p": self._free_or_number(block, "p", 2.0), "a": self._free_or_number(block, "a", None),
                       "confidence": block.number("confidence", "a share below 1", 0.95, 0.01),
                       "measured": self._measured(block)}
            if not 0.0 < options["confidence"] < 1.0:
                self.complaints.add(block.node, "`confidence` is 1 or more; expected a share below 1")
        elif kind == "convergence":
            options = {"result": self._column(block, "result"), "size": self._column(block, "size", True),
                       "safety": block.number("safety", "a factor, 1 or more", 1.25, 1.0)}
        elif kind:
            options = {"x": self._column(block, "x"), "y": self._columns(block, "y"),
                       "x_scale": block.choice("x_scale", ("linear", "log"), "linear"),
                       "y_scale": block.choice("y_scale", ("linear", "log"), "linear")}
        if kind:
            options["by"] = self._column(block, "by", True, optional=True)
        default = "_".join(filter(None, [kind, options.get("result") or options.get("residual") or
                                         "_".join(options.get("y") or [])]))
        name = block.text("name", "a name for the picture's file", default=default)
        if name and not re.fullmatch(r"[\w.\-]+", name):
            self.complaints.add(block.node, f"`name` is `{name}`; expected letters, digits, underscores and dashes")
        if kind:
            block.finish()
        return Plot(kind, name, block.node, options)

    def _names(self, only_parameters: bool) -> list[str]:
        return [*self.parameters, *([] if only_parameters else self.results)]

    def _column(self, block: Block, key: str, only_parameter: bool = False, optional: bool = False) -> str:
        kind = "a parameter of this study" if only_parameter else "a parameter or result of this study"
        name = block.text(key, kind, required=not optional)
        if name and name not in self._names(only_parameter):
            self.complaints.add(block.entries[key][1], f"`{key}` is `{name}`, which is not {kind}; "
                                + nearest(name, self._names(only_parameter)))
        return name

    def _columns(self, block: Block, key: str) -> list[str]:
        names = block.texts(key, "a result of this study, or a list of them", required=True)
        for name in names:
            if name not in self._names(False):
                self.complaints.add(block.entries[key][1], f"`{name}` is no parameter or result of this study; "
                                    + nearest(name, self._names(False)))
        return names

    def _free_or_number(self, block: Block, key: str, default):
        """A number, or None for `free`."""
        node = block.take(key)
        if node is None or (is_scalar(node) and node.value == "free"):
            return default if node is None else None
        return block.number_of(node, key, "a number above zero, or `free`", default, 1e-6)

    def _measured(self, block: Block) -> list[tuple[float, float]]:
        node = block.take("measured")
        if node is None:
            return []
        pairs = []
        for item in node.value if not is_scalar(node) else []:
            numbers = [block.number_of(n, "measured", "numbers in m/s") for n in item.value] \
                if isinstance(item.value, list) and not is_map(item) else []
            if len(numbers) != 2:
                self.complaints.add(item, "a measured point is no pair; expected [striking speed, residual speed] in "
                                    "m/s")
            elif None not in numbers:
                pairs.append(tuple(numbers))
        if not pairs and not self.complaints:
            self.complaints.add(node, f"`measured` is {kind_of(node)}; expected a list of pairs [striking, residual]")
        return pairs
