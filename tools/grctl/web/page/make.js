// SPDX-License-Identifier: MIT
// The view "Make": key poses of a motion, drawn by sliders, by drags in the figure, by handles, and from
// the limp robot. What is drawn is the figure's pose, the robot a pale film beside it; nothing here
// moves the robot but "Show on robot" and its torque, both under the lease.

import { Newest } from './api.js';
import { forward, stand } from './body.js';
import { ask, element, replace, seconds, setText, valueText } from './dom.js';
import { Draft, compare, keysOfFrames } from './make_draft.js';
import { Hands } from './make_hands.js';
import { Line } from './make_line.js';
import { Rows } from './make_rows.js';
import { DEG, add } from './mat.js';
import { sample } from './play.js';

const RATE_HZ = 30;
const IMPORT_MS = 200; // frames of a file become key poses so far apart
const MOST_KEYS = 3000; // of an answer: a file of more would lose the rest
const NUDGE_M = 0.005;
const PAUSE_MS = 60; // between two requests of a kind
const FIELDS = ['at', 'way', 'key-name'];
const FELT_MS = 2500; // a limit that was reached is told so long
const NUDGES = [['Up', [0, 0, 1]], ['Down', [0, 0, -1]], ['Forward', [1, 0, 0]], ['Back', [-1, 0, 0]],
                ['To its left', [0, 1, 0]], ['To its right', [0, -1, 0]]];
const HANDLES = { waist: 'Waist', right_foot: 'Right foot', left_foot: 'Left foot' };

const path = (name) => `/api/motions/${encodeURIComponent(name)}`;
const round = (v, digits) => Math.round(v * 10 ** digits) / 10 ** digits;

/** { p_m, rotation } as the interface has it, of a matrix. */
function placement(m) {
    return { p_m: [m[12], m[13], m[14]].map((v) => round(v, 6)),
             rotation: [m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]].map((v) => round(v, 9)) };
}

export class Make {
    constructor(app) {
        this.app = app;
        this.id = (name) => document.getElementById(`make-${name}`);
        this.draft = null;
        this.at = 0;
        this.look = null;
        this.other = null;
        this.copied = null;
        this.handle = null;
        this.nudged = []; // that wait for the one before
        this.nudges = 0;
        this.told = ['', ''];
        this.hands = new Hands(this);
        this.line = new Line(this.id('track'), app.t, {
            choose: (id) => this.choose(id), at: (ms) => this.seek(ms), touch: () => app.schedule(),
            move: (id, ms) => this.edit(() => this.draft.setTime(id, ms, `move ${id}`)),
            moved: () => this.rest() });
        this.rows = new Rows(this.id('joints'), this);
        this.looks = new Newest(() => this.preview(), PAUSE_MS);
        this.ik = new Newest((job) => this.solve(job), PAUSE_MS / 2);
        this.weighs = new Newest((pose) => this.weigh(pose), PAUSE_MS);
        this.listen();
    }

    listen() {
        const click = (name, what) => this.id(name).addEventListener('click', what);
        const change = (name, what) => this.id(name).addEventListener('change', what);
        click('undo', () => this.undo());
        click('redo', () => this.redo());
        click('add', () => this.add());
        click('copy', () => this.copy());
        click('paste', () => this.paste());
        click('mirror', () => this.edit(() => this.draft.mirror(this.ensureKey())));
        click('mirror-all', () => this.edit(() => this.draft.mirrorAll()));
        click('delete', () => this.edit(() => this.draft.remove(this.draft.chosen), true));
        click('preview', () => this.togglePreview());
        click('new', async () => await this.mayLeave() && this.begin());
        change('open', () => this.chooseFile(this.id('open').value));
        click('save', () => this.save());
        click('save-as', () => this.saveAs());
        this.id('as').addEventListener('keydown', (event) => event.key === 'Enter' && this.saveAs());
        change('at', () => this.field('at', (ms) => this.draft.setTime(this.draft.chosen, ms)));
        change('way', () => this.field('way', (ms) => this.draft.setTransition(this.draft.chosen, ms)));
        change('key-name', () => {
            this.typing = null;
            this.edit(() => this.draft.setName(this.ensureKey(), this.id('key-name').value));
        });
        for (const name of FIELDS) {
            this.id(name).addEventListener('input', () => {
                this.typing = name;
            });
        }
        click('limp', () => this.limp('limp'));
        click('hold', () => this.limp('hold'));
        click('capture', () => this.capture(false));
        click('capture-new', () => this.capture(true));
        click('show', () => this.show());
        change('other', () => this.compareWith(this.id('other').value));
        addEventListener('beforeunload', (event) => {
            if (this.draft && this.draft.changed()) {
                event.preventDefault();
            }
        });
        const narrow = matchMedia('(max-width: 820px)'), maker = document.getElementById('maker');
        const move = () => (narrow.matches ? document.getElementById('make').prepend(maker)
                                           : document.getElementById('stage').append(maker));
        narrow.addEventListener('change', move);
        move();
    }

