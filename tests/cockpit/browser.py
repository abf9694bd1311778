# SPDX-License-Identifier: MIT
"""The cockpit's page in Chromium against `grctl serve -d sim`. Prints TAP.

usage: browser.py [WORD...]: only the tests whose name has one of the words
environment: GRCTL, CHROMIUM; AXE: axe.min.js of axe-core; PICTURES: a folder for pictures of each
view; FIRST: tests before these. Asserted are order, counts and final states; times are reported.
"""
import contextlib
import http.server
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import traceback
import urllib.error
import urllib.request

from playwright.sync_api import sync_playwright

ARGUMENTS = """--no-sandbox --disable-quic --no-first-run --disable-background-networking
    --disable-component-update --disable-sync --use-angle=swiftshader
    --enable-unsafe-swiftshader""".split()
SIZES = {'desktop': (1366, 768), 'tablet': (820, 1180), 'phone': (390, 844)}
LIMIT_MS = 10000
TOKEN = '00112233445566778899aabbccddeeff'
MOTIONS = pathlib.Path('motions')

tests = []


def test(function):
    tests.append(function)
    return function


def note(text):
    print(f'# {text}', flush=True)


def free_ports():
    """A port whose next one is free too."""
    while True:
        with socket.socket() as one, socket.socket() as two:
            one.bind(('127.0.0.1', 0))
            port = one.getsockname()[1]
            with contextlib.suppress(OSError, OverflowError):
                two.bind(('127.0.0.1', port + 1))
                return port


class Server:
    """grctl serve with a simulator of its own and a copy of the motions."""

    def __init__(self, *options, port=None, folder=None, device='sim'):
        self.device = device
        self.own = folder is None
        self.folder = folder or tempfile.mkdtemp()
        if self.own:
            for file in MOTIONS.iterdir():
                if file.suffix in ('.pseq', '.m', '.yaml') and not file.name.startswith('so101'):
                    shutil.copy(file, self.folder)
        self.port = port or free_ports()
        self.options = options
        self.start()

    def start(self):
        environment = dict(os.environ, GRCTL_TOKEN=TOKEN)
        self.process = subprocess.Popen(
            [os.environ['GRCTL'], 'serve', '-d', self.device, '--json', '--port', str(self.port),
             *self.options, self.folder], stdout=subprocess.PIPE, stdin=subprocess.DEVNULL,
            env=environment, text=True)
        line = self.process.stdout.readline()
        told = json.loads(line)
        self.url, self.stop_url = told['url'].split('#')[0], told['stop_url']
        self.link = f'{self.url}#token={TOKEN}'
        self.wait(lambda s: s['link'] == 'up' and None not in s['angle_deg'])

    def call(self, method, path, body=None, **headers):
        if body is not None:
            body = json.dumps(body).encode()
            headers = {'X-Grobo-Token': TOKEN, 'Content-Type': 'application/json', **headers}
        request = urllib.request.Request(self.url.rstrip('/') + path, data=body, method=method,
                                         headers=headers)
        with urllib.request.urlopen(request, timeout=10) as answer:
            return json.load(answer)

    def state(self):
        return self.call('GET', '/api/state')

    def wait(self, true, what='the state'):
        end = time.monotonic() + LIMIT_MS / 1000
        while time.monotonic() < end:
            with contextlib.suppress(urllib.error.URLError, ConnectionError):
                state = self.state()
                if true(state):
                    return state
            time.sleep(0.02)
        raise AssertionError(f'{what} did not come: {json.dumps(self.state())}')

    def settle(self):
        """The next test finds a robot that stands, with nobody driving."""
        if self.state()['stop']['latched']:
            self.call('POST', '/api/reset', {})
        self.wait(lambda s: s['lease']['holder'] is None and not s['stop']['latched'] and
                  s['play']['state'] not in ('playing', 'approaching', 'paused', 'stopping'), 'rest')

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def close(self):
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.kill()
        if self.own:
            shutil.rmtree(self.folder)


class Browser:
    def __init__(self, play):
        self.browser = play.chromium.launch(executable_path=os.environ['CHROMIUM'], args=ARGUMENTS)
        self.contexts = []
        self.trouble = []

    def context(self, size='desktop', **options):
        width, height = SIZES[size]
        options.setdefault('color_scheme', 'light')
        made = self.browser.new_context(viewport={'width': width, 'height': height},
                                        has_touch=size == 'phone', **options)
        made.set_default_timeout(LIMIT_MS)
        self.contexts.append(made)
        return made

    def page(self, link, context=None, ready=True, **options):
        page = (context or self.context(**options)).new_page()
        page.on('console', lambda m: m.type == 'error' and
                '409 (Conflict)' not in m.text and self.trouble.append(m.text))
        page.on('pageerror', lambda e: self.trouble.append(e.stack or str(e)))
        page.goto(link)
        if ready:
            until(page, 'self.cockpit && cockpit.figure.frames > 0 && cockpit.drawn > 0')
        return page

    def tidy(self):
        for context in self.contexts:
            context.close()
        self.contexts = []


def until(page, script, argument=None, limit_ms=LIMIT_MS):
    """Waits until an expression is true. Playwright's own wait evaluates text, which the page's
    content security policy forbids."""
    end = time.monotonic() + limit_ms / 1000
    while not page.evaluate(script, argument):
        assert time.monotonic() < end, f'{script} did not come true'
        page.wait_for_timeout(15)


