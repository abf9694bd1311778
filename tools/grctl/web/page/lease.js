// SPDX-License-Identifier: MIT
// Who drives, seen from this page. The server tells all pages the holder's name and since when; this
// page's own lease is the one that appeared after it was taken, and is lost when that holder changes.
//
//   free --take--> hoped --state names us--> mine --state names another, or nobody--> lost (free, other)
//   other --ask--> asked --10 s, take--> hoped

const HOPE_MS = 2000;

export class Lease {
    constructor() {
        this.id = null;
        this.name = null;
        this.since = null;
        this.tookAt = 0;
        this.askedAt = null;
        this.holder = null;
        this.asker = null;
    }

    /** The server gave a lease. */
    taken(id, name, now) {
        Object.assign(this, { id, name, since: null, tookAt: now, askedAt: null });
    }

    /** This page gave it back. */
    given() {
        this.id = null;
        this.since = null;
    }

    /** This page asks; take works askMs later. */
    asked(now) {
        this.askedAt = now;
    }

    /** A state came. @returns true: the lease of this page was lost just now */
    see({ holder, asked }, now) {
        this.holder = holder;
        this.asker = asked;
        if (!holder) {
            this.askedAt = null;
        }
        if (!this.id) {
            return false;
        }
        const named = holder && holder.name === this.name;
        if (named && this.since === null) {
            this.since = holder.since_ms;
        }
        const ours = named && holder.since_ms === this.since;
        if (ours || this.since === null && now - this.tookAt < HOPE_MS) {
            return false;
        }
        this.given();
        return true;
    }

    /** 'mine', 'free', 'other' (another drives) or 'asked' (and this page asked to). */
    status() {
        if (this.id) {
            return 'mine';
        }
        if (!this.holder) {
            return 'free';
        }
        return this.askedAt === null ? 'other' : 'asked';
    }
}
