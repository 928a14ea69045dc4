// The one operation of all ranks in a step: the next step's length, flags, and what contact is going to do.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "contact/engine.hpp"
#include "dynamics/balance.hpp"

namespace kerf {

/// What all ranks know after a step.
struct StepReduction {
  double least_step = 0.0;  // [s]
  std::int64_t least_id = -1;  // element that sets it; -1 where it is contact
  std::int64_t flags = 0;  // or of all ranks
  ContactSpeeds speeds;  // of contact in the step before
  RankWork work;  // before this step's erosion
};

/// What ranks tell each other about a contact definition.
struct ContactNote {
  ContactNeed need;  // before the forces to come; of the first definition only
  ImpactEffort effort;  // of the forces of the step before

  void join(const ContactNote& other) {
    need.what = need.what < other.need.what ? other.need.what : need.what;
    need.has_news |= other.need.has_news;
    effort.join(other.effort);
  }
};

/// Joins the reductions and, definition by definition, the notes of all ranks.
class StepAgreement {
 public:
  explicit StepAgreement(MPI_Comm comm, std::size_t n_contacts);
  ~StepAgreement();
  StepAgreement(const StepAgreement&) = delete;
  StepAgreement& operator=(const StepAgreement&) = delete;

  /// Both become those of all ranks. Collective; one reduction.
  void reach(StepReduction& reduction, std::vector<ContactNote>& notes) const;

 private:
  MPI_Comm comm_;
  std::size_t size_;  // of a message [bytes]
  MPI_Datatype type_ = MPI_DATATYPE_NULL;
  MPI_Op operation_ = MPI_OP_NULL;
};

}  // namespace kerf
