"""primkit: a teaching kit for mobile-robot perception.

A robot with a LiDAR stands among circles, rectangles, triangles and pentagons; primkit simulates what it sees,
and finds, names and measures the shapes. The public names, in the order of the story:

>>> import primkit as pk
>>> world = pk.random_world(4, rng=7)              # a board with shapes: the truth
>>> lidar = pk.Lidar()                             # the sensor
>>> poses = pk.teleport_poses(world)               # where the robot stands
>>> scans = pk.scan(world, poses, lidar, rng=0)    # what it sees
>>> grid = pk.Grid(resolution=0.001)
>>> grid.add(scans)                                # all hits, on cells of 1 mm
>>> found = pk.find_shapes(grid.points(), rng=0)   # the shapes
>>> pk.evaluate(found, world).weighted_accuracy    # how right they are
1.0

Each name is loaded from its module on first use, so that ``import primkit`` is quick.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_STORY = {
    "shapes": ("Circle", "Polygon"),
    "world": ("World", "random_world"),
    "robot": ("teleport_poses", "skipped_waypoints", "drive"),
    "raycast": ("cast_rays",),
    "lidar": ("Lidar", "Scans", "scan", "scan_blocks"),
    "course.personal": ("personal_world",),
    "grid": ("Grid",),
    "driving.moving_grid": ("MovingGrid",),
    "segmentation": ("segment", "kmeans", "count_by_silhouette", "link"),
    "ransac": ("run_ransac", "trials_needed"),
    "lines": ("Line", "fit_line", "find_lines"),
    "circles": ("fit_circle", "find_circle"),
    "measure": ("Detection", "measure_shape"),
    "steps": ("Steps",),
    "pipeline": ("find_shapes", "Settings", "PAPER", "ROBUST"),
    "driving": ("explore", "Exploration"),
    "evaluation": ("evaluate", "match", "Report"),
    "formats": (
        *("load_world", "save_world", "load_scans", "save_scans"),
        *("Drive", "record_drive", "load_drive", "save_drive", "paper_suite", "scripted_drives"),
    ),
    "driving.scripted": ("scripted_route",),
    "study": ("run_study", "tables"),
    "plots": (
        *("plot_world", "plot_scan", "plot_points", "plot_clusters", "plot_found"),
        *("plot_story", "plot_drive", "save_figure"),
    ),
    "scene": ("drive_scene", "replay"),
}
# Rooms that are used by their own name: pk.widgets.rays(), pk.checks.ray_segment(mine).
_ROOMS = ("widgets", "checks")
_HOME = {name: module for module, names in _STORY.items() for name in names}

__all__ = [*_HOME, *_ROOMS]


def __getattr__(name: str) -> Any:
    if name in _ROOMS:
        return import_module(f"primkit.{name}")  # the import itself keeps it in the namespace
    if name not in _HOME:
        raise AttributeError(f"module 'primkit' has no attribute {name!r}")
    # Kept in the module's namespace: the next use is an ordinary look-up.
    value = getattr(import_module(f"primkit.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


if TYPE_CHECKING:
    from . import checks, widgets
    from .circles import find_circle, fit_circle
    from .course.personal import personal_world
    from .driving import Exploration, explore
    from .driving.moving_grid import MovingGrid
    from .evaluation import Report, evaluate, match
    from .formats import (
        Drive,
        load_drive,
        load_scans,
        load_world,
        paper_suite,
        record_drive,
        save_drive,
        save_scans,
        save_world,
        scripted_drives,
    )
    from .grid import Grid
    from .lidar import Lidar, Scans, scan, scan_blocks
    from .lines import Line, find_lines, fit_line
    from .measure import Detection, measure_shape
    from .pipeline import PAPER, ROBUST, Settings, find_shapes
    from .plots import (
        plot_clusters,
        plot_drive,
        plot_found,
        plot_points,
        plot_scan,
        plot_story,
        plot_world,
        save_figure,
    )
    from .ransac import run_ransac, trials_needed
    from .raycast import cast_rays
    from .robot import drive, skipped_waypoints, teleport_poses
    from .scene import drive_scene, replay
    from .segmentation import count_by_silhouette, kmeans, link, segment
    from .shapes import Circle, Polygon
    from .steps import Steps
    from .study import run_study, scripted_route, tables
    from .world import World, random_world
