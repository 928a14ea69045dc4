"""Warnings before the first step: each has an input that calls for it, and good inputs call for none."""

import pytest

from input_case import GOOD, SOURCE, kerf, on_ranks, spoiled, summary_of
from shipped import INPUTS

CONTACT = "contacts:\n  - {type: eroding_surface}\n"

LINEAR = "eos: {type: linear, bulk_modulus: 130 GPa}"
TNT = "{type: jwl, A: 371.2 GPa, B: 3.231 GPa, R1: 4.15, R2: 0.95, omega: 0.3, initial_energy: 7 GJ/m3"
SMALL_STEPS = ("time:\n  end: 2 us", "time: {safety_factor: 0.1,\n  end: 2 us}")
STRONG_GAS = [("13:5", f"the explosive of part {name} keeps its strength when it has burnt")
              for name in ("target", "striker")]

FLUID = [("type: elastic_plastic\n      shear_modulus: 43 GPa\n      yield_stress: 400 MPa\n"
          "      hardening_modulus: 100 MPa", "type: hydrodynamic"),
         ("{type: plastic_strain, limit: 1.5}", "{type: maximum_shear, limit: 1.5, measure: tensor}"),
         (", effective_plastic_strain", "")]
STEINBERG = ("yield_stress: 120 MPa\n      maximum_yield_stress: 640 MPa\n      beta: 36\n      n: 0.45\n"
             "      A: 2.83e-11 1/Pa\n      B: 3.77e-4 1/K\n      gamma0: 2.02\n      a: 1.5\n"
             "      melting_temperature: 1790 K\n      specific_heat: 383 J/(kg K)")


def reacting(further):
    """PBX-9404 as of the material library, with further constants of the reaction."""
    return ("{type: ignition_and_growth, unreacted: {A: 6969 GPa, B: -172.7 GPa, R1: 7.8, R2: 3.9, omega: 0.8578, "
            "heat_capacity: 2.505 MJ/(m3 K)}, products: {A: 854.5 GPa, B: 20.493 GPa, R1: 4.6, R2: 1.35, omega: 0.25, "
            "heat_capacity: 1 MJ/(m3 K)}, initial_energy: 10.2 GJ/m3, I: 4.4e7 s-1, b: 0.222, x: 4, G1: 2e8 s-1, "
            "c: 0.222, d: 0.667, y: 1.6, " + further + "}")


