#!/bin/sh
# SPDX-License-Identifier: MIT
# Help, man page and completion know what the parser knows, and completion works in the shells.
. tests/support/cli.sh

# options_of FILE: the names in the list of options that begins with a line like the pattern.
options_of() {
    sed -n "/^$2/,/^\$/s/^ *\(-., \)\{0,1\}--\([a-z-]*\).*/\2/p" "$1"
}

"$GRCTL" help >"$work/help"
"$GRCTL" help --man >"$work/grctl.1"
test_case "scripts are printed"
for shell in bash zsh fish; do
    check "completion $shell" exits 0 "$GRCTL" completion $shell
    cp "$work/out" "$work/complete.$shell"
done
sed -n '/^Global options/q;s/^  \([a-z-]*\) .*/\1/p' "$work/help" >"$work/commands"
options_of "$work/help" 'Global options' >"$work/global"
check "there are commands and global options" test -s "$work/commands" -a -s "$work/global"

# missing WHAT WHERE: says so and fails.
missing() {
    echo "$2 does not have $1"
    return 1
}

# The part of a file for one command: its section, its case.
in_manual() {
    sed -n "/^\.Ss $1\$/,/^\.S[sh] /p" "$work/grctl.1"
}
# offered WORD...: what may stand in the place of the last word.
offered() {
    "$GRCTL" __complete "$@" | cut -f 1
}

# has_options COMMAND: each option of its help is known to parser, man page and completion.
has_options() {
    "$GRCTL" help "$1" >"$work/one"
    options_of "$work/one" Options >"$work/options"
    roff=0
    while read -r option; do
        roff_name=$(printf '%s' "$option" | sed 's/-/\\\\-/g')
        "$GRCTL" "$1" --help "--$option" </dev/null 2>&1 | grep -q 'unknown option' &&
            { missing "--$option" "the parser"; return 1; }
        in_manual "$1" | grep -q -e "^\.It.* Fl ..$roff_name\( \|\$\)" ||
            { missing "--$option" "the man page"; return 1; }
        offered "$1" "--$option" | grep -q -x -e "--$option" ||
            { missing "--$option" completion; return 1; }
        roff=$((roff + 1))
    done <"$work/options"
    [ "$(in_manual "$1" | grep -c '^\.It ')" -eq $roff ] || missing "as many options" "the man page"
}

offered '' >"$work/offered"
offered -- >"$work/offered_options"
test_case "commands and options are known everywhere"
while read -r command; do
    check "$command: the parser knows it" exits 0 "$GRCTL" "$command" --help
    check "$command: a section of the man page" grep -q -e "^\.Ss $command\$" "$work/grctl.1"
    check "$command: completion" grep -q -x -e "$command" "$work/offered"
    check "$command: its options everywhere" has_options "$command"
done <"$work/commands"
check "the man page has no other sections" \
    [ "$(grep -c '^\.Ss ' "$work/grctl.1")" -eq "$(wc -l <"$work/commands")" ]
while read -r option; do
    roff_name=$(printf '%s' "$option" | sed 's/-/\\\\-/g')
    check "--$option: man page" grep -q -e "^\.It.* Fl ..$roff_name\( \|\$\)" "$work/grctl.1"
    check "--$option: completion" grep -q -x -e "--$option" "$work/offered_options"
done <"$work/global"

# quiet COMMAND...: nothing is said.
quiet() {
    quiet_said=$("$@" 2>&1 >"$work/rendered")
    [ -z "$quiet_said" ] || { echo "$quiet_said"; return 1; }
}
test_case "the man page renders"
if command -v mandoc >/dev/null 2>&1; then
    mandoc_lint() {
        mandoc -Tlint -Wwarning "$work/grctl.1"
    }
    check "mandoc has nothing to say of the man page" mandoc_lint
else
    skip "mandoc on the man page" "no mandoc here"
fi
if command -v groff >/dev/null 2>&1 && [ -e /usr/share/groff/current/tmac/doc.tmac ]; then
    check "groff renders the man page without warnings" \
        quiet groff -ww -mdoc -Tascii "$work/grctl.1"
    check "and there is something on it" grep -q 'initial posture' "$work/rendered"
else
    skip "groff on the man page" "no groff with mdoc here"
fi

# ---- in the shells ---------------------------------------------------------------------------

