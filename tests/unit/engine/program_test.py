"""The program from outside: exit codes, messages, files that are complete or absent, JSON that parses.

Called as: program_test.py PROGRAM SOURCE_FOLDER
"""
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
import unittest

sys.dont_write_bytecode = True
from program_case import PROGRAM, ROOT, SCENE, ProgramCase

STATS_KEYS = {
    "": "schema scene seconds_simulated steps seconds_wall threads bodies nodes elements stable_dt contacts regions "
        "stages solver energy momentum "
        "max_penetration status state_hash",
    "contacts": "mean max",
    "regions": "mean max largest_contacts",
    "solver": "method iterations_mean worst_error unconverged",
    "energy": "kinetic elastic potential dissipated",
    "trust": "solver energy momentum penetration elements warnings",
}


class ProgramTest(ProgramCase):
    def test_a_run_writes_statistics_with_every_promised_key(self):
        stats = self.folder / "deep" / "stats.json"
        done = self.skerry("run", self.scene, "--threads", 1, "--stats", stats, "--profile")
        found = json.loads(stats.read_text())
        for group, keys in STATS_KEYS.items():
            for key in keys.split():
                self.assertIn(key, found[group] if group else found)
        for stage in found["stages"].values():
            self.assertEqual(set(stage), {"seconds", "runs", "skipped"})
        self.assertEqual(found["status"], "ok")
        self.assertEqual(found["threads"], 1)
        self.assertAlmostEqual(found["seconds_simulated"], 0.2, places=12)
        self.assertEqual(found["elements"] % 5 * (found["elements"] % 6), 0)  # cells of five or six tetrahedra
        self.assertGreater(found["contacts"]["max"], 0)
        self.assertEqual(done.stderr, "")
        for word in ("real time", "steps", "contacts", "penetration", "state hash", found["state_hash"]):
            self.assertIn(word, done.stdout)
        self.assertEqual([p.name for p in stats.parent.iterdir()], ["stats.json"])  # no temporary file is left
        self.assertEqual(found["trust"]["warnings"], [])
        self.assertNotIn("WARNING", done.stdout)

    def test_a_run_that_is_not_to_be_relied_on_says_so(self):
        stacked = dict(SCENE["bodies"][0], name="upper", position=[0.03, 0.02, 0.32], velocity=[0.5, 0.2, -2])
        scene = self.write("stack.json", dict(SCENE, bodies=[*SCENE["bodies"], stacked]))
        stats = self.folder / "stats.json"
        done = self.skerry("run", scene, "--tolerance", 1e-15, "--stats", stats)
        trust = json.loads(stats.read_text())["trust"]
        self.assertGreater(trust["solver"]["unconverged"], 0)
        self.assertTrue(any("above the tolerance" in warning for warning in trust["warnings"]), trust)
        self.assertIn("WARNING", done.stdout)

    def test_probes_add_up_to_the_time_of_the_run(self):
        stats = self.folder / "stats.json"
        self.skerry("run", self.scene, "--stats", stats, "--quiet")
        base = json.loads(stats.read_text())["probes"]["base"]
        self.assertAlmostEqual(base["stick_time"] + base["slide_time"] + base["open_time"], 0.2, places=9)
        self.assertGreater(base["stick_time"] + base["slide_time"], 0)
        lengths = {len(series) for series in base["series"].values()}
        self.assertEqual(len(lengths), 1)
        self.assertGreaterEqual(lengths.pop(), 36)  # 0.2 s of 5 ms, rounded to whole samples in a frame

    def test_quiet_says_nothing(self):
        done = self.skerry("run", self.scene, "--quiet")
        self.assertEqual(done.stdout + done.stderr, "")

    def test_the_same_run_gives_the_same_hash_and_the_flags_count(self):
        hashes = []
        for flags in (["--threads", 1], ["--threads", 2], ["--backend", "serial"]):
            stats = self.folder / "stats.json"
            self.skerry("run", self.scene, "--quiet", "--stats", stats, *flags)
            hashes.append(json.loads(stats.read_text())["state_hash"])
        self.assertEqual(len(set(hashes)), 1)
        stats = self.folder / "other.json"
        self.skerry("run", self.scene, "--quiet", "--stats", stats, "--seconds", 0.1, "--contact-regions", "global",
                    "--method", "pgs", "--tolerance", 1e-6,
                    "--friction", "pyramid", "--step", 1e-4, "--frames-per-second", 20)
        found = json.loads(stats.read_text())
        self.assertEqual(found["solver"]["contact_regions"], "global")
        self.assertEqual(found["solver"]["friction"], "pyramid")
        self.assertEqual(found["solver"]["tolerance"], 1e-6)
        self.assertEqual(found["frames"], 3)
        self.assertEqual(found["steps"], 1000)
        self.assertNotEqual(found["state_hash"], hashes[0])

    def test_frames_a_page_and_a_trace_are_written(self):
        out, page, trace = self.folder / "out", self.folder / "page.html", self.folder / "trace.json"
        self.skerry("run", self.scene, "--seconds", 0.05, "--out", out, "--page", page, "--trace", trace, "--quiet")
        self.assertTrue((out / "drop.pvd").exists())
        self.assertIn("<html", page.read_text()[:2000].lower())
        self.assertTrue(json.loads(trace.read_text()))

    def test_bad_scenes_are_refused_without_output(self):
        outputs = ["--stats", self.folder / "s.json", "--out", self.folder / "out", "--page", self.folder / "p.html"]
        bad = self.write("bad.json", {**SCENE, "secnods": 1})
        self.assert_refused("run", bad, *outputs, said=["bad.json", "secnods", '"seconds"'])
        self.assert_refused("run", self.write("syntax.json", '{"name": "x",\n}'), *outputs, said=["line 2, column"])
        self.assert_refused("run", self.folder / "none.json", *outputs, said=["none.json", "no such file"])
        self.assert_refused("inspect", bad, said=["secnods"])

    def test_output_that_cannot_be_written_is_refused_before_the_run(self):
        blocked = self.write("file", "") / "inside"
        endless = self.write("endless.json", {**SCENE, "seconds": 1e6})
        for flag in ("--stats", "--out", "--page", "--trace", "--export-problems"):
            self.assert_refused("run", endless, flag, blocked, said=["file", "no folder"])
        self.assert_refused("run", endless, "--stats", self.folder, said=["a folder"])
        # One bad output among good ones: the good ones do not appear either.
        self.assert_refused("run", endless, "--out", self.folder / "out", "--stats", blocked, said=["no folder"])

    def test_only_files_are_replaced_and_links_stay(self):
        quick = self.write("quick.json", {**SCENE, "seconds": 0.01})
        target, link = self.write("target.json", "old"), self.folder / "link.json"
        link.symlink_to("target.json")
        target.chmod(0o640)
        self.skerry("run", quick, "--quiet", "--stats", link)
        self.assertTrue(link.is_symlink())
        self.assertEqual(json.loads(target.read_text())["status"], "ok")
        self.assertEqual(target.stat().st_mode & 0o777, 0o640)
        ahead = self.folder / "ahead.json"
        ahead.symlink_to("later.json")
        self.skerry("run", quick, "--quiet", "--stats", ahead)
        self.assertEqual(json.loads((self.folder / "later.json").read_text())["status"], "ok")
        self.assertTrue(ahead.is_symlink())
        shown = self.skerry("run", quick, "--quiet", "--stats", "/dev/stdout")
        self.assertEqual(json.loads(shown.stdout)["status"], "ok")
        self.skerry("run", quick, "--quiet", "--stats", "/dev/null", "--trace", "/dev/null")
        self.assertTrue(pathlib.Path("/dev/null").is_char_device())
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        reader = subprocess.Popen(["cat", str(pipe)], stdout=subprocess.PIPE, text=True)
        self.skerry("run", quick, "--quiet", "--stats", pipe)
        self.assertEqual(json.loads(reader.communicate(timeout=60)[0])["status"], "ok")
        self.assertTrue(pipe.is_fifo())

    def test_what_is_protected_or_something_else_is_not_replaced(self):
        protected = self.write("protected.json", "precious")
        protected.chmod(0o444)
        endless = self.write("endless.json", {**SCENE, "seconds": 1e6})
        self.assert_refused("run", endless, "--stats", protected, said=["protected.json", "protected against writing"])
        self.assertEqual(protected.read_text(), "precious")
        with socket.socket(socket.AF_UNIX) as made:
            made.bind(str(self.folder / "socket"))
            self.assert_refused("run", endless, "--page", self.folder / "socket", said=["found a socket"])
        if pathlib.Path("/dev/full").exists():
            full = self.skerry("run", self.write("q.json", {**SCENE, "seconds": 0.01}), "--quiet", "--stats",
                               "/dev/full", code=3)
            self.assertIn("No space left", full.stderr)
            self.assertTrue(pathlib.Path("/dev/full").is_char_device())

    def test_no_output_takes_the_place_of_another_or_of_the_scene(self):
        endless = self.write("endless.json", {**SCENE, "seconds": 1e6})
        before = endless.read_text()
        same = self.folder / "same"
        other = f"{self.folder}/./sub/../same"
        self.assert_refused("run", endless, "--stats", same, "--trace", other, said=["--trace", "--stats"])
        self.assert_refused("run", endless, "--page", endless, said=["--page", "the scene"])
        link = self.folder / "link.json"
        link.symlink_to(endless)
        self.assert_refused("run", endless, "--stats", link, said=["--stats", "the scene"])
        self.assertEqual(endless.read_text(), before)

    def test_times_that_cannot_be_counted_are_refused_and_the_shortest_is_simulated(self):
        self.assert_refused("run", self.write("long.json", {**SCENE, "seconds": 1e300}),
                            said=["long.json", "frames", "1e9"])
        self.assert_refused("run", self.scene, "--frames-per-second", "1e300", said=["frames", "1e9"])
        self.assert_refused("run", self.write("fine.json", {**SCENE, "probe_step": 1e-13}),
                            said=["samples", "probe_step"])
        for name, scene, flags in (("nano", SCENE, ["--seconds", "1e-11"]),
                                   ("coarse", {**SCENE, "seconds": 0.01, "frame_step": 1e300}, [])):
            stats = self.folder / f"{name}.stats"
            self.skerry("run", self.write(f"{name}.json", scene), "--quiet", "--stats", stats, *flags)
            found = json.loads(stats.read_text())
            self.assertGreater(found["steps"], 0, name)
            self.assertAlmostEqual(found["seconds_simulated"] / (1e-11 if flags else 0.01), 1, places=9)

    def test_bad_command_lines_are_refused(self):
        for arguments in (["run"], ["fly"], [], ["run", self.scene, "--seconds", "-1"],
                          ["run", self.scene, "--seconds", "nan"],
                          ["run", self.scene, "--seconds", "inf"], ["run", self.scene, "--threads", "x"],
                          ["run", self.scene, "--backend", "cuda"],
                          ["run", self.scene, "--step", "0"], ["run", self.scene, "--nonsense"],
                          ["solve", "x", "--max-iterations", "0"], ["run", self.scene, "--export-every", "0"],
                          ["run", self.scene, "--export-problems-of", "body"]):
            done = self.skerry(*arguments, code=2)
            self.assertNotEqual(done.stderr, "")

    def test_a_mesh_that_is_not_one_is_refused(self):
        self.assert_refused("inspect", self.write("broken.msh", "nonsense"), said=["broken.msh"])
        self.assert_refused("inspect", self.folder / "none.msh", said=["none.msh"])

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
        said = self.skerry("inspect", alone).stdout
        self.assertIn("8.33 ms (no body sets one)", said)
        self.assertNotIn("inf", said.lower().replace("info", ""))
        self.assertNotIn("stable up to", self.skerry("run", alone).stdout)

    def test_implicit_bodies_run_and_set_no_step(self):
        beam = {**SCENE["bodies"][0], "name": "beam", "dynamics": "implicit", "position": [0, 0, 0.5]}
        scene = self.write("implicit.json", {**SCENE, "probes": [], "bodies": [beam]})
        found = json.loads(self.skerry("inspect", scene, "--json").stdout)
        self.assertEqual(found["body_kinds"][0]["dynamics"], "implicit")
        self.assertAlmostEqual(found["stable_dt"], 1 / 120)
        self.assertIn("tetrahedra (implicit)", self.skerry("inspect", scene).stdout)
        self.assertIn("steps", self.skerry("run", scene).stdout)

    def test_inspect_says_what_another_value_would_do(self):
        written = json.loads(self.skerry("inspect", self.scene, "--json").stdout)
        place = f"materials.{SCENE['bodies'][0]['material']}.E"
        stiff = json.loads(self.skerry("inspect", self.scene, "--json", "--set", f"{place}=1e9").stdout)
        self.assertLess(stiff["stable_dt"], written["stable_dt"])
        self.assert_refused("inspect", self.scene, "--set", "materials.rubber.weight=1", said=["weight"])
        mesh = ROOT / "scenes/meshes/torus.msh"
        self.assert_refused("inspect", mesh, "--set", f"{place}=1e9", said=["torus.msh", "--set", "a mesh", "a scene"])

    def test_inspect_says_which_tetrahedra_bound_the_step(self):
        mesh = self.bad_box("bad.msh", cells=6)
        found = json.loads(self.skerry("inspect", mesh, "--json").stdout)["step_bound"]
        worst = found["worst"][0]
        self.assertLess(worst["altitude"], 0.1 * worst["mean_edge"])
        self.assertLess(max(abs(x) for x in worst["place"]), 0.5)
        self.assertAlmostEqual(worst["dt"], found["stable_dt"], delta=0.1 * found["stable_dt"])
        self.assertGreater(found["without"][-1]["stable_dt"], 1.5 * found["stable_dt"])
        said = self.skerry("inspect", mesh).stdout
        self.assertIn(f"tetrahedron {worst['tetrahedron']} at (", said)
        self.assertIn("without the worst", said)
        scene = self.write("bad.json", {**SCENE, "probes": [], "bodies": [
            {"name": "bad", "mesh": {"file": "bad.msh", "scale": 0.2}, "material": "rubber", "position": [0, 0, 1]}]})
        of_body = json.loads(self.skerry("inspect", scene, "--json").stdout)["body_kinds"][0]["step_bound"]
        self.assertAlmostEqual(of_body["worst"][0]["altitude"], 0.2 * worst["altitude"], places=9)
        self.assertIn(f"tetrahedron {worst['tetrahedron']} at (", self.skerry("inspect", scene).stdout)

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
        self.assert_refused("inspect", mesh, "--repair", self.folder / "out.vtk", said=["out.vtk", ".msh"])
        self.assert_refused("inspect", mesh, "--repair", mesh, said=["--overwrite"])
        self.assert_refused("inspect", mesh, "--repair", mesh / "x.msh", said=["no folder"])
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
        said = self.skerry("inspect", mesh, "--repair", mesh, "--overwrite").stdout
        for part in ("before", "after", "stable step", "worst altitude", "volume", "surface", "written"):
            self.assertIn(part, said)

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
        self.assertIn("1 node parted", self.skerry("inspect", mesh, "--repair", out, "--tolerance", 0).stdout)
        two = self.bad_box("two.msh", flat=1, kept=[(1, 1, 1), (2, 2, 2)])
        self.assert_refused("inspect", two, "--repair", self.folder / "none.msh", said=["2 parts", "mend each part"])

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
        self.assertIn("-1: 1, 20: 1 tetrahedra", self.skerry("inspect", mesh).stdout)
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
        self.assertTrue(any("a run takes that apart" in problem for problem in problems), problems)

    def test_a_step_that_fails_ends_with_one_and_keeps_the_figures(self):
        fast = json.loads(json.dumps(SCENE))
        fast["bodies"][0]["velocity"] = [0, 0, -1e5]
        stats = self.folder / "stats.json"
        done = self.skerry("run", self.write("fast.json", fast), "--stats", stats, code=1)
        self.assertIn("block", done.stderr)
        self.assertIn("--step", done.stderr)
        self.assertNotEqual(json.loads(stats.read_text())["status"], "ok")

    def test_an_interrupt_writes_what_there_is(self):
        stats = self.folder / "stats.json"
        with subprocess.Popen([PROGRAM, "run", self.scene, "--seconds", "1e6", "--stats", stats],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            time.sleep(1.5)
            process.send_signal(signal.SIGINT)
            _, stderr = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130, stderr)
        self.assertIn("stopped by a signal", stderr)
        self.assertIn("stopped by a signal", json.loads(stats.read_text())["status"])

    def test_help_teaches_and_the_version_is_said(self):
        self.assertIn("Examples", self.skerry("--help").stdout)
        self.assertIn("--contact-regions", self.skerry("run", "--help").stdout)
        self.assertRegex(self.skerry("--version").stdout, r"^skerry \d+\.\d+\.\d+")

    def test_the_schema_is_the_published_one(self):
        self.assertEqual(self.skerry("schema").stdout, (ROOT / "docs/scene.schema.json").read_text())

    def test_solve_refuses_what_is_not_a_problem(self):
        self.assert_refused("solve", self.write("not.hdf5", "text"), said=["not.hdf5"])
        self.assert_refused("solve", self.folder / "none.hdf5", said=["none.hdf5"])

    def exported(self, folder, *flags):
        self.skerry("run", self.scene, "--quiet", "--export-problems", self.folder / folder, *flags)
        return sorted(path.name for path in (self.folder / folder).iterdir())

    def test_reactions_do_not_take_the_place_of_their_problem(self):
        problem = self.folder / "problems" / self.exported("problems")[0]
        before = problem.read_bytes()
        self.assert_refused("solve", problem, "--reactions", problem, said=["--reactions", "the problem"])
        self.assertEqual(problem.read_bytes(), before)

    def test_contact_problems_of_a_run_are_written_and_solved(self):
        names = self.exported("problems")
        self.assertTrue(1 <= len(names) <= 21, names)  # a 20th of the steps each, of which some have no contacts
        for name in names:
            self.assertRegex(name, r"^drop-step\d{6}-contacts\d+\.hdf5$")
            reactions = self.folder / "reactions.txt"
            found = json.loads(self.skerry("solve", self.folder / "problems" / name, "--json", "--tolerance", 1e-9,
                                           "--reactions", reactions).stdout)
            self.assertEqual(found["problem"], name[:-5])
            self.assertEqual(found["contacts"], int(re.search(r"contacts(\d+)", name).group(1)))
            self.assertEqual(len(reactions.read_text().splitlines()), found["contacts"])
            self.assertTrue(found["converged"])
            self.assertLess(abs(found["energy_gap"]), 1e-9)
            for key in "condensed_freedoms largest_region unconverged error error_absolute error_over_q".split():
                self.assertIn(key, found)
        said = self.skerry("solve", self.folder / "problems" / names[-1]).stdout
        for word in ("contacts", "error", "absolute", "|q|", "energy gap"):
            self.assertIn(word, said)

    def test_which_problems_are_written_can_be_chosen(self):
        steps = self.exported("steps", "--export-every", 5)
        self.assertGreater(len(steps), 1)
        self.assertTrue(all(int(name[len("drop-step"):][:6]) % 5 == 0 for name in steps), steps)
        regions = self.exported("regions", "--export-every", 5, "--export-problems-of", "region")
        self.assertGreater(len(regions), len(steps))
        for step in steps:  # the contacts of a step's regions are those of the step
            begin = step[:len("drop-step000000")]
            parts = [int(re.search(r"contacts(\d+)-region\d+", name).group(1)) for name in regions
                     if name.startswith(begin)]
            self.assertEqual(sum(parts), int(re.search(r"contacts(\d+)", step).group(1)))
        said = self.skerry("run", self.scene, "--export-problems", self.folder / "again", "--export-every", 5).stdout
        self.assertIn(f"{len(steps)} contact problems of {len(steps)} steps", said)
        for name in steps:  # the same run gives the same bytes
            self.assertEqual((self.folder / "again" / name).read_bytes(), (self.folder / "steps" / name).read_bytes())

    def test_exporting_changes_nothing(self):
        hashes = []
        for flags in ([], ["--export-problems", self.folder / "problems", "--export-every", 7]):
            stats = self.folder / "stats.json"
            self.skerry("run", self.scene, "--quiet", "--stats", stats, *flags)
            hashes.append(json.loads(stats.read_text())["state_hash"])
        self.assertEqual(hashes[0], hashes[1])

    @unittest.skipUnless(os.environ.get("SKERRY_TEST_DATA"), "SKERRY_TEST_DATA names no folder with problems in it")
    def test_solve_writes_reactions_and_json(self):
        folder = pathlib.Path(os.environ["SKERRY_TEST_DATA"]) / "friction_problems"
        problem = sorted(folder.glob("*1c*.hdf5"))[0]
        reactions = self.folder / "reactions.txt"
        found = json.loads(self.skerry("solve", problem, "--json", "--reactions", reactions).stdout)
        for key in "problem contacts regions method tolerance iterations seconds error converged".split():
            self.assertIn(key, found)
        lines = reactions.read_text().splitlines()
        self.assertEqual(len(lines), found["contacts"])
        self.assertTrue(all(len(line.split()) == 3 for line in lines))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
