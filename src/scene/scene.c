/* scene.c -- the scene as a whole: adding, finishing, framing. See scene.h. */
#include "scene/scene.h"

#include "base/file.h"

#include <string.h>

/* Material 0: what a shape without one has. */
static bool add_neutral(Scene *s)
{
    const BsdfKind *kind = kind_find(bsdfs, "diffuse");
    Material m;
    Opts o;

    opts_default(&o, kind->info.options);
    if (!material_init(&m, kind, &o, NULL))
        return false;
    m.name = "neutral";
    return scene_add_material(s, &m, NULL);
}

Scene *scene_new(void)
{
    Scene *s = MEM_NEW(Scene);
    if (!s)
        return NULL;
    s->around = NO_MEDIUM;
    s->times[1] = 1;
    if (!scene_add_geometry(s, NULL) || !add_neutral(s)) {
        scene_free(s);
        return NULL;
    }
    return s;
}

void scene_drop_accels(Scene *s)
{
    for (size_t i = 0; s->accels && i < s->ngeometries; i++)
        accel_free(s->accels[i]);
    mem_free(s->accels);
    s->accels = NULL;
    s->accel = NULL;
}

void scene_free(Scene *s)
{
    if (!s)
        return;
    for (size_t i = 0; i < s->nlights; i++)
        if (s->lights[i]->kind->clear)
            s->lights[i]->kind->clear(s->lights[i]);
    scene_drop_accels(s);
    for (size_t i = 0; i < s->ngeometries; i++)
        geometry_clear(&s->geometries[i]);
    for (size_t i = 0; i < s->nimages; i++) {
        pyramid_clear(&s->images[i]->pyramid);
        image_clear(&s->images[i]->image);
        mem_free(s->images[i]);
    }
    mem_free(s->geometries);
    for (size_t i = 0; i < s->nmaterials; i++)
        material_clear(&s->materials[i]);
    mem_free(s->materials);
    mem_free(s->lights);
    mem_free(s->media);
    mem_free(s->infinite);
    mem_free(s->images);
    arena_clear(&s->arena);
    mem_free(s);
}

bool scene_add_geometry(Scene *s, uint32_t *index)
{
    Geometry empty;
    memset(&empty, 0, sizeof empty);
    if (!MEM_PUSH(s->geometries, s->ngeometries, s->cap_geometries, empty))
        return false;
    if (index)
        *index = (uint32_t)s->ngeometries - 1;
    return true;
}

bool scene_add_material(Scene *s, const Material *m, uint32_t *index)
{
    if (!MEM_PUSH(s->materials, s->nmaterials, s->cap_materials, *m))
        return false;
    if (index)
        *index = (uint32_t)s->nmaterials - 1;
    return true;
}

bool scene_add_medium(Scene *s, const Medium *m, uint32_t *index)
{
    if (!MEM_PUSH(s->media, s->nmedia, s->cap_media, *m))
        return false;
    if (index)
        *index = (uint32_t)s->nmedia - 1;
    return true;
}

bool scene_add_light(Scene *s, Light *l, uint32_t *index)
{
    l->index = (uint32_t)s->nlights;
    if (!MEM_PUSH(s->lights, s->nlights, s->cap_lights, l)) {
        if (l->kind->clear)
            l->kind->clear(l);
        return false;
    }
    if (index)
        *index = l->index;
    return true;
}

const Image *scene_image(Scene *s, const Making *m, const char *name)
{
    return scene_image_as(s, m, name, ENCODING_BY_FILE);
}

const Image *scene_image_as(Scene *s, const Making *m, const char *name, Encoding encoding)
{
    char *path = path_beside(m->at.file, name);
    SceneImage *im;

    if (!path)
        return NULL;
    for (size_t i = 0; i < s->nimages; i++)
        if (!strcmp(s->images[i]->path, path) && s->images[i]->encoding == encoding) {
            mem_free(path);
            return &s->images[i]->image;
        }
    im = MEM_NEW(SceneImage);
    if (!im || !(im->path = arena_string(&s->arena, path, strlen(path))) ||
        !image_read_as(&im->image, im->path, m->max_pixels, encoding) ||
        !MEM_PUSH(s->images, s->nimages, s->cap_images, im)) {
        if (im)
            image_clear(&im->image);
        mem_free(im);
        mem_free(path);
        return NULL;
    }
    im->encoding = encoding;
    mem_free(path);
    return &im->image;
}

const Pyramid *scene_pyramid(Scene *s, const Image *of)
{
    size_t i = 0;

    while (&s->images[i]->image != of)
        i++;
    if (!s->images[i]->pyramid.base && !pyramid_init(&s->images[i]->pyramid, of))
        return NULL;
    return &s->images[i]->pyramid;
}

/* ---- finishing ---- */

static Box bounds_of(const Geometry *g)
{
    Box b = box_empty();
    for (uint32_t i = 0; i < geometry_prims(g); i++)
        b = box_join(b, geometry_box(g, i));
    return b;
}

