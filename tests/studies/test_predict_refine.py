"""`kerf predict --refine`: a coarse recording that stands for finer cells, against a recording with these cells."""

import csv

import numpy as np
import pytest
from predict_scenes import sample_recording, two_blocks
from test_predict_command import predict

import cycle
import prediction
from cuts import Cuts
from networks import find_network, read_network
from recording import Moment, Recording, write_recording
from refinement import refined, refined_copies
from virtual_ranks import boxes_of_pieces, share_out, share_out_contact


def blocks(n, width=None):
    """A recording of two blocks, with cells of such an edge that blocks are as large for every n."""
    mesh, scene = two_blocks(n)
    mesh.points *= 1.0 if width is None else width / n
    seconds = 3.0e-7 * np.where(mesh.centres()[:, 0] < mesh.points[:, 0].mean(), 1.4, 1.0)
    return Recording([Moment(0, 100, mesh, np.arange(len(mesh.cells)), seconds, contact=scene, n_searches=2.0,
                             n_renewals=8.0)])


def outcome(recording, n_ranks, refine=1, policy="never"):
    return prediction.predict(recording, n_ranks, prediction.CutPartitions(), prediction.read_policy(policy),
                              [read_network(find_network("hdr_infiniband"))], refine=refine)[0]


def test_serial_time_is_that_of_the_finer_mesh():
    coarse, fine = outcome(blocks(8, 8.0), 1, 2), outcome(blocks(16, 8.0), 1)
    assert coarse.useful["elements"].sum() == pytest.approx(fine.useful["elements"].sum(), rel=1.0e-12)
    assert coarse.useful["nodes"].sum() == pytest.approx(fine.useful["nodes"].sum(), rel=0.05)
    # The two recordings have a node more than cells along each edge, so contact is a little too large.
    assert coarse.useful["contact_forces"].sum() == pytest.approx(fine.useful["contact_forces"].sum(), rel=0.35)


@pytest.mark.parametrize("n_ranks", [2, 8, 16])
def test_efficiency_is_that_of_the_finer_mesh(n_ranks):
    def efficiency(recording, refine):
        return (outcome(recording, 1, refine).seconds / outcome(recording, n_ranks, refine).seconds) / n_ranks

    # A rank of contact looks as far round a slave as in coarse cells, and coarse elements share out less evenly: never
    # much better.
    coarse, fine = efficiency(blocks(16, 16.0), 2), efficiency(blocks(32, 16.0), 1)
    assert fine - 0.08 < coarse < fine + 0.03


def test_interfaces_grow_with_the_square():
    fine, coarse = blocks(16).moments[0].mesh, blocks(8).moments[0].mesh
    ranks = [share_out(mesh, Cuts(mesh.centres(), np.ones(len(mesh.cells)), 4).part, 4) for mesh in (coarse, fine)]
    sizes = refined(blocks(8), cycle.Sizes(), cycle.Rates(), 2)[1]
    assert sizes.force == 4 * cycle.Sizes().force and sizes.element_record == 8 * cycle.Sizes().element_record
    assert sizes.reduction == cycle.Sizes().reduction
    assert 4 * ranks[0].interface_faces.items.sum() == pytest.approx(ranks[1].interface_faces.items.sum(), rel=0.2)
    assert 4 * ranks[0].halo.items.sum() == pytest.approx(ranks[1].halo.items.sum(), rel=0.2)
    assert refined_copies(ranks[0].copies, ranks[0].elements, 8, 2).sum() == pytest.approx(ranks[1].copies.sum(),
                                                                                         rel=0.05)


def test_a_cube_of_nodes_is_counted_to_its_second_order():
    n, k = 6, 3
    estimate = refined_copies(np.array([(n + 1) ** 3]), np.array([n**3]), 8, k)[0]
    exact = (n * k + 1) ** 3
    assert exact <= estimate <= exact + 3 * n * k * k + k * k


