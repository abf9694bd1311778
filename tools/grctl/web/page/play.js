// SPDX-License-Identifier: MIT
// The view "Play": the motion directory with small pictures, and the transport below the figure. While
// nothing plays, the position moves a ghost only; while a motion plays, it moves the robot.

import { Camera } from './figure.js';
import { forward, stand } from './body.js';
import { makeFlat } from './flat.js';
import { Newest } from './api.js';
import { element, replace, seconds, setText } from './dom.js';
import { DEG } from './mat.js';

const LIVE = ['approaching', 'playing', 'paused', 'stopping'];

/** The pose of samples at a time, between two of them. @returns ( q: radians, root ) */
export function sample(frames, ms, toMatrix) {
    const at = Math.max(0, Math.min(frames.angle_deg.length - 1, ms / 1000 * frames.rate_hz));
    const n = Math.floor(at), m = Math.min(n + 1, frames.angle_deg.length - 1), k = at - n;
    const a = frames.angle_deg[n], b = frames.angle_deg[m];
    const q = a.map((v, i) => v === null || b[i] === null ? NaN : (v + (b[i] - v) * k) * DEG);
    const root = frames.root && frames.root[k < 0.5 ? n : m];
    return { q, root: root ? toMatrix(root) : null };
}

/** A motion that cannot be played on this robot has no poses to show. */
export function hasPoses(thumbnail) {
    return Boolean(thumbnail && thumbnail.angle_deg.length);
}

/** Why a motion is not played here: of another robot without what a command line would do about it. */
export function refusal({ code, message }, t) {
    return code === 'type' ? `✕ ${t('for another robot, cannot be played')}: ${message.split('; ')[0]}`
                           : `✕ ${message}`;
}

/** What a check has found, as far as it can be read at a glance. */
export function firstOf(diagnostics, most = 3) {
    const texts = diagnostics.map((one) => one.message);
    return texts.slice(0, most).join('; ') + (texts.length > most ? '; …' : '');
}

export class Play {
    constructor(app) {
        this.app = app;
        this.id = (name) => document.getElementById(name);
        this.files = [];
        this.name = null;
        this.look = null;
        this.at = 0;
        this.seek = new Newest((target) => app.command('/api/seek', target));
        this.speed = new Newest((target) => app.command('/api/speed', target));
        const click = (name, what) => this.id(name).addEventListener('click', what);
        click('play', () => this.playOrPause());
        click('preview', () => this.togglePreview());
        click('queue', () => app.command('/api/queue', { motion: this.name, ...this.options() }, true));
        click('halt', () => app.command('/api/halt'));
        this.id('seek').addEventListener('input', () => this.seeked());
        this.id('seek').addEventListener('change', () => {
            this.dragging = performance.now() + 400;
        });
        this.id('speed').addEventListener('input', () => this.sped());
        for (const name of ['mirror', 'loop']) {
            this.id(name).addEventListener('change', () => name === 'mirror' && this.load());
        }
        new ResizeObserver(() => {
            this.stripKey = null;
            app.schedule();
        }).observe(this.id('track'));
    }

    options() {
        return { speed_pct: Number(this.id('speed').value), mirror: this.id('mirror').checked,
                 loop: this.id('loop').checked };
    }

    live() {
        const state = this.app.state;
        return state && LIVE.includes(state.play.state) ? state.play : null;
    }

    async refresh() {
        const list = await this.app.api.get('/api/motions');
        this.files = list.motions;
        this.directory = list.directory;
        this.app.make.setFiles(list.motions);
        this.writeFiles();
        if (this.name && !this.files.some((f) => f.name === this.name)) {
            this.name = this.look = null;
        }
    }

    writeFiles() {
        const t = this.app.t, cards = this.files.map((file) => this.card(file));
        this.id('files').replaceChildren(...cards.map((card) => card.item));
        this.id('no-files').hidden = this.files.length > 0;
        setText(this.id('no-files'), t('No motions in {0}.', this.directory || ''));
        this.pictures = cards;
        this.paint();
    }

    badge(file) {
        const t = this.app.t, check = file.check;
        if (file.state === 'pending') {
            return ['', t('… being checked')];
        }
        if (file.state === 'unreadable' || !check) {
            return ['bad', t('✕ not readable')];
        }
        if (check.refused) {
            return ['bad', refusal(check.refused, t)];
        }
        if (check.falls_ms !== null) {
            return ['bad', t('▲ falls at {0} s', seconds(check.falls_ms))];
        }
        return check.warnings || check.errors ? ['warn', t('▲ {0} warnings', check.warnings + check.errors)]
                                              : ['ok', t('✓ checked')];
    }

