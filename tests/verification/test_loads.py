"""Loads against closed forms: falling, pushed and pressed bodies, whose impulse and energy are in the books."""

import numpy as np
import pytest

SHEAR, BULK, DENSITY = 80e9, 160e9, 7850.0
WAVE_SPEED = ((BULK + 4 / 3 * SHEAR) / DENSITY) ** 0.5  # of plane waves [m/s]


def body(mesh, end, *, loads, curves=None, boundaries=(), sets=None, step=None, strength=None, velocity=(0, 0, 0)):
    """A model of one body, elastic unless said otherwise."""
    return {
        "title": "a loaded body",
        "time": {"end": end, **({"maximum_step": step} if step else {})},
        "materials": {"steel": {
            "density": DENSITY, "strength": strength or {"type": "elastic", "shear_modulus": SHEAR},
            "eos": {"type": "linear", "bulk_modulus": BULK}}},
        "parts": {"body": {"material": "steel", "mesh": mesh, "velocity": list(velocity)}},
        "curves": curves or {}, "loads": loads, "boundaries": list(boundaries), "sets": sets or {},
        "output": {"precision": "double", "results_interval": end, "history_interval": end / 20,
                   "element_fields": ["stress", "pressure"], "node_fields": ["velocity", "displacement"]},
    }


def planes(*names):
    """Planes of symmetry through the origin, or on the far side of a body: {"x": 0, "y": 0.01}."""
    axes = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}
    return [{"type": "symmetry", "normal": [sign * c for c in axes[name]],
             "point": [abs(c) * at for c in axes[name]]} for name, at, sign in names]


def worst_balance(run):
    return np.abs(run.history["balance_error"]).max()


def test_a_free_block_falls(kerf):
    g, end, step = 1e6, 1e-4, 2e-7
    mesh = {"type": "block", "size": [0.02, 0.01, 0.01], "cells": [4, 3, 2]}
    run = kerf(body(mesh, end, step=step, velocity=(3, 0, 0),
                    loads=[{"type": "gravity", "acceleration": [0, 0, -g]}]))
    moved, speed = run.results.node("displacement", -1), run.results.node("velocity", -1)
    # Five hundred equal steps: central differences add up to the parabola, but for round-off of positions of 0.02 m.
    assert moved[:, 2] == pytest.approx(-g * end**2 / 2, rel=1e-9)
    assert moved[:, 0] == pytest.approx(3 * end, rel=1e-9)
    assert np.ptp(speed[:, 2]) <= 1e-6  # no strain, but for the rounding of positions times the modulus
    mass = run.summary["mass"]["initial"]
    # The books take energies half a step back and forth, at v^2 - (g dt/2)^2 (doc/theory/energy_balance.md).
    assert run.history["external"][-1] == pytest.approx(mass * g**2 * (end**2 - step**2 / 4) / 2, rel=1e-9)
    # The work on 60 nodes in 500 steps is rounded to half a quantum of 5e-13 J each time, which adds up to 3e-11 J at
    # random; the error is relative to the initial 0.07 J, or to the work.
    assert worst_balance(run) < 1e-9
    final, impulse = run.summary["momentum"]["final"], run.summary["momentum"]["external_impulse"]
    initial = run.summary["momentum"]["initial"]
    # Every node's impulse is rounded alike in every step, by half of 1.8e-15 kg m/s at most: 60 nodes, 500 steps.
    assert final == pytest.approx([i + e for i, e in zip(initial, impulse)], abs=3e-11)


def test_a_force_on_nodes_is_the_sum_over_them(kerf):
    mesh = {"type": "block", "size": [0.02, 0.01, 0.01], "cells": [4, 3, 2]}
    run = kerf(body(mesh, 4e-5, step=2e-7, sets={"end": {"face": "x_min"}},
                    curves={"pulse": {"times": [0, 1e-5, 2e-5], "values": [0, 1, 0]}},
                    loads=[{"type": "nodal_force", "nodes": "end", "force": [100, -20, 0], "curve": "pulse"}]))
    n_nodes = 4 * 3
    expected = [100 * n_nodes * 1e-5, -20 * n_nodes * 1e-5, 0]
    # The trapezoidal rule is exact: the pulse bends where steps end.
    assert run.summary["momentum"]["external_impulse"] == pytest.approx(expected, rel=1e-10, abs=1e-15)
    assert run.summary["momentum"]["final"] == pytest.approx(expected, rel=1e-10, abs=1e-12)
    assert worst_balance(run) < 1e-9


