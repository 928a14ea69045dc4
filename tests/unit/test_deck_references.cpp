// Ids of decks: what is defined twice, what nothing defines, and what has to be there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "decks/deck_mesh.hpp"

namespace {

using namespace kerf;
using namespace kerf::decks;
namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

/// The errors of a deck, without the name of its folder.
std::vector<std::string> errors_of(const std::string& text) {
  const fs::path path = fs::path(testing::TempDir()) / "kerf_references.k";
  std::ofstream(path, std::ios::binary) << "*KEYWORD\n*CONTROL_TERMINATION\n       1.0\n" << text;
  Diagnostics d;
  const Deck deck = read_deck(path.string(), {}, d);
  check_fields(deck, d);
  const DeckMesh mesh = read_mesh(deck, d);
  check_references(deck, mesh, d);
  std::vector<std::string> errors;
  for (std::string line : d.errors()) {
    for (std::size_t at; (at = line.find(path.parent_path().string() + "/")) != std::string::npos;)
      line.erase(at, path.parent_path().string().size() + 1);
    errors.push_back(line);
  }
  return errors;
}

TEST(DeckIds, of_definitions_occur_once) {
  const std::string elastic = "*MAT_ELASTIC\n         1    7800.0    2.0E11       0.3\n";
  EXPECT_THAT(errors_of(elastic + elastic),
              ElementsAre("kerf_references.k:7:1: error: material 1 is defined twice; first at kerf_references.k:5:1"));
  EXPECT_THAT(errors_of(elastic + "*MAT_NULL_TITLE\nair\n         1       1.2\n"),
              ElementsAre("kerf_references.k:8:1: error: material 1 is defined twice; first at kerf_references.k:5:1, "
                          "with *MAT_ELASTIC"));
  const std::string curve = "*DEFINE_CURVE\n         4\n                 0.0                 1.0\n";
  EXPECT_THAT(errors_of(curve + curve), ElementsAre(HasSubstr(":8:1: error: curve 4 is defined twice; first at ")));
  EXPECT_THAT(errors_of(curve + "*DEFINE_TABLE\n         4\n                 1.0\n"),
              ElementsAre(EndsWith(":8:1: error: curve 4 is defined twice; first at kerf_references.k:5:1, with "
                                   "*DEFINE_CURVE")));
  EXPECT_THAT(errors_of("*EOS_JWL\n         2\n*EOS_GRUNEISEN\n         2\n"),
              ElementsAre(HasSubstr(":7:1: error: equation of state 2 is defined twice")));
  EXPECT_THAT(errors_of("*SECTION_SOLID\n         2         1\n         3         1\n         2         2\n"),
              ElementsAre(HasSubstr(":7:1: error: section 2 is defined twice")));
  EXPECT_THAT(errors_of("*SECTION_SOLID\n         2         1\n*SECTION_SHELL\n         2         2\n"),
              ElementsAre(HasSubstr(":7:1: error: section 2 is defined twice")));
  EXPECT_THAT(errors_of("*HOURGLASS\n         5         4\n*HOURGLASS\n         5         4\n"),
              ElementsAre(HasSubstr(":7:1: error: hourglass control 5 is defined twice")));
  EXPECT_THAT(errors_of("*DEFINE_BOX\n         1\n*DEFINE_BOX\n         1\n"),
              ElementsAre(HasSubstr(":7:1: error: box 1 is defined twice")));
  EXPECT_THAT(errors_of("*DEFINE_COORDINATE_SYSTEM\n         1\n\n*DEFINE_COORDINATE_NODES\n         1\n"),
              ElementsAre(HasSubstr(":8:1: error: coordinate system 1 is defined twice")));
  const std::string shift = "*DEFINE_TRANSFORMATION\n         6\nTRANSL           1.0\n";
  EXPECT_THAT(errors_of(shift + shift),
              ElementsAre(HasSubstr(":8:1: error: transformation 6 is defined twice; first")));
}

TEST(DeckIds, of_one_number_in_different_spaces_do_not_meet) {
  EXPECT_THAT(errors_of("*MAT_ELASTIC\n         1    7800.0    2.0E11       0.3\n"
                        "*MAT_ADD_EROSION\n         1\n       1.0\n"
                        "*MAT_THERMAL_ISOTROPIC\n         1\n"
                        "*EOS_GRUNEISEN\n         1\n"
                        "*SECTION_SOLID\n         1         1\n"
                        "*HOURGLASS\n         1         4\n"
                        "*DEFINE_CURVE\n         1\n                 0.0                 1.0\n"
                        "*DEFINE_BOX\n         1\n"
                        "*DEFINE_VECTOR\n         1\n"
                        "*DEFINE_COORDINATE_SYSTEM\n         1\n\n"
                        "*DEFINE_TRANSFORMATION\n         1\nTRANSL           1.0\n"),
              ElementsAre());
}

const std::string four_nodes =
    "*NODE\n       1             0.0\n       2             1.0\n       3             2.0\n       4             3.0\n";

TEST(DeckIds, of_sets_occur_once_in_whatever_form_they_are_written) {
  const std::string list = "*SET_NODE_LIST\n         1\n         1         2\n";
  for (const char* other :
       {"*SET_NODE_LIST_TITLE\nagain\n         1\n         3\n",
        "*SET_NODE_LIST_GENERATE\n         1\n         3         4\n", "*SET_NODE_GENERAL\n         1\nALL\n",
        "*SET_NODE_ADD\n         1\n         1\n", "*SET_NODE_COLUMN\n         1\n         3\n"})
    EXPECT_THAT(
        errors_of(four_nodes + list + other),
        ElementsAre(EndsWith("error: node set 1 is defined twice; first at kerf_references.k:9:1; only sets with "
                             "_COLLECT are put together")))
        << other;
  const std::string segments = "*SET_SEGMENT\n         1\n         1         2         3         4\n";
  EXPECT_THAT(errors_of(four_nodes + segments + segments), ElementsAre(HasSubstr(":12:1: error: segment set 1 is ")));
  EXPECT_THAT(errors_of("*SET_SOLID\n         1\n         1\n*SET_SOLID_GENERATE\n         1\n         1         1\n"),
              ElementsAre(HasSubstr(":7:1: error: solid set 1 is defined twice")));
  EXPECT_THAT(errors_of("*SET_PART_LIST\n         1\n         1\n*SET_PART_ADD\n         1\n"),
              ElementsAre(HasSubstr(":7:1: error: part set 1 is defined twice")));
  // The four kinds have ids of their own, and _COLLECT puts sets together.
  EXPECT_THAT(errors_of(four_nodes + list + segments + "*SET_PART_LIST\n         1\n         1\n" +
                        "*SET_SOLID\n         1\n         1\n" + "*SET_NODE_LIST_COLLECT\n         1\n         3\n"),
              ElementsAre());
}

TEST(DeckSets, of_segments_are_put_together_with_collect) {
  const fs::path path = fs::path(testing::TempDir()) / "kerf_collected.k";
  std::ofstream(path) << "*KEYWORD\n"
                      << four_nodes
                      << "*SET_SEGMENT_COLLECT\n         1\n         1         2         3         4\n"
                         "*SET_SEGMENT_COLLECT\n         1\n         4         3         2         1\n";
  Diagnostics d;
  const DeckMesh mesh = read_mesh(read_deck(path.string(), {}, d), d);
  EXPECT_THAT(d.errors(), ElementsAre());
  ASSERT_EQ(mesh.mesh.face_sets.size(), 1u);
  EXPECT_EQ(mesh.mesh.face_sets[0].faces, (std::vector<std::array<std::int32_t, 4>>{{0, 1, 2, 3}, {3, 2, 1, 0}}));
}

TEST(DeckSets, of_ranges_hold_what_lies_in_them) {
  const fs::path path = fs::path(testing::TempDir()) / "kerf_ranges.k";
  std::ofstream(path) << "*KEYWORD\n*NODE\n      40\n      10\n      30\n      20\n"
                         "*SET_NODE_LIST_GENERATE\n         1\n        25        99         1        10         9"
                         "        12        30        30\n"
                         "*SET_NODE_LIST_GENERATE\n         2\n        11        19\n"
                         "*SET_NODE_LIST_GENERATE\n         3\n        30        20         0         0        20\n";
  Diagnostics d;
  const DeckMesh mesh = read_mesh(read_deck(path.string(), {}, d), d);
  ASSERT_EQ(mesh.mesh.node_sets.size(), 3u);
  EXPECT_THAT(mesh.mesh.node_sets[0].nodes, ElementsAre(0, 1, 2));
  EXPECT_THAT(mesh.mesh.node_sets[1].nodes, ElementsAre());
  EXPECT_THAT(d.errors(), ElementsAre(HasSubstr(":15:11: error: *SET_NODE_LIST_GENERATE: a range goes from 30 to 20; "
                                                "expected an end that is not below the beginning"),
                                      HasSubstr(":15:51: error: *SET_NODE_LIST_GENERATE: a range goes from 20 to 0")));
}

const std::string brick =
    "*NODE\n       1             0.0             0.0             0.0\n       2             1.0             0.0         "
    "    "
    "0.0\n       3             1.0             1.0             0.0\n       4             0.0             1.0           "
    "  "
    "0.0\n       5             0.0             0.0             1.0\n       6             1.0             0.0           "
    "  "
    "1.0\n       7             1.0             1.0             1.0\n       8             0.0             1.0           "
    "  "
    "1.0\n*ELEMENT_SOLID\n       1       1       1       2       3       4       5       6       7       8\n";  // 12
                                                                                                                // lines

/// `text` stands in the lines from 15 on.
std::vector<std::string> errors_with_brick(const std::string& text) {
  std::vector<std::string> errors = errors_of(brick + text);
  for (std::string& error : errors) error.erase(0, std::string("kerf_references.k:").size());
  return errors;
}

const std::string part_and_material =
    "*PART\nbar\n         1         0         1\n*MAT_ELASTIC\n         1    7800.0    2.0E11       0.3\n"
    "*DEFINE_CURVE\n         1\n                 0.0                 1.0\n";

TEST(DeckReferences, that_must_be_there_are_told_where_they_are_blank) {
  const std::string all = part_and_material;  // 8 lines: what follows begins in line 23
  EXPECT_THAT(errors_with_brick(all + "*LOAD_NODE_POINT\n         0         1         1\n         1         1\n"),
              ElementsAre("24:1: error: *LOAD_NODE_POINT: NID is 0; expected the number of a node",
                          "25:21: error: *LOAD_NODE_POINT: LCID is blank; expected the number of a curve"));
  EXPECT_THAT(errors_with_brick(all + "*BOUNDARY_PRESCRIBED_MOTION_NODE\n                   1         2\n"),
              ElementsAre("24:1: error: *BOUNDARY_PRESCRIBED_MOTION_NODE: NID is blank; expected the number of a node",
                          "24:31: error: *BOUNDARY_PRESCRIBED_MOTION_NODE: LCID is blank; expected the number of a "
                          "curve"));
  EXPECT_THAT(errors_with_brick(all + "*INITIAL_VELOCITY_NODE\n                 1.0\n"),
              ElementsAre("24:1: error: *INITIAL_VELOCITY_NODE: NID is blank; expected the number of a node"));
  EXPECT_THAT(errors_with_brick(all + "*BOUNDARY_SPC_NODE\n        -1         0         1\n"),
              ElementsAre("24:1: error: *BOUNDARY_SPC_NODE: NID is -1; expected the number of a node"));
  for (const char* keyword : {"BOUNDARY_SPC_SET", "BOUNDARY_PRESCRIBED_MOTION_SET", "LOAD_NODE_SET"})
    EXPECT_THAT(
        errors_with_brick(all + "*" + keyword + "\n         0         1         1         1\n"),
        ElementsAre("24:1: error: *" + std::string(keyword) + ": NSID is 0; expected the number of a node set"));
  for (const char* keyword : {"LOAD_SEGMENT_SET", "BOUNDARY_NON_REFLECTING"})
    EXPECT_THAT(
        errors_with_brick(all + "*" + keyword + "\n                   1\n"),
        ElementsAre("24:1: error: *" + std::string(keyword) + ": SSID is blank; expected the number of a segment set"));
  EXPECT_THAT(errors_with_brick(all + "*LOAD_SEGMENT\n         0       1.0       0.0         1         2\n"),
              ElementsAre("24:1: error: *LOAD_SEGMENT: LCID is 0; expected the number of a curve",
                          "24:51: error: *LOAD_SEGMENT: N3 is blank; expected the number of a node"));
  EXPECT_THAT(errors_with_brick(all + "*LOAD_BODY_Z\n                 1.0\n"),
              ElementsAre("24:1: error: *LOAD_BODY_Z: LCID is blank; expected the number of a curve"));
  EXPECT_THAT(errors_with_brick(all + "*INITIAL_VELOCITY_RIGID_BODY\n                 1.0\n"),
              ElementsAre("24:1: error: *INITIAL_VELOCITY_RIGID_BODY: PID is blank; expected the number of a part"));
  EXPECT_THAT(errors_with_brick(all + "*MAT_ADD_EROSION\n\n"),
              ElementsAre("24:1: error: *MAT_ADD_EROSION: MID is blank; expected the number of a material"));
}

TEST(DeckReferences, of_parts_need_a_material_where_there_are_solids) {
  const std::string material = "*MAT_ELASTIC\n         1    7800.0    2.0E11       0.3\n";
  EXPECT_THAT(errors_with_brick(material + "*PART\nbar\n         1\n"),
              ElementsAre("19:21: error: part 1: MID is blank; expected the number of a material"));
  EXPECT_THAT(errors_with_brick(material + "*PART\nbar\n         1         0         0\n"),
              ElementsAre("19:21: error: part 1: MID is 0; expected the number of a material"));
  EXPECT_THAT(errors_with_brick(material + "*PART\nbar\n         1         0         1\nno solids\n         2\n"),
              ElementsAre());
  EXPECT_THAT(errors_with_brick(material + "*PART\nbar\n         1        -2        -1        -3        -4\n"),
              ElementsAre("19:11: error: part 1: SECID is -2; expected the number of a section, or 0",
                          "19:21: error: part 1: MID is -1; expected the number of a material",
                          "19:31: error: part 1: EOSID is -3; expected the number of an equation of state, or 0",
                          "19:41: error: part 1: HGID is -4; expected the number of an hourglass control, or 0"));
}

TEST(DeckReferences, below_zero_are_errors_unless_they_mean_something) {
  const std::string all = part_and_material;  // 8 lines
  const std::string hardening =
      "*MAT_PIECEWISE_LINEAR_PLASTICITY\n         2    7800.0    2.0E11       0.3\n       0.0"
      "       0.0";  // 3 lines; LCSS and LCSR follow
  EXPECT_THAT(errors_with_brick(all + hardening + "        -1        -1\n"), ElementsAre());
  EXPECT_THAT(errors_with_brick(all + hardening + "         1        -7\n"),
              ElementsAre("25:31: error: curve 7 is not defined"));
  EXPECT_THAT(errors_with_brick(all + "*MAT_CRUSHABLE_FOAM\n         2       1.0       1.0       0.0        -1\n"),
              ElementsAre("24:41: error: *MAT_CRUSHABLE_FOAM: LCID is -1; expected the number of a curve, or 0"));
  EXPECT_THAT(errors_with_brick(all + "*LOAD_SEGMENT_SET\n         1        -2\n*SET_SEGMENT\n         1\n         1"
                                      "         2         3         4\n"),
              ElementsAre());  // pressure of a blast: the lowering refuses it
  EXPECT_THAT(errors_with_brick(all + "*RIGIDWALL_PLANAR\n        -1\n"),
              ElementsAre("24:1: error: *RIGIDWALL_PLANAR: NSID is -1; expected the number of a node set, or 0"));
  EXPECT_THAT(
      errors_with_brick(all + "*CONTACT_AUTOMATIC_SURFACE_TO_SURFACE\n        -1         1         3         3\n"
                              "       0.0\n       0.0\n"),
      ElementsAre("24:1: error: *CONTACT_AUTOMATIC_SURFACE_TO_SURFACE: SURFA is -1; expected the number of a "
                  "part"));
}

TEST(DeckReferences, of_detonations_are_parts_sets_of_parts_or_all) {
  const std::string all = part_and_material + "*SET_PART_LIST\n         4\n         1\n";  // 11 lines
  EXPECT_THAT(errors_with_brick(all + "*INITIAL_DETONATION\n         0       1.0\n         1       1.0\n        -4\n"),
              ElementsAre());
  EXPECT_THAT(errors_with_brick(all + "*INITIAL_DETONATION\n        99       1.0\n        -9\n"),
              ElementsAre("27:1: error: part 99 is not defined", "28:1: error: part set 9 is not defined"));
}

TEST(DeckIds, of_definitions_are_above_zero) {
  EXPECT_THAT(errors_of("*MAT_ELASTIC\n              7800.0    2.0E11       0.3\n"),
              ElementsAre(EndsWith(":5:1: error: *MAT_ELASTIC: MID is blank; expected an id above zero")));
  EXPECT_THAT(errors_of("*MAT_ELASTIC\n      &mid    7800.0    2.0E11       0.3\n"),
              ElementsAre(HasSubstr(":5:7: error: parameter mid is not defined")));  // told once
  EXPECT_THAT(errors_of("*DEFINE_CURVE\n        -4\n                 0.0                 1.0\n"),
              ElementsAre(EndsWith(":5:1: error: *DEFINE_CURVE: LCID is -4; expected an id above zero")));
}

}  // namespace
