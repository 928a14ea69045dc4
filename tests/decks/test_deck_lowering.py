"""What single fields of a deck become: decks of a few bricks, read as the case that `kerf convert` writes of them."""

import re

import pytest
import yaml
from deck_case import kerf, summary_of

CUBE = """\
*NODE
       1             0.0             0.0             0.0
       2             1.0             0.0             0.0
       3             1.0             1.0             0.0
       4             0.0             1.0             0.0
       5             0.0             0.0             1.0
       6             1.0             0.0             1.0
       7             1.0             1.0             1.0
       8             0.0             1.0             1.0
       9             0.0             0.0             2.0
      10             1.0             0.0             2.0
      11             1.0             1.0             2.0
      12             0.0             1.0             2.0
*ELEMENT_SOLID
       1       1       1       2       3       4       5       6       7       8
       2       2       5       6       7       8       9      10      11      12
*SECTION_SOLID
1,1
*MAT_ELASTIC
1,7.8,2.0,0.3
"""
PARTS = "*PART\nlower\n1,1,1\n*PART\nupper\n2,1,1\n"
HEAD = "*KEYWORD\n*CONTROL_TERMINATION\n10.0\n"
ELASTIC = "*MAT_ELASTIC\n1,7.8,2.0,0.3\n"


def deck(*blocks, parts=PARTS, mesh=CUBE):
    return HEAD + parts + mesh + "".join(blocks) + "*END\n"


@pytest.fixture
def lowered(tmp_path):
    """The case of a deck, and what is told of it."""
    def lower(text, *words, includes=None, units="g-cm-us"):
        (tmp_path / "deck.k").write_text(text)
        for name, content in (includes or {}).items():
            (tmp_path / name).write_text(content)
        done = kerf("convert", "deck.k", "--units", units, "--output", "case", *words, cwd=tmp_path)
        if done.returncode != 0:
            return None, done.stderr
        return yaml.safe_load((tmp_path / "case" / "case.yaml").read_text()), done.stderr
    return lower


def refused(lowered, text, what, **more):
    case, told = lowered(text, **more)
    assert case is None, told
    lines = [line for line in told.splitlines() if re.match(r"\S+:\d+:\d+: error: ", line) and what in line]
    assert len(lines) == 1, told


def included(line, *factors, transformation=None):
    """An include of `other.k` with factors of mass, time and length, and a transformation."""
    factor = ",".join(str(f) for f in factors) if factors else "1,1,1"
    block = f"*DEFINE_TRANSFORMATION\n7\n{transformation}\n" if transformation else ""
    return (block + "*INCLUDE_TRANSFORM\nother.k\n0,0,0,0,0,0,0\n0\n" + factor + "\n" +
            ("7\n" if transformation else "0\n"), {"other.k": "*KEYWORD\n" + line + "*END\n"})


# ---- Names


@pytest.mark.parametrize("titles", [("part 2", ""), ("Rod", "Rod"), ("Rod 2", "rod 2")])
def test_each_part_has_a_name_of_its_own(lowered, titles):
    case, _ = lowered(deck(parts=f"*PART\n{titles[0]}\n1,1,1\n*PART\n{titles[1]}\n2,1,1\n"))
    assert len(case["parts"]) == 2
    assert all("material" in part for part in case["parts"].values())


# ---- Contacts


def contact(*cards):
    return "*CONTACT_AUTOMATIC_SURFACE_TO_SURFACE\n" + "\n".join(cards) + "\n\n\n"


def test_a_contact_of_a_set_without_solids_is_refused(lowered):
    empty = "*PART\nnothing\n3,1,1\n*SET_PART_LIST\n3\n3\n"
    refused(lowered, deck(empty, contact("1,3,3,2")), "part set 3 has no part with solids")
    case, told = lowered(deck("*PART\nnothing\n3,1,1\n*SET_PART_LIST\n3\n2,3\n", contact("1,3,3,2")))
    assert len(case["contacts"]) == 1
    assert "warning: part set 3 also names 3" in told


