#!/bin/sh
# SPDX-License-Identifier: MIT
# A broker that knows its users, by the list of docs/guide/fleet.md, over TLS: an agent speaks as
# itself alone.
. tests/support/cli.sh
. tests/support/fleet.sh
need_fleet mosquitto_passwd openssl

test_case "a broker with certificates and users"

certify() (
    cd "$work" || exit 1
    openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 3 \
        -subj /CN=test-ca -keyout "$1-ca.key" -out "$1-ca.crt" &&
        openssl req -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -subj /CN=localhost \
            -addext subjectAltName=DNS:localhost,IP:127.0.0.1 -keyout "$1.key" -out "$1.csr" &&
        openssl x509 -req -in "$1.csr" -CA "$1-ca.crt" -CAkey "$1-ca.key" -CAcreateserial \
            -days 3 -copy_extensions copy -out "$1.crt"
) >"$work/openssl.log" 2>&1
certify true && certify other || { echo "Bail out! no certificates"; exit 1; }

for user in one two operator; do
    [ -e "$work/users" ] && create= || create=-c
    mosquitto_passwd $create -b "$work/users" $user "secret-of-$user" 2>/dev/null
done
# The list of the guide.
awk '/^```/ { open = 0 } open { print } /^```text/ { open = 1 }' docs/guide/fleet.md >"$work/rights"
cat >"$work/broker.conf" <<EOF2
user root
listener $port 127.0.0.1
cafile $work/true-ca.crt
certfile $work/true.crt
keyfile $work/true.key
allow_anonymous false
password_file $work/users
acl_file $work/rights
persistence false
EOF2
begin_broker

# as USER COMMAND...: with that user's password.
as() {
    as_user=$1
    shift
    env GRCTL_MQTT_PASSWORD="secret-of-$as_user" "$@"
}
# fleet USER VERB [OPTIONS]
fleet() {
    fleet_user=$1 fleet_verb=$2
    shift 2
    as "$fleet_user" "$GRCTL" fleet "$fleet_verb" --broker "mqtts://$fleet_user@127.0.0.1:$port" \
        --ca "$work/true-ca.crt" "$@"
}
says_as() { # USER TOPIC PAYLOAD
    mosquitto_pub -V 5 -h 127.0.0.1 -p "$port" --cafile "$work/true-ca.crt" -u "$1" \
        -P "secret-of-$1" -q 1 -r -t "$2" -m "$3"
}
check "who may see all" wait_for exits 0 fleet operator list
# What libmosquitto makes of that depends on its version.
check "TLS where nobody listens" fails 1 'fleet: 127.0.0.1: ' \
    as operator "$GRCTL" fleet list --broker mqtts://operator@127.0.0.1:1 --ca "$work/true-ca.crt"
check "but no file is blamed" sh -c '! grep -q "cannot be read" "$1"' sh "$work/err"
check "a wrong password" fails 1 '[Nn]ot authorized' env GRCTL_MQTT_PASSWORD=wrong \
    "$GRCTL" fleet list --broker "mqtts://operator@127.0.0.1:$port" --ca "$work/true-ca.crt"
check "a certificate of another" fails 1 'fleet: 127.0.0.1: ' \
    as operator "$GRCTL" fleet list --broker "mqtts://operator@127.0.0.1:$port" \
    --ca "$work/other-ca.crt"
check "no TLS where it is wanted" fails 1 'fleet: 127.0.0.1: ' \
    as operator "$GRCTL" fleet list --broker "mqtt://operator@127.0.0.1:$port"
check "a file that is no certificate" fails 1 'a certificate or key cannot be read' \
    as operator "$GRCTL" fleet list --broker "mqtts://operator@127.0.0.1:$port" --ca "$work/users"

test_case "an agent"

mkdir -p "$work/config/grctl"
printf 'robots: {a: {device: sim}}\n' >"$work/config/grctl/config.yaml"
GRCTL_MQTT_PASSWORD=secret-of-one "$GRCTL" -d a agent --broker "mqtts://one@127.0.0.1:$port" \
    --ca "$work/true-ca.crt" --host one >"$work/agent.out" 2>"$work/agent.err" &
echo $! >>"$work/pids"
is_listed() {
    fleet operator list | grep -q "^one  *$1"
}
check "an agent is there" wait_for is_listed ONLINE
check "it plays" both exits 0 fleet operator play greet.pseq -s 400 --spread 50 --- \
    says 'one/a: played'
lie='{"v":1,"state":"OFFLINE","epoch":"00112233445566778899aabbccddeeff"}'
stays() {
    says_as two grobo/v1/one/connection "$lie" >/dev/null 2>&1
    is_listed ONLINE
}
check "nobody else speaks as it" stays
check "who it is allowed to may" both says_as operator grobo/v1/one/connection "$lie" --- \
    is_listed OFFLINE
unheard() {
    says_as two grobo/v1/one/cmd/prepare '{"v":1}' >/dev/null 2>&1
    says_as two grobo/v1/one/cmd/put '{"v":1}' >/dev/null 2>&1
    ! grep -q refused "$work/agent.err"
}
check "nor orders it" unheard

done_testing
