// SPDX-License-Identifier: MIT
// What a page does first: STOP, its language, colours and tab. It is small and stands alone, so that a
// page whose view comes late, or not at all, stops what moves all the same. The view is loaded when
// the page has been drawn for the first time: `later` of the HTML names its module, then all that
// that imports, so that they come at once.

import { Api, takeToken } from './api.js';
import { setText, setting, translatePage } from './dom.js';
import { Stopper } from './stop.js';
import { showPanel } from './tabs.js';
import { translate } from './text.js';

const PAINT_MS = 1000; // of a browser that does not tell when it has drawn

export const id = (name) => document.getElementById(name);
export const lang = setting('lang') || (navigator.language.startsWith('ja') ? 'ja' : 'en');
export const t = (text, ...values) => translate(lang, text, values);
export const api = new Api(takeToken());

/** The view of the page says later who presses, and what is known of it. */
export const stopper = new Stopper(api, () => setting('name') || t('Computer'), () => {
    setText(id('stop-words'), t('STOP sent'));
    id('stopped').hidden = false;
});

/** When the page was drawn for the first time, or nobody sees it. */
/** @type {Promise<void>} */
const painted = new Promise((done) => {
    if (document.hidden) {
        done();
    }
    const look = (list) => list.getEntriesByName('first-contentful-paint').forEach(() => done());
    new PerformanceObserver(look).observe({ type: 'paint', buffered: true });
    setTimeout(done, PAINT_MS);
});

id('stop').addEventListener('pointerdown', () => stopper.press());
id('stop').addEventListener('click', (event) => event.detail === 0 && stopper.press());
document.addEventListener('keydown', (event) => {
    if (event.key === 'Escape') {
        event.preventDefault();
        if (!event.repeat) {
            stopper.press();
        }
    }
}, true);
// The link of a server that was started anew, opened in the tab of the one before.
addEventListener('hashchange', () => location.hash.includes('token=') && location.reload());
document.body.classList.remove('unarmed');
document.documentElement.dataset.theme = setting('theme') || '';
translatePage(lang, t);
if (id('tabs')) {
    showPanel(setting('tab'));
}
painted.then(() => {
    const later = document.querySelectorAll('link[data-later]');
    later.forEach((link) => {
        link.rel = 'modulepreload';
    });
    return import(later[0].href);
}).catch((error) => {
    console.error(`${error.name}: ${error.message}`);
    setText(id('notice'), t('No connection to the server.'));
    id('notice').hidden = false;
});
