/* xdmf.c - see xdmf.h. XDMF version 2: a temporal collection of grids of one Polyvertex cell each,
 * whose arrays are hyperslabs of the datasets of the series. Nothing is copied. After each frame
 * the file is whole. SPDX-License-Identifier: BSD-3-Clause */
#include "xdmf.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char head[] =
    "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
    "<Grid Name=\"series\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
static const char tail[] = "</Grid>\n</Domain>\n</Xdmf>\n";

static void check(mpsi_xdmf *x, bool good) {
  if (!good && !x->error) x->error = errno ? errno : EIO;
}

static const char *name_of(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

mps_status mpsi_xdmf_check(mps_context *context, const char *function, const char *path) {
  if (!strpbrk(name_of(path), ":<>&\"")) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "path is '%.300s': with xdmf the name of the file must have none of : < > & \"",
                   path);
}

mps_status mpsi_xdmf_open(mps_context *context, const char *function, const char *path,
                          mpsi_xdmf *out) {
  static const char ending[] = ".vtkhdf";
  const size_t length = strlen(path), cut = sizeof ending - 1;
  const bool ends = length > cut && strcmp(path + length - cut, ending) == 0;
  *out = (mpsi_xdmf){.fd = -1, .series = name_of(path)};
  out->path = mpsi_alloc(context, (int64_t)length + 6, 1);
  if (!out->path) return mpsi_fail_memory(context, function, length + 6);
  (void)snprintf(out->path, length + 6, "%.*s.xdmf", (int)(ends ? length - cut : length), path);
  out->fd = open(out->path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (out->fd < 0) return mpsi_fail_io(context, function, "open", out->path, errno);
  if (dprintf(out->fd, "%s%s", head, tail) < 0)
    return mpsi_fail_io(context, function, "write", out->path, errno);
  return MPS_OK;
}

void mpsi_xdmf_begin(mpsi_xdmf *x, int64_t at, double time, int64_t count) {
  char text[40];
  if (at == 0) at = sizeof head - 1;
  (void)snprintf(text, sizeof text, "%.17g", time);
  char *comma = strchr(text, ','); /* of the host's locale */
  if (comma) *comma = '.';
  check(x, lseek(x->fd, (off_t)at, SEEK_SET) >= 0);
  if (count == 0) return;
  check(x, dprintf(x->fd,
                   "<Grid Name=\"particles\">\n<Time Value=\"%s\"/>\n"
                   "<Topology TopologyType=\"Polyvertex\" NumberOfElements=\"%" PRId64
                   "\" NodesPerElement=\"1\"/>\n",
                   text, count) > 0);
}

/* Rows [first, first + count) of a dataset, of which the rows behind them are not described. */
static void write_slab(mpsi_xdmf *x, const char *group, const char *name, mpsi_item item,
                       int32_t width, int64_t first, int64_t count) {
  const char *kind = item == MPSI_ITEM_F64 ? "Float" : "Int";
  if (width > 0)
    check(x, dprintf(x->fd,
                     "<DataItem ItemType=\"HyperSlab\" Dimensions=\"%" PRId64 " %d\">"
                     "<DataItem Dimensions=\"3 2\" Format=\"XML\">%" PRId64 " 0 1 1 %" PRId64
                     " %d</DataItem>"
                     "<DataItem Dimensions=\"%" PRId64
                     " %d\" NumberType=\"%s\" Precision=\"8\" Format=\"HDF\">"
                     "%s:/VTKHDF/%s%s</DataItem></DataItem>",
                     count, (int)width, first, count, (int)width, first + count, (int)width, kind,
                     x->series, group, name) > 0);
  else
    check(x,
          dprintf(x->fd,
                  "<DataItem ItemType=\"HyperSlab\" Dimensions=\"%" PRId64 "\">"
                  "<DataItem Dimensions=\"3 1\" Format=\"XML\">%" PRId64 " 1 %" PRId64 "</DataItem>"
                  "<DataItem Dimensions=\"%" PRId64
                  "\" NumberType=\"%s\" Precision=\"8\" Format=\"HDF\">"
                  "%s:/VTKHDF/%s%s</DataItem></DataItem>",
                  count, first, count, first + count, kind, x->series, group, name) > 0);
}

void mpsi_xdmf_array(mpsi_xdmf *x, const char *name, mpsi_item item, int32_t width, int64_t first,
                     int64_t count) {
  if (name) {
    const char *type = width <= 1 ? "Scalar" : width == 3 ? "Vector" : "Matrix";
    check(x, dprintf(x->fd, "<Attribute Name=\"%s\" AttributeType=\"%s\" Center=\"Node\">", name,
                     type) > 0);
    write_slab(x, "PointData/", name, item, width, first, count);
    check(x, dprintf(x->fd, "</Attribute>\n") > 0);
  } else {
    check(x, dprintf(x->fd, "<Geometry GeometryType=\"XYZ\">") > 0);
    write_slab(x, "Points", "", item, width, first, count);
    check(x, dprintf(x->fd, "</Geometry>\n") > 0);
  }
}

int64_t mpsi_xdmf_end(mpsi_xdmf *x, int64_t count) {
  if (count > 0) check(x, dprintf(x->fd, "</Grid>\n") > 0);
  const off_t next = lseek(x->fd, 0, SEEK_CUR);
  check(x, next >= 0 && dprintf(x->fd, "%s", tail) > 0);
  check(x, !x->error && ftruncate(x->fd, next + (off_t)(sizeof tail - 1)) == 0);
  return x->error ? -1 : (int64_t)next;
}
