// Reads nodes and parts of a deck, and puts the mesh together.
#include "decks/deck_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "decks/mesh_builder.hpp"

namespace kerf::decks {
namespace {

const std::vector<std::string> node_fields = {"NID", "X", "Y", "Z", "TC", "RC"};

std::vector<std::int32_t> node_widths(CardFormat format) {
  switch (format) {
    case CardFormat::wide:
      return {20, 20, 20, 20, 20, 20};
    case CardFormat::i10:
      return {10, 16, 16, 16, 8, 8};
    case CardFormat::standard:
      break;
  }
  return {8, 16, 16, 16, 8, 8};
}

/// Keywords of elements that are no solids, and what they are counted as.
std::string kind_of_other_element(const std::string& base) {
  for (const char* kind : {"SHELL", "BEAM", "TSHELL", "DISCRETE", "SPH", "SEATBELT"})
    if (base.rfind(fmt::format("ELEMENT_{}", kind), 0) == 0) {
      std::string lower(kind);
      for (char& c : lower) c = static_cast<char>(c - 'A' + 'a');
      return lower;
    }
  return {};
}

}  // namespace

DeckMesh MeshBuilder::build() {
  const std::vector<Block>& blocks = deck_.blocks();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const std::string& base = blocks[b].base();
    if (base == "NODE") read_nodes(blocks[b]);
    if (base == "PART" || base == "PART_INERTIA" || base == "PART_CONTACT")
      read_parts(blocks[b], static_cast<std::int32_t>(b));
    if (base.rfind("ELEMENT_SOLID_", 0) == 0 || base.rfind("NODE_", 0) == 0)
      errors_.error(deck_.place_of(blocks[b]), "forms of the mesh",
                    fmt::format("*{} is not read; *NODE and *ELEMENT_SOLID are", blocks[b].written));
    if (const std::string kind = kind_of_other_element(base); !kind.empty())
      out_.mesh.left_out[kind] += static_cast<std::int64_t>(blocks[b].n_cards);
  }
  declares_parts_ = !out_.parts.empty();
  check_nodes();
  const LabelMap node_index(out_.mesh.node_labels);
  node_index_ = &node_index;
  for (const Block& block : blocks)
    if (block.base() == "ELEMENT_SOLID") read_solids(block);
  check_solids();
  finish_blocks();
  read_sets();
  out_.mesh.format = "LS-DYNA keyword deck";
  return std::move(out_);
}

void MeshBuilder::read_nodes(const Block& block) {
  BulkCard fields(deck_, block, errors_, node_fields, node_widths(block.format));
  const Transform& transform = deck_.transform_of(block);
  FileMesh& mesh = out_.mesh;
  for (std::size_t k = 0; k < block.n_cards; ++k) {
    const Card& card = deck_.cards_of(block)[k];
    if (is_blank(card.view())) continue;
    if (!fields.take(card)) continue;
    const std::int64_t id = fields.integer(0);
    const std::array<double, 3> x = {fields.real(1), fields.real(2), fields.real(3)};
    if (fields.bad()) continue;
    if (id <= 0) {
      errors_.error(fields.place(0), "ids of nodes", fmt::format("a node has the id {}; expected one above zero", id));
      continue;
    }
    if (mesh.points.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) return;
    keep_node_codes(block, fields, card, static_cast<std::int32_t>(mesh.points.size()));
    mesh.points.push_back(transform.motion(x));
    mesh.node_labels.push_back(transform.id(id, IdKind::node));
    node_places_.push_back(fields.place());
  }
}

// With ids in ten columns, programs write the codes in eight or ten columns each: there, blanks separate them.
void MeshBuilder::keep_node_codes(const Block& block, BulkCard& fields, const Card& card, std::int32_t node) {
  std::int64_t tc = 0, rc = 0;
  const std::string_view text = card.view();
  if (block.format == CardFormat::i10 && text.find(',') == std::string_view::npos) {
    const std::string_view rest = text.size() > 58 ? without_blanks(text.substr(58)) : std::string_view();
    if (rest.empty()) return;
    const std::size_t blank = std::min(rest.find(' '), rest.size());
    const std::size_t end = static_cast<std::size_t>(rest.data() - text.data()) + rest.size();
    bool ok = read_deck_integer(rest.substr(0, blank), tc);
    if (blank < rest.size()) {
      ok = ok && read_deck_integer(without_blanks(rest.substr(blank)), rc);
    } else if (end > 68) {  // it stands in the second field
      std::swap(tc, rc);
    }
    if (!ok) tc = -1;
  } else {
    tc = fields.integer(4);
    rc = fields.integer(5);
  }
  if (tc < 0 || tc > 7 || rc < 0 || rc > 7)
    return errors_.error(fields.place(4), "codes of nodes", "codes TC and RC of nodes are integers from 0 to 7");
  if (tc != 0 || rc != 0) out_.codes.push_back({node, static_cast<std::int8_t>(tc), static_cast<std::int8_t>(rc)});
}

