"""Worlds: building, running, copies, files, reports."""

import copy
import dataclasses
import json
import pathlib
import pickle
import re
import warnings
from typing import Any

import numpy as np
import pytest

import skerry as sk
from worlds import RUBBER, ball_world

KEYS: list[dict[str, Any]] = [{"time": 0, "position": [0, 0, 0.13]}, {"time": 0.05, "position": [0, 0, 0.11]}]


def test_keywords_change_single_settings() -> None:
    settings = sk.Settings(gravity=(0, 0, -1), threads=1)
    assert sk.World(settings, tolerance=1e-6).settings == dataclasses.replace(
        settings, tolerance=1e-6, backend=sk.World(settings).settings.backend
    )


def test_an_unknown_setting_is_refused() -> None:
    with pytest.raises(TypeError, match="grvity"):
        sk.World(grvity=(0, 0, 0))  # type: ignore[call-arg]


def test_the_keywords_are_the_fields_of_the_records() -> None:
    from skerry._world import changes

    for record, keywords in [
        (sk.Settings, changes.SettingsChanges),
        (sk.Material, changes.MaterialChanges),
        (sk.Surface, changes.SurfaceChanges),
    ]:
        assert [field.name for field in dataclasses.fields(record)] == list(keywords.__annotations__)


def test_a_ball_falls_freely_until_it_touches() -> None:
    world, ball, _ = ball_world()
    start = ball.center_of_mass[2]
    report = world.advance(0.04)
    assert report.ok and report.status == "ok" and report.message == ""
    assert world.time == pytest.approx(0.04)
    # The first kick is half a step long: the error of the fall is below g t h.
    assert start - ball.center_of_mass[2] == pytest.approx(9.81 * 0.04**2 / 2, abs=9.81 * 0.04 * report.step_size)


def test_equal_records_become_one_material() -> None:
    world = sk.World(threads=1)
    for x in (0, 1):
        world.add_body(sk.Mesh.ball(0.05, 4), sk.Material(density=900), position=(x, 0, 0))
    assert len(world._materials) == 1


def test_names_are_unique_and_given_where_missing() -> None:
    world, ball, _ = ball_world()
    assert world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(1, 0, 0)).name == "body 1"
    assert world.add_collider(sk.Sphere(), position=(9, 9, 9)).name == "collider 1"
    with pytest.raises(sk.SceneError, match="body 'ball': name: found the name of another body") as caught:
        world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(2, 0, 0), name="ball")
    assert (caught.value.object, caught.value.field) == ("body 'ball'", "name")
    assert list(world.bodies) == ["ball", "body 1"]


def test_bodies_are_found_by_name_number_and_body() -> None:
    world, ball, floor = ball_world()
    other = world.add_body(sk.Sphere(radius=0.05), RUBBER, position=(1, 0, 0), name="other")
    assert world.bodies["ball"] == world.bodies[0] == world.bodies[-2] == world.bodies[ball] == ball
    assert list(world.bodies.values()) == [ball, other]
    assert list(world.bodies.items()) == [("ball", ball), ("other", other)]
    assert len(world.bodies) == 2 and "other" in world.bodies and other in world.bodies
    assert 1 in world.bodies and 2 not in world.bodies  # type: ignore[comparison-overlap]
    assert world.colliders["floor"] == floor and floor not in world.bodies
    with pytest.raises(KeyError, match="no bodies have the name 'bal'; the names are 'ball', 'other'"):
        world.bodies["bal"]
    with pytest.raises(KeyError, match="bodies 2: the world has 2"):
        world.bodies[2]


def test_bodies_that_share_a_name_are_found_by_number() -> None:
    world, ball, _ = ball_world()
    given = {"name": "ball", "position": (1.0, 0.0, 0.0)}
    settings = type("BodySettings", (), given)()
    world._core.add_rigid_body(sk.Sphere(radius=0.1), world.add_material()._handle, settings)
    with pytest.raises(KeyError, match="2 bodies have the name 'ball'; use their numbers"):
        world.bodies["ball"]
    first, second = world.bodies.values()
    assert first == ball and second == world.bodies[1] != ball


