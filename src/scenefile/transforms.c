/* transforms.c -- the directives that change the current transform. As in pbrt, each is multiplied
 * onto it from the right, so that the one nearest to a shape acts first.
 *
 * A scene may move: ActiveTransform chooses whether a directive changes the transform of the start,
 * of the end, or of both. Shapes, objects and the camera for which the two differ move. */
#include "scenefile/reader.h"

#include <float.h>

/* True if both maps are finite as floats too, which rays use. */
static bool all_finite(const Transform *t)
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            if (!(fabs(t->m[i][j]) <= FLT_MAX) || !(fabs(t->inv[i][j]) <= FLT_MAX))
                return false;
    return true;
}

static bool set_one(Place at, Transform *which, const Transform *t)
{
    if (!all_finite(t))
        return err_at(at, "the current transform becomes infinite or flat");
    *which = *t;
    return true;
}

/* Sets the current transforms, of those two that directives act on just now. */
static bool set_active(Reader *r, Place at, const Transform *start, const Transform *end)
{
    return (!r->state.at_start || set_one(at, &r->state.ctm, start)) &&
           (!r->state.at_end || set_one(at, &r->state.end, end));
}

static bool set(Reader *r, Place at, const Transform *t) { return set_active(r, at, t, t); }

static bool append(Reader *r, Place at, const Transform *t)
{
    Transform start = xf_then(&r->state.ctm, t), end = xf_then(&r->state.end, t);
    return set_active(r, at, &start, &end);
}

bool do_identity(Reader *r, Place at)
{
    Transform t = xf_identity();
    return set(r, at, &t);
}

bool do_translate(Reader *r, Place at)
{
    double v[3];
    Transform t;
    if (!reader_numbers(r, "Translate", 3, v))
        return false;
    t = xf_translate(v[0], v[1], v[2]);
    return append(r, at, &t);
}

bool do_scale(Reader *r, Place at)
{
    double v[3];
    Transform t;
    if (!reader_numbers(r, "Scale", 3, v))
        return false;
    if (v[0] == 0 || v[1] == 0 || v[2] == 0)
        return err_at(at, "Scale by 0 makes everything flat");
    t = xf_scale(v[0], v[1], v[2]);
    return append(r, at, &t);
}

bool do_rotate(Reader *r, Place at)
{
    double v[4];
    Transform t;
    if (!reader_numbers(r, "Rotate", 4, v))
        return false;
    if (v[1] == 0 && v[2] == 0 && v[3] == 0)
        return err_at(at, "Rotate needs an axis that is not 0 0 0");
    t = xf_rotate(v[0], v[1], v[2], v[3]);
    return append(r, at, &t);
}

bool do_look_at(Reader *r, Place at)
{
    double v[9];
    Transform t;
    if (!reader_numbers(r, "LookAt", 9, v))
        return false;
    if (!xf_look_at(&t, v3((float)v[0], (float)v[1], (float)v[2]),
                    v3((float)v[3], (float)v[4], (float)v[5]),
                    v3((float)v[6], (float)v[7], (float)v[8])))
        return err_at(at,
                      "LookAt needs an eye apart from its target, and an up that points elsewhere");
    return append(r, at, &t);
}

/* Sixteen numbers, column by column. */
static bool read_matrix(Reader *r, Place at, const char *what, Transform *t)
{
    double v[16], m[4][4];

    if (!reader_numbers(r, what, 16, v))
        return false;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            m[i][j] = v[4 * j + i];
    if (m[3][0] != 0 || m[3][1] != 0 || m[3][2] != 0 || m[3][3] == 0)
        return err_at(at, "%s holds a projection; expected 0 0 0 1 as its 4th, 8th, 12th and 16th "
                      "numbers", what);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            m[i][j] /= v[15];
    if (!xf_from(t, m))
        return err_at(at, "%s holds a matrix without an inverse", what);
    return true;
}

bool do_transform(Reader *r, Place at)
{
    Transform t;
    return read_matrix(r, at, "Transform", &t) && set(r, at, &t);
}

bool do_concat_transform(Reader *r, Place at)
{
    Transform t;
    return read_matrix(r, at, "ConcatTransform", &t) && append(r, at, &t);
}

/* ---- named systems ---- */

bool system_set(Reader *r, const char *name, const Transform *start, const Transform *end)
{
    uint32_t i = names_find(&r->systems, name);
    System system = { *start, *end };

    if (i != NAME_NONE) {
        r->transforms[i] = system;
        return true;
    }
    return names_set(&r->systems, &r->out->arena, name, (uint32_t)r->ntransforms) &&
           MEM_PUSH(r->transforms, r->ntransforms, r->cap_transforms, system);
}

bool do_coordinate_system(Reader *r, Place at)
{
    Token t;
    char *name;
    (void)at;
    if (!reader_string(r, "the name of the coordinate system", &t))
        return false;
    name = reader_text(r, &t);
    return name && system_set(r, name, &r->state.ctm, &r->state.end);
}

bool do_coord_sys_transform(Reader *r, Place at)
{
    Token t;
    char *name, hint[HINT_MAX];
    uint32_t i;

    if (!reader_string(r, "the name of the coordinate system", &t))
        return false;
    name = reader_text(r, &t);
    if (!name)
        return false;
    i = names_find(&r->systems, name);
    if (i != NAME_NONE)
        return set_one(at, &r->state.ctm, &r->transforms[i].start) &&
               set_one(at, &r->state.end, &r->transforms[i].end);
    return warn_at(t.at, "unknown coordinate system '%.80s'%s; the transform stays", name,
                   names_hint(&r->systems, name, hint));
}

/* ---- motion ---- */

bool do_active_transform(Reader *r, Place at)
{
    Token t;

    (void)at;
    if (!reader_next(r, &t))
        return false;
    r->state.at_start = token_is(&t, "StartTime") || token_is(&t, "All");
    r->state.at_end = token_is(&t, "EndTime") || token_is(&t, "All");
    if (t.kind != TOKEN_NAME || (!r->state.at_start && !r->state.at_end))
        return err_at(t.at, "expected StartTime, EndTime or All");
    return true;
}

bool do_transform_times(Reader *r, Place at)
{
    double v[2];

    if (!reader_numbers(r, "TransformTimes", 2, v))
        return false;
    if (!(v[0] < v[1]))
        return err_at(at, "TransformTimes needs a start before its end");
    r->scene->times[0] = v[0];
    r->scene->times[1] = v[1];
    return true;
}
