// Reads when elements of a coarse run have died, and where they stood before it.
#include "partition/foresight.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "input/csv_table.hpp"
#include "input/curve_table.hpp"
#include "kerf/functions.hpp"
#include "parallel/communicator.hpp"
#include "partition/nearest_point.hpp"
#include "partition/results_file.hpp"

namespace kerf {

namespace {

constexpr const char* any_run = "expected a file of results that Kerf has written";

/// Elements of one part of the coarse run.
struct CoarsePart {
  std::vector<double> centres;  // three per element [m]
  std::vector<double> lives;  // share of the run
  PointBounds bounds;  // of its nodes
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

/// The number of elements that have eroded in the coarse run. Throws where the run has not come to its end, or has
/// ended before this one will.
std::int64_t deaths_of_whole_run(const std::string& folder, double wanted) {
  const std::string path = folder + "/summary.json";
  const auto refuse = [&](const std::string& sentence) { throw InputError({path + ": error: " + sentence}); };
  const nlohmann::json summary = nlohmann::json::parse(text_of(path), nullptr, false);
  const nlohmann::json::json_pointer exit("/exit"), end_time("/end_time"), deaths("/eroded/elements");
  if (!summary.is_object() || !summary.contains(exit) || !summary[exit].is_string() || !summary.contains(end_time) ||
      !summary[end_time].is_number() || !summary.contains(deaths) || !summary[deaths].is_number_integer())
    refuse("`exit`, `end_time` or `eroded.elements` is missing; expected the summary of a run");
  if (const std::string how = summary[exit]; how != "completed")
    refuse(fmt::format("the run has not come to its end: {}; expected one that has completed", how));
  if (const double end = summary[end_time]; !(end >= 0.999 * wanted))
    refuse(
        fmt::format("the run ends at {:.6g} s, and time.end is {:.6g} s; expected a run that is as long", end, wanted));
  return summary[deaths];
}

/// Share of the run of `end` seconds that each element has lived, by its number.
std::vector<double> lives_of(const std::string& folder, std::int64_t n_elements, double end) {
  const std::int64_t n_deaths = deaths_of_whole_run(folder, end);
  std::vector<double> lives(static_cast<std::size_t>(n_elements), 1.0);
  const std::string path = folder + "/erosion.csv", text = text_of(path);
  if (text.empty() || text.back() != '\n')
    throw InputError({path + ": error: the last line does not end; expected the whole file of a run"});
  Diagnostics diagnostics;
  CsvColumns deaths;
  // The heading alone, where nothing has died, is no table of numbers.
  if (text.find('\n') + 1 < text.size()) deaths = read_csv_columns(text, path, {"time [s]", "element"}, diagnostics);
  diagnostics.throw_if_errors();
  std::vector<std::string> errors;
  for (std::size_t k = 0; k < deaths.first.size(); ++k) {
    const double time = deaths.first[k], element = deaths.second[k];
    const std::string place = fmt::format("{}:{}:{}: error: ", path, deaths.line[k], deaths.column[k]);
    if (!(time >= 0.0)) errors.push_back(place + fmt::format("the time is {}; expected one from 0 on", time));
    if (!(element >= 0.0 && element < static_cast<double>(n_elements) && element == std::floor(element)))
      errors.push_back(place +
                       fmt::format("there is no element {}; expected a number from 0 to {}", element, n_elements - 1));
    else
      lives[static_cast<std::size_t>(element)] = std::min(1.0, time / end);  // later than the end: it lives on
  }
  if (!errors.empty()) throw InputError(errors);
  if (static_cast<std::int64_t>(deaths.first.size()) != n_deaths)
    throw InputError(
        {fmt::format("{}: error: {} elements have eroded, and by summary.json {} have; expected two files "
                     "of one run",
                     path, deaths.first.size(), n_deaths)});
  return lives;
}

/// The undeformed mesh of a run.
struct CoarseMesh {
  std::vector<double> points;  // three per node [m]
  std::vector<std::int64_t> first, corners;  // nodes of element e: corners[first[e]] up to first[e + 1]
  std::vector<std::int64_t> ids;  // by which erosion.csv names an element
  std::vector<std::int32_t> part_of;
  std::size_t n() const { return ids.size(); }
};

/// Elements are named by their numbers, each once.
void require_numbers(const ResultsFile& file, const std::vector<std::int64_t>& ids) {
  std::vector<bool> seen(ids.size(), false);
  for (const std::int64_t id : ids) {
    if (id < 0 || id >= static_cast<std::int64_t>(ids.size()) || seen[static_cast<std::size_t>(id)])
      file.refuse(fmt::format(
          "`VTKHDF/CellData/GlobalElementId` names element {} twice, or there is no element {}; expected each number "
          "from 0 to {} once",
          id, id, ids.size() - 1));
    seen[static_cast<std::size_t>(id)] = true;
  }
}

CoarseMesh read_mesh(const ResultsFile& file) {
  const std::int64_t n_nodes = file.number("VTKHDF/NumberOfPoints", 0), n = file.number("VTKHDF/NumberOfCells", 0);
  if (n_nodes < 1 || n < 1) file.refuse(fmt::format("there are {} elements; {}", n, any_run));
  if (file.rows<double>("VTKHDF/Steps/Values", 0, 1, 1, H5T_NATIVE_DOUBLE).front() != 0.0)
    file.refuse("the first frame is not of time 0; expected one of the undeformed model");
  CoarseMesh mesh;
  mesh.points = file.rows<double>("VTKHDF/Points", 0, n_nodes, 3, H5T_NATIVE_DOUBLE);
  if (!std::all_of(mesh.points.begin(), mesh.points.end(), [](double x) { return std::isfinite(x); }))
    file.refuse("`VTKHDF/Points` holds values that are no numbers; expected positions of nodes");
  mesh.first = file.rows<std::int64_t>("VTKHDF/Offsets", 0, n + 1, 1, H5T_NATIVE_INT64);
  for (std::size_t e = 0; e <= static_cast<std::size_t>(n); ++e)
    if (e == 0 ? mesh.first[e] != 0 : mesh.first[e] <= mesh.first[e - 1])
      file.refuse(fmt::format("`VTKHDF/Offsets` do not rise from 0; {}", any_run));
  mesh.corners = file.rows<std::int64_t>("VTKHDF/Connectivity", 0, mesh.first.back(), 1, H5T_NATIVE_INT64);
  for (const std::int64_t node : mesh.corners)
    if (node < 0 || node >= n_nodes)
      file.refuse(fmt::format("`VTKHDF/Connectivity` names node {}; expected 0 to {}", node, n_nodes - 1));
  mesh.ids = file.rows<std::int64_t>("VTKHDF/CellData/GlobalElementId", 0, n, 1, H5T_NATIVE_INT64);
  require_numbers(file, mesh.ids);
  mesh.part_of = file.rows<std::int32_t>("VTKHDF/CellData/part", 0, n, 1, H5T_NATIVE_INT32);
  return mesh;
}

CoarsePart part_of(const CoarseMesh& mesh, std::ptrdiff_t number, const std::vector<double>& lives) {
  CoarsePart part;
  for (std::size_t e = 0; e < mesh.n(); ++e) {
    if (mesh.part_of[e] != number) continue;
    Vec3 centre;
    for (std::int64_t k = mesh.first[e]; k < mesh.first[e + 1]; ++k) {
      const double* x = &mesh.points[3 * static_cast<std::size_t>(mesh.corners[static_cast<std::size_t>(k)])];
      part.bounds.take({x[0], x[1], x[2]});
      centre = centre + Vec3{x[0], x[1], x[2]};
    }
    centre = centre * (1.0 / static_cast<double>(mesh.first[e + 1] - mesh.first[e]));
    part.centres.insert(part.centres.end(), {centre.x, centre.y, centre.z});
    part.lives.push_back(lives[static_cast<std::size_t>(mesh.ids[e])]);
  }
  return part;
}

/// Reads the parts of the model, in its order. On one rank.
std::vector<CoarsePart> read_run(const Model& model, const std::string& folder) {
  const ResultsFile file(folder);
  const CoarseMesh mesh = read_mesh(file);
  const std::vector<std::string> names = file.texts("Kerf/part_names");
  const std::vector<double> lives = lives_of(folder, static_cast<std::int64_t>(mesh.n()), model.input->time.end);
  std::vector<CoarsePart> parts;
  for (const PartModel& part : model.parts) {
    const auto name = std::find(names.begin(), names.end(), part.input->name);
    if (name == names.end())
      file.refuse(fmt::format("the run has no part {}; expected a run of the same model", part.input->name));
    parts.push_back(part_of(mesh, name - names.begin(), lives));
    if (parts.back().lives.empty() || !(parts.back().bounds.longest_edge() > 0.0))
      file.refuse(fmt::format("part {} has no element there; expected a run of the same model", part.input->name));
  }
  return parts;
}

/// Rank 0's values, on all ranks. A message has less values than an int counts.
void share(MPI_Comm comm, std::vector<double>& values) {
  constexpr std::int64_t most = std::int64_t{1} << 27;
  auto n = static_cast<std::int64_t>(values.size());
  MPI_Bcast(&n, 1, MPI_INT64_T, 0, comm);
  values.resize(static_cast<std::size_t>(n));
  for (std::int64_t at = 0; at < n; at += most)
    MPI_Bcast(values.data() + at, static_cast<int>(std::min(most, n - at)), MPI_DOUBLE, 0, comm);
}

/// A sentence where a part stands elsewhere, or is larger or smaller, by more than two cells of the coarse run.
std::string misfit(const Model& model, std::size_t p, const CoarsePart& coarse) {
  PointBounds mine;
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
  const double cell = kerf::pow(volume / static_cast<double>(coarse.lives.size()), 1.0 / 3.0);
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
      if (failure.find(": error: ") == std::string::npos)
        failure = fmt::format("{}: error: the run cannot be read: {}; expected that of a run that has completed",
                              folder, failure);
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
