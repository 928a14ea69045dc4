"""The blast load in runs: momentum and energy given to a stiff plate, refusals, and the same bits on any ranks."""

import json
import subprocess

import numpy as np
import pytest

# One kilogram at one metre, free air: values of the polynomials in feet and pounds, see tests/point/test_air_blast.cpp.
ARRIVAL, PEAK, IMPULSE = 0.53184e-3, 5005.57e3, 559.033  # [s], [Pa], [Pa s]


def plate(*, strength=None, end=1.2e-3, first=0.53e-3, step=1e-6, blast=None, **more):
    """A steel plate of 20 by 20 by 4 mm, free in space, one metre below a kilogram; the run starts at `first`."""
    return {
        "title": "a plate under a blast", "time": {"end": end - first, "maximum_step": step},
        "materials": {"steel": {
            "density": 7850.0, "strength": strength or {"type": "elastic", "shear_modulus": 80e9},
            "eos": {"type": "linear", "bulk_modulus": 160e9}}},
        "parts": {"plate": {"material": "steel", "mesh": {
            "type": "block", "origin": [-0.01, -0.01, -1.004], "size": [0.02, 0.02, 0.004], "cells": [5, 5, 4]}}},
        "sets": {"top": {"parts": "plate", "face": "z_max"}},
        "loads": [{"type": "air_blast", "facets": "top", "burst": "free_air", "charge_mass": 1.0,
                   "charge_position": [0, 0, 0], "detonation_time": -first, **(blast or {})}],
        "output": {"precision": "double", "results_interval": end, "history_interval": end / 50},
        **more,
    }


def test_a_free_plate_takes_the_reflected_impulse_on_its_area(kerf):
    run = kerf(plate(end=2.4e-3))  # the positive phase lasts until 2.33 ms
    momentum = run.summary["momentum"]
    area = 0.02 * 0.02
    # Rays are 0.4 degrees off the normal at the corners, where cos^2 is 2e-4 less than 1, and Z 1e-4 more; the front
    # arrives within a step, of which up to half the peak is missed: PEAK * 5e-7 s, 0.45 % of the impulse.
    allowed = 3e-4 + 0.5 * 1e-6 * PEAK / IMPULSE
    assert momentum["external_impulse"][2] == pytest.approx(-IMPULSE * area, rel=allowed)
    assert momentum["final"][2] == pytest.approx(momentum["external_impulse"][2], rel=1e-9)
    # Nothing sideways but by symmetry: the four quarters cancel.
    assert np.abs(momentum["final"][:2]).max() < 1e-9 * IMPULSE * area
    # A body that hardly deforms: the work is its kinetic energy, I^2 / 2m, of 0.8 J; its vibrations add below 1 %.
    energy, mass = run.summary["energy"], run.summary["mass"]["initial"]
    assert energy["external"] == pytest.approx(momentum["final"][2] ** 2 / (2 * mass), rel=0.01)
    assert np.abs(run.history["balance_error"]).max() < 1e-6


def test_nothing_acts_before_the_front_arrives(kerf):
    run = kerf(plate(end=ARRIVAL - 2e-6, first=ARRIVAL - 1e-4, step=1e-6))
    assert run.summary["energy"]["external"] == 0.0
    assert run.summary["momentum"]["final"] == [0.0, 0.0, 0.0]


# Facets that look away from the charge, a charge whose blast is over before the run, and one in the middle of the body.
IDLE = {
    "behind": ({"facets": "bottom"}, "can push none of its 25 facets"),
    "over": ({"detonation_time": -10.0}, "can push none of its 25 facets"),
    "inside": ({"facets": "bottom", "charge_position": [0, 0, -1.002]}, "cannot act on 25 of its 25 facets"),
}


@pytest.mark.parametrize("blast, message", IDLE.values(), ids=IDLE.keys())
def test_a_blast_that_would_push_nothing_is_refused(binary, tmp_path, blast, message):
    sets = {name: {"parts": "plate", "face": face} for name, face in (("top", "z_max"), ("bottom", "z_min"))}
    model = plate(blast=blast, end=0.8e-3, sets=sets)
    (tmp_path / "input.yaml").write_text(json.dumps(model))
    done = subprocess.run([str(binary), "check", str(tmp_path / "input.yaml")], capture_output=True, text=True,
                          timeout=100)
    assert done.returncode == 2 and f"error: the load air_blast {message}" in done.stderr, done.stderr


@pytest.mark.parametrize("height, number", [(0.05, 0.05), (60.0, 60.0)])
def test_facets_outside_of_the_table_are_refused(binary, tmp_path, height, number):
    model = plate(blast={"charge_position": [0, 0, height - 1.0]})
    (tmp_path / "input.yaml").write_text(json.dumps(model))
    for command in ("check", "run"):
        words = [str(binary), command, str(tmp_path / "input.yaml")]
        done = subprocess.run(words + (["--output", str(tmp_path / "out")] if command == "run" else []),
                              capture_output=True, text=True, timeout=100)
        assert done.returncode == 2
        # All 25 facets, or those of them that lie too near.
        assert "error: the load air_blast cannot act on 25 of its 25 facets; the first has a scaled distance of" \
            in done.stderr
        assert f"{number:.2g}" in done.stderr and "outside of the table's 0.147 to 40 m/kg^(1/3)" in done.stderr


def test_the_bits_are_the_same_on_any_number_of_ranks_through_erosion(kerf):
    """A strong blast near a weak plate, which erodes under it and uncovers facets that are loaded in their turn."""
    model = plate(
        end=60e-6, first=20e-6, step=1e-7, blast={
            "charge_mass": 0.1, "charge_position": [0.002, 0.001, -0.92], "follow_erosion": True},
        strength={"type": "elastic_plastic", "shear_modulus": 80e9, "yield_stress": 5e7},
        boundaries=[{"type": "fixed", "nodes": "rim"}], balance={"force_interval": 20},
        checks={"energy_growth": 0.5})
    model["sets"]["rim"] = {"parts": "plate", "box": [-0.011, -0.011, -1.01, -0.009, 0.011, -0.9]}
    model["materials"]["steel"]["erosion"] = {"criteria": [{"type": "plastic_strain", "limit": 0.05}]}
    runs = [kerf(model, ranks=ranks) for ranks in (1, 2, 3)]
    assert runs[0].summary["eroded"]["elements"] > 10
    assert len({run.summary["state_hash"] for run in runs}) == 1
    keeps = kerf(model, "loads.0.follow_erosion=false")
    assert keeps.summary["state_hash"] != runs[0].summary["state_hash"]
