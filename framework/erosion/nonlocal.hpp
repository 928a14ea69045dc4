// Spreads over their neighbourhood what criteria add up: see NonLocalAverage.
#pragma once

#include <cstdint>
#include <vector>

#include "erosion/neighbourhood.hpp"
#include "model/model.hpp"

namespace kerf {

class NonLocalDamage {
 public:
  /// Finds the criteria that ask for an average.
  explicit NonLocalDamage(const Model& model);
  /// To be called on all ranks when elements came, went or changed places on any of them.
  void invalidate() { is_valid_ = false; }
  /// Adds the averages of the increments of this step. Collective, where any criterion asks for it.
  void average(Model& model);

 private:
  /// One criterion of one part.
  struct Task {
    int part = 0;
    NonLocalAverage law;
    int increment = 0, sum = 0;  // components of the part's erosion state
    std::vector<std::int32_t> own;  // slots of this rank's elements
    std::vector<std::vector<std::int32_t>> sent;  // per rank: slots whose increments it needs
    Neighbourhood neighbours;
  };
  void find_neighbours(const Model& model, Task& task) const;
  void average(Model& model, const Task& task) const;

  std::vector<Task> tasks_;
  bool is_valid_ = false;
};

}  // namespace kerf
