// Maps a plugin's kind and name to what it declares and to its maker.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "kerf/plugin.hpp"

namespace kerf {

class Registry final : public Registrar {
 public:
  /// Throws std::runtime_error naming both origins where kind and name are taken already.
  void add(Description description, Made (*make)()) override;

  /// The same for types that are not known to the compiler: laws in Python.
  void add_made(Description description, std::function<Made()> make);

  /// Takes note of a file whose types are registered: its name without folder, and a checksum of its bytes.
  void note_file(const std::string& name, std::uint64_t checksum);
  /// The files that were noted, one a line with its checksum.
  const std::string& files() const { return files_; }

  const Description* find(const std::string& kind, const std::string& name) const;  // null where absent
  /// A new object with `type` and `description` set. Pre: find(kind, name) is not null.
  Made make(const std::string& kind, const std::string& name) const;
  std::vector<std::string> kinds() const;
  std::vector<std::string> names(const std::string& kind) const;

 private:
  struct Entry {
    Description description;
    std::function<Made()> make;
  };
  std::map<std::pair<std::string, std::string>, Entry> entries_;
  std::set<std::string> noted_;  // sorted: the order of loading does not matter
  std::string files_;
};

/// Registers everything that was compiled in; defined in the table that CMake generates.
void register_builtin_plugins(Registrar& registrar);

}  // namespace kerf
