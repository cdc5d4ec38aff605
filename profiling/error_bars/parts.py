"""Parts of the scenes with known solutions: items, bars, and meshes of cells that are mapped to curved shapes."""
import dataclasses
import itertools
import math
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "scenes" / "meshes"))
from node_mesh import NodeMesh  # noqa: E402

E, RHO = 1e5, 1000.0  # Young's modulus [Pa] and density [kg/m^3] of most items
C = math.sqrt(E / RHO)  # speed of waves along a bar [m/s]
PERIODS = 2.5  # after 2.5 periods with critical damping less than 1e-5 of the way to rest is left


@dataclasses.dataclass
class Item:
    """A scene with one known value."""
    name: str
    scene: dict
    probe: str  # PROBE.QUANTITY, a column of the series
    truth: float  # known value of the column; NaN for a quantity that has none
    formula: str
    at: str = "end"  # value at the end of the run; "min" or "max": least or largest value
    doubt: float = 0  # relative error of the known value
    at_rest: bool = False  # whether the end of the run is a state of rest
    verdict: str = ""  # the only right verdict of the study, for a quantity without a known value
    meshes: dict = dataclasses.field(default_factory=dict)  # content of mesh files by name


def elastic(nu=0.0, **keys):
    """A lossless material, linear by default."""
    return {"E": E, "nu": nu, "rho": RHO, "loss_factor": 0, "model": "linear", **keys}


def slab(axis, at, size=10.0, width=1e-6):
    """A box that contains the plane where the coordinate `axis` is `at`."""
    lower, upper = [-size] * 3, [size] * 3
    lower[axis], upper[axis] = at - width, at + width
    return {"lower": lower, "upper": upper}


def roller(axis, at):
    """A pin that holds the nodes of a plane along its normal."""
    return {"box": slab(axis, at), "axes": ["xyz"[axis]]}


def scene(seconds, bodies, materials, probes, **keys):
    """A scene without gravity unless `keys` has settings."""
    return {"seconds": seconds, "frame_step": seconds / 100, "materials": materials, "bodies": bodies,
            "probes": probes, "settings": {"gravity": [0, 0, 0]}, **keys}


def box(size, cells):
    return {"box": {"size": list(size), "cells": list(cells)}}


def period(length, height, modulus=E):
    """First period of bending of a bar with one held end [s]"""
    return 2 * math.pi * math.sqrt(12) * length**2 / (1.8751**2 * height * math.sqrt(modulus / RHO))


def critical(time):
    """Material damping that lets a vibration of a given period settle fastest [1/s]"""
    return 4 * math.pi / time


def drag(time):
    """Critical damping of the whole motion. The damping of a material leaves out rigid motion, which rollers allow."""
    return {"kind": "drag", "rate": critical(time)}


def bar(length, height, cells, load, *, nu=0.3, modulus=E, down=0.0, model="linear", width=None, **keys):
    """A bar along x, held at x = -length/2. `load` is a shear stress on its end, `down` an acceleration along -z.
    `keys` are keys of the body."""
    time = period(length, height, modulus)
    body = {"name": "bar", "mesh": box((length, width or height, height), cells), "material": "rubber",
            "pin": {"box": slab(0, -length / 2)}, **keys}
    load = {"kind": "traction", "body": "bar", "box": slab(0, length / 2), "traction": [0, 0, load]}
    forces = {"settings": {"gravity": [0, 0, -down]}} if down else {"loads": [load]}
    return scene((PERIODS + 2 * height / length) * time, [body],
                 {"rubber": elastic(nu, E=modulus, damping=critical(time), model=model)},
                 [{"name": "tip", "quantity": "motion", "body": "bar", "point": [length / 2, 0, 0]}], **forces)


def rk4(rate, state, seconds, steps=2000):
    """State after some seconds of the motion d state/dt = rate(state)."""
    h = seconds / steps
    for _ in range(steps):
        k1 = rate(state)
        k2 = rate([s + h / 2 * k for s, k in zip(state, k1)])
        k3 = rate([s + h / 2 * k for s, k in zip(state, k2)])
        k4 = rate([s + h * k for s, k in zip(state, k3)])
        state = [s + h / 6 * (a + 2 * b + 2 * c + d) for s, a, b, c, d in zip(state, k1, k2, k3, k4)]
    return state


def root(function, low, high):
    """Root of a function that changes its sign between low and high, by bisection."""
    sign = function(low) > 0
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if (function(middle) > 0) == sign else (low, middle)
    return (low + high) / 2


