#!/usr/bin/python3
"""Lets one call of a running server fail that changes something in its data folder: the first one, then the second one, and so on.

    every_disk_call.py path/to/hermite path/to/hermite-client path/to/libfailing_disk.so [--points 10 | --every K] [--seed 1] [--errors ENOSPC ...]
                       [--ways alone after] [--first N]

A point is the number of a call (tests/faults/failing_disk.cpp has which are counted), an error (ENOSPC, EIO, EDQUOT), and whether all calls after it
fail, too. At each of them a server begins in an empty folder: a camera streams, a recording is uploaded in two pieces and becomes a job, a
share link, a note and an export are made. Then the server ends, by SIGTERM or by SIGKILL, and another one starts on the same folder and a
disk that works. It passes when

the first server    lives until it is told to end, or says why it does not, and no client hears of a path of its folder
the second server   starts, and every frame and every byte of the upload is there that a client was told to be durable; the scan is finished
                    or interrupted and has all of its results, by itself; the job is done, after no more than being asked to be done again; link,
                    note and token are there if they were acknowledged; the audit log's chain holds; the upload, begun anew where nothing of it was
                    acknowledged, becomes a scan

What clients are told is read from the wire, by a proxy. Without --every so many points as --points says are taken, evenly spread over calls, errors and
both ways, others with another seed.
"""
import collections
import errno
import glob
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request

from frame_log import frames_in_log
from programs import PATIENCE_S, Camera, Proxy, Server, argument_parser, check, failures, verdict

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server"))
from protobuf_by_hand import CREDIT, RESUMED, WELCOME, fields  # noqa: E402

FRAMES = 6
SEQUENCE = f"synthetic:frames={FRAMES},width=96,height=72,seed=1"
UPLOADED_FRAMES = 4
SETTINGS = ("--drain", "0", "--admin-listen", "off", "--resume-window", "1", "--checkpoint-period", "100", "--requests-per-second", "1000")
A_WHILE_S = 120  # in which everything here ends by itself, on a machine that does much else
FILES = (("log of frames", r"scans/[^/]+/log(/|$)"), ("checkpoint", r"scans/[^/]+/checkpoint"), ("database", r"hermite\.db"), ("uploads, jobs", r"uploads|jobs"),
         ("audit log", r"audit"), ("results, exports", r"scans"), ("folder, token, lock", r""))


class Listener(Proxy):
    """Passes on everything, and keeps what the server says: all bytes, and of WebSockets what is durable."""

    def __init__(self, port):
        self.lock = threading.Lock()
        self.said = bytearray()
        self.scan = None
        self.durable_frames = 0
        super().__init__(port)

    def new_pair(self, near, far):
        return {"far": far, "unread": b"", "is_websocket": None}

    def forward(self, source, sink, pair):
        try:
            while data := source.recv(65536):
                if source is pair["far"]:
                    with self.lock:
                        self.hear(data, pair)
                sink.sendall(data)
        except OSError:
            pass
        for end in (source, sink):
            try:
                end.shutdown(2)
            except OSError:
                pass

    def hear(self, data, pair):
        self.said += data
        if pair["is_websocket"] is None:
            pair["is_websocket"] = data.startswith(b"HTTP/1.1 101")
            data = data.split(b"\r\n\r\n", 1)[1] if pair["is_websocket"] else b""
        if not pair["is_websocket"]:
            return
        unread = pair["unread"] + data
        while len(unread) >= 2:
            length, begin = unread[1] & 0x7F, 2
            if length >= 126:
                begin = 4 if length == 126 else 10
                length = int.from_bytes(unread[2:begin], "big")
            if len(unread) < begin + length:
                break
            if unread[0] == 0x82:
                self.understand(fields(unread[begin:begin + length]))
            unread = unread[begin + length:]
        pair["unread"] = unread

    def understand(self, message):
        if WELCOME in message:
            self.scan = fields(message[WELCOME])[3].decode()
        if CREDIT in message:
            self.durable_frames = max(self.durable_frames, fields(message[CREDIT]).get(2, 0))
        if RESUMED in message:
            self.durable_frames = max(self.durable_frames, fields(message[RESUMED]).get(3, 0))


