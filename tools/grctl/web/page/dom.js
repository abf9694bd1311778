// SPDX-License-Identifier: MIT
// Small helpers for elements. Text from the server is only ever set as text.

/** An element with properties and children; a child that is a string is text. */
export function element(name, properties = {}, ...children) {
    const made = Object.assign(document.createElement(name), properties);
    made.append(...children);
    return made;
}

/** Replaces children, but leaves what is the same: focus and selection stay. */
export function replace(parent, ...children) {
    const same = parent.childNodes.length === children.length &&
        children.every((child, n) => child.isEqualNode(parent.childNodes[n]));
    if (!same) {
        parent.replaceChildren(...children);
    }
}

/** Sets text where it differs, so that a reader is not disturbed. */
export function setText(node, text) {
    if (node.textContent !== text) {
        node.textContent = text;
    }
}

export function seconds(ms) {
    return (ms / 1000).toFixed(1);
}

/** Keys on a slider of degrees: arrows 1, page keys 10; `done` after each. */
export function stepByKeys(slider, done) {
    slider.addEventListener('keydown', (event) => {
        const step = { PageUp: 10, PageDown: -10, ArrowUp: 1, ArrowRight: 1, ArrowDown: -1,
                       ArrowLeft: -1 }[event.key];
        if (step && !event.altKey && !event.ctrlKey && !event.metaKey) {
            event.preventDefault();
            slider.value = Number(slider.value) + step;
            done();
        }
    });
}

/** @type {(yes: boolean) => void} */
let answer = () => {};

/**
 * Asks beside the page, which goes on: a window of the browser's own (confirm) holds up heartbeats,
 * states and STOP. Another question, or Esc in it, is a no.
 * @returns a promise of the answer
 */
export function ask(text) {
    const box = document.getElementById('ask'), before = document.activeElement;
    answer(false);
    setText(box.firstElementChild, text);
    box.show();
    box.querySelector('[value=no]').focus();
    return new Promise((done) => {
        answer = (yes) => {
            answer = () => {};
            box.close();
            before.focus({ preventScroll: true });
            done(yes);
        };
        box.onclick = ({ target }) => target.value && answer(target.value === 'yes');
        box.onkeydown = ({ key }) => key === 'Escape' && answer(false);
    });
}

/** A short tremor where the machine has one: a limit that a finger feels. */
export function tremble() {
    if (navigator.vibrate) {
        navigator.vibrate(12);
    }
}

/** A setting of this browser; a browser that keeps none has the default. */
export function setting(key, value) {
    try {
        if (value !== undefined) {
            localStorage.setItem(key, value);
        }
        return localStorage.getItem(key);
    } catch (error) {
        return null;
    }
}

/** Texts of the page itself. @param t translator */
export function translatePage(lang, t) {
    document.documentElement.lang = lang;
    for (const node of document.querySelectorAll('[data-t]')) {
        node.textContent = t(node.textContent);
    }
    for (const node of document.querySelectorAll('[data-t-label]')) {
        node.setAttribute('aria-label', t(node.dataset.tLabel));
        node.title = node.matches('button') ? t(node.dataset.tLabel) : '';
    }
}

/** An angle in what people give the joint in: degrees, mm, percent of a gripper's range. */
export function valueOf(joint, deg) {
    return joint.unit ? (deg - joint.unit_zero_deg) / joint.unit_deg : deg;
}

/** The angle at which a joint has a value. */
export function degreesOf(joint, value) {
    return joint.unit ? joint.unit_zero_deg + value * joint.unit_deg : value;
}

/** What stands behind the number: "°", " mm", " %". */
export function unitOf(joint) {
    return joint.unit ? ` ${joint.unit}` : '°';
}

/** The value of a joint in words: "12.0°". */
export function valueText(joint, deg, digits = 1) {
    const text = valueOf(joint, deg).toFixed(digits);
    return `${Number(text) === 0 ? (0).toFixed(digits) : text}${unitOf(joint)}`;
}

/** The limits of a joint in its unit, the lower value first. */
export function limitValues(joint) {
    const [a, b] = joint.limits_deg.map((deg) => valueOf(joint, deg));
    return a < b ? [a, b] : [b, a];
}
