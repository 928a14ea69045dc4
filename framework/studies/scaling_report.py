"""Draws the report of a scaling study: report.png, and report.html with the figures and tables in it."""

from __future__ import annotations

import base64
import html
import io
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib.figure import Figure

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "post"))
from charts import plain, style

import scaling_output
from point_folder import write_whole
from scaling import CAUSES

BLUE, ORANGE, GREEN, VIOLET, RED, GREY = "#2b6cb0", "#c05621", "#2f855a", "#805ad5", "#c53030", "#718096"
COLOURS = (BLUE, ORANGE, GREEN, VIOLET, RED, "#b7791f", "#319795", "#d53f8c")
SHOWN_FACTORS = {"parallel_efficiency": BLUE, "load_balance": ORANGE, "communication_efficiency": GREEN,
                 "computation_scaling": VIOLET, "global_efficiency": "#1a202c"}
SOURCE = ("Factors as the POP Centre of Excellence defines them (https://co-design.pop-coe.eu/metrics/; C. Rosas, J. "
          "Giménez &amp; J. Labarta, \"Scalability prediction for fundamental performance factors\", Supercomputing "
          "Frontiers and Innovations 1 (2014) 4-19): load balance = mean / largest useful time; communication "
          "efficiency = largest useful time / run time; parallel efficiency = their product; computation scaling = "
          "useful time of the reference / useful time, both of all ranks and for the same work; global efficiency = "
          "parallel efficiency × computation scaling. Useful time is the work in the steps: all phases that every step "
          "needs, without sending, receiving and waiting.")


def of_ranks(axes, ranks: list[int]) -> None:
    axes.set_xscale("log", base=2)
    axes.set_xticks(ranks, [str(n) for n in ranks])
    axes.minorticks_off()
    axes.set_xlabel("ranks")


def draw_times(rows: list[dict], axes) -> None:
    ranks = [row["ranks"] for row in rows]
    times = [row["seconds_per_cycle"] * 1e3 for row in rows]
    spans = [[(row["seconds"] - row["seconds_min"]) / row["seconds"] * t for row, t in zip(rows, times)],
             [(row["seconds_max"] - row["seconds"]) / row["seconds"] * t for row, t in zip(rows, times)]]
    axes.errorbar(ranks, times, yerr=spans, marker="o", color=BLUE, capsize=3, label="median, least and greatest")
    axes.set_yscale("log")
    of_ranks(axes, ranks)
    style(axes, "time of a cycle [ms]")
    axes.set_title("time", fontsize="medium")


def draw_speed_up(rows: list[dict], axes) -> None:
    ranks = [row["ranks"] for row in rows]
    axes.plot(ranks, [n / ranks[0] for n in ranks], color=GREY, linestyle="--", linewidth=1.0, label="ideal")
    axes.plot(ranks, [row["speed_up"] for row in rows], marker="o", color=BLUE, label="measured")
    axes.set_yscale("log", base=2)
    axes.set_yticks([n / ranks[0] for n in ranks], [f"{n / ranks[0]:.3g}" for n in ranks])
    of_ranks(axes, ranks)
    style(axes, f"throughput over that of {ranks[0]} rank{'s' if ranks[0] > 1 else ''}")
    axes.set_title("speed-up", fontsize="medium")


def finish_ratios(axes, ranks: list[int], label: str, title: str) -> None:
    """The frame of what would be one on an ideal machine."""
    axes.axhline(1.0, color=GREY, linewidth=0.8)
    axes.set_ylim(bottom=0.0)
    of_ranks(axes, ranks)
    style(axes, label)
    axes.set_title(title, fontsize="medium")


def draw_efficiency(rows: list[dict], axes) -> None:
    ranks = [row["ranks"] for row in rows]
    axes.plot(ranks, [row["efficiency"] for row in rows], marker="o", color=BLUE, label=f"against {ranks[0]}")
    side = [row for row in rows if row.get("efficiency_side_by_side") is not None]
    if side:
        axes.plot([row["ranks"] for row in side], [row["efficiency_side_by_side"] for row in side], marker="s",
                  color=ORANGE, label="against serial runs side by side")
    finish_ratios(axes, ranks, "efficiency", "efficiency")


def draw_factors(rows: list[dict], axes) -> None:
    ranks = [row["ranks"] for row in rows]
    for name, colour in SHOWN_FACTORS.items():
        axes.plot(ranks, [row["factors"][name] for row in rows], marker="o", markersize=4, color=colour,
                  label=name.replace("_", " "))
    finish_ratios(axes, ranks, "factor", "POP's factors")


