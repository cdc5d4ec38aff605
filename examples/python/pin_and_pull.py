"""A bar is pinned at one end and pulled at the other: first by a force, then by a clamp that moves."""

import skerry as sk

length, width = 0.5, 0.1  # [m]
young_modulus, pull = 1e5, 10.0  # [Pa], [N]

world = sk.World(gravity=(0, 0, 0))
# With Poisson's ratio 0 the clamped end is as soft as the rest, so Hooke's law for a bar is exact for small strains.
rubber = sk.Material(young_modulus=young_modulus, poisson_ratio=0, density=1000, damping=60)
bar = world.add_body(sk.Mesh.box((length, width, width), (10, 2, 2)), rubber)
bar.attach(bar.select(where=lambda x: x[:, 0] < -length / 2 + 1e-9))
right = bar.select(where=lambda x: x[:, 0] > length / 2 - 1e-9)

load = world.add_traction(bar, bar.faces(right), (pull / width**2, 0, 0))
world.advance(1)
strain = (bar.positions[right, 0].mean() - length / 2) / length
hooke = pull / (young_modulus * width**2)
print(f"{pull:g} N stretch the bar by {100 * strain:.4f} %, Hooke's law says {100 * hooke:.4f} %.")

# Let go, hold the end in a clamp instead, and move that for a tenth of a second.
load.remove()
world.advance(1)
clamp = bar.attach(right, motion=sk.Motion(velocity=(0.1, 0, 0)))
world.advance(0.1)
stretched = bar.positions[right[0], 0] - length / 2
print(f"The clamp moved by {1000 * stretched:.3f} mm.")

# Take the clamp off: the bar swings back.
clamp.remove()
world.advance(1)
back = bar.positions[right[0], 0] - length / 2
print(f"Without it the end came back to {1000 * back:.4f} mm.")

assert abs(strain - hooke) < 0.01 * hooke  # Hooke's law holds for small strains
assert abs(stretched - 0.01) < 1e-4
assert abs(back) < 1e-4
