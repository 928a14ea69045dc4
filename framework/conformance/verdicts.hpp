// What the conformance tests find: one row per type and check.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/activity.hpp"

namespace kerf {

enum class Outcome { pass, fail, note };  // a note is told, and fails nothing

struct ConformanceRow {
  std::string type;  // "material.swift"
  std::string check;  // "objectivity"
  Outcome outcome = Outcome::pass;
  std::string sentence;  // what was found, with numbers; of a failure also what to do
};

/// Collects the rows of the types that are tested, one type after the other.
class Verdicts {
 public:
  /// `checks` are the names of the checks that are wanted; all where it is empty.
  explicit Verdicts(std::vector<std::string> checks = {}) : checks_(std::move(checks)) {}

  void begin(std::string type) { type_ = std::move(type); }
  bool wants(const std::string& check) const {
    return checks_.empty() || std::find(checks_.begin(), checks_.end(), check) != checks_.end();
  }
  /// A failure is told whether its check is wanted or not: what could not be tested has not passed.
  void add(Outcome outcome, const std::string& check, std::string sentence) {
    activity::beat();
    if (wants(check) || outcome == Outcome::fail) rows_.push_back({type_, check, outcome, std::move(sentence)});
  }
  void pass(const std::string& check, std::string sentence) { add(Outcome::pass, check, std::move(sentence)); }
  void fail(const std::string& check, std::string sentence) { add(Outcome::fail, check, std::move(sentence)); }
  void note(const std::string& check, std::string sentence) { add(Outcome::note, check, std::move(sentence)); }

  const std::vector<ConformanceRow>& rows() const { return rows_; }
  bool all_pass() const {
    return std::none_of(rows_.begin(), rows_.end(), [](const auto& r) { return r.outcome == Outcome::fail; });
  }

 private:
  std::vector<std::string> checks_;
  std::string type_;
  std::vector<ConformanceRow> rows_;
};

}  // namespace kerf
