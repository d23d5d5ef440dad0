/* centre.c -- the code of `centre.h`
 *
 * Facets come from the light's own `emit`, so any light that has a surface will do: GRID x GRID
 * places, each of which stands for a part of the area. Where the light looks the same everywhere,
 * those with one normal are one facet, so a flat lamp has one. */
#include "integrators/centre.h"

#include <string.h>

enum { GRID = 8, FINE = 16 };           /* for the facets, for the centre */

/* Place k of n x n, seen by a particle that leaves along the normal or nearly so. */
static bool place(const Light *l, int k, int n, Emission *e)
{
    V2 u = { ((float)(k % n) + 0.5f) / (float)n, ((float)(k / n) + 0.5f) / (float)n };
    return l->kind->emit(l, u, (V2){ 0.25f, 0.5f }, e) && e->pdf_a > 0.0f;
}

/* Where the light comes from on the mean. */
static V3 centre_of(const Light *l)
{
    double sum[3] = { 0, 0, 0 }, total = 0;

    for (int k = 0; k < FINE * FINE; k++) {
        Emission e;
        double w;
        if (!place(l, k, FINE, &e))
            continue;
        w = rgb_lum(e.L) / e.pdf_a;
        sum[0] += w * e.p.x;
        sum[1] += w * e.p.y;
        sum[2] += w * e.p.z;
        total += w;
    }
    if (!(total > 0))
        return v_all(0.0f);
    return v3((float)(sum[0] / total), (float)(sum[1] / total), (float)(sum[2] / total));
}

static bool same_facet(const Light *l, const Facet *f, const Emission *e)
{
    return !l->textured && v_len2(v_sub(f->at.ng, e->n)) < 1e-8f;
}

/* Adds the lamp's facets to those that there are. What a mask leaves of the light is less area.
 * False: memory, reported. */
static bool add_facets(Centres *c, Centre *to)
{
    const Light *l = to->light;

    for (int k = 0; k < GRID * GRID; k++) {
        size_t i = to->first;
        Facet f = { .area = 0.0f };
        Emission e;
        float all;
        if (!place(l, k, GRID, &e))
            continue;
        f.at = surface_at(e.p, e.err, e.n, e.uv);
        all = rgb_lum(l->kind->radiance(l, v_neg(e.d), &f.at));
        if (!(all > 0.0f))
            continue;
        while (i < c->nfacets && !same_facet(l, &c->facet[i], &e))
            i++;
        if (i == c->nfacets && !MEM_PUSH(c->facet, c->nfacets, c->cap_facets, f))
            return false;
        c->facet[i].area += rgb_lum(e.L) / all / (e.pdf_a * (float)(GRID * GRID));
    }
    to->n = c->nfacets - to->first;
    return true;
}

bool centres_init(Centres *c, const Scene *s)
{
    memset(c, 0, sizeof *c);
    c->centre = MEM_ARRAY(Centre, s->nlights);
    if (!c->centre)
        return false;
    for (size_t i = 0; i < s->nlights; i++) {
        const Light *l = s->lights[i];
        Centre one = { l, { 0, 0, 0 }, c->nfacets, 0 };
        bool point = l->kind->delta != DELTA_NONE;
        if (l->kind->infinite || !(rgb_max(l->kind->power(l)) > 0.0f))
            continue;
        if (!point) {
            one.p = centre_of(l);
            if (!add_facets(c, &one)) {
                centres_clear(c);
                return false;
            }
        }
        if (point || one.n)
            c->centre[c->n++] = one;
    }
    return true;
}

void centres_clear(Centres *c)
{
    mem_free(c->centre);
    mem_free(c->facet);
    memset(c, 0, sizeof *c);
}

/* wi: from outside towards the lamp. */
static Rgb intensity(const Centres *c, const Centre *of, V3 wi)
{
    Rgb sum = rgb_all(0.0f);

    for (size_t i = of->first; i < of->first + of->n; i++) {
        const Facet *f = &c->facet[i];
        Rgb L = of->light->kind->radiance(of->light, wi, &f->at);
        sum = rgb_add(sum, rgb_scale(L, f->area * v_absdot(f->at.ng, wi)));
    }
    return sum;
}

bool centre_shines(const Centres *c, size_t i, V3 from, LightSample *s)
{
    const Centre *of = &c->centre[i];
    float d2;

    if (!of->n)
        return of->light->kind->sample(of->light, from, (V2){ 0.5f, 0.5f }, s);
    d2 = sample_at_point(of->p, from, s);
    if (!(d2 > 0.0f))
        return false;
    s->L = rgb_scale(intensity(c, of, s->wi), 1.0f / d2);
    return !rgb_black(s->L);
}

/* A lamp does not stand in its own light: a ray that meets it on the way to its centre has arrived
 * there, so that nothing behind its front matters. */
bool centre_arrives(const Centres *c, size_t i, const Vertex *v, const LightSample *s,
                    uint32_t medium, Tracer *t, Rgb *left)
{
    const Centre *of = &c->centre[i];
    Ray r = shadow_ray(&v->s, s);
    Surface at;
    Hit h;

    if (of->n && tracer_nearest(t, &r, &h)) {
        accel_surface(t->scene->accel, &r, &h, &at);
        if (scene_light_of(t->scene, &at) != of->light)
            return false;
        r.tmax = h.t * SHADOW_TMAX;
    } else if (of->n && !t->scene->nmedia)
        return true;
    return tracer_passes(t, &r, medium, left);
}
