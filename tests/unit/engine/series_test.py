"""Series of probes, and frames for ParaView, read back without any package: numbers are those of the run.

Called as: series_test.py PROGRAM SOURCE_FOLDER
"""
import csv
import json
import math
import re
import resource
import signal
import struct
import subprocess
import sys
import time
import unittest
import xml.etree.ElementTree as ElementTree

sys.dont_write_bytecode = True
from program_case import PROGRAM, ProgramCase

SCENE = {
    "seconds": 0.3,
    "materials": {"rubber": {"E": 5e4, "rho": 500, "mu": 0.5, "damping": 40}, "cord, thick": {"E": 2e5}},
    "bodies": [
        {"name": "block", "mesh": {"box": {"size": [0.2, 0.2, 0.2], "cells": [2, 2, 2]}}, "material": "rubber",
         "position": [0, 0, 0.102]},
        {"name": "strap é", "mesh": {"box": {"size": [0.4, 0.1, 0.1], "cells": [4, 1, 1]}}, "material": "cord, thick",
         "position": [1, 0, 1], "pin": {"box": {"lower": [-1, -1, -1], "upper": [-0.19, 1, 1]}}}],
    "colliders": [{"name": "floor", "shape": {"plane": {}}}],
    "probes": [
        {"name": "corner", "quantity": "motion", "body": "block", "point": [0.1, 0.1, 0.1]},
        {"name": "centre", "quantity": "motion", "body": "block"},
        {"name": "weight", "quantity": "force", "body": "block", "by": "floor"},
        {"name": "ground", "quantity": "force", "collider": "floor"},
        {"name": "clamp", "quantity": "reaction", "body": "strap é"},
        {"name": "energy", "quantity": "energy"},
        {"name": "bend", "quantity": "stress", "body": "strap é"},
        {"name": "squeeze", "quantity": "volume", "body": "block"}],
    "probe_step": 0.01,
    "frame_step": 0.05,
}
GRAVITY = 9.81


