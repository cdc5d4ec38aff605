"""Reads a series of VtkWriter with VTK and compares every number: check_vtk.py FOLDER, which holds expected.json beside
the series.

Ends with 77 (skipped, for CTest) when Python has no VTK.
"""
import json
import os
import sys
import xml.etree.ElementTree as ElementTree

try:
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
    import numpy as np
except ImportError as error:
    print(f"SKIPPED: {error}; Debian: apt-get install python3-vtk9")
    sys.exit(77)

errors = []


def read(reader, path):
    reader.AddObserver("ErrorEvent", lambda caller, event: errors.append(path))
    reader.SetFileName(path)
    reader.Update()
    assert not errors, f"VTK complains about {errors}"
    return reader.GetOutput()


def same(name, found, expected, tolerance):
    expected = np.asarray(expected, dtype=float)
    found = np.asarray(found, dtype=float).reshape(expected.shape)
    scale = max(1e-30, np.abs(expected).max(initial=0))
    worst = np.abs(found - expected).max(initial=0) / scale
    assert worst <= tolerance, f"{name}: off by {worst:g} of {scale:g}"


FLOAT = 1e-7  # half an ulp of a 32-bit float is 6e-8


def point_array(data, name):
    array = data.GetPointData().GetArray(name)
    assert array is not None, f"no point data {name}"
    return vtk_to_numpy(array)


def cell_array(data, name):
    array = data.GetCellData().GetArray(name)
    assert array is not None, f"no cell data {name}"
    return vtk_to_numpy(array)


def points(data):
    return vtk_to_numpy(data.GetPoints().GetData()) if data.GetNumberOfPoints() else np.zeros((0, 3))


def time_of(data):
    return data.GetFieldData().GetArray("TimeValue").GetValue(0)


def texts(data, name):
    array = data.GetFieldData().GetAbstractArray(name)
    assert array is not None and array.IsA("vtkStringArray"), f"no texts {name}"
    values = [array.GetValue(i) for i in range(array.GetNumberOfValues())]
    return [value if isinstance(value, bytes) else value.encode() for value in values]  # bytes that are no text


def six(matrix):
    return [matrix[row][column] for row, column in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]]


def von_mises(stress):
    deviator = stress - np.trace(stress) / 3 * np.eye(3)
    return np.sqrt(1.5 * np.sum(deviator * deviator))


def check_bodies(path, frame):
    data = read(vtk.vtkXMLUnstructuredGridReader(), path)
    assert data.GetNumberOfPoints() == len(frame["position"]), "points"
    assert data.GetNumberOfCells() == len(frame["cells"]), "cells"
    assert time_of(data) == frame["time"], "time"
    assert data.GetPoints().GetDataType() == vtk.VTK_DOUBLE, "places are doubles"
    same("position", points(data), frame["position"], 0)
    same("velocity", point_array(data, "velocity"), frame["velocity"], FLOAT)
    same("displacement", point_array(data, "displacement"), frame["displacement"], FLOAT)
    same("speed", point_array(data, "speed"), np.linalg.norm(frame["velocity"], axis=1), FLOAT)
    for name, array, expected in [("stress", cell_array, "stress"), ("strain", cell_array, "strain"),
                                  ("stress", point_array, "node_stress"), ("strain", point_array, "node_strain")]:
        same(name, array(data, name), [six(m) for m in frame[expected]], FLOAT)
    for array, expected in [(cell_array, "stress"), (point_array, "node_stress")]:
        same("von_mises", array(data, "von_mises"), [von_mises(np.array(m)) for m in frame[expected]], FLOAT)
    same("principal_stresses", point_array(data, "principal_stresses"),
         [np.linalg.eigvalsh(np.array(m))[::-1] for m in frame["node_stress"]], FLOAT)
    same("body", cell_array(data, "body"), frame["body"], 0)
    same("material", cell_array(data, "material"), frame["material"], 0)
    for number, nodes in enumerate(frame["cells"]):
        cell = data.GetCell(number)
        assert cell.GetCellType() == vtk.VTK_TETRA
        assert [cell.GetPointId(k) for k in range(4)] == nodes