class Api:
    """Requests, whose answers may be refusals."""

    def __init__(self, port, token):
        self.address, self.token = f"http://127.0.0.1:{port}/api/v1/", token

    def ask(self, method, path, body=None, headers=None, token=None):
        """(status, headers, bytes); status 0 where no answer came."""
        body = json.dumps(body).encode() if isinstance(body, dict) else body
        request = urllib.request.Request(self.address + path, data=body, method=method,
                                         headers={"Authorization": "Bearer " + (token or self.token), **(headers or {})})
        try:
            with urllib.request.urlopen(request, timeout=A_WHILE_S) as answer:
                return answer.status, answer.headers, answer.read()
        except urllib.error.HTTPError as refusal:
            return refusal.code, refusal.headers, refusal.read()
        except OSError:
            return 0, {}, b""

    def json(self, path):
        status, _, said = self.ask("GET", path)
        return json.loads(said) if status == 200 else None


def until(condition, limit_s=A_WHILE_S):
    """Whether it came true."""
    deadline = time.monotonic() + limit_s
    while not (true := condition()) and time.monotonic() < deadline:
        time.sleep(0.05)
    return bool(true)


class Upload:
    """By tus, in two pieces; keeps what was acknowledged."""

    def __init__(self, recording):
        with open(recording, "rb") as file:
            self.bytes = file.read()
        self.id = None
        self.acknowledged = 0

    def send(self, api):
        """Goes on, or begins. Whether all of it was taken."""
        tus = {"Tus-Resumable": "1.0.0"}
        if self.id is None:
            status, headers, _ = api.ask("POST", "uploads", headers={**tus, "Upload-Length": str(len(self.bytes))})
            if status != 201:
                return False
            self.id = headers["Location"].rsplit("/", 1)[1]
        half = len(self.bytes) // 2
        while self.acknowledged < len(self.bytes):
            end = half if self.acknowledged < half else len(self.bytes)
            status, headers, _ = api.ask("PATCH", "uploads/" + self.id, self.bytes[self.acknowledged:end], {
                **tus, "Content-Type": "application/offset+octet-stream", "Upload-Offset": str(self.acknowledged)})
            if status != 204:
                return False
            self.acknowledged = int(headers["Upload-Offset"])
        return True

    def is_kept(self, api):
        """After a restart: goes on from what is there."""
        status, headers, _ = api.ask("HEAD", "uploads/" + self.id, headers={"Tus-Resumable": "1.0.0"})
        kept = int(headers["Upload-Offset"]) if status == 200 else -1
        if kept < 0 and self.acknowledged == len(self.bytes):
            return api.json("jobs/" + self.id) is not None
        if kept < self.acknowledged:
            return False
        self.acknowledged = kept
        return True


