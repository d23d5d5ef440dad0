/* lightcut.c -- clusters of point lights, their importance for a point, and the choice among them.
 * See lightcut.h. */
#include "lightsampling/lightcut.h"

#include "base/mem.h"
#include "base/simd.h"

/* ---- boxes over the cut ---- */

typedef struct { const LightTree *t; const uint32_t *node; size_t n; FourBoxes *four; } Boxing;

/* The cluster that a node is, or -1. Clusters' nodes are in order. */
static int cluster_at(const Boxing *b, uint32_t node)
{
    size_t lo = 0, hi = b->n;

    while (lo < hi) {
        size_t middle = (lo + hi) / 2;
        if (b->node[middle] < node)
            lo = middle + 1;
        else
            hi = middle;
    }
    return lo < b->n && b->node[lo] == node ? (int)lo : -1;
}

/* Opens the largest of up to four nodes, until there are four or nothing is left to open. */
static int four_below(const Boxing *b, uint32_t root, uint32_t kid[4])
{
    int n = 1;

    kid[0] = root;
    while (n < 4) {
        float most = -1.0f;
        int best = -1;
        for (int k = 0; k < n; k++) {
            float area = box_area(b->t->node[kid[k]].box);
            if (cluster_at(b, kid[k]) < 0 && area > most) {
                most = area;
                best = k;
            }
        }
        if (best < 0)
            return n;
        kid[n++] = b->t->node[kid[best]].second;
        kid[best]++;
    }
    return n;
}

/* Index of the four below the root; *used counts. */
static int32_t box_four(const Boxing *b, uint32_t root, int32_t *used)
{
    int32_t at = (*used)++;
    uint32_t kid[4];
    int n = four_below(b, root, kid);

    for (int k = 0; k < 4; k++) {
        Box box = k < n ? b->t->node[kid[k]].box : box_empty();
        for (int a = 0; a < 3; a++) {
            b->four[at].lo[a][k] = v_axis(box.lo, a);
            b->four[at].hi[a][k] = v_axis(box.hi, a);
        }
    }
    for (int k = 0; k < 4; k++) {
        int cluster = k < n ? cluster_at(b, kid[k]) : -1;
        int32_t child = cluster >= 0 ? ~cluster : k < n ? box_four(b, kid[k], used) : 0;
        b->four[at].child[k] = child;
    }
    return at;
}

static bool boxes_of(LightCut *c, const uint32_t *node, bool beyond)
{
    Boxing b = { c->tree, node, c->n, NULL };
    const LightNode *root = c->tree->node;
    uint32_t top = 0;
    int32_t used = 0;

    if (root->beyond && root->within)
        top = root[1].beyond == beyond ? 1 : root->second;
    else if (root->beyond != beyond)
        return true;
    b.four = c->four[beyond] = MEM_ARRAY(FourBoxes, c->n);
    if (!b.four)
        return false;
    box_four(&b, top, &used);
    return true;
}

enum { STACK = 3 * 160 };       /* of fours to visit; past it clusters are not counted */

static void count_boxes(const FourBoxes *four, V3 p, V3 d, float energy, float *energy_of)
{
    float o[3] = { p.x, p.y, p.z }, inv[3] = { 1.0f / d.x, 1.0f / d.y, 1.0f / d.z };
    int32_t stack[STACK];
    int n = 0;

    stack[n++] = 0;
    while (n) {
        const FourBoxes *b = &four[stack[--n]];
        F4 near = f4(0, 0, 0, 0), far = f4(INFINITY, INFINITY, INFINITY, INFINITY);
        for (int a = 0; a < 3; a++) {
            F4 oo = f4(o[a], o[a], o[a], o[a]), ii = f4(inv[a], inv[a], inv[a], inv[a]);
            F4 s = f4_mul(f4_sub(f4_load_any(b->lo[a]), oo), ii);
            F4 t = f4_mul(f4_sub(f4_load_any(b->hi[a]), oo), ii);
            near = f4_max(f4_min(s, t), near);
            far = f4_min(f4_max(s, t), far);
        }
        for (int hit = f4_at_most(near, far); hit; hit &= hit - 1) {
            int32_t child = b->child[LOWEST_BIT(hit)];
            if (child < 0)
                energy_of[~child] += energy;
            else if (child > 0 && n < STACK)
                stack[n++] = child;
        }
    }
}

