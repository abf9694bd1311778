# SPDX-License-Identifier: MIT
"""A small MQTT 5 client for tests of fleets, by the socket alone.

usage: mqtt.py PORT floor N         round trips of N messages by the broker alone, as JSON
       mqtt.py PORT order HOST VERB BODY [KEY=VALUE...]
                                    one order with a clock that its agent may compare; prints the
                                    answer. id, from: 32 digits; issued_ms, life_ms: beside now;
                                    at_ms: sets at_us; twice=BODY: the same id again, with that body
       mqtt.py PORT abandon HOST GROUP BODY
                                    prepares with BODY, and permits until all are ready, then orders
                                    a start 30 s ahead and falls silent; prints both answers
       mqtt.py PORT still SECONDS N what N robots do until each has stood for so long (30 s more at
                                    most), by "host/robot": whether it came to rest, how far it
                                    moved from there, whether it was busy then, how far that is
                                    from the posture heard first, and how old that one was
       mqtt.py PORT keep FILE       every message of grobo/v1/# as a line "topic payload", until it
                                    is ended
       mqtt.py PORT goodbye         is a broker itself: takes who comes, and says that it shuts down
       mqtt.py PORT mute            is one that takes connections and says nothing
       mqtt.py PORT hostile         is one that takes who comes, and then says what ends libmosquitto
                                    2.0.11 by an assertion, or packets of any content
       mqtt.py 0 fits FILE          these lines are as docs/fleet.schema.json says, but for orders
                                    of strangers; prints how many of each kind
"""
import json
import os
import select
import socket
import struct
import sys
import time

ROOT = "grobo/v1/"


def now_us():
    return time.monotonic_ns() // 1000


def text(value):
    data = value.encode()
    return struct.pack("!H", len(data)) + data


def varint(value):
    out = b""
    while True:
        value, low = value >> 7, value & 127
        out += bytes([low | (128 if value else 0)])
        if not value:
            return out


class Client:
    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.data = b""
        self.number = 0
        name = "test-" + os.urandom(8).hex()
        self.send(0x10, text("MQTT") + b"\x05\x02" + struct.pack("!H", 0) + b"\0" + text(name))
        self.wait(2)

    def send(self, kind, body):
        self.socket.sendall(bytes([kind]) + varint(len(body)) + body)

    def subscribe(self, topic):
        self.number += 1
        self.send(0x82, struct.pack("!H", self.number) + b"\0" + text(topic) + b"\0")
        self.wait(9)

    def publish(self, topic, payload, qos=0, response=None, retain=False):
        self.number += 1
        properties = b"\x08" + text(response) if response else b""
        if not isinstance(payload, bytes):
            payload = json.dumps(payload).encode()
        self.send(0x30 | qos << 1 | retain, text(topic) +
                  (struct.pack("!H", self.number) if qos else b"") +
                  varint(len(properties)) + properties + payload)

    def packet(self, until_s):
        """The next (kind, body), or None."""
        while True:
            length, shift, at = 0, 0, 1
            while at < len(self.data) and self.data[at] & 128:
                length |= (self.data[at] & 127) << shift
                shift, at = shift + 7, at + 1
            if at < len(self.data):
                length |= self.data[at] << shift
                if len(self.data) >= at + 1 + length:
                    whole = self.data[0], self.data[at + 1:at + 1 + length]
                    self.data = self.data[at + 1 + length:]
                    return whole
            rest = until_s - time.monotonic()
            if rest <= 0 or not select.select([self.socket], [], [], rest)[0]:
                return None
            more = self.socket.recv(1 << 16)
            if not more:
                sys.exit("the broker closed the connection")
            self.data += more

    def wait(self, kind):
        until_s = time.monotonic() + 30
        while True:
            packet = self.packet(until_s)
            if packet is None:
                sys.exit("no packet of kind %d" % kind)
            if packet[0] >> 4 == kind:
                return packet[1]

    def message(self, wait_s):
        """The next (topic, payload) of QoS 0, or None."""
        until_s = time.monotonic() + wait_s
        while True:
            packet = self.packet(until_s)
            if packet is None:
                return None
            kind, body = packet
            if kind >> 4 != 3:
                continue
            size = struct.unpack("!H", body[:2])[0]
            at, length, shift = 2 + size, 0, 0
            while body[at] & 128:
                length, shift, at = length | (body[at] & 127) << shift, shift + 7, at + 1
            at += 1 + (length | body[at] << shift)
            return body[2:2 + size].decode(), body[at:]


