// Measures on bodies made by hand: plates with holes of known size, rods with fragments, a bar with a mushroom.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>

#include "kerf/measure.hpp"
#include "plugin/registry.hpp"
#include "support/lone_rank.hpp"

namespace {

using namespace kerf;
using test::HandMade;
using test::LoneRank;

/// A measure made through its registration, as from an input file.
class Maker {
 public:
  explicit Maker(const std::string& name) {
    register_builtin_plugins(registry_);
    made_ = registry_.make("measure", name);
    made_.plugin->label = name;
  }
  Maker& text(const std::string& key, const std::string& value) {
    parameter(key).set_text(made_.parameters, value);
    return *this;
  }
  Maker& real(const std::string& key, double value) {
    parameter(key).set_real(made_.parameters, value);
    return *this;
  }
  Maker& vector(const std::string& key, Vec3 v) {
    parameter(key).set_reals(made_.parameters, {v.x, v.y, v.z});
    return *this;
  }
  std::map<std::string, double> evaluate(const HandMade& model) const {
    std::map<std::string, double> values;
    for (const MeasuredValue& v : measured(model)) values[v.name] = v.value;
    return values;
  }
  /// Why a value is not known; empty where it is known. Fails where a value and a reason do not fit together.
  std::string reason(const HandMade& model, const std::string& name = "") const {
    std::string found = "there is no value of that name";
    for (const MeasuredValue& v : measured(model)) {
      EXPECT_EQ(std::isnan(v.value), !v.reason.empty()) << v.name << ": " << v.reason;
      if (v.name == name) found = v.reason;
    }
    return found;
  }

 private:
  MeasuredValues measured(const HandMade& model) const {
    LoneRank ranks(model);
    return dynamic_cast<const Measure&>(*made_.plugin).evaluate(model, ranks);
  }
  const Parameter& parameter(const std::string& key) const {
    for (const Parameter& p : made_.plugin->description->parameters)
      if (p.name == key) return p;
    throw std::runtime_error("no parameter " + key);
  }
  Registry registry_;
  Made made_;
};

struct Grid {
  int nx, ny, nz;
  double cell;  // [m]
  Vec3 origin;
};

using Predicate = std::function<bool(Vec3)>;  // of the centre of an undeformed cell
using Motion = std::function<Vec3(Vec3)>;

/// Adds a part made of cubes of density 1000 kg/m3; cells for which `dead` holds are eroded.
void add_block(
    HandMade& model, const std::string& name, const Grid& g, const Predicate& dead,
    const Motion& place = [](Vec3 x) { return x; }, Vec3 velocity = {}) {
  const int part = static_cast<int>(model.parts.size());
  const auto base = static_cast<std::int32_t>(model.nodes.size());
  const double mass = 1000.0 * g.cell * g.cell * g.cell;
  model.parts.push_back(name);
  model.initial_mass.push_back(mass * g.nx * g.ny * g.nz);
  for (int k = 0; k <= g.nz; ++k)
    for (int j = 0; j <= g.ny; ++j)
      for (int i = 0; i <= g.nx; ++i) {
        MeasureModel::Node n;
        n.id = static_cast<std::int64_t>(model.nodes.size());
        n.part = part;
        n.free = true;
        n.reference = g.origin + g.cell * Vec3{double(i), double(j), double(k)};
        n.position = place(n.reference);
        n.velocity = velocity;
        model.nodes.push_back(n);
      }
  const auto node = [&](int i, int j, int k) { return base + (k * (g.ny + 1) + j) * (g.nx + 1) + i; };
  for (int k = 0; k < g.nz; ++k)
    for (int j = 0; j < g.ny; ++j)
      for (int i = 0; i < g.nx; ++i) {
        MeasureModel::Element e;
        e.id = static_cast<std::int64_t>(model.elements.size() + model.eroded.size());
        e.part = part;
        e.mass = mass;
        e.nodes = {node(i, j, k),     node(i + 1, j, k),     node(i + 1, j + 1, k),     node(i, j + 1, k),
                   node(i, j, k + 1), node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)};
        const bool alive = !dead(g.origin + g.cell * Vec3{i + 0.5, j + 0.5, k + 0.5});
        for (const std::int32_t n : e.nodes) {
          model.nodes[static_cast<std::size_t>(n)].mass += mass / 8.0;
          if (alive) model.nodes[static_cast<std::size_t>(n)].free = false;
        }
        if (alive) {
          model.elements.push_back(e);
        } else {
          e.mass = 0.0;
          model.eroded.push_back(e);
        }
      }
}