void lightcut_count(const LightCut *c, V3 p, V3 d, float energy, float *energy_of)
{
    if (c->four[0])
        count_boxes(c->four[0], p, d, energy, energy_of);
    if (c->four[1])
        count_boxes(c->four[1], v_all(0.0f), d, energy, energy_of);
    else if (c->of_cell) {
        uint16_t k = c->of_cell[sphere_cell(c->tree->lights->side, d)];
        if (k != NO_CLUSTER)
            energy_of[k] += energy;
    }
}

/* ---- the cut ---- */

static bool arrays_of(LightCut *c)
{
    float **array[] = { &c->x, &c->y, &c->z, &c->hx, &c->hy, &c->hz, &c->deep, &c->nx, &c->ny,
                        &c->nz, &c->turned, &c->size, &c->lum, &c->share };

    for (size_t k = 0; k < sizeof array / sizeof array[0]; k++)
        if (!(*array[k] = MEM_ARRAY(float, c->n)))
            return false;
    c->first = MEM_ARRAY(uint32_t, c->n + 1);
    c->node = MEM_ARRAY(uint32_t, c->n);
    c->above = MEM_ARRAY(CutNode, 2 * c->n);
    return c->first && c->node && c->above;
}

/* Appends the tree below a node down to the cut; the number of nodes so far. */
static uint32_t fill_above(LightCut *c, const Boxing *b, uint32_t node, uint32_t at)
{
    CutNode *n = &c->above[at];
    uint32_t end;

    n->cluster = cluster_at(b, node);
    if (n->cluster >= 0)
        return at + 1;
    end = fill_above(c, b, node + 1, at + 1);
    n->second = end;
    return fill_above(c, b, b->t->node[node].second, end);
}

static void fill(LightCut *c, const uint32_t *node)
{
    const LightTree *t = c->tree;
    Boxing boxing = { t, node, c->n, NULL };

    for (size_t k = 0; k < c->n; k++) {
        const LightNode *n = &t->node[node[k]];
        c->nbeyond += n->beyond;
        c->x[k] = n->centre.x;
        c->y[k] = n->centre.y;
        c->z[k] = n->centre.z;
        c->hx[k] = n->half.x;
        c->hy[k] = n->half.y;
        c->hz[k] = n->half.z;
        c->deep[k] = n->deep;
        c->nx[k] = n->normal.x;
        c->ny[k] = n->normal.y;
        c->nz[k] = n->normal.z;
        c->turned[k] = n->turned;
        c->size[k] = (float)n->size;
        c->lum[k] = n->lum;
        c->share[k] = (float)(n->sum / t->node[0].sum);
        c->node[k] = node[k];
        c->first[k] = n->first;
        c->first[k + 1] = n->first + n->count;
    }
    fill_above(c, &boxing, 0, 0);
}

static bool cells_of(LightCut *c)
{
    const PointLights *all = c->tree->lights;
    size_t cells = (size_t)all->side * all->side;

    if (!c->nbeyond)
        return true;
    c->of_cell = MEM_ARRAY(uint16_t, cells);
    if (!c->of_cell)
        return false;
    for (size_t i = 0; i < cells; i++)
        c->of_cell[i] = NO_CLUSTER;
    for (size_t k = 0; k < c->nbeyond; k++)
        for (uint32_t i = c->first[k]; i < c->first[k + 1]; i++)
            c->of_cell[all->p[c->tree->order[i]].cell] = (uint16_t)k;
    return true;
}

bool lightcut_init(LightCut *c, const LightTree *t, const CutRule *rule, bool boxes,
                   WithinCluster within)
{
    uint32_t node[CUT_MOST];

    memset(c, 0, sizeof *c);
    c->tree = t;
    c->within = within;
    c->n = lighttree_cut(t, rule, node);
    if (!c->n)
        return true;
    if (arrays_of(c)) {
        fill(c, node);
        if (boxes_of(c, node, false) && (boxes ? boxes_of(c, node, true) : cells_of(c)))
            return true;
    }
    lightcut_clear(c);
    return false;
}

void lightcut_clear(LightCut *c)
{
    float *array[] = { c->x, c->y, c->z, c->hx, c->hy, c->hz, c->deep, c->nx, c->ny, c->nz,
                       c->turned, c->size, c->lum, c->share };

    for (size_t k = 0; k < sizeof array / sizeof array[0]; k++)
        mem_free(array[k]);
    mem_free(c->first);
    mem_free(c->above);
    mem_free(c->node);
    mem_free(c->of_cell);
    mem_free(c->four[0]);
    mem_free(c->four[1]);
    memset(c, 0, sizeof *c);
}