    setRobot(robot) {
        const t = this.app.t, names = (joints) => JSON.stringify(joints.map((j) => j.name));
        if (this.draft && names(this.draft.joints) !== names(robot.joints)) {
            this.draft = this.look = null; // another robot: its motions are others
        }
        this.rows.setRobot(robot);
        this.id('handles').hidden = !robot.body;
        replace(this.id('group'), ...robot.groups.map((g) => element('option', { value: g.name },
                                                                     t(g.name))));
        const held = robot.groups.find((g) => g.name === 'arms');
        this.id('group').value = (held || robot.groups[0] || { name: 'all' }).name;
        replace(this.id('handle'), ...Object.keys(robot.body ? HANDLES : {}).map((name) => {
            const button = element('button', { type: 'button', onclick: () => this.chooseHandle(name) },
                                   t(HANDLES[name]));
            button.setAttribute('role', 'radio');
            button.dataset.handle = name;
            return button;
        }));
        replace(this.id('nudge'), ...NUDGES.map(([words, way]) => element('button', {
            type: 'button', onclick: () => this.nudge(way) }, t(words))));
        this.chooseHandle('waist');
    }

    /** The list of motions has changed. */
    setFiles(files) {
        const t = this.app.t, option = (f) => element('option', { value: f.name }, f.name);
        const first = (words) => element('option', { value: '' }, words);
        replace(this.id('open'), first(t('Open a motion …')), ...files.map(option));
        replace(this.id('other'), first(t('with …')), ...files.map(option));
        this.id('open').value = this.draft && this.draft.name || '';
        this.id('other').value = this.other ? this.other.name : '';
        const file = this.draft && files.find((f) => f.name === this.draft.name);
        this.stale = Boolean(file && file.etag && file.etag !== this.draft.etag && !this.saving);
        this.files = files;
    }

    active() {
        return Boolean(this.draft && this.app.robot) && document.body.dataset.tab === 'make';
    }

    // ---- the draft -----------------------------------------------------------------------------

    async mayLeave() {
        return !this.draft || !this.draft.changed() ||
               ask(this.app.t('What was changed is not saved. Leave it?'));
    }

    async chooseFile(name) {
        if (name && await this.mayLeave()) {
            this.open(name);
        } else {
            this.id('open').value = this.draft && this.draft.name || '';
        }
    }

    take(draft, look, suggested) {
        Object.assign(this, { draft, look, at: draft.keys[0].time_ms, previewing: false, stale: false,
                              felt: null, stance: null, frozen: null });
        this.id('open').value = draft.name || '';
        this.id('as').value = suggested;
        this.setFiles(this.files || []);
        this.settle();
    }

    begin() {
        const draft = new Draft(this.app.robot.joints, null);
        draft.add(0, this.app.robot.joints.map((j) => j.init_deg));
        draft.before = [];
        draft.saved = draft.keys;
        this.tell('', '');
        this.take(draft, null, this.freeName('new'));
        this.looks.push(draft.keys);
    }

    freeName(stem) {
        let name = `${stem}.pseq`;
        for (let n = 2; (this.files || []).some((f) => f.name === name); n++) {
            name = `${stem}${n}.pseq`;
        }
        return name;
    }

