"""Meshes and contact for the tests of predictions: a block of cells that another block slides over."""

import numpy as np

from virtual_ranks import ContactScene, Mesh


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
    scene = ContactScene(slaves, facets, pair_slave, pair_facet, np.full(len(slaves), 5.0e-7),
                         np.where(touching, 8.0e-7, 5.0e-8))
    return mesh, scene


def uneven_seconds(mesh, seed=1):
    """Times of elements [s] that differ: some materials cost more, and those in one corner yield."""
    chance = np.random.default_rng(seed).uniform(0.9, 1.1, len(mesh.cells))
    return 3.0e-7 * chance * np.where(mesh.centres()[:, 0] < mesh.points[:, 0].mean(), 1.4, 1.0)
