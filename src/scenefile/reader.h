/* reader.h -- the reader of the scene language from the inside: what its files share. A Reader
 * lives as long as one scenefile_read. Functions return false after an error was reported (or
 * memory ran out), and the whole reading ends; warnings let it go on. */
#ifndef SCENEFILE_READER_H
#define SCENEFILE_READER_H

#include "geometry/meshfile.h"
#include "scenefile/lexer.h"
#include "scenefile/names.h"
#include "scenefile/scenefile.h"
#include "scenefile/spectrum.h"

enum {
    PARAMS_MAX = 256,           /* parameters of one directive */
    DEFAULTS_MAX = 64,          /* parameters that Attribute may have piled up for one target */
    STACK_MAX = 1024,           /* AttributeBegin, TransformBegin, ObjectBegin, Import */
    TEXTURE_COST_MAX = 256,     /* textures that the evaluation of one may touch */
    INCLUDES_MAX = 16384        /* Include and Import directives that are carried out */
};
#define GENERATED_MAX ((uint64_t)1 << 22)       /* triangles made of curved shapes in one scene */
#define MATERIAL_NONE (UINT32_MAX - 1)          /* surfaces that are left out: "interface" */
#define MEDIUM_LEFT_OUT (NO_MEDIUM - 1)         /* a name of one that is not supported */

/* The parameters of the directive being read. Emptied, not freed, between directives. */
typedef struct { size_t name, type, first; } ParamSpan;
typedef struct {
    Param     *p;               /* owned; pointers in it are set when the list is complete */
    ParamSpan *span;            /* owned; where in the pools the strings and values of p[i] are */
    double    *numbers;         /* owned */
    const char **strings;       /* owned; made when the list is complete */
    uint32_t  *string_at;       /* owned; offsets into text, of strings[] */
    char      *text;            /* owned */
    size_t n, cap, cap_span, nnumbers, cap_numbers, nstrings, cap_strings, cap_at, ntext, cap_text;
} ParamPool;

/* One open file. Both paths are the same text, in the two arenas (the second when first wanted). */
typedef struct {
    const char *path;           /* in the scene's arena: lights and cameras keep places */
    const char *kept;           /* in the SceneFile's arena, or NULL */
    FileBytes   bytes;          /* owned; empty if the text is somebody else's */
    Lexer       lexer;
    size_t      depth;          /* of the stack when it was opened, SAVED_IMPORT included */
    bool        import;
} Source;

/* `Attribute "shape" ...`: newest first. In the SceneFile's arena. */
typedef struct Defaults { Params params; const struct Defaults *next; size_t total; } Defaults;
typedef enum {
    TARGET_SHAPE, TARGET_LIGHT, TARGET_MATERIAL, TARGET_MEDIUM, TARGET_TEXTURE, TARGETS
} Target;

/* The light of the shapes to come. Parameters are in the SceneFile's arena. */
typedef struct { const LightKind *kind; Params params; Place at; } AreaLight;

/* What AttributeBegin saves. */
typedef struct {
    Transform ctm, end;                 /* current transform, when motions begin and end */
    bool      at_start, at_end;         /* ActiveTransform: which of them directives change */
    bool      reverse;                  /* ReverseOrientation */
    uint32_t  material;                 /* index in the scene, or MATERIAL_NONE */
    uint32_t  inside, outside;          /* MediumInterface: indices in the scene, or NO_MEDIUM */
    const AreaLight *area;              /* NULL: shapes do not shine */
    const Defaults *defaults[TARGETS];
    const double (*space)[3];           /* colour space to ours, 3x3; NULL: the same */
} State;

typedef enum { SAVED_ATTRIBUTE, SAVED_TRANSFORM, SAVED_OBJECT, SAVED_IMPORT } SavedKind;
typedef struct { SavedKind kind; State state; Place at; uint64_t block; } Saved;

/* Warnings that are given once a scene. */
typedef enum {
    ONCE_MOTION = 1, ONCE_OBJECT_LIGHT = 2, ONCE_INSIDE_OUT = 4
} Once;

