"""Scenes that settle to a state with known values. Damping brings them to rest, as in an ordinary scene."""
import math

from parts import (E, PERIODS, RHO, Item, bar, box, drag, elastic, hollow_octant, hollow_quarter,
                   quarter_disc, quarter_plate_with_hole, rk4, roller, root, scene, slab, tapered_panel)

FINE = "fine mesh of quadratic elements"


def neo_hookean_stress(nu, stretches):
    """Nominal stress along the first of three principal axes (stable neo-Hookean; Smith, de Goes, Kim 2018) [Pa]"""
    mu, lame = 2 / 3 * E / (1 + nu), E * nu / ((1 + nu) * (1 - 2 * nu)) + 5 / 12 * E / (1 + nu)
    x, y, z = stretches
    return mu * (1 - 1 / (x * x + y * y + z * z + 1)) * x + (lame * (x * y * z - 1) - 0.75 * mu) * y * z


def tension():
    length, pull, nu = 0.4, 0.3 * E, 0.3

    def side(x):  # lateral stretch that leaves the sides free of stress
        return root(lambda y: neo_hookean_stress(nu, (y, y, x)), 0.3, 2)

    stretch = root(lambda x: neo_hookean_stress(nu, (x, side(x), side(x))) - pull, 1, 2)
    body = {"name": "bar", "mesh": box((length, 0.1, 0.1), (8, 2, 2)), "material": "rubber",
            "pin": [roller(0, -length / 2), roller(1, -0.05), roller(2, -0.05)]}
    load = {"kind": "traction", "body": "bar", "box": slab(0, length / 2), "traction": [pull, 0, 0]}
    return Item("bar_tension", scene(0.9, [body], {"rubber": elastic(nu, model="stable_neo_hookean")},
                                     [{"name": "end", "quantity": "motion", "body": "bar", "point": [length / 2, 0, 0]}],
                                     loads=[load, drag(0.16)]),
                "end.displacement_x", length * (stretch - 1), "uniaxial tension of the stable neo-Hookean law")


def hanging():
    length, g = 0.8, 9.81
    body = {"name": "bar", "mesh": box((0.1, 0.1, length), (2, 2, 16)), "material": "rubber",
            "pin": [roller(2, length / 2), roller(0, -0.05), roller(1, -0.05)]}
    probes = [{"name": "end", "quantity": "motion", "body": "bar", "point": [0, 0, -length / 2]},
              {"name": "all", "quantity": "stress", "body": "bar"}]
    content = scene(0.9, [body], {"rubber": elastic()}, probes, settings={"gravity": [0, 0, -g]},
                    loads=[drag(0.32)])
    return [Item("hanging_bar", content, "end.displacement_z", -RHO * g * length**2 / (2 * E), "rho g L^2/(2E)"),
            Item("hanging_bar_stress", content, "all.largest_principal", RHO * g * length, "rho g L")]


def cantilevers():
    """Bars with one held end, loaded at the other end or by their weight."""
    return [Item(name, content, "tip.displacement_z", known, FINE, doubt=doubt) for name, content, known, doubt in [
        ("cantilever_end", bar(0.5, 0.1, (10, 2, 2), 1.0, element="linear"), 5.085e-4, 3e-4),
        ("cantilever_weight", bar(0.5, 0.1, (10, 2, 2), 0, nu=0.45, down=0.01), -9.405e-4, 1e-3),
        ("cantilever_slender", bar(1.2, 0.1, (24, 2, 2), 0.1, element="linear", dynamics="implicit"), 6.909e-4, 3e-4),
        ("cantilever_one_layer", bar(0.5, 0.05, (10, 2, 1), 0.1, nu=0.49, width=0.1, element="linear"), 1.942e-4, 2e-3),
        ("cantilever_thick", bar(0.2, 0.1, (6, 3, 3), 10, element="edge_smoothed"), 3.6744e-4, 3e-4)]]


