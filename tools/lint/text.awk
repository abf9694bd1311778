# SPDX-License-Identifier: MIT
# Gate: the bytes of a text file. Runs without strip.awk.

function complain(file, line, text) {
    printf "%s:%d: text: %s\n", file, line, text
    complaints++
}

# Of UTF-8, in bytes (LC_ALL=C): a character of three of them is taken for a wide one.
function columns(line) {
    if (length(line) > 100) {
        gsub(/[\343-\357]../, "ww", line)
        gsub(/[\200-\277]/, "", line)
    }
    return length(line)
}

FNR == 1 { licensed = 0 }
FNR <= 2 && /SPDX-License-Identifier: MIT/ { licensed = 1 }
FILENAME ~ /\.[ch]$/ && FNR == 1 && $0 != "/* SPDX-License-Identifier: MIT */" {
    complain(FILENAME, 1, "first line must be /* SPDX-License-Identifier: MIT */")
}
FILENAME ~ /(\.sh|\.awk|^Makefile|\.ci\/run)$/ && FNR == 2 && !licensed {
    complain(FILENAME, 1, "no SPDX-License-Identifier in the first two lines")
}
/\t/ && FILENAME !~ /(^|\/)Makefile$/ { complain(FILENAME, FNR, "tab") }
/[ \t]$/ { complain(FILENAME, FNR, "trailing blank") }
/\r/ { complain(FILENAME, FNR, "carriage return") }
FILENAME ~ /\.([ch]|sh|awk)$/ && columns($0) > 100 {
    complain(FILENAME, FNR, "longer than 100 columns")
}
END { if (complaints) exit 1 }
