// How the numbers of two ranks become one.
#include "dynamics/agreement.hpp"

#include <cstring>
#include <tuple>
#include <type_traits>

#include "core/waiting.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

static_assert(std::is_trivially_copyable_v<StepReduction> && std::is_trivially_copyable_v<ContactNote>);

/// Least step with the lower id among equals, or of the flags.
void join(StepReduction& a, const StepReduction& b) {
  if (b.least_step < a.least_step ||
      (b.least_step == a.least_step && b.least_id >= 0 && (a.least_id < 0 || b.least_id < a.least_id)))
    std::tie(a.least_step, a.least_id) = std::tie(b.least_step, b.least_id);
  a.flags |= b.flags;
  a.speeds.join(b.speeds);
  a.work.join(b.work);
}

template <class T>
void join_at(char* to, const char* from) {
  T a, b;
  std::memcpy(&a, to, sizeof a);
  std::memcpy(&b, from, sizeof b);
  if constexpr (std::is_same_v<T, StepReduction>)
    join(a, b);
  else
    a.join(b);
  std::memcpy(to, &a, sizeof a);
}

/// For MPI_Op_create: messages of a reduction and as many notes as fit into the type.
void join_messages(void* in, void* inout, int* n, MPI_Datatype* type) {
  int size = 0;
  MPI_Type_size(*type, &size);
  const auto* from = static_cast<const char*>(in);
  auto* to = static_cast<char*>(inout);
  for (int i = 0; i < *n; ++i, from += size, to += size) {
    join_at<StepReduction>(to, from);
    for (std::size_t at = sizeof(StepReduction); at < static_cast<std::size_t>(size); at += sizeof(ContactNote))
      join_at<ContactNote>(to + at, from + at);
  }
}

}  // namespace

StepAgreement::StepAgreement(MPI_Comm comm, std::size_t n_contacts)
    : comm_(comm), size_(sizeof(StepReduction) + n_contacts * sizeof(ContactNote)) {
  MPI_Type_contiguous(static_cast<int>(size_), MPI_BYTE, &type_);
  MPI_Type_commit(&type_);
  MPI_Op_create(&join_messages, 1, &operation_);
}

StepAgreement::~StepAgreement() {
  int finalised = 0;
  MPI_Finalized(&finalised);
  if (finalised != 0) return;
  MPI_Op_free(&operation_);
  MPI_Type_free(&type_);
}

void StepAgreement::reach(StepReduction& reduction, std::vector<ContactNote>& notes) const {
  if (size_of(comm_) == 1) return;
  const std::size_t n_bytes = notes.size() * sizeof(ContactNote);
  std::vector<char> message(size_);
  std::memcpy(message.data(), &reduction, sizeof reduction);
  std::memcpy(message.data() + sizeof reduction, notes.data(), n_bytes);
  {
    const Waiting waiting;
    MPI_Allreduce(MPI_IN_PLACE, message.data(), 1, type_, operation_, comm_);
  }
  std::memcpy(&reduction, message.data(), sizeof reduction);
  std::memcpy(static_cast<void*>(notes.data()), message.data() + sizeof reduction, n_bytes);
}

}  // namespace kerf