    card(file) {
        const canvas = element('canvas', { width: 240, height: 132 });
        canvas.setAttribute('aria-hidden', 'true');
        const [level, words] = this.badge(file);
        const refused = Boolean(file.check && file.check.refused);
        if (refused) {
            canvas.classList.add('none');
        }
        const length = file.length_ms === undefined ? '' : `${seconds(file.length_ms)} s`;
        const button = element('button', { type: 'button', className: 'file',
                                           onclick: () => this.choose(file.name) },
            canvas, element('b', {}, file.name),
            element('span', { className: 'line' }, element('span', { className: 'quiet' }, length),
                    element('span', { className: `badge ${level}` }, words)));
        button.setAttribute('aria-pressed', String(file.name === this.name));
        return { file, canvas, button, item: element('li', {}, button) };
    }

    /** Paints small pictures, one at a time: states and heartbeats come between them. */
    paint() {
        const { body, theme } = this.app.figure;
        clearTimeout(this.painting);
        if (!body || !theme || !this.pictures || this.id('motions').hidden) {
            return;
        }
        const next = this.pictures.find(({ file, canvas }) => hasPoses(file.thumbnail) &&
                                        canvas.dataset.painted !== this.app.themeName);
        if (next) {
            next.canvas.dataset.painted = this.app.themeName;
            try {
                this.picture(next.canvas, next.file.thumbnail, body, theme);
            } catch (error) { // one picture that cannot be drawn keeps none of the others
                console.warn(`${next.file.name}: ${error.message}`);
            }
            this.painting = setTimeout(() => this.paint(), 25);
        }
    }

    /** The first, the middle and the last pose, side by side. */
    picture(canvas, thumbnail, body, theme) {
        const parts = [], r = body.reach, last = thumbnail.angle_deg.length - 1;
        const chosen = [...new Set([0, Math.round(last / 2), last])], n = chosen.length;
        const gap = r * 0.7, yaw = 0.5;
        chosen.forEach((from, i) => {
            const q = thumbnail.angle_deg[from].map((v) => v === null ? 0 : v * DEG);
            const root = thumbnail.root ? this.app.toMatrix(thumbnail.root[from]) : stand(body, q);
            const at = forward(body, q, root), move = (i - (n - 1) / 2) * gap;
            const [x, y] = [at[0][12], at[0][13]];
            const k = 0.35 + 0.65 * (i + 1) / n;
            const colour = theme.part.map((v, c) => c < 3 ? theme.card[c] + (v - theme.card[c]) * k : 1);
            body.links.forEach((link, l) => {
                const here = at[l].slice();
                here[12] -= x + move * Math.sin(yaw);
                here[13] -= y - move * Math.cos(yaw);
                parts.push({ solid: link.solid, at: here, colour });
            });
        });
        const camera = new Camera();
        camera.yaw = yaw;
        camera.pitch = 0.12;
        const aspect = canvas.width / canvas.height, { low, high } = this.app.figure;
        const wide = gap * (n - 1) + r * 0.85, tall = (high[2] - low[2]) * 1.12;
        camera.place([0, 0, (low[2] + high[2]) / 2], Math.max(tall, wide / aspect) / 2 /
                                                     Math.tan(15 * DEG), aspect);
        makeFlat(canvas).draw({ parts, flats: [], lines: [], tops: [] }, camera);
    }

    async choose(name) {
        this.name = name;
        this.at = 0;
        this.look = null;
        this.previewing = false;
        this.pictures.forEach(({ file, button }) => button.setAttribute('aria-pressed',
                                                                        String(file.name === name)));
        await this.load();
    }

    /** What would be played, with its check and balance. */
    async load() {
        const name = this.name, { mirror, speed_pct: pct } = this.options();
        if (!name) {
            return;
        }
        try {
            const look = await this.app.api.post('/api/preview', { motion: name, mirror, speed_pct: pct });
            if (name === this.name) {
                this.look = { ...look, name, pct };
                this.at = Math.min(this.at, look.length_ms);
            }
        } catch (error) {
            this.app.fail(error);
        }
        this.stripKey = null;
        this.app.schedule();
    }

    playOrPause() {
        const live = this.live();
        if (!live) {
            this.previewing = false;
            this.app.command('/api/play', { motion: this.name, ...this.options(),
                                            on_lost: this.app.onLost() }, true);
        } else if (live.state === 'paused') {
            this.app.command('/api/resume', {}, true);
        } else {
            this.app.command('/api/pause');
        }
    }

