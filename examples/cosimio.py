"""A tank of water and a wall on a spring as two programs coupled by Kratos' CoSimIO.

    python3 cosimio.py water & python3 cosimio.py wall

The water is libmps'; the wall, 10 kg on a spring of 211.8 kN/m, stands for a code of yours, which needs no libmps. It is
released 1 mm off its rest. In every step the water sends its force on the wall and receives the wall's mean acceleration,
until both agree (mps/experimental/coupling.h, the program of docs/coupling.md). The wall prints its angular frequency beside that of
potential flow. SPDX-License-Identifier: BSD-3-Clause
"""
import math
import sys

import CoSimIO

LENGTH, DEPTH, SPACING, DT, END = 0.6, 0.3, 0.02, 5e-4, 0.35  # m, m, m, s, s
TRY, ACCEPT, STOP = 0.0, 1.0, 2.0  # what the water asks for


class Connection:
    """Vectors of numbers to and from the other program."""

    def __init__(self, name, other):
        info = CoSimIO.Info()
        info.SetString("my_name", name)
        info.SetString("connect_to", other)
        info.SetString("communication_format", "pipe")  # sockets are slow with so small messages
        info.SetInt("echo_level", 0)
        self.name = CoSimIO.Connect(info).GetString("connection_name")

    def _info(self, identifier=None):
        info = CoSimIO.Info()
        info.SetString("connection_name", self.name)
        if identifier:
            info.SetString("identifier", identifier)
        return info

    def send(self, identifier, values):
        CoSimIO.ExportData(self._info(identifier), CoSimIO.DoubleVector(list(values)))

    def receive(self, identifier):
        values = CoSimIO.DoubleVector()
        CoSimIO.ImportData(self._info(identifier), values)
        return [float(v) for v in values]

    def close(self):
        CoSimIO.Disconnect(self._info())


def run_water():
    import libmps as mps

    mps.default_context(threads=1)
    particles = mps.Particles(spacing=SPACING)
    particles.fill_box([0, 0], [LENGTH, DEPTH])
    fluid = mps.Fluid(particles)
    fluid.add_boundary(point=[0, 0, 0], normal=[0, 1, 0])
    fluid.add_boundary(point=[0, 0, 0], normal=[1, 0, 0])
    wall = fluid.add_boundary(point=[LENGTH, 0, 0], normal=[-1, 0, 0])
    both = mps.Coupling(size=1, method="aitken", floor=1e-3)
    other = Connection("water", "wall")
    velocity = 0.0  # of the wall, into the water
    while fluid.time < END:
        fluid.begin_step(DT)
        mean = both.begin()  # what both must agree on: the wall's mean acceleration over the step
        done = False
        while not done:
            fluid.set_boundary_motion(wall, velocity=[velocity + DT * mean[0]])
            fluid.solve_pressure()
            other.send("force", [TRY, -fluid.get_reaction(wall).force[0]])
            mean, done = both.next(other.receive("acceleration"))
        both.accept()
        fluid.end_step()
        velocity += DT * mean[0]
        other.send("force", [ACCEPT, mean[0]])
    report = both.report
    print(f"water: {report.steps} steps, {report.all_repeats / report.steps:.1f} solutions each")
    other.send("force", [STOP, 0.0])
    other.close()


def run_wall():
    mass, stiffness, off = 10.0, 211800.0, 1e-3  # kg, N/m, m
    still = 0.5 * 1000.0 * 9.81 * DEPTH**2  # N: the spring is at rest under still water
    d = v = t = 0.0
    passes = []  # rising passes of the rest
    other = Connection("wall", "water")
    while True:
        what, value = other.receive("force")
        if what == STOP:
            break
        if what == TRY:
            spring = stiffness * (d + 0.5 * DT * v + off)
            other.send("acceleration", [(still - value - spring) / (mass + 0.25 * stiffness * DT**2)])
            continue
        before = d
        d += DT * (v + 0.5 * DT * value)
        v += DT * value
        t += DT
        if before < -off <= d:
            passes.append(t - DT * (d + off) / (d - before))
    other.close()
    omega = 2.0 * math.pi * (len(passes) - 1) / (passes[-1] - passes[0])
    print(f"wall: omega {omega:.2f} rad/s, potential flow 60.37")


if __name__ == "__main__":
    roles = {"water": run_water, "wall": run_wall}
    if len(sys.argv) != 2 or sys.argv[1] not in roles:
        sys.exit("usage: cosimio.py water | wall")
    roles[sys.argv[1]]()
