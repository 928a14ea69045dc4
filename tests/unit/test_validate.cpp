// Requirement: names that refer across blocks of the input are checked before a run, with the place of each mistake.
#include <gtest/gtest.h>

#include "input/read_model.hpp"
#include "kerf/measure.hpp"

namespace {

using namespace kerf;
using Lines = std::vector<std::string>;

struct Cube final : MeshGenerator {
  double size = 0.0;
  static void describe(Schema<Cube>& s) { s.real(&Cube::size, "size", "m", positive, "edge of the cube"); }
  Lines prepare() override { return size > 1.0 ? Lines{"the cube is larger than 1 m"} : Lines{}; }
  std::int64_t n_nodes() const override { return 8; }
  std::int64_t n_elements() const override { return 1; }
  Vec3 node(std::int64_t i) const override {
    return {i % 4 == 1 || i % 4 == 2 ? size : 0.0, i % 4 > 1 ? size : 0.0, i > 3 ? size : 0.0};
  }
  std::array<std::int64_t, 8> element(std::int64_t) const override { return {0, 1, 2, 3, 4, 5, 6, 7}; }
  Lines face_names() const override { return {"bottom", "top"}; }
  bool on_face(std::int64_t i, int face) const override { return (i > 3) == (face == 1); }
};

struct Rigid final : Material {
  struct State {
    double plastic_strain;
  };
  static void describe(Schema<Rigid>& s) { s.state(&State::plastic_strain, "plastic_strain", "-", 0.0, "strain"); }
  void update(const MaterialBatch&) const override {}
};

struct Linear final : Eos {
  static void describe(Schema<Linear>&) {}
  void evaluate(const EosBatch&) const override {}
};

struct Limit final : ErosionCriterion {
  struct Reads {
    double damage;
  };
  static void describe(Schema<Limit>& s) { s.reads(&Reads::damage, "damage", "damage of the law"); }
  void judge(const ErosionBatch&) const override {}
};

struct Brick final : Element {
  const Shape& shape() const override { return hexahedron; }
  static void describe(Schema<Brick>&) {}
  void add_internal_forces(ElementWork&) const override {}
  void initialise(ElementWork&) const override {}
};

struct SmallBrick final : Element {
  const Shape& shape() const override { return hexahedron; }
  static void describe(Schema<SmallBrick>&) {}
  void add_internal_forces(ElementWork&) const override {}
  void initialise(ElementWork&) const override {}
  bool computes_in_single() const override { return true; }
  void add_internal_forces_single(SingleElementWork&) const override {}
  void initialise_single(SingleElementWork&) const override {}
};

constexpr Shape pyramid{.name = "pyramid", .n_nodes = 5};

struct Pyramid final : Element {
  const Shape& shape() const override { return pyramid; }
  static void describe(Schema<Pyramid>&) {}
  void add_internal_forces(ElementWork&) const override {}
  void initialise(ElementWork&) const override {}
};

/// All of space.
struct Everything final : SpatialDecomposition {
  void build(MPI_Comm, const std::vector<double>&, const std::vector<double>&) override {}
  int owner(Vec3) const override { return 0; }
  void owners(Vec3, Vec3, std::vector<int>& ranks) const override { ranks = {0}; }
};

struct NoSpace final : Partitioner {
  static void describe(Schema<NoSpace>&) {}
  std::vector<int> partition(const PartitionProblem&) override { return {}; }
};

struct Still final : BalancePolicy {
  static void describe(Schema<Still>&) {}
  std::int64_t check_interval() const override { return 0; }
  bool move(const BalanceState&) override { return false; }
};
struct OneRank final : Partitioner {
  std::unique_ptr<SpatialDecomposition> spatial() const override { return std::make_unique<Everything>(); }
  static void describe(Schema<OneRank>&) {}
  std::vector<int> partition(const PartitionProblem&) override { return {}; }
};

struct Speed final : Measure {
  std::string part;
  static void describe(Schema<Speed>& s) { s.text(&Speed::part, "part", "part that is measured"); }
  Lines references() const override { return {part}; }
  MeasuredValues evaluate(const MeasureModel&, MeasureRanks&) const override { return {}; }
};

struct Clamp final : Boundary {
  Lines where;
  static void describe(Schema<Clamp>& s) { s.texts(&Clamp::where, "nodes", "parts or sets"); }
  Lines nodes() const override { return where; }
  Vec3 constrain(const BoundaryNode&, const BoundaryStep&, Vec3) const override { return {}; }
};

class Validate : public testing::Test {
 protected:
  Validate() {
    registry.add_type<Cube>("mesh", "cube", "", "");
    registry.add_type<Rigid>("material", "rigid", "", "");
    registry.add_type<Linear>("eos", "linear", "", "");
    registry.add_type<Limit>("erosion", "limit", "", "");
    registry.add_type<Brick>("element", "hex8", "", "");
    registry.add_type<SmallBrick>("element", "small_brick", "", "");
    registry.add_type<Pyramid>("element", "pyramid", "", "");
    registry.add_type<OneRank>("partitioner", "bisection", "", "");
    registry.add_type<OneRank>("partitioner", "zoltan_rcb", "", "");
    registry.add_type<Still>("balance_policy", "threshold", "", "");
    registry.add_type<NoSpace>("partitioner", "no_space", "", "");
    registry.add_type<Speed>("measure", "speed", "", "");
    registry.add_type<Clamp>("boundary", "clamp", "", "");
    registry.add_type<Linear>("boundary", "impostor", "", "");
  }

