"""What a timing needs to know about the machine: processor, cores, governor, turbo. What cannot be read is None."""

from __future__ import annotations

import os
import platform
import re
from pathlib import Path

CPUS = Path("/sys/devices/system/cpu")


def read_word(path: Path) -> str | None:
    try:
        return path.read_text(encoding="utf-8").strip() or None
    except OSError:
        return None


def processor() -> str | None:
    found = re.search(r"^model name\s*:\s*(.+)$", read_word(Path("/proc/cpuinfo")) or "", re.M)
    return found.group(1) if found else platform.processor() or None


def turbo() -> str | None:
    """"on" or "off"."""
    no_turbo = read_word(CPUS / "intel_pstate" / "no_turbo")
    if no_turbo is not None:
        return "off" if no_turbo == "1" else "on"
    boost = read_word(CPUS / "cpufreq" / "boost")
    return None if boost is None else "on" if boost == "1" else "off"


def machine_facts() -> dict:
    return {"cpu": processor(), "cores": len(os.sched_getaffinity(0)), "cores_of_machine": os.cpu_count(),
            "governor": read_word(CPUS / "cpu0" / "cpufreq" / "scaling_governor"), "turbo": turbo(),
            "load_average": list(os.getloadavg())}
