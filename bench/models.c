/* models.c -- the scenes of the tables. See models.h. */
#include "bench/models.h"

#include "base/text.h"
#include "geometry/generate.h"
#include "scenefile/scenefile.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRONT = 13, WHAT = 13 };
#define FULL_LEAST 10000000     /* triangles of what is large: minutes, and 6.3 GB while built */

/* ---- made by rule ---- */

/* Normals and texture coordinates, as the document's triangles have them. */
static bool dress(Mesh *m)
{
    m->n = MEM_ARRAY(V3, m->nverts);
    m->uv = MEM_ARRAY(V2, m->nverts);
    if (!m->n || !m->uv)
        return false;
    for (uint32_t i = 0; i < m->ntris; i++) {
        const uint32_t *v = m->tri[i].v;
        V3 a = m->p[v[0]], n = v_cross(v_sub(m->p[v[1]], a), v_sub(m->p[v[2]], a));
        for (int k = 0; k < 3; k++)
            m->n[v[k]] = v_add(m->n[v[k]], n);
    }
    for (uint32_t i = 0; i < m->nverts; i++) {
        m->n[i] = v_unit(m->n[i]);
        m->uv[i] = (V2){ m->p[i].x, m->p[i].y };
    }
    return true;
}

/* Bodies in rows of nine, on a slope so that none hides the others. */
static bool make(Scene *scene, const PrintedScene *s)
{
    ShapeTraits traits = { 0, NO_LIGHT, false };

    for (uint32_t i = 0; i < s->meshes; i++) {
        V3 place = v3(2.7f * (float)(i % 9), 1.5f * (float)(i / 9), -2.7f * (float)(i / 9));
        Mesh m;
        bool ok;
        if (!mesh_bumpy_of(&m, s->triangles, i + (uint64_t)1))
            return false;
        for (uint32_t k = 0; k < m.nverts; k++)
            m.p[k] = v_add(m.p[k], place);
        ok = dress(&m) && geometry_add_mesh(&scene->geometries[0], &m, traits, NULL);
        mesh_clear(&m);
        if (!ok)
            return false;
    }
    return true;
}

/* Several meshes were put into arrays with room for more: a copy has none, and tells the size. */
static bool settle(Model *m)
{
    Geometry *g = &m->scene->geometries[0], copy;
    size_t before = mem_bytes();

    if (!geometry_finish(g) || !geometry_copy(&copy, g))
        return false;
    m->bytes = mem_bytes() - before;
    m->tris = g->ntris;
    geometry_clear(g);
    *g = copy;
    return true;
}

/* Case does not count. */
static bool is_word(const char *s, size_t n, const char *word)
{
    return word_is_nocase((Word){ s, n }, word);
}

/* Whether the scene is to be made: large ones are only if they are asked for. */
static bool is_wanted(const PrintedScene *s, uint64_t tris, uint64_t most)
{
    const char *only = getenv("MODEL");
    char n[32];

    if (tris > most)
        return false;
    if (only && *only)
        return is_word(s->name, strlen(s->name), only);
    if (tris < FULL_LEAST || getenv("FULL"))
        return true;
    printf("\n%s, %s triangles, is left out: FULL=1 in the environment asks for it\n", s->name,
           with_commas(n, tris));
    return false;
}

static void each_made(uint64_t most, void (*f)(const Model *m))
{
    for (int i = 0; i < PRINTED_SCENES; i++) {
        const PrintedScene *s = &printed_scenes[i];
        uint64_t tris = (uint64_t)s->meshes * s->triangles;
        Model m = { s->name, s, NULL, 0, 0 };
        if (!is_wanted(s, tris, most))
            continue;
        m.scene = scene_new();
        if (m.scene && make(m.scene, s) && settle(&m))
            f(&m);
        scene_free(m.scene);
    }
}

/* ---- the user's ---- */

