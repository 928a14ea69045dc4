"""Writes the files power_law_*.csv: power-law plasticity, with and without the rate hardening of Cowper and Symonds.

    python3 tests/data/laws/power_law.py

Needs NumPy and SciPy. The differential equations of the law are integrated by a method for stiff equations (Radau IIA
of fifth order, relative tolerance 1e-11); without rate the paths of one axis are solved as they stand, by root
finding. There is no radial return here.
"""

import json
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

HERE = Path(__file__).resolve().parent
G, K, DENSITY = 80e9, 170e9, 7850.0
YOUNG = 9 * K * G / (3 * K + G)
EDGE = 1e-3  # [m]
STEEL = {"k": 7.5e8, "n": 0.22}
LAWS = {"power_law": {**STEEL, "yield_stress": 2.6e8},
        "power_law_elastic_line": {**STEEL, "youngs_modulus": YOUNG},
        "power_law_rate": {**STEEL, "yield_stress": 2.6e8, "C": 40.4, "P": 5.0}}


class Law:
    def __init__(self, p):
        self.k, self.n, self.C, self.P = p["k"], p["n"], p.get("C"), p.get("P")
        self.start = ((p["yield_stress"] / p["k"]) ** (1 / p["n"]) if "yield_stress" in p
                      else (p["youngs_modulus"] / p["k"]) ** (1 / (p["n"] - 1)))

    def stress(self, ep):
        return self.k * (self.start + ep) ** self.n

    def slope(self, ep):
        return self.n * self.stress(ep) / (self.start + ep)

    def rate(self, q, ep):
        """Plastic strain rate of the law with rate hardening."""
        over = q / self.stress(ep) - 1
        return self.C * over**self.P if over > 0 else 0.0


class Pull:
    """The stretch of an edge whose speed is linear between given times."""

    def __init__(self, times, speeds):
        self.times, self.speeds = np.array(times, float), np.array(speeds, float)
        self.gone = np.concatenate([[0], np.cumsum(np.diff(times) * (self.speeds[1:] + self.speeds[:-1]) / 2)])

    def speed(self, t):
        return np.interp(t, self.times, self.speeds)

    def stretch(self, t):
        i = min(max(np.searchsorted(self.times, t, side="right") - 1, 0), len(self.times) - 2)
        return 1 + (self.gone[i] + (t - self.times[i]) * (self.speeds[i] + self.speed(t)) / 2) / EDGE


# A state is (deviatoric axial stress or stress of shear ..., plastic strain, specific energy). The axial deviator s
# has the equivalent 1.5 |s|. `strain(s, log_stretch)` is the deviatoric axial strain, elastic and plastic.
def lateral_is_held(s, log_stretch):
    return 2 / 3 * log_stretch


def lateral_is_free(s, log_stretch):
    # The lateral stress -s/2 - p vanishes: p = K (density ratio - 1) = -s/2, and the volume gives the lateral stretch.
    lateral = (-log_stretch - np.log(1 - s / (2 * K))) / 2
    return 2 / 3 * (log_stretch - lateral)


def pressure_of(kind, s, stretch):
    return K * (1 / stretch - 1) if kind == "strain" else -s / 2


