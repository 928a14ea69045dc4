"""Writes point_compression.csv and point_tension.csv: the closed form of @NAME@ along volumetric paths.

All axes are strained alike, from 0 to `strain` in time: v = (1 + strain)^3.
    p = B (exp((1 - v)/C) - 1)
    energy per mass = integral of p d(1 - v) / rho0 = (B C (exp((1 - v)/C) - 1) - B (1 - v)) / rho0
"""

from math import expm1
from pathlib import Path

B, C, DENSITY = 299.6e6, 0.1368, 997.0  # [Pa], [-], [kg/m3]
RATE, ROWS = 1e4, 50  # [1/s]

for name, strain in (("compression", -0.07), ("tension", 0.01)):
    with open(Path(__file__).with_name(f"point_{name}.csv"), "w") as file:
        file.write("time_s,pressure,specific_energy\n")
        for row in range(1, ROWS + 1):
            share = row / ROWS
            compression = 1.0 - (1.0 + share * strain) ** 3
            p = B * expm1(compression / C)
            energy = (C * p - B * compression) / DENSITY
            file.write(f"{share * abs(strain) / RATE:.12e},{p:.12e},{energy:.12e}\n")
