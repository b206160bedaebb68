"""The tab of the stages, one page's own: a line of pixels step by step, residuals, candidates, and a distance."""

from collections.abc import Callable
from html import escape
from typing import Any

import numpy as np
from viser import GuiApi, GuiEvent, GuiTabHandle

from app.encoded import put
from app.inspection import line_in, residuals_in
from app.inspection_text import candidates_html, distance_html, residuals_html
from app.origins import from_
from app.page import OVERLAYS, MeasuringChosen, OverlayChosen, PageEvent, PageState, StepChosen
from app.pictures import Pictures
from app.showing import set_to
from app.stage_chart import STAGE_AXES, STAGE_BANDS, STAGE_SERIES, stage_chart, stage_scales, stage_text
from app.units import MM_PER, Unit, in_unit, labels_in, scales_in
from rotrecon.line_stages import Line
from rotrecon.reconstruction import Reconstruction

CHART_HEIGHT_PX = 150
JPEG_QUALITY = 90


class InspectionPanel:
    """Controls of one page."""

    def __init__(self, gui: GuiApi, tab: GuiTabHandle, pictures: Pictures, post: Callable[[PageEvent], None]) -> None:
        self._pictures, self._post = pictures, post
        self._stage_of: object = None
        self._rest_of: object = None
        with tab:
            self._step = gui.add_slider("Step", 1, 6, 1, 1, hint="Of the segmentation, on the section's line of pixels")
            self._text = gui.add_html("")
            self._chart = gui.add_uplot(
                stage_chart(None, 0),
                STAGE_SERIES,
                axes=STAGE_AXES,
                bands=STAGE_BANDS,
                scales=stage_scales(None),
                legend={"show": True, "live": False},
                height=CHART_HEIGHT_PX,
                padding=(8, 12, 0, 0),
                visible=False,
            )
            self._image = gui.add_image(
                np.zeros((2, 2, 3), dtype=np.uint8), format="jpeg", jpeg_quality=JPEG_QUALITY, visible=False
            )
            overlay = gui.add_dropdown(
                "Over the picture", OVERLAYS, initial_value="nothing", hint="Residuals in the 3D view, too"
            )
            self._scale = gui.add_html("")
            self._candidates = gui.add_html("")
            measuring = gui.add_checkbox("Clicks measure a distance", False)
            self._distance = gui.add_html("")
        self._step.on_update(self._choosing(lambda number: StepChosen(int(number) - 1)))
        overlay.on_update(self._choosing(OverlayChosen))
        measuring.on_update(self._choosing(lambda value: MeasuringChosen(bool(value))))

    def hold(self, pictures: Pictures) -> None:
        """The pictures of another frame."""
        self._pictures, self._stage_of, self._rest_of = pictures, None, None

    def show(self, result: Reconstruction | None, page: PageState, section: int, unit: Unit) -> None:
        """Bring it up to date."""
        if self._stage_of != (result, section, page.step, unit):
            self._stage_of = (result, section, page.step, unit)
            self._show_stage(result, section, page.step, unit)
        if self._rest_of != (result, page.overlay, page.measuring, page.ends_px, unit):
            self._rest_of = (result, page.overlay, page.measuring, page.ends_px, unit)
            residuals = residuals_in(result) if result is not None and page.overlay == "residuals" else None
            self._scale.content = in_unit(residuals_html(residuals), unit)
            self._candidates.content = in_unit(candidates_html(result), unit)
            distance = distance_html(self._pictures.frame, page.measuring, page.ends_px)
            self._distance.content = in_unit(distance, unit)

    def _show_stage(self, result: Reconstruction | None, section: int, step: int, unit: Unit) -> None:
        line = None if result is None else line_in(result, section)
        self._text.content = in_unit(step_html(line, step), unit)
        self._chart.visible = line is not None
        place, *depths = stage_chart(line, step)
        self._chart.data = (place, *(depth / MM_PER[unit] for depth in depths))
        set_to(self._chart, "axes", labels_in(STAGE_AXES, unit))
        scales = scales_in(stage_scales(line), ("y",), unit)
        if scales != self._chart.scales:
            self._chart.scales = scales
        if line is not None and self._step.max != len(line.stages):
            self._step.max = len(line.stages)
        if self._step.value != step + 1:
            self._step.value = min(step + 1, int(self._step.max))
        image = None if result is None else self._pictures.sent_step(result, section, step)
        self._image.visible = image is not None
        if image is not None:
            put(self._image, image)

    def _choosing(self, event_of: Callable[[Any], PageEvent]) -> Any:
        """A callback that posts the event a value stands for, when the page and not the program has set it."""

        async def chosen(event: GuiEvent[Any]) -> None:
            if event.client_id is not None:
                self._post(event_of(event.target.value))

        return chosen


def step_html(line: Line | None, step: int) -> str:
    """One step of the segmentation in words."""
    text, origin = escape(stage_text(line, step)), from_("steps", "mean_sigma")
    return f'<div class="rr-caption" data-testid="step" {origin}>{text}</div>'
