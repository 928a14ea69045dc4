"""Virtual ranks of a mesh, against sets and loops over its elements; and cuts of space."""

from collections import Counter, defaultdict

import numpy as np
import pytest
from predict_scenes import block, two_blocks, uneven_seconds

from cuts import Cuts, SpaceCuts
from virtual_ranks import (BEHIND, FACES, Mesh, contact_space, copies_of, moved_elements, opened_by, share_out,
                           share_out_contact, slave_work)


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


def surface_of(mesh):
    """{corners: (corners, nodes behind, element)} of all faces that one element has alone."""
    sides = defaultdict(list)
    for element, cell in enumerate(mesh.cells):
        for face, behind in zip(FACES[8], BEHIND):
            sides[frozenset(map(int, cell[face]))].append((cell[face], cell[behind], element))
    return {key: found[0] for key, found in sides.items() if len(found) == 1}


def contact_surface(mesh, scene):
    """The faces of the surface that contact knows: with slaves alone, or candidates."""
    slaves, facets = set(scene.slaves.tolist()), {frozenset(map(int, f)) for f in scene.facets}
    return {key: face for key, face in surface_of(mesh).items() if key <= slaves or key in facets}


@pytest.mark.parametrize("space", ["rcb", "owners"])
def test_contact_needs_the_nodes_of_its_pairs(shared, space):
    mesh, scene, owners, n_ranks = shared
    ranks = share_out(mesh, owners, n_ranks)
    share_out_contact(ranks, mesh, scene, space)
    surface = contact_surface(mesh, scene)
    round_node = defaultdict(set)
    for key in surface:
        for node in key:
            round_node[node].add(key)
    needed = defaultdict(set)
    for slave, facet in zip(scene.pair_slave, scene.pair_facet):
        node = int(scene.slaves[slave])
        for key in {frozenset(map(int, scene.facets[facet]))} | round_node[node]:
            needed[int(ranks.contact_rank[slave])] |= {node, *map(int, surface[key][0]), *map(int, surface[key][1])}
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


def boxes_of_parts(cuts):
    """The box of each part: points above its lower and not above its upper corner belong to the part."""
    low, high = np.full((1, 3), -np.inf), np.full((1, 3), np.inf)
    for axis, place, first_child in cuts.levels:
        n_children = int(first_child[-1]) + (2 if np.isfinite(place[-1]) else 1)
        boxes = np.zeros((2, n_children, 3))
        for k, (a, at, child) in enumerate(zip(axis, place, first_child)):
            boxes[:, child] = low[k], high[k]
            if np.isfinite(at):
                boxes[:, child + 1] = low[k], high[k]
                boxes[1, child, a] = boxes[0, child + 1, a] = at
        low, high = boxes
    return low, high


def ranks_near(cuts, points, reach, n_ranks):
    """The parts that the box round some points touches, by the boxes of all parts."""
    low, high = boxes_of_parts(cuts)
    touches = np.all((points.max(axis=0) + reach > low) & (points.min(axis=0) - reach <= high), axis=1)
    return set(np.flatnonzero(touches).tolist())


def test_records_go_where_boxes_reach(shared):
    mesh, scene, owners, n_ranks = shared
    scene.slave_reach, scene.facet_reach = 0.2, 0.3
    ranks = share_out(mesh, owners, n_ranks)
    share_out_contact(ranks, mesh, scene)
    x, cuts = mesh.points, ranks.space.cuts
    extent = max(x[scene.slaves].max(axis=0) - x[scene.slaves].min(axis=0))
    assert ranks.space.reach == pytest.approx(0.3 + 0.3 + min(8 * 0.2, 0.05 * extent / n_ranks ** (1 / 3)))
    facets, asked = Counter(), set(as_counter(ranks.contact_pull.back()))
    for corners, behind, element in contact_surface(mesh, scene).values():
        for rank in ranks_near(cuts, x[corners], ranks.space.reach, n_ranks):
            facets[(int(owners[element]), rank)] += int(owners[element]) != rank
            asked |= {(rank, int(ranks.owner_of_node[n])) for n in (*corners, *behind)}
    asked |= set(zip(ranks.contact_rank.tolist(), ranks.owner_of_node[scene.slaves].tolist()))
    assert as_counter(ranks.contact_facets) == +facets
    assert set(as_counter(ranks.contact_asked)) == {(rank, owner) for rank, owner in asked if rank != owner}
    assert ranks.contact_asked.items.sum() == ranks.contact_pull.items.sum()


