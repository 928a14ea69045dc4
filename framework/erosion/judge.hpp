// Judges the elements of one part by the erosion criteria of its material.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "kerf/element.hpp"
#include "model/model.hpp"

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
  // Rows of what a criterion reads, and of floats among them as doubles; for as many as the greediest criterion reads.
  std::vector<const double*> reads_;
  AlignedVector<double> wide_;
  int needed_ = 1;  // failing criteria that erode an element
  PartStore* store_ = nullptr;
  std::int64_t cycle_ = 0;
};

}  // namespace kerf
