# SPDX-License-Identifier: MIT
"""Clients of `grctl serve`, good and bad. usage: cockpit.py SCENARIO [GRCTL]; each scenario is a
function below, starts a server of its own on the simulator, and ends with an exception where
something is not as docs/serve.md tells."""
import glob
import gzip
import http.client
import json
import os
import random
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

GRCTL = os.environ["GRCTL"]
MOTIONS = "motions"
STOPS = int(os.environ.get("STOPS", "4"))  # how many stops are tried, in each of some ways
PATIENCE_S = 30  # where something is waited for; a busy machine is no failure


class HeldUp(Exception):
    """The machine held the server up for so long that it stopped the robot, as it must then."""


class Refused(Exception):
    def __init__(self, status, error):
        super().__init__(f"{status} {error}")
        self.status = status
        self.code = error.get("code")
        self.error = error


class Server:
    """`grctl serve`, until the end of the with statement. broker: of a fleet."""

    def __init__(self, *words, motions=MOTIONS, device="sim", env=None, broker=None):
        of = ["serve", "--broker", broker] if broker else ["-d", device, "serve", motions]
        self.words = [GRCTL, "--json", *of, "--port", "0", *words]
        self.env = dict(os.environ, **(env or {}))

    def __enter__(self):
        self.process = subprocess.Popen(self.words, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                        env=self.env, text=True)
        line = self.process.stdout.readline()
        if not line.startswith("{"):
            raise AssertionError(f"no line of JSON: {line} {self.process.stderr.read()}")
        told = json.loads(line)
        if "url" not in told:
            raise AssertionError(f"did not start: {told}")
        self.token = told["token"]
        self.links = (told["url"], told["stop_url"])
        self.port = int(re.search(r":(\d+)/", told["url"]).group(1))
        self.stop_port = int(re.search(r":(\d+)/", told["stop_url"]).group(1))
        return self

    def __exit__(self, kind, value, trace):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        self.status = self.process.wait(PATIENCE_S)
        self.said = self.process.stderr.read()
        if kind is None and self.status != 128 + signal.SIGTERM:
            raise AssertionError(f"the server ended with {self.status}: {self.said}")

    def rss_kb(self):
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as status:
            return int(re.search(r"VmRSS:\s+(\d+)", status.read()).group(1))


class Page:
    """A page: one connection for requests, perhaps the lease."""

    def __init__(self, server, name="test"):
        self.server = server
        self.name = name
        self.lease = None
        self.beating = None

    def ask(self, method, path, body=None, headers=None, port=None, timeout_s=PATIENCE_S):
        """Status, headers, body as bytes."""
        connection = http.client.HTTPConnection("127.0.0.1", port or self.server.port,
                                                timeout=timeout_s)
        sent = {"X-Grobo-Token": self.server.token, **(headers or {})}
        if self.lease:
            sent.setdefault("X-Grobo-Lease", self.lease)
        if body is not None and not isinstance(body, bytes):
            body = json.dumps(body).encode()
            sent.setdefault("Content-Type", "application/json")
        connection.request(method, path, body, {k: v for k, v in sent.items() if v is not None})
        answer = connection.getresponse()
        got = answer.read()
        connection.close()
        return answer.status, answer.headers, got

    def call(self, method, path, body=None, headers=None):
        status, _, got = self.ask(method, path, body, headers)
        told = json.loads(got) if got else None
        if status >= 400:
            raise Refused(status, told["error"])
        return told

    def get(self, path):
        return self.call("GET", path)

    def post(self, path, **body):
        return self.call("POST", "/api/" + path, body)

    def target(self, path, **body):
        """A request that is based on the present state."""
        return self.post(path, sequence=self.state()["sequence"], **body)

    def state(self):
        return self.get("/api/state")

    def take(self):
        self.lease = self.post("lease", action="take", name=self.name)["lease"]
        return self

    def beat(self, drawn=None, lease=None):
        body = {"lease": lease or self.lease, "token": self.server.token,
                "drawn": self.state()["sequence"] if drawn is None else drawn}
        return self.ask("POST", "/heartbeat", json.dumps(body).encode(),
                        {"Content-Type": "text/plain", "X-Grobo-Token": None,
                         "X-Grobo-Lease": None}, self.server.stop_port)[0]

    def keep_beating(self):
        stop = threading.Event()

        def beat():
            while not stop.wait(0.2):
                self.beat()

        thread = threading.Thread(target=beat, daemon=True)
        thread.start()
        self.beating = (stop, thread)
        return self

    def fall_silent(self):
        if self.beating:
            self.beating[0].set()
            self.beating[1].join()
            self.beating = None

    def wait(self, what, holds):
        until = time.monotonic() + PATIENCE_S
        while True:
            state = self.state()
            if holds(state):
                return state
            if time.monotonic() > until:
                self.held_up(self.events())
                raise AssertionError(f"{what}: not so: {json.dumps(state)[:3000]}")
            time.sleep(0.02)

    def wait_played(self, *states):
        return self.wait(" or ".join(states), lambda s: s["play"]["state"] in states)

    def events(self):
        """All events that are kept."""
        stream = Stream(self.server, {"Last-Event-ID": "0"})
        found = []
        while True:
            kind, data = stream.next()
            if kind == "state":
                stream.close()
                return found
            if kind == "event":
                found.append(data)

    @staticmethod
    def held_up(events):
        if any(e.get("trip") == "host_stalled" for e in events):
            raise HeldUp

    def wait_event(self, pattern):
        until = time.monotonic() + PATIENCE_S
        while True:
            events = self.events()
            found = [e for e in events if re.search(pattern, e["message"])]
            if found:
                return found[-1]
            self.held_up(events)
            if time.monotonic() > until:
                raise AssertionError(f"no event like {pattern}: {events}")
            time.sleep(0.05)


class Stream:
    """The raw stream of server-sent events."""

    def __init__(self, server, headers=None, buffer_bytes=None):
        self.socket = socket.socket()
        if buffer_bytes:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer_bytes)
        self.socket.settimeout(PATIENCE_S)
        self.socket.connect(("127.0.0.1", server.port))
        lines = [f"{k}: {v}" for k, v in (headers or {}).items()]
        self.socket.sendall("\r\n".join(
            ["GET /api/events HTTP/1.0", f"Host: 127.0.0.1:{server.port}", *lines, "", ""]).encode())
        self.text = b""
        while b"\r\n\r\n" not in self.text:
            self.read()
        head, self.text = self.text.split(b"\r\n\r\n", 1)
        self.head = head.decode()
        if " 200 " not in self.head.splitlines()[0]:
            raise Refused(int(self.head.split()[1]), {"code": "?"})

    def read(self):
        got = self.socket.recv(65536)
        if not got:
            raise EOFError
        self.text += got

    def next(self):
        """("state" or "event", data) or ("comment", text)."""
        while b"\n\n" not in self.text:
            self.read()
        block, self.text = self.text.split(b"\n\n", 1)
        lines = block.decode().split("\n")
        if lines[0].startswith(":"):
            return "comment", lines[0]
        fields = dict(line.split(": ", 1) for line in lines)
        return fields["event"], json.loads(fields["data"])

    def close(self):
        self.socket.close()


def expect(status, code, call, *words, **body):
    try:
        call(*words, **body)
    except Refused as no:
        if (no.status, no.code) != (status, code):
            raise AssertionError(f"{no}, not {status} {code}") from no
        return no
    raise AssertionError(f"not refused: {words} {body}")


def same(got, wanted, what=""):
    if got != wanted:
        raise AssertionError(f"{what}: {got!r}, not {wanted!r}")


def raw(port, request, timeout_s=PATIENCE_S):
    """What comes for these bytes until the other side closes, as text."""
    with socket.create_connection(("127.0.0.1", port), timeout_s) as s:
        s.sendall(request)
        got = b""
        while True:
            more = s.recv(65536)
            if not more:
                return got.decode(errors="replace")
            got += more


