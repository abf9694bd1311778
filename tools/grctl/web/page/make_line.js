// SPDX-License-Identifier: MIT
// The time line of key poses: a button a key (dragged, or moved by keys), the curve of the chosen joint
// as the server interpolates it, its limits, that of another motion to compare with, and where the
// balance is lost.

import { element, seconds } from './dom.js';

const INSET = 14;
const LEFT = 40; // for the angles
const DRAG = 4; // pixels before a press is a drag

export class Line {
    /** @param host #make-track @param hands ( choose(id), move(id, ms, done), at(ms) ) */
    constructor(host, t, hands) {
        this.host = host;
        this.t = t;
        this.hands = hands;
        this.drawnKeys = this.drawnLook = this.drawnOther = null;
        this.canvas = host.querySelector('canvas');
        this.markers = host.querySelector('.markers');
        this.range = host.querySelector('input');
        this.range.addEventListener('input', () => hands.at(Number(this.range.value)));
        this.canvas.addEventListener('pointerdown', (event) => this.scrub(event));
        this.canvas.addEventListener('pointermove', (event) => event.buttons && this.scrub(event));
        new ResizeObserver(() => {
            this.drawn = null;
            hands.touch();
        }).observe(host);
    }

    scrub(event) {
        const box = this.canvas.getBoundingClientRect();
        this.canvas.setPointerCapture(event.pointerId);
        this.hands.at(this.ms(event.clientX - box.left));
    }

    x(ms) {
        return LEFT + (this.host.clientWidth - LEFT - INSET) * ms / this.span;
    }

    ms(x) {
        const part = (x - LEFT) / (this.host.clientWidth - LEFT - INSET);
        return Math.max(0, Math.min(this.span, part * this.span));
    }

    /** @param view ( draft, at, look, other, joint, css, theme ) */
    draw(view) {
        const { draft, at } = view;
        if (!this.dragging) { // a little room behind the last key, to put another there
            this.span = Math.max(1000, Math.ceil(draft.length() / 1000 * 1.08 + 0.2) * 1000);
        }
        if (Number(this.range.max) !== this.span) {
            this.range.max = this.span;
        }
        if (Number(this.range.value) !== at) {
            this.range.value = at;
        }
        this.range.setAttribute('aria-valuetext', this.t('{0} of {1} seconds', seconds(at),
                                                         seconds(draft.length())));
        const key = JSON.stringify([this.host.clientWidth, this.canvas.clientHeight, view.joint,
                                    view.theme, this.span, at, draft.chosen, Boolean(view.other)]);
        if (key !== this.drawn || draft.keys !== this.drawnKeys || view.look !== this.drawnLook ||
            view.other !== this.drawnOther) {
            Object.assign(this, { drawn: key, drawnKeys: draft.keys, drawnLook: view.look,
                                  drawnOther: view.other });
            this.writeMarkers(draft);
            this.paint(view);
        }
    }

    writeMarkers(draft) {
        while (this.markers.children.length > draft.keys.length) {
            this.markers.lastChild.remove();
        }
        draft.keys.forEach((key, n) => {
            const node = this.markers.children[n] || this.makeMarker();
            const chosen = key.id === draft.chosen;
            node.dataset.id = key.id;
            node.style.left = `${this.x(key.time_ms)}px`;
            node.tabIndex = chosen ? 0 : -1;
            node.setAttribute('aria-selected', String(chosen));
            node.setAttribute('aria-label', this.t('Key pose {0} of {1}, {2} s', n + 1,
                draft.keys.length, (key.time_ms / 1000).toFixed(2)) + (key.name ? `, ${key.name}` : ''));
        });
        if (this.refocus) {
            this.refocus = false;
            this.focus();
        }
    }

    /** The chosen key gets the focus. */
    focus() {
        const node = this.markers.querySelector('[aria-selected=true]');
        if (node) {
            node.focus();
        }
    }

