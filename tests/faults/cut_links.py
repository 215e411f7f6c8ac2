#!/usr/bin/python3
"""Cuts the connection between camera and server again and again, and looks whether anything was lost.

    cut_links.py path/to/hermite path/to/hermite-client [--scans 3] [--seed 1]

A proxy between the two forwards in pieces of random size, down to single bytes, and after a random number of bytes drops both sides: with an
end (FIN) or without (RST), between messages or in their middle. Passes when every camera comes back by itself, trajectory and cloud have the
hashes of an undisturbed run, and the server has as many open files afterwards as before.
"""
import os
import random
import socket
import struct
import sys
import tempfile
import time

from programs import FRAMES, Camera, Proxy, Server, argument_parser, check, failures, open_files


# The upgrade and the hello have less. A camera that has not been told of its scan cannot come back to it, one that sends frames has.
HELLO_BYTES = 4000


class CuttingProxy(Proxy):
    """Cuts every connection once the first frame was on its way, while `cutting`."""

    def __init__(self, port, rng):
        self.rng = rng
        self.cutting = True
        self.cuts = 0
        super().__init__(port)

    def new_pair(self, near, far):
        # A frame has about 18 kB here: between the upgrade and some 15 frames.
        allowance = self.rng.choice([300, 3_000, 50_000, 300_000]) * self.rng.uniform(0.5, 1)
        abrupt = self.rng.random() < 0.5
        return {"far": far, "allowance": allowance, "abrupt": abrupt, "piece": self.rng.choice([1, 100, 65536])}

    def forward(self, source, sink, pair):
        piece = pair["piece"]
        try:
            while data := source.recv(65536):
                if sink is pair["far"]:
                    self.upward_bytes += len(data)
                if self.cutting and self.upward_bytes > HELLO_BYTES and pair["allowance"] < len(data):
                    sink.sendall(data[:max(0, int(pair["allowance"]))])
                    self.cuts += pair["allowance"] >= 0
                    pair["allowance"] = -1
                    break
                pair["allowance"] -= len(data)
                small = data[:64] if piece == 1 else b""
                for k in range(len(small)):
                    sink.sendall(small[k:k + 1])
                for k in range(len(small), len(data), max(piece, 100)):
                    sink.sendall(data[k:k + max(piece, 100)])
        except OSError:
            pass
        for end in (source, sink):
            try:
                if pair["abrupt"]:
                    end.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                else:
                    end.shutdown(socket.SHUT_RDWR)
                end.close()
            except OSError:
                pass


def settled(process, wanted):
    """The count when it has come down to `wanted`, or after 20 s."""
    deadline = time.monotonic() + 20
    while (count := open_files(process)) > wanted and time.monotonic() < deadline:
        time.sleep(0.1)
    return count


def main():
    parser = argument_parser()
    parser.add_argument("--scans", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        server = Server(arguments.hermite, os.path.join(folder, "data"))
        started = time.monotonic()
        expected = Camera(arguments.client, server.url).result()
        check(expected is not None and expected[0] == FRAMES, f"the undisturbed run: {expected}")
        before = open_files(server.process)
        cuts = 0
        for scan in range(arguments.scans):
            proxy = CuttingProxy(server.port, rng)
            camera = Camera(arguments.client, server.url.replace(str(server.port), str(proxy.port)))
            begun = time.monotonic()
            while camera.process.poll() is None and (proxy.cuts == 0 or time.monotonic() < begun + 10):
                time.sleep(0.05)
            proxy.cutting = False  # the waits between attempts grow; it shall come to an end
            result = camera.result()
            check(result == expected, f"scan {scan + 1}: {result} instead of {expected}\n" + "".join(camera.lines[-20:]))
            cuts += proxy.cuts
            proxy.listener.close()
        check(cuts >= arguments.scans, f"only {cuts} cuts: nothing was tested")
        check(settled(server.process, before) <= before, f"{open_files(server.process)} open files, {before} before")
        server.end_well()
        print(f"{cuts} cuts in {arguments.scans} scans of {FRAMES} frames, {time.monotonic() - started:.0f} s, seed {arguments.seed}: "
              f"{'FAILED' if failures else 'nothing lost, all results the same'}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