COLUMN = {"type": "block", "size": [0.1, 0.002, 0.003], "cells": [100, 1, 1]}
ROUND = planes(("y", 0, 1), ("z", 0, 1), ("y", 0.002, -1), ("z", 0.003, -1))  # one-dimensional strain


def test_a_pressure_ramp_gives_area_times_its_integral(kerf):
    peak, end = 3e8, 4e-5
    run = kerf(body(COLUMN, end, step=1e-7, boundaries=ROUND, sets={"end": {"face": "x_min"}},
                    curves={"ramp": {"times": [0, 1e-5, 2e-5], "values": [0, 1, 0]}},
                    loads=[{"type": "pressure", "facets": "end", "pressure": peak, "curve": "ramp"}]))
    impulse = 0.002 * 0.003 * peak * 1e-5
    # Straight between the ends of steps, on an area that the planes keep: exact but for round-off.
    assert run.summary["momentum"]["external_impulse"][0] == pytest.approx(impulse, rel=1e-10)
    assert run.summary["momentum"]["final"][0] == pytest.approx(impulse, rel=1e-10)
    assert worst_balance(run) < 1e-9


def test_a_triangular_pulse_gives_a_plate_half_its_peak_times_its_duration(kerf):
    """A pulse of blast as a curve, which jumps to its peak at the start: on a free plate, then on a clamped one."""
    peak, duration, end, side, thickness = 2e7, 2e-5, 4e-5, 0.02, 0.002
    mesh = {"type": "block", "size": [side, side, thickness], "cells": [8, 8, 3]}
    sets = {"top": {"face": "z_max"}, "rim": {"parts": "body", "box": [-1, -1, -1, 1e-6, 1, 1]}}
    pulse = dict(curves={"triangle": {"times": [0, duration], "values": [1, 0]}}, sets=sets,
                 loads=[{"type": "pressure", "facets": "top", "pressure": peak, "curve": "triangle"}])
    run = kerf(body(mesh, end, step=1e-7, **pulse))
    impulse = -peak * duration / 2 * side**2
    # Straight over each step, and the kick of the first is half a step long: exact on the plate's first area, which
    # bending and Poisson's ratio change by the stress over the modulus, 1e-4.
    assert run.summary["momentum"]["external_impulse"][2] == pytest.approx(impulse, rel=3e-4)
    assert run.summary["momentum"]["final"][2] == pytest.approx(impulse, rel=3e-4)
    # It turns cells by up to a thousandth, and the square of that is what the work of stress misses of that of forces.
    assert worst_balance(run) < 1e-6
    held = kerf(body(mesh, end, step=1e-7, boundaries=[{"type": "fixed", "nodes": "rim"}], **pulse))
    # Held at one edge, it turns by some thousandths. What the rim takes is in the books as well.
    assert worst_balance(held) < 1e-5
    assert abs(held.summary["momentum"]["final"][2]) < 0.99 * abs(impulse)
    impulses = held.summary["momentum"]
    assert impulses["final"][2] == pytest.approx(impulses["external_impulse"][2], rel=1e-9)


