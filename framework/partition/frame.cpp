// Reads positions and living elements of a frame, and rebuilds the model from them.
#include "partition/frame.hpp"

#include <fmt/format.h>

#include <vector>

#include "core/diagnostics.hpp"
#include "model/migrator.hpp"
#include "parallel/communicator.hpp"
#include "partition/hdf5_handle.hpp"

namespace kerf {

namespace {

using hdf5::Handle;

/// A file of results, open for reading. Throws InputError where something is not as Kerf writes it.
class ResultsFile {
 public:
  explicit ResultsFile(const std::string& folder) : path_(folder + "/results.vtkhdf"), file_(open(path_), H5Fclose) {
    if (!file_.good()) refuse("there are no results of a run that can be read; expected the folder of its results");
  }

  std::int64_t n_frames() const { return size_of("VTKHDF/Steps/Values"); }
  std::int64_t size_of(const std::string& name) const {
    const Handle data(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.good()) refuse(fmt::format("`{}` is missing", name));
    const Handle space(H5Dget_space(data), H5Sclose);
    hsize_t rows[2] = {0, 0};
    if (H5Sget_simple_extent_ndims(space) > 2 || H5Sget_simple_extent_dims(space, rows, nullptr) < 0)
      refuse(fmt::format("`{}` is no table", name));
    return static_cast<std::int64_t>(rows[0]);
  }

  /// Rows from `first` on.
  template <class T>
  std::vector<T> rows(const std::string& name, std::int64_t first, std::int64_t n, std::int64_t n_columns,
                      hid_t type) const {
    const Handle data(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.good()) refuse(fmt::format("`{}` is missing", name));
    const Handle space(H5Dget_space(data), H5Sclose);
    const hsize_t start[2] = {static_cast<hsize_t>(first), 0};
    const hsize_t count[2] = {static_cast<hsize_t>(n), static_cast<hsize_t>(n_columns)};
    const Handle memory(H5Screate_simple(2, count, nullptr), H5Sclose);
    std::vector<T> values(static_cast<std::size_t>(n * n_columns));
    if (first + n > size_of(name) || H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr) < 0 ||
        H5Dread(data, type, memory, space, H5P_DEFAULT, values.data()) < 0)
      refuse(fmt::format("`{}` cannot be read from row {} on", name, first));
    return values;
  }

  std::int64_t number(const std::string& name, std::int64_t row) const {
    return rows<std::int64_t>(name, row, 1, 1, H5T_NATIVE_INT64).front();
  }

  [[noreturn]] void refuse(const std::string& sentence) const {
    throw InputError({fmt::format("{}: error: {}", path_, sentence)});
  }

 private:
  static hid_t open(const std::string& path) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // messages are our own
    return H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  }

  std::string path_;
  Handle file_;
};

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
    file.refuse(fmt::format("the results are of a model of {} elements and {} nodes, and the input has {} and {}",
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
  if (n == 0) file.refuse("it holds no frame");
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
