"""Scenes from files and mappings, and their runs."""

import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import skerry as sk
from scenes import SCENE, changed


def test_a_mapping_and_its_file_give_the_same_world(tmp_path: Path) -> None:
    (tmp_path / "drop.json").write_text(json.dumps(SCENE))
    scene, of_file = sk.load_scene(SCENE), sk.load_scene(tmp_path / "drop.json")
    assert scene.world.state_hash == of_file.world.state_hash
    for one in (scene, of_file):
        assert (one.name, one.description) == ("drop", "A ball falls on a floor.")
        assert (one.seconds, one.frame_step, one.probe_step) == (0.1, 0.02, 0.01)
        assert one.materials == ("rubber",)
        assert list(one.world.bodies) == ["ball"] and list(one.world.colliders) == ["floor"]
        assert one.world.settings.threads == 1
        ball, floor = one.world.bodies["ball"], one.world.colliders["floor"]
        assert isinstance(one.probes["ball"], sk.BodyProbe) and one.probes["ball"].body == ball
        assert one.probes["ball"].origin == pytest.approx((0, 0, 0.06))
        assert one.probes["push"] == sk.ForceProbe(ball, floor)
    assert repr(scene) == "<skerry.Scene 'drop', 1 bodies, 0.1 s>"


def test_overrides_replace_values_of_a_scene() -> None:
    scene = sk.load_scene(SCENE, overrides={"bodies[0].position": np.array([0, 1, 0.5]), "name": "high"}, threads=2)
    assert scene.name == "high" and scene.world.settings.threads == 2
    assert scene.world.bodies["ball"].center_of_mass == pytest.approx([0, 1, 0.5], abs=1e-6)
    # A text that looks like a number stays a text.
    assert sk.load_scene(SCENE, overrides={"name": "7"}).name == "7"


def test_a_slider_changes_a_value_while_the_scene_runs() -> None:
    lift = {"name": "lift", "collider": "floor", "along": [0, 0, 2], "low": -0.5, "high": 0.5, "value": -0.25}
    scene = sk.load_scene(changed(sliders=[lift]))
    assert list(scene.sliders) == ["lift"]
    slider = scene.sliders["lift"]
    assert (slider.name, slider.unit, slider.low, slider.high, slider.fastest) == ("lift", "m", -0.5, 0.5, 1)
    assert slider.value == -0.25
    slider.set(-0.21)
    scene.world.advance(0.02)
    assert slider.value == pytest.approx(-0.23)
    scene.world.advance(0.04)
    assert slider.value == -0.21
    assert scene.world.colliders["floor"].pose.position == pytest.approx([0, 0, -0.21])
    with pytest.raises(sk.SceneError, match="slider 'lift': value: found 0.6, expected a value from -0.5 to 0.5 m"):
        slider.set(0.6)
    with pytest.raises(TypeError, match="value"):
        slider.set("high")  # type: ignore[arg-type]
    scene.world.colliders["floor"].remove()
    with pytest.raises(sk.SceneError, match="removed"):
        slider.set(0)


def test_a_wrong_scene_is_refused_with_the_place() -> None:
    with pytest.raises(sk.SceneError, match=r"bodies\[0\]") as caught:
        sk.load_scene(SCENE, overrides={"bodies[0].position": [0, 0]})
    assert caught.value.expected
    with pytest.raises(sk.SceneError, match="gravty"):
        sk.load_scene(changed(settings={"gravty": [0, 0, 0]}))
    with pytest.raises(sk.SceneError, match=r"none\.json"):
        sk.load_scene("none.json")
    with pytest.raises(TypeError, match="^scene: seconds: found <object object .*, expected a value of JSON"):
        sk.load_scene(changed(seconds=object()))


def test_mesh_files_of_a_mapping_are_found_in_the_folder(tmp_path: Path) -> None:
    sk.Mesh.ball(0.05, 4).write(tmp_path / "ball.msh")
    bodies = [{**SCENE["bodies"][0], "mesh": {"file": "ball.msh"}}]
    scene = sk.load_scene(changed(bodies=bodies), folder=tmp_path)
    assert scene.world.bodies["ball"].node_count == 55
    with pytest.raises(sk.SceneError, match=r"ball\.msh"):
        sk.load_scene(changed(bodies=bodies))
    (tmp_path / "drop.json").write_text(json.dumps(SCENE))
    with pytest.raises(TypeError, match="folder"):
        sk.load_scene(tmp_path / "drop.json", folder=tmp_path)


