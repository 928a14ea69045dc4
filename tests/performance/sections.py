"""The sections of the benchmark: what is run, and which numbers are taken from it."""

from __future__ import annotations

import os
import subprocess
import tempfile
import time
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Callable

from cases import ROD_SIZES, bar, johnson_cook_bar, rod, rod_facets, stiffness_bar
from runner import ROOT, BenchError, Case, Run, Runner, Samples

PHASES = ("elements", "nodes", "contact_search", "contact_forces", "loads", "halo", "erosion", "rebalance", "output")


@dataclass
class Bench:
    runner: Runner
    binary: str
    baseline: str | None
    repeats: int
    quick: bool
    measured: dict[str, Samples] = field(default_factory=dict)

    def keep(self, key: str, values: list[float]) -> Samples:
        self.measured[key] = Samples(values)
        return self.measured[key]

    def interleaved(self, cases: list[Case], copy: bool = False) -> dict[str, list[Run]]:
        """All repeats of all cases, in turn; with a baseline also its rate and the ratio to it."""
        runs: dict[str, list[Run]] = {case.name: [] for case in cases}
        old: dict[str, list[Run]] = {case.name: [] for case in cases}
        for _ in range(self.repeats):
            for case in cases:
                runs[case.name].append(self.runner.run(self.binary, case, copy))
                if self.baseline:
                    old[case.name].append(self.runner.run(self.baseline, case))
        if self.baseline:
            for name in runs:
                ratio = self.keep(f"{name}.over_baseline",
                                  [new.rate / before.rate for new, before in zip(runs[name], old[name])])
                same = runs[name][0].summary["state_hash"] == old[name][0].summary["state_hash"]
                print(f"  {name}: {ratio.median:.3f} times the baseline's rate (spread {100 * ratio.spread:.1f} %), "
                      f"state hash {'equal' if same else 'DIFFERENT'}")
        return runs


@dataclass(frozen=True)
class Section:
    measure: Callable[[Bench], None]
    by_default: bool = True


def heading(text: str) -> None:
    print(f"\n{text}", flush=True)


def line(label: str, samples: Samples, unit: str, scale: float = 1.0) -> None:
    spread = f"spread {100 * samples.spread:.1f} %" if len(samples.values) > 1 else ""
    print(f"  {label:<44}{samples.median * scale:>12.4g} {unit:<12} {spread}".rstrip(), flush=True)


def total_of(run: Run) -> float:
    return max(run.total_seconds, 1e-9)


def measure_bar(bench: Bench) -> None:
    size, cycles = ("8 thousand", 60) if bench.quick else ("100 thousand", 400)
    heading(f"Taylor bar, {size} elements, one rank, {cycles} cycles")
    cases = [bar("bar_viscous", size, cycles), stiffness_bar(size, cycles), johnson_cook_bar(size, cycles)]
    runs = bench.interleaved(cases)
    for case in cases:
        rate = bench.keep(f"{case.name}.rate", [run.rate for run in runs[case.name]])
        phase = bench.keep(f"{case.name}.element_phase", [run.element_phase_rate for run in runs[case.name]])
        line(f"{case.name}: whole run", rate, "M/s", 1e-6)
        line(f"{case.name}: element phase alone", phase, "M/s", 1e-6)
        setup = Samples([run.startup for run in runs[case.name]])
        line(f"{case.name}: input to first cycle", setup, "s")
    viscous, stiff = runs["bar_viscous"], runs["bar_stiffness"]
    slower = bench.keep("bar_stiffness.slower", [1.0 - b.rate / a.rate for a, b in zip(viscous, stiff)])
    line("stiffness slower than viscous by", slower, "%", 100.0)


def measure_rod(bench: Bench) -> None:
    """The whole run, and its first part, in which there is little debris yet."""
    size = "11 thousand" if bench.quick else "82 thousand"
    cases = {"rod": "8 us" if bench.quick else "50 us", "rod_start": "4 us" if bench.quick else "15 us"}
    # Rows of history as often as in the whole run by default: a 200th of it.
    runs = bench.interleaved([rod(name, size, f"time.end={end}", "output.history_interval=0.25 us")
                              for name, end in cases.items()])
    for name, end in cases.items():
        heading(f"Oblique rod, {size} elements, one rank, {end}, default output")
        line("run without output", bench.keep(f"{name}.rate", [run.rate for run in runs[name]]), "M/s", 1e-6)
        for phase in PHASES:
            share = bench.keep(f"{name}.share.{phase}", [run.timer(phase) / total_of(run) for run in runs[name]])
            if share.median > 0.0:
                line(phase.replace("_", " "), share, "% of time", 100.0)
        contact = [(run.timer("contact_search") + run.timer("contact_forces")) / total_of(run) for run in runs[name]]
        bench.keep(f"{name}.contact_share", contact)
        bench.keep(f"{name}.output_share", [run.timer("output") / total_of(run) for run in runs[name]])
        summary = runs[name][0].summary
        print(f"  eroded {summary['eroded']['elements']} elements in {summary['cycles']} cycles")


