#!/usr/bin/python3
"""What an operator relies on, from outside: settings, readiness, logs, the service manager's protocol, TLS with a certificate that changes, and
an end that lets scans finish. Runs the programs themselves.

    operators_test.py HERMITE HERMITE_CLIENT
"""
import http.client
import json
import os
import shutil
import signal
import socket
import ssl
import subprocess
import sys
import tempfile
import time
import unittest

HERMITE, CLIENT = sys.argv[1:3]
FRAMES = "synthetic:frames=12,width=160,height=120"
PATIENCE_S = 300  # with a machine that has much else to do


def check(fact, message):
    if not fact:
        raise AssertionError(message)


def settings(text):
    return dict(line.split(" = ", 1) for line in text.splitlines() if line and not line.startswith("#"))


def text_of(path):
    with open(path) as file:
        return file.read()


class Server:
    """`hermite serve` under a service manager that listens."""

    all = []

    def __init__(self, folder, *flags, **variables):
        self.manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.manager.bind("\0hermite-operators-%d-%s" % (os.getpid(), time.monotonic_ns()))
        self.manager.settimeout(60)
        environment = dict(os.environ, NOTIFY_SOCKET="@" + self.manager.getsockname()[1:].decode(), **variables)
        self.log_path = os.path.join(folder, "log")
        with open(self.log_path, "w") as log:
            self.process = subprocess.Popen(
                [HERMITE, "serve", "--listen", "127.0.0.1:0", "--admin-listen", "127.0.0.1:%d" % free_port(), "--data",
                 os.path.join(folder, "data"), *flags],
                stdout=subprocess.PIPE, stderr=log, text=True, env=environment)
        Server.all.append(self.process)
        self.url = self.process.stdout.readline().strip()
        check("#token=" in self.url, "no address: " + text_of(self.log_path))
        self.admin = int(self.process.args[self.process.args.index("--admin-listen") + 1].split(":")[1])

    def heard(self, start):
        """The next datagram that begins so; others are passed over."""
        while True:
            message = self.manager.recv(4096).decode()
            if message.startswith(start):
                return message

    def ask(self, path):
        connection = http.client.HTTPConnection("127.0.0.1", self.admin, timeout=PATIENCE_S)
        try:
            connection.request("GET", path)
            answer = connection.getresponse()
            return answer.status, answer.read().decode()
        finally:
            connection.close()

    def wait_ready(self):
        deadline = time.monotonic() + PATIENCE_S
        while True:
            status, message = self.ask("/readyz")
            if status == 200 or time.monotonic() > deadline:
                return status, message
            time.sleep(0.1)

    def end(self):
        code = self.process.wait(PATIENCE_S)
        self.manager.close()
        self.process.stdout.close()
        log = text_of(self.log_path)
        check(self.url.split("#token=")[1] not in log, "the token is in the log")
        return code, [json.loads(line) for line in log.splitlines()]


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def run(*command, **variables):
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, env=dict(os.environ, **variables))


def make_certificate(folder, name):
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "1", "-subj",
                    "/CN=" + name, "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", folder + "/key.pem", "-out", folder + "/cert.pem"],
                   check=True, capture_output=True)


def shown_certificate(port):
    return ssl.get_server_certificate(("127.0.0.1", port))


def check_top(server, scan):
    """`hermite-client top` shows the scan that runs, with its rate, and what the metrics say."""
    shown = run(CLIENT, "top", "--server", server.url, "--metrics", "http://127.0.0.1:%d" % server.admin, "--once", "--interval", "2")
    check(shown.returncode == 0, shown.stderr)
    lines = shown.stdout.splitlines()
    check("1 scan running" in lines[0] and "0 jobs running, 0 waiting" in lines[0], shown.stdout)
    check("GPU memory" in lines[1] and "ms from a frame's arrival" in lines[1], shown.stdout)
    row = next(line.split() for line in lines if scan in line)
    check(float(row[0]) > 0 and int(row[3]) > 0, shown.stdout)
    refused = run(CLIENT, "top", "--server", server.url.split("#")[0], "--token", "wrong", "--once")
    check(refused.returncode == 5 and "token" in refused.stderr, refused.stderr)


