// Contact laws on a surface made by hand: what single nodes in awkward places get.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "kerf/contact.hpp"
#include "support/make_law.hpp"

namespace {

using namespace kerf;
using kerf::test::make_law;

/// The view of a scene with rows of its own for nodes, facets and slaves; `facets` lists candidates and surroundings.
template <class Scene>
ContactView view_of(const Scene& scene) {
  ContactView view;
  view.dt = view.kick_dt = 1e-3;
  view.n_nodes = static_cast<int>(scene.node_id.size());
  view.node_id = scene.node_id.data();
  view.position = scene.position.data();
  view.velocity = scene.velocity.data();
  view.mass = scene.mass.data();
  view.node_body = scene.node_body.data();
  view.n_facets = static_cast<int>(scene.facet_id.size());
  view.facet_id = scene.facet_id.data();
  view.facet_nodes = scene.facet_nodes.data();
  view.facet_body = scene.facet_body.data();
  view.facet_bulk_modulus = scene.bulk_modulus.data();
  view.facet_volume = scene.volume.data();
  view.facet_edge = scene.edge.data();
  view.n_slaves = static_cast<int>(scene.slave.size());
  view.slave = scene.slave.data();
  view.candidate_rows = scene.candidates.data();
  view.around_rows = scene.around.data();
  view.candidate = view.around = scene.facets.data();
  return view;
}

/// A roof of two unit facets along y, and one free node of another part. Its ridge is at a place that costs round-off.
struct Roof {
  static constexpr Vec3 ridge = {0.37, 0.0, 0.73};

  alignas(32) std::array<double, 28> position = {-1, 0, -1, 0, -1, 1, -1, 0, 0,  0, 0, 0, 0, 1,
                                                 0,  0, 1,  0, -1, 0, 1,  1, -1, 0, 0, 0, 0, 0};
  alignas(32) std::array<double, 28> velocity = {};
  std::array<double, 7> mass = {1, 1, 1, 1, 1, 1, 1};
  std::array<std::int32_t, 7> node_body = {0, 0, 0, 0, 0, 0, 1};
  std::array<std::int64_t, 7> node_id = {0, 1, 2, 3, 4, 5, 6};
  std::array<std::int32_t, 8> facet_nodes = {0, 2, 3, 1, 2, 4, 5, 3};
  std::array<std::int64_t, 2> facet_id = {1, 9};
  std::array<std::int32_t, 2> facet_body = {0, 0};
  std::array<double, 2> bulk_modulus = {1e3, 1e3}, volume = {1, 1}, edge = {1, 1};
  std::array<std::int32_t, 1> slave = {6};
  std::array<ContactRow, 1> candidates = {{{0, 2}}}, around = {};
  std::array<std::int32_t, 2> facets = {0, 1};

  Roof() {
    for (int n = 0; n < 7; ++n)
      for (int d = 0; d < 3; ++d) position[4 * n + d] += ridge[d];
  }

