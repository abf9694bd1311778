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
AXE = os.environ.get('AXE', '')
LIMIT_MS = 30000
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

    def __init__(self, *options, port=None, folder=None, device='sim', wait=None):
        self.device = device
        self.answers = wait or (lambda s: None not in s['angle_deg'])
        self.own = folder is None
        self.folder = folder or tempfile.mkdtemp()
        if self.own:
            for file in MOTIONS.iterdir():
                if file.suffix in ('.pseq', '.m', '.yaml'):
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
        self.wait(lambda s: s['link'] == 'up' and self.answers(s))

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
            self.call('POST', '/api/reset', {'sequence': self.call('GET', '/api/state')['sequence']})
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
        self.expected = ['409 (Conflict)']

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
                not any(words in m.text for words in self.expected) and self.trouble.append(m.text))
        page.on('pageerror', lambda e: self.trouble.append(e.stack or str(e)))
        page.goto(link)
        if ready:
            until(page, 'self.cockpit && cockpit.figure.frames > 0 && cockpit.drawn > 0')
        return page

    def expects(self, *words):
        """What the browser may complain of in this test: it does so when it likes."""
        self.expected += words

    def tidy(self):
        for context in self.contexts:
            context.close()
        self.contexts = []
        self.expected = self.expected[:1]
        self.trouble.clear()


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


def nothing_serious(page, where):
    """What axe-core finds in the page, and finds again: what is old for a moment is grey."""
    page.evaluate(pathlib.Path(AXE).read_text(encoding='utf-8'))
    for _ in range(5):
        bad = page.evaluate("""axe.run({ resultTypes: ['violations'] }).then((r) => r.violations
            .filter((v) => ['serious', 'critical'].includes(v.impact)).map((v) => [v.id,
            v.nodes.map((n) => n.target.join(' ') + ': ' + (n.any[0] || n.all[0] || n.none[0] || {}).message)]))""")
        if not bad:
            return
    raise AssertionError(f'{where}: {json.dumps(bad, indent=1)}')


def loops(page, server, at_ms=0):
    """The page plays greet again and again, and is so far in it at least."""
    torque_on(page, server)
    choose(page, 'greet.pseq')
    page.check('#loop')
    page.click('#play')
    server.wait(lambda s: s['play']['state'] == 'playing' and s['play']['t_ms'] >= at_ms, 'playing')


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
    until(page, "document.getElementById('chosen').innerText.startsWith('L_ELBOW_P')")


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
        server.call('POST', '/api/reset', {'sequence': server.state()['sequence']})
        until(page, '!cockpit.state.stop.latched')


@test
def a_page_without_the_token_watches_and_stops(browser, server):
    page = browser.page(server.url)
    assert page.locator('#lease').is_disabled()
    page.click('#stop')
    server.wait(lambda s: s['stop']['latched'], 'a stop')
    stopped(page)
    server.call('POST', '/api/reset', {'sequence': server.state()['sequence']})


@test
def a_new_link_in_an_old_tab_is_taken(browser, server):
    page = browser.page(server.url + '#token=of-the-server-before')
    with page.expect_event('load', timeout=LIMIT_MS): # the link itself loads nothing
        page.evaluate('link => { location.href = link; }', server.link)
    until(page, 'self.cockpit && cockpit.drawn > 0')
    assert page.evaluate('cockpit.api.token') == TOKEN
    drive(page)


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
    at_once = page.evaluate("""cockpit.robot.joints.map((_, n) => {
        cockpit.select(n);
        return Number(document.querySelector('.jog input[type=range]').value);
    })""")
    worst = max(abs(a - b) for a, b in zip(at_once, server.state()['angle_deg']))
    assert worst < 1, f'a slider that was chosen stands {worst} degrees beside its joint'
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
def a_question_holds_up_neither_control_nor_stop(browser, server):
    page = browser.page(server.link)
    drive(page)
    torque_on(page, server)
    page.click('#torque-off')
    until(page, "document.activeElement.value === 'no'")
    until(page, 'old => cockpit.state.time_ms > old + 4000', page.evaluate('cockpit.state.time_ms'))
    assert page.evaluate("cockpit.lease.status()") == 'mine' # a reader takes his time
    assert set(server.state()['torque']) == {'on'}
    nothing_serious(page, 'a question')
    page.click('#ask [value=yes]')
    server.wait(lambda s: set(s['torque']) == {'off'}, 'torque off')
    torque_on(page, server)
    page.click('#torque-off')
    page.click('#stop')
    stopped(page)
    page.locator('#ask [value=no]').focus()
    page.keyboard.press('Escape')
    until(page, "!document.getElementById('ask').open")
    assert set(server.state()['torque']) == {'on'}


HOLD_FIRST = """path => {
    const real = self.fetch;
    self.held = 0;
    self.fetch = (...request) => request[0] !== path || self.held++ > 0 ? real(...request)
        : new Promise((done) => { self.letGo = done; }).then(() => real(...request));
}"""


@test
def a_drag_before_a_gap_of_the_network_moves_nothing_after_it(browser, server):
    browser.expects('stale: ')
    page = browser.page(server.link)
    drive(page)
    torque_on(page, server)
    page.click('.joint:text-is("L_ELBOW_P")')
    before = server.state()
    page.evaluate(HOLD_FIRST, '/api/jog')
    page.locator('.jog input[type=range]').focus()
    page.keyboard.press('PageDown') # is under way
    page.keyboard.press('PageDown') # waits
    until(page, 'cockpit.joints.newest.next !== undefined')
    until(page, 'old => cockpit.drawn > old + 40', before['sequence'])
    page.evaluate('letGo()')
    until(page, 'self.held === 2 && !cockpit.joints.newest.busy')
    still(server)
    worst = max(abs(a - b) for a, b in zip(before['angle_deg'], server.state()['angle_deg']))
    assert worst < 1, f'a joint moved {worst} degrees'
    until(page, "cockpit.lease.status() === 'mine'")


