"""The models that are measured: the copper Taylor bar and the oblique rod in several sizes."""

from __future__ import annotations

from runner import Case

# Cell sizes of inputs/taylor_bar [mm] and the elements they give.
BAR_CELLS = {"8 thousand": 0.5, "100 thousand": 0.23, "1 million": 0.105, "10 million": 0.0495}

# 42CrMo4, as DynELA's manual has it; the bar itself stays the same, so that only the law differs.
JOHNSON_COOK = ("{type: johnson_cook, shear_modulus: 79.577 GPa, A: 806 MPa, B: 614 MPa, n: 0.168, C: 0.0089, m: 1.1, "
                "specific_heat: 460, reference_temperature: 293.15 K, melting_temperature: 1813.15 K}")

# inputs/oblique_rod_full in three sizes: plate cell [mm]; core, ring and axial cells of the rod.
ROD_SIZES = {"11 thousand": (1.6, 2, 1, 48), "82 thousand": (0.8, 3, 2, 96), "654 thousand": (0.4, 6, 4, 192)}


def bar(name: str, size: str, cycles: int, *overrides: str, ranks: int = 1) -> Case:
    return Case(name, "taylor_bar/taylor_bar.yaml",
                (f"parts.bar.mesh.cell_size={BAR_CELLS[size]} mm", f"time.maximum_cycles={cycles}", *overrides), ranks)


def stiffness_bar(size: str, cycles: int) -> Case:
    return bar("bar_stiffness", size, cycles, "parts.bar.element={type: hex8, hourglass: stiffness}")


def johnson_cook_bar(size: str, cycles: int) -> Case:
    return bar("bar_johnson_cook", size, cycles, f"materials.copper.strength={JOHNSON_COOK}")


def rod(name: str, size: str, *overrides: str, ranks: int = 1) -> Case:
    plate, core, ring, axial = ROD_SIZES[size]
    mesh = (f"parts.plate.mesh.cell_size={plate} mm", f"parts.rod.mesh.core_cells={core}",
            f"parts.rod.mesh.ring_cells={ring}", f"parts.rod.mesh.axial_cells={axial}")
    return Case(name, "oblique_rod_full/oblique_rod_full.yaml", (*mesh, *overrides), ranks)


def rod_facets(size: str) -> int:
    """Exterior facets of both bodies at the start."""
    plate, core, ring, axial = ROD_SIZES[size]
    nx, ny, nz = (round(length / plate) for length in (76.8, 51.2, 9.6))
    section = 4 * core * core + 8 * core * ring
    return 2 * (nx * ny + ny * nz + nx * nz) + 2 * section + 8 * core * axial
