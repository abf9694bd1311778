// SPDX-License-Identifier: MIT
// STOP: sent at once on two ways, and again until the server says that it stands. It is never
// disabled, asks nothing, and needs neither lease nor a fresh state.

const AGAIN_MS = 250;
const GIVE_UP_MS = 30000;

export class Stopper {
    /** @param changed called when there is something new to say */
    constructor(api, name, changed) {
        this.api = api;
        this.name = name;
        this.changed = changed;
        this.at = null;
        this.answered = false;
        this.latched = false;
    }

    press() {
        this.pressed = performance.now();
        if (this.at === null || this.answered) {
            this.at = this.pressed;
            this.answered = false;
        }
        this.send();
        if (!this.timer) {
            this.timer = setInterval(() => this.again(), AGAIN_MS);
        }
        this.changed();
    }

    send() {
        const body = { name: this.name() };
        if (this.api.stopPort) {
            this.api.aside('/stop', body).catch(() => {});
        }
        this.api.post('/api/stop', body).then(() => this.acknowledge(), () => {});
    }

    again() {
        if (this.answered || performance.now() - this.pressed > GIVE_UP_MS) {
            clearInterval(this.timer);
            this.timer = null;
        } else {
            this.send();
        }
        this.changed();
    }

    acknowledge() {
        if (this.at !== null && !this.answered) {
            this.answered = true;
            this.took = performance.now() - this.at;
            this.changed();
        }
    }

    /** A state came. */
    see(stop) {
        if (stop.latched) {
            this.acknowledge();
        } else if (this.latched) {
            this.at = null;
        }
        this.latched = stop.latched;
    }

    /** How long a stop of this page has had no answer, in ms; 0: none waits. */
    unanswered() {
        return this.at === null || this.answered ? 0 : performance.now() - this.at;
    }
}

/** How many joints are in each state of a stop: { stopped: 19, moving: 1 }. */
export function count(joints) {
    const out = {};
    for (const state of joints) {
        out[state] = (out[state] || 0) + 1;
    }
    return out;
}

/**
 * What is known of a stop.
 * @param t translator @param names of the joints
 * @returns ( level: 'ok' | 'warn' | 'bad', text ); null: no stop
 */
export function stopWords(stop, waited, names, t) {
    if (waited > 0) {
        const level = waited > 700 ? 'bad' : 'warn';
        return { level, text: waited > 700
            ? t('STOP sent, no answer for {0} s: use the switch on the robot', (waited / 1000).toFixed(1))
            : t('STOP sent') };
    }
    if (!stop || !stop.latched) {
        return null;
    }
    const n = count(stop.joints), still = (n.stopped || 0) + (n.limp || 0);
    const who = stop.kind === 'trip'
        ? t('Safety stop: {0}', [t(stop.trip || 'stop'), names[stop.joint]].filter(Boolean).join(', '))
        : stop.by ? t('Stopped by {0}', stop.by) : t('Stopped');
    if (stop.confirmed) {
        return { level: 'ok', text: `${who}: ` + (n.limp
            ? t('all {0} joints stand or have no torque, read back', stop.joints.length)
            : t('all {0} joints stand, read back', stop.joints.length)) };
    }
    const bad = stop.joints.map((s, i) => s === 'moving' || s === 'silent' ? `${names[i]} ${t(s)}` : '')
        .filter(Boolean);
    const more = bad.length > 3 ? bad.slice(0, 3).concat('…') : bad;
    return { level: bad.length ? 'bad' : 'warn',
             text: `${who}: ` + t('{0} of {1} joints stand', still, stop.joints.length) +
                   (more.length ? `; ${more.join(', ')}` : '') };
}
