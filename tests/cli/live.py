"""A client of `rilievo serve` in Python's standard library: what tests and hostile clients share.

A server is a process that says its address; a socket says anything, well or badly.
"""

import base64
import json
import math
import os
import re
import signal
import socket
import struct
import subprocess
import threading
import time

# A server that hangs fails a test, and does not hang it.
PATIENCE_S = 280


class Server:
    """A running `rilievo serve SCENE ...`; its address and port, and what it says (--json)."""

    def __init__(self, program, scene, *options, port=0, **more):
        self.process = subprocess.Popen(
            [program, "serve", scene, "--port", str(port), "--json", *map(str, options)], text=True,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **more)
        self.events = []
        self.listening = threading.Event()
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()
        if not self.listening.wait(PATIENCE_S) or not self.port:
            self.process.kill()
            raise AssertionError(f"it does not listen: {self.process.stderr.read()}")

    def _read(self):
        self.port = 0
        for line in self.process.stdout:
            event = json.loads(line)
            if event["event"] == "listening":
                self.address, self.port = event["address"], event["port"]
                self.listening.set()
            self.events.append(event)
        self.listening.set()

    def said(self, event):
        return [one for one in list(self.events) if one["event"] == event]

    def memory_kb(self):
        with open(f"/proc/{self.process.pid}/status") as status:
            return int(re.search(r"VmRSS:\s+(\d+)", status.read())[1])

    def files(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def end(self, by=signal.SIGINT):
        """Its exit code."""
        if self.process.stderr.closed:
            return self.process.returncode
        if self.process.poll() is None:
            self.process.send_signal(by)
        try:
            code = self.process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        self.reader.join(PATIENCE_S)
        self.process.stdout.close()
        self.stderr = self.process.stderr.read()
        self.process.stderr.close()
        return code


def frame(payload, opcode=2, last=True):
    """A frame of a client, masked with zeros."""
    head = bytes([opcode | (0x80 if last else 0)])
    if len(payload) < 126:
        head += bytes([0x80 | len(payload)])
    elif len(payload) < 65536:
        head += bytes([0x80 | 126]) + struct.pack(">H", len(payload))
    else:
        head += bytes([0x80 | 127]) + struct.pack(">Q", len(payload))
    return head + bytes(4) + payload


class Closed(Exception):
    """The server has closed; `code` of the WebSocket's close, or None."""

    def __init__(self, code=None):
        super().__init__(f"closed with {code}")
        self.code = code


class Socket:
    """One connection to a server on this machine."""

    def __init__(self, port, wrap=None, timeout=PATIENCE_S):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=timeout)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if wrap:
            self.socket = wrap(self.socket)
        self.unread = b""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.socket.close()

    def send(self, data):
        self.socket.sendall(data)

    def _more(self):
        try:
            data = self.socket.recv(1 << 16)
        except ConnectionResetError:
            data = b""
        self.unread += data
        return bool(data)

    def read(self, count):
        while len(self.unread) < count:
            if not self._more():
                raise Closed
        data, self.unread = self.unread[:count], self.unread[count:]
        return data

    def ask(self, line, headers=()):
        """The status, the headers and the body of the answer to a request."""
        self.send("\r\n".join([line + " HTTP/1.1", *headers, "", ""]).encode("latin-1"))
        while b"\r\n\r\n" not in self.unread:
            if not self._more():
                raise Closed
        head, self.unread = self.unread.split(b"\r\n\r\n", 1)
        status = int(head.split()[1])
        found = dict((name.lower(), value.strip()) for name, _, value in
                     (one.partition(":") for one in head.decode("latin-1").split("\r\n")[1:]))
        body = b"" if line.startswith("HEAD") or status < 200 else self.read(int(found.get("content-length", 0)))
        return status, found, body

    def open(self, target="/live", host="localhost", origin=None, more=()):
        """The status of the handshake: 101 if the WebSocket is open."""
        key = base64.b64encode(os.urandom(16)).decode()
        return self.ask(f"GET {target}", [
            f"Host: {host}", "Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13",
            f"Sec-WebSocket-Key: {key}", *([f"Origin: {origin}"] if origin is not None else []), *more])[0]

    def say(self, payload, opcode=2):
        self.send(frame(payload, opcode))

    def hear(self):
        """The next binary message; Closed when the server closes. Answers no pings: it sends none."""
        while True:
            first, length = self.read(2)
            if length == 126:
                length, = struct.unpack(">H", self.read(2))
            elif length == 127:
                length, = struct.unpack(">Q", self.read(8))
            payload = self.read(length)
            if first & 15 == 8:
                raise Closed(struct.unpack(">H", payload[:2])[0] if len(payload) >= 2 else None)
            if first & 15 == 2:
                return payload