def test_what_eroding_elements_lay_bare_goes_to_contact_there():
    mesh, scene = two_blocks(6)
    scene.facet_reach = 0.3
    owners = Cuts(mesh.centres(), np.ones(len(mesh.cells)), 8).part
    ranks = share_out(mesh, owners, 8)
    share_out_contact(ranks, mesh, scene)
    eroded = np.array([0, 17, 100])
    before, after = surface_of(mesh), surface_of(Mesh(np.delete(mesh.cells, eroded, axis=0), mesh.points))
    left = np.delete(np.arange(len(mesh.cells)), eroded)
    facets, nodes = Counter(), set()
    for key in after.keys() - before.keys():
        corners, _, element = after[key]
        owner = int(owners[left[element]])
        nodes |= key
        for rank in ranks_near(ranks.space.cuts, mesh.points[corners], ranks.space.reach, 8):
            facets[(owner, rank)] += owner != rank
    opened = opened_by(ranks, mesh, scene, eroded)
    assert as_counter(opened.facets) == +facets and len(+facets) > 0
    slaves = Counter()
    for node in nodes - set(scene.slaves.tolist()):
        owner, rank = int(ranks.owner_of_node[node]), int(ranks.space.cuts.locate(mesh.points[[node]])[0])
        slaves[(owner, rank)] += owner != rank
    assert as_counter(opened.slaves) == +slaves
    # All who know facets of an owner hear of its dead elements.
    dead = Counter(owners[eroded].tolist())
    assert as_counter(opened.dead) == {(s, d): dead[s] for s, d in as_counter(ranks.contact_facets) if dead[s]}


def test_ranks_keep_copies_of_what_has_eroded_until_they_move():
    mesh, _ = two_blocks(6)
    owners = Cuts(mesh.centres(), np.ones(len(mesh.cells)), 8).part
    before = share_out(mesh, owners, 8)
    alive = (mesh.cells >= 20).all(axis=1) & (np.arange(len(mesh.cells)) >= 80)
    later = Mesh(mesh.cells[alive] - 20, mesh.points[20:], np.arange(20, len(mesh.points)))
    kept = share_out(later, owners[alive], 8, copies_of(before, mesh))
    assert as_counter(kept.halo) == as_counter(before.halo)
    np.testing.assert_array_equal(kept.owner_of_node, before.owner_of_node[20:])
    moved = share_out(later, owners[alive], 8)
    assert moved.halo.items.sum() < before.halo.items.sum()


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


@pytest.mark.parametrize("n_parts", [1, 2, 3, 7, 64])
def test_cuts_of_space_never_part_points_of_one_place(n_parts):
    """As partitioners/bisection.cpp; boxes find all parts that a point in them has."""
    mesh = block(12, 10, 8)
    points, weights = mesh.points, np.random.default_rng(3).uniform(0.5, 1.5, len(mesh.points))
    cuts = SpaceCuts(points, weights, n_parts)
    np.testing.assert_array_equal(cuts.locate(points), cuts.part)
    axis, place, _ = cuts.levels[0] if cuts.levels else ([0], [np.inf], None)
    if n_parts > 1:
        wanted = n_parts // 2 / n_parts * weights.sum()
        off = [min(abs(weights[points[:, d] <= at].sum() - wanted) for at in np.unique(points[:, d])) for d in range(3)]
        assert abs(weights[points[:, axis[0]] <= place[0]].sum() - wanted) == pytest.approx(off[axis[0]])
        # The longest edge, or the least error where that of the longest edge is not little.
        little = max(0.1 / n_parts, 0.01) * weights.sum()
        assert axis[0] == (0 if off[0] <= little else np.argmin(off) if min(off) > little else axis[0])
    box, part = cuts.parts_of_boxes(points - 1.5, points + 1.5)
    found = set(zip(box.tolist(), part.tolist()))
    for k in range(0, len(points), 37):
        assert {p for b, p in found if b == k} == ranks_near(cuts, points[[k]], 1.5, n_parts)


def test_a_flat_surface_is_cut_within_its_plane():
    """All but one of the points lie on one wide plate; cuts across its thickness would not divide it."""
    x, y = np.meshgrid(np.arange(32.0), np.arange(32.0))
    plate = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    cuts = SpaceCuts(np.vstack([plate, [[0.0, 0.0, 200.0]]]), np.ones(len(plate) + 1), 16)
    work = np.bincount(cuts.part, minlength=16)
    assert work.max() <= 1.1 * work.mean()


def test_boxes_of_contact_are_kept_while_they_are_good():
    mesh, scene = two_blocks(6)
    first = contact_space(mesh, scene, 8, None)
    work = np.bincount(first.cuts.part, minlength=8)
    assert first.best == pytest.approx(work.max() / work.mean()), "nobody knows of candidates before the first search"
    moved = Mesh(mesh.cells, mesh.points * [1.0, 1.0, 1.001])
    kept = contact_space(moved, scene, 8, first)
    uneven = np.bincount(first.cuts.locate(moved.points[scene.slaves]), weights=slave_work(scene), minlength=8)
    assert (kept.cuts is first.cuts) == (uneven.max() / uneven.mean() <= 1.15 * first.best)
    squashed = Mesh(mesh.cells, mesh.points * [0.01, 0.01, 0.01])
    assert contact_space(squashed, scene, 8, first).cuts is not first.cuts


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
