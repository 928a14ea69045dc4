// No node passes through a live facet: random blocks that strike each other, looked at by brute force as they do.
//
// Depths are in units of the least of a facet's thickness, longest edge and that of the undeformed one. Contact stops a
// node at the surface, as far as the rounds of a step come to agree, and eroding_surface lets go of what is deeper than
// 0.6. Cells at the corners of turned blocks are flattened, so that little counts for much there. Where elements vanish
// at random, a node is found as deep as it then lies, and is held there: nothing pushes it out that it has not brought
// in.
#include <gtest/gtest.h>

#include <ostream>

#include "parallel/communicator.hpp"
#include "parallel/flight.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;
using Deletion = Flight::Deletion;

struct Kind {
  const char* name;
  Flight flight;
  double deepest;  // no intruder may be deeper
  double letting_go = 0.01;  // share of sightings in which the law may leave an intruder alone
};
void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

Flight flight(double speed, bool aligned, bool plastic, Deletion deletion, int n_bodies = 2,
              const char* contact = "{type: eroding_surface}") {
  Flight f;
  f.speed = speed;
  f.aligned = aligned;
  f.plastic = plastic;
  f.deletion = deletion;
  f.n_bodies = n_bodies;
  f.contact = contact;
  return f;
}

constexpr const char* slide = "{type: slide_surface, slave: body_1, master: body_0, symmetric: true}";

class Flights : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(
    Random, Flights,
    testing::Values(Kind{"turned_500", flight(500, false, true, Deletion::none), 0.4},
                    Kind{"flat_500", flight(500, true, true, Deletion::none), 0.25},
                    Kind{"turned_500_eroding", flight(500, false, true, Deletion::strain), 0.25},
                    Kind{"flat_500_eroding", flight(500, true, true, Deletion::strain), 0.25},
                    Kind{"turned_500_deleted_at_random", flight(500, false, true, Deletion::random), 0.6},
                    Kind{"elastic_300_deleted_at_random", flight(300, false, false, Deletion::random), 0.6},
                    Kind{"elastic_500", flight(500, true, false, Deletion::none), 0.4},
                    Kind{"turned_1500_eroding", flight(1500, false, true, Deletion::strain), 0.6},
                    Kind{"flat_1500_eroding", flight(1500, true, true, Deletion::strain), 0.6},
                    Kind{"three_1000_eroding", flight(1000, false, true, Deletion::strain, 3), 0.6},
                    // The classical algorithm takes nodes to the segments round the nearest master node only.
                    Kind{"slide_flat_100", flight(100, true, true, Deletion::none, 2, slide), 0.15, 1.0},
                    Kind{"slide_turned_100", flight(100, false, true, Deletion::none, 2, slide), 0.15, 1.0}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(Flights, let_no_node_through_and_find_all_forces) {
  const int n_seeds = size_of(MPI_COMM_WORLD) == 1 ? 12 : 2;
  std::int64_t n_inside = 0, n_unpushed = 0, n_loaded = 0;
  for (int seed = 0; seed < n_seeds; ++seed) {
    Flight f = GetParam().flight;
    f.seed = static_cast<std::uint64_t>(seed);
    const FlightReport report = fly(f);
    if (rank_of(MPI_COMM_WORLD) != 0) continue;
    EXPECT_LT(report.deepest, GetParam().deepest) << "seed " << seed << "; " << report.worst;
    EXPECT_EQ(report.forces.n_different, 0) << "seed " << seed << "; " << report.forces.first_difference;
    n_inside += report.n_inside;
    n_unpushed += report.n_unpushed;
    n_loaded += report.forces.n_loaded;
  }
  if (rank_of(MPI_COMM_WORLD) != 0) return;
  EXPECT_GT(n_loaded, 50 * n_seeds) << "the bodies hardly touch";
  // Two seeds are too few for a share: one node that is let go is seen a few dozen times.
  if (n_seeds > 2) {
    EXPECT_LE(static_cast<double>(n_unpushed), GetParam().letting_go * static_cast<double>(n_inside))
        << "of " << n_inside << " sightings";
  }
}

TEST(Flight, ends_with_the_same_bits_on_one_rank_and_on_all) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Flight f = flight(1200, seed % 2 == 0, true, seed < 2 ? Deletion::strain : Deletion::random, 3);
    f.seed = seed;
    f.look_interval = 0;
    const FlightReport alone = fly(f, MPI_COMM_SELF);
    EXPECT_GT(alone.n_eroded, 3);
    for (const int force_interval : {0, 3}) {
      f.force_interval = force_interval;
      const FlightReport together = fly(f);
      EXPECT_EQ(alone.state_hash, together.state_hash) << "seed " << seed << ", re-balanced every " << force_interval;
      EXPECT_EQ(alone.n_eroded, together.n_eroded) << "seed " << seed << ", re-balanced every " << force_interval;
    }
  }
}

}  // namespace
