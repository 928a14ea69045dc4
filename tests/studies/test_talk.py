"""How often ranks of a whole model talk to all others: collective operations per cycle."""

import os
import subprocess
from pathlib import Path

import pytest
from study_case import KERF, ROOT

import message_counts

LIBRARY = KERF.parent.parent / "lib" / "libkerf_message_counts.so"
COARSE_ROD = ("parts.plate.mesh.cell_size=1.6 mm", "parts.rod.mesh.core_cells=2", "parts.rod.mesh.ring_cells=1",
              "parts.rod.mesh.axial_cells=48", "time.maximum_cycles=150")


def counted(folder: Path, case: str, ranks: int, *settings: str) -> tuple[dict, list[dict]]:
    """Counts per cycle of a run, and the books of its ranks."""
    path = folder / "counts"
    command = ["mpirun", "-n", str(ranks), "--oversubscribe", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1",
               "env", f"LD_PRELOAD={LIBRARY}", f"KERF_MESSAGE_COUNTS={path}", str(KERF), "run",
               str(ROOT / "inputs" / case), "--output", str(folder / "out")]
    for setting in settings:
        command += ["--set", setting]
    environment = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    done = subprocess.run(command, capture_output=True, text=True, timeout=900, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    counts = message_counts.counts_of(folder / "out", path, ranks)
    return counts["per_cycle"], message_counts.read_ranks(path, ranks)


@pytest.mark.parametrize("ranks", [2, 3])
def test_a_rod_through_a_plate_talks_to_all_once_or_twice_a_cycle(tmp_path, ranks):
    """Once for the step; once more where elements die. A complete search of contact, every 50 cycles, takes five."""
    per_cycle, _ = counted(tmp_path, "oblique_rod_full/oblique_rod_full.yaml", ranks, *COARSE_ROD)
    assert per_cycle["eroding"]["cycles"] >= 50 and per_cycle["others"]["cycles"] >= 50
    assert per_cycle["others"]["collectives"]["median"] == 1
    assert per_cycle["eroding"]["collectives"]["median"] == 2
    assert per_cycle["all"]["collectives"]["mean"] <= 1.7


def test_a_bar_without_contact_talks_to_all_once_a_cycle(tmp_path):
    """The first cycle has two more. Looks at the imbalance would add one each, so there are none."""
    _, books = counted(tmp_path, "taylor_bar/taylor_bar.yaml", 2, "time.maximum_cycles=120",
                       "parameters.cell_size=1.06666667 mm", "balance.policy={type: never}")
    for book in books:
        assert len(book["cycles"]) == 120
        assert {cycle[1] for cycle in book["cycles"][1:]} == {1}
        assert book["cycles"][0][1] <= 3
