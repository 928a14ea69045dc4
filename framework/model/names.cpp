// Goes from ids of the model to numbers within the parts' meshes, which the generators have names for.
#include "model/names.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "model/model.hpp"

namespace kerf {

bool has_labels(const Model& model) {
  return std::any_of(model.parts.begin(), model.parts.end(),
                     [](const PartModel& part) { return part.input->mesh->has_labels(); });
}

std::int64_t element_label(const Model& model, std::int64_t id) {
  const PartModel& part = model.parts[static_cast<std::size_t>(model.part_of_element(id))];
  return part.input->mesh->has_labels() ? part.input->mesh->element_label(id - part.first_element) : id;
}

std::int64_t node_label(const Model& model, std::int64_t id) {
  const PartModel& part = model.parts[static_cast<std::size_t>(model.part_of_node(id))];
  if (!part.input->mesh->has_labels()) return id;
  return part.input->mesh->node_label(model.shared.before_joining(id) - part.first_node);
}

std::string element_name(const Model& model, std::int64_t id) {
  return fmt::format("element {} of part {}", element_label(model, id),
                     model.parts[static_cast<std::size_t>(model.part_of_element(id))].input->name);
}

std::string node_name(const Model& model, std::int64_t id) {
  return fmt::format("node {} of part {}", node_label(model, id),
                     model.parts[static_cast<std::size_t>(model.part_of_node(id))].input->name);
}

}  // namespace kerf
