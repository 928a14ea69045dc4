"""Draws predictions: speed-up, efficiency and its factors over ranks, and what the time of a cycle goes into."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from charts import plain, style
from matplotlib.figure import Figure

FACTORS = {"efficiency": ("black", "-"), "load_balance": ("#2b6cb0", "-"), "serialisation_efficiency": ("#c05621", "-"),
           "transfer_efficiency": ("#2f855a", "-"), "parallel_efficiency": ("#805ad5", "--"),
           "computation_scaling": ("#718096", "--")}
COLOURS = ("#2b6cb0", "#c05621", "#805ad5", "#2f855a", "#b7791f", "#718096", "#c53030", "#319795")


def series_of(rows: list[dict]) -> dict[str, list[dict]]:
    """The rows of each curve, by its name. What all curves have in common is left out of the names."""
    keys = [k for k in ("network", "partitioner", "policy") if len({row[k] for row in rows}) > 1] or ["network"]
    series: dict[str, list[dict]] = {}
    for row in rows:
        series.setdefault(", ".join(str(row[k]) for k in keys), []).append(row)
    return series


def rank_axis(axes, ranks: list[int]) -> None:
    axes.set_xscale("log", base=2)
    axes.set_xticks(ranks, [str(r) for r in ranks], minor=False)
    axes.set_xlabel("ranks")


def all_ranks(rows: list[dict]) -> list[int]:
    return sorted({row["ranks"] for row in rows})


def plot_speed_up(rows: list[dict], path: Path) -> None:
    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    axes = figure.subplots()
    ranks = all_ranks(rows)
    axes.plot(ranks, ranks, color="#a0aec0", linestyle=":", label="ideal")
    for colour, (name, curve) in zip(np.resize(COLOURS, len(series_of(rows))), series_of(rows).items()):
        axes.plot([r["ranks"] for r in curve], [r["speed_up"] for r in curve], color=colour, marker="o", markersize=4,
                  label=plain(name))
    axes.set_yscale("log", base=2)
    rank_axis(axes, ranks)
    style(axes, "speed-up over one rank")
    axes.legend(frameon=False)
    figure.suptitle("Predicted speed-up")
    figure.savefig(path, dpi=140)


def plot_factors(name: str, curve: list[dict], path: Path) -> None:
    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    axes = figure.subplots()
    for factor, (colour, line) in FACTORS.items():
        if all(row[factor] is not None for row in curve):
            axes.plot([r["ranks"] for r in curve], [r[factor] for r in curve], color=colour, linestyle=line, marker="o",
                      markersize=4, label=factor.replace("_", " "))
    rank_axis(axes, all_ranks(curve))
    axes.set_ylim(0.0, 1.05)
    style(axes, "efficiency")
    axes.legend(frameon=False, ncols=2, loc="lower left")
    figure.suptitle(f"Predicted efficiency and its factors\n{plain(name)}")
    figure.savefig(path, dpi=140)


def plot_phases(name: str, curve: list[dict], path: Path) -> None:
    """The mean over ranks of what each phase takes, messages and waiting among it."""
    phases = [key for key in curve[0] if key.startswith("seconds_") and key != "seconds_per_cycle"]
    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    axes = figure.subplots()
    places, below = np.arange(len(curve)), np.zeros(len(curve))
    for colour, phase in zip(np.resize(COLOURS, len(phases)), phases):
        share = np.array([row.get(phase, 0.0) / row["seconds_per_cycle"] for row in curve])
        axes.bar(places, share, bottom=below, color=colour, label=phase.removeprefix("seconds_").replace("_", " "))
        below += share
    for place, top, row in zip(places, below, curve):
        axes.text(place, top + 0.01, f"{1e3 * row['seconds_per_cycle']:.3g} ms", ha="center", fontsize=8)
    axes.set_xticks(places, [str(row["ranks"]) for row in curve])
    axes.set_xlabel("ranks")
    style(axes, "share of the time of a cycle")
    axes.legend(frameon=False, ncols=4, loc="upper center", bbox_to_anchor=(0.5, -0.1))
    figure.suptitle(f"Predicted time per cycle by phase\n{plain(name)}")
    figure.savefig(path, dpi=140)


def plot_all(rows: list[dict], folder: Path) -> list[Path]:
    """Writes the pictures; returns their paths."""
    paths = [folder / "predict_speed_up.png"]
    plot_speed_up(rows, paths[0])
    curves = series_of(rows)
    for name, curve in curves.items():
        suffix = f"_{re.sub('[^0-9a-z]+', '_', name.lower()).strip('_')}" if len(curves) > 1 else ""
        for kind, draw in (("efficiency", plot_factors), ("phases", plot_phases)):
            paths.append(folder / f"predict_{kind}{suffix}.png")
            draw(name, curve, paths[-1])
    return paths
