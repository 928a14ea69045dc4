"""Measures the LogGP parameters of the way between two ranks: compiles measure_network.c, runs it, fits its times."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

SOURCE = Path(__file__).resolve().parent / "measure_network.c"


class MeasurementError(Exception):
    """Why there is no measurement, and what to do."""


def fit(rows: np.ndarray) -> dict[str, float]:
    """The parameters from the columns bytes, round trip, round trip of a burst, messages of a burst, send, receive.

    A round trip of one message takes 2 (o_s + L + o_r + s (G + 2 O)); each further message of a burst adds the greatest
    of what the sender, the receiver and the card do for it.
    """
    size, one, many, burst, sending, receiving = rows.T

    def line(values) -> tuple[float, float]:
        """The value of the smallest message, and the growth per byte from there."""
        more, longer = values - values[0], size - size[0]
        return max(float(values[0]), 0.0), max(float(longer @ more / (longer @ longer)), 0.0)

    send_overhead, send_copy = line(sending)
    receive_overhead, receive_copy = line(receiving)
    gap = line((many - one) / (burst - 1.0))[0]
    per_byte = line(0.5 * one)[1]
    # The processors copy each byte twice, once on either side. What is left of the way of a byte is the network's.
    copying = min(0.5 * (send_copy + receive_copy), 0.5 * per_byte)
    latency = max(0.5 * float(one[0]) - send_overhead - receive_overhead, 0.0)
    return {"latency": latency, "send_overhead": send_overhead, "receive_overhead": receive_overhead,
            # A gap below the overhead of the processor cannot be seen, and does not matter.
            "gap": gap if gap > max(send_overhead, receive_overhead) else 0.0,
            "gap_per_byte": per_byte - 2.0 * copying, "overhead_per_byte": copying}


def times_of(mpirun_options: list[str], repeats: int) -> np.ndarray:
    """Runs the program on two ranks. Of an option `--name=value`, mpirun wants two words."""
    words = [word for option in mpirun_options
             for word in (option.split("=", 1) if option.startswith("--") else [option])]
    for tool in ("mpicc", "mpirun"):
        if shutil.which(tool) is None:
            raise MeasurementError(f"{tool} is not in the path; expected an installation of MPI with its compiler")
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "measure_network"
        commands = (["mpicc", "-O2", "-o", str(program), str(SOURCE)],
                    ["mpirun", *words, "-n", "2", str(program), str(repeats)])
        for command in commands:
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                raise MeasurementError(f"{' '.join(command)} ended with code {done.returncode}:\n{done.stderr[-2000:]}")
    return np.array([[float(word) for word in line.split()] for line in done.stdout.splitlines()])


def describe(found: dict[str, float], name: str) -> str:
    """The description of a network whose ranks are all as far apart as the two that were measured."""
    source = "measured by kerf predict --measure-network: undisturbed round trips of 1 to 3072 bytes, two ranks"
    lines = [f"name: {name}", "ranks_per_node: 1", "between:"]
    lines += [f"  {key}: {{value: {value:.4e}, source: \"{source}\"}}" for key, value in found.items()]
    return "\n".join([*lines, ""])


def measure(file: Path, mpirun_options: list[str], repeats: int = 2000) -> dict[str, float]:
    """Measures, and writes the description to a file."""
    found = fit(times_of(mpirun_options, repeats))
    file.write_text(describe(found, f"measured network {file.stem}"))
    return found
