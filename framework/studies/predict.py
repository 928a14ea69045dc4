#!/usr/bin/env python3
"""Predicts how a run would scale: time per cycle, speed-up, efficiency and its factors on virtual ranks.

Exit code 0: done; 1: a file cannot be written; 2: the recording, a network, partitions or an option is wrong.
"""

from __future__ import annotations

import argparse
import csv
import io
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "post"))

try:
    import measure_network
    import pop
    import prediction
    from networks import NetworkError, find_network, read_network
    from point_folder import write_whole
    from recording import Recording, RecordingError, read_recording
except ModuleNotFoundError as error:
    sys.exit(f"kerf predict: the Python package {error.name} is missing; ./kerf build installs it, unless KERF_PYTHON "
             "names another Python")

RECORDING = "recording.h5"  # in the folder of a run
MOST_RANKS = 1 << 16
MOST_REFINED = 100


class OptionError(Exception):
    """What is wrong with an option."""


def read_ranks(text: str) -> list[int]:
    """`2,4,6`, or `2..4096` (or `2...4096`) for the powers of two times the first."""
    try:
        if ".." in text:
            first, last = (int(word) for word in (text.split("..", 1)[0], text.rsplit("..", 1)[1]))
            ranks = []
            while 0 < first <= last:
                ranks.append(first)
                first *= 2
        else:
            ranks = sorted({int(word) for word in text.split(",")})
    except ValueError:
        ranks = []
    if not ranks or ranks[0] < 1 or ranks[-1] > MOST_RANKS:
        raise OptionError(f"--ranks: error: `{text}`; expected numbers as 2,4,8 or a range as 2..4096, from 1 to "
                          f"{MOST_RANKS}")
    return ranks


def arguments(argv: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="kerf predict", description=__doc__.splitlines()[0])
    parser.add_argument("run", nargs="?", type=Path, help=f"folder of a run with {RECORDING}, or a recording")
    parser.add_argument("--ranks", default="2..4096", help="2,4,8 or 2..4096 for powers of two (default: %(default)s)")
    parser.add_argument("--network", action="append", help="name or file of a network; may be repeated (default: "
                        "hdr_infiniband)")
    parser.add_argument("--partitions", type=Path, help="file of kerf partition with the owners of elements")
    parser.add_argument("--method", action="append", help="method of that file; may be repeated")
    parser.add_argument("--policy", action="append", help="never, every:CYCLES or threshold:IMBALANCE; may be repeated "
                        "(default: never)")
    parser.add_argument("--contact-space", choices=("rcb", "owners"), default="rcb",
                        help="contact has its own decomposition, or follows the elements (default: %(default)s)")
    parser.add_argument("--refine", type=int, default=1, metavar="K", help="each recorded element stands for K x K x K "
                        "elements (default: %(default)s)")
    parser.add_argument("--output", type=Path, help="folder of tables and pictures (default: the folder of the run)")
    parser.add_argument("--measure-network", type=Path, metavar="FILE", help="measure the network between two ranks, "
                        "and write its description")
    parser.add_argument("--mpirun-option", action="append", default=[], help="of mpirun for the measurement, as "
                        "--mpirun-option=--host=a,b")
    return parser.parse_args(argv)


def partitions_of(args: argparse.Namespace) -> list[prediction.Partitions]:
    if args.partitions is None:
        if args.method:
            raise OptionError("--method: error: there is no --partitions; expected a file of kerf partition")
        return [prediction.CutPartitions()]
    if not args.method:
        raise OptionError("--partitions: error: there is no --method; expected at least one method of the file")
    return [prediction.FilePartitions(args.partitions, method) for method in args.method]


def policies_of(args: argparse.Namespace) -> list[prediction.Policy]:
    try:
        return [prediction.read_policy(text) for text in args.policy or ["never"]]
    except ValueError as error:
        raise OptionError(f"--policy: error: {error}") from error


