"""Reads the frames of a VtkWriter with meshio and compares numbers: check_meshio.py FOLDER, which holds expected.json
beside the series.

Ends with 77 (skipped, for CTest) when Python has no meshio.
"""
import json
import os
import sys

try:
    import meshio
    import numpy as np
except ImportError as error:
    print(f"SKIPPED: {error}; pip install meshio")
    sys.exit(77)


def main(folder):
    with open(os.path.join(folder, "expected.json")) as file:
        expected = json.load(file)
    for number, frame in enumerate(expected["frames"]):
        mesh = meshio.read(os.path.join(folder, f"{expected['name']}_bodies_{number:04d}.vtu"))
        assert np.array_equal(mesh.points, np.reshape(frame["position"], (-1, 3))), "places"
        cells = [block.data for block in mesh.cells if block.type == "tetra"]
        assert len(cells) == len(mesh.cells), "tetrahedra only"
        found = np.concatenate(cells) if cells else np.zeros((0, 4))
        assert np.array_equal(found, np.reshape(frame["cells"], (-1, 4))), "cells"
        assert mesh.field_data["TimeValue"][0] == frame["time"], "time"
        if cells:
            assert np.array_equal(mesh.cell_data["body"][0].ravel(), frame["body"]), "bodies"
        velocity = np.reshape(frame["velocity"], (-1, 3))
        assert np.allclose(mesh.point_data["velocity"], velocity, rtol=1e-6, atol=1e-12), "velocities"
    print(f"{len(expected['frames'])} frames: the same as written (meshio {meshio.__version__})")


if __name__ == "__main__":
    main(sys.argv[1])
