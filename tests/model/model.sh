# SPDX-License-Identifier: MIT
# The model of stops between programs (stop.pml), searched whole by Spin, and its sabotages, each of
# which must break a rule. CC and BUILD are make's.
. tests/support/tap.sh

if ! command -v spin >/dev/null; then
    skip "the model of stops" "spin is not installed (apt install spin)"
    done_testing
fi
model=$PWD/tests/model/stop.pml
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# search N: what Spin's verifier says of sabotage N, 0: none.
search() {
    (cd "$work" && rm -f ./* && spin -DSABOTAGE="$1" -a "$model" &&
        ${CC:-cc} -O2 -w -DSAFETY -DVECTORSZ=2048 -o pan pan.c && ./pan -m400000)
}

search 0 >"$work.log" 2>&1
check "every order of steps keeps the rules" grep -q 'errors: 0$' "$work.log"
check "it was searched whole" test -z "$(grep -e 'max search depth too small' \
    -e 'Search not completed' "$work.log")"
echo "# $(grep 'states, stored' "$work.log" | tr -s ' ')"
for sabotage in 1 2 3 4; do
    search $sabotage >"$work.log" 2>&1
    check "sabotage $sabotage breaks one" grep -q 'errors: 1$' "$work.log"
done
rm -f "$work.log"
done_testing