    async open(name) {
        const t = this.app.t;
        let file;
        try {
            file = await this.app.api.get(`${path(name)}?rate=${RATE_HZ}`);
        } catch (error) {
            this.app.fail(error);
            return;
        }
        const stem = name.replace(/\.[^.]+$/, '');
        const look = { ...file, pct: 100 };
        if (file.keys.length >= MOST_KEYS) {
            this.tell('bad', t('{0} has too many key poses to be edited here.', name));
        } else if (['keys', 'postures'].includes(file.kind) && file.keys.length) {
            this.tell('', '');
            this.take(new Draft(this.app.robot.joints, file), look, this.freeName(stem));
        } else if (file.frames.angle_deg.length) {
            const keys = keysOfFrames(file.frames, file.length_ms, IMPORT_MS), stays = file.kind === 'frames';
            const draft = stays ? new Draft(this.app.robot.joints, { name, etag: file.etag, keys }, true)
                                : Draft.ofKeys(this.app.robot.joints, keys);
            this.tell('', stays
                ? t('{0} is seen every {1} s. Save moves its frames around what you change; under another name they become key poses.',
                    name, IMPORT_MS / 1000)
                : t('Taken from the frames of {0}, a key pose every {1} s. Save it under another name.',
                    name, IMPORT_MS / 1000));
            this.take(draft, stays ? { ...look, keys: draft.keys } : look, this.freeName(`${stem}-keys`));
            if (!stays) {
                this.looks.push(draft.keys);
            }
        } else {
            this.tell('bad', `${name}: ${file.check.message || t('✕ not readable')}`);
        }
        this.app.schedule();
    }

    /** Does something to the draft; what follows from it is done here. */
    edit(what, follow) {
        if (!this.draft) {
            return;
        }
        const was = this.draft.keys;
        this.draft.together(what);
        if (this.draft.keys !== was) {
            this.previewing = false;
            const key = this.draft.key();
            this.at = key.time_ms;
            this.line.refocus = follow && this.line.markers.contains(document.activeElement);
            this.looks.push(this.draft.keys);
            this.settle();
        }
    }

    undo() {
        this.edit(() => this.draft.undo() && this.app.say(this.app.t('Undone')));
    }

    redo() {
        this.edit(() => this.draft.redo() && this.app.say(this.app.t('Done again')));
    }

    rest() {
        this.restLater = this.solving || this.ik.next !== undefined;
        if (this.restLater) {
            return;
        }
        this.frozen = null;
        if (this.draft) {
            this.draft.rest();
        }
        this.settle();
        if (this.nudged.length) {
            this.nudge(this.nudged.shift());
        }
    }

    /** Something else is shown: the pose is weighed, the page is drawn. */
    settle() {
        if (this.draft && this.app.robot.body && !this.previewing && !this.frozen) {
            this.weighs.push(this.shown());
        }
        this.app.schedule();
    }

    choose(id) {
        this.draft.chosen = id;
        this.previewing = false;
        this.at = this.draft.key().time_ms;
        this.settle();
    }

    seek(ms) {
        const key = this.draft.near(ms);
        this.previewing = false;
        this.at = key ? key.time_ms : ms;
        this.draft.chosen = key ? key.id : this.draft.chosen;
        this.settle();
    }

    /** The key at this time; null: it is between two. */
    here() {
        return this.draft.near(this.at);
    }

    /** The key that an edit changes: between two, a new one with the pose that is seen. */
    ensureKey() {
        const key = this.here();
        return key ? key.id : this.draft.add(this.at, this.degrees());
    }

    add() {
        this.edit(() => {
            const there = this.here(), pose = this.degrees();
            this.draft.add(there ? this.draft.length() + 500 : this.at, pose);
        });
    }

    copy() {
        const key = this.here() || this.draft.fresh({ angle_deg: this.degrees(), time_ms: this.at });
        this.copied = { key, base: this.draft.base };
        this.app.say(this.app.t('Copied'));
        this.app.schedule();
    }

    paste() {
        if (this.copied) {
            const { key, base } = this.copied; // of another file it is a new one
            this.edit(() => this.draft.paste(base === this.draft.base ? key
                : { ...key, from: null, mirror: false }, this.at), true);
        }
    }

    field(name, what) {
        const ms = Number(this.id(name).value.replace(',', '.')) * 1000;
        if (Number.isFinite(ms) && this.id(name).value.trim() && ms >= 0 && ms <= 3600000) {
            this.edit(() => {
                this.ensureKey();
                what(ms);
            });
        }
        this.fieldsKey = this.typing = null;
        this.app.schedule();
    }

    // ---- the pose that is seen -----------------------------------------------------------------

    /** Degrees of all joints at the cursor. */
    degrees() {
        const key = this.here(), frames = this.look && this.look.frames;
        const made = frames && frames.angle_deg.length ? sample(frames, this.at, this.app.toMatrix).q : null;
        const straight = this.draft.at(this.at);
        return straight.map((v, j) => key && key.angle_deg[j] !== null ? key.angle_deg[j]
            : made && Number.isFinite(made[j]) ? made[j] / DEG : v);
    }