# Kinds of messages (docs/protocol.md).
HELLO, POSE, HAVE, DROPPED, PING = range(1, 6)
WELCOME, KEYFRAME, PONG, BYE = range(65, 69)
VERSION = 1


def message(kind, layout, *values):
    return struct.pack("<BBH" + layout, kind, VERSION, 0, *values)


def hello(width=640, height=360):
    return message(HELLO, "IIIQ", width, height, 4096, 256 << 20)


def pose(step, eye=(0, 1.7, 8), turned=0.0):
    """A pose at `eye` that looks along -z, turned to the left by so many radians."""
    return message(POSE, "Id3d4f2f3f3fffQ", step, 1e3 * time.monotonic(), *eye, 0, math.sin(turned / 2), 0,
                   math.cos(turned / 2), 0.9, 16 / 9, 0, 0, 0, 0, 0, 0, 5, 0, 0)


def have(*ids):
    return message(HAVE, f"I{len(ids)}Q", len(ids), *ids)


def ping(number):
    return message(PING, "Id", 0, number)


def damaged(rng):
    """A few messages, of which at least the last is damaged."""
    sound = [hello(), pose(rng.randrange(100)), have(*range(rng.randrange(400))), ping(rng.random())]
    kind = rng.randrange(4)
    if kind == 0:
        return [rng.randbytes(rng.randrange(300))]
    text = bytearray(rng.choice(sound))
    if kind == 1:
        for _ in range(rng.randrange(1, 4)):
            text[rng.randrange(len(text))] ^= 1 << rng.randrange(8)
    elif kind == 2:
        del text[rng.randrange(len(text)):]
    else:
        text += rng.randbytes(rng.randrange(1, 400))
    return [sound[0], bytes(text)] if rng.randrange(2) else [bytes(text)]


class Walker:
    """A client that behaves: it walks a circle of 50 cm, and turns."""

    def __init__(self, port, target="/live", wrap=None, **handshake):
        self.client = Socket(port, wrap)
        status = self.client.open(target, **handshake)
        if status != 101:
            raise AssertionError(f"the server answers {status}")
        self.client.say(hello())
        welcome = self.client.hear()
        if welcome[0] != WELCOME or welcome[1] != VERSION:
            raise AssertionError(f"the server begins with {welcome[:4]}")
        self.start = struct.unpack_from("<3d", welcome, 80)
        self.steps = self.keyframes = self.bytes = 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.client.close()

    def pose(self):
        self.steps += 1
        angle = 0.05 * self.steps
        x, y, z = self.start
        return pose(self.steps, (x + 0.5 * math.sin(angle), y, z + 0.5 * math.cos(angle)), angle)

    def move(self):
        self.client.say(self.pose())

    def hear(self):
        """The next message, of which keyframes are counted and said to be there."""
        text = self.client.hear()
        self.bytes += len(text)
        if text[0] == KEYFRAME:
            self.keyframes += 1
            self.client.say(have(struct.unpack_from("<Q", text, 16)[0]))
        return text

    def step(self):
        """Moves, and hears what is sent until the server has answered."""
        self.move()
        self.client.say(ping(self.steps))
        while True:
            text = self.hear()
            if text[0] == PONG and struct.unpack_from("<d", text, 8)[0] == self.steps:
                return

    def look(self, keyframes=1):
        """Moves until so many more keyframes have come."""
        until = self.keyframes + keyframes
        deadline = time.monotonic() + PATIENCE_S
        while self.keyframes < until:
            if time.monotonic() > deadline:
                raise AssertionError(f"{keyframes} keyframes do not come: {self.keyframes} of {until}")
            self.step()
            time.sleep(0.01)
