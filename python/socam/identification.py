"""Parameters with intervals, from recordings and a model."""

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack

from socam import _display, _socam
from socam._progress import Progress, reporter
from socam.model import Model
from socam.options import IdentifyOptions
from socam.recording import Sources, several

if TYPE_CHECKING:
    import pandas

__all__ = ["Identification", "Parameter", "identify"]


@dataclass(frozen=True, slots=True)
class Parameter:
    """An estimate, in SI. A value or an end of its 95 % interval that the data do not determine is `None`."""

    name: str
    value: float | None
    unit: str
    low: float | None
    high: float | None
    std: float | None = None
    determined: bool = True
    source: str = "data"
    note: str = ""

    @classmethod
    def of(cls, entry: Mapping[str, Any]) -> "Parameter":
        """From an entry of a document."""
        low, high = entry["ci95"]
        value = entry["value"]
        return cls(
            name=entry["name"],
            value=value,
            unit=entry["unit"],
            low=low,
            high=high,
            std=entry.get("std"),
            determined=entry.get("identifiable", value is not None),
            source=entry.get("source", "data"),
            note=entry.get("note", ""),
        )

    def row(self) -> list[str]:
        """Cells of a table."""
        shown = self.value if self.determined else None
        return [self.name, _display.number(shown), self.unit, _display.interval(self.low, self.high), self.note]


HEAD = ["parameter", "value", "unit", "95 % interval", ""]


class Identification:
    """The result of `identify`. `result["k4"]` is a parameter, or a combination that is determined where its parts are not."""

    __slots__ = ("_inner", "document")

    def __init__(self, inner: _socam.Identification) -> None:
        self._inner = inner
        #: The document `socam.identification/1`.
        self.document: dict[str, Any] = json.loads(inner.json())

    @property
    def parameters(self) -> dict[str, Parameter]:
        """All parameters of the model by name, in its order."""
        return {entry["name"]: Parameter.of(entry) for entry in self.document["parameters"]}

    @property
    def combinations(self) -> dict[str, Parameter]:
        """Combinations of parameters that the recordings determine, by name."""
        return {entry["name"]: Parameter.of(entry) for entry in self.document["combinations"]}

    def __getitem__(self, name: str) -> Parameter:
        return (self.parameters | self.combinations)[name]

    @property
    def converged(self) -> bool:
        """Whether the estimate is a minimum."""
        return bool(self.document["converged"])

    @property
    def finished(self) -> bool:
        """Whether the search came to its own end within `budget_s`. Otherwise the values are those of the best point by then."""
        return bool(self.document["finished"])

    @property
    def unfinished(self) -> str | None:
        """When the search was ended before its own end, and what was not tried."""
        how: str | None = self.document.get("unfinished")
        return how

    @property
    def fit(self) -> dict[str, dict[str, float]]:
        """By channel: `rms` and `noise_std` in SI, `fit_percent` and others, running free over all recordings."""
        channels: dict[str, dict[str, float]] = self.document["fit"]["channels"]
        return channels

    @property
    def validation(self) -> list[dict[str, Any]]:
        """The fit of each held-out recording."""
        held_out: list[dict[str, Any]] = self.document["validation"]
        return held_out

    @property
    def warnings(self) -> list[str]:
        """What a careful reader should know."""
        return list(self.document["warnings"])

    @property
    def advice(self) -> list[str]:
        """Sensors and experiments that would settle what has no number."""
        return list(self.document["advice"])

    @property
    def model(self) -> Model:
        """The model with the identified values."""
        return Model._of(self._inner.model())

    def to_json(self) -> str:
        """The document, as `socam-host identify --json` prints it."""
        return self._inner.json()

    def to_pandas(self) -> "pandas.DataFrame":
        """A row for each parameter and combination, in SI."""
        import pandas

        every = (self.parameters | self.combinations).values()
        columns = ("name", "value", "unit", "low", "high", "std", "determined", "source", "note")
        return pandas.DataFrame({name: [getattr(one, name) for one in every] for name in columns}).set_index("name")

    def __repr__(self) -> str:
        determined = [p for p in self.parameters.values() if p.determined and p.source != "fixed"]
        values = ", ".join(f"{p.name} = {_display.number(p.value)} {p.unit}" for p in determined)
        return f"<Identification of {self.document['model']}: {values or 'nothing determined'}>"

    def _repr_html_(self) -> str:
        estimates = (self.parameters | self.combinations).values()
        fits = [
            [name, _display.number(fit["rms"]), _display.number(fit["noise_std"]), f"{fit['fit_percent']:.2f} %"]
            for name, fit in self.fit.items()
        ]
        return (
            _display.items([repr(self)[1:-1].split(":")[0]])
            + _display.table(HEAD, (one.row() for one in estimates))
            + _display.table(["channel", "residual rms", "noise", "fit"], fits)
            + _display.items(self.warnings + self.advice)
        )


def identify(
    recordings: Sources,
    model: str | os.PathLike[str] | Model = "speed-o-cam",
    *,
    holdout: Sources = (),
    progress: Progress = False,
    **options: Unpack[IdentifyOptions],
) -> Identification:
    """Identifies stiffness, damping and friction: fits the free parameters of a model to all recordings together.

    Other threads of Python run meanwhile. Ctrl-C ends the call within a second.

    Parameters
    ----------
    recordings
        One recording or several, of whatever `read` takes.
    model
        A model, or what `Model` takes.
    holdout
        Recordings that are predicted with the result and not fitted.
    progress
        `True` for a line on stderr, or a function that takes a line of text.
    options
        Those of the command: `help(socam.options.IdentifyOptions)`. `method` is `output-error` or `inverse-dynamics`; `frf` is a function of
        its own.

    Raises
    ------
    FitError
        Where recordings and model do not go together. Not converged and not determined are results, not errors.
    ModelError, RecordingError
        Where a file cannot be used.
    ValueError, TypeError
        For an option that cannot be meant.
    """
    held_out = several(holdout)
    return Identification(
        _socam.identify(several(recordings), Model(model)._inner, holdout=held_out, progress=reporter(progress), **options)
    )
