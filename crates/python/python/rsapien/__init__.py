"""A toy humanoid as a laboratory robot, and an ellipse detector.

``Robot`` is the robot, real or virtual; ``Registry`` its actions; ``detect`` finds ellipses in a numpy
array, ``Detector`` in many, and ``Tracker`` follows them through a video; ``pose`` leads from an ellipse to
space. Every error is a ``RsapienError``, but for wrong types and values, which are ``TypeError`` and
``ValueError`` as usual.
"""

from rsapien import pose
from rsapien._rsapien import (
    ActionRefused,
    BadReport,
    ControllerHeld,
    Detection,
    Detector,
    Ellipse,
    LinkError,
    LinkTimeout,
    MotionInterrupted,
    Outcome,
    OutcomeUnknown,
    Registry,
    RegistryError,
    RegistryTooNew,
    Robot,
    RobotRefused,
    RsapienError,
    Track,
    Tracker,
    UnknownAction,
    __version__,
    detect,
)

__all__ = [
    "ActionRefused",
    "BadReport",
    "ControllerHeld",
    "Detection",
    "Detector",
    "Ellipse",
    "LinkError",
    "LinkTimeout",
    "MotionInterrupted",
    "Outcome",
    "OutcomeUnknown",
    "Registry",
    "RegistryError",
    "RegistryTooNew",
    "Robot",
    "RobotRefused",
    "RsapienError",
    "Track",
    "Tracker",
    "UnknownAction",
    "__version__",
    "detect",
    "pose",
]
