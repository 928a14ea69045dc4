"""Numbers with units as an input file writes them: single values, vectors and lists. Nothing is converted here."""

from __future__ import annotations

import re
from dataclasses import dataclass

from marked_yaml import NUMBER

UNIT = r"(?:1\s*/\s*)?[A-Za-z°µμ%Ω'\"][^\[\],]*"
QUANTITY = re.compile(rf"({NUMBER.pattern})\s*({UNIT})?")
VECTOR = re.compile(rf"\[?\s*({NUMBER.pattern}(?:(?:\s*,\s*|\s+){NUMBER.pattern})+)\s*\]?\s*({UNIT})?")


@dataclass(frozen=True)
class Value:
    """What one parameter is at one point: its text, and its number and unit where it is a number."""

    text: str
    number: float | None = None
    unit: str = ""


def value_of(text: str) -> Value:
    match = QUANTITY.fullmatch(text.strip())
    if not match:
        return Value(text)
    return Value(text, float(match.group(1)), (match.group(2) or "").strip())


def number_text(number: float) -> str:
    """The shortest text that reads back as the same number; whole numbers stay whole."""
    return str(int(number)) if float(number).is_integer() and abs(number) < 1e15 else repr(float(number))


def with_unit(number: float, unit: str) -> Value:
    return Value(f"{number_text(number)} {unit}".strip(), number, unit)


def components(text: str) -> list[str] | None:
    """The components of a vector, each with its unit: "[0, 1] mm" and "0 1 mm" give ["0 mm", "1 mm"]. None for what is
    no vector. A list in YAML, [1 mm, 2 mm], is a vector, too."""
    text = text.strip()
    match = VECTOR.fullmatch(text)
    if match and text.startswith("[") == ("]" in text):
        unit = (match.group(2) or "").strip()
        return [f"{number} {unit}".strip() for number in re.split(r"\s*,\s*|\s+", match.group(1))]
    if text.startswith("[") and text.endswith("]"):
        parts = [part.strip().strip("\"'") for part in text[1:-1].split(",")]
        if parts and all(QUANTITY.fullmatch(part) for part in parts):
            return parts
    return None


def vector_text(parts: list[str], single: bool) -> str:
    """The text of a vector: "[0, 1] mm" where all components share a unit. With `single`, for a place that takes no
    list in YAML: "0 1"."""
    values = [value_of(part) for part in parts]
    units = {value.unit for value in values if value.unit or value.number != 0.0}
    if len(units) > 1 or any(value.number is None for value in values):
        return "[" + ", ".join(parts) + "]"
    unit = units.pop() if units else ""
    numbers = [part.removesuffix(value.unit).strip() for part, value in zip(parts, values)]
    if unit:
        return "[" + ", ".join(numbers) + f"] {unit}"
    return " ".join(numbers) if single else "[" + ", ".join(numbers) + "]"


def scaled(text: str, factor: float, whole: bool, single: bool = False) -> str | None:
    """All numbers of a value times a factor, units kept. None where it is no number or vector of numbers, or where
    whole numbers are asked for and the products are not whole."""
    parts = components(text) or [text]
    made = []
    for part in parts:
        value = value_of(part)
        if value.number is None:
            return None
        product = value.number * factor
        if whole and (abs(product - round(product)) > 1e-9 * abs(product) or round(product) < 1):
            return None
        made.append(with_unit(round(product) if whole else product, value.unit).text)
    return made[0] if components(text) is None else vector_text(made, single)