    /** Where the waist is: as the file draws it, else as the robot stands; null: that. */
    root() {
        if (this.frozen || !this.draft.hasLinks()) {
            return this.frozen || null;
        }
        const key = this.here(), link = key && key.links.find((l) => l.link === this.linkName(key, 0));
        const frames = this.look && this.look.frames;
        return link ? this.app.toMatrix(link)
            : frames && frames.root && frames.root.length ? sample(frames, this.at, this.app.toMatrix).root : null;
    }

    shown() {
        return { q: this.degrees().map((v) => v * DEG), root: this.root() };
    }

    /** For Hands. */
    pose() {
        return this.shown();
    }

    angleOf(joint) {
        return this.degrees()[joint];
    }

    freeze(root) {
        this.frozen = root;
    }

    // ---- hands ---------------------------------------------------------------------------------

    /** Sets a joint of the key, and its twin where both sides are wanted. @returns what it is now */
    turnJoint(joint, deg, tag) {
        const { draft } = this, { joints } = draft, twin = joints[joint].mirror;
        const angles = { [joint]: round(deg, 1) };
        if (this.id('both').checked && twin !== joint) {
            angles[twin] = round(deg * joints[joint].mirror_sign, 1);
        }
        this.edit(() => {
            const id = this.ensureKey();
            draft.setAngles(id, angles, tag);
            this.setFeet(id, Object.keys(angles).map(Number), tag);
        });
        const now = draft.key().angle_deg[joint], [low, high] = joints[joint].limits_deg;
        this.feel(now <= low || now >= high ? `${joints[joint].name} ${this.app.t('at its limit')}` : null);
        return now;
    }

    unset(joint) {
        this.edit(() => this.draft.setAngles(this.ensureKey(), { [joint]: null }));
    }

    /** What a hand feels; null: nothing is in its way. */
    feel(words) {
        if (words && words !== this.felt) {
            this.rows.tremble();
            this.app.say(words);
        }
        this.felt = words;
        clearTimeout(this.feltTimer);
        this.feltTimer = setTimeout(() => {
            this.felt = null;
            this.app.schedule();
        }, FELT_MS);
    }

    linkName(key, n) {
        const { name } = this.app.robot.links[n];
        const found = key.links.find((l) => l.link === name || l.link === String(n));
        return found ? found.link : name;
    }

    /** Where the file gives feet by their places, these go along with the joints of their legs. */
    setFeet(id, joints, tag) {
        const { draft } = this, { robot, figure } = this.app;
        if (!robot.body || !draft.hasLinks()) {
            return;
        }
        const feet = robot.body.feet.filter((foot) => foot.joints.some((j) => joints.includes(j)));
        const pose = this.shown(), at = forward(figure.body, pose.q, pose.root || stand(figure.body, pose.q));
        if (feet.length) {
            draft.setLinks(id, feet.map((foot) => ({ link: this.linkName(draft.key(id), foot.link),
                                                     ...placement(at[foot.link]) })), tag);
        }
    }

    chooseHandle(name) {
        this.handle = name;
        for (const button of this.id('handle').children) {
            const on = button.dataset.handle === name;
            button.setAttribute('aria-checked', String(on));
        }
        this.app.schedule();
    }

    nudge(way) {
        if (this.solving || this.ik.next !== undefined) {
            this.nudged.push(way);
            return;
        }
        const pose = this.shown(), handle = this.hands.handles().find((h) => h.name === this.handle);
        const at = this.hands.placed(pose)[handle.link];
        this.moveHandle(this.handle, add([at[12], at[13], at[14]], way.map((v) => v * NUDGE_M)), pose,
                        `nudge ${++this.nudges}`);
        this.rest();
    }

    /** A handle shall be at p; pose is what it is moved from. The server solves the legs. */
    moveHandle(name, p, pose, tag) {
        this.ik.push({ name, p, pose, tag });
    }

    async solve({ name, p, pose, tag }) {
        const { app, draft } = this;
        if (!draft) {
            return;
        }
        const root = pose.root || stand(app.figure.body, pose.q);
        this.solving = true;
        try {
            const made = await app.api.post('/api/ik', {
                angle_deg: pose.q.map((v) => round(v / DEG, 6)), root: placement(root), handle: name,
                p_m: p.map((v) => round(v, 6)) });
            if (draft === this.draft) {
                this.takeSolved(name, made, tag);
            }
        } catch (error) {
            app.fail(error);
        }
        this.solving = false;
        if (this.restLater) {
            this.rest();
        }
    }

