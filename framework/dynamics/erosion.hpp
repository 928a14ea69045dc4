// Judges elements by the erosion criteria of their material, and deletes those that failed.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "dynamics/ledger.hpp"
#include "kerf/element.hpp"
#include "output/history.hpp"
#include "state/model.hpp"

namespace kerf {

/// The criteria of one part's material, combined by its rule.
class PartJudge final : public ErosionJudge {
 public:
  /// Pre: the part's material has an erosion block.
  explicit PartJudge(const PartModel& part);
  void begin(PartStore& store, std::int64_t cycle);
  unsigned judge(ErosionBatch& rows, int block) override;

  struct Failure {
    int slot = 0, criterion = 0;
    double value = 0.0;
  };
  std::vector<Failure> failures;
  std::vector<std::uint8_t> flags;

 private:
  struct Criterion {
    const ErosionCriterion* law = nullptr;
    int first_state = 0;
    bool keeps_state = false;
    std::vector<std::pair<PartStore::FieldIndex, int>> reads;
  };
  unsigned combine(PartStore& store, const unsigned* masks, const bool* looked, int block) const;

  std::vector<Criterion> criteria_;
  int needed_ = 1;  // failing criteria that erode an element
  PartStore* store_ = nullptr;
  std::int64_t cycle_ = 0;
};

class Erosion {
 public:
  explicit Erosion(const Model& model);
  /// Null where the part does not erode.
  ErosionJudge* judge(Model& model, int part, std::int64_t cycle);
  std::uint8_t* flags(int part);
  bool any_failed() const;
  /// Retires the failed elements of this rank, adds them to the accounts and returns their records. Local.
  std::vector<ErosionRecord> erode(Model& model, const Step& step, Ledger& ledger);
  /// Slots that the last erode() retired on this rank; the face means nothing.
  const std::vector<ExteriorFacet>& retired() const { return retired_; }
  /// After any rank eroded: marks nodes that no live element touches any more, and updates the surface. Collective.
  void update_free_nodes(Model& model);
  /// With `drop`: drops the free nodes. To be called after the kick, when the forces that they still got in the step
  /// of their release have done their work, as the reactions to them have. Local.
  void drop_free_nodes(Model& model, Ledger& ledger);
  /// With `drop_beyond`: drops free nodes that have left the box round all live material by the given distance.
  /// Returns whether any rank dropped one. Collective.
  bool drop_distant_nodes(Model& model, Ledger& ledger);
  /// Moves live elements together where enough slots are empty. Local.
  void compact(Model& model);

 private:
  static void drop(Model& model, int node, Ledger& ledger);

  std::vector<std::unique_ptr<PartJudge>> judges_;
  bool may_have_free_nodes_ = true;  // that are to be dropped; a restart may have left some
  std::vector<ExteriorFacet> retired_;
};

}  // namespace kerf
