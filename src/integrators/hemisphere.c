/* hemisphere.c -- the code of `hemisphere.h` */
#include "integrators/hemisphere.h"

/* Sine of the angle below ring j. */
static double border(const Hemisphere *h, int j) { return sqrt((double)j / h->rings); }
static double cosine(double sine) { return sqrt(d_max(0.0, (1.0 - sine) * (1.0 + sine))); }

/* Integral of sin^2 from 0 to the angle. */
static double below(double sine)
{
    double c = cosine(sine);
    return 0.5 * (md_atan2(sine, c) - sine * c);
}

void hemisphere_cells(int rays, int *rings, int *sectors)
{
    int r = (int)sqrt(rays / PI);

    *rings = r < 1 ? 1 : r > RINGS_MOST ? RINGS_MOST : r;
    *sectors = (rays + *rings - 1) / *rings;
    *sectors = *sectors < 3 ? 3 : *sectors;
}

void hemisphere_start(Hemisphere *h, int rays)
{
    memset(h, 0, sizeof *h);
    hemisphere_cells(rays, &h->rings, &h->sectors);
    for (int j = 0; j < h->rings; j++)          /* the cosine integrates to 1 / (2 rings) */
        h->tangent[j] = (float)(2.0 * h->rings * (below(border(h, j + 1)) - below(border(h, j))));
}

V3 hemisphere_direction(const Hemisphere *h, int j, int k, V2 u)
{
    float sine2 = ((float)j + u.x) / (float)h->rings, s, c, sine;

    sine2 = f_min(sine2, ONE_MINUS_ULP);
    sine = sqrtf(sine2);
    m_sincos_turn(((float)k + u.y) / (float)h->sectors, &s, &c);
    return v3(c * sine, s * sine, sqrtf(1.0f - sine2));
}

static double channel(Rgb c, int k) { return k == 0 ? c.r : k == 1 ? c.g : c.b; }

/* Adds (b - a) times the factor, by the nearer of both, along the direction of the turn u. */
static void moves(Hemisphere *h, const HemisphereCell *a, const HemisphereCell *b, double factor,
                  float x, float y)
{
    factor *= f_max(a->inv_distance, b->inv_distance);
    for (int c = 0; c < 3; c++) {
        double d = factor * (channel(b->L, c) - channel(a->L, c));
        h->move[c][0] += d * x;
        h->move[c][1] += d * y;
    }
}

/* The border between sector k - 1, whose cell is a, and k, at ring j. [WardHeckbert92] */
static void moves_across(Hemisphere *h, int j, int k, const HemisphereCell *a,
                         const HemisphereCell *b)
{
    float s, c;

    m_sincos_turn((float)k / (float)h->sectors, &s, &c);
    moves(h, a, b, border(h, j + 1) - border(h, j), -s, c);
}

void hemisphere_take(Hemisphere *h, int j, int k, Rgb L, float inv_distance)
{
    HemisphereCell now = { L, inv_distance };
    float s, c;

    m_sincos_turn(((float)k + 0.5f) / (float)h->sectors, &s, &c);
    for (int i = 0; i < 3; i++) {
        h->E[i] += channel(L, i);
        h->turn[i][0] -= channel(L, i) * h->tangent[j] * s;
        h->turn[i][1] += channel(L, i) * h->tangent[j] * c;
    }
    h->inv += inv_distance;
    if (j > 0) {                /* the border below this ring; last[j - 1] is of this sector */
        double sine = border(h, j), cosine2 = (1.0 - sine) * (1.0 + sine);
        moves(h, &h->last[j - 1], &now, 2.0 * PI / h->sectors * sine * cosine2, c, s);
    }
    if (k > 0)
        moves_across(h, j, k, &h->last[j], &now);
    else
        h->first[j] = now;
    h->last[j] = now;
    if (k == h->sectors - 1)
        moves_across(h, j, 0, &now, &h->first[j]);
}

static V3 to_world(const Frame *f, const double v[2], double scale)
{
    return frame_out(f, v3((float)(v[0] * scale), (float)(v[1] * scale), 0.0f));
}

void hemisphere_end(Hemisphere *h, const Frame *f, Irradiance *out)
{
    double cells = (double)h->rings * h->sectors, part = PI / cells;

    out->E = rgb((float)(part * h->E[0]), (float)(part * h->E[1]), (float)(part * h->E[2]));
    for (int i = 0; i < 3; i++) {
        out->turn[i] = to_world(f, h->turn[i], part);
        out->move[i] = to_world(f, h->move[i], 1.0);
    }
    out->inv_distance = (float)(h->inv / cells);
}
