"""Descriptions of networks: those that come with Kerf, mistakes in one's own, and a measurement."""

import shutil

import numpy as np
import pytest
import yaml
from predict_scenes import STUDIES

import measure_network
from loggp import Link
from networks import FOLDER, NetworkError, find_network, read_network

OURS = sorted(FOLDER.glob("*.yaml"))


@pytest.mark.parametrize("path", OURS, ids=lambda p: p.stem)
def test_every_number_of_ours_has_a_source(path):
    network = read_network(path)
    assert 0.0 < network.between.latency < 1.0e-4
    content = yaml.safe_load(path.read_text())
    for link in (content["between"], content.get("inside", {})):
        for key, entry in link.items():
            assert len(entry["source"]) > 5, key
    assert read_network(find_network(path.stem)) == network


def test_there_are_ours():
    assert {p.stem for p in OURS} >= {"shared_memory", "edr_infiniband", "hdr_infiniband", "slingshot_11",
                                      "ethernet_10", "ethernet_25"}


GOOD = ("name: mine\nbetween:\n  latency: 1.0e-6\n  gap_per_byte: {value: 1.0e-10, source: measured}\n"
        "  send_overhead: 2.0e-7\n  receive_overhead: 3.0e-7\n  overhead_per_byte: 4.0e-11\n")


def test_numbers_may_stand_alone_or_with_a_source(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(GOOD)
    assert read_network(path).between == Link(
        latency=1.0e-6, gap_per_byte=1.0e-10, send_overhead=2.0e-7, receive_overhead=3.0e-7, overhead_per_byte=4.0e-11)


@pytest.mark.parametrize("text, message", [
    (GOOD.replace("latency", "latencey"), ":3:3: error: unknown key `latencey` in `between`; did you mean `latency`?"),
    (GOOD.replace("1.0e-6", "fast"), ":3:12: error: `latency` is `fast`; expected a finite number, at least 0"),
    (GOOD.replace("1.0e-6", "-1.0"), ":3:12: error: `latency` is `-1.0`; expected a finite number, at least 0"),
    (GOOD.replace("1.0e-6", ".nan"), ":3:12: error: `latency` is `.nan`; expected a finite number, at least 0"),
    (GOOD.replace("value: ", "number: "), ":4:18: error: unknown key `number` in `gap_per_byte`; expected one of"),
    (GOOD + "ranks_per_node: 2.5\n", ":8:17: error: `ranks_per_node` is 2.5; expected a whole number"),
    (GOOD + "ranks_per_node: 4\n", "a node has several ranks, but there is no key `inside`; expected"),
    (GOOD.replace("1.0e-6", "1.0"), ":3:12: error: `latency` is 1 s; expected seconds, at most 0.1"),
    (GOOD.replace("1.0e-6", "1_0"), ":3:12: error: `latency` is `1_0`; expected a finite number, at least 0"),
    (GOOD.replace("name: mine", "name: {a: 1}"), ":1:7: error: `name` is no word; expected one"),
    ("between: {}\n", ":1:10: error: `between` has no `latency`; expected seconds"),
    (GOOD.replace("send_overhead", "gap"), ":3:3: error: `between` has no `send_overhead`; expected seconds"),
    ("name: a\x00b\n", "expected YAML"),
    (GOOD + "allreduce: magic\n", "allreduce is magic; expected open_mpi or recursive_doubling or tree"),
    (GOOD + "name: twice\n", ":8:1: error: the key `name` stands twice in the network; expected it once"),
    ("name: mine\n", "the network has no key `between`; expected"),
    ("between: 3\n", ":1:10: error: `between` is no map; expected keys with values"),
    ("between: [\n", "expected YAML"), ("", "the file is empty; expected a description of a network")])
def test_mistakes_are_told_with_their_place(text, message, tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(NetworkError) as error:
        read_network(path)
    assert f"{path}" in str(error.value) and message in str(error.value)


def test_all_mistakes_are_told_at_once(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(GOOD.replace("1.0e-6", "a").replace("4.0e-11", "b") + "what: 1\n")
    with pytest.raises(NetworkError) as error:
        read_network(path)
    assert [line.split(": ")[0].removeprefix(f"{path}:") for line in str(error.value).splitlines()] == ["3:12", "7:22",
                                                                                                       "8:1"]


def test_a_file_that_is_no_text_is_told(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_bytes(b"name: \xff\xfe\n")
    with pytest.raises(NetworkError, match="the file is no text in UTF-8; expected a description"):
        read_network(path)


def test_names_that_are_not_ours():
    with pytest.raises(NetworkError, match="there is no network `hdr_infinband`; did you mean `hdr_infiniband`"):
        find_network("hdr_infinband")


def test_a_fit_finds_the_parameters_that_made_the_times():
    link = Link(latency=2.0e-6, send_overhead=0.3e-6, receive_overhead=0.5e-6, gap=1.1e-6, gap_per_byte=1.0e-9,
                overhead_per_byte=0.2e-9)
    size = np.array([1.0, 64.0, 256.0, 1024.0, 3072.0])
    one = 2.0 * (link.send_overhead + link.latency + link.receive_overhead + size * 1.4e-9)
    many = one + 15.0 * (link.gap + size * link.gap_per_byte)
    rows = np.stack([size, one, many, np.full(5, 16.0), 0.3e-6 + size * 0.2e-9, 0.5e-6 + size * 0.2e-9],
                    axis=1)
    found = measure_network.fit(rows)
    for key in ("latency", "send_overhead", "receive_overhead", "gap", "gap_per_byte",
                "overhead_per_byte"):
        # One byte counts as none.
        assert found[key] == pytest.approx(getattr(link, key), rel=2.0e-3)


@pytest.mark.skipif(shutil.which("mpicc") is None, reason="mpicc is not installed")
def test_a_measurement_describes_a_network(tmp_path):
    path = tmp_path / "here.yaml"
    measure_network.measure(path, ["--oversubscribe"], repeats=50)
    network = read_network(path)
    one_way = network.between.latency + network.between.send_overhead + network.between.receive_overhead
    # A machine that is busy may let a message wait for some time slices.
    assert 1.0e-8 < one_way < 0.1
    assert 0.0 <= network.between.gap_per_byte + network.between.overhead_per_byte < 1.0e-4
