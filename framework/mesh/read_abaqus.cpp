// Reads the lines of an Abaqus deck that tell its mesh: keywords, their parameters, and the data below them.
#include <algorithm>
#include <cctype>
#include <cstring>
#include <limits>
#include <optional>
#include <set>
#include <string_view>

#include "mesh/abaqus_deck.hpp"
#include "mesh/numbers.hpp"

namespace kerf {

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
  return text;
}

std::string without_blanks(std::string_view text) {
  std::string out = upper(text);
  std::erase_if(out, [](char c) { return std::isspace(static_cast<unsigned char>(c)); });
  return out;
}

/// Lines that are neither comments nor empty.
class DeckLines {
 public:
  explicit DeckLines(std::string_view bytes) : p_(bytes.data()), end_(p_ + bytes.size()) {}
  /// Goes to the next line; false at the end of the file.
  bool next();
  std::string_view line() const { return line_; }
  std::int32_t number() const { return number_; }
  bool is_keyword() const { return line_.starts_with('*'); }
  bool goes_on() const { return line_.ends_with(','); }
  FilePlace place_of(const char* p) const { return {number_, static_cast<std::int32_t>(p - begin_) + 1}; }

 private:
  const char *p_, *end_, *begin_ = nullptr;
  std::string_view line_;
  std::int32_t number_ = 0;
};

bool DeckLines::next() {
  while (p_ != end_) {
    begin_ = p_;
    const void* newline = std::memchr(p_, '\n', static_cast<std::size_t>(end_ - p_));
    const char* stop = newline ? static_cast<const char*>(newline) : end_;
    p_ = newline ? stop + 1 : end_;
    ++number_;
    line_ = trimmed({begin_, static_cast<std::size_t>(stop - begin_)});
    if (!line_.empty() && !line_.starts_with("**")) return true;
  }
  return false;
}

/// Fields of a line between commas.
class Fields {
 public:
  explicit Fields(std::string_view line) : p_(line.data()), end_(p_ + line.size()) {}
  bool at_end() const { return p_ == end_; }
  const char* at() const { return p_; }
  std::string_view text() {
    const void* comma = std::memchr(p_, ',', static_cast<std::size_t>(end_ - p_));
    const char* stop = comma ? static_cast<const char*>(comma) : end_;
    const std::string_view field(p_, static_cast<std::size_t>(stop - p_));
    p_ = comma ? stop + 1 : end_;
    return trimmed(field);
  }
  bool integer(std::int64_t& value) { return number(&read_integer, value); }
  /// A field that is blank is zero.
  bool real(double& value) {
    value = 0.0;
    skip_blanks();
    if (p_ != end_ && *p_ == ',') return ++p_, true;
    return p_ == end_ || number(&read_real, value);
  }

 private:
  void skip_blanks() {
    while (p_ != end_ && (*p_ == ' ' || *p_ == '\t')) ++p_;
  }
  template <class Value>
  bool number(const char* (*read)(const char*, const char*, Value&), Value& value) {
    skip_blanks();
    const char* stop = read(p_, end_, value);
    if (!stop) return false;
    const char* before = p_;
    p_ = stop;
    skip_blanks();
    if (p_ == end_) return true;
    if (*p_ == ',') return ++p_, true;
    p_ = before;
    return false;
  }
  const char *p_, *end_;
};

struct Keyword {
  std::string name;  // in capitals, without blanks
  std::vector<std::pair<std::string, std::string>> parameters;
  FilePlace place;

  const std::string* find(std::string_view parameter) const {
    for (const auto& [key, value] : parameters)
      if (key == parameter) return &value;
    return nullptr;
  }
  std::string value(std::string_view parameter) const {
    const std::string* found = find(parameter);
    return found ? *found : std::string{};
  }
};

/// Kinds of solids: the letters of C3D8 and its kin, which have their corners first and nothing else.
struct SolidType {
  std::string name;
  int n_nodes = 0;
};

std::optional<SolidType> solid_of(const std::string& type) {
  if (!type.starts_with("C3D")) return {};
  SolidType solid{type, 0};
  for (std::size_t i = 3; i < type.size() && i < 5 && std::isdigit(static_cast<unsigned char>(type[i])); ++i)
    solid.n_nodes = 10 * solid.n_nodes + (type[i] - '0');
  return solid;
}

class AbaqusParser {
 public:
  AbaqusParser(std::string_view bytes, MeshErrors& errors) : lines_(bytes), errors_(errors) {}
  AbaqusDeck parse();

