// Input texts to models, the fuse criterion and the limp element.
#include "parallel/scene.hpp"

#include <kerf/element.hpp>

#include <algorithm>

#include "core/assert.hpp"
#include "input/read_model.hpp"
#include "kerf/measure.hpp"
#include "model/setup.hpp"

namespace kerf::test {

namespace {

struct Fuse final : PointwiseErosion<Fuse> {
  using Reads = NoVariables;
  struct State {
    double cycles;
  };
  static void describe(Schema<Fuse>& s) {
    describe_interval(s);
    s.state(&State::cycles, "fuse_cycles", "-", 1e9, "cycles that are left");
  }
  Verdict judge_point(const ErosionInputPoint&, const Reads&, State& state) const {
    state.cycles -= 1.0;
    return {state.cycles, select(state.cycles <= 0.0, 1.0, 0.0)};
  }
};

struct Limp final : Element {
  const Shape& shape() const override { return hexahedron; }
  static void describe(Schema<Limp>&) {}

  void initialise(ElementWork& w) const override { std::fill_n(w.least_step, lane_width, 1e-7); }
  void add_internal_forces(ElementWork& w) const override {
    initialise(w);
    const double zero[9][lane_width] = {};
    const double(&six)[6][lane_width] = *reinterpret_cast<const double(*)[6][lane_width]>(&zero);
    for (int block = 0; block < w.n_blocks && w.judge; ++block) {
      ErosionBatch rows;
      rows.stress = rows.strain_increment = six;
      rows.rotation = zero;
      rows.pressure = rows.density_ratio = rows.volume_ratio = rows.time_step = zero[0];
      w.failed[block] = static_cast<std::uint8_t>(w.judge->judge(rows, block));
    }
  }
};

}  // namespace

const Registry& scene_registry() {
  static const Registry registry = [] {
    Registry r;
    register_builtin_plugins(r);
    r.add_type<Fuse>("erosion", "fuse", "the element has reached its cycle", __FILE__);
    r.add_type<Limp>("element", "limp", "no stiffness at all", __FILE__);
    return r;
  }();
  return registry;
}

std::unique_ptr<ModelInput> scene(const std::string& yaml) {
  Diagnostics diagnostics;
  OriginMap origins;
  auto input = read_model_input("scene.yaml", yaml, {}, scene_registry(), diagnostics, origins);
  validate(*input, origins, diagnostics);
  diagnostics.throw_if_errors();
  return input;
}

void generate(Model& model, const ModelInput& input) {
  create_parts(model, MPI_COMM_WORLD, input);
  generate_mesh(model);
}

Vec3 generated_position(const Model& model, std::int64_t node) {
  const PartModel& part = model.parts[static_cast<std::size_t>(model.part_of_node(node))];
  return part.placement->apply(part.input->mesh->node(node - part.first_node));
}

void light_fuses(Model& model, const std::function<double(std::int64_t)>& cycles) {
  for (PartModel& part : model.parts) {
    PartStore& store = *part.store;
    const auto [field, component] = store.find_variable("fuse_cycles");
    KERF_ASSERT(field != PartStore::n_fields, "the material of every part needs the criterion fuse");
    for (int s = 0; s < store.n_slots(); ++s)
      if (store.live(s)) store.field(field).set(s, component, cycles(store.id(s)));
  }
}

void delete_elements(Model& model, Erosion& erosion, Ledger& ledger, const std::function<bool(std::int64_t)>& dies) {
  const Step step{1, 0.0, 1e-9, 1e-9};
  for (PartModel& part : model.parts) {
    const PartStore& store = *part.store;
    auto* judge = dynamic_cast<PartJudge*>(erosion.judge(model, store.index(), 1));
    KERF_ASSERT(judge, "the material of every part needs an erosion block");
    for (int s = 0; s < store.n_slots(); ++s)
      if (store.live(s) && dies(store.id(s))) judge->failures.push_back({s, 0, 0.0});
  }
  erosion.erode(model, step, ledger);
  erosion.update_free_nodes(model);
  erosion.drop_free_nodes(model, ledger);
  erosion.compact(model);
}

std::vector<int> owners_of_live(const Model& model, const std::function<int(std::int64_t)>& owner) {
  std::vector<int> owners;
  for (const PartModel& part : model.parts)
    for (int s = 0; s < part.store->n_slots(); ++s)
      if (part.store->live(s)) owners.push_back(owner(part.store->id(s)));
  return owners;
}

double scatter(std::uint64_t seed, std::uint64_t item) {
  std::uint64_t z = seed * 0xd1342543de82ef95ULL + item * 0x9e3779b97f4a7c15ULL + 0x632be59bd9b4e019ULL;
  for (int round = 0; round < 2; ++round) {
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ z >> 27) * 0x94d049bb133111ebULL;
    z ^= z >> 31;
  }
  return static_cast<double>(z >> 11) * 0x1p-53;
}

}  // namespace kerf::test
