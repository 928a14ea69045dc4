// Files about programmed burn: burnt shares over time and compression, and lighting times without obstacles.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "support/curves.hpp"
#include "support/eos_point.hpp"

namespace kerf::test {

namespace {

bool begins(const Oracle& o, const char* name) { return o.name.starts_with(name); }

/// The numbers behind "name = " in the first lines of a file.
double number_of(const Oracle& o, const std::string& name) {
  for (const std::string& line : o.comments)
    if (const std::size_t at = line.find(name + " = "); at != std::string::npos)
      return std::stod(line.substr(at + name.size() + 3));
  return std::nan("");
}

/// Any products will do: these files are about what lights them.
std::string products(double D) {
  return "A: 371.2e9, B: 3.231e9, R1: 4.15, R2: 0.95, omega: 0.3, initial_energy: 7e9, " +
         key_and_number("detonation_velocity", D);
}

std::vector<CurveResult> burnt_shares(const Oracle& o) {
  const double D = number_of(o, "D"), p = number_of(o, "p_CJ"), density = number_of(o, "rho0"),
               length = number_of(o, "h = V_e/A_max");
  std::vector<CurveResult> all;
  for (const auto& [burn, column] : {std::pair("time", "F_time"), {"compression", "F_volume"}, {"both", "F_both"}}) {
    CurveResult result{column, 0.0, 1e-8, 0};  // the file has eight or nine digits
    for (std::size_t r = 0; r < o.n_rows(); ++r) {
      EosPoint point("jwl",
                     "{" + products(D) + ", " + key_and_number("cj_pressure", p) + ", burn: " + burn +
                         ", detonators: [{point: [0, 0, 0], time: 1e-5}]}",
                     density);
      point.set_state(1, 1e-5);
      const double time = 1e-5 + o.column("time_since_lighting_s")[r];
      point.evaluate(density / o.column("relative_volume")[r], 0.0, true, time, length);
      double wanted = std::min(o.column(column)[r], 1.0);
      if (wanted < 1e-4) wanted = 0.0;  // counts as nothing
      const double error = std::fabs(point.state(0) - wanted);
      if (!(error <= result.error)) result.error = error, result.row = r;
    }
    all.push_back(result);
  }
  return all;
}

/// "points (x,y,z,t_d): [[[..], t], ...]" and "lines (a,b,t_d): [[[..], [..], t], ...]" as detonators.
std::string detonators_of(const Oracle& o) {
  std::string text;
  const auto vector = [](const nlohmann::json& v) {
    char line[96];
    std::snprintf(line, sizeof line, "[%.17g, %.17g, %.17g]", v[0].get<double>(), v[1].get<double>(),
                  v[2].get<double>());
    return std::string(line);
  };
  for (const std::string& line : o.comments) {
    const bool points = line.find("points (") != std::string::npos, lines = line.find("lines (") != std::string::npos;
    if (!points && !lines) continue;
    for (const auto& d : nlohmann::json::parse(line.substr(line.find("): ") + 3)))
      text += std::string(text.empty() ? "" : ", ") + "{point: " + vector(d[0]) +
              (lines ? ", end: " + vector(d[1]) : "") + ", " + key_and_number("time", d[lines ? 2 : 1]) + "}";
  }
  return text;
}

std::vector<CurveResult> lighting_times(const Oracle& o) {
  CurveResult result{"time_s", 0.0, 1e-11, 0};  // of each time; the file has twelve digits
  for (std::size_t r = 0; r < o.n_rows(); ++r) {
    const EosPoint point("jwl", "{" + products(number_of(o, "D")) + ", detonators: [" + detonators_of(o) + "]}", 1630.0,
                         {o.column("x_m")[r], o.column("y_m")[r], o.column("z_m")[r]});
    const double wanted = o.column("time_s")[r], error = std::fabs(point.state(1) / wanted - 1.0);
    if (!(error <= result.error)) result.error = error, result.row = r;
  }
  return {result};
}

const RegisterCurves shares({"jwl", [](const Oracle& o) { return begins(o, "burn_fraction"); }, burnt_shares});
const RegisterCurves lighting({"jwl", [](const Oracle& o) { return begins(o, "lighting_time_") && o.has("z_m"); },
                               lighting_times});

}  // namespace

}  // namespace kerf::test
