"""What erosion, plasticity and contact do to the balance of an eroding model, and what partitioners and policies save.

Another model is one more entry in CASES.
"""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import numpy as np
from classical import COARSE, INPUT, METHODS, SMALL
from matplotlib.figure import Figure
from study_tools import (ROOT, Case, equal_hashes, median, most_lost, partition, predict, rows_of, run, save_small,
                         summary_of, table)

from cycle import Rates, Sizes  # isort: skip
from pop import imbalance  # isort: skip
from recording import read_recording  # isort: skip
from refinement import refined  # isort: skip
from virtual_ranks import contact_space, slave_work  # isort: skip

INPUTS = ROOT / "inputs"
THICK = INPUTS / "deep_penetration" / "deep_penetration.yaml"
THICK_FINE = ("parameters.cell_size=1 mm", "parameters.core_cells=3", "parameters.ring_cells=3",
              "parameters.axial_cells=72")
THICK_SMALL = ("parameters.cell_size=4 mm", "parameters.core_cells=1", "parameters.ring_cells=1",
               "parameters.axial_cells=14", "time.end=8 us")
# For each model a coarse form, which is run on several ranks, and a fine one, whose recorded work is predicted.
CASES = [(Case("oblique_rod", INPUT, COARSE), Case("oblique_rod_fine", INPUT)),
         (Case("deep_penetration", THICK), Case("deep_penetration_fine", THICK, THICK_FINE))]
QUICK_CASES = [(Case("small_rod", INPUT, SMALL), Case("small_rod", INPUT, SMALL)),
               (Case("small_penetration", THICK, THICK_SMALL), Case("small_penetration", THICK, THICK_SMALL))]
BAR = Case("taylor_bar", INPUTS / "taylor_bar" / "taylor_bar.yaml", ("time.maximum_cycles=20",))
POLICIES = {
    "`never`": ("balance.policy={type: never}",),
    "`threshold`, as it is": (),
    "`threshold: 1.02`, cost not asked": ("balance.policy={type: threshold, threshold: 1.02, cost_factor: 0, "
                                          "check_interval: 25, window: 1, cooldown: 50}",),
    "`every: 100`": ("balance.policy={type: every, interval: 100}",),
}
QUICK_POLICIES = {"`never`": POLICIES["`never`"], "`every: 20`": ("balance.policy={type: every, interval: 20}",)}
# A yield stress that is never reached: the same elements without plasticity, hence without erosion.
ELASTIC = {input: tuple(f"materials.{name}.strength.yield_stress=1e9 GPa" for name in materials)
           for input, materials in {INPUT: ("rod_steel", "plate_steel"), THICK: ("tungsten", "steel")}.items()}
# Cells that stand for K x K x K, ranks, and the efficiency that is wanted.
TARGETS = [("1e8 elements on 1,024 ranks", 11, 1024, 0.85), ("2,500 elements per rank on 4,096 ranks", 5, 4096, 0.50)]
SPACES = {"rcb": "of its own", "owners": "with the elements"}
NETWORK = ["--network", "hdr_infiniband"]


def make(runs: Path, pages: Path, quick: bool) -> dict[str, str]:
    """Writes the figures and returns the tables."""
    counts = [2, 3] if quick else [2, 3, 5, 8]
    tables: dict[str, list[str]] = {}
    for coarse, fine in QUICK_CASES if quick else CASES:
        found = study(coarse, fine, runs / coarse.name, pages, counts, quick)
        for name, text in found.items():
            tables.setdefault(name, []).append(f"**{coarse.name}**\n\n{text}")
    bars = [1, 2] if quick else [1, 2, 4, 8, 16, 32, 64]
    state = equal_hashes({n: run(BAR, runs, f"bar_{n}", ranks=n) for n in bars})
    texts = {name: "\n\n".join(parts) for name, parts in tables.items()}
    return texts | {"many_ranks": table(["ranks", "cycles", "state hash"],
                                        [[", ".join(map(str, bars)), summary_of(runs / "bar_1")["cycles"],
                                          f"`{state}`"]])}


