// What a type declares: texts, units, names and ranges.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <regex>

#include "conformance/checks.hpp"
#include "conformance/law_block.hpp"
#include "core/units.hpp"

namespace kerf {

namespace {

/// What is wrong with a text; empty where nothing is.
std::string fault_of(const std::string& text) {
  static const std::regex unfinished("\\b(TODO|FIXME|XXX|TBD|tbd|todo)\\b");
  if (std::none_of(text.begin(), text.end(), [](unsigned char c) { return std::isalpha(c) != 0; })) return "is empty";
  if (std::regex_search(text, unfinished)) return "is unfinished";
  const std::string_view words = trimmed(text);
  if (words.find(' ') == std::string_view::npos) return "is a single word; say what it means in a sentence";
  return "";
}

bool is_snake_case(const std::string& name) {
  static const std::regex snake("[a-z][a-z0-9]*(_[a-z0-9]+)*");
  return std::regex_match(name, snake);
}
/// Parameters may be the letters of the literature, such as A, C10 and E0.
bool is_parameter_name(const std::string& name) {
  static const std::regex letters("[A-Z][A-Za-z]?[0-9]{0,2}");
  return is_snake_case(name) || std::regex_match(name, letters);
}

bool has_unit(const Parameter& p) {
  return p.kind == ValueKind::real || p.kind == ValueKind::vector || p.kind == ValueKind::reals;
}

void look_at_names_and_units(const Description& d, std::vector<std::string>& faults) {
  const auto unit = [&](const std::string& what, const std::string& text) {
    if (!unit_in_base(text))
      faults.push_back(
          fmt::format("the unit \"{}\" of {} is not known to UDUNITS, or begins at another zero; write "
                      "an SI unit, \"-\" for none",
                      text, what));
  };
  for (const Parameter& p : d.parameters) {
    if (!is_parameter_name(p.name)) faults.push_back(fmt::format("the parameter `{}` is not in snake_case", p.name));
    if (has_unit(p)) unit("the parameter `" + p.name + "`", p.unit);
  }
  for (const StateVariable& v : d.state) {
    if (!is_snake_case(v.name)) faults.push_back(fmt::format("the state variable `{}` is not in snake_case", v.name));
    unit("the state variable `" + v.name + "`", v.unit);
  }
}

/// The source of a type, if it can be read, names where its formulas are from: a year in brackets, or a DOI.
bool names_a_source(const Description& d, bool& can_be_read) {
  std::ifstream file(d.origin);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  can_be_read = !text.empty();
  static const std::regex reference("\\((1[89]|20)[0-9][0-9]\\)|doi|Sources?:");
  return std::regex_search(text, reference);
}

// ---- ranges

const char* const no_numbers[] = {"nan", ".nan", "inf", "-.inf"};

std::string number_text(double v) { return fmt::format("{:.17g}", v); }

/// Numbers just outside of a range.
std::vector<std::string> outside(const Range& r, bool whole) {
  std::vector<std::string> all;
  const auto add = [&](double bound, bool open, double sign) {
    if (!std::isfinite(bound)) return;
    const double step = whole ? 1.0 : std::max(1e-6 * std::fabs(bound), 1e-12);
    all.push_back(number_text(bound + sign * step));
    if (open) all.push_back(number_text(bound));
  };
  add(r.low, r.low_open, -1.0);
  add(r.high, r.high_open, 1.0);
  return all;
}

/// A value of the parameter in which one number is `bad`.
Node with_number(const Parameter& p, const std::string& bad, const Node* sample) {
  if (p.kind == ValueKind::real || p.kind == ValueKind::integer) return text_node(bad);
  Node list;
  list.kind = Node::Kind::list;
  const std::size_t n = p.kind == ValueKind::vector           ? 3
                        : sample && sample->items.size() > 1U ? sample->items.size()
                                                              : 1;
  for (std::size_t i = 0; i < n; ++i) list.items.push_back(text_node(i + 1 == n ? bad : "0"));
  return list;
}

bool is_number(ValueKind k) {
  return k == ValueKind::real || k == ValueKind::integer || k == ValueKind::vector || k == ValueKind::reals ||
         k == ValueKind::integers;
}

class RangeTest {
 public:
  RangeTest(const Registry& registry, const TypeSample& sample) : registry_(registry), sample_(sample) {}

  int tried = 0;
  std::vector<std::string> taken;  // "`A` = -1"
  std::vector<std::string> not_finite;  // "`A` = 0"
  std::vector<std::string> unlimited;

  void run(const Description& d) {
    for (const Parameter& p : d.parameters) {
      if (!is_number(p.kind)) continue;
      if (!std::isfinite(p.range.low) && !std::isfinite(p.range.high)) unlimited.push_back(p.name);
      const bool whole = p.kind == ValueKind::integer || p.kind == ValueKind::integers;
      for (const std::string& text : outside(p.range, whole)) expect_refusal(p, text);
      for (const char* text : no_numbers) expect_refusal(p, text);
      if (p.kind != ValueKind::real || !is_law_kind(sample_.kind)) continue;
      if (std::isfinite(p.range.low) && !p.range.low_open) expect_finite(p, p.range.low);
      if (std::isfinite(p.range.high) && !p.range.high_open) expect_finite(p, p.range.high);
    }
  }

