"""The physics that a model lacks."""

import json
import os
from dataclasses import dataclass
from datetime import datetime
from typing import Any, Unpack

from socam import _display, _socam
from socam._progress import Progress, reporter
from socam.identification import HEAD, Parameter
from socam.model import Model
from socam.options import DiagnoseOptions
from socam.recording import Sources, several

__all__ = ["Diagnosis", "Finding", "diagnose"]


@dataclass(frozen=True, slots=True)
class Finding:
    """An effect that the model lacks, and its place. `entry` is all that the document says about it."""

    effect: str
    location: str
    equation: str
    sentence: str
    parameters: tuple[Parameter, ...]
    entry: dict[str, Any]

    @classmethod
    def of(cls, entry: dict[str, Any]) -> "Finding":
        """From an entry of a document."""
        parameters = tuple(map(Parameter.of, entry["parameters"]))
        return cls(entry["effect"], entry["location"], entry["equation"], entry["sentence"], parameters, entry)


class Diagnosis:
    """The result of `diagnose`."""

    __slots__ = ("_inner", "document")

    def __init__(self, inner: _socam.Diagnosis) -> None:
        self._inner = inner
        #: The document `socam.diagnosis/1`.
        self.document: dict[str, Any] = json.loads(inner.json())

    @property
    def verdict(self) -> str:
        """`adequate`, `missing_physics`, `unexplained`, or `not_judged` where the search was ended before anything was found."""
        return str(self.document["verdict"])

    @property
    def finished(self) -> bool:
        """Whether the search came to its own end within `budget_s`. Otherwise more may be missing than was found."""
        return bool(self.document["finished"])

    @property
    def unfinished(self) -> str | None:
        """When the search was ended before its own end, and what was not examined."""
        how: str | None = self.document.get("unfinished")
        return how

    @property
    def headline(self) -> str:
        """What was found and where, in one line, with all explanations that tie."""
        return self._inner.headline()

    @property
    def certainty(self) -> list[str]:
        """How sure that is, the most important sentence first."""
        return self._inner.certainty()

    @property
    def findings(self) -> list[Finding]:
        """What is missing, strongest first."""
        return [Finding.of(entry) for entry in self.document["findings"]]

    @property
    def candidates(self) -> list[dict[str, Any]]:
        """How far each effect came at each place, and why no further; with `trials` for those named in `why`. Empty for steady states."""
        return list(self.document.get("candidates", []))

    @property
    def warnings(self) -> list[str]:
        """What a careful reader should know."""
        return list(self.document["warnings"])

    @property
    def model(self) -> Model:
        """The corrected model; the model at its best fit where nothing was corrected."""
        return Model._of(self._inner.model())

    def drawing(self) -> str:
        """The bench with the places of the findings, as an SVG file."""
        return self._inner.drawing()

    def picture(self) -> str | None:
        """The most improved channel, measured and predicted before and after, as an SVG file; `None` without recordings over time."""
        return self._inner.picture()

    def report(self, folder: str | os.PathLike[str]) -> None:
        """Writes index.html, diagnosis.json and model.toml into a folder, which is made where it is not there.

        Raises
        ------
        SocamError
            Where they cannot be written.
        """
        date = datetime.now().astimezone().isoformat(sep=" ", timespec="seconds")
        self._inner.report(os.fspath(folder), date)

    def to_json(self) -> str:
        """The document, as `socam-host diagnose --json` prints it."""
        return self._inner.json()

    def __repr__(self) -> str:
        return f"<Diagnosis of {self.document['model']}: {self.headline}>"

    def _repr_html_(self) -> str:
        picture = self.picture()
        found = "".join(
            _display.items([f"{finding.effect} at {finding.location}: {finding.sentence}"])
            + _display.table(HEAD, (parameter.row() for parameter in finding.parameters))
            for finding in self.findings
        )
        return (
            _display.items([self.headline, *self.certainty])
            + _display.picture(self.drawing())
            + found
            + (_display.picture(picture) if picture else "")
            + _display.items(self.warnings)
        )


def diagnose(
    recordings: Sources,
    model: str | os.PathLike[str] | Model = "speed-o-cam",
    *,
    holdout: Sources = (),
    progress: Progress = False,
    **options: Unpack[DiagnoseOptions],
) -> Diagnosis:
    """Finds the physics that a model lacks, where it acts, and whether adding it improves predictions.

    Other threads of Python run meanwhile. Ctrl-C ends the call within a second.

    Parameters
    ----------
    recordings
        One recording or several, of whatever `read` takes.
    model
        A model, or what `Model` takes.
    holdout
        Recordings for validation, used in no fit and in no choice. Without them the result is not validated.
    progress
        `True` for a line on stderr, or a function that takes a line of text.
    options
        Those of the command: `help(socam.options.DiagnoseOptions)`.

    Raises
    ------
    FitError
        Where recordings and model do not go together.
    ModelError, RecordingError
        Where a file cannot be used.
    ValueError, TypeError
        For an option that cannot be meant.
    """
    held_out = several(holdout)
    return Diagnosis(
        _socam.diagnose(several(recordings), Model(model)._inner, holdout=held_out, progress=reporter(progress), **options)
    )