bool in_ellipse(Vec3 x, double a, double b) { return x.x * x.x / (a * a) + x.y * x.y / (b * b) < 1.0; }

constexpr double cell = 0.5e-3;
// A rim of whole cells oversteps a circle by up to half a face's diagonal on either side.
constexpr double diagonal = 1.4143 * cell;
const Grid plate{80, 60, 8, cell, {-20e-3, -15e-3, -4e-3}};
const Grid half_plate{80, 30, 8, cell, {-20e-3, 0.0, -4e-3}};
const Grid quarter_plate{40, 30, 8, cell, {0.0, 0.0, -4e-3}};

/// Elliptical, 16 by 10 mm where the projectile enters (top), 22 by 14 mm where it leaves.
bool in_hole(Vec3 x) { return x.z > -2e-3 ? in_ellipse(x, 8e-3, 5e-3) : in_ellipse(x, 11e-3, 7e-3); }

void expect_hole(const std::map<std::string, double>& m) {
  EXPECT_NEAR(m.at("entry_largest"), 16e-3, cell);
  EXPECT_NEAR(m.at("entry_smallest"), 10e-3, cell);
  EXPECT_NEAR(m.at("exit_largest"), 22e-3, cell);
  EXPECT_NEAR(m.at("exit_smallest"), 14e-3, cell);
  EXPECT_NEAR(m.at("entry_area"), M_PI * 8e-3 * 5e-3, 0.03 * M_PI * 8e-3 * 5e-3);
  EXPECT_EQ(m.at("perforated"), 1.0);
}

Maker hole() { return std::move(Maker("hole_diameter").text("part", "plate")); }

TEST(HoleDiameter, measures_an_elliptical_hole_within_one_cell) {
  HandMade model;
  add_block(model, "plate", plate, in_hole);
  expect_hole(hole().evaluate(model));
}

TEST(HoleDiameter, completes_half_and_quarter_models_to_the_same_numbers) {
  HandMade whole, half, quarter;
  add_block(whole, "plate", plate, in_hole);
  add_block(half, "plate", half_plate, in_hole);
  add_block(quarter, "plate", quarter_plate, in_hole);
  const auto reference = hole().evaluate(whole);
  const auto from_half = hole().vector("symmetry_normal", {0.0, -1.0, 0.0}).evaluate(half);
  const auto from_quarter = hole()
                                .vector("symmetry_normal", {0.0, 1.0, 0.0})
                                .vector("second_symmetry_normal", {1.0, 0.0, 0.0})
                                .evaluate(quarter);
  for (const auto& [name, value] : reference) {
    EXPECT_NEAR(from_half.at(name), value, 1e-9 * value) << name;
    EXPECT_NEAR(from_quarter.at(name), value, 1e-9 * value) << name;
  }
}

TEST(HoleDiameter, measures_the_rim_where_it_is_now) {
  HandMade model;
  add_block(model, "plate", plate, in_hole, [](Vec3 x) {
    return Vec3{1.25 * x.x, 1.1 * x.y, x.z + 2e-3 * std::exp(-norm(x) / 5e-3)};
  });
  const auto m = hole().evaluate(model);
  EXPECT_NEAR(m.at("entry_largest"), 20e-3, 1.25 * cell);
  EXPECT_NEAR(m.at("entry_smallest"), 11e-3, 1.1 * cell);
}

TEST(HoleDiameter, follows_the_normal_of_a_tilted_plate_given_to_three_digits) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  const auto tilt = [=](Vec3 x) { return Vec3{c * x.x + s * x.z, x.y, -s * x.x + c * x.z}; };
  HandMade model;
  add_block(model, "plate", plate, in_hole);
  for (MeasureModel::Node& n : model.nodes) n.reference = n.position = tilt(n.reference);
  expect_hole(hole().vector("normal", {0.6442, 0.0, 0.7648}).evaluate(model));
}

