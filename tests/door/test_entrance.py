"""The way in and out, over real sockets: who gets the page, what it carries, and who is refused."""

import re
import ssl
import subprocess
from collections.abc import Iterator
from contextlib import suppress
from http.cookies import SimpleCookie
from pathlib import Path

import httpx
import pytest
import websockets.sync.client
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection

from app.door import proxy
from app.door.door import Door
from app.door.listening import Certificate, listen
from app.door.people import read_people, with_person, write_people
from app.host import HostError
from tests.door.conftest import SECRET, House
from tests.waiting import WAIT_S, until


@pytest.fixture
def web(house: House) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=house.door.address, trust_env=False) as client:
        yield client


@pytest.mark.parametrize("path", ["/", "/account", "/?websocket=ws://example.org"])
def test_without_a_pass_there_is_only_the_log_in_page(web: httpx.Client, path: str) -> None:
    answer = web.get(path)
    assert (answer.status_code, answer.headers["location"]) == (303, "/login")
    assert "Log in" in web.get("/login").text


def test_the_page_is_for_those_who_are_in(house: House) -> None:
    for name in ("Anna", "Walt"):
        answer = httpx.get(house.door.address, headers={"Cookie": house.cookie(name)}, trust_env=False)
        assert answer.status_code == 200
        assert '<div id="root">' in answer.text
        again = {"Cookie": house.cookie(name), "If-None-Match": answer.headers["etag"]}
        assert httpx.get(house.door.address, headers=again, trust_env=False).status_code == 304


def test_a_pass_is_kept_from_scripts_and_other_sites(house: House) -> None:
    (morsel,) = SimpleCookie(house.log_in("Anna").headers["set-cookie"]).values()
    assert morsel.key == f"rotrecon-{house.door.port}", "cookies know no ports, and two consoles must not share one"
    assert (morsel["httponly"], morsel["samesite"], morsel["path"]) == (True, "strict", "/")
    assert int(morsel["max-age"]) == house.door.gate.passes.lasts_s


@pytest.mark.parametrize(
    ("name", "secret", "status"),
    [("Anna", "wrong", 401), ("nobody", SECRET, 401), ("", "", 401), ("Anna", SECRET * 500, 413), ("arm", SECRET, 403)],
)
def test_who_is_not_let_in_gets_no_pass(house: House, name: str, secret: str, status: int) -> None:
    answer = house.log_in(name, secret)
    assert answer.status_code == status
    assert "set-cookie" not in answer.headers


def test_a_wrong_name_and_a_wrong_secret_look_the_same(house: House) -> None:
    assert house.log_in("Anna", "wrong").text == house.log_in("nobody", SECRET).text


@pytest.mark.parametrize("path", ["/login", "/logout"])
@pytest.mark.parametrize("origin", [None, "null", "http://example.org"])
def test_no_other_site_logs_anybody_in_or_out(web: httpx.Client, house: House, path: str, origin: str | None) -> None:
    cookie = house.cookie("Anna")
    headers = {"Cookie": cookie} | ({} if origin is None else {"Origin": origin})
    answer = web.post(path, data={"name": "Anna", "secret": SECRET}, headers=headers)
    assert answer.status_code == 403
    assert "set-cookie" not in answer.headers
    assert "Anna" in web.get("/account", headers={"Cookie": cookie}).text


def closing_code(socket: ClientConnection) -> int | None:
    """With which code the server closes a page's web socket, whatever else it still sends."""
    with suppress(ConnectionClosed):
        while True:
            socket.recv(WAIT_S)
    return socket.close_code


