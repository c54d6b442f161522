"""A report that is open in a browser: what it shows, where, and what it says."""

from __future__ import annotations

import io
import json
import time

import numpy as np


class Opened:
    """A page in the browser."""

    def __init__(self, browser, folder):
        self.browser, self.folder = browser, folder
        browser.get_log("browser"), browser.get_log("performance")
        browser.get((folder / "report.html").as_uri())

    def run(self, script, *arguments):
        return self.browser.execute_script(script, *arguments)

    def find(self, selector):
        return self.browser.find_element("css selector", selector)

    def part(self, name):
        return self.find(f'[data-part="{name}"]')

    def screen(self):
        """The window as it is drawn, (height, width, 3)."""
        from PIL import Image

        self.run("dem.player && dem.player.scene.draw()")
        return np.asarray(Image.open(io.BytesIO(self.browser.get_screenshot_as_png())).convert("RGB")).astype(int)

    def canvas(self):
        """The picture of the structure, without what is written on it."""
        left, top, width, height = np.rint(self.box("canvas")).astype(int)
        return self.screen()[top + 40 : top + height - 60, left + 2 : left + width - 2]

    def place(self, block):
        """Where the centroid of a block is in the window."""
        return np.array(self.run("return dem.player.scene.eye.place(arguments[0])", block))

    def colour(self, place, screen=None):
        x, y = np.rint(place).astype(int)
        return tuple((self.screen() if screen is None else screen)[y, x])

    def keys(self, element, *keys):
        element.send_keys(*keys)

    def complaints(self):
        """Lines of the console, but for the driver's, which finds that pictures of the window take time."""
        said = [entry["message"] for entry in self.browser.get_log("browser")]
        return [text for text in said if "GL Driver Message (OpenGL, Performance" not in text]

    def box(self, selector):
        """Left, top, width and height of an element in the window."""
        script = "return document.querySelector(arguments[0]).getBoundingClientRect().toJSON()"
        found = self.run(script, selector)
        return np.array([found[name] for name in ("left", "top", "width", "height")])

    def requests(self):
        """Addresses that the page asked for."""
        messages = [json.loads(entry["message"])["message"] for entry in self.browser.get_log("performance")]
        return [m["params"]["request"]["url"] for m in messages if m["method"] == "Network.requestWillBeSent"]


def near(found, wanted, tolerance=3):
    return max(abs(a - b) for a, b in zip(found, wanted, strict=True)) <= tolerance


def until(ask, wanted, seconds=10.0):
    """Whether the answer comes in time."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if ask() == wanted:
            return True
        time.sleep(0.05)
    return False
