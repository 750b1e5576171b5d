"""The core of a fleet: a recording, a model, options and a seed give one row, whatever goes wrong with the recording.

`socam-host fleet` and `socam.ray` run it for many recordings; the rows are the same.
"""

import json
import os
from typing import TYPE_CHECKING, Any

from socam import _files, _socam
from socam.model import Model

if TYPE_CHECKING:
    import pyarrow

__all__ = ["Row", "diagnose_one", "task"]


class Row:
    """The row of one recording, `socam.fleet/1`; `pyarrow.table(row)` is its Arrow form."""

    __slots__ = ("_inner", "document")

    def __init__(self, inner: _socam.FleetRow) -> None:
        self._inner = inner
        #: All columns by name.
        self.document: dict[str, Any] = json.loads(inner.json())

    @property
    def id(self) -> str:
        """Hash of the recording's bytes, the model, the options, the seed and the version."""
        return self._inner.id

    @property
    def status(self) -> str:
        """`ok`, or why there is no verdict; `message` says more."""
        return str(self.document["status"])

    @property
    def message(self) -> str:
        """What is wrong with the recording, in a sentence."""
        return str(self.document["message"])

    @property
    def verdict(self) -> str | None:
        """`adequate`, `missing_physics` or `unexplained`."""
        verdict: str | None = self.document["verdict"]
        return verdict

    def to_arrow(self) -> "pyarrow.Table":
        """A table of one row."""
        import pyarrow

        return pyarrow.table(self)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        return self._inner.__arrow_c_stream__(requested_schema)

    def __repr__(self) -> str:
        return f"<Row {self.document['recording']}: {self.verdict or self.status}>"


def task(model: str | os.PathLike[str] | Model, *, seed: int = 1, **options: Any) -> _socam.FleetTask:
    """What all rows of a fleet are made with.

    Raises
    ------
    ValueError
        For an option that does not exist, and a model with values that are not in its file: the rows' ids depend on its text.
    """
    model = Model(model)
    if model != Model(model.text):
        raise ValueError("the model has values that are not in its text; write them to its file first")
    return _socam.FleetTask(model._inner, json.dumps(options), seed)


def diagnose_one(
    source: str | os.PathLike[str] | bytes,
    model: str | os.PathLike[str] | Model,
    *,
    name: str | None = None,
    machine: str | None = None,
    seed: int = 1,
    **options: Any,
) -> Row:
    """Diagnoses one recording on one thread. Bad input is a row with a `status` and a sentence, never an exception.

    Parameters
    ----------
    source
        A path, a URI that fsspec knows, or the bytes of a file.
    model
        A model, or what `Model` takes.
    name, machine
        Name of the recording and serial number of its machine in the table.
    seed
        Seed of random start values.
    **options
        `false_alarm_rate`, `tolerance`, `most_effects`, `ratio_tolerance`, `frozen`, as in `docs/fleet.md`.
    """
    made = task(model, seed=seed, **options)
    if isinstance(source, bytes):
        _, row = made.row(name or "memory", content=source, machine=machine)
    elif _files.is_remote(source):
        _, row = made.row(name or os.fspath(source), machine=machine, **_files.fetched(os.fspath(source)))
    else:
        path = os.fspath(source)
        _, row = made.row(name or os.path.basename(path), path=path, machine=machine)
    assert row is not None, "no row is known before"
    return Row(row)