    takeSolved(name, made, tag) {
        const { draft } = this, angles = {};
        this.feel(made.reached ? null : this.app.t(made.limits.length ? 'at its limit' : 'out of reach'));
        if (!made.reached) {
            return;
        }
        const now = this.degrees();
        made.angle_deg.forEach((v, j) => {
            if (Math.abs(v - now[j]) > 0.001) {
                angles[j] = round(v, 3);
            }
        });
        this.edit(() => {
            const id = this.ensureKey();
            draft.setAngles(id, angles, tag);
            if (draft.hasLinks()) {
                const foot = this.app.robot.body.feet.findIndex((f) => `${f.side}_foot` === name);
                const n = foot < 0 ? 0 : this.app.robot.body.feet[foot].link;
                draft.setLinks(id, [{ link: this.linkName(draft.key(id), n),
                                      ...(foot < 0 ? { base: true, ...made.root } : made.feet[foot]) }], tag);
            }
        });
        this.frozen = this.app.toMatrix(made.root);
    }

    /** Where the weight of a pose is, by the server: a handle that stays where it is. */
    async weigh(pose) {
        const root = pose.root || stand(this.app.figure.body, pose.q);
        try {
            const made = await this.app.api.post('/api/ik', {
                angle_deg: pose.q.map((v) => round(v / DEG, 6)), root: placement(root), handle: 'waist',
                p_m: placement(root).p_m });
            this.stance = { body: made.body, key: this.poseKey(pose) };
        } catch (error) {
            this.stance = null;
        }
        this.app.schedule();
    }

    poseKey(pose) {
        return JSON.stringify(pose.q.map((v) => round(v, 4)));
    }

    // ---- what the server says ------------------------------------------------------------------

    async preview() {
        const { draft, app } = this;
        if (!draft) {
            return;
        }
        const { keys } = draft;
        const base = draft.name ? { motion: draft.name, etag: draft.etag } : {};
        try {
            const look = await app.api.post('/api/preview', { ...base, edit: draft.toEdit(), rate_hz: RATE_HZ });
            if (draft === this.draft) {
                this.look = { ...look, keys };
                this.trouble = null;
            }
        } catch (error) {
            if (draft === this.draft) {
                this.trouble = error.message;
                this.stale = this.stale || error.code === 'changed';
            }
        }
        app.schedule();
    }

    tell(level, words) {
        this.told = [level, words];
        this.app.schedule();
    }

    /** What a check came to: { level, words }. */
    checked(check, balance) {
        const t = this.app.t, n = check ? check.warnings + check.errors : 0;
        const lost = balance && !balance.assumed && balance.findings.find((f) => f.problem === 'zmp_margin'
            ? f.worst < 0 : ['no_support', 'foot_slip'].includes(f.problem));
        return !check ? { level: '', words: '' }
            : check.refused ? { level: 'bad', words: `✕ ${check.refused.message}` }
            : check.falls_ms !== null ? { level: 'bad', words: t('▲ would fall at {0} s', seconds(check.falls_ms)) }
            : lost ? { level: 'warn', words: t('▲ out of balance from {0} s', seconds(lost.begin_ms)) }
            : n ? { level: 'warn', words: t('▲ {0} warnings', n) }
            : { level: 'ok', words: this.app.robot.body ? t('✓ stays within limits and balance') : t('✓ checked') };
    }

    async save() {
        if (this.draft && this.draft.name) {
            await this.put(this.draft.name, { 'If-Match': this.draft.etag }, {});
        }
    }

    async saveAs() {
        const { draft } = this, typed = this.id('as').value.trim();
        const name = /\.(pseq|m|mseq|yaml|seq)$/i.test(typed) ? typed : `${typed}.pseq`;
        if (!draft || !typed) {
            this.tell('bad', this.app.t('Give the new file a name.'));
            this.id('as').focus();
            return;
        }
        await this.put(name, { 'If-None-Match': '*' },
                       draft.name && !draft.frames ? { base: { motion: draft.name, etag: draft.etag } } : {});
    }

