"""Figures 3 to 5 of Ren & Wang (2005) with Kerf: subdomains, their two criteria, speed-up on 1 to 6 subdomains."""

from __future__ import annotations

import json
import re
from pathlib import Path

from matplotlib.figure import Figure
from study_tools import (ROOT, STUDIES, Case, equal_hashes, machine, median, most_lost, partition, predict, run,
                         save_small, scale, summary_of, table)

INPUT = ROOT / "inputs" / "oblique_rod_full" / "oblique_rod_full.yaml"
COARSE = ("parts.plate.mesh.cell_size=1.6 mm", "parts.rod.mesh.core_cells=2", "parts.rod.mesh.ring_cells=1",
          "parts.rod.mesh.axial_cells=48")
SMALL = ("parts.plate.mesh.cell_size=3.2 mm", *COARSE[1:3], "parts.rod.mesh.axial_cells=24", "time.end=8 us")
METHODS = ["block", "bisection", "zoltan_rcb", "zoltan_rib", "zoltan_hsfc", "zoltan_graph", "zoltan_hypergraph",
           "zoltan_scotch"]
DRAWN = ["zoltan_rcb", "zoltan_hypergraph"]
PAPER = 5.4  # speed-up on 6 subdomains, the mark that is set from the paper
MODELS = {"coarse": Case("coarse", INPUT, COARSE), "fine": Case("fine", INPUT), "small": Case("small", INPUT, SMALL)}


def make(runs: Path, pages: Path, quick: bool) -> dict[str, str]:
    """Writes the figures and returns the tables."""
    case = MODELS["small" if quick else "coarse"]
    parts = partition(case, runs, "partition", [2, 3, 6], METHODS)
    rows = json.loads((parts / "partitions.json").read_text())["partitions"]
    draw_subdomains(parts, rows, pages, DRAWN[:1] if quick else DRAWN)
    ranks = [1, 2] if quick else [1, 2, 3, 4, 5, 6]
    measured = measure(case, runs, 1 if quick else 3, quick)
    states = {n: run(case, runs, f"state_{n}", ranks=n) for n in ranks}
    hash_of_all = equal_hashes(states)
    predicted = {case.name: predictions(case, runs, "1 us" if not quick else "4 us")}
    if not quick:
        predicted["fine"] = predictions(MODELS["fine"], runs, "5 us")
    draw_speed_up(predicted, measured, pages)
    return {"criteria": criteria_table(rows), "measured": measured_table(measured),
            "speed_up": speed_up_table(predicted), "limits": limits_table(predicted),
            "states": table(["ranks", "elements left", "state hash"],
                            [[", ".join(map(str, ranks)), left(states[1]), f"`{hash_of_all}`"]])}


def left(folder: Path) -> str:
    parts = summary_of(folder)["parts"].values()
    return f"{sum(p['alive'] for p in parts)} of {sum(p['elements'] for p in parts)}"


def measure(case: Case, runs: Path, repeats: int, quick: bool) -> dict:
    settings = ["time.maximum_cycles=30"] if quick else []
    return json.loads((scale(case, runs, "scale", [1, 2], repeats, *settings) / "scale.json").read_text())


def predictions(case: Case, runs: Path, interval: str) -> list[dict]:
    recorded = run(case, runs, f"recorded_{case.name}", f"output.recording_interval={interval}")
    return predict(recorded, runs, f"predicted_{case.name}", "--ranks", "1,2,3,4,5,6", "--network", "shared_memory",
                   "--network", one_rank_per_node(runs))


def one_rank_per_node(folder: Path) -> Path:
    """HDR InfiniBand with every rank on a node of its own, as in a cluster of the time of the paper."""
    text = (STUDIES / "networks" / "hdr_infiniband.yaml").read_text()
    text = re.sub(r"(?m)^name: .*$", "name: HDR InfiniBand, 1 rank per node", text)
    text = re.sub(r"(?m)^ranks_per_node: .*$", "ranks_per_node: 1", text)
    path = folder / "hdr_one_rank_per_node.yaml"
    path.write_text(text)
    return path