TEST(HoleDiameter, calls_a_crater_a_crater) {
  HandMade model;
  add_block(model, "plate", plate, [](Vec3 x) { return x.z > -2e-3 && in_ellipse(x, 6e-3, 6e-3); });
  const auto m = hole().evaluate(model);
  EXPECT_NEAR(m.at("entry_largest"), 12e-3, diagonal);
  EXPECT_TRUE(std::isnan(m.at("exit_largest")));
  EXPECT_TRUE(std::isnan(m.at("exit_smallest")));
  EXPECT_EQ(m.at("perforated"), 0.0);
}

TEST(HoleDiameter, does_not_take_a_crater_and_a_scab_for_a_perforation) {
  HandMade model;
  add_block(model, "plate", plate, [](Vec3 x) { return std::fabs(x.z + 2e-3) > 1e-3 && in_ellipse(x, 6e-3, 6e-3); });
  const auto m = hole().evaluate(model);
  EXPECT_NEAR(m.at("exit_largest"), 12e-3, diagonal);
  EXPECT_EQ(m.at("perforated"), 0.0);
}

TEST(HoleDiameter, finds_a_perforation_through_a_tunnel_of_one_cell) {
  HandMade model;
  add_block(model, "plate", plate, [](Vec3 x) {
    return (std::fabs(x.z + 2e-3) > 1e-3 && in_ellipse(x, 6e-3, 6e-3)) ||
           (x.x > 0.0 && x.x < cell && x.y > 0.0 && x.y < cell);
  });
  EXPECT_EQ(hole().evaluate(model).at("perforated"), 1.0);
}

TEST(HoleDiameter, finds_an_oblique_perforation) {
  HandMade model;
  add_block(model, "plate", plate, [](Vec3 x) { return in_ellipse({x.x - 3.0 * x.z, x.y, 0.0}, 3e-3, 2e-3); });
  const auto m = hole().evaluate(model);
  EXPECT_NEAR(m.at("entry_smallest"), 4e-3, cell);
  EXPECT_NEAR(m.at("exit_largest"), 6e-3, cell);
  EXPECT_EQ(m.at("perforated"), 1.0);
}

TEST(HoleDiameter, does_not_see_a_plug_or_fragments_in_the_hole) {
  const auto ring = [](Vec3 x) { return in_ellipse(x, 8e-3, 5e-3) && !in_ellipse(x, 4e-3, 3e-3); };
  HandMade model;
  add_block(model, "plate", plate, ring, [](Vec3 x) { return in_ellipse(x, 5e-3, 4e-3) ? x + Vec3{30e-3, 0, 0} : x; });
  const auto m = hole().evaluate(model);
  EXPECT_NEAR(m.at("entry_largest"), 16e-3, cell);
  EXPECT_NEAR(m.at("exit_smallest"), 10e-3, cell);
  EXPECT_EQ(m.at("perforated"), 1.0);
}

TEST(HoleDiameter, takes_the_largest_of_several_holes) {
  HandMade model;
  add_block(model, "plate", plate, [](Vec3 x) {
    return in_hole(x) || in_ellipse(x - Vec3{15e-3, 10e-3, 0}, 2e-3, 2e-3);
  });
  expect_hole(hole().evaluate(model));
}

TEST(HoleDiameter, finds_no_hole_in_a_whole_plate) {
  HandMade model;
  add_block(model, "plate", plate, [](Vec3) { return false; });
  EXPECT_EQ(hole().reason(model, "entry_largest"), "there is no hole in the entry face");
  EXPECT_EQ(hole().reason(model, "exit_area"), "there is no hole in the exit face");
  EXPECT_EQ(hole().evaluate(model).at("perforated"), 0.0);
}

TEST(HoleDiameter, knows_nothing_of_a_plate_that_has_eroded_away) {
  HandMade model;
  add_block(model, "plate", plate, [](Vec3) { return true; });
  for (const char* name : {"entry_largest", "exit_area", "perforated"})
    EXPECT_EQ(hole().reason(model, name), "no element of part plate is left");
}

