/* replace.c - files that appear whole or not at all: written under another name, confirmed by the
 * disk (fsync), then renamed. A seal at the end, which HDF5 ignores, distinguishes a whole file
 * from one that was cut short or changed: 16 bytes of name, then length and checksum of what is
 * before it, little endian.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "replace.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

mps_status mpsi_fail_io(mps_context *context, const char *function, const char *verb,
                        const char *path, int error) {
  char reason[128] = "unknown error";
  if (error != 0) (void)strerror_r(error, reason, sizeof reason);
  return mpsi_fail(context, function, MPS_ERROR_IO, "cannot %s '%.300s': %s", verb, path, reason);
}

#define SEAL_SIZE 32
static const unsigned char seal_name[16] = "libmps seal 1\r\n";

/* ---- the seal -------------------------------------------------------------------------------- */

static uint64_t little_endian(const unsigned char *bytes) {
  uint64_t word = 0;
  for (int k = 7; k >= 0; k--) word = word << 8 | bytes[k];
  return word;
}

static void put_little_endian(unsigned char *bytes, uint64_t word) {
  for (int k = 0; k < 8; k++) bytes[k] = (unsigned char)(word >> 8 * k);
}

/* Bytes at an offset; fewer at the end of the file; -1 and errno on an error. */
static int64_t read_at(int fd, void *buffer, size_t size, int64_t offset) {
  size_t done = 0;
  while (done < size) {
    const ssize_t got = pread(fd, (char *)buffer + done, size - done, (off_t)offset + (off_t)done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    if (got == 0) break;
    done += (size_t)got;
  }
  return (int64_t)done;
}

/* Checksum of the first `size` bytes. Each step is one to one in the sum and in the word, so that a
 * change of any one word is always detected. False: errno. */
static bool checksum(int fd, int64_t size, uint64_t *out) {
  unsigned char buffer[4096];
  uint64_t sum = (uint64_t)size;
  for (int64_t done = 0; done < size;) {
    const size_t want =
        size - done < (int64_t)sizeof buffer ? (size_t)(size - done) : sizeof buffer;
    const int64_t got = read_at(fd, buffer, want, done);
    if (got < 0) return false;
    if (got == 0) break; /* grew shorter meanwhile */
    for (int64_t k = got; k % 8 != 0; k++) buffer[k] = 0;
    for (int64_t k = 0; k < got; k += 8) {
      sum = (sum ^ little_endian(buffer + k)) * 0x9e3779b97f4a7c15u;
      sum ^= sum >> 32;
    }
    done += got;
  }
  *out = sum;
  return true;
}

/* Appends the seal. False: errno. */
static bool seal(int fd) {
  unsigned char text[SEAL_SIZE];
  uint64_t sum;
  struct stat status;
  if (fstat(fd, &status) != 0 || !checksum(fd, status.st_size, &sum)) return false;
  memcpy(text, seal_name, sizeof seal_name);
  put_little_endian(text + 16, (uint64_t)status.st_size);
  put_little_endian(text + 24, sum);
  for (size_t done = 0; done < sizeof text;) {
    const ssize_t put = pwrite(fd, text + done, sizeof text - done, status.st_size + (off_t)done);
    if (put < 0 && errno == EINTR) continue;
    if (put == 0) errno = ENOSPC;
    if (put <= 0) return false;
    done += (size_t)put;
  }
  return true;
}

mps_status mpsi_seal_check(mps_context *context, const char *function, int fd, const char *path) {
  static const unsigned char hdf5[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
  unsigned char head[8], tail[SEAL_SIZE];
  struct stat status;
  if (fstat(fd, &status) != 0) return mpsi_fail_io(context, function, "read", path, errno);
  if (!S_ISREG(status.st_mode))
    return mpsi_fail(context, function, MPS_ERROR_IO, "cannot read '%.300s': not a file", path);
  const int64_t body = (int64_t)status.st_size - SEAL_SIZE;
  const int64_t first = read_at(fd, head, sizeof head, 0);
  const int64_t last = body < 0 ? 0 : read_at(fd, tail, sizeof tail, body);
  if (first < 0 || last < 0) return mpsi_fail_io(context, function, "read", path, errno);
  if (first < (int64_t)sizeof head || memcmp(head, hdf5, sizeof head) != 0)
    return mpsi_fail(context, function, MPS_ERROR_FORMAT,
                     "'%.300s' is not a checkpoint: it does not begin as an HDF5 file", path);
  if (last < SEAL_SIZE || memcmp(tail, seal_name, sizeof seal_name) != 0)
    return mpsi_fail(context, function, MPS_ERROR_FORMAT,
                     "'%.300s' is not a checkpoint, or cut short: it does not end with a seal",
                     path);
  uint64_t sum;
  if (!checksum(fd, body, &sum)) return mpsi_fail_io(context, function, "read", path, errno);
  if (little_endian(tail + 16) != (uint64_t)body || little_endian(tail + 24) != sum)
    return mpsi_fail(context, function, MPS_ERROR_FORMAT,
                     "'%.300s' is damaged: it is not what was sealed", path);
  return MPS_OK;
}

/* ---- replacing ------------------------------------------------------------------------------- */

static bool contains(const unsigned char *bytes, int64_t size, const char *text) {
  const int64_t length = (int64_t)strlen(text);
  for (int64_t k = 0; k + length <= size; k++)
    if (memcmp(bytes + k, text, (size_t)length) == 0) return true;
  return false;
}

/* The file is empty, is sealed, or, where it has been damaged since, begins as checkpoints do:
 * their first attribute is the name of the format. False with errno 0: none of these. */
static bool is_ours(const char *path, int64_t size) {
  unsigned char head[8192], tail[SEAL_SIZE];
  errno = 0;
  if (size == 0) return true;
  const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return false;
  const int64_t last = size < SEAL_SIZE ? 0 : read_at(fd, tail, sizeof tail, size - SEAL_SIZE);
  const int64_t first = last < 0 ? -1 : read_at(fd, head, sizeof head, 0);
  const int reason = errno;
  close(fd);
  errno = first < 0 ? reason : 0;
  if (last == SEAL_SIZE && memcmp(tail, seal_name, sizeof seal_name) == 0) return true;
  return contains(head, first, "\x89HDF\r\n\x1a\n") && contains(head, first, "libmps checkpoint");
}

/* A new name, an empty file or an earlier checkpoint may be replaced: a rename would also replace a
 * device, or any other file of the caller. */
static mps_status check_place(mps_context *context, const char *function, const char *path,
                              bool sealed) {
  struct stat status;
  if (stat(path, &status) != 0)
    return errno == ENOENT ? MPS_OK : mpsi_fail_io(context, function, "write", path, errno);
  if (!S_ISREG(status.st_mode))
    return mpsi_fail(context, function, MPS_ERROR_IO,
                     "cannot write '%.300s': it is a %s, not a file", path,
                     S_ISDIR(status.st_mode) ? "directory" : "device or pipe");
  if (!sealed || is_ours(path, (int64_t)status.st_size)) return MPS_OK;
  if (errno != 0) return mpsi_fail_io(context, function, "replace", path, errno);
  return mpsi_fail(context, function, MPS_ERROR_IO,
                   "cannot write '%.300s': the file there is no checkpoint, and is not replaced",
                   path);
}

/* True on file systems without locks. The lock ends with the descriptor. */
static bool lock(int fd) { return flock(fd, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK; }

/* Removes what a program that was killed has left under the temporary name. Anything but a file,
 * such as a link, stays, and so does a file that is being written. */
static mps_status clear_name(mps_context *context, const char *function, const char *part) {
  struct stat status;
  if (lstat(part, &status) != 0)
    return errno == ENOENT ? MPS_OK : mpsi_fail_io(context, function, "open", part, errno);
  if (!S_ISREG(status.st_mode))
    return mpsi_fail(context, function, MPS_ERROR_IO, "cannot write '%.300s': not a file", part);
  const int fd = open(part, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  const bool free = fd < 0 || lock(fd);
  if (free) (void)unlink(part);
  if (fd >= 0) close(fd);
  return free ? MPS_OK
              : mpsi_fail(context, function, MPS_ERROR_IO,
                          "cannot write '%.300s': it is being written by another program or thread",
                          part);
}

mps_status mpsi_replace_begin(mps_context *context, const char *function, const char *path,
                              bool sealed, mpsi_replacement *out) {
  const size_t size = strlen(path) + sizeof ".part";
  *out = (mpsi_replacement){.path = path, .fd = -1, .sealed = sealed};
  MPSI_TRY(check_place(context, function, path, sealed));
  out->part = mpsi_alloc(context, (int64_t)size, 1);
  if (!out->part) return mpsi_fail_memory(context, function, size);
  snprintf(out->part, size, "%s.part", path);
  mps_status status = clear_name(context, function, out->part);
  if (status == MPS_OK) {
    out->fd = open(out->part, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (out->fd < 0 || !lock(out->fd)) /* another began at the same time */
      status = mpsi_fail_io(context, function, "open", out->part, errno);
  }
  if (status == MPS_OK) return MPS_OK;
  if (out->fd >= 0) close(out->fd);
  out->fd = -1;
  mpsi_free(context, out->part);
  out->part = NULL;
  return status;
}

/* Lets the disk confirm the new name. Some file systems do not support that; then a crash may leave
 * either the former or the new file. */
static void confirm_name(char *part) {
  char *slash = strrchr(part, '/');
  if (slash) slash[slash == part] = '\0'; /* "/" stays */
  const int fd = open(slash ? part : ".", O_RDONLY | O_CLOEXEC);
  if (fd < 0) return;
  (void)fsync(fd);
  close(fd);
}

mps_status mpsi_replace_commit(mps_context *context, const char *function,
                               mpsi_replacement *replacement) {
  mps_status status = MPS_OK;
  if ((replacement->sealed && !seal(replacement->fd)) || fsync(replacement->fd) != 0)
    status = mpsi_fail_io(context, function, "write", replacement->part, errno);
  const int fd = replacement->fd;
  replacement->fd = -1;
  if (close(fd) != 0 && status == MPS_OK)
    status = mpsi_fail_io(context, function, "close", replacement->part, errno);
  if (status == MPS_OK && rename(replacement->part, replacement->path) != 0)
    status =
        mpsi_fail_io(context, function, "put a new file in the place of", replacement->path, errno);
  if (status == MPS_OK) {
    confirm_name(replacement->part);
    mpsi_free(context, replacement->part);
    replacement->part = NULL;
  }
  mpsi_replace_abandon(context, replacement);
  return status;
}

void mpsi_replace_abandon(mps_context *context, mpsi_replacement *replacement) {
  if (!replacement->part) return;
  if (replacement->fd >= 0) close(replacement->fd);
  (void)unlink(replacement->part);
  mpsi_free(context, replacement->part);
  *replacement = (mpsi_replacement){.fd = -1};
}
