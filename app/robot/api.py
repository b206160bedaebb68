"""`/api/v1`: the decision, its state as a stream, the scene and the model, health, and frames pushed in."""

import asyncio
import tempfile
from datetime import UTC, datetime
from importlib.metadata import version
from typing import IO, Annotated, Any

from fastapi import APIRouter, Depends, FastAPI, HTTPException, Request, Response, WebSocket
from starlette.routing import Mount

from app.door.gate import Gate
from app.door.guard import Guard
from app.door.people import Visitor
from app.robot.access import Access
from app.robot.cell import Cell
from app.robot.exports import MEDIA_TYPES, FileFormat, model_file, scene_file
from app.robot.models import DecisionModel, FrameHealth, Health, OfferHealth, Problem, Taken, decision_model
from app.robot.pushing import LARGEST_PUSH, NotAScene, read_pushed
from app.robot.stream import POLICY_VIOLATION, stream_decision
from app.static_files import static_text

PREFIX = "/api/v1"
NO_MODEL = "There is no model: nothing is measured yet, or nothing could be fitted to what was drawn."
TOO_LARGE = f"A push is at most {LARGEST_PUSH >> 20} MB; send one scene."
Responses = dict[int | str, dict[str, Any]]
REFUSALS: Responses = {
    401: {"model": Problem, "description": "Nobody who may come in."},
    403: {"model": Problem, "description": "Another site's page, or not the role for it."},
    429: {"model": Problem, "description": "Too many secrets are being tried."},
}
FILE: Responses = {200: {"content": {name: {} for name in MEDIA_TYPES.values()}, "description": "The file."}}
MISSING: Responses = {404: {"model": Problem, "description": "There is no model."}}
UNUSABLE: Responses = {
    413: {"model": Problem, "description": "Too large."},
    422: {"model": Problem, "description": "No scene: which file and field, and what to do."},
}
ZIP = {"content": {"application/zip": {"schema": {"type": "string", "format": "binary"}}}, "required": True}


def robot_routes(cell: Cell, gate: Gate, guard: Guard) -> list[Mount]:
    """The interface, to be mounted on the front server."""
    return [Mount(PREFIX, app=robot_api(cell, gate, guard))]


def robot_api(cell: Cell, gate: Gate, guard: Guard) -> FastAPI:
    """The interface as an application of its own; its description is in `openapi.json`."""
    api = FastAPI(
        title="rotrecon",
        version=version("rotrecon"),
        description=static_text("api.md"),
        docs_url=None,
        redoc_url=None,
        servers=[{"url": PREFIX}],
        root_path_in_servers=False,
    )
    access = Access(gate, guard)
    api.include_router(_told(cell, access, guard))
    api.include_router(_files(cell, access))
    api.include_router(_pushed(cell, access))
    return api


def _told(cell: Cell, access: Access, guard: Guard) -> APIRouter:
    router = APIRouter(responses=REFUSALS)

    @router.get("/decision", dependencies=[Depends(access.reader)])
    def decision() -> DecisionModel:
        """The decision as it stands now; the web socket `/decision/stream` sends the same whenever it changes."""
        return decision_model(cell.decision())

    @router.get("/health", dependencies=[Depends(access.reader)])
    def health() -> Health:
        """Whether the console works, how old its frame is, and what the door has refused."""
        return _health(cell, guard)

    @router.websocket("/decision/stream")
    async def stream(socket: WebSocket) -> None:
        try:
            visitor = await access.reader(socket, await access.said(socket))
        except HTTPException:
            await socket.close(POLICY_VIOLATION)
            return
        await socket.accept()
        await stream_decision(socket, cell, lambda: access.stays(visitor, socket))

    return router


def _files(cell: Cell, access: Access) -> APIRouter:
    router = APIRouter(responses=REFUSALS, dependencies=[Depends(access.reader)])

    @router.get("/scene.{form}", response_class=Response, responses=FILE)
    def scene(form: FileFormat) -> Response:
        """The points of the held frame with their colours, in base coordinates, m."""
        return Response(scene_file(cell.frame(), form), media_type=MEDIA_TYPES[form])

    @router.get("/model.{form}", response_class=Response, responses=FILE | MISSING)
    def model(form: FileFormat) -> Response:
        """The fitted solid as a closed mesh, in base coordinates, m."""
        solid = cell.solid()
        if solid is None:
            raise HTTPException(404, NO_MODEL)
        return Response(model_file(solid, form), media_type=MEDIA_TYPES[form])

    return router


def _pushed(cell: Cell, access: Access) -> APIRouter:
    router = APIRouter(responses=REFUSALS | UNUSABLE)
    one_at_a_time = asyncio.Semaphore(1)

    @router.post("/frames", status_code=202, openapi_extra={"requestBody": ZIP})
    async def push(request: Request, robot: Annotated[Visitor, Depends(access.robot)]) -> Taken:
        """Push in a frame with depth or a set of posed views: a ZIP file of a scene folder, `scene.toml` on top.

        The operator is told of it and goes on with the frame that is held. Nothing that is pushed in decides anything.
        """
        async with one_at_a_time:
            with tempfile.TemporaryFile() as file:
                await _receive(request, file)
                try:
                    capture = await asyncio.to_thread(read_pushed, file)
                except NotAScene as error:
                    raise HTTPException(422, str(error)) from error
            offer = await asyncio.to_thread(cell.offer, capture, robot.name)
        return Taken(name=capture.name, views=len(capture.views), notes=capture.notes, arrived_at=offer.arrived_at)

    return router


async def _receive(request: Request, file: IO[bytes]) -> None:
    left = LARGEST_PUSH
    async for chunk in request.stream():
        left -= len(chunk)
        if left < 0:
            raise HTTPException(413, TOO_LARGE)
        file.write(chunk)
    file.seek(0)


def _health(cell: Cell, guard: Guard) -> Health:
    frame, offered = cell.frame(), cell.offered()
    captured = frame.captured_at
    age_s = None if captured is None else (datetime.now(UTC) - captured).total_seconds()
    return Health(
        status="ok",
        version=version("rotrecon"),
        state=cell.decision().state,
        pages=cell.pages(),
        refused=dict(guard.refused),
        frame=FrameHealth(name=cell.name, captured_at=captured, age_s=age_s),
        offered=None
        if offered is None
        else OfferHealth(name=offered.capture.name, who=offered.who, arrived_at=offered.arrived_at),
    )
