// Reads when elements of a coarse run have died, and where they stood before it.
#include "partition/foresight.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "input/csv_table.hpp"
#include "input/curve_table.hpp"
#include "parallel/communicator.hpp"
#include "partition/results_file.hpp"

namespace kerf {

namespace {

constexpr double unbounded = std::numeric_limits<double>::max();

struct Bounds {
  std::array<double, 3> low{unbounded, unbounded, unbounded}, high{-unbounded, -unbounded, -unbounded};
  void take(Vec3 x) {
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], x[d]);
      high[d] = std::max(high[d], x[d]);
    }
  }
};

/// Elements of one part of the coarse run.
struct CoarsePart {
  std::vector<double> centres;  // three per element [m]
  std::vector<double> lives;  // share of the run
  Bounds bounds;  // of its nodes
};

/// Finds the nearest of some points: a grid of boxes with about one point each, searched ring by ring.
class NearestPoint {
 public:
  NearestPoint(const std::vector<double>& points, const Bounds& bounds) : points_(points), low_(bounds.low) {
    const std::size_t n = points.size() / 3;
    double longest = 0.0;
    for (int d = 0; d < 3; ++d) longest = std::max(longest, bounds.high[d] - bounds.low[d]);
    double volume = 1.0;
    for (int d = 0; d < 3; ++d) volume *= std::max(bounds.high[d] - bounds.low[d], 1e-3 * longest);
    edge_ = std::cbrt(volume / static_cast<double>(n));
    for (int d = 0; d < 3; ++d) n_[d] = static_cast<int>((bounds.high[d] - bounds.low[d]) / edge_) + 1;
    boxes_.resize(static_cast<std::size_t>(n_[0]) * n_[1] * n_[2]);
    for (std::size_t i = 0; i < n; ++i) boxes_[box_of(cell_of(point(i)))].push_back(i);
  }

  /// Of equally near ones the first.
  std::size_t find(Vec3 x) const {
    const std::array<int, 3> home = cell_of(x);
    const int most = std::max({n_[0], n_[1], n_[2]});
    std::size_t best = 0;
    double least = unbounded;
    for (int ring = 0; ring <= most; ++ring) {
      // What is farther out than a ring is at least so far away, seen from inside of the grid.
      const double clear = (ring - 1) * edge_;
      if (least < unbounded && clear > 0.0 && clear * clear > least) break;
      look_in_ring(home, ring, x, best, least);
    }
    return best;
  }

 private:
  Vec3 point(std::size_t i) const { return {points_[3 * i], points_[3 * i + 1], points_[3 * i + 2]}; }
  std::array<int, 3> cell_of(Vec3 x) const {
    std::array<int, 3> cell{};
    for (int d = 0; d < 3; ++d)
      cell[d] = static_cast<int>(std::clamp((x[d] - low_[d]) / edge_, 0.0, static_cast<double>(n_[d] - 1)));
    return cell;
  }
  std::size_t box_of(const std::array<int, 3>& c) const {
    return (static_cast<std::size_t>(c[2]) * n_[1] + c[1]) * n_[0] + c[0];
  }
  void look_in_ring(const std::array<int, 3>& home, int ring, Vec3 x, std::size_t& best, double& least) const {
    std::array<int, 3> c{};
    for (c[2] = std::max(home[2] - ring, 0); c[2] <= std::min(home[2] + ring, n_[2] - 1); ++c[2])
      for (c[1] = std::max(home[1] - ring, 0); c[1] <= std::min(home[1] + ring, n_[1] - 1); ++c[1])
        for (c[0] = std::max(home[0] - ring, 0); c[0] <= std::min(home[0] + ring, n_[0] - 1); ++c[0]) {
          int distance = 0;
          for (int d = 0; d < 3; ++d) distance = std::max(distance, std::abs(c[d] - home[d]));
          if (distance != ring) continue;
          for (const std::size_t i : boxes_[box_of(c)]) {
            const Vec3 way = point(i) - x;
            const double square = dot(way, way);
            if (square < least || (square == least && i < best)) {
              least = square;
              best = i;
            }
          }
        }
  }

  const std::vector<double>& points_;
  std::array<double, 3> low_;
  std::array<int, 3> n_{};
  double edge_ = 1.0;
  std::vector<std::vector<std::size_t>> boxes_;
};

