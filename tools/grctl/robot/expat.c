/* SPDX-License-Identifier: MIT */
#include <expat.h>
#include <stdbool.h>
#include <stdio.h>

#include "tools/grctl/lang/lang.h"
#include "tools/grctl/robot/xml.h"

typedef struct reader {
    XML_Parser parser;
    const xml_ear *ear;
    int depth;
    const char *refused; /* why it was ended, or NULL */
} reader;

static XML_Parser now; /* that an ear is called for */

/* Since 2.9.0 places are of 64 bits; the functions before them are deprecated. */
static xml_trouble place(XML_Parser parser)
{
#if XML_MAJOR_VERSION > 2 || (XML_MAJOR_VERSION == 2 && XML_MINOR_VERSION >= 9)
    return (xml_trouble){.line = (unsigned)XML_GetCurrentLineNumber64(parser),
                         .column = (unsigned)XML_GetCurrentColumnNumber64(parser) + 1};
#else
    return (xml_trouble){.line = (unsigned)XML_GetCurrentLineNumber(parser),
                         .column = (unsigned)XML_GetCurrentColumnNumber(parser) + 1};
#endif
}

const char *xml_missing(void)
{
    return NULL;
}

unsigned xml_line(void)
{
    return now ? place(now).line : 0;
}

static void refuse(reader *r, const char *why)
{
    r->refused = why;
    XML_StopParser(r->parser, XML_FALSE);
}

static void on_begin(void *ctx, const XML_Char *name, const XML_Char **attributes)
{
    reader *r = ctx;
    if (r->refused) {
        return;
    }
    if (r->depth == XML_DEPTH_MAX) {
        refuse(r, _("elements are nested too deeply"));
        return;
    }
    r->ear->begin(r->ear->ctx, r->depth++, name, (const char *const *)attributes);
}

static void on_text(void *ctx, const XML_Char *bytes, int size)
{
    reader *r = ctx;
    if (!r->refused) {
        r->ear->text(r->ear->ctx, bytes, (size_t)size);
    }
}

static void on_end(void *ctx, const XML_Char *name)
{
    reader *r = ctx;
    (void)name;
    if (!r->refused) {
        r->ear->end(r->ear->ctx, --r->depth);
    }
}

/* Entities are declared in one, and may grow without bounds. */
static void on_doctype(void *ctx, const XML_Char *name, const XML_Char *system,
                       const XML_Char *public_id, int has_internal)
{
    (void)name;
    (void)system;
    (void)public_id;
    (void)has_internal;
    refuse(ctx, _("a document type is not read"));
}

int xml_read(const char *bytes, size_t size, const xml_ear *ear, xml_trouble *trouble)
{
    reader r = {.parser = XML_ParserCreate(NULL), .ear = ear};
    if (!r.parser) {
        *trouble = (xml_trouble){.text = ""};
        snprintf(trouble->text, sizeof trouble->text, "%s", _("not enough memory"));
        return -1;
    }
    XML_SetUserData(r.parser, &r);
    XML_SetElementHandler(r.parser, on_begin, on_end);
    XML_SetCharacterDataHandler(r.parser, on_text);
    XML_SetStartDoctypeDeclHandler(r.parser, on_doctype);
    now = r.parser;
    bool whole = XML_Parse(r.parser, bytes, (int)size, XML_TRUE) == XML_STATUS_OK;
    now = NULL;
    if (!whole) {
        *trouble = place(r.parser);
        snprintf(trouble->text, sizeof trouble->text, "%s",
                 r.refused ? r.refused : XML_ErrorString(XML_GetErrorCode(r.parser)));
    }
    XML_ParserFree(r.parser);
    return whole ? 0 : -1;
}
