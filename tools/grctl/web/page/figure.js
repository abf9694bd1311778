// SPDX-License-Identifier: MIT
// The figure: what of the robot is drawn, in which colours, from where it is seen. It draws only when
// something that it shows has changed. The renderer is gl.js, or flat.js where there is no WebGL.

import * as m from './mat.js';
import { forward, inside, stand } from './body.js';
import { ball } from './shape.js';
import { makeGl } from './gl.js';
import { makeFlat } from './flat.js';

const FOV = 30 * m.DEG;
const GHOST_DEG = 2.5; // a target that is nearer to the joint than this needs no ghost
const HOME = { yaw: 0.62, pitch: 0.22 };

export function mix(a, b, k) {
    return [0, 1, 2].map((i) => a[i] + (b[i] - a[i]) * k).concat(1);
}

/** [r, g, b, a] of a CSS colour written #rrggbb. */
export function fromHex(hex) {
    const n = parseInt(hex.trim().slice(1), 16);
    return [(n >> 16) / 255, (n >> 8 & 255) / 255, (n & 255) / 255, 1];
}

export class Camera {
    constructor() {
        this.yaw = HOME.yaw;
        this.pitch = HOME.pitch;
        this.zoom = 1;
        this.pan = [0, 0, 0];
    }

    /**
     * @param low, high the box to be seen whole
     * @param room ( top, bottom ) what is covered, as parts of the height
     */
    look(low, high, aspect, room) {
        const middle = m.scale(m.add(low, high), 0.5);
        const r = m.length(m.sub(high, low)) / 2;
        const fill = Math.min(1 - room.top - room.bottom, aspect * 1.1);
        this.place(middle, r * 0.86 / Math.sin(FOV / 2) / fill, aspect, room.bottom - room.top);
    }

    place(middle, distance, aspect, shift = 0) {
        this.shift = shift;
        this.distance = distance / this.zoom;
        const c = Math.cos(this.pitch);
        const back = [Math.cos(this.yaw) * c, Math.sin(this.yaw) * c, Math.sin(this.pitch)];
        const centre = m.add(middle, this.pan);
        this.eye = m.add(centre, m.scale(back, this.distance));
        this.back = back;
        const view = m.lookAt(this.eye, centre, [0, 0, 1]);
        const lens = m.perspective(FOV, aspect, this.distance * 0.05, this.distance * 8);
        this.matrix = m.mul(m.mul(m.translation([0, shift, 0]), lens), view);
    }

    orbit(dx, dy) {
        this.yaw -= dx;
        this.pitch = Math.max(-0.3, Math.min(1.5, this.pitch + dy));
    }

    closer(factor) {
        this.zoom = Math.max(0.3, Math.min(8, this.zoom * factor));
    }

    /** Moves what is looked at, by pixels of a canvas that is `height` high. */
    slide(dx, dy, height) {
        const k = 2 * this.distance * Math.tan(FOV / 2) / height;
        const right = m.unit(m.cross([0, 0, 1], this.back)), up = m.cross(this.back, right);
        this.pan = m.add(this.pan, m.add(m.scale(right, -dx * k), m.scale(up, dy * k)));
    }

    home() {
        Object.assign(this, HOME, { zoom: 1, pan: [0, 0, 0] });
    }
}

/** Distance along the ray to a convex polygon; Infinity: beside it. */
function hit(from, along, points, normal) {
    const slope = m.dot(along, normal);
    if (slope > -1e-9) {
        return Infinity;
    }
    const t = m.dot(m.sub(points[0], from), normal) / slope;
    return t > 0 && inside(m.add(from, m.scale(along, t)), points, normal) ? t : Infinity;
}

/** A flat ring, as triangles. */
function ring(centre, x, y, inner, outer, from = 0, to = 2 * Math.PI) {
    const out = [], n = Math.max(4, Math.ceil(Math.abs(to - from) / 0.2));
    const at = (r, i) => {
        const a = from + (to - from) * i / n;
        return m.add(centre, m.add(m.scale(x, r * Math.cos(a)), m.scale(y, r * Math.sin(a))));
    };
    for (let i = 0; i < n; i++) {
        out.push(at(inner, i), at(outer, i), at(outer, i + 1), at(inner, i), at(outer, i + 1),
                 at(inner, i + 1));
    }
    return out;
}

