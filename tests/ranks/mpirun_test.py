"""Runs of several processes: `mpirun -n N skerry run SCENE` from outside.

Called as: mpirun_test.py PROGRAM SOURCE_FOLDER MPIRUN
"""
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time
import unittest

sys.dont_write_bytecode = True
sys.path.append(str(pathlib.Path(sys.argv[2]) / "tests" / "unit" / "engine"))
MPIRUN = sys.argv.pop(3)
from program_case import PROGRAM, SCENE, ProgramCase

BLOCK = dict(SCENE["bodies"][0], mesh={"box": {"size": [0.2, 0.2, 0.2], "cells": [1, 1, 1]}})
SCENE_OF_FOUR = dict(SCENE, name="four", bodies=[
    dict(BLOCK, name=f"block_{i}", position=[0.02 * i, 0.25 * (i // 2), 0.11 + 0.22 * (i % 2)]) for i in range(4)],
    probes=[dict(SCENE["probes"][0], body="block_0"), {"name": "energy", "quantity": "energy"}])


class MpirunTest(ProgramCase):
    def setUp(self):
        super().setUp()
        self.scene = self.write("four.json", SCENE_OF_FOUR)
        self.checkpoint = self.folder / "run.skerry"

    def command(self, ranks, *arguments):
        return [MPIRUN, "-n", str(ranks), PROGRAM, *map(str, arguments)]

    def ranks(self, ranks, *arguments, code=0, apart=()):
        """`apart`: command line of one more rank."""
        command = self.command(ranks, *arguments) + [":", "-n", "1", *map(str, apart)] * bool(apart)
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(done.returncode, code, f"{command}\n{done.stdout}\n{done.stderr}")
        return done

    def job(self, ranks, *arguments):
        """Starts a run, and returns after its first checkpoint, which is in the file run.skerry."""
        job = subprocess.Popen(self.command(ranks, "run", self.scene, "--quiet", "--checkpoint", self.checkpoint,
                                            "--every", 0.05, *arguments), stderr=subprocess.PIPE, text=True)
        while not self.checkpoint.exists():
            self.assertIsNone(job.poll())
            time.sleep(0.01)
        return job

    def process_of(self, job, rank):
        """Open MPI starts the processes of the ranks itself, MPICH through another process."""
        names = {f"{name}={rank}".encode() for name in ("OMPI_COMM_WORLD_RANK", "PMI_RANK")}
        found = [job.pid]
        for pid in found:
            found += map(int, subprocess.run(["pgrep", "-P", str(pid)], capture_output=True, text=True,
                                             check=False).stdout.split())
        return next(pid for pid in found[1:]
                    if names & set(pathlib.Path(f"/proc/{pid}/environ").read_bytes().split(b"\0")))

    def status_of(self, job, rank):
        """Content of /proc/PID/status; empty if the process has not started yet."""
        try:
            return pathlib.Path(f"/proc/{self.process_of(job, rank)}/status").read_text()
        except (StopIteration, OSError):
            return ""

    def stats_of(self, run, *arguments):
        file = self.folder / "stats.json"
        run("run", *arguments, "--quiet", "--stats", file)
        return json.loads(file.read_text())

    def test_outputs_of_ranks_are_those_of_one_process(self):
        def files(run):
            out, series = self.folder / "frames", self.folder / "series.csv"
            stats = self.stats_of(run, self.scene, "--out", out, "--probes", series)
            return stats, {file.name: without_regions(file.read_bytes()) for file in out.iterdir()}, numbers_of(series)
        alone, expected, rows = files(self.skerry)
        shared, found, rows_found = files(lambda *arguments: self.ranks(3, *arguments, "--threads", 2))
        self.assertEqual(sorted(found), sorted(expected))
        for name, content in expected.items():
            self.assertEqual(found[name], content, name)
        # energies are sums over the ranks, so they are rounded
        for row, row_found in zip(rows, rows_found, strict=True):
            for x, y in zip(row, row_found, strict=True):
                self.assertAlmostEqual(y, x, delta=1e-12 * abs(x))
        for key in ("state_hash", "steps", "frames", "contacts", "regions", "solver", "probes", "step_limits"):
            self.assertEqual(shared[key], alone[key], key)
        self.assertEqual((alone["ranks"]["count"], shared["ranks"]["count"], shared["ranks"]["hosts"]), (1, 3, 1))
        self.assertGreater(shared["ranks"]["messages_per_step"], 0)
        # stages and searches of all ranks are added up
        stage = shared["stages"]["ranks/reduce_findings"]
        self.assertGreaterEqual(stage["runs"], 3 * shared["steps"])
        self.assertEqual(stage["runs"] % 3, 0)
        self.assertGreater(stage["seconds"], 0)
        self.assertGreaterEqual(shared["search"]["broad_searches"], 3)
        self.assertGreaterEqual(shared["search"]["inline_steps"], 3 * alone["search"]["inline_steps"])

    def test_only_rank_0_needs_the_memory_of_the_whole_world(self):
        def peaks(run, balls):
            ball = dict(BLOCK, mesh={"ball": {"radius": 0.1, "resolution": 6}}, position=[0, 0, 0.2],
                        repeat={"count": [balls, 1, 1], "spacing": [0.3, 1, 1]})
            scene = self.write("row.json", dict(SCENE, seconds=0.001, bodies=[ball], probes=[]))
            return self.stats_of(run, scene)["ranks"]["peak_memory"]
        few, many, ranks = 4, 104, 4
        grown, alone = ([a - b for a, b in zip(peaks(run, many), peaks(run, few), strict=True)] for run in (
            lambda *arguments: self.ranks(ranks, *arguments), self.skerry))
        self.assertEqual(len(grown), ranks)
        # a quarter of the bodies, copies of neighbours, and the last message
        for peak in grown[1:]:
            self.assertLess(peak, 0.3 * alone[0])

    def test_rank_0_alone_prints(self):
        done = self.ranks(2, "run", self.scene)
        self.assertEqual(done.stdout.count("times real time"), 1)
        self.assertRegex(done.stdout, r"2 ranks on 1 host; [0-9.]+ messages with")
        for command in (["--help"], ["run", "--help"], ["sweep", "--help"]):
            self.assertEqual(self.ranks(3, *command).stdout.count("Usage:"), 1)
        self.assertEqual(self.ranks(3, "--version").stdout.count("instruction set:"), 1)

    def test_an_error_in_the_command_line_is_said_once(self):
        for command, message in [(["run"], "SCENE is required"), (["run", self.scene, "--bogus"], "--bogus"),
                              (["rum", self.scene], 'the command "rum"'), (["sweep", "x", "--bogus"], "--bogus")]:
            self.assertEqual(self.ranks(3, *command, code=2).stderr.count(message), 1)
        done = self.ranks(1, "run", self.scene, code=2, apart=(PROGRAM, "run", self.scene, "--bogus"))
        self.assertRegex(done.stderr, r"skerry: rank 1 on \S+: .*--bogus")

    def test_a_killed_run_goes_on_with_another_number_of_ranks_and_the_same_bits(self):
        with self.job(2, "--seconds", 1e6) as job:
            os.kill(self.process_of(job, 1), signal.SIGKILL)
            errors = job.communicate(timeout=60)[1]
        self.assertNotEqual(job.returncode, 0)
        self.assertIn("process rank 1", errors)
        match = re.search(r"from the checkpoint at ([\d.]+) ([mk]?)s: skerry run --restart .*run.skerry", errors)
        number, prefix = match.groups()
        end = ("--seconds", 1.01 * float(number) * {"m": 1e-3, "": 1, "k": 1e3}[prefix] + 0.2)
        expected = self.stats_of(self.skerry, self.scene, *end)
        found = self.stats_of(lambda *arguments: self.ranks(3, *arguments), "--restart", self.checkpoint, *end)
        self.assertGreater(found["restarted_at"], 0)
        self.assertEqual(found["state_hash"], expected["state_hash"])

    def test_ranks_that_differ_are_named(self):
        other = self.write("other.json", SCENE_OF_FOUR)
        run = ("run", self.scene)
        for apart, message in [((PROGRAM, "run", other), "command line: found .*other.json"),
                            (("env", "SKERRY_INSTRUCTION_SET=x86-64", PROGRAM, *run),
                             "instruction set: found x86-64,")]:
            done = self.ranks(1, *run, code=2, apart=apart)
            self.assertRegex(done.stderr, rf"skerry: rank 1 on \S+: {message}.*as rank 0 on ")
            self.assertEqual(done.stderr.count("skerry: rank"), 1)
        # the ranks have files of their own under the same name
        for content, code, message in [(SCENE_OF_FOUR | {"seconds": 0.3}, 2, "hash of the scene and its files: found"),
                                    ({}, 2, r"skerry: rank 1 on \S+: four.json: ")]:
            (self.folder / "host_1").mkdir(exist_ok=True)
            self.write("host_1/four.json", content)
            here, there = (("sh", "-c", f'cd "{folder}" && exec "$0" run four.json', PROGRAM)
                           for folder in (self.folder, self.folder / "host_1"))
            done = subprocess.run([MPIRUN, "-n", "1", *here, ":", "-n", "1", *there], capture_output=True, text=True,
                                  timeout=60, check=False)
            self.assertEqual(done.returncode, code)
            self.assertRegex(done.stderr, message)

    def test_errors_that_all_ranks_have_are_said_once(self):
        none = self.folder / "none.json"
        self.assertEqual(self.ranks(3, "run", none, code=2).stderr.count("no such file"), 1)

    def test_commands_and_outputs_that_ranks_cannot_share_are_refused(self):
        for command in ("view", "inspect", "study"):
            done = self.ranks(2, command, self.scene, code=2)
            self.assertEqual(done.stderr.count(f"found 2 processes of `skerry {command}`, expected one process"), 1)
        for option in ("--trace", "--export-problems"):
            done = self.ranks(2, "run", self.scene, option, self.folder / "x", code=2)
            self.assertEqual(done.stderr.count(f"{option}: found 2 ranks, expected one process"), 1)
        forces = self.write("forces.json", SCENE_OF_FOUR | {
            "probes": [{"name": "touch", "quantity": "force", "body": "block_3"}]})
        done = self.ranks(2, "run", forces, "--probes", self.folder / "x.csv", code=2)
        self.assertIn("found forces that are measured, expected none", done.stderr)

    def test_a_signal_to_one_rank_ends_all_after_the_same_step(self):
        stats = self.folder / "stats.json"
        for rank in (0, 1):
            self.checkpoint.unlink(missing_ok=True)
            with self.job(2, "--seconds", 1e6, "--stats", stats) as job:
                os.kill(self.process_of(job, rank), signal.SIGTERM)
                errors = job.communicate(timeout=60)[1]
            self.assertEqual(job.returncode, 143, errors)
            self.assertIn("stopped by a signal at", json.loads(stats.read_text())["status"])
            self.assertNotIn("the launcher ends the job", errors)

    def test_a_signal_to_one_rank_ends_all_before_the_start(self):
        """The signal arrives while the ranks move the bodies to a static equilibrium."""
        fine = dict(BLOCK, name="block_0", position=[0, 0, 0.11],
                    mesh={"box": {"size": [0.2, 0.2, 0.2], "cells": [14, 14, 14]}})
        soft = self.write("soft.json", SCENE_OF_FOUR | {"bodies": [fine]})
        job = subprocess.Popen(self.command(2, "run", soft, "--quiet", "--from-rest"), stderr=subprocess.PIPE,
                               text=True)
        with job:
            handles_signals = r"SigCgt:\s*[0-9a-f]*[4-7c-f][0-9a-f]{3}\n"  # bit 14: SIGTERM
            while not re.search(handles_signals, self.status_of(job, 1)):
                self.assertIsNone(job.poll())
            os.kill(self.process_of(job, 1), signal.SIGTERM)
            errors = job.communicate(timeout=60)[1]
        self.assertEqual(job.returncode, 143, errors)
        self.assertEqual(errors.count("stopped by a signal before the start"), 1, errors)


def without_regions(content):
    """Cuts the numbers of the contact regions, which each rank counts for itself, out of a VTK file."""
    found = re.search(rb'Name="region"[^>]*offset="([0-9]+)"', content)
    if not found:
        return content
    begin = content.index(b"_", content.index(b"<AppendedData")) + 1 + int(found[1])
    length = int.from_bytes(content[begin:begin + 8], "little")
    return content[:begin] + content[begin + 8 + length:]


def numbers_of(series):
    return [[float(cell) for cell in line.split(",") if cell] for line in series.read_text().splitlines()[1:]]


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
