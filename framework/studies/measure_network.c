// Times messages between ranks 0 and 1, from which measure_network.py computes LogGP parameters.
//
// After T. Hoefler, A. Lichei & W. Rehm, "Low-overhead LogGP parameter assessment for modern interconnection networks",
// IPDPS 2007. Prints one line per size: bytes, round trip of one message, round trip of a burst and one answer, send,
// receive of a message that is there already; all in seconds, each the second percentile of many. The one argument, if
// there is one, says of how many; at most 2000.
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

enum { most_repeats = 2000, burst = 16, tag = 1, largest = 3072 };  // below the eager limits of Open MPI

static int repeats = most_repeats;
static char buffer[largest];

static void send_to(int rank, int bytes) { MPI_Send(buffer, bytes, MPI_BYTE, rank, tag, MPI_COMM_WORLD); }
static void receive_from(int rank, int bytes) {
  MPI_Recv(buffer, bytes, MPI_BYTE, rank, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

static int less(const void* a, const void* b) {
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

// What the machine does besides only adds time; the very least may be an accident of the clock.
static double undisturbed(double* times) {
  qsort(times, repeats, sizeof(double), less);
  return times[repeats / 50];
}

// Of `n` messages there and one back.
static double round_trip(int rank, int bytes, int n) {
  static double times[most_repeats];
  for (int i = 0; i < repeats; ++i) {
    const double start = MPI_Wtime();
    if (rank == 0) {
      for (int k = 0; k < n; ++k) send_to(1, bytes);
      receive_from(1, bytes);
    } else {
      for (int k = 0; k < n; ++k) receive_from(0, bytes);
      send_to(0, bytes);
    }
    times[i] = MPI_Wtime() - start;
  }
  return undisturbed(times);
}

static double clock_cost(void) {
  static double times[most_repeats];
  for (int i = 0; i < repeats; ++i) {
    const double start = MPI_Wtime();
    times[i] = MPI_Wtime() - start;
  }
  return undisturbed(times);
}

// Of a send, and of a receive that begins `pause` after it, when the answer has come.
static void overheads(int rank, int bytes, double pause, double* send, double* receive) {
  static double sent[most_repeats], received[most_repeats];
  for (int i = 0; i < repeats; ++i) {
    if (rank != 0) {
      receive_from(0, bytes);
      send_to(0, bytes);
      continue;
    }
    double start = MPI_Wtime();
    send_to(1, bytes);
    sent[i] = MPI_Wtime() - start;
    start = MPI_Wtime();
    while (MPI_Wtime() < start + pause) {
    }
    start = MPI_Wtime();
    receive_from(1, bytes);
    received[i] = MPI_Wtime() - start;
  }
  const double cost = clock_cost();
  *send = undisturbed(sent) - cost;
  *receive = undisturbed(received) - cost;
}

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int rank, size;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (size != 2) {
    if (rank == 0) fprintf(stderr, "%d ranks; expected 2\n", size);
    MPI_Finalize();
    return 2;
  }
  if (argc > 1 && atoi(argv[1]) > 0 && atoi(argv[1]) < most_repeats) repeats = atoi(argv[1]);
  round_trip(rank, 1, 1);  // warms up
  const int sizes[] = {1, 64, 256, 512, 1024, 2048, 3072};
  for (unsigned k = 0; k < sizeof sizes / sizeof sizes[0]; ++k) {
    const double one = round_trip(rank, sizes[k], 1), many = round_trip(rank, sizes[k], burst);
    double send, receive;
    overheads(rank, sizes[k], 20.0 * one, &send, &receive);
    if (rank == 0) printf("%d %.9e %.9e %d %.9e %.9e\n", sizes[k], one, many, (int)burst, send, receive);
  }
  MPI_Finalize();
  return 0;
}
