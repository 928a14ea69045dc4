// Quantities at a place over time: of the element or the node that is there.
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "kerf/observer.hpp"

namespace kerf {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

class Gauge final : public Observer {
 public:
  static void describe(Schema<Gauge>& s) {
    s.text(&Gauge::part, "part", "part that is measured");
    s.vector(&Gauge::point, "point", "m", any_value, "place in the undeformed, placed model");
    s.choice(&Gauge::at, "at", {"element", "node"}, "what is asked: the element round the point, or the nearest node")
        .by_default("element");
    s.choice(&Gauge::motion, "motion", {"moving", "fixed"},
             "whether the gauge moves with the material, or stays in space and asks what passes by")
        .by_default("moving");
    s.texts(&Gauge::quantities, "quantities",
            "element fields as in output.element_fields, or node fields as in output.node_fields");
    describe_interval(s);
    s.rule("quantities", "a gauge needs at least one quantity", [](const Gauge& g) { return !g.quantities.empty(); });
  }

  std::vector<std::string> references() const override { return {part}; }
  std::vector<std::string> element_fields() const override {
    return of_node() ? std::vector<std::string>{} : quantities;
  }
  std::vector<std::string> node_fields() const override { return of_node() ? quantities : std::vector<std::string>{}; }

  void prepare(ObservedModel& model) override {
    part_ = model.find_part(part);
    for (const std::string& q : quantities) add_columns(model, q);
    const auto [score, element] = look_for_element(model, true);
    if (!(score <= 1.0)) {
      std::ostringstream text;
      text << "the point (" << point.x << ", " << point.y << ", " << point.z << ") m is not in part " << part
           << "; expected a point inside of it";
      throw std::runtime_error(text.str());
    }
    target_ = of_node() ? nearest_node(model, true) : element;
  }

  std::vector<ObservedColumn> columns() const override { return columns_; }

  void sample(ObservedModel& model, std::span<double> row) override {
    if (motion == "fixed") target_ = now_at_point(model);
    const std::vector<double> values = of_node() ? values_of_node(model) : values_of_element(model);
    std::copy(values.begin(), values.end(), row.begin());
    if (!std::isnan(values.front())) return;
    if (n_without_ == 0.0) first_without_ = model.time;
    n_without_ += 1.0;
  }

  ObserverReport report(ObservedModel&) override {
    ObserverReport r;
    r.numbers.push_back({"rows_without_value", n_without_, ""});
    if (n_without_ == 0.0) return r;
    r.numbers.push_back({"first_row_without_value", first_without_, ""});
    std::ostringstream text;
    text << "the gauge `" << label << "` has no value in " << n_without_ << " rows, the first at " << first_without_
         << " s: "
         << (motion == "fixed" ? "no element of part " + part + " was at its point" : "its " + at + " has eroded");
    r.warnings.push_back(text.str());
    return r;
  }

  std::vector<double> state() const override { return {static_cast<double>(target_), n_without_, first_without_}; }
  void restore(std::span<const double> numbers) override {
    target_ = static_cast<std::int64_t>(numbers[0]);
    n_without_ = numbers[1];
    first_without_ = numbers[2];
    seen_ = -1;
  }

 private:
  bool of_node() const { return at == "node"; }

  void add_columns(const ObservedModel& model, const std::string& q) {
    if (columns_.empty()) {
      columns_.push_back({"id", "-", "number of the " + at + "; NaN where there is none"});
      for (const char* axis : {"x", "y", "z"})
        columns_.push_back({std::string("position_") + axis, "m", "where the " + at + " is"});
    }
    for (const ObservedColumn& c : of_node() ? model.columns_of_node_field(q) : model.columns_of_field(q))
      columns_.push_back(c);
  }

  Vec3 place_of(const ObservedModel& model, std::int32_t node, bool undeformed) const {
    return undeformed ? model.reference(node) : model.nodes.x(node);
  }

  /// 0 where the element contains the point. Otherwise the distance of its centre from the point over that of its
  /// farthest corner: up to 1 the point may lie beside a curved surface that the mesh cuts short.
  double score_of(const ObservedModel& model, int i, bool undeformed) const {
    const Shape& shape = *model.parts[static_cast<std::size_t>(part_)].shape;
    Vec3 x[Shape::most_nodes], centre;
    for (int k = 0; k < shape.n_nodes; ++k) {
      x[k] = place_of(model, model.element_node(part_, i, k), undeformed) - point;
      centre = centre + x[k] * (1.0 / shape.n_nodes);
    }
    double radius = 0.0;
    for (int k = 0; k < shape.n_nodes; ++k) radius = std::max(radius, norm(x[k] - centre));
    if (norm(centre) > radius) return norm(centre) / radius;
    bool inside = true;
    for (int f = 0; f < shape.n_faces; ++f) {
      const auto& c = shape.face[static_cast<std::size_t>(f)];
      const Vec3 middle = (x[c[0]] + x[c[1]] + x[c[2]] + x[c[3]]) * 0.25;
      const Vec3 outward = cross(x[c[2]] - x[c[0]], x[c[3]] - x[c[1]]);
      inside = inside && dot(middle, outward) >= -1e-9 * radius * norm(outward);
    }
    return inside ? 0.0 : norm(centre) / radius;
  }

