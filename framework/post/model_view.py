"""Finds from the results how a model is best looked at: the way of the impact, the cut, and what to look at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from results import Results, node_array, points


@dataclass
class Viewpoint:
    """The impact direction, the cut plane and the box to look at; lengths in m."""

    impact: np.ndarray
    up: np.ndarray
    cut_normal: np.ndarray
    cut_origin: np.ndarray
    low: np.ndarray
    high: np.ndarray

    @property
    def cut_axes(self) -> tuple[np.ndarray, np.ndarray]:
        """Two directions in the cut plane, to the right and upwards, so that global axes stay upright.

        Upwards is z as far as it lies in the plane, or y where the plane is nearly normal to z. To the right is the
        side on which the largest component is positive; the plane is seen from that side from which this is so.
        """
        upwards = upright(self.cut_normal, [0.0, 1.0, 0.0])
        to_the_right = np.cross(self.cut_normal, upwards)
        if to_the_right[np.argmax(np.abs(to_the_right).round(6))] < 0.0:
            to_the_right = -to_the_right
        return to_the_right, upwards


def upright(sight: np.ndarray, otherwise) -> np.ndarray:
    """The direction normal to a line of sight that is nearest to z, or to `otherwise` where z runs along the sight."""
    sight = sight / np.linalg.norm(sight)
    axis = np.array([0.0, 0.0, 1.0]) if abs(sight[2]) < 0.8 else np.asarray(otherwise, dtype=float)
    axis = axis - sight * (sight @ axis)
    return axis / np.linalg.norm(axis)


def impact_direction(results: Results) -> np.ndarray:
    """The direction in which the faster nodes move at first; x where nothing moves."""
    velocity = node_array(results.whole_grid(0), "velocity")
    if velocity is None or velocity.ndim != 2 or len(velocity) == 0 or not np.all(np.isfinite(velocity)):
        return np.array([1.0, 0.0, 0.0])
    speed = np.linalg.norm(velocity, axis=1)
    if speed.max() <= 0.0:
        return np.array([1.0, 0.0, 0.0])
    mean = velocity[speed > 0.5 * speed.max()].mean(axis=0).astype(float)
    length = np.linalg.norm(mean)
    return mean / length if length > 0.0 else np.array([1.0, 0.0, 0.0])


def box_of(results: Results, grids) -> tuple[np.ndarray, np.ndarray]:
    """The box that holds the bodies of all `grids`, without the few pieces that fly far away."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for grid in grids:
        nodes = points(grid) if grid.GetNumberOfCells() else np.zeros((0, 3))
        if len(nodes):
            low = np.minimum(low, np.percentile(nodes, 0.5, axis=0))
            high = np.maximum(high, np.percentile(nodes, 99.5, axis=0))
    if not np.all(np.isfinite(low)):
        nodes = points(results.whole_grid(0))
        low, high = nodes.min(axis=0), nodes.max(axis=0)
    margin = 0.04 * np.linalg.norm(high - low)
    return low - margin, high + margin


def cut_plane(results: Results, impact: np.ndarray, normal=None, origin=None) -> tuple[np.ndarray, np.ndarray]:
    """The plane to cut along: as asked for, else y = 0, else the middle of the model."""
    if normal is None:
        normal = [0.0, 1.0, 0.0] if abs(impact[1]) < 0.8 else [0.0, 0.0, 1.0]
    normal = np.asarray(normal, dtype=float)
    normal = normal / np.linalg.norm(normal)
    nodes = points(results.whole_grid(0))
    distance = nodes @ normal
    low, high = distance.min(), distance.max()
    size = np.linalg.norm(nodes.max(axis=0) - nodes.min(axis=0))
    tiny = 1.0e-5 * size  # a plane that runs along element faces would show either both sides or none
    if origin is not None:
        at = float(np.asarray(origin, dtype=float) @ normal)
    else:
        at = 0.0 if low - tiny <= 0.0 <= high + tiny else 0.5 * (low + high)
    at = at - tiny if at > high - tiny else at + tiny
    return normal, normal * at


def find_viewpoint(results: Results, cut_normal=None, cut_origin=None) -> Viewpoint:
    impact = impact_direction(results)
    normal, origin = cut_plane(results, impact, cut_normal, cut_origin)
    up = np.array([0.0, 0.0, 1.0]) if abs(impact[2]) < 0.8 else np.array([1.0, 0.0, 0.0])
    low, high = box_of(results, (results.grid(frame) for frame in (len(results.times) // 2, len(results.times) - 1)))
    return Viewpoint(impact, up, normal, origin, low, high)
