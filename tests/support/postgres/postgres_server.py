#!/usr/bin/python3
"""Runs a real PostgreSQL (Debian's) in a folder, for tests, until its standard input is closed.

    postgres_server.py FOLDER [--sync]

Prints the port of 127.0.0.1 on a line when it takes connections, as the user "hermite" without a password. Lines on standard input:
"crash" kills it as a power failure of its machine would end it, "start" starts it again where it was and prints the port again. Each is
answered by a line. Without PostgreSQL it ends with status 77. It does not sync its files without --sync, since no test switches
the machine off.
"""
import glob
import os
import pwd
import shutil
import signal
import socket
import subprocess
import sys
import time

PATIENCE_S = 60
STANDARD = ["-c", "listen_addresses=127.0.0.1", "-c", "max_connections=40", "-c", "shared_buffers=16MB",
            "-c", "logging_collector=off", "-c", "log_min_messages=panic"]


def programs():
    folders = sorted(glob.glob("/usr/lib/postgresql/*/bin/initdb"), key=lambda path: int(path.split("/")[4]))
    if not folders:
        sys.exit(77)
    return os.path.dirname(folders[-1])


def become_user():
    """PostgreSQL refuses to run as root: then it is the user that Debian's package has made."""
    if os.getuid() == 0:
        user = pwd.getpwnam("postgres")
        os.setgroups([])
        os.setgid(user.pw_gid)
        os.setuid(user.pw_uid)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def processes():
    """Returns the parent and the state of each process of the machine, by its id."""
    found = {}
    for path in glob.glob("/proc/[0-9]*/stat"):
        try:
            with open(path) as file:
                state, parent = file.read().rpartition(")")[2].split()[:2]
        except (FileNotFoundError, ProcessLookupError):  # it has ended since
            continue
        found[int(path.split("/")[2])] = int(parent), state
    return found


def is_any_alive(pids):
    found = processes()
    return any(found.get(pid, (0, "Z"))[1] != "Z" for pid in pids)


class Server:
    def __init__(self, folder, syncs):
        self.sync = ["-c", "fsync=" + ("on" if syncs else "off")]
        self.bin, self.port = programs(), free_port()
        self.folder = os.path.join(folder, "postgres")
        os.mkdir(self.folder)
        if os.getuid() == 0:
            os.chmod(folder, 0o711)
            user = pwd.getpwnam("postgres")
            os.chown(self.folder, user.pw_uid, user.pw_gid)
        # Sorted as people sort, and not byte by byte, since Hermite must not depend on it.
        self.call("initdb", "-D", self.folder + "/data", "-U", "hermite", "--auth=trust", "--no-sync", "--no-instructions", "-E", "UTF8",
                  "--locale=C.UTF-8", "--locale-provider=icu", "--icu-locale=en-US")

    def call(self, program, *arguments):
        done = subprocess.run([os.path.join(self.bin, program), *arguments], preexec_fn=become_user, cwd="/", capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{program}: {done.stderr}")

    def start(self):
        self.process = subprocess.Popen([os.path.join(self.bin, "postgres"), "-D", self.folder + "/data", "-k", self.folder,
                                         "-p", str(self.port), *self.sync, *STANDARD],
                                        preexec_fn=become_user, cwd="/", stdin=subprocess.DEVNULL, start_new_session=True,
                                        stdout=subprocess.DEVNULL, stderr=open(self.folder + "-log", "a"))
        end = time.monotonic() + PATIENCE_S
        while subprocess.run([os.path.join(self.bin, "pg_isready"), "-q", "-h", "127.0.0.1", "-p", str(self.port)]).returncode != 0:
            if self.process.poll() is not None or time.monotonic() > end:
                sys.exit("PostgreSQL does not start: " + open(self.folder + "-log").read())
            time.sleep(0.02)
        print(self.port, flush=True)

    def crash(self):
        """Ends all of its processes at once. Each backend leads a process group of its own, and answers once more if it is busy."""
        os.kill(self.process.pid, signal.SIGSTOP)  # so that it starts no more of them
        backends = [pid for pid, (parent, _) in processes().items() if parent == self.process.pid]
        for pid in backends + [self.process.pid]:
            os.kill(pid, signal.SIGKILL)
        self.process.wait()
        while is_any_alive(backends):
            time.sleep(0.002)

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGQUIT)
            self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


def main():
    server = Server(sys.argv[1], "--sync" in sys.argv)
    server.start()
    for line in sys.stdin:
        if line.strip() == "crash":
            server.crash()
            print("crashed", flush=True)
        elif line.strip() == "start":
            server.start()
    server.stop()


if __name__ == "__main__":
    main()
