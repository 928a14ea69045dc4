"""Free bodies that collide through contact: momentum, energy, Coulomb friction."""

import math

import numpy as np
import pytest

RHO = 7800.0
STEEL = {
    "density": RHO,
    "strength": {"type": "elastic", "shear_modulus": "80 GPa"},
    "eos": {"type": "linear", "bulk_modulus": "160 GPa"},
}
CONTACTS = {
    "slide_surface": {"type": "slide_surface", "slave": "hammer", "master": "anvil", "symmetric": True},
    "eroding_surface": {"type": "eroding_surface"},
}


def block(origin, size, cells, velocity):
    mesh = {"type": "block", "origin": origin, "size": size, "cells": cells}
    return {"material": "steel", "mesh": mesh, "velocity": velocity}


def collision(contact, hammer, anvil, end, **rest):
    return {
        "title": "two free bodies collide",
        "time": {"end": end},
        "materials": {"steel": STEEL},
        "parts": {"hammer": hammer, "anvil": anvil},
        "contacts": [contact],
        **rest,
    }


@pytest.fixture(scope="module", params=list(CONTACTS))
def oblique(request, kerf):
    """A turned cube strikes a larger block obliquely and off its centre, with friction; both fly on and turn."""
    hammer = block([-2e-3, -2e-3, -2e-3], [4e-3] * 3, [4, 4, 4], [40, 10, -100])
    hammer["placement"] = [{"angle": "20 deg", "axis": [1, 2, 0.5], "translate": [1e-3, 0.5e-3, 3.1e-3]}]
    anvil = block([-4e-3, -4e-3, -4e-3], [8e-3, 8e-3, 4e-3], [7, 7, 4], [0, 0, 0])
    contact = {**CONTACTS[request.param], "friction": 0.2}
    return kerf(collision(contact, hammer, anvil, "60 us", output={"history_interval": "0.2 us"}))


def test_bodies_have_met_and_parted(oblique):
    parts = oblique.summary["parts"]
    assert parts["hammer"]["velocity"][2] - parts["anvil"]["velocity"][2] > 5.0
    assert abs(oblique.history["contact"][-1] - oblique.history["contact"][-20]) < 1e-9 * oblique.history["kinetic"][0]


def test_collision_conserves_momentum_to_round_off(oblique):
    momentum = oblique.summary["momentum"]
    scale = np.linalg.norm(momentum["initial"])
    drift = np.abs(np.array(momentum["final"]) - momentum["initial"]).max() / scale
    history = max(np.abs(oblique.history[f"momentum_{a}"] - momentum["initial"][i]).max() for i, a in enumerate("xyz"))
    print("drift of the momentum", drift, "largest over the run", history / scale)
    # Forces are equal and opposite in whole quanta; velocities round to 1e-16 of theirs in each of some 500 cycles.
    assert drift < 1e-13
    assert history / scale < 1e-13


def test_collision_balances_its_energy(oblique):
    print("balance error", oblique.summary["energy"]["balance_error"])
    assert abs(oblique.summary["energy"]["balance_error"]) < 5e-3


@pytest.mark.parametrize("kind", list(CONTACTS))
def test_equal_bars_exchange_their_velocities(kerf, kind):
    """Two equal elastic bars of one material, flush: the striking one stops, the other leaves with its speed. A slide
    surface is told the faces that meet, as is its custom: to a node of the rim the sides are as near as the front."""
    speed = 10.0
    hammer = block([0, 0, 0.02e-3], [2e-3, 2e-3, 20e-3], [2, 2, 20], [0, 0, -speed])
    anvil = block([0, 0, -20e-3], [2e-3, 2e-3, 20e-3], [2, 2, 20], [0, 0, 0])
    faces = {"struck": {"parts": "anvil", "face": "z_max"}, "striking": {"parts": "hammer", "face": "z_min"}}
    contact = dict(CONTACTS[kind])
    if kind == "slide_surface":
        contact |= {"slave": "striking", "master": "struck"}
    run = kerf(collision(contact, hammer, anvil, "14 us", sets=faces))
    parts = run.summary["parts"]
    # Lateral vibration of the bars, viscosity and the penalty's stiffness keep some per cent.
    assert parts["hammer"]["velocity"][2] == pytest.approx(0.0, abs=0.06 * speed)
    assert parts["anvil"]["velocity"][2] == pytest.approx(-speed, abs=0.06 * speed)
    # Flush bars stay straight, but for what the unequal roles of slave and master do. With eroding_surface round-off
    # decides whether a rim node lies over the other bar's rim: at five step sizes the drift was 1e-8 to 1.1e-6.
    assert np.abs(np.array(parts["anvil"]["velocity"][:2])).max() < (1e-3 if kind == "slide_surface" else 3e-6) * speed
    assert run.summary["energy"]["hourglass"] < 0.02 * run.summary["energy"]["initial"]


