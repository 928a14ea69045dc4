"""Writes point.csv: @NAME@ in uniaxial strain, in closed form.

The axis is strained from 0 to -0.1 in time, the others are held; e = -ln(1 + strain) is the logarithmic compression.
    p = K e,  q = min(2 G e, c + m K e),  ep = (2 G e - q) / (3 G)
The return scales the deviator, so it stays in the ratio of -2/3 q along the axis to 1/3 q across.
"""

from math import log
from pathlib import Path

G, K, C, M = 60e6, 200e6, 50e3, 0.4  # [Pa], [Pa], [Pa], [-]
END, ROWS = 1e-3, 50  # [s]

with open(Path(__file__).with_name("point.csv"), "w") as file:
    file.write("time_s,pressure,von_mises,effective_plastic_strain,stress_xx,stress_yy\n")
    for row in range(1, ROWS + 1):
        e = -log(1.0 - 0.1 * row / ROWS)
        p, q = K * e, min(2.0 * G * e, C + M * K * e)
        values = (END * row / ROWS, p, q, (2.0 * G * e - q) / (3.0 * G), -p - 2.0 / 3.0 * q, -p + 1.0 / 3.0 * q)
        file.write(",".join(f"{value:.12e}" for value in values) + "\n")
