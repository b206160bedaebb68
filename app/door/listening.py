"""The address to listen on: taken once, never another one silently, and never beyond this machine unguarded."""

import os
import socket
import ssl
from dataclasses import dataclass
from pathlib import Path

from app.door.people import read_people
from app.host import HostError, check_host, is_loopback


@dataclass(frozen=True)
class Certificate:
    """Files of a TLS certificate (with its chain) and its private key, PEM."""

    certificate: Path
    key: Path


def listen(host: str, port: int, people: Path, certificate: Certificate | None) -> socket.socket:
    """A socket bound to the address. Raises HostError, which says what to do, when that cannot or must not be."""
    check_host(host)
    if certificate is not None:
        check_certificate(certificate)
    if not is_loopback(host):
        check_guarded(host, people, certificate)
    family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    bound = socket.socket(family, kind, protocol)
    try:
        if os.name == "posix":  # elsewhere it would let two programs have one port
            bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        bound.bind(address)
        bound.listen()
    except OSError as error:
        bound.close()
        raise HostError(
            f"cannot listen on port {port} of {host} ({error.strerror}); "
            "close what uses it, or give another one with --port"
        ) from error
    return bound


def check_guarded(host: str, people: Path, certificate: Certificate | None) -> None:
    """Raise HostError unless people have to log in and nobody can listen in."""
    missing: list[str] = []
    if not read_people(people):
        missing.append("users: add them with `rotrecon user add NAME`")
    if certificate is None:
        missing.append("TLS: give --certificate FILE and --key FILE")
    if missing:
        raise HostError(
            f"does not listen on {host}, which others can reach, without {'; and without '.join(missing)}. "
            "Leave --host out to keep it to this machine"
        )


def check_certificate(files: Certificate) -> None:
    """Raise HostError for files that are no certificate and its key."""
    try:
        ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(files.certificate, files.key)
    except (OSError, ssl.SSLError) as error:
        raise HostError(
            f"--certificate {files.certificate} and --key {files.key} cannot be used ({error.strerror or error}); "
            "give a PEM certificate and the private key that belongs to it, without a passphrase"
        ) from error
