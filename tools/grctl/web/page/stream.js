// SPDX-License-Identifier: MIT
// The page's end of the stream: through the worker that all pages share where the browser has such
// workers, else by itself. A hidden page has none.

import { Feed } from './feed.js';

function shared(token, tell) {
    const worker = new SharedWorker(new URL('worker.js', import.meta.url), { type: 'module', name: 'grctl' });
    worker.port.onmessage = ({ data }) => tell(data);
    worker.port.start();
    return (message) => worker.port.postMessage({ token, ...message });
}

function own(token, tell) {
    const feed = new Feed(tell);
    return ({ visible }) => visible ? feed.start(token) : feed.stop();
}

/** Streams to tell while the page is visible. */
export function openStream(token, tell) {
    const send = self.SharedWorker ? shared(token, tell) : own(token, tell);
    const say = () => send({ visible: !document.hidden });
    document.addEventListener('visibilitychange', say);
    addEventListener('pageshow', say);
    addEventListener('pagehide', () => send({ bye: true, visible: false }));
    setInterval(() => document.hidden || say(), 4000);
    say();
}
