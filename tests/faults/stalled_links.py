#!/usr/bin/python3
"""Links that neither end nor move: the other side is just silent, longer than the heartbeat allows.

    stalled_links.py path/to/hermite path/to/hermite-client

Side by side on one server, in this order of the report:
  stopped   the client gets SIGSTOP in the middle of its scan, and goes on when the server has let it go;
  swallowed a proxy takes the bytes of both sides and forwards none, without closing anything, until both have given up;
  waiting   a camera that waits for a place, through a proxy that is cut and then swallows: it comes again, and gets its turn;
  mute      a viewer that reads nothing and answers no ping, so that what it is sent piles up.
Passes when the server lets each of them go within the heartbeat's 45 s and a little, a scan that runs beside them is not disturbed, all
cameras come back by themselves and have the result of an undisturbed run, and no file is left open. Exit status 77 (skipped) without
python3-wsproto.
"""
import os
import re
import signal
import socket
import sys
import tempfile
import threading
import time

from programs import FRAMES, Camera, Proxy, Server, argument_parser, check, failures, open_files

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "server"))
from independent_client import Client, hello_viewer  # noqa: E402

HEARTBEAT_S = 45
# The clock starts with the last sign of life; the machine may be busy.
LET_GO_S = HEARTBEAT_S + 25
PLACES = 3
# The camera in the line whose link is silent gets its turn, too, before the server sees that nobody is there: such a scan waits so long.
RESUME_S = 40
# Between the undisturbed scans: heartbeats are waited for, and other tests need the processors meanwhile.
PAUSE_S = 10


class SilentProxy(Proxy):
    """What was read of swallowed connections is forgotten: no byte, no end and no reset gets through."""

    def __init__(self, port):
        self.pairs = []
        super().__init__(port)

    def new_pair(self, near, far):
        self.pairs.append({"near": near, "far": far, "swallowed": False})
        return self.pairs[-1]

    def forward(self, source, sink, pair):
        try:
            while data := source.recv(65536):
                if sink is pair["far"]:
                    self.upward_bytes += len(data)
                if not pair["swallowed"]:
                    sink.sendall(data)
        except OSError:
            pass
        if pair["swallowed"]:
            return  # the other side is not told
        for end in (source, sink):
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass

    def swallow(self):
        """The connections that there are; new ones go through."""
        for pair in self.pairs:
            pair["swallowed"] = True

    def cut(self):
        for pair in self.pairs:
            for name in ("near", "far"):
                try:
                    pair[name].shutdown(socket.SHUT_RDWR)
                except OSError:
                    pass

    def close(self):
        self.listener.close()
        for pair in self.pairs:
            pair["near"].close()
            pair["far"].close()


def connections(server, ports):
    """How many of these local ports the server is still connected to."""
    wanted = {f"{port:04X}" for port in ports}
    with open("/proc/net/tcp", encoding="ascii") as table:
        rows = [row.split() for row in table.readlines()[1:]]
    mine = f":{server.port:04X}"
    return sum(row[1].endswith(mine) and row[2].split(":")[1] in wanted and row[3] == "01" for row in rows)


def ports_of(process):
    """Of the connections of a process."""
    inodes = {found[1] for name in os.listdir(f"/proc/{process.pid}/fd")
              if (found := re.match(r"socket:\[(\d+)\]", os.readlink(f"/proc/{process.pid}/fd/{name}")))}
    with open("/proc/net/tcp", encoding="ascii") as table:
        return [int(row.split()[1].split(":")[1], 16) for row in table.readlines()[1:] if row.split()[9] in inodes]


def wait_until(condition, patience_s):
    """Seconds until then; None: not in time."""
    started = time.monotonic()
    while not condition():
        if time.monotonic() - started > patience_s:
            return None
        time.sleep(0.1)
    return time.monotonic() - started


def running(server):
    return [scan for scan in server.ask("scans")["scans"] if scan["state"] == "running"]


def under_way(server, title):
    """Whether that scan has some of its frames, but not all."""
    return any(scan["title"] == title and 3 <= scan["frames_received"] < FRAMES for scan in running(server))


def has_said(camera, text):
    return any(text in line for line in camera.lines)


def through(server, proxy):
    return server.url.replace(f":{server.port}/", f":{proxy.port}/")


def stopped(server, program, expected, report):
    camera = Camera(program, server.url, settings=["--title", "stopped"])
    check(wait_until(lambda: under_way(server, "stopped"), 60) is not None, "the scan whose client is stopped has begun")
    ports = ports_of(camera.process)
    camera.process.send_signal(signal.SIGSTOP)
    took = wait_until(lambda: connections(server, ports) == 0, LET_GO_S)
    check(took is not None, f"the server lets a stopped client go within {LET_GO_S} s")
    camera.process.send_signal(signal.SIGCONT)
    result = camera.result()
    check(result == expected, f"the stopped client: {result} instead of {expected}\n" + "".join(camera.lines[-10:]))
    check(has_said(camera, "connected again"), "the stopped client has resumed")
    report["stopped: let go after"] = took


