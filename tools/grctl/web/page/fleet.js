// SPDX-License-Identifier: MIT
// The view of a fleet (docs/serve.md): a card for each robot, a stop for all of them, one robot in
// full. It moves none. Drawn from the newest state, as the cockpit is.

import { element, limitValues, replace, setText, setting, unitOf, valueOf } from './dom.js';
import { NEAR_DEG, fleetStopWords, howIs, isWanted, nearest } from './fleet_words.js';
import { api, id, lang, stopper, t } from './start.js';
import { count } from './stop.js';
import { openStream } from './stream.js';

const OLD_MS = 1000;
const degrees = (value, digits = 0) => typeof value === 'number' ? value.toFixed(digits).replace('-', '−') : '–';
const keyOf = ({ host, robot }) => `${host}/${robot}`;

const NOTHING = { model: '', groups: [], joints: [], cockpit: null };

class Card {
    constructor(view, robot) {
        this.view = view;
        this.name = element('b', { textContent: robot.robot });
        this.is = element('span', { className: 'is' });
        this.where = element('small');
        this.canvas = element('canvas');
        this.canvas.setAttribute('role', 'img');
        this.plays = element('small');
        this.figures = element('small', { className: 'figures' });
        this.button = element('button', { type: 'button' },
            element('span', { className: 'line' }, this.name, this.is), this.where, this.canvas,
            element('span', { className: 'line' }, this.plays, this.figures));
        this.button.addEventListener('click', () => view.choose(view.chosen === keyOf(robot) ? null : keyOf(robot)));
        this.item = element('li', {}, this.button);
    }

    draw(robot, facts) {
        const { view } = this, { t } = view, is = howIs(robot, t);
        const old = robot.link !== 'up';
        this.button.className = `robot ${is.level}${old ? ' old' : ''}`;
        this.button.setAttribute('aria-pressed', String(view.chosen === keyOf(robot)));
        setText(this.is, `${{ ok: '●', warn: '▲', bad: '✕', off: '○' }[is.level]} ${is.text}`);
        setText(this.where, [robot.host, facts.model].filter(Boolean).join(' · '));
        setText(this.plays, robot.motion || '–');
        setText(this.figures, [robot.temperature_c === null ? null : `${Math.round(robot.temperature_c)} °C`,
                               robot.voltage_v === null ? null : `${robot.voltage_v.toFixed(1)} V`]
            .filter(Boolean).join(' · '));
        this.item.hidden = !isWanted(robot, facts, view.want(), is.level);
        if (!this.item.hidden) {
            this.bars(robot.angle_deg, facts.joints);
        }
    }

    /** A track for each joint from limit to limit, and where it is on it. */
    bars(angles, joints) {
        const { canvas, view } = this, ratio = devicePixelRatio || 1;
        const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
        const key = `${width} ${view.themeName} ${joints.length} ${angles.join()}`;
        if (key === this.key || width === 0) {
            return;
        }
        this.key = key;
        canvas.width = width;
        canvas.height = height;
        const to = canvas.getContext('2d'), step = Math.min(width / Math.max(1, joints.length), 14 * ratio);
        const near = nearest(angles, joints), { t, css } = view;
        joints.forEach((joint, n) => {
            const [min, max] = joint.limits_deg, x = (n + 0.5) * step, pad = 4 * ratio;
            to.fillStyle = css.grid;
            to.fillRect(x - ratio, pad, 2 * ratio, height - 2 * pad);
            const k = (angles[n] - min) / (max - min);
            if (typeof angles[n] === 'number' && Number.isFinite(k)) {
                const left = Math.min(angles[n] - min, max - angles[n]), tight = left < NEAR_DEG;
                const size = (tight ? 4 : 3) * ratio, y = height - pad - Math.max(0, Math.min(1, k)) * (height - 2 * pad);
                to.fillStyle = tight ? css.warn : css.accent;
                to.fillRect(x - size, y - (tight ? 3 : 2) * ratio, 2 * size, (tight ? 6 : 4) * ratio);
            }
        });
        canvas.setAttribute('aria-label', near
            ? t('{0} joints, {1} is the nearest to a limit: {2}°', joints.length, near.name, near.left.toFixed(0))
            : t('{0} joints, not read', joints.length));
    }
}

class View {
    constructor() {
        this.api = api;
        this.lang = lang;
        this.stopper = stopper;
        this.t = t;
        stopper.changed = () => this.schedule();
        this.state = null;
        this.arrived = 0;
        this.drawn = 0;
        this.facts = new Map();
        this.news = -1;
        this.cards = new Map();
        this.chosen = null;
        this.log = [];
        this.setTheme();
        this.listen();
    }

    start() {
        openStream(this.api.token, (message) => this.take(message));
        setInterval(() => this.schedule(), 250);
        this.loading = true;
        this.load();
    }

