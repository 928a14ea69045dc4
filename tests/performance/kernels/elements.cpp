// Benchmarks of the two passes over a whole model: internal forces per element, kick and drift per node.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "dynamics/element_loop.hpp"
#include "dynamics/integrator.hpp"
#include "erosion/erosion.hpp"
#include "model/ledger.hpp"
#include "parallel/scene.hpp"

namespace {

using namespace kerf;

// Constants of the order of a steel's.
const std::string elastic_plastic =
    "{density: 7850, strength: {type: elastic_plastic, shear_modulus: 80e9, yield_stress: 4e8, hardening_modulus: 5e8},"
    " eos: {type: linear, bulk_modulus: 170e9}}";
const std::string johnson_cook =
    "{density: 7850, strength: {type: johnson_cook, shear_modulus: 80e9, A: 8e8, B: 6e8, n: 0.17, C: 0.009, m: 1.1,"
    " melting_temperature: 1800, specific_heat: 460},"
    " eos: {type: mie_gruneisen, c0: 4570, s: 1.49, gamma0: 1.93, gamma_slope: 0.5}}";

/// A cube of cells of 1 mm whose nodes sway: nearly all points yield on the way forth and on the way back.
class SwayingBlock {
 public:
  SwayingBlock(const std::string& hourglass, const std::string& material, int cells,
               const std::string& precision = "double")
      : input_(test::scene(fmt::format(
            "precision: {3}\ntime: {{end: 1}}\nmaterials:\n  metal: {0}\nparts:\n  block:\n    material: metal\n    "
            "element: {{type: "
            "hex8, hourglass: {1}}}\n    mesh: {{type: block, size: [{2}e-3, {2}e-3, {2}e-3], cells: [{2}, {2}, {2}]}}",
            material, hourglass, cells, precision))) {
    test::generate(model_, *input_);
    erosion_ = std::make_unique<Erosion>(model_);
    ledger_.open(model_);
    step_.cycle = 1;
    step_.dt = step_.last_dt = 0.5 * initialise_elements(model_).least_step;
    push_off();
    home_ = {model_.nodes.position, {}};
    for (int s = 0; s < period; ++s) {
      advance();
      add_forces();
    }
    for (int f = 0; f < PartStore::n_fields; ++f) home_.fields.push_back(field(f));
  }

  /// Moves the nodes by one step. After a period everything is as it was.
  void advance() {
    NodeStore& nodes = model_.nodes;
    if (at_ == period / 2 || at_ == period)
      for (double& v : nodes.velocity) v = -v;
    if (at_ == period) {
      at_ = 0;
      nodes.position = home_.position;
      for (std::size_t f = 0; f < home_.fields.size(); ++f) field(static_cast<int>(f)) = home_.fields[f];
    }
    for (std::size_t i = 0; i < nodes.position.size(); ++i) nodes.position[i] += nodes.velocity[i] * step_.dt;
    std::fill(nodes.force.begin(), nodes.force.end(), 0);
    ledger_.accounts = {};
    ++at_;
  }
  void add_forces() { trouble_ = add_internal_forces(model_, step_, *erosion_, ledger_).trouble; }
  void kick_and_drift(Integrator& integrator) {
    const ContactLoad contact;
    const ExternalLoad external;
    integrator.kick_and_drift(model_, step_, {contact, external}, ledger_);
  }

  const Model& model() const { return model_; }
  const PartStore& store() const { return *model_.parts[0].store; }
  /// Why the numbers mean nothing; empty if they do.
  std::string trouble() const {
    if (!trouble_.empty()) return trouble_;
    const auto [strain, component] = store().find_variable("effective_plastic_strain");
    int n = 0;
    for (int s = 0; s < store().n_slots(); ++s) n += store().field(strain).at(s, component) > 0.01 ? 1 : 0;
    return 10 * n > 9 * store().n_slots() ? "" : "the block hardly yields";
  }
  /// What the element phase has to move at least: fields read and written (the mass read only), nodes of the elements,
  /// positions and velocities read, forces read and written.
  double traffic() const {
    return store().n_slots() * (2.0 * bytes_per_element() - 8.0 + 32.0) + model_.nodes.n() * 128.0;
  }
  double working_set() const { return store().n_slots() * (bytes_per_element() + 32.0) + model_.nodes.n() * 96.0; }

