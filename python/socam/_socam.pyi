"""
The compiled half of the package `socam`.
"""

from _typeshed import SupportsGetItem, SupportsLenAndGetItem
from os import PathLike
from pathlib import Path
from typing import Any, Final, SupportsFloat, SupportsIndex, final

__all__ = ["VERSION", "Column", "Comparison", "Diagnosis", "FleetPart", "FleetRow", "FleetSummary", "FleetTask", "Identification", "Model", "Recording", "check", "compare", "described", "design", "diagnose", "expand", "fleet_list", "fleet_sources", "frf", "identify", "is_recording", "profiles", "replay", "simulate", "watch"]

VERSION: Final[str]
"""
Version of the package.
"""

@final
class Column:
    """
    Values of one column in the memory of the recording, for `numpy.asarray`.
    """
    @property
    def __array_interface__(self, /) -> dict[str, Any]:
        """
        Address, type and length, from which numpy makes a read-only array.
        """
    def __len__(self, /) -> int: ...

@final
class Comparison:
    """
    A recording compared with a simulation.
    """
    def json(self, /) -> str:
        """
        The document `socam.compare/1`, as `socam-host compare --json` prints it.
        """
    def page(self, /, about: SupportsGetItem[int, str]) -> str:
        """
        A page about the comparison; `about` are lines about its origin.
        """

@final
class Diagnosis:
    """
    The result of a diagnosis.
    """
    def certainty(self, /) -> list[str]:
        """
        Sentences about the certainty of the findings, the most important first.
        """
    def drawing(self, /) -> str:
        """
        The bench with the places of the findings, as SVG.
        """
    def headline(self, /) -> str:
        """
        The findings in one line.
        """
    def json(self, /) -> str:
        """
        The document `socam.diagnosis/1`, as `socam-host diagnose --json` prints it.
        """
    def model(self, /) -> Model:
        """
        The corrected model.
        """
    def picture(self, /) -> str | None:
        """
        The most improved channel, measured and predicted, as SVG.
        """
    def report(self, /, folder: str | PathLike[str], date: str) -> None:
        """
        Writes index.html, diagnosis.json and model.toml into a folder; the page shows `date` unchanged.
        """

@final
class FleetPart:
    """
    The part file beside a table: finished rows, kept for a restart.
    """
    def __new__(cls, /, task: FleetTask, target: str | PathLike[str]) -> FleetPart:
        """
        Opens the part file of a table, and takes over the rows of an earlier table.
        """
    def append(self, /, row: bytes) -> tuple[str, str]:
        """
        Appends a row, and returns its name and id.
        """
    def finish(self, /, wanted: SupportsGetItem[int, tuple[str, str]]) -> int:
        """
        Writes the table of these rows, by names and ids, and removes the part file. Returns their number.
        """
    def known(self, /) -> list[tuple[str, str]]:
        """
        Names and ids of the finished rows.
        """

@final
class FleetRow:
    """
    The row of one recording, `socam.fleet/1`.
    """
    def __arrow_c_stream__(self, /, requested_schema: Any | None = None) -> "object":
        """
        The row as an Arrow stream of one batch.
        """
    @property
    def id(self, /) -> str:
        """
        Hash of the recording's bytes, the model, the options, the seed and the version.
        """
    def json(self, /) -> str:
        """
        The row as JSON.
        """
    def to_bytes(self, /) -> bytes:
        """
        The row as bytes, for a part file.
        """

@final
class FleetSummary:
    """
    The summary of a table.
    """
    def __new__(cls, /, table: str | PathLike[str], fdr: SupportsFloat | SupportsIndex) -> FleetSummary:
        """
        Summarises a table; its lists have this false discovery rate.
        """
    def json(self, /) -> str:
        """
        The document `socam.fleet-summary/1`, as `socam-host fleet --json` prints it.
        """
    def page(self, /, about: SupportsGetItem[int, str]) -> str:
        """
        The fleet's page; `about` are lines about its origin.
        """