def test_a_world_built_in_python_has_the_bits_of_the_same_scene_from_a_file(tmp_path: pathlib.Path) -> None:
    scene = {
        "seconds": 0.1,
        "settings": {"threads": 2, "tolerance": 1e-5},
        "materials": {"rubber": {"young_modulus": 2e5, "friction": 0.3, "loss_factor": 0.1}},
        "bodies": [
            {
                "name": "ball",
                "mesh": {"ball": {"radius": 0.05, "resolution": 4}},
                "material": "rubber",
                "position": [0, 0, 0.05],
                "rotation": {"axis": [0, 0, 1], "degrees": 90},
            },
            {
                "name": "box",
                "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [2, 2, 2]}},
                "material": "rubber",
                "position": [0.11, 0, 0.051],
                "velocity": [-0.5, 0, 0],
                "angular_velocity": [0, 1, 0],
                "dynamics": "rigid",
            },
        ],
        "colliders": [
            {"name": "floor", "shape": {"plane": {"normal": [0, 0, 1]}}, "friction": 0.4},
            {"name": "finger", "shape": {"sphere": {"radius": 0.02}}, "motion": {"keys": KEYS}},
        ],
    }
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    loaded = sk.load_scene(tmp_path / "scene.json").world
    world = sk.World(threads=1, tolerance=1e-5)
    rubber = sk.Material(young_modulus=2e5, friction=0.3, loss_factor=0.1)
    ball = world.add_body(sk.Mesh.ball(0.05, 4), rubber, position=(0, 0, 0.05), rotation=(0, 0, np.pi / 2), name="ball")
    world.add_body(
        sk.Mesh.box((0.1, 0.1, 0.1), 2),
        rubber,
        position=(0.11, 0, 0.051),
        velocity=(-0.5, 0, 0),
        angular_velocity=(0, 1, 0),
        dynamics="rigid",
        name="box",
    )
    world.add_collider(sk.Plane(), friction=0.4, name="floor")
    keys = [sk.MotionKey(time=key["time"], position=key["position"]) for key in KEYS]
    world.add_collider(sk.Sphere(radius=0.02), motion=sk.Motion(keys=keys), name="finger")
    assert world.state_hash == loaded.state_hash
    for each in (world, loaded):
        each.advance(0.1)
    assert world.report().max_contacts > 3
    assert world.state_hash == loaded.state_hash
    assert np.array_equal(ball.positions, loaded.bodies["ball"].positions)


@pytest.mark.parametrize("copied", [sk.World.copy, copy.copy, copy.deepcopy, lambda w: pickle.loads(pickle.dumps(w))])
def test_a_copy_continues_with_the_same_bits(copied: Any) -> None:
    world, ball, _ = ball_world()
    world.advance(0.06)
    other = copied(world)
    assert other.state_hash == world.state_hash and other.time == world.time
    world.advance(0.05)
    other.advance(0.05)
    assert other.state_hash == world.state_hash
    assert np.array_equal(other.bodies[ball].positions, ball.positions)
    assert other.bodies[ball] != ball
    other.bodies[ball].velocities += 1.0
    assert other.state_hash != world.state_hash


def test_a_copy_may_have_another_number_of_threads() -> None:
    world, _, _ = ball_world()
    world.advance(0.06)
    other = world.copy(threads=2, backend="threads")
    assert (other.settings.threads, other.settings.backend) == (2, "threads")
    other.advance(0.05)
    world.advance(0.05)
    assert other.state_hash == world.state_hash


def test_a_body_is_copied_with_its_world() -> None:
    _, ball, _ = ball_world()
    for other in (copy.deepcopy(ball), pickle.loads(pickle.dumps(ball))):
        assert other.world is not ball.world and other.name == "ball"
        other.world.advance(0.01)
        assert ball.world.time == 0
    assert copy.copy(ball) == ball


def test_every_object_is_found_in_a_copy() -> None:
    world, ball, floor = ball_world()
    rod = world.add_body(sk.Sphere(radius=0.1), RUBBER, position=(1, 0, 1), name="rod")
    steel = world.add_material(density=8000)
    held = ball.attach([0])
    objects = [ball, rod, floor, held, world.add_joint("hinge", rod), steel]
    other = pickle.loads(pickle.dumps(world))
    for each in objects:
        twin = each.in_copy(other)
        assert type(twin) is type(each) and twin.world is other and twin != each and twin.alive
        pickled = pickle.loads(pickle.dumps(each))
        assert pickled.world is not world and pickled.alive and copy.copy(each) == each
        assert repr(twin) == repr(each) == repr(pickled)
    held.in_copy(other).set_velocity((1, 0, 0))
    steel.in_copy(other).change(density=7000)
    assert steel.settings.density == 8000
    rod.remove()
    with pytest.raises(sk.SceneError, match="body 'ball': found a world without it, expected a copy"):
        ball.in_copy(sk.World())
    late = other.copy()
    rod.in_copy(other).remove()
    with pytest.raises(sk.SceneError, match="body 'rod': found a world without it"):
        rod.in_copy(other)
    assert rod.in_copy(late).alive and not rod.alive


