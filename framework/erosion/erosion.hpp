// Deletes elements whose criteria failed, and decides on the nodes that they leave.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "erosion/judge.hpp"
#include "erosion/nonlocal.hpp"
#include "erosion/record.hpp"
#include "kerf/element.hpp"
#include "model/ledger.hpp"
#include "model/model.hpp"

namespace kerf {

class Erosion {
 public:
  explicit Erosion(const Model& model);
  /// Null where the part does not erode.
  ErosionJudge* judge(Model& model, int part, std::int64_t cycle);
  std::uint8_t* flags(int part);
  bool any_failed() const;
  /// Elements of this rank that the next erode() will retire; the face means nothing.
  std::vector<ExteriorFacet> failing() const;
  /// Retires the failed elements of this rank, adds them to the accounts and returns their records. Local.
  std::vector<ErosionRecord> erode(Model& model, const Step& step, Ledger& ledger);
  /// Slots that the last erode() retired on this rank; the face means nothing.
  const std::vector<ExteriorFacet>& retired() const { return retired_; }
  /// After any rank eroded: marks nodes that no live element touches any more, and updates the surface. Collective.
  void update_free_nodes(Model& model);
  /// With `drop`: drops the free nodes. Call after the kick: the last forces on these nodes must do their work first,
  /// or their reactions would be left without a partner. Local.
  void drop_free_nodes(Model& model, Ledger& ledger);
  /// With `drop_beyond`: drops free nodes that have left the box round all live material by the given distance.
  /// Returns whether any rank dropped one. Collective.
  bool drop_distant_nodes(Model& model, Ledger& ledger);
  /// Spreads over their neighbourhood what criteria have added up in this step. Collective.
  void average(Model& model) { nonlocal_.average(model); }
  /// To be called on all ranks when elements have changed ranks.
  void rearranged() { nonlocal_.invalidate(); }
  /// Moves live elements together where enough slots are empty. Local.
  void compact(Model& model);

 private:
  static void drop(Model& model, int node, Ledger& ledger);

  std::vector<std::unique_ptr<PartJudge>> judges_;
  NonLocalDamage nonlocal_;
  bool may_have_free_nodes_ = true;  // that are to be dropped; a restart may have left some
  std::vector<ExteriorFacet> retired_;
};

}  // namespace kerf
