// Checks across blocks of the input: every name that is used must be there, and fit its use.
#include <fmt/format.h>

#include <algorithm>

#include "input/node_choice.hpp"
#include "input/parameter_text.hpp"
#include "input/placement.hpp"
#include "input/read_model.hpp"
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
    for (const auto& material : model_.materials) check_reads(*material);
    check_parts();
    prepare_meshes();
    for (const auto& set : model_.sets) check_set(*set);
    check_references();
    check_fields();
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
      require(m->strength.get(), "materials." + m->name + ".strength", "Material");
      require(m->eos.get(), "materials." + m->name + ".eos", "Eos");
      if (m->erosion) require_all(m->erosion->criteria, "materials." + m->name + ".erosion", "ErosionCriterion");
    }
    for (const auto& p : model_.parts) {
      require(p->mesh.get(), "parts." + p->name + ".mesh", "MeshGenerator");
      require(p->element.get(), "parts." + p->name + ".element", "Element");
    }
    require_all(model_.boundaries, "boundaries", "Boundary");
    require_all(model_.contacts, "contacts", "Contact");
    require_all(model_.measures, "measures", "Measure");
    require(model_.balance.partitioner.get(), "balance.partitioner", "Partitioner");
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
      const Names faces = part.mesh->face_names();
      if (!set.face.empty() && !contains(faces, set.face))
        diagnostics_.error(origins_.find("sets." + set.name + ".face"),
                           fmt::format("the mesh of part `{}` has no face \"{}\"{}", part.name, set.face,
                                       suggestion(set.face, faces, "its faces")));
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
    if (!item) return;
    for (const std::string& name : item->references())
      if (!contains(names, name))
        diagnostics_.error(origins_.find_text(item->origin, name),
                           fmt::format("there is no {} \"{}\"{}", what, name, suggestion(name, names, plural)));
  }

  void check_references() {
    if (parts_.empty()) return;  // what names them cannot be right, and is not what is wrong
    Names both = parts_;
    both.insert(both.end(), sets_.begin(), sets_.end());
    for (const auto& item : model_.boundaries) check_names(item, both, "part or set", "the parts and sets");
    for (const auto& item : model_.contacts) check_names(item, both, "part or set", "the parts and sets");
    for (const auto& item : model_.measures) check_names(item, parts_, "part", "the parts");
  }

  static void add_variables(Names& names, const Law* law) {
    if (!law) return;
    for (const StateVariable& v : law->state_variables())
      if (!contains(names, v.name)) names.push_back(v.name);
  }
  static Names variables_of(const MaterialInput& material) {
    Names names;
    add_variables(names, material.strength.get());
    add_variables(names, material.eos.get());
    if (material.erosion)
      for (const auto& criterion : material.erosion->criteria) add_variables(names, criterion.get());
    return names;
  }

  void check_reads(const MaterialInput& material) {
    // A law that could not be read would be missed as the one that declares the variable.
    if (!material.erosion || !material.strength || !material.eos) return;
    const Names available = variables_of(material);
    for (const auto& criterion : material.erosion->criteria) {
      if (!criterion || !criterion->description) continue;
      for (const ReadVariable& read : criterion->description->reads)
        if (!contains(available, read.name))
          diagnostics_.error(
              criterion->origin,
              fmt::format("{} reads the state variable \"{}\" ({}), which no law of material `{}` declares{}",
                          criterion->type, read.name, read.doc, material.name,
                          available.empty() ? "; its laws declare none" : "; its laws declare " + listed(available)));
    }
  }

  void check_fields() {
    // The last stands in the default of `element_fields`, whether or not a material has it.
    Names element_fields = {"stress",          "pressure",  "density",
                            "internal_energy", "von_mises", "effective_plastic_strain"};
    bool complete = true;
    for (const auto& material : model_.materials) {
      complete = complete && material->strength && material->eos;
      for (const std::string& name : variables_of(*material)) element_fields.push_back(name);
    }
    for (const auto& part : model_.parts) {
      complete = complete && part->element;
      add_variables(element_fields, part->element.get());
    }
    if (complete) check_list(model_.output.element_fields, element_fields, "element_fields");
    check_list(model_.output.node_fields, {"velocity", "displacement", "mass"}, "node_fields");
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
