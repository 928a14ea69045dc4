"""`kerf test-plugin`: good plugins pass it, and every check finds the type that breaks its promise."""

import re

import pytest

from plugin_case import HERE, KERF, SOURCE, build, call

CONTRACTS = HERE / "wrong_laws"
# What needs no runs of whole models, which take a second each.
QUICK = ["documentation", "sample", "ranges", "lanes", "finite", "objectivity", "rotated_path", "convergence",
         "single_precision", "energy", "moduli", "restart", "hidden_state", "mesh", "vectorised"]


def rows_of(text):
    """(outcome, sentence) by type and check."""
    rows, name = {}, ""
    for line in text.splitlines():
        if re.fullmatch(r"[a-z]+\.[a-z0-9_]+", line):
            name = line
        elif found := re.fullmatch(r"  (\w+) +(pass|FAIL|note)  (.*)", line):
            rows.setdefault(name, {})[found[1]] = found[2], found[3]
    return rows


def verdicts(library, samples, *options):
    """Rows and exit code of the command."""
    done = call(KERF, "test-plugin", library, "--samples", samples, *options)
    assert done.returncode in (0, 1), done.stderr
    rows = rows_of(done.stdout)
    assert (done.returncode == 1) == any(o == "FAIL" for r in rows.values() for o, _ in r.values()), done.stdout
    return rows


def failures(rows):
    return {check: sentence for check, (outcome, sentence) in rows.items() if outcome == "FAIL"}


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    return build(HERE / "out_of_tree", tmp_path_factory.mktemp("good"), "swift_material.so")


@pytest.fixture(scope="module")
def wrong(tmp_path_factory):
    return build(CONTRACTS, tmp_path_factory.mktemp("wrong"), "wrong_laws.so")


@pytest.fixture(scope="module")
def quick(wrong):
    """All quick checks of all wrong types."""
    checks = [word for check in QUICK for word in ("--check", check)]
    return (verdicts(wrong, CONTRACTS / "samples.yaml", *checks)
            | verdicts(wrong.with_name("wrong_parts.so"), CONTRACTS / "parts.yaml", *checks))


# ---- good ones

def test_the_plugin_of_the_documentation_passes_every_check(good):
    rows = verdicts(good, HERE / "out_of_tree" / "samples.yaml")
    assert list(rows) == ["material.swift"] and not failures(rows["material.swift"])
    assert {"documentation", "sample", "ranges", "lanes", "finite", "objectivity", "rotated_path", "convergence",
            "single_precision", "energy", "moduli", "restart", "hidden_state", "cost", "vectorised", "migration",
            "run_restart"} == set(rows["material.swift"])


@pytest.mark.parametrize("name", ["fastest_node", "spring_to_point"])
def test_an_observer_passes_with_an_input_of_its_own(good, name):
    rows = verdicts(good.with_name(name + ".so"), HERE / "out_of_tree" / "samples.yaml")[f"observer.{name}"]
    assert not failures(rows) and {"documentation", "migration", "run_restart"} == set(rows)


def test_an_element_and_its_mesh_pass(tmp_path):
    library = build(HERE / "wedge", tmp_path / "build", "wedge.so")
    rows = verdicts(library, HERE / "wedge" / "samples.yaml")
    assert not failures(rows["element.wedge"]) and "migration" in rows["element.wedge"]
    assert rows["mesh.wedge_block"]["mesh"][0] == "pass"


@pytest.mark.parametrize("kind", ["material", "eos", "solid", "erosion", "mesh", "element", "partitioner",
                                  "balance_policy"])
def test_the_plugin_to_start_from_passes(kind, tmp_path):
    """What `kerf new-plugin` makes, with the samples that it makes; kinds without an input, which takes its time."""
    done = call(KERF, "new-plugin", kind, "first_try", "--output", tmp_path)
    assert done.returncode == 0, done.stderr
    folder = tmp_path / "first_try"
    library = build(folder, folder / "build", "first_try.so")
    rows = verdicts(library, folder / "tests" / "samples.yaml")
    assert rows and not any(failures(r) for r in rows.values()), {name: failures(r) for name, r in rows.items()}


# ---- one promise broken each

