"""A finger pushes a soft ball at 16 different speeds, on all cores at once."""

import numpy as np

import skerry as sk

world = sk.World()
rubber = sk.Material(young_modulus=5e4, density=500, friction=0.6)
ball = world.add_body(sk.Mesh.ball(0.05, 6), rubber, position=(0, 0, 0.051), name="ball")
finger = world.add_collider(sk.Box((0.02, 0.1, 0.1)), position=(-0.065, 0, 0.055), name="finger")
world.add_collider(sk.Plane())

dt, steps = 0.01, 100
speeds = np.linspace(0.05, 0.4, 16)  # [m/s]
poses = np.zeros((len(speeds), steps, 6))  # position and rotation vector at the end of each interval
poses[:, :, :3] = (-0.065, 0, 0.055)
poses[:, :, 0] += speeds[:, None] * dt * np.arange(1, steps + 1)

out = sk.rollout(world, {finger: poses}, dt=dt, record={"ball": sk.BodyProbe(ball), "finger": sk.ForceProbe(finger)})
moved = out["ball.position"][:, -1, 0]  # how far the ball has come in each world [m]
for speed, distance, force in zip(speeds, moved, -out["finger.force"][:, :, 0].min(axis=1), strict=True):
    print(f"finger at {speed:.3f} m/s: the ball moved by {100 * distance:5.2f} cm, largest mean force {force:.2f} N")

assert out["ok"].all()
assert np.all(moved > speeds * steps * dt - 0.01)  # the ball is before the finger