def check_contacts(path, frame):
    data = read(vtk.vtkXMLPolyDataReader(), path)
    rows = frame["contacts"]
    assert data.GetNumberOfPoints() == len(rows) and data.GetNumberOfVerts() == len(rows), "a vertex a contact"
    assert time_of(data) == frame["time"], "time"
    same("point", points(data), [row["point"] for row in rows] or np.zeros((0, 3)), 0)
    names = [bytes(name) for name in frame["body_names"]]
    assert texts(data, "body_names") == names, "names of bodies, also of those that have gone"
    assert texts(data, "material_names")[0] == b'gum <& "rubber">', "the name that a material was given"
    assert texts(data, "material_names")[1:] in ([], [b"material 1"]), "the name of one that was given none"
    for name in ["normal", "impulse", "force", "slip"]:
        same(name, point_array(data, name), [row[name] for row in rows] or np.zeros((0, 3)), FLOAT)
    for name in ["distance", "gap", "state", "region", "first_body"]:
        same(name, point_array(data, name), [row[name] for row in rows], FLOAT)
    same("second_body", point_array(data, "second_body"), [-1] * len(rows), 0)
    same("collider", point_array(data, "collider"), [0] * len(rows), 0)
    return len(rows)


def check_colliders(path):
    data = read(vtk.vtkXMLPolyDataReader(), path)
    numbers = cell_array(data, "collider")
    assert texts(data, "collider_names") == [f"collider {i}".encode() for i in range(5)], "names of colliders"
    assert set(numbers) == {0, 1, 2, 3, 4}, "a picture of each collider"
    place = points(data)
    ids = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    bucket = place[np.unique(ids[numbers == 1])]
    # Floor at 0.005 with 0.02 of wall and floor around an inner radius of 0.48 and an inner height of 0.25.
    same("bucket", [bucket[:, 2].min(), bucket[:, 2].max(), np.hypot(bucket[:, 0], bucket[:, 1]).max()],
         [-0.015, 0.255, 0.5], 1e-12)
    plane = place[np.unique(ids[numbers == 0])]
    flat = np.abs(plane[:, 2]).max() == 0
    assert flat and np.ptp(plane[:, 0]) > 0.5, "the plane is flat and reaches beyond the bodies"
    capsule = place[np.unique(ids[numbers == 3])]
    # Turned by 90 degrees about x: along y, 0.1 + 0.05 to either side of its place.
    same("capsule", [capsule[:, 1].min(), capsule[:, 1].max()], [-0.35, -0.05], 1e-9)


def check_lines(path, frame):
    data = read(vtk.vtkXMLPolyDataReader(), path)
    place, force = points(data), cell_array(data, "force")
    found = {}
    for number in range(data.GetNumberOfCells()):
        cell = data.GetCell(number)
        ends = [place[cell.GetPointId(k)] for k in range(cell.GetNumberOfPoints())]
        kind, line = (cell_array(data, name)[number] for name in ["kind", "line"])
        found.setdefault((line, kind), []).append((ends, force[number]))
    names = texts(data, "line_names")
    assert names[:3] == [b"tie", b"cable <&>", b"spring"], f"names of lines, also of those that have gone: {names}"
    assert len(found) == len(frame["lines"]), "one number a line"
    for cells, line in zip([found[key] for key in sorted(found, key=lambda key: key[1])],
                           sorted(frame["lines"], key=lambda line: line["kind"])):
        ends = line["points"]
        expected = [[a, b] for a, b in zip(ends, ends[1:])] if line["joined"] and len(ends) > 1 else [[a] for a in ends]
        same("ends of segments", [cell[0] for cell in cells], expected, 0)
        same("force", [cell[1] for cell in cells], line["force"][:len(expected)], FLOAT)


def main(folder):
    with open(os.path.join(folder, "expected.json")) as file:
        expected = json.load(file)
    index = ElementTree.parse(os.path.join(folder, expected["name"] + ".pvd"))
    parts = {}
    for entry in index.iter("DataSet"):
        parts.setdefault(float(entry.get("timestep")), {})[entry.get("name")] = os.path.join(folder, entry.get("file"))
    assert list(parts) == [frame["time"] for frame in expected["frames"]], "one time a frame, in order"
    contacts = 0
    for frame in expected["frames"]:
        files = parts[frame["time"]]
        check_bodies(files["bodies"], frame)
        contacts += check_contacts(files["contacts"], frame)
        check_colliders(files["colliders"])
        check_lines(files["lines"], frame)
    without = any(not frame["contacts"] for frame in expected["frames"])
    assert contacts > 0 and without, "frames with and without contacts"
    assert not [name for name in os.listdir(folder) if name.endswith(".part")], "no half-written file left"
    print(f"{len(expected['frames'])} frames, {contacts} contacts: the same as written (VTK "
          f"{vtk.vtkVersion().GetVTKVersion()})")


if __name__ == "__main__":
    main(sys.argv[1])
