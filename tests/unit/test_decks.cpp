// The reader of keyword decks: figures of an independent reader for all sample decks, and messages for broken ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "decks/deck_mesh.hpp"
#include "kerf/shape.hpp"
#include "nlohmann/json.hpp"

namespace {

using namespace kerf;
using namespace kerf::decks;
namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

const fs::path folder = fs::path(KERF_SOURCE_DIR) / "tests/data/decks";

struct ReadDeck {
  Deck deck;
  DeckMesh mesh;
  Diagnostics diagnostics;
  std::string errors() const {
    std::string all;
    for (const std::string& line : diagnostics.errors()) all += line + "\n";
    return all;
  }
};

ReadDeck read_all(const fs::path& path, int case_number = 0) {
  ReadDeck r;
  r.deck = read_deck(path.string(), {case_number}, r.diagnostics);
  check_fields(r.deck, r.diagnostics);
  r.mesh = read_mesh(r.deck, r.diagnostics);
  return r;
}

std::vector<std::vector<std::string>> rows_of(const fs::path& path, char separator) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> row(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"' && separator == ',')
        quoted = !quoted;
      else if (c == separator && !quoted)
        row.emplace_back();
      else
        row.back() += c;
    }
    rows.push_back(row);
  }
  return rows;
}

double volume_of(const DeckMesh& mesh, std::size_t cell) {
  CellCorners x;
  for (std::size_t k = 0; k < 8; ++k) {
    const auto& p = mesh.mesh.points[static_cast<std::size_t>(mesh.mesh.cells[cell][k])];
    x[k] = {p[0], p[1], p[2]};
  }
  return volume_by_faces(hexahedron, x);
}

const char* name_of(SolidShape shape) {
  constexpr const char* names[] = {"hex8", "wedge6", "pyramid5", "tet4", "tet10"};
  return names[static_cast<int>(shape)];
}

/// Figures have ten digits, and a volume is the difference of large terms where a cell lies far from the origin.
void expect_near(double found, double expected, double scale, const std::string& what) {
  EXPECT_NEAR(found, expected, 1e-9 * std::max(std::abs(expected), scale)) << what;
}

class SampleDeck : public testing::TestWithParam<std::string> {};

TEST_P(SampleDeck, has_the_figures_of_the_independent_reader) {
  const fs::path path = folder / GetParam();
  const ReadDeck r = read_all(path);
  if (GetParam().rfind("14", 0) == 0)
    EXPECT_THAT(r.errors(), HasSubstr("unsupported.k:46:1: error: unknown keyword *EM_CONTROL: its group is about"));
  else
    EXPECT_EQ(r.errors(), "");
  const json expected = json::parse(std::ifstream(fs::path(path).replace_extension(".expected.json")));
  std::map<std::string, int> keywords;
  for (const auto& [name, n] : r.deck.keyword_counts())
    if (name != "END") keywords["*" + name] = n;
  std::map<std::string, int> expected_keywords = expected["keywords"];
  EXPECT_EQ(keywords, expected_keywords);
  EXPECT_EQ(r.deck.title(), expected.value("title", ""));
  EXPECT_EQ(r.mesh.mesh.points.size(), expected["nodes"].get<std::size_t>());
  EXPECT_EQ(r.mesh.mesh.cells.size(), expected["solids"].get<std::size_t>());
  std::map<std::string, int> shapes, expected_shapes = expected["solid_kinds"];
  for (const SolidShape shape : r.mesh.shapes) ++shapes[name_of(shape)];
  EXPECT_EQ(shapes, expected_shapes);
  std::map<std::string, std::size_t> sets, expected_sets = expected["node_sets"];
  for (const MeshNodeSet& set : r.mesh.mesh.node_sets) sets[std::to_string(set.label)] = set.nodes.size();
  EXPECT_EQ(sets, expected_sets);
  EXPECT_EQ(r.mesh.codes.size(), expected["tc_rc_nodes"].get<std::size_t>());
  const auto shells = r.mesh.mesh.left_out.find("shell"), beams = r.mesh.mesh.left_out.find("beam");
  EXPECT_EQ(shells == r.mesh.mesh.left_out.end() ? 0 : shells->second, expected["shells"].get<int>());
  EXPECT_EQ(beams == r.mesh.mesh.left_out.end() ? 0 : beams->second, expected["beams"].get<int>());
  std::array<double, 6> box = {1e300, 1e300, 1e300, -1e300, -1e300, -1e300};
  for (const auto& x : r.mesh.mesh.points)
    for (std::size_t d = 0; d < 3; ++d) {
      box[d] = std::min(box[d], x[d]);
      box[3 + d] = std::max(box[3 + d], x[d]);
    }
  for (std::size_t k = 0; k < 6; ++k)
    expect_near(box[k], expected["box_of_all_nodes"][k].get<double>(), 1.0, "box of all nodes");
  for (const Block& block : r.deck.blocks()) {
    if (block.base() == "CONTROL_TERMINATION") {
      EXPECT_DOUBLE_EQ(r.deck.real(block, 1, "endtim").value, expected["end_time"].get<double>());
    }
    if (block.base() == "CONTROL_TIMESTEP") {
      EXPECT_DOUBLE_EQ(r.deck.real(block, 1, "tssfac").value, expected["tssfac"].get<double>());
    }
  }
}

