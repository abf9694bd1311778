# SPDX-License-Identifier: MIT
# Puts rows of tests/bench side by side: a line a measure. Of several values the median counts.

BEGIN {
    FS = "\t"
    count = split("libmodbus rustypot dynamixel-sdk pyserial libevent yaml-cpp", peer, " ")
}

{
    key = $1 FS $2
    if (!(key in seen)) {
        seen[key] = 1
        keys[++n] = key
    }
    values[key, $3] = values[key, $3] " " $4
    if ($3 ~ /^floor /) {
        floor_of[key] = $3
    }
    if ($3 == "libmodbus" || $3 == "rustypot") {
        has_peers[$1] = 1
    }
}

function median(list,    v, i, j, m, t) {
    m = split(list, v, " ")
    for (i = 2; i <= m; i++) {
        for (j = i; j > 1 && v[j - 1] + 0 > v[j] + 0; j--) {
            t = v[j]
            v[j] = v[j - 1]
            v[j - 1] = t
        }
    }
    return m == 0 ? "" : v[int((m + 1) / 2)]
}

function short(value) {
    return value == "" ? "-" : value >= 1000 ? sprintf("%.0f", value) : sprintf("%.3g", value)
}

function quoted(text) {
    return "\"" text "\""
}

END {
    printf "%-4s %-58s %10s %10s %6s  %s\n", "", "", "ours", "floor", "ratio", "others"
    printf "[" >json
    for (i = 1; i <= n; i++) {
        split(keys[i], part, FS)
        ours = median(values[keys[i], "grobo"])
        least = floor_of[keys[i]] == "" ? "" : median(values[keys[i], floor_of[keys[i]]])
        ratio = ours != "" && least != "" && least + 0 > 0 ? ours / least : ""
        others = floor_of[keys[i]] == "" ? "" : "floor: " substr(floor_of[keys[i]], 7)
        object = "{\"scenario\":" quoted(part[1]) ",\"measure\":" quoted(part[2])
        if (ours != "") {
            object = object ",\"ours\":" ours
        }
        if (least != "") {
            object = object ",\"floor\":" least
        }
        more = ""
        for (name in values) {
            split(name, by, SUBSEP)
            if (by[1] == keys[i] && by[2] != "grobo" && by[2] !~ /^floor /) {
                others = others (others == "" ? "" : ", ") by[2] " " short(median(values[name]))
                more = more (more == "" ? "" : ",") quoted(by[2]) ":" median(values[name])
            }
        }
        if (part[1] ~ /^S[12]$/ && least != "") {
            for (p = 1; p <= 4; p++) {
                if (!((keys[i], peer[p]) in values)) {
                    others = others (others == "" ? "" : ", ") peer[p] " not here"
                }
            }
        }
        printf "%-4s %-58s %10s %10s %6s  %s\n", part[1], part[2], short(ours), short(least), \
            short(ratio), others
        printf("%s\n%s,\"others\":{%s}}", (i > 1 ? "," : ""), object, more) >json
    }
    printf "\n]\n" >json
}
