"""The page in a real browser, fed by a machine in this process."""

import asyncio
import contextlib
import os
import threading
from pathlib import Path

import pytest

pytest.importorskip('aiohttp')

from web.browser import browser, picture, wait_until

from gear_dynamics.model.faults import KINDS
from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.parameters.settings import SimSettings
from gear_dynamics.web.hub import Hub
from gear_dynamics.web.local import LocalMachine
from gear_dynamics.web.server import PageServer


@contextlib.contextmanager
def served_machine():
    """Give the address of a page that shows a machine."""
    hub = Hub('the machine starts', tuple(KINDS))
    server = PageServer(hub, '127.0.0.1', 0)
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, daemon=True)
    thread.start()
    asyncio.run_coroutine_threadsafe(server.start(), loop).result()
    machine = LocalMachine(hub, GearPair(), SimSettings())
    machine.start()
    try:
        yield server.address
    finally:
        machine.stop()
        asyncio.run_coroutine_threadsafe(server.stop(), loop).result()
        loop.call_soon_threadsafe(loop.stop)
        thread.join()


class Page:
    """What a user sees and does."""

    def __init__(self, window):
        self.window = window

    def text(self, name):
        return self.window.execute_script(f'return document.getElementById("{name}").textContent')

    def use(self, name, value):
        """Give a control a value, as a hand would."""
        self.window.execute_script(
            'const control = document.getElementById(arguments[0]); control.value = arguments[1];'
            'control.dispatchEvent(new Event("input")); control.dispatchEvent(new Event("change"))',
            name,
            value,
        )

    def drawn(self, panel):
        """Return the picture in a panel as text."""
        return self.window.execute_script(
            f'return document.querySelector("#{panel} canvas")?.toDataURL() ?? ""'
        )

    def data(self, panel):
        """Return the rows that a panel's CSV button saves."""
        text = self.window.execute_async_script(
            'const done = arguments[1]; const make = URL.createObjectURL;'
            'URL.createObjectURL = (blob) => { blob.text().then(done); return make(blob); };'
            'for (const button of document.querySelectorAll(`#${arguments[0]} button`))'
            '  if (button.textContent === "CSV") button.click();'
            'URL.createObjectURL = make;',
            panel,
        )
        return [line.split(',') for line in text.split()]


def highest_line(page, low, high):
    """Return the frequency of the highest line of the spectrum panel between two frequencies."""
    rows = [(float(f), float(a)) for f, a in page.data('spectrum')[1:]]
    return max((a, f) for f, a in rows if low <= f <= high)[1]


def keep_pictures(window):
    """Save the pictures of the documents, if a folder for them is given."""
    folder = os.environ.get('PAGE_PICTURES')
    if folder:
        picture(window, Path(folder) / 'page.png', 1440, 900)
        window.execute_script("location.hash += '&theme=dark'")
        picture(window, Path(folder) / 'page_dark.png', 1024, 768)
        window.execute_script("location.hash = location.hash.replace('theme=dark', '')")
        picture(window, Path(folder) / 'page_phone.png', 390, 844)


def test_the_page_shows_the_machine_and_steers_it():
    with served_machine() as address, browser() as window:
        window.get(f'{address}#channels=gear_ay,mesh_force&spectrum=gear_ay')
        page = Page(window)
        wait_until(lambda: 'period-1' in page.text('state'))
        first = page.drawn('scope')
        wait_until(lambda: page.drawn('scope') != first)
        # The address holds the view: it chose the channels.
        assert page.data('scope')[0] == ['t', 'gear_ay', 'mesh_force']
        assert page.data('section')[0] == ['x', 'y']
        points = len(page.data('section'))
        wait_until(lambda: len(page.data('section')) > points)

        # 34 teeth at 157.08 rad/s mesh at 850 Hz; lines are 6.25 Hz apart.
        page.use('number-speed', '157.08')
        wait_until(lambda: abs(highest_line(page, 700, 1000) - 850.0) < 6.25)

        page.use('preset', 'quiet rig, cracked tooth')
        wait_until(lambda: 'gear, tooth 17: local fault' in page.text('diagnosis'), 150)
        assert 'gear tooth 17 severity 0.5' in page.text('diagnosis')
        keep_pictures(window)
        page.use('fault-kind', 'eccentricity')
        page.use('fault-wheel', 'pinion')
        page.use('fault-severity', '0.2')
        wait_until(lambda: 'eccentricity' in page.text('notices'))
        assert 'eccentricitypinion' in page.text('diagnosis').replace(' ', '')

        page.use('preset', 'chaos, no friction')
        wait_until(lambda: 'chaotic' in page.text('state'))
        page.use('preset', 'friction 0.05')
        wait_until(lambda: 'period-4' in page.text('state'))

        page.use('number-speed', '-1')
        wait_until(lambda: 'speed is -1' in page.text('alert'))
        errors = [entry for entry in window.get_log('browser') if entry['level'] == 'SEVERE']
        assert not errors