 private:
  /// What stands in the range has to be computed, unless a rule refuses it.
  void expect_finite(const Parameter& p, double value) {
    TypeSample changed = sample_;
    set_entry(changed.parameters, p.name, text_node(number_text(value)));
    std::unique_ptr<SampleLaws> laws;
    try {
      laws = std::make_unique<SampleLaws>(registry_, changed);
    } catch (const InputError&) {
      return;
    }
    const LawPoints points(*laws->law, laws->material.density);
    std::mt19937 random(13);
    bool finite = true;
    for (int round = 0; round < 3; ++round) {
      LawBlock<double> block = points.random_block<double>(random);
      points.apply(block);
      block.each_row(block, [&](auto& row, auto&, const char*) {
        finite = finite && std::all_of(std::begin(row), std::end(row), [](double v) { return std::isfinite(v); });
      });
    }
    if (!finite) not_finite.push_back(fmt::format("`{}` = {:g}", p.name, value));
  }
  void expect_refusal(const Parameter& p, const std::string& text) {
    Node parameters = sample_.parameters;
    const Entry* given = sample_.parameters.find(p.name);
    set_entry(parameters, p.name, with_number(p, text, given ? &given->value : nullptr));
    ++tried;
    try {
      make_sample(registry_, sample_, parameters);
    } catch (const InputError&) {
      return;
    }
    taken.push_back(fmt::format("`{}` = {}", p.name, text));
  }

  const Registry& registry_;
  const TypeSample& sample_;
};

/// Variables that the law reads and that nobody in its material keeps.
std::vector<std::string> missing_reads(const SampleLaws& laws) {
  std::vector<std::string> missing;
  for (const ReadVariable& r : laws.law->reads()) {
    bool found = r.is_optional;
    for (const Law* other : laws.material.laws())
      for (const StateVariable& v : other->state_variables()) found = found || v.name == r.name;
    for (const StateVariable& v : laws.element->state_variables()) found = found || v.name == r.name;
    for (const char* field : {"pressure", "mass", "volume", "internal_energy", "viscous_energy"})
      found = found || r.name == field;
    if (!found) missing.push_back(r.name);
  }
  return missing;
}

}  // namespace

void check_documentation(const Description& d, Verdicts& out) {
  const char* check = "documentation";
  if (!out.wants(check)) return;
  std::vector<std::string> faults;
  const auto look = [&](const std::string& what, const std::string& text) {
    if (const std::string fault = fault_of(text); !fault.empty())
      faults.push_back(fmt::format("the text of {} {}", what, fault));
  };
  if (!is_snake_case(d.name)) faults.push_back(fmt::format("its name `{}` is not in snake_case", d.name));
  look("its summary", d.summary);
  for (const Parameter& p : d.parameters) look("the parameter `" + p.name + "`", p.doc);
  for (const StateVariable& v : d.state) look("the state variable `" + v.name + "`", v.doc);
  for (const ReadVariable& r : d.reads) look("what it reads, `" + r.name + "`,", r.doc);
  look_at_names_and_units(d, faults);
  if (!faults.empty()) {
    out.fail(check, fmt::format("{}; mend it in describe(): users read these texts in `kerf describe` and in error "
                                "messages",
                                fmt::join(faults, "; ")));
    return;
  }
  bool can_be_read = false;
  const bool source = names_a_source(d, can_be_read);
  out.pass(check, fmt::format("{} parameters and {} state variables have texts, units and names{}", d.parameters.size(),
                              d.state.size(),
                              source || !can_be_read || !is_law_kind(d.kind)
                                  ? ""
                                  : "; its source file names no paper: say in its first lines where the formulas are "
                                    "from"));
}

bool check_parameters(const Registry& registry, const TypeSample& sample, Verdicts& out) {
  try {
    make_sample(registry, sample, sample.parameters);
    if (is_law_kind(sample.kind)) {
      const SampleLaws laws(registry, sample);
      if (const auto missing = missing_reads(laws); !missing.empty()) {
        out.fail("sample", fmt::format("the law reads {}, which nobody in the material of its sample keeps; name the "
                                       "law that keeps it in `beside`",
                                       fmt::join(missing, ", ")));
        return false;
      }
    }
  } catch (const std::exception& e) {
    out.fail("sample", fmt::format("the sample is refused: {}; the sample, or a default or a rule of the type, is "
                                   "wrong",
                                   sentence_of(e)));
    return false;
  }
  out.pass("sample", "the sample is taken");
  if (!out.wants("ranges")) return true;
  RangeTest test(registry, sample);
  test.run(*registry.find(sample.kind, sample.name));
  if (!test.taken.empty())
    out.fail("ranges", fmt::format("taken although outside of the declared range: {}; give the parameter its range in "
                                   "describe()",
                                   fmt::join(test.taken, ", ")));
  else if (!test.not_finite.empty())
    out.fail("ranges", fmt::format("the law gives no finite numbers with {}, which the declared range allows; narrow "
                                   "the range, or write a rule",
                                   fmt::join(test.not_finite, ", ")));
  else if (!test.unlimited.empty())
    out.note("ranges", fmt::format("{} values outside of ranges, NaN and infinity are refused; any number is taken for "
                                   "{}: is that meant?",
                                   test.tried, fmt::join(test.unlimited, ", ")));
  else
    out.pass("ranges", fmt::format("{} values outside of ranges, NaN and infinity are refused", test.tried));
  return true;
}

}  // namespace kerf