std::string text_of(const std::string& path) {
  std::string failure, text = read_text_file(path, failure);
  if (!failure.empty())
    throw InputError(
        {fmt::format("{}: error: the file cannot be read: {}; expected the folder of a run that has "
                     "completed",
                     path, failure)});
  return text;
}

/// Throws where the coarse run has ended before this one will.
void require_end(const std::string& folder, double wanted) {
  const std::string path = folder + "/summary.json";
  const nlohmann::json summary = nlohmann::json::parse(text_of(path), nullptr, false);
  if (!summary.is_object() || !summary.contains("end_time") || !summary["end_time"].is_number())
    throw InputError({path + ": error: there is no `end_time`; expected the summary of a run"});
  const double end = summary["end_time"];
  if (end < 0.999 * wanted)
    throw InputError(
        {fmt::format("{}: error: the run ends at {:.6g} s, and time.end is {:.6g} s; expected a run that "
                     "is as long",
                     path, end, wanted)});
}

/// Share of the run that each element has lived.
std::vector<double> lives_of(const std::string& folder, std::int64_t n_elements, double end) {
  std::vector<double> lives(static_cast<std::size_t>(n_elements), 1.0);
  const std::string path = folder + "/erosion.csv", text = text_of(path);
  if (text.find('\n') + 1 >= text.size()) return lives;  // the heading alone: nothing has died
  Diagnostics diagnostics;
  const CsvColumns csv = read_csv_columns(text, path, {"time [s]", "element"}, diagnostics);
  diagnostics.throw_if_errors();
  for (std::size_t k = 0; k < csv.first.size(); ++k) {
    if (!(csv.second[k] >= 0.0 && csv.second[k] < static_cast<double>(n_elements)))
      throw InputError({fmt::format("{}:{}:1: error: there is no element {}; expected a number from 0 to {}", path,
                                    csv.line[k], csv.second[k], n_elements - 1)});
    lives[static_cast<std::size_t>(csv.second[k])] = std::min(1.0, csv.first[k] / end);  // later than the end: lives on
  }
  return lives;
}

/// Reads the parts of the model, in its order. On one rank.
std::vector<CoarsePart> read_run(const Model& model, const std::string& folder) {
  const ResultsFile file(folder);
  const std::int64_t n_nodes = file.number("VTKHDF/NumberOfPoints", 0), n = file.number("VTKHDF/NumberOfCells", 0);
  if (file.rows<double>("VTKHDF/Steps/Values", 0, 1, 1, H5T_NATIVE_DOUBLE).front() != 0.0)
    file.refuse("the first frame is not of time 0; expected one of the undeformed model");
  const auto points = file.rows<double>("VTKHDF/Points", 0, n_nodes, 3, H5T_NATIVE_DOUBLE);
  const auto first = file.rows<std::int64_t>("VTKHDF/Offsets", 0, n + 1, 1, H5T_NATIVE_INT64);
  if (first.front() != 0 || !std::is_sorted(first.begin(), first.end()))
    file.refuse("`VTKHDF/Offsets` do not rise from 0; expected the results of a run");
  const auto corners = file.rows<std::int64_t>("VTKHDF/Connectivity", 0, first.back(), 1, H5T_NATIVE_INT64);
  for (const std::int64_t node : corners)
    if (node < 0 || node >= n_nodes)
      file.refuse(fmt::format("`VTKHDF/Connectivity` names node {}; expected 0 to {}", node, n_nodes - 1));
  const auto part_of = file.rows<std::int32_t>("VTKHDF/CellData/part", 0, n, 1, H5T_NATIVE_INT32);
  const std::vector<std::string> names = file.texts("Kerf/part_names");
  require_end(folder, model.input->time.end);
  const std::vector<double> lives = lives_of(folder, n, model.input->time.end);
  std::vector<CoarsePart> parts;
  for (const PartModel& part : model.parts) {
    const auto name = std::find(names.begin(), names.end(), part.input->name);
    if (name == names.end())
      file.refuse(fmt::format("the run has no part {}; expected a run of the same model", part.input->name));
    CoarsePart coarse;
    for (std::size_t e = 0; e < static_cast<std::size_t>(n); ++e) {
      if (part_of[e] != name - names.begin()) continue;
      Vec3 centre;
      for (std::int64_t k = first[e]; k < first[e + 1]; ++k) {
        const double* x = &points[3 * static_cast<std::size_t>(corners[static_cast<std::size_t>(k)])];
        coarse.bounds.take({x[0], x[1], x[2]});
        centre = centre + Vec3{x[0], x[1], x[2]};
      }
      centre = centre * (1.0 / static_cast<double>(first[e + 1] - first[e]));
      coarse.centres.insert(coarse.centres.end(), {centre.x, centre.y, centre.z});
      coarse.lives.push_back(lives[e]);
    }
    if (coarse.lives.empty()) file.refuse(fmt::format("part {} has no element there", part.input->name));
    parts.push_back(std::move(coarse));
  }
  return parts;
}

