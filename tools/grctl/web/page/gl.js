// SPDX-License-Identifier: MIT
// The scene by WebGL 1. A scene is { parts: [{ solid, at, colour, pick, ghost }], flats:
// [{ points, colour }], lines and tops alike }; colours are [r, g, b, a] of 0..1. Solids are
// lists of polygons (shape.js) and keep their buffer as long as the renderer lives.

import { mul, unit } from './mat.js';
import { triangles } from './shape.js';

const VERTEX = `
attribute vec3 p;
attribute vec3 n;
uniform mat4 view, model;
varying vec3 normal, world;
void main() {
    vec4 w = model * vec4(p, 1.0);
    world = w.xyz;
    normal = (model * vec4(n, 0.0)).xyz;
    gl_Position = view * w;
}`;
const FRAGMENT = `
precision mediump float;
uniform vec4 colour;
uniform vec3 light, eye;
uniform float flatness;
varying vec3 normal, world;
void main() {
    vec3 n = normalize(normal);
    vec3 to = normalize(eye - world);
    float key = max(dot(n, light), 0.0);
    float sky = 0.5 + 0.5 * n.z;
    float rim = pow(1.0 - max(dot(n, to), 0.0), 3.0);
    float gleam = pow(max(dot(n, normalize(light + to)), 0.0), 24.0);
    vec3 lit = colour.rgb * (0.34 + 0.26 * sky + 0.52 * key) + vec3(0.10 * gleam + 0.07 * rim);
    gl_FragColor = vec4(mix(lit, colour.rgb, flatness), colour.a) * vec4(vec3(colour.a), 1.0);
}`;
const LINE_VERTEX = `
attribute vec3 p;
attribute vec4 c;
uniform mat4 view;
varying vec4 tint;
void main() {
    tint = c;
    gl_Position = view * vec4(p, 1.0);
}`;
const LINE_FRAGMENT = `
precision mediump float;
varying vec4 tint;
void main() {
    gl_FragColor = vec4(tint.rgb * tint.a, tint.a);
}`;

const LIGHT = unit([0.8, -0.2, 0.8]);

function program(gl, vertex, fragment) {
    const made = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS) && !gl.isContextLost()) {
        throw new Error(gl.getProgramInfoLog(made));
    }
    return made;
}

/** Null where the browser gives no context. */
export function makeGl(canvas) {
    const gl = canvas.getContext('webgl', { antialias: true, alpha: true, stencil: true,
                                            preserveDrawingBuffer: false });
    return gl ? new Gl(gl, canvas) : null;
}

class Gl {
    constructor(gl, canvas) {
        this.gl = gl;
        this.canvas = canvas;
        this.prog = program(gl, VERTEX, FRAGMENT);
        this.line = program(gl, LINE_VERTEX, LINE_FRAGMENT);
        this.buffers = new Map();
        this.scratch = gl.createBuffer();
        const names = ['view', 'model', 'colour', 'light', 'eye', 'flatness'];
        this.at = Object.fromEntries(names.map((n) => [n, gl.getUniformLocation(this.prog, n)]));
        this.lineView = gl.getUniformLocation(this.line, 'view');
        this.slots = { p: gl.getAttribLocation(this.prog, 'p'),
                       n: gl.getAttribLocation(this.prog, 'n'),
                       lp: gl.getAttribLocation(this.line, 'p'),
                       lc: gl.getAttribLocation(this.line, 'c') };
    }

    buffer(solid) {
        let made = this.buffers.get(solid);
        if (!made) {
            const gl = this.gl, data = new Float32Array(triangles(solid));
            made = { id: gl.createBuffer(), count: data.length / 6 };
            gl.bindBuffer(gl.ARRAY_BUFFER, made.id);
            gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
            this.buffers.set(solid, made);
        }
        return made;
    }

    part(part, at = part.at) {
        const gl = this.gl, { id, count } = this.buffer(part.solid);
        gl.bindBuffer(gl.ARRAY_BUFFER, id);
        gl.vertexAttribPointer(this.slots.p, 3, gl.FLOAT, false, 24, 0);
        gl.vertexAttribPointer(this.slots.n, 3, gl.FLOAT, false, 24, 12);
        gl.uniformMatrix4fv(this.at.model, false, at);
        gl.drawArrays(gl.TRIANGLES, 0, count);
    }

