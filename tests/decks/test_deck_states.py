"""A deck, what it is converted to, any number of ranks and a restart give one state, bit for bit."""

import pytest
from deck_case import DECKS, UNITS, copied, kerf, on_ranks, run, summary_of

SHORT = {"03_oblique_rod/rod.k": "20 us", "06_explosive_tube/tube.k": "6 us", "07_ceramic_tile/tile.k": "10 us",
         "04_ball_free_format/ball.k": "8 us"}


@pytest.mark.parametrize("deck", SHORT)
def test_converted_decks_and_ranks_give_one_state(deck, tmp_path):
    path = copied(deck, tmp_path)
    words = ["--units", UNITS[deck], "--set", f"time.end={SHORT[deck]}"]
    alone = run(path, *words)["state_hash"]
    for ranks in (2, 3):
        assert run(path, *words, *on_ranks(ranks))["state_hash"] == alone
    done = kerf("convert", path, "--units", UNITS[deck], "--output", tmp_path / "own")
    assert done.returncode == 0, done.stderr
    assert run(tmp_path / "own" / "case.yaml", "--set", f"time.end={SHORT[deck]}")["state_hash"] == alone
    two = run(tmp_path / "own" / "case.yaml", "--set", f"time.end={SHORT[deck]}", *on_ranks(2))
    assert two["state_hash"] == alone


def test_a_deck_is_resumed_even_as_what_it_was_converted_to(tmp_path):
    deck = "03_oblique_rod/rod.k"
    path = copied(deck, tmp_path)
    end = ["--set", "time.end=20 us"]
    units = ["--units", UNITS[deck]]
    hashes = set()
    for first, words in (("whole", []), ("out", ["--set", "time.maximum_cycles=100"]),
                         ("other", ["--set", "time.maximum_cycles=100"])):
        done = kerf("run", path.name, *units, *end, *words, "--output", first, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    assert summary_of(tmp_path / "out")["cycles"] == 100
    assert kerf("run", path.name, *units, *end, "--output", "out", "--resume", cwd=tmp_path).returncode == 0
    assert kerf("convert", path.name, *units, "--output", "own", cwd=tmp_path).returncode == 0
    done = kerf("run", "own/case.yaml", *end, "--output", "other", "--resume", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for folder in ("whole", "out", "other"):
        hashes.add(summary_of(tmp_path / folder)["state_hash"])
    assert len(hashes) == 1


@pytest.mark.parametrize("mesh", ["bar_and_plate_v22.msh", "sphere_plate_contact.g", "Tensile.inp"])
def test_a_mesh_becomes_the_beginning_of_an_input(mesh, tmp_path):
    path = DECKS.parent / "meshes" / mesh
    refused = kerf("convert", path, "--output", tmp_path)
    assert refused.returncode == 2 and "--units" in refused.stderr
    done = kerf("convert", path, "--units", "mm", "--output", tmp_path)
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "case.yaml").read_text()
    assert "parts:" in text and "unit: mm" in text
    # What is missing is told, and nothing else is wrong.
    check = kerf("check", tmp_path / "case.yaml")
    assert check.returncode == 2 and "required key `time`" in check.stderr


def test_a_deck_that_is_a_mesh_only_is_converted(tmp_path):
    done = kerf("convert", DECKS / "16_public" / "bar_impact_mesh.k", "--units", "mm", "--output", tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "mesh.h5").exists()
    run_of_it = kerf("run", DECKS / "16_public" / "bar_impact_mesh.k", "--units", "kg-mm-ms")
    assert run_of_it.returncode == 2 and "CONTROL_TERMINATION" in run_of_it.stderr
