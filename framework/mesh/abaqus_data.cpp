// Data lines of an Abaqus deck: nodes, elements, members of sets and surfaces, places of instances.
#include <limits>

#include "mesh/abaqus_parser.hpp"

namespace kerf::abaqus {

void AbaqusParser::read_line() {
  switch (data_) {
    case Data::nodes:
      return read_node();
    case Data::solids:
      return read_solid();
    case Data::left_out:
      return read_left_out();
    case Data::set:
      return generate_ ? read_generated() : read_set_line();
    case Data::surface:
      return read_surface_line();
    case Data::instance:
      return read_instance_line();
    case Data::other:
      return;
  }
}

bool AbaqusParser::label(Fields& fields, std::int64_t& value, const char* expected) {
  const char* at = fields.at();
  if (!fields.integer(value)) return bad_line(at, "numbers", expected), false;
  if (value > 0 && value <= std::numeric_limits<std::int32_t>::max()) return true;
  errors_.at(lines_.place_of(at), "label", "the number is " + std::to_string(value) + "; expected 1 to 2147483647");
  return false;
}

void AbaqusParser::read_node() {
  Fields fields(lines_.line());
  std::int64_t number = 0;
  std::array<double, 3> x{};
  if (!label(fields, number, "the number of a node")) return;
  for (double& coordinate : x) {
    const char* at = fields.at();
    if (!fields.real(coordinate)) return bad_line(at, "nodes", "number, x, y, z");
  }
  body_->node_labels.push_back(number);
  body_->points.push_back(x);
  body_->node_lines.push_back(lines_.number());
}

void AbaqusParser::read_solid() {
  Fields fields(lines_.line());
  const auto wanted = static_cast<std::size_t>(solid_.n_nodes) + 1;
  if (record_.empty()) record_place_ = lines_.place_of(lines_.line().data());
  while (!fields.at_end() && record_.size() < wanted) {
    std::int64_t number = 0;
    if (!label(fields, number, "whole numbers of nodes between commas")) return record_.clear();
    record_.push_back(number);
  }
  if (!fields.at_end()) {
    bad_line(fields.at(), "elements", "the end of the line, for all nodes have been read");
    record_.clear();
  } else if (record_.size() == wanted) {
    add_solid();
  } else if (!lines_.goes_on()) {
    errors_.at(record_place_, "too few nodes",
               "an element of type " + solid_.name + " has " + std::to_string(record_.size() - 1) +
                   " nodes; expected " + std::to_string(solid_.n_nodes));
    record_.clear();
  }
}

void AbaqusParser::add_solid() {
  const auto n = [&](std::size_t i) { return static_cast<std::int32_t>(record_[i]); };
  std::array<std::int32_t, 8> cell{n(1), n(2), n(3), n(3), n(4), n(4), n(4), n(4)};
  if (solid_.n_nodes == 5) cell = {n(1), n(2), n(3), n(4), n(5), n(5), n(5), n(5)};
  if (solid_.n_nodes == 6) cell = {n(1), n(2), n(3), n(3), n(4), n(5), n(6), n(6)};
  if (solid_.n_nodes == 8) cell = {n(1), n(2), n(3), n(4), n(5), n(6), n(7), n(8)};
  body_->cells.push_back(cell);
  body_->cell_labels.push_back(record_[0]);
  body_->cell_places.push_back(record_place_);
  body_->n_corners.push_back(static_cast<std::uint8_t>(solid_.n_nodes));
  record_.clear();
}

void AbaqusParser::read_left_out() {
  Fields fields(lines_.line());
  std::int64_t number = 0;
  if (!goes_on_ && label(fields, number, "the number of an element")) {
    body_->left_labels.push_back(number);
    ++body_->left_out[left_type_];
  }
  goes_on_ = lines_.goes_on();
}

void AbaqusParser::read_set_line() {
  AbaqusSet& set = body_->sets.back();
  Fields fields(lines_.line());
  while (!fields.at_end()) {
    const FilePlace place = lines_.place_of(fields.at());
    AbaqusItem item;
    item.place = place;
    const std::string_view text = fields.text();
    if (text.empty()) continue;
    const char* stop = read_integer(text.data(), text.data() + text.size(), item.first);
    item.last = item.first;
    if (stop != text.data() + text.size()) {
      item.kind = AbaqusItem::Kind::name;
      item.name = static_cast<std::int32_t>(body_->names.size());
      const bool is_quoted = text.size() > 1 && text.front() == '"' && text.back() == '"';
      body_->names.emplace_back(is_quoted ? text.substr(1, text.size() - 2) : text);
    }
    AbaqusItem* before = set.items.empty() ? nullptr : &set.items.back();
    const bool follows = before && before->kind == AbaqusItem::Kind::labels && item.kind == before->kind;
    if (follows && before->last < item.first && item.first - 1 == before->last)
      before->last = item.first;
    else
      set.items.push_back(item);
  }
}

void AbaqusParser::read_generated() {
  Fields fields(lines_.line());
  AbaqusItem item;
  item.kind = AbaqusItem::Kind::generated;
  item.place = lines_.place_of(fields.at());
  if (!label(fields, item.first, "first, last, step") || !label(fields, item.last, "first, last, step")) return;
  if (!fields.at_end() && !label(fields, item.step, "first, last, step")) return;
  if (item.last < item.first)
    return bad_line(lines_.line().data(), "sets", "a last number that is not below the first");
  body_->sets.back().items.push_back(item);
}

void AbaqusParser::read_surface_line() {
  AbaqusSurface& surface = body_->surfaces.back();
  Fields fields(lines_.line());
  const FilePlace place = lines_.place_of(fields.at());
  const std::string cells(fields.text()), face = upper(fields.text());
  if (face.size() == 2 && face[0] == 'S' && face[1] >= '1' && face[1] <= '6') {
    surface.faces.push_back({cells, face[1] - '0', place});
    return;
  }
  errors_.warn(place, "surface " + in_quotes(surface.name) + " is left out, for it has a face " + in_quotes(face) +
                          "; expected S1 to S6");
  body_->surfaces.pop_back();
  data_ = Data::other;
}

void AbaqusParser::read_instance_line() {
  AbaqusInstance& instance = deck_.instances.back();
  Fields fields(lines_.line());
  const bool first = instance_line_++ == 0;
  if (instance_line_ > 2) return bad_line(lines_.line().data(), "instances", "at most a shift and a turn");
  const std::size_t n = first ? instance.shift.size() : instance.turn.size();
  double* values = first ? instance.shift.data() : instance.turn.data();
  for (std::size_t i = 0; i < n; ++i) {
    const char* at = fields.at();
    if (!fields.real(values[i]) || (!first && i < 6 && fields.at_end()))
      return bad_line(at, "instances", first ? "x, y, z of the shift" : "two points of an axis and an angle");
  }
  instance.is_turned = !first;
}

/// Ends the data of a keyword: puts what it has read into the set that it names.
void AbaqusParser::close_data() {
  if (data_ == Data::solids && !record_.empty()) {
    errors_.at(record_place_, "too few nodes",
               "the last element of *ELEMENT has " + std::to_string(record_.size() - 1) + " nodes; expected " +
                   std::to_string(solid_.n_nodes));
    record_.clear();
  }
  const bool of_cells = data_ == Data::solids || data_ == Data::left_out;
  if (set_name_.empty() || (data_ != Data::nodes && !of_cells)) return set_name_.clear();
  AbaqusSet set;
  set.name = set_name_;
  set.of_cells = of_cells;
  set.has_left_out = data_ == Data::left_out;
  set.place = keyword_place_;
  const std::size_t n = of_cells ? body_->cells.size() : body_->points.size();
  if (n > first_) {
    AbaqusItem item;
    item.kind = AbaqusItem::Kind::order;
    item.first = static_cast<std::int64_t>(first_);
    item.last = static_cast<std::int64_t>(n) - 1;
    set.items.push_back(item);
  }
  body_->sets.push_back(std::move(set));
  set_name_.clear();
}

}  // namespace kerf::abaqus
