"""Parts whose meshes come from files: one state from every format and on any number of ranks, and all mistakes told."""

import csv
import json
import re
import shutil

import h5py
import numpy as np
import pytest
from scipy.io import netcdf_file
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

from input_case import SOURCE, kerf, on_ranks, summary_of

MESHES = SOURCE / "tests" / "data" / "meshes"
MODEL = """\
title: a bar on a plate, from a file
time: {{end: 4 us}}
materials:
  copper:
    density: 8930 kg/m3
    strength: {{type: elastic_plastic, shear_modulus: 43 GPa, yield_stress: 400 MPa, hardening_modulus: 100 MPa}}
    eos: {{type: linear, bulk_modulus: 130 GPa}}
parts:
  bar: {{material: copper, mesh: {{type: file, file: {file}, unit: mm, block: bar}}, velocity: 0 0 -200 m/s}}
  plate: {{material: copper, mesh: {{type: file, file: {file}, unit: mm, block: plate 12 x 12}}}}
sets:
  wall_x: {{face: symmetry x}}
  wall_y: {{face: symmetry y}}
  edge: {{parts: [plate], face: plate edge}}
boundaries:
  - {{type: fixed, nodes: edge}}
  - {{type: symmetry, nodes: wall_x, normal: 1 0 0}}
contacts: [{{type: eroding_surface}}]
"""


def write(folder, file="bar_and_plate_v22.msh", model=MODEL, face="", **changes):
    for path in MESHES.glob("*"):
        if path.is_file():
            shutil.copy(path, folder)
    text = model.format(file=file, face=face)
    for old, new in changes.items():
        text = text.replace(old, new)
    (folder / "case.yaml").write_text(text)


