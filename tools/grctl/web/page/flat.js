// SPDX-License-Identifier: MIT
// The scene of gl.js on a 2-D canvas: where the browser gives no WebGL, and for the small pictures
// of motions. Polygons that face the eye are painted from far to near.

import { dot, place, project, scale, sub, turn, unit } from './mat.js';

const LIGHT = unit([0.8, -0.2, 0.8]);

function css(colour, k = 1) {
    const [r, g, b] = colour.map((v) => Math.round(Math.min(1, Math.max(0, v * k)) * 255));
    return `rgba(${r},${g},${b},${colour[3]})`;
}

/** A canvas in the processor's memory: a thousand small polygons are slow to hand to a card. */
export function makeFlat(canvas) {
    const pen = canvas.getContext('2d', { willReadFrequently: true });
    return pen ? new Flat(pen, canvas) : null;
}

class Flat {
    constructor(pen, canvas) {
        this.pen = pen;
        this.canvas = canvas;
    }

    /** Points on the canvas; null where one is behind the eye. */
    path(points, camera) {
        const w = this.canvas.width / 2, h = this.canvas.height / 2, out = [];
        for (const p of points) {
            const c = project(camera.matrix, p);
            if (c[3] <= 0.001) {
                return null;
            }
            out.push([w + w * c[0] / c[3], h - h * c[1] / c[3]]);
        }
        return out;
    }

    fill(points, colour) {
        const pen = this.pen;
        pen.fillStyle = colour;
        pen.strokeStyle = colour;
        pen.lineWidth = 0.6;
        pen.beginPath();
        points.forEach((p, n) => n ? pen.lineTo(p[0], p[1]) : pen.moveTo(p[0], p[1]));
        pen.closePath();
        pen.fill();
        pen.stroke();
    }

    lines(list, camera) {
        this.pen.lineWidth = Math.max(1, this.canvas.width / 600);
        for (const { points, colour, colours } of list) {
            for (let n = 0; n + 1 < points.length; n += 2) {
                const two = this.path([points[n], points[n + 1]], camera);
                if (two) {
                    this.pen.strokeStyle = css(colours ? colours[n] : colour);
                    this.pen.beginPath();
                    this.pen.moveTo(...two[0]);
                    this.pen.lineTo(...two[1]);
                    this.pen.stroke();
                }
            }
        }
    }

    flats(list, camera) {
        for (const { points, colour } of list) {
            for (let n = 0; n + 2 < points.length; n += 3) {
                const three = this.path(points.slice(n, n + 3), camera);
                if (three) {
                    this.fill(three, css(colour));
                }
            }
        }
    }

    draw(scene, camera) {
        this.pen.clearRect(0, 0, this.canvas.width, this.canvas.height);
        this.lines(scene.lines.filter((l) => l.below), camera);
        this.flats(scene.flats, camera);
        for (const ghost of [false, true]) {
            this.solids(scene.parts.filter((part) => Boolean(part.ghost) === ghost), camera);
        }
        this.lines(scene.lines.filter((l) => !l.below), camera);
        this.flats(scene.tops, camera);
    }

    solids(parts, camera) {
        const faces = [];
        for (const part of parts) {
            for (const polygon of part.solid) {
                const normal = turn(part.at, polygon.normal);
                const points = polygon.points.map((p) => place(part.at, p));
                const to = sub(camera.eye, points[0]);
                const path = dot(normal, to) > 0 ? this.path(points, camera) : null;
                if (path) {
                    const key = Math.max(dot(normal, LIGHT), 0), sky = 0.5 + 0.5 * normal[2];
                    const light = part.flat ? 1 : 0.36 + 0.27 * sky + 0.52 * key;
                    const middle = points.reduce((s, p) => [s[0] + p[0], s[1] + p[1], s[2] + p[2]],
                                                 [0, 0, 0]);
                    const far = sub(camera.eye, scale(middle, 1 / points.length));
                    faces.push({ path, colour: css(part.colour, light), far: dot(far, far) });
                }
            }
        }
        faces.sort((a, b) => b.far - a.far);
        for (const { path, colour } of faces) {
            this.fill(path, colour);
        }
    }

    forget() {
    }
}
