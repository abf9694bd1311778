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
