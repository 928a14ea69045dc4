// The order of the checks.
#include "conformance/conformance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <stdexcept>

#include "conformance/checks.hpp"
#include "core/flush_denormals.hpp"

namespace kerf {

namespace {

/// A folder that is gone at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "kerf_test_plugin_XXXXXX").string();
    if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder can be made: " + pattern);
    path = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string path;
};

void check_law(const Registry& registry, const TypeSample& sample, Verdicts& out) {
  using Check = void (*)(const Registry&, const TypeSample&, Verdicts&);
  const std::pair<const char*, Check> checks[] = {{"lanes", check_blocks},       {"convergence", check_paths},
                                                  {"energy", check_energy},      {"moduli", check_moduli},
                                                  {"hidden_state", check_state}, {"cost", check_cost}};
  for (const auto& [name, check] : checks) try {
      check(registry, sample, out);
    } catch (const std::exception& e) {
      out.fail(name, fmt::format("the check cannot be made: {}", sentence_of(e)));
    }
}

const char* what_a_sample_is(const std::string& kind) {
  if (is_law_kind(kind) || kind == "mesh" || kind == "partitioner" || kind == "balance_policy" || kind == "element")
    return "give its parameters in the file of --samples";
  return "name an input that uses it under `inputs` in the file of --samples";
}

class Tester {
 public:
  Tester(const Registry& registry, const Samples& samples, const ConformanceOptions& options)
      : registry_(registry), samples_(samples), options_(options), out_(options.checks) {
    place_.folder = folder_.path;
    if (!options.library.empty()) place_.plugins.push_back(std::filesystem::absolute(options.library).string());
  }

  Verdicts run() {
    for (const auto& [kind, name] : options_.types) test_alone(kind, name);
    check_runs(registry_, in_runs_, place_, out_);
    for (const auto& [input, types] : inputs_) check_input(types, input, place_, out_);
    return std::move(out_);
  }

 private:
  void test_alone(const std::string& kind, const std::string& name) {
    const Description& d = *registry_.find(kind, name);
    out_.begin(kind + "." + name);
    check_documentation(d, out_);
    const TypeSample* sample = samples_.find(kind, name);
    const std::string input = samples_.input(kind, name);
    if (!input.empty()) inputs_[input].push_back(kind + "." + name);
    if (!sample) {
      if (input.empty()) out_.fail("sample", fmt::format("it has no sample; {}", what_a_sample_is(kind)));
      return;
    }
    if (!check_parameters(registry_, *sample, out_)) return;
    if (is_law_kind(kind)) {
      check_law(registry_, *sample, out_);
      report_vectorisation(registry_, *sample, options_.library, out_);
    }
    if (kind == "mesh") check_mesh(registry_, *sample, out_);
    in_runs_.push_back(sample);
  }

  const Registry& registry_;
  const Samples& samples_;
  const ConformanceOptions& options_;
  TemporaryFolder folder_;
  RunPlace place_;
  Verdicts out_;
  std::vector<const TypeSample*> in_runs_;
  std::map<std::string, std::vector<std::string>> inputs_;
};

}  // namespace

const std::vector<std::string>& conformance_checks() {
  static const std::vector<std::string> all = {"documentation",    "sample",      "ranges",       "lanes",
                                               "finite",           "objectivity", "rotated_path", "convergence",
                                               "single_precision", "energy",      "moduli",       "restart",
                                               "hidden_state",     "cost",        "vectorised",   "mesh",
                                               "migration",        "run_restart", "balance"};
  return all;
}

Verdicts test_types(const Registry& registry, const Samples& samples, const ConformanceOptions& options) {
  const FlushDenormals flush;
  return Tester(registry, samples, options).run();
}

std::string table_of(const std::vector<ConformanceRow>& rows) {
  std::vector<ConformanceRow> sorted = rows;
  // Rows of runs come last; a reader wants all of a type together.
  std::vector<std::string> order;
  for (const ConformanceRow& r : rows)
    if (std::find(order.begin(), order.end(), r.type) == order.end()) order.push_back(r.type);
  const auto place = [&](const ConformanceRow& r) { return std::find(order.begin(), order.end(), r.type); };
  std::stable_sort(sorted.begin(), sorted.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
  std::string text, type;
  std::map<Outcome, int> counts;
  for (const ConformanceRow& r : sorted) {
    if (r.type != type) text += fmt::format("{}{}\n", type.empty() ? "" : "\n", r.type);
    type = r.type;
    ++counts[r.outcome];
    const char* outcome = r.outcome == Outcome::pass ? "pass" : r.outcome == Outcome::fail ? "FAIL" : "note";
    text += fmt::format("  {:<17} {}  {}\n", r.check, outcome, r.sentence);
  }
  return text + fmt::format("\n{} types: {} rows pass, {} fail, {} notes\n", order.size(), counts[Outcome::pass],
                            counts[Outcome::fail], counts[Outcome::note]);
}

}  // namespace kerf
