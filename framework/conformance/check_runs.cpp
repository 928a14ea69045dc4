// Whole runs: the same bits on any number of ranks, with elements that move between them, and after a restart.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>

#include "conformance/checks.hpp"
#include "conformance/child_run.hpp"
#include "output/hdf5_file.hpp"

namespace kerf {

namespace {

constexpr int cycles = 30;

/// Tables of observers that two runs do not have in common.
std::string different_tables(const ChildRun& a, const ChildRun& b) {
  const auto tables = [](const ChildRun& r) {
    const std::string path = r.folder + "/history.h5";
    return std::filesystem::exists(path) ? hdf5::entries_of_file(path)
                                         : std::map<std::string, std::vector<std::byte>>();
  };
  const auto mine = tables(a), theirs = tables(b);
  std::vector<std::string> names;
  for (const auto& [name, entries] : mine)
    if (const auto found = theirs.find(name); found == theirs.end() || found->second != entries) names.push_back(name);
  if (mine.size() != theirs.size()) names.emplace_back("their number of tables");
  return names.empty() ? "" : fmt::format("history.h5 ({})", fmt::join(names, ", "));
}

/// What two runs do not have in common.
std::string difference_of(const ChildRun& a, const ChildRun& b) {
  std::vector<std::string> keys;
  for (const char* key : {"cycles", "state_hash", "energy", "eroded", "momentum", "mass", "parts", "measures",
                          "not_measured", "observers"}) {
    const auto of = [&](const ChildRun& r) {
      return r.summary.is_object() ? r.summary.value(key, nlohmann::json()) : nlohmann::json();
    };
    if (of(a) != of(b)) keys.emplace_back(key);
  }
  return fmt::format("{}", fmt::join(keys, ", "));
}

/// What runs of one input on several ranks and after a restart have shown; empty texts where all is well.
struct RunFindings {
  std::string failed;  // a run that did not end well
  std::string migration, restart;
  std::int64_t moved = 0, eroded = 0, n_cycles = 0;
  double imbalance = 0.0;  // greatest after a re-balancing
};

void look_at_balance(const ChildRun& run, RunFindings& f) {
  for (const auto& r : run.summary.value("rebalances", nlohmann::json::array())) {
    f.moved += r.value("elements_moved", std::int64_t{0});
    f.imbalance = std::max(f.imbalance, r.value("imbalance_after", 0.0));
  }
}

RunFindings run_input(const std::string& input, const RunPlace& place, const std::string& name,
                      const std::vector<std::string>& settings) {
  RunFindings f;
  const auto go = [&](const std::string& folder, std::vector<std::string> words) {
    for (const std::string& s : settings) words.insert(words.end(), {"--set", s});
    for (const std::string& p : place.plugins) words.insert(words.end(), {"--plugin", p});
    const ChildRun run = run_child(input, place.folder + "/" + name + "_" + folder, words);
    if (run.code != 0 && f.failed.empty())
      f.failed = fmt::format("`kerf run {}` ends with exit code {}: {}", fmt::join(words, " "), run.code, run.errors);
    return run;
  };
  const ChildRun whole = go("one", {"--ranks", "1"});
  if (!f.failed.empty()) return f;
  f.n_cycles = whole.summary.value("cycles", std::int64_t{0});
  f.eroded = whole.summary["eroded"].value("elements", std::int64_t{0});
  // The run on three ranks writes one restart file on its way, from which two ranks go on.
  const double on_the_way = 0.55 * whole.summary.value("end_time", 0.0);
  const std::vector<std::string> with_restart = {"--set", fmt::format("output.restart_interval={:.17g} s", on_the_way),
                                                 "--set", "output.restart_at_end=false"};
  const auto on = [&](const char* ranks) {
    std::vector<std::string> words = {"--ranks", ranks};
    words.insert(words.end(), with_restart.begin(), with_restart.end());
    return words;
  };
  for (const char* ranks : {"2", "3"}) {
    const ChildRun other = go(ranks, on(ranks));
    if (!f.failed.empty()) return f;
    look_at_balance(other, f);
    std::string d = difference_of(whole, other);
    if (d.empty()) d = different_tables(whole, other);
    if (!d.empty() && f.migration.empty())
      f.migration = fmt::format(
          "a run on {} ranks, between which elements move every few cycles, and one on a single "
          "rank differ in {}",
          ranks, d);
  }
  std::vector<std::string> words = on("2");
  words.emplace_back("--resume");
  const ChildRun resumed = go("3", words);
  if (!f.failed.empty()) return f;
  std::string d = difference_of(whole, resumed);
  if (d.empty()) d = different_tables(whole, resumed);
  if (!d.empty())
    f.restart = fmt::format(
        "a run that 2 ranks take up half-way from the restart file of 3, and one that goes through "
        "differ in {}",
        d);
  return f;
}

void tell(const RunFindings& f, Verdicts& out) {
  if (!f.failed.empty()) {
    out.fail("migration", f.failed + "; the sample, or the law in it, does not run");
    return;
  }
  if (f.migration.empty())
    out.pass("migration", fmt::format("1, 2 and 3 ranks give the same bits in {} cycles; {} elements moved, {} eroded",
                                      f.n_cycles, f.moved, f.eroded));
  else
    out.fail("migration", f.migration +
                              "; all that an element remembers has to be declared, sums over elements have "
                              "to be those of the framework, and ties broken by global number");
  if (f.restart.empty())
    out.pass("run_restart", "taken up half-way by another number of ranks: the same bits");
  else
    out.fail("run_restart", f.restart +
                                "; what is kept has to be declared as state, or handed out by state() and "
                                "taken back by restore()");
}

// ---- inputs made of samples

Node number_list(std::initializer_list<double> values, const char* unit) {
  return text_node(fmt::format("[{}] {}", fmt::join(values, ", "), unit));
}

Node start_of_model() {
  // Elements move between ranks often, whether or not that pays. Samples are no engineering: an explosive may well send
  // parts flying.
  return tree_of(
      fmt::format("{{time: {{end: 1 ms, maximum_cycles: {}}}, balance: {{force_interval: 7}}, "
                  "checks: {{energy_growth: 1.0e6, let_go: 1.0}}}}",
                  cycles));
}

Node bar(const std::string& material, const std::string& velocity, double x, double y, int rows) {
  Node part;
  set_entry(part, "material", text_node(material));
  if (!velocity.empty()) set_entry(part, "velocity", text_node(velocity));
  Node mesh = tree_of(fmt::format("{{type: block, cells: [4, {}, 2]}}", rows));
  set_entry(mesh, "origin", number_list({x, y, 0.0}, "mm"));
  set_entry(mesh, "size", number_list({4.0, static_cast<double>(rows), 2.0}, "mm"));
  set_entry(part, "mesh", mesh);
  return part;
}

/// For every law a short bar that hits another one, sideways a little, so that elements are sheared and turned, too.
/// Laws that have a place of their own, such as detonators, come first, near the origin.
Node impacts_of_laws(std::vector<const TypeSample*> samples) {
  std::stable_partition(samples.begin(), samples.end(), [](const TypeSample* s) {
    return yaml_text(s->parameters).find("point") != std::string::npos;
  });
  Node model = start_of_model(), materials, parts;
  double y = 0.0;
  for (const TypeSample* s : samples) {
    const std::string name = s->kind + "_" + s->name;
    set_entry(materials, name, material_of(*s));
    set_entry(parts, name + "_flyer", bar(name, s->settings.velocity, 0.0, y, 2));
    set_entry(parts, name + "_target", bar(name, "", 4.0, y, 3));
    y += 20.0;
  }
  set_entry(model, "materials", materials);
  set_entry(model, "parts", parts);
  set_entry(model, "contacts", tree_of("[{type: eroding_surface}]"));
  return model;
}

constexpr const char* metal =
    "{density: 7850, strength: {type: elastic_plastic, shear_modulus: 80 GPa, yield_stress: 400 MPa, "
    "hardening_modulus: 500 MPa}, eos: {type: linear, bulk_modulus: 160 GPa}}";

Node model_of_metal(const Node& parts) {
  Node model = start_of_model(), materials;
  set_entry(materials, "metal", tree_of(metal));
  set_entry(model, "materials", materials);
  set_entry(model, "parts", parts);
  set_entry(model, "contacts", tree_of("[{type: eroding_surface}]"));
  return model;
}

/// Two bars that meet, shared out by the partitioner of the sample, or whenever its policy says so.
Node model_of_balance(const TypeSample& s) {
  Node parts;
  set_entry(parts, "flyer", bar("metal", s.settings.velocity, 0.0, 0.0, 4));
  set_entry(parts, "target", bar("metal", "", 4.0, 0.0, 6));
  Node model = model_of_metal(parts), partitioner = s.parameters;
  set_entry(partitioner, "type", text_node(s.name));
  if (s.kind == "balance_policy") set_entry(model, "balance", tree_of("{}"));
  set_entry(model.find("balance")->value, s.kind == "partitioner" ? "partitioner" : "policy", partitioner);
  return model;
}

/// A body of the elements of the sample, on the mesh that stands beside it, against a wall at its least x.
Node model_of_element(const Registry& registry, const TypeSample& s) {
  Node element = s.parameters, part;
  set_entry(element, "type", text_node(s.name));
  set_entry(part, "material", text_node("metal"));
  set_entry(part, "element", element);
  set_entry(part, "velocity", text_node("-200 60 0 m/s"));
  set_entry(part, "mesh", tree_of("{type: block, size: 4 3 2 mm, cells: [4, 3, 2]}"));
  for (const Entry& e : s.beside.entries) set_entry(part, e.key, e.value);
  TypeSample mesh;
  mesh.kind = "mesh";
  mesh.parameters = part.find("mesh")->value;
  const Entry* type = mesh.parameters.find("type");
  mesh.name = type ? type->value.text : "";
  if (!registry.find("mesh", mesh.name)) throw std::runtime_error("there is no mesh of type \"" + mesh.name + "\"");
  std::erase_if(mesh.parameters.entries, [](const Entry& e) { return e.key == "type"; });
  const auto made = make_sample(registry, mesh, mesh.parameters);
  auto& generator = dynamic_cast<MeshGenerator&>(*made);
  if (const auto faults = generator.prepare(); !faults.empty()) throw std::runtime_error(faults.front());
  double least = std::numeric_limits<double>::infinity();
  for (std::int64_t i = 0; i < generator.n_nodes(); ++i) least = std::min(least, generator.node(i).x);
  Node parts;
  set_entry(parts, "body", part);
  Node model = model_of_metal(parts);
  set_entry(model, "boundaries",
            tree_of(fmt::format("[{{type: rigid_wall, point: '[{:.17g}, 0, 0] m', normal: [1, 0, 0]}}]", least)));
  return model;
}

std::string write_model(const Node& model, const RunPlace& place, const std::string& name) {
  const std::string path = place.folder + "/" + name + ".yaml";
  std::ofstream file(path);
  file << yaml_text(model);
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path);
  return path;
}

void run_laws(const std::vector<const TypeSample*>& laws, const RunPlace& place, Verdicts& out) {
  if (laws.empty()) return;
  // All in one model, which is quick; where something differs, one after the other, to name the law.
  RunFindings together;
  if (laws.size() > 1) together = run_input(write_model(impacts_of_laws(laws), place, "laws"), place, "laws", {});
  const bool good =
      laws.size() > 1 && together.failed.empty() && together.migration.empty() && together.restart.empty();
  for (const TypeSample* s : laws) {
    out.begin(s->type());
    if (good) {
      out.pass("migration", fmt::format("in a model with {} laws, 1, 2 and 3 ranks give the same bits; {} elements "
                                        "moved, {} eroded",
                                        laws.size(), together.moved, together.eroded));
      out.pass("run_restart", "taken up half-way by another number of ranks: the same bits");
      continue;
    }
    const std::string name = s->kind + "_" + s->name;
    tell(run_input(write_model(impacts_of_laws({s}), place, name), place, name, {}), out);
  }
}

/// The greatest work of a rank over the mean: elements cannot be divided, and a third of the 80 of this model is 27.
constexpr double most_imbalance = 1.5;

}  // namespace

