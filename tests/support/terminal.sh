# SPDX-License-Identifier: MIT
# For tests that need a terminal: a screen of 80x24 in tmux, keys sent to it, its text looked at.
# After cli.sh; `have_terminal` first.

have_terminal() {
    command -v tmux >/dev/null 2>&1
}

# Is grctl built with a full screen, and can it be looked at? $no_screen says why not.
have_full_screen() {
    no_screen=
    have_terminal || no_screen='no tmux'
    [ "${SCREEN:-ncurses}" = ncurses ] || no_screen='built without ncurses'
    [ -z "$no_screen" ]
}

on_screen() {
    tmux -L "grctl$$" -f /dev/null "$@"
}

# open_screen [COLUMNS ROWS]: a shell with the prompt "> ".
open_screen() {
    LC_ALL=C.UTF-8 on_screen new-session -d -x "${1:-80}" -y "${2:-24}" "PS1='> ' exec sh"
    trap 'on_screen kill-server 2>/dev/null; end_cli_test' EXIT
    until_screen '^>'
}

# keys KEY...: as tmux names them; -l TEXT for text as it is.
keys() {
    on_screen send-keys "$@"
}

# screen: what is on it now, in $work/screen too.
screen() {
    on_screen capture-pane -p >"$work/screen"
    cat "$work/screen"
}

# until_screen PATTERN: waits until a line is like that, as long as a slow machine may take.
until_screen() {
    until_end=$(($(date +%s) + 20))
    until screen | grep -q -e "$1"; do
        [ "$(date +%s)" -lt $until_end ] || { echo "no '$1' on the screen:"; screen; return 1; }
    done
}

# type_line TEXT: a command line, on a clean screen.
type_line() {
    keys -l "clear; $1"
    keys Enter
}
