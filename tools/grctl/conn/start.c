/* SPDX-License-Identifier: MIT */
/* The beginning of every program of this command: language, guard, completion, the line. */
#include <locale.h>
#include <string.h>

#include <event2/event.h>

#include "tools/grctl/cli/robot.h"
#include "tools/grctl/cli/run.h"
#include "tools/grctl/conn/family.h"
#include "tools/grctl/conn/guard.h"
#include "tools/grctl/conn/start.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"

char *const *start_words;

/*
 * Numbers, times and errno's texts stay those of the C locale: a decimal comma would spoil files.
 * Messages need no locale to be installed, but what places them on a screen needs its characters.
 */
static void choose_language(void)
{
    setlocale(LC_CTYPE, "");
    if (lang_start(lang_wanted(), os_shows_utf8()) && !os_shows_utf8()) {
        setlocale(LC_CTYPE, "C.UTF-8");
    }
}

/* What libevent would print, of an address or a descriptor: the complaint is that of the caller. */
static void keep_silent(int severity, const char *text)
{
    (void)severity;
    (void)text;
}

int start(int argc, char **argv, const start_program *program)
{
    static app a;
    start_words = argv;
    os_start();
    event_set_log_callback(keep_silent);
    family_list();
    cli_commands = program->commands;
    cli_n_commands = program->n_commands;
    if (argc > 1 && strcmp(argv[1], "__complete") == 0) { /* by the script of a shell */
        robot_of_words(&a, argc - 2, argv + 2);
        cli_print_completions(stdout, app_model(&a), argc - 2, argv + 2);
        return EXIT_DONE;
    }
    choose_language();
    if (argc == 2 && strcmp(argv[1], "guard") == 0) {
        return guard_main();
    }
    if (argc == 2 && program->word && strcmp(argv[1], program->word) == 0) {
        return program->run_word();
    }
    guard_note_program(argv[0]);
    return app_finish(&a, run_line(&a, argc, argv, NULL, NULL));
}
