/* attributes.c -- what AttributeBegin saves and AttributeEnd brings back, and objects that are
 * defined once and placed often.
 *
 * The stack is explicit and bounded, so that no file can exhaust the program's own. */
#include "scenefile/reader.h"

#include <string.h>

static const struct { const char *begin, *end; } pairs[] = {
    { "AttributeBegin", "AttributeEnd" }, { "TransformBegin", "TransformEnd" },
    { "ObjectBegin", "ObjectEnd" }, { "Import", "the end of the imported file" }
};

bool stack_push(Reader *r, SavedKind kind, Place at)
{
    Saved s = { kind, r->state, at, ++r->nblocks };
    if (r->nstack == STACK_MAX)
        return err_at(at, "attributes are nested more than %d deep", STACK_MAX);
    return MEM_PUSH(r->stack, r->nstack, r->cap_stack, s);
}

bool stack_holds(const Reader *r, uint64_t block)
{
    size_t i = r->nstack;

    while (i > 0 && r->stack[i - 1].block != block)
        i--;
    return block == 0 || i > 0;
}

static void restore(Reader *r, const Saved *s)
{
    if (s->kind == SAVED_TRANSFORM) {
        r->state.ctm = s->state.ctm;
        r->state.end = s->state.end;
        r->state.at_start = s->state.at_start;
        r->state.at_end = s->state.at_end;
    } else
        r->state = s->state;
    if (s->kind == SAVED_OBJECT)
        r->object = 0;
}

static bool pop(Reader *r, SavedKind kind, Place at)
{
    const Saved *s = r->nstack ? &r->stack[r->nstack - 1] : NULL;

    if (!s)
        return err_at(at, "%s without %s", pairs[kind].end, pairs[kind].begin);
    if (s->kind != kind)
        return err_at(at, "%s stands where %s was expected, for the %s in line %d", pairs[kind].end,
                      pairs[s->kind].end, pairs[s->kind].begin, s->at.line);
    r->nstack--;
    restore(r, s);
    return true;
}

bool stack_unwind(Reader *r, size_t depth)
{
    while (r->nstack > depth) {
        const Saved *s = &r->stack[--r->nstack];
        if (s->kind != SAVED_IMPORT &&
            !warn_at(s->at, "%s has no %s; it ends here", pairs[s->kind].begin, pairs[s->kind].end))
            return false;
        restore(r, s);
    }
    return true;
}

bool do_attribute_begin(Reader *r, Place at) { return stack_push(r, SAVED_ATTRIBUTE, at); }
bool do_attribute_end(Reader *r, Place at) { return pop(r, SAVED_ATTRIBUTE, at); }
bool do_transform_begin(Reader *r, Place at) { return stack_push(r, SAVED_TRANSFORM, at); }
bool do_transform_end(Reader *r, Place at) { return pop(r, SAVED_TRANSFORM, at); }

bool do_reverse_orientation(Reader *r, Place at)
{
    (void)at;
    r->state.reverse = !r->state.reverse;
    return true;
}

/* ---- objects ---- */

bool do_object_begin(Reader *r, Place at)
{
    Token t;
    char *name;
    uint32_t geometry;

    if (!reader_string(r, "the name of the object", &t))
        return false;
    if (r->object)
        return err_at(at, "ObjectBegin inside of an object");
    name = reader_text(r, &t);
    if (!name)
        return false;
    if (names_find(&r->objects, name) != NAME_NONE)
        return err_at(t.at, "an object is called '%.80s' already", name);
    if (!stack_push(r, SAVED_OBJECT, at) || !scene_add_geometry(r->scene, &geometry) ||
        !names_set(&r->objects, &r->out->arena, name, geometry))
        return false;
    r->object = geometry;
    return true;
}

bool do_object_end(Reader *r, Place at) { return pop(r, SAVED_OBJECT, at); }

static bool unknown_object(Reader *r, Place at, const char *name)
{
    char hint[HINT_MAX];
    return warn_at(at, "unknown object '%.80s'%s; it is left out", name,
                   names_hint(&r->objects, name, hint));
}

bool do_object_instance(Reader *r, Place at)
{
    Token t;
    char *name;
    uint32_t child;

    if (!reader_string(r, "the name of the object", &t))
        return false;
    name = reader_text(r, &t);
    if (!name)
        return false;
    child = names_find(&r->objects, name);
    if (child == NAME_NONE)
        return unknown_object(r, t.at, name);
    if (r->object)
        return err_at(at, child == r->object ? "an object holds an instance of itself"
                                             : "an object cannot hold instances of others");
    return mover_place(r, at, child, &r->state.ctm, &r->state.end) &&
           movers_place(r, at, child, &r->state.ctm, &r->state.end);
}

/* ---- Attribute "target" parameters ---- */

bool do_attribute(Reader *r, Place at)
{
    static const char *const targets[TARGETS] = { "shape", "light", "material", "medium",
                                                  "texture" };
    Token t;
    Params ps;
    Defaults *d;
    int target = 0;
    const Defaults *before;

    if (!reader_string(r, "the target of the attributes", &t))
        return false;
    while (target < TARGETS && !token_is(&t, targets[target]))
        target++;
    if (target == TARGETS)
        return err_at(t.at,
                      "expected \"shape\", \"light\", \"material\", \"medium\" or \"texture\"");
    if (!params_read(r, target == TARGET_LIGHT ? SPECTRUM_LIGHT : SPECTRUM_ALBEDO, &ps))
        return false;
    before = r->state.defaults[target];
    d = arena_take(&r->out->arena, 1, sizeof *d);
    if (!d)
        return false;
    d->next = before;
    d->total = ps.n + (before ? before->total : 0);
    if (d->total > DEFAULTS_MAX)
        return err_at(at, "Attribute gives more than %d parameters for one target", DEFAULTS_MAX);
    if (!params_keep(&r->out->arena, &ps, NULL, &d->params))
        return false;
    r->state.defaults[target] = d;
    return true;
}

bool do_color_space(Reader *r, Place at)
{
    Token t;
    double (*m)[3];
    char name[40];

    (void)at;
    if (!reader_string(r, "the name of the colour space", &t))
        return false;
    word_copy(name, sizeof name, (Word){ t.s, t.n });
    m = arena_take(&r->out->arena, 3, sizeof *m);
    if (!m)
        return false;
    if (!spectrum_space(name, m)) {
        size_t n = 0;
        char hint[HINT_MAX];
        while (spectrum_spaces[n])
            n++;
        return warn_at(t.at, "unknown colour space '%s'%s; colours are taken as before", name,
                       hint_nearest(hint, name, spectrum_spaces, n));
    }
    r->state.space = strcmp(name, "srgb") ? (const double (*)[3])m : NULL;
    return true;
}
