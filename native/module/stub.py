#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write sfumato.pyi, what editors and mypy know of the built module:  cmake --build build --target stub

The module's own signatures say all but two things: that arguments are whatever NumPy makes an array of, not only an
array of one type, and that an `object` among them is such an argument. Stubs that pybind11-stubgen or mypy's stubgen
write lack both, so that calls with lists would be refused.
"""

from __future__ import annotations

import inspect
import re
import textwrap
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

HERE = Path(__file__).resolve().parent
HEAD = """# SPDX-License-Identifier: GPL-3.0-or-later
# Written by stub.py from the built module; do not edit.
from collections.abc import Callable, Sequence
from typing import Any, overload

import numpy
from numpy.typing import ArrayLike, NDArray
"""
WIDTH = 120
_TAKEN_FOR = {"Exposure": "Exposure | Camera", "sequence": "ArrayLike"}  # what arguments of a type may be, too


def python_type(text: str, argument: bool) -> str:
    """What pybind11 calls a type, as a type of Python."""
    text = text.strip().replace("sfumato.", "")
    if wrapped := re.fullmatch(r"Optional\[(.*)\]", text):
        return f"{python_type(wrapped[1], argument)} | None"
    if wrapped := re.fullmatch(r"Union\[(.*)\]", text):
        return " | ".join(python_type(part, argument) for part in split(wrapped[1]))
    if several := re.fullmatch(r"Tuple\[(.*)\]", text):
        return f"tuple[{', '.join(python_type(part, argument) for part in split(several[1]))}]"
    if array := re.fullmatch(r"numpy\.ndarray\[(.*)\]", text):
        return "ArrayLike" if argument else f"NDArray[{array[1]}]"
    if re.fullmatch(r"List\[int\[\d+\]\]", text):
        return "Sequence[int]"
    if several := re.fullmatch(r"List\[(.*)\]", text):
        inner = several[1] if argument else python_type(several[1], argument)
        return f"Sequence[{python_type(inner, argument)}]"
    if text == "object":
        return "ArrayLike" if argument else "Any"
    if argument and text in _TAKEN_FOR:
        return _TAKEN_FOR[text]
    return {"list": "list[Any]", "tuple": "tuple[Any, ...]"}.get(text, text)


def split(text: str) -> list[str]:
    """At the commas that no bracket or quotation mark encloses."""
    parts = re.findall(r"(?:\[(?:[^][]|\[[^][]*\])*\]|'[^']*'|[^,])+", text)
    return [part.strip() for part in parts]


def parameter(text: str) -> str:
    if text == "self" or text.startswith("self:"):
        return "self"
    if text == "*args":
        return "*arrays: ArrayLike"
    name, _, rest = text.partition(": ")
    kind, _, default = rest.partition(" = ")
    of_python = python_type(kind, argument=True)
    if not default:
        return f"{name}: {of_python}"
    nothing = " | None" if default == "None" and "None" not in of_python else ""
    return f"{name}: {of_python}{nothing} = {default.replace(chr(39), chr(34))}"


def summary(doc: str) -> str:
    """The first paragraph, on one line."""
    return " ".join(doc.strip().partition("\n\n")[0].split())


def signatures(name: str, doc: str) -> list[tuple[str, str, str]]:
    """Parameters, return type and summary of each overload."""
    found = re.findall(rf"^(?:\d+\. )?{name}\((.*)\) -> (.*)(?:\n\n((?:.+\n?)*))?", doc, re.MULTILINE)
    if not found:
        raise ValueError(f"{name} has no signature: {doc!r}")
    return found


def described(head: str, text: str, indent: str) -> Iterator[str]:
    """A definition with the text as its docstring, wrapped as black would leave it."""
    if not text:
        yield f"{indent}{head} ..."
        return
    yield f"{indent}{head}"
    lines = textwrap.wrap(text.replace("\\", "\\\\"), WIDTH - len(indent) - 10)
    if len(lines) > 1:
        lines.append("")
    yield f'{indent}    """' + f"\n{indent}    ".join(lines) + '"""'


def function(name: str, doc: str, indent: str, decorators: list[str]) -> Iterator[str]:
    overloads = signatures(name, doc)
    for parameters, returned, text in overloads:
        if not indent:
            yield ""
        for decorator in [*decorators, *(["overload"] if len(overloads) > 1 else [])]:
            yield f"{indent}@{decorator}"
        listed = [parameter(part) for part in split(parameters)]
        tail = f") -> {python_type(returned, argument=False)}:"
        head = f"def {name}({', '.join(listed)}{tail}"
        if len(indent + head) + (0 if text else 4) > WIDTH:
            inner = f"\n{indent}    "
            head = f"def {name}(" + inner + ", ".join(listed)
            if len(indent + "    " + ", ".join(listed)) > WIDTH:
                head = f"def {name}(" + "".join(f"{inner}{part}," for part in listed)
            head += f"\n{indent}{tail}"
        yield from described(head, summary(text), indent)


def members(owner: object, indent: str, static: bool) -> Iterator[str]:
    for name, value in sorted(vars(owner).items()):
        own = isinstance(value, staticmethod)
        value = value.__func__ if own else value
        doc = inspect.getdoc(value) or ""
        if name.startswith("_") and (name != "__init__" or not doc.startswith("__init__(")):
            continue
        if isinstance(value, ModuleType):
            yield f"\nclass {name}:  # a module"
            yield f'    """{summary(doc)}"""'
            yield ""
            yield from members(value, "    ", static=True)
        elif inspect.isclass(value):
            yield f"\nclass {name}:"
            yield f'    """{summary(doc)}"""'
            yield ""
            yield from members(value, "    ", static=False)
        elif isinstance(value, property):
            signature = re.search(r"-> (.*)", value.fget.__doc__ or "")
            yield f"{indent}@property"
            kind = python_type(signature[1], argument=False) if signature else "Any"
            yield from described(f"def {name}(self) -> {kind}:", summary(doc), indent)
        elif callable(value):
            yield from function(name, doc, indent, ["staticmethod"] if static or own else [])
        else:
            yield ""
            yield f"{indent}{name}: {type(value).__name__}"


def stub(module: ModuleType) -> str:
    text = HEAD + "\n" + "\n".join(members(module, "", static=False)) + "\n"
    return re.sub(r"\n{3,}", "\n\n", text)


if __name__ == "__main__":
    import sfumato

    (HERE / "sfumato.pyi").write_text(stub(sfumato), encoding="utf-8")
