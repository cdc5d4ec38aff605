"""Classes of a program that are derived from World."""

import copy
import pathlib
import pickle

import pytest

import skerry as sk


class Arena(sk.World):
    """A world of a program."""

    def __init__(self, size: float) -> None:
        super().__init__(threads=1)
        self.size = size


class Unfinished(sk.World):
    """A world that forgets a call."""

    def __init__(self) -> None:
        pass


def test_copies_have_the_class_of_their_world(tmp_path: pathlib.Path) -> None:
    arena = Arena(3)
    arena.advance(0.1)
    arena.save(tmp_path / "world")
    copies = [arena.copy(), copy.copy(arena), copy.deepcopy(arena), pickle.loads(pickle.dumps(arena))]
    copies += [Arena.from_bytes(arena.to_bytes()), Arena.load(tmp_path / "world")]
    for twin in copies:
        assert type(twin) is Arena and twin.state_hash == arena.state_hash
        assert not hasattr(twin, "size")
    assert type(sk.World.from_bytes(bytearray(arena.to_bytes()))) is sk.World
    with pytest.raises(AttributeError, match=r"Unfinished: __init__\(\) did not call super"):
        Unfinished()
