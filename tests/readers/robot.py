"""Moves one joint of a robot in MuJoCo, the others held: robot.py ROBOT JOINT TORQUE.csv MOTION.csv [NOISE_STD SEED]."""

import csv
import sys

import mujoco
import numpy as np

STEPS = 10
HELD = 1e9


def main():
    robot, joint, torque, motion, *noise = sys.argv[1:]
    with open(torque, newline="") as file:
        header, *rows = csv.reader(file)
    t, torque = np.array(rows, dtype=float).T
    model = mujoco.MjModel.from_xml_path(robot)
    own = model.joint(joint).dofadr[0]
    model.dof_armature[np.arange(model.nv) != own] = HELD
    model.opt.timestep = (t[1] - t[0]) / STEPS
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT | mujoco.mjtDisableBit.mjDSBL_ACTUATION
    model.opt.tolerance = 1e-14
    data = mujoco.MjData(model)
    angle = np.empty(len(t))
    for k in range(len(t)):
        angle[k] = data.qpos[model.joint(joint).qposadr[0]]
        if k + 1 == len(t):
            break
        for step in range(STEPS):
            share = (step + 0.5) / STEPS
            data.qfrc_applied[own] = torque[k] + share * (torque[k + 1] - torque[k])
            mujoco.mj_step(model, data)
    if noise:
        angle += float(noise[0]) * np.random.default_rng(int(noise[1])).standard_normal(len(t))
    with open(motion, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["t_s", "torque_Nm", "angle_rad"])
        writer.writerows(zip(t, torque, angle))


main()