void MeshBuilder::check_nodes() {
  const FileMesh& mesh = out_.mesh;
  std::vector<std::int32_t> order(mesh.node_labels.size());
  std::iota(order.begin(), order.end(), 0);
  const auto label = [&](std::int32_t k) { return mesh.node_labels[static_cast<std::size_t>(k)]; };
  const auto less = [&](std::int32_t a, std::int32_t b) { return label(a) != label(b) ? label(a) < label(b) : a < b; };
  if (!std::is_sorted(order.begin(), order.end(), less)) std::sort(order.begin(), order.end(), less);
  std::size_t first = 0;
  for (std::size_t k = 1; k < order.size(); ++k) {
    if (label(order[k]) != label(order[first])) {
      first = k;
      continue;
    }
    const auto a = static_cast<std::size_t>(order[first]), b = static_cast<std::size_t>(order[k]);
    const bool same = mesh.points[a] == mesh.points[b];
    const std::string where = node_places_[a].source == node_places_[b].source
                                  ? fmt::format("in line {}", node_places_[a].line)
                                  : "at " + deck_.text_of(node_places_[a]);
    errors_.error(node_places_[b], "nodes defined twice",
                  fmt::format("node {} is defined twice, with {}; first {}", label(order[k]),
                              same ? "the same place" : "different places", where));
  }
}

void MeshBuilder::read_parts(const Block& block, std::int32_t number) {
  const Transform& transform = deck_.transform_of(block);
  for (std::size_t r = 0; r < deck_.n_repeats(block); ++r) {
    const Card* ids = deck_.card(block, 2, r);
    if (!ids) {
      errors_.error({block.source, deck_.card(block, 1, r)->line, 1}, "parts",
                    fmt::format("*{} has a title here, but no card with ids below it", block.written));
      return;
    }
    const auto value = [&](const char* name) { return deck_.integer(block, 2, name, r); };
    DeckPart part;
    const Field<std::int64_t> id = value("pid");
    part.place = {block.source, ids->line, 1};
    if (id.value <= 0) {
      errors_.error(id.place, "parts", fmt::format("a part has the id {}; expected one above zero", id.value));
      continue;
    }
    part.id = transform.id(id.value, IdKind::part);
    part.title = deck_.text(block, 1, "title", r).value;
    part.section = transform.id(value("secid").value, IdKind::other);
    part.material = transform.id(value("mid").value, IdKind::material);
    part.eos = transform.id(value("eosid").value, IdKind::material);
    part.hourglass = transform.id(value("hgid").value, IdKind::other);
    part.block = number;
    part.repeat = r;
    const auto [known, is_new] = part_of_id_.emplace(part.id, static_cast<std::int32_t>(out_.parts.size()));
    if (!is_new) {
      errors_.error(id.place, "parts",
                    fmt::format("part {} is defined twice; first at {}", part.id,
                                deck_.text_of(out_.parts[static_cast<std::size_t>(known->second)].place)));
      continue;
    }
    out_.parts.push_back(std::move(part));
  }
}

void MeshBuilder::finish_blocks() {
  std::vector<std::vector<std::int32_t>> cells(out_.parts.size());
  for (std::size_t c = 0; c < out_.cell_part.size(); ++c)
    if (out_.cell_part[c] >= 0)
      cells[static_cast<std::size_t>(out_.cell_part[c])].push_back(static_cast<std::int32_t>(c));
  std::unordered_map<std::string, int> n_named;
  for (const DeckPart& part : out_.parts) ++n_named[part.title];
  for (std::size_t p = 0; p < out_.parts.size(); ++p) {
    if (cells[p].empty()) continue;
    const DeckPart& part = out_.parts[p];
    const bool own = !part.title.empty() && n_named[part.title] == 1;
    out_.mesh.blocks.push_back({own ? part.title : std::to_string(part.id),
                                part.id,
                                std::move(cells[p]),
                                {part.place.line, part.place.column}});
  }
}

DeckMesh read_mesh(const Deck& deck, Diagnostics& diagnostics) {
  DeckErrors errors(deck, diagnostics);
  return MeshBuilder(deck, errors).build();
}

}  // namespace kerf::decks
