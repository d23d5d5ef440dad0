/* neighbours.c -- the policy `neighbours`: how many samples a pixel gets is decided by the other
 * half of the pixels, and by no sample of its own.
 *
 * Idea        For a given number of samples the error of a picture, the mean of the variances
 *             V = A n^-a of its pixels, is least where n is in proportion to A^(1/(a+1)): to the
 *             standard deviation of a sample if samples are independent (a = 1; there [Cline07
 *             (5.9)] has it too). Pixels whose error were equal would do no better than pixels
 *             alike: both make it the mean of A over n.
 * Rounds      In round k each pixel has its first 2^k samples: these are scheduled, they depend on
 *             nothing. Pixels are coloured like a chessboard. For either colour the scheduled
 *             samples of the *other* one say: V of its pixels (Q times r/(1-r); see film.c), a, the
 *             brightness of the picture, and how many samples would bring the error of the picture
 *             down to X (or the mean count to what was asked for), if each pixel had them as those
 *             around it suggest. Are these no more than FINISH times 2^k a pixel, then the colour's
 *             counts are final; else there is a round k + 1.
 * Spikes      Where noise is made of rare bright samples, those met so far say little about where
 *             the next will fall. So counts follow the mean of the roots of Q around a pixel, and a
 *             share of their squares' mean goes to all: that of a few shares by which the pixels
 *             looked at, had they what those around them suggest, would have the least product of
 *             samples and variance. For the same reason V is taken from pixels whose counts did
 *             not follow from their own Q: else it would come out too low.
 * Margin      Whoever stops when V is low enough for the first time stops too early: spikes not yet
 *             met are not in V. So MARGIN standard errors of the sum of V are added to it, as the
 *             V of the pixels tell them.
 * Truth       Unbiased, exactly. Counts of black pixels are a function of the first 2^k samples, k
 *             = 1, 2, ..., of white ones, whether or not those are in the picture, and of nothing
 *             else. The subtle part is that "whether or not": black may want another round when
 *             white has its final counts. Then what white takes for that round, beyond these
 *             counts, is looked at and thrown away. Were it added, or were black to look at what
 *             white has by its final counts, then white's count would depend, by way of black, on
 *             white's samples. When does that happen? Seldom: both colours see nearly the same
 *             picture.
 * Few pixels  A window of less than APART pixels has its scheduled samples taken a second time, for
 *             looking at only, and both colours look at all of them.
 * Counts      Powers of two, so that the blocks of a (0,2)-sequence are whole, between 2^k and
 *             2^(k + MORE) or the most that is allowed; that costs 2 % more error than exact ones.
 *             Which of two powers is a matter of chance, fixed for each pixel, so that no contours
 *             show where counts double. */
#include "render/adaptive.h"

static const double MARGIN = 2;
enum { FINISH = 2, MORE = 4, APART = 64, TURNS = 30, LAST = 26 };

/* What the other colour's first 2^k samples say of the picture. */
typedef struct { double mean, left; } Outlook;

static bool looks_at(const Adaptive *a, int colour, uint32_t x, uint32_t y)
{
    return a->pilot || (int)((x ^ y) & 1) != colour;
}

static const Seen *scheduled(const Adaptive *a) { return a->pilot ? a->pilot : a->seen; }

static Outlook look(const Adaptive *a, int colour, int k)
{
    const Seen *seen = scheduled(a);
    double mean = 0, last = 0, before = 0, n = 0;
    Outlook o;

    for (uint32_t i = 0; i < a->n; i++)
        if (looks_at(a, colour, i % a->film->w, i / a->film->w)) {
            mean += (double)seen[i].mark[k % SEEN_MARKS];
            n++;
            if (k >= 3) {
                last += seen_q(&seen[i], k);
                before += seen_q(&seen[i], k - 2);
            }
        }
    o.mean = mean / n;
    o.left = film_decay(last, before);
    return o;
}

/* Q of the first 2^k samples, and of the half of them. */
static double q_of(const Seen *s, int k, const Outlook *o)
{
    return k > 1 ? 0.5 * (seen_q(s, k) + o->left * seen_q(s, k - 1)) : k > 0 ? seen_q(s, k) : 0;
}

/* exp(-d^2 / 4.5), by the squared distance d^2; 0 for the pixel itself */
static const double weight_at[11] = { 0, 0.8007374, 0.6411804, 0, 0.4111123, 0.3291930, 0, 0,
                                      0.1690133, 0.1353353, 0.1083680 };