def test_a_saved_world_continues_with_the_same_bits(tmp_path: pathlib.Path) -> None:
    world, ball, _ = ball_world()
    world.advance(0.06)
    world.save(tmp_path / "a.skerry")
    other = sk.World.load(tmp_path / "a.skerry", threads=2)
    assert other.settings == dataclasses.replace(world.settings, threads=2)
    assert sk.World.load(tmp_path / "a.skerry", backend="serial").settings.backend == "serial"
    with pytest.raises(sk.SceneError, match="load: backend: found 'mpi', expected one of 'tbb'"):
        sk.World.load(tmp_path / "a.skerry", backend="mpi")  # type: ignore[arg-type]
    for each in (world, other):
        each.advance(0.05)
    assert other.state_hash == world.state_hash
    assert other.bodies[ball].name == "ball"


def test_loading_a_missing_file_names_the_file(tmp_path: pathlib.Path) -> None:
    with pytest.raises(sk.SceneError, match="missing.skerry") as caught:
        sk.World.load(tmp_path / "missing.skerry")
    assert caught.value.file.endswith("missing.skerry")


def test_a_run_ends_at_the_given_time_and_calls_each() -> None:
    world, _, _ = ball_world()
    times: list[float] = []
    world.run(0.05, dt=0.02, each=lambda world: times.append(world.time))
    assert times == pytest.approx([0.02, 0.04, 0.05])
    world.run(0.04, dt=0.02, each=lambda world: times.append(world.time))
    assert times[3:] == pytest.approx([0.07, 0.09])
    world.run(1.0, dt=0.01, each=lambda world: False)
    assert world.time == pytest.approx(0.1)


def test_a_run_of_a_negative_time_is_refused() -> None:
    world, _, _ = ball_world()
    with pytest.raises(sk.SceneError, match="seconds: found -1"):
        world.run(-1)
    with pytest.raises(sk.SceneError, match="dt: found 0"):
        world.run(1, dt=0)


def test_a_run_shows_its_progress(capsys: pytest.CaptureFixture[str]) -> None:
    world, _, _ = ball_world()
    world.run(0.13, dt=0.065, progress=True)
    lines = capsys.readouterr().err.rstrip("\n").split("\r")[1:]
    assert [line.rstrip() for line in lines] == ["0.065 s, 50 %", "0.13 s, 100 %"]
    assert len(lines[0]) == len(lines[1]) >= 20  # a shorter line covers the line before it


def test_a_report_has_all_values_of_the_engine() -> None:
    world, ball, _ = ball_world()
    world.advance(0.06)
    values = world._core.report()
    report = world.report()
    assert set(values) == {field.name for field in dataclasses.fields(report)}
    assert report.steps == sum(limit.steps for limit in report.step_limits) > 0
    assert report.bodies == report.colliders == 1 and report.nodes == ball.node_count
    assert report.energy == world.energy and report.energy.kinetic > 0
    assert report.stages[0].runs == report.steps
    assert report.distrust == ""
    (choice,) = report.dynamics_choices
    assert choice.body == ball and choice.dynamics == ball.dynamics and choice.estimate == ball.dynamics_choice
    with pytest.raises(dataclasses.FrozenInstanceError):
        report.time = 0.0  # type: ignore[misc]


def test_a_report_of_a_call_has_all_values_of_the_engine() -> None:
    world, _, _ = ball_world()
    values = world._core.advance(0.06, None, None, None, 1)
    report = world.copy().try_advance(0.01)
    assert set(values) == {field.name for field in dataclasses.fields(report)}
    assert (values["status"], values["body"], values["node"]) == ("ok", None, None) and values["steps"] > 0
    assert report == dataclasses.replace(report) and report != dataclasses.replace(report, steps=0)
    assert pickle.loads(pickle.dumps(report)) == report
    with pytest.raises(dataclasses.FrozenInstanceError):
        report.steps = 0  # type: ignore[misc]


