// The VTKHDF layout behind ResultsWriter: which table holds what, and when it becomes visible to readers.
#include "output/results.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <stdexcept>
#include <utility>

#include "kerf/collapsed_cell.hpp"
#include "output/collective.hpp"
#include "output/hdf5_file.hpp"

namespace kerf {

namespace {

using hdf5::Dataset;
using hdf5::Group;

constexpr std::uint8_t hidden_cell = 32;  // vtkDataSetAttributes::HIDDENCELL
constexpr char element_id[] = "element_id", node_id[] = "node_id";

/// Whether a table of points or cells is the same in all frames.
bool is_static(const std::string& name) {
  return name == "GlobalElementId" || name == "part" || name == element_id || name == node_id;
}

/// A quantity with the same number of rows in every frame.
struct Series {
  Dataset* data = nullptr;
  Dataset* offsets = nullptr;
  int components = 1;
  bool written = false;
};

/// Which of the two kinds of entity a series belongs to.
struct Entities {
  std::int64_t n = 0;
  Group *arrays = nullptr, *offsets = nullptr;  // of the data and of their offsets
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
/// 256 MiB are split (HDF5 limits chunks to 4 GiB), and several tiny ones share a chunk.
std::uint64_t chunk_rows(std::int64_t rows_per_frame, std::uint64_t row_bytes) {
  constexpr std::uint64_t largest = std::uint64_t{256} << 20, smallest = 16 << 10;
  const auto rows = static_cast<std::uint64_t>(std::max<std::int64_t>(1, rows_per_frame));
  const std::uint64_t pieces = (rows * row_bytes + largest - 1) / largest;
  if (pieces > 1) return (rows + pieces - 1) / pieces;
  return rows * std::max<std::uint64_t>(1, smallest / (rows * row_bytes));
}

/// Rows from the beginning of one frame to that of the next: frames begin with a chunk or share one.
std::uint64_t rows_of_frame(const Dataset& table, std::int64_t n) {
  const auto rows = static_cast<std::uint64_t>(n);
  if (rows <= table.chunk_rows) return rows;
  return (rows + table.chunk_rows - 1) / table.chunk_rows * table.chunk_rows;
}

/// Number of chunks that hold the first `rows` rows.
std::uint64_t n_chunks(const Dataset& table, std::uint64_t rows) {
  return (rows + table.chunk_rows - 1) / table.chunk_rows;
}

Dataset growing_table(hdf5::Type type, int components, std::int64_t rows_per_frame) {
  Dataset table;
  table.type = type;
  table.size = {0};
  if (components > 1) table.size.push_back(static_cast<std::uint64_t>(components));
  table.chunk_rows = chunk_rows(rows_per_frame, table.row_bytes());
  return table;
}

/// A small table that is stored along with the headers.
template <class T>
Dataset small_table(const std::vector<T>& values) {
  Dataset table;
  table.type = hdf5::type_of<T>();
  table.size = {values.size()};
  const auto bytes = std::as_bytes(std::span(values));
  table.content.assign(bytes.begin(), bytes.end());
  return table;
}

template <class T>
void append_value(Dataset& table, T value) {
  const auto bytes = std::as_bytes(std::span(&value, 1));
  table.content.insert(table.content.end(), bytes.begin(), bytes.end());
  ++table.size[0];
}

template <class T>
T value_in(const Dataset& table, std::size_t row) {
  if (table.type != hdf5::type_of<T>() || (row + 1) * sizeof(T) > table.content.size())
    throw std::runtime_error("a table is too short");
  T value{};
  std::memcpy(&value, table.content.data() + row * sizeof(T), sizeof(T));
  return value;
}

Dataset text_table(const std::vector<std::string>& texts) {
  Dataset table;
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  table.type = {hdf5::Kind::text, static_cast<std::uint32_t>(length)};
  table.size = {texts.size()};
  for (const std::string& text : texts) {
    const auto bytes = std::as_bytes(std::span(text));
    table.content.insert(table.content.end(), bytes.begin(), bytes.end());
    table.content.resize(table.content.size() + length - text.size());
  }
  return table;
}

/// What is to be kept of a table of one entry per frame.
void cut_steps(Dataset& table, std::uint64_t frames) {
  table.size[0] = frames;
  table.content.resize(frames * table.type.size);
}

void cut_rows(Dataset& table, std::uint64_t rows) {
  constexpr std::uint64_t chunks_per_node = 64;
  table.size[0] = rows;
  table.places.resize(n_chunks(table, rows));
  table.full_nodes.resize(std::min<std::size_t>(table.full_nodes.size(), table.places.size() / chunks_per_node));
}

}  // namespace

class ResultsWriter::Impl {
 public:
  Impl(MPI_Comm comm, const std::string& path, std::int64_t n_nodes, std::int64_t n_elements, bool double_precision);
  Impl(MPI_Comm comm, const std::string& path, int keep_frames);