def measure_precision(bench: Bench) -> None:
    """Single over double precision. No baseline: older programs have no such key."""
    size, rod_size = ("8 thousand", "11 thousand") if bench.quick else ("100 thousand", "82 thousand")
    cycles, end = (60, "4 us") if bench.quick else (400, "15 us")
    heading(f"Precision single over double, one rank: bars of {size}, rod of {rod_size} elements to {end}")
    models = {"bar": bar("bar", size, cycles), "johnson_cook_bar": johnson_cook_bar(size, cycles),
              "rod": rod("rod", rod_size, f"time.end={end}")}
    runs: dict[str, list[tuple[Run, Run]]] = {name: [] for name in models}
    for _ in range(bench.repeats):
        for name, case in models.items():
            single = replace(case, overrides=(*case.overrides, "precision=single"))
            runs[name].append((bench.runner.run(bench.binary, single), bench.runner.run(bench.binary, case)))
    for name, pairs in runs.items():
        line(f"{name}: single", bench.keep(f"precision.{name}.rate", [a.rate for a, _ in pairs]), "M/s", 1e-6)
        line(f"{name}: over double",
             bench.keep(f"precision.{name}", [a.rate / b.rate for a, b in pairs]), "x")
        line(f"{name}: element phase over double",
             bench.keep(f"precision.{name}.element_phase",
                        [a.element_phase_rate / b.element_phase_rate for a, b in pairs]), "x")


def measure_ranks(bench: Bench) -> None:
    bar_size, rod_size = ("8 thousand", "11 thousand") if bench.quick else ("100 thousand", "82 thousand")
    cycles, end = (60, "4 us") if bench.quick else (400, "15 us")
    heading("Two ranks against two independent serial runs side by side")
    models = {"bar": lambda n: bar(f"bar_{n}", bar_size, cycles, ranks=n),
              "rod": lambda n: rod(f"rod_{n}", rod_size, f"time.end={end}", ranks=n)}
    pairs: dict[str, list[float]] = {name: [] for name in models}
    parallel: dict[str, list[float]] = {name: [] for name in models}
    for _ in range(bench.repeats):
        for name, make in models.items():
            pairs[name].append(sum(run.rate for run in bench.runner.side_by_side(bench.binary, [make(1), make(1)])))
            parallel[name].append(bench.runner.run(bench.binary, make(2)).rate)
    for name in models:
        line(f"{name}: two ranks", bench.keep(f"ranks.{name}.two_ranks", parallel[name]), "M/s", 1e-6)
        line(f"{name}: two serial runs together", bench.keep(f"ranks.{name}.two_runs", pairs[name]), "M/s", 1e-6)
        ratio = bench.keep(f"ranks.{name}", [a / b for a, b in zip(parallel[name], pairs[name])])
        line(f"{name}: ratio", ratio, "%", 100.0)


def measure_rebalance(bench: Bench) -> None:
    size, cycles = ("11 thousand", 60) if bench.quick else ("82 thousand", 200)
    heading(f"Re-balancing every 20 cycles, oblique rod, {size} elements, two ranks")
    case = rod("rebalance", size, f"time.maximum_cycles={cycles}", "balance.force_interval=20", ranks=2)
    seconds, in_cycles = [], []
    for _ in range(bench.repeats):
        run = bench.runner.run(bench.binary, case)
        later = [record["seconds"] for record in run.summary["rebalances"] if record["cycle"] > 0]
        if not later:
            raise BenchError("rebalance: the run did not re-balance")
        cost = sum(later) / len(later)
        cycle = (run.summary["wall_seconds"] - sum(later)) / max(run.summary["cycles"], 1)
        seconds.append(cost)
        in_cycles.append(cost / cycle)
    line("one re-balance", bench.keep("rebalance.seconds", seconds), "s")
    line("the same in cycles of this model", bench.keep("rebalance.cycles", in_cycles), "cycles")


