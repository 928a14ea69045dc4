"""The same input gives the same bits: on any number of ranks, with any partitioner, through balancing and restart."""

import csv
import json
import math
import os
import subprocess
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2]
KERF = Path(os.environ.get("KERF_BINARY", SOURCE / "build" / "bin" / "kerf")).resolve()

# What may differ between runs that are the same: the decomposition and the clock on the wall.
MAY_DIFFER = {"ranks", "wall_seconds", "element_cycles_per_second", "timers", "steps", "rebalances", "work", "input"}

# With free nodes in contact, the harder of the two ways to treat them.
ROD = [SOURCE / "inputs/oblique_rod/oblique_rod.yaml", "parameters.cell_size=1.9 mm", "time.end=14 us",
       "checks.free_nodes=keep"]
TAYLOR = [SOURCE / "inputs/taylor_bar/taylor_bar.yaml", "parts.bar.mesh.cell_size=0.8 mm", "time.end=20 us"]
# A law with logarithms and powers, whose lanes compilers are tempted to treat differently.
JOHNSON_COOK = TAYLOR + [
    "materials.copper.strength={type: johnson_cook, shear_modulus: 79.577 GPa, A: 806 MPa, B: 614 MPa, n: 0.168, "
    "C: 0.0089, m: 1.1, specific_heat: 460, melting_temperature: 1813.15 K}"]
SINGLE = ["precision=single"]
# Small enough that every re-balance moves much, often enough that many fall between erosions.
OFTEN = ["balance.force_interval=10", "output.results_interval=20 us"]

# Two bodies of four elements that destroy each other.
EIGHT = """
title: eight elements
time: {end: 3 us}
materials:
  metal:
    density: 7850
    strength: {type: elastic_plastic, shear_modulus: 80e9, yield_stress: 1e9, hardening_modulus: 0.3e9}
    eos: {type: linear, bulk_modulus: 160e9}
    erosion: {criteria: [{type: geometric_strain, limit: 0.25}, {type: inversion}]}
parts:
  lower: {material: metal, mesh: {type: block, size: "[2, 2, 1] mm", cells: [2, 2, 1]}}
  upper:
    material: metal
    mesh: {type: block, size: "[2, 2, 1] mm", cells: [2, 2, 1]}
    placement: [{translate: "[0.3, 0.2, 1.01] mm"}]
    velocity: 200 0 -1500 m/s
contacts: [{type: eroding_surface}]
balance: {partitioner: {type: none}}
checks: {energy_growth: 0.5, free_nodes: keep}
"""


def run(case, output, ranks=1, settings=(), resume=False, expect=0):
    """Runs a case, given as its file and settings, and returns its results."""
    command = [str(KERF), "run", str(case[0]), "--output", str(output), "--ranks", str(ranks)]
    for setting in [*case[1:], *settings]:
        command += ["--set", setting]
    done = subprocess.run(command + (["--resume"] if resume else []), capture_output=True, text=True, timeout=300)
    assert done.returncode == expect, f"{' '.join(command)}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
    return Results(output)


class Results:
    def __init__(self, folder):
        self.summary = json.loads((folder / "summary.json").read_text())
        self.erosion = (folder / "erosion.csv").read_bytes()
        with open(folder / "history.csv") as file:
            rows = list(csv.reader(file))
        keep = [i for i, name in enumerate(rows[0]) if not name.startswith("imbalance")]
        self.history = [[row[i] for i in keep] for row in rows]

    def physics(self):
        return {k: v for k, v in self.summary.items() if k not in MAY_DIFFER}

    def eroded_ids(self):
        lines = self.erosion.decode().splitlines()
        column = lines[0].split(",").index("element")
        return [int(line.split(",")[column]) for line in lines[1:]]


def expect_same(results, reference):
    ours, theirs = results.physics(), reference.physics()
    assert {k: v for k, v in ours.items() if v != theirs[k]} == {}
    assert results.erosion == reference.erosion
    assert results.history == reference.history


def partitioned(name):
    return [f"balance.partitioner={{type: {name}}}"]


@pytest.fixture(scope="module")
def rod(tmp_path_factory):
    return run(ROD, tmp_path_factory.mktemp("rod"), settings=OFTEN)


@pytest.fixture(scope="module")
def single(tmp_path_factory):
    return {case[-1]: run(case + SINGLE, tmp_path_factory.mktemp("single"), settings=OFTEN)
            for case in (ROD, JOHNSON_COOK)}