def study(coarse: Case, fine: Case, runs: Path, pages: Path, counts: list[int], quick: bool) -> dict[str, str]:
    """All tables of one model."""
    recorded = run(coarse, runs, "recorded", f"output.recording_interval={'4 us' if quick else '2 us'}")
    parts = partition(coarse, runs, "partition", counts, METHODS)
    kept = StaticParts(parts / "partitions.h5", recorded / "erosion.csv")
    policies = {n: {name: run(coarse, runs, f"{re.sub('[^a-z0-9]+', '_', name).strip('_')}_{n}", *settings, ranks=n)
                    for name, settings in (QUICK_POLICIES if quick else POLICIES).items()}
                for n in (counts[:1] if quick else (counts[0], counts[-1]))}
    others = {n: run(coarse, runs, f"threshold_as_it_is_{n}", ranks=n) for n in counts}
    equal_hashes({1: recorded} | others)
    for n, folders in policies.items():
        equal_hashes({k: folder for k, folder in enumerate(folders.values())}, summary_of(recorded)["state_hash"])
    recorded_fine = run(fine, runs, "recorded_fine", f"output.recording_interval={'4 us' if quick else '10 us'}")
    ranks = "2,4" if quick else "2..4096"
    rows = predict(recorded_fine, runs, "predicted", "--ranks", ranks, *NETWORK, *(
        word for policy in ("never", "threshold:1.02") for word in ("--policy", policy)))
    draw_static(kept, counts[-1], pages / f"erosion_static_{coarse.name}.png")
    draw_predicted(rows, pages / f"erosion_predicted_{coarse.name}.png")
    return {"causes": causes_table(recorded, runs, counts), "plasticity": plasticity_table(coarse, runs, quick),
            "partitioners": partitioners_table(kept, counts), "policies": policies_table(policies),
            "moves": moves_table(policies, summary_of(recorded)), "predicted": predicted_table(rows),
            "targets": targets_table(recorded_fine, runs, quick), "boxes": boxes_table(recorded_fine, quick)}


class StaticParts:
    """Live elements of each part of a partition of the undeformed mesh that is never changed, as elements erode."""

    def __init__(self, partitions: Path, erosion: Path):
        deaths = rows_of(erosion)
        self.element = np.array([int(row["element"]) for row in deaths], dtype=np.int64)
        self.cycle = np.array([int(row["cycle"]) for row in deaths], dtype=np.int64)
        with h5py.File(partitions) as file:
            self.part = {(method, int(n)): group[n][:] for method, group in file["initial"].items() for n in group}

    def imbalance(self, method: str, n: int, cycle: float = np.inf) -> float:
        """Most live elements of a part over the mean."""
        part = self.part[(method, n)]
        live = np.bincount(part, minlength=n) - np.bincount(part[self.element[self.cycle <= cycle]], minlength=n)
        return float(live.max() / live.mean())


def causes_table(recorded: Path, runs: Path, counts: list[int]) -> str:
    """By what work is uneven, with contact in a decomposition of its own and without."""
    lines = []
    for space in SPACES:
        for row in predict(recorded, runs, f"causes_{space}", "--ranks", ",".join(map(str, counts)), "--network",
                           "shared_memory", "--contact-space", space):
            lines.append([int(row["ranks"]), SPACES[space]] + [
                f"{row[f'imbalance_{cause}']:.3f} ({100 * row[f'lost_{cause}']:.1f} %)"
                if row.get(f"imbalance_{cause}") else "-" for cause in ("elements", "contact", "erosion")])
    return table(["ranks", "contact's decomposition", "elements", "contact", "erosion"],
                 sorted(lines, key=lambda line: line[0]))


def plasticity_table(case: Case, runs: Path, quick: bool) -> str:
    """Time of an element in one cycle where it may yield, and where it cannot; runs in turn."""
    cycles = "time.maximum_cycles=20" if quick else "time.maximum_cycles=300"
    times: dict[str, list[float]] = {"as it is": [], "without plasticity": []}
    for repeat in range(1 if quick else 3):
        for name, settings in (("as it is", ()), ("without plasticity", ELASTIC[case.input])):
            folder = run(case, runs, f"{name.replace(' ', '_')}_{repeat}", cycles, *settings)
            summary = summary_of(folder)
            times[name].append(1e9 * summary["timers"]["elements"]["mean"] / summary["element_cycles"])
    return table(["material", "runs", "time of an element in a cycle, median [ns]", "least [ns]"],
                 [[name, len(found), float(median(found)), float(min(found))] for name, found in times.items()])


def partitioners_table(kept: StaticParts, counts: list[int]) -> str:
    lines = [[f"`{method}`", *(value for n in counts for value in (kept.imbalance(method, n, 0),
                                                                 kept.imbalance(method, n)))] for method in METHODS]
    return table(["method", *(f"{n}, {when}" for n in counts for when in ("start", "end"))], lines)


def policies_table(policies: dict[int, dict[str, Path]]) -> str:
    """Imbalance by the work model over all rows of history.csv."""
    lines = []
    for n, folders in policies.items():
        for name, folder in folders.items():
            found = [row["imbalance [-]"] for row in rows_of(folder / "history.csv")]
            moves = [m for m in summary_of(folder)["rebalances"] if m["cycle"] > 0]
            lines.append([n, name, float(np.mean(found)), float(max(found)), float(found[-1]), len(moves),
                          sum(m["elements_moved"] for m in moves)])
    return table(["ranks", "policy", "imbalance, mean", "largest", "at the end", "moves", "elements moved"], lines)


