// Asks laws for their state at the start, and applies the input's block `initial_state`.
#include "model/initial_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/diagnostics.hpp"
#include "core/units.hpp"
#include "model/node_group.hpp"
#include "parallel/communicator.hpp"

namespace kerf {

namespace {

/// From the declared values, whatever stood there.
void start(const Law& law, const InitialPoint& point, double* state) {
  for (const StateVariable& v : law.state_variables()) state[v.index] = v.initial;
  law.initialise(point, state);
}

/// State of `lane_width` points of a law, as rows, at a place that does not matter to moduli.
std::vector<double> initial_rows(const Law& law, double density) {
  std::vector<double> one(law.state_variables().size()), rows;
  InitialPoint point;
  point.length = 1.0;
  point.density = density;
  start(law, point, one.data());
  for (const double value : one) rows.insert(rows.end(), lane_width, value);
  rows.resize(rows.size() + lane_width);  // never empty
  return rows;
}

/// One block of undeformed points that a law is asked about.
struct Sample {
  double zero[6][lane_width] = {}, stress[6][lane_width] = {}, density[lane_width], energy[lane_width] = {};
  double shear[lane_width] = {}, bulk[lane_width] = {}, pressure[lane_width] = {};
  double length[lane_width], place[3][lane_width] = {}, rotation[9][lane_width] = {};
  std::vector<double> read_rows;
  std::vector<const double*> reads;

