"""The compiled module. Import from ``rsapien``."""

from collections.abc import Callable, Iterator, Sequence
from os import PathLike
from types import TracebackType
from typing import Any, Literal, Optional, TypedDict, Union, Protocol

import numpy as np
from numpy.typing import NDArray

__version__: str

class RsapienError(Exception):
    """What every error of this module is."""

class LinkError(RsapienError):
    """The link cannot be opened, or was lost."""

class LinkTimeout(LinkError):
    """The robot does not answer."""

class RobotRefused(RsapienError):
    """A controller said no."""

    status: int
    """Its status: 2 bad argument, 6 held, 9 not initialised, … (SPEC.md)."""

class ControllerHeld(RsapienError):
    """Another holder has the controller."""

class MotionInterrupted(RsapienError):
    """What was under way ended early."""

class OutcomeUnknown(RsapienError):
    """Whether the robot did it is unknown."""

class BadReport(RsapienError):
    """A report this version does not understand."""

class RecordingError(RsapienError):
    """A recording cannot be read or written."""

class RegistryError(RsapienError):
    """The registry could not do it."""

class RegistryTooNew(RegistryError):
    """A newer program wrote the registry."""

class UnknownAction(RegistryError):
    """The registry has no such action."""

class ActionRefused(RegistryError):
    """An action that is wrong; the text says where."""

RotatedRect = tuple[tuple[float, float], tuple[float, float], float]

class Ellipse:
    """An ellipse: pixel centres at integers, y down, lengths in pixels, angles in radians."""

    def __new__(
        cls, center_x: float, center_y: float, semi_major: float, semi_minor: float, theta: float = 0.0
    ) -> Ellipse:
        """An ellipse by its numbers, as in ``Ellipse(*row)`` with a row of ``Detection.to_array()``.

        Semi-axes in the wrong order are swapped, and ``theta`` with them. Raises ``ValueError`` where one
        is not above 0.
        """
    @staticmethod
    def from_rotated_rect(rect: RotatedRect) -> Ellipse:
        """From OpenCV's ``RotatedRect``, as ``cv2.fitEllipse`` returns it."""
    def to_rotated_rect(self) -> RotatedRect:
        """OpenCV's ``RotatedRect``, as ``cv2.ellipse`` takes it: centre, (width, height), degrees.

        The width is the major axis, twice ``semi_major``.
        """
    def patch(self, **kwargs: Any) -> Any:
        """A ``matplotlib.patches.Ellipse`` for axes that show the picture with ``imshow``.

        Keyword arguments are the patch's; without ``fill=True`` it is a line. Needs matplotlib.
        """
    @property
    def center(self) -> tuple[float, float]:
        """x and y of the centre, in pixels."""
    @property
    def semi_major(self) -> float:
        """Half of the major axis, in pixels."""
    @property
    def semi_minor(self) -> float:
        """Half of the minor axis, in pixels; not above ``semi_major``."""
    @property
    def theta(self) -> float:
        """Angle of the major axis from +x towards +y, in radians."""
    @property
    def score(self) -> Optional[float]:
        """How much speaks for it, 0 to 1.

        This and what follows is ``None`` for an ellipse that the default detector did not find.
        """
    @property
    def support_share(self) -> Optional[float]:
        """Share of the contour inside the picture along which an edge was found."""
    @property
    def gradient_agreement(self) -> Optional[float]:
        """Mean cosine of the angle between the gradient at these edges and the ellipse's normal."""
    @property
    def log10_false_alarms(self) -> Optional[float]:
        """Logarithm of the number of ellipses as good as this that chance would show in the picture."""
    @property
    def residual(self) -> Optional[float]:
        """Root mean square distance of the edges from the ellipse, in pixels."""
    @property
    def stroke_width(self) -> Optional[float]:
        """Width of the drawn stroke whose middle line this is, in pixels; ``None`` for an edge."""
    @property
    def covariance(self) -> Optional[NDArray[np.float64]]:
        """Shape (5, 5), of centre x, centre y, semi-major, semi-minor, theta; with ``covariance=True``."""
    @property
    def support_points(self) -> NDArray[np.float32]:
        """Shape (n, 3): x, y and direction of the gradient; empty without ``support_points=True``."""
    @property
    def quality(self) -> Optional[int]:
        """The paper's ellipse quality, edge points on the contour; ``None`` without ``preset="paper"``."""
    def contains(self, x: float, y: float) -> bool:
        """Whether a point of the picture lies inside."""
    def overlap(self, other: Ellipse) -> float:
        """Area of the intersection over area of the union, 0 to 1."""
    def __iter__(self) -> Iterator[float]:
        """Centre x, centre y, semi-major, semi-minor, theta."""

