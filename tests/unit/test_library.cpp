// The material library: reading its files, putting its sets in the place of `library: NAME`, and its messages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "input/library.hpp"
#include "input/read_model.hpp"
#include "input/yaml_reader.hpp"
#include "support/make_law.hpp"

namespace {

using namespace kerf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string two_sets = R"(family: metals
steel_a:
  description: one steel
  citation: somebody 1999
  verified: yes
  provenance: {density: "[2] two lists", strength: "[2] two lists", strength.yield_stress: "[C] chosen", eos: "[2] x"}
  material:
    density: 7800 kg/m3
    strength: {type: elastic_plastic, shear_modulus: 80 GPa, yield_stress: 400 MPa}
    eos: {type: linear, bulk_modulus: 160 GPa}
  suggested:
    erosion: {criteria: [{type: plastic_strain, limit: 0.5}]}
steel_b:
  description: another
  citation: nobody
  verified: no
  provenance: {}
  material: {density: 7800, strength: {type: elastic, shear_modulus: -1}, eos: {type: linear, bulk_modulus: 160e9}}
)";

/// Files by path; a folder lists those below it.
struct Files {
  std::map<std::string, std::string> text = {{"lib/metals.yaml", two_sets}};
  std::string operator()(const std::string& path, std::string& failure) const {
    if (path.ends_with('/')) {
      std::string names;
      for (const auto& [file, content] : text)
        if (file.starts_with(path)) names += file.substr(path.size()) + "\n";
      return names;
    }
    if (!text.contains(path)) failure = "no such file";
    return text.contains(path) ? text.at(path) : std::string();
  }
};

struct Expanded {
  Node root;
  std::vector<LibraryUse> uses;
  Diagnostics diagnostics;
};

Expanded expand(const std::string& input, const Files& files = {}) {
  Expanded e;
  e.root = *read_yaml("case.yaml", input, e.diagnostics);
  e.uses = expand_library(e.root, "", {"lib"}, files, e.diagnostics);
  return e;
}

std::vector<std::string> refusals(const std::string& input, const Files& files = {}) {
  try {
    return expand(input, files).diagnostics.errors();
  } catch (const InputError& error) {
    return error.lines();
  }
}

const Node& at(const Node& root, const std::vector<std::string>& path) {
  const Node* node = &root;
  for (const std::string& key : path) node = &node->find(key)->value;
  return *node;
}

TEST(Library, a_set_stands_where_its_name_stood) {
  const Expanded e = expand("materials: {rod: {library: steel_a}}");
  EXPECT_THAT(e.diagnostics.errors(), IsEmpty());
  EXPECT_THAT(e.diagnostics.warnings(), IsEmpty());
  EXPECT_EQ(at(e.root, {"materials", "rod", "strength", "yield_stress"}).text, "400 MPa");
  EXPECT_EQ(at(e.root, {"materials", "rod"}).find("library"), nullptr);
  EXPECT_EQ(at(e.root, {"materials", "rod"}).find("erosion"), nullptr);  // only where it is asked for
  ASSERT_EQ(e.uses.size(), 1U);
  EXPECT_EQ(e.uses[0].material, "rod");
  EXPECT_EQ(e.uses[0].set, "steel_a");
  EXPECT_TRUE(e.uses[0].verified);
  EXPECT_THAT(e.uses[0].overridden, IsEmpty());
}

TEST(Library, values_keep_the_place_where_they_were_written) {
  const Expanded e = expand("materials:\n  rod:\n    library: steel_a\n    strength: {yield_stress: 500 MPa}\n");
  EXPECT_EQ(at(e.root, {"materials", "rod", "strength", "yield_stress"}).origin.text(), "case.yaml:4:30");
  EXPECT_EQ(at(e.root, {"materials", "rod", "strength", "shear_modulus"}).origin.text(), "lib/metals.yaml:9:54");
}

TEST(Library, what_the_input_gives_replaces_single_keys) {
  const Expanded e = expand(
      "materials: {rod: {library: steel_a, density: 1, strength: {yield_stress: 5e8, hardening_modulus: 1e8}, "
      "erosion: {criteria: []}}}");
  EXPECT_EQ(at(e.root, {"materials", "rod", "density"}).text, "1");
  EXPECT_EQ(at(e.root, {"materials", "rod", "strength", "yield_stress"}).text, "5e8");
  EXPECT_EQ(at(e.root, {"materials", "rod", "strength", "hardening_modulus"}).text, "1e8");
  EXPECT_EQ(at(e.root, {"materials", "rod", "strength", "shear_modulus"}).text, "80 GPa");
  EXPECT_THAT(e.uses[0].overridden, ElementsAre("density", "strength.yield_stress", "strength.hardening_modulus"));
}

