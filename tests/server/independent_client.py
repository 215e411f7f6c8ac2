#!/usr/bin/python3
"""A camera and a viewer that share no code with Hermite: WebSocket by wsproto, protobuf and PNG by hand, from proto/README.md alone.

    independent_client.py path/to/hermite

Exit status 77 (skipped) without python3-wsproto.
"""
import hashlib
import json
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import zlib

from protobuf_by_hand import (CHUNK, CREDIT, ERROR, FINISH, FINISHED, FRAME, HELLO, PING, PONG, RESULT, SNAPSHOT_END, WELCOME, double, field, fields)

try:
    from wsproto import ConnectionType, WSConnection
    from wsproto.events import (AcceptConnection, BytesMessage, CloseConnection, Ping, Pong, RejectConnection, Request, TextMessage)
except ImportError:
    print("SKIPPED: python3-wsproto is not installed")
    sys.exit(77)

WIDTH, HEIGHT, FRAME_COUNT = 96, 72, 8
PATIENCE_S = 120


def hello_camera(token):
    camera = (field(1, WIDTH) + field(2, HEIGHT) + field(3, 80.0) + field(4, 80.0) + field(5, (WIDTH - 1) / 2) +
              field(6, (HEIGHT - 1) / 2) + field(7, 1000.0))
    start = (field(1, "independent") + field(2, camera) + field(3, bytes([2])) + field(4, bytes([2])) + field(5, 1) +
             field(6, field(1, "output.unstable") + field(2, "true")) + field(7, FRAME_COUNT))
    return field(HELLO, field(2, "independent_client.py") + field(3, token) + field(4, start))


def hello_viewer(token, scan_id):
    return field(HELLO, field(3, token) + field(5, field(1, scan_id)))


# ---- a scene, as PNG

def png(bit_depth, color_type, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, bit_depth, color_type, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) +
            chunk(b"IEND", b""))


