// *INCLUDE and its kin, and the motions that *DEFINE_TRANSFORMATION gives them.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "decks/deck_reader.hpp"

namespace kerf::decks {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_nested = 50;  // includes within includes
constexpr std::size_t most_readings = 5000;  // of files
constexpr std::size_t most_cards = 500'000'000;
constexpr std::uintmax_t most_bytes = 4'000'000'000;

bool is_file(const fs::path& path) {
  std::error_code status;
  return fs::is_regular_file(path, status);
}

/// The bytes of a file, or null.
std::shared_ptr<const std::string> bytes_of(const std::string& path) {
  std::error_code status;
  const std::uintmax_t size = fs::file_size(path, status);
  if (status || size > most_bytes) return nullptr;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) return nullptr;
  auto bytes = std::make_shared<std::string>(static_cast<std::size_t>(size), '\0');
  bytes->resize(std::fread(bytes->data(), 1, bytes->size(), file.get()));
  return bytes;
}

double factor_of(const Field<double>& field) { return field.value == 0.0 ? 1.0 : field.value; }

}  // namespace

std::int32_t DeckReader::open(const std::string& path, const Place& asked, std::int32_t parent) {
  std::error_code status;
  Source source;
  source.name = std::make_shared<const std::string>(path);
  source.canonical = fs::weakly_canonical(path, status).string();
  source.folder = fs::path(path).parent_path().string();
  source.parent = parent;
  std::shared_ptr<const std::string>& bytes = bytes_[source.canonical];
  if (!bytes && is_file(path)) bytes = bytes_of(path);
  if (parent < 0) deck_.sources_.push_back(source);  // so that the message has a file
  if (!bytes) {
    errors_.error(asked, "files", fmt::format("file {} cannot be read; expected a file of less than 4 GB", path));
    return -1;
  }
  source.bytes = bytes;
  if (parent < 0) {
    deck_.sources_.back() = source;
    open_files_.push_back(source.canonical);
  } else {
    source.format = deck_.sources_[static_cast<std::size_t>(parent)].format;
    deck_.sources_.push_back(source);
  }
  return static_cast<std::int32_t>(deck_.sources_.size()) - 1;
}

// " +" at the end of a line says that the name goes on in the next one.
DeckReader::IncludedName DeckReader::name_at(const Block& block, std::size_t first) const {
  IncludedName found{{}, card_of(block, first).line, 0};
  for (std::size_t k = first; k < block.n_cards; ++k) {
    std::string_view text = without_blanks(card_of(block, k).view());
    ++found.n_cards;
    const bool goes_on = text.size() >= 2 && text.substr(text.size() - 2) == " +";
    if (goes_on) text = without_blanks(text.substr(0, text.size() - 1));
    found.name += text;
    if (!goes_on) break;
  }
  return found;
}

void DeckReader::read_includes(const Block& block) {
  for (std::size_t k = 0; k < block.n_cards;) {
    const IncludedName name = name_at(block, k);
    k += name.n_cards;
    if (!name.name.empty()) include(block, name, {});
  }
}

void DeckReader::read_include_path(const Block& block) {
  const bool relative = block.base() == "INCLUDE_PATH_RELATIVE";
  for (std::size_t k = 0; k < block.n_cards;) {
    const IncludedName name = name_at(block, k);
    k += name.n_cards;
    if (name.name.empty()) continue;
    const std::string& base = relative ? source_of(block)->folder : deck_.sources_.front().folder;
    folders_.push_back((fs::path(base) / name.name).lexically_normal().string());
  }
}

