/* virtualcuts.c -- see virtualcuts.h. */
#include "integrators/virtualcuts.h"

#include "base/mem.h"

void virtualcuts_init(VirtualCuts *it, const VirtualLights *l, float tolerance, size_t most)
{
    memset(it, 0, sizeof *it);
    it->lights = l;
    it->tolerance = tolerance;
    it->most = most;
}

void virtualcuts_clear(VirtualCuts *it)
{
    mem_free(it->matt);
    mem_free(it->which);
    mem_free(it->order);
    mem_free(it->node);
    mem_free(it->tree);
    mem_free(it->trees);
    mem_free(it->other);
    mem_free(it->others);
    memset(it, 0, sizeof *it);
}

/* ---- phases ---- */

static bool take_room(VirtualCuts *it)
{
    size_t n = it->lights->n, sets = it->lights->sets;

    it->matt = MEM_ARRAY(OrientedLight, n);
    it->which = MEM_ARRAY(uint32_t, n);
    it->order = MEM_ARRAY(uint32_t, n);
    it->node = MEM_ARRAY(Cluster, 2 * n);
    it->tree = MEM_ARRAY(VirtualTree, n);
    it->other = MEM_ARRAY(uint32_t, n);
    it->trees = MEM_ARRAY(uint32_t, sets + 1);
    it->others = MEM_ARRAY(uint32_t, sets + 1);
    return it->matt && it->which && it->order && it->node && it->tree && it->other && it->trees &&
           it->others;
}

/* Light i goes into the last tree, or into a new one. */
static void sort_in(VirtualCuts *it, uint32_t i, bool first, uint32_t *nmatt, uint32_t *ntrees,
                    uint32_t *nother)
{
    const VirtualLight *l = &it->lights->light[i];
    VirtualTree *tree;

    if (!(rgb_lum(l->power) > 0.0f))
        return;
    if (l->kind != VIRTUAL_MATT) {
        it->other[(*nother)++] = i;
        return;
    }
    if (first || it->tree[*ntrees - 1].depth != l->depth)
        it->tree[(*ntrees)++] = (VirtualTree){ *nmatt, 0, l->depth };
    tree = &it->tree[*ntrees - 1];
    tree->n++;
    it->which[*nmatt] = i;
    it->matt[(*nmatt)++] = (OrientedLight){ l->p, l->n, rgb_lum(l->power), l->two_sided };
}

static bool make_room(VirtualCuts *it)
{
    uint32_t nmatt = 0, ntrees = 0, nother = 0;

    if (!take_room(it))
        return false;
    for (uint32_t set = 0; set < it->lights->sets; set++) {
        const LightRun *run = &it->lights->set[set];
        it->trees[set] = ntrees;
        it->others[set] = nother;
        for (size_t i = run->first; i < run->first + run->n; i++)
            sort_in(it, (uint32_t)i, ntrees == it->trees[set], &nmatt, &ntrees, &nother);
    }
    it->trees[it->lights->sets] = ntrees;
    it->others[it->lights->sets] = nother;
    return true;
}

uint64_t virtualcuts_units(const VirtualCuts *it, int phase)
{
    if (!(it->tolerance > 0.0f))
        return 0;
    return phase == 0 ? 1 : it->trees[it->lights->sets];
}

bool virtualcuts_run(VirtualCuts *it, int phase, uint64_t unit)
{
    const VirtualTree *tree;

    if (phase == 0)
        return make_room(it);
    tree = &it->tree[unit];
    clusters_build(it->node + 2 * (size_t)tree->first, it->order + tree->first,
                   it->matt + tree->first, tree->n, it->lights->scene->radius, unit);
    return true;
}

/* ---- cutting ---- */

/* Trees that are not too deep: they come first. Numbers of lights are those within their tree. */
typedef struct { const VirtualCuts *it; const VirtualTree *tree; CutAsk *q; } Within;

static Rgb ask_within(void *ctx, uint32_t root, uint32_t light)
{
    const Within *w = ctx;
    return w->q->ask(w->q->ctx, root, w->it->which[w->tree[root].first + light]);
}

size_t virtualcut(const VirtualCuts *it, const Vertex *v, uint32_t set, int depth, float bound,
                  CutAsk *q, CutCluster cut[CLUSTERS_MOST])
{
    const Cluster *root[CLUSTERS_MOST];
    const VirtualTree *tree = it->tree + it->trees[set];
    uint32_t n = it->trees[set + 1] - it->trees[set];
    Within w = { it, tree, q };
    CutAsk inner = *q;
    size_t nroots = 0;

    while (nroots < n && nroots < it->most && (int64_t)tree[nroots].depth <= depth) {
        root[nroots] = it->node + 2 * (size_t)tree[nroots].first;
        nroots++;
    }
    inner.at.p = v->s.p;
    inner.at.n = v->wo.z < 0.0f ? v_neg(v->frame.n) : v->frame.n;
    inner.at.most = bound > 0.0f && fabsf(v_dot(v->frame.n, v->s.ng)) > 1.0f - 1e-6f
                        ? 1.001f * bound : INFINITY;
    inner.f = rgb_max(v->b->kind->eval(v->b, v->wo, v->wo, false));
    inner.tolerance = it->tolerance;
    inner.most = it->most;
    inner.ask = ask_within;
    inner.ctx = &w;
    return inner.f > 0.0f ? clusters_cut(root, nroots, &inner, cut) : 0;
}