def test_a_pressed_column_carries_the_plane_wave(kerf):
    """Behind the front of a step of pressure p, stress is -p and the velocity p/(rho c)."""
    p, end = 1e8, 1.2e-5
    run = kerf(body(COLUMN, end, step=1e-7, boundaries=ROUND, sets={"end": {"face": "x_min"}},
                    curves={"step": {"times": [0, 5e-7], "values": [0, 1]}},
                    loads=[{"type": "pressure", "facets": "end", "pressure": p, "curve": "step"}]))
    front = WAVE_SPEED * (end - 2.5e-7)
    centres, stress = run.results.centres(-1), run.results.cell("stress", -1)
    behind = centres[:, 0] < front - 0.01
    ahead = centres[:, 0] > front + 0.01
    assert behind.sum() > 40 and ahead.sum() > 20
    # The front is five cells wide and leaves a ripple of a per cent behind; the strain is 3e-4.
    assert stress[behind, 0] == pytest.approx(-p, rel=0.02)
    assert np.abs(stress[ahead, 0]).max() < 0.01 * p
    speed = p / (DENSITY * WAVE_SPEED)
    points, velocity = run.results.points(-1), run.results.node("velocity", -1)
    assert velocity[points[:, 0] < front - 0.01, 0] == pytest.approx(speed, rel=0.02)
    # The end moves at that speed: work is force times way. The lag of the ramp is part of `end - 2.5e-7`.
    work = 0.002 * 0.003 * p * speed * (end - 2.5e-7)
    assert run.summary["energy"]["external"] == pytest.approx(work, rel=0.02)
    assert worst_balance(run) < 1e-9


def test_a_cylinder_under_slowly_rising_pressure_shrinks_as_in_elastostatics(kerf):
    """A solid cylinder in plane strain under pressure p on its lateral face: the stress in its section is -p, and the
    radial strain -p (1 + nu)(1 - 2 nu)/E = -p / (2 (K + G/3))."""
    p, end, radius = 1e8, 4e-4, 0.01
    mesh = {"type": "cylinder", "radius": radius, "length": 0.002, "core_cells": 3, "ring_cells": 3, "axial_cells": 1,
            "sector": "quarter"}
    run = kerf(body(mesh, end, boundaries=planes(("x", 0, 1), ("y", 0, 1), ("z", 0, 1), ("z", 0.002, -1)),
                    sets={"rim": {"face": "lateral"}},
                    curves={"slow": {"times": np.linspace(0, end, 101).tolist(),
                                     "values": (np.sin(np.linspace(0, np.pi / 2, 101)) ** 2).tolist()}},
                    loads=[{"type": "pressure", "facets": "rim", "pressure": p, "curve": "slow"}]))
    stress = run.results.cell("stress", -1)
    # Some seventy periods of the radial oscillation long, with a smooth start and end: it hardly oscillates.
    assert stress[:, 0] == pytest.approx(-p, rel=2e-3)
    assert stress[:, 1] == pytest.approx(-p, rel=2e-3)
    start, moved = run.results.points(0), run.results.node("displacement", -1)
    outward = (start[:, :2] * moved[:, :2]).sum(axis=1) / radius
    rim = np.hypot(start[:, 0], start[:, 1]) > 0.999 * radius
    assert outward[rim] == pytest.approx(-radius * p / (2 * (BULK + SHEAR / 3)), rel=5e-3)
    assert worst_balance(run) < 1e-6


def test_a_gas_is_held_by_the_pressure_round_it(kerf):
    """A uniform pressure on the faces of distorted cells meets the nodal forces of a uniform pressure in them."""
    p = 1e5
    model = body({"type": "cylinder", "radius": 0.01, "length": 0.03, "cell_size": 0.003,
                  "nose": {"type": "ogival", "caliber_radius_head": 2.0}}, 2e-4,
                 loads=[{"type": "pressure", "facets": "body", "pressure": p}])
    model["materials"] = {"steel": {
        "density": 1.0, "strength": {"type": "hydrodynamic"},
        "eos": {"type": "linear_polynomial", "C4": 0.4, "C5": 0.4, "initial_energy": p / 0.4}}}
    run = kerf(model)
    # Sound crosses the body twice in this time. Forces differ by quanta, 2^-57 of the largest force that fits.
    assert np.abs(run.results.node("velocity", -1)).max() < 1e-9 * (1.4 * p) ** 0.5
    assert run.results.cell("pressure", -1) == pytest.approx(p, rel=1e-12)


