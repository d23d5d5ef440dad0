/* figures.c -- bodies for scenes, made by rule.
 *
 * A figure is a list of rounded pieces that are joined or cut off one after the other, with the
 * polynomial smooth minimum [Quilez08]: its value is a mixture of both, so it is no steeper than
 * the steeper of them. */
#include "geometry/figures.h"

#include "base/random.h"
#include "geometry/implicit.h"

typedef enum {
    BALL,                       /* ellipsoid: centre a, half axes b */
    LIMB,                       /* round cone: from a, radius ra, to b, radius rb */
    BLOCK                       /* centre a, half sides b, edges rounded by ra */
} PieceKind;

enum { JOIN = 0, CUT = 1, TWIN = 2 };           /* TWIN: the same again at -x */

typedef struct {
    PieceKind kind;
    int    how;
    double blend;               /* width of the seam */
    double a[3], b[3], ra, rb;
    double fold;                /* of limbs about z: waves around them, this deep at the low end */
} Piece;

/* ---- distances ---- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double ball(const Piece *k, const double p[3])
{
    double q2 = 0, least = d_min(k->b[0], d_min(k->b[1], k->b[2]));
    for (int i = 0; i < 3; i++) {
        double x = (p[i] - k->a[i]) / k->b[i];
        q2 += x * x;
    }
    return (sqrt(q2) - 1) * least;
}

/* cos(12 a) for the unit vector (cos a, sin a), by angles doubled and tripled. */
static double cos12(double c)
{
    double c2 = 2 * c * c - 1, c4 = 2 * c2 * c2 - 1;
    return 4 * c4 * c4 * c4 - 3 * c4;
}

static double limb(const Piece *k, const double p[3])
{
    double d[3], q[3], t, r;

    for (int i = 0; i < 3; i++) {
        d[i] = k->b[i] - k->a[i];
        q[i] = p[i] - k->a[i];
    }
    t = d_min(d_max(dot(q, d) / dot(d, d), 0), 1);
    r = k->ra + t * (k->rb - k->ra);
    if (k->fold != 0) {
        double r2 = q[0] * q[0] + q[1] * q[1], c = q[0] / sqrt(r2 + 1e-12);
        r += k->fold * (1 - t) * cos12(c) * d_min(1, r2 / (k->ra * k->ra));
    }
    for (int i = 0; i < 3; i++)
        q[i] -= t * d[i];
    return sqrt(dot(q, q)) - r;
}

static double rounded_block(const Piece *k, const double p[3])
{
    double out2 = 0, in = -1e30;
    for (int i = 0; i < 3; i++) {
        double x = fabs(p[i] - k->a[i]) - k->b[i] + k->ra;
        out2 += x > 0 ? x * x : 0;
        in = d_max(in, x);
    }
    return sqrt(out2) + d_min(in, 0) - k->ra;
}

static double piece(const Piece *k, const double p[3])
{
    double q[3] = { k->how & TWIN ? fabs(p[0]) : p[0], p[1], p[2] };
    switch (k->kind) {
    case BALL:  return ball(k, q);
    case LIMB:  return limb(k, q);
    case BLOCK: break;
    }
    return rounded_block(k, q);
}

static double smooth_min(double a, double b, double width)
{
    double h = width - fabs(a - b);
    if (h <= 0)
        return d_min(a, b);
    return d_min(a, b) - h * h / (4 * width);
}

typedef struct { const Piece *piece; int n; } Figure;

static double figure_at(const void *ctx, const double p[3])
{
    const Figure *f = ctx;
    double v = piece(&f->piece[0], p);

    for (int i = 1; i < f->n; i++) {
        const Piece *k = &f->piece[i];
        double d = piece(k, p);
        v = k->how & CUT ? -smooth_min(-v, d, k->blend) : smooth_min(v, d, k->blend);
    }
    return v;
}

/* ---- the figures ---- */

#define B(how, blend, x, y, z, a, b, c) { BALL, how, blend, { x, y, z }, { a, b, c }, 0, 0, 0 }
#define L(how, blend, x, y, z, r, x2, y2, z2, r2) \
    { LIMB, how, blend, { x, y, z }, { x2, y2, z2 }, r, r2, 0 }
