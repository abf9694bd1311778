#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's server: who may ask what, streams, motions, poses.
. tests/support/pages.sh

has_jsonschema() {
    python3 -c 'import jsonschema' 2>/dev/null
}

check "hosts, origins, tokens, methods that are refused" pages refusals
check "what is too large or never whole is refused" pages sizes
check "no path leads out of the folder" pages escapes
check "beyond loopback everything needs the token" pages beyond_loopback
check "the link leads to the page, wherever it listens" pages printed_links
check "the page: compressed, known by its hash, under a policy" pages page_files
check "states come 30 times a second, events are kept" pages stream
check "a stream that sends something is dropped" pages greedy
check "a stream that does not read is dropped, the others miss nothing" pages slow
check "a stop comes through where all places are taken" pages crowd
check "a stop comes through where connections stay half open" pages half_open
check "a stop comes through where another page holds all places" pages foreign
check "motions are listed, previewed, edited to the bit" pages motions
check "key poses are mirrored, feet moved, motions saved elsewhere" pages making
check "a motion that would fall says when" pages falls
check "feet and waist are dragged" pages ik
check "a motion of another robot says so, and is not played" pages other_motion
check "a robot that is no humanoid" pages other_robot
check "a joint that is not set up says why" pages not_set_up
if has_jsonschema; then
    check "what is answered is what the OpenAPI file tells" pages schema
else
    skip "what is answered is what the OpenAPI file tells" "no python3-jsonschema"
fi

# Whoever starts it behind a file reads the link there while it runs.
tells_at_once() {
    "$GRCTL" -d sim serve --port 0 motions >"$work/link" &
    serve_pid=$!
    wait_for grep -q '^http://127.0.0.1:[0-9]*/#token=' "$work/link"
    told=$?
    kill $serve_pid
    wait $serve_pid
    return $told
}
check "the link is told at once" tells_at_once

# A port that somebody has is an error, and no other is taken.
taken() {
    python3 -c '
import socket, subprocess, sys
s = socket.socket()
s.bind(("127.0.0.1", 0))
s.listen()
sys.exit(subprocess.run([sys.argv[1], "-d", "sim", "serve", "--port",
                         str(s.getsockname()[1])]).returncode)
' "$GRCTL"
}
check "an address of another machine is an error" fails 1 '--listen is no address of this machine' \
    "$GRCTL" serve -d sim --port 0 --listen 999.1.1.1
check "a port in use is an error" fails 1 'port [0-9]*: the port is in use' taken
check "a folder that is none is an error" fails 3 'nowhere: no such folder' \
    "$GRCTL" -d sim serve --port 0 nowhere

done_testing
