/* SPDX-License-Identifier: MIT */
/*
 * Commands that are programs beside grctl, as git has them: they bring libraries that nothing else
 * needs. Each is found in the directory of this program, or in ../libexec/grctl of it, takes the
 * place of this process and reads the same line.
 */
#include <string.h>

#include "tools/grctl/beside.h"
#include "tools/grctl/conn/start.h"
#include "tools/grctl/lang/lang.h"
#include "tools/grctl/os/os.h"

enum { PATH_BYTES = 4096 };

int beside_run(app *a, const char *program)
{
    char path[PATH_BYTES];
    if (a->link) {
        return app_fail(a, EXIT_USAGE, "UNSUPPORTED", "%s: not in a shell: 'grctl %s' is for it",
                        a->line.command->name, a->line.command->name);
    }
    bool found = os_beside(start_words[0], program, path, sizeof path);
    if (found) {
        os_become(path, start_words);
    }
    return app_fail(a, EXIT_FILE, "NOENT", "%s: %s is %s", a->line.command->name, program,
                    found ? _("no program that runs here")
                          : _("not installed beside this grctl; one package has both"));
}
