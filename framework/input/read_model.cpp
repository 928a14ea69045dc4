// Reads the text of an input file into a model.
#include "input/read_model.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "input/balance_keys.hpp"
#include "input/binder.hpp"
#include "input/files_of_input.hpp"
#include "input/substitute.hpp"
#include "input/work_model_file.hpp"
#include "input/yaml_reader.hpp"
#include "kerf/measure.hpp"

namespace kerf {

namespace {

/// Whether a formula names a parameter.
bool names_a_parameter_within(const Node& node) {
  const auto of_entry = [](const Entry& e) { return e.key != "parameters" && names_a_parameter_within(e.value); };
  return node.text.find('$') != std::string::npos ||
         std::any_of(node.items.begin(), node.items.end(), names_a_parameter_within) ||
         std::any_of(node.entries.begin(), node.entries.end(), of_entry);
}

/// Whether an entry means the same as leaving its key out. Restart files from before the key existed still match then.
bool is_default(const Entry& entry) { return entry.key == "precision" && entry.value.text == "double"; }

/// The value of an entry; of `checks` without the limit of time on the clock, which computes nothing.
Node without_limit(const Entry& entry) {
  Node value = entry.value;
  if (entry.key == "checks") std::erase_if(value.entries, [](const Entry& e) { return e.key == "stall_limit"; });
  return value;
}

/// Replaces names of mesh files by what is in them: a mesh may have another name and another form at a restart.
void name_meshes_by_content(Node& node, const MeshCache& meshes) {
  Entry* parts = node.find("parts");
  if (!parts) return;
  for (Entry& part : parts->value.entries)
    if (Entry* mesh = part.value.find("mesh"))
      for (Entry& entry : mesh->value.entries)
        if (const auto at = meshes.digests.find(entry.value.text); at != meshes.digests.end())
          entry.value.text = at->second;
}

/// Of precision, materials, parts, joints, sets, initial states, boundaries, contacts, checks, loads, curves with the
/// files that they name, the choice of the time step, and observers if one of them adds forces: what is computed. How
/// long, how it is distributed and what is written may change at a restart.
std::string physics_digest(const Node& root, const std::vector<std::string>& files, bool observers_act) {
  Digest hash;
  if (const Entry* observers = root.find("observers"); observers && observers_act) hash.add(observers->value);
  for (const char* key : {"precision", "materials", "parts", "joined", "sets", "initial_state", "boundaries",
                          "contacts", "checks", "loads", "curves"})
    if (const Entry* entry = root.find(key); entry && !is_default(*entry)) {
      const Node value = without_limit(*entry);
      if (!value.is_map() || !value.entries.empty() || entry->value.entries.empty()) hash.add(value);
    }
  if (const Entry* time = root.find("time"))
    for (const Entry& entry : time->value.entries)
      if (entry.key != "end" && entry.key != "maximum_cycles") {
        hash.add(entry.key);
        hash.add(entry.value);
      }
  for (const std::string& text : files)
    if (!text.empty()) hash.add(text);
  // Formulas keep the names of parameters.
  if (const Entry* parameters = root.find("parameters"); parameters && names_a_parameter_within(root))
    hash.add(parameters->value);
  return std::to_string(hash.value());
}

/// The block `materials` with its key.
Node materials_of(const Node& root) {
  Node block;
  block.kind = Node::Kind::map;
  block.entries.push_back(*root.find("materials"));
  return block;
}

/// Reads the files that the block `balance` names.
void read_balance_files(BalanceInput& balance, const std::string& folder, const FileReader& read,
                        const Registry& registry, const OriginMap& origins, MeshCache& meshes,
                        Diagnostics& diagnostics) {
  if (!balance.work_model.empty()) {
    const Origin where = origins.find("balance.work_model");
    balance.work =
        read_work_model(path_from(where.text(), folder, balance.work_model), where, read, registry, diagnostics);
  }
  if (!balance.foresee.empty()) {
    balance.foresee_origin = origins.find("balance.foresee").text();
    balance.foresee = path_from(balance.foresee_origin, folder, balance.foresee);
  }
  if (!balance.policy) return;
  const FilesOfInput files(balance.policy->origin, folder, read, meshes);
  for (const std::string& line : balance.policy->prepare(files)) diagnostics.error_line(line);
}

/// Reads the files that meshes of parts name.
void load_meshes(const ModelInput& model, const std::string& folder, const FileReader& read, MeshCache& meshes,
                 Diagnostics& diagnostics) {
  for (const auto& part : model.parts) {
    if (!part || !part->mesh) continue;
    const FilesOfInput files(part->mesh->origin, folder, read, meshes);
    for (const std::string& line : part->mesh->load(files)) diagnostics.error_line(line);
  }
}

}  // namespace

std::unique_ptr<ModelInput> read_model_input(const std::string& file_name, const std::string& bytes,
                                             const std::vector<std::string>& overrides, const Registry& registry,
                                             Diagnostics& diagnostics, OriginMap& origins, const FileReader& read,
                                             const std::vector<std::string>& library) {
  std::optional<Node> root = read_yaml(file_name, bytes, diagnostics);
  if (!root) throw InputError(diagnostics.errors());
  return read_model_document(file_name, std::move(*root), {}, overrides, registry, diagnostics, origins, read, library);
}

std::unique_ptr<ModelInput> read_model_document(const std::string& file_name, Node root, MeshCache meshes,
                                                const std::vector<std::string>& overrides, const Registry& registry,
                                                Diagnostics& diagnostics, OriginMap& origins, const FileReader& read,
                                                const std::vector<std::string>& library) {
  const Origin top{std::make_shared<const std::string>(file_name), 1, 1};
  for (const std::string& text : overrides) apply_override(root, text, diagnostics);
  substitute_parameters(root, diagnostics);
  move_balance_keys(root, diagnostics);
  auto model = std::make_unique<ModelInput>();
  if (root.is_nothing()) {
    diagnostics.error(top, "the input is empty; expected at least the keys time, materials and parts");
    return model;
  }
  const std::string folder = std::filesystem::path(file_name).parent_path().string();
  model->library_uses = expand_library(root, folder, library, read, diagnostics);
  if (!model->library_uses.empty()) model->materials_text = yaml_text(materials_of(root));
  origins.add("", top);
  CurveTable curves(model->curves, folder, read, origins, diagnostics);
  const Entry* parameters = std::as_const(root).find("parameters");
  Binder(registry, diagnostics, origins, &curves, parameters ? &parameters->value : nullptr)
      .bind_block(Schema<ModelInput>::described<ModelInput>(), root, model.get(), "", top);
  for (std::size_t k = 0; k < model->joined.size(); ++k)
    model->joined[k]->origin = origins.find("joined[" + std::to_string(k) + "].parts").text();
  curves.finish();
  read_balance_files(model->balance, folder, read, registry, origins, meshes, diagnostics);
  load_meshes(*model, folder, read, meshes, diagnostics);
  for (const std::string& line : meshes.warnings) diagnostics.warning_line(line);
  const bool observers_act = std::any_of(model->observers.begin(), model->observers.end(),
                                         [](const auto& o) { return o && o->calls().forces; });
  Node computed = root;
  name_meshes_by_content(computed, meshes);
  model->digest = physics_digest(computed, curves.file_texts(), observers_act);
  for (std::size_t i = 0; i < model->initial_states.size(); ++i)
    model->initial_states[i]->origin = origins.find("initial_state[" + std::to_string(i) + "]").text();
  model->end_origin = origins.find("time.end").text();
  return model;
}

}  // namespace kerf
