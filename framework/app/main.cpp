// The command line: what can be typed, and which command it calls.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <exception>

#include "app/commands.hpp"
#include "app/load_input.hpp"
#include "core/diagnostics.hpp"
#include "plugin/crash_report.hpp"
#include "plugin/loader.hpp"
#include "plugin/registry.hpp"
#include "plugin/stall_watch.hpp"

namespace kerf {
namespace {

struct Arguments {
  RunOptions run;
  PartitionOptions partition;
  TestPluginOptions test;
  std::string kind, name, folder, python, mesh_file;
  std::vector<std::string> names;
  bool markdown = false, only_check = false;
};

// One value per option: the default, as many as follow, would swallow the input file.
void add_repeatable(CLI::App& command, const std::string& name, std::vector<std::string>& values,
                    const std::string& placeholder, const std::string& doc) {
  command.add_option(name, values, doc)->allow_extra_args(false)->type_name(placeholder);
}

CLI::App* add_command(CLI::App& app, Arguments& a, const std::string& name, const std::string& doc) {
  CLI::App* command = app.add_subcommand(name, doc);
  add_repeatable(*command, "--plugin", a.run.plugins, "LIB", "load a plugin from a shared library; may be repeated");
  return command;
}

void add_file(CLI::App& command, Arguments& a, const std::string& doc) {
  command.add_option("INPUT", a.run.input, doc)->required()->type_name("");
  add_repeatable(command, "--set", a.run.overrides, "KEY.PATH=VALUE", "replace a value of the input; may be repeated");
  command.add_option("--output", a.run.output, "folder for the results")->type_name("DIR");
}

void add_deck_options(CLI::App& command, Arguments& a) {
  command.add_option("--units", a.run.units, "units of a keyword deck: mass, length and time, or an alias as g-cm-us")
      ->type_name("M,L,T");
  command.add_option("--case", a.run.case_number, "case of a keyword deck that has *CASE")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  command.add_flag("--without-unsupported", a.run.without_unsupported,
                   "leave out what a keyword deck asks for and Kerf does not do");
  command.add_flag("--strict", a.run.strict, "refuse a keyword deck of which anything would be done in another way");
}

void add_input(CLI::App& command, Arguments& a) {
  add_file(command, a, "input file, or a keyword deck");
  add_deck_options(command, a);
  command.add_option("--ranks", a.run.ranks, "number of MPI ranks")
      ->type_name("N")
      ->check(
          [](const std::string& text) {
            int n = 0;
            const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), n);
            const bool good = status == std::errc() && end == text.data() + text.size() && n > 0;
            return good ? std::string() : "\"" + text + "\" is no number of ranks; expected a whole number from 1 on";
          },
          "");
}

void add_partition(CLI::App& app, Arguments& a) {
  CLI::App* partition = add_command(app, a, "partition", "divide the elements of a model, and measure the divisions");
  add_input(*partition, a);
  partition->add_option("--parts", a.partition.parts, "numbers of parts, for example 2,4,8")
      ->required()
      ->type_name("N,...");
  add_repeatable(*partition, "--method", a.partition.methods, "NAME,...",
                 "partitioners, all, or NAME={type: ...} for one with parameters; may be repeated; by default all");
  partition->add_option("--results", a.partition.results, "folder of a run of the input, whose frames are divided")
      ->type_name("DIR");
  partition->add_option("--frame", a.partition.frames, "frames of the results, for example 0,10,last; by default last")
      ->type_name("N,...");
  partition->add_flag("--no-mesh", a.partition.no_mesh, "write no mesh for pictures and ParaView");
}

void add_commands(CLI::App& app, Arguments& a) {
  CLI::App* run = add_command(app, a, "run", "run an input file");
  add_input(*run, a);
  run->add_flag("--resume", a.run.resume, "continue from the last restart file in the output folder");
  add_input(*add_command(app, a, "check", "check an input file without running it"), a);
  CLI::App* convert = add_command(app, a, "convert", "write a keyword deck, or a mesh, as case.yaml and mesh.h5");
  add_file(*convert, a, "keyword deck, or a file of Gmsh, Abaqus or Exodus");
  add_deck_options(*convert, a);
  add_partition(app, a);
  CLI::App* drive = add_command(app, a, "drive", "take laws along paths of deformation, one element at a time");
  add_file(*drive, a, "drive file");
  drive->add_flag("--check", a.only_check, "compare with the references of the file only, and write nothing");
  CLI::App* mesh = add_command(app, a, "mesh", "show what is in the file of a mesh, and write it in Kerf's own form");
  mesh->add_option("FILE", a.run.input, "file of Gmsh, Abaqus, Exodus or Kerf")->required()->type_name("");
  mesh->add_option("--into", a.mesh_file, "file to write, NAME.h5")->type_name("FILE");
  add_command(app, a, "list", "list the types that an input can name")
      ->add_option("KIND", a.kind, "only this kind, for example material; library for the sets of the material library")
      ->type_name("");
  CLI::App* describe = add_command(app, a, "describe", "show what a type takes and keeps");
  describe
      ->add_option("NAME", a.names,
                   "NAME, or KIND NAME, or input for the whole input file, or drive for a drive file; of a type, or of "
                   "a set of the material library")
      ->required()
      ->expected(1, 2)
      ->type_name("");
  describe->add_flag("--markdown", a.markdown, "write Markdown");
  CLI::App* test = add_command(app, a, "test-plugin", "test whether the types of a plugin keep their contracts");
  test->add_option("LIB", a.test.library, "the plugin's shared library")->type_name("");
  test->add_flag("--builtin", a.test.builtin, "test the types of Kerf itself");
  test->add_option("--samples", a.test.samples, "valid parameters of each type, and how it is tested")
      ->type_name("FILE");
  test->add_option("--only", a.test.only, "only this type, or all of this kind")->type_name("KIND.NAME");
  add_repeatable(*test, "--check", a.test.checks, "CHECK", "only this check; may be repeated");
  CLI::App* made = add_command(app, a, "new-plugin", "make a folder with a plugin to start from, its tests and pages");
  made->add_option("KIND", a.kind, "kind of the plugin, for example material")->required()->type_name("");
  made->add_option("NAME", a.name, "name of the new type and of the folder: lower-case words joined by _")
      ->required()
      ->type_name("");
  made->add_option("--output", a.folder, "folder in which the folder NAME is made; by default the present one")
      ->type_name("DIR");
  made->add_option("--from", a.python, "file of laws in Python, of which one is to be translated")->type_name("LAW.py");
  add_command(app, a, "schema", "print the JSON schema of the input");
  add_command(app, a, "reference", "write the reference manual as Markdown")
      ->add_option("--output", a.folder, "folder to write to")
      ->required()
      ->type_name("DIR");
}

