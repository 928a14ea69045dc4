"""A recording as it would be with finer cells: each recorded element stands for K x K x K elements.

Volumes grow with K^3, surfaces with K^2, and a run has K times as many cycles, of which the recorded ones are a sample.
doc/theory/prediction.md tells what is assumed.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cycle import Rates, Sizes
from recording import Moment, Recording

# What travels for each node, facet or face of a surface: of interfaces between ranks, of contact, of erosion.
OF_SURFACES = ("force", "state", "told", "share", "impulse", "load", "request", "surface_mark", "live_count",
               "alive_flag", "slave_record", "facet_record", "dead", "candidate_count")
# What travels for each element or node of a volume, when elements move.
OF_VOLUMES = ("element_header", "element_record", "node_record", "home", "owner")
# Nodes for each element inside a large mesh, by the number of corners: a grid of bricks, and bricks of six tetrahedra.
NODES_OF_ELEMENT = {8: 1.0, 4: 1.0 / 6.0}


def refined(recording: Recording, sizes: Sizes, rates: Rates, k: int) -> tuple[Recording, Sizes, Rates]:
    """The same run with cells K times as fine, and the bytes and times of what one recorded item stands for."""
    if k < 1:
        raise ValueError(f"a refinement of {k}; expected at least 1")
    if k == 1:
        return recording, sizes, rates
    area, volume = k * k, k * k * k
    sizes = replace(sizes, **{name: getattr(sizes, name) * area for name in OF_SURFACES},
                    **{name: getattr(sizes, name) * volume for name in OF_VOLUMES})
    rates = replace(rates, packed=rates.packed * area, rebuild=rates.rebuild * volume,
                    partition=rates.partition * volume)
    return replace(recording, moments=[_refined_moment(moment, k) for moment in recording.moments]), sizes, rates


def _refined_moment(moment: Moment, k: int) -> Moment:
    """Erosion takes K^3 times as many elements in K times as many cycles, hence in more of them."""
    area, volume = k * k, k * k * k
    contact = replace(moment.contact, search_seconds=moment.contact.search_seconds * area,
                      force_seconds=moment.contact.force_seconds * area, slave_reach=moment.contact.slave_reach / k,
                      facet_reach=moment.contact.facet_reach / k)
    n_cycles = moment.n_cycles * k
    return replace(moment, n_cycles=n_cycles, element_seconds=moment.element_seconds * volume, contact=contact,
                   load_seconds=_times(moment.load_seconds, area), erosion_seconds=_times(moment.erosion_seconds, volume),
                   n_searches=moment.n_searches * k, n_renewals=moment.n_renewals * k,
                   n_refreshes=moment.n_refreshes * k, n_eroding=min(moment.n_eroding * volume, float(n_cycles)))


def _times(values: np.ndarray | None, factor: int) -> np.ndarray | None:
    return None if values is None else values * factor


def refined_copies(copies: np.ndarray, elements: np.ndarray, corners: int, k: int) -> np.ndarray:
    """Copies of nodes on each rank: as many as elements inside a volume, and what is more than these on its surface."""
    inside = NODES_OF_ELEMENT[corners] * elements
    return inside * k**3 + (copies - inside) * k**2