class Statistics(TypedDict, total=False):
    """Counts of what a detection did: the first six of the default detector, the others of the paper's."""

    edge_points: int
    chains: int
    arcs: int
    pairs: int
    candidates: int
    accepted: int
    search_point_pairs: int
    virtual_ellipses: int
    real_ellipses: int
    quality_min: int

class Detection(Sequence[Ellipse]):
    """What a detection found, best first. It keeps a reference to the picture, for ``draw``."""

    @property
    def ellipses(self) -> list[Ellipse]: ...
    @property
    def scores(self) -> NDArray[np.float64]:
        """The ellipses' scores, 0 to 1; not a number with ``preset="paper"``, which has none."""
    @property
    def statistics(self) -> Statistics: ...
    @property
    def truncated(self) -> bool:
        """Whether a limit was met, so that there may be more."""
    @property
    def milliseconds(self) -> float:
        """What the detection took."""
    def to_array(self) -> NDArray[np.float64]:
        """Shape (n, 5): centre x, centre y, semi-major, semi-minor, theta."""
    def to_structured(self) -> NDArray[np.void]:
        """Shape (n,), with the fields ``center_x``, ``center_y``, ``semi_major``, ``semi_minor``, ``theta``, ``score``."""
    def draw(self, image: Optional[Picture] = None) -> NDArray[np.uint8]:
        """A copy of the picture (or of ``image``) with the ellipses drawn: shape (height, width, 3), RGB."""
    def __len__(self) -> int: ...
    def __getitem__(self, index: int) -> Ellipse: ...  # type: ignore[override]

class Detector:
    """The default detector with its buffers: quicker than ``detect`` in a series of pictures."""

    def __new__(
        cls,
        *,
        semi_axis_min: Optional[float] = None,
        semi_axis_max: Optional[float] = None,
        axis_ratio_min: Optional[float] = None,
        score_min: Optional[float] = None,
        region: Optional[Region] = None,
        strokes: Optional[Literal["middle", "edges"]] = None,
        support_points: Optional[bool] = None,
        covariance: Optional[bool] = None,
        seed: Optional[int] = None,
    ) -> Detector:
        """The options are those of ``detect``."""
    def detect(self, image: Picture) -> Detection:
        """Finds ellipses; several threads that call this wait for each other."""
    def detect_many(self, images: Sequence[Picture], *, threads: Optional[int] = None) -> list[Detection]:
        """Finds the ellipses of many pictures in parallel; the results are in the pictures' order.

        ``threads``, 1 to 256, is as many as the processor has where it is not given; it changes the time
        and nothing else. Errors name the picture's index.
        """

class Track:
    """An ellipse followed from picture to picture, as it stood after one of them."""

    @property
    def id(self) -> int:
        """Who it is: lasts as long as the track and is given to no other one."""
    @property
    def ellipse(self) -> Ellipse:
        """The ellipse in this picture, smoothed; where it should be, if the picture does not show it."""
    @property
    def score(self) -> float:
        """The ellipse's score when it was last seen, 0 to 1."""
    @property
    def state(self) -> Literal["tentative", "confirmed", "predicted"]:
        """Not seen often enough yet; seen in this picture and often enough; not seen in this picture."""
    @property
    def velocity(self) -> tuple[float, float]:
        """x and y of the centre's velocity, in pixels a second."""
    @property
    def center_deviation(self) -> tuple[float, float]:
        """Standard deviation of the centre's x and y in pixels, as the filter estimates it."""
    @property
    def age(self) -> int:
        """Pictures since it was first seen, that one included."""
    @property
    def sightings(self) -> int:
        """Pictures that showed it."""
    @property
    def misses(self) -> int:
        """Pictures since one showed it; 0 if this one did."""

