// SPDX-License-Identifier: MIT
// The parts of the cockpit's page that need no browser. usage: node unit.mjs PAGE_FOLDER; prints TAP.
import { readFileSync, readdirSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const folder = process.argv[2];
const page = (name) => import(pathToFileURL(`${folder}/${name}.js`));
let tests = 0, failed = 0;

function near(a, b, tolerance = 1e-9) {
    const flat = (v) => Array.isArray(v) ? v.flat(9) : [v];
    const [x, y] = [flat(a), flat(b)];
    if (x.length !== y.length || x.some((v, n) => !(Math.abs(v - y[n]) <= tolerance))) {
        throw new Error(`${JSON.stringify(a)} is not ${JSON.stringify(b)}`);
    }
}

function same(a, b) {
    if (JSON.stringify(a) !== JSON.stringify(b)) {
        throw new Error(`${JSON.stringify(a)} is not ${JSON.stringify(b)}`);
    }
}

async function test(name, body) {
    tests++;
    try {
        await body();
        console.log(`ok ${tests} - ${name}`);
    } catch (error) {
        failed++;
        console.log(`not ok ${tests} - ${name}\n# ${error.stack.replace(/\n/g, '\n# ')}`);
    }
}

const m = await page('mat');
const { makeBody, forward, stand, inertiaBox } = await page('body');

await test('a rotation turns as the right hand does', () => {
    near(m.turn(m.rotation([0, 0, 1], Math.PI / 2), [1, 0, 0]), [0, 1, 0]);
    near(m.turn(m.rotation([1, 0, 0], Math.PI / 2), [0, 1, 0]), [0, 0, 1]);
});
await test('a rigid inverse takes a motion back', () => {
    const t = m.mul(m.translation([1, 2, 3]), m.rotation(m.unit([1, 2, -1]), 0.7));
    near(m.mul(t, m.rigidInverse(t)), m.identity(), 1e-12);
});
await test('the camera puts what it looks at in the middle', () => {
    const view = m.mul(m.perspective(0.5, 1.5, 0.1, 10), m.lookAt([2, 1, 1], [0, 0, 0.2], [0, 0, 1]));
    const c = m.project(view, [0, 0, 0.2]);
    near([c[0] / c[3], c[1] / c[3]], [0, 0], 1e-12);
    const up = m.project(view, [0, 0, 0.4]);
    same(up[1] / up[3] > 0, true);
});

const joint = (name) => ({ name, joint: 0, limits_deg: [-90, 90] });
const link = (parent, at, axis, n) => ({ name: `l${n}`, parent, joint: n, axis, mass: 0.1,
                                         com: [0, 0, -0.05], frame: m.translation(at) });
const legs = () => makeBody(
    [{ ...link(-1, [0, 0, 0.3], [0, 1, 0], -1) }, link(0, [0, -0.05, 0], [0, 1, 0], 0),
     link(1, [0, 0, -0.1], [0, 1, 0], 1), link(0, [0, 0.05, 0], [0, 1, 0], 2),
     link(3, [0, 0, -0.1], [0, 1, 0], 3)],
    [{ link: 2, sole: [0, 0, -0.1], half: [0.04, 0.02] },
     { link: 4, sole: [0, 0, -0.1], half: [0.04, 0.02] }],
    ['a', 'b', 'c', 'd'].map(joint));

await test('links follow their joints', () => {
    const at = forward(legs(), [Math.PI / 2, 0, 0, 0], m.identity());
    near(m.origin(at[2]), [-0.1, -0.05, 0], 1e-12); // the shank points back
    near(m.origin(at[4]), [0, 0.05, -0.1], 1e-12);
});
await test('a body stands with its lower foot flat on the ground', () => {
    const body = legs(), q = [0.3, -0.1, 0.2, 0.4];
    const at = forward(body, q, stand(body, q));
    const soles = body.feet.map((foot) => [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([x, y]) => m.place(
        at[foot.link], [x * 0.04, y * 0.02, -0.1])[2]));
    same(soles.map((z) => z.every((v) => Math.abs(v) < 1e-9)), [true, false]);
    same(Math.min(...soles[1]) > -0.02, true); // with the other flat, this one would be deeper
    const middle = (t) => m.place(t[body.feet[0].link], [0, 0, -0.1]).slice(0, 2);
    near(middle(at), middle(forward(body, [], m.identity())), 1e-12); // as the server puts it
});
await test('a box has the inertia it was made of', () => {
    const [a, b, c] = [0.02, 0.03, 0.05], mass = 0.2;
    const inertia = [b * b + c * c, a * a + c * c, a * a + b * b].map((v) => mass / 3 * v);
    near(inertiaBox(mass, inertia), [a, b, c], 1e-12);
    same(inertiaBox(0, inertia), null);
});
await test('a robot without links is a row of pointers', () => {
    const body = makeBody([], [], ['a', 'b', 'c'].map(joint));
    same(body.linkOf, [1, 2, 3]);
    same(body.links.every((l) => l.joint < 0 || l.hub.length > 0), true);
});
await test('solids are closed: their normals point outwards', async () => {
    const { box, hub, ball, strut } = await page('shape');
    for (const solid of [box([1, 2, 3], 0.2), hub([0, 0, 0], [0, 0, 1], 1, 0.5), ball([0, 0, 0], 1),
                         strut([0, 0, -1], [0, 0, 1], 0.2)]) {
        for (const { points, normal } of solid) {
            same(points.every((p) => m.dot(p, normal) > 0), true);
            near(m.length(normal), 1, 1e-9);
            near(points.map((p) => m.dot(m.sub(p, points[0]), normal)), points.map(() => 0), 1e-9);
        }
    }
});

const { EventParser, Feed, pauseMs } = await page('feed');
await test('events are cut from pieces of any size', () => {
    const text = ': quiet\n\nevent: state\ndata: {"sequence": 1}\n\nid: 7\nevent: event\r\n' +
                 'data: one\ndata: two\r\n\r\n';
    const want = [{ type: 'state', id: null, data: '{"sequence": 1}' },
                  { type: 'event', id: '7', data: 'one\ntwo' }];
    for (const size of [1, 2, 3, 7, 1000]) {
        const got = [], parser = new EventParser((event) => got.push(event));
        for (let n = 0; n < text.length; n += size) {
            parser.push(text.slice(n, n + size));
        }
        same(got, want);
    }
});
await test('the pauses before another attempt grow and end', () => {
    const pauses = [0, 1, 2, 3, 4, 50].map((n) => pauseMs(n, 0.5));
    same(pauses.every((p, n) => n === 0 || p >= pauses[n - 1]), true);
    same(pauses[5], 4000);
});
await test('a stream that is opened again at once is watched for silence too', async () => {
    const real = globalThis.fetch, ends = [];
    globalThis.fetch = (path, { signal }) => new Promise((_, fail) => {
        ends.push(new Promise((done) => signal.addEventListener('abort', () => {
            done('aborted');
            fail(new Error('aborted'));
        })));
    });
    try {
        const feed = new Feed(() => {});
        feed.start('token');
        feed.stop();
        feed.start('token');
        same(await ends[0], 'aborted');
        let timer;
        const late = new Promise((done) => {
            timer = setTimeout(done, 6000, 'open for 6 s');
        });
        const was = await Promise.race([ends[1], late]);
        clearTimeout(timer);
        feed.stop();
        same(was, 'aborted');
    } finally {
        globalThis.fetch = real;
    }
});

const { Lease } = await page('lease');
const state = (holder, asked = null) => ({ holder: holder && { id: holder, name: 'Anna' },
                                         asked: asked && { id: asked, name: 'Ben' } });
await test('a lease is mine while the state names its id', () => {
    const lease = new Lease();
    same(lease.status(), 'free');
    lease.taken({ lease: 'secret', id: 'a' }, 0);
    same(lease.see(state(null), 30), null); // the state is older than the answer
    same(lease.see(state('a'), 60), null);
    same(lease.see(state('a'), 9000), null);
    same([lease.status(), lease.secret()], ['mine', 'secret']);
    same(lease.see(state('b'), 9030), 'lost');
    same([lease.status(), lease.secret()], ['other', null]);
});
await test('a lease is lost when nobody holds it, and when it never came', () => {
    const lease = new Lease();
    lease.taken({ lease: 'secret', id: 'a' }, 0);
    lease.see(state('a'), 10);
    same(lease.see(state(null), 20), 'lost');
    same(lease.status(), 'free');
    lease.taken({ lease: 'secret', id: 'a' }, 100);
    same(lease.see(state(null), 1900), null);
    same(lease.see(state(null), 2200), 'lost');
});
await test('who asked drives when it is given, and asks no more when it is denied', () => {
    const lease = new Lease();
    lease.see(state('a'), 0);
    same(lease.status(), 'other');
    lease.asked({ lease: 'mine', id: 'b' }, 10);
    same(lease.see(state('a', 'b'), 3000), null);
    same(lease.status(), 'asked');
    same(lease.see(state('b'), 3030), 'got');
    same([lease.status(), lease.secret()], ['mine', 'mine']);
    lease.see(state('c'), 3060);
    lease.asked({ lease: 'other', id: 'd' }, 4000);
    lease.see(state('c', 'd'), 4030);
    lease.see(state('c'), 7000);
    same(lease.status(), 'other');
});

const { Stopper, stopWords } = await page('stop');
const { translate, JA } = await page('text');
const t = (text, ...values) => translate('en', text, values);
await test('a stop is told in words, joint by joint', () => {
    const stop = { latched: true, kind: 'stop', trip: null, joint: null, by: 'Anna', confirmed: false,
                   joints: ['stopped', 'moving', 'sent'] };
    same(stopWords({ latched: false }, 0, [], t), null);
    same(stopWords(stop, 0, ['A', 'B', 'C'], t),
         { level: 'bad', text: 'Stopped by Anna: 1 of 3 joints stand; B moves' });
    const done = { ...stop, confirmed: true, joints: ['stopped', 'stopped', 'stopped'] };
    same(stopWords(done, 0, ['A', 'B', 'C'], t),
         { level: 'ok', text: 'Stopped by Anna: all 3 joints stand, read back' });
    same(stopWords(null, 1250, [], t).level, 'bad');
    same(stopWords(null, 1250, [], t).text.includes('1.3 s: use the switch'), true);
});
await test('a stop goes both ways, and again until it is acknowledged', async () => {
    const sent = [];
    let answer = null;
    const api = { stopPort: 1, aside: (path) => {
        sent.push(path);
        return new Promise(() => {});
    }, post: (path) => {
        sent.push(path);
        return answer ? Promise.resolve() : Promise.reject(new Error('lost'));
    } };
    const stopper = new Stopper(api, () => 'Anna', () => {});
    stopper.press();
    same(sent, ['/stop', '/api/stop']);
    await Promise.resolve();
    same(stopper.unanswered() >= 0 && !stopper.answered, true);
    answer = true;
    stopper.again();
    await new Promise((done) => setImmediate(done));
    same(sent.length, 4);
    same(stopper.answered, true);
    stopper.again();
    same(sent.length, 4);
    same(stopper.timer, null);
});

await test('a stop that is pressed again is repeated again, however long the server was away', () => {
    const sent = [], real = performance.now;
    let now = 0;
    performance.now = () => now;
    const stopper = new Stopper({ post: () => {
        sent.push(now);
        return Promise.reject(new Error('lost'));
    } }, () => 'Anna', () => {});
    try {
        stopper.press();
        now = 31000;
        stopper.again();
        same([stopper.timer, stopper.unanswered()], [null, 31000]);
        stopper.press();
        now += 250;
        stopper.again();
        same(sent, [0, 31000, 31250]);
        same(stopper.unanswered(), 31250); // of the first: nobody has heard any of them
    } finally {
        performance.now = real;
        clearInterval(stopper.timer);
    }
});

const { Ring, columns, ticks } = await page('plots');
await test('a ring keeps the newest, and a column its peaks', () => {
    const ring = new Ring(1, 8);
    for (let n = 0; n < 20; n++) {
        ring.push(n * 10, [n === 15 ? 99 : n]);
    }
    const seen = [];
    ring.each(0, 0, (time, value) => seen.push(value));
    same(seen, [12, 13, 14, 99, 16, 17, 18, 19]);
    const { low, high } = columns(ring, 0, 120, 200, 2);
    near([low[0], high[0], low[1], high[1]], [12, 99, 16, 19]);
});
await test('a value that is not known is a gap', () => {
    const ring = new Ring(1, 8);
    ring.push(0, [null]);
    ring.push(60, [5]);
    const { low } = columns(ring, 0, 0, 100, 2);
    same(Number.isNaN(low[0]), true);
    near(low[1], 5);
});
await test('ticks are round', () => {
    near(ticks(-50, 50, 4), [-50, 0, 50]);
    near(ticks(0, 1, 5), [0, 0.2, 0.4, 0.6, 0.8, 1], 1e-9);
});

const { sample } = await page('play');
await test('a pose between two samples is between them', () => {
    const frames = { rate_hz: 10, angle_deg: [[0, null], [90, 5], [180, 5]], root: null };
    near(sample(frames, 50, null).q[0], Math.PI / 4);
    same(Number.isNaN(sample(frames, 50, null).q[1]), true);
    near(sample(frames, 9999, null).q, [Math.PI, 5 * Math.PI / 180]);
});

const { Newest, takeToken } = await page('api');
await test('a browser that keeps nothing has the token of its link', () => {
    const kept = {};
    const storage = { setItem: (key, value) => {
        kept[key] = value;
    }, getItem: (key) => kept[key] ?? null };
    const open = (hash, sessionStorage) => {
        const made = { location: { hash, pathname: '/', search: '' }, sessionStorage,
                       history: { replaceState: (state, title, url) => {
                           made.location.hash = url;
                       } } };
        for (const name of Object.keys(made)) {
            Object.defineProperty(globalThis, name, { configurable: true, get: () => {
                if (made[name] === null) {
                    throw new Error('SecurityError');
                }
                return made[name];
            } });
        }
        return [takeToken(), made.location.hash];
    };
    same(open('#token=one', storage), ['one', '/']);
    same(open('', storage), ['one', '']);
    same(open('#token=two', null), ['two', '#token=two']);
    same(open('', null), [null, '']);
});
await test('of many targets the newest is sent, one at a time', async () => {
    const sent = [];
    let open = null;
    const newest = new Newest((value) => {
        sent.push(value);
        return new Promise((done) => {
            open = done;
        });
    });
    for (const value of [1, 2, 3, 4]) {
        newest.push(value);
    }
    same(sent, [1]);
    open();
    await new Promise((done) => setImmediate(done));
    same(sent, [1, 4]);
});

const { howIs, nearest, fleetStopWords, isWanted } = await page('fleet_words');
await test('a robot of a fleet is told by the worst that is known of it', () => {
    const is = (more) => { const { level, text } = howIs({ link: 'up', trip: null, stopped: false, moving: false,
                                                           play: 'idle', ...more }, (x) => x);
                           return `${level} ${text}`; };
    same(is({}), 'ok idle');
    same(is({ moving: true }), 'ok moves');
    same(is({ play: 'playing', moving: true }), 'ok playing');
    same(is({ stopped: true, play: 'playing' }), 'warn stopped');
    same(is({ stopped: true, moving: true }), 'warn stopping');
    same(is({ trip: 'over_current', stopped: true }), 'bad over_current');
    same(is({ link: 'silent', play: 'playing' }), 'bad no news');
    same(is({ link: 'broken', stopped: true }), 'bad agent lost');
    same(is({ link: 'away', trip: 'over_current' }), 'off signed off');
});

const { setupLines } = await page('joints');
await test('joints that are not set up are told by reason', () => {
    const name = (n) => ['pan', 'lift', 'grip'][n];
    const why = (n, message) => ({ joint: n, message, fix: 'do it' });
    const words = (text, ...values) => text.replace(/\{(\d)\}/g, (_, n) => values[n]);
    same(setupLines([why(0, 'no offset'), why(1, 'mode is 3'), why(2, 'no offset')], name, words),
         ['pan, grip: not set up: no offset; do it', 'lift: not set up: mode is 3; do it']);
    same(setupLines([], name, words), []);
});
await test('the joint nearest to a limit, as far as joints are known', () => {
    const joints = [{ name: 'a', limits_deg: [-90, 90] }, { name: 'b', limits_deg: [0, 100] },
                    { name: 'c', limits_deg: [null, null] }];
    same(nearest([0, 96, 5], joints), { name: 'b', left: 4 });
    same(nearest([-88, null, 5], joints), { name: 'a', left: 2 });
    same(nearest([null, null, null], joints), null);
    same(nearest([], joints), null);
});

await test('a stop of a fleet is told in words', () => {
    const t = (text, ...v) => text.replace(/\{(\d)\}/g, (_, n) => v[n]);
    const state = (stops, confirmed) => ({ latch: { kind: 'stop' }, confirmed, robots: stops.map((stop) => ({ stop })) });
    same(fleetStopWords(null, 0, t), null);
    same(fleetStopWords({ latch: null, robots: [] }, 0, t), null);
    same(fleetStopWords({ latch: null, robots: [] }, 300, t).level, 'warn');
    same(fleetStopWords(null, 1200, t), { level: 'bad', text: 'STOP sent, no answer for 1.2 s: use the switches' });
    same(fleetStopWords(state(['stopped', 'sent', 'away'], false), 0, t),
         { level: 'warn', text: 'Stopped: 1 of 2 robots stand' });
    same(fleetStopWords(state(['stopped', 'silent'], false), 0, t).level, 'bad');
    same(fleetStopWords(state(['stopped', 'moving'], false), 900, t).level, 'bad');
    same(fleetStopWords(state(['stopped', 'stopped', 'away'], true), 0, t),
         { level: 'ok', text: 'Stopped: all 2 robots stand' });
});

await test('a filter takes words, a group, and what is in trouble', () => {
    const robot = { host: 'Stage-1', robot: 'anna', motion: 'greet.pseq', trip: null };
    const facts = { model: 'GR001', groups: ['all', 'stage'] };
    const wanted = (want, level = 'ok') => isWanted(robot, facts, { text: '', group: '', trouble: false, ...want }, level);
    same([wanted({}), wanted({ text: 'ANN' }), wanted({ text: 'gr001  greet' }), wanted({ text: 'stage ben' })],
         [true, true, true, false]);
    same([wanted({ group: 'stage' }), wanted({ group: 'lab' })], [true, false]);
    same([wanted({ trouble: true }), wanted({ trouble: true }, 'bad'), wanted({ trouble: true }, 'off')],
         [false, true, false]);
});

const { Draft, compare, keysOfFrames, mirrorKey } = await page('make_draft');
const pair = [{ joint: 0, name: 'R', limits_deg: [-90, 10], init_deg: 0, mirror: 1, mirror_sign: -1 },
              { joint: 1, name: 'L', limits_deg: [-10, 90], init_deg: 0, mirror: 0, mirror_sign: -1 },
              { joint: 2, name: 'HEAD', limits_deg: [-45, 45], init_deg: 5, mirror: 2, mirror_sign: -1 }];
const filed = (time, angles, more = {}) => ({ time_ms: time, name: '', angle_deg: angles, stationary: [],
                                              links: [], zmp_m: null, max_transition_ms: 0, ...more });
const waist = { link: 'WAIST', p_m: [0, 0.1, 0.2], rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1], base: true,
                stationary: false, touching: false, slave: false };