def test_a_contact_without_the_number_of_a_surface_is_refused(lowered):
    refused(lowered, deck(contact("0,2,2,3")), "does not say which surface; expected the number of a part set")


def test_friction_from_a_table_is_refused(lowered):
    refused(lowered, deck(contact("1,2,3,3", "2.0,0.0")), "from a table")
    case, _ = lowered(deck(contact("1,2,3,3", "0.3,0.3")))
    assert case["contacts"][0]["friction"] == 0.3


def test_a_contact_may_end_after_the_run_only(lowered):
    refused(lowered, deck(contact("1,2,3,3", "", "", "")).replace("3,3\n\n", "3,3\n,,,,,,,9.0\n"), "DT = 9")
    case, _ = lowered(deck(contact("1,2,3,3", "", "")).replace("3,3\n\n", "3,3\n,,,,,,,1e8\n"))
    assert len(case["contacts"]) == 1


def test_segments_in_contact_are_no_more_than_they_are(lowered):
    """Two opposite faces of a brick hold all its nodes, and not its other faces."""
    segments = "*SET_SEGMENT\n5\n1,2,6,5\n4,3,7,8\n"
    case, _ = lowered(deck(segments, contact("5,2,0,3")))
    sets = {name for entry in case["contacts"] for name in entry["parts"]} - {"upper"}
    assert len(sets) == 2


# ---- Includes


CURVE = "*DEFINE_CURVE\n20\n0.0,1.0\n20.0,1.0\n"


def pressure(lowered, load, factors=(), transformation=None, more=""):
    block, files = included(load, *factors, transformation=transformation)
    case, told = lowered(deck(CURVE, more, block), includes=files)
    assert case, told
    return [entry["pressure"] for entry in case["loads"]]


def test_a_pressure_in_a_mirror_pushes_the_same_way_by_segment_and_by_set(lowered):
    mirror = "MIRROR,0,0,0.5,0,0,1.5"
    one = pressure(lowered, "*LOAD_SEGMENT\n20,1.0,0,1,2,6,5\n", transformation=mirror)
    two = pressure(lowered, "*SET_SEGMENT\n5\n1,2,6,5\n*LOAD_SEGMENT_SET\n5,20,1.0,0\n", transformation=mirror)
    assert one == two


def test_factors_of_units_hold_for_what_is_blank_as_for_what_is_written(lowered):
    # Pressure is mass / (length time^2): 1000.
    for load in ("*LOAD_SEGMENT\n20,1.0,0,1,2,6,5\n", "*LOAD_SEGMENT\n20,,0,1,2,6,5\n"):
        assert pressure(lowered, load, (1000, 1, 1)) == ["1000 Mbar"]
    # Rows of two includes do not become one.
    more = "*LOAD_SEGMENT\n20,1.0,0,4,3,7,8\n"
    both = pressure(lowered, "*LOAD_SEGMENT\n20,1.0,0,1,2,6,5\n", (1000, 1, 1), more=more)
    assert sorted(abs(float(p.split()[0])) for p in both) == [1, 1000]


def test_an_impulse_takes_the_units_of_its_include(lowered):
    erosion = "*MAT_ADD_EROSION\n1\n,,,,,0.01,2.0\n"
    block, files = included(erosion, 1000, 1, 1)
    case, _ = lowered(deck(block), includes=files)
    there = case["materials"]["mat_1"]["erosion"]["criteria"][0]
    case, _ = lowered(deck(erosion))
    here = case["materials"]["mat_1"]["erosion"]["criteria"][0]
    assert there["limit"] == pytest.approx(1e6 * here["limit"], rel=1e-12)
    assert here["limit"] == pytest.approx(2.0 * 1e22 * 1e-6, rel=1e-12)


