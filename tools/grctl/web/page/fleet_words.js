// SPDX-License-Identifier: MIT
// What is said of a fleet, without a page.

import { count } from './stop.js';

export const NEAR_DEG = 3;

/** How a robot is: { level: 'ok' | 'warn' | 'bad' | 'off', text }. */
export function howIs(robot, t) {
    const link = { away: ['off', t('signed off')], broken: ['bad', t('agent lost')], silent: ['bad', t('no news')],
                   down: ['bad', t('not connected')] }[robot.link];
    const [level, text] = link ? link
        : robot.trip ? ['bad', t(robot.trip)]
        : robot.stopped ? ['warn', robot.moving ? t('stopping') : t('stopped')]
        : robot.play === 'playing' || robot.play === 'approaching' || robot.play === 'paused'
        ? ['ok', t(robot.play)] : ['ok', robot.moving ? t('moves') : t('idle')];
    return { level, text };
}

/** The joint that has the least to go before a limit: { name, left }; null: nothing is known. */
export function nearest(angles, joints) {
    let found = null;
    joints.forEach((joint, n) => {
        const [min, max] = joint.limits_deg, angle = angles[n];
        if (typeof angle === 'number' && typeof min === 'number' && typeof max === 'number' && min < max) {
            const left = Math.min(angle - min, max - angle);
            found = !found || left < found.left ? { name: joint.name, left } : found;
        }
    });
    return found;
}

/** What is known of a stop, as stopWords() of one robot. null: there is none. */
export function fleetStopWords(state, waited, t) {
    if (waited > 0 && !(state && state.latch)) {
        return waited > 700
            ? { level: 'bad', text: t('STOP sent, no answer for {0} s: use the switches', (waited / 1000).toFixed(1)) }
            : { level: 'warn', text: t('STOP sent') };
    }
    if (!state || !state.latch) {
        return null;
    }
    const n = count(state.robots.map((r) => r.stop)), total = state.robots.length - (n.away || 0);
    const who = state.latch.kind === 'stop' ? t('Stopped') : t('emergency stop');
    if (state.confirmed) {
        return { level: 'ok', text: `${who}: ${t('all {0} robots stand', total)}` };
    }
    return { level: n.moving || n.silent ? 'bad' : 'warn',
             text: `${who}: ${t('{0} of {1} robots stand', n.stopped || 0, total)}` };
}

/** Whether a robot is one that is looked for. @param want ( text, group, trouble ) */
export function isWanted(robot, facts, want, level) {
    const words = [robot.host, robot.robot, facts.model, robot.motion, robot.trip, ...facts.groups];
    return want.text.toLowerCase().split(/\s+/).every(
        (word) => words.some((w) => w && w.toLowerCase().includes(word))) &&
        (!want.group || facts.groups.includes(want.group)) &&
        (!want.trouble || level === 'bad' || level === 'warn');
}
