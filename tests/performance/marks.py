"""The marks that performance is held to, and the table that compares them with what was measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable

from runner import Samples


@dataclass(frozen=True)
class Mark:
    """A number to reach, on one rank of the reference machine (two cores, AVX-512) unless the text says otherwise."""

    key: str
    text: str
    unit: str
    limit: float
    at_least: bool = True
    scale: float = 1.0  # from the measured number to the unit

    def met(self, value: float) -> bool:
        shown = value * self.scale
        return shown >= self.limit if self.at_least else shown <= self.limit


MARKS = (
    Mark("bar_viscous.rate", "Taylor bar, 100 thousand elements, whole run", "M/s", 10.0, scale=1e-6),
    Mark("bar_viscous.element_phase", "the same, element phase alone", "M/s", 12.0, scale=1e-6),
    Mark("bar_stiffness.slower", "stiffness hourglass, slower by", "%", 15.0, False, 100.0),
    Mark("bar_johnson_cook.rate", "Johnson-Cook bar, whole run", "M/s", 6.0, scale=1e-6),
    Mark("rod.rate", "oblique rod, 82 thousand elements, whole run", "M/s", 7.0, scale=1e-6),
    Mark("rod.contact_share", "oblique rod, contact's share of the time", "%", 25.0, False, 100.0),
    Mark("rod_start.contact_share", "the same in its first 15 us", "%", 25.0, False, 100.0),
    Mark("rod.output_share", "oblique rod, output's share of the time", "%", 5.0, False, 100.0),
    Mark("precision.bar.element_phase", "single over double precision, bar's element phase", "x", 1.5),
    Mark("ranks.bar", "bar, two ranks over two serial runs", "%", 90.0, scale=100.0),
    Mark("ranks.rod", "rod, two ranks over two serial runs", "%", 80.0, scale=100.0),
    Mark("size.rate_ratio", "bar, rate at a million over that at 100 thousand", "%", 80.0, scale=100.0),
    Mark("size.bytes_per_element", "bar, memory at a million elements", "B/element", 700.0, False),
    Mark("size.startup", "bar, input to first cycle at a million elements", "s", 20.0, False),
    Mark("output.frame_over_copy", "a frame over copying its bytes", "x", 1.5, False),
    Mark("build.clean", "clean release build, no ccache", "s", 480.0, False),
    Mark("build.one_plugin", "one plugin touched to running binary", "s", 10.0, False),
)


def report(measured: dict[str, Samples], comparable: bool, out: Callable[[str], None]) -> list[dict]:
    """Prints the marks of what was measured; returns the same as data."""
    rows = []
    out(f"\n{'mark':<52}{'wanted':>16}{'median':>10}{'spread':>9}")
    for mark in MARKS:
        if mark.key not in measured:
            continue
        samples = measured[mark.key]
        met = mark.met(samples.median)
        wanted = f"{'>=' if mark.at_least else '<='} {mark.limit:g} {mark.unit}"
        verdict = ("" if met else "   not met") if comparable else ""
        out(f"{mark.text:<52}{wanted:>16}{samples.median * mark.scale:>10.3g}{100 * samples.spread:>7.1f} %{verdict}")
        rows.append({"key": mark.key, "text": mark.text, "unit": mark.unit, "limit": mark.limit,
                     "at_least": mark.at_least, "median": samples.median * mark.scale, "spread": samples.spread,
                     "met": met})
    if not comparable:
        out("(--quick: small models and single runs; the marks are for the full benchmark)")
    return rows
