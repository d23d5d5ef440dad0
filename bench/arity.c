/* arity.c -- what the document finds on children a node and triangles a leaf. */
#include "bench/bench.h"
#include "bench/models.h"

#include <stdio.h>

#define MOST 1200000            /* triangles: more would tell the same */

/* Rows, each compared with another. */
enum { ARITY_2, ARITY_4, ARITY_8, LEAF_4, LEAF_8, BVH_1, BVH_4, BVH_8, ROWS };
static const struct { const char *config; int with; } rows[ROWS] = {
    { "lbvh:bits=16,leaf=1,arity=2", ARITY_2 }, { "lbvh:bits=16,leaf=1,arity=4", ARITY_2 },
    { "lbvh:bits=16,leaf=1,arity=8", ARITY_2 }, { "lbvh:bits=16,leaf=4,arity=4", ARITY_4 },
    { "lbvh:bits=16,leaf=8,arity=4", ARITY_4 }, { "bvh:split=median,leaf=1", BVH_1 },
    { "bvh:split=median,leaf=4", BVH_1 },       { "bvh:split=median,leaf=8", BVH_1 },
};

static double percent(double v, double of) { return 100 * (v / of - 1); }

static void print_row(const PrimaryCost *cost, int i, double tris)
{
    const PrimaryCost *c = &cost[i], *with = &cost[rows[i].with];
    char n[32];

    printf("  %-30s%11s%9.2f%8.1f%8.1f%10.4f", rows[i].config, with_commas(n, c->nodes),
           (double)c->bytes / tris, c->boxes, c->tests, c->seconds);
    if (rows[i].with == i)
        printf("%9s%8s\n", "-", "-");
    else
        printf("%+8.1f%%%+7.1f%%\n", percent((double)c->bytes, (double)with->bytes),
               percent(c->seconds, with->seconds));
}

/* Beside each other: what the document says, and the rows above. */
static void print_findings(const PrimaryCost *c)
{
    double two = (double)c[ARITY_2].bytes;

    printf("  four children for two:       text -33.3 %% of memory, time  +1.5 %%; "
           "ours %+.1f %%, %+.1f %%\n", percent((double)c[ARITY_4].bytes, two),
           percent(c[ARITY_4].seconds, c[ARITY_2].seconds));
    printf("  eight for four:              text  -9.5 %% of memory, time   +14 %%; "
           "ours %+.1f %%, %+.1f %%\n",
           100 * ((double)c[ARITY_8].bytes - (double)c[ARITY_4].bytes) / two,
           percent(c[ARITY_8].seconds, c[ARITY_4].seconds));
    printf("  4 and 8 triangles a leaf:    text time +10 %% and +30 %%; ours %+.1f %% and %+.1f %%, "
           "BVH %+.1f %% and %+.1f %%\n",
           percent(c[LEAF_4].seconds, c[ARITY_4].seconds),
           percent(c[LEAF_8].seconds, c[ARITY_4].seconds),
           percent(c[BVH_4].seconds, c[BVH_1].seconds),
           percent(c[BVH_8].seconds, c[BVH_1].seconds));
}

static void measure(const Model *m)
{
    PrimaryCost cost[ROWS];
    RaySet primary;
    CastScene c;
    char n[32];
    bool ok = true;

    if (!m->tris || !cast_init(&c, m->scene, m->name))
        return;
    if (primary_rays(&c, &primary)) {
        for (int i = 0; ok && i < ROWS; i++)
            ok = cast_primary(&c, rows[i].config, &primary, &cost[i]);
        if (ok) {
            printf("\n%s, %s triangles\n", m->name, with_commas(n, m->tris));
            for (int i = 0; i < ROWS; i++)
                print_row(cost, i, (double)m->tris);
            print_findings(cost);
            fflush(stdout);
        }
        rayset_clear(&primary);
    }
    cast_clear(&c);
}

void bench_arity(void)
{
    printf("\nSections 3.3.1 and 3.4.3: children a node, triangles a leaf; the rays of table 3.2\n\n"
           "  %-30s%11s%9s%8s%8s%10s%9s%8s\n", "", "", "bytes a", "boxes", "tests", "", "memory",
           "time");
    printf("  %-30s%11s%9s%8s%8s%10s%17s\n", "structure", "nodes", "triangle", "a ray", "a ray",
           "seconds", "to the first");
    models_each(MOST, measure);
    printf("\n"
"Memory of eight children for four is told in parts of that of two, as in the document. It also says\n"
"that triangle tests take 4, 18 and 37 %% of the time with 1, 4 and 8 triangles a leaf; here the tests\n"
"are counted. Time falls with four children for two, where the document's rises: they are tested at\n"
"once, in lanes, for about the price of two.\n");
}