def test_a_report_lists_overlaps_at_the_start() -> None:
    world, ball, floor = ball_world()
    low = world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(1, 0, 0.045), name="low")
    world.settle_start()
    (overlap,) = world.report().start_overlaps
    assert (overlap.first, overlap.second, overlap.collider, overlap.resolved) == (low, None, floor, True)
    assert "low" in overlap.message
    (move,) = world.report().start_moves
    assert move.body == low and move.translation[2] > 0.004
    low.remove()
    assert not world.report().start_overlaps or not low.alive


def test_reports_of_removed_bodies_keep_their_names() -> None:
    world, ball, _ = ball_world()
    world.advance(0.01)
    ball.remove()
    (limit,) = world.report().step_limits
    assert limit.body == ball and limit.body_name == "ball" and "removed" in repr(limit)


def test_the_text_of_a_world_counts_its_objects() -> None:
    world, ball, floor = ball_world()
    assert repr(world) == "<skerry.World at 0 s, 1 bodies, 1 colliders, 0 joints>"
    assert repr(floor) == "<skerry.Collider 'floor' Plane>"
    assert repr(world.bodies) == "<skerry bodies: ball>"
    world.add_collider(sk.Sphere(), position=(9, 9, 9), name="<b>")
    page = world._repr_html_()
    assert "<td>ball</td><td>explicit</td>" in page and "&lt;b&gt;" in page and "<td><b>" not in page


def test_the_table_of_a_large_world_ends_early() -> None:
    world = sk.World(threads=1)
    for number in range(60):
        world.add_collider(sk.Sphere(radius=0.1), position=(number, 0, 0))
    page = world._repr_html_()
    assert "collider 49" in page and "collider 50" not in page and "and 10 more" in page


def test_a_trace_and_the_graph_of_the_step_can_be_written(tmp_path: pathlib.Path) -> None:
    world, _, _ = ball_world()
    with world.trace(tmp_path / "trace.json"):
        report = world.advance(0.01)
    events = json.loads((tmp_path / "trace.json").read_text())["traceEvents"]
    assert len([event for event in events if event["name"] == "dynamics/move_colliders"]) == report.steps
    assert world.step_graph().startswith("digraph")


def test_a_watching_function_sees_every_step() -> None:
    world, ball, _ = ball_world()
    seen: list[tuple[int, float]] = []
    world.watch_steps(lambda report: seen.append((report.steps, float(ball.velocities[0, 2]))))
    report = world.advance(0.02)
    assert [steps for steps, _ in seen] == list(range(1, report.steps + 1))
    assert [speed for _, speed in seen] == sorted((speed for _, speed in seen), reverse=True)
    world.watch_steps(None)
    world.advance(0.02)
    assert len(seen) == report.steps


class StopError(Exception):
    pass


def stop(report: sk.StepReport) -> None:
    if report.steps == 3:
        raise StopError("at step 3")


@pytest.mark.parametrize("way", ["watch", "check"])
def test_an_exception_of_a_callback_ends_the_call_between_two_steps(way: str) -> None:
    world, _, _ = ball_world()
    twin = world.copy()
    if way == "watch":
        world.watch_steps(stop)
    with pytest.raises(StopError, match="at step 3"):
        world.advance(0.05, check=stop if way == "check" else None)
    assert world.report().steps == 3
    twin.advance(0.05, check=lambda report: report.steps < 3)
    assert world.state_hash == twin.state_hash
    world.watch_steps(None)
    assert world.advance(0.01).ok


def test_a_check_that_returns_false_stops_the_call() -> None:
    world, _, _ = ball_world()
    report = world.advance(0.05, check=lambda report: report.steps < 5)
    assert (report.status, report.ok, report.steps) == ("stopped", False, 5)
    assert world.time == pytest.approx(5 * report.step_size)
    assert world.advance(0.01, check=lambda report: None).ok


CHANGES = [
    lambda world, ball, floor: world.advance(0.01),
    lambda world, ball, floor: world.watch_steps(None),
    lambda world, ball, floor: world.add_collider(sk.Sphere(), position=(9, 9, 9)),
    lambda world, ball, floor: world.remove(ball),
    lambda world, ball, floor: world.reset(),
    lambda world, ball, floor: world.set_gravity((0, 0, 0)),
    lambda world, ball, floor: world.copy(),
    lambda world, ball, floor: world.to_bytes(),
    lambda world, ball, floor: setattr(ball, "positions", ball.positions),
    lambda world, ball, floor: ball.attach([0]),
    lambda world, ball, floor: floor.set_velocity((1, 0, 0)),
]