  /// The touch of the free node at `s` from the ridge's end, that moves down; empty where there is none.
  std::optional<ContactTouch> touch_at(const Contact& law, Vec3 s, double speed = 1.0) {
    for (int d = 0; d < 3; ++d) position[24 + d] = ridge[d] + s[d];
    velocity[26] = -speed;
    ContactTouches touches;
    law.find_touches(view_of(*this), touches);
    longest_step = touches.longest_step();
    n_let_go = touches.all_let_go().size();
    if (touches.touches().empty()) return std::nullopt;
    return touches.touches().front();
  }
  double longest_step = 0.0;  // that the law allowed last [s]
  std::size_t n_let_go = 0;
};

TEST(ErodingSurface, pushes_a_node_below_a_ridge_up) {
  const auto law = make_law<Contact>("contact", "eroding_surface");
  Roof roof;
  const auto touch = roof.touch_at(*law, {0.0, 0.5, -0.1});
  ASSERT_TRUE(touch);
  EXPECT_GT(touch->direction[2], 0.0);
  EXPECT_NEAR(touch->direction[1], 0.0, 1e-6);
}

// Off the surface by little, length and direction of the way out used to be those of different vectors. That happens
// where triangles meet: on the ridge and on the diagonals of a facet. What is round-off is no touch at all, since it
// would be there on one side of a symmetric model and not on the other.
TEST(ErodingSurface, stays_bounded_for_a_node_on_the_surface) {
  const auto law = make_law<Contact>("contact", "eroding_surface");
  Roof roof;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  int pushed = 0;
  for (int i = 0; i < 40000; ++i) {
    const bool is_round_off = i % 4 < 2;
    const double along = 0.5 + 0.4 * u(random),
                 off = std::pow(10.0, (is_round_off ? -9.5 : -6.0) - 2.0 * std::fabs(u(random)));
    const double across = i % 2 == 0 ? 0.0 : -along;  // the ridge, or the diagonal through its end
    const auto touch =
        roof.touch_at(*law, {across + off * u(random), along + off * u(random), across - off * std::fabs(u(random))});
    if (!touch) continue;
    ASSERT_FALSE(is_round_off);
    // The node is off by at most `off` in each of three directions.
    ASSERT_LT(touch->depth, 1.8 * off);
    ASSERT_NEAR(norm(touch->direction), 1.0, 1e-12) << "off by " << off;
    ++pushed;
  }
  EXPECT_GT(pushed, 5000);
}

/// Two roofs of two facets each, 2 long: a lower one with its ridge along y, and an upper one upside down with its
/// ridge along x. All four ends of the ridges are slaves. The ridges cross in the middle, the upper one 0.1 too deep.
struct CrossedRoofs {
  std::vector<Vec3> x;
  std::vector<std::int64_t> node_id;
  std::array<std::int32_t, 16> facet_nodes = {0, 2, 3, 1, 2, 4, 5, 3, 6, 8, 9, 7, 8, 10, 11, 9};
  std::array<std::int64_t, 4> facet_id = {1, 9, 17, 25};
  std::array<std::int32_t, 4> facet_body = {0, 0, 1, 1};
  std::array<std::int32_t, 12> node_body = {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1};
  std::vector<std::int32_t> slave = {2, 3, 8, 9};
  std::array<double, 4> volume = {4, 4, 4, 4}, edge = {2, 2, 2, 2};
  double down = -1.0;  // velocity of the upper roof
  alignas(32) std::array<double, 48> position = {}, velocity = {};
  std::vector<double> mass = std::vector<double>(12, 1.0), bulk_modulus = std::vector<double>(4, 1e3);
  std::vector<ContactRow> candidates, around;  // per slave
  std::array<std::int32_t, 4> facets = {0, 1, 2, 3};

  /// `drop`: how far the eaves are from the ridge, along z; `angle` between the ridges.
  explicit CrossedRoofs(double drop = 1.0, double angle = 0.5 * 3.14159265358979) {
    for (const double across : {-1.0, 0.0, 1.0})
      for (const double along : {-1.0, 1.0}) x.push_back({across, along, across == 0.0 ? 0.0 : -drop});
    // The same, turned over about the x axis, and its ridge turned away from the lower one's by the angle.
    for (const double across : {-1.0, 0.0, 1.0})
      for (const double along : {1.0, -1.0})
        x.push_back({across * std::cos(angle) - along * std::sin(angle),
                     across * std::sin(angle) + along * std::cos(angle), (across == 0.0 ? 0.0 : drop) - 0.1});
    for (std::int64_t n = 0; n < 12; ++n) node_id.push_back(100 + n);
  }