    /** Space pauses, and never begins anything. */
    space() {
        const live = this.live();
        if (live && live.state !== 'paused' && this.app.mayMove()) {
            this.app.command('/api/pause');
        } else if (this.previewing) {
            this.togglePreview();
        }
    }

    togglePreview() {
        this.previewing = !this.previewing;
        this.beganAt = performance.now() - (this.at >= this.length() - 1 ? 0 : this.at);
        this.app.schedule();
    }

    length() {
        const live = this.live();
        return live ? live.total_ms : this.look ? this.look.length_ms : 0;
    }

    seeked() {
        const ms = Number(this.id('seek').value);
        this.dragging = performance.now() + 1500;
        this.at = ms;
        this.previewing = false;
        if (this.live() && this.app.mayMove()) {
            this.seek.push({ t_ms: ms, sequence: this.app.drawn });
        }
        this.app.schedule();
    }

    sped() {
        const pct = Number(this.id('speed').value);
        if (this.live() && this.app.mayMove()) {
            this.speed.push({ speed_pct: pct, sequence: this.app.drawn });
        }
        clearTimeout(this.later);
        this.later = setTimeout(() => this.load(), 250);
        this.app.schedule();
    }

    /** The ghost: where a playing motion is, or the pose of the preview. */
    ghost(toMatrix) {
        const live = this.live();
        if (live) {
            return live.ghost_deg && { q: live.ghost_deg.map((v) => v === null ? NaN : v * DEG) };
        }
        if (!this.look || !hasPoses(this.look.frames) || document.body.dataset.tab !== 'play' || this.at <= 0 && !this.previewing) {
            return null;
        }
        const pose = sample(this.look.frames, this.at, toMatrix);
        const falls = this.look.check.falls_ms, fell = falls !== null && this.at >= falls;
        return { ...pose, preview: true, bad: fell, note: fell
            ? this.app.t('would fall at {0} s', seconds(falls)) : this.app.t('preview') };
    }

    draw(now) {
        const live = this.live();
        if (live && live.motion && live.motion !== this.name &&
            this.files.some((f) => f.name === live.motion)) {
            this.choose(live.motion);
        }
        if (this.previewing && this.look && !live) {
            this.at = now - this.beganAt;
            if (this.at > this.look.length_ms) {
                if (this.id('loop').checked) {
                    this.beganAt = now;
                } else {
                    this.previewing = false;
                    this.at = this.look.length_ms;
                }
            }
            this.app.schedule();
        }
        this.write(live, now);
        this.strip();
    }

    write(live, now) {
        const t = this.app.t, may = this.app.mayMove(), length = this.length();
        this.id('transport').hidden = !(live || this.name && document.body.dataset.tab !== 'make');
        if (live && !(this.dragging > now)) {
            this.at = live.t_ms;
            this.previewing = false;
        }
        const seek = this.id('seek');
        if (Number(seek.max) !== length) {
            seek.max = Math.max(1, length);
        }
        if (!(this.dragging > now)) {
            seek.value = this.at;
        }
        seek.disabled = Boolean(live) && !may || !length;
        seek.setAttribute('aria-valuetext', t('{0} of {1} seconds', seconds(this.at), seconds(length)));
        setText(this.id('now-time'), `${seconds(this.at)} / ${seconds(length)} s`);
        setText(this.id('now-name'), (live ? live.motion : this.name) || '');
        setText(this.id('now-state'), live ? t(live.state) + this.more(live)
            : this.previewing ? t('preview, the robot does not move')
            : this.at > 0 ? t('ghost only') : t('ready'));
        const refused = this.look && this.look.check.refused;
        setText(this.id('play'), live ? live.state === 'paused' ? `▶ ${t('Resume')}` : `❚❚ ${t('Pause')}`
                                      : `▶ ${t('Play')}`);
        this.id('play').disabled = !may || !live && (!this.look || Boolean(refused));
        setText(this.id('preview'), this.previewing ? `❚❚ ${t('Preview')}` : `▷ ${t('Preview')}`);
        this.id('preview').disabled = !this.look || !hasPoses(this.look.frames);
        this.id('preview').hidden = Boolean(live);
        for (const name of ['queue', 'halt']) {
            this.id(name).hidden = !live;
            this.id(name).disabled = !may;
        }
        const speed = this.id('speed');
        if (live && document.activeElement !== speed && Number(speed.value) !== live.speed_pct) {
            speed.value = live.speed_pct;
        }
        setText(this.id('speed-text'), `${speed.value} %`);
        speed.setAttribute('aria-valuetext', `${speed.value} %`);
        this.verdict(live, refused);
    }

