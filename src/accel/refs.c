/* refs.c -- primitives being sorted into a tree. See refs.h. */
#include "accel/refs.h"

#include "base/bits.h"

/* FEW refs get fewer bins, which are sooner empty and sooner compared; MANY: see fill_rows. */
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
    uint32_t bits = bits_of_float(ref_centre(r, axis) + 0.0f);  /* -0 counts as 0 */

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

/* A box in one vector, lo and -hi in the first three lanes of its halves: to join two is one
 * minimum. Nothing beyond the ref is read, which may be another thread's. */
INLINE F8 ref_box(const Ref *r)
{
    F8 upper = f8_join(f4_all(0.0f), f4(-0.0f, -0.0f, -0.0f, 0.0f));
    return f8_flip(f8_join(ref_lo(r), ref_hi(r)), upper);
}

INLINE F8 box8_none(void) { return f8_all(INFINITY); }

INLINE Box box8_box(F8 b)
{
    float v[8];
    f8_store(v, b);
    return (Box){ v3(v[0], v[1], v[2]), v3(-v[4], -v[5], -v[6]) };
}

/* box_area() of it: both factors of each product have their signs turned. */
INLINE float box8_area(F8 b)
{
    float v[8], x, y, z;
    f8_store(v, b);
    x = v[0] + v[4];
    y = v[1] + v[5];
    z = v[2] + v[6];
    return 2.0f * (x * y + y * z + z * x);
}

/* By bin: the boxes of what is in it, and how many they are. */
typedef struct { F8 box[BINS]; uint32_t n[BINS]; } Row;

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

/* Cost of n primitives that are tested 2^shift at a time; divisions would take long. */
INLINE float groups(uint32_t n, int shift)
{
    return (float)(((uint64_t)n + ((uint32_t)1 << shift) - 1) >> shift);
}

/* A cut along an axis: what comes before bin `cut` is on the left. */
typedef struct { float cost; int axis, cut; Box left, right; } Cut;

/* The cheapest cut between bins of an axis, if it is cheaper than *best. */
static void best_cut(const Row *row, int count, int shift, int axis, Cut *best)
{
    F8 right[BINS], left = box8_none();
    float cost[BINS];
    uint32_t n = 0;

    for (int i = count - 1; i > 0; i--) {
        left = right[i] = f8_min(row->box[i], left);
        n += row->n[i];
        cost[i] = n ? box8_area(left) * groups(n, shift) : INFINITY;
    }
    n = 0;
    left = box8_none();
    for (int i = 1; i < count; i++) {
        float sum;
        left = f8_min(row->box[i - 1], left);
        n += row->n[i - 1];
        if (row->n[i - 1] == 0)
            continue;
        sum = box8_area(left) * groups(n, shift) + cost[i];
        if (sum < best->cost)
            *best = (Cut){ sum, axis, i, box8_box(left), box8_box(right[i]) };
    }
}

static void rows_empty(const Bins *b, Row row[3])
{
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < b->count; i++) {
            row[k].box[i] = box8_none();
            row[k].n[i] = 0;
        }
}

INLINE void rows_add(const Bins *b, Row row[3], const Ref *r)
{
    F4 at = bins_at(b, middle(ref_lo(r), ref_hi(r)));
    F8 box = ref_box(r);

    for (int k = 0; k < 3; k++) {
        int i = (int)f4_lane(at, k);
        row[k].box[i] = f8_min(box, row[k].box[i]);
        row[k].n[i]++;
    }
}

/* Neighbours often are in the same bin, and would wait for each other: of many refs every second
 * goes to bins of its own, which are joined in the end. */
static void fill_rows(const Ref *refs, size_t n, const Bins *b, Row row[3])
{
    Row second[3];
    size_t pairs = n > MANY ? n / 2 : 0;

    rows_empty(b, row);
    for (size_t r = 2 * pairs; r < n; r++)
        rows_add(b, row, &refs[r]);
    if (!pairs)
        return;
    rows_empty(b, second);
    for (size_t r = 0; r < 2 * pairs; r += 2) {
        rows_add(b, row, &refs[r]);
        rows_add(b, second, &refs[r + 1]);
    }
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < b->count; i++) {
            row[k].box[i] = f8_min(second[k].box[i], row[k].box[i]);
            row[k].n[i] += second[k].n[i];
        }
}

static Cut find_cut(const Ref *refs, size_t n, const Bins *b, int shift)
{
    Cut best = { INFINITY, -1, 0, { { 0, 0, 0 }, { 0, 0, 0 } }, { { 0, 0, 0 }, { 0, 0, 0 } } };
    Row row[3];

    fill_rows(refs, n, b, row);
    for (int k = 0; k < 3; k++)
        if (f4_lane(b->scale, k) > 0.0f)
            best_cut(&row[k], b->count, shift, k, &best);
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

/* In pieces that do not overlap: what was stored a moment ago is loaded again in the same pieces,
 * for which processors need not wait. */
INLINE void refs_exchange(Ref *a, Ref *b)
{
    Box x = a->box, y = b->box;         /* tcc 0.9.27 gets copies by memcpy wrong here */
    uint32_t p = a->prim, q = b->prim;

    a->box = y;
    b->box = x;
    a->prim = q;
    b->prim = p;
}

/* Puts what lies left of the cut before what does not; returns how many the former are. */
static size_t divide_at(Ref *refs, size_t n, const Bins *b, const Cut *c, Extent half[2])
{
    size_t k = 0;

    for (size_t i = 0; i < n; i++) {            /* no branch: it would be taken at random */
        F4 centre = middle(ref_lo(&refs[i]), ref_hi(&refs[i]));
        int left = (int)f4_lane(bins_at(b, centre), c->axis) < c->cut;
        refs_exchange(&refs[i], &refs[k]);
        k += (size_t)left;
    }
    half[0] = (Extent){ c->left, centres_of(refs, k) };
    half[1] = (Extent){ c->right, centres_of(refs + k, n - k) };
    return k;
}

size_t refs_split_sah(Ref *refs, size_t n, const Extent *whole, size_t leaf, int shift,
                      Extent half[2])
{
    Bins bins = bins_over(whole->centres, n);
    Cut cut = find_cut(refs, n, &bins, shift);
    float area = box_area(whole->box);
    size_t k;

    if (n <= leaf && !(cut.cost + area < area * groups((uint32_t)n, shift)))
        return 0;
    if (cut.axis >= 0)
        return divide_at(refs, n, &bins, &cut, half);
    k = refs_split_median(refs, n, whole->centres);     /* all in one place, or no area at all */
    half[0] = refs_extent(refs, k);
    half[1] = refs_extent(refs + k, n - k);
    return k;
}