def frame(sequence):
    """A camera that stands still before the inside of a pyramid, painted as a checkerboard."""
    depth = png(16, 0, [struct.pack(f">{WIDTH}H", *(1500 + sequence % 2 + 4 * abs(x - 40) + 6 * abs(y - 30) for x in range(WIDTH))) for y in range(HEIGHT)])
    color = png(8, 2, [b"".join(bytes([80 + 100 * ((x // 8 + y // 8) % 2), 2 * x, 3 * y]) for x in range(WIDTH)) for y in range(HEIGHT)])
    return field(FRAME, field(1, sequence) + field(2, 100 + sequence / 30) + field(3, depth) + field(4, color))


# ---- the connection

class Client:
    def __init__(self, port, headers=(), subprotocol="hermite.v1"):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)
        self.connection = WSConnection(ConnectionType.CLIENT)
        self.events = []
        self.close_code = None
        self.status = None
        self.send(Request(host=f"127.0.0.1:{port}", target="/api/v1/ws", subprotocols=[subprotocol] if subprotocol else [],
                          extra_headers=list(headers)))
        event = self.next_event()
        self.accepted = isinstance(event, AcceptConnection)
        self.status = 101 if self.accepted else getattr(event, "status_code", None)
        if self.accepted:
            check(event.subprotocol == "hermite.v1", "the server names the subprotocol")

    def send(self, event):
        self.socket.sendall(self.connection.send(event))

    def send_message(self, data, pieces=1):
        """One message in several WebSocket frames, with a ping between them."""
        size = -(-len(data) // pieces)
        for k in range(pieces):
            self.send(BytesMessage(data=data[k * size:(k + 1) * size], message_finished=k == pieces - 1))
            if k < pieces - 1:
                self.send(Ping(payload=b"between"))

    def next_event(self):
        while not self.events:
            data = self.socket.recv(65536)
            self.connection.receive_data(data or None)
            self.events = list(self.connection.events())
            if not data and not self.events:
                return None
        return self.events.pop(0)

    def messages(self):
        """(body number, fields) until the server closes."""
        data = b""
        while (event := self.next_event()) is not None:
            if isinstance(event, Ping):
                self.send(event.response())
            elif isinstance(event, CloseConnection):
                self.close_code = event.code
                return
            elif isinstance(event, BytesMessage):
                data += bytes(event.data)
                if event.message_finished:
                    (number, body), = fields(data).items()
                    yield number, fields(body)
                    data = b""
            else:
                check(isinstance(event, Pong), f"nothing but messages, pings and pongs: {event}")


failures = 0


def check(condition, what):
    global failures
    if not condition:
        failures += 1
        print("FAILED:", what)


def text(value):
    return bytes(value or b"").decode()


def stream_a_scan(port, token):
    """Returns the id of the finished scan."""
    client = Client(port)
    client.send_message(hello_camera(token), pieces=3)
    sent = granted = 0
    results, pongs, scan_id, report, trajectory, finish_sent = [], 0, "", None, b"", False
    client.send_message(field(99, b"of a newer client"))
    client.send_message(field(PING, field(1, 7)))
    for number, body in client.messages():
        if number == WELCOME:
            scan_id = text(body[3])
            check(body.get(6) == 2, "the one codec that was offered is chosen: PNG16")
            check(body[4] > WIDTH * HEIGHT * 5, "a raw frame fits into a message")
            granted = body[5]
        elif number == CREDIT:
            granted = max(granted, body[1])
        elif number == RESULT:
            results.append(body)
        elif number == PONG:
            pongs += body[1] == 7
        elif number == FINISHED:
            report, trajectory = json.loads(text(body[1])), bytes(body[2])
        elif number == ERROR:
            check(False, "no error: " + text(body.get(2)))
        while sent < min(granted, FRAME_COUNT):
            client.send_message(frame(sent), pieces=1 + sent % 4)
            sent += 1
        if sent == FRAME_COUNT and not finish_sent:
            client.send_message(field(FINISH, b""))
            finish_sent = True
    check(client.close_code == 1000, f"closed with 1000, not {client.close_code}")
    check(pongs == 1, "the ping was answered once")
    check([r.get(1, 0) for r in results] == list(range(FRAME_COUNT)), "one result a frame, in order")
    check(all(r.get(4) == 1 for r in results), "a still camera is tracked: " + "; ".join(text(r.get(5)) for r in results))
    if results:
        pose = fields(results[-1][3])
        position = [double(pose.get(k)) for k in (1, 2, 3)]
        check(all(abs(x) < 0.005 for x in position), f"a still camera stays within 5 mm: {position}")
    check(report is not None and report["frames"] == FRAME_COUNT, "the report counts the frames")
    if report:
        check(report["settings"]["output.unstable"] is True, "the setting was taken")
        check(report["trajectory_sha256"] == hashlib.sha256(trajectory).hexdigest(), "the report's hash is that of the trajectory")
    lines = [line for line in trajectory.decode().splitlines() if not line.startswith("#")]
    check([float(line.split()[0]) for line in lines] == [round(100 + k / 30, 6) for k in range(FRAME_COUNT)], "a line a frame, with its time")
    return scan_id


def view_the_scan(port, token, scan_id):
    client = Client(port)
    client.send_message(hello_viewer(token, scan_id))
    order, points = [], 0
    for number, body in client.messages():
        order.append(number)
        if number == CHUNK:
            points += body.get(3, 0)
            check(bytes(body.get(4, b"")).startswith(b"DRACO"), "chunks are Draco")
    check(order[:1] == [WELCOME] and SNAPSHOT_END in order, f"a viewer gets a snapshot: {order}")
    check(CHUNK in order and order.index(CHUNK) < order.index(SNAPSHOT_END), "the chunks come before its end")
    check(points > 500, f"the wall has points: {points}")
    check(client.close_code == 1000, "closed with 1000 when everything was sent")


def refused(port, message, code, what):
    client = Client(port)
    client.send(TextMessage(data=message) if isinstance(message, str) else BytesMessage(data=message))
    said = [text(body.get(1)) for number, body in client.messages() if number == ERROR]
    check(client.close_code == code, f"{what}: closed with {code}, not {client.close_code}")
    check(len(said) == 1, f"{what}: one error before the close: {said}")


def break_rules(port, token):
    refused(port, hello_camera("wrong"), 4001, "a wrong token")
    refused(port, hello_viewer(token, "nosuchscan"), 4004, "a scan that does not exist")
    refused(port, frame(0), 1002, "a frame before the hello")
    refused(port, b"\xff\xff\xff", 1007, "bytes that are no message")
    refused(port, "hello", 1003, "text")
    check(Client(port, [(b"Origin", b"http://evil.example")]).status == 403, "a page of another site is refused")
    check(not Client(port, subprotocol=None).accepted, "the subprotocol must be offered")
    mask = b"\0\0\0\0"
    for bytes_sent, code, what in (
            (b"\x82\x03abc", 1002, "no mask"),
            (b"\xf2\x80" + mask, 1002, "reserved bits"),
            (b"\x83\x80" + mask, 1002, "a reserved opcode"),
            (b"\x80\x80" + mask, 1002, "a continuation of nothing"),
            (b"\x09\x80" + mask, 1002, "a ping in fragments"),
            (b"\x89\xfe\x00\x7e" + mask + b"a" * 126, 1002, "a ping of 126 bytes"),
            (b"\x88\x81" + mask + b"a", 1002, "a close with half a code"),
            (b"\x88\x82" + mask + (999).to_bytes(2, "big"), 1002, "a close with a code that is none"),
            (b"\x81\x82" + mask + b"\xc3\x28", 1007, "text that is no UTF-8")):
        client = Client(port)
        client.socket.sendall(bytes_sent)
        list(client.messages())
        check(client.close_code == code, f"against RFC 6455, {what}: closed with {code}, not {client.close_code}")


def main():
    with tempfile.TemporaryDirectory() as data:
        server = subprocess.Popen([sys.argv[1], "serve", "--listen", "127.0.0.1:0", "--data", data], stdout=subprocess.PIPE, text=True)
        try:
            port, token = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/#token=(\S+)\n", server.stdout.readline()).groups()
            scan_id = stream_a_scan(int(port), token)
            break_rules(int(port), token)
            view_the_scan(int(port), token, scan_id)
            check(os.path.getsize(os.path.join(data, "scans", scan_id, "cloud.ply")) > 1000, "the cloud is on disk")
            check(server.poll() is None, "the server lives")
        finally:
            server.send_signal(signal.SIGTERM)
            check(server.wait(PATIENCE_S) == 0, "the server ends well")
    print("FAILED" if failures else "passed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
