// The layout behind restart files: /entities/<group>/{gids, columns/...} and /attributes/<name>, in HDF5.
#include "output/restart.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "output/checksum.hpp"
#include "output/collective.hpp"
#include "output/hdf5_file.hpp"
#include "output/slab.hpp"

namespace kerf {

namespace {

using hdf5::Dataset;
using hdf5::Group;
using hdf5::Piece;

const char* const format_key = "kerf_restart_format";

/// Names are places in the file, where a slash would mean a group.
const std::string& checked_name(const std::string& name) {
  if (name.empty() || name == "." || name.find('/') != std::string::npos)
    throw std::invalid_argument("\"" + name + "\" cannot name something in a restart file");
  return name;
}

template <class T>
void broadcast(MPI_Comm comm, std::vector<T>& values) {
  unsigned long long n = values.size();
  MPI_Bcast(&n, 1, MPI_UNSIGNED_LONG_LONG, 0, comm);
  values.resize(n);
  MPI_Bcast(values.data(), static_cast<int>(n * sizeof(T)), MPI_BYTE, 0, comm);
}

/// The pieces of all ranks, on all ranks.
void share(MPI_Comm comm, std::vector<Piece>& pieces) {
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  const int n = static_cast<int>(pieces.size() * sizeof(Piece));
  std::vector<int> counts(static_cast<std::size_t>(n_ranks)), starts(counts.size(), 0);
  MPI_Allgather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  for (std::size_t r = 1; r < counts.size(); ++r) starts[r] = starts[r - 1] + counts[r - 1];
  std::vector<Piece> all(static_cast<std::size_t>(starts.back() + counts.back()) / sizeof(Piece));
  MPI_Allgatherv(pieces.data(), n, MPI_BYTE, all.data(), counts.data(), starts.data(), MPI_BYTE, comm);
  pieces = std::move(all);
}

/// Moves the rows of `slab` that somebody holds to its front and drops the others.
template <class T>
void compact(std::vector<T>& slab, std::span<const std::uint8_t> present, int components) {
  const auto n = static_cast<std::size_t>(components);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < present.size(); ++i) {
    if (!present[i]) continue;
    if (kept != i) std::copy_n(slab.data() + i * n, n, slab.data() + kept * n);
    ++kept;
  }
  slab.resize(kept * n);
}

}  // namespace

std::string previous_restart(const std::string& path) {
  const std::filesystem::path newest(path);
  return (newest.parent_path() / (newest.stem().string() + "_previous" + newest.extension().string())).string();
}

// ---------------------------------------------------------------------------------------------------------
// Writing

class RestartWriter::Impl {
 public:
  Impl(MPI_Comm comm, const std::string& path) : comm_(comm), path_(path) {
    MPI_Comm_rank(comm, &rank_);
    file_ = hdf5::Hdf5File::create(comm, unfinished());
    file_.root.set(format_key, restart_format);
    file_.root.groups["attributes"];
    file_.root.groups["entities"];
  }

  void write_entities(const std::string& name, std::int64_t n_global, std::span<const std::int64_t> gids,
                      const std::vector<RestartColumn>& columns) {
    const SlabExchange plan(comm_, n_global, gids);
    std::vector<std::int64_t> stored;
    for (std::size_t i = 0; i < plan.present().size(); ++i)
      if (plan.present()[i]) stored.push_back(plan.begin() + static_cast<std::int64_t>(i));
    const auto count = static_cast<std::int64_t>(stored.size());
    std::int64_t begin = 0, total = 0;
    MPI_Exscan(&count, &begin, 1, MPI_INT64_T, MPI_SUM, comm_);
    if (rank_ == 0) begin = 0;  // MPI leaves it undefined there
    MPI_Allreduce(&count, &total, 1, MPI_INT64_T, MPI_SUM, comm_);

    Group& group = file_.root.groups["entities"].groups[checked_name(name)];
    group.set("n_global", n_global);
    write_table<std::int64_t>(group.datasets["gids"], total, 0, begin, stored);
    Group& tables = group.groups["columns"];
    for (const RestartColumn& column : columns) {
      std::visit(
          [&]<class T>(const T* data) {
            const auto n = gids.size() * static_cast<std::size_t>(column.components);
            auto slab = plan.to_slab<T>(std::span<const T>(data, n), column.components, T(0));
            compact(slab, plan.present(), column.components);
            write_table<T>(tables.datasets[checked_name(column.name)], total, column.components, begin, slab);
          },
          column.data);
    }
  }

  template <class T>
  void write_values(const std::string& name, std::vector<T> values) {
    broadcast(comm_, values);
    Dataset& table = attributes().datasets[checked_name(name)];
    table.type = hdf5::type_of<T>();
    table.size = {values.size()};
    const auto bytes = std::as_bytes(std::span(values));
    table.content.assign(bytes.begin(), bytes.end());
  }

