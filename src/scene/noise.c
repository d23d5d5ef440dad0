/* noise.c -- gradient noise and sums of it. See noise.h.
 *
 * Source      [Perlin02] gradients at the corners of a grid of cubes, blended by the quintic
 *             6 t^5 - 15 t^4 + 10 t^3; [PBRT4 10.5] sums that stop where the footprint begins.
 * Departs     The gradient of a corner comes from a hash of its three numbers, not from a table of
 *             256: nothing repeats, and the values are others than those of that table. */
#include "scene/noise.h"

#include "base/random.h"

static uint64_t hash_of(int64_t x, int64_t y, int64_t z)
{
    return mix64((uint64_t)x * 0x9E3779B97F4A7C15u + (uint64_t)y * 0xC2B2AE3D27D4EB4Fu +
                 (uint64_t)z * 0x165667B19E3779F9u + 0x27D4EB2F165667C5u);
}

float noise_cell(int64_t x, int64_t y, unsigned which)
{
    return unit_of((uint32_t)(hash_of(x, y, (int64_t)which) >> 32));
}

/* The product with one of the twelve vectors from the centre of a cube to the middles of its
 * edges. */
static float slope(uint64_t h, float x, float y, float z)
{
    unsigned k = (unsigned)((h >> 32) * 3 >> 32);       /* the axis that it is across of */
    float u = k == 0 ? y : x, v = k == 2 ? y : z;
    return (h & 1 ? -u : u) + (h & 2 ? -v : v);
}

static float blend(float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); }
static float lerp(float a, float b, float t) { return a + t * (b - a); }

/* Between the two corners at (x, y, z) and one further along x. */
static float edge(int64_t x, int64_t y, int64_t z, V3 f, float u)
{
    return lerp(slope(hash_of(x, y, z), f.x, f.y, f.z),
                slope(hash_of(x + 1, y, z), f.x - 1.0f, f.y, f.z), u);
}

float noise(V3 p)
{
    V3 low = v3(floorf(p.x), floorf(p.y), floorf(p.z)), f = v_sub(p, low);
    int64_t x, y, z;
    float u, v, near, far;

    if (!(v_max3(v_abs(p)) < 0x1p30f) || p.x != p.x || p.y != p.y || p.z != p.z)
        return 0.0f;
    x = (int64_t)low.x;
    y = (int64_t)low.y;
    z = (int64_t)low.z;
    u = blend(f.x);
    v = blend(f.y);
    near = lerp(edge(x, y, z, f, u), edge(x, y + 1, z, v3(f.x, f.y - 1.0f, f.z), u), v);
    f.z -= 1.0f;
    far = lerp(edge(x, y, z + 1, f, u), edge(x, y + 1, z + 1, v3(f.x, f.y - 1.0f, f.z), u), v);
    return lerp(near, far, blend(f.z + 1.0f));
}

/* How many octaves are wider than two footprints: of the last one a part. */
static float octaves_seen(Octaves o)
{
    float n = o.width > 0.0f ? -1.0f - m_log2(o.width) : (float)o.octaves;
    return f_min(f_max(n, 0.0f), (float)o.octaves);
}

static float sum_of(V3 p, Octaves o, bool creased)
{
    const float mean = 0.22f;           /* of |noise|: what octaves that are too fine come to */
    float seen = octaves_seen(o), height = 1.0f, sum = 0.0f;

    for (int k = 0; k < o.octaves; k++) {
        float part = f_min(f_max(seen - (float)k, 0.0f), 1.0f), x = part > 0.0f ? noise(p) : 0.0f;
        sum += height * (creased ? part * fabsf(x) + (1.0f - part) * mean : part * x);
        height *= o.roughness;
        p = v_scale(p, 1.99f);
    }
    return sum;
}

float noise_sum(V3 p, Octaves o) { return sum_of(p, o, false); }
float noise_turbulence(V3 p, Octaves o) { return sum_of(p, o, true); }