TEST_P(SampleDeck, has_the_parts_of_the_independent_reader) {
  const ReadDeck r = read_all(folder / GetParam());
  std::size_t n_parts = 0;
  for (const std::vector<std::string>& row : rows_of(folder / "oracle.csv", ',')) {
    if (row[0] != GetParam()) continue;
    ++n_parts;
    const auto& blocks = r.mesh.mesh.blocks;
    const auto block = std::find_if(blocks.begin(), blocks.end(),
                                    [&](const MeshBlock& b) { return std::to_string(b.label) == row[1]; });
    ASSERT_NE(block, blocks.end()) << row[1];
    const auto part =
        std::find_if(r.mesh.parts.begin(), r.mesh.parts.end(), [&](const DeckPart& p) { return p.id == block->label; });
    ASSERT_NE(part, r.mesh.parts.end());
    EXPECT_EQ(part->title, row[2]);
    EXPECT_EQ(block->cells.size(), std::stoul(row[6]));
    std::set<std::int32_t> nodes;
    std::array<double, 6> box = {1e300, 1e300, 1e300, -1e300, -1e300, -1e300};
    double volume = 0.0, least = 1e300;
    for (const std::int32_t c : block->cells) {
      const auto cell = static_cast<std::size_t>(c);
      volume += volume_of(r.mesh, cell);
      least = std::min(least, volume_of(r.mesh, cell));
      nodes.insert(r.mesh.mesh.cells[cell].begin(), r.mesh.mesh.cells[cell].end());
    }
    for (const TenNodes& ten : r.mesh.ten_nodes)
      if (r.mesh.parts[static_cast<std::size_t>(r.mesh.cell_part[static_cast<std::size_t>(ten.cell)])].id ==
          block->label)
        nodes.insert(ten.nodes.begin(), ten.nodes.end());
    for (const std::int32_t n : nodes)
      for (std::size_t d = 0; d < 3; ++d) {
        box[d] = std::min(box[d], r.mesh.mesh.points[static_cast<std::size_t>(n)][d]);
        box[3 + d] = std::max(box[3 + d], r.mesh.mesh.points[static_cast<std::size_t>(n)][d]);
      }
    EXPECT_EQ(nodes.size(), std::stoul(row[5]));
    expect_near(volume, std::stod(row[8]), 0.0, "volume of part " + row[1]);
    expect_near(least, std::stod(row[17]), 0.0, "least volume of part " + row[1]);
    for (std::size_t k = 0; k < 6; ++k) expect_near(box[k], std::stod(row[11 + k]), 1.0, "box of part " + row[1]);
  }
  EXPECT_EQ(r.mesh.mesh.blocks.size(), n_parts);
}

INSTANTIATE_TEST_SUITE_P(
    All, SampleDeck,
    testing::Values("01_one_element/one_element.k", "02_taylor_bar/taylor.k", "03_oblique_rod/rod.k",
                    "04_ball_free_format/ball.k", "05_plate_impact/plate_impact.k", "06_explosive_tube/tube.k",
                    "07_ceramic_tile/tile.k", "08_tension_table/tension.k", "09_include_transform/assembly.k",
                    "10_topologies/topologies.k", "11_long_format/long.k", "11_long_format/i10.k",
                    "11_long_format/i10_whole_deck.k", "11_long_format/plus.k", "11_long_format/abutting.k",
                    "12_rubber_ball/rubber_ball.k", "13_rigid_ball/rigid_ball.k", "14_unsupported/unsupported.k",
                    "16_public/bar_impact_mesh.k", "16_public/transform/elementary_main.k",
                    "16_public/thermal_stress.k"),
    [](const auto& info) {
      std::string name = info.param;
      for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
      return name;
    });

TEST(BrokenDecks, are_told_where_they_are_broken) {
  for (const std::vector<std::string>& row : rows_of(folder / "15_bad/expected.tsv", '\t')) {
    if (row[0] == "file") continue;
    ReadDeck r = read_all(folder / "15_bad" / row[0]);
    if (row[0] != "empty.k" && row[0] != "not_a_deck.k") check_references(r.deck, r.mesh, r.diagnostics);
    if (row[1] == "-") {
      EXPECT_EQ(r.errors(), "") << row[0];
      continue;
    }
    ASSERT_EQ(r.diagnostics.errors().size(), 1u) << row[0] << "\n" << r.errors();
    const std::string& line = r.diagnostics.errors().front();
    const std::string place = (folder / "15_bad" / row[0]).string() + ":" + row[1] + ":" + row[2] + ": error: ";
    EXPECT_EQ(line.substr(0, place.size()), place) << line;
    std::string message = row[3];
    if (const std::size_t dots = message.find("..."); dots != std::string::npos) message.resize(dots);
    if (const std::size_t n = message.find("line N"); n != std::string::npos) message.resize(n);
    if (row[0] == "element_twice.k") message = "element 2 is defined twice";
    if (row[0] == "flat_tetrahedron.k") message = "a tetrahedron needs four nodes";
    if (row[0] == "curve_not_increasing.k") message = "abscissae of curve 4 must increase: 0.5 follows 1";
    EXPECT_THAT(line, HasSubstr(message)) << row[0];
  }
}

}  // namespace
