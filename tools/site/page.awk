# SPDX-License-Identifier: MIT
# Makes a page for Doxygen of a document of ours: headings get the names that links use, links lead
# to pages, and what is no page (a folder, a source file) is named instead of linked.
# -v top=FOLDER: the tree; the pages are docs/*.md, docs/guide/*.md, ports/README.md and
# motions/README.md.

# page PATH: its name, from the tree's top; "" where it is no page.
function page(path) {
    if (path !~ /^(docs\/(guide\/)?[^\/]*|ports\/README|motions\/README|tools\/site\/index)\.md$/)
        return ""
    sub(/\.md$/, "", path)
    sub(/\/README$/, "_readme", path)
    sub(/^.*\//, "", path)
    gsub(/\./, "-", path)
    return "page_" path
}
function slug(heading) {
    heading = tolower(heading)
    gsub(/[^a-z0-9 _-]/, "", heading)
    gsub(/ /, "-", heading)
    return heading
}
# from this file's folder to the top's
function resolve(target,    parts, n, i, out, m) {
    if (target == "") return self
    n = split(folder "/" target, parts, "/")
    m = 0
    for (i = 1; i <= n; i++) {
        if (parts[i] == "..") m--
        else if (parts[i] != "." && parts[i] != "") out[++m] = parts[i]
    }
    target = out[1]
    for (i = 2; i <= m; i++) target = target "/" out[i]
    return target
}
function relink(line,    done, text, target, anchor, path, image) {
    done = ""
    while (match(line, /!?\[[^\]]*\]\([^)]*\)/)) {
        done = done substr(line, 1, RSTART - 1)
        text = substr(line, RSTART, RLENGTH)
        line = substr(line, RSTART + RLENGTH)
        image = substr(text, 1, 1) == "!"
        target = text
        sub(/^!?\[[^\]]*\]\(/, "", target)
        sub(/\)$/, "", target)
        sub(/\]\([^)]*\)$/, "", text)
        sub(/^!?\[/, "", text)
        if (target ~ /^https?:/) {
            done = done "[" text "](" target ")"
        } else if (image) {
            sub(/^.*\//, "", target)
            done = done "![" text "](" target ")"
        } else {
            anchor = ""
            if (match(target, /#.*/)) {
                anchor = substr(target, RSTART + 1)
                target = substr(target, 1, RSTART - 1)
            }
            path = page(resolve(target))
            if (path == "") done = done text
            else done = done "[" text "](@ref " path (anchor == "" ? "" : "_" anchor) ")"
        }
    }
    return done line
}
FNR == 1 {
    self = FILENAME
    if (index(self, top "/") == 1) self = substr(self, length(top) + 2)
    folder = self
    if (!sub(/\/[^\/]*$/, "", folder)) folder = ""
    name = page(self)
}
/^```/ { fenced = !fenced; print; next }
fenced { print; next }
/^<!--.*-->$/ { print ""; next }
/^#+ / {
    heading = $0
    sub(/^#+ /, "", heading)
    plain = heading
    gsub(/`/, "", plain)
    level = length($1)
    if (self ~ /index\.md$/ && level == 1) { print $0 " {#mainpage}"; next }
    # A heading in Japanese has no name that a link could use.
    if (level > 1 && slug(heading) !~ /[a-z]/) { print $1 " " plain; next }
    print $1 " " plain " {#" name (level == 1 ? "" : "_" slug(heading)) "}"
    next
}
# A link may be broken over two lines.
{
    if (held != "") { $0 = held " " $0; held = "" }
    rest = $0
    while (match(rest, /\[[^\]]*\]\([^)]*\)/)) rest = substr(rest, RSTART + RLENGTH)
    if (match(rest, /\[[^\]`]*$/) && $0 !~ /^\|/) { held = $0; next }
    print relink($0)
}
END { if (held != "") print relink(held) }
