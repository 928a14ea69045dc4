"""Parts whose meshes come from files: one state from every format and on any number of ranks, and all mistakes told."""

import json
import shutil

import h5py
import numpy as np
import pytest

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


def write(folder, file="bar_and_plate_v22.msh", model=MODEL, **changes):
    for path in MESHES.glob("*"):
        if path.is_file():
            shutil.copy(path, folder)
    text = model.format(file=file)
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
