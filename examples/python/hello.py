"""A rubber ball falls onto the floor: the whole interface in ten lines."""

import skerry as sk

world = sk.World()  # settings have defaults that work
rubber = sk.Material(young_modulus=1e5, poisson_ratio=0.4, density=1000, friction=0.5)
ball = world.add_body(sk.Mesh.ball(0.1, 8), rubber, position=(0, 0, 1))
world.add_collider(sk.Plane())

lowest, highest = 1.0, 0.0  # heights of any node [m]
while world.time < 2:
    world.advance(1 / 60)  # takes as many stable steps as needed
    lowest = min(lowest, float(ball.positions[:, 2].min()))
    highest = max(highest, float(ball.positions[:, 2].max()))

report = world.report()
print(
    f"After {world.time:.3f} s and {report.steps:,} steps the ball's centre is {ball.center_of_mass[2]:.4f} m above "
    f"the floor; it touched the floor with up to {report.max_contacts} nodes."
)

# The ball reached the floor, did not sink into it, and did not jump higher than it was dropped from.
assert -0.001 < lowest < 0.01
assert highest < 1.1
assert report.max_contacts > 0
