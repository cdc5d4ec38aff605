"""Studies from outside: what they leave, how they go on after a signal, exit codes.

Called as: study_test.py PROGRAM SOURCE_FOLDER
"""
import csv
import json
import signal
import subprocess
import sys
import time
import unittest

sys.dont_write_bytecode = True
from program_case import PROGRAM, SCENE, ProgramCase


class StudyTest(ProgramCase):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "results"

    def study(self, *arguments, code=0):
        return self.skerry("study", self.scene, "--out", self.out, "--threads", 1, *arguments, code=code)

    def test_a_study_leaves_tables_a_page_and_the_cheapest_scene(self):
        done = self.study("--error", "50%", "--probe", "block.displacement_z", "--seconds", 0.05)
        self.assertIn("block.displacement_z_end", done.stdout)
        self.assertIn("wrote " + str(self.out / "study.html"), done.stdout)
        study = json.loads((self.out / "study.json").read_text())
        self.assertEqual((study["schema"], study["wanted_error"]), ("skerry.study/1", 0.5))
        with open(self.out / "study.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["quantity"] for row in rows], [found["name"] for found in study["quantities"]])
        self.assertTrue(all(name["name"].startswith("block.displacement_z") for name in study["quantities"]))
        for run in study["runs"]:
            self.assertEqual((self.out / f"run_{run['name']}.json").exists(), run["status"] != "left_out")
        stats = self.folder / "stats.json"
        finer = next(run for run in study["runs"] if run["name"] == "step_0.5")
        options = [option for text in finer["set"] for option in ("--set", text)]
        self.assertIn("seconds=0.05", finer["set"])
        self.skerry("run", self.scene, *options, "--quiet", "--stats", stats)
        self.assertEqual(json.loads(stats.read_text())["state_hash"], finer["state_hash"])
        self.assertEqual(json.loads((self.out / "cheapest.json").read_text())["seconds"], 0.05)
        self.skerry("run", self.out / "cheapest.json", "--quiet")
        self.study("--error", "1e-9", "--probe", "block.displacement_z", "--seconds", 0.05)
        self.assertFalse((self.out / "cheapest.json").exists())  # no settings reach this error
        again = self.study("--error", "0.5", "--probe", "block.displacement_z", "--seconds", 0.05, "--quiet")
        self.assertEqual((again.stdout, again.stderr), ("", ""))

    def test_a_signal_stops_a_study_and_the_same_command_continues_it(self):
        self.scene.write_text(json.dumps({**SCENE, "seconds": 20}))
        command = [PROGRAM, "study", self.scene, "--out", self.out, "--threads", "1", "--budget", "4"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, stderr=subprocess.DEVNULL) as process:
            while not (self.out / "run_scene.json").exists() and process.poll() is None:
                time.sleep(0.01)
            process.send_signal(signal.SIGINT)
            output, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 128 + signal.SIGINT)
        self.assertIn("Run the same command again", output)
        names = {path.name for path in self.out.iterdir()}
        self.assertIn("run_scene.json", names)
        self.assertFalse([name for name in names if not name.endswith(".json") or name == "study.json"])

    def test_bad_input_is_refused_before_a_run(self):
        self.assert_refused("study", self.scene, "--out", self.out, "--error", "much",
                            message=["--error", "much", "1%"])
        self.assert_refused("study", self.scene, "--out", self.out, "--probe", "blokc", message=['"blokc"', '"block"'])
        scene = self.write("study.json", SCENE)
        self.assert_refused("study", scene, "--out", self.folder, message=["study.json", "SCENE"])

    def test_files_that_the_scene_includes_are_no_outputs(self):
        self.out.mkdir()
        included = self.out / "cheapest.json"
        included.write_text(json.dumps(SCENE))
        scene = self.write("whole.json", {"include": ["results/cheapest.json"]})
        self.assert_refused("study", scene, "--out", self.out, message=["cheapest.json", "a file of SCENE"])
        self.assertEqual(json.loads(included.read_text()), SCENE)

    def test_runs_of_another_scene_are_replaced_only_on_request(self):
        self.study("--seconds", 0.01, "--budget", 4)
        refused = self.study("--seconds", 0.02, "--budget", 4, code=2)
        self.assertIn("redo", refused.stderr)
        self.study("--seconds", 0.02, "--budget", 4, "--redo")

    def test_a_scene_that_fails_has_exit_code_1(self):
        body = {**SCENE["bodies"][0], "velocity": [0, 0, -1e6]}
        self.scene.write_text(json.dumps({**SCENE, "bodies": [body]}))
        self.assertIn("could not be run to its end", self.study(code=1).stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