    async load() {
        try {
            const fleet = await this.api.get('/api/fleet');
            this.api.stopPort = fleet.stop_port;
            this.news = fleet.news;
            this.fleet = fleet;
            document.title = `${this.t('Fleet')} ${fleet.group} – grctl`;
            setText(id('place'), `${fleet.broker} · ${fleet.group}`);
            this.facts = new Map(fleet.hosts.flatMap((host) => host.robots.map((robot) => [
                `${host.host}/${robot.name}`, { ...robot, groups: host.groups }])));
            this.drawGroups(fleet);
        } catch (error) {
            this.fail(error);
            setTimeout(() => this.load(), 1500);
            return; // each state that comes meanwhile would begin another such row
        }
        this.loading = false;
        this.schedule();
    }

    take({ type, data }) {
        if (type === 'state') {
            this.state = data;
            this.arrived = performance.now();
            this.stopper.see({ latched: data.latch !== null });
            if (data.news !== this.news && !this.loading) {
                this.loading = true;
                this.load();
            }
        } else if (type === 'event') {
            this.log.unshift({ ...data, at: new Date() });
            this.log.length = Math.min(this.log.length, 500);
            if (data.level !== 'info') {
                this.notice(data.message);
            }
            setText(id(data.kind === 'stop' ? 'live-now' : 'live'), data.message);
        }
        this.schedule();
    }

    age() {
        const age = this.state ? performance.now() - this.arrived : 0;
        return age > OLD_MS ? age : 0;
    }

    fail(error) {
        console.error(`${error.code || error.name}: ${error.message}`);
        this.notice(error.message);
    }

    notice(text) {
        setText(id('notice'), text);
        id('notice').hidden = false;
        clearTimeout(this.noticeTimer);
        this.noticeTimer = setTimeout(() => {
            id('notice').hidden = true;
        }, 6000);
    }

    want() {
        return { text: id('text').value.trim(), group: id('group').value, trouble: id('trouble').checked };
    }

    choose(key) {
        const before = this.chosen;
        this.chosen = key;
        document.body.classList.toggle('chosen', key !== null);
        id('one').hidden = key === null;
        this.schedule();
        if (key !== null) {
            id('one').focus({ preventScroll: true });
        } else if (this.cards.has(before)) {
            this.cards.get(before).button.focus({ preventScroll: true });
        }
    }