#define K(how, blend, x, y, z, a, b, c, r) { BLOCK, how, blend, { x, y, z }, { a, b, c }, r, 0, 0 }

static const Piece skull[] = {
    B(JOIN, 0, 0, 0.12, 0.66, 0.33, 0.42, 0.33),                /* cranium */
    B(JOIN, 0.08, 0, -0.12, 0.60, 0.26, 0.25, 0.24),            /* forehead */
    B(JOIN, 0.08, 0, -0.19, 0.37, 0.17, 0.18, 0.20),            /* upper jaw */
    L(JOIN | TWIN, 0.05, 0.16, -0.28, 0.38, 0.055, 0.29, 0.02, 0.42, 0.030),    /* cheek bones */
    L(JOIN | TWIN, 0.06, 0.05, -0.345, 0.580, 0.035, 0.20, -0.28, 0.585, 0.035),/* brow ridge */
    B(CUT | TWIN, 0.04, 0.125, -0.36, 0.475, 0.092, 0.19, 0.085),               /* eyes */
    L(CUT, 0.02, 0, -0.38, 0.41, 0.022, 0, -0.38, 0.335, 0.046),/* nose, a pear */
    B(CUT | TWIN, 0.06, 0.34, -0.14, 0.54, 0.07, 0.15, 0.12),   /* temples */
    B(CUT | TWIN, 0.05, 0.24, -0.18, 0.25, 0.09, 0.16, 0.09),   /* below the cheeks */
    /* lower jaw: chin, sides, and up to the joints */
    L(JOIN, 0.03, -0.060, -0.30, 0.060, 0.060, 0.060, -0.30, 0.060, 0.060),
    L(JOIN | TWIN, 0.05, 0.08, -0.28, 0.070, 0.055, 0.20, -0.03, 0.15, 0.045),
    L(JOIN | TWIN, 0.04, 0.20, -0.03, 0.15, 0.045, 0.24, 0.02, 0.36, 0.035),
    L(JOIN | TWIN, 0.02, 0.0, -0.320, 0.165, 0.060, 0.085, -0.28, 0.165, 0.055),/* teeth */
    K(JOIN | TWIN, 0.03, 0.05, -0.280, 0.175, 0.07, 0.06, 0.10, 0.03),
    K(CUT, 0.008, 0, -0.40, 0.172, 0.17, 0.14, 0.008, 0.006),   /* between the rows */
    K(CUT, 0.008, 0, -0.40, 0.172, 0.006, 0.036, 0.06, 0.005),  /* between the teeth */
    K(CUT | TWIN, 0.008, 0.044, -0.395, 0.172, 0.006, 0.040, 0.06, 0.005),
    K(CUT | TWIN, 0.008, 0.088, -0.375, 0.172, 0.006, 0.046, 0.06, 0.005),
};

