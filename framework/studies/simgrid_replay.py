"""Writes a program of virtual ranks for the replay of SimGrid (SMPI), with the same network, and runs the replay.

SimGrid is another engine for the same question. The check compares the two; nothing else needs SimGrid. It shares
links between messages that are under way at once, where LogGP sends one after the other.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np

import program as prog
from loggp import Network

SLOWER = 1.0e6  # the replay prints whole microseconds, so all its times are longer by this factor
FLOPS = 1.0e6  # of a host: one operation of a trace is a microsecond of the replay, a picosecond of the model
BYTE = 6  # the number of MPI_BYTE in a trace


class Unfit(ValueError):
    """A network that the replay cannot be given the same way."""


def find_smpirun() -> str | None:
    return shutil.which("smpirun")


class Traces:
    """The lines of every rank."""

    def __init__(self, n_ranks: int):
        self.lines: list[list[str]] = [[f"{r} init"] for r in range(n_ranks)]
        self.tag = 0

    def exchange(self, messages: prog.Messages, item_bytes: int) -> None:
        """Receives, sends in order, wait for all, of the ranks that take part."""
        sizes = messages.items * item_bytes
        self.tag += 1
        for i in np.lexsort((messages.source, messages.destination)):
            r, s = messages.destination[i], messages.source[i]
            self.lines[r].append(f"{r} irecv {s} {self.tag} {sizes[i]} {BYTE}")
        for s, r, n in zip(messages.source, messages.destination, sizes):
            self.lines[s].append(f"{s} isend {r} {self.tag} {n} {BYTE}")
        for r in np.union1d(messages.source, messages.destination):
            self.lines[r].append(f"{r} waitall")

    def all_to_all_v(self, messages: prog.Messages, item_bytes: int, algorithm: str) -> None:
        n_ranks = len(self.lines)
        for rounds, n_bytes in prog.counts_by_bruck(n_ranks):
            self.exchange(rounds, n_bytes)
        if algorithm == "linear":
            self.exchange(prog.to_all(messages, n_ranks), item_bytes)
            return
        for pairs in prog.pairwise(messages, n_ranks):
            self.exchange(pairs, item_bytes)

    def compute(self, seconds: np.ndarray) -> None:
        for r, t in enumerate(seconds):
            if t > 0.0:
                self.lines[r].append(f"{r} compute {t * SLOWER * FLOPS:.0f}")


def write_traces(program: prog.Program, network: Network, folder: Path) -> Path:
    """One trace per rank, and the list of them, which smpirun reads. Collectives are written as their messages."""
    t = Traces(program.n_ranks)
    make = {"recursive_doubling": prog.recursive_doubling, "tree": prog.reduce_and_broadcast}
    reduction = make[network.allreduce_of(program.n_ranks)](program.n_ranks)
    barrier = prog.dissemination(program.n_ranks)
    for step in program.steps:
        match step:
            case prog.Compute(_, seconds):
                t.compute(seconds)
            case prog.Exchange(_, messages, item_bytes):
                t.exchange(messages, item_bytes)
            case prog.Allreduce(_, n_bytes):
                for messages in reduction:
                    t.exchange(messages, n_bytes)
            case prog.Consensus(_, messages, item_bytes):
                t.exchange(messages, item_bytes)
                t.exchange(messages.back(), 0)  # the acknowledgement of a synchronous send
                for messages in barrier:
                    t.exchange(messages, 1)
            case prog.AllToAllV(_, messages, item_bytes):
                t.all_to_all_v(messages, item_bytes, network.all_to_all_of(program.n_ranks))
    names = []
    for r, lines in enumerate(t.lines):
        names.append(folder / f"rank_{r}.tit")
        names[-1].write_text("\n".join([*lines, f"{r} finalize", ""]))
    listing = folder / "traces.txt"
    listing.write_text("".join(f"{name}\n" for name in names))
    return listing


def write_platform(network: Network, n_ranks: int, folder: Path) -> tuple[Path, Path]:
    """A host per rank with a link out and a link in, through a switch that never tires."""
    if network.ranks_per_node != 1 or network.between.gap > 0.0:
        raise Unfit("the replay has one rank per host and no gap between messages; expected ranks_per_node 1 and gap 0")
    link = network.between
    bandwidth = 1.0 / (max(link.gap_per_byte, 1.0e-18) * SLOWER)
    rows = ['<?xml version="1.0"?>', '<!DOCTYPE platform SYSTEM "https://simgrid.org/simgrid.dtd">',
            '<platform version="4.1">',
            f'<cluster id="cluster" prefix="host" suffix="" radical="0-{n_ranks - 1}" speed="{FLOPS:.0f}f" '
            f'bw="{bandwidth:.6e}Bps" lat="{link.latency * SLOWER / 2.0:.6e}s" sharing_policy="SPLITDUPLEX"/>',
            "</platform>", ""]
    platform, hosts = folder / "platform.xml", folder / "hosts.txt"
    platform.write_text("\n".join(rows))
    hosts.write_text("".join(f"host{r}\n" for r in range(n_ranks)))
    return platform, hosts


def options(network: Network) -> list[str]:
    """The same overheads, latency and protocol. Latency counts three times where a message asks first."""
    link, limit = network.between, min(network.eager_limit + 1, 1 << 30)
    copying = f"{link.overhead_per_byte * SLOWER:.6e}"
    sending = f"0:{link.send_overhead * SLOWER:.6e}:{copying}"
    receiving = f"0:{link.receive_overhead * SLOWER:.6e}:{copying}"
    handshake = 3.0 + 2.0 * (link.send_overhead + link.receive_overhead) / link.latency if link.latency else 1.0
    settings = {"network/model": "SMPI", "network/TCP-gamma": "0", "network/crosstraffic": "0",
                "network/weight-S": "0", "smpi/bw-factor": "0:1", "smpi/lat-factor": f"0:1;{limit}:{handshake:.6f}",
                "smpi/async-small-thresh": f"{limit}", "smpi/send-is-detached-thresh": f"{limit}",
                "smpi/os": sending, "smpi/ois": sending, "smpi/or": receiving, "smpi/wtime": "0", "smpi/init": "0",
                "surf/precision": "1e-9"}
    return [f"--cfg={key}:{value}" for key, value in settings.items()]


def replay(program: prog.Program, network: Network, folder: Path, smpirun: str) -> float:
    """The time at which the last rank is done, by SimGrid [s]."""
    traces = write_traces(program, network, folder)
    platform, hosts = write_platform(network, program.n_ranks, folder)
    command = [smpirun, "-np", str(program.n_ranks), "-platform", str(platform), "-hostfile", str(hosts), "-replay",
               str(traces), *options(network), "--log=replay.thresh:critical", "--log=smpi_replay.thresh:info"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder, check=False)
    text = done.stdout + done.stderr
    time = re.search(r"Simulation time ([0-9.eE+-]+)", text)
    if done.returncode != 0 or time is None:
        raise RuntimeError(f"smpirun ended with code {done.returncode}:\n{text[-3000:]}")
    return float(time.group(1)) / SLOWER
