/* kind.c -- walking the lists of kinds. See kind.h. */
#include "base/kind.h"

#include <string.h>

const KindInfo *kind_info(const void *list, size_t k)
{
    const KindInfo *const *kinds = list;
    return kinds[k];
}

const void *kind_find(const void *list, const char *name)
{
    const KindInfo *info;
    for (size_t k = 0; (info = kind_info(list, k)) != NULL; k++)
        if (!strcmp(info->name, name))
            return info;
    return NULL;
}

const void *kind_find_at(Place at, const void *list, const char *what, const char *name)
{
    enum { MOST = 64 };
    const char *names[MOST];
    const void *found = kind_find(list, name);
    const KindInfo *info;
    size_t n = 0;
    char have[500] = "", hint[HINT_MAX];

    if (found)
        return found;
    for (; n < MOST && (info = kind_info(list, n)) != NULL; n++) {
        names[n] = info->name;
        if (strlen(have) + strlen(info->name) + 2 < sizeof have) {
            strcat(have, " ");
            strcat(have, info->name);
        }
    }
    hint_nearest(hint, name, names, n);
    if (at.file)
        err_at(at, "unknown %s '%s'%s (have:%s)", what, name, hint, have);
    else
        err_usage("unknown %s '%s'%s (have:%s)", what, name, hint, have);
    return NULL;
}

const void *kind_from_text(const void *list, const char *what, const char *text, Opts *o,
                           Arena *arena)
{
    size_t n = strcspn(text, ":");
    char *name = arena_string(arena, text, n);
    const KindInfo *kind;

    if (!name)
        return NULL;
    kind = kind_find_at((Place){ NULL, 0, 0 }, list, what, name);
    if (!kind)
        return NULL;
    opts_default(o, kind->options);
    return opts_parse(o, name, text[n] ? text + n + 1 : "", arena) ? kind : NULL;
}
