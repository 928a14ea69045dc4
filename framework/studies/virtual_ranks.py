"""What each of many virtual ranks would have and send: from a mesh, the owners of its elements, and its contact.

The rules are Kerf's own: the owner of a node as in framework/parallel/ownership.cpp, the ranks of contact as in
framework/contact/distribution.cpp. Nothing loops over elements or ranks.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from cuts import Cuts, SpaceCuts
from program import Messages, no_messages

# Corners of the faces of a cell, by its number of nodes.
FACES = {8: np.array([[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]),
         4: np.array([[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 2, 3]])}
# For each corner of each face of a hexahedron, the corner across.
BEHIND = np.array([[4, 5, 6, 7], [0, 1, 2, 3], [3, 2, 6, 7], [0, 3, 7, 4], [1, 0, 4, 5], [2, 1, 5, 6]])

CANDIDATE_WORK = 0.3  # framework/contact/engine.hpp: candidate_work, of a slave's search
WORST_SHARE = 1.15  # framework/contact/distribution.cpp: worst_share
SPARE_SHARE = 0.05  # framework/contact/distribution.cpp: spare_share
RENEWALS = 5  # framework/contact/engine.hpp: search intervals between two complete searches


@dataclass
class Faces:
    """Faces of elements: nodes, the nodes behind each, and the element."""
    corners: np.ndarray  # (faces, corners)
    behind: np.ndarray
    element: np.ndarray

    def __getitem__(self, which) -> Faces:
        return Faces(self.corners[which], self.behind[which], self.element[which])


@dataclass
class Mesh:
    """Live elements of one moment, and where their nodes are."""
    cells: np.ndarray  # (elements, nodes of a cell): numbers of nodes
    points: np.ndarray  # (nodes, 3) [m]
    node: np.ndarray | None = None  # ids, ascending; numbers where there are none

    def node_ids(self) -> np.ndarray:
        return np.arange(len(self.points)) if self.node is None else self.node

    def centres(self) -> np.ndarray:
        return self.points[self.cells].mean(axis=1)

    @cached_property
    def _sorted_faces(self) -> tuple[Faces, np.ndarray]:
        """All faces of all elements, equal ones side by side, and which are the same as the next."""
        corners = FACES[self.cells.shape[1]]
        behind = BEHIND if self.cells.shape[1] == 8 else corners
        faces = Faces(self.cells[:, corners].reshape(-1, corners.shape[1]),
                      self.cells[:, behind].reshape(-1, corners.shape[1]),
                      np.repeat(np.arange(len(self.cells)), len(corners)))
        keys = np.sort(faces.corners, axis=1)
        order = np.lexsort(keys.T)
        return faces[order], (keys[order][1:] == keys[order][:-1]).all(axis=1)

    @cached_property
    def exterior(self) -> Faces:
        """Faces that one element has alone."""
        faces, same = self._sorted_faces
        twin = np.zeros(len(faces.element), dtype=bool)
        twin[1:] |= same
        twin[:-1] |= same
        return faces[~twin]

    @cached_property
    def inner(self) -> tuple[Faces, Faces]:
        """Faces between two elements, from either side."""
        faces, same = self._sorted_faces
        at = np.flatnonzero(same)
        return faces[at], faces[at + 1]

    @cached_property
    def free_nodes(self) -> tuple[np.ndarray, np.ndarray]:
        """Nodes that no element has, and the element of the surface that is nearest to each."""
        held = np.zeros(len(self.points), dtype=bool)
        held[self.cells.ravel()] = True
        nodes, near = np.flatnonzero(~held), np.unique(self.exterior.element)
        centres = self.points[self.cells[near]].mean(axis=1)
        nearest = [near[np.argmin(((centres - p) ** 2).sum(axis=1))] for p in self.points[nodes]]
        return nodes, np.array(nearest, dtype=np.int64)


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
    slave_reach: float = 0.0  # how far the box of a slave reaches at most [m]
    facet_reach: float = 0.0  # how far the box of a facet reaches beyond its corners, the mean [m]
    homes: np.ndarray | None = None  # where slaves are, unless at their nodes [m]
    facet_pieces: int = 1  # along each edge of a facet, each with a record of its own

    def places(self, mesh: Mesh) -> np.ndarray:
        return mesh.points[self.slaves] if self.homes is None else self.homes

    @cached_property
    def candidates(self) -> np.ndarray:
        """Of each slave."""
        return np.bincount(self.pair_slave, minlength=len(self.slaves))


def no_contact() -> ContactScene:
    none = np.zeros(0, dtype=np.int64)
    return ContactScene(none, np.zeros((0, 4), dtype=np.int64), none, none, none.astype(bool), np.zeros(0), np.zeros(0))


def different(keys: np.ndarray) -> np.ndarray:
    """The different entries of a list, sorted."""
    keys = np.sort(keys)
    return keys[np.diff(keys, prepend=keys[0] - 1) != 0] if len(keys) else keys


def unique_pairs(first, second, n_second: int) -> tuple[np.ndarray, np.ndarray]:
    """The different pairs of two numbers, sorted by the first."""
    keys = different(first.astype(np.int64) * n_second + second)
    return keys // n_second, keys % n_second


def count_messages(source, destination, n_ranks: int) -> Messages:
    """One message for each pair of different ranks, with as many items as there are entries."""
    other = source != destination
    keys = np.sort(source[other].astype(np.int64) * n_ranks + destination[other])
    first = np.flatnonzero(np.diff(keys, prepend=-1))
    keys, items = keys[first], np.diff(np.append(first, len(keys)))
    return Messages(keys // n_ranks, keys % n_ranks, items)


def node_owners(node: np.ndarray, rank: np.ndarray, n_ranks: int, ids: np.ndarray) -> np.ndarray:
    """The owner of each node, given the ids of all and all pairs of a node and a rank that has it, sorted by node, then
    rank.

    Of h holders the one numbered (id / ranks) mod h. A node that nobody has belongs to rank 0.
    """
    holders = np.bincount(node, minlength=len(ids))
    first = np.cumsum(holders) - holders
    pick = first + (ids // n_ranks) % np.maximum(holders, 1)
    owner = np.zeros(len(ids), dtype=np.int64)
    held = holders > 0
    owner[held] = rank[pick[held]]
    return owner


@dataclass
class ContactSpace:
    """Boxes of space of the ranks of contact, kept from search to search while they are good."""
    cuts: SpaceCuts
    best: float  # greatest over mean work when they were made
    reach: float  # beyond its box that a facet is sent [m]


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
    contact_records: np.ndarray | float = 0.0  # of slaves and facets that each rank has then, its own among them
    contact_met: Messages = field(default_factory=no_messages)  # who holds an owner's nodes, at a search
    contact_asked: Messages = field(default_factory=no_messages)  # requests for nodes at a search; perhaps for none
    contact_unasked: Messages = field(default_factory=no_messages)  # the same when no node is new
    space: ContactSpace | None = None  # of contact

    def sum_over_elements(self, seconds) -> np.ndarray:
        """Seconds of each rank from those of each element."""
        return np.bincount(self.owners, weights=seconds, minlength=self.n_ranks)

    def to_homes(self) -> Messages:
        """Ids of copies to the home rank of each node, where owners are agreed on: parallel/ownership.cpp."""
        return count_messages(self.copy_on, self.copy_of % self.n_ranks, self.n_ranks)

    def sum_over_slaves(self, seconds) -> np.ndarray:
        return np.bincount(self.contact_rank, weights=seconds, minlength=self.n_ranks)


@dataclass
class Copies:
    """Which ranks have had copies of which nodes since the mesh was last shared out: ids, and ranks. Their messages
    stay as they are until the next migration, whatever has eroded."""
    node: np.ndarray
    rank: np.ndarray
    halo: Messages

    def among(self, ids: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of nodes that are still there: their numbers, and ranks."""
        at = np.minimum(np.searchsorted(ids, self.node), len(ids) - 1)
        there = ids[at] == self.node
        return at[there], self.rank[there]


