// Pressure of the blast of a charge of TNT in air on exterior facets.
//
// Sources: C. N. Kingery & G. Bulmash (1984), Airblast Parameters from TNT Spherical Air Burst and Hemispherical
// Surface Burst, ARBRL-TR-02555 (polynomials); G. Randers-Pehrson & K. A. Bannister (1997), Airblast Loading Model for
// DYNA2D and DYNA3D, ARL-TR-1310 (angle of incidence). What of the polynomials was compared with what stands in
// doc/theory/loads.md.
#include <kerf/load.hpp>

#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <span>
#include <stdexcept>

namespace {

using namespace kerf;

/// log10 Y = sum of c_k u^k with u = offset + slope log10 Z, up to a largest Z [m/kg^(1/3)].
struct Piece {
  double log10_up_to = 0.0;
  double offset = 0.0, slope = 0.0;
  int n = 0;  // of coefficients
  double c[12] = {};

  constexpr Piece(double up_to_z, double u_offset, double u_slope, std::initializer_list<double> coefficients)
      : log10_up_to(kerf::log10(up_to_z)), offset(u_offset), slope(u_slope) {
    for (const double coefficient : coefficients) c[n++] = coefficient;
  }
  /// log10 Y at a logarithm of the scaled distance.
  double at(double log10_z) const {
    const double u = offset + slope * log10_z;
    double sum = c[n - 1];
    for (int k = n - 2; k >= 0; --k) sum = sum * u + c[k];
    return sum;
  }
};

/// The six quantities of one kind of burst; impulses and times are divided by the cube root of the charge mass.
struct Burst {
  double nearest, farthest;  // scaled distances between which all of them are known [m/kg^(1/3)]
  double strongest;  // more than the reflected pressure at the nearest [Pa]
  std::span<const Piece> incident_pressure, reflected_pressure;  // [kPa]
  std::span<const Piece> incident_impulse, reflected_impulse;  // [kPa ms/kg^(1/3)]
  std::span<const Piece> arrival, duration;  // [ms/kg^(1/3)]

  double log10_nearest = kerf::log10(nearest), log10_farthest = kerf::log10(farthest);