@final
class FleetTask:
    """
    The settings of all rows of a table: a model, options and a seed.
    """
    def __new__(cls, /, model: Model, options: str, seed: SupportsIndex) -> FleetTask:
        """
        Makes a task from a model and options as JSON; options that the text does not name have their defaults.
        """
    def options(self, /) -> str:
        """
        The options as JSON.
        """
    def reference(self, /, named: SupportsGetItem[int, tuple[str, str | PathLike[str]]]) -> str | None:
        """
        The result of healthy recordings as JSON: the option `frozen` of a task, by which all others are screened. Names are used in errors.
        """
    def row(self, /, name: str, *, content: bytes | None = None, path: str | PathLike[str] | None = None, problem: str | None = None, machine: str | None = None, date_ms: SupportsIndex | None = None, known: SupportsGetItem[int, str] | None = None) -> tuple[str, FleetRow | None]:
        """
        Diagnoses one recording, given as bytes or as a path. Returns its id, and its row unless `known` contains the id. If the caller
        could not fetch the recording, `problem` is the reason, and its row contains it.
        """

@final
class Identification:
    """
    The result of a fit.
    """
    def json(self, /) -> str:
        """
        The document `socam.identification/1`, as `socam-host identify --json` prints it.
        """
    def model(self, /) -> Model:
        """
        The model file with the identified values.
        """

@final
class Model:
    """
    A drivetrain's model file, checked and in SI.
    """
    def __new__(cls, /, text: str) -> Model:
        """
        Reads the text of a model file.
        """
    @staticmethod
    def builtin_names() -> list[str]:
        """
        Names of the embedded models.
        """
    @staticmethod
    def builtin_text(name: str) -> str | None:
        """
        Text of an embedded model.
        """
    def changed(self, /, **options: "object") -> Model:
        """
        The model with other values of parameters, with fixed parameters, and with other intersample behaviour of its inputs: the options
        `start_values`, `fixed` and `between` of every task.
        """
    @property
    def channels(self, /) -> list[tuple[str, str, bool]]:
        """
        Channels: name, column of a recording, and whether it drives the model.
        """
    @property
    def description(self, /) -> str:
        """
        The model's description.
        """
    def drawing(self, /) -> str:
        """
        The bench as SVG.
        """
    @property
    def name(self, /) -> str:
        """
        The model's name.
        """
    def parameters_json(self, /) -> str:
        """
        Parameters as a JSON list: name, value in SI, unit, fixed, source.
        """
    @property
    def text(self, /) -> str:
        """
        The file's text.
        """
    def with_effect(self, /, effect: str, place: str, values: SupportsGetItem[int, tuple[str, SupportsFloat | SupportsIndex]]) -> Model:
        """
        The model with an effect of the catalogue at a place, its parameters in SI.
        """

@final
class Recording:
    """
    A recording over time: channels in SI units and their samples.
    """
    def __arrow_c_stream__(self, /, requested_schema: Any | None = None) -> "object":
        """
        The columns as an Arrow stream, `t_s` first, without copies.
        """
    def channel_index(self, /, name: str) -> int:
        """
        Index of a channel, by its name or its column's name.
        """
    @property
    def channels(self, /) -> list[tuple[str, str]]:
        """
        Column names, with the unit's suffix, and symbols of the units.
        """
    def column(self, /, channel: SupportsIndex | None = None) -> Column:
        """
        The values of a channel by its index, or the times.
        """
    @property
    def end_s(self, /) -> float:
        """
        Time of the last row, s.
        """
    @staticmethod
    def from_bytes(name: str, content: bytes) -> Recording:
        """
        Opens a file that is in memory. Its format is determined from its content.
        """
    @staticmethod
    def from_columns(name: str, time_s: "object", columns: "list[tuple[str, object]]") -> Recording:
        """
        Makes a recording of columns: times in s, and values by column names that end in their unit, NaN where a value is missing.
        """
    @property
    def is_complete(self, /) -> bool:
        """
        Whether the file is whole: not cut off, nothing damaged, no sample lost.
        """
    @property
    def lost_samples(self, /) -> int:
        """
        Number of samples lost while recording.
        """
    @property
    def name(self, /) -> str:
        """
        Name in results.
        """
    @staticmethod
    def open(run: str) -> Recording:
        """
        Opens a file of any format, or a part of it: `RUN@FROM..TO` in seconds or clock times.
        """
    @property
    def rows(self, /) -> int:
        """
        Number of rows.
        """
    @property
    def sample_time_s(self, /) -> float:
        """
        Median step of time, s.
        """
    @property
    def segments(self, /) -> list[int]:
        """
        First row of each part without gaps.
        """
    @property
    def start_s(self, /) -> float:
        """
        Time of the first row, s.
        """
    @property
    def warnings(self, /) -> list[str]:
        """
        Warnings about parts that were not read and about missing samples.
        """
    def write(self, /, path: str | PathLike[str]) -> None:
        """
        Writes the recording as .csv or .mcap.
        """

