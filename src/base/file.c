/* file.c -- files, whole or not at all. See file.h. */
#include "base/file.h"

#include "base/digest.h"
#include "base/error.h"
#include "base/mem.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static struct {
    pthread_mutex_t lock;
    unsigned long calls, fail_at;
    bool on;
    int  code;
} fault = { PTHREAD_MUTEX_INITIALIZER, 0, 0, false, 0 };

/* True if the operation about to be made has to fail; then errno is set. */
static bool faulty(void)
{
    bool f;
    int code;
    pthread_mutex_lock(&fault.lock);
    fault.calls++;
    f = fault.fail_at && (fault.calls == fault.fail_at ||
                          (fault.on && fault.calls > fault.fail_at));
    code = fault.code;
    pthread_mutex_unlock(&fault.lock);
    if (f)
        errno = code;
    return f;
}

void file_fail_at(unsigned long k, bool on, int code)
{
    pthread_mutex_lock(&fault.lock);
    fault.calls = 0;
    fault.fail_at = k;
    fault.on = on;
    fault.code = code;
    pthread_mutex_unlock(&fault.lock);
}

unsigned long file_calls(void)
{
    unsigned long n;
    pthread_mutex_lock(&fault.lock);
    n = fault.calls;
    pthread_mutex_unlock(&fault.lock);
    return n;
}

/* ---- reading ---- */

static struct { pthread_mutex_t lock; bool on; uint64_t sum; } all_read = {
    PTHREAD_MUTEX_INITIALIZER, false, 0
};

void file_digest_start(void)
{
    pthread_mutex_lock(&all_read.lock);
    all_read.on = true;
    all_read.sum = DIGEST_NOTHING;
    pthread_mutex_unlock(&all_read.lock);
}

uint64_t file_digest(void)
{
    uint64_t sum;
    pthread_mutex_lock(&all_read.lock);
    all_read.on = false;
    sum = all_read.sum;
    pthread_mutex_unlock(&all_read.lock);
    return sum;
}

/* The size, too: two files are another thing than one that has both. */
static void add_to_digest(const FileBytes *f)
{
    uint64_t size = f->size;
    unsigned char b[8];

    for (int k = 0; k < 8; k++)
        b[k] = (unsigned char)(size >> 8 * k);
    pthread_mutex_lock(&all_read.lock);
    if (all_read.on)
        all_read.sum = digest(digest(all_read.sum, b, sizeof b), f->bytes, f->size);
    pthread_mutex_unlock(&all_read.lock);
}

static ssize_t read_some(int fd, char *to, size_t n)
{
    ssize_t got;
    do
        got = faulty() ? -1 : read(fd, to, n);
    while (got < 0 && errno == EINTR);
    return got;
}

static bool read_open(int fd, const char *path, uint64_t limit, FileBytes *f)
{
    Place at = { path, 0, 0 };
    struct stat st;
    size_t have = 0;

    while (faulty() || fstat(fd, &st))
        if (errno != EINTR)
            return err_at(at, "cannot be read: %s", strerror(errno));
    if (S_ISDIR(st.st_mode))
        return err_at(at, "is a folder, a file was expected");
    if (!S_ISREG(st.st_mode))
        return err_at(at, "is not a regular file");
    if ((uint64_t)st.st_size > limit)
        return err_at(at, "has %.0f bytes, the limit is %.0f (--max-file)",
                      (double)st.st_size, (double)limit);
    f->bytes = mem_array((size_t)st.st_size + 1, 1);
    if (!f->bytes)
        return false;
    while (have < (size_t)st.st_size) {
        ssize_t got = read_some(fd, f->bytes + have, (size_t)st.st_size - have);
        if (got < 0)
            return err_at(at, "cannot be read: %s", strerror(errno));
        if (got == 0)
            break;                                       /* it shrank meanwhile */
        have += (size_t)got;
    }
    f->size = have;
    f->bytes[have] = 0;
    return true;
}

bool file_read(const char *path, uint64_t limit, FileBytes *f)
{
    int fd;
    bool ok;

    f->bytes = NULL;
    f->size = 0;
    do                                    /* O_NONBLOCK: a FIFO without a writer must not hang */
        fd = faulty() ? -1 : open(path, O_RDONLY | O_NONBLOCK);
    while (fd < 0 && errno == EINTR);
    if (fd < 0)
        return err_at((Place){ path, 0, 0 }, "cannot be opened: %s", strerror(errno));
    ok = read_open(fd, path, limit, f);
    close(fd);
    if (ok)
        add_to_digest(f);
    else
        file_clear(f);
    return ok;
}

void file_clear(FileBytes *f)
{
    mem_free(f->bytes);
    f->bytes = NULL;
    f->size = 0;
}

bool file_exists(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0;
}

/* ---- writing ---- */

struct Out {
    int    fd;
    int    error;                 /* errno of the first failure, 0 while all is well */
    bool   direct;                /* the name is a device or a pipe: no file beside it */
    char  *path, *temporary;      /* owned */
    size_t used;
    char   buffer[1 << 16];
};

