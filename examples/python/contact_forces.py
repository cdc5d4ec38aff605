"""The contacts of a block on a slope carry its weight, and friction holds it."""

import numpy as np

import skerry as sk

slope = 0.3  # below the friction angle atan(0.5) = 0.46 [rad]
world = sk.World(gravity=(9.81 * np.sin(slope), 0, -9.81 * np.cos(slope)))  # tilted instead of the floor
rubber = sk.Material(young_modulus=2e5, density=1000, friction=0.5, damping=50)
block = world.add_body(sk.Mesh.box((0.2, 0.2, 0.1), (4, 4, 2)), rubber, position=(0, 0, 0.0505))
floor = world.add_collider(sk.Plane())

world.advance(1.5)  # the block settles
world.measure_forces()
world.advance(0.5)
force = world.forces.on(block, by=floor).force  # mean over the call [N]
weight = block.mass * np.array(world.settings.gravity)  # [N]
contacts = world.contacts
sticking, sliding = np.sum(contacts["motion"] == sk.STICK), np.sum(contacts["motion"] == sk.SLIDE)
print(
    f"The block weighs {np.linalg.norm(weight):.3f} N; the floor pushes with {force[2]:.3f} N and holds with "
    f"{-force[0]:.3f} N of friction.\n{sticking} contacts stick and {sliding} slide."
)

# At rest the contacts carry the weight. The oscillation that remains is below one percent.
assert np.linalg.norm(force + weight) < 0.01 * np.linalg.norm(weight)
assert sticking > 0
