"""Small models that used to end with a wrong answer, and the right ones: contact holds, makes no energy, feels nothing
where nothing presses. The models are in contact_cases/."""

from pathlib import Path

import numpy as np
import pytest
import yaml

CASES = Path(__file__).parent / "contact_cases"


@pytest.fixture(scope="module")
def case(kerf):
    done = {}

    def run(name, *settings, **options):
        key = name, settings
        if key not in done:
            done[key] = kerf(CASES / f"{name}.yaml", *settings, **options)
        return done[key]

    return run


def with_slide_surface(name, **settings):
    """A model with its first part as the slave and its second one as the master of a slide surface."""
    model = yaml.safe_load((CASES / f"{name}.yaml").read_text())
    slave, master = list(model["parts"])[:2]
    model["contacts"] = [{"type": "slide_surface", "slave": slave, "master": master, **settings}]
    return model


@pytest.mark.parametrize("symmetric", [False, True])
@pytest.mark.parametrize("name", ["c40_corner", "c46_contact_feeds"])
def test_frictionless_slide_surface_gives_no_energy(kerf, name, symmetric):
    """Without damping, what pairs took in comes back, and no more than that."""
    run = kerf(with_slide_surface(name, symmetric=symmetric))
    energy, contact = run.summary["energy"], run.history["contact"]
    assert contact.min() >= -1e-12 * energy["initial"]  # round-off of the sums
    assert energy["contact_given_back"] == 0.0
    assert abs(energy["balance_error"]) < 1e-3
    assert run.summary["contact_let_go"]["nodes"] == 0


@pytest.mark.parametrize("symmetric", [False, True])
def test_flush_plates_of_a_slide_surface_meet_as_those_of_an_eroding_surface_do(case, kerf, symmetric):
    """Whole parts are named: nodes of a rim must not be pushed by the sides, which once made 3.6 % of the energy."""
    slide = kerf(with_slide_surface("c29_contact_zone", symmetric=symmetric, penalty=0.4))
    for part, state in case("c29_contact_zone").summary["parts"].items():
        # Velocities of 100 m/s; cells are the same to round-off, which some hundred cycles add up.
        assert slide.summary["parts"][part]["velocity"] == pytest.approx(state["velocity"], abs=1e-7)


def test_a_slide_surface_stops_soft_blocks_that_are_faster_than_their_waves(kerf):
    parts = kerf(with_slide_surface("c33c_soft_fast", symmetric=True)).summary["parts"]
    assert 0.0 < parts["a"]["velocity"][0] < 15.0 and -15.0 < parts["b"]["velocity"][0] < 0.0  # of 150 m/s


def test_more_than_a_limit_of_let_go_nodes_stops_a_run(kerf):
    """Nodes are held by one side only, and to a tenth of a cell: some of the slaves pass."""
    model = with_slide_surface("c33c_soft_fast", symmetric=False, depth=0.1)
    summary = kerf(model, "checks.let_go=1").summary
    let_go = summary["contact_let_go"]
    assert any(f"contact has let go of {let_go['nodes']} nodes" in w for w in summary["warnings"])
    # A tenth of cells of 2 mm that are compressed to a tenth and less.
    assert let_go["nodes"] > 0 and let_go["deepest"] > 1e-6
    run = kerf(model, "checks.let_go=0", completes=False)
    assert run.process.returncode == 3
    assert "contact has let go of" in run.process.stderr


@pytest.mark.parametrize("name", ["c40_corner", "c46_contact_feeds", "c33c_soft_fast"])
def test_frictionless_contact_gives_no_energy(case, name):
    energy = case(name).summary["energy"]
    contact = case(name).history["contact"]
    assert contact.min() >= -1e-12 * energy["initial"]  # round-off of the sums
    # Central differences credit half of a step's kick to either side of it: what contact gives back within the run.
    assert np.maximum.accumulate(contact)[-1] - contact[-1] < 1e-3 * energy["initial"]
    assert energy["contact_given_back"] == 0.0
    assert abs(energy["balance_error"]) < 1e-3


def test_soft_blocks_faster_than_their_waves_stop_each_other(case):
    a, b = (case("c33c_soft_fast").summary["parts"][p]["velocity"][0] for p in "ab")
    assert 0.0 < a < 15.0 and -15.0 < b < 0.0  # of 150 m/s; they may keep a tenth, but may not pass


def test_a_flush_block_without_load_feels_nothing(case):
    parts = case("c19_flush_slide").summary["parts"]
    # Round-off of positions of 1e-2 m is 1e-18 m, in a step of 1e-7 s: some 1e-11 m/s.
    assert parts["slider"]["velocity"][0] == pytest.approx(200.0, abs=1e-9)
    assert np.abs(parts["slider"]["velocity"][1:] + parts["plate"]["velocity"]).max() < 1e-9


