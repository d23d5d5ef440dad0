/* skipped.c -- one warning for all that a reader left out. See skipped.h. */
#include "geometry/skipped.h"

#include <stdio.h>
#include <string.h>

static const char *const texts[SKIPPED_KINDS] = {
    [SKIPPED_KEYWORD]   = "statements that are not supported left out",
    [SKIPPED_FACE]      = "faces of fewer than 3 corners left out",
    [SKIPPED_ATTRIBUTE] = "normals or texture coordinates that are not in the file left out",
    [SKIPPED_CARE]      = "polygons of very many corners cut as fans, which is right if convex",
    [SKIPPED_SPECTRUM]  = "spectral or XYZ colours left out, RGB was expected",
    [SKIPPED_OPTION]    = "maps with an unknown option left out",
    [SKIPPED_ORPHAN]    = "statements before the first newmtl left out",
    [SKIPPED_TAIL]      = "bytes after the last element left out",
    [SKIPPED_ALL]       = "no triangles in this file",
};

static bool empty(const Skipped *s)
{
    for (int k = 0; k < SKIPPED_KINDS; k++)
        if (s->n[k])
            return false;
    return true;
}

void skipped_note(Skipped *s, SkippedKind kind, Place at)
{
    if (empty(s))
        s->first = at;
    s->n[kind]++;
}

void skipped_keyword(Skipped *s, Place at, Word keyword)
{
    if (!s->n[SKIPPED_KEYWORD])
        word_copy(s->word, sizeof s->word, keyword);
    skipped_note(s, SKIPPED_KEYWORD, at);
}

bool skipped_report(const Skipped *s)
{
    char text[800] = "";

    if (empty(s))
        return true;
    for (int k = 0; k < SKIPPED_KINDS; k++) {
        size_t used = strlen(text);
        if (!s->n[k])
            continue;
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", used ? "; " : "",
                                 texts[k]);
        if (k != SKIPPED_ALL)
            used += (size_t)snprintf(text + used, sizeof text - used, ": %lu",
                                     (unsigned long)s->n[k]);
        if (k == SKIPPED_KEYWORD)
            snprintf(text + used, sizeof text - used, " (first '%s')", s->word);
    }
    return warn_at(s->first, "%s", text);
}
