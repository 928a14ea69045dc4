// Exchange of nodal sums between ranks.
#include "model/copies.hpp"

#include <algorithm>

namespace kerf {

void sum_over_copies(const Model& model, std::int64_t* values, int stride) {
  if (!model.ghost_plan) return;
  const int n = std::min(stride, 3);
  std::vector<std::int64_t> copies(model.ghosts.size() * static_cast<std::size_t>(n));
  for (std::size_t g = 0; g < model.ghosts.size(); ++g)
    for (int c = 0; c < n; ++c) copies[g * n + c] = values[static_cast<std::size_t>(model.ghosts[g]) * stride + c];
  model.ghost_plan->push_add(copies.data(), n, values, stride, n);
  copy_to_ghosts(model, values, stride);
}

void copy_to_ghosts(const Model& model, std::int64_t* values, int stride) {
  if (!model.ghost_plan) return;
  const int n = std::min(stride, 3);
  std::vector<std::int64_t> copies(model.ghosts.size() * static_cast<std::size_t>(n));
  model.ghost_plan->pull(values, stride, copies.data(), n, n);
  for (std::size_t g = 0; g < model.ghosts.size(); ++g)
    for (int c = 0; c < n; ++c) values[static_cast<std::size_t>(model.ghosts[g]) * stride + c] = copies[g * n + c];
}

}  // namespace kerf