def one_axis_without_rate(law, kind, pull, times):
    """s, ep at the times: on each piece between reversals, elastic to the yield stress and then on it."""
    strain = lateral_is_held if kind == "strain" else lateral_is_free
    reversals = [pull.times[0]]
    for t0, t1, v0, v1 in zip(pull.times, pull.times[1:], pull.speeds, pull.speeds[1:]):
        if v0 * v1 < 0:
            reversals.append(t0 + (t1 - t0) * v0 / (v0 - v1))
    reversals.append(pull.times[-1])
    values, s0, ep0, plastic0 = {}, 0.0, 0.0, 0.0
    for a, b in zip(reversals, reversals[1:]):
        sign = np.sign(pull.speed((a + b) / 2))

        def at(t):
            log_stretch = np.log(pull.stretch(t))
            elastic = brentq(lambda s: s - 2 * G * (strain(s, log_stretch) - plastic0), -1.9 * K, 1.9 * K, xtol=1e-6,
                             rtol=1e-15)
            if 1.5 * sign * elastic <= law.stress(ep0):
                return elastic, ep0, plastic0
            # s = sign Y / 1.5, and the plastic axial strain has grown by sign (ep - ep0).

            def residual(d):
                s = sign * law.stress(ep0 + d) / 1.5
                return sign * (2 * G * (strain(s, log_stretch) - plastic0 - sign * d) - s)

            d = brentq(residual, 0.0, 2.0, xtol=1e-16, rtol=1e-15)
            return sign * law.stress(ep0 + d) / 1.5, ep0 + d, plastic0 + sign * d

        for t in times:
            if a <= t <= b:
                values[t] = at(t)[:2]
        s0, ep0, plastic0 = at(b)
    return np.array([values[t] for t in times])


def one_axis_with_rate(law, kind, pull, times):
    free = kind == "stress"

    def slope(t, y):
        s, ep = y
        stretch_rate = pull.speed(t) / EDGE / pull.stretch(t)
        ep_rate = law.rate(1.5 * abs(s), ep)
        driven = 2 * G * (stretch_rate if free else 2 / 3 * stretch_rate) - 2 * G * ep_rate * np.sign(s)
        return [driven / (1 + G / (3 * K * (1 - s / (2 * K)))) if free else driven, ep_rate]

    return integrate(slope, [0.0, 0.0], pull, times)


def shear(law, pull, times):
    """a = s_xx = -s_yy and t = s_xy under the spin of simple shear, and the plastic strain."""
    def slope(time, y, flows):
        a, t, ep = y
        g = pull.speed(time) / EDGE
        q = np.sqrt(3 * (a * a + t * t))
        if law.C:
            rate = law.rate(q, ep)
        else:  # consistency: q' = 3 (a a' + t t')/q = Y'
            rate = 3 * G * t * g / (q + 1e-300) / (3 * G + law.slope(ep)) if flows else 0.0
        back = 3 * G * rate / (q + 1e-300)
        return [g * t - back * a, G * g - g * a - back * t, rate]

    if law.C:
        return integrate(lambda time, y: slope(time, y, True), [0.0, 0.0, 0.0], pull, times)
    g = pull.speed(0.0) / EDGE
    # Elastic: t = G sin(g t), a = G (1 - cos(g t)), as the Jaumann rate has it, with q = 2 sqrt(3) G sin(g t/2).
    first = 2 * np.arcsin(law.stress(0.0) / (2 * np.sqrt(3) * G)) / g
    elastic = np.array([[G * (1 - np.cos(g * t)), G * np.sin(g * t), 0.0] for t in times if t <= first])
    begin = [G * (1 - np.cos(g * first)), G * np.sin(g * first), 0.0]
    done = solve_ivp(lambda time, y: slope(time, y, True), (first, times[-1]), begin, "Radau", rtol=1e-11, atol=1e-6,
                     t_eval=[t for t in times if t > first])
    return np.vstack([elastic, done.y.T])


def integrate(slope, start, pull, times):
    """Piece by piece, so that the solver does not step over a kink."""
    y, out = np.array(start), [start]
    for a, b in zip(times, times[1:]):
        knots = [a, *[t for t in pull.times if a < t < b], b]
        for t0, t1 in zip(knots, knots[1:]):
            done = solve_ivp(slope, (t0, t1), y, "Radau", rtol=1e-11, atol=[1e-3] * (len(y) - 1) + [1e-16])
            y = done.y[:, -1]
        out.append(y)
    return np.array(out)


def energy(times, power):
    """The integral of the power between the times, by Simpson's rule: `times` are finer than the rows, in pairs."""
    h = np.diff(times)[::2]
    pieces = h / 3 * (power[:-2:2] + 4 * power[1:-1:2] + power[2::2])
    return np.concatenate([[0], np.cumsum(pieces)])


