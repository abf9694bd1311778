#!/bin/sh
# SPDX-License-Identifier: MIT
# What `grctl serve` answers against its description (docs/serve.openapi.json), judged by
# schemathesis, which makes requests that fit the description and others that do not. SCHEMATHESIS
# is the command, SECONDS_IN_ALL how long it may make some.
. tests/support/tap.sh

scratch=$(mktemp -d) || exit 1
server=
trap 'kill $server 2>/dev/null; rm -rf "$scratch"' EXIT
token=0123456789abcdef0123456789abcdef

if ! "${SCHEMATHESIS:-schemathesis}" --version >/dev/null 2>&1; then
    skip 'answers and description agree' 'schemathesis is not installed'
    done_testing
fi
mkdir "$scratch/motions"
cp motions/*.pseq "$scratch/motions"
GRCTL_TOKEN=$token "$GRCTL" -d sim serve --port 0 --operator "$scratch/motions" >"$scratch/link" &
server=$!
wait_for grep -q '^http://' "$scratch/link" || check 'serve starts' false
page=$(sed -n 's|^\(http://[^/]*\)/.*|\1|p' "$scratch/link")
lease=$(curl -s -H 'Content-Type: application/json' -H "X-Grobo-Token: $token" \
    -d '{"action": "take", "name": "schemathesis"}' "$page/api/lease" |
    sed -n 's/.*"lease":"\([0-9a-f]*\)".*/\1/p')
[ -n "$lease" ] || check 'the lease is had' false

# The second port's paths are the first one's; a stream has no end. Below the rate that is refused.
# It keeps what it found where it runs.
here=$PWD
ask() {
    cd "$scratch" || return 1
    "${SCHEMATHESIS:-schemathesis}" --config-file "$here/tests/cockpit/schemathesis.toml" run \
        "$here/docs/serve.openapi.json" --url "$page" -H "X-Grobo-Token: $token" \
        -H "X-Grobo-Lease: $lease" --exclude-path /stop --exclude-path /estop \
        --exclude-path /heartbeat --exclude-path /api/events --phases examples,coverage,fuzzing \
        --continue-on-failure --no-shrink --rate-limit 90/s --max-time "${SECONDS_IN_ALL:-240}"
}
(ask) >"$scratch/said" 2>&1
status=$?
sed -n '/SUMMARY/,$p' "$scratch/said" | sed 's/^/# /'
[ $status -eq 0 ] || sed 's/^/# /' "$scratch/said"
check 'answers and description agree' test $status -eq 0
check 'the server lives' kill -0 $server
done_testing
