"""Parts: composites of basic shapes, taken apart; and a camera beside the LiDAR."""

from .apart import Apart, take_apart
from .camera import Camera, Views, colors_of, look
from .composite import Composite

__all__ = ["Apart", "Camera", "Composite", "Views", "colors_of", "look", "take_apart"]
