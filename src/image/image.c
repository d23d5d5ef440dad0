/* image.c -- images in memory, the list of file formats, and the sRGB curve.
 *
 * Source      [sRGB]  IEC 61966-2-1:1999, the transfer function of sRGB.
 * A new format is one file and one line of FORMATS. Reading goes by the bytes of the file, in the
 * order of the list: TGA stands last, because it has no mark of its own at the front. */
#include "image/image.h"

#include "base/file.h"
#include "base/mem.h"
#include "base/text.h"
#include "image/exr.h"

#include <stdio.h>
#include <string.h>

#define FORMATS(X) X(pfm) X(hdr) X(exr) X(png) X(ppm) X(tga)
#define DECLARE(name) extern const ImageFormat image_format_##name;
#define ENTRY(name) &image_format_##name,
FORMATS(DECLARE)
const ImageFormat *const image_formats[] = { FORMATS(ENTRY) NULL };

bool image_init(Image *im, uint32_t w, uint32_t h)
{
    uint64_t n = (uint64_t)w * h;

    memset(im, 0, sizeof *im);
    if (n > SIZE_MAX / sizeof(Rgb))
        return err_memory(SIZE_MAX);
    im->pixels = MEM_ARRAY(Rgb, (size_t)n);
    if (!im->pixels)
        return false;
    im->w = w;
    im->h = h;
    return true;
}

bool image_init_alpha(Image *im, uint32_t w, uint32_t h)
{
    if (!image_init(im, w, h))
        return false;
    im->alpha = MEM_ARRAY(float, (size_t)w * h);
    if (!im->alpha)
        image_clear(im);
    return im->pixels != NULL;
}

void image_drop_alpha(Image *im, float value)
{
    size_t i = 0, n = (size_t)im->w * im->h;

    while (im->alpha && i < n && im->alpha[i] == value)
        i++;
    if (im->alpha && i == n) {
        mem_free(im->alpha);
        im->alpha = NULL;
    }
}

void image_clear(Image *im)
{
    mem_free(im->pixels);
    mem_free(im->alpha);
    memset(im, 0, sizeof *im);
}

/* ---- choosing a format ---- */

/* The usual extensions of the formats that can be read or written, with blanks between. */
static const char *extensions_that(bool write, char *out, size_t room)
{
    size_t used = 0;

    out[0] = 0;
    for (const ImageFormat *const *f = image_formats; *f; f++) {
        int n = (int)strcspn((*f)->extensions, " ");
        if ((write ? (*f)->write != NULL : (*f)->read != NULL) && used + (size_t)n + 2 < room)
            used += (size_t)snprintf(out + used, room - used, "%s%.*s", used ? " " : "", n,
                                     (*f)->extensions);
    }
    return out;
}

/* Is `word` one of the blank-separated words of `list`? Case does not count. */
static bool has_word(const char *list, const char *word)
{
    while (*list) {
        size_t n = strcspn(list, " ");
        if (word_is_nocase((Word){ list, n }, word))
            return true;
        list += n + (list[n] == ' ');
    }
    return false;
}

const char *image_extensions(char out[IMAGE_EXTENSIONS])
{
    return extensions_that(true, out, IMAGE_EXTENSIONS);
}

bool image_can_read(const char *path)
{
    for (const ImageFormat *const *f = image_formats; *f; f++)
        if ((*f)->read && has_word((*f)->extensions, path_extension(path)))
            return true;
    return false;
}

const ImageFormat *image_format_of(const char *path)
{
    for (const ImageFormat *const *f = image_formats; *f; f++)
        if ((*f)->write && has_word((*f)->extensions, path_extension(path)))
            return *f;
    return NULL;
}

const ImageFormat *image_format_for_writing(const char *path)
{
    const ImageFormat *f = image_format_of(path);
    char names[IMAGE_EXTENSIONS];

    if (!f)
        err_usage("%.300s: no image is written with the extension '%.40s', one of these was "
                  "expected: %s", path, path_extension(path), image_extensions(names));
    return f;
}

