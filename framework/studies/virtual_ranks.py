"""What each of many virtual ranks would have and send: from a mesh, the owners of its elements, and its contact.

The rules are Kerf's own: the owner of a node as in framework/parallel/ownership.cpp, the ranks of contact as in
framework/contact/distribution.cpp. Nothing loops over elements or ranks.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from cuts import Cuts
from program import Messages, no_messages

# Corners of the faces of a cell, by its number of nodes.
FACES = {8: np.array([[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]),
         4: np.array([[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]])}


@dataclass
class Mesh:
    """Live elements of one moment, and where their nodes are."""
    cells: np.ndarray  # (elements, nodes of a cell): numbers of nodes
    points: np.ndarray  # (nodes, 3) [m]

    def centres(self) -> np.ndarray:
        return self.points[self.cells].mean(axis=1)


@dataclass
class ContactScene:
    """Nodes of the surface, and the pairs of nodes and facets that contact looks at between two searches."""
    slaves: np.ndarray  # numbers of nodes
    facets: np.ndarray  # (facets, 4): numbers of nodes
    pair_slave: np.ndarray  # for each pair: a place in `slaves`
    pair_facet: np.ndarray  # and in `facets`
    pair_touches: np.ndarray  # whether the two touch
    search_seconds: np.ndarray  # for each slave: its share of one search [s]
    force_seconds: np.ndarray  # for each slave: touches and rounds of one cycle [s]


def no_contact() -> ContactScene:
    none = np.zeros(0, dtype=np.int64)
    return ContactScene(none, np.zeros((0, 4), dtype=np.int64), none, none, none.astype(bool), np.zeros(0), np.zeros(0))


def unique_pairs(first, second, n_second: int) -> tuple[np.ndarray, np.ndarray]:
    """The different pairs of two numbers, sorted by the first."""
    keys = np.unique(first.astype(np.int64) * n_second + second)
    return keys // n_second, keys % n_second


def count_messages(source, destination, n_ranks: int) -> Messages:
    """One message for each pair of different ranks, with as many items as there are entries."""
    other = source != destination
    keys, items = np.unique(source[other].astype(np.int64) * n_ranks + destination[other], return_counts=True)
    return Messages(keys // n_ranks, keys % n_ranks, items)


def node_owners(node: np.ndarray, rank: np.ndarray, n_ranks: int, n_nodes: int) -> np.ndarray:
    """The owner of each node, given all pairs of a node and a rank that has it, sorted by node, then rank.

    Of h holders the one numbered (id / ranks) mod h. A node that nobody has belongs to rank 0.
    """
    holders = np.bincount(node, minlength=n_nodes)
    first = np.cumsum(holders) - holders
    pick = first + (np.arange(n_nodes) // n_ranks) % np.maximum(holders, 1)
    owner = np.zeros(n_nodes, dtype=np.int64)
    held = holders > 0
    owner[held] = rank[pick[held]]
    return owner


@dataclass
class VirtualRanks:
    """A mesh and its contact, shared out."""
    n_ranks: int
    owners: np.ndarray  # of elements
    owner_of_node: np.ndarray
    elements: np.ndarray  # per rank
    copies: np.ndarray  # of nodes, per rank
    halo: Messages  # copies of shared nodes to their owners
    interface_faces: Messages  # faces of elements between two ranks, both ways
    copy_of: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))  # the node of each copy
    copy_on: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))  # and its rank
    contact_rank: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))  # of slaves
    contact_nodes: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))  # that each rank needs
    contact_pull: Messages = field(default_factory=no_messages)  # nodes from their owners to ranks of contact
    contact_told: Messages = field(default_factory=no_messages)  # back, of these the nodes that touch; perhaps none
    contact_active: Messages = field(default_factory=no_messages)  # nodes that touch, from their owners
    contact_slaves: Messages = field(default_factory=no_messages)  # records of slaves at a search
    contact_facets: Messages = field(default_factory=no_messages)  # records of facets at a search
    cuts: Cuts | None = None  # of the space of contact

    def sum_over_elements(self, seconds) -> np.ndarray:
        """Seconds of each rank from those of each element."""
        return np.bincount(self.owners, weights=seconds, minlength=self.n_ranks)

    def to_homes(self) -> Messages:
        """Ids of copies to the home rank of each node, where owners are agreed on: parallel/ownership.cpp."""
        return count_messages(self.copy_on, self.copy_of % self.n_ranks, self.n_ranks)

    def sum_over_slaves(self, seconds) -> np.ndarray:
        return np.bincount(self.contact_rank, weights=seconds, minlength=self.n_ranks)


def share_out(mesh: Mesh, owners, n_ranks: int) -> VirtualRanks:
    """Nodes, halo and interfaces of each rank, given the owner of each element."""
    owners = np.asarray(owners, dtype=np.int64)
    if len(owners) != len(mesh.cells):
        raise ValueError(f"{len(owners)} owners for {len(mesh.cells)} elements; expected one for each")
    if len(owners) and not 0 <= owners.min() <= owners.max() < n_ranks:
        raise ValueError(f"owners from {owners.min()} to {owners.max()}; expected ranks from 0 to {n_ranks - 1}")
    n_nodes, width = len(mesh.points), mesh.cells.shape[1]
    node, rank = unique_pairs(mesh.cells.ravel(), np.repeat(owners, width), n_ranks)
    owner_of_node = node_owners(node, rank, n_ranks, n_nodes)
    shared = np.bincount(node, minlength=n_nodes) > 1
    return VirtualRanks(n_ranks, owners, owner_of_node, np.bincount(owners, minlength=n_ranks),
                        np.bincount(rank, minlength=n_ranks), count_messages(rank, owner_of_node[node], n_ranks),
                        match_faces(mesh.cells, owners, shared, n_ranks), node, rank)


def match_faces(cells: np.ndarray, owners: np.ndarray, shared: np.ndarray, n_ranks: int) -> Messages:
    """The faces that an element of one rank has in common with an element of another."""
    if cells.shape[1] not in FACES:
        raise ValueError(f"cells of {cells.shape[1]} nodes; expected one of {', '.join(map(str, FACES))}")
    corners = FACES[cells.shape[1]]
    outer = np.flatnonzero(shared[cells].any(axis=1))
    faces = cells[outer][:, corners].reshape(-1, corners.shape[1])
    owner = np.repeat(owners[outer], len(corners))
    whole = shared[faces].all(axis=1)  # only faces of shared nodes can lie between two ranks
    faces, owner = np.sort(faces[whole], axis=1), owner[whole]
    order = np.lexsort(faces.T)
    faces, owner = faces[order], owner[order]
    same = np.flatnonzero((faces[1:] == faces[:-1]).all(axis=1))
    a, b = owner[same], owner[same + 1]
    return count_messages(np.concatenate([a, b]), np.concatenate([b, a]), n_ranks)


def nodes_of_pairs(scene: ContactScene, at: np.ndarray, chosen: np.ndarray, n_nodes: int):
    """The different nodes of the chosen pairs on each rank: ranks, and nodes."""
    nodes = [scene.slaves[scene.pair_slave[chosen]], *scene.facets[scene.pair_facet[chosen]].T]
    return unique_pairs(np.tile(at[chosen], len(nodes)), np.concatenate(nodes), n_nodes)


def with_items_of(messages: Messages, other: Messages, n_ranks: int) -> Messages:
    """The messages between the same ranks, with as many items as the other messages have, which may be none."""
    keys, others = messages.source * n_ranks + messages.destination, other.source * n_ranks + other.destination
    items = np.zeros(len(keys), dtype=np.int64)
    items[np.searchsorted(keys, others)] = other.items
    return Messages(messages.source, messages.destination, items)


def share_out_contact(ranks: VirtualRanks, mesh: Mesh, scene: ContactScene, space: str = "rcb",
                      cuts: Cuts | None = None) -> None:
    """Gives slaves to ranks, and finds what they need of others.

    `space`: `rcb` cuts space anew with equal work on slaves, as Kerf does; `owners` leaves each slave with the owner of
    its node. `cuts`: of an earlier search, to be kept.
    """
    n, slaves = ranks.n_ranks, scene.slaves
    if space == "owners":
        ranks.contact_rank = ranks.owner_of_node[slaves]
    elif space == "rcb":
        # A slave's work is 1, and 0.3 for each candidate, as in framework/contact/distribution.cpp.
        weights = 1.0 + 0.3 * np.bincount(scene.pair_slave, minlength=len(slaves))
        ranks.cuts = Cuts(mesh.points[slaves], weights, n) if cuts is None else cuts
        ranks.contact_rank = ranks.cuts.part if cuts is None else cuts.locate(mesh.points[slaves])
    else:
        raise ValueError(f"a contact space `{space}`; expected rcb or owners")
    at = ranks.contact_rank[scene.pair_slave]
    rank, node = nodes_of_pairs(scene, at, np.ones(len(at), dtype=bool), len(mesh.points))
    ranks.contact_nodes = np.bincount(rank, minlength=n)
    ranks.contact_pull = count_messages(ranks.owner_of_node[node], rank, n)
    rank, node = nodes_of_pairs(scene, at, scene.pair_touches.astype(bool), len(mesh.points))
    ranks.contact_active = count_messages(ranks.owner_of_node[node], rank, n)
    ranks.contact_told = with_items_of(ranks.contact_pull.back(), ranks.contact_active.back(), n)
    ranks.contact_slaves = count_messages(ranks.owner_of_node[slaves], ranks.contact_rank, n)
    rank, facet = unique_pairs(at, scene.pair_facet, max(len(scene.facets), 1))
    ranks.contact_facets = count_messages(ranks.owner_of_node[scene.facets[facet, 0]], rank, n)


def opened_facets(ranks: VirtualRanks, mesh: Mesh, eroded) -> Messages:
    """Facets and nodes that eroding elements lay bare, from the owners of the elements to the ranks of contact there.

    As many items as eroded elements: what an element lays bare is told once to each rank of contact round it.
    """
    eroded = np.asarray(eroded, dtype=np.int64)
    if len(eroded) == 0:
        return no_messages()
    corners = mesh.cells[eroded]
    if ranks.cuts is None:
        at = ranks.owner_of_node[corners]
    else:
        at = ranks.cuts.locate(mesh.points[corners.ravel()]).reshape(corners.shape)
    element, rank = unique_pairs(np.repeat(np.arange(len(eroded)), corners.shape[1]), at.ravel(), ranks.n_ranks)
    return count_messages(ranks.owners[eroded][element], rank, ranks.n_ranks)


def moved_elements(before, after, n_ranks: int) -> Messages:
    """Elements that change their owner."""
    return count_messages(np.asarray(before), np.asarray(after), n_ranks)
