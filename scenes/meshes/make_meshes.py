#!/usr/bin/env python3
"""Makes the mesh files of scenes/mesh_drop.json, one in each family of formats, and those of other scenes, in metres:
python3 scenes/meshes/make_meshes.py"""
import collections
import math
import pathlib

from node_mesh import NodeMesh

FOLDER = pathlib.Path(__file__).resolve().parent
# Kuhn's six tetrahedra of a cell; its corners are numbered by bits x + 2 y + 4 z. Neighbouring cells match, also around
# a ring.
KUHN = [(0, 1, 3, 7), (0, 1, 5, 7), (0, 2, 3, 7), (0, 2, 6, 7), (0, 4, 5, 7), (0, 4, 6, 7)]


class Builder(NodeMesh):
    def cell(self, node_at, i, j, k, mirror=0):
        """Adds a cell with the lowest node `node_at(i, j, k)`. `mirror` has the bits of the mirrored axes."""
        corners = [node_at(i + (bits & 1), j + (bits >> 1 & 1), k + (bits >> 2)) for bits in range(8)]
        for kuhn in KUHN:
            t = [corners[c ^ mirror] for c in kuhn]
            self.tetrahedra.append(t if self.volume(t) > 0 else [t[0], t[1], t[3], t[2]])

    def faces(self, is_wanted):
        """Faces of the surface with wanted keys of all nodes, counter-clockwise as seen from outside."""
        sides = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
        faces = [(t[a], t[b], t[c]) for t in self.tetrahedra for a, b, c in sides]
        count = collections.Counter(frozenset(face) for face in faces)
        keys = list(self.number)
        return [f for f in faces if count[frozenset(f)] == 1 and all(is_wanted(*keys[n]) for n in f)]


def ring(section, across, through, around, mirror=lambda i: 0):
    """A grid of cells swept around the z axis. `section` returns the radius and the height of a node of the grid."""
    mesh = Builder()

    def node_at(i, j, k):
        angle, (radius, height) = 2 * math.pi * k / around, section(i, j)
        return mesh.node((i, j, k % around), (radius * math.cos(angle), radius * math.sin(angle), height))

    for k in range(around):
        for j in range(through):
            for i in range(across):
                mesh.cell(node_at, i, j, k, mirror(i))
    return mesh


def torus(ring_radius, tube_radius, across, around):
    """A ring whose section is a square grid bent to a disc."""
    def section(i, j):
        x, y = 2 * i / across - 1, 2 * j / across - 1
        x, y = x * math.sqrt(1 - y * y / 2), y * math.sqrt(1 - x * x / 2)
        return ring_radius + tube_radius * x, tube_radius * y

    return ring(section, across, across, around)


def tyre(ring_radius, tube_radius, thickness, opening, across, through, around):
    """A tube that is open towards the axis, over an angle of 2 `opening` of its section."""
    def section(i, j):
        angle = (math.pi - opening) * (2 * i / across - 1)
        radius = tube_radius - thickness * j / through
        return ring_radius + radius * math.cos(angle), radius * math.sin(angle)

    mesh = ring(section, across, through, around, lambda i: 2 * i // across)
    mesh.groups = {"inside": mesh.faces(lambda i, j, k: j == through),
                   "beads": mesh.faces(lambda i, j, k: i in (0, across))}
    return mesh


def bricks(x, y, z, cells, mirror=lambda j: 0):
    """Cells with given numbers, between planes at given coordinates."""
    mesh = Builder()

    def node_at(i, j, k):
        return mesh.node((i, j, k), (x[i], y[j], z[k]))

    for i, j, k in cells:
        mesh.cell(node_at, i, j, k, mirror(j))
    return mesh


def voxels(rows, size, depth):
    """Cubes where a picture has an x, several cells deep."""
    height, width = len(rows), max(len(row) for row in rows)

    def planes(count):
        return [size * (i - count / 2) for i in range(count + 1)]

    return bricks(planes(width), planes(depth), planes(height),
                  ((i, j, height - 1 - row) for row, line in enumerate(rows) for i, mark in enumerate(line)
                   for j in range(depth if mark == "x" else 0)))


def finger(chambers, wall, gap, y, z):
    """A finger along x, with a row of chambers above a channel and open gaps between the chambers."""
    x = [0]
    for size in chambers * (wall, wall, wall, gap):
        x.append(x[-1] + size)
    x, last, middle, top = x[:-1], 4 * chambers - 2, len(y) // 2, len(z) - 1

    def is_solid(i, j, k):
        if i % 4 == 3 and k > 2:
            return False
        is_hollow = 0 < i < last and k == 1 or i % 4 == 1 and 0 < k < top - 1
        return not (is_hollow and 0 < j < len(y) - 2)

    cells = [(i, j, k) for i in range(last + 1) for j in range(len(y) - 1) for k in range(top) if is_solid(i, j, k)]
    mesh = bricks(x, y, z, cells, lambda j: 2 * (j >= middle))
    mesh.groups = {
        "chambers": mesh.faces(lambda i, j, k: 0 < i <= last and 0 < j < len(y) - 1 and 0 < k < top and
                               (k < 3 or i % 4 in (1, 2))),
        "clamp": mesh.faces(lambda i, j, k: i == 0),
        "pad": mesh.faces(lambda i, j, k: k == 0 and i > last - 4)}
    return mesh


def point_lines(mesh, first=None):
    for i, p in enumerate(mesh.nodes):
        yield ("" if first is None else f"{i + first} ") + " ".join(f"{c:.9g}" for c in p)


def write_gmsh(mesh, name):
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat"]
    if mesh.groups:
        lines += ["$PhysicalNames", str(len(mesh.groups))]
        lines += [f'2 {g + 1} "{group}"' for g, group in enumerate(mesh.groups)] + ["$EndPhysicalNames"]
    elements = [("4 2 1 1", t) for t in mesh.tetrahedra]
    elements += [(f"2 2 {g + 1} {g + 1}", face) for g, faces in enumerate(mesh.groups.values()) for face in faces]
    lines += ["$Nodes", str(len(mesh.nodes)), *point_lines(mesh, 1), "$EndNodes", "$Elements", str(len(elements))]
    lines += [f"{i + 1} {kind} " + " ".join(str(n + 1) for n in e) for i, (kind, e) in enumerate(elements)]
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


def write_pebble(name, half_axes, rings, around):
    """A closed surface for examples: an ellipsoid that is flatter below."""
    def point(ring, k):
        polar, angle = math.pi * ring / rings, 2 * math.pi * k / around
        unit = (math.sin(polar) * math.cos(angle), math.sin(polar) * math.sin(angle), math.cos(polar))
        return unit[0] * half_axes[0], unit[1] * half_axes[1], unit[2] * half_axes[2] * (1 if unit[2] > 0 else 0.5)

    points = [point(0, 0), *(point(ring, k) for ring in range(1, rings) for k in range(around)), point(rings, 0)]
    first = [1 + ring * around for ring in range(rings - 1)]  # first node of each ring
    faces = []
    for k in range(around):
        l = (k + 1) % around
        faces += [(0, first[0] + k, first[0] + l), (len(points) - 1, first[-1] + l, first[-1] + k)]
        for a, b in zip(first, first[1:]):
            faces += [(a + k, b + k, b + l), (a + k, b + l, a + l)]
    lines = [f"v {x:.5g} {y:.5g} {z:.5g}" for x, y, z in points]
    (FOLDER / name).write_text("\n".join([*lines, *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces), ""]))