std::string DeckReader::found(const Block& block, const std::string& name, std::string& looked_in) const {
  std::vector<std::string> folders = {deck_.sources_[static_cast<std::size_t>(block.source)].folder,
                                      deck_.sources_.front().folder};
  folders.insert(folders.end(), folders_.begin(), folders_.end());
  std::string with_slashes = name;
  std::replace(with_slashes.begin(), with_slashes.end(), '\\', '/');
  for (const std::string& spelling : {name, with_slashes})
    for (const std::string& folder : folders) {
      const fs::path path = (fs::path(folder) / spelling).lexically_normal();
      if (is_file(path)) return path.string();
    }
  std::vector<std::string> shown;
  for (const std::string& folder : folders) {
    const std::string text = folder.empty() ? "." : folder;
    if (std::find(shown.begin(), shown.end(), text) == shown.end()) shown.push_back(text);
  }
  looked_in = fmt::format("{}", fmt::join(shown, ", "));
  return {};
}

void DeckReader::include(const Block& block, const IncludedName& name, const Transform& inner) {
  const Place place{block.source, name.line, 1};
  std::string looked_in;
  const std::string text = to_utf8(name.name.substr(0, 300));
  const std::string path = name.name.find('\0') == std::string::npos ? found(block, name.name, looked_in) : "";
  if (path.empty())
    return errors_.error(place, "includes", fmt::format("file {} is not found; looked in: {}", text, looked_in));
  std::error_code status;
  const std::string canonical = fs::weakly_canonical(path, status).string();
  const auto loop = std::find(open_files_.begin(), open_files_.end(), canonical);
  if (loop != open_files_.end())
    return errors_.error(place, "includes",
                         fmt::format("{} includes itself{}", text,
                                     loop + 1 == open_files_.end() ? "" : ", through " + *source_of(block)->name));
  if (open_files_.size() >= most_nested || deck_.sources_.size() >= most_readings || deck_.cards_.size() >= most_cards)
    return errors_.error(
        place, "includes",
        fmt::format("more includes than are read: {} within one another, {} in all", most_nested, most_readings));
  const std::int32_t source = open(path, place, block.source);
  if (source < 0) return;
  deck_.sources_.back().transform = source_of(block)->transform.after(inner);
  open_files_.push_back(canonical);
  read_source(source);
  open_files_.pop_back();
}

void DeckReader::read_include_transform(const Block& block) {
  if (block.n_cards == 0)
    return errors_.error(deck_.place_of(block), "includes",
                         "*INCLUDE_TRANSFORM needs a card; the next keyword follows at once");
  const IncludedName name = name_at(block, 0);
  Block cards = block;  // the last line of the name is the first card of the table
  cards.first_card += name.n_cards - 1;
  cards.n_cards -= name.n_cards - 1;
  deck_.arrange(cards);
  include(block, name, transform_of(cards));
}

Transform DeckReader::transform_of(const Block& block) {
  Transform transform;
  const auto check = [&](int card, const char* name, FieldType type) {
    const FieldSpec* spec = block.name.spec->card(card)->field(name);
    const Card* raw = deck_.card(block, card);
    if (!raw) return;
    const FieldText text = block.name.spec->card(card)->text_of(*spec, raw->view(), block.format);
    Place place{block.source, raw->line, text.column};
    double real = 0.0;
    std::int64_t integer = 0;
    if (text.text.empty()) return;
    const FieldMistake mistake =
        type == FieldType::real ? deck_.read(block, text, real, place) : deck_.read(block, text, integer, place);
    if (mistake) errors_.error(place, "includes", fmt::format("field {}: {}", upper_case(name), mistake.message));
  };
  const std::pair<int, const char*> offsets[] = {{2, "idnoff"}, {2, "ideoff"}, {2, "idpoff"}, {2, "idmoff"},
                                                 {2, "idsoff"}, {2, "idfoff"}, {2, "iddoff"}, {3, "idroff"}};
  for (std::size_t k = 0; k < transform.offsets.size(); ++k) {
    check(offsets[k].first, offsets[k].second, FieldType::integer);
    transform.offsets[k] = deck_.integer(block, offsets[k].first, offsets[k].second).value;
  }
  const std::pair<const char*, double*> factors[] = {
      {"fctmas", &transform.mass}, {"fcttim", &transform.time}, {"fctlen", &transform.length}};
  for (const auto& [name, factor] : factors) {
    check(4, name, FieldType::real);
    const Field<double> field = deck_.real(block, 4, name);
    *factor = factor_of(field);
    if (!(*factor > 0.0))
      errors_.error(field.place, "includes",
                    fmt::format("{} is {}; expected a factor above zero", upper_case(name), field.value));
  }
  const Field<std::string> temperature = deck_.text(block, 4, "fcttem");
  double kelvin = 0.0;
  if (temperature.given && !(read_deck_real(temperature.value, kelvin) && (kelvin == 1.0 || kelvin == 0.0)))
    errors_.error(
        temperature.place, "includes",
        fmt::format("FCTTEM {}: temperatures of includes are not converted; expected 1.0", temperature.value));
  transform.motion = Affine::scaled(transform.length, transform.length, transform.length);
  check(5, "tranid", FieldType::integer);
  const Field<std::int64_t> tranid = deck_.integer(block, 5, "tranid");
  if (tranid.value == 0) return transform;
  const auto motion = motions_.find(source_of(block)->transform.id(tranid.value, IdKind::definition));
  if (motion == motions_.end())
    errors_.error(tranid.place, "includes",
                  fmt::format("transformation {} is not defined before this place", tranid.value));
  else
    transform.motion = motion->second.affine.after(transform.motion);
  return transform;
}

