#!/bin/sh
# SPDX-License-Identifier: MIT
# With --json every command writes JSON, one object a line, whether it succeeds or not.
. tests/support/cli.sh

if ! have_json; then
    echo "1..0 # SKIP no python3 to parse JSON with"
    exit
fi

cp docs/examples/robots/rover.yaml "$work/"
# Status, what the lines must be, the command line. A command has a row for each way it goes.
cat >"$work/rows" <<'END'
0|"ports" in lines[0]|ports
0|lines[0]["name"] == "so101" and lines[0]["n_read"] == 6|-d sim --robot so101 --yes setup
0|lines[0]["undone"]|setup --undo
0|len(lines[0]["servos"]) == 2|-d sim --robot pan-tilt --yes first-contact -o WORK/fc
0|lines[0]["ok"] and lines[0]["checks"]|-d sim doctor
0|len(lines[0]["servos"]) == 20|-d sim scan
0|lines[0]["robot"] == "GR001"|-d sim info
0|lines[0]["joints"][3]["name"] == "R_KNEE_P"|joints
0|lines[0]["robots"][1]["name"] == "so101"|robot list
0|lines[0]["safety"]["voltage_mv"] == 6000|robot show
0|lines[0]["servos"][0]["model"] == "LX-16A"|robot servos lx16a
0|lines[0]["n_joints"] == 1 and "STS3215" in lines[0]["text"]|robot import WORK/one.body --ids b=1
3|lines[0]["diagnostics"][0]["line"] == 3|robot check motions/greet.pseq
0|lines[0]["joints"][0]["joint"] == 16 and lines[0]["joints"][0]["status"] == "ok"|-d sim status m5
0|{"id": 5, "joint": 16, "name": "R_ELBOW_P"}.items() <= lines[0]["servos"][4].items()|-d sim scan
0|len(lines[0]["joints"]) == 20 and "tx_frames" in lines[0]["link"]|-d sim status
0|{j["torque"] for j in lines[0]["joints"]} == {"on"}|-d sim servo on arms
0|lines[0]["max_error_deg"] <= 0.1|-d sim init --time 300
0|lines[0]["joints"][0]["name"] == "R_ELBOW_P"|-d sim move m5 -30
0|lines[0]["joints"][0]["motor"] == 5|-d sim pose m5=-30
0|lines[0]["wheels"][0]["stands"]|--robot WORK/rover.yaml -d sim drive left=30 --for 0.2
0|lines[-1]["done"] and lines[-1]["watched"]|-d sim play --speed 500 motions/greet.pseq
0|lines[-1]["watched"] is False|-d sim play --rate 50 --unwatched --speed 500 motions/greet.pseq
4|lines[0]["error"]["code"] == "unwatched"|-d sim play --rate 50 motions/greet.pseq
0|len(lines) == 10|play --dry-run --key motions/greet.pseq
0|lines[0]["state"] == "approach" and lines[-1]["done"]|follow so101-leader@sim so101@sim --for 0.3
0|lines[0]["joints"][0]["offset"] == 25|--robot so101 -d sim calibrate --dry-run --from WORK/a.json
0|lines[0]["done"]|-d sim stop
0|lines[0]["done"]|-d sim estop
0|lines[0]["ok"] and lines[0]["diagnostics"] == []|check motions/greet.pseq
3|not lines[0]["ok"] and lines[0]["diagnostics"][0]["code"]|check /dev/null
0|lines[0]["length_ms"] == 5000|show motions/greet.pseq
0|lines[0]["output"]|plot motions/greet.pseq -o WORK/greet.svg
0|lines[0]["postures"] == 10|convert motions/greet.pseq WORK/greet.m
0|lines[0]["baud_bps"] == 115200 and lines[0]["watched_max_hz"] == 39|budget
0|lines[0]["slot"] == 1|-d sim slot 1
0|lines[0]["scenario"] == 1|-d sim scenario 1
0|lines[0]["id"] == 5|-d sim servo-get 5 baud
0|lines[0]["registers"][0]["baud_bps"] == 115200|-d sim servo-get 5 baud
0|lines[0]["registers"][0]["word"] == "RS302CD"|-d sim servo-get 5
0|lines[0]["id"] == 5|-d sim servo-set 5 delay 1
0|lines[0]["kind"] == "check"|decode 4100
0|lines[0]["packet"]["action"]|decode 53 0C FA AF 03 00 1E 04 01 F6 FF 00 00 11
0|"trace" in lines[0] and len(lines) > 20|decode WORK/trace
0|lines|replay WORK/trace
0|len(lines[0]["commands"]) > 10|help
0|lines[0]["version"]|version
0|lines[0]["shell"] == "bash"|completion bash
0|lines[0]["manual"]|help --man
0|lines[0]["joints"][5]["trim_deg"] == 1.5|-d here calibrate R_ANKLE_R 1.5
1|lines[0]["error"]["code"] == "noent"|-d /dev/none status
2|lines[0]["error"]["code"] == "arg"|status --nonsense
3|lines[0]["error"]["message"]|play /dev/null
3|lines[0]["error"]["code"] == "syntax"|show WORK/number.m
4|lines[0]["error"]["code"] == "limit"|-d sim play WORK/limit.m
4|lines[0]["error"]["code"] == "speed"|-d sim play WORK/speed.m
3|lines[0]["error"]["code"] == "unsupported"|convert motions/step.pseq WORK/step.m --robot so101
2|lines[0]["error"]["code"] == "arg"|convert --to m motions/greet.pseq -
2|lines[0]["error"]["code"] == "arg"|-d sim
1|lines[0]["error"]["message"].endswith("x: no such folder")|sim --link /nonexistent/x
3|"n.json: no such file" == lines[0]["error"]["message"]|--robot koch -d sim calibrate --from n.json
3|lines[0]["error"]["code"] == "isdir"|-d sim --robot so101 calibrate --from tests
3|lines[0]["error"]["code"] == "isdir"|decode tests
3|lines[0]["error"]["code"] == "noent"|robot import none.urdf
3|lines[0]["error"]["code"] == "isdir"|shell tests
3|lines[0]["error"]["code"] == "isdir"|-d sim --trace /tmp status
3|lines[0]["error"]["code"] == "exists"|-d sim --trace README.md status
1|lines[0]["error"]["code"] == "perm"|-d /dev/null --yes setup
4|lines[0]["error"]["code"] == "limit"|-d sim move m5 120
END
cat >"$work/one.body" <<'END'
format: ChoreonoidBody
links: [{name: a}, {name: b, parent: a, jointType: revolute, jointAxis: X, jointRange: 90}]
END
mkdir -p "$work/config/grctl"
echo '0 x' >"$work/number.m"
zeros='0 0 0 0 0 0 0 0 0 0 0 0 0 0 0'
echo "0  0 0 0 0 -1400 $zeros" >"$work/limit.m"
printf '%s\n' "0  0 0 -1000 0 0 $zeros" "100  0 0 1000 0 0 $zeros" >"$work/speed.m"
awk '/^<!-- file lerobot.json/ { on = 1; next } on && /^```$/ { exit } on && !/^```/' \
    docs/guide/arm.md >"$work/a.json"
