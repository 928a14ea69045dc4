"""The material library from outside: list, describe, runs with sets, overrides, and what a run says about them."""
import json
import os
import re
import subprocess
from pathlib import Path

import pytest
import yaml

SOURCE = Path(__file__).resolve().parents[2]
KERF = os.environ.get("KERF_BINARY", str(SOURCE / "build" / "bin" / "kerf"))
FILES = sorted((SOURCE / "physics" / "library").glob("*.yaml"))
SETS = {name: value for file in FILES for name, value in yaml.safe_load(file.read_text()).items() if name != "family"}

ONE_ELEMENT = """time: {{end: 1e-9, maximum_cycles: {cycles}}}
materials:
  m:
{material}
parts:
  p:
    material: m
    mesh: {{type: block, size: 1 1 1 mm, cells: [1, 1, 1]}}
    velocity: 10 20 30 m/s
"""


def kerf(*arguments, **environment):
    return subprocess.run([KERF, *map(str, arguments)], capture_output=True, text=True, timeout=120,
                          env=os.environ | environment)


def indented(material):
    text = material if isinstance(material, str) else yaml.safe_dump(material, sort_keys=False)
    return "".join("    " + line + "\n" for line in text.rstrip().splitlines())


def run(folder, material, *arguments, cycles=1, name="case", **environment):
    """Runs one element of a material; returns the process and, where there is one, the summary."""
    path = folder / f"{name}.yaml"
    path.write_text(ONE_ELEMENT.format(material=indented(material), cycles=cycles))
    process = kerf("run", path, "--output", folder / name, *arguments, **environment)
    summary = folder / name / "summary.json"
    return process, json.loads(summary.read_text()) if summary.exists() else None


def use_of(name):
    """How an input uses a set, with what the set suggests and what it leaves to the user."""
    entry = SETS[name]
    return {"library": name} | entry.get("to_give", {}) | {block: "suggested" for block in entry.get("suggested", {})}


def test_list_has_every_set():
    text = kerf("list", "library").stdout
    for name, entry in SETS.items():
        line = next(line for line in text.splitlines() if line.split()[:1] == [name])
        assert entry["description"] in line
        assert ("not verified" in line) != entry["verified"]
        laws = [block["type"] for block in entry["material"].values() if isinstance(block, dict)]
        assert " + ".join(laws) in line


def test_describe_shows_numbers_with_their_sources():
    text = kerf("describe", "copper_ofhc_johnson_cook").stdout
    assert text == kerf("describe", "library", "copper_ofhc_johnson_cook").stdout
    assert re.search(r"strength\.A +90 MPa +\[1\] +yield stress at the reference rate", text)
    assert re.search(r"eos\.c0 +3940 m/s +\[2\] +shock velocity", text)
    for part in ("not verified", "Johnson and W.H. Cook", "Uintah", "johnson_cook.yaml:5:1", "library: copper_ofhc"):
        assert part in text
    assert "| `strength.A` | 90 MPa | [1] |" in kerf("describe", "--markdown", "copper_ofhc_johnson_cook").stdout


def test_describe_of_an_unknown_set_names_near_ones():
    process = kerf("describe", "library", "coper_ofhc_johnson_cook")
    assert process.returncode == 1 and "did you mean `copper_ofhc_johnson_cook`" in process.stderr
    process = kerf("describe", "coper_ofhc_johnson_cook")
    assert process.returncode == 1 and "did you mean `copper_ofhc_johnson_cook`" in process.stderr


@pytest.mark.parametrize("name", SETS)
def test_every_set_runs_one_step(tmp_path, name):
    process, summary = run(tmp_path, use_of(name))
    assert process.returncode == 0, process.stderr
    assert summary["cycles"] == 1 and summary["exit"] == "completed"
    used = summary["library"]["m"]
    assert used["set"] == name and used["verified"] == SETS[name]["verified"]
    assert re.fullmatch("[0-9a-f]{16}", used["hash"]) and used["file"].endswith(".yaml")


@pytest.mark.parametrize("name", ["copper_ofhc_johnson_cook", "alumina_johnson_holmquist_2", "tnt_jwl"])
def test_a_set_and_its_blocks_written_out_give_the_same_bits(tmp_path, name):
    _, from_library = run(tmp_path, use_of(name), cycles=20, name="library")
    entry = SETS[name]
    written = entry["material"] | entry.get("suggested", {})
    if "to_give" in entry:
        written["eos"] = written["eos"] | entry["to_give"]["eos"]
    _, written_out = run(tmp_path, written, cycles=20, name="written")
    assert from_library["state_hash"] == written_out["state_hash"] != ""
    assert from_library["energy"] == written_out["energy"] and written_out["library"] == {}
    # What the run itself has kept is an input of its own.
    kept = yaml.safe_load((tmp_path / "library" / "materials.yaml").read_text())["materials"]["m"]
    _, from_kept = run(tmp_path, kept, cycles=20, name="kept")
    assert from_kept["state_hash"] == from_library["state_hash"]
    assert not (tmp_path / "written" / "materials.yaml").exists()


def test_overrides_replace_single_keys(tmp_path):
    material = {"library": "copper_ofhc_johnson_cook", "strength": {"A": "400 MPa"}}
    _, summary = run(tmp_path, material)
    assert summary["library"]["m"]["overridden"] == ["strength.A"]
    kept = yaml.safe_load((tmp_path / "case" / "materials.yaml").read_text())["materials"]["m"]
    assert kept["strength"]["A"] == "400 MPa" and kept["strength"]["B"] == "292 MPa" and "library" not in kept
    _, summary = run(tmp_path, {"library": "copper_ofhc_johnson_cook"}, "--set", "materials.m.strength.A=400 MPa",
                     name="set")
    assert yaml.safe_load((tmp_path / "set" / "materials.yaml").read_text())["materials"]["m"] == kept


