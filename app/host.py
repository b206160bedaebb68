"""The address that the console listens on, tried before the server is opened: viser would wait for ever."""

import socket
from ipaddress import ip_address


class HostError(Exception):
    """An address that cannot be listened on; the message names it and what to do."""


def check_host(host: str) -> None:
    """Raise HostError for a name or an address that is not this machine's."""
    try:
        for family, kind, protocol, _, address in socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM):
            with socket.socket(family, kind, protocol) as probe:
                probe.bind(address)
    except (OSError, UnicodeError) as error:
        raise HostError(
            f"cannot listen on --host {host!r} ({_reason(error)}); "
            "give an address of this machine, or leave --host out for 127.0.0.1"
        ) from error


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach what listens there."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _reason(error: OSError | UnicodeError) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or "it is not a name"