@pytest.fixture(scope="module")
def taylor(tmp_path_factory):
    return run(TAYLOR, tmp_path_factory.mktemp("taylor"), settings=OFTEN)


@pytest.mark.parametrize("ranks", [2, 3, 5])
@pytest.mark.parametrize("partitioner", ["zoltan_rcb", "zoltan_hsfc", "zoltan_graph", "none"])
def test_oblique_rod_has_the_same_bits(rod, tmp_path, ranks, partitioner):
    results = run(ROD, tmp_path, ranks, OFTEN + partitioned(partitioner))
    assert results.summary["ranks"] == ranks
    expect_same(results, rod)


def test_oblique_rod_erodes_both_bodies(rod):
    # Otherwise the tests above would show little.
    assert min(rod.summary["eroded"]["by_part"].values()) >= 5


@pytest.mark.parametrize("ranks, partitioner", [(2, "zoltan_rcb"), (3, "zoltan_hsfc"), (5, "none")])
def test_johnson_cook_bar_has_the_same_bits(tmp_path, ranks, partitioner):
    reference = run(JOHNSON_COOK, tmp_path / "one", settings=OFTEN)
    expect_same(run(JOHNSON_COOK, tmp_path / "many", ranks, OFTEN + partitioned(partitioner)), reference)


@pytest.mark.parametrize("ranks, partitioner", [(2, "zoltan_rcb"), (3, "zoltan_hsfc"), (5, "none")])
@pytest.mark.parametrize("case", [ROD, JOHNSON_COOK], ids=["rod", "johnson_cook"])
def test_single_precision_has_the_same_bits(single, tmp_path, case, ranks, partitioner):
    reference = single[case[-1]]
    assert reference.summary["precision"] == "single"
    expect_same(run(case + SINGLE, tmp_path, ranks, OFTEN + partitioned(partitioner)), reference)


def test_single_precision_is_another_run(rod, single):
    # Otherwise the tests above would show little.
    assert single[ROD[-1]].summary["state_hash"] != rod.summary["state_hash"]
    assert min(single[ROD[-1]].summary["eroded"]["by_part"].values()) >= 5


@pytest.mark.parametrize("before, after", [(1, 3), (5, 2)])
def test_restart_in_single_precision_changes_no_bit(tmp_path, before, after):
    settings = OFTEN + SINGLE + ["output.restart_interval=8 us"]
    whole = run(ROD, tmp_path, before, settings)
    expect_same(run(ROD, tmp_path, after, settings, resume=True), whole)


@pytest.mark.parametrize("ranks, partitioner",
                         [(2, "zoltan_rcb"), (3, "zoltan_hsfc"), (5, "zoltan_graph"), (5, "none")])
def test_taylor_bar_has_the_same_bits(taylor, tmp_path, ranks, partitioner):
    expect_same(run(TAYLOR, tmp_path, ranks, OFTEN + partitioned(partitioner)), taylor)


def test_rebalancing_by_need_changes_no_bit(rod, tmp_path):
    settings = ["balance.policy={type: threshold, threshold: 1.001, cooldown: 5, check_interval: 3, cost_factor: 0}",
                "output.results_interval=20 us"]
    results = run(ROD, tmp_path, 3, settings)
    assert len(results.summary["rebalances"]) > 2
    expect_same(results, rod)


@pytest.mark.parametrize("before, after", [(1, 3), (3, 1), (5, 2)])
def test_restart_on_other_ranks_changes_no_bit(tmp_path, before, after):
    settings = OFTEN + ["output.restart_interval=8 us"]  # the one at 8 us is the last before the end
    whole = run(ROD, tmp_path, before, settings)
    resumed = run(ROD, tmp_path, after, settings, resume=True)
    assert resumed.summary["ranks"] == after
    expect_same(resumed, whole)


def test_restart_with_two_contact_definitions_changes_no_bit(tmp_path):
    # Both push the same nodes; a restart file has one force of both.
    settings = OFTEN + ["output.restart_interval=8 us",
                        "contacts=[{type: eroding_surface}, "
                        "{type: eroding_surface, penalty: 0.1, self_contact: false}]"]
    whole = run(ROD, tmp_path / "whole", 1, settings)
    expect_same(run(ROD, tmp_path / "many", 3, settings), whole)
    run(ROD, tmp_path / "again", 2, settings)
    expect_same(run(ROD, tmp_path / "again", 3, settings, resume=True), whole)
    run(ROD, tmp_path / "again", 1, settings)
    expect_same(run(ROD, tmp_path / "again", 1, settings, resume=True), whole)


