"""From the runs of a scaling study to its numbers: speed-up, efficiency, POP's factors, imbalance, waiting, hashes.

All of it comes from summary.json of each run. Throughput is element cycles per second: for strong scaling, where every
run has the same element cycles, its ratio is that of the times; for weak scaling it takes the true sizes of the meshes.
"""

from __future__ import annotations

import csv
import math
from collections import defaultdict
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import fmean, median

import pop
from message_counts import OF_STEP, CountsError, counts_of
from point_folder import DONE
from scaling_study import COUNTED, SIDE, TIMED, ScaleFolder, ScalingStudy

CAUSES = ("elements", "contact_search", "contact_forces", "erosion")  # whose imbalance is told apart
NEEDED = ("ranks", "wall_seconds", "element_cycles", "cycles", "state_hash", "timers", "steps")


@dataclass
class OneRun:
    """One run as it stands in the table of runs."""

    name: str
    kind: str
    ranks: int
    repeat: int
    status: str
    exit_code: int | None
    seconds: float | None  # of the steps, without set-up and output
    element_cycles: int | None
    state_hash: str | None
    message: str


def fault_of(summary: dict, ranks: int) -> str:
    """Why the summary of a run that was to be on so many ranks cannot be used; empty where it can."""
    missing = [name for name in NEEDED if summary.get(name) is None]
    if missing:
        return f"summary.json has no {', '.join(missing)}; expected that of a newer Kerf"
    if summary["ranks"] != ranks:
        return (f"the run was on {summary['ranks']} ranks; expected {ranks}: does --launch start the ranks of the MPI "
                "that Kerf is built with?")
    if not (summary["wall_seconds"] > 0.0 and summary["steps"]["work"]["max"] > 0.0 and summary["element_cycles"] > 0):
        return "the run has made no step whose time could be measured; expected one that takes longer"
    return ""


def run_of(folder: ScaleFolder) -> tuple[OneRun, dict | None]:
    """A run and its summary; the summary only of a run that has completed and has all that is needed."""
    state = folder.state()
    summary = state.summary if state.status == DONE else None
    status, message = state.status, state.message
    fault = "" if summary is None else fault_of(summary, folder.ranks)
    if fault:
        status, summary, message = "failed", None, fault
    facts = summary or {}
    return OneRun(folder.name, folder.kind, folder.group, folder.repeat, status, state.exit_code,
                  facts.get("wall_seconds"), facts.get("element_cycles"), facts.get("state_hash"), message), summary