def moves_table(policies: dict[int, dict[str, Path]], serial: dict) -> str:
    """What moves have cost, in seconds and in cycles of the same run, and what they can save until the end."""
    lines = []
    share = serial["timers"]["elements"]["mean"] / serial["steps"]["mean"]
    for n, folders in policies.items():
        for name, folder in folders.items():
            summary = summary_of(folder)
            moves = [m for m in summary["rebalances"] if m["cycle"] > 0]
            if not moves:
                continue
            cycle = summary["steps"]["mean"] / summary["cycles"]
            costs = [m["seconds"] for m in moves]
            ends = [m["cycle"] for m in moves[1:]] + [summary["cycles"]]
            saved = [(m["imbalance_before"] - m["imbalance_after"]) * (end - m["cycle"]) * share
                     for m, end in zip(moves, ends)]
            lines.append([n, name, len(moves), float(median(costs)), float(median(costs) / cycle),
                          float(sum(costs) / cycle), float(sum(saved))])
    return table(["ranks", "policy", "moves", "seconds per move, median", "cycles per move", "cycles of all moves",
                  "cycles saved at most"], lines)


FACTORS = ("efficiency", "load_balance", "serialisation_efficiency", "transfer_efficiency", "computation_scaling")


def predicted_table(rows: list[dict]) -> str:
    lines = [[row["policy"], int(row["ranks"]), float(row["speed_up"]), *(row[key] for key in FACTORS),
              int(row["moves"]), most_lost(row, 2)] for row in rows]
    return table(["policy", "ranks", "speed-up", *(key.replace("_", " ") for key in FACTORS), "moves",
                  "uneven work costs at most"], lines)


def targets_table(recorded: Path, runs: Path, quick: bool) -> str:
    """Refined models on many ranks, against what is wanted."""
    lines = []
    elements = sum(p["elements"] for p in summary_of(recorded)["parts"].values())
    for name, refine, ranks, wanted in [("small", 2, 4, 0.5)] if quick else TARGETS:
        for space in SPACES:
            row = predict(recorded, runs, f"target_{ranks}_{space}", "--ranks", ranks, "--refine", refine, *NETWORK,
                          "--contact-space", space)[0]
            lines.append([name, refine, f"{elements * refine**3:.3g}", f"{elements * refine**3 / ranks:.0f}",
                          SPACES[space], f"{100 * row['efficiency']:.1f} %", f"{100 * wanted:.0f} %",
                          *(row[key] for key in FACTORS[1:]), row["imbalance_elements"], row["imbalance_contact"],
                          most_lost(row, 2)])
    return table(["target", "K", "elements", "per rank", "contact's decomposition", "efficiency", "wanted",
                  *(key.replace("_", " ") for key in FACTORS[1:]), "imbalance of elements", "of contact",
                  "uneven work costs at most"], lines)


def boxes_table(recorded: Path, quick: bool) -> str:
    """How even the boxes of contact are in each moment of the last target, by what `kerf predict` knows."""
    name, refine, n, _ = ("small", 2, 4, 0.5) if quick else TARGETS[-1]
    recording = refined(read_recording(recorded / "recording.h5"), Sizes(), Rates(), refine)[0]
    space, lines = None, []
    for moment in recording.moments:
        contact = moment.contact
        space = contact_space(moment.mesh, contact, n, space)
        rank = space.cuts.locate(contact.places(moment.mesh))
        n_looks = moment.n_searches + moment.n_renewals
        seconds = contact.force_seconds + contact.search_seconds * (n_looks / moment.n_cycles)
        lines.append([moment.cycle, *(imbalance(np.bincount(rank, weights=work, minlength=n)) for work in (
            np.ones(len(rank)), slave_work(contact), contact.force_seconds, seconds))])
    return table(["recorded cycle", "surface nodes", "work by which boxes are cut", "time of forces",
                  "time of forces and searches"], lines)


def draw_static(kept: StaticParts, n: int, path: Path) -> None:
    """How the imbalance of elements grows where nothing moves."""
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axes = figure.subplots()
    cycles = np.linspace(0, kept.cycle.max() + 1, 60).astype(int)
    for method in METHODS:
        axes.plot(cycles, [kept.imbalance(method, n, cycle) for cycle in cycles], label=method)
    axes.set_xlabel("cycle")
    axes.set_ylabel(f"elements, most over mean, {n} parts")
    axes.grid(alpha=0.3)
    axes.legend(frameon=False, fontsize=8)
    save_small(figure, path)


def draw_predicted(rows: list[dict], path: Path) -> None:
    """Efficiency over the number of ranks, by policy; and its factors where nothing moves."""
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    for policy in dict.fromkeys(row["policy"] for row in rows):
        left.plot(*zip(*((r["ranks"], r["efficiency"]) for r in rows if r["policy"] == policy)), "o-", markersize=4,
                  label=policy)
    for key in FACTORS:
        right.plot(*zip(*((r["ranks"], r[key]) for r in rows if r["policy"] == "never")), "o-", markersize=4,
                   label=key.replace("_", " "))
    for axes, title in ((left, "efficiency by policy"), (right, "factors, never moved")):
        axes.set_xscale("log", base=2)
        axes.set_xlabel("ranks")
        axes.set_title(title, fontsize=10)
        axes.grid(alpha=0.3)
        axes.legend(frameon=False, fontsize=8)
    save_small(figure, path)