def test_pressure_all_round_a_body_gives_it_no_momentum(kerf):
    mesh = {"type": "cylinder", "radius": 0.01, "length": 0.03, "cell_size": 0.003}
    run = kerf(body(mesh, 1e-5, step=1e-7, loads=[{"type": "pressure", "facets": "body", "pressure": 1e8}]))
    pressed = 1e8 * np.pi * 0.01**2 * 1e-5  # the impulse on one end
    assert np.abs(run.summary["momentum"]["final"]).max() < 1e-10 * pressed
    assert run.summary["energy"]["external"] > 0.0
    # The strain is a thousandth, and its square what the work of stress in a step misses of the work of forces.
    assert worst_balance(run) < 1e-5


def test_energy_closes_with_all_loads_on_a_plastic_body(kerf):
    mesh = {"type": "block", "size": [0.02, 0.01, 0.01], "cells": [6, 4, 4]}
    run = kerf(body(mesh, 5e-5, sets={"end": {"face": "x_min"}, "tip": {"face": "x_max"}},
                    strength={"type": "elastic_plastic", "shear_modulus": SHEAR, "yield_stress": 3e8,
                              "hardening_modulus": 1e9},
                    boundaries=[{"type": "fixed", "nodes": "tip"}],
                    curves={"ramp": {"times": [0, 2e-5], "values": [0, 1]},
                            "beat": {"times": [0, 1e-6, 3e-6], "values": [0, 1, -1], "period": 4e-6}},
                    loads=[{"type": "pressure", "facets": ["end", "body"], "pressure": 6e8, "curve": "ramp"},
                           {"type": "gravity", "acceleration": [0, 1e7, 0], "curve": "beat"},
                           {"type": "nodal_force", "nodes": "end", "force": [0, 0, 500], "curve": "beat"}]))
    # What elements and loads round are quanta, but a step's work is not the integral over it where it has plastic
    # strain and the step changes its length.
    assert worst_balance(run) < 1e-3
    assert run.summary["energy"]["external"] > 0.0


def test_a_damped_block_slows_along_the_directions_that_are_named(kerf):
    c, end, step = 2e4, 1e-4, 2e-7
    mesh = {"type": "block", "size": [0.02, 0.01, 0.01], "cells": [4, 3, 2]}
    damping = {"type": "mass_damping", "coefficient": c, "factors": [1, 0.5, 0]}
    run = kerf(body(mesh, end, step=step, velocity=(3, 4, -5), loads=[damping]))
    kicks = np.array([step / 2] + [step] * (run.summary["cycles"] - 1))
    speed = run.results.node("velocity", -1)
    # The velocity of the step before sets the force; the last digits are of positions of 0.02 m times the modulus.
    for axis, (start, factor) in enumerate(((3, 1), (4, 0.5), (-5, 0))):
        assert speed[:, axis] == pytest.approx(start * np.prod(1 - c * factor * kicks), abs=1e-6)
    # That is the exponential, but for half of c times the step of the rate: 2e-3.
    assert speed[:, 0] == pytest.approx(3 * np.exp(-c * end), rel=2 * 2e-3 * c * end)
    assert run.summary["energy"]["external"] < 0.0
    assert worst_balance(run) < 1e-9


def test_damping_settles_a_column_and_leaves_the_books_closed(kerf):
    """A quarter wave of a column that is let go under its weight: it decays with half of c and ends at rest."""
    length, g, c = 0.1, 2e5, 4e4
    omega = np.pi / 2 * WAVE_SPEED / length
    end = 2e-4
    boundaries = ROUND + planes(("x", 0, 1))
    damping = {"type": "mass_damping", "coefficient": c}
    model = body(COLUMN, end, step=1e-7, boundaries=boundaries,
                 loads=[{"type": "gravity", "acceleration": [-g, 0, 0]}, damping])
    model["output"]["results_interval"] = end / 400
    run = kerf(model)
    tip = run.results.points(0)[:, 0] == length
    moved = np.array([run.results.node("displacement", f)[tip, 0].mean() for f in range(len(run.results.times))])
    rest = -g * length**2 / (2 * WAVE_SPEED**2)
    # The damped first mode, of which the displacement of the tip has the share 32/pi^3; the higher ones decay alike.
    half = c / 2
    damped = np.sqrt(omega**2 - half**2)
    t = run.results.times
    first = rest * 32 / np.pi**3 * np.exp(-half * t) * (np.cos(damped * t) + half / damped * np.sin(damped * t))
    third = np.sqrt((3 * omega) ** 2 - half**2)
    second = -first[0] / 27 * np.exp(-half * t) * (np.cos(third * t) + half / third * np.sin(third * t))
    assert np.abs(moved - (rest - first - second)).max() < 0.02 * abs(rest)
    assert moved[-1] == pytest.approx(rest, rel=0.05)
    assert worst_balance(run) < 1e-9
    # What gravity did less what is stored is what damping took.
    assert run.summary["energy"]["external"] == pytest.approx(run.summary["energy"]["internal"], rel=0.01)


