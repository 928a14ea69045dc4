"""Fits to the table of a study: the ballistic limit after Recht and Ipson, and orders of convergence."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np


class Refused(Exception):
    """Why a fit has no answer, in a sentence."""


# ---- ballistic limit

LEAST_LIMIT = 1e-3  # of the slowest perforating speed: what is less says that the points determine none


@dataclass
class BallisticLimit:
    """v_r = a (v_s^p - v_bl^p)^(1/p). R. F. Recht & T. W. Ipson, "Ballistic perforation dynamics", J. Appl. Mech. 30
    (1963) 384-390, where p = 2 and a follows from the masses; J. P. Lambert & G. H. Jonas, "Towards standardization in
    terminal ballistics: velocity representation", BRL R-1852 (1976), where a and p are fitted."""

    a: float
    limit: float  # v_bl [m/s]
    p: float
    intervals: dict[str, tuple[float, float] | None]  # None: fixed, or as many unknowns as points
    confidence: float
    n_perforating: int
    rms: float  # of the residual speeds [m/s]
    notes: list[str]

    def __call__(self, striking):
        return lambert_jonas(np.asarray(striking, dtype=float), self.a, self.limit, self.p)


def lambert_jonas(striking, a, limit, p):
    # As a ratio: powers of speeds themselves leave the range of doubles when p is large.
    ratio = np.clip(limit / striking, 0.0, 1.0)
    return a * striking * (1.0 - ratio**p) ** (1.0 / p)


def start_of_fit(striking, residual, a, p) -> tuple[float, float]:
    """(a, v_bl) of the straight line v_r^p = a^p v_s^p - a^p v_bl^p."""
    x, y = striking**p, residual**p
    slope = a**p if a is not None else (np.polyfit(x, y, 1)[0] if np.ptp(x) > 0.0 else 1.0)
    slope = slope if slope > 0.0 else 1.0
    inner = float(np.mean(x - y / slope))
    return slope ** (1.0 / p), max(inner, 0.0) ** (1.0 / p)


def fit_ballistic_limit(striking, residual, p: float | None = 2.0, a: float | None = None,
                        confidence: float = 0.95) -> BallisticLimit:
    """Least squares over the residual speeds of the perforating points. `None` makes p or a free. Throws Refused."""
    from scipy.optimize import OptimizeWarning, curve_fit

    striking, residual = np.asarray(striking, dtype=float), np.asarray(residual, dtype=float)
    through = residual > 0.0
    v, r = striking[through], residual[through]
    unknowns = ["limit", *(["a"] if a is None else []), *(["p"] if p is None else [])]
    if np.any(v <= 0.0):
        raise Refused("a perforating point has a striking speed of zero or less; expected speeds above zero")
    if v.size < 2:
        raise Refused(f"there {'is' if v.size == 1 else 'are'} {v.size or 'no'} perforating point"
                      f"{'' if v.size == 1 else 's'}; expected two or more with a residual speed above zero")
    if np.unique(v).size < len(unknowns):
        raise Refused(f"{np.unique(v).size} perforating speeds cannot give {len(unknowns)} unknowns "
                      f"({', '.join(unknowns)}); expected more points, or a fixed p or a")
    first_a, first_limit = start_of_fit(v, r, a, p or 2.0)
    most = float(v.min()) * (1.0 - 1.0e-9)
    bounds = {"limit": (0.0, most), "a": (1.0e-3, 10.0), "p": (0.5, 20.0)}
    start = {"limit": min(max(first_limit, 0.05 * most), 0.999 * most), "a": min(max(first_a, 0.01), 5.0), "p": 2.0}

    def model(speed, *values):
        found = dict(zip(unknowns, values))
        return lambert_jonas(speed, found.get("a", a), found["limit"], found.get("p", p))

    scales = {"limit": most, "a": 1.0, "p": 1.0}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", OptimizeWarning)  # of its covariance: standard_errors() looks by itself
            best, _ = curve_fit(model, v, r, [start[n] for n in unknowns], x_scale=[scales[n] for n in unknowns],
                                bounds=tuple(zip(*(bounds[n] for n in unknowns))), xtol=1e-14, ftol=1e-14, gtol=1e-14,
                                max_nfev=20000)
    except RuntimeError as error:
        raise Refused(f"the fit does not converge ({error}); expected points that follow the relation") from error
    found = dict(zip(unknowns, map(float, best)))
    if found["limit"] <= LEAST_LIMIT * v.min():
        raise Refused("the residual speeds do not fall off towards a limit: the best fit has a limit of zero; "
                      "expected points near the limit, or results without mistakes")
    return ballistic_answer(found, unknowns, bounds, (striking, residual), a, p, confidence)