def circular_plate():
    radius, thickness, pressure = 0.1, 0.02, 1.0
    time = 0.1
    body = {"name": "plate", "mesh": {"file": "quarter_disc.msh"}, "material": "rubber",
            "pin": [{"set": "rim"}, roller(0, 0), roller(1, 0)]}
    content = scene(PERIODS * time, [body], {"rubber": elastic(0.3)},
                    [{"name": "centre", "quantity": "motion", "body": "plate", "point": [0, 0, 0]}],
                    loads=[{"kind": "traction", "body": "plate", "set": "top", "traction": [0, 0, -pressure]}, drag(time)])
    return Item("circular_plate", content, "centre.displacement_z", -2.4905e-5, FINE, doubt=5e-4,
                meshes={"quarter_disc.msh": quarter_disc(radius, thickness, 6, 2)})


def square_plate():
    size, thickness, time = 0.2, 0.02, 0.84
    edges = [{"box": {"lower": [at - 1e-6 if axis == 0 else -1, at - 1e-6 if axis == 1 else -1, -thickness / 2 - 1e-6],
                      "upper": [at + 1e-6 if axis == 0 else 1, at + 1e-6 if axis == 1 else 1, -thickness / 2 + 1e-6]},
              "axes": ["z"]} for axis in range(2) for at in (size / 2,)]
    body = {"name": "plate", "mesh": box((size, size, thickness), (10, 10, 2)), "material": "rubber",
            "pin": [*edges, roller(0, -size / 2), roller(1, -size / 2)]}
    content = scene(PERIODS * time, [body], {"rubber": elastic(0.3)},
                    [{"name": "centre", "quantity": "motion", "body": "plate", "point": [-size / 2, -size / 2, 0]}],
                    loads=[{"kind": "traction", "body": "plate", "box": slab(2, thickness / 2),
                            "traction": [0, 0, -0.1]}, drag(time)])
    return Item("square_plate", content, "centre.displacement_z", -1.5002e-4, FINE, doubt=5e-4)


def shaft():
    radius, length, angle, nu, turning = 0.05, 0.4, 0.01, 0.3, 0.5
    keys = [{"time": turning * k / 20,
             "rotation": {"axis": [0, 0, 1], "radians": angle * (k / 20)**2 * (3 - 2 * k / 20)}} for k in range(21)]
    body = {"name": "shaft", "mesh": {"cylinder": {"radius": radius, "height": length, "resolution": 4}},
            "material": "rubber", "pin": [{"box": slab(2, -length / 2)}, {"box": slab(2, length / 2),
                                                                         "motion": {"keys": keys}}]}
    return Item("shaft", scene(1.2, [body], {"rubber": elastic(nu, damping=100)},
                               [{"name": "clamp", "quantity": "reaction", "body": "shaft", "pin": 0}]),
                "clamp.moment_z", -E / (2 * (1 + nu)) * math.pi * radius**4 / 2 * angle / length,
                "G pi R^4/2 theta/L")


def hollow_sphere():
    a, b, p, nu = 0.1, 0.2, 1.0, 0.3
    octant = {"name": "sphere", "mesh": {"file": "hollow_octant.msh"}, "material": "rubber",
              "pin": [roller(axis, 0) for axis in range(3)]}
    content = scene(0.25, [octant], {"rubber": elastic(nu)},
                    [{"name": "inside", "quantity": "motion", "body": "sphere", "point": [a, 0, 0]},
                     {"name": "all", "quantity": "stress", "body": "sphere"}],
                    cavities=[{"body": "sphere", "set": "inside", "pressure": p}], loads=[drag(0.08)])
    meshes = {"hollow_octant.msh": hollow_octant(a, b, 4, 4)}
    moved = p * a**3 / (E * (b**3 - a**3)) * ((1 - 2 * nu) * a + (1 + nu) * b**3 / (2 * a**2))
    hoop = p * a**3 / (b**3 - a**3) * (1 + b**3 / (2 * a**3))
    return [Item("hollow_sphere", content, "inside.displacement_x", moved, "Lame", meshes=meshes),
            Item("hollow_sphere_stress", content, "all.largest_principal", hoop, "Lame", meshes=meshes)]


