// SPDX-License-Identifier: MIT
// The table of joints. The chosen joint has a slider: its ends are the joint's limits, and the robot
// follows while it is dragged, if this page drives.

import { Newest } from './api.js';
import { ask, degreesOf, element, limitValues, replace, setText, stepByKeys, tremble, unitOf, valueOf,
         valueText } from './dom.js';

/** Joints that do not move as their servos are set up: a line for each reason, with its joints. */
export function setupLines(setup, name, t) {
    const joints = new Map();
    for (const { joint, message, fix } of setup) {
        const why = `${message}; ${fix}`;
        joints.set(why, [...joints.get(why) || [], name(joint)]);
    }
    return [...joints].map(([why, names]) => t('{0}: not set up: {1}', names.join(', '), why));
}

const SIGNS = { on: '●', off: '○', brake: '◐' };

export class Joints {
    constructor(app) {
        this.app = app;
        this.body = document.querySelector('#joints tbody');
        this.drawnAt = 0;
        this.newest = new Newest((target) => app.command('/api/jog', target));
        this.speeds = new Newest((speed) => app.command('/api/drive',
                                                        { ...speed, sequence: app.drawn }));
        const all = (id, what) => document.getElementById(id).addEventListener('click', what);
        all('stand', () => app.command('/api/move', { pose: 'init', time_ms: 3000 }, true));
        all('torque-on', () => app.command('/api/torque', { joints: ['all'], mode: 'on' }, true));
        all('torque-off', async () => {
            if (app.robot.arm || !app.robot.body || await ask(app.t('Without torque the robot sinks or falls. Hold it. Switch torque off?'))) {
                app.command('/api/torque', { joints: ['all'], mode: 'off' }, true);
            }
        });
    }

    setRobot(robot) {
        this.rows = robot.joints.map((joint) => this.row(joint));
        this.body.replaceChildren(...this.rows.map((row) => row.line), this.makeSlider());
        this.slot.remove();
    }

    row(joint) {
        const pick = element('button', { type: 'button', className: 'joint',
                                         onclick: () => this.app.select(joint.joint) }, joint.name);
        const cell = (kind) => element('td', { className: kind });
        const cells = { angle: cell('num'), target: cell('num wide quiet'), current: cell('num'),
                        heat: cell('num'), volt: cell('num wide'), torque: cell('torque') };
        const head = element('th', { scope: 'row' }, pick);
        return { joint, pick, cells, line: element('tr', {}, head, ...Object.values(cells)) };
    }

    makeSlider() {
        const t = this.app.t;
        this.slider = element('input', { type: 'range', step: 0.5 });
        this.out = element('output');
        this.ends = [element('span', { className: 'quiet' }), element('span', { className: 'quiet' })];
        this.plot = element('input', { type: 'checkbox' });
        this.plot.addEventListener('change', () => this.app.see.toggle(this.app.selected,
                                                                       this.plot.checked));
        const button = (text, what) => element('button', { type: 'button', onclick: what }, t(text));
        const one = () => [this.app.name(this.app.selected)];
        this.buttons = [
            button('Torque on', () => this.app.command('/api/torque', { joints: one(), mode: 'on' }, true)),
            button('Torque off', () => this.app.command('/api/torque', { joints: one(), mode: 'off' }, true)),
            button('Limp', () => this.app.command('/api/torque', { joints: one(), mode: 'limp' }, true)),
            button('Hold', () => this.app.command('/api/torque', { joints: one(), mode: 'hold' }, true)),
        ];
        this.slider.addEventListener('input', () => this.drag());
        this.slider.addEventListener('change', () => this.release());
        stepByKeys(this.slider, () => {
            this.drag();
            if (!this.isWheel()) {
                this.release();
            }
        });
        for (const end of ['keyup', 'blur', 'pointerup', 'pointercancel']) {
            this.slider.addEventListener(end, () => this.rest());
        }
        const box = element('div', { className: 'jog' },
            element('div', { className: 'line' }, this.ends[0], this.slider, this.ends[1], this.out),
            element('div', { className: 'line buttons' }, ...this.buttons,
                    element('span', { className: 'gap' }),
                    element('label', { className: 'check' }, this.plot, ' ', t('Plot'))));
        this.slot = element('tr', { className: 'slot' }, element('td', { colSpan: 7 }, box));
        return this.slot;
    }

    select(joint) {
        this.rows.forEach((row, n) => {
            row.line.classList.toggle('chosen', n === joint);
            row.pick.setAttribute('aria-expanded', String(n === joint));
        });
        this.dragged = null;
        if (joint < 0) {
            this.slot.remove();
            return;
        }
        const of = this.rows[joint].joint, { name } = of, most = of.max_speed_dps;
        const limits = of.wheel ? [-most, most] : limitValues(of), unit = of.wheel ? '°/s' : unitOf(of);
        this.rest();
        this.slider.min = limits[0];
        this.slider.max = limits[1];
        this.slider.setAttribute('aria-label', of.unit ? `${name}, ${of.unit}`
            : this.app.t(of.wheel ? '{0}, degrees a second' : '{0}, degrees', name));
        this.plot.checked = this.app.see.plots.chosen.includes(joint);
        limits.forEach((v, n) => setText(this.ends[n], `${Math.round(v)}${unit}`));
        this.follow(this.app.state); // a key may come before the next picture
        this.rows[joint].line.after(this.slot);
        this.drawnAt = 0;
    }