def read_csv(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return {head: [float(row[i]) for row in rows[1:]] for i, head in enumerate(rows[0])}


TYPES = {"Float64": "d", "Float32": "f", "Int32": "i", "UInt8": "B"}


def read_vtk(path):
    """Arrays of a file by place and name, in tuples, and the texts of its field data."""
    content = path.read_bytes()
    head, data = content.split(b'<AppendedData encoding="raw">_', 1)
    assert data.endswith(b"\n</AppendedData>\n</VTKFile>\n"), "meshio drops what follows the last line end"
    tree = ElementTree.fromstring(head.decode() + "</VTKFile>")
    arrays, texts = {}, {}
    for group in tree.iter():
        for array in group:
            if array.tag == "Array" and array.get("type") == "String":
                codes = bytes(int(code) for code in array.text.split())
                texts[array.get("Name")] = codes.decode().split("\0")[:-1]
            if array.get("format") != "appended":
                continue
            begin, width = int(array.get("offset")), int(array.get("NumberOfComponents"))
            size = struct.unpack_from("<Q", data, begin)[0]
            kind = TYPES[array.get("type")]
            values = struct.unpack_from(f"<{size // struct.calcsize(kind)}{kind}", data, begin + 8)
            arrays[group.tag, array.get("Name")] = [values[i:i + width] for i in range(0, len(values), width)]
    return arrays, texts


class SeriesTest(ProgramCase):
    def setUp(self):
        super().setUp()
        self.scene = self.write("two.json", SCENE)

    def test_rows_are_those_of_the_run_and_forces_carry_what_is_there(self):
        series, stats = self.folder / "out" / "series.csv", self.folder / "stats.json"
        done = self.skerry("run", self.scene, "--probes", series, "--stats", stats)
        self.assertIn(str(series), done.stdout)
        rows = read_csv(series)
        self.assertEqual(len(rows["time [s]"]), 31)
        for i, at in enumerate(rows["time [s]"]):
            self.assertEqual(at, round(0.01 * i, 14))
        mass = 500 * 0.2 ** 3
        mean = sum(rows["weight.force_z [N]"][-10:]) / 10
        self.assertAlmostEqual(mean, mass * GRAVITY, delta=0.02 * mass * GRAVITY)
        for of_body, of_floor in zip(rows["weight.impulse_z [N s]"][1:], rows["ground.impulse_z [N s]"][1:]):
            self.assertEqual(of_body, -of_floor)
        strap = 1000 * 0.4 * 0.1 * 0.1 * GRAVITY
        self.assertAlmostEqual(sum(rows["clamp.force_z [N]"][1:]) / 30, strap, delta=strap)
        self.assertTrue(math.isnan(rows["clamp.force_z [N]"][0]))
        self.assertEqual(rows["corner.displacement_x [m]"][0], 0)
        self.assertAlmostEqual(rows["corner.position_z [m]"][0], 0.202, places=15)
        self.assertLess(rows["corner.displacement_z [m]"][-1], 0)
        self.assertGreater(rows["bend.largest_von_mises [Pa]"][-1], 100)
        self.assertLess(rows["squeeze.smallest_volume_ratio [1]"][-1], 1)
        self.assertGreater(rows["energy.elastic [J]"][-1], 0)
        # recording changes nothing
        other = self.folder / "other.json"
        self.skerry("run", self.scene, "--stats", other)
        of = [re.search(r'"state_hash": "(\w+)"', path.read_text()).group(1) for path in (stats, other)]
        self.assertEqual(*of)

    def test_rows_are_at_multiples_of_the_probe_step_whatever_the_frames(self):
        for probe_step, frame_step, seconds in ((0.01, 1 / 60, 0.1), (0.02, 0.05, 0.13), (0.04, 0.015, 0.2)):
            series = self.folder / "series.csv"
            scene = self.write("odd.json", {**SCENE, "probe_step": probe_step, "frame_step": frame_step,
                                            "seconds": seconds})
            self.skerry("run", scene, "--probes", series)
            rows = read_csv(series)
            at = rows["time [s]"]
            self.assertEqual(len(at), math.floor(seconds / probe_step + 1e-9) + 1, at)
            for i, of_row in enumerate(at):
                self.assertAlmostEqual(of_row, probe_step * i, places=12)
            # impulses between rows include the calls of advance that end between them
            checkpoint, again = self.folder / "run.skerry", self.folder / "again.csv"
            self.skerry("run", scene, "--probes", again, "--checkpoint", checkpoint, "--every", 0.03,
                        "--seconds", seconds)
            self.skerry("run", "--restart", checkpoint, "--probes", again, "--seconds", seconds + 0.05)
            longer = read_csv(again)
            for i, of_row in enumerate(longer["time [s]"]):
                self.assertAlmostEqual(of_row, probe_step * i, places=12)
            self.assertEqual(longer["time [s]"][:len(at)], at)

    def test_a_run_that_is_resumed_within_a_frame_keeps_all_rows_of_uneven_frames(self):
        series, checkpoint = self.folder / "series.csv", self.folder / "run.skerry"
        scene = self.write("odd.json", {**SCENE, "probe_step": 0.03, "frame_step": 0.1})
        self.skerry("run", scene, "--probes", series, "--checkpoint", checkpoint, "--seconds", 0.16)
        before = read_csv(series)["time [s]"]
        self.skerry("run", "--restart", checkpoint, "--probes", series, "--seconds", 0.3)
        rows = read_csv(series)["time [s]"]
        self.assertEqual(rows[:len(before)], before)
        self.assertEqual(len(rows), 11, rows)
        for i, of_row in enumerate(rows):
            self.assertAlmostEqual(of_row, 0.03 * i, places=12)

    def test_hdf5_holds_the_same_numbers_with_units(self):
        self.skerry("run", self.scene, "--probes", self.folder / "s.h5", "--seconds", 0.05)
        content = (self.folder / "s.h5").read_bytes()
        self.assertEqual(content[:8], b"\x89HDF\r\n\x1a\n")
        self.skerry("run", self.scene, "--probes", self.folder / "s.csv", "--seconds", 0.05)
        rows = read_csv(self.folder / "s.csv")
        for name in ("energy.potential [J]", "corner.position_z [m]"):
            self.assertIn(struct.pack(f"<{len(rows[name])}d", *rows[name]), content)
        for unit in (b"m/s\0", b"N s\0", b"unit\0"):
            self.assertIn(unit, content)

    def test_a_run_that_is_killed_leaves_whole_rows_and_goes_on_with_them(self):
        series, checkpoint = self.folder / "series.csv", self.folder / "run.skerry"
        whole = self.folder / "whole.csv"
        run = subprocess.Popen([PROGRAM, "run", self.scene, "--seconds", "1e6", "--probes", series, "--checkpoint",
                                checkpoint, "--every", "0.05"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            end = time.monotonic() + 60
            while not checkpoint.exists() and run.poll() is None and time.monotonic() < end:
                time.sleep(0.002)
        finally:
            run.send_signal(signal.SIGKILL)
            run.wait()
        content = series.read_text()
        # A kill can cut the last row where a page of the file ends.
        series.write_text(content[:content.rfind("\n") + 1])
        rows = read_csv(series)
        self.assertEqual(len({len(column) for column in rows.values()}), 1)
        self.assertGreater(len(rows["time [s]"]), 4)
        with open(series, "a", encoding="utf-8") as file:
            file.write("0.0")  # as if it had been cut off within a row
        seconds = (round(60 * rows["time [s]"][-1]) + 6) / 60
        self.skerry("run", "--restart", checkpoint, "--seconds", seconds, "--probes", series)
        self.skerry("run", self.scene, "--seconds", seconds, "--probes", whole)
        self.assertEqual(series.read_text(), whole.read_text())

    def test_a_full_disk_leaves_whole_rows_and_takes_no_other_output_with_it(self):
        series, stats = self.folder / "series.csv", self.folder / "stats.json"
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (30000, 30000))
        done = subprocess.run([PROGRAM, "run", self.scene, "--seconds", "1", "--quiet", "--probes", series, "--stats",
                               stats], preexec_fn=limit, capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("series.csv", done.stderr)
        self.assertEqual(list(json.loads(stats.read_text())["outputs_failed"]), ["--probes"])
        rows = read_csv(series)
        self.assertEqual(len({len(column) for column in rows.values()}), 1)
        self.assertGreater(len(rows["time [s]"]), 5)
        self.assertTrue(series.read_text().endswith("\n"))

    def test_a_resumed_run_refuses_a_series_of_other_probes_and_leaves_it_as_it_is(self):
        series, checkpoint = self.folder / "series.csv", self.folder / "run.skerry"
        self.skerry("run", self.scene, "--seconds", 0.05, "--checkpoint", checkpoint)
        series.write_text("time [s],other.kinetic [J]\n0,1\n")
        before = series.read_text()
        self.assert_refused("run", "--restart", checkpoint, "--seconds", 0.1, "--probes", series,
                            message=["series.csv", "the column headings of the recorded probes"])
        self.assertEqual(series.read_text(), before)

    def test_a_resumed_run_keeps_an_existing_hdf5_file_and_begins_a_new_one_at_the_checkpoint(self):
        series, later, rows = (self.folder / name for name in ("series.h5", "later.h5", "later.csv"))
        checkpoint = self.folder / "run.skerry"
        self.skerry("run", self.scene, "--seconds", 0.05, "--checkpoint", checkpoint, "--probes", series)
        before = series.read_bytes()
        self.assert_refused("run", "--restart", checkpoint, "--seconds", 0.1, "--probes", series,
                            message=["series.h5", "an existing file", "a new file", ".csv"])
        self.assertEqual(series.read_bytes(), before)
        for file in (later, rows):
            self.skerry("run", "--restart", checkpoint, "--seconds", 0.1, "--probes", file)
        columns = read_csv(rows)
        self.assertGreater(min(columns["time [s]"]), 0.05)
        heights = columns["corner.position_z [m]"]
        self.assertGreater(len(heights), 1)
        self.assertTrue(struct.pack(f"<{len(heights)}d", *heights) in later.read_bytes())

    def test_frames_have_displacements_strains_names_and_forces(self):
        out = self.folder / "frames"
        self.skerry("run", self.scene, "--out", out, "--seconds", 0.3)
        first, texts = read_vtk(out / "two_bodies_0000.vtu")
        self.assertEqual(texts, {})  # meshio refuses texts
        _, names = read_vtk(out / "two_contacts_0000.vtp")
        self.assertEqual(names.pop("collider_names"), ["floor"])
        last, _ = read_vtk(out / "two_bodies_0006.vtu")
        self.assertEqual(names, {"body_names": ["block", "strap é"], "material_names": ["rubber", "cord, thick"]})
        place = ("Points", "Points")
        for before, now, moved in zip(first[place], last[place], last["PointData", "displacement"]):
            for k in range(3):
                self.assertAlmostEqual(now[k] - before[k], moved[k], delta=1e-6)
        self.assertEqual(set(first["PointData", "displacement"]), {(0, 0, 0)})
        cells, points = len(last["Cells", "types"]), len(last[place])
        for name, width in (("stress", 6), ("strain", 6)):
            self.assertEqual([len(row) for row in last["CellData", name]], [width] * cells)
            self.assertEqual([len(row) for row in last["PointData", name]], [width] * points)
        for body, material in zip(last["CellData", "body"], last["CellData", "material"]):
            self.assertEqual(body, material)
        # its own weight presses the block, which does not turn: about half of it at mid-height
        of_block = [row[2] for row, body in zip(last["CellData", "stress"], last["CellData", "body"]) if body == (0,)]
        self.assertAlmostEqual(sum(of_block) / len(of_block), -500 * GRAVITY * 0.1, delta=100)
        of_block = [row[2] for row, body in zip(last["CellData", "strain"], last["CellData", "body"]) if body == (0,)]
        self.assertAlmostEqual(sum(of_block) / len(of_block), -500 * GRAVITY * 0.1 / 5e4, delta=2e-3)
        contacts, names = read_vtk(out / "two_contacts_0006.vtp")
        self.assertEqual(names["collider_names"], ["floor"])
        force = sum(row[2] for row in contacts["PointData", "force"])
        self.assertAlmostEqual(force, 500 * 0.2 ** 3 * GRAVITY, delta=8)
        _, names = read_vtk(out / "two_colliders_0000.vtp")
        self.assertEqual(names, {"collider_names": ["floor"]})

    def test_displacements_go_on_from_the_first_frame_after_a_restart(self):
        out, checkpoint = self.folder / "frames", self.folder / "run.skerry"
        self.skerry("run", self.scene, "--out", out, "--checkpoint", checkpoint, "--seconds", 0.1)
        self.skerry("run", "--restart", checkpoint, "--out", out, "--seconds", 0.3)
        first, _ = read_vtk(out / "two_bodies_0000.vtu")
        last, _ = read_vtk(out / "two_bodies_0006.vtu")
        for before, now, moved in zip(first["Points", "Points"], last["Points", "Points"],
                                      last["PointData", "displacement"]):
            for k in range(3):
                self.assertAlmostEqual(now[k] - before[k], moved[k], delta=1e-6)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
