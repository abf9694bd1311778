// SPDX-License-Identifier: MIT
// The views of the cockpit as tabs. Which one is chosen is kept in this browser.

import { setting } from './dom.js';

export const TABS = ['see', 'play', 'joints', 'make', 'more'];
const PANELS = { see: 'see', play: 'motions', joints: 'joints', make: 'make', more: 'more' };
const id = (name) => document.getElementById(name);

/** The panel of a view, and its tab. */
export function showPanel(tab) {
    const name = TABS.includes(tab) ? tab : 'see';
    document.body.dataset.tab = name;
    setting('tab', name);
    TABS.forEach((one) => {
        id(`tab-${one}`).setAttribute('aria-selected', String(one === name));
        id(`tab-${one}`).tabIndex = one === name ? 0 : -1;
        id(PANELS[one]).hidden = one !== name;
    });
}
