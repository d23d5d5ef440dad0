/* rays.c -- loading, building and casting. */
#include "base/file.h"
#include "bench/bench.h"
#include "geometry/generate.h"
#include "geometry/meshfile.h"
#include "render/cast.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { SUBDIVISIONS = 224, RUNS = 5 };

/* 20 * 224^2: 1,003,520 triangles of a bumpy closed body. */
static bool make_mesh(Mesh *m)
{
    memset(m, 0, sizeof *m);
    return mesh_bumpy(m, SUBDIVISIONS, 7);
}

void bench_load(void)
{
    char name[64];
    ReadLimits limits = READ_LIMITS_DEFAULT;
    const AccelKind *kind = kind_find(accels, ACCEL_DEFAULT);
    double read[RUNS], built[RUNS];
    SceneFile f;
    Mesh m;
    Opts o;

    snprintf(name, sizeof name, "/tmp/rushlight-bench-%ld.ply", (long)getpid());
    if (!make_mesh(&m) || !ply_write(&m, name))
        return;
    mesh_clear(&m);
    opts_default(&o, kind->info.options);
    for (int i = 0; i < RUNS; i++) {
        double start = clock_wall();
        if (!scenefile_read(&f, name, &limits))
            break;
        read[i] = clock_wall() - start;
        if (!scene_build(f.scene, kind, &o, processors()))
            break;
        built[i] = clock_wall() - start - read[i];
        if (i == RUNS - 1)
            printf("load\tmillion-triangles\tread s %.3f\tbuild s %.3f\tbytes a triangle %.1f\n",
                   median(read, RUNS), median(built, RUNS),
                   (double)f.scene->accel->bytes / geometry_prims(f.scene->accel->geo));
        scenefile_clear(&f);
    }
    unlink(name);
}

/* ---- rays ---- */

static void print(const CastConfig *config, const CastScene *c, const CastRow *row,
                  const RaySet *sets)
{
    for (int k = 0; k < RAYS_KINDS; k++)
        printf("rays\t%s\t%s\tMrays/s: single %.2f, in batches %.2f\tnodes %.1f\tprims %.1f\t"
               "bytes a triangle %.1f\tbuild s %.3f\n", config->text, sets[k].kind,
               row->sets[k].single, row->sets[k].batch, row->sets[k].nodes, row->sets[k].prims,
               (double)row->bytes / (double)c->prims, row->build_all);
}

static void cast(CastScene *c)
{
    const RayRules rules = { .w = 512, .h = 512, .ao = 0.1f, .seed = 1 };
    const CastOrder order = { processors(), RUNS, 256 };
    RaySet sets[RAYS_KINDS];
    CastConfig config = cast_default();
    CastRow row;
    bool ok, differs;

    if (!cast_build(c, &config, order.threads) || !rays_make(c->scene, &rules, sets))
        return;
    ok = cast_reference(c, sets, RAYS_KINDS, &differs);
    if (differs)
        printf("rays\t%s\tWRONG\n", config.text);
    for (int i = 0; ok && accels[i]; i++) {
        config.kind = accels[i];
        config.text = accels[i]->info.name;
        opts_default(&config.opts, accels[i]->info.options);
        if (!strcmp(config.text, "brute"))
            continue;
        if (cast_measure(c, &config, &order, sets, RAYS_KINDS, &row, &differs))
            print(&config, c, &row, sets);
        else if (differs)
            printf("rays\t%s\tWRONG\n", config.text);
    }
    for (int k = 0; k < RAYS_KINDS; k++)
        rayset_clear(&sets[k]);
}

void bench_rays(void)
{
    ShapeTraits traits = { 0, NO_LIGHT, false };
    Scene *scene = scene_new();
    CastScene c;
    Mesh m;

    if (scene && make_mesh(&m) && geometry_add_mesh(&scene->geometries[0], &m, traits, NULL) &&
        cast_init(&c, scene, "million-triangles")) {
        cast(&c);
        cast_clear(&c);
    }
    scene_free(scene);
}
