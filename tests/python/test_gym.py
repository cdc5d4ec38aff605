"""The Gymnasium environment of the examples."""

import pathlib
import sys

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples/python"))


def test_the_environment_passes_gymnasiums_own_check() -> None:
    from gymnasium.utils.env_checker import check_env

    from gym_push import PushEnv

    check_env(PushEnv(), skip_render_check=True)


def test_an_episode_after_a_reset_has_the_bits_of_the_first() -> None:
    from gym_push import PushEnv, push_straight

    def episode(env: PushEnv) -> list[bytes]:
        observation, _ = env.reset(seed=3)
        seen = [observation.tobytes()]
        for _ in range(30):
            observation, *_ = env.step(push_straight(observation))
            seen.append(observation.tobytes())
        return seen

    env = PushEnv()
    first = episode(env)
    assert np.isfinite(np.frombuffer(first[-1])).all()
    assert episode(env) == first
    assert episode(PushEnv()) == first
