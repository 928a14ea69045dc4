// The holes that a penetrator leaves in the front and back face of a plate. See doc/theory/measures.md.
#include <algorithm>
#include <cmath>

#include "kerf/bodies/measured_holes.hpp"
#include "kerf/plugin.hpp"

namespace kerf {
namespace {

using namespace bodies;

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
    s.rule("symmetry_normal", "the plane of symmetry must be perpendicular to the face, so the two normals must be",
           [](const HoleDiameter& m) { return perpendicular(m.symmetry_normal, m.normal); });
    s.rule("second_symmetry_normal", "the planes of symmetry must be perpendicular to the face and to one another",
           [](const HoleDiameter& m) {
             return perpendicular(m.second_symmetry_normal, m.normal) &&
                    perpendicular(m.second_symmetry_normal, m.symmetry_normal);
           });
  }

  std::vector<std::string> references() const override { return {part}; }

  MeasuredValues evaluate(const MeasureModel& model, MeasureRanks& ranks) const override {
    const int number = measured_part(model, part, *this);
    const Vec3 n = unit(normal);
    // What hangs on by a node or an edge alone does not hold: the plate is what is connected through faces.
    const Body body = largest_body(model, ranks, number, Link::face);
    const std::string obstacle = body.is_empty ? nothing_left(part) : trouble_with_symmetry(ranks, number);
    if (!obstacle.empty()) return nothing_known(obstacle);

    BodySurface surface = surface_of(model, ranks, body);
    const Extent planes = undeformed_extent(ranks, number, n);
    const double covered = hull_area(items_on_root(ranks, hull_of(ranks.undeformed_nodes(number), n)), n);
    Face entry = undeformed("entry", ranks, number, n, planes.high, planes, covered);
    Face exit = undeformed("exit", ranks, number, -n, -planes.low, planes, covered);
    if (!ranks.is_root()) return {};
    join_images(surface);
    std::vector<bool> on_face(surface.facets.size(), false);
    for (Face* face : {&entry, &exit}) look_at(surface, *face, on_face);
    MeasuredValues values;
    add_opening(values, entry);
    add_opening(values, exit);
    values.push_back(perforated(surface, on_face, entry, exit));
    return values;
  }

  std::string part;
  Vec3 normal{0.0, 0.0, 1.0};
  Vec3 symmetry_normal, second_symmetry_normal, symmetry_point;  // normals are zero where absent

 private:
  /// What has become of one face of the plate.
  struct Face {
    std::string name;  // "entry" or "exit"
    Vec3 outward;
    double height = 0.0, tolerance = 0.0;  // of the undeformed face, along `outward` [m]
    BodySurface undeformed;
    std::string obstacle;  // why nothing at all can be said about it; empty where something can
    FaceRest rest;
    FaceLoss loss;
    Opening opening;  // of the largest hole
    std::string no_opening;  // why there is none; empty where there is one
  };

  static bool perpendicular(Vec3 a, Vec3 b) { return std::fabs(dot(unit(a), unit(b))) <= 1e-3; }

  MeasuredValues nothing_known(const std::string& reason) const {
    MeasuredValues values;
    for (const char* name :
         {"entry_largest", "entry_smallest", "entry_area", "exit_largest", "exit_smallest", "exit_area", "perforated"})
      values.push_back(unknown(name, reason));
    return values;
  }

  /// Why the part cannot be completed by mirror images; empty where it can. A millionth of the part's size is far above
  /// round-off and far below any cell. Collective.
  std::string trouble_with_symmetry(MeasureRanks& ranks, int number) const {
    for (const Vec3 s : {symmetry_normal, second_symmetry_normal}) {
      if (!(norm(s) > 0.0)) continue;
      const double at = dot(symmetry_point, unit(s));
      const auto [low, high] = undeformed_extent(ranks, number, unit(s));
      const double tolerance = 1e-6 * (high - low);
      if (low < at - tolerance && high > at + tolerance)
        return "part " + part +
               " lies on both sides of a plane of symmetry; leave out its normal or look at `symmetry_point`";
      if (low > at + tolerance || high < at - tolerance)
        return "part " + part + " does not reach a plane of symmetry; look at `symmetry_point`";
    }
    return {};
  }

  void join_images(BodySurface& surface) const {
    if (norm(symmetry_normal) > 0.0) join_mirror_image(surface, symmetry_normal, symmetry_point, 0);
    if (norm(second_symmetry_normal) > 0.0) join_mirror_image(surface, second_symmetry_normal, symmetry_point, 1);
  }

