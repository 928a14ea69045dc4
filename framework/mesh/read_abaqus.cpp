// Reads the keywords of an Abaqus deck that tell its mesh, with their parameters.
#include <algorithm>
#include <cctype>
#include <optional>

#include "mesh/abaqus_parser.hpp"

namespace kerf {

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

namespace abaqus {
namespace {

std::string without_blanks(std::string_view text) {
  std::string out = upper(text);
  std::erase_if(out, [](char c) { return std::isspace(static_cast<unsigned char>(c)); });
  return out;
}

std::optional<SolidType> solid_of(const std::string& type) {
  if (!type.starts_with("C3D")) return {};
  SolidType solid{type, 0};
  for (std::size_t i = 3; i < type.size() && i < 5 && std::isdigit(static_cast<unsigned char>(type[i])); ++i)
    solid.n_nodes = 10 * solid.n_nodes + (type[i] - '0');
  return solid;
}

}  // namespace

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

}  // namespace abaqus

AbaqusDeck parse_abaqus(std::string_view bytes, MeshErrors& errors) {
  return abaqus::AbaqusParser(bytes, errors).parse();
}

FileMesh read_abaqus(const MeshFileText& file, Diagnostics& diagnostics) {
  MeshErrors errors(file.name, diagnostics);
  AbaqusDeck deck = parse_abaqus(file.bytes, errors);
  return assemble_abaqus(deck, errors);
}

}  // namespace kerf