printf 'robots:\n  here: {device: sim}\n' >"$work/config/grctl/config.yaml"
"$GRCTL" --trace "$work/trace" -d sim status >/dev/null

# fits COMMAND: every line of the last output is as docs/grctl.schema.json says, which knows every
# key. table: the page's row of a command, made from the schema.
cat >"$work/schema.py" <<'END'
import json, re, sys
schema = json.load(open("docs/grctl.schema.json"))
kinds = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}

def referred(rule):
    return rule["$ref"].split("/")[-1]

def fits_object(value, rule):
    known = rule.get("properties")
    if known is None:
        return True
    patterns = rule.get("patternProperties", {})
    def of(key):
        return known.get(key) or next((r for p, r in patterns.items() if re.search(p, key)), None)
    return all(key in value for key in rule["required"]) and all(
        of(key) and fits(value[key], of(key)) for key in value)

def fits(value, rule):
    if "$ref" in rule:
        return fits(value, schema["$defs"][referred(rule)])
    if "anyOf" in rule:
        return any(fits(value, one) for one in rule["anyOf"])
    if "enum" in rule:
        return value in rule["enum"]
    types = rule["type"] if isinstance(rule["type"], list) else [rule["type"]]
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not any(number and (t == "number" or isinstance(value, int))
               if t in ("number", "integer") else isinstance(value, kinds[t]) for t in types):
        return False
    if isinstance(value, dict):
        return fits_object(value, rule)
    return not isinstance(value, list) or all(fits(v, rule["items"]) for v in value)

