"""A toy humanoid as a laboratory robot, and an ellipse detector.

``Robot`` is the robot, real or virtual (``aio.Robot`` for programs with asyncio); ``Registry`` keeps its actions, and
``Action`` builds one in code; ``Recording`` reads what was recorded; ``detect`` finds ellipses in a numpy
array, ``Detector`` in many, and ``Tracker`` follows them through a video; ``pose`` leads from an ellipse to
space. Every error is a ``RsapienError``, but for wrong types and values, which are ``TypeError`` and
``ValueError`` as usual.
"""

from rsapien import aio, pose
from rsapien._rsapien import (
    ActionRefused,
    BadReport,
    ControllerHeld,
    Detection,
    Detector,
    Ellipse,
    Finding,
    Guest,
    LinkError,
    LinkTimeout,
    MotionInterrupted,
    Outcome,
    OutcomeUnknown,
    Recorder,
    Recording,
    RecordingError,
    Registry,
    RegistryError,
    RegistryTooNew,
    Robot,
    RobotRefused,
    RsapienError,
    Timeline,
    Track,
    Tracker,
    UnknownAction,
    __version__,
    detect,
)
from rsapien.action import Action

__all__ = [
    "Action",
    "ActionRefused",
    "BadReport",
    "ControllerHeld",
    "Detection",
    "Detector",
    "Ellipse",
    "Finding",
    "Guest",
    "LinkError",
    "LinkTimeout",
    "MotionInterrupted",
    "Outcome",
    "OutcomeUnknown",
    "Recorder",
    "Recording",
    "RecordingError",
    "Registry",
    "RegistryError",
    "RegistryTooNew",
    "Robot",
    "RobotRefused",
    "RsapienError",
    "Timeline",
    "Track",
    "Tracker",
    "UnknownAction",
    "__version__",
    "aio",
    "detect",
    "pose",
]
