"""Space: the story one dimension up, for a LiDAR of many layers.

In:  a ``Scene`` of spheres, cylinders and boxes over a ground; the places that the sensor stands at.
Out: a ``Cloud``; the solids in it, each with its sizes, how sure they are, and what is open.

>>> from primkit import space
>>> scene = space.random_scene(2, rng=3)
>>> cloud = space.scan(scene, [(-2.5, -2.5, 0.6), (2.5, 2.5, 0.9)], rng=0)
>>> [found.kind for found in space.find_solids(cloud, rng=0)] == [solid.kind for solid in scene.solids]
True

The rooms, from what there is to what is found: ``solids``, ``scenes``, ``lidar3d``; ``consensus`` (RANSAC's models),
``ground``; ``along_beam``, ``ends``, ``starts``, ``explanations``: the estimator; ``finding``. Beside them
``points_alone``, ``solid_files`` and ``solid_view``. The story does not know this wing.
"""

from .consensus import CYLINDER, PLANE, SPHERE, with_nearest
from .explanations import FoundSolid
from .finding import find_solids
from .lidar3d import Cloud, Lidar3d, scan
from .points_alone import solid_through
from .scenes import Scene, random_scene
from .solid_files import as_json, from_json
from .solid_view import view
from .solids import Box, Cylinder, Plane, Sphere

__all__ = ["Plane", "Sphere", "Cylinder", "Box", "Scene", "random_scene", "Lidar3d", "Cloud", "scan"]
__all__ += ["PLANE", "SPHERE", "CYLINDER", "with_nearest", "find_solids", "FoundSolid"]
__all__ += ["solid_through", "as_json", "from_json", "view"]
