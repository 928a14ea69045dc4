// Requirement: loads return what their pages say, and a facet's pressure is shared by its corners as virtual work asks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kerf/load.hpp"
#include "loads/facet_shares.hpp"
#include "support/make_law.hpp"

namespace {

using namespace kerf;
using kerf::test::make_law;
using kerf::test::RampTable;
using kerf::test::refusal;
using Corners = std::array<Vec3, 4>;

void expect_vector(Vec3 a, Vec3 b, double tolerance = 1e-15) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(MassDamping, is_against_the_velocity_and_has_factors) {
  kerf::test::RampTable curves;
  LoadedNode node;
  node.mass = 7.0;
  node.velocity = {1, -2, 3};
  expect_vector(make_law<BodyLoad>("load", "mass_damping", "{coefficient: 100 s-1}")->acceleration(node, 0.0),
                {-100, 200, -300}, 0.0);
  const auto law = make_law<BodyLoad>("load", "mass_damping", "{coefficient: 100, factors: [1, 0, 0.5], curve: ramp}",
                                      curves.table());
  expect_vector(law->acceleration(node, 1.0), {}, 0.0);
  expect_vector(law->acceleration(node, 1.5), {-100, 0, -150}, 1e-12);
  EXPECT_FALSE(law->greatest().has_value());
  EXPECT_EQ(make_law<BodyLoad>("load", "mass_damping", "{coefficient: 1, factors: [0, 0, 0]}")->greatest(), 0.0);
  EXPECT_THAT(refusal("load", "mass_damping", "{coefficient: -1}"), ::testing::HasSubstr("coefficient"));
  EXPECT_THAT(refusal("load", "mass_damping", "{coefficient: 1, factors: [1, -1, 1]}"),
              ::testing::HasSubstr("factors"));
}

TEST(Pressure, is_a_constant_times_its_curve) {
  RampTable curves;
  const auto load =
      make_law<FacetLoad>("load", "pressure", "{facets: [top, rim], pressure: 3 MPa, curve: ramp}", curves.table());
  EXPECT_THAT(load->targets(), ::testing::ElementsAre("top", "rim"));
  EXPECT_FALSE(load->follows_erosion());
  EXPECT_EQ(load->greatest(), 6e6);
  EXPECT_EQ(load->force({}, 0.0).pressure, 0.0);
  EXPECT_EQ(load->force({}, 1.5).pressure, 3e6);
  expect_vector(load->force({}, 1.5).traction, {0, 0, 0}, 0.0);
  const auto plain = make_law<FacetLoad>("load", "pressure", "{facets: top, pressure: -2, follow_erosion: true}");
  EXPECT_TRUE(plain->follows_erosion());
  EXPECT_EQ(plain->greatest(), 2.0);
  EXPECT_EQ(plain->force({}, 9.0).pressure, -2.0);
}

TEST(Pressure, needs_facets) {
  EXPECT_THAT(refusal("load", "pressure", "{facets: [], pressure: 1}"),
              ::testing::HasSubstr("at least one part or set"));
  EXPECT_THAT(refusal("load", "pressure", "{pressure: 1}"),
              ::testing::HasSubstr("the required key `facets` is missing"));
}

TEST(Gravity, accelerates_all_nodes_alike) {
  RampTable curves;
  const auto load =
      make_law<BodyLoad>("load", "gravity", "{acceleration: \"[3, 0, -4] m/s2\", curve: ramp}", curves.table());
  EXPECT_TRUE(load->targets().empty());
  EXPECT_EQ(load->greatest(), 10.0);
  expect_vector(load->acceleration({}, 1.5), {3, 0, -4}, 0.0);
  expect_vector(load->acceleration({}, 2.5), {6, 0, -8}, 0.0);
  expect_vector(make_law<BodyLoad>("load", "gravity", "{acceleration: [0, 1, 0]}")->acceleration({}, 0.0), {0, 1, 0},
                0.0);
}

TEST(NodalForce, pushes_each_node) {
  RampTable curves;
  const auto load =
      make_law<NodalLoad>("load", "nodal_force", "{nodes: tip, force: \"[0, 2, 0] kN\", curve: ramp}", curves.table());
  EXPECT_EQ(load->greatest(), 4000.0);
  expect_vector(load->force({}, 1.25), {0, 1000, 0}, 0.0);
  EXPECT_THAT(refusal("load", "nodal_force", "{nodes: [], force: [0, 1, 0]}"),
              ::testing::HasSubstr("at least one part or set"));
}

TEST(FacetShares, are_quarters_of_a_parallelogram) {
  const Corners x = {Vec3{0, 0, 1}, Vec3{2, 0, 1}, Vec3{3, 4, 1}, Vec3{1, 4, 1}};
  for (const Vec3 share : facet_shares(x)) expect_vector(share, {0, 0, 2});
}

TEST(FacetShares, are_thirds_of_a_triangle) {
  const Corners x = {Vec3{0, 0, 0}, Vec3{3, 0, 0}, Vec3{0, 4, 0}, Vec3{0, 4, 0}};
  const auto shares = facet_shares(x);
  expect_vector(shares[0], {0, 0, 2});
  expect_vector(shares[1], {0, 0, 2});
  expect_vector(shares[2] + shares[3], {0, 0, 2});
}

/// The volume under a bilinear facet, towards the origin: a third of the integral of x . n dA, by Gauss's rule of two
/// points each way, which is exact for it.
double volume_under(const Corners& x) {
  double volume = 0.0;
  const double g = 1.0 / std::sqrt(3.0);
  constexpr double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (const double s : {-g, g})
    for (const double t : {-g, g}) {
      Vec3 p, along_s, along_t;
      for (std::size_t a = 0; a < 4; ++a) {
        const double cs = corner[a][0], ct = corner[a][1];
        p = p + x[a] * (0.25 * (1 + cs * s) * (1 + ct * t));
        along_s = along_s + x[a] * (0.25 * cs * (1 + ct * t));
        along_t = along_t + x[a] * (0.25 * ct * (1 + cs * s));
      }
      volume += dot(p, cross(along_s, along_t)) / 3.0;
    }
  return volume;
}

// The work of a pressure is that of the volume that it displaces: dV = sum of share . dx over the faces of a body. For
// one facet that moves within its edges' cones, the sides of the cone move along; so a closed body is moved here.
TEST(FacetShares, of_a_closed_body_are_the_derivatives_of_its_volume) {
  constexpr int face[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  std::array<Vec3, 8> x = {Vec3{0, 0.1, 0},      Vec3{1.2, 0, 0.1},  Vec3{1, 1.1, -0.2}, Vec3{-0.1, 0.9, 0},
                           Vec3{0.05, 0.1, 1.1}, Vec3{0.9, -0.1, 1}, Vec3{1.2, 1, 1.3},  Vec3{0, 1.2, 0.8}};
  const auto corners = [&](int f) { return Corners{x[face[f][0]], x[face[f][1]], x[face[f][2]], x[face[f][3]]}; };
  const auto volume = [&] {
    double sum = 0.0;
    for (int f = 0; f < 6; ++f) sum += volume_under(corners(f));
    return sum;
  };
  std::array<Vec3, 8> share{};
  Vec3 whole;
  for (int f = 0; f < 6; ++f) {
    const auto shares = facet_shares(corners(f));
    for (std::size_t a = 0; a < 4; ++a) {
      share[static_cast<std::size_t>(face[f][a])] = share[static_cast<std::size_t>(face[f][a])] + shares[a];
      whole = whole + shares[a];
    }
  }
  expect_vector(whole, {0, 0, 0}, 1e-15);
  for (std::size_t n = 0; n < 8; ++n)
    for (int d = 0; d < 3; ++d) {
      // The volume is linear in each coordinate: a difference is exact but for round-off.
      x[n][d] += 0.5;
      const double above = volume();
      x[n][d] -= 1.0;
      const double below = volume();
      x[n][d] += 0.5;
      EXPECT_NEAR(share[n][d], above - below, 1e-14) << "node " << n << ", axis " << d;
    }
}

}  // namespace