def measure_sizes(bench: Bench) -> None:
    cycles = {"8 thousand": 1500, "100 thousand": 150, "1 million": 20}
    if bench.quick:
        cycles = {"8 thousand": 40, "100 thousand": 5}
    heading("Taylor bar in several sizes, one rank")
    cases = [bar(size, size, n) for size, n in cycles.items()]
    runs = bench.interleaved(cases)
    for size in cycles:
        line(f"{size}: whole run", bench.keep(f"size.{size}.rate", [r.rate for r in runs[size]]), "M/s", 1e-6)
        memory = bench.keep(f"size.{size}.bytes_per_element", [r.peak_memory / r.elements for r in runs[size]])
        line(f"{size}: memory, all told", memory, "B/element")
        line(f"{size}: input to first cycle", bench.keep(f"size.{size}.startup", [r.startup for r in runs[size]]), "s")
    if "1 million" not in runs:
        return
    large, middle = runs["1 million"], runs["100 thousand"]
    bench.keep("size.rate_ratio", [a.rate / b.rate for a, b in zip(large, middle)])
    bench.keep("size.bytes_per_element", [run.peak_memory / run.elements for run in large])
    bench.keep("size.startup", [run.startup for run in large])


def measure_facets(bench: Bench) -> None:
    sizes = list(ROD_SIZES)[:2] if bench.quick else list(ROD_SIZES)
    cycles = 20 if bench.quick else 60
    heading(f"Contact of the oblique rod in several sizes, one rank, {cycles} cycles")
    runs = bench.interleaved([rod(f"rod of {size}", size, f"time.maximum_cycles={cycles}") for size in sizes])
    for size in sizes:
        facets = rod_facets(size)
        cost = [(run.timer("contact_search") + run.timer("contact_forces")) / (run.summary["cycles"] * facets)
                for run in runs[f"rod of {size}"]]
        line(f"{size} elements, {facets} exterior facets", bench.keep(f"facets.{size}.seconds_per_facet_cycle", cost),
             "ns/facet", 1e9)


def measure_output(bench: Bench) -> None:
    size, cycles = ("8 thousand", 40) if bench.quick else ("100 thousand", 100)
    heading(f"Output, Taylor bar, {size} elements: a frame every cycle")
    case = bar("output", size, cycles, "output.results_interval=1.0e-9", "output.history_interval=1.0")
    runs = bench.interleaved([case], copy=True)["output"]
    line("writing", Samples([run.result_bytes / run.timer("output") for run in runs]), "MB/s", 1e-6)
    line("copying the same file", Samples([run.result_bytes / run.copy_seconds for run in runs]), "MB/s", 1e-6)
    line("a frame over copying its bytes",
         bench.keep("output.frame_over_copy", [run.timer("output") / run.copy_seconds for run in runs]), "x")


def measure_ten_million(bench: Bench) -> None:
    heading("Taylor bar, ten million elements, two ranks, 5 cycles")
    size = "8 thousand" if bench.quick else "10 million"
    run = bench.runner.run(bench.binary, bar("ten_million", size, 5, ranks=2))
    line(f"{run.elements} elements: whole run", bench.keep("ten_million.rate", [run.rate]), "M/s", 1e-6)
    line("input to first cycle", bench.keep("ten_million.startup", [run.startup]), "s")


def measure_build(bench: Bench) -> None:
    """A configuration of its own, without ccache; one plugin's object is deleted in place of being edited."""
    heading("Building")
    jobs = str(os.cpu_count())

    def seconds(*words: str) -> float:
        began = time.perf_counter()
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode != 0:
            raise BenchError(f"{' '.join(words)}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        return time.perf_counter() - began

    with tempfile.TemporaryDirectory(prefix="kerf_build_") as folder:
        configure = seconds("cmake", "-G", "Ninja", "-S", str(ROOT), "-B", folder, "-DKERF_TESTS=OFF",
                            "-DCMAKE_CXX_COMPILER_LAUNCHER=env")
        clean = configure + seconds("ninja", "-C", folder, "-j", jobs, "kerf")
        line("clean build", bench.keep("build.clean", [clean]), "s")
        objects = list(Path(folder).rglob("elastic_plastic.cpp.o"))
        again = []
        for _ in range(bench.repeats):
            objects[0].unlink()
            again.append(seconds("ninja", "-C", folder, "-j", jobs, "kerf"))
        line("after touching one plugin", bench.keep("build.one_plugin", again), "s")


SECTIONS = {
    "bar": Section(measure_bar),
    "rod": Section(measure_rod),
    "precision": Section(measure_precision),
    "ranks": Section(measure_ranks),
    "rebalance": Section(measure_rebalance),
    "sizes": Section(measure_sizes),
    "facets": Section(measure_facets),
    "output": Section(measure_output),
    "ten_million": Section(measure_ten_million, by_default=False),
    "build": Section(measure_build, by_default=False),
}