def drive(page):
    page.click('#lease')
    until(page, "cockpit.lease.status() === 'mine' && cockpit.mayMove()")


def torque_on(page, server):
    page.click('#tab-joints')
    page.click('#torque-on')
    server.wait(lambda s: all(t == 'on' for t in s['torque']) and s['job'] is None, 'torque')


def choose(page, name):
    page.click('#tab-play')
    page.click(f'.file:has(b:text-is("{name}"))')
    until(page, 'name => cockpit.play.look && cockpit.play.look.name === name', name)


def stopped(page):
    until(page, 'cockpit.state.stop.latched && cockpit.state.stop.confirmed')
    until(page, "document.getElementById('stop-words').textContent.includes('read back')")


def still(server, seconds=0.7):
    """Nothing moves for a while."""
    first = server.state()
    time.sleep(seconds)
    last = server.state()
    worst = max(abs(a - b) for a, b in zip(first['angle_deg'], last['angle_deg']))
    assert worst < 1.0, f'a joint moved {worst} degrees'
    assert last['play']['state'] not in ('playing', 'approaching'), last['play']


def comes_to_rest(server):
    """What was stopped softly stands, and what is told of it was read after that."""
    server.wait(lambda s: not s['moving'] and s['job'] is None, 'a robot that stands')
    time.sleep(0.5) # each joint is read 5 times a second
    still(server)


def pixels(page, part):
    """How many pixels of a part of the figure (x, y, w, h of 0..1) are not the background: the picture
    of the page is compared with that of the page without its figure."""
    box = page.locator('#view').bounding_box()
    clip = {'x': box['x'] + box['width'] * part[0], 'y': box['y'] + box['height'] * part[1],
            'width': box['width'] * part[2], 'height': box['height'] * part[3]}
    seen = page.screenshot(clip=clip)
    page.evaluate("document.querySelector('#view canvas').style.visibility = 'hidden'")
    empty = page.screenshot(clip=clip)
    page.evaluate("document.querySelector('#view canvas').style.visibility = ''")
    return page.evaluate("""async ([a, b]) => {
        const data = async (text) => {
            const image = new Image();
            image.src = `data:image/png;base64,${text}`;
            await image.decode();
            const canvas = new OffscreenCanvas(image.width, image.height);
            const pen = canvas.getContext('2d');
            pen.drawImage(image, 0, 0);
            return pen.getImageData(0, 0, image.width, image.height).data;
        };
        const [x, y] = [await data(a), await data(b)];
        let differ = 0;
        for (let n = 0; n < x.length; n += 4) {
            const far = Math.max(...[0, 1, 2].map((i) => Math.abs(x[n + i] - y[n + i])));
            differ += far > 24 ? 1 : 0;
        }
        return differ / (x.length / 4);
    }""", [__import__('base64').b64encode(p).decode() for p in (seen, empty)])


# ---- see ----------------------------------------------------------------------------------------


@test
def the_figure_stands_in_the_middle(browser, server):
    for query, renderer in (('', 'webgl'), ('?flat', '2d')):
        page = browser.page(server.url + query + f'#token={TOKEN}')
        assert page.evaluate("document.querySelector('#view canvas').dataset.renderer") == renderer
        parts = {'head and chest': (0.40, 0.18, 0.2, 0.2), 'legs': (0.42, 0.5, 0.16, 0.25),
                 'left corner': (0.02, 0.3, 0.15, 0.2), 'right corner': (0.83, 0.3, 0.15, 0.2)}
        found = {name: pixels(page, part) for name, part in parts.items()}
        note(f'{renderer}: ' + ', '.join(f'{k} {v:.0%}' for k, v in found.items()))
        assert found['head and chest'] > 0.35 and found['legs'] > 0.35, found
        assert found['left corner'] < 0.1 and found['right corner'] < 0.1, found


@test
def the_figure_turns_zooms_and_picks(browser, server):
    page = browser.page(server.link)
    box = page.locator('#view canvas').bounding_box()
    x, y = box['x'] + box['width'] / 2, box['y'] + box['height'] / 2
    before = page.evaluate('cockpit.figure.camera.yaw')
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 120, y + 10, steps=5)
    page.mouse.up()
    until(page, 'yaw => Math.abs(cockpit.figure.camera.yaw - yaw) > 0.5', before)
    assert page.evaluate('cockpit.selected') == -1, 'a drag chose a joint'
    page.keyboard.press('0')
    page.locator('#view canvas').focus()
    page.keyboard.press('ArrowLeft')
    page.keyboard.press('+')
    until(page, 'cockpit.figure.camera.zoom > 1')
    page.keyboard.press('0')
    until(page, 'cockpit.figure.camera.zoom === 1')
    until(page, '!cockpit.figure.dirty')
    joint = page.evaluate("cockpit.robot.joints.find((j) => j.name === 'L_ELBOW_P').joint")
    at = page.evaluate("""joint => {
        const f = cockpit.figure, n = f.body.linkOf[joint], p = f.at[n], c = f.body.links[n].com;
        const w = [0, 1, 2].map((i) => p[i] * c[0] + p[4 + i] * c[1] + p[8 + i] * c[2] + p[12 + i]);
        const m = f.camera.matrix, q = [0, 1, 2, 3].map(
            (i) => m[i] * w[0] + m[4 + i] * w[1] + m[8 + i] * w[2] + m[12 + i]);
        return [(q[0] / q[3] + 1) / 2 * f.host.clientWidth, (1 - q[1] / q[3]) / 2 * f.host.clientHeight];
    }""", joint)
    page.mouse.click(box['x'] + at[0], box['y'] + at[1])
    assert page.evaluate('cockpit.selected') == joint
    until(page, "document.querySelector('.labels .chosen')?.textContent.startsWith('L_ELBOW_P')")
    assert page.locator('#chosen').inner_text().startswith('L_ELBOW_P')