const foot = { ...waist, link: 'R', base: false, rotation: [1, 2, 3, 4, 5, 6, 7, 8, 9] };
const draft = () => new Draft(pair, { name: 'a.pseq', etag: '"1"', keys: [
    filed(0, [1, 2.5, null]), filed(500, [-20, null, null], { links: [waist, foot], stationary: [0] }),
    filed(1000, [5, 6, 7], { name: 'end', zmp_m: [0.1, 0.2, 0] })] });

await test('of a draft only what differs from the file is written', () => {
    const d = draft();
    same(d.toEdit(), { keys: [{ from: 0 }, { from: 1 }, { from: 2 }] });
    d.setAngles(d.keys[0].id, { 0: -30, 2: 99 });
    d.setAngles(d.keys[2].id, { 1: null });
    d.setTime(d.keys[1].id, 700);
    d.setLinks(d.keys[1].id, [{ link: 'WAIST', p_m: [0, 0, 0.3], rotation: waist.rotation }]);
    same(d.toEdit().keys[0], { from: 0, angle_deg: { R: -30, HEAD: 45 } });
    same(d.toEdit().keys[1], { from: 1, time_ms: 700,
                               links: [{ ...waist, p_m: [0, 0, 0.3] }, { link: 'R' }] });
    same(d.toEdit().keys[2], { from: 2, angle_deg: { L: null } });
    d.add(300, [1, 2, 3]);
    same(d.toEdit().keys[1], { time_ms: 300, angle_deg: { R: 1, L: 2, HEAD: 3 } });
});
await test('a key in the mirror is left for right, and twice it is what it was', () => {
    const d = draft(), id = d.keys[1].id;
    d.mirror(id);
    same(d.key(id).angle_deg, [null, 20, null]);
    same(d.key(id).links.map((l) => l.link), ['WAIST', 'L']);
    same(d.key(id).links[0].p_m, [0, -0.1, 0.2]);
    same(d.key(id).links[1].rotation, [1, -2, 3, -4, 5, -6, 7, -8, 9]);
    same(d.key(id).stationary, [1]);
    same(d.toEdit().keys[1], { from: 1, mirror: true });
    d.setAngles(id, { 2: 4 });
    same(d.toEdit().keys[1], { from: 1, mirror: true, angle_deg: { HEAD: 4 } });
    same(mirrorKey(mirrorKey(d.base[1], pair), pair), d.base[1]);
    d.mirrorAll();
    same(d.toEdit().keys[1], { from: 1, angle_deg: { HEAD: -4 } });
});
await test('a drag is one step back, and what is undone is done again', () => {
    const d = draft(), id = d.keys[0].id, was = d.keys;
    for (const deg of [2, 3, 4]) {
        d.setAngles(id, { 0: deg }, 'drag');
    }
    d.rest();
    d.setAngles(id, { 0: 9 }, 'drag');
    same(d.before.length, 2);
    same(d.undo(), true);
    same(d.key(id).angle_deg[0], 4);
    d.undo();
    same(d.keys === was && !d.changed(), true);
    same(d.undo(), false);
    d.redo();
    same(d.key(id).angle_deg[0], 4);
    d.setAngles(id, { 0: 1 });
    same(d.redo(), false); // another way was taken
});
await test('what is done together is one step back', () => {
    const d = draft(), was = d.keys;
    d.together(() => {
        d.setAngles(d.add(300, [1, 2, 3]), { 0: 4 });
        d.setLinks(d.chosen, [waist]);
    });
    same([d.before.length, d.key().angle_deg[0]], [1, 4]);
    d.together(() => d.undo());
    same([d.keys === was, d.before.length], [true, 0]);
    d.together(() => d.redo());
    same([d.before.length, d.key().links.length], [1, 1]);
});
await test('keys keep their order and their distance', () => {
    const d = draft(), [a, b, c] = d.keys.map((k) => k.id);
    const times = () => d.keys.map((k) => k.time_ms);
    d.setTime(a, 600);
    same([times(), d.index(a)], [[500, 600, 1000], 1]);
    d.setTime(a, 1000); // taken: the next place
    same(times(), [500, 1000, 1010]);
    d.undo();
    d.undo();
    d.setTransition(b, 200);
    same(times(), [0, 200, 700]);
    d.setTransition(c, -50); // no key before the one before
    same(times(), [0, 200, 210]);
    d.paste(d.key(a), 200);
    same(times(), [0, 200, 700, 710]);
    for (let n = 0; n < 6; n++) {
        d.remove(d.chosen);
    }
    same(d.keys.length, 1); // one is left
});
await test('between keys that set a joint there is a straight line', () => {
    const d = draft();
    near(d.at(750), [-7.5, 2.5 + 3.5 * 0.75, 7]);
    near(new Draft(pair, { keys: [filed(0, [1, 2, null])] }).at(99), [1, 2, 5]);
});
await test('after saving, steps back refer to the file as it is', () => {
    const d = draft(), [a, b] = d.keys.map((k) => k.id);
    d.remove(b);
    d.setAngles(a, { 0: -7 });
    const written = d.keys;
    d.setAngles(a, { 0: -8 }); // while it was saved
    d.rebase({ name: 'b.pseq', etag: '"2"', keys: [filed(0, [-7, 2.5, null]), filed(1000, [5, 6, 7])] },
             written);
    same([d.name, d.etag, d.changed()], ['b.pseq', '"2"', true]);
    same(d.toEdit(), { keys: [{ from: 0, angle_deg: { R: -8 } }, { from: 1, name: 'end',
                                                                   zmp_m: [0.1, 0.2, 0] }] });
    d.undo();
    same([d.changed(), d.toEdit()], [false, { keys: [{ from: 0 }, { from: 1 }] }]);
    d.undo();
    d.undo(); // the key that was deleted, and is in the file no more
    same(d.toEdit().keys[1], { time_ms: 500, angle_deg: { R: -20 }, stationary: [0], links: [waist, foot] });
});
await test('frames become key poses, and motions are compared', () => {
    const frames = { rate_hz: 10, angle_deg: Array.from({ length: 11 }, (_, n) => [n, null, 0]) };
    same(keysOfFrames(frames, 1000, 400).map((k) => [k.time_ms, k.angle_deg[0]]), [[0, 0], [400, 4], [1000, 10]]);
    const other = { rate_hz: 10, angle_deg: Array.from({ length: 6 }, (_, n) => [n === 3 ? -1 : n, 5, 1]) };
    same(compare(frames, other).map((d) => [d.joint, d.most, d.at_ms]), [[0, -4, 300], [2, 1, 0]]);
    same(compare(frames, { rate_hz: 10, angle_deg: [] }), []);
});

