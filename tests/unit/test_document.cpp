// Requirement: the input becomes a tree that knows where each value stands, and overrides change it like an editor.
#include "input/document.hpp"

#include <gtest/gtest.h>

#include "input/yaml_reader.hpp"

namespace {

using kerf::Diagnostics;
using kerf::Node;
using Lines = std::vector<std::string>;

Node read(const std::string& text, Diagnostics& diagnostics) {
  return kerf::read_yaml("a.yaml", text, diagnostics).value_or(Node{});
}
Lines errors_of(const std::string& text) {
  Diagnostics diagnostics;
  read(text, diagnostics);
  return diagnostics.errors();
}

TEST(Yaml, keeps_the_place_of_keys_and_values) {
  Diagnostics diagnostics;
  const Node root = read("# rod\ntime:\n  end: 50 us\nparts: [a, b]\n", diagnostics);
  ASSERT_TRUE(root.find("time"));
  const kerf::Entry* end = root.find("time")->value.find("end");
  ASSERT_TRUE(end);
  EXPECT_EQ(end->key_origin.text(), "a.yaml:3:3");
  EXPECT_EQ(end->value.origin.text(), "a.yaml:3:8");
  EXPECT_EQ(end->value.text, "50 us");
  EXPECT_EQ(root.find("parts")->value.items.at(1).origin.text(), "a.yaml:4:12");
  EXPECT_FALSE(diagnostics.has_errors());
}

TEST(Yaml, keeps_the_order_of_keys) {
  Diagnostics diagnostics;
  const Node root = read("z: 1\na: 2\nm: 3\n", diagnostics);
  EXPECT_EQ(root.entries[0].key + root.entries[1].key + root.entries[2].key, "zam");
}

TEST(Yaml, refuses_a_key_that_is_given_twice) {
  EXPECT_EQ(errors_of("end: 1\ngrowth: 2\nend: 3\n"),
            Lines{"a.yaml:3:1: error: `end` is given twice; it stands in line 1 already"});
}

TEST(Yaml, names_the_place_of_a_syntax_error) {
  EXPECT_EQ(
      errors_of("a: b: c\n"),
      Lines{"a.yaml:1:5: error: not valid YAML: illegal map value; the keys of a block begin in one column, and a "
            "text that holds a colon and a space must be quoted"});
}

TEST(Yaml, says_how_to_write_a_list_with_a_unit) {
  EXPECT_EQ(errors_of("a:\n  v: [0, 0, -1] m/s\n"),
            Lines{"a.yaml:2:17: error: not valid YAML: end of map not found; a list followed by a unit must be quoted, "
                  "for example \"[0, 0, -1] m/s\""});
}

TEST(Yaml, resolves_aliases) {
  Diagnostics diagnostics;
  const Node root = read("a: &x {b: 1}\nc: *x\n", diagnostics);
  ASSERT_TRUE(root.find("c")->value.find("b"));
  EXPECT_EQ(root.find("c")->value.find("b")->value.text, "1");
}

TEST(Yaml, bounds_the_expansion_of_aliases) {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string n = std::to_string(i), m = "*a" + std::to_string(i - 1);
    text += "a" + n + ": &a" + n + " [" + m;
    for (int k = 0; k < 9; ++k) text += ", " + m;
    text += "]\n";
  }
  const Lines errors = errors_of(text);
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_NE(errors[0].find("the aliases expand to too many values"), std::string::npos);
}

TEST(Yaml, refuses_a_second_document) {
  EXPECT_EQ(errors_of("a: 1\n---\nb: 2\n"),
            Lines{"a.yaml:2:1: error: a second YAML document begins; expected one only, without `---` in between"});
}

TEST(Yaml, refuses_tags) {
  EXPECT_EQ(errors_of("a: !!int 3\n"),
            Lines{"a.yaml:1:4: error: the tag \"tag:yaml.org,2002:int\" has no meaning here; leave it out"});
}

