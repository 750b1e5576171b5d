"""Writes socam/options.py: the options of every function as keywords, from the one description that the commands' help is made of.

    python typed_options.py > ../socam/options.py
"""

import json
import re
from textwrap import fill
from typing import Any

from socam import _socam

# Tasks, and options that their functions take in their own way: as the model or the recording that they name, or not at all.
_TASKS: dict[str, set[str]] = {
    "check": {"model"},
    "identify": {"model"},
    "response": {"model"},
    "diagnose": {"model", "repeatability"},
    "compare": set(),
    "watch": {"model"},
    "simulate": {"model", "profile"},
    "design": {"model", "rival"},
}
_HEAD = '''"""Options of the functions, as keywords. Written by `python/tests/typed_options.py`; a test compares both."""

from collections.abc import Iterable, Mapping
from os import PathLike
from typing import Literal, TypedDict
'''


def _annotation(option: dict[str, Any]) -> str:
    plain = {"switch": "bool", "whole": "int", "number": "float", "path": "str | PathLike[str]"}
    kind, value = option["kind"], option["value_name"]
    if kind in plain:
        own = plain[kind]
    elif kind == "choice":
        own = f"Literal[{', '.join(json.dumps(word) for word in option['choices'])}]"
    elif option["is_list"] and re.fullmatch(r"\[?\w+\[?=\]?\w+\]?", value):
        own = "str | Iterable[str] | Mapping[str, float | str]"
    elif option["is_list"]:
        own = "str | Iterable[str]"
    else:
        own = "str | tuple[float, float]" if re.search(r"\.\.|:|/", value) else "str"
    return own if option["default"] not in (None, []) else f"{own} | None"


def _sentence(option: dict[str, Any]) -> str:
    default = option["default"]
    is_said = default is None or isinstance(default, list | bool) or "[default" in option["help"]
    known = "" if is_said else f" [default: {default}]"
    return f"{option['help']}{known}."


def text() -> str:
    """The module's text."""
    classes = []
    for task, left_out in _TASKS.items():
        every = json.loads(_socam.described(task))
        own = [option for option in every if option["name"] not in left_out and not (task == "identify" and option["heading"])]
        documented = [f"    {option['name']}\n{fill(_sentence(option), 124, initial_indent=' ' * 8, subsequent_indent=' ' * 8)}" for option in own]
        head = f'class {task.capitalize()}Options(TypedDict, total=False):\n    """Options of `{task}`.\n\n'
        fields = "\n".join(f"    {option['name']}: {_annotation(option)}" for option in own)
        classes.append(head + "\n".join(documented) + f'\n    """\n\n{fields}\n')
    return "\n\n".join([_HEAD, *classes])


if __name__ == "__main__":
    print(text(), end="")
