"""Time per cycle of a recorded run on many ranks, for a partitioner, a policy of re-balancing and a network."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol

import numpy as np

import cycle as cycles
import loggp
import pop
from cuts import Cuts
from program import Program, Traffic, traffic_of
from recording import Moment, Recording
from refinement import refined, refined_copies, thin_out
from virtual_ranks import VirtualRanks, copies_of, moved_elements, share_out, share_out_contact


class PartitionError(Exception):
    """Why there are no owners for a moment."""


class Partitions(Protocol):
    """Finds owners; `name` stands in tables."""
    name: str

    def owners(self, moment: int, state: Moment, n_ranks: int) -> np.ndarray: ...


class CutPartitions:
    """Recursive coordinate bisection with equal measured work on either side."""
    name = "rcb"

    def owners(self, moment: int, state: Moment, n_ranks: int) -> np.ndarray:
        return Cuts(state.mesh.centres(), state.element_seconds, n_ranks).part


class FilePartitions:
    """Owners that `kerf partition` has written: by state of the model, method and number of parts."""

    def __init__(self, path: Path, method: str):
        self.path, self.name = path, method

    def owners(self, moment: int, state: Moment, n_ranks: int) -> np.ndarray:
        """Of the last state of the file that is not later than the moment."""
        import h5py

        try:
            file = h5py.File(self.path)
        except OSError as error:
            raise PartitionError(f"{self.path}: error: the file cannot be read: {error}; expected one that kerf "
                                 "partition has written") from error
        with file:
            states = sorted((float(group.attrs["time"]), name) for name, group in file.items() if "time" in group.attrs)
            fitting = [name for time, name in states if time <= state.time * (1.0 + 1e-9)]
            if not fitting:
                raise PartitionError(f"{self.path}: error: there is no state at or before {state.time:g} s; expected "
                                     "one")
            methods = file[fitting[-1]]
            key = f"{self.name}/{n_ranks}"
            if key not in methods:
                known = ", ".join(f"{m}/{k}" for m in methods for k in methods[m])
                raise PartitionError(f"{self.path}: error: the state {fitting[-1]} has no partition {key}; expected "
                                     f"one of {known}")
            parts = methods[key][:].astype(np.int64)
        if moment == 0 and state.cycle <= 1 and np.count_nonzero(parts >= 0) != len(state.element):
            raise PartitionError(f"{self.path}: error: {np.count_nonzero(parts >= 0)} elements have a part; expected "
                                 f"those of the run, {len(state.element)}")
        if state.element.max() >= len(parts):
            raise PartitionError(f"{self.path}: error: {len(parts)} elements; expected those of the run, which has an "
                                 f"element {state.element.max()}")
        owners = parts[state.element]
        if owners.min() < 0:
            raise PartitionError(f"{self.path}: error: elements that live at {state.time:g} s have no part; expected a "
                                 "state in which they live")
        return owners


@dataclass(frozen=True)
class Policy:
    """When the mesh is shared out anew: `never`, `every` so many cycles, or at a `threshold` of imbalance."""
    kind: str = "never"
    value: float = 0.0

    @property
    def name(self) -> str:
        return self.kind if self.kind == "never" else f"{self.kind}:{self.value:g}"

    def moves(self, moment: Moment, imbalance: float) -> int:
        """How often it moves in the cycles of a moment; the first move takes place at its start."""
        if self.kind == "every":  # in the cycles whose numbers it divides
            before = max(moment.cycle - 1, 0)
            return (before + moment.n_cycles) // int(self.value) - before // int(self.value)
        return 1 if self.kind == "threshold" and imbalance > self.value else 0


def read_policy(text: str) -> Policy:
    kind, _, value = text.partition(":")
    try:
        number = float(value) if value else 0.0
    except ValueError:
        number = float("nan")
    least = {"never": 0.0, "every": 1.0, "threshold": 1.0}.get(kind)
    if least is None or not number >= least or (kind == "never" and value) or (kind == "every" and number % 1.0):
        raise ValueError(f"a policy `{text}`; expected never, every:CYCLES or threshold:IMBALANCE, both at least 1")
    return Policy(kind, number)


@dataclass
class Outcome:
    """A run on a number of ranks. Times are of one cycle, the mean over all."""
    n_ranks: int
    partitioner: str
    policy: str
    network: str
    seconds: float
    ideal_seconds: float
    phases: dict[str, float] = field(default_factory=dict)  # computing and communicating, mean over ranks [s]
    useful: dict[str, np.ndarray] = field(default_factory=dict)  # computing, per rank [s]
    moves: int = 0
    causes: dict[str, dict[str, float]] = field(default_factory=dict)
    traffic: Traffic = field(default_factory=Traffic)  # of one cycle, the mean

    def total_useful(self) -> np.ndarray:
        return np.sum(list(self.useful.values()), axis=0)


class _Sum:
    """Adds up the cycles of all moments on one network."""

    def __init__(self, n_ranks: int):
        self.n_ranks, self.seconds = n_ranks, 0.0
        self.phases: dict[str, float] = {}
        self.useful: dict[str, np.ndarray] = {}
        self.traffic = Traffic()

    def add(self, clock: loggp.Clock, weight: float, program: Program) -> None:
        """Runs one cycle on a clock that has settled; it counts `weight` times."""
        self.traffic.add(traffic_of(program), weight)
        start = clock.time.max()
        clock.spent.clear()
        clock.useful.clear()
        seconds = float(clock.run(program).max() - start)
        self.seconds += weight * seconds
        # Ranks that begin apart catch up with one another in the cycle, which in a run they do once only: the cycle has
        # less waiting than its ranks together.
        useful = {name: float(values.mean()) for name, values in clock.useful.items()}
        waiting = {name: float(values.mean()) - useful.get(name, 0.0) for name, values in clock.spent.items()}
        waits = sum(waiting.values())
        share = max(seconds - sum(useful.values()), 0.0) / waits if waits > 0.0 else 0.0
        for name, seconds_waited in waiting.items():
            booked = useful.get(name, 0.0) + share * seconds_waited
            self.phases[name] = self.phases.get(name, 0.0) + weight * booked
        for name, values in clock.useful.items():
            self.useful[name] = self.useful.get(name, np.zeros(self.n_ranks)) + weight * values


def plain_cycle(moment: Moment) -> cycles.CycleWork:
    """Without a search, erosion or migration."""
    return cycles.CycleWork(moment.element_seconds, moment.contact, moment.load_seconds, moment.erosion_seconds,
                            rounds=max(round(moment.rounds), 1), agreements=max(round(moment.agreements), 0),
                            friction=moment.friction > 0.5, renewed=moment.renewed, loads=moment.n_loads > 0,
                            looks_always=moment.n_searches + moment.n_renewals == 0.0)


def kinds_of_cycles(moment: Moment, moved, n_moves: int) -> list[tuple[cycles.CycleWork, float]]:
    """The different cycles of a moment, and how many of each there are."""
    plain = plain_cycle(moment)
    kinds = [(plain, float(moment.n_cycles))]
    # A cycle in which more happens takes the place of a plain one.
    for n, changes in ((moment.n_searches, {"search": "complete"}),
                       (moment.n_renewals, {"search": "renewal"}), (moment.n_refreshes, {"search": "refresh"}),
                       (moment.n_eroding, {"eroded": moment.eroded}),
                       (float(n_moves), {"moved": moved})):
        if n > 0.0:
            kinds.append((replace(plain, **changes), n))
            kinds[0] = (plain, kinds[0][1] - n)
    return [(work, n) for work, n in kinds if n != 0.0]


def predict(recording: Recording, n_ranks: int, partitions: Partitions, policy: Policy, networks: list[loggp.Network],
            contact_space: str = "rcb", rates: cycles.Rates | None = None, settling: int = 1,
            refine: int = 1) -> list[Outcome]:
    """One outcome per network. The virtual ranks are made once for all networks.

    `settling`: plain cycles before what counts, so that ranks start as far apart as they are in a run. `refine`: each
    recorded element stands for so many along each edge.
    """
    rates = replace(rates or cycles.Rates(), node=recording.node_seconds)
    sizes = replace(cycles.Sizes(), element_record=recording.record_bytes)
    recording, sizes, rates = refined(recording, sizes, rates, refine)
    both = [n for network in networks for n in (network, loggp.ideal(network))]
    sums = [_Sum(n_ranks) for _ in both]
    owners, n_moves, space, copies = None, 0, None, None
    for k, moment in enumerate(recording.moments):
        owners, moved, moves = _next_owners(recording, k, owners, n_ranks, partitions, policy)
        n_moves += moves
        ranks = share_out(moment.mesh, owners, n_ranks, None if moves else copies)
        copies = copies_of(ranks, moment.mesh)
        ranks.copies = refined_copies(ranks.copies, ranks.elements, moment.mesh.cells.shape[1], refine)
        if len(moment.contact.slaves):
            share_out_contact(ranks, moment.mesh, moment.contact, contact_space, space)
            thin_out(ranks, moment.contact)
            space = ranks.space
        settle, kinds = _programs(ranks, moment, moved, moves, sizes, rates, settling)
        for total, network in zip(sums, both):
            _add_moment(total, network, settle, kinds)
    n_cycles = sum(m.n_cycles for m in recording.moments)
    return [_outcome(partitions, policy, network, n_cycles, n_moves, real, without)
            for network, real, without in zip(networks, sums[::2], sums[1::2])]


def _outcome(partitions, policy, network, n_cycles: int, n_moves: int, real: _Sum, without: _Sum) -> Outcome:
    useful = {name: v / n_cycles for name, v in real.useful.items()}
    seconds = real.seconds / n_cycles
    return Outcome(real.n_ranks, partitions.name, policy.name, network.name, seconds, without.seconds / n_cycles,
                   {name: v / n_cycles for name, v in real.phases.items()}, useful, n_moves,
                   pop.imbalance_by_cause(useful, seconds), real.traffic.over(n_cycles))


def _next_owners(recording: Recording, k: int, before, n_ranks: int, partitions: Partitions, policy: Policy):
    """Owners of the elements of a moment, which elements have moved, and how often the mesh is shared out anew."""
    moment = recording.moments[k]
    first = before is None
    kept = partitions.owners(k, moment, n_ranks) if first else _carry_over(recording.moments[k - 1], moment, before)
    work = np.bincount(kept, weights=moment.element_seconds, minlength=n_ranks)
    moves = policy.moves(moment, 1.0 if first else pop.imbalance(work))
    if moves == 0:
        return kept, None, 0
    owners = kept if first else partitions.owners(k, moment, n_ranks)
    return owners, moved_elements(kept, owners, n_ranks), moves


def _carry_over(earlier: Moment, moment: Moment, owners: np.ndarray) -> np.ndarray:
    """The same owners for the elements that are left."""
    order = np.argsort(earlier.element)
    at = np.searchsorted(earlier.element[order], moment.element)
    at = np.minimum(at, len(order) - 1)
    if not np.array_equal(earlier.element[order][at], moment.element):
        raise ValueError("an element of a moment is not in the one before it; expected elements to die only")
    return owners[order][at]


def _programs(ranks: VirtualRanks, moment: Moment, moved, n_moves: int, sizes, rates,
              settling: int) -> tuple[Program, list[tuple[Program, float]]]:
    """What settles the clocks, and a program of one cycle of each kind with the number of such cycles."""
    settle, kinds = Program(ranks.n_ranks), []
    for _ in range(settling):
        cycles.add_cycle(settle, ranks, moment.mesh, plain_cycle(moment), sizes, rates)
    for work, weight in kinds_of_cycles(moment, moved, n_moves):
        program = Program(ranks.n_ranks)
        cycles.add_cycle(program, ranks, moment.mesh, work, sizes, rates)
        kinds.append((program, weight))
    return settle, kinds


def _add_moment(total: _Sum, network: loggp.Network, settle: Program, kinds: list[tuple[Program, float]]) -> None:
    clock = loggp.Clock(network, settle.n_ranks)
    clock.run(settle)
    settled = clock.state()
    for program, weight in kinds:
        clock.set_state(settled)
        total.add(clock, weight, program)
