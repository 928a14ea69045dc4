// Files about the reaction of a shocked explosive at constant volume.
#include <algorithm>
#include <cmath>

#include "support/curves.hpp"
#include "support/eos_point.hpp"

namespace kerf::test {

namespace {

bool fits(const Oracle& o) { return o.name.starts_with("ignition_growth_") && o.name.ends_with("_constant_volume"); }

/// Parameters in SI units from the file's, which are of centimetres, microseconds and megabars.
std::string parameters_of(const Oracle& o) {
  constexpr double megabar = 1e11, per_microsecond = 1e6;
  const auto phase = [&](const char* list) {
    const auto& c = o.parameters.at(list);
    return "{" + key_and_number("A", c[0].get<double>() * megabar) + ", " +
           key_and_number("B", c[1].get<double>() * megabar) + ", " + key_and_number("R1", c[2]) + ", " +
           key_and_number("R2", c[3]) + ", " + key_and_number("omega", c[4]) + ", " +
           key_and_number("heat_capacity", c[5].get<double>() * megabar) + "}";
  };
  std::string text = "{unreacted: " + phase("unreacted_A_B_R1_R2_w_Cv") +
                     ", products: " + phase("products_A_B_R1_R2_w_Cv") + ", " +
                     key_and_number("initial_energy", o.parameter("E0_Mbar") * megabar);
  const char* names[] = {"I", "b", "a", "x", "figmax", "G1", "c", "d", "y", "fg1max", "G2", "e", "g", "z", "fg2min"};
  const auto& rates = o.parameters.at("I_b_a_x_FIGMAX_G1_c_d_y_FG1MAX_G2_e_g_z_FG2MIN");
  for (std::size_t k = 0; k < std::size(names); ++k) {
    const std::string name = names[k];
    const bool is_rate = name == "I" || name == "G1" || name == "G2";
    text += ", " + key_and_number(name, rates[k].get<double>() * (is_rate ? per_microsecond : 1.0));
  }
  return text + "}";
}

/// Each block of rows of one particle velocity is a run from the inert shock's volume and energy, which stay.
std::vector<CurveResult> check(const Oracle& o) {
  constexpr int steps = 10;  // between two rows: some 200 for a run
  const double density = o.parameter("rho0_g_cc") * 1000.0;
  const auto &velocity = o.column("particle_velocity_m_s"), &time = o.column("time_s"),
             &share = o.column("burned_fraction"), &V = o.column("relative_volume");
  // Tolerances of section "recommended tolerances".
  CurveResult of_share{"burned_fraction", 0.0, 1e-3, 0}, of_pressure{"pressure_Pa", 0.0, 1e-4, 0},
      of_temperature{"temperature_K", 0.0, 1e-3, 0};
  const auto note = [&](CurveResult& result, double value, std::size_t row) {
    const auto& wanted = o.column(result.column);
    const double error = std::fabs(value - wanted[row]) / *std::max_element(wanted.begin(), wanted.end());
    if (error > result.error || std::isnan(error)) result.error = error, result.row = row;
  };
  std::unique_ptr<EosPoint> point;
  for (std::size_t r = 0; r < o.n_rows(); ++r) {
    const double energy = 0.5 * velocity[r] * velocity[r];
    const bool starts = r == 0 || velocity[r] != velocity[r - 1];
    double pressure = 0.0;
    if (starts) {
      point = std::make_unique<EosPoint>("ignition_and_growth", parameters_of(o), density);
      point->set_state(0, share[r]);
    } else {
      point->set_step((time[r] - time[r - 1]) / steps);
    }
    for (int i = 0; i < (starts ? 1 : steps); ++i) pressure = point->evaluate(density / V[r], energy, true).pressure;
    note(of_share, point->state(0), r);
    note(of_pressure, pressure, r);
    note(of_temperature, point->state(1), r);
  }
  return {of_share, of_pressure, of_temperature};
}

const RegisterCurves registered({"ignition_and_growth", fits, check});

}  // namespace

}  // namespace kerf::test