@test
def it_draws_only_what_is_new(browser, server):
    page = browser.page(server.link)
    page.click('#tab-more')
    page.wait_for_timeout(500)
    before = page.evaluate('[cockpit.figure.frames, cockpit.drawn]')
    page.wait_for_timeout(1000)
    after = page.evaluate('[cockpit.figure.frames, cockpit.drawn]')
    note(f'in 1 s: {after[1] - before[1]} states, {after[0] - before[0]} drawn')
    assert after[1] - before[1] >= 15, 'states are not drawn at the rate they come'
    assert after[0] - before[0] <= 3, 'a robot that stands still is drawn again and again'


@test
def the_table_and_the_plots_tell_what_the_state_says(browser, server):
    page = browser.page(server.link)
    page.click('#tab-joints')
    page.click('.joint:text-is("R_KNEE_P")')
    angle = server.state()['angle_deg'][3]
    until(page, """angle => Math.abs(document.querySelector('tr.chosen td').textContent - angle) < 0.3
        """, angle)
    page.click('#tab-see')
    until(page, "document.querySelector('#plots canvas').getAttribute('aria-label')?.includes('R_KNEE_P')")
    label = page.locator('#plots canvas').first.get_attribute('aria-label')
    assert f'{angle:.1f} °' in label, label
    assert page.locator('#line dt').count() >= 8


# ---- control --------------------------------------------------------------------------------------


@test
def stop_by_pointer_is_confirmed_joint_by_joint(browser, server):
    page = browser.page(server.link)
    drive(page)
    torque_on(page, server)
    at = time.monotonic()
    page.click('#stop')
    state = server.wait(lambda s: s['stop']['latched'] and s['stop']['confirmed'], 'a confirmed stop')
    note(f'pointer to answer {page.evaluate("cockpit.stopper.took"):.0f} ms; to the confirmation, with '
         f'the test that clicks, {(time.monotonic() - at) * 1000:.0f} ms')
    assert state['stop']['kind'] == 'stop'
    assert len(state['stop']['joints']) == 20
    stopped(page)
    assert page.evaluate("cockpit.lease.status()") == 'free', 'a stop takes the lease away'
    assert page.locator('#play').is_disabled()
    page.click('#reset')
    until(page, '!cockpit.state.stop.latched')
    until(page, "document.getElementById('stopped').hidden")
    still(server)


@test
def escape_stops_in_any_focus_and_without_control(browser, server):
    page = browser.page(server.link)
    keys = ('Escape', 'Control+Shift+Escape', 'Alt+Escape')
    focuses = ('#name', '#lang', '#tab-more')
    for key, focus in zip(keys, focuses):
        page.click('#tab-more')
        page.locator(focus).focus()
        page.keyboard.press(key)
        stopped(page)
        server.call('POST', '/api/reset', {})
        until(page, '!cockpit.state.stop.latched')


@test
def a_page_without_the_token_watches_and_stops(browser, server):
    page = browser.page(server.url)
    assert page.locator('#lease').is_disabled()
    page.click('#stop')
    server.wait(lambda s: s['stop']['latched'], 'a stop')
    stopped(page)
    server.call('POST', '/api/reset', {})


@test
def the_token_leaves_the_address_bar(browser, server):
    page = browser.page(server.link)
    assert 'token' not in page.evaluate('location.href')
    page.reload()
    until(page, 'self.cockpit && cockpit.drawn > 0')
    drive(page)


@test
def a_slider_moves_its_joint_and_ends_at_the_limit(browser, server):
    page = browser.page(server.link)
    drive(page)
    torque_on(page, server)
    page.click('.joint:text-is("R_ELBOW_P")')
    joint = page.evaluate('cockpit.selected')
    limits = page.evaluate('cockpit.robot.joints[cockpit.selected].limits_deg')
    begin = server.state()['angle_deg'][joint]
    page.locator('.jog input[type=range]').focus()
    page.keyboard.press('PageDown')
    server.wait(lambda s: abs(s['angle_deg'][joint] - (begin - 10)) < 1.5, 'ten degrees less')
    page.keyboard.press('ArrowRight')
    server.wait(lambda s: abs(s['angle_deg'][joint] - (begin - 9)) < 1.5, 'one degree more')
    page.keyboard.press('Home')
    until(page, "document.querySelector('.jog output').textContent.includes('at its limit')")
    state = server.wait(lambda s: abs(s['angle_deg'][joint] - limits[0]) < 2, 'the limit')
    assert state['target_deg'][joint] >= limits[0] - 0.11, state['target_deg']


