// The output room: exchange into global order, results, tables, summary and restart, on any number of ranks.
#include <gtest/gtest.h>
#include <mpi.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "erosion/record.hpp"
#include "model/accounts.hpp"
#include "output/collective.hpp"
#include "output/hdf5_file.hpp"
#include "output/history.hpp"
#include "output/restart.hpp"
#include "output/results.hpp"
#include "output/slab.hpp"
#include "output/summary.hpp"
#include "report/erosion_log.hpp"
#include "support/hdf5_reader.hpp"

namespace kerf {
namespace {

namespace fs = std::filesystem;
using Ids = std::vector<std::int64_t>;

/// Starts MPI where the program's main() has not.
class MpiEnvironment : public testing::Environment {
 public:
  void SetUp() override {
    int started = 0;
    MPI_Initialized(&started);
    if (started) return;
    MPI_Init(nullptr, nullptr);
    started_here_ = true;
  }
  void TearDown() override {
    if (started_here_) MPI_Finalize();
  }

 private:
  bool started_here_ = false;
};
const auto* const environment = testing::AddGlobalTestEnvironment(new MpiEnvironment);

int rank_of(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

int size_of(MPI_Comm comm) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  return size;
}

/// A folder that all ranks share; removed afterwards unless KERF_TEST_OUTPUT names one to keep.
class OutputTest : public testing::Test {
 protected:
  void SetUp() override {
    char name[1024] = "/tmp/kerf_output_test_XXXXXX";
    if (rank == 0) {
      const char* wanted = std::getenv("KERF_TEST_OUTPUT");
      if (wanted != nullptr) {
        std::snprintf(name, sizeof name, "%s", wanted);
        fs::create_directories(wanted);
      } else {
        ASSERT_NE(mkdtemp(name), nullptr);
      }
      keep_ = wanted != nullptr;
    }
    MPI_Bcast(name, sizeof name, MPI_CHAR, 0, MPI_COMM_WORLD);
    folder_ = name;
  }
  void TearDown() override {
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank == 0 && !keep_) fs::remove_all(folder_);
  }
  std::string path(const std::string& name) const { return folder_ / name; }

  const int rank = rank_of(MPI_COMM_WORLD), n_ranks = size_of(MPI_COMM_WORLD);

