// Makes the named curves of an input, from tables in place or from CSV files, for whatever asks for them.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/diagnostics.hpp"
#include "input/document.hpp"
#include "input/model_input.hpp"

namespace kerf {

/// Returns the contents of a file; where it cannot be read, sets `failure` to a sentence.
using FileReader = std::function<std::string(const std::string& path, std::string& failure)>;

/// Reads a file of this machine. A path that ends in / names a folder, of which the names of its files *.yaml are read,
/// in the order of the alphabet, one a line.
std::string read_text_file(const std::string& path, std::string& failure);

class CurveTable {
 public:
  using Inputs = std::vector<std::unique_ptr<CurveInput>>;

  /// All must outlive this; `inputs` may grow later. Files are looked for from `folder`.
  CurveTable(const Inputs& inputs, std::string folder, FileReader read, const OriginMap& origins,
             Diagnostics& diagnostics);

  /// The curve of that name, made when it is first asked for; null where there is none. Mistakes in its file go to the
  /// diagnostics, and the curve is zero then.
  const Curve* find(const std::string& name);
  std::vector<std::string> names() const;
  /// Makes the curves that nobody has asked for, and warns of them.
  void finish();
  /// Contents of all files that were read, in the order of the curves.
  std::vector<std::string> file_texts() const;

 private:
  struct Made {
    bool done = false, used = false;
    std::string text;  // of its file
  };
  void make(std::size_t i);
  void make_from_file(CurveInput& input, Made& made);
  Made& state_of(std::size_t i);

  const Inputs& inputs_;
  std::string folder_;
  FileReader read_;
  const OriginMap& origins_;
  Diagnostics& diagnostics_;
  std::vector<Made> made_;
};

}  // namespace kerf
