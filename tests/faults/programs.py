"""The real programs, for the tests that break things around them."""
import argparse
import glob
import json
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request

FRAMES = 40
SEQUENCE = f"synthetic:frames={FRAMES},width=160,height=120,noise=kinect-white,seed=1"
RATE_HZ = 20
PATIENCE_S = 300


class Server:
    def __init__(self, program, data, settings=(), host="127.0.0.1", environment=None):
        """`settings`: more arguments. `environment`: more variables of it."""
        with socket.create_server((host, 0), family=socket.AF_INET6 if ":" in host else socket.AF_INET) as free:
            self.port = free.getsockname()[1]
        listen = f"[{host}]:{self.port}" if ":" in host else f"{host}:{self.port}"
        self.command = [program, "serve", "--listen", listen, "--data", data, "--mesh-on-demand", *settings]
        self.log = open(data + ".server.log", "a+", encoding="utf-8")
        self.environment = environment or {}
        self.process = None
        self.url = None
        self.start()

    def try_to_start(self):
        """Whether it has started."""
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=self.log, text=True, env={**os.environ, **self.environment})
        self.url = self.process.stdout.readline().strip()
        return self.url.startswith("http")

    def start(self):
        if not self.try_to_start():
            sys.exit("the server did not start: " + self.tail())

    def ask(self, path, method="GET", body=None):
        """JSON of the API."""
        address = self.url.split("/#token=")[0]
        request = urllib.request.Request(address + "/api/v1/" + path, data=body and json.dumps(body).encode(), method=method,
                                         headers={"Authorization": "Bearer " + self.token()})
        with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
            return json.load(answer)

    def token(self):
        return self.url.split("#token=")[1]

    def scans(self):
        return self.ask("scans")["scans"]

    def end(self, how):
        self.process.send_signal(how)
        status = self.process.wait(PATIENCE_S)
        self.process.stdout.close()
        return status

    def end_well(self):
        """As the last check of a test; with its last message where something has failed before."""
        if failures:
            print(self.tail())
        check(self.end(signal.SIGTERM) == 0, "the server ends well")

    def all_of_log(self):
        self.log.seek(0)
        return self.log.read()

    def tail(self):
        return self.all_of_log()[-3000:]


class Camera:
    def __init__(self, program, url, sequence=SEQUENCE, settings=()):
        """`settings`: more arguments."""
        command = [program, "stream", sequence, "--server", url, "--rate", str(RATE_HZ), "--set", "map.stable_confidence=1", *settings]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.lines = []
        self.out = ""
        self.threads = [threading.Thread(target=self.read_lines), threading.Thread(target=self.read_out)]
        for thread in self.threads:
            thread.start()

    def read_lines(self):
        for line in self.process.stderr:
            self.lines.append(line)

    def read_out(self):
        self.out = self.process.stdout.read()

    def result(self):
        status = self.process.wait(PATIENCE_S)
        for thread in self.threads:
            thread.join()
        if status != 0:
            return None
        report = json.loads(self.out)
        return report["frames"], report["trajectory_sha256"], report["cloud_sha256"]


def free_port():
    with socket.create_server(("127.0.0.1", 0)) as free:
        return free.getsockname()[1]


def wait_until(condition, what):
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        if time.monotonic() > deadline:
            sys.exit("never: " + what)
        time.sleep(0.02)


def stream_until(server, client, count):
    """A camera, and its scan, of which so many frames have come."""
    known = {scan["id"] for scan in server.scans()}
    camera = Camera(client, server.url)

    def news():
        return [scan for scan in server.scans() if scan["id"] not in known]

    wait_until(lambda: any(scan["frames_received"] >= count for scan in news()), f"{count} frames")
    return camera, news()[0]["id"]


def readiness(port):
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/readyz", timeout=PATIENCE_S) as answer:
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as refusal:
        return refusal.code, refusal.read().decode()


def log_of(data, scan):
    (log,) = glob.glob(os.path.join(data, "scans", scan, "log"))
    return log


class Proxy:
    """Between cameras and a server. What becomes of the bytes is said by forward()."""

    def __init__(self, port):
        self.server_port = port
        self.upward_bytes = 0
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                near, _ = self.listener.accept()
            except OSError:
                return
            far = socket.create_connection(("127.0.0.1", self.server_port))
            pair = self.new_pair(near, far)
            for source, sink in ((near, far), (far, near)):
                threading.Thread(target=self.forward, args=(source, sink, pair), daemon=True).start()

    def new_pair(self, near, far):
        """What the two directions of a connection share."""
        raise NotImplementedError

    def forward(self, source, sink, pair):
        """One direction of a connection until its end, on a thread of its own."""
        raise NotImplementedError


def argument_parser():
    """The programs; a test adds what else it takes."""
    parser = argparse.ArgumentParser()
    parser.add_argument("hermite")
    parser.add_argument("client")
    return parser


def open_files(process):
    return len(os.listdir(f"/proc/{process.pid}/fd"))


def resident_mb(process):
    with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
        return int(re.search(r"VmRSS:\s+(\d+)", status.read())[1]) / 1000


def durable_said(lines):
    """What the client was told to be durable, each time that it lost its connection."""
    return [int(found[1]) for line in lines if (found := re.search(r"connection lost with (\d+) frames durable", line))]


def verdict():
    """Said, and as an exit status."""
    print("FAILED" if failures else "passed")
    return 1 if failures else 0


failures = []


def check(condition, what):
    if not condition:
        failures.append(what)
        print("FAILED:", what, flush=True)