JWL = "*EOS_JWL\n9,3.712,0.0323,4.15,0.95,0.3,0.07,1.0\n"
EXPLOSIVE = "*MAT_HIGH_EXPLOSIVE_BURN\n9,1.63,0.693,0.21,2.0\n" + JWL


def test_a_detonator_moves_with_its_include(lowered):
    block, files = included("*INITIAL_DETONATION\n1,0.5,0.5,0.0,1.0\n", transformation="TRANSL,100,0,0")
    case, told = lowered(deck(EXPLOSIVE, block, parts="*PART\nlower\n1,1,9,9\n*PART\nupper\n2,1,1\n"), includes=files)
    assert case, told
    eos = next(m["eos"] for m in case["materials"].values() if m["eos"]["type"] == "jwl")
    assert eos["detonators"][0]["point"] == "100.5 0.5 0 cm"


@pytest.mark.parametrize("line", [
    "*INITIAL_VELOCITY_NODE\n1,1.0,0,0\n", "*BOUNDARY_SPC_NODE\n1,0,1,0,0\n", "*LOAD_NODE_POINT\n1,1,20,1.0\n",
    "*LOAD_BODY_Z\n20,1.0\n", "*BOUNDARY_PRESCRIBED_MOTION_NODE\n1,1,0,20,1.0\n",
])
def test_directions_in_an_include_that_is_turned_are_refused(lowered, line):
    block, files = included(line, transformation="ROTATE,0,0,1,0,0,0,90")
    refused(lowered, deck(CURVE, block), "in an include that is turned", includes=files)
    block, files = included(line, transformation="TRANSL,1,0,0")
    case, told = lowered(deck(CURVE, block), includes=files)
    assert case, told


# ---- Laws

BRITTLE = {
    "MAT_JOHNSON_HOLMQUIST_CERAMICS":
        "1,3.7,0.9,0.93,0.31,0.0,0.6,0.6\n1e-6,0.002,0.2,0.02,0.015,1.0\n0.005,1.0,1.31,0,0,{fs}\n",
    "MAT_JOHNSON_HOLMQUIST_CONCRETE":
        "1,2.4,0.149,0.79,1.6,0.007,0.61,4.8e-4\n4e-5,1e-6,0.01,7.0,1.6e-4,0.001,0.008,0.1\n"
        "0.04,1.0,0.85,-1.71,2.08,{fs}\n",
}


@pytest.mark.parametrize("law, fs, expected", [
    ("MAT_JOHNSON_HOLMQUIST_CERAMICS", "0.0", None),
    ("MAT_JOHNSON_HOLMQUIST_CERAMICS", "-1.0", "volume_ratio > 1.0015290519877675"),
    ("MAT_JOHNSON_HOLMQUIST_CONCRETE", "0.0", "pressure <= -0.999 * 4000000 Pa * (1 - damage)"),
    ("MAT_JOHNSON_HOLMQUIST_CONCRETE", "-1.0", "damage >= 1"),
    ("MAT_JOHNSON_HOLMQUIST_CONCRETE", "0.5", 0.5),
])
def test_failure_of_brittle_laws(lowered, law, fs, expected):
    case, told = lowered(deck(mesh=CUBE.replace(ELASTIC, f"*{law}\n" + BRITTLE[law].format(fs=fs))))
    assert case, told
    erosion = case["materials"]["mat_1"].get("erosion")
    assert (erosion is None) == (expected is None)
    if expected is not None:
        criterion = erosion["criteria"][0]
        found = criterion.get("expression", criterion.get("limit"))
        # Products of the unit leave round-off of a few digits behind the sixteenth.
        assert found == expected or re.sub(r"[\d.e+]+ Pa", lambda n: f"{float(n[0][:-3]):.10g} Pa", found) == expected


def with_material(card, parts=PARTS):
    return deck(parts=parts, mesh=CUBE.replace(ELASTIC, card))


