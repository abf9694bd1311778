// SPDX-License-Identifier: MIT
// One stream for all pages of a browser: a browser opens six connections to a server, and six pages
// with a stream each would leave none for anything else. The stream is open while a page is visible.
// A page that is closed says so, or is forgotten when it has said nothing for 12 s.

import { Feed } from './feed.js';

const pages = new Map();
const feed = new Feed((message) => {
    for (const [port, page] of pages) {
        if (page.visible) {
            port.postMessage(message);
        }
    }
});

function decide(token) {
    if ([...pages.values()].some((page) => page.visible)) {
        feed.start(token);
    } else {
        feed.stop();
    }
}

setInterval(() => {
    for (const [port, page] of pages) {
        if (page.visible && Date.now() - page.heard > 12000) {
            page.visible = false;
        }
    }
    decide();
}, 3000);

self.onconnect = (event) => {
    const port = event.ports[0];
    port.onmessage = ({ data }) => {
        if (data.bye) {
            pages.delete(port);
        } else {
            pages.set(port, { visible: data.visible, heard: Date.now() });
        }
        decide(data.token);
    };
};
