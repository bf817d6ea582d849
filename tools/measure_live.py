#!/usr/bin/env python3
"""Measures whether viewers slow the control loop: the same live run without a viewer, with viewers that take all they are
sent, and with viewers that take nothing, in turns. Prints medians and range of the ticks' percentiles [us].

    tools/measure_live.py [--program build/bin/ajar] [--scenario scenarios/kinematic_door.toml] [--repeats 7]
"""
import argparse
import json
import pathlib
import re
import socket
import statistics
import subprocess
import tempfile
import threading
import urllib.parse

VIEWERS = 3


def connect(address):
    """A viewer that asks for the events and then reads nothing: its buffers fill, the server's writes block."""
    url = urllib.parse.urlparse(address)
    viewer = socket.socket()
    viewer.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
    viewer.connect((url.hostname, url.port))
    viewer.sendall(f"GET {url.path}events HTTP/1.1\r\nHost: {url.netloc}\r\n\r\n".encode())
    return viewer


def read_all(viewer):
    try:
        while viewer.recv(65536):
            pass
    except OSError:
        pass


def run(arguments, viewers, reading):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "run"
        command = [arguments.program, "run", arguments.scenario, "--quiet", "--out", out]
        command += ["--live", "--speed", str(arguments.speed)]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        address = re.search(r"http\S+", process.stderr.readline()).group()
        sockets = [connect(address) for _ in range(viewers)]
        for viewer in sockets if reading else []:
            threading.Thread(target=read_all, args=(viewer,), daemon=True).start()
        process.communicate()
        for viewer in sockets:
            viewer.close()
        return json.loads((out / "result.json").read_text())["tick_us"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/bin/ajar")
    parser.add_argument("--scenario", default="scenarios/kinematic_door.toml")
    parser.add_argument("--speed", type=float, default=4.0, help="times real time; 0 = as fast as it goes")
    parser.add_argument("--repeats", type=int, default=7)
    arguments = parser.parse_args()
    cases = {"no viewer": (0, False), f"{VIEWERS} reading viewers": (VIEWERS, True), f"{VIEWERS} stuck viewers": (VIEWERS, False)}
    found = {name: [] for name in cases}
    for _ in range(arguments.repeats):
        for name, case in cases.items():
            found[name].append(run(arguments, *case))
    print(f"{'':<26}{'p50':>8}{'p99':>8}{'p99.9':>8}{'p99.9 of the single runs':>30}")
    for name, ticks in found.items():
        p50, p99, p999 = (statistics.median(t[k] for t in ticks) for k in ("p50", "p99", "p999"))
        single = [round(t["p999"]) for t in ticks]
        print(f"{name:<26}{p50:>8.1f}{p99:>8.1f}{p999:>8.1f}{min(single):>20} to {max(single)}")


if __name__ == "__main__":
    main()
