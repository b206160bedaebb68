"""Whether a request comes from this server's own page: no other site may use what a browser carries for this one."""

from starlette.requests import HTTPConnection

SECURE = {"https", "wss"}


def is_own_page(connection: HTTPConnection) -> bool:
    """Whether the browser says that a page of this server sent it; without an Origin nobody does."""
    scheme = "https" if connection.url.scheme in SECURE else "http"
    return connection.headers.get("origin") == f"{scheme}://{connection.headers.get('host')}"
