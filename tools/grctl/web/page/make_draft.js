// SPDX-License-Identifier: MIT
// A motion that is being drawn: its key poses, what was done and undone, and what of it differs from
// the file. Keys are never changed, only replaced, so that a step back is a list that was kept. Angles
// are degrees, null where a key does not set the joint; times are milliseconds.

const MOST_STEPS = 200;
const LEAST_MS = 10; // between two keys, and of a step of the time line

function same(a, b) {
    return JSON.stringify(a) === JSON.stringify(b);
}

/** An angle between the limits of its joint. */
export function clamp(deg, joint) {
    return Math.max(joint.limits_deg[0], Math.min(joint.limits_deg[1], deg));
}

/** Angles left for right, by the robot's table. */
export function mirrorAngles(angles, joints) {
    return joints.map((j) => {
        const v = angles[j.mirror];
        return v === null || v === undefined ? null : v * j.mirror_sign || 0;
    });
}

function mirrorLink(link, joints) {
    const joint = joints.find((j) => j.name === link.link);
    return { ...link, link: joint ? joints[joint.mirror].name : link.link,
             p_m: [link.p_m[0], 0 - link.p_m[1], link.p_m[2]],
             rotation: link.rotation.map((v, n) => Math.floor(n / 3) === 1 !== (n % 3 === 1) ? 0 - v : v) };
}

/** A key pose left for right, as the server does with "mirror". */
export function mirrorKey(key, joints) {
    return { ...key, angle_deg: mirrorAngles(key.angle_deg, joints),
             links: key.links.map((link) => mirrorLink(link, joints)),
             stationary: key.stationary.map((j) => joints[j].mirror).sort((a, b) => a - b),
             zmp_m: key.zmp_m && [key.zmp_m[0], 0 - key.zmp_m[1], key.zmp_m[2]] };
}

/** Links as they are written: of one that is as in the file only the name. */
function editLinks(links, was) {
    return links.map((link) => {
        const old = was.find((l) => l.link === link.link);
        return old && same(old, link) ? { link: link.link } : link;
    });
}

export class Draft {
    /**
     * @param joints of the robot
     * @param file ( name, etag, keys ) as the server told it; null: a new motion
     * @param frames whether the keys are samples of a file of frames, which is to stay one
     */
    constructor(joints, file, frames = false) {
        this.frames = frames;
        this.joints = joints;
        this.name = file ? file.name : null;
        this.etag = file ? file.etag : null;
        this.base = file ? file.keys : [];
        this.nextId = 1;
        this.keys = this.base.map((key, n) => this.fresh({ ...key, from: n }));
        this.chosen = this.keys.length ? this.keys[0].id : 0;
        this.before = [];
        this.after = [];
        this.saved = this.keys;
    }

    /** A new motion of these keys. */
    static ofKeys(joints, keys) {
        const draft = new Draft(joints, null);
        draft.keys = keys.map((key) => draft.fresh(key));
        draft.chosen = draft.keys[0].id;
        return draft;
    }

    fresh(key) {
        return { from: null, mirror: false, name: '', links: [], stationary: [], zmp_m: null,
                 max_transition_ms: 0, ...key, id: this.nextId++ };
    }

    // ---- reading -------------------------------------------------------------------------------

    index(id = this.chosen) {
        return this.keys.findIndex((key) => key.id === id);
    }

    key(id = this.chosen) {
        return this.keys[this.index(id)] || null;
    }

    length() {
        return this.keys.length ? this.keys[this.keys.length - 1].time_ms : 0;
    }

    changed() {
        return this.keys !== this.saved;
    }

    /** Whether the legs of this motion are given by where waist and feet are. */
    hasLinks() {
        return this.keys.some((key) => key.links.length > 0);
    }

    /** The angles at a time, between the keys that set them by straight lines. */
    at(ms) {
        return this.joints.map((joint, j) => {
            let low = null, high = null;
            for (const key of this.keys) {
                if (key.angle_deg[j] !== null) {
                    if (key.time_ms <= ms) {
                        low = key;
                    } else {
                        high = key;
                        break;
                    }
                }
            }
            if (!low || !high) {
                return low || high ? (low || high).angle_deg[j] : joint.init_deg;
            }
            const k = (ms - low.time_ms) / (high.time_ms - low.time_ms);
            return low.angle_deg[j] + (high.angle_deg[j] - low.angle_deg[j]) * k;
        });
    }

    /** The key at a time, to a step of the time line; null: there is none. */
    near(ms) {
        return this.keys.find((key) => Math.abs(key.time_ms - ms) < LEAST_MS / 2) || null;
    }

    // ---- what is done, and undone --------------------------------------------------------------

