# SPDX-License-Identifier: MIT
"""Clients of `grctl serve --broker`, with a real broker and agents of simulated robots.
usage: fleet_view.py SCENARIO; each scenario is a function below."""
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

from cockpit import (GRCTL, PATIENCE_S, Page, Refused, Server, Stream, expect, raw, same,
                     free_port as ports_in_a_row)

HOSTS = {"stage": ["a", "b"], "lab": ["c", "d"]}


def is_possible():
    """Why not, or None."""
    if not all(shutil.which(w) for w in ("mosquitto", "mosquitto_pub")):
        return "no mosquitto and mosquitto_pub here"
    said = subprocess.run([GRCTL, "fleet", "list", "--broker", "mqtt://127.0.0.1:1"],
                          capture_output=True, text=True, check=False).stderr
    return "this grctl has no MQTT in it" if "no MQTT in it" in said else None


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Fleet:
    """A broker, and an agent of two robots on each of two hosts; d is not there."""

    def __enter__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        (self.folder / "motions").mkdir()
        shutil.copy("motions/greet.pseq", self.folder / "motions")
        config = self.folder / "config" / "grctl"
        config.mkdir(parents=True)
        groups = ", ".join(f"{g}: [{', '.join(r)}]" for g, r in HOSTS.items())
        (config / "config.yaml").write_text(
            f"groups: {{{groups}}}\nrobots: {{a: {{device: sim}}, b: {{device: sim}}, "
            f"c: {{device: sim, robot: so101}}, d: {{device: {self.folder}/none}}}}\n")
        self.env = dict(os.environ, XDG_CONFIG_HOME=str(self.folder / "config"),
                        XDG_STATE_HOME=str(self.folder / "state"), LC_ALL="C.UTF-8")
        self.port = free_port()
        self.url = f"mqtt://127.0.0.1:{self.port}"
        self.publish = ["mosquitto_pub", "-h", "127.0.0.1", "-p", str(self.port)]
        self.running = {}
        self.begin_broker()
        for host in HOSTS:
            self.begin_agent(host)
        return self

    def __exit__(self, *_):
        for name in [n for n in self.running if n != "broker"] + ["broker"]:
            self.end(name)
        shutil.rmtree(self.folder)

    def begin(self, name, words):
        with open(self.folder / f"{name}.log", "ab") as log:
            self.running[name] = subprocess.Popen(words, stdout=log, stderr=log, env=self.env,
                                                  stdin=subprocess.DEVNULL)

    def begin_broker(self):
        conf = self.folder / "broker.conf"
        conf.write_text(f"listener {self.port} 127.0.0.1\nallow_anonymous true\npersistence false\n"
                        "set_tcp_nodelay true\n")
        self.begin("broker", ["mosquitto", "-c", str(conf)])
        until = time.monotonic() + PATIENCE_S
        while subprocess.run([*self.publish, "-t", "x", "-m", "x"], capture_output=True,
                             check=False).returncode:
            assert time.monotonic() < until, "the broker did not start"
            time.sleep(0.05)

    def begin_agent(self, host, *words):
        self.begin(host, [GRCTL, "-d", host, "agent", "--broker", self.url, "--host", f"host-{host}",
                          "--motions", str(self.folder / "motions"), *words])

    def end(self, name, how=signal.SIGTERM):
        process = self.running.pop(name, None)
        if process and process.poll() is None:
            process.send_signal(how)
            process.wait(PATIENCE_S)

    def say(self, topic, message, *words):
        text = message if isinstance(message, str) else json.dumps(message)
        subprocess.run([*self.publish, "-q", "1", "-t", f"grobo/v1/{topic}",
                        "-s" if text else "-n", *words], input=text, text=True, check=True)

    def order(self, *words):
        """Status and complaint of `grctl fleet`."""
        got = subprocess.run([GRCTL, "fleet", *words, "--broker", self.url], env=self.env,
                             capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
        return got.returncode, got.stderr

    def play(self):
        """Slowly, on group stage."""
        self.begin("play", [GRCTL, "fleet", "play", "greet.pseq", "--broker", self.url, "-s", "20",
                            "--group", "stage"])


class View(Page):
    def robots(self, state=None):
        return {r["robot"]: r for r in (state or self.state())["robots"]}

    def wait_link(self, **links):
        return self.wait(f"{links}", lambda s: all(
            self.robots(s).get(r, {}).get("link") == link for r, link in links.items()))

    def wait_all(self):
        self.wait_link(a="up", b="up", c="up", d="down")
        return self.wait("all was read", lambda s: all(
            None not in r["angle_deg"] for r in s["robots"]))


def shown():
    """Who is there, how they are; a stream of whole states; who goes is seen to go."""
    with Fleet() as fleet, Server(broker=fleet.url) as server:
        view = View(server)
        state = view.wait_all()
        robots = view.robots(state)
        same(len(robots["a"]["angle_deg"]), 20)
        same(robots["d"]["angle_deg"], [])
        assert robots["a"]["temperature_c"] > 0 and robots["a"]["voltage_v"] > 5, robots["a"]
        same((state["broker"], state["latch"], state["confirmed"]), (True, None, False))
        hosts = {h["host"]: h for h in view.get("/api/fleet")["hosts"]}
        same(sorted(hosts), ["host-lab", "host-stage"])
        same((hosts["host-stage"]["groups"], hosts["host-stage"]["connection"]),
             (["all", "stage"], "ONLINE"))
        a = hosts["host-stage"]["robots"][0]
        same((a["name"], a["model"], len(a["joints"]), a["cockpit"]), ("a", "GR001", 20, None))
        same(sorted(a["joints"][0]), ["limits_deg", "name"])
        stream, states, kinds = Stream(server), [], set()
        while len(states) < 12 or "comment" not in kinds:
            kind, data = stream.next()
            kinds.add(kind)
            if kind == "state":
                states.append(data)
        stream.close()
        same([b["sequence"] - s["sequence"] for s, b in zip(states, states[1:])],
             [1] * (len(states) - 1))
        same({len(s["robots"]) for s in states}, {4})
        fleet.end("lab")
        view.wait_link(c="away", d="away")
        fleet.end("stage", signal.SIGKILL)
        view.wait_link(a="broken", b="broken")
        fleet.begin_agent("stage")
        view.wait_link(a="up", b="up")
        same(view.ask("GET", "/")[0], 200)
        assert b"fleet.js" in __import__("gzip").decompress(view.ask("GET", "/")[2])
    with Fleet() as fleet, Server("--group", "lab", broker=fleet.url) as server:
        view = View(server)
        view.wait_link(c="up")
        same(sorted(view.robots()), ["c", "d"], "a group alone")


def stopping():
    """A stop reaches what plays, stands, is told robot by robot, and is released."""
    with Fleet() as fleet, Server(broker=fleet.url) as server:
        view = View(server)
        view.wait_all()
        expect(409, "state", view.target, "reset")
        expect(400, "arg", view.post, "reset")
        expect(400, "arg", view.target, "reset", group="all")
        fleet.play()
        view.wait("they play", lambda s: all(
            view.robots(s)[r]["play"] == "playing" and view.robots(s)[r]["motion"] == "greet.pseq"
            for r in "ab"))
        same(view.ask("POST", "/stop", b"{}", {"Content-Type": "text/plain", "X-Grobo-Token": None},
                      server.stop_port)[0], 204, "by the second port, without a token")
        state = view.wait("both stand", lambda s: all(
            view.robots(s)[r]["stop"] == "stopped" for r in "abc"))
        same((state["latch"]["kind"], state["latch"]["ours"]), ("stop", True))
        same((view.robots(state)["d"]["stop"], state["confirmed"]), ("silent", False),
             "nobody knows of d")
        assert not any(view.robots(state)[r]["moving"] for r in "abc"), state
        fleet.running.pop("play").wait(PATIENCE_S)
        status, why = fleet.order("play", "greet.pseq", "--group", "stage")
        assert status == 1 and "a stop of group all stands" in why, why
        same(view.post("stop", name="again")["done"], True, "it is one stop")
        view.post("estop", name="harder")
        view.wait("as an emergency stop", lambda s: s["latch"] and s["latch"]["kind"] == "estop" and
                  all(view.robots(s)[r]["stop"] == "stopped" for r in "abc"))
        expect(401, "token", view.call, "POST", "/api/reset", {}, {"X-Grobo-Token": None})
        seen = view.state()["sequence"]
        view.post("estop", name="Anna")
        no = expect(409, "stale", view.post, "reset", sequence=seen)  # it was held up on its way
        assert "by Anna" in no.error["message"], no.error
        view.target("reset", name="test")
        view.wait("released", lambda s: s["latch"] is None and not any(
            r["stopped"] for r in s["robots"]))
        view.wait("no trip is left", lambda s: all(r["trip"] is None for r in s["robots"]))
        assert not any(r["moving"] for r in view.state()["robots"])
        same(fleet.order("play", "greet.pseq", "--group", "stage", "-s", "400")[0], 0)
        same(fleet.order("stop")[0], 1, "d is not there")
        state = view.wait("a stop of another is seen", lambda s: s["latch"] is not None)
        same(state["latch"]["ours"], False)
        view.target("reset")
        view.wait("and released", lambda s: s["latch"] is None)
        fleet.end("lab")
        gone = view.wait("the lab is gone", lambda s: all(
            view.robots(s)[r]["link"] in ("away", "broken") for r in "cd"))
        left = all(view.robots(gone)[r]["link"] == "away" for r in "cd")
        view.post("stop")
        if left:  # a busy machine may have broken it off, and that is waited for
            view.wait("who left is not waited for", lambda s: s["confirmed"])


def first_of_all():
    """The stop port is open before the broker has answered, and says what it cannot do."""
    ports = ports_in_a_row()
    with socket.create_server(("127.0.0.1", 0)) as nobody:  # takes a connection, and says nothing
        url = f"mqtt://127.0.0.1:{nobody.getsockname()[1]}"
        server = subprocess.Popen([GRCTL, "serve", "--broker", url, "--port", str(ports)],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        until = time.monotonic() + PATIENCE_S
        while True:
            try:
                got = raw(ports + 1, f"POST /stop HTTP/1.1\r\nHost: 127.0.0.1:{ports + 1}\r\n"
                                     "Content-Length: 2\r\nConnection: close\r\n\r\n{}".encode())
                break
            except ConnectionRefusedError:
                assert server.poll() is None and time.monotonic() < until, "no port"
                time.sleep(0.01)
        same(int(got.split()[1]), 503)
        assert "use the switches" in got, got
        assert server.poll() is None, "it waits for the broker still"
        server.terminate()
        server.communicate()


def broker_away():
    """A stop while the broker is away is refused, and goes out when it is back; so does one that the
    broker forgot."""
    with Fleet() as fleet, Server(broker=fleet.url) as server:
        view = View(server)
        view.wait_all()
        fleet.end("broker", signal.SIGKILL)
        view.wait("its loss is told", lambda s: not s["broker"])
        no = expect(503, "unreachable", view.post, "stop", name="test")
        assert "use the switches" in no.error["message"], no
        same(view.ask("POST", "/stop", b"{}", {}, server.stop_port)[0], 503)
        expect(503, "unreachable", view.target, "reset")
        view.wait("it is kept", lambda s: s["wanted"])
        fleet.begin_broker()
        view.wait("it went out", lambda s: s["latch"] is not None and not s["wanted"])
        view.wait("they obey", lambda s: all(view.robots(s)[r]["stop"] == "stopped" for r in "abc"))
        for host in HOSTS:
            fleet.end(host)
        fleet.end("broker", signal.SIGKILL)
        view.wait("its loss is told", lambda s: not s["broker"])
        fleet.begin_broker()
        view.wait("it is back", lambda s: s["broker"])
        fleet.begin_agent("stage")
        view.wait("who comes later hears of the stop", lambda s: all(
            view.robots(s)[r]["stop"] == "stopped" for r in "ab"))


def walls():
    """The rules of `grctl serve` hold here too."""
    with Fleet() as fleet:
        with Server(broker=fleet.url) as server:
            view = View(server)
            host = f"127.0.0.1:{server.port}"

            def post(headers, path, port=server.port):
                return int(raw(port, "\r\n".join([
                    f"POST {path} HTTP/1.1", f"Host: 127.0.0.1:{port}", "Content-Length: 2",
                    "Connection: close", *headers, "", "{}"]).encode()).split()[1])

            json_type = "Content-Type: application/json"
            for path in ("/", "/api/fleet", "/api/state", "/api/events"):
                same(view.ask("GET", path, headers={"Host": "evil.example"})[0], 403, path)
            for port, path in ((server.port, "/api/stop"), (server.stop_port, "/stop")):
                same(post([json_type, "Origin: http://evil.example"], path, port), 403, path)
                same(post([json_type, "Sec-Fetch-Site: cross-site"], path, port), 403, path)
            same(view.state()["latch"], None, "one of these stopped the robots")
            same(post([json_type], "/api/reset"), 401, "reset without token")
            for path in ("/api/play", "/api/robot", "/api/motions", "/api/lease", "/nothing"):
                same(view.ask("GET", path)[0], 404, path)
            same(view.ask("GET", "/api/reset")[0], 405)
            same(post([json_type, f"Origin: http://{host}"], "/api/stop"), 200, "our own page")
        with Server("--listen", "0.0.0.0", broker=fleet.url) as server:
            view = View(server)
            same(view.ask("GET", "/api/state", headers={"X-Grobo-Token": None})[0], 401)
            same(view.ask("POST", "/stop", b"{}", {"X-Grobo-Token": None}, server.stop_port)[0], 401)
            same(view.ask("GET", "/api/state")[0], 200)
    for words, pattern in ((["motions"], "motions are not of a fleet"), (["--group", "a/b"], "letters"),
                           (["--broker", "http://x"], "is wanted")):
        got = subprocess.run([GRCTL, "serve", "--broker", "mqtt://127.0.0.1:1", *words],
                             capture_output=True, text=True, check=False)
        assert got.returncode == 2 and pattern in got.stderr, got


def strangers():
    """What comes over the broker is bounded, and is no link and no markup."""
    with Fleet() as fleet, Server(broker=fleet.url) as server:
        view = View(server)
        view.wait_all()
        links = {"ok": "https://robot.local:8717/#token=x", "script": "javascript:alert(1)",
                 "data": "data:text/html,x", "space": "http://a b", "long": "http://" + "x" * 400,
                 "line": "http://a\nb", "quote": "http://a\"b", "number": 7}
        bad = [{"name": n, "cockpit": url, "model": "<img src=x>", "joints": [
            {"name": "j" * 500, "limits_deg": ["x", None]}, 7, {}]} for n, url in links.items()]
        bad += [{"name": n} for n in ("a/b", "", "<b>", 7, None, "x" * 64)] + [3, None, []]
        fleet.say("evil/factsheet", {"v": 1, "epoch": "e", "groups": ["all", "<b>", 7], "robots": bad}, "-r")
        fleet.say("evil/connection", {"v": 1, "state": "ONLINE", "epoch": "e"}, "-r")
        fleet.say("evil/ok/state", {"v": 1, "up": True, "play": "p" * 1000, "trip": {"x": 1}, "moving": "yes",
                                    "temperature_c": "hot", "voltage_v": [1], "heard_us": 9e18,
                                    "angles_deg": [1, "x", None, {}] + [2] * 2000})
        view.wait_link(ok="up", script="silent")
        robot = view.robots()["ok"]
        same((robot["play"], robot["trip"], robot["moving"], robot["temperature_c"], robot["voltage_v"]),
             (None, None, False, None, None))
        same((robot["angle_deg"][:4], len(robot["angle_deg"])), ([1, None, None, None], 64))
        assert 0 <= robot["age_ms"] < 60000, robot
        evil = [h for h in view.get("/api/fleet")["hosts"] if h["host"] == "evil"][0]
        same(evil["groups"], ["all"])
        same({r["name"]: r["cockpit"] for r in evil["robots"]},
             {n: url if n == "ok" else None for n, url in links.items()})
        same(evil["robots"][0]["joints"][0], {"name": None, "limits_deg": [None, None]})
        before_kb = server.rss_kb()
        for n in range(0, 200, 20):
            fleet.say(f"evil/r{n}/state", {"v": 1, "up": True, "x": "y" * 4000})
        fleet.say("evil/factsheet", {"v": 1, "groups": ["all"], "robots": [
            {"name": f"r{n}"} for n in range(3000)]}, "-r")
        view.wait("only so many of a host", lambda s: len(s["robots"]) == 68)
        for junk in ("", "{", "[]", "7", "[" * 100000, json.dumps({"v": 2}), "\x00\xff"):
            fleet.say("evil/factsheet", junk)
            fleet.say("group/all/latch", junk)
        fleet.say("group/all/latch", {"v": 1, "stopped": True, "id": 7, "how": "x" * 500})
        state = view.state()
        assert state["latch"] is None or state["latch"]["kind"] is None, state["latch"]
        assert server.rss_kb() - before_kb < 20000
        view.post("stop")
        view.wait("it still stops", lambda s: all(view.robots(s)[r]["stop"] == "stopped" for r in "abc"))


def schema():
    """What is answered is what the OpenAPI file tells."""
    from cockpit import Schemas
    with Fleet() as fleet, Server(broker=fleet.url) as server:
        view = View(server)
        fits = Schemas("docs/serve-fleet.openapi.json")
        fits.paths(view, {})
        fits.bodies(view, "/api/stop", "/api/estop", "/stop", "/estop")
        fits.routes("tools/grctl/web/fleet.c", "/index.html", "/fleet.html")
        view.wait("stopped by that", lambda s: s["latch"] is not None)
        view.target("reset")
        view.wait_all()
        fits("fleet", view.get("/api/fleet"))
        fits("state", view.state())
        fits("accepted", view.post("stop", name="x"))
        fits("state", view.wait("stopped", lambda s: view.robots(s)["a"]["stop"] == "stopped"))
        fleet.end("broker", signal.SIGKILL)
        view.wait("its loss is told", lambda s: not s["broker"])
        try:
            view.post("stop")
        except Refused as no:
            fits("refusal", {"error": no.error})
        for event in view.events():
            fits("event", event)


if __name__ == "__main__":
    globals()[sys.argv[1]]()
