// What criteria share that add up damage with the plastic strain: the sum, its dependence on the size of the element,
// its average over a neighbourhood, and the softening of the stress before the element fails.
//
// Sources: F. Neukamm, M. Feucht & A. Haufe, "Considering damage history in crashworthiness simulations" (2008) for the
// exponent of softening and the factor over the element's length; A. Hillerborg, M. Modeer & P.-E. Petersson, Cem.
// Concr. Res. 6 (1976) 773-781 for the fracture energy; G. Pijaudier-Cabot & Z.P. Bazant, J. Eng. Mech. 113 (1987)
// 1512-1533 for the non-local average.
#pragma once

#include <kerf/erosion.hpp>
#include <kerf/law_use.hpp>

#include <string>
#include <vector>

namespace kerf {

/// What such a criterion keeps. A law's State derives from it, and so begins with it.
struct DamageState {
  double amount;  // what is added up, in the criterion's unit
  double last_plastic_strain;  // that has been seen; negative before the first step
  double increment;  // of the step, where the engine averages it; else 0
  double onset_strain, onset_stress;  // where the amount reached its limit; the former negative before that [-], [Pa]
  double pace;  // amount per plastic strain at the end of the last step
};
/// What it reads. A law's Reads derive from it, and so begin with it.
struct DamageReads {
  double effective_plastic_strain;
};
/// Base of a law that has `State` and `Reads` as above, and
///   double pace(const Point&, const Reads&, double rate) const   amount per plastic strain, at the end of a step with
///                                                                that plastic strain rate [1/s]
///   double amount_at_failure() const                             greater than zero
///   static describe(Schema<LawType>&), which calls describe_damage
/// A law whose amount does not grow in proportion to the plastic strain hides `growth`.
template <class LawType>
class AccumulatedDamage : public PointwiseErosion<LawType>, public WarningLaw {
 public:
  static constexpr bool can_soften = true;
  static constexpr unsigned inputs = with_initial_length;
  using Point = ErosionInputWith<inputs>;

  std::string softening = "none", nonlocal_weight = "plateau";
  double critical_damage = -1.0, softening_exponent = -1.0;  // [-]; negative where not given
  double fracture_energy = 0.0;  // [J/m2]
  double softening_at_deletion = -1.0;  // [-]; negative where not given
  std::vector<double> element_lengths, length_factors;  // [m], [-]
  double nonlocal_radius = 0.0;  // [m]
  std::vector<double> nonlocal_exponents;  // p and q of the plateau; empty where not given

  bool softens() const override { return softening != "none"; }
  NonLocalAverage nonlocal() const override {
    NonLocalAverage average;
    average.radius = nonlocal_radius;
    average.bell = nonlocal_weight == "bell";
    if (!nonlocal_exponents.empty()) {
      average.p = nonlocal_exponents[0];
      average.q = nonlocal_exponents[1];
    }
    average.increment = 2;
    average.sum = 0;
    return average;
  }

  std::vector<std::string> warnings(LawUse& use) const override {
    if (!(nonlocal_radius > 0.0)) return {};
    const double sphere = 4.0 / 3.0 * 3.14159265358979324 * nonlocal_radius * nonlocal_radius * nonlocal_radius;
    const double volume = static_cast<double>(use.n_elements) * use.length * use.length * use.length;
    if (nonlocal_radius < use.length)
      return {
          "nonlocal_radius is less than the length of an element of part " + use.part +
          ", which has no neighbour so near: each element is its own average; use a radius of two elements or more"};
    if (sphere > volume)
      return {"the sphere of nonlocal_radius is larger than part " + use.part +
              ": the average is over nearly all of the part, and nothing localises; use a smaller radius"};
    return {};
  }

  enum class Softening { none, stress, linear, exponential };
  /// What a loop over points knows before it begins. Where the size of the element counts as well, it does not
  /// vectorise, and one form is enough.
  template <Softening kind, bool has_lengths>
  struct Form {
    static constexpr bool is_scaled = has_lengths;
    static constexpr Softening softening(const AccumulatedDamage& law) { return has_lengths ? law.kind() : kind; }
  };
  template <class Work>
  void with_form(const Work& work) const {
    if (!length_factors.empty()) return work(Form<Softening::none, true>{});
    switch (kind()) {
      case Softening::none:
        return work(Form<Softening::none, false>{});
      case Softening::stress:
        return work(Form<Softening::stress, false>{});
      case Softening::linear:
        return work(Form<Softening::linear, false>{});
      default:
        return work(Form<Softening::exponential, false>{});
    }
  }