await test('of frames a key names what is elsewhere than in the file', () => {
    const keys = [0, 200, 400].map((ms) => ({ time_ms: ms, angle_deg: [ms / 100, 1, null] }));
    const d = new Draft(pair, { name: 'a.yaml', etag: '"1"', keys }, true);
    const times = [{ time_ms: 0 }, { time_ms: 200 }, { time_ms: 400 }];
    same(d.toEdit(), { keys: times });
    d.setAngles(d.keys[1].id, { 1: 5 });
    same(d.toEdit().keys, [times[0], { time_ms: 200, angle_deg: { L: 5 } }, times[2]]);
    d.add(300, [3, 3, 0]); // as it is seen there
    same(d.toEdit().keys[2], { time_ms: 300 });
    d.setAngles(d.keys[2].id, { 0: 4 });
    same(d.toEdit().keys[2], { time_ms: 300, angle_deg: { R: 4 } });
    d.setTime(d.keys[2].id, 320); // what was seen was elsewhere
    same(d.toEdit().keys[2], { time_ms: 320, angle_deg: { R: 4, L: 3, HEAD: 0 } });
    same(d.toEdit(false).keys[1], { time_ms: 200, angle_deg: { R: 2, L: 5 } });
    d.rebase({ name: 'a.yaml', etag: '"2"', keys: d.keys }, d.keys);
    same(d.toEdit().keys.every((key) => !('angle_deg' in key)), true);
    d.undo();
    d.undo();
    same(d.toEdit().keys[2], { time_ms: 300, angle_deg: { R: 3, L: 3, HEAD: 0 } });
});