static const Piece statue[] = {
    { LIMB, JOIN, 0, { 0.00, 0.00, 0.14 }, { 0.01, 0, 0.52 }, 0.125, 0.070, 0.014 },    /* robe */
    B(JOIN, 0.05, 0.01, 0.00, 0.50, 0.085, 0.070, 0.080),       /* hips */
    L(JOIN, 0.05, 0.01, 0, 0.55, 0.058, 0.00, 0.005, 0.64, 0.070),
    B(JOIN, 0.04, 0.00, 0.005, 0.685, 0.085, 0.058, 0.070),     /* chest */
    B(JOIN | TWIN, 0.025, 0.036, -0.042, 0.672, 0.032, 0.028, 0.030),
    L(JOIN, 0.04, -0.085, 0.005, 0.735, 0.028, 0.085, 0.005, 0.735, 0.028),     /* shoulders */
    L(JOIN, 0.03, 0, 0.005, 0.74, 0.034, 0.005, 0.00, 0.81, 0.027),             /* neck */
    B(JOIN, 0.02, 0.008, -0.004, 0.868, 0.045, 0.055, 0.062),   /* head */
    B(JOIN, 0.02, 0.008, -0.022, 0.835, 0.028, 0.034, 0.032),   /* chin */
    L(JOIN, 0.012, 0.008, -0.058, 0.880, 0.007, 0.008, -0.066, 0.856, 0.010),   /* nose */
    B(CUT, 0.015, -0.012, -0.066, 0.878, 0.011, 0.014, 0.009),  /* eyes */
    B(CUT, 0.015, 0.028, -0.066, 0.878, 0.011, 0.014, 0.009),
    B(JOIN, 0.012, 0.008, 0.012, 0.885, 0.052, 0.056, 0.058),   /* hair */
    B(JOIN, 0.015, 0.008, 0.070, 0.90, 0.028, 0.030, 0.028),    /* its knot */
    /* the arm that lifts a bowl */
    L(JOIN, 0.03, -0.098, 0.005, 0.73, 0.031, -0.185, -0.04, 0.655, 0.025),
    L(JOIN, 0.02, -0.185, -0.04, 0.655, 0.025, -0.205, -0.115, 0.775, 0.018),
    B(JOIN, 0.015, -0.205, -0.120, 0.792, 0.020, 0.024, 0.026),
    B(JOIN, 0.008, -0.205, -0.125, 0.842, 0.060, 0.060, 0.030),
    B(CUT, 0.006, -0.205, -0.125, 0.866, 0.052, 0.052, 0.032),
    /* the arm that holds a jug */
    L(JOIN, 0.03, 0.098, 0.005, 0.73, 0.031, 0.150, 0.015, 0.615, 0.025),
    L(JOIN, 0.02, 0.150, 0.015, 0.615, 0.025, 0.165, -0.035, 0.500, 0.018),
    B(JOIN, 0.015, 0.166, -0.040, 0.482, 0.020, 0.024, 0.028),
    B(JOIN, 0.012, 0.170, -0.045, 0.385, 0.046, 0.046, 0.062),
    L(JOIN, 0.015, 0.170, -0.045, 0.43, 0.018, 0.170, -0.045, 0.470, 0.024),
    /* a sash, the foot that shows, the plinth */
    L(JOIN, 0.02, -0.075, -0.03, 0.700, 0.020, 0.075, -0.050, 0.565, 0.024),
    B(JOIN, 0.02, -0.050, -0.125, 0.115, 0.030, 0.060, 0.024),
    L(JOIN, 0.06, -0.042, -0.085, 0.14, 0.045, -0.030, -0.035, 0.44, 0.060),
    K(JOIN, 0.008, 0, 0, 0.045, 0.185, 0.185, 0.045, 0.012),
    K(JOIN, 0.006, 0, 0, 0.0975, 0.160, 0.160, 0.0125, 0.008),
};

static const Piece hare[] = {
    B(JOIN, 0, 0, 0.12, 0.22, 0.19, 0.28, 0.205),               /* body */
    B(JOIN, 0.08, 0, 0.24, 0.20, 0.20, 0.19, 0.19),             /* haunches */
    B(JOIN | TWIN, 0.05, 0.14, 0.18, 0.15, 0.085, 0.16, 0.14),
    B(JOIN, 0.08, 0, -0.10, 0.26, 0.13, 0.13, 0.17),            /* chest */
    L(JOIN, 0.06, 0, -0.10, 0.34, 0.10, 0, -0.17, 0.47, 0.09),  /* neck */
    B(JOIN, 0.05, 0, -0.21, 0.53, 0.105, 0.135, 0.110),         /* head */
    B(JOIN, 0.04, 0, -0.31, 0.50, 0.060, 0.060, 0.060),         /* muzzle */
    B(JOIN | TWIN, 0.03, 0.055, -0.25, 0.50, 0.055, 0.065, 0.060),              /* cheeks */
    L(JOIN | TWIN, 0.03, 0.050, -0.15, 0.61, 0.038, 0.105, -0.02, 0.92, 0.030), /* ears */
    L(CUT | TWIN, 0.02, 0.058, -0.190, 0.66, 0.012, 0.113, -0.060, 0.90, 0.018),
    B(CUT | TWIN, 0.015, 0.092, -0.262, 0.555, 0.016, 0.020, 0.018),            /* eyes */
    B(JOIN | TWIN, 0.005, 0.086, -0.258, 0.555, 0.014, 0.017, 0.015),
    L(JOIN | TWIN, 0.04, 0.070, -0.16, 0.20, 0.050, 0.075, -0.21, 0.045, 0.040),/* fore legs */
    B(JOIN | TWIN, 0.03, 0.075, -0.245, 0.035, 0.042, 0.070, 0.034),
    B(JOIN | TWIN, 0.03, 0.155, 0.06, 0.040, 0.050, 0.150, 0.039),              /* hind feet */
    B(JOIN, 0.03, 0, 0.44, 0.20, 0.065, 0.060, 0.070),          /* tail */
};

