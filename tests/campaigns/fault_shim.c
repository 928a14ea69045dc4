/* Lets the K-th system call of output fail, or ends the process there. To be preloaded (LD_PRELOAD) by the campaigns.
 *
 * Counted are calls on files in KERF_FAULT_FOLDER, and writes to the standard output: open, close, read, write, sync,
 * truncate, rename, unlink and mkdir. Environment:
 *   KERF_FAULT_FOLDER  absolute path of the folder
 *   KERF_FAULT_AT      K; 0 or absent to count only
 *   KERF_FAULT_KIND    kill: the process ends before the call. tear: the first pages of the block are written, then the
 *                      process ends. full: part of the block is written, and from then on there is no space left.
 *                      A number: the call fails with this errno.
 *   KERF_FAULT_RANK    the rank that is meant; others only count
 *   KERF_FAULT_COUNT   a file "<this>.<rank>" gets the number of calls when the process ends in good order
 *   KERF_FAULT_LOG     a file "<this>.<rank>" gets a line per call
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

enum { n_descriptors = 4096, page = 4096 };

static char watched[n_descriptors];
static long calls, fault_at;
static const char *folder, *kind;
static int is_full, log_id = -1;

static int is_program(void) { return strcmp(program_invocation_short_name, "kerf") == 0; }

static const char* rank_text(void) {
  const char* rank = getenv("OMPI_COMM_WORLD_RANK");
  return rank ? rank : "0";
}

__attribute__((constructor)) static void begin(void) {
  if (!is_program()) return; /* but a helper that MPI starts */
  folder = getenv("KERF_FAULT_FOLDER");
  kind = getenv("KERF_FAULT_KIND");
  const char *at = getenv("KERF_FAULT_AT"), *rank = getenv("KERF_FAULT_RANK"), *log = getenv("KERF_FAULT_LOG");
  if (at && kind && strcmp(rank ? rank : "0", rank_text()) == 0) fault_at = atol(at);
  watched[STDOUT_FILENO] = folder != NULL;
  if (log) {
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s.%s", log, rank_text());
    int (*real_open)(const char*, int, ...);
    *(void**)&real_open = dlsym(RTLD_NEXT, "open");
    log_id = real_open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  }
}

__attribute__((destructor)) static void end(void) {
  const char* count = getenv("KERF_FAULT_COUNT");
  if (!count || !folder) return;
  char path[PATH_MAX];
  snprintf(path, sizeof path, "%s.%s", count, rank_text());
  FILE* out = fopen(path, "w");
  if (!out) return;
  fprintf(out, "%ld\n", calls);
  fclose(out);
}

static int is_inside(const char* path) {
  char absolute[PATH_MAX];
  if (!folder || !path) return 0;
  if (path[0] == '/') {
    snprintf(absolute, sizeof absolute, "%s", path);
  } else {
    char here[PATH_MAX];
    if (!getcwd(here, sizeof here) || strlen(here) + strlen(path) + 2 > sizeof absolute) return 0;
    strcpy(absolute, here);
    strcat(absolute, "/");
    strcat(absolute, path);
  }
  return strncmp(absolute, folder, strlen(folder)) == 0;
}

static int is_watched(int id) { return id >= 0 && id < n_descriptors && watched[id]; }

static void die(void) {
  kill(getpid(), SIGKILL);
  for (;;) pause();
}

/* Counts a call. Returns the errno that it has to fail with, 0 for none, -1 for a write to be cut short. */
static int next_call(const char* name, int needs_space) {
  ++calls;
  if (log_id >= 0) {
    char line[64];
    const int n = snprintf(line, sizeof line, "%ld %s\n", calls, name);
    ssize_t (*real_write)(int, const void*, size_t);
    *(void**)&real_write = dlsym(RTLD_NEXT, "write");
    if (real_write(log_id, line, (size_t)n) < 0) _exit(99);
  }
  if (is_full && needs_space) return ENOSPC;
  if (fault_at == 0 || calls != fault_at) return 0;
  if (strcmp(kind, "kill") == 0) die();
  if (strcmp(kind, "tear") == 0) {
    if (needs_space != 2) die();
    return -1;
  }
  if (strcmp(kind, "full") == 0) {
    is_full = 1;
    return needs_space == 2 ? -1 : needs_space ? ENOSPC : 0;
  }
  return atoi(kind);
}

static int fails(const char* name, int needs_space) {
  const int error = next_call(name, needs_space);
  if (error > 0) errno = error;
  return error > 0;
}

/* How much of a block is written at the fault. Systems write whole pages; what is appended may end anywhere. */
static size_t cut_short(size_t n, const char* name) {
  return strcmp(kind, "full") == 0 && strcmp(name, "write") == 0 ? (n + 1) / 2 : n / 2 / page * page;
}