class Point:
    """One call that fails, and what happens with and after it."""

    def __init__(self, arguments, folder, number, error, stays):
        self.arguments, self.number, self.error, self.stays = arguments, number, error, stays
        self.data = os.path.join(folder, "data")
        self.report = os.path.join(folder, "calls")
        self.recording = os.path.join(folder, "recording.raw")
        self.name = f"call {number} {error}{' and after' if stays else ''}"
        for path in (self.data, self.report, self.data + ".server.log"):
            shutil.rmtree(path, ignore_errors=True)
            if os.path.exists(path):
                os.unlink(path)
        self.link = self.note = self.token = None
        self.listener = self.camera_result = None
        self.scan_of_upload = None
        self.outcomes = []

    def check(self, condition, what):
        if not condition and not any(self.name in failure for failure in failures):
            print(self.calls()[-1:], self.failed_call())
            with open(self.data + ".server.log", encoding="utf-8") as log:
                print(log.read()[-4000:])
        check(condition, f"{self.name}: {what}")

    def calls(self):
        if not os.path.exists(self.report):
            return []
        with open(self.report, encoding="utf-8") as report:
            return report.read().splitlines()

    def failed_call(self):
        """"fdatasync hermite.db-wal", or None."""
        return next((line.split(" ", 1)[1].removesuffix(" failed") for line in self.calls() if line.endswith(" failed")), None)

    def run(self):
        environment = {"LD_PRELOAD": self.arguments.library, "HERMITE_DISK_FOLDER": self.data, "HERMITE_DISK_CALL": str(self.number),
                       "HERMITE_DISK_ERROR": str(getattr(errno, self.error)), "HERMITE_DISK_STAYS": "1" if self.stays else "0",
                       "HERMITE_DISK_REPORT": self.report}
        server = FaultyServer(self.arguments.hermite, self.data, settings=SETTINGS, environment=environment)
        try:
            if server.has_started:
                self.listener = Listener(server.port)
                self.token = server.token()
                self.use(server, Api(self.listener.port, self.token))
                self.end(server)
            else:
                self.not_started(server)
            server.environment = {}
            server.has_started = server.try_to_start()
            self.check(server.has_started, "the next server starts")
            if server.has_started:
                self.look(server, Api(server.port, server.token()))
                self.check(server.end(signal.SIGTERM) == 0, "the next server ends well")
            self.check_audit()
        finally:
            if server.process.poll() is None:
                server.process.kill()
                server.process.wait()
            server.log.close()
            if self.listener:
                self.listener.listener.close()

    def not_started(self, server):
        status = server.process.wait(A_WHILE_S)
        self.check(status == 1 and self.says_why(server), f"a server that does not start says why: {status}")
        self.outcomes.append("no start")

    def says_why(self, server):
        """The last line names something in the folder, or the folder, and the error, in SQLite's message where that has met it."""
        last = server.all_of_log().strip().splitlines()[-1:]
        messages = (os.strerror(getattr(errno, self.error)), "disk I/O error", "database or disk is full")
        return bool(last) and self.data in last[0] and any(message in last[0] for message in messages)

    def use(self, server, api):
        camera = Camera(self.arguments.client, f"http://127.0.0.1:{self.listener.port}/#token={self.token}", SEQUENCE)
        done = until(lambda: camera.process.poll() is not None or server.process.poll() is not None)
        self.check(done, f"the camera is told something: {camera.lines}")
        if camera.process.poll() is None:
            camera.process.kill()
        self.camera_result = camera.result()
        self.outcomes.append("scan finished" if self.camera_result else "scan ended" if self.listener.scan else "scan refused")
        upload = self.scan_of_upload = Upload(self.recording)
        sent = upload.send(api)
        if sent:
            until(lambda: server.process.poll() is not None or self.job_rests(api, upload.id))
            job = api.json("jobs/" + upload.id)
            self.outcomes.append("job " + (job["state"] if job else "unknown"))
        else:
            self.outcomes.append("upload begun" if upload.id else "upload refused")
        if not (scan := self.listener.scan):
            return
        status, _, said = api.ask("POST", f"scans/{scan}/shares", {"name": "of a test"})
        self.link = json.loads(said)["secret"] if status == 201 else None
        status, _, said = api.ask("POST", f"scans/{scan}/notes", {"position_m": [0, 0, 1], "text": "kept"})
        self.note = json.loads(said)["id"] if status == 201 else None
        status, _, _ = api.ask("POST", f"scans/{scan}/exports", {"format": "las"})
        if status in (200, 202):
            self.check(until(lambda: server.process.poll() is not None or self.export_rests(api, scan)), "the export ends, or says why it waits")
        self.outcomes += [name for name, made in (("link", self.link), ("note", self.note)) if not made]

    @staticmethod
    def job_rests(api, job):
        """It has ended, or waits for the disk."""
        told = api.json("jobs/" + job)
        return told is not None and (told["state"] not in ("queued", "running") or (told["state"] == "queued" and told["words"]))

    @staticmethod
    def export_of(api, scan):
        offers = api.json(f"scans/{scan}/exports")
        return next((offer for offer in offers["exports"] if offer["format"] == "las"), None) if offers else None

    def export_rests(self, api, scan):
        export = self.export_of(api, scan)
        return export is not None and (export["state"] not in ("queued", "running") or (export["state"] == "queued" and export["words"]))

    def end(self, server):
        died = server.process.poll()
        if died is not None:
            self.check(died == 1 and self.says_why(server), f"a server that ends says why: {died}")
            self.outcomes.append("server ended")
        else:
            is_kill = self.number % 2 == 1
            status = server.end(signal.SIGKILL if is_kill else signal.SIGTERM)
            self.check(is_kill or status == 0, f"the server ends well: {status}")
        with self.listener.lock:
            said = bytes(self.listener.said)
        self.check(self.data.encode() not in said, "no client hears of a path of the server: " + repr(said[max(0, said.find(self.data.encode()) - 200):][:300]))
        logs = glob.glob(os.path.join(self.data, "scans", self.listener.scan, "log")) if self.listener.scan else []
        frames = frames_in_log(logs[0]) if logs else 0
        self.check(frames >= self.listener.durable_frames, f"{self.listener.durable_frames} frames were durable, {frames} are in the log")

    def look(self, server, api):
        """At what the next server has."""
        self.check(self.token is None or self.token == server.token(), "the first token is the one that was printed")
        if self.scan_of_upload and self.scan_of_upload.id:
            self.check(self.scan_of_upload.is_kept(api), f"{self.scan_of_upload.acknowledged} bytes of the upload were acknowledged")
        upload = self.scan_of_upload or Upload(self.recording)
        self.check(upload.send(api), "the upload goes on")
        self.check(until(lambda: api.json("jobs/" + upload.id)["state"] not in ("queued", "running")), "the job ends")
        job = api.json("jobs/" + upload.id)
        if job["state"] == "failed":
            self.outcomes.append("job asked for again")
            status, _, said = api.ask("POST", f"jobs/{upload.id}/retry", b"")
            self.check(status == 200, f"the job can be tried again: {status} {said}")
            self.check(until(lambda: api.json("jobs/" + upload.id)["state"] not in ("queued", "running")), "the job ends")
            job = api.json("jobs/" + upload.id)
        self.check(job["state"] == "finished", f"the job is done: {job}")
        self.check(until(lambda: all(row["state"] != "running" and not row["to_be_rebuilt"] for row in api.json("scans")["scans"])), "scans have what they can")
        rows = {row["id"]: row for row in api.json("scans")["scans"]}
        if job["scan"] in rows:
            self.has_results(api, rows[job["scan"]], UPLOADED_FRAMES)
        if self.listener and self.listener.scan:
            self.look_at_scan(api, rows.get(self.listener.scan))
        # A row whose sync has failed may be in the database nevertheless; its scan was refused.
        others = set(rows) - {job["scan"], self.listener and self.listener.scan}
        self.check(not others, f"no other scan is there: {[rows[other] for other in others]}")

    def look_at_scan(self, api, row):
        self.check(row, "a scan whose camera was admitted is listed")
        if not row:
            return
        logs = glob.glob(os.path.join(self.data, "scans", row["id"], "log"))
        frames = frames_in_log(logs[0]) if logs else 0
        self.check(frames >= self.listener.durable_frames, f"{self.listener.durable_frames} frames were durable, {frames} are in the log now")
        if self.camera_result:
            self.check(frames == FRAMES or "frames are not kept" in row["words"], f"a camera has its result, {frames} frames are in the log: {row}")
        if "frames are not kept" in row["words"]:
            self.outcomes.append("says that frames are not kept")
        self.check(row["state"] == "finished" if self.camera_result else row["state"] in ("finished", "interrupted"), f"state: {row}")
        self.has_results(api, row, frames)
        if self.link:
            self.check(api.ask("GET", "scans/" + row["id"], token=self.link)[0] == 200, "the link opens its scan")
        if self.note:
            notes = api.json(f"scans/{row['id']}/notes")["notes"]
            self.check([note["id"] for note in notes] == [self.note] and notes[0]["text"] == "kept", f"the note is there: {notes}")
        if self.camera_result:
            status, _, said = api.ask("POST", f"scans/{row['id']}/exports", {"format": "las"})
            self.check(status in (200, 202), f"an export is made: {status} {said}")
            self.check(until(lambda: self.export_of(api, row["id"])["state"] == "ready"), "the export is ready")

    def has_results(self, api, row, frames):
        """Of all frames in its log, and perhaps of those that could not be written there."""
        processed = row["frames_processed"]
        self.check(frames <= processed <= row["frames_received"], f"all of the {frames} frames in its log are processed: {row}")
        if processed == 0:
            return
        status, _, trajectory = api.ask("GET", f"scans/{row['id']}/trajectory.txt")
        poses = [line for line in trajectory.decode().splitlines() if not line.startswith("#")] if status == 200 else []
        self.check(len(poses) == processed, f"{processed} frames have a pose: {status} {len(poses)} {row}")
        for name in ("cloud.ply", "report.json"):
            self.check(api.ask("GET", f"scans/{row['id']}/{name}")[0] == 200, f"there is {name}: {row}")

    def check_audit(self):
        done = subprocess.run([self.arguments.hermite, "audit", "--data", self.data], capture_output=True, text=True, check=False)
        self.check(done.returncode == 0, f"the audit log holds: {done.stderr}")


