// Reads the text of an input file into a model.
#include "input/read_model.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "input/binder.hpp"
#include "input/substitute.hpp"
#include "input/yaml_reader.hpp"
#include "kerf/measure.hpp"

namespace kerf {

namespace {

/// FNV-1a.
void add(const std::string& text, std::uint64_t& hash) {
  for (const char c : text + '\n') hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
}

/// Of keys and texts, in the order of writing.
void digest(const Node& node, std::uint64_t& hash) {
  add(node.text, hash);
  for (const Node& item : node.items) digest(item, hash);
  for (const Entry& entry : node.entries) {
    add(entry.key, hash);
    digest(entry.value, hash);
  }
}

/// Whether a formula names a parameter.
bool names_a_parameter_within(const Node& node) {
  const auto of_entry = [](const Entry& e) { return e.key != "parameters" && names_a_parameter_within(e.value); };
  return node.text.find('$') != std::string::npos ||
         std::any_of(node.items.begin(), node.items.end(), names_a_parameter_within) ||
         std::any_of(node.entries.begin(), node.entries.end(), of_entry);
}

/// Whether an entry means the same as leaving its key out. Restart files from before the key existed still match then.
bool is_default(const Entry& entry) { return entry.key == "precision" && entry.value.text == "double"; }

/// Of precision, materials, parts, joints, sets, initial states, boundaries, contacts, checks, loads, curves with the
/// files that they name, and the choice of the time step: what is computed. How long, how it is distributed and what is
/// written may change at a restart.
std::string physics_digest(const Node& root, const std::vector<std::string>& files) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char* key : {"precision", "materials", "parts", "joined", "sets", "initial_state", "boundaries",
                          "contacts", "checks", "loads", "curves"})
    if (const Entry* entry = root.find(key); entry && !is_default(*entry)) digest(entry->value, hash);
  if (const Entry* time = root.find("time"))
    for (const Entry& entry : time->value.entries)
      if (entry.key != "end" && entry.key != "maximum_cycles") {
        digest(Node{.origin = {}, .text = entry.key, .items = {}, .entries = {}}, hash);
        digest(entry.value, hash);
      }
  for (const std::string& text : files)
    if (!text.empty()) add(text, hash);
  // Formulas keep the names of parameters.
  if (const Entry* parameters = root.find("parameters"); parameters && names_a_parameter_within(root))
    digest(parameters->value, hash);
  return std::to_string(hash);
}

}  // namespace

std::unique_ptr<ModelInput> read_model_input(const std::string& file_name, const std::string& bytes,
                                             const std::vector<std::string>& overrides, const Registry& registry,
                                             Diagnostics& diagnostics, OriginMap& origins, const FileReader& read) {
  std::optional<Node> root = read_yaml(file_name, bytes, diagnostics);
  if (!root) throw InputError(diagnostics.errors());
  const Origin top{std::make_shared<const std::string>(file_name), 1, 1};
  for (const std::string& text : overrides) apply_override(*root, text, diagnostics);
  substitute_parameters(*root, diagnostics);
  auto model = std::make_unique<ModelInput>();
  if (root->is_nothing()) {
    diagnostics.error(top, "the input is empty; expected at least the keys time, materials and parts");
    return model;
  }
  origins.add("", top);
  CurveTable curves(model->curves, std::filesystem::path(file_name).parent_path().string(), read, origins, diagnostics);
  const Entry* parameters = std::as_const(*root).find("parameters");
  Binder(registry, diagnostics, origins, &curves, parameters ? &parameters->value : nullptr)
      .bind_block(Schema<ModelInput>::described<ModelInput>(), *root, model.get(), "", top);
  for (std::size_t k = 0; k < model->joined.size(); ++k)
    model->joined[k]->origin = origins.find("joined[" + std::to_string(k) + "].parts").text();
  curves.finish();
  model->digest = physics_digest(*root, curves.file_texts());
  for (std::size_t i = 0; i < model->initial_states.size(); ++i)
    model->initial_states[i]->origin = origins.find("initial_state[" + std::to_string(i) + "]").text();
  model->end_origin = origins.find("time.end").text();
  return model;
}

}  // namespace kerf
