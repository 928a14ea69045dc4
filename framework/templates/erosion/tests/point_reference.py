"""Writes point.csv: the damage of @NAME@ in uniaxial tension, in closed form.

With the logarithmic strain e = ln(1 + strain), E = 9 K G / (3 K + G) and the plastic strain ep:
    sigma = E (e - ep) = Y0 + H ep,  hence  ep = max((E e - Y0) / (E + H), 0)
The triaxiality is 1/3 all the time, so that D = (1 + 1 / (3 A)) ep.
"""

from math import log
from pathlib import Path

G, K, Y0, H, A = 80e9, 160e9, 400e6, 500e6, 0.5  # [Pa], [Pa], [Pa], [Pa], [-]
E = 9.0 * K * G / (3.0 * K + G)
RATE, STRAIN, ROWS = 1000.0, 0.2, 50  # [1/s], [-]

with open(Path(__file__).with_name("point.csv"), "w") as file:
    file.write("time_s,@NAME@_damage,effective_plastic_strain,von_mises\n")
    for row in range(1, ROWS + 1):
        strain = STRAIN * row / ROWS
        plastic = max((E * log(1.0 + strain) - Y0) / (E + H), 0.0)
        stress = E * (log(1.0 + strain) - plastic)
        values = (strain / RATE, (1.0 + 1.0 / (3.0 * A)) * plastic, plastic, stress)
        file.write(",".join(f"{value:.12e}" for value in values) + "\n")
