"""The clocks of virtual ranks: closed forms of the LogGP model, and an engine that loops over messages."""

import numpy as np
import pytest
from predict_scenes import sample_program

import loggp
from loggp import Clock, Link, Network, ideal, serve
from program import (Messages, Program, dissemination, joined, no_messages, recursive_doubling,
                     reduce_and_broadcast)

LINK = Link(latency=1.0e-6, send_overhead=0.3e-6, receive_overhead=0.4e-6, gap=0.2e-6, gap_per_byte=1.0e-9,
            overhead_per_byte=0.1e-9)
NETWORK = Network("test", LINK, allreduce="recursive_doubling", all_to_all="pairwise")


def times(network, n_ranks, *messages, n_bytes=1, start=None):
    clock = Clock(network, n_ranks)
    if start is not None:
        clock.time = np.array(start, dtype=float)
    for m in messages:
        clock.exchange(m, n_bytes)
    return clock.time


def test_one_message_takes_overheads_latency_and_bytes():
    got = times(NETWORK, 2, Messages([0], [1], [1]), n_bytes=1000)
    assert got[0] == pytest.approx(0.3e-6 + 1000 * 0.1e-9)
    assert got[1] == pytest.approx(0.3e-6 + 1.0e-6 + 1000 * 1.0e-9 + 0.4e-6 + 2 * 1000 * 0.1e-9)


def test_a_second_message_leaves_when_the_card_is_free():
    got = times(NETWORK, 3, Messages([0, 0], [1, 2], [1, 1]), n_bytes=10000)
    card = 0.2e-6 + 10000 * 1.0e-9
    assert got[2] - got[1] == pytest.approx(card)


def test_a_card_receives_one_message_after_the_other():
    got = times(NETWORK, 3, Messages([0, 1], [2, 2], [1, 1]), n_bytes=10000)
    one = times(NETWORK, 2, Messages([0], [1], [1]), n_bytes=10000)
    assert got[2] - one[1] == pytest.approx(0.2e-6 + 10000 * 1.0e-9)


def test_a_receiver_that_comes_late_finds_its_message():
    late = 1.0e-3
    got = times(NETWORK, 2, Messages([0], [1], [1]), start=[0.0, late])
    assert got[1] == pytest.approx(late + LINK.receive_overhead + LINK.overhead_per_byte)
    assert got[0] < 1.0e-6


def test_a_long_message_waits_for_its_receiver_and_its_sender_too():
    network = Network("test", LINK, eager_limit=100)
    late, n_bytes = 1.0e-3, 1000
    got = times(network, 2, Messages([0], [1], [1]), n_bytes=n_bytes, start=[0.0, late])
    handshake = LINK.latency + LINK.send_overhead + LINK.receive_overhead
    begin = late + handshake
    assert got[0] == pytest.approx(begin + n_bytes * LINK.gap_per_byte)
    assert got[1] == pytest.approx(begin + LINK.latency + n_bytes * (LINK.gap_per_byte + LINK.overhead_per_byte)
                                   + LINK.receive_overhead)


def test_the_last_message_of_a_step_keeps_the_card_busy_for_the_next():
    m = Messages([0], [1], [1])
    n_bytes = 100000
    got = times(Network("test", Link(gap_per_byte=1.0e-9)), 2, m, m, n_bytes=n_bytes)
    assert got[1] == pytest.approx(2 * n_bytes * 1.0e-9)


def test_ranks_of_a_node_share_its_link():
    network = Network("test", Link(), inside=Link(), ranks_per_node=4, node_gap_per_byte=1.0e-9)
    four = Messages([0, 1, 2, 3], [4, 5, 6, 7], [1] * 4)
    assert times(network, 8, four, n_bytes=1000).max() == pytest.approx(4 * 1000 * 1.0e-9)
    inside = Messages([0, 1, 2, 4], [1, 2, 3, 5], [1] * 4)
    assert times(network, 8, inside, n_bytes=1000).max() == 0.0


def one_by_one(arrival, queue, service):
    """First come, first served, by a loop."""
    begin, free = np.empty(len(arrival)), {}
    for i in sorted(range(len(arrival)), key=lambda k: (arrival[k], k)):
        begin[i] = max(arrival[i], free.get(queue[i], -np.inf))
        free[queue[i]] = begin[i] + service[i]
    return begin


