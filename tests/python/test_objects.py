"""Objects other than bodies and colliders: names, settings, copies, files, reset, busy worlds and removal."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from typing import Any

import pytest

import skerry as sk
from worlds import RUBBER, busy

CUBE = sk.Mesh.box((0.1, 0.1, 0.1), (1, 1, 1))


def object_world() -> sk.World:
    """A soft cube at the origin, a rigid block beside it, and a collider above."""
    world = sk.World(threads=1, gravity=(0, 0, 0))
    world.add_body(CUBE, RUBBER, dynamics="explicit", name="cube")
    world.add_body(CUBE, RUBBER, position=(0.3, 0, 0), dynamics="rigid", name="block")
    world.add_collider(sk.Sphere(0.05), position=(0, 0, 1), name="hook")
    return world


def spring(world: sk.World) -> sk.Spring:
    hook = sk.Anchor(collider=world.colliders["hook"], point=(0, 0, 1))
    return world.add_spring(sk.Anchor(body=world.bodies["cube"]), hook, stiffness=1)


def cable(world: sk.World) -> sk.Cable:
    first, last = sk.Anchor(body=world.bodies["cube"]), sk.Anchor(body=world.bodies["block"], point=(0.3, 0, 0))
    return world.add_cable([first, sk.Anchor(point=(0.15, 0, 0.2)), last], tension=1)


def cavity(world: sk.World) -> sk.Cavity:
    return world.add_cavity(world.bodies["cube"], pressure=10)


def pipe(world: sk.World) -> sk.Pipe:
    block = world.bodies["block"]
    return world.add_pipe(
        world.add_cavity(block, faces=block.surface[:1], gas=sk.Gas(), volume=1e-3), conductance=1e-9, pressure=100
    )


def tie(world: sk.World) -> sk.Tie:
    return world.add_tie(world.bodies["cube"], [0])


def load(world: sk.World) -> sk.Load:
    return world.add_force(world.bodies["cube"], [0], (0.1, 0, 0))


def fibres(world: sk.World) -> sk.FibreFamily:
    return world.add_fibres(world.bodies["cube"], (0, 0, 1), stiffness=1e3, tension=[(0, 10), (1, 20)])


def surface_set(world: sk.World) -> sk.SurfaceSet:
    return world.add_surface_set(world.bodies["cube"], nodes=[0], friction=0.1)


def joint(world: sk.World) -> sk.Joint:
    return world.add_joint("hinge", world.bodies["block"], point=(0.3, 0, 0))


def attachment(world: sk.World) -> sk.Attachment:
    return world.bodies["cube"].attach([0])


KINDS: dict[str, tuple[Callable[[sk.World], Any], str]] = {
    "springs": (spring, "spring of body 'cube' and collider 'hook'"),
    "cables": (cable, "cable of body 'cube', the world and body 'block'"),
    "cavities": (cavity, "cavity of body 'cube'"),
    "pipes": (pipe, "pipe from the cavity of body 'block'"),
    "ties": (tie, "tie of body 'cube'"),
    "loads": (load, "force on body 'cube'"),
    "fibres": (fibres, "fibres in body 'cube'"),
    "surface_sets": (surface_set, "surface set of body 'cube'"),
    "joints": (joint, "hinge joint of body 'block' and the world"),
    "attachments": (attachment, "attachment of body 'cube'"),
}


@pytest.mark.parametrize("kind", KINDS)
def test_an_object_names_its_bodies_in_texts_and_in_the_table_of_its_world(kind: str) -> None:
    add, label = KINDS[kind]
    world = object_world()
    item = add(world)
    assert getattr(world, kind) == [item]
    assert label in world._repr_html_().replace("&#x27;", "'")
    item.remove()
    assert repr(item) == f"<skerry.{type(item).__name__}: {label}, removed>"


@pytest.mark.parametrize("kind", KINDS)
def test_an_object_is_in_each_copy_of_its_world(kind: str, tmp_path: Any) -> None:
    world = object_world()
    item = KINDS[kind][0](world)
    world.save(tmp_path / "world.skerry")
    pickled = pickle.loads(pickle.dumps(item))
    assert pickled.alive and pickled.world is not world and repr(pickled) == repr(item)
    copies = [
        world.copy(),
        sk.World.from_bytes(world.to_bytes()),
        sk.World.load(tmp_path / "world.skerry"),
        pickled.world,
    ]
    world.advance(0.01)
    for other in copies:
        twin = item.in_copy(other)
        assert twin.alive and twin.world is other and twin != item and getattr(other, kind) == [twin]
        other.advance(0.01)
        assert other.state_hash == world.state_hash
        twin.remove()
        assert not twin.alive and item.alive
        with pytest.raises(sk.SceneError, match="expected a copy of its world"):
            item.in_copy(other)


@pytest.mark.parametrize("kind", KINDS)
def test_reset_to_a_copy_brings_back_its_objects_only(kind: str) -> None:
    add, _ = KINDS[kind]
    world = object_world()
    before = world.copy()
    item = add(world)
    after = world.copy()
    world.reset(before)
    assert not item.alive and getattr(world, kind) == []
    with pytest.raises(sk.SceneError, match="was removed"):
        world.remove(item)
    other = add(world)
    assert other.alive and not item.alive and other != item
    world.reset(after)
    assert item.alive and not other.alive and getattr(world, kind) == [item]
    world.advance(0.01)


@pytest.mark.parametrize("kind", KINDS)
def test_an_object_of_a_busy_world_is_refused_and_stays(kind: str) -> None:
    add, _ = KINDS[kind]
    world = object_world()
    item = add(world)
    state = world.state_hash
    with busy(world):
        for call in (
            lambda: add(world),
            lambda: getattr(world, kind),
            lambda: item.alive,
            lambda: world.remove(item),
            item.remove,
        ):
            with pytest.raises(sk.BusyError, match="in use by another thread"):
                call()
        assert "in use by another thread" in repr(item)
    assert item.alive and world.state_hash != state and getattr(world, kind) == [item]


@pytest.mark.parametrize("kind", KINDS)
def test_an_object_is_removed_by_its_world_and_with_its_body(kind: str) -> None:
    add, label = KINDS[kind]
    world = object_world()
    item = add(world)
    with pytest.raises(sk.SceneError, match="belongs to another world"):
        object_world().remove(item)
    world.remove(item)
    assert not item.alive and getattr(world, kind) == []
    with pytest.raises(sk.SceneError, match="was removed"):
        item.remove()
    item = add(world)
    world.bodies["block" if "'block'" in label else "cube"].remove()
    assert not item.alive and getattr(world, kind) == []
    world.advance(0.01)


PROBES: dict[str, Callable[[Any], sk.Probe]] = {
    "springs": sk.SpringProbe,
    "cables": sk.CableProbe,
    "cavities": sk.CavityProbe,
    "joints": sk.JointProbe,
    "attachments": sk.ReactionProbe,
}


@pytest.mark.parametrize("kind", PROBES)
def test_no_step_is_taken_while_a_recorder_has_a_removed_object(kind: str) -> None:
    world = object_world()
    item = KINDS[kind][0](world)
    with world.recorder({"probe": PROBES[kind](item)}) as recorder:
        world.advance(0.01)
        item.remove()
        with pytest.raises(sk.SceneError, match="recorder: probe 'probe': found an object that was removed"):
            world.advance(0.01)
        assert world.time == pytest.approx(0.01) and len(recorder) == 2


def test_nodes_may_be_given_by_a_truth_value_for_each() -> None:
    world = object_world()
    cube = world.bodies["cube"]
    mask = cube.positions[:, 2] > 0
    numbers = mask.nonzero()[0].tolist()
    assert world.add_tie(cube, mask).state.nodes.tolist() == numbers
    assert world.add_surface_set(cube, nodes=mask, friction=0.1).nodes.tolist() == numbers
    force = world.add_force(cube, mask, (1, 0, 0))
    same = world.add_force(cube, numbers, (1, 0, 0))
    assert force.state.force == same.state.force == pytest.approx((1, 0, 0))
    for add in (world.add_tie, lambda body, nodes: world.add_force(body, nodes, (1, 0, 0))):
        with pytest.raises(TypeError, match=r"nodes: found an array of the shape \(7,\), expected \(8,\)"):
            add(cube, mask[1:])


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "attachments"])
def test_an_object_is_found_by_its_name_also_in_a_copy(kind: str) -> None:
    world = object_world()
    item = KINDS[kind][0](world)
    assert getattr(world, kind)[item.name] == item
    item.name = "my own"
    for same in [world, world.copy(), pickle.loads(pickle.dumps(world))]:
        assert getattr(same, kind)["my own"].name == "my own"
        assert getattr(same, kind)[0] == getattr(same, kind)[:1][0]
    with pytest.raises(KeyError, match=r"no object has the name 'other'; the names are \['my own'\]"):
        getattr(world, kind)["other"]


def traction(world: sk.World) -> sk.Load:
    cube = world.bodies["cube"]
    return world.add_traction(cube, cube.surface[:2], (0, 0, 5), scale=[(0, 1), (1, 2)])


def drag(world: sk.World) -> sk.Load:
    return world.add_drag(2, wind=(1, 0, 0))


def acceleration(world: sk.World) -> sk.Load:
    return world.add_acceleration((1, 2, 3), body=world.bodies["block"])


def weight(world: sk.World) -> sk.Load:
    return world.add_gravity_scale(0.5)


def balloon(world: sk.World) -> sk.Cavity:
    cube = world.bodies["cube"]
    return world.add_cavity(cube, faces=cube.surface[:1], gas=sk.Gas(pressure=100, inflow=1e-6), volume=1e-3)


def plain(value: Any) -> Any:
    """A setting in a form that can be compared, without rounding errors."""
    if isinstance(value, sk.Anchor):
        return value.body, value.collider, tuple(round(x, 12) for x in value.point)
    if isinstance(value, list):
        return [plain(inner) for inner in value]
    if isinstance(value, sk.Gas):
        return round(value.pressure, 6), value.exponent, value.inflow
    return value.round(12).tolist() if hasattr(value, "tolist") else value


ADDED: list[tuple[Callable[[sk.World], Any], str]] = [
    (spring, "add_spring"),
    (cable, "add_cable"),
    (cavity, "add_cavity"),
    (balloon, "add_cavity"),
    (pipe, "add_pipe"),
    (tie, "add_tie"),
    (load, "add_force"),
    (traction, "add_traction"),
    (drag, "add_drag"),
    (acceleration, "add_acceleration"),
    (fibres, "add_fibres"),
]


@pytest.mark.parametrize(("make", "method"), ADDED)
def test_settings_are_arguments_that_add_an_equal_object(make: Callable[[sk.World], Any], method: str) -> None:
    world = object_world()
    item = make(world)
    twin = getattr(world, method)(**item.settings)
    assert twin != item
    assert {name: plain(value) for name, value in twin.settings.items()} == {
        name: plain(value) for name, value in item.settings.items()
    }


@pytest.mark.parametrize(("make", "method"), [*ADDED, (weight, "add_gravity_scale"), (joint, "add_joint")])
def test_an_object_is_named_when_it_is_added(make: Callable[[sk.World], Any], method: str) -> None:
    world = object_world()
    item = make(world)
    given = item.settings
    item.remove()
    named = getattr(world, method)(**given, name="mine")
    assert named.name == "mine"
    before = world.to_bytes()
    for name in ("", "two\nlines"):
        with pytest.raises(sk.SceneError, match="name: found '.*', expected a text of at least one character"):
            getattr(world, method)(**given, name=name)
        with pytest.raises(sk.SceneError, match="name: found '.*', expected a text of at least one character"):
            named.name = name
    assert world.to_bytes() == before
    assert world.add_surface_set(world.bodies["cube"], nodes=[0], name="sole").name == "sole"


def test_settings_are_those_that_were_given() -> None:
    world = object_world()
    assert spring(world).settings["stiffness"] == 1 and spring(world).settings["only"] == "both"
    assert cable(world).settings["tension"] == ((0, 1),) and cable(world).settings["length"] is None
    assert cavity(world).settings["pressure"] == ((0, 10),)
    assert balloon(world).settings["gas"].inflow == ((0, 1e-6),)
    assert pipe(world).settings["second"] is None and pipe(world).settings["pressure"] == ((0, 100),)
    assert tie(world).settings["to"] is None and tie(world).settings["nodes"].tolist() == [0]
    assert weight(world).settings == {"body": None, "scale": ((0, 0.5),)}
    assert traction(world).settings["scale"] == ((0, 1), (1, 2))
    assert drag(world).settings["wind"] == (1, 0, 0)