/** A line on the ground of some width, as triangles. */
function band(a, b, width) {
    const along = m.unit(m.sub(b, a)), side = m.scale([-along[1], along[0], 0], width / 2);
    const p = [m.add(a, side), m.sub(a, side), m.sub(b, side), m.add(b, side)];
    return [p[0], p[1], p[2], p[0], p[2], p[3]];
}

export class Figure {
    /**
     * @param host the element that holds the canvas and the labels
     * @param options ( flat: never use WebGL, onPick: called with a joint or -1, onTouch: called when
     * there is something to draw, onGrab: called with a point that is pressed, and whether by a finger,
     * answers what it moves ( move, end ) or null, above, below: elements that cover the figure )
     */
    constructor(host, options) {
        this.host = host;
        this.options = options;
        this.camera = new Camera();
        this.pose = null;
        this.ghost = null;
        this.selected = -1;
        this.labels = host.querySelector('.labels');
        this.dirty = true;
        this.frames = 0;
        this.makeCanvas(!options.flat);
        new ResizeObserver(() => this.touch()).observe(host);
    }

    makeCanvas(webgl) {
        const old = this.host.querySelector('canvas'), canvas = old.cloneNode(false);
        old.replaceWith(canvas);
        this.canvas = canvas;
        try {
            /** @type {any} */
            this.renderer = webgl ? makeGl(canvas) : null;
        } catch (error) {
            console.warn(`figure: WebGL failed: ${error.message}`);
            this.renderer = null;
            return this.makeCanvas(false);
        }
        this.flat = !this.renderer;
        this.renderer = this.renderer || makeFlat(canvas);
        canvas.dataset.renderer = this.flat ? '2d' : 'webgl';
        canvas.addEventListener('webglcontextlost', (event) => {
            event.preventDefault();
            this.makeCanvas(false);
        });
        this.listen(canvas);
        this.touch();
        return undefined;
    }

    /** @param theme colours by name, each [r, g, b, a] */
    setTheme(theme) {
        this.theme = theme;
        this.touch();
    }

    setBody(body) {
        this.body = body;
        this.renderer.forget();
        const r = body.reach, zero = forward(body, [], stand(body, []));
        this.low = [-r * 0.25, -r * 0.25, 0];
        this.high = [r * 0.25, r * 0.25, 0];
        zero.forEach((t, n) => body.links[n].solid.forEach(({ points }) => points.forEach((q) => {
            const p = m.place(t, q);
            for (let i = 0; i < 3; i++) {
                this.low[i] = Math.min(this.low[i], p[i]);
                this.high[i] = Math.max(this.high[i], p[i]);
            }
        })));
        this.grid = this.makeGrid();
        this.ballSolid = ball([0, 0, 0], r * 0.022);
        this.touch();
    }

