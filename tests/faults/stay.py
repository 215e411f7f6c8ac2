#!/usr/bin/python3
"""A guest who stays: the server begins to close the connection since the share link was revoked, and the guest sends one message more, answers
the closing, and keeps the TCP connection.

    stay.py path/to/hermite path/to/hermite-client

Passes when the server lives, and no part of server and client has the assertion that ended it (server/CMakeLists.txt). Exit status 77 (skipped) without python3-wsproto.
"""
import os
import signal
import sys
import tempfile
import time

from programs import Server, argument_parser, check, verdict

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server"))
from independent_client import WELCOME, Client, hello_camera, hello_viewer, text  # noqa: E402

MASK = b"\0\0\0\0"
MESSAGE = b"\x82\x80" + MASK
WRONG_ASSERTION = b"ec == net::error::operation_aborted"
CLOSE = b"\x88\x82" + MASK + (1000).to_bytes(2, "big")


def welcomed(client):
    return next(body for number, body in client.messages() if number == WELCOME)


def main():
    arguments = argument_parser().parse_args()
    for program in (arguments.hermite, arguments.client):
        with open(program, "rb") as file:
            check(WRONG_ASSERTION not in file.read(), f"{program} was compiled without Boost's wrong assertion")
    with tempfile.TemporaryDirectory() as data:
        server = Server(arguments.hermite, data)
        camera = Client(server.port)
        camera.send_message(hello_camera(server.token()))
        scan_id = text(welcomed(camera)[3])
        share = server.ask(f"scans/{scan_id}/shares", "POST", {"name": "guest"})
        guest = Client(server.port)
        guest.send_message(hello_viewer(share["secret"], scan_id))
        welcomed(guest)
        server.ask(f"shares/{share['share']['id']}", "DELETE")
        list(guest.messages())
        check(guest.close_code == 4001, f"the guest is told why: {guest.close_code}")
        guest.socket.sendall(MESSAGE)
        time.sleep(0.3)  # so that the server has read it, and waits to read again, when the answer comes
        guest.socket.sendall(CLOSE)
        time.sleep(12)  # in silence; the server's patience is ten seconds
        check(server.process.poll() is None, "the server lives")
        if server.process.poll() is None:
            check(server.scans()[0]["id"] == scan_id, "and serves")
            server.end(signal.SIGKILL)  # it would wait for the camera
    return verdict()


if __name__ == "__main__":
    sys.exit(main())
