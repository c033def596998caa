"""Widgets: pictures that change while you move a slider; one for each lesson.

Beside the story. A lesson shows its slider with ``pk.widgets.rays()``,
and below it the same picture for a few named settings, which needs no Python behind it: ``pk.widgets.rays().twin()``.
The drawing behind the lesson's formula is ``pk.widgets.rays().diagram()``.

What a student guesses beforehand is asked for by ``predict``, and drawn into the ``answer``.

In:  a lesson's values: beams, noise, a seed.
Out: an ``Explorer``; its ``draw(**values)`` returns the picture as SVG text.

>>> svg = rays().draw(beams=24)
>>> what_it_says(svg)
'9 of 24 beams meet an outline within 0.3 m, with noise of 0 mm; the nearest hit is 17.0 cm away.'
"""

from .arcs import arcs, show_circles
from .boards import boards
from .cells import cells
from .composites import composites, show_apart
from .edges import edges, show_lines
from .groups import groups
from .layers import layers
from .naming import fit_each_kind, naming
from .poses import poses, show_maps
from .predictions import answer, guesses, predict, read_quiz
from .rays import rays
from .scoring import scoring
from .slider import Choice, Explorer, Slider, explore
from .svg import what_it_says
from .wheels import wheels

# The lessons' sliders, in the order of the lessons: tests move each of them to all corners of its box.
SLIDERS = (boards, rays, cells, groups, edges, arcs, naming, scoring, wheels, poses, layers, composites)

__all__ = ["boards", "rays", "cells", "groups", "edges", "arcs", "naming", "scoring", "wheels", "poses", "SLIDERS"]
__all__ += ["show_lines", "show_circles", "fit_each_kind", "explore", "Explorer", "Slider", "Choice", "what_it_says"]
__all__ += ["layers", "composites", "show_apart"]
__all__ += ["predict", "answer", "guesses", "read_quiz", "show_maps"]