/* block: the innermost that was open, 0 for none. A name whose block has ended is free: version 3
 * forgets it there. */
typedef struct { const Texture *texture; uint32_t cost; uint64_t block; } NamedTexture;

/* A material that was made of another one and a mask. */
typedef struct { uint32_t of, material; const Texture *mask; } Masked;

/* A named coordinate system. */
typedef struct { Transform start, end; } System;

/* A geometry whose shapes move alike: those of the world, or of the object that they are part of,
 * which takes them along wherever it is placed. */
typedef struct { uint32_t object, geometry; Transform start, end; } Mover;

typedef struct {
    SceneFile *out;
    Scene     *scene;           /* borrowed from out */
    const ReadLimits *limits;
    const char *main_path;      /* in the scene's arena */
    Source    *sources;         /* owned; the innermost is last */
    size_t     nsources, cap_sources;
    uint64_t   bytes_read, includes;
    State      state;
    Saved     *stack;           /* owned */
    size_t     nstack, cap_stack;
    uint64_t   nblocks;         /* begun so far */
    bool       world;           /* after WorldBegin */
    bool       camera_seen;
    uint32_t   object;          /* geometry that shapes go to: 0, or that of ObjectBegin */
    unsigned   said;            /* Once bits */
    Names      materials, float_textures, colour_textures, systems, objects, media;
    const Texture *mask;        /* of the shape being read, or NULL */
    Masked    *masked;          /* owned */
    size_t     nmasked, cap_masked;
    uint32_t   unseen;          /* the material of borders of media; 0: not made yet */
    NamedTexture *textures;     /* owned; what the two tables of textures number */
    size_t     ntextures, cap_textures;
    System    *transforms;      /* owned; what the table of systems numbers */
    size_t     ntransforms, cap_transforms;
    Mover     *movers;          /* owned */
    size_t     nmovers, cap_movers;
    ParamPool  pool;
    Cie       *cie;             /* owned; made when first wanted */
    uint64_t   generated;       /* triangles made so far */
    uint64_t   degenerate;      /* triangles dropped, and where the first was */
    Place      degenerate_at;
} Reader;

/* ---- reader.c ---- */

bool reader_init(Reader *r, SceneFile *out, const char *path, const ReadLimits *limits);
void reader_clear(Reader *r);
bool reader_finish(Reader *r);          /* what moves is placed, what was counted is warned of */

/* The next token of the innermost file; END at its end. */
bool reader_next(Reader *r, Token *t);
bool reader_peek(Reader *r, Token *t);
/* Each takes one token of that kind. what: "the name of the material", for messages. */
bool reader_string(Reader *r, const char *what, Token *t);
bool reader_numbers(Reader *r, const char *what, size_t n, double *v);
/* What a string says: in an arena, or in the pool until params_read or the next call. NULL: out of
 * memory, reported. */
char *reader_keep(Arena *arena, const Token *t);
char *reader_text(Reader *r, const Token *t);

bool reader_once(Reader *r, Once what);         /* true the first time */
/* Reads a file, counting its bytes against the limit. at: who wants it, file NULL if the user. */
bool reader_file(Reader *r, Place at, const char *path, FileBytes *f);
/* Where the file called `name` in the scene is: beside the main file, or else beside the file that
 * names it; if it is in neither, the first of these. Owned by the caller. */
char *reader_path(Reader *r, Place at, const char *name);
/* For scene_image and the makers of lights: to_world and the place, with at.file such that `name`
 * (may be NULL) beside it is the file that reader_path finds. False: out of memory, reported. */
bool reader_making(const Reader *r, Place at, const char *name, Making *m);
const Cie *reader_cie(Reader *r);                /* NULL: out of memory, reported */
bool reader_generate(Reader *r, Place at, uint64_t ntriangles);    /* false: too many, reported */

/* ---- params.c, paramuse.c ---- */

