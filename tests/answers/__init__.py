"""Answers to the lessons' tasks: for each, other correct ways than the library's, and usual wrong ones.

Each module ``lesson_XX`` has a dictionary ANSWERS, from the name of a task in primkit.checks to

* "right": correct functions by other algorithms, by name;
* "wrong": pairs (function, what its message must contain), by name;
* "error": pairs (function, what its message must contain), by name, for functions that raise.
"""
