// The HDF5 layout behind restart files: /entities/<group>/{gids, columns/...} and /attributes/<name>.
#include "output/restart.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "output/collective.hpp"
#include "output/hdf5.hpp"
#include "output/slab.hpp"

namespace kerf {

namespace {

using hdf5::Handle;

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

// ---------------------------------------------------------------------------------------------------------
// Writing

class RestartWriter::Impl {
 public:
  Impl(MPI_Comm comm, const std::string& path) : comm_(comm), path_(path) {
    MPI_Comm_rank(comm, &rank_);
    file_ = hdf5::create_file(comm, unfinished());
    hdf5::write_attribute(file_, format_key, {&restart_format, 1}, true);
    attributes_ = hdf5::create_group(file_, "attributes");
    entities_ = hdf5::create_group(file_, "entities");
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

    const Handle group = hdf5::create_group(entities_, checked_name(name));
    hdf5::write_attribute(group, "n_global", {&n_global, 1}, true);
    const Handle ids = hdf5::create_table(group, "gids", hdf5::type_of<std::int64_t>(), total, 0);
    hdf5::write_rows<std::int64_t>(ids, begin, stored);
    const Handle tables = hdf5::create_group(group, "columns");
    for (const RestartColumn& column : columns) {
      std::visit(
          [&]<class T>(const T* data) {
            const auto n = gids.size() * static_cast<std::size_t>(column.components);
            auto slab = plan.to_slab<T>(std::span<const T>(data, n), column.components, T(0));
            compact(slab, plan.present(), column.components);
            const Handle table =
                hdf5::create_table(tables, checked_name(column.name), hdf5::type_of<T>(), total, column.components);
            hdf5::write_rows<T>(table, begin, slab);
          },
          column.data);
    }
  }

  template <class T>
  void write_values(const std::string& name, std::vector<T> values) {
    broadcast(comm_, values);
    const Handle table = hdf5::create_table(attributes_, checked_name(name), hdf5::type_of<T>(),
                                            static_cast<std::int64_t>(values.size()), 0);
    if (rank_ == 0) hdf5::write_rows<T>(table, 0, values);
  }

  void write_text(const std::string& name, std::string text) {
    broadcast_text(comm_, text);
    hdf5::write_text(attributes_, checked_name(name), text, rank_ == 0);
  }

  void finish() {
    if (!file_) throw std::logic_error("a restart file is finished once");
    hdf5::flush(file_);  // to disk before the name changes hands
    entities_.reset();
    attributes_.reset();
    file_.reset();
    MPI_Barrier(comm_);
    on_root(comm_, [this] { std::filesystem::rename(unfinished(), path_); });
  }

 private:
  std::string unfinished() const { return path_ + ".part"; }

  MPI_Comm comm_;
  int rank_ = 0;
  std::string path_;
  Handle file_, attributes_, entities_;
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
    file_ = hdf5::open_file(comm, path, false);
    if (!hdf5::has_attribute(file_, format_key)) throw std::runtime_error("\"" + path + "\" is not a restart file");
    const std::int64_t format = hdf5::read_attribute(file_, format_key);
    if (format != restart_format)
      throw std::runtime_error("\"" + path + "\" has restart format " + std::to_string(format) +
                               ", and this program reads format " + std::to_string(restart_format) +
                               "; resume with the version of Kerf that wrote it");
    attributes_ = hdf5::open_group(file_, "attributes");
    entities_ = hdf5::open_group(file_, "entities");
  }

  const Handle& attributes() const { return attributes_; }
  const Handle& entities() const { return entities_; }

  RestartEntities read_entities(const std::string& name) const {
    require(entities_, name, "entities");
    const Handle group = hdf5::open_group(entities_, name);
    const Handle ids = hdf5::open_dataset(group, "gids");
    RestartEntities result;
    result.n_global = hdf5::read_attribute(group, "n_global");
    result.n_total = hdf5::n_rows(ids);
    const std::int64_t begin = SlabExchange::slab_begin(result.n_total, rank_, n_ranks_);
    const auto count = static_cast<std::size_t>(SlabExchange::slab_begin(result.n_total, rank_ + 1, n_ranks_) - begin);
    result.gids.resize(count);
    hdf5::read_rows<std::int64_t>(ids, begin, result.gids);
    const Handle tables = hdf5::open_group(group, "columns");
    for (const std::string& column : hdf5::names_in(tables)) {
      const Handle table = hdf5::open_dataset(tables, column);
      const int components = hdf5::n_components(table);
      const auto read = [&]<class T>(std::map<std::string, RestartEntities::Column<T>>& columns) {
        std::vector<T> values(count * static_cast<std::size_t>(components));
        hdf5::read_rows<T>(table, begin, values);
        columns[column] = {components, std::move(values)};
      };
      if (hdf5::is_table_of<double>(table))
        read(result.reals);
      else
        read(result.integers);
    }
    return result;
  }

  template <class T>
  std::vector<T> values(const std::string& name) const {
    require(attributes_, name, "value");
    const Handle table = hdf5::open_dataset(attributes_, name);
    if (!hdf5::is_table_of<T>(table))
      throw std::runtime_error("\"" + name + "\" in \"" + path_ + "\" has another type than expected");
    std::vector<T> result(static_cast<std::size_t>(hdf5::n_rows(table)));
    hdf5::read_rows<T>(table, 0, result);
    return result;
  }

  template <class T>
  T value(const std::string& name) const {
    const std::vector<T> all = values<T>(name);
    if (all.size() != 1) throw std::runtime_error("\"" + name + "\" in \"" + path_ + "\" is not a single value");
    return all.front();
  }

  std::string text(const std::string& name) const {
    require(attributes_, name, "value");
    return hdf5::read_text(attributes_, name);
  }

 private:
  void require(const Handle& group, const std::string& name, const char* what) const {
    if (!hdf5::has_link(group, name))
      throw std::runtime_error("\"" + path_ + "\" has no " + what + " named \"" + name + "\"");
  }

  std::string path_;
  int rank_ = 0, n_ranks_ = 1;
  Handle file_, attributes_, entities_;
};

RestartReader::RestartReader(MPI_Comm comm, const std::string& path) : impl_(std::make_unique<Impl>(comm, path)) {}
RestartReader::RestartReader(RestartReader&&) noexcept = default;
RestartReader& RestartReader::operator=(RestartReader&&) noexcept = default;
RestartReader::~RestartReader() = default;
bool RestartReader::has_entities(const std::string& group) const { return hdf5::has_link(impl_->entities(), group); }
RestartEntities RestartReader::read_entities(const std::string& group) const { return impl_->read_entities(group); }
bool RestartReader::has_attribute(const std::string& name) const { return hdf5::has_link(impl_->attributes(), name); }
std::string RestartReader::text(const std::string& name) const { return impl_->text(name); }
std::int64_t RestartReader::integer(const std::string& name) const { return impl_->value<std::int64_t>(name); }
double RestartReader::real(const std::string& name) const { return impl_->value<double>(name); }
std::vector<std::int64_t> RestartReader::integers(const std::string& name) const {
  return impl_->values<std::int64_t>(name);
}
std::vector<double> RestartReader::reals(const std::string& name) const { return impl_->values<double>(name); }

}  // namespace kerf