  template <class Form, class Reads, class State>
  [[gnu::always_inline]] Verdict judge_point(const Point& in, const Reads& reads, State& state) const {
    const auto& law = static_cast<const LawType&>(*this);
    const double strain = reads.effective_plastic_strain, limit = law.amount_at_failure();
    // What plastic strain there is before the first step has done no damage.
    const bool has_seen = state.last_plastic_strain >= 0.0;
    const double d = select(has_seen, max_of(strain - state.last_plastic_strain, 0.0), 0.0);
    // By the rule of the trapezium: the state of stress may change much within a step.
    const double pace = law.pace(in, reads, d / (in.dt + tiny<double>));
    const double mean = 0.5 * (pace + select(has_seen, state.pace, pace));
    double way = mean * d;
    if constexpr (Form::is_scaled) way /= length_factor(in.initial_length);
    const double growth = law.growth(in, way, state);
    state.pace = pace;
    const bool is_local = !(nonlocal_radius > 0.0);
    const double reached = state.amount + select(is_local, growth, 0.0);
    state.increment = select(is_local, 0.0, growth);
    state.amount = min_of(reached, limit);
    state.last_plastic_strain = strain;
    const double damage = state.amount / limit;
    const Softening softens_how = Form::softening(*this);
    if (softens_how == Softening::linear || softens_how == Softening::exponential) {
      const double past = clamp_to((reached - limit) / (growth + tiny<double>), 0.0, 1.0);
      const double opening = opening_of(in, strain, past * d, reached >= limit, state);
      const double lost = softens_how == Softening::linear ? min_of(0.5 * opening, 1.0) : 1.0 - kerf::exp(-opening);
      return {lost, select(lost >= most_lost(), 1.0, 0.0), 1.0 - lost, 1.0 - lost};
    }
    double kept = 1.0;
    if (softens_how == Softening::stress) kept = kept_share(damage, law.softening_begins(state));
    return {state.amount, select(damage >= 1.0, 1.0, 0.0), kept, kept};
  }

  /// Increment of the amount, from that of an amount in proportion to the plastic strain.
  double growth(const Point&, double way, DamageState&) const { return way; }
  /// The damage at which softening begins; 1 or more: not yet.
  double softening_begins(const DamageState&) const { return max_of(critical_damage, 0.0); }

  /// Mean stress over equivalent stress, positive in tension.
  [[gnu::always_inline]] static double triaxiality(const ErosionInputPoint& in) {
    const double q = von_mises(deviator(in.stress));
    return clamp_to(-in.pressure / (q + tiny<double>), -most_triaxiality, most_triaxiality);
  }

 protected:
  /// Declares the keys and the state. `amount` names what is added up, `prefix` begins the names of the rest.
  template <class S>
  static void describe_damage(S& s, const std::string& amount, const std::string& unit, const std::string& doc,
                              const std::string& prefix) {
    describe_softening(s);
    describe_size(s);
    LawType::describe_interval(s);
    s.state(&DamageState::amount, amount, unit, 0.0, doc).within(non_negative);
    s.state(&DamageState::last_plastic_strain, prefix + "_last_plastic_strain", "-", -1.0,
            "equivalent plastic strain that the criterion has seen; negative before the first step");
    s.state(&DamageState::increment, prefix + "_increment", unit, 0.0,
            "what the last step has added here, where the average over a neighbourhood counts");
    s.state(&DamageState::onset_strain, prefix + "_onset_strain", "-", -1.0,
            "plastic strain at which softening by a fracture energy began; negative before that");
    s.state(&DamageState::onset_stress, prefix + "_onset_stress", "Pa", 0.0,
            "equivalent stress at which softening by a fracture energy began");
    s.state(&DamageState::pace, prefix + "_pace", unit, 0.0,
            "what is added per plastic strain, as at the end of the last step");
    s.reads(&DamageReads::effective_plastic_strain, "effective_plastic_strain",
            "equivalent plastic strain of the material");
  }

 private:
  static constexpr double most_triaxiality = 100.0;  // exponentials stay finite

  Softening kind() const {
    return softening == "none"     ? Softening::none
           : softening == "stress" ? Softening::stress
           : softening == "linear" ? Softening::linear
                                   : Softening::exponential;
  }
  double most_lost() const { return softening_at_deletion > 0.0 ? softening_at_deletion : 0.99; }