    draw(scene, camera) {
        const gl = this.gl;
        gl.viewport(0, 0, this.canvas.width, this.canvas.height);
        gl.clearColor(0, 0, 0, 0);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
        gl.enable(gl.DEPTH_TEST);
        gl.depthFunc(gl.LEQUAL);
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
        this.ribbons(scene.lines.filter((l) => l.below), camera, gl.LINES);
        this.begin(camera);
        this.shadow(scene);
        for (const part of scene.parts) {
            if (!part.ghost && !part.through) {
                gl.uniform1f(this.at.flatness, part.flat || 0);
                gl.uniform4fv(this.at.colour, part.colour);
                this.part(part);
            }
        }
        this.ghosts(scene);
        this.ribbons(scene.lines.filter((l) => !l.below), camera, gl.LINES);
        this.marks(scene, camera);
    }

    /** What must be seen through the robot: pale where something is before it. */
    marks(scene, camera) {
        const gl = this.gl;
        for (const { test, k } of [{ test: false, k: 0.5 }, { test: true, k: 1 }]) {
            (test ? gl.enable : gl.disable).call(gl, gl.DEPTH_TEST);
            const pale = (c) => [c[0], c[1], c[2], c[3] * k];
            this.begin(camera);
            gl.uniform1f(this.at.flatness, 0.4);
            for (const part of scene.parts.filter((p) => p.through)) {
                gl.uniform4fv(this.at.colour, pale(part.colour));
                this.part(part);
            }
            this.ribbons([...scene.tops, ...scene.flats].map(({ points, colour }) => (
                { points, colour: pale(colour) })), camera, gl.TRIANGLES);
        }
    }

    begin(camera) {
        const gl = this.gl;
        gl.useProgram(this.prog);
        gl.enableVertexAttribArray(this.slots.p);
        gl.enableVertexAttribArray(this.slots.n);
        gl.uniformMatrix4fv(this.at.view, false, camera.matrix);
        gl.uniform3fv(this.at.light, LIGHT);
        gl.uniform3fv(this.at.eye, camera.eye);
    }

    /** The solids flattened onto the ground along the light; the stencil darkens each spot once. */
    shadow(scene) {
        const gl = this.gl, [x, y, z] = LIGHT;
        const flat = [1, 0, 0, 0, 0, 1, 0, 0, -x / z * 0.4, -y / z * 0.4, 0, 0, 0, 0, 0.0004, 1];
        gl.enable(gl.STENCIL_TEST);
        gl.stencilFunc(gl.EQUAL, 0, 255);
        gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
        gl.depthMask(false);
        gl.uniform1f(this.at.flatness, 1);
        gl.uniform4fv(this.at.colour, scene.shadow);
        for (const part of scene.parts) {
            if (!part.ghost && !part.through) {
                this.part(part, mul(flat, part.at));
            }
        }
        gl.disable(gl.STENCIL_TEST);
        gl.depthMask(true);
    }

    /** Depth first, colour second: a ghost is one clear film, not a heap of panes. */
    ghosts(scene) {
        const gl = this.gl, ghosts = scene.parts.filter((part) => part.ghost);
        gl.uniform1f(this.at.flatness, 0.35);
        gl.enable(gl.POLYGON_OFFSET_FILL); // where ghost and robot are one, the robot is seen
        gl.polygonOffset(3, 12);
        for (const colour of [false, true]) {
            gl.colorMask(colour, colour, colour, colour);
            for (const part of ghosts) {
                gl.uniform4fv(this.at.colour, part.colour);
                this.part(part);
            }
        }
        gl.disable(gl.POLYGON_OFFSET_FILL);
    }

    ribbons(list, camera, mode) {
        const gl = this.gl, data = [];
        for (const { points, colour, colours } of list) {
            points.forEach((p, n) => data.push(...p, ...(colours ? colours[n] : colour)));
        }
        if (!data.length) {
            return;
        }
        gl.useProgram(this.line);
        gl.enableVertexAttribArray(this.slots.lp);
        gl.enableVertexAttribArray(this.slots.lc);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.scratch);
        gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(data), gl.DYNAMIC_DRAW);
        gl.vertexAttribPointer(this.slots.lp, 3, gl.FLOAT, false, 28, 0);
        gl.vertexAttribPointer(this.slots.lc, 4, gl.FLOAT, false, 28, 12);
        gl.uniformMatrix4fv(this.lineView, false, camera.matrix);
        gl.depthMask(false);
        gl.drawArrays(mode, 0, data.length / 7);
        gl.depthMask(true);
    }

    /** Forgets the buffers of a robot that is no longer shown. */
    forget() {
        for (const { id } of this.buffers.values()) {
            this.gl.deleteBuffer(id);
        }
        this.buffers.clear();
    }
}
