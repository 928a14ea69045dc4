// Goes through an Abaqus deck: a keyword tells what the lines below it mean.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/abaqus_deck.hpp"
#include "mesh/abaqus_lines.hpp"

namespace kerf::abaqus {

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

}  // namespace kerf::abaqus
