"""Simulations: the virtual bench on a profile, and a model driven by a recording's inputs."""

import json
import os
from pathlib import Path
from typing import Any, Unpack, overload

from socam import _display, _socam
from socam.model import Model
from socam.options import SimulateOptions
from socam.recording import Recording, Source, read

__all__ = ["Replay", "profiles", "simulate"]


def profiles() -> list[str]:
    """Names of the built-in profiles."""
    return _socam.profiles()


class Replay:
    """A model driven by a recording's inputs: `recording` is what it predicts, `channels` how that differs from the measurement."""

    __slots__ = ("document", "recording")

    def __init__(self, recording: Recording, document: str) -> None:
        #: The model's inputs and predicted outputs.
        self.recording = recording
        #: The document `socam.comparison/1`.
        self.document: dict[str, Any] = json.loads(document)

    @property
    def channels(self) -> dict[str, dict[str, Any]]:
        """By channel: `rms` and `max` of the error in SI, and `relative_percent` of the channel's standard deviation."""
        return {entry["channel"]: entry for entry in self.document["channels"]}

    def __repr__(self) -> str:
        errors = ", ".join(f"{name} {entry['relative_percent']:.3g} %" for name, entry in self.channels.items())
        return f"<Replay of {self.document['input']} by {self.document['model']}: error {errors}>"

    def _repr_html_(self) -> str:
        rows = [
            [name, entry["unit"], _display.number(entry["rms"]), _display.number(entry["max"]), f"{entry['relative_percent']:.3g} %"]
            for name, entry in self.channels.items()
        ]
        return _display.table(["channel", "unit", "error rms", "error max", "relative"], rows)


@overload
def simulate(
    model: str | os.PathLike[str] | Model = ...,
    profile: str | os.PathLike[str] = ...,
    *,
    name: str = ...,
    **options: Unpack[SimulateOptions],
) -> Recording: ...


@overload
def simulate(
    model: str | os.PathLike[str] | Model = ..., *, inputs: Source, **options: Unpack[SimulateOptions]
) -> Replay: ...


def simulate(
    model: str | os.PathLike[str] | Model = "speed-o-cam",
    profile: str | os.PathLike[str] = "multisine",
    *,
    inputs: Source | None = None,
    name: str = "simulation",
    **options: Unpack[SimulateOptions],
) -> Recording | Replay:
    """Records the virtual bench of a model on a profile; or, with `inputs`, drives the model by the inputs of a recording.

    Parameters
    ----------
    model
        A model, or what `Model` takes.
    profile
        A built-in profile (`profiles()`), the path of a profile file, or its text.
    inputs
        A recording whose inputs drive the model; its outputs are compared with the predictions.
    name
        The recording's name.
    options
        Those of the command: `help(socam.options.SimulateOptions)`. `duration_s`, `rate_hz`, `seed` and `noise` are for a profile, `between`,
        `disturb` and `from_rest` for inputs. The same arguments give the same recording.

    Returns
    -------
    Recording or Replay
        A `Replay` where `inputs` are given.

    Raises
    ------
    SimulationError
        Where the bench ends the run, as at a limit, or the solver fails.
    ValueError, TypeError
        For a profile or an option that cannot be meant.
    """
    own = Model(model)._inner
    if inputs is not None:
        recording, document = _socam.replay(own, read(inputs)._inner, **options)
        return Replay(Recording(recording), document)
    return Recording(_socam.simulate(own, _profile(profile), name=name, **options))


def _profile(profile: str | os.PathLike[str]) -> str:
    """The name of a built-in profile, or the text of a profile file."""
    if isinstance(profile, str) and (profile in profiles() or "\n" in profile):
        return profile
    try:
        return Path(profile).read_text(encoding="utf-8")
    except OSError as error:
        names = ", ".join(profiles())
        raise ValueError(f"profile: `{profile}` is neither a file nor built in ({names}): {error}") from None
