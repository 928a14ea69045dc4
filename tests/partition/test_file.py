"""Runs with parts from a file: the same bits as without, and a line for everything that is wrong with the file."""

import json
import subprocess

import numpy as np
import pytest

from test_command import MODEL, call

h5py = pytest.importorskip("h5py")

N = 388  # elements of the model


@pytest.fixture(scope="module")
def folder(binary, tmp_path_factory):
    """The model, its partitions, and a run on one rank."""
    place = tmp_path_factory.mktemp("file")
    (place / "rod.yaml").write_text(json.dumps(MODEL))
    call(binary, "partition", place / "rod.yaml", "--parts", "1,2,3", "--output", place / "study", "--no-mesh",
         "--method", "zoltan_hypergraph,block")
    call(binary, "run", place / "rod.yaml", "--output", place / "reference")
    return place


def hash_of(folder):
    return json.loads((folder / "summary.json").read_text())["state_hash"]


def write(folder, name, lines):
    (folder / name).write_text("\n".join(lines) + "\n")
    return name


def run(binary, folder, output, partitioner, ranks, expect=0, force=0):
    model = {**MODEL, "balance": {"partitioner": {"type": "file", **partitioner}, "force_interval": force}}
    path = folder / f"{output.name}.yaml"
    path.write_text(json.dumps(model))
    return call(binary, "run", path, "--output", output, "--ranks", ranks, expect=expect)


@pytest.mark.parametrize("ranks", [1, 2, 3])
@pytest.mark.parametrize("method", ["block", "zoltan_hypergraph"])
def test_runs_by_the_file_of_partitions(binary, folder, tmp_path, ranks, method):
    run(binary, folder, tmp_path / f"run_{method}_{ranks}", {"file": "study/partitions.h5", "method": method}, ranks,
        force=7)
    results = tmp_path / f"run_{method}_{ranks}"
    assert hash_of(results) == hash_of(folder / "reference")
    with h5py.File(folder / "study/partitions.h5") as file, h5py.File(results / "results.vtkhdf") as frames:
        assert np.array_equal(frames["VTKHDF/CellData/owner"][:N], file[f"initial/{method}/{ranks}"][:])


def test_runs_by_text_and_by_a_plain_hdf5_file(binary, folder, tmp_path):
    lines = ["# element part"] + [f"{e} {e % 2}" if e % 3 else f"{e},{e % 2}  # odd or even" for e in range(N)]
    write(folder, "owners.txt", lines[:100] + [""] + lines[100:])
    run(binary, folder, tmp_path / "text", {"file": "owners.txt"}, 2)
    order = np.random.default_rng(3).permutation(N)
    with h5py.File(folder / "owners.h5", "w") as file:
        file["element"], file["part"] = order, order % 2
    run(binary, folder, tmp_path / "hdf5", {"file": "owners.h5"}, 2)
    for name in ("text", "hdf5"):
        assert hash_of(tmp_path / name) == hash_of(folder / "reference")
        with h5py.File(tmp_path / name / "results.vtkhdf") as frames:
            assert np.array_equal(frames["VTKHDF/CellData/owner"][:N], np.arange(N) % 2)


def test_of_several_files_the_one_that_fits_is_taken(binary, folder, tmp_path):
    for n in (1, 2, 3):
        write(folder, f"owners_{n}.txt", [f"{e} {e % n}" for e in range(N)])
    files = {"file": [f"owners_{n}.txt" for n in (1, 2, 3)]}
    for ranks in (1, 3):
        run(binary, folder, tmp_path / f"several_{ranks}", files, ranks)
        assert hash_of(tmp_path / f"several_{ranks}") == hash_of(folder / "reference")


GOOD = [f"{e} {e % 2}" for e in range(N)]


@pytest.mark.parametrize("lines, messages", [
    (GOOD[:7] + ["7 one", "8"] + GOOD[9:], [
        'bad.txt:8: error: "7 one" is no element and its part; expected two whole numbers',
        'bad.txt:9: error: "8" is no element and its part; expected two whole numbers']),
    (GOOD + ["388 0", "-1 0"], [
        "bad.txt:389: error: there is no element 388; expected a number from 0 to 387",
        "bad.txt:390: error: there is no element -1; expected a number from 0 to 387"]),
    (GOOD[:5] + ["5 -1"] + GOOD[6:], ["bad.txt:6: error: part -1 is out of range"]),
    (GOOD + ["9 0"], ["bad.txt:389: error: element 9 has a part already, in line 10"]),
    (GOOD[:100] + GOOD[103:], ["bad.txt: error: 3 elements have no part, the first of them element 100"]),
    ([f"{e} {e % 5}" for e in range(N)],
     ["bad.txt: error: the number of parts is 5 (line 3 has the first part above 1), and the number asked for is 2"]),
    ([f"{e} 0" for e in range(N)], ["bad.txt: error: the number of parts is 1, and the number asked for is 2"]),
    (["# nothing"], ["bad.txt: error: no line has an element and its part"]),
    (["1.5 0"] * 30, ["bad.txt:20: error:", "bad.txt: error: 10 more lines are wrong"]),
])
def test_bad_lines_are_told(binary, folder, tmp_path, lines, messages):
    write(folder, "bad.txt", lines)
    done = run(binary, folder, tmp_path / "bad", {"file": "bad.txt"}, 2, expect=2)
    for message in messages:
        assert message in done.stderr
    assert done.stderr.count("error:") >= len(messages)


