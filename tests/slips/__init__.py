"""Slips: mutants of a right answer to each task, made by a script, and whether a check names the slip in each of them.

``right.py`` has one plain right answer to each task of a lesson, written as the lesson teaches it; those to the problem
sets stand in their notebooks. ``make.py`` makes the slips, ``slips.json`` lists them, ``named.py`` measures.
"""
