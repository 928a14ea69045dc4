"""Bodies of wedges, pyramids and tetrahedra, which are hexahedra with corners that coincide: mass, free motion,
pressure, bars that bounce, contact both ways, erosion, the same bits on any ranks, and cells of VTK."""

import json
import math
import subprocess

import h5py
import numpy as np
import pytest
from mixed_meshes import MixedBlock, all_kinds, write_msh

RHO, SHEAR, BULK = 7800.0, 80e9, 160e9
STEEL = {"density": RHO, "strength": {"type": "elastic", "shear_modulus": SHEAR},
         "eos": {"type": "linear", "bulk_modulus": BULK}}
KINDS = ["wedges", "pyramids", "tetrahedra"]
CONTACTS = {
    "slide_surface": {"type": "slide_surface", "slave": "hammer", "master": "anvil", "symmetric": True},
    "eroding_surface": {"type": "eroding_surface"},
}


def of_one_kind(kind):
    return lambda i, j, k: kind


def part(path, block=None, velocity=(0, 0, 0), **rest):
    mesh = {"type": "file", "file": str(path), "unit": "mm"} | ({"block": block} if block else {})
    return {"material": "steel", "mesh": mesh, "velocity": list(velocity), **rest}


def model(parts, end, **rest):
    return {"title": "collapsed cells", "time": {"end": end}, "materials": {"steel": STEEL}, "parts": parts, **rest}


@pytest.fixture(scope="module")
def mixed(tmp_path_factory):
    """3 x 3 x 3 mm of all kinds; its surface by name, and the top."""
    folder = tmp_path_factory.mktemp("mixed")
    block = MixedBlock((3, 3, 3), all_kinds)
    write_msh(folder / "mixed.msh", {"body": block}, {"top": faces_at(block, 2, 3.0)})
    return folder / "mixed.msh", block


def faces_at(block, axis, place):
    """Faces of cells in a plane, as lists of three or four nodes; enough that all nodes are in some."""
    on = np.abs(block.points[:, axis] - place) < 1e-9
    faces = [[n for n in cell if on[n]] for cell in block.cells]
    return [f if len(f) == 4 else f[:3] for f in faces if len(f) >= 3]


def test_masses_and_volumes_are_exact(kerf, mixed):
    path, block = mixed
    assert block.volumes().sum() == pytest.approx(27.0, rel=1e-14)
    run = kerf(model({"body": part(path, velocity=(30, 20, -10))}, "0.2 us",
                     output={"precision": "double", "node_fields": ["mass"]}))
    of_body = run.summary["parts"]["body"]
    assert of_body["elements"] == len(block.cells)
    assert of_body["mass"] == pytest.approx(RHO * 27e-9, rel=1e-14)
    # A corner gets an eighth; where corners coincide, the node gets the shares of all of them.
    expected = np.zeros(len(block.points))
    shares = {8: [1] * 8, 6: [1, 2, 1] * 2, 5: [1, 1, 1, 1, 4], 4: [1, 2, 1, 4]}
    for cell, volume in zip(block.cells, block.volumes(), strict=True):
        if len(cell) in (5, 8):  # of wedges and tetrahedra it depends on the order which node counts twice
            np.add.at(expected, cell, RHO * 1e-9 * volume / 8 * np.array(shares[len(cell)]))
    with h5py.File(run.folder / "results.vtkhdf") as file:
        mass = file["VTKHDF/PointData/mass"][: len(block.points)]
    assert mass.sum() == pytest.approx(RHO * 27e-9, rel=1e-14)
    assert (mass >= expected * (1 - 1e-12)).all()


def test_free_flight_gives_no_forces(kerf, mixed):
    run = kerf(model({"body": part(mixed[0], velocity=(300, 200, -100))}, "20 us"))
    energy, momentum = run.summary["energy"], run.summary["momentum"]
    assert abs(energy["internal"]) + abs(energy["hourglass"]) < 1e-18 * energy["kinetic"]
    assert momentum["final"] == pytest.approx(momentum["initial"], rel=1e-13)


def test_a_spinning_body_keeps_its_energy(kerf, mixed):
    spin = 2000.0
    run = kerf(model({"body": part(mixed[0])}, 2 * math.pi / spin / 4, boundaries=[
        {"type": "initial_velocity", "nodes": "body", "angular_velocity": [spin, 0, 0],
         "point": [1.5e-3, 1.5e-3, 1.5e-3]}]))
    energy = run.summary["energy"]
    # The strain of the centrifugal force is of the order rho (omega L/2)^2 / E = 3e-7.
    assert energy["kinetic"] == pytest.approx(energy["initial"], rel=1e-5)
    assert abs(energy["balance_error"]) < 1e-6


