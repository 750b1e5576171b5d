"""The next experiment."""

import json
import os
from pathlib import Path
from typing import Any, Unpack

from socam import _display, _socam
from socam._progress import Progress, reporter
from socam.model import Model
from socam.options import DesignOptions
from socam.recording import Sources, several

__all__ = ["Design", "design"]


class Design:
    """A proposal: `profile` is the text of a profile file, which `simulate` and `socam-host record` run."""

    __slots__ = ("_text", "document")

    def __init__(self, text: str) -> None:
        self._text = text
        #: The document `socam.design/1`.
        self.document: dict[str, Any] = json.loads(text)

    @property
    def profile(self) -> str:
        """The profile file's text."""
        return str(self.document["profile"])

    @property
    def widths(self) -> dict[str, float | None]:
        """Half-widths of the 95 % intervals to expect, relative to their parameters; `None` where nothing is determined."""
        return {entry["name"]: entry["relative"] for entry in self.document["widths"]}

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes the profile file."""
        Path(path).write_text(self.profile, encoding="utf-8")

    def to_json(self) -> str:
        """The document, as `socam-host design --json` prints it."""
        return self._text

    def __repr__(self) -> str:
        return f"<Design: the best of {self.document['tried']} profiles>"

    def _repr_html_(self) -> str:
        known = {entry["name"]: entry["relative"] for entry in self.document["reference"] or []}

        def percent(share: float | None) -> str:
            return "not determined" if share is None else f"±{100 * share:.3g} %"

        rows = [[name, percent(width), percent(known.get(name))] for name, width in self.widths.items()]
        return _display.items([repr(self)[1:-1]]) + _display.table(["95 % interval", "proposed", "five steps"], rows)


def design(
    model: str | os.PathLike[str] | Model = "speed-o-cam",
    recordings: Sources = (),
    *,
    rival: str | os.PathLike[str] | Model | None = None,
    progress: Progress = False,
    **options: Unpack[DesignOptions],
) -> Design:
    """Proposes the next experiment: the most informative profile within the rig's limits.

    Parameters
    ----------
    model
        A model, or what `Model` takes.
    recordings
        Existing recordings, whose information is taken into account.
    rival
        A competing model: the profile then tells both apart. Without it, it makes the widest interval narrowest.
    progress
        `True` for a line on stderr, or a function that takes a line of text.
    options
        Those of the command: `help(socam.options.DesignOptions)`.

    Raises
    ------
    SimulationError
        Where no profile keeps the limits, or the bench cannot be simulated.
    ValueError, TypeError
        For an option that cannot be meant.
    """
    own, other = Model(model), None if rival is None else Model(rival)
    inner, names = None if other is None else other._inner, (own.name, "" if other is None else other.name)
    return Design(
        _socam.design(own._inner, several(recordings), rival=inner, names=names, progress=reporter(progress), **options)
    )