def write(name, title, law, path, columns):
    with open(HERE / f"{name}.csv", "w") as file:
        print(f"# power-law plasticity: {title}", file=file)
        parameters = {"law": "power_law", "G": G, "K": K, **law, "density": DENSITY, "eos": {"type": "linear", "K": K}}
        print("# parameters: " + json.dumps(parameters), file=file)
        print("# path: " + json.dumps(path), file=file)
        print("# yield stress k (e_y + ep)^n, times 1 + (plastic strain rate/C)^(1/P) where there are C and P",
              file=file)
        print("# stress tension positive, pressure compression positive; without bulk viscosity and inertia", file=file)
        print("# relative tolerance of the integration 1e-11; energy by Simpson's rule, 50 intervals a row", file=file)
        print(",".join(columns), file=file)
        for row in zip(*columns.values()):
            print(",".join(f"{v:.11g}" for v in row), file=file)


def axis_path(name, law, kind, pull, rows):
    fine = np.linspace(0, pull.times[-1], 50 * rows + 1)
    solve = one_axis_with_rate if law.get("C") else one_axis_without_rate
    s, ep = solve(Law(law), kind, pull, fine).T
    stretch = np.array([pull.stretch(t) for t in fine])
    p = pressure_of(kind, s, stretch)
    # Held sides do no work, and free ones have no stress: the axial stress times area and stretch rate is the power.
    density_ratio = p / K + 1
    power = (s - p) * pull.speed(fine) / EDGE / stretch / (DENSITY * density_ratio)
    # The power jumps at no row, but has kinks; 50 intervals a row make them small.
    work = energy(fine, power)[::25]
    at = slice(None, None, 50)
    columns = {"time_s": fine[at], "stretch_axial": stretch[at], "density_kg_m3": DENSITY * density_ratio[at],
               "specific_energy_J_kg": work, "pressure_Pa": p[at], "stress_xx_Pa": (s - p)[at],
               "von_mises_Pa": 1.5 * np.abs(s[at]), "effective_plastic_strain": ep[at]}
    if kind == "strain":
        columns |= {"stress_yy_Pa": (-s / 2 - p)[at], "stress_zz_Pa": (-s / 2 - p)[at]}
    path = {"kind": kind, "edge_m": EDGE, "end_s": pull.times[-1], "velocity_times_s": list(pull.times),
            "velocities_m_per_s": list(pull.speeds)}
    write(f"{name}_uniaxial_{kind}", f"uniaxial {kind}", law, path, columns)


def shear_path(name, law, pull, rows):
    fine = np.linspace(0, pull.times[-1], 50 * rows + 1)
    a, t, ep = shear(Law(law), pull, fine).T
    work = energy(fine, t * pull.speed(fine) / EDGE / DENSITY)[::25]
    at = slice(None, None, 50)
    columns = {"time_s": fine[at], "shear": np.array([pull.stretch(x) - 1 for x in fine[at]]),
               "specific_energy_J_kg": work, "stress_xx_Pa": a[at], "stress_yy_Pa": -a[at], "stress_xy_Pa": t[at],
               "von_mises_Pa": np.sqrt(3 * (a * a + t * t))[at], "effective_plastic_strain": ep[at]}
    path = {"kind": "shear", "edge_m": EDGE, "end_s": pull.times[-1], "velocity_times_s": list(pull.times),
            "velocities_m_per_s": list(pull.speeds)}
    write(f"{name}_shear", "simple shear", law, path, columns)


if __name__ == "__main__":
    for name, law in LAWS.items():
        axis_path(name, law, "strain", Pull([0, 4e-6, 4.2e-6, 1.2e-5, 1.22e-5, 1.6e-5],
                                            [-20, -20, 20, 20, -20, -20]), 160)
        axis_path(name, law, "stress", Pull([0, 1.6e-5, 1.64e-5, 4e-5], [10, 10, -10, -10]), 200)
        shear_path(name, law, Pull([0, 2e-5], [100, 100]), 100)
