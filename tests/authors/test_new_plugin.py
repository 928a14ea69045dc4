"""`kerf new-plugin`: for every kind a folder that builds and passes its own tests as it stands, and refusals."""

import json
import re
import shutil
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor

import pytest
import yaml

from plugin_case import BUILD, KERF, SOURCE, cached, call

TEMPLATES = SOURCE / "framework" / "templates"
KINDS = sorted(folder.name for folder in TEMPLATES.iterdir() if folder.name != "common")
LAWS = ["eos", "erosion", "material", "solid"]
NAME = "fresh_start"


def make(kerf, kind, folder, name=NAME):
    """The new folder, and the three commands that the program says come next."""
    done = call(kerf, "new-plugin", kind, name, "--output", folder)
    assert done.returncode == 0, done.stderr
    commands = [line.split() for line in done.stdout.splitlines() if line.startswith("  c")]
    assert [words[0] for words in commands] == ["cmake", "cmake", "ctest"]
    # The compiler has to be Kerf's own.
    commands[0].append(f"-DCMAKE_CXX_COMPILER={cached('CMAKE_CXX_COMPILER')}")
    return folder / name, commands


def carry_out(commands):
    """What the commands print. Every one has to end well."""
    text = ""
    for words in commands:
        done = call(*words)
        text += done.stdout + done.stderr
        assert done.returncode == 0, text
    return text


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """By kind: folder, output of building and testing, and seconds; two kinds at a time."""

    def work(kind):
        begin = time.monotonic()
        folder, commands = make(KERF, kind, tmp_path_factory.mktemp(kind))
        try:
            text = carry_out(commands)
        except AssertionError as error:
            text = str(error)
        return folder, text, time.monotonic() - begin

    with ThreadPoolExecutor(max_workers=2) as pool:
        found = dict(zip(KINDS, pool.map(work, KINDS)))
    print("\nkind            lines  seconds")
    for kind, (folder, _, seconds) in found.items():
        print(f"{kind:14}  {len((folder / f'{NAME}.cpp').read_text().splitlines()):5}  {seconds:7.1f}")
    return found


def test_every_kind_of_plugin_has_a_template():
    done = call(KERF, "list")
    assert [line for line in done.stdout.splitlines() if line and not line.startswith(" ")] == KINDS


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_plugin_builds_and_passes_its_tests(made, kind):
    text = made[kind][1]
    passed = re.search(r"100% tests passed, 0 tests failed out of (\d+)", text)
    assert passed and int(passed.group(1)) == (6 if kind in LAWS else 5), text
    assert "warning" not in text and "Warning" not in text, text


@pytest.mark.parametrize("kind", KINDS)
def test_a_new_plugin_has_all_its_files_and_nothing_is_left_to_fill_in(made, kind):
    folder = made[kind][0]
    files = {str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file() and "build" not in p.parts}
    wanted = {"CMakeLists.txt", "README.md", ".gitignore", ".github/workflows/ci.yml", f"{NAME}.cpp", f"{NAME}.md",
              "case.yaml", "tests/samples.yaml", "tests/expected.json", "tests/check_page.cmake",
              "tests/run_case.cmake"}
    if kind in LAWS:
        wanted |= {"tests/point.yaml", "tests/point_reference.py"}
    assert wanted <= files
    for name in files:
        text = (folder / name).read_text()
        assert not re.search(r"@[A-Z_]+@", text), name
        assert "NAME" not in name
        if name.endswith((".yaml", ".yml")):
            assert isinstance(yaml.safe_load(text), dict), name


@pytest.mark.parametrize("kind", KINDS)
def test_the_case_of_a_new_plugin_uses_it_and_gives_no_warning(made, kind):
    folder = made[kind][0]
    assert NAME in (folder / "case.yaml").read_text()
    summary = json.loads((folder / "build" / "results" / "ranks_2" / "summary.json").read_text())
    assert summary["ranks"] == 2 and summary["warnings"] == []


@pytest.mark.parametrize("kind", LAWS)
def test_references_of_a_point_are_what_their_script_writes(made, kind, tmp_path):
    tests = made[kind][0] / "tests"
    shutil.copy(tests / "point_reference.py", tmp_path)
    subprocess.run(["python3", tmp_path / "point_reference.py"], check=True, timeout=60)
    tables = sorted(tests.glob("point*.csv"))
    assert tables and [t.name for t in tables] == sorted(t.name for t in tmp_path.glob("point*.csv"))
    for table in tables:
        for ours, theirs in zip(table.read_text().splitlines(), (tmp_path / table.name).read_text().splitlines(),
                                strict=True):
            if ours == theirs:
                continue
            # Nine digits are written; libraries of C may differ in the last of sixteen.
            for a, b in zip(ours.split(","), theirs.split(","), strict=True):
                assert float(a) == pytest.approx(float(b), rel=2e-9)


