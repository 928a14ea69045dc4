"""Frames hold the same bytes on any number of ranks, while elements die, move between ranks and are compacted away; and
what they hold fits together."""

import numpy as np
import pytest

ROD = ("oblique_rod/oblique_rod.yaml", "parameters.cell_size=1.9 mm", "time.end=14 us", "balance.force_interval=10",
       "output.results_interval=1 us", "output.precision=double",
       "output.element_fields=[stress, pressure, density, internal_energy, von_mises, effective_plastic_strain]",
       "output.node_fields=[velocity, displacement, mass]")


def datasets(run):
    """Name and content of every table of results.vtkhdf."""
    import h5py

    found = {}
    with h5py.File(run.folder / "results.vtkhdf") as file:
        file.visititems(lambda name, it: found.update({name: it[()]}) if isinstance(it, h5py.Dataset) else None)
    return found


@pytest.fixture(scope="module")
def one_rank(kerf):
    return kerf(*ROD)


@pytest.mark.parametrize("settings", [("ranks=2",), ("ranks=3", "balance.partitioner={type: zoltan_graph}"),
                                      ("ranks=5", "balance.partitioner={type: none}")], ids=lambda s: s[0])
def test_frames_are_the_same_bytes(kerf, one_rank, settings):
    ranks = int(settings[0].split("=")[1])
    ours, theirs = datasets(kerf(*ROD, *settings[1:], ranks=ranks)), datasets(one_rank)
    assert ours.keys() == theirs.keys() and len(ours) > 20
    assert [name for name in ours if ours[name].tobytes() != theirs[name].tobytes()] == []


def test_frames_are_those_of_an_eroding_run(one_rank):
    # Otherwise the test above would show little.
    results = one_rank.results
    alive = [int(results.cell("alive", frame).sum()) for frame in range(len(results.times))]
    assert len(alive) == 15 and alive == sorted(alive, reverse=True)
    assert alive[0] == len(results.cells) and alive[0] - alive[-1] == one_rank.summary["eroded"]["elements"] > 10


@pytest.mark.parametrize("frame", [0, 5, -1])
def test_fields_of_a_frame_fit_together(one_rank, frame):
    results = one_rank.results
    alive = results.cell("alive", frame) == 1
    stress = results.cell("stress", frame)
    # The pressure that trace and field differ by is the round-off of three sums.
    pressure = results.cell("pressure", frame)
    scale = np.abs(stress).max() + 1.0
    assert np.abs(stress[:, :3].mean(axis=1) + pressure).max() < 1e-14 * scale
    deviator = stress.copy()
    deviator[:, :3] += pressure[:, None]
    squares = (deviator[:, :3] ** 2).sum(axis=1) + 2.0 * (deviator[:, 3:] ** 2).sum(axis=1)
    assert np.abs(np.sqrt(1.5 * squares) - results.cell("von_mises", frame)).max() < 1e-14 * scale
    assert (results.cell("density", frame)[alive] > 0.0).all()
    for name in ("stress", "density", "von_mises", "effective_plastic_strain"):
        assert not results.cell(name, frame)[~alive].any(), "fields of eroded elements are zero"
    # Positions are of the order of 0.1 m: their difference is exact to a unit in the last place.
    moved = results.points(frame) - results.points(0)
    assert np.abs(moved - results.node("displacement", frame)).max() < 1e-16
    mass = one_rank.summary["mass"]
    assert abs(results.node("mass", frame).sum() - mass["initial"]) < 1e-13 * mass["initial"]
