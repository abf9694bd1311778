// SPDX-License-Identifier: MIT
// Who drives, seen from this page. The server tells all pages the holder's id; this page's own lease is
// the one whose id it was told. It is lost when the state names another holder, or none.
//
//   free --take--> hoped --state names us--> mine --state names another, or nobody--> free, other
//   other --ask--> asked --given: the state names us--> mine
//                  asked --10 s, take--> hoped

const HOPE_MS = 2000;

export class Lease {
    constructor() {
        this.mine = null;
        this.ask = null;
        this.holder = null;
        this.asker = null;
    }

    /** The server gave a lease: { lease, id }. */
    taken({ lease, id }, now) {
        this.mine = { lease, id, at: now, seen: false };
        this.ask = null;
    }

    /** This page gave it back. */
    given() {
        this.mine = null;
    }

    /** The server took note that this page asks: { lease, id }. */
    asked({ lease, id }, now) {
        this.ask = { lease, id, at: now };
    }

    /** For X-Grobo-Lease; null: this page does not drive. */
    secret() {
        return this.mine && this.mine.lease;
    }

    /** A state came. @returns 'got' or 'lost' when this page's part changed by it, else null */
    see({ holder, asked }, now) {
        this.holder = holder;
        this.asker = asked;
        if (this.ask && holder && holder.id === this.ask.id) {
            this.mine = { ...this.ask, seen: true };
            this.ask = null;
            return 'got';
        }
        if (this.ask && !(asked && asked.id === this.ask.id) && now - this.ask.at > HOPE_MS) {
            this.ask = null; // denied, or the asker is another now
        }
        if (!this.mine) {
            return null;
        }
        if (holder && holder.id === this.mine.id) {
            this.mine.seen = true;
        } else if (this.mine.seen || now - this.mine.at > HOPE_MS) {
            this.mine = null;
            return 'lost';
        }
        return null;
    }

    /** 'mine', 'free', 'other' (another drives) or 'asked' (and this page asked to). */
    status() {
        return this.mine ? 'mine' : this.ask ? 'asked' : this.holder ? 'other' : 'free';
    }
}
