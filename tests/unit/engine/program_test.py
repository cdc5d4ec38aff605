"""The program from outside: exit codes, messages, files that are complete or absent, JSON that parses.

Called as: program_test.py PROGRAM SOURCE_FOLDER
"""
import json
import os
import pathlib
import re
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
        self.assert_refused("run", bad, *outputs, message=["bad.json", "secnods", '"seconds"'])
        self.assert_refused("run", self.write("syntax.json", '{"name": "x",\n}'), *outputs, message=["line 2, column"])
        self.assert_refused("run", self.folder / "none.json", *outputs, message=["none.json", "no such file"])
        self.assert_refused("inspect", bad, message=["secnods"])

    def test_output_that_cannot_be_written_is_refused_before_the_run(self):
        blocked = self.write("file", "") / "inside"
        endless = self.write("endless.json", {**SCENE, "seconds": 1e6})
        for flag in ("--stats", "--out", "--page", "--film", "--gltf", "--trace", "--export-problems"):
            self.assert_refused("run", endless, flag, blocked, message=["file", "not a folder"])
        self.assert_refused("run", endless, "--stats", self.folder, message=["a folder"])
        self.assert_refused("run", endless, "--film-color", "stress", message=["--film-color", "neither --film nor"])
        # One bad output among good ones: the good ones do not appear either.
        self.assert_refused("run", endless, "--out", self.folder / "out", "--stats", blocked, message=["not a folder"])

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
        self.assert_refused("run", endless, "--stats", protected, message=["protected.json", "a write-protected file"])
        self.assertEqual(protected.read_text(), "precious")
        with socket.socket(socket.AF_UNIX) as made:
            made.bind(str(self.folder / "socket"))
            self.assert_refused("run", endless, "--page", self.folder / "socket", message=["found a socket"])
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
        self.assert_refused("run", endless, "--stats", same, "--trace", other, message=["--trace", "--stats"])
        self.assert_refused("run", endless, "--page", endless, message=["--page", "the scene"])
        link = self.folder / "link.json"
        link.symlink_to(endless)
        self.assert_refused("run", endless, "--stats", link, message=["--stats", "the scene"])
        self.assertEqual(endless.read_text(), before)

    def test_times_that_cannot_be_counted_are_refused_and_the_shortest_is_simulated(self):
        self.assert_refused("run", self.write("long.json", {**SCENE, "seconds": 1e300}),
                            message=["long.json", "frames", "1e9"])
        self.assert_refused("run", self.scene, "--frames-per-second", "1e300", message=["frames", "1e9"])
        self.assert_refused("run", self.write("fine.json", {**SCENE, "probe_step": 1e-13}),
                            message=["samples", "probe_step"])
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
        self.assert_refused("view", self.scene, "--rate", "abc",
                            message=["--rate: found abc, expected a number from 0 to 1000"])
        self.assert_refused("view", self.scene, "--port", "65536",
                            message=["--port: found 65536, expected a whole number from 0 to 65535"])
        for command in ("run", "study"):
            self.assert_refused(command, self.scene, "--threads", "2000",
                                message=["--threads: found 2000, expected a whole number from 0 to 1024"])

    def test_a_mesh_that_is_not_one_is_refused(self):
        self.assert_refused("inspect", self.write("broken.msh", "nonsense"), message=["broken.msh"])
        self.assert_refused("inspect", self.folder / "none.msh", message=["none.msh"])

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
        with self.job("run", self.scene, "--seconds", "1e6", "--stats", stats) as process:
            process.send_signal(signal.SIGINT)
            _, stderr = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130, stderr)
        self.assertIn("stopped by a signal", stderr)
        self.assertIn("stopped by a signal", json.loads(stats.read_text())["status"])

    def test_a_live_view_ends_by_its_time_or_an_interrupt_and_refuses_a_port_in_use(self):
        done = self.skerry("view", self.scene, "--no-open", "--rate", 0, "--seconds", 0.05)
        self.assertRegex(done.stdout, r"drop: open http://127\.0\.0\.1:\d+/#token=[0-9a-f]{32} in a browser")
        self.assertRegex(done.stdout, r"simulated in .* times real time; frames: 0 sent, 0 dropped")
        view = subprocess.Popen([PROGRAM, "view", self.scene, "--no-open", "--paused"], stdout=subprocess.PIPE,
                                text=True)
        with view:
            port = re.search(r":(\d+)/", view.stdout.readline())[1]
            self.assert_refused("view", self.scene, "--no-open", "--port", port,
                                message=[f"live view: port: found {port}, which cannot be opened",
                                         "expected a free port"])
            view.send_signal(signal.SIGINT)
            self.assertIn("drop: 0 s simulated", view.stdout.read())
        self.assertEqual(view.returncode, 0)

    @unittest.skipIf(sys.platform == "darwin", "the program that opens files is called open")
    def test_the_browser_is_opened_without_the_token_in_its_arguments(self):
        opener, told = self.folder / "bin" / "xdg-open", self.folder / "told"
        opener.parent.mkdir()
        opener.write_text(f'#!/bin/sh\n{{ echo "$@"; stat -c %a "$1"; cat "$1"; }} > "{told}.part"\n'
                          f'mv "{told}.part" "{told}"\n')
        opener.chmod(0o755)
        own = {**os.environ, "DISPLAY": ":0", "PATH": f"{opener.parent}:{os.environ['PATH']}",
               "TMPDIR": str(self.folder)}
        with subprocess.Popen([PROGRAM, "view", self.scene, "--paused"], stdout=subprocess.PIPE, text=True,
                              env=own) as view:
            address = re.search(r"http\S+", view.stdout.readline())[0]
            end = time.monotonic() + 60
            while not told.exists() and time.monotonic() < end:
                time.sleep(0.01)
            view.send_signal(signal.SIGINT)
        argument, mode, page = told.read_text().split("\n", 2)
        self.assertNotIn(address.rpartition("=")[2], argument)
        self.assertIn(address, page)
        self.assertEqual(mode, "600")
        self.assertFalse(pathlib.Path(argument).parent.exists())

    def test_materials_are_listed_with_their_sources(self):
        found = json.loads(self.skerry("materials", "--json").stdout)
        text = self.skerry("materials").stdout
        self.assertGreaterEqual(len(found["materials"]), 25)
        for material in found["materials"]:
            self.assertIn(material["name"], text)
            for key in ("young_modulus", "poisson_ratio", "density"):
                self.assertGreaterEqual(material[key]["value"], 0)
                self.assertIn(material[key]["source"], text)
        for pair in found["frictions"]:
            self.assertIn(pair["source"], text)

    def test_help_teaches_and_the_version_is_said(self):
        self.assertIn("Examples", self.skerry("--help").stdout)
        self.assertIn("--contact-regions", self.skerry("run", "--help").stdout)
        self.assertRegex(self.skerry("--version").stdout, r"^skerry \d+\.\d+\.\d+")

    def test_the_schema_is_the_published_one(self):
        self.assertEqual(self.skerry("schema").stdout, (ROOT / "docs/scene.schema.json").read_text())

    def test_solve_refuses_what_is_not_a_problem(self):
        self.assert_refused("solve", self.write("not.hdf5", "text"), message=["not.hdf5"])
        self.assert_refused("solve", self.folder / "none.hdf5", message=["none.hdf5"])

    def exported(self, folder, *flags):
        self.skerry("run", self.scene, "--quiet", "--export-problems", self.folder / folder, *flags)
        return sorted(path.name for path in (self.folder / folder).iterdir())

    def test_reactions_do_not_take_the_place_of_their_problem(self):
        problem = self.folder / "problems" / self.exported("problems")[0]
        before = problem.read_bytes()
        self.assert_refused("solve", problem, "--reactions", problem, message=["--reactions", "the problem"])
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
        output = self.skerry("solve", self.folder / "problems" / names[-1]).stdout
        for word in ("contacts", "error", "absolute", "|q|", "energy gap"):
            self.assertIn(word, output)

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
        output = self.skerry("run", self.scene, "--export-problems", self.folder / "again", "--export-every", 5).stdout
        self.assertIn(f"{len(steps)} contact problems of {len(steps)} steps", output)
        for name in steps:  # the same run gives the same bytes
            self.assertEqual((self.folder / "again" / name).read_bytes(), (self.folder / "steps" / name).read_bytes())

    def test_problems_of_an_earlier_run_make_room_and_nothing_else_does(self):
        earlier = self.exported("problems", "--export-every", 5)
        mine = ["drop-step000005-contacts4.txt", "drop-step5.hdf5", "drop-step000005-contacts.hdf5", "notes.hdf5",
                "drop2-step000005-contacts4.hdf5"]
        for name in mine:
            (self.folder / "problems" / name).write_text("mine")
        found = self.exported("problems", "--export-every", 7)
        self.assertTrue(set(earlier) - set(found))
        self.assertEqual(found, sorted(self.exported("others", "--export-every", 7) + mine))

    def test_a_resumed_run_keeps_the_problems_before_its_checkpoint_only(self):
        flags = ("--export-every", 5, "--checkpoint", self.folder / "drop.skerry")
        self.exported("problems", *flags, "--seconds", 0.1)
        checkpoint = (self.folder / "drop.skerry").read_bytes()
        earlier = self.exported("problems", *flags)
        (self.folder / "drop.skerry").write_bytes(checkpoint)
        self.skerry("run", "--restart", self.folder / "drop.skerry", "--quiet", "--seconds", 0.15, "--export-every", 5,
                    "--export-problems", self.folder / "problems")
        found = sorted(path.name for path in (self.folder / "problems").iterdir())
        self.assertEqual(found, earlier[:len(found)])
        self.assertLess(len(found), len(earlier))

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
