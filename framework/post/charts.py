"""Charts over time: energies, balance, erosion and imbalance from history.csv, and the columns of history.h5."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

ENERGIES = {
    "kinetic": "#2b6cb0", "internal": "#c05621", "hourglass": "#805ad5", "bulk_viscosity": "#2f855a",
    "contact": "#b7791f", "external": "#718096", "eroded": "#c53030",
}
SHARES = ("friction",)  # energies that another column contains
MORE_COLOURS = ("#319795", "#d53f8c", "#975a16", "#4a5568")  # of energies that have no colour of their own
MOST_CURVES = 12  # of one unit, that a chart can show


def plain(text: str) -> str:
    """Text of a user as it stands, not as a formula between dollar signs."""
    return text.replace("$", r"\$")


def engineering(values: np.ndarray) -> tuple[float, str]:
    """The factor and prefix that bring the largest value to a readable number: 1.2e6 -> (1e-6, 'M')."""
    largest = float(np.nanmax(np.abs(values))) if np.size(values) else 0.0
    for factor, prefix in ((1.0e9, "G"), (1.0e6, "M"), (1.0e3, "k"), (1.0, ""), (1.0e-3, "m"), (1.0e-6, "µ")):
        if largest >= factor:
            return 1.0 / factor, prefix
    return 1.0, ""


def style(axes, label: str) -> None:
    axes.set_ylabel(label)
    axes.grid(True, color="#e2e8f0", linewidth=0.8)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def plot_energies(history: dict[str, np.ndarray], names: list[str], title: str, path: Path) -> None:
    """The named energies over time, their sum, and below it the balance error."""
    time = history["time"] * 1.0e6
    present = {name: history[name] for name in names if name in history and name not in SHARES}
    more = [name for name in present if name not in ENERGIES]
    colours = ENERGIES | {name: MORE_COLOURS[i % len(MORE_COLOURS)] for i, name in enumerate(more)}
    factor, prefix = engineering(np.concatenate(list(present.values())))
    figure = Figure(figsize=(9.0, 6.5), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1])
    for name, values in present.items():
        if np.any(values != 0.0):
            above.plot(time, values * factor, color=colours[name], label=name.replace("_", " "), linewidth=1.8)
    total = sum(values for name, values in present.items() if name != "external")
    above.plot(time, total * factor, color="black", linestyle="--", linewidth=1.2, label="sum")
    style(above, f"energy [{prefix}J]")
    above.legend(frameon=False, ncols=2)
    if "balance_error" in history:
        below.plot(time, 100.0 * history["balance_error"], color="#1a202c", linewidth=1.4)
    below.axhline(0.0, color="#a0aec0", linewidth=0.8)
    style(below, "balance error [%]")
    below.set_xlabel("time [µs]")
    figure.suptitle(title)
    figure.savefig(path, dpi=140)


def plot_progress(history: dict[str, np.ndarray], title: str, path: Path) -> None:
    """How many elements have eroded, how evenly the ranks share the work, and the time step."""
    time = history["time"] * 1.0e6
    figure = Figure(figsize=(9.0, 6.5), layout="constrained")
    eroded, imbalance, step = figure.subplots(3, 1, sharex=True)
    if "eroded_count" in history:
        eroded.step(time, history["eroded_count"], where="post", color="#c53030", linewidth=1.8)
    style(eroded, "eroded elements")
    if "imbalance" in history:
        imbalance.plot(time, history["imbalance"], color="#2b6cb0", linewidth=1.8)
        imbalance.axhline(1.0, color="#a0aec0", linewidth=0.8)
    style(imbalance, "imbalance (max / mean)")
    if "dt" in history:
        step.plot(time, history["dt"] * 1.0e9, color="#2f855a", linewidth=1.8)
    style(step, "time step [ns]")
    step.set_xlabel("time [µs]")
    figure.suptitle(title)
    figure.savefig(path, dpi=140)


def plot_observer(columns: dict[str, np.ndarray], units: dict[str, str], title: str, path: Path) -> list[str]:
    """The columns of one observer over time, those of one unit in one chart. Returns the columns that are left out,
    because there are too many for a chart or because they have no value at all."""
    time = columns["time"] * 1.0e6
    by_unit: dict[str, list[str]] = {}
    left_out = []
    for name, values in columns.items():
        if name == "time" or name == "id":
            continue
        unit = units.get(name, "-")
        if np.any(np.isfinite(values)) and len(by_unit.get(unit, [])) < MOST_CURVES:
            by_unit.setdefault(unit, []).append(name)
        else:
            left_out.append(name)
    if not by_unit:
        return left_out
    figure = Figure(figsize=(9.0, 1.0 + 2.7 * len(by_unit)), layout="constrained")
    charts = np.atleast_1d(figure.subplots(len(by_unit), 1, sharex=True))
    for axes, (unit, names) in zip(charts, by_unit.items()):
        finite = np.concatenate([columns[name][np.isfinite(columns[name])] for name in names])
        scaled = unit not in ("-", "")
        factor, prefix = engineering(finite) if scaled and not unit.startswith("kg") else (1.0, "")
        for name in names:
            axes.plot(time, columns[name] * factor, label=plain(name), linewidth=1.4)
        style(axes, f"[{prefix}{unit}]")
        axes.legend(frameon=False, fontsize="small", ncols=2)
    charts[-1].set_xlabel("time [µs]")
    figure.suptitle(title)
    figure.savefig(path, dpi=140)
    return left_out