def standard_errors(found, unknowns, v, r, a, p) -> dict[str, float]:
    """Of each unknown, from the derivatives at the best fit; infinite where the points do not determine it."""
    values = {"limit": found["limit"], "a": found.get("a", a), "p": found.get("p", p)}
    columns = []
    for name in unknowns:  # each in units of its value
        above, below = ({**values, name: values[name] * (1.0 + side)} for side in (1e-5, -1e-5))
        columns.append((lambert_jonas(v, **above) - lambert_jonas(v, **below)) / 2e-5)
    jacobian = np.column_stack(columns)
    rms = np.linalg.norm(lambert_jonas(v, **values) - r) / math.sqrt(max(v.size - len(unknowns), 1))
    _, singular, axes = np.linalg.svd(jacobian, full_matrices=False)
    if singular[-1] <= 1e-8 * singular[0]:
        return dict.fromkeys(unknowns, math.inf)
    return {name: float(rms * np.linalg.norm(axes[:, i] / singular) * values[name]) for i, name in enumerate(unknowns)}


def ballistic_answer(found, unknowns, bounds, points, a, p, confidence) -> BallisticLimit:
    from scipy.stats import t

    striking, residual = points
    through = residual > 0.0
    free = int(through.sum()) - len(unknowns)
    notes, intervals = [], {}
    at_bounds = [n for n in unknowns if min(abs(found[n] - b) for b in bounds[n]) <= 1e-6 * max(1.0, abs(found[n]))]
    if at_bounds:
        notes.append(f"{', '.join(at_bounds)} ended at the bound of what was searched: these points do not "
                     "determine it")
    errors = standard_errors(found, unknowns, striking[through], residual[through], a, p)
    widths = {name: errors[name] * t.ppf(0.5 + confidence / 2.0, free) if free > 0 else math.inf for name in unknowns}
    wide = [name for name in unknowns if not widths[name] < found[name]]
    for name in unknowns:
        known = free > 0 and not at_bounds and not wide
        intervals[name] = (found[name] - widths[name], found[name] + widths[name]) if known else None
    if wide and free > 0 and not at_bounds:
        notes.append(f"{', '.join(wide)}: the interval is wider than the value: these points do not determine "
                     f"{'it' if len(wide) == 1 else 'them'}")
    if free == 0:
        notes.append("as many unknowns as perforating points: no interval of confidence")
    answer = BallisticLimit(float(found.get("a", a)), float(found["limit"]), float(found.get("p", p)), intervals,
                            confidence, int(through.sum()), 0.0, notes)
    answer.rms = float(np.sqrt(np.mean((answer(striking[through]) - residual[through]) ** 2)))
    if not through.all() and striking[~through].max() > answer.limit:
        notes.append(f"a point stopped at {striking[~through].max():g} m/s, which is above the fitted limit")
    if answer.a > 1.0:
        notes.append("a is above 1, which no mass of a plug explains")
    return answer


# ---- convergence

FORMAL_ORDER = 2.0  # of elements with linear fields, and of central differences
# Of the index where the observed order is above the formal one. W. L. Oberkampf & C. J. Roy, "Verification and
# validation in scientific computing", Cambridge University Press (2010), section 8.7.
CAREFUL_SAFETY = 3.0


