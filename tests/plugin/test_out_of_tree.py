"""A plugin outside the tree: it builds against the package, loads, computes, and is refused where it does not fit."""

import json
import re
import shutil

import h5py
import numpy as np
import pytest

from plugin_case import HERE, KERF, build, call, compile_library, run

# A Taylor test: the bar flies against a rigid wall and is upset there.
CASE = """
title: a bar of Swift's material against a wall
time: {end: 30 us}
materials:
  metal:
    density: 7850 kg/m3
    strength:
      type: swift
      shear_modulus: 80 GPa
      strength_coefficient: 900 MPa
      initial_strain: 0.01
      hardening_exponent: 0.2
    eos: {type: linear, bulk_modulus: 160 GPa}
parts:
  bar:
    mesh: {type: block, size: "[20, 10, 10] mm", cells: [8, 4, 4]}
    material: metal
    velocity: "[-150, 0, 0] m/s"
boundaries:
  - {type: rigid_wall, point: "[0, 0, 0] m", normal: "[1, 0, 0]"}
output: {precision: double, results_interval: 5 us, element_fields: [von_mises, effective_plastic_strain]}
"""


@pytest.fixture(scope="module")
def plugin(tmp_path_factory):
    return build(HERE / "out_of_tree", tmp_path_factory.mktemp("plugin"), "swift_material.so")


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    path = tmp_path_factory.mktemp("case") / "taylor.yaml"
    path.write_text(CASE)
    return path


def test_list_shows_the_type_beside_the_built_in_ones(plugin):
    done = call(KERF, "list", "material", "--plugin", plugin)
    assert done.returncode == 0, done.stderr
    names = [line.split()[0] for line in done.stdout.splitlines() if line.startswith("  ")]
    assert "swift" in names and "johnson_cook" in names


def test_describe_shows_what_it_declares(plugin):
    done = call(KERF, "describe", "swift", "--plugin", plugin)
    assert done.returncode == 0, done.stderr
    for text in ("strength_coefficient: number in Pa", "effective_plastic_strain", "swift_material.cpp"):
        assert text in done.stdout


def test_stress_follows_the_law_of_the_plugin(plugin, case, tmp_path):
    summary = run(case, plugin, tmp_path / "one")
    assert summary["exit"] == "completed"
    with h5py.File(tmp_path / "one" / "results.vtkhdf") as file:
        cells = file["VTKHDF/CellData"]
        strain, stress = (np.ravel(cells[name]) for name in ("effective_plastic_strain", "von_mises"))
    assert strain.max() > 0.2
    over = stress / (900.0e6 * (0.01 + strain) ** 0.2) - 1.0
    # Newton's method stops at 1e-14 of the trial stress, which is at most a few times the flow stress.
    assert over.max() < 1e-11, "no stress may lie outside the yield surface"
    # Frames show waves, loading and unloading; what flows is on the surface: some of what has flowed is.
    assert np.count_nonzero(np.abs(over[strain > 0.0]) < 1e-11) > 20


def test_state_of_the_plugin_is_the_same_on_any_number_of_ranks(plugin, case, tmp_path):
    hashes = {n: run(case, plugin, tmp_path / f"ranks_{n}", "--ranks", n, "--set", "balance.force_interval=40")
              ["state_hash"] for n in (1, 2, 3)}
    assert len(set(hashes.values())) == 1, hashes


def test_pieces_in_a_folder_of_its_name_belong_to_a_plugin(plugin, case, tmp_path):
    source, pieces = tmp_path / "source", tmp_path / "source" / "swift_material"
    shutil.copytree(HERE / "out_of_tree", source)
    pieces.mkdir()
    (pieces / "texts.cpp").write_text('const char* modulus_text() { return "resistance to shear, from a piece"; }\n')
    law = (source / "swift_material.cpp").read_text()
    text = '"elastic shear modulus"'
    assert text in law
    law = law.replace(text, "modulus_text()").replace("namespace {", "const char* modulus_text();\n\nnamespace {", 1)
    (source / "swift_material.cpp").write_text(law)
    # Where the piece is missing, a name is unknown and the library is not loaded.
    library = build(source, tmp_path / "build", "swift_material.so")
    assert "from a piece" in call(KERF, "describe", "swift", "--plugin", library).stdout
    assert run(case, library, tmp_path / "two")["state_hash"] == run(case, plugin, tmp_path / "one")["state_hash"]


