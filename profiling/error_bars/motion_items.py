"""Moving scenes with a known value at the end of the run."""
import math

from parts import C, E, RHO, Item, bar, box, elastic, period, rk4, scene, slab

G = 9.81


def step_load(name, dynamics, **settings):
    length, pull = 0.4, 100.0
    body = {"name": "bar", "mesh": box((length, 0.05, 0.05), (16, 2, 2)), "material": "rubber", "dynamics": dynamics,
            "pin": {"box": slab(0, -length / 2)}}
    content = scene(3 * length / C, [body], {"rubber": elastic()},
                    [{"name": "end", "quantity": "motion", "body": "bar", "point": [length / 2, 0, 0]}],
                    loads=[{"kind": "traction", "body": "bar", "box": slab(0, length / 2), "traction": [pull, 0, 0]}])
    content["settings"].update(settings)
    return Item(name, content, "end.displacement_x", pull / E * length, "s L/E at the time 3L/c")


def cantilever_release():
    length, height = 0.5, 0.1
    content = bar(length, height, (10, 2, 2), 0, down=0.01)
    content["materials"]["rubber"].pop("damping")
    content["seconds"] = 0.8 * period(length, height)
    content["probe_step"] = content["seconds"] / 200
    return Item("cantilever_release", content, "tip.displacement_z", -7.529e-4, "modes of a fine mesh of quadratic elements", doubt=1e-3)


def on_wall():
    length, speed = 0.4, 0.1
    body = {"name": "bar", "mesh": box((length, 0.05, 0.05), (16, 2, 2)), "material": "rubber",
            "position": [length / 2, 0, 0], "velocity": [-speed, 0, 0], "dynamics": "explicit"}
    return Item("bar_on_wall", scene(1.5 * length / C, [body], {"rubber": elastic(mu=0)},
                                     [{"name": "bar", "quantity": "motion", "body": "bar"}],
                                     colliders=[{"name": "wall", "shape": {"plane": {"normal": [1, 0, 0]}}}]),
                "bar.velocity_x", speed / 2, "v/2 at the time 1.5 L/c")


def two_bars():
    length, speed = 0.4, 0.1
    def one(name, place, **keys):
        return {"name": name, "mesh": box((length, 0.05, 0.05), (16, 2, 2)), "material": "rubber",
                "position": [place, 0, 0], "dynamics": "explicit", **keys}
    bodies = [one("first", -length / 2, velocity=[speed, 0, 0]), one("second", length / 2)]
    return Item("two_bars", scene(3 * length / C, bodies, {"rubber": elastic(mu=0)},
                                  [{"name": "second", "quantity": "motion", "body": "second"}]),
                "second.velocity_x", speed, "v")


def hertz_impact():
    radius, nu, a = 0.05, 0.3, 0.01
    deepest, mass = a * a / radius, 4 / 3 * math.pi * radius**3 * RHO
    speed = math.sqrt(16 / 15 * E / (1 - nu * nu) * math.sqrt(radius) * deepest**2.5 / mass)
    lasts = 2.94 * deepest / speed
    ball = {"name": "ball", "mesh": {"ball": {"radius": radius, "resolution": 10}}, "material": "rubber",
            "position": [0, 0, radius], "velocity": [0, 0, -speed], "dynamics": "explicit"}
    return Item("hertz_impact", scene(0.8 * lasts, [ball], {"rubber": elastic(nu, mu=0)},
                                      [{"name": "ball", "quantity": "motion", "body": "ball"}],
                                      colliders=[{"name": "floor", "shape": {"plane": {}}}]),
                "ball.displacement_z", -deepest, "(15 m v^2/(16 E* sqrt R))^(2/5)", at="min", doubt=0.05)


def incline(name, degrees, seconds, probe, truth, formula, velocity=0.0, **keys):
    """A block on a slope that is a turned direction of gravity."""
    turn = math.radians(degrees)
    block = {"name": "block", "mesh": box((0.2, 0.2, 0.1), (4, 4, 2)), "material": "block", "position": [0, 0, 0.05],
             "velocity": [velocity, 0, 0], **keys}
    return Item(name, scene(seconds, [block], {"block": elastic(0.3, mu=0.3, damping=40)},
                            [{"name": "block", "quantity": "motion", "body": "block"},
                             {"name": "board", "quantity": "force", "body": "block", "by": "board"}],
                            settings={"gravity": [G * math.sin(turn), 0, -G * math.cos(turn)]},
                            colliders=[{"name": "board", "shape": {"plane": {}}}]), probe, truth, formula)


def inclines():
    turn = math.radians(25)
    return [incline("incline_slide", 25, 1, "block.displacement_x", G * (math.sin(turn) - 0.3 * math.cos(turn)) / 2,
                    "g (sin a - mu cos a) t^2/2"),
            incline("incline_stick", 10, 1, "board.friction_force_x", -0.2 * 0.2 * 0.1 * RHO * G * math.sin(math.radians(10)),
                    "m g sin a"),
            incline("sliding_stop", 0, 1, "block.displacement_x", 1 / (2 * 0.3 * G), "v^2/(2 mu g)", velocity=1.0,
                    dynamics="rigid")]


def ball(name, content, seconds, probe, truth, formula, radius=0.1, **keys):
    body = {"name": "ball", "shape": {"sphere": {"radius": radius}}, "material": "hard", **content}
    return Item(name, scene(seconds, [body], {"hard": {"E": 1e9, "nu": 0.3, "rho": RHO, "mu": 0.3}},
                            [{"name": "ball", "quantity": "motion", "body": "ball"}],
                            **{"settings": {"gravity": [0, 0, -G]}, **keys}), probe, truth, formula)