    listen() {
        id('reset').addEventListener('click', () => this.api.post('/api/reset', { name: this.stopper.name(), sequence: this.drawn })
            .catch((error) => this.fail(error)));
        id('close').addEventListener('click', () => this.choose(null));
        for (const [name, kind] of [['text', 'input'], ['group', 'change'], ['trouble', 'change']]) {
            id(name).addEventListener(kind, () => this.schedule());
        }
        id('text').placeholder = this.t('Name, host, model or motion');
        matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.setTheme());
        addEventListener('resize', () => this.schedule());
    }

    setTheme() {
        document.documentElement.dataset.theme = setting('theme') || '';
        const style = getComputedStyle(document.documentElement);
        this.css = Object.fromEntries(['grid', 'accent', 'warn'].map(
            (n) => [n, style.getPropertyValue(`--${n}`).trim()]));
        this.themeName = style.getPropertyValue('--page');
        this.schedule();
    }

    // ---- drawing -------------------------------------------------------------------------------

    schedule() {
        if (!this.waiting) {
            this.waiting = true;
            requestAnimationFrame(() => {
                this.waiting = false;
                this.draw();
            });
        }
    }

    draw() {
        this.drawTop();
        this.drawStop();
        if (this.state) {
            this.drawCards();
            this.drawOne();
            this.drawn = this.state.sequence;
        }
    }

    drawTop() {
        const { t, state } = this, age = this.age(), link = id('link');
        const words = !state ? t('connecting …') : age ? t('no news for {0} s', (age / 1000).toFixed(1))
            : state.broker ? t('live') : t('broker lost');
        setText(link.lastElementChild, words);
        link.className = `pill ${!state ? 'warn' : age || !state.broker ? 'bad' : 'ok'}`;
        document.body.classList.toggle('stale', age > 0 || Boolean(state) && !state.broker);
    }

    drawGroups(fleet) {
        const names = [...new Set(fleet.hosts.flatMap((host) => host.groups))].sort(), was = id('group').value;
        replace(id('group'), element('option', { value: '', textContent: this.t('every group') }),
                ...names.map((name) => element('option', { value: name, textContent: name })));
        id('group').value = names.includes(was) ? was : '';
    }

    drawCards() {
        const { t, state } = this;
        const robots = [...state.robots].sort((a, b) => keyOf(a).localeCompare(keyOf(b), 'en', { numeric: true }));
        const keys = new Set(robots.map(keyOf));
        for (const [key, card] of this.cards) {
            if (!keys.has(key)) {
                card.item.remove();
                this.cards.delete(key);
            }
        }
        robots.forEach((robot, n) => {
            const key = keyOf(robot);
            if (!this.cards.has(key)) {
                this.cards.set(key, new Card(this, robot));
            }
            const { item } = this.cards.get(key), list = id('robots');
            if (list.children[n] !== item) {
                list.insertBefore(item, list.children[n] || null);
            }
            this.cards.get(key).draw(robot, this.facts.get(key) || NOTHING);
        });
        const levels = count(robots.map((robot) => howIs(robot, t).level));
        const shown = robots.filter((robot) => !this.cards.get(keyOf(robot)).item.hidden).length;
        setText(id('counts'), [t('{0} robots', robots.length), levels.bad ? `✕ ${levels.bad}` : '',
                               levels.warn ? `▲ ${levels.warn}` : ''].filter(Boolean).join('  '));
        id('none').hidden = shown > 0;
        setText(id('none'), robots.length ? t('No robot is like that.') : t('No agent is at this broker.'));
    }

    drawOne() {
        const { t } = this, robot = this.state.robots.find((r) => keyOf(r) === this.chosen);
        if (this.chosen === null || !robot) {
            return;
        }
        const facts = this.facts.get(this.chosen) || NOTHING, is = howIs(robot, t);
        setText(id('one-name'), `${robot.robot} · ${robot.host}`);
        const link = id('one-cockpit').firstElementChild;
        id('one-cockpit').hidden = !facts.cockpit;
        if (facts.cockpit && link.getAttribute('href') !== facts.cockpit) {
            link.href = facts.cockpit;
        }
        const line = (name, value, level = '') => [element('dt', {}, name), element('dd', { className: level }, value)];
        replace(id('one-facts'),
            ...line(t('State'), is.text, is.level), ...line(t('Model'), facts.model || '–'),
            ...line(t('Groups'), facts.groups.join(', ')), ...line(t('Motion'), robot.motion || '–'),
            ...line(t('Heard'), robot.age_ms === null ? t('never')
                : robot.age_ms < 1000 ? t('now') : t('{0} s ago', (robot.age_ms / 1000).toFixed(0))),
            ...line(t('Hottest'), robot.temperature_c === null ? '–' : `${Math.round(robot.temperature_c)} °C`),
            ...line(t('Supply'), robot.voltage_v === null ? '–' : `${robot.voltage_v.toFixed(2)} V`));
        replace(id('one-joints').tBodies[0], ...facts.joints.map((joint, n) => {
            const angle = robot.angle_deg[n], [min, max] = joint.limits_deg;
            const left = min < max ? Math.min(angle - min, max - angle) : Infinity; // else a wheel
            return element('tr', {}, element('th', { scope: 'row' }, joint.name || ''),
                element('td', { className: `num${typeof angle === 'number' && left < NEAR_DEG ? ' warn' : ''}` },
                    typeof angle === 'number' ? `${degrees(valueOf(joint, angle), 1)}${unitOf(joint)}` : '–'),
                element('td', { className: 'quiet' },
                        `${limitValues(joint).map((v) => degrees(v)).join(' … ')}${unitOf(joint)}`));
        }));
        replace(id('log'), ...this.log.filter((e) => e.host === robot.host && (!e.robot || e.robot === robot.robot))
            .slice(0, 30).map((event) => element('li', { className: event.level },
                element('time', {}, event.at.toLocaleTimeString(this.lang)), ' ', event.message)));
    }

    drawStop() {
        const { t, state } = this, words = fleetStopWords(state, this.stopper.unanswered(), t);
        id('stopped').hidden = !words;
        document.body.classList.toggle('stopped', Boolean(words));
        if (words) {
            setText(id('stop-words'), words.text);
            id('stopped').className = words.level;
        }
        const latched = Boolean(state && state.latch);
        const open = latched && !state.confirmed ? state.robots.filter((r) => r.stop !== 'stopped' && r.stop !== 'away') : [];
        replace(id('stop-joints'), ...open.slice(0, 24).map((r) => element('li', { className: r.stop },
            `${{ moving: '▲', silent: '✕', sent: '…' }[r.stop] || ''} ${keyOf(r)} ${t(
                r.stop === 'silent' ? 'use its switch' : r.stop)}`)),
            ...open.length > 24 ? [element('li', {}, `+ ${open.length - 24}`)] : []);
        id('reset').hidden = !latched;
        id('reset').disabled = !this.api.token || this.age() > 0;
    }
}

self.cockpit = new View(); // for tests, and for the curious
self.cockpit.start();
