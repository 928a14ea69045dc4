"""The tables of a scaling study: scale.json, scale.csv, runs.csv, counts.csv, and those for the screen, with notes."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

from point_folder import DONE, write_whole
from scaling import CAUSES

FACTORS = ("global_efficiency", "parallel_efficiency", "load_balance", "communication_efficiency",
           "serialisation_efficiency", "transfer_efficiency", "computation_scaling")
OF_ROW = ("ranks", "oversubscribed", "completed", "elements", "cycles", "element_cycles", "seconds", "seconds_min",
          "seconds_max", "spread", "seconds_per_cycle", "element_cycles_per_second", "base_ranks", "speed_up",
          "efficiency", "side_by_side_seconds", "efficiency_side_by_side")
OVERSUBSCRIBED = ("on {ranks} ranks there are more ranks than the {cores} cores: times, speed-ups and factors of these "
                  "runs mean nothing; hashes and counts of messages do")
NO_SPLIT = ("communication efficiency is not split into serialisation and transfer: that takes the run time on a "
            "network whose messages take no time (kerf predict, or a trace that is replayed)")


def write_json(content: dict, output: Path) -> None:
    write_whole(output / "scale.json", json.dumps(content, indent=1, ensure_ascii=False) + "\n")


# ---- tables

def flat(row: dict) -> dict:
    """One line of scale.csv."""
    line = {name: row.get(name) for name in OF_ROW}
    line |= {name: (row.get("factors") or {}).get(name) for name in FACTORS}
    for phase, numbers in (row.get("phases") or {}).items():
        line |= {f"{name}_{phase}": numbers[name] for name in ("seconds", "work", "waiting", "imbalance")}
    model = row.get("imbalance_of_model") or {}
    line |= {f"imbalance_of_model_{name}": model.get(name) for name in ("mean", "median", "largest")}
    for kind, numbers in ((row.get("counts") or {}).get("per_cycle") or {}).items():
        line[f"cycles_{kind}"] = numbers["cycles"]
        for what in ("collectives", "messages", "bytes"):
            line |= {f"{what}_{kind}_{name}": value for name, value in numbers[what].items()}
    return line


def cell(value) -> str:
    return "" if value is None else repr(value) if isinstance(value, float) else str(value)


def write_csv(path: Path, lines: list[dict]) -> None:
    names = list(dict.fromkeys(name for line in lines for name in line))
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(names)
    for line in lines:
        table.writerow([cell(line.get(name)) for name in names])
    write_whole(path, text.getvalue())


def write_tables(content: dict, output: Path) -> None:
    write_csv(output / "scale.csv", [flat(row) for row in content["ranks"]])
    write_csv(output / "runs.csv", content["runs"])
    counted = [{"ranks": row["ranks"], **entry} for row in content["ranks"]
               for entry in (row.get("counts") or {}).get("functions", [])]
    if counted:
        write_csv(output / "counts.csv", counted)


# ---- what is shown

def shown(value, digits: int = 3) -> str:
    return "-" if value is None else f"{value:.{digits}g}" if isinstance(value, float) else str(value)


def aligned(lines: list[list[str]]) -> str:
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    return "\n".join("  ".join(word.rjust(width) for word, width in zip(line, widths)).rstrip() for line in lines)


def main_lines(content: dict) -> list[list[str]]:
    """Heading and lines of times and efficiencies."""
    lines = [["ranks", "runs", "elements", "seconds", "spread", "s/cycle", "speed-up", "efficiency", "side by side",
              "parallel", "load bal.", "comm.", "comp. scal.", "global"]]
    for row in content["ranks"]:
        f = row.get("factors") or {}
        lines.append([str(row["ranks"]) + ("*" if row["oversubscribed"] else ""),
                      str(row["completed"]), shown(row.get("elements")), shown(row.get("seconds"), 4),
                      shown(row.get("spread"), 2), shown(row.get("seconds_per_cycle")), shown(row.get("speed_up")),
                      shown(row.get("efficiency")), shown(row.get("efficiency_side_by_side")),
                      *(shown(f.get(name)) for name in ("parallel_efficiency", "load_balance",
                                                        "communication_efficiency", "computation_scaling",
                                                        "global_efficiency"))])
    return lines


def count_lines(content: dict) -> list[list[str]]:
    """Heading and lines of what is said per cycle."""
    lines = [["ranks", "cycles", "how many", "collectives mean", "median", "largest", "messages mean", "median",
              "largest", "kB mean", "median", "largest"]]
    for row in content["ranks"]:
        for kind, numbers in ((row.get("counts") or {}).get("per_cycle") or {}).items():
            words = [str(row["ranks"]), kind, str(numbers["cycles"])]
            for what, factor in (("collectives", 1.0), ("messages", 1.0), ("bytes", 1.0e-3)):
                words += [shown(None if value is None else float(value) * factor, 4)
                          for value in (numbers[what][name] for name in ("mean", "median", "largest"))]
            lines.append(words)
    return lines


def imbalance_lines(content: dict) -> list[list[str]]:
    """Heading and lines of imbalance by its causes, and of the waiting in phases."""
    lines = [["ranks", *(name.replace("_", " ") for name in CAUSES), "work model",
              *(f"waiting in {name.replace('_', ' ')}" for name in (*CAUSES, "halo"))]]
    for row in content["ranks"]:
        phases = row.get("phases") or {}
        model = row.get("imbalance_of_model") or {}
        lines.append([str(row["ranks"]), *(shown((phases.get(name) or {}).get("imbalance")) for name in CAUSES),
                      shown(model.get("mean")),
                      *(percent((phases.get(name) or {}).get("waiting_share")) for name in (*CAUSES, "halo"))])
    return lines


def percent(value) -> str:
    return "-" if value is None else f"{100.0 * value:.1f} %"


def table_text(content: dict) -> str:
    parts = [aligned(main_lines(content))]
    if len(count_lines(content)) > 1:
        parts.append("said per cycle (collective operations of one rank; messages and bytes of all)\n"
                     + aligned(count_lines(content)))
    parts.append("imbalance (largest over mean work), and waiting as a share of the time\n"
                 + aligned(imbalance_lines(content)))
    return "\n\n".join(parts)


def notes_of(content: dict) -> list[str]:
    """Sentences that a reader of the tables must know."""
    notes = []
    over = [str(row["ranks"]) for row in content["ranks"] if row["oversubscribed"]]
    if over:
        notes.append(OVERSUBSCRIBED.format(ranks=", ".join(over), cores=content["machine"].get("cores")))
    load, cores = content["machine"].get("load_average"), content["machine"].get("cores")
    most = max((row["ranks"] for row in content["ranks"]), default=1)
    if load and cores and load[1] > most + 0.5:
        notes.append(f"the machine had other work to do (a load of {load[1]:.1f} in the last five minutes): times are "
                     "not to be trusted")
    if len(content["versions"]) > 1:
        notes.append("runs were made by different versions of Kerf: " + ", ".join(content["versions"]))
    for row in content["ranks"]:
        missing = (row.get("counts") or {}).get("missing")
        if missing:
            notes.append(f"no counts of messages on {row['ranks']} ranks: {missing}")
    done = sum(run["status"] == DONE for run in content["runs"])
    notes.append(f"{done} of {len(content['runs'])} runs have completed")
    if content["hashes"]["equal"] and done:
        notes.append(f"runs of the same mesh end in the same state: {', '.join(content['hashes']['values'])}")
    if any(row["completed"] for row in content["ranks"]):
        notes.append(NO_SPLIT)
    return notes


def hash_message(content: dict, output: Path) -> list[str]:
    """Loud, for a result that depends on the number of ranks is no result."""
    lines = [f"{output / 'scale.json'}: error: STATES DIFFER: runs of the same input have ended in different states; "
             "expected the same state hash from all of them"]
    for found in content["hashes"]["differing"]:
        lines += [f"  {value}: {', '.join(names)}" for value, names in sorted(found.items())]
    return lines
