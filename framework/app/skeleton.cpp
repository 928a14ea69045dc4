// Writes declarations as C++: parameters, state, reads, and the head of the function that is to be translated.
#include "app/skeleton.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "input/parameter_text.hpp"
#include "kerf/eos.hpp"
#include "kerf/erosion.hpp"
#include "kerf/law.hpp"

namespace kerf {

namespace {

/// What differs between the kinds.
struct KindText {
  const char *kind, *header, *base, *macro, *input, *function;
  const char* result;  // type of what the function returns
  const char* arguments;  // behind input and reads
};

constexpr KindText kinds[] = {
    {"material", "material", "PointwiseMaterial", "KERF_MATERIAL", "PointInput", "update_point", "void",
     "SymTensor& /*deviator*/, State& /*state*/, double& /*modulus*/"},
    {"solid", "solid", "PointwiseSolid", "KERF_SOLID", "SolidInput", "update_point", "void",
     "SymTensor& /*stress*/, State& /*state*/, SolidModuli& /*moduli*/"},
    {"eos", "eos", "PointwiseEos", "KERF_EOS", "EosInput", "evaluate_point", "EosOutput", "State& /*state*/"},
    {"erosion", "erosion", "PointwiseErosion", "KERF_EROSION", "ErosionInput", "judge_point", "Verdict",
     "State& /*state*/"}};

const KindText& text_of(const std::string& kind) {
  for (const KindText& k : kinds)
    if (kind == k.kind) return k;
  throw std::runtime_error(
      fmt::format("a {} cannot be written in Python; expected material, solid, eos or erosion", kind));
}

std::string number_text(double v) {
  if (std::isinf(v)) return fmt::format("{}std::numeric_limits<double>::infinity()", v < 0.0 ? "-" : "");
  return fmt::format("{}", v);
}

std::string range_code(const Range& r) {
  const auto same = [&](const Range& known) {
    return r.low == known.low && r.high == known.high && r.low_open == known.low_open && r.high_open == known.high_open;
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (std::isinf(r.low) && std::isinf(r.high)) return "any_value";
  if (same(fraction)) return "fraction";
  if (r.low == 0.0 && r.high == infinity) return r.low_open ? "positive" : "non_negative";
  return fmt::format("Range{{{}, {}, {}, {}}}", number_text(r.low), number_text(r.high), r.low_open, r.high_open);
}

std::string quoted(const std::string& text) {
  std::string all = "\"";
  for (const char c : text) all += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
  return all + "\"";
}

/// Whether a criterion of any kind has the key.
bool is_common(const std::string& kind, const Parameter& p) {
  return kind == "erosion" && (p.name == "check_interval" || p.name == "then");
}

std::string tensor_name(const StateVariable& first) { return first.name.substr(0, first.name.size() - 3); }

std::string members(const Description& d) {
  std::string text;
  for (const Parameter& p : d.parameters)
    if (!is_common(d.kind, p)) text += fmt::format("  double {} = 0.0;  // [{}]\n", p.name, p.unit);
  return text;
}

std::string state_struct(const Description& d) {
  if (d.state.empty()) return "  using State = NoVariables;\n";
  std::string text = "  struct State {\n";
  for (std::size_t v = 0; v < d.state.size(); v += d.state[v].begins_tensor ? 6 : 1)
    text += d.state[v].begins_tensor ? fmt::format("    SymTensor {};\n", tensor_name(d.state[v]))
                                     : fmt::format("    double {};\n", d.state[v].name);
  return text + "  };\n";
}

std::string reads_struct(const Description& d) {
  if (d.reads.empty()) return d.kind == "erosion" ? "  using Reads = NoVariables;\n" : "";
  std::string text = "  struct Reads {\n";
  for (const ReadVariable& r : d.reads) text += fmt::format("    double {};\n", r.name);
  return text + "  };\n";
}

std::string describe_function(const Description& d, const std::string& type) {
  std::string text = fmt::format("  static void describe(Schema<{}>& s) {{\n", type);
  for (const Parameter& p : d.parameters) {
    if (is_common(d.kind, p)) continue;
    text += fmt::format("    s.real(&{}::{}, \"{}\", \"{}\", {}, {})", type, p.name, p.name, p.unit,
                        range_code(p.range), quoted(p.doc));
    text += p.required ? ";\n" : fmt::format(".by_default({});\n", quoted(p.default_text));
  }
  for (std::size_t v = 0; v < d.state.size(); v += d.state[v].begins_tensor ? 6 : 1) {
    const StateVariable& s = d.state[v];
    if (s.begins_tensor)
      text += fmt::format("    s.state(&State::{0}, \"{0}\", \"{1}\", {2});\n", tensor_name(s), s.unit, quoted(s.doc));
    else
      text += fmt::format("    s.state(&State::{0}, \"{0}\", \"{1}\", {2}, {3});\n", s.name, s.unit,
                          number_text(s.initial), quoted(s.doc));
  }
  for (const ReadVariable& r : d.reads) {
    text += fmt::format("    s.reads(&Reads::{0}, \"{0}\", {1})", r.name, quoted(r.doc));
    text += r.is_optional ? fmt::format(".by_default({});\n", number_text(r.value)) : ";\n";
  }
  if (d.kind == "erosion") text += "    describe_interval(s);\n";
  return text + "  }\n";
}

std::string inputs_line(unsigned asked) {
  std::vector<std::string> names;
  for (const auto& [bit, name] : {std::pair{with_length, "with_length"},
                                  {with_initial_length, "with_initial_length"},
                                  {with_reference_position, "with_reference_position"},
                                  {with_rotation, "with_rotation"}})
    if ((asked & bit) != 0) names.push_back(name);
  if (names.empty()) return "";
  return fmt::format("  static constexpr unsigned inputs = {};\n", fmt::join(names, " | "));
}

std::string function(const Description& d, const KindText& k, bool asks, const std::string& name) {
  const std::string input = asks                  ? fmt::format("{}With<inputs>", k.input)
                            : d.kind == "erosion" ? std::string("ErosionInputPoint")
                                                  : std::string(k.input);
  const bool has_reads = !d.reads.empty() || d.kind == "erosion";
  return fmt::format(
      "  {} {}(const {}& /*in*/, {}{}) const {{\n"
      "    throw std::runtime_error(\"{}: {} is not written yet; the Python at the end of its file says what it "
      "does\");\n"
      "  }}\n",
      k.result, k.function, input, has_reads ? "const Reads& /*reads*/, " : "", k.arguments, name, k.function);
}

std::string source_text(const Description& d, const Law& law, const std::string& name, const std::string& type,
                        const std::string& python) {
  const KindText& k = text_of(d.kind);
  const auto* eos = dynamic_cast<const Eos*>(&law);
  const auto* criterion = dynamic_cast<const ErosionCriterion*>(&law);
  std::string text = fmt::format(
      "// {}. It was tried in Python, which stands at the end of this file.\n//\n"
      "// Source: the author, title and year of where the equations come from.\n"
      "#include <kerf/{}.hpp>\n\n#include <limits>\n#include <stdexcept>\n\nnamespace {{\n\nusing namespace kerf;\n\n"
      "/// {}\nstruct {} final : {}<{}> {{\n",
      d.summary, k.header, d.summary, type, k.base, type);
  text += members(d) + inputs_line(law.asked_inputs());
  if (criterion && criterion->softens()) text += "  static constexpr bool can_soften = true;\n";
  text += "\n" + state_struct(d) + reads_struct(d) + "\n" + describe_function(d, type);
  if (eos && !eos->uses_energy()) text += "  bool uses_energy() const override { return false; }\n";
  text += "\n" + function(d, k, law.asked_inputs() != 0, name) + "};\n\n}  // namespace\n\n";
  text += fmt::format("{}({}, \"{}\", {})\n\n// ---- The Python\n//\n", k.macro, type, name, quoted(d.summary));
  std::istringstream lines(python);
  for (std::string line; std::getline(lines, line);) text += line.empty() ? "//\n" : "// " + line + "\n";
  return text;
}

std::string page_text(const Description& d, const std::string& name) {
  std::string text = fmt::format(
      "# {}\n\n{}.\n\n## Equations\n\nTo be written.\n\n## Parameters\n\n| name | unit | range | meaning "
      "|\n|---|---|---|---|\n",
      name, d.summary);
  for (const Parameter& p : d.parameters)
    text += fmt::format("| `{}` | {} | {} | {}{} |\n", p.name, p.unit, range_text(p.range, p.unit), p.doc,
                        p.required || p.default_text.empty() ? "" : ", by default " + p.default_text);
  if (!d.state.empty()) text += "\n## State\n\n| name | unit | meaning |\n|---|---|---|\n";
  for (const StateVariable& v : d.state) text += fmt::format("| `{}` | {} | {} |\n", v.name, v.unit, v.doc);
  if (!d.reads.empty()) text += "\n## Reads\n\n";
  for (const ReadVariable& r : d.reads) text += fmt::format("- `{}`: {}\n", r.name, r.doc);
  return text + "\n## Restrictions\n\nTo be written.\n\n## References\n\nTo be written.\n";
}

std::string samples_text(const Description& d, const std::string& name) {
  std::string keys;
  for (const Parameter& p : d.parameters)
    if (p.required) keys += fmt::format("    {}:   # {}\n", p.name, expectation(p));
  return fmt::format("# A valid sample of the law, for `kerf test-plugin`: give every key a value.\n{}:\n  {}:{}\n{}",
                     d.kind, name, keys.empty() ? " {}" : "", keys);
}

}  // namespace

Skeleton skeleton_of(const Registry& laws, const std::string& kind, const std::string& name, const std::string& type,
                     const std::string& python) {
  text_of(kind);
  const std::vector<std::string> names = laws.names(kind);
  std::string chosen = names.size() == 1 ? names.front() : name;
  if (names.empty()) throw std::runtime_error(fmt::format("the file has no law of the kind {}; expected one", kind));
  const Description* d = laws.find(kind, chosen);
  if (d == nullptr)
    throw std::runtime_error(
        fmt::format("the file has several laws of the kind {}, none of them called {}; expected one of "
                    "{} as the name",
                    kind, name, listed(names, " or ")));
  const Made made = laws.make(kind, chosen);
  const auto* law = dynamic_cast<const Law*>(made.plugin.get());
  return {source_text(*d, *law, name, type, python), page_text(*d, name), samples_text(*d, name)};
}

}  // namespace kerf