  Sample(const MaterialInput& m, double specific_energy, double ratio = 1.0) {
    std::fill(density, density + lane_width, ratio * m.density);
    std::fill(energy, energy + lane_width, specific_energy);
    std::fill(length, length + lane_width, 1.0);
    for (const int d : {0, 4, 8}) std::fill(rotation[d], rotation[d] + lane_width, 1.0);
  }
  /// Variables that a law reads have their initial values.
  void fill(LawRows& rows, const Law& law, const MaterialInput& m) {
    rows.length = rows.initial_length = length;
    rows.reference_position = place;
    rows.rotation = rotation;
    read_rows.clear();
    const std::vector<ReadVariable> all = law.reads();
    for (const ReadVariable& r : all) {
      double value = r.value;
      for (const Law* other : m.laws()) {
        const std::vector<double> start = initial_rows(*other, m.density);
        for (std::size_t v = 0; v < other->state_variables().size(); ++v)
          if (other->state_variables()[v].name == r.name) value = start[v * lane_width];
      }
      read_rows.insert(read_rows.end(), lane_width, value);
    }
    reads.clear();
    for (std::size_t r = 0; r < all.size(); ++r) reads.push_back(read_rows.data() + r * lane_width);
    rows.reads = reads.data();
  }
};

/// Fills the rows that the batches of materials and of solids have in common.
template <class Batch>
void fill_stress_rows(Batch& b, const MaterialInput& m, Sample& s, double* state) {
  s.fill(b, m.stress_law(), m);
  b.reference_density = m.density;
  b.strain_increment = s.zero;
  b.density = s.density;
  b.specific_energy = s.energy;
  b.deviator = s.stress;
  b.pressure = s.pressure;
  b.state = state;
  b.shear_modulus = s.shear;
}

void ask_stress_law(const MaterialInput& m, Sample& s) {
  std::vector<double> state = initial_rows(m.stress_law(), m.density);
  if (m.solid) {
    SolidBatch b;
    fill_stress_rows(b, m, s, state.data());
    b.bulk_modulus = s.bulk;
    m.solid->update(b);
    return;
  }
  MaterialBatch b;
  fill_stress_rows(b, m, s, state.data());
  m.strength->update(b);
}

void ask_eos(const MaterialInput& m, Sample& s) {
  const std::vector<double> eos_state = initial_rows(*m.eos, m.density);
  EosBatch e;
  s.fill(e, *m.eos, m);
  e.reference_density = m.density;
  e.density = s.density;
  e.specific_energy = s.energy;
  e.state = eos_state.data();
  e.pressure = s.pressure;
  e.bulk_modulus = s.bulk;
  m.eos->evaluate(e);
}

/// Calls `work`, which asks a law of a material; what it throws is an error of the input.
template <class Work>
void told(const MaterialInput& m, const Law& law, const Work& work) {
  try {
    work();
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    throw InputError(
        {fmt::format("{}: error: the law {} of material {} cannot start: {}", law.origin, law.type, m.name, e.what())});
  }
}

void ask(const MaterialInput& m, Sample& s) {
  told(m, m.stress_law(), [&] { ask_stress_law(m, s); });
  if (m.eos) told(m, *m.eos, [&] { ask_eos(m, s); });
}

/// Whether an entry of `initial_state` may reach elements of a part.
bool may_reach(const InitialStateInput& initial, const PartInput& part, const ModelInput& input) {
  if (initial.elements.empty()) return true;
  const auto is_other_part = [&](const std::string& name) {
    return name != part.name &&
           std::any_of(input.parts.begin(), input.parts.end(), [&](const auto& other) { return other->name == name; });
  };
  return !std::all_of(initial.elements.begin(), initial.elements.end(), is_other_part);
}

}  // namespace

namespace {

constexpr double compressed = 1.1;  // density ratio

/// dp/d(rho e) of undeformed material that is compressed by `ratio` [-].
double grueneisen(const MaterialInput& m, double ratio) {
  constexpr double warming = 1e3;  // [J/kg], a few degrees
  Sample cold(m, 0.0, ratio), warm(m, warming, ratio);
  ask(m, cold);
  ask(m, warm);
  return (warm.pressure[0] - cold.pressure[0]) / (ratio * m.density * warming);
}

}  // namespace

void ask_moduli(PartModel& part, const ModelInput& input) {
  const MaterialInput& m = *part.material;
  Sample cold(m, 0.0);
  ask(m, cold);
  part.shear_modulus = cold.shear[0];
  part.bulk_modulus = cold.bulk[0];
  part.initial_pressure = cold.pressure[0];
  part.grueneisen = grueneisen(m, 1.0);
  part.grueneisen_compressed = grueneisen(m, compressed);
  part.initial_energy = (m.solid ? m.solid->initial_energy_density() : m.eos->initial_energy_density()) / m.density;
  for (const auto& initial : input.initial_states) {
    if (initial->variable != "specific_energy" || !may_reach(*initial, *part.input, input)) continue;
    Sample hot(m, to_si(initial->value, "J/kg").value);
    ask(m, hot);
    part.hot_stiffness = std::max({part.hot_stiffness, hot.bulk[0], std::fabs(hot.pressure[0])});
  }
  if (!(part.bulk_modulus + 4.0 / 3.0 * part.shear_modulus > 0.0) && !(part.hot_stiffness > 0.0))
    throw InputError({fmt::format(
        "{}: error: material {} of part {} has no stiffness at the start: its bulk modulus is {:.3g} Pa and its shear "
        "modulus {:.3g} Pa; expected constants, or an initial energy, with which it resists compression",
        m.eos ? m.eos->origin : m.stress_law().origin, m.name, part.input->name, part.bulk_modulus,
        part.shear_modulus)});
}

namespace {

void initialise_states(const MaterialInput& m, const PartModel& part, const InitialPoint& point, double* record) {
  const PartStore& store = *part.store;
  const auto start_told = [&](const auto& law, double* state) { told(m, law, [&] { start(law, point, state); }); };
  start_told(m.stress_law(), record + store.offset(PartStore::material_state));
  if (m.eos) start_told(*m.eos, record + store.offset(PartStore::eos_state));
  if (m.erosion) {
    double* state = record + store.offset(PartStore::erosion_state) + part.first_criterion_state;
    for (const auto& c : m.erosion->criteria) {
      start_told(*c, state);
      state += c->state_variables().size();
    }
  }
}

}  // namespace

void initialise_laws(const PartModel& part, const InitialPoint& point, double* record) {
  const MaterialInput& m = *part.material;
  const PartStore& store = *part.store;
  initialise_states(m, part, point, record);
  if (store.field(PartStore::place).n_components == 0) return;
  double* place = record + store.offset(PartStore::place);
  for (int d = 0; d < 3; ++d) place[d] = point.position[d];
  place[3] = point.length;
}

void apply_initial_states(Model& model) {
  std::vector<std::string> errors;
  for (const auto& initial : model.input->initial_states) {
    const NodeGroup group(model, initial->elements);
    const bool is_energy = initial->variable == "specific_energy";
    std::int64_t n_set = 0;
    for (PartModel& part : model.parts) {
      PartStore& store = *part.store;
      const auto [field, component] =
          is_energy ? std::pair(PartStore::internal_energy, 0) : store.find_variable(initial->variable);
      if (field == PartStore::n_fields) continue;
      const std::string unit = is_energy ? "J/kg" : store.field(field).components[component].unit;
      const double value = to_si(initial->value, unit).value;
      for (int s = 0; s < store.n_slots(); ++s)
        if (store.live(s) && group.holds_element(model.nodes, store, s)) {
          store.field(field).set(s, component, is_energy ? value * store.field(PartStore::mass).at(s, 0) : value);
          ++n_set;
        }
    }
    if (sum_of(model.comm, n_set) == 0)
      errors.push_back(fmt::format(
          "{}: error: `{}` is set in no element; expected parts, or sets that hold all nodes of some element, whose "
          "material has this variable",
          initial->origin, initial->variable));
  }
  if (!errors.empty()) throw InputError(errors);
}

}  // namespace kerf