static const Piece dragon[] = {
    /* from the tail's tip along the back to the head, an S seen from the side */
    L(JOIN, 0, -0.62, 0.10, 0.10, 0.016, -0.70, -0.02, 0.07, 0.028),
    L(JOIN, 0.03, -0.70, -0.02, 0.07, 0.028, -0.58, -0.12, 0.08, 0.045),
    L(JOIN, 0.03, -0.58, -0.12, 0.08, 0.045, -0.42, -0.04, 0.17, 0.070),
    L(JOIN, 0.04, -0.42, -0.04, 0.17, 0.070, -0.25, 0.02, 0.34, 0.100),
    L(JOIN, 0.05, -0.25, 0.02, 0.34, 0.100, -0.02, 0.03, 0.36, 0.125),
    L(JOIN, 0.05, -0.02, 0.03, 0.36, 0.125, 0.16, 0.00, 0.42, 0.115),
    L(JOIN, 0.05, 0.16, 0.00, 0.42, 0.115, 0.28, -0.02, 0.56, 0.080),
    L(JOIN, 0.04, 0.28, -0.02, 0.56, 0.080, 0.26, -0.03, 0.72, 0.062),
    L(JOIN, 0.04, 0.26, -0.03, 0.72, 0.062, 0.32, -0.06, 0.84, 0.065),
    L(JOIN, 0.04, 0.32, -0.06, 0.84, 0.072, 0.44, -0.11, 0.82, 0.056),          /* head */
    L(JOIN, 0.02, 0.44, -0.11, 0.83, 0.044, 0.58, -0.16, 0.79, 0.034),          /* snout */
    L(JOIN, 0.01, 0.40, -0.10, 0.765, 0.030, 0.54, -0.15, 0.705, 0.020),        /* jaw */
    B(JOIN, 0.01, 0.585, -0.160, 0.82, 0.022, 0.022, 0.018),    /* nostrils */
    L(JOIN, 0.01, 0.34, -0.02, 0.89, 0.020, 0.20, 0.04, 0.97, 0.018),           /* horns */
    L(JOIN, 0.01, 0.31, -0.11, 0.89, 0.020, 0.17, -0.14, 0.97, 0.018),
    B(JOIN, 0.01, 0.435, -0.065, 0.870, 0.020, 0.016, 0.018),   /* eyes */
    B(JOIN, 0.01, 0.405, -0.155, 0.865, 0.020, 0.016, 0.018),
    /* legs: thigh, shin, foot with toes */
    L(JOIN, 0.04, -0.25, -0.09, 0.30, 0.075, -0.17, -0.20, 0.18, 0.050),
    L(JOIN, 0.03, -0.17, -0.20, 0.18, 0.050, -0.26, -0.22, 0.05, 0.034),
    L(JOIN, 0.02, -0.26, -0.22, 0.035, 0.034, -0.14, -0.26, 0.025, 0.022),
    L(JOIN, 0.04, -0.27, 0.12, 0.30, 0.075, -0.19, 0.23, 0.18, 0.050),
    L(JOIN, 0.03, -0.19, 0.23, 0.18, 0.050, -0.28, 0.24, 0.05, 0.034),
    L(JOIN, 0.02, -0.28, 0.24, 0.035, 0.034, -0.16, 0.27, 0.025, 0.022),
    L(JOIN, 0.04, 0.18, -0.10, 0.36, 0.060, 0.13, -0.20, 0.21, 0.042),
    L(JOIN, 0.03, 0.13, -0.20, 0.21, 0.042, 0.22, -0.23, 0.05, 0.030),
    L(JOIN, 0.02, 0.21, -0.23, 0.030, 0.030, 0.32, -0.27, 0.022, 0.020),
    L(JOIN, 0.04, 0.18, 0.10, 0.36, 0.060, 0.14, 0.20, 0.24, 0.042),
    L(JOIN, 0.03, 0.14, 0.20, 0.24, 0.042, 0.28, 0.21, 0.12, 0.030),
    L(JOIN, 0.02, 0.28, 0.21, 0.11, 0.030, 0.38, 0.20, 0.08, 0.020),
    /* spines along the back */
    L(JOIN, 0.01, -0.48, -0.06, 0.20, 0.030, -0.55, -0.05, 0.27, 0.018),
    L(JOIN, 0.01, -0.36, 0.00, 0.32, 0.034, -0.43, 0.01, 0.41, 0.018),
    L(JOIN, 0.01, -0.24, 0.02, 0.43, 0.038, -0.31, 0.03, 0.53, 0.018),
    L(JOIN, 0.01, -0.10, 0.03, 0.47, 0.040, -0.16, 0.03, 0.58, 0.018),
    L(JOIN, 0.01, 0.04, 0.02, 0.50, 0.038, -0.02, 0.02, 0.61, 0.018),
    L(JOIN, 0.01, 0.17, 0.00, 0.56, 0.034, 0.10, 0.01, 0.65, 0.018),
    L(JOIN, 0.01, 0.20, -0.02, 0.69, 0.030, 0.11, -0.02, 0.75, 0.018),
    L(JOIN, 0.01, 0.24, -0.04, 0.81, 0.028, 0.14, -0.04, 0.85, 0.018),
};

