#!/usr/bin/python3
"""What is small and claims or becomes much: messages, images, requests, archives and recordings, thrown at a server that runs.

    bombs.py path/to/hermite path/to/hermite-client

Prints a table of what the server answered and by how much its memory grew at the worst. Passes when each is refused with a message or by the right
code, no growth is beyond what the thing may take, and the server lives and serves. Exit status 77 (skipped) without python3-wsproto.
"""
import io
import json
import os
import socket
import struct
import subprocess
import sys
import tarfile
import tempfile
import time
import zipfile
import zlib

from programs import PATIENCE_S, Camera, Server, argument_parser, check, verdict

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server"))
from independent_client import (ERROR, FRAME, HELLO, RESULT, WELCOME, BytesMessage, Client, field, fields, frame, hello_camera, text)  # noqa: E402

# Buffers of sockets, of the log and of the images of one frame; a scan's pipeline is there before the bomb.
MESSAGE_MB = 64
DISCARD = 8  # of proto/scan.proto
# And what an archive is unpacked through, an index of a recording's frames; with a sanitizer, which keeps what was freed for a while, 84 were seen.
FILE_MB = 256


class Memory:
    """By how much the resident set of a process grew at the worst."""

    def __init__(self, process):
        self.folder = f"/proc/{process.pid}/"
        self.before_kb = 0

    def begin(self):
        self.rest()
        with open(self.folder + "clear_refs", "w", encoding="ascii") as file:
            file.write("5")  # the peak begins anew
        self.before_kb = self.kilobytes("VmRSS")

    def rest(self):
        """What began before is over, or has had 20 s: a camera that answers no ping is let go after 45."""
        before, deadline = -1000, time.monotonic() + 20
        while abs((now := self.kilobytes("VmRSS")) - before) > 500 and time.monotonic() < deadline:
            before = now
            time.sleep(1)

    def kilobytes(self, name):
        with open(self.folder + "status", encoding="ascii") as file:
            return next(int(line.split()[1]) for line in file if line.startswith(name + ":"))

    def growth_mb(self):
        return (self.kilobytes("VmHWM") - self.before_kb) / 1000


