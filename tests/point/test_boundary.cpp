// Boundary conditions at a node.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kerf/boundary.hpp"
#include "support/make_law.hpp"

namespace {

using namespace kerf;
using kerf::test::make_law;
using kerf::test::refusal;

std::unique_ptr<Boundary> make_boundary(const std::string& name, const std::string& parameters) {
  return make_law<Boundary>("boundary", name, parameters);
}

BoundaryNode node_at(double x, double y, double z) {
  BoundaryNode node;
  node.id = 7;
  node.mass = 1.0;
  node.position = {x, y, z};
  return node;
}

void expect_vector(Vec3 a, Vec3 b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(InitialVelocity, sets_velocity_and_spin_at_the_start_only) {
  const auto b = make_boundary("initial_velocity",
                               "{nodes: rod, velocity: \"[0, 0, 100] m/s\", angular_velocity: \"[0, 0, 10] rad/s\"}");
  EXPECT_EQ(b->nodes(), std::vector<std::string>{"rod"});
  expect_vector(b->initial(node_at(2, 0, 0), {1, 2, 3}), {0, 20, 100});
  expect_vector(b->constrain(node_at(2, 0, 0), {1.0, 0.1}, {1, 2, 3}), {1, 2, 3});
}

TEST(Fixed, holds_the_chosen_components) {
  expect_vector(make_boundary("fixed", "{nodes: [a, b]}")->constrain({}, {}, {1, 2, 3}), {0, 0, 0});
  const auto b = make_boundary("fixed", "{components: [x, z]}");
  EXPECT_TRUE(b->nodes().empty());
  expect_vector(b->constrain({}, {}, {1, 2, 3}), {0, 2, 0});
  expect_vector(b->initial({}, {1, 2, 3}), {0, 2, 0});
  EXPECT_THAT(refusal("boundary", "fixed", "{components: [x, w]}"), ::testing::HasSubstr("any of x, y and z"));
}

TEST(PrescribedMotion, follows_its_table) {
  const auto b =
      make_boundary("prescribed_motion",
                    "{components: y, velocity: \"[9, 10, 9] m/s\", times: \"[1, 2, 4] s\", factors: [0, 1, -1]}");
  const auto y_at = [&](double time) { return b->constrain({}, {time, 0.1}, {1, 2, 3}).y; };
  EXPECT_DOUBLE_EQ(y_at(0.0), 0.0);
  EXPECT_DOUBLE_EQ(y_at(1.5), 5.0);
  EXPECT_DOUBLE_EQ(y_at(3.0), 0.0);
  EXPECT_DOUBLE_EQ(y_at(9.0), -10.0);
  expect_vector(b->constrain({}, {2.0, 0.1}, {1, 2, 3}), {1, 10, 3});
  expect_vector(make_boundary("prescribed_motion", "{velocity: [1, 2, 3]}")->initial({}, {}), {1, 2, 3});
}

TEST(PrescribedMotion, follows_a_named_curve) {
  kerf::test::RampTable curves;
  const auto b =
      make_law<Boundary>("boundary", "prescribed_motion", "{velocity: [10, 0, 0], curve: ramp}", curves.table());
  expect_vector(b->constrain({}, {0.5, 0.1}, {1, 2, 3}), {0, 0, 0});
  expect_vector(b->constrain({}, {1.5, 0.1}, {1, 2, 3}), {10, 0, 0});
  expect_vector(b->constrain({}, {7.0, 0.1}, {1, 2, 3}), {20, 0, 0});
  EXPECT_THAT(refusal("boundary", "prescribed_motion",
                      "{velocity: [10, 0, 0], curve: ramp, times: [0, 1], factors: [1, 1]}", curves.table()),
              ::testing::HasSubstr("give one or the other"));
  EXPECT_THAT(refusal("boundary", "prescribed_motion", "{velocity: [10, 0, 0], curve: rampp}", curves.table()),
              ::testing::HasSubstr("there is no curve \"rampp\"; did you mean `ramp`?"));
  EXPECT_THAT(refusal("boundary", "prescribed_motion", "{velocity: [10, 0, 0], curve: ramp}"),
              ::testing::HasSubstr("there is no curve \"ramp\"; declare it in the block `curves`"));
}

TEST(PrescribedMotion, refuses_a_bad_table) {
  EXPECT_THAT(refusal("boundary", "prescribed_motion", "{velocity: [1, 0, 0], times: [1, 2], factors: [1]}"),
              ::testing::HasSubstr("equal number"));
  EXPECT_THAT(refusal("boundary", "prescribed_motion", "{velocity: [1, 0, 0], times: [2, 1], factors: [1, 1]}"),
              ::testing::HasSubstr("times must increase"));
}

TEST(Symmetry, holds_nodes_on_the_plane_and_leaves_others) {
  const auto b = make_boundary("symmetry", "{normal: [0, 2, 0]}");
  expect_vector(b->constrain(node_at(1, 0, 1), {0, 1e-3}, {1, 2, 3}), {1, 0, 3}, 0.0);
  expect_vector(b->constrain(node_at(1, 1, 1), {0, 1e-3}, {1, -2, 3}), {1, -2, 3}, 0.0);
  expect_vector(b->initial(node_at(1, 0, 1), {1, 2, 3}), {1, 0, 3}, 0.0);
  expect_vector(b->initial(node_at(1, 1, 1), {1, 2, 3}), {1, 2, 3}, 0.0);
}

TEST(Symmetry, bounces_a_free_node_off_its_mirror_image) {
  const auto b = make_boundary("symmetry", "{normal: [0, 2, 0], point: [0, 1, 0]}");
  const Vec3 v = b->constrain(node_at(0, 1.5, 0), {0, 1e-3}, {4, -1000, 0});
  expect_vector(v, {4, 1000, 0}, 1e-9);  // the elastic collision of two equal masses; round-off of the normalisation
}

TEST(Symmetry, complains_of_nodes_on_the_other_side) {
  const auto b = make_boundary("symmetry", "{normal: [0, 1, 0]}");
  EXPECT_EQ(b->complaint(node_at(0, 0, 0)), "");
  EXPECT_EQ(b->complaint(node_at(0, 1, 0)), "");
  EXPECT_THAT(b->complaint(node_at(0, -1, 0)), ::testing::StartsWith("starts 1 m behind"));
}

/// Bodies of 25 nm and of 25 km alike: the cell has an edge of `edge`.
TEST(Symmetry, tolerance_follows_the_mesh) {
  for (const double edge : {5e-9, 1e-3, 5e3}) {
    const auto b = make_boundary("symmetry", "{normal: [0, 1, 0]}");
    b->prepare({edge, 5.0 * edge});
    EXPECT_TRUE(b->mirrors({edge, 1e-7 * edge, 0}));
    EXPECT_FALSE(b->mirrors({edge, 1e-3 * edge, 0}));
    EXPECT_EQ(b->complaint(node_at(0, -1e-7 * edge, 0)), "");
    EXPECT_NE(b->complaint(node_at(0, -1e-3 * edge, 0)), "");
  }
  const auto given = make_boundary("symmetry", "{normal: [0, 1, 0], tolerance: 0.1}");
  given->prepare({1e-3, 1.0});
  EXPECT_TRUE(given->mirrors({0, 0.05, 0}));
}

TEST(RigidWall, tolerance_follows_the_mesh) {
  const auto b = make_boundary("rigid_wall", "{point: [0, 0, 0], normal: [0, 0, 1]}");
  b->prepare({5e-9, 25e-9});
  EXPECT_EQ(b->complaint(node_at(0, 0, -1e-16)), "");
  EXPECT_NE(b->complaint(node_at(0, 0, -1e-10)), "");
}

TEST(RigidWall, puts_a_node_on_the_wall_and_lets_it_leave) {
  const auto b = make_boundary("rigid_wall", "{point: [0, 0, 1], normal: [0, 0, 3]}");
  const BoundaryStep step{0.05, 0.1};
  expect_vector(b->constrain(node_at(0, 0, 1.2), step, {5, 0, -10}), {5, 0, -2});
  expect_vector(b->constrain(node_at(0, 0, 1), step, {5, 0, 10}), {5, 0, 10}, 0.0);
  expect_vector(b->constrain(node_at(0, 0, 2), step, {5, 0, -9}), {5, 0, -9}, 0.0);
}

TEST(RigidWall, moves_with_its_velocity) {
  const auto b = make_boundary("rigid_wall", "{point: [0, 0, 0], normal: [0, 0, 1], velocity: \"[0, 0, 3] m/s\"}");
  // At the end of the step, t = 2.1, the wall is at z = 6.3.
  expect_vector(b->constrain(node_at(0, 0, 6.0), {2.05, 0.1}, {0, 0, 0}), {0, 0, 3});
}

TEST(RigidWall, slows_sliding_by_friction) {
  const auto b = make_boundary("rigid_wall", "{point: [0, 0, 0], normal: [0, 0, 1], friction: 0.3}");
  const BoundaryStep step{0.0, 1.0};
  expect_vector(b->constrain(node_at(0, 0, 0), step, {30, 40, -10}), {30 - 1.8, 40 - 2.4, 0});  // slides
  expect_vector(b->constrain(node_at(0, 0, 0), step, {1, 2, -10}), {0, 0, 0});  // sticks
}

TEST(RigidWall, complains_of_nodes_behind_it) {
  const auto b = make_boundary("rigid_wall", "{point: [0, 0, 0], normal: [0, 0, 1]}");
  EXPECT_EQ(b->complaint(node_at(0, 0, 0)), "");
  EXPECT_THAT(b->complaint(node_at(0, 0, -1e-3)), ::testing::HasSubstr("behind the rigid wall"));
  EXPECT_THAT(refusal("boundary", "rigid_wall", "{point: [0, 0, 0], normal: [0, 0, 0]}"),
              ::testing::HasSubstr("zero length"));
}

}  // namespace
