// The holes that a penetrator leaves in the front and back face of a plate. See doc/theory/measures.md.
#include <algorithm>
#include <cmath>

#include "dynamics/measure_geometry.hpp"
#include "kerf/plugin.hpp"

namespace kerf {
namespace {

class HoleDiameter final : public Measure {
 public:
  static void describe(Schema<HoleDiameter>& s) {
    s.text(&HoleDiameter::part, "part", "plate that is measured");
    s.vector(&HoleDiameter::normal, "normal", "-", any_value,
             "outward normal of the face where the penetrator enters; the exit face is opposite")
        .by_default("[0, 0, 1]");
    s.vector(&HoleDiameter::symmetry_normal, "symmetry_normal", "-", any_value,
             "normal of the symmetry plane of a half model, which is completed by its mirror image")
        .optional();
    s.vector(&HoleDiameter::second_symmetry_normal, "second_symmetry_normal", "-", any_value,
             "normal of the other symmetry plane of a quarter model")
        .optional();
    s.vector(&HoleDiameter::symmetry_point, "symmetry_point", "m", any_value, "a point on all symmetry planes")
        .by_default("[0, 0, 0]");
    s.rule("normal", "the normal must not have zero length",
           [](const HoleDiameter& m) { return norm(m.normal) > 0.0; });
  }

  std::vector<std::string> references() const override { return {part}; }

  MeasuredValues evaluate(const MeasureModel& model) const override {
    const int number = measured_part(model, part, *this);
    const Vec3 n = unit(normal);
    const auto [exit_plane, entry_plane] = face_planes(model, number, n);
    // What hangs on by a node or an edge alone does not hold: the plate is what is connected through faces.
    BodySurface surface = surface_of(model, largest_body(model, number, Link::face));
    for (const Vec3 s : {symmetry_normal, second_symmetry_normal})
      if (norm(s) > 0.0) join_mirror_image(surface, s, symmetry_point);

    std::vector<bool> on_face(surface.facets.size(), false);
    const std::vector<Rim> entry = holes_in_face(surface, n, entry_plane, entry_plane - exit_plane, on_face);
    const std::vector<Rim> exit = holes_in_face(surface, -n, -exit_plane, entry_plane - exit_plane, on_face);
    const Opening front = largest_opening(surface, entry, n), back = largest_opening(surface, exit, n);
    const bool perforated = walls_connect(surface, on_face, entry, exit);
    return {{"entry_largest", front.largest},      {"entry_smallest", front.smallest}, {"entry_area", front.area},
            {"exit_largest", back.largest},        {"exit_smallest", back.smallest},   {"exit_area", back.area},
            {"perforated", perforated ? 1.0 : 0.0}};
  }

  std::string part;
  Vec3 normal{0.0, 0.0, 1.0};
  Vec3 symmetry_normal, second_symmetry_normal, symmetry_point;  // normals are zero where absent

 private:
  /// Heights of the undeformed exit and entry face along the normal, from all nodes, eroded or not.
  static std::pair<double, double> face_planes(const MeasureModel& model, int number, Vec3 n) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const MeasureModel::Node& node : model.nodes) {
      if (node.part != number) continue;
      low = min_of(low, dot(node.reference, n));
      high = max_of(high, dot(node.reference, n));
    }
    return {low, high};
  }

  /// Holes in what is left of the face at `height`, and marks its facets. A thousandth of the thickness is far
  /// below any layer of cells, and above the error of a normal that is given to three digits.
  static std::vector<Rim> holes_in_face(const BodySurface& surface, Vec3 outward, double height, double thickness,
                                        std::vector<bool>& on_face) {
    std::vector<std::int32_t> facets;
    for (std::size_t f = 0; f < surface.facets.size(); ++f) {
      bool inside = true;
      for (const std::int32_t v : surface.facets[f])
        inside = inside &&
                 std::fabs(dot(surface.reference[static_cast<std::size_t>(v)], outward) - height) <= 1e-3 * thickness;
      if (!inside) continue;
      facets.push_back(static_cast<std::int32_t>(f));
      on_face[f] = true;
    }
    return find_holes(surface, facets, outward);
  }

  /// Of several holes, the one that took most of the face; craters of fragments are smaller.
  static Opening largest_opening(const BodySurface& surface, const std::vector<Rim>& holes, Vec3 n) {
    if (holes.empty()) return {};
    const auto largest = std::max_element(
        holes.begin(), holes.end(), [](const Rim& a, const Rim& b) { return a.reference_area < b.reference_area; });
    std::vector<Vec3> line;
    for (const std::int32_t v : largest->vertices) line.push_back(surface.position[static_cast<std::size_t>(v)]);
    return measure_opening(line, n);
  }
};

}  // namespace
}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::HoleDiameter, "measure", "hole_diameter",
                        "largest and smallest diameter of the entry and exit hole of a plate [m], and whether it is "
                        "perforated"))
