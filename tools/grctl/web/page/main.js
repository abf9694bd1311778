// SPDX-License-Identifier: MIT
// The cockpit: ties the views, the stream, the lease and STOP together. Everything is drawn from the
// newest state, in animation frames that are asked for when a state or a hand has come.

import { makeBody } from './body.js';
import { element, replace, setText, setting, valueText } from './dom.js';
import { Figure, fromHex, mix } from './figure.js';
import { Joints } from './joints.js';
import { Lease } from './lease.js';
import { Make } from './make.js';
import { DEG } from './mat.js';
import { Play } from './play.js';
import { See } from './see.js';
import { api, id, lang, stopper, t } from './start.js';
import { stopWords } from './stop.js';
import { openStream } from './stream.js';
import { TABS, showPanel } from './tabs.js';

const OLD_MS = 500;
const SETTLED_MS = 400;

class App {
    constructor() {
        this.api = api;
        this.lang = lang;
        this.stopper = stopper;
        this.t = t;
        this.lease = new Lease();
        this.state = null;
        this.arrived = 0;
        this.drawn = 0;
        this.selected = -1;
        this.look = setting('look') || 'torque';
        this.log = [];
        this.leaseAsks = false;
        this.toMatrix = ({ p_m: p, rotation: r }) => [r[0], r[3], r[6], 0, r[1], r[4], r[7], 0,
                                                      r[2], r[5], r[8], 0, p[0], p[1], p[2], 1];
        stopper.name = () => this.userName();
        stopper.changed = () => this.schedule();
        this.figure = new Figure(id('view'), {
            flat: new URLSearchParams(location.search).has('flat'),
            onPick: (joint) => this.select(joint === this.selected ? -1 : joint, true),
            onTouch: () => this.schedule(),
            onGrab: (x, y, touch) => this.make.active() ? this.make.hands.grab(x, y, touch) : null,
            above: id('look'), below: id('legend'),
        });
        this.see = new See(this);
        this.joints = new Joints(this);
        this.play = new Play(this);
        this.make = new Make(this);
        this.listen();
        this.setTheme(setting('theme') || '');
        this.showTab(document.body.dataset.tab);
    }

    async start() {
        openStream(this.api.token, (message) => this.take(message));
        setInterval(() => this.schedule(), 250); // what grows old must be seen to
        setInterval(() => this.beat(), 200);
        await this.loadRobot();
    }

    async loadRobot() {
        try {
            this.robot = await this.api.get('/api/robot');
        } catch (error) {
            this.fail(error);
            setTimeout(() => this.loadRobot(), 1500);
            return;
        }
        const { robot } = this;
        this.api.stopPort = robot.stop_port;
        document.title = `${robot.title} – grctl`;
        setText(id('robot'), robot.title);
        setText(id('device'), robot.simulator ? this.t('simulator') : robot.device);
        setText(id('about'), `grctl ${robot.version} · ${robot.title} · ${robot.family} · ${robot.device}`);
        const links = robot.links.map((l) => ({
            name: l.name, parent: l.parent, joint: l.joint, axis: l.axis, mass: l.mass_kg,
            com: l.com_m || [0, 0, 0], inertia: l.inertia_kgm2,
            frame: this.toMatrix({ p_m: l.origin_m, rotation: l.rotation }),
        }));
        const feet = (robot.body ? robot.body.feet : []).map((f) => ({
            link: f.link, sole: f.sole_m, half: f.half_m }));
        this.figure.setBody(makeBody(links, feet, robot.joints));
        this.see.setRobot(robot);
        this.joints.setRobot(robot);
        this.make.setRobot(robot);
        await this.play.refresh().catch((error) => this.fail(error));
        this.schedule();
    }

    name(joint) {
        return this.robot && this.robot.joints[joint] ? this.robot.joints[joint].name : '';
    }

    // ---- what comes from the server ------------------------------------------------------------

    take(message) {
        if (message.type === 'state') {
            this.takeState(message.data);
        } else if (message.type === 'event') {
            this.takeEvent(message.data);
        } else {
            this.takeLink(message);
        }
        this.schedule();
    }

