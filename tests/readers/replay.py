"""Runs an exported model on a recording: replay.py MODEL.{py,xml} RECORDING.csv PREDICTED.csv."""

import csv
import importlib.util
import sys

import numpy as np


def read(path):
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    columns = dict(zip(header, np.array(rows, dtype=float).T))
    return columns["t_s"] - columns["t_s"][0], columns


def python(path, t, columns):
    spec = importlib.util.spec_from_file_location("exported", path)
    model = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(model)
    outputs = model.simulate(t, model.read_inputs(t, columns))
    return {entry[1]: (row - entry[3]) / entry[2] for entry, row in zip(model.OUTPUTS, outputs)}


def mujoco(path, t, columns):
    import mujoco

    model = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(model)
    texts = {}
    for index in range(model.ntext):
        start = model.text_adr[index]
        words = bytes(model.text_data[start : start + model.text_size[index]]).decode().rstrip("\0")
        texts[mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_TEXT, index)] = words.split(":")[0]
    inputs = {name: model.actuator(name).id for name in texts if name.startswith("input_")}
    controls = {}
    for name, actuator in inputs.items():
        scale, offset = model.numeric(name).data
        controls[actuator] = scale * columns[texts[name]] + offset
    outputs = [name for name in texts if name not in inputs]

    def readings():
        for name in outputs:
            factors = model.numeric(name).data
            if len(factors) == 1:
                yield factors[0] * data.sensor(name).data[0]
            else:
                yield factors[0] * data.sensor(name + "_twist").data[0] + factors[1] * data.sensor(name + "_rate").data[0]

    steps = round((t[1] - t[0]) / model.opt.timestep)
    table = np.empty((len(t), len(outputs)))
    for k in range(len(t)):
        mujoco.mj_forward(model, data)
        table[k] = list(readings())
        if k + 1 == len(t):
            break
        for step in range(steps):
            share = (step + 0.5) / steps
            for actuator, values in controls.items():
                data.ctrl[actuator] = values[k] + share * (values[k + 1] - values[k])
            mujoco.mj_step(model, data)
    return dict(zip((texts[name] for name in outputs), table.T))


def main():
    path, recording, predicted = sys.argv[1:]
    t, columns = read(recording)
    outputs = (python if path.endswith(".py") else mujoco)(path, t, columns)
    with open(predicted, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["t_s", *outputs])
        writer.writerows(zip(t, *outputs.values()))


main()