class CellMesh(NodeMesh):
    """Cells of a grid, each of six tetrahedra. Nodes at the same place are one."""

    def node_at(self, point):
        return self.node(tuple(round(c * 1e9) for c in point), point)

    def grid(self, counts, place, **groups):
        """Adds nx * ny * nz cells. `place` maps the unit cube. A group NAME = [(axis, side), ...] contains the faces at
        these sides of the cube, with side 0 or 1."""
        def at(i, j, k):
            return self.node_at(place(i / counts[0], j / counts[1], k / counts[2]))

        for corner in itertools.product(*(range(count) for count in counts)):
            for order in itertools.permutations(range(3)):
                path = [list(corner)]
                for axis in order:
                    path.append([c + (a == axis) for a, c in enumerate(path[-1])])
                t = [at(*p) for p in path]
                if self.volume(t) < 0:
                    t[0], t[1] = t[1], t[0]
                self.tetrahedra.append(t)
                for name, (axis, side) in ((name, side) for name, sides in groups.items() for side in sides):
                    face = [at(*p) for p in path if p[axis] == side * counts[axis]]
                    if len(face) == 3:
                        self.groups.setdefault(name, []).append(self.outward(face, t))

    def outward(self, face, t):
        fourth = next(n for n in t if n not in face)
        return face if self.volume([fourth, *face]) > 0 else [face[1], face[0], face[2]]

    def gmsh(self):
        """Text of a Gmsh file, version 2.2."""
        names = "".join(f'2 {n + 1} "{name}"\n' for n, name in enumerate(self.groups))
        nodes = "".join("{} {:.12g} {:.12g} {:.12g}\n".format(n + 1, *p) for n, p in enumerate(self.nodes))
        faces = [(f"2 2 {g + 1} {g + 1}", face) for g, faces in enumerate(self.groups.values()) for face in faces]
        elements = [*faces, *(("4 2 0 1", t) for t in self.tetrahedra)]
        lines = "".join(f"{n + 1} {head} {' '.join(str(m + 1) for m in nodes)}\n"
                        for n, (head, nodes) in enumerate(elements))
        return (f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{len(self.groups)}\n{names}$EndPhysicalNames\n"
                f"$Nodes\n{len(self.nodes)}\n{nodes}$EndNodes\n$Elements\n{len(elements)}\n{lines}$EndElements\n")


def hollow_octant(inner, outer, side, through):
    """An eighth of a hollow sphere. The group "inside" has the faces of the inner surface."""
    mesh = CellMesh()
    for axis in range(3):
        def place(u, v, w, axis=axis):
            p = [0.0] * 3
            p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = 1, math.tan(math.pi / 4 * u), math.tan(math.pi / 4 * v)
            r = (inner + (outer - inner) * w) / math.sqrt(sum(c * c for c in p))
            return tuple(r * c for c in p)
        mesh.grid((side, side, through), place, inside=[(2, 0)])
    return mesh.gmsh()


def hollow_quarter(inner, outer, height, around, through):
    """A quarter of a ring of one layer of cells. The group "inside" has the faces of the inner surface."""
    def place(u, v, w):
        r, angle = inner + (outer - inner) * u, math.pi / 2 * v
        return r * math.cos(angle), r * math.sin(angle), height * w

    mesh = CellMesh()
    mesh.grid((through, around, 1), place, inside=[(0, 0)])
    return mesh.gmsh()


def quarter_disc(radius, thickness, side, through):
    """A quarter of a disc. The group "rim" has the faces of the curved side, "top" those of the upper face."""
    def place(u, v, w):
        # The disc is the image of the square |u| < 1, |v| < 1.
        return radius * u * math.sqrt(1 - v * v / 2), radius * v * math.sqrt(1 - u * u / 2), thickness * (w - 0.5)

    mesh = CellMesh()
    mesh.grid((side, side, through), place, top=[(2, 1)], rim=[(0, 1), (1, 1)])
    return mesh.gmsh()


def quarter_plate_with_hole(radius, half_width, thickness, around, through):
    """A quarter of a square plate with a round hole, with cells that are smaller at the hole."""
    def place(u, v, w):
        angle = math.pi / 2 * v
        hole = radius * math.cos(angle), radius * math.sin(angle)
        rim = (half_width, half_width * 2 * v) if v <= 0.5 else (half_width * 2 * (1 - v), half_width)
        s = (math.exp(1.6 * u) - 1) / (math.exp(1.6) - 1)
        return *(h + (r - h) * s for h, r in zip(hole, rim)), thickness * w

    mesh = CellMesh()
    mesh.grid((through, around, 1), place)
    return mesh.gmsh()


def tapered_panel(width, thickness, cells):
    """Cook's membrane: 0.44 m high at the left side, from 0.44 to 0.6 m at the right side."""
    mesh = CellMesh()
    mesh.grid(cells, lambda u, v, w: (width * u, 0.44 * u + (0.44 - 0.28 * u) * v, thickness * w), right=[(0, 1)])
    return mesh.gmsh()


def l_bracket(arm, thickness, cells):
    """An upright arm along z and a horizontal arm along x, with square cross-sections of `cells` cells."""
    mesh, long = CellMesh(), round((arm - thickness) / thickness * cells)
    mesh.grid((cells, cells, cells), lambda u, v, w: (thickness * u, thickness * v, thickness * w))
    span = arm - thickness
    mesh.grid((long, cells, cells), lambda u, v, w: (thickness + span * u, thickness * v, thickness * w))
    mesh.grid((cells, cells, long), lambda u, v, w: (thickness * u, thickness * v, thickness + span * w))
    return mesh.gmsh()
