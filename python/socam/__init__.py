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
from socam.comparison import Comparison, compare
from socam.diagnosis import Diagnosis, Finding, diagnose
from socam.errors import FitError, ModelError, RecordingError, SimulationError, SocamError
from socam.experiment import Design, design
from socam.identification import Identification, Parameter, identify
from socam.model import Model, ModelParameter
from socam.recording import Recording, read
from socam.response import FrequencyResponse, Response, frf
from socam.simulation import Replay, profiles, simulate
from socam.watching import Watched, watch

__all__ = [
    "Check",
    "Comparison",
    "Design",
    "Diagnosis",
    "Finding",
    "FitError",
    "FrequencyResponse",
    "Identification",
    "Model",
    "ModelError",
    "ModelParameter",
    "Parameter",
    "Recording",
    "RecordingError",
    "Replay",
    "Response",
    "SimulationError",
    "SocamError",
    "Watched",
    "__version__",
    "check",
    "compare",
    "design",
    "diagnose",
    "frf",
    "identify",
    "profiles",
    "read",
    "simulate",
    "watch",
]
