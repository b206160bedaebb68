"""Viser's own page, one file, and the policy that lets the browser run what it is made of and nothing else."""

import base64
import gzip
import hashlib
import re
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import viser
import zstandard

ALPHABET = "!#$%()*+,-./0123456789:;=?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_abcdefghijklmnopqrstuvwxyz{|}~"
"""Digits of the base in which viser's page packs its program: five to four bytes."""
PACKED = re.compile(r'<script data-p="([^"]*)" data-ss="(\d+)" data-cs="(\d+)">(.*?)</script>', re.DOTALL)
BASE_POLICY = {
    "default-src": "'none'",
    "base-uri": "'none'",
    "form-action": "'self'",
    "frame-ancestors": "'none'",
    "style-src": "'self' 'unsafe-inline'",
    "img-src": "'self' data: blob:",
}


@dataclass(frozen=True)
class PageFile:
    """The page as it is sent."""

    plain: bytes
    gzipped: bytes
    tag: str
    policy: str
    """Content-Security-Policy: of scripts, the two of this page by their digests."""


def policy(**sources: str) -> str:
    """A Content-Security-Policy with more sources than none; names with _ for -."""
    allowed = BASE_POLICY | {name.replace("_", "-"): value for name, value in sources.items()}
    return "; ".join(f"{name} {value}" for name, value in allowed.items())


@lru_cache(maxsize=1)
def page_file() -> PageFile:
    """Viser's page. Raises RuntimeError when it is not packed the way that this reads it."""
    plain = (Path(viser.__file__).parent / "client" / "build" / "index.html").read_bytes()
    found = PACKED.search(plain.decode("utf-8"))
    if found is None:
        raise RuntimeError("viser's page is not packed as that of 1.1.1; its policy has to be made anew")
    packed, style_size, code_size, loader = found.groups()
    unpacked = zstandard.ZstdDecompressor().decompress(_decoded(packed), int(style_size) + int(code_size))
    scripts = (loader.encode("utf-8"), unpacked[int(style_size) :])
    allowed = policy(
        script_src=" ".join([*map(_digest, scripts), "'wasm-unsafe-eval'"]),
        connect_src="'self' data: blob:",
        worker_src="blob:",
        font_src="'self' data:",
    )
    return PageFile(plain, gzip.compress(plain, 6), f'"{hashlib.sha256(plain).hexdigest()[:32]}"', allowed)


def _decoded(text: str) -> bytes:
    """Bytes of groups of five digits, the most significant first; the last group may be shorter."""
    digits = np.zeros(128, dtype=np.int64)
    digits[[ord(letter) for letter in ALPHABET]] = np.arange(len(ALPHABET))
    values = digits[np.frombuffer(text.encode("ascii"), dtype=np.uint8)]
    whole = len(values) // 5 * 5
    words = values[:whole].reshape(-1, 5) @ len(ALPHABET) ** np.arange(4, -1, -1)
    rest = 0
    for digit in values[whole:]:
        rest = rest * len(ALPHABET) + int(digit)
    return words.astype(">u4").tobytes() + rest.to_bytes(max(len(values) - whole - 1, 0), "big")


def _digest(script: bytes) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(script).digest()).decode()}'"
