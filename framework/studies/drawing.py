"""Draws the plots that a study declares, and writes the numbers of its fits into fits.json."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import numpy as np
from matplotlib.figure import Figure

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "post"))
from charts import plain, style

import fits
from gather import Row
from plot_keys import Plot
from point_folder import write_whole
from study import Study

COLOURS = ("#2b6cb0", "#c05621", "#2f855a", "#805ad5", "#c53030", "#b7791f", "#319795", "#d53f8c", "#4a5568")


class Group:
    """The rows of one curve: those that share a value of `by`. What cannot be trusted is left out and counted."""

    def __init__(self, label: str, rows: list[Row]):
        self.label, self.rows = label, rows

    def columns(self, *names: str) -> list[np.ndarray]:
        """Numbers of the rows that have all of them."""
        found = [[row.number(name) for name in names] for row in self.rows]
        kept = [values for values in found if None not in values]
        return [np.array([values[i] for values in kept], dtype=float) for i in range(len(names))]


def groups_of(rows: list[Row], by: str) -> list[Group]:
    labelled: dict[str, list[Row]] = {}
    for row in rows:
        label = f"{by} = {row.folder.point.values[by].text}" if by else ""
        labelled.setdefault(label, []).append(row)
    return [Group(label, inner) for label, inner in labelled.items()]


class Drawing:
    """All plots of one study. `fits` and `notes` tell what came of them; `refused` whether a fit has no answer."""

    def __init__(self, study: Study, rows: list[Row], output: Path):
        self.study, self.into, self.output = study, output / "plots", output
        self.rows = [row for row in rows if row.trust != "no"]
        self.left_out = len(rows) - len(self.rows)
        self.fits: list[dict] = []
        self.notes: list[str] = []
        self.refused = False

    def draw_all(self) -> None:
        for plot in self.study.plots:
            figure = Figure(figsize=(8.0, 5.5), layout="constrained")
            axes = figure.subplots()
            {"recht_ipson": self._recht_ipson, "convergence": self._convergence, "scatter": self._curves,
             "line": self._curves}[plot.type](plot, axes)
            if axes.has_data():
                self._save(plot, figure, axes)
        if self.study.plots:
            write_whole(self.output / "fits.json", json.dumps(
                {"points_left_out": self.left_out, "fits": self.fits}, indent=1, ensure_ascii=False) + "\n")
        if self.left_out and self.study.plots:
            self.notes.append(f"{self.left_out} point{'s' if self.left_out > 1 else ''} that cannot be trusted "
                              f"{'are' if self.left_out > 1 else 'is'} left out of plots and fits")

    def _save(self, plot: Plot, figure: Figure, axes) -> None:
        if axes.get_legend_handles_labels()[0]:
            axes.legend(frameon=False, fontsize="small")
        missing = f"  ·  {self.left_out} points left out" if self.left_out else ""
        figure.suptitle(plain((self.study.title or self.study.file.stem) + missing))
        self.into.mkdir(parents=True, exist_ok=True)
        figure.savefig(self.into / f"{plot.name}.png", dpi=140)

    def _label(self, name: str) -> str:
        parameter = self.study.parameters.get(name)
        unit = parameter.unit if parameter else ""
        return plain(f"{name} [{unit}]" if unit else name)

    def _tell(self, plot: Plot, group: Group, facts: dict, sentence: str) -> None:
        self.fits.append({"plot": plot.name, "type": plot.type, "group": group.label, **facts, "says": sentence})
        self.notes.append(f"{plot.name}{', ' + group.label if group.label else ''}: {sentence}")

    def _refuse(self, plot: Plot, group: Group, error: Exception) -> None:
        self.refused = True
        self._tell(plot, group, {"refused": True}, str(error))

    # ---- kinds

    def _recht_ipson(self, plot: Plot, axes) -> None:
        o = plot.options
        groups = groups_of(self.rows, o["by"]) or [Group("", [])]
        for group, colour in zip(groups, colours()):
            striking, residual = group.columns(o["striking"], o["residual"])
            # The sign of a component says the direction; the relation is one of speeds along the line of flight.
            self._one_limit(plot, group, np.abs(striking), residual, colour, axes)
        if o["measured"]:
            v, r = np.array(o["measured"]).T
            self._one_limit(plot, Group("measured", []), v, r, "#1a202c", axes)
        axes.set_xlabel("striking speed [m/s]")
        style(axes, "residual speed [m/s]")

    def _one_limit(self, plot: Plot, group: Group, striking, residual, colour, axes) -> None:
        o = plot.options
        if striking.size:
            axes.plot(striking, np.maximum(residual, 0.0), "s" if group.label == "measured" else "o", color=colour,
                      label=plain(group.label or "computed"))
        try:
            unit = self.study.parameters[o["striking"]].unit
            if unit not in ("m/s", ""):
                raise fits.Refused(f"the striking speeds are in {unit}; expected m/s, as the residual speeds are")
            found = fits.fit_ballistic_limit(striking, residual, o["p"], o["a"], o["confidence"])
        except fits.Refused as error:
            self._refuse(plot, group, error)
            return
        speeds = np.linspace(found.limit, max(float(striking.max()), found.limit), 300)
        axes.plot(speeds, found(speeds), color=colour, linewidth=1.4)
        axes.axvline(found.limit, color=colour, linewidth=0.8, linestyle=":")
        interval = found.intervals.get("limit")
        if interval:
            axes.axvspan(*interval, color=colour, alpha=0.12)
        self._tell(plot, group, asdict(found), limit_sentence(found))

    def _convergence(self, plot: Plot, axes) -> None:
        o = plot.options
        refinement = self.study.parameters[o["size"]].is_refinement
        for group, colour in zip(groups_of(self.rows, o["by"]) or [Group("", [])], colours()):
            sizes, values = group.columns(o["size"], o["result"])
            sizes = 1.0 / sizes if refinement else sizes
            axes.plot(sizes, values, "o-", color=colour, label=plain(group.label) or None)
            try:
                triplets = fits.convergence(sizes, values, o["safety"])
            except fits.Refused as error:
                self._refuse(plot, group, error)
                continue
            finest = triplets[0]
            if finest.extrapolated is not None:
                axes.plot([0.0], [finest.extrapolated], "x", color=colour,
                          label=f"order {finest.order:.3g}, extrapolated")
            self._tell(plot, group, {"triplets": [asdict(triplet) for triplet in triplets]}, finest.sentence()
                       + "".join(f"; the meshes before: {triplet.sentence()}" for triplet in triplets[1:]))
        axes.set_xlim(left=0.0)
        axes.set_xlabel("size of cells, 1 for the mesh of the input" if refinement else self._label(o["size"]))
        style(axes, self._label(o["result"]))

    def _curves(self, plot: Plot, axes) -> None:
        o = plot.options
        colour = colours()
        for group in groups_of(self.rows, o["by"]):
            for name in o["y"]:
                x, y = group.columns(o["x"], name)
                order = np.argsort(x, kind="stable")
                label = ", ".join(filter(None, [name if len(o["y"]) > 1 else "", group.label]))
                if x.size:
                    axes.plot(x[order], y[order], "o-" if plot.type == "line" else "o", color=next(colour),
                              label=plain(label) or None)
        if not axes.has_data():
            self.refused = True
            self.notes.append(f"{plot.name}: no point has numbers for {o['x']} and {', '.join(o['y'])}; nothing is "
                              "drawn")
        axes.set_xscale(o["x_scale"])
        axes.set_yscale(o["y_scale"])
        axes.set_xlabel(self._label(o["x"]))
        style(axes, ", ".join(self._label(name) for name in o["y"]))


def colours():
    """Colours without end, and without one that a reader takes for another before nine are used."""
    while True:
        yield from COLOURS


def limit_sentence(found: fits.BallisticLimit) -> str:
    def told(name: str, value: float, unit: str) -> str:
        interval = found.intervals.get(name)
        fixed = "" if name in found.intervals else " (fixed)"
        between = f" ({100 * found.confidence:g} % between {interval[0]:.4g} and {interval[1]:.4g})" if interval else ""
        return f"{value:.4g}{unit}{fixed}{between}"

    text = (f"ballistic limit {told('limit', found.limit, ' m/s')}, a = {told('a', found.a, '')}, "
            f"p = {told('p', found.p, '')}, from {found.n_perforating} perforating points, rms {found.rms:.3g} m/s")
    return text + "".join(f"; {note}" for note in found.notes)