// ---- what hole_diameter cannot know

/// Nothing is known of the holes and of a perforation, for a reason in which `part` stands.
void expect_unknown(const Maker& measure, const HandMade& model, const std::string& part) {
  for (const char* name : {"entry_largest", "entry_smallest", "entry_area", "exit_largest", "perforated"})
    EXPECT_THAT(measure.reason(model, name), testing::HasSubstr(part)) << name;
}

TEST(HoleDiameter, of_half_a_plate_is_not_known_without_its_plane_of_symmetry) {
  HandMade half, quarter;
  add_block(half, "plate", half_plate, in_hole);
  add_block(quarter, "plate", quarter_plate, in_hole);
  expect_unknown(hole(), half, "reaches its outline and has no closed rim; give `symmetry_normal`");
  expect_unknown(hole(), quarter, "reaches its outline");
  expect_unknown(hole().vector("symmetry_normal", {0.0, 1.0, 0.0}), quarter, "reaches its outline");
}

TEST(HoleDiameter, that_breaks_out_through_the_outline_is_not_known) {
  HandMade model;  // a small closed hole beside a large notch, then a crater beside it that does not go through
  add_block(model, "plate", plate, [](Vec3 x) {
    return in_ellipse(x - Vec3{0, 14e-3, 0}, 8e-3, 5e-3) || in_ellipse(x + Vec3{0, 8e-3, 0}, 2e-3, 2e-3);
  });
  EXPECT_THAT(hole().reason(model, "entry_largest"), testing::HasSubstr("reaches its outline"));
  EXPECT_EQ(hole().evaluate(model).at("perforated"), 1.0) << "the closed hole leads through";
}

TEST(HoleDiameter, is_that_of_the_closed_hole_where_only_a_corner_is_missing) {
  HandMade model;
  add_block(model, "plate", plate, [](Vec3 x) { return in_hole(x) || (x.x > 18e-3 && x.y > 13e-3); });
  expect_hole(hole().evaluate(model));
}

TEST(HoleDiameter, a_notch_in_one_face_alone_is_no_perforation) {
  HandMade model;
  add_block(model, "plate", half_plate, [](Vec3 x) { return x.z > -2e-3 && in_ellipse(x, 6e-3, 6e-3); });
  EXPECT_THAT(hole().reason(model, "entry_area"), testing::HasSubstr("reaches its outline"));
  EXPECT_EQ(hole().reason(model, "exit_area"), "there is no hole in the exit face");
  EXPECT_EQ(hole().evaluate(model).at("perforated"), 0.0);
}

TEST(HoleDiameter, is_not_known_where_the_normal_is_wrong) {
  HandMade model;
  add_block(model, "plate", plate, in_hole);
  for (const Vec3 normal : {Vec3{0.0, 1.0, 1.0}, Vec3{1.0, 1.0, 1.0}, Vec3{0.05, 0.0, 1.0}})
    expect_unknown(hole().vector("normal", normal), model, "face that is perpendicular to `normal`");
}

TEST(HoleDiameter, is_not_known_where_the_plane_of_symmetry_is_elsewhere) {
  HandMade whole, half;
  add_block(whole, "plate", plate, in_hole);
  add_block(half, "plate", half_plate, in_hole);
  expect_unknown(hole().vector("symmetry_normal", {0.0, 1.0, 0.0}), whole, "lies on both sides");
  expect_unknown(hole().vector("symmetry_normal", {0.0, 1.0, 0.0}).vector("symmetry_point", {0.0, -1e-3, 0.0}), half,
                 "does not reach a plane of symmetry");
}

TEST(HoleDiameter, keeps_to_the_undeformed_face_where_a_whole_layer_has_been_dropped) {
  HandMade model;
  add_block(model, "plate", plate, [](Vec3 x) { return x.z > -cell; });
  for (MeasureModel::Node& n : model.nodes)
    if (n.free) n.position = {1e9, 1e9, 1e9};  // nobody knows where a dropped node is
  EXPECT_TRUE(std::isnan(hole().evaluate(model).at("entry_largest")));
  EXPECT_EQ(hole().evaluate(model).at("perforated"), 0.0);
}

