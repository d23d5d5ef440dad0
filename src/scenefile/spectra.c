/* spectra.c -- the spectra that have names: measured n and k of metals, glasses, illuminants.
 *
 * Sources     Ag, Au, Cu: [Johnson72] table I. Al: Rakic, Applied Optics 34 (1995). CuZn (70/30
 *             brass): Querry, CRDC-CR-85034 (1985). MgO: Stephens and Malitson, J. Res. NBS 49
 *             (1952), dispersion formula. TiO2 (ordinary ray of rutile): Devore, JOSA 41 (1951),
 *             dispersion formula.
 *             Glasses: index at 587.6 nm (d line) of the Schott data sheets: rays carry three
 *             colours and do not split, so dispersion has no meaning here. Illuminants: the
 *             chromaticities of CIE 15 (1931 observer).
 * Columns     Wavelength in nm, n, k; linear between rows. */
#include "scenefile/spectrum.h"

#include "base/error.h"

#include <stdio.h>
#include <string.h>

typedef struct { double nm, n, k; } Nk;

static const Nk ag[] = {
    { 381.5, 0.05, 1.864 }, { 397.4, 0.05, 2.070 }, { 413.3, 0.05, 2.275 }, { 430.5, 0.04, 2.462 },
    { 450.9, 0.04, 2.657 }, { 471.4, 0.05, 2.869 }, { 495.9, 0.05, 3.093 }, { 520.9, 0.05, 3.324 },
    { 548.6, 0.06, 3.586 }, { 582.1, 0.05, 3.858 }, { 616.8, 0.06, 4.152 }, { 659.5, 0.05, 4.483 },
    { 704.5, 0.04, 4.838 }, { 756.0, 0.03, 5.242 }, { 0, 0, 0 }
};
static const Nk au[] = {
    { 381.5, 1.46, 1.933 }, { 397.4, 1.47, 1.952 }, { 413.3, 1.46, 1.958 }, { 430.5, 1.45, 1.948 },
    { 450.9, 1.38, 1.914 }, { 471.4, 1.31, 1.849 }, { 495.9, 1.04, 1.833 }, { 520.9, 0.62, 2.081 },
    { 548.6, 0.43, 2.455 }, { 582.1, 0.29, 2.863 }, { 616.8, 0.21, 3.272 }, { 659.5, 0.14, 3.697 },
    { 704.5, 0.13, 4.103 }, { 756.0, 0.14, 4.542 }, { 0, 0, 0 }
};
static const Nk cu[] = {
    { 381.5, 1.33, 2.045 }, { 397.4, 1.32, 2.116 }, { 413.3, 1.28, 2.207 }, { 430.5, 1.25, 2.305 },
    { 450.9, 1.24, 2.397 }, { 471.4, 1.25, 2.483 }, { 495.9, 1.22, 2.564 }, { 520.9, 1.18, 2.608 },
    { 548.6, 1.02, 2.577 }, { 582.1, 0.70, 2.704 }, { 616.8, 0.30, 3.205 }, { 659.5, 0.22, 3.747 },
    { 704.5, 0.21, 4.205 }, { 756.0, 0.24, 4.665 }, { 0, 0, 0 }
};
static const Nk al[] = {
    { 364.66, 0.39877, 4.3957 }, { 413.28, 0.52135, 5.0008 }, { 442.80, 0.60790, 5.3676 },
    { 476.87, 0.72780, 5.7781 }, { 516.60, 0.87340, 6.2418 }, { 563.57, 1.0728, 6.7839 },
    { 619.93, 1.3660, 7.4052 },  { 652.25, 1.5724, 7.7354 },  { 688.81, 1.8301, 8.0601 },
    { 729.32, 2.1606, 8.3565 },  { 774.91, 2.6154, 8.4914 },  { 0, 0, 0 }
};
static const Nk cuzn[] = {
    { 380, 1.487, 1.818 }, { 400, 1.445, 1.805 }, { 420, 1.350, 1.786 }, { 440, 1.191, 1.797 },
    { 460, 0.994, 1.883 }, { 480, 0.816, 2.046 }, { 500, 0.686, 2.250 }, { 520, 0.602, 2.464 },
    { 540, 0.549, 2.668 }, { 560, 0.505, 2.860 }, { 580, 0.468, 3.059 }, { 600, 0.450, 3.253 },
    { 620, 0.449, 3.434 }, { 640, 0.444, 3.609 }, { 660, 0.445, 3.778 }, { 680, 0.444, 3.943 },
    { 700, 0.446, 4.106 }, { 740, 0.455, 4.424 }, { 0, 0, 0 }
};
static const Nk mgo[] = {
    { 400, 1.7622, 0 }, { 450, 1.7524, 0 }, { 500, 1.7455, 0 }, { 550, 1.7405, 0 },
    { 600, 1.7367, 0 }, { 650, 1.7337, 0 }, { 700, 1.7313, 0 }, { 0, 0, 0 }
};
static const Nk tio2[] = {
    { 430, 2.8717, 0 }, { 450, 2.8126, 0 }, { 500, 2.7114, 0 }, { 550, 2.6479, 0 },
    { 600, 2.6049, 0 }, { 650, 2.5742, 0 }, { 700, 2.5512, 0 }, { 0, 0, 0 }
};