static bool is_stem(const char *name, const char *word)
{
    return is_word(name, strlen(name) - strlen(path_extension(name)) - 1, word);
}

static const PrintedScene *scene_named(const char *file)
{
    for (int i = 0; i < PRINTED_SCENES; i++)
        if (is_stem(file, printed_scenes[i].name) || is_stem(file, printed_scenes[i].files))
            return &printed_scenes[i];
    return NULL;
}

static void read_one(const char *folder, const char *name, void (*f)(const Model *m))
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    Model m = { name, scene_named(name), NULL, 0, 0 };
    size_t room = strlen(folder) + strlen(name) + 2;
    char *path = mem_array(room, 1);
    SceneFile file;

    if (!path)
        return;
    snprintf(path, room, "%s/%s", folder, name);
    if (scenefile_read(&file, path, &limits)) {
        m.scene = file.scene;
        if (settle(&m))
            f(&m);
        scenefile_clear(&file);
    }
    mem_free(path);
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool is_mesh(const char *name)
{
    const char *ext = path_extension(name);
    return is_word(ext, strlen(ext), "ply") || is_word(ext, strlen(ext), "obj");
}

static void each_file(const char *folder, void (*f)(const Model *m))
{
    DIR *dir = opendir(folder);
    struct dirent *entry;
    char **names = NULL;
    size_t n = 0, cap = 0;

    if (!dir) {
        err_at((Place){ folder, 0, 0 }, "this folder cannot be read");
        return;
    }
    while ((entry = readdir(dir)) != NULL)
        if (is_mesh(entry->d_name)) {
            char *name = mem_string(entry->d_name, strlen(entry->d_name));
            if (!name || !MEM_PUSH(names, n, cap, name))
                mem_free(name);
        }
    closedir(dir);
    if (n)
        qsort(names, n, sizeof *names, by_name);
    else
        err_at((Place){ folder, 0, 0 }, "this folder has no .ply and no .obj files");
    for (size_t i = 0; i < n; i++) {
        read_one(folder, names[i], f);
        mem_free(names[i]);
    }
    mem_free(names);
}

void models_each(uint64_t most, void (*f)(const Model *m))
{
    const char *folder = getenv("MODELS");

    if (folder && *folder)
        each_file(folder, f);
    else
        each_made(most, f);
}

CastConfig config_of(const char *text, Arena *arena)
{
    CastConfig c;

    memset(&c, 0, sizeof c);
    c.text = text;
    c.kind = kind_from_text(accels, "accelerator", text, &c.opts, arena);
    ASSERT(c.kind);
    return c;
}

/* ---- what the tables have in common ---- */

const Structure *table_column(int i)
{
    static const Structure ours[COLUMNS - PRINTED] = {
        { "short/4", "lbvh:bits=16,leaf=4" }, { "hlbvh/4", "hlbvh:leaf=4" },
        { "kdtree", "kdtree" }, { "wide", "wide:form=lean" },
    };
    return i < PRINTED ? &printed_structures[i] : &ours[i - PRINTED];
}

void table_head(const char *first)
{
    line_head("", "");
    printf("%s", first);
    for (int i = 0; i < COLUMNS; i++)
        printf("%7s ", table_column(i)->name);
    printf("\n");
}

void line_head(const char *front, const char *what)
{
    printf("%-*s%-*s", FRONT, front, WHAT, what);
}

const char *with_commas(char out[32], uint64_t n)
{
    char plain[24];
    int digits = snprintf(plain, sizeof plain, "%lu", (unsigned long)n), k = 0;

    for (int i = 0; i < digits; i++) {
        if (i && (digits - i) % 3 == 0)
            out[k++] = ',';
        out[k++] = plain[i];
    }
    out[k] = 0;
    return out;
}

void cell(double v, int digits, bool known, char mark)
{
    if (known)
        printf("%7.*f%c", digits, v, mark);
    else
        printf("%7s ", "-");
}