def test_in_single_precision_it_computes_in_double_precision_as_ever(plugin, case, tmp_path):
    settings = ("--set", "precision=single", "--set", "balance.force_interval=40")
    hashes = {n: run(case, plugin, tmp_path / f"ranks_{n}", "--ranks", n, *settings)["state_hash"] for n in (1, 3)}
    assert hashes[1] == hashes[3]
    run(case, plugin, tmp_path / "double")
    strain = {}
    for name in ("ranks_1", "double"):
        with h5py.File(tmp_path / name / "results.vtkhdf") as file:
            strain[name] = np.ravel(file["VTKHDF/CellData/effective_plastic_strain"])
    # Stress is rounded to 6e-8 of itself in a step; a run has some hundred steps.
    assert 0.0 < np.abs(strain["ranks_1"] - strain["double"]).max() < 1e-5 * strain["double"].max()


def test_a_built_in_criterion_reads_the_plugins_state(plugin, case, tmp_path):
    criterion = "materials.metal.erosion.criteria=[{type: plastic_strain, limit: 0.15}]"
    summary = run(case, plugin, tmp_path / "eroding", "--set", criterion)
    assert 0 < summary["eroded"]["by_criterion"]["plastic_strain"] <= 128


def test_a_rule_of_the_plugin_is_an_error_with_a_line(plugin, case):
    done = call(KERF, "check", case, "--plugin", plugin, "--set", "materials.metal.strength.shear_modulus=100 MPa")
    assert done.returncode == 2
    assert "`strength_coefficient`: the initial yield stress K e0^n must be less than the shear modulus" in done.stderr
    line = next(i for i, text in enumerate(CASE.splitlines(), 1) if "strength_coefficient" in text)
    assert f"taylor.yaml:{line}:" in done.stderr


def test_without_the_plugin_its_type_is_unknown(case):
    done = call(KERF, "check", case)
    assert done.returncode == 2
    assert 'there is no material of type "swift"' in done.stderr


def test_a_plugin_of_another_version_with_the_same_interface_loads(tmp_path):
    library = compile_library(HERE / "out_of_tree" / "swift_material.cpp", tmp_path / "old.so", "-UKERF_VERSION",
                              '-DKERF_VERSION="0.0.1"')
    done = call(KERF, "list", "--plugin", library)
    assert done.returncode == 0, done.stderr
    assert "swift" in done.stdout


def test_a_plugin_of_another_interface_is_refused_with_every_difference(tmp_path):
    here = json.loads((HERE.parent / "python" / "interface.json").read_text())["interface_version"]
    source = tmp_path / "foreign.cpp"
    source.write_text(f"#define FOREIGN \"{here + 1}\"\n" + """
#include <kerf/plugin.hpp>
extern "C" {
extern const char kerf_plugin_manifest_text[] =
    "interface=" FOREIGN "\\nkerf=9.9\\nflags=-ffast-math\\nlane_width=4\\n";
}
extern "C" __attribute__((visibility("default"))) void kerf_plugin_register(kerf::Registrar&) { __builtin_trap(); }
""")
    done = call(KERF, "list", "--plugin", compile_library(source, tmp_path / "foreign.so", "-fvisibility=default"))
    assert done.returncode == 2
    for text in (f"the interface version is {here + 1} in the plugin and {here} here",
                 "the lane width is 4 in the plugin and 8 here",
                 "Kerf's version is \"9.9\" in the plugin and"):
        assert text in done.stderr


def test_a_library_that_is_no_plugin_is_refused(tmp_path):
    source = tmp_path / "nothing.cpp"
    source.write_text("int nothing() { return 0; }\n")
    done = call(KERF, "list", "--plugin", compile_library(source, tmp_path / "nothing.so"))
    assert done.returncode == 2
    assert "is a shared library but no Kerf plugin" in done.stderr


def test_a_file_that_is_no_library_is_refused(case):
    done = call(KERF, "list", "--plugin", case)
    assert done.returncode == 2
    assert "is a file of another kind, not a shared library" in done.stderr


def test_a_missing_library_is_named(tmp_path):
    done = call(KERF, "list", "--plugin", tmp_path / "absent.so")
    assert done.returncode == 2
    assert "absent.so: error: there is no such plugin file" in done.stderr


def test_the_same_name_twice_names_both_origins(plugin, tmp_path):
    twin = tmp_path / "twin.cpp"
    twin.write_text((HERE / "out_of_tree" / "swift_material.cpp").read_text())
    library = compile_library(twin, tmp_path / "twin.so")
    done = call(KERF, "list", "--plugin", plugin, "--plugin", library)
    assert done.returncode == 2
    assert 'two plugins of kind material are called "swift"' in done.stderr
    assert "swift_material.cpp" in done.stderr and "twin.cpp" in done.stderr