  void write_text(const std::string& name, std::string text) {
    broadcast_text(comm_, text);
    Dataset& table = attributes().datasets[checked_name(name)];
    table.type = {hdf5::Kind::text, static_cast<std::uint32_t>(std::max<std::size_t>(1, text.size()))};
    const auto bytes = std::as_bytes(std::span(text));
    table.content.assign(bytes.begin(), bytes.end());
    table.content.resize(table.type.size);
  }

  /// An unfinished file is of no use to anybody and may be what fills the disk.
  ~Impl() {
    if (rank_ == 0 && !published_) std::remove(unfinished().c_str());
  }

  void finish() {
    if (finished_) throw std::logic_error("a restart file is finished once");
    finished_ = true;
    file_.commit();  // to disk before the name changes hands
    file_.close();
    on_root(comm_, [this] {
      rename_if_there(path_, previous_restart(path_));
      publish(unfinished(), path_);
    });
    published_ = true;
  }

 private:
  std::string unfinished() const { return path_ + ".part"; }
  Group& attributes() { return file_.root.groups["attributes"]; }

  /// Writes this rank's rows, in pieces that a reader can check one by one.
  template <class T>
  void write_table(Dataset& table, std::int64_t rows, int components, std::int64_t begin,
                   const std::vector<T>& values) {
    constexpr std::size_t largest_piece = std::size_t{16} << 20;
    table.type = hdf5::type_of<T>();
    table.size = {static_cast<std::uint64_t>(rows)};
    if (components > 0) table.size.push_back(static_cast<std::uint64_t>(components));
    table.places = {file_.allocate(static_cast<std::uint64_t>(rows) * table.row_bytes())};
    std::uint64_t place = table.places[0] + static_cast<std::uint64_t>(begin) * table.row_bytes();
    for (auto bytes = std::as_bytes(std::span(values)); !bytes.empty();) {
      const auto piece = bytes.first(std::min(bytes.size(), largest_piece));
      file_.write(place, piece);
      table.pieces.push_back({place, piece.size(), crc64(piece)});
      place += piece.size();
      bytes = bytes.subspan(piece.size());
    }
    share(comm_, table.pieces);
  }

  MPI_Comm comm_;
  int rank_ = 0;
  std::string path_;
  hdf5::Hdf5File file_;
  bool finished_ = false, published_ = false;
};

RestartWriter::RestartWriter(MPI_Comm comm, const std::string& path) : impl_(std::make_unique<Impl>(comm, path)) {}
RestartWriter::RestartWriter(RestartWriter&&) noexcept = default;
RestartWriter& RestartWriter::operator=(RestartWriter&&) noexcept = default;
RestartWriter::~RestartWriter() = default;
void RestartWriter::write_entities(const std::string& group, std::int64_t n_global, std::span<const std::int64_t> gids,
                                   const std::vector<RestartColumn>& columns) {
  impl_->write_entities(group, n_global, gids, columns);
}
void RestartWriter::write_attribute(const std::string& name, const std::string& value) {
  impl_->write_text(name, value);
}
void RestartWriter::write_attribute(const std::string& name, const std::vector<double>& values) {
  impl_->write_values(name, values);
}
void RestartWriter::write_attribute(const std::string& name, const std::vector<std::int64_t>& values) {
  impl_->write_values(name, values);
}
void RestartWriter::finish() { impl_->finish(); }

// ---------------------------------------------------------------------------------------------------------
// Reading

namespace {

template <class T>
const std::vector<T>& column_of(const std::map<std::string, RestartEntities::Column<T>>& columns,
                                const std::string& name, int components) {
  const auto found = columns.find(name);
  if (found == columns.end()) throw std::runtime_error("the restart file has no \"" + name + "\" where it is needed");
  if (found->second.components != components)
    throw std::runtime_error("\"" + name + "\" has " + std::to_string(found->second.components) +
                             " components in the restart file and " + std::to_string(components) + " in this model");
  return found->second.values;
}

}  // namespace

const std::vector<double>& RestartEntities::real(const std::string& name, int components) const {
  return column_of(reals, name, components);
}
const std::vector<std::int64_t>& RestartEntities::integer(const std::string& name, int components) const {
  return column_of(integers, name, components);
}

class RestartReader::Impl {
 public:
  Impl(MPI_Comm comm, const std::string& path) : path_(path) {
    MPI_Comm_rank(comm, &rank_);
    MPI_Comm_size(comm, &n_ranks_);
    on_root(comm, [&] {
      if (!std::filesystem::is_regular_file(path))
        throw std::runtime_error("there is no restart file \"" + path + "\"");
    });
    file_ = hdf5::Hdf5File::open(comm, path, false, true);
    std::string failure;  // the same on all ranks: they all look at the same description
    try {
      check_format();
    } catch (const std::exception& e) {
      failure = "\"" + path + "\" is not a restart file";
    }
    kerf::agree(comm, failure);
    const std::int64_t format = file_.root.integer(format_key);
    if (format != restart_format)
      throw OutputError("\"" + path + "\" has restart format " + std::to_string(format) +
                        ", and this program reads format " + std::to_string(restart_format) +
                        "; resume with the version of Kerf that wrote it");
  }

