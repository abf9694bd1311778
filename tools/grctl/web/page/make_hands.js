// SPDX-License-Identifier: MIT
// Hands on the figure: a joint of the draft that is turned by a drag, and handles of waist and feet
// that are moved in the plane of the picture. They change the draft, never the robot.

import { forward, stand } from './body.js';
import { DEG, add, origin, place, rigidInverse, rotation, sub, turn } from './mat.js';

const LEAST_PX = 40; // a radian of a joint seen along its lever is at least so long

export class Hands {
    /** @param make the view: { app, pose(), turnJoint(joint, deg, tag), moveHandle(n, p), rest() } */
    constructor(make) {
        this.make = make;
        this.count = 0;
    }

    get figure() {
        return this.make.app.figure;
    }

    /** The handles: 'waist', 'right_foot', 'left_foot', with the link of each. */
    handles() {
        const { robot } = this.make.app;
        return robot && robot.body ? [
            { name: 'waist', link: 0 },
            ...robot.body.feet.map((foot) => ({ name: `${foot.side}_foot`, link: foot.link }))] : [];
    }

    /** Where the links of a pose are. */
    placed(pose) {
        const { body } = this.figure, q = pose.q.map((v) => Number.isFinite(v) ? v : 0);
        return forward(body, q, pose.root || stand(body, q));
    }

    /** A press at a point of the figure. @returns ( move, end ) or null: it turns the picture */
    grab(x, y, touch) {
        const { figure } = this;
        if (!figure.at) {
            return null;
        }
        const handle = this.handles().find((one) => {
            const [hx, hy] = figure.onScreen(origin(figure.at[one.link]));
            return Math.hypot(hx - x, hy - y) < 20;
        });
        if (handle) {
            return this.grabHandle(handle, x, y);
        }
        const hit = figure.hitAt(x, y);
        if (hit.joint < 0 || touch && hit.joint !== this.make.app.selected) {
            return null; // a finger chooses first: it is put down to turn the picture too
        }
        return this.grabJoint(hit, x, y);
    }

    grabHandle(handle, x, y) {
        const { figure, make } = this, begin = origin(figure.at[handle.link]);
        const pose = make.pose(), tag = `drag ${++this.count}`;
        make.chooseHandle(handle.name);
        return {
            taken: true,
            move: (nx, ny) => make.moveHandle(handle.name, add(begin, figure.slideOf(begin, nx - x, ny - y)),
                                              pose, tag),
            end: () => make.rest(),
        };
    }

    /** The point that was pressed follows the pointer, as far as its joint lets it. */
    grabJoint({ joint, point }, x, y) {
        const { figure, make } = this, { body } = figure, n = body.linkOf[joint];
        const at = figure.at[n], axis = turn(at, body.links[n].axis), centre = origin(at);
        const begin = make.pose(), tag = `drag ${++this.count}`, local = place(rigidInverse(at), point);
        let deg = make.angleOf(joint), before = [x, y], moved = false;
        return {
            move: (nx, ny) => {
                if (!moved) {
                    moved = true;
                    make.app.select(joint, true);
                    make.freeze(begin.root || stand(body, begin.q)); // the ground comes back at the end
                }
                const here = place(this.placed(make.pose())[n], local), small = 0.02;
                const lever = sub(here, centre), turned = turn(rotation(axis, small), lever);
                const [a, b] = [figure.onScreen(here), figure.onScreen(add(centre, turned))];
                let way = [(b[0] - a[0]) / small, (b[1] - a[1]) / small];
                const far = Math.hypot(...way);
                if (far < LEAST_PX) { // seen along its lever: up and right are more
                    way = far < 1 ? [LEAST_PX, -LEAST_PX] : way.map((v) => v * LEAST_PX / far);
                }
                const step = ((nx - before[0]) * way[0] + (ny - before[1]) * way[1]) /
                             (way[0] ** 2 + way[1] ** 2) / DEG;
                before = [nx, ny];
                deg = make.turnJoint(joint, deg + Math.max(-30, Math.min(30, step)), tag);
            },
            end: () => {
                make.freeze(null);
                make.rest();
            },
        };
    }
}