@test
def a_frozen_page_loses_control_and_the_robot_stands(browser, server):
    page = browser.page(server.link)
    drive(page)
    torque_on(page, server)
    page.evaluate("""setTimeout(() => {
        const end = performance.now() + 6000;
        while (performance.now() < end) { }
    }, 50)""")
    begin = time.monotonic()
    server.wait(lambda s: s['lease']['holder'] is None, 'a free lease')
    note(f'control was lost {time.monotonic() - begin:.1f} s after the page froze')
    still(server)
    until(page, "cockpit.lease.status() === 'free' && document.getElementById('driver')"
                ".textContent === 'Nobody drives'")
    assert page.evaluate('cockpit.api.lease') is None


def events(server, words):
    """Those that were told with these words."""
    request = urllib.request.Request(server.url + 'api/events', headers={'Last-Event-ID': '0'})
    with urllib.request.urlopen(request, timeout=10) as stream:
        found = []
        for line in stream:
            if line.startswith(b'event: state'):
                return [e for e in found if words in e['message']]
            if line.startswith(b'data: '):
                found.append(json.loads(line[6:]))
    return []


FREEZE = """ms => setTimeout(() => {
    const end = performance.now() + ms;
    while (performance.now() < end) { }
}, 0)"""
HIDE = """hidden => {
    Object.defineProperty(document, 'hidden', { configurable: true, get: () => hidden });
    Object.defineProperty(document, 'visibilityState',
                          { configurable: true, get: () => hidden ? 'hidden' : 'visible' });
    document.dispatchEvent(new Event('visibilitychange'));
}"""


@test
def a_page_that_freezes_while_jogging_stops_softly(browser, server):
    page = browser.page(server.link)
    drive(page)
    torque_on(page, server)
    joint = page.evaluate("cockpit.robot.joints.find((j) => j.name === 'R_SHOULDER_P').joint")
    begin = server.state()['angle_deg'][joint]
    end = page.evaluate('joint => cockpit.robot.joints[joint].limits_deg[0]', joint)
    before = events(server, '')[-1]['id']
    page.evaluate("""target => cockpit.command('/api/jog',
        { angle_deg: { R_SHOULDER_P: target }, time_ms: 8000 }, true)""", end)
    server.wait(lambda s: s['angle_deg'][joint] < begin - 1, 'a jog')
    at = server.state()['time_ms']
    page.evaluate(FREEZE, 5000)
    server.wait(lambda s: s['lease']['holder'] is None, 'a free lease')
    stops = [e for e in events(server, 'jogging stops') if e['id'] > before]
    assert len(stops) == 1, stops
    note(f"jogging stopped {stops[0]['time_ms'] - at} ms after the page froze")
    state = server.state()
    assert end + 20 < state['angle_deg'][joint] < begin, state['angle_deg'][joint]
    assert set(state['torque']) == {'on'}, 'it holds'
    comes_to_rest(server)
    until(page, "cockpit.lease.status() === 'free'")


@test
def a_page_that_freezes_while_playing_does_what_was_declared(browser, server):
    for declared, words, end in (('stop', 'the motion stops', 'idle'),
                                 ('finish', 'the motion goes on', 'finished'),
                                 ('exit', 'the exit policy is carried out', 'idle')):
        page = browser.page(server.link)
        page.click('#tab-more')
        page.select_option('#on-lost', declared)
        drive(page)
        torque_on(page, server)
        choose(page, 'greet.pseq')
        before = events(server, '')[-1]['id']
        page.click('#play')
        server.wait(lambda s: s['play']['state'] == 'playing', 'playing')
        at = server.state()['time_ms']
        page.evaluate(FREEZE, 4500)
        server.wait(lambda s: s['lease']['holder'] is None, 'a free lease')
        found = [e for e in events(server, words) if e['id'] > before]
        assert len(found) == 1, (declared, found)
        note(f"{declared}: {found[0]['time_ms'] - at} ms after the page froze")
        server.wait(lambda s: s['play']['state'] == end and s['job'] is None, end)
        assert set(server.state()['torque']) == {'on'}, declared
        comes_to_rest(server)
        page.close()


@test
def a_hidden_page_gives_control_back_and_its_motion_ends_as_declared(browser, server):
    page = browser.page(server.link)
    drive(page)
    torque_on(page, server)
    choose(page, 'greet.pseq')
    page.check('#loop')
    page.click('#play')
    server.wait(lambda s: s['play']['state'] == 'playing', 'playing')
    page.evaluate(HIDE, True)
    server.wait(lambda s: s['lease']['holder'] is None, 'a free lease')
    at = server.state()['time_ms']
    server.wait(lambda s: s['clients'] == 0, 'a hidden page has no stream')
    assert server.state()['play']['state'] == 'playing', 'the motion has 3 s'
    server.wait(lambda s: s['play']['state'] == 'idle', 'its end')
    note(f"the motion ended {server.state()['time_ms'] - at} ms after the page was hidden")
    comes_to_rest(server)
    page.evaluate(HIDE, False)
    until(page, "cockpit.lease.status() === 'free' && cockpit.age() === 0")
    drive(page)
    page.click('#tab-play')
    page.click('#play')
    server.wait(lambda s: s['play']['state'] == 'playing', 'playing')
    page.evaluate(HIDE, True)
    server.wait(lambda s: s['lease']['holder'] is None, 'a free lease')
    page.evaluate(HIDE, False)
    until(page, "cockpit.lease.status() === 'free' && cockpit.age() === 0")
    drive(page) # in time
    page.wait_for_timeout(3500)
    assert server.state()['play']['state'] == 'playing', 'who comes back in time drives on'


