"""Writes point.csv: @NAME@ in uniaxial strain, by a Runge-Kutta integration that shares no code with the plugin.

The axis is strained at the true rate D = r / (1 + r t), the others are held: the equivalent strain grows by 2/3 D.
    q' = 3 G (2/3 D - ep'),  eta ep' = max(q - Y0 - H ep, 0),  p = K (1 / (1 + r t) - 1)
"""

from pathlib import Path

G, Y0, H, ETA, K = 80e9, 350e6, 500e6, 5e3, 160e9  # [Pa], [Pa], [Pa], [Pa s], [Pa]
RATE, END, STEPS, ROWS = 1e4, 2e-6, 200_000, 40  # [1/s], [s]


def slopes(time, q, plastic):
    rate = max(q - Y0 - H * plastic, 0.0) / ETA
    return 3.0 * G * (2.0 / 3.0 * RATE / (1.0 + RATE * time) - rate), rate


def main():
    rows, q, plastic, dt = [], 0.0, 0.0, END / STEPS
    for step in range(STEPS):
        t = step * dt
        a = slopes(t, q, plastic)
        b = slopes(t + dt / 2, q + dt / 2 * a[0], plastic + dt / 2 * a[1])
        c = slopes(t + dt / 2, q + dt / 2 * b[0], plastic + dt / 2 * b[1])
        d = slopes(t + dt, q + dt * c[0], plastic + dt * c[1])
        q += dt / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
        plastic += dt / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
        if (step + 1) % (STEPS // ROWS) == 0:
            t = (step + 1) * dt
            rows.append((t, q, plastic, slopes(t, q, plastic)[1], K * (1.0 / (1.0 + RATE * t) - 1.0)))
    with open(Path(__file__).with_name("point.csv"), "w") as file:
        file.write("time_s,von_mises,effective_plastic_strain,plastic_strain_rate,pressure\n")
        for row in rows:
            file.write(",".join(f"{value:.9e}" for value in row) + "\n")


main()
