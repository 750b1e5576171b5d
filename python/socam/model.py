"""Models of drivetrains."""

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from socam import _display, _socam
from socam.errors import ModelError

__all__ = ["Fixed", "Model", "ModelParameter"]

Fixed: TypeAlias = Mapping[str, float] | Iterable[str]


@dataclass(frozen=True, slots=True)
class ModelParameter:
    """A parameter of a model: its value in SI, the unit, whether it is known and not fitted, and where the value comes from."""

    name: str
    value: float
    unit: str
    fixed: bool
    source: str


class Model:
    """A drivetrain's model.

    Parameters
    ----------
    source
        The name of an embedded model (`Model.embedded()` lists them), the path of a model file, or a model file's text.

    Raises
    ------
    ModelError
        Where there is no such model, or the file has a mistake: the message names the line.
    """

    __slots__ = ("_inner",)
    _inner: _socam.Model

    def __init__(self, source: "str | os.PathLike[str] | Model") -> None:
        self._inner = source._inner if isinstance(source, Model) else _socam.Model(_text(source))

    @staticmethod
    def embedded() -> list[str]:
        """Names of the embedded models."""
        return _socam.Model.builtin_names()

    @classmethod
    def _of(cls, inner: _socam.Model) -> "Model":
        model = cls.__new__(cls)
        model._inner = inner
        return model

    @property
    def name(self) -> str:
        """The model's name."""
        return self._inner.name

    @property
    def description(self) -> str:
        """What it describes."""
        return self._inner.description

    @property
    def text(self) -> str:
        """The model file's text. Values that `set` and `fix` gave are not in it."""
        return self._inner.text

    @property
    def parameters(self) -> dict[str, ModelParameter]:
        """Parameters by name, in SI."""
        return {entry["name"]: ModelParameter(**entry) for entry in json.loads(self._inner.parameters_json())}

    @property
    def inputs(self) -> list[str]:
        """Columns of a recording that drive the model."""
        return [column for _, column, is_input in self._inner.channels if is_input]

    @property
    def outputs(self) -> list[str]:
        """Columns of a recording that the model predicts."""
        return [column for _, column, is_input in self._inner.channels if not is_input]

    def set(self, values: Mapping[str, float]) -> "Model":
        """The model with other values of parameters, in SI, from which a fit starts."""
        return Model._of(self._inner.changed(start_values=values))

    def fix(self, parameters: Fixed) -> "Model":
        """The model with parameters held: at the given values in SI, or, of a list of names, at their own."""
        return Model._of(self._inner.changed(fixed=parameters))

    def between(self, kind: str | Mapping[str, str]) -> "Model":
        """The model with how its inputs move between samples: `auto`, `hold`, `linear` or `band-limited`, for all or by input."""
        return Model._of(self._inner.changed(between=kind))

    def with_effect(self, effect: str, place: str, **values: float) -> "Model":
        """The model with an effect of the catalogue at a place, as in `with_effect("coulomb_friction", "load_bearing", torque=0.3)`."""
        return Model._of(self._inner.with_effect(effect, place, list(values.items())))

    def drawing(self) -> str:
        """The bench as an SVG file."""
        return self._inner.drawing()

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes the model file."""
        Path(path).write_text(self.text, encoding="utf-8")

    def __repr__(self) -> str:
        return f"<Model {self.name}: {self.description}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Model) and (self.text, self.parameters) == (other.text, other.parameters)

    def __hash__(self) -> int:
        return hash(self.text)

    def __reduce__(self) -> tuple[object, tuple[str, dict[str, float], list[str]]]:
        every = self.parameters.values()
        return _rebuilt, (self.text, {p.name: p.value for p in every}, [p.name for p in every if p.fixed])

    def _repr_html_(self) -> str:
        rows = [[p.name, _display.number(p.value), p.unit, "fixed" if p.fixed else ""] for p in self.parameters.values()]
        head = ["parameter", "value", "unit", ""]
        return _display.items([repr(self)[1:-1]]) + _display.picture(self.drawing()) + _display.table(head, rows)


def _rebuilt(text: str, values: dict[str, float], fixed: list[str]) -> Model:
    return Model(text).set(values).fix(fixed)


def _text(source: str | os.PathLike[str]) -> str:
    if isinstance(source, str):
        embedded = _socam.Model.builtin_text(source)
        if embedded is not None:
            return embedded
        if "\n" in source:
            return source
    try:
        return Path(source).read_text(encoding="utf-8")
    except FileNotFoundError:
        names = ", ".join(Model.embedded())
        raise ModelError(f"there is no model file `{source}`, and embedded models are {names}") from None
    except (OSError, UnicodeDecodeError) as error:
        raise ModelError(f"cannot read the model file `{source}`: {error}") from None
