#!/usr/bin/python3
"""Many at once: more cameras than places, and connections that come and go.

    crowd.py path/to/hermite path/to/hermite-client [--cameras 8] [--connects 1000]

Passes when every camera finishes with the same result and those without a place were told to wait, and when after many connections of every
bad kind the server has as many open files as before and hardly more memory. An allocator may still fill its caches while the first of them come
and go (AddressSanitizer keeps up to 256 MB of freed memory); what leaks grows each time. So there are up to ROUNDS rounds, and one is flat.
Exit status 77 (skipped) without python3-wsproto.
"""
import os
import socket
import struct
import sys
import tempfile
import time

from programs import Camera, Server, argument_parser, check, open_files, resident_mb, verdict

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server"))
from independent_client import Client, hello_viewer  # noqa: E402

PLACES = 2
ROUNDS = 4
ROUND_GROWTH_MB = 8


def crowd_of_cameras(server, program, count):
    started = time.monotonic()
    cameras = [Camera(program, server.url) for _ in range(count)]
    most = 0
    while any(camera.process.poll() is None for camera in cameras):
        most = max(most, sum(scan["state"] == "running" for scan in server.scans()))
        time.sleep(0.2)
    results = [camera.result() for camera in cameras]
    waited = sum("no place on the server yet" in "".join(camera.lines) for camera in cameras)
    check(all(result is not None for result in results), f"every camera finishes: {results}")
    check(len(set(results)) == 1, f"all with the same result: {set(results)}")
    check(most <= PLACES, f"at most {PLACES} scans at once, not {most}")
    check(waited >= count - PLACES, f"{count - PLACES} were told to wait, not {waited}")
    print(f"{count} cameras, {PLACES} places: {waited} waited, all finished with one result, {time.monotonic() - started:.0f} s", flush=True)


def come_and_go(server, count, scan_id):
    """One after the other: nothing said, a request cut short, an upgrade and gone, no hello but noise, a wrong token, a viewer that is reset."""
    def plain():
        return socket.create_connection(("127.0.0.1", server.port), timeout=30)

    def reset(end):
        end.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        end.close()

    def cut():
        end = plain()
        end.sendall(b"GET /api/v1/scans HTTP/1.1\r\nHos")
        end.close()

    def upgrade_only():
        reset(Client(server.port).socket)

    def said(message):
        client = Client(server.port)
        client.send_message(message)
        list(client.messages())
        client.socket.close()

    def viewer():
        client = Client(server.port)
        client.send_message(hello_viewer(server.token(), scan_id))
        client.next_event()
        reset(client.socket)

    kinds = [lambda: plain().close(), lambda: reset(plain()), cut, upgrade_only, lambda: said(b"\xff\xff"), viewer]
    for k in range(count):
        kinds[k % len(kinds)]()


def state_of(process):
    """Open files and resident memory in MB, once the former is at rest."""
    before, deadline = -1, time.monotonic() + 60
    while (count := open_files(process)) != before and time.monotonic() < deadline:
        before = count
        time.sleep(1)
    return count, resident_mb(process)


def check_flat(server, count, scan_id):
    """Rounds of connections, until one leaves the memory as it was."""
    come_and_go(server, 60, scan_id)  # what is made once and kept
    for _ in range(ROUNDS):
        files_before, mb_before = state_of(server.process)
        come_and_go(server, count, scan_id)
        files, mb = state_of(server.process)
        print(f"{count} connections: open files {files_before} -> {files}, memory {mb_before:.1f} -> {mb:.1f} MB", flush=True)
        check(files <= files_before, "no open file is left")
        if mb - mb_before < ROUND_GROWTH_MB:
            return
    check(False, f"memory is flat in one of {ROUNDS} rounds")


def main():
    parser = argument_parser()
    parser.add_argument("--cameras", type=int, default=8)
    parser.add_argument("--connects", type=int, default=1000)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        # All come from one address.
        server = Server(arguments.hermite, os.path.join(folder, "data"), settings=[
            "--max-scans", str(PLACES), "--requests-per-second", "10000", "--connections-per-address", "1000"])
        crowd_of_cameras(server, arguments.client, arguments.cameras)
        check_flat(server, arguments.connects, server.scans()[0]["id"])
        check(server.process.poll() is None, "the server lives")
        server.end_well()
    return verdict()


if __name__ == "__main__":
    sys.exit(main())
