// SPDX-License-Identifier: MIT
// Vectors of three numbers and 4x4 matrices, column-major as WebGL wants them. Nothing here knows
// a robot or a screen. Lengths are metres, angles radians.

export const DEG = Math.PI / 180;

export function add(a, b) {
    return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

export function sub(a, b) {
    return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

export function scale(a, k) {
    return [a[0] * k, a[1] * k, a[2] * k];
}

export function dot(a, b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

export function cross(a, b) {
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

export function length(a) {
    return Math.sqrt(dot(a, a));
}

/** The vector of length 1; the vector itself where it has no direction. */
export function unit(a) {
    const l = length(a);
    return l > 1e-12 ? scale(a, 1 / l) : a;
}

export function lerp(a, b, k) {
    return add(a, scale(sub(b, a), k));
}

/** Some unit vector at a right angle to the unit vector a. */
export function normalTo(a) {
    const other = Math.abs(a[0]) < 0.6 ? [1, 0, 0] : [0, 1, 0];
    return unit(sub(other, scale(a, dot(a, other))));
}

export function identity() {
    return [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
}

/** a * b: b is applied first. */
export function mul(a, b) {
    const out = new Array(16);
    for (let c = 0; c < 16; c += 4) {
        for (let r = 0; r < 4; r++) {
            out[c + r] = a[r] * b[c] + a[4 + r] * b[c + 1] + a[8 + r] * b[c + 2] +
                         a[12 + r] * b[c + 3];
        }
    }
    return out;
}

export function translation(p) {
    return [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, p[0], p[1], p[2], 1];
}

/** Turns by angle about the unit vector axis (Rodrigues). */
export function rotation(axis, angle) {
    const c = Math.cos(angle), s = Math.sin(angle), k = 1 - c;
    const [x, y, z] = axis;
    return [c + x * x * k, y * x * k + z * s, z * x * k - y * s, 0,
            x * y * k - z * s, c + y * y * k, z * y * k + x * s, 0,
            x * z * k + y * s, y * z * k - x * s, c + z * z * k, 0, 0, 0, 0, 1];
}

/** Fixed axes x, then y, then z, as URDF counts roll, pitch, yaw. */
export function fromRpy(rpy) {
    return mul(rotation([0, 0, 1], rpy[2]), mul(rotation([0, 1, 0], rpy[1]),
                                                rotation([1, 0, 0], rpy[0])));
}

/** The matrix whose columns are x, y, z and whose origin is p. */
export function fromAxes(x, y, z, p) {
    return [x[0], x[1], x[2], 0, y[0], y[1], y[2], 0, z[0], z[1], z[2], 0, p[0], p[1], p[2], 1];
}

/** The inverse of a rotation with a translation. */
export function rigidInverse(m) {
    const p = [m[12], m[13], m[14]];
    const x = [m[0], m[1], m[2]], y = [m[4], m[5], m[6]], z = [m[8], m[9], m[10]];
    return [m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0,
            -dot(x, p), -dot(y, p), -dot(z, p), 1];
}

export function place(m, p) {
    return [m[0] * p[0] + m[4] * p[1] + m[8] * p[2] + m[12],
            m[1] * p[0] + m[5] * p[1] + m[9] * p[2] + m[13],
            m[2] * p[0] + m[6] * p[1] + m[10] * p[2] + m[14]];
}

export function turn(m, v) {
    return [m[0] * v[0] + m[4] * v[1] + m[8] * v[2], m[1] * v[0] + m[5] * v[1] + m[9] * v[2],
            m[2] * v[0] + m[6] * v[1] + m[10] * v[2]];
}

export function origin(m) {
    return [m[12], m[13], m[14]];
}

export function perspective(fov, aspect, near, far) {
    const f = 1 / Math.tan(fov / 2), n = 1 / (near - far);
    return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) * n, -1, 0, 0,
            2 * far * near * n, 0];
}

export function lookAt(eye, centre, up) {
    const z = unit(sub(eye, centre)), x = unit(cross(up, z)), y = cross(z, x);
    return [x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0,
            -dot(x, eye), -dot(y, eye), -dot(z, eye), 1];
}

/** Where a point is in clip space: x, y, z, w. */
export function project(m, p) {
    return [0, 1, 2, 3].map((r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]);
}