def inside(rule, each):
    if "$ref" in rule:
        return " (%s *%s*)" % (each, referred(rule))
    if rule.get("type") == "array":
        return inside(rule["items"], "each a")
    if "anyOf" in rule:
        return inside(rule["anyOf"][0], each)
    return " (%s)" % keys(rule) if rule.get("properties") else ""

def keys(rule):
    if "anyOf" in rule:
        return "; or ".join(keys(one) for one in rule["anyOf"])
    if "$ref" in rule:
        return "a *%s*" % referred(rule)
    if "enum" in rule:
        return "one of " + " ".join("`%s`" % word for word in rule["enum"])
    return ", ".join("`%s`%s%s" % (key, inside(of, "a"), "" if key in rule["required"] else "?")
                     for key, of in rule["properties"].items())

if sys.argv[1] == "table":
    for name, rule in schema["$defs"].items():
        print("| %s | %s |" % (name, keys(rule)))
    sys.exit()
def misfits(path, command):
    for text in open(path):
        line = json.loads(text)
        names = ["error"] if "error" in line else command.split(",")
        if not any(fits(line, schema["$defs"][name]) for name in names):
            return "not as $defs/%s: %.1000s" % (" ".join(names), text)

def holds(lines, expression):
    return eval("(" + expression + ")")

if sys.argv[1] == "rows":
    wrong = 0
    for row in open(sys.argv[2]):
        path, command, expression = row.rstrip("\n").split("|", 2)
        why = misfits(path, command)
        if not why and not holds([json.loads(text) for text in open(path)], expression):
            why = "does not hold: %s of %.1000s" % (expression, open(path).read())
        if why:
            wrong += 1
            print("%s: %s" % (command, why))
    sys.exit(wrong > 0)
sys.exit(misfits(sys.argv[2], sys.argv[1]))
END
fits() {
    python3 "$work/schema.py" "$1" "$work/out"
}
# The first word that is a command, behind a device.
command_of() {
    for word in ${1#*-d * }; do
        grep -q "^  \"$word\": {" "$work/defs" && { echo "$word"; return; }
    done
}
grep '^  "' docs/grctl.schema.json >"$work/defs"

rows() {
    while IFS='|' read -r status expression line; do
        case $1 in
        run)
            line=$(printf '%s\n' "$line" | sed "s|WORK|$work|")
            # $line is a command line, to be split.
            # shellcheck disable=SC2086
            check "--json ${line%%"$work"*}" exits "$status" timeout 30 "$GRCTL" --json $line
            n_rows=$((n_rows + 1))
            cp "$work/out" "$work/row.$n_rows"
            printf '%s|%s|%s\n' "$work/row.$n_rows" "$(command_of "$line")" "$expression" \
                >>"$work/printed"
            ;;
        names) for word in $line; do echo "$word"; done ;;
        esac
    done <"$work/rows"
}
n_rows=0
rows run
check "each as its row and the schema say" python3 "$work/schema.py" rows "$work/printed"
test_case "options in JSON"
check "--json of an option" both exits 0 "$GRCTL" move --help --json \
    --- json 'lines[0]["commands"][0]["name"] == "move"'
check "as the schema says" fits help
check "--json cut short, and a mistake behind it" both exits 2 "$GRCTL" --js status --nonsense \
    --- json 'lines[0]["error"]["code"] == "arg"'

test_case "what speaks until it is ended, and what a person leads"

# speaks SIGNAL STATUS ARGUMENTS...: ended when it has said two lines, or has asked for keys.
speaks() {
    speaks_signal=$1
    speaks_status=$2
    shift 2
    rm -f "$work/out" "$work/err"
    timeout 30 "$GRCTL" --json "$@" </dev/null >"$work/out" 2>"$work/err" &
    speaks_pid=$!
    written "$work/$speaks_file" "$speaks_pattern" || return 1
    kill -"$speaks_signal" $speaks_pid
    wait $speaks_pid
    [ $? -eq "$speaks_status" ] || { cat "$work/out" "$work/err"; return 1; }
}
speaks_file=out
speaks_pattern='^{'
check "--json monitor" both speaks INT 130 -d sim monitor --- \
    json 'len(lines) > 0 and len(lines[0]["joints"]) == 20'
