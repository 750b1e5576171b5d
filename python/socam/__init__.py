"""Identifies drivetrains from recordings, and names the physics that their models lack.

    import socam

    recording = socam.read("run.mcap")
    result = socam.identify(recording, "bench.toml", fixed={"k3": 52485.0})
    diagnosis = socam.diagnose(recording, "bench.toml")
    diagnosis.report("report")

All quantities are SI. Names end in their unit. The functions are the commands of `socam-host` and give the same numbers.
"""

from socam._socam import VERSION as __version__
from socam.checking import Check, check
from socam.diagnosis import Diagnosis, Finding, diagnose
from socam.errors import FitError, ModelError, RecordingError, SimulationError, SocamError
from socam.experiment import Design, design
from socam.identification import Identification, Parameter, identify
from socam.model import Model, ModelParameter
from socam.recording import Recording, read
from socam.simulation import Replay, profiles, simulate

__all__ = [
    "Check",
    "Design",
    "Diagnosis",
    "Finding",
    "FitError",
    "Identification",
    "Model",
    "ModelError",
    "ModelParameter",
    "Parameter",
    "Recording",
    "RecordingError",
    "Replay",
    "SimulationError",
    "SocamError",
    "__version__",
    "check",
    "design",
    "diagnose",
    "identify",
    "profiles",
    "read",
    "simulate",
]