write_pebble("pebble.obj", (0.05, 0.035, 0.025), 8, 16)
write_gmsh(torus(0.06, 0.028, 3, 18), "torus.msh")
write_vtk(voxels([".x.", "xxx", ".x."], 0.04, 2), "cross.vtk")
write_tetgen(voxels(["xxx", "x..", "xxx", "..x", "xxx"], 0.028, 2), "letter_s")
write_gmsh(finger(5, 0.006, 0.0045, [-0.015, -0.009, -0.0045, 0, 0.0045, 0.009, 0.015],
                  [0, 0.006, 0.011, 0.017, 0.023, 0.029, 0.035]), "air_finger.msh")
write_gmsh(tyre(0.12, 0.06, 0.022, math.radians(60), 10, 2, 46), "tyre.msh")


def fill(name, size, shape, deform=lambda *point: point):
    """Fills a geometry with tetrahedra by the package gmsh, which must be installed, and writes the physical groups.
    `shape` makes the geometry and the groups from the functions of gmsh.model."""
    import gmsh
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
    shape(gmsh.model)
    gmsh.model.mesh.generate(3)
    tags, points, _ = gmsh.model.mesh.getNodes()
    for tag, point in zip(tags, points.reshape(-1, 3)):
        gmsh.model.mesh.setNode(tag, [round(c, 6) + 0.0 for c in deform(*point)], [])
    gmsh.write(str(FOLDER / name))
    gmsh.finalize()


def notched_finger(model):
    """A bar along x with three notches in its lower side."""
    length, half_width, half_height = 0.1, 0.008, 0.01
    outline = [(0, -half_height)]
    for x in (0.03, 0.055, 0.08):
        outline += [(x - 0.008, -half_height), (x - 0.0015, 0.002), (x + 0.0015, 0.002), (x + 0.008, -half_height)]
    outline += [(length, -half_height), (length, half_height), (0, half_height)]
    points = [model.occ.addPoint(x, -half_width, z) for x, z in outline]
    lines = [model.occ.addLine(a, b) for a, b in zip(points, points[1:] + points[:1])]
    face = model.occ.addPlaneSurface([model.occ.addCurveLoop(lines)])
    model.occ.extrude([(2, face)], 0, 2 * half_width, 0)
    model.occ.synchronize()
    model.addPhysicalGroup(3, [1], name="silicone")
    base = model.getEntitiesInBoundingBox(-1e-4, -1, -1, 1e-4, 1, 1, 2)
    model.addPhysicalGroup(2, [tag for _, tag in base], name="base")


def liver(model):
    """A large and a small lobe, with a tumour in the large one."""
    def ellipsoid(center, half_axes):
        ball = [(3, model.occ.addSphere(*center, 1))]
        model.occ.dilate(ball, *center, *half_axes)
        return ball

    lobes, _ = model.occ.fuse(ellipsoid((0, 0, 0.03), (0.065, 0.05, 0.03)),
                              ellipsoid((0.06, 0.012, 0.03), (0.055, 0.035, 0.019)))
    model.occ.fragment(lobes, [(3, model.occ.addSphere(-0.022, 0.005, 0.034, 0.014))])
    model.occ.synchronize()
    tumour, parenchyma = sorted((tag for _, tag in model.getEntities(3)), key=lambda tag: model.occ.getMass(3, tag))
    model.addPhysicalGroup(3, [parenchyma], name="parenchyma")
    model.addPhysicalGroup(3, [tumour], name="tumour")


def unit_ball(model):
    model.occ.addSphere(0, 0, 0, 1)
    model.occ.synchronize()
    model.addPhysicalGroup(3, [1], name="egg")


fill("notched_finger.msh", 0.005, notched_finger)
fill("liver.msh", 0.0095, liver)
# An egg of 60 mm along x and 44 mm across, narrower at +x.
fill("egg.msh", 0.32, unit_ball, lambda x, y, z: (0.03 * x, 0.022 * (1 - 0.15 * x) * y, 0.022 * (1 - 0.15 * x) * z))