    /**
     * Makes these the keys. @param tag of what goes on for a while (a drag): one step back for all
     */
    set(keys, chosen = this.chosen, tag = null) {
        if (!(tag && tag === this.tag)) {
            this.before.push({ keys: this.keys, chosen: this.chosen });
            this.before.splice(0, this.before.length - MOST_STEPS);
        }
        this.tag = tag;
        this.after = [];
        this.keys = keys;
        this.chosen = keys.some((key) => key.id === chosen) ? chosen : keys[0].id;
    }

    /** Does several things that are one step back. */
    together(what) {
        const { keys, before } = this;
        what();
        const first = before.findIndex((step) => step.keys === keys);
        if (first >= 0) {
            before.length = first + 1;
        }
    }

    /** What comes next is a step of its own. */
    rest() {
        this.tag = null;
    }

    step(from, to) {
        const was = from.pop();
        if (was) {
            to.push({ keys: this.keys, chosen: this.chosen });
            this.keys = was.keys;
            this.chosen = was.chosen;
            this.rest();
        }
        return Boolean(was);
    }

    undo() {
        return this.step(this.before, this.after);
    }

    redo() {
        return this.step(this.after, this.before);
    }

    // ---- keys ----------------------------------------------------------------------------------

    replaceKey(id, change, tag) {
        const keys = this.keys.map((key) => key.id === id ? { ...key, ...change } : key);
        this.set(keys, id, tag);
    }

    /** Sets angles { joint: degrees or null } of a key, within limits. */
    setAngles(id, angles, tag) {
        const key = this.key(id), all = key.angle_deg.slice();
        for (const [j, deg] of Object.entries(angles)) {
            all[j] = deg === null ? null : clamp(deg, this.joints[j]);
        }
        this.replaceKey(id, { angle_deg: all }, tag);
    }

    /** Sets targets { link, p_m, rotation } of a key; one that it has not is added. */
    setLinks(id, links, tag) {
        const all = this.key(id).links.slice();
        for (const link of links) {
            const n = all.findIndex((l) => l.link === link.link);
            all.splice(n < 0 ? all.length : n, 1, n < 0
                ? { base: false, stationary: false, touching: false, slave: false, ...link }
                : { ...all[n], ...link });
        }
        this.replaceKey(id, { links: all }, tag);
    }

    setName(id, name) {
        this.replaceKey(id, { name });
    }

    sorted(keys) {
        return keys.slice().sort((a, b) => a.time_ms - b.time_ms || a.id - b.id);
    }

    /** A time that no other key has, near the one that is wanted. */
    freeTime(ms, id) {
        let free = Math.max(0, Math.round(ms / LEAST_MS) * LEAST_MS);
        while (this.keys.some((key) => key.id !== id && Math.abs(key.time_ms - free) < LEAST_MS)) {
            free += LEAST_MS;
        }
        return free;
    }

    /** Moves one key in time; the others stay where they are. */
    setTime(id, ms, tag) {
        const free = this.freeTime(ms, id);
        if (free !== this.key(id).time_ms) {
            this.set(this.sorted(this.keys.map((key) => key.id === id ? { ...key, time_ms: free } : key)),
                     id, tag);
        }
    }

    /** Makes the way to a key take so long; what comes after is later or earlier by as much. */
    setTransition(id, ms) {
        const n = this.index(id), before = n > 0 ? this.keys[n - 1].time_ms : 0;
        const add = before + Math.max(n > 0 ? LEAST_MS : 0, ms) - this.keys[n].time_ms;
        this.set(this.keys.map((key, i) => i < n ? key : { ...key, time_ms: key.time_ms + add }), id);
    }

    /** A new key at a time. @returns its id */
    add(ms, angles) {
        const key = this.fresh({ time_ms: this.freeTime(ms, 0),
                                 angle_deg: angles.map((v, j) => v === null ? null
                                     : clamp(Math.round(v * 10) / 10, this.joints[j])) });
        if (this.frames) { // what is as it was seen there is not changed
            key.seen = { time_ms: key.time_ms, angle_deg: key.angle_deg };
        }
        this.set(this.sorted([...this.keys, key]), key.id);
        return key.id;
    }

    /** A copy of a key at a time; where one is there, half a second behind it, before what follows. */
    paste(key, ms) {
        const there = this.near(ms), gap = 500;
        const at = there ? there.time_ms + gap : this.freeTime(ms, 0);
        const copy = { ...key, id: this.nextId++, time_ms: at };
        const rest = this.keys.map((k) => there && k.time_ms > there.time_ms
            ? { ...k, time_ms: k.time_ms + gap } : k);
        this.set(this.sorted([...rest, copy]), copy.id);
    }

    remove(id) {
        if (this.keys.length > 1) {
            const n = this.index(id), keys = this.keys.filter((key) => key.id !== id);
            this.set(keys, keys[Math.min(n, keys.length - 1)].id);
        }
    }

