"""Reference: a page for each module that has public names, from the table of contents and the docstrings.

In:  ``primkit/__init__.pyi``.
Out: the pages' sources by name: ``index``, then one for each module, in the order of the story.
"""

import ast
import importlib
import inspect
from pathlib import Path

import primkit

STUB = Path(primkit.__file__).with_suffix(".pyi")


def contents():
    """Return the public names by their modules, and the wings."""
    names, wings = {}, []
    for node in ast.parse(STUB.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom) and node.module:
            names.setdefault(node.module, []).extend(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            wings += [alias.name for alias in node.names]
    return names, wings


def pages():
    """Return the sources of the reference."""
    names, wings = contents()
    told = {module: page(module, names.get(module, [])) for module in dict.fromkeys([*names, *wings])}
    listed = "\n".join(f"   {module}" for module in told)
    rows = "\n".join(
        f"* :doc:`{module}`: {', '.join(f'`{name}`' for name in names.get(module, []))}" for module in told
    )
    title = "Reference\n=========\n\nEvery public name of ``primkit``, in the order of the story, then the wings.\n"
    return {"index": f"{title}\n{rows}\n\n.. toctree::\n   :hidden:\n\n{listed}\n"} | told


def page(module, names):
    """Return the page of a module."""
    head = inspect.getdoc(importlib.import_module(f"primkit.{module}")).partition("\n")[0]
    title = f"{module.rpartition('.')[2]}: {head.partition(': ')[2].rstrip('.') or head}"
    parts = [f"{title}\n{'=' * len(title)}", f".. automodule:: primkit.{module}\n   :no-index:"]
    return "\n\n".join([*parts, *(documented(name) for name in names)]) + "\n"


def documented(name):
    """Return the directive for a public name."""
    value = getattr(primkit, name)
    if inspect.isclass(value):
        return f".. autoclass:: primkit.{name}\n   :members:"
    if inspect.isfunction(value):
        return f".. autofunction:: primkit.{name}"
    return f".. autodata:: primkit.{name}\n   :no-value:"