static const struct { const char *name; const Nk *nk; } metals[] = {
    { "metal-Ag", ag }, { "metal-Al", al }, { "metal-Au", au }, { "metal-Cu", cu },
    { "metal-CuZn", cuzn }, { "metal-MgO", mgo }, { "metal-TiO2", tio2 }
};

static const struct { const char *name; double n; } glasses[] = {
    { "glass-BK7", 1.51680 }, { "glass-BAF10", 1.67003 }, { "glass-FK51A", 1.48656 },
    { "glass-LASF9", 1.85025 }, { "glass-SF5", 1.67271 }, { "glass-SF10", 1.72825 },
    { "glass-SF11", 1.78472 },
    { "glass-F5", 1.67271 }, { "glass-F10", 1.72825 }, { "glass-F11", 1.78472 }   /* pbrt's names */
};

static const struct { const char *name; double x, y; } illuminants[] = {
    { "stdillum-A", 0.44758, 0.40745 },   { "stdillum-D50", 0.34567, 0.35851 },
    { "stdillum-D65", 0.31272, 0.32903 }, { "illum-acesD60", 0.32168, 0.33767 },
    { "stdillum-F1", 0.31310, 0.33727 },  { "stdillum-F2", 0.37208, 0.37529 },
    { "stdillum-F3", 0.40910, 0.39430 },  { "stdillum-F4", 0.44018, 0.40329 },
    { "stdillum-F5", 0.31379, 0.34531 },  { "stdillum-F6", 0.37790, 0.38835 },
    { "stdillum-F7", 0.31292, 0.32933 },  { "stdillum-F8", 0.34588, 0.35875 },
    { "stdillum-F9", 0.37417, 0.37281 },  { "stdillum-F10", 0.34609, 0.35986 },
    { "stdillum-F11", 0.38052, 0.37713 }, { "stdillum-F12", 0.43695, 0.40441 }
};

#define COUNT(a) (sizeof(a) / sizeof *(a))

static void from_nk(const Cie *c, const Nk *nk, bool want_k, SpectrumUse use, double rgb[3])
{
    double pairs[2 * 32];
    size_t n = 0;
    for (; nk[n].nm > 0; n++) {
        pairs[2 * n] = nk[n].nm;
        pairs[2 * n + 1] = want_k ? nk[n].k : nk[n].n;
    }
    spectrum_from_samples(c, pairs, n, use, rgb);
}

bool spectrum_named(const Cie *c, const char *name, SpectrumUse use, double rgb[3])
{
    for (size_t i = 0; i < COUNT(metals); i++) {
        size_t n = strlen(metals[i].name);
        bool want_k = !strcmp(name + (strlen(name) > n ? n : 0), "-k");
        if (!strncmp(name, metals[i].name, n) && (want_k || !strcmp(name + n, "-eta"))) {
            from_nk(c, metals[i].nk, want_k, use, rgb);
            return true;
        }
    }
    for (size_t i = 0; i < COUNT(glasses); i++)
        if (!strcmp(name, glasses[i].name)) {
            rgb[0] = rgb[1] = rgb[2] = glasses[i].n;
            return true;
        }
    for (size_t i = 0; i < COUNT(illuminants); i++)
        if (!strcmp(name, illuminants[i].name)) {
            double x = illuminants[i].x, y = illuminants[i].y;
            double xyz[3] = { x / y, 1, (1 - x - y) / y };
            spectrum_from_xyz(xyz, rgb);
            return true;
        }
    return false;
}

const char *spectrum_hint(const char *name, char hint[HINT_MAX])
{
    static const char *const parts[2] = { "-eta", "-k" };
    char of_metals[2 * COUNT(metals)][20];
    const char *names[2 * COUNT(metals) + COUNT(glasses) + COUNT(illuminants)];
    size_t n = 0;

    for (; n < 2 * COUNT(metals); n++) {
        snprintf(of_metals[n], sizeof of_metals[n], "%s%s", metals[n / 2].name, parts[n % 2]);
        names[n] = of_metals[n];
    }
    for (size_t i = 0; i < COUNT(glasses); i++)
        names[n++] = glasses[i].name;
    for (size_t i = 0; i < COUNT(illuminants); i++)
        names[n++] = illuminants[i].name;
    return hint_nearest(hint, name, names, n);
}
