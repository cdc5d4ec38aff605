"""skerry fill, and surfaces as meshes of scenes, from outside."""
import json
import os
import pathlib
import shutil
import sys
import unittest

from program_case import PROGRAM, ROOT, SCENE, ProgramCase

CUBE = """v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
"""
OPEN_CUBE = "\n".join(CUBE.splitlines()[:-1]) + "\n"


class FillTest(ProgramCase):
    def setUp(self):
        super().setUp()
        self.cube = self.write("cube.obj", CUBE)
        os.environ.pop("SKERRY_FILL_PYTHON", None)

    def stub(self, commands):
        """A program in place of the Python interpreter of fTetWild."""
        program = self.write("stub", f"#!/bin/sh\n{commands}\n")
        program.chmod(0o700)
        os.environ["SKERRY_FILL_PYTHON"] = str(program)

    def need_netgen(self):
        if not (pathlib.Path(PROGRAM).parent / "skerry-fill").exists():
            self.skipTest("skerry-fill is not built: it needs libnglib-dev")

    def test_a_filled_surface_runs_in_the_scene_that_is_written_beside_it(self):
        self.need_netgen()
        out, scene = self.folder / "meshes" / "cube.msh", self.folder / "scenes" / "drop.json"
        found = json.loads(self.skerry("fill", self.cube, out, "--scene", scene, "--material", "silicone_ecoflex_30",
                                       "--json").stdout)
        self.assertEqual((found["mesher"], found["exact"]), ("Netgen", True))
        self.assertAlmostEqual(found["mesh"]["volume"], 1, places=12)
        self.assertEqual(json.loads(self.skerry("inspect", out, "--json").stdout)["volume"], found["mesh"]["volume"])
        facts = json.loads(self.skerry("inspect", scene, "--json").stdout)
        self.assertEqual(facts["problems"], [])
        self.assertEqual(facts["contacts_at_start"], 0)
        # The engine rounds the position to three digits upwards.
        self.assertAlmostEqual(json.loads(scene.read_text())["bodies"][0]["position"][2], 0.5, places=2)
        self.skerry("run", scene, "--seconds", 0.05)
        output = self.skerry("fill", self.cube, out).stdout
        for part in ("Netgen", "volume", "the surface is unchanged", "quality", "stable with", "written"):
            self.assertIn(part, output)

    def test_a_surface_in_millimetres_is_scaled(self):
        self.need_netgen()
        out, scene = self.folder / "cube.msh", self.folder / "drop.json"
        output = self.skerry("fill", self.cube, out, "--scene", scene, "--scale", 0.001, "--edge", 0.0011).stdout
        self.assertIn("the surface is unchanged", output)
        found = json.loads(self.skerry("inspect", out, "--json").stdout)
        self.assertAlmostEqual(found["volume"] * 1e9, 1, places=12)
        visual = json.loads(scene.read_text())["bodies"][0]["visual"]
        self.assertEqual(visual, {"file": "cube.obj", "scale": 0.001})
        self.skerry("run", scene, "--seconds", 0.001)
        self.assert_refused("fill", self.cube, out, "--scale", 0.001, "--edge", 1.1, message=["edge", "after scaling"])

    def test_the_example_of_a_filled_surface_runs(self):
        self.need_netgen()
        for name in ("keys/filled.json", "meshes/pebble.obj"):
            (self.folder / name).parent.mkdir()
            shutil.copy(ROOT / "scenes" / name, self.folder / name)
        self.skerry("run", self.folder / "keys/filled.json", "--seconds", 0.05)

    def test_a_surface_that_cannot_be_filled_leaves_no_file(self):
        surface, out = self.write("open.obj", OPEN_CUBE), self.folder / "out.msh"
        arguments = ["fill", surface, out, "--scene", self.folder / "out.json"]
        self.stub("exec sleep 100")
        self.assert_refused(*arguments, "--time-limit", 0.1, message=["open.obj", "time limit of 0.1 s"])
        self.stub("kill -SEGV $$")
        self.assert_refused(*arguments, message=["open.obj", "crashed"])
        self.stub("echo 3 >&3")
        self.assert_refused(*arguments, message=["not a valid mesh"])
        self.stub("exit 3")
        self.assert_refused(*arguments, message=["pip install wildmeshing"])
        self.assert_refused(*arguments, "--tolerance", 0, message=["tolerance above 0"])

    def test_wrong_arguments_are_refused(self):
        self.assert_refused("fill", self.cube, self.folder / "out.vtk", message=["out.vtk", ".msh"])
        self.assert_refused("fill", self.folder / "none.obj", self.folder / "out.msh", message=["none.obj"])
        self.assert_refused("fill", self.cube, self.folder / "out.msh", "--material", "cheese", message=["cheese"])
        self.assert_refused("fill", self.cube, self.cube.with_suffix(".msh"), "--scene",
                            self.cube.with_suffix(".msh"), message=["--scene"])
        self.skerry("fill", self.cube, code=2)
        self.skerry("fill", self.cube, self.folder / "out.msh", "--edge", 0, code=2)

    def scene_of(self, **mesh):
        body = {"mesh": {"surface": "cube.obj", **mesh}, "material": "rubber", "positions": [[0, 0, 2], [5, 0, 2]]}
        return self.write("surface.json", {**SCENE, "bodies": [body], "probes": []})

    def test_a_scene_fills_a_surface_and_keeps_the_mesh_beside_it(self):
        self.need_netgen()
        facts = json.loads(self.skerry("inspect", self.scene_of(scale=0.1), "--json").stdout)
        self.assertAlmostEqual(facts["body_kinds"][0]["mesh"]["volume"], 1e-3, places=12)
        cache = list(self.folder.glob("cube.obj.*.msh"))
        self.assertEqual(len(cache), 1)
        changed = cache[0].stat().st_mtime_ns
        self.skerry("run", self.scene_of(), "--seconds", 0.01)
        self.assertEqual(cache[0].stat().st_mtime_ns, changed)
        self.assertEqual(list(self.folder.glob("cube.obj.*.msh")), cache)

    def test_the_edge_of_a_surface_in_millimetres_is_a_length_after_scaling(self):
        self.need_netgen()
        self.write("cube.obj", "".join(line.replace("1", "1000") + "\n" if line[0] == "v" else line + "\n"
                                       for line in CUBE.splitlines()))
        found = self.skerry("inspect", self.scene_of(scale=0.001, edge=1.1)).stdout
        self.assertNotIn("another unit", found)
        self.assertEqual(len(list(self.folder.glob("cube.obj.*.msh"))), 1)

    def test_the_meshes_of_files_and_surfaces_are_refined_and_made_coarser(self):
        self.need_netgen()
        counts = [json.loads(self.skerry("inspect", self.scene_of(refine=n), "--json").stdout)["body_kinds"][0]["mesh"]
                  ["tetrahedra"] for n in (0, 1)]
        self.assertEqual(counts[1], 8 * counts[0])
        mesh = ROOT / "scenes/meshes/torus.msh"
        shutil.copy(mesh, self.folder)
        mean_edge = json.loads(self.skerry("inspect", mesh, "--json").stdout)["edge"]["mean"]
        given = self.folder / "given"
        body = {"mesh": {"file": "torus.msh", "refine": -1}, "material": "rubber", "position": [0, 0, 2]}
        scene = self.write("coarse.json", {**SCENE, "bodies": [body], "probes": []})
        for size, code in ((0.06, 0), (0.01, 2)):
            for cached in self.folder.glob("torus.msh.*"):
                cached.unlink()
            mesh_text = f"4 1\\n0 0 0\\n{size} 0 0\\n0 {size} 0\\n0 0 {size}\\n0 1 2 3\\n"
            self.stub(f"head -n 1 > {given}\ncat > /dev/null\nprintf '{mesh_text}' >&3")
            output = self.skerry("inspect", scene, "--json", code=code)
            if code == 0:
                self.assertEqual(json.loads(output.stdout)["body_kinds"][0]["mesh"]["tetrahedra"], 1)
            else:
                self.assertIn("refine: found a mesh with a mean edge of 0.0121", output.stderr)
        self.assertAlmostEqual(float(given.read_text().split()[2]), 2 * mean_edge, places=9)

    def test_keys_of_a_surface_need_a_surface(self):
        box = {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}, "edge": 0.1}
        body = {"mesh": box, "material": "rubber", "position": [0, 0, 2]}
        self.assert_refused("inspect", self.write("edge.json", {**SCENE, "bodies": [body], "probes": []}),
                            message=["bodies[0].mesh", '"surface"'])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