check "as the schema says" fits monitor
check "--json status --watch" both speaks INT 130 -d sim status --watch --- json 'lines[0]["link"]'
check "as the schema says" fits status
check "--json sim" both speaks TERM 143 sim --tcp 0 --- json 'lines[0]["simulated"]'
check "as the schema says" fits sim
check "--json serve" both speaks TERM 143 -d sim serve --port 0 --- json 'lines[0]["token"]'
check "as the schema says" fits serve
records() {
    printf ' s' | exits_with_keys "$GRCTL" --json -d sim record --key -o "$work/taught.m" &&
        json 'lines[0]["postures"] == 1'
}
exits_with_keys() {
    "$@" >"$work/out" 2>"$work/err" || { cat "$work/err"; return 1; }
}
check "--json record" records
check "as the schema says" fits record
teaches() {
    printf ' s' | exits_with_keys "$GRCTL" --json -d sim teach -o "$work/taught.pseq" arms &&
        json 'lines[0]["postures"] == 1'
}
check "--json teach" teaches
check "as the schema says" fits teach
in_shell() {
    printf 'Clear\nPush\nt 500\nReverse\nversion\n' |
        exits_with_keys "$GRCTL" --json -d sim shell
}
check "--json shell" both in_shell --- json 'len(lines) == 10'
check "as the schema says" fits shell,version

rows names | sort -u >"$work/names"
every_command() {
    for command in $("$GRCTL" help | sed -n '/^Global options/q;s/^  \([a-z-]*\) .*/\1/p'); do
        # shellcheck disable=SC2194 # the list is the constant
        case " sim shell monitor serve agent fleet record teach " in
        *" $command "*) ;; # above
        *) grep -qx -e "$command" "$work/names" || { echo "$command has no row"; return 1; } ;;
        esac
        grep -q "^  \"$command\": {" "$work/defs" || { echo "$command: no schema"; return 1; }
    done
}
check "every command has a row, and a schema" every_command

test_case "the page"

page_has_schema() {
    python3 "$work/schema.py" table >"$work/table"
    while IFS= read -r row; do
        sed -n 's/^| [`*]\([a-z_-]*\)[`*] | /| \1 | /p' docs/grctl-json.md | grep -qF -e "$row" ||
            { echo "docs/grctl-json.md has no row: $row"; return 1; }
    done <"$work/table"
}
check "docs/grctl-json.md has the schema's keys" page_has_schema
awk -f tools/json_page.awk docs/grctl-json.md >"$work/grctl-json.5"
# The words of error codes are those of error.h, in the schema as in what grctl's source names.
cat >"$work/codes.py" <<'END'
import glob, json, re, sys
names = re.findall(r"^    X\((\w+), -\d+", open("include/grobo/error.h").read(), re.M)
library = [name.lower() for name in names]
schema = json.load(open("docs/grctl.schema.json"))["$defs"]
if schema["code"]["enum"] != library:
    sys.exit("$defs/code is not error.h's list")
calls = 0
for path in glob.glob("tools/grctl/**/*.c", recursive=True):
    for code in re.findall(r'\bapp_fail\(\s*[^,]+,\s*[^,]+,\s*"(\w+)"', open(path).read()):
        calls += 1
        if code.lower() not in library or not code.isupper():
            sys.exit("%s: %s is no name of an error" % (path, code))
if calls < 50:
    sys.exit("only %d calls were found" % calls)
trips = re.findall(r'TRIP_\w+\] = "([^"]+)"', open("src/robot/trip.c").read())[1:]
if schema["error"]["properties"]["error"]["properties"]["trip"]["enum"] != [
        re.sub("[ -]", "_", trip) for trip in trips]:
    sys.exit("the schema's trips are not those of trip.c")
END
check "error codes are the names of error.h" python3 "$work/codes.py"
check "grctl-json(5) is made of it" grep -q '^\.It doctor$' "$work/grctl-json.5"
if command -v mandoc >/dev/null 2>&1; then
    check "mandoc has nothing to say of it" mandoc -Tlint -Wwarning "$work/grctl-json.5"
else
    skip "mandoc on grctl-json(5)" "no mandoc here"
fi
done_testing
