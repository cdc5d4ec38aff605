"""Bad files of cases, options and launchers: each is answered by one error that names the file, the object or field,
what was found and what was expected, with exit code 2 and nothing left behind.

Called as: sweep_inputs_test.py PROGRAM SOURCE_FOLDER
"""
import os
import sys
import unittest

sys.dont_write_bytecode = True
from program_case import ProgramCase

MU = "materials.rubber.mu"


def grid(*parameters):
    return {"scene": "drop.json", "grid": [{"set": MU, **parameter} for parameter in parameters]}


def drawn(**keys):
    return {"scene": "drop.json", "random": {"seed": 1, "count": 2, "parameters": [{"set": MU, **keys}]}}


# name, content of the file of cases, words that the message has
FILES = [
    ("an empty file", "", ["cases.json", "an empty file", "cases in JSON"]),
    ("broken JSON", '{"scene": "drop.json",', ["cases.json", "line 1", "not valid JSON"]),
    ("a list", "[]", ["cases.json", "the list []", "an object"]),
    ("no scene", {"list": [{}]}, ["cases.json", '"scene"']),
    ("a scene that is not there", {"scene": "dorp.json", "list": [{}]},
     ["scene", "dorp.json", "path of an existing file"]),
    ("a scene that is none", {"scene": "rubbish.json", "list": [{}]}, ["rubbish.json", "not valid JSON"]),
    ("no cases", {"scene": "drop.json"}, ['"grid", "list", "random"']),
    ("two kinds of cases", {"scene": "drop.json", "list": [{}], "grid": []}, ["grid", "list", "exactly one"]),
    ("an empty grid", {"scene": "drop.json", "grid": []}, ["an empty list of cases"]),
    ("an unknown key", {"scene": "drop.json", "gird": []}, ["gird", "unknown key", '"grid"']),
    ("a key twice", '{"scene": "drop.json", "scene": "drop.json"}', ["scene", "twice"]),
    ("an unknown key of a parameter", grid({"vales": [1]}), ["grid[0].vales", "unknown key", '"values"']),
    ("a parameter without a place", {"scene": "drop.json", "grid": [{"values": [1]}]}, ["grid[0]", '"set"']),
    ("no values", grid({"values": []}), ["grid[0].values", "empty", "at least one"]),
    ("values both ways", grid({"values": [1], "from": 1, "to": 2, "count": 2}), ["grid[0]", "values", "from"]),
    ("no end", grid({"from": 1, "count": 2}), ["grid[0]", '"from"', '"to"']),
    ("no step", grid({"from": 1, "to": 1, "count": 2}), ["grid[0].to", "the same number as"]),
    ("a count of zero", grid({"from": 1, "to": 2, "count": 0}), ["grid[0].count", "0", "at least 1"]),
    ("a logarithm of zero", grid({"from": 0, "to": 2, "count": 3, "spacing": "log"}), ["grid[0].from", "above 0"]),
    ("an unknown spacing", grid({"from": 1, "to": 2, "count": 3, "spacing": "lgo"}), ["spacing", '"lgo"', '"log"']),
    ("too many cases", {"scene": "drop.json", "grid": [
        {"set": MU, "from": 0, "to": 1, "count": 1000}, {"set": "seconds", "from": 0.1, "to": 1, "count": 1001}]},
     ["grid", "1001000 combinations", "1000000"]),
    ("a place twice", grid({"values": [1]}, {"name": "other", "values": [1]}), ["grid[1].set", MU, "already sets"]),
    ("a name twice", grid({"name": "a", "values": [1]}, {"name": "a", "set": "seconds", "values": [1]}),
     ["grid[1].name", '"a", which is already']),
    ("a name that tables have", grid({"name": "status", "values": [1]}),
     ["grid[0].name", '"status"', "another name for the parameter"]),
    ("an item that is not there", grid({"set": "bodies[3].name", "values": ["a"]}),
     ["cases.json", "grid[0].set", "drop.json", "index 3 in a list of length 1"]),
    ("a place within a number", grid({"set": "seconds.x", "values": [1]}), ["grid[0].set", "seconds.x", "an object"]),
    ("a material that is not there", grid({"set": "materials.ruber.mu", "values": [1]}),
     ["grid[0].set", "materials.ruber.mu", '"rubber"']),
    ("a key that scenes have not", grid({"set": "materials.rubber.frictoin", "values": [1]}),
     ["cases.json", "no case", "drop.json", "frictoin", '"friction"']),
    ("an assignment as a place", grid({"set": MU + "=1", "values": [1]}), ["grid[0].set", "a place without"]),
    ("a value that no case can have", grid({"values": [-1, -2]}), ["grid", "no case", "mu=-1", "at least 0"]),
    ("a bad place for all cases", {"scene": "drop.json", "set": {"bodies[2].name": "a"}, "list": [{}]},
     ["cases.json", "set", "index 2 in a list of length 1"]),
    ("a bad place in a list", {"scene": "drop.json", "list": [{}, {"bodies[2].name": "a"}]}, ["list[1]", "index 2"]),
    ("a case that is a number", {"scene": "drop.json", "list": [3]}, ["list[0]", "the number 3", "an object"]),
    ("no seed", {"scene": "drop.json", "random": {"count": 1, "parameters": [{"set": MU}]}}, ["random", '"seed"']),
    ("a seed below zero", {"scene": "drop.json", "random": {"seed": -1, "count": 1, "parameters": []}},
     ["random.seed", "-1"]),
    ("nothing to draw", {"scene": "drop.json", "random": {"seed": 1, "count": 1, "parameters": []}},
     ["random.parameters", "empty"]),
    ("a draw without an end", drawn(**{"from": 1}), ["random.parameters[0]", '"to"', '"uniform"']),
    ("a draw upside down", drawn(**{"from": 1, "to": 0}), ["random.parameters[0].to", "above"]),
    ("ends of a normal distribution", drawn(distribution="normal", mean=1, deviation=1, to=2),
     ["random.parameters[0].to", '"normal"', '"mean" and "deviation"']),
    ("no deviation", drawn(distribution="normal", mean=1, deviation=0), ["deviation", "above 0"]),
    ("half an integer", drawn(distribution="integer", **{"from": 1.5, "to": 3}), ["from", "1.5", "a whole number"]),
    ("an unknown distribution", drawn(distribution="gauss", mean=1, deviation=1), ["distribution", '"gauss"']),
]