# The shells look for the command where they are started.
case $GRCTL in
/*) grctl=$GRCTL ;;
*) grctl=$PWD/$GRCTL ;;
esac

# completes WANT WORD...: bash completes the last word to just that (words, in any order).
cat >"$work/try.bash" <<'EOF'
. "$1"
shift
COMP_WORDS=("$@")
COMP_CWORD=$(($# - 1))
_grctl "$COMMAND"
echo "${COMPREPLY[@]}"
EOF
completes() {
    completes_want=$1
    shift
    completes_got=$(cd "$work/files" &&
        COMMAND=$grctl bash "$work/try.bash" "$work/complete.bash" grctl "$@" 2>&1)
    [ "$completes_got" = "$completes_want" ] && return
    echo "'$completes_got', not '$completes_want'"
    return 1
}
mkdir "$work/files" "$work/files/sub"
: >"$work/files/walk.pseq"
: >"$work/files/two words.m"
test_case "bash completes"
if command -v bash >/dev/null 2>&1; then
    check "bash: it registers itself" bash -c '. "$0" && complete -p grctl' "$work/complete.bash"
    check "bash: a command" completes 'status' stat
    check "bash: commands" completes 'play plot' pl
    check "bash: an option" completes '--speed' play --sp
    check "bash: a global option" completes '--wiring' play --wi
    check "bash: before a command" completes '--wiring' --wi
    check "bash: choices" completes 'exact numeric off' play --ik ''
    check "bash: choices of a global option" completes 'board bus' --wiring b
    check "bash: --color=al" completes 'always' --color = al
    check "bash: --color=" completes 'auto always never' --color =
    check "bash: a command behind an option with its value" completes 'scan' --wiring bus sca
    check "bash: a joint" completes 'R_KNEE_P' status R_KN
    check "bash: a group" completes 'left_arm left_leg legs' servo on le
    check "bash: the words of an argument" completes 'brake' servo b
    check "bash: a command as an argument" completes 'serve servo servo-get servo-set' help serv
    check "bash: a file" completes 'walk.pseq' play w
    check "bash: files with blanks" completes 'two words.m' play t
    check "bash: a file for an option" completes 'walk.pseq' plot -o wal
    check "bash: a device" completes 'sim' -d si
    check "bash: nothing for a number" completes '' play --repeat ''
    check "bash: nothing for a command that is none" completes '' nonsense ''
else
    skip "completion in bash" "no bash here"
fi
test_case "zsh completes"
if command -v zsh >/dev/null 2>&1; then
    check "zsh: it registers itself" zsh -f -c '
        autoload -U compinit && compinit -D -u && . "$0" && [[ $_comps[grctl] == _grctl ]]' \
        "$work/complete.zsh"
    # What zsh would be given: _describe and _files are its own.
    zsh_completes() {
        zsh_want=$1
        shift
        zsh_got=$(cd "$work/files" && zsh -f -c '
            compdef() { :; }
            . "$1"
            _describe() { (( ! $#found )) || print -l -- ${found%%:*}; }
            _files() { print files; }
            shift
            words=("$@")
            CURRENT=$#
            _grctl' zsh "$work/complete.zsh" "$grctl" "$@" | tr '\n' ' ')
        [ "$zsh_got" = "$zsh_want " ] || { echo "'$zsh_got', not '$zsh_want '"; return 1; }
    }
    check "zsh: a command" zsh_completes status stat
    check "zsh: an option" zsh_completes --speed play --sp
    check "zsh: choices" zsh_completes 'board bus' --wiring b
    check "zsh: a joint" zsh_completes R_KNEE_P status R_KN
    check "zsh: a file" zsh_completes files play w
else
    skip "completion in zsh" "no zsh here"
fi
test_case "fish completes"
if command -v fish >/dev/null 2>&1; then
    fish_completes() {
        fish_got=$(cd "$work/files" && HOME=$work fish -N -c "source $work/complete.fish
            function grctl; $grctl \$argv; end
            complete -C '$1'" |
            cut -f 1 | tr '\n' ' ')
        [ "$fish_got" = "$2 " ] || { echo "'$fish_got', not '$2 '"; return 1; }
    }
    check "fish: a command" fish_completes 'grctl stat' status
    check "fish: an option" fish_completes 'grctl play --sp' --speed
    check "fish: choices" fish_completes 'grctl --wiring b' 'board bus'
    check "fish: --color=al" fish_completes 'grctl --color=al' --color=always
    check "fish: a joint" fish_completes 'grctl status R_KN' R_KNEE_P
    check "fish: a file" fish_completes 'grctl play wa' walk.pseq
else
    skip "completion in fish" "no fish here"
fi
done_testing