@pytest.mark.parametrize("partitioner, message", [
    ({"file": "none.txt"}, "none.txt: error: the file with the parts of elements cannot be read"),
    ({"file": []}, "file must not be an empty list"),
    ({"file": "study/partitions.h5"},
     "it has partitions of several methods; name one with the key `method`: block, zoltan_hypergraph"),
    ({"file": "study/partitions.h5", "method": "rcb"}, "there is no method `rcb`; it has block, zoltan_hypergraph"),
    ({"file": "study/partitions.h5", "state": "frame_1"}, "there is no state `frame_1`; it has initial"),
])
def test_what_the_file_does_not_have_is_told(binary, folder, tmp_path, partitioner, message):
    assert message in run(binary, folder, tmp_path / "bad", partitioner, 2, expect=2).stderr


@pytest.mark.parametrize("file", ["chosen.txt", "chosen.h5"])
@pytest.mark.parametrize("key", [{"method": "block"}, {"state": "frame_7"}])
def test_keys_that_cannot_choose_are_refused(binary, folder, tmp_path, file, key):
    write(folder, "chosen.txt", GOOD)
    with h5py.File(folder / "chosen.h5", "w") as plain:
        plain["part"] = np.arange(N) % 2
    done = run(binary, folder, tmp_path / "bad", {"file": file, **key}, 2, expect=2)
    assert f"{file} has one division only, of which `method` and `state` cannot choose" in done.stderr


def test_too_many_ranks_are_an_error_with_both_numbers(binary, folder, tmp_path):
    done = run(binary, folder, tmp_path / "bad", {"file": "study/partitions.h5", "method": "block"}, 5, expect=2)
    assert "the number of parts is 1, 2, 3, and the number asked for is 5" in done.stderr
    write(folder, "two.txt", GOOD)
    done = run(binary, folder, tmp_path / "one", {"file": "two.txt"}, 1, expect=2)
    assert "the number of parts is 2 (line 2 has the first part above 0), and the number" in done.stderr


def test_a_damaged_hdf5_file_is_told(binary, folder, tmp_path):
    whole = (folder / "study/partitions.h5").read_bytes()
    (folder / "cut.h5").write_bytes(whole[: len(whole) // 2])
    done = run(binary, folder, tmp_path / "bad", {"file": "cut.h5", "method": "block"}, 2, expect=2)
    assert "cut.h5: error: the HDF5 file cannot be read" in done.stderr
    with h5py.File(folder / "wrong.h5", "w") as file:
        file["part"] = np.zeros(N)
    assert "`part` is no list of whole numbers" in run(binary, folder, tmp_path / "bad2", {"file": "wrong.h5"}, 2,
                                                       expect=2).stderr


def test_a_division_of_ones_own_is_measured(binary, folder, tmp_path):
    write(folder, "mine.txt", GOOD)
    call(binary, "partition", folder / "rod.yaml", "--parts", 2, "--output", tmp_path, "--no-mesh", "--method",
         f"mine={{type: file, file: {folder / 'mine.txt'}}}")
    row, = json.loads((tmp_path / "partitions.json").read_text())["partitions"]
    assert row["of_parts"]["elements"] == [N // 2, N // 2] and row["method"] == "mine"


@pytest.mark.parametrize("ranks", [2, 3])
@pytest.mark.parametrize("partitioner", [
    "{type: none}", "{type: block}", "{type: zoltan_rcb}", "{type: zoltan_rcb, criteria: elements_and_contact}",
    "{type: zoltan_rib}", "{type: zoltan_hsfc}", "{type: zoltan_graph}", "{type: zoltan_hypergraph}",
    "{type: zoltan_scotch}"])
def test_every_partitioner_leaves_the_bits_alone(binary, folder, tmp_path, partitioner, ranks):
    done = subprocess.run([str(binary), "run", str(folder / "rod.yaml"), "--output", str(tmp_path), "--ranks",
                           str(ranks), "--set", f"balance.partitioner={partitioner}", "--set",
                           "balance.force_interval=7"], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    assert hash_of(tmp_path) == hash_of(folder / "reference")
    assert len(json.loads((tmp_path / "summary.json").read_text())["rebalances"]) > 3