PLASTIC = "*MAT_PIECEWISE_LINEAR_PLASTICITY\n1,7.8,2.0,0.3,0.01,0.0,,\n{c},{p},{lcss},0,{vp}\n\n\n"


def test_rates_of_a_table_leave_no_place_for_others(lowered):
    table = "*DEFINE_TABLE\n5\n0.0\n1.0\n*DEFINE_CURVE\n6\n0,0.01\n1,0.02\n*DEFINE_CURVE\n7\n0,0.02\n1,0.03\n"
    case, told = lowered(with_material(PLASTIC.format(c=40, p=5, lcss=5, vp=1) + table))
    strength = case["materials"]["mat_1"]["strength"]
    assert "C" not in strength and len(strength["curves"]) == 2
    assert "C and P have no effect" in told
    refused(lowered, with_material(PLASTIC.format(c=0, p=0, lcss=-5, vp=1) + table), "LCSS < 0")


@pytest.mark.parametrize("vp", ["", "0", "0.0"])
def test_a_rate_of_the_whole_strain_is_told_whether_it_is_written_or_not(lowered, vp):
    case, told = lowered(with_material(PLASTIC.format(c=40, p=5, lcss="", vp=vp)))
    assert case and "the rate is always that of the plastic strain" in told
    case, told = lowered(with_material(PLASTIC.format(c=40, p=5, lcss="", vp=vp)), "--strict")
    assert case is None and "--strict takes nothing of this kind" in told
    case, told = lowered(with_material(PLASTIC.format(c=0, p=0, lcss="", vp=vp)), "--strict")
    assert case, told


JOHNSON_COOK = ("*MAT_JOHNSON_COOK\n1,7.8,0.8,2.1,0.3,,1.0\n0.008,0.005,0.3,{c},1.0,1800,293,{rate}\n"
                "4.5e-6,{pc},{spall}\n\n")
GRUNEISEN = "*EOS_GRUNEISEN\n1,0.46,1.33,,,2.0\n\n"
WITH_EOS = "*PART\nlower\n1,1,1,1\n*PART\nupper\n2,1,1,1\n"


def test_a_rate_factor_needs_its_reference_rate(lowered):
    card = JOHNSON_COOK.format(c=0.01, rate="", pc=0, spall=0)
    refused(lowered, with_material(card + GRUNEISEN, WITH_EOS), "without its reference rate")
    card = JOHNSON_COOK.format(c=0.01, rate=1e-6, pc=0, spall=0)
    case, told = lowered(with_material(card + GRUNEISEN, WITH_EOS))
    assert case["materials"]["mat_1"]["strength"]["reference_rate"] == "1e-06 1/us", told
    case, told = lowered(with_material(JOHNSON_COOK.format(c=0, rate="", pc=0, spall=0) + GRUNEISEN, WITH_EOS))
    assert case, told


def test_a_tension_limit_without_effect_is_told(lowered):
    card = JOHNSON_COOK.format(c=0, rate="", pc=-0.05, spall=1)
    case, told = lowered(with_material(card + JWL.replace("\n9,", "\n1,"), WITH_EOS))
    assert case and "a pressure cut-off has no effect" in told


@pytest.mark.parametrize("fields", ["2,,,,", "2,0.0,0.0,0.0,0.0"])
def test_a_blank_and_a_zero_mean_the_same(lowered, fields):
    """Fields of *HOURGLASS: IHQ, QM, (IBQ,) Q1 and Q2, beside *CONTROL_BULK_VISCOSITY."""
    ihq, qm, q1, q2, _ = (fields + ",").split(",")[:5]
    control = f"*CONTROL_BULK_VISCOSITY\n2.5,0.2\n*HOURGLASS\n4,{ihq},{qm},,{q1},{q2}\n"
    case, told = lowered(deck(control, parts="*PART\nlower\n1,1,1,0,4\n*PART\nupper\n2,1,1\n"))
    element = case["parts"]["lower"]["element"]
    assert (element["quadratic_viscosity"], element["linear_viscosity"]) == (2.5, 0.2)
    assert element == case["parts"]["upper"]["element"] | {"hourglass_coefficient": 0.1}


