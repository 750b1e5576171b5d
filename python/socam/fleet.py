"""The core of a fleet: a recording, a model, options and a seed give one row, whatever goes wrong with the recording.

`socam-host fleet` and `socam.ray` run it for many recordings; the rows are the same.
"""

import json
import os
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from socam import _display, _files, _socam
from socam._files import StorageOptions
from socam.model import Model

if TYPE_CHECKING:
    import pyarrow

__all__ = ["Row", "Summary", "diagnose_one", "row_of", "summary", "task"]


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


def row_of(
    made: _socam.FleetTask, name: str, place: str, storage_options: StorageOptions = None, **about: Any
) -> tuple[str, _socam.FleetRow | None]:
    """Id and row of a recording at a path or URI; no row where `known` holds its id. What cannot be fetched is a row that says so."""
    with ExitStack() as copies:
        path = place
        if _files.is_remote(place):
            try:
                path = copies.enter_context(_files.local(place, storage_options))
            except _files.Unfetched as error:
                return made.row(name, problem=f"the file cannot be read: {error.why}", **about)
            except (ImportError, ValueError) as error:
                return made.row(name, problem=f"the file cannot be read: {error}", **about)
        return made.row(name, path=path, **about)


def diagnose_one(
    source: str | os.PathLike[str] | bytes,
    model: str | os.PathLike[str] | Model,
    *,
    name: str | None = None,
    machine: str | None = None,
    seed: int = 1,
    storage_options: StorageOptions = None,
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
    storage_options
        What the store's file system takes; see `socam.read`.
    **options
        `false_alarm_rate`, `tolerance`, `most_effects`, `ratio_tolerance`, `frozen`, as in `docs/fleet.md`.
    """
    made = task(model, seed=seed, **options)
    if isinstance(source, bytes):
        _, row = made.row(name or "memory", content=source, machine=machine)
    else:
        place = os.fspath(source)
        usual = _files.label(place) if _files.is_remote(place) else os.path.basename(place)
        _, row = row_of(made, name or usual, place, storage_options, machine=machine)
    assert row is not None, "no row is known before"
    return Row(row)


class Summary:
    """What the rows of a fleet's table say together. `faulty`, `groups`, `trends` and others are the lists of `socam-host fleet`."""

    __slots__ = ("_inner", "document")

    def __init__(self, inner: _socam.FleetSummary) -> None:
        self._inner = inner
        #: The document `socam.fleet-summary/1`.
        self.document: dict[str, Any] = json.loads(inner.json())

    @property
    def counts(self) -> dict[str, int]:
        """Recordings in all, by verdict and by trouble, and those that got the full diagnosis."""
        counts: dict[str, int] = self.document["counts"]
        return counts

    @property
    def faulty(self) -> list[dict[str, Any]]:
        """Machines that lack physics, the smallest p-value first."""
        return list(self.document["faulty"])

    @property
    def groups(self) -> list[dict[str, Any]]:
        """Their findings by effect and place, those on the most machines first."""
        return list(self.document["groups"])

    @property
    def trends(self) -> list[dict[str, Any]]:
        """Parameters that change over the dates."""
        return list(self.document["trends"])

    @property
    def differences(self) -> list[dict[str, Any]]:
        """Machines that differ from their sisters."""
        return list(self.document["differences"])

    @property
    def troubles(self) -> list[dict[str, Any]]:
        """Recordings without a verdict, the first thousand."""
        return list(self.document["troubles"])

    def to_json(self) -> str:
        """The document, as `socam-host fleet --json` prints it."""
        return self._inner.json()

    def to_html(self) -> str:
        """The fleet's page, as `socam-host fleet --report` writes it."""
        return self._inner.page(["socam.fleet.summary"])

    def report(self, path: str | os.PathLike[str]) -> None:
        """Writes the page."""
        Path(path).write_text(self.to_html(), encoding="utf-8")

    def __repr__(self) -> str:
        recordings, machines = self.counts["recordings"], self.document["machines"]
        return f"<Summary of {recordings} recordings of {machines} machines: {len(self.faulty)} machines lack physics>"

    def _repr_html_(self) -> str:
        number = _display.number
        return (
            _display.items([repr(self)[1:-1], ", ".join(f"{count} {name}" for name, count in self.counts.items())])
            + _display.table(
                ["machine", "p", "what is missing"],
                ([one["machine"], number(one["p_value"]), ", ".join(one["findings"])] for one in self.faulty),
            )
            + _display.table(
                ["machine", "parameter", "change a year", "95 % interval", "unit"],
                (
                    [one["machine"], one["parameter"], number(one["per_year"]), _display.interval(one["low"], one["high"]), one["unit"]]
                    for one in self.trends
                ),
            )
            + _display.table(
                ["machine", "parameter", "value", "sisters", "unit", "deviations"],
                (
                    [one["machine"], one["parameter"], number(one["value"]), number(one["median"]), one["unit"], f"{one['z']:+.1f}"]
                    for one in self.differences
                ),
            )
            + _display.table(["recording", "trouble", "why"], ([one["recording"], one["status"], one["message"]] for one in self.troubles))
        )


def summary(table: str | os.PathLike[str], *, fdr: float = 0.05) -> Summary:
    """What the rows of a fleet's table say together: which machines lack physics, what changes over the dates, which machines differ.

    Parameters
    ----------
    table
        Path of a table that `socam.ray.diagnose` or `socam-host fleet` wrote.
    fdr
        False discovery rate of each list.

    Raises
    ------
    SocamError
        Where it is no table of a fleet.
    ValueError
        For a rate that is not between 0 and 1.
    """
    return Summary(_socam.FleetSummary(os.fspath(table), fdr))