def test_a_run_records_the_probes_and_writes_its_outputs(tmp_path: Path) -> None:
    scene = sk.load_scene(SCENE)
    recorder = scene.run(csv=tmp_path / "a.csv", page=tmp_path / "a.html", vtk=tmp_path / "frames")
    assert scene.world.time == pytest.approx(0.1)
    table = recorder.table()
    np.testing.assert_allclose(table["time"], np.arange(11) * 0.01, atol=1e-12)
    assert table["ball.position_z"][3] == pytest.approx(0.06 - 9.81 / 2 * 0.03**2, rel=1e-2)
    assert len((tmp_path / "a.csv").read_text().splitlines()) == 12
    assert (tmp_path / "a.html").stat().st_size > 100_000
    frames = ElementTree.parse(tmp_path / "frames" / "drop.pvd").getroot().iter("DataSet")
    assert len({frame.get("timestep") for frame in frames}) == 6


def test_a_run_makes_the_calls_that_the_scene_asks_for() -> None:
    scene, twin = sk.load_scene(SCENE), sk.load_scene(SCENE).world
    scene.run()
    for _ in range(10):
        twin.advance(0.02 / 2)
    assert scene.world.state_hash == twin.state_hash
    plain = sk.load_scene(changed(probes=[]))
    plain.run(0.05)
    twin = sk.load_scene(SCENE).world
    for duration in (0.02, 0.02, 0.05 - 2 * 0.02):
        twin.advance(duration)
    assert plain.world.state_hash == twin.state_hash


def test_the_outputs_of_a_run_that_fails_end_there(tmp_path: Path) -> None:
    scene = sk.load_scene(SCENE)

    def look(report: sk.StepReport) -> None:
        if scene.world.time > 0.055:
            raise ZeroDivisionError

    scene.world.watch_steps(look)
    with pytest.raises(ZeroDivisionError):
        scene.run(csv=tmp_path / "a.csv", page=tmp_path / "a.html", vtk=tmp_path / "frames")
    assert len((tmp_path / "a.csv").read_text().splitlines()) == 7
    assert (tmp_path / "a.html").stat().st_size > 100_000
    assert (tmp_path / "frames" / "drop.pvd").is_file()
    scene.world.watch_steps(None)
    scene.world.advance(0.01)  # no output is left to write


def test_a_run_can_be_continued_and_ends_where_it_is_told() -> None:
    whole, parts = sk.load_scene(SCENE), sk.load_scene(SCENE)
    whole.run()
    parts.run(until=0.04)
    assert parts.world.time == pytest.approx(0.04)
    parts.run()
    assert parts.world.state_hash == whole.world.state_hash
    parts.run(0.05)  # in the past
    assert parts.world.time == pytest.approx(0.1)
    with pytest.raises(ValueError, match="until: found -1"):
        parts.run(-1)


@pytest.mark.parametrize(("frame_step", "probe_step", "rows"), [(0.02, 0.05, 3), (0.03, 0.02, 6), (0.015, 0.1, 2)])
def test_rows_have_their_times_whatever_the_frames_are(frame_step: float, probe_step: float, rows: int) -> None:
    scene = sk.load_scene(changed(frame_step=frame_step, probe_step=probe_step))
    time = scene.run().table()["time"]
    np.testing.assert_allclose(time, np.arange(rows) * probe_step, atol=1e-9)
    assert scene.world.time == pytest.approx(0.1)


