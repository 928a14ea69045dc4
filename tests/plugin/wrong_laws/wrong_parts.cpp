// A mesh, a partitioner, an element's mesh and an observer that each break a promise.
#include <cstdlib>

#include <kerf/mesh.hpp>
#include <kerf/observer.hpp>
#include <kerf/partitioner.hpp>

namespace {

using namespace kerf;

/// A row of cubes along x.
template <class Mesh>
struct Row : MeshGenerator {
  static constexpr std::int64_t n = 4;
  static void describe(Schema<Mesh>&) {}
  std::vector<std::string> prepare() override { return {}; }
  std::int64_t n_nodes() const override { return 4 * (n + 1); }
  std::int64_t n_elements() const override { return n; }
  Vec3 node(std::int64_t i) const override {
    const auto k = static_cast<double>(i / 4);
    const std::int64_t c = i % 4;
    return {1e-3 * k, c == 1 || c == 2 ? 1e-3 : 0.0, c >= 2 ? 1e-3 : 0.0};
  }
  ElementNodeIds element(std::int64_t e) const override {
    const std::int64_t a = 4 * e, b = a + 4;
    return {a, b, b + 1, a + 1, a + 3, b + 3, b + 2, a + 2};
  }
  std::vector<std::string> face_names() const override { return {"x_min"}; }
  bool on_face(std::int64_t i, int) const override { return i < 4; }
};
struct RightRow final : Row<RightRow> {};
struct InsideOut final : Row<InsideOut> {
  ElementNodeIds element(std::int64_t e) const override {
    const ElementNodeIds r = Row::element(e);
    return {r[4], r[5], r[6], r[7], r[0], r[1], r[2], r[3]};
  }
};
struct BeyondTheEnd final : Row<BeyondTheEnd> {
  std::int64_t n_nodes() const override { return 4 * n; }
};
struct LostNode final : Row<LostNode> {
  std::int64_t n_nodes() const override { return 4 * (n + 1) + 1; }
};
struct WrongFace final : Row<WrongFace> {
  bool on_face(std::int64_t i, int) const override { return i < 5; }
};
struct ChangesItsMind final : Row<ChangesItsMind> {
  mutable double shift = 0.0;
  Vec3 node(std::int64_t i) const override {
    shift += 1e-12;
    return Row::node(i) + Vec3{shift, 0.0, 0.0};
  }
};

/// All elements go to the first rank.
struct AllToOne final : Partitioner {
  static void describe(Schema<AllToOne>&) {}
  std::vector<int> partition(const PartitionProblem& problem) override {
    return std::vector<int>(problem.ids.size(), 0);
  }
};
/// Ranks that do not exist.
struct Nowhere final : Partitioner {
  static void describe(Schema<Nowhere>&) {}
  std::vector<int> partition(const PartitionProblem& problem) override {
    return std::vector<int>(problem.ids.size(), 99);
  }
};

/// How often it was asked, which it does not hand on to a restart.
struct Forgets final : Observer {
  static void describe(Schema<Forgets>& s) { describe_interval(s); }
  ObserverCalls calls() const override { return {.after_step = true}; }
  std::vector<ObservedColumn> columns() const override { return {{"steps", "-", "number of steps so far"}}; }
  void after_step(ObservedModel&) override { steps += 1.0; }
  void sample(ObservedModel&, std::span<double> row) override { row[0] = steps; }
  ObserverReport report(ObservedModel&) override { return {{{"steps", steps, ""}}, {}}; }
  double steps = 0.0;
};

/// The same, told in its table only.
struct ForgetsRows final : Observer {
  static void describe(Schema<ForgetsRows>& s) { describe_interval(s); }
  ObserverCalls calls() const override { return {.after_step = true}; }
  std::vector<ObservedColumn> columns() const override { return {{"steps", "-", "number of steps so far"}}; }
  void after_step(ObservedModel&) override { steps += 1.0; }
  void sample(ObservedModel&, std::span<double> row) override { row[0] = steps; }
  double steps = 0.0;
};

/// A column that depends on the number of ranks.
struct KnowsRanks final : Observer {
  static void describe(Schema<KnowsRanks>& s) { describe_interval(s); }
  std::vector<ObservedColumn> columns() const override { return {{"ranks", "-", "one, or more than one"}}; }
  void sample(ObservedModel&, std::span<double> row) override {
    row[0] = std::getenv("OMPI_COMM_WORLD_SIZE") ? 2.0 : 1.0;
  }
};

}  // namespace

KERF_REGISTER(KERF_TYPE(RightRow, "mesh", "right_row", "nothing is wrong with it")
                  KERF_TYPE(InsideOut, "mesh", "inside_out", "elements inside out")
                      KERF_TYPE(BeyondTheEnd, "mesh", "beyond_the_end", "nodes that do not exist")
                          KERF_TYPE(LostNode, "mesh", "lost_node", "a node in no element")
                              KERF_TYPE(WrongFace, "mesh", "wrong_face", "a node of another face")
                                  KERF_TYPE(ChangesItsMind, "mesh", "changes_its_mind", "nodes that move when asked")
                                      KERF_TYPE(AllToOne, "partitioner", "all_to_one", "all work on one rank")
                                          KERF_TYPE(Nowhere, "partitioner", "nowhere", "owners that do not exist")
                                              KERF_TYPE(Forgets, "observer", "forgets", "a sum that a restart loses")
                                                  KERF_TYPE(ForgetsRows, "observer", "forgets_rows",
                                                            "a sum that a restart loses")
                                                      KERF_TYPE(KnowsRanks, "observer", "knows_ranks",
                                                                "a column that depends on ranks"))
