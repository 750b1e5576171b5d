"""Moves one joint of a robot in MuJoCo, the others held: robot.py ROBOT JOINT TORQUE.csv MOTION.csv [NOISE_STD SEED]."""

import csv
import sys

import mujoco
import numpy as np

STEPS = 10
HELD = 1e9


def alone(model, joint):
    """Takes from a model all that moves or stops a joint but itself, its torque and gravity."""
    own = model.joint(joint).dofadr[0]
    model.dof_armature[np.arange(model.nv) != own] = HELD
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    bit = mujoco.mjtDisableBit
    model.opt.disableflags |= bit.mjDSBL_CONTACT | bit.mjDSBL_LIMIT | bit.mjDSBL_ACTUATION | bit.mjDSBL_EQUALITY
    model.opt.tolerance = 1e-14
    return own


def move(model, joint, t, torque):
    """Angles of a joint from rest at its zero, under a torque that is linear between its samples."""
    own = alone(model, joint)
    model.opt.timestep = (t[1] - t[0]) / STEPS
    data = mujoco.MjData(model)
    data.qpos[model.joint(joint).qposadr[0]] = 0.0
    angle = np.empty(len(t))
    for k in range(len(t)):
        angle[k] = data.qpos[model.joint(joint).qposadr[0]]
        if k + 1 == len(t):
            break
        for step in range(STEPS):
            share = (step + 0.5) / STEPS
            data.qfrc_applied[own] = torque[k] + share * (torque[k + 1] - torque[k])
            mujoco.mj_step(model, data)
    return angle


def main():
    robot, joint, torque, motion, *noise = sys.argv[1:]
    with open(torque, newline="") as file:
        header, *rows = csv.reader(file)
    t, torque = np.array(rows, dtype=float).T
    angle = move(mujoco.MjModel.from_xml_path(robot), joint, t, torque)
    if noise:
        angle += float(noise[0]) * np.random.default_rng(int(noise[1])).standard_normal(len(t))
    with open(motion, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["t_s", "torque_Nm", "angle_rad"])
        writer.writerows(zip(t, torque, angle))


if __name__ == "__main__":
    main()
