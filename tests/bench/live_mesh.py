#!/usr/bin/python3
"""What the surface of a scan that runs costs, and how soon it is there. A measurement, no test.

    live_mesh.py path/to/hermite path/to/hermite-client SEQUENCE [--frames N] [--rounds 2]

The recording is streamed again and again, every frame of it, to a server with one viewer: of points and of the surface in turn. The same frames do
the same work, so times are compared frame by frame. Then it comes once as from a live camera, at its own rate and with frames left out, for how
long it takes from a frame's arrival to the pieces of the surface that show what it has changed. Prints Markdown.
"""
import argparse
import json
import os
import re
import selectors
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.request

sys.path[:0] = [os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", folder) for folder in ("faults", "server")]
from independent_client import CHUNK, HELLO, RESULT, double, field, fields  # noqa: E402
from programs import Server, free_port, wait_until  # noqa: E402
import viewers  # noqa: E402

MESH_CHUNK = 16
POINTS, SURFACE = 1, 2  # of Watch


def body_of(message):
    ((number, body),) = fields(message).items()
    return number, body


class Watcher(viewers.Viewer):
    """Of points or of the surface: counts bytes, and keeps the server's time of each frame."""

    def __init__(self, server, scan_id, what):
        viewers.hello_viewer = lambda token, scan: field(HELLO, field(3, token) + field(5, field(1, scan) + field(2, field(what, 1))))
        super().__init__(server.port, server.token(), scan_id, slow=False)
        self.bytes = {CHUNK: 0, MESH_CHUNK: 0}
        self.pieces = 0
        self.frame_ms = {}

    def take(self, message):
        super().take(message)
        number, body = body_of(message)
        if number in self.bytes:
            self.bytes[number] += len(message)
            self.pieces += 1
        if number == RESULT:
            result = fields(body)
            self.frame_ms[result.get(1, 0)] = double(result.get(10, b""))


def delays(admin_port):
    """{upper bound [s]: pieces of surface that took no longer}."""
    with urllib.request.urlopen(f"http://127.0.0.1:{admin_port}/metrics") as answer:
        text = answer.read().decode()
    return {float(bound): float(count) for bound, count in re.findall(r'hermite_mesh_delay_seconds_bucket\{le="([^"]+)"\} (\S+)', text)}


def quantile_s(buckets, share):
    """Within its bucket as if evenly spread."""
    wanted, below, low = share * max(buckets.values()), 0, 0.0
    for bound, count in sorted(buckets.items()):
        if count >= wanted:
            return low + (min(bound, 60) - low) * (wanted - below) / max(count - below, 1)
        below, low = count, bound
    return low


def processor_s(process):
    """Of all its threads since it began."""
    with open(f"/proc/{process.pid}/stat", encoding="ascii") as file:
        user, system = file.read().rsplit(")", 1)[1].split()[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


def one_scan(server, arguments, what, more):
    known = {scan["id"] for scan in server.scans()}
    command = ["--frames", f"0:{arguments.frames}"] if arguments.frames else []
    camera = subprocess.Popen([arguments.client, "stream", arguments.sequence, "--server", server.url, *more, *command],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    wait_until(lambda: any(scan["id"] not in known for scan in server.scans()), "the scan")
    scan_id = next(scan["id"] for scan in server.scans() if scan["id"] not in known)
    watcher = Watcher(server, scan_id, what)
    start, before_s, ready = time.monotonic(), processor_s(server.process), selectors.DefaultSelector()
    ready.register(watcher.client.socket, selectors.EVENT_READ)
    while camera.poll() is None and watcher.open:
        for _ in ready.select(0.02):
            watcher.read()
        if watcher.open:
            watcher.speak()
        if watcher.frame_ms:
            watcher.running_s = time.monotonic() - start
            watcher.processor_s = processor_s(server.process) - before_s
            watcher.running_bytes = dict(watcher.bytes)
    report = json.loads(camera.communicate()[0])
    watcher.client.socket.close()
    return watcher, (report["frames"], report["trajectory_sha256"], report["cloud_sha256"])


def compare(server, arguments):
    rounds = {POINTS: [], SURFACE: []}
    results = set()
    for _ in range(arguments.rounds):
        for what, watchers in rounds.items():
            watcher, result = one_scan(server, arguments, what, ["--rate", "max"])
            watchers.append(watcher)
            results.add(result)
    print("| one viewer of | ms a frame, median | whole scan [s] | processor time of the server [s] | kB a second to the viewer | pieces |")
    print("|---|---|---|---|---|---|")
    for what, name in ((POINTS, "points"), (SURFACE, "the surface")):
        watchers = rounds[what]
        times = [ms for watcher in watchers for ms in watcher.frame_ms.values()]
        seconds = statistics.median(watcher.running_s for watcher in watchers)
        work_s = statistics.median(watcher.processor_s for watcher in watchers)
        rate = statistics.median(sum(w.running_bytes.values()) / w.running_s / 1000 for w in watchers)
        print(f"| {name} | {statistics.median(times):.1f} | {seconds:.1f} | {work_s:.1f} | {rate:.0f} | {watchers[0].pieces} |")
    ratios = []
    for points, surface in zip(rounds[POINTS], rounds[SURFACE]):
        ratios += [surface.frame_ms[k] / points.frame_ms[k] for k in points.frame_ms.keys() & surface.frame_ms.keys() if points.frame_ms[k] > 0]
    whole = statistics.median(s.running_s / p.running_s for p, s in zip(rounds[POINTS], rounds[SURFACE]))
    print(f"\nWith the surface over without: {statistics.median(ratios):.3f} of a frame's time (median of {len(ratios)} pairs), {whole:.3f} of the scan's. "
          f"Poses and clouds are {'the same to the last bit' if len(results) == 1 else 'NOT THE SAME'}.")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("hermite")
    parser.add_argument("client")
    parser.add_argument("sequence")
    parser.add_argument("--frames", type=int, default=0, help="only the first so many")
    parser.add_argument("--rounds", type=int, default=2)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        admin_port = free_port()
        server = Server(arguments.hermite, os.path.join(folder, "data"),
                        ["--requests-per-second", "10000", "--admin-listen", f"127.0.0.1:{admin_port}"])
        compare(server, arguments)
        before = delays(admin_port)
        one_scan(server, arguments, SURFACE, ["--live"])
        live = {bound: count - before.get(bound, 0) for bound, count in delays(admin_port).items()}
        print(f"\nLive, from a frame's arrival to a piece that shows it: {max(live.values()):.0f} pieces, median {quantile_s(live, 0.5):.2f} s, "
              f"p95 {quantile_s(live, 0.95):.2f} s.")
        server.end(signal.SIGTERM)


if __name__ == "__main__":
    main()