def check(recordings: SupportsGetItem[int, Recording], model: Model | None = None, **options: "object") -> str:
    """
    Checks recordings before any fit: the document `socam.check/1`. Without a model all channels are checked.
    """

def compare(recording: Recording, simulation: Recording, **options: "object") -> Comparison:
    """
    Compares a recording with the output of a simulator: channels of the same name and unit, and the given pairs of channels.
    """

def described(task: str) -> str:
    """
    The options of a task as a JSON list: name, flag, kind, default, choices, help.
    """

def design(model: Model, recordings: SupportsGetItem[int, Recording], *, rival: Model | None, names: SupportsLenAndGetItem[str], progress: "object" = None, **options: "object") -> str:
    """
    Proposes the next experiment: the document `socam.design/1`.
    """

def diagnose(recordings: SupportsGetItem[int, Recording], model: Model, *, holdout: SupportsGetItem[int, Recording], progress: "object" = None, **options: "object") -> Diagnosis:
    """
    Finds the physics that a model lacks, by recordings.
    """

def expand(run: str) -> list[str]:
    """
    Names of recordings, with the wildcards of this one expanded.
    """

def fleet_list(place: str | PathLike[str], content: bytes) -> list[tuple[str, Path, str | None, int | None]]:
    """
    The recordings of a CSV list that was fetched from `place`, in the form of `fleet_sources`.
    """

def fleet_sources(place: str | PathLike[str]) -> list[tuple[str, Path, str | None, int | None]]:
    """
    The recordings of a folder, or of a CSV list with the columns file, machine and date: name, path, machine, date in ms since 1970.
    """

def frf(recordings: SupportsGetItem[int, Recording], model: Model, **options: "object") -> tuple[str, list[tuple[list[str], list[tuple[str, str]]]], list[str]]:
    """
    Frequency responses: the document `socam.frequency-response/1`, the results for each output, and warnings and notes about all outputs.
    """

def identify(recordings: SupportsGetItem[int, Recording], model: Model, *, holdout: SupportsGetItem[int, Recording], progress: "object" = None, **options: "object") -> Identification:
    """
    Fits the free parameters of a model to recordings.
    """

def is_recording(name: str | PathLike[str]) -> bool:
    """
    Whether a file of this name in a folder counts as a recording.
    """

def profiles() -> list[str]:
    """
    Names of the built-in profiles.
    """

def replay(model: Model, inputs: Recording, **options: "object") -> tuple[Recording, str]:
    """
    Drives a model by the inputs of a recording. Returns the simulated recording, and its errors as the document `socam.comparison/1`.
    """

def simulate(model: Model, profile: str, *, name: str, **options: "object") -> Recording:
    """
    Records a profile (its name, or the text of a profile file) on the virtual bench of a model.
    """

def watch(recordings: SupportsGetItem[int, Recording], model: Model, *, baseline: SupportsGetItem[int, Recording], **options: "object") -> str:
    """
    Monitors recordings against a model: the document `socam.watch/1`.
    """
