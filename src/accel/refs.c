/* refs.c -- primitives being sorted into a tree. See refs.h. */
#include "accel/refs.h"

#include <string.h>

enum { BINS = 16, FEW = 24, BINS_FEW = 8, MANY = 256 };

void refs_init(Ref *refs, const Geometry *g)
{
    uint32_t n = geometry_prims(g);

    for (uint32_t i = 0; i < n; i++)
        refs[i] = (Ref){ geometry_box(g, i), i };
}

static int longest_axis(Box b)
{
    V3 d = v_sub(b.hi, b.lo);
    return d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
}

static float ref_centre(const Ref *r, int axis)
{
    return 0.5f * v_axis(r->box.lo, axis) + 0.5f * v_axis(r->box.hi, axis);
}

/* Boxes as two vectors, of which the fourth lane is of no concern. */
typedef struct { F4 lo, hi; } Bounds;

INLINE Bounds bounds_none(void)
{
    return (Bounds){ f4_all(INFINITY), f4_all(-INFINITY) };
}

INLINE void bounds_join(Bounds *b, F4 lo, F4 hi)
{
    b->lo = f4_min(lo, b->lo);
    b->hi = f4_max(hi, b->hi);
}

INLINE Box bounds_box(Bounds b)
{
    return (Box){ v3(f4_lane(b.lo, 0), f4_lane(b.lo, 1), f4_lane(b.lo, 2)),
                  v3(f4_lane(b.hi, 0), f4_lane(b.hi, 1), f4_lane(b.hi, 2)) };
}

/* What follows the corner in the ref is read, too. */
INLINE F4 ref_lo(const Ref *r) { return f4_load_any(&r->box.lo.x); }
INLINE F4 ref_hi(const Ref *r) { return f4_load_any(&r->box.hi.x); }
INLINE F4 middle(F4 lo, F4 hi)
{
    F4 half = f4_all(0.5f);
    return f4_add(f4_mul(half, lo), f4_mul(half, hi));
}

Extent refs_extent(const Ref *refs, size_t n)
{
    Bounds all = bounds_none(), centres = all;

    for (size_t i = 0; i < n; i++) {
        F4 lo = ref_lo(&refs[i]), hi = ref_hi(&refs[i]), c = middle(lo, hi);
        bounds_join(&all, lo, hi);
        bounds_join(&centres, c, c);
    }
    return (Extent){ bounds_box(all), bounds_box(centres) };
}

/* The place of the centre along the axis as a number of the same order, with the primitive's number
 * below it: no two are equal, so the tree does not depend on the order of refs. */
static uint64_t ref_key(const Ref *r, int axis)
{
    float centre = ref_centre(r, axis) + 0.0f;          /* -0 counts as 0 */
    uint32_t bits;

    memcpy(&bits, &centre, 4);
    bits ^= bits >> 31 ? 0xFFFFFFFFu : 0x80000000u;
    return (uint64_t)bits << 32 | r->prim;
}

/* Afterwards refs[0..k) come before refs[k..n) along the axis. What is bisected is the range of the
 * keys, so that no order and no spacing of the input takes more than 64 rounds. */
static void select_refs(Ref *refs, size_t n, size_t k, int axis)
{
    uint64_t least = UINT64_MAX, most = 0;
    size_t lo = 0, hi = n, mid = n;

    for (size_t i = 0; i < n; i++) {
        uint64_t key = ref_key(&refs[i], axis);
        least = key < least ? key : least;
        most = key > most ? key : most;
    }
    while (mid != k) {
        uint64_t pivot = least + (most - least) / 2;
        size_t end = hi;
        for (mid = lo; mid < end;) {
            Ref swap = refs[mid];
            if (ref_key(&swap, axis) <= pivot)
                mid++;
            else {
                refs[mid] = refs[--end];
                refs[end] = swap;
            }
        }
        if (k < mid) {
            hi = mid;
            most = pivot;
        } else {
            lo = mid;
            least = pivot + 1;
        }
    }
}

void refs_divide(Ref *refs, size_t n, size_t k, Box centres)
{
    select_refs(refs, n, k, longest_axis(centres));
}

size_t refs_split_median(Ref *refs, size_t n, Box centres)
{
    refs_divide(refs, n, n / 2, centres);
    return n / 2;
}

size_t refs_split_middle(Ref *refs, size_t n, Box centres)
{
    int axis = longest_axis(centres);
    float x = 0.5f * v_axis(centres.lo, axis) + 0.5f * v_axis(centres.hi, axis);
    size_t i = 0, j = n;

    while (i < j) {
        if (ref_centre(&refs[i], axis) < x)
            i++;
        else {
            Ref swap = refs[i];
            refs[i] = refs[--j];
            refs[j] = swap;
        }
    }
    return i > 0 && i < n ? i : refs_split_median(refs, n, centres);
}

/* ---- the surface area heuristic ---- */

typedef struct { Bounds bounds; uint32_t n; } Bin;

/* From a place along an axis to one of `count` bins. */
typedef struct { F4 lo, scale, last; int count; } Bins;

static Bins bins_over(Box centres, size_t n)
{
    float lo[4] = { 0 }, scale[4] = { 0 };
    int count = n > FEW ? BINS : BINS_FEW;

    for (int k = 0; k < 3; k++) {
        float extent = v_axis(centres.hi, k) - v_axis(centres.lo, k), s = (float)count / extent;
        lo[k] = v_axis(centres.lo, k);
        scale[k] = extent > 0.0f && is_finite(s) ? s : 0.0f;
    }
    return (Bins){ f4_load_any(lo), f4_load_any(scale), f4_all((float)(count - 1)), count };
}