def middle(summaries: list[dict]) -> dict:
    """The run whose time is the median; of an even number the faster one of the two in the middle."""
    ordered = sorted(summaries, key=lambda summary: summary["wall_seconds"])
    return ordered[(len(ordered) - 1) // 2]


# ---- one run

def times_of_ranks(times: dict, n_ranks: int) -> list[float]:
    """Times of ranks that have the mean and the largest of `times`. On two ranks they are the true ones; on more the
    others are not known one by one, and no factor asks for them."""
    if n_ranks == 1:
        return [times["max"]]
    rest = (times["mean"] * n_ranks - times["max"]) / (n_ranks - 1)
    return [times["max"]] + [max(rest, 0.0)] * (n_ranks - 1)


def useful_per_work(summary: dict) -> float:
    """Seconds of all ranks together for an element cycle."""
    return summary["steps"]["work"]["mean"] * summary["ranks"] / summary["element_cycles"]


def factors_of(summary: dict, reference: dict) -> pop.Factors:
    """POP's factors of a run. The reference's useful time is scaled to the element cycles of this run."""
    useful = times_of_ranks(summary["steps"]["work"], summary["ranks"])
    return pop.factors(useful, summary["wall_seconds"],
                       reference_useful=useful_per_work(reference) * summary["element_cycles"])


def phases_of(summary: dict) -> dict[str, dict[str, float]]:
    """Per phase of a step: seconds and work (mean over ranks), waiting, and the imbalance of the work."""
    found = {}
    for name in OF_STEP:
        times = summary["timers"].get(name)
        if times is None:
            continue
        work = times["work"]
        waiting = times["mean"] - work["mean"]
        found[name] = {"seconds": times["mean"], "work": work["mean"], "work_max": work["max"], "waiting": waiting,
                       "waiting_share": waiting / summary["wall_seconds"],
                       "imbalance": work["max"] / work["mean"] if work["mean"] > 0.0 else 1.0,
                       "lost_share": (work["max"] - work["mean"]) / summary["wall_seconds"]}
    return found


def imbalance_of_model(folder: Path) -> dict[str, float] | None:
    """What the work model saw: the column `imbalance` of history.csv."""
    try:
        with open(folder / "history.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        place = [name.split(" ")[0] for name in rows[0]].index("imbalance")
        values = [float(row[place]) for row in rows[1:]]
    except (OSError, ValueError, IndexError):
        return None
    return {"mean": fmean(values), "median": median(values), "largest": max(values)} if values else None


# ---- one number of ranks

def row_of(n: int, summaries: list[dict], base: dict, base_ranks: int, cores: int | None) -> dict:
    """The table's line of n ranks. `base` is the middle run of the fewest ranks."""
    chosen = middle(summaries)
    seconds = [summary["wall_seconds"] for summary in summaries]
    typical = median(seconds)
    work = chosen["element_cycles"]
    throughput = work / typical
    return {"ranks": n, "oversubscribed": cores is not None and n > cores, "completed": len(summaries),
            "elements": sum(part["elements"] for part in chosen.get("parts", {}).values()),
            "cycles": chosen["cycles"], "element_cycles": work,
            "seconds": typical, "seconds_min": min(seconds), "seconds_max": max(seconds),
            "spread": (max(seconds) - min(seconds)) / typical, "seconds_per_cycle": typical / max(chosen["cycles"], 1),
            "element_cycles_per_second": throughput, "base_ranks": base_ranks,
            "factors": asdict(factors_of(chosen, base)), "phases": phases_of(chosen)}


def add_speed_ups(rows: list[dict]) -> None:
    """Against the fewest ranks that have completed: speed-up = ratio of throughputs; efficiency = speed-up over the
    ratio of ranks."""
    base = next((row for row in rows if row["completed"]), None)
    for row in rows:
        if base is None or not row["completed"]:
            continue
        row["speed_up"] = row["element_cycles_per_second"] / base["element_cycles_per_second"]
        row["efficiency"] = row["speed_up"] * base["ranks"] / row["ranks"]


def side_by_side_of(row: dict, copies: list[dict]) -> None:
    """Efficiency against n independent serial runs at the same time: throughput of the run over n times theirs."""
    speeds = [copy["element_cycles"] / copy["wall_seconds"] for copy in copies]
    row["side_by_side_seconds"] = median(copy["wall_seconds"] for copy in copies)
    row["efficiency_side_by_side"] = row["element_cycles_per_second"] / (row["ranks"] * median(speeds))


def wrong_growth(content: dict) -> list[str]:
    """Of weak scaling: the numbers of ranks whose mesh has not grown with the ranks."""
    rows = [row for row in content["ranks"] if row["completed"]] if content["mode"] == "weak" else []
    wanted = {row["ranks"]: rows[0]["elements"] * row["ranks"] / rows[0]["ranks"] for row in rows}
    return [f"kerf scale: error: the mesh of {row['ranks']} ranks has {row['elements']} elements, and that of "
            f"{rows[0]['ranks']} ranks {rows[0]['elements']}; expected about {wanted[row['ranks']]:.0f}: --weak must "
            "name all that makes cells" for row in rows
            if not 0.5 <= row["elements"] / max(wanted[row["ranks"]], 1.0) <= 2.0]


# ---- the whole study

def hashes_of(folders: list[ScaleFolder], runs: list[OneRun]) -> dict:
    """Runs of the same settings must end in the same state, on any number of ranks."""
    groups: dict[tuple, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for folder, run in zip(folders, runs):
        if run.state_hash is not None:
            groups[tuple(sorted(folder.point.settings.items()))][run.state_hash].append(run.name)
    differ = [dict(found) for found in groups.values() if len(found) > 1]
    return {"equal": not differ if groups else None, "differing": differ,
            "values": sorted({value for found in groups.values() for value in found})}


def counts_of_run(folder: ScaleFolder, summary: dict | None) -> dict:
    if summary is None:
        return {"missing": "the counted run has not completed"}
    try:
        return counts_of(folder.path, folder.counts_path, folder.ranks)
    except CountsError as error:
        return {"missing": str(error)}


def empty_row(n: int, cores: int | None) -> dict:
    return {"ranks": n, "oversubscribed": cores is not None and n > cores, "completed": 0}


def tabulate(study: ScalingStudy, output: Path, machine: dict) -> dict:
    """The content of scale.json."""
    folders = [folder for group in study.groups(output) for folder in group]
    pairs = [run_of(folder) for folder in folders]
    done: dict[tuple[str, int], list[tuple[ScaleFolder, dict]]] = defaultdict(list)
    for folder, (_, summary) in zip(folders, pairs):
        if summary is not None:
            done[folder.kind, folder.group].append((folder, summary))
    cores = machine.get("cores")
    timed = {n: [summary for _, summary in done[TIMED, n]] for n in study.ranks}
    base = next((n for n in study.ranks if timed[n]), None)
    rows = []
    for n in study.ranks:
        rows.append(row_of(n, timed[n], middle(timed[base]), base, cores) if timed[n] else empty_row(n, cores))
        if timed[n]:
            chosen = next(folder for folder, summary in done[TIMED, n] if summary is middle(timed[n]))
            rows[-1]["imbalance_of_model"] = imbalance_of_model(chosen.path)
        if timed[n] and done[SIDE, n]:
            side_by_side_of(rows[-1], [summary for _, summary in done[SIDE, n]])
        if study.counts:
            counted = done[COUNTED, n]
            folder = counted[0][0] if counted else ScaleFolder(study, output, COUNTED, n, 1)
            rows[-1]["counts"] = counts_of_run(folder, counted[0][1] if counted else None)
    add_speed_ups(rows)
    runs = [run for run, _ in pairs]
    return {"runs": [asdict(run) for run in runs], "ranks": rows, "hashes": hashes_of(folders, runs),
            "versions": sorted({str(summary.get("kerf_version")) for _, summary in pairs if summary}),
            "title": next((summary.get("title", "") for _, summary in pairs if summary), "")}


def finite(value):
    """Numbers that JSON has no word for become null."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, dict):
        return {key: finite(inner) for key, inner in value.items()}
    return [finite(inner) for inner in value] if isinstance(value, list) else value
