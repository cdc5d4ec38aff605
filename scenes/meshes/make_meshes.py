#!/usr/bin/env python3
"""Makes the mesh files of the scenes, in metres: python3 scenes/meshes/make_meshes.py
The meshes at the end need the package gmsh. Those of mesh_drop.json are in one of each family of formats."""
import math
import pathlib

FOLDER = pathlib.Path(__file__).resolve().parent
# Kuhn's six tetrahedra of a cell; its corners are numbered by bits x + 2 y + 4 z. Neighbouring cells match, also around
# a ring.
KUHN = [(0, 1, 3, 7), (0, 1, 5, 7), (0, 2, 3, 7), (0, 2, 6, 7), (0, 4, 5, 7), (0, 4, 6, 7)]


class Builder:
    def __init__(self):
        self.nodes, self.tetrahedra, self.number = [], [], {}
        self.labels, self.faces, self.names = [], [], []  # of tetrahedra; (label, corners); (dimension, label, name)

    def node(self, key, point):
        if key not in self.number:
            self.number[key] = len(self.nodes)
            self.nodes.append(point)
        return self.number[key]

    def cell(self, corners):
        for kuhn in KUHN:
            t = [corners[c] for c in kuhn]
            a, b, c, d = (self.nodes[n] for n in t)
            u, v, w = ([p[i] - a[i] for i in range(3)] for p in (b, c, d))
            volume = sum(u[i] * (v[(i + 1) % 3] * w[(i + 2) % 3] - v[(i + 2) % 3] * w[(i + 1) % 3]) for i in range(3))
            self.tetrahedra.append(t if volume > 0 else [t[0], t[1], t[3], t[2]])


def torus(ring_radius, tube_radius, across, around):
    """A square grid of cells bent to a disc and swept around."""
    mesh = Builder()

    def corner(i, j, k):
        x, y = 2 * i / across - 1, 2 * j / across - 1
        x, y = x * math.sqrt(1 - y * y / 2), y * math.sqrt(1 - x * x / 2)
        angle, radius = 2 * math.pi * k / around, ring_radius + tube_radius * x
        return mesh.node((i, j, k % around), (radius * math.cos(angle), radius * math.sin(angle), tube_radius * y))

    for k in range(around):
        for j in range(across):
            for i in range(across):
                mesh.cell([corner(i + (b & 1), j + (b >> 1 & 1), k + (b >> 2)) for b in range(8)])
    return mesh


def voxels(rows, size, depth):
    """Cubes where a picture has an x, several cells deep."""
    mesh = Builder()
    height, width = len(rows), max(len(row) for row in rows)

    def corner(i, j, k):
        return mesh.node((i, j, k), (size * (i - width / 2), size * (j - depth / 2), size * (k - height / 2)))

    for row, line in enumerate(rows):
        for i, mark in enumerate(line):
            for j in range(depth if mark == "x" else 0):
                mesh.cell([corner(i + (b & 1), j + (b >> 1 & 1), height - 1 - row + (b >> 2)) for b in range(8)])
    return mesh


def point_lines(mesh, first=None):
    for i, p in enumerate(mesh.nodes):
        yield ("" if first is None else f"{i + first} ") + " ".join(f"{c:.9g}" for c in p)


def write_gmsh(mesh, name):
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat"]
    if mesh.names:
        lines += ["$PhysicalNames", str(len(mesh.names)), *(f'{d} {n} "{name}"' for d, n, name in mesh.names),
                  "$EndPhysicalNames"]
    elements = [(4, label, t) for label, t in zip(mesh.labels or [1] * len(mesh.tetrahedra), mesh.tetrahedra)]
    elements += [(2, label, t) for label, t in mesh.faces]
    lines += ["$Nodes", str(len(mesh.nodes)), *point_lines(mesh, 1), "$EndNodes", "$Elements", str(len(elements))]
    lines += [f"{i + 1} {kind} 2 {label} {label} " + " ".join(str(n + 1) for n in corners)
              for i, (kind, label, corners) in enumerate(elements)]
    (FOLDER / name).write_text("\n".join(lines + ["$EndElements", ""]))


def write_vtk(mesh, name):
    count = len(mesh.tetrahedra)
    lines = ["# vtk DataFile Version 3.0", "made by make_meshes.py", "ASCII", "DATASET UNSTRUCTURED_GRID",
             f"POINTS {len(mesh.nodes)} double", *point_lines(mesh)]
    lines += [f"CELLS {count} {5 * count}"] + ["4 " + " ".join(map(str, t)) for t in mesh.tetrahedra]
    lines += [f"CELL_TYPES {count}"] + ["10"] * count
    (FOLDER / name).write_text("\n".join(lines + [""]))


