/* SPDX-License-Identifier: MIT */
/* `grctl agent` and `grctl fleet` where they are a program beside this one. */
#include "tools/grctl/beside.h"
#include "tools/grctl/fleet/run.h"

int agent_run(app *a)
{
    return beside_run(a, "grctl-fleet");
}

int fleet_run(app *a)
{
    return beside_run(a, "grctl-fleet");
}