@test
def another_page_asks_and_gets_control(browser, server):
    one = browser.page(server.link)
    two = browser.page(server.link)
    one.evaluate("localStorage.setItem('name', 'Anna')")
    two.evaluate("localStorage.setItem('name', 'Ben')")
    drive(one)
    until(two, "document.getElementById('driver').textContent === 'Anna drives'")
    assert two.locator('#play').is_disabled()
    two.click('#lease')
    until(one, "document.getElementById('driver').textContent === 'Ben asks to drive'")
    one.click('#lease')
    server.wait(lambda s: s['lease']['holder'] and s['lease']['holder']['name'] == 'Ben',
                'the lease given')
    until(two, "cockpit.lease.status() === 'mine' && cockpit.mayMove()") # with no other click
    until(one, "document.getElementById('driver').textContent === 'Ben drives'")
    assert one.evaluate('cockpit.lease.status()') == 'other'


@test
def two_clicks_take_control_once(browser, server):
    page = browser.page(server.link)
    page.dblclick('#lease')
    until(page, "cockpit.lease.status() === 'mine' && cockpit.mayMove()")
    page.wait_for_timeout(600)
    assert server.state()['lease']['holder'], 'the second click gave it back'
    page.click('#lease')
    server.wait(lambda s: s['lease']['holder'] is None, 'a free lease')
    until(page, "document.getElementById('lease').textContent === 'Take control'"
                " && document.getElementById('lease').ariaDisabled === 'false'")
    page.evaluate("""() => { const button = document.getElementById('lease'), app = cockpit;
        app.lease.see({ holder: { id: 'x', name: 'Ben' }, asked: null }, performance.now());
        button.click(); }""") # it still says "Take control", and does that
    until(page, "cockpit.lease.status() === 'mine' && cockpit.mayMove()")


@test
def a_page_that_does_not_answer_is_taken_over(browser, server):
    one = browser.page(server.link)
    two = browser.page(server.link)
    drive(one)
    until(two, "cockpit.lease.status() === 'other'")
    two.click('#lease')
    until(two, "document.getElementById('lease').ariaDisabled === 'true'")
    begin = time.monotonic()
    until(two, "document.getElementById('lease').textContent === 'Take over'"
               " && document.getElementById('lease').ariaDisabled === 'false'", limit_ms=20000)
    note(f'taking over was possible after {time.monotonic() - begin:.1f} s')
    drive(two)
    until(one, "cockpit.lease.status() === 'other'")


@test
def a_page_that_is_closed_gives_control_back(browser, server):
    page = browser.page(server.link)
    drive(page)
    begin = time.monotonic()
    page.close(run_before_unload=True)
    server.wait(lambda s: s['lease']['holder'] is None, 'a free lease')
    took = time.monotonic() - begin
    note(f'given back after {took * 1000:.0f} ms')
    assert took < 2.5, 'only the heartbeat noticed'


@test
def twenty_pages_have_one_stream_and_one_stop(browser, server):
    context = browser.context()
    pages = [browser.page(server.link, context) for _ in range(20)]
    server.wait(lambda s: s['clients'] == 1, 'one stream')
    drive(pages[0])
    begin = time.monotonic()
    pages[19].click('#stop')
    server.wait(lambda s: s['stop']['latched'], 'a stop')
    until(pages[19], 'cockpit.stopper.answered')
    note(f'page 20: pointer to answer {pages[19].evaluate("cockpit.stopper.took"):.0f} ms, with the '
         f'test that clicks {(time.monotonic() - begin) * 1000:.0f} ms')
    for page in (pages[0], pages[7], pages[19]):
        stopped(page)
    for page in pages:
        page.close()
    server.wait(lambda s: s['clients'] == 0, 'no stream')


