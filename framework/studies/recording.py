"""What a finished run has recorded about its work: the input of a prediction. Arrays, and a file of them.

A recording is a list of moments. Each moment stands for a number of cycles in which the mesh and the work were about as
they are here. Whoever records work differently makes these objects some other way; nothing else knows the file.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from recording_check import mistakes_in
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
NEEDED_ARRAYS = ("element", "element_seconds")
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
            if not np.array_equal(file.attrs.get("kerf_recording"), FORMAT):
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
    except (TypeError, ValueError, AttributeError) as error:
        raise RecordingError(f"{path}: error: something in it has another form: {error}; expected a recording as a "
                             "run has written it") from error
    if errors := mistakes_in(recording):
        raise RecordingError("\n".join(f"{path}: error: {text}" for text in errors))
    return recording


def _text(value) -> str:
    return value.decode() if isinstance(value, bytes) else str(value)


def _read_moment(group) -> Moment:
    arrays = {key: group[key][:] for key in MOMENT_ARRAYS if key in group or key in NEEDED_ARRAYS}
    numbers = {key: group.attrs[key] for key in MOMENT_NUMBERS}
    numbers = {key: int(v) if key in ("cycle", "n_cycles", "n_loads") else float(v) for key, v in numbers.items()}
    contact = ContactScene(**{key: group[f"contact/{key}"][:] for key in CONTACT_ARRAYS},
                           **{key: float(group.attrs[key]) for key in CONTACT_NUMBERS})
    mesh = Mesh(group["cells"][:], group["points"][:], group["node"][:])
    return Moment(mesh=mesh, contact=contact, **arrays, **numbers)