class Operators(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="hermite-operators-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def tearDown(self):
        for process in Server.all:
            process.kill()
            process.wait()
            process.stdout.close()
        Server.all.clear()

    def test_settings_come_from_file_environment_and_flags(self):
        folder = self.folder
        path = os.path.join(folder, "serve.toml")
        with open(path, "w") as file:
            file.write('max-scans = 2\ncredit-window = 3\ndrain = 7\nallow-host = ["a.example"]\ndata = "%s/with # and, comma"\n' % folder)
        printed = run(HERMITE, "serve", "--config", path, "--drain", "9", "--print-config", HERMITE_SERVE_CREDIT_WINDOW="5", HERMITE_SERVE_DRAIN="8")
        check(printed.returncode == 0, printed.stderr)
        known = settings(printed.stdout)
        check((known["max-scans"], known["credit-window"], known["drain"]) == ("2", "5", "9"), "file < environment < flag: %s" % known)
        check(known["allow-host"] == '["a.example"]', known["allow-host"])
        again = os.path.join(folder, "again.toml")
        with open(again, "w") as file:
            file.write(printed.stdout)
        check(run(HERMITE, "serve", "--config", again, "--print-config").stdout == printed.stdout, "what is printed reads back")
        check(run(HERMITE, "serve", "--print-config", HERMITE_SERVE_CONFIG=again).stdout == printed.stdout, "the file by the environment")
        twice = settings(run(HERMITE, "serve", "--allow-host", "a", "--allow-host", "b", "--print-config").stdout)
        check(twice["allow-host"] == '["a", "b"]', twice["allow-host"])
        for flags, text in [(["--max-scans", "0"], "setting max-scans is '0', allowed is 1 to 64"), (["--config", "/nowhere"], "/nowhere"),
                             (["--log-level", "loud"], "setting log-level is 'loud'"), (["--tls-key", "x"], "go together"),
                             (["--trusted-proxy", "x", "--data", folder], '--trusted-proxy: "x" is no address'),
                             (["--listen", "0.0.0.0:0", "--data", folder], "--tls-certificate")]:
            refused = run(HERMITE, "serve", *flags)
            check(refused.returncode in (1, 2) and text in refused.stderr, "%s: %s" % (flags, refused.stderr))

    def test_a_server_that_ends_lets_its_scan_finish(self):
        folder = self.folder
        server = Server(folder, "--drain", "120", WATCHDOG_USEC="400000")
        check("READY=1" in server.heard("READY=1"), "ready")
        server.heard("WATCHDOG=1")
        status, message = server.wait_ready()
        check(status == 200, message)
        client = subprocess.Popen([CLIENT, "stream", FRAMES, "--server", server.url], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + PATIENCE_S
        while 'hermite_scans_running{mode="batch"} 1' not in server.ask("/metrics")[1]:
            check(time.monotonic() < deadline, "the scan does not start")
            time.sleep(0.02)
        server.process.send_signal(signal.SIGTERM)
        server.heard("STOPPING=1")
        status, message = server.ask("/readyz")
        check(status == 503 and "not ready: the server is ending" in message, "while it ends: %d %s" % (status, message))
        server.heard("WATCHDOG=1")
        report, said = client.communicate(timeout=PATIENCE_S)
        check(client.returncode == 0, said)
        json.loads(report)
        code, log = server.end()
        check(code == 0, "exit status %d" % code)
        ended = [line for line in log if "finished: 12 frames received, 12 processed" in line["msg"]]
        check(len(ended) == 1 and ended[0]["session"] and ended[0]["duration"] > 0, log)

    def test_a_scan_that_takes_too_long_is_left_to_the_next_server(self):
        folder = self.folder
        server = Server(folder, "--drain", "1")
        client = subprocess.Popen([CLIENT, "stream", "synthetic:frames=9000,width=160,height=120", "--server", server.url],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        deadline = time.monotonic() + PATIENCE_S
        while "hermite_frames_processed_total 0" in server.ask("/metrics")[1]:
            check(time.monotonic() < deadline, "no frame")
            time.sleep(0.05)
        metrics = server.ask("/metrics")[1]
        for stage in ("queue", "decode", "preprocess", "track", "fuse", "predict"):
            check('hermite_frame_stage_seconds_count{stage="%s"}' % stage in metrics, "no time of " + stage)
        scan = next(json.loads(line)["session"] for line in text_of(server.log_path).splitlines() if "started" in line)
        check(scan not in metrics, "an id among the metrics")
        status, trace = server.ask("/debug/trace?scan=" + scan)
        events = json.loads(trace)["traceEvents"]
        check(status == 200 and any(event["ph"] == "X" and event["name"] == "track" for event in events), trace)
        check_top(server, scan)
        server.process.send_signal(signal.SIGTERM)
        code, log = server.end()
        check(code == 0, "exit status %d" % code)
        check(any("is left running" in line["msg"] for line in log), log)
        check(client.poll() is None, "the client waits for the next server")
        client.send_signal(signal.SIGINT)
        time.sleep(3)
        client.send_signal(signal.SIGINT)  # again: now, without an answer
        check(client.wait(PATIENCE_S) != 0, "the client has given up")
        client.communicate()

    def test_the_certificate_is_read_again(self):
        folder = self.folder
        if not shutil.which("openssl"):
            self.skipTest("no openssl here")
        make_certificate(folder, "first")
        server = Server(folder, "--tls-certificate", folder + "/cert.pem", "--tls-key", folder + "/key.pem")
        check(server.url.startswith("https://"), server.url)
        port = int(server.url.split("#")[0].rstrip("/").rsplit(":", 1)[1])
        first = shown_certificate(port)
        refused = run(CLIENT, "stream", FRAMES, "--server", server.url)
        check(refused.returncode != 0 and "is not trusted" in refused.stderr, refused.stderr)
        make_certificate(folder, "second")
        server.process.send_signal(signal.SIGHUP)
        deadline = time.monotonic() + PATIENCE_S
        while shown_certificate(port) == first:
            check(time.monotonic() < deadline, "the old certificate is still shown")
            time.sleep(0.05)
        second = shown_certificate(port)
        with open(folder + "/cert.pem", "w") as file:
            file.write("garbage")
        server.process.send_signal(signal.SIGHUP)
        deadline = time.monotonic() + PATIENCE_S
        while "the old certificate stays" not in text_of(server.log_path):
            check(time.monotonic() < deadline, "nothing is said about a bad certificate")
            time.sleep(0.05)
        check(shown_certificate(port) == second, "a bad certificate took the place of a good one")
        with open(folder + "/ca.pem", "w") as file:
            file.write(second)
        made = run(HERMITE, "token", "create", "--data", folder + "/data")
        check(made.returncode == 0 and made.stdout.startswith("hmt_"), made.stderr)
        listed = run(HERMITE, "token", "list", "--data", folder + "/data")
        check(listed.stdout.count("active") == 2, listed.stdout + listed.stderr)
        done = run(CLIENT, "stream", FRAMES, "--server", server.url, "--ca", folder + "/ca.pem")
        check(done.returncode == 0, done.stderr)
        for version in (ssl.TLSVersion.TLSv1, ssl.TLSVersion.TLSv1_1):
            context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
            context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
            context.set_ciphers("ALL:@SECLEVEL=0")
            context.minimum_version = context.maximum_version = version
            try:
                context.wrap_socket(socket.create_connection(("127.0.0.1", port), 10))
                self.fail("%s is spoken" % version)
            except (ssl.SSLError, ConnectionError):
                pass
        server.process.send_signal(signal.SIGTERM)
        check(server.end()[0] == 0, "exit status")

    def test_a_proxy_is_believed_when_it_is_trusted(self):
        folder = self.folder
        server = Server(folder, "--trusted-proxy", "127.0.0.1")
        port = int(server.url.split("#")[0].rstrip("/").rsplit(":", 1)[1])
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
        connection.request("GET", "/healthz", headers={"X-Forwarded-Proto": "https", "X-Forwarded-For": "198.51.100.4"})
        check(connection.getresponse().getheader("Strict-Transport-Security"), "the proxy says that its side is encrypted")
        connection.close()
        server.process.send_signal(signal.SIGTERM)
        check(server.end()[0] == 0, "exit status")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