static int note_open(int id) {
  if (id >= 0 && id < n_descriptors) watched[id] = 1;
  return id;
}

#define OPEN(name)                                        \
  int name(const char* path, int flags, ...) {            \
    static int (*real)(const char*, int, ...);            \
    if (!real) *(void**)&real = dlsym(RTLD_NEXT, #name);  \
    mode_t mode = 0;                                      \
    if (flags & O_CREAT) {                                \
      va_list list;                                       \
      va_start(list, flags);                              \
      mode = va_arg(list, mode_t);                        \
      va_end(list);                                       \
    }                                                     \
    if (!is_inside(path)) return real(path, flags, mode); \
    if (fails("open", (flags & O_CREAT) != 0)) return -1; \
    return note_open(real(path, flags, mode));            \
  }
OPEN(open)
OPEN(open64)

int close(int id) {
  static int (*real)(int);
  if (!real) *(void**)&real = dlsym(RTLD_NEXT, "close");
  if (!is_watched(id)) return real(id);
  const int failed = id != STDOUT_FILENO && fails("close", 0), error = errno;
  watched[id] = 0;
  const int result = real(id);
  if (!failed) return result;
  errno = error;
  return -1;
}

static ssize_t write_with(ssize_t (*put)(int, const void*, size_t, off_t), int id, const void* bytes, size_t n,
                          off_t place, const char* name) {
  if (!is_watched(id)) return put(id, bytes, n, place);
  const int error = next_call(name, 2);
  if (error > 0) {
    errno = error;
    return -1;
  }
  if (error == 0) return put(id, bytes, n, place);
  n = cut_short(n, name);
  const ssize_t written = n > 0 ? put(id, bytes, n, place) : -1;
  if (strcmp(kind, "tear") == 0) die();
  if (n == 0) errno = ENOSPC;
  return written;
}

static ssize_t plain_write(int id, const void* bytes, size_t n, off_t place) {
  static ssize_t (*real)(int, const void*, size_t);
  if (!real) *(void**)&real = dlsym(RTLD_NEXT, "write");
  (void)place;
  return real(id, bytes, n);
}

static ssize_t placed_write(int id, const void* bytes, size_t n, off_t place) {
  static ssize_t (*real)(int, const void*, size_t, off_t);
  if (!real) *(void**)&real = dlsym(RTLD_NEXT, "pwrite");
  return real(id, bytes, n, place);
}

ssize_t write(int id, const void* bytes, size_t n) { return write_with(plain_write, id, bytes, n, 0, "write"); }
ssize_t pwrite(int id, const void* bytes, size_t n, off_t place) {
  return write_with(placed_write, id, bytes, n, place, "pwrite");
}
ssize_t pwrite64(int id, const void* bytes, size_t n, off64_t place) {
  return write_with(placed_write, id, bytes, n, place, "pwrite");
}

#define READ(name)                                           \
  ssize_t name(int id, void* bytes, size_t n, off_t place) { \
    static ssize_t (*real)(int, void*, size_t, off_t);       \
    if (!real) *(void**)&real = dlsym(RTLD_NEXT, #name);     \
    if (is_watched(id) && fails("pread", 0)) return -1;      \
    return real(id, bytes, n, place);                        \
  }
READ(pread)
READ(pread64)

#define SYNC(name)                                       \
  int name(int id) {                                     \
    static int (*real)(int);                             \
    if (!real) *(void**)&real = dlsym(RTLD_NEXT, #name); \
    if (is_watched(id) && fails(#name, 0)) return -1;    \
    return real(id);                                     \
  }
SYNC(fsync)
SYNC(fdatasync)

#define TRUNCATE(name)                                      \
  int name(int id, off_t size) {                            \
    static int (*real)(int, off_t);                         \
    if (!real) *(void**)&real = dlsym(RTLD_NEXT, #name);    \
    if (is_watched(id) && fails("ftruncate", 0)) return -1; \
    return real(id, size);                                  \
  }
TRUNCATE(ftruncate)
TRUNCATE(ftruncate64)

int rename(const char* from, const char* to) {
  static int (*real)(const char*, const char*);
  if (!real) *(void**)&real = dlsym(RTLD_NEXT, "rename");
  if (is_inside(to) && fails("rename", 0)) return -1;
  return real(from, to);
}

int unlink(const char* path) {
  static int (*real)(const char*);
  if (!real) *(void**)&real = dlsym(RTLD_NEXT, "unlink");
  if (is_inside(path) && fails("unlink", 0)) return -1;
  return real(path);
}

int mkdir(const char* path, mode_t mode) {
  static int (*real)(const char*, mode_t);
  if (!real) *(void**)&real = dlsym(RTLD_NEXT, "mkdir");
  if (is_inside(path) && fails("mkdir", 1)) return -1;
  return real(path, mode);
}
