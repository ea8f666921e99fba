"""A page of `pellicle live` without a browser: starts the program, opens a WebSocket (RFC 6455), sends lines and reads messages."""
import base64
import json
import os
import re
import socket
import struct
import subprocess
import time
from pathlib import Path

PAGE = Path(__file__).resolve().parents[1] / "live/page.html"


class Program:
    """`pellicle live` with its words; it keeps its sessions below `state`."""

    def __init__(self, program, folder, *words):
        environment = {**os.environ, "XDG_STATE_HOME": str(folder / "state")}
        self.process = subprocess.Popen([program, "live", *words, "--no-open", "--page", PAGE], cwd=folder, env=environment, text=True,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.address = ""
        line = self.process.stdout.readline()
        found = re.match(r"live at http://127\.0\.0\.1:(\d+)/\?token=(\w+)\n", line)
        if not found:
            raise RuntimeError(f"'{line}' {self.process.stderr.read()}")
        self.port, self.token = int(found.group(1)), found.group(2)

    def end(self, number, seconds=10):
        """sends a signal; (exit status, seconds until then, what stands on stderr)"""
        start = time.monotonic()
        self.process.send_signal(number)
        status = self.process.wait(seconds)
        took = time.monotonic() - start
        self.process.stdout.close()
        return status, took, self.process.stderr.read()


class Page:
    def __init__(self, program):
        self.socket = socket.create_connection(("127.0.0.1", program.port), timeout=60)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(
            f"GET /?token={program.token} HTTP/1.1\r\nHost: 127.0.0.1:{program.port}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
            f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Protocol: pellicle\r\n\r\n".encode())
        self.bytes = b""
        while b"\r\n\r\n" not in self.bytes:
            self.receive()
        head, self.bytes = self.bytes.split(b"\r\n\r\n", 1)
        if not head.startswith(b"HTTP/1.1 101"):
            raise RuntimeError(head.decode())
        self.notices, self.count, self.frame = [], 0, {}

    def close(self):
        self.socket.close()

    def receive(self):
        more = self.socket.recv(1 << 20)
        if not more:
            raise ConnectionError("the server has closed")
        self.bytes += more

    def say(self, line):
        text, mask = line.encode(), os.urandom(4)
        size = bytes([0x80 | len(text)]) if len(text) < 126 else bytes([0x80 | 126]) + struct.pack(">H", len(text))
        self.socket.sendall(b"\x81" + size + mask + bytes(c ^ mask[i % 4] for i, c in enumerate(text)))

    def take(self, size):
        while len(self.bytes) < size:
            self.receive()
        taken, self.bytes = self.bytes[:size], self.bytes[size:]
        return taken

    def hear(self):
        """the head of the next message; the page takes each frame at once"""
        first, size = self.take(2)
        if size == 126:
            size = struct.unpack(">H", self.take(2))[0]
        elif size == 127:
            size = struct.unpack(">Q", self.take(8))[0]
        body = self.take(size)
        if first & 15 == 8:
            raise ConnectionError("the server says goodbye")
        if first & 15 == 2:
            length = struct.unpack("<I", body[:4])[0]
            body = body[4:4 + length]
        head = json.loads(body)
        if head["type"] == "frame":
            self.say("received")
            self.frame = head
        elif head["type"] == "notice":
            self.notices.append(head["text"])
        return head

    def answer(self, *lines):
        """says lines; (the frame that answers them, seconds until then)"""
        self.count += 1
        start = time.monotonic()
        for line in (*lines, f"echo {self.count}"):
            self.say(line)
        while self.hear().get("echo") != self.count:
            pass
        return self.frame, time.monotonic() - start

    def await_notice(self, words):
        while not any(words in text for text in self.notices):
            self.hear()