class Tracker:
    """Finds ellipses in a series of pictures and follows them, each by a number that lasts."""

    def __new__(
        cls,
        detector: Optional[Detector] = None,
        *,
        fresh_every: Optional[int] = None,
        confirmations: Optional[int] = None,
        misses_max: Optional[int] = None,
        overlap_min: Optional[float] = None,
        noise: Optional[float] = None,
        acceleration: Optional[float] = None,
        speed: Optional[float] = None,
    ) -> Tracker:
        """A tracker that looks with a copy of ``detector``, or with the default options.

        Every ``fresh_every``-th picture, 1 to 1000, is looked at as a whole, the others near what is followed: new
        ellipses are found in the former. ``confirmations``, 1 to 100, pictures must show an ellipse until its track is
        confirmed; one that is not seen is kept for ``misses_max``, 0 to 1000. ``overlap_min``, 0.05 to 0.95, is the
        least overlap of a prediction with what it is taken for.

        The filter has ``noise``, the least standard deviation of a measured place in pixels, 0.001 to 100;
        ``acceleration``, by which velocities change, in pixels a second squared, 0 to 1000000: the lower, the
        smoother; and ``speed``, that of what is seen for the first time, in pixels a second, 0 to 1000000.
        Raises ``ValueError`` for a value out of its range.
        """
    def update(self, image: Picture, time: float) -> list[Track]:
        """Looks at the next picture, taken at ``time`` in seconds from any start; the tracks, oldest first.

        ``image`` is as of ``detect``. One of another size than the last starts anew. A time that is not a number or
        lies before the last one counts as the same interval again, one later than 10 s after it as 10 s.
        """
    @property
    def tracks(self) -> list[Track]:
        """The tracks of the last picture, oldest first."""
    def reset(self) -> None:
        """Forgets all tracks; their numbers are not given again."""

class Intrinsics:
    """A pinhole camera: (x, y, z) is seen at (center_x + focal_x * x / z, center_y + focal_y * y / z)."""

    def __new__(cls, focal_x: float, focal_y: float, center_x: float, center_y: float) -> Intrinsics:
        """Focal lengths in widths and heights of a pixel, and where the optical axis meets the picture, in pixels."""
    @staticmethod
    def from_field_of_view(width: int, height: int, horizontal: float) -> Intrinsics:
        """A camera with square pixels whose axis meets the middle of a picture of ``width`` by ``height`` pixels.

        ``horizontal`` is the angle from its left to its right edge, in radians.
        """
    @property
    def focal_x(self) -> float: ...
    @property
    def focal_y(self) -> float: ...
    @property
    def center_x(self) -> float: ...
    @property
    def center_y(self) -> float: ...

class CirclePose:
    """Where a circle stands and where it faces."""

    def __new__(cls, center: Vector, normal: Vector) -> CirclePose: ...
    @property
    def center(self) -> tuple[float, float, float]:
        """In metres; it is seen off the centre of the ellipse."""
    @property
    def normal(self) -> tuple[float, float, float]:
        """Unit normal of its plane, of the two the one on the camera's side."""

class BallPosition:
    """Where a ball is."""

    @property
    def center(self) -> tuple[float, float, float]:
        """In metres."""
    @property
    def misfit(self) -> float:
        """How far the ellipse is from a ball's outline, in radians at the camera; a ball's is that of the noise."""

Vector = Union[Sequence[float], NDArray[np.float64]]

def circle_poses(ellipse: Ellipse, intrinsics: Intrinsics, radius: float) -> tuple[CirclePose, CirclePose]:
    """The two poses of a circle of ``radius`` metres that is seen as ``ellipse``; only the scene tells which is true.

    The first one's normal points further up, as that of a cup's rim does that is seen from above. Raises
    ``ValueError`` for a radius that is not positive, and an ellipse so thin that its numbers do not tell.
    """

def ball_position(ellipse: Ellipse, intrinsics: Intrinsics, radius: float) -> BallPosition:
    """The position of a ball of ``radius`` metres whose outline is ``ellipse``. Raises as ``circle_poses``."""

def project_circle(pose: CirclePose, radius: float, intrinsics: Intrinsics) -> Optional[Ellipse]:
    """What a circle of ``radius`` metres is seen as; ``None`` where it is not in front of the camera as an ellipse."""

