/* camera.c -- the list of cameras. See scene.h. */
#include "scene/scene.h"

#define CAMERAS(X) X(perspective)
#define DECLARE(name) extern const CameraKind camera_##name;
#define ENTRY(name) &camera_##name,
CAMERAS(DECLARE)
const CameraKind *const cameras[] = { CAMERAS(ENTRY) NULL };
