/* harmonics.c -- the code of `harmonics.h` */
#include "integrators/harmonics.h"

/* P(l, m) = up z P(l-1, m) - back P(l-2, m); with cos or sin m phi of norm 1 on the hemisphere. */
void harmonics_init(Harmonics *h, int bands)
{
    double first = sqrt(0.5 / PI);

    h->bands = bands;
    h->n = bands * (bands + 1) / 2;
    for (int m = 0; m < bands; m++) {
        if (m > 0)
            first *= sqrt((m == 1 ? 2.0 : 1.0) * (2 * m + 1) / (2 * m));
        h->first[m] = (float)first;
        for (int l = m + 1; l < bands; l++) {
            double l2 = l * l, m2 = m * m, below = (l - 1) * (l - 1);
            double up = sqrt((4 * l2 - 1) / (l2 - m2));
            h->up[m][l] = (float)up;
            h->back[m][l] = (float)(up * sqrt((below - m2) / (4 * below - 1)));
        }
    }
}

void harmonics_at(const Harmonics *h, V3 w, float *out)
{
    float c = 1.0f, s = 0.0f;   /* sine^m cos m phi, sine^m sin m phi */

    for (int m = 0; m < h->bands; m++) {
        float before = 0.0f, p = h->first[m], turned = c * w.x - s * w.y;
        for (int l = m;;) {
            float next;
            if (!((l - m) & 1)) {
                *out++ = p * c;
                if (m > 0)
                    *out++ = p * s;
            }
            if (++l == h->bands)
                break;
            next = h->up[m][l] * w.z * p - h->back[m][l] * before;      /* [Abramowitz64 8.5.3] */
            before = p;
            p = next;
        }
        s = s * w.x + c * w.y;
        c = turned;
    }
}
