"""Loads exported robots in readers that others wrote: check_robots.py ROBOT.urdf SCENE.xml."""

import sys

import mujoco
import yourdfpy

robot = yourdfpy.URDF.load(sys.argv[1])
assert robot.validate()
followers = [joint.name for joint in robot.robot.joints if joint.mimic is not None]
in_mujoco = mujoco.MjModel.from_xml_path(sys.argv[1])
assert in_mujoco.neq == len(followers), (in_mujoco.neq, followers)
scene = mujoco.MjModel.from_xml_path(sys.argv[2])
print(len(robot.robot.joints), len(followers), scene.nv)
