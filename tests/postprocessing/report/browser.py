# SPDX-License-Identifier: GPL-3.0-or-later
"""A page in headless Chromium, by the DevTools protocol over a pipe: messages are JSON, each ended by a zero byte.

    with Browser() as browser:
        page = browser.open(path, width=400, dark=True)  # in the one tab there is, for another takes a second of processor time
        page.value("document.title")                    # of an expression, or of what a promise gives
        page.errors                                     # exceptions and errors on the console so far
"""
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

PROGRAM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
PATIENCE = 60.0  # seconds


class Browser:
    def __enter__(self):
        self.folder = tempfile.mkdtemp(prefix="haffChromium")
        out, self.to = os.pipe()
        self.back, into = os.pipe()
        command = [PROGRAM, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars", "--no-first-run",
                   f"--user-data-dir={self.folder}", "--remote-debugging-pipe", "about:blank"]

        def pipes():  # the protocol is on the descriptors 3 and 4
            a, b = os.dup(out), os.dup(into)
            os.dup2(a, 3)
            os.dup2(b, 4)

        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=pipes, pass_fds=(3, 4))
        os.close(out)
        os.close(into)
        self.rest, self.count, self.events = b"", 0, []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Runtime", "Log", "Page"):
            self.call(f"{domain}.enable", self.session)
        return self

    def __exit__(self, *_):
        try:
            self.call("Browser.close")
            self.process.wait(10)
        except (OSError, AssertionError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        os.close(self.to)
        os.close(self.back)
        shutil.rmtree(self.folder, ignore_errors=True)

    def message(self):
        """The next message; AssertionError where none comes."""
        until = time.monotonic() + PATIENCE
        while b"\0" not in self.rest:
            ready, _, _ = select.select([self.back], [], [], max(until - time.monotonic(), 0))
            part = os.read(self.back, 1 << 20) if ready else b""
            if not part:
                raise AssertionError("Chromium does not answer")
            self.rest += part
        text, _, self.rest = self.rest.partition(b"\0")
        return json.loads(text)

    def call(self, method, session=None, **parameters):
        self.count += 1
        asked = {"id": self.count, "method": method, "params": parameters, **({"sessionId": session} if session else {})}
        os.write(self.to, json.dumps(asked).encode() + b"\0")
        while True:
            told = self.message()
            if told.get("id") == self.count:
                if "error" in told:
                    raise AssertionError(f"{method}: {told['error']}")
                return told["result"]
            self.events.append(told)

    def looks(self, paths):
        """(path, page, width, dark) of each page, wide and light, narrow and dark; every other one is loaded narrow."""
        for k, path in enumerate(paths):
            one, other = ((1280, False), (400, True))[::1 - 2 * (k % 2)]
            page = self.open(path, width=one[0], dark=one[1])
            yield path, page, *one
            page.change(*other)
            yield path, page, *other

    def open(self, path, width=1280, height=900, dark=False):
        self.events = []
        return Page(self, path, width, height, dark)


class Page:
    def __init__(self, browser, path, width, height, dark):
        self.browser = browser
        self.emulate(width, height, dark)
        self.call("Page.navigate", url="file://" + os.path.abspath(path))
        self.value("new Promise(done => document.readyState == 'complete' ? done() : addEventListener('load', done))")
        self.drawn()

    def emulate(self, width, height, dark):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def drawn(self):
        self.value("new Promise(done => requestAnimationFrame(() => setTimeout(done, 50)))")

    def change(self, width, dark):
        """The same page on another screen, without loading it again, which takes half a second of processor time."""
        self.emulate(width, 900, dark)
        self.drawn()

    def call(self, method, **parameters):
        return self.browser.call(method, self.browser.session, **parameters)

    def mine(self, *methods):
        return [e for e in self.browser.events if e.get("method") in methods]

    def wait(self, method, count=1):
        """Until an event of that name has come so often."""
        while len(self.mine(method)) < count:
            self.browser.events.append(self.browser.message())

    def value(self, expression):
        found = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in found:
            raise AssertionError(f"{expression}: {found['exceptionDetails']}")
        return found["result"].get("value")

    @property
    def errors(self):
        thrown = [e["params"]["exceptionDetails"] for e in self.mine("Runtime.exceptionThrown")]
        told = [e["params"] for e in self.mine("Runtime.consoleAPICalled") if e["params"]["type"] in ("error", "warning", "assert")]
        logged = [e["params"]["entry"] for e in self.mine("Log.entryAdded") if e["params"]["entry"]["level"] in ("error", "warning")]
        return thrown + told + logged