@pytest.mark.parametrize("change", CHANGES)
def test_a_callback_cannot_change_the_world(change: Any) -> None:
    world, ball, floor = ball_world()
    twin = world.copy()
    refused = []

    def look(report: sk.StepReport) -> None:
        with pytest.raises(sk.SceneError, match=r"a call during advance\(\)"):
            change(world, ball, floor)
        refused.append(report.steps)

    world.watch_steps(look)
    world.advance(0.005)
    assert refused
    twin.advance(0.005)
    assert world.state_hash == twin.state_hash


def test_doubts_are_told_once_for_each_cause() -> None:
    world, _, _ = ball_world(step_size=1e-2)
    with pytest.warns(sk.Doubt, match="ball") as caught:
        world.advance(0.02)
    assert len(caught) == 1 and caught[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        world.advance(0.02)


def test_the_start_again_is_a_reset_to_a_copy() -> None:
    world, ball, _ = ball_world()
    start = world.copy()
    world.advance(0.08)
    steel = world.add_material(density=8000)
    later = world.add_body(sk.Sphere(radius=0.05), steel, position=(1, 0, 0))
    world.reset(start)
    assert world.state_hash == start.state_hash and world.time == 0
    assert ball.alive and not later.alive and not steel.alive
    assert repr(steel) == "<skerry.MaterialHandle: material, removed>"
    with pytest.raises(sk.SceneError, match="^material was removed$"):
        steel.change(density=1)
    assert len(ball.surface) == len(start.bodies[ball].surface)
    assert world.add_body(sk.Sphere(radius=0.05), RUBBER, position=(1, 0, 0)) != later


def test_materials_and_meshes_that_a_reset_removes_are_forgotten() -> None:
    world, ball, _ = ball_world()
    start = world.copy()
    steel = sk.Material(density=8000)
    for _ in range(2):
        later = world.add_body(sk.Mesh.ball(0.05, 4), steel, position=(1, 0, 1), dynamics="rigid")
        assert len(later.surface) == len(ball.surface) and len(world._mesh_arrays) == 2
        world.reset(start)
        assert not world._mesh_arrays
    assert len(ball.surface) and len(world._mesh_arrays) == 1
    ball.remove()
    assert not world._mesh_arrays


def test_a_reset_of_the_bodies_keeps_the_time() -> None:
    world, ball, _ = ball_world()
    first = ball.positions
    world.advance(0.08)
    world.reset()
    assert world.time == pytest.approx(0.08)
    assert np.allclose(ball.positions, first, atol=1e-12) and not ball.velocities.any()


def test_a_reset_to_another_world_is_refused() -> None:
    world, _, _ = ball_world()
    with pytest.raises(sk.SceneError):
        world.reset(ball_world()[0])


@pytest.mark.parametrize("stop", [False, np.bool_(False)])
def test_a_truth_value_of_numpy_ends_a_run(stop: object) -> None:
    world, _, _ = ball_world()
    world.run(1, dt=0.01, each=lambda world: stop)
    assert world.time == pytest.approx(0.01)
    assert world.advance(1, check=lambda report: stop).status == "stopped"
    world.run(0.02, dt=0.01, each=lambda world: None)
    assert world.time == pytest.approx(0.03)


def test_reports_have_short_texts() -> None:
    world, ball, _ = ball_world()
    report = world.advance(0.06)
    assert re.fullmatch(r"<skerry.StepReport ok, \d+ steps, \d+ contacts, worst error \S+>", repr(report))
    text = repr(world.report())
    assert re.fullmatch(r"<skerry.WorldReport at 0.06 s, \d+ steps, 1 bodies, worst error \S+>", text)
    apart = ball_world()[0]
    assert "no contact" not in repr(apart.report())  # before the first step
    apart.advance(0.001)
    assert repr(apart.report()).endswith(", no contact in the whole run>")
    velocities = ball.velocities
    velocities[0] = (1e100, 0, 0)
    ball.velocities = velocities
    report = world.try_advance(0.01)
    assert report.message and report.message in repr(report)


def test_a_trace_that_cannot_be_written_is_refused_at_the_start(tmp_path: pathlib.Path) -> None:
    world, _, _ = ball_world()
    with pytest.raises(FileNotFoundError), world.trace(tmp_path / "none" / "trace.json"):
        world.advance(0.01)
    assert world.time == 0
