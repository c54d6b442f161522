"""Reports in a real browser, headless and cut off from the network: charts, tables and texts of the page.

Where CI is set a missing browser is a failure; elsewhere these tests are skipped. Debian: chromium, chromium-driver.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from shown.opened import Opened, near, until
from synthetic import LENGTH, wall_frames, wall_model
from synthetic.pages import HOSTILE

import dem_cli
from dem_cli.results.output.scalars import scalars

SMALL = """const touched = document.querySelectorAll("button, select, summary, label, input:not([type=checkbox])");
const low = (box) => box.width > 0 && (box.width < 44 || box.height < 44);
return [...touched].filter((e) => low(e.getBoundingClientRect())).map((e) => e.outerHTML)"""
SKY, DARK_SKY = (0xE9, 0xEE, 0xF3), (0x1E, 0x20, 0x23)  # of assets/scene.js


@pytest.mark.parametrize("name", ["wall", "evil", "sweep", "shaken", "tumbling"])
def test_no_page_complains_or_asks_for_anything(opened, name):
    page = opened(name)
    page.screen()
    assert page.complaints() == []
    assert [url for url in page.requests() if not url.startswith((page.folder.as_uri(), "data:"))] == []
    assert page.run("return document.title") != "hacked"


def test_the_policy_holds(opened):
    page = opened("wall")
    page.run("document.addEventListener('securitypolicyviolation', (e) => (window.broken = e.effectiveDirective))")
    for script, broken in (
        ("fetch('https://example.org').catch(() => 0)", "connect-src"),
        ("document.body.append(Object.assign(new Image(), {src: 'https://example.org/a.png'}))", "img-src"),
        ("const s = document.createElement('script'); s.text = 'alert(1)'; document.body.append(s)", "script-src-elem"),
    ):
        page.run(script)
        assert until(lambda: page.run("return window.broken"), broken)


def test_hostile_texts_are_shown_as_they_are(opened):
    page = opened("evil")
    assert page.find("h1").text == HOSTILE
    assert page.run("return document.querySelectorAll('main img, .warnings b').length") == 0
    assert "</pre><script>" in page.find("#case").get_attribute("textContent")
    page.run("dem.player.select(3)")
    assert page.run("return dem.player.data.ids[3]").startswith("</script><img")


def test_the_capacity_curve_and_the_view_follow_each_other(opened):
    page = opened("wall")
    mark = "const c = document.querySelector('.now circle'); return ['cx', 'cy'].map((name) => +c.getAttribute(name))"
    end = page.run(mark)
    page.keys(page.part("slider"), "\ue011")
    start = page.run(mark)
    assert start[0] < end[0] - 100
    frame = wall_frames(wall_model())[8]
    script = "return [dem.charts[0].px(1e3 * arguments[0]), dem.charts[0].py(arguments[1])]"
    expected = page.run(script, frame.displacement, frame.load)
    from selenium.webdriver import ActionChains

    svg = page.find("#chart-capacity svg")
    offset = np.rint(expected - 0.5 * page.box("#chart-capacity svg")[2:]).astype(int).tolist()
    ActionChains(page.browser, duration=0).move_to_element_with_offset(svg, *offset).click().perform()
    assert page.run("return dem.player.at") == 8
    assert page.run(mark) == pytest.approx(expected)
    assert "collapse: " in page.find("#chart-capacity .reading").text


def test_the_tables_hold_summary_json(opened):
    page = opened("wall")
    script = "return [...document.querySelectorAll('#numbers tr')].map((r) => [...r.cells].map((c) => c.textContent))"
    rows = dict(page.run(script))
    summary = json.loads((page.folder / "summary.json").read_text(encoding="utf-8"))
    for path, value in scalars(summary).items():
        listed = path.rpartition(".")
        text = rows[path] if path in rows else rows[listed[0]].split(", ")[int(listed[2])]
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            assert float(text) == value, path
        else:
            assert text == ("–" if value is None else str(value).lower() if isinstance(value, bool) else str(value))
    assert page.find("#summary").text.splitlines()[0] == "failure load 0.6402 (between 0.6395 and 0.6409)"
    assert page.find(".verdict").text == "reference: 0.64 ± 0.001: passed"


def test_a_time_history_opens_at_its_collapse_on_a_ground_that_moves(opened):
    page = opened("shaken")
    assert "collapsed at 4.2 s" in page.find(".answer").text
    assert page.run("return dem.player.scene.frame.time") == pytest.approx(4.2, abs=0.1)
    base, wanted = page.place(0), page.run("return dem.player.data.ground[dem.player.at][0]")
    moving = page.part("carried").is_selected()
    page.part("carried").click()
    shift = (page.place(0) - base)[0] * (-1 if moving else 1)
    metre = np.abs((page.place(2) - page.place(1))[0]) / LENGTH
    assert shift == pytest.approx(metre * wanted, abs=1.0)
    assert len(page.run("return document.querySelectorAll('#chart-displacement .line')")) == 2


def test_a_sweep_is_sorted_filtered_and_drawn(opened):
    page = opened("sweep")

    def cells(column):
        script = "return [...document.querySelectorAll('#runs tbody tr')].map((r) => r.cells[arguments[0]].textContent)"
        return page.run(script, column)

    def head(text):
        buttons = page.browser.find_elements("css selector", "#runs thead button")
        return next(button for button in buttons if button.text.split()[0] == text)

    assert cells(0) == [f"a{i}" for i in range(8)]
    head("failure_load").click()
    assert cells(5) == ["0.3", "0.3", "0.5", "0.5", "0.5", "0.7", "0.7", "–"]
    head("failure_load").click()
    assert cells(5)[0] == "0.7"
    assert cells(5)[-1] == "–"
    page.part("filter").send_keys("friction>=0.5 running")
    assert sorted(cells(0)) == ["a2", "a4", "a6"]
    assert page.part("count").text == "3 of 8 runs"
    assert len(page.run("return document.querySelectorAll('#chart-sweep circle:not(.pointer)')")) == 3
    page.part("filter").clear()
    page.part("filter").send_keys("thin")
    assert cells(4) == ["<i>too thin</i>"]
    page.part("filter").send_keys("\ue009a\ue003")  # control-a, backspace
    assert [line["name"] for line in page.run("return dem.runs.chart.spec.lines")] == ["running", "stack"]
    assert page.run("return document.querySelector('#runs a').getAttribute('href')") == "runs/a0/summary.json"


def test_runs_of_a_sweep_without_an_answer_are_drawn_as_in_the_picture(opened):
    """They were left out: of what was not found the chart said nothing."""
    page = opened("sweep")
    page.run(
        """const data = dem.runs.data, load = data.columns.indexOf("failure_load");
        data.columns.push("failure_load_bracket.0", "failure_load_bracket.1");
        const known = { a0: [0.25, 0.35], a2: [0.4, 0.9], a3: [0.2, null] };
        for (const row of data.rows) row.push(...(known[row[0]] ?? [null, null]));
        for (const row of data.rows) if (["a2", "a3"].includes(row[0])) row[load] = null;
        dem.runs.show()"""
    )
    spans = page.run("return dem.runs.chart.spans.map((span) => [span.x, span.low, span.high, span.alone])")
    assert sorted(spans) == [[0.3, 0.25, 0.35, False], [0.5, 0.2, None, True], [0.5, 0.4, 0.9, True]]
    assert page.run("return document.querySelectorAll('#chart-sweep .span.alone').length") == 2
    assert page.run("return dem.runs.chart.spec.missing") == [1.0]
    assert page.run("return document.querySelectorAll('#chart-sweep circle:not(.pointer)').length") == 5
    legend = page.run("return [...document.querySelectorAll('#chart-sweep .legend li')].map((one) => one.innerText)")
    assert legend == ["running", "stack", "bracket, no answer", "no answer"]
    assert page.run("return dem.runs.chart.range('y')[1]") > 0.9
    assert page.complaints() == []


def test_small_screens_and_the_dark(opened, browser):
    phone = {"width": 390, "height": 800, "deviceScaleFactor": 1, "mobile": True}
    dark = {"features": [{"name": "prefers-color-scheme", "value": "dark"}]}
    try:
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", phone)
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", dark)
        for name in ("sweep", "solid", "wall"):
            page = opened(name)
            assert page.run("return document.documentElement.scrollWidth") == 390
            assert page.run(SMALL) == []
        corner = page.box("canvas")[:2] + np.array((6, 60))
        assert near(page.colour(corner), DARK_SKY)
        page.find("#theme").click()
        assert near(page.colour(corner), SKY)
    finally:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


def test_a_cell_of_a_notebook_holds_the_answer_and_a_player(browser, pages, tmp_path):
    with dem_cli.open(pages["wall"]) as result:
        (tmp_path / "report.html").write_text(f"<p>a notebook</p>{result._repr_html_()}", encoding="utf-8")
    page = Opened(browser, tmp_path)
    assert until(lambda: page.run("return document.querySelector('iframe').offsetHeight > 641"), True)
    assert page.run("return document.documentElement.scrollWidth <= innerWidth")
    browser.switch_to.frame(page.find("iframe"))
    try:
        assert page.run("return document.documentElement.scrollHeight <= innerHeight + 1")
        assert page.find(".answer strong").text == "0.6402"
        before = page.run("return dem.player.at")
        page.keys(page.part("canvas"), "\ue012")
        assert page.run("return dem.player.at") == before - 1
    finally:
        browser.switch_to.default_content()
    assert page.complaints() == []
    assert [url for url in page.requests() if not url.startswith(("file:", "data:", "about:"))] == []


def test_without_webgl_the_rest_of_the_page_works(opened, browser):
    refuse = "HTMLCanvasElement.prototype.getContext = () => null"
    script = browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": refuse})
    try:
        page = opened("wall")
        assert page.find(".without-webgl").is_displayed()
        assert not page.part("canvas").is_displayed()
        assert len(page.run("return document.querySelectorAll('.chart svg .line')")) > 5
        assert not [text for text in page.complaints() if "Uncaught" in text]
    finally:
        browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", script)


def test_paper(opened):
    page = opened("wall")
    page.run("addEventListener('beforeprint', () => (window.unfolded = document.querySelector('details.print').open))")
    found = page.browser.execute_cdp_cmd("Page.printToPDF", {"printBackground": True})
    assert found["data"].startswith("JVBERi")  # %PDF
    assert page.run("return window.unfolded") is True
    assert page.run("return document.querySelector('details.print').open") is False
