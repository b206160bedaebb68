"""What was recorded: one frame whose depth is known, or several views that still have to be matched."""

from dataclasses import dataclass
from functools import cached_property

from rotrecon.drawing import AreaOfInterest
from rotrecon.frame import Frame, FrameUnavailable, View
from rotrecon.settings import Settings
from rotrecon.stereo.frames import area_frame, whole_frame
from rotrecon.stereo.preparing import Prepared, prepare
from rotrecon.workspace import Workspace

DEFAULTS = Settings()


@dataclass(frozen=True, eq=False)
class Capture:
    """A recording as it was read: either `recorded` is a frame, or `views` are two or more."""

    name: str
    recorded: Frame | None = None
    views: tuple[View, ...] = ()
    notes: tuple[str, ...] = ()
    """What a reader should know of how it was made, such as intrinsics that had to be recovered."""
    workspace: Workspace = Workspace()
    """Of the arm that took the views; a recorded frame has its own."""

    def frame(self, area: AreaOfInterest | None = None, settings: Settings = DEFAULTS) -> Frame | FrameUnavailable:
        """The frame to measure in.

        A recorded one is given back as it is. Views are matched: the whole frame at half resolution, for display; or
        with an area, px of the first view, that area at full resolution, and nothing else. Raises DrawingError for an
        area that cannot be used on the first view.
        """
        if self.recorded is not None:
            return self.recorded
        if isinstance(self.prepared, FrameUnavailable):
            return self.prepared
        return whole_frame(self.prepared) if area is None else area_frame(self.prepared, area)

    @cached_property
    def prepared(self) -> Prepared | FrameUnavailable:
        """What the views tell before any pixel is matched; worked out once."""
        return prepare(self.views, self.workspace)
