/* SPDX-License-Identifier: MIT */
/* Lines that more than one writer writes. */
#include <string.h>

#include "src/motion/format/write.h"

void grobo_i_put_kept(grobo_i_out *out, const grobo_i_kept *kept, grobo_kept_level level, int link,
                      int indent)
{
    for (; kept != NULL; kept = kept->next) {
        if (kept->level != level || (level == GROBO_KEPT_LINK && kept->link != link)) {
            continue;
        }
        for (int i = 0; i < indent; i++) {
            grobo_i_put(out, " ", 1);
        }
        grobo_i_put_name(out, kept->text, kept->key_bytes - 1);
        grobo_i_put_text(out, ": ");
        grobo_i_put(out, kept->text + kept->key_bytes, kept->value_bytes - 1);
        grobo_i_put_text(out, "\n");
    }
}

void grobo_i_put_text_line(grobo_i_out *out, const char *name, const char *value)
{
    grobo_i_put_text(out, name);
    grobo_i_put_text(out, ": ");
    grobo_i_put_quoted(out, value, strlen(value));
    grobo_i_put_text(out, "\n");
}