/* The parameters that follow; spectra become three numbers. In the pool until the next call. */
bool params_read(Reader *r, SpectrumUse use, Params *out);
bool params_keep(Arena *arena, const Params *ps, const char *file, Params *out);   /* deep copy */
void pool_clear(ParamPool *p);

/* A single string by name; *s is `otherwise` if it is not given. False: not one string. */
bool params_string(const Params *ps, const char *name, const char *otherwise, const char **s);
/* n numbers by name; untouched if not given. False: of the wrong type or count, reported. */
bool params_numbers(const Params *ps, const char *name, size_t n, double *v);
bool params_given(const Params *ps, const char *name);   /* it is there and not 0 */
/* Fits parameters to a table: colours become numbers where the table wants one (room has a row
 * each); parameters that the table has not and that say how to compute, not what, pass silently. */
void params_fit(Params *ps, const OptDef *defs, double (*room)[3]);
/* Appends what Attribute set for this target. list has room for PARAMS_MAX + DEFAULTS_MAX. */
void params_with_defaults(const Reader *r, Target target, const Params *ps, Param *list,
                          Params *out);

/* ---- the directives: each reads what follows its name ---- */

typedef bool (*Directive)(Reader *r, Place at);
bool parser_run(Reader *r);                     /* parser.c: all sources */
bool source_push(Reader *r, const char *path, const char *text, size_t n);      /* borrows both */

bool do_identity(Reader *r, Place at);          /* transforms.c */
bool do_translate(Reader *r, Place at);
bool do_scale(Reader *r, Place at);
bool do_rotate(Reader *r, Place at);
bool do_look_at(Reader *r, Place at);
bool do_transform(Reader *r, Place at);
bool do_concat_transform(Reader *r, Place at);
bool do_coordinate_system(Reader *r, Place at);
bool do_coord_sys_transform(Reader *r, Place at);
bool do_active_transform(Reader *r, Place at);
bool do_transform_times(Reader *r, Place at);
bool system_set(Reader *r, const char *name, const Transform *start, const Transform *end);

bool do_attribute_begin(Reader *r, Place at);   /* attributes.c */
bool do_attribute_end(Reader *r, Place at);
bool do_transform_begin(Reader *r, Place at);
bool do_transform_end(Reader *r, Place at);
bool do_object_begin(Reader *r, Place at);
bool do_object_end(Reader *r, Place at);
bool do_object_instance(Reader *r, Place at);
bool do_attribute(Reader *r, Place at);
bool do_reverse_orientation(Reader *r, Place at);
bool do_color_space(Reader *r, Place at);
bool stack_push(Reader *r, SavedKind kind, Place at);
bool stack_holds(const Reader *r, uint64_t block);      /* it is still open; 0 always is */
bool stack_unwind(Reader *r, size_t depth);     /* warns of each Begin without its End */

bool do_camera(Reader *r, Place at);            /* settings.c */
bool do_film(Reader *r, Place at);
bool do_sampler(Reader *r, Place at);
bool do_pixel_filter(Reader *r, Place at);
bool do_integrator(Reader *r, Place at);
bool do_accelerator(Reader *r, Place at);
bool do_option(Reader *r, Place at);
bool do_volume_integrator(Reader *r, Place at);

bool do_light_source(Reader *r, Place at);      /* lightsources.c */
bool do_area_light_source(Reader *r, Place at);
bool lightsource_shine(Reader *r, const AreaLight *area, uint32_t shape, Place at);

bool do_texture(Reader *r, Place at);           /* textures.c, imagemaps.c */
const Texture *texture_constant(Reader *r, Rgb value);          /* NULL: memory, reported */
const Texture *texture_product(Reader *r, const Texture *a, const Texture *b);  /* likewise */
/* A texture by its name, of either type, the wanted one first. *t NULL: unknown, warned of. */
bool texture_find(Reader *r, Place at, const char *name, bool colour, const Texture **t);
/* A picture as a texture, repeated and bilinear; grey 0.5 with a warning if pictures of that kind
 * cannot be read. */
Texture *texture_image(Reader *r, Place at, const char *name);
Texture *texture_data(Reader *r, Place at, const char *name);   /* numbers as stored: no colours */

