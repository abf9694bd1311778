/* SPDX-License-Identifier: MIT */
/* Where expat was not there when grctl was built. */
#include <stdio.h>

#include "tools/grctl/lang/lang.h"
#include "tools/grctl/robot/xml.h"

const char *xml_missing(void)
{
    return _("this grctl was built without expat, which reads XML");
}

unsigned xml_line(void)
{
    return 0;
}

int xml_read(const char *bytes, size_t size, const xml_ear *ear, xml_trouble *trouble)
{
    (void)bytes;
    (void)size;
    (void)ear;
    *trouble = (xml_trouble){.line = 1, .column = 1};
    snprintf(trouble->text, sizeof trouble->text, "%s", xml_missing());
    return -1;
}
