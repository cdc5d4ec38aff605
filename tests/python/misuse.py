"""Mistakes that mypy must find. A comment names the error that is expected on its line."""

import skerry as sk

world = sk.World(gravity="down")  # expect: arg-type
world = sk.World(grvity=(0, 0, -9.81))  # expect: call-arg
ball = world.add_body(sk.Mesh.ball(0.1, 4), 3.0)  # expect: arg-type
world.advance("1/60")  # expect: arg-type
height: float = ball.positions  # expect: assignment
place = ball.position  # expect: attr-defined