def impulses(run, start):
    parts = run.summary["parts"]
    hammer, anvil = parts["hammer"], parts["anvil"]
    gained = hammer["mass"] * (np.array(hammer["velocity"]) - start)
    return gained, anvil["mass"] * np.array(anvil["velocity"])


@pytest.mark.parametrize("kind", list(CONTACTS))
@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_friction_impulse_is_coulombs_share_of_the_normal_impulse(kerf, kind, friction):
    """A plate falls flat on another while it slides fast: at every moment the friction force is mu times the normal
    force and against the sliding, so the same holds for the impulses, whatever the plates do inside."""
    start = np.array([100.0, 0.0, -5.0])
    hammer = block([-3e-3, -3e-3, 0.01e-3], [6e-3, 6e-3, 2e-3], [6, 6, 2], start.tolist())
    anvil = block([-8e-3, -8e-3, -3e-3], [16e-3, 16e-3, 3e-3], [17, 17, 3], [0, 0, 0])
    run = kerf(collision({**CONTACTS[kind], "friction": friction}, hammer, anvil, "15 us"))
    gained, given = impulses(run, start)
    assert gained == pytest.approx(-given, abs=1e-12 * np.linalg.norm(gained))
    assert gained[2] > 5e-3 * 0.5 * run.summary["parts"]["hammer"]["mass"]
    assert -gained[0] / gained[2] == pytest.approx(friction, rel=0.01)
    assert abs(gained[1]) < 0.01 * abs(gained[0])


def test_friction_slows_a_pressed_block_on_a_rigid_wall(kerf):
    """A block that is pressed on a wall by its own momentum: the same ratio from the wall's impulse."""
    model = {
        "title": "a block slides along a rigid wall",
        "time": {"end": "8 us"},
        "materials": {"steel": STEEL},
        "parts": {"hammer": block([0, 0, 0], [4e-3, 4e-3, 2e-3], [4, 4, 2], [200, 0, -5])},
        "boundaries": [{"type": "rigid_wall", "point": [0, 0, 0], "normal": [0, 0, 1], "friction": 0.25}],
    }
    impulse = kerf(model).summary["momentum"]["external_impulse"]
    assert impulse[2] > 0
    assert -impulse[0] / impulse[2] == pytest.approx(0.25, rel=0.01)


def test_friction_stops_a_pressed_plate(kerf):
    """Two plates pressed together by prescribed motion; the upper slides at first and comes to rest: friction never
    reverses the sliding. In x the upper plate is free."""
    upper = block([-2e-3, -2e-3, 0.0], [4e-3, 4e-3, 2e-3], [4, 4, 2], [5, 0, 0])
    lower = block([-5e-3, -4e-3, -2e-3], [10e-3, 8e-3, 2e-3], [11, 9, 2], [0, 0, 0])
    model = collision({**CONTACTS["eroding_surface"], "friction": 0.5}, upper, lower, "40 us", sets={
        "top": {"parts": "hammer", "face": "z_max"},
        "bottom": {"parts": "anvil", "face": "z_min"},
    }, boundaries=[
        {"type": "fixed", "nodes": "bottom"},
        {"type": "prescribed_motion", "nodes": "top", "components": "z", "velocity": [0, 0, -1]},
    ], output={"history_interval": "0.2 us"})
    run = kerf(model, "checks.energy_growth=1")
    mass = run.summary["parts"]["hammer"]["mass"]
    momentum = run.history["momentum_x"] / mass
    assert momentum[0] == pytest.approx(5.0)
    # At rest on the lower plate but for the shear vibration of both, which sticking friction does not damp: a quarter
    # wave in 4 mm of steel, 5 us. The mean over four periods is that of a plate that does not slide.
    assert abs(momentum[-100:].mean()) < 0.3
    assert np.abs(momentum).max() < 5.001  # friction never drives
    assert math.isfinite(run.summary["energy"]["contact"]) and run.summary["energy"]["contact"] > 0.0
