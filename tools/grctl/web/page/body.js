// SPDX-License-Identifier: MIT
// The robot as rigid links: where they are at given angles, where the mass is, what it stands on,
// and solids to draw them by. Lengths are metres, angles radians, masses kilograms. A robot without
// links is drawn as rows of pointers, one a joint.

import * as m from './mat.js';
import { box, hub, strut } from './shape.js';

/** Rows of pointers for a robot of which only the joints are known. */
function pointers(joints) {
    const gap = 0.07, wide = Math.ceil(Math.sqrt(joints.length * 1.4));
    const rows = Math.ceil(joints.length / wide);
    const links = [{ name: 'base', parent: -1, joint: -1, axis: [0, 0, 1], frame: m.identity(),
                     mass: 0, com: [0, 0, 0],
                     half: [(rows - 1) * gap / 2 + 0.03, (wide - 1) * gap / 2 + 0.03, 0.005] }];
    joints.forEach((joint, n) => {
        const x = Math.floor(n / wide) - (rows - 1) / 2, y = n % wide - (wide - 1) / 2;
        links.push({ name: joint.name, parent: 0, joint: n, axis: [0, 1, 0], mass: 0,
                     frame: m.translation([-x * gap, -y * gap, 0.03]), com: [0, 0, 0.016],
                     half: [0.006, 0.006, 0.022] });
    });
    return links;
}

/** Half lengths of the uniform box that has a link's inertia; null: none is known. */
export function inertiaBox(mass, inertia) {
    if (!inertia || !(mass > 0)) {
        return null;
    }
    const diagonal = inertia.length === 9 ? [inertia[0], inertia[4], inertia[8]] : inertia;
    const sum = diagonal[0] + diagonal[1] + diagonal[2];
    if (!(sum > 0)) {
        return null;
    }
    return diagonal.map((own) => Math.sqrt(Math.max(6 / mass * (sum - 2 * own), 1.6e-5)) / 2);
}

/** The same where only the mass and its centre are known: a cube as dense as servos are. */
function massBox(link, body) {
    const side = Math.cbrt(link.mass / 900) / 2;
    return body.known && link.mass > 0 && m.length(link.com) > 1e-6 ? [side, side, side] : null;
}

/**
 * A body from links { name, parent, joint, axis, frame, mass, com, inertia? }, parents first, and
 * feet { link, sole, half }.
 */
export function makeBody(links, feet, joints) {
    const known = links.length > 0;
    const body = { links: known ? links : pointers(joints), feet: known ? feet : [], ground: 0,
                   known };
    body.linkOf = joints.map((_, n) => body.links.findIndex((l) => l.joint === n));
    const zero = forward(body, new Array(joints.length).fill(0));
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    body.links.forEach((link, n) => {
        for (const p of [m.origin(zero[n]), m.place(zero[n], link.com)]) {
            for (let i = 0; i < 3; i++) {
                low[i] = Math.min(low[i], p[i]);
                high[i] = Math.max(high[i], p[i]);
            }
        }
    });
    body.reach = Math.max(m.length(m.sub(high, low)), 0.05);
    body.thick = known ? body.reach * 0.028 : 0.009;
    solids(body);
    body.ground = body.feet.length ? 0 : lowest(body, zero);
    return body;
}

/** Gives each link its polygons, and each joint its hub. */
function solids(body) {
    const children = body.links.map(() => []);
    body.links.forEach((link, n) => {
        if (link.parent >= 0) {
            children[link.parent].push(n);
        }
    });
    const bevel = body.thick * 0.35;
    const feet = new Map(body.feet.map((foot) => [foot.link, foot]));
    body.links.forEach((link, n) => {
        const half = link.half || inertiaBox(link.mass, link.inertia) || massBox(link, body);
        link.solid = [];
        if (half) {
            const foot = feet.get(n);
            if (foot) { // down to the sole, so that the foot stands on the ground and not above
                const low = foot.sole[2], high = Math.max(link.com[2] + half[2], low + 0.004);
                const centre = [foot.sole[0], foot.sole[1], (low + high) / 2];
                link.solid.push(...box([foot.half[0] * 1.1, foot.half[1] * 1.1, (high - low) / 2],
                                       bevel, m.translation(centre)));
            } else {
                link.solid.push(...box(half, bevel, m.translation(link.com)));
            }
        }
        const thick = half ? body.thick * 0.35 : body.thick;
        for (const child of children[n]) {
            const to = m.origin(body.links[child].frame);
            if (m.length(to) > body.thick * (half ? 0.6 : 1.2) && body.known) {
                link.solid.push(...strut([0, 0, 0], to, thick));
            }
        }
        if (!half && link.parent < 0) {
            link.solid.push(...box([1.9, 1.6, 0.7].map((k) => k * body.thick), bevel));
        } else if (!half && children[n].length === 0) {
            const to = m.length(link.com) > body.thick ? link.com : fingertip(body, link);
            link.solid.push(...strut([0, 0, 0], to, thick * 0.6));
        }
    });
    body.links.forEach((link) => {
        link.hub = link.joint < 0 ? [] : servo(body, link);
    });
}