    takeState(state) {
        const again = this.state && state.sequence < this.state.sequence;
        this.state = state;
        this.arrived = performance.now();
        this.stopper.see(state.stop);
        const changed = this.lease.see(state.lease, this.arrived);
        this.api.lease = this.lease.secret();
        if (changed) {
            this.say(this.t(changed === 'got' ? 'This page drives.'
                                              : 'This page does not drive any more.'), true);
        }
        if (again) { // another server: its robot may be another too
            this.loadRobot();
        }
        if (this.robot) {
            this.see.state(state);
        }
    }

    takeEvent(event) {
        this.log.unshift({ ...event, at: new Date() });
        this.log.length = Math.min(this.log.length, 200);
        this.logDirty = true;
        if (event.kind === 'file') {
            clearTimeout(this.fileTimer);
            this.fileTimer = setTimeout(() => this.play.refresh().catch(() => {}), 150);
        }
        if (event.kind !== 'stop' && (event.level === 'error' || event.level === 'warning')) {
            this.notice(event.message); // a stop is told beside STOP
        }
        if (['stop', 'trip', 'link', 'lease', 'play', 'fall'].includes(event.kind)) {
            this.say(event.message, ['stop', 'trip', 'fall'].includes(event.kind));
        }
    }

    takeLink({ type, wait }) {
        const up = type === 'up';
        if (this.connected && !up) {
            this.say(this.t('No connection to the server.'), true);
        }
        this.connected = up;
        this.retryAt = up ? null : performance.now() + wait;
    }

    /** How old the picture is, in ms; 0: fresh. */
    age() {
        const age = this.state ? performance.now() - this.arrived : 0;
        return age > OLD_MS ? age : 0;
    }

    // ---- what goes to the server ---------------------------------------------------------------

    userName() {
        const kept = setting('name');
        if (kept) {
            return kept;
        }
        const phone = matchMedia('(pointer: coarse)').matches;
        this.ownName = this.ownName ||
            `${this.t(phone ? 'Phone' : 'Computer')} ${Math.floor(10 + Math.random() * 90)}`;
        return this.ownName;
    }

    onLost() {
        return id('on-lost').value;
    }

    /** @param based whether the server is to know which state this page had drawn */
    async command(path, body = {}, based = false) {
        try {
            return await this.api.post(path, based ? { ...body, sequence: this.drawn } : body);
        } catch (error) {
            this.fail(error);
            return null;
        }
    }

    fail(error) {
        console.error(`${error.code || error.name}: ${error.message}`);
        this.notice(error.message);
        this.schedule();
    }

    notice(text) {
        setText(id('notice'), text);
        id('notice').hidden = false;
        clearTimeout(this.noticeTimer);
        this.noticeTimer = setTimeout(() => {
            id('notice').hidden = true;
        }, 6000);
    }

    say(text, now) {
        setText(id(now ? 'live-now' : 'live'), text);
    }

    mayMove() {
        return this.lease.status() === 'mine' && !this.age() && this.state !== null &&
               !this.state.stop.latched && this.state.link === 'up';
    }

    /** Why nothing can be moved from here, in words; null: it can. */
    whyNot() {
        if (this.mayMove() || !this.state) {
            return null;
        }
        if (this.age() || this.state.link !== 'up') {
            return this.t('No fresh news of the robot.');
        }
        if (this.state.stop.latched) {
            return this.t('A stop is latched: release it first.');
        }
        return this.t('Take control to move the robot.');
    }