    more(live) {
        const t = this.app.t, out = [];
        if (live.loop) {
            out.push(t('loop'));
        } else if (live.passes > 1) {
            out.push(`${live.pass}/${live.passes}`);
        }
        if (live.mirror) {
            out.push(t('mirrored'));
        }
        if (live.queue.length) {
            out.push(t('then {0}', live.queue.join(', ')));
        }
        return out.length ? ` · ${out.join(' · ')}` : '';
    }

    verdict(live, refused) {
        const t = this.app.t, node = this.id('verdict'), check = this.look && this.look.check;
        let level = '', words = '';
        if (refused) {
            [level, words] = ['bad', refusal(refused, t)];
        } else if (check && check.falls_ms !== null) {
            [level, words] = ['bad', t('▲ would fall at {0} s', seconds(check.falls_ms))];
        } else if (check && check.message) {
            [level, words] = [check.warnings || check.errors ? 'warn' : 'ok', check.message];
        } else if (check) {
            [level, words] = check.warnings || check.errors
                ? ['warn', [t('▲ {0} warnings', check.warnings + check.errors),
                            firstOf(this.look.diagnostics)].filter(Boolean).join(': ')]
                : ['ok', t('✓ stays within limits and balance')];
        }
        const why = !live && this.app.whyNot();
        setText(node, words + (why ? `${words ? ' · ' : ''}${why}` : ''));
        node.className = level;
    }

    /** The time line: how far the ZMP is inside the soles, and where it is not. */
    strip() {
        const canvas = this.id('track').querySelector('canvas'), theme = this.app.css;
        const w = canvas.clientWidth, h = canvas.clientHeight, look = this.look;
        const key = JSON.stringify([w, h, look && look.name, this.app.themeName, look && look.pct]);
        if (key === this.stripKey || !w || !theme) {
            return;
        }
        this.stripKey = key;
        const scale = Math.min(window.devicePixelRatio || 1, 2), pen = canvas.getContext('2d');
        canvas.width = w * scale;
        canvas.height = h * scale;
        pen.setTransform(scale, 0, 0, scale, 0, 0);
        const inset = 11, x = (ms) => inset + (w - 2 * inset) * ms / Math.max(1, look ? look.length_ms : 1);
        pen.fillStyle = theme.grid;
        pen.fillRect(inset, h - 3, w - 2 * inset, 2);
        if (look && look.balance) {
            this.margins(pen, look.balance, x, h, theme);
        }
        if (look && look.check.falls_ms !== null) {
            const at = x(look.check.falls_ms), words = this.app.t('falls at {0} s', seconds(look.check.falls_ms));
            pen.fillStyle = theme.danger;
            pen.fillRect(at - 1, 0, 2, h);
            pen.font = '600 11px system-ui, sans-serif';
            pen.textAlign = at > w * 0.7 ? 'right' : 'left';
            pen.fillText(words, at + (at > w * 0.7 ? -6 : 6), 10);
        }
    }

    margins(pen, balance, x, h, theme) {
        const most = Math.max(10, ...balance.margin_mm.filter((v) => v !== null));
        pen.beginPath();
        pen.moveTo(x(balance.time_ms[0] || 0), h - 2);
        balance.time_ms.forEach((ms, n) => pen.lineTo(x(ms), h - 2 - Math.max(0, balance.margin_mm[n] || 0) /
                                                                    most * (h - 16)));
        pen.lineTo(x(balance.time_ms[balance.time_ms.length - 1] || 0), h - 2);
        pen.fillStyle = theme.good;
        pen.globalAlpha = 0.28;
        pen.fill();
        pen.globalAlpha = 1;
        for (const finding of balance.findings) {
            const from = x(finding.begin_ms), to = Math.max(from + 3, x(finding.end_ms));
            const outside = finding.problem !== 'zmp_margin' || finding.worst < 0;
            pen.strokeStyle = outside ? theme.danger : theme.warn;
            pen.save();
            pen.beginPath();
            pen.rect(from, h - 14, to - from, 13);
            pen.clip();
            pen.lineWidth = 1.5;
            for (let at = from - 14; at < to; at += 5) { // hatched: not by colour alone
                pen.beginPath();
                pen.moveTo(at, h);
                pen.lineTo(at + 14, h - 14);
                pen.stroke();
            }
            pen.restore();
        }
    }
}
