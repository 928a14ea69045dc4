// Declarations of the blocks of the input file.
#include "input/model_input.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "input/output_fields.hpp"
#include "kerf/measure.hpp"

namespace kerf {

ModelInput::~ModelInput() = default;

bool ModelInput::has_external_forces() const {
  return !loads.empty() ||
         std::any_of(observers.begin(), observers.end(), [](const auto& o) { return o && o->calls().forces; });
}

void TimeInput::describe(Schema<TimeInput>& s) {
  s.real(&TimeInput::end, "end", "s", positive, "time at which the run ends");
  s.real(&TimeInput::safety_factor, "safety_factor", "-", Range{0.0, 1.0, true, false},
         "fraction of the stable time step that is used")
      .by_default("0.9");
  s.real(&TimeInput::initial_step, "initial_step", "s", positive, "upper bound of the first time step").optional();
  s.real(&TimeInput::maximum_step, "maximum_step", "s", positive, "upper bound of every time step").optional();
  s.real(&TimeInput::minimum_step, "minimum_step", "s", positive,
         "the run stops, naming the element, when the stable step falls below this; by default 1e-4 of the first step")
      .optional();
  s.real(&TimeInput::growth, "growth", "-", Range{1.0, 10.0, true, false},
         "largest ratio of a time step to the one before it")
      .by_default("1.1");
  s.integer(&TimeInput::maximum_cycles, "maximum_cycles", positive, "the run ends after this many cycles").optional();
}

void CurveInput::describe(Schema<CurveInput>& s) {
  s.reals(&CurveInput::times, "times", "s", any_value, "times of the points, ascending").optional();
  s.reals(&CurveInput::values, "values", "-", any_value,
          "values at the times, linear between them and constant outside")
      .optional();
  s.text(&CurveInput::file, "file", "CSV file with the points, named relative to the input file").optional();
  s.texts(&CurveInput::columns, "columns",
          "columns of the file that hold times and values, by their names in the heading or their numbers from 1")
      .by_default("[1, 2]");
  s.real(&CurveInput::period, "period", "s", positive, "time after which the points repeat").optional();
  s.real(&CurveInput::time_scale, "time_scale", "-", positive, "factor of all times, 1e-6 for a file in microseconds")
      .by_default("1");
  s.real(&CurveInput::value_scale, "value_scale", "-", any_value, "factor of all values").by_default("1");
  s.rule("file", "a curve takes either a table of `times` and `values` or a `file`",
         [](const CurveInput& c) { return c.file.empty() == (!c.times.empty() || !c.values.empty()); });
  s.rule("values", "times and values must be of equal number, at least one",
         [](const CurveInput& c) { return !c.file.empty() || c.times.size() == c.values.size(); });
  s.rule("times", "times must ascend strictly", [](const CurveInput& c) { return c.ascends(); });
  s.rule("period", "the period must not be less than the time from the first to the last point",
         [](const CurveInput& c) { return c.times.empty() || c.fits_period(); });
  s.rule("columns", "two columns are needed, of the times and of the values",
         [](const CurveInput& c) { return c.columns.size() == 2; });
}

bool CurveInput::ascends() const {
  return std::adjacent_find(times.begin(), times.end(), [](double a, double b) { return !(a < b); }) == times.end();
}

/// In multiples of the scale, as the curve will be.
bool CurveInput::fits_period() const {
  return period == 0.0 || times.back() * time_scale - times.front() * time_scale <= period;
}

void ErosionInput::describe(Schema<ErosionInput>& s) {
  s.choice(&ErosionInput::rule, "rule", {"any", "all", "at_least"},
           "how many criteria must fail an element before it is eroded")
      .by_default("any");
  s.integer(&ErosionInput::count, "count", positive, "number of criteria for the rule at_least").optional();
  s.integer(&ErosionInput::fade_out, "fade_out", between(0.0, 1e6),
            "cycles in which the deviator and the tension of an element that has failed fall to nothing before it is "
            "deleted")
      .by_default("0");
  s.plugin_list(&ErosionInput::criteria, "criteria", "erosion", "criteria that judge the elements of this material");
  s.rule("criteria", "a material takes one to eight erosion criteria, or no block `erosion` at all",
         [](const ErosionInput& e) { return !e.criteria.empty() && e.criteria.size() <= 8; });
  s.rule("count", "at_least needs a count no larger than the number of criteria", [](const ErosionInput& e) {
    return e.rule != "at_least" || e.count <= static_cast<std::int64_t>(e.criteria.size());
  });
  s.rule("count", "the rule at_least needs this key, the number of criteria",
         [](const ErosionInput& e) { return e.rule != "at_least" || e.count >= 1; });
  s.rule("count", "count acts with the rule at_least only",
         [](const ErosionInput& e) { return e.rule == "at_least" || e.count == 0; });
}

void MaterialInput::describe(Schema<MaterialInput>& s) {
  s.text(&MaterialInput::library, "library",
         "name of a set of the material library, whose blocks stand here then; what is given beside it replaces single "
         "keys, and `erosion: suggested` takes what the set suggests (`kerf list library`)")
      .optional();
  s.real(&MaterialInput::density, "density", "kg/m3", positive, "density of the undeformed material");
  s.plugin(&MaterialInput::strength, "strength", "material", "law of the stress deviator; needs an eos").optional();
  s.plugin(&MaterialInput::eos, "eos", "eos", "equation of state, the law of the pressure; needs a strength")
      .optional();
  s.plugin(&MaterialInput::solid, "solid", "solid", "law of the whole stress, in place of strength and eos").optional();
  s.optional_block(&MaterialInput::erosion, "erosion", "when elements of this material are deleted");
}

std::vector<const Law*> MaterialInput::laws() const {
  std::vector<const Law*> all;
  for (const Law* law : std::initializer_list<const Law*>{strength.get(), eos.get(), solid.get()})
    if (law) all.push_back(law);
  if (erosion)
    for (const auto& criterion : erosion->criteria)
      if (criterion) all.push_back(criterion.get());
  return all;
}

void InitialStateInput::describe(Schema<InitialStateInput>& s) {
  s.texts(&InitialStateInput::elements, "elements",
          "parts, or sets that hold all nodes of an element; all elements where absent")
      .optional();
  s.text(&InitialStateInput::variable, "variable", "a state variable of the elements' laws, or specific_energy");
  s.text(&InitialStateInput::value, "value", "its value before the first step, with a unit");
}

void PlacementInput::describe(Schema<PlacementInput>& s) {
  s.real(&PlacementInput::angle, "angle", "rad", any_value, "angle of rotation about the axis").by_default("0 rad");
  s.vector(&PlacementInput::axis, "axis", "-", any_value, "direction of the axis of rotation").by_default("[0, 0, 1]");
  s.vector(&PlacementInput::about, "about", "m", any_value, "point on the axis of rotation").by_default("[0, 0, 0]");
  s.vector(&PlacementInput::translate, "translate", "m", any_value, "translation after the rotation")
      .by_default("[0, 0, 0]");
  s.rule("axis", "the axis must not have zero length", [](const PlacementInput& p) { return norm(p.axis) > 0.0; });
}

void PartInput::describe(Schema<PartInput>& s) {
  s.plugin(&PartInput::mesh, "mesh", "mesh", "generator of the part's mesh");
  s.text(&PartInput::material, "material", "name of a material in `materials`");
  s.plugin(&PartInput::element, "element", "element", "element technology").by_default("{type: hex8}");
  s.block_list(&PartInput::placement, "placement", "rotations and translations, carried out in order").optional();
  s.vector(&PartInput::velocity, "velocity", "m/s", any_value, "initial velocity of all nodes of the part")
      .by_default("[0, 0, 0]");
}

void JoinedInput::describe(Schema<JoinedInput>& s) {
  s.texts(&JoinedInput::parts, "parts", "two parts or more that share the nodes in which their meshes meet");
  s.real(&JoinedInput::tolerance, "tolerance", "m", positive,
         "distance up to which two nodes of different parts become one; by default a millionth of the shortest edge of "
         "the mesh")
      .optional();
  s.rule("parts", "at least two parts are needed to join anything",
         [](const JoinedInput& j) { return j.parts.size() >= 2; });
}

void SetInput::describe(Schema<SetInput>& s) {
  s.texts(&SetInput::parts, "parts", "parts whose nodes are taken; all where absent").optional();
  s.text(&SetInput::face, "face", "face of the generator whose nodes are taken").optional();
  s.reals(&SetInput::box, "box", "m", any_value,
          "box whose nodes are taken: x_min, y_min, z_min, x_max, y_max, z_max, after placement")
      .optional();
  s.rule("box", "a box takes six numbers, the three lower bounds first and none above its upper bound",
         [](const SetInput& b) { return b.has_proper_box(); });
}

bool SetInput::has_proper_box() const {
  return box.empty() || (box.size() == 6 && box[0] <= box[3] && box[1] <= box[4] && box[2] <= box[5]);
}

void BalanceInput::describe(Schema<BalanceInput>& s) {
  s.plugin(&BalanceInput::partitioner, "partitioner", "partitioner", "how elements are distributed over the ranks")
      .by_default("{type: zoltan_rcb}");
  s.plugin(
       &BalanceInput::contact_partitioner, "contact_partitioner", "partitioner",
       "how space is divided between the ranks for contact; one that divides space, such as bisection or zoltan_rcb")
      .by_default("{type: bisection}");
  s.plugin(&BalanceInput::policy, "policy", "balance_policy", "when the mesh is re-balanced during the run")
      .by_default("{type: threshold}");
  s.text(
       &BalanceInput::work_model, "work_model",
       "file with the costs of elements, laws, contact and re-balancing, as `kerf bench --calibrate` writes it, named "
       "relative to the input file; by default built-in costs")
      .optional();
  s.choice(&BalanceInput::contact_work, "contact_work", {"own", "with_elements"},
           "whose work contact is: `own` divides space and does not count for elements; with `with_elements` the "
           "elements below contact surfaces weigh more, too")
      .by_default("own");
  s.text(
       &BalanceInput::foresee, "foresee",
       "folder of an earlier, coarser run of the same model, named relative to the input file: the first distribution "
       "weighs elements with how long they are expected to live, as far as that makes the run shorter")
      .optional();
  s.boolean(&BalanceInput::enabled, "enabled", "whether the policy is asked at all").by_default("true");
  s.integer(&BalanceInput::force_interval, "force_interval", non_negative,
            "re-balance every so many cycles, whatever the policy says; 0 for never")
      .by_default("0");
}

void OutputInput::describe(Schema<OutputInput>& s) {
  s.real(&OutputInput::results_interval, "results_interval", "s", positive,
         "time between two frames of results.vtkhdf; by default a twentieth of the run")
      .optional();
  s.real(&OutputInput::history_interval, "history_interval", "s", positive,
         "time between two lines of history.csv; by default a two-hundredth of the run")
      .optional();
  s.real(&OutputInput::restart_interval, "restart_interval", "s", positive,
         "time between two restart files; by default there are none on the way")
      .optional();
  s.real(&OutputInput::recording_interval, "recording_interval", "s", positive,
         "time between two moments of recording.h5, which `kerf predict` reads: mesh, contact, and the work that they "
         "cost; by default there is none")
      .optional();
  s.boolean(&OutputInput::restart_at_end, "restart_at_end",
            "write a restart file at the end, so that the run can be prolonged; a signal always does")
      .by_default("true");
  s.integer(&OutputInput::progress_interval, "progress_interval", non_negative,
            "cycles between two progress lines; 0 for about twenty lines in a run")
      .by_default("0");
  s.choice(&OutputInput::precision, "precision", {"single", "double"}, "precision of the fields in results.vtkhdf")
      .by_default("single");
  s.texts(&OutputInput::element_fields, "element_fields",
          fmt::format("element fields to write: any of {}, {}, and every state variable",
                      fmt::join(element_field_names(), ", "), owner_field().name))
      .by_default("[pressure, von_mises, effective_plastic_strain]");
  s.texts(&OutputInput::node_fields, "node_fields",
          fmt::format("node fields to write: any of {}", fmt::join(node_field_names(), ", ")))
      .by_default("[velocity]");
}

void ChecksInput::describe(Schema<ChecksInput>& s) {
  s.real(&ChecksInput::energy_growth, "energy_growth", "-", positive,
         "the run stops when the energy balance error exceeds this")
      .by_default("0.05");
  s.real(&ChecksInput::let_go, "let_go", "-", non_negative,
         "the run stops when contact has let go of nodes with more than this share of the model's mass")
      .by_default("0.01");
  s.real(&ChecksInput::maximum_speed, "maximum_speed", "m/s", positive,
         "the run stops when a node is faster than this; by default a hundred times the sound speed")
      .optional();
  s.real(&ChecksInput::stall_limit, "stall_limit", "s", non_negative,
         "the program stops when no phase of a cycle has come to an end for this time on the clock; 0 for no limit")
      .by_default("600 s");
  s.choice(&ChecksInput::free_nodes, "free_nodes", {"keep", "drop", "drop_beyond"},
           "what becomes of nodes without live elements: point masses in contact, or dropped and accounted for")
      .by_default("drop");
  s.real(&ChecksInput::drop_distance, "drop_distance", "m", positive,
         "free nodes farther than this from the box round all live material are dropped (for drop_beyond)")
      .optional();
}

void ModelInput::describe(Schema<ModelInput>& s) {
  s.text(&ModelInput::title, "title", "one line about the run").by_default("");
  s.choice(&ModelInput::precision, "precision", {"double", "single"},
           "numbers that elements compute with and keep their stress in; single is faster and less exact")
      .by_default("double");
  s.text_map(&ModelInput::parameters, "parameters", "values by name, used as $name in place of any single value")
      .optional();
  s.texts(&ModelInput::plugins, "plugins",
          "shared libraries with plugins that the input needs, relative to the input file, beside those of --plugin")
      .optional();
  s.texts(&ModelInput::library, "library",
          "folders with material sets of your own, relative to the input file, beside those that come with Kerf")
      .optional();
  s.block(&ModelInput::time, "time", "how long the run is and how its time step is chosen");
  // Before all that may name a curve.
  s.block_map(&ModelInput::curves, "curves", "functions of time by name, for loads and boundary conditions").optional();
  s.block_map(&ModelInput::materials, "materials", "materials by name");
  s.block_map(&ModelInput::parts, "parts", "bodies by name");
  s.block_list(&ModelInput::joined, "joined", "parts that are bonded: they share the nodes in which their meshes meet")
      .optional();
  s.block_map(&ModelInput::sets, "sets", "named sets of nodes, facets and elements").optional();
  s.block_list(&ModelInput::initial_states, "initial_state", "values of state variables before the first step")
      .optional();
  s.plugin_list(&ModelInput::boundaries, "boundaries", "boundary", "boundary conditions").optional();
  s.plugin_list(&ModelInput::loads, "loads", "load", "forces on nodes, facets and bodies").optional();
  s.plugin_list(&ModelInput::contacts, "contacts", "contact", "contact definitions").optional();
  s.plugin_map(&ModelInput::measures, "measures", "measure", "numbers that go to summary.json, by name").optional();
  s.plugin_map(&ModelInput::observers, "observers", "observer", "what is watched during the run, by name").optional();
  s.block(&ModelInput::balance, "balance", "distribution over ranks and re-balancing").by_default("{}");
  s.block(&ModelInput::output, "output", "what is written, and how often").by_default("{}");
  s.block(&ModelInput::checks, "checks", "when a run that goes wrong is stopped, and what becomes of free nodes")
      .by_default("{}");
}

}  // namespace kerf
