/* reach.c -- the code of `reach.h` */
#include "integrators/reach.h"

#include "base/mem.h"

/* A place lies behind a record if it is so much of the radius below: on a curved or bumpy surface
 * some of that is due to rounding and to normals that are interpolated. */
#define BEHIND 0.02f

float reach_limit(Reach *r, float inv_distance, float value, float slope, float least, float most)
{
    float kept = 1.0f;

    r->radius = most;
    r->least = least;
    if (inv_distance * most > 1.0f)
        r->radius = 1.0f / inv_distance;
    if (slope * r->radius > value)
        r->radius = value / slope;
    if (r->radius < least) {    /* it reaches beyond what its slope is good for */
        kept = r->radius / least;
        r->radius = least;
    }
    return kept;
}

float reach_error(const Reach *r, V3 p, V3 n)
{
    V3 d = v_sub(p, r->p);

    if (0.5f * v_dot(d, v_add(n, r->n)) < -BEHIND * r->radius)
        return INFINITY;
    return v_len(d) / r->radius + sqrtf(f_max(0.0f, 1.0f - v_dot(n, r->n)));    /* [Ward88] */
}

double reach_weight(const Reach *r, V3 p, V3 n, float a)
{
    float e = reach_error(r, p, n);

    if (!(e < a))
        return 0.0;
    return 1.0 / d_max(e, 1e-4 * (double)a) - 1.0 / (double)a;  /* the same place: all of it */
}

/* ---- many ---- */

bool reaches_init(Reaches *s, Box around, float a)
{
    memset(s, 0, sizeof *s);
    s->a = a;
    return balltree_init(&s->tree, around);
}

void reaches_clear(Reaches *s)
{
    balltree_clear(&s->tree);
    mem_free(s->at);
    memset(s, 0, sizeof *s);
}

/* The balls of neighbours that shrink stay as large as they were: whoever asks sees by itself. */
static void clamp_neighbours(Reaches *s, Reach *r)
{
    for (int way = 0; way < 2; way++) {         /* first the record by them, then they by it */
        BallWalk walk = balltree_ask(&s->tree, r->p);
        uint32_t id;
        while (balltree_next(&walk, &id)) {
            Reach *other = &s->at[id], *by = way ? r : other, *it = way ? other : r;
            float most = by->radius + v_len(v_sub(r->p, other->p));
            if (reach_error(other, r->p, r->n) < s->a && most < it->radius)
                it->radius = f_max(most, it->least);
        }
    }
}

bool reaches_insert(Reaches *s, const Reach *r)
{
    Reach in = *r;

    clamp_neighbours(s, &in);
    return MEM_PUSH(s->at, s->n, s->cap, in) &&
           balltree_add(&s->tree, in.p, in.radius * s->a, (uint32_t)(s->n - 1));
}
