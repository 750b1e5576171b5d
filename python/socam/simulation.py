"""Simulations: the virtual bench on a profile, and a model driven by a recording's inputs."""

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, overload

from socam import _display, _socam
from socam.model import Model
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
    duration_s: float | None = ...,
    rate_hz: float = ...,
    values: Mapping[str, float] | None = ...,
    hide: Sequence[str] = ...,
    seed: int = ...,
    noise: bool = ...,
    name: str = ...,
) -> Recording: ...


@overload
def simulate(
    model: str | os.PathLike[str] | Model = ...,
    *,
    inputs: Source,
    values: Mapping[str, float] | None = ...,
    hide: Sequence[str] = ...,
    from_rest: bool = ...,
) -> Replay: ...


def simulate(
    model: str | os.PathLike[str] | Model = "speed-o-cam",
    profile: str | os.PathLike[str] = "multisine",
    *,
    inputs: Source | None = None,
    duration_s: float | None = None,
    rate_hz: float = 1000.0,
    values: Mapping[str, float] | None = None,
    hide: Sequence[str] = (),
    seed: int = 1,
    noise: bool = True,
    from_rest: bool = False,
    name: str = "simulation",
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
    duration_s
        Time until the command is back at 0, s. Default: the profile's.
    rate_hz
        Sampling rate, Hz.
    values
        Parameters of the virtual bench that differ from the model's, in SI.
    hide
        Physics that the bench has and the model does not name, as in `coulomb_friction@load_bearing:torque=0.3`.
    seed, noise
        Seed of the sensors' noise, and whether they have any. The same arguments give the same recording.
    from_rest
        With `inputs`: start at rest. Default: start states that fit the whole recording best.
    name
        The recording's name.

    Returns
    -------
    Recording or Replay
        A `Replay` where `inputs` are given.

    Raises
    ------
    SimulationError
        Where the bench ends the run, as at a limit, or the solver fails.
    ValueError
        For a profile, a rate, a parameter or an effect that cannot be meant.
    """
    model = Model(model)
    pairs = list((values or {}).items())
    if inputs is not None:
        recording, document = _socam.replay(
            model._inner, read(inputs)._inner, values=pairs, hide=list(hide), from_rest=from_rest
        )
        return Replay(Recording(recording), document)
    inner = _socam.simulate(
        model._inner,
        _profile(profile),
        name=name,
        duration_s=duration_s,
        rate_hz=rate_hz,
        values=pairs,
        hide=list(hide),
        seed=seed,
        noise=noise,
    )
    return Recording(inner)


def _profile(profile: str | os.PathLike[str]) -> str:
    """The name of a built-in profile, or the text of a profile file."""
    if isinstance(profile, str) and (profile in profiles() or "\n" in profile):
        return profile
    try:
        return Path(profile).read_text(encoding="utf-8")
    except OSError as error:
        names = ", ".join(profiles())
        raise ValueError(f"profile: `{profile}` is neither a file nor built in ({names}): {error}") from None
