"""Given motions of nodes: places to the last bit, the work that they do, and the times at which they begin and end."""

import numpy as np
import pytest

SHEAR, BULK, DENSITY = 80e9, 160e9, 7850.0
WAVE_SPEED = ((BULK + 4 / 3 * SHEAR) / DENSITY) ** 0.5  # of plane waves [m/s]
LENGTH, AREA = 0.1, 0.002 * 0.003  # of the column [m], [m2]
AT = 0.3  # where its end is [m]
FACES = [([0, 1, 0], [0, 0, 0]), ([0, 0, 1], [0, 0, 0]), ([0, -1, 0], [0, 0.002, 0]), ([0, 0, -1], [0, 0, 0.003])]


STEP = 1e-7  # below the stable step: all steps are alike, and only then is their work exact to round-off [s]


def column(motion, end, *, n_results=10, curve=None, step=STEP):
    """An elastic column in uniaxial strain, far from the origin, whose end is moved."""
    steel = {"density": DENSITY, "strength": {"type": "elastic", "shear_modulus": SHEAR},
             "eos": {"type": "linear", "bulk_modulus": BULK}}
    return {
        "title": "a column whose end is moved", "time": {"end": end, "maximum_step": step},
        "materials": {"steel": steel},
        "parts": {"body": {"material": "steel", "mesh": {
            "type": "block", "origin": [AT, 0, 0], "size": [LENGTH, 0.002, 0.003], "cells": [100, 1, 1]}}},
        "curves": {"way": curve} if curve else {}, "sets": {"end": {"face": "x_min"}},
        "boundaries": [{"type": "symmetry", "normal": n, "point": p} for n, p in FACES]
        + [{"type": "prescribed_motion", "nodes": "end", "components": ["x"], **motion}],
        "output": {"precision": "double", "results_interval": end / n_results, "history_interval": end / 100,
                   "node_fields": ["velocity", "displacement"]},
    }


def way_of_end(run, frame):
    points = run.results.points(0)
    return run.results.node("displacement", frame)[points[:, 0] == AT, 0]


def worst_balance(run):
    return np.abs(run.history["balance_error"]).max()


def test_a_displacement_that_grows_evenly_does_what_its_velocity_does(kerf):
    end, speed = 1.2e-5, 8.0
    place = kerf(column({"displacement": [speed * end, 0, 0], "times": [0, 2 * end], "factors": [0, 2]}, end))
    given = kerf(column({"velocity": [speed, 0, 0]}, end))
    # The one is exact at the end of every step, the other adds up. The last bit of 0.3 m, in a step of 1e-7 s, is
    # 5e-10 m/s.
    for name, tolerance in (("velocity", 1e-8), ("displacement", 1e-14)):
        assert np.abs(place.results.node(name, -1) - given.results.node(name, -1)).max() < tolerance
    assert place.summary["energy"]["external"] == pytest.approx(given.summary["energy"]["external"], rel=1e-9)
    # Behind the front all moves at that speed, under the stress rho c v: work is stress times area times way.
    work = DENSITY * WAVE_SPEED * speed * AREA * speed * end
    assert place.summary["energy"]["external"] == pytest.approx(work, rel=0.01)
    assert worst_balance(place) < 1e-9


def test_the_place_is_exact_whenever_it_is_looked_at(kerf):
    curve = {"times": [0, 3e-6, 5e-6, 9e-6], "values": [0, 1, -0.5, 0.25]}
    run = kerf(column({"displacement": [2e-5, 0, 0], "curve": "way"}, 1.2e-5, curve=curve, n_results=40))
    assert len(run.results.times) > 30
    for frame, time in enumerate(run.results.times):
        wanted = 2e-5 * np.interp(time, curve["times"], curve["values"])
        # Displacements are differences of coordinates of 0.3 m, whose last bit is 5.6e-17 m.
        assert np.abs(way_of_end(run, frame) - wanted).max() <= 1.2e-16, time
    # The column is elastic and does not turn; where the slope jumps, so does the velocity, by an impulse in the books.
    assert worst_balance(run) < 1e-9


def test_a_run_that_is_resumed_goes_on_with_the_same_bits(kerf):
    curve = {"times": [0, 3e-6, 5e-6, 9e-6], "values": [0, 1, -0.5, 0.25]}
    model = column({"displacement": [2e-5, 0, 0], "curve": "way", "birth": 0, "death": 8e-6}, 1e-5, curve=curve)
    whole = kerf(model)
    half = whole.summary["cycles"] // 2
    stopped = kerf(model, f"time.maximum_cycles={half}", ranks=3)
    resumed = kerf(model, ranks=2, resumes=stopped)
    assert resumed.summary["state_hash"] == whole.summary["state_hash"]
    assert resumed.summary["energy"] == whole.summary["energy"]


@pytest.mark.parametrize("motion", [{"velocity": [20, 0, 0]},
                                    {"displacement": [2e-4, 0, 0], "times": [0, 1e-5], "factors": [0, 1]}],
                         ids=["velocity", "displacement"])
def test_nodes_are_free_before_birth_and_after_death(kerf, motion):
    birth, death, end = 2e-6, 6e-6, 1.2e-5
    run = kerf(column({**motion, "birth": birth, "death": death}, end))
    time, work = run.history["time"], run.history["external"]
    assert (work[time < birth - STEP] == 0.0).all()
    during = (time > birth + STEP) & (time < death - STEP)
    assert during.sum() > 20 and (np.diff(work[during]) > 0.0).all()
    after = work[time > death + 2 * STEP]
    assert len(after) > 30 and np.ptp(after) == 0.0
    assert after[0] == pytest.approx(DENSITY * WAVE_SPEED * 20**2 * AREA * (death - birth), rel=0.04)
    # At rest until then, the end goes at 20 m/s, up to half a step at either time. Where it is free again, its stress
    # rho c v vanishes and with that its speed, since c is the same in compression and release.
    moved = np.array([way_of_end(run, f).mean() for f in range(len(run.results.times))])
    times = run.results.times
    assert (moved[times < birth] == 0.0).all()
    last = np.flatnonzero(times < death)[-1]
    assert moved[last] == pytest.approx(20 * (times[last] - birth), abs=20 * STEP)
    assert moved[-1] == pytest.approx(20 * (death - birth), rel=0.03)
    assert worst_balance(run) < 1e-9


def test_a_displacement_counts_from_the_place_at_birth(kerf):
    """The body flies before; the motion then brings it no further than its curve has gone since."""
    model = column({"displacement": [4e-5, 0, 0], "times": [0, 8e-6], "factors": [0, 1], "birth": 4e-6}, 8e-6)
    model["parts"]["body"]["velocity"] = [3, 0, 0]
    run = kerf(model)
    assert way_of_end(run, -1) == pytest.approx(3 * 4e-6 + 4e-5 / 2, abs=5 * STEP)  # at 3 and at 5 m/s
    assert worst_balance(run) < 1e-9
