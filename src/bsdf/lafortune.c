/* lafortune.c -- a matt surface with any number of generalised cosine lobes, each about a direction
 * of its own: fits of measured surfaces, skin and clay among them. Both sides.
 *
 * Source  [Lafortune97]: f = kd/pi + sum of k_j (n_j + 2)/(2 pi) max(0, C_j wo . wi)^n_j, where
 *         C_j = (cx, cy, cz) multiplies wo coordinate by coordinate. (-1, -1, 1) is Phong's lobe
 *         about the mirrored direction with the colour k_j, (1, 1, 1) looks back to the light, and
 *         |cz| < |cx| makes a lobe that grows towards grazing angles. A lobe points along C_j wo,
 *         and is sampled as cos^n about that.
 *
 * Energy  Fits may return more light than they get. When the lobes are read, the largest albedo of
 *         their sum is looked for, over angles to the normal along either tangent, between which
 *         it lies for others; lobes are then scaled so that it is at most 1, and where kd and they
 *         together pass 1, both are scaled. */
#include "bsdf/bsdf.h"
#include "bsdf/half.h"

enum { NUMBERS = 7, LOBES_MOST = 15 };          /* of a lobe; with the normal, 16 peaks */

typedef struct { V3 c; float n; Rgb k; } Lobe;  /* k: (n + 2) / (2 pi) times the colour */
typedef struct {
    int  n;
    Lobe lobe[LOBES_MOST];
    Rgb  most;                  /* largest albedo */
    bool tangent;
} Lobes;

typedef struct {
    const Lobes *lobes;         /* borrowed from the material; NULL: none */
    Rgb diffuse, scale;         /* of all lobes */
} Lafortune;

static const Lafortune *of(const Bsdf *b) { return (const Lafortune *)(const void *)b->as.number; }

/* C wo and its length, wo made exactly unit: a power of the length will tell. */
static double arrow(const Lobe *l, V3 wo, double *x, double *y, double *z)
{
    double a = unit_factor(wo);
    *x = a * l->c.x * wo.x;
    *y = a * l->c.y * wo.y;
    *z = a * l->c.z * wo.z;
    return sqrt(*x * *x + *y * *y + *z * *z);
}

/* cos^n of the angle between wi and the lobe, and its length^n in *size. A narrow lobe's cosine is
 * 1 - d^2/2 with d the distance of unit directions: see phong.c. */
static double power_of(const Lobe *l, V3 wo, V3 wi, double *size)
{
    double x, y, z, length = arrow(l, wo, &x, &y, &z), c, a;

    *size = 0.0;
    if (!(length > 1e-6))
        return 0.0;
    a = unit_factor(wi);
    x = x / length - a * wi.x;
    y = y / length - a * wi.y;
    z = z / length - a * wi.z;
    c = 1.0 - 0.5 * (x * x + y * y + z * z);
    *size = md_pow(length, l->n);
    return c > 0.0 ? md_pow(c, l->n) : 0.0;
}

/* Albedo of a lobe without its colour: 2 pi/(n+2) |C wo|^n times the cosine of the lobe, more at
 * grazing, see phong.c: an estimate. */
static double lobe_albedo(const Lobe *l, V3 wo)
{
    double x, y, z, length = arrow(l, wo, &x, &y, &z), g = 1.0 / (4.0 + 2.0 * PI * l->n), c;

    if (!(length > 1e-6))
        return 0.0;
    c = d_max(z / length, 0.0);
    if (z < 0.0)                                /* most of it below the surface */
        g *= md_pow(1.0 - z * z / (length * length), 0.5 * l->n);
    return 2.0 * PI / (l->n + 2.0) * md_pow(length, l->n) * sqrt(c * c + (1.0 - c * c) * g);
}

static float lobe_chance(const Lafortune *p, int j, V3 wo)
{
    return rgb_lum(rgb_mul(p->lobes->lobe[j].k, p->scale)) *
           (float)lobe_albedo(&p->lobes->lobe[j], wo);
}

/* ---- reading ---- */