  bool holds(double log10_z) const { return log10_z >= log10_nearest && log10_z <= log10_farthest; }
};

// Spherical charges far from any ground.
constexpr Piece free_incident_pressure[] = {
    Piece(40.0, -0.214362789151, 1.35034249993,
          {2.611368669, -1.69012801396, 0.00804973591951, 0.336743114941, -0.00516226351334, -0.0809228619888,
           -0.00478507266747, 0.00793030472242, 0.0007684469735}),
};
constexpr Piece free_reflected_pressure[] = {
    Piece(40.0, -0.214362789151, 1.35034249993,
          {3.22958031387, -2.21400538997, 0.035119031446, 0.657599992109, 0.0141818951887, -0.243076636231,
           -0.0158699803158, 0.0492741184234, 0.00227639644004, -0.00397126276058}),
};
constexpr Piece free_incident_impulse[] = {
    Piece(0.792, 2.34723921354, 3.24299066475,
          {2.38830516757, -0.443749377691, 0.168825414684, 0.0348138030308, -0.010435192824}),
    Piece(40.0, -1.75305660315, 2.30629231803,
          {1.55197227115, -0.40463292088, -0.0142721946082, 0.00912366316617, -0.0006750681404, -0.00800863718901,
           0.00314819515931, 0.00152044783382, -0.0007470265899}),
};
constexpr Piece free_reflected_impulse[] = {
    Piece(40.0, -0.204004553231, 1.37882996018, {2.55875660396, -0.903118886091, 0.101771877942, -0.0242139751146}),
};
constexpr Piece free_arrival[] = {
    Piece(40.0, -0.253273111999, 1.37407043777,
          {0.0720707787637, 1.36456871214, -0.0570035692784, -0.182832224796, 0.0118851436014, 0.0432648687627,
           -0.0007997367834, -0.00436073555033}),
};
constexpr Piece free_duration[] = {
    Piece(0.888, 2.26367268496, 5.11588554305,
          {-0.686608550419, 0.164953518069, 0.127788499497, 0.00291430135946, 0.00187957449227, 0.0173413962543,
           0.00269739758043, -0.00361976502798, -0.00100926577934}),
    Piece(2.28, -1.33361206714, 9.2996288611,
          {0.23031841078, -0.0297944268969, 0.0306329542941, 0.0183405574074, -0.0173964666286, -0.00106321963576,
           0.0056206003128, 0.0001618217499, -0.0006860188944}),
    Piece(40.0, -3.13005805346, 3.1524725364,
          {0.621036276475, 0.0967031995552, -0.00801302059667, 0.00482705779732, 0.00187587272287, -0.00246738509321,
           -0.000841116668, 0.0006193291052}),
};
constexpr Burst free_air = {0.147,
                            40.0,
                            2.4e8,
                            free_incident_pressure,
                            free_reflected_pressure,
                            free_incident_impulse,
                            free_reflected_impulse,
                            free_arrival,
                            free_duration};

// Hemispherical charges on the ground, which reflects their blast.
constexpr Piece surface_incident_pressure[] = {
    Piece(40.0, -0.214362789151, 1.35034249993,
          {2.78076916577, -1.6958988741, -0.154159376846, 0.514060730593, 0.0988534365274, -0.293912623038,
           -0.0268112345019, 0.109097496421, 0.00162846756311, -0.0214631030242, 0.0001456723382, 0.00167847752266}),
};
constexpr Piece surface_reflected_pressure[] = {
    Piece(40.0, -0.240657322658, 1.36637719229,
          {3.40283217581, -2.21030870597, -0.218536586295, 0.895319589372, 0.24989009775, -0.569249436807,
           -0.11791682383, 0.224131161411, 0.0245620259375, -0.0455116002694, -0.00190930738887, 0.00361471193389}),
};
constexpr Piece surface_incident_impulse[] = {
    Piece(0.955, 2.06761908721, 3.0760329666,
          {2.52455620925, -0.502992763686, 0.171335645235, 0.0450176963051, -0.0118964626402}),
    Piece(40.0, -1.94708846747, 2.40697745406,
          {1.67281645863, -0.384519026965, -0.0260816706301, 0.00595798753822, 0.014544526107, -0.00663289334734,
           -0.00284189327204, 0.0013644816227}),
};
constexpr Piece surface_reflected_impulse[] = {
    Piece(40.0, -0.246208804814, 1.33422049854, {2.70588058103, -0.949516092853, 0.112136118689, -0.0250659183287}),
};
constexpr Piece surface_arrival[] = {
    Piece(40.0, -0.202425716178, 1.37784223635,
          {-0.0591634288046, 1.35706496258, 0.052492798645, -0.196563954086, -0.0601770052288, 0.0696360270891,
           0.0215297490092, -0.0161658930785, -0.00232531970294, 0.00147752067524}),
};
constexpr Piece surface_duration[] = {
    Piece(1.01, 1.92946154068, 5.25099193925,
          {-0.614227603559, 0.130143717675, 0.134872511954, 0.0391574276906, -0.00475933664702, -0.00428144598008}),
    Piece(2.78, -2.12492525216, 9.2996288611,
          {0.315409245784, -0.0297944268976, 0.030632954288, 0.0183405574086, -0.0173964666211, -0.00106321963633,
           0.00562060030977, 0.0001618217499, -0.0006860188944}),
    Piece(40.0, -3.53626218091, 3.46349745571,
          {0.686906642409, 0.0933035304009, -0.0005849420883, -0.00226884995013, -0.00295908591505, 0.00148029868929}),
};
constexpr Burst ground_surface = {0.178,
                                  40.0,
                                  2.3e8,
                                  surface_incident_pressure,
                                  surface_reflected_pressure,
                                  surface_incident_impulse,
                                  surface_reflected_impulse,
                                  surface_arrival,
                                  surface_duration};

double log10_of(std::span<const Piece> pieces, double log10_z) {
  std::size_t k = 0;
  while (k + 1 < pieces.size() && log10_z > pieces[k].log10_up_to) ++k;
  return pieces[k].at(log10_z);
}
double power_of_ten(double y) { return kerf::exp(y * 2.302585092994045684); }

/// The coefficient b of (1 - s) exp(-b s), s from 0 to 1, whose integral F(b) = (b - 1 + exp(-b)) / b^2 is `mean`.
/// Pre: 0.03 < mean < 0.56. Newton's method on 1/F, which is convex and nearly straight: 2 + 2b/3 at b = 0, and b + 1
/// for large b. From a start that has both tangents, three steps reach round-off.
double decay_for(double mean) {
  const double wanted = 1.0 / mean, y = wanted - 2.0;
  double b = y * (1.5 + 0.5 * y) / (1.0 + 0.5 * y);
  for (int i = 0; i < 3; ++i) {
    double integral, rest;  // F, and (1/2 - F) / b
    if (std::fabs(b) < 1.0) {
      // Sum of (-b)^k / (k + 3)!; what is left out is below 1e-20.
      double sum = 1.0;
      for (int k = 18; k >= 1; --k) sum = 1.0 - b / (k + 3) * sum;
      rest = sum / 6.0;
      integral = 0.5 - b * rest;
    } else {
      integral = (b + kerf::expm1(-b)) / (b * b);
      rest = (0.5 - integral) / b;
    }
    const double slope = 2.0 * rest - integral;  // dF/db
    b += (1.0 / integral - wanted) * integral * integral / slope;
  }
  return b;
}

/// Friedlander's wave, at the share s of the duration that has passed since the front.
double friedlander(double peak, double impulse, double duration, double s) {
  return peak * (1.0 - s) * kerf::exp(-decay_for(impulse / (peak * duration)) * s);
}

/// p = p_r(t) cos^2 + p_i(t) (1 - cos)^2, on facets that face the charge.
struct AirBlast final : FacetLoad {
  std::vector<std::string> names;
  std::string burst;
  double mass = 0.0;  // [kg]
  Vec3 charge;  // [m]
  double detonation = 0.0;  // [s]
  bool follows = false;

