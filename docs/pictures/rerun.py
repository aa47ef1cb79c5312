#!/usr/bin/env python3
"""Takes a picture of a Rerun recording: opens it in the viewer, moves to a moment, saves what the viewer shows.

    python3 docs/pictures/rerun.py run.rrd rerun.png --at 52 --size 1600x900

Needs the viewer (`rerun`, of the version that the recording was written with) and a Vulkan driver; a software one will
do (Mesa's lavapipe). The viewer draws without a window where it can; with `--window` it gets a screen from Xvfb.
"""

import argparse
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path


class Remote:
    """The viewer's remote control: one JSON document a line, each answered by one."""

    def __init__(self, port):
        self.process = subprocess.Popen(
            ["rerun", "viewer-mcp"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        self.count = 0
        self.ask(
            "initialize",
            {"protocolVersion": "2024-11-05", "capabilities": {}, "clientInfo": {"name": "picture", "version": "1"}},
        )
        self.send({"method": "notifications/initialized"})
        self.do("connect", endpoint=f"http://127.0.0.1:{port}")

    def send(self, message):
        self.process.stdin.write(json.dumps({"jsonrpc": "2.0"} | message) + "\n")
        self.process.stdin.flush()

    def ask(self, method, params):
        self.count += 1
        self.send({"id": self.count, "method": method, "params": params})
        while True:
            line = self.process.stdout.readline()
            if not line:
                sys.exit("the viewer's remote control ended")
            answer = json.loads(line)
            if answer.get("id") == self.count:
                return answer

    def do(self, name, **arguments):
        answer = self.ask("tools/call", {"name": name, "arguments": arguments})
        result = answer.get("result", {})
        text = " ".join(part.get("text", "") for part in result.get("content", []))
        if "error" in answer or result.get("isError"):
            sys.exit(f"{name}: {answer.get('error', text)}")
        return text

    def close(self):
        self.process.stdin.close()
        self.process.wait(timeout=10)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def wait_for(condition, what, limit_s=60):
    start = time.monotonic()
    while not condition():
        if time.monotonic() - start > limit_s:
            sys.exit(f"{what} did not come within {limit_s} s")
        time.sleep(0.2)


def listens(port):
    with socket.socket() as probe:
        probe.settimeout(0.5)
        return probe.connect_ex(("127.0.0.1", port)) == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recording", type=Path)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--at", type=float, default=0.0, help="moment on the timeline [s]")
    parser.add_argument("--size", default="1600x900", help="points across and down")
    parser.add_argument("--scale", type=float, default=1.0, help="pixels in a point")
    parser.add_argument("--click", help="click on this point first, for example 1175x42 on a tab")
    parser.add_argument("--trim", type=int, default=0, help="points to cut off at the top (needs Pillow)")
    parser.add_argument("--window", action="store_true", help="draw in a window on a screen of its own (Xvfb)")
    options = parser.parse_args()
    if shutil.which("rerun") is None:
        sys.exit("no `rerun` on the PATH; `pip install rerun-sdk` of the recording's version brings it")
    if not options.recording.is_file():
        sys.exit(f"{options.recording}: no such file")
    if not re.fullmatch(r"\d+x\d+", options.size):
        sys.exit(f"found size `{options.size}`, expected for example 1600x900")
    width, height = (int(part) for part in options.size.split("x"))

    port = free_port()
    viewer = ["rerun", str(options.recording), "--port", str(port), "--hide-welcome-screen"]
    viewer += ["--renderer", "vulkan", "--window-size", options.size]
    if options.window:
        viewer = ["xvfb-run", "-a", "-s", f"-screen 0 {options.size}x24", *viewer]
    else:
        viewer.append("--headless")
    picture = options.picture.resolve()
    picture.unlink(missing_ok=True)
    process = subprocess.Popen(
        viewer, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True, env=os.environ
    )
    try:
        wait_for(lambda: process.poll() is not None or listens(port), "the viewer")
        if process.poll() is not None:
            sys.exit(f"the viewer ended with status {process.returncode}")
        remote = Remote(port)
        wait_for(lambda: '"time"' in remote.do("viewer_state"), "the recording")
        remote.do("resize", width=width, height=height)
        remote.do("wait_for", min_steps=20, timeout_secs=60)
        if options.click:
            across, down = (float(part) for part in options.click.split("x"))
            remote.do("click", pos={"x": across, "y": down})
        remote.do("set_time", timeline="time", time=round(options.at * 1e9))
        remote.do("wait_for", min_steps=90, timeout_secs=120)
        remote.do("screenshot", pixels_per_point=options.scale, save_path=str(picture))
        wait_for(picture.is_file, "the picture", 20)
        remote.close()
        if options.trim:
            from PIL import Image

            whole = Image.open(picture).convert("RGB")
            whole.crop((0, round(options.trim * options.scale), *whole.size)).save(picture, optimize=True)
    finally:
        try:
            os.killpg(process.pid, 15)
        except ProcessLookupError:
            pass
        process.wait(timeout=20)


if __name__ == "__main__":
    main()