def test_restart_with_dropped_nodes_changes_no_bit(tmp_path):
    settings = OFTEN + ["output.restart_interval=8 us", "checks.free_nodes=drop"]
    whole = run(ROD, tmp_path, 2, settings)
    expect_same(run(ROD, tmp_path, 3, settings, resume=True), whole)


@pytest.mark.parametrize("ranks", [2, 5])
def test_dropped_nodes_are_the_same_and_accounted_for(tmp_path, ranks):
    settings = OFTEN + ["checks.free_nodes=drop"]
    one = run(ROD, tmp_path / "one", 1, settings)
    expect_same(run(ROD, tmp_path / "more", ranks, settings), one)
    mass = one.summary["mass"]
    assert mass["dropped"] > 0.0 and any(one.summary["momentum"]["eroded"])
    assert abs(mass["live"] + mass["free_nodes"] + mass["dropped"] - mass["initial"]) <= 1e-14 * mass["initial"]


@pytest.mark.parametrize("ranks", [1, 3])
def test_candidates_without_dropped_nodes_are_those_of_a_new_search(tmp_path, ranks):
    settings = OFTEN + ["checks.free_nodes=drop"]
    kept_up = run(ROD, tmp_path / "kept_up", ranks, settings)
    searched = run(ROD, tmp_path / "searched", ranks, settings + ["contacts.0.search_interval=1"])
    assert kept_up.summary["eroded"]["elements"] > 20
    assert kept_up.summary["state_hash"] == searched.summary["state_hash"]


def momentum_error(summary):
    """What is missing from the balance of momentum, over the greatest momentum in it."""
    m = summary["momentum"]
    missing = [f + e - i - x for f, e, i, x in zip(m["final"], m["eroded"], m["initial"], m["external_impulse"])]
    greatest = max(math.hypot(*m[k]) for k in ("final", "initial", "external_impulse"))
    return math.hypot(*missing) / greatest


@pytest.mark.parametrize("settings", [[], ["checks.free_nodes=drop"], SINGLE])
def test_momentum_is_conserved_to_round_off(tmp_path, settings):
    # A step rounds a node's momentum by half a unit in the last place, 1e-16; random over thousands of nodes and
    # hundreds of steps these add up to about 1e-13 of the whole.
    error = momentum_error(run(ROD, tmp_path, 1, settings).summary)
    print(f"momentum error {error:.2e}")
    assert error < 1e-12


def test_momentum_against_a_wall_is_conserved_to_round_off(taylor):
    assert momentum_error(taylor.summary) < 1e-12


@pytest.mark.parametrize("ranks", [2, 3, 5])
@pytest.mark.parametrize("partitioner, limit", [("zoltan_rcb", 1.05), ("zoltan_hsfc", 1.05), ("zoltan_graph", 1.05)])
def test_rebalancing_reaches_balance(tmp_path, ranks, partitioner, limit):
    results = run(ROD, tmp_path, ranks, OFTEN + partitioned(partitioner))
    after = [r["imbalance_after"] for r in results.summary["rebalances"]]
    assert len(after) > 10
    assert max(after) < limit


def test_ranks_without_elements_and_without_live_elements_work(tmp_path):
    case = [tmp_path / "eight.yaml"]
    case[0].write_text(EIGHT)
    one = run(case, tmp_path / "one")
    eroded = set(one.eroded_ids())
    # With five ranks and no partitioner the elements stay where they are generated: 0 1, 2 3, 4 5, 6, 7.
    assert any(set(ids) <= eroded for ids in ([0, 1], [2, 3], [4, 5], [6], [7]))
    for ranks in (2, 3, 5):
        expect_same(run(case, tmp_path / f"{ranks}", ranks), one)
        moved = run(case, tmp_path / f"{ranks}_moved", ranks, partitioned("zoltan_rcb") + ["balance.force_interval=5"])
        expect_same(moved, one)


@pytest.mark.parametrize("precision", ["double", "single"])
def test_a_run_whose_last_element_erodes_goes_on_with_free_nodes(tmp_path, precision):
    case = [tmp_path / "eight.yaml", f"precision={precision}"]
    case[0].write_text(EIGHT.replace("limit: 0.25", "limit: 0.01"))
    one = run(case, tmp_path / "one")
    assert one.summary["exit"] == "completed"
    assert one.summary["eroded"]["elements"] == 8
    assert one.summary["mass"]["live"] == 0.0
    for ranks in (2, 5):
        expect_same(run(case, tmp_path / f"{ranks}", ranks, ["balance.force_interval=5"]), one)
