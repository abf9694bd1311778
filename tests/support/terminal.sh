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
    wait_for on_screen_is "$1" || { echo "no '$1' on the screen:"; screen; return 1; }
}
on_screen_is() {
    screen | grep -q -e "$1"
}

# until_cursor COLUMN: waits until the cursor stands there.
until_cursor() {
    wait_for cursor_is "$1"
}
cursor_is() {
    [ "$(on_screen display-message -p '#{cursor_x}')" = "$1" ]
}

# type_line TEXT: a command line, on a clean screen.
type_line() {
    keys -l "clear; $1"
    keys Enter
}
