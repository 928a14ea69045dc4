// Collects everything that is wrong with an input, each with the place where it was written.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace kerf {

/// Place in a file, counted from one; a default Origin means "nowhere in particular".
struct Origin {
  std::shared_ptr<const std::string> file;
  int line = 0, column = 0;

  /// "file:line:column", "file" where the line is unknown, empty where the file is.
  std::string text() const;
};

/// The user's mistakes, thrown once all of them are known; leads to exit code 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<std::string> lines);
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> lines_;
};

/// Gathers "origin: error: sentence" lines; nothing is printed here.
class Diagnostics {
 public:
  void error(const Origin& where, const std::string& message);
  /// `where` as text, e.g. Plugin::origin.
  void error(const std::string& where, const std::string& message);
  /// A whole line that has its place and "error" in it already.
  void error_line(const std::string& line) { errors_.push_back(line); }
  void warning(const Origin& where, const std::string& message);
  /// A whole line that has its place and "warning" in it already.
  void warning_line(const std::string& line) { warnings_.push_back(line); }
  bool has_errors() const { return !errors_.empty(); }
  const std::vector<std::string>& errors() const { return errors_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Throws InputError with all errors so far, if there are any.
  void throw_if_errors() const;

 private:
  std::vector<std::string> errors_, warnings_;
};

/// The name in `candidates` that is closest to `name` by edit distance, or empty where none is near.
std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace kerf
