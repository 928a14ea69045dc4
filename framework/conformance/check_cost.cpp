// What one point of a law costs, beside a law that everyone knows; and whether the compiler has vectorised it.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <regex>
#include <typeinfo>

#include "conformance/checks.hpp"
#include "conformance/law_block.hpp"

namespace kerf {

namespace {

constexpr int n_blocks = 16, n_calls = 20, n_turns = 25;

/// The law that another one of its kind is measured against.
TypeSample yardstick(const std::string& kind) {
  const auto made = [&](const char* name, const char* parameters) {
    TypeSample s;
    s.kind = kind;
    s.name = name;
    s.parameters = tree_of(parameters);
    return s;
  };
  if (kind == "material")
    return made("elastic_plastic", "{shear_modulus: 80 GPa, yield_stress: 400 MPa, hardening_modulus: 500 MPa}");
  if (kind == "eos") return made("linear", "{bulk_modulus: 160 GPa}");
  if (kind == "erosion") return made("plastic_strain", "{limit: 0.3}");
  return made("drucker_prager",
              "{shear_modulus: 50 MPa, strength_at_no_pressure: 10 kPa, slope: 1.2, compactions: [0, 0.05, 0.2], "
              "pressures: '[0, 5, 100] MPa', unloading_moduli: '[300, 600, 1000] MPa'}");
}

/// Calls a law for blocks that begin each time with the same points, so that nothing runs away.
class Timed {
 public:
  Timed(const Registry& registry, const TypeSample& sample)
      : laws_(registry, sample), points_(*laws_.law, laws_.material.density) {
    std::mt19937 random(5);
    for (int b = 0; b < n_blocks; ++b) start_.push_back(points_.random_block<double>(random));
    now_ = start_;
  }
  /// [ns] per point.
  double turn() {
    const auto begin = std::chrono::steady_clock::now();
    for (int call = 0; call < n_calls; ++call)
      for (int b = 0; b < n_blocks; ++b) {
        auto& block = now_[static_cast<std::size_t>(b)];
        const auto& from = start_[static_cast<std::size_t>(b)];
        std::copy(&from.deviator[0][0], &from.deviator[0][0] + 6 * lane_width, &block.deviator[0][0]);
        std::copy(&from.rest[2][0], &from.rest[2][0] + lane_width, &block.rest[2][0]);
        std::copy(&from.state[0][0], &from.state[0][0] + points_.n_state() * lane_width, &block.state[0][0]);
        points_.apply(block);
      }
    const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - begin;
    return spent.count() / (n_calls * n_blocks * lane_width);
  }

 private:
  SampleLaws laws_;
  LawPoints points_;
  std::vector<LawBlock<double>> start_, now_;
};

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

// ---- vectorisation

struct Remark {
  std::string file, text;
  int line = 0;
  bool missed = false;
  std::string place() const { return fmt::format("{}:{}", file, line); }
};

/// What the compiler says of one function.
struct FunctionRemarks {
  std::string name;
  std::vector<Remark> remarks;
};

std::vector<FunctionRemarks> remarks_of(const std::string& path) {
  std::vector<FunctionRemarks> all;
  std::ifstream file(path);
  static const std::regex form("(.+):([0-9]+):[0-9]+: (optimized|missed): +(.*)");
  for (std::string line; std::getline(file, line);) {
    std::smatch m;
    if (line.starts_with(";; Function")) all.push_back({line, {}});
    if (!all.empty() && std::regex_match(line, m, form))
      all.back().remarks.push_back({m[1], m[4], std::stoi(m[2]), m[3] == "missed"});
  }
  return all;
}

/// Whether the function is the one that calls the law of this type for a block of doubles.
bool is_loop_of(const FunctionRemarks& f, const std::string& mangled_type) {
  if (f.name.find("I" + mangled_type + "E") == std::string::npos) return false;
  return f.name.find("6updateE") != std::string::npos || f.name.find("8evaluateE") != std::string::npos ||
         f.name.find("5judgeE") != std::string::npos || f.name.find("10judge_rowsI") != std::string::npos;
}

constexpr const char* gives_up = "couldn't vectorize loop";

/// The first loop that was given up in all ways; null where there is none. A loop is tried with registers of several
/// sizes.
const Remark* given_up(const FunctionRemarks& f) {
  for (const Remark& r : f.remarks) {
    if (!r.missed || r.text != gives_up) continue;
    const auto done = [&](const Remark& o) {
      return !o.missed && o.place() == r.place() && o.text.starts_with("loop vectorized");
    };
    if (std::none_of(f.remarks.begin(), f.remarks.end(), done)) return &r;
  }
  return nullptr;
}

/// The first remark about the author's code that tells why a loop was not vectorised.
const Remark* first_obstacle(const FunctionRemarks& f, const std::string& origin) {
  const std::string folder = std::filesystem::path(origin).parent_path().string();
  const auto is_authors = [&](const Remark& r) {
    return r.file == origin || (!folder.empty() && r.file.starts_with(folder + "/"));
  };
  for (const char* beginning : {"not vectorized", "statement clobbers memory", ""})
    for (const Remark& r : f.remarks)
      if (r.missed && is_authors(r) && r.text.starts_with(beginning)) return &r;
  return nullptr;
}

}  // namespace

void check_cost(const Registry& registry, const TypeSample& sample, Verdicts& out) {
  if (!out.wants("cost")) return;
  const TypeSample other = yardstick(sample.kind);
  Timed mine(registry, sample), theirs(registry, other);
  std::vector<double> a, b;
  for (int turn = 0; turn < n_turns; ++turn) {
    a.push_back(mine.turn());
    b.push_back(theirs.turn());
  }
  out.note("cost", fmt::format("{:.1f} ns a point, {:.2f} times {}'s {:.1f} ns on this machine", median(a),
                               median(a) / median(b), other.name, median(b)));
}

void report_vectorisation(const Registry& registry, const TypeSample& sample, const std::string& library,
                          Verdicts& out) {
  const char* check = "vectorised";
  if (!out.wants(check) || library.empty()) return;
  const std::filesystem::path path(library);
  const std::string report = (path.parent_path() / path.stem()).string() + ".vec.txt";
  const std::string origin = registry.find(sample.kind, sample.name)->origin;
  const auto made = registry.make(sample.kind, sample.name);
  const Plugin& plugin = *made.plugin;
  const std::string type = typeid(plugin).name();
  for (const FunctionRemarks& f : remarks_of(report)) {
    if (!is_loop_of(f, type)) continue;
    // Loops that only copy rows are no matter: where the law stops the loop of the points, none is vectorised.
    const Remark* loop = given_up(f);
    const bool any = std::any_of(f.remarks.begin(), f.remarks.end(), [](const Remark& r) { return !r.missed; });
    if (!loop && !any) continue;
    if (any) {
      out.note(check, "the loop over the points is vectorised");
      return;
    }
    const Remark* obstacle = first_obstacle(f, origin);
    out.note(check, fmt::format("the loop over the points is not vectorised: {}",
                                obstacle ? fmt::format("{}: {}", obstacle->place(), obstacle->text)
                                         : fmt::format("{}: {}; {} has all that the compiler says", loop->place(),
                                                       loop->text, report)));
    return;
  }
  out.note(check,
           fmt::format("not known: {} says nothing of a loop over the points of this law; a plugin that is built "
                       "with kerf_add_plugin() and GCC has this file beside it",
                       report));
}

}  // namespace kerf