def hollow_cylinder():
    a, b, p, nu, height = 0.1, 0.2, 1.0, 0.4, 0.025
    ring = {"name": "ring", "mesh": {"file": "hollow_quarter.msh"}, "material": "rubber",
            "pin": [roller(0, 0), roller(1, 0), roller(2, 0), roller(2, height)]}
    content = scene(0.3, [ring], {"rubber": elastic(nu)},
                    [{"name": "inside", "quantity": "motion", "body": "ring", "point": [a, 0, 0]}],
                    cavities=[{"body": "ring", "set": "inside", "pressure": p}], loads=[drag(0.1)])
    moved = (1 + nu) * p * a**2 / (E * (b**2 - a**2)) * ((1 - 2 * nu) * a + b**2 / a)
    return Item("hollow_cylinder", content, "inside.displacement_x", moved, "Lame",
                meshes={"hollow_quarter.msh": hollow_quarter(a, b, height, 6, 4)})


def cook():
    panel = {"name": "panel", "mesh": {"file": "panel.msh"}, "material": "rubber", "pin": {"box": slab(0, 0)},
             "element": "linear"}
    width, thickness = 0.48, 0.08
    content = scene(1.6, [panel], {"rubber": elastic(0.3, damping=25)},
                    [{"name": "corner", "quantity": "motion", "body": "panel", "point": [width, 0.6, thickness / 2]}],
                    loads=[{"kind": "traction", "body": "panel", "set": "right", "traction": [0, 10, 0]}])
    return Item("cook", content, "corner.displacement_y", 4.006e-4, FINE, doubt=1.5e-3,
                meshes={"panel.msh": tapered_panel(width, thickness, (8, 8, 2))})


def twisted_bar():
    length, width, turning = 1, 0.2, 2
    keys = [{"time": turning * k / 40,
             "rotation": {"axis": [1, 0, 0], "radians": math.pi * (k / 40)**2 * (3 - 2 * k / 40)}} for k in range(41)]
    body = {"name": "bar", "mesh": box((length, width, width), (15, 3, 3)), "material": "rubber",
            "pin": [{"box": slab(0, -length / 2)}, {"box": slab(0, length / 2), "motion": {"keys": keys}}]}
    return Item("twisted_bar", scene(2.6, [body], {"rubber": elastic(0.45, damping=30, model="stable_neo_hookean")},
                                     [{"name": "energy", "quantity": "energy"}]),
                "energy.elastic", 39.0, FINE, doubt=0.002)


def punch():
    width, height, size, depth, lowering = 1, 0.5, 0.5, 1e-3, 0.2
    keys = [{"time": lowering * k / 20, "position": [0, 0, -depth * (k / 20)**2 * (3 - 2 * k / 20)]} for k in range(21)]
    edge = size / 2 + 1e-6
    body = {"name": "block", "mesh": box((width, width, height), (8, 8, 4)), "material": "rubber",
            "pin": [{"box": slab(2, -height / 2)},
                    {"box": {"lower": [-edge, -edge, height / 2 - 1e-6], "upper": [edge, edge, height / 2 + 1e-6]},
                     "motion": {"keys": keys}}]}
    return Item("punch", scene(0.8, [body], {"rubber": elastic(0.3, E=1e6, damping=100)},
                               [{"name": "punch", "quantity": "reaction", "body": "block", "pin": 1}]),
                "punch.force_z", -2.075 * 1e6 * size * depth, FINE, doubt=0.002)


def two_layers():
    length, height, shear = 1, 0.1, 0.01
    content = bar(length, height, (20, 2, 2), shear, modulus=1e4)
    stiff = elastic(0.3, E=1e6, damping=2.4)
    content["materials"] = {"rubber": elastic(0.3, E=1e4, damping=2.4), "plastic": stiff}
    content["bodies"][0].update(
        sets={"upper": {"box": {"lower": [-1, -1, -1e-6], "upper": [1, 1, 1]}}}, materials={"upper": "plastic"})
    content["seconds"] = 10
    content["probe_step"] = 0.05
    return Item("two_layers", content, "tip.displacement_z", 282.6 * shear * height * height / (1e4 * height),
                FINE, doubt=0.002)