  const Group& attributes() const { return file_.root.groups.at("attributes"); }
  const Group& entities() const { return file_.root.groups.at("entities"); }

  RestartEntities read_entities(const std::string& name) {
    const auto found = entities().groups.find(name);
    if (found == entities().groups.end()) absent("entities", name);
    const Dataset& ids = found->second.datasets.at("gids");
    RestartEntities result;
    result.n_global = found->second.integer("n_global");
    result.n_total = static_cast<std::int64_t>(ids.size.at(0));
    result.gids = read_share<std::int64_t>(ids, result.n_total);
    for (const auto& [column, table] : found->second.groups.at("columns").datasets) {
      const int components = table.size.size() > 1 ? static_cast<int>(table.size[1]) : 1;
      if (table.type == hdf5::type_of<double>())
        result.reals[column] = {components, read_share<double>(table, result.n_total)};
      else
        result.integers[column] = {components, read_share<std::int64_t>(table, result.n_total)};
    }
    file_.agree();
    return result;
  }

  template <class T>
  std::vector<T> values(const std::string& name) const {
    const Dataset& table = attribute(name);
    if (table.type != hdf5::type_of<T>())
      throw std::runtime_error("\"" + name + "\" in \"" + path_ + "\" has another type than expected");
    std::vector<T> result(table.content.size() / sizeof(T));
    if (!result.empty()) std::memcpy(result.data(), table.content.data(), result.size() * sizeof(T));
    return result;
  }

  template <class T>
  T value(const std::string& name) const {
    const std::vector<T> all = values<T>(name);
    if (all.size() != 1) throw std::runtime_error("\"" + name + "\" in \"" + path_ + "\" is not a single value");
    return all.front();
  }

  std::string text(const std::string& name) const {
    const Dataset& table = attribute(name);
    if (table.type.kind != hdf5::Kind::text) throw std::runtime_error("\"" + name + "\" is not a text");
    std::string text(reinterpret_cast<const char*>(table.content.data()), table.content.size());
    while (!text.empty() && text.back() == '\0') text.pop_back();
    return text;
  }

 private:
  void check_format() const {
    file_.root.integer(format_key);
    entities();
    attributes();
  }

  [[noreturn]] void absent(const char* what, const std::string& name) const {
    throw std::runtime_error("\"" + path_ + "\" has no " + what + " named \"" + name + "\"");
  }

  const Dataset& attribute(const std::string& name) const {
    const auto found = attributes().datasets.find(name);
    if (found == attributes().datasets.end()) absent("value", name);
    return found->second;
  }

  /// This rank's rows of a table of `rows` rows.
  template <class T>
  std::vector<T> read_share(const Dataset& table, std::int64_t rows) {
    const std::int64_t begin = SlabExchange::slab_begin(rows, rank_, n_ranks_);
    const std::int64_t end = SlabExchange::slab_begin(rows, rank_ + 1, n_ranks_);
    std::vector<T> values(static_cast<std::size_t>(end - begin) * table.row_bytes() / sizeof(T));
    const std::uint64_t place = table.places.at(0) + static_cast<std::uint64_t>(begin) * table.row_bytes();
    file_.read(place, std::as_writable_bytes(std::span(values)));
    return values;
  }

  std::string path_;
  int rank_ = 0, n_ranks_ = 1;
  hdf5::Hdf5File file_;
};

RestartReader::RestartReader(MPI_Comm comm, const std::string& path) : impl_(std::make_unique<Impl>(comm, path)) {}
RestartReader::RestartReader(RestartReader&&) noexcept = default;
RestartReader& RestartReader::operator=(RestartReader&&) noexcept = default;
RestartReader::~RestartReader() = default;
bool RestartReader::has_entities(const std::string& group) const { return impl_->entities().groups.contains(group); }
RestartEntities RestartReader::read_entities(const std::string& group) { return impl_->read_entities(group); }
bool RestartReader::has_attribute(const std::string& name) const { return impl_->attributes().datasets.contains(name); }
std::string RestartReader::text(const std::string& name) const { return impl_->text(name); }
std::int64_t RestartReader::integer(const std::string& name) const { return impl_->value<std::int64_t>(name); }
double RestartReader::real(const std::string& name) const { return impl_->value<double>(name); }
std::vector<std::int64_t> RestartReader::integers(const std::string& name) const {
  return impl_->values<std::int64_t>(name);
}
std::vector<double> RestartReader::reals(const std::string& name) const { return impl_->values<double>(name); }

}  // namespace kerf
