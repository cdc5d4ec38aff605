"""Two fingers grip a soft ball and lift it. Their positions are set every millisecond, and the force is measured."""

import numpy as np

import skerry as sk

world = sk.World()
rubber = sk.Material(young_modulus=5e4, density=500, friction=0.8, damping=20)
ball = world.add_body(sk.Mesh.ball(0.05, 6), rubber, position=(0, 0, 0.052), name="ball")
world.add_collider(sk.Plane())
reach, half = 0.07, 0.01  # distance of the centres of finger and ball; half a finger's thickness [m]
fingers = [
    world.add_collider(sk.Box(size=(2 * half, 0.04, 0.04)), position=(side * reach, 0, 0.05)) for side in (-1, 1)
]
world.measure_forces()

dt, wanted = 1e-3, 4.0  # [s], [N]
mean, lift = 0.0, 0.0  # mean force [N], height [m]
for ms in range(2000):
    # Close until the force reaches `wanted`. Then move up at 0.1 m/s for one second and stay there.
    reach -= dt * float(np.clip(0.02 * (wanted - mean), -0.05, 0.05))
    lift += 0.1 * dt if 700 < ms < 1700 else 0.0
    for side, finger in zip((-1, 1), fingers, strict=True):
        finger.move_to(sk.Pose(position=(side * reach, 0, 0.05 + lift)), dt)
    world.advance(dt)
    mean += 0.05 * (world.forces.on(fingers[1], by=ball).impulse[0] / dt - mean)
    if ms % 200 == 199:
        print(
            f"{ms + 1:4} ms: fingers press with {mean:5.2f} N, {2000 * (reach - half):4.1f} mm apart; "
            f"the ball is at z = {1000 * ball.center_of_mass[2]:5.1f} mm"
        )

assert ball.center_of_mass[2] > 0.14
assert abs(mean - wanted) < 0.5