@test
def a_seek_before_a_gap_of_the_network_moves_nothing_after_it(browser, server):
    browser.expects('stale: ')
    page = browser.page(server.link)
    drive(page)
    loops(page, server, 200)
    page.evaluate(HOLD_FIRST, '/api/seek')
    page.evaluate("""() => {
        const post = cockpit.api.post.bind(cockpit.api);
        self.refused = [];
        cockpit.api.post = (path, body) => post(path, body).catch((no) => {
            refused.push(no.code);
            throw no;
        });
        for (const ms of [300, 600]) {
            document.getElementById('seek').value = ms;
            document.getElementById('seek').dispatchEvent(new Event('input'));
        }
    }""")
    until(page, 'old => cockpit.drawn > old + 40', page.evaluate('cockpit.drawn'))
    page.evaluate('letGo()')
    until(page, 'self.held === 2 && !cockpit.play.seek.busy')
    assert page.evaluate('refused') == ['stale', 'stale'], page.evaluate('refused')


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
        server.wait(lambda s, end=end: s['play']['state'] == end and s['job'] is None, end)
        assert set(server.state()['torque']) == {'on'}, declared
        comes_to_rest(server)
        page.close()


@test
def a_hidden_page_gives_control_back_and_its_motion_ends_as_declared(browser, server):
    page = browser.page(server.link)
    drive(page)
    loops(page, server)
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
    browser.expects('ERR_')
    place = pathlib.Path(tempfile.mkdtemp()) / 'robot'
    sim = subprocess.Popen([os.environ['GRCTL'], 'sim', '--link', str(place)], stdin=subprocess.DEVNULL,
                           stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    sim.stdout.readline()
    own = Server(device=str(place))
    try:
        page = browser.page(own.link)
        drive(page)
        loops(page, own, 300)
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


@test
def a_server_that_died_comes_back_and_nothing_moves(browser, server):
    browser.expects('ERR_')
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


@test
def a_foreign_page_moves_and_stops_nothing(browser, server):
    browser.expects('') # all that is tried is complained of
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
def a_motion_of_another_robot_says_so_and_keeps_no_card_blank(browser, server):
    page = browser.page(server.link)
    page.click('#tab-play')
    until(page, "document.querySelectorAll('.file').length > 3")
    until(page, "[...document.querySelectorAll('.badge')].every((b) => !b.textContent.includes('…'))")
    until(page, """[...document.querySelectorAll('.file')].every((card) =>
        card.textContent.includes('so101') || card.querySelector('canvas[data-painted]'))""")
    blank = page.evaluate("""[...document.querySelectorAll('.file')].filter((card) => {
        const canvas = card.querySelector('canvas'), pen = canvas.getContext('2d');
        return !pen.getImageData(0, 0, canvas.width, canvas.height).data.some((v) => v);
    }).map((card) => card.textContent)""")
    assert len(blank) == 1 and 'so101-wave.yaml' in blank[0], blank
    said = page.locator('.file', has_text='so101-wave').locator('.badge')
    assert 'for another robot' in said.inner_text(), said.inner_text()
    assert 'made for so101, not for GR001' in said.inner_text(), said.inner_text()
    assert said.evaluate('(b) => b.scrollWidth <= b.clientWidth'), 'it cannot be read whole'
    drive(page)
    page.click('#tab-play')
    choose(page, 'so101-wave.yaml')
    until(page, "document.getElementById('verdict').textContent.includes('made for so101')")
    assert page.locator('#play').is_disabled() and page.locator('#preview').is_disabled()
    page.locator('#seek').fill('1000')
    until(page, 'old => cockpit.drawn > old + 5', server.state()['sequence'])
    still(server, 0.3)


@test
def a_joint_that_is_not_set_up_says_why(browser, server):
    environment = dict(os.environ, GRCTL_ROBOT='so101')
    grctl = os.environ['GRCTL']
    with subprocess.Popen([grctl, 'sim'], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                          env=environment) as robot:
        device = robot.stdout.readline().strip()
        for servo in ('3', '4'):
            subprocess.run([grctl, '-d', device, '--yes', 'servo-set', servo, 'mode', '3', '--flash'],
                           env=environment, check=True, capture_output=True)
        of_it = Server('--robot', 'so101', device=device, wait=lambda s: 'setup' in s['status'])
        try:
            page = browser.page(of_it.link)
            page.click('#tab-joints')
            until(page, "document.querySelectorAll('#setup-hint li').length === 2")
            said = page.locator('#setup-hint').inner_text()
            assert 'elbow_flex: not set up: mode is 3, 0 is wanted' in said, said
            assert "'grctl servo-set 4 mode 0 --flash' sets it" in said, said
            row_text = page.locator('#joints tbody tr').nth(2).inner_text()
            assert 'not set up' in row_text, row_text
            assert page.evaluate('document.body.scrollWidth <= innerWidth'), 'too wide'
        finally:
            of_it.close()
            robot.terminate()


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
    loops(page, server, 200)
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


# ---- make -----------------------------------------------------------------------------------------


def edit_motion(page, name):
    """Opens a motion in the editor, with all that is folded there unfolded."""
    page.click('#tab-make')
    page.select_option('#make-open', name)
    until(page, """name => cockpit.make.draft && cockpit.make.draft.name === name && cockpit.make.look
        && !cockpit.make.looks.busy""", name)
    page.evaluate("document.querySelectorAll('#make details').forEach((d) => { d.open = true; })")


def fresh_look(page):
    """The server has looked at the draft as it is."""
    until(page, 'cockpit.make.look && cockpit.make.look.keys === cockpit.make.draft.keys')


def row(page, name):
    """The slider of a joint of the draft."""
    return page.locator(f'#make-joints li:has(.joint:text-is("{name}")) input[type=range]')


def joint_of(page, name):
    return page.evaluate('name => cockpit.robot.joints.find((j) => j.name === name).joint', name)


def key_deg(page, key, joint):
    return page.evaluate('([k, j]) => cockpit.make.draft.keys[k].angle_deg[j]', [key, joint])


def screen_of(page, joint):
    """Where the middle of a joint's link is seen, in pixels of the page."""
    box = page.locator('#view canvas').bounding_box()
    at = page.evaluate("""joint => {
        const f = cockpit.figure, n = f.body.linkOf[joint], p = f.at[n], c = f.body.links[n].com;
        return f.onScreen([0, 1, 2].map((i) => p[i] * c[0] + p[4 + i] * c[1] + p[8 + i] * c[2] + p[12 + i]));
    }""", joint)
    return box['x'] + at[0], box['y'] + at[1]


def file_lines(server, name):
    return (pathlib.Path(server.folder) / name).read_bytes().split(b'\n')


@test
def a_pose_is_edited_undone_and_saved_as_a_new_file(browser, server):
    page = browser.page(server.link)
    begin = server.state()['angle_deg']
    edit_motion(page, 'greet.pseq')
    elbow = joint_of(page, 'R_ELBOW_P')
    page.locator('.markers button').nth(4).click()
    until(page, "document.getElementById('make-key-title').textContent === 'Key pose 5 of 10'")
    assert key_deg(page, 4, elbow) == -30
    row(page, 'R_ELBOW_P').focus()
    page.keyboard.press('PageDown')
    page.keyboard.press('ArrowDown')
    until(page, "document.querySelector('.labels .chosen')?.textContent === 'R_ELBOW_P -41.0°'")
    assert key_deg(page, 4, elbow) == -41
    assert abs(page.evaluate('j => cockpit.figure.pose.q[j] * 180 / Math.PI', elbow) + 41) < 0.01
    page.keyboard.press('Control+z')
    assert key_deg(page, 4, elbow) == -40
    page.keyboard.press('Control+z')
    assert key_deg(page, 4, elbow) == -30 and not page.evaluate('cockpit.make.draft.changed()')
    page.keyboard.press('Control+Shift+z')
    page.click('#make-redo')
    assert key_deg(page, 4, elbow) == -41
    fresh_look(page)
    until(page, "document.getElementById('make-verdict').textContent.startsWith('✓')")
    page.fill('#make-as', 'greet-low')
    page.click('#make-save-as')
    until(page, "document.getElementById('make-told').textContent.startsWith('Saved as greet-low.pseq. ✓')")
    differ = [b for a, b in zip(file_lines(server, 'greet.pseq'), file_lines(server, 'greet-low.pseq'))
              if a != b]
    assert len(differ) == 1 and b'-0.7155' in differ[0], differ
    # It is that file now: what is changed next is saved over it, and what was done can be undone.
    assert page.evaluate('cockpit.make.draft.name') == 'greet-low.pseq'
    page.click('#make-undo')
    assert key_deg(page, 4, elbow) == -40
    page.click('#make-save')
    until(page, "cockpit.make.draft.saved === cockpit.make.draft.keys && !cockpit.make.saving")
    assert server.call('GET', '/api/motions/greet-low.pseq')['keys'][4]['angle_deg'][elbow] == -40
    still(server, 0.2)
    worst = max(abs(a - b) for a, b in zip(begin, server.state()['angle_deg']))
    assert worst < 1, 'an edit moved the robot'


@test
def an_edit_is_told_of_limits_and_of_a_fall(browser, server):
    page = browser.page(server.link)
    edit_motion(page, 'bow.pseq')
    page.locator('.markers button').nth(1).click()
    row(page, 'L_ELBOW_P').focus()
    page.keyboard.press('End')
    until(page, "document.getElementById('make-verdict').textContent === '▲ L_ELBOW_P at its limit'")
    until(page, "document.querySelector('.labels .chosen').textContent.endsWith('at its limit')")
    limits = page.evaluate("cockpit.robot.joints.find((j) => j.name === 'L_ELBOW_P').limits_deg")
    assert key_deg(page, 1, joint_of(page, 'L_ELBOW_P')) == limits[1]
    number = page.locator('#make-joints li:has(.joint:text-is("L_ELBOW_P")) input[type=text]')
    number.fill('999')
    number.press('Enter')
    assert key_deg(page, 1, joint_of(page, 'L_ELBOW_P')) == limits[1]
    page.keyboard.press('Control+z')
    for name in ('R_ANKLE_P', 'L_ANKLE_P'): # a lean that no sole holds
        number = page.locator(f'#make-joints li:has(.joint:text-is("{name}")) input[type=text]')
        number.fill('25' if name[0] == 'R' else '-25')
        number.press('Enter')
    until(page, "document.getElementById('make-verdict').textContent.startsWith('▲ would fall at')")
    until(page, "cockpit.make.stance && cockpit.make.margin() < 0 && !cockpit.figure.pose.balance.inside")


@test
def a_joint_is_dragged_in_the_figure(browser, server):
    page = browser.page(server.link)
    edit_motion(page, 'greet.pseq')
    page.locator('.markers button').nth(1).click()
    joint = joint_of(page, 'L_SHOULDER_P')
    yaw = page.evaluate('cockpit.figure.camera.yaw')
    until(page, '!cockpit.figure.dirty')
    before = page.evaluate('j => cockpit.make.degrees()[j]', joint)
    x, y = screen_of(page, joint_of(page, 'L_ELBOW_P'))
    page.evaluate('j => cockpit.select(j)', joint)
    x, y = screen_of(page, joint)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 60, y - 10, steps=8)
    page.mouse.up()
    until(page, '!cockpit.make.frozen')
    after = key_deg(page, 1, joint)
    note(f'60 pixels turned L_SHOULDER_P from {before:.1f} to {after} degrees')
    assert abs(after - before) > 5, 'the drag turned nothing'
    assert page.evaluate('cockpit.selected') == joint
    assert page.evaluate('cockpit.figure.camera.yaw') == yaw, 'the drag turned the picture'
    assert page.evaluate('cockpit.make.draft.before.length') == 1, 'a drag is one step'
    page.keyboard.press('Control+z')
    assert not page.evaluate('cockpit.make.draft.changed()')
    page.mouse.move(40, 120)
    box = page.locator('#view canvas').bounding_box()
    page.mouse.move(box['x'] + 20, box['y'] + 60)
    page.mouse.down()
    page.mouse.move(box['x'] + 90, box['y'] + 60, steps=4)
    page.mouse.up()
    assert page.evaluate('cockpit.figure.camera.yaw') != yaw, 'beside the robot a drag turns the picture'


