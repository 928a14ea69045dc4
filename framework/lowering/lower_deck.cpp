// The steps from a deck to its document, in their order, and the report of it.
#include "lowering/lower_deck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "kerf/shape.hpp"
#include "lowering/handled_fields.hpp"
#include "lowering/lower_mesh.hpp"

namespace kerf::lowering {
namespace {

using decks::Block;
using decks::Deck;
using decks::DeckMesh;
using decks::DeckPart;
using decks::IdKind;

// ---- units -----------------------------------------------------------------------------------------------------

/// Whether a density and a modulus, in SI, are those of some material.
bool is_plausible(double density_in_si, double modulus_in_si) {
  return density_in_si > 20.0 && density_in_si < 25000.0 &&
         (modulus_in_si == 0.0 || (modulus_in_si > 1e4 && modulus_in_si < 1.5e12));
}

/// The systems in which all densities and moduli of the deck are those of materials.
std::string fitting_systems(const Deck& deck) {
  std::string names;
  for (const NamedSystem& system : usual_systems()) {
    bool fits = true, any = false;
    for (const Block& block : deck.blocks()) {
      if (block.base().rfind("MAT_", 0) != 0 || !block.name.spec || !block.name.spec->card(1)) continue;
      const auto value = [&](const char* field) {
        return block.name.spec->card(1)->field(field) ? deck.real(block, 1, field).value : 0.0;
      };
      const double modulus = value("e") > 0.0 ? value("e") : value("g");
      if (value("ro") <= 0.0) continue;
      any = true;
      fits = fits && is_plausible(value("ro") * system.units.in_si(density), modulus * system.units.in_si(pressure));
    }
    if (fits && any) names += (names.empty() ? "" : ", ") + system.alias;
  }
  return names;
}

class Units {
 public:
  Units(const Deck& deck, const LoweringOptions& options, Diagnostics& diagnostics)
      : deck_(deck), options_(options), diagnostics_(diagnostics) {}

  std::optional<UnitSystem> find(DeckReport& report) {
    std::optional<UnitSystem> given, written;
    if (!options_.units.empty()) {
      const std::string fault = parse_unit_system(options_.units, given);
      if (!fault.empty()) diagnostics_.error("--units " + options_.units, fault);
      report.source_of_units = "--units";
    }
    for (const Block& block : deck_.blocks())
      if (block.base() == "CONTROL_UNITS") read_card(block, written);
    if (given && written && given->name() != written->name())
      diagnostics_.error(card_origin_, fmt::format("the deck is in {}, but --units says {}; leave --units out",
                                                   written->name(), given->name()));
    if (written && !given) report.source_of_units = card_origin_.text();
    if (!given && !written && options_.units.empty()) propose();
    return given ? given : written;
  }

 private:
  void read_card(const Block& block, std::optional<UnitSystem>& written) {
    card_origin_ = deck_.origin(deck_.place_of(block));
    const auto word = [&](const char* field) {
      std::string text = deck_.text(block, 1, field).value;
      for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      return text;
    };
    const std::string fault =
        parse_unit_system(fmt::format("{},{},{}", word("mass"), word("length"), word("time")), written);
    if (!fault.empty()) diagnostics_.error(card_origin_, fault);
  }

  void propose() {
    const std::string fitting = fitting_systems(deck_);
    diagnostics_.error(deck_.origin({0, 1, 1}),
                       "the deck does not say its units; expected --units M,L,T, for example --units g,cm,us" +
                           (fitting.empty() ? std::string("; no usual system fits its densities and moduli")
                                            : "; its densities and moduli fit " + fitting));
  }

