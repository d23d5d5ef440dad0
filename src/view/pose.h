/* pose.h -- where a camera stands and looks, moved by hand. */
#ifndef VIEW_POSE_H
#define VIEW_POSE_H

#include "scene/scene.h"

/* The camera of the scene, turned by two angles and put somewhere. */
typedef struct {
    double base[3][3];          /* its space to the world at first, without the place */
    double up[3];               /* the axis of the world that is most nearly up in the picture */
    double yaw, pitch;          /* about that axis; before, about the picture's horizontal */
    double eye[3], pivot[3];    /* where it stands; what orbits go around */
} Pose;

/* As the camera stands at time 0, if it moves. pivot: in the middle of the picture. */
void pose_init(Pose *p, const Camera *c, V3 pivot);
/* Gives the place to a camera of the same scene. False: it cannot stand so; nothing is changed. */
bool pose_put(const Pose *p, Camera *c);
/* camera to world, as the bytes of a camera have it: right, up, forward and place. */
void pose_matrix(const Pose *p, double m[4][4]);

/* Around the pivot, and around the eye itself; radians to the right and up, where the picture goes.
 * It does not tip over. */
void pose_orbit(Pose *p, double right, double up);
void pose_turn(Pose *p, double right, double up);
/* Along the world's directions of the picture; `takes`: the pivot comes along. */
void pose_shift(Pose *p, double right, double up, double forward, bool takes);
/* The distance from the pivot becomes so many times what it was. */
void pose_zoom(Pose *p, double factor);
double pose_distance(const Pose *p);            /* from the pivot */
bool   pose_is_usable(const Pose *p);           /* finite, and not beyond what floats hold */

#endif
