"""Runs of decks meet closed forms and runs of the same models in YAML."""

import json
import math

import h5py
import numpy as np
import pytest
from deck_case import DECKS, UNITS, copied, kerf, run, summary_of

RESULTS = json.loads((DECKS / "reference_results.json").read_text())


def last_frame(folder, *, cells=(), points=()):
    """The last frame of results.vtkhdf: centres of elements, fields, and the displacement-free points."""
    with h5py.File(folder / "results.vtkhdf") as file:
        root = file["VTKHDF"]
        steps = root["Steps"]
        n = int(steps.attrs["NSteps"])
        n_points, n_cells = int(root["NumberOfPoints"][-1]), int(root["NumberOfCells"][-1])
        first = int(steps["PointOffsets"][n - 1])
        found = {"time": float(steps["Values"][n - 1]), "points": root["Points"][first:first + n_points]}
        for kind, size, names in (("CellData", n_cells, cells), ("PointData", n_points, points)):
            for name in names:
                first = int(steps[kind + "Offsets"][name][n - 1])
                found[name] = root[kind][name][first:first + size]
        return found


def undeformed(folder):
    """Places of nodes in the first frame, and the corners of the elements."""
    with h5py.File(folder / "results.vtkhdf") as file:
        root = file["VTKHDF"]
        n_cells = int(root["NumberOfCells"][0])
        return root["Points"][:int(root["NumberOfPoints"][0])], root["Connectivity"][:8 * n_cells].reshape(-1, 8)


def centres(folder):
    """Of the undeformed elements, which are all hexahedra."""
    x, corners = undeformed(folder)
    return x[corners].mean(axis=1)


def test_one_element_is_compressed_as_a_bar(tmp_path):
    deck = copied("01_one_element/one_element.k", tmp_path)
    run(deck, "--units", UNITS["01_one_element/one_element.k"])
    x = last_frame(tmp_path / "results" / "one_element")["points"]
    top = x[:, 2].max() - 0.5
    # Uniaxial stress of 40 MPa; the element still swings by a percent about it.
    assert top == pytest.approx(RESULTS["01_one_element"]["top_displacement_z_m"], rel=0.02)
    assert x[:, 0].max() - 0.5 == pytest.approx(RESULTS["01_one_element"]["widening_of_half_metre_m"], rel=0.02)


def test_the_taylor_bar_has_the_length_of_its_equivalent(tmp_path):
    deck = copied("02_taylor_bar/taylor.k", tmp_path)
    measures = ("{length: {type: final_length, part: bar, axis: 0 0 1},"
                " radius: {type: largest_radius, part: bar, axis: 0 0 1}}")
    found = run(deck, "--units", "kg-mm-ms", "--set", "measures=" + measures)["measures"]
    kerf("run", "equivalent.yaml", cwd=tmp_path, timeout=600)
    wanted = summary_of(tmp_path / "results" / "equivalent")["measures"]
    # The equivalent has `linear` pressure, the deck -K ln V, and places are rounded to sixteen columns.
    assert found["length"] == pytest.approx(wanted["length"], rel=1e-3)
    assert found["radius"] == pytest.approx(wanted["mushroom_radius"], rel=3e-3)
    assert found["length"] == pytest.approx(RESULTS["02_taylor_bar"]["final_length_mm"] * 1e-3, rel=5e-3)


def test_the_oblique_rod_goes_through_its_plate(tmp_path):
    deck = copied("03_oblique_rod/rod.k", tmp_path)
    summary = run(deck, "--units", "g,cm,us",
                  "--set", "measures={rod: {type: residual_velocity, part: Rod}, lost: {type: mass_lost, part: Rod}}")
    wanted = RESULTS["03_oblique_rod"]
    eroded = summary["eroded"]["by_part"]
    rod, plate = eroded["Rod"], next(n for part, n in eroded.items() if part.startswith("Plate"))
    assert abs(rod - wanted["eroded_rod"]) <= 10 and abs(plate - wanted["eroded_plate"]) <= 10
    # Velocities have seven digits in the deck, and erosion amplifies what is lost.
    assert math.hypot(*summary["parts"]["Rod"]["velocity"]) == pytest.approx(wanted["rod_speed_m_s"], rel=0.03)
    assert abs(summary["energy"]["balance_error"]) < 1e-3


