/* merge.c -- adds shares of a render, or renders with different seeds, to one picture.
 *
 * Sums        are exact, so the order of the parts does not matter, and where shares have samples
 *             of one sequence, their sum has the bits of the render that was shared.
 * Same render Texts (see state.c) are the same but for seed and share. No two parts may have the
 *             same numbers: the picture would pass for a better one than it is.
 * Noise       Parts are independent, or better than that, so the variance of the sum is the mean of
 *             theirs, weighed by the squares of their shares in the samples. */
#include "render/merge.h"

#include "base/number.h"
#include "base/text.h"

#include <string.h>

void merge_clear(Merge *m)
{
    film_clear(&m->film);
    mem_free(m->text.text);
    mem_free(m->parts);
    memset(m, 0, sizeof *m);
}

/* ---- texts ---- */

static bool begins(Word line, const char *with)
{
    size_t n = strlen(with);
    return line.n >= n && !memcmp(line.s, with, n);
}

/* The next line that tells what is rendered; seed and share go to *of. False: there is none. */
static bool next_line(Text *t, PartOf *of, Word *line)
{
    Text l;

    while (text_line(t, &l)) {
        *line = (Word){ l.at, (size_t)(l.end - l.at) };
        if (begins(*line, "seed "))
            word_copy(of->seed, sizeof of->seed, (Word){ line->s + 5, line->n - 5 });
        else if (begins(*line, "shard ")) {
            int64_t i = 0, n = 0;
            size_t took = number_int(line->s + 6, l.end, &i, NULL);
            if (line->n > 7 + took)
                number_int(line->s + 7 + took, l.end, &n, NULL);
            of->shard = i > 0 && i <= n ? (uint32_t)i - 1 : 0;
            of->shards = n > 0 && n <= INT32_MAX ? (uint32_t)n : 0;
        } else
            return true;
    }
    *line = (Word){ "", 0 };
    return false;
}

/* Whether the part is of the same render as those before; its numbers go to *of. */
static bool same_render(const Merge *m, const StateHead *h, const char *path, PartOf *of)
{
    char his[200], ours[200];
    Text a, b;
    PartOf first;
    Word x, y;

    text_init(&a, NULL, m->n ? m->text.text : h->text, m->n ? m->text.n : h->ntext);
    text_init(&b, NULL, h->text, h->ntext);
    memset(of, 0, sizeof *of);
    for (;;) {
        bool more = next_line(&a, &first, &x);
        if (!next_line(&b, of, &y) && !more)
            return true;
        if (x.n != y.n || memcmp(x.s, y.s, x.n))
            return err_at((Place){ path, 0, 0 }, "is of another render than the first part: it has "
                          "'%s', not '%s'", word_copy(his, sizeof his, y),
                          word_copy(ours, sizeof ours, x));
    }
}

static bool is_new(const Merge *m, const PartOf *of, const char *path)
{
    for (size_t i = 0; i < m->n; i++) {
        const PartOf *p = &m->parts[i];
        if (strcmp(p->seed, of->seed))
            continue;
        if (p->shards != of->shards)
            return err_at((Place){ path, 0, 0 }, "has the seed of another part, but is one of "
                          "another number of shares: they have samples in common");
        if (p->shard == of->shard)
            return err_at((Place){ path, 0, 0 }, "has the samples of another part (seed %s, share "
                          "%lu of %lu)", of->seed, (unsigned long)of->shard + 1,
                          (unsigned long)(of->shards ? of->shards : 1));
    }
    return true;
}

uint32_t merge_missing(const Merge *m)
{
    uint32_t missing = 0;

    for (size_t i = 0; i < m->n; i++) {
        uint32_t have = 0;
        bool first = true;
        for (size_t k = 0; k < m->n; k++)
            if (!strcmp(m->parts[k].seed, m->parts[i].seed)) {
                have++;
                first = first && k >= i;
            }
        if (first && m->parts[i].shards > have)
            missing += m->parts[i].shards - have;
    }
    return missing;
}

/* From the name of a layer, as "length.2". False: reported. */
static bool aov_of_layer(Aov *a, Word name)
{
    char text[AOV_NAME + 8];
    char *dot;

    word_copy(text, AOV_NAME, name);
    dot = strchr(text, '.');
    for (char *p = dot; p && *p; p++)
        *p = *p == '.' ? ':' : *p == '-' ? ',' : *p;
    return aov_parse(a, strcat(text, "=x.pfm"));
}