@pytest.mark.parametrize("seed", range(20))
def test_queues_are_those_of_a_loop(seed):
    rng = np.random.default_rng(seed)
    n, n_queues = 2000, int(rng.choice([1, 3, 50, 1500]))
    arrival, service = 1.0 + rng.uniform(0.0, 1.0e-4, n), rng.exponential(2.0e-6, n)
    queue = rng.integers(0, n_queues, n)
    np.testing.assert_allclose(serve(arrival, queue, service), one_by_one(arrival, queue, service), rtol=0, atol=1e-12)


def naive_exchange(network, start, messages, n_bytes):
    """Eager messages of one exchange, one after the other, on clocks that start with free cards."""
    n = len(start)

    def link(i):
        same = messages.source[i] // network.ranks_per_node == messages.destination[i] // network.ranks_per_node
        return network.inside if same and network.ranks_per_node > 1 else network.between

    size = messages.items * n_bytes
    links = [link(i) for i in range(len(messages))]
    now, ready = list(start), []
    for i, w in enumerate(links):
        now[messages.source[i]] += w.send_overhead + size[i] * w.overhead_per_byte
        ready.append(now[messages.source[i]])
    card = np.array([w.gap + size[i] * w.gap_per_byte for i, w in enumerate(links)])
    out = one_by_one(np.array(ready), messages.source, card)
    far = np.array([w is network.between for w in links]) & (network.ranks_per_node > 1)
    node = network.node_gap + size * network.node_gap_per_byte
    out[far] = one_by_one(out[far], messages.source[far] // network.ranks_per_node, node[far])
    came = out + np.array([w.latency for w in links])
    came[far] = one_by_one(came[far], messages.destination[far] // network.ranks_per_node, node[far])
    bytes_time = np.array([size[i] * w.gap_per_byte for i, w in enumerate(links)])
    bytes_time[far] = np.maximum(bytes_time, size * network.node_gap_per_byte)[far]
    came = one_by_one(came, messages.destination, card) + bytes_time
    took = np.array([w.receive_overhead + size[i] * w.overhead_per_byte for i, w in enumerate(links)])
    came = np.maximum(came, np.array(now)[messages.destination])
    done = one_by_one(came, messages.destination, took) + took
    return np.array([max([now[r], *done[messages.destination == r]]) for r in range(n)])


@pytest.mark.parametrize("ranks_per_node", [1, 4])
@pytest.mark.parametrize("seed", range(5))
def test_an_exchange_is_that_of_a_loop(seed, ranks_per_node):
    rng = np.random.default_rng(seed)
    n = 40
    pairs = np.unique(rng.integers(0, n * n, 300))
    pairs = pairs[pairs // n != pairs % n]
    messages = Messages(pairs // n, pairs % n, rng.integers(1, 400, len(pairs)))
    network = Network("test", LINK, inside=Link(2e-7, 1e-7, 1e-7, 0.0, 2e-10, 1e-10), ranks_per_node=ranks_per_node,
                      node_gap=1e-8, node_gap_per_byte=5e-10)
    start = rng.uniform(0.0, 2.0e-5, n)
    np.testing.assert_allclose(times(network, n, messages, n_bytes=24, start=start),
                               naive_exchange(network, start, messages, 24), rtol=0, atol=1e-13)


@pytest.mark.parametrize("n_ranks", [2, 4, 64, 1024])
def test_recursive_doubling_takes_the_logarithm_of_the_ranks(n_ranks):
    program = Program(n_ranks)
    program.allreduce("halo", 100)
    round_time = (LINK.send_overhead + LINK.receive_overhead + 2 * 100 * LINK.overhead_per_byte + LINK.latency
                  + 100 * LINK.gap_per_byte)
    got = Clock(NETWORK, n_ranks).run(program)
    np.testing.assert_allclose(got, np.log2(n_ranks) * round_time, rtol=1e-9)


@pytest.mark.parametrize("n_ranks", [1, 2, 3, 5, 7, 12, 64, 100, 129])
@pytest.mark.parametrize("make", [recursive_doubling, reduce_and_broadcast, dissemination])
def test_after_a_collective_every_rank_knows_of_every_other(make, n_ranks):
    known = np.eye(n_ranks, dtype=bool)
    for messages in make(n_ranks):
        before = known.copy()
        for s, d in zip(messages.source, messages.destination):
            known[d] |= before[s]
    assert known.all()


@pytest.mark.parametrize("algorithm", ["recursive_doubling", "tree"])
def test_nobody_leaves_an_allreduce_before_the_last_has_come(algorithm):
    program = Program(37)
    program.compute("elements", np.where(np.arange(37) == 11, 1.0, 0.0))
    program.allreduce("halo", 8)
    got = Clock(Network("test", LINK, allreduce=algorithm), 37).run(program)
    assert got.min() > 1.0


def test_nobody_leaves_a_consensus_before_all_messages_are_taken():
    program = Program(9)
    program.compute("elements", np.where(np.arange(9) == 4, 1.0, 0.0))
    program.consensus("erosion", Messages([0], [4], [1]), 100)
    assert Clock(NETWORK, 9).run(program).min() > 1.0


@pytest.mark.parametrize("algorithm", ["pairwise", "linear"])
def test_an_all_to_all_costs_every_rank_all_others(algorithm):
    n = 16
    program = Program(n)
    program.all_to_all_v("rebalance", Messages([0, 3], [5, 1], [10, 20]), 400)
    got = Clock(Network("test", LINK, all_to_all=algorithm), n).run(program)
    least = (n - 1) * (LINK.send_overhead + LINK.receive_overhead)
    assert got.min() >= least
    assert got.max() < 20.0 * least


def test_bounds_stand_for_the_messages_of_a_linear_all_to_all(monkeypatch):
    n = 200
    rng = np.random.default_rng(4)
    program = Program(n)
    program.compute("elements", rng.uniform(0.0, 2.0e-5, n))
    source = np.repeat(np.arange(n), 3)
    moved = Messages(source, (source + np.tile([1, 2, 9], n)) % n, rng.integers(1, 50, len(source)))
    program.all_to_all_v("rebalance", moved, 400)
    network = Network("test", LINK, all_to_all="linear")
    followed = Clock(network, n).run(program).max()
    monkeypatch.setattr(loggp, "MOST_LINEAR", 0)
    bounded = Clock(network, n).run(program).max()
    assert bounded == pytest.approx(followed, rel=0.15)


def test_open_mpi_changes_its_algorithm_with_the_ranks():
    network = Network("test", LINK)
    assert [network.allreduce_of(n) for n in (64, 127, 128, 4096)] == ["recursive_doubling"] * 2 + ["tree"] * 2
    assert [network.all_to_all_of(n) for n in (32, 64, 128, 512, 4096)] == ["linear", "pairwise", "linear", "pairwise",
                                                                            "linear"]


def test_on_an_ideal_network_ranks_only_wait():
    program = sample_program(8, 16, 3)
    useful = Clock(ideal(NETWORK), 16)
    end = useful.run(program).max()
    most = np.sum(list(useful.useful.values()), axis=0).max()
    assert most <= end < Clock(NETWORK, 16).run(program).max()


def test_a_slower_network_is_never_faster():
    program = sample_program(8, 32, 3)
    slower = Network("slower", Link(*(2.0 * v for v in (1e-6, 0.3e-6, 0.4e-6, 0.2e-6, 1e-9, 1e-10))),
                     allreduce="recursive_doubling")
    assert np.all(Clock(slower, 32).run(program) >= Clock(NETWORK, 32).run(program))


def test_the_phases_of_a_rank_add_up_to_its_time():
    clock = Clock(NETWORK, 32)
    end = clock.run(sample_program(8, 32, 3))
    np.testing.assert_allclose(np.sum(list(clock.spent.values()), axis=0), end, rtol=1e-12)


def test_messages_that_travel_together_have_the_bytes_of_both():
    both = joined((Messages([0, 1], [1, 2], [2, 3]), 10), (Messages([1, 2], [2, 0], [4, 5]), 100))
    assert list(zip(both.source, both.destination, both.items)) == [(0, 1, 20), (1, 2, 430), (2, 0, 500)]
    assert len(joined((no_messages(), 1), (no_messages(), 1))) == 0


def test_messages_to_oneself_and_twice_to_another_are_refused():
    with pytest.raises(ValueError, match="sends a message to itself; expected messages between different ranks"):
        Messages([1], [1], [1])
    with pytest.raises(ValueError, match="two messages from the same rank to the same rank; expected one"):
        Messages([1, 1], [2, 2], [1, 1])


@pytest.mark.parametrize("seconds, text", [(np.ones(3), "expected one for each of the 4 ranks"),
                                           (np.array([1.0, np.nan, 1.0, 1.0]), "expected at least 0 s")])
def test_times_that_cannot_be_are_refused(seconds, text):
    with pytest.raises(ValueError, match=text):
        Program(4).compute("elements", seconds)
