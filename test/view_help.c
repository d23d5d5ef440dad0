/* view_help.c -- see view_help.h. */
#include "test/view_help.h"

#include "base/clock.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

void view_start(View *v, const char *options)
{
    const struct timespec pause = { 0, 5000000 };
    char text[200] = "";

    v->run = cli_start(NULL, "view tiny.pbrt --threads 2 %s", options);
    while (!strchr(text, '\n')) {
        ssize_t n = pread(fileno(v->run.stream[0]), text, sizeof text - 1, 0);
        REQUIRE(n >= 0, "pread: %s", strerror(errno));
        text[n] = 0;
        nanosleep(&pause, NULL);
    }
    REQUIRE(sscanf(text, "http://127.0.0.1:%d/%32[0-9a-f]/\n", &v->port, v->token) == 2 &&
            strlen(v->token) == TOKEN_LENGTH, "the address: %s", text);
}

void view_end(View *v)
{
    double start = clock_wall();

    kill(v->run.pid, SIGINT);
    cli_wait(&v->run);
    EXPECT(v->run.status == 0, "status %d: %s", v->run.status, v->run.err);
    EXPECT(clock_wall() - start < 10, "it takes %.1f s to end", clock_wall() - start);
}

int dial(unsigned long address, int port)
{
    struct sockaddr_in to;
    int fd = socket(AF_INET, SOCK_STREAM, 0);

    memset(&to, 0, sizeof to);
    to.sin_family = AF_INET;
    to.sin_port = htons((uint16_t)port);
    to.sin_addr.s_addr = htonl((uint32_t)address);
    REQUIRE(fd >= 0, "socket: %s", strerror(errno));
    if (connect(fd, (struct sockaddr *)&to, sizeof to) == 0)
        return fd;
    close(fd);
    return -1;
}