    async put(name, headers, more) {
        const { draft, app } = this, { t } = app, written = draft.keys;
        const stays = draft.frames && name === draft.name; // a file of frames
        this.saving = true;
        try {
            const told = await app.api.request('PUT', path(name), { ...draft.toEdit(stays), ...more }, headers);
            const file = await app.api.get(`${path(name)}?rate=${RATE_HZ}`);
            const whole = stays ||
                (file.keys.length === written.length && ['keys', 'postures'].includes(file.kind));
            if (whole && file.etag === told.etag) {
                draft.frames = stays;
                draft.rebase(stays ? { ...file, keys: written } : file, written);
                this.id('as').value = this.freeName(name.replace(/\.[^.]+$/, ''));
            }
            const said = [whole ? t('Saved as {0}.', name) : t('A copy was written as {0}.', name),
                          this.checked(told.check, file.balance).words, ...told.notes];
            this.stale = false;
            this.tell(told.check && told.check.ok ? 'ok' : 'bad', said.join(' '));
        } catch (error) {
            this.tell('bad', error.code !== 'changed' ? error.message
                : headers['If-Match'] ? t('{0} has changed since it was opened. Save under another name, or open it again.', name)
                : t('{0} is there already, or what it is made of has changed. Choose another name.', name));
        }
        this.saving = false;
        await app.play.refresh().catch(() => {});
        this.looks.push(draft.keys);
        app.schedule();
    }

    // ---- the robot -----------------------------------------------------------------------------

    async limp(mode) {
        const { app } = this, group = app.robot.groups.find((g) => g.name === this.id('group').value);
        const legs = (app.robot.body ? app.robot.body.feet : []).flatMap((foot) => foot.joints);
        const falls = mode === 'limp' && group.joints.some((j) => legs.includes(j));
        if (!falls || await ask(app.t('Without torque the robot sinks or falls. Hold it. Switch torque off?'))) {
            app.command('/api/torque', { joints: [group.name], mode }, true);
        }
    }

    /** The robot's angles into the key: of the joints that are limp, or of all where none is. */
    async capture(asNew) {
        const { app } = this, { t } = app, { draft } = this;
        const told = await app.command('/api/capture', { joints: ['all'] });
        if (!told || !draft || draft !== this.draft) {
            return;
        }
        const limp = app.state.limp, angles = {};
        told.angle_deg.forEach((v, j) => {
            if (v !== null && (asNew || !limp.length || limp.includes(j))) {
                angles[j] = round(v, 1);
            }
        });
        this.edit(() => {
            const id = asNew ? draft.add(this.here() ? draft.length() + 1000 : this.at, this.degrees())
                             : this.ensureKey();
            draft.setAngles(id, angles);
            this.at = draft.key(id).time_ms;
            this.setFeet(id, Object.keys(angles).map(Number));
        });
        this.tell('', t('{0} joints were read from the robot.', Object.keys(angles).length));
    }

    /** So long that no joint turns faster than the robot comes to a motion's beginning. */
    showTime() {
        const deg = this.degrees(), now = this.app.state.angle_deg;
        const far = deg.reduce((most, v, j) => Math.max(most, Math.abs(v - (now[j] ?? v))), 0);
        return Math.min(60000, Math.max(1000, Math.ceil(far / (this.app.robot.safety.approach_dps || 60) * 10) * 100));
    }

    async show() {
        const { app } = this, margin = this.margin();
        const angles = Object.fromEntries(this.degrees().map((v, j) => [app.robot.joints[j].name, round(v, 2)]));
        if (margin === null || margin >= 0 ||
            await ask(app.t('In this pose the robot would fall. Move it there?'))) {
            app.command('/api/move', { angle_deg: angles, time_ms: this.showTime() }, true);
        }
    }

    /** How far the weight is inside the soles, in metres; null: unknown. */
    margin() {
        return this.stance && this.stance.key === this.poseKey(this.shown()) ? this.stance.body.margin_m : null;
    }

    // ---- comparing -----------------------------------------------------------------------------

    async compareWith(name) {
        this.other = null;
        if (name) {
            try {
                const file = await this.app.api.get(`${path(name)}?rate=${RATE_HZ}`);
                this.other = { name, frames: file.frames, length_ms: file.length_ms };
            } catch (error) {
                this.app.fail(error);
            }
        }
        this.app.schedule();
    }

