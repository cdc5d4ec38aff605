"""Finds the keys of scene files that a JSON schema describes, and examples of them in the scenes of the project."""
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def keys_of(schema):
    """All keys, as pairs (definition, key). The definition of the whole file is "scene"."""
    definitions = [("scene", schema), *schema["$defs"].items()]
    return [(name, key) for name, of in definitions for key in of.get("properties", {})]


def values_of(schema, json_value, definition="scene", of=None):
    """Yields (definition, key, value) for every key in a scene that is valid by the schema."""
    of = schema if of is None else of
    if "$ref" in of:
        definition = of["$ref"].rsplit("/", 1)[-1]
        of = schema["$defs"][definition]
    for choice in of.get("oneOf", []):
        yield from values_of(schema, json_value, definition, choice)
    if isinstance(json_value, list) and "items" in of:
        for item in json_value:
            yield from values_of(schema, item, definition, of["items"])
    if not isinstance(json_value, dict):
        return
    names = of.get("additionalProperties")
    for key, value in json_value.items():
        if key in of.get("properties", {}):
            yield definition, key, value
            yield from values_of(schema, value, definition, of["properties"][key])
        elif isinstance(names, dict):
            yield from values_of(schema, value, definition, names)


def examples_of(schema):
    """{(definition, key): (file, value)} of the keys that scenes of the project use. The examples come from scenes/keys
    where possible, and are as short as possible."""

    def rank(example):
        file, value = example
        return not file.startswith("scenes/keys/"), len(json.dumps(value))

    examples = {}
    for path in sorted((ROOT / "scenes").rglob("*.json")):
        for definition, key, value in values_of(schema, json.loads(path.read_text(encoding="utf-8"))):
            found = path.relative_to(ROOT).as_posix(), value
            examples[definition, key] = min(examples.get((definition, key), found), found, key=rank)
    return examples


def main():
    """Prints every key with its example."""
    schema = json.loads((ROOT / "docs/scene.schema.json").read_text(encoding="utf-8"))
    examples = examples_of(schema)
    for definition, key in keys_of(schema):
        file, value = examples.get((definition, key), ("", None))
        print(f"{definition}.{key}: {json.dumps(value) if file else 'no example'}  {file}")
    return 0 if examples.keys() >= set(keys_of(schema)) else 1


if __name__ == "__main__":
    sys.exit(main())
