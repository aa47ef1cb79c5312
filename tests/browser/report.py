#!/usr/bin/env python3
"""Opens a report in headless Chromium and checks that every plot is drawn and that nothing went wrong.

usage: report.py REPORT.html [--shots FOLDER] [--part TITLE FILE.png]

--shots takes pictures of the whole page; --part takes one of the plot of this title.

Needs python 3 and a Chromium, nothing else: the browser is spoken to over its DevTools pipe. The browser is the one of
HEADLAND_CHROMIUM, else the first of chromium, chromium-browser, google-chrome, chrome on the PATH. Without a browser the
test is skipped with a line that says so, or fails if HEADLAND_BROWSER is "required".
"""

import base64
import json
import os
import pathlib
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time

NAMES = ["chromium", "chromium-browser", "google-chrome", "chrome"]
# Seconds for one answer of the browser: a cold start on a busy machine takes a while.
PATIENCE = 90.0

# Of each plot: its shapes with an outline that is not empty, and how far its drawing reaches beyond its frame.
LOOK = """
(() => [...document.querySelectorAll('.plot')].map((plot) => {
  const svg = plot.querySelector('svg');
  const shapes = svg ? [...svg.querySelectorAll('path,circle,rect,polygon,polyline,line')] : [];
  const drawn = shapes.filter((one) => one.tagName !== 'path' || (one.getAttribute('d') ?? '').length > 4);
  const bad = svg ? /NaN|undefined/.test(svg.innerHTML.replace(/<text[^]*?<\\/text>/g, '')) : true;
  const title = document.getElementById('t' + plot.id.slice(1)).textContent;
  return {title, shapes: drawn.length, bad, label: plot.getAttribute('aria-label') ?? '', width: svg?.clientWidth ?? 0};
}))()
"""
# What the page is wider than its window, in pixels.
OVERFLOW = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
# Where the plot of a title stands on the page; null where there is none.
PART = """
((title) => {
  const head = [...document.querySelectorAll('figure h3')].find((one) => one.textContent === title)?.closest('figure');
  if (!head) return null;
  const {x, y, width, height} = head.getBoundingClientRect();
  return {x: x + window.scrollX - 8, y: y + window.scrollY - 8, width: width + 16, height: height + 16, scale: 1};
})
"""
# A drag over the middle of the first plot over time has to zoom all plots of its section, and a double click to undo it.
ZOOM = """
(() => {
  const frames = [...document.querySelectorAll('section')].map((s) => [...s.querySelectorAll('.plot[data-linked]')]).find((p) => p.length > 1);
  if (!frames) return null;
  const charts = frames.map((frame) => echarts.getInstanceByDom(frame));
  const ends = () => charts.map((c) => { const z = c.getOption().dataZoom[0]; return [Math.round(z.start), Math.round(z.end)]; });
  charts[0].dispatchAction({type: 'dataZoom', dataZoomIndex: 0, start: 30, end: 60});
  return new Promise((done) => setTimeout(() => {
    const zoomed = ends();
    charts[0].dispatchAction({type: 'dataZoom', dataZoomIndex: 0, start: 0, end: 100});
    setTimeout(() => done({zoomed, whole: ends()}), 200);
  }, 200));
})()
"""


