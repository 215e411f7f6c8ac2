#!/usr/bin/python3
"""Many small scans, uploads and viewers, one after the other and beside each other, and what the server holds meanwhile.

    soak.py path/to/hermite path/to/hermite-client [--scans 2000] [--uploads 20] [--viewers 50] [--minutes M] [--plot FILE.svg]
            [--environment NAME=VALUE]
    soak.py path/to/hermite path/to/hermite-client --short                    20 scans, 2 uploads, 6 viewers: as in CTest

Passes when every scan and upload ends well, when at the end, as nobody is there any more, there are no more open files and threads than after a first
scan and upload, and when resident memory has not grown by GROWTH_MB since the first tenth (with --short since the first scan). `--minutes` ends it before all scans are done. Prints a line for
each twentieth of the scans or minutes; `--plot` draws all of them. Exit status 77 (skipped) without python3-wsproto.
"""
import json
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

from programs import PATIENCE_S, Server, argument_parser, check, failures, open_files, resident_mb

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server"))
from independent_client import Client, hello_viewer  # noqa: E402

SEQUENCE = "synthetic:frames=8,width=96,height=72,noise=kinect-white"
CAMERAS = 2  # at once
GROWTH_MB = 30  # lists and indexes of the database grow with every scan; a leak of a scan's buffers would be ten times that


def threads_of(process):
    return len(os.listdir(f"/proc/{process.pid}/task"))