def test_plates_strain_each_other_as_a_rigid_wall_does(case):
    """By symmetry each of two equal plates is a plate on a wall at half of the speed: to round-off, the same cells."""

    def face(name, x):
        r = case(name).results
        at = np.abs(r.centres(0)[:, 0] - x) < 0.06e-3
        assert at.any()
        return r.cell("effective_plastic_strain", -1)[at], r.cell("pressure", -1)[at]

    for found, wall in zip(face("c29_contact_zone", 0.05e-3), face("c29w_wall", 0.05e-3)):
        assert found == pytest.approx(wall, rel=1e-5)  # results are in single precision


def test_energy_balances_whatever_dies_when(case):
    history = case("c13_empty_rank").history
    assert history["eroded_count"][-1] == 512
    assert np.abs(history["balance_error"]).max() < 1e-3
    assert case("c13_empty_rank").summary["parts"]["flyer"]["velocity"] == pytest.approx([0, 0, -600], abs=1e-9)


def test_an_interface_of_several_cells_stays_flat(case):
    r = case("d2_lateral_2x2").results
    face = np.abs(r.points(0)[:, 0]) < 1e-9
    x = r.points(-1)[face, 0]
    assert np.ptp(x) < 1e-6 * 50e-6  # of a cell
    energy = case("d2_lateral_2x2").summary["energy"]
    assert energy["hourglass"] < 1e-9 * energy["initial"]


def test_gases_at_rest_with_internal_energy_start_and_meet_in_the_star_state(case):
    """Sod's tube as two bodies; star pressure 0.30313 (G.A. Sod, J. Comput. Phys. 27 (1978) 1-31)."""
    run = case("d9_energy_check_initial_energy")
    # Internal energy p / (gamma - 1) over 0.5 m of 1e-4 m2 on either side.
    assert run.summary["energy"]["initial"] == pytest.approx((2.5 + 0.25) * 0.5e-4, rel=1e-9)
    r = run.results
    x, pressure = r.centres(-1)[:, 0], r.cell("pressure", -1)
    star = pressure[(x > 0.03) & (x < 0.30)]  # between the tail of the fan, at -0.014 m, and the shock, at 0.35 m
    assert np.median(star) == pytest.approx(0.30313, rel=0.01)
    assert abs(run.summary["energy"]["balance_error"]) < 2e-3


LAWS = {
    "eroding_surface": {"type": "eroding_surface"},
    "slide_surface": {"type": "slide_surface", "slave": "flyer", "master": "target"},
    "symmetric_slide_surface": {"type": "slide_surface", "slave": "flyer", "master": "target", "symmetric": True},
}
MATERIALS = {"al": (2785, 5328, 1.338, 2.0), "w": (19224, 4029, 1.237, 1.54), "gelatine": (1030, 1553, 1.93, 1.0)}


@pytest.mark.parametrize("flyer, target, speed", [("al", "al", 100), ("al", "al", 3e3), ("al", "al", 1e4),
                                                  ("w", "w", 5e3), ("w", "gelatine", 5e3), ("gelatine", "w", 5e3)])
@pytest.mark.parametrize("cells", [1, 2])
@pytest.mark.parametrize("contact", list(LAWS))
def test_pressure_of_plate_impact_is_that_of_the_hugoniots(kerf, contact, flyer, target, speed, cells):
    expect_hugoniot_state(kerf, contact, flyer, target, speed, (cells, cells), cells)


# Interfaces of cells 1:2 and 1:3 across used to buckle from 3 km/s on, until the plates had passed through each other.
@pytest.mark.parametrize("flyer, target, speed, cells", [
    ("al", "al", 7e3, (4, 2)), ("al", "al", 1e4, (2, 4)), ("al", "al", 7e3, (8, 2)), ("al", "al", 3e3, (6, 2)),
    ("al", "w", 5e3, (2, 6)), ("w", "al", 5e3, (2, 6)), ("gelatine", "gelatine", 3e3, (4, 2))])
@pytest.mark.parametrize("contact", ["eroding_surface", "symmetric_slide_surface"])
def test_plates_of_different_cells_do_not_buckle(kerf, contact, flyer, target, speed, cells):
    expect_hugoniot_state(kerf, contact, flyer, target, speed, cells, 2)