  std::pair<double, std::int64_t> look_for_element(ObservedModel& model, bool undeformed) const {
    double best = std::numeric_limits<double>::infinity();
    std::int64_t id = -1;
    const auto ids = model.elements(part_);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const double score = score_of(model, static_cast<int>(i), undeformed);
      if (score < best || (score == best && ids[i] < id)) {
        best = score;
        id = ids[i];
      }
    }
    return model.nearest(best, id);
  }

  std::int64_t nearest_node(ObservedModel& model, bool undeformed) const {
    double best = std::numeric_limits<double>::infinity();
    std::int64_t id = -1;
    const ObservedNodes& nodes = model.nodes;
    for (int i = 0; i < nodes.n; ++i) {
      if (!model.belongs_to(i, part_) || nodes.owned[i] == 0 || nodes.free[i] != 0) continue;
      const double distance = norm(place_of(model, i, undeformed) - point);
      if (distance < best || (distance == best && nodes.id[i] < id)) {
        best = distance;
        id = nodes.id[i];
      }
    }
    return model.nearest(best, id).second;
  }

  /// What is at the point of a gauge that stays in space, or -1.
  std::int64_t now_at_point(ObservedModel& model) {
    seen_ = -1;
    const auto [score, element] = look_for_element(model, false);
    if (!(score <= 1.0)) return -1;
    return of_node() ? nearest_node(model, false) : element;
  }

  /// Where this rank holds the target: place in the list of elements, or node; -1 where it does not.
  template <class Ids>
  int held(const ObservedModel& model, const Ids& ids, std::size_t n) {
    if (seen_ == model.arrangement()) return held_;
    seen_ = model.arrangement();
    held_ = -1;
    for (std::size_t i = 0; i < n && held_ < 0; ++i)
      if (ids[i] == target_) held_ = static_cast<int>(i);
    return held_;
  }

  std::vector<double> values_of_element(ObservedModel& model) {
    std::vector<double> values;
    const auto ids = model.elements(part_);
    const int i = held(model, ids, ids.size());
    if (i >= 0) {
      const Shape& shape = *model.parts[static_cast<std::size_t>(part_)].shape;
      Vec3 centre;
      for (int k = 0; k < shape.n_nodes; ++k)
        centre = centre + model.nodes.x(model.element_node(part_, i, k)) * (1.0 / shape.n_nodes);
      values = {static_cast<double>(target_), centre.x, centre.y, centre.z};
      for (const std::string& q : quantities)
        for (const double v : model.field_of(part_, i, q)) values.push_back(v);
    }
    values.resize(columns_.size(), nothing);
    return model.from_holder(i >= 0, values);
  }

  std::vector<double> values_of_node(ObservedModel& model) {
    std::vector<double> values;
    const ObservedNodes& nodes = model.nodes;
    const int i = held(model, nodes.id, static_cast<std::size_t>(nodes.n));
    const bool mine = i >= 0 && nodes.owned[i] != 0 && nodes.free[i] == 0;
    if (mine) {
      const Vec3 x = nodes.x(i);
      values = {static_cast<double>(target_), x.x, x.y, x.z};
      for (const std::string& q : quantities)
        for (const double v : model.node_field(i, q)) values.push_back(v);
    }
    values.resize(columns_.size(), nothing);
    return model.from_holder(mine, values);
  }

  std::string part, at, motion;
  Vec3 point;
  std::vector<std::string> quantities;
  int part_ = -1;
  std::vector<ObservedColumn> columns_;
  std::int64_t target_ = -1;  // global id of the element or node
  double n_without_ = 0.0, first_without_ = 0.0;  // rows without a value, and when the first was [s]
  std::int64_t seen_ = -1;  // arrangement of the model for which held_ is right
  int held_ = -1;
};

}  // namespace
}  // namespace kerf

KERF_OBSERVER(kerf::Gauge, "gauge", "fields at a point over time, moving with the material or fixed in space")
