// SPDX-License-Identifier: MIT
// What tsc cannot know of the page (make analyse): which kind of element has an id or is a child,
// and what the page keeps at its window. Its own mistakes are found by Chromium (make check-cockpit).

interface Document {
    getElementById(id: string): any;
    activeElement: any;
}
interface ParentNode {
    querySelector(selectors: string): any;
    querySelectorAll(selectors: string): NodeListOf<any>;
}
interface Element {
    closest(selectors: string): any;
}
interface Window {
    cockpit: any; // App or View, for tests
    onconnect: any; // of a shared worker
}
