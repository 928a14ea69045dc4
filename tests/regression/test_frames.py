"""Frames hold the same bytes on any number of ranks, while elements die, move between ranks and are compacted away; and
what they hold fits together."""

import numpy as np
import pytest
import test_state_hash
import yaml

FRAMES = ("output.results_interval=2 us",
          "output.element_fields=[stress, pressure, density, internal_energy, von_mises, effective_plastic_strain]",
          "output.node_fields=[velocity, displacement, mass]")
ROD = ("oblique_rod/oblique_rod.yaml", "parameters.cell_size=1.9 mm", "checks.free_nodes=keep", "time.end=28 us",
       "balance.force_interval=10", *FRAMES)
DOUBLE = ("output.precision=double",)
SINGLE = ("precision=single",)  # fields are floats, and so is what is written

# On five ranks some have no elements, or none that live.
EIGHT = yaml.safe_load(test_state_hash.EIGHT)


def datasets(run):
    """Name and content of every table of results.vtkhdf."""
    import h5py

    found = {}
    with h5py.File(run.folder / "results.vtkhdf") as file:
        file.visititems(lambda name, it: found.update({name: it[()]}) if isinstance(it, h5py.Dataset) else None)
    return found


def expect_same_bytes(ours, theirs):
    ours, theirs = datasets(ours), datasets(theirs)
    assert ours.keys() == theirs.keys() and len(ours) > 20
    assert [name for name in ours if ours[name].tobytes() != theirs[name].tobytes()] == []


@pytest.fixture(scope="module")
def one_rank(kerf):
    return {precision: kerf(*ROD, *precision) for precision in (DOUBLE, SINGLE)}


@pytest.mark.parametrize("ranks, precision, partitioner", [
    (2, DOUBLE, "zoltan_rcb"), (3, DOUBLE, "zoltan_graph"), (5, DOUBLE, "none"), (3, SINGLE, "zoltan_hsfc")])
def test_frames_are_the_same_bytes(kerf, one_rank, ranks, precision, partitioner):
    many = kerf(*ROD, *precision, f"balance.partitioner={{type: {partitioner}}}", ranks=ranks)
    if partitioner != "none":
        assert len(many.summary["rebalances"]) > 2
    expect_same_bytes(many, one_rank[precision])


@pytest.mark.parametrize("ranks", [3, 5])
def test_ranks_without_elements_write_the_same_bytes(kerf, ranks):
    settings = ("output.results_interval=0.2 us", *FRAMES[1:])
    expect_same_bytes(kerf(EIGHT, *settings, ranks=ranks), kerf(EIGHT, *settings))


def test_frames_are_those_of_a_run_that_erodes_and_is_compacted(one_rank):
    # Otherwise the tests above would show little. A part is compacted when 2 % of its places are empty.
    run = one_rank[DOUBLE]
    results = run.results
    alive = [int(results.cell("alive", frame).sum()) for frame in range(len(results.times))]
    assert len(alive) == 15 and alive == sorted(alive, reverse=True)
    assert alive[0] == len(results.cells) and alive[0] - alive[-1] == run.summary["eroded"]["elements"]
    assert alive[-1] < 0.97 * alive[0]


@pytest.mark.parametrize("frame", [0, 5, -1])
def test_fields_of_a_frame_fit_together(one_rank, frame):
    results = one_rank[DOUBLE].results
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
    mass = one_rank[DOUBLE].summary["mass"]
    assert abs(results.node("mass", frame).sum() - mass["initial"]) < 1e-13 * mass["initial"]
