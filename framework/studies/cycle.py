"""The steps of one cycle of Kerf on virtual ranks, in the order of doc/developers/flow_of_a_step.md."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from program import Messages, Program, joined
from virtual_ranks import ContactScene, Mesh, VirtualRanks, opened_by

PHASES = ("nodes", "rebalance", "elements", "halo", "loads", "contact_search", "contact_forces", "erosion")


@dataclass(frozen=True)
class Sizes:
    """What travels per item [bytes], and how often. The files of Kerf where each number comes from are named."""
    force: int = 24  # model/copies.cpp: three sums of 8 bytes
    reduction: int = 104  # dynamics/agreement.hpp: StepReduction
    contact_note: int = 32  # and the note of a contact definition
    state: int = 64  # contact/channel.hpp: state_width numbers, of position, velocity and mass
    told: int = 32  # contact/channel.cpp: active_width numbers, the place of a node and its shares
    share: int = 24  # contact/channel.hpp: share_width numbers
    impulse: int = 24  # contact/engine.cpp, push_velocities: three sums
    load: int = 32  # contact/engine.cpp, Exchange::add_up: four sums
    request: int = 8  # contact/channel.cpp, request: an id
    agreement: int = 8  # contact/engine.cpp: greatest(...)
    surface_mark: int = 8  # contact/surface_records.cpp, surface_nodes
    live_count: int = 8  # erosion/neighbourhood.cpp
    alive_flag: int = 8  # model/surface.cpp
    slave_record: int = 96  # contact/records.hpp: ContactNodeRecord
    facet_record: int = 216  # contact/records.hpp: ContactFacetRecord
    opened_slave: int = 96  # the same records, of what erosion lays bare
    opened_facet: int = 216
    record_header: int = 32  # contact/engine.hpp: Post::n_lists lengths of lists
    holder: int = 4  # contact/distribution.cpp, put: a rank that looks at nodes
    dead: int = 8  # contact/upkeep.cpp, announce_change: an id
    candidate_count: int = 8  # contact/engine.cpp, count_candidates
    frames: int = 128  # contact/foresight.cpp: sums over nodes of a body
    extent: int = 56  # contact/distribution.cpp, extent_of: seven numbers
    element_header: int = 80  # model/migrator.cpp: Header
    element_record: int = 400  # model/part_store.hpp: record_size() fields; depends on element and material
    node_record: int = 128  # model/node_store.hpp: NodeRecord
    home: int = 8  # parallel/ownership.cpp: the id of a copy
    owner: int = 4  # parallel/ownership.cpp: a rank


@dataclass(frozen=True)
class Rates:
    """Work that is not recorded per element or slave."""
    node: float = 2.0e-9  # kick and drift of one copy of a node [s]
    packed: float = 2.5e-8  # per item that is packed or unpacked [s]; measured, doc/theory/prediction.md
    record: float = 4.0e-7  # per record of a search that a rank gets, its own among them [s]; measured, the same
    rebuild: float = 2.0e-6  # per element of a rank after a move: numbering, plans, surface [s]
    partition: float = 0.0  # per element of a rank, to find new owners [s]


@dataclass
class CycleWork:
    """The work of one cycle, and what happens in it."""
    element_seconds: np.ndarray  # for each live element [s]
    contact: ContactScene
    load_seconds: np.ndarray | None = None  # for each element [s]
    erosion_seconds: np.ndarray | None = None  # for each element [s]
    eroded: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))  # elements
    rounds: int = 12  # of impacts
    agreements: int = 0  # reductions of contact besides the one of the step
    friction: bool = False
    loads: bool = False  # whether loads act on anything
    search: str = ""  # `complete`, `renewal` of all boxes, `refresh` of some
    renewed: float = 1.0  # share of the slaves whose records a renewal sends
    looks_always: bool = False  # there is no search in many cycles, and its time is that of every cycle
    moved: Messages | None = None  # elements that change their owners, in a cycle that re-balances


def add_cycle(program: Program, ranks: VirtualRanks, mesh: Mesh, work: CycleWork, sizes: Sizes = Sizes(),
              rates: Rates = Rates()) -> None:
    """Appends one cycle to a program."""
    n = ranks.n_ranks
    program.compute("nodes", rates.node * ranks.copies)
    if work.moved is not None:
        add_move(program, ranks, work.moved, sizes, rates)
    program.compute("elements", ranks.sum_over_elements(work.element_seconds))
    if n > 1:
        add_sum_over_copies(program, "halo", ranks.halo, sizes.force, rates)
    if work.load_seconds is not None:
        if n > 1 and work.loads:
            add_sum_over_copies(program, "loads", ranks.halo, sizes.force, rates)
        program.compute("loads", ranks.sum_over_elements(work.load_seconds))
    in_contact = len(work.contact.slaves) > 0
    program.allreduce("halo", sizes.reduction + (sizes.contact_note if in_contact else 0))
    if in_contact:
        add_contact(program, ranks, work, sizes, rates)
    if len(work.eroded):
        add_erosion(program, ranks, mesh, work, sizes, rates)


def add_push(program: Program, phase: str, messages: Messages, item_bytes: int, rates: Rates) -> None:
    """Packs, sends and unpacks."""
    n = program.n_ranks
    program.compute(phase, rates.packed * np.bincount(messages.source, weights=messages.items, minlength=n))
    program.exchange(phase, messages, item_bytes)
    program.compute(phase, rates.packed * np.bincount(messages.destination, weights=messages.items, minlength=n))


_answers: dict[int, tuple[Messages, Messages]] = {}


def answers(messages: Messages) -> Messages:
    """The same object for the same messages, so that a clock prepares the way of each only once."""
    if id(messages) not in _answers:
        if len(_answers) > 64:
            _answers.clear()
        _answers[id(messages)] = (messages, messages.back())
    return _answers[id(messages)][1]


def add_sum_over_copies(program: Program, phase: str, halo: Messages, item_bytes: int, rates: Rates) -> None:
    add_push(program, phase, halo, item_bytes, rates)
    add_push(program, phase, answers(halo), item_bytes, rates)


def add_contact(program: Program, ranks: VirtualRanks, work: CycleWork, sizes: Sizes, rates: Rates) -> None:
    held, active = ranks.contact_pull, ranks.contact_active
    if work.looks_always or work.search in ("complete", "renewal"):
        program.compute("contact_search", ranks.sum_over_slaves(work.contact.search_seconds))
    if work.search and program.n_ranks > 1:
        add_search(program, ranks, work, sizes, rates)
    for _ in range(work.agreements):
        program.allreduce("contact_search", sizes.agreement)
    # Touches, then as much again for each round.
    step = ranks.sum_over_slaves(work.contact.force_seconds) / (work.rounds + 1)
    add_push(program, "contact_forces", held, sizes.state, rates)
    program.compute("contact_forces", step)
    add_push(program, "contact_forces", ranks.contact_told, sizes.told, rates)
    add_push(program, "contact_forces", active, sizes.share, rates)
    for k in range(work.rounds):
        if k > 0:
            add_sum(program, active, sizes.impulse, rates)
        if k % 3 == 0:
            add_sum(program, active, sizes.load, rates)
        program.compute("contact_forces", step)
    for _ in range(1 + work.friction):
        add_push(program, "contact_forces", answers(active), sizes.force, rates)
    add_push(program, "halo", answers(ranks.halo), sizes.force, rates)


def add_sum(program: Program, active: Messages, item_bytes: int, rates: Rates) -> None:
    """To the owners, and back to all who look at the nodes."""
    add_push(program, "contact_forces", answers(active), item_bytes, rates)
    add_push(program, "contact_forces", active, item_bytes, rates)


def add_search(program: Program, ranks: VirtualRanks, work: CycleWork, sizes: Sizes, rates: Rates) -> None:
    """Records go to the ranks of contact, which ask for the nodes of their candidates and tell the number of these."""
    records = joined((ranks.contact_slaves, sizes.slave_record), (ranks.contact_facets, sizes.facet_record),
                     (ranks.contact_met, sizes.holder), header=sizes.record_header)
    if work.search == "complete":
        add_sum_over_copies(program, "contact_search", ranks.halo, sizes.surface_mark, rates)
        # Frames of bodies there and back, the extent, and whether the boxes of space are good enough.
        for n_bytes in (sizes.frames, sizes.frames, 8 * program.n_ranks, sizes.extent):
            program.allreduce("contact_search", n_bytes)
        program.consensus("contact_search", records, 1)
    elif work.search == "renewal":
        program.exchange("contact_search", share_of(records, work.renewed, sizes.record_header), 1)
    else:
        told = Messages(records.source, records.destination, np.ones(len(records), dtype=np.int64))
        program.exchange("contact_search", told, sizes.record_header)
    if work.search != "refresh":
        share = work.renewed if work.search == "renewal" else 1.0
        program.compute("contact_search", share * rates.record * ranks.contact_records)
    if work.search == "complete":
        add_push(program, "contact_search", ranks.contact_asked, sizes.request, rates)
        add_push(program, "contact_search", answers(ranks.contact_pull), sizes.candidate_count, rates)
    else:
        add_push(program, "contact_search", ranks.contact_unasked, sizes.request, rates)


def share_of(records: Messages, share: float, header: int) -> Messages:
    """The same messages with a share of their records."""
    n_bytes = header + np.rint((records.items - header) * share).astype(np.int64)
    return Messages(records.source, records.destination, n_bytes)


def add_erosion(program: Program, ranks: VirtualRanks, mesh: Mesh, work: CycleWork, sizes: Sizes,
                rates: Rates) -> None:
    if work.erosion_seconds is not None:
        program.compute("erosion", ranks.sum_over_elements(work.erosion_seconds))
    add_sum_over_copies(program, "erosion", ranks.halo, sizes.live_count, rates)
    add_push(program, "erosion", ranks.interface_faces, sizes.alive_flag, rates)
    if not len(work.contact.slaves) or program.n_ranks == 1:
        return
    opened = opened_by(ranks, mesh, work.contact, work.eroded)
    # Kerf times what contact hears of it as a search.
    add_sum_over_copies(program, "contact_search", ranks.halo, sizes.surface_mark, rates)
    news = joined((opened.facets, sizes.opened_facet), (opened.slaves, sizes.opened_slave), (opened.dead, sizes.dead),
                  header=sizes.record_header)
    program.consensus("contact_search", news, 1)
    add_push(program, "contact_search", ranks.contact_unasked, sizes.request, rates)


def add_move(program: Program, ranks: VirtualRanks, moved: Messages, sizes: Sizes, rates: Rates) -> None:
    """Partition, migration of elements and nodes, and what is built anew."""
    program.compute("rebalance", rates.partition * ranks.elements)
    for item_bytes in (sizes.element_header, sizes.element_record, sizes.node_record):
        program.consensus("rebalance", moved, item_bytes)  # about as many nodes as elements
    homes = ranks.to_homes()
    program.consensus("rebalance", homes, sizes.home)
    program.consensus("rebalance", homes.back(), sizes.owner)
    program.consensus("rebalance", ranks.halo, sizes.request)
    program.compute("rebalance", rates.rebuild * ranks.elements)
