// A library for LD_PRELOAD that counts what a program says to other ranks, through the profiling interface of MPI.
//
// Kerf marks its cycles and phases with MPI_Pcontrol (core/marks.hpp). At MPI_Finalize every rank writes what it has
// counted to the file "<KERF_MESSAGE_COUNTS>.<rank>.json": calls, bytes and seconds per function and phase, and per
// cycle the collective operations, messages, bytes and seconds of its step, without output, observers and re-balancing.
// Other libraries that watch MPI (mpiP, Score-P, EZTrace) need the same names of functions: use one of them at a time.
#include <mpi.h>

#include <array>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/marks.hpp"

namespace {

/// What is counted of a function in a phase, or of everything in a cycle.
struct Count {
  std::int64_t calls = 0, bytes = 0;
  double seconds = 0.0;
};

struct Cycle {
  std::int64_t number = 0, collectives = 0, messages = 0, bytes = 0;
  double seconds = 0.0;
};

enum class Kind { collective, message, wait };

struct Book {
  int phase = 0, depth = 0;
  std::map<std::pair<int, const char*>, std::pair<Kind, Count>> by_phase;
  bool beside = false;  // whether this is no part of a step: output, observers, re-balancing
  std::vector<Cycle> cycles;
};

Book& book() {
  static Book the_book;
  return the_book;
}

std::int64_t bytes_of(int count, MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  return static_cast<std::int64_t>(count) * size;
}

/// One call of a function. Functions that the MPI library calls within another one do not count.
class Call {
 public:
  Call(Kind kind, const char* name, std::int64_t bytes)
      : kind_(kind), name_(name), bytes_(bytes), start_(PMPI_Wtime()) {
    ++book().depth;
  }
  ~Call() {
    Book& b = book();
    if (--b.depth > 0) return;
    const double seconds = PMPI_Wtime() - start_;
    auto& [kind, count] = b.by_phase[{b.phase, name_}];
    kind = kind_;
    ++count.calls;
    count.bytes += bytes_;
    count.seconds += seconds;
    if (b.cycles.empty() || b.beside) return;
    Cycle& c = b.cycles.back();
    c.collectives += kind_ == Kind::collective ? 1 : 0;
    c.messages += kind_ == Kind::message ? 1 : 0;
    c.bytes += bytes_;
    c.seconds += seconds;
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

 private:
  Kind kind_;
  const char* name_;
  std::int64_t bytes_;
  double start_;
};

const char* name_of(Kind kind) {
  return kind == Kind::collective ? "collective" : kind == Kind::message ? "message" : "wait";
}

void write_book() {
  const char* path = std::getenv("KERF_MESSAGE_COUNTS");
  if (path == nullptr) return;
  int rank = 0;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  const std::string file = std::string(path) + "." + std::to_string(rank) + ".json";
  std::FILE* out = std::fopen(file.c_str(), "w");
  if (out == nullptr) {
    std::fprintf(stderr, "cannot write the counts of messages to %s\n", file.c_str());
    return;
  }
  std::fprintf(out, "{\"rank\": %d,\n\"functions\": [", rank);
  const char* comma = "\n";
  for (const auto& [key, entry] : book().by_phase) {
    std::fprintf(out, "%s{\"phase\": %d, \"function\": \"%s\", \"kind\": \"%s\", \"calls\": %lld, \"bytes\": %lld, ",
                 comma, key.first, key.second, name_of(entry.first), static_cast<long long>(entry.second.calls),
                 static_cast<long long>(entry.second.bytes));
    std::fprintf(out, "\"seconds\": %.9g}", entry.second.seconds);
    comma = ",\n";
  }
  std::fprintf(out, "],\n\"cycles\": [");
  comma = "\n";
  for (const Cycle& c : book().cycles) {
    std::fprintf(out, "%s[%lld, %lld, %lld, %lld, %.6g]", comma, static_cast<long long>(c.number),
                 static_cast<long long>(c.collectives), static_cast<long long>(c.messages),
                 static_cast<long long>(c.bytes), c.seconds);
    comma = ",\n";
  }
  std::fprintf(out, "]}\n");
  const bool is_whole = std::ferror(out) == 0;
  if (std::fclose(out) != 0 || !is_whole)
    std::fprintf(stderr, "the counts of messages in %s are not whole; is the disk full?\n", file.c_str());
}

std::int64_t sum_of(const int* counts, int n, MPI_Datatype type) {
  std::int64_t sum = 0;
  for (int r = 0; r < n; ++r) sum += bytes_of(counts[r], type);
  return sum;
}

int size_of(MPI_Comm comm) {
  int n = 1;
  PMPI_Comm_size(comm, &n);
  return n;
}

}  // namespace

extern "C" {

int MPI_Pcontrol(const int level, ...) {
  if (level >= kerf::marks::phase) {
    book().beside = level >= kerf::marks::beside;
    book().phase = level - (book().beside ? kerf::marks::beside : kerf::marks::phase);
  } else if (level == kerf::marks::cycle) {
    std::va_list arguments;
    va_start(arguments, level);
    book().cycles.push_back({.number = va_arg(arguments, int)});
    va_end(arguments);
  }
  return MPI_SUCCESS;
}

int MPI_Finalize() {
  write_book();
  return PMPI_Finalize();
}

// ---- collective operations ----------------------------------------------------------------------------------------

int MPI_Barrier(MPI_Comm comm) {
  const Call call(Kind::collective, "Barrier", 0);
  return PMPI_Barrier(comm);
}
int MPI_Ibarrier(MPI_Comm comm, MPI_Request* request) {
  const Call call(Kind::collective, "Ibarrier", 0);
  return PMPI_Ibarrier(comm, request);
}
int MPI_Bcast(void* data, int n, MPI_Datatype type, int root, MPI_Comm comm) {
  const Call call(Kind::collective, "Bcast", bytes_of(n, type));
  return PMPI_Bcast(data, n, type, root, comm);
}
int MPI_Reduce(const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, int root, MPI_Comm comm) {
  const Call call(Kind::collective, "Reduce", bytes_of(n, type));
  return PMPI_Reduce(in, out, n, type, op, root, comm);
}
int MPI_Allreduce(const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  const Call call(Kind::collective, "Allreduce", bytes_of(n, type));
  return PMPI_Allreduce(in, out, n, type, op, comm);
}
int MPI_Iallreduce(const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm, MPI_Request* r) {
  const Call call(Kind::collective, "Iallreduce", bytes_of(n, type));
  return PMPI_Iallreduce(in, out, n, type, op, comm, r);
}
int MPI_Scan(const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  const Call call(Kind::collective, "Scan", bytes_of(n, type));
  return PMPI_Scan(in, out, n, type, op, comm);
}
int MPI_Exscan(const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  const Call call(Kind::collective, "Exscan", bytes_of(n, type));
  return PMPI_Exscan(in, out, n, type, op, comm);
}
int MPI_Reduce_scatter(const void* in, void* out, const int* n, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  const Call call(Kind::collective, "Reduce_scatter", sum_of(n, size_of(comm), type));
  return PMPI_Reduce_scatter(in, out, n, type, op, comm);
}
int MPI_Reduce_scatter_block(const void* in, void* out, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  const Call call(Kind::collective, "Reduce_scatter_block", bytes_of(n, type) * size_of(comm));
  return PMPI_Reduce_scatter_block(in, out, n, type, op, comm);
}
int MPI_Gather(const void* in, int n_in, MPI_Datatype type_in, void* out, int n, MPI_Datatype type, int root,
               MPI_Comm comm) {
  const Call call(Kind::collective, "Gather", in == MPI_IN_PLACE ? 0 : bytes_of(n_in, type_in));
  return PMPI_Gather(in, n_in, type_in, out, n, type, root, comm);
}
int MPI_Gatherv(const void* in, int n_in, MPI_Datatype type_in, void* out, const int* n, const int* at,
                MPI_Datatype type, int root, MPI_Comm comm) {
  const Call call(Kind::collective, "Gatherv", in == MPI_IN_PLACE ? 0 : bytes_of(n_in, type_in));
  return PMPI_Gatherv(in, n_in, type_in, out, n, at, type, root, comm);
}
int MPI_Allgather(const void* in, int n_in, MPI_Datatype type_in, void* out, int n, MPI_Datatype type, MPI_Comm comm) {
  const Call call(Kind::collective, "Allgather", bytes_of(n, type));
  return PMPI_Allgather(in, n_in, type_in, out, n, type, comm);
}
int MPI_Allgatherv(const void* in, int n_in, MPI_Datatype type_in, void* out, const int* n, const int* at,
                   MPI_Datatype type, MPI_Comm comm) {
  const Call call(Kind::collective, "Allgatherv", in == MPI_IN_PLACE ? 0 : bytes_of(n_in, type_in));
  return PMPI_Allgatherv(in, n_in, type_in, out, n, at, type, comm);
}
int MPI_Scatter(const void* in, int n_in, MPI_Datatype type_in, void* out, int n, MPI_Datatype type, int root,
                MPI_Comm comm) {
  const Call call(Kind::collective, "Scatter", out == MPI_IN_PLACE ? 0 : bytes_of(n, type));
  return PMPI_Scatter(in, n_in, type_in, out, n, type, root, comm);
}
int MPI_Scatterv(const void* in, const int* n_in, const int* at, MPI_Datatype type_in, void* out, int n,
                 MPI_Datatype type, int root, MPI_Comm comm) {
  const Call call(Kind::collective, "Scatterv", out == MPI_IN_PLACE ? 0 : bytes_of(n, type));
  return PMPI_Scatterv(in, n_in, at, type_in, out, n, type, root, comm);
}
int MPI_Alltoall(const void* in, int n_in, MPI_Datatype type_in, void* out, int n, MPI_Datatype type, MPI_Comm comm) {
  const Call call(Kind::collective, "Alltoall", bytes_of(n, type) * size_of(comm));
  return PMPI_Alltoall(in, n_in, type_in, out, n, type, comm);
}
int MPI_Alltoallv(const void* in, const int* n_in, const int* at_in, MPI_Datatype type_in, void* out, const int* n,
                  const int* at, MPI_Datatype type, MPI_Comm comm) {
  const Call call(Kind::collective, "Alltoallv", in == MPI_IN_PLACE ? 0 : sum_of(n_in, size_of(comm), type_in));
  return PMPI_Alltoallv(in, n_in, at_in, type_in, out, n, at, type, comm);
}
int MPI_Comm_dup(MPI_Comm comm, MPI_Comm* copy) {
  const Call call(Kind::collective, "Comm_dup", 0);
  return PMPI_Comm_dup(comm, copy);
}
int MPI_Comm_split(MPI_Comm comm, int colour, int key, MPI_Comm* part) {
  const Call call(Kind::collective, "Comm_split", 0);
  return PMPI_Comm_split(comm, colour, key, part);
}

// ---- messages -----------------------------------------------------------------------------------------------------

int MPI_Send(const void* data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
  const Call call(Kind::message, "Send", bytes_of(n, type));
  return PMPI_Send(data, n, type, to, tag, comm);
}
int MPI_Ssend(const void* data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
  const Call call(Kind::message, "Ssend", bytes_of(n, type));
  return PMPI_Ssend(data, n, type, to, tag, comm);
}
int MPI_Rsend(const void* data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
  const Call call(Kind::message, "Rsend", bytes_of(n, type));
  return PMPI_Rsend(data, n, type, to, tag, comm);
}
int MPI_Isend(const void* data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request) {
  const Call call(Kind::message, "Isend", bytes_of(n, type));
  return PMPI_Isend(data, n, type, to, tag, comm, request);
}
int MPI_Issend(const void* data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request) {
  const Call call(Kind::message, "Issend", bytes_of(n, type));
  return PMPI_Issend(data, n, type, to, tag, comm, request);
}
int MPI_Irsend(const void* data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request) {
  const Call call(Kind::message, "Irsend", bytes_of(n, type));
  return PMPI_Irsend(data, n, type, to, tag, comm, request);
}
int MPI_Sendrecv(const void* in, int n_in, MPI_Datatype type_in, int to, int tag_in, void* out, int n,
                 MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Status* status) {
  const Call call(Kind::message, "Sendrecv", bytes_of(n_in, type_in));
  return PMPI_Sendrecv(in, n_in, type_in, to, tag_in, out, n, type, from, tag, comm, status);
}

// ---- waiting ------------------------------------------------------------------------------------------------------

int MPI_Recv(void* data, int n, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Status* status) {
  const Call call(Kind::wait, "Recv", 0);
  return PMPI_Recv(data, n, type, from, tag, comm, status);
}
int MPI_Mrecv(void* data, int n, MPI_Datatype type, MPI_Message* message, MPI_Status* status) {
  const Call call(Kind::wait, "Mrecv", 0);
  return PMPI_Mrecv(data, n, type, message, status);
}
int MPI_Probe(int from, int tag, MPI_Comm comm, MPI_Status* status) {
  const Call call(Kind::wait, "Probe", 0);
  return PMPI_Probe(from, tag, comm, status);
}
int MPI_Mprobe(int from, int tag, MPI_Comm comm, MPI_Message* message, MPI_Status* status) {
  const Call call(Kind::wait, "Mprobe", 0);
  return PMPI_Mprobe(from, tag, comm, message, status);
}
int MPI_Improbe(int from, int tag, MPI_Comm comm, int* flag, MPI_Message* message, MPI_Status* status) {
  const Call call(Kind::wait, "Improbe", 0);
  return PMPI_Improbe(from, tag, comm, flag, message, status);
}
int MPI_Wait(MPI_Request* request, MPI_Status* status) {
  const Call call(Kind::wait, "Wait", 0);
  return PMPI_Wait(request, status);
}
int MPI_Waitall(int n, MPI_Request* requests, MPI_Status* statuses) {
  const Call call(Kind::wait, "Waitall", 0);
  return PMPI_Waitall(n, requests, statuses);
}
int MPI_Waitany(int n, MPI_Request* requests, int* which, MPI_Status* status) {
  const Call call(Kind::wait, "Waitany", 0);
  return PMPI_Waitany(n, requests, which, status);
}
int MPI_Waitsome(int n, MPI_Request* requests, int* n_done, int* which, MPI_Status* statuses) {
  const Call call(Kind::wait, "Waitsome", 0);
  return PMPI_Waitsome(n, requests, n_done, which, statuses);
}
int MPI_Test(MPI_Request* request, int* flag, MPI_Status* status) {
  const Call call(Kind::wait, "Test", 0);
  return PMPI_Test(request, flag, status);
}
int MPI_Testall(int n, MPI_Request* requests, int* flag, MPI_Status* statuses) {
  const Call call(Kind::wait, "Testall", 0);
  return PMPI_Testall(n, requests, flag, statuses);
}
}
