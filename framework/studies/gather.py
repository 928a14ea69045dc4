"""Makes the table of a study from the folders of its points: parameters, results, and what cannot be trusted."""

from __future__ import annotations

import csv
import io
import json
import math
import sys
from dataclasses import dataclass, field
from pathlib import Path

from marked_yaml import nearest
from point_folder import DONE, PointFolder, State, write_whole
from study import Result, Study

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "post"))


class NoResult(Exception):
    """Why a result has no value."""


@dataclass
class Row:
    folder: PointFolder
    state: State
    results: dict[str, float | None] = field(default_factory=dict)
    flags: list[str] = field(default_factory=list)
    reasons: list[str] = field(default_factory=list)  # a sentence for each flag

    @property
    def trust(self) -> str:
        """`yes`; `look`: it has warnings that one must read; `no`."""
        if not self.flags:
            return "yes"
        return "look" if set(self.flags) <= {"warnings", "versions", "hourglass"} else "no"

    def flag(self, name: str, reason: str) -> None:
        if name not in self.flags:
            self.flags.append(name)
        self.reasons.append(reason)

    def number(self, name: str) -> float | None:
        """A parameter's or a result's number."""
        value = self.folder.point.values.get(name)
        return self.results.get(name) if value is None else value.number


def look_up(value, path: str):
    """What stands at a path in a summary. Keys may have dots of their own: measures.rod.speed. Throws NoResult."""
    steps = path.replace("[", ".").replace("]", "").split(".")

    def inside(value, steps, done):
        if not steps:
            return value
        if isinstance(value, list) and steps[0].isdigit() and int(steps[0]) < len(value):
            return inside(value[int(steps[0])], steps[1:], f"{done}[{steps[0]}]")
        if isinstance(value, dict):
            for length in range(len(steps), 0, -1):
                key = ".".join(steps[:length])
                if key in value:
                    return inside(value[key], steps[length:], f"{done}.{key}".lstrip("."))
        names = list(value) if isinstance(value, dict) else []
        raise NoResult(f"summary.json has no `{path}`" + (f" in `{done}`" if done else "") + "; "
                       + nearest(".".join(steps), names))

    return inside(value, steps, "")


def from_summary(result: Result, summary: dict) -> float:
    value = look_up(summary, result.path)
    if value is None:
        short = result.path.removeprefix("measures.").removeprefix("observers.")
        why = (summary.get("not_measured") or {}).get(short, "it has no value")
        raise NoResult(f"`{result.path}` is null: {why}")
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise NoResult(f"`{result.path}` is no number; expected the path of a single number")
    return float(value)


def from_column(result: Result, folder: Path) -> float:
    import numpy as np
    from results import ResultsError, read_history, read_observers

    try:
        if result.observer:
            observers = read_observers(folder / "history.h5")
            if result.observer not in observers:
                raise NoResult(f"history.h5 has no observer `{result.observer}`; "
                               + nearest(result.observer, observers))
            columns = observers[result.observer]
        else:
            columns = read_history(folder / "history.csv")
    except ResultsError as error:
        raise NoResult(str(error)) from error
    if result.column not in columns:
        raise NoResult(f"there is no column `{result.column}`; {nearest(result.column, columns)}")
    values = np.asarray(columns[result.column], dtype=float).ravel()
    if result.take != "last":
        values = values[np.isfinite(values)]  # a gauge whose element has eroded writes NaN
    if values.size == 0 or not np.isfinite(values[-1]):
        raise NoResult(f"the column `{result.column}` ends without a value")
    return float({"last": values[-1], "max": values.max(), "min": values.min()}[result.take])


def row_of(folder: PointFolder, study: Study) -> Row:
    row = Row(folder, folder.state())
    if row.state.status != DONE:
        row.flag(row.state.status, row.state.message or "this point was not run yet")
        row.results = dict.fromkeys(study.results)
        return row
    summary = row.state.summary
    for name, result in study.results.items():
        try:
            value = from_summary(result, summary) if result.path else from_column(result, folder.path)
            row.results[name] = value * result.factor
        except NoResult as error:
            row.results[name] = None
            row.flag("no_result", f"{name}: {error}")
    flag_balances(row, summary, study)
    warnings = summary.get("warnings") or []
    if warnings:
        row.flag("warnings", f"{len(warnings)} warnings of the run: " + " ".join(map(str, warnings)))
    return row


