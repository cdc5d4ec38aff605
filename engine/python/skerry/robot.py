"""Writes a robot as a scene: python -m skerry.robot arm.urdf arm.json."""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ._errors import SceneError
from ._robot import Frame, PlannedBody, PlannedJoint, Robot, load_robot, plan_robot
from ._settings import Motor, SurfaceMesh

_MATERIAL = "links"


def write_scene(
    robot: Robot,
    path: str | os.PathLike[str],
    *,
    coordinates: Mapping[str, float] | None = None,
    fixed: bool | None = None,
    motors: bool = True,
    self_collision: bool = True,
) -> None:
    """Writes a robot as a scene file, which other scenes can include, and its surfaces into the folder NAME_meshes
    beside it. The arguments are those of World.add_robot()."""
    plan = plan_robot(robot, Frame(), coordinates, fixed=fixed, motors=motors)
    file = Path(path)
    meshes = file.with_name(f"{file.stem}_meshes")
    meshes.mkdir(parents=True, exist_ok=True)
    surfaces = {of.link.name: f"{meshes.name}/{of.link.name.replace('/', '_')}.obj" for of in plan.bodies}
    for of in plan.bodies:
        (file.parent / surfaces[of.link.name]).write_text(_obj_text(of.surface), encoding="utf-8")
    scene = {
        "name": robot.name,
        "materials": {_MATERIAL: {}},
        "bodies": [_body(of, surfaces[of.link.name]) for of in plan.bodies],
        "no_collision": [
            {"body": first, "to_body": second}
            for first, second in plan.pairs_apart(robot, self_collision=self_collision)
        ],
        "joints": [_joint(of) for of in plan.joints],
        "probes": [{"name": of.joint.name, "quantity": "joint", "joint": of.joint.name} for of in plan.joints],
    }
    file.write_text(json.dumps(scene, indent=1) + "\n", encoding="utf-8")


def _obj_text(surface: SurfaceMesh) -> str:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in surface.nodes.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in surface.triangles.tolist()]
    return "\n".join(lines) + "\n"


def _body(of: PlannedBody, surface: str) -> dict[str, Any]:
    body: dict[str, Any] = {
        "name": of.link.name,
        "mesh": {"file": surface},
        "material": _MATERIAL,
        "dynamics": "rigid",
        "position": of.frame.position.tolist(),
        "rotation": of.frame.rotation.tolist(),
        **{name: np.asarray(value).tolist() for name, value in of.mass_properties.items()},
    }
    if not of.collides:
        body |= {"collision_group": 0, "collision_mask": 0}
    if of.held:
        lower, upper = of.surface.nodes.min(axis=0), of.surface.nodes.max(axis=0)
        body["pin"] = {"box": {"lower": lower.tolist(), "upper": upper.tolist()}}
    return body


def _joint(of: PlannedJoint) -> dict[str, Any]:
    passive = of.joint.passive
    joint: dict[str, Any] = {
        "name": of.joint.name,
        "kind": of.joint.kind,
        "first": of.joint.link,
        "point": of.point.tolist(),
        "axis": of.axis.tolist(),
    }
    optional: dict[str, Any] = {
        "second": of.second,
        "coordinate": of.coordinate or None,
        "lower": of.joint.lower,
        "upper": of.joint.upper,
        "motor": None if of.motor is None else _motor(of.motor),
        "passive": {name: getattr(passive, name) for name in ("stiffness", "rest", "damping", "friction")},
    }
    if not any(optional["passive"].values()):
        del optional["passive"]
    if of.joint.mimic is not None:
        optional["mimic"] = dict(zip(("joint", "ratio", "offset"), of.joint.mimic, strict=True))
    return joint | {name: value for name, value in optional.items() if value is not None}


def _motor(motor: Motor) -> dict[str, float]:
    values = {"position": motor.position, "speed": motor.speed, "strength": motor.strength, "fastest": motor.fastest}
    return {name: value for name, value in values.items() if value is not None and math.isfinite(value)}


def main(arguments: list[str] | None = None) -> int:
    """Runs the command and returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m skerry.robot", description=__doc__)
    parser.add_argument("robot", help="URDF or MJCF file")
    parser.add_argument("scene", help="scene file to write")
    parser.add_argument("--free", action="store_true", help="let the base move")
    parser.add_argument("--no-motors", action="store_true", help="write no motors")
    given = parser.parse_args(arguments)
    try:
        robot = load_robot(given.robot)
        write_scene(robot, given.scene, fixed=False if given.free else None, motors=not given.no_motors)
    except (SceneError, OSError, ImportError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    for warning in robot.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