void share(MPI_Comm comm, std::vector<double>& values) {
  auto n = static_cast<std::int64_t>(values.size());
  MPI_Bcast(&n, 1, MPI_INT64_T, 0, comm);
  values.resize(static_cast<std::size_t>(n));
  MPI_Bcast(values.data(), static_cast<int>(n), MPI_DOUBLE, 0, comm);
}

/// A sentence where a part stands elsewhere, or is larger or smaller, by more than two cells of the coarse run.
std::string misfit(const Model& model, std::size_t p, const CoarsePart& coarse) {
  Bounds mine;
  const PartStore& store = *model.parts[p].store;
  for (int s = 0; s < store.n_slots(); ++s)
    if (store.live(s))
      for (int k = 0; k < store.n_nodes(); ++k) mine.take(model.nodes.x(store.node(s, k)));
  MPI_Allreduce(MPI_IN_PLACE, mine.low.data(), 3, MPI_DOUBLE, MPI_MIN, model.comm);
  MPI_Allreduce(MPI_IN_PLACE, mine.high.data(), 3, MPI_DOUBLE, MPI_MAX, model.comm);
  double volume = 1.0, off = 0.0;
  for (int d = 0; d < 3; ++d) {
    volume *= coarse.bounds.high[d] - coarse.bounds.low[d];
    off =
        std::max({off, std::fabs(mine.low[d] - coarse.bounds.low[d]), std::fabs(mine.high[d] - coarse.bounds.high[d])});
  }
  const double cell = std::cbrt(volume / static_cast<double>(coarse.lives.size()));
  if (off <= 2.0 * cell) return {};
  return fmt::format(
      "part {} of the run stands elsewhere or has another size, by {:.3g} m; expected a run of the same "
      "model, with other cells at most",
      model.parts[p].input->name, off);
}

}  // namespace

std::vector<double> expected_lives(const Model& model, const std::string& folder, const std::string& origin) {
  std::vector<CoarsePart> parts(model.parts.size());
  std::string failure;
  if (model.rank() == 0) try {
      parts = read_run(model, folder);
    } catch (const std::exception& e) {  // of any kind: the other ranks wait to be told
      failure = e.what();
      if (failure.empty()) failure = folder + ": error: the run cannot be read";
    }
  if (failure = broadcast(model.comm, failure); !failure.empty())
    throw InputError({failure, fmt::format("{}: error: `foresee` names a folder that does not serve; expected that of "
                                           "an earlier run of this model",
                                           origin)});
  std::vector<double> lives;
  std::vector<std::string> misfits;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    CoarsePart& coarse = parts[p];
    share(model.comm, coarse.centres);
    share(model.comm, coarse.lives);
    MPI_Bcast(coarse.bounds.low.data(), 3, MPI_DOUBLE, 0, model.comm);
    MPI_Bcast(coarse.bounds.high.data(), 3, MPI_DOUBLE, 0, model.comm);
    if (const std::string text = misfit(model, p, coarse); !text.empty())
      misfits.push_back(fmt::format("{}: error: {}", origin, text));
    const NearestPoint nearest(coarse.centres, coarse.bounds);
    const PartStore& store = *model.parts[p].store;
    for (int s = 0; s < store.n_slots(); ++s) {
      if (!store.live(s)) continue;
      Vec3 centre;
      for (int k = 0; k < store.n_nodes(); ++k) centre = centre + model.nodes.x(store.node(s, k));
      lives.push_back(coarse.lives[nearest.find(centre * (1.0 / store.n_nodes()))]);
    }
  }
  if (!misfits.empty()) throw InputError(misfits);
  return lives;
}

}  // namespace kerf
