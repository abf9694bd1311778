#!/bin/sh
# SPDX-License-Identifier: MIT
# With --json every command writes JSON, one object a line, whether it succeeds or not.
. tests/support/cli.sh

if ! have_json; then
    echo "1..0 # SKIP no python3 to parse JSON with"
    exit
fi

# Status, what the lines must be, the command line. A command has a row for each way it goes.
cat >"$work/rows" <<'END'
0|"ports" in lines[0]|ports
0|lines[0]["ok"] and lines[0]["checks"]|-d sim doctor
0|len(lines[0]["servos"]) == 20|-d sim scan
0|lines[0]["robot"] == "GR001"|-d sim info
0|len(lines[0]["joints"]) == 20 and "tx_frames" in lines[0]["link"]|-d sim status
0|{j["torque"] for j in lines[0]["joints"]} == {"on"}|-d sim servo on arms
0|lines[0]["max_error_deg"] <= 0.1|-d sim init --time 300
0|lines[0]["joints"][0]["name"] == "R_ELBOW_P"|-d sim move m5 -30
0|lines[0]["joints"][0]["motor"] == 5|-d sim pose m5=-30
0|lines[-1]["done"]|-d sim play --speed 500 motions/greet.pseq
0|len(lines) == 10|play --dry-run --key motions/greet.pseq
0|lines[0]["done"]|-d sim stop
0|lines[0]["done"]|-d sim estop
0|lines[0]["ok"] and lines[0]["diagnostics"] == []|check motions/greet.pseq
3|not lines[0]["ok"] and lines[0]["diagnostics"][0]["code"]|check /dev/null
0|lines[0]["length_ms"] == 5000|show motions/greet.pseq
0|lines[0]["output"]|plot motions/greet.pseq -o WORK/greet.svg
0|lines[0]["postures"] == 10|convert motions/greet.pseq WORK/greet.m
0|lines[0]["baud_bps"] == 115200|budget
0|lines[0]["slot"] == 1|-d sim slot 1
0|lines[0]["scenario"] == 1|-d sim scenario 1
0|lines[0]["id"] == 5|-d sim servo-get 5 baud
0|lines[0]["id"] == 5|-d sim servo-set 5 delay 1
0|lines[0]["kind"] == "check"|decode 4100
0|lines|replay WORK/trace
0|len(lines[0]["commands"]) > 10|help
0|lines[0]["version"]|version
0|lines[0]["shell"] == "bash"|completion bash
0|lines[0]["manual"]|help --man
0|lines[0]["joints"][5]["trim_deg"] == 1.5|-d here calibrate R_ANKLE_R 1.5
1|lines[0]["error"]["code"] == "NOENT"|-d /dev/none status
2|lines[0]["error"]["code"] == "USAGE"|status --nonsense
3|lines[0]["error"]["message"]|play /dev/null
4|lines[0]["error"]["code"] == "LIMIT"|-d sim move m5 120
END
mkdir -p "$work/config/grctl"
echo 'robots: {here: {device: sim}}' >"$work/config/grctl/config.yaml"
"$GRCTL" --trace "$work/trace" -d sim status >/dev/null

# fits COMMAND: every line of the last output is as docs/grctl.schema.json says.
cat >"$work/fits.py" <<'END'
import json, sys
schema = json.load(open("docs/grctl.schema.json"))
kinds = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}

def fits(value, rule):
    if "$ref" in rule:
        return fits(value, schema["$defs"][rule["$ref"].split("/")[-1]])
    if "anyOf" in rule:
        return any(fits(value, one) for one in rule["anyOf"])
    if "enum" in rule:
        return value in rule["enum"]
    types = rule.get("type", [])
    types = [types] if isinstance(types, str) else types
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if types and not any(number and (t == "number" or isinstance(value, int))
                         if t in ("number", "integer") else isinstance(value, kinds[t])
                         for t in types):
        return False
    if isinstance(value, dict):
        return all(k in value for k in rule.get("required", [])) and all(
            fits(value[k], r) for k, r in rule.get("properties", {}).items() if k in value)
    return not isinstance(value, list) or all(fits(v, rule.get("items", {})) for v in value)

for text in open(sys.argv[2]):
    line = json.loads(text)
    name = "error" if "error" in line else sys.argv[1]
    if not fits(line, schema["$defs"][name]):
        sys.exit("not as $defs/%s: %.1000s" % (name, text))
END
command_of() {
    for word in $1; do
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
            check "--json ${line%%"$work"*}" both exits "$status" timeout 30 "$GRCTL" --json $line \
                --- json "$expression"
            check "as the schema says" python3 "$work/fits.py" "$(command_of "$line")" "$work/out"
            ;;
        names) for word in $line; do echo "$word"; done ;;
        esac
    done <"$work/rows"
}
rows run

# Not here: what speaks until it is ended (sim.sh has it), with a person, or in a shell's language.
elsewhere="sim shell monitor record"
rows names | sort -u >"$work/names"
every_command() {
    for command in $("$GRCTL" help | sed -n '/^Commands:/,/^$/s/^  \([a-z-]*\) .*/\1/p'); do
        case " $elsewhere " in
        *" $command "*) ;;
        *) grep -qx -e "$command" "$work/names" || { echo "$command has no row"; return 1; } ;;
        esac
    done
}
check "every command has a row" every_command
done_testing
