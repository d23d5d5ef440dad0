/* session.h -- a scene that is looked at: one or two pictures that are always being rendered, and
 * begin anew when camera or methods change. Any number of threads may ask and change. */
#ifndef VIEW_SESSION_H
#define VIEW_SESSION_H

#include "render/render.h"
#include "view/json.h"

#include <pthread.h>

enum { PANES = 2 };

typedef struct Session Session;

/* For a scene that is built, as `base` says; both are borrowed, and the scene is the session's own
 * until session_free. All messages go to it. NULL: reported. */
Session *session_new(SceneFile *f, const RenderSettings *base);
void session_free(Session *s);

/* A choice by its text: "integrator", "integrator2", "accel", "sampler", "filter" by
 * "NAME[:KEY=VALUE,...]", "split" by "on" or "off". False: said; an unknown word too. */
bool session_set(Session *s, const char *what, const char *text);

/* Moves of the camera, x to the right and y up, in heights of the picture: as something is dragged
 * for orbit, turn and pan; for zoom y is how much nearer; for walk x, y and z (forward) are radii
 * of the scene. False: there is no such move. */
bool session_move(Session *s, const char *how, double x, double y, double z);
/* "save", "next", "previous", "first" (as the scene has it). False: there is no such word, or no
 * room for more. */
bool session_view(Session *s, const char *what);

/* Waits until something has changed since the change of that number, or for so long. Returns the
 * number of the last change. */
uint64_t session_wait(Session *s, uint64_t since, double seconds);

/* A copy of what a pane shows. False: there is nothing yet, or no memory, reported. */
typedef struct { Image image; uint32_t scale; uint64_t shown; } Snapshot;
bool session_snapshot(Session *s, int pane, Snapshot *copy);
/* What a pane shows at a place of the picture, in pixels; false where there is nothing. */
bool session_pixel(Session *s, int pane, double x, double y, Rgb *c);

/* All of its state, as an object. */
void session_describe(Session *s, Json *j);
int  session_threads(const Session *s);

/* From the first call on, until the second, errors of this thread are kept in a->said, the last
 * one, and told to nobody else. */
enum { LINE_MOST = 400 };
typedef struct Asker { pthread_t thread; char said[LINE_MOST]; struct Asker *next; } Asker;
void session_ask(Session *s, Asker *a);
void session_asked(Session *s, Asker *a);
void session_quit(Session *s);          /* whoever waits need wait no longer */
bool session_has_quit(Session *s);

#endif
