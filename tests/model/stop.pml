/* SPDX-License-Identifier: MIT */
/*
 * The protocol by which programs of one robot stop each other, as a model that Spin searches whole:
 * marks, holders and answers of emergency stops (src/link/guard/estop.c), the word that says who has
 * the line (src/link/guard/guard.h), and the guard (src/link/guard/run.c). A step is called as the
 * function that it stands for.
 *
 * A program moves the robot, looks at marks, resets, leaves, and opens the device again. It may be
 * killed, stopped and continued at any step. Two commands set an emergency stop each, wait for an
 * answer as long as they like, ask the guard if none came, and open the device where nobody has it.
 *
 * Rules:
 *   - nothing leaves the program once its guard has sent;
 *   - never two have the line;
 *   - where a stop was reported done, the robot was stopped behind it, and does not move before it is
 *     cleared;
 *   - a stop is cleared only when it has reached the robot;
 *   - at the end no joint is on its way that no program has in hand, and no stop that stands has not
 *     reached the robot.
 *
 * What it leaves out: time. A guard waits for a quiet line (await_quiet()), here until the program
 * is not between its look at the word and its write. One that is stopped just there, or whose
 * mark is replaced between the read and the removal of a clear, is not modelled: of these steps each
 * pair is one.
 *
 * Sabotages (make check-model tries each): 1 the program gives the line up without an exchange, 2 a reset does
 * not look at marks before it clears them, 3 a session opens without a look at marks, 4 the guard
 * sends before the line is its own. Each must break a rule.
 */
#ifndef SABOTAGE
#define SABOTAGE 0
#endif

#define STOPS 2 /* emergency stops, by number; 0: none */
#define OPENS 2 /* times that the program opens the device */

mtype = { PROGRAM, GUARD, NOBODY };       /* guard_shared.line */
mtype = { SILENT, HEARD, DONE };          /* grobo_estop_answer */
mtype = { FREE, BY_PROGRAM, BY_COMMAND }; /* who has locked the device */

/* files */
byte mark = 0;
bool holder = false;
mtype answer[STOPS + 1] = SILENT;

/* shared memory, the device's lock, and messages */
mtype line = NOBODY;
mtype device = FREE;
bool guarded = false; /* the guard has the port */
bool moves = false;   /* grobo_i_guard_tell() */
bool latch = false;   /* and that the policy is an emergency stop */
bool asked = false;   /* grobo_estop_force() */

/* the program */
bool alive = true, stopped = false, ended = false;
byte opens = 0;
byte heard = 0;
bool latched = false, owed = false, opened = false;

/* the robot, seen from outside */
bool turns = false;
bool guard_sent = false;         /* since the program had the line last */
bool reached[STOPS + 1] = false; /* the robot was stopped behind it */
byte commands = 0;               /* that have ended */

/* A frame that stops the robot has left. */
inline halt_leaves()
{
    turns = false;
    if
    :: mark != 0 -> reached[mark] = true
    :: else
    fi
}

#if SABOTAGE == 2
#define CLEARED true
#else
#define CLEARED (mark == heard)
#endif

#define UP (alive && !stopped && opened)
#define TAKEN (line == GUARD)

/* ---- the program ---------------------------------------------------------------------------- */

/* grobo_i_estop_watch_look(): true where a mark stands that was not heard. */
inline grobo_i_estop_watch_look(fresh)
{
    fresh = (mark != 0 && mark != heard);
    if
    :: fresh -> heard = mark
    :: else
    fi
}

inline obey_mark()
{
    latched = true;
    owed = true;
    latch = true;
    if
    :: answer[heard] != DONE -> answer[heard] = HEARD
    :: else
    fi
}

/* A session opens the device: grobo_serial_open(), grobo_i_estop_watch_begin(),
 * grobo_i_session_guard_take(), then grobo_i_session_estop_arm(), before anything else leaves. */
inline grobo_session_open()
{
    atomic {
        alive && !stopped && !opened && !ended && opens < OPENS && device == FREE;
        device = BY_PROGRAM;
        opens++;
        opened = true;
        holder = true;
        heard = 0;
        latched = false;
        owed = false;
    }
    atomic {
        if
        :: UP -> line = PROGRAM; guarded = true; guard_sent = false; moves = false; latch = false
        :: !alive -> skip
        fi
    }
#if SABOTAGE != 3
    atomic {
        if
        :: UP -> /* grobo_i_session_estop_arm() */
            grobo_i_estop_watch_look(fresh);
            if
            :: fresh && answer[heard] == DONE -> latched = true; latch = true
            :: fresh && answer[heard] != DONE -> obey_mark()
            :: else
            fi
        :: !alive -> skip
        fi
    }
#endif
}

/* A frame leaves: the word is looked at before it does. */
inline move_leaves()
{
    atomic {
        UP && !latched && !TAKEN && line == PROGRAM;
        moves = true;
        turns = true;
        assert(!guard_sent);
        assert(!(mark != 0 && answer[mark] == DONE))
    }
}

inline estop_leaves()
{
    atomic {
        UP && owed && line == PROGRAM;
        assert(!guard_sent);
        turns = false;
        moves = false;
        if
        :: heard != 0 -> reached[heard] = true
        :: else
        fi
    }
    atomic { /* grobo_i_session_estop_ended(), grobo_i_estop_watch_answer() */
        if
        :: UP -> owed = false; if :: heard != 0 -> answer[heard] = DONE :: else fi
        :: !alive -> skip
        fi
    }
}

