// Extent of a part along an axis, for bodies that stay whole: the Taylor bar's final length.
#include "kerf/bodies/measured_bodies.hpp"
#include "kerf/plugin.hpp"

namespace kerf {
namespace {

using namespace bodies;

class FinalLength final : public Measure {
 public:
  static void describe(Schema<FinalLength>& s) {
    s.text(&FinalLength::part, "part", "part that is measured");
    s.vector(&FinalLength::axis, "axis", "-", any_value, "direction along which the length is taken");
    s.rule("axis", "the axis must not have zero length", [](const FinalLength& m) { return norm(m.axis) > 0.0; });
  }

  std::vector<std::string> references() const override { return {part}; }

  MeasuredValues evaluate(const MeasureModel& model, MeasureRanks& ranks) const override {
    const int number = measured_part(model, part, *this);
    return {value_of_remnant(extent_along(model, ranks, live_nodes(model, number), unit(axis)), part)};
  }

  std::string part;
  Vec3 axis;
};

}  // namespace
}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::FinalLength, "measure", "final_length",
                        "extent along an axis of all nodes of a part that belong to live elements [m]"))
