"""What is wrong with an observer is said with its line, before the run begins."""

import h5py
import pytest

from input_case import GOOD, kerf, on_ranks, summary_of

GAUGE = "{type: gauge, part: target, point: POINT, quantities: [pressure]}"

BAD = {
    "unknown type": ("{type: gage}", 'there is no observer of type "gage"; did you mean `gauge`?'),
    "unknown part": ("{type: part_history, parts: [targets]}", 'there is no part "targets"; did you mean `target`?'),
    "unknown field": ("{type: gauge, part: target, point: 0 0 0 m, quantities: [presure]}",
                      'there is no field "presure"; did you mean `pressure`?'),
    "element field at a node": ("{type: gauge, at: node, part: target, point: 0 0 0 m, quantities: [pressure]}",
                                'there is no node field "pressure"'),
    "no quantities": ("{type: gauge, part: target, point: 0 0 0 m, quantities: []}",
                      "`quantities`: a gauge needs at least one quantity"),
    "unknown key": ("{type: reactions, intervall: 1 us}", "unknown key `intervall`; did you mean `interval`?"),
    "interval that is none": ("{type: part_history, interval: 0 s}", "`interval` = 0 s is out of range"),
    "plane beside the part": ("{type: section_force, part: target, point: 1 0 0 m, normal: 1 0 0}",
                              "the plane does not cut part target: all of its nodes lie on one side"),
    "point outside": ("{type: gauge, part: target, point: 1 0 0 m, quantities: [pressure]}",
                      "the point (1, 0, 0) m is not in part target"),
}


def input_with(observer):
    return GOOD + "\nobservers:\n  watch: " + observer + "\n"


@pytest.mark.parametrize("command", ["check", "run"])
@pytest.mark.parametrize("name", BAD)
def test_a_bad_observer_is_an_error_with_its_line(name, command, tmp_path):
    observer, says = BAD[name]
    text = input_with(observer)
    (tmp_path / "case.yaml").write_text(text)
    words = [command, tmp_path / "case.yaml"] + (["--output", tmp_path / "out"] if command == "run" else [])
    done = kerf(*words, cwd=tmp_path)
    assert done.returncode == 2, done.stdout + done.stderr
    lines = [line for line in done.stderr.splitlines() if ": error: " in line]
    assert len(lines) == 1 and says in lines[0], done.stderr
    assert lines[0].startswith(f"{tmp_path / 'case.yaml'}:{len(text.splitlines())}:")
    assert not (tmp_path / "out" / "history.h5").exists()


@pytest.mark.parametrize("ranks", [1, 2])
def test_all_observers_that_cannot_start_are_named(ranks, tmp_path):
    text = input_with(GAUGE.replace("POINT", "1 0 0 m")) + "  other: " + GAUGE.replace("POINT", "0 2 0 m") + "\n"
    (tmp_path / "case.yaml").write_text(text)
    done = kerf("run", tmp_path / "case.yaml", "--output", tmp_path / "out", *on_ranks(ranks), cwd=tmp_path)
    assert done.returncode == 2
    assert "(1, 0, 0) m is not in part target" in done.stderr and "(0, 2, 0) m is not in part target" in done.stderr


def test_reactions_without_a_boundary_condition_are_refused(tmp_path):
    text = input_with("{type: reactions}")
    if "boundaries:" in text:
        start = text.index("boundaries:")
        end = text.index("\n\n", start) if "\n\n" in text[start:] else len(text)
        text = text[:start] + text[end:]
    (tmp_path / "case.yaml").write_text(text)
    done = kerf("check", tmp_path / "case.yaml")
    assert done.returncode == 2
    assert "the model has no boundary condition; expected at least one under `boundaries`" in done.stderr


def test_columns_are_due_at_their_own_interval(tmp_path):
    (tmp_path / "case.yaml").write_text(input_with("{type: part_history, interval: 0.5 us}"))
    done = kerf("run", tmp_path / "case.yaml", "--output", tmp_path / "out", "--set", "time.end=2 us",
                "--set", "time.maximum_step=0.05 us")
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "out" / "history.h5") as file:
        times = file["watch/time"][()]
        assert file["watch"].attrs["unit of striker.kinetic"] == b"J"
    assert len(times) == 5
    # A row is due at the first step that reaches its time, to within a billionth of the run, for round-off.
    assert all(-2e-15 <= t - 0.5e-6 * i < 0.05e-6 for i, t in enumerate(times[:-1]))
    assert times[-1] == summary_of(tmp_path / "out")["end_time"]


def test_a_section_of_a_joined_part_is_refused(tmp_path):
    text = input_with("{type: section_force, part: upper, point: 100 100 15 mm, normal: 0 0 1}")
    (tmp_path / "case.yaml").write_text(text)
    block = "{material: copper, mesh: {type: block, origin: 100 100 Z mm, size: 10 10 10 mm, cells: [2, 2, 2]}}"
    settings = ["joined=[{parts: [lower, upper]}]"]
    for name, z in (("lower", "0"), ("upper", "10")):
        settings.append(f"parts.{name}=" + block.replace("Z", z))
    words = [word for setting in settings for word in ("--set", setting)]
    done = kerf("check", tmp_path / "case.yaml", *words)
    assert done.returncode == 2, done.stdout + done.stderr
    assert ("part upper is joined with part lower, and the force on nodes that they share cannot be told apart; "
            "expected a part that is joined with no other") in done.stderr