@dataclass
class Triplet:
    """Three meshes, the finest first, and what they say about convergence. P. J. Roache, "Perspective: a method for
    uniform reporting of grid refinement studies", J. Fluids Engng 116 (1994) 405-413; for ratios of sizes that differ,
    I. B. Celik et al., J. Fluids Engng 130 (2008) 078001."""

    sizes: tuple[float, float, float]
    values: tuple[float, float, float]
    behaviour: str  # monotone, oscillating, diverging, unchanged
    order: float | None = None
    extrapolated: float | None = None
    index_fine: float | None = None  # grid convergence index of the finest mesh, a share of its value; none of zero
    index_middle: float | None = None

    def sentence(self) -> str:
        if self.behaviour == "monotone":
            meshes = ((self.index_fine, "finest mesh"), (self.index_middle, "next"))
            indices = ", ".join(f"none ({mesh}, whose result is 0)" if index is None else
                                f"{100.0 * index:.3g} % ({mesh})" for index, mesh in meshes)
            told = (f"monotone: observed order {self.order:.3g}, extrapolated {self.extrapolated:.6g}, grid "
                    f"convergence index {indices}")
            if self.order > 1.1 * FORMAL_ORDER:
                told += (f"; an order above that of the method, {FORMAL_ORDER:g}, says that the meshes are not fine "
                         f"enough for an order to be seen: the index is taken with {FORMAL_ORDER:g} and a factor of "
                         f"{CAREFUL_SAFETY:g}")
            return told
        return {"oscillating": "not monotone: the results go up and down as the cells get smaller; no order is given",
                "diverging": "not converging: the differences do not shrink with the cells; no order is given",
                "unchanged": "the results of two meshes are the same number; no order is given"}[self.behaviour]


def order_of(coarse_over_fine: float, r_fine: float, r_coarse: float) -> float:
    """The order p for which (f3 - f2) / (f2 - f1) = r21^p (r32^p - 1) / (r21^p - 1)."""
    from scipy.optimize import brentq

    def difference(p):
        return (r_fine**p * math.expm1(p * math.log(r_coarse)) / math.expm1(p * math.log(r_fine))) - coarse_over_fine

    highest = 1.0
    while difference(highest) < 0.0:
        highest *= 2.0
        if highest > 200.0:
            raise Refused("the differences shrink faster than any order explains; expected results that differ by more "
                          "than round-off")
    return brentq(difference, 1e-9, highest, xtol=1e-12)


def examine(sizes, values, safety: float) -> Triplet:
    """Pre: sizes ascend."""
    h1, h2, h3 = sizes
    f1, f2, f3 = values
    found = Triplet(tuple(sizes), tuple(values), "monotone")
    fine, coarse = f2 - f1, f3 - f2
    if fine == 0.0 or coarse == 0.0:
        found.behaviour = "unchanged"
    elif coarse / fine < 0.0:
        found.behaviour = "oscillating"
    elif coarse / fine <= math.log(h3 / h2) / math.log(h2 / h1) * (1.0 + 1e-9):
        found.behaviour = "diverging"  # the ratio of an order of zero, and less
    if found.behaviour != "monotone":
        return found
    found.order = order_of(coarse / fine, h2 / h1, h3 / h2)
    found.extrapolated = f1 - fine / ((h2 / h1) ** found.order - 1.0)
    if found.order > 1.1 * FORMAL_ORDER:
        safety = max(safety, CAREFUL_SAFETY)
    order = min(found.order, FORMAL_ORDER)
    found.index_fine = safety * abs(fine / f1) / ((h2 / h1) ** order - 1.0) if f1 else None
    found.index_middle = safety * abs(coarse / f2) / ((h3 / h2) ** order - 1.0) if f2 else None
    return found


def convergence(sizes, values, safety: float = 1.25) -> list[Triplet]:
    """All triplets of neighbouring meshes, that of the finest first. Throws Refused."""
    pairs = sorted(zip(map(float, sizes), map(float, values)))
    ordered = [size for size, _ in pairs]
    if len(pairs) < 3:
        raise Refused(f"there are {len(pairs)} meshes; expected three or more")
    if len(set(ordered)) < len(ordered):
        raise Refused("two points have the same size of cells; expected one point per size, or `by` to tell them apart")
    if ordered[0] <= 0.0:
        raise Refused(f"a size of cells is {ordered[0]:g}; expected more than zero")
    return [examine(ordered[i:i + 3], [value for _, value in pairs[i:i + 3]], safety) for i in range(len(pairs) - 2)]