#undef B
#undef L
#undef K

/* ---- rocks ---- */

enum { PLANES = 14, WAVES = 10 };
typedef struct {
    double plane[PLANES][4];    /* unit normal, distance */
    double wave[WAVES][5];      /* vector, phase, height */
} Rock;

static double centred(Rng *rng) { return 2.0 * (double)rng_unit(rng) - 1.0; }

static void rock_make(Rock *r, uint64_t seed)
{
    Rng rng = rng_seed(seed);

    for (int i = 0; i < PLANES; i++) {
        double *p = r->plane[i], l2;
        do {
            p[0] = centred(&rng);
            p[1] = centred(&rng);
            p[2] = centred(&rng);
            l2 = dot(p, p);
        } while (l2 < 0.01 || l2 > 1);
        for (int k = 0; k < 3; k++)
            p[k] /= sqrt(l2);
        p[3] = 0.36 + 0.10 * (double)rng_unit(&rng);
    }
    for (int i = 0; i < WAVES; i++) {           /* each finer than the one before, and flatter */
        double *w = r->wave[i], f = 5.0 * md_pow(1.45, i);
        for (int k = 0; k < 3; k++)
            w[k] = f * centred(&rng);
        w[3] = PI * centred(&rng);
        w[4] = 0.09 / f;
    }
}

/* A ball cut by planes, its edges rounded, roughened by waves whose steepness sums to 1.6. */
static double rock_at(const void *ctx, const double p[3])
{
    const Rock *r = ctx;
    double q[3] = { p[0] / 1.25, p[1] / 1.1, (p[2] - 0.45) }, v = sqrt(dot(q, q)) - 0.56;

    for (int i = 0; i < PLANES; i++)
        v = -smooth_min(-v, r->plane[i][3] - dot(r->plane[i], q), 0.05);
    v = -smooth_min(-v, p[2], 0.03);            /* it lies flat */
    for (int i = 0; i < WAVES; i++)
        v += r->wave[i][4] * md_sin(dot(r->wave[i], p) + r->wave[i][3]);
    return v;
}

/* ---- knots ---- */

/* The tube about the curve that runs twice round a ring and three times round its tube. The frame:
 * across the curve, away from the ring's centre line, which the curve never points to. */