TEST(Library, another_type_replaces_the_whole_block) {
  const Expanded e = expand("materials: {rod: {library: steel_a, strength: {type: hydrodynamic}}}");
  EXPECT_EQ(at(e.root, {"materials", "rod", "strength"}).entries.size(), 1U);
  EXPECT_THAT(e.uses[0].overridden, ElementsAre("strength"));
}

TEST(Library, suggested_takes_what_the_set_suggests) {
  const Expanded e = expand("materials: {rod: {library: steel_a, erosion: suggested}}");
  EXPECT_EQ(at(e.root, {"materials", "rod", "erosion", "criteria"}).items.at(0).find("limit")->value.text, "0.5");
  EXPECT_THAT(refusals("materials: {rod: {library: steel_b, erosion: suggested}}"),
              ElementsAre("case.yaml:1:46: error: the set `steel_b` suggests no `erosion`; expected a block of your "
                          "own"));
}

TEST(Library, an_unverified_set_is_a_warning) {
  const Expanded e = expand("materials: {rod: {library: steel_b}}");
  ASSERT_EQ(e.diagnostics.warnings().size(), 1U);
  EXPECT_THAT(e.diagnostics.warnings()[0], HasSubstr("case.yaml:1:28: warning: the set `steel_b`"));
  EXPECT_FALSE(e.uses[0].verified);
}

TEST(Library, unknown_names_are_refused_with_near_ones) {
  EXPECT_THAT(refusals("materials: {rod: {library: stel_a}}"),
              ElementsAre("case.yaml:1:28: error: there is no set \"stel_a\" in the material library; did you mean "
                          "`steel_a`? (`kerf list library` shows all)"));
  EXPECT_THAT(refusals("materials: {rod: {library: mild_steel}}"),
              ElementsAre(HasSubstr("did you mean `steel_a` or `steel_b`?")));
  EXPECT_THAT(refusals("materials: {rod: {library: }, plate: {library: [a]}}"),
              ElementsAre(HasSubstr("case.yaml:1:19: error: `library` is nothing"),
                          HasSubstr("case.yaml:1:48: error: `library` is a list")));
}

TEST(Library, files_that_are_wrong_are_named_with_the_place) {
  const auto of_file = [](const std::string& text) {
    return refusals("materials: {rod: {library: x}}", Files{{{"lib/a.yaml", text}}});
  };
  const std::string rest = " citation: c, verified: yes, provenance: {}, material: {}}";
  EXPECT_THAT(of_file("x: 3"), ElementsAre("lib/a.yaml:1:4: error: `x` is the text \"3\"; expected a map with the key "
                                           "`material`"));
  EXPECT_THAT(of_file("x: {descripton: d, description: d," + rest),
              ElementsAre("lib/a.yaml:1:5: error: unknown key `descripton`; did you mean `description`?"));
  EXPECT_THAT(of_file("x: {" + rest), ElementsAre(HasSubstr("the set `x` has no key `description`")));
  EXPECT_THAT(of_file("x: {description: d, citation: c, verified: maybe, provenance: {a: b}, material: {}}"),
              ElementsAre(HasSubstr("expected yes or no"), HasSubstr("`a` is no key of this set")));
  EXPECT_THAT(of_file("- 3"), testing::Contains(HasSubstr("expected a map of sets")));
  EXPECT_THAT(refusals("materials: {rod: {library: x}}", Files{{{"lib/a.yaml", two_sets}, {"lib/b.yaml", two_sets}}}),
              testing::Contains(HasSubstr("lib/b.yaml:2:1: error: the set `steel_a` is there already, at "
                                          "lib/a.yaml:2:1")));
}

TEST(Library, further_folders_are_named_at_the_top) {
  Files files;
  files.text["own/mine.yaml"] =
      "mine: {description: d, citation: c, verified: no, provenance: {}, material: {density: 3}}";
  EXPECT_EQ(
      at(expand("library: own\nmaterials: {rod: {library: mine}}", files).root, {"materials", "rod", "density"}).text,
      "3");
  EXPECT_EQ(refusals("materials: {rod: {library: mine}}", files).size(), 1U);
}