@test
def a_finger_turns_the_picture_before_it_turns_a_joint(browser, server):
    page = browser.page(server.link, size='phone')
    edit_motion(page, 'greet.pseq')
    until(page, '!cockpit.figure.dirty')
    joint = joint_of(page, 'L_SHOULDER_R')
    finger = page.context.new_cdp_session(page)

    def drag(x, y, dx):
        for kind, points in (('touchStart', [(x, y)]), ('touchMove', [(x + dx / 2, y)]),
                             ('touchMove', [(x + dx, y)]), ('touchEnd', [])):
            finger.send('Input.dispatchTouchEvent', {
                'type': kind, 'touchPoints': [{'x': a, 'y': b} for a, b in points]})

    yaw = page.evaluate('cockpit.figure.camera.yaw')
    drag(*screen_of(page, joint), 30)
    until(page, 'yaw => cockpit.figure.camera.yaw !== yaw', yaw)
    assert not page.evaluate('cockpit.make.draft.changed()')
    page.evaluate('cockpit.figure.home()')
    page.evaluate('j => cockpit.select(j)', joint)
    until(page, '!cockpit.figure.dirty')
    drag(*screen_of(page, joint), 30)
    until(page, 'cockpit.make.draft.before.length === 1 && !cockpit.make.frozen')
    assert page.evaluate('cockpit.figure.camera.yaw') == yaw
    assert page.evaluate('cockpit.make.draft.key().angle_deg.map((v, j) => v !== '
                         'cockpit.make.draft.base[0].angle_deg[j]).filter(Boolean).length') == 1


