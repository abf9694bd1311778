/* SPDX-License-Identifier: MIT */
/* `grctl serve` where it is a program beside this one. */
#include "tools/grctl/beside.h"
#include "tools/grctl/web/run.h"

int serve_run(app *a)
{
    return beside_run(a, "grctl-serve");
}
