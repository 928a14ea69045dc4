"""`kerf check` tells of decks what an independent reader finds in them, and refuses what cannot be run at its place."""

import re

import pytest
from deck_case import DECKS, UNITS, copied, figures_of, in_si, kerf, rows_of, table_of_parts


@pytest.mark.parametrize("deck", UNITS)
def test_figures_are_those_of_another_reader(deck):
    figures = figures_of(deck)
    done = kerf("check", DECKS / deck, "--units", UNITS[deck])
    assert done.returncode == 0, done.stderr
    mass, length, time = in_si(UNITS[deck])
    parts = table_of_parts(done.stdout)
    with_solids = {id: part for id, part in figures["parts"].items() if part.get("solids")}
    for id, part in with_solids.items():
        # The table has eight digits.
        assert parts[id]["volume"] == pytest.approx(part["volume"], rel=1e-6), parts[id]["line"]
        assert parts[id]["mass"] == pytest.approx(part["mass"], rel=1e-6), parts[id]["line"]
    assert int(re.search(r"^elements +(\d+)$", done.stdout, re.M)[1]) == sum(p["solids"] for p in with_solids.values())
    assert int(re.search(r"^nodes of the deck +(\d+)$", done.stdout, re.M)[1]) == figures["nodes"]
    total = float(re.search(r"^mass +(\S+) kg$", done.stdout, re.M)[1])
    assert total == pytest.approx(figures["total_solid_mass"] * mass, rel=1e-5)  # printed with six digits
    energy = float(re.search(r"^kinetic energy +(\S+) J$", done.stdout, re.M)[1])
    joule = mass * (length / time) ** 2
    if "08_tension" not in deck:  # there the drawn nodes have the velocity of their curve from the beginning
        assert energy == pytest.approx(figures["initial_kinetic_energy"] * joule, rel=1e-5, abs=1e-300)


@pytest.mark.parametrize("deck", ["02_taylor_bar/taylor.k", "03_oblique_rod/rod.k", "05_plate_impact/plate_impact.k"])
def test_a_deck_begins_with_the_step_of_its_equivalent(deck):
    first = re.compile(r"^first time step +(\S+) s", re.M)
    of_deck = kerf("check", DECKS / deck, "--units", UNITS[deck])
    of_yaml = kerf("check", (DECKS / deck).parent / "equivalent.yaml")
    # Four digits are printed.
    assert float(first.search(of_deck.stdout)[1]) == pytest.approx(float(first.search(of_yaml.stdout)[1]), rel=2e-4)


def test_all_that_cannot_be_run_is_told_at_once():
    deck = DECKS / "14_unsupported" / "unsupported.k"
    done = kerf("check", deck, "--units", "kg-mm-ms")
    assert done.returncode == 2
    for row in rows_of(deck.with_name("expected.tsv")):
        keyword = row["keyword"].removeprefix("*")
        place = rf".*:{row['line']}:\d+: error: .*{keyword}"
        found = [line for line in done.stderr.splitlines() if re.match(place, line)]
        assert len(found) == 1, f"line {row['line']}: {keyword}\n{done.stderr}"
    for word in ("implicit time integration", "thermal", "1 element of part 2", "1 element of part 3", "concrete",
                 "electromagnetism", "coupling of beams"):
        assert word in done.stderr


def test_what_cannot_be_run_is_left_out_where_the_user_wants_it(tmp_path):
    deck = copied("14_unsupported/unsupported.k", tmp_path)
    text = deck.read_text()
    begin, end = text.index("*MAT_CSCM_CONCRETE_TITLE"), text.index("*MAT_ELASTIC\n")
    deck.write_text(text[:begin] + "*MAT_ELASTIC\n         1    2.4E-6      30.0       0.2\n" + text[end:])
    done = kerf("check", deck, "--units", "kg-mm-ms", "--without-unsupported")
    assert done.returncode == 0, done.stderr
    # Nine of the ten lines of expected.tsv: the concrete has become elastic.
    assert done.stderr.count("left out") == 9
    assert int(re.search(r"^left out +(\d+)$", done.stdout, re.M)[1]) == 8  # the reader tells of *EM_CONTROL
    nothing = copied("14_unsupported/unsupported.k", tmp_path / "whole")
    done = kerf("check", nothing, "--units", "kg-mm-ms", "--without-unsupported")
    assert done.returncode == 2 and "no part is left" in done.stderr and "CSCM" in done.stderr


BAD = rows_of(DECKS / "15_bad" / "expected.tsv")


@pytest.mark.parametrize("row", BAD, ids=[row["file"] for row in BAD])
def test_mistakes_are_told_at_their_places(row):
    done = kerf("check", row["file"], "--units", "kg,m,s", cwd=DECKS / "15_bad")
    if row["line"] == "-" or "this deck is good" in row["what the message has to say"]:
        assert done.returncode == 0, done.stderr
        return
    assert done.returncode == 2
    place = f"{row['file']}:{row['line']}:{row['column']}: error: "
    assert any(line.startswith(place) for line in done.stderr.splitlines()), done.stderr
    assert all(re.match(r"[^:]+:\d+:\d+: error: ", line) for line in done.stderr.splitlines()), done.stderr


