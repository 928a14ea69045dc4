// One part and one law after the other.
#include "review/law_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kerf/law_use.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

class PartUse final : public LawUse {
 public:
  PartUse(const Model& model, const PartModel& used) : model_(model), part_(used) {
    part = used.input->name;
    density = used.material->density;
    end = model.input->time.end;
    grueneisen = used.grueneisen;
    grueneisen_compressed = used.grueneisen_compressed;
    n_elements = used.n_elements;
    double volume = 0.0;
    for (int s = 0; s < used.store->n_slots(); ++s)
      if (used.store->live(s)) volume = std::max(volume, used.store->field(PartStore::mass).at(s, 0) / density);
    volume = greatest_of(volume);
    // The mean, in shares of the greatest: whole numbers, whose sum is the same on any number of ranks.
    std::int64_t shares = 0;
    for (int s = 0; s < used.store->n_slots(); ++s)
      if (used.store->live(s))
        shares += std::llrint(used.store->field(PartStore::mass).at(s, 0) / density / volume * 0x1p20);
    shares = sum_of(model.comm, shares);
    length = kerf::positive_power(
        volume * static_cast<double>(shares) * 0x1p-20 / static_cast<double>(std::max(n_elements, std::int64_t{1})),
        1.0 / 3.0);
  }

  double least(const std::string& variable) override {
    double low = infinity;
    each(variable, [&](double value) { low = std::min(low, value); });
    return -greatest_of(-low);
  }
  double greatest(const std::string& variable, double below) override {
    double high = -infinity;
    each(variable, [&](double value) { high = value < below ? std::max(high, value) : high; });
    return greatest_of(high);
  }
  std::int64_t count_from(const std::string& variable, double limit) override {
    std::int64_t n = 0;
    each(variable, [&](double value) { n += value >= limit ? 1 : 0; });
    return sum_of(model_.comm, n);
  }
  double distance(const std::function<Vec3(Vec3)>& nearest) override {
    double least = infinity;
    for (const PartModel& p : model_.parts) {
      for (int s = 0; p.material == part_.material && s < p.store->n_slots(); ++s) {
        if (!p.store->live(s)) continue;
        const Vec3 x = centre(*p.store, s);
        least = std::min(least, norm(x - nearest(x)));
      }
    }
    return -greatest_of(-least);
  }

 private:
  Vec3 centre(const PartStore& store, int slot) const {
    Vec3 sum;
    for (int k = 0; k < store.n_nodes(); ++k) sum = sum + model_.nodes.x(store.node(slot, k));
    return sum * (1.0 / store.n_nodes());
  }
  double greatest_of(double value) const { return kerf::greatest(model_.comm, value); }
  template <class Work>
  void each(const std::string& variable, const Work& work) const {
    const PartStore& store = *part_.store;
    const auto [field, component] = store.find_variable(variable);
    for (int s = 0; field != PartStore::n_fields && s < store.n_slots(); ++s)
      if (store.live(s)) work(store.field(field).at(s, component));
  }

  const Model& model_;
  const PartModel& part_;
};

}  // namespace

std::vector<std::string> law_warnings(const Model& model) {
  std::vector<std::string> lines;
  for (const PartModel& part : model.parts)
    for (const Law* law : part.material->laws()) {
      const auto* speaker = dynamic_cast<const WarningLaw*>(law);
      if (speaker == nullptr) continue;
      PartUse use(model, part);
      for (const std::string& text : speaker->warnings(use)) {
        std::string line = fmt::format("{}: warning: {}", law->origin, text);
        if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(std::move(line));
      }
    }
  return lines;
}

}  // namespace kerf
