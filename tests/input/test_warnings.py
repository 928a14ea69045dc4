"""Warnings before the first step: each has an input that calls for it, and good inputs call for none."""

import pytest

from input_case import GOOD, SOURCE, kerf, on_ranks, spoiled, summary_of

INPUTS = sorted((SOURCE / "inputs").glob("*/*.yaml"))
CONTACT = "contacts:\n  - {type: eroding_surface}\n"

# Name: (edits of the good input, start of each line after the file's name, with what must stand in it).
CASES = {
    "forgotten contact": ([(CONTACT, "")],
                          [("31:5", "parts target and striker are on a collision course and meet at about 5e-07 s")]),
    "one layer": ([("size: 4 4 2 mm, cells: [4, 4, 2]", "size: 4 4 0.5 mm, cells: [4, 4, 1]"),
                   ("origin: 1 1 2.1 mm", "origin: 1 1 0.6 mm"),
                   ("{type: fixed, nodes: bottom}", "{type: fixed, nodes: bottom, components: [x]}")],
                  [("28:5", "part target has one layer of cells across its thickness of 0.0005 m")]),
    "idle part": ([("boundaries:\n  - {type: fixed, nodes: bottom}\n", ""), ("0 0 -200 m/s", "0 0 200 m/s")],
                  [("28:5", "part target is at rest, no boundary condition holds it, and nothing that moves with the "
                            "velocity of its part will strike it")]),
    "coefficient": ([("origin: 1 1 2.1 mm, cells: [2, 2, 2]}",
                      "origin: 1 1 2.1 mm, cells: [2, 2, 2]}\n"
                      "    element: {type: hex8, hourglass_coefficient: 0.005}")],
                    [("32:50", "`hourglass_coefficient` = 0.005 is not usual; expected from 0.01 to 0.1, "
                               "or leave it")]),
    "plane that swallows": ([("  - {type: fixed, nodes: bottom}",
                              "  - {type: fixed, nodes: bottom}\n"
                              "  - {type: symmetry, normal: 1 0 0, tolerance: 1.5 mm}")],
                            [("39:5", "takes in whole cells: 8 of the 32 of part target")]),
    "single cell": ([("origin: 1 1 2.1 mm, cells: [2, 2, 2]", "origin: 1 1 2.1 mm, cells: [1, 1, 1]")],
                    [("31:5", "part striker is a free body of one cell")]),
    "late contact": ([("origin: 1 1 2.1 mm", "origin: 1 1 4 mm")],
                     [("8:8", "the first contact, of parts target and striker, comes at about 1e-05 s")]),
    "far from the origin": ([("size: 4 4 2 mm,", "size: 4 4 2 mm, origin: 20000000 0 0 m,"),
                             ("origin: 1 1 2.1 mm", "origin: 20000000.001 0.001 0.0021 m")],
                            [("28:5", "part target lies 2e+07 m from the origin, where positions are rounded by up to "
                                      "2.2e-06 of the shortest edge of the mesh, 0.001 m")]),
    "idle load": ([(CONTACT, CONTACT + "sets:\n  inner: {parts: target, box: 0.5 0.5 0.5 3.5 3.5 1.5 mm}\n"
                    "loads:\n  - {type: pressure, facets: inner, pressure: 1 MPa}\n"),
                   ("sets:\n  bottom: {parts: target, face: z_min}\n\n", ""),
                   ("  - {type: fixed, nodes: bottom}", "  - {type: fixed, nodes: inner}")],
                  [("42:5", "the load pressure acts on nothing: no exterior facet has all its corners in")]),
    "load of nothing": ([(CONTACT, CONTACT + "loads:\n  - {type: gravity, acceleration: 0 0 0}\n")],
                        [("43:5", "the load gravity is zero at all times")]),
    "idle curve": ([("materials:\n", "curves:\n  ramp: {times: 0 1 us, values: 0 1}\nmaterials:\n")],
                   [("11:3", "nothing uses the curve `ramp`; name it where it is meant to act")]),
    "average over nothing": ([("{type: plastic_strain, limit: 1.5}",
                               "{type: rice_tracey, limit: 0.5, nonlocal_radius: 0.5 mm}")],
                             [("22:11", "nonlocal_radius is less than the length of an element of part target"),
                              ("22:11", "nonlocal_radius is less than the length of an element of part striker")]),
    "average over all": ([("{type: plastic_strain, limit: 1.5}",
                           "{type: rice_tracey, limit: 0.5, nonlocal_radius: 1.5 mm}")],
                         [("22:11", "the sphere of nonlocal_radius is larger than part striker")]),
    "overlap without contact": ([(CONTACT, ""), ("origin: 1 1 2.1 mm", "origin: 1 1 1.5 mm")],
                                [("31:5", "parts target and striker overlap at the start: they share 2e-09 m3")]),
}


@pytest.mark.parametrize("name", CASES, ids=lambda name: name.replace(" ", "_"))
def test_warns_and_runs(name, tmp_path):
    edits, expected = CASES[name]
    (tmp_path / "case.yaml").write_text(spoiled(edits))
    said = []
    for words in (["check", "case.yaml"], ["check", "case.yaml", "--ranks", 3],
                  ["run", "case.yaml", "--set", "time.maximum_cycles=2", "--output", "out"]):
        done = kerf(*words, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        said.append(done.stderr.splitlines())
    assert said[0] == said[1] == said[2], "the same from check and run, on any number of ranks"
    assert summary_of(tmp_path / "out")["warnings"] == said[0]
    assert len(said[0]) == len(expected), said[0]
    for line, (place, text) in zip(said[0], expected):
        assert line.startswith(f"case.yaml:{place}: warning: ") and text in line and "; " in line, line


def test_a_layer_that_cannot_bend_is_fine(tmp_path):
    """Held across its thickness, as a column in one-dimensional strain is."""
    edits = CASES["one layer"][0][:2]
    (tmp_path / "case.yaml").write_text(spoiled(edits))
    assert kerf("check", "case.yaml", cwd=tmp_path).stderr == ""


@pytest.mark.parametrize("path", INPUTS, ids=lambda p: p.stem)
def test_shipped_inputs_call_for_none(path):
    said = kerf("check", path).stderr.splitlines()
    # Sets of the library that are not verified are marked so on purpose.
    assert [line for line in said if "of the material library is not verified" not in line] == []


def test_a_good_input_has_no_warnings(tmp_path):
    (tmp_path / "case.yaml").write_text(GOOD)
    done = kerf("run", "case.yaml", "--set", "time.maximum_cycles=2", "--output", "out", *on_ranks(2), cwd=tmp_path)
    assert done.stderr == "" and summary_of(tmp_path / "out")["warnings"] == []


def test_a_body_of_nanometres_keeps_its_contact(tmp_path):
    """All tolerances follow the mesh: nothing is swallowed by the plane of symmetry, and the striker is stopped."""
    small = [("size: 4 4 2 mm", "size: 24 24 12 nm"),
             ("size: 2 2 2 mm, origin: 1 1 2.1 mm", "size: 12 12 12 nm, origin: 0 0 12.1 nm"),
             ("end: 2 us", "end: 10 ps"),
             ("  - {type: fixed, nodes: bottom}",
              "  - {type: fixed, nodes: bottom}\n  - {type: symmetry, normal: 1 0 0}")]
    (tmp_path / "case.yaml").write_text(spoiled(small))
    done = kerf("run", "case.yaml", "--output", "out", cwd=tmp_path)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert summary_of(tmp_path / "out")["parts"]["striker"]["velocity"][2] > -150.0