class FaultyServer(Server):
    has_started = False

    def start(self):
        self.has_started = self.try_to_start()


def points_of(arguments, call_count):
    """(number, error, stays) of those that are to be tried."""
    kinds = [(error, way == "after") for error in arguments.errors for way in arguments.ways]
    if arguments.every:
        return [(number, *kind) for index, kind in enumerate(kinds) for number in range(1 + (index + arguments.seed) % arguments.every, call_count + 1, arguments.every)]
    # The places of a point are shifted by the golden ratio, so that the seeds' places differ.
    shift = arguments.seed * 0.618034 % 1
    return [(1 + int((index + shift) / arguments.points * call_count), *kinds[index % len(kinds)]) for index in range(arguments.points)]


def file_of(failed_call):
    return next(name for name, pattern in FILES if re.search(pattern, failed_call.split(" ", 1)[1]))


def main():
    parser = argument_parser()
    parser.add_argument("library")
    parser.add_argument("--points", type=int, default=10)
    parser.add_argument("--every", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=1, help="leaves out the calls before it")
    parser.add_argument("--errors", nargs="+", default=["ENOSPC", "EIO", "EDQUOT"])
    parser.add_argument("--ways", nargs="+", default=["alone", "after"])
    arguments = parser.parse_args()
    arguments.library = os.path.abspath(arguments.library)
    table = collections.defaultdict(collections.Counter)
    begun_at = time.monotonic()
    # In memory: the syncs of a real disk take most of the time, and are not what fails here.
    with tempfile.TemporaryDirectory(dir="/dev/shm" if os.access("/dev/shm", os.W_OK) else None) as folder:
        folder = os.path.realpath(folder)
        subprocess.run([arguments.hermite, "convert", SEQUENCE.replace(str(FRAMES), str(UPLOADED_FRAMES), 1), os.path.join(folder, "recording.raw"), "--to", "raw"],
                       check=True, stdout=subprocess.DEVNULL)
        undisturbed = Point(arguments, folder, 0, "ENOSPC", False)
        undisturbed.run()
        call_count = len(undisturbed.calls())
        check(undisturbed.outcomes == ["scan finished", "job finished"], f"without a failure: {undisturbed.outcomes}")
        check(call_count > 100, f"only {call_count} calls were counted")
        print(f"{call_count} calls without a failure", flush=True)
        points = [point for point in points_of(arguments, call_count) if point[0] >= arguments.first] if not failures else []
        failed_count = 0
        for number, error, stays in points:
            point = Point(arguments, folder, number, error, stays)
            point.run()
            if failed := point.failed_call():
                failed_count += 1
                table[file_of(failed), "all after" if stays else "alone"][", ".join(point.outcomes)] += 1
            print(f"{point.name}: {failed}: {', '.join(point.outcomes)}", flush=True)
    for (file, way), outcomes in sorted(table.items()):
        print(f"| {file} | {way} | {sum(outcomes.values())} | " + "; ".join(f"{count} {outcome}" for outcome, count in outcomes.most_common()) + " |")
    check(failed_count >= 0.8 * len(points), f"at {failed_count} of {len(points)} points a call has failed")
    print(f"{len(points)} points, {time.monotonic() - begun_at:.0f} s")
    return verdict()


if __name__ == "__main__":
    sys.exit(main())
