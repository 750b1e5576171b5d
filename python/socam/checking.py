"""Whether recordings can carry a fit, before any fit."""

import json
import os
from dataclasses import dataclass
from typing import Any, Unpack

from socam import _display, _socam
from socam.model import Model
from socam.options import CheckOptions
from socam.recording import Source, read

__all__ = ["Check", "Remark", "check"]


@dataclass(frozen=True, slots=True)
class Remark:
    """What a check found: `severity` is `prevents`, `weakens` or `note`; `remedy` says what to record instead."""

    severity: str
    sentence: str
    remedy: str


class Check:
    """The result of `check`."""

    __slots__ = ("_text", "document")

    def __init__(self, text: str) -> None:
        self._text = text
        #: The recording's entry in the document `socam.check/1`.
        self.document: dict[str, Any] = json.loads(text)["recordings"][0]

    @property
    def verdict(self) -> str:
        """`fit`, `fit_with_reservations` or `unfit`."""
        return str(self.document["verdict"])

    @property
    def remarks(self) -> list[Remark]:
        """What was found, worst first."""
        return [Remark(**entry) for entry in self.document["sentences"]]

    def to_json(self) -> str:
        """The document, as `socam-host check --json` prints it."""
        return self._text

    def __repr__(self) -> str:
        return f"<Check of {self.document['recording']}: {self.verdict}>"

    def _repr_html_(self) -> str:
        rows = [[remark.severity, remark.sentence, remark.remedy] for remark in self.remarks]
        return _display.items([repr(self)[1:-1]]) + _display.table(["", "finding", "instead"], rows)


def check(
    recording: Source, model: str | os.PathLike[str] | Model | None = None, **options: Unpack[CheckOptions]
) -> Check:
    """Checks a recording: excitation of the input, speed ratios, saturated, stuck, noisy or humming sensors, missing rows.

    Parameters
    ----------
    recording
        A recording, or what `read` takes.
    model
        A model, or what `Model` takes: its channels are checked. Without one, all channels are.
    options
        Those of the command: `help(socam.options.CheckOptions)`; `ratio_tolerance` is a fraction.

    Raises
    ------
    RecordingError
        Where the recording cannot be read, or has no such input.
    FitError
        Where it has none of the model's channels.
    """
    inner = None if model is None else Model(model)._inner
    return Check(_socam.check([read(recording)._inner], inner, **options))