// ---- penetrators ----

const Grid rod{4, 4, 60, 1e-3, {-2e-3, -2e-3, 0.0}};

Vec3 lean(Vec3 x) { return {0.8 * x.x + 0.6 * x.z, x.y, -0.6 * x.x + 0.8 * x.z}; }

TEST(ResidualLength, is_that_of_the_largest_body_along_its_own_axis) {
  HandMade model;  // 40 mm of rod are left, and a fragment of 10 mm
  add_block(
      model, "rod", rod, [](Vec3 x) { return x.z > 50e-3 || (x.z > 10e-3 && x.z < 12e-3) || x.z < 2e-3; }, lean);
  EXPECT_NEAR(Maker("residual_length").text("part", "rod").evaluate(model).at(""), 38e-3, 1e-9);
  const auto along_z = Maker("residual_length").text("part", "rod").vector("axis", {0.0, 0.0, 2.0}).evaluate(model);
  EXPECT_NEAR(along_z.at(""), 0.8 * 38e-3 + 0.6 * 4e-3, 1e-9);
}

TEST(ResidualLength, of_a_bevelled_half_rod_lies_in_the_symmetry_plane) {
  const auto bevel = [](Vec3 x) { return std::hypot(x.x, x.y) > 0.5e-3 + 0.1 * x.z; };
  HandMade whole, half;
  add_block(whole, "rod", rod, bevel);
  add_block(half, "rod", {4, 2, 60, 1e-3, {-2e-3, 0.0, 0.0}}, bevel);
  const double reference = Maker("residual_length").text("part", "rod").evaluate(whole).at("");
  const auto m = Maker("residual_length").text("part", "rod").vector("symmetry_normal", {0, 3, 0}).evaluate(half);
  EXPECT_NEAR(m.at(""), reference, 1e-9);
}

TEST(ResidualLength, counts_bodies_that_share_a_node_as_one) {
  HandMade model;
  add_block(model, "rod", {2, 2, 2, 1e-3, {}}, [](Vec3 x) { return (x.x > 1e-3) != (x.y > 1e-3); });
  EXPECT_NEAR(Maker("residual_length").text("part", "rod").vector("axis", {1, 0, 0}).evaluate(model).at(""), 2e-3,
              1e-12);
}

TEST(Measures, of_a_part_that_has_eroded_away_are_not_known) {
  HandMade model;
  add_block(model, "rod", rod, [](Vec3) { return true; });
  const std::string reason = "no element of part rod is left";
  const Vec3 z{0, 0, 1};
  EXPECT_EQ(Maker("residual_length").text("part", "rod").reason(model), reason);
  EXPECT_EQ(Maker("residual_length").text("part", "rod").vector("axis", z).reason(model), reason);
  for (const char* name : {"x", "y", "z", "speed"})
    EXPECT_EQ(Maker("residual_velocity").text("part", "rod").reason(model, name), reason);
  EXPECT_EQ(Maker("final_length").text("part", "rod").vector("axis", z).reason(model), reason);
  EXPECT_EQ(Maker("largest_radius").text("part", "rod").vector("axis", z).reason(model), reason);
  // All mass is lost, and its nodes still move: these are numbers.
  EXPECT_EQ(Maker("mass_lost").text("part", "rod").evaluate(model).at("fraction"), 1.0);
  EXPECT_EQ(Maker("kinetic_energy").text("part", "rod").reason(model), "");
  for (MeasureModel::Node& n : model.nodes) n.mass = 0.0;
  EXPECT_EQ(Maker("kinetic_energy").text("part", "rod").reason(model), "all nodes of part rod have been dropped");
  for (const char* name : {"x", "y", "z"})
    EXPECT_EQ(Maker("part_momentum").text("part", "rod").reason(model, name),
              "all nodes of part rod have been dropped");
}

