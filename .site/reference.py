"""Reference: a page for each module that has public names, from the table of contents and the docstrings.

In:  ``primkit/__init__.pyi``.
Out: the pages' sources by name: ``index``, then one for each module, in the order of the story.
"""

import ast
import importlib
import inspect
from operator import attrgetter
from pathlib import Path

import primkit

STUB = Path(primkit.__file__).with_suffix(".pyi")
LONGEST_VALUE = 300  # letters; of a longer one its type is told


def contents():
    """Return the public names by their modules, in the order of the story; then what each wing adds, as WING.NAME."""
    names, wings = {}, []
    for node in ast.parse(STUB.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom) and node.module:
            names.setdefault(node.module, []).extend(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            wings += [alias.name for alias in node.names]
    for wing in wings:
        module = importlib.import_module(f"primkit.{wing}")
        its = [one for one in getattr(module, "__all__", ()) if getattr(module, one) is not getattr(primkit, one, None)]
        names.setdefault(wing, []).extend(f"{wing}.{one}" for one in its)
    return names


def pages():
    """Return the sources of the reference."""
    names = contents()
    listed = "\n".join(f"   {module}" for module in names)
    rows = "\n".join(f"* :doc:`{module}`: {', '.join(f'`{name}`' for name in its)}" for module, its in names.items())
    title = "Reference\n=========\n\nEvery public name of ``primkit``, in the order of the story, then the wings.\n"
    index = f"{title}\n{rows}\n\n.. toctree::\n   :hidden:\n\n{listed}\n"
    return {"index": index} | {module: page(module, its) for module, its in names.items()}


def page(module, names):
    """Return the page of a module."""
    head = inspect.getdoc(importlib.import_module(f"primkit.{module}")).partition("\n")[0]
    title = f"{module.rpartition('.')[2]}: {head.partition(': ')[2].rstrip('.') or head}"
    parts = [f"{title}\n{'=' * len(title)}", f".. automodule:: primkit.{module}\n   :no-index:"]
    return "\n\n".join([*parts, *map(documented, names)]) + "\n"


def documented(name):
    """Return the directive for a public name."""
    value = attrgetter(name)(primkit)
    if inspect.isclass(value):
        return f".. autoclass:: primkit.{name}\n   :members:"
    if inspect.isfunction(value):
        return f".. autofunction:: primkit.{name}"
    shown = repr(value)
    what = shown if len(shown) < LONGEST_VALUE and " at 0x" not in shown else f"a {type(value).__name__}"
    return f".. data:: primkit.{name}\n\n   ``{what}``"
