// How explosives burn: burnt share, energy released and the place of the front over time.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "kerf/observer.hpp"

namespace kerf {
namespace {

constexpr double not_yet = -1.0;  // a time that has not come

class Burn final : public Observer {
 public:
  static void describe(Schema<Burn>& s) {
    s.texts(&Burn::names, "parts", "explosive parts that are followed; all where absent").optional();
    describe_interval(s);
  }

  std::vector<std::string> references() const override { return names; }
  std::vector<std::string> element_fields() const override { return {"burn_fraction"}; }

  void prepare(ObservedModel& model) override {
    const bool all = names.empty();
    for (std::size_t p = 0; p < model.parts.size(); ++p) {
      // By what its laws keep, not by its elements: a resumed run may find none.
      const std::vector<std::string>& kept = model.parts[p].state_variables;
      const bool burns = std::find(kept.begin(), kept.end(), "burn_fraction") != kept.end();
      const std::string& name = model.parts[p].name;
      if (all && burns) names.push_back(name);
      for (const std::string& wanted : names)
        if (wanted == name && !burns)
          throw std::runtime_error("part " + name +
                                   " does not burn; expected parts whose material has an explosive as "
                                   "its equation of state");
    }
    if (times_.empty()) times_.assign(n_times * names.size(), not_yet);
  }

  std::vector<ObservedColumn> columns() const override {
    std::vector<ObservedColumn> all;
    for (const std::string& name : names) {
      all.push_back({name + ".burnt", "-", "burnt share of the mass of live elements"});
      all.push_back({name + ".released", "J", "chemical energy that live elements have released"});
      all.push_back(
          {name + ".lit", "-",
           "share of the mass that the detonation should have reached by its lighting times; NaN where the law "
           "has none"});
    }
    return all;
  }

  void sample(ObservedModel& model, std::span<double> row) override {
    constexpr double begun = 1e-3, half = 0.5, done = 0.999;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const int part = model.find_part(names[k]);
      const std::vector<double> mass = model.field(part, "mass"), share = model.field(part, "burn_fraction"),
                                lighting = model.field(part, "lighting_time");
      std::vector<double> burnt(mass.size()), lit(mass.size());
      for (std::size_t i = 0; i < mass.size(); ++i) {
        burnt[i] = mass[i] * share[i];
        lit[i] = std::isnan(lighting[i]) ? lighting[i] : lighting[i] <= model.time ? mass[i] : 0.0;
      }
      const std::vector<double> s = model.sums({mass, burnt, lit});
      const double all = s[0] > 0.0 ? s[0] : std::numeric_limits<double>::quiet_NaN();
      row[3 * k] = s[1] / all;
      row[3 * k + 1] = s[1] * model.parts[static_cast<std::size_t>(part)].energy;
      row[3 * k + 2] = s[2] / all;
      double* time = &times_[n_times * k];
      for (const double limit : {begun, half, done}) {
        if (*time == not_yet && row[3 * k] >= limit) *time = model.time;
        ++time;
      }
    }
  }

  ObserverReport report(ObservedModel&) override {
    ObserverReport r;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const double* time = &times_[n_times * k];
      for (const char* what : {".begins_to_burn", ".half_burnt", ".burnt"}) {
        const bool came = *time != not_yet;
        r.numbers.push_back({names[k] + what, came ? *time : std::numeric_limits<double>::quiet_NaN(),
                             came ? "" : "it has not come to that"});
        ++time;
      }
    }
    return r;
  }

  std::vector<double> state() const override { return times_; }
  void restore(std::span<const double> values) override { times_.assign(values.begin(), values.end()); }

 private:
  static constexpr std::size_t n_times = 3;

  std::vector<std::string> names;
  std::vector<double> times_;  // of each part: when a thousandth, half, and all but a thousandth were burnt [s]
};

}  // namespace
}  // namespace kerf

KERF_OBSERVER(kerf::Burn, "burn", "burnt share and energy released of explosives over time")