def project_ball(center: Vector, radius: float, intrinsics: Intrinsics) -> Optional[Ellipse]:
    """The outline of a ball of ``radius`` metres; ``None`` where it is not in front of the camera with all of itself."""

Picture = Union[NDArray[np.uint8], NDArray[np.uint16]]
Region = tuple[int, int, int, int]

def detect(
    image: Picture,
    *,
    preset: Literal["default", "paper"] = "default",
    semi_axis_min: Optional[float] = None,
    semi_axis_max: Optional[float] = None,
    axis_ratio_min: Optional[float] = None,
    score_min: Optional[float] = None,
    region: Optional[Region] = None,
    strokes: Optional[Literal["middle", "edges"]] = None,
    support_points: Optional[bool] = None,
    covariance: Optional[bool] = None,
    seed: Optional[int] = None,
    semi_major: Optional[tuple[float, float]] = None,
    semi_minor: Optional[tuple[float, float]] = None,
    quality: Optional[int] = None,
    distance: Optional[float] = None,
) -> Detection:
    """Finds ellipses.

    ``image`` is ``uint8`` of shape (height, width), or (height, width, 3 or 4) for RGB or RGBA, or
    ``uint16`` of shape (height, width), of which the upper 8 bits are looked at. A C-contiguous 8-bit grey
    picture is not copied; do not write to it meanwhile, since other threads run during a detection.

    Of ``preset="default"``: ``semi_axis_min`` (2) and ``semi_axis_max`` bound the semi-minor and the
    semi-major axis in pixels, ``axis_ratio_min`` (0.2) their ratio, ``score_min`` (0.6) the score;
    ``region`` is the part of the picture looked at, (left, top, width, height); ``strokes`` tells of a
    drawn ring its middle line (``"middle"``) or both its edges (``"edges"``); ``support_points`` and
    ``covariance`` ask for those of each ellipse.

    Of ``preset="paper"``: ``semi_major`` and ``semi_minor`` are the least and greatest semi-axes in pixels,
    ``quality`` the least number of edge points on a contour, ``distance`` the clusters' similarity threshold.

    The same ``seed`` gives the same ellipses. Raises ``TypeError`` for another kind of array and
    ``ValueError`` for a value out of its range, or an argument of the other preset.
    """

class ActionSummary(TypedDict):
    name: str
    description: str
    tags: list[str]
    step_count: int
    duration_ms: int
    joints: list[str]
    content_hash: str
    version: int

class VersionSummary(TypedDict):
    version: int
    changed_ms: int
    description: str

class ImportReport(TypedDict):
    added: list[str]
    replaced: list[str]
    unchanged: list[str]

OnConflict = Literal["refuse", "keep-mine", "take-theirs", "rename"]

class BundlePlan(TypedDict):
    """What an import of a bundle does."""

    added: list[str]
    unchanged: list[str]
    conflicts: list[str]
    renamed: list[tuple[str, str]]
    plays_mine: list[tuple[str, list[str]]]

