"""HTML and SVG for notebooks. Styles are in the elements, so that nothing outside of them changes."""

from base64 import b64encode
from collections.abc import Iterable, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

_CELL = "padding:1px 10px;text-align:left"
_COLUMNS = 160


def number(value: float | None) -> str:
    """Five significant digits; a dash for a value that is not there."""
    return "–" if value is None else f"{value:.5g}"


def interval(low: float | None, high: float | None) -> str:
    """A 95 % interval, with a question mark for an open end."""
    if low is None and high is None:
        return ""
    return f"[{'?' if low is None else number(low)}, {'?' if high is None else number(high)}]"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; cells that begin with `<svg` are drawings, all others text."""

    def cell(text: str) -> str:
        return f'<td style="{_CELL}">{text if text.startswith("<svg") else escape(text)}</td>'

    heads = "".join(f'<th style="{_CELL}">{escape(name)}</th>' for name in head)
    body = "".join(f"<tr>{''.join(map(cell, row))}</tr>" for row in rows)
    return f"<table><thead><tr>{heads}</tr></thead><tbody>{body}</tbody></table>"


def picture(svg: str) -> str:
    """A drawing with a style sheet of its own, apart from the page's."""
    data = b64encode(svg.encode()).decode()
    return f'<img style="max-width:100%;background:#fff" src="data:image/svg+xml;base64,{data}">'


def items(texts: Iterable[str]) -> str:
    """A list; nothing where there are no texts."""
    entries = "".join(f"<li>{escape(text)}</li>" for text in texts)
    return f"<ul>{entries}</ul>" if entries else ""


def sparkline(values: NDArray[np.float64]) -> str:
    """The course of a channel: smallest and largest value of each pixel column, so that no spike is lost."""
    width, height = _COLUMNS, 28
    known = values[np.isfinite(values)]
    if known.size == 0:
        return ""
    low, high = float(known.min()), float(known.max())
    scale = (height - 2) / (high - low) if high > low else 0.0
    lines = []
    for column, part in enumerate(np.array_split(values, min(width, values.size))):
        part = part[np.isfinite(part)]
        if part.size:
            ends = (height - 1 - scale * (float(end) - low) for end in (part.max(), part.min()))
            top, bottom = ends
            lines.append(f"M{column} {top - 0.4:.1f}V{bottom + 0.4:.1f}")
    return (
        f'<svg width="{width}" height="{height}" viewBox="0 0 {width} {height}">'
        f'<path d="{"".join(lines)}" stroke="#1f5fa8" fill="none"/></svg>'
    )
