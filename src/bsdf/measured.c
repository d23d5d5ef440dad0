/* measured.c -- a BRDF as it was measured: a table in a file, on both sides. See merl.h.
 *
 * Sampled [Cline07 4.4.1] by half vectors: their density depends on theta_h alone, is constant in
 *         each row of the table and goes as the row's mean times the cosine. That follows lobes of
 *         facets, however narrow. It is mixed with the cosine, so that f cos / pdf is bounded by
 *         what the table holds.
 *
 * Energy  Measured values near grazing angles are not to be trusted: tables return up to several
 *         times what they get there. When one is read, its albedo A is found for 64 angles; f is
 *         scaled by the smaller of min(1, 1/A) of both directions, which is reciprocal and leaves
 *         at most 1. */
#include "base/file.h"
#include "bsdf/half.h"
#include "bsdf/merl.h"
#include "bsdf/bsdf.h"
#include "sampling/table.h"

enum { ANGLES = 64, ROWS_MOST = MERL_MOST };
#define COSINE_SHARE 0.4f       /* of samples */

typedef struct {
    Merl  merl;
    Table rows;                 /* owned; of theta_h */
    float density[ROWS_MOST];   /* of h, per solid angle, in each row */
    float kept[ANGLES + 1];     /* min(1, 1/A) by the cosine */
    Rgb   albedo[ANGLES + 1];
} Measured;

static const Measured *of(const Bsdf *b)
{
    const void *const *p = (const void *const *)(const void *)b->as.number;
    return *p;
}

/* ---- reading ---- */

static void edges_of(const Measured *m, size_t row, double *first, double *last)
{
    double a = (double)row / m->merl.nh, b = (double)(row + 1) / m->merl.nh;
    *first = md_cos(0.5 * PI * a * a);
    *last = md_cos(0.5 * PI * b * b);
}

static bool make_rows(Measured *m)
{
    float weight[ROWS_MOST];
    size_t nd = m->merl.nd, np = m->merl.np;
    double total;

    for (size_t h = 0; h < m->merl.nh; h++) {
        double sum = 0.0, first, last;
        for (size_t k = 0; k < nd * 8 / 9 * np; k++)            /* not the last ten degrees */
            sum += rgb_lum(m->merl.f[h * nd * np + k]);
        edges_of(m, h, &first, &last);
        m->density[h] = (float)(d_max(sum, 1e-9) * (first + last));
        weight[h] = (float)(m->density[h] * (first - last));
    }
    if (!table_init(&m->rows, weight, m->merl.nh))
        return false;
    total = table_total(&m->rows) * 2.0 * PI;
    for (size_t h = 0; h < m->merl.nh; h++)
        m->density[h] = (float)(m->density[h] / total);
    return true;
}

static V3 toward(const Measured *m, V3 wo, V2 u);
static float density_of(const Measured *m, V3 wo, V3 wi);

/* The albedo at each angle, by 48 x 48 points of the density that samples. */
static void make_albedo(Measured *m)
{
    enum { N = 48 };
    for (int k = 0; k <= ANGLES; k++) {
        float z = f_max((float)k / ANGLES, 1e-3f), most;
        V3 wo = v3(sqrtf(1.0f - z * z), 0.0f, z);
        Rgb sum = rgb_all(0.0f);
        for (int i = 0; i < 2 * N * N; i++) {                   /* a half of each kind */
            V2 u = { ((float)(i / 2 % N) + 0.5f) / N, ((float)(i / 2 / N) + 0.5f) / N };
            V3 wi = i % 2 ? warp_cosine(u) : toward(m, wo, u);
            float pdf = wi.z > 0.0f ? 0.5f * warp_cosine_pdf(wi.z) + 0.5f * density_of(m, wo, wi)
                                    : 0.0f;
            if (pdf > 0.0f)
                sum = rgb_add(sum, rgb_scale(merl_f(&m->merl, wo, wi), wi.z / pdf));
        }
        m->albedo[k] = rgb_scale(sum, 0.5f / (N * N));
        most = rgb_max(m->albedo[k]) * 1.01f;                   /* the quadrature */
        m->kept[k] = most > 1.0f ? 1.0f / most : 1.0f;
        m->albedo[k] = rgb_scale(m->albedo[k], m->kept[k]);
    }
}

static void drop(void *data)
{
    Measured *m = data;
    merl_clear(&m->merl);
    table_clear(&m->rows);
    mem_free(m);
}