def test_a_rate_constant_of_zero_is_no_rate(lowered):
    card = "*MAT_PLASTIC_KINEMATIC\n1,7.8,2.0,0.3,0.01,0.0,1.0\n{src},{srp},0.5,0\n"
    case, _ = lowered(with_material(card.format(src=0, srp=5)))
    assert case["materials"]["mat_1"]["strength"]["type"] == "elastic_plastic"
    refused(lowered, with_material(card.format(src=40, srp=0)), "exponent of Cowper and Symonds is missing")


# ---- The rest


def test_what_is_told_of_a_control_card_is_told_once(lowered):
    curves = CURVE + CURVE.replace("20\n", "21\n", 1)
    loads = "*LOAD_BODY_Z\n20,1.0\n*LOAD_BODY_X\n21,1.0\n"
    _, told = lowered(deck("*CONTROL_TERMINATION\n10.0\n", curves, loads))
    assert told.count("*CONTROL_TERMINATION is written again") == 1


def test_output_by_number_of_states(lowered):
    case, _ = lowered(deck("*DATABASE_BINARY_D3PLOT\n0.0,,,100\n*DATABASE_GLSTAT\n0.1,3\n"))
    assert case["output"] == {"results_interval": "0.1 us", "history_interval": "0.1 us"}


def test_blank_criteria_beside_an_excluding_number_are_told(lowered):
    _, told = lowered(deck("*MAT_ADD_EROSION\n1,999\n999,999,999,999,999,999,999,999\n"))
    assert "blank fields are taken as left out" in told


def test_a_curve_of_dynamic_relaxation_is_refused(lowered):
    refused(lowered, deck(CURVE.replace("20\n", "20,1\n", 1), "*LOAD_BODY_Z\n20,1.0\n"), "SIDR = 1")


@pytest.mark.parametrize("law", list(BRITTLE))
def test_brittle_bricks_that_are_drawn_are_eroded(tmp_path, law):
    drawn = ("*SET_NODE_LIST\n1\n1,2,3,4\n*SET_NODE_LIST\n2\n9,10,11,12\n*BOUNDARY_SPC_SET\n1,0,1,1,1\n"
             "*BOUNDARY_PRESCRIBED_MOTION_SET\n2,3,0,20,0.01\n") + CURVE
    fs = "-1.0" if "CERAMICS" in law else "0.0"
    (tmp_path / "deck.k").write_text(
        deck(drawn, mesh=CUBE.replace(ELASTIC, f"*{law}\n" + BRITTLE[law].format(fs=fs))))
    done = kerf("run", "deck.k", "--units", "g-cm-us", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert sum(summary_of(tmp_path / "results" / "deck")["eroded"]["by_part"].values()) > 0


def test_more_velocities_than_boundaries_can_be_made_of_are_refused(lowered):
    points = "".join(f"{i},0.0,0.0,{i}.0\n" for i in range(100, 2102))
    velocities = "*INITIAL_VELOCITY_NODE\n" + "".join(f"{i},{i}.0,0.0,0.0\n" for i in range(100, 2102))
    refused(lowered, deck("*NODE\n" + points + velocities), "2002 different velocities")


def test_control_characters_of_a_keyword_do_not_reach_messages(tmp_path):
    (tmp_path / "deck.k").write_bytes(deck("*ELEMENT_S\rHELL\n9,2,1,2,3,4\n").encode())
    done = kerf("check", "deck.k", "--units", "g-cm-us", cwd=tmp_path)
    assert done.returncode == 2
    assert "\r" not in done.stderr
    assert all(re.match(r"deck\.k:\d+:\d+: (error|warning): ", line) for line in done.stderr.splitlines())
