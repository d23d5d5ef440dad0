/* pose.c -- the code of `pose.h`.
 *
 * Idea        The linear part of the camera's map is Y P B: B what the scene has, P a turn by
 *             `pitch` about B's horizontal, Y one by `yaw` about the world's vertical. Angles are
 *             kept, not matrices, so nothing drifts however long somebody plays; and all of B stays
 *             as it is: mirrored and stretched spaces, fields of view, lenses. */
#include "view/pose.h"

#include <string.h>

#define UPRIGHT_LEAST 0.035             /* 2 degrees from the vertical are the least */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* v turned by an angle about the unit axis k: v cos + (k x v) sin + k (k . v) (1 - cos). */
static void turn(double v[3], const double k[3], double angle)
{
    double c = md_cos(angle), s = md_sin(angle), along = dot(k, v) * (1 - c);
    double cross[3] = { k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2],
                        k[0] * v[1] - k[1] * v[0] };

    for (int i = 0; i < 3; i++)
        v[i] = v[i] * c + cross[i] * s + k[i] * along;
}

/* Column k of B, unit. */
static void base_axis(const Pose *p, int k, double out[3])
{
    double length;

    for (int i = 0; i < 3; i++)
        out[i] = p->base[i][k];
    length = sqrt(dot(out, out));
    for (int i = 0; i < 3; i++)
        out[i] = length > 0 ? out[i] / length : i == k;
}

static void turn_both(const Pose *p, double v[3])
{
    double right[3];

    base_axis(p, 0, right);
    turn(v, right, p->pitch);
    turn(v, p->up, p->yaw);
}

static void turn_back(const Pose *p, double v[3])
{
    double right[3];

    base_axis(p, 0, right);
    turn(v, p->up, -p->yaw);
    turn(v, right, -p->pitch);
}

/* Unit direction k of the picture in the world: right, up, forward. */
static void axis(const Pose *p, int k, double out[3])
{
    base_axis(p, k, out);
    turn_both(p, out);
}

void pose_init(Pose *p, const Camera *c, V3 pivot)
{
    double up[3], most = -1;
    int k = 1;

    memset(p, 0, sizeof *p);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            p->base[i][j] = c->to_world.m[i][j];
        p->eye[i] = c->to_world.m[i][3];
    }
    p->pivot[0] = pivot.x;
    p->pivot[1] = pivot.y;
    p->pivot[2] = pivot.z;
    base_axis(p, 1, up);
    for (int i = 0; i < 3; i++)
        if (fabs(up[i]) > most) {
            most = fabs(up[i]);
            k = i;
        }
    p->up[k] = up[k] < 0 ? -1 : 1;
}

void pose_matrix(const Pose *p, double m[4][4])
{
    for (int k = 0; k < 3; k++) {
        double v[3] = { p->base[0][k], p->base[1][k], p->base[2][k] };
        turn_both(p, v);
        for (int i = 0; i < 3; i++)
            m[i][k] = v[i];
        m[k][3] = p->eye[k];
        m[3][k] = 0;
    }
    m[3][3] = 1;
}

bool pose_put(const Pose *p, Camera *c)
{
    double m[4][4];
    Transform t;

    pose_matrix(p, m);
    if (!xf_from(&t, m))
        return false;
    c->to_world = xf_affine(&t);
    c->to_camera = xf_affine_inverse(&t);
    c->motion = NULL;
    return true;
}

/* ---- moves ---- */

/* Positive angles about the axes turn the view down and to the left in a space without mirrors;
 * which way it is here, the axes say themselves: forward moves towards right, or up, or it is the
 * other sign. */
static double sense(const double about[3], const double from[3], const double to[3])
{
    double v[3] = { from[0], from[1], from[2] };

    turn(v, about, 1e-3);
    return dot(v, to) >= dot(from, to) ? 1 : -1;
}

void pose_turn(Pose *p, double right, double up)
{
    double r[3], u[3], f[3], old = p->pitch, before, after;

    axis(p, 0, r);
    axis(p, 1, u);
    axis(p, 2, f);
    before = dot(u, p->up);
    p->yaw += right * sense(p->up, f, r);
    base_axis(p, 0, r);
    base_axis(p, 1, u);
    base_axis(p, 2, f);
    p->pitch += up * sense(r, f, u);
    axis(p, 1, u);
    after = dot(u, p->up);
    if (after < UPRIGHT_LEAST && after < before)
        p->pitch = old;
}

/* What is between eye and pivot stays as it is in the camera's space. */
void pose_orbit(Pose *p, double right, double up)
{
    double to[3];

    for (int i = 0; i < 3; i++)
        to[i] = p->pivot[i] - p->eye[i];
    turn_back(p, to);
    pose_turn(p, right, up);
    turn_both(p, to);
    for (int i = 0; i < 3; i++)
        p->eye[i] = p->pivot[i] - to[i];
}

void pose_shift(Pose *p, double right, double up, double forward, bool takes)
{
    const double by[3] = { right, up, forward };

    for (int k = 0; k < 3; k++) {
        double v[3];
        axis(p, k, v);
        for (int i = 0; i < 3; i++) {
            p->eye[i] += by[k] * v[i];
            p->pivot[i] += takes ? by[k] * v[i] : 0;
        }
    }
}

void pose_zoom(Pose *p, double factor)
{
    for (int i = 0; i < 3; i++)
        p->eye[i] = p->pivot[i] + (p->eye[i] - p->pivot[i]) * factor;
}

double pose_distance(const Pose *p)
{
    double to[3] = { p->pivot[0] - p->eye[0], p->pivot[1] - p->eye[1], p->pivot[2] - p->eye[2] };
    return sqrt(dot(to, to));
}

bool pose_is_usable(const Pose *p)
{
    for (int i = 0; i < 3; i++)
        if (!(fabs(p->eye[i]) < 1e15) || !(fabs(p->pivot[i]) < 1e15))
            return false;
    return fabs(p->yaw) < 1e6 && fabs(p->pitch) < 1e6;
}
