"""Validates a unit, simulates it with the inputs of a table, and writes time and outputs."""
import sys

import numpy as np
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

unit, inputs, outputs = sys.argv[1:]
problems = validate_fmu(unit)
assert not problems, problems
signals = np.genfromtxt(inputs, delimiter=",", names=True)
step_s = signals["time"][1] - signals["time"][0]
names = [variable.name for variable in read_model_description(unit).modelVariables if variable.causality == "output"]
found = simulate_fmu(unit, input=signals, output=names, start_time=0.0, stop_time=signals["time"][-1],
                     step_size=step_s, output_interval=step_s, fmi_type="CoSimulation")
with open(outputs, "w") as table:
    table.write(",".join(["time", *names]) + "\n")
    for row in found:
        table.write(",".join(repr(float(row[name])) for name in ["time", *names]) + "\n")
