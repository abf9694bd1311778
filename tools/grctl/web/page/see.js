// SPDX-License-Identifier: MIT
// The view "See": balance in words, plots of chosen joints, health of the line.

import { Plots } from './plots.js';
import { element, replace } from './dom.js';

const MOST = 6;

export class See {
    constructor(app) {
        this.app = app;
        this.plots = new Plots(document.getElementById('plots'), app.t);
        this.plots.onTouch = () => app.schedule();
        this.history = [];
        this.drawnAt = 0;
        const add = document.getElementById('add-plot');
        add.addEventListener('change', () => {
            this.toggle(Number(add.value), true);
            add.value = '';
        });
    }

    setRobot(robot) {
        this.plots.setJoints(robot.joints);
        this.write();
    }

    /** Chooses a joint for the plots, or no longer. */
    toggle(joint, on) {
        const rest = this.plots.chosen.filter((j) => j !== joint);
        this.plots.chosen = (on ? [...rest, joint] : rest).slice(-MOST);
        this.plots.dirty = true;
        this.write();
        this.app.schedule();
    }

    write() {
        const { app, plots } = this, names = plots.names || [];
        replace(document.getElementById('add-plot'),
                element('option', { value: '' }, app.t('Add a joint …')),
                ...names.map((name, n) => element('option', { value: n }, name))
                    .filter((_, n) => !plots.chosen.includes(n)));
        replace(document.getElementById('chosen'), ...plots.chosen.map((joint, n) => {
            const chip = element('button', { type: 'button', className: `chip series${n % 6}`,
                                             onclick: () => this.toggle(joint, false) });
            chip.setAttribute('aria-label', app.t('Remove {0} from the plots', names[joint]));
            chip.append(element('i'), names[joint], element('span', { className: 'quiet' }, ' ×'));
            return chip;
        }));
    }

    state(state) {
        this.plots.push(state);
        const { timeouts, bad_sums: sums, retries } = state.line;
        this.history.push({ at: state.time_ms, timeouts, sums, retries });
        while (this.history.length > 1 && (state.time_ms - this.history[0].at > 60000 ||
                                           this.history[0].at > state.time_ms)) {
            this.history.shift();
        }
    }

    draw(state, now) {
        if (now - this.drawnAt > 66 || this.plots.cursor !== null) {
            this.plots.draw();
        }
        if (now - this.drawnAt > 240 && this.history.length) {
            this.drawnAt = now;
            this.writeBalance(state);
            this.writeLine(state);
        }
    }

    writeBalance(state) {
        const t = this.app.t, body = state.body;
        const cards = [];
        const card = (level, title, value) => cards.push(element('div', { className: `card ${level}` },
            element('span', {}, title), element('b', {}, value)));
        if (body) {
            const mm = body.margin_m === null ? null : Math.round(body.margin_m * 1000);
            const feet = body.soles.filter((s) => s.standing).map((s) => t(s.side));
            card(mm === null ? '' : mm < 0 ? 'bad' : mm < 5 ? 'warn' : 'ok', t('Balance'),
                 mm === null ? t('unknown') : mm < 0 ? t('✕ {0} mm outside', -mm)
                                                     : t('✓ {0} mm inside', mm));
            card('', t('Stands on'), feet.join(' + ') || t('nothing'));
        }
        if (state.imu) {
            const tilt = Math.round(state.imu.tilt_deg);
            card(state.imu.fallen ? 'bad' : tilt > 20 ? 'warn' : 'ok', t('Tilt'),
                 state.imu.fallen ? t('✕ {0}°, fallen', tilt) : `${tilt}°`);
        }
        const hot = state.temperature_c.reduce((b, v, n) => v > (b ? b.v : -1) ? { v, n } : b, null);
        const limit = this.app.robot.safety.temperature_c;
        if (hot) {
            card(limit && hot.v >= limit - 5 ? 'bad' : limit && hot.v >= limit - 15 ? 'warn' : '',
                 t('Hottest'), `${this.app.name(hot.n)} ${hot.v}\u00a0°C`);
        }
        const volts = state.voltage_v.filter((v) => v !== null);
        if (volts.length) {
            const low = Math.min(...volts), least = this.app.robot.safety.voltage_mv / 1000;
            card(least && low < least ? 'bad' : least && low < least * 1.05 ? 'warn' : '',
                 t('Supply'), `${low.toFixed(2)} V`);
        }
        replace(document.getElementById('balance'), ...cards);
    }

    writeLine(state) {
        const t = this.app.t, line = state.line, first = this.history[0], jitter = line.jitter_us;
        const budget = this.app.robot.budget;
        const minute = (all, key) => t('{0} ({1} in the last minute)', all, all - first[key]);
        const rows = [
            [t('Load'), line.load_pct === null ? '–' : `${Math.round(line.load_pct)} %`,
             line.load_pct],
            [t('Readings'), line.load_hz === null ? '–' : `${Math.round(line.load_hz)} /s`],
            [t('Budget'), t('{0} Hz watched, {1} Hz at most', budget.watched_hz, budget.max_hz)],
            [t('Jitter'), jitter.frames ? `p50 ${jitter.p50} µs, p99 ${jitter.p99} µs, ` +
                                          `max ${jitter.max} µs` : t('no motion yet')],
            [t('Late frames'), t('{0} of {1}', line.late_frames, line.motion_frames)],
            [t('Timeouts'), minute(line.timeouts, 'timeouts')],
            [t('Retries'), minute(line.retries, 'retries')],
            [t('Bad checksums'), minute(line.bad_sums, 'sums')],
            [t('Pages'), String(state.clients)],
        ];
        replace(document.getElementById('line'), ...rows.flatMap(([name, value, part]) => {
            const dd = element('dd', {}, value);
            if (part !== undefined && part !== null) {
                dd.append(element('meter', { min: 0, max: 100, value: part, high: 90 }));
                dd.lastChild.setAttribute('aria-label', name);
            }
            return [element('dt', {}, name), dd];
        }));
    }
}