/* The albedo of a lobe by 24 x 48 points of its own density, without its colour. */
static double exact_albedo(const Lobe *l, V3 wo)
{
    enum { ROWS = 24, COLS = 48 };
    double x, y, z, length = arrow(l, wo, &x, &y, &z), sum = 0.0;
    Frame frame;

    if (!(length > 1e-6))
        return 0.0;
    frame = frame_about(v_unit(v3((float)(x / length), (float)(y / length), (float)(z / length))));
    for (int i = 0; i < ROWS * COLS; i++) {
        double c = md_pow((i / COLS + 0.5) / ROWS, 1.0 / (l->n + 1.0)), s = sqrt(1.0 - c * c);
        float sine, cosine;
        m_sincos_turn(((float)(i % COLS) + 0.5f) / COLS, &sine, &cosine);
        sum += d_max(0.0, frame.n.z * c + s * (frame.s.z * cosine + frame.t.z * sine));
    }
    return 2.0 * PI / (l->n + 1.0) * md_pow(length, l->n) * sum / (ROWS * COLS);
}

static void find_most(Lobes *l)
{
    enum { ANGLES = 48 };
    for (int i = 0; i < 2 * ANGLES; i++) {
        float s, c;
        Rgb sum = rgb_all(0.0f);
        m_sincos_turn(0.25f * (float)(i / 2) / (ANGLES - 1), &s, &c);
        for (int j = 0; j < l->n; j++)
            sum = rgb_add(sum, rgb_scale(l->lobe[j].k, (float)exact_albedo(
                                             &l->lobe[j], i % 2 ? v3(s, 0, c) : v3(0, s, c))));
        l->most = rgb(f_max(l->most.r, sum.r), f_max(l->most.g, sum.g), f_max(l->most.b, sum.b));
    }
    l->most = rgb_scale(l->most, 1.002f);       /* angles in between, and the quadrature */
}

static bool add_lobe(Lobes *l, const Param *p, const double *v)
{
    Lobe *lobe = &l->lobe[l->n++];

    lobe->c = v3((float)v[0], (float)v[1], (float)v[2]);
    lobe->n = (float)v[3];
    lobe->k = rgb_scale(rgb((float)v[4], (float)v[5], (float)v[6]),
                        0.5f * INV_PI * (lobe->n + 2.0f));
    l->tangent = l->tangent || lobe->c.x != lobe->c.y;
    for (int i = 0; i < 3; i++)
        if (!(fabs(v[i]) <= 1.5) || !(v[4 + i] >= 0.0) || !(v[4 + i] <= 1e6))
            return err_at(p->at, "\"lobes\" is not right, expected cx cy cz from -1.5 to 1.5 and "
                          "colours from 0 on");
    return (lobe->n >= 0.0f && lobe->n <= 1e4f) ||
           err_at(p->at, "\"lobes\" is not right, expected exponents from 0 to 10000");
}

static bool load(const Opts *o, const BsdfFiles *files, void **data)
{
    static const double phong[NUMBERS] = { -1, -1, 1, 20, 0.25, 0.25, 0.25 };
    const Param *p = opt_param(o, "lobes");
    Lobes *l;

    (void)files;
    if (p && (p->n % NUMBERS != 0 || p->n > NUMBERS * LOBES_MOST))
        return err_at(p->at, "\"lobes\" is not right, expected up to %d times the numbers cx cy cz "
                      "n r g b", LOBES_MOST);
    l = MEM_NEW(Lobes);
    if (!l)
        return false;
    for (size_t i = 0; i < (p ? p->n : NUMBERS); i += NUMBERS)
        if (!add_lobe(l, p, p ? p->numbers + i : phong)) {
            mem_free(l);
            return false;
        }
    find_most(l);
    *data = l;
    return true;
}

static float to_one(float sum) { return 1.0f / f_max(1.0f, sum); }

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Lafortune *p = (Lafortune *)(void *)b->as.number;
    Rgb most = rgb_all(0.0f), sum, scale;

    p->lobes = data;
    p->diffuse = reflectance_of(value[0]);
    p->scale = rgb_all(1.0f);
    if (p->lobes) {
        most = p->lobes->most;
        p->scale = rgb(to_one(most.r), to_one(most.g), to_one(most.b));
        most = rgb_mul(most, p->scale);
    }
    sum = rgb_add(p->diffuse, most);
    scale = rgb(to_one(sum.r), to_one(sum.g), to_one(sum.b));
    p->diffuse = rgb_mul(p->diffuse, scale);
    p->scale = rgb_mul(p->scale, scale);
    if (!p->lobes || !p->lobes->tangent)
        b->flags &= ~BSDF_TANGENT;
}

/* ---- the model; directions above the surface ---- */

