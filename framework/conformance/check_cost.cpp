// What one point of a law costs, beside a law that everyone knows; and whether the compiler has vectorised it.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <random>
#include <regex>
#include <set>

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
};

std::vector<Remark> remarks_of(const std::string& path) {
  std::vector<Remark> all;
  std::ifstream file(path);
  static const std::regex form("(.+):([0-9]+):[0-9]+: (optimized|missed): +(.*)");
  for (std::string line; std::getline(file, line);) {
    std::smatch m;
    if (std::regex_match(line, m, form)) all.push_back({m[1], m[3].str() + ": " + m[4].str(), std::stoi(m[2])});
  }
  return all;
}

/// Whether the loop over the lanes in the header of a kind was vectorised, by all remarks about it. The header says
/// itself where the loop begins and ends: from its function of one point to the loop below the pragma.
std::optional<bool> loop_vectorised(const std::vector<Remark>& remarks, const std::string& kind) {
  const std::string header = "kerf/" + kind + ".hpp";
  std::optional<bool> found;
  for (const Remark& r : remarks) {
    if (!r.file.ends_with(header)) continue;
    const bool done = r.text.find("optimized: loop vectorized") == 0;
    if (!done && r.text.find("missed: couldn't vectorize loop") != 0) continue;
    found = found.value_or(true) && done;
  }
  return found;
}

/// The first remark about the author's code that tells why a loop was not vectorised.
const Remark* first_obstacle(const std::vector<Remark>& remarks, const std::string& origin) {
  const std::string folder = std::filesystem::path(origin).parent_path().string();
  const auto is_authors = [&](const Remark& r) {
    return r.file == origin || (!folder.empty() && r.file.starts_with(folder + "/"));
  };
  for (const char* beginning : {"missed: not vectorized", "missed: statement clobbers", "missed: "})
    for (const Remark& r : remarks)
      if (is_authors(r) && r.text.starts_with(beginning) && r.text.find("couldn't vectorize loop") == std::string::npos)
        return &r;
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

void report_vectorisation(const Description& d, int types_of_its_kind, const std::string& library, Verdicts& out) {
  const char* check = "vectorised";
  if (!out.wants(check) || library.empty() || !is_law_kind(d.kind)) return;
  const std::filesystem::path path(library);
  const std::string report = (path.parent_path() / path.stem()).string() + ".vec.txt";
  const std::vector<Remark> remarks = remarks_of(report);
  const std::optional<bool> vectorised = loop_vectorised(remarks, d.kind);
  const std::string share =
      types_of_its_kind > 1 ? fmt::format(" (of {} laws of this kind in the library, all that are)", types_of_its_kind)
                            : "";
  if (!vectorised) {
    out.note(check, fmt::format("not known: {} says nothing of the loop over the points; build with kerf_add_plugin() "
                                "and GCC, which writes this file, or with -fopt-info-vec-optimized-missed=FILE",
                                report));
    return;
  }
  if (*vectorised) {
    out.note(check, "the loop over the points is vectorised" + share);
    return;
  }
  const Remark* obstacle = first_obstacle(remarks, d.origin);
  out.note(check, fmt::format("the loop over the points is not vectorised{}; {}", share,
                              obstacle ? fmt::format("the first obstacle in your code is {}:{}: {}", obstacle->file,
                                                     obstacle->line, obstacle->text)
                                       : "the compiler names no obstacle in your code; " + report + " has all it said"));
}

}  // namespace kerf