  const Deck& deck_;
  const LoweringOptions& options_;
  Diagnostics& diagnostics_;
  Origin card_origin_;
};

// ---- parts and report ------------------------------------------------------------------------------------------

UsedIds used_ids(const Lowering& low) {
  UsedIds used;
  for (const DeckPart& part : low.mesh.parts) {
    // A part of shells or beams is judged by its section, too.
    const bool has_solids = low.has_cells(part.id);
    if (!has_solids && low.mesh.mesh.left_out.empty()) continue;
    used.sections.insert(part.section);
    used.hourglass.insert(part.hourglass);
    if (!has_solids) continue;
    used.materials.insert(part.material);
    used.equations.insert(part.eos);
  }
  return used;
}

const char* shape_name(decks::SolidShape shape) {
  static const char* const names[] = {"hexahedra", "wedges", "pyramids", "tetrahedra", "ten-node tetrahedra"};
  return names[static_cast<std::size_t>(shape)];
}

double volume_of(const FileMesh& mesh, std::size_t cell) {
  CellCorners x{};
  for (std::size_t k = 0; k < 8; ++k) {
    const auto& point = mesh.points[static_cast<std::size_t>(mesh.cells[cell][k])];
    x[k] = {point[0], point[1], point[2]};
  }
  return volume_by_faces(hexahedron, x);
}

void report_parts(const Lowering& low, DeckReport& report) {
  for (const DeckPart& part : low.mesh.parts) {
    PartLine line{part.id, part.title, {}, low.part_name(part.id), {}};
    for (const MeshBlock& block : low.mesh.mesh.blocks) {
      if (block.label != part.id) continue;
      for (const std::int32_t cell : block.cells) {
        const auto c = static_cast<std::size_t>(cell);
        ++line.shapes[shape_name(low.mesh.shapes[c])];
        line.volume += volume_of(low.mesh.mesh, c);
      }
    }
    if (const Block* material = low.defined("MAT_", "mid", part.material, IdKind::material)) {
      line.material = fmt::format("*{} {}", material->base(), part.material);
      line.mass = line.volume * low.row(*material).value("ro", density);
    }
    report.parts.push_back(std::move(line));
  }
}

void report_sets(const DeckMesh& mesh, DeckReport& report) {
  const auto size = [](const auto& members) { return static_cast<std::int64_t>(members.size()); };
  for (const MeshNodeSet& set : mesh.mesh.node_sets)
    report.sets.push_back({"nodes", set.label, set.name, size(set.nodes)});
  for (const MeshFaceSet& set : mesh.mesh.face_sets)
    report.sets.push_back({"segments", set.label, set.name, size(set.faces)});
  for (const decks::DeckIdSet& set : mesh.part_sets) report.sets.push_back({"parts", set.id, set.title, size(set.ids)});
  for (const decks::DeckIdSet& set : mesh.solid_sets)
    report.sets.push_back({"solids", set.id, set.title, size(set.ids)});
  report.n_nodes = static_cast<std::int64_t>(mesh.mesh.points.size());
}

void check_solids(Lowering& low) {
  if (!low.mesh.ten_nodes.empty())
    low.differ(
        low.deck.origin(low.mesh.place_of_cell(static_cast<std::size_t>(low.mesh.ten_nodes.front().cell))),
        fmt::format("{} tetrahedra of ten nodes are computed with their four corners only", low.mesh.ten_nodes.size()));
  if (low.mesh.mesh.cells.empty()) low.error(low.root.origin, "the deck has no solids; expected *ELEMENT_SOLID");
}

/// Parts whose law was refused are left out where the user wants that.
void drop_parts_without_material(Lowering& low) {
  Entry* parts = low.root.find("parts");
  if (!parts) return;
  for (const Entry& part : parts->value.entries)
    if (!part.value.find("material") && !low.has_complained())
      low.error(part.value.origin, fmt::format("part {} has no material that Kerf can run", part.key));
  std::erase_if(parts->value.entries, [](const Entry& part) { return !part.value.find("material"); });
  std::erase_if(low.part_names, [&](const auto& part) { return !parts->value.find(part.second); });
  if (parts->value.entries.empty()) low.error(low.root.origin, "no part is left that can be run");
}

void lower(Lowering& low) {
  lower_control(low);
  lower_parts(low);
  lower_materials(low);
  drop_parts_without_material(low);
  lower_boundaries(low);
  lower_initial(low);
  lower_loads(low);
  lower_contacts(low);
}

/// Whether a deck has neither an end time nor a material.
bool is_mesh_only(const Deck& deck) {
  return std::none_of(deck.blocks().begin(), deck.blocks().end(), [](const Block& block) {
    return block.base() == "CONTROL_TERMINATION" || block.base().rfind("MAT_", 0) == 0;
  });
}

bool is_keyword_line(std::string_view line) {
  return line.size() > 1 && line[0] == '*' &&
         ((line[1] >= 'A' && line[1] <= 'Z') || (line[1] >= 'a' && line[1] <= 'z'));
}

}  // namespace

bool is_deck(const std::string& path, const std::string& bytes) {
  const std::string ending = std::filesystem::path(path).extension().string();
  for (const char* known : {".k", ".key", ".dyn", ".kwd", ".K", ".KEY"})
    if (ending == known) return true;
  for (const char* other : {".yaml", ".yml", ".inp", ".msh", ".exo", ".ex2", ".e", ".g", ".h5"})
    if (ending == other) return false;
  std::string_view rest = bytes;
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, std::min(rest.find('\n'), rest.size()));
    if (!line.empty() && line[0] != '$' && line[0] != '\r') return is_keyword_line(line);
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  }
  return false;
}

