# SPDX-License-Identifier: MIT
# The deepest chain of calls below a room's functions, in bytes of stack, and its way. Calls
# through pointers (callbacks) and what the compiler's own library takes are not in it.
#
# usage: awk -v objects="core/bus core/bus_time" -f stack.awk SU... CALLS
#   SU are the compiler's .su files; a line of CALLS is: OBJECT, and one line of objdump -dr.

# A function by its name as seen from an object: its own, or one that all see.
function node_of(object, name) {
    if ((object, name) in own) {
        return object SUBSEP name
    }
    return name in home ? home[name] SUBSEP name : ""
}

# Bytes from this function down; path[] names the way.
function depth(node,    n, i, list, below, most, way) {
    if (node in known || node in open) {
        return known[node] + 0
    }
    open[node] = 1
    n = split(calls[node], list, "\n")
    for (i = 1; i < n; i++) {
        below = depth(list[i])
        if (below > most) {
            most = below
            way = " > " path[list[i]]
        }
    }
    delete open[node]
    path[node] = substr(node, index(node, SUBSEP) + 1) way
    return known[node] = own[node] + most
}

FILENAME ~ /\.su$/ {
    n = split($1, place, ":")
    object = FILENAME
    sub(/.*\/src\//, "", object)
    sub(/\.su$/, "", object)
    own[object, place[n]] = $2
    if (place[n] ~ /^grobo_/) {
        home[place[n]] = object
    }
    next
}
$3 ~ /^<.*>:$/ {
    caller = $1 SUBSEP substr($3, 2, length($3) - 3)
    next
}
/R_ARM_THM_(CALL|JUMP24)/ {
    callee = node_of($1, $NF)
    if (callee != "" && callee != caller) {
        calls[caller] = calls[caller] callee "\n"
    }
}
END {
    n = split(objects, list, " ")
    for (i = 1; i <= n; i++) {
        wanted[list[i]] = 1
    }
    for (node in own) {
        split(node, part, SUBSEP)
        if (part[1] in wanted && depth(node) > most) {
            most = depth(node)
            deepest = node
        }
    }
    print most, path[deepest]
}
