#!/usr/bin/env python3
"""Runs a scene of profile_work_precision with MuJoCo's flex: mujoco_peer.py SCENE.json RESULT.json --step S [options].
The only file that knows MuJoCo.

The bodies are flexes of the same tetrahedra with the masses of the scene; MuJoCo's elastic law is that of Saint Venant
and Kirchhoff, which is ours for small strains. Its contacts are springs by design: their time constant is set to twice
the step, the least that MuJoCo recommends."""
import argparse
import json
import math
import os
import time

import mujoco
import numpy as np


def text(values):
    return " ".join(f"{v:.17g}" for v in np.ravel(values))


def model_of(scene, options):
    material = scene["material"]
    contact = (f'solref="{2 * options.step:.17g} 1" solimp="0.9999 0.9999 0.001 0.5 2" '
               f'friction="{material["friction"]:.17g}" condim="3" '
               f'margin="0"')
    flexes = []
    for b, body in enumerate(scene["bodies"]):
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
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{options.step:.17g}" integrator="{options.integrator}" cone="elliptic" '
        f'impratio="{options.impratio}" '
        f'iterations="{options.iterations}" tolerance="1e-10" gravity="{text(scene["gravity"][0][1:])}"/>'
        f'<size memory="200M"/><worldbody>{"".join(planes)}{"".join(flexes)}</worldbody></mujoco>')


def gravity_at(keys, now):
    keys = np.array(keys, float)
    return [np.interp(now, keys[:, 0], keys[:, 1 + c]) for c in range(3)]


def node_bodies(model, scene):
    """For each node of the scene the body that carries it, or -1 where it is held."""
    carriers = []
    for b, body in enumerate(scene["bodies"]):
        first, count = model.flex_vertadr[b], model.flex_vertnum[b]
        assert count == len(body["nodes"])
        carriers.append([model.flex_vertbodyid[first + n] for n in range(count)])
    return np.concatenate(carriers)


def run(scene, options):
    samples = scene["samples"]
    interval = scene["seconds"] / samples
    steps = max(1, math.ceil(interval / options.step - 1e-9))
    options.step = interval / steps
    model = model_of(scene, options)
    data = mujoco.MjData(model)
    carrier = node_bodies(model, scene)
    mass = np.concatenate([body["mass"] for body in scene["bodies"]])
    velocity = np.concatenate([np.array(body["velocity"], float) for body in scene["bodies"]])
    free = model.body_dofnum[carrier] == 3
    dofs = model.body_dofadr[carrier[free]][:, None] + np.arange(3)
    model.body_mass[carrier[free]] = mass[free]
    mujoco.mj_setConst(model, data)
    data.qvel[dofs] = velocity[free]
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
        moving = np.zeros_like(velocity)
        moving[free] = data.qvel[dofs]
        # positions of vertices are those of the last evaluation; the state itself is newer by a step
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_flex(model, data)
        place = data.flexvert_xpos
        # MuJoCo starts anew from rest after one of these
        warned = any(data.warning[int(w)].number for w in (mujoco.mjtWarning.mjWARN_BADQPOS,
                                                           mujoco.mjtWarning.mjWARN_BADQVEL,
                                                           mujoco.mjtWarning.mjWARN_BADQACC))
        if seconds > options.cap or warned or not np.all(np.isfinite(place)):
            result["finished"] = False
            break
        result["positions"].append(np.ravel(place).tolist())
        result["velocities"].append(np.ravel(moving).tolist())
    result["seconds"] = seconds
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("result")
    parser.add_argument("--step", type=float, required=True)
    parser.add_argument("--integrator", default="Euler")
    parser.add_argument("--impratio", type=float, default=1)
    parser.add_argument("--iterations", type=int, default=100)
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--cap", type=float, default=60)
    parser.add_argument("--chunk", type=int, default=16, help="steps between two looks at the clock and at gravity")
    options = parser.parse_args()
    with open(options.scene) as file:
        scene = json.load(file)
    options.result = os.path.abspath(options.result)
    os.chdir(os.path.dirname(options.result))  # MuJoCo writes a log where it runs
    runs = [run(scene, options)]
    while len(runs) < options.repeat and runs[0]["finished"]:
        runs.append(run(scene, options))
    runs[0]["seconds"] = sorted(r["seconds"] for r in runs)[len(runs) // 2]
    with open(options.result, "w") as file:
        json.dump(runs[0], file)


if __name__ == "__main__":
    main()