    writeComparison() {
        const { other, look } = this, { t } = this.app;
        if (this.compared === other && this.comparedLook === look) {
            return;
        }
        this.compared = other;
        this.comparedLook = look;
        const both = other && look && look.frames.angle_deg.length && other.frames.angle_deg.length;
        const all = both ? compare(look.frames, other.frames) : [];
        const some = all.filter((d) => Math.abs(d.most) >= 0.05);
        this.id('compare').hidden = !some.length;
        setText(this.id('difference'), !both ? '' :
            `${t('{0} s here, {1} s there.', seconds(look.length_ms), seconds(other.length_ms))} ` +
            (some.length ? t('{0} of {1} joints differ.', some.length, all.length) : t('All angles are the same.')));
        replace(this.id('compare').tBodies[0], ...some.slice(0, 10).map((d) => element('tr', {},
            element('th', { scope: 'row' }, element('button', { type: 'button', className: 'joint', onclick: () => {
                this.app.select(d.joint);
                this.seek(Math.round(d.at_ms / 10) * 10);
            } }, this.app.name(d.joint))),
            element('td', { className: 'num' }, `${d.most.toFixed(1)}°`),
            element('td', { className: 'num' }, (d.at_ms / 1000).toFixed(1)),
            element('td', { className: 'num' }, `${d.rms.toFixed(1)}°`))));
    }

    // ---- drawing -------------------------------------------------------------------------------

    togglePreview() {
        this.previewing = !this.previewing;
        this.beganAt = performance.now() - (this.at >= this.draft.length() - 1 ? 0 : this.at);
        this.settle();
    }

    /** For the figure: the draft, with its limits, its handles and its weight. */
    figurePose() {
        const { app, draft } = this, theme = app.figure.theme, pose = this.shown(), key = this.here();
        const stance = this.stance && this.stance.key === this.poseKey(pose) ? this.stance.body : null;
        return {
            ...pose, draft: true, faded: false,
            handles: this.previewing ? [] : this.hands.handles().map(({ name, link }) => (
                { link, chosen: name === this.handle })),
            looks: draft.joints.map((joint, j) => {
                const deg = pose.q[j] / DEG, left = Math.min(deg - joint.limits_deg[0], joint.limits_deg[1] - deg);
                const set = Boolean(key) && key.angle_deg[j] !== null;
                const edge = left < 0.05 && (set || j === app.selected);
                return { name: joint.name, limits: joint.limits_deg, target: app.state.angle_deg[j],
                         shape: set ? 'on' : 'off', level: edge ? 'warn' : '',
                         note: '', tint: edge ? 0.5 : 0,
                         colour: edge ? theme.warn : theme.accent, text: `${valueText(joint, deg)}${edge ? ` ${app.t('at its limit')}` : ''}`, unknown: false };
            }),
            balance: stance && { com: stance.com_m, zmp: null, support: stance.support_m,
                                 inside: stance.margin_m === null || stance.margin_m >= 0,
                                 soles: stance.soles.map((s) => ({ corners: s.corners_m, standing: s.standing })) },
        };
    }

    /** The film beside it: the other motion, or the robot as it is. */
    film() {
        const { app, other } = this;
        if (other && other.frames.angle_deg.length) {
            return { ...sample(other.frames, this.at, app.toMatrix), note: other.name };
        }
        const { state } = app, root = state.body ? app.toMatrix(state.body.root) : null, own = this.root();
        if (root && own) { // a file has a world of its own: both stand in the same place
            const pose = this.shown(), here = stand(app.figure.body, pose.q);
            root[12] += own[12] - here[12];
            root[13] += own[13] - here[13];
        }
        return app.age() ? null : { q: state.angle_deg.map((v) => v === null ? NaN : v * DEG), root };
    }

    legend(item) {
        const { t } = this.app, body = this.stance ? [item('target', t('centre of mass')), item('area', t('support'))] : [];
        return [item('dot draft', t('draft: the robot does not move')), ...body,
                item('film', this.other ? this.other.name : t('robot'))];
    }

    draw(now) {
        const { app } = this, tab = document.body.dataset.tab === 'make';
        document.getElementById('maker').hidden = !(tab && this.draft);
        if (!tab) {
            this.previewing = false;
            return;
        }
        this.id('file').hidden = !this.draft;
        this.id('hint').hidden = Boolean(this.draft);
        if (!this.draft) {
            this.writeTold();
            return;
        }
        if (this.previewing) {
            this.at = now - this.beganAt;
            if (this.at >= this.draft.length()) {
                this.previewing = false;
                this.seek(this.draft.length());
            }
            app.schedule();
        }
        this.line.draw({ draft: this.draft, at: this.at, look: this.look, other: this.other,
                         joint: app.selected, css: app.css, theme: app.themeName });
        this.rows.draw(this.degrees(), this.here(), app.selected);
        this.write();
        this.writeKey();
        this.writeRobot();
        this.writeTold();
        this.writeComparison();
    }