def copies_of(ranks: VirtualRanks, mesh: Mesh) -> Copies:
    return Copies(mesh.node_ids()[ranks.copy_of], ranks.copy_on, ranks.halo)


def share_out(mesh: Mesh, owners, n_ranks: int, kept: Copies | None = None) -> VirtualRanks:
    """Nodes, halo and interfaces of each rank, given the owner of each element.

    `kept`: copies of an earlier moment, which ranks keep where their elements have eroded until the next migration.
    """
    owners = np.asarray(owners, dtype=np.int64)
    if len(owners) != len(mesh.cells):
        raise ValueError(f"{len(owners)} owners for {len(mesh.cells)} elements; expected one for each")
    if len(owners) and not 0 <= owners.min() <= owners.max() < n_ranks:
        raise ValueError(f"owners from {owners.min()} to {owners.max()}; expected ranks from 0 to {n_ranks - 1}")
    n_nodes, width = len(mesh.points), mesh.cells.shape[1]
    node, rank = mesh.cells.ravel(), np.repeat(owners, width)
    if kept is not None:
        old_node, old_rank = kept.among(mesh.node_ids())
        node, rank = np.concatenate([node, old_node]), np.concatenate([rank, old_rank])
    node, rank = unique_pairs(node, rank, n_ranks)
    owner_of_node = node_owners(node, rank, n_ranks, mesh.node_ids())
    free, nearest = mesh.free_nodes
    held = np.bincount(node, minlength=n_nodes) > 0
    owner_of_node[free] = np.where(held[free], owner_of_node[free], owners[nearest])
    shared = np.bincount(node, minlength=n_nodes) > 1
    halo = count_messages(rank, owner_of_node[node], n_ranks) if kept is None else kept.halo
    return VirtualRanks(n_ranks, owners, owner_of_node, np.bincount(owners, minlength=n_ranks),
                        np.bincount(rank, minlength=n_ranks), halo,
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


def slave_work(scene: ContactScene) -> np.ndarray:
    """As framework/contact/distribution.cpp counts it."""
    return 1.0 + CANDIDATE_WORK * scene.candidates


def contact_space(mesh: Mesh, scene: ContactScene, n_ranks: int, before: ContactSpace | None) -> ContactSpace:
    """The boxes of an earlier search where these are good enough, or new ones."""
    homes = scene.places(mesh)
    extent = float((homes.max(axis=0) - homes.min(axis=0)).max()) if len(homes) else 0.0
    reach = scene.facet_reach + 1.5 * scene.slave_reach + min(
        2.0 * (RENEWALS - 1) * scene.slave_reach, SPARE_SHARE * extent / n_ranks ** (1.0 / 3.0))

    def unevenness(cuts: Cuts, weights) -> float:
        work = np.bincount(cuts.locate(homes), weights=weights, minlength=n_ranks)
        return float(work.max() / work.mean()) if len(homes) else 1.0

    # Before the first search nobody knows of candidates.
    weights = np.ones(len(homes)) if before is None else slave_work(scene)
    if before is not None and unevenness(before.cuts, weights) <= WORST_SHARE * before.best:
        return ContactSpace(before.cuts, before.best, reach)
    cuts = SpaceCuts(homes, weights, n_ranks)
    return ContactSpace(cuts, unevenness(cuts, weights), reach)


def share_out_contact(ranks: VirtualRanks, mesh: Mesh, scene: ContactScene, space: str = "rcb",
                      before: ContactSpace | None = None) -> None:
    """Gives slaves to ranks, and finds what they need of others.

    `space`: `rcb` cuts space anew with equal work on slaves, as Kerf does; `owners` leaves each slave with the owner of
    its node. `before`: the boxes of an earlier search.
    """
    n, slaves = ranks.n_ranks, scene.slaves
    if space == "owners":
        ranks.contact_rank = ranks.owner_of_node[slaves]
    elif space == "rcb":
        ranks.space = contact_space(mesh, scene, n, before)
        ranks.contact_rank = ranks.space.cuts.locate(scene.places(mesh))
    else:
        raise ValueError(f"a contact space `{space}`; expected rcb or owners")
    faces, face_of_facet = faces_of_contact(mesh, scene)
    rank, node = nodes_of_view(ranks, scene, faces, face_of_facet, len(mesh.points))
    ranks.contact_nodes = np.bincount(rank, minlength=n)
    ranks.contact_pull = count_messages(ranks.owner_of_node[node], rank, n)
    at = ranks.contact_rank[scene.pair_slave]
    rank, node = nodes_of_pairs(scene, at, scene.pair_touches.astype(bool), len(mesh.points))
    ranks.contact_active = count_messages(ranks.owner_of_node[node], rank, n)
    ranks.contact_told = with_items_of(ranks.contact_pull.back(), ranks.contact_active.back(), n)
    send_records(ranks, mesh, scene, faces, face_of_facet)


def faces_of_contact(mesh: Mesh, scene: ContactScene) -> tuple[Faces, np.ndarray]:
    """Faces of the surface whose corners are all slaves or that are candidates, and the place of each facet among them.

    A facet that is no face of the mesh any more stands behind the others, without anything behind itself.
    """
    is_slave = np.zeros(len(mesh.points), dtype=bool)
    is_slave[scene.slaves] = True
    surface = mesh.exterior
    width = surface.corners.shape[1]
    keys = np.concatenate([np.sort(surface.corners, axis=1), np.sort(scene.facets[:, :width], axis=1)])
    different, number = np.unique(keys, axis=0, return_inverse=True)
    number = number.ravel()
    face_with = np.full(len(different), -1)
    face_with[number[:len(surface.corners)]] = np.arange(len(surface.corners))
    face_of_facet = face_with[number[len(surface.corners):]]
    chosen = is_slave[surface.corners].all(axis=1)
    chosen[face_of_facet[face_of_facet >= 0]] = True
    place = np.cumsum(chosen) - 1
    gone = np.flatnonzero(face_of_facet < 0)
    face_of_facet = np.where(face_of_facet >= 0, place[face_of_facet], 0)
    face_of_facet[gone] = chosen.sum() + np.arange(len(gone))
    lone = scene.facets[gone][:, :width]
    kept = surface[chosen]
    return Faces(np.concatenate([kept.corners, lone]), np.concatenate([kept.behind, lone]),
                 np.concatenate([kept.element, np.full(len(gone), -1)])), face_of_facet


def nodes_of_view(ranks: VirtualRanks, scene: ContactScene, faces: Faces, face_of_facet, n_nodes: int):
    """What ranks of contact ask for: slaves with candidates, the facets that these look at and those round them, and
    the nodes behind all these facets (framework/contact/candidate_rows.cpp). Pairs of a rank and a node."""
    at = ranks.contact_rank[scene.pair_slave]
    some = np.flatnonzero(scene.candidates)
    width = faces.corners.shape[1]
    order = np.argsort(faces.corners.ravel(), kind="stable")
    starts = np.searchsorted(faces.corners.ravel()[order], np.arange(n_nodes + 1))
    n_round = (starts[1:] - starts[:-1])[scene.slaves[some]]
    first = np.repeat(starts[scene.slaves[some]], n_round)
    within = np.arange(len(first)) - np.repeat(np.cumsum(n_round) - n_round, n_round)
    rank, face = unique_pairs(np.concatenate([at, np.repeat(ranks.contact_rank[some], n_round)]),
                              np.concatenate([face_of_facet[scene.pair_facet], order[first + within] // width]),
                              max(len(faces.element), 1))
    nodes = [scene.slaves[some], *faces.corners[face].T, *faces.behind[face].T]
    return unique_pairs(np.concatenate([ranks.contact_rank[some], *[rank] * (2 * width)]), np.concatenate(nodes),
                        n_nodes)


def boxes_of_pieces(corners: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """The boxes of n x n pieces of each facet, side by side; a triangle is a facet whose last corner stands twice."""
    if n == 1:
        return corners.min(axis=1), corners.max(axis=1)
    a, b, c, d = (corners[:, min(i, corners.shape[1] - 1), None, None] for i in range(4))
    u, v = (w[None, ..., None] for w in np.meshgrid(np.arange(n + 1) / n, np.arange(n + 1) / n, indexing="ij"))
    grid = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
    pieces = np.stack([grid[:, :-1, :-1], grid[:, 1:, :-1], grid[:, 1:, 1:], grid[:, :-1, 1:]])
    return pieces.min(axis=0).reshape(-1, 3), pieces.max(axis=0).reshape(-1, 3)


def send_records(ranks: VirtualRanks, mesh: Mesh, scene: ContactScene, faces: Faces, face_of_facet) -> None:
    """Which records go where at a search, and who asks whom for nodes afterwards."""
    n = ranks.n_ranks
    there = faces.element >= 0
    faces = faces[there]
    ranks.contact_slaves = count_messages(ranks.owner_of_node[scene.slaves], ranks.contact_rank, n)
    if ranks.space is not None:
        low, high = boxes_of_pieces(mesh.points[faces.corners], scene.facet_pieces)
        reach = ranks.space.reach
        face, rank = ranks.space.cuts.parts_of_boxes(low - reach, high + reach)
        face //= scene.facet_pieces**2
    else:
        looked_at = there[face_of_facet[scene.pair_facet]]
        rank, face = unique_pairs(ranks.contact_rank[scene.pair_slave][looked_at],
                                  face_of_facet[scene.pair_facet][looked_at], max(len(faces.element), 1))
    ranks.contact_records = np.bincount(rank, minlength=n) + np.bincount(ranks.contact_rank, minlength=n)
    sender = ranks.owners[faces.element[face]]
    ranks.contact_facets = count_messages(sender, rank, n)
    # The owners of the nodes of a record hear of the ranks that it has gone to.
    nodes = np.concatenate([faces.corners, faces.behind], axis=1)
    owner = ranks.owner_of_node[nodes[face]]
    width = owner.shape[1]
    owner, holder, sender = owner.ravel(), np.repeat(rank, width), np.repeat(sender, width)
    apart = owner != holder
    told = different((sender[apart] * n + owner[apart]) * n + holder[apart])
    ranks.contact_met = count_messages(told // (n * n), told // n % n, n)
    met = different(owner[apart] * n + holder[apart])
    met_owner, met_holder = met // n, met % n
    met_owner = np.concatenate([met_owner, ranks.owner_of_node[scene.slaves], ranks.contact_pull.source])
    met_holder = np.concatenate([met_holder, ranks.contact_rank, ranks.contact_pull.destination])
    asked = count_messages(met_holder, met_owner, n)
    ranks.contact_asked = with_items_of(asked, ranks.contact_pull.back(), n)
    ranks.contact_unasked = Messages(asked.source, asked.destination, np.zeros(len(asked), dtype=np.int64))


@dataclass
class Opened:
    """What eroding elements lay bare."""
    facets: Messages
    slaves: Messages
    dead: Messages  # the elements themselves, to all ranks that know facets of the same sender


def opened_by(ranks: VirtualRanks, mesh: Mesh, scene: ContactScene, eroded) -> Opened:
    """The facets that open, from the owners of their elements, their new nodes, and the eroded elements."""
    n = ranks.n_ranks
    eroded = np.asarray(eroded, dtype=np.int64)
    dies = np.zeros(len(mesh.cells), dtype=bool)
    dies[eroded] = True
    one, other = mesh.inner
    a, b = dies[one.element], dies[other.element]
    corners = np.concatenate([one.corners[b & ~a], other.corners[a & ~b]])
    element = np.concatenate([one.element[b & ~a], other.element[a & ~b]])
    nodes = np.setdiff1d(corners.ravel(), scene.slaves)
    if ranks.space is None:
        face, rank = np.arange(len(element)), ranks.owner_of_node[corners[:, 0]]
        at = ranks.owner_of_node[nodes]
    else:
        x = mesh.points[corners]
        face, rank = ranks.space.cuts.parts_of_boxes(x.min(axis=1) - ranks.space.reach,
                                                     x.max(axis=1) + ranks.space.reach)
        at = ranks.space.cuts.locate(mesh.points[nodes])
    n_dead = np.bincount(ranks.owners[eroded], minlength=n)[ranks.contact_facets.source]
    told = n_dead > 0
    return Opened(count_messages(ranks.owners[element[face]], rank, n),
                  count_messages(ranks.owner_of_node[nodes], at, n),
                  Messages(ranks.contact_facets.source[told], ranks.contact_facets.destination[told], n_dead[told]))


def moved_elements(before, after, n_ranks: int) -> Messages:
    """Elements that change their owner."""
    return count_messages(np.asarray(before), np.asarray(after), n_ranks)