namespace {

LoweredDeck mesh_alone(DeckMesh mesh, const LoweringOptions& options, Diagnostics& diagnostics) {
  LoweredDeck result;
  result.report.units = length_of(options.units, diagnostics);
  result.mesh_name = options.mesh_name;
  result.document = document_of_mesh(mesh.mesh, result.mesh_name, result.report.units);
  result.mesh = std::make_shared<FileMesh>(std::move(mesh.mesh));
  return result;
}

}  // namespace

LoweredDeck lower_deck(const std::string& path, LoweringOptions options, Diagnostics& diagnostics) {
  if (options.mesh_name.empty()) options.mesh_name = std::filesystem::path(path).filename().string();
  LoweredDeck result;
  result.mesh_name = options.mesh_name;
  const Deck deck = decks::read_deck(path, {options.case_number, options.without_unsupported}, diagnostics);
  result.mesh = std::make_shared<FileMesh>();
  if (deck.sources().empty() || deck.blocks().empty()) {
    if (!diagnostics.has_errors())
      diagnostics.error(Origin{std::make_shared<const std::string>(path), 1, 1},
                        "there is no keyword in the file; expected a keyword deck");
    return result;
  }
  decks::check_fields(deck, diagnostics);
  DeckMesh mesh = decks::read_mesh(deck, diagnostics);
  const bool is_mesh = options.mesh_is_enough && is_mesh_only(deck);
  if (!is_mesh) decks::check_references(deck, mesh, diagnostics);
  const bool is_sound = !diagnostics.has_errors();
  if (is_mesh) return mesh_alone(std::move(mesh), options, diagnostics);
  const std::optional<UnitSystem> found =
      is_sound ? Units(deck, options, diagnostics).find(result.report) : std::optional<UnitSystem>();
  const UnitSystem units = found ? *found : usual_systems().front().units;
  result.report.units = units.name();
  Lowering low(deck, mesh, units, options, result.report, diagnostics);
  low.name_parts();
  check_handled(low, used_ids(low));
  report_parts(low, result.report);
  report_sets(mesh, result.report);
  check_solids(low);
  if (is_sound && !mesh.mesh.cells.empty()) lower(low);
  result.document = std::move(low.root);
  result.mesh = std::make_shared<FileMesh>(std::move(mesh.mesh));
  result.mesh->node_sets = std::move(low.sets);
  result.mesh->face_sets.clear();
  return result;
}

}  // namespace kerf::lowering
