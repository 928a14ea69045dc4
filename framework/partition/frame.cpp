// Reads positions and living elements of a frame, and rebuilds the model from them.
#include "partition/frame.hpp"

#include <fmt/format.h>

#include <vector>

#include "core/diagnostics.hpp"
#include "model/migrator.hpp"
#include "parallel/communicator.hpp"
#include "partition/results_file.hpp"

namespace kerf {

namespace {

/// What a frame shows, as far as a partition depends on it.
struct Frame {
  double time = 0.0;
  std::vector<double> positions;  // three per node, by id [m]
  std::vector<std::uint8_t> alive;  // by id
};

Frame read_frame(const Model& model, const std::string& folder, std::int64_t frame) {
  const ResultsFile file(folder);
  const std::int64_t n_nodes = file.number("VTKHDF/NumberOfPoints", 0);
  const std::int64_t n_elements = file.number("VTKHDF/NumberOfCells", 0);
  if (n_nodes != model.n_nodes || n_elements != model.n_elements)
    file.refuse(
        fmt::format("the results are of a model of {} elements and {} nodes, and the input has {} and {}; "
                    "expected results of this input",
                    n_elements, n_nodes, model.n_elements, model.n_nodes));
  Frame f;
  f.time = file.rows<double>("VTKHDF/Steps/Values", frame, 1, 1, H5T_NATIVE_DOUBLE).front();
  f.positions = file.rows<double>("VTKHDF/Points", file.number("VTKHDF/Steps/PointOffsets", frame), n_nodes, 3,
                                  H5T_NATIVE_DOUBLE);
  f.alive = file.rows<std::uint8_t>("VTKHDF/CellData/alive", file.number("VTKHDF/Steps/CellDataOffsets/alive", frame),
                                    n_elements, 1, H5T_NATIVE_UINT8);
  return f;
}

}  // namespace

std::int64_t frames_of(const std::string& folder) {
  const ResultsFile file(folder);
  const std::int64_t n = file.n_frames();
  if (n == 0) file.refuse("it holds no frame; expected at least one");
  return n;
}

FrameState take_frame(Model& model, const std::string& folder, std::int64_t frame) {
  Frame f;
  std::string failure;
  try {
    f = read_frame(model, folder, frame);
  } catch (const InputError& e) {
    failure = e.lines().front();
  }
  if (failure = first_text(model.comm, failure); !failure.empty()) throw InputError({failure});
  for (int i = 0; i < model.nodes.n(); ++i) {
    const double* x = &f.positions[3 * static_cast<std::size_t>(model.nodes.id[i])];
    model.nodes.set_x(i, {x[0], x[1], x[2]});
  }
  for (PartModel& part : model.parts)
    for (int s = 0; s < part.store->n_slots(); ++s)
      if (part.store->live(s) && f.alive[static_cast<std::size_t>(part.store->id(s))] == 0)
        part.store->retire(s, model.nodes.first_dummy());
  // Everything that follows from who lives and who has what is made anew.
  migrate(model, std::vector<int>(static_cast<std::size_t>(model.n_live_local()), model.rank()));
  return {frame, f.time};
}

}  // namespace kerf