await test('every text of the page is there in Japanese', () => {
    const missing = new Set();
    for (const name of readdirSync(folder)) {
        const text = readFileSync(`${folder}/${name}`, 'utf8');
        const found = name.endsWith('.html')
            ? [...text.matchAll(/ data-t>([^<]+)</g), ...text.matchAll(/data-t-label="([^"]+)"/g)]
            : name === 'text.js' ? [] : [...text.matchAll(/\bt\(\s*'((?:[^'\\]|\\.)*)'/g)];
        for (const [, key] of found) {
            if (!(key in JA)) {
                missing.add(key);
            }
        }
    }
    same([...missing], []);
    for (const [key, value] of Object.entries(JA)) {
        same((key.match(/\{\d\}/g) || []).sort(), (value.match(/\{\d\}/g) || []).sort());
    }
});

await test('a motion that cannot be played has no picture, and says why', async () => {
    const { hasPoses, refusal, firstOf } = await page('play');
    const t = (text) => text;
    same([null, { angle_deg: [] }, { angle_deg: [[0]] }].map(hasPoses), [false, false, true]);
    same(refusal({ code: 'type', message: 'a.yaml: made for so101, not for GR001; choose that robot' }, t),
         '✕ for another robot, cannot be played: a.yaml: made for so101, not for GR001');
    same(refusal({ code: 'limit', message: 'a.m: 200 degrees; --clamp' }, t), '✕ a.m: 200 degrees; --clamp');
    const found = ['a', 'b', 'c', 'd'].map((message) => ({ message }));
    same([firstOf([]), firstOf(found.slice(0, 1)), firstOf(found)], ['', 'a', 'a; b; c; …']);
});

console.log(`1..${tests}`);
process.exit(failed ? 1 : 0);