/* The bins of a place on all axes. What is no number, from an extent that overflows, counts as in
 * the first. */
INLINE F4 bins_at(const Bins *b, F4 centre)
{
    F4 at = f4_mul(f4_sub(centre, b->lo), b->scale);
    return f4_min(f4_max(at, f4_all(0.0f)), b->last);
}

/* Cost of n primitives that are tested `block` at a time. */
static float groups(uint32_t n, size_t block) { return (float)((n + block - 1) / block); }

/* A cut along an axis: what comes before bin `cut` is on the left. */
typedef struct { float cost; int axis, cut; Box left, right; } Cut;

/* The cheapest cut between bins of an axis, if it is cheaper than *best. */
static void best_cut(const Bin *bins, int count, size_t block, int axis, Cut *best)
{
    Bounds right[BINS], left = bounds_none();
    float cost[BINS];
    uint32_t n = 0;

    right[count - 1] = left;
    for (int i = count - 1; i > 0; i--) {
        right[i] = i + 1 < count ? right[i + 1] : left;
        bounds_join(&right[i], bins[i].bounds.lo, bins[i].bounds.hi);
        n += bins[i].n;
        cost[i] = n ? box_area(bounds_box(right[i])) * groups(n, block) : INFINITY;
    }
    n = 0;
    for (int i = 1; i < count; i++) {
        float sum;
        bounds_join(&left, bins[i - 1].bounds.lo, bins[i - 1].bounds.hi);
        n += bins[i - 1].n;
        if (bins[i - 1].n == 0)
            continue;
        sum = box_area(bounds_box(left)) * groups(n, block) + cost[i];
        if (sum < best->cost)
            *best = (Cut){ sum, axis, i, bounds_box(left), bounds_box(right[i]) };
    }
}

static void bins_empty(const Bins *b, Bin bins[3][BINS])
{
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < b->count; i++)
            bins[k][i] = (Bin){ bounds_none(), 0 };
}

INLINE void bins_add(const Bins *b, Bin bins[3][BINS], const Ref *r)
{
    F4 lo = ref_lo(r), hi = ref_hi(r), at = bins_at(b, middle(lo, hi));

    for (int k = 0; k < 3; k++) {
        Bin *bin = &bins[k][(int)f4_lane(at, k)];
        bounds_join(&bin->bounds, lo, hi);
        bin->n++;
    }
}

/* Neighbours often are in the same bin, and would wait for each other: of many refs every second
 * goes to bins of its own, which are joined in the end. */
static void fill_bins(const Ref *refs, size_t n, const Bins *b, Bin bins[3][BINS])
{
    Bin second[3][BINS];
    size_t pairs = n > MANY ? n / 2 : 0;

    bins_empty(b, bins);
    for (size_t r = 2 * pairs; r < n; r++)
        bins_add(b, bins, &refs[r]);
    if (!pairs)
        return;
    bins_empty(b, second);
    for (size_t r = 0; r < 2 * pairs; r += 2) {
        bins_add(b, bins, &refs[r]);
        bins_add(b, second, &refs[r + 1]);
    }
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < b->count; i++) {
            bounds_join(&bins[k][i].bounds, second[k][i].bounds.lo, second[k][i].bounds.hi);
            bins[k][i].n += second[k][i].n;
        }
}

static Cut find_cut(const Ref *refs, size_t n, const Bins *b, size_t block)
{
    Cut best = { INFINITY, -1, 0, { { 0, 0, 0 }, { 0, 0, 0 } }, { { 0, 0, 0 }, { 0, 0, 0 } } };
    Bin bins[3][BINS];

    fill_bins(refs, n, b, bins);
    for (int k = 0; k < 3; k++)
        if (f4_lane(b->scale, k) > 0.0f)
            best_cut(bins[k], b->count, block, k, &best);
    return best;
}

static Box centres_of(const Ref *refs, size_t n)
{
    Bounds all = bounds_none();

    for (size_t i = 0; i < n; i++) {
        F4 c = middle(ref_lo(&refs[i]), ref_hi(&refs[i]));
        bounds_join(&all, c, c);
    }
    return bounds_box(all);
}

/* Puts what lies left of the cut before what does not; returns how many the former are. */
static size_t divide_at(Ref *refs, size_t n, const Bins *b, const Cut *c, Extent half[2])
{
    size_t k = 0;

    for (size_t i = 0; i < n; i++) {            /* no branch: it would be taken at random */
        F4 centre = middle(ref_lo(&refs[i]), ref_hi(&refs[i]));
        int left = (int)f4_lane(bins_at(b, centre), c->axis) < c->cut;
        Ref swap = refs[i];
        refs[i] = refs[k];
        refs[k] = swap;
        k += (size_t)left;
    }
    half[0] = (Extent){ c->left, centres_of(refs, k) };
    half[1] = (Extent){ c->right, centres_of(refs + k, n - k) };
    return k;
}

size_t refs_split_sah(Ref *refs, size_t n, const Extent *whole, size_t leaf, size_t block,
                      Extent half[2])
{
    Bins bins = bins_over(whole->centres, n);
    Cut cut = find_cut(refs, n, &bins, block);
    float area = box_area(whole->box);
    size_t k;

    if (n <= leaf && !(cut.cost + area < area * groups((uint32_t)n, block)))
        return 0;
    if (cut.axis >= 0)
        return divide_at(refs, n, &bins, &cut, half);
    k = refs_split_median(refs, n, whole->centres);     /* all in one place, or no area at all */
    half[0] = refs_extent(refs, k);
    half[1] = refs_extent(refs + k, n - k);
    return k;
}