def png(width, height, bit_depth, color_type, bytes_per_pixel, rows):
    """Black. `rows` of them are there, whatever the header says."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    packer = zlib.compressobj(9)
    packed = b"".join(packer.compress(bytes(1 + width * bytes_per_pixel)) for _ in range(rows)) + packer.flush()
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bit_depth, color_type, 0, 0, 0)) +
            chunk(b"IDAT", packed) + chunk(b"IEND", b""))


# ---- each takes the server and the memory, which is measured from just before, and says (bytes sent, what it would become, the answer)

def frame_with(depth=None, color=None):
    good = fields(fields(frame(0))[FRAME])
    return field(FRAME, field(1, 1) + field(2, 101.0) + field(3, depth or bytes(good[3])) + field(4, color or bytes(good[4])))


def images(depth, color, what):
    """The second frame of a scan. One that cannot be read is said to be one, and the scan goes on."""
    def throw(server, memory):
        client = Client(server.port)
        client.send_message(hello_camera(server.token()))
        bomb, said = frame_with(depth, color), ""
        for number, body in client.messages():
            if number == WELCOME:
                client.send_message(frame(0))
            elif number == RESULT and not body.get(1):
                memory.begin()  # what a scan takes is there
                client.send_message(bomb)
            elif number == ERROR:
                said = text(body.get(2))
                check(body.get(4) == 1, f"it is about the frame: {said}")
                client.send_message(field(DISCARD, b""))
        check(said != "", f"an answer to {what}")
        return len(bomb), what, said
    return throw


def first_message(message, code, what):
    def throw(server, _memory):
        client = Client(server.port)
        client.send(BytesMessage(data=message))
        said = [text(body.get(2)) for number, body in client.messages() if number == ERROR]
        check(client.close_code == code, f"{what}: closed with {client.close_code}")
        return len(message), what, f"{client.close_code}: {' '.join(said)}"
    return throw


def huge_camera():
    camera = b"".join(field(number, 100_000) for number in (1, 2)) + b"".join(field(number, 500.0) for number in (3, 4, 5, 6, 7))
    return field(1, "bomb") + field(2, camera) + field(3, bytes([2])) + field(4, bytes([2])) + field(5, 1)


def hello_that_is_a_bomb(server, memory):
    return first_message(field(HELLO, field(3, server.token()) + field(4, huge_camera())), 1002, "a camera of 100000 x 100000 pixels")(
        server, memory)


def raw_websocket(data, what, code, repeat=1, first=b""):
    """Bytes behind the handshake, until the server closes."""
    def throw(server, _memory):
        client = Client(server.port)
        client.socket.sendall(first)
        sent = len(first)
        try:
            for _ in range(repeat):
                client.socket.sendall(data)
                sent += len(data)
        except OSError:
            pass  # closed, with bytes of ours on the way
        try:
            list(client.messages())
        except OSError:
            pass
        check(client.close_code in (code, None), f"{what}: closed with {client.close_code}")
        return sent, what, f"closed{f' with {client.close_code}' if client.close_code else ''}"
    return throw


def request(head, what, body=b"", repeat=0):
    def throw(server, _memory):
        sent = 0
        with socket.create_connection(("127.0.0.1", server.port), timeout=PATIENCE_S) as end:
            try:
                for piece in [head.replace("TOKEN", server.token()).encode(), *[body] * max(repeat, 1)]:
                    end.sendall(piece)
                    sent += len(piece)
            except OSError:
                pass
            try:
                answer = end.recv(4096).split(b"\r\n")[0].decode()
            except OSError:
                answer = "closed"
        check(not answer.startswith("HTTP/1.1 2"), f"{what}: {answer}")
        return sent, what, answer or "closed"
    return throw


def job(folder, client, name, make, what):
    """An upload becomes a job, which fails with a message."""
    def throw(server, _memory):
        path = os.path.join(folder, name)
        make(path)
        process = subprocess.run([client, "upload", path, "--title", name, "--no-check", "--json", "--server", server.url],
                                 capture_output=True, text=True, timeout=PATIENCE_S, env={**os.environ, "XDG_STATE_HOME": folder + "/state"})
        size = os.path.getsize(path)
        os.remove(path)
        if process.returncode != 0:
            check(False, f"{what}: {process.stdout} {process.stderr}")
            return size, what, "not taken"
        number = json.loads(process.stdout)["job"]
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            state = next(one for one in server.ask("jobs")["jobs"] if one["id"] == number)
            if state["state"] not in ("queued", "running"):
                break
            time.sleep(0.05)
        check(state["state"] == "failed" and state["words"], f"{what}: {state}")
        return size, what, f"{state['state']}: {state['words']}"
    return throw


def zip_of_zeros(path):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as file, file.open("depth/0.png", "w", force_zip64=True) as entry:
        for _ in range(1000):
            entry.write(bytes(1_000_000))


def tar_of_zeros(path):
    with tarfile.open(path, "w:gz", compresslevel=9) as file:
        info = tarfile.TarInfo("depth/0.png")
        info.size = 1_000_000_000

        class Zeros(io.RawIOBase):
            def read(self, size=-1):
                return bytes(size)
        file.addfile(info, Zeros())


def tar_of_many(path):
    with tarfile.open(path, "w:gz", compresslevel=1) as file:
        for number in range(250_000):
            file.addfile(tarfile.TarInfo(f"depth/{number}.png"))


def klg_of_many(path):
    with open(path, "wb") as file:
        file.write(struct.pack("<i", 2**31 - 1) + struct.pack("<qii", 1, 2**31 - 1, 2**31 - 1) + bytes(64))


def sens_of_many(path):
    matrix = struct.pack("<16f", 500, 0, 320, 0, 0, 500, 240, 0, 0, 0, 1, 0, 0, 0, 0, 1)
    with open(path, "wb") as file:
        file.write(struct.pack("<IQ", 4, 4) + b"Bomb" + 4 * matrix + struct.pack("<iiIIIIf", 2, 1, 60000, 60000, 60000, 60000, 1000.0) +
                   struct.pack("<Q", 2**60))


def bombs(folder, client):
    """(most megabytes that it may take, what throws it)"""
    mask = b"\0\0\0\0"
    settings = field(1, "bomb") + b"".join(field(6, field(1, f"key{k}") + field(2, "1")) for k in range(8000))
    post = "POST /api/v1/{} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer TOKEN\r\nContent-Type: application/json\r\n"
    messages = [
        images(png(60000, 60000, 16, 0, 2, 1), None, "depth that says 60000 x 60000 pixels"),
        images(png(6000, 6000, 16, 0, 2, 6000), None, "depth of 6000 x 6000 pixels, 72 MB"),
        images(None, png(5000, 5000, 8, 2, 3, 5000), "colour of 5000 x 5000 pixels, 75 MB"),
        hello_that_is_a_bomb,
        first_message(field(HELLO, field(4, settings)), 1009, "a hello of 100 kB of settings"),
        raw_websocket(b"\x82\xff" + struct.pack(">Q", 2**62) + mask, "a message of 2^62 bytes", 1009),
        raw_websocket(b"\x00\xfe" + struct.pack(">H", 1000) + mask + bytes(1000), "a message in pieces without end", 1009, 100_000, b"\x02\x80" + mask),
        raw_websocket(1000 * (b"\x89\x80" + mask), "a million pings and no hello", 1006, 1000),
        request("GET / HTTP/1.1\r\nHost: localhost\r\n", "a header of 100 MB", b"X-Bomb: " + b"a" * 1000 + b"\r\n", 100_000),
        request(post.format("jobs") + f"Content-Length: {2**62}\r\n\r\n", "a body of 2^62 bytes", b"[" * 1000, 10_000),
        request(post.format("jobs") + "Transfer-Encoding: chunked\r\n\r\n", "a chunk of 2^60 bytes", b"1000000000000000\r\n" + b"[" * 1000),
        request(post.format("jobs") + "Content-Length: 60000\r\n\r\n", "JSON 60000 deep", b"[" * 60_000),
    ]
    files = [
        job(folder, client, "zeros.zip", zip_of_zeros, "a .zip of 1 GB of zeros"),
        job(folder, client, "zeros.tar.gz", tar_of_zeros, "a .tar.gz of 1 GB of zeros"),
        job(folder, client, "many.tar.gz", tar_of_many, "a .tar.gz of 250000 empty files"),
        job(folder, client, "many.klg", klg_of_many, "a .klg of 2^31 frames of 2 GB"),
        job(folder, client, "many.sens", sens_of_many, "a .sens of 2^60 frames of 60000 x 60000 pixels"),
    ]
    return [(MESSAGE_MB, throw) for throw in messages] + [(FILE_MB, throw) for throw in files]


def main():
    arguments = argument_parser().parse_args()
    with tempfile.TemporaryDirectory() as folder:
        server = Server(arguments.hermite, os.path.join(folder, "data"))
        undisturbed = Camera(arguments.client, server.url).result()  # and the memory of a first scan is no growth
        print("| what | bytes sent | answer | memory grew by [MB] |\n|---|---|---|---|")
        for limit_mb, throw in bombs(folder, arguments.client):
            memory = Memory(server.process)
            memory.begin()
            sent, what, answer = throw(server, memory)
            if server.process.poll() is not None:
                check(False, f"the server lives after {what}")
                break
            growth_mb = memory.growth_mb()
            print(f"| {what} | {sent} | {answer[:150]} | {growth_mb:.1f} |", flush=True)
            check(growth_mb <= limit_mb, f"{what} takes {growth_mb:.0f} MB, more than {limit_mb}")
        check(Camera(arguments.client, server.url).result() == undisturbed, "a scan afterwards has the result of one before")
        server.end_well()
    return verdict()


if __name__ == "__main__":
    sys.exit(main())
