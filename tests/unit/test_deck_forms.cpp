// Forms that decks may take: numbers, parameters and their scope, includes, cases, formats, shapes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <utility>
#include <vector>

#include "decks/deck_mesh.hpp"
#include "decks/solid_shape.hpp"

namespace {

using namespace kerf;
using namespace kerf::decks;
namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path folder = fs::path(KERF_SOURCE_DIR) / "tests/data/decks";

std::string joined(const Diagnostics& diagnostics) {
  std::string all;
  for (const std::string& line : diagnostics.errors()) all += line + "\n";
  return all;
}

fs::path written(const std::string& name, const std::string& text) {
  const fs::path path = fs::path(testing::TempDir()) / name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

/// The values of ELFORM of all sections, by SECID.
std::map<std::int64_t, std::int64_t> sections_of(const fs::path& path, Diagnostics& diagnostics) {
  const Deck deck = read_deck(path.string(), {}, diagnostics);
  check_fields(deck, diagnostics);
  std::map<std::int64_t, std::int64_t> found;
  for (const Block& block : deck.blocks())
    if (block.base() == "SECTION_SOLID")
      found[deck.integer(block, 1, "secid").value] = deck.integer(block, 1, "elform").value;
  return found;
}

TEST(DeckNumbers, are_read_as_fortran_writes_them) {
  double x = 0.0;
  const std::pair<const char*, double> good[] = {
      {"7.34-4", 7.34e-4}, {"2.07+5", 2.07e5}, {"1.d3", 1e3},       {"1.0D-03", 1e-3}, {".5", 0.5},    {"5.", 5.0},
      {"+3", 3.0},         {"-1E2", -100.0},   {"1.000000E8", 1e8}, {"0", 0.0},        {"-.5+1", -5.0}};
  for (const auto& [text, value] : good) {
    EXPECT_TRUE(read_deck_real(text, x)) << text;
    EXPECT_EQ(x, value) << text;
  }
  for (const char* bad :
       {"", ".", "-", "1e", "1e+", "nan", "inf", "1.2.3", "2.1Q11", "0x10", "1e999", "1 2", "--1", "1-"})
    EXPECT_FALSE(read_deck_real(bad, x)) << bad;
  std::int64_t n = 0;
  EXPECT_TRUE(read_deck_integer("3.0", n));
  EXPECT_EQ(n, 3);
  EXPECT_FALSE(read_deck_integer("3.5", n));
  EXPECT_FALSE(read_deck_integer("99999999999999999999", n));
}

TEST(DeckParameters, later_global_definitions_win_and_local_ones_stay_at_home) {
  const fs::path parameters = folder / "16_public/parameters";
  Diagnostics d;
  EXPECT_EQ(sections_of(parameters / "collision/main_with_consumer.k", d),
            (std::map<std::int64_t, std::int64_t>{{100, 1}, {200, 2}, {300, 2}}));
  EXPECT_EQ(sections_of(parameters / "collision_local/main.k", d),
            (std::map<std::int64_t, std::int64_t>{{100, 1}, {200, 2}}));
  EXPECT_EQ(sections_of(parameters / "nonlocal/top.k", d),
            (std::map<std::int64_t, std::int64_t>{{10, 100}, {20, 1}, {30, 100}}));
  EXPECT_EQ(sections_of(parameters / "sibling/main.k", d), (std::map<std::int64_t, std::int64_t>{{1234, 5678}}));
  EXPECT_EQ(joined(d), "");
  EXPECT_THAT(d.warnings(), testing::Contains(HasSubstr("module_b.k:4:1: warning: parameter scale is defined again")));
  Diagnostics of_top, of_sibling;
  sections_of(parameters / "local/top.k", of_top);
  EXPECT_THAT(joined(of_top), HasSubstr("top.k:15:13: error: parameter loc is not defined; the parameters are: gbl"));
  EXPECT_EQ(of_top.errors().size(), 1u);
  sections_of(parameters / "local/sibling_test_top.k", of_sibling);
  EXPECT_THAT(joined(of_sibling), HasSubstr("sibling_b.k:6:13: error: parameter aloc is not defined"));
  EXPECT_EQ(of_sibling.errors().size(), 1u);
}

TEST(DeckParameters, are_evaluated_in_expressions) {
  Diagnostics d;
  const Deck deck = read_deck((folder / "05_plate_impact/plate_impact.k").string(), {}, d);
  ASSERT_EQ(joined(d), "");
  const Asker last{1 << 20, {0}};
  EXPECT_DOUBLE_EQ(deck.parameters().find("up", last)->value.real, 0.03);
  EXPECT_DOUBLE_EQ(deck.parameters().find("us", last)->value.real, 0.566);
  EXPECT_DOUBLE_EQ(deck.parameters().find("PHUG", last)->value.real, 2.703 * 0.566 * 0.03);
  EXPECT_DOUBLE_EQ(deck.parameters().find("vneg", last)->value.real, -0.06);
  const auto value = [&](const char* text) { return evaluate(text, deck.parameters(), last); };
  EXPECT_DOUBLE_EQ(value("-2.0**2 + 3*(1+1)").value.real, 2.0);
  EXPECT_DOUBLE_EQ(value("2**3**2").value.real, 512.0);
  EXPECT_DOUBLE_EQ(value("max(&vimp, sqrt(4.0))/1.d1").value.real, 0.2);
  EXPECT_DOUBLE_EQ(value("6/3").value.real, 2.0);
  EXPECT_THAT(value("2/3").error, HasSubstr("divides two integers with a remainder"));
  EXPECT_THAT(value("1/0").error, HasSubstr("division by zero"));
  EXPECT_THAT(value("nobody+1").error, HasSubstr("parameter nobody is not defined"));
  EXPECT_THAT(value("log(-1.0)").error, HasSubstr("no finite value"));
  EXPECT_THAT(value(std::string(5000, '(').c_str()).error, HasSubstr("nested too deeply"));
}

TEST(DeckExpressions, may_stand_in_fields_and_need_their_parameters) {
  Diagnostics d;
  const Deck deck = read_deck((folder / "16_public/encoding_sample.k").string(), {}, d);
  check_fields(deck, d);
  ASSERT_EQ(d.errors().size(), 2u) << joined(d);
  EXPECT_THAT(d.errors()[0], HasSubstr("encoding_sample.k:11:44: error: parameter PAB_TTF is not defined"));
  // Its curve is written one column too far to the right: the exponent of one value stands in the field of the next.
  EXPECT_THAT(d.errors()[1], HasSubstr("encoding_sample.k:14:21: error: field O1 (columns 21-40) holds two values"));
}

TEST(DeckCases, are_left_out_unless_they_are_asked_for) {
  const std::string path = (folder / "03_oblique_rod/rod.k").string();
  const auto n_velocities = [&](int number, Diagnostics& d) {
    const Deck deck = read_deck(path, {number}, d);
    int n = 0;
    for (const Block& block : deck.blocks()) n += block.base() == "INITIAL_VELOCITY_GENERATION" ? 1 : 0;
    return std::pair(n, deck.title());
  };
  Diagnostics none, by_case, by_subcase, unknown;
  EXPECT_EQ(n_velocities(0, none), std::pair(1, std::string("Pointed rod, plate at 45 degrees, 1646 m/s")));
  EXPECT_EQ(n_velocities(201, by_case), std::pair(2, std::string("Pointed rod, slow")));
  EXPECT_EQ(n_velocities(2, by_subcase), std::pair(2, std::string("Pointed rod, slow")));
  EXPECT_EQ(joined(none) + joined(by_case) + joined(by_subcase), "");
  n_velocities(7, unknown);
  EXPECT_THAT(joined(unknown), HasSubstr("rod.k:1:1: error: there is no case 7; the cases are: 2, 201"));
}

TEST(DeckHeadings, keep_their_commas_and_become_utf8) {
  Diagnostics d;
  const Deck latin = read_deck((folder / "15_bad/latin1.k").string(), {}, d);
  EXPECT_EQ(latin.title(), "Sto\u00df auf K\u00f6rper");
  const Deck taylor = read_deck((folder / "02_taylor_bar/taylor.k").string(), {}, d);
  for (const Block& block : taylor.blocks()) {
    if (block.written == "BOUNDARY_SPC_SET_ID") {
      EXPECT_THAT(taylor.heading(block), HasSubstr("symmetry"));
    }
    if (block.written == "CONTROL_TERMINATION") {
      EXPECT_EQ(taylor.real(block, 1, "endmas").value, 1e8);
    }
  }
  EXPECT_EQ(joined(d), "");
}

TEST(DeckFields, know_their_places_and_defaults) {
  Diagnostics d;
  const Deck deck = read_deck((folder / "01_one_element/one_element.k").string(), {}, d);
  for (const Block& block : deck.blocks()) {
    if (block.base() != "DEFINE_CURVE") continue;
    EXPECT_EQ(deck.integer(block, 1, "lcid").value, 9);
    const Field<double> sfa = deck.real(block, 1, "sfa");
    EXPECT_FALSE(sfa.given);
    EXPECT_EQ(sfa.value, 1.0);
    EXPECT_EQ(deck.n_repeats(block), 3u);
    const Field<double> o1 = deck.real(block, 2, "o1", 1);
    EXPECT_EQ(o1.value, 20e6);
    EXPECT_THAT(deck.text_of(o1.place), HasSubstr("one_element.k:55:21"));
  }
}

TEST(DeckIncludes, carry_on_with_names_and_do_not_need_a_keyword) {
  const fs::path part = written("kerf_part_with_a_long_name.k", "*SECTION_SOLID\n         5         1\n");
  const fs::path main = written("kerf_main.k", "*KEYWORD\n*INCLUDE\nkerf_part_with_ +\na_long_name.k\n*END\n");
  Diagnostics d;
  EXPECT_EQ(sections_of(main, d), (std::map<std::int64_t, std::int64_t>{{5, 1}}));
  EXPECT_EQ(joined(d), "");
}

TEST(DeckContacts, have_headings_with_commas_and_optional_cards_behind_those_of_mpp) {
  const fs::path path = written("kerf_contacts.k",
                                "*KEYWORD\n*CONTACT_ERODING_SURFACE_TO_SURFACE_MPP_ID\n         7rod, \"x\"\n"
                                "         0       200\n&\n         1         2         3         3\n       0.3\n\n"
                                "         1         1         1\n         2\n"
                                "*CONTACT_AUTOMATIC_SINGLE_SURFACE_TITLE\n7,ball, to plate\n         5\n");
  Diagnostics d;
  const Deck deck = read_deck(path.string(), {}, d);
  check_fields(deck, d);
  EXPECT_EQ(joined(d), "");
  const Block &eroding = deck.blocks()[1], &single = deck.blocks()[2];
  EXPECT_EQ(deck.heading(eroding), "rod, \"x\"");
  EXPECT_EQ(deck.integer(eroding, 1, "surfb").value, 2);
  EXPECT_EQ(deck.real(eroding, 2, "fs").value, 0.3);
  EXPECT_EQ(deck.integer(eroding, 4, "erosop").value, 1);
  EXPECT_EQ(deck.integer(eroding, 8, "soft").value, 2);
  EXPECT_EQ(deck.heading(single), "ball, to plate");
  EXPECT_EQ(deck.integer(single, 1, "surfa").value, 5);
}

TEST(DeckNodes, have_codes_in_all_widths) {
  const fs::path path = written("kerf_codes.k",
                                "*NODE %\n"
                                "         1             0.0             0.0             0.0       7       3\n"
                                "         2             1.0             0.0             0.0         7         3\n"
                                "         3             1.0             1.0             0.0       7\n"
                                "         4             0.0             1.0             0.0                 5\n"
                                "*NODE\n       6             1.0             0.0             1.0       0       2\n"
                                "7,1.,1.,1.,1\n8 ,0.,1., 1.,,2\n");
  Diagnostics d;
  const DeckMesh mesh = read_mesh(read_deck(path.string(), {}, d), d);
  EXPECT_EQ(joined(d), "");
  std::vector<std::pair<int, int>> codes;
  for (const NodeCode& code : mesh.codes) codes.emplace_back(code.tc, code.rc);
  EXPECT_EQ(codes, (std::vector<std::pair<int, int>>{{7, 3}, {7, 3}, {7, 0}, {0, 5}, {0, 2}, {1, 0}, {0, 2}}));
}

TEST(DeckSets, in_forms_that_are_not_read_are_errors_where_they_are_named) {
  const fs::path path = written("kerf_sets.k",
                                "*KEYWORD\n*CONTROL_TERMINATION\n       1.0\n*SET_NODE_COLUMN_TITLE\nrow\n         4\n"
                                "*BOUNDARY_SPC_SET\n         4         0         1\n         5         0         1\n");
  Diagnostics d;
  const Deck deck = read_deck(path.string(), {}, d);
  check_fields(deck, d);
  const DeckMesh mesh = read_mesh(deck, d);
  check_references(deck, mesh, d);
  ASSERT_EQ(d.errors().size(), 2u) << joined(d);
  EXPECT_THAT(d.errors()[0], HasSubstr(":8:1: error: node set 4 is written with *SET_NODE_COLUMN_TITLE, which is not"));
  EXPECT_THAT(d.errors()[1], HasSubstr(":9:1: error: node set 5 is not defined"));
}

TEST(SolidShapes, are_found_however_the_brick_is_turned) {
  EXPECT_EQ(recognised({1, 2, 3, 4, 5, 6, 7, 8}).shape, SolidShape::hex8);
  EXPECT_EQ(recognised({1, 2, 3, 4, 5, 5, 6, 6}).shape, SolidShape::wedge6);
  EXPECT_EQ(recognised({1, 2, 3, 3, 4, 5, 6, 6}).shape, SolidShape::wedge6);
  EXPECT_EQ(recognised({1, 1, 2, 3, 4, 4, 5, 6}).shape, SolidShape::wedge6);
  EXPECT_EQ(recognised({1, 2, 3, 4, 5, 5, 5, 5}).shape, SolidShape::pyramid5);
  EXPECT_EQ(recognised({1, 1, 1, 1, 2, 3, 4, 5}).shape, SolidShape::pyramid5);
  EXPECT_EQ(recognised({1, 2, 3, 3, 4, 4, 4, 4}).shape, SolidShape::tet4);
  EXPECT_EQ(recognised({1, 2, 3, 4, 4, 4, 4, 4}).shape, SolidShape::tet4);
  EXPECT_FALSE(recognised({1, 2, 3, 4, 5, 6, 7, 7}).ok);
  EXPECT_FALSE(recognised({1, 2, 1, 3, 4, 5, 6, 7}).ok);
  EXPECT_FALSE(recognised({1, 1, 1, 1, 1, 1, 1, 1}).ok);
}

}  // namespace