    /** Does what the button says; that may be older than what is known by now. */
    async leaseButton() {
        if (id('lease').ariaDisabled !== 'false') {
            return;
        }
        id('lease').ariaDisabled = 'true'; // until it is drawn again
        this.leaseAsks = true;
        const name = this.userName(), { says } = this.leaseSays;
        try {
            if (says === 'give') {
                this.giveBack();
            } else if (says === 'ask') {
                this.lease.asked(await this.api.post('/api/lease', { action: 'ask', name }),
                                 performance.now());
            } else {
                const ask = this.lease.ask ? { lease: this.lease.ask.lease } : {};
                this.lease.taken(await this.api.post('/api/lease', { action: 'take', name, ...ask }),
                                 performance.now());
                this.api.lease = this.lease.secret();
                this.beat();
                this.say(this.t('This page drives.'));
            }
        } catch (error) {
            this.fail(error);
        }
        this.leaseAsks = false;
        this.schedule();
    }

    giveBack(leaving) {
        if (this.lease.mine) {
            this.joints.cancel();
            const body = { action: 'give', lease: this.lease.secret() };
            if (leaving) {
                this.api.beacon('/api/lease', body);
            } else {
                this.command('/api/lease', body);
            }
            this.lease.given();
            this.api.lease = null;
        }
    }

    /** 5 times a second, with what was drawn last: a page that draws nothing is lost too. */
    beat() {
        if (this.lease.mine && this.api.stopPort) {
            this.api.aside('/heartbeat', { lease: this.lease.secret(), drawn: this.drawn }).catch(() => {});
        }
    }

    // ---- hands ---------------------------------------------------------------------------------

    listen() {
        document.addEventListener('keydown', (event) => event.key === 'Escape' || this.onKey(event), true);
        id('reset').addEventListener('click', () => this.command('/api/reset', {}, true));
        id('lease').addEventListener('click', () => this.leaseButton());
        id('lease-keep').addEventListener('click', () => this.command('/api/lease', { action: 'deny' }));
        id('home').addEventListener('click', () => this.figure.home());
        for (const button of document.querySelectorAll('[data-look]')) {
            button.addEventListener('click', () => {
                this.look = setting('look', button.dataset.look) || button.dataset.look;
                this.schedule();
            });
        }
        TABS.forEach((tab) => id(`tab-${tab}`).addEventListener('click', () => this.showTab(tab)));
        id('tabs').addEventListener('keydown', (event) => {
            const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
            if (step) {
                const n = (TABS.indexOf(document.body.dataset.tab) + step + TABS.length) % TABS.length;
                this.showTab(TABS[n]);
                id(`tab-${TABS[n]}`).focus();
            }
        });
        document.addEventListener('visibilitychange', () => document.hidden && this.giveBack(true));
        addEventListener('pagehide', () => this.giveBack(true));
        this.listenSettings();
        const narrow = matchMedia('(max-width: 820px)');
        const move = () => (narrow.matches ? id('motions').prepend : id('stage').append).call(
            narrow.matches ? id('motions') : id('stage'), id('transport'));
        narrow.addEventListener('change', move);
        move();
    }

