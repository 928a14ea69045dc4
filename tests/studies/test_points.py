"""Which points a study has: lists, grids, Latin hypercubes, refinements of meshes, and their products."""

import numpy as np
import pytest
from study_case import INPUT, STUDY, sweep, write

from marked_yaml import StudyError
from model_input import ModelInput, PathError
from quantities import components, scaled, value_of, vector_text
from study import read_study


def points_of(folder, points, **more):
    return read_study(write(folder, points, **more)).points


def numbers(points, name):
    return [point.values[name].number for point in points]


def test_values_are_taken_as_they_are_written(tmp_path):
    points = points_of(tmp_path, """points:
  type: values
  values:
    - {speed: 100 m/s, strength: 400 MPa}
    - {speed: 2.5e2 m/s, strength: 300 MPa}
""")
    assert [p.settings for p in points] == [
        {"parts.striker.velocity": "[0, 0, -100] m/s", "materials.copper.strength.yield_stress": "400 MPa"},
        {"parts.striker.velocity": "[0, 0, -250] m/s", "materials.copper.strength.yield_stress": "300 MPa"}]


def test_a_grid_is_the_product_of_lists_and_ranges(tmp_path):
    points = points_of(tmp_path, """points:
  type: grid
  axes:
    speed: {from: 100 m/s, to: 300 m/s, count: 3}
    strength: [300 MPa, 400 MPa]
""")
    assert list(zip(numbers(points, "speed"), numbers(points, "strength"))) == [
        (100, 300), (100, 400), (200, 300), (200, 400), (300, 300), (300, 400)]


def test_a_logarithmic_range_has_equal_ratios(tmp_path):
    points = points_of(tmp_path, """points:
  type: grid
  axes: {strength: {from: 1 MPa, to: 1000 MPa, count: 4, spacing: logarithmic}}
""")
    assert numbers(points, "strength") == pytest.approx([1, 10, 100, 1000], rel=1e-12)


LHS = """points:
  type: latin_hypercube
  n: 8
  seed: %d
  ranges:
    speed: {from: 100 m/s, to: 260 m/s}
    strength: {from: 300 MPa, to: 460 MPa}
"""


def test_a_latin_hypercube_has_one_point_in_every_layer(tmp_path):
    points = points_of(tmp_path, LHS % 3)
    for name, low in (("speed", 100), ("strength", 300)):
        layers = np.floor((np.array(numbers(points, name)) - low) / 20)
        assert sorted(layers) == list(range(8))


def test_a_latin_hypercube_is_the_same_for_the_same_seed_only(tmp_path):
    first, again, other = (points_of(tmp_path, LHS % seed) for seed in (3, 3, 4))
    assert [p.settings for p in first] == [p.settings for p in again]
    assert [p.settings for p in first] != [p.settings for p in other]


def test_whole_numbers_of_a_hypercube_reach_both_ends(tmp_path):
    study = STUDY.replace("  strength:", "  cells: parts.target.mesh.cells[2]\n  strength:")
    points = points_of(tmp_path, """points:
  type: latin_hypercube
  n: 40
  seed: 1
  ranges: {cells: {from: 2, to: 5, whole: true}, speed: {from: 1 m/s, to: 2 m/s}}
""", study=study)
    assert [numbers(points, "cells").count(n) for n in (2, 3, 4, 5)] == [10, 10, 10, 10]
    assert {p.settings["parts.target.mesh.cells.2"] for p in points} == set("2345")


def test_a_value_inside_of_another_that_is_set_is_refused(tmp_path):
    """Refinement sets all three numbers of cells, so that the one of the grid would be lost."""
    study = STUDY.replace("  strength:", "  cells: parts.target.mesh.cells[2]\n  strength:")
    with pytest.raises(StudyError, match="mesh.cells.2 and parts.target.mesh.cells are both set"):
        points_of(tmp_path, """points:
  - {type: grid, axes: {cells: [2, 3]}}
  - {type: mesh, factors: [1, 2]}
""", study=study)


def test_a_mesh_is_refined_in_all_its_parts(tmp_path):
    points = points_of(tmp_path, "points: {type: mesh, factors: [1, 1.5, 3]}\n")
    assert [(p.settings["parts.target.mesh.cells"], p.settings["parts.striker.mesh.cells"]) for p in points] == [
        ("[4, 4, 2]", "[2, 2, 2]"), ("[6, 6, 3]", "[3, 3, 3]"), ("[12, 12, 6]", "[6, 6, 6]")]


def test_sizes_of_cells_shrink_and_a_named_value_shrinks_once(tmp_path):
    model = INPUT.replace("parameters:", "parameters:\n  h: 0.5 mm").replace("cells: [4, 4, 2]", "cell_size: $h") \
        .replace("cells: [2, 2, 2]", "cell_size: $h")
    points = points_of(tmp_path, "points: {type: mesh, factors: [2]}\n", model=model)
    assert points[0].settings == {"parameters.h": "0.25 mm"}


def test_blocks_in_a_list_are_multiplied(tmp_path):
    points = points_of(tmp_path, """points:
  - {type: values, values: [{speed: 100 m/s}, {speed: 200 m/s}]}
  - {type: mesh, factors: [1, 2]}
""")
    assert list(zip(numbers(points, "speed"), numbers(points, "refinement"))) == [
        (100, 1), (100, 2), (200, 1), (200, 2)]