static bool load(const Opts *o, const BsdfFiles *files, void **data)
{
    const char *name = opt_string(o, "filename");
    char *path;
    FileBytes bytes;
    Measured *m;
    bool ok;

    if (!files || !*name)
        return true;
    path = path_beside(files->beside, name);
    if (!path || !file_read(path, files->max_file, &bytes)) {
        mem_free(path);
        return false;
    }
    m = MEM_NEW(Measured);
    ok = m && merl_read(&m->merl, path, (const unsigned char *)bytes.bytes, bytes.size) &&
         make_rows(m);
    file_clear(&bytes);
    mem_free(path);
    if (ok)
        make_albedo(m);
    else if (m)
        drop(m);
    *data = ok ? m : NULL;
    return ok;
}

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    const void **p = (const void **)(void *)b->as.number;
    (void)value;
    *p = data;
}

/* ---- the model; directions above the surface ---- */

static float between(const float *table, float z, int *k)
{
    float x = f_min(z, 1.0f) * ANGLES;
    *k = (int)f_min(floorf(x), ANGLES - 1);
    return table[*k] + (table[*k + 1] - table[*k]) * (x - (float)*k);
}

static Rgb f_of(const Measured *m, V3 wo, V3 wi)
{
    int k;
    float o = between(m->kept, wo.z, &k), i = between(m->kept, wi.z, &k);
    return rgb_scale(merl_f(&m->merl, wo, wi), f_min(o, i));
}

/* Of half vectors, as a density of wi. */
static float density_of(const Measured *m, V3 wo, V3 wi)
{
    Half h = half_of(wo, wi);
    double x = sqrt(md_atan2(sqrt(h.x * h.x + h.y * h.y), h.z) / (0.5 * PI)) * m->merl.nh;
    size_t row = (size_t)x;
    return m->density[row < m->merl.nh ? row : m->merl.nh - 1] / (4.0f * (float)h.cosine);
}

static V3 toward(const Measured *m, V3 wo, V2 u)
{
    double first, last, c, s;
    size_t row;
    float rest, sine, cosine;

    if (!table_sample(&m->rows, u.x, &row, NULL, &rest))
        return v3(0.0f, 0.0f, 0.0f);
    edges_of(m, row, &first, &last);
    c = first + (last - first) * rest;
    s = sqrt(d_max(0.0, 1.0 - c * c));
    m_sincos_turn(u.y, &sine, &cosine);
    return half_reflect(wo, s * cosine, s * sine, c);
}

static float pdf_of(const Measured *m, V3 wo, V3 wi)
{
    return COSINE_SHARE * warp_cosine_pdf(wi.z) + (1.0f - COSINE_SHARE) * density_of(m, wo, wi);
}

static Rgb eval(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    (void)importance;
    if (!of(b) || !same_side(wo, wi))
        return rgb_all(0.0f);
    return f_of(of(b), above(wo), above(wi));
}

static float pdf_w(const Bsdf *b, V3 wo, V3 wi)
{
    return of(b) && same_side(wo, wi) ? pdf_of(of(b), above(wo), above(wi)) : 0.0f;
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Measured *m = of(b);
    V3 up = above(wo);

    (void)importance;
    if (!m)
        return false;
    s->wi = lobe < COSINE_SHARE ? warp_cosine(u) : toward(m, up, u);
    if (!same_side(up, s->wi))
        return false;
    return smooth_event(s, wo, f_of(m, up, s->wi), pdf_of(m, up, s->wi), false);
}

static Rgb albedo(const Bsdf *b, V3 wo)
{
    int k;
    if (!of(b))
        return rgb_all(0.0f);
    between(of(b)->kept, fabsf(wo.z), &k);
    return of(b)->albedo[k];
}

/* Tables do not say: where facets and things that look back have theirs. [Cline07 5.2.2] */
static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    (void)b;
    peak[0] = normal_z(wo);
    peak[1] = mirror_z(wo);
    peak[2] = wo;
    return 3;
}

static const OptDef options[] = {
    { .key = "filename", .type = OPT_STRING, .str = "",
      .help = "a table in the format of the MERL database; none: black" },
    { .key = NULL }
};

const BsdfKind bsdf_measured = {
    .info = { "measured", "Matusik03; Rusinkiewicz98; Cline07 5.2.2",
              "a BRDF from a table of measurements, MERL format", options },
    .flags = BSDF_REFLECT | BSDF_SMOOTH | BSDF_LOBES,
    .load = load, .drop = drop,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .albedo = albedo, .peaks = peaks
};
