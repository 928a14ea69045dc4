"""Runs one point for Dakota: reads the parameters file of its `fork` interface, and writes the results file.

Dakota's formats: https://snl-dakota.github.io/docs/, "Parameters File Format" (standard and APREPRO) and "Results File
Format". A results file that begins with FAIL tells Dakota that the evaluation has failed (failure_capture).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from marked_yaml import NUMBER, StudyError, nearest, quoted_where_needed
from model_input import PathError
from point_folder import write_whole
from quantities import Value, with_unit
from study import Point, Study

VALUE, GRADIENT, HESSIAN = 1, 2, 4
APREPRO = re.compile(r"\{\s*([^\s=]+)\s*=\s*(.*?)\s*\}")
COUNTS = {"variables": "DAKOTA_VARS", "functions": "DAKOTA_FNS", "derivative_variables": "DAKOTA_DER_VARS",
          "analysis_components": "DAKOTA_AN_COMPS"}


@dataclass
class Request:
    """What Dakota asks for: values of variables, and which responses it wants (the bits of the active set vector)."""

    variables: dict[str, str]
    responses: dict[str, int]
    evaluation: str


def pairs_of(text: str) -> list[tuple[str, str]]:
    """(tag, value) of all lines, in either format. In the standard one the value stands before its tag."""
    if "{" in text:
        return [(tag, value.strip('"')) for tag, value in APREPRO.findall(text)]
    pairs = []
    for line in text.splitlines():
        value, _, tag = line.strip().rpartition(" ")
        if tag:
            name = COUNTS.get(tag, "DAKOTA_EVAL_ID" if tag == "eval_id" else tag)
            pairs.append((name, value.strip()))
    return pairs


def read_request(file: Path) -> Request:
    """Throws StudyError where the file does not have what its counts promise."""
    try:
        pairs = pairs_of(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise StudyError(f"{file}: error: the parameters file cannot be read: {error.strerror}; expected the file that "
                         "Dakota has written") from error
    counts = {tag: int(value) for tag, value in pairs if tag in COUNTS.values() and value.isdigit()}
    tags = [tag for tag, _ in pairs]
    if "DAKOTA_VARS" not in counts or "DAKOTA_FNS" not in counts:
        raise StudyError(f"{file}: error: the numbers of variables and functions are missing; expected a parameters "
                         "file of Dakota, in standard or APREPRO format")
    first = tags.index("DAKOTA_VARS") + 1
    variables = dict(pairs[first:first + counts["DAKOTA_VARS"]])
    asked = [(tag.partition(":")[2], value) for tag, value in pairs if re.match(r"ASV_\d+:", tag)]
    if tags.index("DAKOTA_FNS") != first + counts["DAKOTA_VARS"] or len(asked) != counts["DAKOTA_FNS"]:
        n_variables = tags.index("DAKOTA_FNS") - first
        raise StudyError(f"{file}: error: there are {n_variables} variables and {len(asked)} functions, but "
                         f"{counts['DAKOTA_VARS']} and {counts['DAKOTA_FNS']} are promised; expected a whole file")
    if not all(value.isdigit() for _, value in asked):
        raise StudyError(f"{file}: error: an entry of the active set is no whole number; expected 0 to 7")
    return Request(variables, {name: int(value) for name, value in asked}, dict(pairs).get("DAKOTA_EVAL_ID", ""))


def point_of(request: Request, study: Study, file: Path) -> Point:
    """The point of the study that Dakota asks for. Throws StudyError with every name that does not fit."""
    complaints = []
    known = [name for name, parameter in study.parameters.items() if not parameter.is_refinement]
    for name in request.variables:
        if name not in known:
            complaints.append(f"the variable `{name}` is no parameter of {study.file}; {nearest(name, known)}")
    complaints += [f"the parameter `{name}` of {study.file} is no variable; expected a value for each parameter"
                   for name in known if name not in request.variables]
    for name, asked in request.responses.items():
        if name not in study.results:
            complaints.append(f"the response `{name}` is no result of {study.file}; {nearest(name, study.results)}")
        if asked & (GRADIENT | HESSIAN):
            complaints.append(f"a derivative of `{name}` is asked for; expected numerical_gradients or no_gradients, "
                              "because Kerf computes values only")
    if complaints:
        raise StudyError(*(f"{file}: error: {text}" for text in complaints))
    try:
        values = {name: variable(text, study.parameters[name]) for name, text in request.variables.items()}
        return Point(values, study.settings_of(values))
    except PathError as error:
        raise StudyError(f"{file}: error: {error}") from error


def variable(text: str, parameter) -> Value:
    if NUMBER.fullmatch(text):
        return with_unit(float(text), parameter.unit)
    if parameter.unit or parameter.factor != 1.0:
        raise PathError(f"`{text}` is no number; expected a number for `{parameter.name}`")
    return Value(quoted_where_needed(text, False))


def write_results(file: Path, request: Request, results: dict[str, float]) -> None:
    write_whole(file, "".join(f"{results[name]!r} {name}\n" for name, asked in request.responses.items()
                              if asked & VALUE))


def write_failure(file: Path, reasons: list[str]) -> None:
    write_whole(file, "FAIL\n" + "".join(f"{reason}\n" for reason in reasons))