/* The deviation to be expected of pixel (x, y) after 2^k samples, but for a factor: the mean of the
 * roots of Q of those pixels around it that the colour looks at. */
static double deviation_around(const Adaptive *a, int colour, int k, const Outlook *o, int x, int y)
{
    int w = (int)a->film->w, h = (int)a->film->h;
    double sum = 0, weights = 0;

    for (int v = y < 3 ? 0 : y - 3; v <= y + 3 && v < h; v++)
        for (int u = x < 3 ? 0 : x - 3; u <= x + 3 && u < w; u++) {
            int d2 = (u - x) * (u - x) + (v - y) * (v - y);
            if (d2 == 0 || d2 > 10 || !looks_at(a, colour, (uint32_t)u, (uint32_t)v))
                continue;
            sum += weight_at[d2] *
                   sqrt(q_of(&scheduled(a)[(size_t)v * a->film->w + (size_t)u], k, o));
            weights += weight_at[d2];
        }
    return weights > 0 ? sum / weights : 0;
}

/* ---- how many ---- */

/* squares: of the pixels' variances. */
typedef struct { double samples, variance, squares, pixels; } Sum;

/* Doublings above 2^k of a pixel that is `wish` octaves above it. */
static int doublings(double wish, int most)
{
    return wish < 1 ? 0 : wish >= most ? most : (int)wish;
}

/* Samples and variance of the pixels that a colour looks at, if they had what they would get by the
 * pixels around them, c being added to the octaves of their wishes. Only so is it an estimate for
 * the colour: its own pixels do not have the spikes that the wishes were made from, either. A
 * doubling is taken to halve the variance, which patterns do better than, but how much is not known
 * yet. */
static Sum spend(const Adaptive *a, int colour, int k, double c, int most)
{
    Sum s = { 0, 0, 0, 0 };

    for (uint32_t i = 0; i < a->n; i++)
        if (looks_at(a, colour, i % a->film->w, i / a->film->w)) {
            int j = doublings((double)a->room[2 * i] + c, most);
            double v;
            s.samples += (double)((uint32_t)1 << (k + j));
            v = (double)a->room[2 * i + 1] / (double)(1 << j);
            s.variance += v;
            s.squares += v * v;
            s.pixels++;
        }
    return s;
}

/* Octaves of the wish of a pixel whose expected deviation has the square d2, but for what all have
 * in common. floor: what goes to all. */
static float wish(float d2, double floor_of_all, double slope)
{
    float v = d2 + (float)floor_of_all;
    return v > 0 ? m_log2(v) / (float)(1 + slope) : -1e9f;
}

/* The share of the mean square that goes to all. mean: that square of the pixels looked at. */
static double best_share(const Adaptive *a, int colour, double mean, double slope)
{
    static const double shares[] = { 0.1, 0.4, 1.6, 6.4, 1e6 };
    double best = shares[0], least = INFINITY;

    for (size_t k = 0; k < sizeof shares / sizeof shares[0] && mean > 0; k++) {
        double samples = 0, variance = 0;
        for (uint32_t i = 0; i < a->n; i++)
            if (looks_at(a, colour, i % a->film->w, i / a->film->w)) {
                double n = (double)m_exp(0.6931472f * wish(a->room[2 * i] / (float)mean,
                                                          shares[k], slope));
                samples += n;
                variance += (double)a->room[2 * i + 1] / n;
            }
        if (samples * variance < least) {
            least = samples * variance;
            best = shares[k];
        }
    }
    return best;
}

/* All pixels' wishes, in octaves but for what they have in common, and the variances of those that
 * the colour looks at. */
static void fill_room(Adaptive *a, int colour, int k, const Outlook *o)
{
    double slope = -(double)m_log2((float)o->left), mean = 0, n = 0, shared;

    for (uint32_t i = 0; i < a->n; i++) {
        uint32_t x = i % a->film->w, y = i / a->film->w;
        double d = deviation_around(a, colour, k, o, (int)x, (int)y);
        a->room[2 * i] = (float)(d * d);
        a->room[2 * i + 1] = (float)(q_of(&scheduled(a)[i], k, o) * film_left(o->left));
        if (looks_at(a, colour, x, y)) {
            mean += d * d;
            n++;
        }
    }
    mean /= n;
    shared = best_share(a, colour, mean, slope) * mean;
    for (uint32_t i = 0; i < a->n; i++) {
        uint64_t x = i % a->film->w + a->film->x0, y = i / a->film->w + a->film->y0;
        a->room[2 * i] = wish(a->room[2 * i], shared, slope) +
                         unit_of((uint32_t)draw64(key_with(0, y), x));
    }
}

