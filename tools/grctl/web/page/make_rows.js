// SPDX-License-Identifier: MIT
// A row a joint of the draft: slider between its limits, number, and whether the key pose sets it.

import { degreesOf, element, limitValues, stepByKeys, tremble, valueOf, valueText } from './dom.js';

export class Rows {
    /** @param make ( turnJoint(joint, deg, tag), unset(joint), rest(), app ) */
    constructor(list, make) {
        this.list = list;
        this.make = make;
        this.rows = [];
    }

    setRobot(robot) {
        this.rows = robot.joints.map((joint) => this.row(joint));
        this.drawn = null;
        this.list.replaceChildren(...this.rows.map((row) => row.line));
    }

    row(joint) {
        const { make } = this, { t } = make.app, j = joint.joint;
        const [min, max] = limitValues(joint);
        const slider = element('input', { type: 'range', step: 0.1, min, max });
        const number = element('input', { type: 'text', inputMode: 'decimal', autocomplete: 'off' });
        const pick = element('button', { type: 'button', className: 'joint',
                                         onclick: () => make.app.select(j) }, joint.name);
        const unset = element('button', { type: 'button', className: 'unset',
                                          onclick: () => make.unset(j) }, '×');
        const called = joint.unit ? `${joint.name}, ${joint.unit}` : t('{0}, degrees', joint.name);
        slider.setAttribute('aria-label', called);
        number.setAttribute('aria-label', called);
        unset.setAttribute('aria-label', t('{0} is not set by this key pose', joint.name));
        unset.title = t('{0} is not set by this key pose', joint.name);
        const turn = () => {
            if (make.app.selected !== j) {
                make.app.select(j);
            }
            make.turnJoint(j, degreesOf(joint, Number(slider.value)), `slide ${j}`);
        };
        slider.addEventListener('input', turn);
        slider.addEventListener('change', () => make.rest());
        stepByKeys(slider, turn);
        slider.addEventListener('keyup', () => make.rest());
        number.addEventListener('change', () => {
            const value = Number(number.value.replace(/°|mm|%|\s/g, '').replace(',', '.'));
            if (Number.isFinite(value) && number.value.trim()) {
                make.turnJoint(j, degreesOf(joint, value), null);
                make.rest();
            }
            this.drawn = null;
            make.app.schedule();
        });
        const line = element('li', {}, pick, slider, number, unset);
        return { joint, line, slider, number, pick };
    }

    tremble() {
        tremble();
    }

    /** @param degrees of all joints @param key the key pose that is here, or null */
    draw(degrees, key, selected) {
        const now = JSON.stringify([degrees, key && key.angle_deg, selected]);
        if (now === this.drawn) {
            return;
        }
        this.drawn = now;
        this.rows.forEach(({ joint, line, slider, number, pick }, j) => {
            const deg = degrees[j], set = Boolean(key) && key.angle_deg[j] !== null;
            const edge = set && (deg <= joint.limits_deg[0] || deg >= joint.limits_deg[1]);
            const words = valueText(joint, deg), value = valueOf(joint, deg);
            if (Number(slider.value) !== value) {
                slider.value = value;
            }
            if (document.activeElement !== number || number.value === '') {
                number.value = words;
            }
            slider.setAttribute('aria-valuetext', words + (edge ? ` ${this.make.app.t('at its limit')}` : '') +
                                (set ? '' : ` ${this.make.app.t('(not set by this key pose)')}`));
            line.className = `${set ? 'set' : ''} ${edge ? 'edge' : ''} ${j === selected ? 'chosen' : ''}`;
            pick.setAttribute('aria-pressed', String(j === selected));
        });
    }

    /** Brings the row of a joint into view. */
    reveal(joint) {
        this.rows[joint].line.scrollIntoView({ block: 'nearest' });
    }
}