CRITERION = """
#include <kerf/erosion.hpp>
struct Faulty final : kerf::PointwiseErosion<Faulty> {{
  {members}
  static void describe(kerf::Schema<Faulty>& s) {{
    describe_interval(s);
    {declared}
  }}
  kerf::Verdict judge_point(const kerf::ErosionInputPoint&, const Reads&, State&) const {{ return {{0.0, 0.0}}; }}
}};
KERF_EROSION(Faulty, "faulty", "a criterion with a fault")
"""
STATE = "struct State {{ {0} }}; struct Reads {{}};"
DECLARE = 's.state(&State::{0}, "{0}", "-", 0.0, "a variable");'


@pytest.mark.parametrize("members, declared, said", [
    (STATE.format("double a, b;"), DECLARE.format("a"), "takes 16 bytes, but describe() declares 1 doubles, 8 bytes"),
    (STATE.format("double a, b;"), DECLARE.format("b") + DECLARE.format("a"),
     "declares `b` in place 1, but it is double number 2 of its State"),
    (STATE.format("float f; double a;"), DECLARE.format("a"), "declares `a` in place 1, but it is double number 2"),
    (STATE.format("double a; float f;"), DECLARE.format("a"), "takes 16 bytes, but describe() declares 1 doubles"),
    ("struct State {}; struct Reads { double p, q; };", 's.reads(&Reads::p, "pressure", "read");',
     "its Reads takes 16"),
], ids=["not_declared", "out_of_order", "float_first", "float_last", "reads"])
def test_a_state_that_is_not_declared_as_it_is_is_refused(tmp_path, members, declared, said):
    source = tmp_path / "faulty.cpp"
    source.write_text(CRITERION.format(members=members, declared=declared))
    library = compile_library(source, tmp_path / "faulty.so")
    done = call(KERF, "list", "erosion", "--plugin", library)
    assert done.returncode == 2
    assert str(library) in done.stderr and "erosion faulty" in done.stderr and said in done.stderr


# ---- an observer

@pytest.fixture(scope="module")
def observer(plugin):
    return plugin.with_name("fastest_node.so")


@pytest.fixture(scope="module")
def observed(tmp_path_factory):
    """The bar of a built-in material, watched."""
    path = tmp_path_factory.mktemp("case") / "observed.yaml"
    law = CASE[CASE.index("      type: swift"):CASE.index("    eos:")]
    built_in = ("      {type: elastic_plastic, shear_modulus: 80 GPa, yield_stress: 350 MPa, "
                "hardening_modulus: 500 MPa}\n")
    path.write_text(CASE.replace(law, built_in) + "observers:\n  quick: {type: fastest_node}\n")
    return path


def table(folder):
    with h5py.File(folder / "history.h5") as file:
        return {name: data[()] for name, data in file["quick"].items()}


def test_columns_of_an_observer_are_the_same_on_any_number_of_ranks(observer, observed, tmp_path):
    summaries, tables = {}, {}
    for n in (1, 2, 3, 5):
        summaries[n] = run(observed, observer, tmp_path / str(n), "--ranks", n, "--set", "balance.force_interval=15")
        tables[n] = table(tmp_path / str(n))
    for n in (2, 3, 5):
        assert {k: v.tobytes() for k, v in tables[n].items()} == {k: v.tobytes() for k, v in tables[1].items()}
    numbers = summaries[1]["observers"]["quick"]
    assert numbers == summaries[5]["observers"]["quick"]
    assert numbers["forces_seen"] == summaries[1]["cycles"]  # every cycle, as it has asked for
    assert numbers["grown"] > 0
    assert tables[1]["speed"][0] == 150.0 and tables[1]["force"].max() > 0.0


def test_an_observer_goes_on_after_a_restart_with_the_same_bits(observer, observed, tmp_path):
    settings = ("--set", "output.restart_interval=12 us", "--set", "output.restart_at_end=false")
    whole = run(observed, observer, tmp_path / "out", *settings)
    before = table(tmp_path / "out")
    resumed = run(observed, observer, tmp_path / "out", "--resume", "--ranks", 2, *settings)
    after = table(tmp_path / "out")
    assert {k: v.tobytes() for k, v in after.items()} == {k: v.tobytes() for k, v in before.items()}
    assert resumed["observers"] == whole["observers"]