/** The servo of a joint: a disc on its axis, long enough to be seen on both sides of its links. */
function servo(body, link) {
    const most = body.thick * 3, ends = [body.thick, body.thick];
    const parent = link.parent < 0 ? null : body.links[link.parent];
    const back = m.rigidInverse(link.frame);
    const solids = [link.solid, ...parent ? [parent.solid.map(({ points, normal }) => ({
        points: points.map((p) => m.place(back, p)), normal: m.turn(back, normal) }))] : []];
    for (const { points, normal } of solids.flat()) {
        const slope = m.dot(link.axis, normal);
        const t = Math.abs(slope) < 1e-9 ? Infinity : m.dot(points[0], normal) / slope;
        if (Math.abs(t) < most && inside(m.scale(link.axis, t), points, normal)) {
            ends[t > 0 ? 0 : 1] = Math.max(ends[t > 0 ? 0 : 1], Math.abs(t));
        }
    }
    const middle = m.scale(link.axis, (ends[0] - ends[1]) / 2);
    return hub(middle, link.axis, body.thick * 1.1, (ends[0] + ends[1]) / 2 + body.thick * 0.16);
}

/** Whether a point of a polygon's plane is inside it; its corners go round anticlockwise. */
export function inside(p, points, normal) {
    return points.every((from, n) => {
        const edge = m.sub(points[(n + 1) % points.length], from);
        return m.dot(m.cross(edge, m.sub(p, from)), normal) >= 0;
    });
}

/** Where the last link of a chain may point to: on as its parent does, across its own axis. */
function fingertip(body, link) {
    const back = m.origin(m.rigidInverse(link.frame));
    const flat = m.sub(back, m.scale(link.axis, m.dot(back, link.axis)));
    const to = m.length(flat) > 1e-4 ? m.scale(m.unit(flat), -1) : m.normalTo(link.axis);
    return m.scale(to, body.thick * 4);
}

/** Where every link is in the world. @param root of the root link; null: as the table puts it */
export function forward(body, q, root = null) {
    const at = [];
    for (const link of body.links) {
        let here = link.parent < 0 ? root || m.mul(m.translation([0, 0, -body.ground]), link.frame)
                                   : m.mul(at[link.parent], link.frame);
        if (link.joint >= 0 && q[link.joint]) {
            here = m.mul(here, m.rotation(link.axis, q[link.joint]));
        }
        at.push(here);
    }
    return at;
}

function lowest(body, at) {
    let z = Infinity;
    body.links.forEach((link, n) => {
        for (const { points } of link.solid) {
            for (const p of points) {
                z = Math.min(z, m.place(at[n], p)[2]);
            }
        }
    });
    return z === Infinity ? 0 : z;
}

/** The corners of a sole in the world. */
function sole(foot, at) {
    const [x, y] = foot.half, [cx, cy, cz] = foot.sole;
    return [[x, y], [-x, y], [-x, -y], [x, -y]].map(
        ([dx, dy]) => m.place(at[foot.link], [cx + dx, cy + dy, cz]));
}

/**
 * The root of a body that stands, as the server puts it: the sole of the lower foot lies flat on the
 * ground, its middle below where it is with straight legs.
 */
export function stand(body, q) {
    if (body.feet.length < 2) {
        return null;
    }
    const loose = forward(body, q, m.identity()), straight = forward(body, [], m.identity());
    const roots = body.feet.map((foot) => {
        const root = m.rigidInverse(m.mul(loose[foot.link], m.translation(foot.sole)));
        const depth = Math.min(...body.feet.map((other) => Math.min(
            ...sole(other, loose).map((p) => m.place(root, p)[2]))));
        return { root, depth, foot };
    });
    const { root, foot } = roots[0].depth >= roots[1].depth - 1e-4 ? roots[0] : roots[1];
    const [x, y] = m.place(straight[foot.link], foot.sole);
    return m.mul(m.translation([x, y, 0]), root);
}