def expect_hugoniot_state(kerf, contact, flyer, target, speed, cells, width_in_lengths):
    """Impedance match of two linear Hugoniots, u_s = c + s u (M.A. Meyers, Dynamic Behavior of Materials, 1994, 4.4).
    Plates of so many cells across, flyer and target, and as wide as so many cells are long."""
    (rho_f, c_f, s_f, _), (rho_t, c_t, s_t, _) = MATERIALS[flyer], MATERIALS[target]
    low, high = 0.0, speed
    for _ in range(100):
        u = 0.5 * (low + high)
        p = rho_t * (c_t + s_t * u) * u
        low, high = (u, high) if p < rho_f * (c_f + s_f * (speed - u)) * (speed - u) else (low, u)
    shock_t, shock_f = c_t + s_t * u, c_f + s_f * (speed - u)
    length, n = 5e-3, 100
    width = width_in_lengths * length / n
    end = 0.6 * length / max(shock_t, shock_f)

    def material(name):
        rho, c, s, gamma = MATERIALS[name]
        eos = {"type": "mie_gruneisen", "c0": c, "s": s, "gamma0": gamma}
        return {"density": rho, "strength": {"type": "hydrodynamic"}, "eos": eos}

    def plate(name, origin, velocity, across):
        mesh = {"type": "block", "origin": [origin, 0, 0], "size": [length, width, width], "cells": [n, across, across]}
        return {"material": name, "mesh": mesh, "velocity": [velocity, 0, 0]}

    planes = [{"type": "symmetry", "point": point, "normal": normal} for point, normal in (
        ([0, 0, 0], [0, 1, 0]), ([0, 0, 0], [0, 0, 1]), ([0, width, 0], [0, -1, 0]), ([0, 0, width], [0, 0, -1]))]
    run = kerf({
        "title": "plate impact", "time": {"end": end},
        "materials": {"f": material(flyer), "t": material(target)},
        "parts": {"flyer": plate("f", -length, speed, cells[0]), "target": plate("t", 0.0, 0.0, cells[1])},
        "boundaries": planes, "contacts": [LAWS[contact]],
        "output": {"results_interval": end, "precision": "double", "element_fields": ["pressure"],
                   "node_fields": ["velocity"]},
    })
    r, face = run.results, u * end
    behind_t, behind_f = 0.4 * (shock_t * end - face), 0.4 * (face - (speed - shock_f) * end)
    x = r.centres(-1)[:, 0]
    shocked = (x > face - behind_f) & (x < face + behind_t)
    nodes = r.points(-1)[:, 0]
    moving = (nodes > face - behind_f) & (nodes < face + behind_t)
    # The marks of the field for a plateau between ringing shocks: 1 % of the pressure, 0.5 % of the velocity.
    assert r.cell("pressure", -1)[shocked].mean() == pytest.approx(p, rel=0.01)
    assert r.node("velocity", -1).reshape(-1, 3)[moving, 0].mean() == pytest.approx(u, rel=0.005)
    assert run.summary["contact_let_go"]["nodes"] == 0


def test_bodies_inside_each_other_at_the_end_are_warned_of(kerf):
    """A slide surface of faces that do not meet lets a block through: the run must not end without a word."""
    model = yaml.safe_load((CASES / "c33c_soft_fast.yaml").read_text())
    model["time"]["end"] = "40 us"
    model["sets"] = {"back": {"parts": "a", "face": "x_min"}, "front": {"parts": "b", "face": "x_min"}}
    model["contacts"] = [{"type": "slide_surface", "slave": "back", "master": "front"}]
    run = kerf(model)
    warnings = [w for w in run.summary["warnings"] if "contact did not keep them apart" in w]
    assert len(warnings) == 1 and "parts a and b overlap at the end" in warnings[0]
    assert warnings[0] in run.process.stderr


def test_bodies_driven_into_each_other_without_a_contact_are_warned_of(kerf):
    """Velocities of parts foretell no collision where a boundary condition drives a body."""
    steel = {"density": 7800, "strength": {"type": "elastic", "shear_modulus": "80 GPa"},
             "eos": {"type": "linear", "bulk_modulus": "160 GPa"}}
    cube = {"type": "block", "size": "[4, 4, 4] mm", "cells": [2, 2, 2]}
    run = kerf({
        "title": "driven", "time": {"end": "20 us"}, "materials": {"steel": steel},
        "parts": {"upper": {"material": "steel", "mesh": {**cube, "origin": "[0, 0, 0.1] mm"}},
                  "lower": {"material": "steel", "mesh": {**cube, "origin": "[0, 0, -4] mm"}}},
        "sets": {"top": {"parts": "upper", "face": "z_max"}},
        "boundaries": [{"type": "prescribed_motion", "nodes": "top", "velocity": "0 0 -100 m/s"}],
    })
    warnings = [w for w in run.summary["warnings"] if "no contact definition covers both" in w]
    assert len(warnings) == 1 and "parts upper and lower overlap at the end" in warnings[0]
    assert warnings[0] in run.process.stderr