    makeMarker() {
        const node = element('button', { type: 'button' }, element('i'));
        const id = () => Number(node.dataset.id);
        node.setAttribute('role', 'option');
        let from = null;
        node.addEventListener('pointerdown', (event) => {
            node.setPointerCapture(event.pointerId);
            from = { x: event.clientX, at: parseFloat(node.style.left), moved: false, id: id() };
            this.hands.choose(id());
        });
        node.addEventListener('pointermove', (event) => {
            if (from && (from.moved || Math.abs(event.clientX - from.x) > DRAG)) {
                from.moved = this.dragging = true;
                this.hands.move(from.id, this.ms(from.at + event.clientX - from.x));
            }
        });
        const end = () => {
            if (from) {
                from = null;
                this.dragging = false;
                this.hands.moved();
            }
        };
        node.addEventListener('pointerup', end);
        node.addEventListener('pointercancel', end);
        node.addEventListener('click', (event) => event.detail === 0 && this.hands.choose(id()));
        this.markers.append(node);
        return node;
    }

    // ---- the canvas ----------------------------------------------------------------------------

    paint(view) {
        const { canvas } = this, css = view.css, w = canvas.clientWidth, h = canvas.clientHeight;
        const scale = Math.min(window.devicePixelRatio || 1, 2), pen = canvas.getContext('2d');
        if (!w || !css) {
            return;
        }
        canvas.width = w * scale;
        canvas.height = h * scale;
        pen.setTransform(scale, 0, 0, scale, 0, 0);
        pen.font = '11px system-ui, sans-serif';
        this.seconds(pen, css, h);
        const range = this.bounds(view);
        const y = (v) => 8 + (h - 30) * (1 - (v - range[0]) / (range[1] - range[0]));
        if (view.joint >= 0) {
            this.limits(pen, view, range, y, w);
        }
        for (const key of view.draft.keys) {
            const chosen = key.id === view.draft.chosen;
            pen.fillStyle = chosen ? css.accent : css.grid;
            pen.fillRect(this.x(key.time_ms) - (chosen ? 1 : 0.5), 0, chosen ? 2 : 1, h - 20);
        }
        if (view.joint >= 0) {
            if (view.other) {
                this.between(pen, view, y);
                this.curve(pen, view.other.frames, view, y, css.series[1], [6, 4]);
            }
            if (view.look && view.look.frames.angle_deg.length) {
                this.curve(pen, view.look.frames, view, y, css.accent, []);
            }
            this.dots(pen, view, y);
        }
        this.falls(pen, view, h);
        pen.fillStyle = css.text;
        pen.fillRect(this.x(view.at) - 0.75, 0, 1.5, h - 20);
    }

    seconds(pen, css, h) {
        const steps = [100, 200, 500, 1000, 2000, 5000, 10000, 30000, 60000];
        const room = (this.host.clientWidth - LEFT - INSET) / this.span;
        const step = steps.find((s) => s * room > 46) || 60000;
        pen.textAlign = 'center';
        pen.textBaseline = 'alphabetic';
        for (let ms = 0; ms <= this.span; ms += step) {
            pen.fillStyle = css.grid;
            pen.fillRect(this.x(ms) - 0.5, h - 20, 1, 5);
            pen.fillStyle = css.quiet;
            pen.fillText(String(+(ms / 1000).toFixed(1)), this.x(ms), h - 4);
        }
    }

    values(frames, joint) {
        return frames.angle_deg.map((row) => row[joint]);
    }

    /** The angles that are shown: those of the curves, with some air. */
    bounds({ look, other, joint, draft }) {
        const all = joint < 0 ? [] : [
            ...look ? this.values(look.frames, joint) : [],
            ...other ? this.values(other.frames, joint) : [],
            ...draft.keys.map((key) => key.angle_deg[joint])].filter((v) => v !== null && v !== undefined);
        const low = all.reduce((a, v) => Math.min(a, v), Infinity);
        const high = all.reduce((a, v) => Math.max(a, v), -Infinity);
        const [l, u] = low > high ? [-10, 10] : [low, high], lack = Math.max(0, 10 - (u - l)) / 2;
        return [l - lack - (u - l) * 0.1, u + lack + (u - l) * 0.1];
    }

