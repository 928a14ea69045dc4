// The command that takes laws along paths of deformation, one element at a time.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>

#include "app/commands.hpp"
#include "app/load_input.hpp"
#include "core/activity.hpp"
#include "core/diagnostics.hpp"
#include "core/physics_error.hpp"
#include "drive/drive.hpp"

namespace kerf {

namespace {

void print_curves(const std::vector<DrivenCurve>& curves) {
  for (const DrivenCurve& c : curves) {
    const auto at = [&](const char* name) {
      const auto found = std::find_if(c.columns.begin(), c.columns.end(),
                                      [&](const DrivenColumn& column) { return column.name == name; });
      return static_cast<std::size_t>(std::distance(c.columns.begin(), found));
    };
    double von_mises = 0.0, pressure = 0.0;
    for (const std::vector<double>& row : c.rows) {
      von_mises = std::max(von_mises, row[at("von_mises")]);
      if (std::abs(row[at("pressure")]) > std::abs(pressure)) pressure = row[at("pressure")];
    }
    fmt::print("{} along {}: {} steps to {:.6g} s, von Mises stress up to {:.6g} Pa, pressure up to {:.6g} Pa{}\n",
               c.material, c.path, c.steps, c.rows.back().front(), von_mises, pressure,
               c.failed_at < 0.0 ? "" : fmt::format(", the element fails at {:.6g} s", c.failed_at));
  }
}

std::string folder_of(const RunOptions& options) {
  std::string folder = options.output;
  if (folder.empty()) folder = std::filesystem::path(options.input).replace_extension(".drive").string();
  return folder.back() == '/' ? folder : folder + "/";
}

}  // namespace

int drive_command(const RunOptions& options, Registry& registry, bool only_check) {
  const std::string bytes = read_with_plugins(options, registry);
  const auto input = read_drive_input(options.input, bytes, options.overrides, registry);
  for (const std::string& warning : input->warnings) fmt::print(stderr, "{}\n", warning);
  const std::string input_folder = std::filesystem::path(options.input).parent_path().string();
  const activity::Task task("driving laws", {activity::default_limit, "a fixed limit", exit_physics});
  std::vector<DrivenCurve> curves;
  try {
    curves = drive(*input, input_folder);
  } catch (const PhysicsError& e) {
    fmt::print(stderr, "{}: error: {}\n", options.input, e.what());
    return exit_physics;
  }
  if (!only_check) {
    const std::string folder = folder_of(options);
    write_curves(*input, input_folder, curves, folder);
    print_curves(curves);
    fmt::print("curves are in {}\n", folder);
  }
  fmt::print("{}", check_table(curves));
  std::size_t checks = 0, failed = 0;
  for (const DrivenCurve& c : curves) {
    checks += c.checks.size();
    failed += std::count_if(c.checks.begin(), c.checks.end(), [](const DriveCheck& k) { return !k.passes(); });
  }
  if (only_check && checks == 0) {
    fmt::print(stderr, "{}: error: no path has a reference with a tolerance, so there is nothing to check\n",
               options.input);
    return exit_input_error;
  }
  if (failed > 0) fmt::print(stderr, "{}: error: {} of {} checks fail\n", options.input, failed, checks);
  return failed > 0 ? exit_other : exit_done;
}

}  // namespace kerf
