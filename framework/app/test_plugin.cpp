// `kerf test-plugin`: the conformance tests for the types of a plugin, or for those of Kerf itself.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "app/commands.hpp"
#include "conformance/conformance.hpp"
#include "core/activity.hpp"
#include "core/diagnostics.hpp"
#include "plugin/loader.hpp"

namespace kerf {

namespace {

using Type = std::pair<std::string, std::string>;

std::set<Type> types_of(const Registry& registry) {
  std::set<Type> all;
  for (const std::string& kind : registry.kinds())
    for (const std::string& name : registry.names(kind)) all.emplace(kind, name);
  return all;
}

/// The types that are wanted: those of `all`, or the one that --only names.
std::vector<Type> chosen(const std::set<Type>& all, const std::string& only) {
  std::vector<Type> types;
  std::vector<std::string> names;
  for (const auto& [kind, name] : all) {
    names.push_back(kind + "." + name);
    if (only.empty() || only == names.back() || only == kind) types.emplace_back(kind, name);
  }
  if (!types.empty()) return types;
  const std::string near = nearest_name(only, names);
  throw InputError({fmt::format("--only {}: error: no such type is tested; expected KIND.NAME or KIND{}", only,
                                near.empty() ? "" : ", for example " + near)});
}

void expect_known(const std::vector<std::string>& checks) {
  const std::vector<std::string>& all = conformance_checks();
  for (const std::string& check : checks)
    if (std::find(all.begin(), all.end(), check) == all.end())
      throw InputError(
          {fmt::format("--check {}: error: there is no such check; expected one of {}", check, fmt::join(all, ", "))});
}

}  // namespace

int test_plugin_command(const TestPluginOptions& o, Registry& registry) {
  if (o.builtin != o.library.empty())
    throw InputError({"test-plugin: error: expected either a library or --builtin, which tests the types of Kerf"});
  expect_known(o.checks);
  const std::set<Type> before = types_of(registry);
  std::set<Type> tested = before;
  if (!o.builtin) {
    Diagnostics diagnostics;
    load_plugin(o.library, registry, diagnostics);
    diagnostics.throw_if_errors();
    tested.clear();
    for (const Type& type : types_of(registry))
      if (!before.contains(type)) tested.insert(type);
    if (tested.empty()) throw InputError({fmt::format("{}: error: the plugin registers no type", o.library)});
  }
  ConformanceOptions options;
  options.types = chosen(tested, o.only);
  options.checks = o.checks;
  options.library = o.library;
  const Samples samples = o.samples.empty() ? Samples() : Samples(o.samples, registry);
  print_warnings(samples.warnings());
  const activity::Task task("testing a plugin", {activity::default_limit, "of a check", exit_other});
  const Verdicts verdicts = test_types(registry, samples, options);
  fmt::print("{}", table_of(verdicts.rows()));
  return verdicts.all_pass() ? exit_done : exit_other;
}

}  // namespace kerf
