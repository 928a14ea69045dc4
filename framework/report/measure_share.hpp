// What measures see of a model: the elements and nodes of this rank, and how ranks ask each other.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kerf/measure.hpp"
#include "model/model.hpp"
#include "report/meeting_point.hpp"

namespace kerf {

/// The elements and nodes of this rank. Collective.
MeasureModel measure_share(const Model& model);

class MeasuringRanks final : public MeasureRanks {
 public:
  explicit MeasuringRanks(const Model& model) : model_(model), meeting_(model.comm) {}
  const MeetingPoint& meeting() const { return meeting_; }

  bool is_root() const override { return model_.rank() == 0; }
  std::vector<double> sums(const std::vector<std::span<const double>>& lists) override;
  std::vector<double> greatest(std::vector<double> values) override;
  std::vector<double> least(std::vector<double> values) override;
  std::vector<std::int64_t> least_by_key(const std::vector<Key>& keys,
                                         const std::vector<std::int64_t>& values) override;
  std::vector<std::int64_t> sums_by_key(const std::vector<Key>& keys, const std::vector<std::int64_t>& values) override;
  std::vector<char> bytes_on_root(const std::vector<char>& bytes) override;
  std::vector<Vec3> undeformed_nodes(int part) override;
  const Shape& shape(int part) const override;
  void visit_undeformed(int part, const std::function<void(const UndeformedElement&)>& visit) override;

 private:
  const PartModel& part_of(int part) const;
  std::vector<std::int64_t> combine(const std::vector<Key>& keys, const std::vector<std::int64_t>& values,
                                    const std::function<void(std::int64_t&, std::int64_t)>& join) const;

  const Model& model_;
  MeetingPoint meeting_;
};

}  // namespace kerf
