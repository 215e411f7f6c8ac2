#!/usr/bin/python3
"""Prints the ten slowest of the tests whose results GoogleTest has written as JSON.

    slowest_tests.py FOLDER
"""
import json
import pathlib
import sys

tests = []
for path in pathlib.Path(sys.argv[1]).glob("*.json"):
    try:
        suites = json.loads(path.read_text(encoding="utf-8"))["testsuites"]
    except ValueError:
        continue  # of a program that was ended while it wrote
    for suite in suites:
        tests += [(float(test["time"].rstrip("s")), f"{suite['name']}.{test['name']}") for test in suite["testsuite"]]
print("The slowest tests:")
for seconds, name in sorted(tests, reverse=True)[:10]:
    print(f"  {seconds:6.1f} s  {name}")
