"""Files where they are: local paths, and stores through fsspec."""

import os
import re
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, TypeAlias
from urllib.parse import unquote, urlsplit

from socam.errors import RecordingError

Place: TypeAlias = str | os.PathLike[str]
# What a store's file system takes: keys, endpoints, timeouts.
StorageOptions: TypeAlias = Mapping[str, Any] | None

# A network fails now and then: seconds before the second and the third attempt, beside those that the store's own library makes.
_PAUSES_S = (1.0, 2.0)
_ARROW_OPTION = re.compile(r"[?&](endpoint_override|region|scheme)=")


class Unfetched(RecordingError):
    """A file of a store that could not be fetched; `why` says it without the file's name."""

    def __init__(self, uri: str, why: str) -> None:
        super().__init__(f"`{label(uri)}` cannot be read: {why}")
        self.why = why


def is_remote(place: object) -> bool:
    """Whether it is a URI such as `s3://bucket/run.mcap`, and not a path."""
    return isinstance(place, str) and "://" in place


def is_web(uri: str) -> bool:
    """Whether it is a web address, in which `%20` is a space, and what follows `?` is no part of a name."""
    return uri.startswith(("http://", "https://"))


def label(uri: str) -> str:
    """The URI as names and messages say it: without user, query and fragment of a web address, which may hold keys."""
    if not is_web(uri):
        return uri
    parts = urlsplit(uri)
    return f"{parts.scheme}://{parts.netloc.rpartition('@')[2]}{parts.path}"


def file_system(uri: str, storage_options: StorageOptions = None) -> tuple[Any, str]:
    """The file system of a URI, and the path in it.

    Raises
    ------
    ImportError
        Where fsspec, or its part for this kind of store, is not installed.
    ValueError
        Where no store is known by this name, or the URI holds options of pyarrow.
    Unfetched
        Where the store's library refuses.
    """
    try:
        from fsspec.core import url_to_fs
    except ImportError as error:
        raise ImportError(f"`{label(uri)}` needs fsspec: pip install fsspec") from error
    if not is_web(uri) and (found := _ARROW_OPTION.search(uri)):
        wanted = "storage_options, as in {'endpoint_url': 'http://localhost:9000'}"
        raise ValueError(f"`{label(uri)}`: `{found[1]}` is an option of pyarrow, and URIs here are those of fsspec; give {wanted}")
    try:
        system, path = url_to_fs(uri, **(storage_options or {}))
    except ImportError as error:
        package = getattr(error.__cause__, "name", None) or getattr(error, "name", None) or "the package that it names"
        raise ImportError(f"`{label(uri)}` needs {package}: pip install {package}") from error
    except ValueError as error:
        raise ValueError(f"`{label(uri)}` cannot be opened by fsspec: {_why(error)}") from error
    except Exception as error:
        raise Unfetched(uri, _why(error)) from error
    return system, path


@contextmanager
def local(uri: str, storage_options: StorageOptions = None) -> Iterator[str]:
    """The path of a copy of a store's file on this machine, for as long as it is needed.

    What is missing or forbidden stays so; anything else is tried again.

    Raises
    ------
    ImportError, ValueError, Unfetched
        As `file_system`, and where the file cannot be fetched.
    """
    system, path = file_system(uri, storage_options)
    if type(system).__name__ == "LocalFileSystem":
        # `Path.as_uri` writes a space as `%20`, fsspec as a space.
        yield path if os.path.exists(path) else unquote(path)
        return
    with tempfile.TemporaryDirectory(prefix="socam-") as folder:
        copy = os.path.join(folder, "recording")
        for pause_s in (*_PAUSES_S, None):
            try:
                system.get_file(path, copy)
                break
            except Exception as error:
                if pause_s is None or _is_final(error):
                    raise Unfetched(uri, _why(error)) from error
            time.sleep(pause_s)
        if not os.path.isfile(copy):
            raise Unfetched(uri, "it is a folder")
        yield copy


def found_in(system: Any, uri: str, path: str) -> list[str]:
    """Files of a store, as URIs: those that a pattern with `*` matches, else all of a folder.

    Raises
    ------
    Unfetched
        Where the store cannot be asked.
    """
    try:
        # What was listed before may be of another time.
        system.invalidate_cache()
        listed = system.glob(path, detail=True) if "*" in path else system.find(path, detail=True)
    except Exception as error:
        raise Unfetched(uri, _why(error)) from error
    return [system.unstrip_protocol(name) for name, info in listed.items() if info["type"] == "file"]


def _is_final(error: Exception) -> bool:
    status = getattr(error, "status", None)
    refused = isinstance(status, int) and 400 <= status < 500 and status not in (408, 429)
    return refused or isinstance(error, FileNotFoundError | PermissionError | IsADirectoryError | ImportError | ValueError)


def _why(error: Exception) -> str:
    """What a store's library says, in one line and without keys."""
    status = getattr(error, "status", None)
    if isinstance(status, int):
        return f"the server answers {status} {getattr(error, 'message', '')}".rstrip()
    text = " ".join((getattr(error, "strerror", None) or str(error)).split()).rstrip(".")
    if isinstance(error, FileNotFoundError) and "does not exist" not in text:
        return "there is no such file"
    text = re.sub(r"(https?://)[^\s'\"/@]*@", r"\1", text)
    return re.sub(r"(https?://[^\s'\"?#]+)[?#][^\s'\"]*", r"\1", text) or type(error).__name__
