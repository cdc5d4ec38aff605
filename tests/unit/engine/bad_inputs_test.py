"""Bad inputs of many kinds: each is answered by one error that names the file, the object or field, what was found and
what was expected, with exit code 2 and nothing left behind.

Called as: bad_inputs_test.py PROGRAM SOURCE_FOLDER
"""
import copy
import os
import sys
import unittest

sys.dont_write_bytecode = True
from program_case import SCENE, ProgramCase

CUBE = {"box": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}}
BODY = {"name": "second", "mesh": CUBE, "material": "rubber", "position": [2, 0, 2]}
BASE = {**copy.deepcopy(SCENE), "bodies": [SCENE["bodies"][0], BODY]}
NOWHERE = {"lower": [5, 5, 5], "upper": [6, 6, 6]}
POINTS = [{"point": [0, 0, 1]}, {"body": "block"}]
SMALL, LARGE = [-0.3, -0.3, -0.3], [0.3, 0.3, 0.3]


def probe(**keys):
    return [{"name": "p", **keys}]


# name, place in the scene, value put there (REMOVED: nothing), words that the message has
REMOVED = object()
SCENES = [
    # quantities of materials
    ("a negative modulus", "materials.rubber.E", -1, ["materials.rubber.E", "-1", "above 0"]),
    ("a modulus of zero", "materials.rubber.E", 0, ["materials.rubber.E", "0", "above 0"]),
    ("a modulus in a text", "materials.rubber.E", "1 MPa", ["materials.rubber.E", '"1 MPa"', "number"]),
    ("an incompressible material", "materials.rubber.nu", 0.5, ["materials.rubber.nu", "0.5", "below 0.5"]),
    ("negative friction", "materials.rubber.mu", -0.1, ["materials.rubber.mu", "-0.1", "at least 0"]),
    ("an unknown law", "materials.rubber.model", "hook", ["materials.rubber.model", '"hook"', '"linear"']),
    ("a typing mistake in a key", "materials.rubber.densty", 1, ["densty", "unknown key", '"density"']),
    ("both names of one key", "materials.rubber.density", 1, ["density", '"rho"', "the same"]),
    ("a material that is a list", "materials.rubber", [1, 2], ["materials.rubber", "the list [1,2]", "an object"]),
    ("a modulus without bounds", "materials.rubber.E", 1e300, ["rubber", "light"]),
    ("half of two frictions", "materials.rubber.static_friction", 0.5, ["static_friction", "dynamic_friction"]),
    # bodies and meshes
    ("a body without a mesh", "bodies.0.mesh", REMOVED, ['body "block"', '"mesh"']),
    ("a material that there is not", "bodies.0.material", "ruber", ['body "block"', '"ruber"', '"rubber"']),
    ("a material in place of its name", "bodies.0.material", {"E": 1e5},
     ["bodies[0].material", "found the object", "name of one of the materials"]),
    ("two bodies of one name", "bodies.1.name", "block",
     ['"block", which is already the name of a body', "a different name for every body"]),
    ("a body without a name", "bodies.0.name", "", ["bodies[0].name", "empty"]),
    ("a position of two numbers", "bodies.0.position", [0, 0], ["bodies[0].position", "[0,0]", "3 numbers"]),
    ("a position that is a text", "bodies.0.position", "origin", ["bodies[0].position", '"origin"', "3 numbers"]),
    ("a box of no size", "bodies.0.mesh.box.size", [0, 1, 1], ["bodies[0].mesh.box.size[0]", "0", "above 0"]),
    ("a box without cells", "bodies.0.mesh.box.cells", [0, 1, 1], ["bodies[0].mesh.box.cells[0]", "at least 1"]),
    ("a box of too many cells", "bodies.0.mesh.box.cells", [1, 1, 10 ** 6], ["cells[2]", "1000000", "at most 1000"]),
    ("cells that are no whole numbers", "bodies.0.mesh.box.cells", [1, 1, 1.5], ["cells[2]", "1.5", "whole"]),
    ("two shapes at once", "bodies.0.mesh.ball", {"radius": 1, "resolution": 2}, ["bodies[0].mesh", "box", "ball"]),
    ("a mesh without a shape", "bodies.0.mesh", {}, ["bodies[0].mesh", "box", "file"]),
    ("a scale of zero", "bodies.0.mesh.scale", 0, ["bodies[0].mesh.scale", "0", "above 0"]),
    ("a mesh file that is not there", "bodies.0.mesh", {"file": "none.msh"}, ["none.msh", "bodies[0].mesh"]),
    ("a mesh file that is a folder", "bodies.0.mesh", {"file": "folder.msh"}, ["folder.msh", "a folder"]),
    ("a mesh file of rubbish", "bodies.0.mesh", {"file": "rubbish.msh"}, ["rubbish.msh", "$MeshFormat"]),
    ("an empty mesh file", "bodies.0.mesh", {"file": "empty.vtk"}, ["empty.vtk", "expected"]),
    ("a mesh file of another kind", "bodies.0.mesh", {"file": "mesh.doc"}, ["mesh.doc", ".msh"]),
    ("a negative contact distance", "bodies.0.contact_distance", -1, ["bodies[0].contact_distance", "at least 0"]),
    ("an unknown element", "bodies.0.element", "cubic", ["bodies[0].element", '"cubic"', '"smoothed"']),
    ("labels that the mesh has not", "bodies.0.materials", {"3": "rubber"}, ["materials.3", "label 3"]),
    ("a turn about no axis", "bodies.0.rotation", {"axis": [0, 0, 0], "degrees": 3}, ["bodies[0].rotation", "axis"]),
    ("too many copies", "bodies.0.repeat", {"count": [1000, 1000, 2], "spacing": [1, 1, 1]}, ["count", "2000000"]),
    ("self contact by a number", "bodies.0.self_contact", 1, ["bodies[0].self_contact", "1", "true or false"]),
    # pins and motions
    ("a pin of no node", "bodies.0.pin", {"box": NOWHERE}, ["pin", "contains no node"]),
    ("a box upside down", "bodies.0.pin", {"box": {"lower": LARGE, "upper": SMALL}}, ["pin.box", "upper", "lower"]),
    ("a pin of a node that is not there", "bodies.0.pin", {"nodes": [0, 999]}, ["pin.nodes[1]", "999", "below"]),
    ("a pin of a node twice", "bodies.0.pin", {"nodes": [1, 1]}, ["pin.nodes[1]", "second time", "once"]),
    ("a pin of a negative node", "bodies.0.pin", {"nodes": [-1]}, ["pin.nodes[0]", "-1", "at least 0"]),
    ("keys out of order", "colliders.0.motion", {"keys": [{"time": 1}, {"time": 0}]}, ["motion", "keys", "time"]),
    ("a motion both ways", "colliders.0.motion", {"velocity": [1, 0, 0], "keys": [{"time": 0}, {"time": 1}]},
     ["motion", "velocity", "keys"]),
    # colliders
    ("a collider without a shape", "colliders.0.shape", REMOVED, ['collider "floor"', '"shape"']),
    ("a plane without a normal", "colliders.0.shape.plane.normal", [0, 0, 0], ["floor", "normal"]),
    ("a sphere of a negative radius", "colliders.0.shape", {"sphere": {"radius": -1}}, ["sphere.radius", "-1"]),
    ("restitution above one", "colliders.0.restitution", 1.5, ["colliders[0].restitution", "1.5", "at most 1"]),
    # the run
    ("no time", "seconds", 0, ["seconds", "0", "above 0"]),
    ("time without end", "seconds", 1e300, ["seconds"]),
    ("frames without end", "frame_step", 1e-300, ["frame_step"]),
    ("a negative step", "settings.step_size", -1, ["settings.step_size", "-1", "above 0"]),
    ("a setting that is internal now", "settings.sleep_speed", 0.01,
     ["bad.json", "settings.sleep_speed", "no longer exists", "delete the key", '"sleep_time"']),
    ("threads by thousands", "settings.threads", 5000, ["settings.threads", "5000", "at most 1024"]),
    ("gravity of one number", "settings.gravity", 9.81, ["settings.gravity", "9.81", "3 numbers"]),
    ("an unknown method", "settings.method", "gauss", ["settings.method", '"gauss"', '"automatic"']),
    ("a method that was removed", "settings.method", "nncg",
     ["bad.json", "settings.method", '"nncg"', 'use "automatic" or "ags"', "profile_solvers"]),
    ("another", "settings.method", "apgd", ["settings.method", '"apgd"', '"ags"', "profile_solvers"]),
    ("a third", "settings.method", "mprgp", ["settings.method", '"mprgp"', '"ags"', "profile_solvers"]),
    ("a friction law that was removed", "settings.friction", "cone_convex",
     ["bad.json", "settings.friction", '"cone_convex"', 'use "cone"', "profile_solvers"]),
    ("regions that were removed", "settings.contact_regions", "paper_algorithm_1",
     ["bad.json", "settings.contact_regions", '"paper_algorithm_1"', 'use "separate"', "profile_separation"]),
    ("an include that is not there", "include", "none.json",
     ['include: found the path of a missing file, "none.json"', "the path of an existing file"]),
    ("a scene that includes itself", "include", "bad.json", ["bad.json", "include"]),
    ("bodies by name", "bodies", {"block": {}}, ["bodies", "the object", "a list"]),
    # cables
    ("a cable without a control", "cables", [{"points": POINTS}], ["cables[0]", "tension", "length", "rate"]),
    ("a cable that pushes", "cables", [{"points": POINTS, "tension": [[0, 1], [1, -1]]}],
     ["tension", "-1", "at least 0"]),
    ("a cable through one point", "cables", [{"points": POINTS[:1], "length": 1}], ["cables[0]", "at least 2 points"]),
    ("a cable of an unknown body", "cables", [{"points": [{"body": "blok"}, {}], "length": 1}],
     ["cables[0].points[0].body", '"blok"', '"block"']),
    ("a cable far from its body", "cables", [{"points": [{"body": "block", "point": [9, 0, 0]}, {}], "length": 1}],
     ["cables[0]", "points[0].point", "outside body 'block'"]),
    # probes
    ("a probe of no known quantity", "probes", probe(quantity="heat"), ["probes[0].quantity", '"heat"', '"energy"']),
    ("a probe without a name", "probes", [{"quantity": "energy"}], ["probes[0]", '"name"']),
    ("a probe with an empty name", "probes", [{"name": "", "quantity": "energy"}], ["probes[0].name", "empty"]),
    ("a probe called time", "probes", [{"name": "time", "quantity": "energy"}], ["probes[0].name", "column headings"]),
    ("a probe with a slash", "probes", [{"name": "a/b", "quantity": "energy"}], ['"a/b"', "without /"]),
    ("two probes of one name", "probes", probe(quantity="energy") * 2,
     ['"p", which is already the name of a probe', "a different name for every probe"]),
    ("contacts without a box", "probes", probe(body="block"), ['neither "box" nor "set"', "contacts"]),
    ("motion of nobody", "probes", probe(quantity="motion"), ['no key "body"', '"motion"']),
    ("motion of a body that there is not", "probes", probe(quantity="motion", body="blok"), ['"blok"', '"block"']),
    ("motion of a point outside", "probes", probe(quantity="motion", body="block", point=[0, 0, 9]),
     ["probes[0].point", "[0, 0, 9]", "inside the body", "the nearest node is at"]),
    ("motion of a point of two numbers", "probes", probe(quantity="motion", body="block", point=[0, 0]),
     ["probes[0].point", "3 numbers"]),
    ("a force on nobody", "probes", probe(quantity="force"),
     ['neither "body" nor "collider"', "exactly one of the two keys"]),
    ("a force on two", "probes", probe(quantity="force", body="block", collider="floor"),
     ['both "body" and "collider"', "exactly one of the two keys"]),
    ("a force by nobody", "probes", probe(quantity="force", body="block", by="flor"),
     ["probes[0].by", '"flor"', "a body or a collider", '"floor"']),
    ("a force of a collider by itself", "probes", probe(quantity="force", collider="floor", by="floor"),
     ["probes[0].by", '"floor"', "the name of a body"]),
    ("a reaction without a pin", "probes", probe(quantity="reaction", body="block"),
     ["probes[0].body", "a body without pins", "a body with pins"]),
    ("a negative pin", "probes", probe(quantity="reaction", body="block", pin=-1),
     ["probes[0].pin", "-1", "at least 0"]),
    ("energy of a body", "probes", probe(quantity="energy", body="block"),
     ["probes[0].body", '"energy"', 'only the keys "name" and "quantity"']),
    ("stress of no node", "probes", probe(quantity="stress", body="block", box=NOWHERE),
     ["probes[0].box", "contains no node"]),
    ("volume of a point", "probes", probe(quantity="volume", body="block", point=[0, 0, 0]),
     ["probes[0].point", '"volume"', '"body"']),
    ("rows without end", "probe_step", 1e-300, ["probe_step"]),
    ("a negative time between rows", "probe_step", -1, ["probe_step", "-1", "above 0"]),
]

