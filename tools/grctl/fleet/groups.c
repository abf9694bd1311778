/* SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "tools/grctl/fleet/agent.h"

agent_group *agent_find_group(agent *g, const char *name)
{
    for (int i = 0; i < g->n_groups; i++) {
        if (strcmp(g->groups[i].name, name) == 0) {
            return &g->groups[i];
        }
    }
    return NULL;
}

void agent_join(agent *g, const char *group)
{
    if (!agent_find_group(g, group) && g->n_groups < AGENT_GROUPS) {
        snprintf(g->groups[g->n_groups++].name, FLEET_NAME_BYTES, "%s", group);
    }
}

const char *agent_latched(const agent *g)
{
    static char text[FLEET_NAME_BYTES + 32];
    for (int i = 0; i < g->n_groups; i++) {
        if (g->groups[i].latch) {
            snprintf(text, sizeof text, "a stop of group %s stands", g->groups[i].name);
            return text;
        }
    }
    return NULL;
}

bool agent_brakes(const agent_group *group)
{
    const char *how = fleet_text(group->latch, "how");
    return !how || strcmp(how, "stop") != 0;
}