bool do_material(Reader *r, Place at);          /* materials.c */
bool do_make_named_material(Reader *r, Place at);
bool do_named_material(Reader *r, Place at);
/* Makes the material `type` of the scene language. */
bool material_make(Reader *r, Place at, const char *type, const Params *ps, const char *name,
                   uint32_t *index);

/* principled.c: a material by what it looks like, as many programs describe one. */
typedef struct {
    const Texture *color, *metallic, *roughness, *spectrans, *clearcoat;        /* none is NULL */
    float eta, anisotropic, gloss;
} Principled;
bool principled_make(Reader *r, Place at, const Principled *p, const char *name, uint32_t *index);
/* The material `disney` of version 3. */
bool disney_make(Reader *r, Place at, const Params *ps, const char *name, uint32_t *index);

/* materialuse.c: which of the model's options has this key; -1: none. */
int material_option(const BsdfKind *kind, const char *key);
/* A texture as what option `key` of the material's model is. */
void material_put(Material *m, const char *key, const Texture *t);
/* A colour, a number or a texture that no table has. *t NULL: not given. False: reported. */
bool material_value(Reader *r, const Params *ps, const char *name, const Texture **t);
/* Two materials side by side: `amount` of the first; of one if the amount says so everywhere. */
bool material_mix(Reader *r, const Texture *amount, uint32_t first, uint32_t second,
                  uint32_t *index);
/* Puts the textures that were given for options in their place. */
bool material_textures(Reader *r, Material *m, const Opts *o);
/* What the language gives this type of material besides, and that the names of it are known. */
bool material_extras(Reader *r, const char *type, const Params *ps, Material *m);
void material_extras_known(const Params *ps, const char *type);

bool do_make_named_medium(Reader *r, Place at); /* surfaces.c */
bool do_medium_interface(Reader *r, Place at);
/* The mask ("alpha") of the shape that is being read, in r->mask; *nowhere: nothing is left. */
bool surface_mask(Reader *r, const Params *ps, bool *nowhere);
/* Whether a shape of this material is neither seen nor separates media nor shines. */
bool surface_left_out(const Reader *r, uint32_t material);
/* The material with the mask on it; that of an unseen border for MATERIAL_NONE. */
bool surface_material(Reader *r, uint32_t material, uint32_t *index);
/* What a shape that was added has besides: media on its sides, light. */
bool surface_finish(Reader *r, const AreaLight *area, uint32_t shape, Place at);

/* ---- movers.c ---- */

bool reader_moves(const Reader *r);             /* the two current transforms differ */
/* Shapes that are read between begin and end become parts of what moves, if anything does; end is
 * called if begin succeeded. */
typedef struct { uint32_t object; Transform ctm; } Moved;
bool mover_begin(Reader *r, Place at, Moved *was);
void mover_end(Reader *r, const Moved *was);
/* Puts a geometry into the world, unless it is empty; and the moving shapes of an object (0: those
 * of the world itself) that is placed so. */
bool mover_place(Reader *r, Place at, uint32_t geometry, const Transform *start,
                 const Transform *end);
bool movers_place(Reader *r, Place at, uint32_t object, const Transform *start,
                  const Transform *end);

bool do_shape(Reader *r, Place at);             /* shapes.c */
/* Adds a mesh given in the space of the current transform. Takes the mesh over in any case. */
bool shape_add_mesh(Reader *r, Place at, Mesh *m, uint32_t material, const AreaLight *area);

/* mtlmaterials.c: a material of an MTL file, and the light that it gives (NULL: none). */
bool mtl_material(Reader *r, const MtlMaterial *m, uint32_t *index);
bool mtl_light(Reader *r, const MtlMaterial *m, const AreaLight **area);
/* Names of old files use backslashes. In the SceneFile's arena; NULL: memory. */
char *mtl_slashed(Reader *r, const char *name);
/* objfile.c: reads an OBJ file with its MTL files and adds it. */
bool objfile_add(Reader *r, Place at, const char *path);

#endif