  static void describe(Schema<AirBlast>& s) {
    s.texts(&AirBlast::names, "facets",
            "parts or sets whose exterior facets are pressed; a set has those with all corners in it");
    s.choice(&AirBlast::burst, "burst", {"free_air", "surface"},
             "free_air: a sphere far from any ground; surface: a hemisphere on the ground, which reflects the blast");
    s.real(&AirBlast::mass, "charge_mass", "kg", positive, "mass of the charge, as that of TNT of the same effect");
    s.vector(&AirBlast::charge, "charge_position", "m", any_value, "middle of the charge");
    s.real(&AirBlast::detonation, "detonation_time", "s", any_value,
           "when the charge explodes; negative where the run starts after it")
        .by_default("0 s");
    s.boolean(&AirBlast::follows, "follow_erosion",
              "whether the blast also acts on what the erosion of loaded elements uncovers")
        .by_default("false");
    s.rule("facets", "name at least one part or set", [](const AirBlast& b) { return !b.names.empty(); });
  }

  const Burst& table() const { return burst == "surface" ? ground_surface : free_air; }
  std::vector<std::string> targets() const override { return names; }
  std::optional<double> greatest() const override { return table().strongest; }
  bool follows_erosion() const override { return follows; }
  bool reads_reference_position() const override { return true; }