def test_logging_out_ends_the_pass_everywhere(web: httpx.Client, house: House, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(proxy, "RECHECK_S", 0.05)
    cookie = house.cookie("Anna")
    with house.socket(cookie) as socket:
        answer = web.post("/logout", headers={"Cookie": cookie, "Origin": house.door.address})
        assert answer.headers["location"] == "/login"
        assert web.get("/", headers={"Cookie": cookie}).status_code == 303
        assert closing_code(socket) == 1008


def test_somebody_removed_is_put_out(
    house: House, people: Path, web: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(proxy, "RECHECK_S", 0.05)
    before = read_people(people)
    write_people(people, with_person(before, "Gast", "watcher", SECRET))
    cookie = house.cookie("Gast")
    with house.socket(cookie) as socket:
        write_people(people, before)
        assert web.get("/", headers={"Cookie": cookie}).status_code == 303
        assert closing_code(socket) == 1008


def test_a_broken_list_of_users_lets_nobody_in_until_it_is_mended(house: House, people: Path) -> None:
    content = people.read_bytes()
    people.write_text("{")
    assert house.log_in("Anna").status_code == 401
    people.write_bytes(content)
    assert house.log_in("Anna").status_code == 303


def test_the_link_opens_once_and_its_name_says_so(house: House, web: httpx.Client) -> None:
    link = house.door.link
    assert link is not None
    assert web.head(link).status_code == 200, "a preview of the link does not use it up"
    answer = web.get(link)
    assert (answer.status_code, answer.headers["location"]) == (303, "/")
    assert "(local)</b>, operator" in web.get("/account").text
    web.cookies.clear()
    assert web.get(link).status_code == 403
    assert "set-cookie" not in web.get(f"{link}x").headers


def test_every_answer_tells_the_browser_to_be_careful(web: httpx.Client, house: House) -> None:
    cookie = house.cookie("Anna")
    for path in ("/", "/login", "/account", "/nothing", "/door.css", "/enter?key=x"):
        headers = web.get(path, headers={"Cookie": cookie}).headers
        assert "frame-ancestors 'none'" in headers["content-security-policy"]
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["referrer-policy"] == "same-origin"


def test_the_page_runs_its_own_two_scripts_and_connects_to_its_own_server(house: House) -> None:
    answer = httpx.get(house.door.address, headers={"Cookie": house.cookie("Anna")}, trust_env=False)
    policy = dict(part.split(" ", 1) for part in answer.headers["content-security-policy"].split("; "))
    assert re.fullmatch(r"('sha256-[^']+' ){2}'wasm-unsafe-eval'", policy["script-src"])
    assert policy["connect-src"] == "'self' data: blob:"
    assert policy["default-src"] == "'none'"


def test_viser_itself_is_out_of_reach(house: House) -> None:
    uri = house.door._hidden.uri
    address = uri.replace("ws", "http", 1)
    for headers in ({}, {"X-Rotrecon-Ticket": ""}, {"X-Rotrecon-Ticket": "guess"}):
        assert httpx.get(address, headers=headers, trust_env=False).status_code == 403
        with pytest.raises(InvalidStatus):
            websockets.sync.client.connect(uri, additional_headers=headers, proxy=None)
    assert house.server.get_host() == "127.0.0.1"
    assert house.server.get_port() != house.door.port


def test_the_name_behind_a_page_is_the_one_that_logged_in(house: House) -> None:
    pages = {name: house.page(name) for name in ("Anna", "Walt")}
    for name, page in pages.items():
        assert house.door.name_of(page.client_id) == name
        page.close()
    until(lambda: not {page.client_id for page in pages.values()} & set(house.server.get_clients()))
    assert house.door.name_of(pages["Anna"].client_id) == "Anna", "also after the page has gone"
    assert house.door.name_of(10**9) is None


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> Certificate:
    folder = tmp_path_factory.mktemp("tls")
    files = Certificate(folder / "cert.pem", folder / "key.pem")
    command = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes"]
    where = ["-keyout", str(files.key), "-out", str(files.certificate), "-days", "2"]
    who = ["-subj", "/CN=localhost", "-addext", "subjectAltName=IP:127.0.0.1,DNS:localhost"]
    subprocess.run([*command, *where, *who], check=True, capture_output=True)
    return files


def test_with_a_certificate_everything_is_encrypted(house: House, people: Path, certificate: Certificate) -> None:
    bound = listen("0.0.0.0", 0, people, certificate)
    door = Door(house.door._hidden, people, bound, "0.0.0.0", certificate)
    door.start()
    address = f"https://127.0.0.1:{door.port}"
    trusted = ssl.create_default_context(cafile=certificate.certificate)
    try:
        assert door.link is None, "a link that lets in without a secret is for this machine alone"
        with httpx.Client(base_url=address, verify=trusted, trust_env=False) as web:
            answer = web.post("/login", data={"name": "Anna", "secret": SECRET}, headers={"Origin": address})
            (morsel,) = SimpleCookie(answer.headers["set-cookie"]).values()
            assert morsel["secure"]
            assert web.get("/").status_code == 200
        headers = {"Cookie": f"{morsel.key}={morsel.value}", "Origin": address}
        with websockets.sync.client.connect(
            address.replace("http", "ws", 1),
            additional_headers=headers,
            subprotocols=["viser-v1.1.1"],  # pyright: ignore[reportArgumentType]
            ssl=trusted,
            proxy=None,
        ) as socket:
            assert socket.recv(10)
    finally:
        door.stop()


def test_beyond_this_machine_it_takes_users_and_tls(people: Path, certificate: Certificate, tmp_path: Path) -> None:
    nobody = tmp_path / "users.json"
    for users, files, missing in (
        (nobody, None, ("rotrecon user add", "--certificate")),
        (nobody, certificate, ("rotrecon user add",)),
        (people, None, ("--certificate",)),
    ):
        with pytest.raises(HostError) as refused:
            listen("0.0.0.0", 0, users, files)
        assert all(word in str(refused.value) for word in missing)
    listen("0.0.0.0", 0, people, certificate).close()
    listen("127.0.0.1", 0, nobody, None).close()


def test_a_taken_port_and_a_useless_certificate_are_told(house: House, people: Path, certificate: Certificate) -> None:
    with pytest.raises(HostError, match=f"port {house.door.port} .*--port"):
        listen("127.0.0.1", house.door.port, people, None)
    for files in (Certificate(people, people), Certificate(certificate.certificate, people / "none")):
        with pytest.raises(HostError, match="--certificate"):
            listen("127.0.0.1", 0, people, files)