/* ---- importance ---- */

#define MOST_SOLID (2.0f * PI_F)        /* errata 002.4 */
#define NEAR 4.0f               /* radii: within, 1 / d^2 changes by a factor of 2.8 */

/* Mean of max(0, x) for x from c - s to c + s; of all directions, if s is the sine of more. */
static inline float mean_cosine(float c, float s)
{
    float most = f_min(s, 1.001f), both = (c + most) * (c + most) / (4.0f * most);
    return c >= s ? c : c > -s ? both : 0.0f;
}

/* The area that lights show to a point in the direction -w from them, of the normal's length
 * `turned` (-1: all of the size) and the component `along` w; s is by how much their cosines may
 * differ. Lights whose normals do not agree are guessed at: above 0 wherever one of them may be. */
static inline float shown(float size, float turned, float along, float s)
{
    float agreed = turned * mean_cosine(-along / turned, s);
    float rest = f_max(size - turned, 0.0f) * 0.25f;
    return turned > 0.0f ? agreed + rest : size;
}

/* How far cluster k goes from its middle along n. */
static inline float reach(const LightCut *c, size_t k, V3 n)
{
    return fabsf(n.x) * c->hx[k] + fabsf(n.y) * c->hy[k] + fabsf(n.z) * c->hz[k];
}

/* The solid angle of cluster k from p, clamped; 1 / d in *inv and what it shows of its size. */
static inline float solid_angle(const LightCut *c, size_t k, V3 to, float *inv, float *part)
{
    float d2 = f_max(v_len2(to), 1e-30f), area;
    float along = c->nx[k] * to.x + c->ny[k] * to.y + c->nz[k] * to.z;

    *inv = 1.0f / sqrtf(d2);
    area = shown(c->size[k], c->turned[k], along * *inv, c->deep[k] * *inv + 1e-3f);
    *part = area / c->size[k];
    return f_min(area / d2, MOST_SOLID);
}

void lightcut_matt(const LightCut *c, V3 p, V3 n, float above, float below, float *weight)
{
    for (size_t k = 0; k < c->nbeyond; k++) {
        float cosine = n.x * c->x[k] + n.y * c->y[k] + n.z * c->z[k], s = reach(c, k, n) + 1e-3f;
        float up = mean_cosine(cosine, s), down = mean_cosine(-cosine, s);
        weight[k] += (above * up + below * down) * INV_PI * c->lum[k] * c->size[k];
    }
    for (size_t k = c->nbeyond; k < c->n; k++) {
        V3 to = { c->x[k] - p.x, c->y[k] - p.y, c->z[k] - p.z };
        float inv, part, solid = solid_angle(c, k, to, &inv, &part);
        float cosine = v_dot(n, to) * inv, s = reach(c, k, n) * inv + 1e-3f;
        float up = mean_cosine(cosine, s), down = mean_cosine(-cosine, s);
        weight[k] += (above * up + below * down) * INV_PI * c->lum[k] * solid;
    }
}

/* Solid angles of clusters as seen from p, clamped; what faces away counts little. */
static void solid_angles(const LightCut *c, V3 p, float *omega)
{
    for (size_t k = 0; k < c->nbeyond; k++)
        omega[k] = c->size[k];
    for (size_t k = c->nbeyond; k < c->n; k++) {
        V3 to = { c->x[k] - p.x, c->y[k] - p.y, c->z[k] - p.z };
        float inv, part;
        omega[k] = solid_angle(c, k, to, &inv, &part);
    }
}

#define EVIDENCE 1.5f

/* What share of a node's energy its first child is given: `one` and `other` rays fell into the
 * children, and q is the first one's share of the solid angle. That of the rays and of more of
 * them, spread evenly: `prior`, or so many that of a deviation from evenness by z standard
 * deviations of chance a part 1 - EVIDENCE / z^2 is left, and next to nothing if that is below 0
 * [JamesStein61]. */