  /// The face at `height` before anything happened. A thousandth of the thickness is far below any layer of cells, and
  /// above the error of a normal that is given to four digits. `covered` is the area that the part covers, seen along
  /// the normal [m2]. Collective.
  Face undeformed(const std::string& name, MeasureRanks& ranks, int number, Vec3 outward, double height, Extent planes,
                  double covered) const {
    Face face;
    face.name = name;
    face.outward = outward;
    face.height = height;
    face.tolerance = 1e-3 * (planes.high - planes.low);
    face.undeformed = undeformed_face(ranks, number, outward, height, face.tolerance);
    // Whether the face is as large as the part is, seen from there. A wrong normal meets an edge, a corner or a strip.
    if (!(hull_area(face.undeformed.reference, outward) > 0.9 * covered))
      face.no_opening = face.obstacle =
          "part " + part + " has no flat " + name + " face that is perpendicular to `normal`; look at `normal`";
    return face;
  }

  /// Looks at what is left of a face, and marks its facets.
  void look_at(const BodySurface& surface, Face& face, std::vector<bool>& on_face) const {
    if (!face.obstacle.empty()) return;
    join_images(face.undeformed);
    std::vector<std::int32_t> facets;
    for (std::size_t f = 0; f < surface.facets.size(); ++f) {
      const bool inside = std::all_of(surface.facets[f].begin(), surface.facets[f].end(), [&](std::int32_t v) {
        return std::fabs(dot(surface.reference[static_cast<std::size_t>(v)], face.outward) - face.height) <=
               face.tolerance;
      });
      if (!inside) continue;
      facets.push_back(static_cast<std::int32_t>(f));
      on_face[f] = true;
    }
    face.rest = rest_of_face(surface, facets, face.outward);
    face.loss = loss_of_face(surface, face.rest, face.undeformed, face.outward);
    measure_largest_hole(surface, face);
  }

  /// Of several holes, the one that took most of the face; craters of fragments are smaller. A larger loss that reaches
  /// the outline is what was looked for, and has no closed rim.
  static void measure_largest_hole(const BodySurface& surface, Face& face) {
    const auto largest =
        std::max_element(face.rest.holes.begin(), face.rest.holes.end(),
                         [](const Rim& a, const Rim& b) { return a.reference_area < b.reference_area; });
    const double area = largest == face.rest.holes.end() ? 0.0 : largest->reference_area;
    if (face.loss.largest_at_outline > area) {
      face.no_opening = open_at_outline(face);
    } else if (area == 0.0) {
      face.no_opening = "there is no hole in the " + face.name + " face";
    } else {
      std::vector<Vec3> line;
      for (const std::int32_t v : largest->vertices) line.push_back(surface.position[static_cast<std::size_t>(v)]);
      face.opening = measure_opening(line, face.outward);
      if (std::isnan(face.opening.area)) face.no_opening = "the hole in the " + face.name + " face is closed to a line";
    }
  }

  static std::string open_at_outline(const Face& face) {
    return "what is gone of the " + face.name +
           " face reaches its outline and has no closed rim; give `symmetry_normal` (and `second_symmetry_normal`) if "
           "a part of the plate is modelled";
  }

  static void add_opening(MeasuredValues& values, const Face& face) {
    values.push_back({face.name + "_largest", face.opening.largest, face.no_opening});
    values.push_back({face.name + "_smallest", face.opening.smallest, face.no_opening});
    values.push_back({face.name + "_area", face.opening.area, face.no_opening});
  }

  static MeasuredValue perforated(const BodySurface& surface, const std::vector<bool>& on_face, const Face& entry,
                                  const Face& exit) {
    for (const Face* face : {&entry, &exit})
      if (!face->obstacle.empty()) return unknown("perforated", face->obstacle);
    if (walls_connect(surface, on_face, entry.rest.holes, exit.rest.holes)) return {"perforated", 1.0};
    // Where a face has lost nothing, no way leads through it.
    if (!entry.loss.any || !exit.loss.any) return {"perforated", 0.0};
    for (const Face* face : {&entry, &exit})
      if (face->loss.largest_at_outline > 0.0) return unknown("perforated", open_at_outline(*face));
    return {"perforated", 0.0};
  }
};

}  // namespace
}  // namespace kerf

KERF_REGISTER(KERF_TYPE(kerf::HoleDiameter, "measure", "hole_diameter",
                        "largest and smallest diameter of the entry and exit hole of a plate [m], and whether it is "
                        "perforated; null where that cannot be known"))
