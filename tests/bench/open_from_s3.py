#!/usr/bin/python3
"""How long a scan takes to open whose results are in S3, beside one whose results are in the data folder. A measurement, no test.

    open_from_s3.py path/to/hermite path/to/hermite-client [--points 1000000] [--rounds 5]

Imports the same cloud into two servers of this machine, one with a real S3 server (OpenStack Swift in one process of Python), and prints
the median of each time, in milliseconds, as a Markdown table:

open      a viewer of a server that has just started: from its first message until it has all points
download  the whole cloud.ply over HTTP
a part    64 KiB from its middle, by Range, of a server that has just started
"""
import json
import os
import random
import signal
import statistics
import struct
import sys
import tempfile
import time
import urllib.request

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "faults"))
from programs import PATIENCE_S, Server, argument_parser, wait_until  # noqa: E402
from s3_results import Swift, key_file, settings_of  # noqa: E402
from viewers import VIEWER_ACK, BytesMessage, Viewer, field  # noqa: E402

IDLE_S = 0.5  # a viewer that has got nothing for so long has all


def write_cloud(path, count):
    """Points of a wavy surface of 10 m by 10 m, with normals and colours."""
    random.seed(1)
    header = ("ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % count
              + "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
              + "".join(f"property uchar {name}\n" for name in ("red", "green", "blue")) + "end_header\n")
    point = struct.Struct("<6f3B")
    with open(path, "wb") as file:
        file.write(header.encode("ascii"))
        for _ in range(count):
            x, y = random.uniform(-5, 5), random.uniform(-5, 5)
            file.write(point.pack(x, y, 0.01 * random.random(), 0, 0, 1, int(20 * (x + 5)), int(20 * (y + 5)), 128))


def ask(server, scan, path, headers=None):
    request = urllib.request.Request(f"{server.url.split('/#')[0]}/api/v1/scans/{scan}/{path}",
                                     headers={"Authorization": "Bearer " + server.token(), **(headers or {})})
    with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
        return answer.read()


def import_cloud(server, path):
    request = urllib.request.Request(server.url.split("/#")[0] + "/api/v1/uploads/cloud.ply", data=open(path, "rb"), method="PUT",
                                     headers={"Authorization": "Bearer " + server.token(), "Content-Length": str(os.path.getsize(path))})
    with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
        job = json.load(answer)["job"]
    wait_until(lambda: server.ask("jobs/" + job)["state"] in ("finished", "failed"), "the import ends")
    return server.ask("jobs/" + job)["scan"]


def ms_of(action):
    start = time.perf_counter()
    action()
    return 1000 * (time.perf_counter() - start)


def opened_ms(server, scan):
    start = time.perf_counter()
    viewer = Viewer(server.port, server.token(), scan, False)
    last, received = start, 0
    while viewer.open and time.perf_counter() - last < IDLE_S + (PATIENCE_S if received == 0 else 0):
        viewer.read()
        if viewer.received > received:
            received, last = viewer.received, time.perf_counter()  # an ended scan is closed once all is sent
            if not viewer.open:
                break
            viewer.send(viewer.client.connection.send(BytesMessage(data=field(VIEWER_ACK, field(1, received)))))
        else:
            time.sleep(0.0005)
    return 1000 * (last - start), received


def restart(server):
    server.end(signal.SIGTERM)
    server.start()


def measure(server, scan, rounds):
    """Medians by name, the bytes of the cloud, and those that a viewer gets."""
    times = {"open": [], "download": [], "a part": []}
    size = len(ask(server, scan, "cloud.ply"))
    sent = 0
    for _ in range(rounds):
        restart(server)
        part = {"Range": f"bytes={size // 2}-{size // 2 + 65535}"}
        times["a part"].append(ms_of(lambda: ask(server, scan, "cloud.ply", part)))
        restart(server)
        took_ms, sent = opened_ms(server, scan)
        times["open"].append(took_ms)
        times["download"].append(ms_of(lambda: ask(server, scan, "cloud.ply")))
    return {name: statistics.median(values) for name, values in times.items()}, size, sent


def main():
    parser = argument_parser()
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        cloud = os.path.join(folder, "cloud.ply")
        write_cloud(cloud, arguments.points)
        swift = Swift(os.path.join(folder, "swift"))
        settings = {"folder": [], "S3": ["--blobs", "s3://scans/bench", *settings_of(swift, key_file(folder))]}
        rows = {}
        for name, flags in settings.items():
            server = Server(arguments.hermite, os.path.join(folder, name), ["--admin-listen", "off", *flags])
            rows[name] = measure(server, import_cloud(server, cloud), arguments.rounds)
            server.end(signal.SIGTERM)
        swift.kill()
    times, size, sent = rows["folder"]
    print(f"{arguments.points} points: cloud.ply has {size / 1e6:.1f} MB, a viewer gets {sent / 1e6:.1f} MB\n")
    print("| results in | " + " | ".join(times) + " |\n" + "|---" * (1 + len(times)) + "|")
    for name, (values, *_) in rows.items():
        print(f"| {name} | " + " | ".join(f"{value:.0f} ms" for value in values.values()) + " |")


if __name__ == "__main__":
    main()