def run(folder, *words):
    done = kerf("run", "case.yaml", *words, cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return summary_of(folder / "results" / "case")


def test_the_three_files_of_gmsh_give_one_state(tmp_path):
    hashes = set()
    for name in ("bar_and_plate_v22.msh", "bar_and_plate_v41.msh", "bar_and_plate_v41_binary.msh"):
        folder = tmp_path / name
        folder.mkdir()
        write(folder, name)
        hashes.add(run(folder)["state_hash"])
    assert len(hashes) == 1


@pytest.mark.parametrize("ranks", [2, 3, 5])
def test_the_state_is_the_same_on_any_ranks(tmp_path, ranks):
    write(tmp_path)
    alone = run(tmp_path)
    assert run(tmp_path, *on_ranks(ranks))["state_hash"] == alone["state_hash"]
    assert alone["parts"]["bar"]["elements"] == 315 and alone["parts"]["plate"]["elements"] == 192
    # 248.466 and 432 mm3, the volumes that expected.json gives.
    assert alone["parts"]["bar"]["mass"] == pytest.approx(8930 * 248.4662832984199e-9, rel=1e-12)
    assert alone["parts"]["plate"]["mass"] == pytest.approx(8930 * 432e-9, rel=1e-12)


# ---- The ids of the file live on

def labels_of_file(name="bar_and_plate_v22.msh"):
    """Positions [m] by the file's number of the node, nodes by that of the element: Gmsh 2.2 is plain text."""
    lines = (MESHES / name).read_text().splitlines()
    at = lines.index("$Nodes")
    rows = [line.split() for line in lines[at + 2:at + 2 + int(lines[at + 1])]]
    nodes = {int(row[0]): tuple(1e-3 * float(x) for x in row[1:]) for row in rows}
    at = lines.index("$Elements")
    rows = [list(map(int, line.split())) for line in lines[at + 2:at + 2 + int(lines[at + 1])]]
    return nodes, {row[0]: row[3 + row[2]:] for row in rows if row[1] == 5}


def ids_in(folder):
    with h5py.File(folder / "results.vtkhdf") as file:
        root = file["VTKHDF"]
        n_nodes, n_cells = root["NumberOfPoints"][0], root["NumberOfCells"][0]
        return (root["PointData/node_id"][:], root["CellData/element_id"][:], root["Points"][:n_nodes],
                root["Connectivity"][:].reshape(n_cells, 8), root["CellData/part"][:], n_nodes, n_cells)


@pytest.mark.parametrize("ranks", [1, 2, 3])
def test_results_have_the_ids_of_the_file(tmp_path, ranks):
    write(tmp_path)
    # Parts that share nodes: ids of the model are not those of the file in another order only.
    words = ["--set", "output.precision=double", "--set", "time.maximum_cycles=2", "--set", "balance.force_interval=1"]
    run(tmp_path, *on_ranks(ranks), *words)
    node_ids, element_ids, points, cells, _, n_nodes, n_cells = ids_in(tmp_path / "results" / "case")
    nodes, elements = labels_of_file()
    assert len(node_ids) == n_nodes and len(element_ids) == n_cells == len(elements)
    assert sorted(element_ids) == sorted(elements) and len(set(node_ids)) == n_nodes
    for label, point in zip(node_ids, points):
        assert point == pytest.approx(nodes[label], abs=1e-15)
    for label, cell in zip(element_ids, cells):
        assert sorted(node_ids[cell]) == sorted(elements[label])


def test_paraview_reads_the_ids_in_all_frames(tmp_path):
    write(tmp_path)
    run(tmp_path)
    folder = tmp_path / "results" / "case"
    node_ids, element_ids, *_ = ids_in(folder)
    reader = vtkHDFReader()
    reader.SetFileName(str(folder / "results.vtkhdf"))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() > 2
    for step in range(reader.GetNumberOfSteps()):
        reader.SetStep(step)
        reader.Update()
        grid = reader.GetOutput()
        np.testing.assert_array_equal(vtk_to_numpy(grid.GetPointData().GetArray("node_id")), node_ids)
        np.testing.assert_array_equal(vtk_to_numpy(grid.GetCellData().GetArray("element_id")), element_ids)


ERODING = {"density: 8930 kg/m3": "density: 8930 kg/m3\n    erosion: {criteria: [{type: plastic_strain, "
                                  "limit: 0.05}]}", "0 0 -200 m/s": "0 0 -600 m/s"}


def eroded(folder):
    with open(folder / "results" / "case" / "erosion.csv", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("ranks", [1, 2, 3])
def test_erosion_csv_has_the_ids_of_the_file_after_moves_and_a_restart(tmp_path, ranks):
    write(tmp_path, **ERODING)
    words = [*on_ranks(ranks), "--set", "balance.force_interval=3"]
    run(tmp_path, *words, "--set", "time.end=3 us")
    before = len(eroded(tmp_path))
    run(tmp_path, *words, "--resume")
    rows = eroded(tmp_path)
    assert len(rows) > before > 0
    _, element_ids, _, _, parts, _, _ = ids_in(tmp_path / "results" / "case")
    for row in rows:
        assert int(row["element_id"]) == element_ids[int(row["element"])]
        assert row["part"] == ["bar", "plate"][parts[int(row["element"])]]
    assert any(row["element_id"] != row["element"] for row in rows)


def test_generated_meshes_have_the_numbers_of_the_model(tmp_path):
    """In one model with parts from a file, too: there, results have ids for all."""
    boxes = MODEL.replace("plate: {{material: copper, mesh: {{type: file, file: {file}, unit: mm, "
                          "block: plate 12 x 12}}}}",
                          "plate: {{material: copper, mesh: {{type: block, size: 12 12 3 mm, cells: [8, 8, 2], "
                          "origin: 0 0 -3 mm}}}}")
    boxes = boxes.replace("edge: {{parts: [plate], face: plate edge}}", "edge: {{parts: [plate], face: x_max}}")
    boxes = boxes.replace("{{face: symmetry", "{{parts: [bar], face: symmetry")
    assert boxes != MODEL
    write(tmp_path, model=boxes, **ERODING)
    run(tmp_path)
    node_ids, element_ids, _, _, parts, n_nodes, n_cells = ids_in(tmp_path / "results" / "case")
    np.testing.assert_array_equal(element_ids[parts == 1], np.arange(n_cells)[parts == 1])
    np.testing.assert_array_equal(node_ids[-9 * 9 * 3:], np.arange(n_nodes)[-9 * 9 * 3:])
    _, elements = labels_of_file()
    assert set(element_ids[parts == 0]) <= set(elements)


def test_messages_name_elements_and_nodes_by_the_file_on_any_ranks(tmp_path):
    """The same words on one, two and three ranks, and after a restart."""
    write(tmp_path)
    nodes, elements = labels_of_file()
    said = {}
    for name, settings, pattern, known in (
            ("step", ["time.minimum_step=1 us"], r"the stable time step of element (\d+) of part (?:bar|plate) is",
             elements),
            ("speed", ["checks.maximum_speed=201 m/s"], r": node (\d+) of part (?:bar|plate) moves at", nodes),
            ("energy", ["checks.energy_growth=1.0e-9"], r"is in element (\d+) of part (?:bar|plate)$", elements)):
        for ranks in (1, 2, 3):
            words = [word for setting in [*settings, "balance.force_interval=1"] for word in ("--set", setting)]
            done = kerf("run", "case.yaml", *on_ranks(ranks), *words, cwd=tmp_path)
            assert done.returncode == 3, done.stdout + done.stderr
            found = re.search(pattern, done.stderr.strip())
            assert found and int(found[1]) in known, done.stderr
            assert said.setdefault(name, done.stderr) == done.stderr


def test_a_node_behind_a_wall_is_named_by_the_file(tmp_path):
    write(tmp_path, **{"{type: fixed, nodes: edge}": "{type: rigid_wall, point: 0 0 -1 mm, normal: 0 0 1}"})
    nodes, _ = labels_of_file()
    lines = set()
    for ranks in (1, 2, 3):
        done = kerf("check", "case.yaml", *on_ranks(ranks), cwd=tmp_path)
        assert done.returncode == 2
        lines.add(done.stderr)
        found = re.search(r"node (\d+) of part plate at \((\S+), (\S+), (\S+)\) m starts (\S+) m behind the rigid wall",
                          done.stderr)
        assert [float(found[k]) for k in (2, 3, 4)] == pytest.approx(nodes[int(found[1])], rel=1e-5, abs=1e-12)
    assert len(lines) == 1


def test_elements_without_volume_are_named_by_the_file(tmp_path):
    write(tmp_path)
    text = (tmp_path / "bar_and_plate_v22.msh").read_text().splitlines()
    _, elements = labels_of_file()
    wrong = sorted(elements)[40]
    at = next(i for i, line in enumerate(text) if line.startswith(f"{wrong} 5 "))
    words = text[at].split()
    words[-8:] = words[-4:] + words[-8:-4]  # upside down
    text[at] = " ".join(words)
    (tmp_path / "bar_and_plate_v22.msh").write_text("\n".join(text) + "\n")
    for ranks in (1, 3):
        done = kerf("check", "case.yaml", *on_ranks(ranks), cwd=tmp_path)
        assert done.returncode == 2
        assert re.search(r"error: 1 of the \d+ elements of part \w+ has no volume or a corner turned inside out, the "
                         rf"first of them element {wrong}; change the file\n", done.stderr), done.stderr


def test_partitions_have_the_ids_of_the_file(tmp_path):
    write(tmp_path)
    done = kerf("partition", "case.yaml", "--parts", "2", "--method", "block", "--output", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    with h5py.File(tmp_path / "out" / "partitions.h5") as file:
        _, elements = labels_of_file()
        assert sorted(file["element_id"][:]) == sorted(elements)
    parts = "balance.partitioner={type: file, file: out/partitions.h5}"
    done = kerf("run", "case.yaml", "--ranks", "2", "--set", parts, "--set", "time.maximum_cycles=1", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


# ---- Kerf's own form

def own_form(folder, name, into="mesh.h5"):
    done = kerf("mesh", name, "--into", into, cwd=folder)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    return done.stdout


def test_kerf_mesh_shows_and_converts(tmp_path):
    write(tmp_path)
    said = own_form(tmp_path, "bar_and_plate_v22.msh")
    assert re.search(r'^format +Gmsh 2.2, text\nnodes +803\nelements +507\ndigest +[0-9a-f]{16}\n\n', said)
    assert re.search(r'^block +"bar" +315$', said, re.M) and re.search(r'^node set +".*" +\d+$|^face set', said, re.M)
    assert kerf("mesh", "mesh.h5", cwd=tmp_path).stdout == said.split("\nthe mesh is in")[0]
    nodes, elements = labels_of_file()
    with h5py.File(tmp_path / "mesh.h5") as file:  # any HDF5 library reads it
        assert file.attrs["kerf_mesh"] == 1 and file.attrs["digest"].decode() in said
        assert list(file["node_id"]) == list(nodes) and file["cells"].shape == (507, 8)
        np.testing.assert_array_equal(1e-3 * file["points"][:], list(nodes.values()))
        assert sorted(name.decode() for name in file["blocks/name"]) == ["bar", "plate 12 x 12"]
        assert file["blocks/first"][-1] == len(file["blocks/members"]) == len(elements)
        assert sorted(file["element_id"]) == sorted(elements)


@pytest.mark.parametrize("words, code, message", [
    (["absent.msh"], 2, "absent.msh: error: the file cannot be read; expected a mesh of Gmsh, Abaqus, Exodus or Kerf"),
    (["case.yaml"], 2, "case.yaml: error: neither the name nor the first bytes tell what this is; expected a mesh"),
    (["bar_and_plate_v22.msh", "--into", "mesh.exo"], 2, 'error: the mesh cannot be written to "mesh.exo"; expected'),
    (["bar_and_plate_v22.msh", "--into", "no/mesh.h5"], 1, 'error: cannot create "no/mesh.h5.part"')])
def test_kerf_mesh_tells_what_is_wrong(tmp_path, words, code, message):
    write(tmp_path)
    done = kerf("mesh", *words, cwd=tmp_path)
    assert done.returncode == code and done.stderr.startswith(message), done.stderr


@pytest.mark.parametrize("ranks", [1, 3])
def test_one_mesh_in_two_forms_restarts_alike(tmp_path, ranks):
    """Begun with text, gone on with Kerf's form under another name, ended with a binary file: the bits of one run."""
    write(tmp_path)
    text = (tmp_path / "case.yaml").read_text()
    own_form(tmp_path, "bar_and_plate_v22.msh")
    alone = run(tmp_path, *on_ranks(ranks))
    for path in (tmp_path / "results").rglob("*"):
        if path.is_file():
            path.unlink()
    end = ["--set", "time.maximum_cycles={}"]
    run(tmp_path, *on_ranks(ranks), end[0], end[1].format(7))
    (tmp_path / "case.yaml").write_text(text.replace("bar_and_plate_v22.msh", "mesh.h5"))
    run(tmp_path, *on_ranks(ranks), "--resume", end[0], end[1].format(14))
    (tmp_path / "case.yaml").write_text(text.replace("bar_and_plate_v22.msh", "bar_and_plate_v41_binary.msh"))
    assert run(tmp_path, *on_ranks(ranks), "--resume")["state_hash"] == alone["state_hash"]


def test_another_mesh_in_the_same_file_is_refused(tmp_path):
    write(tmp_path)
    run(tmp_path, "--set", "time.maximum_cycles=2")
    path = tmp_path / "bar_and_plate_v22.msh"
    lines = path.read_text().splitlines()
    at = lines.index("$Nodes") + 2
    words = lines[at + 700].split()
    lines[at + 700] = " ".join([*words[:3], repr(float(words[3]) + 1e-9)])
    path.write_text("\n".join(lines) + "\n")
    done = kerf("run", "case.yaml", "--resume", cwd=tmp_path)
    assert done.returncode == 2 and "this restart file belongs to another model" in done.stderr


def test_a_damaged_file_is_refused_with_its_name(tmp_path):
    write(tmp_path, "mesh.h5")
    own_form(tmp_path, "bar_and_plate_v22.msh")
    bytes_ = bytearray((tmp_path / "mesh.h5").read_bytes())
    bytes_[5000] ^= 4
    (tmp_path / "mesh.h5").write_bytes(bytes_)
    for ranks in (1, 2):
        done = kerf("check", "case.yaml", *on_ranks(ranks), cwd=tmp_path)
        assert done.returncode == 2
        assert re.match(r"mesh.h5: error: the file is damaged: bytes \d+ to \d+ do not fit their checksum; expected a "
                        r"mesh that Kerf has written\n", done.stderr), done.stderr


# ---- Names that mean several things

COLUMN = """\
title: a column of bricks
time: {{end: 0.1 us, safety_factor: 0.2}}
materials:
  copper:
    density: 8930 kg/m3
    strength: {{type: elastic, shear_modulus: 43 GPa}}
    eos: {{type: linear, bulk_modulus: 130 GPa}}
parts:
  column: {{material: copper, mesh: {{type: file, file: {file}, unit: mm}}, velocity: 0 0 -100 m/s}}
sets:
  held: {{face: "{face}"}}
boundaries:
  - {{type: fixed, nodes: held}}
"""
POINTS = [(x, y, z) for z in range(4) for y in (0, 1) for x in (0, 1)]
BRICKS = [[4 * k + corner for corner in (1, 2, 4, 3, 5, 6, 8, 7)] for k in range(3)]
TOP_FACE = (13, 14, 16, 15)


def abaqus_column(path, node_set, face_set):
    """A node set of two nodes at the bottom, and the face at the top."""
    lines = ["*NODE", *(f"{k + 1}, {x}, {y}, {z}" for k, (x, y, z) in enumerate(POINTS)), "*ELEMENT, TYPE=C3D8"]
    lines += [", ".join(map(str, [k + 1, *nodes])) for k, nodes in enumerate(BRICKS)]
    lines += [f"*NSET, NSET={node_set}", "1, 2", f"*SURFACE, NAME={face_set}", "3, S2"]
    path.write_text("\n".join(lines) + "\n")


def gmsh_column(path, volume, surface):
    """A physical volume of all bricks, whose nodes are a set, and the face at the top."""
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "2", f'2 7 "{surface}"', f'3 8 "{volume}"',
             "$EndPhysicalNames", "$Nodes", str(len(POINTS))]
    lines += [f"{k + 1} {x} {y} {z}" for k, (x, y, z) in enumerate(POINTS)]
    lines += ["$EndNodes", "$Elements", "4", "1 3 2 7 1 " + " ".join(map(str, TOP_FACE))]
    lines += [f"{k + 2} 5 2 8 1 " + " ".join(map(str, nodes)) for k, nodes in enumerate(BRICKS)]
    path.write_text("\n".join([*lines, "$EndElements"]) + "\n")


def exodus_column(path, node_set, face_set):
    """Sets without names, which are called by their numbers."""
    with netcdf_file(path, "w", version=2) as file:
        def put(name, values, *dimensions):
            for dimension, n in zip(dimensions, np.shape(values)):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, n)
            variable = file.createVariable(name, "d" if name.startswith("coord") else "i", dimensions)
            variable[:] = values
            return variable
        for axis, name in enumerate(("coordx", "coordy", "coordz")):
            put(name, [float(point[axis]) for point in POINTS], "num_nodes")
        put("eb_prop1", [1], "num_el_blk")
        put("connect1", BRICKS, "num_el_in_blk1", "num_nod_per_el1").elem_type = "HEX8"
        put("ns_prop1", [int(node_set)], "num_node_sets")
        put("node_ns1", [1, 2], "num_nod_ns1")
        put("ss_prop1", [int(face_set)], "num_side_sets")
        put("elem_ss1", [3], "num_side_ss1")
        put("side_ss1", [6], "num_side_ss1")


COLUMNS = {"exo": (exodus_column, "1", "2"), "inp": (abaqus_column, "TOP", "LOW"), "msh": (gmsh_column, "a b", "top")}


def check_face(folder, file, face, *words):
    (folder / "case.yaml").write_text(COLUMN.format(file=file, face=face))
    return kerf("check", "case.yaml", *words, cwd=folder)


@pytest.mark.parametrize("ending", COLUMNS)
def test_a_name_of_two_kinds_of_sets_is_an_error_and_each_kind_has_its_own(tmp_path, ending):
    make, name, other = COLUMNS[ending]
    make(tmp_path / f"one.{ending}", name, name)
    make(tmp_path / f"two.{ending}", name, other)
    for ranks in (1, 2):
        done = check_face(tmp_path, f"one.{ending}", name, *on_ranks(ranks))
        assert done.returncode == 2
        assert done.stderr == (f'case.yaml:11:16: error: the face "{name}" means more than one set in the mesh of part '
                               f"`column`; expected one of face_set:{name} and node_set:{name}\n")
    hashes = {}
    for file, face in (("one", f"node_set:{name}"), ("two", name), ("two", f"node_set:{name}"),
                       ("one", f"face_set:{name}"), ("two", other), ("two", f"face_set:{other}")):
        done = check_face(tmp_path, f"{file}.{ending}", face)
        assert done.returncode == 0, done.stderr
        hashes[file, face] = run(tmp_path)["state_hash"]
    assert hashes["one", f"node_set:{name}"] == hashes["two", name] == hashes["two", f"node_set:{name}"]
    assert hashes["one", f"face_set:{name}"] == hashes["two", other] == hashes["two", f"face_set:{other}"]
    assert hashes["two", name] != hashes["two", other]


@pytest.mark.parametrize("ending", COLUMNS)
def test_kerf_mesh_and_convert_name_both_sets(tmp_path, ending):
    make, name, other = COLUMNS[ending]
    make(tmp_path / f"one.{ending}", name, name)
    make(tmp_path / f"two.{ending}", name, other)
    said = kerf("mesh", f"one.{ending}", cwd=tmp_path).stdout
    assert re.search(rf'^node set +"{name}" +\d+  as "node_set:{name}"$', said, re.M), said
    assert re.search(rf'^face set +"{name}" +\d+  as "face_set:{name}"$', said, re.M), said
    assert " as " not in kerf("mesh", f"two.{ending}", cwd=tmp_path).stdout
    faces = {}
    for file in ("one", "two"):
        done = kerf("convert", f"{file}.{ending}", "--units", "mm", "--output", file, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        text = (tmp_path / file / "case.yaml").read_text()
        faces[file] = sorted(line.split("face: ")[1].strip("\"'}") for line in text.splitlines() if "face: " in line)
        words = re.findall(r"^  (\w+):", text[text.index("sets:"):], re.M)
        assert len(set(words)) == len(words) == len(faces[file])
        for face in faces[file]:
            assert check_face(tmp_path, f"{file}/mesh.h5", face).returncode == 0
    assert faces == {"one": [f"face_set:{name}", f"node_set:{name}"], "two": sorted([name, other])}


def test_messages_about_faces_do_not_name_a_set_twice(tmp_path):
    abaqus_column(tmp_path / "one.inp", "TOP", "TOP")
    abaqus_column(tmp_path / "two.inp", "TOP", "LOW")
    for file, names in (("one", "face_set:TOP and node_set:TOP"), ("two", "LOW and TOP")):
        done = check_face(tmp_path, f"{file}.inp", "elsewhere")
        assert done.returncode == 2 and done.stderr.endswith(
            f'the mesh of part `column` has no face "elsewhere"; its faces are {names}\n'), done.stderr


def test_two_blocks_of_one_name_are_chosen_by_number(tmp_path):
    gmsh_column(tmp_path / "column.msh", "a", "top")
    text = (tmp_path / "column.msh").read_text()
    text = text.replace("$PhysicalNames\n2\n", '$PhysicalNames\n3\n3 9 "a"\n').replace("4 5 2 8 1", "4 5 2 9 1")
    (tmp_path / "column.msh").write_text(text)

    def case(block):
        model = COLUMN.format(file="column.msh", face="a").replace("unit: mm", f'unit: mm, block: "{block}"')
        (tmp_path / "case.yaml").write_text(model)
        return kerf("check", "case.yaml", cwd=tmp_path)
    done = case("a")
    assert done.returncode == 2
    assert '"column.msh" has more than one block "a"; expected `block` to be "block:8" or "block:9"' in done.stderr
    assert '"column.msh" has no block "b"; expected `block` to be one of "block:8", "block:9"' in case("b").stderr
    for block, n in (("block:8", 2), ("block:9", 1)):
        assert re.search(rf"^column +{n} ", case(block).stdout, re.M)
    said = kerf("mesh", "column.msh", cwd=tmp_path).stdout
    assert re.search(r'^block +"a" +2  as "block:8"\nblock +"a" +1  as "block:9"$', said, re.M), said
    kerf("convert", "column.msh", "--units", "mm", "--output", "out", cwd=tmp_path)
    text = (tmp_path / "out" / "case.yaml").read_text()
    assert "block:8" in text and "block:9" in text


# ---- What is left out

def test_elements_that_are_left_out_are_told_once(tmp_path):
    write(tmp_path)
    path = tmp_path / "bar_and_plate_v22.msh"
    text = path.read_text()
    n = int(re.search(r"\$Elements\n(\d+)\n", text)[1])
    text = text.replace(f"$Elements\n{n}\n", f"$Elements\n{n + 3}\n900001 1 2 0 1 1 2\n900002 3 2 0 1 1 2 3 4\n"
                                             "900003 1 2 0 1 2 3\n")
    path.write_text(text)
    line = ("bar_and_plate_v22.msh: warning: 3 elements that are no solids are left out, by kind: "
            '2 "line", 1 "quadrangle"\n')
    for ranks in (1, 2):
        for command in ("check", "run"):
            done = kerf(command, "case.yaml", *on_ranks(ranks), "--set", "time.maximum_cycles=1", cwd=tmp_path)
            assert done.returncode == 0 and done.stderr.count("left out") == done.stderr.count(line) == 1, done.stderr
        assert summary_of(tmp_path / "results" / "case")["warnings"].count(line.strip()) == 1
        shutil.rmtree(tmp_path / "results")
    for words in (["mesh", path.name], ["convert", path.name, "--units", "mm", "--output", "out"]):
        assert kerf(*words, cwd=tmp_path).stderr == line
    # The form of Kerf's own remembers it.
    (tmp_path / "case.yaml").write_text((tmp_path / "case.yaml").read_text().replace(path.name, "out/mesh.h5"))
    assert kerf("check", "case.yaml", cwd=tmp_path).stderr == line.replace(path.name, "out/mesh.h5")


def test_warnings_of_readers_reach_the_run(tmp_path):
    """Sides of shells that a side set names."""
    model = COLUMN.replace("unit: mm", "unit: mm, block: brick")
    write(tmp_path, model=model, file="shapes_nc4.exo", face="bottom face")
    for words in (["check"], ["run", "--ranks", "1"]):
        done = kerf(words[0], "case.yaml", *words[1:], cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        for said in ('side set "around sheet" has 1 sides of elements that are no solids',
                     '1 element that is no solid is left out, by kind: 1 "SHELL4"'):
            assert done.stderr.count("shapes_nc4.exo: warning: " + said) == 1, done.stderr
    assert len(summary_of(tmp_path / "results" / "case")["warnings"]) >= 2