    drag() {
        const value = Number(this.slider.value), joint = this.app.selected;
        const edge = value <= Number(this.slider.min) || value >= Number(this.slider.max);
        if (edge && !this.atEdge) {
            tremble();
        }
        this.atEdge = edge;
        this.dragged = { joint, value, at: performance.now() };
        this.show(value, edge);
        if (this.isWheel()) {
            this.turn(joint, value);
            return;
        }
        const deg = degreesOf(this.rows[joint].joint, value);
        this.newest.push({ angle_deg: { [this.app.name(joint)]: deg }, sequence: this.app.drawn });
    }

    isWheel() {
        return this.app.selected >= 0 && this.rows[this.app.selected].joint.wheel === true;
    }

    /** A wheel turns while its slider is held: its speed is asked for again and again. */
    turn(joint, dps) {
        const say = () => this.speeds.push({ speed_dps: { [this.app.name(joint)]: this.turning.dps } });
        const begins = !this.turning;
        this.turning = { joint, dps, timer: begins ? setInterval(say, 150) : this.turning.timer };
        if (begins) {
            say();
        }
    }

    /** The slider springs back, and the wheel comes to rest. */
    rest() {
        if (!this.turning) {
            return;
        }
        clearInterval(this.turning.timer);
        this.speeds.push({ speed_dps: { [this.app.name(this.turning.joint)]: 0 } });
        this.turning = this.dragged = null;
        this.slider.value = 0;
        this.show(0, false);
    }

    release() {
        this.rest();
        if (this.dragged) {
            this.dragged.until = performance.now() + 1500;
        }
    }

    show(value, edge) {
        const of = this.rows[this.app.selected];
        const unit = !of ? '°' : of.joint.wheel ? '°/s' : unitOf(of.joint);
        const words = `${value.toFixed(1)}${unit}` + (edge ? ` ${this.app.t('at its limit')}` : '');
        setText(this.out, words);
        this.out.classList.toggle('warn', edge);
        this.slider.setAttribute('aria-valuetext', words);
    }

    /** Ends a drag softly: the page is hidden, or the pointer was taken away. */
    cancel() {
        this.rest();
        if (this.dragged && !this.dragged.until) {
            this.dragged = null;
            this.app.command('/api/halt');
        }
    }

    /** Puts the slider where its joint is. Where that is not known, nothing can be dragged. */
    follow(state) {
        const joint = this.app.selected;
        if (this.isWheel()) {
            this.slider.value = 0;
            this.known = state !== null;
            this.slider.disabled = !this.known || !this.app.mayMove();
            this.show(0, false);
            return;
        }
        const deg = state ? state.target_deg[joint] ?? state.angle_deg[joint] ?? null : null;
        const angle = deg === null ? null : valueOf(this.rows[joint].joint, deg);
        if (angle !== null && Number(this.slider.value) !== angle) {
            this.slider.value = angle;
        }
        this.known = angle !== null;
        if (joint >= 0 && this.rows[joint].joint.follows !== undefined) {
            this.known = false; // it goes where the joint that it follows is sent
        }
        this.slider.disabled = !this.known || !this.app.mayMove();
        this.show(angle || 0, false);
    }

    draw(state, now) {
        const joint = this.app.selected;
        if (this.dragged && this.dragged.until && now > this.dragged.until) {
            this.dragged = null;
        }
        if (joint >= 0 && !this.dragged) {
            this.follow(state);
        }
        if (now - this.drawnAt > 240) {
            this.drawnAt = now;
            this.rows.forEach((row, n) => this.write(row, state, n));
            const may = this.app.mayMove();
            for (const node of [this.slider, ...this.buttons,
                                ...document.querySelectorAll('#all-joints button')]) {
                node.disabled = !may || node === this.slider && !this.known;
            }
            setText(document.getElementById('jog-hint'), this.app.whyNot() || '');
            const lines = setupLines(state.setup, (joint) => this.app.name(joint), this.app.t);
            replace(document.getElementById('setup-hint'),
                    ...lines.map((line) => element('li', {}, line)));
        }
    }

    write({ joint, cells, line }, state, n) {
        const t = this.app.t, number = (v, digits) => v === null ? '–' : v.toFixed(digits);
        const look = this.app.heatLevel(state.temperature_c[n]);
        const old = state.age_ms[n] === null || state.age_ms[n] > 500 || state.status[n] !== 'ok';
        line.classList.toggle('old', old);
        const value = (deg) => deg === null ? '–' : joint.unit ? valueText(joint, deg) : deg.toFixed(1);
        const dps = state.speed_dps[n];
        setText(cells.angle, !joint.wheel ? value(state.angle_deg[n]) : dps === null ? '–' : `${dps}°/s`);
        setText(cells.target, value(state.target_deg[n]));
        setText(cells.current, number(state.current_ma[n], 0));
        setText(cells.heat, number(state.temperature_c[n], 0) + (look ? ' ▲' : ''));
        cells.heat.className = `num ${look}`;
        setText(cells.volt, number(state.voltage_v[n], 2));
        const torque = state.torque[n], limp = state.limp.includes(n);
        const said = limp ? `◌ ${t('limp')}` : torque ? `${SIGNS[torque]} ${t(torque)}` : '–';
        setText(cells.torque, said + (state.status[n] !== 'ok' && state.status[n] !== 'empty'
            ? ` · ${state.status[n] === 'setup' ? t('not set up') : state.status[n]}` : '') + (old && state.age_ms[n] > 500
            ? ` · ${(state.age_ms[n] / 1000).toFixed(1)} s` : ''));
    }
}
