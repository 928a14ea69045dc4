// Files about the ceramics of Johnson and Holmquist.
#include "support/curves.hpp"

namespace kerf::test {

namespace {

bool fits(const Oracle& o) { return o.law() == "johnson_holmquist_2"; }

std::vector<CurveResult> check(const Oracle& o) {
  PathCheck c;
  c.laws.density = o.parameter("density");
  c.laws.solid = "johnson_holmquist_2";
  std::string text = o.text({{"shear_modulus", "G"},
                             {"A", "A"},
                             {"B", "B"},
                             {"C", "C"},
                             {"M", "M"},
                             {"N", "N"},
                             {"tensile_strength", "T"},
                             {"hugoniot_elastic_limit", "HEL"},
                             {"hugoniot_elastic_pressure", "PHEL"},
                             {"D1", "D1"},
                             {"D2", "D2"},
                             {"K1", "K1"},
                             {"K2", "K2"},
                             {"K3", "K3"},
                             {"bulking_share", "beta"},
                             {"reference_rate", "reference_rate"}});
  if (o.parameter("SFMAX") < 1e20) text += ", " + o.text({{"most_fractured_strength", "SFMAX"}});
  c.laws.solid_parameters = "{" + text + "}";
  c.names = {{"effective_plastic_strain", "effective_plastic_strain"},
             {"damage", "damage"},
             {"bulking_pressure_Pa", "bulking_pressure"}};
  // The law is integrated to first order. Where damage sets in, 40 steps per row keep the errors below these.
  c.steps = 40 * static_cast<int>(o.n_rows() - 1);
  c.others = 1e-2;
  c.tolerances = {{"pressure_Pa", 2e-3}, {"damage", 2e-2}, {"bulking_pressure_Pa", 1e-2}};
  c.rms = {{"von_mises_Pa", 1e-2}};
  // A row in which damage jumps by more than 0.3 is not resolved.
  for (std::size_t r = 1; o.has("damage") && r < o.n_rows(); ++r)
    if (o.column("damage")[r] - o.column("damage")[r - 1] > 0.3) c.skipped.push_back(r);
  return path_results(o, c);
}

const RegisterCurves registered({"johnson_holmquist_2", fits, check});

}  // namespace

}  // namespace kerf::test
