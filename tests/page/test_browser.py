"""The page in a real Chromium: it draws, filters and compares, asks nothing of a network, and is readable."""

import json
import re

import pytest
from axe_core_python.base import AXE_SCRIPT
from selenium import webdriver
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

from .conftest import CHROMIUM, DRIVER

pytestmark = pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="needs the Debian packages chromium, chromium-driver")


@pytest.fixture
def opened(browser, page):
    """The page, just opened at the width of a desk."""
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    browser.get(page.as_uri())
    return browser


def unfold(browser, selector):
    found = browser.find_element(By.CSS_SELECTOR, selector)
    browser.execute_script("arguments[0].open = true; arguments[0].scrollIntoView()", found)
    return found


def until(browser, condition):
    return WebDriverWait(browser, 20).until(lambda _: condition())


def choose(browser, details, label, value):
    """Take a choice as a user does: the change is announced."""
    browser.execute_script(
        "const labels = [...arguments[0].querySelectorAll('label')];"
        "const select = labels.find(l => l.firstChild.textContent === arguments[1]).querySelector('select');"
        "select.value = arguments[2];"
        "for (const name of ['input', 'change']) select.dispatchEvent(new Event(name, {bubbles: true}))",
        details, label, value)


def shown_rows(browser):
    return browser.execute_script("return [...document.querySelectorAll('details.cells tbody tr')]"
                                  ".filter(r => !r.hidden).map(r => [...r.cells].map(c => c.textContent))")


def ink(browser, canvas):
    """Colours on a canvas."""
    return browser.execute_script(
        "const c = arguments[0], d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data, s = new Set();"
        "for (let i = 0; i < d.length; i += 4) s.add(d[i] << 24 | d[i+1] << 16 | d[i+2] << 8 | d[i+3]); return s.size",
        canvas)


def test_it_asks_nothing_of_a_network_and_says_nothing_on_the_console(opened, page):
    unfold(opened, "details.explore")
    unfold(opened, "details.images")
    until(opened, lambda: opened.find_elements(By.CSS_SELECTOR, ".chart canvas"))
    events = [json.loads(entry["message"])["message"] for entry in opened.get_log("performance")]
    asked = {event["params"]["request"]["url"] for event in events if event["method"] == "Network.requestWillBeSent"}
    assert {url for url in asked if not url.startswith(("data:", "blob:"))} <= {page.as_uri()}
    assert opened.get_log("browser") == []


def test_every_figure_is_drawn(opened):
    opened.execute_script("document.querySelectorAll('details').forEach(d => d.open = true);"
                          "document.querySelectorAll('img').forEach(i => i.loading = 'eager')")
    until(opened, lambda: opened.execute_script("return [...document.images].every(i => i.complete)"))
    assert opened.execute_script("return [...document.images].every(i => i.naturalWidth > 0)")


def test_the_table_is_filtered_and_sorted(opened):
    details = unfold(opened, "details.cells")
    everything = len(shown_rows(opened))
    choose(opened, details, "k", "16")
    rows = shown_rows(opened)
    assert 0 < len(rows) < everything and {row[1] for row in rows} == {"16"}
    details.find_element(By.CSS_SELECTOR, "input[type=search]").send_keys("heap")
    until(opened, lambda: len(shown_rows(opened)) == 1)
    details.find_element(By.CSS_SELECTOR, "input[type=search]").clear()
    choose(opened, details, "k", "")
    opened.find_element(By.XPATH, "//th/button[text()='time (ms)']").send_keys(Keys.ENTER)
    times = opened.execute_script("return [...document.querySelectorAll('details.cells tbody tr')].map(r =>"
                                  "r.querySelector('[data-i]')?.textContent.split(' ')[0]).filter(Boolean).map(Number)")
    assert len(times) > 10 and times == sorted(times)