def write_tetgen(mesh, name):
    (FOLDER / f"{name}.node").write_text("\n".join([f"{len(mesh.nodes)} 3 0 0", *point_lines(mesh, 0), ""]))
    elements = [f"{i} " + " ".join(map(str, t)) for i, t in enumerate(mesh.tetrahedra)]
    (FOLDER / f"{name}.ele").write_text("\n".join([f"{len(mesh.tetrahedra)} 4 0", *elements, ""]))


write_gmsh(torus(0.06, 0.028, 3, 18), "torus.msh")
write_vtk(voxels([".x.", "xxx", ".x."], 0.04, 2), "cross.vtk")
write_tetgen(voxels(["xxx", "x..", "xxx", "..x", "xxx"], 0.028, 2), "letter_s")


def tetrahedra_of(shape, size):
    """Fills the geometry that `shape` makes from the functions of gmsh.model.occ. `shape` returns physical groups as
    pairs of names and tags of volumes, and as pairs of names and boxes around surfaces."""
    import gmsh
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.Algorithm3D", 10)  # HXT
    volumes, surfaces = shape(gmsh.model.occ)
    gmsh.model.mesh.generate(3)
    mesh, at = Builder(), {}
    tags, points, _ = gmsh.model.mesh.getNodes(3, includeBoundary=True)
    for tag, point in zip(tags, points.reshape(-1, 3)):
        at[tag] = mesh.node(tag, [round(c, 6) + 0.0 for c in point])

    def corners(dimension, tag, count):
        kinds, _, nodes = gmsh.model.mesh.getElements(dimension, tag)
        return [[at[n] for n in row] for row in nodes[0].reshape(-1, count)] if len(kinds) else []

    for number, (name, tag) in enumerate(volumes, 1):
        mesh.names.append((3, number, name))
        mesh.tetrahedra += corners(3, tag, 4)
        mesh.labels += [number] * (len(mesh.tetrahedra) - len(mesh.labels))
    for number, (name, box) in enumerate(surfaces, len(volumes) + 1):
        mesh.names.append((2, number, name))
        for _, tag in gmsh.model.getEntitiesInBoundingBox(*box, 2):
            mesh.faces += [(number, face) for face in corners(2, tag, 3)]
    gmsh.finalize()
    return mesh


def finger(occ):
    """A bar along x with three notches in its lower side."""
    length, half_width, half_height = 0.1, 0.008, 0.01
    outline = [(0, -half_height)]
    for x in (0.03, 0.055, 0.08):
        outline += [(x - 0.008, -half_height), (x - 0.0015, 0.002), (x + 0.0015, 0.002), (x + 0.008, -half_height)]
    outline += [(length, -half_height), (length, half_height), (0, half_height)]
    points = [occ.addPoint(x, -half_width, z) for x, z in outline]
    lines = [occ.addLine(a, b) for a, b in zip(points, points[1:] + points[:1])]
    face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    solid = occ.extrude([(2, face)], 0, 2 * half_width, 0)
    occ.synchronize()
    volume = next(tag for dimension, tag in solid if dimension == 3)
    return [("silicone", volume)], [("base", (-1e-4, -1, -1, 1e-4, 1, 1)), ("tip", (length - 1e-4, -1, -1, 1, 1, 1))]


def ellipsoid(occ, center, axes):
    ball = occ.addSphere(*center, 1)
    occ.dilate([(3, ball)], *center, *axes)
    return 3, ball


def liver(occ):
    """A large and a small lobe, with a tumour in the large one."""
    lobes, _ = occ.fuse([ellipsoid(occ, (0, 0, 0.03), (0.065, 0.05, 0.03))],
                        [ellipsoid(occ, (0.06, 0.012, 0.03), (0.055, 0.035, 0.019))])
    tumour = occ.addSphere(-0.022, 0.005, 0.034, 0.014)
    occ.fragment(lobes, [(3, tumour)])
    occ.synchronize()
    size = {tag: occ.getMass(3, tag) for _, tag in occ.getEntities(3)}
    inner, outer = sorted(size, key=size.get)
    return [("parenchyma", outer), ("tumour", inner)], []


def egg(occ):
    """A ball, which `to_egg` deforms."""
    ball = occ.addSphere(0, 0, 0, 1)
    occ.synchronize()
    return [("egg", ball)], []


def to_egg(mesh, half_length, radius):
    """Stretches a ball along x and narrows its end at +x."""
    for i, (x, y, z) in enumerate(mesh.nodes):
        across = radius * (1 - 0.15 * x)
        mesh.nodes[i] = [round(c, 6) + 0.0 for c in (half_length * x, across * y, across * z)]
    return mesh


write_gmsh(tetrahedra_of(finger, 0.0045), "finger.msh")
write_gmsh(tetrahedra_of(liver, 0.0095), "liver.msh")
write_gmsh(to_egg(tetrahedra_of(egg, 0.28), 0.03, 0.022), "egg.msh")
