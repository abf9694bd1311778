// SPDX-License-Identifier: MIT
// Solids as lists of flat polygons, { points, normal }: WebGL draws them as triangles, the 2-D
// canvas as paths. Sizes are metres, in the frame of the link.

import { add, cross, dot, identity, normalTo, place, scale, sub, turn, unit } from './mat.js';

function polygon(points, outward) {
    let normal = unit(cross(sub(points[1], points[0]), sub(points[2], points[0])));
    if (dot(normal, outward) < 0) {
        points.reverse();
        normal = scale(normal, -1);
    }
    return { points, normal };
}

/** A box about the frame's origin whose edges are cut off at bevel: 26 polygons. */
export function box(half, bevel, frame = identity()) {
    const b = Math.min(bevel, half[0] * 0.6, half[1] * 0.6, half[2] * 0.6);
    const out = [];
    const at = (x, y, z) => place(frame, [x, y, z]);
    const corner = (s, flat) => at(...[0, 1, 2].map((i) => s[i] * (half[i] - (i === flat ? 0 : b))));
    for (let i = 0; i < 3; i++) {
        const j = (i + 1) % 3, k = (i + 2) % 3;
        for (const si of [-1, 1]) {
            const sign = (sj, sk) => {
                const s = [0, 0, 0];
                s[i] = si;
                s[j] = sj;
                s[k] = sk;
                return s;
            };
            out.push(polygon([[-1, -1], [1, -1], [1, 1], [-1, 1]].map(
                (p) => corner(sign(...p), i)), turn(frame, sign(0, 0))));
            for (const sj of [-1, 1]) {
                out.push(polygon([corner(sign(sj, -1), i), corner(sign(sj, 1), i),
                                  corner(sign(sj, 1), j), corner(sign(sj, -1), j)],
                                 turn(frame, sign(sj, 0))));
            }
        }
    }
    for (let n = 0; n < 8; n++) {
        const s = [n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1];
        out.push(polygon([0, 1, 2].map((i) => corner(s, i)), turn(frame, s)));
    }
    return out;
}

/** A disc with a bevelled rim: a servo's horn. */
export function hub(centre, axis, radius, halfHeight, sides = 14) {
    const u = normalTo(axis), v = cross(axis, u);
    const inner = radius * 0.8, step = radius - inner;
    const ring = (r, h) => Array.from({ length: sides }, (_, n) => {
        const a = n / sides * 2 * Math.PI;
        return add(add(centre, scale(axis, h)),
                   add(scale(u, r * Math.cos(a)), scale(v, r * Math.sin(a))));
    });
    const levels = [ring(inner, -halfHeight), ring(radius, -halfHeight + step * 0.5),
                    ring(radius, halfHeight - step * 0.5), ring(inner, halfHeight)];
    const out = [polygon(levels[0].slice(), scale(axis, -1)), polygon(levels[3].slice(), axis)];
    for (let l = 0; l < 3; l++) {
        for (let n = 0; n < sides; n++) {
            const m = (n + 1) % sides;
            const points = [levels[l][n], levels[l][m], levels[l + 1][m], levels[l + 1][n]];
            out.push(polygon(points, add(sub(points[0], centre), sub(points[2], centre))));
        }
    }
    return out;
}

/** A strut between two points. */
export function strut(from, to, thickness) {
    const along = sub(to, from), z = unit(along), x = normalTo(z), y = cross(z, x);
    const mid = scale(add(from, to), 0.5);
    const frame = [...x, 0, ...y, 0, ...z, 0, ...mid, 1];
    const long = Math.sqrt(dot(along, along)) / 2 + thickness * 0.5;
    return box([thickness, thickness, long], thickness * 0.4, frame);
}

/** A ball of 8 * n * n triangles or so, coarse on purpose. */
export function ball(centre, radius) {
    const out = [];
    const bands = 6, sides = 10;
    const at = (i, j) => {
        const a = i / bands * Math.PI, b = j / sides * 2 * Math.PI;
        return add(centre, scale([Math.sin(a) * Math.cos(b), Math.sin(a) * Math.sin(b),
                                  Math.cos(a)], radius));
    };
    for (let i = 0; i < bands; i++) {
        for (let j = 0; j < sides; j++) {
            const points = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if (i === 0) {
                points.pop();
            } else if (i === bands - 1) {
                points.splice(1, 1);
            }
            out.push(polygon(points, sub(points[0], centre)));
        }
    }
    return out;
}

/** Triangles of polygons: positions and normals, interleaved, six numbers a corner. */
export function triangles(polygons) {
    const out = [];
    for (const { points, normal } of polygons) {
        for (let n = 2; n < points.length; n++) {
            for (const p of [points[0], points[n - 1], points[n]]) {
                out.push(p[0], p[1], p[2], normal[0], normal[1], normal[2]);
            }
        }
    }
    return out;
}
