"""Validates an FMU, simulates it with FMPy and compares every output with socam's own simulation.

Usage: simulate_fmu.py MODEL.fmu TABLE.csv INTERFACE INPUTS PARAMETER VALUE
The interface is CoSimulation or ModelExchange.
The table begins with the time and INPUTS columns of inputs, the rest are outputs; the parameter gets the value (SI) before the start.
Prints the largest error of each output relative to its largest magnitude. It is also checked that the FMU refuses what it must.
"""

import shutil
import sys

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

# The simulator keeps its own error an order of magnitude below a count of a converter of 16 bits, 1.5e-5.
MOST_RELATIVE_ERROR = 1e-5


def compare(fmu, table, interface, inputs, start_values):
    data = np.genfromtxt(table, delimiter=",", names=True)
    names = data.dtype.names
    result = simulate_fmu(
        fmu,
        fmi_type=interface,
        relative_tolerance=1e-9,
        stop_time=data["time"][-1],
        output_interval=data["time"][1],
        input=data[list(names[: inputs + 1])],
        output=names[inputs + 1 :],
        start_values=start_values,
    )
    assert len(result) == len(data), (len(result), len(data))
    for name in names[inputs + 1 :]:
        largest = np.abs(data[name]).max()
        error = np.abs(result[name] - data[name]).max() / largest
        print(f"{name}: {error:.1e} of {largest:.3g}")
        assert largest > 0 and error < MOST_RELATIVE_ERROR, name


def instantiated(folder, description, token):
    slave = FMU3Slave(
        guid=token,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="tested",
    )
    slave.instantiate()
    return slave


def refused(call):
    try:
        call()
    except FMICallException:
        return True
    return False


def call(folder, description):
    """What a simulation from start to end does not do: returns in time, values out of bounds, a wrong token."""
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    outputs = [v.valueReference for v in description.modelVariables if v.causality == "output"]
    an_input = next(v.valueReference for v in description.modelVariables if v.causality == "input")
    slave = instantiated(folder, description, description.guid)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.setFloat64([an_input], [1.0])
    slave.doStep(0.0, 0.01)
    state = slave.getFMUState()
    slave.doStep(0.01, 0.01)
    first = slave.getFloat64(outputs)
    slave.setFloat64([an_input], [-3.0])
    slave.doStep(0.02, 0.003)
    assert slave.getFloat64(outputs) != first
    slave.setFMUState(state)
    slave.doStep(0.01, 0.01)
    assert slave.getFloat64(outputs) == first and slave.getFloat64([0]) == [0.02]
    slave.freeFMUState(state)
    bounded = next(v for v in description.modelVariables if v.causality == "parameter" and v.max is not None)
    assert refused(lambda: slave.setFloat64([bounded.valueReference], [2 * float(bounded.max)]))
    assert refused(lambda: slave.setFloat64(outputs, first))
    assert refused(lambda: slave.getFloat64([len(references)]))
    assert refused(lambda: slave.getInt32([0]))
    assert refused(lambda: slave.doStep(5.0, 0.01)), "a step from another time"
    assert refused(lambda: slave.doStep(0.02, -0.01)), "a step back"
    slave.reset()
    assert slave.getFloat64([0]) == [0.0]
    slave.terminate()
    slave.freeInstance()
    try:
        instantiated(folder, description, "another model")
    except Exception as error:
        assert "instantiate" in str(error).lower(), error
    else:
        raise AssertionError("an FMU started with the token of another one")


def main(fmu, table, interface, inputs, parameter, value):
    problems = validate_fmu(fmu)
    assert not problems, problems
    compare(fmu, table, interface, int(inputs), {parameter: float(value)})
    folder = extract(fmu)
    try:
        call(folder, read_model_description(folder))
    finally:
        shutil.rmtree(folder, ignore_errors=True)


main(*sys.argv[1:])