def draw_phases(rows: list[dict], axes) -> None:
    """Work of each phase, and on top the waiting of all of them, as shares of the time."""
    places = range(len(rows))
    bottom = [0.0] * len(rows)
    # Phases that take nothing would only fill the legend.
    names = list(dict.fromkeys(name for row in rows for name, phase in row["phases"].items()
                               if phase["work"] > 1.0e-3 * row["seconds"]))
    for name, colour in zip(names, COLOURS):
        heights = [100.0 * row["phases"][name]["work"] / row["seconds"] if name in row["phases"] else 0.0
                   for row in rows]
        axes.bar(places, heights, bottom=bottom, color=colour, label=name.replace("_", " "))
        bottom = [b + h for b, h in zip(bottom, heights)]
    waiting = [100.0 * sum(phase["waiting"] for phase in row["phases"].values()) / row["seconds"] for row in rows]
    axes.bar(places, waiting, bottom=bottom, color="#e2e8f0", hatch="//", edgecolor=GREY, label="messages, waiting")
    axes.set_xticks(list(places), [str(row["ranks"]) for row in rows])
    axes.set_xlabel("ranks")
    axes.set_xlim(-0.6, len(rows) + 0.6)  # with room for the legend
    style(axes, "share of the time [%]")
    axes.set_title("work and waiting", fontsize="medium")


def draw_counts(rows: list[dict], axes) -> None:
    ranks = [row["ranks"] for row in rows]
    counted = [row for row in rows if (row.get("counts") or {}).get("per_cycle")]
    for kind, label, colour in (("eroding", "cycles that erode", RED), ("others", "other cycles", BLUE),
                                ("all", "all cycles", GREY)):
        found = [(row["ranks"], row["counts"]["per_cycle"][kind]["collectives"]["mean"]) for row in counted
                 if row["counts"]["per_cycle"][kind]["cycles"]]
        if found:
            axes.plot(*zip(*found), marker="o", color=colour, label=label)
    if not counted:
        axes.text(0.5, 0.5, "not counted", ha="center", transform=axes.transAxes)
    of_ranks(axes, ranks)
    axes.set_ylim(bottom=0.0)
    style(axes, "collective operations per cycle")
    axes.set_title("collective operations, mean", fontsize="medium")


def draw_messages(rows: list[dict], axes) -> None:
    counted = [row for row in rows if (row.get("counts") or {}).get("per_cycle")]
    ranks = [row["ranks"] for row in rows]
    if counted:
        axes.plot([row["ranks"] for row in counted],
                  [row["counts"]["per_cycle"]["all"]["messages"]["mean"] / row["ranks"] for row in counted], marker="o",
                  color=BLUE, label="messages of a rank")
        axes.plot([row["ranks"] for row in counted],
                  [row["counts"]["per_cycle"]["all"]["bytes"]["mean"] / row["ranks"] * 1e-3 for row in counted],
                  marker="s", color=ORANGE, label="kB of a rank")
    of_ranks(axes, ranks)
    axes.set_ylim(bottom=0.0)
    style(axes, "per cycle and rank")
    axes.set_title("messages, mean", fontsize="medium")


def draw_imbalance(rows: list[dict], axes) -> None:
    ranks = [row["ranks"] for row in rows]
    for name, colour in zip(CAUSES, COLOURS):
        axes.plot(ranks, [row["phases"].get(name, {}).get("imbalance") for row in rows], marker="o", markersize=4,
                  color=colour, label=name.replace("_", " "))
    model = [(row["ranks"], row["imbalance_of_model"]["mean"]) for row in rows if row.get("imbalance_of_model")]
    if model:
        axes.plot(*zip(*model), marker="s", markersize=4, color=GREY, linestyle="--", label="the work model")
    of_ranks(axes, ranks)
    style(axes, "largest / mean work")
    axes.set_title("imbalance", fontsize="medium")


CHARTS = {"times": draw_times, "speed_up": draw_speed_up, "efficiency": draw_efficiency, "factors": draw_factors,
          "phases": draw_phases, "imbalance": draw_imbalance, "collectives": draw_counts, "messages": draw_messages}


def finish(axes) -> None:
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, fontsize="x-small", loc="best")


def write_png(content: dict, rows: list[dict], output: Path) -> None:
    figure = Figure(figsize=(18.0, 8.5), layout="constrained")
    for axes, draw in zip(figure.subplots(2, 4).ravel(), CHARTS.values()):
        if rows:
            draw(rows, axes)
        finish(axes)
    figure.suptitle(plain(title_of(content)))
    figure.savefig(output / "report.png", dpi=110)