@test
def a_motion_of_an_arm_is_drawn_too(browser, server):
    folder = tempfile.mkdtemp()
    shutil.copy(MOTIONS / 'so101-wave.yaml', folder)
    arm = Server('--robot', 'so101', folder=folder)
    try:
        page = browser.page(arm.link)
        page.click('#tab-make')
        page.click('#make-new')
        until(page, "cockpit.make.draft && cockpit.figure.pose.draft")
        assert page.locator('#make-handles').is_hidden()
        first = page.evaluate('cockpit.robot.joints[1].name')
        row(page, first).focus()
        page.keyboard.press('PageUp')
        page.click('#make-add')
        page.keyboard.press('Control+z')
        page.click('#make-redo')
        fresh_look(page)
        page.click('#make-save-as')
        until(page, "document.getElementById('make-told').textContent.startsWith('Saved as new.pseq')")
        keys = arm.call('GET', '/api/motions/new.pseq')['keys']
        assert [k['time_ms'] for k in keys] == [0, 500] and keys[0]['angle_deg'] == keys[1]['angle_deg']
        page.select_option('#make-open', 'so101-wave.yaml')
        until(page, "cockpit.make.draft.keys.length > 10")
        page.click('#make-more summary')
        page.select_option('#make-other', 'new.pseq')
        until(page, "document.getElementById('make-difference').textContent !== ''")
    finally:
        arm.close()
        shutil.rmtree(folder)


@test
def feet_and_waist_are_moved_by_handles(browser, server):
    page = browser.page(server.link)
    edit_motion(page, 'bow.pseq')
    knee = joint_of(page, 'R_KNEE_P')
    before = key_deg(page, 0, knee)
    waist = page.evaluate('cockpit.figure.at[0][14]')
    page.click('#make-nudge button:text-is("Down")')
    page.click('#make-nudge button:text-is("Down")')
    until(page, 'z => Math.abs(cockpit.figure.at[0][14] - (z - 0.01)) < 0.0005', waist)
    assert key_deg(page, 0, knee) < before - 3, 'a lower waist bends the knees'
    until(page, '!cockpit.make.solving')
    assert page.evaluate('cockpit.make.draft.before.length') == 2
    # By the handle in the picture: 15 pixels up and down again is nearly the pose that was.
    page.click('#make-handle button:text-is("Left foot")')
    box = page.locator('#view canvas').bounding_box()
    until(page, '!cockpit.figure.dirty')
    link = page.evaluate("cockpit.robot.body.feet.find((f) => f.side === 'left').link")
    x, y = page.evaluate("""n => cockpit.figure.onScreen(cockpit.figure.at[n].slice(12, 15))""", link)
    left = joint_of(page, 'L_KNEE_P')
    bent = key_deg(page, 0, left)
    page.mouse.move(box['x'] + x, box['y'] + y)
    page.mouse.down()
    page.mouse.move(box['x'] + x, box['y'] + y - 15, steps=5)
    until(page, '([j, was]) => cockpit.make.draft.keys[0].angle_deg[j] > was + 3', [left, bent])
    page.mouse.up()
    until(page, '!cockpit.make.solving && !cockpit.make.frozen')
    assert page.evaluate('cockpit.make.draft.before.length') == 3, 'a drag is one step'
    # Out of reach is told, and leaves the pose as it is.
    far = page.evaluate('JSON.stringify(cockpit.make.draft.keys)')
    page.click('#make-handle button:text-is("Waist")')
    page.evaluate("cockpit.make.moveHandle('waist', [0, 0, 3], cockpit.make.shown(), 'far')")
    until(page, "document.getElementById('make-verdict').textContent === '▲ out of reach'")
    assert page.evaluate('JSON.stringify(cockpit.make.draft.keys)') == far
    # Where the figure stands by itself is where the server says that it stands.
    page.click('#tab-see')
    until(page, 'cockpit.state.body')
    apart = page.evaluate("""import('./body.js').then(({ stand }) => {
        const s = cockpit.state, here = stand(cockpit.figure.body, s.angle_deg.map((d) => d * Math.PI / 180));
        return Math.max(...cockpit.toMatrix(s.body.root).map((v, n) => Math.abs(v - here[n])));
    })""")
    assert apart < 0.0005, f'{apart} m from where the server puts it'