def test_units_are_never_guessed():
    deck = DECKS / "02_taylor_bar" / "taylor.k"
    done = kerf("check", deck)
    assert done.returncode == 2
    assert "does not say its units" in done.stderr and "fit kg-mm-ms" in done.stderr
    assert "g-cm-us" not in done.stderr.partition("fit ")[2]
    wrong = kerf("check", deck, "--units", "g,parsec,us")
    assert wrong.returncode == 2 and "parsec" in wrong.stderr and "g-cm-us" in wrong.stderr


def test_units_of_the_deck_itself_count(tmp_path):
    deck = copied("01_one_element/one_element.k", tmp_path)
    card = "*CONTROL_UNITS\n" + "".join(f"{word:>10}" for word in ("m", "sec", "kg", "k")) + "\n"
    deck.write_text(deck.read_text().replace("*CONTROL_OUTPUT", card + "*CONTROL_OUTPUT"))
    done = kerf("check", deck)
    assert done.returncode == 0, done.stderr
    assert "kg, m, s" in done.stdout
    other = kerf("check", deck, "--units", "g,cm,us")
    assert other.returncode == 2 and "leave --units out" in other.stderr


def test_options_of_decks_are_refused_for_other_inputs():
    done = kerf("check", DECKS / "02_taylor_bar" / "equivalent.yaml", "--units", "g,cm,us")
    assert done.returncode == 2 and "keyword decks" in done.stderr


def test_strict_takes_nothing_that_is_done_in_another_way():
    deck = DECKS / "12_rubber_ball" / "rubber_ball.k"
    assert "warning: *CONTACT_INTERIOR" in kerf("check", deck, "--units", "kg-mm-ms").stderr
    done = kerf("check", deck, "--units", "kg-mm-ms", "--strict")
    assert done.returncode == 2 and "error: *CONTACT_INTERIOR" in done.stderr


def test_rigid_materials_are_refused_at_their_place():
    done = kerf("check", "rigid_ball.k", "--units", "kg-mm-ms", cwd=DECKS / "13_rigid_ball")
    assert done.returncode == 2
    lines = (DECKS / "13_rigid_ball" / "rigid_ball.k").read_text().splitlines()
    line = lines.index("*MAT_RIGID_TITLE") + 1
    assert f"rigid_ball.k:{line}:1: error: *MAT_RIGID_TITLE of part 2 has no law" in done.stderr


def one_element_with(cards, folder):
    """`kerf check` of the deck of one element with cards before its part, and the line in which they begin."""
    deck = copied("01_one_element/one_element.k", folder)
    head, part, rest = deck.read_text().partition("*PART")
    deck.write_text(head + cards + part + rest)
    return kerf("check", deck.name, "--units", "kg,m,s", cwd=deck.parent), head.count("\n") + 1


@pytest.mark.parametrize("keyword", ["SET_SHELL", "SET_NODE_COLUMN"])
def test_sets_that_are_not_read_have_no_effect(keyword, tmp_path):
    done, line = one_element_with(f"*{keyword}\n         7\n         1\n", tmp_path)
    assert done.returncode == 0, done.stderr
    assert re.search(rf"^\*{keyword} +without effect +one_element.k:{line}$", done.stdout, re.M), done.stdout


def test_sets_that_are_read_are_done(tmp_path):
    done, line = one_element_with("*SET_NODE_LIST\n         7\n         1\n", tmp_path)
    assert done.returncode == 0, done.stderr
    assert re.search(rf"^\*SET_NODE_LIST +done +one_element.k:{line}$", done.stdout, re.M), done.stdout


def test_sets_that_are_not_read_are_refused_where_something_names_them(tmp_path):
    named = "*SET_NODE_COLUMN\n         7\n         1\n*BOUNDARY_SPC_SET\n         7         0         1\n"
    done, line = one_element_with(named, tmp_path)
    assert done.returncode == 2
    assert f"one_element.k:{line + 4}:1: error: node set 7 is written with *SET_NODE_COLUMN" in done.stderr


@pytest.mark.parametrize(("cards", "place", "message"), [
    ("*MAT_NULL\n         2     1.0\n", None, "material 2 is defined twice; first at one_element.k:"),
    ("*LOAD_NODE_POINT\n         0         1         9\n", "1:1", "NID is 0; expected the number of a node"),
    ("*LOAD_NODE_POINT\n        -5         1         9\n", "1:1", "NID is -5; expected the number of a node"),
    ("*LOAD_NODE_POINT\n         5         1\n", "1:21", "LCID is blank; expected the number of a curve"),
    ("*INITIAL_DETONATION\n        99       0.0\n", "1:1", "part 99 is not defined")])
def test_ids_of_decks_are_defined_once_and_where_they_are_named(cards, place, message, tmp_path):
    done, line = one_element_with(cards, tmp_path)
    assert done.returncode == 2
    below, column = (int(number) for number in (place or "0:0").split(":"))
    where = rf"{line + below}:{column}" if place else r"\d+:1"
    assert re.search(rf"^one_element\.k:{where}: error: .*{re.escape(message)}", done.stderr, re.M), done.stderr
