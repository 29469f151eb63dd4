"""A headless Chromium that looks at a page, for tests and pictures."""

import contextlib
import os
import shutil
import time

import pytest

ARGUMENTS = (
    '--headless=new --no-sandbox --disable-gpu --disable-quic --no-first-run '
    '--disable-background-networking --disable-component-update --disable-sync --hide-scrollbars'
).split()


@contextlib.contextmanager
def browser(width=1440, height=900):
    """Give a browser window; skip the test where there is none."""
    webdriver = pytest.importorskip('selenium.webdriver')
    binary, driver = shutil.which('chromium'), shutil.which('chromedriver')
    if not binary or not driver:
        pytest.skip('chromium and chromedriver are not installed')
    options = webdriver.ChromeOptions()
    options.binary_location = binary
    for argument in (*ARGUMENTS, f'--window-size={width},{height}'):
        options.add_argument(argument)
    options.set_capability('goog:loggingPrefs', {'browser': 'ALL'})
    # The driver asks the network for nothing if it is told where the program is.
    service = webdriver.ChromeService(driver, env={**os.environ, 'SE_OFFLINE': 'true'})
    window = webdriver.Chrome(options=options, service=service)
    try:
        yield window
    finally:
        window.quit()


def wait_until(true, seconds=60.0):
    """Wait until `true()` is; return what it gave."""
    end = time.monotonic() + seconds
    while not (found := true()):
        if time.monotonic() > end:
            pytest.fail(f'not within {seconds:g} s: {true.__doc__ or true}')
        time.sleep(0.1)
    return found


def picture(window, path, width, height):
    """Save a picture of the whole page at a width, however long it is."""
    size = {'width': width, 'height': height, 'deviceScaleFactor': 1, 'mobile': width < 500}
    window.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', size)
    time.sleep(1.0)
    size['height'] = window.execute_script('return document.documentElement.scrollHeight')
    window.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', size)
    time.sleep(1.0)
    window.save_screenshot(str(path))