def elastica():
    length, height = 1.0, 0.05
    load = 2 * E * height**2 / 12 / length**2  # shear stress at the end: P L^2 = 2 E I [Pa]
    content = bar(length, height, (40, 2, 2), load, nu=0, model="stable_neo_hookean")

    def end(slope):  # turn and height of the end, by shooting along the bar from the clamp with a given curvature
        return rk4(lambda s: [s[1], -2 * math.cos(s[0]), math.sin(s[0])], [0, slope, 0], 1, 2000)

    slope = root(lambda k: end(k)[1], 0, 4)
    return Item("elastica", content, "tip.displacement_z", length * end(slope)[2],
                "elastica with P L^2 = 2 E I, without shear and stretch", doubt=0.004)


def plastic_bar():
    length, yield_stress, hardening, time = 0.4, 5e3, 2e4, 6.0
    stretch = 0.12
    keys = [{"time": time * k / 20, "position": [stretch * length * (k / 20)**2 * (3 - 2 * k / 20), 0, 0]}
            for k in range(21)]
    body = {"name": "bar", "mesh": box((length, 0.1, 0.1), (4, 1, 1)), "material": "metal",
            "pin": [roller(0, -length / 2), roller(1, -0.05), roller(2, -0.05),
                    {"box": slab(0, length / 2), "axes": ["x"], "motion": {"keys": keys}}]}
    metal = elastic(0.3, model="hencky", damping=40, plasticity={"yield_stress": yield_stress, "hardening": hardening})
    strain = math.log(1 + stretch)
    stress = root(lambda s: s / E + (s - yield_stress) / hardening - strain, yield_stress, E)
    plastic = (stress - yield_stress) / hardening
    return Item("plastic_bar", scene(7, [body], {"metal": metal},
                                     [{"name": "end", "quantity": "reaction", "body": "bar", "pin": 3}]),
                "end.force_x", 0.01 * stress * math.exp(-stress / E - plastic), "A s exp(-s/E - p)")


def balloon():
    a, b, p, nu = 0.1, 0.15, 6e3, 0.45

    def outside(wide):
        """Radial stress at the outer surface, for a hoop stretch `wide` of the inner one. Equation: d(R^2 S)/dR = 2 R H,
        with the nominal radial and hoop stress S and H."""
        h, steps = (b - a) / 100, 100
        r, q = wide * a, -p * wide**2 * a**2  # present radius, R^2 S

        def rates(at, r, q):
            hoop = r / at
            radial = root(lambda x: neo_hookean_stress(nu, (x, hoop, hoop)) - q / at**2, 0.2, 3)
            return radial, 2 * at * neo_hookean_stress(nu, (hoop, hoop, radial))

        for n in range(steps):
            at = a + n * h
            k1 = rates(at, r, q)
            k2 = rates(at + h / 2, r + h / 2 * k1[0], q + h / 2 * k1[1])
            r, q = r + h * k2[0], q + h * k2[1]
        return q

    wide = root(outside, 1.0, 1.3)
    octant = {"name": "balloon", "mesh": {"file": "balloon.msh"}, "material": "rubber",
              "pin": [roller(axis, 0) for axis in range(3)]}
    content = scene(0.3, [octant], {"rubber": elastic(nu, model="stable_neo_hookean")},
                    [{"name": "inside", "quantity": "motion", "body": "balloon", "point": [a, 0, 0]}],
                    cavities=[{"body": "balloon", "set": "inside", "pressure": p}], loads=[drag(0.1)])
    return Item("balloon", content, "inside.displacement_x", a * (wide - 1),
                "thick sphere of the stable neo-Hookean law", meshes={"balloon.msh": hollow_octant(a, b, 4, 3)})