@test
def legs_of_a_file_stay_targets(browser, server):
    page = browser.page(server.link)
    edit_motion(page, 'step.pseq')
    page.click('#make-nudge button:text-is("Up")')
    until(page, 'cockpit.make.draft.before.length === 1 && !cockpit.make.solving')
    fresh_look(page)
    page.fill('#make-as', 'step-high.pseq')
    page.click('#make-save-as')
    until(page, "document.getElementById('make-told').textContent.startsWith('Saved as')")
    was = server.call('GET', '/api/motions/step.pseq')['keys']
    now = server.call('GET', '/api/motions/step-high.pseq')['keys']
    assert now[1:] == was[1:]
    waist = now[0]['links'][0]
    assert abs(waist['p_m'][2] - was[0]['links'][0]['p_m'][2] - 0.005) < 1e-6, waist
    assert waist['base'] and now[0]['links'][1:] == was[0]['links'][1:]
    assert now[0]['angle_deg'] != was[0]['angle_deg']
    # A knee that is turned moves its foot's target, and a foot that slips so is told.
    page.locator('.markers button').nth(2).click()
    row(page, 'R_KNEE_P').focus()
    page.keyboard.press('PageDown')
    moved = [a['link'] for a in page.evaluate('cockpit.make.draft.keys[2].links')
             if a not in was[2]['links']]
    assert moved == ['R_ANKLE_R'], moved
    fresh_look(page)
    until(page, "document.getElementById('make-verdict').textContent.startsWith('▲ out of balance from')")


@test
def keys_are_added_moved_copied_mirrored_and_deleted(browser, server):
    page = browser.page(server.link)
    edit_motion(page, 'greet.pseq')
    times = 'cockpit.make.draft.keys.map((k) => k.time_ms)'
    was = page.evaluate(times)
    page.locator('#make-track input').focus()
    page.locator('#make-track input').fill('2500')
    until(page, "document.getElementById('make-key-title').textContent.startsWith('Between')")
    page.click('#make-add')
    assert page.evaluate(times) == was[:6] + [2500] + was[6:]
    page.locator('.markers [aria-selected=true]').focus()
    page.keyboard.press('Shift+ArrowRight')
    assert page.evaluate(times)[6] == 2510
    page.keyboard.press('ArrowLeft')
    until(page, "cockpit.make.at === 2200 && document.activeElement.matches('.markers [aria-selected=true]')")
    page.keyboard.press('Control+c')
    page.locator('#make-track input').fill('4600')
    page.keyboard.press('Control+v')
    assert page.evaluate(times) == was[:6] + [2510, 2900, 3600, 4200, 4600, 5000]
    copied = 'n => JSON.stringify(cockpit.make.draft.keys[n].angle_deg)'
    assert page.evaluate(copied, 10) == page.evaluate(copied, 5)
    page.click('#make-mirror')
    arms = page.evaluate("""() => { const k = cockpit.make.draft.keys, js = cockpit.robot.joints;
        return js.map((j) => [k[10].angle_deg[j.joint], k[5].angle_deg[j.mirror], j.mirror_sign]); }""")
    assert all(a == (b if b is None else b * s) for a, b, s in arms), arms
    marker = page.locator('.markers button').nth(11).bounding_box()
    page.mouse.move(marker['x'] + 13, marker['y'] + 14)
    page.mouse.down()
    page.mouse.move(marker['x'] + 63, marker['y'] + 14, steps=4)
    page.mouse.up()
    assert page.evaluate(times)[11] > 5200
    page.keyboard.press('Delete') # the marker has the focus
    page.fill('#make-way', '1.5')
    page.locator('#make-way').press('Enter')
    until(page, "cockpit.make.draft.keys.length === 11 && cockpit.make.draft.before.length === 7")
    now = page.evaluate(times)
    assert now[10] - now[9] == 1500, now
    for _ in range(7):
        page.click('#make-undo')
    assert page.evaluate(times) == was and not page.evaluate('cockpit.make.draft.changed()')
    for _ in range(7):
        page.click('#make-redo')
    assert page.evaluate(times) == now
    fresh_look(page)
    page.fill('#make-as', 'keys')
    page.click('#make-save-as')
    until(page, "document.getElementById('make-told').textContent.startsWith('Saved as keys.pseq')")
    assert [k['time_ms'] for k in server.call('GET', '/api/motions/keys.pseq')['keys']] == now


@test
def a_file_that_changed_elsewhere_is_not_written_over(browser, server):
    browser.expects('400 (Bad Request)')
    path = pathlib.Path(server.folder) / 'mine.pseq'
    shutil.copy(MOTIONS / 'bow.pseq', path)
    page = browser.page(server.link)
    until(page, "[...document.querySelectorAll('#make-open option')].some((o) => o.value === 'mine.pseq')")
    edit_motion(page, 'mine.pseq')
    page.locator('.markers button').nth(2).click()
    row(page, 'NECK_Y').focus()
    page.keyboard.press('PageUp')
    path.write_bytes((MOTIONS / 'bow.pseq').read_bytes() + b'# somebody else\n')
    theirs = path.read_bytes()
    page.click('#make-save')
    until(page, "document.getElementById('make-told').textContent.includes('has changed since it was opened')")
    assert path.read_bytes() == theirs
    page.fill('#make-as', 'bow.pseq')
    page.click('#make-save-as')
    until(page, "document.getElementById('make-told').textContent.includes('is there already')")
    assert (pathlib.Path(server.folder) / 'bow.pseq').read_bytes() == (MOTIONS / 'bow.pseq').read_bytes()
    page.fill('#make-as', '../out.pseq')
    page.click('#make-save-as')
    until(page, "document.getElementById('make-told').className === 'bad'")
    assert not (pathlib.Path(server.folder).parent / 'out.pseq').exists()
    page.select_option('#make-open', 'greet.pseq') # what is not saved is not left by mistake
    page.click('#ask [value=no]')
    until(page, "document.getElementById('make-open').value === 'mine.pseq'")
    assert page.evaluate('cockpit.make.draft.name') == 'mine.pseq'


