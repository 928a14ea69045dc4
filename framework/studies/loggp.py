"""Advances the clocks of virtual ranks through a program by the LogGP model of a network.

A. Alexandrov, M. Ionescu, K. Schauser & C. Scheiman, "LogGP: incorporating long messages into the LogP model", SPAA
1995; queues of processor and network card as in T. Hoefler, T. Schneider & A. Lumsdaine, "LogGOPSim", LSAP 2010. No
loop over ranks or messages: every queue is a running maximum. The equations stand in doc/theory/prediction.md.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, fields, replace

import numpy as np

import program as prog
from program import Messages


MOST_LINEAR = 512  # ranks, for which every message of a linear all-to-all is followed


@dataclass(frozen=True)
class Link:
    """The LogGP parameters of one kind of way between two ranks."""
    latency: float = 0.0  # L [s]
    send_overhead: float = 0.0  # o_s: time of the processor per message [s]
    receive_overhead: float = 0.0  # o_r [s]
    gap: float = 0.0  # g: time of the network card per message [s]
    gap_per_byte: float = 0.0  # G [s/byte]
    overhead_per_byte: float = 0.0  # O: time of the processor per byte, to copy [s/byte]


@dataclass(frozen=True)
class Network:
    """A cluster: ways inside a node and between nodes, and how many ranks share a node and its link."""
    name: str
    between: Link
    inside: Link = Link()
    ranks_per_node: int = 1
    node_gap: float = 0.0  # time of the shared link of a node per message [s]
    node_gap_per_byte: float = 0.0  # time of the shared link of a node per byte [s/byte]
    eager_limit: int = 1 << 62  # [bytes]; a longer message waits for its receiver
    envelope: int = 0  # bytes that travel with every message
    allreduce: str = "open_mpi"  # as Open MPI 4.1 chooses; or "recursive_doubling", "tree"
    all_to_all: str = "open_mpi"  # as Open MPI 4.1 chooses; or "pairwise", "linear"

    def __post_init__(self):
        for link in (self.between, self.inside):
            for f in fields(link):
                if not 0.0 <= getattr(link, f.name) < np.inf:
                    raise ValueError(f"network {self.name}: {f.name} is {getattr(link, f.name)}; expected a finite "
                                     "number, at least 0")
        if self.ranks_per_node < 1:
            raise ValueError(f"network {self.name}: ranks_per_node is {self.ranks_per_node}; expected at least 1")
        for key, known in (("allreduce", ("open_mpi", "recursive_doubling", "tree")),
                           ("all_to_all", ("open_mpi", "pairwise", "linear"))):
            if getattr(self, key) not in known:
                raise ValueError(f"network {self.name}: {key} is {getattr(self, key)}; expected {' or '.join(known)}")

    def allreduce_of(self, n_ranks: int) -> str:
        """The algorithm for messages of some 100 bytes: ompi/mca/coll/tuned/coll_tuned_decision_fixed.c of 4.1."""
        if self.allreduce != "open_mpi":
            return self.allreduce
        return "recursive_doubling" if n_ranks < 128 else "tree"

    def all_to_all_of(self, n_ranks: int) -> str:
        """The algorithm of an all-to-all with counts, from the same file, which asks only for the number of ranks."""
        if self.all_to_all != "open_mpi":
            return self.all_to_all
        return "pairwise" if n_ranks < 4 or 64 <= n_ranks < 128 or 256 <= n_ranks < 1024 else "linear"


def ideal(network: Network) -> Network:
    """The same cluster with messages that take no time: what is left is waiting for each other."""
    return replace(network, name=f"ideal {network.name}", between=Link(), inside=Link(), node_gap=0.0,
                   node_gap_per_byte=0.0, eager_limit=1 << 62)


def serve(arrival: np.ndarray, queue: np.ndarray, service: np.ndarray, in_order: bool = False) -> np.ndarray:
    """When each item begins to be served, by a server per queue that takes one at a time, first come first served.

    begin_i = max(arrival_i, begin_(i-1) + service_(i-1)) = B_i + max over j <= i of (arrival_j - B_j), where B_i is the
    service of all before i. The maximum runs over all queues at once: each is lifted above the one before it.
    `in_order`: the items stand in the order of their queues already, and each queue serves them as they stand.
    """
    if len(arrival) == 0:
        return arrival.copy()
    low = arrival.min()
    if in_order:
        order = slice(None)
    else:
        order = np.argsort(queue * (1.001 * (arrival.max() - low) + 1e-9) + (arrival - low), kind="stable")
    a, q, s = arrival[order] - low, queue[order], service[order]
    first = np.empty(len(q), dtype=bool)
    first[0] = True
    np.not_equal(q[1:], q[:-1], out=first[1:])
    before = np.cumsum(s)
    before -= s
    number = np.cumsum(first) - 1
    before -= before[first][number]
    lag = a - before
    lift = number * (lag.max() - lag.min() + 1e-9)
    begin = np.maximum.accumulate(lag + lift) - lift + before
    begin = np.maximum(begin, a) + low  # what the lift has rounded off
    if in_order:
        return begin
    result = np.empty_like(begin)
    result[order] = begin
    return result


class Way:
    """What never changes about a set of messages on a network: who queues where, and for how long."""

    def __init__(self, network: Network, n_ranks: int, messages: Messages, item_bytes: int):
        m = messages
        self.source, self.destination = m.source, m.destination
        n_bytes = m.items * item_bytes + network.envelope
        inside = m.source // network.ranks_per_node == m.destination // network.ranks_per_node
        inside &= network.ranks_per_node > 1

        def of(name: str) -> np.ndarray:
            return np.where(inside, getattr(network.inside, name), getattr(network.between, name))

        self.latency = of("latency")
        self.transfer = n_bytes * of("gap_per_byte")
        self.card = of("gap") + self.transfer  # how long it keeps the card of a rank busy
        copying = n_bytes * of("overhead_per_byte")
        self.sending, self.receiving = of("send_overhead") + copying, of("receive_overhead") + copying
        total = np.cumsum(self.sending)
        starts = np.flatnonzero(np.diff(m.source, prepend=-1)) if len(m) else np.zeros(0, dtype=np.int64)
        lengths = np.diff(np.append(starts, len(m)))
        self.sent = total - np.repeat((total - self.sending)[starts], lengths)  # since the first send of its rank
        self.all_sent = np.bincount(m.source, weights=self.sending, minlength=n_ranks)
        self.rendezvous = np.flatnonzero(m.items * item_bytes > network.eager_limit)
        self.handshake = of("latency") + of("send_overhead") + of("receive_overhead")
        self.one_to_each = len(np.unique(m.destination)) == len(m)
        self.one_from_each = len(starts) == len(m)
        # Messages between nodes also pass the one link of their node, out and in.
        self.far = np.flatnonzero(~inside) if network.ranks_per_node > 1 else np.zeros(0, dtype=np.int64)
        self.from_node = m.source[self.far] // network.ranks_per_node
        self.to_node = m.destination[self.far] // network.ranks_per_node
        in_node = n_bytes[self.far] * network.node_gap_per_byte
        self.node_service = network.node_gap + in_node
        self.transfer[self.far] = np.maximum(self.transfer[self.far], in_node)  # the slowest link sets the pace


class Clock:
    """The clocks of all ranks [s], and what their time went into."""

    def __init__(self, network: Network, n_ranks: int):
        self.network, self.n_ranks = network, n_ranks
        self.time = np.zeros(n_ranks)
        self.useful: dict[str, np.ndarray] = defaultdict(lambda: np.zeros(n_ranks))  # computing, by phase [s]
        self.spent: dict[str, np.ndarray] = defaultdict(lambda: np.zeros(n_ranks))  # computing and communicating
        n_nodes = -(-n_ranks // network.ranks_per_node)
        self.card_out, self.card_in = np.zeros(n_ranks), np.zeros(n_ranks)  # when they are free again [s]
        self.node_out, self.node_in = np.zeros(n_nodes), np.zeros(n_nodes)
        self.ways: dict[tuple[int, int], tuple[Messages, Way]] = {}
        self.rounds: dict[str, list[Messages]] = {}
        self.counts: list[tuple[Messages, int]] | None = None

    def state(self) -> list[np.ndarray]:
        """When ranks, cards and links are free; without what the time went into."""
        return [v.copy() for v in (self.time, self.card_out, self.card_in, self.node_out, self.node_in)]

    def set_state(self, state: list[np.ndarray]) -> None:
        self.time, self.card_out, self.card_in, self.node_out, self.node_in = (v.copy() for v in state)

    def run(self, program: prog.Program) -> np.ndarray:
        """Runs the steps; returns the clocks at the end."""
        if program.n_ranks != self.n_ranks:
            raise ValueError(f"a program for {program.n_ranks} ranks on clocks of {self.n_ranks}")
        for step in program.steps:
            before = self.time.copy()
            match step:
                case prog.Compute(phase, seconds):
                    self.time = self.time + seconds
                    self.useful[phase] += seconds
                case prog.Exchange(phase, messages, item_bytes):
                    self.exchange(messages, item_bytes)
                case prog.Allreduce(phase, n_bytes):
                    for messages in self.rounds_of(self.network.allreduce_of(self.n_ranks)):
                        self.exchange(messages, n_bytes)
                case prog.Consensus(phase, messages, item_bytes):
                    self.consensus(messages, item_bytes)
                case prog.AllToAllV(phase, messages, item_bytes):
                    self.all_to_all_v(messages, item_bytes)
            self.spent[step.phase] += self.time - before
        return self.time

    def rounds_of(self, algorithm: str) -> list[Messages]:
        make = {"recursive_doubling": prog.recursive_doubling, "tree": prog.reduce_and_broadcast,
                "dissemination": prog.dissemination}[algorithm]
        if algorithm not in self.rounds:
            self.rounds[algorithm] = make(self.n_ranks)
        return self.rounds[algorithm]

    def way(self, messages: Messages, item_bytes: int) -> Way:
        key = (id(messages), item_bytes)
        if key not in self.ways:
            # The messages are kept with their way, because an id is unique only among objects that are alive.
            self.ways[key] = (messages, Way(self.network, self.n_ranks, messages, item_bytes))
        return self.ways[key][1]

    def exchange(self, messages: Messages, item_bytes: int) -> np.ndarray:
        """Posts receives, sends all, waits for all. Returns when each message has been received [s]."""
        if len(messages) == 0:
            return np.zeros(0)
        return self.carry(self.way(messages, item_bytes))

    def carry(self, w: Way) -> np.ndarray:
        posted = self.time
        sent = posted + w.all_sent  # when each rank begins to wait
        ready = posted[w.source] + w.sent
        if len(w.rendezvous):  # the request to send, and the answer once the receive is posted
            r = w.rendezvous
            asked = np.maximum(ready[r] + w.handshake[r], posted[w.destination[r]])
            ready[r] = np.maximum(asked + w.handshake[r], sent[w.source[r]])
        out = self.inject(w, ready)
        if len(w.rendezvous):  # the sender waits until the data have gone
            sent = sent.copy()
            np.maximum.at(sent, w.source[r], out[r] + w.transfer[r])
        delivered = self.deliver(w, out + w.latency)
        received = self.receive(w, np.maximum(delivered, sent[w.destination]))
        self.time = sent.copy() if sent is not posted else sent
        np.maximum.at(self.time, w.destination, received)
        return received

    def inject(self, w: Way, ready: np.ndarray) -> np.ndarray:
        """When the card of the sender, and the link of its node, begin with each message."""
        ready = np.maximum(ready, self.card_out[w.source])
        if w.one_from_each:
            out = ready
        else:
            out = serve(ready, w.source, w.card, in_order=len(w.rendezvous) == 0)
        np.maximum.at(self.card_out, w.source, out + w.card)
        if len(w.far):
            out = out.copy()
            out[w.far] = serve(np.maximum(out[w.far], self.node_out[w.from_node]), w.from_node, w.node_service)
            np.maximum.at(self.node_out, w.from_node, out[w.far] + w.node_service)
        return out

    def deliver(self, w: Way, arrival: np.ndarray) -> np.ndarray:
        """When the last byte of each message has passed the link of the node and the card of the receiver."""
        if len(w.far):
            arrival[w.far] = serve(np.maximum(arrival[w.far], self.node_in[w.to_node]), w.to_node, w.node_service)
            np.maximum.at(self.node_in, w.to_node, arrival[w.far] + w.node_service)
        arrival = np.maximum(arrival, self.card_in[w.destination])
        begin = arrival if w.one_to_each else serve(arrival, w.destination, w.card)
        np.maximum.at(self.card_in, w.destination, begin + w.card)
        return begin + w.transfer

    @staticmethod
    def receive(w: Way, delivered: np.ndarray) -> np.ndarray:
        """When the processor of the receiver has taken each message, in the order in which they come."""
        begin = delivered if w.one_to_each else serve(delivered, w.destination, w.receiving)
        return begin + w.receiving

    def barrier(self) -> None:
        for messages in self.rounds_of("dissemination"):
            self.exchange(messages, 1)

    def consensus(self, messages: Messages, item_bytes: int) -> None:
        """Synchronous sends; who knows that all his have been taken enters a barrier; its end says that all have."""
        if len(messages):
            w = self.way(messages, item_bytes)
            received = self.carry(w)
            acknowledged = received + w.latency
            np.maximum.at(self.time, w.source, acknowledged)
        self.barrier()

    def all_to_all_v(self, messages: Messages, item_bytes: int) -> None:
        """Counts by the algorithm of Bruck, then data: pairwise, where every rank meets every other, or all at once."""
        if self.n_ranks == 1:
            return
        if self.counts is None:
            self.counts = prog.counts_by_bruck(self.n_ranks)
        for rounds, n_bytes in self.counts:
            self.exchange(rounds, n_bytes)
        if self.network.all_to_all_of(self.n_ranks) == "linear":
            self.linear(messages, item_bytes)
            return
        for pairs in prog.pairwise(messages, self.n_ranks):
            self.carry(Way(self.network, self.n_ranks, pairs, item_bytes))

    def linear(self, messages: Messages, item_bytes: int) -> None:
        """A message from everybody to everybody, most of them empty."""
        if self.n_ranks <= MOST_LINEAR:
            self.carry(Way(self.network, self.n_ranks, prog.to_all(messages, self.n_ranks), item_bytes))
            return
        # The greatest of three bounds: messages with items alone, the processor's work, and the last message of all.
        start, link = self.time, self.network.between
        self.exchange(messages, item_bytes)
        n_bytes = messages.items * item_bytes * link.overhead_per_byte
        copying = sum(np.bincount(side, weights=n_bytes, minlength=self.n_ranks)
                      for side in (messages.source, messages.destination))
        others = self.n_ranks - 1
        busy = start + others * (link.send_overhead + link.receive_overhead) + copying
        last = start.max() + others * link.send_overhead + link.latency + link.receive_overhead
        self.time = np.maximum(np.maximum(self.time, busy), last)