static float share_of_first(float one, float other, float q, float prior)
{
    float n = one + other, away = one - n * q, chance = f_max(n * q * (1.0f - q), 1e-6f);
    float more = f_max(away * away - EVIDENCE * chance, 1e-3f * chance);
    float even = f_max(prior, n * EVIDENCE * chance / more);

    return (one + even * q) / (n + even);
}

/* Shares the root's energy out again, down to clusters: see the head of lightcut.h. */
static void spread_out(const LightCut *c, V3 p, float prior, float ray, float *energy)
{
    float has[2 * CUT_MOST], solid[2 * CUT_MOST], omega[CUT_MOST], per_ray = 1.0f / ray;
    size_t n = 2 * c->n - 1;

    solid_angles(c, p, omega);
    for (size_t i = n; i-- > 0;) {
        const CutNode *node = &c->above[i];
        has[i] = node->second ? has[i + 1] + has[node->second] : energy[node->cluster];
        solid[i] = node->second ? solid[i + 1] + solid[node->second] : omega[node->cluster];
    }
    for (size_t i = 0; i < n; i++) {    /* has[i] becomes what it is given */
        const CutNode *node = &c->above[i];
        float one, q;
        if (!node->second) {
            energy[node->cluster] = has[i];
            continue;
        }
        q = solid[i] > 0.0f ? solid[i + 1] / solid[i] : 0.5f;
        one = has[i] * share_of_first(has[i + 1] * per_ray, has[node->second] * per_ray, q, prior);
        has[node->second] = has[i] - one;
        has[i + 1] = one;
    }
}

void lightcut_lobes(const LightCut *c, V3 p, float prior, float one, float *energy)
{
    if (prior > 0.0f && one > 0.0f)
        spread_out(c, p, prior, one, energy);
    for (size_t k = 0; k < c->nbeyond; k++)
        energy[k] *= c->lum[k];
    for (size_t k = c->nbeyond; k < c->n; k++) {
        V3 to = { c->x[k] - p.x, c->y[k] - p.y, c->z[k] - p.z };
        float inv, part;
        solid_angle(c, k, to, &inv, &part);
        energy[k] *= c->lum[k] * f_min(1.0f, 8.0f * part);      /* nothing, of what faces away */
    }
}

float lightcut_middle(const LightCut *c, size_t k, V3 p, V3 *wi)
{
    V3 at = { c->x[k], c->y[k], c->z[k] };
    float inv, part;

    if (k < c->nbeyond) {
        *wi = at;
        return c->size[k];
    }
    at = v_sub(at, p);
    *wi = v_unit(at);
    return solid_angle(c, k, at, &inv, &part);
}

/* ---- the choice ---- */

void lightcut_normalize(const LightCut *c, float safe, float *weight)
{
    double sum = 0.0;
    float scale;

    for (size_t k = 0; k < c->n; k++)
        sum += (double)weight[k];
    if (!(sum > 0.0) || sum - sum != 0.0)
        safe = 1.0f;
    scale = safe < 1.0f ? (float)((1.0 - (double)safe) / sum) : 0.0f;
    for (size_t k = 0; k < c->n; k++)
        weight[k] = (scale > 0.0f ? scale * weight[k] : 0.0f) + safe * c->share[k];
}

/* ---- within a cluster ---- */

/* The share of a light in a run of the tree's order. */
static double pmf_in(const LightCut *c, size_t first, size_t count, size_t at)
{
    const double *running = c->tree->running;

    if (c->within == WITHIN_EVEN)
        return 1.0 / (double)count;
    return (running[at + 1] - running[at]) / (running[first + count] - running[first]);
}

/* The light where what is left, in [0, 1), falls. */
static size_t place_in(const LightCut *c, size_t first, size_t count, double left)
{
    const double *running = c->tree->running;
    size_t lo = first, hi = first + count - 1;
    double x = running[lo] + left * (running[hi + 1] - running[lo]);

    if (c->within == WITHIN_EVEN)
        return lo + (size_t)d_min((double)count * left, (double)(count - 1));
    while (lo < hi) {           /* the last whose running sum is at most x */
        size_t middle = lo + (hi - lo + 1) / 2;
        if (running[middle] <= x)
            lo = middle;
        else
            hi = middle - 1;
    }
    return lo;
}

/* By how much cosines of directions to a node's lights may differ from that of its centre, which is
 * at `to`, 1 / inv away: along the normal in question they are up to `along` from it. That over the
 * distance of the nearest place of the box, where light is most; but no more than for the ball. */