# name, bytes of a scene file, words of the message
FILES = [
    ("an empty file", b"", ["bad.json"]),
    ("binary rubbish", bytes(range(256)), ["bad.json", "line 1"]),
    ("zeros", bytes(1000), ["bad.json", "line 1"]),
    ("a file that ends early", b'{"bodies": [', ["bad.json", "line 1"]),
    ("a comma too many", b'{"seconds": 1,}', ["bad.json", "line 1"]),
    ("a number that is none", b'{"seconds": NaN}', ["bad.json", "line 1"]),
    ("a number beyond all", b'{"seconds": 1e999}', ["bad.json"]),
    ("a key twice", b'{"seconds": 1, "probes": [], "seconds": 2}', ["bad.json: seconds: ", "twice"]),
    ("a list", b"[1, 2]", ["bad.json", "the list [1,2]", "an object"]),
    ("no JSON", b"<scene/>", ["bad.json", "line 1"]),
    ("text that is no UTF-8", b'{"name": "\xff\xfe"}', ["bad.json", "UTF-8"]),
    ("brackets without end", b"[" * 100000, ["bad.json"]),
]

# name, arguments (SCENE: a good one), words of the message
COMMANDS = [
    ("no command", [], ["subcommand"]),
    ("an unknown command", ["simulate"], ['"simulate"', '"run"', '"inspect"']),
    ("no scene", ["run"], ["SCENE"]),
    ("a scene that is not there", ["run", "none.json"], ["none.json", "no such file"]),
    ("a scene that is a folder", ["run", "folder.msh"], ["folder.msh", "a folder"]),
    ("a negative time", ["run", "SCENE", "--seconds", "-1"], ["--seconds", "-1", "above 0"]),
    ("a time that is no number", ["run", "SCENE", "--seconds", "soon"], ["--seconds", "soon"]),
    ("an unknown option", ["run", "SCENE", "--secnods", "1"], ["--secnods"]),
    ("series of an unknown kind", ["run", "SCENE", "--probes", "p.xlsx"], ["p.xlsx", "--probes", ".xlsx", ".csv"]),
    ("series without an extension", ["run", "SCENE", "--probes", "p"], ["--probes", "without extension", ".csv"]),
    ("a film of an unknown kind", ["run", "SCENE", "--film", "f.abc"],
     ["f.abc", "the extension .abc", ".usd or .usdc"]),
    ("a glTF file of text", ["run", "SCENE", "--gltf", "f.gltf"], ["f.gltf", "the extension .gltf", ".glb"]),
    ("a film whose colours end at zero", ["run", "SCENE", "--film", "f.usd", "--film-max", "0"],
     ["--film-max", "above 0"]),
    ("series in a folder", ["run", "SCENE", "--probes", "folder.csv"], ["folder.csv", "a folder", "a file"]),
    ("series in place of the figures", ["run", "SCENE", "--probes", "good.csv", "--stats", "./good.csv"],
     ["good.csv", "--probes", "--stats", "a different file"]),
    ("series that nothing has", ["run", "PLAIN", "--probes", "p.csv"],
     ["p.csv", "--probes", "a scene without probes that record a time series", "quantity"]),
    ("a change of nothing", ["run", "SCENE", "--set", "bodies[7].mesh=1"],
     ["good.json", "bodies[7].mesh=1", "index 7 in a list of length 2", "0 to 1"]),
    ("a change without a value", ["run", "SCENE", "--set", "seconds"], ["good.json", '"seconds"', "PLACE=VALUE"]),
    ("a restart from rubbish", ["run", "--restart", "rubbish.msh"], ["rubbish.msh"]),
    ("a restart from nothing", ["run", "--restart", "none.skerry"], ["none.skerry"]),
    ("no file to look at", ["inspect", "none.msh"], ["none.msh"]),
    ("rubbish to look at", ["inspect", "rubbish.msh"], ["rubbish.msh", "expected"]),
    ("a folder to look at", ["inspect", "folder.msh"], ["folder.msh", "a folder or device", "a mesh file"]),
    ("a problem of rubbish", ["solve", "rubbish.msh"], ["rubbish.msh", "expected"]),
    ("a method that was removed", ["solve", "rubbish.msh", "--method", "apgd"],
     ["--method", "apgd", '"ags"', "profile_solvers"]),
    ("a friction law that was removed", ["solve", "rubbish.msh", "--friction", "cone_convex"],
     ["--friction", "cone_convex", '"cone"', "profile_solvers"]),
    ("regions that were removed", ["run", "SCENE", "--contact-regions", "paper_algorithm_1"],
     ["--contact-regions", "paper_algorithm_1", '"separate"', "profile_separation"]),
    ("a tolerance of zero", ["solve", "rubbish.msh", "--tolerance", "0"], ["--tolerance", "0"]),
]


