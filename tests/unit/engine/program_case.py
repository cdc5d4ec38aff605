"""Base of the tests that run the program. Called as: TEST PROGRAM SOURCE_FOLDER"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM, ROOT = sys.argv[1], pathlib.Path(sys.argv[2])

SCENE = {
    "name": "drop",
    "seconds": 0.2,
    "materials": {"rubber": {"E": 2e4, "nu": 0.3, "rho": 500, "mu": 0.5}},
    "bodies": [{"name": "block", "mesh": {"box": {"size": [0.2, 0.2, 0.2], "cells": [2, 2, 2]}}, "material": "rubber",
                "position": [0, 0, 0.11]}],
    "colliders": [{"name": "floor", "shape": {"plane": {}}}],
    "probes": [{"name": "base", "body": "block", "box": {"lower": [-1, -1, -1], "upper": [1, 1, -0.09]}}],
    "probe_step": 0.005,
}


class ProgramCase(unittest.TestCase):
    """Runs the program in a folder of its own."""

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.scene = self.write("drop.json", SCENE)

    def tearDown(self):
        self.temporary.cleanup()

    def write(self, name, content):
        path = self.folder / name
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return path

    def skerry(self, *arguments, code=0):
        done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def job(self, *arguments):
        """Starts a run and returns after its first line of progress: signals are handled and steps are made."""
        process = subprocess.Popen([PROGRAM, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True)
        line = process.stderr.readline()
        while " steps; about " not in line:
            self.assertNotEqual(line, "", "the run ended early")
            line = process.stderr.readline()
        return process

    def assert_refused(self, *arguments, message):
        """Exit code 2, one line on standard error, nothing on standard output, no file that was not there."""
        before = sorted(self.folder.rglob("*"))
        done = self.skerry(*arguments, code=2)
        for part in message:
            self.assertIn(part, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertEqual(sorted(self.folder.rglob("*")), before)
        return done