class Registry:
    """RoboRegistry: the motion primitives and actions."""

    def __new__(cls, path: Union[str, PathLike[str]]) -> Registry:
        """Opens the file, or makes it with the actions that come with the robot."""
    @staticmethod
    def in_memory() -> Registry:
        """A registry of its own with the actions that come with the robot."""
    @staticmethod
    def primitives() -> list[str]:
        """The 21 motion primitives, in the order of the paper's Table 1."""
    @property
    def path(self) -> Any: ...
    def actions(self) -> list[ActionSummary]:
        """Every action, by name."""
    def search(
        self,
        text: str = "",
        *,
        tags: Sequence[str] = (),
        joints: Sequence[str] = (),
        shortest_ms: Optional[int] = None,
        longest_ms: Optional[int] = None,
        limit: int = 50,
        offset: int = 0,
    ) -> list[ActionSummary]:
        """The actions that fit: by words (best first), tags, joints that move, and length."""
    def steps(
        self,
        action: Union[str, HasText],
        *,
        times: int = 1,
        speed: float = 1.0,
        arguments: Optional[dict[str, Union[str, float]]] = None,
    ) -> list[tuple[list[str], int]]:
        """The action as the robot plays it: primitives that start together, and a duration in ms."""
    def timeline(
        self, action: Union[str, HasText], *, arguments: Optional[dict[str, Union[str, float]]] = None
    ) -> Timeline:
        """The joints of an action over time; a notebook shows it as a picture."""
    def text(self, name: str) -> str:
        """The text of an action, word for word."""
    def check(self, text: str) -> list[Finding]:
        """What the checker finds in a text; nothing is stored."""
    def save(self, action: Union[str, HasText], *, replace: bool = False) -> ImportReport:
        """Checks an action or a text, tries it on the virtual body and stores it, word for word."""
    def import_text(self, text: str, *, replace: bool = False) -> ImportReport:
        """Stores the actions of a text, all or none; ``replace`` makes new versions of known ones."""
    def export_text(self, *names: str) -> str:
        """The actions named, with those they play; all of them when none is named."""
    def restore(self, name: str, version: int) -> int:
        """Saves an older version again, also of a removed action; returns the new version."""
    def backup(self, path: Union[str, PathLike[str]]) -> None:
        """Copies the registry to a new file, while it is in use."""
    def verify(self) -> list[tuple[str, str]]:
        """What is wrong with what is stored, each with advice; empty where all is well."""
    def export_bundle(self, path: Union[str, PathLike[str]], *names: str) -> list[str]:
        """Writes one file with these actions and all they play, checks and pictures; the names of all of them."""
    def import_bundle(
        self, path: Union[str, PathLike[str]], *, on_conflict: OnConflict = "refuse"
    ) -> BundlePlan:
        """Imports a bundle, or nothing; each action is checked and tried here. Nothing is replaced silently:
        ``on_conflict`` says what happens to actions that are here already and do something else.
        """
    def plan_bundle(
        self, path: Union[str, PathLike[str]], *, on_conflict: OnConflict = "keep-mine"
    ) -> BundlePlan:
        """What ``import_bundle`` would do."""
    def remove(self, name: str) -> None: ...
    def history(self, name: str) -> list[VersionSummary]: ...

class State(TypedDict):
    time_ms: int
    mode: str
    bumpers: list[str]
    presses: dict[str, int]
    motors: list[str]
    positions: dict[str, Optional[str]]
    queue_free: int
    steps_ended: int
    supply_low: bool
    boot: int
    cause: str
    pan: Optional[float]
    tilt: Optional[float]

class HasText(Protocol):
    """An action with a text, such as ``rsapien.Action``."""

    @property
    def text(self) -> str: ...

class Finding:
    """What the checker says; as text, with the place underlined."""

    @property
    def severity(self) -> Literal["error", "warning"]: ...
    @property
    def rule(self) -> str:
        """The rule's name, as in docs/rules.md."""
    @property
    def message(self) -> str: ...
    @property
    def line(self) -> int: ...
    @property
    def column(self) -> int: ...
    @property
    def action(self) -> Optional[str]: ...
    @property
    def help(self) -> Optional[str]:
        """What to do."""
    @property
    def rendered(self) -> str:
        """The message as a compiler tells it."""

class Timeline:
    """The joints of an action over time, reckoned with nominal travel times."""

    @property
    def name(self) -> str: ...
    @property
    def duration_ms(self) -> int:
        """How long it lasts; waits for bumpers are not counted."""
    @property
    def labels(self) -> list[tuple[int, str]]:
        """When, in ms, and the name."""
    def movements(self) -> list[dict[str, Any]]:
        """Every movement: joint, ``from_ms``, ``to_ms``, ``from_place`` and ``to_place`` (0 to 1), target …"""
    def svg(self, *, title: str = "", description: str = "", width: int = 900) -> str:
        """The picture, as SVG."""
    def text(self, width: int = 100) -> str:
        """The picture for a terminal."""
    def _repr_svg_(self) -> str: ...

class Claim(TypedDict):
    """An action that is played or waits, and the joints that are its own meanwhile."""

    action: str
    program: str
    pid: int
    joints: list[str]