 private:
  fs::path folder_;
  bool keep_ = false;
};

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Owner of an entity in a division that mixes everything and changes with `seed`.
int scattered_owner(std::int64_t gid, int n_ranks, int seed) {
  return static_cast<int>((static_cast<std::uint64_t>(gid) * 2654435761u + static_cast<std::uint64_t>(seed) * 40503u) %
                          1000003u % static_cast<std::uint64_t>(n_ranks));
}

/// The ids of this rank in that division, in an order of their own; `keep` says which entities exist.
template <class Keep>
Ids held_ids(std::int64_t n, int rank, int n_ranks, int seed, Keep&& keep) {
  Ids ids;
  for (std::int64_t gid = n - 1; gid >= 0; --gid)
    if (keep(gid) && scattered_owner(gid, n_ranks, seed) == rank) ids.push_back(gid);
  return ids;
}
Ids held_ids(std::int64_t n, int rank, int n_ranks, int seed) {
  return held_ids(n, rank, n_ranks, seed, [](std::int64_t) { return true; });
}

// --- SlabExchange ------------------------------------------------------------------------------------------

using Slab = OutputTest;

template <class T>
void check_round_trip(std::int64_t n, int components, int rank, int n_ranks) {
  const auto exists = [](std::int64_t gid) { return gid % 3 != 1; };
  const Ids gids = held_ids(n, rank, n_ranks, components, exists);
  const SlabExchange plan(MPI_COMM_WORLD, n, gids);
  const auto value = [](std::int64_t gid, int c) { return static_cast<T>((gid * 5 + c) % 200); };
  std::vector<T> values;
  for (const std::int64_t gid : gids)
    for (int c = 0; c < components; ++c) values.push_back(value(gid, c));

  const std::vector<T> slab = plan.to_slab<T>(values, components, T(77));
  ASSERT_EQ(static_cast<std::int64_t>(slab.size()), plan.slab_size() * components);
  for (std::int64_t i = 0; i < plan.slab_size(); ++i) {
    const std::int64_t gid = plan.begin() + i;
    EXPECT_EQ(plan.present()[static_cast<std::size_t>(i)], exists(gid) ? 1 : 0);
    for (int c = 0; c < components; ++c)
      EXPECT_EQ(slab[static_cast<std::size_t>(i * components + c)], exists(gid) ? value(gid, c) : T(77));
  }
  EXPECT_EQ(plan.from_slab<T>(slab, components), values);

  // The same from where values stand in another order and with gaps.
  const auto stride = static_cast<std::size_t>(components) + 2;
  std::vector<T> apart(stride * gids.size(), T(55));
  std::vector<std::int32_t> row(gids.size());
  for (std::size_t i = 0; i < gids.size(); ++i) {
    row[i] = static_cast<std::int32_t>(gids.size() - 1 - i);
    for (int c = 0; c < components; ++c) apart[stride * static_cast<std::size_t>(row[i]) + c] = value(gids[i], c);
  }
  std::vector<T> from_rows(slab.size(), T(77));
  plan.update_slab<T>({apart.data(), gids.size(), stride, row.data()}, components, from_rows);
  EXPECT_EQ(from_rows, slab);
}

TEST_F(Slab, doubles_apart_become_floats_in_order) {
  const Ids gids = held_ids(200, rank, n_ranks, 1);
  const SlabExchange plan(MPI_COMM_WORLD, 200, gids);
  std::vector<double> rows(4 * gids.size(), -1.0);
  std::vector<std::int32_t> row(gids.size());
  for (std::size_t i = 0; i < gids.size(); ++i) {
    row[i] = static_cast<std::int32_t>((i + 1) % gids.size());
    for (std::size_t c = 0; c < 3; ++c)
      rows[4 * static_cast<std::size_t>(row[i]) + c] = static_cast<double>(gids[i]) / 3.0 + static_cast<double>(c);
  }
  std::vector<float> slab(3 * static_cast<std::size_t>(plan.slab_size()));
  plan.update_slab<float, double>({rows.data(), gids.size(), 4, row.data()}, 3, slab);
  for (std::size_t i = 0; i < slab.size(); ++i) {
    const double gid = static_cast<double>(plan.begin() + static_cast<std::int64_t>(i / 3));
    EXPECT_EQ(slab[i], static_cast<float>(gid / 3.0 + static_cast<double>(i % 3)));
  }
}

TEST_F(Slab, values_come_back_for_every_type_and_number_of_components) {
  for (const std::int64_t n : {0, 1, 2, 7, 500}) {
    check_round_trip<double>(n, 3, rank, n_ranks);
    check_round_trip<float>(n, 1, rank, n_ranks);
    check_round_trip<std::int64_t>(n, 8, rank, n_ranks);
    check_round_trip<std::int32_t>(n, 2, rank, n_ranks);
    check_round_trip<std::uint8_t>(n, 1, rank, n_ranks);
  }
}

TEST_F(Slab, slabs_tile_the_ids_and_owners_agree_with_them) {
  for (const std::int64_t n : {1, 2, 7, 100, 1001})
    for (const int ranks : {1, 2, 3, 7, 64, 2000}) {
      EXPECT_EQ(SlabExchange::slab_begin(n, 0, ranks), 0);
      EXPECT_EQ(SlabExchange::slab_begin(n, ranks, ranks), n);
      for (std::int64_t gid = 0; gid < n; ++gid) {
        const int owner = SlabExchange::slab_owner(n, gid, ranks);
        EXPECT_LE(SlabExchange::slab_begin(n, owner, ranks), gid);
        EXPECT_GT(SlabExchange::slab_begin(n, owner + 1, ranks), gid);
      }
    }
}

TEST_F(Slab, entries_that_nobody_holds_keep_their_value_in_an_update) {
  const Ids all = held_ids(50, rank, n_ranks, 1);
  const SlabExchange first(MPI_COMM_WORLD, 50, all);
  std::vector<double> ones(all.size(), 1.0);
  std::vector<double> slab = first.to_slab<double>(ones, 1, 0.0);
  const Ids even = held_ids(50, rank, n_ranks, 2, [](std::int64_t gid) { return gid % 2 == 0; });
  std::vector<double> twos(even.size(), 2.0);
  SlabExchange(MPI_COMM_WORLD, 50, even).update_slab<double>(HeldValues<double>::in_order(twos, 1), 1, slab);
  for (std::size_t i = 0; i < slab.size(); ++i)
    EXPECT_EQ(slab[i], (first.begin() + static_cast<std::int64_t>(i)) % 2 == 0 ? 2.0 : 1.0);
}

TEST_F(Slab, bad_ids_are_refused_on_all_ranks) {
  const bool last = rank == n_ranks - 1;
  EXPECT_THROW(SlabExchange(MPI_COMM_WORLD, 10, last ? Ids{10} : Ids{}), std::invalid_argument);
  EXPECT_THROW(SlabExchange(MPI_COMM_WORLD, 10, last ? Ids{-1} : Ids{}), std::invalid_argument);
  EXPECT_THROW(SlabExchange(MPI_COMM_WORLD, 10, last ? Ids{3, 3} : Ids{}), std::invalid_argument);
  if (n_ranks > 1) {
    EXPECT_THROW(SlabExchange(MPI_COMM_WORLD, 10, Ids{4}), std::invalid_argument);
  }
}

TEST_F(Slab, a_cached_plan_is_rebuilt_when_one_rank_changes) {
  SlabExchangeCache cache;
  const Ids gids = held_ids(40, rank, n_ranks, 1);
  cache.get(MPI_COMM_WORLD, 40, gids);
  // The last rank loses one id; the others' ids stay.
  Ids fewer = gids;
  if (rank == n_ranks - 1) fewer.pop_back();
  const SlabExchange& plan = cache.get(MPI_COMM_WORLD, 40, fewer);
  std::int64_t present = std::ranges::count(plan.present(), 1);
  MPI_Allreduce(MPI_IN_PLACE, &present, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
  EXPECT_EQ(present, 39);
}

// --- ResultsWriter -----------------------------------------------------------------------------------------

/// A row of cubes along x; node 4 i + j is corner j of cross-section i.
struct Bar {
  std::int64_t n_elements;
  std::int64_t n_nodes() const { return 4 * (n_elements + 1); }
  Ids nodes_of(std::int64_t element) const {
    const std::int64_t a = 4 * element, b = a + 4;
    return {a, b, b + 1, a + 1, a + 3, b + 3, b + 2, a + 2};
  }
  static double x(std::int64_t node, int frame) { return static_cast<double>(node / 4) * (1.0 + 0.5 * frame); }
  static double y(std::int64_t node) { return node % 4 == 1 || node % 4 == 2 ? 1.0 : 0.0; }
  static double z(std::int64_t node) { return node % 4 >= 2 ? 1.0 : 0.0; }
  /// From frame 2 on, elements divisible by five are dead.
  static bool lives(std::int64_t element, int frame) { return frame < 2 || element % 5 != 0; }
  /// From frame 3 on, the last cross-section is dropped from the model.
  bool has_node(std::int64_t node, int frame) const { return frame < 3 || node / 4 < n_elements; }
  static double stress(std::int64_t element, int c, int frame) {
    return static_cast<double>(element * 10 + c) + 0.25 * frame;
  }
};

void write_topology(ResultsWriter& writer, const Bar& bar, int rank, int n_ranks) {
  const Ids elements = held_ids(bar.n_elements, rank, n_ranks, 0);
  std::vector<ElementNodeIds> nodes;
  std::vector<std::int32_t> parts;
  for (const std::int64_t e : elements) {
    const Ids corners = bar.nodes_of(e);
    std::copy(corners.begin(), corners.end(), nodes.emplace_back().begin());
    parts.push_back(e < bar.n_elements / 2 ? 0 : 1);
  }
  writer.write_topology(elements, nodes, parts,
                        {{"rod", bar.n_elements / 2}, {"plate", bar.n_elements - bar.n_elements / 2}});
}

void write_frame(ResultsWriter& writer, const Bar& bar, int frame, int rank, int n_ranks, bool finish = true) {
  // The division changes with every frame, as re-balancing makes it do.
  const Ids nodes = held_ids(bar.n_nodes(), rank, n_ranks, frame, [&](auto n) { return bar.has_node(n, frame); });
  const Ids live = held_ids(bar.n_elements, rank, n_ranks, frame, [&](auto e) { return Bar::lives(e, frame); });
  std::vector<double> positions, speed, stress;
  for (const std::int64_t n : nodes) {
    positions.insert(positions.end(), {Bar::x(n, frame), Bar::y(n), Bar::z(n)});
    speed.push_back(static_cast<double>(n) + frame);
  }
  for (const std::int64_t e : live)
    for (int c = 0; c < 6; ++c) stress.push_back(Bar::stress(e, c, frame));
  writer.begin_frame(1e-6 * frame);
  writer.add_points(nodes, HeldValues<double>::in_order(positions, 3));
  writer.add_node_field("speed", 1, nodes, HeldValues<double>::in_order(speed, 1));
  writer.add_element_field("stress", 6, live, HeldValues<double>::in_order(stress, 6));
  writer.add_alive(live);
  if (finish) writer.end_frame();
}

std::int64_t frames_in(const std::string& path) { return read_number(path, "VTKHDF/Steps", "NSteps"); }

template <class T>
void check_frames(const std::string& path, const Bar& bar, int n_frames) {
  ASSERT_EQ(frames_in(path), n_frames);
  const auto points = read_table<T>(path, "VTKHDF/Points");
  const auto speed = read_table<T>(path, "VTKHDF/PointData/speed");
  const auto stress = read_table<T>(path, "VTKHDF/CellData/stress");
  const auto alive = read_table<std::uint8_t>(path, "VTKHDF/CellData/alive");
  const auto ghost = read_table<std::uint8_t>(path, "VTKHDF/CellData/vtkGhostType");
  const auto times = read_table<double>(path, "VTKHDF/Steps/Values");
  ASSERT_GE(static_cast<std::int64_t>(points.size()), n_frames * bar.n_nodes() * 3);
  ASSERT_GE(static_cast<std::int64_t>(stress.size()), n_frames * bar.n_elements * 6);
  for (int f = 0; f < n_frames; ++f) {
    EXPECT_EQ(times[static_cast<std::size_t>(f)], 1e-6 * f);
    for (std::int64_t n = 0; n < bar.n_nodes(); ++n) {
      const auto row = static_cast<std::size_t>(f * bar.n_nodes() + n);
      const int written = bar.has_node(n, f) ? f : 2;  // a dropped node stays where it was seen last
      EXPECT_EQ(points[3 * row], static_cast<T>(Bar::x(n, written)));
      EXPECT_EQ(points[3 * row + 1], static_cast<T>(Bar::y(n)));
      EXPECT_EQ(points[3 * row + 2], static_cast<T>(Bar::z(n)));
      EXPECT_EQ(speed[row], bar.has_node(n, f) ? static_cast<T>(static_cast<double>(n) + f) : T(0));
    }
    for (std::int64_t e = 0; e < bar.n_elements; ++e) {
      const auto row = static_cast<std::size_t>(f * bar.n_elements + e);
      EXPECT_EQ(alive[row], Bar::lives(e, f) ? 1 : 0);
      EXPECT_EQ(ghost[row], Bar::lives(e, f) ? 0 : 32);
      for (int c = 0; c < 6; ++c)
        EXPECT_EQ(stress[6 * row + static_cast<std::size_t>(c)],
                  Bar::lives(e, f) ? static_cast<T>(Bar::stress(e, c, f)) : T(0));
    }
  }
}

using Results = OutputTest;

TEST_F(Results, frames_are_stored_in_global_order_in_both_precisions) {
  const Bar bar{23};
  for (const bool double_precision : {false, true}) {
    const std::string file = path("results.vtkhdf");
    {
      ResultsWriter writer(MPI_COMM_WORLD, file, bar.n_nodes(), bar.n_elements, double_precision);
      write_topology(writer, bar, rank, n_ranks);
      for (int f = 0; f < 5; ++f) write_frame(writer, bar, f, rank, n_ranks);
    }
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank == 0) {
      double_precision ? check_frames<double>(file, bar, 5) : check_frames<float>(file, bar, 5);
      const auto connectivity = read_table<std::int64_t>(file, "VTKHDF/Connectivity");
      for (std::int64_t e = 0; e < bar.n_elements; ++e)
        EXPECT_TRUE(
            std::ranges::equal(bar.nodes_of(e), std::span(connectivity).subspan(static_cast<std::size_t>(8 * e), 8)));
      const auto offsets = read_table<std::int64_t>(file, "VTKHDF/Offsets");
      ASSERT_EQ(offsets.size(), 24u);
      EXPECT_EQ(offsets.back(), 8 * 23);
      EXPECT_EQ(read_table<std::int32_t>(file, "VTKHDF/CellData/part").back(), 1);
    }
    MPI_Barrier(MPI_COMM_WORLD);
  }
}

TEST_F(Results, parts_of_different_shapes_have_cells_of_their_own) {
  // Seven tetrahedra, three hexahedra and two tetrahedra; element e has the nodes 8 e, 8 e + 1, ...
  constexpr Shape tetrahedron{.name = "tetrahedron", .n_nodes = 4, .vtk_type = 10};
  const std::vector<ResultsWriter::PartTopology> parts = {
      {"first", 7, &tetrahedron}, {"second", 3, &hexahedron}, {"third", 2, &tetrahedron}};
  const std::string file = path("mixed.vtkhdf");
  const Ids elements = held_ids(12, rank, n_ranks, 0);
  {
    ResultsWriter writer(MPI_COMM_WORLD, file, 96, 12, true);
    std::vector<ElementNodeIds> nodes;
    std::vector<std::int32_t> part_of;
    for (const std::int64_t e : elements) {
      ElementNodeIds& n = nodes.emplace_back();
      for (std::size_t k = 0; k < n.size(); ++k) n[k] = 8 * e + static_cast<std::int64_t>(k);
      part_of.push_back(e < 7 ? 0 : e < 10 ? 1 : 2);
    }
    writer.write_topology(elements, nodes, part_of, parts);
    writer.begin_frame(0.0);
    const Ids held = held_ids(96, rank, n_ranks, 0);
    const std::vector<double> x(3 * held.size(), 1.0);
    writer.add_points(held, {x.data(), held.size(), 3, nullptr});
    writer.add_alive(elements);
    writer.end_frame();
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank == 0) {
    Ids nodes, offsets = {0};
    std::vector<std::uint8_t> types;
    for (std::int64_t e = 0; e < 12; ++e) {
      const bool is_brick = e >= 7 && e < 10;
      for (std::int64_t k = 0; k < (is_brick ? 8 : 4); ++k) nodes.push_back(8 * e + k);
      offsets.push_back(static_cast<std::int64_t>(nodes.size()));
      types.push_back(is_brick ? 12 : 10);
    }
    EXPECT_EQ(read_table<std::int64_t>(file, "VTKHDF/Connectivity"), nodes);
    EXPECT_EQ(read_table<std::int64_t>(file, "VTKHDF/Offsets"), offsets);
    EXPECT_EQ(read_table<std::uint8_t>(file, "VTKHDF/Types"), types);
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

TEST_F(Results, more_ranks_than_elements_and_frames_without_live_elements_work) {
  const Bar bar{1};
  const std::string file = path("results.vtkhdf");
  {
    ResultsWriter writer(MPI_COMM_WORLD, file, bar.n_nodes(), 1, false);
    write_topology(writer, bar, rank, n_ranks);
    for (int f = 0; f < 4; ++f) write_frame(writer, bar, f, rank, n_ranks);  // element 0 dies at frame 2
    writer.begin_frame(4e-6);
    writer.add_points({}, {});  // nobody holds anything any more
    writer.add_node_field("speed", 1, {}, {});
    writer.add_element_field("stress", 6, {}, {});
    writer.add_alive({});
    writer.end_frame();
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank == 0) {
    EXPECT_EQ(frames_in(file), 5);
    const auto points = read_table<float>(file, "VTKHDF/Points");
    ASSERT_EQ(points.size(), 5u * 8 * 3);
    // Nodes of the first section were last seen in frame 3, the others in frame 2.
    EXPECT_EQ(points[4 * 24 + 3 * 3 + 2], 1.0f);
    EXPECT_EQ(points[4 * 24 + 4 * 3], static_cast<float>(Bar::x(4, 2)));
  }
}

TEST_F(Results, a_file_that_is_cut_off_in_the_middle_of_a_frame_holds_the_frames_before) {
  const Bar bar{4000};
  const std::string file = path("results.vtkhdf"), copy = path("copy.vtkhdf");
  ResultsWriter writer(MPI_COMM_WORLD, file, bar.n_nodes(), bar.n_elements, false);
  write_topology(writer, bar, rank, n_ranks);
  for (int f = 0; f < 3; ++f) {
    write_frame(writer, bar, f, rank, n_ranks);
    write_frame(writer, bar, f + 1, rank, n_ranks, false);
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank == 0) {
      fs::copy_file(file, copy, fs::copy_options::overwrite_existing);
      check_frames<float>(copy, bar, f + 1);
    }
    MPI_Barrier(MPI_COMM_WORLD);
    // Start over from the frames that count, as a resumed run does.
    writer = ResultsWriter(MPI_COMM_WORLD, path("other.vtkhdf"), 0, 0, false);
    writer = ResultsWriter::reopen(MPI_COMM_WORLD, file, f + 1);
  }
}

TEST_F(Results, a_reopened_file_forgets_later_frames_and_goes_on) {
  const Bar bar{30};
  const std::string file = path("results.vtkhdf");
  {
    ResultsWriter writer(MPI_COMM_WORLD, file, bar.n_nodes(), bar.n_elements, false);
    write_topology(writer, bar, rank, n_ranks);
    for (int f = 0; f < 6; ++f) write_frame(writer, bar, f, rank, n_ranks);
  }
  for (const int keep : {5, 3}) {
    ResultsWriter writer = ResultsWriter::reopen(MPI_COMM_WORLD, file, keep);
    EXPECT_EQ(writer.n_frames(), keep);
    for (int f = keep; f < 5; ++f) write_frame(writer, bar, f, rank, n_ranks);
    EXPECT_EQ(writer.n_frames(), 5);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank == 0) {
    check_frames<float>(file, bar, 5);
    EXPECT_EQ(read_table<double>(file, "VTKHDF/Steps/Values").size(), 5u);
    EXPECT_EQ(read_table<float>(file, "VTKHDF/PointData/speed").size(), 5u * 124);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_THROW(ResultsWriter::reopen(MPI_COMM_WORLD, file, 6), std::runtime_error);
  EXPECT_THROW(ResultsWriter::reopen(MPI_COMM_WORLD, path("absent.vtkhdf"), 0), std::runtime_error);
}

TEST_F(Results, the_set_of_fields_is_fixed_by_the_first_frame) {
  const Bar bar{6};
  ResultsWriter writer(MPI_COMM_WORLD, path("results.vtkhdf"), bar.n_nodes(), bar.n_elements, false);
  EXPECT_THROW(writer.begin_frame(0.0), std::logic_error);  // no topology yet
  write_topology(writer, bar, rank, n_ranks);
  write_frame(writer, bar, 0, rank, n_ranks);
  writer.begin_frame(1.0);
  EXPECT_THROW(writer.add_element_field("late", 1, {}, {}), std::logic_error);
  writer.add_points({}, {});
  EXPECT_THROW(writer.end_frame(), std::logic_error);  // fields are missing
}

// The file that tests/python/test_vtkhdf.py opens with VTK.
TEST_F(Results, file_for_vtk) {
  const Bar bar{23};
  ResultsWriter writer(MPI_COMM_WORLD, path("for_vtk.vtkhdf"), bar.n_nodes(), bar.n_elements, false);
  write_topology(writer, bar, rank, n_ranks);
  for (int f = 0; f < 5; ++f) write_frame(writer, bar, f, rank, n_ranks);
  ResultsWriter second(MPI_COMM_WORLD, path("for_vtk_double.vtkhdf"), bar.n_nodes(), bar.n_elements, true);
  write_topology(second, bar, rank, n_ranks);
  for (int f = 0; f < 5; ++f) write_frame(second, bar, f, rank, n_ranks);
}

// --- history.csv and erosion.csv ---------------------------------------------------------------------------

using Tables = OutputTest;

TEST_F(Tables, history_has_units_and_numbers_that_read_back_to_the_same_bits) {
  const std::string file = path("history.csv");
  const double third = 1.0 / 3.0;
  {
    HistoryWriter history(MPI_COMM_WORLD, file, {{"time", "s"}, {"kinetic", "J"}, {"error", "-"}});
    history.write(std::vector{0.1, third, std::numeric_limits<double>::quiet_NaN()});
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank != 0) return;
  const std::string text = text_of(file);
  EXPECT_EQ(text, "time [s],kinetic [J],error [-]\n0.1,0.3333333333333333,nan\n");
  EXPECT_EQ(std::strtod("0.3333333333333333", nullptr), third);
}

TEST_F(Tables, history_goes_on_at_the_time_of_a_restart) {
  const std::string file = path("history.csv");
  const std::vector<HistoryColumn> columns{{"time", "s"}, {"kinetic", "J"}};
  {
    HistoryWriter history(MPI_COMM_WORLD, file, columns);
    for (int i = 0; i < 5; ++i) history.write(std::vector{0.1 * i, 1.0 * i});
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank == 0) std::ofstream(file, std::ios::app) << "0.05,12";  // a row that a crash cut off
  {
    HistoryWriter history = HistoryWriter::resume(MPI_COMM_WORLD, file, columns, 0.1 * 2);
    history.write(std::vector{0.25, 7.0});
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank == 0) {
    EXPECT_EQ(text_of(file), "time [s],kinetic [J]\n0,0\n0.1,1\n0.2,2\n0.25,7\n");
  }
  EXPECT_THROW(HistoryWriter::resume(MPI_COMM_WORLD, file, {{"time", "s"}}, 1.0), std::runtime_error);
  EXPECT_THROW(HistoryWriter::resume(MPI_COMM_WORLD, path("absent.csv"), columns, 1.0), std::runtime_error);
}

TEST_F(Tables, erosion_log_is_sorted_whoever_reports) {
  const std::string file = path("erosion.csv");
  {
    ErosionLog log(MPI_COMM_WORLD, file);
    for (const std::int64_t cycle : {10, 20}) {
      std::vector<ErosionRecord> local;
      for (std::int64_t e = 40; e > 30; --e)
        if (scattered_owner(e, n_ranks, 1) == rank)
          local.push_back(
              {0.5 * static_cast<double>(cycle), cycle, e, "rod, outer", "strain", 1.5, 1e-3, 2.0, 1000 + e});
      log.keep(local);
      log.keep({});
      if (cycle == 20) log.write();  // both cycles at once
    }
    log.write();  // of nothing
  }
  ErosionLog::resume(MPI_COMM_WORLD, file, 5.0);
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank != 0) return;
  std::istringstream lines(text_of(file));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "time [s],cycle,element,part,criterion,value,mass [kg],energy [J],element_id");
  for (int e = 31; e <= 40; ++e) {
    std::getline(lines, line);
    EXPECT_EQ(line, "5,10," + std::to_string(e) + ",\"rod, outer\",strain,1.5,0.001,2," + std::to_string(1000 + e));
  }
  EXPECT_FALSE(std::getline(lines, line));
}

// --- summary.json ------------------------------------------------------------------------------------------

using SummaryFile = OutputTest;

TEST_F(SummaryFile, has_the_keys_of_the_contract_and_null_for_what_is_not_a_number) {
  if (rank != 0) return;
  Summary s;
  s.ranks = 2;
  s.exit = "completed";
  for (const BookLine& line : book_lines())
    if ((line.places & in_energy) != 0) s.energy[line.name] = 1.0;
  s.energy["balance_error"] = std::numeric_limits<double>::quiet_NaN();
  s.momentum.final = {1.0, 2.0, 3.0};
  s.eroded.by_part["rod"] = 4;
  s.parts["rod"] = {10, 6, 0.5, {0.0, 0.0, -100.0}, 2500.0};
  s.measures["length"] = 0.1 + 0.2;
  s.timers["halo"] = {{1.0, 2.0, 3.0}, {0.5, 1.0, 1.5}};
  s.observers["nose"]["rows_without_value"] = 3.0;
  s.rebalances.push_back({100, 1.5, 1.01, 77, 0.25});
  write_summary(path("summary.json"), s);
  const auto json = nlohmann::json::parse(text_of(path("summary.json")));
  for (const char* key : {"kerf_version", "input", "ranks", "cycles", "end_time", "wall_seconds", "element_cycles",
                          "element_cycles_per_second", "state_hash", "exit", "energy", "momentum", "mass", "eroded",
                          "parts", "measures", "timers", "rebalances", "observers"})
    EXPECT_TRUE(json.contains(key)) << key;
  for (const char* key : {"initial", "kinetic", "internal", "hourglass", "bulk_viscosity", "contact", "external",
                          "eroded", "balance_error"})
    EXPECT_TRUE(json["energy"].contains(key)) << key;
  EXPECT_TRUE(json["energy"]["balance_error"].is_null());
  EXPECT_EQ(json["momentum"]["final"], nlohmann::json({1.0, 2.0, 3.0}));
  EXPECT_EQ(json["eroded"]["by_part"]["rod"], 4);
  EXPECT_EQ(json["parts"]["rod"]["velocity"][2], -100.0);
  EXPECT_EQ(json["measures"]["length"].get<double>(), 0.1 + 0.2);
  EXPECT_EQ(json["timers"]["halo"]["mean"], 2.0);
  EXPECT_EQ(json["timers"]["halo"]["work"]["max"], 1.5);
  EXPECT_EQ(json["observers"]["nose"]["rows_without_value"], 3.0);
  EXPECT_EQ(json["rebalances"][0]["elements_moved"], 77);
  EXPECT_FALSE(fs::exists(path("summary.json.part")));
}

// --- restart -----------------------------------------------------------------------------------------------

using Restart = OutputTest;

/// A bit pattern for every entity and component; negative zero, infinities and NaNs with payloads among them.
std::uint64_t bits_of(std::int64_t gid, int c) {
  if (gid == 5) return 0x8000000000000000u;
  if (gid == 8) return 0x7ff4dead0000beefu;
  return static_cast<std::uint64_t>(gid * 16 + c) * 0x9e3779b97f4a7c15u;
}
bool is_stored(std::int64_t gid) { return gid % 7 != 2; }

void write_restart(MPI_Comm comm, const std::string& file, std::int64_t n) {
  const Ids gids = held_ids(n, rank_of(comm), size_of(comm), 3, is_stored);
  std::vector<double> stress;
  Ids counters;
  for (const std::int64_t gid : gids) {
    for (int c = 0; c < 6; ++c) stress.push_back(std::bit_cast<double>(bits_of(gid, c)));
    counters.push_back(gid * 1000000007);
  }
  RestartWriter writer(comm, file);
  writer.write_entities("elements", n, gids, {{"stress", 6, stress.data()}, {"counter", 1, counters.data()}});
  writer.write_entities("nothing", 9, Ids{}, {{"stress", 6, static_cast<const double*>(nullptr)}});
  writer.write_attribute("time", 0.1 + rank_of(comm));  // the value of rank 0 counts
  writer.write_attribute("cycle", std::int64_t{1} << 40);
  writer.write_attribute("title", "a rod\nand a plate, 100 %");
  writer.write_attribute("empty", "");
  writer.write_attribute("history", std::vector<std::int64_t>{3, -1, 4});
  writer.write_attribute("none", std::vector<double>{});
  writer.finish();
}

void check_restart(MPI_Comm comm, const std::string& file, std::int64_t n) {
  RestartReader reader(comm, file);
  const RestartEntities elements = reader.read_entities("elements");
  Ids all;
  for (std::int64_t gid = 0; gid < n; ++gid)
    if (is_stored(gid)) all.push_back(gid);
  EXPECT_EQ(elements.n_global, n);
  EXPECT_EQ(elements.n_total, static_cast<std::int64_t>(all.size()));
  const auto begin = static_cast<std::size_t>(SlabExchange::slab_begin(elements.n_total, rank_of(comm), size_of(comm)));
  const auto end =
      static_cast<std::size_t>(SlabExchange::slab_begin(elements.n_total, rank_of(comm) + 1, size_of(comm)));
  ASSERT_EQ(elements.gids,
            Ids(all.begin() + static_cast<std::ptrdiff_t>(begin), all.begin() + static_cast<std::ptrdiff_t>(end)));
  const std::vector<double>& stress = elements.real("stress", 6);
  for (std::size_t i = 0; i < elements.gids.size(); ++i) {
    EXPECT_EQ(elements.integer("counter", 1)[i], elements.gids[i] * 1000000007);
    for (int c = 0; c < 6; ++c)
      EXPECT_EQ(std::bit_cast<std::uint64_t>(stress[i * 6 + static_cast<std::size_t>(c)]),
                bits_of(elements.gids[i], c));
  }
  EXPECT_THROW(elements.real("stress", 3), std::runtime_error);
  EXPECT_THROW(elements.real("strain", 6), std::runtime_error);
  EXPECT_EQ(reader.read_entities("nothing").n_total, 0);
  EXPECT_FALSE(reader.has_entities("nodes"));
  EXPECT_THROW(reader.read_entities("nodes"), std::runtime_error);
  EXPECT_EQ(reader.real("time"), 0.1);
  EXPECT_EQ(reader.integer("cycle"), std::int64_t{1} << 40);
  EXPECT_EQ(reader.text("title"), "a rod\nand a plate, 100 %");
  EXPECT_EQ(reader.text("empty"), "");
  EXPECT_EQ(reader.integers("history"), (Ids{3, -1, 4}));
  EXPECT_TRUE(reader.reals("none").empty());
  EXPECT_FALSE(reader.has_attribute("absent"));
  EXPECT_THROW(reader.integer("time"), std::runtime_error);
  EXPECT_THROW(reader.integer("history"), std::runtime_error);
}

TEST_F(Restart, any_number_of_ranks_reads_back_the_same_bits) {
  for (const std::int64_t n : {1, 10, 1000}) {
    const std::string file = path("restart.h5");
    write_restart(MPI_COMM_WORLD, file, n);
    EXPECT_FALSE(fs::exists(file + ".part"));
    for (int readers = 1; readers <= n_ranks; ++readers) {
      MPI_Comm some = MPI_COMM_NULL;
      MPI_Comm_split(MPI_COMM_WORLD, rank < readers ? 0 : MPI_UNDEFINED, rank, &some);
      if (some != MPI_COMM_NULL) {
        check_restart(some, file, n);
        MPI_Comm_free(&some);
      }
      MPI_Barrier(MPI_COMM_WORLD);
    }
  }
}

TEST_F(Restart, the_file_does_not_depend_on_the_number_of_ranks_that_wrote_it) {
  write_restart(MPI_COMM_WORLD, path("all.h5"), 100);
  if (rank == 0) {
    write_restart(MPI_COMM_SELF, path("one.h5"), 100);
    const std::string table = "entities/elements/columns/counter";
    EXPECT_EQ(read_table<std::int64_t>(path("all.h5"), table), read_table<std::int64_t>(path("one.h5"), table));
    check_restart(MPI_COMM_SELF, path("one.h5"), 100);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  check_restart(MPI_COMM_WORLD, path("one.h5"), 100);
}

TEST_F(Restart, an_interrupted_write_leaves_the_previous_file) {
  const std::string file = path("restart.h5");
  write_restart(MPI_COMM_WORLD, file, 50);
  {
    RestartWriter unfinished(MPI_COMM_WORLD, file);
    unfinished.write_attribute("time", 9.0);
  }
  check_restart(MPI_COMM_WORLD, file, 50);
}

TEST_F(Restart, what_cannot_be_read_is_refused_with_a_sentence) {
  const auto message = [](const std::string& file) -> std::string {
    try {
      RestartReader(MPI_COMM_WORLD, file);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message(path("absent.h5")).find("there is no restart file"), std::string::npos);
  if (rank == 0) std::ofstream(path("text.h5")) << "not HDF5 at all";
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_NE(message(path("text.h5")).find("is no file of Kerf's: too short"), std::string::npos);
  for (const bool has_format : {false, true}) {
    hdf5::Hdf5File other = hdf5::Hdf5File::create(MPI_COMM_WORLD, path("other.h5"));
    other.root.groups["attributes"];
    other.root.groups["entities"];
    if (has_format) other.root.set("kerf_restart_format", restart_format + 1);
    other.commit();
    const std::string expected =
        has_format ? "has restart format 4, and this program reads format 3" : "is not a restart file";
    EXPECT_NE(message(path("other.h5")).find(expected), std::string::npos) << message(path("other.h5"));
  }
}

// Each byte of a small file in turn has one bit changed. Nothing of the file is used by anybody then, but for the bytes
// between its blocks, which say nothing.
TEST_F(Restart, a_change_of_any_byte_is_noticed) {
  const std::string file = path("restart.h5"), copy = path("copy.h5");
  write_restart(MPI_COMM_WORLD, file, 10);
  if (rank == 0) {
    std::ifstream in(file, std::ios::binary);
    const std::string whole(std::istreambuf_iterator<char>(in), {});
    check_restart(MPI_COMM_SELF, file, 10);
    std::size_t unnoticed = 0;
    for (std::size_t at = 0; at < whole.size(); ++at) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
      std::ofstream(copy, std::ios::binary) << damaged;
      try {
        check_restart(MPI_COMM_SELF, copy, 10);  // harmless where it is read at all
        ++unnoticed;
      } catch (const OutputError&) {
      }
    }
    EXPECT_LE(unnoticed, 7u * 4) << "of at most seven bytes between two blocks";
    for (const std::size_t size : {std::size_t{0}, whole.size() / 2, whole.size() - 1}) {
      std::ofstream(copy, std::ios::binary) << whole.substr(0, size);
      EXPECT_THROW(RestartReader(MPI_COMM_SELF, copy), OutputError);
    }
    std::ofstream(copy, std::ios::binary) << whole << 'x';
    EXPECT_THROW(RestartReader(MPI_COMM_SELF, copy), OutputError);
  }
}

TEST_F(Restart, the_file_before_the_newest_is_kept) {
  const std::string file = path("restart.h5");
  write_restart(MPI_COMM_WORLD, file, 10);
  EXPECT_FALSE(fs::exists(previous_restart(file)));
  MPI_Barrier(MPI_COMM_WORLD);
  write_restart(MPI_COMM_WORLD, file, 20);
  check_restart(MPI_COMM_WORLD, file, 20);
  check_restart(MPI_COMM_WORLD, previous_restart(file), 10);
  EXPECT_FALSE(fs::exists(file + ".part"));
}

}  // namespace
}  // namespace kerf
