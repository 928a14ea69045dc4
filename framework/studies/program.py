"""What virtual ranks do, one step after the other: compute, exchange messages, reduce. No clock in here.

A program is a list of steps. `loggp.Clock` advances the clocks of the ranks through it; `simgrid_replay.write_traces`
writes it down for another engine. Both read the same program, so they can be compared.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np


class Messages:
    """Which ranks send how many items to which ranks, in the order in which each rank sends: by destination."""

    def __init__(self, source, destination, items):
        source, destination = np.asarray(source, dtype=np.int64), np.asarray(destination, dtype=np.int64)
        items = np.asarray(items, dtype=np.int64)
        if not len(source) == len(destination) == len(items):
            raise ValueError(f"{len(source)} sources, {len(destination)} destinations and {len(items)} numbers of "
                             "items; expected as many of each")
        if np.any(source == destination):
            raise ValueError("a rank sends a message to itself; expected messages between different ranks")
        order = np.lexsort((destination, source))
        self.source, self.destination, self.items = source[order], destination[order], items[order]
        if np.any((np.diff(self.source) == 0) & (np.diff(self.destination) == 0)):
            raise ValueError("two messages from the same rank to the same rank; expected one with all items")

    def __len__(self) -> int:
        return len(self.source)

    def back(self) -> Messages:
        """The answers: the same items the other way."""
        return Messages(self.destination, self.source, self.items)

    def neighbours(self, n_ranks: int) -> np.ndarray:
        """To how many ranks each rank sends."""
        return np.bincount(self.source, minlength=n_ranks)


def no_messages() -> Messages:
    return Messages([], [], [])


def joined(*lists: tuple[Messages, int], header: int = 0) -> Messages:
    """One message where any list of messages, each with the bytes of its items, has one. Its items are all bytes."""
    n_ranks = 1 + max((int(v.max()) for m, _ in lists for v in (m.source, m.destination) if len(v)), default=0)
    keys = np.concatenate([m.source * n_ranks + m.destination for m, _ in lists])
    n_bytes = np.concatenate([m.items * item_bytes for m, item_bytes in lists])
    different, place = np.unique(keys, return_inverse=True)
    total = np.bincount(place, weights=n_bytes, minlength=len(different)).astype(np.int64) + header
    return Messages(different // n_ranks, different % n_ranks, total)


@dataclass(frozen=True, eq=False)
class Compute:
    """Each rank works for its own time [s]."""
    phase: str
    seconds: np.ndarray


@dataclass(frozen=True, eq=False)
class Exchange:
    """Each rank posts its receives, sends its messages in order of destination, and waits for all."""
    phase: str
    messages: Messages
    item_bytes: int


@dataclass(frozen=True)
class Allreduce:
    phase: str
    n_bytes: int


@dataclass(frozen=True, eq=False)
class Consensus:
    """An exchange whose receivers do not know who will send: non-blocking consensus of Hoefler et al. (2010)."""
    phase: str
    messages: Messages
    item_bytes: int


@dataclass(frozen=True, eq=False)
class AllToAllV:
    """An all-to-all of counts, then of the messages themselves."""
    phase: str
    messages: Messages
    item_bytes: int


Step = Compute | Exchange | Allreduce | Consensus | AllToAllV


@dataclass
class Program:
    """The steps of one or more cycles on a number of ranks."""
    n_ranks: int
    steps: list[Step] = field(default_factory=list)

    def compute(self, phase: str, seconds) -> None:
        seconds = np.asarray(seconds, dtype=float)
        if seconds.shape != (self.n_ranks,):
            raise ValueError(f"times of the phase {phase} of shape {seconds.shape}; expected one for each of the "
                             f"{self.n_ranks} ranks")
        if not np.all(seconds >= 0.0):
            raise ValueError(f"a time of the phase {phase} is negative or not a number; expected at least 0 s")
        self.steps.append(Compute(phase, seconds))

    def exchange(self, phase: str, messages: Messages, item_bytes: int) -> None:
        self.steps.append(Exchange(phase, messages, item_bytes))

    def allreduce(self, phase: str, n_bytes: int) -> None:
        self.steps.append(Allreduce(phase, n_bytes))

    def consensus(self, phase: str, messages: Messages, item_bytes: int) -> None:
        self.steps.append(Consensus(phase, messages, item_bytes))

    def all_to_all_v(self, phase: str, messages: Messages, item_bytes: int) -> None:
        self.steps.append(AllToAllV(phase, messages, item_bytes))


@dataclass
class Traffic:
    """What the ranks say in a program."""
    messages: float = 0.0  # of all ranks
    n_bytes: float = 0.0  # of all ranks, with what each hands to collective operations
    collectives: float = 0.0  # of each rank; a sparse consensus has one

    def add(self, other: Traffic, weight: float) -> None:
        self.messages += weight * other.messages
        self.n_bytes += weight * other.n_bytes
        self.collectives += weight * other.collectives

    def over(self, n: float) -> Traffic:
        return Traffic(self.messages / n, self.n_bytes / n, self.collectives / n)


def traffic_of(program: Program) -> Traffic:
    """As the library kerf_message_counts counts: what the program hands to MPI, not what MPI makes of it."""
    traffic = Traffic()
    for step in program.steps:
        if isinstance(step, Allreduce):
            traffic.collectives += 1
            traffic.n_bytes += step.n_bytes * program.n_ranks
        elif isinstance(step, AllToAllV):
            traffic.collectives += 2
            traffic.n_bytes += 4 * program.n_ranks**2 + int(step.messages.items.sum()) * step.item_bytes
        elif isinstance(step, Exchange | Consensus):
            traffic.collectives += isinstance(step, Consensus)
            traffic.messages += len(step.messages)
            traffic.n_bytes += int(step.messages.items.sum()) * step.item_bytes
    return traffic


def recursive_doubling(n_ranks: int) -> list[Messages]:
    """The rounds of an allreduce: ranks beyond the greatest power of two hand over to a neighbour first."""
    power = 1 << (n_ranks.bit_length() - 1)
    extra = n_ranks - power
    rounds = []
    handing, taking = np.arange(0, 2 * extra, 2), np.arange(1, 2 * extra, 2)
    members = np.concatenate([taking, np.arange(2 * extra, n_ranks)])
    if extra:
        rounds.append(Messages(handing, taking, np.ones(extra)))
    place = np.arange(power)
    for bit in range(power.bit_length() - 1):
        rounds.append(Messages(members, members[place ^ (1 << bit)], np.ones(power)))
    if extra:
        rounds.append(Messages(taking, handing, np.ones(extra)))
    return rounds


def reduce_and_broadcast(n_ranks: int) -> list[Messages]:
    """The rounds of an allreduce over a binomial tree: to rank 0, and back."""
    up = []
    for bit in range((n_ranks - 1).bit_length()):
        sender = np.arange(1 << bit, n_ranks, 2 << bit)
        up.append(Messages(sender, sender - (1 << bit), np.ones(len(sender))))
    return up + [m.back() for m in reversed(up)]


def dissemination(n_ranks: int) -> list[Messages]:
    """The rounds of a barrier: each rank tells the one 1, 2, 4, ... ranks ahead."""
    ranks = np.arange(n_ranks)
    return [Messages(ranks, (ranks + (1 << bit)) % n_ranks, np.ones(n_ranks))
            for bit in range((n_ranks - 1).bit_length())]


def counts_by_bruck(n_ranks: int) -> list[tuple[Messages, int]]:
    """The rounds of an all-to-all of one count of four bytes, and the bytes of each message."""
    ranks = np.arange(n_ranks)
    return [(messages, 4 * int(np.count_nonzero(ranks >> bit & 1)))
            for bit, messages in enumerate(dissemination(n_ranks))]


def pairwise(messages: Messages, n_ranks: int) -> Iterator[Messages]:
    """The steps of an all-to-all: in step k to the rank k ahead, from the rank k behind, with or without items."""
    ranks = np.arange(n_ranks)
    distance = (messages.destination - messages.source) % n_ranks
    order = np.argsort(distance, kind="stable")
    at = np.searchsorted(distance[order], np.arange(1, n_ranks + 1))
    for step in range(1, n_ranks):
        items = np.zeros(n_ranks, dtype=np.int64)
        some = order[at[step - 1]:at[step]]
        items[messages.source[some]] = messages.items[some]
        yield Messages(ranks, (ranks + step) % n_ranks, items)


def to_all(messages: Messages, n_ranks: int) -> Messages:
    """A message from every rank to every other, most of them without items."""
    items = np.zeros((n_ranks, n_ranks), dtype=np.int64)
    items[messages.source, messages.destination] = messages.items
    source, destination = np.nonzero(~np.eye(n_ranks, dtype=bool))
    return Messages(source, destination, items[source, destination])