# options, environment, words that the message has
PROCESSES = [
    (["--rank", "2", "--of", "2"], {}, ["rank 2 of 2", "from 0 to 1"]),
    (["--rank", "0"], {}, ["--rank without --of"]),
    (["--jobs", "0"], {}, ["--jobs"]),
    (["--jobs", "many"], {}, ["--jobs"]),
    ([], {"SLURM_PROCID": "x", "SLURM_NTASKS": "2"}, ["SLURM_PROCID", '"x"', "--rank I --of N"]),
    ([], {"PMI_RANK": "4", "PMI_SIZE": "4"}, ["PMI_RANK", "rank 4 of 4"]),
    ([], {"SLURM_ARRAY_TASK_ID": "9", "SLURM_ARRAY_TASK_COUNT": "2"}, ["SLURM_ARRAY_TASK_ID", "without gaps"]),
]


class SweepInputsTest(ProgramCase):
    def setUp(self):
        super().setUp()
        self.write("rubbish.json", "not a scene")
        self.out = self.folder / "results"

    def test_bad_files_of_cases(self):
        for name, content, message in FILES:
            with self.subTest(name):
                cases = self.write("cases.json", content)
                done = self.assert_refused("sweep", cases, "--out", self.out, message=message)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    def test_files_that_are_none(self):
        self.assert_refused("sweep", self.folder / "none.json", message=["none.json", "no such file", "cases in JSON"])
        self.assert_refused("sweep", self.folder, message=["a folder", "cases in JSON"])
        self.assert_refused("sweep", self.scene, "--out", self.out, message=["drop.json", "unknown key"])
        self.assert_refused("sweep", message=["CASES"])

    def test_bad_places_for_results(self):
        cases = self.write("cases.json", {"scene": "drop.json", "list": [{}]})
        self.assert_refused("sweep", cases, "--out", self.scene, message=["drop.json", "not a folder"])
        own = self.write("case_000000.json", {"scene": "drop.json", "list": [{}]})
        self.assert_refused("sweep", own, "--out", self.folder, "--redo",
                            message=["case_000000.json", "another folder"])
        (self.out / "sweep.csv").mkdir(parents=True)
        self.assert_refused("sweep", cases, "--out", self.out, message=["sweep.csv", "a folder", "the name of a file"])

    def test_bad_processes(self):
        cases = self.write("cases.json", {"scene": "drop.json", "list": [{}]})
        for options, environment, message in PROCESSES:
            with self.subTest(message[0]):
                os.environ.update(environment)
                try:
                    self.assert_refused("sweep", cases, "--out", self.out, *options, message=message)
                finally:
                    for key in environment:
                        del os.environ[key]


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
