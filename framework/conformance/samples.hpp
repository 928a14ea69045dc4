// The samples of a plugin: for each type one set of parameters that is valid, what stands beside it, and how it is
// tested. The format is that of tests/data/sample_laws.yaml and is explained in doc/plugin-authors/testing_a_plugin.md.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "input/document.hpp"
#include "input/model_input.hpp"
#include "plugin/registry.hpp"

namespace kerf {

/// The block `conformance` of a sample: how the type is tested.
struct SampleSettings {
  double order = 1.0;  // of convergence with the step
  double strain = 0.02, compression = 0.02;  // greatest of the paths [-]
  double duration = 20e-6;  // of the paths [s]
  bool isotropic = true;
  double tangent_excess = 1.0;  // greatest tangent over what the moduli say
  std::string velocity;  // of the impacts in runs
  std::map<std::string, std::string> initial_state;
  static void describe(Schema<SampleSettings>& s);
};

struct TypeSample {
  std::string kind, name;
  Node parameters;  // of the type
  Node beside;  // what else its material, or its part, has
  SampleSettings settings;
  std::string type() const { return kind + "." + name; }
};

/// The kinds of laws that work on blocks of points.
inline constexpr const char* law_kinds[] = {"material", "eos", "solid", "erosion"};
bool is_law_kind(const std::string& kind);

class Samples {
 public:
  Samples() = default;
  /// Throws InputError where the file cannot be read, or has what no sample has.
  Samples(const std::string& path, const Registry& registry);

  const TypeSample* find(const std::string& kind, const std::string& name) const;  // null where absent
  /// Path of the whole input that shows a type at work; empty where there is none.
  std::string input(const std::string& kind, const std::string& name) const;
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  std::vector<TypeSample> samples_;
  std::vector<std::string> warnings_;
  std::map<std::pair<std::string, std::string>, std::string> inputs_;
};

/// A map with one more key; a key that is there already gets the value.
void set_entry(Node& map, const std::string& key, Node value);
Node text_node(const std::string& text);
/// The tree of a text in YAML. Pre: it is valid.
Node tree_of(const std::string& text);

/// The block of a material that has the law of the sample, and the usual partners where `beside` names no others.
/// `bare_eos`: an equation of state gets no strength to speak of, where it does without.
Node material_of(const TypeSample& sample, bool bare_eos = false);

/// Makes what a description says of a block. Throws InputError with all mistakes.
void bind(const Registry& registry, const Description& description, const Node& node, void* target,
          const std::string& path);
/// The type of a sample, made as a run makes it. Throws InputError with all mistakes.
std::unique_ptr<Plugin> make_sample(const Registry& registry, const TypeSample& sample, const Node& parameters);

/// A material with the law of a sample, and the element hex8 without bulk viscosity, made afresh.
class SampleLaws {
 public:
  explicit SampleLaws(const Registry& registry, const TypeSample& sample, bool bare_eos = false);
  MaterialInput material;
  std::unique_ptr<Element> element;
  const TypeSample& sample;
  const Law* law = nullptr;  // that of the sample, in `material`
};

}  // namespace kerf