class Override : public testing::Test {
 protected:
  Node root;
  Diagnostics diagnostics;
  Override() { root = read("time: {end: 1}\ncontacts:\n  - {type: penalty, friction: 0}\n", diagnostics); }
};

TEST_F(Override, replaces_a_value) {
  kerf::apply_override(root, "time.end=50 us", diagnostics);
  const kerf::Entry* end = root.find("time")->value.find("end");
  EXPECT_EQ(end->value.text, "50 us");
  EXPECT_EQ(end->value.origin.text(), "--set time.end=50 us");
  EXPECT_EQ(end->key_origin.text(), "--set time.end=50 us");
}

TEST_F(Override, creates_missing_keys) {
  kerf::apply_override(root, "output.node_fields=[velocity, mass]", diagnostics);
  ASSERT_TRUE(root.find("output"));
  EXPECT_EQ(root.find("output")->value.find("node_fields")->value.items.at(1).text, "mass");
}

TEST_F(Override, reaches_into_lists_by_either_spelling) {
  kerf::apply_override(root, "contacts.0.friction=0.1", diagnostics);
  EXPECT_EQ(root.find("contacts")->value.items[0].find("friction")->value.text, "0.1");
  kerf::apply_override(root, "contacts[0].friction=0.2", diagnostics);
  EXPECT_EQ(root.find("contacts")->value.items[0].find("friction")->value.text, "0.2");
}

TEST_F(Override, takes_a_list_with_a_unit) {
  kerf::apply_override(root, "v=[0, 0, -1] m/s", diagnostics);
  EXPECT_EQ(root.find("v")->value.text, "[0, 0, -1] m/s");
  EXPECT_FALSE(diagnostics.has_errors());
}

TEST_F(Override, refuses_what_it_cannot_follow) {
  kerf::apply_override(root, "contacts.3.friction=0.1", diagnostics);
  kerf::apply_override(root, "time.end.x=0.1", diagnostics);
  kerf::apply_override(root, "time.end", diagnostics);
  kerf::apply_override(root, "time..end=1", diagnostics);
  EXPECT_EQ(
      diagnostics.errors(),
      (Lines{"--set contacts.3.friction=0.1: error: \"3\" is no position in a list of 1; expected a number from 0 to 0",
             "--set time.end.x=0.1: error: \"x\" leads into the text \"1\"; expected a map or a list there",
             "--set time.end: error: there is nothing to set; expected key.path=value, for example time.end=50e-6",
             "--set time..end=1: error: \"time..end\" has an empty element; expected keys with single dots "
             "between"}));
}

TEST(OriginMap, falls_back_on_the_enclosing_block) {
  const auto file = std::make_shared<const std::string>("a.yaml");
  kerf::OriginMap map;
  map.add("parts.rod", {file, 4, 3});
  map.add("parts.rod.material", {file, 5, 15}, "steel");
  EXPECT_EQ(map.find("parts.rod.material").text(), "a.yaml:5:15");
  EXPECT_EQ(map.find("parts.rod.placement[0].angle").text(), "a.yaml:4:3");
  EXPECT_EQ(map.find("sets.x").text(), "");
  EXPECT_EQ(map.find_text("a.yaml:4:3", "steel"), "a.yaml:5:15");
  EXPECT_EQ(map.find_text("a.yaml:4:3", "lead"), "a.yaml:4:3");
}

TEST(NearestName, finds_slips_of_the_pen) {
  EXPECT_EQ(kerf::nearest_name("denisty", {"eos", "density", "strength"}), "density");
  EXPECT_EQ(kerf::nearest_name("Density", {"eos", "density"}), "density");
  EXPECT_EQ(kerf::nearest_name("johnson", {"elastic", "johnson_cook"}), "johnson_cook");
  EXPECT_EQ(kerf::nearest_name("xyz", {"eos", "density"}), "");
}

}  // namespace