@test
def twenty_browsers_have_a_stream_each(browser, server):
    def used():
        with open(f'/proc/{server.process.pid}/stat', encoding='ascii') as f:
            fields = f.read().rsplit(')', 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')

    def share(seconds=4):
        before, at = used(), time.monotonic()
        time.sleep(seconds)
        return 100 * (used() - before) / (time.monotonic() - at)

    alone = share()
    pages = [browser.context('phone').new_page() for _ in range(20)]
    for page in pages: # 20 figures in software are a load for a graphics card
        page.goto(f'{server.url}?flat#token={TOKEN}', wait_until='commit', timeout=60000)
        until(page, 'self.cockpit && cockpit.drawn > 0', limit_ms=60000)
    server.wait(lambda s: s['clients'] == 20, 'twenty streams')
    note(f'the server takes {alone:.1f} % of a core alone, {share():.1f} % with 20 browsers')
    pages[3].locator('#stop').dispatch_event('pointerdown')
    server.wait(lambda s: s['stop']['latched'], 'a stop')
    for page in (pages[3], pages[11]):
        until(page, 'cockpit.state.stop.latched && cockpit.state.stop.confirmed', limit_ms=60000)
    note(f"in the crowd: pointer to answer {pages[3].evaluate('cockpit.stopper.took'):.0f} ms")


@test
def a_server_that_is_killed_in_a_motion_leaves_a_robot_that_stands(browser, server):
    """The robot is behind a pty: what stops it is the guard."""
    place = pathlib.Path(tempfile.mkdtemp()) / 'robot'
    sim = subprocess.Popen([os.environ['GRCTL'], 'sim', '--link', str(place)], stdin=subprocess.DEVNULL,
                           stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    sim.stdout.readline()
    own = Server(device=str(place))
    try:
        page = browser.page(own.link)
        drive(page)
        torque_on(page, own)
        choose(page, 'greet.pseq')
        page.check('#loop')
        page.click('#play')
        own.wait(lambda s: s['play']['state'] == 'playing' and s['play']['t_ms'] > 300, 'playing')
        own.kill()
        until(page, "document.body.classList.contains('stale')")
        assert not page.evaluate('cockpit.mayMove()')
        own.start()
        until(page, "!document.body.classList.contains('stale')")
        comes_to_rest(own)
        state = own.state()
        assert state['play']['state'] == 'idle' and state['lease']['holder'] is None, state['play']
        assert set(state['torque']) == {'on'}, 'the guard lets it hold'
        until(page, "cockpit.lease.status() === 'free'")
    finally:
        own.close()
        sim.terminate()
        sim.wait(10)
    browser.trouble[:] = [t for t in browser.trouble if 'ERR_' not in t]


@test
def a_server_that_died_comes_back_and_nothing_moves(browser, server):
    page = browser.page(server.link)
    drive(page)
    torque_on(page, server)
    server.kill()
    until(page, "document.body.classList.contains('stale')")
    until(page, "/^no news for \\d/.test(document.getElementById('stale').textContent)")
    assert not page.evaluate('cockpit.mayMove()')
    assert page.locator('#stop').is_enabled()
    page.click('#stop')
    until(page, "document.getElementById('stop-words').textContent.includes('use the switch')")
    page.wait_for_timeout(600)
    server.start()
    until(page, "!document.body.classList.contains('stale')")
    until(page, 'cockpit.state.stop.latched') # repeated until it was acknowledged
    stopped(page)
    still(server)
    assert page.evaluate("cockpit.lease.status()") == 'free'
    browser.trouble[:] = [t for t in browser.trouble if 'ERR_' not in t]


@test
def a_foreign_page_moves_and_stops_nothing(browser, server):
    attack = f"""<!doctype html><script>
        const all = [];
        for (const path of ['/api/stop', '/api/estop', '/api/reset', '/api/lease', '/api/play']) {{
            for (const type of ['text/plain', 'application/json']) {{
                for (const mode of ['no-cors', 'cors']) {{
                    all.push(fetch('{server.url}'.replace(/\\/$/, '') + path, {{ method: 'POST', mode,
                        headers: {{ 'Content-Type': type }},
                        body: '{{"action": "take", "name": "evil"}}' }}).catch(() => 0));
                }}
            }}
        }}
        all.push(fetch('{server.stop_url}'.replace(/\\/$/, '') + '/stop', {{ method: 'POST',
            mode: 'no-cors', body: '{{}}' }}).catch(() => 0));
        all.push(fetch('{server.url}api/state').then((r) => r.text()).then((t) => {{
            document.title = 'read ' + t.length; }}, () => 0));
        Promise.all(all).then(() => {{ document.body.dataset.done = 1; }});
        </script><body><iframe src="{server.url}"></iframe>
        <form method=post enctype=text/plain action="{server.url}api/stop"
        target=_blank><input name='{{"name":"' value='evil"}}'></form>"""

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header('Content-Type', 'text/html')
            self.end_headers()
            self.wfile.write(attack.encode())

        def log_message(self, *_):
            pass

    with http.server.ThreadingHTTPServer(('127.0.0.1', 0), Handler) as foreign:
        threading.Thread(target=foreign.serve_forever, daemon=True).start()
        page = browser.page(f'http://localhost:{foreign.server_port}/', ready=False)
        page.wait_for_selector('body[data-done]')
        with page.context.expect_page():
            page.evaluate('document.forms[0].submit()')
        page.wait_for_timeout(300)
        assert not page.title().startswith('read'), page.title()
        inner = page.frames[1]
        assert inner.url.startswith('chrome-error:') or not inner.evaluate('self.cockpit ? 1 : 0')
        foreign.shutdown()
    state = server.state()
    assert not state['stop']['latched'] and state['lease']['holder'] is None, state
    browser.trouble.clear()


# ---- play ---------------------------------------------------------------------------------------


@test
def a_page_keeps_control_while_it_paints_the_list(browser, server):
    page = browser.page(server.link)
    drive(page)
    page.evaluate("""self.worst = 0; self.last = performance.now(); setInterval(() => {
        const now = performance.now(); worst = Math.max(worst, now - last); last = now; }, 10)""")
    page.click('#tab-play')
    until(page, "document.querySelectorAll('.file canvas[data-painted]').length >= 7",
          limit_ms=30000)
    note(f'the page was busy for {page.evaluate("worst"):.0f} ms at most')
    assert page.evaluate('cockpit.lease.status()') == 'mine'


@test
def a_motion_is_chosen_previewed_played_and_ended(browser, server):
    page = browser.page(server.link)
    page.click('#tab-play')
    until(page, "document.querySelectorAll('.file').length > 3")
    until(page, "[...document.querySelectorAll('.badge')].every((b) => !b.textContent.includes('…'))")
    choose(page, 'greet.pseq')
    page.click('#preview')
    until(page, 'cockpit.play.at > 300')
    still(server, 0.3)
    until(page, '!cockpit.play.previewing')
    drive(page)
    torque_on(page, server)
    page.click('#tab-play')
    page.evaluate("""self.seen = []; setInterval(() => {
        const s = cockpit.state.play.state;
        if (seen[seen.length - 1] !== s) { seen.push(s); } }, 10)""")
    page.click('#play')
    server.wait(lambda s: s['play']['state'] == 'playing', 'playing')
    server.wait(lambda s: s['play']['state'] not in ('approaching', 'playing', 'stopping'), 'the end')
    until(page, "document.getElementById('play').textContent.includes('Play')")
    seen = page.evaluate('seen')
    note(f'states: {seen}')
    assert seen.index('playing') < len(seen) - 1
    assert 'failed' not in seen and 'paused' not in seen


@test
def space_pauses_a_slider_seeks_and_the_rest_is_played(browser, server):
    page = browser.page(server.link)
    drive(page)
    torque_on(page, server)
    choose(page, 'greet.pseq')
    page.evaluate('document.activeElement.blur()')
    page.keyboard.press(' ')
    page.wait_for_timeout(200)
    assert server.state()['play']['state'] not in ('playing', 'approaching'), 'a key began a motion'
    page.click('#play')
    server.wait(lambda s: s['play']['state'] == 'playing' and s['play']['t_ms'] > 100, 'playing')
    page.evaluate('document.activeElement.blur()')
    page.keyboard.press(' ')
    server.wait(lambda s: s['play']['state'] == 'paused', 'a pause')
    total = server.state()['play']['total_ms']
    page.locator('#seek').focus()
    page.locator('#seek').fill(str(round(total * 0.7 / 10) * 10))
    state = server.wait(lambda s: abs(s['play']['t_ms'] - total * 0.7) < total * 0.15, 'the place')
    until(page, "document.getElementById('seek').getAttribute('aria-valuetext').includes('seconds')")
    if state['play']['state'] == 'paused':
        page.click('#play')
    server.wait(lambda s: s['play']['state'] in ('idle', 'finished'), 'the end')


@test
def escape_stops_a_motion_and_no_motion_follows(browser, server):
    page = browser.page(server.link)
    drive(page)
    torque_on(page, server)
    choose(page, 'greet.pseq')
    page.check('#loop')
    page.click('#play')
    server.wait(lambda s: s['play']['state'] == 'playing' and s['play']['t_ms'] > 200, 'playing')
    page.keyboard.press('Escape')
    stopped(page)
    still(server)
    page.click('#reset')
    until(page, '!cockpit.state.stop.latched')
    still(server)


@test
def a_name_of_a_file_is_text(browser, server):
    name = '<img src=x onerror=alert(1)>.pseq'
    shutil.copy(MOTIONS / 'bow.pseq', pathlib.Path(server.folder) / name)
    try:
        page = browser.page(server.link)
        page.on('dialog', lambda d: browser.trouble.append('a dialog'))
        page.click('#tab-play')
        until(page, "document.querySelectorAll('.file').length > 3")
        page.wait_for_timeout(300)
        assert page.locator('#files img').count() == 0
    finally:
        os.unlink(pathlib.Path(server.folder) / name)


# ---- craft ----------------------------------------------------------------------------------------


@test
def it_weighs_less_than_150_kb_and_holds_nothing_inline(browser, server):
    page = browser.page(server.link)
    names = ['/', *{e for e in page.evaluate(
        "performance.getEntriesByType('resource').map((r) => new URL(r.name).pathname)")
        if not e.startswith('/api') and e not in ('/', '/heartbeat')}, '/worker.js', '/feed.js']
    total = 0
    for name in sorted(set(names)):
        request = urllib.request.Request(server.url.rstrip('/') + name,
                                         headers={'Accept-Encoding': 'gzip'})
        with urllib.request.urlopen(request) as answer:
            assert answer.headers['Content-Encoding'] == 'gzip', name
            total += len(answer.read())
            policy = answer.headers['Content-Security-Policy']
            assert "default-src 'none'" in policy and 'unsafe' not in policy, policy
    note(f'{len(set(names))} files, {total} bytes compressed')
    assert total < 150 * 1024
    text = page.content()
    assert ' style=' not in text.split('</head>')[1].split('<main>')[0]
    paint = page.evaluate("performance.getEntriesByName('first-contentful-paint')[0].startTime")
    floor = browser.page('data:text/html,<p>floor', ready=False).evaluate(
        "new Promise((done) => setTimeout(() => done(performance.getEntriesByName("
        "'first-contentful-paint')[0]?.startTime ?? 0), 500))")
    note(f'first paint {paint:.0f} ms; floor of an empty page {floor:.0f} ms')


@test
def it_fits_three_sizes(browser, server):
    for size, (width, height) in SIZES.items():
        page = browser.page(server.link, size=size)
        for tab in ('see', 'play', 'joints', 'more'):
            page.click(f'#tab-{tab}')
            wide = page.evaluate('document.documentElement.scrollWidth')
            assert wide <= width, f'{size} {tab}: {wide} pixels wide'
            box = page.locator('#stop').bounding_box()
            assert box['height'] >= 64 and box['y'] + box['height'] <= height, (size, tab, box)
            over = page.evaluate("""() => { const b = document.getElementById('stop')
                .getBoundingClientRect(); return document.elementFromPoint(b.x + b.width / 2,
                b.y + b.height / 2).id; }""")
            assert over == 'stop', f'{size} {tab}: {over} covers STOP'
        figure = page.locator('#view').bounding_box()
        note(f'{size}: figure {figure["height"] / height:.0%} of the height')
        if size == 'phone':
            assert 0.42 <= figure['height'] / height <= 0.48
            assert box['width'] >= width - 32
            small = page.evaluate("""() => [...document.querySelectorAll('button, select')].filter((b) =>
                b.offsetParent && b.getBoundingClientRect().height < 39.5 && !b.matches('.chip'))
                .map((b) => b.textContent)""")
            assert small == [], f'too small for a finger: {small}'


@test
def it_speaks_japanese(browser, server):
    page = browser.page(server.link, locale='ja-JP')
    assert page.evaluate('document.documentElement.lang') == 'ja'
    assert page.locator('#lease').inner_text() == '操作権を取る'
    page.click('#tab-more')
    with page.expect_navigation():
        page.select_option('#lang', 'en')
    until(page, "self.cockpit && document.documentElement.lang === 'en'")
    assert page.locator('#tab-see').inner_text() == 'See'


@test
def axe_finds_nothing_serious(browser, server):
    axe = os.environ.get('AXE', '')
    if not os.path.exists(axe):
        return 'axe-core is not installed'
    for size in ('desktop', 'phone'):
        for scheme in ('light', 'dark'):
            page = browser.page(server.link, context=browser.context(
                size, color_scheme=scheme, bypass_csp=True))
            for tab in ('see', 'play', 'joints', 'more'):
                page.click(f'#tab-{tab}')
                if tab == 'joints':
                    page.click('.joint:text-is("R_KNEE_P")')
                page.wait_for_timeout(400)
                page.evaluate(pathlib.Path(axe).read_text())
                found = page.evaluate("""axe.run({ resultTypes: ['violations'] }).then((r) =>
                    r.violations.map((v) => [v.impact, v.id, v.nodes.map((n) => n.target.join(' ') +
                    ': ' + (n.any[0] || n.all[0] || n.none[0] || {}).message)]))""")
                bad = [v for v in found if v[0] in ('serious', 'critical')]
                assert not bad, f'{size} {scheme} {tab}: {json.dumps(bad, indent=1)}'
    return None


@test
def pictures_of_each_view(browser, server):
    folder = os.environ.get('PICTURES')
    if not folder:
        return 'PICTURES names no folder'
    os.makedirs(folder, exist_ok=True)
    for size in SIZES:
        for scheme in ('light', 'dark'):
            page = browser.page(server.link, size=size, color_scheme=scheme)
            drive(page)
            torque_on(page, server)
            for tab in ('see', 'play', 'joints', 'more'):
                if tab == 'play':
                    choose(page, 'greet.pseq')
                    page.click('#play')
                    server.wait(lambda s: s['play']['state'] == 'playing' and s['play']['t_ms'] > 900)
                page.click(f'#tab-{tab}')
                page.wait_for_timeout(500)
                page.screenshot(path=f'{folder}/{size}-{tab}-{scheme}.png')
            page.click('#stop')
            stopped(page)
            page.screenshot(path=f'{folder}/{size}-stopped-{scheme}.png')
            page.close()
            server.call('POST', '/api/reset', {})
    return None


def main(of=Server):
    words = sys.argv[1:]
    chosen = [t for t in tests if not words or any(w in t.__name__ for w in words)]
    count = int(os.environ.get('FIRST', 0))
    server = of()
    failed = False
    with sync_playwright() as play:
        browser = Browser(play)
        for one in chosen:
            count += 1
            name = one.__name__.replace('_', ' ')
            try:
                reason = one(browser, server)
                assert not browser.trouble, f'the browser complains: {browser.trouble}'
                print(f'ok {count} - {name}' + (f' # SKIP {reason}' if reason else ''), flush=True)
            except Exception: # every failure is one test's
                failed = True
                print(f'not ok {count} - {name}')
                for line in traceback.format_exc().splitlines():
                    if 'site-packages' not in line and line.strip('~^ '):
                        print(f'# {line}')
                print(f'# the browser said: {browser.trouble}', flush=True)
                for page in (p for c in browser.contexts for p in c.pages):
                    with contextlib.suppress(Exception):
                        print('# ' + json.dumps(page.evaluate("""[cockpit.whyNot(), cockpit.age(),
                            cockpit.lease.status(), cockpit.play.name, cockpit.play.look?.check,
                            cockpit.state.play, cockpit.state.stop.latched, cockpit.log.slice(0, 5)]""")),
                              flush=True)
                if server.process.poll() is not None:
                    print(f'# the server ended with {server.process.returncode}')
                    server.start()
            browser.tidy()
            browser.trouble.clear()
            with contextlib.suppress(AssertionError):
                server.settle()
        browser.browser.close()
    server.close()
    sys.exit(1 if failed else 0)


if __name__ == '__main__':
    main()
