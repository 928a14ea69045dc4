"""`./kerf test --campaign NAME`: runs one campaign in full, prints its counts, and fails where anything went wrong."""

import importlib
import inspect
import signal
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from harness import Report  # noqa: E402

CAMPAIGNS = ("damaged_restarts", "kills", "io_faults", "fuzz_input", "parameters", "sanitizers",
             "compilers", "tidy", "newest_python")


def interrupt(*_):
    raise KeyboardInterrupt


def main(words):
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, interrupt)  # also where a shell started this in the background
    name = words[0] if words else "list"
    if name == "list":
        for campaign in CAMPAIGNS:
            first_line = inspect.getdoc(importlib.import_module(campaign)).splitlines()[0]
            print(f"{campaign:18s} {first_line}")
        return 0
    if name not in CAMPAIGNS:
        print(f"error: there is no campaign \"{name}\"; there are {', '.join(CAMPAIGNS)}", file=sys.stderr)
        return 1
    began = time.time()
    module = importlib.import_module(name)
    try:
        report = module.campaign(short="--short" in words)
    except KeyboardInterrupt:
        report = Report.latest
        print("stopped on the way; so far:")
    print(report.text())
    print(f"{'FAILED' if report.faults else 'passed'} in {time.time() - began:.0f} s")
    return 1 if report.faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