def flag_balances(row: Row, summary: dict, study: Study) -> None:
    error = summary.get("energy", {}).get("balance_error")
    if not is_within(error, study.limits.balance_error):
        row.flag("energy_balance", f"the energy balance is off by {error}; the limit is {study.limits.balance_error}")
    share = summary.get("hourglass", {}).get("share")
    if not is_within(share, study.limits.hourglass_share):
        row.flag("hourglass", f"the share of hourglass control is {share}; the limit is "
                 f"{study.limits.hourglass_share}")
    mass = summary.get("mass", {}).get("initial") or math.inf
    let_go = summary.get("contact_let_go", {}).get("mass", 0.0) / mass
    if not is_within(let_go, study.limits.let_go_mass):
        row.flag("let_go", f"contact has let go of {let_go:.3g} of the mass; the limit is {study.limits.let_go_mass}")


def is_within(value, limit: float) -> bool:
    """A number that is missing or no number is not within any limit."""
    return isinstance(value, (int, float)) and abs(value) <= limit


def flag_versions(rows: list[Row]) -> None:
    versions = {row.state.summary.get("kerf_version") for row in rows if row.state.status == DONE}
    if len(versions) > 1:
        for row in rows:
            if row.state.status == DONE:
                row.flag("versions", "points of this study were computed by different versions of Kerf: "
                         + ", ".join(sorted(map(str, versions))))


def gather(folders: list[PointFolder], study: Study) -> list[Row]:
    rows = [row_of(folder, study) for folder in folders]
    flag_versions(rows)
    return rows


# ---- files

OF_RUN = ("cycles", "end_time", "wall_seconds", "kerf_version", "ranks")


def as_records(rows: list[Row], study: Study) -> list[dict]:
    records = []
    for row in rows:
        summary = row.state.summary or {}
        values = row.folder.point.values
        records.append({
            "point": row.folder.name,
            "parameters": {n: v.text if v.number is None else v.number for n, v in values.items()},
            "results": row.results, "trust": row.trust, "flags": row.flags, "reasons": row.reasons,
            "exit": row.state.exit or row.state.status, "exit_code": row.state.exit_code,
            "state_hash": summary.get("state_hash"), "warnings": len(summary.get("warnings") or []),
            "message": row.state.message, **{name: summary.get(name) for name in OF_RUN},
            "settings": row.folder.point.settings})
    return records


def headings(study: Study) -> dict[str, str]:
    return {name: f"{name} [{p.unit}]" if p.unit else name for name, p in study.parameters.items()}


def write_tables(rows: list[Row], study: Study, output: Path) -> None:
    records = as_records(rows, study)
    text = {"title": study.title, "study": str(study.file), "input": str(study.input.file),
            "units": {name: p.unit for name, p in study.parameters.items()}, "points": records}
    write_whole(output / "table.json", json.dumps(text, indent=1, ensure_ascii=False) + "\n")
    named = headings(study)
    rest = ["trust", "flags", "exit", "exit_code", "state_hash", "warnings", *OF_RUN, "message"]
    lines = io.StringIO()
    table = csv.writer(lines, lineterminator="\n")
    table.writerow(["point", *named.values(), *study.results, *rest])
    for record in records:
        cells = [record["point"], *(record["parameters"].get(name) for name in named),
                 *(record["results"].get(name) for name in study.results),
                 *(" ".join(record[name]) if name == "flags" else record[name] for name in rest)]
        table.writerow(["" if cell is None else repr(cell) if isinstance(cell, float) else cell for cell in cells])
    write_whole(output / "table.csv", lines.getvalue())


def shown(value) -> str:
    return "-" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)


def table_text(rows: list[Row], study: Study) -> str:
    """The table for the screen."""
    names = headings(study)
    lines = [[*names.values(), *study.results, "exit", "code", "warnings", "trust", "state hash"]]
    for record in as_records(rows, study):
        lines.append([*(shown(record["parameters"].get(n)) for n in names),
                      *(shown(record["results"].get(n)) for n in study.results),
                      record["exit"][:24], shown(record["exit_code"]), shown(record["warnings"]),
                      record["trust"] + (f" ({' '.join(record['flags'])})" if record["flags"] else ""),
                      (record["state_hash"] or "-")[:10]])
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)
