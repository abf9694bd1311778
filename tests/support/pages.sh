# SPDX-License-Identifier: MIT
# For tests of `grctl serve`, whose clients are those of tests/support/cockpit.py. Ends the test
# where there is nothing to test, or nothing to test with.

. tests/support/cli.sh

if "$GRCTL" -d sim serve nowhere 2>&1 | grep -q 'without evhttp'; then
    echo "1..0 # SKIP this grctl has no evhttp"
    exit
fi
if ! have_json; then
    echo "1..0 # SKIP no python3 to ask the server with"
    exit
fi

# pages SCENARIO: a function of cockpit.py.
pages() {
    python3 tests/support/cockpit.py "$1"
}
