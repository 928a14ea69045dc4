"""What a finished run has recorded about its work: the input of a prediction. Arrays, and a file of them.

A recording is a list of moments. Each moment stands for a number of cycles in which the mesh and the work were about as
they are here. Whoever records work differently makes these objects some other way; nothing else knows the file.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from virtual_ranks import ContactScene, Mesh, no_contact

FORMAT = 2


class RecordingError(Exception):
    """Why a recording cannot be used."""


@dataclass
class Moment:
    """A mesh, and the work of one cycle on it."""
    cycle: int  # the first that it stands for
    n_cycles: int
    mesh: Mesh
    element: np.ndarray  # ids of the live elements, in the order of mesh.cells
    element_seconds: np.ndarray  # for each, of one cycle [s]
    time: float = 0.0  # at its first cycle [s]
    contact: ContactScene = field(default_factory=no_contact)
    load_seconds: np.ndarray | None = None  # for each element [s]
    erosion_seconds: np.ndarray | None = None  # for each element, of a cycle with erosion [s]
    rounds: float = 12.0  # of impacts in a cycle, the mean
    agreements: float = 0.0  # reductions of contact in a cycle besides the one of the step, the mean
    n_loads: int = 0  # faces that loads act on
    friction: float = 0.0  # share of the contact definitions that have it
    n_searches: float = 0.0  # complete ones, in all cycles together
    n_renewals: float = 0.0  # of all boxes
    n_refreshes: float = 0.0  # of some boxes
    renewed: float = 1.0  # share of slaves that have new boxes at a renewal
    n_eroding: float = 0.0  # cycles in which elements erode
    eroded: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))  # places of those in one of them


@dataclass
class Recording:
    """The moments of one run, and what is known of its nodes and messages."""
    moments: list[Moment]
    node_seconds: float = 2.0e-9  # kick and drift of one node [s]
    record_bytes: int = 400  # of an element that moves to another rank
    source: str = ""


MOMENT_ARRAYS = ("element", "element_seconds", "load_seconds", "erosion_seconds", "eroded")
MOMENT_NUMBERS = ("cycle", "n_cycles", "time", "rounds", "agreements", "n_loads", "friction", "n_searches",
                  "n_renewals", "n_refreshes", "renewed", "n_eroding")
CONTACT_NUMBERS = ("slave_reach", "facet_reach")
CONTACT_ARRAYS = ("slaves", "facets", "pair_slave", "pair_facet", "pair_touches", "search_seconds", "force_seconds")


def write_recording(path: Path, recording: Recording) -> None:
    """One group per moment."""
    import h5py

    with h5py.File(path, "w") as file:
        file.attrs["kerf_recording"] = FORMAT
        for key in ("node_seconds", "record_bytes", "source"):
            file.attrs[key] = getattr(recording, key)
        for k, moment in enumerate(recording.moments):
            group = file.create_group(f"moments/{k}")
            for key in MOMENT_NUMBERS:
                group.attrs[key] = getattr(moment, key)
            group["cells"], group["points"] = moment.mesh.cells, moment.mesh.points
            group["node"] = moment.mesh.node_ids()
            for key in MOMENT_ARRAYS:
                if getattr(moment, key) is not None:
                    group[key] = getattr(moment, key)
            for key in CONTACT_ARRAYS:
                group[f"contact/{key}"] = getattr(moment.contact, key)
            for key in CONTACT_NUMBERS:
                group.attrs[key] = getattr(moment.contact, key)


def read_recording(path: Path) -> Recording:
    """Throws RecordingError where the file is none, or its arrays do not fit together."""
    import h5py

    try:
        with h5py.File(path) as file:
            if file.attrs.get("kerf_recording") != FORMAT:
                raise RecordingError(f"{path}: error: the file is no recording of format {FORMAT}; expected one that a "
                                     "run with a recording of its work has written")
            if len(file["moments"]) == 0:
                raise RecordingError(f"{path}: error: there is no moment; expected at least one: the run has ended "
                                     "before it has written its first")
            moments = [_read_moment(file[f"moments/{k}"]) for k in range(len(file["moments"]))]
            recording = Recording(moments, float(file.attrs["node_seconds"]), int(file.attrs["record_bytes"]),
                                  _text(file.attrs["source"]))
    except OSError as error:
        raise RecordingError(f"{path}: error: the file cannot be read: {error}; expected a recording in "
                             "HDF5") from error
    except KeyError as error:
        raise RecordingError(f"{path}: error: {error.args[0]}; expected a whole recording") from error
    check(recording, str(path))
    return recording


def _text(value) -> str:
    return value.decode() if isinstance(value, bytes) else str(value)


def _read_moment(group) -> Moment:
    arrays = {key: group[key][:] for key in MOMENT_ARRAYS if key in group}
    numbers = {key: group.attrs[key] for key in MOMENT_NUMBERS}
    numbers = {key: int(v) if key in ("cycle", "n_cycles", "n_loads") else float(v) for key, v in numbers.items()}
    contact = ContactScene(**{key: group[f"contact/{key}"][:] for key in CONTACT_ARRAYS},
                           **{key: float(group.attrs[key]) for key in CONTACT_NUMBERS})
    mesh = Mesh(group["cells"][:], group["points"][:], group["node"][:])
    return Moment(mesh=mesh, contact=contact, **arrays, **numbers)


def check(recording: Recording, name: str) -> None:
    """Throws RecordingError with all that does not fit."""
    errors = []
    if not recording.moments:
        errors.append("there is no moment; expected at least one")
    for k, m in enumerate(recording.moments):
        n, n_nodes = len(m.mesh.cells), len(m.mesh.points)
        c = m.contact
        if len(m.mesh.node_ids()) != n_nodes:
            errors.append(f"moment {k}: {len(m.mesh.node_ids())} ids of {n_nodes} nodes; expected one for each")
        for key in ("element", "element_seconds", "load_seconds", "erosion_seconds"):
            values = getattr(m, key)
            if values is not None and len(values) != n:
                errors.append(f"moment {k}: {len(values)} values of {key} for {n} elements; expected one for each")
            elif values is not None and key.endswith("seconds") and not np.all(values >= 0.0):
                errors.append(f"moment {k}: a value of {key} is negative or not a number; expected at least 0 s")
        for what, values, limit in (("a node of a cell", m.mesh.cells, n_nodes), ("a slave", c.slaves, n_nodes),
                                    ("a node of a facet", c.facets, n_nodes),
                                    ("pair_slave", c.pair_slave, len(c.slaves)),
                                    ("pair_facet", c.pair_facet, len(c.facets)), ("an eroded element", m.eroded, n)):
            if values.size and not 0 <= values.min() <= values.max() < limit:
                errors.append(f"moment {k}: {what} is {values.max()}; expected a number from 0 to {limit - 1}")
        for key in ("search_seconds", "force_seconds"):
            if len(getattr(c, key)) != len(c.slaves):
                errors.append(f"moment {k}: {len(getattr(c, key))} values of {key} for {len(c.slaves)} slaves; "
                              "expected one for each")
        if not len(c.pair_slave) == len(c.pair_facet) == len(c.pair_touches):
            errors.append(f"moment {k}: {len(c.pair_slave)} slaves, {len(c.pair_facet)} facets and "
                          f"{len(c.pair_touches)} touches of pairs; expected as many of each")
        if n == 0 or m.n_cycles < 1:
            errors.append(f"moment {k}: {n} elements in {m.n_cycles} cycles; expected at least one of each")
    if errors:
        raise RecordingError("\n".join(f"{name}: error: {text}" for text in errors))
