// Force and moment that a body hands on across a plane.
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "kerf/observer.hpp"

namespace kerf {
namespace {

class SectionForce final : public Observer {
 public:
  static void describe(Schema<SectionForce>& s) {
    s.text(&SectionForce::part, "part", "part that is cut");
    s.vector(&SectionForce::point, "point", "m", any_value,
             "point of the plane in the undeformed, placed model; moments are about this place");
    s.vector(&SectionForce::normal, "normal", "-", any_value, "normal of the plane, towards what lies ahead");
    describe_interval(s);
    s.rule("normal", "the normal must not have zero length",
           [](const SectionForce& f) { return norm(f.normal) > 0.0; });
  }

  std::vector<std::string> references() const override { return {part}; }

  void prepare(ObservedModel& model) override {
    part_ = model.find_part(part);
    refuse_joined_part(model);
    look_behind(model);
    double sides[2] = {0.0, 0.0};  // nodes ahead and behind
    for (int i = 0; i < model.nodes.n; ++i)
      if (model.nodes.part[i] == part_) sides[behind_[static_cast<std::size_t>(i)]] += 1.0;
    const std::vector<double> both = model.greatest({sides[0], sides[1]});
    if (!(both[0] > 0.0) || !(both[1] > 0.0))
      throw std::runtime_error("the plane does not cut part " + part + ": all of its nodes lie on one side");
  }

  std::vector<ObservedColumn> columns() const override {
    std::vector<ObservedColumn> all;
    for (const char* axis : {"x", "y", "z"})
      all.push_back({std::string("force_") + axis, "N", "of what lies ahead of the plane on what lies behind"});
    all.push_back({"normal_force", "N", "its component along the normal; positive in tension"});
    for (const char* axis : {"x", "y", "z"})
      all.push_back({std::string("moment_") + axis, "N m", "the same, about the point of the plane"});
    return all;
  }

  void sample(ObservedModel& model, std::span<double> row) override {
    look_behind(model);
    const std::span<const Vec3> contact = model.contact_force(), loads = model.load_force();
    std::vector<double> force[3], moment[3];
    for (int i = 0; i < model.nodes.n; ++i) {
      if (model.nodes.owned[i] == 0 || behind_[static_cast<std::size_t>(i)] == 0 || model.nodes.part[i] != part_)
        continue;
      // What is left is the force of elements.
      const auto place = static_cast<std::size_t>(i);
      const Vec3 f = model.nodes.force(i) - contact[place] - loads[place];
      const Vec3 m = cross(model.nodes.x(i) - point, f);
      for (int d = 0; d < 3; ++d) {
        force[d].push_back(f[d]);
        moment[d].push_back(m[d]);
      }
    }
    const std::vector<double> s = model.sums({force[0], force[1], force[2], moment[0], moment[1], moment[2]});
    for (std::size_t d = 0; d < 3; ++d) {
      row[d] = s[d];
      row[4 + d] = s[3 + d];
    }
    row[3] = dot({s[0], s[1], s[2]}, normal) * (1.0 / norm(normal));
  }

 private:
  /// The force of a node that parts share holds that of the elements of all of them.
  void refuse_joined_part(const ObservedModel& model) const {
    const ObservedPart& own = model.parts[static_cast<std::size_t>(part_)];
    for (const ObservedPart& other : model.parts)
      if (&other != &own && other.body == own.body)
        throw std::runtime_error("part " + part + " is joined with part " + other.name +
                                 ", and the force on nodes that they share cannot be told apart; expected a part that "
                                 "is joined with no other");
  }
  /// Marks the nodes of this rank that lay behind the plane in the undeformed model, unless that is known.
  void look_behind(const ObservedModel& model) {
    if (seen_ == model.arrangement()) return;
    seen_ = model.arrangement();
    behind_.assign(static_cast<std::size_t>(model.nodes.n), 0);
    for (int i = 0; i < model.nodes.n; ++i)
      if (model.nodes.part[i] == part_ && dot(normal, model.reference(i) - point) < 0.0)
        behind_[static_cast<std::size_t>(i)] = 1;
  }

  std::string part;
  Vec3 point, normal;
  int part_ = -1;
  std::vector<std::uint8_t> behind_;  // per node of this rank
  std::int64_t seen_ = -1;  // arrangement of the model for which behind_ is right
};

}  // namespace
}  // namespace kerf

KERF_OBSERVER(kerf::SectionForce, "section_force", "force and moment that a part hands on across a plane")