  std::string objection(const LoadedFacet& f) const override {
    const Ray ray(*this, f);
    // A facet that looks away is not loaded, however far it is; but a charge that near to it lies in the body.
    const bool near = !(ray.distance > table().nearest * power_of_ten(kerf::log10(mass) / 3.0));
    return ray.cosine > 0.0 || near ? out_of_range(ray.distance) : std::string{};
  }
  bool can_reach(const LoadedFacet& f, double end) const override {
    const Ray ray(*this, f);
    if (!(ray.cosine > 0.0)) return false;
    const double log10_root = kerf::log10(mass) / 3.0, log10_z = kerf::log10(ray.distance) - log10_root;
    if (!table().holds(log10_z)) return true;  // which objection() tells
    const double scale = 1e-3 * power_of_ten(log10_root);
    const double arrival = detonation + scale * power_of_ten(log10_of(table().arrival, log10_z));
    const double duration = scale * power_of_ten(log10_of(table().duration, log10_z));
    return arrival + duration > 0.0 && arrival < end;
  }

  FacetForce force(const LoadedFacet& f, double time) const override {
    const Ray ray(*this, f);
    // Negated, so that it holds for a facet without area, whose normal is no direction.
    if (!(ray.cosine > 0.0) || !(time > detonation)) return {};
    const double log10_root = kerf::log10(mass) / 3.0, log10_z = kerf::log10(ray.distance) - log10_root;
    const Burst& of = table();
    if (!of.holds(log10_z)) throw std::runtime_error("a facet has " + out_of_range(ray.distance));
    // Most of a run lies before or after the pulse, and is told so by logarithms. Times in [ms/kg^(1/3)].
    const double log10_time = kerf::log10(1e3 * (time - detonation)) - log10_root;
    const double log10_arrival = log10_of(of.arrival, log10_z);
    if (log10_time < log10_arrival) return {};
    const double log10_duration = log10_of(of.duration, log10_z);
    if (log10_time > 0.31 + max_of(log10_arrival, log10_duration)) return {};  // beyond twice the greater
    const double arrival = power_of_ten(log10_arrival), duration = power_of_ten(log10_duration);
    const double s = max_of(0.0, (power_of_ten(log10_time) - arrival) / duration);
    if (s >= 1.0) return {};
    const auto wave = [&](std::span<const Piece> pressure, std::span<const Piece> impulse) {
      return friedlander(power_of_ten(log10_of(pressure, log10_z)), power_of_ten(log10_of(impulse, log10_z)), duration,
                         s);
    };
    const double reflected = wave(of.reflected_pressure, of.reflected_impulse);
    const double incident = wave(of.incident_pressure, of.incident_impulse);
    const double c = ray.cosine;
    return {1e3 * (reflected * c * c + incident * (1.0 - c) * (1.0 - c)), Vec3{}};
  }

 private:
  /// From the charge to where a facet lay in the undeformed model.
  struct Ray {
    double distance;  // [m]
    double cosine;  // of the angle of incidence; negative where the facet looks away

    Ray(const AirBlast& blast, const LoadedFacet& f) {
      const Vec3 d = f.reference_position - blast.charge;
      distance = norm(d);
      cosine = distance > 0.0 ? -dot(d, f.normal) / distance : 1.0;
    }
  };

  /// What is wrong with a distance; empty where nothing is.
  std::string out_of_range(double distance) const {
    const double z = distance > 0.0 ? distance / power_of_ten(kerf::log10(mass) / 3.0) : 0.0;
    const Burst& of = table();
    if (z > 0.0 && of.holds(kerf::log10(distance) - kerf::log10(mass) / 3.0)) return {};
    char text[160];
    std::snprintf(text, sizeof text, "a scaled distance of %.3g m/kg^(1/3), outside of the table's %g to %g m/kg^(1/3)",
                  z, of.nearest, of.farthest);
    return text;
  }
};

}  // namespace

KERF_LOAD(AirBlast, "air_blast", "presses on facets as the blast of a charge of TNT in air (Kingery and Bulmash)")
