"""Bodies that overlap at the start: messages and results of the program. Called as: TEST PROGRAM SOURCE_FOLDER"""
import json
import subprocess
import sys
import unittest

from program_case import PROGRAM, ROOT, SCENE, ProgramCase


class ProgramStartTest(ProgramCase):
    def overlapping(self, x, **settings):
        """Two balls of 100 mm whose centres are x metres apart."""
        ball = {"mesh": {"ball": {"radius": 0.05, "resolution": 4}}, "material": "rubber",
                "velocity": [0, 1, 0]}
        return self.write("overlapping.json", {
            "materials": {"rubber": {"E": 1e5}}, "seconds": 0.01, "settings": {"gravity": [0, 0, 0], **settings},
            "bodies": [{"name": "left", "position": [0, 0, 0], **ball},
                       {"name": "right", "position": [x, 0, 0], **ball}]})

    def test_bodies_that_coincide_are_refused_by_name_before_the_run(self):
        self.assert_refused("run", self.overlapping(0), message=["overlapping.json", "'left' and 'right' coincide at"])
        self.assert_refused("run", self.overlapping(0.02), message=["bodies 'left' and 'right' overlap by"])
        self.assert_refused("run", self.overlapping(0.09), "--start-overlaps", "refuse", message=["overlap by"])
        problems = json.loads(self.skerry("inspect", self.overlapping(0), "--json").stdout)["problems"]
        self.assertTrue(any("'left' and 'right' coincide" in problem for problem in problems), problems)
        self.assertTrue(any("a run refuses to start with these overlaps" in problem for problem in problems), problems)

    def test_bodies_that_overlap_a_bit_are_moved_apart_and_the_run_says_so(self):
        stats = self.folder / "stats.json"
        done = self.skerry("run", self.overlapping(0.095), "--stats", stats)
        self.assertIn("1 overlap, 2 bodies moved apart, the largest movement ", done.stdout)
        self.assertNotIn("WARNING", done.stdout)
        start = json.loads(stats.read_text())["start"]
        self.assertEqual([m["body"] for m in start["moves"]], ["left", "right"])
        self.assertTrue(start["overlaps"][0]["resolved"])
        self.assertEqual(json.loads(stats.read_text())["max_penetration"], 0)

    def test_a_strict_run_with_warnings_fails_and_writes_its_outputs(self):
        stats = self.folder / "stats.json"
        done = self.skerry("run", self.overlapping(0, start_overlaps="ignore"), "--strict", "--quiet", "--stats", stats,
                           code=1)
        self.assertIn("WARNING", done.stderr)
        self.assertTrue(json.loads(stats.read_text())["trust"]["warnings"])
        self.skerry("run", self.overlapping(0.2), "--strict")

    def test_a_warning_names_both_bodies_that_overlap_at_the_start_quiet_or_not(self):
        done = self.skerry("run", self.overlapping(0, start_overlaps="ignore"))
        for part in ("WARNING", "'left' and 'right' coincide at (0, 0, 0) m at the start: move the objects apart"):
            self.assertIn(part, done.stdout)
        done = self.skerry("run", self.overlapping(0.09, start_overlaps="ignore"))
        self.assertIn("settings.start_overlaps to \"resolve\"", done.stdout)
        self.assertNotIn("shorten the step", done.stdout)
        quiet = self.skerry("run", self.overlapping(0, start_overlaps="ignore"), "--quiet")
        self.assertEqual(quiet.stdout, "")
        self.assertIn("skerry: WARNING: bodies 'left' and 'right' coincide", quiet.stderr)

    def test_a_contact_distance_out_of_proportion_is_what_is_blamed(self):
        sunk = json.loads(json.dumps(SCENE))
        sunk["bodies"][0]["contact_distance"] = 10
        done = self.skerry("run", self.write("shell.json", sunk), "--seconds", 0.05)
        self.assertIn("closer than their contact distance", done.stdout)
        self.assertNotIn("shorten the step", done.stdout)
        problems = json.loads(self.skerry("inspect", self.folder / "shell.json", "--json").stdout)["problems"]
        self.assertTrue(any("contact distance" in problem for problem in problems), problems)

    def test_bodies_of_one_mesh_file_are_of_one_kind_if_their_elements_are(self):
        body = {"mesh": {"file": str(ROOT / "scenes/meshes/drop_ball.msh")}, "material": "rubber"}
        scene = self.write("balls.json", {"materials": {"rubber": {"E": 1e5}}, "seconds": 0.01, "bodies": [
            {**body, "position": [0.2 * i, 0, 0.2], "element": element}
            for i, element in enumerate(["linear", "smoothed", "linear"])]})
        kinds = json.loads(self.skerry("inspect", scene, "--json").stdout)["body_kinds"]
        self.assertEqual([kind["count"] for kind in kinds], [2, 1])
        self.assertNotEqual(kinds[0]["stable_dt"], kinds[1]["stable_dt"])

    def test_a_run_says_that_a_boundary_is_no_manifold(self):
        self.write("m.node", "7 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 -1 0 0\n6 0 -1 0\n7 0 0 -1\n")
        self.write("m.ele", "2 4 0\n1 1 2 3 4\n2 1 6 5 7\n")
        scene = self.write("joined.json", {"materials": {"rubber": {"E": 1e5}}, "seconds": 0.01, "bodies": [
            {"name": "pair", "mesh": {"file": "m.ele"}, "material": "rubber"}]})
        output = self.skerry("run", scene).stdout
        self.assertIn("the boundary of body 'pair' is not a closed manifold: node 0, at which parts of", output)
        self.assertRegex(output, "without a common edge in .*m.ele; contacts may fail")
        output = self.skerry("inspect", scene).stdout
        self.assertRegex(output, r'body "pair" \(mesh .*m.ele\): the boundary is not a closed manifold \(node 0, at')

    def two_tetrahedra(self, name, second, apex=-1):
        """A scene with a mesh of two tetrahedra on a shared face; `second` lists the nodes of the second one."""
        self.write(name + ".node", f"5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0 0 {apex}\n")
        self.write(name + ".ele", f"2 4 0\n1 1 2 3 4\n2 {second}\n")
        return self.write(name + ".json", {"materials": {"rubber": {"E": 1e5}}, "seconds": 0.01, "bodies": [
            {"name": "pair", "mesh": {"file": name + ".ele"}, "material": "rubber"}]})

    def test_tetrahedra_listed_the_other_way_round_are_turned_and_counted(self):
        scene, stats = self.two_tetrahedra("mixed", "1 2 3 5"), self.folder / "stats.json"
        done = self.skerry("run", scene, "--stats", stats)
        message = "mixed.ele: 1 of 2 tetrahedra list their nodes in the opposite order"
        self.assertIn("skerry: NOTE: ", done.stderr)
        self.assertIn(message, done.stderr)
        self.assertIn(message, json.loads(stats.read_text())["notes"][0])
        self.assertIn(message, self.skerry("inspect", scene).stdout)
        self.assertIn(message, self.skerry("inspect", self.folder / "mixed.ele").stdout)
        self.assertEqual(self.skerry("run", scene, "--quiet").stderr, "")
        clean = self.skerry("run", self.two_tetrahedra("clean", "1 3 2 5"))
        self.assertNotIn("NOTE", clean.stderr)

    def test_a_mesh_of_two_parts_is_noted(self):
        self.write("halves.node", "8 3 0 0\n" + "".join(
            f"{4 * part + k} {x} {y} {z + 2 * part}\n" for part in (0, 1)
            for k, (x, y, z) in enumerate([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])))
        self.write("halves.ele", "2 4 0\n0 0 1 2 3\n1 4 5 6 7\n")
        scene = self.write("halves.json", {"materials": {"rubber": {"E": 1e5}}, "seconds": 0.01, "bodies": [
            {"name": "halves", "mesh": {"file": "halves.ele"}, "material": "rubber"}]})
        self.assertIn('NOTE: the mesh of body "halves" has 2 parts without a common node, which can move apart',
                      self.skerry("run", scene).stderr)

    def test_a_mesh_with_a_node_in_a_wrong_place_is_refused_with_its_file_and_its_faults(self):
        # The apex of the second tetrahedron lies on the wrong side: turned, it would lie in the first tetrahedron.
        scene = self.two_tetrahedra("tangled", "1 3 2 5", apex=0.5)
        self.assert_refused("run", scene,
                            message=["tangled.json", "tangled.ele: tetrahedron 1", "inverted: 1, flat: 0 of 2"])
        self.assertIn("1 inverted tetrahedra", self.skerry("inspect", self.folder / "tangled.ele").stdout)

    def test_a_stiff_explicit_body_is_named_with_its_remedy_before_a_long_run(self):
        scene = json.loads(json.dumps(SCENE))
        scene["materials"]["steel"] = {"E": 2e11, "nu": 0.3, "rho": 7800}
        scene["bodies"].append({**scene["bodies"][0], "name": "anvil", "material": "steel", "dynamics": "explicit",
                                "position": [1, 0, 0.11]})
        scene["seconds"] = 1000

        def first_line(scene):
            """First line on standard error of a run that is then stopped."""
            command = [PROGRAM, "run", str(self.write("anvil.json", scene))]
            with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as run:
                line = run.stderr.readline()
                run.terminate()
                run.communicate(timeout=60)
            return line

        held = {**scene["bodies"][1], "pin": {"box": {"lower": [-1, -1, -1], "upper": [1, 1, 0]}}}
        del held["dynamics"]
        for anvil in (held, scene["bodies"][1]):
            note = first_line({**scene, "bodies": [scene["bodies"][0], anvil]})
            self.assertIn("skerry: NOTE: ", note)
            for part in ('body "anvil" is explicit, of material "steel"', "steps, ",
                         'set "dynamics" of the body to "implicit"'):
                self.assertIn(part, note)
        self.assertNotIn("NOTE", self.skerry("run", self.folder / "anvil.json", "--seconds", 0.001).stderr)
        scene["bodies"][1]["dynamics"] = "implicit"
        self.assertIn("s to simulate", first_line(scene))
        scene["bodies"].pop()
        scene["fibres"] = [{"body": scene["bodies"][0]["name"], "direction": [0, 0, 1], "stiffness": 1e13}]
        note = first_line(scene)
        self.assertRegex(note, 'the springs, cables, cavities, fibres or loads that act on it need steps of .* times '
                               'as many as otherwise; reduce their stiffness')

    def test_a_run_without_any_contact_says_so_with_the_shortest_distance(self):
        scene = {**SCENE, "settings": {"gravity": [0, 0, 0]}}
        scene["bodies"] = [{**SCENE["bodies"][0], "position": [0, 0, 0.6]}]
        output = self.skerry("run", self.write("far.json", scene)).stdout
        self.assertIn('no contact in the whole run: the shortest distance at the end is 500 mm between body "block" '
                      'and collider "floor"', output)
        self.assertNotIn("no contact in the whole run", self.skerry("run", self.scene).stdout)
        del scene["colliders"]
        self.assertNotIn("no contact in the whole run", self.skerry("run", self.write("alone.json", scene)).stdout)

    def test_a_collider_that_turns_by_much_in_a_step_is_named(self):
        mill = {"materials": {"rubber": {"E": 1e5}}, "seconds": 0.01, "settings": {"gravity": [0, 0, 0]},
                "bodies": [{"name": "ball", "shape": {"sphere": {"radius": 0.05}}, "dynamics": "rigid",
                            "material": "rubber"}],
                "colliders": [{"name": "mill", "shape": {"plane": {}}, "position": [0, 0, -1],
                               "motion": {"velocity": [0, 0, -1], "angular_velocity": [0, 0, 1200]}}]}
        message = "collider \"mill\" turns by 10 rad in a step"
        self.assertIn(message, self.skerry("run", self.write("mill.json", mill)).stdout)
        problems = json.loads(self.skerry("inspect", self.folder / "mill.json", "--json").stdout)["problems"]
        self.assertTrue(any(message in problem for problem in problems), problems)
        self.assertNotIn("WARNING", self.skerry("run", self.folder / "mill.json", "--step", 1e-4).stdout)

    def test_advice_names_an_option_that_there_is(self):
        stack = json.loads(json.dumps(SCENE))
        stack["settings"] = {"tolerance": 1e-10}
        stack["bodies"].append({**stack["bodies"][0], "name": "upper", "position": [0.03, 0.02, 0.32]})
        scene = self.write("stack.json", stack)
        self.assertIn("(--max-iterations), now 2", self.skerry("run", scene, "--max-iterations", 2).stdout)
        self.assertNotIn("max-iterations", self.skerry("run", scene, "--max-iterations", 100000).stdout)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
