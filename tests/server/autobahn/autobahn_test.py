#!/usr/bin/python3
"""The Autobahn testsuite (fuzzing client) against the WebSocket code of the server.

    WSTEST=path/to/wstest autobahn_test.py path/to/autobahn_echo [--cases '1.*' ...] [--keep FOLDER]

The suite wants an echo, and speaks neither our subprotocol nor our messages: autobahn_echo is the same code up to whole messages
(server/connections/websocket_stream.h) and says them back. Compression (12.*, 13.*) is left out since the server never agrees to it. Passes when the
behaviour of every case and of its close is OK, NON-STRICT or INFORMATIONAL. Exit status 77 (skipped) where WSTEST does not name the program.
"""
import argparse
import collections
import json
import os
import subprocess
import sys
import tempfile

GOOD = {"OK", "NON-STRICT", "INFORMATIONAL"}
PATIENCE_S = 1700


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("echo")
    parser.add_argument("--cases", nargs="+", default=["*"])
    parser.add_argument("--keep", help="a folder for the suite's own reports")
    arguments = parser.parse_args()
    wstest = os.environ.get("WSTEST")
    if not wstest:
        print("SKIPPED: WSTEST does not name the wstest program of the Autobahn testsuite")
        return 77
    with tempfile.TemporaryDirectory() as folder, subprocess.Popen([arguments.echo], stdout=subprocess.PIPE, text=True) as server:
        try:
            reports = arguments.keep or os.path.join(folder, "reports")
            specification = os.path.join(folder, "fuzzingclient.json")
            with open(specification, "w", encoding="utf-8") as file:
                json.dump({"outdir": reports, "servers": [{"agent": "hermite", "url": f"ws://127.0.0.1:{int(server.stdout.readline())}"}],
                           "cases": arguments.cases, "exclude-cases": ["12.*", "13.*"], "exclude-agent-cases": {}}, file)
            subprocess.run([wstest, "-m", "fuzzingclient", "-s", specification], check=True, cwd=folder, timeout=PATIENCE_S)
            with open(os.path.join(reports, "index.json"), encoding="utf-8") as file:
                cases = json.load(file)["hermite"]
        finally:
            alive = server.poll() is None
            server.kill()
    counts = collections.Counter(case["behavior"] for case in cases.values())
    bad = {name: (case["behavior"], case["behaviorClose"]) for name, case in cases.items()
           if case["behavior"] not in GOOD or case["behaviorClose"] not in GOOD}
    for name, (behaviour, close) in sorted(bad.items()):
        print(f"FAILED: case {name}: {behaviour}, its close: {close}")
    if not alive:
        print("FAILED: the server died")
    print(f"{len(cases)} cases: " + ", ".join(f"{count} {behaviour}" for behaviour, count in counts.most_common()))
    return 0 if cases and not bad and alive else 1


if __name__ == "__main__":
    sys.exit(main())
