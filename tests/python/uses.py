"""A program that uses every name of the package with its type. mypy must find no mistake in it."""

import json
import math
import pathlib
import sys

import numpy as np

import skerry as sk

backend: sk.Backend = "threads"
method: sk.SolverMethod = "automatic"
friction: sk.Friction = "cone"
integrator: sk.Integrator = "leapfrog"
overlaps: sk.StartOverlaps = "resolve"
regions: sk.ContactRegions = "separate"
settings = sk.Settings(backend=backend, threads=1, method=method, friction=friction, integrator=integrator)
world = sk.World(settings, start_overlaps=overlaps, contact_regions=regions)

# Materials, meshes and bodies.
model: sk.MaterialModel = "stable_neo_hookean"
rubber = sk.Material(young_modulus=2e5, friction=0.5, model=model)
known: sk.NamedMaterials = sk.materials
pairs: tuple[sk.KnownFriction, ...] = tuple(known.frictions())
moduli = sk.OrthotropicModuli(young_modulus=(1e5, 2e5, 1e5), poisson_ratio=(0.3, 0.3, 0.3), shear_modulus=(4e4,) * 3)
others = [sk.orthotropic(moduli), sk.mooney_rivlin(3e4, 1e4, 1e6), sk.ogden([(4e4, 2.0)], 1e6), known["steel"]]
metal = sk.Material(young_modulus=1e7, model="hencky", plasticity=sk.Plasticity(yield_stress=1e5))
box = sk.Mesh.box((0.1, 0.1, 0.1), (3, 3, 3))
inside = np.abs(box.nodes[box.tetrahedra].mean(axis=1)).max(axis=1) < 0.1 / 6
mesh = sk.Mesh(box.nodes, box.tetrahedra[~inside])
quality: sk.MeshReport = mesh.inspect()
finer: sk.Mesh = mesh.refine()
dynamics: sk.Dynamics = "explicit"
element: sk.ElementKind = "smoothed"
cube: sk.Body = world.add_body(mesh, rubber, dynamics=dynamics, element=element, position=(0, 0, 0.0505), name="cube")
handle: sk.MaterialHandle = cube.material
cube.add_set("low", sk.MeshSet(nodes=cube.select(below=0.02)))
shapes: list[sk.Shape] = [sk.Plane(), sk.Bucket(radius=1, height=1, thickness=0.1), sk.Box((1, 1, 1)), mesh.boundary()]
floor: sk.Collider = world.add_collider(shapes[0], name="floor", motion=sk.Motion(keys=[sk.MotionKey(time=0)]))
rod = world.add_body(sk.Capsule(radius=0.02, length=0.1), rubber, position=(0.5, 0, 0.5), name="rod")
bob = world.add_body(sk.Sphere(radius=0.02), rubber, position=(0.7, 0, 0.5))
puck = world.add_body(sk.Mesh.ball(0.05, 2), metal, position=(3, 0, 0.0501))
drum = world.add_body(sk.Cylinder(radius=0.05, height=0.1), rubber, position=(0.7, 0, 0.8))
bodies: sk.Objects[sk.Body] = world.bodies
triangles: sk.SurfaceMesh = mesh.boundary()
paint = sk.VisualMaterial(name="paint")
cube.visual = sk.VisualSurface(triangles.nodes, triangles.triangles, materials=[paint])
drawn: sk.VisualSurface | None = cube.visual
folder = pathlib.Path(sys.argv[1])
(folder / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
triangles = sk.read_surface(folder / "one.obj")
checked: sk.SurfaceReport = sk.check_surface(triangles)
faults: tuple[sk.SurfaceFault, ...] = checked.faults
fault_kinds: set[sk.SurfaceFaultKind] = {fault.kind for fault in faults}
shells: tuple[sk.SurfaceShell, ...] = checked.shells

# Connections and loads.
low: sk.SurfaceSet = world.add_surface_set(cube, sk.Surface(friction=0.2), nodes=cube.select(set="low"))
kind: sk.JointKind = "hinge"
motor = sk.Motor(keys=[sk.MotorKey(time=0, speed=1.0)], strength=1)
joint: sk.Joint = world.add_joint(kind, rod, motor=motor, passive=sk.JointPassive(damping=0.01))
joint_now: sk.JointState = joint.state
joints: sk.ObjectList[sk.Joint] = world.joints
weld: sk.TieKind = "weld"
tie: sk.Tie = world.add_tie(cube, [0, 1, 2], kind=weld)
tie_now: sk.TieState = tie.state
ends = [sk.Anchor(body=rod, point=(0.5, 0, 0.5)), sk.Anchor(body=bob, point=(0.7, 0, 0.5))]
cable: sk.Cable = world.add_cable(ends, tension=1.0)
cable_now: sk.CableState = cable.state
side: sk.SpringSide = "both"
spring: sk.Spring = world.add_spring(ends[1], sk.Anchor(body=drum, point=(0.7, 0, 0.8)), stiffness=10.0, only=side)
spring_now: sk.SpringState = spring.state
fillings = (sk.Gas(), sk.Liquid())
cavity: sk.Cavity = world.add_cavity(cube, gas=fillings[0])
law: sk.CavityLaw = cavity.state.law
cavity_now: sk.CavityState = cavity.state
pipe: sk.Pipe = world.add_pipe(cavity, conductance=1e-9)
pipe_now: sk.PipeState = pipe.state
fibres: sk.FibreFamily = world.add_fibres(cube, (1, 0, 0), stiffness=1e3)
fibres_now: sk.FibreState = fibres.state
load: sk.Load = world.add_force(cube, [0], (0, 0, 0.1))
load_kind: sk.LoadKind = load.state.kind
load_now: sk.LoadState = load.state
clamp: sk.Attachment = cube.attach(cube.select(above=0.1))
clamp.move_to(sk.Pose(position=(0, 0, -0.002)), 0.01)

# Results.
probes: dict[str, sk.Probe] = {
    "point": cube.probe((0.04, 0, 0.05)),
    "center": sk.PointProbe(body=cube, node=(0, 1, 1, 1), weight=(0.5, 0.5, 0, 0)),
    "body": sk.BodyProbe(cube),
    "force": sk.ForceProbe(cube),
    "reaction": sk.ReactionProbe(clamp),
    "joint": sk.JointProbe(joint),
    "tie": sk.TieProbe(tie),
    "cable": sk.CableProbe(cable),
    "cavity": sk.CavityProbe(cavity),
    "spring": sk.SpringProbe(spring),
    "energy": sk.EnergyProbe(),
    "stress": sk.StressProbe(cube, nodes=[0]),
    "volume": sk.VolumeProbe(cube),
}
more: dict[str, sk.Probe] = {"pose": sk.PoseProbe(rod), "velocity": sk.VelocityProbe(rod), "nodes": sk.NodesProbe(cube)}
world.measure_forces()
recorder: sk.Recorder = world.recorder(probes)
errors: sk.ErrorEstimator = world.error_estimator()
film: sk.Film = world.record()
with recorder, errors, film, world.contact_problems() as steps:
    report: sk.StepReport = world.advance(0.02)
worst, mesh_error = errors.table()["worst_tetrahedron"], cube.mesh_error()
page: sk.Page = world.show()
try:
    with sk.view(world, open=False) as view:
        opened: sk.View = view
        opened.sync()
        duration: float = next(opened.steps())
except sk.SceneError as without_server:
    assert "live view" in str(without_server)
color: sk.FilmColor = "speed"
world.gltf(folder / "end.glb", color=color)
step: sk.StepProblem = steps[-1]
problem: sk.Problem = step.problem
solution: sk.Solution = sk.solve(problem, method=method)
error: sk.ProblemError = sk.problem_error(problem, solution.reaction)
forces: sk.Forces = world.forces
on_floor: sk.ForceReport = forces.on(floor)
of_pairs: list[sk.PairForces] = forces.pairs()
hit: sk.SurfaceHit | None = world.cast_ray((0, 0, 1), (0, 0, -1))
assert world.contacts.dtype == sk.contact_dtype and world.cast_rays([(0, 0, 1)], [(0, 0, -1)]).dtype == sk.hit_dtype
assert {int(motion) for motion in world.contacts["motion"]} <= {sk.OPEN, sk.SLIDE, sk.STICK}
run: sk.WorldReport = world.report()
energy: sk.Energy = run.energy
choices: tuple[sk.DynamicsChoice, ...] = run.dynamics_choices
estimates: list[sk.DynamicsEstimate] = [choice.estimate for choice in choices]
stages: tuple[sk.StageReport, ...] = run.stages
limits: tuple[sk.StepLimitReport, ...] = run.step_limits
found: tuple[sk.StartOverlap, ...] = run.start_overlaps
moves: tuple[sk.StartMove, ...] = run.start_moves
crossings: tuple[sk.SelfCrossing, ...] = run.self_crossings

# Many worlds, scenes and errors.
out: sk.RolloutResult = sk.rollout([world.copy(), world.copy()], {}, dt=0.001, steps=2, record=more)
rest = sk.World(threads=1)
rest.add_body(sk.Sphere(radius=0.1), rubber)
relaxed: sk.RelaxReport = rest.relax(max_steps=1)
block = {"name": "block", "mesh": {"box": {"size": [1, 1, 1], "cells": [1, 1, 1]}}, "material": "rubber"}
described = {"seconds": 0.01, "materials": {"rubber": {}}, "bodies": [block], "settings": {"threads": 1}}
part = {"lower": [-1, -1, -1], "upper": [1, 1, 0]}
described["probes"] = [{"name": "low", "quantity": "contacts", "body": "block", "box": part}]
described["loads"] = [{"name": "wind", "kind": "acceleration", "acceleration": [1, 0, 0]}]
described["sliders"] = [{"name": "wind", "load": "wind", "low": 0, "high": 2}]
scene: sk.Scene = sk.load_scene(described)
wind: sk.Slider = scene.sliders["wind"]
wind.set(wind.low + wind.fastest * wind.value * 0.1)
contact_probes: tuple[sk.ContactProbe, ...] = scene.contact_probes
(folder / "described.json").write_text(json.dumps(described))
study: sk.Study = sk.study(folder / "described.json", seconds=0.002, threads=1, budget=4)
quantities: dict[str, sk.StudyQuantity] = study.quantities
studied: tuple[sk.StudyRun, ...] = study.runs
cheapest: sk.CheapestSettings | None = study.cheapest
table = sk.sweep(described, {"materials.rubber.density": [500, 1000]}, jobs=1)
assert math.isfinite(energy.kinetic) and "properties" in sk.scene_schema() and isinstance(sk.__version__, str)
try:
    world.advance(-1)
except (sk.SceneError, sk.StepError, sk.BusyError) as refused:
    text: str = str(refused)
doubt: type[Warning] = sk.Doubt


def add_robot(file: str) -> tuple[list[sk.RobotLink], list[sk.RobotJoint]]:
    """Needs another package, so that it is not called here."""
    robot: sk.Robot = sk.load_robot(file)
    placed: sk.PlacedRobot = world.add_robot(robot)
    return list(placed.robot.links.values()), list(robot.joints.values())