  ContactTouches touches(const Contact& law) const {
    CrossedRoofs scene = *this;
    for (std::size_t n = 0; n < 12; ++n) {
      for (int d = 0; d < 3; ++d) scene.position[4 * n + static_cast<std::size_t>(d)] = x[n][d];
      scene.velocity[4 * n + 2] = n < 6 ? 0.0 : down;
    }
    // Each ridge is held by the facets of its own roof, and may touch those of the other.
    for (const std::int32_t s : slave) {
      scene.around.push_back(s < 6 ? ContactRow{0, 2} : ContactRow{2, 4});
      scene.candidates.push_back(s < 6 ? ContactRow{2, 4} : ContactRow{0, 2});
    }
    ContactTouches found;
    law.find_touches(view_of(scene), found);
    return found;
  }
};

TEST(ErodingSurfaceEdges, touch_where_they_cross_though_no_node_is_inside) {
  const CrossedRoofs roofs;
  const auto found = roofs.touches(*make_law<Contact>("contact", "eroding_surface"));
  ASSERT_EQ(found.touches().size(), 1u);  // once, whoever of the four ends sees it
  const ContactTouch& t = found.touches().front();
  EXPECT_EQ(std::min(t.node, t.second), 2);
  EXPECT_EQ(std::max(t.node, t.second), 3);
  EXPECT_NEAR(t.second_weight, 0.5, 1e-15);
  EXPECT_EQ(t.facet, 2);  // of the two that hold the upper ridge, the one with the lower id
  const double weights[4] = {0.0, 0.5, 0.5, 0.0};  // of its corners 6, 8, 9, 7
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(t.weights[k], weights[k], 1e-15);
  EXPECT_NEAR(t.direction.z, -1.0, 1e-15);  // the lower ridge is pushed out of the upper roof
  EXPECT_NEAR(t.depth, 0.1, 1e-15);
  EXPECT_TRUE(roofs.touches(*make_law<Contact>("contact", "eroding_surface", "{edges: false}")).touches().empty());
}

// Which rank owns which end, and how it numbers nodes, must not matter.
TEST(ErodingSurfaceEdges, are_reported_by_one_end_with_the_same_bits) {
  const auto law = make_law<Contact>("contact", "eroding_surface");
  CrossedRoofs roofs(0.9, 1.1);
  for (Vec3& x : roofs.x) x = x + Vec3{0.123, 0.456, 0.789};
  for (int n = 6; n < 12; ++n) roofs.x[static_cast<std::size_t>(n)].x += 0.3;
  for (const std::int64_t lowest : {2, 3, 8, 9}) {
    CrossedRoofs other = roofs;
    other.node_id[static_cast<std::size_t>(lowest)] = 1;
    const auto all = other.touches(*law);
    ASSERT_EQ(all.touches().size(), 1u);
    std::size_t n_found = 0;
    for (const std::int32_t one : {2, 3, 8, 9}) {
      other.slave = {one};
      const auto found = other.touches(*law);
      n_found += found.touches().size();
      EXPECT_EQ(found.touches().size(), one == lowest ? 1u : 0u);
      if (found.touches().empty()) continue;
      EXPECT_EQ(found.touches().front().depth, all.touches().front().depth);
      EXPECT_EQ(found.touches().front().second_weight, all.touches().front().second_weight);
    }
    EXPECT_EQ(n_found, 1u);
  }
}

TEST(ErodingSurfaceEdges, are_let_alone_where_nothing_is_inside) {
  const auto law = make_law<Contact>("contact", "eroding_surface");
  const auto n_found = [&](const CrossedRoofs& roofs) {
    const auto found = roofs.touches(*law);
    return std::count_if(found.touches().begin(), found.touches().end(), [](const auto& t) { return t.second >= 0; });
  };
  EXPECT_EQ(n_found(CrossedRoofs(1.0, 0.6)), 1);
  EXPECT_EQ(n_found(CrossedRoofs(1.0, 0.05)), 0) << "nearly parallel";
  EXPECT_EQ(n_found(CrossedRoofs(0.3)), 1);
  EXPECT_EQ(n_found(CrossedRoofs(0.25)), 0) << "28 degrees count as smooth";
  EXPECT_EQ(n_found(CrossedRoofs(-1.0)), 0) << "valleys";
  const auto moved = [&](double drop, Vec3 way) {
    CrossedRoofs roofs(drop);
    for (std::size_t n = 6; n < 12; ++n) roofs.x[n] = roofs.x[n] + way;
    return n_found(roofs);
  };
  EXPECT_EQ(moved(1.0, {0, 0, 0.11}), 0) << "apart";
  EXPECT_EQ(moved(1.0, {0, 0, -3.0}), 0) << "deeper than any edge is held";
  // The upper ridge passes the end of the lower one, 0.1 above it. The end is in the wedge as far as it has gone down.
  EXPECT_EQ(moved(1.0, {0, 0.99, 0}), 1);
  EXPECT_EQ(moved(1.0, {0, 1.09, 0}), 1) << "the end is inside";
  EXPECT_EQ(moved(1.0, {0, 1.11, 0}), 0) << "the end is beside";
  EXPECT_EQ(moved(3.0, {0, 1.03, 0}), 1) << "the end is inside of a wedge of 37 degrees";
  EXPECT_EQ(moved(3.0, {0, 1.04, 0}), 0) << "the end is beside a wedge of 37 degrees";
  // Wedges of 37 degrees that lean: their sides both go down from the ridge, and then one of them goes up.
  for (const double lean : {0.0, 0.5, 1.3}) {
    CrossedRoofs acute(3.0);
    for (std::size_t n = 0; n < 6; ++n) {
      const Vec3 x = acute.x[n];
      acute.x[n].x = x.x * std::cos(lean) - x.z * std::sin(lean);
      acute.x[n].z = x.x * std::sin(lean) + x.z * std::cos(lean);
    }
    EXPECT_EQ(n_found(acute), lean < 1.0 ? 1 : 0) << lean;
  }
}

TEST(ErodingSurfaceEdges, are_let_go_of_below_the_greatest_depth) {
  const auto law = make_law<Contact>("contact", "eroding_surface");
  CrossedRoofs roofs;
  // The facets are 2 by 1.414 in size, of elements 1.414 thick: an edge is held to 0.6 of that.
  for (std::size_t n = 6; n < 12; ++n) roofs.x[n].z -= 0.8 - 0.1;
  EXPECT_EQ(roofs.touches(*law).touches().size(), 1u);
  for (std::size_t n = 6; n < 12; ++n) roofs.x[n].z -= 0.1;
  roofs.down = -100.0;  // from 0.8 to 0.9 in this step
  EXPECT_EQ(roofs.touches(*law).touches().size(), 0u);
  ASSERT_EQ(roofs.touches(*law).all_let_go().size(), 1u);
  EXPECT_NEAR(roofs.touches(*law).all_let_go().front().depth, 0.9, 1e-12);
  roofs.down = -1.0;  // it had been let go of before
  EXPECT_TRUE(roofs.touches(*law).all_let_go().empty());
}

// Which facets beyond their reach are candidates is a matter of the search's margins, hence of chance.
TEST(ErodingSurface, does_not_care_for_facets_beyond_their_reach) {
  const auto law = make_law<Contact>("contact", "eroding_surface", "{damping: 0}");
  Roof roof;
  // A long facet that ends in a short one, which goes straight down. Both hold the closest point, on their edge; the
  // node is within the reach of the long one, 0.75 of 4, and beyond that of the short one, 0.75 of 1.
  const Vec3 corner[6] = {{-4, -0.5, 0}, {-4, 0.5, 0}, {0, -0.5, 0}, {0, 0.5, 0}, {0, -0.5, -1}, {0, 0.5, -1}};
  for (int n = 0; n < 6; ++n)
    for (int d = 0; d < 3; ++d) roof.position[4 * n + d] = Roof::ridge[d] + corner[n][d];
  roof.volume = {16, 1};
  roof.edge = {4, 1};
  const Vec3 node{0.8, 0.0, -0.3};
  const auto with_both = roof.touch_at(*law, node);
  roof.candidates[0].end = 1;  // of two candidates
  const auto with_one = roof.touch_at(*law, node);
  ASSERT_TRUE(with_both && with_one);
  for (int d = 0; d < 3; ++d) EXPECT_EQ(with_both->direction[d], with_one->direction[d]);
  EXPECT_EQ(with_both->depth, with_one->depth);
}

/// What all laws do alike.
struct AnyLaw : testing::TestWithParam<const char*> {
  std::unique_ptr<Contact> law() const {
    const std::string name = GetParam();
    return make_law<Contact>("contact", GetParam(),
                             name == "slide_surface" ? "{slave: a, master: b, depth: 0.6}" : "{depth: 0.6}");
  }
};
INSTANTIATE_TEST_SUITE_P(Contact, AnyLaw, testing::Values("eroding_surface", "slide_surface"),
                         [](const auto& info) { return std::string(info.param); });

// The greatest depth is 0.6 here, the step 1 ms.
TEST_P(AnyLaw, counts_a_node_in_the_step_in_which_it_passes_the_greatest_depth) {
  Roof roof;
  roof.candidates[0].end = 1;
  const Vec3 corner[4] = {{-1, -1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 0}};
  for (int n = 0; n < 4; ++n)
    for (int d = 0; d < 3; ++d) roof.position[4 * n + d] = Roof::ridge[d] + corner[n][d];
  const auto law = this->law();
  EXPECT_TRUE(roof.touch_at(*law, {-0.4, -0.3, -0.5995}));
  EXPECT_EQ(roof.n_let_go, 0u);
  EXPECT_FALSE(roof.touch_at(*law, {-0.4, -0.3, -0.6005}));
  EXPECT_EQ(roof.n_let_go, 1u);
  EXPECT_FALSE(roof.touch_at(*law, {-0.4, -0.3, -0.6015}));
  EXPECT_EQ(roof.n_let_go, 0u) << "it was deeper before";
}

TEST_P(AnyLaw, bounds_the_step_of_a_node_that_closes_in) {
  Roof roof;
  roof.candidates[0].end = 1;
  const Vec3 corner[4] = {{-1, -1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 0}};
  for (int n = 0; n < 4; ++n)
    for (int d = 0; d < 3; ++d) roof.position[4 * n + d] = Roof::ridge[d] + corner[n][d];
  const auto law = this->law();
  constexpr double deepest = 0.6, speed = 200.0;
  for (const double height : {0.6, 0.2, 0.0, -0.2}) {
    roof.touch_at(*law, {-0.4, -0.3, height}, speed);
    // No farther than to half of the greatest depth, nor out of sight at 1.25 times of it; round-off is 1e-16 of 1 m.
    const double way = std::min(0.5 * deepest + std::max(height, 0.0), 1.25 * deepest + height);
    EXPECT_NEAR(roof.longest_step, way / speed, 1e-15) << height;
  }
  roof.touch_at(*law, {-0.4, -0.3, 0.2}, -speed);
  EXPECT_GT(roof.longest_step, 1e200) << "it flies away";
  roof.touch_at(*law, {-0.4, -0.3, 0.2}, 0.1 * speed);
  EXPECT_GT(roof.longest_step, 1e200) << "it is slow";
}

// The least of V/A, longest edge now and longest edge once, whatever the facet has become.
TEST_P(AnyLaw, lets_go_of_what_is_deeper_than_the_facet_was_large) {
  const auto law = this->law();
  struct Case {
    double width, volume, edge;  // of a facet 4 long: width, volume of its element, longest edge once
    double least;
  };
  for (const Case c :
       {Case{1.0, 1.0, 2.0, 0.25}, Case{0.125, 1.0, 1.5, 1.5}, Case{0.5, 27.0, 3.0, 3.0}, Case{4.0, 512.0, 9.0, 4.0}}) {
    Roof roof;
    roof.candidates[0].end = 1;
    const double w = 0.5 * c.width;
    const Vec3 corner[4] = {{-4, -w, 0}, {-4, w, 0}, {0, -w, 0}, {0, w, 0}};
    for (int n = 0; n < 4; ++n)
      for (int d = 0; d < 3; ++d) roof.position[4 * n + d] = Roof::ridge[d] + corner[n][d];
    roof.volume[0] = c.volume;
    roof.edge[0] = c.edge;
    for (const bool shallow : {true, false}) {
      const double depth = 0.6 * c.least * (shallow ? 0.99 : 1.01);
      const bool touches = roof.touch_at(*law, {-1.7, 0.1 * w, -depth}).has_value();
      EXPECT_EQ(touches, shallow) << c.width << " wide, volume " << c.volume << ", depth " << depth;
    }
  }
}

}  // namespace
