"""Styles: the same right result in the forms that students return: lists, tuples, arrays, numbers of all makes.

In:  a right function.
Out: by name, functions that return the same in another form; None stays None, a text a text.
"""

import numpy as np


def each(change, value):
    """Change the numbers and arrays within lists, tuples and sets, however deep."""
    if isinstance(value, (list, tuple, set, frozenset)):
        return type(value)(each(change, part) for part in value)
    return change(value)


def unpacked(kind):
    """Return a change of arrays, lists and tuples into lists, or into tuples."""

    def change(value):
        if isinstance(value, np.ndarray):
            value = value.tolist()
        return kind(map(change, value)) if isinstance(value, (list, tuple)) else value

    return change


def as_array(value):
    """Make one array of numbers in lists and tuples; what fits into none stays, and an index beside a length."""
    if not isinstance(value, (list, tuple)) or len({isinstance(part, (int, np.integer)) for part in value}) != 1:
        return value
    try:
        found = np.array(value)
    except ValueError:  # parts of different lengths
        return type(value)(map(as_array, value))
    return found if found.dtype.kind in "biuf" else value


def of_array(change):
    return lambda value: each(lambda part: change(part) if isinstance(part, np.ndarray) else part, value)


def of_number(change):
    def changed(part):
        number = isinstance(part, (int, float, np.integer, np.floating)) and not isinstance(part, (bool, np.bool))
        return change(part) if number else part

    return lambda value: each(changed, value)


def read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


STYLES = {
    "lists": unpacked(list),
    "tuples": unpacked(tuple),
    "one array": as_array,
    "Python's numbers": of_number(lambda x: x.item() if isinstance(x, np.generic) else x),
    "NumPy's numbers": of_number(lambda x: np.int64(x) if isinstance(x, (int, np.integer)) else np.float64(x)),
    "whole numbers where they are whole": of_number(lambda x: int(x) if np.isfinite(x) and x == int(x) else x),
    "read-only arrays": of_array(read_only),
    "columns first": of_array(np.asfortranarray),
    "every second place of a longer array": of_array(lambda a: np.repeat(a, 2, axis=-1)[..., ::2] if a.ndim else a),
    "short whole numbers": of_array(lambda a: a.astype(np.int16) if a.dtype.kind in "iu" else a),
}


def styled(function):
    """Return name -> function that returns the same in another form."""

    def with_style(change):
        return lambda *args: change(function(*args))

    return {name: with_style(change) for name, change in STYLES.items()}
