#!/usr/bin/python3
"""A real S3 server for tests: OpenStack Swift with its S3 interface, as Debian packages it (python3-swift), in one process.

    swift_server.py FOLDER [--port PORT] [--bucket NAME]

Everything is kept in FOLDER, so a killed server goes on where it was. The key is hermite:tests, the secret is `testing`, the region
us-east-1, and addresses are path-style. Prints the port once it answers, and ends when its standard input is closed. Exit status 77:
python3-swift is not installed, or the folder's file system has no extended attributes.
"""
import argparse
import os
import sys
import threading
from array import array

try:
    import eventlet
    import eventlet.wsgi
    from swift.common import storage_policy, utils
except ImportError as missing:
    print(f"skipped: {missing}; it is in Debian's python3-swift", file=sys.stderr)
    sys.exit(77)

PROXY = """
[DEFAULT]
swift_dir = {folder}
log_level = ERROR
[pipeline:main]
pipeline = catch_errors s3api tempauth proxy-server
[filter:catch_errors]
use = egg:swift#catch_errors
[filter:s3api]
use = egg:swift#s3api
location = us-east-1
[filter:tempauth]
use = egg:swift#tempauth
user_hermite_tests = testing .admin
[app:proxy-server]
use = egg:swift#proxy
account_autocreate = true
"""


class Memory:
    """What memcached would keep, of which only get, set and delete are used here."""

    def __init__(self):
        self.values = {}

    def get(self, key, raise_on_error=False):
        return self.values.get(key)

    def set(self, key, value, *_, **__):
        self.values[key] = value

    def delete(self, key, *_, **__):
        self.values.pop(key, None)

    def incr(self, key, delta=1, *_, **__):
        self.values[key] = int(self.values.get(key, 0)) + delta
        return self.values[key]


def check_attributes(folder):
    try:
        os.setxattr(folder, "user.swift.test", b"x")
    except OSError as error:
        print(f"skipped: {folder} takes no extended attributes: {error}", file=sys.stderr)
        sys.exit(77)


def serve(socket, application):
    return eventlet.spawn(eventlet.wsgi.server, socket, application, log_output=False, debug=False)


def start_stores(folder):
    """The servers of accounts, containers and objects, on one device without copies."""
    from swift.account.server import AccountController
    from swift.common.ring import RingData
    from swift.container.server import ContainerController
    from swift.obj.server import ObjectController

    devices = os.path.join(folder, "devices")
    os.makedirs(os.path.join(devices, "disk"), exist_ok=True)
    conf = {"devices": devices, "swift_dir": folder, "mount_check": "false", "log_level": "ERROR"}
    sockets = {name: eventlet.listen(("127.0.0.1", 0)) for name in ("account", "container", "object")}
    for name, socket in sockets.items():
        port = socket.getsockname()[1]
        device = {"id": 0, "zone": 0, "region": 1, "device": "disk", "ip": "127.0.0.1", "port": port,
                  "replication_ip": "127.0.0.1", "replication_port": port, "weight": 1.0}
        RingData([array("H", [0, 0])], [device], 31).save(os.path.join(folder, name + ".ring.gz"))
    serve(sockets["account"], AccountController(conf))
    serve(sockets["container"], ContainerController(conf))
    serve(sockets["object"], ObjectController(conf))


def load_proxy(folder):
    from swift.common.wsgi import loadapp

    path = os.path.join(folder, "proxy.conf")
    with open(path, "w", encoding="ascii") as conf:
        conf.write(PROXY.format(folder=folder))
    application = loadapp(path)
    memory = Memory()

    def with_memory(environment, start_response):
        environment["swift.cache"] = memory
        return application(environment, start_response)

    return with_memory


def make_bucket(application, bucket):
    from swift.common.swob import Request

    request = Request.blank(f"/v1/AUTH_hermite/{bucket}", method="PUT", environ={"swift.authorize_override": True, "swift_owner": True})
    status = request.get_response(application).status_int
    if status >= 300:
        sys.exit(f"creating the bucket {bucket}: {status}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--bucket", default="scans")
    arguments = parser.parse_args()
    os.makedirs(arguments.folder, exist_ok=True)
    check_attributes(arguments.folder)
    eventlet.monkey_patch(thread=False)
    utils.HASH_PATH_SUFFIX = b"tests"
    utils.SWIFT_CONF_FILE = os.path.join(arguments.folder, "swift.conf")
    with open(utils.SWIFT_CONF_FILE, "w", encoding="ascii") as conf:
        conf.write("[swift-hash]\nswift_hash_path_suffix = tests\n[storage-policy:0]\nname = one\ndefault = yes\n")
    storage_policy.reload_storage_policies()
    start_stores(arguments.folder)
    application = load_proxy(arguments.folder)
    make_bucket(application, arguments.bucket)
    socket = eventlet.listen(("127.0.0.1", arguments.port), backlog=128)
    os.write(1, b"%d\n" % socket.getsockname()[1])  # at once: print() is cut in two here, and the reader may be gone in between
    server = serve(socket, application)
    threading.Thread(target=lambda: (sys.stdin.read(), os._exit(0)), daemon=True).start()
    server.wait()


if __name__ == "__main__":
    main()
