// How columns lie in the file: each in one block with room to grow, which moves to a larger one when it is full.
#include "output/columns.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "output/collective.hpp"
#include "output/hdf5_file.hpp"

namespace kerf {

namespace {

using Clock = std::chrono::steady_clock;

hdf5::Group described(const ColumnTable& table) {
  hdf5::Group group;
  group.set("type", table.type);
  const auto add = [&](const std::string& name, const std::string& unit) {
    hdf5::Dataset& column = group.datasets[name];
    column.type = hdf5::type_of<double>();
    column.size = {0};
    group.set("unit of " + name, unit);
  };
  add("time", "s");
  for (const ColumnInfo& column : table.columns) {
    add(column.name, column.unit);
    group.set("meaning of " + column.name, column.doc);
  }
  return group;
}

bool same_columns(const hdf5::Group& a, const hdf5::Group& b) {
  const auto key = [](const hdf5::Group& g) {
    std::vector<std::string> names;
    for (const auto& [name, column] : g.datasets) names.push_back(name);
    for (const hdf5::Attribute& attribute : g.attributes)
      if (attribute.name.rfind("meaning of ", 0) != 0)
        names.emplace_back(reinterpret_cast<const char*>(attribute.content.data()), attribute.content.size());
    return names;
  };
  return key(a) == key(b);
}

}  // namespace

/// The file on rank 0, where nobody else has to agree.
class ColumnFile::Impl {
 public:
  Impl(const std::string& path, const std::vector<ColumnTable>& tables) : path_(path) {
    file_ = hdf5::Hdf5File::create(MPI_COMM_SELF, path + ".part");
    for (const ColumnTable& table : tables) file_.root.groups[table.name] = described(table);
    open_tables(tables);
    commit();
    file_.publish(path);
  }

  Impl(const std::string& path, const std::vector<ColumnTable>& tables, double time) : path_(path) {
    file_ = hdf5::Hdf5File::open(MPI_COMM_SELF, path, true, false);
    bool same = file_.root.groups.size() == tables.size();
    for (const ColumnTable& table : tables) {
      const auto found = file_.root.groups.find(table.name);
      same = same && found != file_.root.groups.end() && same_columns(found->second, described(table));
    }
    if (!same)
      throw std::runtime_error("\"" + path + "\" has other columns than the observers of this run fill, so it cannot " +
                               "be continued; resume with the observers that the run began with");
    open_tables(tables);
    for (Table& table : tables_) cut_back(table, time);
    commit();  // before new rows are written over the old ones
  }

  double last_time(std::size_t table) const { return tables_[table].last_time; }

  void add_row(std::size_t k, double time, std::span<const double> values) {
    Table& table = tables_[k];
    if (values.size() + 1 != table.columns.size()) throw std::logic_error("a row has a value for each column");
    table.columns[0].pending.push_back(time);
    for (std::size_t c = 0; c < values.size(); ++c) table.columns[c + 1].pending.push_back(values[c]);
    pending_ = true;
    if (Clock::now() - last_commit_ >= std::chrono::seconds(1)) commit();
  }

  void sync() {
    if (pending_) commit();
  }
  void close() {
    sync();
    file_.close();
  }

 private:
  struct Column {
    hdf5::Dataset* data = nullptr;
    std::vector<double> pending;
  };
  struct Table {
    std::vector<Column> columns;  // the time first
    std::uint64_t capacity = 0;  // rows that have room in the blocks
    double last_time = -1.0;
  };

  void open_tables(const std::vector<ColumnTable>& tables) {
    file_.take_turns();
    for (const ColumnTable& info : tables) {
      hdf5::Group& group = file_.root.groups.at(info.name);
      Table table;
      table.columns.push_back({&group.datasets.at("time"), {}});
      for (const ColumnInfo& column : info.columns) table.columns.push_back({&group.datasets.at(column.name), {}});
      table.capacity = table.columns[0].data->size[0];
      tables_.push_back(std::move(table));
    }
  }

  std::vector<double> rows_of(const hdf5::Dataset& column) {
    std::vector<double> values(column.size[0]);
    if (!values.empty()) file_.read(column.places.at(0), std::as_writable_bytes(std::span(values)));
    file_.agree();
    return values;
  }

  void cut_back(Table& table, double time) {
    const std::vector<double> times = rows_of(*table.columns[0].data);
    std::uint64_t kept = 0;
    while (kept < times.size() && times[kept] <= time) ++kept;
    for (Column& column : table.columns) column.data->size = {kept};
    if (kept > 0) table.last_time = times[kept - 1];
  }

  /// Moves the columns of a table to blocks of twice the size.
  void make_room(Table& table, std::uint64_t rows) {
    if (rows <= table.capacity) return;
    table.capacity = std::max<std::uint64_t>(64, 2 * rows);
    for (Column& column : table.columns) {
      const std::vector<double> values = rows_of(*column.data);
      column.data->places = {file_.allocate(table.capacity * sizeof(double))};
      file_.write(column.data->places[0], std::as_bytes(std::span(values)));
    }
  }

  void commit() {
    for (Table& table : tables_) {
      const std::uint64_t rows = table.columns[0].data->size[0], added = table.columns[0].pending.size();
      if (added == 0) continue;
      make_room(table, rows + added);
      for (Column& column : table.columns) {
        file_.write(column.data->places[0] + rows * sizeof(double), std::as_bytes(std::span(column.pending)));
        column.data->size = {rows + added};
        column.pending.clear();
      }
    }
    file_.commit();
    pending_ = false;
    last_commit_ = Clock::now();
  }

  std::string path_;
  hdf5::Hdf5File file_;
  std::vector<Table> tables_;
  bool pending_ = false;
  Clock::time_point last_commit_;
};

ColumnFile::ColumnFile(MPI_Comm comm) : comm_(comm) {}
ColumnFile::ColumnFile(ColumnFile&&) noexcept = default;
ColumnFile& ColumnFile::operator=(ColumnFile&&) noexcept = default;
ColumnFile::~ColumnFile() = default;

ColumnFile::ColumnFile(MPI_Comm comm, const std::string& path, const std::vector<ColumnTable>& tables)
    : comm_(comm), last_times_(tables.size(), -1.0) {
  on_root(comm, [&] { impl_ = std::make_unique<Impl>(path, tables); });
}

ColumnFile ColumnFile::resume(MPI_Comm comm, const std::string& path, const std::vector<ColumnTable>& tables,
                              double time) {
  ColumnFile file(comm);
  file.last_times_.resize(tables.size());
  on_root(comm, [&] {
    file.impl_ = std::make_unique<Impl>(path, tables, time);
    for (std::size_t k = 0; k < tables.size(); ++k) file.last_times_[k] = file.impl_->last_time(k);
  });
  MPI_Bcast(file.last_times_.data(), static_cast<int>(tables.size()), MPI_DOUBLE, 0, comm);
  return file;
}

void ColumnFile::add_row(std::size_t table, double time, std::span<const double> values) {
  on_root(comm_, [&] { impl_->add_row(table, time, values); });
}
void ColumnFile::sync() {
  on_root(comm_, [&] { impl_->sync(); });
}
void ColumnFile::close() {
  on_root(comm_, [&] { impl_->close(); });
}

}  // namespace kerf
