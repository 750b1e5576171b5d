"""Recordings watched against a model."""

import json
import os
from typing import Any, Unpack

from socam import _display, _socam
from socam.model import Model
from socam.options import WatchOptions
from socam.recording import Sources, several

__all__ = ["Watched", "watch"]


class Watched:
    """The result of `watch`."""

    __slots__ = ("_text", "document")

    def __init__(self, text: str) -> None:
        self._text = text
        #: The document `socam.watch/1`.
        self.document: dict[str, Any] = json.loads(text)

    @property
    def recordings(self) -> list[dict[str, Any]]:
        """What was seen in each recording: `baseline`, `alarms`, `returned`, `blocks_not_judged`."""
        return list(self.document["recordings"])

    @property
    def alarms(self) -> list[dict[str, Any]]:
        """Alarms of all recordings: `time_s`, `onset_s`, `channel`, `symptom`, `size_sigma`, and `naming` with the causes."""
        return [alarm for recording in self.recordings for alarm in recording["alarms"]]

    def to_json(self) -> str:
        """The document, as `socam-host watch --json` prints it."""
        return self._text

    def __repr__(self) -> str:
        return f"<Watched against {self.document['model']}: {len(self.alarms)} alarms in {len(self.recordings)} recordings>"

    def _repr_html_(self) -> str:
        rows = []
        for recording in self.recordings:
            for alarm in recording["alarms"]:
                causes = (alarm["naming"] or {"causes": []})["causes"]
                named = ", ".join(f"{one['effect']} at {one['location']} ({100 * one['share']:.0f} %)" for one in causes)
                times = [_display.number(alarm["time_s"]), _display.number(alarm["onset_s"])]
                rows.append([recording["recording"], *times, alarm["channel"], f"{alarm['size_sigma']:+.1f}", named])
        head = ["recording", "alarm, s", "change, s", "channel", "deviations", "causes"]
        return _display.items([repr(self)[1:-1]]) + _display.table(head, rows)


def watch(
    recordings: Sources,
    model: str | os.PathLike[str] | Model = "speed-o-cam",
    *,
    baseline: Sources = (),
    **options: Unpack[WatchOptions],
) -> Watched:
    """Watches recordings against a model, and raises an alarm where the bench departs from it.

    Parameters
    ----------
    recordings
        One recording or several, of whatever `read` takes.
    model
        A model, or what `Model` takes.
    baseline
        Recordings of the healthy bench. Default: the beginning of each recording.
    options
        Those of the command: `help(socam.options.WatchOptions)`.

    Raises
    ------
    FitError
        Where the model cannot be evaluated on the recordings, the healthy ones are too short, or a setting is out of its range.
    ModelError, RecordingError
        Where a file cannot be used.
    """
    return Watched(_socam.watch(several(recordings), Model(model)._inner, baseline=several(baseline), **options))
