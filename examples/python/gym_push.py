"""A Gymnasium environment: a soft finger pushes a puck over a floor to a target.

    pip install .[gym]  # in the source folder
    python gym_push.py

The hand that holds the finger is the only thing that an agent moves. Its actions are two speeds of the hand. Resets
restore a copy of the first state, which takes less time than to build the world anew, and the same seed and actions
give the same bits."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

import skerry as sk

Floats = NDArray[np.float64]


class PushEnv(gymnasium.Env[Floats, Floats]):
    """Observation: horizontal positions of the hand, the fingertip, the puck and the target, shape (8,) [m]. Action:
    velocity of the hand in x and y, shape (2,) [m/s]. Reward: minus the distance between puck and target [m]."""

    metadata: dict[str, Any] = {"render_modes": []}
    step_seconds = 1 / 30
    reach = 0.3  # largest coordinate of the hand [m]
    near = 0.02  # distance at which the target counts as reached [m]
    step_limit = 150  # number of steps after which an episode is cut off

    def __init__(self) -> None:
        self.observation_space = gymnasium.spaces.Box(-1.0, 1.0, (8,), np.float64)
        self.action_space = gymnasium.spaces.Box(-0.2, 0.2, (2,), np.float64)
        self._world = sk.World(threads=1)  # run many environments, one on each core
        self._world.add_collider(sk.Plane(), name="floor")
        silicone = sk.Material(young_modulus=5e5, poisson_ratio=0.45, density=1100, friction=0.4)
        finger = sk.Mesh.box((0.03, 0.03, 0.1), (2, 2, 6))
        self._finger = self._world.add_body(finger, silicone, position=(0, 0, 0.06), name="finger")
        self._hand = self._finger.attach(self._finger.select(above=0.105))
        self._tip = self._finger.select(below=0.02)
        puck = sk.Cylinder(radius=0.025, height=0.03)
        self._puck = self._world.add_body(puck, silicone, position=(0.1, 0, 0.016), name="puck")
        self._start = self._world.copy()
        self._target = np.zeros(2)
        self._steps = 0

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Floats, dict[str, Any]]:
        """Places the puck around the finger, and the target behind the puck."""
        super().reset(seed=seed)
        self._world.reset(self._start)
        angle = self.np_random.uniform(-np.pi, np.pi)
        self._puck.pose = sk.Pose(position=(0.06 * np.cos(angle), 0.06 * np.sin(angle), 0.016))
        angle += self.np_random.uniform(-0.2, 0.2)
        self._target = 0.2 * np.array([np.cos(angle), np.sin(angle)])
        self._steps = 0
        return self._observe(), {}

    def step(self, action: Floats) -> tuple[Floats, float, bool, bool, dict[str, Any]]:
        """Moves the hand for a thirtieth of a second."""
        here = np.array(self._hand.pose.position[:2])
        there = np.clip(here + np.clip(action, -0.2, 0.2) * self.step_seconds, -self.reach, self.reach)
        self._hand.set_velocity((*(there - here) / self.step_seconds, 0.0))
        self._world.advance(self.step_seconds)
        self._steps += 1
        distance = float(np.linalg.norm(self._puck.center_of_mass[:2] - self._target))
        return self._observe(), -distance, distance < self.near, self._steps >= self.step_limit, {}

    def _observe(self) -> Floats:
        tip = self._finger.positions[self._tip].mean(axis=0)
        return np.concatenate([self._hand.pose.position[:2], tip[:2], self._puck.center_of_mass[:2], self._target])


def push_straight(observation: Floats) -> Floats:
    """A policy: get behind the puck as seen from the target, and push the faster the better the fingertip is there."""
    _, tip, puck, target = observation.reshape(4, 2)
    direction = (target - puck) / np.linalg.norm(target - puck)
    aside = (puck - tip) - (puck - tip) @ direction * direction
    speed = 0.1 * max(0.1, 1 - float(np.linalg.norm(aside)) / 0.01)
    return np.clip(8 * aside + speed * direction, -0.2, 0.2)


def main() -> None:
    """Plays three episodes. Each of them must reach the target."""
    env = PushEnv()
    for seed in range(3):
        observation, _ = env.reset(seed=seed)
        reached = cut_off = False
        total, steps = 0.0, 0
        while not (reached or cut_off):
            observation, reward, reached, cut_off, _ = env.step(push_straight(observation))
            total, steps = total + reward, steps + 1
        print(f"episode {seed}: {'reached' if reached else 'missed'} the target, {steps} steps, return {total:.2f}")
        assert reached


if __name__ == "__main__":
    main()