def test_charts_are_drawn_zoomed_and_changed(opened):
    details = unfold(opened, "details.explore")
    canvas = until(opened, lambda: opened.find_element(By.CSS_SELECTOR, ".chart canvas"))
    assert ink(opened, canvas) > 10
    names = opened.execute_script("return [...document.querySelectorAll('.u-legend .u-label')].map(l => l.textContent)")
    assert {"K⁺B-Heap", "AB_Array"} <= set(names)
    before = opened.get_screenshot_as_base64()
    choose(opened, details, "y", "memory (MiB)")
    until(opened, lambda: opened.get_screenshot_as_base64() != before)
    over = opened.find_element(By.CSS_SELECTOR, ".chart .u-over")
    webdriver.ActionChains(opened).move_to_element(over).perform()
    tip = opened.find_element(By.CSS_SELECTOR, ".chart .tip")
    until(opened, tip.is_displayed)
    assert ": " in tip.text
    before = opened.get_screenshot_as_base64()
    webdriver.ActionChains(opened).move_to_element_with_offset(over, -80, -60).click_and_hold().move_by_offset(
        160, 120).release().perform()
    until(opened, lambda: opened.get_screenshot_as_base64() != before)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_lines_of_charts_stand_out_from_the_page(opened, scheme):
    """Each has the contrast of 3 to 1 that WCAG 2 asks of graphics, also once the scheme changes."""
    unfold(opened, "details.explore")
    until(opened, lambda: opened.find_elements(By.CSS_SELECTOR, ".chart canvas"))
    for each in ({"light": "dark", "dark": "light"}[scheme], scheme):
        opened.execute_cdp_cmd("Emulation.setEmulatedMedia",
                               {"features": [{"name": "prefers-color-scheme", "value": each}]})

    def found():
        return opened.execute_script(
            "return [getComputedStyle(document.body).backgroundColor,"
            "[...document.querySelectorAll('.u-legend .u-marker')].map(m => getComputedStyle(m).borderTopColor)]")

    def all_stand_out():  # once the browser has told the page of the scheme
        ground, colours = found()
        return all(contrast(colour, ground) >= 3 for colour in colours)

    until(opened, all_stand_out)
    ground, colours = found()
    assert (contrast(ground, "rgb(0, 0, 0)") < 3) == (scheme == "dark") and len(set(colours)) > 5


def contrast(*colours):
    """The contrast of two colours as browsers write them (WCAG 2.2, relative luminance)."""
    def luminance(colour):
        shares = [int(value) / 255 for value in re.findall(r"\d+", colour)[:3]]
        linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in shares]
        return sum(weight * value for weight, value in zip((0.2126, 0.7152, 0.0722), linear, strict=True))
    low, high = sorted(map(luminance, colours))
    return (high + 0.05) / (low + 0.05)


def test_kept_images_are_compared(opened):
    details = unfold(opened, "details.images")
    canvas = until(opened, lambda: opened.find_element(By.CSS_SELECTOR, ".stage canvas"))
    until(opened, lambda: ink(opened, canvas) > 3)
    choose(opened, details, "shown", "difference × 1")
    until(opened, lambda: "Largest difference of a channel: 20 of 255." in details.text)
    for side in ("left", "right"):
        first = opened.execute_script("return document.querySelector('.compare option').value")
        choose(opened, details, side, first)
    until(opened, lambda: "Largest difference of a channel: 0 of 255." in details.text)


def test_shaders_are_unpacked_and_chosen(opened):
    details = unfold(opened, "#shaders details")
    text = until(opened, lambda: opened.find_element(By.CSS_SELECTOR, "#shaders pre"))
    assert "#version 430 core" in text.text
    choose(opened, details, "method", "kplus-heap (k 16)")
    choose(opened, details, "pass and stage", "1")
    assert "void main()" in text.get_attribute("textContent")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [400, 1200])
def test_it_is_accessible_and_fits(opened, scheme, width):
    """axe-core finds no violation, and nothing but wide tables scrolls sideways."""
    opened.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                           {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False})
    opened.execute_cdp_cmd("Emulation.setEmulatedMedia",
                           {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
    opened.execute_script("document.querySelectorAll('details').forEach(d => d.open = true)")
    until(opened, lambda: opened.find_elements(By.CSS_SELECTOR, ".chart canvas"))
    assert opened.execute_script("const e = document.documentElement; return e.scrollWidth <= e.clientWidth")
    opened.execute_script(AXE_SCRIPT)
    found = opened.execute_async_script("axe.run().then(arguments[arguments.length - 1])")
    assert [(v["id"], [n["html"][:120] for n in v["nodes"][:3]]) for v in found["violations"]] == []


def test_without_a_script_everything_is_there(browser, page):
    browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    try:
        browser.get(page.as_uri())
        source = browser.page_source
    finally:
        browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})
    assert source.count("<img ") == 3 and source.count("<tr data-m=") > 60
    assert browser.get(page.as_uri()) is None
