"""What does not fit together in a recording, as sentences: numbers that cannot be give predictions that look sound."""

from __future__ import annotations

import numpy as np

CORNERS = 8  # nodes of a cell


def mistakes_in(recording) -> list[str]:
    """All that is wrong, in the order of the moments."""
    errors = [f"{key} is {value}; expected a finite number, at least 0"
              for key in ("node_seconds", "record_bytes") if not is_amount(value := getattr(recording, key))]
    if not recording.moments:
        errors.append("there is no moment; expected at least one")
    next_cycle = 0
    for k, moment in enumerate(recording.moments):
        if moment.cycle < next_cycle:
            errors.append(f"moment {k}: it begins with cycle {moment.cycle}; expected at least {next_cycle}, after the "
                          "moment before")
        next_cycle = moment.cycle + max(moment.n_cycles, 1)
        found = mistakes_in_forms(moment)
        if not found:  # numbers of arrays without their form mean nothing
            found = mistakes_in_numbers(moment) + mistakes_in_counts(moment)
        errors += [f"moment {k}: {text}" for text in found]
    return errors


def is_amount(values) -> bool:
    """Whether all of the numbers are finite and none is negative."""
    values = np.asarray(values)
    return values.dtype.kind in "iufb" and bool(np.all(np.isfinite(values) & (values >= 0)))


def mistakes_in_forms(m) -> list[str]:
    """Arrays that have another length or shape than what they belong to."""
    errors = []
    for what, array, width in (("cells", m.mesh.cells, CORNERS), ("points", m.mesh.points, 3),
                               ("facets", m.contact.facets, 4)):
        if array.ndim != 2 or array.shape[1] != width:
            errors.append(f"{what} has the shape {array.shape}; expected rows of {width}")
    if errors:
        return errors
    n, n_nodes, n_slaves = len(m.mesh.cells), len(m.mesh.points), len(m.contact.slaves)
    lengths = [("node ids", m.mesh.node_ids(), n_nodes, "nodes"), ("element", m.element, n, "elements"),
               ("element_seconds", m.element_seconds, n, "elements"), ("load_seconds", m.load_seconds, n, "elements"),
               ("erosion_seconds", m.erosion_seconds, n, "elements"),
               ("search_seconds", m.contact.search_seconds, n_slaves, "slaves"),
               ("force_seconds", m.contact.force_seconds, n_slaves, "slaves"),
               ("pair_facet", m.contact.pair_facet, len(m.contact.pair_slave), "pairs"),
               ("pair_touches", m.contact.pair_touches, len(m.contact.pair_slave), "pairs")]
    for what, array, length, whose in lengths:
        if array is not None and array.shape != (length,):
            errors.append(f"{array.size} values of {what} for {length} {whose}; expected one for each")
    if n == 0 or m.n_cycles < 1:
        errors.append(f"{n} elements in {m.n_cycles} cycles; expected at least one of each")
    return errors


def mistakes_in_numbers(m) -> list[str]:
    """Entries of arrays that are out of their range."""
    c, errors = m.contact, []
    for what, values, limit in (("a node of a cell", m.mesh.cells, len(m.mesh.points)),
                                ("a slave", c.slaves, len(m.mesh.points)),
                                ("a node of a facet", c.facets, len(m.mesh.points)),
                                ("pair_slave", c.pair_slave, len(c.slaves)),
                                ("pair_facet", c.pair_facet, len(c.facets)),
                                ("an eroded element", m.eroded, len(m.mesh.cells))):
        if values.dtype.kind not in "iu":
            if values.size:
                errors.append(f"{what} is no whole number; expected one")
        elif values.size and not 0 <= values.min() <= values.max() < limit:
            wrong = values.min() if values.min() < 0 else values.max()
            errors.append(f"{what} is {wrong}; expected a number from 0 to {limit - 1}")
    for what, values in (("element_seconds", m.element_seconds), ("load_seconds", m.load_seconds),
                         ("erosion_seconds", m.erosion_seconds), ("search_seconds", c.search_seconds),
                         ("force_seconds", c.force_seconds)):
        if values is not None and not is_amount(values):
            errors.append(f"a value of {what} is negative or not finite; expected at least 0 s")
    if not np.all(np.isfinite(m.mesh.points)):
        errors.append("a coordinate of a node is not finite; expected metres")
    for what, ids in (("nodes", m.mesh.node_ids()), ("elements", m.element)):
        if len(np.unique(ids)) != len(ids):
            errors.append(f"two {what} have the same id; expected an id for each")
    return errors


def mistakes_in_counts(m) -> list[str]:
    """Numbers of a moment that cannot be those of its cycles."""
    errors = [f"{key} is {value}; expected a finite number, at least 0"
              for key in ("rounds", "agreements", "n_loads", "friction", "n_searches", "n_renewals", "n_refreshes",
                          "renewed", "n_eroding")
              if not is_amount(value := getattr(m, key))]
    errors += [f"{key} is {value} m; expected a finite length, at least 0" for key in ("slave_reach", "facet_reach")
               if not is_amount(value := getattr(m.contact, key))]
    most = m.n_cycles * (m.agreements + 1.0)  # one look at the candidates in a cycle for each contact definition
    looks = m.n_searches + m.n_renewals + m.n_refreshes
    if not errors and looks > most + 0.5:
        errors.append(f"{looks:g} searches, renewals and refreshes in {m.n_cycles} cycles; expected at most {most:g}")
    if not errors and m.n_eroding > m.n_cycles:
        errors.append(f"elements erode in {m.n_eroding:g} of {m.n_cycles} cycles; expected at most all of them")
    return errors