@pytest.mark.parametrize("ranks", [1, 3])
def test_an_observer_that_throws_on_one_rank_stops_all_with_its_name_and_place(observer, observed, tmp_path, ranks):
    done = call(KERF, "run", observed, "--plugin", observer, "--output", tmp_path / "out", "--ranks", ranks,
                "--set", "observers.quick.fail_at=10 us", cwd=tmp_path)
    assert done.returncode == 3, done.stdout + done.stderr
    assert re.search(r"the run stopped: the observer `quick` \(fastest_node, \S+observed.yaml:\d+:\d+\) failed in "
                     r"after_step: node 0 was not meant to get this far; at time 1\S+e-05 s, cycle \d+", done.stderr)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["exit"].startswith("the observer `quick`") and summary["end_time"] >= 10e-6
    times = table(tmp_path / "out")["time"]
    assert len(times) > 10 and times[-1] < 10e-6 + 0.5e-6


def test_ranks_that_come_to_different_collective_functions_are_told(tmp_path, observed):
    source = tmp_path / "astray.cpp"
    source.write_text("""
#include <kerf/observer.hpp>
struct Astray final : kerf::Observer {
  static void describe(kerf::Schema<Astray>&) {}
  std::vector<kerf::ObservedColumn> columns() const override { return {{"x", "-", "nothing"}}; }
  void sample(kerf::ObservedModel& model, std::span<double>) override {
    bool first = false;
    for (int i = 0; i < model.nodes.n; ++i) first |= model.nodes.owned[i] != 0 && model.nodes.id[i] == 0;
    if (first) model.greatest({1.0});
  }
};
KERF_OBSERVER(Astray, "astray", "calls a collective function on one rank only")
""")
    library = compile_library(source, tmp_path / "astray.so")
    words = (KERF, "run", observed, "--plugin", library, "--set", "observers.quick.type=astray")
    alone = call(*words, "--output", tmp_path / "one", cwd=tmp_path)
    assert alone.returncode == 0, alone.stderr
    done = call(*words, "--output", tmp_path / "two", "--ranks", 2, cwd=tmp_path)
    assert done.returncode == 3
    assert "some ranks have come to its end and others to greatest; collective functions have to be called by all " \
        "ranks alike" in done.stderr


@pytest.mark.parametrize("mistake, told", [
    ("ranks.sums_by_key({{0, -1, -1, -1}}, ranks.is_root() ? std::vector<std::int64_t>{} : "
     "std::vector<std::int64_t>{1})", "1 keys have 0 values; expected one for each"),
    ("ranks.visit_undeformed(ranks.is_root() ? 9 : 0, [](const MeasureRanks::UndeformedElement&) {})",
     "there is no part 9")])
def test_a_measure_that_asks_wrongly_on_one_rank_is_told_and_no_rank_waits(tmp_path, observed, mistake, told):
    source = tmp_path / "unfit.cpp"
    source.write_text(f"""
#include <kerf/measure.hpp>
using namespace kerf;
struct Unfit final : Measure {{
  static void describe(Schema<Unfit>&) {{}}
  std::vector<std::string> references() const override {{ return {{}}; }}
  MeasuredValues evaluate(const MeasureModel&, MeasureRanks& ranks) const override {{
    {mistake};
    return {{{{"", 1.0}}}};
  }}
}};
KERF_REGISTER(KERF_TYPE(Unfit, "measure", "unfit", "asks wrongly on rank 0"))
""")
    library = compile_library(source, tmp_path / "unfit.so")
    joined = observed.read_text().replace("boundaries:", """  more:
    mesh: {type: block, size: "[20, 10, 10] mm", origin: "0 0 10 mm", cells: [8, 4, 4]}
    material: metal
    velocity: "[-150, 0, 0] m/s"
joined: [{parts: [bar, more]}]
measures: {bad: {type: unfit}}
boundaries:""")
    case = tmp_path / "joined.yaml"
    case.write_text(joined[:joined.index("observers:")])
    # A rank that waited for the other would end the run after the stall limit, with another exit code.
    done = call(KERF, "run", case, "--plugin", library, "--ranks", 2, "--output", tmp_path / "out", "--set",
                "time.maximum_cycles=3", "--set", "checks.stall_limit=60 s", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["measures"]["bad"] is None
    assert f"measure bad (unfit) has failed: {told}" in summary["warnings"][-1]
