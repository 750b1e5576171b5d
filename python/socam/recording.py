"""Recordings over time."""

import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from socam import _display, _files, _socam
from socam._files import StorageOptions
from socam.errors import RecordingError

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow

__all__ = ["Recording", "read"]

_TIME = "t_s"


class Recording:
    """A recording: channels in SI units over time.

    Made by `read` and `simulate`. `recording["motor_speed_rad_s"]` is a column, `recording["t_s"]` are the times. Arrays and Arrow tables
    are views of the recording's own memory, where it has its samples in memory: numpy arrays of it cannot be written to.
    """

    __slots__ = ("_inner",)

    def __init__(self, inner: _socam.Recording) -> None:
        self._inner = inner

    @property
    def name(self) -> str:
        """Its name in results: the path by which it was read."""
        return self._inner.name

    @property
    def channels(self) -> list[str]:
        """Column names, each ending in its unit; without `t_s`."""
        return [name for name, _ in self._inner.channels]

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column, as in `rad/s`."""
        return dict(self._inner.channels)

    @property
    def sample_time_s(self) -> float:
        """Median step of time, s."""
        return self._inner.sample_time_s

    @property
    def duration_s(self) -> float:
        """Time from the first row to the last, s."""
        return self._inner.end_s - self._inner.start_s

    @property
    def segments(self) -> list[int]:
        """First row of each part without gaps."""
        return self._inner.segments

    @property
    def lost_samples(self) -> int:
        """Number of samples lost while recording."""
        return self._inner.lost_samples

    @property
    def is_complete(self) -> bool:
        """Whether the file is whole: not cut off, nothing damaged, no sample lost."""
        return self._inner.is_complete

    @property
    def warnings(self) -> list[str]:
        """What was not read, and what is missing."""
        return self._inner.warnings

    def __len__(self) -> int:
        return self._inner.rows

    def __contains__(self, name: object) -> bool:
        return name in self.keys()

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def keys(self) -> list[str]:
        """`t_s`, then the channels, so that `dict(recording)` holds all columns."""
        return [_TIME, *self.channels]

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """A column by its name, with or without the unit.

        Returns
        -------
        numpy.ndarray
            Shape (rows,), SI, NaN where a value is missing; a view that cannot be written to.

        Raises
        ------
        KeyError
            For a channel that the recording does not have.
        """
        if name == _TIME:
            return np.asarray(self._inner.column())
        try:
            index = self._inner.channel_index(name)
        except RecordingError as error:
            raise KeyError(str(error)) from None
        return np.asarray(self._inner.column(index))

    def to_numpy(self) -> dict[str, NDArray[np.float64]]:
        """All columns, `t_s` first: arrays of shape (rows,) that share the recording's memory."""
        return {name: self[name] for name in self.keys()}

    def to_arrow(self) -> "pyarrow.Table":
        """A table that shares the recording's memory; a missing value is a null."""
        import pyarrow

        return pyarrow.table(self)

    def to_polars(self) -> "polars.DataFrame":
        """A data frame that shares the recording's memory; a missing value is a null."""
        import polars

        return polars.DataFrame(self)

    def to_pandas(self) -> "pandas.DataFrame":
        """A data frame that shares the recording's memory; a missing value is NaN."""
        import pandas

        return pandas.DataFrame(self.to_numpy(), copy=False)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        return self._inner.__arrow_c_stream__(requested_schema)

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes it as .csv or .mcap, by the extension.

        Raises
        ------
        ValueError
            For another extension.
        RecordingError
            Where the file cannot be written.
        """
        self._inner.write(os.fspath(path))

    def __repr__(self) -> str:
        channels = ", ".join(self.channels)
        return f"<Recording {self.name}: {len(self)} rows, {self.duration_s:.5g} s, {channels}>"

    def _repr_html_(self) -> str:
        rows = []
        for name, unit in self._inner.channels:
            values = self[name]
            known = values[~np.isnan(values)]
            ends = [_display.number(float(end)) for end in (known.min(), known.max())] if known.size else ["–", "–"]
            rows.append([name, unit, *ends, str(values.size - known.size), _display.sparkline(values)])
        head = ["channel", "unit", "least", "most", "missing", f"over {self.duration_s:.5g} s"]
        return _display.items([repr(self)[1:-1]]) + _display.table(head, rows) + _display.items(self.warnings)


Source: TypeAlias = str | os.PathLike[str] | bytes | Mapping[str, Any] | Recording | Any
Sources: TypeAlias = Source | Sequence[Source]


def read(source: Source, *, name: str | None = None, storage_options: StorageOptions = None) -> Recording:
    """Reads a recording.

    Parameters
    ----------
    source
        A path, or a part of a file as `RUN@FROM..TO` in seconds or clock times; files of one run as `A.csv+B.csv` or `log_*.csv+`; a URI that fsspec knows; the bytes of a file; or columns: a mapping of
        names to arrays of shape (rows,), or a table of pandas, polars or pyarrow, with the times `t_s` in s, and names that end in an SI
        unit (`motor_speed_rad_s`, `torque_Nm`). Columns are copied once.
    name
        Name in results, of URIs, bytes and columns.
    storage_options
        What the store's file system takes, as pandas and fsspec have it: `{"key": ..., "secret": ..., "endpoint_url": ...}` of S3. Without it,
        the store's own environment variables and those of fsspec (`FSSPEC_S3_ENDPOINT_URL`) hold.

    Raises
    ------
    RecordingError
        Where a file cannot be fetched or read, is damaged, or does not say what its numbers are.
    ImportError
        Where the package of a store is not installed.
    ValueError
        Where columns differ in length, their times do not increase, or their names have no unit; where no store is known by the URI.
    """
    if isinstance(source, Recording):
        return source
    if isinstance(source, str | os.PathLike):
        if isinstance(source, str) and _files.is_remote(source):
            with _files.local(source, storage_options) as copy:
                content = Path(copy).read_bytes()
            return Recording(_socam.Recording.from_bytes(name or _files.label(source), content))
        return Recording(_socam.Recording.open(os.fspath(source)))
    if isinstance(source, bytes | bytearray | memoryview):
        return Recording(_socam.Recording.from_bytes(name or "memory", bytes(source)))
    columns = _columns(source)
    if _TIME not in columns:
        raise ValueError(f"the columns have no times `{_TIME}`, in s; they are {', '.join(columns)}")
    time_s = columns.pop(_TIME)
    return Recording(_socam.Recording.from_columns(name or "memory", time_s, list(columns.items())))


def _columns(source: Any) -> dict[str, NDArray[np.float64]]:
    """Columns of a mapping or of a table, whatever made it."""
    if isinstance(source, Mapping):
        named = dict(source)
    elif hasattr(source, "column_names"):
        named = {name: source.column(name) for name in source.column_names}
    elif hasattr(source, "columns") and hasattr(source, "__getitem__"):
        named = {name: source[name] for name in source.columns}
    else:
        raise TypeError(f"a recording is read from a path, bytes, a mapping or a table, not from {type(source).__name__}")
    return {str(name): _values(str(name), values) for name, values in named.items()}


def _values(name: str, values: Any) -> NDArray[np.float64]:
    try:
        array = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise TypeError(f"the column `{name}` does not hold numbers: {error}") from None
    if array.ndim != 1:
        raise ValueError(f"the column `{name}` has the shape {array.shape}; expected (rows,)")
    return array


def _expanded(source: Source) -> list[Source]:
    """The files that a pattern such as `runs/*.csv` names; anything else as it is."""
    return list(_socam.expand(source)) if isinstance(source, str) and not _files.is_remote(source) else [source]


def several(sources: Sources) -> list[_socam.Recording]:
    """One recording or several, of whatever `read` takes, each once."""
    named = sources if isinstance(sources, list | tuple) else [sources]
    listed = [one for source in named for one in _expanded(source)]
    inner = [read(source)._inner for source in listed]
    if len({id(one) for one in inner}) < len(inner):
        raise ValueError("a recording is named twice; its samples would count double")
    return inner