def picture(draw, rows: list[dict]) -> str:
    figure = Figure(figsize=(5.6, 4.0), layout="constrained")
    axes = figure.subplots()
    draw(rows, axes)
    finish(axes)
    data = io.BytesIO()
    figure.savefig(data, dpi=110, format="png")
    return base64.b64encode(data.getvalue()).decode("ascii")


# ---- HTML

STYLE = """body{font-family:sans-serif;max-width:78em;margin:2em auto;padding:0 1em;color:#1a202c}
table{border-collapse:collapse;margin:.6em 0 1.4em;font-size:.85em}td,th{border:1px solid #cbd5e0;padding:.2em .6em;
text-align:right}th{background:#edf2f7}td.text{text-align:left}.loud{background:#c53030;color:#fff;padding:1em;
font-weight:bold}.note{background:#fefcbf;padding:.4em 1em}figure{display:inline-block;margin:.3em}"""


def title_of(content: dict) -> str:
    name = content["title"] or Path(content["input"]).stem
    return f"{content['mode'].capitalize()} scaling: {name}"


def as_table(lines: list[list[str]], left: tuple[int, ...] = ()) -> str:
    head = "".join(f"<th>{html.escape(word)}</th>" for word in lines[0])
    body = "".join("<tr>" + "".join(f"<td{' class=text' if i in left else ''}>{html.escape(word)}</td>"
                                    for i, word in enumerate(line)) + "</tr>" for line in lines[1:])
    return f"<table><tr>{head}</tr>{body}</table>"


def facts_table(content: dict) -> str:
    machine = content["machine"]
    facts = {"input": content["input"], "date": content["date"], "version of Kerf": ", ".join(content["versions"]),
             "settings": "; ".join(f"{key} = {value}" for key, value in content["settings"].items()),
             "grows with the ranks": ", ".join(content["weak"]), "processor": machine.get("cpu"),
             "cores that may be used": machine.get("cores"), "cores of the machine": machine.get("cores_of_machine"),
             "governor": machine.get("governor"), "turbo": machine.get("turbo"), "ranks started by": content["launch"]}
    lines = [["", ""]] + [[name, "not known" if value is None else str(value)] for name, value in facts.items()
                          if value != ""]
    return as_table(lines, (0, 1))


def run_lines(content: dict) -> list[list[str]]:
    return [["run", "ranks", "status", "exit code", "seconds", "state hash", "message"]] + [
        [run["name"], str(run["ranks"]), run["status"], scaling_output.shown(run["exit_code"]),
         scaling_output.shown(run["seconds"], 4), run["state_hash"] or "-", run["message"]] for run in content["runs"]]


def function_lines(content: dict) -> list[list[str]]:
    lines = [["ranks", "phase", "function", "kind", "calls per cycle of a rank", "kB per cycle of all"]]
    for row in content["ranks"]:
        for entry in (row.get("counts") or {}).get("functions", []):
            if entry["in_step"]:
                lines.append([str(row["ranks"]), entry["phase"], entry["function"], entry["kind"],
                              scaling_output.shown(entry["calls_per_cycle"]),
                              scaling_output.shown(entry["bytes_per_cycle"] * 1e-3)])
    return lines


def write_report(content: dict, output: Path) -> None:
    rows = [row for row in content["ranks"] if row["completed"]]
    write_png(content, rows, output)
    loud = scaling_output.hash_message(content, output) if content["hashes"]["differing"] else []
    figures = "".join(f'<figure><img alt="{name}" src="data:image/png;base64,{picture(draw, rows)}"></figure>'
                      for name, draw in CHARTS.items()) if rows else "<p>No run has completed.</p>"
    counts = scaling_output.count_lines(content)
    parts = [f"<h1>{html.escape(title_of(content))}</h1>",
             "".join(f'<p class="loud">{html.escape(line)}</p>' for line in loud),
             "".join(f'<p class="note">{html.escape(note)}</p>' for note in scaling_output.notes_of(content)),
             facts_table(content), "<h2>Times and factors</h2>", as_table(scaling_output.main_lines(content)),
             f"<p>{SOURCE}</p>", figures, "<h2>Imbalance and waiting</h2>",
             as_table(scaling_output.imbalance_lines(content))]
    if len(counts) > 1:
        parts += ["<h2>Said per cycle</h2>", as_table(counts, (1,)), "<h2>By function and phase</h2>",
                  as_table(function_lines(content), (1, 2, 3))]
    parts += ["<h2>Runs</h2>", as_table(run_lines(content), (0, 2, 6))]
    write_whole(output / "report.html", f"<!DOCTYPE html><html lang=en><meta charset=utf-8><title>"
                f"{html.escape(title_of(content))}</title><style>{STYLE}</style>\n" + "\n".join(parts) + "</html>\n")