 private:
  enum class Data { other, nodes, solids, left_out, set, surface, instance };
  Keyword read_keyword();
  void start(const Keyword& keyword);
  bool refuses(const Keyword& keyword);
  void start_part(const Keyword& keyword);
  void start_instance(const Keyword& keyword);
  void start_nodes(const Keyword& keyword);
  void start_elements(const Keyword& keyword);
  void start_set(const Keyword& keyword);
  void start_surface(const Keyword& keyword);
  std::string required(const Keyword& keyword, const char* parameter);
  void read_line();
  void read_node();
  void read_solid();
  void read_left_out();
  void read_set_line();
  void read_generated();
  void read_surface_line();
  void read_instance_line();
  void add_solid();
  void close_data();
  bool label(Fields& fields, std::int64_t& value, const char* expected);
  void bad_line(const char* at, const char* kind, const char* expected) {
    errors_.at(lines_.place_of(at), kind,
               std::string("this line of ") + kind + " cannot be read from here on; expected " + expected);
  }

  DeckLines lines_;
  MeshErrors& errors_;
  AbaqusDeck deck_;
  AbaqusBody* body_ = nullptr;
  Data data_ = Data::other;
  SolidType solid_;
  std::string left_type_, set_name_;
  std::size_t first_ = 0;  // node or cell of this keyword
  FilePlace keyword_place_;
  bool generate_ = false, goes_on_ = false;
  std::vector<std::int64_t> record_;  // label and nodes of an element so far
  FilePlace record_place_;
  int instance_line_ = 0;
  std::set<std::string> part_names_, instance_names_;
};

// ---- keywords --------------------------------------------------------------------------------------------------

AbaqusDeck AbaqusParser::parse() {
  body_ = &deck_.model;
  bool more = lines_.next();
  while (more) {
    if (lines_.is_keyword()) {
      close_data();
      start(read_keyword());
    } else {
      read_line();
    }
    more = lines_.next();
  }
  close_data();
  return std::move(deck_);
}