  void write_topology(std::span<const std::int64_t> elements, std::span<const ElementNodeIds> nodes,
                      std::span<const std::int32_t> part_of, const std::vector<PartTopology>& parts);
  void write_labels(Entities& kind, const char* name, const ResultsWriter::LabelOf& label);
  void begin_frame(double time, bool same_entities);
  void add_points(std::span<const std::int64_t> gids, const HeldValues<double>& positions);
  void add_field(Entities& kind, const std::string& name, int components, std::span<const std::int64_t> gids,
                 const HeldValues<double>& values);
  void add_alive(std::span<const std::int64_t> gids);
  void end_frame();
  void close() { file_.close(); }

  Group& own_group() { return file_.root.groups["Kerf"]; }
  Entities& nodes() { return nodes_; }
  Entities& elements() { return elements_; }
  std::int64_t n_frames() const { return n_frames_; }
  bool double_precision() const { return double_precision_; }
  double last_time() const { return n_frames_ > 0 ? time_ : -1.0; }

 private:
  void find_groups();
  void find_series(Entities& kind);
  void cut_back(int keep_frames);
  void read_last_points();
  template <class Use>
  void for_step_tables(Use&& use);
  std::int64_t begin_of(const Entities& kind) const { return SlabExchange::slab_begin(kind.n, rank_, n_ranks_); }
  std::int64_t size_of(const Entities& kind) const {
    return SlabExchange::slab_begin(kind.n, rank_ + 1, n_ranks_) - begin_of(kind);
  }
  Series& series_to_write(Entities& kind, const std::string& name, int components, hdf5::Type type);
  template <class T>
  void store(Group& group, const char* name, std::int64_t rows, std::int64_t first, const std::vector<T>& values);
  template <class Transfer>
  void for_blocks(const Dataset& table, std::uint64_t first_row, std::size_t n_bytes, Transfer&& transfer) const;
  template <class T>
  void append(const Entities& kind, Dataset& table, std::span<const T> slab);
  template <class T>
  void add_points_as(std::vector<T>& last, const SlabExchange& plan, const HeldValues<double>& positions);
  template <class T>
  void add_values(const Entities& kind, Dataset& table, std::vector<T>& slab, const SlabExchange& plan, int components,
                  const HeldValues<double>& values);
  hdf5::Type real_type() const { return double_precision_ ? hdf5::type_of<double>() : hdf5::type_of<float>(); }

