// SPDX-License-Identifier: MIT
// The last minute of some joints: rings of numbers, and curves on canvases. A column of pixels is
// drawn from the least to the largest of its numbers, so that no peak is lost.

import { unitOf, valueOf } from './dom.js';

const SPAN_MS = 60000;
const SIZE = 4096; // a minute at 60 Hz, and some

/** Numbers by time: the newest SIZE. */
export class Ring {
    constructor(channels, size = SIZE) {
        this.size = size;
        this.time = new Float64Array(size);
        this.rows = Array.from({ length: channels }, () => new Float32Array(size));
        this.count = 0;
    }

    push(time, values) {
        const at = this.count % this.size;
        this.time[at] = time;
        this.rows.forEach((row, n) => {
            row[at] = values[n] === null || values[n] === undefined ? NaN : values[n];
        });
        this.count++;
    }

    /** Calls with (time, value) from the oldest that is not before `from`. */
    each(channel, from, call) {
        const row = this.rows[channel];
        for (let n = Math.max(0, this.count - this.size); n < this.count; n++) {
            const at = n % this.size;
            if (this.time[at] >= from) {
                call(this.time[at], row[at]);
            }
        }
    }

    clear() {
        this.count = 0;
    }
}

/**
 * Least and largest by column of pixels.
 * @returns ( low, high ) of width columns; NaN where there is nothing
 */
export function columns(ring, channel, from, to, width) {
    const low = new Float32Array(width).fill(NaN), high = new Float32Array(width).fill(NaN);
    ring.each(channel, from, (time, value) => {
        const x = Math.min(width - 1, Math.floor((time - from) / (to - from) * width));
        if (x >= 0 && value === value) {
            low[x] = low[x] < value ? low[x] : value;
            high[x] = high[x] > value ? high[x] : value;
        }
    });
    return { low, high };
}

/** Some round numbers between low and high, about n. */
export function ticks(low, high, n) {
    const raw = (high - low) / n, ten = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((k) => k * ten).find((s) => s >= raw * 0.999);
    const out = [];
    for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + step * 1e-9; v += step) {
        out.push(Math.abs(v) < step / 1e6 ? 0 : v);
    }
    return out;
}

const KINDS = [
    { key: 'angle_deg', unit: '°', title: 'Angle and target', least: 10, digits: 1 },
    { key: 'current_ma', unit: 'mA', title: 'Current', least: 50, zero: true, digits: 0 },
    { key: 'temperature_c', unit: '°C', title: 'Temperature', least: 10, digits: 0 },
    { key: 'voltage_v', unit: 'V', title: 'Voltage', least: 0.5, digits: 2 },
];
const KEYS = ['angle_deg', 'target_deg', 'current_ma', 'temperature_c', 'voltage_v'];
const DASHES = [[], [7, 3], [2, 3], [9, 3, 2, 3], [4, 2], [12, 4]];

export class Plots {
    /** @param host gets a canvas a quantity @param t translator */
    constructor(host, t) {
        this.host = host;
        this.t = t;
        this.chosen = [];
        this.rings = [];
        this.cursor = null;
        this.onTouch = null;
        this.charts = KINDS.map((kind) => {
            const box = document.createElement('figure'), title = document.createElement('figcaption');
            const canvas = document.createElement('canvas');
            canvas.setAttribute('role', 'img');
            box.append(title, canvas);
            host.append(box);
            canvas.addEventListener('pointermove', (event) => this.point(event, canvas));
            canvas.addEventListener('pointerdown', (event) => this.point(event, canvas));
            canvas.addEventListener('pointerleave', () => this.point(null));
            return { ...kind, title, canvas, words: kind.title };
        });
    }

    point(event, canvas) {
        const box = canvas && canvas.getBoundingClientRect();
        this.cursor = event ? Math.max(0, Math.min(1, (event.clientX - box.left - 40) /
                                                      (box.width - 100))) : null;
        this.dirty = true;
        if (this.onTouch) {
            this.onTouch();
        }
    }

    setJoints(joints) {
        this.joints = joints;
        this.names = joints.map((joint) => joint.name);
        this.rings = joints.map(() => new Ring(KEYS.length));
        this.chosen = [];
    }

    push(state) {
        this.now = state.time_ms;
        this.rings.forEach((ring, n) => {
            if (ring.count && state.time_ms < ring.time[(ring.count - 1) % ring.size]) {
                ring.clear(); // another server: its clock began anew
            }
            const shown = (key, v) => v !== null && key.endsWith('_deg') ? valueOf(this.joints[n], v) : v;
            ring.push(state.time_ms, KEYS.map((key) => shown(key, state[key][n])));
        });
        this.dirty = true;
    }

    /** @param theme ( text, quiet, grid, danger, series: colours ) as CSS text */
    setTheme(theme) {
        this.theme = theme;
        this.dirty = true;
    }

    draw() {
        if (!this.dirty || !this.theme || this.now === undefined || !this.host.clientWidth) {
            return;
        }
        this.dirty = false;
        for (const chart of this.charts) {
            this.chart(chart);
        }
    }