/// A line that ends in a comma goes on in the next one.
Keyword AbaqusParser::read_keyword() {
  Keyword keyword;
  keyword.place = lines_.place_of(lines_.line().data());
  std::string text(lines_.line().substr(1));
  while (text.ends_with(',') && lines_.next()) text += lines_.line();
  Fields fields(text);
  keyword.name = without_blanks(fields.text());
  while (!fields.at_end()) {
    const std::string_view field = fields.text();
    const std::size_t equals = field.find('=');
    std::string_view value = equals == std::string_view::npos ? "" : trimmed(field.substr(equals + 1));
    if (value.size() > 1 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
    keyword.parameters.emplace_back(without_blanks(field.substr(0, equals)), value);
  }
  return keyword;
}

std::string AbaqusParser::required(const Keyword& keyword, const char* parameter) {
  std::string value = keyword.value(parameter);
  if (value.empty())
    errors_.at(keyword.place, "parameter",
               "*" + keyword.name + " has no " + parameter + "; expected " + parameter + "=name");
  return value;
}

/// Keywords that make or move nodes and elements, which would be missing or elsewhere.
bool AbaqusParser::refuses(const Keyword& keyword) {
  static const std::map<std::string, const char*> refused = {{"INCLUDE", "the text of the other file in its place"},
                                                             {"SYSTEM", "nodes in the global frame"},
                                                             {"NGEN", "*NODE for all nodes"},
                                                             {"NFILL", "*NODE for all nodes"},
                                                             {"NCOPY", "*NODE for all nodes"},
                                                             {"NMAP", "*NODE for all nodes"},
                                                             {"ELGEN", "*ELEMENT for all elements"},
                                                             {"ELCOPY", "*ELEMENT for all elements"},
                                                             {"IMPORT", "the mesh itself"},
                                                             {"PARAMETER", "numbers"}};
  const auto found = refused.find(keyword.name);
  if (found == refused.end()) return false;
  errors_.at(keyword.place, "keyword", "*" + keyword.name + " is not taken; expected " + found->second);
  return true;
}

void AbaqusParser::start(const Keyword& keyword) {
  data_ = Data::other;
  keyword_place_ = keyword.place;
  const std::string& name = keyword.name;
  if (refuses(keyword)) return;
  if (name == "PART") start_part(keyword);
  if (name == "INSTANCE") start_instance(keyword);
  if (name == "ENDPART" || name == "ENDINSTANCE") body_ = &deck_.model;
  if (name == "NODE") start_nodes(keyword);
  if (name == "ELEMENT") start_elements(keyword);
  if (name == "NSET" || name == "ELSET") start_set(keyword);
  if (name == "SURFACE") start_surface(keyword);
  if (name == "SOLIDSECTION") body_->sections.push_back({required(keyword, "ELSET"), keyword.place});
  if (keyword.find("INPUT") && (name == "NODE" || name == "ELEMENT"))
    errors_.at(keyword.place, "keyword", "*" + name + " reads another file; expected the lines in this one");
}

void AbaqusParser::start_part(const Keyword& keyword) {
  const std::string name = required(keyword, "NAME");
  if (!part_names_.insert(upper(name)).second)
    errors_.at(keyword.place, "part", "part " + in_quotes(name) + " is there twice; expected different names");
  body_ = &deck_.parts.emplace_back();
  body_->name = name;
  body_->place = keyword.place;
}

void AbaqusParser::start_instance(const Keyword& keyword) {
  const std::string name = required(keyword, "NAME");
  if (!instance_names_.insert(upper(name)).second)
    errors_.at(keyword.place, "instance", "instance " + in_quotes(name) + " is there twice; expected different names");
  AbaqusInstance& instance = deck_.instances.emplace_back();
  instance.part = required(keyword, "PART");
  body_ = &instance.own;
  body_->name = name;
  body_->place = keyword.place;
  data_ = Data::instance;
  instance_line_ = 0;
}

void AbaqusParser::start_nodes(const Keyword& keyword) {
  const std::string system = upper(keyword.value("SYSTEM"));
  if (!system.empty() && system != "R")
    errors_.at(keyword.place, "keyword", "*NODE has coordinates of SYSTEM=" + system + "; expected SYSTEM=R");
  data_ = Data::nodes;
  set_name_ = keyword.value("NSET");
  first_ = body_->points.size();
}

void AbaqusParser::start_elements(const Keyword& keyword) {
  const std::string type = upper(required(keyword, "TYPE"));
  set_name_ = keyword.value("ELSET");
  first_ = body_->cells.size();
  goes_on_ = false;
  const std::optional<SolidType> solid = solid_of(type);
  const int n = solid ? solid->n_nodes : 0;
  const bool taken = n == 4 || n == 5 || n == 6 || n == 8;
  data_ = taken ? Data::solids : Data::left_out;
  if (taken) solid_ = *solid;
  left_type_ = type;
  if (solid && !taken)
    errors_.at(keyword.place, "type",
               "elements of type " + type +
                   " are not of first order; expected C3D8, C3D6, C3D5, "
                   "C3D4 and their kin");
  if (!set_name_.empty() && taken) body_->element_sets.push_back({set_name_, keyword.place});
}

void AbaqusParser::start_set(const Keyword& keyword) {
  const bool of_cells = keyword.name == "ELSET";
  AbaqusSet set;
  set.name = required(keyword, of_cells ? "ELSET" : "NSET");
  set.of_cells = of_cells;
  set.instance = keyword.value("INSTANCE");
  if (!of_cells) set.nodes_of = keyword.value("ELSET");
  set.place = keyword.place;
  generate_ = keyword.find("GENERATE") != nullptr;
  body_->sets.push_back(std::move(set));
  data_ = Data::set;
}

void AbaqusParser::start_surface(const Keyword& keyword) {
  const std::string type = upper(keyword.value("TYPE"));
  const std::string name = required(keyword, "NAME");
  if (!type.empty() && type != "ELEMENT") {
    errors_.warn(keyword.place,
                 "surface " + in_quotes(name) + " of TYPE=" + type + " is left out; expected TYPE=ELEMENT");
    return;
  }
  body_->surfaces.push_back({name, keyword.place, {}});
  data_ = Data::surface;
}

// ---- data ------------------------------------------------------------------------------------------------------

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

}  // namespace

AbaqusDeck parse_abaqus(std::string_view bytes, MeshErrors& errors) { return AbaqusParser(bytes, errors).parse(); }

FileMesh read_abaqus(const MeshFileText& file, Diagnostics& diagnostics) {
  MeshErrors errors(file.name, diagnostics);
  AbaqusDeck deck = parse_abaqus(file.bytes, errors);
  return assemble_abaqus(deck, errors);
}

}  // namespace kerf