/* Kinds of pictures that are known, but not read, and how they begin. */
static const char *foreign_kind(const unsigned char *b, size_t n)
{
    static const struct { const char *name, *begin; size_t n, at; } kinds[] = {
        { "JPEG", "\xFF\xD8\xFF", 3, 0 }, { "GIF", "GIF8", 4, 0 },
        { "BMP", "BM", 2, 0 }, { "TIFF", "II*\0", 4, 0 }, { "TIFF", "MM\0*", 4, 0 },
        { "WebP", "WEBP", 4, 8 }, { "DDS", "DDS ", 4, 0 }, { "Ptex", "Ptex", 4, 0 },
        { "HEIF", "ftyp", 4, 4 }
    };
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (n >= kinds[i].at + kinds[i].n &&
            !memcmp(b + kinds[i].at, kinds[i].begin, kinds[i].n))
            return kinds[i].name;
    return NULL;
}

static bool read_bytes(Image *im, const char *path, const unsigned char *bytes, size_t n,
                       uint64_t max_pixels, Encoding encoding)
{
    Place at = { path, 0, 0 };
    const char *foreign = foreign_kind(bytes, n);
    char names[IMAGE_EXTENSIONS];

    extensions_that(false, names, sizeof names);
    if (foreign)
        return err_at(at, "is a %s file, one of these was expected: %s (another program can "
                      "convert it, for instance: magick IN OUT.png)", foreign, names);
    for (const ImageFormat *const *f = image_formats; *f; f++) {
        if (!(*f)->detect(bytes, n))
            continue;
        if (!(*f)->read)
            return err_at(at, "is a %s file, one of these was expected: %s", (*f)->info.name,
                          names);
        return (*f)->read(im, path, bytes, n, max_pixels, encoding);
    }
    return err_at(at, "is no image of a known kind, one of these was expected: %s", names);
}

bool image_read(Image *im, const char *path, uint64_t max_pixels)
{
    return image_read_as(im, path, max_pixels, ENCODING_BY_FILE);
}

bool image_read_as(Image *im, const char *path, uint64_t max_pixels, Encoding encoding)
{
    FileBytes f;
    bool ok;

    memset(im, 0, sizeof *im);
    if (!file_read(path, FILE_LIMIT_DEFAULT, &f))
        return false;
    ok = read_bytes(im, path, (const unsigned char *)f.bytes, f.size, max_pixels,
                    encoding);
    file_clear(&f);
    return ok;
}

bool image_read_layer(Image *im, const char *path, uint64_t max_pixels, const char *layer)
{
    FileBytes f;
    bool ok;

    memset(im, 0, sizeof *im);
    if (!file_read(path, FILE_LIMIT_DEFAULT, &f))
        return false;
    if (image_format_exr.detect((const unsigned char *)f.bytes, f.size))
        ok = exr_read(im, path, (const unsigned char *)f.bytes, f.size, max_pixels, layer);
    else
        ok = err_at((Place){ path, 0, 0 }, "only EXR files have layers, --layer %s was asked for",
                    layer);
    file_clear(&f);
    return ok;
}

bool image_write(const Image *im, const char *path, const Display *display)
{
    const ImageFormat *f = image_format_for_writing(path);

    ASSERT(im->w > 0 && im->h > 0);             /* no format has pictures without pixels */
    return f && f->write(im, path, display);
}

/* ---- the sRGB curve ---- */

float srgb_encode(float linear)
{
    double x = linear;

    if (!(linear > 0.0f))                               /* NaN too */
        return 0.0f;
    if (linear >= 1.0f)
        return 1.0f;
    return (float)(x <= 0.0031308 ? 12.92 * x : 1.055 * md_pow(x, 1 / 2.4) - 0.055);
}

float srgb_decode(float encoded)
{
    double x = encoded;

    if (!(encoded > 0.0f))
        return 0.0f;
    if (encoded >= 1.0f)
        return 1.0f;
    return (float)(x <= 0.04045 ? x / 12.92 : md_pow((x + 0.055) / 1.055, 2.4));
}