def test_damping_is_the_same_on_any_ranks_and_after_a_restart(kerf):
    model = body({"type": "block", "size": [0.02, 0.01, 0.01], "cells": [8, 4, 4]}, 2e-5, velocity=(30, 0, 0),
                 sets={"end": {"face": "x_min"}}, boundaries=[{"type": "fixed", "nodes": "end"}],
                 curves={"rise": {"times": [0, 1e-5], "values": [0, 1]}},
                 loads=[{"type": "mass_damping", "nodes": "body", "coefficient": 1e5, "curve": "rise"}])
    whole = kerf(model)
    half = whole.summary["cycles"] // 2
    resumed = kerf(model, ranks=2, resumes=kerf(model, f"time.maximum_cycles={half}", ranks=3))
    assert resumed.summary["state_hash"] == whole.summary["state_hash"]
    assert resumed.summary["energy"]["external"] == whole.summary["energy"]["external"]


def test_damping_that_would_give_energy_stops_the_run(kerf):
    model = body({"type": "block", "size": [0.02, 0.01, 0.01], "cells": [4, 3, 2]}, 1e-4, velocity=(3, 0, 0),
                 curves={"falls": {"times": [0, 1e-5], "values": [1, -1]}},
                 loads=[{"type": "mass_damping", "coefficient": 1e4, "curve": "falls"}])
    run = kerf(model, completes=False)
    assert run.process.returncode == 3
    assert "its curve is negative, and damping cannot give energy" in run.process.stdout + run.process.stderr


def test_damping_that_would_turn_velocities_round_stops_the_run(kerf):
    """Above 2 over the step, velocities would grow without bound and the books would still close."""
    model = body({"type": "block", "size": [0.02, 0.01, 0.01], "cells": [4, 3, 2]}, 1e-4, step=2e-7,
                 velocity=(3, 0, 0), loads=[{"type": "mass_damping", "coefficient": 0.9 / 2e-7}])
    assert kerf(model, "time.maximum_cycles=20").summary["energy"]["kinetic"] >= 0.0
    model["loads"][0]["coefficient"] = 1.1 / 2e-7
    run = kerf(model, completes=False)
    assert run.process.returncode == 3
    assert "coefficient times the time step is above 1" in run.process.stdout + run.process.stderr


@pytest.mark.parametrize("form", ["curve", "table"])
def test_a_motion_follows_a_curve_as_it_follows_its_table(kerf, form):
    table = {"times": [0, 1e-5, 2e-5], "values": [0, 1, 0.5]}
    motion = {"type": "prescribed_motion", "nodes": "end", "velocity": [10, 0, 0]}
    motion |= {"curve": "pull"} if form == "curve" else {"times": table["times"], "factors": table["values"]}
    model = body(COLUMN, 3e-5, loads=[], boundaries=[motion], sets={"end": {"face": "x_min"}},
                 curves={"pull": table} if form == "curve" else None)
    run = kerf(model)
    points = run.results.points(0)
    moved = run.results.node("displacement", -1)[points[:, 0] == 0.0, 0]
    # The velocity is taken at the middle of steps, so its sum differs from the integral only in the steps of the bends.
    assert moved == pytest.approx(10 * (0.5e-5 + 0.75e-5 + 0.5e-5), rel=1e-3)