TEST(ResidualLength, of_what_is_no_rod_any_more_needs_an_axis) {
  const auto measure = [] { return std::move(Maker("residual_length").text("part", "rod")); };
  HandMade stub, disc, half_disc;  // 4 mm wide
  add_block(
      stub, "rod", rod, [](Vec3 x) { return x.z > 4e-3; }, lean);
  add_block(
      disc, "rod", rod, [](Vec3 x) { return x.z > 1e-3; },
      [](Vec3 x) {
        return Vec3{2.0 * x.x, x.y, x.z};
      });
  add_block(half_disc, "rod", {4, 2, 60, 1e-3, {-2e-3, 0.0, 0.0}}, [](Vec3 x) { return x.z > 1e-3; });
  EXPECT_THAT(measure().reason(stub), testing::HasSubstr("hardly longer than it is wide; give `axis`"));
  EXPECT_THAT(measure().reason(disc), testing::HasSubstr("wider than it is long; give `axis`"));
  EXPECT_THAT(measure().vector("symmetry_normal", {0, 1, 0}).reason(half_disc), testing::HasSubstr("wider than it is"));
  EXPECT_NEAR(measure().vector("axis", {0.6, 0, 0.8}).evaluate(stub).at(""), 4e-3, 1e-12);
}

TEST(ResidualVelocity, is_that_of_the_largest_body_whatever_its_fragments_do) {
  HandMade model;
  add_block(model, "rod", rod, [](Vec3 x) { return x.z > 50e-3 && x.z < 52e-3; });
  for (MeasureModel::Node& n : model.nodes)
    n.velocity = n.reference.z < 51.5e-3 ? Vec3{30.0, 0.0, -40.0 + 1e3 * n.reference.x} : Vec3{0.0, 900.0, 0.0};
  const auto m = Maker("residual_velocity").text("part", "rod").evaluate(model);
  EXPECT_NEAR(m.at("x"), 30.0, 1e-9);
  EXPECT_NEAR(m.at("y"), 0.0, 1e-9);
  EXPECT_NEAR(m.at("z"), -40.0, 1e-9);
  EXPECT_NEAR(m.at("speed"), 50.0, 1e-9);
}

TEST(MassLost, is_what_eroded) {
  HandMade model;
  add_block(model, "other", rod, [](Vec3) { return true; });
  add_block(model, "rod", rod, [](Vec3 x) { return x.z > 45e-3; });
  const auto m = Maker("mass_lost").text("part", "rod").evaluate(model);
  EXPECT_NEAR(m.at(""), 15 * 16 * 1e-6, 1e-12);
  EXPECT_NEAR(m.at("fraction"), 0.25, 1e-12);
}

TEST(MassLost, is_exactly_zero_where_nothing_eroded) {
  HandMade model;
  add_block(model, "rod", {7, 11, 13, 1e-3, {}}, [](Vec3) { return false; });
  model.initial_mass[0] *= 1.0 + 3e-16;  // summed in another order
  const auto m = Maker("mass_lost").text("part", "rod").evaluate(model);
  EXPECT_EQ(m.at(""), 0.0);
  EXPECT_EQ(m.at("fraction"), 0.0);
}

TEST(PartMomentum, and_kinetic_energy_take_all_nodes_of_the_part) {
  HandMade model;
  const auto keep = [](Vec3 x) { return x; };
  add_block(model, "rod", rod, [](Vec3 x) { return x.z > 45e-3; }, keep, {3.0, 0.0, 4.0});
  add_block(model, "other", rod, [](Vec3) { return false; }, keep, {100.0, 0.0, 0.0});
  const double mass = 960e-6;
  const auto m = Maker("part_momentum").text("part", "rod").evaluate(model);
  EXPECT_NEAR(m.at("x"), 3.0 * mass, 1e-12);
  EXPECT_NEAR(m.at("z"), 4.0 * mass, 1e-12);
  EXPECT_NEAR(Maker("kinetic_energy").text("part", "rod").evaluate(model).at(""), 12.5 * mass, 1e-12);
}

