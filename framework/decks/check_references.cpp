// Finds ids that fields name but nothing defines, curves that do not increase, and a missing end time.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "decks/deck_mesh.hpp"

namespace kerf::decks {
namespace {

bool begins(const std::string& text, const char* with) { return text.rfind(with, 0) == 0; }

/// What a keyword defines: the name of its kind, the field with the id, and how offsets call it.
struct Definition {
  const char* kind = nullptr;
  const char* field = nullptr;
  IdKind offset = IdKind::other;
};

Definition definition_of(const std::string& base) {
  if (begins(base, "MAT_THERMAL_")) return {"thermal_material", "tmid", IdKind::material};
  if (begins(base, "MAT_ADD_") || base == "MAT_NONLOCAL") return {};  // they name materials
  if (begins(base, "MAT_")) return {"material", "mid", IdKind::material};
  if (begins(base, "EOS_")) return {"eos", "eosid", IdKind::material};
  if (base == "HOURGLASS") return {"hourglass", "hgid", IdKind::other};
  if (begins(base, "SECTION_")) return {"section", "secid", IdKind::other};
  if (begins(base, "DEFINE_CURVE")) return {"curve", "lcid", IdKind::function};
  if (begins(base, "DEFINE_TABLE")) return {"curve", "tbid", IdKind::function};
  if (base == "DEFINE_BOX") return {"box", "boxid", IdKind::definition};
  if (begins(base, "DEFINE_COORDINATE_")) return {"coordinate_system", "cid", IdKind::definition};
  if (base == "DEFINE_VECTOR") return {"vector", "vid", IdKind::definition};
  return {};
}

IdKind offset_of(const std::string& kind) {
  if (kind == "node") return IdKind::node;
  if (kind == "part") return IdKind::part;
  if (kind == "material" || kind == "eos") return IdKind::material;
  if (kind == "curve") return IdKind::function;
  if (kind == "box") return IdKind::definition;
  return kind == "node_set" || kind == "segment_set" || kind == "part_set" ? IdKind::set : IdKind::other;
}

std::string shown(const std::string& kind) {
  if (kind == "eos") return "equation of state";
  if (kind == "hourglass") return "hourglass control";
  std::string words = kind;
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

class References {
 public:
  References(const Deck& deck, const DeckMesh& mesh, DeckErrors& errors) : deck_(deck), mesh_(mesh), errors_(errors) {}

  void check() {
    collect();
    for (const Block& block : deck_.blocks()) {
      if (block.name.use != KeywordUse::tabled) continue;
      check_fields_of(block);
      if (block.base() == "DEFINE_CURVE") check_curve(block);
      if (begins(block.base(), "CONTACT_") && block.name.spec->card(1)->field("surfatyp")) check_contact(block);
    }
    const bool ends = std::any_of(deck_.blocks().begin(), deck_.blocks().end(),
                                  [](const Block& b) { return b.base() == "CONTROL_TERMINATION"; });
    if (!ends && !deck_.sources().empty())
      errors_.error({0, 1, 1}, "end time", "no *CONTROL_TERMINATION: the end time is not given");
  }

 private:
  void collect() {
    for (const Block& block : deck_.blocks()) {
      const Definition defines = definition_of(block.base());
      if (!defines.kind) continue;
      if (block.name.use != KeywordUse::tabled) {  // its cards are not known, but its first number is its id
        define(defines, block, deck_.first_field(block));
        continue;
      }
      const bool once = block.name.spec->has(CardWhen::always);
      const std::size_t n = once ? 1 : deck_.n_repeats(block);
      for (std::size_t r = 0; r < n; ++r)
        if (const Card* card = deck_.card(block, 1, r); card && (once || !is_blank(card->view())))
          if (!is_unreadable(block, 1, defines.field, r))
            define(defines, block, deck_.integer(block, 1, defines.field, r));
    }
    for (const MeshNodeSet& set : mesh_.mesh.node_sets) defined_["node_set"].try_emplace(set.label);
    for (const MeshFaceSet& set : mesh_.mesh.face_sets) defined_["segment_set"].try_emplace(set.label);
    for (const DeckIdSet& set : mesh_.part_sets) defined_["part_set"].try_emplace(set.id);
    for (const DeckPart& part : mesh_.parts) defined_["part"].try_emplace(part.id);
    for (const MeshBlock& block : mesh_.mesh.blocks) with_solids_.insert(block.label);
    for (const std::int64_t label : mesh_.mesh.node_labels) nodes_.push_back(label);
    std::sort(nodes_.begin(), nodes_.end());
    for (const Block& block : deck_.blocks())
      for (const auto& [stem, kind] : {std::pair{"SET_NODE", "node_set"}, std::pair{"SET_SEGMENT", "segment_set"},
                                       std::pair{"SET_PART", "part_set"}}) {
        if (!begins(block.base(), stem)) continue;
        const std::int64_t id = deck_.transform_of(block).id(deck_.first_integer(block), IdKind::set);
        if (!is_defined(kind, id)) unread_[{kind, id}] = block.written;
      }
  }

  void define(const Definition& defines, const Block& block, const Field<std::int64_t>& written) {
    const std::int64_t id = deck_.transform_of(block).id(written.value, defines.offset);
    if (written.value <= 0 && block.name.use == KeywordUse::tabled)
      return errors_.error(
          written.place, "ids of definitions",
          fmt::format("*{}: {} is {}; expected an id above zero", block.written, upper_case(defines.field),
                      written.given ? std::to_string(written.value) : "blank"));
    const auto [first, is_new] = defined_[defines.kind].emplace(id, Defined{written.place, &block});
    if (is_new || !written.given) return;
    const Block& other = *first->second.block;
    errors_.error(written.place, "ids defined twice",
                  fmt::format("{} {} is defined twice; first at {}{}", shown(defines.kind), id,
                              deck_.text_of(first->second.place),
                              other.base() == block.base() ? "" : ", with *" + other.written));
  }

  bool is_defined(const std::string& kind, std::int64_t id) {
    if (kind == "node") return std::binary_search(nodes_.begin(), nodes_.end(), id);
    return defined_[kind].count(id) > 0;
  }

  void check_fields_of(const Block& block) {
    const std::size_t n_groups = deck_.n_repeats(block);
    for (const CardSpec& card : block.name.spec->cards) {
      if (card.when != CardWhen::always && card.when != CardWhen::more) continue;
      const std::size_t n = card.when == CardWhen::always ? 1 : n_groups;
      for (const FieldSpec& field : card.fields)
        for (std::size_t r = 0; r < n && !field.reference.kind.empty(); ++r)
          if (deck_.card(block, card.number, r)) check_field(block, card, field, r);
    }
  }

  void check_field(const Block& block, const CardSpec& card, const FieldSpec& spec, std::size_t repeat) {
    const FieldReference& reference = spec.reference;
    const Field<std::int64_t> field = deck_.integer(block, card.number, spec.name, repeat);
    if (field.value > 0) return check_id(block, reference.kind, field, repeat);
    if (field.value < 0 && reference.may_be_negative) {
      if (reference.negative_kind.empty()) return;
      const std::int64_t id = -std::max(field.value, -std::numeric_limits<std::int64_t>::max());
      return check_id(block, reference.negative_kind, {id, field.given, field.place}, repeat);
    }
    const bool is_missing = field.value == 0 && reference.required && is_needed(block, repeat) &&
                            !is_unreadable(block, card.number, spec.name, repeat);
    if (is_missing || field.value < 0) expect(block, spec.name, reference, field, repeat);
  }

  /// Whether a field holds text that is no number: check_fields has complained.
  bool is_unreadable(const Block& block, int card, std::string_view field, std::size_t repeat) const {
    return !deck_.integer(block, card, field, repeat).given && deck_.text(block, card, field, repeat).given;
  }

  /// Parts without solids need nothing: what they are made of never counts.
  bool is_needed(const Block& block, std::size_t repeat) const {
    return !begins(block.base(), "PART") || with_solids_.count(part_of(block, repeat)) > 0;
  }

  std::int64_t part_of(const Block& block, std::size_t repeat) const {
    return deck_.transform_of(block).id(deck_.integer(block, 2, "pid", repeat).value, IdKind::part);
  }

  void expect(const Block& block, const std::string& name, const FieldReference& reference,
              const Field<std::int64_t>& field, std::size_t repeat) {
    const std::string kind = shown(reference.kind);
    const bool vowel = std::string_view("aeiou").find(kind.front()) != std::string_view::npos;
    errors_.error(
        field.place, "ids that are missing",
        fmt::format("{}: {} is {}; expected the number of {} {}{}",
                    begins(block.base(), "PART") ? fmt::format("part {}", part_of(block, repeat)) : "*" + block.written,
                    upper_case(name), field.given ? std::to_string(field.value) : "blank",
                    vowel || reference.kind == "hourglass" ? "an" : "a", kind, reference.required ? "" : ", or 0"));
  }

  void check_id(const Block& block, const std::string& kind, const Field<std::int64_t>& field, std::size_t repeat) {
    const std::int64_t id = deck_.transform_of(block).id(field.value, offset_of(kind));
    if (is_defined(kind, id)) return;
    if (const auto unread = unread_.find({kind, id}); unread != unread_.end())
      return errors_.error(
          field.place, "sets that are not read",
          fmt::format("{} {} is written with *{}, which is not read", shown(kind), id, unread->second));
    errors_.error(field.place, "undefined ids",
                  begins(block.base(), "PART") ? fmt::format("part {} names {} {}, which is not defined",
                                                             part_of(block, repeat), shown(kind), id)
                                               : fmt::format("{} {} is not defined", shown(kind), id));
  }

  /// What SURFA and SURFB name hangs on their types: 0 segment sets, 2 part sets, 3 parts, 4 node sets.
  void check_contact(const Block& block) {
    for (const auto& [name, type] : {std::pair{"surfa", "surfatyp"}, std::pair{"surfb", "surfbtyp"}}) {
      const Field<std::int64_t> surface = deck_.integer(block, 1, name);
      const std::int64_t of_type = deck_.integer(block, 1, type).value;
      const char* kind = of_type == 0                   ? "segment_set"
                         : of_type == 2 || of_type == 6 ? "part_set"
                         : of_type == 3                 ? "part"
                         : of_type == 4                 ? "node_set"
                                                        : nullptr;
      if (!kind || surface.value == 0) continue;
      if (surface.value < 0) {
        expect(block, name, {kind, true, false, {}}, surface, 0);
        continue;
      }
      const std::int64_t id = deck_.transform_of(block).id(surface.value, offset_of(kind));
      if (is_defined(kind, id)) continue;
      const auto unread = unread_.find({kind, id});
      const std::string why =
          unread == unread_.end() ? "is not defined" : "is written with *" + unread->second + ", which is not read";
      errors_.error(surface.place, "undefined ids",
                    fmt::format("{} {}: {} {} {}", upper_case(name), surface.value, shown(kind), id, why));
    }
  }

  void check_curve(const Block& block) {
    const std::size_t n = deck_.n_repeats(block);
    for (std::size_t r = 1; r < n; ++r) {
      const Field<double> before = deck_.real(block, 2, "a1", r - 1), here = deck_.real(block, 2, "a1", r);
      if (here.value > before.value) continue;
      errors_.error({here.place.source, here.place.line, 1}, "curves",
                    fmt::format("abscissae of curve {} must increase: {:.6g} follows {:.6g}",
                                deck_.integer(block, 1, "lcid").value, here.value, before.value));
    }
  }

  const Deck& deck_;
  const DeckMesh& mesh_;
  DeckErrors& errors_;
  struct Defined {
    Place place;
    const Block* block = nullptr;
  };
  std::map<std::string, std::map<std::int64_t, Defined>> defined_;
  std::map<std::pair<std::string, std::int64_t>, std::string> unread_;  // sets in forms that are not read: keywords
  std::vector<std::int64_t> nodes_;
  std::set<std::int64_t> with_solids_;  // parts
};

}  // namespace

void check_references(const Deck& deck, const DeckMesh& mesh, Diagnostics& diagnostics) {
  DeckErrors errors(deck, diagnostics);
  References(deck, mesh, errors).check();
}

}  // namespace kerf::decks