def test_contact_is_spread_and_keeps_its_sum():
    recording = sample_recording()
    scene, finer = recording.moments[0].contact, refined(recording, cycle.Sizes(), cycle.Rates(), 3)[0].moments[0]
    assert finer.contact.search_seconds.sum() == pytest.approx(9.0 * scene.search_seconds.sum())
    assert finer.contact.force_seconds.sum() == pytest.approx(9.0 * scene.force_seconds.sum())
    assert np.array_equal(finer.contact.candidates, np.repeat(scene.candidates, 9))
    places = finer.contact.homes.reshape(len(scene.slaves), 9, 3)
    assert np.allclose(places.mean(axis=1), recording.moments[0].mesh.points[scene.slaves])
    assert len(np.unique(places.reshape(-1, 3), axis=0)) == len(scene.slaves) * 9
    assert np.abs(places - places.mean(axis=1, keepdims=True)).max() == pytest.approx(1.0 / 3.0)
    finest = refined(recording, cycle.Sizes(), cycle.Rates(), 8)
    assert len(finest[0].moments[0].contact.slaves) == 16 * len(scene.slaves)
    assert finest[0].moments[0].contact.force_seconds.sum() == pytest.approx(64.0 * scene.force_seconds.sum())
    assert finest[1].slave_record == 4 * cycle.Sizes().slave_record
    assert finest[2].record == pytest.approx(4.0 * cycle.Rates().record)
    ranks = share_out(finer.mesh, Cuts(finer.mesh.centres(), np.ones(len(finer.mesh.cells)), 64).part, 64)
    share_out_contact(ranks, finer.mesh, finer.contact)
    work = ranks.sum_over_slaves(np.ones(len(finer.contact.slaves)))
    assert work.max() < 1.3 * work.mean()


def test_pieces_of_a_facet_cover_it():
    corners = np.array([[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 2.0, 1.0], [0.0, 2.0, 1.0]]])
    low, high = boxes_of_pieces(corners, 4)
    assert len(low) == 16
    assert np.allclose(low.min(axis=0), [0, 0, 0]) and np.allclose(high.max(axis=0), [4, 2, 1])
    assert np.allclose(high - low, [1.0, 0.5, 0.25])


def test_a_finer_run_has_more_cycles_and_erodes_in_more_of_them():
    recording = sample_recording()
    finer = refined(recording, cycle.Sizes(), cycle.Rates(), 2)[0].moments[0]
    assert (finer.n_cycles, finer.n_eroding, finer.n_searches) == (200, 24.0, 2.0)
    assert refined(recording, cycle.Sizes(), cycle.Rates(), 10)[0].moments[0].n_eroding == 1000.0
    assert outcome(recording, 4, 2, "threshold:1.01").moves == outcome(recording, 4, 1, "threshold:1.01").moves == 1


def test_without_refinement_nothing_changes():
    recording = sample_recording()
    assert refined(recording, cycle.Sizes(), cycle.Rates(), 1)[0] is recording
    with pytest.raises(ValueError, match="expected at least 1"):
        refined(recording, cycle.Sizes(), cycle.Rates(), 0)


def test_the_command_refines_and_refuses(tmp_path):
    write_recording(tmp_path / "recording.h5", sample_recording())
    rows = {}
    for k in (1, 3):
        done = predict(tmp_path, "--ranks", "8", "--refine", k, "--output", tmp_path / str(k))
        assert done.returncode == 0, done.stderr
        with open(tmp_path / str(k) / "predict.csv", newline="") as file:
            rows[k] = next(csv.DictReader(file))
        assert int(rows[k]["refine"]) == k
    assert float(rows[3]["seconds_elements"]) == pytest.approx(27.0 * float(rows[1]["seconds_elements"]))
    assert float(rows[3]["efficiency"]) > float(rows[1]["efficiency"])
    done = predict(tmp_path, "--ranks", "8", "--refine", "0")
    assert done.returncode == 2 and "--refine: error: 0; expected a whole number from 1 to 100" in done.stderr
