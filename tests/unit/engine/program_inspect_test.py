"""`skerry inspect`: contents of a scene or mesh, bounds of its step, repairs. Called as: TEST PROGRAM SOURCE_FOLDER"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True
from program_case import PROGRAM, ROOT, SCENE, ProgramCase


class ProgramInspectTest(ProgramCase):
    def test_inspect_says_what_is_there(self):
        mesh = json.loads(self.skerry("inspect", ROOT / "scenes/meshes/torus.msh", "--json").stdout)
        self.assertEqual(mesh["tetrahedra"], 972)
        self.assertEqual(mesh["components"], 1)
        self.assertEqual(mesh["problems"], [])
        self.assertIn("972 tetrahedra", self.skerry("inspect", ROOT / "scenes/meshes/torus.msh").stdout)
        scene = json.loads(self.skerry("inspect", self.scene, "--json").stdout)
        self.assertEqual(scene["bodies"], 1)
        self.assertGreater(scene["stable_dt"], 0)
        self.assertAlmostEqual(scene["body_kinds"][0]["stable_dt"], scene["stable_dt"], delta=1e-9 * scene["stable_dt"])
        self.assertIn("stable step", self.skerry("inspect", self.scene).stdout)

    def test_inspect_counts_joining_objects_on_one_line(self):
        body = {**SCENE["bodies"][0], "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}}, "name": "pad",
                "surfaces": [{"nodes": [0], "friction": 0.1}]}
        material = body["material"]
        scene = self.write("joined.json", {
            **SCENE, "probes": [], "bodies": [body], "pairs": [{"materials": [material, material], "friction": 0.2}],
            "loads": [{"name": "weight", "kind": "gravity", "scale": 0.5}],
            "sliders": [{"name": "moon", "load": "weight", "low": 0, "high": 1}],
            "springs": [{"first": {"body": "pad"}, "second": {"point": [0, 0, 1]}, "stiffness": 1}]})
        text = self.skerry("inspect", scene).stdout
        self.assertIn(" collider, 1 load, 1 spring, 1 pair of materials, 1 surface set\n  step ", text)
        found = json.loads(self.skerry("inspect", scene, "--json").stdout)
        self.assertEqual([found[key] for key in ("pipes", "loads", "springs", "pairs", "surfaces")], [0, 1, 1, 1, 1])
        self.assertIn("  slider        moon: from 0 to 1\n", text)
        self.assertEqual(found["sliders"], [{"name": "moon", "unit": "1", "value": 0.5, "low": 0, "high": 1}])

    def test_inspect_knows_rigid_bodies(self):
        rigid = {**SCENE["bodies"][0], "name": "stone", "dynamics": "rigid", "position": [0, 0, 3]}
        mixed = self.write("both.json", {**SCENE, "bodies": SCENE["bodies"] + [rigid]})
        both = json.loads(self.skerry("inspect", mixed, "--json").stdout)
        self.assertEqual([kind["dynamics"] for kind in both["body_kinds"]], ["explicit", "rigid"])
        self.assertEqual(both["stable_dt"], both["body_kinds"][0]["stable_dt"])
        self.assertNotIn("stable_dt", both["body_kinds"][1])
        alone = self.write("rigid.json", {**SCENE, "probes": [], "bodies": [rigid]})
        found = json.loads(self.skerry("inspect", alone, "--json").stdout)
        self.assertAlmostEqual(found["stable_dt"], 1 / 120)
        self.assertGreaterEqual(found["steps"], 120 * SCENE["seconds"])
        output = self.skerry("inspect", alone).stdout
        self.assertIn("8.33 ms (no body limits the step)", output)
        self.assertNotIn("inf", output.lower().replace("info", ""))
        self.assertNotIn("stable up to", self.skerry("run", alone).stdout)

    def test_implicit_bodies_run_and_set_no_step(self):
        beam = {**SCENE["bodies"][0], "name": "beam", "dynamics": "implicit", "position": [0, 0, 0.5]}
        scene = self.write("implicit.json", {**SCENE, "probes": [], "bodies": [beam]})
        found = json.loads(self.skerry("inspect", scene, "--json").stdout)
        self.assertEqual(found["body_kinds"][0]["dynamics"], "implicit")
        self.assertAlmostEqual(found["stable_dt"], 1 / 120)
        self.assertIn("tetrahedra (implicit)", self.skerry("inspect", scene).stdout)
        self.assertIn("steps", self.skerry("run", scene).stdout)

    def test_kinds_of_bodies_have_their_own_dynamics_after_a_choice_was_changed(self):
        # The first body becomes explicit when the last one is added, which moves it to the end of World::bodies().
        block = {**SCENE["bodies"][0], "material": "firm"}
        stiff = {**block, "name": "stiff", "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [4, 4, 4]}}}
        rigid = {**block, "name": "stone", "dynamics": "rigid", "position": [0, 0, 3]}
        soft = {**SCENE["bodies"][0], "name": "soft", "position": [0, 0, 5],
                "mesh": {"box": {"size": [0.03, 0.03, 0.03], "cells": [4, 4, 4]}}}
        scene = {**SCENE, "probes": [], "materials": {**SCENE["materials"], "firm": {"E": 1e8}}}
        kinds = {}
        for bodies in ([stiff, rigid], [stiff, rigid, soft]):
            found = self.skerry("inspect", self.write("three.json", {**scene, "bodies": bodies}), "--json").stdout
            kinds[len(bodies)] = {kind["name"]: kind["dynamics"] for kind in json.loads(found)["body_kinds"]}
        self.assertEqual(kinds[2], {"stiff": "implicit", "stone": "rigid"})
        self.assertEqual(kinds[3], {"stiff": "explicit", "stone": "rigid", "soft": "explicit"})

    def test_inspect_says_what_another_value_would_do(self):
        written = json.loads(self.skerry("inspect", self.scene, "--json").stdout)
        place = f"materials.{SCENE['bodies'][0]['material']}.E"
        stiff = json.loads(self.skerry("inspect", self.scene, "--json", "--set", f"{place}=1e9").stdout)
        self.assertLess(stiff["stable_dt"], written["stable_dt"])
        self.assert_refused("inspect", self.scene, "--set", "materials.rubber.weight=1", message=["weight"])
        mesh = ROOT / "scenes/meshes/torus.msh"
        self.assert_refused("inspect", mesh, "--set", f"{place}=1e9",
                            message=["torus.msh", "--set", "a mesh", "a scene"])

    def test_inspect_reads_the_surfaces_of_colliders(self):
        corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
        solid = self.folder / "solid.obj"
        solid.write_text(corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
        found = json.loads(self.skerry("inspect", solid, "--json").stdout)
        self.assertEqual((found["triangles"], found["nodes"], found["can_be_filled"]), (4, 4, True))
        self.assertAlmostEqual(found["volume"], 1 / 6)
        self.assertAlmostEqual(found["area"], 1.5 + 3 ** 0.5 / 2)
        self.assertEqual((found["problems"], found["faults"], len(found["shells"])), ([], [], 1))
        self.assertIn("a surface of 4 triangles", self.skerry("inspect", solid).stdout)
        room = self.folder / "room.obj"
        room.write_text(corners + "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n")
        self.assertIn("clockwise as seen from outside", self.skerry("inspect", room).stdout)
        sheet = self.folder / "sheet.stl"
        sheet.write_text("solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                         "endloop\nendfacet\nendsolid s\n")
        self.assertRegex(self.skerry("inspect", sheet).stdout,
                         r"problem       1 hole, the longest 3.41\d* m around at \(.*\) m, triangle 0; close")
        faults = json.loads(self.skerry("inspect", sheet, "--json").stdout)["faults"]
        self.assertEqual([fault["kind"] for fault in faults], ["holes"])
        in_gmsh = self.folder / "surface.msh"
        in_gmsh.write_text("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n"
                           "$Elements\n1\n1 2 0 1 2 3\n$EndElements\n")
        self.assertEqual(json.loads(self.skerry("inspect", in_gmsh, "--json").stdout)["triangles"], 1)
        (self.folder / "bad.obj").write_text("v 0 0 0\nf 1 2 3\n")
        self.assert_refused("inspect", self.folder / "bad.obj", message=["bad.obj", "face", "line 2"])
        self.assert_refused("inspect", solid, "--repair", self.folder / "new.msh",
                            message=["solid.obj", ".obj", ".vtu"])

    def test_a_large_scene_reports_its_set_up(self):
        block = dict(SCENE["bodies"][0], name="block", position=[0, 0, 1],
                     mesh={"box": {"size": [0.5, 0.5, 0.5], "cells": [26, 26, 26]}})
        scene = self.write("large.json", {**SCENE, "probes": [], "bodies": [block]})
        output = self.skerry("inspect", scene)
        for line in ("skerry: set-up of 105,456 tetrahedra: adding the body", "s: measuring the meshes",
                     "s: choosing the step length", "s: timing the first steps"):
            self.assertIn(line, output.stderr)
        self.assertRegex(output.stdout,
                         "removal of the worst 1 % of the tetrahedra was not tried: "
                         "their longest step is only 1[.0-9]* times")
        stats = self.folder / "stats.json"
        output = self.skerry("run", scene, "--seconds", 1e-6, "--stats", stats)
        self.assertIn("skerry: set-up of 105,456 tetrahedra: adding the body", output.stderr)
        self.assertRegex(output.stdout,
                         "(?s)simulated in .*, after .* of loading and set-up.*\\n  set-up .* to read the scene")
        numbers = json.loads(stats.read_text())
        self.assertGreater(numbers["seconds_setup"], numbers["seconds_load"])
        self.assertGreater(numbers["seconds_setup"], numbers["seconds_wall"])
        self.assertNotIn("set-up of", self.skerry("run", scene, "--seconds", 1e-6, "--quiet").stderr)

    def test_inspect_says_which_tetrahedra_bound_the_step(self):
        mesh = self.bad_box("bad.msh", cells=6)
        found = json.loads(self.skerry("inspect", mesh, "--json").stdout)["step_bound"]
        worst = found["worst"][0]
        self.assertLess(worst["altitude"], 0.1 * worst["mean_edge"])
        self.assertLess(max(abs(x) for x in worst["place"]), 0.5)
        self.assertAlmostEqual(worst["dt"], found["stable_dt"], delta=0.1 * found["stable_dt"])
        self.assertGreater(found["without"][-1]["stable_dt"], 1.5 * found["stable_dt"])
        output = self.skerry("inspect", mesh).stdout
        self.assertIn(f"tetrahedron {worst['tetrahedron']} at (", output)
        self.assertIn("without the worst", output)
        scene = self.write("bad.json", {**SCENE, "probes": [], "bodies": [
            {"name": "bad", "mesh": {"file": "bad.msh", "scale": 0.2}, "material": "rubber", "position": [0, 0, 1]}]})
        of_body = json.loads(self.skerry("inspect", scene, "--json").stdout)["body_kinds"][0]["step_bound"]
        self.assertAlmostEqual(of_body["worst"][0]["altitude"], 0.2 * worst["altitude"], places=9)
        self.assertIn(f"tetrahedron {worst['tetrahedron']} at (", self.skerry("inspect", scene).stdout)

    def test_inspect_prints_the_step_without_the_worst_tetrahedra_if_it_is_a_tenth_longer(self):
        for mesh, gains in ((self.bad_box("bad.msh", cells=6), True), (self.bad_box("even.msh", flat=0.5), False)):
            found = json.loads(self.skerry("inspect", mesh, "--json").stdout)["step_bound"]
            ratios = [without["stable_dt"] / found["stable_dt"] for without in found["without"]]
            self.assertTrue(ratios)
            self.assertEqual(max(ratios) >= 1.1, gains, ratios)
            self.assertEqual(self.skerry("inspect", mesh).stdout.count("without the worst"),
                             sum(ratio >= 1.1 for ratio in ratios))

    def test_a_part_that_is_too_stiff_in_bending_is_a_problem_and_a_warning(self):
        strip = {"name": "strip", "mesh": {"box": {"size": [0.05, 0.01, 0.001], "cells": [20, 4, 1]}}, "material": "m"}
        stone = {**strip, "name": "stone", "position": [0, 0.1, 0], "dynamics": "rigid"}  # does not bend
        strip["pin"] = {"box": {"lower": [-1, -1, -1], "upper": [-0.024, 1, 1]}}  # a run warns of bodies that deform
        scene = self.write("strip.json", {"seconds": 1e-4, "materials": {"m": {"E": 3e7, "nu": 0, "rho": 1000}},
                                          "bodies": [strip, stone]})

        def found(*assignments):
            values = [argument for assignment in assignments for argument in ("--set", f"bodies[0].{assignment}")]
            problems = json.loads(self.skerry("inspect", scene, "--json", *values).stdout)["problems"]
            self.skerry("run", scene, "--quiet", "--stats", self.folder / "stats.json", *values)
            warnings = json.loads((self.folder / "stats.json").read_text())["trust"]["warnings"]
            self.assertEqual([text.replace("'", '"') for text in warnings], problems)
            return problems

        # Deflections under the own weight of 0.88, 0.32 and 0.26 mm instead of 3.07 mm.
        for assignments, right in (([], 3.49), (["mesh.box.cells=[10,2,1]"], 9.46), (["element=linear"], 11.8)):
            [problem] = found(*assignments)
            self.assertIn('body "strip": a part 1 mm thick and 50 mm long around (0, 0, 0) m has 1 layer of cells',
                          problem)
            self.assertEqual('"element" of the body to "smoothed"' in problem, "element=linear" in assignments)
            stiffness = float(re.search(r"about ([0-9.]+) times as stiff in bending", problem)[1])
            self.assertLess(right / 1.5, stiffness)
            self.assertLess(stiffness, 1.5 * right)
        self.assertEqual(found("mesh.box.size=[0.05,0.01,0.005]", "mesh.box.cells=[20,4,2]"), [])
        [stiff] = found("mesh.box.size=[0.5,0.1,0.001]", "element=linear")
        self.assertRegex(stiff, r"about \d{3,5} times as stiff in bending")  # without an exponent
        plate = self.bad_box("plate.msh", cells=8, kept={(x, y, 0) for x in range(8) for y in range(8)})
        self.assertIn("problem       a part 125 mm thick", self.skerry("inspect", plate).stdout)

    def bad_box(self, name, cells=4, flat=1e-3, needle=False, kept=None):
        """A unit box with an inner node close to another one; with `needle` the same on its surface. `kept`: cells."""
        side = cells + 1
        nodes = [[x / cells - 0.5, y / cells - 0.5, z / cells - 0.5]
                 for z in range(side) for y in range(side) for x in range(side)]
        number = lambda p: (p[2] * side + p[1]) * side + p[0]
        tetrahedra = []
        for cell in range(cells ** 3):
            at = [cell % cells, cell // cells % cells, cell // cells ** 2]
            if kept and tuple(at) not in kept:
                continue
            for walk in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)):
                corner = [at[i] + at[i] % 2 for i in range(3)]
                t = [number(corner)]
                for axis in walk:
                    corner[axis] += 1 if at[axis] % 2 == 0 else -1
                    t.append(number(corner))
                a, b, c = ([nodes[t[k]][i] - nodes[t[0]][i] for i in range(3)] for k in (1, 2, 3))
                if sum(a[i] * (b[(i + 1) % 3] * c[(i + 2) % 3] - b[(i + 2) % 3] * c[(i + 1) % 3])
                       for i in range(3)) < 0:
                    t[2], t[3] = t[3], t[2]
                tetrahedra.append(t)
        for moved, towards in ((number([2, 2, 2]), number([3, 2, 2])),
                               *([(number([0, 2, 2]), number([0, 3, 2]))] if needle else [])):
            nodes[moved] = [flat * a + (1 - flat) * b for a, b in zip(nodes[moved], nodes[towards])]
        used = sorted({n for t in tetrahedra for n in t})
        nodes, tetrahedra = [nodes[n] for n in used], [[used.index(n) for n in t] for t in tetrahedra]
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", len(nodes)]
        lines += [" ".join(map(str, [i + 1, *x])) for i, x in enumerate(nodes)]
        lines += ["$EndNodes", "$Elements", len(tetrahedra)]
        lines += [" ".join(map(str, [i + 1, 4, 2, 1, 1, *(n + 1 for n in t)])) for i, t in enumerate(tetrahedra)]
        return self.write(name, "\n".join(map(str, [*lines, "$EndElements", ""])))

    def test_a_repair_is_refused_before_any_work(self):
        mesh = self.bad_box("bad.msh")
        self.assert_refused("inspect", mesh, "--repair", self.folder / "out.vtk", message=["out.vtk", ".msh"])
        self.assert_refused("inspect", mesh, "--repair", mesh, message=["--overwrite"])
        self.assert_refused("inspect", mesh, "--repair", mesh / "x.msh", message=["not a folder"])
        for arguments in (["--tolerance", 0.1], ["--repair", "x.msh", "--tolerance", -1], ["--overwrite"]):
            self.skerry("inspect", mesh, *arguments, code=2)
        # A copy of the program has no skerry-fill beside it.
        alone = pathlib.Path(shutil.copy(PROGRAM, self.folder / "skerry"))
        done = subprocess.run([alone, "inspect", mesh, "--repair", self.folder / "out.msh"], capture_output=True,
                              text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("apt-get install libnglib-dev", done.stderr)

    def need_fill(self):
        if not (pathlib.Path(PROGRAM).parent / "skerry-fill").exists():
            self.skipTest("skerry-fill is not built: it needs libnglib-dev")

    def test_a_repaired_mesh_has_a_longer_step_and_the_same_surface(self):
        self.need_fill()
        better = self.folder / "deep" / "better.msh"
        for tolerance in (0, 0.01):
            mesh = self.bad_box("bad.msh", needle=tolerance > 0)
            found = json.loads(self.skerry("inspect", mesh, "--repair", better, "--tolerance", tolerance,
                                           "--json").stdout)
            before, after = found["before"], found["after"]
            self.assertTrue(found["written"])
            self.assertGreater(after["stable_dt"], 1.3 * before["stable_dt"])
            self.assertAlmostEqual(after["volume"], 1, delta=0.01)
            self.assertLessEqual(max(found["distance"].values()), max(found["tolerance"], 1e-12))
            again = json.loads(self.skerry("inspect", better, "--json").stdout)
            self.assertEqual(again["tetrahedra"], after["tetrahedra"])
            self.assertEqual(again["step_bound"]["stable_dt"], after["stable_dt"])
            if tolerance == 0:
                self.assertEqual(found["edges_collapsed"] + found["edges_flipped"], 0)
                self.assertAlmostEqual(after["volume"], before["volume"], places=12)
            else:
                self.assertGreater(found["edges_collapsed"], 0)
        output = self.skerry("inspect", mesh, "--repair", mesh, "--overwrite").stdout
        for part in ("before", "after", "stable step", "worst altitude", "volume", "surface", "written"):
            self.assertIn(part, output)

    def test_a_body_of_a_scene_is_repaired_for_its_material(self):
        self.need_fill()
        self.bad_box("bad.msh")
        scene = self.write("two.json", {**SCENE, "bodies": SCENE["bodies"] + [
            {"name": "bad", "mesh": {"file": "bad.msh", "scale": 0.2}, "material": "rubber", "position": [1, 0, 1]}]})
        better = self.folder / "better.msh"
        found = json.loads(self.skerry("inspect", scene, "--repair", better, "--json").stdout)
        self.assertIn('body "bad"', found["mesh"])
        self.assertAlmostEqual(found["after"]["volume"], 0.008, delta=0.0001)
        kinds = json.loads(self.skerry("inspect", scene, "--json").stdout)["body_kinds"]
        self.assertAlmostEqual(found["before"]["stable_dt"], kinds[1]["stable_dt"], places=12)
        self.skerry("inspect", scene, "--repair", better, "--body", "bda", code=2)

    def test_a_node_that_joins_what_shares_no_face_there_is_parted(self):
        self.need_fill()
        chain = [(1, 1, 1), (0, 1, 1), (0, 2, 1), (0, 3, 1), (1, 3, 1), (2, 3, 1), (2, 3, 2), (2, 2, 2)]
        mesh = self.bad_box("pinched.msh", flat=1, kept=chain)
        out = self.folder / "parted.msh"
        found = json.loads(self.skerry("inspect", mesh, "--repair", out, "--tolerance", 0, "--json").stdout)
        self.assertEqual(found["nodes_parted"], 1)
        again = json.loads(self.skerry("inspect", out, "--json").stdout)
        self.assertTrue(again["closed_manifold"])
        self.assertAlmostEqual(again["volume"], found["before"]["volume"], places=12)
        if found["kept"]:  # nothing better was found to fill it with
            self.assertEqual(again["nodes"], found["before"]["nodes"] + 1)
            self.assertEqual(again["tetrahedra"], found["before"]["tetrahedra"])
        self.assertIn("1 node split", self.skerry("inspect", mesh, "--repair", out, "--tolerance", 0).stdout)
        two = self.bad_box("two.msh", flat=1, kept=[(1, 1, 1), (2, 2, 2)])
        self.assert_refused("inspect", two, "--repair", self.folder / "none.msh", message=["2 parts", "save each part"])

    def test_what_is_not_better_is_not_written(self):
        self.need_fill()
        good = self.bad_box("good.msh", flat=1)
        out = self.folder / "out.msh"
        done = self.skerry("inspect", good, "--repair", out, "--tolerance", 0, code=1)
        self.assertIn("nothing was written", done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertFalse(out.exists())

    def test_inspect_counts_labels_and_materials(self):
        self.write("m.node", "5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n")
        mesh = self.write("m.ele", "2 4 1\n1 1 2 3 4 -1\n2 2 3 4 5 20\n")
        self.assertEqual(json.loads(self.skerry("inspect", mesh, "--json").stdout)["labels"], {"-1": 1, "20": 1})
        self.assertIn("label -1: 1 tetrahedra, label 20: 1 tetrahedra", self.skerry("inspect", mesh).stdout)
        layered = self.write("layered.json", {"materials": {"rubber": {"E": 1e5}, "steel": {"E": 1e7}}, "bodies": [
            {"mesh": {"file": "m.ele"}, "material": "rubber", "materials": {"20": "steel"}}]})
        kind = json.loads(self.skerry("inspect", layered, "--json").stdout)["body_kinds"][0]
        self.assertEqual(kind["materials"], {"rubber": 1, "steel": 1})
        self.assertIn("rubber 1, steel 1", self.skerry("inspect", layered).stdout)

    def test_inspect_finds_an_overlap(self):
        sunk = json.loads(json.dumps(SCENE))
        sunk["bodies"][0]["position"][2] = 0.09
        problems = json.loads(self.skerry("inspect", self.write("sunk.json", sunk), "--json").stdout)["problems"]
        self.assertIn("body 'block' and collider 'floor' overlap by 0.01 m at (0, 0, -0.01) m at the start", problems)
        self.assertTrue(any("a run moves overlapping bodies apart" in problem for problem in problems), problems)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
