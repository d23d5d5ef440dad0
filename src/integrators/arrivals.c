/* arrivals.c -- see arrivals.h. */
#include "integrators/arrivals.h"

#include "base/error.h"
#include "base/mem.h"

#include <string.h>

enum { BEGIN, COUNT, ARRANGE, PLACE, SORT };

bool arrivals_init(Arrivals *a, size_t size, uint64_t paths)
{
    uint64_t batches = (paths + ARRIVALS_BATCH - 1) / ARRIVALS_BATCH;

    memset(a, 0, sizeof *a);
    if (batches > SIZE_MAX)
        return err_memory(SIZE_MAX);
    a->batches = MEM_ARRAY(ArrivalBatch, (size_t)batches);
    if (!a->batches)
        return false;
    a->size = size;
    a->paths = paths;
    a->nbatches = (size_t)batches;
    return true;
}

void arrivals_clear(Arrivals *a)
{
    for (size_t i = 0; i < a->nbatches; i++)
        mem_free(a->batches[i].records);
    mem_free(a->batches);
    pointgrid_clear(&a->grid);
    memset(a, 0, sizeof *a);
}

bool arrivals_add(ArrivalBatch *b, size_t size, const void *record)
{
    if (!mem_grow(&b->records, &b->cap, b->n + 1, size))
        return false;
    memcpy(b->records + b->n++ * size, record, size);
    return true;
}

size_t arrivals_found(const Arrivals *a)
{
    size_t n = 0;

    for (size_t i = 0; i < a->nbatches; i++)
        n += a->batches[i].n;
    return n;
}

/* The number of a record has that of its batch in its upper bits. */
static bool begin(Arrivals *a, float edge)
{
    size_t most = 0;

    for (size_t i = 0; i < a->nbatches; i++)
        most = a->batches[i].n > most ? a->batches[i].n : most;
    for (a->bits = 0; most >> a->bits; a->bits++) {}
    if (a->nbatches && (uint64_t)(a->nbatches - 1) > UINT32_MAX >> a->bits)
        return err_at((Place){ NULL, 0, 0 }, "light arrives in more places than can be numbered, "
                      "expected fewer light paths a pass");
    return pointgrid_begin(&a->grid, arrivals_found(a), a->nbatches, edge);
}

uint64_t arrivals_units(const Arrivals *a, int phase)
{
    return phase == BEGIN || phase == ARRANGE ? 1 : phase == SORT ? POINTGRID_PARTS : a->nbatches;
}

bool arrivals_run(Arrivals *a, int phase, uint64_t unit, float edge)
{
    const ArrivalBatch *b = phase == SORT ? NULL : &a->batches[unit];
    const float *at = b ? (const float *)(const void *)b->records : NULL;

    switch (phase) {
    case BEGIN: return begin(a, edge);
    case COUNT: pointgrid_count(&a->grid, (size_t)unit, at, a->size, b->n); break;
    case ARRANGE: pointgrid_arrange(&a->grid); break;
    case PLACE:
        pointgrid_place(&a->grid, (size_t)unit, at, a->size, b->n, (uint32_t)unit << a->bits);
        break;
    default: pointgrid_sort(&a->grid, (uint32_t)unit);
    }
    return true;
}