def test_the_plates_reach_the_stress_of_their_hugoniot(tmp_path):
    deck = copied("05_plate_impact/plate_impact.k", tmp_path)
    run(deck, "--units", "g,cm,us", "--set", "output.element_fields=[stress, density, pressure]", "--set",
        "time.end=1.2 us")
    folder = tmp_path / "results" / "plate_impact"
    frame = last_frame(folder, cells=["stress", "density"])
    # Cells of the target that the front has passed, which is at 6.9 mm, and no release has reached.
    x = centres(folder)[:, 0]
    behind = (x > 1e-3) & (x < 4e-3)
    stress, density = frame["stress"][behind][:, 0], frame["density"][behind]
    assert np.median(stress) == pytest.approx(RESULTS["05_plate_impact"]["axial_stress_GPa"] * 1e9, rel=0.01)
    assert np.median(density) == pytest.approx(RESULTS["05_plate_impact"]["density_kg_m3"], rel=0.01)


def test_the_charge_is_lit_along_straight_lines(tmp_path):
    deck = copied("06_explosive_tube/tube.k", tmp_path)
    run(deck, "--units", "g-cm-us", "--set", "output.element_fields=[lighting_time]", "--set",
        "output.precision=double", "--set", "output.node_fields=[velocity]", "--set", "output.results_interval=11 us")
    folder = tmp_path / "results" / "tube"
    frame = last_frame(folder, cells=["lighting_time", "part"], points=["velocity"])
    charge = frame["part"] == 0
    # Detonation velocity 6930 m/s, lit at the origin; the place of an element is the mean of its corners.
    arrival = np.linalg.norm(centres(folder)[charge], axis=1) / 6930.0
    assert frame["lighting_time"][charge] == pytest.approx(arrival, rel=1e-6)
    x = undeformed(folder)[0]
    at = (np.abs(x[:, 2] - 0.03) < 1e-3) & (np.hypot(x[:, 0], x[:, 1]) > 0.0125)
    radial = (frame["velocity"][at, :2] * x[at, :2]).sum(axis=1) / np.hypot(x[at, 0], x[at, 1])
    assert 1000.0 < radial.mean() < 1500.0  # Gurney's estimate is 1410 m/s


def test_the_bar_that_is_drawn_takes_the_force_of_its_table(tmp_path):
    deck = copied("08_tension_table/tension.k", tmp_path)
    run(deck, "--units", "t-mm-s", "--set", "observers={pull: {type: reactions, interval: 1 us}}")
    folder = tmp_path / "results" / "tension"
    x = last_frame(folder)["points"]
    assert x[:, 0].max() == pytest.approx(16e-3 + 3.2e-3, rel=1e-6)  # 3.2 mm is drawn
    wanted = RESULTS["08_tension_table"]["force_at_fixed_end_N"]
    assert force_at_the_end(folder) == pytest.approx(wanted, rel=0.03)


def force_at_the_end(folder):
    """Mean of the force that holds the fixed end, over the last tenth of the run."""
    with h5py.File(folder / "history.h5") as file:
        force = file["pull"]["fixed_1.force_x"][:]
    return abs(force[-len(force) // 10:].mean())


def test_the_ball_erodes_the_plate(tmp_path):
    deck = copied("04_ball_free_format/ball.k", tmp_path)
    summary = run(deck, "--units", "g-mm-ms")
    assert summary["eroded"]["by_criterion"]["principal_strain"] > 0
    assert abs(summary["energy"]["balance_error"]) < 1e-2
    assert summary["deck"]["units"] == "g, mm, ms"


def test_the_ball_breaks_the_tile(tmp_path):
    deck = copied("07_ceramic_tile/tile.k", tmp_path)
    summary = run(deck, "--units", "kg-mm-ms")
    assert summary["eroded"]["elements"] > 0
    assert abs(summary["energy"]["balance_error"]) < 2e-2


def test_the_rubber_ball_bounces(tmp_path):
    deck = copied("12_rubber_ball/rubber_ball.k", tmp_path)
    summary = run(deck, "--units", "kg-mm-ms")
    assert summary["parts"]["Ball"]["velocity"][1] > 0.0  # it fell at 24 m/s
    assert summary["deck"]["in_another_way"] == 2
