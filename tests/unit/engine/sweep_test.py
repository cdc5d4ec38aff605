"""Sweeps from outside: what they leave, how they go on after being stopped or killed, how processes share their cases.

Called as: sweep_test.py PROGRAM SOURCE_FOLDER
"""
import collections
import csv
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

sys.dont_write_bytecode = True
from program_case import PROGRAM, ROOT, SCENE, ProgramCase

MU = {"name": "mu", "set": "materials.rubber.mu", "values": [0.1, 0.5]}
HEIGHT = {"set": "bodies[0].position[2]", "from": 0.11, "to": 0.13, "count": 3}
LAUNCHERS = [key for key in os.environ if key.startswith(("SLURM_", "PMI_", "OMPI_"))]


class SweepTest(ProgramCase):
    def setUp(self):
        super().setUp()
        for key in LAUNCHERS:  # this test may itself be a job
            os.environ.pop(key, None)
        self.out = self.folder / "results"
        self.cases = self.write("cases.json", {"scene": "drop.json", "grid": [MU, HEIGHT]})

    def sweep(self, *arguments, code=0, environment=None):
        done = subprocess.run([PROGRAM, "sweep", *map(str, arguments)], capture_output=True, text=True, timeout=300,
                              check=False, env={**os.environ, **(environment or {})})
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def result(self, index):
        return json.loads((self.out / f"case_{index:06d}.json").read_text())

    def table(self):
        with open(self.out / "sweep.csv", newline="") as file:
            return list(csv.DictReader(file))

    def hashes(self):
        return [row["state_hash"] for row in self.table()]

    def names(self):
        return sorted(path.name for path in self.out.iterdir())

    def test_each_case_is_the_run_that_its_assignments_make(self):
        done = self.sweep(self.cases, "--out", self.out)
        self.assertEqual(self.names(), [f"case_00000{i}.json" for i in range(6)] + ["sweep.csv", "sweep.html"])
        self.assertIn("6 cases: 6 ok", done.stdout)
        self.assertEqual(done.stdout.splitlines()[0].split()[:4], ["case", "mu", "bodies[0].position[2]", "status"])
        rows = self.table()
        self.assertEqual([(row["case"], float(row["mu"]), float(row["bodies[0].position[2]"])) for row in rows],
                         [(str(3 * i + k), mu, height) for i, mu in enumerate([0.1, 0.5])
                          for k, height in enumerate([0.11, 0.12, 0.13])])
        for index in (1, 5):
            result, stats = self.result(index), self.folder / "stats.json"
            options = [option for text in result["set"] for option in ("--set", text)]
            self.skerry("run", self.scene, *options, "--quiet", "--stats", stats)
            run = json.loads(stats.read_text())
            self.assertEqual(result["state_hash"], run["state_hash"])
            self.assertEqual(rows[index]["state_hash"], run["state_hash"])
            self.assertEqual(result["report"]["steps"], run["steps"])
            self.assertEqual(result["report"]["probes"], run["probes"])
            self.assertEqual(result["figures"]["steps"], run["steps"])
            self.assertEqual(float(rows[index]["base.slip_m"]), run["probes"]["base"]["slip_distance"])
            self.assertEqual((result["report"]["threads"], result["report"]["backend"]), (1, "serial"))
        self.assertEqual(len(set(self.hashes())), 6)

    def test_the_table_has_columns_for_every_probe_of_a_series(self):
        probes = [{"name": "centre", "quantity": "motion", "body": "block"},
                  {"name": "weight", "quantity": "force", "body": "block", "by": "floor"},
                  {"name": "bend", "quantity": "stress", "body": "block"},
                  {"name": "squeeze", "quantity": "volume", "body": "block"}]
        self.scene.write_text(json.dumps({**SCENE, "probes": probes}))
        done = self.sweep(self.cases, "--out", self.out, "--probes")
        for name in ("weight.largest_force_max_N", "bend.largest_von_mises_max_Pa",
                     "squeeze.smallest_volume_ratio_min"):
            self.assertIn(name, done.stdout.splitlines()[0])
        for row in self.table():
            with open(self.out / f"case_{int(row['case']):06d}.csv", newline="") as file:
                series = list(csv.DictReader(file))
            for column, figure, unit in (("centre.position_z [m]", "centre.position_z", "_m"),
                                         ("centre.velocity_z [m/s]", "centre.velocity_z", "_m_s"),
                                         ("bend.largest_von_mises [Pa]", "bend.largest_von_mises", "_Pa"),
                                         ("squeeze.smallest_volume_ratio [1]", "squeeze.smallest_volume_ratio", "")):
                values = [float(line[column]) for line in series]
                self.assertLessEqual(float(row[figure + "_min" + unit]), min(values))
                self.assertGreaterEqual(float(row[figure + "_max" + unit]), max(values))
                self.assertAlmostEqual(float(row[figure + "_end" + unit]), values[-1], places=9)
            self.assertGreater(float(row["weight.force_z_max_N"]), 10)
            self.assertTrue(float(row["weight.force_z_min_N"]) <= float(row["weight.force_z_mean_N"]) <=
                            float(row["weight.force_z_max_N"]))

    def test_the_folder_of_results_has_the_name_of_the_sweep(self):
        cases = {"scene": "drop.json", "grid": [{**MU, "values": [0.1]}]}
        for name, extra in (("grips", {"name": "grips"}), ("cases", {})):
            file = self.write("cases.json", {**extra, **cases})
            done = subprocess.run([PROGRAM, "sweep", file, "--quiet"], cwd=self.folder, capture_output=True, text=True,
                                  timeout=300, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue((self.folder / "out" / name / "sweep.csv").exists(), name)
        for name in ("../elsewhere", ".."):
            self.assert_refused("sweep", self.write("bad.json", {"name": name, **cases}),
                                message=["bad.json", "name", name])

    def test_what_is_done_is_not_done_again(self):
        self.sweep(self.cases, "--out", self.out)
        files = {i: self.out / f"case_{i:06d}.json" for i in range(6)}
        before = {i: file.stat().st_mtime_ns for i, file in files.items()}
        table = self.table()
        files[3].unlink()
        done = self.sweep(self.cases, "--out", self.out)
        self.assertIn("1 of 6 cases to run", done.stderr)
        changed = {i for i, file in files.items() if file.stat().st_mtime_ns != before[i]}
        self.assertEqual(changed, {3})
        clocks = {"seconds_wall", "seconds_cpu"}
        for old, new in zip(table, self.table()):
            self.assertEqual({k: v for k, v in old.items() if k not in clocks},
                             {k: v for k, v in new.items() if k not in clocks})
        self.assertIn("0 of 6 cases to run", self.sweep(self.cases, "--out", self.out).stderr)

    def test_results_of_other_cases_are_refused_or_computed_again(self):
        self.sweep(self.cases, "--out", self.out)
        before = self.hashes()
        self.write("cases.json", {"scene": "drop.json", "grid": [{**MU, "values": [0.2, 0.5]}, HEIGHT]})
        self.assert_refused("sweep", self.cases, "--out", self.out, message=[
            str(self.out), "3 files", "not belong to these cases", "case_000000.json", '"mu":0.1', "--redo", "--out"])
        done = self.sweep(self.cases, "--out", self.out, "--redo")
        self.assertIn("3 cases are computed again", done.stderr)
        self.assertIn("3 of 6 cases to run", done.stderr)
        self.assertEqual([old == new for old, new in zip(before, self.hashes())], [False] * 3 + [True] * 3)
        # what the scene is, not how it is written
        self.scene.write_text(json.dumps(SCENE, indent=4))
        self.assertIn("0 of 6 cases to run", self.sweep(self.cases, "--out", self.out).stderr)
        self.scene.write_text(json.dumps({**SCENE, "seconds": 0.1}))
        self.assert_refused("sweep", self.cases, "--out", self.out,
                            message=["6 files", "an earlier version of the scene"])
        self.scene.write_text(json.dumps(SCENE))
        (self.out / "case_000002.json").write_text('{"schema": "skerry.case/2", "case')
        self.assert_refused("sweep", self.cases, "--out", self.out,
                            message=["case_000002.json", "not the result of a case"])
        self.assertIn("1 of 6", self.sweep(self.cases, "--out", self.out, "--redo").stderr)

    def test_a_case_belongs_to_the_scenes_and_surfaces_that_its_scene_names(self):
        box = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
        self.write("drawn.obj", box)
        self.write("part.json", SCENE)
        self.scene.write_text(json.dumps({"include": [{"scene": "part.json", "name": "left"}], "seconds": 0.01,
                                          "materials": SCENE["materials"],
                                          "bodies": [{**SCENE["bodies"][0], "name": "b", "visual": "drawn.obj",
                                                      "position": [5, 0, 1]}]}))
        self.write("cases.json", {"scene": "drop.json", "grid": [{"set": "seconds", "values": [0.01]}]})
        self.sweep(self.cases, "--out", self.out)
        for name, content in (("part.json", {**SCENE, "probe_step": 0.01}), ("drawn.obj", box + "# changed\n")):
            self.write(name, content)
            self.assert_refused("sweep", self.cases, "--out", self.out, message=["an earlier version of the scene"])
            self.assertIn("1 of 1 cases to run", self.sweep(self.cases, "--out", self.out, "--redo").stderr)

    def slow_cases(self):
        """Eight of a few tenths of a second."""
        scene = dict(SCENE, seconds=2, bodies=[
            dict(SCENE["bodies"][0], mesh={"ball": {"radius": 0.1, "resolution": 8}})], probes=[])
        self.write("slow.json", scene)
        return self.write("slow_cases.json", {"scene": "slow.json", "grid": [
            {**HEIGHT, "count": 8}]})

    def whole_files(self):
        """How many there are; those that are not whole would not be read."""
        files = list(self.out.glob("case_*.json"))
        for file in files:
            self.assertEqual(json.loads(file.read_text())["schema"], "skerry.case/2")
        return len(files)

    def children_of(self, process):
        try:
            with open(f"/proc/{process}/task/{process}/children") as file:
                return [int(text) for text in file.read().split()]
        except OSError:
            return []

    def kill_a_child_of(self, process):
        """Returns false if there is no child, or if it had ended before."""
        for child in self.children_of(process):
            try:
                os.kill(child, signal.SIGSTOP)  # cannot end by itself any more
                while (state := pathlib.Path(f"/proc/{child}/stat").read_text().rpartition(") ")[2][0]) not in "TZ":
                    time.sleep(0.001)
                os.kill(child, signal.SIGKILL)
            except OSError:  # it has ended
                continue
            if state == "T":
                return True
        return False

    def test_a_sweep_that_is_killed_leaves_whole_files_and_no_process_and_goes_on(self):
        cases = self.slow_cases()
        self.sweep(cases, "--out", self.folder / "undisturbed", "--quiet")
        killed, left_behind = 0, set()
        for delay in (0, 0.03, 0.01):
            process = subprocess.Popen([PROGRAM, "sweep", str(cases), "--out", str(self.out), "--quiet", "--jobs", "2"])
            before = self.whole_files()
            while process.poll() is None and self.whole_files() == before:
                time.sleep(0.005)
            time.sleep(delay)
            if process.poll() is None:
                left_behind.update(self.children_of(process.pid))
                process.kill()
                killed += 1
            process.wait()
            self.whole_files()
        self.assertGreater(killed, 1)
        deadline = time.monotonic() + 60
        while any(os.path.exists(f"/proc/{child}") for child in left_behind) and time.monotonic() < deadline:
            time.sleep(0.02)
        self.assertEqual([child for child in left_behind if os.path.exists(f"/proc/{child}")], [])
        self.sweep(cases, "--out", self.out)
        found = self.hashes()
        self.out = self.folder / "undisturbed"
        self.assertEqual(found, self.hashes())

    def test_ctrl_c_leaves_whole_files_alone_and_says_how_to_go_on(self):
        cases = self.slow_cases()
        with subprocess.Popen([PROGRAM, "sweep", str(cases), "--out", str(self.out), "--jobs", "2", "--probes"],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              start_new_session=True) as process:
            deadline = time.monotonic() + 60
            while self.whole_files() == 0 and time.monotonic() < deadline:
                time.sleep(0.01)
            os.killpg(process.pid, signal.SIGINT)  # as the terminal does
            stdout, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, stderr)
        self.assertIn("Run the same command again for the other cases", stdout)
        done = self.whole_files()
        self.assertIn(f"{done} of 8 cases", stdout)
        self.assertLess(done, 8)
        self.assertEqual([name for name in self.names() if ".part" in name or name.startswith("sweep")], [])
        self.assertIn(f"{8 - done} of 8 cases to run", self.sweep(cases, "--out", self.out).stderr)
        self.assertEqual(len(self.table()), 8)

    def test_a_case_that_is_killed_has_no_result_and_is_run_again(self):
        cases = self.slow_cases()
        with subprocess.Popen([PROGRAM, "sweep", str(cases), "--out", str(self.out), "--jobs", "1"],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            while process.poll() is None and not self.kill_a_child_of(process.pid):
                time.sleep(0.005)
            stderr = process.communicate(timeout=60)[1]
        self.assertEqual(process.returncode, 1, stderr)
        self.assertRegex(stderr, r"case \d .* ended by signal 9 .*the case has no result")
        self.assertEqual(self.whole_files(), 7)
        self.assertFalse((self.out / "sweep.csv").exists())
        self.assertIn("8 cases: 7 ok, 1 not run", self.sweep(cases, "--out", self.out, "--table").stdout)
        self.assertIn("not run", (self.out / "sweep.csv").read_text())
        self.assertIn("1 of 8 cases to run", self.sweep(cases, "--out", self.out).stderr)
        self.assertNotIn("not run", (self.out / "sweep.csv").read_text())

    def listed(self, *arguments, environment=None):
        done = self.sweep(self.cases, "--out", self.out, "--dry-run", *arguments, environment=environment)
        return [int(text) for text in re.findall(r"^case (\d+):", done.stdout, re.MULTILINE)]

    def test_processes_share_the_cases_so_that_each_is_run_once(self):
        count = 4
        launchers = {
            "by hand": lambda i: (["--rank", i, "--of", count], {}),
            "mpirun": lambda i: ([], {"OMPI_COMM_WORLD_RANK": str(i), "OMPI_COMM_WORLD_SIZE": str(count)}),
            "mpich": lambda i: ([], {"PMI_RANK": str(i), "PMI_SIZE": str(count)}),
            "srun": lambda i: ([], {"SLURM_PROCID": str(i), "SLURM_NTASKS": str(count)}),
            "array": lambda i: ([], {"SLURM_ARRAY_TASK_ID": str(i + 1), "SLURM_ARRAY_TASK_MIN": "1",
                                     "SLURM_ARRAY_TASK_COUNT": str(count)}),
        }
        for name, launcher in launchers.items():
            with self.subTest(name):
                seen = collections.Counter()
                for i in range(count):
                    arguments, environment = launcher(i)
                    found = self.listed(*arguments, environment=environment)
                    self.assertEqual(found, list(range(i, 6, count)))
                    seen.update(found)
                self.assertEqual(seen, {case: 1 for case in range(6)})
        self.assertFalse(self.out.exists())  # a dry run leaves nothing

    def test_the_last_process_makes_the_table(self):
        first = self.sweep(self.cases, "--out", self.out, "--rank", 1, "--of", 2)
        self.assertIn("process 1 of 2 (--rank, --of)", first.stderr)
        self.assertIn("3 of 3 cases of this process have a result", first.stdout)
        self.assertEqual(self.names(), [f"case_00000{i}.json" for i in (1, 3, 5)])
        self.assertIn("6 cases: 6 ok", self.sweep(self.cases, "--out", self.out, "--rank", 0, "--of", 2).stdout)
        self.assertEqual(len(self.table()), 6)
        # all at once, as mpirun does: each may be the last
        self.out = self.folder / "at_once"
        processes = [subprocess.Popen([PROGRAM, "sweep", str(self.cases), "--out", str(self.out), "--quiet"],
                                      env={**os.environ, "PMI_RANK": str(i), "PMI_SIZE": "6"}) for i in range(6)]
        self.assertEqual([process.wait(timeout=60) for process in processes], [0] * 6)
        self.assertEqual(self.names(), [f"case_00000{i}.json" for i in range(6)] + ["sweep.csv", "sweep.html"])

    def test_a_case_that_is_refused_or_fails_is_a_result_and_stops_no_other(self):
        self.write("cases.json", {"scene": "drop.json", "list": [
            {"materials.rubber.mu": -1}, {}, {"bodies[0].material": "ruber"},
            {"bodies[0].velocity": [0, 0, -30000], "settings.step_size": 1e-3},
            {"seconds": 0.1, "settings.start_overlaps": "ignore", "bodies[0].position": [0, 0, 0.06]}]})
        done = self.sweep(self.cases, "--out", self.out)
        rows = self.table()
        self.assertEqual([row["status"] for row in rows][:3], ["refused", "ok", "refused"])
        self.assertIn("materials.rubber.mu: found -1", rows[0]["message"])
        self.assertEqual(rows[0]["state_hash"], "")
        self.assertIn("case 2 refused:", done.stdout)
        self.assertEqual(rows[3]["status"], "failed", rows[3])
        self.assertIn("block", rows[3]["message"])
        self.assertGreater(float(rows[4]["warnings"]), 0)
        self.assertIn("at the start", rows[4]["warnings_text"])
        self.assertIn("case 4 WARNING:", done.stdout)
        self.assertIsNone(self.result(0)["report"])
        self.assertIn("0 of 5 cases to run", self.sweep(self.cases, "--out", self.out, "--strict", code=1).stderr)

    def test_a_parameter_without_effect_is_told(self):
        self.write("cases.json", {"scene": "drop.json", "grid": [{"set": "description", "values": ["a", "b"]}]})
        self.assertIn("All 2 cases that ran ended in the same state", self.sweep(self.cases, "--out", self.out).stdout)

    def test_an_output_that_cannot_be_written_ends_the_sweep(self):
        (self.out / "case_000001.json.part" / "not empty").mkdir(parents=True)
        done = self.sweep(self.cases, "--out", self.out, "--jobs", 1, code=3)
        self.assertIn("case_000001.json: output: found", done.stderr)
        self.assertEqual(self.whole_files(), 1)  # none was begun after it
        (self.out / "case_000001.json.part" / "not empty").rmdir()
        (self.out / "case_000001.json.part").rmdir()
        (self.out / "sweep.csv.part" / "not empty").mkdir(parents=True)
        self.assertIn("sweep.csv: output: found", self.sweep(self.cases, "--out", self.out, code=3).stderr)
        self.assertEqual(self.whole_files(), 6)

    def test_random_cases_are_those_of_their_seed(self):
        def cases(count, seed=3):
            self.write("cases.json", {"scene": "drop.json", "random": {"seed": seed, "count": count, "parameters": [
                {"name": "mu", "set": "materials.rubber.mu", "from": 0.1, "to": 0.9},
                {"name": "E", "set": "materials.rubber.E", "distribution": "log_uniform", "from": 1e4, "to": 1e5}]}})
            return re.findall(r"^case \d+: (.*)$", self.sweep(self.cases, "--dry-run").stdout, re.MULTILINE)
        self.assertEqual(cases(4), cases(4))
        self.assertEqual(cases(9)[:4], cases(4))
        self.assertNotEqual(cases(4, seed=4), cases(4))
        cases(4)
        self.sweep(self.cases, "--out", self.out)
        cases(6)  # goes on with two more
        self.assertIn("2 of 6 cases to run", self.sweep(self.cases, "--out", self.out).stderr)

    def test_series_of_probes_come_whole_beside_their_case(self):
        self.write("drop.json", {**SCENE, "probes": [{"name": "block", "quantity": "motion", "body": "block"}]})
        self.sweep(self.cases, "--out", self.out, "--probes")
        for i in range(6):
            with open(self.out / f"case_{i:06d}.csv", newline="") as file:
                self.assertEqual(len(list(csv.reader(file))), 1 + 41)  # names; 0 to 200 ms in steps of 5 ms
        self.assertEqual([name for name in self.names() if "part" in name], [])

    def test_the_page_has_all_cases_and_cannot_be_broken_out_of(self):
        self.write("cases.json", {"name": "</script><b>", "scene": "drop.json", "grid": [MU, HEIGHT]})
        self.sweep(self.cases, "--out", self.out)
        page = (self.out / "sweep.html").read_text()
        data = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL).group(1)
        found = json.loads(data)
        self.assertEqual(found["name"], "</script><b>")
        self.assertIn("<title>&lt;/script&gt;&lt;b&gt;</title>", page)
        self.assertEqual([row["values"]["mu"] for row in found["rows"]], [0.1] * 3 + [0.5] * 3)
        self.assertNotIn("http", page.replace("http://www.w3.org/2000/svg", ""))  # nothing is fetched

    def test_the_page_draws_all_cases(self):
        browser = shutil.which("chromium") or shutil.which("google-chrome")
        if browser is None:
            self.skipTest("no Chromium")
        self.sweep(self.cases, "--out", self.out)
        command = [browser, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                   f"--user-data-dir={self.folder / 'profile'}", "--dump-dom", f"file://{self.out / 'sweep.html'}"]
        try:
            page = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False).stdout
        except subprocess.TimeoutExpired:
            self.skipTest("Chromium hangs")
        root = re.search("<html[^>]*>", page).group(0)
        self.assertIn('data-ready="true"', root)
        self.assertIn('data-points="6"', root)
        self.assertEqual(len(re.findall("<polyline", page)), 3)  # over mu, a line for each height
        self.assertEqual(len(re.findall("<tr>", page)), 7)

    def test_the_examples_are_planned(self):
        for name, count in (("incline_sweep", 18), ("incline_random", 60)):
            done = self.sweep(ROOT / "examples" / f"{name}.json", "--dry-run")
            self.assertIn(f"{count} of {count} cases are for this process", done.stdout)

    def test_the_schema_of_sweeps_has_all_keys(self):
        text = self.skerry("schema", "--sweep").stdout
        self.assertEqual(text, (ROOT / "docs/sweep.schema.json").read_text())
        schema = json.loads(text)
        self.assertEqual(list(schema["properties"]), ["$schema", "name", "description", "scene", "set", "grid", "list",
                                                      "random"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