def floor(client, n):
    topic = "floor/" + os.urandom(8).hex()
    took = []
    client.subscribe(topic)
    for _ in range(n):
        began = now_us()
        client.publish(topic, b"x" * 300, qos=1)
        if client.message(10) is None:
            sys.exit("nothing came back")
        took.append(now_us() - began)
    took.sort()
    print(json.dumps({"p50_us": took[n // 2], "p99_us": took[n * 99 // 100], "max_us": took[-1]}))


class Sender:
    """Who orders one agent, and tells it the time."""

    def __init__(self, client, host, name=None):
        self.client, self.host = client, host
        self.name = name or os.urandom(16).hex()
        client.subscribe(ROOT + "ack/" + self.name)
        client.subscribe(ROOT + "time/" + self.name + "/ping")
        client.subscribe(ROOT + host + "/connection")
        self.epoch = None
        while self.epoch is None:
            got = client.message(10) or sys.exit("no agent of that name")
            if got[0].endswith("/connection"):
                self.epoch = json.loads(got[1])["epoch"]

    def order(self, verb, body, options):
        issued = now_us() + int(float(options.get("issued_ms", 0)) * 1000)
        head = {"v": 1, "id": options.get("id") or os.urandom(16).hex(), "from": self.name,
                "epoch": self.epoch, "issued_us": issued,
                "deadline_us": issued + int(float(options.get("life_ms", 2000)) * 1000)}
        if "at_ms" in options:
            body = dict(body, at_us=now_us() + int(float(options["at_ms"]) * 1000))
        self.client.publish(ROOT + self.host + "/cmd/" + verb, dict(body, **head), qos=1,
                            response=ROOT + "ack/" + self.name)
        return head["id"]

    def answer(self, number, wait_s=10):
        """None: it did not come."""
        until_s = time.monotonic() + wait_s
        while time.monotonic() < until_s:
            got = self.client.message(until_s - time.monotonic())
            if got is None:
                continue
            said = json.loads(got[1])
            if got[0].endswith("/ping"):
                self.client.publish(ROOT + "time/" + said["host"] + "/pong",
                                    {"v": 1, "leader": self.name, "n": said["n"],
                                     "t_us": now_us()})
            elif said.get("id") == number and "ok" in said:
                return said
        return None


def order(client, host, verb, body, words):
    options = dict(word.split("=", 1) for word in words)
    sender = Sender(client, host, options.get("from"))
    number = sender.order(verb, json.loads(body), options)
    print(json.dumps(sender.answer(number) or sys.exit("no answer")))
    if "twice" in options:
        options["id"] = number
        sender.order(verb, json.loads(options["twice"]), options)
        print(json.dumps(sender.answer(number) or sys.exit("no answer")))


def abandon(client, host, group, body):
    sender = Sender(client, host)
    number = sender.order("prepare", dict(json.loads(body), group=group, spread_us=1000000), {})
    said, until_s = None, time.monotonic() + 60
    while said is None and time.monotonic() < until_s:
        client.publish(ROOT + "group/" + group + "/permit",
                       {"v": 1, "leader": sender.name, "seq": 0})
        said = sender.answer(number, 0.1)
    print(json.dumps(said))
    start = sender.order("start", {"of": number}, {"at_ms": 30000})
    print(json.dumps(sender.answer(start)))


class Rest:
    """A robot that should stand. Its angles may be old when it is heard of first: what counts is how
    it goes on from the first posture that was read wholly after it was told to be at rest."""

    def __init__(self):
        self.first = self.rest_us = self.posture = self.posture_us = self.now_us = None
        self.came = self.moved = self.old_ms = 0
        self.busy = False

    def take(self, said):
        angles, self.now_us = said["angles_deg"], said["t_us"]
        if self.first is None:
            self.first, self.old_ms = angles, said["angles_age_ms"]
        busy = said["moving"] or said["play"] == "playing"
        if self.posture:
            self.moved = max(self.moved, farthest(self.posture, angles))
            self.busy |= busy
        elif busy:
            self.rest_us = None
        elif self.rest_us is None:
            self.rest_us = self.now_us
        elif self.now_us - 1000 * said["angles_age_ms"] > self.rest_us:
            self.posture, self.posture_us = angles, self.now_us
            self.came = farthest(self.first, angles)

    def stood_for(self, seconds):
        return self.posture and self.now_us - self.posture_us >= seconds * 1e6

    def row(self):
        return {"rests": self.posture is not None, "moved_deg": self.moved, "busy": self.busy,
                "came_deg": self.came, "old_ms": self.old_ms}


def farthest(a, b):
    return max(abs(x - y) for x, y in zip(a, b) if x is not None and y is not None)


def still(client, seconds, n):
    client.subscribe(ROOT + "+/+/state")
    seen, until_s = {}, time.monotonic() + seconds + 30
    while time.monotonic() < until_s:
        got = client.message(until_s - time.monotonic())
        if got is None:
            break
        said = json.loads(got[1])
        if said.get("angles_age_ms") is not None:
            seen.setdefault("/".join(got[0].split("/")[2:4]), Rest()).take(said)
        if len(seen) == n and all(robot.stood_for(seconds) for robot in seen.values()):
            break
    print(json.dumps({name: robot.row() for name, robot in sorted(seen.items())}))


def keep(client, path):
    client.subscribe(ROOT + "#")
    with open(path, "w", buffering=1) as out:
        while True:
            got = client.message(1)
            if got:
                out.write(got[0] + " " + got[1].decode("utf-8", "replace") + "\n")


def listen(port):
    listener = socket.socket()
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    listener.bind(("127.0.0.1", port))
    listener.listen()
    print("ready", flush=True)
    return listener


def goodbye(port):
    listener, kept = listen(port), []
    while True:
        client = listener.accept()[0]
        client.recv(1000)
        client.sendall(b"\x20\x03\0\0\0" + b"\xe0\x02\x8b\0")
        kept.append(client)


def hostile(port):
    import random
    any_of = random.Random(1)
    listener, n = listen(port), 0
    while True:
        client = listener.accept()[0]
        client.recv(1000)
        packets = b"\xf0\x03\0\x68\0" if n % 2 == 0 else b"".join(
            bytes([any_of.randrange(256), size]) + any_of.randbytes(size)
            for size in (any_of.randrange(100) for _ in range(8)))
        n += 1
        try:
            client.sendall(b"\x20\x03\0\0\0" + packets)
            client.shutdown(socket.SHUT_WR)
            client.settimeout(5)
            while client.recv(1 << 16):
                pass
        except OSError:
            pass
        client.close()
        print("served", n, flush=True)


def mute(port):
    listener, kept = listen(port), []
    while True:
        kept.append(listener.accept()[0])


def kind_of(topic):
    part = topic[len(ROOT):].split("/")
    return "cmd_" + part[2] if part[1:2] == ["cmd"] else "ack" if part[0] == "ack" else part[-1]


def fits(path, kinds):
    import jsonschema
    schema = json.load(open("docs/fleet.schema.json"))
    checks = {name: jsonschema.Draft202012Validator(dict(schema, **{"$ref": "#/$defs/" + name}))
              for name in schema["$defs"]}
    seen, wrong = dict.fromkeys(checks, 0), []
    for line in open(path):
        topic, text = line.rstrip("\n").split(" ", 1)
        kind = kind_of(topic)
        try:
            errors = [e.message for e in checks[kind].iter_errors(json.loads(text))]
        except (ValueError, KeyError) as error:
            errors = [repr(error)]
        if not errors:
            seen[kind] += 1
        elif not kind.startswith("cmd_"):
            wrong.append("%s: %s" % (line[:300], errors[0][:200]))
    print(json.dumps(seen))
    if wrong:
        sys.exit("\n".join(wrong[:5]))
    if not all(seen[kind] for kind in kinds.split()):
        sys.exit("not all of these were seen: " + kinds)


def main(words):
    if words[1] == "fits":
        fits(words[2], words[3])
        return
    if words[1] == "goodbye":
        goodbye(int(words[0]))
    if words[1] == "mute":
        mute(int(words[0]))
    if words[1] == "hostile":
        hostile(int(words[0]))
    client = Client(int(words[0]))
    if words[1] == "floor":
        floor(client, int(words[2]))
    elif words[1] == "order":
        order(client, words[2], words[3], words[4], words[5:])
    elif words[1] == "abandon":
        abandon(client, *words[2:])
    elif words[1] == "still":
        still(client, float(words[2]), int(words[3]))
    else:
        keep(client, words[2])


main(sys.argv[1:])
