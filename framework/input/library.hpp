// The material library: named sets of constants in YAML files, each with the sources of its numbers.
//
// A file holds the sets of one family: the key `family` with a title, then one block per set (MaterialSet). Files of a
// user's own are read beside those that come with Kerf.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/diagnostics.hpp"
#include "input/curve_table.hpp"
#include "input/document.hpp"

namespace kerf {

/// One entry of a library file.
struct MaterialSet {
  std::string name, family, description, citation, notes;
  std::string file;  // as it was read, with its folder
  Origin origin;
  bool verified = false;  // every number was found in two independent sources, or follows from such numbers
  Node material;  // the blocks of a material, as a user would write them
  Node suggested;  // blocks that are used where the user asks for them: `erosion: suggested`
  Node to_give;  // what a user has to add, with example values; nothing for most sets
  /// Sources by path inside `material` and `suggested`: "density", "strength", "strength.C".
  std::vector<std::pair<std::string, std::string>> provenance;

  /// Fingerprint of the numbers, 16 hexadecimal digits.
  std::string hash() const;
  /// Source of the value at a path: its own or that of the innermost block round it. Empty where there is none.
  std::string source_of(std::string path) const;
  /// The name of the file without its folder.
  std::string file_name() const;
};

class MaterialLibrary {
 public:
  /// Reads all files *.yaml of the folders. What is wrong with them goes to `diagnostics`, with the place in the file.
  MaterialLibrary(const std::vector<std::string>& folders, const FileReader& read, Diagnostics& diagnostics);

  const MaterialSet* find(const std::string& name) const;  // null where absent
  /// In the order of the files and, inside, of writing.
  const std::vector<MaterialSet>& sets() const { return sets_; }
  std::vector<std::string> names() const;
  /// What to say to somebody who asked for a set that is not there: "; did you mean `a` or `b`?", or where to look.
  std::string suggestion_for(const std::string& name) const;

 private:
  void read_file(const std::string& path, const std::string& text, Diagnostics& diagnostics);
  std::vector<MaterialSet> sets_;
};

/// The folder of the sets that come with Kerf: below the installation of the running program or, in a build tree, in
/// the sources. Then the folders that the environment variable KERF_LIBRARY names, separated by colons.
std::vector<std::string> library_folders();

/// Puts the blocks of the named sets in the place of each `library: NAME` under `materials`. What the input gives
/// beside it replaces single keys of the set, at any depth; a block of another `type` replaces the whole block. Values
/// keep the place where they were written, in the input or in the library. The key `library` at the top names further
/// folders, relative to `input_folder`. Unverified sets are warnings. Throws InputError where a set is not found.
std::vector<LibraryUse> expand_library(Node& root, const std::string& input_folder, std::vector<std::string> folders,
                                       const FileReader& read, Diagnostics& diagnostics);

}  // namespace kerf