TEST(Measures, divide_a_shared_node_between_its_parts_by_what_they_give_to_its_mass) {
  HandMade model;
  model.parts = {"rod", "other", "third"};
  model.initial_mass = {1.0, 1.0, 1.0};
  // A node of the rod alone, one that all parts share, and a shared one that was dropped.
  model.nodes = {{0, 0, false, 2.0, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}},
                 {1, 0, false, 6.0, {0, 0, 1}, {0, 0, 1}, {0, 0, 10}},
                 {2, 0, true, 0.0, {0, 0, 2}, {0, 0, 2}, {0, 0, 0}}};
  model.nodes[1].first_share = 0;
  model.nodes[2].first_share = 3;
  model.shares = {{1, 0, 1.0}, {1, 1, 2.0}, {1, 2, 3.0}, {2, 0, 4.0}, {2, 1, 4.0}};
  const auto momentum = [&](const char* part) { return Maker("part_momentum").text("part", part).evaluate(model); };
  EXPECT_EQ(momentum("rod").at("x"), 2.0);
  EXPECT_EQ(momentum("rod").at("z"), 10.0);
  EXPECT_EQ(momentum("other").at("z"), 20.0);
  EXPECT_EQ(momentum("third").at("z"), 30.0);
  EXPECT_EQ(Maker("kinetic_energy").text("part", "third").evaluate(model).at(""), 150.0);
  EXPECT_TRUE(model.belongs_to(model.nodes[1], 2));
  EXPECT_FALSE(model.belongs_to(model.nodes[0], 2));
  EXPECT_FALSE(model.belongs_to(model.nodes[2], 2));
  EXPECT_EQ(model.mass_in(model.nodes[2], 1), 0.0);
}

// ---- the Taylor bar ----

TEST(FinalLength, and_largest_radius_measure_a_mushroom) {
  // Shortened to 2/3; the radius falls linearly from twice the initial one at the wall to the initial one at the top.
  HandMade model;
  add_block(
      model, "bar", rod, [](Vec3) { return false; },
      [](Vec3 x) {
        const double swell = 2.0 - x.z / 60e-3;
        return Vec3{5e-3 + swell * x.x, swell * x.y, 1e-3 + x.z / 1.5};
      });
  model.nodes.push_back({999999, 0, true, 1e-6, {}, {1.0, 1.0, 1.0}, {}});  // a free node counts for nothing
  EXPECT_NEAR(Maker("final_length").text("part", "bar").vector("axis", {0, 0, -1}).evaluate(model).at(""), 40e-3,
              1e-12);
  const auto radius = [] {
    return std::move(
        Maker("largest_radius").text("part", "bar").vector("axis", {0, 0, 1}).vector("point", {5e-3, 0.0, 7.0}));
  };
  const double corner = std::sqrt(2.0) * 2e-3;
  EXPECT_NEAR(radius().evaluate(model).at(""), 2.0 * corner, 1e-12);
  EXPECT_NEAR(radius().real("at_height", 0.0).evaluate(model).at(""), 2.0 * corner, 1e-12);
  // 0.2 of the initial 60 mm is 12 mm above the wall, where the material came from 18 mm.
  EXPECT_NEAR(radius().real("at_height", 0.2).evaluate(model).at(""), 1.7 * corner, 1e-12);
  EXPECT_EQ(radius().real("at_height", 0.9).reason(model), "part bar has become too short to reach `at_height`");
  EXPECT_EQ(Maker("largest_radius")
                .text("part", "bar")
                .vector("axis", {0, 0, 1})
                .vector("point", {20e-3, 0, 0})
                .reason(model),
            "the axis does not pass through part bar; look at `axis` and `point`");
  EXPECT_EQ(Maker("largest_radius")
                .text("part", "bar")
                .vector("axis", {1, 0, 0})
                .vector("point", {0, 0, -9e-3})
                .reason(model),
            "the axis does not pass through part bar; look at `axis` and `point`");
}

TEST(Measures, name_the_part_that_is_missing) {
  HandMade model;
  add_block(model, "rod", rod, [](Vec3) { return false; });
  for (const char* name : {"residual_length", "residual_velocity", "mass_lost", "hole_diameter", "part_momentum",
                           "kinetic_energy", "final_length", "largest_radius"})
    EXPECT_THROW(Maker(name).text("part", "bolt").evaluate(model), std::runtime_error) << name;
}

}  // namespace
