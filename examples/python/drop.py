"""A soft ball falls on a table. The program prints its contact forces and writes a table and a page.

Usage: python drop.py [FOLDER]
"""

import pathlib
import sys
import tempfile

import numpy as np

import skerry as sk


def main(folder: pathlib.Path) -> None:
    """Runs the drop and writes drop.csv and drop.html into the folder."""
    world = sk.World()
    world.add_collider(sk.Plane(), name="floor")
    table = world.add_body(
        sk.Mesh.table(height=0.3),
        sk.Material(young_modulus=1e7, density=700),
        position=(0, 0, 0.001),
        name="table",
    )
    ball = world.add_body(
        sk.Mesh.ball(0.06, 8), sk.Material(young_modulus=2e5, friction=0.8), position=(0, 0, 0.45), name="ball"
    )
    world.measure_forces()

    probes: dict[str, sk.Probe] = {
        "top": ball.probe((0, 0, 0.51)),
        "push": sk.ForceProbe(ball, by=table),
        "energy": sk.EnergyProbe(),
    }
    with world.record(title="drop") as film, world.recorder(probes) as recorder:
        world.run(0.5, dt=1 / 240)

    history = recorder.table()
    hardest = int(np.nanargmax(history["push.force_z"]))
    print(f"largest force {history['push.force_z'][hardest]:.3g} N at {history['time'][hardest]:.3f} s")
    contacts = world.contacts
    sticking = int(np.count_nonzero(contacts["motion"] == sk.STICK))
    print(f"{len(contacts)} contacts at the end, of which {sticking} stick")
    print(f"the floor carries {world.forces.on(table, by=world.colliders['floor']).force[2]:.3g} N")

    recorder.to_csv(folder / "drop.csv")
    film.save(folder / "drop.html")
    print(f"wrote drop.csv and drop.html to {folder}")


if len(sys.argv) > 1:
    main(pathlib.Path(sys.argv[1]))
else:
    with tempfile.TemporaryDirectory() as temporary:
        main(pathlib.Path(temporary))
