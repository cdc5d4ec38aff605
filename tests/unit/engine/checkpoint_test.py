"""Runs that are killed, stopped, or find no room, and go on from their checkpoints: the program from outside.

Called as: checkpoint_test.py PROGRAM SOURCE_FOLDER
"""
import json
import math
import random
import re
import resource
import signal
import struct
import subprocess
import sys
import time
import unittest

sys.dont_write_bytecode = True
from program_case import PROGRAM, SCENE, ProgramCase


class CheckpointTest(ProgramCase):
    def run_stats(self, *arguments, code=0):
        stats = self.folder / "stats.json"
        self.skerry("run", *arguments, "--quiet", "--stats", stats, code=code)
        return json.loads(stats.read_text())

    def same_run(self, found, expected):
        """All that does not tell of clocks, threads, memory, or of how the run was cut into parts. Errors are estimated
        since the restart."""
        own = {"seconds_wall", "seconds_load", "seconds_setup", "seconds_output", "real_time_factor", "stages",
               "restarted_at", "threads", "backend", "ranks", "checkpoints", "errors"}
        for key in expected.keys() - own:
            self.assertEqual(found[key], expected[key], key)

    def rows_of_a_run_in_two_parts(self, scene):
        """Checks that a restart continues the series of the scene as a run in one part does, and returns its lines."""
        whole, parts, checkpoint = (self.folder / name for name in ("whole.csv", "parts.csv", "run.skerry"))
        self.run_stats(scene, "--seconds", 0.2, "--probes", whole)
        self.run_stats(scene, "--seconds", 0.1, "--probes", parts, "--checkpoint", checkpoint)
        self.run_stats("--restart", checkpoint, "--seconds", 0.2, "--probes", parts)
        self.assertEqual(parts.read_text(), whole.read_text())
        lines = whole.read_text().splitlines()
        self.assertGreater(len(lines), 5)
        return lines

    def test_a_run_that_is_killed_at_any_moment_goes_on_from_its_checkpoint_with_the_same_bits(self):
        scene = self.write("long.json", dict(SCENE, seconds=3, bodies=[
            dict(SCENE["bodies"][0], mesh={"ball": {"radius": 0.1, "resolution": 8}}, position=[0, 0, 0.2]),
            dict(SCENE["bodies"][0], name="second", velocity=[0, 0, -1], position=[0.05, 0, 0.5])],
            probes=[dict(SCENE["probes"][0], box={"lower": [-1, -1, -1], "upper": [1, 1, 1]})]))
        expected = self.run_stats(scene)
        checkpoint = self.folder / "run.skerry"
        numbers = random.Random(7)
        arguments = [scene]
        killed = 0
        for _ in range(8):  # with a checkpoint after every sample most are killed while one is written
            before = checkpoint.exists() and checkpoint.stat()
            process = subprocess.Popen([PROGRAM, "run", *map(str, arguments), "--quiet", "--checkpoint", checkpoint,
                                        "--every", "0.005", "--threads", str(numbers.randint(1, 3))])
            while process.poll() is None and (checkpoint.exists() and checkpoint.stat()) == before:
                time.sleep(0.001)
            time.sleep(numbers.uniform(0, 0.1))
            if process.poll() is not None:
                break
            process.kill()
            process.wait()
            killed += 1
            arguments = ["--restart", checkpoint]
        self.assertGreater(killed, 2)
        found = self.run_stats("--restart", checkpoint, "--threads", 2)
        self.assertGreater(found["restarted_at"], 0)
        self.same_run(found, expected)
        self.assertEqual([p.name for p in self.folder.glob("*.skerry*") if p.suffix not in (".part", ".lock")],
                         ["run.skerry"])

    def test_a_checkpoint_is_a_safetensors_file(self):
        """Reads the file as the specification of the format says, without Skerry's own reader."""
        checkpoint = self.folder / "run.skerry"
        self.skerry("run", self.scene, "--quiet", "--seconds", 0.02, "--checkpoint", checkpoint)
        content = checkpoint.read_bytes()
        length = int.from_bytes(content[:8], "little")
        header = json.loads(content[8:8 + length])
        data = content[8 + length:]
        texts = header.pop("__metadata__")
        self.assertTrue(all(isinstance(text, str) for text in texts.values()))
        self.assertEqual(json.loads(texts["note"])["scene"], str(self.scene))
        sizes = {"F64": 8, "U64": 8, "F32": 4, "I32": 4, "U32": 4, "U16": 2, "U8": 1}
        end = 0  # arrays follow each other without gaps
        for name, array in sorted(header.items(), key=lambda item: item[1]["data_offsets"]):
            self.assertEqual(array["data_offsets"][0], end, name)
            end = array["data_offsets"][1]
            self.assertEqual(end - array["data_offsets"][0], math.prod(array["shape"]) * sizes[array["dtype"]], name)
        self.assertEqual(end, len(data))
        nodes = header["nodes/position"]
        positions = struct.unpack(f"<{math.prod(nodes['shape'])}d", data[slice(*nodes["data_offsets"])])
        self.assertEqual(nodes["shape"][1], 3)
        self.assertTrue(all(abs(x) < 10 for x in positions) and any(positions))

    def test_checkpoints_change_nothing_and_a_run_may_be_made_longer(self):
        expected = self.run_stats(self.scene, "--seconds", 0.31)
        checkpoint = self.folder / "run.skerry"
        short = self.run_stats(self.scene, "--seconds", 0.2, "--checkpoint", checkpoint, "--every", 0.05)
        self.assertEqual(short["checkpoints"], {"written": 4, "failed": 0})
        self.assertEqual(short["state_hash"], self.run_stats(self.scene, "--seconds", 0.2)["state_hash"])
        self.same_run(self.run_stats("--restart", checkpoint, "--seconds", 0.31), expected)
        # a run that ended within a frame ends where it is asked to
        self.run_stats(self.scene, "--seconds", 0.21, "--checkpoint", checkpoint)
        longer = self.run_stats("--restart", checkpoint, "--seconds", 0.31)
        self.assertAlmostEqual(longer["seconds_simulated"], 0.31, places=12)
        self.assertEqual(longer["frames"], expected["frames"])

    def test_a_longer_run_keeps_its_bits_if_the_last_frame_is_rounded(self):
        # 0.25 - 14 / 60 is rounded to less than 1 / 60
        scene = self.write("rolling.json", dict(SCENE, bodies=[
            dict(SCENE["bodies"][0], mesh={"ball": {"radius": 0.1, "resolution": 4}}, position=[0, 0, 0.11],
                 velocity=[0.3, 0, 0], angular_velocity=[1, 2, 3])], probes=[]))
        expected = self.run_stats(scene, "--seconds", 0.4)
        checkpoint = self.folder / "run.skerry"
        self.run_stats(scene, "--seconds", 0.25, "--checkpoint", checkpoint)
        self.same_run(self.run_stats("--restart", checkpoint, "--seconds", 0.4), expected)

    def test_a_run_with_a_probe_of_a_joint_goes_on_with_the_same_rows(self):
        lever = dict(SCENE["bodies"][0], name="lever", dynamics="rigid", position=[0, 0, 1])
        hinge = {"kind": "hinge", "first": "lever", "point": [0, 0, 1.2], "axis": [0, 1, 0]}
        scene = self.write("lever.json", dict(
            SCENE, bodies=[lever], joints=[hinge],
            probes=[{"name": "hinge", "quantity": "joint", "joint": "joint_0"}]))
        self.rows_of_a_run_in_two_parts(scene)

    def test_a_run_with_a_probe_of_a_tie_goes_on_with_the_same_rows(self):
        scene = self.write("tie.json", dict(
            SCENE, ties=[{"name": "tie", "body": "block", "nodes": [0]}],
            probes=[{"name": "tie", "quantity": "tie", "tie": "tie"}]))
        self.rows_of_a_run_in_two_parts(scene)

    def test_a_run_with_a_cable_goes_on_with_the_same_rows(self):
        points = [{"point": [0, 0, 1]}, {"body": "block", "point": [0, 0, 0.05]},
                  {"collider": "floor", "point": [1, 0, 0]}]
        scene = self.write("cable.json", dict(
            SCENE, cables=[{"points": points, "rate": [[0.05, 0], [0.1, -0.2]], "friction": 0.2}],
            probes=[{"name": "tendon", "quantity": "cable", "cable": "cable_0"}]))
        heading, *_, last = self.rows_of_a_run_in_two_parts(scene)
        self.assertIn("tendon.tension_1 [N],tendon.length [m]", heading)
        self.assertGreater(float(last.split(",")[1]), 0)

    def test_a_run_with_a_spring_and_a_cavity_goes_on_with_the_same_rows(self):
        scene = self.write("pressed.json", dict(
            SCENE,
            springs=[{"first": {"body": "block", "point": [0, 0, 0]}, "second": {"point": [0, 0, 1]},
                      "stiffness": 5}],
            cavities=[{"body": "block", "pressure": [[0, 0], [0.2, 100]]}],
            probes=[{"name": "cord", "quantity": "spring", "spring": "spring_0"},
                    {"name": "skin", "quantity": "cavity", "cavity": "cavity_0"}]))
        heading = self.rows_of_a_run_in_two_parts(scene)[0]
        self.assertIn("cord.force [N]", heading)
        self.assertIn("skin.pressure [Pa]", heading)

    def test_a_run_of_a_changed_scene_goes_on_with_it(self):
        checkpoint = self.folder / "run.skerry"
        change = ["--set", "bodies[0].name=brick", "--set", "probes[0].body=brick"]
        expected = self.run_stats(self.scene, *change, "--seconds", 0.1)
        self.run_stats(self.scene, *change, "--seconds", 0.05, "--checkpoint", checkpoint)
        self.same_run(self.run_stats("--restart", checkpoint, "--seconds", 0.1), expected)

    def test_a_stopped_run_goes_on_from_its_last_checkpoint_and_so_do_its_frames(self):
        checkpoint, out, whole = self.folder / "run.skerry", self.folder / "frames", self.folder / "whole"
        with subprocess.Popen([PROGRAM, "run", self.scene, "--seconds", "1e6", "--quiet", "--out", out, "--checkpoint",
                               checkpoint, "--every", "0.02"], stderr=subprocess.PIPE, text=True) as process:
            while not checkpoint.exists() and process.poll() is None:
                time.sleep(0.02)
            process.send_signal(signal.SIGTERM)
            stderr = process.communicate(timeout=120)[1]
        self.assertEqual(process.returncode, 143, stderr)
        stopped = float(re.search("stopped by a signal at ([0-9.]+) s", stderr).group(1))
        seconds = (round(60 * stopped) + 6) / 60
        expected = self.run_stats(self.scene, "--seconds", seconds, "--out", whole)
        found = self.run_stats("--restart", checkpoint, "--seconds", seconds, "--out", out)
        self.same_run(found, expected)
        self.assertEqual(sorted(p.name for p in out.iterdir()), sorted(p.name for p in whole.iterdir()))
        for file in out.glob("*.vt*"):
            self.assertEqual(file.read_bytes(), (whole / file.name).read_bytes(), file.name)

        def listed(folder):
            return re.findall(r'part="\d" name="\w+" file="[^"]+"', (folder / "drop.pvd").read_text())
        self.assertEqual(listed(out), listed(whole))

    def test_a_checkpoint_that_finds_no_room_is_said_and_the_run_goes_on(self):
        expected = self.run_stats(self.scene)
        checkpoint, stats = self.folder / "run.skerry", self.folder / "stats.json"
        self.run_stats(self.scene, "--seconds", 0.1, "--checkpoint", checkpoint)
        before = checkpoint.read_bytes()
        done = subprocess.run([PROGRAM, "run", self.scene, "--quiet", "--stats", stats, "--checkpoint", checkpoint,
                               "--every", "0.05"], capture_output=True, text=True, timeout=300, check=False,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000)))
        self.assertEqual(done.returncode, 3, done.stderr)
        message = (r"the checkpoint at 0.[0-9]* s could not be written: .*run.skerry.*enough space for the whole file "
                r"\(free disk space or choose another path\); the run continues")
        self.assertEqual(len(re.findall(message, done.stderr)), 4, done.stderr)
        found = json.loads(stats.read_text())
        self.assertEqual(found["checkpoints"], {"written": 0, "failed": 4})
        self.assertIn("run.skerry", found["outputs_failed"]["--checkpoint"])
        self.same_run(dict(found, outputs_failed={}), expected)
        self.assertEqual(checkpoint.read_bytes(), before)
        self.assertFalse((self.folder / "run.skerry.part").exists())

    def test_a_restart_from_something_else_is_refused(self):
        checkpoint = self.folder / "run.skerry"
        self.run_stats(self.scene, "--checkpoint", checkpoint)
        self.assert_refused("run", "--restart", checkpoint, message=["a checkpoint at 0.2 s", "a larger --seconds"])
        self.assert_refused("run", "--restart", self.scene, message=["drop.json", "a file of another kind"])
        self.assert_refused("run", "--restart", self.folder / "none", message=["no such file"])
        for option, value in (("--step", 1e-5), ("--max-iterations", 9), ("--start-overlaps", "ignore")):
            self.assert_refused("run", "--restart", checkpoint, "--seconds", 0.3, option, value, message=[option])
        self.assert_refused("run", "--every", 1, self.scene, message=["--checkpoint"])
        self.assert_refused("run", message=["SCENE"])
        self.assert_refused("run", self.scene, "--checkpoint", self.scene, message=["the same file as the scene"])
        damaged = bytearray(checkpoint.read_bytes())
        damaged[len(damaged) // 2] ^= 16
        broken = self.folder / "broken.skerry"
        broken.write_bytes(damaged)
        self.assert_refused("run", "--restart", broken, message=["broken.skerry", "checksum", "damaged"])
        other = self.write("other.json", dict(SCENE, bodies=[dict(SCENE["bodies"][0], name="brick")], probes=[]))
        self.assert_refused("run", other, "--restart", checkpoint, message=['body "block"', '"brick"', "has changed"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