def test_pressure_pushes_with_the_area_of_triangles_and_quadrilaterals(kerf, mixed):
    pressure, end, step = 1e5, 1e-6, 1e-8
    run = kerf(model({"body": part(mixed[0])}, end, sets={"top": {"face": "top"}},
                     loads=[{"type": "pressure", "facets": "top", "pressure": pressure}]),
               f"time.maximum_step={step}")
    final = np.array(run.summary["momentum"]["final"])
    steps = np.diff(run.history["time"])
    assert run.summary["cycles"] <= 101 and steps.max() <= step * 1.001
    # Forces act from the end of the first step on. The face stretches by p / K, 6e-7, at most.
    first = run.history["time"][1]
    assert final[2] == pytest.approx(-pressure * 9e-6 * (end - 0.5 * first), rel=1e-5)
    assert np.abs(final[:2]).max() < 1e-5 * abs(final[2])


def test_pressure_all_round_moves_nothing(kerf, mixed):
    run = kerf(model({"body": part(mixed[0])}, "1 us",
                     loads=[{"type": "pressure", "facets": "body", "pressure": "10 MPa"}]))
    assert np.abs(run.summary["momentum"]["final"]).max() < 1e-11 * 10e6 * 9e-6 * 1e-6
    # A cell that is pressed as the others has no forces on inner nodes: the balance tells that all is conserved.
    assert abs(run.summary["energy"]["balance_error"]) < 1e-2


@pytest.mark.parametrize("kind", KINDS)
def test_an_elastic_bar_bounces_off_a_wall(kerf, tmp_path, kind):
    """2 x 2 x 10 mm, at the default safety factor: the energy balance holds, and the bar leaves as bricks do."""
    write_msh(tmp_path / "bar.msh", {"bar": MixedBlock((2, 2, 10), of_one_kind(kind))})
    run = kerf(model({"bar": part(tmp_path / "bar.msh", velocity=(0, 0, -20))}, "8 us",
                     boundaries=[{"type": "rigid_wall", "normal": [0, 0, 1], "point": [0, 0, 0]}]))
    energy = run.summary["energy"]
    print(kind, "balance error", energy["balance_error"], "speed", run.summary["parts"]["bar"]["velocity"],
          "hourglass", energy["hourglass"] / energy["initial"])
    assert abs(energy["balance_error"]) < 2e-3
    assert energy["hourglass"] < 0.02 * energy["initial"]
    # A bar of bricks of the same size leaves with 18.06 m/s: the rest vibrates.
    assert run.summary["parts"]["bar"]["velocity"][2] == pytest.approx(18.06, rel=0.04)


@pytest.mark.parametrize("contact", list(CONTACTS))
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("hits", [True, False])
def test_a_body_hits_a_plate_of_bricks_and_the_other_way_round(kerf, tmp_path, contact, kind, hits):
    """A turned cube of cut cells strikes a plate of bricks off its centre, or a cube of bricks a plate of cut cells."""
    cut, bricks = of_one_kind(kind), of_one_kind("brick")
    write_msh(tmp_path / "bodies.msh", {
        "hammer": MixedBlock((4, 4, 4), cut if hits else bricks, origin=(-2, -2, -2)),
        "anvil": MixedBlock((7, 7, 4), bricks if hits else cut, edge=8 / 7, origin=(-4, -4, -4 * 8 / 7))})
    hammer = part(tmp_path / "bodies.msh", "hammer", (40, 10, -100),
                  placement=[{"angle": "20 deg", "axis": [1, 2, 0.5], "translate": [1e-3, 0.5e-3, 3.1e-3]}])
    run = kerf(model({"hammer": hammer, "anvil": part(tmp_path / "bodies.msh", "anvil")}, "40 us",
                     contacts=[CONTACTS[contact]]))
    momentum, energy = run.summary["momentum"], run.summary["energy"]
    scale = np.linalg.norm(momentum["initial"])
    parts = run.summary["parts"]
    print(contact, kind, "balance error", energy["balance_error"], "let go", run.summary["contact_let_go"]["nodes"])
    assert np.abs(np.array(momentum["final"]) - momentum["initial"]).max() < 1e-13 * scale
    assert abs(energy["balance_error"]) < 5e-3
    assert run.summary["contact_let_go"]["nodes"] == 0
    assert parts["hammer"]["velocity"][2] - parts["anvil"]["velocity"][2] > 5.0