    limits(pen, { joint, draft, css }, range, y, w) {
        pen.textAlign = 'right';
        pen.textBaseline = 'middle';
        for (const v of range.map((r, n) => n ? r - (range[1] - range[0]) * 0.06
                                              : r + (range[1] - range[0]) * 0.06)) {
            pen.fillStyle = css.quiet;
            pen.fillText(`${Math.round(v)}°`, LEFT - 6, y(v));
        }
        pen.strokeStyle = css.danger;
        pen.setLineDash([2, 3]);
        for (const v of draft.joints[joint].limits_deg) {
            if (v > range[0] && v < range[1]) {
                pen.beginPath();
                pen.moveTo(LEFT, y(v));
                pen.lineTo(w - INSET, y(v));
                pen.stroke();
            }
        }
        pen.setLineDash([]);
    }

    path(pen, frames, joint, y) {
        let open = false;
        this.values(frames, joint).forEach((v, n) => {
            if (v === null) {
                open = false;
            } else {
                pen[open ? 'lineTo' : 'moveTo'](this.x(n / frames.rate_hz * 1000), y(v));
                open = true;
            }
        });
    }

    curve(pen, frames, { joint }, y, colour, dash) {
        pen.strokeStyle = colour;
        pen.lineWidth = 1.8;
        pen.setLineDash(dash);
        pen.beginPath();
        this.path(pen, frames, joint, y);
        pen.stroke();
        pen.setLineDash([]);
        pen.lineWidth = 1;
    }

    /** What lies between the two curves. */
    between(pen, { look, other, joint, css }, y) {
        const a = look ? this.values(look.frames, joint) : [], b = this.values(other.frames, joint);
        const n = Math.min(a.length, b.length);
        pen.fillStyle = css.series[1];
        pen.globalAlpha = 0.16;
        for (let i = 0; i + 1 < n; i++) {
            if (![a[i], a[i + 1], b[i], b[i + 1]].includes(null)) {
                const [from, to] = [i, i + 1].map((k) => this.x(k / look.frames.rate_hz * 1000));
                pen.beginPath();
                pen.moveTo(from, y(a[i]));
                pen.lineTo(to, y(a[i + 1]));
                pen.lineTo(to, y(b[i + 1]));
                pen.lineTo(from, y(b[i]));
                pen.fill();
            }
        }
        pen.globalAlpha = 1;
    }

    /** Where keys set the joint. */
    dots(pen, { draft, joint, css }, y) {
        for (const key of draft.keys) {
            const v = key.angle_deg[joint];
            if (v !== null) {
                pen.fillStyle = key.id === draft.chosen ? css.text : css.accent;
                pen.beginPath();
                pen.arc(this.x(key.time_ms), y(v), 4, 0, 7);
                pen.fill();
            }
        }
    }

    falls(pen, { look, css }, h) {
        const fall = look && look.check.falls_ms;
        for (const finding of look && look.balance ? look.balance.findings : []) {
            const outside = finding.problem !== 'zmp_margin' || finding.worst < 0;
            const from = this.x(finding.begin_ms), to = Math.max(from + 3, this.x(finding.end_ms));
            pen.strokeStyle = outside ? css.danger : css.warn;
            pen.save();
            pen.beginPath();
            pen.rect(from, h - 29, to - from, 8);
            pen.clip();
            for (let at = from - 8; at < to; at += 5) { // hatched: not by colour alone
                pen.beginPath();
                pen.moveTo(at, h - 21);
                pen.lineTo(at + 8, h - 29);
                pen.stroke();
            }
            pen.restore();
        }
        if (fall !== null && fall !== undefined) {
            pen.fillStyle = css.danger;
            pen.fillRect(this.x(fall) - 1, 0, 2, h - 20);
            pen.textAlign = 'left';
            pen.fillText(this.t('falls at {0} s', seconds(fall)), this.x(fall) + 5, h - 26);
        }
    }
}

