"""Virtual ranks of a mesh, against sets and loops over its elements; and cuts of space."""

from collections import Counter, defaultdict

import numpy as np
import pytest
from predict_scenes import block, two_blocks, uneven_seconds

from cuts import Cuts
from virtual_ranks import FACES, moved_elements, opened_facets, share_out, share_out_contact


def as_counter(messages):
    return Counter(dict(zip(zip(messages.source.tolist(), messages.destination.tolist()), messages.items.tolist())))


def holders_of(mesh, owners):
    holders = defaultdict(set)
    for cell, rank in zip(mesh.cells, owners):
        for node in cell:
            holders[int(node)].add(int(rank))
    return holders


def owner_by_rule(node, ranks, n_ranks):
    """framework/parallel/ownership.cpp: among h holders the one numbered (id / ranks) mod h."""
    ordered = sorted(ranks)
    return ordered[(node // n_ranks) % len(ordered)]


@pytest.fixture(params=[1, 2, 5, 16])
def shared(request):
    mesh, scene = two_blocks(6)
    n_ranks = request.param
    owners = Cuts(mesh.centres(), uneven_seconds(mesh), n_ranks).part
    return mesh, scene, owners, n_ranks


def test_owners_and_halo_are_those_of_a_loop(shared):
    mesh, _, owners, n_ranks = shared
    ranks = share_out(mesh, owners, n_ranks)
    halo, copies = Counter(), Counter()
    for node, holders in holders_of(mesh, owners).items():
        owner = owner_by_rule(node, holders, n_ranks)
        assert ranks.owner_of_node[node] == owner
        for rank in holders:
            copies[rank] += 1
            if rank != owner:
                halo[(rank, owner)] += 1
    assert as_counter(ranks.halo) == halo
    assert {r: c for r, c in enumerate(ranks.copies) if c} == copies
    assert ranks.elements.sum() == len(mesh.cells)
    homes = Counter((rank, node % n_ranks) for node, holders in holders_of(mesh, owners).items() for rank in holders
                    if rank != node % n_ranks)
    assert as_counter(ranks.to_homes()) == homes


def test_faces_between_ranks_are_those_of_a_loop(shared):
    mesh, _, owners, n_ranks = shared
    sides = defaultdict(list)
    for cell, rank in zip(mesh.cells, owners):
        for face in FACES[8]:
            sides[tuple(sorted(cell[face]))].append(int(rank))
    expected = Counter()
    for ranks in sides.values():
        if len(ranks) == 2 and ranks[0] != ranks[1]:
            expected[(ranks[0], ranks[1])] += 1
            expected[(ranks[1], ranks[0])] += 1
    assert as_counter(share_out(mesh, owners, n_ranks).interface_faces) == expected


@pytest.mark.parametrize("space", ["rcb", "owners"])
def test_contact_needs_the_nodes_of_its_pairs(shared, space):
    mesh, scene, owners, n_ranks = shared
    ranks = share_out(mesh, owners, n_ranks)
    share_out_contact(ranks, mesh, scene, space)
    needed = defaultdict(set)
    for slave, facet in zip(scene.pair_slave, scene.pair_facet):
        needed[int(ranks.contact_rank[slave])] |= {int(scene.slaves[slave]), *map(int, scene.facets[facet])}
    pull = Counter()
    for rank, nodes in needed.items():
        assert ranks.contact_nodes[rank] == len(nodes)
        for node in nodes:
            if ranks.owner_of_node[node] != rank:
                pull[(int(ranks.owner_of_node[node]), rank)] += 1
    assert as_counter(ranks.contact_pull) == pull
    active = Counter()
    touching = defaultdict(set)
    for slave, facet in zip(scene.pair_slave[scene.pair_touches], scene.pair_facet[scene.pair_touches]):
        touching[int(ranks.contact_rank[slave])] |= {int(scene.slaves[slave]), *map(int, scene.facets[facet])}
    for rank, nodes in touching.items():
        active.update((int(ranks.owner_of_node[node]), rank) for node in nodes if ranks.owner_of_node[node] != rank)
    assert as_counter(ranks.contact_active) == active
    assert as_counter(ranks.contact_told) == {(h, o): active[(o, h)] for o, h in pull}
    if space == "owners":
        np.testing.assert_array_equal(ranks.contact_rank, ranks.owner_of_node[scene.slaves])


def test_what_eroding_elements_lay_bare_goes_to_contact_there():
    mesh, scene = two_blocks(6)
    owners = Cuts(mesh.centres(), np.ones(len(mesh.cells)), 8).part
    ranks = share_out(mesh, owners, 8)
    share_out_contact(ranks, mesh, scene)
    eroded = np.array([0, 17, 100])
    expected = Counter()
    for e in eroded:
        for rank in set(ranks.cuts.locate(mesh.points[mesh.cells[e]]).tolist()) - {int(owners[e])}:
            expected[(int(owners[e]), rank)] += 1
    assert as_counter(opened_facets(ranks, mesh, eroded)) == expected


def test_elements_that_move_are_counted():
    assert as_counter(moved_elements([0, 0, 1, 2], [0, 1, 1, 0], 3)) == {(0, 1): 1, (2, 0): 1}


@pytest.mark.parametrize("n_parts", [1, 2, 3, 7, 64, 100])
def test_cuts_share_out_the_weight(n_parts):
    rng = np.random.default_rng(2)
    points, weights = rng.uniform(size=(20000, 3)), rng.uniform(0.5, 1.5, 20000)
    cuts = Cuts(points, weights, n_parts)
    work = np.bincount(cuts.part, weights=weights, minlength=n_parts)
    # At each of at most seven levels half a point's weight may be on the wrong side.
    assert np.abs(work - weights.sum() / n_parts).max() <= 7 * 1.5
    np.testing.assert_array_equal(cuts.locate(points), cuts.part)


def test_cuts_leave_parts_empty_where_there_are_fewer_points():
    cuts = Cuts([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], [1.0, 1.0], 8)
    assert len(np.unique(cuts.part)) == 2
    assert 0 <= cuts.part.min() <= cuts.part.max() < 8


def test_cuts_of_a_cube_are_cubes():
    mesh = block(8, 8, 8)
    parts = Cuts(mesh.centres(), np.ones(512), 8).part
    for part in range(8):
        inside = mesh.centres()[parts == part]
        np.testing.assert_array_equal(inside.max(axis=0) - inside.min(axis=0), [3.0, 3.0, 3.0])


def test_owners_that_do_not_fit_are_refused():
    mesh = block(2, 2, 2)
    with pytest.raises(ValueError, match="7 owners for 8 elements; expected one for each"):
        share_out(mesh, np.zeros(7), 2)
    with pytest.raises(ValueError, match="expected ranks from 0 to 1"):
        share_out(mesh, np.full(8, 2), 2)
    with pytest.raises(ValueError, match="a contact space `graph`; expected rcb or owners"):
        share_out_contact(share_out(mesh, np.zeros(8), 1), mesh, two_blocks(4)[1], "graph")
