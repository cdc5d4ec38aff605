"""Reading robots from files with the package mujoco (docs/decisions/0025-robot-files.md)."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from .._arrays import path_text
from .._errors import import_package, scene_error
from .._settings import JointPassive, SurfaceMesh
from .description import Drive, Frame, Reals, Robot, RobotJoint, RobotLink, mass_of
from .shapes import box_surface, capsule_surface, cylinder_surface, hull_surface, shells

_KINDS = ("free", "ball", "slider", "hinge")  # in the order of mjtJoint
_PLANE, _HEIGHTS, _SPHERE, _CAPSULE, _ELLIPSOID, _CYLINDER, _BOX, _MESH = range(8)  # values of mjtGeom
_CORNERS = 64  # largest number of corners of the convex hull of a mesh
_PACKAGE = "package://"
_MESHES = (".stl", ".obj", ".msh")  # file types of meshes that the package mujoco reads


def load_robot(path: str | os.PathLike[str], *, packages: Mapping[str, str | os.PathLike[str]] | None = None) -> Robot:
    """Reads a robot from a URDF or MJCF file. Needs the package mujoco. A mesh collides as its convex hull with at most
    64 corners. Robot.warnings lists the parts of the file that are not simulated.

    packages: folder of each package that a URDF names as package://NAME; default: a folder of this name that contains
        the file, or that lies in a folder above the file.
    SceneError: a file is missing or wrong, or a link has several joints."""
    file = Path(path_text(path, "path"))
    return _Reader(file, {name: Path(folder) for name, folder in (packages or {}).items()}).read()


class _Reader:
    """Reads one file. `spec` is its content and `model` the model that the package mujoco compiles from it."""

    def __init__(self, file: Path, packages: dict[str, Path]) -> None:
        self.file = file
        self.packages = packages
        self.warnings: list[str] = []
        try:
            root = ElementTree.parse(file).getroot()
        except OSError as error:
            raise scene_error("", "path", error.strerror or str(error), "a URDF or MJCF file", file=str(file)) from None
        except ElementTree.ParseError as error:
            raise scene_error("", "", str(error), "an XML file", file=str(file)) from None
        if root.tag not in ("robot", "mujoco"):
            raise scene_error("", "", f"<{root.tag}>", "<robot> (URDF) or <mujoco> (MJCF)", file=str(file))
        mujoco = import_package("mujoco")
        self.urdf = root if root.tag == "robot" else None
        try:
            self.spec = mujoco.MjSpec.from_file(str(file))
            self.spec.compiler.fusestatic = False
            self.name_all(self.spec.bodies[1:], "body")
            self.name_all(self.spec.joints, "joint")
            for mesh in self.spec.meshes:
                mesh.file = self.found(mesh.file)
                mesh.maxhullvert = _CORNERS if mesh.maxhullvert < 0 else mesh.maxhullvert
            if self.urdf is not None:
                self.spec.strippath = False
                for name, mimic in self.urdf_mimics(self.urdf):
                    if mimic[0] == name:
                        expected = "the name of another joint"
                        raise scene_error(f"joint '{name}'", "mimic", f"'{name}'", expected, file=str(self.file))
            self.model = self.spec.compile()
        except ValueError as error:
            if hasattr(error, "found"):
                raise
            raise scene_error("", "", " ".join(str(error).split()), "a valid model", file=str(file)) from None

    def warn(self, element: str, name: str, what: str) -> None:
        self.warnings.append(f"{element} '{name}': {what}" if name else f"{element}: {what}")

    @staticmethod
    def name_all(items: Sequence[Any], kind: str) -> None:
        """Gives each item without a name a name of the kind and a number, such as "joint_0"."""
        names = {item.name for item in items}
        for number, item in enumerate(items):
            if not item.name:
                item.name = f"{kind}_{number}"
                while item.name in names:
                    item.name += "_"

    def found(self, file: str) -> str:
        """Path of a mesh file. For a name package://NAME/FILE it is in the folder of the package NAME. Refuses missing
        files and unknown file types."""
        if not file:
            return file  # the MJCF file itself contains the mesh
        if Path(file).suffix.lower() not in _MESHES:
            raise scene_error(
                "mesh", "filename", f"'{file}'", f"a file of the type {', '.join(_MESHES)}", file=str(self.file)
            )
        if not file.startswith(_PACKAGE):
            folder = self.file.parent / self.spec.meshdir
            if not any(path.is_file() for path in (folder / file, folder / Path(file).name)):
                raise scene_error("mesh", "filename", f"'{file}', which does not exist", "a file", file=str(self.file))
            return file
        package, _, rest = file.removeprefix(_PACKAGE).partition("/")
        folders = [self.packages[package]] if package in self.packages else self.package_folders(package)
        for folder in folders:
            if (folder / rest).is_file():
                return str((folder / rest).resolve())
        raise scene_error(
            "mesh", "filename", f"'{file}', which does not exist", "a file of a known package",
            f'pass packages={{"{package}": FOLDER}}', file=str(self.file)
        )  # fmt: skip

    def package_folders(self, package: str) -> Iterator[Path]:
        """Folders with the name of the package that contain the file, or that lie in a folder above the file."""
        for above in self.file.resolve().parents:
            if above.name == package:
                yield above
            yield above / package

    def read(self) -> Robot:
        model = self.model
        self.warn_of_elements()
        self.group = np.zeros(model.nbody, int)  # for each body: index of the first body of its link
        for b in range(1, model.nbody):
            joined = model.body_parentid[b] == 0 or model.body_jntnum[b] > 0
            self.group[b] = b if joined else self.group[model.body_parentid[b]]
            if model.body_jntnum[b] > 1:
                names = ", ".join(repr(model.joint(model.body_jntadr[b] + k).name) for k in range(model.body_jntnum[b]))
                raise scene_error(
                    f"body '{model.body(b).name}'", "joint", names, "one joint of each body", file=str(self.file)
                )
        links = {link.name: link for link in map(self.link, np.unique(self.group[1:]).tolist())}
        joints = [self.joint(j) for j in range(model.njnt) if model.jnt_type[j] != 0]
        joints = self.with_mimics(self.with_drives(joints))
        return Robot(
            name=self.spec.modelname or self.file.stem,
            links=links,
            joints={joint.name: joint for joint in joints},
            apart=tuple(self.apart()),
            warnings=tuple(self.warnings),
        )

    # Links.

    def frame(self, positions: Reals, quaternions: Reals, row: int) -> Frame:
        """Frame from the row `row` of two tables of the model; quaternions are (w, x, y, z)."""
        w, x, y, z = quaternions[row]
        rotation = np.array([
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ])  # fmt: skip
        return Frame(np.array(positions[row]), rotation)

    def body_frame(self, b: int) -> Frame:
        return self.frame(self.model.body_pos, self.model.body_quat, b)

    def in_group(self, b: int) -> Frame:
        """Frame of a body relative to the first body of its link."""
        if self.group[b] == b:
            return Frame()
        return self.in_group(self.model.body_parentid[b]) @ self.body_frame(b)

    def link(self, first: int) -> RobotLink:
        model = self.model
        members = np.flatnonzero(self.group == first).tolist()
        parts, surfaces = [], []
        for b in members:
            frame = self.in_group(b)
            principal = frame @ self.frame(model.body_ipos, model.body_iquat, b)
            inertia = principal.rotation @ np.diag(model.body_inertia[b]) @ principal.rotation.T
            parts.append((float(model.body_mass[b]), principal.position, inertia))
            for g in np.flatnonzero(model.geom_bodyid == b).tolist():
                surface = self.surface(g)
                if surface is not None:
                    surfaces.append((surface, frame @ self.frame(model.geom_pos, model.geom_quat, g)))
        mass, center, inertia = mass_of(parts)
        parent = model.body_parentid[first]
        place = self.body_frame(first)
        if parent != 0:
            place = self.in_group(parent) @ place
        return RobotLink(
            name=model.body(first).name,
            members=tuple(model.body(b).name for b in members),
            parent=None if parent == 0 else model.body(self.group[parent]).name,
            place=place,
            moves=parent != 0 or model.body_jntnum[first] > 0,
            mass=mass,
            center_of_mass=center,
            inertia=inertia,
            surface=shells(surfaces),
        )

    def surface(self, g: int) -> SurfaceMesh | None:
        """Surface of the shape with index `g`; None if the shape does not collide or is not supported."""
        model = self.model
        if model.geom_contype[g] == 0 and model.geom_conaffinity[g] == 0:
            return None
        kind, size = model.geom_type[g], model.geom_size[g]
        if kind in (_PLANE, _HEIGHTS):
            self.warn("geom", self.name_of_geom(g), "planes and height fields of links are not supported")
            return None
        if kind == _BOX:
            return box_surface(size)
        if kind == _CYLINDER:
            return cylinder_surface(size[0], size[1])
        if kind == _ELLIPSOID:
            ball = capsule_surface(1, 0)
            return SurfaceMesh(nodes=ball.nodes * size, triangles=ball.triangles)
        if kind in (_SPHERE, _CAPSULE):
            return capsule_surface(size[0], size[1] if kind == _CAPSULE else 0)
        mesh = model.geom_dataid[g]
        nodes = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]]
        # Layout of mesh_graph for v corners and f faces of the hull: v; f; v offsets of edges; indices of the nodes of
        # the v corners; v + 3 f ends of edges; indices of the three nodes of each face.
        graph = model.mesh_graph[model.mesh_graphadr[mesh] :]
        corners, faces = graph[:2]
        start = 2 + 3 * corners + 3 * faces
        return hull_surface(np.asarray(nodes, float), graph[start : start + 3 * faces].reshape(-1, 3))

    def name_of_geom(self, g: int) -> str:
        return self.model.geom(g).name or f"of body {self.model.body(self.model.geom_bodyid[g]).name}"

    def apart(self) -> Iterator[tuple[str, str]]:
        """Pairs of names of links whose collision the file excludes."""
        for exclude in self.spec.excludes:
            first, second = (
                self.model.body(self.group[self.model.body(name).id]).name
                for name in (exclude.bodyname1, exclude.bodyname2)
            )
            yield first, second

    # Joints.

    def joint(self, j: int) -> RobotJoint:
        model = self.model
        name, kind, dof = model.joint(j).name, _KINDS[model.jnt_type[j]], model.jnt_dofadr[j]
        passive = JointPassive()
        has_axis = kind != "ball"
        damping, friction = float(model.dof_damping[dof]), float(model.dof_frictionloss[dof])
        if has_axis:
            passive = JointPassive(
                stiffness=float(model.jnt_stiffness[j]),
                rest=float(model.qpos_spring[model.jnt_qposadr[j]]),
                damping=damping,
                friction=friction,
            )
        elif damping or friction or model.jnt_stiffness[j] or model.jnt_limited[j]:
            self.warn("joint", name, "limits, stiffness, damping and friction of ball joints are not supported")
        columns = [("armature", model.dof_armature[dof]), ("margin", model.jnt_margin[j])]
        # Columns that only version 4 of the package has.
        later = (("jnt_stiffnesspoly", j), ("jnt_springyield", j), ("dof_dampingpoly", dof), ("jnt_actgravcomp", j))
        for column, row in later:
            if (values := getattr(model, column, None)) is not None:
                columns.append((column.partition("_")[2], float(np.abs(values[row]).max())))
        for column, value in columns:
            if value != 0:
                self.warn("joint", name, f"{column} {value:g} is not simulated")
        limited = has_axis and bool(model.jnt_limited[j])
        return RobotJoint(
            name=name,
            kind=kind,  # type: ignore[arg-type]
            link=model.body(model.jnt_bodyid[j]).name,
            point=np.array(model.jnt_pos[j]),
            axis=np.array(model.jnt_axis[j]),
            rest=float(model.qpos0[model.jnt_qposadr[j]]) if has_axis else 0.0,
            lower=float(model.jnt_range[j, 0]) if limited else None,
            upper=float(model.jnt_range[j, 1]) if limited else None,
            passive=passive,
            strength=float(np.abs(model.jnt_actfrcrange[j]).max()) if model.jnt_actfrclimited[j] else math.inf,
        )

    def with_drives(self, joints: list[RobotJoint]) -> list[RobotJoint]:
        """The joints with the motors of the file. In a URDF each hinge or slider with an effort limit has a motor."""
        if self.urdf is not None:
            speed = {
                joint.get("name"): self.fastest(joint.get("name", ""), limit.get("velocity", "inf"))
                for joint in self.urdf.iter("joint")
                if (limit := joint.find("limit")) is not None
            }
            return [
                replace(joint, drive="position", fastest=speed.get(joint.name, math.inf))
                if joint.has_coordinate and math.isfinite(joint.strength)
                else replace(joint, strength=0.0)
                for joint in joints
            ]
        of_name = {joint.name: replace(joint, strength=0.0) for joint in joints}
        for a in range(self.model.nu):
            of_joint = next((joint for joint in joints if joint.name == self.target_of(a)), None)
            if of_joint is None or not of_joint.has_coordinate:
                self.warn("actuator", self.model.actuator(a).name, "only actuators of hinges and sliders are supported")
            elif (motor := self.drive(a, of_joint)) is None:
                self.warn("actuator", self.model.actuator(a).name, "only position, velocity and motor are supported")
            elif of_name[of_joint.name].drive is not None:
                self.warn("actuator", self.model.actuator(a).name, "the joint has another actuator, which is used")
            else:
                of_name[of_joint.name] = replace(of_joint, drive=motor[0], strength=motor[1])
        return list(of_name.values())

    def fastest(self, joint: str, text: str) -> float:
        """The speed limit of a joint in a URDF, where 0 means that there is none."""
        try:
            return float(text) or math.inf
        except ValueError:
            raise scene_error(f"joint '{joint}'", "velocity", f"'{text}'", "a number", file=str(self.file)) from None

    def target_of(self, a: int) -> str | None:
        """Name of the joint that an actuator drives; None if it drives something else."""
        on_joint = 0  # mjTRN_JOINT
        of_joint = self.model.actuator_trntype[a] == on_joint
        return str(self.model.joint(self.model.actuator_trnid[a, 0]).name) if of_joint else None

    def drive(self, a: int, joint: RobotJoint) -> tuple[Drive, float] | None:
        """Drive and strength of the motor that replaces an actuator of a joint; None if no motor can replace it."""
        model, name = self.model, self.model.actuator(a).name
        gain, bias = model.actuator_gainprm[a], model.actuator_biasprm[a]
        gear = abs(float(model.actuator_gear[a, 0]))
        fixed, none, affine = 0, 0, 1  # mjGAIN_FIXED, mjDYN_NONE and mjBIAS_NONE, mjBIAS_AFFINE
        if model.actuator_gaintype[a] != fixed or model.actuator_dyntype[a] != none or gear == 0:
            return None
        drive: Drive
        ways = np.abs(model.actuator_ctrlrange[a]).max() if model.actuator_ctrllimited[a] else math.inf
        if model.actuator_biastype[a] == none:
            drive, most = "force", gain[0] * gear * ways
        elif model.actuator_biastype[a] != affine or bias[0] != 0:
            return None
        elif bias[1] == -gain[0]:
            # A servo exerts gain * (target - coordinate). With target and coordinate within the joint's limits,
            # this is at most gain * way. Without limits, `way` is a full turn.
            way = 2 * math.pi if joint.lower is None or joint.upper is None else joint.upper - joint.lower
            drive, most = "position", gain[0] * gear * gear * way
        elif bias[1] == 0 and bias[2] == -gain[0]:
            drive, most = "speed", gain[0] * gear * gear * 2 * ways
        else:
            return None
        if drive != "force":
            self.warn("actuator", name, "the gains are not simulated; the motor holds its target within its strength")
        if model.actuator_forcelimited[a]:
            most = min(most, gear * np.abs(model.actuator_forcerange[a]).max())
        most = min(float(most), joint.strength)
        if not math.isfinite(most):
            expected = "a forcerange or ctrlrange, which limits the force"
            raise scene_error(f"actuator '{name}'", "forcerange", "no limit", expected, file=str(self.file))
        return drive, most

    def with_mimics(self, joints: list[RobotJoint]) -> list[RobotJoint]:
        """Returns the joints with their mimics. A URDF file defines mimics, which the package mujoco does not read; an
        MJCF file defines them by equalities. Joints that mimic have no motor."""
        mimics = dict(self.urdf_mimics(self.urdf) if self.urdf is not None else self.equalities(joints))
        names = {joint.name for joint in joints if joint.has_coordinate}
        for name, mimic in mimics.items():
            if not {name, mimic[0]} <= names:
                raise scene_error(
                    f"joint '{name}'", "mimic", f"'{mimic[0]}'", "the name of a hinge or slider", file=str(self.file)
                )
        if self.urdf is None:
            for joint in joints:
                if joint.drive is not None and joint.name in mimics:
                    self.warn("actuator", f"of joint {joint.name}", "joints that an equality couples have no motor")
        return [
            replace(joint, mimic=mimics[joint.name], drive=None) if joint.name in mimics else joint for joint in joints
        ]

    @staticmethod
    def urdf_mimics(root: ElementTree.Element) -> Iterator[tuple[str, tuple[str, float, float]]]:
        for joint in root.iter("joint"):
            if (mimic := joint.find("mimic")) is not None:
                values = (float(mimic.get("multiplier", "1")), float(mimic.get("offset", "0")))
                yield joint.get("name", ""), (mimic.get("joint", ""), *values)

    def equalities(self, joints: list[RobotJoint]) -> Iterator[tuple[str, tuple[str, float, float]]]:
        model, of_joints = self.model, 2  # mjEQ_JOINT
        rest = {joint.name: joint.rest for joint in joints}
        for e in range(model.neq):
            constant, ratio, *higher = (float(value) for value in model.eq_data[e, :5])
            two = model.eq_type[e] == of_joints and model.eq_obj2id[e] >= 0
            if not two or any(higher) or ratio == 0 or not model.eq_active0[e]:
                self.warn("equality", model.equality(e).name, "only linear couplings of two joints are supported")
                continue
            first, second = (model.joint(row[e]).name for row in (model.eq_obj1id, model.eq_obj2id))
            yield first, (second, ratio, rest[first] + constant - ratio * rest[second])

    # Elements that are not simulated.

    def warn_of_elements(self) -> None:
        spec, model = self.spec, self.model
        for element, items in (
            ("tendon", spec.tendons), ("pair", spec.pairs), ("flex", spec.flexes), ("skin", spec.skins),
            ("plugin", spec.plugins),
        ):  # fmt: skip
            for item in items:
                self.warn(element, item.name, "is not supported")
        for g in np.flatnonzero(model.geom_bodyid == 0).tolist():
            self.warn("geom", self.name_of_geom(g), "shapes of the world are not part of the robot")
        for b in range(1, model.nbody):
            if model.body_gravcomp[b] != 0:
                self.warn("body", model.body(b).name, "gravcomp is not simulated")
            if model.body_mocapid[b] >= 0:
                self.warn("body", model.body(b).name, "mocap bodies stay fixed")
        option = self.spec.option
        if self.urdf is None and not np.array_equal(option.gravity, (0, 0, -9.81)):
            self.warn("option", "gravity", "is not read; set the gravity of the world or scene")
        for name in ("wind", "density", "viscosity"):
            if np.any(getattr(option, name)):
                self.warn("option", name, "forces of a fluid are not simulated")
        default = ((1, 0.005, 0.0001), (0.02, 1), (0.9, 0.95, 0.001, 0.5, 2))
        given = (model.geom_friction, model.geom_solref, model.geom_solimp)
        if any(len(rows) and not np.allclose(rows, value) for rows, value in zip(given, default, strict=True)):
            self.warn("geom", "", "friction, solref and solimp are not read; pass a material to add_robot()")
