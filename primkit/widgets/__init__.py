"""Widgets: pictures that change while you move a slider; one for each lesson.

Beside the story. A lesson shows its slider with ``pk.widgets.rays()``,
and below it the same picture for a few named settings, which needs no Python behind it: ``pk.widgets.rays().twin()``.

In:  a lesson's values: beams, noise, a seed.
Out: an ``Explorer``; its ``draw(**values)`` returns the picture as SVG text.

>>> svg = rays().draw(beams=24)
>>> what_it_says(svg)
'9 of 24 beams meet an outline within 0.3 m, with noise of 0 mm; the nearest hit is 17.0 cm away.'

The rooms, each of which imports only those before it:

===============  ==================================================
``drawing.py``   SVG as text: axes in metres, points, shapes
``slider.py``    ``explore``: controls, named settings, the twin
``boards.py``    lesson 00: a board for each seed
``rays.py``      lesson 01: beams among shapes
``cells.py``     lesson 02: a circle seen through the grid
``groups.py``    lesson 03: K-Means step by step
``edges.py``     lesson 04: RANSAC trial by trial, and its band
``arcs.py``      lesson 05: the circles that five ways see in an arc
``naming.py``    lesson 06: candidates, what each costs, the chosen one
``scoring.py``   lesson 07: tolerance, weights, one-sided or two-sided
``wheels.py``    lesson 08: the arc that two wheels make, and straight pieces
===============  ==================================================
"""

from .arcs import arcs
from .boards import boards
from .cells import cells
from .drawing import what_it_says
from .edges import edges
from .groups import groups
from .naming import naming
from .rays import rays
from .scoring import scoring
from .slider import Choice, Explorer, Slider, explore
from .wheels import wheels

# The lessons' sliders, in the order of the lessons: tests move each of them to all corners of its box.
SLIDERS = (boards, rays, cells, groups, edges, arcs, naming, scoring, wheels)

__all__ = [
    "boards",
    "rays",
    "cells",
    "groups",
    "edges",
    "arcs",
    "naming",
    "scoring",
    "wheels",
    "explore",
    "Explorer",
    "Slider",
    "Choice",
    "what_it_says",
    "SLIDERS",
]