@test
def frames_become_key_poses_and_key_poses_other_formats(browser, server):
    page = browser.page(server.link)
    page.click('#tab-make')
    page.select_option('#make-open', 'greet.yaml')
    until(page, 'cockpit.make.draft && cockpit.make.draft.keys.length === 26')
    until(page, "document.getElementById('make-save').disabled")
    fresh_look(page)
    page.click('#make-save-as')
    until(page, "document.getElementById('make-told').textContent.startsWith('Saved as greet-keys.pseq')")
    assert server.call('GET', '/api/motions/greet-keys.pseq')['length_ms'] == 5000
    for name, kind, length in (('out.m', 'postures', 5250), ('out.yaml', 'frames', 5000)):
        edit_motion(page, 'greet.pseq')
        page.fill('#make-as', name)
        page.click('#make-save-as')
        words = 'Saved as' if kind == 'postures' else 'A copy was written as'
        until(page, 'words => document.getElementById("make-told").textContent.startsWith(words)',
              f'{words} {name}')
        made = server.call('GET', f'/api/motions/{name}')
        assert (made['kind'], made['length_ms'], made['check']['ok']) == (kind, length, True), made['check']
        assert page.evaluate('cockpit.make.draft.name') == ('out.m' if kind == 'postures' else 'greet.pseq')
    page.click('#make-new')
    until(page, 'cockpit.make.draft.name === null && cockpit.make.draft.keys.length === 1')


@test
def frames_are_edited_in_place(browser, server):
    path = pathlib.Path(server.folder) / 'mine.yaml'
    shutil.copy(MOTIONS / 'greet.yaml', path)
    was = path.read_bytes().split(b'\n')
    page = browser.page(server.link)
    until(page, "[...document.querySelectorAll('#make-open option')].some((o) => o.value === 'mine.yaml')")
    page.click('#tab-make')
    page.select_option('#make-open', 'mine.yaml')
    until(page, "cockpit.make.draft && cockpit.make.draft.name === 'mine.yaml'")
    page.locator('.markers button').nth(5).click() # at 1 s
    for press in ('PageUp', 'PageUp'):
        row(page, 'NECK_Y').focus()
        page.keyboard.press(press)
        fresh_look(page)
        page.click('#make-save')
        until(page, '!cockpit.make.saving && !cockpit.make.draft.changed()')
        until(page, "document.getElementById('make-told').textContent.startsWith('Saved as mine.yaml')")
    now = path.read_bytes().split(b'\n')
    differ = [n for n, (a, b) in enumerate(zip(was, now)) if a != b]
    assert len(now) == len(was) and len(differ) == 19 and differ[-1] - differ[0] == 18, differ
    for n in differ: # one joint of 0.82 to 1.18 s
        assert sum(a != b for a, b in zip(was[n].split(b','), now[n].split(b','))) == 1, now[n]
    assert page.evaluate('cockpit.make.draft.frames')


@test
def two_motions_are_compared(browser, server):
    page = browser.page(server.link)
    edit_motion(page, 'greet.pseq')
    page.select_option('#make-other', 'greet.m')
    until(page, "document.getElementById('make-difference').textContent !== ''")
    close = page.locator('#make-difference').inner_text()
    page.select_option('#make-other', 'wave_both.pseq')
    until(page, "document.getElementById('make-difference').textContent.startsWith('5.0 s here, 4.2 s there.')")
    first = page.locator('#make-compare tbody tr').first
    name = first.locator('.joint').inner_text()
    said = float(first.locator('td').first.inner_text().rstrip('°'))
    one, two = (server.call('GET', f'/api/motions/{m}.pseq?rate=30')['frames']['angle_deg']
                for m in ('greet', 'wave_both'))
    joint = joint_of(page, name)
    most = max((b[joint] - a[joint] for a, b in zip(one, two)), key=abs)
    assert abs(most - said) < 0.06, (name, most, said)
    worst = max(abs(b[j] - a[j]) for a, b in zip(one, two) for j in range(20))
    assert abs(worst - abs(said)) < 0.06, 'the largest is first'
    note(f'{close}; wave_both: {name} {said} degrees')
    first.locator('.joint').click()
    assert page.evaluate('cockpit.selected') == joint
    until(page, "[...document.querySelectorAll('.labels span')].some((s) => s.textContent === 'wave_both.pseq')")