/* Whether these are enough: all samples that are to be spent, or less error than is allowed. */
static bool enough(const Adaptive *a, const Sum *s, const Outlook *o, double mean)
{
    double allowed = a->error * o->mean;
    return a->error > 0 ? s->variance + MARGIN * sqrt(s->squares) <= allowed * allowed * s->pixels
                        : s->samples >= mean * s->pixels;
}

/* Final counts for a colour, if they are not too far from 2^k. mean: samples, where there is no
 * error to reach; force: however far. */
static bool decide(Adaptive *a, int colour, int k, double mean, bool force)
{
    Outlook o = look(a, colour, k);
    double lo = -60, hi = 160;
    int most = 0;
    Sum s;

    while (most < MORE && (uint64_t)1 << (k + most) < a->most)
        most++;
    fill_room(a, colour, k, &o);
    s = spend(a, colour, k, lo, most);
    if (enough(a, &s, &o, mean))
        hi = lo;
    for (int i = 0; i < TURNS && hi > lo; i++) {
        double c = 0.5 * (lo + hi);
        s = spend(a, colour, k, c, most);
        if (enough(a, &s, &o, mean))
            hi = c;
        else
            lo = c;
    }
    s = spend(a, colour, k, hi, most);
    if (!force && (!enough(a, &s, &o, mean) || s.samples > FINISH * s.pixels * (double)(1u << k)))
        return false;
    for (uint32_t i = 0; i < a->n; i++)
        if ((int)((i % a->film->w ^ i / a->film->w) & 1) == colour) {
            uint32_t n = (uint32_t)1 << (k + doublings((double)a->room[2 * i] + hi, most));
            Seen *p = &a->seen[i];
            n = !a->mean && n < a->least ? a->least : n;
            n = n < a->most ? n : a->most;
            p->want = n > p->want ? n : p->want;
            if (a->mean || a->error > 0)
                p->keep = p->want;
        }
    return true;
}

/* ---- rounds ---- */

static bool start(Adaptive *a)
{
    uint32_t most = a->mean ? a->mean / 2 : a->most;

    for (a->step = 0; (uint64_t)2 << a->step <= most && (uint32_t)1 << a->step < a->least;)
        a->step++;
    if (a->n >= APART)
        return true;
    a->npilot = a->n;
    a->pilot = MEM_ARRAY(Seen, a->n);
    return a->pilot != NULL;
}

static void schedule(Adaptive *a, int k)
{
    adaptive_want(a, (uint32_t)1 << k);
    for (uint32_t i = 0; i < a->npilot; i++)
        a->pilot[i].want = (uint32_t)1 << k;
}

/* For progress: what a picture of pixels alike would need, from V ~ n^-a. */
static void expect(Adaptive *a, int k)
{
    Outlook o = look(a, 0, k);
    Sum s = spend(a, 0, k, -60, 0);
    double allowed = a->error * o.mean, slope = -(double)m_log2((float)o.left);

    if (a->mean)
        a->expected = (double)a->mean * a->n;
    else if (allowed > 0 && s.pixels > 0)
        a->expected = (double)a->n * (double)((uint32_t)1 << k) *
                      md_pow(s.variance / s.pixels / (allowed * allowed), 1 / slope);
}

/* Without an end the mean goes to twice the schedule, round by round. */
static bool plan(Adaptive *a)
{
    int k = a->step;
    double one = (double)((uint32_t)1 << k), most = a->mean ? a->mean : a->most;
    bool endless = !a->mean && !(a->error > 0);
    bool last = 2 * one > most || k == LAST || (a->mean && FINISH * one >= most);

    if (scheduled(a)->taken == 0) {
        schedule(a, k);
        return true;
    }
    if ((a->done[0] && a->done[1]) || (endless && last))
        return false;
    for (int colour = 0; colour < 2; colour++)
        if (!a->done[colour])
            a->done[colour] = decide(a, colour, k, a->mean ? a->mean : 2 * one, last || endless) &&
                              !endless;
    if (!a->done[0] || !a->done[1]) {
        expect(a, k);
        schedule(a, ++a->step);
    }
    return true;
}

static const OptDef options[] = { ADAPTIVE_LEAST, { .key = NULL } };

const AdaptiveKind adaptive_neighbours = {
    .info = { "neighbours", "Kirk91; Cline07 5.5", "pixels of one colour by those of the other, as "
              "on a chessboard; pictures had at most 1.1 X where --error X stopped them", options },
    .truth = UNBIASED, .start = start, .plan = plan
};
