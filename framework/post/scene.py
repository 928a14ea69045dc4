"""Draws the bodies in three dimensions off-screen and returns images; knows VTK's rendering, and nothing of runs."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass

import numpy as np

# Muted metals, told apart also by those who see colours differently.
PART_COLOURS = ["#7f96ad", "#c8803f", "#8f9e5b", "#a8607a", "#6b6f9c", "#c2ae5e", "#4f8f8b", "#9a7b66"]

_PROBE = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderWindow, vtkRenderer
window = vtkRenderWindow(); window.SetOffScreenRendering(1); window.SetSize(8, 8)
window.AddRenderer(vtkRenderer()); window.Render()
"""


def choose_window() -> str | None:
    """Picks a way of drawing without a screen that works on this machine; None where there is none.

    Each way is tried in a process of its own, because a missing driver may end the process that asks for it.
    """
    candidates = ["vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow"]
    if os.environ.get("DISPLAY"):
        candidates.append("vtkXOpenGLRenderWindow")
    given = os.environ.get("VTK_DEFAULT_OPENGL_WINDOW")
    for name in [given] if given else candidates:
        environment = dict(os.environ, VTK_DEFAULT_OPENGL_WINDOW=name)
        try:
            probe = subprocess.run([sys.executable, "-c", _PROBE], env=environment, capture_output=True, timeout=60)
        except subprocess.TimeoutExpired:
            continue
        if probe.returncode == 0:
            os.environ["VTK_DEFAULT_OPENGL_WINDOW"] = name
            return name
    return None


@dataclass
class Colouring:
    """How cells are coloured: by part (values are part numbers), or by a field within a range."""

    array: str
    low: float = 0.0
    high: float = 1.0
    by_part: bool = False
    map_name: str = "turbo"


def lookup_table(colouring: Colouring, n_parts: int):
    import matplotlib
    from matplotlib.colors import to_rgb
    from vtkmodules.vtkCommonCore import vtkLookupTable

    table = vtkLookupTable()
    if colouring.by_part:
        colours = [(*to_rgb(PART_COLOURS[i % len(PART_COLOURS)]), 1.0) for i in range(max(n_parts, 1))]
        table.SetTableRange(-0.5, len(colours) - 0.5)
    else:
        colours = matplotlib.colormaps[colouring.map_name](np.linspace(0.0, 1.0, 256))
        table.SetTableRange(colouring.low, colouring.high)
    table.SetNumberOfTableValues(len(colours))
    for i, colour in enumerate(colours):
        table.SetTableValue(i, *(float(c) for c in colour))
    table.Build()
    return table


def reflect(grid, axes: list[int]):
    """The grid together with its mirror images in the coordinate planes normal to `axes` (0, 1 or 2)."""
    from vtkmodules.vtkCommonTransforms import vtkTransform
    from vtkmodules.vtkFiltersCore import vtkAppendFilter
    from vtkmodules.vtkFiltersGeneral import vtkTransformFilter

    for axis in axes:
        transform = vtkTransform()
        transform.Scale(*(-1.0 if i == axis else 1.0 for i in range(3)))
        mirrored = vtkTransformFilter()
        mirrored.SetInputData(grid)
        mirrored.SetTransform(transform)
        both = vtkAppendFilter()
        both.AddInputData(grid)
        both.AddInputConnection(mirrored.GetOutputPort())
        both.Update()
        grid = both.GetOutput()
    return grid


def outer_surface(grid):
    from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter

    surface = vtkGeometryFilter()
    surface.SetInputData(grid)
    surface.Update()
    return surface.GetOutput()


def body_actor(surface, colouring: Colouring, n_parts: int):
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

    mapper = vtkPolyDataMapper()
    mapper.SetInputData(surface)
    mapper.SetScalarModeToUseCellFieldData()
    mapper.SelectColorArray(colouring.array)
    mapper.SetLookupTable(lookup_table(colouring, n_parts))
    mapper.UseLookupTableScalarRangeOn()
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetAmbient(0.25)
    look.SetDiffuse(0.75)
    look.SetSpecular(0.15)
    look.SetSpecularPower(20.0)
    look.SetInterpolationToFlat()
    if surface.GetNumberOfCells() < 60000:  # more lines than this would only blacken the picture
        look.EdgeVisibilityOn()
        look.SetEdgeColor(0.15, 0.15, 0.15)
        look.SetEdgeOpacity(0.25)
    return actor


def draw(grid, colouring: Colouring, n_parts: int, direction, up, low, high, pixels=1.1e6):
    """An image (rows, columns, 3) of the grid seen along `direction`, and the length of one pixel [m].

    The image has about `pixels` pixels and the shape of the box (low, high) as seen; the projection is parallel, so
    a scale bar holds everywhere.
    """
    # Loaded before anything is made: it replaces the abstract drawing classes by those that draw.
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkRenderingCore import vtkLightKit, vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter

    direction = np.asarray(direction, dtype=float) / np.linalg.norm(direction)
    right = np.cross(direction, up)
    right /= np.linalg.norm(right)
    true_up = np.cross(right, direction)
    half = 0.5 * (np.asarray(high) - np.asarray(low))
    half_width, half_height = np.abs(right) @ half, np.abs(true_up) @ half
    shape = float(np.clip(half_width / half_height, 0.6, 2.0))
    size = int(np.sqrt(pixels * shape)), int(np.sqrt(pixels / shape))
    scale = 1.04 * max(half_height, half_width * size[1] / size[0])

    renderer = vtkRenderer()
    renderer.SetBackground(1.0, 1.0, 1.0)
    surface = outer_surface(grid)
    if surface.GetNumberOfCells():
        renderer.AddActor(body_actor(surface, colouring, n_parts))
    vtkLightKit().AddLightsToRenderer(renderer)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(*size)
    window.AddRenderer(renderer)
    centre, distance = 0.5 * (np.asarray(low) + np.asarray(high)), 10.0 * np.linalg.norm(half)
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(*centre)
    camera.SetPosition(*(centre - direction * distance))
    camera.SetViewUp(*true_up)
    camera.SetParallelScale(scale)
    renderer.ResetCameraClippingRange()
    window.Render()
    grabber = vtkWindowToImageFilter()
    grabber.SetInput(window)
    grabber.ReadFrontBufferOff()
    grabber.Update()
    image = grabber.GetOutput()
    columns, rows, _ = image.GetDimensions()
    seen = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns, -1)[::-1, :, :3].copy()
    window.Finalize()
    return seen, 2.0 * scale / rows