@test
def the_robot_is_made_limp_captured_and_shown_a_pose(browser, server):
    page = browser.page(server.link)
    edit_motion(page, 'greet.pseq')
    until(page, "['show', 'limp', 'hold'].every((n) => document.getElementById(`make-${n}`).disabled)")
    drive(page)
    torque_on(page, server)
    elbow = joint_of(page, 'L_ELBOW_P')
    server.call('POST', '/api/move', {'angle_deg': {'L_ELBOW_P': 55}, 'time_ms': 300,
                                      'sequence': server.state()['sequence']},
                **{'X-Grobo-Lease': page.evaluate('cockpit.api.lease')})
    server.wait(lambda s: abs(s['angle_deg'][elbow] - 55) < 1 and s['job'] is None, 'the elbow')
    page.click('#tab-make')
    page.select_option('#make-group', 'left_arm')
    page.click('#make-limp')
    server.wait(lambda s: elbow in s['limp'], 'a limp arm')
    until(page, 'j => cockpit.state.limp.includes(j)', elbow)
    page.locator('.markers button').nth(2).click()
    knee = key_deg(page, 2, 3)
    page.click('#make-capture')
    until(page, 'j => cockpit.make.draft.keys[2].angle_deg[j] !== null', elbow)
    assert abs(key_deg(page, 2, elbow) - 55) < 2
    assert key_deg(page, 2, 3) == knee, 'joints with torque are not captured'
    page.click('#make-capture-new')
    until(page, 'cockpit.make.draft.keys.length === 11')
    assert page.evaluate('cockpit.make.draft.keys[10].time_ms') == 6000
    page.click('#make-hold')
    server.wait(lambda s: not s['limp'] and s['job'] is None, 'an arm that holds')
    torque_on(page, server)
    page.click('#tab-make')
    page.locator('.markers button').nth(1).click()
    target = page.evaluate('cockpit.make.degrees()')
    seconds = page.evaluate('cockpit.make.showTime()') / 1000
    begin = server.state()['angle_deg']
    fastest = max(abs(a - b) for a, b in zip(begin, target)) / seconds
    assert fastest <= page.evaluate('cockpit.robot.safety.approach_dps') + 0.1, fastest
    page.click('#make-show')
    server.wait(lambda s: max(abs(a - b) for a, b in zip(s['angle_deg'], target)) < 2, 'the pose')
    page.keyboard.press('Escape')
    stopped(page)
    assert page.locator('#make-show').is_disabled()


@test
def a_draft_lives_through_a_preview_and_other_views(browser, server):
    page = browser.page(server.link)
    edit_motion(page, 'greet.pseq')
    page.click('#make-preview')
    until(page, 'cockpit.make.at > 400 && cockpit.make.previewing')
    page.evaluate('document.activeElement.blur()')
    page.keyboard.press(' ')
    until(page, '!cockpit.make.previewing')
    still(server, 0.2)
    row(page, 'NECK_Y').focus()
    page.keyboard.press('PageUp')
    page.click('#tab-play')
    until(page, '!cockpit.figure.pose.draft')
    assert page.locator('#maker').is_hidden()
    page.click('#tab-make')
    until(page, 'cockpit.figure.pose.draft && cockpit.make.draft.changed()')
    until(page, "document.getElementById('make-changed').innerText === 'not saved'")


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


CONTEXTS = """self.contexts = [];
    const real = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (...words) {
        contexts.push(performance.getEntriesByName('first-contentful-paint').length);
        return real.apply(this, words);
    };"""
LOADED = """performance.getEntriesByType('resource').filter((r) => r.responseEnd > 0 &&
    !r.name.includes('/api/')).map((r) => new URL(r.name).pathname.split('/').pop())"""


def is_drawn_before_its_scripts(browser, link, sheets, ready):
    """No script is let through: the words of the page and STOP are there all the same, from the HTML
    and its style sheets alone. Then the scripts come in two steps, each of which is asked for at once:
    those of STOP, and when the page was painted those of the view. What draws asks for a context later
    still."""
    held, let = [], []
    context = browser.context()
    context.add_init_script(CONTEXTS)
    page = context.new_page()
    page.on('pageerror', lambda e: browser.trouble.append(e.stack or str(e)))
    page.on('console', lambda m: m.type in ('error', 'warning') and browser.trouble.append(m.text))
    page.route('**/*.js', lambda route: held.append(route))
    early = page.goto(link, wait_until='commit').headers['link']
    assert all(f'/{sheet}>; rel=preload; as=style' in early for sheet in sheets), early
    until(page, "performance.getEntriesByName('first-contentful-paint').length === 1")
    stop = page.locator('#stop')
    assert stop.inner_text().startswith('STOP') and stop.bounding_box()['height'] >= 64
    words = page.inner_text('body')
    loaded = page.evaluate(LOADED)
    assert sorted(set(loaded) - {'icon.svg'}) == sheets, loaded
    assert page.evaluate("!self.cockpit && document.body.matches('.unarmed')"), 'a script ran'
    for what in ('script, link[rel=modulepreload]', 'link[data-later]'):
        names = page.evaluate('(w) => [...document.querySelectorAll(w)].map((n) => n.src || n.href)', what)
        end = time.monotonic() + LIMIT_MS / 1000
        while len(held) < len(names) and time.monotonic() < end:
            page.wait_for_timeout(15)
        assert sorted(r.request.url for r in held) == sorted(names), f'{what}: {names}'
        let.append([held.pop(0) for _ in names])
        for one in let[-1]:
            one.continue_()
    page.route('**/*.js', lambda route: (held.append(route), route.continue_()))
    until(page, ready)
    more = {r.request.url.rsplit('/', 1)[1] for r in held}
    assert more <= {'worker.js', 'feed.js'}, f'not named in the HTML: {more}' # of the shared worker
    assert page.evaluate("!document.body.matches('.unarmed')")
    contexts = page.evaluate('contexts')
    assert contexts and all(n == 1 for n in contexts), f'drawn before the first paint: {contexts}'
    note(f'first paint needs {1 + len(sheets)} requests; STOP {len(let[0])} scripts at once, the view '
         f'{len(let[1])} more at once')
    return words


@test
def it_is_drawn_before_its_scripts(browser, server):
    words = is_drawn_before_its_scripts(browser, server.link, ['style.css'],
                                        'self.cockpit && cockpit.figure.frames > 0 && cockpit.drawn > 0')
    for word in ('connecting', 'Take control', 'Torque', 'See', 'Play', 'Joints', 'Make', 'More',
                 'Last minute', 'Software stop'):
        assert word in words, f'{word} is not in {words}'


