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

/// Steps of many lengths, whose ends are no round numbers.
class Flight {
 public:
  Flight(const std::string& parameters, Vec3 from, CurveTable* curves = nullptr)
      : law_(make_law<Boundary>("boundary", "prescribed_motion", parameters, curves)),
        node_(node_at(from.x, from.y, from.z)) {
    node_.reference_position = from;
    law_->prepare({1e-3, 2.0});
    velocity_ = law_->initial(node_, {});
  }
  void step(double dt) {
    velocity_ = law_->constrain(node_, {time_ + 0.5 * dt, dt}, velocity_);
    node_.position = node_.position + velocity_ * dt;
    time_ += dt;
  }
  /// Something else moves the node.
  void push(Vec3 way) { node_.position = node_.position + way; }
  double time() const { return time_; }
  Vec3 velocity() const { return velocity_; }
  Vec3 position() const { return node_.position; }
  Vec3 moved() const { return node_.position - node_.reference_position; }

 private:
  std::unique_ptr<Boundary> law_;
  BoundaryNode node_;
  Vec3 velocity_;
  double time_ = 0.0;
};

TEST(PrescribedMotion, gives_the_place_at_the_end_of_every_step) {
  Flight flight("{displacement: [2 mm, -1 mm, 0 mm], times: \"[0, 1, 3] s\", factors: [0, 1, -1], components: [x, y]}",
                {0.7, -1.3, 0.2});
  expect_vector(flight.velocity(), {2e-3, -1e-3, 0.0}, 0.0);  // of the first piece, from time zero on
  for (int i = 0; i < 40000; ++i) {
    flight.step(1e-4 * (1.0 + 0.3 * std::sin(0.1 * i)));
    const double t = flight.time(), f = t < 1.0 ? t : t < 3.0 ? 2.0 - t : -1.0;
    // Half the last bit of the coordinate, and what adding up times has left of theirs.
    ASSERT_NEAR(flight.position().x, 0.7 + 2e-3 * f, 1.2e-16) << i;
    ASSERT_NEAR(flight.position().y, -1.3 - 1e-3 * f, 2.3e-16) << i;
    ASSERT_EQ(flight.moved().z, 0.0);
  }
  EXPECT_GT(flight.time(), 3.5);
  expect_vector(flight.velocity(), {}, 1e-11);  // the last bit of a coordinate in a step
}

TEST(PrescribedMotion, follows_a_displacement_by_a_named_curve) {
  kerf::test::RampTable curves;
  Flight flight("{displacement: [10 mm, 0 mm, 0 mm], curve: ramp}", {0.0, 0.0, 0.0}, curves.table());
  expect_vector(flight.velocity(), {}, 0.0);
  for (int i = 0; i < 6; ++i) flight.step(0.25);
  EXPECT_DOUBLE_EQ(flight.moved().x, 10e-3);
  EXPECT_DOUBLE_EQ(flight.velocity().x, 20e-3);
}

TEST(PrescribedMotion, does_not_take_back_at_once_what_something_else_has_moved) {
  Flight flight("{displacement: [1 mm, 0 mm, 0 mm], times: [0, 1], factors: [0, 1]}", {0.0, 0.0, 0.0});
  flight.step(0.1);
  flight.push({1e-4, 0.0, 0.0});
  flight.step(0.1);
  EXPECT_DOUBLE_EQ(flight.velocity().x, 1e-3);
  EXPECT_DOUBLE_EQ(flight.moved().x, 3e-4);
}

TEST(PrescribedMotion, acts_between_birth_and_death) {
  const auto velocity = make_boundary("prescribed_motion", "{velocity: [5, 5, 5], birth: 1 s, death: 2 s}");
  const auto place = make_boundary("prescribed_motion",
                                   "{displacement: [5, 5, 5], times: [0, 4], factors: [-1, 3], "
                                   "birth: 1 s, death: 2 s}");
  for (const auto& b : {velocity.get(), place.get()}) {
    expect_vector(b->initial({}, {1, 2, 3}), {1, 2, 3}, 0.0);
    expect_vector(b->constrain({}, {0.999, 0.1}, {1, 2, 3}), {1, 2, 3}, 0.0);
    expect_vector(b->constrain({}, {1.0, 0.1}, {1, 2, 3}), {5, 5, 5});
    expect_vector(b->constrain({}, {1.999, 0.1}, {1, 2, 3}), {5, 5, 5});
    expect_vector(b->constrain({}, {2.0, 0.1}, {1, 2, 3}), {1, 2, 3}, 0.0);
  }
  expect_vector(make_boundary("prescribed_motion", "{velocity: [5, 5, 5], death: 1 s}")->initial({}, {}), {5, 5, 5});
}

TEST(PrescribedMotion, refuses_what_is_no_motion) {
  const auto text = [](const std::string& keys) { return refusal("boundary", "prescribed_motion", "{" + keys + "}"); };
  const std::string table = "displacement: [1, 0, 0], times: [0, 1], factors: ";
  EXPECT_THAT(text("components: x"), ::testing::HasSubstr("give a velocity or a displacement, one of the two"));
  EXPECT_THAT(text("velocity: [1, 0, 0], displacement: [1, 0, 0]"), ::testing::HasSubstr("one of the two"));
  EXPECT_THAT(text("displacement: [1, 0, 0]"), ::testing::HasSubstr("must be 0 at time zero"));
  EXPECT_THAT(text(table + "[0.1, 1]"), ::testing::HasSubstr("must be 0 at time zero"));
  EXPECT_EQ(text(table + "[0.1, 1], birth: 0.5 s"), "");
  EXPECT_EQ(text(table + "[0, 1]"), "");
  EXPECT_THAT(text("velocity: [1, 0, 0], birth: 2 s, death: 2 s"), ::testing::HasSubstr("death must be after birth"));
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
