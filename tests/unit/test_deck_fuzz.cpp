// Thousands of damaged decks, always the same ones: none may crash or hang the reader, and every error has a place.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <regex>
#include <string>
#include <vector>

#include "decks/deck_mesh.hpp"

namespace {

using namespace kerf;
using namespace kerf::decks;
namespace fs = std::filesystem;

const fs::path folder = fs::path(KERF_SOURCE_DIR) / "tests/data/decks";

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// One way to damage a deck, chosen by the generator. Numbers of std::mt19937 are the same everywhere, those of the
/// distributions of the standard library are not: hence the remainders.
class Damage {
 public:
  explicit Damage(unsigned seed) : random_(seed) {}

  std::string operator()(std::string text) {
    for (std::size_t n = 1 + below(3); n > 0 && !text.empty(); --n) damage(text);
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

  /// Where a line begins, and how long it is with its end.
  std::pair<std::size_t, std::size_t> line(const std::string& text) {
    const std::size_t at = below(text.size());
    const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
    const std::size_t start = before == std::string::npos ? 0 : before + 1;
    const std::size_t end = std::min(text.find('\n', start), text.size() - 1) + 1;
    return {start, end - start};
  }

  void damage(std::string& text) {
    static const std::vector<std::string> pieces = {"99999999999999999999",
                                                    "-1",
                                                    "1e308",
                                                    "1e-400",
                                                    "nan",
                                                    "&x",
                                                    "<1/0>",
                                                    "<((((((",
                                                    "\t",
                                                    ",,,,,,,,,",
                                                    "*END\n",
                                                    "*NODE %\n",
                                                    "*",
                                                    "$",
                                                    "\r",
                                                    "*KEYWORD LONG=Y\n",
                                                    "*INCLUDE\nbrick.k\n",
                                                    "0",
                                                    "*PARAMETER\nR x 1\n",
                                                    std::string(3, '\0'),
                                                    "*SET_NODE_LIST_GENERATE\n         9\n         1999999999\n",
                                                    "*CASE_BEGIN_3\n",
                                                    " +\n",
                                                    "*ELEMENT_SOLID\n",
                                                    "*DEFINE_TRANSFORMATION\n         1\nSCALE     1e300\n",
                                                    "I10=Y",
                                                    "_TITLE",
                                                    "_ID"};
    const auto [start, length] = line(text);
    switch (below(8)) {
      case 0:
        text.resize(below(text.size()));
        break;
      case 1:
        for (std::size_t k = 0; k < 1 + below(20); ++k) text[below(text.size())] ^= static_cast<char>(1 << below(8));
        break;
      case 2: {  // swaps two lines
        const std::string first = text.substr(start, length);
        text.erase(start, length);
        text.insert(text.empty() ? 0 : line(text).first, first);
        break;
      }
      case 3:
        text.insert(start, text.substr(start, std::min<std::size_t>(text.size() - start, 1 + below(2000))));
        break;
      case 4:
        text.erase(start, length);
        break;
      case 5:
        text.insert(below(text.size()), pieces[below(pieces.size())]);
        break;
      case 6:
        text.replace(start + below(length), std::min<std::size_t>(1 + below(12), text.size() - start - length + 1),
                     pieces[below(pieces.size())]);
        break;
      default:
        text[below(text.size())] = static_cast<char>(below(256));
    }
  }

  std::mt19937 random_;
};

// KERF_FUZZ_DECKS asks for another number of decks, for campaigns by hand.
TEST(DamagedDecks, neither_crash_nor_hang_and_every_error_has_a_place) {
  const fs::path place = fs::path(testing::TempDir()) / "kerf_damaged_decks";
  fs::create_directories(place / "parts");
  fs::copy_file(folder / "09_include_transform/parts/brick.k", place / "parts/brick.k",
                fs::copy_options::overwrite_existing);
  fs::copy_file(folder / "09_include_transform/parts/brick_si.k", place / "parts/brick_si.k",
                fs::copy_options::overwrite_existing);
  std::vector<std::string> decks;
  for (const char* name :
       {"01_one_element/one_element.k", "08_tension_table/tension.k", "09_include_transform/assembly.k",
        "10_topologies/topologies.k", "11_long_format/long.k", "11_long_format/i10.k", "14_unsupported/unsupported.k",
        "16_public/thermal_stress.k", "15_bad/binary.k", "16_public/encoding_sample.k"})
    decks.push_back(bytes_of(folder / name));
  std::string start_of_plate = bytes_of(folder / "05_plate_impact/plate_impact.k");
  start_of_plate.resize(6000);
  decks.push_back(start_of_plate);
  const std::string path = (place / "damaged.k").string();
  const std::regex has_place("^[^:]+:[1-9][0-9]*:[1-9][0-9]*: error: .+");
  const char* wanted = std::getenv("KERF_FUZZ_DECKS");
  const unsigned n = wanted ? static_cast<unsigned>(std::atoi(wanted)) : 5000u;
  std::size_t n_with_errors = 0;
  for (unsigned seed = 1; seed <= n; ++seed) {
    const std::string damaged = Damage(seed)(decks[seed % decks.size()]);
    std::ofstream(path, std::ios::binary) << damaged;
    const auto begin = std::chrono::steady_clock::now();
    Diagnostics diagnostics;
    const Deck deck = read_deck(path, {static_cast<int>(seed % 4)}, diagnostics);
    check_fields(deck, diagnostics);
    const DeckMesh mesh = read_mesh(deck, diagnostics);
    check_references(deck, mesh, diagnostics);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    EXPECT_LT(seconds, 10.0) << "seed " << seed;  // the decks have a few kilobytes
    n_with_errors += diagnostics.has_errors() ? 1 : 0;
    for (const std::string& line : diagnostics.errors())
      EXPECT_TRUE(std::regex_match(line, has_place)) << "seed " << seed << ": " << line;
    for (const auto& cell : mesh.mesh.cells)
      for (const std::int32_t node : cell) ASSERT_LT(static_cast<std::size_t>(node), mesh.mesh.points.size());
    if (HasFailure()) break;
  }
  EXPECT_GT(n_with_errors, n / 3);  // damage that nobody sees would be no test
  fs::remove_all(place);
}

}  // namespace
