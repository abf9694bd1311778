# SPDX-License-Identifier: MIT
"""The page of a fleet in Chromium against `grctl serve --broker`, a real broker and agents of
simulated robots. Prints TAP. usage and environment: as browser.py."""
import os
import pathlib
import re
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / 'support'))
os.environ.setdefault('LC_ALL', 'C.UTF-8')

from browser import (AXE, SIZES, is_drawn_before_its_scripts, main, note, nothing_serious, test,  # noqa: E402
                     tests, until)
from cockpit import Server as Serve  # noqa: E402
from fleet_view import Fleet, View, is_possible  # noqa: E402


tests.clear() # those of the cockpit


class Server:
    """What the tests of browser.py expect of one."""

    def __init__(self):
        self.fleet = Fleet().__enter__()
        self.start()

    def start(self):
        self.serve = Serve(broker=self.fleet.url).__enter__()
        self.process, self.port = self.serve.process, self.serve.port
        self.view = View(self.serve)
        self.link = f'http://127.0.0.1:{self.port}/#token={self.serve.token}'

    def close(self):
        self.serve.__exit__(None, None, None)
        self.fleet.__exit__(None, None, None)

    def settle(self):
        if self.view.state()['latch']:
            self.view.target('reset')
        self.view.wait('rest', lambda s: s['latch'] is None and not any(r['stopped'] for r in s['robots']))


READY = 'self.cockpit && cockpit.drawn > 0 && document.querySelectorAll(".robot").length === 4'


def open_page(browser, server, **options):
    page = browser.page(server.link, ready=False, **options)
    until(page, READY)
    return page


def shown(page):
    return page.evaluate("""[...document.querySelectorAll('#robots li')].filter((li) => !li.hidden)
        .map((li) => li.querySelector('b').textContent).sort()""")


@test
def the_fleet_is_drawn_before_its_scripts(browser, server):
    words = is_drawn_before_its_scripts(browser, server.link, ['fleet.css', 'style.css'], READY)
    for word in ('Fleet', 'connecting', 'Trouble only', 'Stops all robots'):
        assert word in words, f'{word} is not in {words}'


@test
def a_card_tells_how_a_robot_is(browser, server):
    server.view.wait_all()
    page = open_page(browser, server)
    text = page.locator('.robot', has=page.locator('b:text-is("a")')).inner_text()
    assert 'host-stage · GR001' in text and 'idle' in text and re.search(r'\d+ °C · \d\.\d V', text), text
    assert 'not connected' in page.locator('.robot.bad').inner_text()
    label = page.locator('.robot canvas').first.get_attribute('aria-label')
    assert re.search(r'joints, \w+ is the nearest to a limit: \d+°', label), label
    server.fleet.play()
    until(page, "document.querySelectorAll('.robot .is').length && [...document.querySelectorAll('.is')]"
                ".filter((e) => e.textContent.includes('playing')).length === 2")
    assert page.locator('.robot small:text-is("greet.pseq")').count() == 2
    page.click('#stop')
    server.fleet.running.pop('play').wait(30)


@test
def a_stop_of_all_is_told_robot_by_robot_and_released(browser, server):
    page = open_page(browser, server)
    server.fleet.play()
    until(page, "cockpit.state.robots.filter((r) => r.play === 'playing').length === 2", limit_ms=30000)
    page.locator('#text').focus()
    page.keyboard.press('Escape')
    until(page, "document.getElementById('stop-words').textContent === 'Stopped: 3 of 4 robots stand'")
    note(f"key to answer {page.evaluate('cockpit.stopper.took'):.0f} ms")
    assert 'host-lab/d use its switch' in page.locator('#stop-joints').inner_text()
    server.fleet.running.pop('play').wait(30)
    assert not any(r['moving'] for r in server.view.state()['robots'])
    page.click('#reset')
    until(page, "document.getElementById('stopped').hidden")
    server.view.wait('released', lambda s: not any(r['stopped'] for r in s['robots']))


@test
def robots_are_filtered_and_one_is_seen_in_full(browser, server):
    page = open_page(browser, server)
    page.fill('#text', 'so101')
    until(page, "[...document.querySelectorAll('#robots li')].filter((li) => !li.hidden).length === 1")
    assert shown(page) == ['c']
    page.fill('#text', '')
    page.select_option('#group', 'stage')
    until(page, "[...document.querySelectorAll('#robots li')].filter((li) => !li.hidden).length === 2")
    assert shown(page) == ['a', 'b']
    page.select_option('#group', '')
    page.check('#trouble')
    until(page, "[...document.querySelectorAll('#robots li')].filter((li) => !li.hidden).length === 1")
    assert shown(page) == ['d']
    page.fill('#text', 'nobody')
    until(page, "!document.getElementById('none').hidden")
    page.fill('#text', '')
    page.uncheck('#trouble')
    page.click('.robot:has(b:text-is("a"))')
    until(page, "document.getElementById('one-name').textContent === 'a · host-stage'")
    assert page.locator('#one-joints tbody tr').count() == 20
    assert page.locator('#one-cockpit').is_hidden()
    page.click('#close')
    until(page, "document.getElementById('one').hidden")
    assert page.evaluate("document.activeElement.querySelector('b').textContent") == 'a'