// The last line is carried out first.
void DeckReader::read_transformation(const Block& block) {
  const Field<std::int64_t> id = deck_.integer(block, 1, "tranid");
  Affine motion;
  for (std::size_t k = 0; k < deck_.n_repeats(block); ++k) {
    Affine line;
    if (motion_of(block, k, line)) motion = motion.after(line);
  }
  const std::int64_t whole_id = source_of(block)->transform.id(id.value, IdKind::definition);
  const auto [first, is_new] = motions_.emplace(whole_id, Motion{motion, id.place});
  if (!is_new)
    errors_.error(
        id.place, "transformations",
        fmt::format("transformation {} is defined twice; first at {}", whole_id, deck_.text_of(first->second.place)));
}

bool DeckReader::motion_of(const Block& block, std::size_t repeat, Affine& motion) {
  const Field<std::string> option = deck_.text(block, 2, "option", repeat);
  double a[8] = {};
  for (int k = 1; k < 8; ++k) a[k] = deck_.real(block, 2, fmt::format("a{}", k), repeat).value;
  const std::string name = upper_case(option.value);
  if (name.empty()) return false;
  const auto refuse = [&](const std::string& what) {
    errors_.error(option.place, "transformations", what);
    return false;
  };
  if (name == "TRANSL") {
    motion = Affine::moved(a[1], a[2], a[3]);
  } else if (name == "SCALE") {
    const auto factor = [](double x) { return x == 0.0 ? 1.0 : x; };
    motion = Affine::scaled(factor(a[1]), factor(a[2]), factor(a[3]));
  } else if (name == "ROTATE") {
    if (a[4] == 0.0 && a[5] == 0.0 && a[6] == 0.0 && a[7] == 0.0)
      return refuse("ROTATE about two points is not read; expected a direction, a point and an angle A7");
    if (a[1] == 0.0 && a[2] == 0.0 && a[3] == 0.0) return refuse("the axis of ROTATE has no direction");
    motion = Affine::turned({a[1], a[2], a[3]}, {a[4], a[5], a[6]}, a[7]);
  } else if (name == "MIRROR") {
    if (a[1] == a[4] && a[2] == a[5] && a[3] == a[6])
      return refuse("the two points of MIRROR are the same; the way between them is normal to the mirror");
    motion = Affine::mirrored({a[1], a[2], a[3]}, {a[4], a[5], a[6]});
  } else {
    return refuse(
        fmt::format("option {} of *DEFINE_TRANSFORMATION is not read; expected TRANSL, ROTATE, SCALE or MIRROR",
                    name.substr(0, 40)));
  }
  return true;
}

}  // namespace kerf::decks