def draw_subdomains(parts: Path, rows: list[dict], pages: Path, methods: list[str]) -> None:
    """Figures 3 and 4 of the paper: the meshes of 2 and of 3 subdomains."""
    import partition as drawing
    from results import Results

    drawing.scene.choose_window()
    results = Results(parts / "initial")
    for row in rows:
        if row["method"] in methods and row["parts"] in (2, 3):
            large = parts / f"{row['method']}_{row['parts']}.png"
            drawing.draw_parts(results, row, 0.5, "flat rod and plate at 45 degrees", large)
            save_small(large, pages / f"subdomains_{row['method']}_{row['parts']}.png")


def draw_speed_up(predicted: dict[str, list[dict]], measured: dict, pages: Path) -> None:
    """Figure 5 of the paper: speed-up over the number of subdomains."""
    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    axes = figure.subplots()
    axes.plot([1, 6], [1, 6], color="0.7", linewidth=1.0, label="ideal")
    axes.plot([6], [PAPER], "k*", markersize=11, label="mark from the paper")
    for model, rows in predicted.items():
        for network in dict.fromkeys(r["network"] for r in rows):
            line = sorted((r["ranks"], r["speed_up"]) for r in rows if r["network"] == network)
            axes.plot(*zip(*line), "o-" if model != "fine" else "s--", markersize=4,
                      label=f"predicted, {network}, {model}")
    line = [(row["ranks"], row["speed_up"]) for row in measured["ranks"]]
    axes.plot(*zip(*line), "rD", markersize=7, fillstyle="none", label="measured, coarse")
    axes.set_xlabel("subdomains")
    axes.set_ylabel("speed-up")
    axes.legend(frameon=False, fontsize=8)
    axes.grid(alpha=0.3)
    save_small(figure, pages / "classical_speed_up.png")


def criteria_table(rows: list[dict]) -> str:
    """Equal elements and fewest interface nodes."""
    counts = sorted({row["parts"] for row in rows})
    head = ["method", *(f"{what}, {n}" for n in counts for what in ("elements", "interface nodes"))]
    lines = []
    for method in METHODS:
        line = [f"`{method}`"]
        for n in counts:
            row = next(r for r in rows if r["method"] == method and r["parts"] == n)
            line += [float(row["element_balance"]), row["interface_nodes"]]
        lines.append(line)
    return table(head, lines)


def measured_table(measured: dict) -> str:
    lines = []
    for row in measured["ranks"]:
        seconds = [r["seconds"] for r in measured["runs"] if r["ranks"] == row["ranks"] and r["kind"] == "timed"]
        lines.append([row["ranks"], len(seconds), float(median(seconds)), float(row["speed_up"]),
                      float(row["efficiency"]), row.get("efficiency_side_by_side") or "-"])
    head = ["ranks", "runs", "seconds, median", "speed-up", "efficiency", "efficiency against serial runs side by side"]
    return table(head, lines) + f"\n\n{machine()}."


def speed_up_table(predicted: dict[str, list[dict]]) -> str:
    lines = []
    for model, rows in predicted.items():
        for network in dict.fromkeys(r["network"] for r in rows):
            some = sorted((r for r in rows if r["network"] == network), key=lambda r: r["ranks"])
            lines.append([model, network, *(float(r["speed_up"]) for r in some)])
    return table(["model", "network", "1", "2", "3", "4", "5", "6"], lines)


LIMITS = ("load_balance", "serialisation_efficiency", "transfer_efficiency", "computation_scaling")


def limits_table(predicted: dict[str, list[dict]]) -> str:
    """What is lost on six subdomains: factors, and shares of the time by cause."""
    lines = []
    for model, rows in predicted.items():
        for row in rows:
            if row["ranks"] == 6:
                lines.append([model, row["network"], *(row[key] for key in LIMITS), most_lost(row, 3)])
    return table(["model", "network", *(key.replace("_", " ") for key in LIMITS), "uneven work costs at most"], lines)