    chart(chart) {
        const scale = Math.min(window.devicePixelRatio || 1, 2), canvas = chart.canvas;
        const w = canvas.clientWidth, h = canvas.clientHeight;
        if (canvas.width !== Math.round(w * scale) || canvas.height !== Math.round(h * scale)) {
            canvas.width = Math.round(w * scale);
            canvas.height = Math.round(h * scale);
        }
        const pen = canvas.getContext('2d');
        pen.setTransform(scale, 0, 0, scale, 0, 0);
        pen.clearRect(0, 0, w, h);
        const area = { x: 40, y: 8, w: w - 100, h: h - 24 };
        const to = this.now, from = to - SPAN_MS, channel = KEYS.indexOf(chart.key);
        const width = Math.max(20, Math.round(area.w * scale));
        const series = this.chosen.map((joint, n) => ({
            joint, n, ...columns(this.rings[joint], channel, from, to, width),
            target: chart.key === 'angle_deg' ? columns(this.rings[joint], 1, from, to, width) : null,
        }));
        const range = this.range(chart, series);
        const y = (v) => area.y + area.h * (1 - (v - range[0]) / (range[1] - range[0]));
        this.frame(pen, chart, area, range, y);
        for (const one of series) {
            this.curve(pen, one, area, y);
        }
        this.ends(pen, chart, series, area, y);
        const now = series.map((s) => `${this.names[s.joint]} ${this.value(chart, s, 1)}`).join(', ');
        const units = chart.key === 'angle_deg'
            ? [...new Set(this.chosen.map((joint) => unitOf(this.joints[joint]).trim()))] : [];
        chart.title.textContent = `${this.t(chart.words)} (${units.join(', ') || chart.unit})`;
        canvas.setAttribute('aria-label', `${this.t(chart.words)}: ${now || this.t('no joint chosen')}`);
    }

    range(chart, series) {
        let low = Infinity, high = -Infinity;
        for (const one of series) {
            for (const part of [one, one.target]) {
                for (let x = 0; part && x < part.low.length; x++) {
                    low = part.low[x] < low ? part.low[x] : low;
                    high = part.high[x] > high ? part.high[x] : high;
                }
            }
        }
        if (low > high) {
            [low, high] = [0, chart.least];
        }
        if (chart.zero) {
            low = Math.min(low, 0);
        }
        const lack = Math.max(0, chart.least - (high - low)) / 2, air = (high - low + lack) * 0.08;
        return [chart.zero ? low : low - lack - air, high + (chart.zero ? lack * 2 : lack) + air];
    }

    frame(pen, chart, area, range, y) {
        pen.font = '11px system-ui, sans-serif';
        pen.textBaseline = 'middle';
        pen.textAlign = 'right';
        pen.lineWidth = 1;
        for (const v of ticks(range[0], range[1], 3)) {
            pen.strokeStyle = this.theme.grid;
            pen.beginPath();
            pen.moveTo(area.x, Math.round(y(v)) + 0.5);
            pen.lineTo(area.x + area.w, Math.round(y(v)) + 0.5);
            pen.stroke();
            pen.fillStyle = this.theme.quiet;
            pen.fillText(String(+v.toFixed(2)), area.x - 6, y(v));
        }
        pen.textAlign = 'center';
        for (const s of [60, 45, 30, 15, 0]) {
            pen.fillStyle = this.theme.quiet;
            pen.fillText(s ? `−${s} s` : this.t('now'), area.x + area.w * (1 - s / 60),
                         area.y + area.h + 10);
        }
    }

    /** Targets are thin and pale, angles strong; each joint has its own dashes besides its colour. */
    curve(pen, one, area, y) {
        const colour = this.theme.series[one.n % this.theme.series.length];
        for (const [part, wide, pale] of [[one.target, 1, 0.55], [one, 1.8, 1]]) {
            if (part) {
                pen.strokeStyle = colour;
                pen.globalAlpha = pale;
                pen.lineWidth = wide;
                pen.setLineDash(part === one ? DASHES[one.n % DASHES.length] : []);
                pen.beginPath();
                let last = -1;
                for (let x = 0; x < part.low.length; x++) {
                    if (part.low[x] === part.low[x]) {
                        const px = area.x + area.w * (x + 0.5) / part.low.length;
                        if (last < 0 || x - last > part.low.length / 20) {
                            pen.moveTo(px, y(part.low[x]));
                        }
                        pen.lineTo(px, y(part.low[x]));
                        if (part.high[x] !== part.low[x]) {
                            pen.lineTo(px, y(part.high[x]));
                        }
                        last = x;
                    }
                }
                pen.stroke();
            }
        }
        pen.setLineDash([]);
        pen.globalAlpha = 1;
    }

    value(chart, one, part) {
        const end = Math.round((one.low.length - 1) * part);
        for (let x = end; x >= 0 && x > end - one.low.length / 20; x--) {
            if (one.high[x] === one.high[x]) {
                const unit = chart.key === 'angle_deg' ? unitOf(this.joints[one.joint]).trim() : chart.unit;
                return `${one.high[x].toFixed(chart.digits)} ${unit}`;
            }
        }
        return '–';
    }

    /** The newest values, or those under the pointer, at the right. */
    ends(pen, chart, series, area, y) {
        const part = this.cursor === null ? 1 : this.cursor;
        if (this.cursor !== null) {
            pen.strokeStyle = this.theme.quiet;
            pen.beginPath();
            pen.moveTo(area.x + area.w * part, area.y);
            pen.lineTo(area.x + area.w * part, area.y + area.h);
            pen.stroke();
        }
        const labels = series.map((one) => {
            const text = this.value(chart, one, part);
            return { text, n: one.n, y: text === '–' ? area.y + area.h / 2 : y(parseFloat(text)) };
        }).sort((a, b) => a.y - b.y);
        let floor = area.y;
        pen.textAlign = 'left';
        pen.font = '600 11px system-ui, sans-serif';
        for (const label of labels) {
            label.y = floor = Math.max(label.y, floor);
            floor += 13;
        }
        const over = Math.max(0, floor - 13 - area.y - area.h);
        for (const label of labels) {
            pen.fillStyle = this.theme.series[label.n % this.theme.series.length];
            pen.fillText(label.text, area.x + area.w + 6, label.y - over);
        }
    }
}
