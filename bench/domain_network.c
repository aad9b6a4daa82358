/* domain_network.c - what messages between ranks cost here, for the model of bench-partition:
 * mpirun -n N bench-domain-network [BYTES [ROUNDS]]. In a round each rank sends BYTES (1e6) to a
 * rank half of all away and gets as many from one; then all reduce nine numbers, as solvers do in a
 * step. SPDX-License-Identifier: BSD-3-Clause */
#include "measure.h"

#include <mpi.h>

typedef struct times {
  double least, median; /* s, of the slowest rank in a round */
} times;

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static times of_rounds(int rounds, double *round) {
  MPI_Allreduce(MPI_IN_PLACE, round, rounds, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
  qsort(round, (size_t)rounds, sizeof *round, ascending);
  return (times){round[0], round[rounds / 2]};
}

static times swap_messages(int bytes, int rounds, char *out, char *in, double *round) {
  int rank, size;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  const int half = size > 1 ? size / 2 : 0, to = (rank + half) % size,
            from = (rank + size - half) % size;
  for (int k = 0; k < rounds; k++) {
    MPI_Request request[2];
    MPI_Barrier(MPI_COMM_WORLD);
    const double start = seconds();
    MPI_Irecv(in, bytes, MPI_BYTE, from, 0, MPI_COMM_WORLD, &request[0]);
    MPI_Isend(out, bytes, MPI_BYTE, to, 0, MPI_COMM_WORLD, &request[1]);
    MPI_Waitall(2, request, MPI_STATUSES_IGNORE);
    round[k] = seconds() - start;
  }
  return of_rounds(rounds, round);
}

static times reduce_numbers(int rounds, double *round) {
  double number[9] = {0.0};
  for (int k = 0; k < rounds; k++) {
    MPI_Barrier(MPI_COMM_WORLD);
    const double start = seconds();
    MPI_Allreduce(MPI_IN_PLACE, number, 9, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    round[k] = seconds() - start;
  }
  return of_rounds(rounds, round);
}

int main(int argc, char **argv) {
  const double bytes = argc > 1 ? atof(argv[1]) : 1e6, rounds = argc > 2 ? atof(argv[2]) : 300;
  int rank, size;
  MPI_Init(&argc, &argv);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  char *out = calloc((size_t)bytes + 1, 1), *in = calloc((size_t)bytes + 1, 1);
  double *round = calloc((size_t)rounds + 1, sizeof *round);
  if (!(bytes >= 1.0 && bytes < 2e9 && rounds >= 1.0 && rounds < 1e6) || !out || !in || !round) {
    fprintf(stderr,
            "bench-domain-network: BYTES in 1..2e9, ROUNDS in 1..1e6, and memory for them\n");
    MPI_Abort(MPI_COMM_WORLD, 2);
  }
  const times message = swap_messages((int)bytes, (int)rounds, out, in, round);
  const times reduction = reduce_numbers((int)rounds, round);
  if (rank == 0)
    printf("%d ranks, %.3g MB: %.4f ms (least), %.4f (median), %.2f GB/s into a rank (least); a "
           "reduction %.4f ms (least), %.4f (median)\n",
           size, 1e-6 * bytes, 1e3 * message.least, 1e3 * message.median,
           1e-9 * bytes / message.least, 1e3 * reduction.least, 1e3 * reduction.median);
  free(out);
  free(in);
  free(round);
  MPI_Finalize();
  return 0;
}
