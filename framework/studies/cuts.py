"""Recursive coordinate bisection of points with weights, all parts of a level at once."""

from __future__ import annotations

import numpy as np


class Cuts:
    """A tree of cuts across space; every leaf is the box of one part."""

    def __init__(self, points, weights, n_parts: int):
        """Cuts where the weight of the points is shared out in proportion to the parts on either side."""
        points = np.asarray(points, dtype=float).reshape(-1, 3)
        weights = np.asarray(weights, dtype=float)
        if len(weights) != len(points):
            raise ValueError(f"{len(weights)} weights for {len(points)} points; expected one for each")
        if n_parts < 1:
            raise ValueError(f"{n_parts} parts; expected at least 1")
        if not (np.all(weights >= 0.0) and np.all(np.isfinite(points))):
            raise ValueError("a weight is negative or a point is not finite; expected weights of at least 0")
        self.levels: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []  # axis, place, number of the lower child
        self.n_parts = n_parts
        sizes, group = np.array([n_parts]), np.zeros(len(points), dtype=np.int64)
        while np.any(sizes > 1):
            group, sizes = self._cut(points, weights, group, sizes)
        self.part = group

    def _cut(self, points, weights, group, sizes):
        n = len(sizes)
        cut = sizes > 1
        lower = sizes // 2
        first_child = np.cumsum(1 + cut) - (1 + cut)
        children = np.empty(n + int(cut.sum()), dtype=np.int64)
        children[first_child] = np.where(cut, lower, sizes)
        children[first_child[cut] + 1] = (sizes - lower)[cut]
        axis = self._longest_axis(points, group, n)
        along = points[np.arange(len(points)), axis[group]]
        order = np.lexsort((along, group))
        g, x, w = group[order], along[order], weights[order]
        starts = np.searchsorted(g, np.arange(n + 1))
        total = np.concatenate([[0.0], np.cumsum(w)])
        in_group = total[starts[1:]] - total[starts[:-1]]
        wanted = in_group * (lower / np.maximum(sizes, 1))
        # The middle of a point's weight decides, so that a point is not always on the same side of its cut.
        middle = total[:-1] + 0.5 * w - total[starts[:-1]][g]
        below = middle < wanted[g]
        below |= ~cut[g]
        n_below = np.bincount(g, weights=below, minlength=n).astype(np.int64)
        place = np.full(n, np.inf)
        some = cut & (starts[1:] > starts[:-1])
        last = starts[:-1] + np.maximum(n_below - 1, 0)
        after = np.minimum(starts[:-1] + n_below, np.maximum(starts[1:] - 1, 0))
        place[some] = 0.5 * (x[last[some]] + x[after[some]])
        self.levels.append((axis, place, first_child))
        new = np.empty_like(group)
        new[order] = first_child[g] + ~below
        return new, children

    @staticmethod
    def _longest_axis(points, group, n):
        extent = np.zeros((n, 3))
        for d in range(3):
            low, high = np.full(n, np.inf), np.full(n, -np.inf)
            np.minimum.at(low, group, points[:, d])
            np.maximum.at(high, group, points[:, d])
            extent[:, d] = high - low
        return np.argmax(np.where(np.isfinite(extent), extent, 0.0), axis=1)

    def locate(self, points) -> np.ndarray:
        """The part whose box holds each point."""
        points = np.asarray(points, dtype=float).reshape(-1, 3)
        group = np.zeros(len(points), dtype=np.int64)
        for axis, place, first_child in self.levels:
            along = points[np.arange(len(points)), axis[group]]
            group = first_child[group] + (along > place[group])
        return group
