"""Runs of the program: progress, exit codes, outputs, and inputs with huge numbers.

Called as: program_run_test.py PROGRAM SOURCE_FOLDER
"""
import json
import re
import resource
import signal
import subprocess
import sys
import unittest

from program_case import PROGRAM, ROOT, SCENE, ProgramCase

# A run of a day within its first frame. Sleeping bodies would end it at once.
SLOW = {**SCENE, "seconds": 1e5, "frame_step": 1e5, "probe_step": 1e5, "settings": {"sleep": False}}


class ProgramRunTest(ProgramCase):
    def test_an_energy_error_of_some_per_cent_is_a_warning(self):
        # the board turns by more than a radian in a step
        tumbling = {"name": "tumbling", "seconds": 0.5, "settings": {"gravity": [0, 0, 0]},
                    "materials": {"firm": {"rho": 1000}},
                    "bodies": [{"name": "board", "mesh": {"box": {"size": [0.1, 0.2, 0.4], "cells": [1, 1, 2]}},
                                "material": "firm", "dynamics": "rigid", "angular_velocity": [180, 1, 120]}]}
        trust = json.loads(self.run_with_stats(self.write("tumbling.json", tumbling)))["trust"]
        self.assertGreater(trust["energy"]["share"], 0.02)
        warning = next(warning for warning in trust["warnings"] if "energy balance has an error" in warning)
        self.assertIn("settings.step_size below the mean step of 8.33 ms", warning)
        calm = json.loads(self.run_with_stats(self.scene))["trust"]
        self.assertLess(calm["energy"]["share"], 0.01)
        self.assertEqual(calm["warnings"], [])

    def test_a_run_from_rest_does_not_move(self):
        stats = self.folder / "rest_stats.json"
        done = self.skerry("run", self.scene, "--from-rest", "--stats", stats, "--seconds", "0.1")
        self.assertRegex(done.stderr, r"NOTE: the run starts from a static equilibrium, which took \d+ steps")
        self.assertLess(json.loads(stats.read_text())["energy"]["kinetic"], 1e-6)

    def test_the_summary_and_the_statistics_have_estimated_errors(self):
        # all nodes of one face are held, and the bar bends under its weight
        bar = {"name": "bar", "seconds": 0.05, "materials": {"m": {"E": 1e5}},
               "bodies": [{"name": "bar", "mesh": {"box": {"size": [0.4, 0.1, 0.1], "cells": [4, 1, 1]}},
                           "material": "m", "pin": {"box": {"lower": [-1, -1, -1], "upper": [-0.19, 1, 1]}}}]}
        stats = self.folder / "bar_stats.json"
        summary = self.skerry("run", self.write("bar.json", bar), "--stats", stats).stdout
        self.assertRegex(summary, r"\n  errors +mesh about [0-9.]+ % of .*, steps about [0-9.e-]+ % of")
        [errors] = json.loads(stats.read_text())["errors"]
        self.assertEqual(errors["body"], "bar")
        self.assertTrue(0.1 < errors["deflection"] < 1, errors)

    def test_a_run_without_equilibrium_ends_before_its_start(self):
        # the incline is steeper than the friction angle
        steep = {**SCENE, "settings": {"gravity": [7, 0, -7]}, "materials": {"m": {"mu": 0.1}},
                 "bodies": [{**SCENE["bodies"][0], "material": "m", "dynamics": "rigid"}]}
        done = self.skerry("run", self.write("steep.json", steep), "--from-rest", code=1)
        self.assertRegex(done.stderr, "--from-rest: found no equilibrium: after .* on body 'block' is")

    def test_held_nodes_inside_a_collider_are_a_warning_with_their_depth(self):
        led = {"name": "led", "seconds": 0.2, "settings": {"gravity": [0, 0, 0]}, "materials": {"m": {}},
               "bodies": [{"name": "cube", "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [2, 2, 2]}},
                           "material": "m", "position": [0, 0, 0.06],
                           "pin": {"box": {"lower": [-1, -1, -1], "upper": [1, 1, 1]},
                                   "motion": {"velocity": [0, 0, -0.15]}}}],
               "colliders": [{"name": "floor", "shape": {"plane": {}}}]}
        stats = self.folder / "led_stats.json"
        summary = self.skerry("run", self.write("led.json", led), "--stats", stats).stdout
        line = next(line for line in summary.splitlines() if line.startswith("  penetration"))
        self.assertRegex(line, r"held surfaces at most (19\.[0-9]|20) mm")
        self.assertRegex(summary, r'WARNING       held nodes of body "cube" are up to (19\.[0-9]|20) mm deep inside '
                                  '"floor", and no contact can push them out: correct the place or the motion of one')
        found = json.loads(stats.read_text())["trust"]["penetration"]
        self.assertAlmostEqual(found["held"], 0.02, delta=1e-3)
        self.assertEqual((found["held_body"], found["held_in"]), ("cube", "floor"))

    def test_the_summary_names_ties_that_broke_with_time_and_force(self):
        block = {"mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}}, "material": "rubber",
                 "name": "block", "dynamics": "implicit"}
        scene = {"seconds": 0.4, "settings": {"gravity": [0, 0, 0], "step_size": 1e-3},
                 "materials": {"rubber": {"E": 1e6}}, "bodies": [block],
                 "ties": [{"name": "weak", "body": "block", "nodes": [0], "break_force": 2}],
                 "loads": [{"kind": "force", "body": "block", "nodes": [0], "force": [10, 0, 0],
                            "scale": [[0, 0], [1, 1]]}]}
        stats = self.folder / "stats.json"
        summary = self.skerry("run", self.write("torn.json", scene), "--stats", stats).stdout
        self.assertRegex(summary, r"  ties +weak: 1 of 1 node broke off at 20\d ms; largest force of the tie 2[.\d]* N")
        tie = json.loads(stats.read_text())["broken_ties"]["weak"]
        self.assertEqual((tie["nodes"], tie["broken"]), (1, 1))
        self.assertEqual(tie["first_time"], tie["last_time"])
        self.assertAlmostEqual(tie["first_time"], 0.2, delta=2e-3)
        self.assertTrue(2 < tie["largest_force"] < 2.02, tie)

    def test_a_run_in_which_surfaces_cross_ends_with_its_own_status_and_exit_code(self):
        # Two boxes close on a cube until nothing is left between them.
        def finger(side):
            keys = [{"time": 0, "position": [side * 0.026, 0, 0]}, {"time": 0.1, "position": [side * 0.005, 0, 0]}]
            return {"shape": {"box": {"size": [0.01, 0.1, 0.1]}}, "motion": {"keys": keys}}
        scene = {"name": "closed", "seconds": 0.11, "settings": {"gravity": [0, 0, 0]}, "materials": {"m": {}},
                 "bodies": [{"mesh": {"box": {"size": [0.04, 0.04, 0.04], "cells": [2, 2, 2]}}, "material": "m"}],
                 "colliders": [finger(-1), finger(1)]}
        stats = self.folder / "closed_stats.json"
        done = self.skerry("run", self.write("closed.json", scene), "--stats", stats, "--profile", code=4)
        self.assertIn("NOT TRUSTED", done.stdout)
        self.assertIn("cannot be trusted", done.stderr)
        self.assertIn("balance       not to be trusted: energy error", done.stdout)
        self.assertIn("; not to be trusted", next(line for line in done.stdout.splitlines() if "dissipated" in line))
        found = json.loads(stats.read_text())
        self.assertEqual(found["status"], found["trust"]["distrust"])
        self.assertIn("cannot be trusted", found["status"])
        self.assertAlmostEqual(found["seconds_simulated"], 0.11)
        self.assertEqual(json.loads(self.run_with_stats(self.scene))["trust"]["distrust"], "")

    def test_values_in_wrong_units_are_warnings_before_the_start(self):
        def warnings(*settings):
            done = self.skerry("run", self.scene, "--seconds", 1e-3, *(part for s in settings for part in ("--set", s)))
            lines = [line for line in done.stderr.splitlines() if line.startswith("skerry: WARNING: ")]
            for line in lines:
                self.assertIn(line.removeprefix("skerry: "), re.sub(r"WARNING +", "WARNING: ", done.stdout))
            return lines
        self.assertEqual(warnings(), [])
        sag = warnings("materials.rubber.E=0.02")
        self.assertEqual(len(sag), 1)
        self.assertIn('body "block" sags by about 49,000 times its height under its own weight', sag[0])
        self.assertIn("is E in Pa", sag[0])
        large = warnings("bodies[0].mesh.scale=200", "bodies[0].position=[0,0,25]", "probes=[]")
        self.assertIn("times its height", large[0])
        self.assertIn("is it in g/cm^3?", warnings("materials.rubber.rho=1")[0])
        self.assertIn("more than any material", warnings("materials.rubber.rho=1e6", "materials.rubber.E=1e8")[0])
        self.assertIn("more than diamond", warnings("materials.rubber.E=2e14")[0])
        self.assertIn("is it in m/s^2?", warnings("settings.gravity=[0,0,-9810]", "materials.rubber.E=1e8")[0])
        self.assertEqual(warnings("materials.rubber.E=0.02", "settings.gravity=[0,0,0]"), [])
        heavy = ['bodies[0].dynamics="rigid"', "bodies[0].mass=1e6"]
        self.assertIn('is "mass" in kg', warnings(*heavy)[0])
        self.assertIn("centre of mass", warnings(*heavy, "bodies[0].center_of_mass=[9,0,0]",
                                                 "bodies[0].inertia=[[1e6,0,0],[0,1e6,0],[0,0,1e6]]")[-1])
        yields = ['materials.rubber.model="hencky"', 'materials.rubber.plasticity={"yield_stress":1e-4}']
        self.assertIn("far below its Young's modulus", warnings(*yields, 'bodies[0].dynamics="rigid"')[-1])
        self.assertIn("does not yield", warnings(*yields, 'bodies[0].dynamics="rigid"')[0])
        small = '{"name":"chip","mesh":{"ball":{"radius":1e-5,"resolution":2}},"material":"rubber","position":[9,9,9]}'
        block = json.dumps(SCENE["bodies"][0])
        self.assertIn("mesh.scale to 0.001", warnings(f"bodies=[{block},{small}]")[0])
        inspected = self.skerry("inspect", self.scene, "--set", "materials.rubber.E=0.02").stdout
        self.assertIn("sags by about 49,000 times its height", inspected)

    def test_a_thin_part_is_named_where_a_later_body_changed_the_order_of_bodies(self):
        # The second body makes the first one explicit, and World::bodies() then lists the first one last.
        def body(name, size, cells, height, **more):
            return {"name": name, "mesh": {"box": {"size": size, "cells": cells}}, "material": "stiff",
                    "position": [0, 0, height], **more}
        scene = {"name": "order", "seconds": 1e-5, "materials": {"stiff": {"E": 1e9}},
                 "bodies": [body("plate", [1, 0.2, 0.05], [20, 4, 1], 1),
                            body("crumb", [0.01, 0.01, 0.01], [1, 1, 1], 1.5, dynamics="explicit")]}
        warnings = json.loads(self.run_with_stats(self.write("order.json", scene)))["trust"]["warnings"]
        self.assertTrue(any(text.startswith("body 'plate': a part 50 mm thick") for text in warnings), warnings)

    def test_a_mesh_is_too_stiff_only_for_a_body_that_deforms(self):
        def warnings(poisson_ratio, **body):
            plate = {"name": "plate", "mesh": {"box": {"size": [0.4, 0.2, 0.2], "cells": [4, 2, 2]}},
                     "material": "soft", "dynamics": "explicit", **body}
            scene = {"name": "plate", "seconds": 0.05, "bodies": [plate],
                     "materials": {"soft": {"E": 1e5, "nu": poisson_ratio}}}
            return json.loads(self.run_with_stats(self.write("plate.json", scene)))["trust"]["warnings"]
        held = {"pin": {"box": {"lower": [-1, -1, -1], "upper": [-0.19, 1, 1]}}}
        thin = {"mesh": {"box": {"size": [0.4, 0.2, 0.04], "cells": [8, 4, 1]}}}
        linear = {"element": "linear"}
        locks = ["body 'plate': elements of the kind \"linear\" lock at a Poisson ratio of 0.49: in bending they are "
                 "more than twice as stiff as the material: set \"element\" of the body to \"smoothed\""]
        self.assertEqual(warnings(0.49, **held, **linear), locks)
        self.assertEqual(warnings(0.4, **held, **linear), [])
        self.assertEqual(warnings(0.49, **held), [])
        self.assertEqual(warnings(0.49, **linear), [])  # it only falls
        self.assertEqual(warnings(0.4, **thin), [])
        [text] = warnings(0.49, **held, **linear, **thin)
        self.assertIn("has 1 layer of cells", text)

    def test_contact_areas_smaller_than_the_cells_are_a_warning_if_a_probe_depends_on_them(self):
        scene = {"name": "impact", "seconds": 0.02, "frame_step": 0.001, "settings": {"gravity": [0, 0, 0]},
                 "materials": {"rubber": {"E": 1e6}},
                 "bodies": [{"name": "ball", "mesh": {"ball": {"radius": 0.05, "resolution": 4}}, "material": "rubber",
                             "position": [0, 0, 0.0505], "velocity": [0, 0, -0.02], "dynamics": "explicit"}],
                 "colliders": [{"name": "floor", "shape": {"plane": {"normal": [0, 0, 1]}}}]}
        def warnings(**changes):
            found = json.loads(self.run_with_stats(self.write("impact.json", {**scene, **changes})))
            return found["trust"]["warnings"], found["errors"][0]
        stress = {"name": "stress", "quantity": "stress", "body": "ball"}
        force = {"name": "force", "quantity": "force", "body": "ball"}
        [text], error = warnings(probes=[force])
        self.assertLess(error["contact_radius"], 0.25 * error["contact_edge"])
        self.assertRegex(text, "^the contact areas of body 'ball' have a radius of up to .* mm by the theory of Hertz, "
                               "less than the edges there, .* mm: impacts take about 0.[56]\\d* times as long as they "
                               "should, and their forces are too large accordingly: make the cells there .* times "
                               "smaller$")
        self.assertIn("the stress there is wrong", warnings(probes=[stress])[0][0])
        self.assertEqual(warnings()[0], [])
        finer = [{**scene["bodies"][0], "mesh": {"ball": {"radius": 0.05, "resolution": 6}}, "velocity": [0, 0, -0.5]}]
        self.assertEqual(warnings(bodies=finer, probes=[force])[0], [])

    def test_a_position_that_keys_replace_is_a_warning(self):
        def collider(position):
            keys = [{"time": 0, "position": [0, 0, -1]}, {"time": 1, "position": [0, 0, -2]}]
            shape = {"box": {"size": [1, 1, 1]}}
            scene = {**SCENE, "seconds": 1e-3,
                     "colliders": [{"name": "lift", "shape": shape, "position": position, "motion": {"keys": keys}}]}
            return self.skerry("run", self.write("lift.json", scene)).stdout
        self.assertIn('collider "lift" starts at the position [0.0,0.0,-1.0] of its first key', collider([0, 0, -3]))
        for position in ([0, 0, -1], [0, 0, 0]):
            self.assertNotIn('"lift" starts', collider(position))

    def test_a_body_that_goes_through_itself_is_a_warning_and_penetration_is_not_claimed_to_be_zero(self):
        # a strip whose right end turns by 0.7 revolutions, into its left half
        end = {"lower": [0.089, -1, -1], "upper": [1, 1, 1]}
        fold = {"name": "fold", "seconds": 0.7, "settings": {"gravity": [0, 0, 0]}, "materials": {"soft": {"E": 2e4}},
                "bodies": [{"name": "strip", "mesh": {"box": {"size": [0.2, 0.04, 0.02], "cells": [10, 2, 1]}},
                            "material": "soft",
                            "pin": [{"box": {"lower": [-1, -1, -1], "upper": [-0.089, 1, 1]}},
                                    {"box": end, "motion": {"angular_velocity": [0, -6.28, 0]},
                                     "pivot": [0, 0, 0.015]}]}]}
        scene = self.write("fold.json", fold)
        stats = json.loads(self.run_with_stats(scene))
        (found,) = stats["self_crossings"]
        self.assertEqual((found["body"], found["self_contact"]), ("strip", False))
        self.assertGreater(found["first_time"], 0.3)
        self.assertGreater(found["most_places"], 0)
        warning = next(text for text in stats["trust"]["warnings"] if "'strip' crosses itself" in text)
        self.assertIn('set "self_contact" of this body to true', warning)
        summary = self.skerry("run", scene).stdout
        self.assertIn("a surface crosses itself, to a depth that is not measured", summary)
        self.assertIn("WARNING       the surface of body 'strip' crosses itself", summary)
        self.assertIn("; no surface crosses itself", self.skerry("run", self.scene).stdout)

    def test_pins_that_leave_no_node_free_are_a_warning(self):
        halves = [{"box": {"lower": [-1, -1, low], "upper": [1, 1, low + 1]}} for low in (-1.01, 0.01)]
        body = {"name": "pad", "mesh": {"box": {"size": [0.1, 0.1, 0.04], "cells": [2, 2, 1]}}, "material": "soft",
                "pin": halves}
        scene = self.write("pad.json", {"seconds": 0.01, "materials": {"soft": {"E": 1e5}}, "bodies": [body]})
        warning = 'the pins of body "pad" hold all of its nodes, so that none can move between them: refine its mesh'
        self.assertIn(warning, self.skerry("run", scene).stderr)
        self.assertNotIn("hold all", self.skerry("run", scene, "--set", "bodies[0].mesh.box.cells=[2,2,2]").stderr)
        self.assertNotIn("hold all", self.skerry("run", scene, "--set", 'bodies[0].pin[1].axes=["z"]').stderr)

    def test_a_pin_that_rotates_about_the_far_origin_is_a_warning(self):
        top = {"lower": [-1, -1, 0.149], "upper": [1, 1, 1]}
        turn = {"keys": [{"time": 0}, {"time": 1, "rotation": {"axis": [0, 0, 1], "degrees": 20}}]}
        body = {"name": "bar", "mesh": {"box": {"size": [0.1, 0.1, 0.3], "cells": [2, 2, 6]}}, "material": "soft",
                "position": [1, 2, 3], "pin": [{"box": top, "motion": turn}]}
        scene = self.write("turn.json", {"seconds": 0.01, "settings": {"gravity": [0, 0, 0]},
                                         "materials": {"soft": {"E": 1e5}}, "bodies": [body]})
        self.assertIn('pin 0 of body "bar" rotates about the origin of the world, 3.74 m away: give the centre of '
                      'rotation as "position" of every key', self.skerry("run", scene).stderr)
        body["pin"][0]["pivot"] = [1, 2, 3]
        scene = self.write("turn.json", {"materials": {"soft": {"E": 1e5}}, "bodies": [body]})
        found = self.skerry("run", scene, code=2).stderr
        self.assertIn("pivot", found)
        self.assertIn("give each key the position of the centre of rotation", found)
        for key in turn["keys"]:
            key["position"] = [1, 2, 3]
        del body["pin"][0]["pivot"]
        scene = self.write("turn.json", {"seconds": 0.01, "materials": {"soft": {"E": 1e5}}, "bodies": [body]})
        self.assertNotIn("rotates about", self.skerry("run", scene).stderr)

    def test_the_summary_is_short_and_details_are_printed_on_request(self):
        short = self.skerry("run", self.scene).stdout
        self.assertLessEqual(len(short.splitlines()), 15, short)
        for part in ("real time", str(self.scene), "1 deformable, 1 collider", "tetrahedra", "contacts", "penetration",
                     "balance", "warnings      none", "base: sticks", "--page FILE.html"):
            self.assertIn(part, short)
        details = ("regions", "solver", "stages", "solver/solve_regions", "volume ratio", "kinetic", "state hash")
        for part in details:
            self.assertNotIn(part, short)
        long = self.skerry("run", self.scene, "--profile").stdout
        for part in details:
            self.assertIn(part, long)
        self.skerry("run", self.scene, "--profile", "--quiet", code=2)

    def blocked(self, *names):
        """A name at which a file cannot be written, from a certain moment of the run on: a full disk to the program."""
        place = self.folder.joinpath(*names)
        (place / "not empty").mkdir(parents=True)

    def test_an_output_that_cannot_be_written_takes_no_other_with_it(self):
        out, page, stats, trace = (self.folder / name for name in ("out", "page.html", "stats.json", "trace.json"))
        outputs = ("--out", out, "--page", page, "--stats", stats, "--trace", trace)
        self.blocked("out", "drop_contacts_0003.vtp.part")
        done = self.skerry("run", self.scene, *outputs, code=3)
        self.assertIn("drop_contacts_0003.vtp: output: found", done.stderr)
        self.assertIn("--out could not be written", done.stderr)
        self.assertIn("NOT WRITTEN   --out", done.stdout)
        self.assertNotIn(f"wrote         {out}", done.stdout)
        found = json.loads(stats.read_text())
        self.assertEqual((found["status"], list(found["outputs_failed"])), ("ok", ["--out"]))
        self.assertAlmostEqual(found["seconds_simulated"], 0.2)
        self.assertIn("<html", page.read_text()[:2000].lower())
        self.assertTrue(json.loads(trace.read_text()))
        frames = sorted(path.name for path in out.glob("drop_*.vt*") if path.is_file())
        self.assertEqual(frames, sorted([f"drop_bodies_000{i}.vtu" for i in range(3)] + ["drop_colliders_0000.vtp"] +
                                        [f"drop_contacts_000{i}.vtp" for i in range(3)]))
        self.assertTrue(all(name in (out / "drop.pvd").read_text() for name in frames))

        self.blocked("page.html.part")
        done = self.skerry("run", self.scene, "--page", page, "--stats", stats, "--out", self.folder / "good", code=3)
        self.assertIn("--page could not be written", done.stderr)
        self.assertEqual(list(json.loads(stats.read_text())["outputs_failed"]), ["--page"])
        self.assertTrue((self.folder / "good" / "drop.pvd").exists())

        endless = self.write("endless.json", {**SCENE, "seconds": 1e6})  # with nothing left to write it ends
        done = self.skerry("run", endless, "--out", out, code=3)
        self.assertIn("none of the outputs can be written", done.stderr)

    def test_a_film_that_finds_no_room_leaves_no_file_and_the_run_goes_on(self):
        film, probes = self.folder / "film.usd", self.folder / "probes.csv"
        scene = self.write("probed.json", {**SCENE, "probes": [{"name": "energy", "quantity": "energy"}]})
        done = subprocess.run([PROGRAM, "run", scene, "--film", film, "--probes", probes], capture_output=True,
                              text=True, timeout=300, check=False,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4000, 4000)))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("film.usd: output: found the error \"File too large\" while writing", done.stderr)
        self.assertIn("NOT WRITTEN   --film", done.stdout)
        files = sorted(file.name for file in self.folder.iterdir())
        self.assertEqual(files, ["drop.json", "probed.json", "probes.csv"])

    def test_frames_of_an_earlier_run_make_room_and_nothing_else_does(self):
        out = self.folder / "out"
        self.skerry("run", self.scene, "--out", out, "--quiet")
        mine = ["notes.txt", "drop_bodies_old.vtu", "drop_bodies_0009.vtp", "drop_bodies_001.vtu",
                "drop_extra_0009.vtu", "drop2_bodies_0009.vtu", "xdrop_bodies_0009.vtu", "stats.json"]
        for name in mine:
            (out / name).write_text("mine")
        (out / "drop_bodies_0010.vtu").unlink()
        (out / "drop_bodies_0010.vtu").symlink_to("notes.txt")
        self.assertTrue((out / "drop_bodies_0012.vtu").exists())
        self.skerry("run", self.scene, "--seconds", 0.05, "--out", out, "--quiet")
        frames = sorted(path.name for path in out.iterdir() if path.name not in mine)
        self.assertEqual(frames, sorted([f"drop_bodies_000{i}.vtu" for i in range(4)] + ["drop_colliders_0000.vtp"] +
                                        [f"drop_contacts_000{i}.vtp" for i in range(4)] +
                                        ["drop.pvd", "drop_bodies_0010.vtu"]))
        for name in mine:
            self.assertEqual((out / name).read_text(), "mine")
        kept = out / "drop_bodies_0003.vtu"
        kept.chmod(0o444)
        self.assert_refused("run", self.scene, "--seconds", 0.01, "--out", out,
                            message=["drop_bodies_0003", "protected"])
        kept.chmod(0o644)

    def test_an_output_that_another_process_writes_is_refused_with_the_name_of_both(self):
        out, probes = self.folder / "out", self.folder / "probes.csv"
        fast = self.write("fast.json", {**SCENE, "probes": [{"name": "energy", "quantity": "energy"}]})
        slow = self.write("slow.json", {**SLOW, "probes": [{"name": "energy", "quantity": "energy"}]})
        other = self.write("other.json", {**SCENE, "name": "other"})
        with self.job("run", slow, "--out", out, "--probes", probes, "--checkpoint", self.folder / "c") as process:
            for option, path in (("--out", out), ("--probes", probes), ("--checkpoint", self.folder / "c")):
                before = {file: file.read_bytes() for file in self.folder.rglob("*") if file.is_file()}
                self.assert_refused("run", fast, option, path,
                                    message=[f"{path}: {option}: found an output of process {process.pid} on ",
                                             f"(skerry run {slow}), expected"])
                self.assertEqual({file: file.read_bytes() for file in before}, before)
            self.skerry("run", other, "--out", out, "--quiet")  # a scene with another name has other files
            process.kill()
            process.communicate(timeout=60)
        self.assertTrue((out / "drop.lock").exists())
        self.skerry("run", fast, "--out", out, "--quiet")  # a killed process reserves nothing
        self.assertEqual(sorted(file.name for file in self.folder.rglob("*.lock")), ["c.lock", "probes.csv.lock"])

    def test_no_output_goes_among_the_frames_under_their_names(self):
        out = self.folder / "out"
        for name in ("drop.pvd", "drop_bodies_0000.vtu", "drop_colliders_0007.vtp"):
            self.assert_refused("run", self.scene, "--out", out, "--stats", out / name,
                                message=["--stats", "--out also writes"])
        self.skerry("run", self.scene, "--seconds", 0.02, "--out", out, "--quiet", "--stats", out / "drop_0000.json")

    def test_a_material_or_a_mesh_beyond_all_numbers_is_named(self):
        for change in ({"rho": 1e-300}, {"E": 1e308}):
            scene = {**SCENE, "materials": {"rubber": {**SCENE["materials"]["rubber"], **change}}}
            self.assert_refused("run", self.write("wild.json", scene), message=["materials.rubber", "kg/m^3", "light"])
        scene = json.loads(json.dumps(SCENE))
        scene["bodies"][0]["mesh"]["scale"] = 1e-30
        scene["probes"] = []
        self.assert_refused("run", self.write("dot.json", scene),
                            message=["block", "mesh, material: found a mean edge length of"])

    def test_an_interrupt_ends_a_run_within_a_frame_that_would_take_hours_and_what_there_is_is_whole(self):
        slow = self.write("slow.json", SLOW)
        stats, page, out, film = (self.folder / name for name in ("stats.json", "page.html", "out", "film.usd"))
        with self.job("run", slow, "--stats", stats, "--page", page, "--out", out, "--film", film) as process:
            process.send_signal(signal.SIGINT)
            stdout, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, stderr)
        found = json.loads(stats.read_text())
        self.assertIn("stopped by a signal", found["status"])
        self.assertGreater(found["seconds_simulated"], 0)
        self.assertIn("stopped by a signal", stdout)
        self.assertTrue(page.exists())
        self.assertTrue(film.read_bytes().startswith(b"PXR-USDC"))
        frames = sorted(path.name for path in out.glob("drop_bodies_*.vtu"))
        self.assertEqual(frames, ["drop_bodies_0000.vtu", "drop_bodies_0001.vtu"])
        for frame in frames:
            self.assertIn(frame, (out / "drop.pvd").read_text())
        self.assertEqual(list(self.folder.rglob("*.part")), [])
        probe = found["probes"]["base"]
        self.assertAlmostEqual(sum(probe[key] for key in ("stick_time", "slide_time", "open_time")),
                               found["seconds_simulated"])

    def test_a_run_says_how_much_there_is_to_do_and_how_long_it_will_take(self):
        with subprocess.Popen([PROGRAM, "run", self.write("slow.json", SLOW)],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            lines = [process.stderr.readline() for _ in range(3)]
            process.send_signal(signal.SIGTERM)
            process.communicate(timeout=60)
        self.assertEqual(process.returncode, 128 + signal.SIGTERM)
        self.assertRegex(lines[0], r"^skerry: 100000 s to simulate, about [\d,]+ steps of [\d.]+ ms$")
        for line in lines[1:]:
            self.assertRegex(line, r"after [\d.]+ s: .* of 100000 s .* steps; about .* left$")
        steps = [int(re.search(r"([\d,]+) steps", line)[1].replace(",", "")) for line in lines[1:]]
        self.assertGreater(steps[1], steps[0])

    def test_inspect_estimates_the_cost_of_the_whole_run(self):
        found = json.loads(self.skerry("inspect", self.scene, "--json").stdout)
        self.assertAlmostEqual(found["wall_seconds"], 0.2 * found["wall_seconds_per_second"])
        self.assertEqual(found["trial_seconds"], 0.2)
        self.assertIn("measured in a trial of the whole run", self.skerry("inspect", self.scene).stdout)
        # The block is thrown onto the floor, where it needs shorter steps than in flight.
        thrown = {**SCENE, "bodies": [{**SCENE["bodies"][0], "position": [0, 0, 0.3], "velocity": [0, 0, -6]}]}
        scene = self.write("thrown.json", {**thrown, "probes": []})
        run = json.loads(self.run_with_stats(scene))
        self.assertGreater(run["steps"], 1.1 * 0.2 / run["stable_dt"])
        found = json.loads(self.skerry("inspect", scene, "--json").stdout)
        self.assertAlmostEqual(found["steps"], run["steps"], delta=1)

    def test_inspect_estimates_a_run_that_is_too_long_to_try(self):
        found = json.loads(self.skerry("inspect", self.write("slow.json", SLOW), "--json").stdout)
        self.assertGreater(found["trial_seconds"], 0)
        self.assertLess(found["trial_seconds"], SLOW["seconds"])
        self.assertGreater(found["wall_seconds"], 0)
        self.assertGreater(found["steps"], 0.9 * SLOW["seconds"] / found["stable_dt"])
        self.assertRegex(self.skerry("inspect", self.folder / "slow.json").stdout,
                         r"cost +about .* of wall time for the whole run, .* per simulated second, "
                         r"estimated from a trial of the first [\d.e+]+ s\n")

    def test_a_run_names_the_chosen_dynamics_in_one_line(self):
        block = SCENE["bodies"][0]
        stiff = {**block, "name": "stiff", "material": "steel", "position": [0, 0, 3]}
        scene = self.write("mixed.json", {**SCENE, "probes": [], "bodies": [block, stiff],
                                          "materials": {**SCENE["materials"], "steel": {"E": 2e11}}})
        lines = [line for line in self.skerry("run", scene).stdout.splitlines() if "  dynamics  " in line]
        self.assertEqual(len(lines), 1)
        self.assertRegex(lines[0], r"2 bodies: 1 explicit \(soft: strains of up to [\d.]+ % expected\), "
                                   r"1 implicit \(stiff: explicit steps would cost [\d,]+ times as much\)")

    def run_with_stats(self, scene, *arguments):
        stats = self.folder / "stats.json"
        self.skerry("run", scene, "--quiet", "--stats", stats, *arguments)
        return stats.read_text()


class SetTest(ProgramCase):
    def test_values_of_a_scene_are_changed_and_mistakes_refused(self):
        stats = self.folder / "stats.json"
        change = ["--set", "bodies[0].name=brick", "--set", "probes[0].body=brick"]
        self.skerry("run", "--set", "seconds=0.05", self.scene, *change, "--quiet", "--stats", stats)
        self.assertAlmostEqual(json.loads(stats.read_text())["seconds_simulated"], 0.05)
        self.assertEqual(json.loads(stats.read_text())["stable_dt_body"], "brick")
        self.assert_refused("run", self.scene, "--set", "bodies[7].name=brick",
                            message=["index 7 in a list of length ", "drop.json"])
        for step in ("--step", "1e-300"), ("--set", "settings.step_size=1e-300"):
            self.assert_refused("run", self.scene, *step,
                                message=["drop.json: run: steps of settings.step_size per frame", "found 5e+297"])
        self.assert_refused("run", self.scene, "--set", "settings.gravitee=1", message=["gravitee", "gravity"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