    listenSettings() {
        id('name').value = this.userName();
        id('name').addEventListener('change', () => setting('name', id('name').value.trim()));
        id('lang').value = this.lang;
        id('lang').addEventListener('change', () => {
            setting('lang', id('lang').value);
            location.reload();
        });
        id('theme').value = setting('theme') || '';
        id('theme').addEventListener('change', () => this.setTheme(setting('theme', id('theme').value)
                                                                   || id('theme').value));
        matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.setTheme(
            id('theme').value));
        id('on-lost').value = setting('on-lost') || 'stop';
        id('on-lost').addEventListener('change', () => setting('on-lost', id('on-lost').value));
    }

    onKey(event) {
        const typing = event.target.matches('input:not([type=range]):not([type=checkbox]), select');
        if (this.make.onKey(event) || typing || event.ctrlKey || event.metaKey || event.altKey) {
            return;
        }
        if (event.key === ' ' && !event.target.matches('button, input, summary')) {
            event.preventDefault();
            this.play.space();
        } else if (event.key >= '1' && event.key <= String(TABS.length)) {
            this.showTab(TABS[event.key - 1]);
        }
    }

    showTab(tab) {
        showPanel(tab);
        this.see.plots.dirty = true;
        this.play.paint();
        this.schedule();
    }

    /** @param show whether the joint's row is to be brought into view */
    select(joint, show) {
        this.selected = joint;
        this.figure.select(joint);
        this.joints.select(joint);
        if (joint >= 0 && this.see.plots.chosen.length === 0) {
            this.see.toggle(joint, true);
        }
        if (show && joint >= 0 && document.body.dataset.tab === 'see') {
            this.see.toggle(joint, true);
        }
        if (show && joint >= 0 && document.body.dataset.tab === 'joints') {
            this.joints.rows[joint].line.scrollIntoView({ block: 'nearest' });
        }
        if (show && joint >= 0 && document.body.dataset.tab === 'make') {
            this.make.rows.reveal(joint);
        }
        this.schedule();
    }

    // ---- theme ---------------------------------------------------------------------------------

    setTheme(name) {
        document.documentElement.dataset.theme = name;
        const style = getComputedStyle(document.documentElement);
        const names = ['text', 'quiet', 'grid', 'danger', 'good', 'warn', 'accent', 'part', 'faded',
                       'ghost', 'com', 'zmp', 'on', 'off', 'brake', 'cold', 'card'];
        /** @type {any} */
        this.css = Object.fromEntries(names.map((n) => [n, style.getPropertyValue(`--${n}`).trim()]));
        this.css.series = [0, 1, 2, 3, 4, 5].map((n) => style.getPropertyValue(`--series${n}`).trim());
        const dark = style.getPropertyValue('--dark').trim() === '1';
        this.themeName = dark ? 'dark' : 'light';
        this.figure.setTheme({ ...Object.fromEntries(names.map((n) => [n, fromHex(this.css[n])])),
                               shadow: [0, 0, 0, dark ? 0.34 : 0.13] });
        this.see.plots.setTheme(this.css);
        this.play.paint();
        this.play.stripKey = null;
        this.schedule();
    }

    // ---- drawing -------------------------------------------------------------------------------

    schedule() {
        if (!this.waiting) {
            this.waiting = true;
            requestAnimationFrame((now) => {
                this.waiting = false;
                this.draw(now);
            });
        }
    }

    draw(now) {
        this.drawTop();
        this.drawStop();
        if (this.state && this.robot) {
            const draft = this.make.active();
            this.figure.setPose(draft ? this.make.figurePose() : this.pose(),
                                draft ? this.make.film()
                                      : this.play.ghost(this.toMatrix) || this.target());
            this.figure.draw();
            this.play.draw(now);
            this.make.draw(now);
            if (document.body.dataset.tab === 'see') {
                this.see.draw(this.state, now);
            } else if (document.body.dataset.tab === 'joints') {
                this.joints.draw(this.state, now);
            }
            this.drawn = this.state.sequence;
        }
        if (this.logDirty && document.body.dataset.tab === 'more') {
            this.drawLog();
        }
    }

    target() {
        return { q: this.state.target_deg.map((v) => v === null ? NaN : v * DEG) };
    }

    pose() {
        const { state } = this, body = state.body;
        return {
            q: state.angle_deg.map((v) => v === null ? NaN : v * DEG),
            root: body ? this.toMatrix(body.root) : null,
            faded: this.age() > 0 || state.link !== 'up',
            looks: this.robot.joints.map((joint, n) => this.jointLook(joint, n)),
            balance: body && {
                com: body.com_m, zmp: body.zmp_m, support: body.support_m,
                inside: body.margin_m === null || body.margin_m >= 0,
                soles: body.soles.map((s) => ({ corners: s.corners_m, standing: s.standing })),
            },
        };
    }

    /** 'bad', 'warn' or '': how hot a servo is, measured by what the engine stops at. */
    heatLevel(heat) {
        const limit = this.robot.safety.temperature_c || 70;
        return heat === null || heat < limit - 15 ? '' : heat < limit - 5 ? 'warn' : 'bad';
    }

    jointLook(joint, n) {
        const { state } = this, theme = this.figure.theme, angle = state.angle_deg[n];
        const base = { name: joint.name, limits: joint.limits_deg, target: state.target_deg[n],
                       shape: state.torque[n], level: '', note: '', tint: 0, colour: theme.faded,
                       text: angle === null ? '–' : valueText(joint, angle),
                       unknown: angle === null || state.age_ms[n] > 2 * OLD_MS };
        const heat = state.temperature_c[n], hot = this.heatLevel(heat);
        if (hot) {
            Object.assign(base, { level: hot, note: `${heat} °C` });
        }
        if (state.limp.includes(n)) {
            base.note = this.t('limp');
        }
        if (this.look === 'torque') {
            base.colour = theme[state.torque[n]] || theme.faded;
            base.tint = state.torque[n] === 'on' ? 0.06 : 0.3;
            const without = state.torque.filter((v) => v !== 'on').length;
            if (state.torque[n] && state.torque[n] !== 'on' && without <= 6 && !base.note) {
                base.note = this.t(state.torque[n]);
            }
        } else if (this.look === 'heat' && heat !== null) {
            const k = Math.max(0, Math.min(1, (heat - 25) / ((this.robot.safety.temperature_c || 70) - 25)));
            base.colour = this.ramp(k);
            base.tint = 0.65;
        } else if (this.look === 'load' && state.current_ma[n] !== null) {
            const most = this.robot.safety.current_ma || 800, ma = state.current_ma[n];
            base.colour = this.ramp(Math.min(1, Math.abs(ma) / most));
            base.tint = 0.65;
            base.note = Math.abs(ma) > most * 0.7 ? `${ma} mA` : base.note;
        } else if (this.look === 'limit' && angle !== null) {
            this.limitLook(base, joint, angle, theme);
        }
        return base;
    }

    limitLook(base, joint, angle, theme) {
        const left = joint.wheel ? Infinity : Math.min(angle - joint.limits_deg[0], joint.limits_deg[1] - angle);
        base.colour = left < 3 ? theme.danger : left < 12 ? theme.warn : theme.good;
        base.tint = left < 12 ? 0.6 : 0.25;
        if (left < 12) {
            base.level = left < 3 ? 'bad' : 'warn';
            base.note = left < 0 ? this.t('{0}° beyond', (-left).toFixed(0))
                                 : this.t('{0}° left', left.toFixed(0));
        }
    }

    /** Cold to hot, of growing brightness in the dark and growing depth in the light. */
    ramp(k) {
        const { cold, warn, danger } = this.figure.theme;
        return k < 0.6 ? mix(cold, warn, k / 0.6) : mix(warn, danger, (k - 0.6) / 0.4);
    }

    drawTop() {
        const age = this.age(), state = this.state, link = id('link');
        const words = !state ? this.t('connecting …')
            : age ? this.t('no news for {0} s', (age / 1000).toFixed(1))
            : state.link === 'lost' ? this.t('robot lost') : state.link === 'opening'
            ? this.t('opening the line …') : this.t('live');
        const level = !state || state.link === 'opening' ? 'warn' : age || state.link === 'lost' ? 'bad' : 'ok';
        setText(link.lastElementChild, words);
        link.className = `pill ${level}`;
        document.body.classList.toggle('stale', age > 0);
        setText(id('stale'), age ? words : '');
        for (const button of document.querySelectorAll('[data-look]')) {
            button.setAttribute('aria-pressed', String(button.dataset.look === this.look));
        }
        this.drawDriver();
        if (state && this.robot) {
            this.drawLegend(state);
        }
    }

    drawDriver() {
        const t = this.t, lease = this.lease, status = lease.status(), button = id('lease');
        const holder = lease.holder && lease.holder.name;
        let words = status === 'mine' ? t('You drive') : holder ? t('{0} drives', holder)
            : t('Nobody drives');
        let action = { mine: t('Give back'), free: t('Take control'), other: t('Ask for control'),
                       asked: t('Asked …') }[status];
        let ready = status === 'mine' || Boolean(this.state) && !this.age();
        const askMs = this.robot ? this.robot.lease.ask_ms : 10000;
        if (status === 'asked') {
            const left = askMs + 300 - (performance.now() - lease.ask.at); // clocks differ a little
            ready = ready && left <= 0;
            action = left > 0 ? t('Asked, {0} s', Math.ceil(left / 1000)) : t('Take over');
        }
        const asker = status === 'mine' && lease.asker ? lease.asker.name : null;
        if (asker) {
            words = t('{0} asks to drive', asker);
            action = t('Give it');
        }
        if (!this.api.token) {
            words = holder ? t('{0} drives', holder) : t('watching');
            action = t('Take control');
            ready = false;
            button.title = t('To drive, open the link that grctl serve printed.');
        }
        setText(id('driver'), words);
        setText(button, action);
        button.ariaDisabled = String(!this.settled(status) || !ready || this.leaseAsks);
        button.classList.toggle('strong', status !== 'mine' || Boolean(asker));
        id('lease-keep').hidden = !asker;
        setText(id('lease-keep'), t('Keep it'));
        document.body.classList.toggle('driving', status === 'mine');
    }

    /** Whether the button has said the same for a while: news may change it under a finger. */
    settled(status) {
        const now = performance.now();
        const says = { mine: 'give', free: 'take', other: 'ask', asked: 'over' }[status];
        if (!this.leaseSays || this.leaseSays.says !== says) {
            this.leaseSays = { says, since: now };
        }
        return now - this.leaseSays.since >= SETTLED_MS;
    }

    drawLegend(state) {
        const t = this.t, item = (cls, words) => element('span', {}, element('i', { className: cls }),
                                                         words);
        const n = (kind) => state.torque.filter((v) => v === kind).length;
        if (this.make.active()) {
            replace(id('legend'), ...this.make.legend(item));
            return;
        }
        const max = this.robot.safety.temperature_c || 70, most = this.robot.safety.current_ma || 800;
        const scales = {
            torque: [item('dot on', `${t('on')} ${n('on')}`), item('ring', `${t('off')} ${n('off')}`),
                     ...n('brake') ? [item('half', `${t('brake')} ${n('brake')}`)] : []],
            heat: [item('ramp', `25 – ${max} °C`)],
            load: [item('ramp', `0 – ${most} mA`)],
            limit: [item('dot good', t('free')), item('tri', t('less than 12° left')),
                    item('cross', t('less than 3° left'))],
        };
        const body = state.body ? [item('target', t('centre of mass')),
                                   ...state.body.zmp_m ? [item('x', 'ZMP')] : [],
                                   item('area', t('support'))] : [];
        replace(id('legend'), ...scales[this.look], ...body, item('film', t('target')));
    }

    drawStop() {
        const t = this.t, stop = this.state && this.state.stop;
        const words = stopWords(stop, this.stopper.unanswered(),
                                this.robot ? this.robot.joints.map((j) => j.name) : [], t);
        id('stopped').hidden = !words;
        document.body.classList.toggle('stopped', Boolean(words));
        if (words) {
            setText(id('stop-words'), words.text);
            id('stopped').className = words.level;
        }
        const joints = stop && stop.latched && this.robot && !stop.confirmed ? stop.joints : [];
        replace(id('stop-joints'), ...joints.map((what, n) => element('li', { className: what },
            `${{ stopped: '✓', limp: '✓', moving: '▲', silent: '✕', sent: '…' }[what]} ` +
            `${this.name(n)} ${t(what)}`)));
        id('reset').hidden = !(stop && stop.latched);
        id('reset').disabled = !this.api.token || this.age() > 0;
        if (stop && stop.confirmed && !this.confirmed) {
            this.say(words.text, true);
        }
        this.confirmed = Boolean(stop && stop.confirmed);
    }

    drawLog() {
        this.logDirty = false;
        id('log').replaceChildren(...this.log.map((event) => element('li', { className: event.level },
            element('time', {}, event.at.toLocaleTimeString(this.lang)), ' ',
            { info: '·', warning: '▲', error: '✕' }[event.level] || '·', ' ', event.message)));
    }
}

self.cockpit = new App(); // for tests, and for the curious
self.cockpit.start();
