"""From an ellipse back to space: where a circle or a ball of known radius stands that a camera sees as this ellipse.

The camera is a pinhole; undo the distortion of a lens first. Places are in metres from its centre of projection, x to the
right, y down, z forward, so that what is seen has a positive z.
"""

from rsapien._rsapien import (
    BallPosition,
    CirclePose,
    Intrinsics,
    ball_position,
    circle_poses,
    project_ball,
    project_circle,
)

__all__ = [
    "BallPosition",
    "CirclePose",
    "Intrinsics",
    "ball_position",
    "circle_poses",
    "project_ball",
    "project_circle",
]
