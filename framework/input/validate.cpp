// Checks across blocks of the input: every name that is used must be there, and fit its use.
#include <fmt/format.h>

#include <algorithm>

#include "core/units.hpp"
#include "input/condition_complaints.hpp"
#include "input/node_choice.hpp"
#include "input/output_fields.hpp"
#include "input/parameter_text.hpp"
#include "input/placement.hpp"
#include "input/read_model.hpp"
#include "kerf/law_use.hpp"
#include "kerf/measure.hpp"

namespace kerf {
namespace {

using Names = std::vector<std::string>;

template <class Block>
Names names_of(const std::vector<std::unique_ptr<Block>>& blocks) {
  Names names;
  for (const auto& block : blocks) names.push_back(block->name);
  return names;
}

bool contains(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

class Validator {
 public:
  Validator(const ModelInput& model, const OriginMap& origins, Diagnostics& diagnostics)
      : model_(model),
        origins_(origins),
        diagnostics_(diagnostics),
        parts_(names_of(model.parts)),
        sets_(names_of(model.sets)) {}

  void check() {
    // A plugin registered under a kind whose class it does not derive from leaves its slot empty.
    if (!diagnostics_.has_errors()) check_all_there();
    check_time_and_checks();
    for (const auto& material : model_.materials) {
      check_laws(*material);
      check_parameters(*material);
      check_variables(*material);
      check_reads(*material);
      check_erosion(*material);
    }
    check_parts();
    prepare_meshes();
    for (std::size_t k = 0; k < model_.joined.size(); ++k) check_joint(*model_.joined[k], k);
    for (const auto& set : model_.sets) check_set(*set);
    check_references();
    for (std::size_t i = 0; i < model_.initial_states.size(); ++i) check_initial_state(i);
    check_fields();
    check_loads();
    check_contact_partitioner();
  }

 private:
  void require(const void* plugin, const std::string& path, const char* base) {
    if (!plugin)
      diagnostics_.error(origins_.find(path), fmt::format("`{}` names a type that does not derive from kerf::{}; its "
                                                          "plugin registers it under the wrong kind",
                                                          path, base));
  }
  template <class Item>
  void require_all(const std::vector<std::unique_ptr<Item>>& items, const std::string& path, const char* base) {
    for (const auto& item : items) require(item.get(), path, base);
  }

  void check_all_there() {
    for (const auto& m : model_.materials) {
      const std::string path = "materials." + m->name;
      if (origins_.has(path + ".strength")) require(m->strength.get(), path + ".strength", "Material");
      if (origins_.has(path + ".eos")) require(m->eos.get(), path + ".eos", "Eos");
      if (origins_.has(path + ".solid")) require(m->solid.get(), path + ".solid", "Solid");
      if (m->erosion) require_all(m->erosion->criteria, "materials." + m->name + ".erosion", "ErosionCriterion");
    }
    for (const auto& p : model_.parts) {
      require(p->mesh.get(), "parts." + p->name + ".mesh", "MeshGenerator");
      require(p->element.get(), "parts." + p->name + ".element", "Element");
    }
    require_all(model_.boundaries, "boundaries", "Boundary");
    require_all(model_.contacts, "contacts", "Contact");
    require_all(model_.loads, "loads", "Load");
    require_all(model_.measures, "measures", "Measure");
    require_all(model_.observers, "observers", "Observer");
    require(model_.balance.partitioner.get(), "balance.partitioner", "Partitioner");
    require(model_.balance.policy.get(), "balance.policy", "BalancePolicy");
    require(model_.balance.contact_partitioner.get(), "balance.contact_partitioner", "Partitioner");
  }

  void check_time_and_checks() {
    const TimeInput& time = model_.time;
    if (time.maximum_step > 0.0 && time.minimum_step > 0.0 && time.maximum_step < time.minimum_step)
      diagnostics_.error(origins_.find("time.maximum_step"),
                         fmt::format("`maximum_step` = {} s is less than `minimum_step` = {} s; expected at least that",
                                     time.maximum_step, time.minimum_step));
    if (model_.checks.free_nodes == "drop_beyond" && model_.checks.drop_distance <= 0.0)
      diagnostics_.error(origins_.find("checks.free_nodes"),
                         "drop_beyond needs a distance; expected the key `drop_distance`, for example 10 mm");
  }

  void check_parts() {
    if (model_.parts.empty() && !diagnostics_.has_errors())
      diagnostics_.error(origins_.find("parts"), "there are no parts; expected at least one");
    const Names materials = names_of(model_.materials);
    for (const auto& part : model_.parts)
      if (!part->material.empty() && !materials.empty() && !contains(materials, part->material))
        diagnostics_.error(origins_.find("parts." + part->name + ".material"),
                           fmt::format("there is no material \"{}\"{}", part->material,
                                       suggestion(part->material, materials, "the materials")));
    for (const auto& part : model_.parts)
      if (model_.precision == "single" && part->element && !part->element->computes_in_single())
        diagnostics_.error(origins_.find("precision"),
                           fmt::format("the element {} of part `{}` computes in double precision only; expected double",
                                       part->element->type, part->name));
    for (const auto& part : model_.parts)
      if (part->mesh && part->element && part->mesh->shape().name != std::string(part->element->shape().name))
        diagnostics_.error(
            part->mesh->origin,
            fmt::format("the mesh of part `{}` is made of cells of the shape {}, and the element {} is a "
                        "{}; expected one shape",
                        part->name, part->mesh->shape().name, part->element->type, part->element->shape().name));
    for (const auto& part : model_.parts)
      if (part->element && part->element->shape().dimension != Dimension::solid)
        diagnostics_.error(
            origins_.find("parts." + part->name + ".element"),
            fmt::format("the element {} is {}; expected an element of three dimensions", part->element->type,
                        part->element->shape().dimension == Dimension::plane ? "plane" : "axisymmetric"));
    for (const std::string& name : sets_)
      if (contains(parts_, name))
        diagnostics_.error(origins_.find("sets." + name),
                           fmt::format("a part is called `{}` already; expected another name, since parts and sets are "
                                       "chosen from alike",
                                       name));
  }

  void prepare_meshes() {
    for (const auto& part : model_.parts) {
      bool ready = part->mesh != nullptr;
      if (ready)
        for (const std::string& complaint : part->mesh->prepare()) {
          diagnostics_.error(part->mesh->origin, complaint);
          ready = false;
        }
      is_prepared_.push_back(ready);
    }
  }

  void check_joint(const JoinedInput& joint, std::size_t number) {
    const PartInput* first = nullptr;
    Names seen;
    for (std::size_t i = 0; i < joint.parts.size(); ++i) {
      const std::string& name = joint.parts[i];
      const Origin origin = origins_.find(fmt::format("joined[{}].parts[{}]", number, i));
      if (!contains(parts_, name)) {
        diagnostics_.error(origin,
                           fmt::format("there is no part \"{}\"{}", name, suggestion(name, parts_, "the parts")));
        continue;
      }
      if (contains(seen, name))
        diagnostics_.error(origin, fmt::format("part {} cannot be joined with itself; expected each part once", name));
      seen.push_back(name);
      for (const auto& part : model_.parts) {
        if (part->name != name) continue;
        if (!first) first = part.get();
        const Vec3 d = part->velocity - first->velocity;
        if (norm(d) > 0.0)
          diagnostics_.warning(origin,
                               fmt::format("parts {} and {} start with different velocities and share nodes, which "
                                           "start with the mean, weighted by mass: kinetic energy is lost at once",
                                           first->name, name));
      }
    }
  }

  /// Why a part has not this face. Names "WORD:NAME" stand where NAME alone means several faces.
  static std::string no_face(const PartInput& part, const std::string& face) {
    const Names faces = part.mesh->face_names();
    Names meant, enough;
    for (const std::string& name : faces) {
      const std::string alone = name.substr(name.find(':') + 1);
      if (alone != name && alone == face) meant.push_back(name);
      if (alone == name || !contains(faces, alone)) enough.push_back(name);
    }
    if (meant.size() > 1)
      return fmt::format("the face \"{}\" means more than one set in the mesh of part `{}`; expected one of {}", face,
                         part.name, listed(meant));
    return fmt::format("the mesh of part `{}` has no face \"{}\"{}", part.name, face,
                       suggestion(face, enough, "its faces"));
  }

  void check_set(const SetInput& set) {
    const std::size_t errors_before = diagnostics_.errors().size();
    for (std::size_t i = 0; i < set.parts.size(); ++i)
      if (!contains(parts_, set.parts[i]))
        diagnostics_.error(
            origins_.find(fmt::format("sets.{}.parts[{}]", set.name, i)),
            fmt::format("there is no part \"{}\"{}", set.parts[i], suggestion(set.parts[i], parts_, "the parts")));
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      const PartInput& part = *model_.parts[p];
      if (!is_prepared_[p] || !(set.parts.empty() || contains(set.parts, part.name))) continue;
      if (!set.face.empty() && part.mesh->find_face(set.face) < 0)
        diagnostics_.error(origins_.find("sets." + set.name + ".face"), no_face(part, set.face));
    }
    const bool all_ready = std::find(is_prepared_.begin(), is_prepared_.end(), false) == is_prepared_.end();
    if (all_ready && diagnostics_.errors().size() == errors_before && !parts_.empty() && set.has_proper_box() &&
        is_empty(set))
      diagnostics_.error(origins_.find("sets." + set.name),
                         fmt::format("the set `{}` holds no node; move its box, or name another face", set.name));
  }

  /// Stops at the first node, so that only a set that is wrong costs a pass over the mesh.
  bool is_empty(const SetInput& set) const {
    for (const auto& part : model_.parts) {
      const NodeChoice choice(set, *part);
      if (!choice.possible()) continue;
      const Placement placement(*part);
      for (std::int64_t i = 0; i < part->mesh->n_nodes(); ++i)
        if (choice.takes(*part->mesh, i, placement.apply(part->mesh->node(i)))) return false;
    }
    return true;
  }

  template <class Item>
  void check_names(const Item& item, const Names& names, const char* what, const char* plural) {
    if (item) check_words(*item, item->references(), names, what, plural);
  }
  void check_words(const Plugin& item, const Names& used, const Names& names, const char* what, const char* plural) {
    for (const std::string& name : used)
      if (!contains(names, name))
        diagnostics_.error(origins_.find_text(item.origin, name),
                           fmt::format("there is no {} \"{}\"{}", what, name, suggestion(name, names, plural)));
  }

  void check_references() {
    if (parts_.empty()) return;  // what names them cannot be right, and is not what is wrong
    Names both = parts_;
    both.insert(both.end(), sets_.begin(), sets_.end());
    for (const auto& item : model_.boundaries) check_names(item, both, "part or set", "the parts and sets");
    for (const auto& item : model_.contacts) check_names(item, both, "part or set", "the parts and sets");
    for (const auto& item : model_.loads) check_names(item, both, "part or set", "the parts and sets");
    for (const auto& item : model_.measures) check_names(item, parts_, "part", "the parts");
    for (const auto& item : model_.observers) check_names(item, parts_, "part", "the parts");
  }

  void check_loads() {
    for (const auto& load : model_.loads)
      if (load && !dynamic_cast<const NodalLoad*>(load.get()) && !dynamic_cast<const FacetLoad*>(load.get()) &&
          !dynamic_cast<const BodyLoad*>(load.get()))
        diagnostics_.error(load->origin, fmt::format("the load {} derives from none of kerf::NodalLoad, FacetLoad and "
                                                     "BodyLoad; its plugin must choose one",
                                                     load->type));
  }

  void check_contact_partitioner() {
    const auto& partitioner = model_.balance.contact_partitioner;
    if (partitioner && !partitioner->spatial())
      diagnostics_.error(origins_.find("balance.contact_partitioner"),
                         fmt::format("{} does not divide space between ranks, as contact needs it; expected one that "
                                     "does, such as bisection or zoltan_rcb",
                                     partitioner->type));
  }

  static void add_variables(Names& names, const Law* law) {
    if (!law) return;
    for (const StateVariable& v : law->state_variables())
      if (!contains(names, v.name)) names.push_back(v.name);
  }
  static Names variables_of(const MaterialInput& material) {
    Names names;
    for (const Law* law : material.laws()) add_variables(names, law);
    return names;
  }

  /// The stress comes from a strength and an EOS, or from a solid.
  void check_laws(const MaterialInput& material) {
    const std::string path = "materials." + material.name;
    const bool strength = origins_.has(path + ".strength"), eos = origins_.has(path + ".eos"),
               solid = origins_.has(path + ".solid");
    if (solid && (strength || eos))
      diagnostics_.error(origins_.find(path + ".solid"),
                         fmt::format("material `{}` has a solid, which is the law of the whole stress, and {} too; "
                                     "expected either solid, or strength and eos",
                                     material.name, strength ? "a strength" : "an eos"));
    else if (!solid && !(strength && eos))
      diagnostics_.error(
          origins_.find(path),
          fmt::format("material `{}` has no {}; expected the keys strength and eos, or the key solid", material.name,
                      strength ? "eos"
                      : eos    ? "strength"
                               : "law of the stress"));
  }
  /// What a law cannot start with at the density of its material.
  void check_parameters(const MaterialInput& material) {
    const std::pair<const Law*, const char*> laws[] = {
        {material.strength.get(), "strength"}, {material.eos.get(), "eos"}, {material.solid.get(), "solid"}};
    for (const auto& [law, key] : laws) {
      const auto* checked = dynamic_cast<const DensityCheckedLaw*>(law);
      if (!checked || !(material.density > 0.0)) continue;
      const std::string path = fmt::format("materials.{}.{}", material.name, key);
      for (const ParameterComplaint& c : checked->complaints(material.density))
        diagnostics_.error(origins_.find(c.parameter.empty() ? path : path + "." + c.parameter),
                           c.parameter.empty() ? c.sentence : fmt::format("`{}`: {}", c.parameter, c.sentence));
    }
  }
  /// A variable of a law must not be called as something that every element keeps: whoever reads it would get that.
  void check_variables(const MaterialInput& material) {
    Names taken = {"mass",
                   "volume",
                   "pressure",
                   "internal_energy",
                   "viscous_energy",
                   "deviator_xx",
                   "deviator_yy",
                   "deviator_zz",
                   "deviator_xy",
                   "deviator_yz",
                   "deviator_zx",
                   "reference_x",
                   "reference_y",
                   "reference_z",
                   "initial_length",
                   "erosion_verdicts",
                   "fade_out_cycles",
                   "fade_out_criterion",
                   "fade_out_value",
                   "fade_out_strength",
                   "fade_out_tension",
                   "next_strength_factor",
                   "next_tension_factor",
                   "next_compression_factor",
                   "strength_factor",
                   "tension_factor",
                   "compression_factor",
                   "no_tension",
                   "stress",
                   "density",
                   "von_mises"};
    for (const auto& part : model_.parts)
      if (part->material == material.name) add_variables(taken, part->element.get());
    for (const Law* law : material.laws())
      for (const StateVariable& v : law->state_variables())
        if (contains(taken, v.name))
          diagnostics_.error(law->origin,
                             fmt::format("{} declares the state variable \"{}\", and elements keep something of that "
                                         "name; its author has to call it otherwise",
                                         law->type, v.name));
  }
  /// Whether all laws that were written could be read.
  bool is_complete(const MaterialInput& material) const {
    return material.solid ? !material.strength && !material.eos : material.strength && material.eos;
  }

  /// How many laws of a material declare a variable.
  static std::size_t n_declaring(const MaterialInput& material, const std::string& name) {
    std::size_t n = 0;
    for (const Law* law : material.laws())
      for (const StateVariable& v : law->state_variables()) n += v.name == name ? 1 : 0;
    return n;
  }

  void check_reads(const MaterialInput& material) {
    // A law that could not be read would be missed as the one that declares the variable.
    if (!is_complete(material)) return;
    const Names available = variables_of(material);
    for (const Law* law : material.laws())
      for (const ReadVariable& read : law->reads()) {
        const std::size_t n = n_declaring(material, read.name);
        const std::string what =
            fmt::format("{} reads the state variable \"{}\" ({}), which ", law->type, read.name, read.doc);
        if (n == 0 && !read.is_optional && !is_element_variable(read))
          diagnostics_.error(law->origin, fmt::format("{}no law of material `{}` declares{}", what, material.name,
                                                      available.empty() ? "; its laws declare none"
                                                                        : "; its laws declare " + listed(available)));
        if (n > 1)
          diagnostics_.error(law->origin,
                             fmt::format("{}{} laws of material `{}` declare; expected one", what, n, material.name));
      }
  }
  /// What becomes of elements that fail, and what criteria find wrong with what they read.
  void check_erosion(const MaterialInput& material) {
    if (!material.erosion || !is_complete(material)) return;
    const ErosionInput& erosion = *material.erosion;
    const auto& criteria = erosion.criteria;
    if (criteria.empty() || std::any_of(criteria.begin(), criteria.end(), [](const auto& c) { return !c; })) return;
    const std::string path = "materials." + material.name + ".erosion";
    const bool together = erosion.rule == "all" || (erosion.rule == "at_least" && erosion.count > 1);
    bool any_deleted = false;
    for (std::size_t k = 0; k < criteria.size(); ++k) {
      const ErosionCriterion& c = *criteria[k];
      const Origin origin = origins_.find(fmt::format("{}.criteria[{}].then", path, k));
      any_deleted = any_deleted || c.then == "erosion";
      if (c.then == "no_tension" && !c.can_fade())
        diagnostics_.error(origin, fmt::format("an element that {} has failed cannot be computed any longer; expected "
                                               "`then: erosion`",
                                               c.type));
      if (together && c.then != criteria[0]->then)
        diagnostics_.error(origin, fmt::format("criteria that fail an element together, by `rule: {}`, must agree on "
                                               "what becomes of it; expected `then: {}`",
                                               erosion.rule, criteria[0]->then));
      check_complaints(material, c, fmt::format("{}.criteria[{}]", path, k));
    }
    if (erosion.fade_out > 0 && !any_deleted)
      diagnostics_.error(origins_.find(path + ".fade_out"),
                         "`fade_out` acts before elements are deleted, and every criterion keeps them; expected a "
                         "criterion with `then: erosion`, or no fade_out");
  }
  void check_complaints(const MaterialInput& material, const ErosionCriterion& c, const std::string& path) {
    std::map<std::string, std::string> units = {
        {"pressure", "Pa"}, {"volume", "m3"}, {"mass", "kg"}, {"internal_energy", "J"}, {"viscous_energy", "J"}};
    for (const Law* law : material.laws())
      for (const StateVariable& v : law->state_variables()) units.emplace(v.name, v.unit);
    std::vector<ReadComplaint> complaints = c.complaints(units);
    if (const auto* conditional = dynamic_cast<const ConditionalLaw*>(&c))
      for (const VariableCondition& condition : conditional->conditions())
        for (ReadComplaint& complaint : complaints_about(condition, units)) complaints.push_back(std::move(complaint));
    for (const ReadComplaint& complaint : complaints) {
      Origin origin = origins_.find(path + "." + complaint.parameter);
      origin.column += complaint.offset;
      diagnostics_.error(origin, complaint.sentence);
    }
  }
  /// What every element keeps may be read under a name that the user gives.
  static bool is_element_variable(const ReadVariable& read) {
    return read.name_of && (read.name == "pressure" || read.name == "volume" || read.name == "mass" ||
                            read.name == "internal_energy" || read.name == "viscous_energy");
  }

  void check_initial_value(const InitialStateInput& initial, const std::string& path, const StateVariable& v,
                           const std::string& law) {
    const Quantity q = to_si(initial.value, v.unit);
    if (q.ok() && !v.range.contains(q.value))
      diagnostics_.error(origins_.find(path + ".value"),
                         fmt::format("`value` = {} is out of the range of {} of {}; expected {}",
                                     quantity_text(q.value, v.unit), v.name, law, range_text(v.range, v.unit)));
  }
  void check_initial_state(std::size_t i) {
    const InitialStateInput& initial = *model_.initial_states[i];
    const std::string path = fmt::format("initial_state[{}]", i);
    Names both = parts_;
    both.insert(both.end(), sets_.begin(), sets_.end());
    for (std::size_t k = 0; k < initial.elements.size(); ++k)
      if (!contains(both, initial.elements[k]))
        diagnostics_.error(origins_.find(fmt::format("{}.elements[{}]", path, k)),
                           fmt::format("there is no part or set \"{}\"{}", initial.elements[k],
                                       suggestion(initial.elements[k], both, "the parts and sets")));
    Names known = {"specific_energy"}, units;
    if (initial.variable == known[0]) units.push_back("J/kg");
    bool complete = true;
    for (const auto& material : model_.materials) {
      complete = complete && is_complete(*material);
      if (n_declaring(*material, initial.variable) > 1)
        diagnostics_.error(
            origins_.find(path + ".variable"),
            fmt::format("more than one law of material `{}` declares the state variable \"{}\"; expected a "
                        "variable that one law declares",
                        material->name, initial.variable));
      for (const Law* law : material->laws())
        for (const StateVariable& v : law->state_variables()) {
          if (!contains(known, v.name)) known.push_back(v.name);
          if (v.name != initial.variable) continue;
          if (!contains(units, v.unit)) units.push_back(v.unit);
          check_initial_value(initial, path, v, law->type);
        }
    }
    if (units.empty() && complete)
      diagnostics_.error(origins_.find(path + ".variable"),
                         fmt::format("no law of a material declares the state variable \"{}\"{}", initial.variable,
                                     suggestion(initial.variable, known, "the variables")));
    // Laws of two materials may measure what they call alike in different units.
    for (const std::string& unit : units)
      if (const Quantity q = to_si(initial.value, unit); !q.ok())
        diagnostics_.error(origins_.find(path + ".value"), fmt::format("`value`: {}", q.error));
  }

  /// What the engine keeps of failure and softening, where criteria ask for it.
  static void add_failure_fields(const MaterialInput& material, Names& fields) {
    if (!material.erosion) return;
    const auto any = [&](const auto& asks) {
      const auto& all = material.erosion->criteria;
      return std::any_of(all.begin(), all.end(), [&](const auto& c) { return c && asks(*c); });
    };
    const bool stays = any([](const ErosionCriterion& c) { return c.then == "no_tension"; });
    if (stays) fields.emplace_back("no_tension");
    if (stays || material.erosion->fade_out > 0 || any([](const ErosionCriterion& c) { return c.softens(); }))
      for (const char* name : {"strength_factor", "tension_factor", "compression_factor"}) fields.emplace_back(name);
  }
  void check_fields() {
    Names element_fields = element_field_names();
    element_fields.push_back("effective_plastic_strain");  // stands in the default, whether or not a material has it
    bool complete = true;
    for (const auto& material : model_.materials) {
      complete = complete && is_complete(*material);
      for (const std::string& name : variables_of(*material)) element_fields.push_back(name);
      add_failure_fields(*material, element_fields);
    }
    for (const auto& part : model_.parts) {
      complete = complete && part->element;
      add_variables(element_fields, part->element.get());
    }
    Names of_results = element_fields;
    of_results.emplace_back(owner_field().name);
    if (complete) check_list(model_.output.element_fields, of_results, "element_fields");
    for (const auto& item : model_.observers) {
      if (item && complete) check_words(*item, item->element_fields(), element_fields, "field", "the fields");
      if (item) check_words(*item, item->node_fields(), node_field_names(), "node field", "the node fields");
    }
    check_list(model_.output.node_fields, node_field_names(), "node_fields");
  }
  /// A material in which several laws keep a variable of that name: nobody could know whose is meant.
  const MaterialInput* ambiguous_in(const std::string& name) const {
    for (const auto& material : model_.materials)
      if (n_declaring(*material, name) > 1) return material.get();
    return nullptr;
  }
  void check_list(const Names& used, const Names& known, const std::string& key) {
    Names fields, seen;
    for (const std::string& name : known)
      if (!contains(fields, name)) fields.push_back(name);
    for (std::size_t i = 0; i < used.size(); ++i) {
      const Origin origin = origins_.find(fmt::format("output.{}[{}]", key, i));
      if (!contains(fields, used[i]))
        diagnostics_.error(
            origin, fmt::format("there is no field \"{}\"{}", used[i], suggestion(used[i], fields, "the fields")));
      else if (const MaterialInput* twice = ambiguous_in(used[i]); twice != nullptr)
        diagnostics_.error(origin,
                           fmt::format("more than one law of material `{}` declares \"{}\"; expected a field that one "
                                       "law declares",
                                       twice->name, used[i]));
      else if (contains(seen, used[i]))
        diagnostics_.error(origin, fmt::format("field \"{}\" is listed twice; expected once", used[i]));
      seen.push_back(used[i]);
    }
  }

  const ModelInput& model_;
  const OriginMap& origins_;
  Diagnostics& diagnostics_;
  const Names parts_, sets_;
  std::vector<bool> is_prepared_;
};

}  // namespace

void validate(const ModelInput& model, const OriginMap& origins, Diagnostics& diagnostics) {
  Validator(model, origins, diagnostics).check();
}

}  // namespace kerf