FOUND = {
    "material.no_text": {"documentation": "the text of the parameter `factor` is empty; mend it in describe()"},
    "material.odd_unit": {"documentation": "the text of the parameter `Stiffness` is unfinished; the parameter "
                          "`Stiffness` is not in snake_case; the unit \"Pascals per dog\""},
    "material.bad_default": {"sample": "`factor` = 2 is out of range; expected from 0 to 1"},
    "material.wide_range": {"ranges": "no finite numbers with `divisor` = 0, which the declared range allows"},
    "material.lane_dependent": {"lanes": "what a point becomes depends on its lane or on its neighbours (deviator: "},
    "material.not_finite": {"finite": "guard divisions, roots and logarithms"},
    "material.fixed_direction": {"objectivity": "use no direction that is fixed in space",
                                 "rotated_path": "the law prefers a direction in space"},
    "material.unrotated": {"objectivity": "keep tensors as SymTensor, which the element rotates",
                           "rotated_path": "the law prefers a direction in space"},
    "material.counts_steps": {"convergence": "`calls` converges with order 0.0"},
    "material.first_order": {"convergence": "converges with order 1.0"},
    "material.makes_energy": {"energy": "the law makes energy; unload with the moduli of loading"},
    "material.lying_modulus": {"moduli": "the tangent in stretch without change of pressure is 1.067e+11 Pa, but the "
                               "law returns moduli that make it 8.533e+10 Pa"},
    "material.negative_modulus": {"moduli": "shear modulus -1 Pa"},
    "eos.eos_makes_energy": {"energy": "the law makes energy"},
    "eos.lying_eos": {"moduli": "the tangent in compression is 1.6"},
    "solid.lying_solid": {"moduli": "the tangent in stretch along an axis is 2.667e+11 Pa"},
    "material.counts_objects": {"restart": "declare everything that the law remembers in its State",
                                "hidden_state": "no static, no mutable members"},
    "material.remembers": {"lanes": "keep nothing from one call to the next",
                           "restart": "declare everything that the law remembers in its State",
                           "hidden_state": "no static, no mutable members"},
    "material.loses_digits": {"single_precision": "`strain_sum` differs by"},
    "material.knows_ranks": {},
    "erosion.along_x": {"objectivity": "a rotation by 2 rad during the path changes `greatest_stress`",
                        "rotated_path": "body and path turned by 1.1 rad change `greatest_stress`"},
    "material.no_sample": {"sample": "it has no sample; give its parameters in the file of --samples"},
    "material.right": {},
    "material.loops": {},
    "mesh.right_row": {},
    "mesh.inside_out": {"mesh": "element 0 has the volume -1e-09 m3 within its faces"},
    "mesh.beyond_the_end": {"mesh": "element 3 has node 16 of 16"},
    "mesh.lost_node": {"mesh": "node 20 is in no element"},
    "mesh.wrong_face": {"mesh": "its face \"x_min\" has 5 nodes, but its facets on the surface have 4"},
    "mesh.changes_its_mind": {"mesh": "two meshes of the same parameters differ"},
    "partitioner.all_to_one": {},
    "partitioner.nowhere": {},
    "observer.forgets": {},
    "observer.forgets_rows": {},
    "observer.knows_ranks": {},
}


def test_every_wrong_type_is_listed_here(quick):
    assert set(quick) == set(FOUND)


@pytest.mark.parametrize("name", FOUND)
def test_a_broken_promise_is_found_by_its_check_and_by_no_other(quick, name):
    found = failures(quick[name])
    assert set(found) == set(FOUND[name]), found
    for check, words in FOUND[name].items():
        assert words in found[check]


