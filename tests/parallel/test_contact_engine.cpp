// The contact engine against brute force: whatever moves, however fast, whatever dies and wherever it lives, the
// forces are those of all slaves against all facets, to the last bit.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "parallel/communicator.hpp"
#include "parallel/lookout.hpp"
#include "parallel/scene.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;

/// Two blocks above one another and a strip that is bent until its ends overlap; limp, so that any motion will do. All
/// of it `offset` away from the origin along each axis.
std::string limp_bodies(const std::string& contact, int force_interval, double offset) {
  const auto moved = [offset](double x, double y, double z) {
    return fmt::format("[{}, {}, {}]", x + offset, y + offset, z + offset);
  };
  return R"(
time: {end: 6e-6, safety_factor: 1}
materials:
  limp:
    density: 7850
    strength: {type: elastic, shear_modulus: 80e9}
    eos: {type: linear, bulk_modulus: 160e9}
    erosion: {criteria: [{type: fuse}]}
parts:
  lower:
    material: limp
    element: {type: limp}
    mesh: {type: block, size: [5e-3, 5e-3, 2e-3], cells: [5, 5, 2]}
    placement: [{translate: )" +
         moved(0.0, 0.0, 0.0) + R"(}]
  upper:
    material: limp
    element: {type: limp}
    mesh: {type: block, size: [3e-3, 3e-3, 3e-3], cells: [4, 3, 3]}
    placement: [{angle: 0.3, translate: )" +
         moved(1.2e-3, 0.5e-3, 2.2e-3) + R"(}]
  strip:
    material: limp
    element: {type: limp}
    mesh: {type: block, size: [16e-3, 2e-3, 1e-3], cells: [16, 2, 1]}
    placement: [{translate: )" +
         moved(0.0, 8e-3, 0.0) + R"(}]
balance: {force_interval: )" +
         std::to_string(force_interval) + "}\ncontacts:\n  - " + contact + "\n";
}

/// Wild bodies leave nothing where it was; of calm ones most nodes rest or glide, so that boxes are kept for long; of
/// stretched ones the strip becomes three times as long, so that its facets are larger than their elements ever were.
enum class Mood { wild, calm, stretched };

/// Moves all copies of all nodes along paths that are functions of node and time alone.
class Puppeteer final : public StepObserver {
 public:
  Puppeteer(const Simulation& simulation, std::uint64_t seed, Mood mood, double offset)
      : simulation_(simulation), seed_(seed), mood_(mood), offset_{offset, offset, offset} {
    for (std::int64_t id = 0; id < simulation.model().n_nodes; ++id)
      start_.push_back(test::generated_position(simulation.model(), id) - offset_);
  }

  ForceComparison comparison;
  std::size_t n_candidates = 0;  // of this rank, added up over the run

  void before_forces(Model& model, const Step& step) override {
    for (int i = 0; i < model.nodes.n(); ++i) {
      const Vec3 from = path(model, i, step.start), to = path(model, i, step.end());
      model.nodes.set_x(i, to);
      model.nodes.set_v(i, (to - from) * (1.0 / step.dt));
    }
  }
  void after_forces(Model&, const Step& step) override {
    if (step.cycle % 2 == 0) compare_contact_forces(simulation_, step, comparison);
    n_candidates += simulation_.contacts().front()->n_candidates();
  }

 private:
  /// To and fro at constant speed.
  static double sway(double time, double period) {
    return 4.0 * std::fabs(time / period - std::floor(time / period) - 0.5) - 1.0;
  }
  /// Time that stands still and then catches up, within every 0.9 us: a search during the rest cannot foresee the dash.
  static double fitful(double time) {
    constexpr double period = 0.9e-6, rest = 0.6;
    const double whole = std::floor(time / period), part = time / period - whole;
    return period * (whole + (part < rest ? 0.0 : (part - rest) / (1.0 - rest)));
  }

  Vec3 path(const Model& model, int i, double time) const {
    return offset_ + (mood_ == Mood::wild ? wild_path(model, i, time) : calm_path(model, i, time));
  }
  /// The upper body, pressed into the lower one, glides at 25 m/s; the strip's ends overlap; one node in ten shivers by
  /// fits.
  Vec3 calm_path(const Model& model, int i, double time) const {
    Vec3 to = start_[static_cast<std::size_t>(model.nodes.id[i])];
    const std::uint64_t item = static_cast<std::uint64_t>(model.nodes.id[i]) * 4;
    if (model.nodes.part[i] == 1) {
      to.z -= 0.45e-3;
      to.x += 25.0 * time;
    } else if (model.nodes.part[i] == 2) {
      const double stretch = mood_ == Mood::stretched ? 1.0 + 2.0 * time / 6e-6 : 1.0;
      to.x *= stretch;
      to = bent(to, 2.0 * 3.14159265358979 / 16e-3 * 1.1 / stretch);
    }
    if (scatter(seed_ + 7, item) > 0.1) return to;
    for (std::uint64_t d = 0; d < 3; ++d)
      to[static_cast<int>(d)] +=
          0.08e-3 * sway(fitful(time + 3e-6 * scatter(seed_ + 5, item)) + 3e-6 * scatter(seed_ + 6, item + d), 1.4e-6);
    return to;
  }
  static Vec3 bent(Vec3 x, double curvature) {
    const double r = 1.0 / curvature - x.z;
    return {r * std::sin(curvature * x.x), x.y, 1.0 / curvature - r * std::cos(curvature * x.x)};
  }
  Vec3 wild_path(const Model& model, int i, double time) const {
    const Vec3 x = start_[static_cast<std::size_t>(model.nodes.id[i])];
    const std::uint64_t item = static_cast<std::uint64_t>(model.nodes.id[i]) * 4;
    const double t = fitful(time);
    Vec3 to = x;
    if (model.nodes.part[i] == 1) {
      // Down by up to 0.7 mm and sideways, at rest and then at up to 5000 m/s.
      to.z += 0.35e-3 * (sway(t, 0.7e-6) - 1.0);
      to.x += 1.2e-3 * sway(t, 1.7e-6 + 0.5e-6 * scatter(seed_, 1));
      to.y += 0.8e-3 * sway(t, 2.3e-6 + 0.5e-6 * scatter(seed_, 2));
    } else if (model.nodes.part[i] == 2) {
      // Bent to a ring whose ends overlap at the end.
      to = bent(x, 2.0 * 3.14159265358979 / 16e-3 * (0.85 + 0.25 * sway(t, 5e-6)));
    }
    // A shiver of its own for every node.
    for (std::uint64_t d = 0; d < 3; ++d)
      to[static_cast<int>(d)] += 0.08e-3 * sway(t + 3e-6 * scatter(seed_ + 5, item + d), 0.7e-6);
    return to;
  }

  const Simulation& simulation_;
  std::uint64_t seed_;
  Mood mood_;
  Vec3 offset_;
  std::vector<Vec3> start_;  // by node id
};

struct Looks {
  ContactEngine::Counts counts;
  std::size_t n_candidates = 0;  // of this rank, added up over the run
};

Looks expect_brute_forces(const std::string& contact, std::uint64_t seed, bool deaths, int force_interval,
                          Mood mood = Mood::wild, double offset = 0.0) {
  const auto input = scene(limp_bodies(contact, force_interval, offset));
  Simulation simulation(MPI_COMM_WORLD, *input);
  if (deaths)
    light_fuses(simulation.model(), [&](std::int64_t id) {
      const auto item = static_cast<std::uint64_t>(id) * 2;
      return scatter(seed, item) < 0.5 ? std::floor(1.0 + 60.0 * scatter(seed, item + 1)) : 1e9;
    });
  Puppeteer puppeteer(simulation, seed, mood, offset);
  simulation.observe(puppeteer);
  simulation.run();
  const Looks looks{simulation.contacts().front()->counts(), puppeteer.n_candidates};
  if (rank_of(MPI_COMM_WORLD) != 0) return looks;
  const ForceComparison& c = puppeteer.comparison;
  EXPECT_EQ(c.n_different, 0) << "of " << c.n_looks << " looks, seed " << seed << "; first in " << c.first_difference;
  EXPECT_GT(c.n_loaded, 5 * c.n_looks) << "the bodies hardly touch";
  if (mood == Mood::wild && contact.find("eroding_surface") != std::string::npos) {
    EXPECT_GT(c.n_edges, c.n_looks / 5) << "edges hardly touch";
  }
  return looks;
}

TEST(ContactEngine, misses_no_pair_of_eroding_surfaces) {
  expect_brute_forces("{type: eroding_surface, friction: 0.2}", 1, false, 0);
}

TEST(ContactEngine, misses_no_pair_while_elements_die) {
  expect_brute_forces("{type: eroding_surface}", 2, true, 0);
  expect_brute_forces("{type: eroding_surface, search_interval: 25}", 3, true, 0);
}

TEST(ContactEngine, misses_no_pair_while_elements_die_and_move_between_ranks) {
  expect_brute_forces("{type: eroding_surface}", 4, true, 7);
}

TEST(ContactEngine, misses_no_pair_while_boxes_are_kept_and_renewed) {
  for (std::uint64_t seed = 10; seed < 13; ++seed) {
    const auto counts =
        expect_brute_forces("{type: eroding_surface, search_interval: 3}", seed, seed % 2 == 0, 0, Mood::calm).counts;
    // On five ranks slaves leave their ranks' boxes of space sooner, which takes a search.
    EXPECT_GT(counts.renewals, counts.searches) << "renewals seldom follow each other";
    EXPECT_GT(counts.refreshes, 0);
  }
  const auto counts = expect_brute_forces("{type: slide_surface, slave: upper, master: lower, search_interval: 3}", 13,
                                          false, 0, Mood::calm)
                          .counts;
  EXPECT_GT(counts.renewals, 0);
}

TEST(ContactEngine, misses_no_pair_of_facets_that_are_stretched) {
  for (const char* contact : {"{type: eroding_surface}", "{type: eroding_surface, search_interval: 30}"})
    expect_brute_forces(contact, 14, true, 5, Mood::stretched);
}

// Boxes in single precision would be as wide as the bodies here, 1 km from the origin, if they were taken from there.
TEST(ContactEngine, misses_no_pair_far_from_the_origin_and_looks_at_no_more) {
  for (const char* contact :
       {"{type: eroding_surface, friction: 0.2}", "{type: slide_surface, slave: upper, master: lower}"})
    for (const Mood mood : {Mood::wild, Mood::calm}) {
      const Looks near = expect_brute_forces(contact, 15, false, 5, mood);
      const Looks far = expect_brute_forces(contact, 15, false, 5, mood, 1000.0);
      // Round-off of positions, 1e-13 m, decides about few boxes. On several ranks it may also decide when slaves that
      // leave their rank's box of space call for a search.
      if (size_of(MPI_COMM_WORLD) > 1) continue;
      EXPECT_LT(static_cast<double>(far.n_candidates), 1.02 * static_cast<double>(near.n_candidates)) << contact;
      EXPECT_EQ(far.counts.searches, near.counts.searches) << contact;
    }
}

// What a facet may push must not be nearer to a coarse element's side than to the flat skin that lies between.
TEST(ContactEngine, finds_nobody_inside_a_flat_skin_over_coarse_elements) {
  for (const char* skin : {"10.2e-3", "10.5e-3", "11e-3"})
    for (const char* gap : {"1e-3", "1.5e-3", "1.86e-3", "2.5e-3"}) {
      const auto input = scene(std::string(R"(
time: {end: 1e-6}
materials:
  steel: {density: 7805, strength: {type: elastic, shear_modulus: 80e9}, eos: {type: linear, bulk_modulus: 163e9}}
parts:
  striker:
    material: steel
    mesh: {type: block, size: [3e-3, 3e-3, 8e-3], origin: [6.9e-3, -1.2e-3, 0], cells: [6, 6, 16]}
    placement: [{translate: [0, 0, )") +
                               gap + R"(]}]
  plate:
    material: steel
    mesh:
      type: block
      size: [20e-3, 20e-3, )" + skin +
                               R"(]
      origin: [-10e-3, -10e-3, -)" +
                               skin + R"(]
      cells: [4, 4, 2]
      grading_z: [{to: 10e-3, cells: 2}, {to: )" +
                               skin + R"(, cells: 1}]
contacts: [{type: eroding_surface}]
)");
      EXPECT_NO_THROW(Simulation(MPI_COMM_WORLD, *input)) << "skin up to " << skin << ", gap " << gap;
    }
}

TEST(ContactEngine, misses_no_pair_without_self_contact) {
  expect_brute_forces("{type: eroding_surface, self_contact: false, parts: [lower, upper]}", 5, true, 11);
}

TEST(ContactEngine, misses_no_pair_of_slide_surfaces) {
  expect_brute_forces("{type: slide_surface, slave: upper, master: lower, friction: 0.1}", 6, false, 0);
  expect_brute_forces("{type: slide_surface, slave: upper, master: lower, symmetric: true}", 7, false, 9);
}

}  // namespace
