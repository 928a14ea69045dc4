"""Recursive coordinate bisection of points with weights, all parts of a level at once.

`Cuts` may part points of equal coordinates. `SpaceCuts` is what partitioners/bisection.cpp does: space alone decides.
"""

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
        low, high = self._boxes(points, group, n)
        axis = np.argmax(high - low, axis=1)
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
    def _boxes(points, group, n):
        """Lower and upper corners of the boxes round the points of each group; zeros where there are none."""
        low, high = np.full((n, 3), np.inf), np.full((n, 3), -np.inf)
        np.minimum.at(low, group, points)
        np.maximum.at(high, group, points)
        empty = ~np.isfinite(low[:, 0])
        low[empty], high[empty] = 0.0, 0.0
        return low, high

    def locate(self, points) -> np.ndarray:
        """The part whose box holds each point."""
        points = np.asarray(points, dtype=float).reshape(-1, 3)
        group = np.zeros(len(points), dtype=np.int64)
        for axis, place, first_child in self.levels:
            along = points[np.arange(len(points)), axis[group]]
            group = first_child[group] + (along > place[group])
        return group

    def parts_of_boxes(self, low, high) -> tuple[np.ndarray, np.ndarray]:
        """All pairs of a box and a part that it touches: numbers of boxes, and parts."""
        box, group = np.arange(len(low)), np.zeros(len(low), dtype=np.int64)
        for axis, place, first_child in self.levels:
            below = low[box, axis[group]] <= place[group]
            above = high[box, axis[group]] > place[group]
            child = first_child[group]
            box = np.concatenate([box[below], box[above]])
            group = np.concatenate([child[below], child[above] + 1])
        return box, group


class SpaceCuts(Cuts):
    """Cuts across the longest edge of the box round the points of each region, where that leaves little on the wrong
    side; otherwise across the axis that leaves least. Two points that are as good as side by side are not parted.

    As partitioners/bisection.cpp: a cut finds its place among `bins` slices of the box.
    """
    bins = 4096

    def _cut(self, points, weights, group, sizes):
        n = len(sizes)
        cut, lower = sizes > 1, sizes // 2
        first_child = np.cumsum(1 + cut) - (1 + cut)
        low, high = self._boxes(points, group, n)
        total = np.bincount(group, weights=weights, minlength=n)
        places, errors = np.empty((3, n)), np.empty((3, n))
        for d in range(3):
            places[d], errors[d] = self._places(points[:, d], weights, group, low[:, d], (high - low)[:, d],
                                                lower / sizes)
        fair = errors <= np.maximum(0.1 / sizes, 0.01) * total
        axis = np.where(fair.any(axis=0), np.argmax(np.where(fair, (high - low).T, -1.0), axis=0),
                        np.argmin(errors, axis=0))
        place = np.where(cut, places[axis, np.arange(n)], np.inf)
        self.levels.append((axis, place, first_child))
        children = np.repeat(np.arange(n), 1 + cut)
        upper = np.zeros(len(children), dtype=bool)
        upper[first_child[cut] + 1] = True
        first = cut[children] & ~upper
        new_sizes = np.where(upper, (sizes - lower)[children], np.where(first, lower[children], sizes[children]))
        return first_child[group] + (points[np.arange(len(points)), axis[group]] > place[group]), new_sizes

    def _places(self, along, weights, group, start, edge, share) -> tuple[np.ndarray, np.ndarray]:
        """Where each region would be cut across one axis, and the weight that is then on the wrong side."""
        n = len(start)
        width = edge / self.bins
        bin_of = np.clip((along - start[group]) / np.maximum(width[group], 1e-300), 0, self.bins - 1).astype(np.int64)
        key, run = np.unique(group * self.bins + bin_of, return_inverse=True)
        inside = np.bincount(run, weights=weights, minlength=len(key))
        g = key // self.bins
        total = np.bincount(g, weights=inside, minlength=n)
        reached = np.cumsum(inside) - (np.cumsum(total) - total)[g]  # at the end of each slice that has points
        target = (share * total)[g]
        enough = np.flatnonzero(reached >= target * (1.0 - 1e-12))
        chosen = np.full(n, len(key), dtype=np.int64)
        np.minimum.at(chosen, g[enough], enough)
        place, error = start + 0.5 * edge, np.zeros(n)  # of a region without points
        some = np.flatnonzero(chosen < len(key))
        k = chosen[some]
        taken = target[k] - (reached - inside)[k] >= 0.5 * inside[k]
        slice_of = key[k] % self.bins
        place[some] = np.where(taken, start[some] + (slice_of + 1) * width[some],
                               np.nextafter(start[some] + slice_of * width[some], -np.inf))
        error[some] = np.abs(np.where(taken, reached[k], (reached - inside)[k]) - target[k])
        return place, error
