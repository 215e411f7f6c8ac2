#!/usr/bin/python3
"""Many viewers of one scan, with and without one behind a slow link. A measurement, no test.

    viewers.py path/to/hermite path/to/hermite-client [--viewers 32] [--rounds 3]

While a camera scans, each viewer asks for a Pong ten times a second and takes what comes, acknowledging as the browser does. Rounds with a viewer
that reads 100 kbit/s take turns with rounds without. Prints a Markdown table: round trips of all the others, and what a viewer costs the server.
"""
import os
import selectors
import signal
import socket
import statistics
import sys
import tempfile
import time

from programs import Camera, Server, argument_parser, resident_mb

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server"))
from independent_client import Client, hello_viewer  # noqa: E402
from protobuf_by_hand import PING, PONG, VIEWER_ACK, field, fields  # noqa: E402
from wsproto.events import BytesMessage, CloseConnection, Ping  # noqa: E402

SEQUENCE = "synthetic:frames=240,width=320,height=240,noise=kinect-white,seed=1"
ASK_EVERY_S = 0.1
SLOW_BYTES_PER_S = 100_000 / 8


class Viewer:
    def __init__(self, port, token, scan_id, slow):
        self.slow = slow
        self.client = Client(port)
        if slow:
            self.client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        self.client.send_message(hello_viewer(token, scan_id))
        self.client.socket.setblocking(False)
        self.received = self.acknowledged = self.asked = 0
        self.open = True
        self.asked_at = {}
        self.round_trips_ms = []
        self.data = b""
        self.next_ask = time.monotonic()
        self.next_read = time.monotonic()

    def read(self):
        now = time.monotonic()
        if self.slow and now < self.next_read:
            return
        try:
            data = self.client.socket.recv(1250 if self.slow else 1 << 20)
        except BlockingIOError:
            return
        if self.slow:
            self.next_read = now + len(data) / SLOW_BYTES_PER_S
        if not data:
            self.open = False
            return
        self.client.connection.receive_data(data)
        for event in self.client.connection.events():
            if isinstance(event, Ping):
                self.send(self.client.connection.send(event.response()))
            elif isinstance(event, CloseConnection):
                self.open = False
            elif isinstance(event, BytesMessage):
                self.data += bytes(event.data)
                if event.message_finished:
                    self.take(self.data)
                    self.data = b""

    def take(self, message):
        self.received += len(message)
        if message[0] == PONG << 3 | 2:
            (_, body), = fields(message).items()
            number = fields(body).get(1, 0)
            self.round_trips_ms.append(1000 * (time.monotonic() - self.asked_at.pop(number)))

    def send(self, data):
        try:
            self.client.socket.sendall(data)
        except OSError:
            self.open = False

    def speak(self):
        now = time.monotonic()
        if now < self.next_ask:
            return
        self.next_ask = now + ASK_EVERY_S
        self.asked += 1
        self.asked_at[self.asked] = now
        messages = [field(PING, field(1, self.asked))]
        if self.received > self.acknowledged:
            self.acknowledged = self.received
            messages.append(field(VIEWER_ACK, field(1, self.received)))
        for message in messages:
            self.send(self.client.connection.send(BytesMessage(data=message)))


def one_round(server, program, count, with_slow):
    """Round trips of the fast viewers [ms], and memory of the server with and without viewers [MB]."""
    known = {scan["id"] for scan in server.scans()}
    camera = Camera(program, server.url, SEQUENCE)
    while not (new := [scan["id"] for scan in server.scans() if scan["id"] not in known]):
        time.sleep(0.1)
    time.sleep(3)
    alone_mb = resident_mb(server.process)
    viewers = [Viewer(server.port, server.token(), new[0], with_slow and k == 0) for k in range(count)]
    selector = selectors.DefaultSelector()
    for viewer in viewers:
        selector.register(viewer.client.socket, selectors.EVENT_READ, viewer)
    most_mb = alone_mb
    while camera.process.poll() is None:
        for key, _ in selector.select(0.01):
            key.data.read()
        for viewer in viewers:
            if viewer.open:
                viewer.speak()
        most_mb = max(most_mb, resident_mb(server.process))
        for viewer in [v for v in viewers if not v.open and v.client.socket.fileno() >= 0]:
            selector.unregister(viewer.client.socket)
            viewer.client.socket.close()
    camera.result()
    times = [t for viewer in viewers if not viewer.slow for t in viewer.round_trips_ms]
    slow = [v.received for v in viewers if v.slow]
    fast = statistics.median(v.received for v in viewers if not v.slow)
    for viewer in viewers:
        viewer.client.socket.close()
    return times, (most_mb - alone_mb) / count, fast, slow[0] if slow else None


def main():
    parser = argument_parser()
    parser.add_argument("--viewers", type=int, default=32)
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    print("| viewers | one at 100 kbit/s | round trips | median ms | p95 ms | MB of the server for each, with the scan's own growth | MB received: median of the fast, the slow |")
    print("|---|---|---|---|---|---|---|")
    p95 = {False: [], True: []}
    with tempfile.TemporaryDirectory() as folder:
        server = Server(arguments.hermite, os.path.join(folder, "data"), settings=["--connections-per-address", "1000", "--requests-per-second", "10000"])
        for k in range(2 * arguments.rounds):
            with_slow = k % 2 == 1
            times, each_mb, fast, slow = one_round(server, arguments.client, arguments.viewers, with_slow)
            quantiles = statistics.quantiles(times, n=20)
            p95[with_slow].append(quantiles[-1])
            print(f"| {arguments.viewers} | {'yes' if with_slow else 'no'} | {len(times)} | {statistics.median(times):.2f} | {quantiles[-1]:.2f} | {each_mb:.1f} | "
                  f"{fast / 1e6:.1f}, {'-' if slow is None else f'{slow / 1e6:.2f}'} |", flush=True)
        server.end(signal.SIGTERM)
    ratio = statistics.median(p95[True]) / statistics.median(p95[False])
    print(f"\nmedian of p95 with the slow viewer over that without: {ratio:.3f}")


if __name__ == "__main__":
    main()
