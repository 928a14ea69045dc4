"""Messages of virtual ranks against those that Kerf sends, which the library kerf_message_counts has counted."""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from predict_scenes import block

import cycle
from program import Allreduce, Exchange, Messages, Program, no_messages
from virtual_ranks import ContactScene, VirtualRanks, no_contact, share_out

HERE = Path(__file__).resolve().parent
LIBRARY = Path(os.environ.get("KERF_BUILD_DIR", "")) / "lib" / "libkerf_message_counts.so"
pytestmark = pytest.mark.skipif(not LIBRARY.is_file(), reason=f"{LIBRARY} has not been built")


def counts_of(case, n_ranks, folder):
    """What each rank has counted."""
    environment = {**os.environ, "KERF_MESSAGE_COUNTS": str(folder / "counts")}
    command = ["mpirun", "--oversubscribe", "-n", str(n_ranks), "-x", "KERF_MESSAGE_COUNTS", "-x",
               f"LD_PRELOAD={LIBRARY}",
               os.environ["KERF_BINARY"], "run", str(HERE / case), "--output", str(folder / "out")]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    return [json.loads((folder / f"counts.{r}.json").read_text()) for r in range(n_ranks)]


def sent_by(program, rank):
    """Messages, and bytes of messages and reductions, that a rank sends in a program."""
    n, n_bytes = 0, 0
    for step in program.steps:
        if isinstance(step, Exchange):
            mine = step.messages.source == rank
            n += int(mine.sum())
            n_bytes += int(step.messages.items[mine].sum()) * step.item_bytes
        elif isinstance(step, Allreduce):
            n_bytes += step.n_bytes
    return n, n_bytes


@pytest.mark.parametrize("n_ranks", [4, 7])
def test_a_block_without_contact_sends_what_its_virtual_ranks_send(n_ranks, tmp_path):
    mesh = block(10, 8, 12)
    n = len(mesh.cells)
    sizes = [n // n_ranks + (r < n % n_ranks) for r in range(n_ranks)]
    ranks = share_out(mesh, np.repeat(np.arange(n_ranks), sizes), n_ranks)
    program = Program(n_ranks)
    cycle.add_cycle(program, ranks, mesh, cycle.CycleWork(np.zeros(n), no_contact()))
    for rank, counted in enumerate(counts_of("predict_block.yaml", n_ranks, tmp_path)):
        for number, collectives, messages, n_bytes, _ in counted["cycles"][1:-1]:
            assert (collectives, messages, n_bytes) == (1, *sent_by(program, rank)), f"rank {rank}, cycle {number}"


def contact_program(n_active, rounds):
    """A cycle in which rank 0 looks at nodes of rank 1. Its halo has messages, but nothing in them."""
    none, one = np.zeros(0, dtype=int), np.zeros(1, dtype=int)
    ranks = VirtualRanks(2, none, none, np.zeros(2), np.zeros(2), Messages([0, 1], [1, 0], [0, 0]), no_messages(),
                         contact_rank=one, contact_pull=Messages([1], [0], [1]),
                         contact_told=Messages([0], [1], [n_active]), contact_active=Messages([1], [0], [n_active]))
    scene = ContactScene(one, np.zeros((0, 4), dtype=int), none, none, none.astype(bool), np.zeros(1), np.zeros(1))
    program = Program(2)
    cycle.add_cycle(program, ranks, None, cycle.CycleWork(np.zeros(0), scene, rounds=rounds))
    return program


def test_the_rounds_of_an_impact_send_what_a_program_sends(tmp_path):
    """Rank 0 looks at all that touches: found by its messages, of which each round has one up and none down."""
    counted = counts_of("predict_impact.yaml", 2, tmp_path)[0]
    cycles = np.array([row[:4] for row in counted["cycles"]])
    without = cycles[(cycles[:, 1] == 1) & (cycles[:, 2] == 4)]
    assert len(without) > 0, "no cycle without touches; expected some before the impact"
    halo = int(without[0, 3])  # of the halo, the reduction and an empty word of who looks
    some = 0
    for number, collectives, messages, n_bytes in cycles:
        if collectives != 1 or messages < 20:
            continue
        rounds = 3 * (int(messages) - 4) // 4  # three of the halo, one to tell, one each of the sums, one at the end
        if (messages - 4) % 4 != 0:
            continue  # boxes were renewed, which has messages of its own
        _, bytes_of_one = sent_by(contact_program(1, rounds), 0)
        active, rest = divmod(int(n_bytes) - halo, bytes_of_one - cycle.Sizes().reduction - cycle.Sizes().contact_note)
        assert rest == 0, f"cycle {number}"
        assert sent_by(contact_program(active, rounds), 0)[0] == messages, f"cycle {number}"
        assert 1 <= active <= 400
        some += 1
    assert some >= 5