  template <class S>
  static void describe_softening(S& s) {
    using Law = LawType;
    s.choice(&Law::softening, "softening", {"none", "stress", "linear", "exponential"},
             "whether the deviator and tensile pressures are weakened before the element fails: not, over damage, or "
             "over plastic displacement such that a crack takes the fracture energy")
        .by_default("none");
    s.real(&Law::critical_damage, "critical_damage", "-", Range{0.0, 1.0, false, true},
           "damage at which softening over damage begins; 0 where absent")
        .optional();
    s.real(&Law::softening_exponent, "softening_exponent", "-", Range{0.0, 20.0, true, false},
           "exponent of softening over damage; 1 where absent")
        .optional();
    s.real(&Law::fracture_energy, "fracture_energy", "J/m2", positive,
           "energy that the softening of an element takes, over its face; for linear and exponential softening")
        .optional();
    s.real(&Law::softening_at_deletion, "softening_at_deletion", "-", Range{0.0, 1.0, true, false},
           "share of the stress that is lost where linear or exponential softening ends and the element fails; 0.99 "
           "where absent")
        .optional();
    s.rule("critical_damage", "critical_damage acts with `softening: stress` only",
           [](const Law& l) { return l.softening == "stress" || l.critical_damage < 0.0; });
    s.rule("softening_exponent", "softening_exponent acts with `softening: stress` only",
           [](const Law& l) { return l.softening == "stress" || l.softening_exponent < 0.0; });
    s.rule("fracture_energy", "fracture_energy and `softening: linear` or `exponential` go together", [](const Law& l) {
      return (l.softening == "linear" || l.softening == "exponential") == (l.fracture_energy > 0.0);
    });
    s.rule("softening_at_deletion", "softening_at_deletion acts with `softening: linear` or `exponential` only",
           [](const Law& l) { return l.fracture_energy > 0.0 || l.softening_at_deletion < 0.0; });
    s.rule("softening_at_deletion", "exponential softening never takes all; expected less than 1",
           [](const Law& l) { return l.softening != "exponential" || l.softening_at_deletion < 1.0; });
  }
  template <class S>
  static void describe_size(S& s) {
    using Law = LawType;
    s.reals(&Law::element_lengths, "element_lengths", "m", positive,
            "initial lengths of elements, ascending, at which length_factors are given")
        .optional();
    s.reals(&Law::length_factors, "length_factors", "-", positive,
            "factors of the failure strain at these lengths, linear between them and constant outside")
        .optional();
    s.real(&Law::nonlocal_radius, "nonlocal_radius", "m", positive,
           "radius within which the increments of all elements of the part are averaged; none where absent")
        .optional();
    s.choice(&Law::nonlocal_weight, "nonlocal_weight", {"plateau", "bell"},
             "weight over the distance r: 1/(1 + (r/L)^p)^q, or (1 - r^2/L^2)^2")
        .by_default("plateau");
    s.reals(&Law::nonlocal_exponents, "nonlocal_exponents", "-", positive,
            "p and q of the plateau; 8 and 2 where absent")
        .optional();
    s.rule("nonlocal_exponents", "nonlocal_exponents are two, and act with nonlocal_radius and the plateau only",
           [](const Law& l) {
             return l.nonlocal_exponents.empty() ||
                    (l.nonlocal_exponents.size() == 2 && l.nonlocal_radius > 0.0 && l.nonlocal_weight == "plateau");
           });
    s.rule("length_factors", "element_lengths and length_factors must be of equal number",
           [](const Law& l) { return l.element_lengths.size() == l.length_factors.size(); });
    s.rule("element_lengths", "element_lengths must ascend strictly", [](const Law& l) {
      for (std::size_t i = 1; i < l.element_lengths.size(); ++i)
        if (!(l.element_lengths[i - 1] < l.element_lengths[i])) return false;
      return true;
    });
    s.rule("nonlocal_weight", "nonlocal_weight acts with nonlocal_radius only",
           [](const Law& l) { return l.nonlocal_radius > 0.0 || l.nonlocal_weight == "plateau"; });
  }

  [[gnu::always_inline]] double length_factor(double length) const {
    if (length_factors.empty()) return 1.0;
    double factor = length_factors.front();
    for (std::size_t i = 1; i < element_lengths.size(); ++i) {
      const double share =
          clamp_to((length - element_lengths[i - 1]) / (element_lengths[i] - element_lengths[i - 1]), 0.0, 1.0);
      factor += share * (length_factors[i] - length_factors[i - 1]);
    }
    return factor;
  }

  [[gnu::always_inline]] double kept_share(double damage, double from) const {
    const double exponent = softening_exponent > 0.0 ? softening_exponent : 1.0;
    const double beyond = max_of(damage - from, 0.0) / (max_of(1.0 - from, 0.0) + tiny<double>);
    const bool any = beyond > 1e-60;
    return 1.0 - select(any, positive_power(select(any, min_of(beyond, 1.0), 1.0), exponent), 0.0);
  }

  /// s0 u / Gf with the plastic displacement u = L (ep - ep0) since the onset and the stress s0 there. The lost share d
  /// is half of it (linear), or d = 1 - exp(-s0 u / Gf). Both take the energy Gf per area. `past` is the plastic strain
  /// of this step after the onset.
  [[gnu::always_inline]] double opening_of(const Point& in, double strain, double past, bool reached,
                                           DamageState& state) const {
    const bool starts = reached && state.onset_strain < 0.0;
    state.onset_strain = select(starts, strain - past, state.onset_strain);
    state.onset_stress = select(starts, von_mises(deviator(in.stress)), state.onset_stress);
    const bool began = state.onset_strain >= 0.0;
    const double displacement = in.initial_length * max_of(strain - state.onset_strain, 0.0);
    return select(began, state.onset_stress * displacement / fracture_energy, 0.0);
  }
};

}  // namespace kerf