def test_all_kinds_of_probes_of_a_scene_can_be_recorded_again() -> None:
    probes = [
        *SCENE["probes"],
        {"name": "tip", "quantity": "motion", "body": "ball", "point": [0, 0, 0.04]},
        {"name": "energy", "quantity": "energy"},
        {"name": "stress", "quantity": "stress", "body": "ball"},
        {"name": "volume", "quantity": "volume", "body": "ball"},
        {"name": "floor", "quantity": "force", "collider": "floor"},
        {"name": "clamp", "quantity": "reaction", "body": "bar", "pin": 0},
        {"name": "axle", "quantity": "joint", "joint": "hinge"},
    ]
    box = {"mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [1, 1, 1]}}, "material": "rubber"}
    bodies = [
        *SCENE["bodies"],
        {**box, "name": "bar", "position": [1, 0, 1], "pin": [{"box": {"lower": [-1, -1, 0], "upper": [1, 1, 1]}}]},
        {**box, "name": "wheel", "position": [2, 0, 1], "dynamics": "rigid"},
    ]
    joints = [{"name": "hinge", "kind": "hinge", "first": "wheel", "point": [2, 0, 1]}]
    scene = sk.load_scene(changed(probes=probes, bodies=bodies, joints=joints))
    kinds = [
        sk.BodyProbe,
        sk.ForceProbe,
        sk.PointProbe,
        sk.EnergyProbe,
        sk.StressProbe,
        sk.VolumeProbe,
        sk.ForceProbe,
        sk.ReactionProbe,
        sk.JointProbe,
    ]
    assert [type(probe) for probe in scene.probes.values()] == kinds
    with scene.world.recorder(scene.probes) as recorder:
        scene.world.run(0.02, dt=0.01)
    assert {name.split(".")[0] for name in recorder.units} == {"time", *(probe["name"] for probe in probes)}


def test_the_nodes_of_contact_probes_are_those_in_their_box() -> None:
    box = {"name": "foot", "body": "ball", "box": {"lower": [-1, -1, -1], "upper": [1, 1, -0.04]}}
    [probe] = sk.load_scene(changed(probes=[box])).contact_probes
    ball = probe.body
    assert probe.name == "foot" and probe.nodes.tolist() == ball.select(below=0.02).tolist()


def test_the_schema_names_the_keys_of_a_scene() -> None:
    assert {"bodies", "colliders", "materials", "settings"} <= set(sk.scene_schema()["properties"])


def test_a_value_that_is_no_number_is_named_by_its_place() -> None:
    bodies = [{**SCENE["bodies"][0], "position": (0, 0, np.nan)}]
    with pytest.raises(sk.SceneError, match=r"^scene: bodies\[0\]\.position\[2\]: found nan") as caught:
        sk.load_scene(changed(bodies=bodies))
    assert caught.value.field == "bodies[0].position[2]"
    with pytest.raises(sk.SceneError, match=r"^scene: materials\.rubber\.friction: found inf"):
        sk.load_scene(SCENE, overrides={"materials.rubber.friction": np.float32(np.inf)})
    with pytest.raises(TypeError, match=r"^scene: bodies\[0\]: found \{1\}, expected a value of JSON"):
        sk.load_scene(changed(bodies=[{1}]))
    with pytest.raises(TypeError, match=r"^scene: found the key 1 in bodies\[0\], expected a text"):
        sk.load_scene(changed(bodies=[{1: 2}]))


@pytest.mark.parametrize("scene", [json.dumps(SCENE), 3, b"scene.json"])
def test_something_else_than_a_scene_is_refused(scene: Any) -> None:
    with pytest.raises(TypeError, match="^scene: found .*, expected a path of a JSON file or a mapping"):
        sk.load_scene(scene)


def test_a_wrong_argument_of_load_scene_is_named() -> None:
    with pytest.raises(TypeError, match="^threads: found 'a', expected a whole number"):
        sk.load_scene(SCENE, threads="a")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"^overrides: found \[1\], expected a mapping"):
        sk.load_scene(SCENE, overrides=[1])  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="^Scene.run: until: found 'a', expected a number"):
        sk.load_scene(SCENE).run("a")  # type: ignore[arg-type]


def test_a_place_in_an_unknown_material_is_refused() -> None:
    with pytest.raises(sk.SceneError, match='the unknown material "rubbr", expected .* materials "rubber"'):
        sk.load_scene(SCENE, overrides={"materials.rubbr.friction": 0.1})


def test_notes_of_the_files_of_a_scene_are_warnings(tmp_path: Path) -> None:
    lines = ["mtllib none.mtl", "v 0 0 0", "v 1 0 0", "v 0 1 0", "v 0 0 1", "f 1 3 2", "f 1 2 4", "f 2 3 4", "f 1 4 3"]
    (tmp_path / "shown.obj").write_text("\n".join(lines) + "\n")
    body = {"mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}}, "material": "m", "visual": {"file": "shown.obj"}}
    with pytest.warns(sk.Doubt, match="none.mtl"):
        sk.load_scene({"materials": {"m": {}}, "bodies": [body]}, folder=tmp_path)
