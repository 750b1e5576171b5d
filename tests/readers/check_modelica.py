"""An exported Modelica package: parsed, and with the folder of the Modelica Standard Library simulated against the exported Python file.

check_modelica.py BENCH.mo BENCH.py [LIBRARY]
"""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import rumoca

path, python, *library = sys.argv[1:]
source = Path(path).read_text()
# It refuses what is not Modelica.
rumoca.format(source)
if library:
    name = Path(path).stem
    source += f"""
model Driven
  {name}.Drivetrain drivetrain;
equation
  drivetrain.input_motor_torque = 0.3*sin(20*time) + 0.1*sin(133*time);
end Driven;
"""
    model = rumoca.Session(library).loads(source, model="Driven")
    result = model.simulate((0, 0.5), dt=2e-4, config=rumoca.SimConfig(solver="bdf", rtol=1e-8, atol=1e-10))
    spec = importlib.util.spec_from_file_location("exported", python)
    exported = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(exported)
    t = np.arange(0, 0.5, 2e-4)
    outputs = exported.simulate(t, [0.3 * np.sin(20 * t) + 0.1 * np.sin(133 * t)])
    time = np.array(result.time)
    for (name, *_), here in zip(exported.OUTPUTS, outputs):
        there = np.interp(t, time, result[f"drivetrain.reading_{name}"])
        difference = np.sqrt(np.mean((there - here) ** 2)) / np.std(here)
        print(f"{name} {difference:.1e}")
        assert difference < 1e-3, (name, difference)
