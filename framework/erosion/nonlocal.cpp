// Which elements of other ranks are near, and the averages of every step.
#include "erosion/nonlocal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/assert.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

using Box = std::array<double, 6>;  // lower corner, then the upper one

Box box_of(const std::vector<Neighbourhood::Point>& points) {
  constexpr double far = std::numeric_limits<double>::max();
  Box box = {far, far, far, -far, -far, -far};
  for (const Neighbourhood::Point& p : points)
    for (int d = 0; d < 3; ++d) {
      box[d] = std::min(box[d], p.position[d]);
      box[3 + d] = std::max(box[3 + d], p.position[d]);
    }
  return box;
}

/// Greatest coordinate [m].
double farthest_of(const std::vector<Neighbourhood::Point>& points) {
  double farthest = 0.0;
  for (const Neighbourhood::Point& p : points)
    for (int d = 0; d < 3; ++d) farthest = std::max(farthest, std::fabs(p.position[d]));
  return farthest;
}

bool is_near(const Box& box, Vec3 x, double distance) {
  for (int d = 0; d < 3; ++d)
    if (x[d] < box[d] - distance || x[d] > box[3 + d] + distance) return false;
  return true;
}

std::vector<Box> boxes_of_all(MPI_Comm comm, const Box& mine) {
  std::vector<Box> all(static_cast<std::size_t>(size_of(comm)));
  MPI_Allgather(mine.data(), 6, MPI_DOUBLE, all.data(), 6, MPI_DOUBLE, comm);
  return all;
}

}  // namespace

NonLocalDamage::NonLocalDamage(const Model& model) {
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const PartModel& part = model.parts[p];
    if (!part.material->erosion) continue;
    int first = part.first_criterion_state;
    for (const auto& criterion : part.material->erosion->criteria) {
      const NonLocalAverage law = criterion->nonlocal();
      if (law.radius > 0.0) {
        Task task;
        task.part = static_cast<int>(p);
        task.law = law;
        task.increment = first + law.increment;
        task.sum = first + law.sum;
        tasks_.push_back(std::move(task));
      }
      first += static_cast<int>(criterion->state_variables().size());
    }
  }
}

void NonLocalDamage::average(Model& model) {
  for (Task& task : tasks_) {
    if (!is_valid_) find_neighbours(model, task);
    average(model, task);
  }
  is_valid_ = true;
}

/// Every rank gets the elements of the others that are near the box round its own, by where they were before the first
/// step.
void NonLocalDamage::find_neighbours(const Model& model, Task& task) const {
  const PartStore& store = *model.parts[static_cast<std::size_t>(task.part)].store;
  const Field& place = store.field(PartStore::place);
  KERF_ASSERT(place.n_components > 0, "the place of elements is kept where a criterion asks for an average");
  std::vector<Neighbourhood::Point> points;
  task.own.clear();
  for (int s = 0; s < store.n_slots(); ++s) {
    if (!store.live(s)) continue;
    const double length = place.at(s, 3);
    points.push_back({store.id(s), {place.at(s, 0), place.at(s, 1), place.at(s, 2)}, length * length * length});
    task.own.push_back(s);
  }
  const std::vector<Box> boxes = boxes_of_all(model.comm, box_of(points));
  // A little more than the radius: whether a pair is near enough is decided by one computation only, that of
  // Neighbourhood, and here no point may be missed by round-off. One too many does no harm.
  const double reach = task.law.radius * (1.0 + 1e-6) + 1e-9 * greatest(model.comm, farthest_of(points));
  std::vector<std::vector<Neighbourhood::Point>> outgoing(boxes.size());
  task.sent.assign(boxes.size(), {});
  for (std::size_t r = 0; r < boxes.size(); ++r)
    for (std::size_t k = 0; k < points.size() && static_cast<int>(r) != model.rank(); ++k)
      if (is_near(boxes[r], points[k].position, reach)) {
        outgoing[r].push_back(points[k]);
        task.sent[r].push_back(task.own[k]);
      }
  for (const auto& from : all_to_all(model.comm, outgoing)) points.insert(points.end(), from.begin(), from.end());
  task.neighbours = Neighbourhood(points, task.own.size(), task.law);
}

void NonLocalDamage::average(Model& model, const Task& task) const {
  PartStore& store = *model.parts[static_cast<std::size_t>(task.part)].store;
  Field& states = store.field(PartStore::erosion_state);
  const auto increments = [&](const std::vector<std::int32_t>& slots) {
    std::vector<double> values;
    values.reserve(slots.size());
    for (const std::int32_t s : slots) values.push_back(states.at(s, task.increment));
    return values;
  };
  std::vector<std::vector<double>> outgoing;
  for (const auto& slots : task.sent) outgoing.push_back(increments(slots));
  std::vector<double> values = increments(task.own);
  for (const auto& from : all_to_all(model.comm, outgoing)) values.insert(values.end(), from.begin(), from.end());
  for (std::size_t i = 0; i < task.own.size(); ++i)
    states.set(task.own[i], task.sum, states.at(task.own[i], task.sum) + task.neighbours.average(i, values));
}

}  // namespace kerf
