#!/usr/bin/env python3
"""Measures how fast Kerf runs and sets the numbers beside the marks that it is held to. Behind `./kerf bench`.

Repeats of all cases are interleaved, so that a slow minute of the machine does not fall on one case alone; medians
and half ranges are shown. Rates are element-cycles per second of the run without set-up and output. With --baseline
an older program runs in turn with this one, and ratios are shown: absolute seconds of another day tell little.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

import marks  # noqa: E402
from calibrate import calibrate  # noqa: E402
from runner import ROOT, BenchError, Runner, Samples  # noqa: E402
from sections import SECTIONS, Bench  # noqa: E402


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="kerf bench", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, metavar="FILE", help="write everything measured to FILE")
    parser.add_argument("--quick", action="store_true", help="small models, single runs: shows that all of it works")
    parser.add_argument("--baseline", type=Path, metavar="BINARY", help="an older kerf to compare with, in turn")
    parser.add_argument("--repeats", type=int, metavar="N", help="default 5, or 1 with --quick")
    by_default = [name for name, section in SECTIONS.items() if section.by_default]
    parser.add_argument("--only", nargs="+", choices=list(SECTIONS), metavar="SECTION",
                        help=f"of {', '.join(SECTIONS)}; by default {', '.join(by_default)}")
    parser.add_argument("--calibrate", type=Path, metavar="FILE.yaml",
                        help="measure the costs of elements, laws, contact and re-balancing, and nothing else, and "
                        "write them to FILE.yaml for balance.work_model")
    parser.add_argument("--scratch", type=Path, metavar="DIR",
                        help="where runs write (default: below the build folder)")
    arguments = parser.parse_args()
    if arguments.repeats is not None and arguments.repeats < 1:
        parser.error("--repeats has to be at least 1")
    if arguments.baseline and not os.access(arguments.baseline, os.X_OK):
        parser.error(f"{arguments.baseline} is not a program")
    arguments.only = arguments.only or by_default
    return arguments


def machine() -> dict:
    model = "unknown"
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            model = line.split(":", 1)[1].strip()
            break
    return {"processor": model, "cores": os.cpu_count(), "load_at_start": os.getloadavg()[0]}


def default_binary() -> str:
    build = Path(os.environ.get("KERF_BUILD_DIR", ROOT / "build"))
    return os.environ.get("KERF_BINARY", str(build / "bin" / "kerf"))


def main() -> int:
    arguments = parse_arguments()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    binary = default_binary()
    if not os.access(binary, os.X_OK):
        print(f"kerf bench: {binary} is not there; run ./kerf build", file=sys.stderr)
        return 1
    host = machine()
    print(f"{host['processor']}, {host['cores']} cores, load {host['load_at_start']:.2f}")
    if host["load_at_start"] > 0.3:
        print("note: other programs are running; the numbers are disturbed")
    scratch = arguments.scratch or Path(binary).resolve().parents[1]
    baseline = str(arguments.baseline.resolve()) if arguments.baseline else None
    with tempfile.TemporaryDirectory(prefix="bench_", dir=scratch) as folder:
        bench = Bench(Runner(Path(folder)), binary, baseline, arguments.repeats or (1 if arguments.quick else 5),
                      arguments.quick)
        try:
            if arguments.calibrate:
                calibrate(bench, arguments.calibrate, host)
                return 0
            for name in arguments.only:
                SECTIONS[name].measure(bench)
        except BenchError as error:
            print(f"kerf bench: {error}", file=sys.stderr)
            return 1
        finally:
            bench.runner.stop()
    rows = marks.report(bench.measured, not arguments.quick, print)
    if arguments.json:
        samples = {key: value.as_json() if isinstance(value, Samples) else value
                   for key, value in bench.measured.items()}
        arguments.json.write_text(json.dumps(
            {"machine": host, "binary": binary, "baseline": baseline, "quick": arguments.quick,
             "repeats": bench.repeats, "sections": arguments.only, "marks": rows, "samples": samples}, indent=1) + "\n")
        print(f"written to {arguments.json}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
