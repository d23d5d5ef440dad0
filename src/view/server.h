/* server.h -- a session served to browsers of this machine. */
#ifndef VIEW_SERVER_H
#define VIEW_SERVER_H

#include "view/session.h"

#include <signal.h>

/* Listens on 127.0.0.1 alone, at a port of its own choice if port is 0, prints the address and
 * serves until *stop is not 0, or the session quits. False: reported. */
bool serve(Session *s, int port, const volatile sig_atomic_t *stop);

#endif