def soil(further):
    """A soil in the place of the good input's copper; its cone has the apex at -1 MPa."""
    strength_and_eos = GOOD[GOOD.index("    strength:"):GOOD.index("    erosion:")]
    return (strength_and_eos, "    solid: {type: drucker_prager, shear_modulus: 1 GPa, strength_at_no_pressure: 1 MPa, "
                              "slope: 1, compactions: [0, 0.1, 0.3], pressures: [0, 100 MPa, 1 GPa], "
                              f"unloading_moduli: 5 GPa, {further}}}\n")


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
    "late blast": ([(CONTACT, CONTACT + "loads:\n  - {type: air_blast, facets: target, burst: free_air, "
                                        "charge_mass: 1 kg, charge_position: 0 0 1 m}\n")],
                   [("43:5", "the load air_blast pushes its first facet after the end of the run at 2e-06 s")]),
    "idle curve": ([("materials:\n", "curves:\n  ramp: {times: 0 1 us, values: 0 1}\nmaterials:\n")],
                   [("11:3", "nothing uses the curve `ramp`; name it where it is meant to act")]),
    "soft in volume": ([("bulk_modulus: 130 GPa", "bulk_modulus: 13 GPa")],
                       [("13:5", "part target has a bulk modulus of 1.3e+10 Pa and a shear modulus of 4.3e+10 Pa at "
                                 "the start, so that Poisson's ratio is -0.29"),
                        ("13:5", "part striker has a bulk modulus of 1.3e+10 Pa")]),
    "burnt from the start": ([(LINEAR, "eos: " + TNT + "}"),
                              SMALL_STEPS],
                             [*STRONG_GAS,
                              ("18:5", "no detonator is given, so that the explosive of part target is burnt"),
                              ("18:5", "no detonator is given, so that the explosive of part striker is burnt")]),
    "detonator that is not used": ([(LINEAR, "eos: " + TNT + ", burn: compression, detonators: [{point: 0 0 0 mm}]}"),
                                    ("density: 8930 kg/m3", "density: 1630 kg/m3")],
                                   [*STRONG_GAS, ("18:5", "`burn: compression` uses no detonators")]),
    "detonator outside": ([(LINEAR, "eos: " + TNT + ", detonators: [{point: 0 0 200 mm}]}"),
                           ("density: 8930 kg/m3", "density: 1630 kg/m3"), ("end: 2 us", "end: 60 us")],
                          [*STRONG_GAS,
                           ("18:5", "detonator 1 lies 0.196 m off the nearest element of its explosive, which is lit "
                                     "late by 2.83e-05 s"),
                           ("18:5", "the detonation runs over 2 cells of part target"),
                           ("18:5", "the detonation runs over 2 cells of part striker")]),
    "two Grueneisen parameters": ([("type: elastic_plastic", "type: steinberg_guinan"),
                                   ("yield_stress: 400 MPa\n      hardening_modulus: 100 MPa",
                                    STEINBERG),
                                   (LINEAR, "eos: {type: mie_gruneisen, c0: 3940 m/s, s: 1.49, gamma0: 1.5}")],
                                  [("13:5", "gamma0 of steinberg_guinan is 2.02, and the equation of state of part "
                                            "target has 1.5"),
                                   ("13:5", "gamma0 of steinberg_guinan is 2.02, and the equation of state of part "
                                            "striker has 1.5")]),
    "molten": ([("type: elastic_plastic", "type: steinberg_guinan"),
                ("yield_stress: 400 MPa\n      hardening_modulus: 100 MPa",
                 STEINBERG + "\n      initial_temperature: 1800 K"),
                (LINEAR, "eos: {type: mie_gruneisen, c0: 3940 m/s, s: 1.49, gamma0: 2.02}")],
               [("13:5", "part target is molten at the start, and has no strength"),
                ("13:5", "part striker is molten at the start, and has no strength")]),
    "degrees Celsius": ([("type: elastic_plastic", "type: johnson_cook"),
                         ("yield_stress: 400 MPa\n      hardening_modulus: 100 MPa",
                          "A: 90 MPa\n      B: 292 MPa\n      n: 0.31\n      C: 0.025\n      m: 1.09\n"
                          "      specific_heat: 383 J/(kg K)\n      melting_temperature: 1356 K\n"
                          "      initial_temperature: 25")],
                        [("23:28", "`initial_temperature` = 25 K is not usual; expected from 100 to 3000 K")]),
    "kilometres per second": ([(LINEAR, "eos: {type: mie_gruneisen, c0: 3.94, s: 1.49, gamma0: 2.02}"),
                               ("shear_modulus: 43 GPa", "shear_modulus: 100 kPa")],
                              [("18:36", "`c0` = 3.94 m/s is not usual; expected from 50 to 20000 m/s")]),
    "pressure that nothing holds": ([*FLUID, (LINEAR, "eos: {type: linear_polynomial, C0: 60 MPa, C1: 5 GPa}")],
                                    [("15:5", "C0 gives part target a pressure of 6e+07 Pa at the start, 0.012 of"),
                                     ("15:5", "C0 gives part striker a pressure of 6e+07 Pa")]),
    "velocity without a detonator": ([*FLUID, (LINEAR, "eos: " + TNT + ", detonation_velocity: 6.93 km/s}"),
                                      ("density: 8930 kg/m3", "density: 1630 kg/m3"), SMALL_STEPS],
                                     [("15:5", "part target is burnt at the start and detonation_velocity and "
                                               "cj_pressure have no effect"),
                                      ("15:5", "part striker is burnt at the start and detonation_velocity")]),
    "arrival that is not used": ([*FLUID, (LINEAR, "eos: " + TNT + ", burn: compression, arrival: eikonal}"),
                                  ("density: 8930 kg/m3", "density: 1630 kg/m3")],
                                 [("15:5", "`arrival: eikonal` has no effect with `burn: compression`")]),
    "terms of a reaction that never act": ([*FLUID,
                                            (LINEAR, "eos: " + reacting("G2: 400 s-1, z: 2, fg2min: 1, figmax: 0")),
                                            ("density: 8930 kg/m3", "density: 1842 kg/m3")],
                                           [("15:5", "ignition ends at a figmax of 0"),
                                            ("15:5", "completion begins at an fg2min of 1"),
                                            ("15:5", "G2 is not within 1e4 and 1e13 1/s")]),
    "completion without a rate": ([*FLUID, (LINEAR, "eos: " + reacting("z: 2, e: 0.5")),
                                   ("density: 8930 kg/m3", "density: 1842 kg/m3")],
                                  [("15:5", "e, g, z and fg2min have no effect without G2")]),
    "exponent of another term": ([*FLUID, (LINEAR, "eos: " + reacting("a: 4")),
                                  ("density: 8930 kg/m3", "density: 1842 kg/m3")],
                                 [("15:347", "`a` = 4 is not usual; expected from -0.1 to 1, or leave it out for 0")]),
    "strength that is cut off": ([soil("zero_strength_pressure: 1 MPa")],
                                 [("13:5", "there is no strength at a pressure of 1e+06 Pa and below, which takes the "
                                           "strength of 1e+06 Pa at no pressure away")]),
    "tension beyond the apex": ([soil("tension_limit: 100 MPa")],
                                [("13:5", "tension_limit of 1e+08 Pa lies beyond the apex of the yield surface at "
                                          "-1e+06 Pa")]),
    "cap below the cone": ([soil("most_strength: 0.1 MPa, zero_strength_pressure: -1 MPa")],
                           [("13:5", "most_strength of 1e+05 Pa is not above the strength of 1e+06 Pa at no "
                                     "pressure")]),
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


@pytest.mark.parametrize("density, warned", [("7850 kg/m3", True), ("8.9 g/cm3", False)])
def test_a_density_that_is_not_that_of_the_set(density, warned, tmp_path):
    start, end = GOOD.index("    density:"), GOOD.index("    erosion:")
    material = f"    library: copper_ofhc_johnson_cook\n    density: {density}\n"
    (tmp_path / "case.yaml").write_text(GOOD[:start] + material + GOOD[end:])
    said = kerf("check", "case.yaml", cwd=tmp_path).stderr
    assert ("case.yaml:13:14: warning: the density of 7850 kg/m3 is not that of the set `copper_ofhc_johnson_cook`, "
            "8960 kg/m3, to which its other constants belong; leave it out" in said) == warned, said
    assert said.count("warning:") == 1 + warned


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