int run_on_ranks(const std::string& command, const Arguments& a, Registry& registry, int argc, char** argv) {
  if (needs_mpirun(a.run.ranks)) check_before_launch(a.run, registry);
  relaunch_under_mpirun(a.run.ranks, argc, argv);
  if (command == "run") return run_command(a.run, registry);
  if (command == "check") return check_command(a.run, registry);
  PartitionOptions options = a.partition;
  options.run = a.run;
  return partition_command(options, registry);
}

int dispatch(const std::string& command, const Arguments& a, int argc, char** argv) {
  load_limit();  // a wrong one is told before anything else
  Registry registry;
  register_builtin_plugins(registry);
  if (command == "run" || command == "check" || command == "partition")
    return run_on_ranks(command, a, registry, argc, argv);
  if (command == "convert") return convert_command(a.run);
  if (command == "mesh") return mesh_command(a.run.input, a.mesh_file);
  if (command == "drive") return drive_command(a.run, registry, a.only_check);
  Diagnostics diagnostics;
  for (const std::string& path : a.run.plugins) load_plugin(path, registry, diagnostics);
  diagnostics.throw_if_errors();
  if (command == "list") return list_command(registry, a.kind);
  if (command == "describe") return describe_command(registry, a.names, a.markdown);
  if (command == "test-plugin") return test_plugin_command(a.test, registry);
  if (command == "new-plugin") return new_plugin_command(registry, a.kind, a.name, a.folder, a.python);
  if (command == "schema") return schema_command(registry);
  return reference_command(registry, a.folder);
}

// CLI11 would report a mistyped command as a superfluous argument.
bool is_unknown_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return false;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  if (std::find(names.begin(), names.end(), argv[1]) != names.end()) return false;
  const std::string near = nearest_name(argv[1], names);
  fmt::print(stderr, "error: there is no command \"{}\"; {}\n", argv[1],
             near.empty() ? "`kerf --help` shows all commands" : "did you mean `kerf " + near + "`?");
  return true;
}

// The message of the parser, or a better one for what it did not expect.
std::string complaint(const CLI::App& app, const CLI::App& command, const CLI::ParseError& e) {
  const std::vector<std::string> words = app.remaining(true);
  if (!dynamic_cast<const CLI::ExtrasError*>(&e) || words.empty()) return e.what();
  std::vector<std::string> options;
  for (const CLI::Option* o : command.get_options()) options.push_back(o->get_name());
  for (const std::string& word : words) {
    if (word.size() < 2 || word[0] != '-') continue;
    const std::string near = nearest_name(word.substr(0, word.find('=')), options);
    return fmt::format("`kerf {}` has no option {}{}", command.get_name(), word,
                       near.empty() ? "" : "; did you mean " + near + "?");
  }
  return fmt::format("\"{}\" is one argument too many", words.front());
}

int run_program(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Kerf: explicit dynamics for impact, penetration and erosion", "kerf");
  app.set_version_flag("--version", fmt::format("kerf {} (interface {})", KERF_VERSION, interface_version));
  app.require_subcommand(1);
  add_commands(app, arguments);
  if (argc < 2) {
    fmt::print("{}", app.help());
    return exit_other;
  }
  if (is_unknown_command(app, argc, argv)) return exit_other;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e) == 0 ? exit_done : exit_other;  // --help and --version
    const std::vector<CLI::App*> commands = app.get_subcommands();
    const CLI::App& command = commands.empty() ? app : *commands.front();
    fmt::print(stderr, "error: {}; `kerf {}--help` shows what can be typed\n", complaint(app, command, e),
               commands.empty() ? "" : command.get_name() + " ");
    return exit_other;
  }
  return dispatch(app.get_subcommands().front()->get_name(), arguments, argc, argv);
}

}  // namespace
}  // namespace kerf

int main(int argc, char** argv) {
  kerf::report_crashes();
  kerf::watch_for_stalls();
  try {
    return kerf::run_program(argc, argv);
  } catch (const kerf::InputError& e) {
    kerf::print_errors(e.lines());
    return kerf::exit_input_error;
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());  // on whichever rank it happens
    return kerf::exit_other;
  }
}