@test
def what_strangers_say_is_text_and_their_links_are_links(browser, server):
    page = open_page(browser, server)
    page.on('dialog', lambda d: browser.trouble.append('a dialog'))
    robots = [{'name': 'good', 'model': '<img src=x onerror=alert(1)>', 'cockpit': 'http://127.0.0.1:1/'},
              {'name': 'bad', 'model': 'x', 'cockpit': 'javascript:alert(1)'}]
    server.fleet.say('evil/connection', {'v': 1, 'state': 'ONLINE', 'epoch': 'e'}, '-r')
    server.fleet.say('evil/factsheet', {'v': 1, 'epoch': 'e', 'groups': ['all'], 'robots': robots}, '-r')
    try:
        until(page, 'document.querySelectorAll(".robot").length === 6')
        assert page.locator('#robots img').count() == 0
        for name, link in (('good', 'http://127.0.0.1:1/'), ('bad', None)):
            page.click(f'.robot:has(b:text-is("{name}"))')
            until(page, "name => document.getElementById('one-name').textContent.startsWith(name)", name)
            until(page, "hidden => document.getElementById('one-cockpit').hidden === hidden", link is None)
            if link:
                assert page.locator('#one-cockpit a').get_attribute('href') == link
                assert page.locator('#one-cockpit a').get_attribute('rel') == 'noopener noreferrer'
    finally:
        server.fleet.say('evil/factsheet', {'v': 1, 'epoch': 'e', 'groups': [], 'robots': []}, '-r')
        server.view.wait('gone', lambda s: len(s['robots']) == 4)


@test
def a_broker_that_is_away_is_seen_and_the_stop_goes_out_later(browser, server):
    browser.expects('503', 'unreachable')
    page = open_page(browser, server)
    server.fleet.end('broker', 9)
    until(page, "document.getElementById('link').textContent === 'broker lost'")
    page.click('#stop')
    until(page, "document.getElementById('stop-words').textContent.includes('use the switches')")
    server.fleet.begin_broker()
    until(page, "document.getElementById('stop-words').textContent === 'Stopped: 3 of 4 robots stand'",
          limit_ms=30000)


@test
def facts_that_do_not_come_are_asked_for_at_a_pace(browser, server):
    browser.expects('ERR_FAILED', 'Failed to fetch')
    page = open_page(browser, server)
    asked = []

    def refuse(route):
        asked.append(time.monotonic())
        route.abort()

    page.route('**/api/fleet', refuse)
    page.evaluate('cockpit.news = -1')
    until(page, 'old => cockpit.state.sequence > old + 20', page.evaluate('cockpit.state.sequence'))
    assert 1 <= len(asked) <= 2 + (time.monotonic() - asked[0]) / 1.5, asked
    page.unroute('**/api/fleet')
    until(page, 'cockpit.news === cockpit.state.news')


@test
def a_page_without_the_token_stops_and_releases_nothing(browser, server):
    page = browser.page(server.link.split('#')[0], ready=False)
    until(page, READY)
    page.click('#stop')
    until(page, 'cockpit.state.latch !== null')
    assert page.locator('#reset').is_disabled()


@test
def it_fits_three_sizes(browser, server):
    folder = os.environ.get('PICTURES')
    for size, (width, height) in SIZES.items():
        for scheme in ('light', 'dark'):
            page = open_page(browser, server, size=size, color_scheme=scheme)
            for chosen in (False, True):
                if chosen:
                    page.click('.robot:has(b:text-is("a"))')
                    until(page, "document.getElementById('one-name').textContent === 'a · host-stage'")
                wide = page.evaluate('document.documentElement.scrollWidth')
                assert wide <= width, f'{size}: {wide} pixels wide'
                box = page.locator('#stop').bounding_box()
                assert box['height'] >= 64 and box['y'] + box['height'] <= height, (size, box)
                if folder:
                    os.makedirs(folder, exist_ok=True)
                    page.screenshot(path=f'{folder}/fleet-{size}-{scheme}{"-one" if chosen else ""}.png')
            page.close()


@test
def axe_finds_nothing_serious(browser, server):
    if not os.path.exists(AXE):
        return 'axe-core is not installed'
    for size in ('desktop', 'phone'):
        for scheme in ('light', 'dark'):
            page = open_page(browser, server,
                             context=browser.context(size, color_scheme=scheme, bypass_csp=True))
            for chosen in (False, True):
                if chosen:
                    page.click('.robot:has(b:text-is("a"))')
                    until(page, "document.getElementById('one-name').textContent === 'a · host-stage'")
                nothing_serious(page, f'{size} {scheme}')
    return None


@test
def it_speaks_japanese(browser, server):
    page = open_page(browser, server, locale='ja-JP')
    assert page.locator('#stop').inner_text().startswith('すべて STOP')
    assert '未接続' in page.locator('.robot.bad').inner_text()


if __name__ == '__main__':
    why = is_possible()
    if why:
        print(f'ok {int(os.environ.get("FIRST", 0)) + 1} - the page of a fleet # SKIP {why}')
    else:
        main(Server)