  // A model without a mistake, changed as `overrides` say.
  Lines errors(const Lines& overrides) {
    const std::string text =
        "time: {end: 1}\n"
        "materials:\n"
        "  steel: {density: 7800, strength: {type: rigid}, eos: {type: linear}}\n"
        "parts:\n"
        "  rod: {mesh: {type: cube, size: 1 mm}, material: steel}\n"
        "  plate: {mesh: {type: cube, size: 1 mm}, material: steel}\n"
        "sets:\n"
        "  tip: {parts: [rod], face: top}\n"
        "boundaries:\n"
        "  - {type: clamp, nodes: [tip, plate]}\n"
        "measures:\n"
        "  v: {type: speed, part: rod}\n";
    Diagnostics diagnostics;
    OriginMap origins;
    const auto model = read_model_input("a.yaml", text, overrides, registry, diagnostics, origins);
    validate(*model, origins, diagnostics);
    return diagnostics.errors();
  }

  Registry registry;
};

TEST_F(Validate, accepts_a_model_without_mistakes) { EXPECT_EQ(errors({}), Lines{}); }

TEST_F(Validate, finds_unknown_names) {
  EXPECT_EQ(errors({"parts.rod.material=stele"}),
            Lines{"--set parts.rod.material=stele: error: there is no material \"stele\"; did you mean `steel`?"});
  EXPECT_EQ(errors({"sets.tip.parts=rodd"}),
            Lines{"--set sets.tip.parts=rodd: error: there is no part \"rodd\"; did you mean `rod`?"});
  EXPECT_EQ(errors({"sets.tip.face=tpo"}),
            Lines{"--set sets.tip.face=tpo: error: the mesh of part `rod` has no face \"tpo\"; did you mean `top`?"});
  EXPECT_EQ(errors({"measures.v.part=tip"}),
            Lines{"--set measures.v.part=tip: error: there is no part \"tip\"; the parts are rod and plate"});
  EXPECT_EQ(errors({"boundaries[0].nodes=[tip, plaet]"}),
            Lines{"--set boundaries[0].nodes=[tip, plaet]: error: there is no part or set \"plaet\"; did you mean "
                  "`plate`?"});
  EXPECT_EQ(errors({"output.node_fields=speed"}),
            Lines{"--set output.node_fields=speed: error: there is no field \"speed\"; the fields are velocity, "
                  "displacement and mass"});
}

TEST_F(Validate, finds_elements_that_do_not_compute_in_single_precision) {
  EXPECT_EQ(errors({"precision=double"}), Lines{});
  EXPECT_EQ(errors({"precision=single", "parts.rod.element={type: small_brick}"}),
            Lines{"--set precision=single: error: the element hex8 of part `plate` computes in double precision only; "
                  "expected double"});
}

TEST_F(Validate, finds_meshes_of_another_shape_than_the_element) {
  EXPECT_EQ(errors({"parts.rod.element={type: pyramid}"}),
            Lines{"a.yaml:5:9: error: the mesh of part `rod` is made of cells of the shape hexahedron, and the element "
                  "pyramid is a pyramid; expected one shape"});
}

TEST_F(Validate, finds_a_partitioner_that_cannot_serve_contact) {
  EXPECT_EQ(errors({"balance.partitioner={type: no_space}"}), Lines{});
  EXPECT_EQ(errors({"balance.contact_partitioner={type: no_space}"}),
            Lines{"--set balance.contact_partitioner={type: no_space}: error: no_space does not divide space between "
                  "ranks, as contact needs it; expected one that does, such as bisection or zoltan_rcb"});
}

TEST_F(Validate, finds_a_part_and_a_set_of_one_name) {
  EXPECT_EQ(errors({"sets.rod.face=top"}),
            Lines{"--set sets.rod.face=top: error: a part is called `rod` already; expected another name, since parts "
                  "and sets are chosen from alike"});
}

TEST_F(Validate, finds_a_variable_that_no_law_keeps) {
  EXPECT_EQ(errors({"materials.steel.erosion={criteria: [{type: limit}]}"}),
            Lines{"--set materials.steel.erosion={criteria: [{type: limit}]}: error: limit reads the state variable "
                  "\"damage\" (damage of the law), which no law of material `steel` declares; its laws declare "
                  "plastic_strain"});
}

TEST_F(Validate, passes_on_what_a_mesh_generator_says) {
  EXPECT_EQ(errors({"parts.rod.mesh.size=2 m"}), Lines{"a.yaml:5:9: error: the cube is larger than 1 m"});
}

TEST_F(Validate, finds_contradictions) {
  EXPECT_EQ(
      errors({"time.maximum_step=1 us", "time.minimum_step=2 us"}),
      Lines{"--set time.maximum_step=1 us: error: `maximum_step` = 1e-06 s is less than `minimum_step` = 2e-06 s; "
            "expected at least that"});
  EXPECT_EQ(errors({"checks.free_nodes=drop_beyond"}),
            Lines{"--set checks.free_nodes=drop_beyond: error: drop_beyond needs a distance; expected the key "
                  "`drop_distance`, for example 10 mm"});
  EXPECT_EQ(errors({"parts={}", "sets={}", "boundaries=[]", "measures={}"}),
            Lines{"--set parts={}: error: there are no parts; expected at least one"});
}

TEST_F(Validate, finds_a_plugin_of_the_wrong_class) {
  EXPECT_EQ(errors({"boundaries=[{type: impostor}]"}),
            Lines{"--set boundaries=[{type: impostor}]: error: `boundaries` names a type that does not derive from "
                  "kerf::Boundary; its plugin registers it under the wrong kind"});
}

TEST_F(Validate, does_not_take_anything_from_text_that_is_not_yaml) {
  Diagnostics diagnostics;
  OriginMap origins;
  EXPECT_THROW(read_model_input("a.yaml", "a: [1, 2", {}, registry, diagnostics, origins), InputError);
  const auto model = read_model_input("b.yaml", "", {}, registry, diagnostics, origins);
  EXPECT_TRUE(model);
  EXPECT_EQ(diagnostics.errors().at(1),
            "b.yaml:1:1: error: the input is empty; expected at least the keys time, materials and parts");
}

}  // namespace