@pytest.fixture(scope="module")
def penetration(tmp_path_factory):
    """A rod of all kinds breaks through a plate of all kinds, whose cells erode."""
    path = tmp_path_factory.mktemp("eroding") / "bodies.msh"
    write_msh(path, {"rod": MixedBlock((3, 3, 6), all_kinds, edge=0.8, origin=(-1.2, -1.2, 0.02)),
                     "plate": MixedBlock((9, 9, 3), lambda i, j, k: all_kinds(i % 3, j % 3, k),
                                         origin=(-4.5, -4.5, -3))})
    copper = {"density": 8930, "strength": {"type": "elastic_plastic", "shear_modulus": "43 GPa",
                                            "yield_stress": "200 MPa", "hardening_modulus": "100 MPa"},
              "eos": {"type": "linear", "bulk_modulus": "130 GPa"},
              "erosion": {"criteria": [{"type": "plastic_strain", "limit": 0.6}, {"type": "inversion"}]}}
    return model({"rod": part(path, "rod", (0, 0, -900)), "plate": part(path, "plate")}, "6 us",
                 contacts=[{"type": "eroding_surface"}]) | {"materials": {"steel": copper}}


@pytest.fixture(scope="module")
def eroded(kerf, penetration):
    return kerf(penetration)


def test_cells_of_all_kinds_erode(eroded):
    assert eroded.summary["eroded"]["elements"] > 50
    momentum = eroded.summary["momentum"]
    assert abs(eroded.summary["energy"]["balance_error"]) < 0.02
    whole = np.array(momentum["final"]) + np.array(momentum["eroded"])
    assert whole == pytest.approx(momentum["initial"], abs=1e-12 * np.linalg.norm(momentum["initial"]))


@pytest.mark.parametrize("ranks", [2, 3, 5])
def test_erosion_has_the_same_bits_on_any_ranks(kerf, penetration, eroded, ranks):
    assert kerf(penetration, ranks=ranks).summary["state_hash"] == eroded.summary["state_hash"]


def test_erosion_has_the_same_bits_after_a_restart_on_other_ranks(kerf, penetration):
    settings = "output.restart_interval=2 us"
    whole = kerf(penetration, settings)
    cycles = whole.summary["cycles"]
    stopped = kerf(penetration, settings, f"time.maximum_cycles={int(0.7 * cycles)}", completes=False)
    resumed = kerf(penetration, settings, ranks=3, resumes=stopped)
    assert resumed.summary["state_hash"] == whole.summary["state_hash"]


def test_results_have_the_cells_that_the_mesh_has(kerf, mixed):
    vtk_io = pytest.importorskip("vtkmodules.vtkIOHDF")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
    from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter

    path, block = mixed
    for ranks in (1, 3):
        run = kerf(model({"body": part(path)}, "0.05 us", output={"precision": "double"}), ranks=ranks)
        reader = vtk_io.vtkHDFReader()
        reader.SetFileName(str(run.folder / "results.vtkhdf"))
        reader.Update()
        grid = reader.GetOutput()
        types = [grid.GetCellType(c) for c in range(grid.GetNumberOfCells())]
        assert types == [{8: 12, 6: 13, 5: 14, 4: 10}[len(c)] for c in block.cells]
        sizes = vtkCellSizeFilter()
        sizes.SetInputData(grid)
        sizes.Update()
        volumes = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume"))
        # The order of a wedge is that of vtkWedge, whose first triangle looks outward. Verdict, which measures here,
        # has it the other way round.
        volumes = np.where(np.array(types) == 13, -volumes, volumes)
        assert volumes == pytest.approx(1e-9 * block.volumes(), rel=1e-9)
        # A picture shows the outside, and nothing that lies between cells.
        surface = vtkGeometryFilter()
        surface.SetInputData(grid)
        surface.Update()
        area = vtkCellSizeFilter()
        area.SetInputData(surface.GetOutput())
        area.Update()
        areas = vtk_to_numpy(area.GetOutput().GetCellData().GetArray("Area"))
        assert areas.sum() == pytest.approx(6 * 9e-6, rel=1e-9)


def test_other_coincidences_are_refused_by_name(binary, tmp_path):
    block = MixedBlock((1, 1, 1), of_one_kind("brick"))
    block.cells[0][7] = block.cells[0][6]  # one edge
    write_msh(tmp_path / "edge.msh", {"body": block})
    (tmp_path / "case.yaml").write_text(json.dumps(model({"body": part(tmp_path / "edge.msh")}, "1 us")))
    done = subprocess.run([str(binary), "check", "case.yaml"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2
    assert "element 1 of" in done.stdout + done.stderr
    assert "coincide in another way than those of a wedge" in done.stdout + done.stderr