static inline float differ(const LightNode *n, float along, V3 to, float inv)
{
    V3 gap = v_max(v_sub(v_abs(to), n->half), v_all(0.0f));
    float ball = n->radius * inv, d2 = v_len2(gap);

    return (along * along < ball * ball * d2 ? along / sqrtf(d2) : ball) + 1e-3f;
}

/* What a node would bring to the point, about; above 0 unless all of it is below the horizon. */
static float brings(const LightNode *n, const LitPoint *lit)
{
    V3 to = v_sub(n->centre, lit->p);
    float d2 = f_max(v_len2(to), 1e-30f), inv = 1.0f / sqrtf(d2), r = n->radius;
    float s = differ(n, n->deep, to, inv), cosine = 1.0f;

    if (v_len2(lit->n) > 0.0f)
        cosine = mean_cosine(v_dot(lit->n, to) * inv,
                             differ(n, v_dot(v_abs(lit->n), n->half), to, inv));
    return n->lum * cosine * shown((float)n->size, n->turned, v_dot(n->normal, to) * inv, s) /
           f_max(d2, r * r);
}

/* The chance of the first child. */
static double first_child(const LightTree *t, uint32_t node, const LitPoint *lit)
{
    const LightNode *one = &t->node[node + 1], *other = &t->node[t->node[node].second];
    double a = (double)brings(one, lit), b = (double)brings(other, lit);

    return a + b > 0.0 && a + b < 1e300 ? a / (a + b) : one->sum / (one->sum + other->sum);
}

/* So near that lights of the node differ by more than their light: from farther away a node is no
 * longer divided. */
static bool is_near(const LightNode *n, const LitPoint *lit)
{
    return n->second && v_len2(v_sub(n->centre, lit->p)) < NEAR * NEAR * n->radius * n->radius;
}

/* Where the way down to light `at` ends, and the chance of taking it. */
static uint32_t way_down(const LightTree *t, uint32_t node, const LitPoint *lit, size_t at,
                         double *pmf)
{
    while (is_near(&t->node[node], lit)) {
        double one = first_child(t, node, lit);
        bool first = at < t->node[t->node[node].second].first;
        *pmf *= first ? one : 1.0 - one;
        node = first ? node + 1 : t->node[node].second;
    }
    return node;
}

/* The same by chance: *left is in [0, 1), and what is left of it. */
static uint32_t go_down(const LightTree *t, uint32_t node, const LitPoint *lit, double *left,
                        double *pmf)
{
    while (is_near(&t->node[node], lit)) {
        double one = first_child(t, node, lit);
        if (*left < one) {
            *left /= one;
            *pmf *= one;
            node++;
        } else {
            *left = (*left - one) / (1.0 - one);
            *pmf *= 1.0 - one;
            node = t->node[node].second;
        }
        *left = d_min(*left, 1.0 - 0x1p-53);
    }
    return node;
}

static bool goes_down(const LightCut *c, size_t k)
{
    return c->within == WITHIN_BY_TREE && k >= c->nbeyond;
}

float lightcut_pmf(const LightCut *c, const LitPoint *lit, const float *pmf_of, size_t k, size_t at)
{
    uint32_t node = c->node[k];
    double pmf = (double)pmf_of[k];

    if (goes_down(c, k))
        node = way_down(c->tree, node, lit, at, &pmf);
    return (float)(pmf * pmf_in(c, c->tree->node[node].first, c->tree->node[node].count, at));
}

size_t lightcut_choose(const LightCut *c, const LitPoint *lit, const float *pmf_of, double x,
                       size_t *k, double *before, float *pmf)
{
    const LightNode *n;
    double left, chance;
    uint32_t node;
    size_t at;

    while (*k + 1 < c->n && *before + (double)pmf_of[*k] <= x)
        *before += (double)pmf_of[(*k)++];
    chance = (double)pmf_of[*k];
    left = chance > 0.0 ? (x - *before) / chance : 0.0;
    left = d_min(d_max(left, 0.0), 1.0 - 0x1p-53);
    node = c->node[*k];
    if (goes_down(c, *k))
        node = go_down(c->tree, node, lit, &left, &chance);
    n = &c->tree->node[node];
    at = place_in(c, n->first, n->count, left);
    *pmf = (float)(chance * pmf_in(c, n->first, n->count, at));
    return c->tree->order[at];
}