def table_row(outcome: prediction.Outcome, serial: prediction.Outcome, refine: int) -> dict:
    """One line of the table. The reference is one rank, whose cycle has no messages."""
    factors = pop.factors(outcome.total_useful(), outcome.seconds, outcome.ideal_seconds, serial.total_useful().sum())
    row = {"network": outcome.network, "partitioner": outcome.partitioner, "policy": outcome.policy,
           "ranks": outcome.n_ranks, "seconds_per_cycle": outcome.seconds, "speed_up": serial.seconds / outcome.seconds,
           "efficiency": serial.seconds / outcome.seconds / outcome.n_ranks, **factors.as_dict(),
           "refine": refine, "moves": outcome.moves, "messages": outcome.traffic.messages,
           "bytes": outcome.traffic.n_bytes, "collectives": outcome.traffic.collectives}
    for cause, numbers in outcome.causes.items():
        row |= {f"imbalance_{cause}": numbers["imbalance"], f"lost_{cause}": numbers["lost"]}
    return row | {f"seconds_{phase}": seconds for phase, seconds in outcome.phases.items()}


def predict_all(recording: Recording, args: argparse.Namespace, networks: list) -> list[dict]:
    """All rows, by network, partitioner, policy and ranks."""
    rows = []
    ranks = read_ranks(args.ranks)
    if not 1 <= args.refine <= MOST_REFINED:
        raise OptionError(f"--refine: error: {args.refine}; expected a whole number from 1 to {MOST_REFINED}")
    serial = prediction.predict(recording, 1, prediction.CutPartitions(), prediction.Policy(), networks[:1],
                                refine=args.refine)[0]
    for partitions in partitions_of(args):
        for policy in policies_of(args):
            for n in ranks:
                if n > min(len(m.mesh.cells) for m in recording.moments):
                    print(f"{n} ranks are more than there are elements; no prediction", file=sys.stderr)
                    continue
                outcomes = prediction.predict(recording, n, partitions, policy, networks, args.contact_space,
                                              refine=args.refine)
                for outcome in outcomes:
                    rows.append(table_row(outcome, serial, args.refine))
                    print(f"{outcome.network:<28}{outcome.partitioner:<12}{outcome.policy:<16}{n:>6} ranks  "
                          f"{outcome.seconds:.4g} s per cycle, efficiency {rows[-1]['efficiency']:.3f}", flush=True)
    return sorted(rows, key=lambda r: (r["network"], r["partitioner"], r["policy"], r["ranks"]))


def write_tables(rows: list[dict], folder: Path, about: dict) -> None:
    names = list(dict.fromkeys(name for row in rows for name in row))
    table = io.StringIO()
    writer = csv.DictWriter(table, names, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_whole(folder / "predict.csv", table.getvalue())
    write_whole(folder / "predict.json", json.dumps({**about, "predictions": rows}, indent=1) + "\n")


def run(args: argparse.Namespace) -> None:
    if args.run is None:
        raise OptionError("kerf predict: error: no run is named; expected the folder of a run, or --measure-network")
    path = args.run / RECORDING if args.run.is_dir() else args.run
    networks = [read_network(find_network(name)) for name in args.network or ["hdr_infiniband"]]
    recording = read_recording(path)
    rows = predict_all(recording, args, networks)
    if not rows:
        raise OptionError("--ranks: error: every number of ranks is greater than that of elements; expected fewer "
                          "ranks")
    folder = args.output or path.parent
    folder.mkdir(parents=True, exist_ok=True)
    write_tables(rows, folder, {"recording": str(path), "source": recording.source,
                                "contact_space": args.contact_space, "refine": args.refine,
                                "networks": [n.name for n in networks]})
    import prediction_charts

    for picture in prediction_charts.plot_all(rows, folder):
        print(picture)


def main(argv: list[str]) -> int:
    args = arguments(argv)
    try:
        if args.measure_network is not None:
            for key, value in measure_network.measure(args.measure_network, args.mpirun_option).items():
                print(f"{key:<20}{value:.4g} s")
        else:
            run(args)
    except (OptionError, RecordingError, NetworkError, prediction.PartitionError,
            measure_network.MeasurementError) as error:
        print(error, file=sys.stderr)
        return 2
    except OSError as error:
        print(f"{error.filename or args.output}: error: {error.strerror or error}; expected a folder that can be "
              "written", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
