/* refs.c -- primitives being sorted into a tree. See refs.h. */
#include "accel/refs.h"

#include <string.h>

enum { BINS = 16 };

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

void refs_bounds(const Ref *refs, size_t n, Box *box, Box *centres)
{
    *box = *centres = box_empty();
    for (size_t i = 0; i < n; i++) {
        *box = box_join(*box, refs[i].box);
        *centres = box_point(*centres, box_centre(refs[i].box));
    }
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

typedef struct { Box box; uint32_t n; } Bin;

static int bin_of(const Ref *r, int axis, float lo, float scale)
{
    float b = (ref_centre(r, axis) - lo) * scale;       /* no number if the extent overflows */
    return b >= (float)BINS ? BINS - 1 : b > 0.0f ? (int)b : 0;
}

/* Cost of n primitives that are tested `block` at a time. */
static float groups(uint32_t n, size_t block) { return (float)((n + block - 1) / block); }

/* Least cost of a split between bins: sum over sides of area times cost. *cut: first bin of the
 * right side. */
static float best_cut(const Bin *bins, size_t block, int *cut)
{
    float cost[BINS], best = INFINITY;
    Box b = box_empty();
    uint32_t n = 0;

    for (int i = BINS - 1; i > 0; i--) {
        b = box_join(b, bins[i].box);
        n += bins[i].n;
        cost[i] = n ? box_area(b) * groups(n, block) : INFINITY;
    }
    b = box_empty();
    n = 0;
    for (int i = 1; i < BINS; i++) {
        b = box_join(b, bins[i - 1].box);
        n += bins[i - 1].n;
        if (n && box_area(b) * groups(n, block) + cost[i] < best) {
            best = box_area(b) * groups(n, block) + cost[i];
            *cut = i;
        }
    }
    return best;
}

size_t refs_split_sah(Ref *refs, size_t n, Box box, Box centres, size_t leaf, size_t block)
{
    Bin bins[3][BINS];
    float scale[3], lo[3], best = INFINITY;
    int axis = -1, cut = 0;
    size_t i = 0, j = n;

    for (int k = 0; k < 3; k++) {
        float extent = v_axis(centres.hi, k) - v_axis(centres.lo, k);
        lo[k] = v_axis(centres.lo, k);
        scale[k] = extent > 0.0f && is_finite((float)BINS / extent) ? (float)BINS / extent : 0.0f;
        for (int b = 0; b < BINS; b++)
            bins[k][b] = (Bin){ box_empty(), 0 };
    }
    for (size_t r = 0; r < n; r++)
        for (int k = 0; k < 3; k++) {
            Bin *b = &bins[k][bin_of(&refs[r], k, lo[k], scale[k])];
            b->box = box_join(b->box, refs[r].box);
            b->n++;
        }
    for (int k = 0; k < 3; k++) {
        int at = 0;
        float cost = scale[k] > 0.0f ? best_cut(bins[k], block, &at) : INFINITY;
        if (cost < best) {
            best = cost;
            axis = k;
            cut = at;
        }
    }
    if (n <= leaf && !(best + box_area(box) < box_area(box) * groups((uint32_t)n, block)))
        return 0;
    if (axis < 0)                               /* all centres in one place, or no area at all */
        return refs_split_median(refs, n, centres);
    while (i < j) {
        if (bin_of(&refs[i], axis, lo[axis], scale[axis]) < cut)
            i++;
        else {
            Ref swap = refs[i];
            refs[i] = refs[--j];
            refs[j] = swap;
        }
    }
    return i > 0 && i < n ? i : refs_split_median(refs, n, centres);
}
