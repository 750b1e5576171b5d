"""A fleet on Ray: many recordings over many processes and machines, with the rows of `socam-host fleet`.

    import socam.ray

    socam.ray.diagnose("s3://bucket/fleet/**/*.mcap", "machine.toml", "fleet.parquet", reference=["healthy.mcap"])

The driver appends each row to a part file beside the table. A run that ended early goes on where it was: a recording whose id (the hash of
its bytes, the model, the options, the seed and the version) is in the part file, or in an earlier table, is fetched and not diagnosed again.
The table is sorted, so that its bytes do not depend on workers, on their deaths, or on restarts.
"""

import json
import os
from collections.abc import Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any, TypeAlias
from urllib.parse import quote, unquote

import numpy as np

from socam import _files, _socam
from socam._files import StorageOptions
from socam._progress import Progress, reporter
from socam.fleet import row_of, task
from socam.model import Model

__all__ = ["Recording", "diagnose", "recordings"]

# A worker that dies (out of memory, a machine that is taken away) is started again, and its recordings are given to it again, so often.
_MOST_RESTARTS = 20
# Rows become visible to the driver block by block: what a dead driver or worker loses is at most this many recordings a worker.
_BLOCK_ROWS = 16


@dataclass(frozen=True, slots=True)
class Recording:
    """A recording of a fleet: its name in the table, where it is, its machine's serial number, and its date in ms since 1970 (UTC)."""

    name: str
    place: str
    machine: str | None = None
    date_ms: int | None = None


Places: TypeAlias = str | os.PathLike[str] | Sequence[str | os.PathLike[str] | Recording]


def recordings(places: Places, *, storage_options: StorageOptions = None) -> list[Recording]:
    """The recordings that are meant.

    Parameters
    ----------
    places
        A folder or a CSV list (columns file, machine, date), of this machine or of a store: `s3://bucket/fleet`, `s3://bucket/list.csv`; a
        pattern in a store, with `*`: `s3://bucket/fleet/**/*.mcap`; or a sequence of paths, URIs and recordings, which are named by what
        follows the folder that they have in common. Files of a list are relative to its folder, or URIs.
    storage_options
        What the store's file system takes; see `socam.read`.

    Raises
    ------
    ImportError
        Where a store's package is not installed.
    SocamError
        Where the folder, the list or the store cannot be read.
    ValueError
        Where there is no recording, or two have the same name.
    """
    if isinstance(places, str) and _files.is_remote(places):
        found = _in_store(places, storage_options)
    elif isinstance(places, str | os.PathLike):
        listed = _socam.fleet_sources(os.fspath(places))
        found = [_listed(name, os.path.abspath(path), machine, date_ms) for name, path, machine, date_ms in listed]
    else:
        found = _named(places, storage_options)
    found.sort(key=lambda one: one.name)
    if not found:
        shown = _files.label(places) if isinstance(places, str) else places
        raise ValueError(f"there is no recording in {shown}")
    for one, other in zip(found, found[1:]):
        if one.name == other.name:
            raise ValueError(f"two recordings have the name `{one.name}`; give them names by `socam.ray.Recording`")
    return found


def _name(place: str) -> str:
    """A place as a name: of a web address `a%20b.csv` as `a b.csv`."""
    return unquote(_files.label(place)) if _files.is_web(place) else place


def _listed(name: str, place: str, machine: str | None, date_ms: int | None) -> Recording:
    """A line of a list, whose name may be a place elsewhere."""
    return Recording(_name(name), name if _files.is_remote(name) else place, machine, date_ms)


def _in_store(uri: str, storage_options: StorageOptions) -> list[Recording]:
    """Recordings of a store: those of a pattern, a list or a folder. Names begin after the last folder without a wildcard."""
    if "*" not in uri and _files.label(uri).lower().endswith(".csv"):
        with _files.local(uri, storage_options) as copy, open(copy, "rb") as file:
            listed = _socam.fleet_list(_files.label(uri), file.read())
        folder = _files.label(uri).rpartition("/")[0]
        quoted = quote if _files.is_web(uri) else str
        return [_listed(name, f"{folder}/{quoted(name)}", machine, date_ms) for name, _, machine, date_ms in listed]
    system, path = _files.file_system(uri, storage_options)
    places = _files.found_in(system, uri, path)
    folder = path.split("*")[0].rpartition("/")[0] if "*" in path else path
    shared = _name(system.unstrip_protocol(folder)).rstrip("/")
    found = [Recording(_name(place).removeprefix(shared).lstrip("/"), place) for place in places]
    return found if "*" in path else [one for one in found if _is_recording(one.name)]


def _is_recording(name: str) -> bool:
    hidden = any(part.startswith(".") for part in PurePosixPath(name).parts)
    return not hidden and _socam.is_recording(name)


def _named(places: Iterable[str | os.PathLike[str] | Recording], storage_options: StorageOptions) -> list[Recording]:
    listed = list(places)
    paths = [os.fspath(one) for one in listed if not isinstance(one, Recording)]
    # A package that is missing is said here, and not in the row of each recording.
    for uri in {path.partition("://")[0]: path for path in paths if _files.is_remote(path)}.values():
        _files.file_system(uri, storage_options)
    names = [_name(path) for path in paths]
    shared = os.path.commonprefix([name.rpartition("/")[0] + "/" for name in names]).rpartition("/")[0]
    named = [
        Recording(name.removeprefix(shared).lstrip("/"), path if _files.is_remote(path) else os.path.abspath(path))
        for name, path in zip(names, paths)
    ]
    return named + [one for one in listed if isinstance(one, Recording)]


