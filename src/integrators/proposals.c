/* proposals.c -- the code of `proposals.h`. */
#include "integrators/proposals.h"

#include "base/mem.h"

bool proposals_init(Proposals *p, const Film *f, bool median, int side)
{
    const FilterKind *box = kind_find(filters, "box");
    uint32_t crop[4] = { f->x0, f->y0, f->x1, f->y1 };
    Opts none;

    opts_default(&none, box->info.options);
    filter_init(&p->box, box, &none);
    p->median = median;
    p->side = side | 1;
    return film_init(&p->film, f->full_w, f->full_h, crop, 1) && film_accepts_splats(&p->film);
}

void proposals_clear(Proposals *p) { film_clear(&p->film); }

/* The middle one; the higher of the two of an even number. */
static float median_of(float *v, int n)
{
    for (int i = 1; i < n; i++) {
        float x = v[i];
        int k = i;
        for (; k > 0 && v[k - 1] > x; k--)
            v[k] = v[k - 1];
        v[k] = x;
    }
    return v[n / 2];
}

/* Over the part of the square around pixel (x, y) that is within the window. */
static float expected(const Proposals *p, const Image *counts, int x, int y)
{
    float v[PROPOSALS_SIDE * PROPOSALS_SIDE], sum = 0.0f;
    int reach = p->side / 2, n = 0;

    for (int j = y - reach; j <= y + reach; j++)
        for (int i = x - reach; i <= x + reach; i++)
            if (i >= 0 && j >= 0 && i < (int)counts->w && j < (int)counts->h) {
                v[n] = counts->pixels[(size_t)j * counts->w + (size_t)i].r;
                sum += v[n++];
            }
    return p->median ? median_of(v, n) : sum / (float)n;
}

bool proposals_even_out(const Proposals *p, Film *f)
{
    float *gain = MEM_ARRAY(float, (size_t)f->w * f->h);
    Image counts = { 0 };

    if (!gain || !image_init(&counts, f->w, f->h)) {
        mem_free(gain);
        return false;
    }
    film_picture(&p->film, 0, &counts);
    for (size_t i = 0; i < (size_t)f->w * f->h; i++) {
        float counted = counts.pixels[i].r;
        gain[i] = counted > 0.0f
                      ? expected(p, &counts, (int)(i % f->w), (int)(i / f->w)) / counted : 1.0f;
    }
    image_clear(&counts);
    film_multiply_splats(f, gain);
    return true;
}