    write() {
        const { draft } = this, { t } = this.app, changed = draft.changed() || !draft.name;
        this.id('undo').disabled = !draft.before.length;
        this.id('redo').disabled = !draft.after.length;
        this.id('paste').disabled = !this.copied;
        this.id('delete').disabled = draft.keys.length < 2 || !this.here();
        setText(this.id('preview'), this.previewing ? `❚❚ ${t('Preview')}` : `▷ ${t('Preview')}`);
        setText(this.id('time'), `${(this.at / 1000).toFixed(2)} / ${(draft.length() / 1000).toFixed(2)} s`);
        setText(this.id('name'), draft.name || t('new motion'));
        setText(this.id('changed'), this.stale ? t('▲ changed elsewhere') : changed ? t('not saved') : t('saved'));
        this.id('changed').className = `pill ${this.stale || changed ? 'warn' : ''}`;
        this.id('save').disabled = !draft.name || !draft.changed() || !this.app.api.token || Boolean(this.saving);
        this.id('save-as').disabled = !this.app.api.token || Boolean(this.saving);
        const { level, words } = this.felt ? { level: 'warn', words: `▲ ${this.felt}` }
            : this.trouble ? { level: 'bad', words: `✕ ${this.trouble}` }
            : this.checked(this.look && this.look.check, this.look && this.look.balance);
        setText(this.id('verdict'), words);
        this.id('verdict').className = level;
    }

    writeKey() {
        const { draft } = this, { t } = this.app, key = this.here(), n = draft.index();
        const before = n > 0 ? draft.keys[n - 1].time_ms : 0;
        setText(this.id('key-title'), key ? t('Key pose {0} of {1}', n + 1, draft.keys.length)
                                          : t('Between key poses: an edit adds one here'));
        const fields = key ? [(key.time_ms / 1000).toFixed(2), ((key.time_ms - before) / 1000).toFixed(2), key.name]
                           : [(this.at / 1000).toFixed(2), '', ''];
        const now = JSON.stringify(fields);
        if (now !== this.fieldsKey) {
            this.fieldsKey = now;
            FIELDS.forEach((name, i) => { // what somebody types is left alone
                if (name !== this.typing || document.activeElement !== this.id(name)) {
                    this.id(name).value = fields[i];
                }
            });
        }
        this.id('way').disabled = !key;
    }

    writeRobot() {
        const { app } = this, may = app.mayMove(), up = !app.age() && app.state.link === 'up';
        for (const name of ['limp', 'hold', 'show']) {
            this.id(name).disabled = !may;
        }
        for (const name of ['capture', 'capture-new']) {
            this.id(name).disabled = !up || !app.api.token;
        }
        setText(this.id('show'), app.t('Show on robot, {0} s', seconds(this.showTime())));
        setText(this.id('why'), app.whyNot() || '');
    }

    writeTold() {
        setText(this.id('told'), this.told[1]);
        this.id('told').className = this.told[0] || 'quiet';
    }

    // ---- keys ----------------------------------------------------------------------------------

    /** @returns whether it was one of ours */
    onKey(event) {
        const typing = event.target.matches('input:not([type=range]):not([type=checkbox]), select');
        if (!this.active() || typing) {
            return false;
        }
        const ctrl = event.ctrlKey || event.metaKey, marker = event.target.closest('.markers');
        const does = ctrl && !event.altKey ? {
            z: () => event.shiftKey ? this.redo() : this.undo(), y: () => this.redo(),
            c: getSelection().isCollapsed ? () => this.copy() : null, v: () => this.paste() }[event.key.toLowerCase()]
            : marker ? this.markerKey(event) : event.key === ' ' && !event.target.matches('button, summary, input')
            ? () => this.togglePreview() : null;
        if (does) {
            event.preventDefault();
            does();
        }
        return Boolean(does);
    }

    markerKey(event) {
        const { draft } = this, n = draft.index(), step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
        const go = (to) => () => {
            this.line.refocus = true;
            this.choose(draft.keys[Math.max(0, Math.min(draft.keys.length - 1, to))].id);
        };
        if (step && event.shiftKey) {
            return () => this.edit(() => draft.setTime(draft.chosen, draft.key().time_ms + step * 10), true);
        }
        return step ? go(n + step) : {
            Home: go(0), End: go(draft.keys.length - 1),
            Delete: () => this.edit(() => draft.remove(draft.chosen), true),
            Backspace: () => this.edit(() => draft.remove(draft.chosen), true) }[event.key];
    }
}