static bool build_geometry(Scene *s, size_t k, const AccelKind *kind, const Opts *o, int threads)
{
    Geometry *g = &s->geometries[k];

    if (!geometry_finish(g))
        return false;
    for (size_t i = 0; i < g->nshapes; i++) {
        Instance *in = g->shapes[i].as.instance;
        g->shapes[i].plain = !s->materials[g->shapes[i].material].looks_at_uv &&
                             !(g->shapes[i].light != NO_LIGHT &&
                               s->lights[g->shapes[i].light]->textured);
        s->see_through |= s->materials[g->shapes[i].material].opacity != NULL;
        if (g->shapes[i].kind != SHAPE_INSTANCE)
            continue;
        ASSERT(s->accels[in->child] != NULL);
        in->accel = s->accels[in->child];
        in->bounds = instance_box(in, bounds_of(in->accel->geo));
    }
    s->accels[k] = accel_build(kind, g, o, threads);
    return s->accels[k] != NULL;
}

/* The world's sphere: of its box; a scene without shapes gets one of radius 1, so that powers of
 * infinite lights are not 0. */
static void set_bounds(Scene *s)
{
    s->bounds = bounds_of(&s->geometries[0]);
    s->centre = v_all(0.0f);
    s->radius = 1.0f;
    if (!box_is_empty(s->bounds)) {
        s->centre = box_centre(s->bounds);
        s->radius = v_len(v_sub(s->bounds.hi, s->centre));
    }
}

static bool prepare_lights(Scene *s)
{
    s->infinite = MEM_ARRAY(const Light *, s->nlights);
    if (!s->infinite)
        return false;
    for (size_t i = 0; i < s->nlights; i++) {
        Light *l = s->lights[i];
        if (l->kind->prepare && !l->kind->prepare(l, s))
            return false;
        if (l->kind->infinite)
            s->infinite[s->ninfinite++] = l;
    }
    return true;
}

static bool anything_moves(const Scene *s)
{
    const Geometry *world = &s->geometries[0];

    for (size_t k = 0; k < world->nodd; k++) {
        const Shape *shape = &world->shapes[world->odd[k]];
        if (shape->kind == SHAPE_INSTANCE && shape->as.instance->motion)
            return true;
    }
    return s->camera && s->camera->motion;
}

float scene_time(const Scene *s, float u)
{
    const double *open = s->camera->shutter, *whole = s->times;
    double t = (open[0] + u * (open[1] - open[0]) - whole[0]) / (whole[1] - whole[0]);

    return clamp01((float)t);
}

bool scene_blurs(const Scene *s)
{
    return s->moves && scene_time(s, 0.0f) != scene_time(s, 1.0f);
}

/* Objects before the world: an object can hold instances only of objects that came before it. */
bool scene_build_accels(Scene *s, const AccelKind *kind, const Opts *o, int threads)
{
    scene_drop_accels(s);
    for (size_t i = 0; i < s->nmaterials; i++)
        material_settle(s->materials, (uint32_t)i);
    s->accels = MEM_ARRAY(Accel *, s->ngeometries);
    if (!s->accels)
        return false;
    for (size_t k = 1; k < s->ngeometries; k++)
        if (!build_geometry(s, k, kind, o, threads))
            return false;
    if (!build_geometry(s, 0, kind, o, threads))
        return false;
    s->accel = s->accels[0];
    return true;
}

bool scene_build(Scene *s, const AccelKind *kind, const Opts *o, int threads)
{
    if (!scene_build_accels(s, kind, o, threads))
        return false;
    set_bounds(s);
    s->moves = anything_moves(s);
    return prepare_lights(s);
}

/* ---- framing a bare mesh ---- */

/* Where the eye stands, seen from the middle of the mesh: before it, a little to the right and
 * above (y is up, as in the scanned meshes that people have). */
static const V3 EYE = { 0.35f, 0.3f, 0.89f };
#define FRAME_FOV 30.0              /* degrees: a short telephoto, little distortion */

bool scene_frame_camera(Scene *s)
{
    const CameraKind *kind = kind_find(cameras, "perspective");
    Transform view;
    Making m;
    Opts o;
    float dist;

    if (!geometry_finish(&s->geometries[0]))
        return false;
    set_bounds(s);
    dist = s->radius / (float)md_sin(FRAME_FOV / 2 * PI / 180);
    if (!xf_look_at(&view, v_mad(v_unit(EYE), dist, s->centre), s->centre, v3(0, 1, 0)))
        view = xf_identity();       /* a mesh without extent, or beyond the range of floats */
    memset(&m, 0, sizeof m);
    m.scene = s;
    m.to_world = xf_inverse(&view);
    opts_default(&o, kind->info.options);
    opt_set_number(&o, "fov", FRAME_FOV);
    s->camera = kind->make(&m, &o);
    if (s->camera)
        s->camera->kind = kind;
    return s->camera != NULL;
}

bool scene_frame(Scene *s)
{
    Making m;
    Light *sky;

    memset(&m, 0, sizeof m);
    m.scene = s;
    m.to_world = xf_rotate(-90, 1, 0, 0);       /* the sky's pole is z; here up is y */
    sky = scene_frame_camera(s) ? light_studio(&m) : NULL;
    if (!sky)
        return false;
    sky->kind = kind_find(lights, "infinite");
    return scene_add_light(s, sky, NULL);
}
