#!/usr/bin/python3
"""Clients that keep to the letter of the protocols and mean no good, and clients that do not: a server that runs serves the others meanwhile.

    hostile.py path/to/hermite path/to/hermite-client [--long]

The first three at the same time, each from addresses of its own:

slow headers    a hundred connections from two addresses send a byte of their header now and then: each is closed after 10 s
slow bodies     uploads and requests whose body comes a byte at a time; with --long until the server lets go of them, after 60 s
silence         upgraded to a WebSocket, and then a message that never ends: closed after 10 s

and one after the other:

no reading      a hundred requests each on connections that read no answer
odd frames      by npm's ws (odd_frames.mjs): each broken rule is told by its code. Left out, and said so, without node_modules
IPv6, proxies   hosts, and X-Forwarded-For from who is trusted and who is not, seen in the audit log. Left out without IPv6
script          titles, names, paths and settings that are script come back as JSON or text that no browser runs

Prints a table. Passes when all of this is so, another client is answered within 5 s all the time, the server lives, has as many open files as
before, and a scan has the result of one before.
"""
import http.client
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor

from programs import PATIENCE_S, Camera, Server, argument_parser, check, open_files, resident_mb, verdict, wait_until

HERE = os.path.dirname(os.path.abspath(__file__))
SLOW_S = 5.0  # half of what the server waits for the slow ones: whoever waits behind them waits longer
SCRIPTS = ['<script>alert(1)</script>', '"><img src=x onerror=alert(1)>', "';alert(1)//", 'javascript:alert(1)', '</title><svg onload=alert(1)>']
table = []


def row(what, answer):
    table.append((what, answer))
    print(f"| {what} | {answer} |", flush=True)


class Slow:
    """Connections that say `begin` at once and then a byte of `rest` every so often, until they are closed."""

    def __init__(self, port, sources, begin, rest=b"x", then=b"", period_s=0.5):
        """`then`: after an answer to the beginning."""
        self.sockets = []
        for source in sources:
            one = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S, source_address=(source, 0))
            one.sendall(begin)
            if then:
                check(b"101 Switching" in one.recv(4096), "it is upgraded")
                one.sendall(then)
            one.setblocking(False)
            self.sockets.append(one)
        self.rest, self.period_s, self.begun_at = rest, period_s, time.monotonic()
        self.closed_after_s = []

    def go_on(self, for_s):
        """Until all are closed, or for so long. Whether all are."""
        deadline, sent = time.monotonic() + for_s, 0
        while self.sockets and time.monotonic() < deadline:
            time.sleep(self.period_s)
            piece = self.rest[sent % len(self.rest):][:1]
            sent += 1
            for one in list(self.sockets):
                try:
                    one.sendall(piece)
                    gone = one.recv(65536) == b""
                except BlockingIOError:
                    gone = False
                except OSError:
                    gone = True
                if gone:
                    self.closed_after_s.append(time.monotonic() - self.begun_at)
                    one.close()
                    self.sockets.remove(one)
        return not self.sockets

    def end(self):
        for one in self.sockets:
            one.close()


class Honest:
    """Asks all the time, as anybody else would, and keeps the longest that it had to wait."""

    def __init__(self, server):
        self.server, self.longest_s, self.stopped = server, 0, False
        self.thread = threading.Thread(target=self.ask)
        self.thread.start()

    def ask(self):
        while not self.stopped:
            begun = time.monotonic()
            try:
                self.server.scans()
            except OSError as error:
                check(False, f"another client is served: {error}")
            self.longest_s = max(self.longest_s, time.monotonic() - begun)
            time.sleep(0.2)

    def end(self, what):
        self.stopped = True
        self.thread.join()
        check(self.longest_s < SLOW_S, f"{what}: another client waited {self.longest_s:.1f} s")
        return f"others waited {self.longest_s:.2f} s at most"


def outlasted(server, what, slow, limit_s=15):
    """Checks that the server closes all of these connections by then, and serves another client meanwhile. Text for the table."""
    honest = Honest(server)
    all_gone = slow.go_on(20)
    summary = honest.end(what)
    longest_s = max(slow.closed_after_s, default=0)
    check(all_gone, f"{what}: {len(slow.sockets)} are still there")
    check(longest_s < limit_s, f"{what}: closed after {longest_s:.0f} s")
    slow.end()
    return f"closed after {longest_s:.0f} s; {summary}"


def request(server, method, path, headers=(), body=None, host="127.0.0.1"):
    connection = http.client.HTTPConnection(host, server.port, timeout=PATIENCE_S)
    connection.request(method, path, body, dict(headers))
    answer = connection.getresponse()
    return answer, answer.read()


