#!/usr/bin/env python3
"""Runs a scene of profile_work_precision or profile_stiff_peers with MuJoCo's flex: mujoco_peer.py SCENE.json
RESULT.json --step S [options]. The only file that knows MuJoCo.

The bodies are flexes of the same tetrahedra with the masses of the scene; MuJoCo's elastic law is that of Saint Venant
and Kirchhoff, which is ours for small strains, or neo-Hooke's where asked. Its contacts are springs by design: their
time constant is set to twice the step, the least that MuJoCo recommends, unless its own are asked for."""
import argparse
import math
import time

import mujoco
import numpy as np

import peer


def text(values):
    return " ".join(f"{v:.17g}" for v in np.ravel(values))


def model_of(scene, options):
    material = scene["material"]
    contact = f'friction="{material["friction"]:.17g}" condim="3" margin="0"'
    if options.solref or options.contact == "stiff":
        contact += f' solref="{options.solref or 2 * options.step:.17g} 1"'
    if options.contact == "stiff":
        contact += ' solimp="0.9999 0.9999 0.001 0.5 2"'
    flexes = []
    for b, body in enumerate(scene["bodies"]):
        if "sphere" in body:
            flexes.append(f'<body name="s{b}" pos="{text(body["nodes"][0])}"><freejoint/>'
                          f'<geom type="sphere" size="{body["sphere"]:.17g}" mass="{sum(body["mass"]):.17g}" '
                          f'{contact}/></body>')
            continue
        pins = f'<pin id="{" ".join(map(str, body["fixed"]))}"/>' if body["fixed"] else ""
        flexes.append(
            f'<flexcomp name="b{b}" type="direct" dim="3" mass="{sum(body["mass"]):.17g}" '
            f'radius="{scene["contact_distance"] / 2:.17g}" '
            f'point="{text(body["nodes"])}" element="{" ".join(str(n) for t in body["tetrahedra"] for n in t)}">'
            f'<contact {contact} selfcollide="none"/>'
            f'<elasticity young="{material["young_modulus"]:.17g}" poisson="{material["poisson_ratio"]:.17g}" '
            f'damping="{material["stiffness_damping"]:.17g}"/>{pins}</flexcomp>')
    planes = []
    for plane in scene["planes"]:
        # the flex keeps half the contact distance by its radius; the plane is moved by the other half
        place = np.array(plane["point"]) + scene["contact_distance"] / 2 * np.array(plane["normal"])
        planes.append(f'<geom type="plane" size="5 5 1" pos="{text(place)}" zaxis="{text(plane["normal"])}" '
                      f'{contact}/>')
    spec = mujoco.MjSpec.from_string(
        f'<mujoco><option timestep="{options.step:.17g}" integrator="{options.integrator}" cone="{options.cone}" '
        f'impratio="{options.impratio}" iterations="{options.iterations}" tolerance="{options.tolerance}" '
        f'gravity="{text(scene["gravity"][0][1:])}"/>'
        f'<size memory="1G"/><worldbody>{"".join(planes)}{"".join(flexes)}</worldbody></mujoco>')
    for flex in spec.flexes:
        flex.elastic3d = 1 if options.law == "neo_hookean" else 0
    return spec.compile()


def gravity_at(keys, now):
    keys = np.array(keys, float)
    return [np.interp(now, keys[:, 0], keys[:, 1 + c]) for c in range(3)]


class Soft:
    """A body of the scene that is a flex: the rows of its nodes and of their freedoms."""

    def __init__(self, model, body, flex):
        self.first, count = model.flex_vertadr[flex], model.flex_vertnum[flex]
        assert count == len(body["nodes"])
        carrier = model.flex_vertbodyid[self.first:self.first + count]
        self.free = model.body_dofnum[carrier] == 3
        self.dofs = model.body_dofadr[carrier[self.free]][:, None] + np.arange(3)
        model.body_mass[carrier[self.free]] = np.array(body["mass"])[self.free]
        self.start = np.array(body["velocity"], float)

    def set_velocity(self, data):
        data.qvel[self.dofs] = self.start[self.free]

    def positions(self, data):
        return data.flexvert_xpos[self.first:self.first + len(self.free)]

    def velocities(self, data):
        moving = np.zeros((len(self.free), 3))
        moving[self.free] = data.qvel[self.dofs]
        return moving