TEST(Library, the_hash_follows_the_numbers_and_nothing_else) {
  Diagnostics diagnostics;
  const auto hash = [&](const std::string& text) {
    return MaterialLibrary({"lib"}, Files{{{"lib/a.yaml", text}}}, diagnostics).find("steel_a")->hash();
  };
  std::string other = two_sets, prose = two_sets;
  other.replace(other.find("400 MPa"), 7, "401 MPa");
  prose.replace(prose.find("one steel"), 9, "one metal");
  EXPECT_EQ(hash(two_sets), hash(prose));
  EXPECT_NE(hash(two_sets), hash(other));
}

TEST(Library, materials_written_out_read_back_alike) {
  const Expanded e = expand("materials: {rod: {library: steel_a, erosion: suggested}}");
  Diagnostics diagnostics;
  Digest before, after;
  before.add(e.root);
  after.add(*read_yaml("out.yaml", yaml_text(e.root), diagnostics));
  EXPECT_EQ(before.value(), after.value());
}

// ---- the sets that come with Kerf ----------------------------------------------------------------------------------

const MaterialLibrary& shipped() {
  static const MaterialLibrary library = [] {
    Diagnostics diagnostics;
    MaterialLibrary read({std::string(KERF_SOURCE_DIR) + "/physics/library"}, read_text_file, diagnostics);
    diagnostics.throw_if_errors();
    return read;
  }();
  return library;
}

/// Calls `take` with the path of every value below a block.
template <class Take>
void each_value(const Node& node, const std::string& path, const Take& take) {
  for (const Entry& entry : node.entries) {
    const std::string inner = path.empty() ? entry.key : path + "." + entry.key;
    if (entry.value.is_map())
      each_value(entry.value, inner, take);
    else if (entry.key != "type")
      take(inner);
  }
}

TEST(ShippedLibrary, every_number_has_a_source_with_a_mark) {
  ASSERT_GT(shipped().sets().size(), 60U);
  const std::set<std::string> marks = {"[2]", "[1]", "[M]", "[C]"};
  for (const MaterialSet& set : shipped().sets()) {
    for (const Node* block : {&set.material, &set.suggested})
      each_value(*block, "", [&](const std::string& path) {
        EXPECT_TRUE(marks.contains(set.source_of(path).substr(0, 3))) << set.name << ": " << path;
      });
    EXPECT_FALSE(set.citation.empty());
  }
}

TEST(ShippedLibrary, a_set_is_verified_where_all_its_sources_are) {
  int n_verified = 0;
  for (const MaterialSet& set : shipped().sets()) {
    const bool all = std::all_of(set.provenance.begin(), set.provenance.end(), [](const auto& source) {
      return source.second.starts_with("[2]") || source.second.starts_with("[C]");
    });
    EXPECT_EQ(set.verified, all) << set.name;
    n_verified += set.verified ? 1 : 0;
  }
  EXPECT_GT(n_verified, 0);
}

TEST(ShippedLibrary, every_set_passes_the_checks_of_an_input) {
  for (const MaterialSet& set : shipped().sets()) {
    std::string input = "time: {end: 1e-6}\nmaterials:\n  m:\n    library: " + set.name + "\n";
    if (set.to_give.is_map()) input += yaml_text(set.to_give, 4);
    for (const Entry& block : set.suggested.entries) input += "    " + block.key + ": suggested\n";
    input += "parts: {p: {material: m, mesh: {type: block, size: [1, 1, 1] , cells: [1, 1, 1]}}}\n";
    Diagnostics diagnostics;
    OriginMap origins;
    const auto model = read_model_input("case.yaml", input, {}, test::builtin_plugins(), diagnostics, origins,
                                        read_text_file, {std::string(KERF_SOURCE_DIR) + "/physics/library"});
    validate(*model, origins, diagnostics);
    EXPECT_THAT(diagnostics.errors(), IsEmpty()) << set.name;
    // Nothing unusual about it either, but that it may not be verified.
    EXPECT_EQ(diagnostics.warnings().size(), set.verified ? 0U : 1U)
        << set.name << ": " << testing::PrintToString(diagnostics.warnings());
  }
}

}  // namespace
