"""A recording beside the output of a simulator."""

import json
import os
from pathlib import Path
from typing import Any, Unpack

from socam import _display, _socam
from socam.options import CompareOptions
from socam.recording import Source, read

__all__ = ["Comparison", "compare"]


class Comparison:
    """The result of `compare`: `verdict` is `agree` or `differ`."""

    __slots__ = ("_inner", "document")

    def __init__(self, inner: _socam.Comparison) -> None:
        self._inner = inner
        #: The document `socam.compare/1`.
        self.document: dict[str, Any] = json.loads(inner.json())

    @property
    def verdict(self) -> str:
        """`agree` where no channel differs, else `differ`."""
        return str(self.document["verdict"])

    @property
    def sentences(self) -> list[str]:
        """Where, when, at which speed and frequency both part."""
        return list(self.document["sentences"])

    @property
    def channels(self) -> dict[str, dict[str, Any]]:
        """By channel: `differs`, `error_rms` in SI, `error_share` of its standard deviation, `delay_s`, `gain`; the largest error first."""
        return {entry["name"]: entry for entry in self.document["channels"]}

    @property
    def warnings(self) -> list[str]:
        """What was left aside or is worth knowing."""
        return list(self.document["warnings"])

    def to_json(self) -> str:
        """The document, as `socam-host compare --json` prints it."""
        return self._inner.json()

    def report(self, folder: str | os.PathLike[str]) -> None:
        """Writes index.html and comparison.json into a folder."""
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        (target / "index.html").write_text(self._inner.page(["socam.compare"]), encoding="utf-8")
        (target / "comparison.json").write_text(self.to_json(), encoding="utf-8")

    def __repr__(self) -> str:
        return f"<Comparison of {self.document['recording']} with {self.document['simulation']}: {self.verdict}>"

    def _repr_html_(self) -> str:
        rows = [
            [name, entry["unit"], _display.number(entry["error_rms"]), f"{100 * entry['error_share']:.3g} %", "yes" if entry["differs"] else "no"]
            for name, entry in self.channels.items()
        ]
        head = ["channel", "unit", "rms of error", "of its deviation", "differs"]
        return _display.items([repr(self)[1:-1], *self.sentences]) + _display.table(head, rows) + _display.items(self.warnings)


def compare(recording: Source, simulation: Source, **options: Unpack[CompareOptions]) -> Comparison:
    """Compares a recording with the output of a simulator, without a model and without the sensors' noise.

    Parameters
    ----------
    recording, simulation
        What `read` takes. Channels of the same name and unit are compared.
    options
        Those of the command: `help(socam.options.CompareOptions)`. With `model`, the name of an embedded model or the path of a file, that
        model is simulated on the recording's inputs, too.

    Raises
    ------
    RecordingError
        Where a file cannot be read, or both have no channel or too little time in common.
    ValueError, TypeError
        For an option that cannot be meant.
    """
    return Comparison(_socam.compare(read(recording)._inner, read(simulation)._inner, **options))