static void knot_point(double u, double v, V3 *p, V3 *n)
{
    const double big = 0.62, small = 0.26, tube = 0.12;
    double a = 4 * PI * u, b = 6 * PI * u, ca = md_cos(a), sa = md_sin(a);
    double cb = md_cos(b), sb = md_sin(b), r = big + small * cb, l, c = md_cos(2 * PI * v);
    double s = md_sin(2 * PI * v), out[3] = { cb * ca, cb * sa, sb };
    double t[3] = { -r * sa * 2 - 3 * small * sb * ca, r * ca * 2 - 3 * small * sb * sa,
                    3 * small * cb };
    double w[3] = { t[1] * out[2] - t[2] * out[1], t[2] * out[0] - t[0] * out[2],
                    t[0] * out[1] - t[1] * out[0] };

    l = sqrt(dot(w, w));
    *n = v_unit(v3((float)(c * out[0] + s * w[0] / l), (float)(c * out[1] + s * w[1] / l),
                   (float)(c * out[2] + s * w[2] / l)));
    *p = v3((float)(r * ca + tube * (c * out[0] + s * w[0] / l)),
            (float)(r * sa + tube * (c * out[1] + s * w[1] / l)),
            (float)(small * sb + tube * (c * out[2] + s * w[2] / l)));
}

static bool knot(Mesh *m, uint32_t ntris)
{
    /* Quadrangles are about square: the curve is 13 long, the tube 0.75 around. */
    uint32_t nv = (uint32_t)d_max(3, floor(sqrt(ntris / 2.0 / 17))), nu = ntris / 2 / nv;
    uint32_t k = 0;

    if (!mesh_alloc(m, (size_t)nu * nv, 2 * (size_t)nu * nv, true, false))
        return false;
    m->nverts = nu * nv;
    for (uint32_t i = 0; i < nu; i++)
        for (uint32_t j = 0; j < nv; j++, k++) {
            uint32_t next = (i + 1) % nu * nv, up = (j + 1) % nv;
            knot_point((double)i / nu, (double)j / nv, &m->p[k], &m->n[k]);
            m->tri[m->ntris++] = (Tri){ { i * nv + j, next + up, next + j } };
            m->tri[m->ntris++] = (Tri){ { i * nv + j, i * nv + up, next + up } };
        }
    return true;
}

/* ---- the list ---- */

#define FIGURE(list, x0, y0, z0, x1, y1, z1) \
    { { list, sizeof list / sizeof *list }, { x0, y0, z0 }, { x1, y1, z1 } }
static const struct { Figure f; double lo[3], hi[3]; } figures[] = {
    FIGURE(skull, -0.42, -0.52, -0.03, 0.42, 0.58, 1.05),
    FIGURE(statue, -0.30, -0.25, -0.03, 0.26, 0.23, 0.99),
    FIGURE(hare, -0.29, -0.45, -0.03, 0.29, 0.57, 1.02),
    FIGURE(dragon, -0.78, -0.35, -0.03, 0.65, 0.35, 1.03),
};

bool figure_mesh(Mesh *m, FigureKind kind, uint32_t ntris, uint64_t seed)
{
    Implicit f = { figure_at, NULL, 3, { -0.8, -0.8, -0.1 }, { 0.8, 0.8, 1.1 } };
    Rock rock;

    *m = (Mesh){ 0 };
    if (ntris < 1000 || ntris > 2000000000)
        return err_usage("a figure of %lu triangles, 1000 to 2000000000 were expected",
                         (unsigned long)ntris);
    if (kind == FIGURE_KNOT)
        return knot(m, ntris);
    if (kind == FIGURE_ROCK) {
        rock_make(&rock, seed);
        f.at = rock_at;
        f.ctx = &rock;
        return implicit_mesh(m, &f, ntris);
    }
    f.ctx = &figures[kind - FIGURE_SKULL].f;
    for (int k = 0; k < 3; k++) {
        f.lo[k] = figures[kind - FIGURE_SKULL].lo[k];
        f.hi[k] = figures[kind - FIGURE_SKULL].hi[k];
    }
    return implicit_mesh(m, &f, ntris);
}