def bearer(server):
    return {"Authorization": "Bearer " + server.token()}


def slow_headers(server, _long):
    sources = ["127.0.0.2"] * 50 + ["127.0.0.3"] * 50
    slow = Slow(server.port, sources, b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: ")
    return outlasted(server, "slow headers", slow)


def slow_bodies(server, is_long):
    head = f"PUT /api/v1/uploads/slow.raw HTTP/1.1\r\nHost: 127.0.0.1\r\nAuthorization: Bearer {server.token()}\r\nContent-Length: 1000000\r\n\r\n"
    slow = Slow(server.port, ["127.0.0.4"] * 30, head.encode())
    small = head.replace("PUT /api/v1/uploads/slow.raw", "POST /api/v1/jobs").replace("1000000", "4000")
    slow_small = Slow(server.port, ["127.0.0.5"] * 30, small.encode(), rest=b" ")
    short = outlasted(server, "short slow bodies", slow_small)
    honest = Honest(server)
    gone = slow.go_on(90 if is_long else 1)
    summary = honest.end("slow bodies")
    check(gone or not is_long, f"slow bodies: {len(slow.sockets)} are still there")
    slow.end()
    wait_until(lambda: not server.ask("uploads")["uploads"], "their uploads are gone")
    ended = f"long ones after {max(slow.closed_after_s):.0f} s" if gone else "long ones were broken off by us"
    return f"short ones {short}; {ended}, nothing is left of them; {summary}"


def no_reading(server):
    before_mb = resident_mb(server.process)
    asked = f"GET /api/v1/scans HTTP/1.1\r\nHost: 127.0.0.1\r\nAuthorization: Bearer {server.token()}\r\n\r\n".encode() * 100
    sockets = []
    for number in range(40):
        one = socket.socket()
        one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        one.bind((f"127.0.0.{2 + number % 2}", 0))
        one.connect(("127.0.0.1", server.port))
        one.setblocking(False)
        try:
            one.send(asked)
        except BlockingIOError:
            pass
        sockets.append(one)
    honest = Honest(server)
    time.sleep(3)
    summary = honest.end("no reading")
    grown_mb = resident_mb(server.process) - before_mb
    check(grown_mb < 64, f"no reading: {grown_mb:.0f} MB more")
    for one in sockets:
        one.close()
    return f"{grown_mb:.1f} MB more; {summary}"


def silence(server, _long):
    upgrade = (f"GET /api/v1/ws HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
               "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: hermite.v1\r\n\r\n")
    slow = Slow(server.port, ["127.0.0.6"] * 30, upgrade.encode(),
                then=b"\x82\xfe\x10\x00\0\0\0\0")  # a message that comes a byte at a time
    return outlasted(server, "silence", slow)


def odd_frames(server):
    node = shutil.which("node")
    if not node or not os.path.isdir(os.path.join(HERE, "../../web/node_modules/ws")):
        return "left out: no npm ws"
    done = subprocess.run([node, os.path.join(HERE, "odd_frames.mjs"), str(server.port), server.token()], capture_output=True, text=True,
                          timeout=PATIENCE_S, check=False)
    if done.returncode != 0:
        check(False, f"odd frames: {done.stderr}")
        return done.stderr
    answers = json.loads(done.stdout)
    fine = {name: answer for name, answer in answers.items() if name.startswith("a hello")}
    for name, answer in fine.items():
        check("there is no scan" in answer["words"], f"{name} is understood: {answer}")
    codes = {name: answer["code"] for name, answer in answers.items() if name not in fine}
    for name, code in codes.items():
        check(code in (1002, 1003, 1007, 1008, 1006 if "noise" in name else 1002), f"{name}: closed with {code}")
    return ", ".join(f"{name}: {code}" for name, code in codes.items()) + f"; {len(fine)} hellos in odd pieces are understood"


def audited_addresses(hermite, data):
    """Of wrong tokens, with how many there were."""
    done = subprocess.run([hermite, "audit", "--data", data], capture_output=True, text=True, check=False)
    check(done.returncode == 0, f"the audit log holds: {done.stderr}")
    entries = [json.loads(line) for line in done.stdout.splitlines()]
    return {entry["address"]: entry["count"] for entry in entries if entry["did"] == "wrong token"}


def behind_a_proxy(hermite, folder, host, trusted):
    """What each of these X-Forwarded-For is counted as."""
    data = os.path.join(folder, "proxied-" + ("trusted" if trusted else "not"))
    settings = ["--admin-listen", "off"] + (["--trusted-proxy", host, "--trusted-proxy", "10.0.0.0/8"] if trusted else [])
    server = Server(hermite, data, settings=settings, host=host)
    asked = {"198.51.100.1": "198.51.100.1", "6.6.6.6, 198.51.100.2": "198.51.100.2", "198.51.100.3, 10.0.0.9": "198.51.100.3",
             "198.51.100.4:4711": "198.51.100.4", "[2001:db8::5]:99": "2001:db8::5", "::ffff:198.51.100.6": "198.51.100.6",
             "<script>": host, "10.0.0.1, " * 300 + "10.0.0.1": "10.0.0.1"}
    for forwarded in asked:
        answer, _ = request(server, "GET", "/api/v1/scans",
                            {"Authorization": "Bearer wrong", "X-Forwarded-For": forwarded, "X-Forwarded-Proto": "https"}, host=host)
        check(answer.status in (401, 429), f"{forwarded[:40]}: {answer.status}")
    named = "[::1]" if ":" in host else host
    for value, status in ((f"{named}:{server.port}", 200), (named, 200), ("evil.example", 403), ("[::2]", 403)):
        answer, _ = request(server, "GET", "/api/v1/scans", {"Host": value, "X-Forwarded-Proto": "https", **bearer(server)}, host=host)
        check(answer.status == status, f"host {value}: {answer.status}")
    check(server.end(signal.SIGTERM) == 0, "the server ends well")
    counted = audited_addresses(hermite, data)
    expected = {address: 1 for address in asked.values()} if trusted else {host: len(asked)}
    check(counted == expected, f"X-Forwarded-For, trusted {trusted}: {counted} instead of {expected}")
    return f"{len(asked)} ways of writing it are {len(counted)} addresses" if trusted else "it is not believed"


def proxies(hermite, host):
    """Rows for servers at that address that trust a proxy there, and that do not."""
    if host == "::1" and not os.path.exists("/proc/net/if_inet6"):
        row("IPv6", "left out: there is none here")
        return
    for trusted in (False, True):
        with tempfile.TemporaryDirectory() as folder:
            row(f"X-Forwarded-For of {host}, {'' if trusted else 'not '}trusted", behind_a_proxy(hermite, folder, host, trusted))


def scripts(server):
    for script in SCRIPTS:
        body = b"no recording " + script.encode()
        answer, said = request(server, "PUT", "/api/v1/uploads/" + "".join(f"%{byte:02x}" for byte in script.encode()), bearer(server), body)
        check(answer.status == 201, f"an upload called {script}: {answer.status} {said}")
        for path in ("/" + script.replace(" ", "%20"), "/api/v1/scans/" + script.replace(" ", "%20"), "/api/v1/jobs?x=" + script.replace(" ", "%20")):
            reflected, said = request(server, "GET", path, bearer(server))
            kind = reflected.getheader("Content-Type", "")
            check(kind.startswith(("application/json", "text/plain")) and reflected.getheader("X-Content-Type-Options") == "nosniff",
                  f"{path}: {kind}")
            check("default-src 'none'" in reflected.getheader("Content-Security-Policy", "") or script.encode() not in said, f"{path}: {said}")
    jobs = server.ask("jobs")["jobs"]
    check({job["title"] for job in jobs} >= {script.rsplit("/", 1)[-1] for script in SCRIPTS}, f"titles are as they were given: {[job['title'] for job in jobs]}")
    return "as they were given, in JSON with nosniff; tests/web/import_test.mjs looks at them in a browser"


def main():
    parser = argument_parser()
    parser.add_argument("--long", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        server = Server(arguments.hermite, os.path.join(folder, "data"), settings=["--admin-listen", "off", "--requests-per-second", "1000"])
        before = Camera(arguments.client, server.url).result()
        check(before is not None, "a scan before")
        time.sleep(1)
        files = open_files(server.process)
        slow = {"slow headers": slow_headers, "slow bodies": slow_bodies, "silence after the upgrade": silence}
        with ThreadPoolExecutor(len(slow)) as pool:
            for name, answer in zip(slow, pool.map(lambda throw: throw(server, arguments.long), slow.values())):
                row(name, answer)
        for name, throw in (("no reading", no_reading), ("odd frames", odd_frames), ("script as title, name and path", scripts)):
            row(name, throw(server))
        for host in ("127.0.0.1", "::1"):
            proxies(arguments.hermite, host)
        check(Camera(arguments.client, server.url).result() == before, "a scan afterwards has the result of the one before")
        wait_until(lambda: open_files(server.process) <= files + 2, "all connections are gone")
        server.end_well()
    return verdict()


if __name__ == "__main__":
    sys.exit(main())
