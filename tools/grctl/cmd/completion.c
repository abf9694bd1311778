/* SPDX-License-Identifier: MIT */
/*
 * completion: the script of a shell, which asks `grctl __complete WORD...` at each TAB. bash splits
 * words at =.
 */
#include <string.h>

#include "tools/grctl/cli/app.h"
#include "tools/grctl/cmd/commands.h"

static const struct {
    const char *shell, *script;
} all[] = {
    {"bash", "# bash completion for grctl; made by 'grctl completion bash'.\n"
             "_grctl() {\n"
             "    local IFS=$'\\n' line current=${COMP_WORDS[COMP_CWORD]#=}\n"
             "    COMPREPLY=()\n"
             "    while read -r line; do\n"
             "        if [ \"$line\" = :files ]; then\n"
             "            compopt -o filenames 2>/dev/null\n"
             "            COMPREPLY+=($(compgen -f -- \"$current\"))\n"
             "        else\n"
             "            COMPREPLY+=(\"${line%%$'\\t'*}\")\n"
             "        fi\n"
             "    done < <(\"$1\" __complete \"${COMP_WORDS[@]:1:COMP_CWORD}\" 2>/dev/null)\n"
             "}\n"
             "complete -F _grctl grctl\n"},
    {"zsh",
     "#compdef grctl\n"
     "# zsh completion for grctl; made by 'grctl completion zsh'.\n"
     "_grctl() {\n"
     "    local line word files\n"
     "    local -a asked=(\"${(@Q)words[2,CURRENT]}\") found\n"
     "    for line in ${(f)\"$($words[1] __complete \"$asked[@]\" 2>/dev/null)\"}; do\n"
     "        word=${line%%$'\\t'*}\n"
     "        if [[ $line == :files ]]; then\n"
     "            files=yes\n"
     "        else\n"
     "            found+=(\"${word//:/\\\\:}${${line#$word}/$'\\t'/:}\")\n"
     "        fi\n"
     "    done\n"
     "    _describe grctl found\n"
     "    [[ -z $files ]] || _files\n"
     "}\n"
     "if [[ $funcstack[1] == _grctl ]]; then _grctl \"$@\"; else compdef _grctl grctl; fi\n"},
    {"fish", "# fish completion for grctl; made by 'grctl completion fish'.\n"
             "function __grctl_complete\n"
             "    set -l words (commandline -opc) (commandline -ct)\n"
             "    for line in ($words[1] __complete $words[2..-1] 2>/dev/null)\n"
             "        if test \"$line\" = :files\n"
             "            __fish_complete_path (commandline -ct)\n"
             "        else\n"
             "            echo $line\n"
             "        end\n"
             "    end\n"
             "end\n"
             "complete -c grctl -f -a '(__grctl_complete)'\n"},
};

static int run(app *a)
{
    const char *shell = a->line.argument[0];
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        if (strcmp(shell, all[i].shell) != 0) {
            continue;
        }
        if (a->json) {
            app_print_json(json_pack("{s:s,s:s}", "shell", shell, "script", all[i].script));
        } else {
            app_print("%s", all[i].script);
        }
        return EXIT_DONE;
    }
    return app_fail(a, EXIT_USAGE, "ARG", "completion: '%s' is not one of bash, zsh, fish", shell);
}

const cli_command cmd_completion = {
    .name = "completion",
    COMMAND_ARGUMENTS("bash|zsh|fish", 1, 1, CLI_ARG_WORD),
    .summary = "print a script that completes command lines",
    .details = "Prints the script that makes a shell complete commands, options, joints, groups\n"
               "and files of grctl. 'make install' puts it where the shells look for it.\n",
    .example = "  source <(grctl completion bash)\n"
               "  grctl completion fish >~/.config/fish/completions/grctl.fish\n",
    .run = run,
};
