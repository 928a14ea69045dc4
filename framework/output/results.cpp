// The VTKHDF layout behind ResultsWriter: which table holds what, and when it becomes visible to readers.
#include "output/results.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "output/collective.hpp"
#include "output/hdf5.hpp"

namespace kerf {

namespace {

using hdf5::Handle;

constexpr std::uint8_t vtk_hexahedron = 12;
constexpr std::uint8_t hidden_cell = 32;  // vtkDataSetAttributes::HIDDENCELL
constexpr std::int64_t steps_chunk = 1024;
const std::vector<std::string> static_cell_arrays{"GlobalElementId", "part"};

/// One number per frame that tells readers where the frame's rows begin; `factor` times the frame number.
struct StepTable {
  Handle table;
  std::int64_t factor = 0, constant = 0;
};

/// A quantity with the same number of rows in every frame.
struct Series {
  Handle data, offsets;
  int components = 1;
  bool written = false;
};

/// Which of the two kinds of entity a series belongs to.
struct Entities {
  std::int64_t n = 0;
  Handle arrays, offsets;  // the groups of the data and of their offsets
  std::map<std::string, Series> series;
  SlabExchangeCache plans;
};

void require(bool holds, const std::string& sentence) {
  if (!holds) throw std::logic_error(sentence);
}

std::vector<std::string> names_of(const Entities& kind) {
  std::vector<std::string> names;
  for (const auto& [name, series] : kind.series) names.push_back(name);
  return names;
}

/// Rows per chunk: a frame is one chunk, so each rank's slab is one contiguous block on disk. Frames beyond
/// 256 MiB are split (HDF5 limits chunks to 4 GiB), tiny ones share a chunk.
std::int64_t chunk_rows(std::int64_t rows_per_frame, std::int64_t row_bytes) {
  constexpr std::int64_t largest = std::int64_t{256} << 20, smallest = 16 << 10;
  const std::int64_t pieces = std::max<std::int64_t>(1, (rows_per_frame * row_bytes + largest - 1) / largest);
  return std::max((rows_per_frame + pieces - 1) / pieces, std::max<std::int64_t>(1, smallest / row_bytes));
}

/// Cuts the file back to `frames` frames. Done by one rank with HDF5's serial driver: shrinking a chunked table
/// rewrites the chunk at the new end, which several ranks must not do at once.
void truncate(const std::string& path, std::int64_t frames) {
  const Handle file = hdf5::open_file_alone(path);
  if (!hdf5::has_link(file, "VTKHDF")) throw std::runtime_error("\"" + path + "\" is not a VTKHDF file");
  const Handle root = hdf5::open_group(file, "VTKHDF"), steps = hdf5::open_group(root, "Steps");
  const std::int64_t there = hdf5::read_attribute(steps, "NSteps");
  if (frames < 0 || frames > there)
    throw std::runtime_error("cannot keep " + std::to_string(frames) + " frames of \"" + path + "\": it has " +
                             std::to_string(there));
  const auto count = [&](const char* name) {
    std::int64_t n = 0;
    hdf5::read_rows<std::int64_t>(hdf5::open_dataset(root, name), 0, {&n, 1});
    return n;
  };
  const std::int64_t n_nodes = count("NumberOfPoints"), n_elements = count("NumberOfCells");
  hdf5::write_attribute(steps, "NSteps", {&frames, 1}, true);
  for (const char* name :
       {"Values", "PartOffsets", "NumberOfParts", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"})
    hdf5::set_rows(hdf5::open_dataset(steps, name), frames);
  hdf5::set_rows(hdf5::open_dataset(root, "Points"), frames * n_nodes);
  for (const bool nodal : {true, false}) {
    const Handle arrays = hdf5::open_group(root, nodal ? "PointData" : "CellData");
    const Handle offsets = hdf5::open_group(steps, nodal ? "PointDataOffsets" : "CellDataOffsets");
    for (const std::string& name : hdf5::names_in(arrays)) {
      hdf5::set_rows(hdf5::open_dataset(offsets, name), frames);
      if (std::ranges::find(static_cell_arrays, name) == static_cell_arrays.end())
        hdf5::set_rows(hdf5::open_dataset(arrays, name), frames * (nodal ? n_nodes : n_elements));
    }
  }
}

}  // namespace

class ResultsWriter::Impl {
 public:
  Impl(MPI_Comm comm, const std::string& path, std::int64_t n_nodes, std::int64_t n_elements, bool double_precision);
  Impl(MPI_Comm comm, const std::string& path, int keep_frames);

  void write_topology(std::span<const std::int64_t> elements, std::span<const std::int64_t> nodes,
                      std::span<const std::int32_t> parts, const std::vector<std::string>& part_names);
  void begin_frame(double time, bool same_entities);
  void add_points(std::span<const std::int64_t> gids, const HeldValues<double>& positions);
  void add_field(Entities& kind, const std::string& name, int components, std::span<const std::int64_t> gids,
                 const HeldValues<double>& values);
  void add_alive(std::span<const std::int64_t> gids);
  void end_frame();

  Entities& nodes() { return nodes_; }
  Entities& elements() { return elements_; }
  std::int64_t n_frames() const { return n_frames_; }
  bool double_precision() const { return double_precision_; }
  double last_time() const { return n_frames_ > 0 ? time_ : -1.0; }

 private:
  void open_steps(bool create);
  void open_static_offsets(bool create);
  void add_step_table(const Handle& group, const std::string& name, bool create, std::int64_t factor,
                      std::int64_t constant);
  void read_last_points();
  std::int64_t begin_of(const Entities& kind) const { return SlabExchange::slab_begin(kind.n, rank_, n_ranks_); }
  std::int64_t size_of(const Entities& kind) const {
    return SlabExchange::slab_begin(kind.n, rank_ + 1, n_ranks_) - begin_of(kind);
  }
  Series& series_to_write(Entities& kind, const std::string& name, int components, hid_t type);
  template <class T>
  void append(const Entities& kind, const Handle& table, std::span<const T> slab);
  template <class T>
  void add_points_as(std::vector<T>& last, const SlabExchange& plan, const HeldValues<double>& positions);
  template <class T>
  void add_values(const Entities& kind, const Handle& table, std::vector<T>& slab, const SlabExchange& plan,
                  int components, const HeldValues<double>& values);
  hid_t real_type() const { return double_precision_ ? hdf5::type_of<double>() : hdf5::type_of<float>(); }

  MPI_Comm comm_;
  int rank_ = 0, n_ranks_ = 1;
  bool double_precision_ = false;
  // The file stands first: members close in reverse order, and it refuses to close before its contents.
  Handle file_, root_, steps_, points_, times_;
  Entities nodes_, elements_;
  std::int64_t n_frames_ = 0;
  std::vector<StepTable> step_tables_;
  // Positions of this rank's slab as last written; the one that fits the precision is used.
  std::vector<float> last_float_;
  std::vector<double> last_double_;
  // A field's slab on its way to the file; kept because touching fresh memory costs as much as writing it.
  std::vector<float> scratch_float_;
  std::vector<double> scratch_double_;
  bool in_frame_ = false, has_topology_ = false, has_points_ = false;
  double time_ = 0.0;  // of the frame that is being written or was last [s]
};

// ---------------------------------------------------------------------------------------------------------
// Opening

ResultsWriter::Impl::Impl(MPI_Comm comm, const std::string& path, std::int64_t n_nodes, std::int64_t n_elements,
                          bool double_precision)
    : comm_(comm), double_precision_(double_precision) {
  MPI_Comm_rank(comm, &rank_);
  MPI_Comm_size(comm, &n_ranks_);
  nodes_.n = n_nodes;
  elements_.n = n_elements;
  file_ = hdf5::create_file(comm, path);
  root_ = hdf5::create_group(file_, "VTKHDF");
  const std::int64_t version[2] = {2, 0};
  hdf5::write_attribute(root_, "Version", version, false);
  hdf5::write_attribute(root_, "Type", "UnstructuredGrid");
  nodes_.arrays = hdf5::create_group(root_, "PointData");
  elements_.arrays = hdf5::create_group(root_, "CellData");
  open_steps(true);
  const std::int64_t row_bytes = 3 * (double_precision ? 8 : 4);
  points_ = hdf5::create_growing_table(root_, "Points", real_type(), 3, chunk_rows(n_nodes, row_bytes));
  read_last_points();
}

ResultsWriter::Impl::Impl(MPI_Comm comm, const std::string& path, int keep_frames) : comm_(comm) {
  MPI_Comm_rank(comm, &rank_);
  MPI_Comm_size(comm, &n_ranks_);
  on_root(comm, [&] { truncate(path, keep_frames); });
  n_frames_ = keep_frames;
  file_ = hdf5::open_file(comm, path, true);
  root_ = hdf5::open_group(file_, "VTKHDF");
  hdf5::read_rows<std::int64_t>(hdf5::open_dataset(root_, "NumberOfPoints"), 0, {&nodes_.n, 1});
  hdf5::read_rows<std::int64_t>(hdf5::open_dataset(root_, "NumberOfCells"), 0, {&elements_.n, 1});
  points_ = hdf5::open_dataset(root_, "Points");
  double_precision_ = hdf5::is_table_of<double>(points_);
  nodes_.arrays = hdf5::open_group(root_, "PointData");
  elements_.arrays = hdf5::open_group(root_, "CellData");
  open_steps(false);
  open_static_offsets(false);
  for (Entities* kind : {&nodes_, &elements_}) {
    for (const std::string& name : hdf5::names_in(kind->arrays)) {
      if (std::ranges::find(static_cell_arrays, name) != static_cell_arrays.end()) continue;
      Series series{hdf5::open_dataset(kind->arrays, name), hdf5::open_dataset(kind->offsets, name)};
      series.components = hdf5::n_components(series.data);
      kind->series.emplace(name, std::move(series));
    }
  }
  has_topology_ = true;
  if (n_frames_ > 0) hdf5::read_rows<double>(times_, n_frames_ - 1, {&time_, 1});
  read_last_points();
}

void ResultsWriter::Impl::read_last_points() {
  const auto n = static_cast<std::size_t>(3 * size_of(nodes_));
  const std::int64_t row = (n_frames_ - 1) * nodes_.n + begin_of(nodes_);
  const auto read = [&](auto& last) {
    using T = typename std::remove_reference_t<decltype(last)>::value_type;
    last.assign(n, T(0));
    if (n_frames_ > 0) hdf5::read_rows<T>(points_, row, last);
  };
  if (double_precision_)
    read(last_double_);
  else
    read(last_float_);
}

void ResultsWriter::Impl::add_step_table(const Handle& group, const std::string& name, bool create, std::int64_t factor,
                                         std::int64_t constant) {
  Handle table = create ? hdf5::create_growing_table(group, name, hdf5::type_of<std::int64_t>(), 0, steps_chunk)
                        : hdf5::open_dataset(group, name);
  step_tables_.push_back({std::move(table), factor, constant});
}

void ResultsWriter::Impl::open_steps(bool create) {
  const auto group = [&](const Handle& parent, const char* name) {
    return create ? hdf5::create_group(parent, name) : hdf5::open_group(parent, name);
  };
  steps_ = group(root_, "Steps");
  nodes_.offsets = group(steps_, "PointDataOffsets");
  elements_.offsets = group(steps_, "CellDataOffsets");
  const std::int64_t none = 0;
  if (create) hdf5::write_attribute(steps_, "NSteps", {&none, 1}, true);
  times_ = create ? hdf5::create_growing_table(steps_, "Values", hdf5::type_of<double>(), 0, steps_chunk)
                  : hdf5::open_dataset(steps_, "Values");
  // Every frame is the same single partition with the same cells; only the points move on.
  add_step_table(steps_, "PartOffsets", create, 0, 0);
  add_step_table(steps_, "NumberOfParts", create, 0, 1);
  add_step_table(steps_, "PointOffsets", create, nodes_.n, 0);
  add_step_table(steps_, "CellOffsets", create, 0, 0);
  add_step_table(steps_, "ConnectivityIdOffsets", create, 0, 0);
}

void ResultsWriter::Impl::open_static_offsets(bool create) {
  for (const std::string& name : static_cell_arrays) add_step_table(elements_.offsets, name, create, 0, 0);
}

// ---------------------------------------------------------------------------------------------------------
// Topology

void ResultsWriter::Impl::write_topology(std::span<const std::int64_t> elements, std::span<const std::int64_t> nodes,
                                         std::span<const std::int32_t> parts,
                                         const std::vector<std::string>& part_names) {
  require(!has_topology_, "the topology is written once, and a reopened results file has it already");
  const SlabExchange& plan = elements_.plans.get(comm_, elements_.n, elements);
  int complete = plan.all_present();
  MPI_Allreduce(MPI_IN_PLACE, &complete, 1, MPI_INT, MPI_LAND, comm_);
  require(complete, "the topology has to name every element of the model");

  const std::int64_t begin = plan.begin();
  const auto store = [&]<class T>(const Handle& group, const char* name, std::int64_t rows, std::int64_t first,
                                  const std::vector<T>& values) {
    hdf5::write_rows<T>(hdf5::create_table(group, name, hdf5::type_of<T>(), rows, 0), first, values);
  };
  store(root_, "Connectivity", 8 * elements_.n, 8 * begin, plan.to_slab<std::int64_t>(nodes, 8, 0));
  // One entry more than there are elements; the last rank adds it.
  std::vector<std::int64_t> offsets(static_cast<std::size_t>(plan.slab_size()) + (rank_ == n_ranks_ - 1 ? 1 : 0));
  for (std::size_t i = 0; i < offsets.size(); ++i) offsets[i] = 8 * (begin + static_cast<std::int64_t>(i));
  store(root_, "Offsets", elements_.n + 1, begin, offsets);
  const auto n = static_cast<std::size_t>(plan.slab_size());
  store(root_, "Types", elements_.n, begin, std::vector<std::uint8_t>(n, vtk_hexahedron));
  std::vector<std::int64_t> gids(n);
  for (std::size_t i = 0; i < n; ++i) gids[i] = begin + static_cast<std::int64_t>(i);
  store(elements_.arrays, "GlobalElementId", elements_.n, begin, gids);
  store(elements_.arrays, "part", elements_.n, begin, plan.to_slab<std::int32_t>(parts, 1, 0));

  const auto store_count = [&](const char* name, std::int64_t value) {
    store(root_, name, 1, 0, rank_ == 0 ? std::vector<std::int64_t>{value} : std::vector<std::int64_t>{});
  };
  store_count("NumberOfPoints", nodes_.n);
  store_count("NumberOfCells", elements_.n);
  store_count("NumberOfConnectivityIds", 8 * elements_.n);
  open_static_offsets(true);
  // VTKHDF leaves everything outside its own group to the writer.
  hdf5::write_texts(hdf5::create_group(file_, "Kerf"), "part_names", part_names, rank_ == 0);
  has_topology_ = true;
}

// ---------------------------------------------------------------------------------------------------------
// Frames

void ResultsWriter::Impl::begin_frame(double time, bool same_entities) {
  require(has_topology_, "the topology has to be written before the first frame");
  require(!in_frame_, "a frame has to end before the next begins");
  in_frame_ = true;
  has_points_ = false;
  time_ = time;
  for (Entities* kind : {&nodes_, &elements_}) {
    if (same_entities)
      kind->plans.expect_same();
    else
      kind->plans.forget();
    for (auto& [name, series] : kind->series) series.written = false;
  }
}

template <class T>
void ResultsWriter::Impl::append(const Entities& kind, const Handle& table, std::span<const T> slab) {
  hdf5::set_rows(table, (n_frames_ + 1) * kind.n);
  hdf5::write_rows<T>(table, n_frames_ * kind.n + begin_of(kind), slab);
}

template <class T>
void ResultsWriter::Impl::add_points_as(std::vector<T>& last, const SlabExchange& plan,
                                        const HeldValues<double>& positions) {
  plan.update_slab<T, double>(positions, 3, last);
  append<T>(nodes_, points_, last);
}

void ResultsWriter::Impl::add_points(std::span<const std::int64_t> gids, const HeldValues<double>& positions) {
  require(in_frame_ && !has_points_, "points are added once, between begin_frame and end_frame");
  const SlabExchange& plan = nodes_.plans.get(comm_, nodes_.n, gids);
  if (double_precision_)
    add_points_as(last_double_, plan, positions);
  else
    add_points_as(last_float_, plan, positions);
  has_points_ = true;
}

Series& ResultsWriter::Impl::series_to_write(Entities& kind, const std::string& name, int components, hid_t type) {
  require(in_frame_, "field \"" + name + "\" is added outside a frame");
  auto found = kind.series.find(name);
  if (found == kind.series.end()) {
    require(n_frames_ == 0, "field \"" + name + "\" is not in the earlier frames; the fields of a file are fixed");
    require(std::ranges::find(static_cell_arrays, name) == static_cell_arrays.end(),
            "the name \"" + name + "\" is taken");
    const std::int64_t row_bytes = components * static_cast<std::int64_t>(H5Tget_size(type));
    Series series{hdf5::create_growing_table(kind.arrays, name, type, components == 1 ? 0 : components,
                                             chunk_rows(kind.n, row_bytes)),
                  hdf5::create_growing_table(kind.offsets, name, hdf5::type_of<std::int64_t>(), 0, steps_chunk),
                  components};
    found = kind.series.emplace(name, std::move(series)).first;
  }
  Series& series = found->second;
  require(series.components == components, "field \"" + name + "\" had another number of components before");
  require(!series.written, "field \"" + name + "\" is added twice in one frame");
  series.written = true;
  return series;
}

template <class T>
void ResultsWriter::Impl::add_values(const Entities& kind, const Handle& table, std::vector<T>& slab,
                                     const SlabExchange& plan, int components, const HeldValues<double>& values) {
  const auto n = static_cast<std::size_t>(components);
  slab.resize(plan.present().size() * n);
  plan.update_slab<T, double>(values, components, slab);
  for (std::size_t i = 0; i < plan.present().size() && !plan.all_present(); ++i)
    if (!plan.present()[i]) std::fill_n(slab.data() + i * n, n, T(0));
  append<T>(kind, table, slab);
}

void ResultsWriter::Impl::add_field(Entities& kind, const std::string& name, int components,
                                    std::span<const std::int64_t> gids, const HeldValues<double>& values) {
  Series& series = series_to_write(kind, name, components, real_type());
  const SlabExchange& plan = kind.plans.get(comm_, kind.n, gids);
  if (double_precision_)
    add_values(kind, series.data, scratch_double_, plan, components, values);
  else
    add_values(kind, series.data, scratch_float_, plan, components, values);
}

void ResultsWriter::Impl::add_alive(std::span<const std::int64_t> gids) {
  const hid_t type = hdf5::type_of<std::uint8_t>();
  Series& alive = series_to_write(elements_, "alive", 1, type);
  Series& ghost = series_to_write(elements_, "vtkGhostType", 1, type);
  const std::span<const std::uint8_t> present = elements_.plans.get(comm_, elements_.n, gids).present();
  append<std::uint8_t>(elements_, alive.data, present);
  std::vector<std::uint8_t> hidden(present.size());
  std::ranges::transform(present, hidden.begin(),
                         [](std::uint8_t lives) { return lives ? std::uint8_t{0} : hidden_cell; });
  append<std::uint8_t>(elements_, ghost.data, hidden);
}

void ResultsWriter::Impl::end_frame() {
  require(in_frame_ && has_points_, "a frame needs begin_frame and its points before it can end");
  for (const Entities* kind : {&nodes_, &elements_})
    for (const auto& [name, series] : kind->series)
      require(series.written, "field \"" + name + "\" is missing in this frame; the fields of a file are fixed");

  // All tables grow by one entry; its value is the same for everybody, so rank 0 writes it.
  const auto add_entry = [this]<class T>(const Handle& table, T value) {
    hdf5::set_rows(table, n_frames_ + 1);
    if (rank_ == 0) hdf5::write_rows<T>(table, n_frames_, {&value, 1});
  };
  add_entry(times_, time_);
  for (const StepTable& step : step_tables_) add_entry(step.table, step.constant + n_frames_ * step.factor);
  for (const Entities* kind : {&nodes_, &elements_})
    for (const auto& [name, series] : kind->series) add_entry(series.offsets, n_frames_ * kind->n);

  // The frame goes to disk first and is counted afterwards: a crash between the two loses it, no more.
  hdf5::flush(file_);
  ++n_frames_;
  hdf5::write_attribute(steps_, "NSteps", {&n_frames_, 1}, true);
  hdf5::flush(file_);
  in_frame_ = false;
}

// ---------------------------------------------------------------------------------------------------------
// The public face

ResultsWriter::ResultsWriter(MPI_Comm comm, const std::string& path, std::int64_t n_nodes, std::int64_t n_elements,
                             bool double_precision)
    : impl_(std::make_unique<Impl>(comm, path, n_nodes, n_elements, double_precision)) {}
ResultsWriter::ResultsWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ResultsWriter::ResultsWriter(ResultsWriter&&) noexcept = default;
ResultsWriter& ResultsWriter::operator=(ResultsWriter&&) noexcept = default;
ResultsWriter::~ResultsWriter() = default;

ResultsWriter ResultsWriter::reopen(MPI_Comm comm, const std::string& path, int keep_frames) {
  return ResultsWriter(std::make_unique<Impl>(comm, path, keep_frames));
}
void ResultsWriter::write_topology(std::span<const std::int64_t> elements, std::span<const std::int64_t> nodes,
                                   std::span<const std::int32_t> parts, const std::vector<std::string>& part_names) {
  impl_->write_topology(elements, nodes, parts, part_names);
}
void ResultsWriter::begin_frame(double time, bool same_entities) { impl_->begin_frame(time, same_entities); }
void ResultsWriter::add_points(std::span<const std::int64_t> owned_nodes, const HeldValues<double>& positions) {
  impl_->add_points(owned_nodes, positions);
}
void ResultsWriter::add_node_field(const std::string& name, int components, std::span<const std::int64_t> owned_nodes,
                                   const HeldValues<double>& values) {
  impl_->add_field(impl_->nodes(), name, components, owned_nodes, values);
}
void ResultsWriter::add_element_field(const std::string& name, int components,
                                      std::span<const std::int64_t> live_elements, const HeldValues<double>& values) {
  impl_->add_field(impl_->elements(), name, components, live_elements, values);
}
void ResultsWriter::add_alive(std::span<const std::int64_t> live_elements) { impl_->add_alive(live_elements); }
void ResultsWriter::end_frame() { impl_->end_frame(); }
bool ResultsWriter::double_precision() const { return impl_->double_precision(); }
std::vector<std::string> ResultsWriter::node_fields() const { return names_of(impl_->nodes()); }
std::vector<std::string> ResultsWriter::element_fields() const { return names_of(impl_->elements()); }
int ResultsWriter::n_frames() const { return static_cast<int>(impl_->n_frames()); }
double ResultsWriter::last_time() const { return impl_->last_time(); }

}  // namespace kerf
