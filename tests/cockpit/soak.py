# SPDX-License-Identifier: MIT
"""`grctl serve` for a long time, with clients that behave well and badly at once: its memory and its
descriptors stay what they were.

usage: soak.py MINUTES
environment: GRCTL. Prints a line a minute, and the first and the last figure. The first is taken after
a fifth of the time: until then tables and allocators grow to what they need.
"""
import json
import os
import pathlib
import random
import socket
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
from cockpit import Page, Refused, Server, Stream, raw  # noqa: E402

GROWTH_KB = 1024
MOTION = "greet.pseq"
over = threading.Event()
counts = {}
broken = []


def client(server, name, act, pause_s):
    """A thread that does this again and again. Refusals and ended connections are what it is about."""
    def run():
        while not over.wait(pause_s * random.uniform(0.5, 1.5)):
            try:
                act(server)
                counts[name] = counts.get(name, 0) + 1
            except (OSError, EOFError, Refused, ValueError):
                counts[name + ", refused"] = counts.get(name + ", refused", 0) + 1
            except BaseException as error:
                broken.append(f"{name}: {error!r}")
                return
    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    return thread


def read_stream(server):
    """30 s of states."""
    stream = Stream(server, {"Last-Event-ID": "0"})
    until = time.monotonic() + 30
    while time.monotonic() < until and not over.is_set():
        stream.next()
    stream.close()


def read_slowly(server):
    """Takes a few bytes now and then, until it is dropped."""
    stream = Stream(server, buffer_bytes=4096)
    until = time.monotonic() + 20
    while time.monotonic() < until and not over.is_set():
        if not stream.socket.recv(200):
            break
        time.sleep(0.3)
    stream.close()


def leave_a_stream(server):
    stream = Stream(server)
    stream.next()
    stream.close()


def shout_into_a_stream(server):
    stream = Stream(server)
    for _ in range(20):
        stream.socket.sendall(b"x" * 65536)
    stream.close()


def half_a_request(server):
    with socket.create_connection(("127.0.0.1", server.port), 10) as s:
        s.sendall(f"POST /api/play HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nContent-Le".encode())
        s.recv(100)


def half_a_body(server):
    with socket.create_connection(("127.0.0.1", server.port), 10) as s:
        s.sendall(f"POST /api/ik HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nX-Grobo-Token: {server.token}"
                  "\r\nContent-Type: application/json\r\nContent-Length: 5000\r\n\r\n{".encode())
        time.sleep(random.uniform(0, 1))


def rubbish(server):
    raw(random.choice((server.port, server.stop_port)), os.urandom(random.randrange(1, 3000)) + b"\r\n\r\n", 10)


def leave_before_the_answer(server):
    with socket.create_connection(("127.0.0.1", server.port), 10) as s:
        s.sendall(f"GET /api/motions/{MOTION} HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n\r\n".encode())


def look(server):
    page = Page(server)
    for path in ("/api/robot", "/api/state", "/api/motions", f"/api/motions/{MOTION}?rate=50"):
        page.get(path)
    page.ask("GET", "/")
    page.ask("GET", "/api/motions/nothing.pseq")


def preview(server):
    Page(server).post("preview", motion=MOTION, speed_pct=random.choice((50, 100, 200)))


def save(server):
    page = Page(server)
    whole = page.get(f"/api/motions/{MOTION}")
    keys = [{"from": n} for n in range(len(whole["keys"]))]
    name = f"soak{random.randrange(4)}.pseq"
    status, headers, _ = page.ask("GET", f"/api/motions/{name}/file")
    known = {"If-Match": headers["ETag"]} if status == 200 else {"If-None-Match": "*"}
    copy = [dict(k, time_ms=t["time_ms"], angle_deg={}) for k, t in zip(keys, whole["keys"])]
    page.call("PUT", f"/api/motions/{name}",
              {"kind": "keys", "keys": [{"time_ms": k["time_ms"], "angle_deg": {"CHEST_P": 1}}
                                        for k in copy]}, known)


def drive(server):
    """Takes the lease; plays, jogs, moves, stops; or falls silent in the middle of it."""
    page = Page(server, "soak")
    if page.state()["stop"]["latched"]:
        page.target("reset")
    page.take().keep_beating()
    try:
        page.target("play", motion=MOTION, speed_pct=200, on_lost=random.choice(("stop", "finish", "exit")))
        time.sleep(random.uniform(0.2, 4))
        way = random.randrange(4)
        if way == 0:
            page.ask("POST", "/stop", b"{}", {}, server.stop_port)
            page.wait("confirmed", lambda s: s["stop"]["confirmed"])
            page.target("reset")
        elif way == 1:
            page.post("halt")
            for angle in range(0, -30, -2):
                page.target("jog", angle_deg={"R_ELBOW_P": angle})
        elif way == 2:
            page.post("lease", action="give")
    finally:
        page.fall_silent()


CLIENTS = [(read_stream, 1, 6), (read_slowly, 1, 2), (leave_a_stream, 0.5, 2), (shout_into_a_stream, 3, 1),
           (half_a_request, 1, 2), (half_a_body, 0.5, 2), (rubbish, 0.2, 1), (leave_before_the_answer, 0.3, 1),
           (look, 0.5, 1), (preview, 2, 1), (save, 5, 1), (drive, 1, 1)]


def figures(server):
    return server.rss_kb(), len(os.listdir(f"/proc/{server.process.pid}/fd"))


def main():
    minutes = float(sys.argv[1])
    folder = pathlib.Path(os.environ.get("TMPDIR", "/tmp")) / f"soak-{os.getpid()}"
    folder.mkdir()
    (folder / MOTION).write_bytes((pathlib.Path("motions") / MOTION).read_bytes())
    began = time.monotonic()
    seen = []
    with Server(motions=str(folder)) as server:
        threads = [client(server, act.__name__, act, pause_s)
                   for act, pause_s, n in CLIENTS for _ in range(n)]
        while time.monotonic() - began < 60 * minutes and not broken:
            over.wait(min(5.0, 6 * minutes))
            at = time.monotonic() - began
            seen.append((at, *figures(server)))
            if len(seen) % 12 == 0:
                print(f"# {at / 60:.1f} min: {seen[-1][1]} kB, {seen[-1][2]} descriptors", flush=True)
            assert server.process.poll() is None, "the server ended"
        over.set()
        for thread in threads:
            thread.join(60)
        Page(server).wait("no stream is left", lambda s: s["clients"] == 0)
        after_fds = figures(server)[1]
    for file in folder.iterdir():
        file.unlink()
    folder.rmdir()
    print("# " + json.dumps(counts, sort_keys=True))
    assert not broken, broken
    for name in {act.__name__ for act, _, _ in CLIENTS}:
        assert counts.get(name, 0) + counts.get(name + ", refused", 0) > 0, f"{name} did nothing"
    settled = [s for s in seen if s[0] > 12 * minutes]
    fifth = max(1, len(settled) // 4)
    first, last = (max(kb for _, kb, _ in part) for part in (settled[:fifth], settled[-fifth:]))
    print(f"# resident memory: first {first} kB, last {last} kB; at the end {after_fds} descriptors")
    assert last - first < GROWTH_KB, f"memory grew from {first} to {last} kB"
    print("ok 1 - memory is flat\n1..1")


main()
