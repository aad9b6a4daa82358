/* domain_counts.c - see domain_counts.h. SPDX-License-Identifier: BSD-3-Clause */
#include "domain_counts.h"

#include "measure.h"

#include <mpi.h>

enum { REQUESTS = 4096 }; /* persistent ones */

domain_counts domain_count;
static struct {
  MPI_Request request;
  int64_t bytes; /* of sends */
} known[REQUESTS];
static int known_count;

static int64_t bytes_of(int count, MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  return (int64_t)count * size;
}

int MPI_Allreduce(const void *from, void *to, int count, MPI_Datatype type, MPI_Op op,
                  MPI_Comm comm) {
  const double start = seconds();
  const int code = PMPI_Allreduce(from, to, count, type, op, comm);
  domain_count.reducing += seconds() - start;
  domain_count.reductions++;
  return code;
}

/* One that a rank waits for later. */
int MPI_Iallreduce(const void *from, void *to, int count, MPI_Datatype type, MPI_Op op,
                   MPI_Comm comm, MPI_Request *request) {
  const double start = seconds();
  const int code = PMPI_Iallreduce(from, to, count, type, op, comm, request);
  domain_count.reducing += seconds() - start;
  domain_count.reductions++;
  return code;
}

int MPI_Wait(MPI_Request *request, MPI_Status *status) {
  const double start = seconds();
  const int code = PMPI_Wait(request, status);
  domain_count.reducing += seconds() - start;
  return code;
}

int MPI_Isend(const void *data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm,
              MPI_Request *request) {
  const double start = seconds();
  const int code = PMPI_Isend(data, count, type, to, tag, comm, request);
  domain_count.posting += seconds() - start;
  domain_count.messages++;
  domain_count.bytes += bytes_of(count, type);
  return code;
}

int MPI_Send_init(const void *data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm,
                  MPI_Request *request) {
  const int code = PMPI_Send_init(data, count, type, to, tag, comm, request);
  if (known_count < REQUESTS) {
    known[known_count].request = *request;
    known[known_count++].bytes = bytes_of(count, type);
  }
  return code;
}

int MPI_Startall(int count, MPI_Request *requests) {
  const double start = seconds();
  const int code = PMPI_Startall(count, requests);
  domain_count.posting += seconds() - start;
  for (int i = 0; i < count; i++)
    for (int k = known_count - 1; k >= 0; k--) {
      if (known[k].request != requests[i]) continue;
      domain_count.messages++;
      domain_count.bytes += known[k].bytes;
      break;
    }
  return code;
}

int MPI_Request_free(MPI_Request *request) {
  for (int k = 0; k < known_count; k++)
    if (known[k].request == *request) known[k] = known[--known_count];
  return PMPI_Request_free(request);
}

int MPI_Waitall(int count, MPI_Request *requests, MPI_Status *statuses) {
  const double start = seconds();
  const int code = PMPI_Waitall(count, requests, statuses);
  domain_count.waiting += seconds() - start;
  return code;
}