class Guest:
    """A robot whose line another program of this user holds: that program plays what is handed to it."""

    @staticmethod
    def find(link: str = "auto", *, baud: int = 57_600) -> Optional[Guest]:
        """The way to the program that holds the line; ``None`` where nobody does, or it plays for nobody."""
    @property
    def link(self) -> str: ...
    @property
    def holder(self) -> str:
        """Who holds the line."""
    def claims(self) -> tuple[list[Claim], list[Claim]]:
        """What is played on the robot, and what waits."""
    def play(
        self,
        action: Union[str, HasText],
        *,
        times: int = 1,
        speed: float = 1.0,
        mirrored: bool = False,
        arguments: Optional[dict[str, Union[str, float]]] = None,
        from_label: Optional[str] = None,
        registry: Optional[Registry] = None,
        policy: Policy = "refuse",
        on_admission: Optional[Callable[[str, str], object]] = None,
        on_progress: Optional[Callable[[int, int], object]] = None,
    ) -> Outcome:
        """As ``Robot.play``."""

class States:
    """Goes through the states of a robot, without end."""

    def __iter__(self) -> States: ...
    def __next__(self) -> State: ...

class Outcome:
    """How an action ended."""

    @property
    def kind(self) -> Literal["done", "refused", "interrupted", "unknown"]: ...
    @property
    def text(self) -> str:
        """What happened, in words."""
    @property
    def steps_ended(self) -> int: ...
    @property
    def steps_total(self) -> int: ...
    @property
    def elapsed_ms(self) -> int: ...
    @property
    def reached(self) -> Optional[tuple[str, int]]:
        """The step under way when it ended early: the action it is written in, and its number there."""
    @property
    def instead(self) -> Optional[Outcome]:
        """How what was played instead of the rest ended, because a bumper was met or waited for in vain."""
    def __bool__(self) -> bool:
        """Whether it was done."""

class Frames:
    """The pictures of a recording, one after the other."""

    def __iter__(self) -> Frames: ...
    def __next__(self) -> tuple[int, NDArray[np.uint8]]: ...

class Recording:
    """A recording: a file that ``rsapien record`` or ``Robot.record`` has written.

    Times are milliseconds of the line's clock. Each call reads the file anew.
    """

    def __new__(cls, path: Union[str, PathLike[str]]) -> Recording:
        """Reads the file once, from its begin to its end; ``RecordingError`` if it is no recording."""
    @property
    def topics(self) -> dict[str, int]:
        """How many messages each channel has; only those with some."""
    @property
    def time_range(self) -> Optional[tuple[int, int]]:
        """Time of the first and of the last message; None of an empty recording."""
    @property
    def complete(self) -> bool:
        """False when the end of the file is missing: its writer was killed, or still writes."""
    @property
    def about(self) -> dict[str, Any]:
        """``program``, ``link``, ``baud``, and of a virtual robot ``seed``, ``controllers`` and ``fast``."""
    def states(self) -> NDArray[np.void]:
        """A structured array, a row a state.

        ``time_ms``, ``mode``, ``cause``; ``bumpers`` and ``presses`` by bumper, ``motors`` and ``pose`` by
        joint (1 to 3, 0 on the way); ``supply_low``, ``queue_free``, ``steps_ended``, ``boot``; ``pan``,
        ``tilt``, ``pan_target``, ``tilt_target`` in degrees, nan without a camera controller.
        """
    def packages(self) -> list[dict[str, Any]]:
        """Every package: ``time_ms``, ``direction``, ``controller``, ``kind``, ``words``, ``hex``, …"""
    def motion(self) -> list[dict[str, Any]]:
        """What was played: ``time_ms``, ``event`` (``begin``, ``step``, ``end``), ``action``, ``outcome``, …"""
    def bytes(self) -> list[tuple[int, str, bytes]]:
        """Every byte on the line: time, ``to-robot`` or ``to-pc``, and those that came together."""
    def frames(self) -> Frames:
        """The pictures: time, and an array (height, width, 3)."""
    def detections(self) -> NDArray[np.void]:
        """A structured array, a row an ellipse: ``time_ms``, and the fields of ``Detection.to_structured``."""

class Recorder:
    """A recording that is being written. Use it in a ``with``, or call ``finish``."""

    def finish(self) -> None:
        """Ends the file."""
    def __enter__(self) -> Recorder: ...
    def __exit__(
        self,
        kind: Optional[type[BaseException]] = None,
        error: Optional[BaseException] = None,
        traceback: Optional[TracebackType] = None,
    ) -> None: ...