class Ball:
    """A body of the scene that is a rigid sphere, which its nodes draw; at rest when it starts."""

    def __init__(self, model, body, name):
        self.row = model.body(name).id
        self.dof = model.body_dofadr[self.row]
        self.arms = np.array(body["nodes"], float) - body["nodes"][0]

    def set_velocity(self, data):
        data.qvel[self.dof:self.dof + 6] = 0

    def turned(self, data):
        return self.arms @ data.xmat[self.row].reshape(3, 3).T

    def positions(self, data):
        return data.xpos[self.row] + self.turned(data)

    def velocities(self, data):
        spin = data.xmat[self.row].reshape(3, 3) @ data.qvel[self.dof + 3:self.dof + 6]
        return data.qvel[self.dof:self.dof + 3] + np.cross(spin, self.turned(data))


def bodies_of(model, scene):
    bodies, flexes = [], 0
    for b, body in enumerate(scene["bodies"]):
        if "sphere" in body:
            bodies.append(Ball(model, body, f"s{b}"))
        else:
            bodies.append(Soft(model, body, flexes))
            flexes += 1
    return bodies


def run(scene, options):
    samples = scene["samples"]
    interval = scene["seconds"] / samples
    steps = max(1, math.ceil(interval / options.step - 1e-9))
    options.step = interval / steps
    model = model_of(scene, options)
    data = mujoco.MjData(model)
    bodies = bodies_of(model, scene)
    mujoco.mj_setConst(model, data)
    for body in bodies:
        body.set_velocity(data)
    mujoco.mj_forward(model, data)
    result = {"finished": True, "step": options.step, "steps": 0, "positions": [], "velocities": []}
    seconds = 0.0
    changing = len(scene["gravity"]) > 1
    for s in range(samples):
        start = time.thread_time()
        for i in range(0, steps, options.chunk):
            if changing:
                model.opt.gravity[:] = gravity_at(scene["gravity"], data.time)
            mujoco.mj_step(model, data, nstep=min(options.chunk, steps - i))
            if seconds + time.thread_time() - start > options.cap:
                break
        seconds += time.thread_time() - start
        result["steps"] += steps
        # positions of vertices are those of the last evaluation; the state itself is newer by a step
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_flex(model, data)
        place = np.concatenate([body.positions(data) for body in bodies])
        # MuJoCo starts anew from rest after one of these
        warned = any(data.warning[int(w)].number for w in (mujoco.mjtWarning.mjWARN_BADQPOS,
                                                           mujoco.mjtWarning.mjWARN_BADQVEL,
                                                           mujoco.mjtWarning.mjWARN_BADQACC))
        if seconds > options.cap or warned or not np.all(np.isfinite(place)):
            result["finished"] = False
            break
        result["positions"].append(np.ravel(place).tolist())
        result["velocities"].append(np.concatenate([np.ravel(body.velocities(data)) for body in bodies]).tolist())
    result["seconds"] = seconds
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    peer.add_arguments(parser)
    parser.add_argument("--integrator", default="Euler")
    parser.add_argument("--impratio", type=float, default=1)
    parser.add_argument("--cone", default="elliptic")
    parser.add_argument("--contact", choices=["stiff", "own"], default="stiff",
                        help="as stiff as MuJoCo recommends, or softness as it has it by itself")
    parser.add_argument("--solref", type=float, default=0, help="time constant of contacts, s")
    parser.add_argument("--law", choices=["own", "neo_hookean"], default="own")
    parser.add_argument("--tolerance", type=float, default=1e-10)
    parser.add_argument("--iterations", type=int, default=100)
    parser.add_argument("--chunk", type=int, default=16, help="steps between two looks at the clock and at gravity")
    peer.run_repeatedly(run, parser.parse_args())


if __name__ == "__main__":
    main()
