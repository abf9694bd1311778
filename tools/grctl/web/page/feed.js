// SPDX-License-Identifier: MIT
// The stream of states and events, read by fetch (an EventSource cannot send the token). A stream
// that says nothing for 1.5 s is dead; then it is opened again, after pauses that grow.

const SILENCE_MS = 1500;
const PAUSES_MS = [150, 400, 1000, 2000, 4000];

/** Cuts server-sent events out of text that comes in pieces. */
export class EventParser {
    constructor(take) {
        this.take = take;
        this.rest = '';
    }

    push(text) {
        const parts = (this.rest + text).replace(/\r\n/g, '\n').split('\n\n');
        this.rest = parts.pop();
        for (const part of parts) {
            const event = { type: 'message', id: null, data: '' };
            for (const line of part.split('\n')) {
                const [, name, value] = line.match(/^([a-z]*): ?(.*)$/) || [];
                if (name === 'data') {
                    event.data += event.data ? `\n${value}` : value;
                } else if (name === 'event') {
                    event.type = value;
                } else if (name === 'id') {
                    event.id = value;
                }
            }
            if (event.data) {
                this.take(event);
            }
        }
    }
}

/** How long to wait before the n-th attempt since the stream was last heard, in ms. */
export function pauseMs(n, random = Math.random()) {
    return PAUSES_MS[Math.min(n, PAUSES_MS.length - 1)] * (0.8 + 0.4 * random);
}

export class Feed {
    /** @param tell called with { type: 'state' | 'event' | 'up' | 'down', ... } */
    constructor(tell) {
        this.tell = tell;
        this.last = null;
        this.tries = 0;
        this.running = false;
    }

    start(token) {
        this.token = token || this.token;
        if (!this.running) {
            this.running = true;
            this.tries = 0;
            this.open();
        }
    }

    stop() {
        this.running = false;
        clearTimeout(this.timer);
        if (this.abort) {
            this.abort.abort();
        }
    }

    async open() {
        const abort = this.abort = new AbortController();
        let why = null;
        try {
            const headers = {};
            if (this.token) {
                headers['X-Grobo-Token'] = this.token;
            }
            if (this.last !== null) {
                headers['Last-Event-ID'] = this.last;
            }
            this.watch(abort);
            const answer = await fetch('/api/events', { headers, cache: 'no-store',
                                                        signal: abort.signal });
            if (!answer.ok) {
                throw new Error(`HTTP ${answer.status}`);
            }
            await this.read(answer.body.getReader(), abort);
        } catch (error) {
            why = error.message;
        }
        if (this.abort !== abort) {
            return; // there is a new one, with a silence of its own
        }
        clearTimeout(this.silence);
        if (this.running) {
            const wait = pauseMs(this.tries++);
            this.tell({ type: 'down', wait, why });
            this.timer = setTimeout(() => this.open(), wait);
        }
    }

    async read(reader, abort) {
        const decoder = new TextDecoder();
        const parser = new EventParser((event) => {
            const data = JSON.parse(event.data);
            if (event.id !== null) {
                this.last = event.id;
            }
            this.tries = 0;
            this.tell({ type: event.type, data });
        });
        this.tell({ type: 'up' });
        for (;;) {
            const { done, value } = await reader.read();
            if (done) {
                return;
            }
            this.watch(abort);
            parser.push(decoder.decode(value, { stream: true }));
        }
    }

    watch(abort) {
        clearTimeout(this.silence);
        this.silence = setTimeout(() => abort.abort(), SILENCE_MS);
    }
}
