// Files about Newtonian fluids.
#include "support/curves.hpp"

namespace kerf::test {

namespace {

bool fits(const Oracle& o) { return o.law() == "newtonian"; }

std::vector<CurveResult> check(const Oracle& o) {
  PathCheck c;
  c.laws.density = o.parameter("density");
  c.laws.strength = "newtonian_fluid";
  c.laws.strength_parameters = "{" + o.text({{"viscosity", "viscosity_Pa_s"}}) + "}";
  // p = (gamma - 1) rho (e + e0) - gamma pinf is a linear polynomial.
  const nlohmann::json& gas = o.parameters.at("eos");
  const double gamma = gas.at("gamma"), start = gas.at("initial_pressure"), stiffness = gas.at("pinf");
  c.laws.eos = "linear_polynomial";
  c.laws.eos_parameters = "{" + key_and_number("C0", start) + ", " + key_and_number("C1", start + gamma * stiffness) +
                          ", " + key_and_number("C4", gamma - 1.0) + ", " + key_and_number("C5", gamma - 1.0) + "}";
  // The rate of the middle of the step stands for that of its end. The energy, which the pressure follows, is the work
  // of the mean of two steps' stresses: second order, but for the first step, before which the file has no stress.
  c.others = 2e-3;
  c.steps = 4000;
  c.skipped = {0};
  // Nor does a rate that jumps within a row, where the path is reversed.
  if (o.path.contains("velocity_times_s")) {
    const auto times = o.path.at("velocity_times_s").get<std::vector<double>>();
    for (std::size_t r = 1; r < o.n_rows(); ++r)
      for (std::size_t i = 1; i + 1 < times.size(); ++i)
        if (times[i] > o.column("time_s")[r - 1] * (1.0 + 1e-9) && times[i] <= o.column("time_s")[r] * (1.0 + 1e-9))
          c.skipped.push_back(r);
  }
  return path_results(o, c);
}

const RegisterCurves registered({"newtonian_fluid", fits, check});

}  // namespace

}  // namespace kerf::test
