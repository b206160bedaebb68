"""The docked panels' parts that belong to one page: its layers, its crop, its section."""

from collections.abc import Callable
from html import escape
from typing import Any

import numpy as np
from viser import ClientHandle, GuiEvent

from app.charts import (
    CHART_HEIGHT_PX,
    RADIUS_AXES,
    RADIUS_BANDS,
    RADIUS_SERIES,
    radius_chart,
    radius_scales,
    section_count,
)
from app.encoded import put
from app.events import Event, SectionsRestored, SectionToggled
from app.origins import from_
from app.page import LAYERS, DarkChosen, LayerChosen, OpacityChosen, PageEvent, PageState, SectionChosen
from app.panels import Panels
from app.pictures import Pictures
from app.section_drawing import line_text, section_svg, section_text
from app.session import Session
from app.showing import set_to
from app.units import MM_PER, Unit, in_unit, labels_in, scales_in
from rotrecon.overlay import LIGHT_BLUE, NAVY, RED, YELLOW
from rotrecon.reconstruction import Reconstruction

JPEG_QUALITY = 80
LEGEND = (("object", RED), ("accepted", YELLOW), ("close", LIGHT_BLUE), ("distant", NAVY))


class PagePanels:
    """Controls of one page, in the tabs that all pages share."""

    def __init__(
        self, client: ClientHandle, shared: Panels, pictures: Pictures, post: Callable[[Event | PageEvent], None]
    ) -> None:
        self._gui, self._pictures, self._post = client.gui, pictures, post
        self._section = 0
        with shared.sections:
            self._add_sections()
        with shared.picture:
            self._add_picture()
        self._television_of: object = None
        self._crop_of: object = None
        self._sections_of: object = None

    def hold(self, pictures: Pictures) -> None:
        """The pictures of another frame."""
        self._pictures, self._television_of, self._crop_of = pictures, None, None

    def show(self, session: Session, page: PageState, section: int, moving: bool) -> None:
        """Bring this page's panels up to date; pictures wait for the end of a drag."""
        result = session.reconstruction
        if not moving:
            self._show_television(result, page)
        set_to(self._depth_bar, "content", in_unit(depth_bar(self._pictures.depth_range_m), session.unit))
        self._show_sections(result, section, session.shown.excluded_sections, session.unit)

    def _show_television(self, result: Reconstruction | None, page: PageState) -> None:
        if self._television_of != (result, page.layer):
            self._television_of = (result, page.layer)
            put(self._television, self._pictures.sent_television(result, page.layer))
        if page.last_point_px is not None and self._crop_of != page.last_point_px:
            self._crop_of = page.last_point_px
            self._crop.image = self._pictures.crop(page.last_point_px)
            self._crop.visible = True

    def _show_sections(self, result: Reconstruction | None, section: int, excluded: frozenset[int], unit: Unit) -> None:
        if self._sections_of == (result, section, excluded, unit):
            return
        self._sections_of = (result, section, excluded, unit)
        count = section_count(result)
        chart = radius_chart(result, section)
        self._chart.data = tuple(column / MM_PER[unit] for column in chart)
        set_to(self._chart, "axes", labels_in(RADIUS_AXES, unit))
        set_to(self._chart, "series", labels_in(RADIUS_SERIES, unit))
        scales = scales_in(radius_scales(chart), ("x", "y"), unit)
        if scales != self._chart.scales:
            self._chart.scales = scales
        self._section = section
        if self._slider.max != max(count, 2):
            self._slider.max = max(count, 2)
        if self._slider.value != section + 1:
            self._slider.value = section + 1
        for part in (self._chart, self._slider, self._exclude):
            part.visible = count > 0
        self._restore.visible = bool(excluded)
        self._exclude.label = "Put this section back" if section in excluded else "Exclude this section"
        self._plane.content = in_unit(section_html(result, section), unit)

    def _add_sections(self) -> None:
        chart = radius_chart(None, 0)
        self._chart = self._gui.add_uplot(
            chart,
            RADIUS_SERIES,
            axes=RADIUS_AXES,
            bands=RADIUS_BANDS,
            scales=radius_scales(chart),
            legend={"show": True, "live": False},
            height=CHART_HEIGHT_PX,
            padding=(8, 12, 0, 0),
            visible=False,
        )
        self._slider = self._gui.add_slider("Section", 1, 2, 1, 1, visible=False, hint="Z and X step")
        self._exclude = self._gui.add_button("Exclude this section", visible=False, color="gray")
        self._restore = self._gui.add_button("Put all back", visible=False, color="gray")
        self._plane = self._gui.add_html("")
        self._slider.on_update(self._choosing(lambda number: SectionChosen(int(number) - 1)))
        self._exclude.on_click(self._choosing(lambda _: SectionToggled(self._section)))
        self._restore.on_click(self._choosing(lambda _: SectionsRestored()))

    def _add_picture(self) -> None:
        opacity = self._gui.add_slider("Depth, %", 0, 100, 5, 0)
        opacity.on_update(self._choosing(lambda percent: OpacityChosen(float(percent) / 100)))
        self._depth_bar = self._gui.add_html("")
        layer = self._gui.add_dropdown("Frame shows", LAYERS, initial_value="segmentation")
        layer.on_update(self._choosing(LayerChosen))
        self._television = self._gui.add_image(
            np.zeros((2, 2, 3), dtype=np.uint8), format="jpeg", jpeg_quality=JPEG_QUALITY
        )
        colors = "".join(f'<span class="rr-key" style="background:rgb{color}"></span>{name}' for name, color in LEGEND)
        self._gui.add_html(f'<div class="rr-caption">Segmentation:{colors}</div>')
        self._crop = self._gui.add_image(
            np.zeros((2, 2, 3), dtype=np.uint8),
            label="Round the last point",
            format="jpeg",
            jpeg_quality=JPEG_QUALITY,
            visible=False,
        )
        dark = self._gui.add_checkbox("Dark page", True)
        dark.on_update(self._choosing(DarkChosen))

    def _choosing(self, event_of: Callable[[Any], Event | PageEvent]) -> Any:
        """A callback that posts the event a value stands for, when the page and not the program has set it."""

        async def chosen(event: GuiEvent[Any]) -> None:
            if event.client_id is not None:
                self._post(event_of(event.target.value))

        return chosen


def section_html(result: Reconstruction | None, section: int) -> str:
    """One section in words and in its own plane, and what was done on the line of pixels that it was made of."""
    text, line = escape(section_text(result, section)), escape(line_text(result, section))
    return (
        f'<div class="rr-caption" data-testid="section" {from_("section_radius", "section_rms")}>{text}</div>'
        f"{section_svg(result, section)}"
        f'<div class="rr-caption" data-testid="line" {from_("steps", "mean_sigma")}>{line}</div>'
    )


def depth_bar(range_m: tuple[float, float]) -> str:
    """The colours of the depth map, and which depths are at their two ends."""
    ends = "".join(f"<span>{1000 * end_m:.0f} mm</span>" for end_m in range_m)
    origin = from_("depth_range")
    return f'<div class="rr-caption" {origin}><div class="rr-bar"></div><div class="rr-ends">{ends}</div></div>'
