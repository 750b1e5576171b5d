"""Frequency responses, without parameters."""

import json
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import NDArray

from socam import _display, _socam
from socam.model import Model
from socam.options import ResponseOptions
from socam.recording import Sources, several

if TYPE_CHECKING:
    import pandas

__all__ = ["FrequencyResponse", "Response", "frf"]


class Response:
    """The response of one output: arrays of shape (lines,) over rising frequency, intervals of shape (lines, 2)."""

    __slots__ = ("document", "pictures", "sentences")

    def __init__(self, document: dict[str, Any], sentences: list[str], pictures: dict[str, str]) -> None:
        #: The output's entry in the document `socam.frequency-response/1`.
        self.document = document
        #: What the lines say that nothing excites.
        self.sentences = sentences
        #: Drawings as SVG: `magnitude`, `phase`, `coherence`, and `lines` where distortion can be told from noise.
        self.pictures = pictures

    def _column(self, name: str) -> NDArray[np.float64]:
        return np.array([line[name] for line in self.document["lines"]], dtype=np.float64)

    @property
    def output(self) -> str:
        """Name of the output."""
        return str(self.document["output"])

    @property
    def input(self) -> str:
        """Name of the input."""
        return str(self.document["input"])

    @property
    def unit(self) -> str:
        """Unit of `response`, `magnitude`, `model` and `std`: that of the output per that of the input."""
        return f"({self.document['unit']})/({self.document['input_unit']})"

    @property
    def frequency_hz(self) -> NDArray[np.float64]:
        """Frequencies, Hz."""
        return self._column("frequency_hz")

    @property
    def response(self) -> NDArray[np.complex128]:
        """The estimate, in `unit`."""
        return self._column("re") + 1j * self._column("im")

    @property
    def model(self) -> NDArray[np.complex128]:
        """The model's own response, in `unit`."""
        return self._column("model_re") + 1j * self._column("model_im")

    @property
    def magnitude(self) -> NDArray[np.float64]:
        """Size of the estimate, in `unit`."""
        return self._column("magnitude")

    @property
    def magnitude_ci95(self) -> NDArray[np.float64]:
        """95 % interval of the magnitude, in `unit`."""
        return self._column("magnitude_ci95")

    @property
    def phase_deg(self) -> NDArray[np.float64]:
        """Phase of the estimate, degrees, -180 to 180."""
        return self._column("phase_deg")

    @property
    def phase_ci95_deg(self) -> NDArray[np.float64]:
        """95 % interval of the phase, degrees."""
        return self._column("phase_ci95_deg")

    @property
    def std(self) -> NDArray[np.float64]:
        """Root mean square of the complex error, in `unit`; NaN where it is not known."""
        return self._column("std")

    @property
    def coherence(self) -> NDArray[np.float64]:
        """Share of the power of both signals that is linearly related, 0 to 1."""
        return self._column("coherence")

    def to_pandas(self) -> "pandas.DataFrame":
        """A row for each line, in the columns of the document; intervals in two."""
        import pandas

        rows = []
        for line in self.document["lines"]:
            low, high = line["magnitude_ci95"]
            phase_low, phase_high = line["phase_ci95_deg"]
            single = {name: value for name, value in line.items() if not isinstance(value, list)}
            ends = {"magnitude_low": low, "magnitude_high": high, "phase_low_deg": phase_low, "phase_high_deg": phase_high}
            rows.append(single | ends)
        return pandas.DataFrame(rows).set_index("frequency_hz")

    def __repr__(self) -> str:
        hz = self.frequency_hz
        return f"<Response of {self.output} per {self.input}: {hz.size} lines, {hz[0]:.4g} to {hz[-1]:.4g} Hz>"

    def _repr_html_(self) -> str:
        return _display.items([repr(self)[1:-1], *self.sentences]) + "".join(map(_display.picture, self.pictures.values()))


class FrequencyResponse:
    """The result of `frf`: `result["output_speed"]` is the response of an output."""

    __slots__ = ("_text", "document", "outputs", "warnings")

    def __init__(self, text: str, seen: Sequence[tuple[list[str], list[tuple[str, str]]]], warnings: list[str]) -> None:
        self._text = text
        #: The document `socam.frequency-response/1`.
        self.document: dict[str, Any] = json.loads(text)
        #: Responses by the names of their outputs.
        self.outputs: dict[str, Response] = {
            entry["output"]: Response(entry, sentences, dict(pictures))
            for entry, (sentences, pictures) in zip(self.document["outputs"], seen, strict=True)
        }
        #: What a careful reader should know, and what was done to the signals.
        self.warnings = list(dict.fromkeys(warnings))

    def __getitem__(self, output: str) -> Response:
        return self.outputs[output]

    def to_json(self) -> str:
        """The document, as `socam-host identify --method frf --json` prints it."""
        return self._text

    def __repr__(self) -> str:
        return f"<FrequencyResponse of {self.document['model']}: {', '.join(self.outputs)}>"

    def _repr_html_(self) -> str:
        return "".join(one._repr_html_() for one in self.outputs.values()) + _display.items(self.warnings)


def frf(
    recordings: Sources, model: str | os.PathLike[str] | Model = "speed-o-cam", **options: Unpack[ResponseOptions]
) -> FrequencyResponse:
    """Estimates the frequency response of a model's outputs to its input, with coherence and 95 % intervals, beside the model's own.

    Where the signals repeat, lines are those that the input excites, and noise is measured between them; else local polynomials are fitted.

    Parameters
    ----------
    recordings
        One recording or several, of whatever `read` takes.
    model
        A model, or what `Model` takes: it says which columns are input and outputs, and has a response of its own.
    options
        Those of the command: `help(socam.options.ResponseOptions)`. The band is 0.1 to 100 Hz, or to a third of the sampling rate, where
        none is given.

    Raises
    ------
    FitError
        Where the model has not one input, or the signals are too short or not excited.
    ModelError, RecordingError
        Where a file cannot be used.
    ValueError, TypeError
        For an option that cannot be meant.
    """
    return FrequencyResponse(*_socam.frf(several(recordings), Model(model)._inner, **options))