class Soak:
    def __init__(self, arguments, folder):
        self.arguments = arguments
        for setting in arguments.environment:
            name, value = setting.split("=", 1)
            os.environ[name] = value
        self.server = Server(arguments.hermite, os.path.join(folder, "data"), settings=[
            "--max-scans", "4", "--requests-per-second", "10000", "--connections-per-address", "1000", "--log-level", "warn"])
        self.recording = os.path.join(folder, "recording.raw")
        subprocess.run([arguments.hermite, "convert", SEQUENCE, self.recording, "--to", "raw"], check=True, stdout=subprocess.DEVNULL)
        self.lock = threading.Lock()
        self.begun = self.done = 0
        self.scan_ids = []
        self.uploads_begun = 0
        self.deadline = time.monotonic() + 60 * arguments.minutes if arguments.minutes else float("inf")
        self.samples = []
        self.sample_at = 0
        self.resting = None  # files and threads when nobody is there

    def ended(self):
        return self.begun >= self.arguments.scans or time.monotonic() > self.deadline

    def cameras(self):
        while True:
            with self.lock:
                if self.ended():
                    return
                self.begun += 1
                number = self.begun
            self.scan(number)
            with self.lock:
                self.done += 1
            self.sample()

    def scan(self, number):
        command = [self.arguments.client, "stream", f"{SEQUENCE},seed={number}", "--server", self.server.url]
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, timeout=PATIENCE_S, check=False)
        check(done.returncode == 0, f"scan {number}: {done.stderr[-500:]}")

    def sample(self):
        with self.lock:
            if self.arguments.minutes:
                due = time.monotonic() >= self.sample_at
            else:
                due = self.done % max(1, self.arguments.scans // 20) == 0
            if due:
                self.sample_at = time.monotonic() + 60 * self.arguments.minutes / 20
                self.take_sample()

    def take_sample(self):
        process = self.server.process
        self.samples.append((self.done, resident_mb(process), open_files(process), threads_of(process)))
        print("%6d scans  %7.1f MB  %4d files  %4d threads" % self.samples[-1], flush=True)

    def upload(self):
        address = self.server.url.split("/#")[0]
        with open(self.recording, "rb") as file:
            bytes_ = file.read()
        self.uploads_begun += 1
        request = urllib.request.Request(f"{address}/api/v1/uploads/{self.uploads_begun}.raw", data=bytes_, method="PUT",
                                         headers={"Authorization": "Bearer " + self.server.token()})
        with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
            job = json.load(answer)["job"]
        while (state := self.server.ask("jobs/" + job)["state"]) in ("queued", "running"):
            time.sleep(0.2)
        check(state == "finished", f"upload {self.uploads_begun}: {state}")

    def uploads(self):
        begun_at = time.monotonic()
        for number in range(self.arguments.uploads):
            # Spread over the scans, or the time.
            def early(share=number / self.arguments.uploads):
                if self.arguments.minutes:
                    return time.monotonic() - begun_at < 60 * self.arguments.minutes * share
                return self.done < self.arguments.scans * share

            while early() and not self.ended():
                time.sleep(0.1)
            if self.ended():
                return
            self.upload()

    def viewers(self):
        """They come to scans that run and to those that have ended, take some messages and go, with and without a word."""
        chance = random.Random(1)
        open_ = []
        while not self.ended():
            scans = self.server.scans()[:20]
            if scans:
                client = Client(self.server.port)
                client.send_message(hello_viewer(self.server.token(), chance.choice(scans)["id"]))
                open_.append(client)
            while len(open_) > self.arguments.viewers or (open_ and chance.random() < 0.4):
                leaving = open_.pop(chance.randrange(len(open_)))
                if chance.random() < 0.5:
                    leaving.socket.shutdown(socket.SHUT_RDWR)
                leaving.socket.close()
            time.sleep(0.1)
        for client in open_:
            client.socket.close()

    def held(self):
        return open_files(self.server.process), threads_of(self.server.process)

    def run(self):
        self.scan(0)
        self.upload()
        time.sleep(2)
        self.resting = self.held()
        self.take_sample()
        threads = [threading.Thread(target=self.cameras) for _ in range(CAMERAS)]
        threads += [threading.Thread(target=self.uploads), threading.Thread(target=self.viewers)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        time.sleep(2)
        self.take_sample()
        # With few scans what those need that run at that moment is more than what a leak would be: samples at rest are compared.
        warm_at = 0 if self.arguments.short else 0.1 * self.done
        warm = next(sample for sample in self.samples if sample[0] >= warm_at)
        last = self.samples[-1]
        check(last[1] - warm[1] < GROWTH_MB, f"memory: {warm[1]:.1f} MB after {warm[0]} scans, {last[1]:.1f} MB after {last[0]}")
        deadline = time.monotonic() + PATIENCE_S / 10  # what vanished without a word is noticed a little later
        while any(now > before for now, before in zip(self.held(), self.resting)) and time.monotonic() < deadline:
            time.sleep(0.5)
        files, held_threads = self.held()
        check(files <= self.resting[0], f"open files: {self.resting[0]} after a first scan, {files} at the end")
        check(held_threads <= self.resting[1], f"threads: {self.resting[1]} after a first scan, {held_threads} at the end")
        check(self.server.process.poll() is None, "the server lives")
        if failures:
            print(self.server.tail())
        check(self.server.end(signal.SIGTERM) == 0, "the server ends well")
        if self.arguments.plot:
            self.draw(self.arguments.plot)

    def draw(self, path):
        """Memory over the scans, and below it files and threads, each from zero."""
        width, height, left = 640, 330, 60

        def line(column, top, bottom, colour):
            most = max(1, max(sample[column] for sample in self.samples))
            points = " ".join(f"{left + (width - left - 20) * sample[0] / max(1, self.done):.1f},{bottom - (bottom - top) * sample[column] / most:.1f}"
                              for sample in self.samples)
            return (f'<path d="M{left} {top}V{bottom}H{width - 20}" fill="none" stroke="gray"/><polyline fill="none" stroke="{colour}" points="{points}"/>'
                    f'<text x="{left - 5}" y="{top + 4}" text-anchor="end">{most:.0f}</text><text x="{left - 5}" y="{bottom}" text-anchor="end">0</text>')

        with open(path, "w", encoding="utf-8") as file:
            file.write(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">\n'
                       f'<rect width="{width}" height="{height}" fill="white"/>\n'
                       f'<text x="{left}" y="15">resident memory of the server [MB]</text>\n{line(1, 25, 180, "black")}\n'
                       f'<text x="{left}" y="205">open files (blue), threads (red)</text>\n{line(2, 215, 300, "blue")}\n{line(3, 265, 300, "red")}\n'
                       f'<text x="{width - 20}" y="{height - 8}" text-anchor="end">{self.done} scans, {self.uploads_begun} uploads</text></svg>\n')


def main():
    parser = argument_parser()
    parser.add_argument("--scans", type=int, default=2000)
    parser.add_argument("--uploads", type=int, default=20)
    parser.add_argument("--viewers", type=int, default=50, help="that are there at once, at most")
    parser.add_argument("--minutes", type=float, default=0)
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--plot")
    parser.add_argument("--environment", action="append", default=[], help="of the server: MALLOC_ARENA_MAX=1")
    with tempfile.TemporaryDirectory() as folder:
        arguments = parser.parse_args()
        if arguments.short:
            arguments.scans, arguments.uploads, arguments.viewers = 20, 2, 6
        Soak(arguments, folder).run()
    print("FAILED" if failures else "passed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