def balls():
    floor = {"name": "floor", "shape": {"plane": {}}}
    height, kappa, seconds = 0.5, 0.8, 1.5
    speed, left = math.sqrt(2 * G * height), seconds - math.sqrt(2 * height / G)
    while left > 2 * kappa * speed / G:
        speed *= kappa
        left -= 2 * speed / G
    bounce = kappa * speed * left - G * left**2 / 2
    start, mu = 1.0, 0.3
    until = 2 * start / (7 * mu * G)
    rolled = start * until - mu * G * until**2 / 2 + 5 / 7 * start * (1 - until)
    rate, fall = 2.0, 1.0
    return [ball("bounce", {"position": [0, 0, 0.1 + height]}, seconds, "ball.position_z", 0.1 + bounce, "parabolas",
                 colliders=[{**floor, "restitution": kappa}]),
            ball("rolling_ball", {"position": [0, 0, 0.1], "velocity": [start, 0, 0]}, 1, "ball.displacement_x", rolled,
                 "slides for 2v/(7 mu g), then rolls at 5/7 v", colliders=[floor]),
            ball("drag", {}, fall, "ball.displacement_z", -G / rate * (fall - (1 - math.exp(-rate * fall)) / rate),
                 "g/k (t - (1 - exp(-k t))/k)", loads=[{"kind": "drag", "rate": rate}])]


def oscillator():
    stiffness, mass, seconds, start = 400.0, 4 / 3 * math.pi * 0.1**3 * RHO, 2.0, 0.1
    damper = 2.0
    decay, omega = damper / (2 * mass), math.sqrt(stiffness / mass - (damper / (2 * mass))**2)
    x = start * math.exp(-decay * seconds) * (math.cos(omega * seconds) + decay / omega * math.sin(omega * seconds))
    return ball("oscillator", {"position": [1 + start, 0, 0]}, seconds, "ball.position_x", 1 + x,
                "1 m + damped vibration", settings={"gravity": [0, 0, 0]},
                springs=[{"first": {"body": "ball"}, "second": {"point": [0, 0, 0]}, "stiffness": stiffness,
                          "damping": damper, "rest_length": 1}])


def rigid_box(name, size, content, seconds, probe, truth, formula, **keys):
    body = {"name": "box", "mesh": box(size, (1, 1, 1)), "material": "hard", "dynamics": "rigid", **content}
    return Item(name, scene(seconds, [body], {"hard": {"E": 1e9, "nu": 0.3, "rho": RHO, "mu": 1}},
                            [{"name": "box", "quantity": "motion", "body": "box", **keys.pop("at", {})}],
                            **{"settings": {"gravity": [0, 0, -G]}, **keys}), probe, truth, formula)


def toppling():
    width, height, lean, seconds = 0.2, 0.6, math.radians(25), 0.5
    half = math.hypot(width, height) / 2
    alpha = math.atan2(width, height)
    rate = 3 * G / (4 * half)  # squared, about the edge
    angle, _ = rk4(lambda s: [s[1], rate * math.sin(s[0] - alpha)], [lean, 0], seconds)
    def centre(turn):  # turned about the edge at the origin
        return half * math.sin(turn - alpha), half * math.cos(turn - alpha)
    x, z = centre(lean)
    return rigid_box("toppling", (width, width, height),
                     {"position": [x, 0, z], "rotation": {"axis": [0, 1, 0], "radians": lean}}, seconds,
                     "box.position_z", centre(angle)[1], "pendulum about an edge",
                     colliders=[{"name": "floor", "shape": {"plane": {}}}])


def pendulum():
    length, thick, start, seconds = 1.0, 0.1, math.radians(120), 2.0
    inertia = (length**2 + thick**2) / 12 + length**2 / 4
    angle, _ = rk4(lambda s: [s[1], -G * length / 2 / inertia * math.sin(s[0])], [start, 0], seconds)
    return rigid_box("pendulum", (thick, thick, length),
                     {"position": [-math.sin(start) * length / 2, 0, -math.cos(start) * length / 2],
                      "rotation": {"axis": [0, 1, 0], "radians": start}},
                     seconds, "box.position_x", -math.sin(angle) * length / 2, "equation of the pendulum",
                     joints=[{"kind": "hinge", "first": "box", "point": [0, 0, 0], "axis": [0, 1, 0]}])


def wing_nut():
    size, seconds, spin = (0.3, 0.2, 0.1), 2.0, [0.05, 6.0, 0.0]
    a, b, c = ((size[1]**2 + size[2]**2) / 12, (size[0]**2 + size[2]**2) / 12, (size[0]**2 + size[1]**2) / 12)

    def rates(s):  # angular velocity in the body's axes, then the attitude as a quaternion
        p, q, r, w, x, y, z = s
        return [(b - c) / a * q * r, (c - a) / b * r * p, (a - b) / c * p * q, (-x * p - y * q - z * r) / 2,
                (w * p + y * r - z * q) / 2, (w * q + z * p - x * r) / 2, (w * r + x * q - y * p) / 2]

    *_, x, _, z = rk4(rates, [*spin, 1, 0, 0, 0], seconds)
    return rigid_box("wing_nut", size, {"angular_velocity": spin}, seconds, "box.position_y",
                     0.1 * (1 - 2 * (x * x + z * z)), "Euler's equations", settings={"gravity": [0, 0, 0]}, at={"point": [0, 0.1, 0]})


def items():
    return [step_load("bar_step_load", "explicit"), step_load("bar_step_implicit", "implicit", step_size=2e-3),
            cantilever_release(), on_wall(), two_bars(), hertz_impact(), *inclines(), *balls(), oscillator(), toppling(),
            pendulum(), wing_nut()]
