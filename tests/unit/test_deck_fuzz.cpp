// Thousands of damaged decks, always the same ones: none may crash or hang the reader, and every error has a place.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "decks/deck_mesh.hpp"
#include "input/read_model.hpp"
#include "kerf/measure.hpp"
#include "lowering/lower_deck.hpp"
#include "plugin/loader.hpp"
#include "support/damaged_deck.hpp"

namespace {

using namespace kerf;
using namespace kerf::decks;
namespace fs = std::filesystem;

const fs::path folder = fs::path(KERF_SOURCE_DIR) / "tests/data/decks";

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

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
    const std::string damaged = test::DeckDamage(seed)(decks[seed % decks.size()]);
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

/// What `kerf check` does before it makes a model: the document, its plugins, and what no single block can know.
std::vector<std::string> errors_of_model(const std::string& path, const Registry& registry, unsigned seed) {
  Diagnostics diagnostics;
  OriginMap origins;
  try {
    lowering::LoweredDeck deck =
        lowering::lower_deck(path, {"kg,mm,ms", 0, seed % 3 == 0, seed % 5 == 0, {}, false}, diagnostics);
    if (diagnostics.has_errors()) return diagnostics.errors();
    MeshCache meshes;
    meshes.add((fs::path(path).parent_path() / deck.mesh_name).lexically_normal().string(), deck.mesh);
    const auto model = read_model_document(path, std::move(deck.document), std::move(meshes), {}, registry, diagnostics,
                                           origins, read_text_file, {});
    validate(*model, origins, diagnostics);
  } catch (const InputError& e) {
    return e.lines();
  }
  return diagnostics.errors();
}

TEST(DamagedDecks, become_models_or_errors_with_places) {
  const fs::path place = fs::path(testing::TempDir()) / "kerf_damaged_models";
  fs::create_directories(place);
  std::vector<std::string> decks;
  for (const char* name : {"01_one_element/one_element.k", "08_tension_table/tension.k", "10_topologies/topologies.k",
                           "12_rubber_ball/rubber_ball.k", "14_unsupported/unsupported.k", "06_explosive_tube/tube.k",
                           "07_ceramic_tile/tile.k", "13_rigid_ball/rigid_ball.k", "05_plate_impact/plate_impact.k"})
    decks.push_back(bytes_of(folder / name));
  Registry registry;
  register_builtin_plugins(registry);
  const std::string path = (place / "damaged.k").string();
  const std::regex has_place("^[^:]+:[1-9][0-9]*:[1-9][0-9]*: error: .+");
  const char* wanted = std::getenv("KERF_FUZZ_DECKS");
  const unsigned n = wanted ? static_cast<unsigned>(std::atoi(wanted)) : 1000u;
  std::size_t n_good = 0;
  for (unsigned seed = 1; seed <= n; ++seed) {
    std::ofstream(path, std::ios::binary) << test::DeckDamage(seed + 1000000u)(decks[seed % decks.size()]);
    const auto begin = std::chrono::steady_clock::now();
    const std::vector<std::string> errors = errors_of_model(path, registry, seed);
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 5.0) << "seed " << seed;
    n_good += errors.empty() ? 1 : 0;
    for (const std::string& line : errors)
      EXPECT_TRUE(std::regex_match(line, has_place)) << "seed " << seed << ": " << line;
    if (HasFailure()) break;
  }
  EXPECT_GT(n_good, n / 20);  // else the steps beyond the reader would not be tried
  fs::remove_all(place);
}

}  // namespace