class Browser:
    """A headless browser that reads commands from its descriptor 3 and answers on 4, each ended by a zero byte."""

    def __init__(self, program, folder):
        command_read, self.commands = os.pipe()
        self.answers, answer_write = os.pipe()

        def descriptors():
            # Through high numbers first, so that neither is closed by the other.
            read, write = os.dup(command_read), os.dup(answer_write)
            high_read, high_write = 60, 61
            os.dup2(read, high_read)
            os.dup2(write, high_write)
            os.dup2(high_read, 3)
            os.dup2(high_write, 4)

        self.process = subprocess.Popen(
            [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
             "--hide-scrollbars", "--remote-debugging-pipe", f"--user-data-dir={folder}", "about:blank"],
            preexec_fn=descriptors, pass_fds=[3, 4], start_new_session=True,
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(command_read)
        os.close(answer_write)
        self.buffer = b""
        self.number = 0
        self.session = None
        self.events = []

    def receive(self, deadline):
        while b"\0" not in self.buffer:
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self.answers], [], [], left)[0]:
                raise TimeoutError("the browser does not answer")
            chunk = os.read(self.answers, 1 << 20)
            if not chunk:
                raise ConnectionError("the browser ended")
            self.buffer += chunk
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, **params):
        self.number += 1
        message = {"id": self.number, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.commands, json.dumps(message).encode() + b"\0")
        deadline = time.monotonic() + PATIENCE
        while True:
            answer = self.receive(deadline)
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    def wait_for(self, method):
        deadline = time.monotonic() + PATIENCE
        while not any(event.get("method") == method for event in self.events):
            self.events.append(self.receive(deadline))

    def value_of(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"].get("exception", {}).get("description", expression))
        return result["result"].get("value")

    def open(self, page):
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ["Page", "Runtime", "Log", "Network"]:
            self.call(f"{domain}.enable")
        self.show(1280, False)
        self.events.clear()
        self.call("Page.navigate", url=page.resolve().as_uri())
        self.wait_for("Page.loadEventFired")

    def show(self, width, dark):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=width < 500)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])

    def settle(self):
        """Waits until the page has drawn all of its plots after a change of its window."""
        time.sleep(0.5)
        deadline = time.monotonic() + PATIENCE
        while self.value_of("document.body.dataset.drawn") != "all":
            if time.monotonic() > deadline:
                raise TimeoutError("the page does not finish its plots")
            time.sleep(0.1)

    def shoot(self, path):
        shot = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True)
        path.write_bytes(base64.b64decode(shot["data"]))

    def shoot_part(self, title, path):
        clip = self.value_of(f"{PART}({json.dumps(title)})")
        if clip is None:
            raise RuntimeError(f"no plot is called `{title}`")
        shot = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=True, clip=clip)
        path.write_bytes(base64.b64decode(shot["data"]))

    def complaints(self):
        found = []
        for event in self.events:
            method, params = event.get("method"), event.get("params", {})
            if method == "Runtime.exceptionThrown":
                details = params["exceptionDetails"]
                found.append("exception: " + details.get("exception", {}).get("description", details["text"]))
            elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning", "assert"):
                found.append(f"console {params['type']}: " + " ".join(str(a.get("value", a.get("description"))) for a in params["args"]))
            elif method == "Log.entryAdded" and params["entry"]["level"] == "error":
                found.append("log: " + params["entry"]["text"])
            elif method == "Network.requestWillBeSent" and not params["request"]["url"].startswith(("file:", "data:", "blob:")):
                found.append("the page asked for " + params["request"]["url"])
        return found

    def close(self):
        try:
            self.session = None
            self.call("Browser.close")
            self.process.wait(20)
        except (OSError, RuntimeError, TimeoutError, subprocess.TimeoutExpired):
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()


def check(browser, page, shots, part):
    """Looks at the page at two widths in light and dark; a list of what is wrong."""
    wrong = []
    browser.open(page)
    for width, dark in [(1280, False), (1280, True), (400, False), (400, True)]:
        browser.show(width, dark)
        browser.settle()
        where = f"at {width} px, {'dark' if dark else 'light'}"
        plots = browser.value_of(LOOK)
        for plot in plots:
            # The axes alone are a handful of shapes; nothing at all means that drawing failed.
            if plot["shapes"] < 2:
                wrong.append(f"{where}: `{plot['title']}` is not drawn ({plot['shapes']} shapes)")
            if plot["bad"]:
                wrong.append(f"{where}: `{plot['title']}` is drawn at places that are no numbers")
            if not plot["label"]:
                wrong.append(f"{where}: `{plot['title']}` has no words for those who cannot see it")
        overflow = browser.value_of(OVERFLOW)
        if overflow > 0:
            wrong.append(f"{where}: the page is {overflow} px wider than its window")
        if shots:
            browser.shoot(shots / f"{width}_{'dark' if dark else 'light'}.png")
    if part:
        browser.show(1280, False)
        browser.settle()
        browser.shoot_part(*part)
    expected = browser.value_of("JSON.parse(document.getElementById('plots').textContent).length")
    if len(plots) != expected:
        wrong.append(f"{expected} plots have data and {len(plots)} a place")
    zoom = browser.value_of(ZOOM)
    if zoom and any(ends != [30, 60] for ends in zoom["zoomed"]):
        wrong.append(f"plots over time do not zoom together: {zoom['zoomed']}")
    if zoom and any(ends != [0, 100] for ends in zoom["whole"]):
        wrong.append(f"plots over time do not come back together: {zoom['whole']}")
    return len(plots), wrong + browser.complaints()


def main():
    arguments = sys.argv[1:]
    shots = None
    if "--shots" in arguments:
        at = arguments.index("--shots")
        shots = pathlib.Path(arguments[at + 1])
        shots.mkdir(parents=True, exist_ok=True)
        del arguments[at:at + 2]
    part = None
    if "--part" in arguments[:-2]:
        at = arguments.index("--part")
        part = (arguments[at + 1], pathlib.Path(arguments[at + 2]))
        del arguments[at:at + 3]
    if len(arguments) != 1 or not pathlib.Path(arguments[0]).is_file():
        print(__doc__, file=sys.stderr)
        return 2
    program = os.environ.get("HEADLAND_CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        required = os.environ.get("HEADLAND_BROWSER") == "required"
        print(("failed" if required else "skipped") + ": no browser; looked for " + ", ".join(NAMES))
        return 1 if required else 0
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        browser = Browser(program, folder)
        try:
            plots, wrong = check(browser, pathlib.Path(arguments[0]), shots, part)
        except (OSError, RuntimeError, TimeoutError) as error:
            plots, wrong = 0, [str(error), *browser.complaints()]
        finally:
            browser.close()
    for line in wrong:
        print("wrong: " + line)
    print(f"{arguments[0]}: {plots} plots, " + (f"{len(wrong)} things wrong" if wrong else "all drawn, nothing logged"))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
