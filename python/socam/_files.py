"""Files where they are: local paths, and object stores through fsspec."""

import os
import time
from typing import Any, TypeAlias

Place: TypeAlias = str | os.PathLike[str]


def is_remote(place: Place) -> bool:
    """Whether it is a URI such as `s3://bucket/run.mcap`, and not a path."""
    return isinstance(place, str) and "://" in place


def file_system(uri: str) -> tuple[Any, str]:
    """The file system of a URI, and the path in it.

    Raises
    ------
    ImportError
        Where fsspec, or its part for this kind of store, is not installed.
    """
    try:
        from fsspec.core import url_to_fs
    except ImportError as error:
        raise ImportError(f"`{uri}` needs fsspec: pip install 'socam[ray]'") from error
    system, path = url_to_fs(uri)
    return system, path


def content(uri: str) -> bytes:
    """All bytes of a file in a store."""
    system, path = file_system(uri)
    data: bytes = system.cat_file(path)
    return data


def fetched(uri: str, attempts: int = 3) -> dict[str, Any]:
    """The content of a file in a store, or the problem why there is none, as arguments of a fleet's row.

    What is missing or forbidden stays so; anything else is tried again, because a network fails now and then.
    """
    for attempt in range(attempts):
        try:
            return {"content": content(uri)}
        except (FileNotFoundError, PermissionError, ImportError) as error:
            return {"problem": f"the file cannot be read: {error}"}
        except Exception as error:  # noqa: BLE001: stores raise what they like
            if attempt + 1 == attempts:
                return {"problem": f"the file cannot be read: {error}"}
            time.sleep(2.0**attempt)
    raise AssertionError("unreachable")
