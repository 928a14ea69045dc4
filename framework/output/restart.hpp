// The restart file: the exact bits of a model, readable by any number of ranks.
//
// Entities are stored compactly and sorted by global id, one table per column, so the values do not depend on how the
// model was divided. A file becomes visible under its name only when it is complete, the one before it is kept beside
// it, and all bytes of a file are compared with their checksums before any of them is believed.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace kerf {

/// Raised whenever the contents of a restart file change meaning.
inline constexpr std::int64_t restart_format = 3;

/// Where the file before the newest is kept: "restart/restart_previous.h5" for "restart/restart.h5".
std::string previous_restart(const std::string& path);

/// A quantity to be stored: `components` values per entity, in the order of the entities' ids.
struct RestartColumn {
  std::string name;
  int components = 1;
  std::variant<const double*, const std::int64_t*> data;
};

/// Writes one restart file. All functions are collective. Failures of the file throw OutputError on all ranks, not
/// later than in finish(); the files before stay as they are.
class RestartWriter {
 public:
  /// Begins "<path>.part"; what is at `path` stays until finish().
  RestartWriter(MPI_Comm comm, const std::string& path);
  RestartWriter(RestartWriter&&) noexcept;
  RestartWriter& operator=(RestartWriter&&) noexcept;
  /// Without finish(), the unfinished file is removed and the previous complete one stays.
  ~RestartWriter();

  /// Stores the entities that ranks hold, each once. Pre: ids are in [0, n_global); there may be fewer entities
  /// than n_global (the dead are absent); columns have the same names, types and components on all ranks.
  void write_entities(const std::string& group, std::int64_t n_global, std::span<const std::int64_t> gids,
                      const std::vector<RestartColumn>& columns);

  /// Stores a value of the whole model; that of rank 0 counts.
  void write_attribute(const std::string& name, const std::string& value);
  void write_attribute(const std::string& name, const char* value) { write_attribute(name, std::string(value)); }
  void write_attribute(const std::string& name, double value) { write_attribute(name, std::vector{value}); }
  void write_attribute(const std::string& name, const std::vector<double>& values);
  void write_attribute(const std::string& name, const std::vector<std::int64_t>& values);
  template <class Int, std::enable_if_t<std::is_integral_v<Int>, int> = 0>
  void write_attribute(const std::string& name, Int value) {
    write_attribute(name, std::vector<std::int64_t>{static_cast<std::int64_t>(value)});
  }

  /// Completes the file on disk and gives it its name. What had that name becomes previous_restart().
  void finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// One rank's share of the entities of a group: consecutive in the order of global ids.
struct RestartEntities {
  std::int64_t n_global = 0;  // as passed when writing
  std::int64_t n_total = 0;  // entities in the file
  std::vector<std::int64_t> gids;

  template <class T>
  struct Column {
    int components = 1;
    std::vector<T> values;
  };
  std::map<std::string, Column<double>> reals;
  std::map<std::string, Column<std::int64_t>> integers;

  /// The column of that name; throws std::runtime_error where there is none or its components differ.
  const std::vector<double>& real(const std::string& name, int components) const;
  const std::vector<std::int64_t>& integer(const std::string& name, int components) const;
};

/// Reads a restart file. All functions are collective; what they return is equal on all ranks unless it says
/// otherwise. Failures throw std::runtime_error on all ranks, those of the file OutputError.
class RestartReader {
 public:
  /// Throws OutputError where the file is absent, damaged, not a restart file, or of another format.
  RestartReader(MPI_Comm comm, const std::string& path);
  RestartReader(RestartReader&&) noexcept;
  RestartReader& operator=(RestartReader&&) noexcept;
  ~RestartReader();

  bool has_entities(const std::string& group) const;
  /// Rank r of R gets the stored entities [r M / R, (r + 1) M / R).
  RestartEntities read_entities(const std::string& group);

  bool has_attribute(const std::string& name) const;
  std::string text(const std::string& name) const;
  std::int64_t integer(const std::string& name) const;
  double real(const std::string& name) const;
  std::vector<std::int64_t> integers(const std::string& name) const;
  std::vector<double> reals(const std::string& name) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