 private:
  static constexpr int period = 20;  // steps forth and back

  Field& field(int f) { return model_.parts[0].store->field(static_cast<PartStore::FieldIndex>(f)); }
  double bytes_per_element() const {
    double bytes = 0.0;
    for (int f = 0; f < PartStore::n_fields; ++f) {
      const Field& each = store().field(static_cast<PartStore::FieldIndex>(f));
      bytes += each.n_components * (each.is_single ? 4.0 : 8.0);
    }
    return bytes;
  }
  /// Velocities of a wave of shear, and of some compression, along each axis; 0.4 % of strain in a step at most.
  void push_off() {
    NodeStore& nodes = model_.nodes;
    const double wave = 2.0 * 3.14159265358979 / 16e-3;
    for (int i = 0; i < nodes.n(); ++i) {
      const Vec3 x = nodes.x(i) * wave;
      Vec3 v;
      for (int d = 0; d < 3; ++d) v[d] = std::sin(x[(d + 1) % 3]) + 0.25 * std::sin(x[d]);
      nodes.set_v(i, v * (4e-3 / (wave * step_.dt)));
    }
  }

  std::unique_ptr<ModelInput> input_;
  Model model_;
  Ledger ledger_;
  std::unique_ptr<Erosion> erosion_;
  Step step_;
  struct {
    AlignedVector<double> position;
    std::vector<Field> fields;
  } home_;
  int at_ = 0;  // step of the period
  std::string trouble_;
};

/// Items are elements; the move between two calls is not timed.
void internal_forces(benchmark::State& state, const std::string& hourglass, const std::string& material,
                     const std::string& precision = "double") {
  SwayingBlock block(hourglass, material, static_cast<int>(state.range(0)), precision);
  for (auto _ : state) {
    state.PauseTiming();
    block.advance();
    state.ResumeTiming();
    block.add_forces();
  }
  if (!block.trouble().empty()) state.SkipWithError(block.trouble().c_str());
  state.SetItemsProcessed(state.iterations() * block.store().n_slots());
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(block.traffic()));
  state.counters["working_set"] = block.working_set();
}

/// Items are nodes; without boundary conditions and contact.
void kick_and_drift(benchmark::State& state) {
  SwayingBlock block("viscous", elastic_plastic, static_cast<int>(state.range(0)));
  Constraints constraints;
  constraints.resolve(block.model());
  Integrator integrator(constraints);
  for (auto _ : state) block.kick_and_drift(integrator);
  // Position, velocity and force are read and written, four entries each; the inverse mass is read.
  const std::int64_t n = block.model().nodes.n();
  state.SetItemsProcessed(state.iterations() * n);
  state.SetBytesProcessed(state.iterations() * n * 200);
}

void block_sizes(benchmark::internal::Benchmark* b) {
  b->ArgName("cells")->Arg(12)->Arg(16)->Arg(46);  // along an edge: 1728, 4096 and 97336 elements
  b->Unit(benchmark::kMicrosecond);
}

BENCHMARK_CAPTURE(internal_forces, viscous_elastic_plastic, "viscous", elastic_plastic)->Apply(block_sizes);
BENCHMARK_CAPTURE(internal_forces, stiffness_elastic_plastic, "stiffness", elastic_plastic)->Apply(block_sizes);
BENCHMARK_CAPTURE(internal_forces, viscous_johnson_cook, "viscous", johnson_cook)->Apply(block_sizes);
BENCHMARK_CAPTURE(internal_forces, viscous_elastic_plastic_single, "viscous", elastic_plastic, "single")
    ->Apply(block_sizes);
BENCHMARK_CAPTURE(internal_forces, viscous_johnson_cook_single, "viscous", johnson_cook, "single")->Apply(block_sizes);
BENCHMARK(kick_and_drift)->Apply(block_sizes);

}  // namespace