@pytest.mark.parametrize("name, library, expected", [
    ("material.right", "wrong_laws", {}),
    ("material.knows_ranks", "wrong_laws", {
        "migration": "and one on a single rank differ in state_hash",
        "run_restart": "a run that 2 ranks take up half-way from the restart file of 3"}),
    ("observer.forgets", "wrong_parts", {"run_restart": "differ in observers"}),
    ("observer.forgets_rows", "wrong_parts", {"run_restart": "differ in history.h5 (watch/steps)"}),
    ("observer.knows_ranks", "wrong_parts", {"migration": "differ in history.h5 (watch/ranks)",
                                             "run_restart": "differ in history.h5 (watch/ranks)"}),
    ("partitioner.all_to_one", "wrong_parts", {"balance": "3.00 times the mean work"}),
    ("partitioner.nowhere", "wrong_parts", {
        "migration": "the partitioner `nowhere` gives element 0 to part 99; expected a part from 0 to 1"}),
])
def test_what_only_runs_show(wrong, name, library, expected):
    samples = CONTRACTS / ("samples.yaml" if library == "wrong_laws" else "parts.yaml")
    rows = verdicts(wrong.with_name(library + ".so"), samples, "--only", name)
    found = failures(rows[name])
    assert set(found) == set(expected), found
    for check, words in expected.items():
        assert words in found[check]


def test_of_several_laws_in_runs_the_wrong_one_is_named(wrong, tmp_path):
    """All in one model first; where that differs, each alone."""
    samples = tmp_path / "samples.yaml"
    samples.write_text("material: {right: {}, knows_ranks: {}}\n")
    rows = verdicts(wrong, samples, "--check", "migration", "--only", "material")
    assert failures(rows["material.knows_ranks"]) and not failures(rows["material.right"])


def test_loops_are_reported_law_by_law(quick):
    assert quick["material.right"]["vectorised"] == ("note", "the loop over the points is vectorised")
    outcome, sentence = quick["material.loops"]["vectorised"]
    assert outcome == "note" and "the loop over the points is not vectorised: " in sentence
    assert "wrong_laws.cpp:" in sentence


def test_without_the_compilers_report_nothing_is_claimed(wrong, tmp_path):
    alone = tmp_path / "wrong_laws.so"
    alone.write_bytes(wrong.read_bytes())
    rows = verdicts(alone, CONTRACTS / "samples.yaml", "--check", "vectorised", "--only", "material.right")
    assert "not known: " in rows["material.right"]["vectorised"][1]


def test_a_stated_trait_is_taken_into_account(wrong, tmp_path):
    samples = tmp_path / "samples.yaml"
    samples.write_text("material:\n  lying_modulus: {conformance: {tangent_excess: 1.3}}\n"
                       "  fixed_direction: {conformance: {isotropic: false}}\n"
                       "  first_order: {}\n")
    checks = ["--check", "moduli", "--check", "rotated_path", "--check", "convergence"]
    rows = verdicts(wrong, samples, "--only", "material", *checks)
    assert rows["material.lying_modulus"]["moduli"][0] == "pass"
    assert "the stiffest is 1.25 times" in rows["material.lying_modulus"]["moduli"][1]
    assert rows["material.fixed_direction"]["rotated_path"][0] == "note"
    assert rows["material.first_order"]["convergence"][0] == "pass"


# ---- what is typed

@pytest.mark.parametrize("words, said", [
    ([], "expected either a library or --builtin"),
    (["nowhere.so"], "there is no such plugin file"),
    (["LIB", "--samples", "nowhere.yaml"], "nowhere.yaml: error: the samples cannot be read"),
    (["LIB", "--only", "material.rihgt"], "no such type is tested; expected KIND.NAME or KIND, for example "
     "material.right"),
    (["LIB", "--check", "lane"], "there is no such check; expected one of documentation"),
])
def test_mistakes_are_errors_of_the_input(wrong, words, said):
    done = call(KERF, "test-plugin", *(wrong if w == "LIB" else w for w in words))
    assert done.returncode == 2 and said in done.stderr, done.stderr


@pytest.mark.parametrize("text, said", [
    ("materials: {right: {}}",
     "samples.yaml:1:1: error: there is no kind of plugins called \"materials\"; did you mean material?"),
    ("material: {right: {conformance: {ordr: 2}}}",
     "samples.yaml:1:34: error: unknown key `ordr`; did you mean `order`?"),
    ("material: {right: 3}", "expected a map of its parameters"),
    ("inputs: {material: {right: {file: a.yaml}}}", "expected {input: FILE}"),
])
def test_mistakes_in_the_samples_have_their_place(wrong, tmp_path, text, said):
    samples = tmp_path / "samples.yaml"
    samples.write_text(text + "\n")
    done = call(KERF, "test-plugin", wrong, "--samples", samples)
    assert done.returncode == 2 and said in done.stderr, done.stderr