@pytest.mark.parametrize("file, old, new, test, said", [
    (f"{NAME}.cpp", "(Y0 + H * state.effective_plastic_strain)", "Y0", "point", "von_mises"),
    (f"{NAME}.md", "`viscosity`", "viscosity", "page", "not explained: viscosity"),
    ("tests/expected.json", '"at_most": -500', '"at_most": -900', "case", "the ball is slowed down"),
    ("case.yaml", "end: 8 us", "end: 8 us, maximum_cycle: 1", "case", "unknown key `maximum_cycle`"),
], ids=["law", "page", "number", "input"])
def test_tests_of_a_new_plugin_find_faults(made, tmp_path, file, old, new, test, said):
    folder, commands = make(KERF, "material", tmp_path)
    text = (folder / file).read_text()
    assert old in text
    (folder / file).write_text(text.replace(old, new))
    carry_out(commands[:2])
    done = call(*commands[2], "-E", "conformance")  # which is the subject of test_conformance.py
    assert done.returncode != 0
    failed = re.findall(r"^\s+\d+ - (\w+) \(Failed\)", done.stdout + done.stderr, re.MULTILINE)
    # A law without hardening changes the numbers of the case a little, within their bounds.
    assert failed == [test]
    assert said in " ".join(done.stdout.split())


def test_an_installed_kerf_makes_plugins_too(tmp_path):
    prefix = tmp_path / "prefix"
    done = call("cmake", "--install", BUILD, "--prefix", prefix)
    assert done.returncode == 0, done.stderr
    folder, commands = make(prefix / "bin" / "kerf", "partitioner", tmp_path)
    assert f"-DKerf_DIR={prefix}/lib/cmake/Kerf" in commands[0]
    text = carry_out(commands)
    assert "100% tests passed" in text
    entries = (folder / "build" / "CTestTestfile.cmake").read_text()
    assert str(prefix / "bin" / "kerf") in entries and str(KERF) not in entries


def test_the_build_of_a_partitioner_is_that_of_all_kinds_and_mpi(tmp_path):
    both = []
    for kind in ("balance_policy", "partitioner"):
        (tmp_path / kind).mkdir()
        text = (make(KERF, kind, tmp_path / kind)[0] / "CMakeLists.txt").read_text()
        assert "@" not in text
        both.append(text.replace(kind, "KIND"))
    without = both[1].replace("find_package(MPI REQUIRED COMPONENTS CXX)\n", "").replace(" LINK MPI::MPI_CXX)", ")")
    assert both[1] != both[0] and without == both[0]


@pytest.mark.parametrize("words, said", [
    (["materail", NAME], 'there is no kind "materail"; did you mean `material`?'),
    (["common", NAME], 'there is no kind "common"; the kinds are '),
    (["material", "FreshStart"], "is no name for a type; expected lower-case words"),
    (["material", "fresh-start"], "is no name for a type; expected lower-case words"),
    (["material", "2_fresh"], "is no name for a type; expected lower-case words"),
    (["material", "../fresh"], "is no name for a type; expected lower-case words"),
    (["material", "elastic"], "there is a type elastic of kind material already; expected another name"),
    (["material", "test"], 'CMake keeps the name "test" for itself'),
    (["material", "curve"], "would be called Curve, which Kerf's interface has already"),
])
def test_what_cannot_be_a_plugin_is_refused(tmp_path, words, said):
    done = call(KERF, "new-plugin", *words, "--output", tmp_path)
    assert done.returncode == 1 and said in done.stderr and done.stdout == ""
    assert list(tmp_path.iterdir()) == []


def test_a_name_may_be_taken_in_another_kind(tmp_path):
    assert call(KERF, "new-plugin", "eos", "elastic", "--output", tmp_path).returncode == 0


def test_a_folder_that_exists_is_left_alone(tmp_path):
    (tmp_path / NAME).write_text("something of the author's")
    done = call(KERF, "new-plugin", "material", NAME, "--output", tmp_path)
    assert done.returncode == 1 and f"{tmp_path / NAME} exists already; remove it, or name another" in done.stderr
    assert (tmp_path / NAME).read_text() == "something of the author's"


def test_a_folder_that_cannot_be_written_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    done = call(KERF, "new-plugin", "material", NAME, "--output", tmp_path / "file")
    assert done.returncode == 1
    expected = f"the folder {tmp_path}/file/{NAME} cannot be made: Not a directory; name another with --output"
    assert expected in done.stderr


def test_a_disk_that_is_full_leaves_nothing_behind(tmp_path):
    # A limit of file sizes stands in for it: the tests run as any user.
    done = subprocess.run(["bash", "-c", f"trap '' XFSZ; ulimit -f 1; exec '{KERF}' new-plugin material {NAME} "
                           f"--output '{tmp_path}'"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and "the plugin could not be written, and nothing is left of it" in done.stderr
    assert list(tmp_path.iterdir()) == []
