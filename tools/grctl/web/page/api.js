// SPDX-License-Identifier: MIT
// Requests to the server (docs/serve.md). A refusal is thrown as an ApiError with the server's words.

export class ApiError extends Error {
    constructor(status, error) {
        super(error.message);
        this.status = status;
        Object.assign(this, { code: error.code, joint: error.joint, holder: error.holder });
    }
}

/**
 * The token of the link that opened the page; kept for reloads, and out of the address bar. In a
 * browser that keeps nothing it stays there.
 */
export function takeToken() {
    const [, token = null] = location.hash.match(/token=([^&]+)/) || [];
    try {
        if (token) {
            sessionStorage.setItem('token', token);
            history.replaceState(null, '', location.pathname + location.search);
        }
        return sessionStorage.getItem('token');
    } catch (error) {
        return token;
    }
}

export class Api {
    constructor(token) {
        this.token = token;
        this.lease = null;
        this.stopPort = null;
    }

    async request(method, path, body, extra = {}) {
        const headers = { ...extra };
        if (this.token) {
            headers['X-Grobo-Token'] = this.token;
        }
        if (this.lease && method !== 'GET') {
            headers['X-Grobo-Lease'] = this.lease;
        }
        if (body !== undefined) {
            headers['Content-Type'] = 'application/json';
        }
        const answer = await fetch(path, { method, headers, cache: 'no-store',
                                           body: body === undefined ? body : JSON.stringify(body) });
        const text = await answer.text();
        let data = {};
        try {
            data = JSON.parse(text);
        } catch (error) {
            data = { error: { code: 'io', message: `HTTP ${answer.status}` } };
        }
        if (!answer.ok) {
            throw new ApiError(answer.status, data.error);
        }
        return data;
    }

    get(path) {
        return this.request('GET', path);
    }

    /** @returns {Promise<any>} what the server answers */
    post(path, body = {}) {
        return this.request('POST', path, body);
    }

    /** To the port for stop and heartbeat alone; the browser does not show the answer. */
    aside(path, body) {
        const at = `${location.protocol}//${location.hostname}:${this.stopPort}${path}`;
        const whole = this.token ? { ...body, token: this.token } : body;
        return fetch(at, { method: 'POST', mode: 'no-cors', cache: 'no-store',
                           headers: { 'Content-Type': 'text/plain' }, body: JSON.stringify(whole) });
    }

    /** As a page that goes away may still send. */
    beacon(path, body) {
        navigator.sendBeacon(path, JSON.stringify(this.token ? { ...body, token: this.token } : body));
    }
}

/**
 * Sends the newest of many targets: one request is under way, what comes meanwhile replaces itself.
 * A target that moves the robot names the state that was drawn when it was pushed, not when it is
 * sent: after a gap of the network it is stale.
 * After each it rests for pauseMs: the server takes 100 a second of all pages.
 */
export class Newest {
    constructor(send, pauseMs = 0) {
        this.send = send;
        this.pauseMs = pauseMs;
        this.busy = false;
        this.next = undefined;
    }

    async push(value) {
        this.next = value;
        if (this.busy) {
            return;
        }
        this.busy = true;
        while (this.next !== undefined) {
            const now = this.next;
            this.next = undefined;
            await this.send(now);
            if (this.pauseMs) {
                await new Promise((done) => setTimeout(done, this.pauseMs));
            }
        }
        this.busy = false;
    }
}
