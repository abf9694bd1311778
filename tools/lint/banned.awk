# SPDX-License-Identifier: MIT
# Gate: functions that are not called. Words are compared whole, outside comments and strings.

function ban(names, why,    list, n, i) {
    n = split(names, list, " ")
    for (i = 1; i <= n; i++) {
        reason[list[i]] = why
    }
}

function forbid(names, why, where,    list, n, i) {
    n = split(names, list, " ")
    for (i = 1; i <= n; i++) {
        reason[list[i]] = why
        place[list[i]] = where
    }
}

BEGIN {
    ban("strcpy strcat stpcpy sprintf vsprintf gets strncpy strncat", "no bound, or half of one")
    ban("strtok", "keeps hidden state")
    ban("atoi atof atol atoll", "cannot tell an error")
    ban("alloca", "no bound on the stack")
    ban("setjmp longjmp sigsetjmp siglongjmp", "jumps over clean-up")
    forbid("sleep usleep nanosleep", "wait for an event instead", "^(src|ports|tests)/")
    forbid("printf vprintf puts putchar perror stdout stderr", "the library never prints",
        "^(src|ports)/")
    forbid("exit abort _exit", "a library does not end the program", "^(src|ports)/")
    forbid("malloc calloc realloc free strdup strndup", "allocate through grobo_mem", "^src/")
    forbid("errno", "only ports/ meets the operating system",
           "^src/(base|model|play|bus|servo|robot|sim|body)/")
}

# The classic shelf is a program for the library: it prints as the reference document says, and its
# objects are the C library's.
FILENAME ~ /(^|\/)src\/classic\// { classic = 1 }
FILENAME !~ /(^|\/)src\/classic\// { classic = 0 }

# The one place where grobo_mem_default() meets the C library.
FILENAME ~ /(^|\/)base\/memory\.c$/ { next }

{
    rest = code
    while (match(rest, /[A-Za-z_][A-Za-z0-9_]*/)) {
        word = substr(rest, RSTART, RLENGTH)
        before = substr(rest, 1, RSTART - 1)
        rest = substr(rest, RSTART + RLENGTH)
        if (!(word in reason) || ((word in place) && FILENAME !~ place[word])) {
            continue
        }
        if (classic && word ~ /^(malloc|calloc|realloc|free|stderr)$/) {
            continue
        }
        # A member (x->free) or a header's name (<setjmp.h>) is not a call; a stream needs no call.
        if (before ~ /(\.|->)$/ || (rest !~ /^ *\(/ && word !~ /^(stdout|stderr|errno)$/)) {
            continue
        }
        complain("banned: " word ": " reason[word])
    }
}
