"""Camera: a strip of colours over bearings, beside the LiDAR's strip of ranges.

The e-puck's camera has 52 x 39 pixels over 56 degrees: a pixel is 1.08 degrees, 5.6 mm at 0.3 m. On a board all that
stands upright looks alike in each row, so that a view is one row, the mean of all. A pinhole: columns are evenly spread
across the image plane, not over angles::

    column i sees the bearings whose tangent lies between  t_i  and  t_(i+1),   t_i = tan(fov / 2) (1 - 2 i / width)

In:  a ``World``, poses, shape (P, 3): x [m], y [m], heading [rad], a ``Camera`` and a colour for each shape.
Out: ``Views``: ``.pixels``, shape (P, width, 3), red, green and blue from 0 to 1; and of each LiDAR hit its colour.

>>> from primkit.shapes import Circle
>>> from primkit.world import World
>>> views = look(World([Circle((0.3, 0), 0.05)]), [(0, 0, 0)], colors=[(1, 0, 0)])
>>> views.pixels.shape, views.pixels[0, 26].round(2).tolist()
((1, 52, 3), [1.0, 0.0, 0.0])

Not here: what a camera knows of ranges (nothing), lenses, and shadows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import Floats, Ints, as_count, as_floats, as_poses, as_positive, as_rng, check_type
from ..lidar import Scans
from ..raycast import cast_rays
from ..world import World

RAYS_PER_COLUMN = 8  # a pixel at an edge shows both sides of it, by their shares
FLOOR_COLOR = (0.6, 0.6, 0.6)  # what is behind all shapes: grey, so that it has no hue
LEAST_SATURATION = 0.35  # below, a pixel is floor, or a mixture with it
HUES_APART = np.radians(30)  # hues that lie closer are of one colour
LEAST_OF_HUE = 0.02  # of all pixels with a hue: fewer are mixtures


@dataclass(frozen=True)
class Camera:
    """A camera that looks ahead; the e-puck's, when not told otherwise.

    Raises ValueError if a number is out of its range.

    Parameters
    ----------
    width, height : int
        Pixels; the strip is the mean of ``height`` rows.
    field_of_view : float
        Over the whole width, radians.
    turned : float
        By how much the camera is turned to the left against the heading, radians; one that is mounted well: 0.
    light : float
        Each view is brighter or darker by a share of up to this: 0.3 for +-30 %.
    noise_std : float
        Of each pixel's red, green and blue, as a share of full brightness.

    Examples
    --------
    >>> camera = Camera()
    >>> np.degrees([camera.field_of_view / camera.width, *camera.edges[[0, -1]]]).round(2).tolist()
    [1.08, 28.0, -28.0]
    """

    width: int = 52
    height: int = 39
    field_of_view: float = float(np.radians(56))
    turned: float = 0.0
    light: float = 0.0
    noise_std: float = 0.0

    def __post_init__(self) -> None:
        for name in ("width", "height"):
            as_count(getattr(self, name), name)
        for name in ("light", "noise_std"):
            as_positive(getattr(self, name), name, zero=True)
        if not 0 < as_positive(self.field_of_view, "field_of_view") < np.pi:
            raise ValueError(f"field_of_view must be below pi radians, got {self.field_of_view:g}")

    @property
    def edges(self) -> Floats:
        """Bearings between which the columns lie, shape (width + 1,), radians from the heading, from left to right."""
        return self.turned + np.arctan(np.tan(self.field_of_view / 2) * np.linspace(1, -1, self.width + 1))


@dataclass(frozen=True, eq=False)
class Views:
    """What a camera saw from each pose.

    Parameters
    ----------
    poses : array, shape (P, 3): x [m], y [m], heading [rad], world frame
    camera : Camera
        As one believes it to be: ``turned`` by 0, as far as one knows.
    pixels : array, shape (P, width, 3): red, green and blue, 0 to 1
    """

    poses: Floats
    camera: Camera
    pixels: Floats

    @property
    def hues(self) -> Floats:
        """The hue of each pixel, shape (P, width), radians; NaN where it has none."""
        red, green, blue = np.moveaxis(self.pixels, 2, 0)
        high, low = self.pixels.max(axis=2), self.pixels.min(axis=2)
        hue = np.arctan2(np.sqrt(3) * (green - blue), 2 * red - green - blue) % (2 * np.pi)
        return np.where(high - low >= LEAST_SATURATION * np.maximum(high, 1e-9), hue, np.nan)

    def colors(self) -> tuple[Ints, Floats]:
        """Return the number of each pixel's colour, shape (P, width), -1 for none; and the hues of all colours, (C,).

        Hues are of one colour unless a gap of 30 degrees parts them; a mixture of two, at an edge, has no number.
        """
        hues = self.hues
        inner = ~np.isnan(hues)
        for side in (-1, 1):  # a pixel with unlike neighbours on a side is at an edge
            near = np.roll(hues, side, axis=1)
            near[:, 0 if side == 1 else -1] = np.nan
            inner &= np.abs((hues - near + np.pi) % (2 * np.pi) - np.pi) < HUES_APART / 2
        if not inner.any():
            return np.full(hues.shape, -1), np.empty(0)
        order = np.sort(hues[inner])
        gaps = np.flatnonzero(np.diff(order, append=order[0] + 2 * np.pi) > HUES_APART)
        groups = np.split(order, gaps + 1) if len(gaps) else [order]
        if len(groups) > 1:
            groups = [np.append(groups[-1] - 2 * np.pi, groups[0]), *groups[1:-1]]
        groups = [group for group in groups if len(group) > LEAST_OF_HUE * len(order)]
        known = np.array([np.median(group) % (2 * np.pi) for group in groups])
        off = np.abs((hues[..., None] - known + np.pi) % (2 * np.pi) - np.pi)
        near = np.where(np.isnan(hues), np.inf, np.nanmin(np.where(np.isnan(off), np.inf, off), axis=2))
        number = np.where(np.isnan(off), np.inf, off).argmin(axis=2)
        return np.where(near < HUES_APART / 2, number, -1), known


def look(
    world: World,
    poses: ArrayLike,
    camera: Camera | None = None,
    *,
    colors: ArrayLike | None = None,
    rng: int | np.random.Generator | None = None,
) -> Views:
    """Look at the world once from each pose.

    Raises ValueError if the poses are not finite (P, 3), or there is not one colour for each shape, from 0 to 1.

    Parameters
    ----------
    world : World
    poses : array_like, shape (P, 3)
        x [m], y [m], heading [rad], world frame.
    camera : Camera, optional
        The e-puck's when not given.
    colors : array_like, shape (S, 3), optional
        Red, green and blue of each of the world's shapes, 0 to 1; hues evenly spread when not given.
    rng : seed or numpy.random.Generator, optional
        For light and noise.

    Examples
    --------
    What stands behind is hidden:

    >>> from primkit.shapes import Circle
    >>> views = look(World([Circle((0.2, 0), 0.05), Circle((0.4, 0), 0.05)]), [(0, 0, 0)])
    >>> sorted(set(views.colors()[0][0].tolist())), len(views.colors()[1])
    ([-1, 0], 1)
    """
    check_type(world, World, "world must be a World, as in look(world, poses)")
    poses, camera, rng = as_poses(poses), camera or Camera(), as_rng(rng)
    n = len(world.shapes)
    paint = _even_hues(n) if colors is None else as_floats(colors, "colors", "(S, 3)")
    if paint.shape != (n, 3) or not ((paint >= 0) & (paint <= 1)).all():
        raise ValueError(f"colors must be {n} rows of red, green and blue from 0 to 1, got shape {paint.shape}")
    share = (np.arange(camera.width * RAYS_PER_COLUMN) + 0.5) / RAYS_PER_COLUMN
    across = np.interp(share, np.arange(camera.width + 1), np.tan(camera.edges - camera.turned))
    bearings = camera.turned + np.arctan(across)
    ranges = cast_rays(world, poses, bearings[::-1].copy())[:, ::-1]
    seen = np.concatenate([paint, [FLOOR_COLOR]])[_shape_hit(world, poses, bearings, ranges)]
    strips = seen.reshape(len(poses), camera.width, RAYS_PER_COLUMN, 3).mean(axis=2)
    strips *= 1 + camera.light * rng.uniform(-1, 1, (len(poses), 1, 1))
    strips += camera.noise_std / np.sqrt(camera.height) * rng.standard_normal(strips.shape)
    believed = Camera(camera.width, camera.height, camera.field_of_view)
    return Views(poses, believed, np.clip(strips, 0.0, 1.0))


def _even_hues(n: int) -> Floats:
    """Return n colours of full saturation, their hues evenly spread, shape (n, 3)."""
    hue = np.arange(n)[:, None] * (6 / max(n, 1)) + np.array([0.0, 4.0, 2.0])
    return np.clip(np.abs(hue % 6 - 3) - 1, 0.0, 1.0)


def _shape_hit(world: World, poses: Floats, bearings: Floats, ranges: Floats) -> Ints:
    """Return which shape each ray met, shape (P, R); the number of shapes where it met none."""
    hit = np.full(ranges.shape, len(world.shapes))
    pose, ray = np.nonzero(np.isfinite(ranges))
    at = poses[pose, 2] + bearings[ray]
    places = poses[pose, :2] + ranges[pose, ray][:, None] * np.column_stack([np.cos(at), np.sin(at)])
    if len(places):
        hit[pose, ray] = np.argmin([np.abs(shape.signed_distance(places)) for shape in world.shapes], axis=0)
    return hit


def colors_of(scans: Scans, views: Views) -> Ints:
    """Return the colour of each hit of scans from the same poses, shape (N,), as ``scans.points()``; -1 for unknown.

    A hit at a bearing takes the colour of the column there. Raises ValueError if the poses differ.
    """
    if not np.array_equal(scans.poses, views.poses):
        raise ValueError(f"scans and views must be from the same poses, got {len(scans.poses)} and {len(views.poses)}")
    numbers = views.colors()[0]
    pose, beam = np.nonzero(scans.hits)
    bearing = (scans.angles[beam] + np.pi) % (2 * np.pi) - np.pi
    half = np.tan(views.camera.field_of_view / 2)
    column = np.floor((1 - np.tan(np.clip(bearing, -1.5, 1.5)) / half) / 2 * views.camera.width).astype(int)
    inside = (np.abs(bearing) < views.camera.field_of_view / 2) & (column >= 0) & (column < views.camera.width)
    return np.where(inside, numbers[pose, np.clip(column, 0, views.camera.width - 1)], -1)
