// The file of a work model: its keys, and the factors that follow from its seconds.
#include "input/work_model_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "input/binder.hpp"
#include "input/model_input.hpp"
#include "input/parameter_text.hpp"
#include "input/yaml_reader.hpp"

namespace kerf {

namespace {

/// Seconds of a type of element or law.
struct TypeSeconds {
  std::string name;
  double seconds = 0.0;
  static void describe(Schema<TypeSeconds>& s) {
    s.real(&TypeSeconds::seconds, "seconds", "s", non_negative, "of one element in one cycle");
  }
};

struct ContactSeconds {
  double node = 0.0, candidate = 0.0;
  double touch = 0.0;  // told beside the others; candidates contain it
  static void describe(Schema<ContactSeconds>& s) {
    s.real(&ContactSeconds::node, "node", "s", non_negative, "search, of a surface node in one cycle");
    s.real(&ContactSeconds::candidate, "candidate", "s", non_negative,
           "forces, of a pair of a node and a facet in one cycle");
    s.real(&ContactSeconds::touch, "touch", "s", non_negative,
           "forces, of a pair that touches; not used, since candidates contain it")
        .by_default("0 s");
  }
};

struct MoveSeconds {
  double fixed = 0.0, element = 0.0, moved_element = 0.0;
  static void describe(Schema<MoveSeconds>& s) {
    s.real(&MoveSeconds::fixed, "fixed", "s", non_negative, "of a re-balance, whatever moves");
    s.real(&MoveSeconds::element, "element", "s", non_negative,
           "of a re-balance, for each element of a rank, whether or not it moves");
    s.real(&MoveSeconds::moved_element, "moved_element", "s", non_negative, "for each element that leaves a rank");
  }
};

struct WorkFile {
  using Types = std::vector<std::unique_ptr<TypeSeconds>>;
  std::int64_t format = 0;
  std::string kerf_version, machine, date;
  double element_cycle = 0.0, other_element = 0.0, other_law = 0.0, other_eos = 0.0, erosion = 0.0,
         eroded_element = 0.0;
  Types elements, laws, eos;
  ContactSeconds contact;
  MoveSeconds rebalance;

  static void describe(Schema<WorkFile>& s) {
    s.integer(&WorkFile::format, "format", Range{1.0, 1.0, false, false}, "of this file: 1");
    s.text(&WorkFile::kerf_version, "kerf_version", "the program that was measured");
    s.text(&WorkFile::machine, "machine", "where it was measured");
    s.text(&WorkFile::date, "date", "when it was measured");
    s.real(&WorkFile::element_cycle, "element_cycle", "s", positive,
           "of a hex8 with elastic_plastic and linear: the unit of work");
    s.real(&WorkFile::other_element, "other_element", "s", positive,
           "of an element that is not listed, without its laws, times the cost that it declares");
    s.real(&WorkFile::other_law, "other_law", "s", non_negative,
           "of a strength or solid that is not listed, times the cost that it declares");
    s.real(&WorkFile::other_eos, "other_eos", "s", non_negative,
           "of an equation of state that is not listed, times the cost that it declares");
    s.real(&WorkFile::erosion, "erosion", "s", non_negative, "of an element whose material has erosion criteria");
    s.real(&WorkFile::eroded_element, "eroded_element", "s", non_negative, "of an element that is eroded, once");
    s.block_map(&WorkFile::elements, "elements", "elements without their laws, by type").optional();
    s.block_map(&WorkFile::laws, "laws", "strengths and solids, by type").optional();
    s.block_map(&WorkFile::eos, "eos", "equations of state, by type").optional();
    s.block(&WorkFile::contact, "contact", "work of contact");
    s.block(&WorkFile::rebalance, "rebalance", "work of a re-balance");
  }
};

/// Factors of types from their seconds. A type that does not exist is a mistake: its number would serve nobody.
std::map<std::string, double> factors(const WorkFile::Types& types, const std::string& path,
                                      const std::vector<std::string>& known, double unit, const OriginMap& origins,
                                      Diagnostics& diagnostics) {
  std::map<std::string, double> all;
  for (const auto& t : types) {
    if (std::find(known.begin(), known.end(), t->name) == known.end())
      diagnostics.error(origins.find(path + "." + t->name),
                        fmt::format("there is no type `{}`{}", t->name, suggestion(t->name, known, "the types")));
    all[t->name] = t->seconds / unit;
  }
  return all;
}

}  // namespace

WorkModel read_work_model(const std::string& path, const Origin& where, const FileReader& read,
                          const Registry& registry, Diagnostics& diagnostics) {
  WorkModel model;
  std::string failure;
  const std::string text = read(path, failure);
  if (!failure.empty()) {
    diagnostics.error(where, fmt::format("the file \"{}\" cannot be read: {}; expected a work model of `kerf bench "
                                         "--calibrate`, named relative to the input file",
                                         path, failure));
    return model;
  }
  const std::size_t errors_before = diagnostics.errors().size();
  const std::optional<Node> root = read_yaml(path, text, diagnostics);
  if (!root) return model;
  const Origin top{std::make_shared<const std::string>(path), 1, 1};
  OriginMap origins;
  origins.add("", top);
  WorkFile file;
  Binder(registry, diagnostics, origins).bind_block(Schema<WorkFile>::described<WorkFile>(), *root, &file, "", top);
  if (diagnostics.errors().size() != errors_before) return model;
  const double unit = file.element_cycle;
  std::vector<std::string> laws = registry.names("material");
  for (const std::string& solid : registry.names("solid")) laws.push_back(solid);
  model.elements = factors(file.elements, "elements", registry.names("element"), unit, origins, diagnostics);
  model.laws = factors(file.laws, "laws", laws, unit, origins, diagnostics);
  model.eos = factors(file.eos, "eos", registry.names("eos"), unit, origins, diagnostics);
  model.other_element = file.other_element / unit;
  model.other_law = file.other_law / unit;
  model.other_eos = file.other_eos / unit;
  model.erosion = file.erosion / unit;
  model.eroded_element = file.eroded_element / unit;
  model.contact_node = file.contact.node / unit;
  model.contact_candidate = file.contact.candidate / unit;
  model.move = {file.rebalance.fixed / unit, file.rebalance.element / unit, file.rebalance.moved_element / unit};
  model.element_cycle = unit;
  return model;
}

}  // namespace kerf