Policy = Literal["refuse", "queue", "replace", "merge"]

class Robot:
    """The robot, real or virtual. Use it in a ``with``: leaving it stops the motors and lets go.

    A robot holds the controllers it uses (motion, camera, sensors) until it is closed; another holder
    is refused with ``ControllerHeld``. Ctrl-C during a call stops the motors first.
    """

    @staticmethod
    def open(link: str = "auto", *, baud: int = 57600) -> Robot:
        """``auto``, ``/dev/ttyUSB0``, ``COM3``, ``tcp://host:port`` or ``virtual``."""
    @staticmethod
    def virtual(
        *,
        seed: int = 0,
        world: str = "demo",
        fast: bool = False,
        firmware: Optional[Union[str, PathLike[str]]] = None,
        simulator: Optional[Union[str, PathLike[str]]] = None,
    ) -> Robot:
        """A virtual robot of its own; ``fast`` runs on a virtual clock.

        ``firmware``, a folder of hex files, runs the firmware itself in ``simulator``, the simulator of
        its chips (``rsapien-gpsim``, where programs are installed).
        """
    @property
    def link(self) -> str: ...
    def record(self, path: Union[str, PathLike[str]], *, force: bool = False) -> Recorder:
        """Records bytes, packages and states from now on; a file that is there is replaced with ``force``."""
    def init(self) -> None:
        """Robot initialisation: every joint is driven to its middle position."""
    def state(self) -> State:
        """Asks the robot now. Angles in degrees, pan right and tilt up positive."""
    def do(self, *steps: str, policy: Policy = "refuse") -> Outcome:
        """Steps as on the command line: ``do("right-arm-up+tilt-left:500", "tilt-mid", "wave")``.

        A step lasts 1000 ms where it does not say otherwise.
        """
    def play(
        self,
        action: Union[str, HasText],
        *,
        times: int = 1,
        speed: float = 1.0,
        mirrored: bool = False,
        arguments: Optional[dict[str, Union[str, float]]] = None,
        from_label: Optional[str] = None,
        registry: Optional[Registry] = None,
        policy: Policy = "refuse",
        on_admission: Optional[Callable[[str, str], object]] = None,
        on_progress: Optional[Callable[[int, int], object]] = None,
    ) -> Outcome:
        """Plays an action of the registry (without one: of those that come with the robot), or one that is
        built in code.

        ``arguments`` are values of its parameters: numbers, or times such as ``"650ms"``.

        ``policy`` says what happens while another thread or program plays something: ``"refuse"`` raises
        ``ControllerHeld``, ``"queue"`` waits, ``"replace"`` ends it, ``"merge"`` plays beside it where no joint
        is in both. ``on_admission`` is told before anything moves: ``"begins"``, ``"waits"``, ``"replaces"`` or
        ``"beside"``, and the same in words with the others' names.
        """
    def pause(self) -> None:
        """Pauses what is played at the end of a step, until ``resume``."""
    def resume(self) -> None:
        """Lets what is paused go on."""
    def states(self, *, every_ms: int = 100) -> States:
        """The state, again and again: ``for state in robot.states(): ...``."""
    def look(self, pan: float, tilt: float, *, speed: int = 0) -> tuple[float, float]:
        """Turns the head, waits until it is there and returns pan and tilt in degrees."""
    def snapshot(self) -> NDArray[np.uint8]:
        """What the camera sees: shape (height, width, 3), RGB. The virtual robot's only."""
    def stop(self) -> None:
        """All motors off, now."""
    def sleep(self, ms: int) -> None:
        """Waits on the robot's clock."""
    def close(self) -> None: ...
    def __enter__(self) -> Robot: ...
    def __exit__(
        self,
        kind: Optional[type[BaseException]],
        error: Optional[BaseException],
        traceback: Optional[TracebackType],
    ) -> None: ...

def action_name(text: str) -> str:
    """The name of the one action of a text."""

def run_command(arguments: Sequence[str]) -> int:
    """Runs the ``rsapien`` command and returns its exit status."""