def swallowed(server, program, expected, report):
    proxy = SilentProxy(server.port)
    camera = Camera(program, through(server, proxy))
    wait_until(lambda: proxy.upward_bytes > 100_000, 30)
    proxy.swallow()
    ports = [pair["far"].getsockname()[1] for pair in proxy.pairs]
    took = wait_until(lambda: connections(server, ports) == 0, LET_GO_S)
    check(took is not None, f"the server lets a swallowed link go within {LET_GO_S} s")
    back = wait_until(lambda: has_said(camera, "connected again"), LET_GO_S)
    check(back is not None, "the client of a swallowed link gives it up and comes back")
    result = camera.result()
    check(result == expected, f"the swallowed link: {result} instead of {expected}\n" + "".join(camera.lines[-10:]))
    proxy.close()
    report["swallowed: let go after"] = took


def mute_viewer(server, report):
    wait_until(lambda: under_way(server, "stopped"), 60)  # a scan that is there for long
    scan = next(scan["id"] for scan in running(server) if scan["title"] == "stopped")
    client = Client(server.port)
    client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    client.send_message(hello_viewer(server.token(), scan))
    port = client.socket.getsockname()[1]
    took = wait_until(lambda: connections(server, [port]) == 0, LET_GO_S)
    check(took is not None, f"the server lets a mute viewer go within {LET_GO_S} s")
    client.socket.close()
    report["mute viewer: let go after"] = took


def waiting(server, program, expected, holders, report):
    """The places are taken by scans whose cameras are stopped, until the end of this."""
    proxy = SilentProxy(server.port)
    camera = Camera(program, through(server, proxy))
    check(wait_until(lambda: has_said(camera, "no place on the server yet"), 30) is not None, "a camera without a place waits")
    started = time.monotonic()
    proxy.cut()
    check(wait_until(lambda: has_said(camera, "connection lost while waiting"), 30) is not None, "it sees that its link is lost")
    again = wait_until(lambda: sum("no place on the server yet" in line for line in camera.lines) >= 2, 60)
    check(again is not None, "it waits again after a cut")
    proxy.swallow()
    third = wait_until(lambda: sum("no place on the server yet" in line for line in camera.lines) >= 3, LET_GO_S)
    check(third is not None, "it waits again after a link that is silent")
    report["waiting: in the line again after a cut"] = again
    report["waiting: in the line again after silence"] = third
    for holder in holders:
        holder.process.send_signal(signal.SIGCONT)
    result = camera.result()
    check(result == expected, f"the one that waited: {result} instead of {expected}\n" + "".join(camera.lines[-10:]))
    proxy.close()
    report["waiting: in all"] = time.monotonic() - started


def beside(server, program, expected, over, results):
    """Scans that nobody disturbs, again and again with a pause, as long as others are disturbed."""
    while not over.is_set():
        started = time.monotonic()
        camera = Camera(program, server.url)
        result = camera.result()
        check(result == expected, f"the undisturbed one: {result} instead of {expected}\n" + "".join(camera.lines[-10:]))
        check(not has_said(camera, "connection lost"), "the undisturbed one keeps its connection")
        results.append(time.monotonic() - started)
        over.wait(PAUSE_S)


def stall_side_by_side(server, program, expected, report):
    over, times = threading.Event(), []
    undisturbed = threading.Thread(target=beside, args=(server, program, expected, over, times))
    undisturbed.start()
    parts = [threading.Thread(target=stopped, args=(server, program, expected, report)),
             threading.Thread(target=swallowed, args=(server, program, expected, report)),
             threading.Thread(target=mute_viewer, args=(server, report))]
    for part in parts:
        part.start()
    for part in parts:
        part.join()
    over.set()
    undisturbed.join()
    report["undisturbed scans beside them, each"] = sum(times) / max(len(times), 1)


def stall_in_line(server, program, expected, report):
    holders = []
    for number in range(PLACES):
        title = f"holder {number}"
        holders.append(Camera(program, server.url, settings=["--title", title]))
        check(wait_until(lambda wanted=title: under_way(server, wanted), 60) is not None, f"{title} has begun")
        holders[-1].process.send_signal(signal.SIGSTOP)
    waiting(server, program, expected, holders, report)
    for holder in holders:
        result = holder.result()
        check(result == expected, f"one that had a place: {result} instead of {expected}")


def main():
    arguments = argument_parser().parse_args()
    report = {}
    with tempfile.TemporaryDirectory() as folder:
        server = Server(arguments.hermite, os.path.join(folder, "data"), settings=[
            "--max-scans", str(PLACES), "--requests-per-second", "1000", "--resume-window", str(RESUME_S)])
        started = time.monotonic()
        expected = Camera(arguments.client, server.url).result()
        check(expected is not None and expected[0] == FRAMES, f"the undisturbed run: {expected}")
        before = open_files(server.process)
        stall_side_by_side(server, arguments.client, expected, report)
        stall_in_line(server, arguments.client, expected, report)
        check(wait_until(lambda: open_files(server.process) <= before, HEARTBEAT_S + RESUME_S + 30) is not None,
              f"{open_files(server.process)} open files, {before} before")
        for name, took_s in report.items():
            print(f"{name} {'never' if took_s is None else f'{took_s:.1f} s'}")
        server.end_well()
        print(f"{time.monotonic() - started:.0f} s: {'FAILED' if failures else 'all let go, all came back, all results the same'}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