static void out_flush(Out *o)
{
    size_t done = 0;
    while (!o->error && done < o->used) {
        ssize_t n = faulty() ? -1 : write(o->fd, o->buffer + done, o->used - done);
        if (n < 0 && errno != EINTR)
            o->error = errno;
        else if (n > 0)
            done += (size_t)n;
    }
    o->used = 0;
}

static void out_free(Out *o)
{
    mem_free(o->path);
    mem_free(o->temporary);
    mem_free(o);
}

/* Opens a name beside the final one that no other process uses. */
static bool open_temporary(Out *o)
{
    size_t room = strlen(o->path) + 40;
    o->temporary = mem_array(room, 1);
    if (!o->temporary)
        return false;
    for (int k = 0; k < 100; k++) {
        snprintf(o->temporary, room, "%s.%ld-%d.part", o->path, (long)getpid(), k);
        o->fd = faulty() ? -1 : open(o->temporary, O_WRONLY | O_CREAT | O_EXCL, 0666);
        if (o->fd >= 0)
            return true;
        if (errno != EEXIST && errno != EINTR)
            break;
    }
    return err_output(o->path, "cannot be written: %s", strerror(errno));
}

Out *out_open(const char *path)
{
    struct stat st;
    Out *o = MEM_NEW(Out);

    if (!o)
        return NULL;
    o->fd = -1;
    o->path = mem_string(path, strlen(path));
    if (!o->path)
        goto failed;
    if (stat(path, &st) == 0 && S_ISDIR(st.st_mode)) {
        err_output(path, "cannot be written: it is a folder");
        goto failed;
    }
    if (stat(path, &st) == 0 && !S_ISREG(st.st_mode)) {
        o->direct = true;
        do                              /* a pipe: waits for its reader */
            o->fd = faulty() ? -1 : open(path, O_WRONLY);
        while (o->fd < 0 && errno == EINTR);
        if (o->fd < 0) {
            err_output(path, "cannot be written: %s", strerror(errno));
            goto failed;
        }
    } else if (!open_temporary(o))
        goto failed;
    return o;
failed:
    out_free(o);
    return NULL;
}

void out_write(Out *o, const void *bytes, size_t n)
{
    const char *p = bytes;
    while (n) {
        size_t room = sizeof o->buffer - o->used, k = n < room ? n : room;
        memcpy(o->buffer + o->used, p, k);
        o->used += k;
        p += k;
        n -= k;
        if (o->used == sizeof o->buffer)
            out_flush(o);
    }
}

void out_text(Out *o, const char *s) { out_write(o, s, strlen(s)); }

void out_u32be(Out *o, uint32_t v)
{
    unsigned char b[4] = { (unsigned char)(v >> 24), (unsigned char)(v >> 16),
                           (unsigned char)(v >> 8), (unsigned char)v };
    out_write(o, b, 4);
}

/* A call that a signal interrupted begins again, but close: its descriptor is gone, and after
 * fsync there was nothing left to lose. EINVAL of fsync: not a file that can be synchronised. */
bool out_close(Out *o)
{
    out_flush(o);
    while (!o->error && !o->direct && (faulty() || fsync(o->fd)) && errno != EINVAL)
        if (errno != EINTR)
            o->error = errno;
    if (close(o->fd) && errno != EINTR && !o->error)    /* close in any case, then pretend */
        o->error = errno;
    if (faulty() && errno != EINTR && !o->error)
        o->error = errno;
    while (!o->error && !o->direct && (faulty() || rename(o->temporary, o->path)))
        if (errno != EINTR)
            o->error = errno;
    if (o->error) {
        if (!o->direct)
            unlink(o->temporary);
        err_output(o->path, "cannot be written: %s", strerror(o->error));
        out_free(o);
        return false;
    }
    out_free(o);
    return true;
}

void out_abort(Out *o)
{
    if (!o)
        return;
    close(o->fd);
    if (!o->direct)
        unlink(o->temporary);
    out_free(o);
}

bool out_possible(const char *path)
{
    struct stat st;
    Out *o;

    if (stat(path, &st) == 0 && !S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode))
        return true;
    o = out_open(path);
    out_abort(o);
    return o != NULL;
}

bool file_write(const char *path, const void *bytes, size_t n)
{
    Out *o = out_open(path);
    if (!o)
        return false;
    out_write(o, bytes, n);
    return out_close(o);
}

/* ---- names ---- */

char *path_beside(const char *from, const char *name)
{
    const char *slash = from ? strrchr(from, '/') : NULL;
    size_t folder = slash && name[0] != '/' ? (size_t)(slash - from) + 1 : 0;
    size_t n = strlen(name);
    char *path = mem_array(folder + n + 1, 1);

    if (!path)
        return NULL;
    if (folder)
        memcpy(path, from, folder);
    memcpy(path + folder, name, n);
    return path;
}

const char *path_extension(const char *path)
{
    const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
    return dot && (!slash || dot > slash) ? dot + 1 : "";
}
