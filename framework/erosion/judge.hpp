// Judges the elements of one part by the erosion criteria of its material.
#pragma once

#include <cstdint>
#include <vector>

#include "kerf/element.hpp"
#include "model/model.hpp"

namespace kerf {

/// The criteria of one part's material, combined by its rule.
class PartJudge final : public ErosionJudge {
 public:
  /// `first_state` is where the state of the first criterion begins in the store's erosion state.
  PartJudge(const ErosionInput& erosion, const PartStore& store, int first_state);
  void begin(PartStore& store, std::int64_t cycle);
  unsigned judge(ErosionBatch& rows, int block) override;
  unsigned asked_inputs() const override { return asked_; }

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
    bool keeps_state = false, softens = false;
    bool keeps_element = false;  // an element that fails stays, without deviator and tension
    LawReads reads;
    LawAccess access;  // in this cycle
  };
  /// Verdicts of all criteria on one block.
  struct Verdicts {
    alignas(64) double value[8][lane_width], failed[lane_width];
    alignas(64) double strength[lane_width], tension[lane_width],
        compression[lane_width];  // products over the criteria
    unsigned masks[8] = {};
    bool looked[8] = {};
  };
  template <class Test, class Complain>
  void for_bad_lanes(int block, const Test& is_bad, const Complain& complain) const;
  void refuse_unknown(const ErosionCriterion& law, const Verdicts& v, std::size_t k, int block) const;
  void refuse_shares(const ErosionCriterion& law, const double* shares, const char* of, int block) const;
  void ask(std::size_t criterion, ErosionBatch& rows, int block, Verdicts& verdicts);
  unsigned combine(Verdicts& verdicts, int block) const;
  unsigned failed_together(const Verdicts& verdicts, int block) const;
  void hold_without_tension(unsigned failed, Verdicts& verdicts, int block) const;
  int first_failing(const Verdicts& verdicts, int lane) const;
  unsigned at_once(const Verdicts& verdicts, const double* volume_ratio) const;
  unsigned fade_out(unsigned dead, const ErosionBatch& rows, Verdicts& verdicts, int block);
  void soften(const Verdicts& verdicts, int block) const;
  void record(unsigned dead, const Verdicts& verdicts, int block);

  std::vector<Criterion> criteria_;
  unsigned asked_ = 0;
  bool softens_ = false;  // a criterion does, or elements fade out, or stay without tension
  int no_tension_ = -1;  // component of the erosion state that says so; negative: none
  int needed_ = 1;  // failing criteria that erode an element
  int fade_out_ = 0;  // cycles
  PartStore* store_ = nullptr;
  std::int64_t cycle_ = 0;
};

}  // namespace kerf
