// Reads the files of a deck: keywords, cards, includes, parameters, transformations and cases.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "decks/deck.hpp"

namespace kerf::decks {

/// Fills a deck, file by file in the order of the includes. For one use.
class DeckReader {
 public:
  DeckReader(Deck& deck, const DeckOptions& options, Diagnostics& diagnostics)
      : deck_(deck), options_(options), errors_(deck, diagnostics) {}
  void read(const std::string& path);

 private:
  // deck_reader.cpp
  void read_source(std::int32_t source);
  bool start_block(std::int32_t source, std::string_view line, std::int32_t number);
  void finish_block();
  void read_keyword(Block& block);
  bool is_active(const Block& block) const;
  void read_case(const Block& block);
  void open_or_close_case(const Block& block);
  void check_case() const;
  Source* source_of(const Block& block) { return &deck_.sources_[static_cast<std::size_t>(block.source)]; }
  const Card& card_of(const Block& block, std::size_t k) const { return deck_.cards_[block.first_card + k]; }
  // read_includes.cpp
  struct IncludedName {
    std::string name;
    std::int32_t line = 0;
    std::size_t n_cards = 0;  // that the name takes
  };
  IncludedName name_at(const Block& block, std::size_t first) const;
  void read_includes(const Block& block);
  void read_include_path(const Block& block);
  void read_include_transform(const Block& block);
  Transform transform_of(const Block& block);
  void include(const Block& block, const IncludedName& name, const Transform& inner);
  std::string found(const Block& block, const std::string& name, std::string& looked_in) const;
  std::int32_t open(const std::string& path, const Place& asked, std::int32_t parent);
  void read_transformation(const Block& block);
  bool motion_of(const Block& block, std::size_t repeat, Affine& motion);
  // read_parameters.cpp
  void read_parameters(const Block& block);
  void read_expressions(const Block& block);
  void define(const Block& block, const FieldText& name, const FieldText& value, std::int32_t line, bool expression);

  Deck& deck_;
  const DeckOptions options_;
  mutable DeckErrors errors_;
  std::map<std::string, std::shared_ptr<const std::string>> bytes_;  // by canonical name
  std::vector<std::string> open_files_;  // canonical names, outermost first
  std::vector<std::string> folders_;  // of *INCLUDE_PATH
  struct Motion {
    Affine affine;
    Place place;
  };
  std::map<std::int64_t, Motion> motions_;  // of *DEFINE_TRANSFORMATION
  std::set<int> active_cases_, seen_cases_;
  int open_case_ = 0;
  Place open_case_place_;
  std::int32_t order_ = 1;
  bool in_block_ = false;  // the last block of the deck is being filled
};

}  // namespace kerf::decks
