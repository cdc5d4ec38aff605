"""Scenes with known values that played no part in the choice of the rules of studies and estimates."""
import dataclasses
import math

from motion_items import G, ball
from parts import C, E, RHO, CellMesh, Item, bar, box, critical, drag, elastic, period, roller, scene, slab


def confined_column():
    """A column that cannot widen, under its weight. Its lower end is shorter by the share e, which raises the Cauchy
    stress of the linear law on the sides."""
    length, width, nu, g = 0.4, 0.1, 0.3, 9.81
    modulus = E * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    shorter = RHO * g * length / modulus
    body = {"name": "column", "mesh": box((width, width, length), (2, 2, 8)), "material": "rubber",
            "pin": [roller(2, -length / 2), *(roller(axis, at) for axis in range(2) for at in (-width / 2, width / 2))]}
    content = scene(0.6, [body], {"rubber": elastic(nu)},
                    [{"name": "top", "quantity": "motion", "body": "column", "point": [0, 0, length / 2]},
                     {"name": "all", "quantity": "stress", "body": "column"}],
                    settings={"gravity": [0, 0, -g]}, loads=[drag(0.14)])
    return [Item("confined_column", content, "top.displacement_z", -RHO * g * length**2 / (2 * modulus),
                 "rho g L^2/(2M)"),
            Item("confined_column_stress", content, "all.largest_von_mises",
                 RHO * g * length * (1 - nu / ((1 - nu) * (1 - shorter))),
                 "rho g L (1 - nu/((1 - nu)(1 - e))), e = rho g L/M")]


def short_beam():
    length, height, load = 0.4, 0.1, 1.0
    return Item("short_beam", bar(length, height, (8, 2, 2), load, nu=0), "tip.displacement_z",
                load * height**2 * (length**3 / (E * height**4 / 4) + 1.2 * length / (E / 2 * height**2)), "Timoshenko",
                doubt=5e-3)


def clamped_beam():
    length, height, g = 0.8, 0.1, 0.05
    content = bar(length, height, (16, 2, 2), 0, nu=0, down=g)
    content["bodies"][0]["pin"] = [{"box": slab(0, -length / 2)}, {"box": slab(0, length / 2)}]
    time = period(length, height) * (1.8751 / 4.73)**2
    content["materials"]["rubber"]["damping"] = critical(time)
    content["probes"][0].update(name="middle", point=[0, 0, 0])
    weight = RHO * height**2 * g
    return Item("clamped_beam", content, "middle.displacement_z",
                -weight * length**2 * (length**2 / (384 * E * height**4 / 12) + 1.2 / (8 * E / 2 * height**2)),
                "Timoshenko", doubt=5e-3)


def tapered_rod():
    length, thick, thin, pull = 0.8, 0.1, 0.05, 100.0

    def place(u, v, w):
        side = thick + (thin - thick) * u
        return length * u, side * (v - 0.5), side * (w - 0.5)

    mesh = CellMesh()
    mesh.grid((12, 2, 2), place, end=[(0, 1)])
    body = {"name": "rod", "mesh": {"file": "rod.msh"}, "material": "rubber", "pin": {"box": slab(0, 0)}}
    content = scene(1.2, [body], {"rubber": elastic()},
                    [{"name": "end", "quantity": "motion", "body": "rod", "point": [length, 0, 0]}],
                    loads=[{"kind": "traction", "body": "rod", "set": "end", "traction": [pull, 0, 0]}, drag(0.32)])
    return Item("tapered_rod", content, "end.displacement_x", pull * thin * length / (E * thick), "P L/(E a b)",
                doubt=5e-3, meshes={"rod.msh": mesh.gmsh()})


def stack_of_two():
    size, g = 0.2, 9.81
    bodies = [{"name": name, "mesh": box((size, size, size), (3, 3, 3)), "material": "rubber", "position": [0, 0, at]}
              for name, at in (("lower", size / 2), ("upper", 3 * size / 2))]
    return Item("stack_of_two", scene(1.5, bodies, {"rubber": elastic(damping=100, mu=0.5)},
                                      [{"name": "top", "quantity": "motion", "body": "upper",
                                        "point": [0, 0, size / 2]}],
                                      settings={"gravity": [0, 0, -g]},
                                      colliders=[{"name": "floor", "shape": {"plane": {}}}]),
                "top.displacement_z", -RHO * g * (2 * size)**2 / (2 * E), "rho g H^2/(2E)")


def bar_caught():
    """A moving bar one end of which is stopped at once."""
    length, speed = 0.4, 0.1
    body = {"name": "bar", "mesh": box((length, 0.05, 0.05), (16, 2, 2)), "material": "rubber",
            "velocity": [speed, 0, 0], "dynamics": "explicit", "pin": {"box": slab(0, -length / 2)}}
    return Item("bar_caught", scene(1.5 * length / C, [body], {"rubber": elastic()},
                                    [{"name": "end", "quantity": "motion", "body": "bar",
                                      "point": [length / 2, 0, 0]}]),
                "end.displacement_x", speed * length / (2 * C), "v L/(2c) at the time 1.5 L/c")


def balls():
    slope, seconds, push, lift = math.radians(20), 1.0, 3.0, 4.0
    stiffness, mass = 200.0, 4 / 3 * math.pi * 0.1**3 * RHO
    turn = math.sqrt(stiffness / mass) * seconds
    return [ball("rolling_down", {"position": [0, 0, 0.1]}, seconds, "ball.displacement_x",
                 5 / 14 * G * math.sin(slope) * seconds**2, "5/14 g sin a t^2",
                 settings={"gravity": [G * math.sin(slope), 0, -G * math.cos(slope)]},
                 colliders=[{"name": "floor", "shape": {"plane": {}}}]),
            ball("throw", {"velocity": [push, 0, lift]}, seconds, "ball.displacement_z",
                 lift * seconds - G * seconds**2 / 2, "v t - g t^2/2"),
            ball("spring_drop", {"position": [0, 0, -1]}, seconds, "ball.displacement_z",
                 -mass * G / stiffness * (1 - math.cos(turn)), "m g/k (1 - cos(w t))",
                 springs=[{"first": {"body": "ball"}, "second": {"point": [0, 0, 0]}, "stiffness": stiffness,
                           "rest_length": 1}])]


def items():
    """All scenes of this file; the first five settle."""
    settled = [*confined_column(), short_beam(), clamped_beam(), tapered_rod(), stack_of_two()]
    return [*(dataclasses.replace(item, at_rest=True) for item in settled), bar_caught(), *balls()]
