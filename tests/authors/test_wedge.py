"""An element of another shape, out of the tree: wedges and hexahedra meet in surface, contact, erosion and output."""

import shutil

import numpy as np
import pytest

from plugin_case import HERE, KERF, build, call, run

# A block of wedges flies into a plate of hexahedra; both erode.
CASE = """
title: a block of wedges against a plate of hexahedra
time: {end: 12 us}
materials:
  copper:
    density: 8930
    strength: {type: elastic_plastic, shear_modulus: 43.3e9, yield_stress: 4e8, hardening_modulus: 1e8}
    eos: {type: linear, bulk_modulus: 130e9}
    erosion: {criteria: [{type: plastic_strain, limit: 0.5}, {type: inversion}]}
parts:
  block:
    material: copper
    element: {type: wedge}
    mesh: {type: wedge_block, size: "[6, 6, 8] mm", origin: "[-3, -3, 0.05] mm", cells: [5, 5, 7]}
    velocity: 80 30 -600 m/s
  plate:
    material: copper
    mesh: {type: block, size: "[16, 16, 3] mm", origin: "[-8, -8, -3] mm", cells: [16, 16, 3]}
contacts: [{type: eroding_surface}]
measures:
  block: {type: residual_velocity, part: block}
  left: {type: residual_length, part: block, axis: [0, 0, 1]}
balance: {force_interval: 20}
output: {precision: double, results_interval: 6 us, restart_interval: 5 us, restart_at_end: false}
"""
N_WEDGES, N_HEXAHEDRA = 2 * 5 * 5 * 7, 16 * 16 * 3


@pytest.fixture(scope="module")
def plugin(tmp_path_factory):
    return build(HERE / "wedge", tmp_path_factory.mktemp("plugin"), "wedge.so")


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    path = tmp_path_factory.mktemp("case") / "wedges.yaml"
    path.write_text(CASE)
    return path


@pytest.fixture(scope="module")
def impact(plugin, case, tmp_path_factory):
    """Folder and summary of the impact on two ranks."""
    folder = tmp_path_factory.mktemp("impact") / "two"
    return folder, run(case, plugin, folder, "--ranks", 2)


def test_wedges_and_hexahedra_erode_and_the_balance_holds(impact):
    _, summary = impact
    assert summary["exit"] == "completed"
    eroded = summary["eroded"]["by_part"]
    assert 0 < eroded["block"] < N_WEDGES and 0 < eroded["plate"] < N_HEXAHEDRA
    energy, momentum = summary["energy"], summary["momentum"]
    # The bound of hexahedra alone in test_collisions.py.
    assert abs(energy["balance_error"]) < 5e-3
    assert 0.0 < energy["hourglass"] < 0.05 * energy["initial"]
    # Forces add up to nothing in whole quanta; what is left is round-off of sums over two thousand nodes.
    lost = np.array(momentum["final"]) + momentum["eroded"] - momentum["initial"]
    assert np.abs(lost).max() < 1e-12 * np.linalg.norm(momentum["initial"])


@pytest.mark.parametrize("ranks", [1, 3])
def test_bits_are_the_same_on_any_number_of_ranks(impact, plugin, case, tmp_path, ranks):
    assert run(case, plugin, tmp_path / "other", "--ranks", ranks)["state_hash"] == impact[1]["state_hash"]


def test_restart_changes_no_bit(impact, plugin, case):
    folder, summary = impact
    again = run(case, plugin, folder.parent / "two", "--ranks", 3, "--resume")
    assert again["ranks"] == 3 and again["state_hash"] == summary["state_hash"]


def test_results_open_in_vtk_with_cells_of_both_kinds(impact):
    vtk_io = pytest.importorskip("vtkmodules.vtkIOHDF")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    reader = vtk_io.vtkHDFReader()
    reader.SetFileName(str(impact[0] / "results.vtkhdf"))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == 3
    reader.SetStep(0)
    reader.Update()
    grid = reader.GetOutputDataObject(0)
    grid = grid.GetPartition(0) if grid.IsA("vtkPartitionedDataSet") else grid
    types = np.array([grid.GetCellType(i) for i in range(grid.GetNumberOfCells())])
    assert np.count_nonzero(types == 13) == N_WEDGES and np.count_nonzero(types == 12) == N_HEXAHEDRA
    points = vtk_to_numpy(grid.GetPoints().GetData())
    volume = 0.0
    for i in np.flatnonzero(types == 13):
        x = points[[grid.GetCell(i).GetPointId(k) for k in range(6)]]
        # VTK's first triangle points outward.
        each = -0.5 * np.dot(np.cross(x[1] - x[0], x[2] - x[0]), x[3] - x[0])
        assert each > 0.0
        volume += each
    # Positions are floats in VTK's reader or doubles in the file; eight digits are more than either error.
    assert volume == pytest.approx(6e-3 * 6e-3 * 8e-3, rel=1e-6)


@pytest.mark.parametrize("ranks", [1, 3])
def test_a_wave_keeps_its_energy(plugin, case, tmp_path, ranks):
    """Without erosion and plasticity: what the block loses in motion is elastic, or booked."""
    settings = ["materials.copper.erosion.criteria=[{type: inversion}]",
                "materials.copper.strength={type: elastic, shear_modulus: 43.3e9}", "parts.block.velocity=0 0 -50 m/s"]
    summary = run(case, plugin, tmp_path / "elastic", "--ranks", ranks, *(w for s in settings for w in ("--set", s)))
    assert abs(summary["energy"]["balance_error"]) < 2e-3


def test_a_mesh_of_another_shape_is_an_error_with_a_line(plugin, case):
    done = call(KERF, "check", case, "--plugin", plugin, "--set", "parts.block.element.type=hex8")
    assert done.returncode == 2
    assert "the mesh of part `block` is made of cells of the shape wedge" in done.stderr


def test_a_plane_element_is_an_error_with_a_line(case, tmp_path):
    source = tmp_path / "source"
    shutil.copytree(HERE / "wedge", source)
    law = (source / "wedge.cpp").read_text()
    assert law.count(".vtk_type = 13") == 1
    law = law.replace(".vtk_type = 13", ".dimension = Dimension::plane, .vtk_type = 13")
    (source / "wedge.cpp").write_text(law)
    done = call(KERF, "check", case, "--plugin", build(source, tmp_path / "build", "wedge.so"))
    assert done.returncode == 2
    line = next(i for i, text in enumerate(CASE.splitlines(), 1) if "element: {type: wedge}" in text)
    assert f"wedges.yaml:{line}:" in done.stderr
    assert "the element wedge is plane; expected an element of three dimensions" in done.stderr


def test_check_reports_mesh_and_overlap_of_wedges(plugin, case):
    done = call(KERF, "check", case, "--plugin", plugin)
    assert done.returncode == 0, done.stderr
    row = next(line for line in done.stdout.splitlines() if line.startswith("block"))
    assert str(N_WEDGES) in row
    done = call(KERF, "check", case, "--plugin", plugin, "--set", "parts.block.mesh.origin=[-3, -3, -0.4] mm")
    text = done.stdout + done.stderr
    assert "parts block and plate overlap" in text
    # 6 x 6 x 0.4 mm3
    assert "they share 1.44e-08 m3" in text
