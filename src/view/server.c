/* server.c -- the code of `server.h`.
 *
 * Idea        A connection is a request and its answer, on a thread of its own; a page waits for
 *             changes by asking a question that is answered late. So many connections at most, each
 *             with a limit of time for its head and for its answer: whoever is slow or says nothing
 *             keeps nobody else waiting for long. SIGPIPE must be ignored. */
#include "view/server.h"

#include "base/clock.h"
#include "base/work.h"
#include "view/answer.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define HEAD_SECONDS 5.0                /* for a request to come */
#define SEND_SECONDS 20.0               /* for an answer to go */
#define TICK_SECONDS 0.1                /* to see whether it is all over */
enum { CONNECTIONS_MOST = 32, WAITING_MOST = 64 };

typedef struct {
    Door door;
    int  fd;
    pthread_mutex_t lock;
    pthread_cond_t  gone;
    int  connections;           /* under the lock */
} Server;

typedef struct { Server *server; int fd; } Connection;

/* ---- a connection ---- */

/* Whether the descriptor is ready for it before `end`. */
static bool ready(int fd, short event, double end)
{
    struct pollfd p = { 0 };
    double left;
    int n;

    p.fd = fd;
    p.events = event;
    do {
        left = end - clock_wall();
        n = left > 0 ? poll(&p, 1, (int)(left * 1000) + 1) : 0;
    } while (n < 0 && errno == EINTR);
    return n > 0;
}

static HttpStatus receive(Session *s, int fd, char *bytes, HttpRequest *r)
{
    double end = clock_wall() + HEAD_SECONDS;
    HttpStatus status;
    size_t n = 0;

    while ((status = http_parse(bytes, n, r)) == HTTP_MORE) {
        ssize_t more;
        if (!ready(fd, POLLIN, d_min(end, clock_wall() + TICK_SECONDS))) {
            if (clock_wall() >= end || session_has_quit(s))
                return HTTP_TIMEOUT;
            continue;
        }
        more = recv(fd, bytes + n, HTTP_HEAD_MOST - n, 0);
        if (more == 0 || (more < 0 && errno != EINTR && errno != EAGAIN))
            return HTTP_MORE;           /* nobody is there any more */
        n += more > 0 ? (size_t)more : 0;
    }
    return status;
}

static void send_all(int fd, const char *bytes, size_t n, double end)
{
    while (n > 0 && ready(fd, POLLOUT, end)) {
        ssize_t done = send(fd, bytes, n, 0);
        if (done < 0 && errno != EINTR && errno != EAGAIN)
            return;
        bytes += done > 0 ? done : 0;
        n -= done > 0 ? (size_t)done : 0;
    }
}

/* Nothing from elsewhere is loaded, nobody else's page may hold this one, and no address is told to
 * others. */
static void send_answer(int fd, const Answer *a)
{
    double end = clock_wall() + SEND_SECONDS;
    char head[1000];
    int n = snprintf(head, sizeof head,
                     "HTTP/1.1 %d %s\r\nContent-Type: %s\r\nContent-Length: %lu\r\n"
                     "Connection: close\r\nCache-Control: no-store\r\n"
                     "Content-Security-Policy: default-src 'none'; script-src 'self'; "
                     "style-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'none'; "
                     "frame-ancestors 'none'\r\n"
                     "X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n"
                     "Cross-Origin-Resource-Policy: same-origin\r\n%s%s\r\n",
                     (int)a->status, http_reason(a->status), a->type, (unsigned long)a->n,
                     a->field, a->field[0] ? "\r\n" : "");

    send_all(fd, head, (size_t)n, end);
    if (a->n)
        send_all(fd, a->body, a->n, end);
}

/* A connection that is closed while there is something to read is broken off, and the answer may
 * be lost with it: what has come meanwhile is read and forgotten. */
static void finish(int fd)
{
    char bytes[4096];

    shutdown(fd, SHUT_WR);
    for (int k = 0; k < 64 && ready(fd, POLLIN, clock_wall() + 0.1); k++)
        if (recv(fd, bytes, sizeof bytes, 0) <= 0)
            break;
    close(fd);
}

static void converse(const Door *door, int fd)
{
    char bytes[HTTP_HEAD_MOST];
    HttpRequest r;
    HttpStatus status = receive(door->session, fd, bytes, &r);
    Answer a;

    if (status != HTTP_MORE) {
        if (status == HTTP_OK)
            answer(door, &r, &a);
        else
            answer_error(&a, status, http_reason(status));
        send_answer(fd, &a);
        answer_clear(&a);
    }
    finish(fd);
}

static void *connection_run(void *arg)
{
    Connection c = *(Connection *)arg;

    mem_free(arg);
    converse(&c.server->door, c.fd);
    pthread_mutex_lock(&c.server->lock);
    c.server->connections--;
    pthread_cond_signal(&c.server->gone);
    pthread_mutex_unlock(&c.server->lock);
    return NULL;
}