def plate_with_hole():
    radius, half, thickness, pull = 0.02, 0.1, 0.01, 1e2
    body = {"name": "plate", "mesh": {"file": "plate_with_hole.msh"}, "material": "rubber",
            "pin": [roller(0, 0), roller(1, 0), roller(2, 0), roller(2, thickness)]}
    content = scene(0.15, [body], {"rubber": elastic(0.3)},
                    [{"name": "all", "quantity": "stress", "body": "plate"}],
                    loads=[{"kind": "traction", "body": "plate", "box": slab(0, half), "traction": [pull, 0, 0]}, drag(0.05)])
    return Item("plate_with_hole", content, "all.largest_principal", 336.0, FINE, doubt=3e-4,
                meshes={"plate_with_hole.msh": quarter_plate_with_hole(radius, half, thickness, 8, 6)})


def spinning_bar():
    length, omega = 0.4, 5.0
    body = {"name": "bar", "mesh": box((length, 0.05, 0.05), (16, 2, 2)), "material": "rubber",
            "angular_velocity": [0, 0, omega]}
    return Item("spinning_bar", scene(1.0, [body], {"rubber": elastic(damping=60, model="corotational")},
                                      [{"name": "all", "quantity": "stress", "body": "bar"}]),
                "all.largest_principal", RHO * omega**2 * (length / 2)**2 / 2, "rho omega^2 L^2/2", doubt=0.02)


def block_on_floor():
    size, g = 0.2, 9.81
    body = {"name": "block", "mesh": box((size, size, size), (4, 4, 4)), "material": "rubber",
            "position": [0, 0, size / 2]}
    return Item("block_on_floor", scene(1.0, [body], {"rubber": elastic(damping=100, mu=0)},
                                        [{"name": "top", "quantity": "motion", "body": "block",
                                          "point": [0, 0, size / 2]}],
                                        settings={"gravity": [0, 0, -g]},
                                        colliders=[{"name": "floor", "shape": {"plane": {}}}]),
                "top.displacement_z", -RHO * g * size**2 / (2 * E), "rho g H^2/(2E)")


def hertz_press():
    radius, nu, a = 0.05, 0.3, 0.01
    reduced = E / (1 - nu * nu)
    force = 4 / 3 * reduced * a**3 / radius
    # The force of the other plate moves the pole outwards (Tatara 1991).
    square = a * a + 4 * radius * radius
    f = 2 * (1 + nu) * radius**2 / square**1.5 + (1 - nu * nu) / math.sqrt(square)
    depth = a * a / radius - f * force / (math.pi * E)
    lowering = 0.5
    keys = [{"time": lowering * k / 20, "position": [0, 0, 2 * radius - 2 * depth * (k / 20)**2 * (3 - 2 * k / 20)]}
            for k in range(21)]
    body = {"name": "ball", "mesh": {"ball": {"radius": radius, "resolution": 10}}, "material": "rubber",
            "position": [0, 0, radius]}
    plates = [{"name": "floor", "shape": {"plane": {}}},
              {"name": "plate", "shape": {"plane": {"normal": [0, 0, -1]}}, "position": [0, 0, 2 * radius],
               "motion": {"keys": keys}}]
    return Item("hertz_press", scene(1.2, [body], {"rubber": elastic(nu, damping=300, mu=0)},
                                     [{"name": "floor", "quantity": "force", "body": "ball", "by": "floor"}],
                                     colliders=plates),
                "floor.force_z", force, "4/3 E* a^3/R, approach after Tatara 1991", doubt=0.02)


def items():
    return [tension(), *hanging(), *cantilevers(), circular_plate(), square_plate(), shaft(), *hollow_sphere(),
            hollow_cylinder(), cook(), twisted_bar(), punch(), two_layers(), elastica(), plastic_bar(), balloon(),
            plate_with_hole(), spinning_bar(), block_on_floor(), hertz_press()]