@test
def stop_is_heard_though_the_rest_of_the_page_does_not_come(browser, server):
    page = browser.context().new_page()
    held = []
    page.route('**/figure.js', lambda route: held.append(route)) # and never let through
    page.goto(server.link, wait_until='commit')
    until(page, "document.body && !document.body.classList.contains('unarmed')")
    assert page.evaluate('!self.cockpit')
    page.keyboard.press('Escape')
    server.wait(lambda s: s['stop']['latched'] and s['stop']['confirmed'], 'a confirmed stop')
    until(page, "document.getElementById('stop-words').innerText.startsWith('STOP sent')")
    for one in held:
        one.abort()


@test
def a_second_visit_asks_for_the_page_alone(browser, server):
    context = browser.context()
    page = browser.page(server.link, context=context)
    first = page.evaluate('performance.getEntriesByType("resource").filter((r) => r.transferSize).length')
    page.goto('about:blank')
    page.goto(server.link)
    until(page, 'self.cockpit && cockpit.drawn > 0')
    again = page.evaluate("""performance.getEntriesByType('resource').filter((r) => r.transferSize &&
        r.initiatorType !== 'fetch' && r.initiatorType !== 'beacon').map((r) => r.name)""")
    assert not again, f'loaded again: {again}'
    note(f'{first} requests at the first visit, of the page itself none but the HTML at the second')


FIRST_PAINT = """new Promise((told) => new PerformanceObserver((list) =>
    list.getEntriesByName('first-contentful-paint').forEach((entry) => told(entry.startTime)))
    .observe({type: 'paint', buffered: true}))"""


def first_paints(browser, link, rounds=5):
    """First paints of a link in a new context each, in ms."""
    found = []
    for _ in range(rounds):
        context = browser.context()
        page = context.new_page()
        page.goto(link, wait_until='commit')
        found.append(page.evaluate(FIRST_PAINT)) # asking for it would take processor time from it
        context.close()
    return sorted(found)


@test
def its_first_paint_beside_that_of_an_empty_page(browser, server):
    empty = b'<!DOCTYPE html><title>floor</title><p>floor'

    class Floor(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header('Content-Type', 'text/html')
            self.send_header('Content-Length', str(len(empty)))
            self.end_headers()
            self.wfile.write(empty)

        def log_message(self, *words):
            pass

    with http.server.ThreadingHTTPServer(('127.0.0.1', 0), Floor) as floor:
        threading.Thread(target=floor.serve_forever, daemon=True).start()
        first_paints(browser, server.link, 1) # the browser warms up
        pages = first_paints(browser, server.link)
        floors = first_paints(browser, f'http://127.0.0.1:{floor.server_address[1]}/')
        floor.shutdown()
    note(f'first paint, 5 visits of a new context each: median {pages[2]:.0f} ms ({pages[0]:.0f} to '
         f'{pages[4]:.0f}); an empty page of loopback: median {floors[2]:.0f} ms ({floors[0]:.0f} to '
         f'{floors[4]:.0f})')


@test
def it_fits_three_sizes(browser, server):
    for size, (width, height) in SIZES.items():
        page = browser.page(server.link, size=size)
        for tab in ('see', 'play', 'joints', 'make', 'more'):
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
    if not os.path.exists(AXE):
        return 'axe-core is not installed'
    for size in ('desktop', 'phone'):
        for scheme in ('light', 'dark'):
            page = browser.page(server.link, context=browser.context(
                size, color_scheme=scheme, bypass_csp=True))
            for tab in ('see', 'play', 'joints', 'make', 'more'):
                page.click(f'#tab-{tab}')
                if tab == 'joints':
                    page.click('.joint:text-is("R_KNEE_P")')
                if tab == 'make':
                    edit_motion(page, 'greet.pseq')
                    page.select_option('#make-other', 'bow.pseq')
                page.wait_for_timeout(400)
                nothing_serious(page, f'{size} {scheme} {tab}')
    return None


@test
def pictures_of_each_view(browser, server):
    folder = os.environ.get('PICTURES')
    if not folder:
        return 'PICTURES names no folder'
    os.makedirs(folder, exist_ok=True)
    for size in SIZES:
        for scheme, locale in (('light', 'en-GB'), ('dark', 'en-GB'), ('light', 'ja-JP')):
            look = 'ja' if locale == 'ja-JP' else scheme
            page = browser.page(server.link, size=size, color_scheme=scheme, locale=locale)
            drive(page)
            torque_on(page, server)
            for tab in ('see', 'play', 'joints', 'make', 'more'):
                if tab == 'play':
                    choose(page, 'greet.pseq')
                    page.click('#play')
                    server.wait(lambda s: s['play']['state'] == 'playing' and s['play']['t_ms'] > 900)
                page.click(f'#tab-{tab}')
                if tab == 'make':
                    server.wait(lambda s: s['play']['state'] not in ('playing', 'stopping'), 'its end')
                    edit_motion(page, 'greet.pseq')
                    page.locator('.markers button').nth(4).click()
                    page.evaluate('cockpit.select(16)')
                    page.select_option('#make-other', 'wave_both.pseq')
                page.wait_for_timeout(500)
                page.screenshot(path=f'{folder}/{size}-{tab}-{look}.png')
                if tab == 'make':
                    page.evaluate("document.getElementById('make').scrollTop = 400")
                    page.wait_for_timeout(200)
                    page.screenshot(path=f'{folder}/{size}-{tab}-below-{look}.png')
            page.click('#stop')
            until(page, "cockpit.state.stop.confirmed && document.getElementById('stopped').matches('.ok')")
            page.screenshot(path=f'{folder}/{size}-stopped-{look}.png')
            page.close()
            server.call('POST', '/api/reset', {'sequence': server.state()['sequence']})
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
            with contextlib.suppress(AssertionError):
                server.settle()
        browser.browser.close()
    server.close()
    sys.exit(1 if failed else 0)


if __name__ == '__main__':
    main()
