"""Progress of long calls."""

import sys
from collections.abc import Callable
from typing import TypeAlias

Progress: TypeAlias = bool | Callable[[str], object]


class Line:
    """One line on stderr that is written over and over, in terminals and notebooks."""

    def __init__(self) -> None:
        self._width = 0

    def __call__(self, text: str) -> None:
        sys.stderr.write("\r" + text.ljust(self._width))
        sys.stderr.flush()
        self._width = len(text)


def reporter(progress: Progress) -> Callable[[str], object] | None:
    """What is called with news: a line on stderr for `True`, nothing for `False`, or the given function."""
    if callable(progress):
        return progress
    return Line() if progress else None