    mirrorOf(key) {
        return { ...mirrorKey(key, this.joints), mirror: key.from !== null && !key.mirror };
    }

    mirror(id) {
        this.replaceKey(id, this.mirrorOf(this.key(id)));
    }

    mirrorAll() {
        this.set(this.keys.map((key) => this.mirrorOf(key)));
    }

    // ---- the file ------------------------------------------------------------------------------

    /** What the server is to write: of a key of the file what differs from it, of a new one all. */
    toEdit(frames = this.frames) {
        return { keys: this.keys.map((key) => frames ? this.editFrames(key) : this.editKey(key)) };
    }

    /** Of a file of frames: where joints are at this time, if elsewhere than in the file. */
    editFrames(key) {
        const was = [key.from === null ? null : this.base[key.from], key.seen]
            .find((one) => one && one.time_ms === key.time_ms);
        const angles = {};
        this.joints.forEach((joint, j) => {
            const v = key.angle_deg[j];
            if (v !== null && !(was && v === was.angle_deg[j])) {
                angles[joint.name] = v;
            }
        });
        return Object.keys(angles).length ? { time_ms: key.time_ms, angle_deg: angles }
                                          : { time_ms: key.time_ms };
    }

    editKey(key) {
        const was = key.from === null || this.frames ? null : this.base[key.from];
        const old = was && key.mirror ? mirrorKey(was, this.joints) : was;
        const edit = was ? { from: key.from } : { time_ms: key.time_ms };
        const angles = {};
        if (was && key.mirror) {
            edit.mirror = true;
        }
        this.joints.forEach((joint, j) => {
            const v = key.angle_deg[j];
            if (old ? v !== old.angle_deg[j] : v !== null) {
                angles[joint.name] = v;
            }
        });
        if (Object.keys(angles).length) {
            edit.angle_deg = angles;
        }
        for (const what of ['time_ms', 'name', 'max_transition_ms', 'stationary', 'zmp_m']) {
            if (old ? !same(key[what], old[what]) : key[what] && !same(key[what], [])) {
                edit[what] = key[what];
            }
        }
        if (old ? !same(key.links, old.links) : key.links.length > 0) {
            edit.links = editLinks(key.links, old ? old.links : []);
        }
        return edit;
    }

    /**
     * The keys `written` were saved, and the file is this now: { name, etag, keys }. Steps back stay
     * possible; a key that is not in the file any more comes back as a new one.
     */
    rebase(file, written) {
        const at = new Map(written.map((key, n) => [key.id, n]));
        const made = new Map([[written, file.keys.map((key, n) => (
            { ...key, id: written[n].id, from: n, mirror: false, seen: null }))]]);
        const move = (keys) => {
            if (!made.has(keys)) {
                made.set(keys, keys.map((key) => ({ ...key, mirror: false, seen: null,
                                                    from: at.has(key.id) ? at.get(key.id) : null })));
            }
            return made.get(keys);
        };
        for (const step of [...this.before, ...this.after, this]) {
            step.keys = move(step.keys);
        }
        Object.assign(this, { name: file.name, etag: file.etag, base: file.keys,
                              saved: made.get(written) });
        this.rest();
    }
}

/** Key poses of samples, one every so many ms and one at the end: of a file of frames. */
export function keysOfFrames(frames, lengthMs, everyMs) {
    const keys = [], last = frames.angle_deg.length - 1;
    const pick = (ms) => frames.angle_deg[Math.min(last, Math.round(ms / 1000 * frames.rate_hz))];
    for (let ms = 0; ms < lengthMs - everyMs / 2; ms += everyMs) {
        keys.push({ time_ms: ms, angle_deg: pick(ms) });
    }
    keys.push({ time_ms: Math.round(lengthMs), angle_deg: pick(lengthMs) });
    return keys;
}

/**
 * How far two motions differ, sampled at one rate. By joint: { joint, most, at_ms, rms } of the
 * time that both have, the largest first; joints that one of them never sets are left out.
 */
export function compare(a, b) {
    const n = Math.min(a.angle_deg.length, b.angle_deg.length), out = [];
    const joints = n ? a.angle_deg[0].length : 0;
    for (let joint = 0; joint < joints; joint++) {
        let most = 0, at = 0, sum = 0, count = 0;
        for (let i = 0; i < n; i++) {
            const [x, y] = [a.angle_deg[i][joint], b.angle_deg[i][joint]];
            if (x !== null && y !== null) {
                const d = y - x;
                sum += d * d;
                count++;
                if (Math.abs(d) > Math.abs(most)) {
                    most = d;
                    at = i;
                }
            }
        }
        if (count) {
            out.push({ joint, most, at_ms: at / a.rate_hz * 1000, rms: Math.sqrt(sum / count) });
        }
    }
    return out.sort((x, y) => Math.abs(y.most) - Math.abs(x.most));
}