def test_a_unit_of_a_parameter_is_that_of_bare_numbers(tmp_path):
    study = STUDY.replace("factor: -1}\n  s", "factor: -1, unit: m/s}\n  s")
    points = points_of(tmp_path, "points: {type: grid, axes: {speed: [100, 200 m/s]}}\n", study=study)
    assert [p.settings["parts.striker.velocity"] for p in points] == ["[0, 0, -100] m/s", "[0, 0, -200] m/s"]


def test_two_components_of_one_vector_are_both_set(tmp_path):
    study = STUDY.replace('path: "parts.striker.velocity[2]"',
                          'path: ["parts.striker.velocity[0]", "parts.striker.velocity[2]"]')
    points = points_of(tmp_path, "points: {type: grid, axes: {speed: [100 m/s]}}\n", study=study)
    assert points[0].settings == {"parts.striker.velocity": "[-100, 0, -100] m/s"}


def test_a_component_is_put_into_the_value_that_the_study_sets(tmp_path):
    points = points_of(tmp_path, 'set: {parts.striker.velocity: 5 0 0 m/s}\n'
                                 "points: {type: grid, axes: {speed: [100 m/s]}}\n")
    assert points[0].settings["parts.striker.velocity"] == "[5, 0, -100] m/s"


def test_check_prints_the_points_and_runs_nothing(tmp_path):
    study = write(tmp_path, "points: {type: grid, axes: {speed: [100 m/s, 150 m/s]}}\n")
    done = sweep(study, "--check")
    assert done.returncode == 0, done.stderr
    assert "parts.striker.velocity = [0, 0, -150] m/s" in done.stdout
    assert "2 points of" in done.stdout
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("text, parts", [
    ("0 0 -800 m/s", ["0 m/s", "0 m/s", "-800 m/s"]), ("[0, 0, -1646] m/s", ["0 m/s", "0 m/s", "-1646 m/s"]),
    ("[1 mm, 2 mm]", ["1 mm", "2 mm"]), ("[4, 4, 2]", ["4", "4", "2"]), ("5.0e-4 1/s", None), ("452 J/(kg K)", None),
    ("[a, b]", None), ("0 0 1", ["0", "0", "1"])])
def test_vectors_are_told_from_numbers_with_units(text, parts):
    assert components(text) == parts


def test_numbers_keep_their_units():
    assert (value_of("5.0e-4 1/s").number, value_of("5.0e-4 1/s").unit) == (5e-4, "1/s")
    assert (value_of("452 J/(kg K)").number, value_of("452 J/(kg K)").unit) == (452.0, "J/(kg K)")
    assert value_of("viscous").number is None
    assert scaled("12 mm", 0.5, False) == "6 mm"
    assert scaled("1 2 mm", 0.5, False) == "[0.5, 1] mm"
    assert vector_text(["4", "4", "2"], single=False) == "[4, 4, 2]"
    assert vector_text(["4", "4", "2"], single=True) == "4 4 2"
    assert vector_text(["0", "1 mm", "1 cm"], single=False) == "[0, 1 mm, 1 cm]"
    assert scaled("3", 1.5, True) is None


def test_paths_lead_into_lists_and_tell_what_is_near(tmp_path):
    write(tmp_path)
    model = ModelInput(tmp_path / "input.yaml")
    assert model.find(["boundaries", "0", "type"])[0].value == "fixed"
    with pytest.raises(PathError, match="did you mean `striker`"):
        model.find(["parts", "stricker", "velocity"])
    with pytest.raises(PathError, match=r"a list of 1, and has no \[3\]; expected a position from 0 to 0"):
        model.find(["contacts", "3", "friction"])


def test_the_same_point_twice_is_refused(tmp_path):
    with pytest.raises(StudyError, match="the point speed = 100.0 m/s is there twice|there twice"):
        points_of(tmp_path, "points: {type: grid, axes: {speed: [100 m/s, 100.0 m/s]}}\n")


@pytest.mark.parametrize("parameters, point", [
    ("{s: {path: \"parts.bar.velocity[2]\"}, v: parts.bar.velocity}", "{s: -200 m/s, v: 0 0 -50 m/s}"),
    ("{v: parts.bar.velocity, s: {path: \"parts.bar.velocity[2]\"}}", "{v: 0 0 -50 m/s, s: -200 m/s}"),
    ("{t: time.end, u: time.end}", "{t: 1 us, u: 2 us}")])
def test_two_parameters_that_set_one_value_are_refused(tmp_path, parameters, point):
    (tmp_path / "input.yaml").write_text(INPUT)
    text = (f"input: input.yaml\nparameters: {parameters}\npoints: {{type: values, values: [{point}]}}\n"
            "results: {b: energy.balance_error}\n")
    (tmp_path / "study.yaml").write_text(text.replace("parts.bar", "parts.striker"))
    done = sweep(tmp_path / "study.yaml", "--check")
    assert done.returncode == 2 and "expected each value to be set once" in done.stderr, done.stdout + done.stderr


@pytest.mark.parametrize("points", [
    "points: {type: latin_hypercube, n: 1000000000000, seed: 1, ranges: {speed: {from: 1 m/s, to: 2 m/s}, "
    "strength: {from: 1 MPa, to: 2 MPa}}}\n",
    "points: {type: grid, axes: {speed: {from: 1 m/s, to: 2 m/s, count: 1000000000000}, strength: [1 MPa]}}\n"])
def test_too_many_points_are_refused_before_they_are_made(tmp_path, points):
    done = sweep(write(tmp_path, points), "--check")
    assert done.returncode == 2 and "these are more than 100000 points; expected fewer" in done.stderr
