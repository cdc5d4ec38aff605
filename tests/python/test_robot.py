"""Robots of URDF and MJCF files, beside the package mujoco and closed forms."""

import dataclasses
import itertools
import json
import pathlib
import sys
from collections.abc import Mapping

import numpy as np
import pytest

import skerry as sk
from skerry.robot import main, write_scene

mujoco = pytest.importorskip("mujoco")

ROBOTS = pathlib.Path(__file__).resolve().parents[2] / "examples/robots"
ARM, SWING = ROBOTS / "arm.urdf", ROBOTS / "swing.xml"

PENDULUM = """<robot name="pendulum"><link name="world"/>
<joint name="upper" type="continuous"><parent link="world"/><child link="one"/><axis xyz="0 1 0"/></joint>
<link name="one"><inertial><origin xyz="0 0 -0.2"/><mass value="2"/>
  <inertia ixx="0.03" iyy="0.025" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="lower" type="continuous"><parent link="one"/><child link="two"/><origin xyz="0 0 -0.5"/>
  <axis xyz="0 1 0"/></joint>
<link name="two"><inertial><origin xyz="0 0 -0.1"/><mass value="1"/>
  <inertia ixx="0.01" iyy="0.008" izz="0.005" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""

MESH = """<robot name="a"><link name="a">
  <collision><geometry><mesh filename="{}"/></geometry></collision></link></robot>"""
HINGE = """<robot name="a"><link name="a"/><link name="b"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>
  <limit lower="-1" upper="1" effort="5" velocity="{}"/>{}</joint></robot>"""


def exact_pendulum(angles: np.ndarray, seconds: float) -> np.ndarray:
    """The angles of the double pendulum PENDULUM, by the equations of Lagrange and the Runge-Kutta method of order 4.
    The second angle is relative to the first link."""
    m1, m2, c1, c2, l1, i1, i2, g = 2.0, 1.0, 0.2, 0.1, 0.5, 0.025, 0.008, 9.81

    def rate(state: np.ndarray) -> np.ndarray:
        a, b = state[0], state[0] + state[1]  # angles to the vertical
        va, vb = state[2], state[2] + state[3]
        couple = m2 * l1 * c2 * np.cos(a - b)
        mass = np.array([[i1 + m1 * c1**2 + m2 * l1**2, couple], [couple, i2 + m2 * c2**2]])
        turn = m2 * l1 * c2 * np.sin(a - b)
        force = [
            -turn * vb**2 - g * (m1 * c1 + m2 * l1) * np.sin(a),
            turn * va**2 - g * m2 * c2 * np.sin(b),
        ]
        wa, wb = np.linalg.solve(mass, force)
        return np.array([va, vb - va, wa, wb - wa])

    state, h = np.array([*angles, 0.0, 0.0]), 1e-3
    for _ in range(round(seconds / h)):
        k1 = rate(state)
        k2 = rate(state + h / 2 * k1)
        k3 = rate(state + h / 2 * k2)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(state + h * k3))
    return state[:2]


def swung(robot: sk.Robot, step: float, seconds: float, coordinates: Mapping[str, float]) -> np.ndarray:
    """Coordinates of a robot without motors after some time."""
    world = sk.World(threads=1, step_size=step, tolerance=1e-10, sleep=False)
    placed = world.add_robot(robot, coordinates=coordinates, motors=False)
    world.advance(seconds)
    assert world.report().energy_error_share < 1e-2
    return placed.positions


def test_the_frames_of_all_links_are_those_of_mujoco() -> None:
    random = np.random.default_rng(1)
    for path in (ARM, SWING):
        robot = sk.load_robot(path)
        model = mujoco.MjModel.from_xml_path(str(path))  # fuses links, but keeps these
        data = mujoco.MjData(model)
        values = {n: random.uniform(0, 0.06) for n in robot.coordinate_names if robot.joints[n].mimic is None}
        for name, value in robot.complete(values).items():
            data.qpos[model.joint(name).qposadr] = value
        mujoco.mj_kinematics(model, data)
        frames = robot.frames(values)
        names = [name for name in frames if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) > 0]
        assert len(names) >= 4
        for name in names:
            assert frames[name].position == pytest.approx(data.body(name).xpos, abs=1e-14)
            assert frames[name].rotation == pytest.approx(data.body(name).xmat.reshape(3, 3), abs=1e-14)
    assert robot.joints["knee"].rest == pytest.approx(np.radians(15))
    assert robot.joints["swing"].passive == sk.JointPassive(stiffness=0.5, rest=np.radians(20), damping=0.02)
    assert robot.joints["lift"].mimic == pytest.approx(("swing", 0.05, 0))
    assert robot.apart == (("upper", "rod"),)


def test_what_is_not_simulated_is_named() -> None:
    assert sk.load_robot(ARM).warnings == ()
    assert sk.load_robot(SWING).warnings == (
        "tendon 'string': is not supported",
        "joint 'knee': armature 0.001 is not simulated",
        "actuator 'servo': the gains are not simulated; the motor holds its target within its strength",
        "actuator 'pull': only actuators of hinges and sliders are supported",
        "equality 'glue': only linear couplings of two joints are supported",
    )


def test_options_and_motors_that_are_not_simulated_are_named(tmp_path: pathlib.Path) -> None:
    file = tmp_path / "robot.xml"
    file.write_text(
        '<mujoco><option gravity="0 0 -1" density="1.2"/><worldbody><body><joint name="x"/><geom size="0.1"/>'
        '<body><joint name="y"/><geom size="0.1"/></body></body></worldbody><actuator><motor joint="y" '
        'ctrlrange="-1 1"/></actuator><equality><joint joint1="y" joint2="x"/></equality></mujoco>'
    )
    assert sk.load_robot(file).warnings == (
        "option 'gravity': is not read; set the gravity of the world or scene",
        "option 'density': forces of a fluid are not simulated",
        "actuator 'of joint y': joints that an equality couples have no motor",
    )


def test_bodies_and_joints_without_name_are_numbered(tmp_path: pathlib.Path) -> None:
    file = tmp_path / "robot.xml"
    file.write_text(
        '<mujoco><worldbody><body><joint/><geom size="0.1"/><body name="body_1"><joint name="x"/><geom size="0.1"/>'
        '<body><joint type="ball"/><geom size="0.1"/></body></body></body></worldbody></mujoco>'
    )
    robot = sk.load_robot(file)
    assert list(robot.links) == ["body_0", "body_1", "body_2"]
    assert list(robot.joints) == ["joint_0", "x", "joint_2"]


def test_a_robot_has_the_masses_of_the_file() -> None:
    world = sk.World(threads=1)
    arm = world.add_robot(ARM, position=(1, 0, 0), coordinates={"elbow": 1.0}, name="left")
    assert set(world.bodies) == {"left/base", "left/upper", "left/lower", "left/left_finger", "left/right_finger"}
    assert {joint.name for joint in world.joints} == {"left/shoulder", "left/elbow", "left/left", "left/right"}
    assert arm.links["lower"] == arm.links["palm"]  # joined by a fixed joint
    assert arm.links["palm"].mass == pytest.approx(0.8)
    # Lower link 0.6 kg at 0.1 m, palm 0.2 kg at 0.22 m: both along the turned link.
    along = np.array([np.sin(1), 0, np.cos(1)])
    expected = np.array([1, 0, 0.47]) + (0.6 * 0.1 + 0.2 * 0.22) / 0.8 * along
    assert arm.links["lower"].center_of_mass == pytest.approx(expected, abs=1e-12)
    assert arm.positions == pytest.approx([0, 1, 0, 0])
    assert arm.joints["elbow"].limits == (-2.6, 2.6)
    assert arm.joints["shoulder"].passive == sk.JointPassive(damping=0.2, friction=0.1)
    # Linked parent and child do not collide.
    assert not world.may_collide(arm.links["upper"], arm.links["lower"])
    assert world.may_collide(arm.links["base"], arm.links["palm"])
    copy = world.copy()
    twin = arm.in_copy(copy)
    copy.advance(0.01)
    world.advance(0.01)
    assert np.array_equal(twin.positions, arm.positions)


def test_a_pendulum_of_two_links_converges_to_the_equations_of_lagrange(tmp_path: pathlib.Path) -> None:
    file = tmp_path / "pendulum.urdf"
    file.write_text(PENDULUM)
    robot = sk.load_robot(file)
    start = np.array([1.2, -0.7])
    exact = exact_pendulum(start, 0.5)
    assert np.abs(exact - start).max() > 0.5
    coordinates = dict(zip(robot.coordinate_names, start, strict=True))
    errors = [np.abs(swung(robot, step, 0.5, coordinates) - exact).max() for step in (2e-3, 1e-3)]
    assert errors[0] < 1e-2
    assert errors[1] < 0.6 * errors[0]


def test_an_arm_swings_as_in_mujoco() -> None:
    robot = sk.load_robot(ARM)
    shoulder = robot.joints["shoulder"]
    # Friction of mujoco is soft.
    joints = {**robot.joints, "shoulder": dataclasses.replace(shoulder, passive=sk.JointPassive(damping=0.2))}
    robot = dataclasses.replace(robot, joints=joints)
    model = mujoco.MjModel.from_xml_path(str(ARM))
    model.dof_frictionloss[:] = 0
    model.opt.timestep, model.opt.integrator = 1e-4, mujoco.mjtIntegrator.mjINT_RK4
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    data = mujoco.MjData(model)
    data.qpos[:2] = 0.5, 0.6
    for _ in range(3000):
        mujoco.mj_step(model, data)
    assert 0.9 < data.qpos[0] < 1.7 and abs(data.qpos[1] - 0.6) > 0.1  # within the limits, which are soft, too
    errors = [
        np.abs(swung(robot, step, 0.3, {"shoulder": 0.5, "elbow": 0.6})[:2] - data.qpos[:2]).max()
        for step in (2e-3, 1e-3)
    ]
    assert errors[0] < 1e-2
    assert errors[1] < 0.6 * errors[0]


def test_motors_hold_and_move_the_arm_and_the_fingers_mirror() -> None:
    world = sk.World(threads=1, tolerance=1e-10, step_size=2e-3)
    arm = world.add_robot(ARM, coordinates={"shoulder": 0.4, "elbow": 0.8})
    assert arm.motor_names == ("shoulder", "elbow", "left")
    world.advance(0.1)
    assert arm.positions == pytest.approx([0.4, 0.8, 0, 0], abs=1e-6)
    # Moment of all parts behind the shoulder about it, by the motor and its dry friction.
    links = {arm.links[name] for name in ("upper", "lower", "left_finger", "right_finger")}
    moment = sum(9.81 * link.mass * link.center_of_mass[0] for link in links)
    assert abs(arm.forces[0] + moment) < 0.1 + 1e-6
    arm.follow([0.1, 0.4], [[0.4, 0.8, 0], [0.6, 0.5, 0.03]])
    world.advance(0.2)
    assert arm.positions[2] == pytest.approx(0.02, abs=1e-6)
    assert abs(arm.positions[2] - arm.positions[3]) < 1e-9
    assert abs(arm.velocities[2] - arm.velocities[3]) < 1e-6
    world.advance(0.15)
    assert arm.positions == pytest.approx([0.6, 0.5, 0.03, 0.03], abs=1e-5)
    arm.set_targets([0.6, 0.5, 0.01])
    world.advance(0.3)
    assert arm.positions[2:] == pytest.approx([0.01, 0.01], abs=1e-6)
    assert arm.joints["right"].state.mimic != 0
    with pytest.raises(TypeError, match="targets"):
        arm.set_targets([0, 0])


def test_a_motor_with_a_force_exerts_it() -> None:
    world = sk.World(threads=1, gravity=(0, 0, 0))
    swing = world.add_robot(SWING)
    assert swing.robot.joints["swing"].drive == "force"
    swing.set_targets([-1.5, swing.positions[1]])
    world.advance(0.05)
    assert swing.joints["swing"].state.motor == pytest.approx(-1.5)
    swing.set_targets([5, swing.positions[1]])
    world.advance(0.05)
    assert swing.joints["swing"].state.motor == pytest.approx(2)  # the limit of the file
    with pytest.raises(sk.SceneError, match="joint 'swing': drive: found force"):
        swing.follow([0, 1], np.zeros((2, 2)))


def test_a_robot_with_a_free_base_falls() -> None:
    world = sk.World(threads=1, step_size=1e-3)
    arm = world.add_robot(ARM, fixed=False, position=(0, 0, 5), motors=False)
    world.advance(0.1)
    total = sum(body.mass for body in world.bodies.values())
    center = sum(body.mass * body.center_of_mass for body in world.bodies.values()) / total
    fallen = arm.robot.frames()
    before = sum(
        link.mass * fallen[name].points(link.center_of_mass[None])[0] for name, link in arm.robot.links.items()
    )
    assert center[2] - 5 - before[2] / total == pytest.approx(-9.81 * 0.1**2 / 2, rel=0.011)


def test_a_scene_of_a_robot_moves_as_the_robot(tmp_path: pathlib.Path) -> None:
    world = sk.World(threads=1)
    arm = world.add_robot(ARM, coordinates={"shoulder": 0.5})
    write_scene(arm.robot, tmp_path / "arm.json", coordinates={"shoulder": 0.5})
    scene = sk.load_scene({"include": [{"scene": str(tmp_path / "arm.json"), "name": "left"}]})
    assert list(scene.world.bodies) == [f"left/{name}" for name in arm.robot.links]
    for one in (world, scene.world):
        one.joints[0].set_motor(None)
        one.advance(0.2)
    found = [joint.coordinate for joint in scene.world.joints]
    assert found == pytest.approx(arm.positions, abs=1e-6)
    assert found[0] > 0.55
    assert scene.world.joints[3].mimic == (scene.world.joints[2], 1.0, 0.0)


@pytest.mark.parametrize("self_collision", [True, False])
def test_pairs_of_links_collide_in_a_scene_as_in_a_world(tmp_path: pathlib.Path, self_collision: bool) -> None:
    world = sk.World(threads=1)
    placed = world.add_robot(SWING, self_collision=self_collision)
    write_scene(placed.robot, tmp_path / "swing.json", self_collision=self_collision)
    other = sk.load_scene(tmp_path / "swing.json").world
    pairs = list(itertools.combinations([name for name in placed.links if name in other.bodies], 2))
    found = {pair: other.may_collide(*(other.bodies[name] for name in pair)) for pair in pairs}
    assert found == {pair: world.may_collide(*(placed.links[name] for name in pair)) for pair in pairs}
    assert ("upper", "rod") in found or ("rod", "upper") in found
    assert any(found.values()) == self_collision


def test_the_command_writes_a_scene(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(ARM), str(tmp_path / "arm.json"), "--no-motors"]) == 0
    scene = json.loads((tmp_path / "arm.json").read_text())
    assert [joint["name"] for joint in scene["joints"]] == ["shoulder", "elbow", "left", "right"]
    assert not any("motor" in joint for joint in scene["joints"])
    assert main([str(tmp_path / "nothing.urdf"), str(tmp_path / "arm.json")]) == 1
    assert "nothing.urdf" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot", "expected an XML file"),
        ("<arm/>", "found <arm>, expected <robot>"),
        ('<robot name="a"><link name="a"/><joint name="j" type="fixed"><parent link="a"/></joint></robot>', "child"),
        (
            '<robot name="a"><link name="a"><collision><geometry><mesh filename="package://nowhere/a.stl"/></geometry>'
            "</collision></link></robot>",
            "mesh: filename: found 'package://nowhere/a.stl'",
        ),
        (
            '<mujoco><worldbody><body name="b"><joint name="x"/><joint name="y" axis="1 0 0"/>'
            '<geom size="0.1"/></body></worldbody>'
            "</mujoco>",
            "body 'b': joint: found 'x', 'y', expected one joint",
        ),
        (
            '<mujoco><worldbody><body name="b"><joint name="x"/><geom size="0.1"/></body></worldbody>'
            '<actuator><motor name="m" joint="x"/></actuator></mujoco>',
            "actuator 'm': forcerange: found no limit",
        ),
        (MESH.format("nothing.stl"), "mesh: filename: found 'nothing.stl', which does not exist"),
        (MESH.format("part.dae"), "mesh: filename: found 'part.dae', expected a file of the type .stl, .obj"),
        (HINGE.format("1", '<mimic joint="j"/>'), "joint 'j': mimic: found 'j', expected the name of another joint"),
        (HINGE.format("fast", ""), "joint 'j': velocity: found 'fast', expected a number"),
    ],
)
def test_mistakes_of_a_file_are_named(text: str, message: str, tmp_path: pathlib.Path) -> None:
    file = tmp_path / "robot.xml"
    file.write_text(text)
    with pytest.raises(sk.SceneError) as error:
        sk.load_robot(file)
    assert message in str(error.value)
    assert str(file) in str(error.value)


def test_a_robot_is_added_completely_or_not_at_all() -> None:
    world = sk.World(threads=1)
    world.add_body(sk.Sphere(0.1), sk.Material(), position=(3, 0, 0), dynamics="rigid", name="arm/lower")
    for arguments in ({}, {"coordinates": {"arm": 1}, "name": "b"}, {"coordinates": {"right": 0.1}, "name": "b"}):
        with pytest.raises(sk.SceneError):
            world.add_robot(ARM, **arguments)  # type: ignore[arg-type]
        assert list(world.bodies) == ["arm/lower"]
        assert world.joints == []
    world.advance(0.01)


def test_the_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(ImportError, match="pip install mujoco"):
        sk.load_robot(ARM)
    with pytest.raises(sk.SceneError, match=r"nothing\.urdf: path: found No such file"):
        sk.load_robot("nothing.urdf")
