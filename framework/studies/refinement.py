"""A recording as it would be with finer cells: each recorded element stands for K x K x K elements.

Volumes grow with K^3, surfaces with K^2, and a run has K times as many cycles, of which the recorded ones are a sample.
doc/theory/prediction.md tells what is assumed.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cycle import Rates, Sizes
from program import Messages
from recording import Moment, Recording
from virtual_ranks import ContactScene, VirtualRanks, unique_pairs

# What travels for each node, facet or face of a surface: of interfaces between ranks, of contact, of erosion.
OF_SURFACES = ("force", "state", "told", "share", "impulse", "load", "request", "surface_mark", "live_count",
               "alive_flag", "opened_facet", "opened_slave", "dead", "candidate_count")
# What travels for each element or node of a volume, when elements move.
OF_VOLUMES = ("element_header", "element_record", "node_record", "home", "owner")
# What travels for each piece of a slave or of a facet at a search.
OF_PIECES = ("slave_record", "facet_record")
# Nodes for each element inside a large mesh, by the number of corners: a grid of bricks, and bricks of six tetrahedra.
NODES_OF_ELEMENT = {8: 1.0, 4: 1.0 / 6.0}


MOST_PIECES = 4  # of a slave along each edge: enough for space to be cut between them, and few enough to be quick


def refined(recording: Recording, sizes: Sizes, rates: Rates, k: int) -> tuple[Recording, Sizes, Rates]:
    """The same run with cells K times as fine, and the bytes and times of what one recorded item stands for."""
    if k < 1:
        raise ValueError(f"a refinement of {k}; expected at least 1")
    if k == 1:
        return recording, sizes, rates
    area, volume = k * k, k * k * k
    sizes = replace(sizes, **{name: getattr(sizes, name) * area for name in OF_SURFACES},
                    **{name: getattr(sizes, name) * volume for name in OF_VOLUMES},
                    **{name: round(getattr(sizes, name) * _slaves_of_piece(k)) for name in OF_PIECES})
    rates = replace(rates, packed=rates.packed * area, rebuild=rates.rebuild * volume,
                    partition=rates.partition * volume, record=rates.record * _slaves_of_piece(k))
    return replace(recording, moments=[_refined_moment(moment, k) for moment in recording.moments]), sizes, rates


def _refined_moment(moment: Moment, k: int) -> Moment:
    """Erosion takes K^3 times as many elements in K times as many cycles, hence in more of them."""
    volume = k * k * k
    n_cycles = moment.n_cycles * k
    return replace(moment, n_cycles=n_cycles, element_seconds=moment.element_seconds * volume,
                   contact=_refined_contact(moment, k), load_seconds=_times(moment.load_seconds, k * k),
                   erosion_seconds=_times(moment.erosion_seconds, volume), n_searches=moment.n_searches * k,
                   n_renewals=moment.n_renewals * k, n_refreshes=moment.n_refreshes * k,
                   n_eroding=min(moment.n_eroding * volume, float(n_cycles)))


def _slaves_of_piece(k: int) -> float:
    return (k / min(k, MOST_PIECES)) ** 2


def _refined_contact(moment: Moment, k: int) -> ContactScene:
    """Pieces in place of each slave, spread over its share of the surface, so that space can be cut between them."""
    contact, pieces, weight = moment.contact, min(k, MOST_PIECES), _slaves_of_piece(k)
    n = pieces * pieces
    pair_slave = contact.pair_slave[:, None] * n + np.arange(n)
    return replace(contact, slaves=np.repeat(contact.slaves, n), pair_slave=pair_slave.ravel(),
                   pair_facet=np.repeat(contact.pair_facet, n), pair_touches=np.repeat(contact.pair_touches, n),
                   search_seconds=np.repeat(contact.search_seconds * weight, n),
                   force_seconds=np.repeat(contact.force_seconds * weight, n), slave_reach=contact.slave_reach / k,
                   facet_reach=contact.facet_reach / k, homes=_spread(moment, pieces), facet_pieces=pieces)


def _spread(moment: Moment, n: int) -> np.ndarray:
    """Places of the slaves: a grid round each node along the edges of a face that has it. A free node has none."""
    slaves, points, corners = moment.contact.slaves, moment.mesh.points, moment.mesh.exterior.corners
    width = corners.shape[1]
    at = np.full(len(points), -1)
    at[corners.ravel()] = np.arange(corners.size)
    at = at[slaves]
    face, corner = at // width, at % width
    steps = (np.arange(n) + 0.5) / n - 0.5
    places = np.repeat(points[slaves][:, None], n * n, axis=1)
    for side, number in ((1, np.repeat(steps, n)), (-1, np.tile(steps, n))):
        edge = np.where(at[:, None] >= 0, points[corners[face, (corner + side) % width]] - points[slaves], 0.0)
        places += number[None, :, None] * edge[:, None]
    return places.reshape(-1, 3)


def _times(values: np.ndarray | None, factor: int) -> np.ndarray | None:
    return None if values is None else values * factor


def refined_copies(copies: np.ndarray, elements: np.ndarray, corners: int, k: int) -> np.ndarray:
    """Copies of nodes on each rank: as many as elements inside a volume, and what is more than these on its surface."""
    inside = NODES_OF_ELEMENT[corners] * elements
    return inside * k**3 + (copies - inside) * k**2


def thin_out(ranks: VirtualRanks, contact: ContactScene) -> None:
    """A rank of contact that has only some pieces of the slaves it has looks at as small a share of their nodes."""
    n, pieces = ranks.n_ranks, contact.facet_pieces**2
    if pieces == 1 or not len(contact.slaves):
        return
    some = np.flatnonzero(contact.candidates)
    rank, _ = unique_pairs(ranks.contact_rank[some], some // pieces, len(contact.slaves))
    whole = np.bincount(rank, minlength=n) * pieces
    share = np.bincount(ranks.contact_rank[some], minlength=n) / np.maximum(whole, 1)
    for name, looks in (("contact_pull", "destination"), ("contact_active", "destination"), ("contact_told", "source"),
                        ("contact_asked", "source")):
        messages = getattr(ranks, name)
        items = np.ceil(messages.items * share[getattr(messages, looks)])
        setattr(ranks, name, Messages(messages.source, messages.destination, items))