    makeGrid() {
        const steps = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5];
        const step = steps.find((s) => s >= this.body.reach / 8) || 1;
        const n = 14, points = [], fade = [];
        for (let i = -n; i <= n; i++) {
            for (let j = -n; j < n; j++) {
                for (const [a, b] of [[[i, j], [i, j + 1]], [[j, i], [j + 1, i]]]) {
                    points.push([a[0] * step, a[1] * step, 0], [b[0] * step, b[1] * step, 0]);
                    fade.push(...[a, b].map((p) => Math.max(0, 1 - Math.hypot(...p) / n) ** 1.5));
                }
            }
        }
        return { points, fade };
    }

    /**
     * @param pose ( q: radians by joint (NaN: unknown), root, looks: by joint ( colour, tint, shape,
     * note ), faded, balance: ( com, zmp, support, inside ), draft: it is drawn and not the robot,
     * handles: ( link, chosen ) of a draft )
     */
    setPose(pose, ghost) {
        const key = JSON.stringify([pose.q.map((q) => Math.round(q * 2000)), pose.looks, pose.faded,
                                    pose.balance, ghost && ghost.q.map((q) => Math.round(q * 2000)),
                                    ghost && ghost.bad, ghost && ghost.note, pose.draft, pose.handles,
                                    pose.draft && pose.root]);
        if (key !== this.key) {
            this.key = key;
            this.pose = pose;
            this.ghost = ghost;
            this.touch();
        }
    }

    select(joint) {
        this.selected = joint;
        this.touch();
    }

    touch() {
        this.dirty = true;
        if (this.options.onTouch) {
            this.options.onTouch();
        }
    }

    /** Draws if something changed. @returns whether it drew */
    draw() {
        if (!this.dirty || !this.body || !this.theme || !this.pose) {
            return false;
        }
        const scale = Math.min(window.devicePixelRatio || 1, 2);
        const w = Math.round(this.host.clientWidth * scale);
        const h = Math.round(this.host.clientHeight * scale);
        if (w < 2 || h < 2) {
            return false;
        }
        if (this.canvas.width !== w || this.canvas.height !== h) {
            this.canvas.width = w;
            this.canvas.height = h;
        }
        this.dirty = false;
        const part = (pixels) => Math.min(0.25, pixels / this.host.clientHeight);
        this.camera.look(this.low, this.high, w / h, {
            top: part(this.options.above.offsetHeight + 14),
            bottom: part(this.options.below.offsetHeight + 14) });
        this.renderer.draw(this.scene(), this.camera);
        this.writeLabels();
        this.frames++;
        return true;
    }

    known(q) {
        return q.map((a) => Number.isFinite(a) ? a : 0);
    }

    scene() {
        const { body, theme, pose } = this;
        const q = this.known(pose.q);
        this.at = forward(body, q, pose.root || stand(body, q));
        const parts = [], scene = { parts, flats: [], lines: [], tops: [], shadow: theme.shadow };
        body.links.forEach((link, n) => {
            const look = pose.looks[link.joint];
            let colour = link.joint < 0 || !look ? theme.part : mix(theme.part, look.colour, look.tint);
            if (pose.draft) {
                colour = mix(colour, theme.accent, 0.34);
            }
            if (pose.faded || look && look.unknown) {
                colour = mix(colour, theme.faded, 0.75);
            }
            parts.push({ solid: link.solid, at: this.at[n], colour, joint: link.joint });
            if (link.joint >= 0 && look) {
                this.addHub(parts, link, n, look);
            }
        });
        scene.lines.push({ below: true, points: this.grid.points,
                           colours: this.grid.fade.map((f) => [...theme.grid.slice(0, 3), f * 0.7]) });
        if (pose.balance && !pose.faded) {
            this.addBalance(scene, pose.balance);
        }
        this.addGhost(parts);
        for (const { link, chosen } of pose.handles || []) {
            const big = chosen ? 1.7 : 1.25, size = [big, 0, 0, 0, 0, big, 0, 0, 0, 0, big, 0, 0, 0, 0, 1];
            parts.push({ solid: this.ballSolid, at: m.mul(m.translation(m.origin(this.at[link])), size),
                         colour: mix(theme.accent, theme.text, chosen ? 0.55 : 0), joint: -1, flat: 0.4,
                         through: true });
        }
        if (this.selected >= 0) {
            this.addArc(scene);
        }
        return scene;
    }

    /** The servo tells torque by its size too: full with torque, small without. */
    addHub(parts, link, n, look) {
        const { theme, pose } = this;
        const chosen = link.joint === this.selected;
        const k = { on: 1, off: 0.62, brake: 0.8 }[look.shape] || 0.62;
        const z = link.axis, x = m.normalTo(z), y = m.cross(z, x);
        const axes = m.fromAxes(x, y, z, [0, 0, 0]);
        const size = [k, 0, 0, 0, 0, k, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
        const shape = m.mul(axes, m.mul(size, m.rigidInverse(axes)));
        const faded = pose.faded || look.unknown;
        const colour = chosen ? theme.accent : faded ? theme.faded : look.colour;
        parts.push({ solid: link.hub, at: m.mul(this.at[n], shape), colour, joint: link.joint,
                     flat: chosen ? 0.4 : 0.15 });
    }

    addGhost(parts) {
        const { body, ghost, pose, theme } = this;
        if (!ghost || pose.faded && !ghost.preview) {
            this.ghostAt = null;
            return;
        }
        const q = ghost.q.map((a, n) => Number.isFinite(a) ? a : this.known(pose.q)[n]);
        const off = q.some((a, n) => Math.abs(a - (pose.q[n] || 0)) > GHOST_DEG * m.DEG);
        this.ghostAt = off || ghost.preview
            ? forward(body, q, ghost.root || pose.root && !ghost.preview && pose.root || stand(body, q))
            : null;
        if (this.ghostAt) {
            const base = ghost.bad ? theme.danger : ghost.preview ? theme.accent : theme.ghost;
            const colour = [...base.slice(0, 3), ghost.preview ? 0.5 : 0.34];
            body.links.forEach((link, n) => {
                if (ghost.preview || this.apart(n)) {
                    parts.push({ solid: link.solid, at: this.ghostAt[n], colour, ghost: true });
                }
            });
        }
    }

    /** Whether the ghost of a link is far enough from it to be worth drawing. */
    apart(n) {
        const r = this.body.reach;
        return [[0, 0, 0], [r / 8, 0, 0], [0, r / 8, 0], [0, 0, r / 8]].some((p) => m.length(
            m.sub(m.place(this.at[n], p), m.place(this.ghostAt[n], p))) > r * 0.012);
    }

    addBalance(scene, balance) {
        const { theme, body } = this, z = body.reach * 0.002, wide = body.reach * 0.008;
        const { com, zmp, support } = balance;
        const edge = balance.inside ? theme.good : theme.danger;
        const up = (p) => [p[0], p[1], z];
        for (let n = 2; n < support.length; n++) {
            scene.flats.push({ points: [support[0], support[n - 1], support[n]].map(up),
                               colour: [...edge.slice(0, 3), 0.16] });
        }
        support.forEach((p, n) => scene.flats.push({
            points: band(up(p), up(support[(n + 1) % support.length]), wide), colour: edge }));
        for (const sole of balance.soles) {
            const c = sole.corners;
            c.forEach((p, n) => scene.lines.push({
                below: true, points: [p, c[(n + 1) % 4]].map((a) => [a[0], a[1], Math.max(a[2], z)]),
                colour: [...theme.text.slice(0, 3), sole.standing ? 0.8 : 0.3] }));
        }
        const x = [1, 0, 0], y = [0, 1, 0], r = body.reach * 0.03;
        if (com) {
            const foot = [com[0], com[1], z * 2];
            scene.parts.push({ solid: this.ballSolid, at: m.translation(com), colour: theme.com,
                               joint: -1, flat: 0.3, through: true });
            scene.lines.push({ points: [com, foot], colour: theme.com });
            scene.tops.push({ points: ring(foot, x, y, r * 0.65, r), colour: theme.com });
        }
        if (zmp) {
            const c = [zmp[0], zmp[1], z * 2], s = r * 1.05;
            for (const d of [[1, 1], [1, -1]]) {
                const v = m.scale([d[0], d[1], 0], s * 0.75);
                scene.tops.push({ points: band(m.sub(c, v), m.add(c, v), r * 0.36),
                                  colour: theme.zmp });
            }
        }
    }

    /** Of the chosen joint: the way between its limits, where it is, where it shall be. */
    addArc(scene) {
        const { body, pose, theme } = this, n = body.linkOf[this.selected];
        const look = pose.looks[this.selected];
        if (n < 0 || !look || !look.limits) {
            return;
        }
        const link = body.links[n], parent = link.parent < 0 ? m.identity() : this.at[link.parent];
        const base = m.mul(parent, link.frame), centre = m.origin(base);
        const axis = m.turn(base, link.axis);
        const tip = body.links.reduce((best, l) => l.parent === n && m.length(m.origin(l.frame)) >
            m.length(best) ? m.origin(l.frame) : best, link.com);
        const flat = m.sub(tip, m.scale(link.axis, m.dot(tip, link.axis)));
        const x = m.turn(base, m.length(flat) > 1e-4 ? m.unit(flat) : m.normalTo(link.axis));
        const y = m.cross(axis, x), r = body.reach * 0.19;
        const [low, high] = look.limits.map((d) => d * m.DEG);
        const fill = ring(centre, x, y, r * 0.35, r, low, high);
        scene.tops.push({ points: fill, colour: [...theme.accent.slice(0, 3), 0.16] });
        scene.tops.push({ points: ring(centre, x, y, r * 0.97, r * 1.02, low, high),
                          colour: theme.accent });
        const needle = (a, from, to, wide, colour) => scene.tops.push({
            points: ring(centre, x, y, r * from, r * to, a - wide, a + wide), colour });
        needle(low, 0.8, 1.12, 0.022, theme.danger);
        needle(high, 0.8, 1.12, 0.022, theme.danger);
        if (Number.isFinite(look.target)) {
            needle(look.target * m.DEG, 0.6, 1.1, 0.03, theme.ghost);
        }
        needle(pose.q[this.selected] || 0, 0.3, 1.06, 0.026, theme.text);
    }

    /** Words beside the joints that need some. */
    writeLabels() {
        const wanted = [];
        const say = (key, p, text, kind) => {
            const [x, y] = this.onScreen(p);
            wanted.push({ key, text, kind, x, y });
        };
        this.pose.looks.forEach((look, joint) => {
            const n = this.body.linkOf[joint];
            if (n >= 0 && (joint === this.selected || look.note && wanted.length < 8)) {
                say(joint, m.origin(this.at[n]), look.note && joint !== this.selected
                    ? `${look.name} ${look.note}` : `${look.name} ${look.text}`,
                    joint === this.selected ? 'chosen' : look.level);
            }
        });
        if (this.ghostAt && this.ghost.note) {
            say('ghost', m.add(m.origin(this.ghostAt[0]), [0, 0, this.body.reach * 0.6]),
                this.ghost.note, this.ghost.bad ? 'bad' : 'plain');
        }
        const top = this.options.above.offsetHeight + 34;
        for (const label of wanted) {
            label.y = Math.max(label.y, top);
        }
        wanted.sort((a, b) => a.y - b.y);
        wanted.forEach((label, n) => {
            for (const before of wanted.slice(0, n)) {
                if (Math.abs(before.x - label.x) < 150 && label.y - before.y < 24) {
                    label.y = before.y + 24;
                }
            }
        });
        while (this.labels.children.length > wanted.length) {
            this.labels.lastChild.remove();
        }
        wanted.forEach((label, n) => {
            let node = this.labels.children[n];
            if (!node) {
                node = document.createElement('span');
                this.labels.append(node);
            }
            node.textContent = label.text;
            node.className = label.kind;
            const width = this.host.clientWidth, wide = node.offsetWidth;
            const x = label.x < width / 2 ? label.x - 18 - wide : label.x + 18;
            const inside = Math.max(4, Math.min(width - wide - 4, x));
            node.style.transform = `translate(${Math.round(inside)}px, ${Math.round(label.y - 12)}px)`;
        });
    }

    /** Where a point of the world is on the canvas, in pixels of the page. */
    onScreen(p) {
        const c = m.project(this.camera.matrix, p);
        return [(c[0] / c[3] + 1) / 2 * this.host.clientWidth,
                (1 - c[1] / c[3]) / 2 * this.host.clientHeight];
    }

    /** How far a point of the world goes, in the plane of the picture, that goes so many pixels. */
    slideOf(p, dx, dy) {
        const { eye, back } = this.camera, right = m.unit(m.cross([0, 0, 1], back));
        const k = 2 * m.dot(m.sub(eye, p), back) * Math.tan(FOV / 2) / this.host.clientHeight;
        return m.add(m.scale(right, dx * k), m.scale(m.cross(back, right), -dy * k));
    }

    /** The joint under a point of the canvas, in pixels of the page; -1: none. */
    pick(x, y) {
        const { joint, point } = this.hitAt(x, y);
        return point ? joint : this.nearestHub(x, y, 22);
    }

    /** The joint of the link that is hit, -1 for none, and where it is hit; null: nothing is. */
    hitAt(x, y) {
        if (!this.at) {
            return { joint: -1, point: null };
        }
        const w = this.host.clientWidth, h = this.host.clientHeight;
        const fx = (x / w * 2 - 1) * Math.tan(FOV / 2) * w / h;
        const fy = (1 - y / h * 2 - this.camera.shift) * Math.tan(FOV / 2);
        const { eye, back } = this.camera;
        const right = m.unit(m.cross([0, 0, 1], back)), up = m.cross(back, right);
        const along = m.unit(m.add(m.scale(back, -1), m.add(m.scale(right, fx), m.scale(up, fy))));
        let best = { far: Infinity, joint: -1 };
        this.body.links.forEach((link, n) => {
            for (const { points, normal } of [...link.solid, ...link.hub]) {
                const far = hit(eye, along, points.map((p) => m.place(this.at[n], p)),
                                m.turn(this.at[n], normal));
                if (far < best.far) {
                    best = { far, joint: link.joint };
                }
            }
        });
        return { joint: best.joint, point: best.far < Infinity
            ? m.add(eye, m.scale(along, best.far)) : null };
    }

    nearestHub(x, y, within) {
        let best = { far: within, joint: -1 };
        this.body.linkOf.forEach((n, joint) => {
            if (n >= 0 && this.at) {
                const [cx, cy] = this.onScreen(m.origin(this.at[n]));
                const far = Math.hypot(cx - x, cy - y);
                best = far < best.far ? { far, joint } : best;
            }
        });
        return best.joint;
    }

    listen(canvas) {
        const down = new Map();
        let moved = 0, grip = null;
        const inside = (event) => {
            const box = canvas.getBoundingClientRect();
            return [event.clientX - box.left, event.clientY - box.top];
        };
        const drop = () => {
            if (grip) {
                grip.end();
                grip = null;
            }
        };
        canvas.addEventListener('pointerdown', (event) => {
            down.set(event.pointerId, [event.clientX, event.clientY]);
            canvas.setPointerCapture(event.pointerId);
            moved = down.size > 1 ? 99 : 0;
            drop();
            if (down.size === 1 && event.button === 0 && !event.shiftKey && this.options.onGrab) {
                grip = this.options.onGrab(...inside(event), event.pointerType === 'touch');
            }
        });
        canvas.addEventListener('pointermove', (event) => {
            const was = down.get(event.pointerId), now = [event.clientX, event.clientY];
            if (!was) {
                return;
            }
            const dx = now[0] - was[0], dy = now[1] - was[1];
            moved += Math.abs(dx) + Math.abs(dy);
            if (grip) {
                if (moved > 3) {
                    grip.move(...inside(event));
                }
            } else if (down.size === 2) {
                const other = [...down].find(([id]) => id !== event.pointerId)[1];
                const before = Math.hypot(was[0] - other[0], was[1] - other[1]);
                const after = Math.hypot(now[0] - other[0], now[1] - other[1]);
                this.camera.closer(after / Math.max(before, 1));
                this.camera.slide(dx / 2, dy / 2, canvas.clientHeight);
            } else if (event.shiftKey || event.buttons & 6) {
                this.camera.slide(dx, dy, canvas.clientHeight);
            } else if (moved > 3) {
                this.camera.orbit(dx * 0.009, dy * 0.007);
            }
            down.set(event.pointerId, now);
            this.touch();
        });
        const up = (event) => {
            const taken = grip && grip.taken;
            drop();
            if (down.delete(event.pointerId) && !taken && moved < 5 && event.type === 'pointerup') {
                this.options.onPick(this.pick(...inside(event)));
            }
        };
        canvas.addEventListener('pointerup', up);
        canvas.addEventListener('pointercancel', up);
        canvas.addEventListener('contextmenu', (event) => event.preventDefault());
        canvas.addEventListener('wheel', (event) => {
            event.preventDefault();
            this.camera.closer(Math.exp(-event.deltaY * 0.0012));
            this.touch();
        }, { passive: false });
        canvas.addEventListener('dblclick', () => this.home());
        canvas.addEventListener('keydown', (event) => this.onKey(event));
    }

    onKey(event) {
        const step = 0.12;
        const does = {
            ArrowLeft: () => this.camera.orbit(-step, 0), ArrowRight: () => this.camera.orbit(step, 0),
            ArrowUp: () => this.camera.orbit(0, step), ArrowDown: () => this.camera.orbit(0, -step),
            '+': () => this.camera.closer(1.15), '-': () => this.camera.closer(1 / 1.15),
            0: () => this.camera.home(),
        }[event.key];
        if (does && !event.ctrlKey && !event.metaKey && !event.altKey) {
            event.preventDefault();
            does();
            this.touch();
        }
    }

    home() {
        this.camera.home();
        this.touch();
    }
}
