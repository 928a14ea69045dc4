"""Meshes and contact for the tests of predictions: a block of cells that another block slides over."""

import sys
from pathlib import Path

import numpy as np

STUDIES = Path(__file__).resolve().parents[2] / "framework" / "studies"
sys.path.insert(0, str(STUDIES))

import cycle  # noqa: E402
from cuts import Cuts  # noqa: E402
from program import Program  # noqa: E402
from recording import Moment, Recording  # noqa: E402
from virtual_ranks import ContactScene, Mesh, share_out, share_out_contact  # noqa: E402


def block(n_x, n_y, n_z, corner=(0.0, 0.0, 0.0), first_node=0):
    """Cells of edge 1, in rows along x."""
    k, j, i = np.meshgrid(np.arange(n_z), np.arange(n_y), np.arange(n_x), indexing="ij")
    row, layer = n_x + 1, (n_x + 1) * (n_y + 1)
    base = first_node + (i + row * j + layer * k).ravel()
    lower = np.stack([base, base + 1, base + row + 1, base + row], axis=1)
    z, y, x = np.meshgrid(np.arange(n_z + 1), np.arange(n_y + 1), np.arange(n_x + 1), indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1) + np.asarray(corner)
    return Mesh(np.concatenate([lower, lower + layer], axis=1), points)


def two_blocks(n):
    """A block of n^3 cells, and one half as wide that stands on it. Where they meet, nodes look at facets."""
    below, width = block(n, n, n), n // 2
    above = block(width, width, n, corner=(0.25 * n + 0.3, 0.25 * n + 0.4, n + 0.01), first_node=len(below.points))
    mesh = Mesh(np.concatenate([below.cells, above.cells]), np.concatenate([below.points, above.points]))
    top = np.flatnonzero(below.points[:, 2] == n)
    foot = len(below.points) + np.flatnonzero(above.points[:, 2] == above.points[:, 2].min())
    facets = below.cells[-n * n:, 4:]
    # Every node of the foot sees the facets round the cell that it stands on.
    cell = np.floor(mesh.points[foot, :2]).astype(int)
    slave, facet = [], []
    for dx in (-1, 0, 1):
        for dy in (-1, 0, 1):
            x, y = cell[:, 0] + dx, cell[:, 1] + dy
            inside = (x >= 0) & (x < n) & (y >= 0) & (y < n)
            slave.append(np.flatnonzero(inside))
            facet.append((x + n * y)[inside])
    slaves = np.concatenate([foot, top])
    pair_slave, pair_facet = np.concatenate(slave), np.concatenate(facet)
    touching = np.bincount(pair_slave, minlength=len(slaves)) > 0
    below_it = pair_facet == (cell[:, 0] + n * cell[:, 1])[pair_slave]
    scene = ContactScene(slaves, facets, pair_slave, pair_facet, below_it, np.full(len(slaves), 5.0e-7),
                         np.where(touching, 8.0e-7, 5.0e-8))
    return mesh, scene


def uneven_seconds(mesh, seed=1):
    """Times of elements [s] that differ: some materials cost more, and those in one corner yield."""
    chance = np.random.default_rng(seed).uniform(0.9, 1.1, len(mesh.cells))
    return 3.0e-7 * chance * np.where(mesh.centres()[:, 0] < mesh.points[:, 0].mean(), 1.4, 1.0)


def sample_program(n, n_ranks, n_cycles, sizes=cycle.Sizes()):
    """Cycles of two blocks cut by coordinates. In every third some elements erode."""
    mesh, scene = two_blocks(n)
    ranks = share_out(mesh, Cuts(mesh.centres(), np.ones(len(mesh.cells)), n_ranks).part, n_ranks)
    share_out_contact(ranks, mesh, scene)
    program = Program(n_ranks)
    for k in range(n_cycles):
        work = cycle.CycleWork(uneven_seconds(mesh, k), scene)
        if k % 3 == 2:
            work.eroded = np.random.default_rng(k).choice(n**3, 20, replace=False)
            work.erosion_seconds = np.zeros(len(mesh.cells))
            work.erosion_seconds[work.eroded] = 2.0e-6
        cycle.add_cycle(program, ranks, mesh, work, sizes)
    return program


def sample_recording(n=12, n_moments=2):
    """In the second moment a corner of the lower block has died, and what is left of it costs more."""
    mesh, scene = two_blocks(n)
    moments = []
    for k in range(n_moments):
        alive = np.ones(len(mesh.cells), dtype=bool)
        centres = mesh.centres()
        alive[: n**3] = ~np.all(centres[: n**3] < n / 4.0 * k, axis=1)
        seconds = uneven_seconds(mesh, 7)[alive] * np.where(centres[alive, 1] < n / 2, 1.0 + k, 1.0)
        moments.append(Moment(100 * k, 100, Mesh(mesh.cells[alive], mesh.points), np.flatnonzero(alive), seconds,
                              time=1.0e-6 * k, contact=scene, n_searches=1.0, n_renewals=4.0, n_eroding=3.0,
                              eroded=np.arange(10), erosion_seconds=np.full(int(alive.sum()), 1.0e-9)))
    return Recording(moments, source="two blocks")