/* ---- the door ---- */

/* So little fits into the socket at once: nobody is waited for. */
static void refuse(int fd)
{
    char bytes[HTTP_HEAD_MOST];
    Answer a;

    answer_error(&a, HTTP_BUSY, "too many are here already");
    send_answer(fd, &a);
    answer_clear(&a);
    shutdown(fd, SHUT_WR);
    if (recv(fd, bytes, sizeof bytes, 0) < 0)
        errno = 0;                      /* it has not asked yet, and may miss the answer */
    close(fd);
}

/* On a thread of its own; where there is none, it is refused. */
static void begin(Server *s, int fd)
{
    Connection *c = MEM_NEW(Connection);
    pthread_t thread;
    bool ok;

    if (c)
        *c = (Connection){ s, fd };
    pthread_mutex_lock(&s->lock);
    ok = c && s->connections < CONNECTIONS_MOST;
    s->connections += ok;
    pthread_mutex_unlock(&s->lock);
    if (ok && work_thread(&thread, connection_run, c)) {
        pthread_detach(thread);
        return;
    }
    mem_free(c);
    refuse(fd);
    pthread_mutex_lock(&s->lock);
    s->connections -= ok;
    pthread_mutex_unlock(&s->lock);
}

static bool open_door(Server *s, int port)
{
    struct sockaddr_in at;
    socklen_t n = sizeof at;
    int yes = 1;

    memset(&at, 0, sizeof at);
    at.sin_family = AF_INET;
    at.sin_port = htons((uint16_t)port);
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    s->fd = socket(AF_INET, SOCK_STREAM, 0);
    if (s->fd < 0)
        return err_output(NULL, "no socket can be made: %s", strerror(errno));
    setsockopt(s->fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    fcntl(s->fd, F_SETFD, FD_CLOEXEC);
    fcntl(s->fd, F_SETFL, O_NONBLOCK);
    if (bind(s->fd, (struct sockaddr *)&at, sizeof at) || listen(s->fd, WAITING_MOST) ||
        getsockname(s->fd, (struct sockaddr *)&at, &n)) {
        err_output(NULL, "port %d of 127.0.0.1 cannot be had: %s", port, strerror(errno));
        close(s->fd);
        return false;
    }
    s->door.port = ntohs(at.sin_port);
    return true;
}

/* 128 bits that nobody can guess. */
static bool make_token(char token[TOKEN_LENGTH + 1])
{
    unsigned char bytes[TOKEN_LENGTH / 2];
    FILE *f = fopen("/dev/urandom", "rb");
    bool ok = f && fread(bytes, 1, sizeof bytes, f) == sizeof bytes;

    if (f)
        fclose(f);
    if (!ok)
        return err_output("/dev/urandom", "cannot be read, so no secret address can be made");
    for (int k = 0; k < TOKEN_LENGTH / 2; k++)
        snprintf(token + 2 * k, 3, "%02x", bytes[k]);
    return true;
}

static void listen_on(Server *s, const volatile sig_atomic_t *stop)
{
    struct pollfd p = { 0 };

    p.fd = s->fd;
    p.events = POLLIN;
    while (!*stop && !session_has_quit(s->door.session)) {
        int fd = poll(&p, 1, (int)(TICK_SECONDS * 1000)) > 0 ? accept(s->fd, NULL, NULL) : -1;
        if (fd >= 0) {
            fcntl(fd, F_SETFD, FD_CLOEXEC);
            fcntl(fd, F_SETFL, O_NONBLOCK);
            begin(s, fd);
        }
    }
}

/* Whoever does not get it cannot come: there is nobody to serve then. */
static bool say_address(const Door *door)
{
    if (printf("http://127.0.0.1:%d/%s/\n", door->port, door->token) > 0 && !fflush(stdout))
        return true;
    return err_output("standard output", "cannot be written: %s", strerror(errno));
}

bool serve(Session *session, int port, const volatile sig_atomic_t *stop)
{
    Server s;
    bool ok;

    memset(&s, 0, sizeof s);
    s.door.session = session;
    if (!make_token(s.door.token) || !open_door(&s, port))
        return false;
    pthread_mutex_init(&s.lock, NULL);
    pthread_cond_init(&s.gone, NULL);
    ok = say_address(&s.door);
    if (ok)
        listen_on(&s, stop);
    close(s.fd);
    session_quit(session);
    pthread_mutex_lock(&s.lock);
    while (s.connections)
        pthread_cond_wait(&s.gone, &s.lock);
    pthread_mutex_unlock(&s.lock);
    pthread_cond_destroy(&s.gone);
    pthread_mutex_destroy(&s.lock);
    return ok;
}