/* Of a variance: where that is which it is the variance of. */
static void find_whose(RenderSettings *s, Aov *a)
{
    for (int k = 0; k < s->naovs; k++)
        if (a->kind == AOV_VARIANCE && (int)s->aovs[k].kind == a->which)
            a->of = 1 + k;
}

bool merge_aovs(const Merge *m, RenderSettings *s)
{
    Text t, l;
    Word w;

    text_init(&t, NULL, m->text.text, m->text.n);
    while (text_line(&t, &l)) {
        if (!word_is(text_word(&l), "layers"))
            continue;
        while ((w = text_word(&l)).n && s->naovs < AOVS_MAX && s->naovs + 1 < m->film.layers)
            if (!aov_of_layer(&s->aovs[s->naovs++], w))
                return false;
    }
    for (int k = 0; k < s->naovs; k++) {
        s->aovs[k].file = NULL;
        find_whose(s, &s->aovs[k]);
    }
    return true;
}

bool merge_want(const Merge *m, RenderSettings *s, const char *text)
{
    Aov a;

    if (!aov_parse(&a, text))
        return false;
    if (a.kind == AOV_VARIANCE && m->film.splats)
        return err_usage("--aov variance: of a sum of parts with splats nobody knows it");
    for (int k = 0; k < s->naovs; k++)
        if (s->aovs[k].kind == a.kind && s->aovs[k].which == a.which && !s->aovs[k].file) {
            s->aovs[k].file = a.file;
            return true;
        }
    return err_usage("--aov %.*s: the parts were rendered without it", (int)strcspn(text, "="),
                     text);
}

/* ---- films ---- */

static bool film_of(Film *f, const StateHead *h, const char *path, const ReadLimits *limits)
{
    const FilmShape *p = &h->shape;

    if ((uint64_t)(p->crop[2] - p->crop[0]) * (p->crop[3] - p->crop[1]) > limits->max_pixels)
        return err_at((Place){ path, 0, 0 }, "has more pixels than the limit of %.0f "
                      "(--max-pixels)", (double)limits->max_pixels);
    return film_init(f, p->w, p->h, p->crop, (int)p->layers) &&
           (!p->splats || film_accepts_splats(f));
}

static void weigh(Merge *m, const Film *part)
{
    double n = part->splats ? (double)part->splats->shots : (double)film_samples(part);
    double e = film_error(part);

    m->samples += n;
    if (n > 0)
        m->squares += e * n * (e * n);
}

double merge_error(const Merge *m)
{
    return m->samples > 0 ? sqrt(m->squares) / m->samples : INFINITY;
}

/* Adds the film behind the head, the first as it is. */
static bool join(Merge *m, StateHead *h, const char *path, const ReadLimits *limits)
{
    Film part = { 0 };

    if (m->n && !film_has_shape(&m->film, &h->shape))
        return err_at((Place){ path, 0, 0 }, "is a picture of another size than the first part");
    if (!film_of(&part, h, path, limits) ||
        (!film_load(&part, &h->rest) && !err_at((Place){ path, 0, 0 }, "is not whole"))) {
        film_clear(&part);
        return false;
    }
    weigh(m, &part);
    if (!m->n) {
        m->film = part;
        return true;
    }
    film_join(&m->film, &part);
    film_clear(&part);
    return true;
}

static bool keep_text(Merge *m, const StateHead *h)
{
    if (m->n)
        return true;
    mem_free(m->text.text);
    m->text.text = mem_string(h->text, h->ntext);
    m->text.n = h->ntext;
    return m->text.text != NULL;
}

bool merge_add(Merge *m, const char *path, const ReadLimits *limits)
{
    StateHead h;
    PartOf of;
    bool ok;

    if (!state_read_head(&h, path, limits->max_file))
        return false;
    ok = same_render(m, &h, path, &of) && is_new(m, &of, path) &&
         mem_grow(&m->parts, &m->cap, m->n + 1, sizeof *m->parts) && keep_text(m, &h) &&
         join(m, &h, path, limits);
    load_clear(&h.rest);
    if (ok)
        m->parts[m->n++] = of;
    return ok;
}
