# SPDX-License-Identifier: MIT
# Draws rows of tests/bench as an SVG: cost against work, both axes logarithmic.
#
# usage: awk -f plot.awk -v scenario=S5 -v part='us a frame' -v title=... -v x=... ROWS
# The work is the first number of a measure, among those of the scenario that end in `part`.

BEGIN {
    FS = "\t"
    width = 480
    height = 260
    left = 60
    bottom = 40
    split("#1f5fa8 #777777 #b5541c", colour, " ")
}

$1 == scenario && substr($2, length($2) - length(part) + 1) == part {
    measure = $2
    gsub(/[^0-9]+/, " ", measure)
    split(measure, number, " ")
    who = $3
    sub(/^floor /, "", who)
    if (!(who in line)) {
        line[who] = ++lines
        name[lines] = who
    }
    n[who]++
    at[who, n[who]] = log(number[1])
    cost[who, n[who]] = log($4)
    if (!count++ || log(number[1]) < x0) x0 = log(number[1])
    if (count == 1 || log(number[1]) > x1) x1 = log(number[1])
    if (count == 1 || log($4) < y0) y0 = log($4)
    if (count == 1 || log($4) > y1) y1 = log($4)
}

function px(value) {
    return left + (value - x0) / (x1 - x0) * (width - left - 110)
}

function py(value) {
    return height - bottom - (value - y0) / (y1 - y0) * (height - bottom - 50)
}

function ten(low, high, axis,    e, v) {
    for (e = -3; e < 9; e++) {
        v = e * log(10)
        if (v < low - 0.001 || v > high + 0.001) continue
        if (axis == "x") {
            printf "<text x=\"%.0f\" y=\"%d\" text-anchor=\"middle\">%g</text>\n", px(v), \
                height - bottom + 18, 10 ^ e
        } else {
            printf "<path d=\"M%d %.0fH%d\" stroke=\"#ddd\"/>\n", left, py(v), width - 110
            printf "<text x=\"%d\" y=\"%.0f\" text-anchor=\"end\">%g</text>\n", left - 6, \
                py(v) + 4, 10 ^ e
        }
    }
}

END {
    y0 = int(y0 / log(10)) * log(10)
    y1 = (int(y1 / log(10)) + 1) * log(10)
    printf "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\"", width, height
    print " font-family=\"sans-serif\" font-size=\"12\">"
    printf "<rect width=\"%d\" height=\"%d\" fill=\"white\"/>\n", width, height
    printf "<text x=\"%d\" y=\"22\" font-size=\"14\">%s</text>\n", left, title
    ten(y0, y1, "y")
    ten(x0, x1, "x")
    printf "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">%s</text>\n", \
        (left + width - 110) / 2, height - 6, x
    for (i = 1; i <= lines; i++) {
        who = name[i]
        printf "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"2\" points=\"", colour[i]
        for (k = 1; k <= n[who]; k++) {
            printf "%s%.1f,%.1f", (k > 1 ? " " : ""), px(at[who, k]), py(cost[who, k])
        }
        printf "\"/>\n<text x=\"%.0f\" y=\"%.0f\" fill=\"%s\">%s</text>\n", \
            px(at[who, n[who]]) + 8, py(cost[who, n[who]]) + 4, colour[i], who
    }
    print "</svg>"
}