def test_mistakes_name_the_file_that_holds_them(tmp_path):
    process, _ = run(tmp_path, "library: copper_ofhc_johnson_cook\nstrength: {A: -4 MPa}")
    assert process.returncode == 2
    assert "case.yaml:5:19: error: `A` = -4000000 Pa is out of range" in process.stderr
    own = tmp_path / "own"
    own.mkdir()
    (own / "mine.yaml").write_text("mine:\n  description: d\n  citation: c\n  verified: no\n  provenance: {}\n"
                                   "  material: {density: -1}\n")
    process, _ = run(tmp_path, "library: mine", KERF_LIBRARY=str(own))
    assert process.returncode == 2 and f"{own}/mine.yaml:6:23: error: `density` = -1 kg/m3" in process.stderr


def test_unknown_names_are_refused(tmp_path):
    process, _ = run(tmp_path, {"library": "coper_ofhc_johnson_cook"})
    assert process.returncode == 2
    assert 'case.yaml:4:14: error: there is no set "coper_ofhc_johnson_cook"' in process.stderr
    assert "did you mean `copper_ofhc_johnson_cook`" in process.stderr


def test_parameters_may_name_a_set(tmp_path):
    process, summary = run(tmp_path, "library: $metal", "--set", "parameters.metal=steel_4340_johnson_cook")
    assert process.returncode == 0 and summary["library"]["m"]["set"] == "steel_4340_johnson_cook"
    process, _ = run(tmp_path, "library: $metal")
    errors = [line for line in process.stderr.splitlines() if ": error: " in line]
    assert process.returncode == 2 and len(errors) == 1 and 'there is no parameter "metal"' in errors[0]


def test_unverified_sets_are_warnings_everywhere(tmp_path):
    process, summary = run(tmp_path, use_of("copper_ofhc_johnson_cook"))
    warning = "warning: the set `copper_ofhc_johnson_cook` of the material library is not verified"
    assert warning in process.stderr
    assert any(warning in line for line in summary["warnings"])
    assert warning in kerf("check", tmp_path / "case.yaml").stderr
    process, summary = run(tmp_path, use_of("alumina_johnson_holmquist_2"), name="verified")
    assert "not verified" not in process.stderr and not any("not verified" in line for line in summary["warnings"])


def test_folders_of_ones_own(tmp_path):
    (tmp_path / "own").mkdir()
    entry = {"description": "d", "citation": "c", "verified": False, "provenance": {"density": "measured"},
             "material": SETS["steel_rod_elastic_plastic"]["material"]}
    text = yaml.safe_dump({"mine": entry}).replace("verified: false", "verified: no")
    (tmp_path / "own" / "mine.yaml").write_text(text)
    process, summary = run(tmp_path, "library: mine", KERF_LIBRARY=str(tmp_path / "own"))
    assert process.returncode == 0 and summary["library"]["m"]["file"] == str(tmp_path / "own" / "mine.yaml")
    assert "mine" in kerf("list", "library", KERF_LIBRARY=str(tmp_path / "own")).stdout
    path = tmp_path / "case.yaml"
    path.write_text("library: own\n" + path.read_text())
    assert kerf("check", path).returncode == 0
    process = kerf("check", path, KERF_LIBRARY=str(tmp_path / "absent"))
    assert process.returncode == 2 and "the folder of a material library cannot be read" in process.stderr


def test_ranks_and_resumed_runs_use_the_same_set(tmp_path):
    material = use_of("steel_4340_johnson_cook")
    text = ONE_ELEMENT.format(material=indented(material), cycles=10).replace("[1, 1, 1]", "[4, 1, 1]")
    path = tmp_path / "case.yaml"
    path.write_text(text)
    assert kerf("run", path, "--output", tmp_path / "one").returncode == 0
    assert kerf("run", path, "--output", tmp_path / "two", "--ranks", 2).returncode == 0
    one, two = (json.loads((tmp_path / name / "summary.json").read_text()) for name in ("one", "two"))
    assert one["state_hash"] == two["state_hash"] and one["library"] == two["library"]
    kerf("run", path, "--output", tmp_path / "rest", "--set", "time.maximum_cycles=4")
    process = kerf("run", path, "--output", tmp_path / "rest", "--resume")
    assert process.returncode == 0, process.stderr
    rest = json.loads((tmp_path / "rest" / "summary.json").read_text())
    assert rest["state_hash"] == one["state_hash"] and rest["library"] == one["library"]
    changed = kerf("run", path, "--output", tmp_path / "rest", "--resume", "--set", "materials.m.strength.A=1 GPa")
    assert changed.returncode != 0


def test_schema_takes_sets():
    jsonschema = pytest.importorskip("jsonschema")
    validator = jsonschema.Draft202012Validator(json.loads(kerf("schema").stdout))

    def errors(material):
        return list(validator.iter_errors(
            yaml.safe_load(ONE_ELEMENT.format(material=indented(material), cycles=1))))

    assert not errors(use_of("copper_ofhc_johnson_cook"))
    assert not errors({"library": "copper_ofhc_johnson_cook", "strength": {"A": "400 MPa"}, "density": "8 g/cm3"})
    assert not errors(SETS["copper_ofhc_johnson_cook"]["material"])
    assert errors({"library": "copper_ofhc_johnson_cook", "stren": {}})
    assert errors({"strength": {"type": "hydrodynamic"}, "eos": {"type": "linear", "bulk_modulus": "1 GPa"}})
