// Reads samples, and makes materials of them.
#include "conformance/samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "input/binder.hpp"
#include "input/curve_table.hpp"
#include "input/yaml_reader.hpp"

namespace kerf {

namespace {

// The partners of a law that is not the whole material. This strength keeps all that criteria read.
constexpr const char* usual_strength =
    "{type: johnson_cook, shear_modulus: 79.6 GPa, A: 806 MPa, B: 614 MPa, n: 0.168, C: 0.0089, m: 1.1, "
    "reference_temperature: 293.15 K, melting_temperature: 1813.15 K, specific_heat: 460 J/(kg K)}";
constexpr const char* usual_eos = "{type: mie_gruneisen, c0: 4570 m/s, s: 1.49, gamma0: 1.93, gamma_slope: 0.5}";

std::string near_text(const std::string& name, const std::vector<std::string>& known) {
  const std::string near = nearest_name(name, known);
  return near.empty() ? "" : "; did you mean " + near + "?";
}

TypeSample read_sample(const Registry& registry, const std::string& kind, const Entry& entry, Diagnostics& diagnostics,
                       OriginMap& origins) {
  TypeSample sample;
  sample.kind = kind;
  sample.name = entry.key;
  if (!entry.value.is_map() && !entry.value.is_nothing())
    diagnostics.error(entry.key_origin, fmt::format("the sample of {} is {}; expected a map of its parameters",
                                                    sample.type(), entry.value.what()));
  sample.parameters = entry.value;
  sample.parameters.kind = Node::Kind::map;
  Node settings;
  settings.kind = Node::Kind::map;
  if (const Entry* found = entry.value.find("beside")) sample.beside = found->value;
  if (const Entry* found = entry.value.find("conformance")) settings = found->value;
  std::erase_if(sample.parameters.entries, [](const Entry& e) { return e.key == "beside" || e.key == "conformance"; });
  Binder(registry, diagnostics, origins)
      .bind_block(Schema<SampleSettings>::described<SampleSettings>(), settings, &sample.settings,
                  sample.type() + ".conformance", entry.key_origin);
  return sample;
}

/// A file may have the samples of several libraries, so a type that is not there is no error.
bool knows(const Registry& registry, const std::string& kind, const Entry& entry, Diagnostics& diagnostics) {
  if (registry.find(kind, entry.key)) return true;
  diagnostics.warning(entry.key_origin, fmt::format("no {} of type \"{}\" is loaded, so its sample is not used{}", kind,
                                                    entry.key, near_text(entry.key, registry.names(kind))));
  return false;
}

}  // namespace

void SampleSettings::describe(Schema<SampleSettings>& s) {
  s.real(&SampleSettings::order, "order", "-", between(0.5, 4.0), "order of convergence with the time step")
      .by_default("1");
  s.real(&SampleSettings::strain, "strain", "-", between(1e-6, 0.5), "size of the strains of the paths")
      .by_default("0.02");
  s.real(&SampleSettings::compression, "compression", "-", between(0.0, 0.5),
         "size of the volumetric strains of the paths")
      .by_default("0.02");
  s.real(&SampleSettings::duration, "duration", "s", positive, "time that a path takes").by_default("20 us");
  s.boolean(&SampleSettings::isotropic, "isotropic", "whether the law is the same in all directions")
      .by_default("true");
  s.real(&SampleSettings::tangent_excess, "tangent_excess", "-", between(1.0, 2.0),
         "how much stiffer than its moduli the law may be, where that is a trait of its flow")
      .by_default("1");
  s.text(&SampleSettings::velocity, "velocity", "velocity with which bodies meet in runs").by_default("200 60 0 m/s");
  s.text_map(&SampleSettings::initial_state, "initial_state", "state variables before a path").optional();
}

bool is_law_kind(const std::string& kind) {
  return std::find(std::begin(law_kinds), std::end(law_kinds), kind) != std::end(law_kinds);
}

Samples::Samples(const std::string& path, const Registry& registry) {
  std::string failure;
  const std::string text = read_text_file(path, failure);
  if (!failure.empty()) throw InputError({fmt::format("{}: error: the samples cannot be read: {}", path, failure)});
  Diagnostics diagnostics;
  OriginMap origins;
  const Node root = read_yaml(path, text, diagnostics).value_or(Node{});
  diagnostics.throw_if_errors();
  std::vector<std::string> kinds = registry.kinds();
  kinds.emplace_back("inputs");
  for (const Entry& kind : root.entries) {
    if (std::find(kinds.begin(), kinds.end(), kind.key) == kinds.end()) {
      diagnostics.error(kind.key_origin, fmt::format("there is no kind of plugins called \"{}\"{}", kind.key,
                                                     near_text(kind.key, kinds)));
      continue;
    }
    for (const Entry& entry : kind.value.entries) {
      if (kind.key != "inputs") {
        if (knows(registry, kind.key, entry, diagnostics))
          samples_.push_back(read_sample(registry, kind.key, entry, diagnostics, origins));
        continue;
      }
      for (const Entry& type : entry.value.entries) {
        if (!knows(registry, entry.key, type, diagnostics)) continue;
        const Entry* input = type.value.find("input");
        if (!input || type.value.entries.size() != 1) {
          diagnostics.error(type.key_origin, "expected {input: FILE}, a whole input file, seen from this file");
          continue;
        }
        inputs_[{entry.key, type.key}] =
            (std::filesystem::path(path).parent_path() / input->value.text).lexically_normal().string();
      }
    }
  }
  diagnostics.throw_if_errors();
  warnings_ = diagnostics.warnings();
}

const TypeSample* Samples::find(const std::string& kind, const std::string& name) const {
  const auto found = std::find_if(samples_.begin(), samples_.end(),
                                  [&](const TypeSample& s) { return s.kind == kind && s.name == name; });
  return found == samples_.end() ? nullptr : &*found;
}

std::string Samples::input(const std::string& kind, const std::string& name) const {
  const auto found = inputs_.find({kind, name});
  return found == inputs_.end() ? "" : found->second;
}

void set_entry(Node& map, const std::string& key, Node value) {
  map.kind = Node::Kind::map;
  if (Entry* found = map.find(key)) {
    found->value = std::move(value);
    return;
  }
  Entry entry;
  entry.key = key;
  entry.value = std::move(value);
  map.entries.push_back(std::move(entry));
}

Node text_node(const std::string& text) {
  Node node;
  node.kind = Node::Kind::scalar;
  node.text = text;
  return node;
}

Node tree_of(const std::string& text) {
  Diagnostics diagnostics;
  Node node = node_from_text(text, Origin{}, diagnostics);
  diagnostics.throw_if_errors();
  return node;
}

Node material_of(const TypeSample& sample, bool bare_eos) {
  Node law = sample.parameters, material;
  set_entry(law, "type", text_node(sample.name));
  set_entry(material, "density", text_node("7850 kg/m3"));
  if (sample.kind == "solid") {
    set_entry(material, "solid", law);
  } else {
    const bool bare = bare_eos && sample.kind == "eos";
    set_entry(material, "strength", tree_of(bare ? "{type: hydrodynamic}" : usual_strength));
    set_entry(material, "eos", tree_of(usual_eos));
    if (sample.kind == "material") set_entry(material, "strength", law);
    if (sample.kind == "eos") set_entry(material, "eos", law);
  }
  if (sample.kind == "erosion") {
    Node criteria;
    criteria.kind = Node::Kind::list;
    criteria.items.push_back(law);
    Node erosion;
    set_entry(erosion, "criteria", criteria);
    set_entry(material, "erosion", erosion);
  }
  for (const Entry& e : sample.beside.entries) set_entry(material, e.key, e.value);
  return material;
}

void bind(const Registry& registry, const Description& description, const Node& node, void* target,
          const std::string& path) {
  Diagnostics diagnostics;
  OriginMap origins;
  Binder(registry, diagnostics, origins).bind_block(description, node, target, path, node.origin);
  diagnostics.throw_if_errors();
}

std::unique_ptr<Plugin> make_sample(const Registry& registry, const TypeSample& sample, const Node& parameters) {
  Made made = registry.make(sample.kind, sample.name);
  bind(registry, *made.plugin->description, parameters, made.parameters, sample.name);
  return std::move(made.plugin);
}

SampleLaws::SampleLaws(const Registry& registry, const TypeSample& sample_of, bool bare_eos) : sample(sample_of) {
  bind(registry, Schema<MaterialInput>::described<MaterialInput>(), material_of(sample, bare_eos), &material,
       "materials.sample");
  TypeSample hex8;
  hex8.kind = "element";
  hex8.name = "hex8";
  // The work of bulk viscosity is none of the law's.
  element.reset(dynamic_cast<Element*>(
      make_sample(registry, hex8, tree_of("{linear_viscosity: 0, quadratic_viscosity: 0}")).release()));
  if (sample.kind == "material") law = material.strength.get();
  if (sample.kind == "eos") law = material.eos.get();
  if (sample.kind == "solid") law = material.solid.get();
  if (sample.kind == "erosion") law = material.erosion->criteria.front().get();
}

}  // namespace kerf