class _Worker:
    """An actor: makes the rows of recordings, one at a time, on one thread."""

    def __init__(self, model: str, options: str, seed: int, storage_options: StorageOptions) -> None:
        self._task = _socam.FleetTask(_socam.Model(model), options, seed)
        self._storage_options = storage_options

    def __call__(self, batch: dict[str, Any]) -> dict[str, Any]:
        results = [self._one(*values) for values in zip(*(batch[name] for name in _COLUMNS), strict=True)]
        return {"name": batch["name"], "id": [one[0] for one in results], "row": [one[1] for one in results]}

    def _one(self, name: str, place: str, machine: str, date_ms: float, known: str) -> tuple[str, bytes]:
        id_, row = row_of(
            self._task,
            str(name),
            str(place),
            self._storage_options,
            machine=str(machine) or None,
            date_ms=None if np.isnan(date_ms) else int(date_ms),
            known=str(known).split() or None,
        )
        return id_, b"" if row is None else row.to_bytes()


_COLUMNS = ("name", "place", "machine", "date_ms", "known")


def diagnose(
    places: Places,
    model: str | os.PathLike[str] | Model,
    out: str | os.PathLike[str],
    *,
    reference: Sequence[str | os.PathLike[str]] = (),
    workers: int | None = None,
    seed: int = 1,
    storage_options: StorageOptions = None,
    progress: Progress = False,
    **options: Any,
) -> int:
    """Diagnoses the recordings of a fleet on Ray, and writes the table that `socam-host fleet` writes, byte for byte.

    Ray is started on this machine, unless it is already, or `RAY_ADDRESS` names a cluster. Each worker takes one processor. Paths must mean
    the same on all machines.

    Parameters
    ----------
    places
        The recordings; see `recordings`.
    model
        A model, or what `Model` takes.
    out
        Path of the table, Parquet, on the driver's machine. While the run goes on, `OUT.part` holds its rows.
    reference
        Healthy recordings, as paths on the driver's machine or URIs: their noise is what all others are tested against.
    workers
        Number of actors. Default: the processors of the cluster.
    seed
        Seed of random start values.
    storage_options
        What the store's file system takes; see `socam.read`. Ray gives it to the workers.
    progress
        `True` for a line on stderr, or a function that takes a line of text.
    **options
        `false_alarm_rate`, `tolerance`, `most_effects`, `ratio_tolerance`, `frozen`, as in `docs/fleet.md`.

    Returns
    -------
    int
        Number of rows of the table. A recording that cannot be used is a row with its `status` and a sentence.

    Raises
    ------
    ImportError
        Where Ray, or a store's package, is not installed.
    SocamError
        Where the table, the reference or the place of the recordings cannot be used.
    ValueError
        For options and places that cannot be meant.
    """
    found = recordings(places, storage_options=storage_options)
    own = Model(model)
    made = task(own, seed=seed, **options)
    if reference:
        made = _socam.FleetTask(own._inner, _with_reference(made, reference, storage_options), seed)
    part = _socam.FleetPart(made, os.fspath(out))
    report = reporter(progress)
    wanted = []
    for name, id_, row in _rows(found, (own.text, made.options(), seed, storage_options), part, workers):
        wanted.append(part.append(row) if row else (name, id_))
        if report:
            report(f"{len(wanted)} of {len(found)} recordings")
    if len(wanted) != len(found):
        raise RuntimeError(f"Ray gave {len(wanted)} rows for {len(found)} recordings; run it again to go on")
    return part.finish(wanted)


def _with_reference(
    made: _socam.FleetTask, reference: Sequence[str | os.PathLike[str]], storage_options: StorageOptions
) -> str:
    with ExitStack() as copies:
        named = []
        for path in [os.fspath(one) for one in reference]:
            if _files.is_remote(path):
                named.append((_files.label(path), copies.enter_context(_files.local(path, storage_options))))
            else:
                named.append((os.path.basename(path), path))
        frozen = made.reference(named)
    return json.dumps(json.loads(made.options()) | {"frozen": None if frozen is None else json.loads(frozen)})


def _rows(
    found: list[Recording],
    made_with: tuple[str, str, int, StorageOptions],
    part: _socam.FleetPart,
    workers: int | None,
) -> Iterable[tuple[str, str, bytes]]:
    """Names, ids and rows as they are made; no row where the part holds it."""
    try:
        import ray
        import ray.data
    except ImportError as error:
        raise ImportError("socam.ray needs Ray: pip install 'socam[ray]'") from error
    if not ray.is_initialized():
        ray.init(logging_level="warning", include_dashboard=False)
    # The caller's own line says how far it is.
    ray.data.DataContext.get_current().enable_progress_bars = False
    known: dict[str, list[str]] = {}
    for name, id_ in part.known():
        known.setdefault(name, []).append(id_)
    workers = workers or max(1, int(ray.cluster_resources().get("CPU", 1)))
    workers = min(workers, len(found))
    blocks = max(-(-len(found) // _BLOCK_ROWS), min(len(found), 4 * workers))
    # Ids that are done go with their recording, so that a worker that is started again needs nothing else.
    items = [
        {
            "name": one.name,
            "place": one.place,
            "machine": one.machine or "",
            "date_ms": float("nan") if one.date_ms is None else one.date_ms,
            "known": " ".join(known.get(one.name, ())),
        }
        for one in found
    ]
    rows = ray.data.from_items(items, override_num_blocks=blocks).map_batches(
        _Worker,
        fn_constructor_args=made_with,
        batch_size=1,
        batch_format="numpy",
        num_cpus=1,
        compute=ray.data.ActorPoolStrategy(size=workers),
        max_restarts=_MOST_RESTARTS,
        max_task_retries=_MOST_RESTARTS,
    )
    for batch in rows.iter_batches(batch_size=None, prefetch_batches=1):
        yield from zip(map(str, batch["name"]), map(str, batch["id"]), map(bytes, batch["row"]), strict=True)
