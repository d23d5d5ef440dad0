/* inside.h -- a session from the inside: what the files about it share. */
#ifndef VIEW_INSIDE_H
#define VIEW_INSIDE_H

#include "view/pose.h"
#include "view/session.h"

enum { VIEWS_MOST = 100, LOG_MOST = 20 };

/* One member of an open set with its options. */
typedef struct {
    const KindInfo *kind;       /* first of a struct of functions */
    Opts  opts;
    Arena arena;                /* owned: texts of the options */
} Choice;

/* A thread that renders one of the two pictures. */
typedef struct {
    Session  *session;
    pthread_t thread;
    bool      started, on;      /* on: its picture is wanted */
    bool      busy;             /* it renders */
    Choice    integrator;
    uint64_t  done;             /* what was wanted when it last was through */
    Image     image;            /* owned: what it shows, of */
    uint32_t  scale;            /* pixels of the whole picture a pixel of this one's side */
    bool      fresh;            /* the picture is of what is wanted now, and whole */
    RenderReport report;
    uint64_t  of;               /* what was wanted then */
    uint64_t  shown;            /* the change that brought it */
    double    rate;             /* pixels a second of a first look; 0: not known yet */
} Pane;

struct Session {
    SceneFile *file;            /* borrowed */
    RenderSettings base;
    pthread_mutex_t setting;    /* of those who change methods: one at a time */
    pthread_mutex_t lock;       /* of all that follows but the messages */
    pthread_cond_t  changed;
    Choice   sampler, filter, accel;
    Pane     pane[PANES];
    bool     split, quit;
    bool     held;              /* nobody may render: methods are being changed */
    uint64_t change;            /* grows with whatever can be seen */
    uint64_t wanted;            /* grows with what a picture depends on, */
    uint64_t method;            /* and with that but for the camera */
    Pose     pose, first;
    bool     moved;             /* the pose is not that of the scene, which may move by itself */
    Pose     views[VIEWS_MOST];
    int      nviews, at;
    pthread_mutex_t log_lock;
    Asker   *askers;            /* borrowed */
    char     log[LOG_MOST][LINE_MOST];          /* the latest ones, each line once */
    int      nlog;
};

/* ---- pane.c ---- */

/* What a thread does until the session quits; arg: its Pane. */
void *pane_run(void *arg);

#endif