void check_runs(const Registry& registry, const std::vector<const TypeSample*>& samples, const RunPlace& place,
                Verdicts& out) {
  if (!out.wants("migration") && !out.wants("run_restart") && !out.wants("balance")) return;
  std::vector<const TypeSample*> laws;
  for (const TypeSample* s : samples)
    if (is_law_kind(s->kind)) laws.push_back(s);
  run_laws(laws, place, out);
  for (const TypeSample* s : samples) {
    if (s->kind != "partitioner" && s->kind != "balance_policy" && s->kind != "element") continue;
    out.begin(s->type());
    try {
      const bool shares = s->kind == "partitioner";
      const Node model = s->kind == "element" ? model_of_element(registry, *s) : model_of_balance(*s);
      const std::string name = s->kind + "_" + s->name;
      const RunFindings f = run_input(write_model(model, place, name), place, name, {});
      tell(f, out);
      if (!shares || !f.failed.empty()) continue;
      if (f.imbalance <= most_imbalance)
        out.pass("balance", fmt::format("every rank gets work, the busiest {:.2f} times the mean", f.imbalance));
      else
        out.fail("balance", fmt::format("the busiest of 2 or 3 ranks has {:.2f} times the mean work, expected at most "
                                        "{:.2f}; share out `weights` alike",
                                        f.imbalance, most_imbalance));
    } catch (const std::exception& e) {
      out.fail("migration", fmt::format("no model can be made of the sample: {}", sentence_of(e)));
    }
  }
}

void check_input(const std::vector<std::string>& types, const std::string& input, const RunPlace& place,
                 Verdicts& out) {
  if (!out.wants("migration") && !out.wants("run_restart") && !out.wants("balance")) return;
  std::string name = std::filesystem::path(input).stem().string();
  const RunFindings f = run_input(input, place, "input_" + name, {"balance.force_interval=7"});
  for (const std::string& type : types) {
    out.begin(type);
    tell(f, out);
  }
}

}  // namespace kerf