def beside(*calls):
    """These beside each other; what each raised, or None."""
    raised = [None] * len(calls)

    def run(i):
        try:
            calls[i][0](*calls[i][1:])
        except BaseException as error:
            raised[i] = error

    threads = [threading.Thread(target=run, args=(i,)) for i in range(len(calls))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return raised


# ---- who may ask what --------------------------------------------------------------------------

def refusals():
    with Server() as server:
        page = Page(server)
        host = f"127.0.0.1:{server.port}"

        def status(lines, port=server.port):
            text = raw(port, "\r\n".join([*lines, "Connection: close", "", ""]).encode())
            head = text.split("\r\n\r\n")[0].lower()
            assert "access-control" not in head, head
            return int(text.split()[1])

        same(status(["GET /api/state HTTP/1.1", f"Host: {host}"]), 200, "as it should be")
        for own in (f"localhost:{server.port}", f"LOCALHOST:{server.port}", f"[::1]:{server.port}"):
            same(status(["GET /api/state HTTP/1.1", f"Host: {own}"]), 200, own)
        for foreign in ("evil.example", f"evil.example:{server.port}", "127.0.0.1",
                        f"127.0.0.1:{server.stop_port}", f"127.0.0.1.evil.example:{server.port}",
                        f"{host}.", f"user@{host}", ""):
            same(status(["GET /api/state HTTP/1.1", f"Host: {foreign}"]), 403, f"Host {foreign!r}")
            same(status(["GET / HTTP/1.1", f"Host: {foreign}"]), 403, f"page, Host {foreign!r}")
        same(status(["GET /api/state HTTP/1.1"]), 403, "no Host")
        same(status(["GET /api/state HTTP/1.1", f"Host: {host}", f"Host: {host}"]), 403, "two")
        same(status([f"GET http://{host}/api/state HTTP/1.1", f"Host: {host}"]), 403, "absolute")
        same(status(["GET http://evil.example/api/state HTTP/1.1", f"Host: {host}"]), 403, "URI")
        same(status(["GET //evil.example/api/state HTTP/1.1", f"Host: {host}"]), 403, "two /")

        def foreign_page(headers, path="/api/stop", port=server.port):
            return status([f"POST {path} HTTP/1.1", f"Host: 127.0.0.1:{port}",
                           "Content-Type: application/json", "Content-Length: 2",
                           *headers, "", "{}"], port)

        def post(headers, path, port=server.port, body="{}"):
            text = raw(port, "\r\n".join([f"POST {path} HTTP/1.1", f"Host: 127.0.0.1:{port}",
                                          f"Content-Length: {len(body)}", "Connection: close",
                                          *headers, "", body]).encode())
            return int(text.split()[1])

        json_type = "Content-Type: application/json"
        own = f"Origin: http://{host}"
        token = f"X-Grobo-Token: {server.token}"
        for port, path in ((server.port, "/api/stop"), (server.stop_port, "/stop")):
            for origin in ("http://evil.example", "null", f"https://{host}", "http://127.0.0.1",
                           f"http://127.0.0.1:{server.stop_port}", f"http://{host}.evil.example"):
                same(post([json_type, f"Origin: {origin}"], path, port), 403, f"{path} {origin}")
            same(post([json_type, own, own], path, port), 403, "two Origins")
            same(post([json_type, "Sec-Fetch-Site: cross-site"], path, port), 403, "cross-site")
            same(post([json_type, own, "Sec-Fetch-Site: cross-site"], path, port), 403, "both")
        same(post([json_type, "Sec-Fetch-Site: same-site"], "/api/stop"), 403, "another port's page")
        assert not page.state()["stop"]["latched"], "one of these stopped the robot"
        for path in ("/api/play", "/api/torque", "/api/reset", "/api/preview"):
            same(post(["Content-Type: text/plain", token], path), 415, path)
            same(post([json_type], path), 401, path + " without token")
        for method in ("OPTIONS", "DELETE", "PATCH", "TRACE", "FOO", "PUT"):
            same(status([f"{method} /api/play HTTP/1.1", f"Host: {host}", "Content-Length: 0"]), 405,
                 method)
        same(status(["GET /api/play HTTP/1.1", f"Host: {host}"]), 405, "GET of a verb")
        same(post([json_type, token], "/api/state"), 405, "POST of data")
        same(status(["OPTIONS /api/play HTTP/1.1", f"Host: {host}", "Origin: http://evil.example",
                     "Access-Control-Request-Method: POST"]), 403, "preflight")
        began = time.monotonic()
        same(post([json_type, "X-Grobo-Token: " + "0" * 32], "/api/reset"), 401, "a wrong token")
        assert time.monotonic() - began > 0.2, "a wrong token is answered at once"
        expect(409, "lease", page.post, "pause")
        page.lease = "0" * 32
        expect(409, "lease", page.target, "play", motion="greet.pseq")
        same(post([json_type, token], "/api/ik", body="[]"), 400, "no object")
        same(post([json_type, token], "/api/ik", body='{"a":1,"a":2}'), 400, "a key twice")
        same(post([json_type, token], "/api/ik", body="{" * 60000), 400, "deep")
        same(post([own, json_type], "/api/stop"), 200, "our own page stops")
        same(post([own, "Content-Type: text/plain", "Sec-Fetch-Site: same-site"], "/stop",
                  server.stop_port), 204, "and by the second port")
        same(post([], "/stop", server.stop_port), 204, "and curl, with no content type")


def framing():
    """What a request says twice, or in a way of its own, is refused in JSON, with its connection."""
    with Server() as server:
        host = f"Host: 127.0.0.1:{server.port}\r\n"
        fine = "Content-Length: 2\r\n"
        for status, request in (
                (400, f"POST /api/lease HTTP/1.1\r\n{host}{fine}{fine}\r\n{{}}"),
                (400, f"POST /api/lease HTTP/1.1\r\n{host}{fine}Content-Length: 30\r\n\r\n{{}}"),
                (400, f"POST /api/lease HTTP/1.1\r\n{host}Content-Length: 2, 2\r\n\r\n{{}}"),
                (400, f"POST /api/lease HTTP/1.1\r\n{host}Content-Length: +2\r\n\r\n{{}}"),
                (400, f"POST /api/lease HTTP/1.1\r\n{host}Content-Length: -2\r\n\r\n{{}}"),
                (400, f"POST /api/lease HTTP/1.1\r\n{host}Content-Length:\r\n\r\n{{}}"),
                (413, f"POST /api/lease HTTP/1.1\r\n{host}Content-Length: 99999999\r\n\r\n{{}}"),
                (413, f"POST /api/lease HTTP/1.1\r\n{host}Content-Length: 1048577\r\n\r\n{{}}"),
                (400, f"POST /api/lease HTTP/1.1\r\n{host}{fine}Transfer-Encoding: chunked\r\n\r\n"),
                (501, f"POST /api/lease HTTP/1.1\r\n{host}Transfer-Encoding: gzip\r\n\r\n{{}}"),
                (501, f"POST /api/lease HTTP/1.1\r\n{host}Transfer-Encoding: chunked, gzip\r\n\r\n"),
                (417, f"POST /api/lease HTTP/1.1\r\n{host}{fine}Expect: 200-ok\r\n\r\n{{}}"),
                (400, f"GET /api/state\r\n{host}\r\n"),
                (400, f"GET /api/a b HTTP/1.1\r\n{host}\r\n"),
                (400, f"GET\t/api/state HTTP/1.1\r\n{host}\r\n"),
                (400, f" GET /api/state HTTP/1.1\r\n{host}\r\n"),
                (400, f"GET /api/state HTTP/1.1\r\n{host}X: a\r\n folded\r\n\r\n"),
                (400, f"GET /api/state HTTP/1.1\r\n{host}Content-Length : 2\r\n\r\n"),
                (400, f"GET /api/state HTTP/1.1\r\n{host}: 2\r\n\r\n"),
                (400, f"GET /api/state HTTP/1.1\r\n{host}nonsense\r\n\r\n"),
                (400, f"GET /api/state HTTP/1.1\r\n{host}X: a\0b\r\n\r\n"),
                (400, "\0\1\2\r\n\r\n"),
                (505, f"GET /api/state HTTP/2.0\r\n{host}\r\n"),
                (405, f"TRACE /api/state HTTP/1.1\r\n{host}\r\n"),
                (405, f"QUERY /api/state HTTP/1.1\r\n{host}{fine}\r\n{{}}")):
            head, _, body = raw(server.port, request.encode()).partition("\r\n\r\n")
            same(int(head.split()[1]), status, request)
            assert "Content-Type: application/json" in head, head
            assert "Connection: close" in head, head
            assert "Allow: GET\r\n" in head + "\r\n" or status != 405, head
            assert json.loads(body)["error"]["message"], body
        # Behind a request that is whole, nobody is asked before it is refused.
        two = raw(server.port, f"GET /api/state HTTP/1.1\r\n{host}\r\nPOST /api/lease HTTP/1.1\r\n"
                               f"{host}Content-Type: application/json\r\n{fine}{fine}\r\n{{}}".encode())
        same([part.split()[0] for part in two.split("HTTP/1.1 ")[1:]], ["200", "400"])
        # A stop whose length nobody can tell is carried out, and refused.
        page = Page(server).take()
        page.keep_beating()
        page.target("move", angle_deg={"R_ELBOW_P": 40}, time_ms=3000)
        page.wait("moving", lambda s: s["moving"])
        raw(server.port, f"POST /api/stop HTTP/1.1\r\n{host}{fine}{fine}\r\n{{}}".encode())
        page.wait("stopped", lambda s: s["stop"]["kind"] is not None)
        page.fall_silent()


def sizes():
    with Server() as server:
        host = f"Host: 127.0.0.1:{server.port}"
        text = raw(server.port, f"GET /api/state HTTP/1.1\r\n{host}\r\nX: {'y' * 9000}\r\n\r\n".encode())
        same(text.split()[1], "431", "9 kB of header")
        for path, size, wanted in (("/api/ik", 65 * 1024, 413), ("/api/ik", 2 * 1024 * 1024, 413),
                                   ("/api/preview", 65 * 1024, 400),
                                   ("/api/preview", 2 * 1024 * 1024, 413)):
            body = b" " * size
            with socket.create_connection(("127.0.0.1", server.port), PATIENCE_S) as s:
                s.sendall(f"POST {path} HTTP/1.1\r\n{host}\r\nX-Grobo-Token: {server.token}\r\n"
                          f"Content-Type: application/json\r\nContent-Length: {size}\r\n\r\n".encode())
                try:
                    s.sendall(body)
                except OSError:
                    pass  # refused before all was sent
                same(s.recv(4096).split()[1], str(wanted).encode(), f"{size} bytes to {path}")
        both = raw(server.port, f"POST /api/stop HTTP/1.1\r\n{host}\r\nContent-Length: 2\r\n"
                                "Transfer-Encoding: chunked\r\nConnection: close\r\n\r\n{}".encode())
        assert both == "" or int(both.split()[1]) >= 400, both
        began = time.monotonic()
        raw(server.port, f"GET /api/state HTTP/1.1\r\n{host}\r\n".encode())  # and no more
        took = time.monotonic() - began
        assert 4 < took < PATIENCE_S, f"half a request lived {took} s"
        Page(server).state()


def escapes():
    folder = tempfile.mkdtemp()
    outside = os.path.join(folder, "secret.pseq")
    inside = os.path.join(folder, "motions")
    os.mkdir(inside)
    shutil.copy("motions/greet.pseq", outside)
    shutil.copy("motions/greet.pseq", inside)
    os.symlink(outside, os.path.join(inside, "link.pseq"))
    with Server(motions=inside) as server:
        page = Page(server).take()
        same([m["name"] for m in page.get("/api/motions")["motions"]], ["greet.pseq"], "list")
        for name in ("../secret.pseq", "..%2fsecret.pseq", "%2e%2e%2fsecret.pseq", "link.pseq",
                     "..%5csecret.pseq", outside, outside.replace("/", "%2f"), "greet.pseq%00",
                     ".", "..", "%00", "greet.pseq/../../secret.pseq"):
            for tail in ("", "/file"):
                status = page.ask("GET", "/api/motions/" + name + tail)[0]
                assert status in (400, 403, 404), f"{name}{tail}: {status}"
                status = page.ask("PUT", "/api/motions/" + name + tail, {"keys": []},
                                  {"If-None-Match": "*"})[0]
                assert status >= 400, f"PUT {name}{tail}: {status}"
            try:
                page.target("play", motion=name)
                raise AssertionError(f"played {name}")
            except Refused as no:
                assert no.code in ("noent", "arg"), no
    same(sorted(os.listdir(folder)), ["motions", "secret.pseq"], "files")
    same(sorted(os.listdir(inside)), ["greet.pseq", "link.pseq"], "files")
    shutil.rmtree(folder)


def beyond_loopback():
    """Listening on all addresses: reading needs the token, and so does a stop."""
    with Server("--listen", "0.0.0.0", "--name", "robot.local") as server:
        page = Page(server)

        def status(headers, path="/api/state"):
            return page.ask("GET", path, headers=headers)[0]

        same(status({}), 200, "with token")
        same(status({"X-Grobo-Token": None}), 401, "without")
        same(status({"X-Grobo-Token": None}, "/"), 200, "the page itself")
        same(status({"Host": f"robot.local:{server.port}"}), 200, "its name")
        same(status({"Host": f"other.local:{server.port}"}), 403, "another name")
        same(page.ask("POST", "/stop", b"{}", {"X-Grobo-Token": None}, server.stop_port)[0], 401,
             "stop without token")
        same(page.ask("POST", "/stop", json.dumps({"token": server.token}).encode(),
                      {"X-Grobo-Token": None, "Content-Type": "text/plain"}, server.stop_port)[0],
             204, "stop with the token in its body")
        assert page.state()["stop"]["latched"]


def printed_links():
    """The link of each way to listen leads to the page, and its other port takes a stop."""
    ways = [(), ("--listen", "127.0.0.2"), ("--listen", "0.0.0.0"),
            ("--listen", "127.0.0.2", "--name", "localhost")]
    if os.path.exists("/proc/sys/net/ipv6") and socket.has_ipv6:
        ways.append(("--listen", "::1"))
    for words in ways:
        with Server(*words) as server:
            told = [re.fullmatch(r"http://(.+):(\d+)/", url) for url in server.links]
            assert all(told), f"{words}: {server.links}"
            for link, path in zip(told, ("/", "/stop")):
                host, port = link.group(1), int(link.group(2))
                at = words[1] if words and words[1] != "0.0.0.0" else "127.0.0.1"
                connection = http.client.HTTPConnection(at, port, timeout=PATIENCE_S)
                connection.request("GET" if path == "/" else "POST", path, None,
                                   {"Host": f"{host}:{port}", "X-Grobo-Token": server.token,
                                    "Origin": f"http://{told[0].group(1)}:{server.port}"})
                answer = connection.getresponse()
                same(answer.status, 200 if path == "/" else 204, f"{words}: {link.group()}{path}")
                connection.close()


def page_files():
    with Server() as server:
        page = Page(server)
        status, headers, body = page.ask("GET", "/")
        same(status, 200)
        same(headers["Content-Encoding"], "gzip")
        same(body[:2], b"\x1f\x8b")
        policy = headers["Content-Security-Policy"]
        for part in ("default-src 'none'", "script-src 'self'", "frame-ancestors 'none'",
                     f"connect-src 'self' http://127.0.0.1:{server.stop_port};"):
            assert part in policy, policy
        for name, value in (("X-Content-Type-Options", "nosniff"),
                            ("Referrer-Policy", "no-referrer"),
                            ("Cross-Origin-Resource-Policy", "same-origin"),
                            ("Cross-Origin-Opener-Policy", "same-origin"),
                            ("Cache-Control", "no-cache")):
            same(headers[name], value, name)
        assert "unsafe" not in policy
        same(page.ask("GET", "/", headers={"If-None-Match": headers["ETag"]})[0], 304)
        same(page.ask("GET", "/index.html")[0], 200)
        below = re.search(rb'href="(v[^/"]+)/style.css"', gzip.decompress(body)).group(1).decode()
        for path, kept in (("/style.css", "no-cache"),
                           (f"/{below}/style.css", "max-age=31536000, immutable")):
            status, headers, style = page.ask("GET", path)
            same((status, headers["Cache-Control"], headers["Content-Encoding"]), (200, kept, "gzip"), path)
            assert b"#stop" in gzip.decompress(style)
        for path in (f"/{below}", f"/{below}/", f"/{below}x/style.css", f"/{below}//style.css",
                     f"/{below}/{below}/style.css", f"/{below}/../Makefile", "/v1-1/style.css"):
            same(page.ask("GET", path)[0], 404, path)
        for path in ("/nothing", "/../Makefile", "/%2e%2e/Makefile", "/index.html/"):
            status, headers, _ = page.ask("GET", path)
            assert status in (403, 404), f"{path}: {status}"
            same(headers["X-Content-Type-Options"], "nosniff")
        same(page.ask("GET", "/stop", port=server.stop_port)[0], 405)
        same(page.ask("GET", "/", port=server.stop_port)[0], 404)
        same(page.ask("POST", "/stop", {})[0], 404)


# ---- streams -----------------------------------------------------------------------------------

def stream():
    """States come 30 times a second and are complete; events have ids, and are told again."""
    with Server() as server:
        s = Stream(server)
        assert "text/event-stream" in s.head
        states, comments = [], 0
        while len(states) < 60:
            kind, data = s.next()
            if kind == "state":
                states.append(data)
            comments += kind == "comment"
        s.close()
        same([b["sequence"] - a["sequence"] for a, b in zip(states, states[1:])], [1] * 59)
        took_ms = states[-1]["time_ms"] - states[0]["time_ms"]
        assert took_ms >= 59 * 30, f"59 states in {took_ms} ms"
        assert comments >= 1
        page = Page(server).take()
        events = page.events()
        same([e["id"] for e in events], list(range(1, len(events) + 1)))
        assert any("test drives" in e["message"] for e in events), events


def greedy():
    """A stream that sends something is dropped, and costs nothing."""
    with Server() as server:
        page = Page(server)
        before_kb = server.rss_kb()
        s = Stream(server)
        s.next()
        sent = 0
        try:
            for _ in range(2000):
                s.socket.sendall(b"x" * 65536)
                sent += 65536
        except OSError:
            pass
        assert sent < 50e6, f"it took {sent} bytes"
        page.wait("no stream is left", lambda state: state["clients"] == 0)
        assert server.rss_kb() - before_kb < 20000, f"{server.rss_kb()} kB, {before_kb} before"
        early = socket.create_connection(("127.0.0.1", server.port), PATIENCE_S)
        early.sendall(f"GET /api/events HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n\r\nGET / ".encode())
        page.wait("nor one whose bytes came at once", lambda state: state["clients"] == 0)
        early.close()


def slow():
    """Who does not read is dropped within seconds; the others get all states meanwhile."""
    with Server() as server:
        page = Page(server)
        before_kb = server.rss_kb()
        deaf = Stream(server, buffer_bytes=4096)
        other = Stream(server)
        states, clients = [], 2
        until = time.monotonic() + PATIENCE_S
        while clients > 1 and time.monotonic() < until:
            kind, data = other.next()
            if kind == "state":
                states.append(data["sequence"])
                clients = data["clients"]
        same(clients, 1, "clients at last")
        same([b - a for a, b in zip(states, states[1:])], [1] * (len(states) - 1), "the other")
        assert server.rss_kb() - before_kb < 20000
        deaf.close()
        other.close()
        page.state()


def crowd():
    """32 streams and no more; the port's places are taken, and a stop comes through all the same."""
    with Server() as server:
        page = Page(server)
        streams = [Stream(server) for _ in range(32)]
        expect(503, "?", Stream, server)
        idle = [socket.create_connection(("127.0.0.1", server.port), PATIENCE_S) for _ in range(40)]
        began = time.monotonic()
        same(page.ask("POST", "/stop", b"{}", {}, server.stop_port)[0], 204)
        print(f"# stop beside 72 connections: {(time.monotonic() - began) * 1e3:.1f} ms")
        for s in idle:
            s.close()
        for s in streams:
            s.close()
        page.wait("all are gone", lambda state: state["clients"] == 0)
        assert page.state()["stop"]["latched"]


def has_ended(connection):
    """Whether the other side has closed it."""
    connection.setblocking(False)
    try:
        return connection.recv(1, socket.MSG_PEEK) == b""
    except BlockingIOError:
        return False
    except OSError:
        return True


def ask_until(page, path, port):
    """The status of a POST. On a machine that holds the client up between its connection and its
    request for a second, it is half open itself, and makes room: it comes again, as a page does."""
    for _ in range(20):
        try:
            return page.ask("POST", path, b"{}", {}, port, 4 * PATIENCE_S)[0]
        except (ConnectionError, http.client.RemoteDisconnected):
            print("# made room itself")
    raise AssertionError(f"{path}: the connection ended 20 times")


def half_open():
    """Connections that never make a request hold no place where somebody comes with one."""
    ways = (b"", b"POST /stop HTT", b"POST /stop HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nX: ",
            b"GET /api/state HTTP/1.1\r\n",
            b"POST /api/ik HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nContent-Length: 9\r\n\r\n{")
    with Server() as server:
        page = Page(server)
        for port, path in ((server.stop_port, "/stop"), (server.port, "/api/stop")):
            for n, way in enumerate(ways):
                held = [socket.create_connection(("127.0.0.1", port), PATIENCE_S) for _ in range(64)]
                for s in held:
                    s.sendall(way.replace(b"%d", b"%d" % port))
                began = time.monotonic()
                status = ask_until(page, path, port)
                print(f"# {path} beside 64 half open, {way[:20]}: "
                      f"{(time.monotonic() - began) * 1e3:.1f} ms")
                same(status, 204 if path == "/stop" else 200)
                # It was answered before those were ended: each ends half a request after 5 s.
                ended = [s for s in held if has_ended(s)]
                assert len(ended) < len(held), f"{path}, way {n}: only when all had ended"
                for s in held:
                    s.close()
        beside_a_flood(server, page)
        # The page and its stream are there still.
        stream = Stream(server)
        held = [socket.create_connection(("127.0.0.1", server.port), PATIENCE_S) for _ in range(80)]
        for _ in range(40):
            stream.next()
        for s in held:
            s.close()
        stream.close()
        page.wait("they are gone", lambda s: s["clients"] == 0)


def beside_a_flood(server, page):
    """A stop beside clients that open connections again and again, faster than they end."""
    stop = threading.Event()

    def flood(port):
        opened = []
        while not stop.is_set():
            try:
                opened.append(socket.create_connection(("127.0.0.1", port), 1))
            except OSError:
                pass
            if len(opened) > 150:
                opened.pop(0).close()
        for s in opened:
            s.close()

    flooders = [threading.Thread(target=flood, args=(server.stop_port,), daemon=True)
                for _ in range(2)]
    for one in flooders:
        one.start()
    try:
        for _ in range(5):
            began = time.monotonic()
            # The system makes who comes wait a second, or three, or more on a busy machine.
            same(ask_until(page, "/stop", server.stop_port), 204)
            print(f"# /stop in a flood of connections: {(time.monotonic() - began) * 1e3:.1f} ms")
    finally:
        stop.set()
    for one in flooders:
        one.join()


def foreign():
    """Connections that are kept, and asked for refusals again and again, hold no place for long."""
    with Server() as server:
        page = Page(server)
        for port, path in ((server.stop_port, "/stop"), (server.port, "/api/stop")):
            held = [socket.create_connection(("127.0.0.1", port), PATIENCE_S) for _ in range(64)]
            stop = threading.Event()

            def refresh(wait_s=0, held=held, port=port, stop=stop):
                """From another page, each once."""
                for s in held:
                    try:
                        s.sendall(f"POST /stop HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://else"
                                  "where\r\nContent-Length: 0\r\n\r\n".encode())
                        assert s.recv(4096) == b"" or not stop.wait(wait_s)
                    except (OSError, AssertionError):
                        pass

            refresh()
            again = threading.Thread(target=lambda go=refresh, stop=stop: [
                go(0.01) for _ in iter(stop.is_set, True)], daemon=True)
            again.start()
            began = time.monotonic()
            status = page.ask("POST", path, b"{}", {"Content-Type": "application/json"}, port)[0]
            print(f"# {path} beside 64 of another page: {(time.monotonic() - began) * 1e3:.1f} ms")
            stop.set()
            again.join()
            for s in held:
                s.close()
            same(status, 204 if path == "/stop" else 200)
            page.wait("latched", lambda state: state["stop"]["latched"])


# ---- driving -----------------------------------------------------------------------------------

def names():
    """A name is told to others as it was given, or as many characters of it as fit."""
    with Server() as server:
        for given, told in (("a" + "あ" * 31, "a" + "あ" * 31), ("ab" + "あ" * 100, "ab" + "あ" * 41),
                            ("x" * 500, "x" * 127), ("😀" * 99, "😀" * 31), ("", "a script")):
            page = Page(server, given).take()
            no = expect(409, "lease", Page(server).post, "lease", action="take", name="other")
            same(no.error["holder"]["name"], told)
            assert no.error["message"].startswith(told + " drives since"), no.error
            same(page.state()["lease"]["holder"]["name"], told)
            page.wait_event(re.escape(told + " drives"))
            page.post("stop", name=given)
            same(page.state()["stop"]["by"], told)
            page.target("reset")


def driving():
    with Server() as server:
        page = Page(server).take().keep_beating()
        job = page.target("move", angle_deg={"R_ELBOW_P": -45}, time_ms=300)
        assert not job["done"]
        page.wait_event("move: done")
        page.wait("the elbow is there", lambda s: abs(s["angle_deg"][16] + 45) < 1)
        no = expect(422, "limit", page.target, "move", angle_deg={"R_ELBOW_P": 120})
        same((no.error["joint"], no.error["name"], no.error["value"]), (16, "R_ELBOW_P", 120.0))
        expect(404, "noent", page.target, "play", motion="nothing.pseq")
        expect(404, "notfound", page.target, "move", angle_deg={"R_ELBOW": 1})
        expect(400, "arg", page.target, "play", motion="greet.pseq", speed_pct=0)
        page.target("play", motion="greet.pseq", speed_pct=200, mirror=True)
        state = page.wait_played("playing")
        same((state["play"]["motion"], state["play"]["mirror"]), ("greet.pseq", True))
        same(len(state["play"]["ghost_deg"]), 20)
        page.target("queue", motion="bow.pseq")
        same(page.state()["play"]["queue"], ["bow.pseq"])
        page.post("pause")
        page.wait_played("paused")
        page.target("seek", t_ms=2000)
        page.target("resume")
        state = page.wait_played("playing")
        page.target("speed", speed_pct=1000)
        page.wait("bow is played", lambda s: s["play"]["motion"] == "bow.pseq")
        page.wait_played("finished")
        page.target("torque", joints=["right_arm"], mode="limp")
        arm = [j["joint"] for j in page.get("/api/robot")["joints"] if "right_arm" in j["groups"]]
        same(page.state()["limp"], arm)
        angles = page.post("capture", joints=["right_arm"])["angle_deg"]
        same([j for j, a in enumerate(angles) if a is not None], arm)

        def capture_one(name, joint):
            got = page.post("capture", joints=[name])["angle_deg"]
            same([j for j, a in enumerate(got) if a is not None], [joint])

        # Joint by joint, each on a connection of its own: they share a reading.
        names = {j["joint"]: j["name"] for j in page.get("/api/robot")["joints"]}
        same(beside(*[(capture_one, names[j], j) for j in names]), [None] * len(names))
        page.target("torque", joints=["right_arm"], mode="hold")
        page.wait("the arm holds", lambda s: s["limp"] == [] and s["torque"][16] == "on")
        page.fall_silent()


def wheels():
    """Wheels turn while the page asks for it, and no longer."""
    rover = os.path.abspath("docs/examples/robots/rover.yaml")
    with Server(env={"GRCTL_ROBOT": rover}) as server:
        page = Page(server).take().keep_beating()
        same([j.get("wheel", False) for j in page.get("/api/robot")["joints"]],
             [True, True, False, False])

        def turn(**speeds):
            try:
                page.target("drive", speed_dps=speeds)
            except Refused as no:
                if no.code not in ("state", "full", "stale"):  # their torque comes on
                    raise
            return page.state()["speed_dps"]

        end = time.time() + PATIENCE_S
        while abs(turn(left=90, right=-45)[0] - 90) > 3:
            assert time.time() < end, page.state()
            time.sleep(0.1)
        assert abs(page.state()["speed_dps"][1] + 45) < 3, page.state()
        page.wait("nobody asks: they stand", lambda s: s["speed_dps"][:2] == [0, 0])
        expect(422, "limit", page.target, "drive", speed_dps={"left": 300})
        expect(422, "unsupported", page.target, "drive", speed_dps={"pan": 3})
        expect(404, "notfound", page.target, "drive", speed_dps={"nobody": 3})
        expect(400, "arg", page.target, "drive", speed_dps={})
        expect(400, "arg", page.target, "drive", speed_dps={"left": "fast"})
        expect(400, "arg", page.post, "drive", speed_dps={"left": 3})
        expect(422, "arg", page.target, "move", angle_deg={"left": 3})
        turn(left=90)
        page.wait("it turns", lambda s: s["speed_dps"][0] > 20)
        page.post("halt")
        page.wait("it is halted", lambda s: s["speed_dps"][0] == 0 and not s["moving"])
        page.fall_silent()


def lines():
    """Two arms on two lines are one robot: all move, and a stop reaches both."""
    arms = os.path.abspath("docs/examples/robots/two-arms.yaml")
    with Server(env={"GRCTL_ROBOT": arms}) as server:
        page = Page(server).take().keep_beating()
        same([j["motor"] for j in page.get("/api/robot")["joints"]], [1, 2, 3, 4, 1, 2, 3, 4])
        page.target("move", angle_deg={"L_pan": 20, "R_pan": -20})
        page.wait("both arms are there", lambda s: not s["moving"]
                  and abs(s["angle_deg"][0] - 20) < 1 and abs(s["angle_deg"][4] + 20) < 1)
        page.target("move", angle_deg={"L_pan": -60, "R_pan": 60}, time_ms=6000)
        page.wait("both move", lambda s: s["angle_deg"][0] < 15 and s["angle_deg"][4] > -15)
        page.post("halt")
        halted = page.wait("both are halted", lambda s: not s["moving"])
        assert halted["angle_deg"][0] > -55 and halted["angle_deg"][4] < 55, halted
        page.fall_silent()


def stale():
    with Server() as server:
        page = Page(server).take().keep_beating()
        old = page.state()["sequence"]
        for bad in (0, -1, "7", None, 1.5, True, [7]):
            expect(400, "arg", page.post, "move", pose="init", sequence=bad)
        expect(409, "stale", page.post, "move", pose="init", sequence=10 ** 9)
        page.wait("a second has passed", lambda s: s["sequence"] > old + 45)
        expect(409, "stale", page.post, "move", pose="init", sequence=old)
        same(page.beat(drawn=old), 409, "a page that draws nothing")
        same(page.beat(lease="0" * 32), 409, "a lease that is none")
        page.fall_silent()


def fields():
    """A body is taken whole or refused: no mistake in it means all joints, or a default."""
    with Server() as server:
        page = Page(server).take().keep_beating()
        page.target("torque", joints="all", mode="on")
        page.wait("all hold", lambda s: set(s["torque"]) == {"on"})
        elbow = {"joints": ["R_ELBOW_P"], "mode": "off"}
        for bad in ({"joints": "R_ELBOW_P"}, {"joints": []}, {"joints": None}, {"joints": 16},
                    {"joints": {}}, {"joints": [16]}, {"joints": ["R_ELBOW_P", None]},
                    {"joints": "ALL"}, {"mode": "offf"}, {"mode": 0}, {"mode": None},
                    {"joint": ["R_ELBOW_P"]}, {"Joints": ["R_ELBOW_P"]}, {"on": True}):
            no = expect(400, "arg", page.target, "torque", **{**elbow, **bad})
            assert "expected" in no.error["message"], no.error
        no = expect(400, "arg", page.target, "torque", mode="off")
        same(no.error["message"], "torque: joints is missing; expected a list of names of joints "
                                  "or groups, or \"all\"")
        expect(400, "arg", page.post, "torque", **elbow)  # no sequence
        expect(404, "notfound", page.target, "torque", joints=["R_ELBOW"], mode="off")
        wrong = {
            "move": [{}, {"angle_deg": {}}, {"angle_deg": [0]}, {"angle_deg": {"CHEST_P": "1"}},
                     {"angle_deg": {"CHEST_P": None}}, {"pose": "sit"}, {"pose": None},
                     {"pose": "init", "angle_deg": {"CHEST_P": 1}}, {"pose": "init", "time": 100},
                     {"pose": "init", "time_ms": -1}, {"pose": "init", "time_ms": "100"},
                     {"pose": "init", "time_ms": 163831}],
            "jog": [{}, {"angle_deg": {}}, {"angle_deg": {"CHEST_P": 1}, "pose": "init"}],
            "play": [{}, {"motion": 7}, {"motion": "greet.pseq", "speed_pct": 0},
                     {"motion": "greet.pseq", "speed_pct": 1001},
                     {"motion": "greet.pseq", "speed_pct": 50.5},
                     {"motion": "greet.pseq", "loop": "no"}, {"motion": "greet.pseq", "mirror": 1},
                     {"motion": "greet.pseq", "repeat": 0}, {"motion": "greet.pseq", "speed": 50},
                     {"motion": "greet.pseq", "on_lost": "sit"},
                     {"motion": "greet.pseq", "from_ms": -1}],
            "queue": [{}, {"motion": "greet.pseq", "on_lost": "stop"}],
            "seek": [{}, {"t_ms": -1}, {"t_ms": "0"}, {"t": 0}],
            "speed": [{}, {"speed_pct": 0}, {"speed_pct": 1e9}, {"pct": 50}],
            "resume": [{"motion": "greet.pseq"}], "reset": [{"force": True}],
        }
        for verb, bodies in wrong.items():
            for body in bodies:
                no = expect(400, "arg", page.target, verb, **body)
                assert no.error["message"].startswith(verb), no.error
                assert "expected" in no.error["message"], no.error
        for verb in ("resume", "reset"):
            expect(400, "arg", page.post, verb)
        for verb, body in (("pause", {"sequence": 1}), ("halt", {"now": True}),
                           ("capture", {"joints": []}), ("capture", {"joints": "R_ELBOW_P"}),
                           ("capture", {"joint": ["R_ELBOW_P"]}),
                           ("lease", {"action": "steal"}), ("lease", {}),
                           ("lease", {"action": "take", "name": 7}),
                           ("lease", {"action": "take", "operator": True}),
                           ("preview", {"motion": 7}), ("preview", {}),
                           ("preview", {"motion": "greet.pseq", "rate": 30}),
                           ("preview", {"motion": "greet.pseq", "speed_pct": "50"}),
                           ("ik", {"angle_deg": [0.0] * 20, "handle": "waist", "p_m": [0, 0, 0],
                                   "rot": []})):
            expect(400, "arg", page.post, verb, **body)
        for path in ("/api/state?x=1", "/api/motions?rate=7", "/api/motions/greet.pseq?rate=x",
                     "/api/motions/greet.pseq?rat=50"):
            expect(400, "arg", page.get, path)
        for beat in ({"drawn": 1}, {"lease": page.lease, "drawn": "1"}, {"lease": 7, "drawn": 1},
                     {"lease": page.lease, "drawn": 1, "x": 1}):
            same(page.ask("POST", "/heartbeat", beat, port=server.stop_port)[0], 400, beat)
        state = page.wait("every joint was read", lambda s: None not in s["torque"])
        same((set(state["torque"]), state["limp"], state["moving"]), ({"on"}, [], False))
        page.target("torque", **elbow)
        state = page.wait("the elbow is limp", lambda s: s["torque"][16] == "off")
        same(sum(t == "on" for t in state["torque"]), 19)
        page.target("torque", joints=["all"], mode="off")
        page.wait("all are limp", lambda s: set(s["torque"]) == {"off"})
        page.fall_silent()


def delayed():
    """What was held up on its way acts on no newer situation."""
    with Server() as server:
        page, other = Page(server).take().keep_beating(), Page(server, "Ben")
        page.target("play", motion="greet.pseq", loop=True)
        page.wait_played("playing")
        # Released before a stop was pressed, and it arrives after that.
        before = page.state()["sequence"]
        other.post("stop", name="Ben")
        no = expect(409, "stale", page.post, "reset", sequence=before)
        assert "stop by Ben" in no.error["message"], no.error
        assert no.error["sequence"] > before, no.error
        assert page.state()["stop"]["latched"]
        # Released as it was seen, but somebody pressed again meanwhile.
        seen = page.wait("confirmed", lambda s: s["stop"]["confirmed"])["sequence"]
        other.post("stop", name="Carla")
        no = expect(409, "stale", page.post, "reset", sequence=seen)
        assert "stop by Carla" in no.error["message"], no.error
        assert page.state()["stop"]["latched"]
        page.target("reset")
        assert not page.state()["stop"]["latched"]
        # A move from before the stop does not begin after its release.
        page.fall_silent()
        page.take().keep_beating()
        for verb, body in (("move", {"pose": "init"}), ("play", {"motion": "greet.pseq"}),
                           ("queue", {"motion": "greet.pseq"}), ("seek", {"t_ms": 0}),
                           ("jog", {"angle_deg": {"R_ELBOW_P": -10}}), ("resume", {}),
                           ("speed", {"speed_pct": 400}),
                           ("torque", {"joints": "all", "mode": "off"}),
                           ("torque", {"joints": "all", "mode": "on"})):
            expect(409, "stale", page.post, verb, sequence=seen, **body)
        # A resume from before a halt, or from before the pause.
        page.target("play", motion="greet.pseq", loop=True)
        playing = page.wait_played("playing")["sequence"]
        # One that is based on the pause itself goes on.
        page.post("resume", sequence=page.post("pause")["sequence"])
        page.wait_played("playing")
        done = page.post("pause")
        page.wait_played("paused")
        no = expect(409, "stale", page.post, "resume", sequence=playing)
        assert "paused" in no.error["message"], no.error
        same(page.state()["play"]["state"], "paused")
        assert done["sequence"] > playing
        paused = page.state()["sequence"]
        page.post("halt")
        expect(409, "stale", page.post, "resume", sequence=paused)
        page.wait("it stands", lambda s: not s["moving"])
        # A jog that comes after the halt that ended it; and a move after torque was switched off.
        before = page.state()["sequence"]
        page.post("halt")
        expect(409, "stale", page.post, "jog", sequence=before, angle_deg={"R_ELBOW_P": -10})
        before = page.state()["sequence"]
        page.target("torque", joints=["R_ELBOW_P"], mode="off")
        expect(409, "stale", page.post, "move", sequence=before, angle_deg={"R_ELBOW_P": -10})
        # What the answers name is the situation that they made.
        told = page.post("halt")
        page.post("move", sequence=told["sequence"], angle_deg={"L_ELBOW_P": -10})
        page.fall_silent()


def order():
    """A stop beside a move, a reset or a resume: whichever comes first, the stop stands in the end,
    and what comes behind it is refused."""
    with Server() as server:
        page, other = Page(server).take().keep_beating(), Page(server, "Ben")
        page.target("move", pose="init", time_ms=300)
        page.wait_event("move: done")
        move = {"angle_deg": {"R_ELBOW_P": -60}, "time_ms": 5000}

        def rests():
            state = page.wait("confirmed", lambda s: s["stop"]["confirmed"])
            assert state["stop"]["latched"] and not state["moving"], state
            before = state["angle_deg"][16]
            time.sleep(0.1)  # what was not stopped would go on
            assert abs(page.state()["angle_deg"][16] - before) < 1, "it goes on"
            page.target("reset")
            page.fall_silent()
            page.take().keep_beating()

        # The stop first: a move that is based on the same state is refused.
        based = page.state()["sequence"]
        other.post("stop", name="Ben")
        expect(409, "lease", page.post, "move", sequence=based, **move)
        page.fall_silent()
        page.take().keep_beating()
        expect(409, "latched", page.post, "move", sequence=based, **move)
        rests()
        expect(409, "stale", page.post, "move", sequence=based, **move)
        # The move first.
        page.target("move", **move)
        page.wait("it moves", lambda s: s["moving"])
        other.post("stop", name="Ben")
        rests()
        # At the same moment, each from a connection of its own.
        came = {"done": 0, "refused": 0}
        for n in range(3 * STOPS):
            verb = ("move", "reset", "resume")[n % 3]
            if verb == "reset":
                other.post("stop", name="Carla")
                page.wait("confirmed", lambda s: s["stop"]["confirmed"])
            elif verb == "resume":
                page.target("play", motion="greet.pseq", loop=True)
                page.wait_played("playing")
                page.post("pause")
                page.wait_played("paused")
            based = page.state()["sequence"]
            begin = threading.Barrier(2)

            def press(begin=begin):
                begin.wait()
                other.post("stop", name="Ben")

            thread = threading.Thread(target=press)
            thread.start()
            begin.wait()
            try:
                page.post(verb, sequence=based, **(move if verb == "move" else {}))
                came["done"] += 1
            except Refused as no:
                assert no.status == 409 and no.code in ("stale", "lease", "latched"), no
                came["refused"] += 1
            thread.join()
            assert page.state()["stop"]["latched"], verb
            rests()
        same(came["done"] + came["refused"], 3 * STOPS)
        page.fall_silent()


def unreadable():
    """A stop is carried out whatever its body is, also where it never comes."""
    broken = [b"{", b"[]", b"nothing", b'{"name": 7}', b'{"a": 1, "a": 2}', b'{"unknown": 1}',
              b"\xff\xfe", b"\x00", b'"' + b"x" * 100 + b'"']
    with Server() as server:
        page = Page(server)

        def stopped(what):
            state = page.wait(f"stopped: {what}", lambda s: s["stop"]["latched"])
            page.wait("confirmed", lambda s: s["stop"]["confirmed"])
            page.target("reset")
            assert not page.state()["stop"]["latched"]
            return state

        def head(port, path, *lines):
            return "\r\n".join([f"POST {path} HTTP/1.1", f"Host: 127.0.0.1:{port}", *lines, "",
                                ""]).encode()

        for port, path in ((server.port, "/api/stop"), (server.stop_port, "/stop")):
            for body in broken:
                status = page.ask("POST", path, body, {"Content-Type": "application/json"}, port)[0]
                assert status in (200, 204), f"{path} {body[:20]}: {status}"
                stopped(f"{path} {body[:20]}")
            for kind in ("application/x-www-form-urlencoded", "multipart/form-data; boundary=x",
                         "application/octet-stream", "application/jsonx", "\tnonsense"):
                assert page.ask("POST", path, b"{}", {"Content-Type": kind}, port)[0] < 300, kind
                stopped(f"{path} {kind}")
            raw(port, head(port, path + "?why=because", "Connection: close"))
            stopped("with a query, without a length")
            for lines in (("Content-Length: 65537",), ("Content-Length: 100000000",),
                          ("Content-Length: none",), ("Content-Length: -1",),
                          ("Content-Length: 10", "Content-Length: 20"),
                          ("Transfer-Encoding: chunked",), ("Transfer-Encoding: gzip",),
                          ("Content-Length: 50",)):
                with socket.create_connection(("127.0.0.1", port), PATIENCE_S) as s:
                    s.sendall(head(port, path, *lines) + b"{")  # and the rest never comes
                    stopped(f"{path} {lines}")
            with socket.create_connection(("127.0.0.1", port), PATIENCE_S) as s:
                for byte in head(port, path, "Content-Length: 9", "X: " + "y" * 99) + b"{":
                    s.sendall(bytes([byte]))
                stopped(f"{path}, byte by byte")
            large = b'{"name": "' + b"x" * 100000
            page.ask("POST", path, large[:70000 if port == server.port else 60000], {}, port)
            stopped("a large body that is no JSON")
        # What comes from another page, or is no stop, is none however early it is looked at.
        for lines in (("Origin: http://evil.example",), ("Sec-Fetch-Site: cross-site",),
                      ("Host: evil.example",)):
            with socket.create_connection(("127.0.0.1", server.port), PATIENCE_S) as s:
                s.sendall(head(server.port, "/api/stop", *lines, "Content-Length: 9"))
                s.sendall(b"{")
                time.sleep(0.1)
        for text in (b"GET /api/stop HTTP/1.1", b"POST /api/stopx HTTP/1.1",
                     b"POST /stop HTTP/1.1", b"POST http://evil.example/api/stop HTTP/1.1"):
            raw(server.port, text + f"\r\nHost: 127.0.0.1:{server.port}\r\nConnection: close"
                                    "\r\n\r\n".encode())
        assert not page.state()["stop"]["latched"], "one of these stopped the robot"
        # Who stops is told as soon as it is known, and once.
        with socket.create_connection(("127.0.0.1", server.stop_port), PATIENCE_S) as s:
            s.sendall(head(server.stop_port, "/stop", "Content-Length: 16"))
            page.wait("stopped", lambda s: s["stop"]["latched"])
            s.sendall(b'{"name": "Anna"}')
            s.recv(4096)
            page.wait("its name", lambda s: s["stop"]["by"] in ("Anna", "a request that is not whole"))
        page.target("reset")
        page.post("stop", name="Ben")
        same(page.state()["stop"]["by"], "Ben")


def free_port():
    """Two ports in a row that nobody has."""
    while True:
        with socket.socket() as one, socket.socket() as two:
            one.bind(("127.0.0.1", 0))
            port = one.getsockname()[1]
            try:
                two.bind(("127.0.0.1", port + 1))
                return port
            except (OSError, OverflowError):
                pass


def first_of_all():
    """Both ports are open, and a stop is answered, before there is a robot; it holds when it comes."""
    for path, answered in (("/stop", 204), ("/api/estop", 200)):
        port, token = free_port(), "0123456789abcdef"
        with tempfile.TemporaryDirectory() as folder:
            link = os.path.join(folder, "robot")
            with socket.create_server(("127.0.0.1", 0)) as nobody:  # takes a line, and says nothing
                device = f"tcp:127.0.0.1:{nobody.getsockname()[1]}"
                server = subprocess.Popen([GRCTL, "-d", device, "serve", "--port", str(port)],
                                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                          env={**os.environ, "GRCTL_TOKEN": token})
                until = time.monotonic() + PATIENCE_S
                at = port + 1 if path == "/stop" else port
                while True:
                    try:
                        got = raw(at, f"POST {path} HTTP/1.1\r\nHost: 127.0.0.1:{at}\r\n"
                                      "Content-Length: 2\r\nConnection: close\r\n\r\n{}".encode())
                        break
                    except ConnectionRefusedError:
                        assert server.poll() is None and time.monotonic() < until, "no port"
                        time.sleep(0.01)
                same(int(got.split()[1]), answered, path)
                other = raw(port, f"GET /api/state HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n"
                                  "Connection: close\r\n\r\n".encode())
                same(int(other.split()[1]), 503, "there is no robot yet")
                assert server.poll() is None
                server.terminate()
                server.communicate()
        # And one that is there a moment later.
        with tempfile.TemporaryDirectory() as folder:
            link = os.path.join(folder, "robot")
            sim = subprocess.Popen([GRCTL, "sim", "--link", link], stdout=subprocess.DEVNULL)
            while not os.path.exists(link):
                time.sleep(0.01)
            os.kill(sim.pid, signal.SIGSTOP)  # it does not answer yet
            server = Server(device=link, env={"GRCTL_TOKEN": token})
            server.words[server.words.index("--port") + 1] = str(port)
            pressed = threading.Event()

            def press(port=port, path=path, pressed=pressed, sim=sim):
                at = port + 1 if path == "/stop" else port
                while not pressed.is_set():
                    try:
                        raw(at, f"POST {path} HTTP/1.1\r\nHost: 127.0.0.1:{at}\r\n"
                                "Content-Length: 2\r\nConnection: close\r\n\r\n{}".encode())
                        pressed.set()
                    except ConnectionRefusedError:
                        time.sleep(0.01)
                os.kill(sim.pid, signal.SIGCONT)

            thread = threading.Thread(target=press)
            thread.start()
            with server:
                assert pressed.is_set()
                page = Page(server)
                state = page.wait("confirmed", lambda s: s["stop"]["confirmed"])
                same(state["stop"]["kind"], "stop" if path == "/stop" else "estop")
                page.take()
                expect(409, "latched", page.target, "move", pose="init")
                page.target("reset")
            thread.join()
            sim.terminate()
            sim.wait()


def stopping():
    """A stop latches, is confirmed joint by joint, takes the lease, and is taken back."""
    with Server() as server:
        page, other = Page(server).take().keep_beating(), Page(server, "other")
        page.target("move", pose="init", time_ms=300)
        page.wait_event("move: done")
        page.target("play", motion="greet.pseq", loop=True)
        page.wait_played("playing")
        other.post("stop", name="other")
        state = other.wait("confirmed", lambda s: s["stop"]["confirmed"])
        same((state["stop"]["kind"], state["stop"]["by"]), ("stop", "other"))
        same(set(state["stop"]["joints"]), {"stopped"})
        same(set(state["torque"]), {"on"}, "it holds")
        same(state["lease"]["holder"], None)
        where = state["angle_deg"]
        expect(409, "lease", page.target, "play", motion="greet.pseq")
        page.fall_silent()
        page.take().keep_beating()
        for verb, body in (("play", {"motion": "greet.pseq"}), ("move", {"pose": "init"}),
                           ("jog", {"angle_deg": {"R_ELBOW_P": -10}}),
                           ("torque", {"joints": ["all"], "mode": "on"})):
            expect(409, "latched", page.target, verb, **body)
        other.post("stop", name="again")
        same(other.state()["stop"]["by"], "other", "it is one stop")
        page.fall_silent()
        other.target("reset")
        state = other.state()
        assert not state["stop"]["latched"] and not state["moving"], state["stop"]
        assert max(abs(a - b) for a, b in zip(where, state["angle_deg"])) < 1, "it moved by itself"
        page.take().keep_beating()
        page.target("move", angle_deg={"R_ELBOW_P": -20}, time_ms=300)
        page.wait_event("move: done")
        page.post("estop")
        state = page.wait("torque is gone", lambda s: "on" not in s["torque"])
        same(state["stop"]["kind"], "estop")
        page.wait("confirmed", lambda s: s["stop"]["confirmed"])
        page.fall_silent()


def tripped():
    """A stop of the engine for safety: each joint is read until it stands, as after one of a page."""
    words = [GRCTL, "sim"]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as robot:
        device = robot.stdout.readline().strip()
        with Server(device=device) as server:
            page = Page(server).take().keep_beating()
            page.target("move", pose="init", time_ms=300)
            page.wait_event("move: done")
            page.target("move", angle_deg={"R_ELBOW_P": -120}, time_ms=20000)
            page.wait("it moves", lambda s: s["angle_deg"][16] < -5)
            robot.stdin.write("temperature 12 68\n")
            robot.stdin.flush()
            state = page.wait("a stop for safety", lambda s: s["stop"]["kind"] == "trip")
            same(len(state["stop"]["joints"]), len(state["angle_deg"]))
            state = page.wait("confirmed", lambda s: s["stop"]["confirmed"])
            same(state["stop"]["kind"], "trip")
            same(set(state["stop"]["joints"]), {"stopped"})
            where = state["angle_deg"][16]
            time.sleep(0.3)  # what was not stopped would go on
            assert abs(page.state()["angle_deg"][16] - where) < 1, "it goes on"
            page.fall_silent()
        robot.terminate()


def on_the_way():
    """A stop in the middle of a slow move of one frame, of a jog and of an approach: each joint stays
    where it was. The line is busy with readings nearly always, so the frame that stops has to wait."""
    with Server() as server:
        page, ways = Page(server).take(), ("move", "jog", "play")
        page.keep_beating()
        page.target("move", pose="init", time_ms=300)
        page.wait_event("move: done")
        for n in range(3 * STOPS // 2):
            way = ways[n % 3]
            page.take()
            page.target("move", angle_deg={"R_SHOULDER_P": -20}, time_ms=300)
            page.wait("there", lambda s: abs(s["angle_deg"][14] + 20) < 1.5 and not s["moving"])
            if way == "play":
                page.target("play", motion="greet.pseq", speed_pct=20)
            else:
                page.target(way, angle_deg={"R_SHOULDER_P": -140}, time_ms=4000)
            state = page.wait("it moves", lambda s: abs(s["angle_deg"][14] + 20) > 2)
            where = state["angle_deg"][14]
            same(page.ask("POST", "/stop", b"{}", {}, server.stop_port)[0], 204)
            state = page.wait("confirmed", lambda s: s["stop"]["confirmed"])
            time.sleep(0.3)  # what was not stopped would go on
            last = page.state()["angle_deg"][14]
            assert abs(last - where) < 30, f"{way}: from {where} to {last} after a stop"
            page.target("reset")
        page.fall_silent()


def lines_of(trace):
    """When each write to the robot left and what it was, by a trace (pcapng)."""
    with open(trace, "rb") as f:
        data = f.read()
    at = 0
    while at + 12 <= len(data):
        kind, size = struct.unpack_from("<II", data, at)
        if kind == 6 and at + size <= len(data):
            _, high, low, n, _ = struct.unpack_from("<IIIII", data, at + 8)
            option = at + 28 + (n + 3) // 4 * 4
            if struct.unpack_from("<H", data, option)[0] == 2 and data[option + 4] & 3 == 2:
                yield (high << 32 | low) / 1e6, data[at + 28:at + 28 + n]
        at += max(size, 12)


def latency():
    """From a stop to the last servo, beside streams that do not read: the write that tells all servos
    to stand is the last one of a goal until something else is asked for."""
    trace = tempfile.mktemp()
    server = Server()
    server.words[1:1] = ["--trace", trace]
    stops, answers, floor = [], [], []
    with server:
        page = Page(server).take().keep_beating()
        deaf = [Stream(server, buffer_bytes=4096) for _ in range(8)]
        for n in range(2 * STOPS):
            page.take()
            page.target("play", motion="greet.pseq", loop=True)
            page.wait("it moves", lambda s: s["play"]["state"] == "playing" and s["play"]["t_ms"] > 20)
            time.sleep(random.uniform(0, 0.3))
            if n % 10 == 0:
                deaf.append(Stream(server, buffer_bytes=4096))
            began = time.monotonic()
            page.state()
            floor.append((time.monotonic() - began) * 1e3)
            wall, began = time.time(), time.monotonic()
            same(page.ask("POST", "/stop", b"{}", {}, server.stop_port)[0], 204)
            answers.append((time.monotonic() - began) * 1e3)
            state = page.wait("confirmed", lambda s: s["stop"]["confirmed"])
            assert not state["moving"]
            stops.append((wall, time.time()))
            page.target("reset")
        for s in deaf:
            s.close()
        page.fall_silent()
    goals = [(at, line) for at, line in lines_of(trace) if line[:1] == b"S"]
    os.unlink(trace)
    times = []
    for wall, confirmed in stops:
        told = [at + len(line) * 10 / 115200 for at, line in goals if wall - 0.0005 < at < confirmed]
        assert told, "a stop without a frame"
        times.append((told[-1] - wall) * 1e3)

    def words(values):
        values = sorted(values)
        return f"median {values[len(values) // 2]:.1f}, p99 {values[len(values) * 99 // 100]:.1f} ms"

    print(f"# {len(stops)} stops, request to the last servo's last byte: {words(times)}; "
          f"to the answer: {words(answers)}; floor, a state: {words(floor)}")


def twenty():
    """What 20 clients cost: the server's time of a core beside its own without them."""
    def used(server):
        with open(f"/proc/{server.process.pid}/stat", encoding="ascii") as f:
            fields = f.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def share(server, streams, seconds=10):
        over = time.monotonic() + seconds
        before, n = used(server), [0] * len(streams)

        def read(i):
            while time.monotonic() < over:
                n[i] += streams[i].next()[0] == "state"

        for error in beside(*((read, i) for i in range(len(streams)))):
            if error:
                raise error
        time.sleep(max(0, over - time.monotonic()))
        return 100 * (used(server) - before) / seconds, min(n, default=0)

    with Server() as server:
        page = Page(server).take().keep_beating()
        page.target("play", motion="greet.pseq", loop=True)
        page.wait_played("playing")
        alone, _ = share(server, [])
        streams = [Stream(server) for _ in range(20)]
        loaded, least = share(server, streams)
        print(f"# while it plays: {alone:.1f} % of a core alone, {loaded:.1f} % with 20 pages, "
              f"each of which got {least} states in 10 s or more")
        assert least > 200, "states are missing"
        for s in streams:
            s.close()
        page.fall_silent()


# ---- a page that is lost -----------------------------------------------------------------------

def lost_in_jog():
    with Server() as server:
        page, other = Page(server).take(), Page(server)
        page.target("move", pose="init", time_ms=300)
        page.keep_beating()
        page.wait_event("move: done")
        for angle in range(-20, -60, -2):
            page.target("jog", angle_deg={"R_ELBOW_P": angle}, time_ms=3000)
        page.fall_silent()
        last_ms = page.state()["time_ms"]
        took = other.wait_event("jogging stops")["time_ms"] - last_ms
        assert 500 < took < 3000, f"{took} ms"
        state = other.wait("it stands", lambda s: not s["moving"])
        assert -57 < state["angle_deg"][16] < -1, f"not on its way: {state['angle_deg'][16]}"
        same(set(state["torque"]), {"on"}, "it holds")
        other.wait_event("page that drove is gone")
        same(other.state()["lease"]["holder"], None)


def given_back():
    """A lease that is given back while something moves, and that nobody takes: as if lost."""
    with Server() as server:
        page, other = Page(server).take(), Page(server)
        page.target("play", motion="greet.pseq", loop=True)
        page.wait_played("playing")
        page.post("lease", action="give")
        given_ms = page.state()["time_ms"]
        took = other.wait_event("page that drives is lost: the motion stops")["time_ms"] - given_ms
        assert 2500 < took < 6000, f"{took} ms"
        other.wait("it stands", lambda s: not s["moving"] and s["play"]["state"] == "idle")
        same(set(other.state()["torque"]), {"on"}, "it holds")
        page.lease = None
        page.take().keep_beating()
        page.target("play", motion="greet.pseq", repeat=3)
        page.wait_played("playing")
        page.post("lease", action="give")
        page.fall_silent()
        other.take().keep_beating()
        other.wait("whoever takes it in time drives on",
                   lambda s: s["time_ms"] > given_ms and s["play"]["t_ms"] > 4000)
        same(other.state()["play"]["state"], "playing")
        other.post("halt")
        other.wait_played("idle", "finished")
        other.target("play", motion="greet.pseq", on_lost="finish")
        other.wait_played("playing")
        other.post("lease", action="give")
        other.fall_silent()
        other.wait_event("lost: the motion goes on")
        other.wait_played("finished")


def lost_with(on_lost, message, end, **how):
    with Server() as server:
        page, other = Page(server).take(), Page(server)
        how.update({"on_lost": on_lost} if on_lost else {})
        page.target("play", motion="greet.pseq", repeat=2, **how)
        last_ms = page.state()["time_ms"]
        took = other.wait_event(message)["time_ms"] - last_ms
        assert 2500 < took < 6000, f"{on_lost}: {took} ms"
        state = other.wait_played(end)
        same(state["lease"]["holder"], None)
        if end == "idle":
            other.wait("it stands", lambda s: not s["moving"] and s["job"] is None)
        same(set(other.state()["torque"]), {"on"}, on_lost)


def lost_in_a_loop():
    lost_with("finish", "a loop has no end, the motion stops", "idle", loop=True)


def lost_in_motion():
    """Stop softly by default, finish, or the exit policy."""
    for each in beside((lost_with, None, "the motion stops", "idle"),
                       (lost_with, "stop", "the motion stops", "idle"),
                       (lost_with, "finish", "the motion goes on", "finished"),
                       (lost_in_a_loop,),
                       (lost_with, "exit", "exit policy", "idle")):
        if each:
            raise each


def killed():
    """The process of the page that drives is killed: as silence."""
    with Server() as server:
        other = Page(server)
        child = os.fork()
        if child == 0:
            page = Page(server, "doomed").take()
            page.target("play", motion="greet.pseq", loop=True)
            while True:
                page.beat()
                time.sleep(0.2)
        other.wait_played("playing")
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        other.wait_event("page that drives is lost: the motion stops")
        other.wait_played("idle")
        same(other.state()["lease"]["holder"], None)


def takeover():
    with Server() as server:
        anna, ben = Page(server, "Anna").take().keep_beating(), Page(server, "Ben")
        no = expect(409, "lease", ben.post, "lease", action="take", name="Ben")
        same(no.error["holder"]["name"], "Anna")
        asked = ben.post("lease", action="ask", name="Ben")
        same(asked["held"], False)
        same(anna.state()["lease"]["asked"]["name"], "Ben")
        ben.lease = asked["lease"]
        expect(409, "lease", ben.post, "lease", action="take", name="Ben")
        expect(409, "lease", ben.post, "pause")
        anna.post("lease", action="deny")
        same(anna.state()["lease"]["asked"], None)
        ben.lease = ben.post("lease", action="ask", name="Ben")["lease"]
        anna.fall_silent()
        anna.beat()
        anna.post("lease", action="give")
        same(anna.state()["lease"]["holder"]["name"], "Ben")
        expect(409, "lease", anna.post, "pause")
        expect(409, "state", ben.post, "pause")
        ben.post("lease", action="give")
        same(anna.state()["lease"]["holder"], None)
        anna.take().keep_beating()
        ben.lease = ben.post("lease", action="ask", name="Ben")["lease"]
        began = time.monotonic()
        while True:  # nobody answers
            try:
                ben.post("lease", action="take", name="Ben")
                break
            except Refused as refused:
                same(refused.code, "lease")
            time.sleep(0.2)
        assert time.monotonic() - began > 9, "it was not asked for 10 s"
        same(anna.state()["lease"]["holder"]["name"], "Ben")
        anna.fall_silent()
    with Server("--operator") as server:
        Page(server, "Anna").take()
        Page(server, "Ben").take()
        same(Page(server).state()["lease"]["holder"]["name"], "Ben")


def left():
    """The server is asked to end while something moves: the exit policy, as from any command."""
    with Server() as server:
        page = Page(server).take()
        page.target("play", motion="greet.pseq", loop=True)
        page.wait_played("playing")
    same(server.status, 128 + signal.SIGTERM)
    assert "the servos hold where they are" in server.said, server.said


# ---- motions -----------------------------------------------------------------------------------

def motions():
    folder = tempfile.mkdtemp()
    for name in ("greet.pseq", "greet.m", "step.pseq"):
        shutil.copy(os.path.join("motions", name), folder)
    with open(os.path.join(folder, "bad.pseq"), "w", encoding="ascii") as bad:
        bad.write("components: [\n")
    with open(os.path.join(folder, "notes.txt"), "w", encoding="ascii") as notes:
        notes.write("none\n")
    with Server(motions=folder) as server:
        page = Page(server)

        def listed():
            return {m["name"]: m for m in page.get("/api/motions")["motions"]}

        same(sorted(listed()), ["bad.pseq", "greet.m", "greet.pseq", "step.pseq"])
        until = time.monotonic() + PATIENCE_S
        while any(m["state"] == "pending" for m in listed().values()):
            assert time.monotonic() < until
            time.sleep(0.05)
        all_of = listed()
        same(all_of["bad.pseq"]["state"], "unreadable")
        assert all_of["bad.pseq"]["check"]["message"]
        greet = all_of["greet.pseq"]
        same((greet["kind"], greet["length_ms"], greet["keys"], greet["check"]["ok"]),
             ("keys", 5000.0, 10, True))
        same(len(greet["thumbnail"]["angle_deg"]), 5)
        whole = page.get("/api/motions/greet.pseq?rate=10")
        same((len(whole["frames"]["angle_deg"]), whole["etag"]), (51, greet["etag"]))
        # What a preview says of a motion at ten times its speed, and of one nobody has saved.
        fast = page.post("preview", motion="greet.pseq", speed_pct=1000)
        same(fast["length_ms"], 5000.0)
        edit = {"keys": [{"from": 0}, {"from": 1, "angle_deg": {"R_ELBOW_P": -170}}]}
        for bad in ({}, {"motion": 7}, {"motion": "greet.pseq", "rate_hz": 0},
                    {"motion": "greet.pseq", "speed_pct": 2000}):
            expect(400, "arg", page.post, "preview", **bad)
        # A draft may be as large as what is saved.
        long = {"keys": [{"time_ms": 20 * i, "angle_deg": {"CHEST_P": -1 - i % 2 / 1e9, "NECK_Y": i / 1e9}}
                         for i in range(2000)]}
        assert 100e3 < len(json.dumps(long)) < 1e6
        same(page.post("preview", edit=long)["length_ms"], 39980.0)
        beyond = page.post("preview", motion="greet.pseq", edit=edit)
        same((beyond["check"]["ok"], beyond["check"]["refused"]["code"]), (False, "limit"))

        def put(name, body, **headers):
            named = {k.replace("_", "-"): v for k, v in headers.items()}
            return page.call("PUT", "/api/motions/" + name, body, named)

        with open("motions/greet.pseq", "rb") as f:
            before = f.read()
        same(put("greet.pseq", {"keys": [{"from": i} for i in range(10)]},
                 If_Match=greet["etag"])["etag"], greet["etag"], "nothing was touched")
        edit = {"keys": [{"from": i} for i in range(10)]}
        edit["keys"][4]["angle_deg"] = {"R_ELBOW_P": -51.5}
        saved = put("greet.pseq", edit, If_Match=greet["etag"])
        with open(os.path.join(folder, "greet.pseq"), "rb") as f:
            after = f.read()
        differ = [(a, b) for a, b in zip(before.split(b"\n"), after.split(b"\n")) if a != b]
        same(len(differ), 1, f"lines that differ: {differ}")
        expect(409, "changed", put, "greet.pseq", edit, If_Match=greet["etag"])
        expect(428, "changed", put, "greet.pseq", edit)
        expect(409, "changed", put, "greet.pseq", edit | {"keys": [{"time_ms": 0}]},
               If_None_Match="*")
        keys = page.get("/api/motions/greet.pseq")["keys"]
        same((len(keys), keys[4]["angle_deg"][16]), (10, -51.5))
        copies = {"keys": [{"from": 0}, {"from": 0, "time_ms": 250}, {"from": 2, "time_ms": 700}]}
        put("greet.pseq", copies, If_Match=saved["etag"])
        same([k["time_ms"] for k in page.get("/api/motions/greet.pseq")["keys"]], [0, 250, 700])
        # Legs, ZMP and kept keys go along with `from`.
        step = page.get("/api/motions/step.pseq")
        put("step.pseq", {"keys": [{"from": i} for i in range(len(step["keys"]))]},
            If_Match=step["etag"])
        same(page.get("/api/motions/step.pseq")["keys"], step["keys"])
        new = put("new.pseq", {"keys": [{"time_ms": 0, "angle_deg": {"CHEST_P": 5}},
                                        {"time_ms": 400.5, "angle_deg": {"CHEST_P": 0},
                                         "name": "end"}]}, If_None_Match="*")
        same((new["keys"], new["length_ms"]), (2, 400.5))
        for bad in ({}, {"keys": []}, {"keys": [{"from": 99}]}, {"keys": [{}]}, {"keys": [7]},
                    {"keys": [{"from": 1}, {"from": 0}]},
                    {"keys": [{"time_ms": 0, "angle_deg": {"NOBODY": 1}}]},
                    {"keys": [{"time_ms": 0, "angle_deg": {"CHEST_P": "x"}}]}):
            try:
                put("new.pseq", bad, If_Match=new["etag"])
                raise AssertionError(f"taken: {bad}")
            except Refused as no:
                same(no.status, 422, str(no))
        status, headers, bytes_ = page.ask("GET", "/api/motions/new.pseq/file")
        same((status, headers["ETag"]), (200, new["etag"]))
        octets = {"Content-Type": "application/octet-stream", "If-None-Match": "*"}
        same(page.ask("PUT", "/api/motions/copy.pseq/file", bytes_, octets)[0], 200)
        with open(os.path.join(folder, "copy.pseq"), "rb") as f:
            same(f.read(), bytes_)
        same(page.ask("PUT", "/api/motions/junk.pseq/file", b"junk: [", octets)[0], 422)
        assert not os.path.exists(os.path.join(folder, "junk.pseq"))
        os.unlink(os.path.join(folder, "copy.pseq"))
        assert "copy.pseq" not in listed()
    shutil.rmtree(folder)


def making():
    """What a person does who draws a motion: a copy elsewhere, poses mirrored, feet moved."""
    folder = tempfile.mkdtemp()
    for name in ("greet.pseq", "step.pseq", "greet.m", "greet.yaml"):
        shutil.copy(os.path.join("motions", name), folder)
    with open("motions/step.pseq", encoding="ascii") as f:
        step_text = f.read().replace("isTouching: true", "isTouching: true\n          myKey: 7", 1)
    with open(os.path.join(folder, "kept.pseq"), "w", encoding="ascii") as f:
        f.write(step_text)
    outside = os.path.join(tempfile.mkdtemp(), "outside.pseq")
    shutil.copy("motions/bow.pseq", outside)
    os.symlink(outside, os.path.join(folder, "link.pseq"))

    def content(name):
        with open(os.path.join(folder, name), "rb") as f:
            return f.read()

    with Server(motions=folder) as server:
        page = Page(server)

        def put(name, body, **headers):
            named = {k.replace("_", "-"): v for k, v in headers.items()}
            return page.call("PUT", "/api/motions/" + name, body, named)

        def every(n):
            return [{"from": i} for i in range(n)]

        greet = page.get("/api/motions/greet.pseq")
        base = {"motion": "greet.pseq", "etag": greet["etag"]}
        # A copy of all keys is the file, to the bit; with one angle changed one line differs.
        copy = put("copy.pseq", {"base": base, "keys": every(10)}, If_None_Match="*")
        same((content("copy.pseq"), copy["notes"]), (content("greet.pseq"), []))
        edit = {"base": base, "keys": every(10)}
        edit["keys"][4]["angle_deg"] = {"R_ELBOW_P": -51.5}
        put("copy.pseq", edit, If_Match=copy["etag"])
        same(sum(a != b for a, b in zip(content("copy.pseq").split(b"\n"),
                                        content("greet.pseq").split(b"\n"))), 1)
        # Nothing is made of a file that has changed meanwhile, or that is none of the list.
        old = {"motion": "greet.pseq", "etag": '"0000000000000000"'}
        expect(409, "changed", put, "b.pseq", {"base": old, "keys": every(1)}, If_None_Match="*")
        expect(409, "changed", page.post, "preview", motion="greet.pseq", etag=old["etag"],
               edit={"keys": every(1)})
        for name in ("link.pseq", "../greet.pseq", "nothing.pseq"):
            expect(404, "noent", put, "b.pseq", {"base": {"motion": name}, "keys": every(1)},
                   If_None_Match="*")
        for bad in ({}, {"motion": 7}, 7, "greet.pseq"):
            expect(400, "arg", put, "b.pseq", {"base": bad, "keys": every(1)}, If_None_Match="*")
        assert not os.path.exists(os.path.join(folder, "b.pseq"))
        # A new file in the place of a link that leads out of the folder does not follow it.
        expect(409, "changed", put, "link.pseq", {"base": base, "keys": every(10)},
               If_None_Match="*")
        with open(outside, "rb") as f, open("motions/bow.pseq", "rb") as g:
            same(f.read(), g.read(), "a file outside the folder was written")

        # In the mirror: angles, targets of feet; what else is given counts after it.
        joints = page.get("/api/robot")["joints"]
        step = page.get("/api/motions/step.pseq")
        keys = every(len(step["keys"]))
        keys[2]["mirror"] = True
        keys[2]["angle_deg"] = {"CHEST_P": 3}
        put("mirrored.pseq", {"base": {"motion": "step.pseq"}, "keys": keys}, If_None_Match="*")
        made = page.get("/api/motions/mirrored.pseq")["keys"]
        same([k for i, k in enumerate(made) if i != 2],
             [k for i, k in enumerate(step["keys"]) if i != 2])
        for j in joints:
            was = step["keys"][2]["angle_deg"][j["mirror"]]
            wanted = 3 if j["name"] == "CHEST_P" else was and was * j["mirror_sign"]
            same(made[2]["angle_deg"][j["joint"]], wanted, j["name"])
        same(made[2]["links"][0]["p_m"], [0, -0.033, 0.15])
        expect(422, "arg", put, "c.pseq", {"keys": [{"time_ms": 0, "mirror": True}]},
               If_None_Match="*")

        # A target that is moved keeps its flags and keys of other programs; others stay.
        kept = page.get("/api/motions/kept.pseq")
        keys = every(len(kept["keys"]))
        keys[0]["links"] = [{"link": "WAIST"}, {"link": "R_ANKLE_R", "p_m": [0.03, -0.02, 0.02115]},
                            {"link": "L_ANKLE_R"}]
        put("kept.pseq", {"keys": keys}, If_Match=kept["etag"])
        differ = [(a, b) for a, b in zip(step_text.encode().split(b"\n"),
                                         content("kept.pseq").split(b"\n")) if a != b]
        same([b.strip() for _, b in differ], [b"translation: [ 0.03, -0.02, 0.02115 ]"])

        # Other formats: what they have no place for is told, and legs become angles.
        m = put("copy.m", {"base": base, "keys": every(10)}, If_None_Match="*")
        same((m["kind"], m["keys"], content("copy.m")), ("postures", 10, content("greet.m")))
        same(page.get("/api/motions/copy.m")["keys"][4]["time_ms"], 1850)
        yaml = put("copy.yaml", {"base": base, "keys": every(10)}, If_None_Match="*")
        same((yaml["kind"], yaml["length_ms"], content("copy.yaml")),
             ("frames", 5000.0, content("greet.yaml")))
        legs = put("legs.yaml", {"base": {"motion": "step.pseq"}, "keys": every(len(step["keys"]))},
                   If_None_Match="*")
        same((legs["kind"], legs["check"]["ok"]), ("frames", True))
        new = put("new.yaml", {"keys": [{"time_ms": 0, "angle_deg": {"CHEST_P": 5}},
                                        {"time_ms": 400, "angle_deg": {"CHEST_P": 0}}]},
                  If_None_Match="*")
        same((new["kind"], new["length_ms"]), ("frames", 400.0))
        for late_ms in (1.44e7, 1.9e8, 1e11): # 4 hours, 2 days, 3 years, in frames
            expect(413, "cap", put, "long.yaml", {"keys": [
                {"time_ms": 0, "angle_deg": {j["name"]: 5 for j in joints}},
                {"time_ms": late_ms, "angle_deg": {j["name"]: 0 for j in joints}}]},
                   If_None_Match="*")
        frames(page, put, content)
    shutil.rmtree(folder)
    shutil.rmtree(os.path.dirname(outside))


def frames(page, put, content):
    """Frames are moved around the keys that name a joint; the others stay to the last digit."""
    file = page.get("/api/motions/copy.yaml")
    same((file["kind"], file["keys"]), ("frames", []))
    was = content("copy.yaml").split(b"\n")
    keys = [{"time_ms": 1000}, {"time_ms": 1200, "angle_deg": {"CHEST_P": -10}}, {"time_ms": 1600}]
    look = page.post("preview", motion="copy.yaml", edit={"keys": keys}, rate_hz=50)
    told = put("copy.yaml", {"keys": keys}, If_Match=file["etag"])
    same((told["kind"], told["length_ms"]), ("frames", 5000.0))
    chest = [j["name"] for j in page.get("/api/robot")["joints"]].index("CHEST_P")
    saved = page.get("/api/motions/copy.yaml?rate=50")["frames"]["angle_deg"]
    same(look["frames"]["angle_deg"], saved)
    moved = [row[chest] for row in saved]
    same([round(moved[n], 1) for n in (50, 55, 60, 70, 80)], [0.0, -5.0, -10.0, -5.0, 0.0])
    lines = [(a, b) for a, b in zip(was, content("copy.yaml").split(b"\n")) if a != b]
    same(len(lines), 29) # those of 1.02 to 1.58 s
    for a, b in lines:
        same(sum(x != y for x, y in zip(a.split(b","), b.split(b","))), 1, "one joint of each")
    base = {"base": {"motion": "copy.yaml"}}
    for code, bad in (("arg", [{"time_ms": 5100}]), ("arg", [{"from": 0}]),
                      ("arg", [{"time_ms": 50}, {"time_ms": 40}]),
                      ("notfound", [{"time_ms": 0, "angle_deg": {"NOSE": 1}}]),
                      ("arg", [{"time_ms": 0, "angle_deg": {"CHEST_P": "x"}}]),
                      ("unsupported", [{"time_ms": 0, "links": []}])):
        expect(422, code, put, "d.yaml", {**base, "keys": bad}, If_None_Match="*")


def falls():
    """A motion that would fall says when; the robot is not asked."""
    folder = tempfile.mkdtemp()
    shutil.copy("motions/bow.pseq", folder)
    with Server(motions=folder) as server:
        page = Page(server)
        bow = page.get("/api/motions/bow.pseq")
        edit = {"keys": [{"from": i} for i in range(len(bow["keys"]))]}
        for key in edit["keys"][1:]:
            key["angle_deg"] = {"R_ANKLE_P": -60, "L_ANKLE_P": 60}
        told = page.post("preview", motion="bow.pseq", edit=edit)
        falls_ms = told["check"]["falls_ms"]
        assert falls_ms is not None and 0 <= falls_ms <= told["length_ms"], told["check"]
        assert "would fall at" in told["check"]["message"]
        worst = min(m for m in told["balance"]["margin_mm"] if m is not None)
        assert worst < 0, worst
        same(page.get("/api/motions/bow.pseq")["check"]["falls_ms"], None)
    shutil.rmtree(folder)


def ik():
    with Server() as server:
        page = Page(server)
        state = page.wait("all was read", lambda s: None not in s["angle_deg"])
        same(state["body"]["margin_m"] > 0, True)
        root = state["body"]["root"]
        lower = [root["p_m"][0], root["p_m"][1], root["p_m"][2] - 0.01]
        pose = page.post("ik", angle_deg=state["angle_deg"], handle="waist", p_m=lower)
        assert pose["reached"], pose
        same(pose["root"]["p_m"], [round(v, 5) for v in lower])
        again = page.post("ik", angle_deg=pose["angle_deg"], root=pose["root"], handle="waist",
                          p_m=root["p_m"])
        worst = max(abs(a - b) for a, b in zip(again["angle_deg"], state["angle_deg"]))
        assert worst < 0.2, f"there and back: {worst} degrees"
        foot = pose["feet"][0]["p_m"]
        lifted = page.post("ik", angle_deg=state["angle_deg"], handle="right_foot",
                           p_m=[foot[0], foot[1], foot[2] + 0.02])
        assert lifted["reached"]
        same([s["standing"] for s in lifted["body"]["soles"]], [False, True])
        far = page.post("ik", angle_deg=state["angle_deg"], handle="waist", p_m=[0, 0, 5])
        same((far["reached"], far["angle_deg"]), (False, [round(a, 4) for a in state["angle_deg"]]))
        for status, bad in ((400, {"handle": "nose"}), (400, {"p_m": [0, 0]}),
                            (422, {"p_m": [0, 0, 1e9]}), (422, {"rotation": [1] * 9}),
                            (422, {"angle_deg": [0]}), (400, {"angle_deg": ["x"] * 20})):
            expect(status, "arg", page.post, "ik", **{"angle_deg": state["angle_deg"],
                                                      "handle": "waist", "p_m": lower, **bad})


# ---- the interface -----------------------------------------------------------------------------

class Schemas:
    """Judges values by the schemas of an OpenAPI file, in which nothing is answered that is not told."""

    def __init__(self, path):
        import jsonschema
        self.library = jsonschema
        with open(path, encoding="utf-8") as f:
            self.api = json.load(f)
        self.strict(self.api["components"]["schemas"])

    def strict(self, node):
        if isinstance(node, dict):
            if node.get("type") == "object" and node.get("properties"):
                node.setdefault("additionalProperties", False)
            for value in node.values():
                self.strict(value)
        elif isinstance(node, list):
            for value in node:
                self.strict(value)

    def __call__(self, name, value):
        try:
            self.library.validate(value, {"$ref": "#/components/schemas/" + name,
                                          "components": self.api["components"]})
        except self.library.ValidationError as error:
            raise AssertionError(f"{name}: {error.json_path}: {error.message[:500]}") from error

    def paths(self, page, names):
        """Every path that is told is there, for the methods that are told and no other."""
        for path, methods in self.api["paths"].items():
            own, other = page.server.port, page.server.stop_port
            if "servers" in methods:
                own, other = other, own
            real = path.format(**names)
            for method in ("get", "post", "put", "delete", "patch"):
                if path == "/api/events" and method in methods:
                    continue
                status, _, _ = page.ask(method.upper(), real, {}, port=own)
                assert status not in (404, 405) if method in methods else status == 405, \
                    f"{method} {path}: {status}"
            same(page.ask("GET", real, port=other)[0], 404, f"{path} at the other port")

    def bodies(self, page, *but):
        """Every body that is told has the fields that are taken, no more and no less."""
        for path, methods in self.api["paths"].items():
            content = methods.get("post", {}).get("requestBody", {}).get("content", {})
            for schema in [c["schema"]["$ref"] for c in content.values() if "$ref" in c["schema"]]:
                if path in but:
                    continue
                port = page.server.stop_port if "servers" in methods else page.server.port
                status, _, got = page.ask("POST", path, {"zzz": 1}, port=port)
                same(status, 400, path)
                said = json.loads(got)["error"]["message"]
                taken = re.search("unknown field 'zzz'; expected (.*)$", said).group(1).split(", ")
                told = self.api["components"]["schemas"][schema.rsplit("/", 1)[1]]["properties"]
                same(sorted(taken), sorted(told) or ["none"], path)

    def routes(self, source, *but):
        """Every path that the source has is told: a string of it that begins with a slash is one."""
        with open(source, encoding="utf-8") as f:
            found = set(re.findall(r'"(/[^"]+)"', f.read())) - set(but)
        told = {part for path in self.api["paths"] for part in re.split(r"\{.*\}", path) if part}
        same(sorted(found), sorted(told), source)
        for other in glob.glob("tools/grctl/web/*.c"):
            if os.path.basename(other) not in ("routes.c", "fleet.c"):
                with open(other, encoding="utf-8") as f:
                    assert '"/api' not in f.read(), f"{other} has a path of its own"


def schema():
    """What is answered is what serve.openapi.json tells, and every path of it is there."""
    fits = Schemas("docs/serve.openapi.json")
    folder = tempfile.mkdtemp()
    for name in ("greet.pseq", "greet.yaml", "step.pseq"):
        shutil.copy(os.path.join("motions", name), folder)
    with Server(motions=folder) as server:
        page = Page(server)
        fits.paths(page, {"name": "greet.pseq"})
        fits.routes("tools/grctl/web/routes.c", "/api/motions/NAME", "/api/motions/NAME/file")
        fits.bodies(page, "/api/stop", "/api/estop")
        page.target("reset")
        fits("robot", page.get("/api/robot"))
        fits("state", page.state())
        fits("motions", page.get("/api/motions"))
        for name in ("greet.pseq", "greet.yaml", "step.pseq"):
            fits("motion_whole", page.get("/api/motions/" + name))
        fits("motions", page.get("/api/motions"))
        fits("preview", page.post("preview", motion="step.pseq", speed_pct=50))
        edit = {"base": {"motion": "step.pseq"}, "keys": [{"from": 0}, {"from": 1, "mirror": True}]}
        fits("motion_edit", edit)
        fits("motion", page.call("PUT", "/api/motions/new.m", edit, {"If-None-Match": "*"}))
        page.take().keep_beating()
        page.fall_silent()
        taken = page.post("lease", action="take", name="again")
        fits("lease", taken)
        page.lease = taken["lease"]
        page.keep_beating()
        fits("accepted", page.target("play", motion="step.pseq"))
        fits("state", page.wait_played("playing"))
        fits("lease", Page(server).post("lease", action="ask", name="x"))
        fits("state", page.state())
        fits("accepted", page.post("halt"))
        fits("captured", page.post("capture"))
        state = page.wait("it stands", lambda s: not s["moving"])
        fits("pose", page.post("ik", angle_deg=state["angle_deg"], handle="waist",
                               p_m=state["body"]["root"]["p_m"]))
        fits("refusal", {"error": expect(422, "limit", page.target, "move",
                                         angle_deg={"m5": 170}).error})
        page.fall_silent()
        page.post("stop", name="x")
        fits("state", page.wait("confirmed", lambda s: s["stop"]["confirmed"]))
        for event in page.events():
            fits("event", event)
    shutil.rmtree(folder)
    with Server(motions=MOTIONS, env={}, device="sim") as server:
        fits("state", Page(server).state())


def other_motion():
    """A motion that was made for another robot is in the list with its reason, and is not played."""
    with Server() as server:
        page = Page(server).take().keep_beating()
        until = time.monotonic() + PATIENCE_S
        while True:
            files = {m["name"]: m for m in page.get("/api/motions")["motions"]}
            if all(m["state"] != "pending" for m in files.values()):
                break
            assert time.monotonic() < until, files
            time.sleep(0.05)
        wave = files["so101-wave.yaml"]
        same((wave["check"]["ok"], wave["check"]["refused"]["code"]), (False, "type"))
        assert "made for so101, not for GR001" in wave["check"]["message"], wave["check"]
        same(wave["thumbnail"]["angle_deg"], [])
        others = [n for n, m in files.items() if not m["check"]["ok"]]
        same(others, ["so101-wave.yaml"], "what cannot be played")
        for verb in ("play", "queue"):
            no = expect(422, "type", page.target, verb, motion="so101-wave.yaml")
            assert "made for so101, not for GR001" in no.error["message"], no.error
            expect(422, "type", page.target, verb, motion="so101-wave.yaml", clamp=True)
        look = page.post("preview", motion="so101-wave.yaml")
        same((look["check"]["ok"], look["frames"]["angle_deg"]), (False, []))
        state = page.state()
        same((state["moving"], state["play"]["state"], state["play"]["queue"]), (False, "idle", []))
        page.target("play", motion="so101-wave.yaml", force=True, clamp=True, speed_pct=50)
        page.wait_played("approaching", "playing")
        page.post("halt")
        page.fall_silent()


def other_robot():
    """A robot without a body: links of its file, no balance."""
    server = Server(motions="motions")
    server.words.insert(1, "--robot")
    server.words.insert(2, "so101")
    with server:
        page = Page(server)
        robot = page.get("/api/robot")
        same((robot["name"], robot["body"]), ("so101", None))
        same(len(robot["joints"]), len(page.state()["angle_deg"]))
        same(page.state()["body"], None)
        assert robot["links"] and robot["links"][0]["parent"] == -1, robot["links"]
        wave = page.get("/api/motions/so101-wave.yaml")
        same((wave["check"]["ok"], wave["balance"], wave["frames"]["root"]), (True, None, None))
        page.take().keep_beating()
        page.target("play", motion="so101-wave.yaml")
        page.wait_played("playing")
        page.post("stop")
        page.wait("confirmed", lambda s: s["stop"]["confirmed"])
        page.fall_silent()


def not_set_up():
    """A joint whose servo has another mode: which register differs, and what fixes it."""
    env = dict(os.environ, GRCTL_ROBOT="so101")
    with subprocess.Popen([GRCTL, "sim"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=env,
                          text=True) as robot:
        device = robot.stdout.readline().strip()
        subprocess.run([GRCTL, "-d", device, "--yes", "servo-set", "3", "mode", "3", "--flash"],
                       env=env, check=True, capture_output=True)
        with Server(device=device, env=env) as server:
            page = Page(server).take()
            page.keep_beating()
            state = page.wait("a reading", lambda s: s["status"][2] == "setup")
            why = {"joint": 2, "message": "mode is 3, 0 is wanted",
                   "fix": "'grctl servo-set 3 mode 0 --flash' sets it"}
            same(state["setup"], [why])
            page.target("move", angle_deg={"elbow_flex": 10}, time_ms=200)
            refused = page.wait_event("elbow_flex")
            assert why["message"] in refused["message"], refused
            page.fall_silent()
        robot.terminate()


if __name__ == "__main__":
    for _ in range(3):
        try:
            globals()[sys.argv[1]]()
            break
        except HeldUp:
            print("# the machine held it up: once more")
    else:
        sys.exit("the machine held it up each time")
