#!/bin/sh
# SPDX-License-Identifier: MIT
# The cockpit's server: who may ask what, how it begins, what is answered.
. tests/support/pages.sh

has_jsonschema() {
    python3 -c 'import jsonschema' 2>/dev/null
}

test_that "hosts, origins, tokens, methods that are refused" pages refusals
test_that "what is too large or never whole is refused" pages sizes
test_that "what is said twice, or in a way of its own, is refused in JSON" pages framing
test_that "no path leads out of the folder" pages escapes
test_that "beyond loopback everything needs the token" pages beyond_loopback
test_that "the link leads to the page, wherever it listens" pages printed_links
test_that "the page: compressed, known by its hash, under a policy" pages page_files
test_case "what is answered is what the OpenAPI file tells"
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
test_that "the link is told at once" tells_at_once

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
test_that "an address of another machine is an error" \
    fails 1 '--listen is no address of this machine' \
    "$GRCTL" serve -d sim --port 0 --listen 999.1.1.1
test_that "a port in use is an error" fails 1 'port [0-9]*: the port is in use' taken
test_that "a folder that is none is an error" fails 3 'nowhere: no such folder' \
    "$GRCTL" -d sim serve --port 0 nowhere

done_testing
