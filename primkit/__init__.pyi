# The table of contents: every public name, in the order of the story; then the wings. `X as X` is how a stub says that
# a name is meant to be used from here. Both type checkers and `primkit` itself read it: there is no other list.

__version__: str

from .shapes import Circle as Circle, Polygon as Polygon
from .world import World as World, random_world as random_world
from .robot import teleport_poses as teleport_poses, skipped_waypoints as skipped_waypoints, drive as drive
from .robot import published_poses as published_poses, odometry as odometry
from .raycast import cast_rays as cast_rays
from .sensors import Lidar as Lidar, RPLIDAR_A1 as RPLIDAR_A1, LDS_01 as LDS_01
from .lidar import Scans as Scans, scan as scan, scan_blocks as scan_blocks
from .grid import Grid as Grid
from .driving.moving_grid import MovingGrid as MovingGrid

from .segmentation import segment as segment, kmeans as kmeans, count_by_silhouette as count_by_silhouette, link as link
from .ransac import run_ransac as run_ransac, draw_samples as draw_samples, trials_needed as trials_needed
from .lines import Line as Line, LINE as LINE, fit_line as fit_line, find_lines as find_lines
from .circles import CIRCLE as CIRCLE, fit_circle as fit_circle, find_circle as find_circle
from .measure import Detection as Detection, measure_shape as measure_shape
from .paper import measure_as_published as measure_as_published
from .steps import Steps as Steps
from .pipeline import find_shapes as find_shapes, Settings as Settings, PAPER as PAPER, ROBUST as ROBUST
from .evaluation import evaluate as evaluate, match as match
from .report import Report as Report

from .driving.mapper import Mapper as Mapper
from .driving.align import align as align, Alignment as Alignment
from .driving.steady import steady as steady
from .driving import explore as explore, Exploration as Exploration
from .driving.scripted import scripted_route as scripted_route
from .parts import Composite as Composite, Apart as Apart, take_apart as take_apart
from .parts import Camera as Camera, Views as Views, look as look, colors_of as colors_of
from .formats import load_world as load_world, save_world as save_world
from .formats import load_found as load_found, save_found as save_found
from .formats import load_scans as load_scans, save_scans as save_scans
from .formats import Drive as Drive, record_drive as record_drive, load_drive as load_drive, save_drive as save_drive
from .formats import paper_suite as paper_suite, published_suite as published_suite, scripted_drives as scripted_drives
from .study import run_study as run_study, repeat_study as repeat_study, tables as tables
from .plots import plot_world as plot_world, plot_scan as plot_scan, plot_points as plot_points
from .plots import plot_clusters as plot_clusters, plot_found as plot_found
from .plots import plot_story as plot_story, plot_drive as plot_drive, save_figure as save_figure
from .scene import drive_scene as drive_scene, replay as replay
from .course.personal import personal_world as personal_world

from . import driving as driving, parts as parts, formats as formats, study as study
from . import plots as plots, widgets as widgets, scene as scene
from . import checks as checks, course as course, commands as commands
from . import space as space
