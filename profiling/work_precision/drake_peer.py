#!/usr/bin/env python3
"""Runs a scene of profile_stiff_peers with Drake's deformable bodies: drake_peer.py SCENE.json RESULT.json --step S
[options]. The only file that knows Drake.

The bodies have the same tetrahedra, the law is linear corotated elasticity, steps are implicit and solved together with
the contacts. Planes are boxes, since its half space does not touch deformable bodies."""
import argparse
import pathlib
import time

import numpy as np
from pydrake import geometry, math
from pydrake.multibody import fem, plant, tree
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

import peer


def write_mesh(body, file):
    lines = ["# vtk DataFile Version 3.0", "body", "ASCII", "DATASET UNSTRUCTURED_GRID",
             f"POINTS {len(body['nodes'])} double"]
    lines += [" ".join(f"{x:.17g}" for x in node) for node in body["nodes"]]
    count = len(body["tetrahedra"])
    lines.append(f"CELLS {count} {5 * count}")
    lines += ["4 " + " ".join(map(str, tetrahedron)) for tetrahedron in body["tetrahedra"]]
    lines.append(f"CELL_TYPES {count}")
    lines += ["10"] * count
    file.write_text("\n".join(lines) + "\n")


def surface_properties(scene, options, rigid):
    properties = geometry.ProximityProperties()
    friction = scene["material"]["friction"]
    geometry.AddContactMaterial(dissipation=options.dissipation, friction=plant.CoulombFriction(friction, friction),
                                properties=properties)
    if rigid:
        geometry.AddRigidHydroelasticProperties(options.resolution, properties)
    return properties


def add_plane(world, scene, plane, name, options):
    thickness = 0.5
    normal = np.array(plane["normal"], float)
    place = np.array(plane["point"]) + scene["contact_distance"] * normal - thickness / 2 * normal
    pose = math.RigidTransform(math.RotationMatrix.MakeFromOneVector(normal, 2), place)
    world.RegisterCollisionGeometry(world.world_body(), pose, geometry.Box(4, 4, thickness), name,
                                    surface_properties(scene, options, True))


class Soft:
    """A deformable body of the scene."""

    def __init__(self, world, scene, body, name, options):
        file = pathlib.Path(options.result).with_name(name + ".vtk")
        write_mesh(body, file)
        instance = geometry.GeometryInstance(math.RigidTransform(), geometry.Mesh(str(file)), name)
        instance.set_proximity_properties(surface_properties(scene, options, False))
        config = fem.DeformableBodyConfig()
        config.set_youngs_modulus(scene["material"]["young_modulus"])
        config.set_poissons_ratio(scene["material"]["poisson_ratio"])
        config.set_mass_density(scene["material"]["density"])
        config.set_stiffness_damping_coefficient(scene["material"]["stiffness_damping"])
        config.set_material_model(fem.MaterialModel.kLinearCorotated)
        self.model = world.mutable_deformable_model()
        self.id = self.model.RegisterDeformableBody(instance, config, 1.0)
        if body["fixed"]:
            # held nodes are those on one side of a plane: here those of least x
            nodes = np.array(body["nodes"])
            held = np.max(nodes[body["fixed"]][:, 0])
            assert np.sum(nodes[:, 0] <= held) == len(body["fixed"])
            self.model.SetWallBoundaryCondition(self.id, np.array([held + 1e-6, 0, 0]), np.array([1.0, 0, 0]))

    def positions(self, context):
        return self.model.GetPositions(context, self.id).T

    def velocities(self, context):
        return self.model.GetVelocities(context, self.id).T


class Ball:
    """A rigid sphere, which its nodes draw."""

    def __init__(self, world, scene, body, name, options):
        self.plant = world
        self.arms = np.array(body["nodes"], float) - body["nodes"][0]
        self.start = np.array(body["nodes"][0])
        radius = body["sphere"]
        self.body = world.AddRigidBody(name, tree.SpatialInertia.SolidSphereWithMass(sum(body["mass"]), radius))
        world.RegisterCollisionGeometry(self.body, math.RigidTransform(), geometry.Sphere(radius), name,
                                        surface_properties(scene, options, True))

    def place(self, context):
        self.plant.SetFreeBodyPose(context, self.body, math.RigidTransform(self.start))

    def positions(self, context):
        pose = self.plant.EvalBodyPoseInWorld(context, self.body)
        return pose.translation() + self.arms @ pose.rotation().matrix().T

    def velocities(self, context):
        moving = self.plant.EvalBodySpatialVelocityInWorld(context, self.body)
        arms = self.positions(context) - self.plant.EvalBodyPoseInWorld(context, self.body).translation()
        return moving.translational() + np.cross(moving.rotational(), arms)


def build(scene, options):
    builder = DiagramBuilder()
    config = plant.MultibodyPlantConfig(time_step=options.step, discrete_contact_approximation=options.approximation,
                                        stiction_tolerance=options.stiction)
    world, _ = plant.AddMultibodyPlant(config, builder)
    for p, plane in enumerate(scene["planes"]):
        add_plane(world, scene, plane, f"plane{p}", options)
    bodies = [(Ball if "sphere" in body else Soft)(world, scene, body, f"body{b}", options)
              for b, body in enumerate(scene["bodies"])]
    world.mutable_gravity_field().set_gravity_vector(np.array(scene["gravity"][0][1:], float))
    world.Finalize()
    simulator = Simulator(builder.Build())
    context = world.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    for body in bodies:
        if isinstance(body, Ball):
            body.place(context)
    simulator.Initialize()
    for body, wanted in zip(bodies, scene["bodies"]):
        assert np.allclose(body.positions(context), wanted["nodes"])
    return simulator, context, bodies


def run(scene, options):
    assert len(scene["gravity"]) == 1 and not any(np.any(body["velocity"]) for body in scene["bodies"])
    interval = scene["seconds"] / scene["samples"]
    steps = max(1, round(interval / options.step))
    options.step = interval / steps
    simulator, context, bodies = build(scene, options)
    result = {"finished": True, "step": options.step, "steps": 0, "positions": [], "velocities": []}
    seconds = 0.0
    for s in range(scene["samples"]):
        start = time.process_time()
        simulator.AdvanceTo((s + 1) * interval)
        seconds += time.process_time() - start
        result["steps"] += steps
        place = np.concatenate([body.positions(context) for body in bodies])
        if seconds > options.cap or not np.all(np.isfinite(place)):
            result["finished"] = False
            break
        result["positions"].append(np.ravel(place).tolist())
        result["velocities"].append(np.concatenate([np.ravel(body.velocities(context)) for body in bodies]).tolist())
    result["seconds"] = seconds
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    peer.add_arguments(parser)
    parser.add_argument("--approximation", default="lagged", help="of friction: lagged, similar, sap")
    parser.add_argument("--dissipation", type=float, help="of contacts, s/m; by default Drake's own")
    parser.add_argument("--stiction", type=float, default=1e-4, help="speed below which friction is smoothed, m/s")
    parser.add_argument("--resolution", type=float, default=0.02, help="edge of the faces of rigid spheres, m")
    peer.run_repeatedly(run, parser.parse_args())


if __name__ == "__main__":
    main()