  MPI_Comm comm_;
  int rank_ = 0, n_ranks_ = 1;
  bool double_precision_ = false;
  std::string path_;
  hdf5::Hdf5File file_;
  Group *root_ = nullptr, *steps_ = nullptr;
  Dataset* points_ = nullptr;
  Entities nodes_, elements_;
  std::int64_t n_frames_ = 0;
  // Positions of this rank's slab as last written; the one that fits the precision is used.
  std::vector<float> last_float_;
  std::vector<double> last_double_;
  // A field's slab on its way to the file; kept because touching fresh memory costs as much as writing it.
  std::vector<float> scratch_float_;
  std::vector<double> scratch_double_;
  bool in_frame_ = false, has_topology_ = false, has_points_ = false;
  bool has_name_ = false;  // no longer "<path>.part"
  double time_ = 0.0;
};

// ---------------------------------------------------------------------------------------------------------
// Opening

ResultsWriter::Impl::Impl(MPI_Comm comm, const std::string& path, std::int64_t n_nodes, std::int64_t n_elements,
                          bool double_precision)
    : comm_(comm), double_precision_(double_precision), path_(path) {
  MPI_Comm_rank(comm, &rank_);
  MPI_Comm_size(comm, &n_ranks_);
  nodes_.n = n_nodes;
  elements_.n = n_elements;
  file_ = hdf5::Hdf5File::create(comm, path + ".part");
  find_groups();
  root_->set("Version", std::vector<std::int64_t>{2, 0});
  root_->set("Type", std::string("UnstructuredGrid"));
  steps_->set("NSteps", 0);
  steps_->datasets["Values"] = small_table<double>({});
  // Every frame is the same single partition with the same cells; only the points move on.
  for (const char* name : {"PartOffsets", "NumberOfParts", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"})
    steps_->datasets[name] = small_table<std::int64_t>({});
  for (const char* name : {"GlobalElementId", "part"})
    elements_.offsets->datasets[name] = small_table<std::int64_t>({});
  root_->datasets["Points"] = growing_table(real_type(), 3, n_nodes);
  points_ = &root_->datasets.at("Points");
  read_last_points();
}

ResultsWriter::Impl::Impl(MPI_Comm comm, const std::string& path, int keep_frames) : comm_(comm), path_(path) {
  MPI_Comm_rank(comm, &rank_);
  MPI_Comm_size(comm, &n_ranks_);
  file_ = hdf5::Hdf5File::open(comm, path, true, false);
  has_name_ = true;
  std::string failure;  // the same on all ranks: they all look at the same description
  try {
    find_groups();
    nodes_.n = value_in<std::int64_t>(root_->datasets.at("NumberOfPoints"), 0);
    elements_.n = value_in<std::int64_t>(root_->datasets.at("NumberOfCells"), 0);
    points_ = &root_->datasets.at("Points");
    double_precision_ = points_->type == hdf5::type_of<double>();
    find_series(nodes_);
    find_series(elements_);
    const std::int64_t there = steps_->integer("NSteps");
    if (keep_frames < 0 || keep_frames > there)
      throw std::runtime_error("it has " + std::to_string(there) + " frames, and " + std::to_string(keep_frames) +
                               " were to be kept");
    cut_back(keep_frames);
  } catch (const std::exception& e) {
    failure = "cannot continue \"" + path + "\": " + e.what();
  }
  kerf::agree(comm, failure);
  has_topology_ = true;
  read_last_points();
}

void ResultsWriter::Impl::find_groups() {
  root_ = &file_.root.groups["VTKHDF"];
  steps_ = &root_->groups["Steps"];
  nodes_.arrays = &root_->groups["PointData"];
  elements_.arrays = &root_->groups["CellData"];
  nodes_.offsets = &steps_->groups["PointDataOffsets"];
  elements_.offsets = &steps_->groups["CellDataOffsets"];
}

void ResultsWriter::Impl::find_series(Entities& kind) {
  for (auto& [name, data] : kind.arrays->datasets) {
    if (is_static(name)) continue;
    Series series{&data, &kind.offsets->datasets.at(name), static_cast<int>(data.row_bytes() / data.type.size)};
    kind.series.emplace(name, series);
  }
}

/// Calls use(table, value of the next frame) for all tables of one entry per frame but the times.
template <class Use>
void ResultsWriter::Impl::for_step_tables(Use&& use) {
  const auto frame = static_cast<std::uint64_t>(n_frames_);
  const auto first_row = [&](const Dataset& table, std::int64_t n) {
    return static_cast<std::int64_t>(frame * rows_of_frame(table, n));
  };
  for (auto& [name, table] : steps_->datasets) {
    if (name == "Values") continue;
    use(table, name == "NumberOfParts" ? 1 : name == "PointOffsets" ? first_row(*points_, nodes_.n) : 0);
  }
  for (Entities* kind : {&nodes_, &elements_})
    for (auto& [name, offsets] : kind->offsets->datasets)
      if (is_static(name)) use(offsets, std::int64_t{0});
  for (Entities* kind : {&nodes_, &elements_})
    for (auto& [name, series] : kind->series) use(*series.offsets, first_row(*series.data, kind->n));
}

/// Leaves the first frames. The file is smaller only after the frames are gone for readers, too.
void ResultsWriter::Impl::cut_back(int keep_frames) {
  const auto frames = static_cast<std::uint64_t>(keep_frames);
  n_frames_ = keep_frames;
  if (keep_frames > 0) time_ = value_in<double>(steps_->datasets.at("Values"), frames - 1);
  if (steps_->integer("NSteps") == keep_frames) return;
  steps_->set("NSteps", n_frames_);
  cut_steps(steps_->datasets.at("Values"), frames);
  for_step_tables([&](Dataset& table, std::int64_t) { cut_steps(table, frames); });
  cut_rows(*points_, frames * rows_of_frame(*points_, nodes_.n));
  for (Entities* kind : {&nodes_, &elements_})
    for (auto& [name, series] : kind->series) cut_rows(*series.data, frames * rows_of_frame(*series.data, kind->n));
  file_.commit();
  file_.shorten();
}

void ResultsWriter::Impl::read_last_points() {
  const auto n = static_cast<std::size_t>(3 * size_of(nodes_));
  const auto read = [&](auto& last) {
    using T = typename std::remove_reference_t<decltype(last)>::value_type;
    last.assign(n, T(0));
    if (n_frames_ == 0) return;
    const std::uint64_t row = static_cast<std::uint64_t>(n_frames_ - 1) * rows_of_frame(*points_, nodes_.n) +
                              static_cast<std::uint64_t>(begin_of(nodes_));
    const auto bytes = std::as_writable_bytes(std::span(last));
    for_blocks(*points_, row, bytes.size(), [&](std::uint64_t place, std::size_t first, std::size_t count) {
      file_.read(place, bytes.subspan(first, count));
    });
  };
  if (double_precision_)
    read(last_double_);
  else
    read(last_float_);
  file_.agree();
}

// ---------------------------------------------------------------------------------------------------------
// Topology

namespace {

/// Connectivity of a slab of elements, and where each of them begins in the connectivity of all. Collapsed cells are
/// written as the wedges, pyramids and tetrahedra that they are.
struct Cells {
  std::vector<std::int64_t> nodes, offsets;
  std::vector<std::uint8_t> types;
  std::int64_t first = 0, n_all = 0;  // entries of the connectivity before this slab, and in the file

  /// Collective.
  Cells(MPI_Comm comm, const std::vector<ResultsWriter::PartTopology>& parts, const std::vector<std::int64_t>& padded,
        const std::vector<std::int32_t>& part_of) {
    for (std::size_t e = 0; e < part_of.size(); ++e) {
      ElementNodeIds corners{};
      std::copy_n(padded.begin() + static_cast<std::ptrdiff_t>(e * Shape::most_nodes), Shape::most_nodes,
                  corners.begin());
      const DistinctCell cell(*parts[static_cast<std::size_t>(part_of[e])].shape, corners);
      offsets.push_back(static_cast<std::int64_t>(nodes.size()));
      types.push_back(static_cast<std::uint8_t>(cell.shape->vtk_type));
      const ElementNodeIds distinct = cell.of(corners);
      nodes.insert(nodes.end(), distinct.begin(), distinct.begin() + cell.shape->n_nodes);
    }
    const auto n = static_cast<std::int64_t>(nodes.size());
    MPI_Allreduce(&n, &n_all, 1, MPI_INT64_T, MPI_SUM, comm);
    MPI_Scan(&n, &first, 1, MPI_INT64_T, MPI_SUM, comm);
    first -= n;
    for (std::int64_t& offset : offsets) offset += first;
  }
};

}  // namespace

/// A list that is written once, of which this rank has the values from row `first` on.
template <class T>
void ResultsWriter::Impl::store(Group& group, const char* name, std::int64_t rows, std::int64_t first,
                                const std::vector<T>& values) {
  Dataset table;
  table.type = hdf5::type_of<T>();
  table.size = {static_cast<std::uint64_t>(rows)};
  table.places = {file_.allocate(static_cast<std::uint64_t>(rows) * sizeof(T))};
  file_.write(table.places[0] + static_cast<std::uint64_t>(first) * sizeof(T), std::as_bytes(std::span(values)));
  group.datasets[name] = std::move(table);
}

void ResultsWriter::Impl::write_topology(std::span<const std::int64_t> elements, std::span<const ElementNodeIds> nodes,
                                         std::span<const std::int32_t> part_of,
                                         const std::vector<PartTopology>& parts) {
  require(!has_topology_, "the topology is written once, and a reopened results file has it already");
  const SlabExchange& plan = elements_.plans.get(comm_, elements_.n, elements);
  int complete = plan.all_present();
  MPI_Allreduce(MPI_IN_PLACE, &complete, 1, MPI_INT, MPI_LAND, comm_);
  require(complete, "the topology has to name every element of the model");

  const std::int64_t begin = plan.begin();
  const std::span<const std::int64_t> flat(nodes.empty() ? nullptr : nodes.front().data(),
                                           nodes.size() * Shape::most_nodes);
  const std::vector<std::int32_t> parts_here = plan.to_slab<std::int32_t>(part_of, 1, 0);
  Cells cells(comm_, parts, plan.to_slab<std::int64_t>(flat, Shape::most_nodes, 0), parts_here);
  store(*root_, "Connectivity", cells.n_all, cells.first, cells.nodes);
  // One entry more than there are elements; the last rank adds it.
  if (rank_ == n_ranks_ - 1) cells.offsets.push_back(cells.n_all);
  store(*root_, "Offsets", elements_.n + 1, begin, cells.offsets);
  store(*root_, "Types", elements_.n, begin, cells.types);
  const auto n = static_cast<std::size_t>(plan.slab_size());
  std::vector<std::int64_t> gids(n);
  for (std::size_t i = 0; i < n; ++i) gids[i] = begin + static_cast<std::int64_t>(i);
  store(*elements_.arrays, "GlobalElementId", elements_.n, begin, gids);
  store(*elements_.arrays, "part", elements_.n, begin, parts_here);
  std::vector<std::string> part_names;
  for (const PartTopology& part : parts) part_names.push_back(part.name);
  root_->datasets["NumberOfPoints"] = small_table<std::int64_t>({nodes_.n});
  root_->datasets["NumberOfCells"] = small_table<std::int64_t>({elements_.n});
  root_->datasets["NumberOfConnectivityIds"] = small_table<std::int64_t>({cells.n_all});
  // VTKHDF leaves everything outside its own group to the writer.
  file_.root.groups["Kerf"].datasets["part_names"] = text_table(part_names);
  has_topology_ = true;
}

void ResultsWriter::Impl::write_labels(Entities& kind, const char* name, const ResultsWriter::LabelOf& label) {
  require(has_topology_ && n_frames_ == 0 && !in_frame_, "labels are written between topology and frames");
  std::vector<std::int64_t> labels(static_cast<std::size_t>(size_of(kind)));
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = label(begin_of(kind) + static_cast<std::int64_t>(i));
  store(*kind.arrays, name, kind.n, begin_of(kind), labels);
  kind.offsets->datasets[name] = small_table<std::int64_t>({});
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

/// Calls transfer(place in the file, first byte, number of bytes) for the part of the bytes in each chunk.
template <class Transfer>
void ResultsWriter::Impl::for_blocks(const Dataset& table, std::uint64_t first_row, std::size_t n_bytes,
                                     Transfer&& transfer) const {
  const std::uint64_t row_bytes = table.row_bytes(), chunk_bytes = table.chunk_rows * row_bytes;
  std::uint64_t at = first_row * row_bytes;
  for (std::size_t done = 0; done < n_bytes;) {
    const std::uint64_t within = at % chunk_bytes;
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(n_bytes - done, chunk_bytes - within));
    transfer(table.places.at(at / chunk_bytes) + within, done, count);
    done += count;
    at += count;
  }
}

/// Adds this rank's slab of the frame. The rows are out of sight until the next state of the file.
template <class T>
void ResultsWriter::Impl::append(const Entities& kind, Dataset& table, std::span<const T> slab) {
  const std::uint64_t rows = rows_of_frame(table, kind.n), first = static_cast<std::uint64_t>(n_frames_) * rows;
  table.size[0] = first + rows;
  while (table.places.size() < n_chunks(table, first + rows))
    table.places.push_back(file_.allocate(table.chunk_rows * table.row_bytes()));
  const auto bytes = std::as_bytes(slab);
  for_blocks(table, first + static_cast<std::uint64_t>(begin_of(kind)), bytes.size(),
             [&](std::uint64_t place, std::size_t begin, std::size_t count) {
               file_.write(place, bytes.subspan(begin, count));
             });
}

template <class T>
void ResultsWriter::Impl::add_points_as(std::vector<T>& last, const SlabExchange& plan,
                                        const HeldValues<double>& positions) {
  plan.update_slab<T, double>(positions, 3, last);
  append<T>(nodes_, *points_, last);
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

Series& ResultsWriter::Impl::series_to_write(Entities& kind, const std::string& name, int components, hdf5::Type type) {
  require(in_frame_, "field \"" + name + "\" is added outside a frame");
  auto found = kind.series.find(name);
  if (found == kind.series.end()) {
    require(n_frames_ == 0, "field \"" + name + "\" is not in the earlier frames; the fields of a file are fixed");
    require(!is_static(name), "the name \"" + name + "\" is taken");
    Dataset& data = kind.arrays->datasets[name] = growing_table(type, components, kind.n);
    Dataset& offsets = kind.offsets->datasets[name] = small_table<std::int64_t>({});
    found = kind.series.emplace(name, Series{&data, &offsets, components}).first;
  }
  Series& series = found->second;
  require(series.components == components, "field \"" + name + "\" had another number of components before");
  require(!series.written, "field \"" + name + "\" is added twice in one frame");
  series.written = true;
  return series;
}

template <class T>
void ResultsWriter::Impl::add_values(const Entities& kind, Dataset& table, std::vector<T>& slab,
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
    add_values(kind, *series.data, scratch_double_, plan, components, values);
  else
    add_values(kind, *series.data, scratch_float_, plan, components, values);
}

void ResultsWriter::Impl::add_alive(std::span<const std::int64_t> gids) {
  const hdf5::Type type = hdf5::type_of<std::uint8_t>();
  Series& alive = series_to_write(elements_, "alive", 1, type);
  Series& ghost = series_to_write(elements_, "vtkGhostType", 1, type);
  const std::span<const std::uint8_t> present = elements_.plans.get(comm_, elements_.n, gids).present();
  append<std::uint8_t>(elements_, *alive.data, present);
  std::vector<std::uint8_t> hidden(present.size());
  std::ranges::transform(present, hidden.begin(),
                         [](std::uint8_t lives) { return lives ? std::uint8_t{0} : hidden_cell; });
  append<std::uint8_t>(elements_, *ghost.data, hidden);
}

void ResultsWriter::Impl::end_frame() {
  require(in_frame_ && has_points_, "a frame needs begin_frame and its points before it can end");
  for (const Entities* kind : {&nodes_, &elements_})
    for (const auto& [name, series] : kind->series)
      require(series.written, "field \"" + name + "\" is missing in this frame; the fields of a file are fixed");
  append_value(steps_->datasets.at("Values"), time_);
  for_step_tables([](Dataset& table, std::int64_t value) { append_value(table, value); });
  ++n_frames_;
  steps_->set("NSteps", n_frames_);
  file_.commit();
  if (!has_name_) file_.publish(path_);
  has_name_ = true;
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
void ResultsWriter::write_topology(std::span<const std::int64_t> elements, std::span<const ElementNodeIds> nodes,
                                   std::span<const std::int32_t> part_of, const std::vector<PartTopology>& parts) {
  impl_->write_topology(elements, nodes, part_of, parts);
}
void ResultsWriter::write_labels(const LabelOf& of_element, const LabelOf& of_node) {
  impl_->write_labels(impl_->elements(), element_id, of_element);
  impl_->write_labels(impl_->nodes(), node_id, of_node);
}
void ResultsWriter::note_units(const std::vector<std::pair<std::string, std::string>>& units) {
  std::vector<std::string> names, texts;
  for (const auto& [name, unit] : units) {
    names.push_back(name);
    texts.push_back(unit);
  }
  impl_->own_group().datasets["field_names"] = text_table(names);
  impl_->own_group().datasets["field_units"] = text_table(texts);
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
void ResultsWriter::close() { impl_->close(); }
bool ResultsWriter::double_precision() const { return impl_->double_precision(); }
std::vector<std::string> ResultsWriter::node_fields() const { return names_of(impl_->nodes()); }
std::vector<std::string> ResultsWriter::element_fields() const { return names_of(impl_->elements()); }
int ResultsWriter::n_frames() const { return static_cast<int>(impl_->n_frames()); }
double ResultsWriter::last_time() const { return impl_->last_time(); }

}  // namespace kerf