# Values of a valid scene with which no step is possible: exit code 1, statistics so far, and a message with the cause.
STEPS = [
    ("a velocity beyond all numbers", "bodies.0.velocity", [1e308, 0, 0], ["body 'block'", "velocity"]),
    ("a place beyond all digits", "bodies.0.position", [1e300, 0, 0], ["body 'block'", "far from the origin"]),
    ("a speed beyond all steps", "bodies.1.velocity", [0, 0, 1e150], ["body '"]),
]


def put(scene, place, value):
    *path, last = [int(part) if part.isdigit() else part for part in place.split(".")]
    target = scene
    for part in path:
        target = target.setdefault(part, {}) if isinstance(target, dict) else target[part]
    if value is REMOVED:
        del target[last]
    else:
        target[last] = value


class BadInputsTest(ProgramCase):
    def setUp(self):
        super().setUp()
        (self.folder / "folder.msh").mkdir()
        (self.folder / "folder.csv").mkdir()
        (self.folder / "rubbish.msh").write_bytes(bytes(range(255, -1, -1)) * 9)
        self.write("empty.vtk", "")
        self.write("mesh.doc", "a mesh")
        self.before = os.getcwd()
        os.chdir(self.folder)

    def tearDown(self):
        os.chdir(self.before)
        super().tearDown()

    def outputs(self):
        return ["--out", "frames", "--stats", "s.json", "--page", "p.html", "--seconds", "0.01"]

    def assert_answered(self, *arguments, message):
        done = self.assert_refused(*arguments, message=message)
        self.assertNotIn("terminate called", done.stderr)
        self.assertNotIn("[json.exception", done.stderr)
        return done

    def test_bad_values_of_scenes_are_named(self):
        for name, place, value, message in SCENES:
            with self.subTest(name):
                scene = copy.deepcopy(BASE)
                put(scene, place, value)
                self.write("bad.json", scene)
                done = self.assert_answered("run", "bad.json", *(self.outputs() if place not in ("seconds",) else []),
                                            message=message)
                self.assertIn("bad.json", done.stderr)
                self.assertIn("found", done.stderr)
                self.assertIn("expected", done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1)

    def test_steps_that_cannot_be_taken_end_with_one_and_say_whose_fault_it_is(self):
        for name, place, value, message in STEPS:
            with self.subTest(name):
                scene = copy.deepcopy(BASE)
                put(scene, place, value)
                done = self.skerry("run", self.write("bad.json", scene), "--seconds", "0.01", "--quiet", code=1)
                for word in ("the step was not taken", *message):
                    self.assertIn(word, done.stderr)

    def test_files_that_are_no_scenes_are_named(self):
        for name, content, message in FILES:
            with self.subTest(name):
                (self.folder / "bad.json").write_bytes(content)
                done = self.assert_answered("run", "bad.json", *self.outputs(), message=message)
                self.assertEqual(done.stderr.count("\n"), 1)
                self.assert_answered("inspect", "bad.json", message=message)

    def test_bad_commands_are_named(self):
        scene = copy.deepcopy(BASE)
        self.write("plain.json", scene)
        scene["probes"] = [{"name": "energy", "quantity": "energy"}]
        self.write("good.json", scene)
        names = {"SCENE": "good.json", "PLAIN": "plain.json"}
        for name, arguments, message in COMMANDS:
            with self.subTest(name):
                self.assert_answered(*[names.get(argument, argument) for argument in arguments], message=message)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