/* on_reset(): looks, and clears what it has heard and carried out. */
inline on_reset()
{
#if SABOTAGE == 2
    UP && latched && !owed && !TAKEN;
#else
    atomic {
        UP && latched && !owed && !TAKEN;
        grobo_i_estop_watch_look(fresh);
        if
        :: fresh -> obey_mark()
        :: else
        fi
    }
#endif
    atomic {
        if
        :: UP && !owed ->
            if /* grobo_i_estop_clear() */
            :: mark != 0 && CLEARED -> assert(reached[mark]); mark = 0; latched = false; latch = false
            :: mark == 0 -> latched = false; latch = false
            :: else
            fi
        :: !alive || owed -> skip
        fi
    }
}

/* The exit policy, then the session is freed: withdraw(), grobo_i_estop_watch_end(). */
inline grobo_session_close()
{
    atomic {
        UP && !TAKEN && !owed && line == PROGRAM;
        turns = false;
        moves = false
    }
#if SABOTAGE == 1
    if
    :: UP && line == PROGRAM -> atomic { UP; line = NOBODY; guarded = false }
    :: UP && line == GUARD -> skip
    :: !alive -> skip
    fi;
#else
    atomic { /* withdraw() */
        if
        :: UP && line == PROGRAM -> line = NOBODY; guarded = false
        :: UP && line == GUARD -> skip
        :: !alive -> skip
        fi
    }
#endif
    atomic {
        if
        :: UP && line != GUARD -> opened = false; holder = false; device = FREE
        :: UP && line == GUARD -> opened = false; holder = false /* grobo_i_port_abandon() */
        :: !alive -> skip
        fi
    }
}

active proctype program()
{
    bool fresh;

    if
    :: grobo_session_open()
    :: !alive -> goto gone
    fi;
    do
    :: move_leaves()
    :: atomic { UP && !TAKEN && mark != heard; grobo_i_estop_watch_look(fresh);
                if :: fresh -> obey_mark() :: else fi }
    :: estop_leaves()
    :: on_reset()
    :: grobo_session_close();
        if
        :: grobo_session_open()
        :: atomic { alive && !stopped && !opened -> ended = true }; break
        :: !alive -> break
        fi
    :: atomic { UP && TAKEN -> opened = false; holder = false }; /* grobo_i_session_guard_hear() */
        if
        :: grobo_session_open()
        :: atomic { alive && !stopped && !opened -> ended = true }; break
        :: !alive -> break
        fi
    :: !alive -> break
    od;
gone:
    skip
}

/* The system. SIGKILL may come at any time, SIGSTOP once, and SIGCONT behind it. */
active proctype signals()
{
    if
    :: atomic { !ended -> stopped = true };
        if
        :: atomic { alive -> stopped = false }
        :: atomic { alive = false; stopped = false }
        fi
    :: skip
    fi;
    if
    :: atomic { !ended -> alive = false; stopped = false }
    :: skip
    fi
}

/* ---- its guard ------------------------------------------------------------------------------ */

/* stop(): await_quiet(), then an engine on its own port; closes it. */
inline stop()
{
    atomic {
        guard_sent = true;
        halt_leaves();
        if
        :: asked && mark != 0 -> answer[mark] = DONE /* what the command makes of it */
        :: else
        fi;
        moves = false;
        guarded = false;
        asked = false;
        device = FREE
    }
}

/* claim(): by one exchange; the program may just be giving it up. */
inline claim(mine)
{
    atomic {
        if
        :: guarded && line == PROGRAM -> line = GUARD; mine = true
        :: else -> mine = false
        fi
    }
}

active proctype guard()
{
    bool mine;

    do
    :: guarded && (!alive || (stopped && moves) || asked) ->
#if SABOTAGE == 4
        atomic { guard_sent = true; turns = false };
#endif
        claim(mine);
        if
        :: mine -> stop()
        :: else
        fi
    :: !guarded && !alive && device == BY_PROGRAM -> device = FREE /* the system closes it */
    :: !guarded && (!alive || ended) && device != BY_PROGRAM && commands == STOPS -> break
    od
}

/* ---- grctl estop ---------------------------------------------------------------------------- */

proctype command(byte its)
{
    atomic { mark = its; answer[its] = SILENT }; /* grobo_estop_set() */
    do
    :: atomic { answer[its] == DONE -> assert(reached[its]) }; break
    :: atomic { (mark != its) -> skip }; break /* another one took its place, or it was cleared */
    :: atomic { guarded && answer[its] != DONE && mark == its -> asked = true } /* by the guard */
    :: atomic { device == FREE && mark == its && answer[its] != DONE; device = BY_COMMAND };
        atomic { /* a session of its own, armed before anything else */
            halt_leaves();
            if
            :: mark == its -> answer[its] = DONE
            :: else
            fi;
            device = FREE
        }
    od;
    commands++
}

init
{
    run command(1);
    run command(2)
}

/* ---- at the end ----------------------------------------------------------------------------- */

active proctype judge()
{
    atomic {
        commands == STOPS && (!alive || ended) && !guarded && device == FREE;
        assert(!turns);
        assert(mark == 0 || reached[mark])
    }
}