/* f and the density of wi. */
static Rgb both(const Lafortune *p, V3 wo, V3 wi, float *pdf)
{
    Rgb sum = rgb_scale(p->diffuse, INV_PI);
    double part = rgb_lum(p->diffuse), all = part, density = part * warp_cosine_pdf(wi.z);

    for (int j = 0; p->lobes && j < p->lobes->n; j++) {
        const Lobe *l = &p->lobes->lobe[j];
        double size, power = power_of(l, wo, wi, &size);
        sum = rgb_add(sum, rgb_scale(rgb_mul(l->k, p->scale), (float)(size * power)));
        part = lobe_chance(p, j, wo);
        all += part;
        density += part * 0.5 / PI * (l->n + 1.0) * power;
    }
    *pdf = all > 0.0 ? (float)(density / all) : 0.0f;
    return sum;
}

static Rgb eval(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    float pdf;
    (void)importance;
    return same_side(wo, wi) ? both(of(b), above(wo), above(wi), &pdf) : rgb_all(0.0f);
}

static float pdf_w(const Bsdf *b, V3 wo, V3 wi)
{
    float pdf = 0.0f;
    if (same_side(wo, wi))
        both(of(b), above(wo), above(wi), &pdf);
    return pdf;
}

static V3 about(const Lobe *l, V3 wo, V2 u)
{
    double x, y, z, length = arrow(l, wo, &x, &y, &z), rest, down, sine;
    Frame frame = frame_about(v_unit(v3((float)(x / length), (float)(y / length),
                                        (float)(z / length))));
    V2 c = circle_and(u, &rest);

    down = 1.0 - md_pow(rest, 1.0 / (l->n + 1.0));
    sine = sqrt(down * (2.0 - down));
    return v_unit(frame_out(&frame, v3((float)(sine * c.x), (float)(sine * c.y),
                                       (float)(1.0 - down))));
}

/* The lobe that the number falls on, or -1: the matt part. -2: there is nothing. */
static int choose(const Lafortune *p, V3 wo, float lobe)
{
    float all = rgb_lum(p->diffuse), sum = all;
    int last = sum > 0.0f ? -1 : -2;

    for (int j = 0; p->lobes && j < p->lobes->n; j++)
        all += lobe_chance(p, j, wo);
    if (lobe * all < sum)
        return -1;
    for (int j = 0; p->lobes && j < p->lobes->n; j++) {
        float part = lobe_chance(p, j, wo);
        sum += part;
        if (part > 0.0f)
            last = j;
        if (part > 0.0f && lobe * all < sum)
            break;
    }
    return last;
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Lafortune *p = of(b);
    V3 up = above(wo);
    int j = choose(p, up, lobe);
    float pdf;
    Rgb f;

    (void)importance;
    if (j < -1)
        return false;
    s->wi = j < 0 ? warp_cosine(u) : about(&p->lobes->lobe[j], up, u);
    if (!same_side(up, s->wi))
        return false;
    f = both(p, up, s->wi, &pdf);
    return smooth_event(s, wo, f, pdf, j < 0);
}

static Rgb albedo(const Bsdf *b, V3 wo)
{
    const Lafortune *p = of(b);
    Rgb sum = p->diffuse;
    for (int j = 0; p->lobes && j < p->lobes->n; j++)
        sum = rgb_add(sum, rgb_scale(rgb_mul(p->lobes->lobe[j].k, p->scale),
                                     (float)lobe_albedo(&p->lobes->lobe[j], above(wo))));
    return rgb(f_min(sum.r, 1.0f), f_min(sum.g, 1.0f), f_min(sum.b, 1.0f));
}

static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    const Lafortune *p = of(b);
    int n = 1;

    peak[0] = normal_z(wo);
    for (int j = 0; p->lobes && j < p->lobes->n; j++) {
        V3 d = v_unit(v_mul(p->lobes->lobe[j].c, wo));
        if (d.z * wo.z > 0.0f)
            peak[n++] = d;
    }
    return n;
}

static const OptDef options[] = {
    { .key = "reflectance", .type = OPT_RGB, .num = 0.5, .lo = 0, .hi = 1, .also = "Kd",
      .help = "part of the light that is reflected in every direction" },
    { .key = "lobes", .type = OPT_NUMBERS,
      .help = "seven numbers a lobe: cx cy cz, exponent, red green blue; -1 -1 1 is Phong's" },
    { .key = NULL }
};

const BsdfKind bsdf_lafortune = {
    .info = { "lafortune", "Lafortune97; Cline07 5.2.2",
              "matt with any number of cosine lobes: skin, clay", options },
    .flags = BSDF_REFLECT | BSDF_SMOOTH | BSDF_LOBES | BSDF_TANGENT | BSDF_MATT,
    .load = load, .drop = mem_free,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .albedo = albedo, .peaks = peaks
};
