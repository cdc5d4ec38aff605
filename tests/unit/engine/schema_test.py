"""Every shipped scene is valid by the published schema, which refuses the same values as the reader. Every key has an
example in a scene. Skipped without python3-jsonschema."""
import copy
import json
import pathlib
import sys

try:
    import jsonschema
except ImportError:
    print("skipped: no python3-jsonschema")
    sys.exit(77)

ROOT = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(ROOT / "scripts/lib"))
import scene_keys  # noqa: E402

schema = json.loads((ROOT / "docs/scene.schema.json").read_text())
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)

scenes = {path.name: json.loads(path.read_text()) for path in sorted((ROOT / "scenes").rglob("*.json"))}
assert len(scenes) >= 9, "the scenes are not where they were"
for name, scene in scenes.items():
    errors = [f"{name}: {error.json_path}: {error.message}" for error in validator.iter_errors(scene)]
    assert not errors, "\n".join(errors)


def spoiled(change):
    scene = copy.deepcopy(scenes["skittles.json"])
    change(scene)
    return scene


def set_in(container, key, value):
    container[key] = value


MISTAKES = {
    "unknown key": lambda s: set_in(s, "colider", []),
    "unknown body key": lambda s: set_in(s["bodies"][0], "postion", [0, 0, 0]),
    "negative modulus": lambda s: set_in(s["materials"]["ball"], "young_modulus", -1),
    "both names of a key": lambda s: set_in(s["materials"]["ball"], "E", 1e5),
    "only static friction": lambda s: (s["materials"]["ball"].pop("friction"),
                                       set_in(s["materials"]["ball"], "static_friction", 1)),
    "two meshes": lambda s: set_in(s["bodies"][1]["mesh"], "file", "x.msh"),
    "no material": lambda s: s["bodies"][1].pop("material"),
    "two numbers": lambda s: set_in(s["bodies"][1], "position", [1, 2]),
    "unknown method": lambda s: set_in(s["settings"], "method", "steepest"),
    "position and positions": lambda s: set_in(s["bodies"][0], "position", [0, 0, 0]),
}
for name, change in MISTAKES.items():
    assert not validator.is_valid(spoiled(change)), name + " passed the schema"
assert validator.is_valid(spoiled(lambda s: set_in(s["bodies"][1], "rotation", {"axis": [0, 0, 1], "degrees": 5})))
assert validator.is_valid(spoiled(lambda s: set_in(s["bodies"][1], "rotation", [[1, 0, 0], [0, 1, 0], [0, 0, 1]])))
without_example = [f"{of}.{key}" for of, key in set(scene_keys.keys_of(schema)) - set(scene_keys.examples_of(schema))]
assert not without_example, f"add an example to a scene in scenes/keys: {sorted(without_example)}"
print(f"{len(scenes)} scenes are valid, {len(MISTAKES)} mistakes are not")
